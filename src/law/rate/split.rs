//! What the laws that split a step into half a step of flow, the strain increment, and half a step of flow have in common:
//! the first five numbers of their state, and when a cell flows.
//!
//! State: `[E p accumulated, E eps_p signed, E eps_p still to come, signed overstress, work of the overstress times E, ..]`.
//! The first two are those after the half step of flow that follows the stress: what that half step adds is the third, so
//! that the stress need not be asked twice.

/// Overstress below this part of the stresses it is the difference of is rounding and does not flow.
const ROUNDING: f64 = 4.0 * f64::EPSILON;

/// Stands for an overstress that the latest step took away to the last bit.
pub(super) const GONE: f64 = f64::MIN_POSITIVE;

/// How far a stress is beyond the elastic limits, and in which sense (0: the upper one, 1: the lower one); none where it is
/// between them. `back` is the back stress.
#[inline]
pub(super) fn excess(sigma: f64, [low, high]: [f64; 2], back: f64) -> Option<(f64, usize)> {
    let least = ROUNDING * (sigma.abs() + back.abs() + (high - low));
    if sigma - high > least {
        Some((sigma - high, 0))
    } else if low - sigma > least {
        Some((low - sigma, 1))
    } else {
        None
    }
}

/// The signed overstress of an [`excess`].
#[inline]
pub(super) fn signed((excess, sense): (f64, usize)) -> f64 {
    if sense == 0 { excess } else { -excess }
}

/// What [`crate::law::CellLaw`] reads off the state.
macro_rules! readings_of_split_state {
    () => {
        const TAKES_TIME: bool = true;

        #[inline]
        fn base(&self, sigma: f64, state: [f64; N]) -> f64 {
            sigma - state[2]
        }

        #[inline]
        fn plastic_strain(&self, state: [f64; N]) -> f64 {
            state[1] - state[2]
        }

        #[inline]
        fn accumulated(&self, state: [f64; N]) -> f64 {
            state[0] - state[2].abs()
        }

        /// That of the overstress.
        fn sense(&self, sigma: f64, state: [f64; N]) -> $crate::material::Sense {
            $crate::material::Sense::of(if state[3] == 0.0 { sigma } else { state[3] })
        }

        fn yields(&self, _sigma: f64, state: [f64; N]) -> bool {
            state[3] != 0.0
        }

        #[inline]
        fn overstress_work(&self, state: [f64; N]) -> f64 {
            state[4]
        }

        #[inline]
        fn flows(&self, state: [f64; N]) -> bool {
            state[3] != 0.0
        }

        /// The cell is loaded, and at least half of its overstress goes within half a step: it follows the static curve. A
        /// cell that unloaded within the step has no overstress at its end.
        #[inline]
        fn keeps_up(&self, state: [f64; N]) -> bool {
            let left = state[3].abs();
            left == $crate::law::rate::split::GONE || (left > 0.0 && state[2].abs() >= 0.5 * left)
        }
    };
}

pub(super) use readings_of_split_state;
