//! The summary of a run, as printed and as `--json`.

use serde::{Deserialize, Serialize};

use super::{AuditRow, ErrorTable, Figures, LengthSummary};
use crate::law::rupture::{Cause, Rupture};

/// The summary of a run; the keys are part of the interface.
#[derive(Debug, Clone, Serialize)]
pub struct Summary {
    /// Scene title.
    pub scene: String,
    /// "done", "rupture", "interrupted", ...
    pub outcome: String,
    /// "fd" or "moc".
    pub method: String,
    /// "leapfrog", ...
    pub scheme: String,
    /// Effects that were simulated.
    pub effects: Vec<String>,
    /// Cells; 0 for moc, which has none.
    pub cells: usize,
    /// Time steps; for moc, the events.
    pub steps: usize,
    /// Meetings of fronts, and steps of the ends (0 for fd).
    pub events: u64,
    /// Whole run, output included, s.
    pub wall_s: f64,
    /// Stepping alone, s.
    pub step_wall_s: f64,
    /// cells * steps / `step_wall_s`.
    pub cell_steps_per_s: f64,
    /// What only front tracking has; absent for fd.
    #[serde(flatten)]
    pub tracking: Option<TrackingSummary>,
    /// Simulated time reached, s.
    pub end_time_s: f64,
    /// Left end at the end time.
    pub left: EndSummary,
    /// Right end at the end time.
    pub right: EndSummary,
    /// Lengths of the segments, left to right; left out in torsion.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub lengths: Vec<LengthSummary>,
    /// Forces, contact, gauges, residual deformation, energy, rebound.
    pub figures: Figures,
    /// What only a bar in torsion has.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub torsion: Option<TorsionSummary>,
    /// Fronts.
    pub fronts: Vec<FrontSummary>,
    /// Of the struck material, m/s; null where the data hold none.
    #[serde(rename = "critical_velocity_m_s")]
    pub critical_velocity: Option<f64>,
    /// The imposed velocity is more than the bar can carry away.
    pub above_critical: bool,
    /// sigma against rho c0 v (9.34), where the run stayed elastic.
    pub elastic_check: Option<ElasticCheck>,
    /// Residuals.
    pub ledger: LedgerSummary,
    /// Error against a reference, where there is one.
    pub error: Option<ErrorFigure>,
    /// Errors one by one; left out where they were not measured or estimated.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub errors: Option<ErrorTable>,
    /// Why this method and resolution; left out where the scene names them.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub choice: Option<ChoiceSummary>,
    /// Where and when the bar broke; left out where it was not to break.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub ruptures: Option<Vec<RuptureSummary>>,
    /// What `effects = "auto"` chose, and why; left out where the scene names its effects.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub auto: Option<Vec<AutoChoice>>,
    /// Largest rise in temperature at the end, K; left out without the effect of heat.
    #[serde(rename = "largest_temperature_rise_K", skip_serializing_if = "Option::is_none")]
    pub temperature_rise: Option<f64>,
    /// Neglected effects.
    pub audit: Vec<AuditRow>,
    /// Notes on problematic settings of the scene, and on neglected effects that matter, one sentence each.
    pub notes: Vec<String>,
    /// Result file.
    pub output: String,
}

/// One decision of `effects = "auto"`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct AutoChoice {
    /// A key of the scene's `[effects]`.
    pub effect: String,
    /// Simulated from this round on.
    pub on: bool,
    /// Why, with the figures.
    pub why: String,
    /// Estimated relative change of the stress that it makes; infinite (null in JSON) where a field that is recorded needs it.
    pub estimate: f64,
    /// 0: before the first run; otherwise after which run it was found to be missing.
    pub round: usize,
}

/// Additional results of front tracking; the keys are on the level of those of [`Summary`].
#[derive(Debug, Clone, Copy, Serialize)]
pub struct TrackingSummary {
    /// Smallest stress jump that is tracked as a front of its own, relative to `stress_scale`.
    pub front_tolerance: f64,
    /// Largest stress that the scene's data can reach, Pa.
    #[serde(rename = "stress_scale_Pa")]
    pub stress_scale: f64,
    /// Fronts in the bar at the end.
    pub fronts_under_way: usize,
    /// events / `step_wall_s`.
    pub events_per_s: f64,
}

/// How a scene with a tolerance came to its method and resolution.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ChoiceSummary {
    /// What was asked for.
    pub tolerance: f64,
    /// One sentence.
    pub why: String,
    /// Pilots and runs that missed, method by method, and then the run itself.
    pub tried: Vec<Tried>,
}

