//! Merging of fronts: neighbouring waves of one kind are merged if the change of the solution is within the tolerance.
//!
//! Where fans meet reflections, waves multiply without end and become weaker and closer together. At any time the solution is a sum of step functions
//! of x, one for each kind of wave: elastic waves in +x, elastic waves in -x, plastic waves of each speed, and stationary histories. The steps of
//! each function are merged separately: two neighbouring steps are replaced by their mean over their common length. That conserves momentum,
//! displacement and plastic work exactly, and leaves each wave purely of its kind. It removes a little energy, the spread of the averaged values,
//! which is accounted for. Where waves of two kinds cancel each other (an unloading wave within the loading waves that it overtakes), a mean of one
//! kind can contain more energy than what it replaces. Over a run, such merges may add at most the front tolerance times the energy plus the energy
//! that other merges have removed. The change by a merge is measured as it is done: two steps are merged only if the integral of |change| over x
//! stays below the allowance. Nothing is averaged across an end or joint, and next to one only histories are: a piece between a joint and a place
//! where histories differ would stay for good, however short, and every wave that enters it would reverberate.
//!
//! It is not sufficient to hold back weak waves where they arise until the next front arrives: measurements show that the velocity steps left at
//! thousands of contacts add up to more than the signal, even if each is tiny.

use super::FrontTracking;
use super::list::{Kind, NONE, Node};
use super::merging::{Scratch, neighbours};
use super::nearness::{REST, same_motion};
use super::place::Content;
use super::tracking::FrontWork;
use crate::wave::riemann::{Flow, Point};

/// Relative difference (of the elastic wave speed) below which two speeds count as equal.
const SAME_SPEED: f64 = 1e-9;

impl FrontTracking {
    /// Merges neighbouring waves of every kind once.
    pub(super) fn merge_fronts(&mut self) {
        let mut scratch = std::mem::take(&mut self.merging.scratch);
        let energy = self.spread_out(&mut scratch);
        let FrontWork { plastic, heat, against } = self.removed_nodes.front_work;
        self.merging.start(energy, plastic + heat + against);
        let mut start = 0;
        while start + 1 < scratch.ids.len() {
            let end = (start + 1..scratch.ids.len() - 1)
                .find(|&i| scratch.wave[i].is_none())
                .unwrap_or(scratch.ids.len() - 1);
            self.collect_between(&mut scratch, start, end);
            start = end;
        }
        let taken = self.merging.merge(&mut scratch, &self.media);
        self.put_back(&scratch);
        self.merging.energy += taken.energy;
        self.removed_nodes.shifted.momentum -= taken.momentum;
        self.merging.scratch = scratch;
        let nodes = self.list.len();
        self.merging.passed(nodes, self.events);
    }

