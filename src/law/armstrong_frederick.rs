//! Nonlinear kinematic hardening (Armstrong and Frederick): the back stress tends to a limit in the sense of the flow.

use super::rate::Piece;
use super::{Backbone, CellLaw, Response};
use crate::root::{Tolerance, fixed_point};

/// Law with a back stress a that obeys `da = C d(eps_p) - gamma a dp`. On first loading it is `a0(p) = (C/gamma)(1 - exp(-gamma p))`. The half width
/// of the elastic range is `f(p) - a0(p)`, so that first loading follows the curve f whatever C and gamma are; p is the accumulated plastic strain.
///
/// A point that flows by d in the sense s obeys `s sigma = f(p + d) + (s a - a0(p)) exp(-gamma d)`: the curve, plus the difference of the back
/// stress from its value on first loading. On first loading the difference is zero, and one table evaluation gives the stress. After a reversal, d
/// is found by the secant method within a bracket.
///
/// State: `[E p accumulated, E eps_p signed, a, a0(p)]`. Requires the same curve in tension and compression.
///
/// Reference: P. J. Armstrong, C. O. Frederick 1966 (CEGB report RD/B/N 731; Materials at High Temperatures 24, 2007, 1).
#[derive(Debug, Clone)]
pub struct ArmstrongFrederick<B> {
    backbone: B,
    back: BackStress,
}

/// Constants of a back stress, with plastic strains in stress units (E times the strain).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BackStress {
    /// Rise of the back stress per plastic strain on first loading, C/E, > 0.
    rise: f64,
    /// Recall constant gamma/E, 1/Pa, > 0.
    recall: f64,
}

impl BackStress {
    /// Builds the constants from C (Pa), gamma and the elastic modulus (Pa), all > 0.
    pub fn new(c: f64, gamma: f64, modulus: f64) -> Self {
        Self { rise: c / modulus, recall: gamma / modulus }
    }

    /// Returns a0 after first loading to E times the plastic strain `p` (Pa), Pa.
    #[inline(always)]
    pub fn first_loading(&self, p: f64) -> f64 {
        -(self.rise / self.recall) * (-self.recall * p).exp_m1()
    }

    /// Returns d a0/dp at `p`.
    fn slope(&self, p: f64) -> f64 {
        self.rise * (-self.recall * p).exp()
    }

    /// Returns the `p` at which d a0/dp equals `slope`, Pa. `None` if it is smaller everywhere.
    fn with_slope(&self, slope: f64) -> Option<f64> {
        (slope < self.rise).then(|| (self.rise / slope).ln() / self.recall)
    }

    /// Returns E times the plastic strain (Pa) at which the elastic range would vanish because a0 reaches the flow stress; `None` if it does not.
    /// `pieces` are those of f(p), of which the last one is unbounded.
    pub fn uses_up(&self, pieces: &[Piece]) -> Option<f64> {
        let ends = pieces.iter().skip(1).map(|piece| piece.start).chain([f64::INFINITY]);
        pieces.iter().zip(ends).find_map(|(&Piece { start, stress, slope }, end)| {
            // f - a0 is convex along a piece: its minimum is where the slopes agree.
            let lowest =
                if self.slope(start) <= slope { start } else { self.with_slope(slope).unwrap_or(start).min(end) };
            (stress + slope * (lowest - start).min(f64::MAX) <= self.first_loading(lowest)).then_some(lowest)
        })
    }
}

impl<B: Backbone> ArmstrongFrederick<B> {
    /// Builds the law. `back` must leave an elastic range along the whole backbone, see [`BackStress::uses_up`].
    pub fn new(backbone: B, back: BackStress) -> Self {
        Self { backbone, back }
    }
}

impl<B: Backbone> CellLaw<4> for ArmstrongFrederick<B> {
    #[inline(always)]
    fn base(&self, sigma: f64, _state: [f64; 4]) -> f64 {
        sigma
    }

    #[inline]
    fn respond(&self, _sigma: f64, predictor: f64, [p, signed, back, first]: [f64; 4]) -> Response<4> {
        let sense = 1.0_f64.copysign(predictor - back);
        let trial = sense * predictor;
        // Back stress minus its value on first loading, <= 0 up to rounding.
        let lacks = sense * back - first;
        let flow = |lacks: f64| {
            let z = trial - lacks + p;
            z - p - self.backbone.yielding_stress(z, sense)
        };
        let most = flow(lacks);
        // False for NaN: along a curve that never yields, both terms of the flow are infinite.
        let yields = most > 0.0;
        if !yields {
            return Response { sigma: predictor, state: [p, signed, back, first], plastic: 0.0 };
        }
        let fades = |flow: f64| lacks * (-self.back.recall * flow).exp();
        let tolerance = Tolerance::of_differences(trial.abs() + p);
        let flow = fixed_point(most, [0.0, most], tolerance, |d| flow(fades(d)).max(0.0));
        let (plastic, first) = (sense * flow, self.back.first_loading(p + flow));
        let state = [p + flow, signed + plastic, sense * (first + fades(flow)), first];
        Response { sigma: predictor - plastic, state, plastic }
    }