/// A method and how finely it worked.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct SolvedBy {
    /// "fd" or "moc".
    pub method: String,
    /// "leapfrog", "muscl", "front-tracking" or "characteristic-net".
    pub scheme: String,
    /// Cells of the bar.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub cells: Option<usize>,
    /// Front tolerance.
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

/// A pilot, or a run.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Tried {
    /// By what.
    #[serde(flatten)]
    pub by: SolvedBy,
    /// Estimate of its error.
    pub estimate: Option<f64>,
    /// Cell-steps or events.
    pub work: u64,
}

/// The ends of a bar in torsion at the end time; stresses, strains and velocities of the summary are those of its surface.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct TorsionSummary {
    /// The surface's radius (of thin tubes the mean one), m.
    pub radius_m: f64,
    /// Torque at the left and the right end, N m.
    #[serde(rename = "torque_N_m")]
    pub torque: [f64; 2],
    /// Their angular velocities, rad/s.
    pub angular_velocity_rad_s: [f64; 2],
}

/// The state at an end.
#[derive(Debug, Clone, Copy, Serialize)]
pub struct EndSummary {
    /// Pa.
    #[serde(rename = "stress_Pa")]
    pub stress: f64,
    /// Engineering strain: by fd four cells inside the bar, by moc right at the end.
    pub strain: f64,
    /// m/s.
    #[serde(rename = "velocity_m_s")]
    pub velocity: f64,
    /// Velocity of the striker there, m/s; left out where there is none.
    #[serde(rename = "striker_velocity_m_s", skip_serializing_if = "Option::is_none")]
    pub striker: Option<f64>,
}

/// A rupture in the summary.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct RuptureSummary {
    /// "left end", "right end", "joint 1", ..., "segment 1", ...
    pub site: String,
    /// What it broke of.
    pub cause: Cause,
    /// When.
    pub time_s: f64,
    /// Where in the undeformed bar.
    pub x_m: f64,
    /// Stress there as it broke, Pa.
    #[serde(rename = "stress_Pa")]
    pub stress: f64,
    /// Nominal strain there.
    pub strain: f64,
    /// Energy that had been absorbed there, J/m^3.
    #[serde(rename = "absorbed_J_m3")]
    pub absorbed: f64,
    /// Strain energy and plastic work of the whole bar just then, J (per m^2 where the scene gives no area).
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

/// A front in the summary.
#[derive(Debug, Clone, Serialize)]
pub struct FrontSummary {
    /// Where it started.
    pub origin: String,
    /// Strain ahead.
    pub strain_ahead: f64,
    /// Strain behind.
    pub strain_behind: f64,
    /// Pa.
    #[serde(rename = "stress_ahead_Pa")]
    pub stress_ahead: f64,
    /// Pa.
    #[serde(rename = "stress_behind_Pa")]
    pub stress_behind: f64,
    /// By theory, m/s.
    #[serde(rename = "speed_m_s")]
    pub speed: f64,
    /// Read off the field, m/s; null where it could not be followed.
    #[serde(rename = "speed_measured_m_s")]
    pub speed_measured: Option<f64>,
    /// Where it was last seen, m from the left end; null where it never was.
    #[serde(rename = "position_m")]
    pub position: Option<f64>,
    /// When that was.
    pub last_seen_s: Option<f64>,
}

/// The elastic check, sigma = rho c0 v.
#[derive(Debug, Clone, Copy, Serialize)]
pub struct ElasticCheck {
    /// Simulated stress behind the front, Pa.
    #[serde(rename = "stress_Pa")]
    pub stress: f64,
    /// rho c0 v with its sign, Pa.
    #[serde(rename = "expected_Pa")]
    pub expected: f64,
    /// |stress - expected| / |expected|.
    pub relative: f64,
}

/// What the ledger could not account for.
#[derive(Debug, Clone, Copy, Serialize)]
pub struct LedgerSummary {
    /// Largest energy residual of the run, relative.
    pub energy_residual: f64,
    /// Largest momentum residual of the run, relative.
    pub momentum_residual: f64,
}

/// An error figure.
#[derive(Debug, Clone, Serialize)]
pub struct ErrorFigure {
    /// The figure.
    pub value: f64,
    /// What was measured, e.g. "relative L1 of stress over the bar at the end time".
    pub measure: String,
    /// Against what.
    pub reference: String,
    /// Errors one by one, where they are known; the figure is the largest of them then.
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
