//! Rate-dependent plastic flow: plastic strain rate as a function of the overstress above the static curve.
//!
//! `E d eps_p/dt = q(x, f)` with the overstress `x = |sigma - a| - r > 0`; no flow where x <= 0. Here f(p) is the static
//! flow stress at the accumulated plastic strain (the loading table), `h = f - sigma_y` its hardening, and b the kinematic
//! fraction: `r = sigma_y + (1 - b) h` is half the elastic range, and the back stress a changes by `da = b dh` in the sense of the flow. So
//! on first loading x = |sigma| - f whatever b is. Between the elastic limits nothing flows: unloading is elastic.
//! The functions q are those of [`Overstress`].
//!
//! While a cell flows, its stress falls by a fixed share of its plastic flow p (the share depends on the surroundings: 1 in a
//! cell of given strain), and the loading raises its stress at a rate that is constant over the step:
//!
//! ```text
//!   dx/dt = rise/time - (share + df/dp) q(x, f)
//! ```
//!
//! [`RateLaw::strained`] solves this over a step with the static curve straight between the start and the end of the step ([`Overstress::flow`]
//! along that line); both ends are on the curve, knots included. It is of second order in the step where the step resolves the relaxation. A
//! step that is long compared with the relaxation time ends at the overstress of its own rate of flow, or without loading on the
//! static curve. Any step is stable and dissipative. [`RateLaw::flow`] computes the flow of a node of characteristics.
//!
//! Limits: a stress jump that meets a cell which already flows is treated as a ramp over the step. This is exact for Malvern's law;
//! for the other laws, the flow in that step has an error whose relative size does not decrease with the step.
//!
//! References: V. V. Sokolovsky 1948 (Prikl. Mat. Mekh. 12, 261); L. E. Malvern 1951 (J. Appl. Mech. 18, 203);
//! N. Cristescu 1967 (Dynamic Plasticity, North-Holland).

mod cell;
mod closed;
mod driven;
mod hardening;
mod heated;
mod malvern_batch;
mod node;
mod overstress;
mod secant_batch;
mod step;

pub use cell::Timed;
use closed::{Closed, JohnsonCook, Malvern, PowerAboveOne};
pub use driven::Driven;
use driven::relaxed;
use hardening::Sides;
pub use hardening::{Hardening, Piece};
pub use heated::Heated;
pub use node::NodeStep;
pub use overstress::Overstress;
#[cfg(test)]
pub(super) use secant_batch::tests::{LAWS, heating};
use serde::{Deserialize, Serialize};

use super::{Deformed, Table};
use crate::root::{Tolerance, fixed_point};

/// Smallest share used in the bound of the flow; also the smallest static stress at the start of a flow, relative to that at its end.
const LEAST_SHARE: f64 = 1e-12;

/// Plastic history of a cell.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub struct History {
    /// E times the accumulated plastic strain, Pa, >= 0.
    pub accumulated: f64,
    /// E times the signed plastic strain, Pa.
    pub signed: f64,
    /// Back stress, Pa.
    pub back: f64,
    /// Indices of the pieces of the static curves (tension, compression) reached so far.
    piece: [u32; 2],
}

/// Plastic flow of a cell or node in a step.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Flow {
    /// E times the signed plastic strain of the step, Pa.
    pub plastic: f64,
    /// Part of it that precedes the instant at which the node is evaluated, Pa.
    pub before: f64,
    /// E times the work of the overstress, per volume, Pa^2, >= 0.
    pub overstress: f64,
    /// E times the energy dissipated by the scheme, per volume, Pa^2, >= 0.
    pub numerical: f64,
}

impl Flow {
    /// Returns the mean of two flows that one node could have.
    #[must_use]
    pub fn mean(&self, other: &Self) -> Self {
        let half = |a: f64, b: f64| 0.5 * (a + b);
        Self {
            plastic: half(self.plastic, other.plastic),
            before: half(self.before, other.before),
            overstress: half(self.overstress, other.overstress),
            numerical: half(self.numerical, other.numerical),
        }
    }
}

