//! The nodes of one segment.

use std::ops::Range;

use multiversion::multiversion;
use serde::{Deserialize, Serialize};

use crate::bar::{Initial, Segment};
use crate::law::rate::{Flow, History, RateLaw, RelaxationStep};
use crate::law::{DataEnd, Flowing, Reached};
use crate::material::Sense;

/// Share of its plastic flow by which the stress of a node falls inside a segment: what it meets on both sides takes the
/// other half.
pub(super) const INSIDE: f64 = 0.5;

/// Nodes that are looked at together: if none is beyond its elastic limits there is nothing to do for them.
const GROUP: usize = 32;

/// Nodes at fixed places: elastic limits, Pa, and histories.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(super) struct Nodes {
    pub low: Vec<f64>,
    pub high: Vec<f64>,
    pub history: Vec<History>,
}

/// Sums of plastic work.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub(super) struct Work {
    /// All of it.
    pub total: f64,
    /// Of it, that of the overstress.
    pub overstress: f64,
}

impl Work {
    pub fn add(&mut self, other: Self) {
        self.total += other.total;
        self.overstress += other.overstress;
    }
}

/// A segment.
#[derive(Debug, Clone)]
pub(super) struct Part {
    pub law: RateLaw,
    end: DataEnd,
    /// Whole steps of the nodes inside the segment.
    relaxation_step: RelaxationStep,
    /// Its cells, counted over the whole bar.
    pub cells: Range<usize>,
    /// m^2.
    pub area: f64,
    /// rho c0, Pa s/m.
    pub impedance: f64,
    /// Pa.
    pub modulus: f64,
    /// sigma - Z v and sigma + Z v of the cells at whole steps, before they relax, Pa.
    pub f: Vec<f64>,
    pub g: Vec<f64>,
    pub centres: Nodes,
    /// One more than cells; the first and the last belong to the joints or ends there.
    pub borders: Nodes,
    /// Plastic work so far, Pa^2; joules are [`Part::per_work`] times it.
    pub work: Work,
}

/// Stress of a node beyond its elastic limits: (sense, excess).
#[inline]
pub(super) fn beyond(stress: f64, low: f64, high: f64) -> Option<(usize, f64)> {
    if stress > high {
        Some((0, stress - high))
    } else if stress < low {
        Some((1, low - stress))
    } else {
        None
    }
}

impl Nodes {
    fn new(law: &RateLaw, count: usize, history: History) -> Self {
        let [low, high] = law.limits(&history);
        Self { low: vec![low; count], high: vec![high; count], history: vec![history; count] }
    }

    /// What node `i` would flow within `time`, and its history then.
    pub fn flow(&self, law: &RateLaw, i: usize, stress: f64, share: f64, time: f64) -> (Flow, History) {
        let mut history = self.history[i];
        let flow = match beyond(stress, self.low[i], self.high[i]) {
            Some((sense, excess)) => law.flow(excess, sense, share, time, &mut history),
            None => Flow::default(),
        };
        (flow, history)
    }

    /// Takes node `i` to a new history.
    pub fn set(&mut self, law: &RateLaw, i: usize, history: History) {
        if history != self.history[i] {
            self.history[i] = history;
            [self.low[i], self.high[i]] = law.limits(&history);
        }
    }

    /// Lets the nodes from `first` on flow for a step; `f` and `g` (one entry a node) are what reaches them, and then
    /// what leaves them.
    fn relax(
        &mut self,
        law: &RateLaw,
        relaxation_step: &RelaxationStep,
        first: usize,
        f: &mut [f64],
        g: &mut [f64],
    ) -> Work {
        let count = f.len();
        let g = &mut g[..count];
        let (low, high) = (&mut self.low[first..first + count], &mut self.high[first..first + count]);
        let history = &mut self.history[first..first + count];
        let mut sum = Work::default();
        let mut start = 0;
        while start < count {
            let end = (start + GROUP).min(count);
            if any_beyond(&f[start..end], &g[start..end], &low[start..end], &high[start..end]) {
                for i in start..end {
                    let stress = 0.5 * (f[i] + g[i]);
                    let Some((sense, excess)) = beyond(stress, low[i], high[i]) else { continue };
                    let flow = law.flow_at(relaxation_step, excess, sense, &mut history[i]);
                    [low[i], high[i]] = law.limits(&history[i]);
                    let drop = INSIDE * flow.plastic;
                    f[i] -= drop;
                    g[i] -= drop;
                    sum.total += (stress - 0.5 * drop) * flow.plastic;
                    sum.overstress += flow.overstress;
                }
            }
            start = end;
        }
        sum
    }
}

