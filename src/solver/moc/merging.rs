//! Selection of the neighbouring steps of one kind that are merged, and the change that this causes.

use std::cmp::{Ordering, Reverse};
use std::collections::BinaryHeap;

use serde::{Deserialize, Serialize};

use super::nearness::REST;
use super::place::Content;
use super::scale::change_weights;
use crate::wave::riemann::{Flow, Medium, Path, Point};

/// Allowance relative to (front tolerance)^2 times stress scale times length. Steps of relative height delta at relative distances delta represent a
/// smooth wave to within delta; steps that are a little closer are merged.
const ALLOWANCE: f64 = 5.0;

/// Fraction of the allowance below which a merge may leave a point past its yield stress, by up to the front tolerance times the stress scale. Merges
/// with larger changes may not do so: a point past its yield stress flows too little from then on and keeps too high a stress, so that such errors
/// would add up in one sense. Small changes have to be allowed because clusters of waves between two converging plastic fronts cannot be merged
/// otherwise. A piece left there is short only at first: pieces between diverging fronts have no length where they begin, so that a merge changes
/// little whatever it does to their stress. Hence the bound on the stress itself.
const SMALL_CHANGE: f64 = 0.25;

/// Least stress change of a jump, relative to the stress scale, and in front tolerances; the larger one applies. Where nothing has flowed, merging
/// changes the states on both sides of a jump by at most [`AT_JUMP`] times the tolerance squared times the stress scale: the largest stresses occur
/// behind jumps, and the mean of a wave that decays behind a jump is lower than its largest stress by several tolerances. (Where plastic waves run to
/// and fro, jumps multiply, and so would the waves kept beside them.)
const JUMP: f64 = 0.05;
const JUMP_TOLERANCES: f64 = 8.0;
const AT_JUMP: f64 = 0.02;

/// Number of nodes below which merging waits for events: a pass would cost more than the few events that it could save.
const FEWEST: usize = 64;

/// Merging is due after the number of nodes has grown by one part in `GROWTH`, at least by `LEAST_GROWTH` nodes, or after this many events per node.
const GROWTH: usize = 32;
const LEAST_GROWTH: usize = 8;
const EVENTS_A_NODE: u64 = 8;

/// Limits of merging, and the sums of what it has changed.
#[derive(Debug, Clone, Default, Serialize, Deserialize)]
pub(super) struct FrontMerging {
    /// Largest integral of |change| of one merge, Pa m; 0 if nothing is merged.
    allowance: f64,
    /// Sum of these integrals over all merges, Pa m.
    pub changed: f64,
    /// Energy removed from the bar, J.
    pub energy: f64,
    /// Energy that the current pass may add, J. Where waves of another kind run through the merged ones and cancel them, a mean contains more energy
    /// than the waves that it replaces.
    credit: f64,
    /// Largest energy that the bar has contained, J.
    largest: f64,
    tolerance: f64,
    /// Stress by which a merge with a small change may take a point past its yield stress, Pa.
    overstress: f64,
    /// Least stress change of a jump, and largest change of the states beside it, Pa.
    jump: f64,
    kept: f64,
    /// For each segment, stress over E times plastic strain where the loading curve reaches the stress scale divided by the segment's weight, see [`change_weights`].
    secant: Vec<f64>,
    /// For each segment, the weight of its stress changes, see [`change_weights`].
    change_weights: Vec<f64>,
    due_at_nodes: usize,
    due_at_events: u64,
    #[serde(skip)]
    pub scratch: Scratch,
}

/// Arrays that are reused from pass to pass.
#[derive(Debug, Clone, Default)]
pub(super) struct Scratch {
    pub ids: Vec<u32>,
    pub x: Vec<f64>,
    pub wave: Vec<Option<f64>>,
    /// States to the right of the nodes, their lengths (m), and whether a merge has changed them.
    pub pieces: Vec<Point>,
    pub lengths: Vec<f64>,
    pub raised: Vec<bool>,
    pub gone: Vec<bool>,
    pub kind: Vec<(f64, usize)>,
    steps: Vec<Step>,
    pairs: BinaryHeap<Reverse<Pair>>,
    trial: Vec<Point>,
}

/// A step of the step function of one kind: it covers the pieces `first..last`, between two nodes of that kind, or for histories also between a node
/// and a border.
#[derive(Debug, Clone, Copy)]
struct Step {
    first: usize,
    last: usize,
    length: f64,
    /// Height above the piece before the first node of its kind, or above the first piece if that node is a border.
    height: Point,
    segment: usize,
    /// Whether nothing has flowed around it.
    elastic: bool,
    /// Indices of the neighbouring steps to its left and right; `NONE` if there is none.
    sides: [usize; 2],
    merged: bool,
}

