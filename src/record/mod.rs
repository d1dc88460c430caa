//! Records of a run: fields, gauges, end histories, fronts, ledger, audit, and the result file.

mod audit;
mod checks;
mod end_rows;
mod error_table;
mod figures;
mod frames;
mod fronts;
mod grid_view;
mod impact;
mod joint_rows;
mod ledger;
mod length;
mod step_gauges;
mod stepped;
pub mod store;
mod summary;
mod temperature;
mod traces;
mod tracked;
mod tracked_fronts;
mod view;

use serde::ser::SerializeStruct;
use serde::{Deserialize, Serialize, Serializer};

pub use crate::solver::EndState;
use crate::solver::Energies;

pub use audit::{
    AUDIT_SAMPLES, Audit, Case, Off, above_critical, at_limit, broken_end, broken_inside, late_fracture, past_data,
    reversed_flow, short_tension, unresolved_flow,
};
pub use checks::{ElasticProbe, against_similarity, alone, similar_stress};
pub use end_rows::EndRows;
pub use error_table::{ErrorTable, Measure, Worst};
pub use figures::{
    Extreme, Figure, Figures, Fragments, Group, Profile, Records, ResidualProfile, SegmentEnd, Tally, definitions,
    dimension_of, names as figure_names, without_unit,
};
pub use frames::{Frames, Twisted, read_frame};
pub use fronts::FrontTracker;
pub use impact::{ImpactPlan, ImpactSummary};
pub use joint_rows::JointRows;
pub use ledger::Ledger;
pub use length::LengthSummary;
pub use step_gauges::StepGauges;
pub use stepped::Stepped;
pub use summary::{
    AutoChoice, ChoiceSummary, ElasticCheck, EndSummary, ErrorFigure, FrontSummary, LedgerSummary, RuptureSummary,
    SolvedBy, Summary, TorsionSummary, TrackingSummary, Tried,
};
pub use temperature::{flowed_both_ways, largest_rise};
pub use traces::Traces;
pub use tracked::EndHistories;
pub use tracked_fronts::{INTERIOR, Paths, TrackedFronts};
pub use view::{Account, ContactReading, Start, View};

/// A field that can be recorded over x and t.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, clap::ValueEnum)]
#[serde(rename_all = "snake_case")]
#[value(rename_all = "snake_case")]
pub enum Field {
    /// Engineering stress, Pa.
    Stress,
    /// Engineering strain.
    Strain,
    /// Velocity, m/s.
    Velocity,
    /// Displacement, m.
    Displacement,
    /// Signed plastic strain.
    PlasticStrain,
    /// Accumulated plastic strain, >= 0.
    AccumulatedPlasticStrain,
    /// Temperature, K.
    Temperature,
    /// In torsion: torque, N m.
    Torque,
    /// In torsion: twist per length, rad/m.
    Twist,
    /// In torsion: angular velocity, rad/s.
    AngularVelocity,
}

impl Field {
    /// Every field, in the order in which the interface lists them.
    pub const ALL: [Self; 10] = [
        Self::Stress,
        Self::Strain,
        Self::Velocity,
        Self::Displacement,
        Self::PlasticStrain,
        Self::AccumulatedPlasticStrain,
        Self::Temperature,
        Self::Torque,
        Self::Twist,
        Self::AngularVelocity,
    ];

    /// Returns the surface field from which a field in torsion is computed, or the field itself if it is no such field.
    #[must_use]
    pub fn base(self) -> Self {
        match self {
            Self::Torque => Self::Stress,
            Self::Twist => Self::Strain,
            Self::AngularVelocity => Self::Velocity,
            field => field,
        }
    }

