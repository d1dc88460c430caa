//! The method of characteristics for rate-independent bars: wave-front tracking with unloading.
//!
//! The law is piecewise linear, so that piecewise constant data have a piecewise constant solution, bounded by straight fronts in (x, t). The fronts
//! are followed from one interaction to the next. Where they meet, or reach an end, a joint or a place where histories differ, a Riemann problem
//! ([`crate::wave::riemann`]) gives the waves that leave. There is no grid and no numerical diffusion: the solution is exact for the table, to
//! rounding. This is the graphical method of Bohnenblust with the bookkeeping of Holden and Risebro (Front Tracking for Hyperbolic Conservation
//! Laws).

mod at_end;
mod breaking;
mod compare;
mod contact;
mod end;
mod front_segment;
mod front_segments;
mod interaction;
mod joint_clock;
mod known_limits;
mod later_fans;
mod limits;
mod list;
mod merge_fronts;
mod merging;
mod nearness;
mod openings;
mod place;
mod ramp;
mod read;
mod resolve;
mod rupture;
mod sample;
mod scale;
mod shift;
mod snapshot;
mod step_control;
mod stepping;
mod sums;
mod tracking;

pub use end::{EndRecord, EndStep, StrikerState};
pub use front_segment::FrontSegment;
pub use joint_clock::{JointChange, JointState};
pub use known_limits::PointAtLimit;
pub use openings::Opening;
pub use read::{Front, Piece, Sample};
pub use sums::Balance;
pub use tracking::FrontTracking;

/// Settings of a front-tracking run.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Settings {
    /// Tolerance for merging waves, >= 0: neighbouring waves of one kind are merged if that changes the solution by less than about the square of
    /// this value times [`FrontTracking::stress_scale`] times the length. Momentum and displacement are conserved; the error of the stress is of
    /// about this order. With 0 every wave is kept.
    pub front_tolerance: f64,
    /// Height of the steps that replace ramps of an end's history, relative to [`FrontTracking::stress_scale`] (velocities by the elastic impedance);
    /// strikers and springs take steps of similar effect. The error is proportional to its square. `None` uses the front tolerance, or, below
    /// [`RAMP_STEP`], the geometric mean of the two, so that the error of ramps is proportional to the tolerance; but at least [`FINEST_STEP`], which
    /// also applies to a tolerance of 0. No step of a ramp is shorter than 1e-6 of the elastic transit time of the bar.
    pub ramp_step: Option<f64>,
    /// Largest number of events of a run.
    pub event_budget: u64,
    /// Whether the front segments of ended fronts are kept for [`FrontTracking::take_front_segments`].
    pub front_segments: bool,
    /// Whether the run ends with [`Stopped::AtLimit`] at the end of the data of a material. Otherwise such points are only recorded, see
    /// [`FrontTracking::limits_reached`].
    pub stop_at_limits: bool,
}

/// Error of a coarser companion run relative to that of the run, and of the run relative to that of a finer one.
pub const COMPANION_RATIO: f64 = 3.0;

/// Front tolerance below which the step of ramps decreases only with the square root of the tolerance.
pub const RAMP_STEP: f64 = 1e-3;

/// Smallest default step of ramps for any front tolerance: the number of wave crossings increases with its inverse square.
pub const FINEST_STEP: f64 = 1e-4;

impl Settings {
    /// Returns the step of ramps for these settings; a larger front tolerance never gives a smaller step.
    pub fn step(&self) -> f64 {
        let finer = (RAMP_STEP * self.front_tolerance).sqrt();
        self.ramp_step.unwrap_or_else(|| self.front_tolerance.max(finer).max(FINEST_STEP))
    }

    /// Returns the settings of a companion run with [`COMPANION_RATIO`] times the error.
    #[must_use]
    pub fn coarser(self) -> Self {
        let front_tolerance = COMPANION_RATIO * self.front_tolerance;
        Self { front_tolerance, ramp_step: Some(front_tolerance.max(self.step_factor() * self.step())), ..self }
    }

    /// Returns the settings of a companion run with the error divided by [`COMPANION_RATIO`].
    #[must_use]
    pub fn finer(self) -> Self {
        let front_tolerance = self.front_tolerance / COMPANION_RATIO;
        Self { front_tolerance, ramp_step: Some(front_tolerance.max(self.step() / self.step_factor())), ..self }
    }

    /// Returns the factor between the ramp steps of companion runs. The error of merged waves is proportional to the tolerance, that of ramps to the
    /// square of their steps, which are larger than tolerances below [`RAMP_STEP`].
    fn step_factor(&self) -> f64 {
        if self.front_tolerance < self.step() { COMPANION_RATIO.sqrt() } else { COMPANION_RATIO }
    }
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            front_tolerance: 0.0,
            ramp_step: None,
            event_budget: 10_000_000,
            front_segments: false,
            stop_at_limits: false,
        }
    }
}

/// Reason why a run stopped before its end.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum Stopped {
    /// More events than allowed. The bar is valid at the time reached and can be read.
    #[error("front tracking reached its limit of {events} events at t = {time:.6e} s with {fronts} active fronts")]
    EventBudget {
        /// Time reached, s.
        time: f64,
        /// Events so far.
        events: u64,
        /// Number of active fronts.
        fronts: usize,
    },
    /// A stress or velocity that is not finite.
    #[error("front tracking found a state that is not a number at t = {time:.6e} s, x = {x:.6e} m")]
    NotANumber {
        /// Time, s.
        time: f64,
        /// Position, m.
        x: f64,
    },
    /// A point that reached the end of the data of its material.
    #[error("front tracking reached the end of the material data at t = {:.6e} s, x = {:.6e} m", .0.time, .0.x)]
    AtLimit(PointAtLimit),
}
