//! Nodes of one segment.

use std::ops::Range;

use multiversion::multiversion;
use serde::{Deserialize, Serialize};

use crate::bar::Segment;
use crate::law::rate::{Flow, History, NodeStep, RateLaw};
use crate::law::{DataEnd, Flowing, Reached};
use crate::material::Sense;
use crate::solver::fd::SegmentGrid;

/// Ratio of stress drop to plastic flow of a node inside a segment. The waves on both sides carry the other half.
pub(super) const INSIDE: f64 = 0.5;

/// Limit of the flow of a border node in a step, relative to that of a node inside the bar that relaxes to its curve. At an absorbing end, whose
/// stress falls by half as much, the flow is twice as much; the limit is well above that, so that rounding decides nothing.
const RUN_AWAY: f64 = 3.0;

/// Number of nodes that are checked together: if none is beyond its elastic limits, the group is skipped.
const GROUP: usize = 32;

/// Nodes at fixed positions: elastic limits (Pa), histories, and plastic flow of the latest step (E times plastic strain, Pa).
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(super) struct Nodes {
    pub low: Vec<f64>,
    pub high: Vec<f64>,
    pub history: Vec<History>,
    pub flowed: Vec<f64>,
}

/// Sums of plastic work.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub(super) struct Work {
    /// Total plastic work.
    pub total: f64,
    /// Part of the total done by the overstress.
    pub overstress: f64,
    /// Part of the total that the net dissipates numerically.
    pub numerical: f64,
}

impl Work {
    /// Returns the work of a fraction of a flow under `stress`, the mean of the stresses before and after it.
    pub fn of(part: f64, stress: f64, flow: &Flow) -> Self {
        Self {
            total: part * stress * flow.plastic,
            overstress: part * flow.overstress,
            numerical: part * flow.numerical,
        }
    }

    pub fn add(&mut self, other: Self) {
        self.total += other.total;
        self.overstress += other.overstress;
        self.numerical += other.numerical;
    }
}

/// A segment.
#[derive(Debug, Clone)]
pub(super) struct NetSegment {
    pub law: RateLaw,
    end: DataEnd,
    /// Time step, s.
    dt: f64,
    /// Cells of the segment, counted over the whole bar.
    pub cells: Range<usize>,
    /// Cross-sectional area, m^2.
    pub area: f64,
    /// Impedance rho c0, Pa s/m.
    pub impedance: f64,
    /// Young's modulus, Pa.
    pub modulus: f64,
    /// sigma - Z v and sigma + Z v of the cells at whole steps, before they relax, Pa.
    pub f: Vec<f64>,
    pub g: Vec<f64>,
    pub centres: Nodes,
    /// Border nodes, one more than cells. The first and the last belong to the joints or ends there.
    pub borders: Nodes,
    /// Plastic work so far, Pa^2; [`NetSegment::per_work`] converts it to joules.
    pub work: Work,
}

/// Load on a node: its stress on arrival (Pa), the ratio of its stress drop to its flow, and the length of the step, s.
#[derive(Debug, Clone, Copy)]
pub(super) struct Load {
    pub stress: f64,
    pub share: f64,
    pub time: f64,
}

impl Load {
    fn step(self, excess: f64, sense: usize, [one, other]: [f64; 2]) -> NodeStep {
        let least = if sense == 0 { one.min(other) } else { -one.max(other) };
        NodeStep { excess, share: self.share, smooth: 0.5 * least.max(0.0), time: self.time }
    }
}

