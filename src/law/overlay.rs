//! Multilinear kinematic hardening: elastic-perfectly-plastic elements in parallel (Besseling), one table evaluation in most steps.

use super::reversals::NUMBERS;
use super::{Backbone, CellLaw, Response, Reversals, Table};
use crate::material::Sense;

/// Kinematic hardening along a curve of several lines by Masing's rule, see [`Reversals`].
///
/// State: `[E p accumulated, E eps_p signed]` and the open reversals. The elastic range is `2 sigma_y` wide and ends where the
/// point last flowed. Requires the same curve in tension and compression, with falling slopes. For a curve of two lines it equals
/// [`super::Mixed`] with `kinematic` = 1, which is faster.
#[derive(Debug, Clone)]
pub struct Overlay<B> {
    backbone: B,
    yield_stress: f64,
    last_knot: f64,
}

/// Number of state variables of [`Overlay`].
pub const OVERLAY: usize = 2 + NUMBERS;

impl<B: Backbone> Overlay<B> {
    /// Builds the law. `backbone` must evaluate `table`.
    pub fn new(backbone: B, table: &Table) -> Self {
        let lines = table.lines();
        Self { backbone, yield_stress: table.yield_stress(), last_knot: lines[lines.len() - 1].start }
    }
}

fn split(state: [f64; OVERLAY]) -> (f64, f64, Reversals) {
    let [accumulated, plastic, reversals @ ..] = state;
    (accumulated, plastic, Reversals::of(&reversals))
}

impl<B: Backbone> CellLaw<OVERLAY> for Overlay<B> {
    #[inline(always)]
    fn base(&self, sigma: f64, _state: [f64; OVERLAY]) -> f64 {
        sigma
    }

    #[inline]
    fn respond(&self, _sigma: f64, predictor: f64, state: [f64; OVERLAY]) -> Response<OVERLAY> {
        let (accumulated, signed, mut reversals) = split(state);
        let strain = predictor + signed;
        let change = strain - reversals.tip();
        let elastic = if reversals.is_virgin() {
            change.abs() <= self.yield_stress
        } else {
            change == 0.0 || (reversals.sense() * change < 0.0 && change.abs() <= 2.0 * self.yield_stress)
        };
        if elastic {
            return Response { sigma: predictor, state, plastic: 0.0 };
        }
        let sense = 1.0_f64.copysign(change);
        // Rounding may lift the branch above the elastic line.
        let stress = reversals.flow_to(&self.backbone, self.last_knot, strain);
        let sigma = if sense * stress < sense * predictor { stress } else { predictor };
        let plastic = predictor - sigma;
        let mut state = [0.0; OVERLAY];
        state[..2].copy_from_slice(&[accumulated + plastic.abs(), signed + plastic]);
        state[2..].copy_from_slice(&reversals.numbers());
        Response { sigma, state, plastic }
    }

    #[inline(always)]
    fn plastic_strain(&self, state: [f64; OVERLAY]) -> f64 {
        state[1]
    }

    #[inline(always)]
    fn accumulated(&self, state: [f64; OVERLAY]) -> f64 {
        state[0]
    }

    fn along_table(&self, state: [f64; OVERLAY]) -> f64 {
        let (.., reversals) = split(state);
        let z = reversals.curve_abscissa(reversals.tip()).abs();
        z - self.backbone.stress(z, 1.0)
    }

    fn back_stress(&self, state: [f64; OVERLAY]) -> f64 {
        let (_, plastic, reversals) = split(state);
        if reversals.is_virgin() { 0.0 } else { reversals.tip() - plastic - reversals.sense() * self.yield_stress }
    }

    fn sense(&self, sigma: f64, state: [f64; OVERLAY]) -> Sense {
        let relative = sigma - self.back_stress(state);
        Sense::of(if relative == 0.0 { split(state).2.sense() } else { relative })
    }

    fn reversals(&self, state: [f64; OVERLAY]) -> Reversals {
        split(state).2
    }
}
