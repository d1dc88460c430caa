//! Heat in laws on the adiabatic curve: the table includes it, and the temperature follows from the accumulated plastic strain.

use super::{CellLaw, Deformed, Response, Reversals, Steps};
use crate::material::{Heating, Sense};

/// A law over adiabatic tables, with what tells its temperature. Steps as the law itself, and keeps no more state.
///
/// The temperature is that of a cell whose flow went one way all the time; where tension and compression share a curve that
/// is no restriction.
#[derive(Debug, Clone)]
pub struct WithTemperature<L> {
    law: L,
    heating: Heating,
    modulus: f64,
}

impl<L> WithTemperature<L> {
    /// `law` runs on the adiabatic tables of a material of this modulus, Pa.
    pub fn new(law: L, heating: &Heating, modulus: f64) -> Self {
        Self { law, heating: heating.clone(), modulus }
    }
}

impl<L: CellLaw<N>, const N: usize> CellLaw<N> for WithTemperature<L> {
    const TAKES_TIME: bool = L::TAKES_TIME;

    #[inline(always)]
    fn base(&self, sigma: f64, state: [f64; N]) -> f64 {
        self.law.base(sigma, state)
    }

    #[inline(always)]
    fn onset(&self, sigma: f64, state: [f64; N], after: &Response<N>) -> f64 {
        self.law.onset(sigma, state, after)
    }

    #[inline(always)]
    fn turned_work(&self, state: [f64; N], after: &Response<N>) -> f64 {
        self.law.turned_work(state, after)
    }

    const BOUNDS_ELASTICITY: bool = L::BOUNDS_ELASTICITY;

    #[inline(always)]
    fn is_elastic_up_to(&self, size: f64, accumulated: f64) -> bool {
        self.law.is_elastic_up_to(size, accumulated)
    }

    const READS_TABLE: bool = L::READS_TABLE;

    #[inline(always)]
    fn table_abscissa(&self, predictor: f64, state: [f64; N]) -> f64 {
        self.law.table_abscissa(predictor, state)
    }

    #[inline(always)]
    fn interpolate(&self, reach: &[f64], predictor: &[f64], table: &mut [f64]) {
        self.law.interpolate(reach, predictor, table);
    }

    #[inline(always)]
    fn return_map(&self, predictor: f64, state: [f64; N], table: f64) -> Response<N> {
        self.law.return_map(predictor, state, table)
    }

    #[inline(always)]
    fn respond(&self, sigma: f64, predictor: f64, state: [f64; N]) -> Response<N> {
        self.law.respond(sigma, predictor, state)
    }

    #[inline(always)]
    fn respond_to_most<const W: usize>(
        &self,
        sigma: &[f64; W],
        predictor: &[f64; W],
        state: [&[f64; W]; N],
        after: &mut Steps<N, W>,
    ) {
        self.law.respond_to_most(sigma, predictor, state, after);
    }

    #[inline(always)]
    fn respond_to_other(&self, sigma: f64, predictor: f64, state: [f64; N]) -> Response<N> {
        self.law.respond_to_other(sigma, predictor, state)
    }

    #[inline(always)]
    fn plastic_strain(&self, state: [f64; N]) -> f64 {
        self.law.plastic_strain(state)
    }

    #[inline(always)]
    fn accumulated(&self, state: [f64; N]) -> f64 {
        self.law.accumulated(state)
    }

    fn sense(&self, sigma: f64, state: [f64; N]) -> Sense {
        self.law.sense(sigma, state)
    }

    fn yields(&self, sigma: f64, state: [f64; N]) -> bool {
        self.law.yields(sigma, state)
    }

    fn back_stress(&self, state: [f64; N]) -> f64 {
        self.law.back_stress(state)
    }

    fn along_table(&self, state: [f64; N]) -> f64 {
        self.law.along_table(state)
    }

    fn reversals(&self, state: [f64; N]) -> Reversals {
        self.law.reversals(state)
    }

    fn overstress_work(&self, state: [f64; N]) -> f64 {
        self.law.overstress_work(state)
    }

    fn flows(&self, state: [f64; N]) -> bool {
        self.law.flows(state)
    }

    fn keeps_up(&self, state: [f64; N]) -> bool {
        self.law.keeps_up(state)
    }

    fn deformed(&self, deformed: &Deformed) -> [f64; N] {
        self.law.deformed(deformed)
    }

    fn temperature(&self, state: [f64; N]) -> f64 {
        let sense = Sense::of(self.law.plastic_strain(state));
        self.heating.temperature(sense, self.law.accumulated(state) / self.modulus)
    }

    fn heat_fraction(&self) -> f64 {
        self.heating.fraction
    }
}
