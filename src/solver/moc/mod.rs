//! The method of characteristics for rate-independent bars: wave-front tracking with unloading.
//!
//! The law is straight between knots, so from piecewise constant data every solution is piecewise constant, bounded
//! by straight fronts in (x, t). The fronts are followed from one interaction to the next; where they meet, or reach an
//! end, a joint or a place where histories differ, a Riemann problem ([`crate::wave::riemann`]) tells what leaves.
//! No grid, no numerical diffusion: exact for the table, to rounding. This is the graphical method of Bohnenblust
//! with the bookkeeping of Holden and Risebro (Front Tracking for Hyperbolic Conservation Laws).

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

/// How a front-tracking run is carried out.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Settings {
    /// How much waves may be merged, >= 0: neighbouring waves of one kind become one where that changes the solution
    /// by less than about the square of this times [`FrontTracking::stress_scale`] times the length. Momentum and
    /// displacement are kept; the error of the stress is of about this order. 0: every wave is kept.
    pub front_tolerance: f64,
    /// Ramps of an end's history are made into steps of this height, relative to [`FrontTracking::stress_scale`]
    /// (velocities by the elastic impedance); strikers and springs take steps of like effect. The error goes with its
    /// square. None: the front tolerance; below [`RAMP_STEP`] the root of their product, so that the error of ramps goes with
    /// the tolerance; never less than [`FINEST_STEP`], which also goes with a tolerance of 0. No step of a ramp is shorter
    /// than 1e-6 of the bar's elastic transit time.
    pub ramp_step: Option<f64>,
    /// Most events that a run may take.
    pub event_budget: u64,
    /// Keep the front segments of fronts that end, for [`FrontTracking::take_front_segments`].
    pub front_segments: bool,
    /// End with [`Stopped::AtLimit`] where nothing is known of a material any more; else such points are only noted, see
    /// [`FrontTracking::passed`].
    pub stop_at_limits: bool,
}

/// The error of a coarser companion, over the run's; that of the run, over a finer companion's.
pub const COMPANION_RATIO: f64 = 3.0;

/// The front tolerance below which the step of ramps falls with the root of the tolerance only.
pub const RAMP_STEP: f64 = 1e-3;

/// The finest step of ramps that goes with any front tolerance: waves cross in numbers that go with its inverse square.
pub const FINEST_STEP: f64 = 1e-4;

impl Settings {
    /// The step of ramps that goes with these settings: never finer for a larger front tolerance.
    pub fn step(&self) -> f64 {
        let finer = (RAMP_STEP * self.front_tolerance).sqrt();
        self.ramp_step.unwrap_or_else(|| self.front_tolerance.max(finer).max(FINEST_STEP))
    }

    /// The settings of a companion with [`COMPANION_RATIO`] times the error.
    #[must_use]
    pub fn coarser(self) -> Self {
        let front_tolerance = COMPANION_RATIO * self.front_tolerance;
        Self { front_tolerance, ramp_step: Some(front_tolerance.max(self.step_factor() * self.step())), ..self }
    }

    /// The settings of a companion with this part of the error.
    #[must_use]
    pub fn finer(self) -> Self {
        let front_tolerance = self.front_tolerance / COMPANION_RATIO;
        Self { front_tolerance, ramp_step: Some(front_tolerance.max(self.step() / self.step_factor())), ..self }
    }

    /// The step of ramps, over that of a companion. The error of merged waves is proportional to the tolerance; that of ramps to the
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

/// Why a run stopped before its end.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum Stopped {
    /// More events than allowed; the bar stands at the time reached and can be read.
    #[error("front tracking reached its limit of {events} events at t = {time:.6e} s with {fronts} active fronts")]
    EventBudget {
        /// Time reached, s.
        time: f64,
        /// Events so far.
        events: u64,
        /// Fronts under way.
        fronts: usize,
    },
    /// A stress or velocity that is not a number.
    #[error("front tracking found a state that is not a number at t = {time:.6e} s, x = {x:.6e} m")]
    NotANumber {
        /// Time, s.
        time: f64,
        /// Place, m.
        x: f64,
    },
    /// A point at which nothing is known of its material any more.
    #[error("front tracking reached the end of the material data at t = {:.6e} s, x = {:.6e} m", .0.time, .0.x)]
    AtLimit(PointAtLimit),
}