/// A step of fixed length and share, with precomputed coefficients.
#[derive(Debug, Clone, PartialEq)]
pub struct RelaxationStep {
    share: f64,
    time: f64,
    /// For laws that are linear in the overstress: the result of [`relaxed`] for each piece of the static curves.
    parts: [Vec<[f64; 2]>; 2],
}

/// Overstress law, and the change of the static curve over a flow.
#[derive(Debug, Clone, Copy)]
struct Course {
    law: Overstress,
    /// Rise of the elastic limit over the flow, Pa.
    limit: f64,
    /// Static flow stress of first loading before and after the flow, Pa.
    flow_stress: [f64; 2],
}

impl Course {
    /// Returns the flow if the static curve changes as it does along a flow of `flow` > 0. The curve is taken as straight between the
    /// ends. A law that needs the static stress is a function of x/f, evaluated at the end with the f of the end.
    fn answer(&self, driven: Driven, share: f64, flow: f64) -> f64 {
        let Driven { excess, rise, time } = driven;
        if flow <= 0.0 {
            return self.law.flow(driven, share, self.flow_stress[0]);
        }
        let [start, end] = self.flow_stress;
        let (gain, f) = (share + self.limit / flow, 0.5 * (start + end));
        if !self.law.needs_static_stress() {
            return self.law.flow(driven, gain, f);
        }
        // With u = x/f: f du = rise - (gain + u df/dp) dp.
        let left = (excess + rise - share * flow - self.limit).max(0.0);
        // The static stress starts at f = 0 if the curve leaves the elastic line at the origin.
        let over = |x: f64, f: f64| x / f.max(LEAST_SHARE * end);
        let mean = 0.5 * (over(excess, start) + over(left, end));
        let driven = Driven { excess: over(excess, start) * f, rise, time };
        self.law.flow(driven, gain + mean * (end - start) / flow, f)
    }
}

/// A rate-dependent law above a static curve.
#[derive(Debug, Clone, PartialEq)]
pub struct RateLaw {
    overstress: Overstress,
    /// Static curve in tension, and in compression if it has a curve of its own.
    hardening: Vec<Hardening>,
    kinematic: f64,
}

impl RateLaw {
    /// Builds the law from the loading tables. `compression` is given only if it differs; `kinematic` (0 to 1) must then be 0.
    pub fn new(overstress: Overstress, tension: &Table, compression: Option<&Table>, kinematic: f64) -> Self {
        let hardening = std::iter::once(tension).chain(compression).map(Hardening::new).collect();
        Self { overstress, hardening, kinematic }
    }

    /// Returns the static curve for a sense: 0 tension, 1 compression.
    fn side(&self, sense: usize) -> &Hardening {
        &self.hardening[sense.min(self.hardening.len() - 1)]
    }

    /// Builds a history from E times the accumulated and the signed plastic strain, and the back stress, Pa.
    #[inline]
    pub fn history(&self, accumulated: f64, signed: f64, back: f64) -> History {
        let first = self.side(0).find(accumulated);
        let second = if self.hardening.len() > 1 { self.side(1).find(accumulated) } else { first };
        History { accumulated, signed, back, piece: [first, second] }
    }

    /// Returns the history after slow loading and unloading. A back stress is that of first loading.
    pub fn deformed(&self, deformed: &Deformed) -> History {
        let Deformed { plastic, accumulated, .. } = *deformed;
        let mut history = History::default();
        self.advance(plastic.abs(), usize::from(plastic < 0.0), &mut history);
        if self.kinematic == 0.0 && accumulated > plastic.abs() {
            return self.history(accumulated, plastic, 0.0);
        }
        history
    }

    /// Returns the lower and the upper stress between which a cell is elastic, Pa.
    #[inline]
    pub fn limits(&self, history: &History) -> [f64; 2] {
        let limit = |sense: usize| -> f64 {
            let side = self.side(sense);
            let f = side.pieces()[history.piece[sense] as usize].at(history.accumulated);
            if self.kinematic == 0.0 || f == f64::INFINITY { f } else { f - self.kinematic * (f - side.yield_stress()) }
        };
        let up = limit(0);
        let down = if self.hardening.len() == 1 { up } else { limit(1) };
        [history.back - down, history.back + up]
    }

