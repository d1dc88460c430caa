//! The method of characteristics for rate-independent bars: wave-front tracking with unloading.
//!
//! The law is straight between knots, so from piecewise constant data every solution is piecewise constant, bounded
//! by straight fronts in (x, t). The fronts are followed from one meeting to the next; where they meet, or reach an
//! end, a joint or a place where histories differ, a Riemann problem ([`crate::wave::riemann`]) tells what leaves.
//! No grid, no numerical diffusion: exact for the table, to rounding. This is the graphical method of Bohnenblust
//! with the bookkeeping of Holden and Risebro (Front Tracking for Hyperbolic Conservation Laws).

mod end;
mod list;
mod read;
mod resolve;
mod sample;
mod sums;
mod tracking;
mod trail;

pub use end::{EndRecord, EndStep, stepped};
pub use read::{Front, Piece, Sample};
pub use sample::Opening;
pub use sums::Balance;
pub use tracking::FrontTracking;
pub use trail::Trail;

/// How a front-tracking run is carried out.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Settings {
    /// Waves weaker than this, relative to [`FrontTracking::stress_scale`], are held back where they arise, as a
    /// velocity jump at rest, until the next front passes. 0: every wave is sent.
    pub front_tolerance: f64,
    /// Most events that a run may take.
    pub event_budget: u64,
    /// Keep the trails of fronts that end, for [`FrontTracking::take_trails`].
    pub trails: bool,
}

impl Default for Settings {
    fn default() -> Self {
        Self { front_tolerance: 0.0, event_budget: 10_000_000, trails: false }
    }
}

/// Why a bar cannot be tracked.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum Unsupported {
    /// A joint that can open.
    #[error("front tracking does not yet follow a joint that can open (joint {0}, counted from 1)")]
    ContactJoint(usize),
    /// A history with a ramp.
    #[error("front tracking needs histories in steps; the {0} end's history has a ramp")]
    Ramp(&'static str),
}

/// Why a run stopped before its end.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum Stopped {
    /// More events than allowed; the bar stands at the time reached and can be read.
    #[error("front tracking used its {events} events and reached t = {time:.6e} s: {fronts} fronts were under way")]
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
}
