//! The records of a run: fields, gauges, end histories, fronts, ledger, audit, and the result file.

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
    Audit, Case, LOOKS, Off, above_critical, at_limit, broken_end, broken_inside, late_fracture, past_data,
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
    /// Every field, in the order of the contract.
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

    /// The field of the surface from which one in torsion is computed; any other field itself.
    #[must_use]
    pub fn base(self) -> Self {
        match self {
            Self::Torque => Self::Stress,
            Self::Twist => Self::Strain,
            Self::AngularVelocity => Self::Velocity,
            field => field,
        }
    }

    /// The effect without which it does not exist, a key of the scene's `[effects]`.
    pub fn needs(self) -> Option<&'static str> {
        match self {
            Self::PlasticStrain | Self::AccumulatedPlasticStrain => Some("hardening"),
            Self::Temperature => Some("heat"),
            _ => None,
        }
    }

    /// Dataset name.
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

    /// SI unit, as written to the `units` attribute.
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

    /// For the `long_name` attribute and for axis labels.
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

    /// The same for a bar in torsion, whose fields are those of its surface.
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

/// One moment of the recorded fields: one row of `n_x` values for each recorded field, in the layout's order.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Frame {
    /// s.
    pub time: f64,
    /// A row for each field.
    pub rows: Vec<Vec<f64>>,
}

/// A history at one place; a column has one value a row of `time`, or is empty.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct Trace {
    /// s.
    pub time: Vec<f64>,
    /// Pa.
    pub stress: Vec<f64>,
    /// Engineering strain; empty for the ends.
    pub strain: Vec<f64>,
    /// m/s.
    pub velocity: Vec<f64>,
    /// K; empty without the effect of heat, and for the ends.
    pub temperature: Vec<f64>,
}

impl Trace {
    /// All columns, the time first.
    pub fn columns_mut(&mut self) -> [&mut Vec<f64>; 5] {
        [&mut self.time, &mut self.stress, &mut self.strain, &mut self.velocity, &mut self.temperature]
    }
}

/// One row of the ledger. Energies in J, momenta in N s (per m^2 where the scene gives no area).
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize)]
pub struct LedgerRow {
    /// s.
    pub time: f64,
    /// Energies and momentum of the bar.
    pub energies: Energies,
    /// Work done on the bar by the left end since the start.
    pub work_left: f64,
    /// Work done on the bar by the right end since the start.
    pub work_right: f64,
    /// Impulse that both ends, external damping and a foundation have given to the bar since the start.
    pub impulse: f64,
    /// Energy that is missing (or too much), over the larger of the initial energy and the work that went
    /// through the ends; dimensionless.
    pub residual: f64,
}

/// One front: an edge of the hull and what the simulation made of it. Signs as in the fields.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct FrontRow {
    /// Where it started: "left", "right" or "joint 1", ..., for the fronts of theory; [`INTERIOR`] for any other front
    /// that is under way at the end of a tracked run.
    pub origin: String,
    /// Strain behind the front.
    pub strain_behind: f64,
    /// Strain ahead of it.
    pub strain_ahead: f64,
    /// Stress behind, Pa.
    pub stress_behind: f64,
    /// Stress ahead, Pa.
    pub stress_ahead: f64,
    /// Theory, m/s: sqrt(d sigma/(rho d eps)), positive in +x.
    pub speed: f64,
    /// Read off the simulated field (by front tracking: off the front itself), m/s, positive in +x; NaN where the front
    /// could not be followed.
    pub speed_measured: f64,
    /// Place where it was last seen, m from the left end; NaN where it never was.
    pub position: f64,
    /// When it was last seen, s: the end of the run, or when it met another wave.
    pub last_seen: f64,
    /// Until when the load that sent it out is as at t = 0, s: infinite where it never changes, NaN for [`INTERIOR`].
    pub load_held_until: f64,
    /// Arrival time at each gauge in the layout's order, s; NaN where it did not get there.
    pub arrivals: Vec<f64>,
}

/// A straight piece of a front in x and t, for `/paths`.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub struct PathRow {
    /// Where it began, m from the left end.
    pub x0: f64,
    /// When, s.
    pub t0: f64,
    /// Where it met something, or is at the end of the run, m.
    pub x1: f64,
    /// When, s.
    pub t1: f64,
    /// Stress behind the front less the stress ahead of it, Pa.
    pub stress_jump: f64,
    /// m/s, positive in +x.
    pub speed: f64,
}

/// A neglected effect, and how large it would have been; see [`Audit`].
#[derive(Debug, Clone, Default, PartialEq)]
pub struct AuditRow {
    /// e.g. "hardening".
    pub effect: String,
    /// Estimated relative change of the stress, or the quantity named in `finding`; NaN (null in JSON) if unknown.
    pub estimate: f64,
    /// Threshold of significance: the `audit-tolerance` of the run, or that named in `finding`.
    pub threshold: f64,
    /// What was neglected, e.g. "lateral inertia", where `finding` is only its size; empty where that says all, as in rows read from a file.
    pub neglected: String,
    /// For people: size, place, time.
    pub finding: String,
    /// How to include the effect, e.g. "Add `heat = {}` under `[effects]` to include it"; empty if there is nothing to do, and in
    /// rows read from a file, whose `finding` has it.
    pub remedy: String,
}

impl AuditRow {
    /// The effect would have changed the answer.
    pub fn matters(&self) -> bool {
        self.estimate >= self.threshold
    }

    /// The finding, and how to include the effect.
    pub fn advice(&self) -> String {
        let stop = if self.remedy.is_empty() { "" } else { ". " };
        format!("{}{stop}{}", self.said(" was neglected; "), self.remedy)
    }

    /// The advice as a sentence, with a capital letter and a full stop.
    pub fn note(&self) -> String {
        let advice = self.advice();
        let mut letters = advice.chars();
        let first: String = letters.next().into_iter().flat_map(char::to_uppercase).collect();
        format!("{first}{}.", letters.as_str())
    }

    /// The finding without its remedy; `of` leads from what was neglected to its size.
    fn said(&self, of: &str) -> String {
        if self.neglected.is_empty() { self.finding.clone() } else { format!("{}{of}{}", self.neglected, self.finding) }
    }

    /// The finding where the effect is considered, not neglected.
    pub fn considered(&self) -> String {
        self.said(": ")
    }

    /// One line of text: effect, finding, and the key that includes it.
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

/// A curve as the run used it, for `/material/<name>`.
#[derive(Debug, Clone, PartialEq)]
pub struct MaterialRecord {
    /// Group name.
    pub name: String,
    /// Knot strains, signed: compression branch first where it differs.
    pub strain: Vec<f64>,
    /// Knot stresses, Pa, signed.
    pub stress: Vec<f64>,
    /// Strains and stresses (Pa) in tension.
    pub tension: [Vec<f64>; 2],
    /// Their magnitudes in compression.
    pub compression: [Vec<f64>; 2],
    /// kg/m^3.
    pub density: f64,
    /// Pa.
    pub modulus: f64,
    /// Citation, what was measured, confidence, origin: written as attributes.
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
