//! Fracture where fronts meet: a section fractures at the time at which its state would meet the criterion.
//!
//! Every state of a tracked bar first exists at the position whose Riemann problem creates it, so that only those positions have to be checked. The
//! state that would fracture the section never occurs: both sides respond as free faces instead, and the waves that they emit run with, or ahead of,
//! all others that would have been emitted. Separation dissipates no energy.

use super::FrontTracking;
use super::breaking::{Answer, strained};
use super::joint_clock::Contact;
use super::list::{Kind, NONE, Node};
use super::scale::stress_scale;
use crate::law::rupture::{Rupture, Site};
use crate::wave::riemann::{Path, Point};

impl FrontTracking {
    /// Returns the fractures so far, ordered by time.
    pub fn ruptures(&self) -> &[Rupture] {
        self.rupture.as_ref().map_or(&[], |breaking| &breaking.found)
    }

    /// Returns whether the position x, at a joint or not, fractures instead of reaching these states, and records the fracture.
    pub(super) fn breaks_inside(&mut self, sides: &[Answer; 2], capped: bool, joint: Option<u32>, x: f64) -> bool {
        if joint.is_some_and(|id| self.contacts.iter().any(|contact| contact.node == id)) {
            return false;
        }
        let Some(breaking) = &self.rupture else { return false };
        let left_segment = sides[0].0 as usize;
        let notch = if joint.is_some() { breaking.criteria.joints[left_segment] } else { 1.0 };
        let gathers = capped && sides[1].2.velocity > sides[0].2.velocity;
        let breaks = |(side, path): &(&Answer, &Path)| {
            let medium = &self.media[side.0 as usize];
            // At a joint of unequal sections only one of them may be at its largest stress.
            let level = gathers && path.sense() > 0.0 && side.2.stress >= path.cap() - medium.round_off;
            breaking.breaks(side, medium, notch, level)
        };
        let paths = [&self.scratch.work.left, &self.scratch.work.right];
        // The side that exceeds its criterion most is the one that fractures.
        let share = |side: &Answer| {
            let medium = &self.media[side.0 as usize];
            breaking.criteria.segments[side.0 as usize].share(&strained(medium, &side.2))
        };
        let broken = sides.iter().zip(paths).filter(breaks).map(|(side, _)| *side);
        let Some(side) = broken.reduce(|a, b| if share(&b) > share(&a) { b } else { a }) else { return false };
        let site = if joint.is_some() { Site::Joint(left_segment) } else { Site::Inside(left_segment) };
        self.note(&side, site, x);
        true
    }

    /// Same for an end (0 left, 1 right); `short`: its curve cannot carry the imposed value.
    pub(super) fn breaks_at_end(&mut self, which: usize, answer: Answer, short: bool) -> bool {
        let Some(breaking) = &self.rupture else { return false };
        if !breaking.breaks(&answer, &self.media[answer.0 as usize], 1.0, short) {
            return false;
        }
        let x = self.list.get(self.end_nodes[which]).x;
        self.note(&answer, [Site::Left, Site::Right][which], x);
        true
    }

    fn note(&mut self, &(segment, _, point): &Answer, site: Site, x: f64) {
        let now = self.balance();
        let place = strained(&self.media[segment as usize], &point);
        let time = self.now;
        let Some(breaking) = &mut self.rupture else { return };
        let criterion = &breaking.criteria.segments[segment as usize];
        breaking.found.push(Rupture {
            time,
            x,
            site,
            segment: segment as usize,
            cause: criterion.cause(),
            stress: point.stress,
            strain: criterion.strain(&place),
            absorbed: criterion.absorbed(&place),
            bar_absorbed: now.elastic + now.plastic + now.heat,
        });
    }

    /// Releases an end that breaks off together with the rest of its load. From then on merging is relative to the stresses in the bar and the load
    /// of the other end: relative to a load that never arrives, everything left could be within the tolerance.
    pub(super) fn break_off(&mut self, which: usize) {
        self.ends[which].release();
        self.loads[which] = None;
        let pieces = self.list.iter().filter(|node| node.next != NONE);
        let points: Vec<(usize, Point)> = pieces.map(|node| (node.segment as usize, node.right)).collect();
        let scale = stress_scale(&points, &self.media, self.loads).min(self.stress_scale);
        // In a bar without stress there is nothing to merge.
        if scale > 0.0 {
            self.merging.relate_to(scale, &self.media, self.list.get(self.end_nodes[1]).x);
        }
    }

    /// Separates the bar at x, where no wave has been emitted yet: from now on there are two faces.
    pub(super) fn part(&mut self, prev: u32, joint: Option<u32>, right: Point, x: f64) {
        let segment = self.list.get(prev).segment;
        let id =
            joint.unwrap_or_else(|| self.list.insert(prev, Node::new(Kind::Joint, x, self.now, 0.0, right, segment)));
        self.contacts.push(Contact::broken(id, segment as usize, self.now));
        if !self.resolve_apart(prev, id, right, x) {
            // Faces that press against each other behave as if bonded; a section that fractures in tension has no such faces.
            self.resolve_inside(prev, Some(id), right, x);
        }
    }
}
