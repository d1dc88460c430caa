//! Nodes at fixed places, and their flow in a step.
//!
//! What reaches a node in a step comes at once: its stress jumps by the rise of the whole step, and falls by flow. Flow that begins at the
//! jump is right for a front, which is one. Where the bar is strained steadily, however, it leaves the mean of the stresses before and
//! after it, with which the bar goes on, too high by up to half a rise: many times the overstress of a law as stiff as that of Johnson
//! and Cook in steps that strain by more than C f/E. A rise that goes on from the step before is therefore spread over the step, half of
//! it before the jump and half after it: the lesser of both rises, so that a front alone is no steady rise. Flow then runs ahead of the
//! stress by half of the steady rise, and the mean stress is that of the strain rate, whatever the step.

use multiversion::multiversion;
use serde::{Deserialize, Serialize};

use crate::law::rate::{Driven, Flow, History, RateLaw, RelaxationStep};

/// Share of its plastic flow by which the stress of a node falls inside a segment: what it meets on both sides takes the
/// other half.
pub(super) const INSIDE: f64 = 0.5;

/// Nodes that are looked at together: if none is beyond its elastic limits there is nothing to do for them.
const GROUP: usize = 32;

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

/// Nodes at fixed places: elastic limits, Pa, and histories.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(super) struct Nodes {
    pub low: Vec<f64>,
    pub high: Vec<f64>,
    pub history: Vec<History>,
    latest: Vec<Latest>,
}

/// The latest step in which a node flowed.
#[derive(Debug, Clone, Copy, Default, Serialize, Deserialize)]
pub(super) struct Latest {
    /// Counted from 1; 0 where it has never flowed.
    step: u32,
    /// 0: tension, 1: compression.
    sense: u32,
    /// Stress at its end, Pa.
    left: f64,
    /// Rise of the stress since the end of the step before, in the sense of the flow, Pa; 0 where the node did not flow then.
    rise: f64,
}

/// What a node meets in a step.
#[derive(Debug, Clone, Copy)]
pub(super) struct Meeting {
    /// Counted from 1.
    pub step: u32,
    /// Stress before it flows, Pa.
    pub stress: f64,
    /// Share of its flow by which its stress falls.
    pub share: f64,
    /// Length of the step, s.
    pub time: f64,
}

/// What a node does in a step.
#[derive(Debug, Clone, Copy)]
pub(super) struct NodeStep {
    pub flow: Flow,
    pub history: History,
    /// As it will be once the stress at the end is known.
    latest: Latest,
}

/// How a node beyond its limits is driven: a rise that goes on from the step before, of all its rise.
#[derive(Debug, Clone, Copy)]
struct Drive {
    sense: usize,
    excess: f64,
    rise: f64,
    steady: f64,
}

impl Drive {
    /// Over a step of that length: half of the steady rise before the jump, half of it after.
    fn spread(&self, time: f64) -> Driven {
        let (start, end) = (self.excess - 0.5 * self.steady, self.excess + 0.5 * self.steady);
        if start >= 0.0 {
            return Driven { excess: start, rise: self.steady, time };
        }
        // It comes to its limit within the step.
        Driven { excess: 0.0, rise: end, time: time * end / self.steady }
    }
}

impl NodeStep {
    /// Half-way between two that one node could have done.
    pub fn mean(&self, other: &Self, law: &RateLaw) -> Self {
        let half = |a: f64, b: f64| 0.5 * (a + b);
        let flow = Flow {
            plastic: half(self.flow.plastic, other.flow.plastic),
            overstress: half(self.flow.overstress, other.flow.overstress),
        };
        let rise = half(self.latest.rise, other.latest.rise);
        Self { flow, history: law.mean(&self.history, &other.history), latest: Latest { rise, ..self.latest } }
    }
}

impl Nodes {
    pub fn new(law: &RateLaw, count: usize, history: History) -> Self {
        let [low, high] = law.limits(&history);
        Self {
            low: vec![low; count],
            high: vec![high; count],
            history: vec![history; count],
            latest: vec![Latest::default(); count],
        }
    }

    /// Memory of a node, bytes.
    pub const BYTES: usize = size_of::<History>() + size_of::<Latest>() + 2 * size_of::<f64>();

    /// How node `i` is driven; none within its elastic limits.
    #[inline]
    fn drive(&self, law: &RateLaw, i: usize, Meeting { step, stress, .. }: Meeting) -> Option<Drive> {
        let (sense, excess) = beyond(stress, self.low[i], self.high[i])?;
        let latest = &self.latest[i];
        if latest.step + 1 != step || latest.sense != sense as u32 {
            return Some(Drive { sense, excess, rise: 0.0, steady: 0.0 });
        }
        let rise = if sense == 0 { stress - latest.left } else { latest.left - stress };
        // Under a linear law relaxation alone keeps stresses behind a front in order, in steps of any length.
        let steady = if law.overstress().is_linear() { 0.0 } else { rise.min(latest.rise).max(0.0) };
        Some(Drive { sense, excess, rise, steady })
    }