const NONE: usize = usize::MAX;

/// Number of trailing bits of a change that may be rounding, and fraction of the allowance below which a change may be all rounding.
const ROUNDING_BITS: u32 = 20;
const NO_CHANGE: f64 = 1e-9;

/// Two neighbouring steps, the change if they are merged (Pa m), their distance from the middle of the bar (m), and the speed of their waves away
/// from it (m/s).
#[derive(Debug, Clone, Copy, PartialEq)]
struct Pair {
    change: f64,
    from_middle: f64,
    outwards: f64,
    steps: [usize; 2],
}

impl Pair {
    /// Orders pairs by change. Changes that are equal but for rounding, like those of the even steps of a ramp, are ordered from the middle of the
    /// bar outwards; for two waves at the same position, the one that runs inwards comes first.
    fn compare(&self, other: &Self) -> Ordering {
        let rounded =
            |pair: &Self| (pair.change.to_bits() >> ROUNDING_BITS, pair.from_middle.to_bits() >> ROUNDING_BITS);
        rounded(self).cmp(&rounded(other)).then(self.outwards.total_cmp(&other.outwards))
    }
}

impl Eq for Pair {}

impl PartialOrd for Pair {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for Pair {
    fn cmp(&self, other: &Self) -> Ordering {
        self.compare(other).then(self.steps.cmp(&other.steps))
    }
}

impl FrontMerging {
    pub fn new(tolerance: f64, media: &[Medium], stress_scale: f64, length: f64) -> Self {
        let mut merging =
            Self { tolerance, due_at_nodes: FEWEST, due_at_events: EVENTS_A_NODE * FEWEST as u64, ..Self::default() };
        merging.relate_to(stress_scale, media, length);
        merging
    }

    /// Sets the stress (Pa) and the bar length (m) to which merging is relative.
    pub fn relate_to(&mut self, stress_scale: f64, media: &[Medium], length: f64) {
        self.allowance = ALLOWANCE * self.tolerance * self.tolerance * stress_scale * length;
        self.overstress = self.tolerance * stress_scale;
        self.jump = stress_scale * JUMP.max(JUMP_TOLERANCES * self.tolerance);
        self.kept = AT_JUMP * self.tolerance * self.overstress;
        self.change_weights = change_weights(media, stress_scale);
        self.secant =
            media.iter().zip(&self.change_weights).map(|(m, weight)| secant(m, stress_scale / weight)).collect();
    }

    /// Returns whether there is a tolerance.
    pub fn is_on(&self) -> bool {
        self.allowance > 0.0
    }

    /// Starts a pass through a bar that contains this energy. The pass may add the energy that earlier passes have removed, the work that merged
    /// fronts have done since beyond their mean work (`front_work`, J), and the front tolerance times the largest energy.
    pub fn start(&mut self, energy: f64, front_work: f64) {
        self.largest = self.largest.max(energy);
        self.credit = (self.energy + front_work + self.tolerance * self.largest).max(0.0);
    }

    /// Records a pass that left this number of nodes, after this number of events.
    pub fn passed(&mut self, nodes: usize, events: u64) {
        self.due_at_nodes = (nodes + (nodes / GROWTH).max(LEAST_GROWTH)).max(FEWEST);
        self.due_at_events = events + EVENTS_A_NODE * nodes.max(FEWEST) as u64;
    }

    /// Returns whether this number of nodes or events requires a pass.
    pub fn is_due(&self, nodes: usize, events: u64) -> bool {
        self.is_on() && (nodes > self.due_at_nodes || events > self.due_at_events)
    }
}

impl Scratch {
    /// Clears the nodes of the previous pass.
    pub fn clear(&mut self) {
        self.ids.clear();
        self.x.clear();
        self.wave.clear();
        self.pieces.clear();
        self.lengths.clear();
        self.raised.clear();
        self.gone.clear();
    }

