//! Merging of fronts: neighbouring waves of one kind become one where that changes the solution by less than is allowed.
//!
//! Where fans meet reflections, waves multiply without end, ever weaker and closer together. At any moment the
//! solution is a sum of step functions of x, one for each kind of wave: elastic waves in +x, elastic waves in -x,
//! plastic waves of one speed, and the histories, which stand still. The steps of each function are merged by themselves: two
//! neighbouring steps are replaced by their mean over their common length. That keeps momentum, displacement and
//! plastic work exactly, and leaves pure waves pure. It takes a little energy, the spread of what is averaged, which is
//! booked. What it changes is measured as it is done: two steps become one only where the integral of |change| over x
//! stays below the allowance. Nothing is ever averaged across an end or a joint, nor next to one.
//!
//! To hold weak waves back where they arise, until the next front comes by, is not good enough: measured, the steps in
//! velocity that stay behind at thousands of contacts add up to more than the signal, even if each is tiny.

use super::FrontTracking;
use super::list::{Kind, NONE, Node};
use super::nearness::{REST, same_motion};
use crate::wave::riemann::{Flow, Medium, Path, Point};

/// The allowance, over (front tolerance)^2 times stress scale times length. Steps of height delta that are delta apart
/// make up a smooth wave to within delta; those that are a little closer become one.
const ALLOWANCE: f64 = 4.0;

/// A merge that changes less than this part of the allowance may leave a point past its yield stress. Larger ones may
/// not: a point past its yield stress flows too little from then on and keeps its stress too high, so such errors would
/// add up in one sense; but the clusters of waves between two plastic fronts that close in on each other have no
/// other way out, and what stays behind there is a speck.
const TRIFLE: f64 = 0.1;

/// Speeds closer than this part of the elastic wave speed are one speed.
const SAME_SPEED: f64 = 1e-9;

/// Below this many nodes merging waits for events: a passage costs more than the few events that it could save.
const FEWEST: usize = 64;

/// Merging is due after a growth by this part, by `LEAST_GROWTH` nodes at the least, and after this many events a node.
const GROWTH: usize = 32;
const LEAST_GROWTH: usize = 8;
const EVENTS_A_NODE: u64 = 8;

/// What merging is allowed, and what it did.
#[derive(Debug, Clone, Default)]
pub struct FrontMerging {
    /// Largest integral of |change| of one merge, Pa m; 0: nothing is merged.
    allowance: f64,
    /// Sum of all of them, Pa m.
    pub changed: f64,
    /// Energy taken, J.
    pub energy: f64,
    /// For each segment: stress over E times plastic strain where the loading curve reaches the stress scale.
    secant: Vec<f64>,
    due_at_nodes: usize,
    due_at_events: u64,
    scratch: Scratch,
}

/// Arrays that are used again and again.
#[derive(Debug, Clone, Default)]
struct Scratch {
    ids: Vec<u32>,
    x: Vec<f64>,
    wave: Vec<Option<f64>>,
    pieces: Vec<Point>,
    gone: Vec<bool>,
    kind: Vec<(f64, usize)>,
    old: Vec<Step>,
    new: Vec<Step>,
    lifted: Vec<Point>,
}

/// A step of one kind's function: over the pieces `first..last`, between two nodes of that kind.
#[derive(Debug, Clone, Copy)]
struct Step {
    first: usize,
    last: usize,
    length: f64,
    /// Height above the piece before the first node.
    height: Point,
}

impl FrontMerging {
    pub fn new(tolerance: f64, media: &[Medium], stress_scale: f64, length: f64) -> Self {
        Self {
            allowance: ALLOWANCE * tolerance * tolerance * stress_scale * length,
            secant: media.iter().map(|m| secant(m, stress_scale)).collect(),
            due_at_nodes: FEWEST,
            due_at_events: EVENTS_A_NODE * FEWEST as u64,
            ..Self::default()
        }
    }

    /// Whether there is a tolerance.
    pub fn is_on(&self) -> bool {
        self.allowance > 0.0
    }

    /// Whether so many nodes and events call for a passage.
    pub fn is_due(&self, nodes: usize, events: u64) -> bool {
        self.is_on() && (nodes > self.due_at_nodes || events > self.due_at_events)
    }
}