    /// What node `i` does in a step.
    pub fn flow(&self, law: &RateLaw, i: usize, meeting: Meeting) -> NodeStep {
        let drive = self.drive(law, i, meeting);
        self.driven(law, i, drive, meeting, |excess, sense, history| {
            law.flow(excess, sense, meeting.share, meeting.time, history)
        })
    }

    #[inline]
    fn driven(
        &self,
        law: &RateLaw,
        i: usize,
        drive: Option<Drive>,
        meeting: Meeting,
        from_jump: impl FnOnce(f64, usize, &mut History) -> Flow,
    ) -> NodeStep {
        let mut history = self.history[i];
        let Some(drive) = drive else {
            return NodeStep { flow: Flow::default(), history, latest: self.latest[i] };
        };
        let flow = if drive.steady == 0.0 {
            from_jump(drive.excess, drive.sense, &mut history)
        } else {
            let flow = law.driven_flow(drive.spread(meeting.time), meeting.share, drive.sense, &mut history);
            self.flow_between(law, i, &drive, meeting.share, flow, &history)
        };
        let latest = Latest { step: meeting.step, sense: drive.sense as u32, left: 0.0, rise: drive.rise };
        NodeStep { flow, history, latest }
    }

    /// With the work of the overstress, by its mean before and after.
    fn flow_between(&self, law: &RateLaw, i: usize, drive: &Drive, share: f64, flow: f64, after: &History) -> Flow {
        let [low, high] = law.limits(after);
        let hardened = if drive.sense == 0 { high - self.high[i] } else { self.low[i] - low };
        let left = drive.excess - share * flow - hardened;
        let overstress = 0.5 * (drive.excess + left).max(0.0) * flow;
        Flow { plastic: if drive.sense == 0 { flow } else { -flow }, overstress }
    }

    /// Node `i` half-way through the step that it is about to take, where what it meets holds: its flow so far and its history. From a jump
    /// on that is the flow of half the time, under a steady rise half of the flow.
    pub fn half_way(&self, law: &RateLaw, i: usize, meeting: Meeting) -> (Flow, History) {
        let mut history = self.history[i];
        let Some(drive) = self.drive(law, i, meeting) else { return (Flow::default(), history) };
        let steadily = if drive.steady > 0.0 { (drive.steady / drive.rise).min(1.0) } else { 0.0 };
        let whole = if steadily > 0.0 { self.flow(law, i, meeting).flow } else { Flow::default() };
        if steadily == 1.0 {
            let flow = Flow { plastic: 0.5 * whole.plastic, overstress: 0.5 * whole.overstress };
            law.advance(flow.plastic.abs(), drive.sense, &mut history);
            return (flow, history);
        }
        let jumped = law.flow(drive.excess, drive.sense, meeting.share, 0.5 * meeting.time, &mut history);
        if steadily == 0.0 {
            return (jumped, history);
        }
        // No more than in the whole step.
        let mean = |whole: f64, jumped: f64| (jumped + steadily * (0.5 * whole - jumped)).min(whole);
        let plastic = mean(whole.plastic.abs(), jumped.plastic.abs()).copysign(whole.plastic);
        let flow = Flow { plastic, overstress: mean(whole.overstress, jumped.overstress) };
        history = self.history[i];
        law.advance(flow.plastic.abs(), drive.sense, &mut history);
        (flow, history)
    }

    /// Takes node `i` to the end of a step, with the stress `left` there, Pa.
    #[inline]
    pub fn set(&mut self, law: &RateLaw, i: usize, step: &NodeStep, left: f64) {
        self.latest[i] = Latest { left, ..step.latest };
        if step.history != self.history[i] {
            self.history[i] = step.history;
            [self.low[i], self.high[i]] = law.limits(&step.history);
        }
    }

    /// Lets the nodes from `first` on flow for a step; `f` and `g` (one entry a node) are what reaches them, and then
    /// what leaves them.
    pub fn relax(
        &mut self,
        law: &RateLaw,
        (relaxation_step, step, time): (&RelaxationStep, u32, f64),
        first: usize,
        f: &mut [f64],
        g: &mut [f64],
    ) -> Work {
        let count = f.len();
        let g = &mut g[..count];
        let mut sum = Work::default();
        let mut start = 0;
        while start < count {
            let end = (start + GROUP).min(count);
            let (low, high) = (&self.low[first + start..first + end], &self.high[first + start..first + end]);
            if any_beyond(&f[start..end], &g[start..end], low, high) {
                for i in start..end {
                    let (node, stress) = (first + i, 0.5 * (f[i] + g[i]));
                    let meeting = Meeting { step, stress, share: INSIDE, time };
                    let Some(drive) = self.drive(law, node, meeting) else { continue };
                    let done = self.driven(law, node, Some(drive), meeting, |excess, sense, history| {
                        law.flow_at(relaxation_step, excess, sense, history)
                    });
                    let drop = INSIDE * done.flow.plastic;
                    self.set(law, node, &done, stress - drop);
                    f[i] -= drop;
                    g[i] -= drop;
                    sum.total += (stress - 0.5 * drop) * done.flow.plastic;
                    sum.overstress += done.flow.overstress;
                }
            }
            start = end;
        }
        sum
    }
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