    /// Returns the static flow stress of first loading at a cell's plastic strain, Pa; sense 0 tension, 1 compression.
    pub fn static_stress(&self, history: &History, sense: usize) -> f64 {
        self.side(sense).pieces()[history.piece[sense] as usize].at(history.accumulated)
    }

    /// Returns the slope d f/dp of [`Self::static_stress`].
    fn slope(&self, history: &History, sense: usize) -> f64 {
        self.side(sense).pieces()[history.piece[sense] as usize].slope
    }

    /// Returns the largest elastic limit that a cell can reach by flow in one sense (0 tension, 1 compression), Pa: infinite unless the static curve
    /// ends with slope 0.
    pub fn largest_limit(&self, sense: usize, history: &History) -> f64 {
        let back = if sense == 0 { history.back } else { -history.back };
        let known = self.kinematic * (self.static_stress(history, sense) - self.side(sense).yield_stress());
        match self.side(sense).pieces() {
            [.., last] if last.slope == 0.0 => back + last.stress - known,
            _ => f64::INFINITY,
        }
    }

    /// Returns the overstress law.
    pub fn overstress(&self) -> Overstress {
        self.overstress
    }

    /// Returns the static curves of tension and compression.
    #[inline(always)]
    fn curves(&self) -> Sides<'_> {
        Sides([self.side(0), self.side(1)])
    }

    /// Returns the kinematic fraction of the hardening, and the elastic limit of first loading, Pa; both 0 if the fraction is 0 or the limit
    /// infinite.
    #[inline(always)]
    fn moving(&self) -> [f64; 2] {
        let yield_stress = self.side(0).yield_stress();
        if self.kinematic > 0.0 && yield_stress.is_finite() { [self.kinematic, yield_stress] } else { [0.0; 2] }
    }

    /// Prepares steps of length `time` in which the stress falls by `share` of the flow.
    pub fn relaxation_step(&self, share: f64, time: f64) -> RelaxationStep {
        let parts = [0, 1].map(|sense| match self.overstress {
            Overstress::Malvern { k } => {
                self.side(sense).pieces().iter().map(|piece| relaxed(k, share + piece.slope, time)).collect()
            }
            _ => Vec::new(),
        });
        RelaxationStep { share, time, parts }
    }

    /// Returns the flow of a cell at the upper (`sense` 0) or lower (1) elastic limit or `driven.excess` beyond it, whose stress changes
    /// by `driven.rise` in that sense and falls by `share` (>= 0) of the flow: E times plastic strain, Pa, >= 0.
    #[inline]
    pub fn strained(&self, driven: Driven, share: f64, sense: usize, history: &History) -> f64 {
        self.strained_by_part(driven, share, None, sense, history)
    }

    /// Computes [`Self::strained`] for a whole step prepared by [`Self::relaxation_step`].
    #[inline]
    pub fn strained_at(
        &self,
        relaxation_step: &RelaxationStep,
        [excess, rise]: [f64; 2],
        sense: usize,
        history: &History,
    ) -> f64 {
        let part = relaxation_step.parts[sense].get(history.piece[sense] as usize).copied();
        self.strained_by_part(
            Driven { excess, rise, time: relaxation_step.time },
            relaxation_step.share,
            part,
            sense,
            history,
        )
    }

    #[inline]
    fn strained_by_part(
        &self,
        driven: Driven,
        share: f64,
        part: Option<[f64; 2]>,
        sense: usize,
        history: &History,
    ) -> f64 {
        // Also catches NaN.
        if !(driven.time > 0.0 && driven.excess + driven.rise.max(0.0) > 0.0) {
            return 0.0;
        }
        let pieces = self.side(sense).pieces();
        let (k, p) = (history.piece[sense] as usize, history.accumulated);
        let piece = pieces[k];
        let (f, room) = (piece.at(p), self.side(sense).end(k) - p);
        let mut flow = match (self.overstress, part) {
            (Overstress::Malvern { k }, Some(part)) => driven.linear(k, share + piece.slope, part),
            _ => self.overstress.flow(driven, share + piece.slope, f),
        };
        let law = self.overstress;
        let size = driven.excess + driven.rise.abs();
        let most = size / share.max(LEAST_SHARE);
        let tolerance = Tolerance::of_differences(size);
        // If the law needs the static stress, hardening may reduce the flow from that at the stress of the start, so that it does not reach the end
        // of the piece.
        let by_static_stress = law.needs_static_stress();
        if flow >= room || (by_static_stress && piece.slope > 0.0) {
            let answer = |flow: f64| {
                let at = self.side(sense).piece_at(p + flow, k as u32);
                let end = pieces[at as usize].at(p + flow);
                Course { law, limit: end - f, flow_stress: [f, end] }.answer(driven, share, flow)
            };
            let least = if by_static_stress { 0.0 } else { room };
            flow = fixed_point(flow.min(most), [least, most.max(least)], tolerance, answer);
        }
        flow
    }

    /// Advances a history by a flow (>= 0) in a sense.
    #[inline]
    fn advance(&self, flow: f64, sense: usize, history: &mut History) {
        self.arrive(history.accumulated + flow, flow, sense, history);
    }

    /// Advances a history by a flow in a sense to the accumulated plastic strain `p` (times E, Pa), which must agree with the flow up to rounding.
    #[inline]
    fn arrive(&self, p: f64, flow: f64, sense: usize, history: &mut History) {
        let before = self.static_stress(history, sense);
        let sign = if sense == 0 { 1.0 } else { -1.0 };
        history.accumulated = p;
        history.signed += sign * flow;
        history.piece[sense] = self.side(sense).piece_at(p, history.piece[sense]);
        history.piece[1 - sense] = match self.hardening.len() {
            1 => history.piece[sense],
            _ => self.side(1 - sense).piece_at(p, history.piece[1 - sense]),
        };
        if self.kinematic > 0.0 {
            history.back += sign * self.kinematic * (self.static_stress(history, sense) - before);
        }
    }

    /// Returns E times the work that the static flow stress of first loading does between two histories, per volume, Pa^2.
    fn first_loading(&self, sense: usize, before: &History, after: &History) -> f64 {
        let pieces = self.side(sense).pieces();
        let (mut from, mut work) = (before.accumulated, 0.0);
        for k in before.piece[sense]..=after.piece[sense] {
            let piece = &pieces[k as usize];
            let to = self.side(sense).end(k as usize).min(after.accumulated);
            work += (to - from) * piece.at(0.5 * (from + to));
            from = to;
        }
        work
    }

    /// Returns the mean of two possible histories of one cell.
    pub fn mean(&self, one: &History, other: &History) -> History {
        let accumulated = 0.5 * (one.accumulated + other.accumulated);
        let piece = |sense: usize| {
            let from = one.piece[sense].min(other.piece[sense]);
            self.side(sense).piece_at(accumulated, from)
        };
        History {
            accumulated,
            signed: 0.5 * (one.signed + other.signed),
            back: 0.5 * (one.back + other.back),
            piece: [piece(0), piece(1)],
        }
    }
}