impl FrontTracking {
    /// Merges neighbouring waves of every kind once.
    pub(super) fn merge_fronts(&mut self) {
        let mut scratch = std::mem::take(&mut self.merging.scratch);
        self.spread_out(&mut scratch);
        let before = self.content(self.end_nodes[0], self.end_nodes[1]);
        let mut start = 0;
        while start + 1 < scratch.ids.len() {
            let end = (start + 1..scratch.ids.len() - 1)
                .find(|&i| scratch.wave[i].is_none())
                .unwrap_or(scratch.ids.len() - 1);
            self.merge_between(&mut scratch, start, end);
            start = end;
        }
        self.put_back(&scratch);
        let after = self.content(self.end_nodes[0], self.end_nodes[1]);
        self.merging.energy += before.energy - after.energy;
        self.booked.shifted.momentum += after.momentum - before.momentum;
        self.merging.scratch = scratch;
        let nodes = self.list.len();
        self.merging.due_at_nodes = (nodes + (nodes / GROWTH).max(LEAST_GROWTH)).max(FEWEST);
        self.merging.due_at_events = self.events + EVENTS_A_NODE * nodes.max(FEWEST) as u64;
    }

    /// The list as arrays: nodes, where they are, how fast (none: a border), and the pieces to their right.
    fn spread_out(&self, scratch: &mut Scratch) {
        scratch.ids.clear();
        scratch.x.clear();
        scratch.wave.clear();
        scratch.pieces.clear();
        let (mut id, mut left) = (self.end_nodes[0], Point::default());
        while id != NONE {
            let node = self.list.get(id);
            scratch.ids.push(id);
            scratch.x.push(node.at(self.now));
            scratch.pieces.push(node.right);
            scratch.wave.push(match node.kind {
                Kind::Front => Some(node.speed),
                Kind::Contact => {
                    let medium = &self.media[node.segment as usize];
                    same_motion(&left, &node.right, medium, 2.0 * REST).then_some(0.0)
                }
                Kind::End | Kind::Joint => None,
            });
            left = node.right;
            id = node.next;
        }
        scratch.gone.clear();
        scratch.gone.resize(scratch.ids.len(), false);
    }

    /// The nodes between two borders, kind by kind.
    fn merge_between(&mut self, scratch: &mut Scratch, start: usize, end: usize) {
        let segment = self.list.get(scratch.ids[start]).segment as usize;
        let medium = &self.media[segment];
        let same = SAME_SPEED * medium.c0();
        // A state off its curve means nothing where the curve is all the law: there only waves that follow each other
        // directly, along one line of the curve, can become one.
        let across = medium.flow != Flow::PathIndependent;
        scratch.kind.clear();
        scratch.kind.extend((start + 1..end).filter_map(|i| scratch.wave[i].map(|speed| (speed, i))));
        scratch.kind.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        let mut first = 0;
        while first < scratch.kind.len() {
            let speed = scratch.kind[first].0;
            let last = first + scratch.kind[first..].partition_point(|k| k.0 - speed <= same);
            // Speeds that differ by rounding are out of order in x.
            scratch.kind[first..last].sort_unstable_by_key(|k| k.1);
            while first < last {
                let next = if across { last } else { first + neighbours(&scratch.kind[first..last]) };
                if next - first > 2 {
                    scratch.collect(first, next);
                    self.merging.merge(scratch, &self.media[segment], segment);
                }
                first = next;
            }
        }
    }

    /// Takes out the nodes that are gone and sets the states and meetings of the others.
    fn put_back(&mut self, scratch: &Scratch) {
        let last = scratch.ids.len() - 1;
        for i in 1..last {
            let (left, node) = (self.list.get(scratch.ids[i - 1]).right, *self.list.get(scratch.ids[i]));
            let changed = left != scratch.pieces[i - 1] || node.right != scratch.pieces[i];
            if node.kind == Kind::Front && (scratch.gone[i] || changed) {
                // Its trail ends here, and another one goes on.
                self.keep_trail(&node);
                self.merging.energy += self.unbooked(&node);
                let node = self.list.get_mut(scratch.ids[i]);
                (node.x, node.t) = (scratch.x[i], self.now);
            }
        }
        for i in 0..last {
            if scratch.gone[i] {
                self.drop_node(scratch.ids[i]);
            } else {
                self.list.get_mut(scratch.ids[i]).right = scratch.pieces[i];
            }
        }
        for i in 0..last {
            if !scratch.gone[i] && scratch.gone[i + 1] {
                self.schedule(scratch.ids[i]);
            }
        }
    }
}

