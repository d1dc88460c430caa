//! Viscoplastic flow at a node of the characteristic net, once per step.
//!
//! A part `theta` of the flow p of a node comes before the moment at which it is read, the rest after it. So the rates of flow at
//! both ends of a characteristic act along it, each for half a step, and a bar that is strained steadily has the overstress of
//! its strain rate, whatever the step. With x* the excess over the elastic limit on arrival, and x at the moment of reading,
//!
//! ```text
//!   x* = x + gain (p - a),   p = q(x, f) time,   gain = share + df/dp,   a = (1 - theta) p,
//! ```
//!
//! `share` being what the stress of the node falls by per flow. But for Malvern's law the static curve is taken as straight between
//! the ends of the step; both ends are on it. The part a that comes after the reading lies between two bounds.
//!
//! The lower bound is exact for a stress that relaxes by Malvern's law and is not driven. With z = gain p/x, the step over the
//! relaxation time,
//!
//! ```text
//!   theta = 1/(1 - exp(-z)) - 1/z
//! ```
//!
//! By the other laws z has the overstress over which the rate changes by a factor e instead of x, where that is less. Then no
//! node falls below its static curve, and nothing rings. But theta tends to 1 for long steps, and what passes between nodes is the
//! stress half-way through their flow: too large by `share (theta - 1/2) p`, which diffuses plastic waves as a scheme of first
//! order does.
//!
//! The upper bound, theta = 1/2, is the rule of the trapezium, which dissipates nothing and damps nothing. It applies where the
//! flow is smooth: a is at most half of the least flow of the two neighbours half a step before, as in a minmod limiter. Malvern's
//! law stays at the lower bound: its relaxation time does not fall as the strain rate rises, and steps resolve it.

use super::{Flow, History, Overstress, RateLaw, driven::relaxed};
use crate::root::{Tolerance, fixed_point};

/// What a node meets in a step.
#[derive(Debug, Clone, Copy)]
pub struct NodeStep {
    /// Stress beyond the elastic limit on arrival, Pa.
    pub excess: f64,
    /// What the stress falls by per flow, >= 0.
    pub share: f64,
    /// Half of the least flow of the neighbours in the same sense, Pa, >= 0.
    pub smooth: f64,
    /// s.
    pub time: f64,
}

/// Flow of a node, all of it and after its reading; and the overstress at the reading. Pa.
#[derive(Clone, Copy)]
struct Solution {
    flow: f64,
    after: f64,
    overstress: f64,
}

/// A flow is known to this part of it: the rate changes by a factor e within a thousandth of the largest excess.
const RESOLUTION: f64 = 1e-13;

/// Largest flow of a step over its excess where neither the node nor hardening limits it: the run ends there, by its strain.
const LARGEST: f64 = 1e6;

/// 1 - theta at the lower bound.
fn after_reading(z: f64) -> f64 {
    if z < 1e-3 { 0.5 - z / 12.0 } else { z.recip() - z.exp_m1().recip() }
}

impl NodeStep {
    /// Part of a flow that comes after its reading, z being the step over the relaxation time.
    fn after(self, flow: f64, z: f64) -> f64 {
        (flow * after_reading(z)).max(self.smooth.min(0.5 * flow))
    }

    /// What the law and the curve make of a flow, the static stress being `start` before and higher by `rise` after it; and the
    /// flow by a step of Newton's method from there, on a scale of logarithms.
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
    /// Flow of a node in a sense (0: beyond the upper elastic limit, 1: the lower one). The history is taken to the end of the step.
    pub fn flow(&self, step: NodeStep, sense: usize, history: &mut History) -> Flow {
        // Not a number, or nothing to do.
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

    /// A history after a signed flow.
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
        // No less than half of a flow comes before the reading.
        let mut most = (step.time * self.overstress.rate(step.excess, start)).min(2.0 * step.excess / step.share);
        if step.share == 0.0 {
            // Of a prescribed stress far above the static curve hardening alone limits the flow.
            let mut hardened = step.excess;
            while rise(hardened) < 2.0 * step.excess && hardened < LARGEST * step.excess {
                hardened *= 2.0;
            }
            most = most.min(hardened);
        }
        let tolerance = Tolerance { relative: RESOLUTION, absolute: 0.0 };
        at(fixed_point(most, [0.0, most], tolerance, |flow| at(flow).1)).0
    }

    /// Flow by Malvern's law of a stress that is not driven: exact along each piece of the static curve.
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
            // Where the table rises as steeply as the elastic line, the static stress jumps here.
            excess = to - (pieces[piece].stress - (f + (gain - share) * room));
        }
        p - history.accumulated
    }
}