#[cfg(test)]
mod tests {
    use super::secant_batch::tests::heating;
    use super::*;
    use crate::law::CellLaw;
    use crate::material::{Beyond, Curve};

    const MODULUS: f64 = 200e9;

    fn table() -> Table {
        let rows = [(0.001, 200e6), (0.004, 260e6), (0.01, 300e6), (0.05, 340e6)];
        Table::new(&Curve::new(&rows, Beyond::Extend).expect("rows rise"), MODULUS)
    }

    fn step(excess: f64, share: f64, time: f64) -> NodeStep {
        NodeStep { excess, share, smooth: 0.0, time }
    }

    fn law(k: f64, kinematic: f64) -> RateLaw {
        RateLaw::new(Overstress::Malvern { k }, &table(), None, kinematic)
    }

    #[test]
    fn two_half_steps_are_one_step_of_malvern() {
        let law = law(1e6, 0.0);
        for excess in [1e6, 50e6, 500e6] {
            let (mut once, mut twice) = (History::default(), History::default());
            let whole = law.flow(step(excess, 0.5, 2e-6), 0, &mut once);
            let first = law.flow(step(excess, 0.5, 1e-6), 0, &mut twice);
            let stress = 200e6 + excess - 0.5 * first.plastic;
            let second = law.flow(step(stress - law.limits(&twice)[1], 0.5, 1e-6), 0, &mut twice);
            // A dozen operations with errors of 1e-16 each.
            assert!((once.accumulated - twice.accumulated).abs() < 1e-14 * excess, "{excess}");
            // Along one piece the overstress falls linearly with the flow; a chord replaces the curve where it has knots.
            let [whole, first, second] = [whole, first, second].map(|flow| flow.overstress + flow.numerical);
            let bound = if once.piece[0] == 0 { 1e-12 } else { 2e-2 };
            assert!((whole - first - second).abs() < bound * whole, "{excess}: {whole} {first} {second}");
        }
    }

