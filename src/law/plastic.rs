//! Plastic flow with elastic unloading: isotropic, kinematic and mixed hardening, one table evaluation per step.
//!
//! With `g(z)` the loading table in stress units (z = E eps), `p = E * accumulated plastic strain` and hardening `h = f - sigma_y`, the stress at the
//! end of a step follows without iteration. A point on the table obeys `p' + sigma_y + h(p') = z`, so that the table read at
//! `z = (elastic predictor) + p` is the solution.

use super::{Backbone, CLOSE_TO_YIELD, CellLaw, Deformed, Response, within};

/// Isotropic hardening: tension and compression harden alike.
///
/// State: `[E p accumulated, E eps_p signed]`. `sigma' = sign(tau) min(|tau|, g(|tau| + E p))` with `tau = sigma + E d_eps`.
#[derive(Debug, Clone)]
pub struct Isotropic<B>(pub B);

/// Number of iterations towards the elastic limit. Each multiplies the error by the slope of the curve over E.
const YIELD_ITERATIONS: usize = 8;

impl<B: Backbone> CellLaw<2> for Isotropic<B> {
    const BOUNDS_ELASTICITY: bool = true;

    /// Curves never fall, so the elastic limit grows with the accumulated plastic strain.
    #[inline(always)]
    fn is_elastic_up_to(&self, size: f64, accumulated: f64) -> bool {
        let size = size * (1.0 + CLOSE_TO_YIELD);
        let [tension, compression] = [1.0, -1.0].map(|sign| self.0.stress(size + accumulated, sign));
        size <= tension && size <= compression
    }

    fn elastic_up_to(&self, yield_stress: f64, cells: impl Iterator<Item = [f64; 2]>) -> f64 {
        let least = cells.map(|state| state[0]).fold(f64::INFINITY, f64::min);
        let curve = |size: f64| self.0.stress(size, 1.0).min(self.0.stress(size, -1.0));
        // The elastic limit is the size at which curve(size + least) = size. Each iterate is closer to it, from below.
        let mut size = yield_stress.max(curve(least));
        for _ in 0..YIELD_ITERATIONS {
            size = curve(size + least);
        }
        let size = within([-size, size]);
        if self.is_elastic_up_to(size, least) { size } else { 0.0 }
    }

    #[inline(always)]
    fn base(&self, sigma: f64, _state: [f64; 2]) -> f64 {
        sigma
    }

    const READS_TABLE: bool = B::AT_ONCE;

    #[inline(always)]
    fn table_abscissa(&self, predictor: f64, [p, _]: [f64; 2]) -> f64 {
        predictor.abs() + p
    }

    #[inline(always)]
    fn interpolate(&self, abscissa: &[f64], predictor: &[f64], table: &mut [f64]) {
        self.0.stresses(abscissa, predictor, table);
    }

    #[inline(always)]
    fn respond(&self, _sigma: f64, predictor: f64, state: [f64; 2]) -> Response<2> {
        self.return_map(predictor, state, self.0.yielding_stress(self.table_abscissa(predictor, state), predictor))
    }

    #[inline(always)]
    fn return_map(&self, predictor: f64, [p, signed]: [f64; 2], table: f64) -> Response<2> {
        let size = predictor.abs();
        let stress = if size < table { size } else { table };
        let sigma = stress.copysign(predictor);
        let plastic = predictor - sigma;
        Response { sigma, state: [p + (size - stress), signed + plastic], plastic }
    }

    fn deformed(&self, deformed: &Deformed) -> [f64; 2] {
        [deformed.accumulated, deformed.plastic]
    }

    #[inline(always)]
    fn plastic_strain(&self, state: [f64; 2]) -> f64 {
        state[1]
    }

    #[inline(always)]
    fn accumulated(&self, state: [f64; 2]) -> f64 {
        state[0]
    }
}

/// Mixed hardening: the fraction `kinematic` (0 to 1) of the hardening moves the elastic range, the rest widens it.
///
/// State: `[E p accumulated, E eps_p signed, back stress a, hardening h]`. With `xi = |tau - a|` the table is read at
/// `z = xi + kinematic h + E p`. Requires the same table in tension and compression. The tangent modulus follows the accumulated
/// plastic strain along the table. With several hardening lines, cycles of constant strain amplitude are therefore neither symmetric nor closed,
/// as they are in [`super::Overlay`]. If `kinematic` > 0.5 and a line is less steep than an earlier one, reverse flow may release
/// more work than was stored.
#[derive(Debug, Clone)]
pub struct Mixed<B> {
    /// Curve of first loading.
    pub backbone: B,
    /// Elastic limit of first loading, Pa.
    pub yield_stress: f64,
    /// Kinematic fraction of the hardening: 0 isotropic, 1 kinematic.
    pub kinematic: f64,
}

impl<B: Backbone> CellLaw<4> for Mixed<B> {
    fn elastic_up_to(&self, _yield_stress: f64, cells: impl Iterator<Item = [f64; 4]>) -> f64 {
        let range = |[_, _, back, h]: [f64; 4]| {
            let half = self.yield_stress + (1.0 - self.kinematic) * h;
            [back - half, back + half]
        };
        cells.map(|state| within(range(state))).fold(f64::INFINITY, f64::min)
    }

    #[inline(always)]
    fn base(&self, sigma: f64, _state: [f64; 4]) -> f64 {
        sigma
    }

    const READS_TABLE: bool = B::AT_ONCE;

    #[inline(always)]
    fn table_abscissa(&self, predictor: f64, [p, _, back, h]: [f64; 4]) -> f64 {
        (predictor - back).abs() + self.kinematic * h + p
    }

    #[inline(always)]
    fn interpolate(&self, abscissa: &[f64], predictor: &[f64], table: &mut [f64]) {
        self.backbone.stresses(abscissa, predictor, table);
    }

    #[inline(always)]
    fn respond(&self, _sigma: f64, predictor: f64, state: [f64; 4]) -> Response<4> {
        self.return_map(
            predictor,
            state,
            self.backbone.yielding_stress(self.table_abscissa(predictor, state), predictor),
        )
    }

    #[inline(always)]
    fn return_map(&self, predictor: f64, [p, signed, back, h]: [f64; 4], table: f64) -> Response<4> {
        let relative = predictor - back;
        let trial = relative.abs() + self.kinematic * h;
        let yields = trial > self.yield_stress + h;
        // If the table is parallel to the elastic line, the plastic strain is constant along it, and rounding may place the trial on either side.
        let reached = if table < trial { table } else { trial };
        let h_new = if yields { reached - self.yield_stress } else { h };
        let back_new = back + (self.kinematic * (h_new - h)).copysign(relative);
        let on_surface = back_new + (self.yield_stress + (1.0 - self.kinematic) * h_new).copysign(relative);
        let sigma = if yields { on_surface } else { predictor };
        let flow = if yields { trial - reached } else { 0.0 };
        let plastic = flow.copysign(relative);
        Response { sigma, state: [p + flow, signed + plastic, back_new, h_new], plastic }
    }

    #[inline(always)]
    fn plastic_strain(&self, state: [f64; 4]) -> f64 {
        state[1]
    }

    #[inline(always)]
    fn back_stress(&self, state: [f64; 4]) -> f64 {
        state[2]
    }

    #[inline(always)]
    fn accumulated(&self, state: [f64; 4]) -> f64 {
        state[0]
    }
}