    /// Adds the steps between the nodes `kind[from..to]`, all of one kind. `elastic`: nothing has flowed between the borders around them.
    pub fn collect(&mut self, from: usize, to: usize, segment: usize, elastic: bool) {
        let start = self.steps.len();
        let mut height = Point::default();
        for pair in self.kind[from..to].windows(2) {
            let (first, last) = (pair[0].1, pair[1].1);
            if self.wave[first].is_some() {
                height = height.plus(&self.pieces[first], 1.0).plus(&self.pieces[first - 1], -1.0);
            }
            let length = (self.x[last] - self.x[first]).max(0.0);
            let k = self.steps.len();
            let sides = [if k > start { k - 1 } else { NONE }, k + 1];
            self.steps.push(Step { first, last, length, height, segment, elastic, sides, merged: false });
        }
        if let [.., last] = &mut self.steps[start..] {
            last.sides[1] = NONE;
        }
    }

    /// Replaces two neighbouring steps by one.
    fn replace(&mut self, [a, b]: [usize; 2], height: Point) -> usize {
        let (left, right) = (self.steps[a], self.steps[b]);
        let k = self.steps.len();
        let sides = [left.sides[0], right.sides[1]];
        let length = left.length + right.length;
        self.steps.push(Step { last: right.last, length, height, sides, ..left });
        for (side, neighbour) in sides.into_iter().enumerate().filter(|&(_, neighbour)| neighbour != NONE) {
            self.steps[neighbour].sides[1 - side] = k;
        }
        self.steps[a].merged = true;
        self.steps[b].merged = true;
        self.gone[right.first] = true;
        k
    }

    /// Brings the pieces of two steps to one height and returns the energy and momentum that this removes. Returns `None` and changes nothing if the
    /// energy would be less than `least`; if a piece would be past its yield stress by more than `most` (Pa) and by more than it is already; or if
    /// flow would be taken back that never happened, because where plastic waves of both directions exist the mean of one kind can be less than the
    /// flow due to the others.
    fn set_height(
        &mut self,
        steps: [Step; 2],
        height: &Point,
        medium: &Medium,
        most: f64,
        least: f64,
    ) -> Option<Content> {
        self.trial.clear();
        let rounding = REST * medium.round_off;
        let mut taken = Content::default();
        for step in steps {
            for i in step.first..step.last {
                let piece = &self.pieces[i];
                let mut raised = piece.plus(height, 1.0).plus(&step.height, -1.0);
                if medium.flow != Flow::PathIndependent {
                    let lacking = |point: &Point| point.plastic.abs() - point.accumulated;
                    if lacking(&raised) > lacking(piece).max(0.0) + rounding {
                        return None;
                    }
                    raised.accumulated = raised.accumulated.max(raised.plastic.abs());
                }
                let over = medium.overstress(&raised);
                if over > most + rounding && over > medium.overstress(piece) + rounding {
                    return None;
                }
                let volume = medium.area * self.lengths[i];
                taken.energy += volume * (medium.energy(piece) - medium.energy(&raised));
                taken.momentum += volume * medium.density * (piece.velocity - raised.velocity);
                self.trial.push(raised);
            }
        }
        if taken.energy < least {
            return None;
        }
        let pieces = steps[0].first..steps[1].last;
        self.pieces[pieces.clone()].copy_from_slice(&self.trial);
        self.raised[pieces].fill(true);
        Some(taken)
    }
}

impl FrontMerging {
    /// Merges neighbouring steps as long as the change is within the allowance, and marks the nodes to be removed. Pairs with the smallest change
    /// come first, wherever they are: in the order of positions a bar and its mirror image would be merged differently. Returns the energy and
    /// momentum that this removes from the bar.
    pub fn merge(&mut self, scratch: &mut Scratch, media: &[Medium]) -> Content {
        let mut all = Content::default();
        for k in 0..scratch.steps.len() {
            self.consider([k, scratch.steps[k].sides[1]], scratch, media);
        }
        while let Some(Reverse(Pair { change, steps, .. })) = scratch.pairs.pop() {
            let [a, b] = steps.map(|k| scratch.steps[k]);
            if a.merged || b.merged {
                continue;
            }
            let share = share(&a, &b);
            let height = a.height.plus(&b.height, share).plus(&a.height, -share);
            let medium = &media[a.segment];
            let most = if change > SMALL_CHANGE * self.allowance || medium.flow == Flow::PathIndependent {
                0.0
            } else {
                self.overstress / self.change_weights[a.segment]
            };
            let Some(taken) = scratch.set_height([a, b], &height, medium, most, -self.credit) else { continue };
            self.credit += taken.energy;
            self.changed += change;
            all.energy += taken.energy;
            all.momentum += taken.momentum;
            let k = scratch.replace(steps, height);
            let sides = scratch.steps[k].sides;
            self.consider([sides[0], k], scratch, media);
            self.consider([k, sides[1]], scratch, media);
        }
        scratch.steps.clear();
        all
    }