    #[test]
    fn the_longest_step_ends_on_the_static_curve() {
        for overstress in [
            Overstress::Malvern { k: 1e6 },
            Overstress::CowperSymonds { rate: MODULUS * 40.0, exponent: 5.0 },
            Overstress::JohnsonCook { c: 0.014, rate: MODULUS },
        ] {
            let law = RateLaw::new(overstress, &table(), None, 0.0);
            let mut history = History::default();
            let flow = law.flow(step(400e6, 1.0, 1e60), 0, &mut history);
            let (stress, limit) = (600e6 - flow.plastic, law.limits(&history)[1]);
            // With share 1 the total strain stays: 600 MPa / E = 0.003, where the table has 240 MPa.
            assert!((limit - 240e6).abs() < 1e-3 && (stress - limit).abs() < 1e-3, "{overstress:?} {stress} {limit}");
        }
    }

    /// Within the error of its flow, the cell may end inside its elastic limit.
    #[test]
    fn a_heated_cell_that_is_strained_on_keeps_flowing() {
        for (kinematic, exponent) in [(0.0, 1.2), (1.0, 1.2), (1.0, 0.8)] {
            let rate_independent = RateLaw::new(Overstress::RATE_INDEPENDENT, &table(), None, kinematic);
            let law = Heated::<7>::new(rate_independent, &heating(exponent), MODULUS, 1e-6);
            let (mut sigma, mut state, mut flowing) = (0.0, [0.0; 7], 0);
            for step in 0..40_000 {
                let part = f64::from(step) / 40.0;
                let increment = 1e8 * part.sin() * (1.0 + (7.0 * part).cos());
                let after = law.respond(sigma, sigma + increment, state);
                if increment * after.plastic > 0.0 {
                    assert!(law.is_relaxed(after.state), "m = {exponent}, step {step}: {after:?}");
                    flowing += 1;
                }
                (sigma, state) = (after.sigma, after.state);
            }
            assert!(flowing > 10_000, "{flowing}");
        }
    }

    #[test]
    fn first_loading_does_not_depend_on_the_kind_of_hardening() {
        for sense in [0, 1] {
            let flows =
                [0.0, 0.3, 1.0].map(|b| law(1e6, b).flow(step(120e6, 0.5, 1e-6), sense, &mut History::default()));
            assert_eq!(flows[0], flows[1]);
            assert_eq!(flows[0], flows[2]);
        }
        let (law, mut history) = (law(1e6, 1.0), History::default());
        law.flow(step(120e6, 0.5, 1e-6), 0, &mut history);
        let [low, high] = law.limits(&history);
        assert!((high - low - 400e6).abs() < 1e-3, "the elastic range moves and keeps its size");
    }

    #[test]
    fn not_a_number_ends() {
        let mut history = History::default();
        assert_eq!(law(1e6, 0.0).flow(step(f64::NAN, 0.5, 1e-6), 0, &mut history).plastic, 0.0);
        law(1e300, 0.0).flow(step(1e300, 0.0, 1e300), 0, &mut history);
    }
}