#[multiversion(targets("x86_64+avx512f+avx512dq+avx512vl+avx512bw", "x86_64+avx2"))]
fn any_beyond(f: &[f64], g: &[f64], low: &[f64], high: &[f64]) -> bool {
    let count = f.len();
    let (g, low, high) = (&g[..count], &low[..count], &high[..count]);
    let mut any = false;
    for i in 0..count {
        let stress = 0.5 * (f[i] + g[i]);
        any |= stress > high[i];
        any |= stress < low[i];
    }
    any
}

impl Part {
    pub fn new(law: RateLaw, cells: Range<usize>, dt: f64, segment: &Segment) -> Self {
        let (impedance, modulus) = (segment.material.impedance(), segment.material.modulus);
        let (count, Initial { stress, plastic_strain }) = (cells.len(), segment.initial);
        let history = law.deformed(modulus * plastic_strain);
        Self {
            centres: Nodes::new(&law, count, history),
            borders: Nodes::new(&law, count + 1, history),
            f: vec![stress - impedance * segment.velocity; count],
            g: vec![stress + impedance * segment.velocity; count],
            work: Work::default(),
            relaxation_step: law.relaxation_step(INSIDE, dt),
            end: DataEnd::of(&segment.material),
            law,
            cells,
            area: segment.area,
            impedance,
            modulus,
        }
    }

    /// Joules per [`Work`]: A dt/(2 Z).
    pub fn per_work(&self, dt: f64) -> f64 {
        0.5 * self.area * dt / self.impedance
    }

    /// The cells flow for a whole step; then f and g are what leaves them.
    pub fn relax_cells(&mut self) {
        let work = self.centres.relax(&self.law, &self.relaxation_step, 0, &mut self.f, &mut self.g);
        self.work.add(work);
    }

    /// The borders inside the segment flow for a whole step; then f and g go on to the next cells. `entering` are the f
    /// and the g that come in at the segment's left and right border.
    pub fn pass_borders(&mut self, entering: [f64; 2]) {
        let last = self.f.len() - 1;
        let work = self.borders.relax(&self.law, &self.relaxation_step, 1, &mut self.f[..last], &mut self.g[1..]);
        self.work.add(work);
        self.f.copy_within(..last, 1);
        self.g.copy_within(1.., 0);
        self.f[0] = entering[0];
        self.g[last] = entering[1];
    }

    /// What arrives at the segment's left (side 0: g) or right (side 1: f) border once the cells have flowed.
    pub fn arriving(&self, side: usize) -> f64 {
        if side == 0 { self.g[0] } else { self.f[self.f.len() - 1] }
    }

    /// Stress and history of local cell `i` at the whole step, half of its flow done; and the work of that half.
    pub fn cell(&self, i: usize, dt: f64) -> (f64, History, Work) {
        let stress = 0.5 * (self.f[i] + self.g[i]);
        let (flow, history) = self.centres.flow(&self.law, i, stress, INSIDE, 0.5 * dt);
        let drop = INSIDE * flow.plastic;
        let work = Work { total: (stress - 0.5 * drop) * flow.plastic, overstress: flow.overstress };
        (stress - drop, history, work)
    }

    /// The limit of what its law knows to which local cell `i` has come, if it has.
    pub fn reached(&self, i: usize, dt: f64) -> Option<Reached> {
        let nodes = &self.centres;
        let before = 0.5 * (self.f[i] + self.g[i]);
        if self.end.is_far(nodes.history[i].accumulated, before) {
            return None;
        }
        let flow = beyond(before, nodes.low[i], nodes.high[i]);
        let (stress, history, _) = self.cell(i, dt);
        let sense = flow.map_or_else(|| Sense::of(before), |(sense, _)| [Sense::Tension, Sense::Compression][sense]);
        let point = Flowing { sense, accumulated: history.accumulated, strain: stress + history.signed };
        self.end.reached(&point, |_| flow.is_some())
    }

    /// Velocity of local cell `i`, m/s.
    pub fn velocity(&self, i: usize) -> f64 {
        (self.g[i] - self.f[i]) / (2.0 * self.impedance)
    }
}
