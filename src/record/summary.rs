//! Summary of a run, as printed and as `--json`.

use serde::{Deserialize, Serialize};

use super::{AuditRow, ErrorTable, Figures, LengthSummary};
use crate::law::rupture::{Cause, Rupture};

/// Summary of a run; its keys are part of the interface.
#[derive(Debug, Clone, Serialize)]
pub struct Summary {
    /// Title of the scene.
    pub scene: String,
    /// Outcome: "done", "rupture", "interrupted", ...
    pub outcome: String,
    /// Method: "fd" or "moc".
    pub method: String,
    /// Scheme: "leapfrog", ...
    pub scheme: String,
    /// Effects that were simulated.
    pub effects: Vec<String>,
    /// Number of cells; 0 for moc, which has none.
    pub cells: usize,
    /// Number of time steps; for moc, of events.
    pub steps: usize,
    /// Number of events: interactions of fronts, and steps of the ends (0 for fd).
    pub events: u64,
    /// Wall time of the whole run, output included, s.
    pub wall_s: f64,
    /// Wall time of the solver alone, s.
    pub step_wall_s: f64,
    /// Cells times steps over `step_wall_s`, 1/s.
    pub cell_steps_per_s: f64,
    /// Results that only front tracking has; absent for fd.
    #[serde(flatten)]
    pub tracking: Option<TrackingSummary>,
    /// Simulated time that was reached, s.
    pub end_time_s: f64,
    /// State of the left end at the end time.
    pub left: EndSummary,
    /// State of the right end at the end time.
    pub right: EndSummary,
    /// Lengths of the segments from left to right; absent in torsion.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub lengths: Vec<LengthSummary>,
    /// Figures: forces, contact, gauges, residual deformation, energy, rebound.
    pub figures: Figures,
    /// Results that only a bar in torsion has.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub torsion: Option<TorsionSummary>,
    /// Fronts emitted by the ends and joints, and in moc all fronts in the bar at the end.
    pub fronts: Vec<FrontSummary>,
    /// Critical velocity of the struck material, m/s; null if the data do not determine it.
    #[serde(rename = "critical_velocity_m_s")]
    pub critical_velocity: Option<f64>,
    /// True if an imposed velocity exceeds the critical velocity.
    pub above_critical: bool,
    /// Comparison of sigma with rho c0 v (9.34), if the run stayed elastic.
    pub elastic_check: Option<ElasticCheck>,
    /// Residuals of the ledger.
    pub ledger: LedgerSummary,
    /// Error against a reference, if there is one.
    pub error: Option<ErrorFigure>,
    /// Errors of all measures; null if they were neither measured nor estimated.
    pub errors: Option<ErrorTable>,
    /// Reasons for the method and resolution; absent if the scene specifies them.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub choice: Option<ChoiceSummary>,
    /// Fractures of the bar; absent if the scene does not simulate fracture.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub ruptures: Option<Vec<RuptureSummary>>,
    /// Choices of `effects = "auto"` and their reasons; absent if the scene lists its effects.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub auto: Option<Vec<AutoChoice>>,
    /// Largest temperature rise at the end, K; absent without the effect of heat.
    #[serde(rename = "largest_temperature_rise_K", skip_serializing_if = "Option::is_none")]
    pub temperature_rise: Option<f64>,
    /// Neglected effects.
    pub audit: Vec<AuditRow>,
    /// Notes on problematic settings of the scene and on significant neglected effects, one sentence each.
    pub notes: Vec<String>,
    /// Path of the result file.
    pub output: String,
}

/// Decision of `effects = "auto"` about one effect.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct AutoChoice {
    /// Key of the scene's `[effects]`.
    pub effect: String,
    /// True if the effect is simulated from this round onwards.
    pub on: bool,
    /// Reason, with the figures.
    pub why: String,
    /// Estimated relative change of the stress by the effect; infinite (null in JSON) if a recorded field needs it.
    pub estimate: f64,
    /// Round: 0 before the first run, otherwise the number of the run after which the effect was found to be missing.
    pub round: usize,
}

/// Additional results of front tracking; their keys are at the same level as those of [`Summary`].
#[derive(Debug, Clone, Copy, Serialize)]
pub struct TrackingSummary {
    /// Smallest stress jump that is tracked as a front of its own, relative to `stress_scale`.
    pub front_tolerance: f64,
    /// Stress to which tolerances are relative, Pa: the largest imposed or initial stress, or the stress that the
    /// largest difference of imposed and initial velocities causes in the unstressed bar.
    #[serde(rename = "stress_scale_Pa")]
    pub stress_scale: f64,
    /// Number of fronts in the bar at the end.
    pub fronts_under_way: usize,
    /// Events over `step_wall_s`, 1/s.
    pub events_per_s: f64,
}

/// Choice of the method and resolution for a scene with a tolerance.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ChoiceSummary {
    /// Requested tolerance.
    pub tolerance: f64,
    /// Reason for the choice, one sentence.
    pub why: String,
    /// Pilot runs and runs that missed the tolerance, method by method, and finally the run itself.
    pub tried: Vec<Tried>,
}

/// Method and its resolution.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct SolvedBy {
    /// Method: "fd" or "moc".
    pub method: String,
    /// Scheme: "leapfrog", "muscl", "front-tracking" or "characteristic-net".
    pub scheme: String,
    /// Number of cells of the bar; absent for front tracking.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub cells: Option<usize>,
    /// Front tolerance; absent for methods on a grid.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub front_tolerance: Option<f64>,
}

impl std::fmt::Display for SolvedBy {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{} with ", self.scheme)?;
        match self.front_tolerance {
            Some(front_tolerance) => write!(f, "front tolerance {front_tolerance:.1e}"),
            None => write!(f, "{} cells", self.cells.unwrap_or(0)),
        }
    }
}