impl FrontTracking {
    /// Energy that a front has taken since its start and that the work behind it does not show, J. The mean of two waves
    /// has their mean work, but the work of a jump goes with the square of its height.
    pub(super) fn unbooked(&self, node: &Node) -> f64 {
        let (left, right) = (self.list.get(node.prev).right, node.right);
        let (ahead, behind) = if node.speed > 0.0 { (right, left) } else { (left, right) };
        let medium = &self.media[node.segment as usize];
        let flow = (behind.plastic - ahead.plastic) / medium.modulus;
        let taken = 0.5 * (ahead.stress + behind.stress) * flow - (behind.work - ahead.work);
        taken * medium.area * node.speed.abs() * (self.now - node.t)
    }

    /// Energy that merging has taken so far, J.
    pub(super) fn merged_energy(&self) -> f64 {
        if !self.merging.is_on() {
            return 0.0;
        }
        let fronts = self.list.iter().filter(|n| n.kind == Kind::Front);
        self.merging.energy + fronts.map(|n| self.unbooked(n)).sum::<f64>()
    }
}

impl Scratch {
    /// The steps between the nodes `kind[from..to]`, all of one kind.
    fn collect(&mut self, from: usize, to: usize) {
        self.old.clear();
        let mut height = Point::default();
        for pair in self.kind[from..to].windows(2) {
            let (first, last) = (pair[0].1, pair[1].1);
            height = height.plus(&self.pieces[first], 1.0).plus(&self.pieces[first - 1], -1.0);
            self.old.push(Step { first, last, length: (self.x[last] - self.x[first]).max(0.0), height });
        }
    }

    /// Lifts the pieces of two steps to one height; where `strict`, not if that takes one of them past its yield stress.
    fn lift(&mut self, steps: [Step; 2], height: &Point, medium: &Medium, strict: bool) -> bool {
        self.lifted.clear();
        for step in steps {
            for piece in &self.pieces[step.first..step.last] {
                let mut lifted = piece.plus(height, 1.0).plus(&step.height, -1.0);
                // Rounding must not take back flow that never was.
                lifted.accumulated = lifted.accumulated.max(0.0);
                if strict && medium.overstress(&lifted) > (medium.round_off * REST).max(medium.overstress(piece)) {
                    return false;
                }
                self.lifted.push(lifted);
            }
        }
        self.pieces[steps[0].first..steps[1].last].copy_from_slice(&self.lifted);
        true
    }
}

impl FrontMerging {
    /// Makes neighbouring steps one as long as that changes no more than allowed; marks the nodes that go.
    fn merge(&mut self, scratch: &mut Scratch, medium: &Medium, segment: usize) {
        scratch.new.clear();
        for k in 0..scratch.old.len() {
            scratch.new.push(scratch.old[k]);
            while let [.., a, b] = scratch.new[..] {
                let length = a.length + b.length;
                let share = if length > 0.0 { b.length / length } else { 0.5 };
                let change = self.distance(&a.height, &b.height, medium, segment) * 2.0 * a.length * share;
                if change > self.allowance {
                    break;
                }
                let height = a.height.plus(&b.height, share).plus(&a.height, -share);
                if !scratch.lift([a, b], &height, medium, change > TRIFLE * self.allowance) {
                    break;
                }
                self.changed += change;
                scratch.new.truncate(scratch.new.len() - 2);
                scratch.new.push(Step { first: a.first, last: b.last, length, height });
                scratch.gone[b.first] = true;
            }
        }
    }

    /// How far two heights are apart, Pa: in stress, in the stress of an elastic wave of that velocity, or in the stress
    /// that goes with that plastic strain.
    fn distance(&self, a: &Point, b: &Point, medium: &Medium, segment: usize) -> f64 {
        let history = (a.accumulated - b.accumulated).abs().max((a.plastic - b.plastic).abs());
        let stress = (a.stress - b.stress).abs().max((a.velocity - b.velocity).abs() * medium.impedance());
        stress.max(history * self.secant[segment])
    }
}

/// How many of these nodes, from the first on, are neighbours in x.
fn neighbours(kind: &[(f64, usize)]) -> usize {
    1 + kind.windows(2).take_while(|pair| pair[1].1 == pair[0].1 + 1).count()
}

/// Stress over E times plastic strain where the loading curve reaches `stress`, at its largest where it never does; 1 where it is
/// elastic up to there: a bar of smaller section can flow all the same, and what has flowed must not be averaged for nothing.
fn secant(medium: &Medium, stress: f64) -> f64 {
    let (mut path, mut sent) = (Path::default(), Vec::new());
    path.fill(medium, &Point::default(), 1.0);
    let point = path.emit(stress.min(path.cap()), 1.0, &mut sent);
    if point.plastic > 0.0 { point.stress / point.plastic } else { 1.0 }
}
