//! Path-independent law sigma = f(eps) in loading and unloading: von Kármán's theory, without elastic unloading.

use super::{Backbone, CellLaw, Response};

/// Path-independent law: the stress follows the loading curve in loading and unloading. Exact as long as no yielded point unloads.
///
/// State: `[E eps_p signed]`, where `E eps_p = E eps - sigma`. The "plastic" work is all work beyond the
/// elastic energy sigma^2/(2E); it is recovered when the strain decreases.
#[derive(Debug, Clone)]
pub struct PathIndependent<B>(pub B);

impl<B: Backbone> CellLaw<1> for PathIndependent<B> {
    #[inline(always)]
    fn base(&self, sigma: f64, [inelastic]: [f64; 1]) -> f64 {
        sigma + inelastic
    }

    /// Always 0: the work along the curve is recovered, so the mean stress applies.
    #[inline(always)]
    fn onset(&self, _: f64, _: [f64; 1], _: &Response<1>) -> f64 {
        0.0
    }

    const READS_TABLE: bool = B::AT_ONCE;

    #[inline(always)]
    fn table_abscissa(&self, predictor: f64, _: [f64; 1]) -> f64 {
        predictor.abs()
    }

    #[inline(always)]
    fn interpolate(&self, abscissa: &[f64], predictor: &[f64], table: &mut [f64]) {
        self.0.stresses(abscissa, predictor, table);
    }

    #[inline(always)]
    fn respond(&self, _sigma: f64, predictor: f64, state: [f64; 1]) -> Response<1> {
        self.return_map(predictor, state, self.0.stress(predictor.abs(), predictor))
    }

    #[inline(always)]
    fn return_map(&self, predictor: f64, [before]: [f64; 1], table: f64) -> Response<1> {
        let sigma = table.copysign(predictor);
        let inelastic = predictor - sigma;
        Response { sigma, state: [inelastic], plastic: inelastic - before }
    }

    #[inline(always)]
    fn plastic_strain(&self, [inelastic]: [f64; 1]) -> f64 {
        inelastic
    }

    /// Returns true also if the strain decreases along the curve.
    fn yields(&self, _sigma: f64, [inelastic]: [f64; 1]) -> bool {
        inelastic != 0.0
    }

    #[inline(always)]
    fn accumulated(&self, [inelastic]: [f64; 1]) -> f64 {
        inelastic.abs()
    }
}
