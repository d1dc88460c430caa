//! Viscoplastic flow at a node of the characteristic net, once per step.
//!
//! A fraction `theta` of the flow p of a node precedes the instant at which the node is evaluated, the rest follows it. The rates of flow at
//! both ends of a characteristic thus act along it, each for half a step, and a bar that is strained steadily has the overstress of
//! its strain rate, whatever the step. With x* the excess over the elastic limit on arrival, and x at the instant of evaluation,
//!
//! ```text
//!   x* = x + gain (p - a),   p = q(x, f) time,   gain = share + df/dp,   a = (1 - theta) p,
//! ```
//!
//! where `share` is the decrease of the node's stress per flow. Except for Malvern's law, the static curve is taken as straight between
//! the ends of the step; both ends are on it. The part a that follows the evaluation lies between two bounds.
//!
//! The lower bound is exact for a stress that relaxes by Malvern's law without loading. With z = gain p/x, the ratio of the step to the
//! relaxation time,
//!
//! ```text
//!   theta = 1/(1 - exp(-z)) - 1/z
//! ```
//!
//! For the other laws, x in z is replaced by the overstress over which the rate changes by a factor e, if that is smaller. Then no node falls below
//! its static curve, and nothing oscillates. But theta tends to 1 for long steps, and the stress that is transmitted between nodes is that half-way
//! through their flow. It is too large by `share (theta - 1/2) p`, which diffuses plastic waves as a first-order scheme does.
//!
//! The upper bound, theta = 1/2, is the trapezoidal rule, which has neither dissipation nor damping. It applies where the
//! flow is smooth: a is at most half of the smaller flow of the two neighbours half a step before, as in a minmod limiter. Malvern's
//! law stays at the lower bound: its relaxation time does not decrease with the strain rate, and steps resolve it.

use super::{Flow, History, Overstress, RateLaw, driven::relaxed};
use crate::root::{Tolerance, fixed_point};

/// Loading of a node in a step.
#[derive(Debug, Clone, Copy)]
pub struct NodeStep {
    /// Stress beyond the elastic limit on arrival, Pa.
    pub excess: f64,
    /// Decrease of the stress per flow, >= 0.
    pub share: f64,
    /// Half of the smaller flow of the two neighbours in the same sense, Pa, >= 0.
    pub smooth: f64,
    /// Duration of the step, s.
    pub time: f64,
}

/// Flow of a node: the whole flow, its part after the evaluation, and the overstress at the evaluation; Pa.
#[derive(Clone, Copy)]
struct Solution {
    flow: f64,
    after: f64,
    overstress: f64,
}

/// Relative tolerance of a flow. The rate changes by a factor e within a thousandth of the largest excess.
const RESOLUTION: f64 = 1e-13;

/// Largest flow of a step, relative to its excess, where neither the share nor hardening limits it. The strain of such a flow ends the run.
const LARGEST: f64 = 1e6;

/// Returns 1 - theta at the lower bound.
fn after_reading(z: f64) -> f64 {
    if z < 1e-3 { 0.5 - z / 12.0 } else { z.recip() - z.exp_m1().recip() }
}

impl NodeStep {
    /// Returns the part of a flow that follows the evaluation; z is the ratio of the step to the relaxation time.
    fn after(self, flow: f64, z: f64) -> f64 {
        (flow * after_reading(z)).max(self.smooth.min(0.5 * flow))
    }

    /// Evaluates law and curve for an assumed flow, with the static stress `start` before it and higher by `rise` after it. Returns the solution,
    /// and an improved flow by a step of Newton's method on a logarithmic scale.
    fn solution(self, law: Overstress, start: f64, rise: f64, flow: f64) -> (Solution, f64) {
        let (gain, f) = (self.share + rise / flow, start + 0.5 * rise);
        let overstress = law.overstress(flow / self.time, f);
        let width = if overstress > 0.0 { law.width(overstress, f) } else { 0.0 };
        let after = self.after(flow, gain * flow / width.min(overstress));
        let drop = gain * (flow - after);
        let next = flow * ((self.excess - overstress - drop) / (width + drop)).exp();
        (Solution { flow, after, overstress }, next)
    }
}