    #[inline(always)]
    fn plastic_strain(&self, state: [f64; 4]) -> f64 {
        state[1]
    }

    #[inline(always)]
    fn accumulated(&self, state: [f64; 4]) -> f64 {
        state[0]
    }

    #[inline(always)]
    fn back_stress(&self, state: [f64; 4]) -> f64 {
        state[2]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::law::{Searched, Table};
    use crate::material::{Beyond, Curve};

    const E: f64 = 200e9;
    const C: f64 = 30e9;
    const GAMMA: f64 = 200.0;

    fn law() -> ArmstrongFrederick<Searched> {
        let curve = Curve::new(&[(0.001, 200e6), (0.01, 320e6), (0.1, 400e6)], Beyond::Extend).expect("rows rise");
        ArmstrongFrederick::new(Searched(Table::new(&curve, E)), BackStress::new(C, GAMMA, E))
    }

    /// Strains a point in steps to each of several strains in turn. Returns stress, plastic strain and back stress at each of them.
    fn path(strains: &[f64], steps: usize) -> Vec<[f64; 3]> {
        let (law, mut sigma, mut state, mut from) = (law(), 0.0, [0.0; 4], 0.0);
        let mut at = |to: f64| {
            for _ in 0..steps {
                let after = law.respond(sigma, sigma + E * (to - from) / steps as f64, state);
                (sigma, state) = (after.sigma, after.state);
            }
            from = to;
            [sigma, state[1] / E, state[2]]
        };
        strains.iter().map(|to| at(*to)).collect()
    }

    #[test]
    fn first_loading_follows_the_curve() {
        for (strain, stress) in [(5e-4, 100e6), (0.001, 200e6), (0.01, 320e6), (0.055, 360e6), (0.2, 489e6)] {
            let [[sigma, plastic, back]] = path(&[strain], 7)[..] else { panic!("one strain") };
            let expected = if strain > 0.1 { 400e6 + (strain - 0.1) * 80e6 / 0.09 } else { stress };
            assert!((sigma - expected).abs() < 1e-6 * expected, "{strain}: {sigma:e} {expected:e}");
            let limit = C / GAMMA * (1.0 - (-GAMMA * plastic).exp());
            assert!((back - limit).abs() < 1e-9 * C, "{strain}: {back:e} {limit:e}");
        }
    }

    /// The step is exact: a reversal and the return give the same result in one step as in a thousand.
    #[test]
    fn the_length_of_the_steps_makes_no_difference() {
        let strains = [0.02, -0.01, 0.015, -0.05];
        for (one, many) in path(&strains, 1).iter().zip(path(&strains, 1000)) {
            for (a, b) in one.iter().zip(many) {
                assert!((a - b).abs() < 1e-9 * a.abs(), "{one:?} {many:?}");
            }
        }
    }

    /// After a reversal at p0 the stress is `-f(p) + 2 a0(p0) exp(-gamma (p - p0))`: reverse flow begins early, and tends to the curve.
    #[test]
    fn reverse_flow_has_its_closed_form() {
        let flow_stress = |p: f64| {
            let [first, second] = [120e6 / 0.009, 80e6 / 0.09].map(|slope| slope / (1.0 - slope / E));
            let knot = 0.01 - 320e6 / E;
            if p < knot { 200e6 + first * p } else { 320e6 + second * (p - knot) }
        };
        for reverse in [0.012, -0.02, -0.06] {
            let [[_, start, back], [sigma, end, _]] = path(&[0.02, reverse], 50)[..] else { panic!("two strains") };
            let flowed = start - end;
            let expected = -flow_stress(start + flowed) + 2.0 * back * (-GAMMA * flowed).exp();
            assert!(flowed > 0.0, "{reverse}: no reverse flow");
            assert!((sigma - expected).abs() < 1e-9 * flow_stress(start), "{reverse}: {sigma:e} {expected:e}");
        }
    }

    #[test]
    fn a_back_stress_above_the_curve_leaves_no_elastic_range() {
        let piece = |start, stress, slope| Piece { start, stress, slope };
        let level = [piece(0.0, 200e6, 0.0)];
        assert_eq!(BackStress::new(30e9, 200.0, E).uses_up(&level), None);
        assert!(BackStress::new(30e9, 100.0, E).uses_up(&level).is_some());
        // The elastic range vanishes only between 0 and the plastic strain at which the slopes agree.
        let rising = [piece(0.0, 100e6, 0.001), piece(E * 0.05, 110e6, 0.1)];
        assert!(BackStress::new(30e9, 200.0, E).uses_up(&rising).is_some_and(|p| p > 0.0 && p < E * 0.05));
    }
}