    /// Copies the list to arrays: nodes, positions, speeds (`None` for a border), and the pieces to their right with their lengths. Returns the
    /// energy of the bar, J.
    fn spread_out(&self, scratch: &mut Scratch) -> f64 {
        scratch.clear();
        let (mut id, mut left, mut content) = (self.end_nodes[0], Point::default(), Content::default());
        while id != NONE {
            let node = self.list.get(id);
            let length = if node.next == NONE { 0.0 } else { self.length_after(node) };
            self.add_piece(node, length, &mut content);
            scratch.ids.push(id);
            scratch.x.push(node.at(self.now));
            scratch.lengths.push(length);
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
        scratch.gone.resize(scratch.ids.len(), false);
        scratch.raised.resize(scratch.ids.len(), false);
        content.energy
    }

    /// Collects the steps between two borders, kind by kind.
    fn collect_between(&self, scratch: &mut Scratch, start: usize, end: usize) {
        let segment = self.list.get(scratch.ids[start]).segment as usize;
        let medium = &self.media[segment];
        let same = SAME_SPEED * medium.c0();
        let elastic = scratch.pieces[start..end].iter().all(|piece| medium.is_on_elastic_line(piece));
        // If the curve is the whole law, a state off its curve is meaningless: beyond the elastic line only waves that follow each other directly
        // along one line of the curve can be merged.
        let across = elastic || medium.flow != Flow::PathIndependent;
        scratch.kind.clear();
        scratch.kind.extend((start + 1..end).filter_map(|i| scratch.wave[i].map(|speed| (speed, i))));
        if across && !elastic && scratch.kind.iter().any(|&(speed, _)| speed == 0.0) {
            // Histories extend to the borders.
            scratch.kind.extend([(0.0, start), (0.0, end)]);
        }
        scratch.kind.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        let mut first = 0;
        while first < scratch.kind.len() {
            let speed = scratch.kind[first].0;
            let last = first + scratch.kind[first..].partition_point(|k| k.0 - speed <= same);
            // Nodes whose speeds differ by rounding are not in order of x.
            scratch.kind[first..last].sort_unstable_by_key(|k| k.1);
            while first < last {
                let next = if across { last } else { first + neighbours(&scratch.kind[first..last]) };
                if next - first > 2 {
                    scratch.collect(first, next, segment, elastic);
                }
                first = next;
            }
        }
    }

    /// Removes the nodes that were merged, and sets states and interactions of the others.
    fn put_back(&mut self, scratch: &Scratch) {
        let last = scratch.ids.len() - 1;
        for i in (1..last).filter(|&i| scratch.gone[i] || scratch.raised[i - 1] || scratch.raised[i]) {
            let (left, node) = (self.list.get(scratch.ids[i - 1]).right, *self.list.get(scratch.ids[i]));
            let changed = left != scratch.pieces[i - 1] || node.right != scratch.pieces[i];
            if node.kind == Kind::Front && (scratch.gone[i] || changed) {
                // The front segment ends here, and another one begins.
                self.keep_front_segment(&node);
                self.book_work_of(&node);
                let node = self.list.get_mut(scratch.ids[i]);
                (node.x, node.t) = (scratch.x[i], self.now);
            }
        }
        for i in 0..last {
            if scratch.gone[i] {
                self.drop_node(scratch.ids[i]);
            } else if scratch.raised[i] {
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
    /// Adds the plastic work that a front, possibly a mean, has done since its start and that the work of the state behind it does not contain. The
    /// mean of two waves has their mean work, but the work of a jump is proportional to the square of its height: if an evenly rising wave has become
    /// one front, the mean exceeds the work of the front. Merging of waves of other kinds may even bring a front to a stress of the opposite sign.
    /// The energy that it returns as it runs is not plastic work, since no material flows against its stress minus its back stress.
    fn add_front_work(&self, node: &Node, sum: &mut FrontWork) {
        if node.kind != Kind::Front || !self.merging.is_on() {
            return;
        }
        let (left, right) = (self.list.get(node.prev).right, node.right);
        let (ahead, behind) = if node.speed > 0.0 { (right, left) } else { (left, right) };
        let medium = &self.media[node.segment as usize];
        let flow = (behind.plastic - ahead.plastic) / medium.modulus;
        let (stress, back) = (0.5 * (ahead.stress + behind.stress), 0.5 * (ahead.back + behind.back));
        let against = match medium.flow {
            Flow::Plastic { .. } => ((stress - back) * flow).min(0.0),
            Flow::PathIndependent | Flow::Overlay => 0.0,
        };
        let passed = |per_volume: f64| per_volume * medium.area * node.speed.abs() * (self.now - node.t);
        let work = passed(stress * flow - against - (behind.work - ahead.work));
        let heats = self.heating(node.segment as usize).map_or(0.0, |heating| heating.fraction);
        sum.plastic += (1.0 - heats) * work;
        sum.heat += heats * work;
        sum.against += passed(against);
    }

    /// Adds this work to the sums, before the front changes or is removed.
    pub(super) fn book_work_of(&mut self, node: &Node) {
        let mut sum = self.removed_nodes.front_work;
        self.add_front_work(node, &mut sum);
        self.removed_nodes.front_work = sum;
    }

    /// Returns this work for all fronts so far.
    pub(super) fn total_front_work(&self) -> FrontWork {
        let mut sum = self.removed_nodes.front_work;
        self.list.iter().for_each(|node| self.add_front_work(node, &mut sum));
        sum
    }
}