impl RateLaw {
    /// Returns the flow of a node in a sense (0: beyond the upper elastic limit, 1: the lower one), and advances the history to the end of the step.
    pub fn flow(&self, step: NodeStep, sense: usize, history: &mut History) -> Flow {
        // Also catches NaN.
        if !(step.excess > 0.0 && step.time > 0.0) {
            return Flow::default();
        }
        let start = self.static_stress(history, sense);
        let Solution { flow, after, overstress } = self.node_flow(step, sense, history);
        self.advance(flow, sense, history);
        let rise = self.static_stress(history, sense) - start;
        let late = 0.5 * flow - after;
        let signed = |p: f64| if sense == 0 { p } else { -p };
        Flow {
            plastic: signed(flow),
            before: signed(flow - after),
            overstress: overstress * flow + rise * late,
            numerical: step.share * flow * late,
        }
    }

    /// Returns a history after a signed flow.
    pub fn flowed(&self, plastic: f64, history: &History) -> History {
        let mut history = *history;
        self.advance(plastic.abs(), usize::from(plastic < 0.0), &mut history);
        history
    }

    fn node_flow(&self, step: NodeStep, sense: usize, history: &History) -> Solution {
        let pieces = self.side(sense).pieces();
        let (k, p) = (history.piece[sense], history.accumulated);
        let piece = pieces[k as usize];
        let start = piece.at(p);
        let room = self.side(sense).end(k as usize) - p;
        let rise = |flow: f64| {
            if flow < room {
                return piece.slope * flow;
            }
            let there = self.side(sense).piece_at(p + flow, k);
            pieces[there as usize].at(p + flow) - start
        };
        if let Overstress::Malvern { k } = self.overstress {
            let flow = self.relaxation(k, step, sense, history);
            let flow = if step.share == 0.0 { flow.min(LARGEST * step.excess) } else { flow };
            if flow == 0.0 {
                return Solution { flow, after: 0.0, overstress: step.excess };
            }
            let z = (step.share + rise(flow) / flow) * k * step.time;
            return Solution { flow, after: flow * after_reading(z), overstress: flow / (k * step.time) };
        }
        let at = |flow: f64| step.solution(self.overstress, start, rise(flow), flow);
        // At least half of the flow precedes the evaluation.
        let mut most = (step.time * self.overstress.rate(step.excess, start)).min(2.0 * step.excess / step.share);
        if step.share == 0.0 {
            // Under a prescribed stress far above the static curve, only hardening limits the flow.
            let mut hardened = step.excess;
            while rise(hardened) < 2.0 * step.excess && hardened < LARGEST * step.excess {
                hardened *= 2.0;
            }
            most = most.min(hardened);
        }
        let tolerance = Tolerance { relative: RESOLUTION, absolute: 0.0 };
        at(fixed_point(most, [0.0, most], tolerance, |flow| at(flow).1)).0
    }

    /// Returns the flow by Malvern's law for a stress without loading: exact along each piece of the static curve.
    fn relaxation(&self, k: f64, step: NodeStep, sense: usize, history: &History) -> f64 {
        let NodeStep { mut excess, share, mut time, .. } = step;
        let (mut piece, mut p) = (history.piece[sense] as usize, history.accumulated);
        let pieces = self.side(sense).pieces();
        while excess > 0.0 && time > 0.0 {
            let (gain, f) = (share + pieces[piece].slope, pieces[piece].at(p));
            let flow = excess * relaxed(k, gain, time)[0];
            let room = self.side(sense).end(piece) - p;
            if flow < room || room == f64::INFINITY {
                p += flow;
                break;
            }
            let to = excess - gain * room;
            time -= if gain > 0.0 { (excess / to).ln() / (k * gain) } else { room / (k * excess) };
            piece += 1;
            p = pieces[piece].start;
            // Where the table is parallel to the elastic line, the static stress jumps.
            excess = to - (pieces[piece].stress - (f + (gain - share) * room));
        }
        p - history.accumulated
    }
}