    /// Returns the effect without which the field does not exist, as a key of the scene's `[effects]`; `None` if it always exists.
    pub fn needs(self) -> Option<&'static str> {
        match self {
            Self::PlasticStrain | Self::AccumulatedPlasticStrain => Some("hardening"),
            Self::Temperature => Some("heat"),
            _ => None,
        }
    }

    /// Returns the name of the dataset.
    pub fn name(self) -> &'static str {
        match self {
            Self::Stress => "stress",
            Self::Strain => "strain",
            Self::Velocity => "velocity",
            Self::Displacement => "displacement",
            Self::PlasticStrain => "plastic_strain",
            Self::AccumulatedPlasticStrain => "accumulated_plastic_strain",
            Self::Temperature => "temperature",
            Self::Torque => "torque",
            Self::Twist => "twist",
            Self::AngularVelocity => "angular_velocity",
        }
    }

    /// Returns the SI unit, as written to the `units` attribute.
    pub fn units(self) -> &'static str {
        match self {
            Self::Stress => "Pa",
            Self::Velocity => "m/s",
            Self::Displacement => "m",
            Self::Temperature => "K",
            Self::Strain | Self::PlasticStrain | Self::AccumulatedPlasticStrain => "1",
            Self::Torque => "N m",
            Self::Twist => "rad/m",
            Self::AngularVelocity => "rad/s",
        }
    }

    /// Returns the description for the `long_name` attribute and for axis labels.
    pub fn long_name(self) -> &'static str {
        match self {
            Self::Stress => "engineering stress, tension positive",
            Self::Strain => "engineering strain",
            Self::Velocity => "velocity in +x",
            Self::Displacement => "displacement in +x",
            Self::PlasticStrain => "plastic strain",
            Self::AccumulatedPlasticStrain => "accumulated plastic strain",
            Self::Temperature => "temperature",
            Self::Torque => "torque in the section",
            Self::Twist => "twist per length",
            Self::AngularVelocity => "angular velocity",
        }
    }

    /// Returns the description for a bar in torsion, whose fields are those of its surface.
    pub fn long_name_in_torsion(self) -> &'static str {
        match self {
            Self::Stress => "nominal shear stress at the surface, torque times radius over J",
            Self::Strain => "engineering shear strain at the surface",
            Self::Velocity => "velocity of the surface, angular velocity times radius",
            Self::Displacement => "displacement of the surface, angle times radius",
            Self::PlasticStrain => "plastic shear strain at the surface",
            Self::AccumulatedPlasticStrain => "accumulated plastic shear strain at the surface",
            field => field.long_name(),
        }
    }
}

/// Recorded fields at one time: one row of `n_x` values for each recorded field, in the layout's order.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Frame {
    /// Time of the frame, s.
    pub time: f64,
    /// One row of values for each field.
    pub rows: Vec<Vec<f64>>,
}

/// History at one place. A column has one value for each row of `time`, or is empty.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct Trace {
    /// Times of the rows, s, non-decreasing.
    pub time: Vec<f64>,
    /// Stress, Pa, tension positive.
    pub stress: Vec<f64>,
    /// Engineering strain; empty for the ends.
    pub strain: Vec<f64>,
    /// Velocity, m/s, positive in +x.
    pub velocity: Vec<f64>,
    /// Temperature, K; empty without the effect of heat, and for the ends.
    pub temperature: Vec<f64>,
}

impl Trace {
    /// Returns all columns, the time first.
    pub fn columns_mut(&mut self) -> [&mut Vec<f64>; 5] {
        [&mut self.time, &mut self.stress, &mut self.strain, &mut self.velocity, &mut self.temperature]
    }
}

/// Row of the ledger. Energies are in J, momenta in N s (per m^2 if the scene gives no area).
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize)]
pub struct LedgerRow {
    /// Time of the row, s.
    pub time: f64,
    /// Energies and momentum of the bar.
    pub energies: Energies,
    /// Work done on the bar by the left end since the start.
    pub work_left: f64,
    /// Work done on the bar by the right end since the start.
    pub work_right: f64,
    /// Impulse given to the bar by both ends, external damping and a foundation since the start.
    pub impulse: f64,
    /// Energy residual, positive if there is too much energy, relative to the largest energy that the bar has held or an end has transferred so far.
    pub residual: f64,
}

/// Front: an edge of the hull, and what was measured of it in the simulation. Signs as in the fields.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct FrontRow {
    /// Origin of the front: "left", "right" or "joint 1", ..., for the fronts of the theory; [`INTERIOR`] for any other
    /// front in the bar at the end of a front-tracking run.
    pub origin: String,
    /// Engineering strain behind the front.
    pub strain_behind: f64,
    /// Engineering strain ahead of the front.
    pub strain_ahead: f64,
    /// Stress behind the front, Pa.
    pub stress_behind: f64,
    /// Stress ahead of the front, Pa.
    pub stress_ahead: f64,
    /// Theoretical speed sqrt(d sigma/(rho d eps)), m/s, positive in +x.
    pub speed: f64,
    /// Speed measured in the simulated field (in front tracking: of the front itself), m/s, positive in +x; NaN if the front could not be followed.
    pub speed_measured: f64,
    /// Last known position, m from the left end; NaN if there is none.
    pub position: f64,
    /// Time of the last known position, s: the end of the run, or the time at which the front met another wave.
    pub last_seen: f64,
    /// Time up to which the load that emits the front is as at t = 0, s: infinite if it never changes, NaN for [`INTERIOR`].
    pub load_held_until: f64,
    /// Arrival time at each gauge in the layout's order, s; NaN if the front did not reach the gauge.
    pub arrivals: Vec<f64>,
}

/// Straight segment of a front in the x-t plane, for `/paths`.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub struct PathRow {
    /// Position of the start, m from the left end.
    pub x0: f64,
    /// Time of the start, s.
    pub t0: f64,
    /// Position of the end, m: where the front met another front or a boundary, or where it is at the end of the run.
    pub x1: f64,
    /// Time of the end, s.
    pub t1: f64,
    /// Stress behind the front minus stress ahead of it, Pa.
    pub stress_jump: f64,
    /// Speed, m/s, positive in +x.
    pub speed: f64,
}