/// Returns sense (0 tension, 1 compression) and excess of a stress beyond the elastic limits of a node; `None` within them.
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
    fn new(law: &RateLaw, history: Vec<History>) -> Self {
        let (low, high) = history.iter().map(|history| law.limits(history).into()).unzip();
        Self { low, high, flowed: vec![0.0; history.len()], history }
    }

    /// Returns the flow of node `i` between these `neighbours` (their flow in their latest step), and its history after that.
    pub fn flow(&self, law: &RateLaw, i: usize, load: Load, neighbours: [f64; 2]) -> (Flow, History) {
        let mut history = self.history[i];
        let flow = match beyond(load.stress, self.low[i], self.high[i]) {
            Some((sense, excess)) => law.flow(load.step(excess, sense, neighbours), sense, &mut history),
            None => Flow::default(),
        };
        (flow, history)
    }

    /// Records the flow of node `i` and its new history.
    pub fn set(&mut self, law: &RateLaw, i: usize, flow: &Flow, history: History) {
        self.flowed[i] = flow.plastic;
        if history != self.history[i] {
            self.history[i] = history;
            [self.low[i], self.high[i]] = law.limits(&history);
        }
    }

    /// Advances the nodes from `first` on by a step of `time`. `f` and `g` (one entry per node) are the waves that arrive, and on return those that
    /// leave. `neighbours` is the flow of the nodes between which they lie, one entry more.
    fn relax(&mut self, law: &RateLaw, time: f64, first: usize, neighbours: &[f64], [f, g]: [&mut [f64]; 2]) -> Work {
        let count = f.len();
        let g = &mut g[..count];
        let nodes = first..first + count;
        let (low, high) = (&mut self.low[nodes.clone()], &mut self.high[nodes.clone()]);
        let (history, flowed) = (&mut self.history[nodes.clone()], &mut self.flowed[nodes]);
        let mut sum = Work::default();
        let mut start = 0;
        while start < count {
            let end = (start + GROUP).min(count);
            flowed[start..end].fill(0.0);
            if any_beyond(&f[start..end], &g[start..end], &low[start..end], &high[start..end]) {
                for i in start..end {
                    let stress = 0.5 * (f[i] + g[i]);
                    let Some((sense, excess)) = beyond(stress, low[i], high[i]) else { continue };
                    let step =
                        Load { stress, share: INSIDE, time }.step(excess, sense, [neighbours[i], neighbours[i + 1]]);
                    let flow = law.flow(step, sense, &mut history[i]);
                    [low[i], high[i]] = law.limits(&history[i]);
                    flowed[i] = flow.plastic;
                    let drop = INSIDE * flow.plastic;
                    f[i] -= drop;
                    g[i] -= drop;
                    sum.add(Work::of(1.0, stress - 0.5 * drop, &flow));
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

impl NetSegment {
    pub fn new(law: RateLaw, grid: &SegmentGrid, dt: f64, segment: &Segment) -> Self {
        let (impedance, modulus, cells) = (segment.material.impedance(), segment.material.modulus, grid.cells.clone());
        let history = |[from, to]: [f64; 2]| law.deformed(&segment.initial_between(from, to).deformed(modulus));
        // sigma - Z v of a state equals sigma + Z v at the opposite velocity.
        let passing = |sign: f64| {
            let of = |[from, to]: [f64; 2]| {
                segment.initial_between(from, to).stress + sign * impedance * segment.velocity_between(from, to)
            };
            cells.clone().map(|cell| of(grid.cell(cell))).collect()
        };
        Self {
            centres: Nodes::new(&law, cells.clone().map(|cell| history(grid.cell(cell))).collect()),
            borders: Nodes::new(
                &law,
                (cells.start..=cells.end).map(|node| history(grid.nodal_interval(node))).collect(),
            ),
            f: passing(-1.0),
            g: passing(1.0),
            work: Work::default(),
            dt,
            end: DataEnd::of(&segment.material),
            law,
            cells,
            area: segment.area,
            impedance,
            modulus,
        }
    }

    /// Returns the energy per [`Work`], A dt/(2 Z), which converts Pa^2 to J.
    pub fn per_work(&self, dt: f64) -> f64 {
        0.5 * self.area * dt / self.impedance
    }

    /// Advances the cells by a whole step. On return f and g are the waves that leave them.
    pub fn relax_cells(&mut self) {
        let work = self.centres.relax(&self.law, self.dt, 0, &self.borders.flowed, [&mut self.f, &mut self.g]);
        self.work.add(work);
    }

    /// Advances the borders inside the segment by a whole step and moves f and g on to the next cells. `entering` are the f and the g that enter at
    /// the left and the right border of the segment.
    pub fn pass_borders(&mut self, entering: [f64; 2]) {
        let last = self.f.len() - 1;
        let between = [&mut self.f[..last], &mut self.g[1..]];
        let work = self.borders.relax(&self.law, self.dt, 1, &self.centres.flowed, between);
        self.work.add(work);
        self.f.copy_within(..last, 1);
        self.g.copy_within(1.., 0);
        self.f[0] = entering[0];
        self.g[last] = entering[1];
    }

    /// Returns the wave that arrives at the left (side 0: g) or right (side 1: f) border of the segment after the cells have flowed.
    pub fn arriving(&self, side: usize) -> f64 {
        if side == 0 { self.g[0] } else { self.f[self.f.len() - 1] }
    }

    /// Returns the flow of local cell `i` in the step centred on the whole step.
    pub fn flow_of_cell(&self, i: usize) -> Flow {
        let load = Load { stress: 0.5 * (self.f[i] + self.g[i]), share: INSIDE, time: self.dt };
        self.centres.flow(&self.law, i, load, [self.borders.flowed[i], self.borders.flowed[i + 1]]).0
    }

    /// Returns the flow of the border node of an end or joint under a load, and its history after that.
    pub fn flow_of_border(&self, node: usize, load: Load) -> (Flow, History) {
        let beside = self.centres.flowed[node.min(self.f.len() - 1)];
        self.borders.flow(&self.law, node, load, [beside; 2])
    }

    /// Returns whether no flow can raise the static curve of such a node to the stress that acts on it and the node flows more in a step than
    /// [`RUN_AWAY`] allows.
    pub fn runs_away(&self, node: usize, load: Load, flow: &Flow) -> bool {
        let Some((sense, excess)) = beyond(load.stress, self.borders.low[node], self.borders.high[node]) else {
            return false;
        };
        let (stress, relaxed) = (if sense == 0 { load.stress } else { -load.stress }, RUN_AWAY * excess / INSIDE);
        flow.plastic.abs() > relaxed && stress > self.law.largest_limit(sense, &self.borders.history[node])
    }

    /// Accounts for the flow of such a node, which is half a node, under `stress`, the mean of the stresses before and after it.
    pub fn record_flow(&mut self, node: usize, stress: f64, flow: &Flow, history: History) {
        self.work.add(Work::of(0.5, stress, flow));
        self.borders.set(&self.law, node, flow, history);
    }

    /// Returns stress and history of local cell `i` at the whole step, after the part of its flow that precedes the reading, and the work of that
    /// part.
    pub fn cell(&self, i: usize) -> (f64, History, Work) {
        let (stress, flow) = (0.5 * (self.f[i] + self.g[i]), self.flow_of_cell(i));
        if flow.plastic == 0.0 {
            return (stress, self.centres.history[i], Work::default());
        }
        let drop = INSIDE * flow.before;
        let start = self.centres.history[i];
        let history = self.law.flowed(flow.before, &start);
        let work = Work::of(flow.before / flow.plastic, stress - 0.5 * drop, &flow);
        // The stress falls as the node flows, so that this first part of the flow does more than its share of the work. The excess counts as
        // numerical; as plastic work, it would be taken back by the rest of the flow.
        let limit = |history| {
            let [low, high] = self.law.limits(history);
            if flow.plastic < 0.0 { low } else { high }
        };
        let on_curve = 0.5 * (limit(&start) + limit(&history)) * flow.before;
        (stress - drop, history, Work { numerical: work.total - work.overstress - on_curve, ..work })
    }

    /// Returns the end of the data of its law that local cell `i` has reached; `None` if it has reached none.
    pub fn reached(&self, i: usize) -> Option<Reached> {
        let nodes = &self.centres;
        let before = 0.5 * (self.f[i] + self.g[i]);
        if self.end.is_far(nodes.history[i].accumulated, before) {
            return None;
        }
        let flow = beyond(before, nodes.low[i], nodes.high[i]);
        let (stress, history, _) = self.cell(i);
        let sense = flow.map_or_else(|| Sense::of(before), |(sense, _)| [Sense::Tension, Sense::Compression][sense]);
        let point = Flowing { sense, accumulated: history.accumulated, strain: stress + history.signed, held: false };
        self.end.reached(&point, |_| flow.is_some())
    }

    /// Velocity of local cell `i`, m/s.
    pub fn velocity(&self, i: usize) -> f64 {
        (self.g[i] - self.f[i]) / (2.0 * self.impedance)
    }
}