    /// Adds two steps to the candidates for merging.
    fn consider(&self, steps: [usize; 2], scratch: &mut Scratch, media: &[Medium]) {
        if !steps.contains(&NONE) {
            let pair = self.pair(steps, scratch, media);
            scratch.pairs.extend(pair.map(Reverse));
        }
    }

    /// Returns two steps and the change if they are merged; `None` if it exceeds the allowance.
    fn pair(&self, steps: [usize; 2], scratch: &Scratch, media: &[Medium]) -> Option<Pair> {
        let [a, b] = steps.map(|k| &scratch.steps[k]);
        let medium = &media[a.segment];
        let (distance, share) = (self.distance(&a.height, &b.height, medium, a.segment), share(a, b));
        let change = distance * 2.0 * a.length * share;
        // Histories are steepest beside ends and joints, where the flow matters most, so that less change is allowed.
        let at_border = [a.first, b.last].iter().any(|&node| scratch.wave[node].is_none());
        let allowance = if at_border { SMALL_CHANGE * self.allowance } else { self.allowance };
        if change > allowance || a.elastic && self.changes_peak([a, b], distance, share, scratch, medium) {
            return None;
        }
        let change = if change < NO_CHANGE * self.allowance { 0.0 } else { change };
        let beyond_middle = scratch.x[b.first] - 0.5 * (scratch.x[0] + scratch.x[scratch.x.len() - 1]);
        let outwards = scratch.wave[b.first].map_or(0.0, |speed| speed * beyond_middle.signum());
        Some(Pair { change, from_middle: beyond_middle.abs(), outwards, steps })
    }

    /// Returns whether the mean of two steps, the second of which has the fraction `share` of their length, would change the height of a step beside
    /// a jump. This applies to a wave that decays behind the jump, not to a short pulse between two jumps.
    fn changes_peak(&self, [a, b]: [&Step; 2], distance: f64, share: f64, scratch: &Scratch, medium: &Medium) -> bool {
        let between = distance > self.jump;
        let blunted = |step: &Step, side: usize, share: f64| {
            share * distance > self.kept && (self.beside(step, side, scratch, medium) > self.jump) != between
        };
        blunted(a, 0, share) || blunted(b, 1, 1.0 - share)
    }

    /// Difference between the heights on both sides of a step's first (0) or last (1) node, Pa.
    fn beside(&self, step: &Step, side: usize, scratch: &Scratch, medium: &Medium) -> f64 {
        let (node, neighbour) = ([step.first, step.last][side], step.sides[side]);
        let heights = if neighbour == NONE {
            [&scratch.pieces[node - 1], &scratch.pieces[node]]
        } else {
            [&step.height, &scratch.steps[neighbour].height]
        };
        self.distance(heights[0], heights[1], medium, step.segment)
    }

    /// Difference of two heights, Pa: in stress, in the stress of an elastic wave of that velocity difference, or in the stress that corresponds to
    /// that difference of plastic strain, whichever is largest. It is weighted by the [`change_weights`] of the segment.
    fn distance(&self, a: &Point, b: &Point, medium: &Medium, segment: usize) -> f64 {
        let history = (a.accumulated - b.accumulated).abs().max((a.plastic - b.plastic).abs());
        let stress = (a.stress - b.stress).abs().max((a.velocity - b.velocity).abs() * medium.impedance());
        stress.max(history * self.secant[segment]) * self.change_weights[segment]
    }
}

/// Returns the fraction of the total length that belongs to the second step.
fn share(a: &Step, b: &Step) -> f64 {
    let length = a.length + b.length;
    if length > 0.0 { b.length / length } else { 0.5 }
}

/// Returns how many of these nodes, from the first one on, are neighbours in x.
pub(super) fn neighbours(kind: &[(f64, usize)]) -> usize {
    1 + kind.windows(2).take_while(|pair| pair[1].1 == pair[0].1 + 1).count()
}

/// Returns stress over E times plastic strain where the loading curve reaches `stress`, or at its largest stress if it never does; 1 if it is elastic
/// up to there. A bar of smaller section can flow all the same, and flow must not be averaged at no cost.
fn secant(medium: &Medium, stress: f64) -> f64 {
    let (mut path, mut sent) = (Path::default(), Vec::new());
    path.fill(medium, &Point::default(), 1.0);
    let point = path.emit(stress.min(path.cap()), 1.0, &mut sent);
    if point.plastic > 0.0 { point.stress / point.plastic } else { 1.0 }
}