/// Pilot run, or run.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Tried {
    /// Method and its resolution.
    #[serde(flatten)]
    pub by: SolvedBy,
    /// Estimated error.
    pub estimate: Option<f64>,
    /// Work: cell-steps or events.
    pub work: u64,
}

/// Ends of a bar in torsion at the end time. The stresses, strains and velocities of the summary are those of the surface.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct TorsionSummary {
    /// Radius of the surface, m; for thin tubes the mean radius.
    pub radius_m: f64,
    /// Torque at the left and the right end, N m.
    #[serde(rename = "torque_N_m")]
    pub torque: [f64; 2],
    /// Angular velocity of the left and the right end, rad/s.
    pub angular_velocity_rad_s: [f64; 2],
}

/// State at an end.
#[derive(Debug, Clone, Copy, Serialize)]
pub struct EndSummary {
    /// Stress, Pa, tension positive.
    #[serde(rename = "stress_Pa")]
    pub stress: f64,
    /// Engineering strain: for fd four cells inside the bar, for moc at the end itself.
    pub strain: f64,
    /// Velocity, m/s, positive in +x.
    #[serde(rename = "velocity_m_s")]
    pub velocity: f64,
    /// Velocity of the striker at the end, m/s; absent without a striker.
    #[serde(rename = "striker_velocity_m_s", skip_serializing_if = "Option::is_none")]
    pub striker: Option<f64>,
}

/// Fracture in the summary.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct RuptureSummary {
    /// Site: "left end", "right end", "joint 1", ..., "segment 1", ...
    pub site: String,
    /// Criterion that was met.
    pub cause: Cause,
    /// Time of the fracture, s.
    pub time_s: f64,
    /// Position in the undeformed bar, m from the left end.
    pub x_m: f64,
    /// Stress at the place when it fractured, Pa.
    #[serde(rename = "stress_Pa")]
    pub stress: f64,
    /// Nominal strain at the place when it fractured.
    pub strain: f64,
    /// Energy absorbed at the place up to the fracture, J/m^3.
    #[serde(rename = "absorbed_J_m3")]
    pub absorbed: f64,
    /// Strain energy and plastic work of the whole bar at the time of the fracture, J (per m^2 if the scene gives no area).
    #[serde(rename = "bar_absorbed_J")]
    pub bar_absorbed: f64,
}

impl From<&Rupture> for RuptureSummary {
    fn from(rupture: &Rupture) -> Self {
        Self {
            site: rupture.site.to_string(),
            cause: rupture.cause,
            time_s: rupture.time,
            x_m: rupture.x,
            stress: rupture.stress,
            strain: rupture.strain,
            absorbed: rupture.absorbed,
            bar_absorbed: rupture.bar_absorbed,
        }
    }
}

/// Front in the summary.
#[derive(Debug, Clone, Serialize)]
pub struct FrontSummary {
    /// Origin of the front.
    pub origin: String,
    /// Strain ahead of the front.
    pub strain_ahead: f64,
    /// Strain behind the front.
    pub strain_behind: f64,
    /// Stress ahead of the front, Pa.
    #[serde(rename = "stress_ahead_Pa")]
    pub stress_ahead: f64,
    /// Stress behind the front, Pa.
    #[serde(rename = "stress_behind_Pa")]
    pub stress_behind: f64,
    /// Theoretical speed, m/s, positive in +x.
    #[serde(rename = "speed_m_s")]
    pub speed: f64,
    /// Speed measured in the field, m/s; null if the front could not be followed.
    #[serde(rename = "speed_measured_m_s")]
    pub speed_measured: Option<f64>,
    /// Last known position, m from the left end; null if there is none.
    #[serde(rename = "position_m")]
    pub position: Option<f64>,
    /// Time of the last known position, s.
    pub last_seen_s: Option<f64>,
}

/// Elastic check, sigma = rho c0 v.
#[derive(Debug, Clone, Copy, Serialize)]
pub struct ElasticCheck {
    /// Simulated stress behind the front, Pa.
    #[serde(rename = "stress_Pa")]
    pub stress: f64,
    /// Expected stress rho c0 v with its sign, Pa.
    #[serde(rename = "expected_Pa")]
    pub expected: f64,
    /// Relative error |stress - expected| / |expected|.
    pub relative: f64,
}

/// Residuals of the ledger.
#[derive(Debug, Clone, Copy, Serialize)]
pub struct LedgerSummary {
    /// Largest relative energy residual of the run.
    pub energy_residual: f64,
    /// Largest relative momentum residual of the run.
    pub momentum_residual: f64,
}

/// Error and what it refers to.
#[derive(Debug, Clone, Serialize)]
pub struct ErrorFigure {
    /// Value of the error.
    pub value: f64,
    /// Measured quantity, e.g. "relative L1 of stress over the bar at the end time".
    pub measure: String,
    /// Reference against which the error is measured.
    pub reference: String,
    /// Errors of all measures, if they are known; `value` is then the largest of them.
    #[serde(skip)]
    pub table: Option<ErrorTable>,
}

impl From<&super::FrontRow> for FrontSummary {
    fn from(row: &super::FrontRow) -> Self {
        let known = |value: f64| value.is_finite().then_some(value);
        Self {
            origin: row.origin.clone(),
            strain_ahead: row.strain_ahead,
            strain_behind: row.strain_behind,
            stress_ahead: row.stress_ahead,
            stress_behind: row.stress_behind,
            speed: row.speed,
            speed_measured: known(row.speed_measured),
            position: known(row.position),
            last_seen_s: known(row.last_seen),
        }
    }
}