/// Neglected effect and the estimate of its size; see [`Audit`].
#[derive(Debug, Clone, Default, PartialEq)]
pub struct AuditRow {
    /// Name of the effect, e.g. "hardening".
    pub effect: String,
    /// Estimated relative change of the stress, or the quantity named in `finding`; NaN (null in JSON) if unknown.
    pub estimate: f64,
    /// Threshold of significance: the `audit-tolerance` of the run, or the one named in `finding`.
    pub threshold: f64,
    /// Neglected phenomenon, e.g. "lateral inertia", if `finding` states only its size; empty if `finding` is complete, as in rows read from a file.
    pub neglected: String,
    /// Text with size, place and time.
    pub finding: String,
    /// Instruction for including the effect, e.g. "Add `heat = {}` under `[effects]` to include it". Empty if there is
    /// nothing to do, and in rows read from a file, whose `finding` contains it.
    pub remedy: String,
}

impl AuditRow {
    /// Returns true if including the effect would change the result significantly.
    pub fn matters(&self) -> bool {
        self.estimate >= self.threshold
    }

    /// Returns the finding, followed by the instruction for including the effect.
    pub fn advice(&self) -> String {
        let stop = if self.remedy.is_empty() { "" } else { ". " };
        format!("{}{stop}{}", self.said(" was neglected; "), self.remedy)
    }

    /// Returns the advice as a sentence, with a capital letter and a full stop.
    pub fn note(&self) -> String {
        let advice = self.advice();
        let mut letters = advice.chars();
        let first: String = letters.next().into_iter().flat_map(char::to_uppercase).collect();
        format!("{first}{}.", letters.as_str())
    }

    /// Returns the finding without its remedy; `of` joins the neglected phenomenon to its size.
    fn said(&self, of: &str) -> String {
        if self.neglected.is_empty() { self.finding.clone() } else { format!("{}{of}{}", self.neglected, self.finding) }
    }

    /// Returns the finding for an effect that is considered, not neglected.
    pub fn considered(&self) -> String {
        self.said(": ")
    }

    /// Returns one line of text: effect, finding, and the key that includes the effect.
    pub fn message(&self) -> String {
        format!("{}: {}", self.effect, self.advice())
    }
}

impl Serialize for AuditRow {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut row = serializer.serialize_struct("AuditRow", 4)?;
        row.serialize_field("effect", &self.effect)?;
        row.serialize_field("estimate", &self.estimate)?;
        row.serialize_field("threshold", &self.threshold)?;
        row.serialize_field("message", &self.message())?;
        row.end()
    }
}

/// Stress-strain curve as the run used it, for `/material/<name>`.
#[derive(Debug, Clone, PartialEq)]
pub struct MaterialRecord {
    /// Name of the group.
    pub name: String,
    /// Strains of the knots, signed; the compression branch comes first if it differs from the tension branch.
    pub strain: Vec<f64>,
    /// Stresses of the knots, Pa, signed.
    pub stress: Vec<f64>,
    /// Strains and stresses (Pa) in tension.
    pub tension: [Vec<f64>; 2],
    /// Magnitudes of strains and stresses (Pa) in compression.
    pub compression: [Vec<f64>; 2],
    /// Density, kg/m^3.
    pub density: f64,
    /// Young's modulus (shear modulus in torsion), Pa.
    pub modulus: f64,
    /// Citation, measured quantity, confidence and origin, written as attributes.
    pub provenance: crate::material::Provenance,
}

/// Size of the numbers in the file.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Precision {
    /// 8 bytes.
    #[default]
    F64,
    /// 4 bytes.
    F32,
}

/// Compression of the fields in the file.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Compression {
    /// Shuffle and deflate: small.
    #[default]
    Deflate,
    /// Shuffle and lzf: faster, larger.
    Lzf,
    /// None.
    None,
}

impl From<&crate::material::Material> for MaterialRecord {
    fn from(material: &crate::material::Material) -> Self {
        use crate::material::Sense;
        let tension = material.branch(Sense::Tension);
        let (mut strain, mut stress) = (Vec::new(), Vec::new());
        if let Some(compression) = &material.compression {
            strain.extend(compression.strain().iter().skip(1).rev().map(|e| -e));
            stress.extend(compression.stress().iter().skip(1).rev().map(|s| -s));
        }
        strain.extend(tension.strain());
        stress.extend(tension.stress());
        let branch = |sense| [material.branch(sense).strain().to_vec(), material.branch(sense).stress().to_vec()];
        Self {
            name: material.name.clone(),
            strain,
            stress,
            tension: branch(Sense::Tension),
            compression: branch(Sense::Compression),
            density: material.density,
            modulus: material.modulus,
            provenance: material.provenance.clone(),
        }
    }
}
