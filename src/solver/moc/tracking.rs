//! Advances the fronts from one event to the next.

use std::cmp::Reverse;
use std::collections::BinaryHeap;
use std::sync::Arc;

use serde::{Deserialize, Serialize};

use super::breaking::Breaking;
use super::end::{End, Scales, face};
use super::interaction::Interaction;
use super::joint_clock::Contact;
use super::known_limits::Limits;
use super::list::{Kind, List, NONE, Node};
use super::merging::FrontMerging;
use super::nearness::{Nearness, SAME_STRESS};
use super::openings::Openings;
use super::place::Shifted;
use super::scale::{Load, load, stress_scale};
use super::{FrontSegment, Settings, Stopped};
use crate::bar::{Bar, EndCondition, Segment};
use crate::law::Table;
use crate::law::rupture::Criteria;
use crate::material::{Material, Sense};
use crate::wave::riemann::{Emitted, Flow, Medium, Point, Workspace};

/// Scratch for Riemann problems: the paths of both sides, and the waves that they emit.
#[derive(Debug, Clone, Default)]
pub(super) struct Scratch {
    pub work: Workspace,
    pub sent_left: Vec<Emitted>,
    pub sent_right: Vec<Emitted>,
}

/// Work of fronts that the states behind them do not contain, J.
#[derive(Debug, Clone, Copy, Default, Serialize, Deserialize)]
pub(super) struct FrontWork {
    /// Plastic work that was not converted to heat.
    pub plastic: f64,
    pub heat: f64,
    /// Negative work of flow against the stress, to which merging has brought a front; it is numerical.
    pub against: f64,
}

/// Sums over nodes that no longer exist.
#[derive(Debug, Clone, Default, Serialize, Deserialize)]
pub(super) struct RemovedNodeSums {
    /// Work dissipated at single points, J.
    pub concentrated: f64,
    /// Work of fronts that the states behind them do not contain, J.
    pub front_work: FrontWork,
    pub shifted: Shifted,
    pub opened: Openings,
}

/// A bar whose fronts are tracked.
#[derive(Debug, Clone)]
pub struct FrontTracking {
    pub(super) media: Vec<Medium>,
    /// Material of each segment.
    pub(super) materials: Vec<Arc<Material>>,
    pub(super) limits: Limits,
    pub(super) ends: [End; 2],
    pub(super) end_nodes: [u32; 2],
    /// Joints that can open.
    pub(super) contacts: Vec<Contact>,
    pub(super) list: List,
    pub(super) queue: BinaryHeap<Reverse<Interaction>>,
    pub(super) now: f64,
    pub(super) events: u64,
    pub(super) budget: u64,
    pub(super) nearness: Nearness,
    pub(super) stress_scale: f64,
    /// Loads that the left and the right end impose; `None` once the end has broken off.
    pub(super) loads: [Option<Load>; 2],
    pub(super) fronts: usize,
    pub(super) removed_nodes: RemovedNodeSums,
    pub(super) merging: FrontMerging,
    /// Whether a ramp was replaced by steps, or a body moves in steps.
    pub(super) in_steps: bool,
    /// Front segments of fronts that ended; `None` if they are not recorded.
    pub(super) front_segments: Option<Vec<FrontSegment>>,
    pub(super) scratch: Scratch,
    /// Fracture criteria and fractures; `None` if the bar never fractures.
    pub(super) rupture: Option<Box<Breaking>>,
}

impl FrontTracking {
    /// Creates a bar at t = 0 with its ends; every segment flows according to `flow`.
    pub fn new(bar: &Bar, flow: Flow, ends: [EndCondition; 2], settings: Settings) -> Self {
        Self::that_breaks(bar, flow, (ends, bar.end_velocities()), settings, None)
    }

    /// Same for a bar that fractures where it meets one of `criteria`. `end_velocities` (m/s) are those of the two end faces at t = 0; the steps of a
    /// staircase next to them have mean velocities.
    pub fn that_breaks(
        bar: &Bar,
        flow: Flow,
        (ends, end_velocities): ([EndCondition; 2], [f64; 2]),
        settings: Settings,
        criteria: Option<Criteria>,
    ) -> Self {
        let last = bar.segments.len() - 1;
        let mut media: Vec<Medium> = bar.segments.iter().map(|s| medium(s, flow)).collect();
        let starts: Vec<Vec<Start>> = bar.segments.iter().zip(&media).map(|(s, medium)| starts(s, medium)).collect();
        let outer = [starts[0][0].point, starts[last][starts[last].len() - 1].point];
        let faces = [face(1.0, end_velocities[0], &media[0]), face(-1.0, end_velocities[1], &media[last])];
        let loads = [Some(load(&ends[0], &faces[0])), Some(load(&ends[1], &faces[1]))];
        let stress_scale = stress_scale(&all_points(&starts), &media, loads);
        for medium in &mut media {
            medium.round_off = SAME_STRESS * stress_scale;
        }
        let merging = FrontMerging::new(settings.front_tolerance, &media, stress_scale, bar.length());
        let transit = bar.transit_time();
        let nearness = Nearness::new(bar.length(), transit, settings.front_tolerance);
        let scales = Scales {
            stress: stress_scale,
            step: settings.step(),
            transit,
            same_time: nearness.time,
            same_stress: SAME_STRESS * stress_scale,
        };
        let [left, right] = ends;
        let ends = [(left, faces[0], outer[0]), (right, faces[1], outer[1])];
        let ends = ends.map(|(condition, face, start)| End::new(&condition, face, start, scales));
        let in_steps = ends.iter().any(End::needs_steps);
        let mut tracking = Self {
            media,
            materials: bar.segments.iter().map(|s| Arc::clone(&s.material)).collect(),
            limits: Limits::new(bar, settings.stop_at_limits),
            ends,
            end_nodes: [0, 0],
            contacts: Contact::all(bar),
            list: List::default(),
            queue: BinaryHeap::new(),
            now: 0.0,
            events: 0,
            budget: settings.event_budget,
            nearness,
            stress_scale,
            loads,
            fronts: 0,
            removed_nodes: RemovedNodeSums::default(),
            merging,
            in_steps,
            front_segments: settings.front_segments.then(Vec::new),
            scratch: Scratch::default(),
            rupture: criteria.map(|criteria| Box::new(Breaking::new(criteria))),
        };
        tracking.lay_out(bar, &starts);
        tracking
    }

    /// Places the ends and joints, and emits their waves at t = 0.
    fn lay_out(&mut self, bar: &Bar, starts: &[Vec<Start>]) {
        let (mut x, mut after) = (0.0, NONE);
        for (k, (segment, starts)) in bar.segments.iter().zip(starts).enumerate() {
            let kind = if k == 0 { Kind::End } else { Kind::Joint };
            after = self.list.insert(after, Node::new(kind, x, 0.0, 0.0, starts[0].point, k as u32));
            x += segment.length;
        }
        let last = bar.segments.len() - 1;
        let end = Node::new(Kind::End, x, 0.0, 0.0, Point::default(), last as u32);
        self.end_nodes = [0, self.list.insert(after, end)];
        // Indices are given out in order, so that they number the ends and joints from left to right.
        let mut all: Vec<u32> = (0..=self.end_nodes[1]).collect();
        for (k, starts) in starts.iter().enumerate() {
            let (from, mut after) = (self.list.get(k as u32).x, k as u32);
            for Start { x, point } in &starts[1..] {
                after = self.list.insert(after, Node::new(Kind::Contact, from + x, 0.0, 0.0, *point, k as u32));
                all.push(after);
            }
        }
        for id in all {
            self.resolve(id, id, self.list.get(id).x);
        }
    }

    /// Advances the fronts up to and including `until` (s). Does nothing if `until` is NaN.
    ///
    /// # Errors
    /// [`Stopped::EventBudget`], with the bar valid at the time reached; [`Stopped::NotANumber`]; [`Stopped::AtLimit`].
    pub fn advance_to(&mut self, until: f64) -> Result<(), Stopped> {
        // No comparison with NaN is true.
        let until = if until.is_nan() { self.now } else { until };
        loop {
            self.limits.check(until)?;
            let interaction = self.next_interaction();
            let (own, id) = self.next_own();
            let time = interaction.map_or(f64::INFINITY, |m| m.time).min(own);
            // Not between events of equal time, whose order depends on rounding.
            if time > self.now + self.nearness.time && self.merging.is_due(self.list.len(), self.events) {
                self.merge_fronts();
                continue;
            }
            if time > until + self.nearness.time {
                self.now = self.now.max(until);
                return Ok(());
            }
            if self.events >= self.budget {
                return Err(Stopped::EventBudget { time: self.now, events: self.events, fronts: self.fronts });
            }
            self.events += 1;
            self.now = self.now.max(time);
            match interaction {
                Some(m) if m.time <= time => self.interact(m)?,
                _ => self.gather(id, id, self.list.get(id).x)?,
            }
        }
    }

    /// Returns the time (s) and the node of the next event of an end or joint that no front causes.
    fn next_own(&self) -> (f64, u32) {
        let [left, right] = self.ends.each_ref().map(End::next_time);
        let mut first = if right < left { (right, self.end_nodes[1]) } else { (left, self.end_nodes[0]) };
        for contact in &self.contacts {
            if contact.closes < first.0 {
                first = (contact.closes, contact.node);
            }
        }
        first
    }

    /// Returns the next interaction that is still valid, without removing it from the queue.
    fn next_interaction(&mut self) -> Option<Interaction> {
        while let Some(&Reverse(m)) = self.queue.peek() {
            let (left, right) = (self.list.get(m.left), self.list.get(m.right));
            if left.stamp == m.left_stamp && right.stamp == m.right_stamp && left.next == m.right {
                return Some(m);
            }
            self.queue.pop();
        }
        None
    }

    fn interact(&mut self, m: Interaction) -> Result<(), Stopped> {
        self.queue.pop();
        let (left, right) = (self.list.get(m.left), self.list.get(m.right));
        // A stationary node gives the position exactly; otherwise the slower one is more accurate.
        let x = if right.speed.abs() < left.speed.abs() { right.at(self.now) } else { left.at(self.now) };
        self.gather(m.left, m.right, x)
    }

    /// Collects all neighbours that are also at x, and resolves the interaction of all of them.
    fn gather(&mut self, mut first: u32, mut last: u32, x: f64) -> Result<(), Stopped> {
        let slower = |a: f64, b: f64| if a.abs() < b.abs() { a } else { b };
        let mut slowest = slower(self.list.get(first).speed, self.list.get(last).speed);
        while self.is_there(self.list.get(first).prev, x, 1.0, slowest) {
            first = self.list.get(first).prev;
            slowest = slower(slowest, self.list.get(first).speed);
        }
        while self.is_there(self.list.get(last).next, x, -1.0, slowest) {
            last = self.list.get(last).next;
            slowest = slower(slowest, self.list.get(last).speed);
        }
        let x = self.common_place(first, last, x);
        if !x.is_finite() {
            return Err(Stopped::NotANumber { time: self.now, x });
        }
        self.resolve(first, last, x);
        Ok(())
    }

    /// Returns whether a node is at x, or next to it and not moving away; `towards` is +1 for a node on the left. Ends and joints count only at x:
    /// otherwise, waves that leave them slower than the waves that meet them would be brought back again and again.
    fn is_there(&self, id: u32, x: f64, towards: f64, slowest: f64) -> bool {
        if id == NONE {
            return false;
        }
        let node = self.list.get(id);
        let distance = (node.at(self.now) - x).abs();
        let is_left = node.is_fixed() && towards * slowest > 0.0;
        distance <= self.nearness.place || (distance <= self.nearness.near && towards * node.speed >= 0.0 && !is_left)
    }

    /// Returns the position where the nodes `first..=last` meet, m, if it is at x to within the nearness: that of an end or joint; that of a
    /// stationary node; if the nodes are apart from each other, the mean of their positions weighted by their steps in history, so that no plastic
    /// flow is lost.
    fn common_place(&self, first: u32, last: u32, x: f64) -> f64 {
        let (mut place, mut moment, mut sum, mut id) = (x, 0.0, 0.0, first);
        loop {
            let node = self.list.get(id);
            if node.is_fixed() {
                return node.x;
            }
            if node.speed == 0.0 {
                place = node.x;
            }
            let (left, right) = (self.list.get(node.prev).right, node.right);
            let step = (right.accumulated - left.accumulated).abs() + (right.plastic - left.plastic).abs();
            moment += step * (node.at(self.now) - x);
            sum += step;
            if id == last {
                break;
            }
            id = node.next;
        }
        let apart = self.list.get(last).at(self.now) - self.list.get(first).at(self.now);
        if sum > 0.0 && apart > self.nearness.place { x + moment / sum } else { place }
    }

    /// Schedules the interaction of a node with the next one, if they will ever meet.
    pub(super) fn schedule(&mut self, left: u32) {
        let a = self.list.get(left);
        if a.next == NONE {
            return;
        }
        let b = self.list.get(a.next);
        let closing = a.speed - b.speed;
        if closing > 0.0 {
            let distance = (b.at(self.now) - a.at(self.now)).max(0.0);
            self.queue.push(Reverse(Interaction {
                time: self.now + distance / closing,
                left,
                right: a.next,
                left_stamp: a.stamp,
                right_stamp: b.stamp,
            }));
        }
    }
}

fn medium(segment: &Segment, flow: Flow) -> Medium {
    let material = &segment.material;
    let table = |sense| Table::new(material.branch(sense), material.modulus);
    let (tension, compression) = (table(Sense::Tension), table(Sense::Compression));
    Medium::new([&tension, &compression], material.modulus, material.density, segment.area, flow, 0.0)
}

/// Returns every state at t = 0 with the index of its segment.
fn all_points(starts: &[Vec<Start>]) -> Vec<(usize, Point)> {
    let of = |(k, starts): (usize, &Vec<Start>)| starts.iter().map(|start| (k, start.point)).collect::<Vec<_>>();
    starts.iter().enumerate().flat_map(of).collect()
}

/// A state at t = 0 from the position `x` on (m from the left end of its segment).
struct Start {
    x: f64,
    point: Point,
}

/// Returns the states of a segment at t = 0 from left to right: one state, or the mean between every two rows of its tables, which are those of
/// staircases. Equal neighbouring states are merged.
fn starts(segment: &Segment, medium: &Medium) -> Vec<Start> {
    let mut borders = segment.profile.as_ref().map_or_else(|| vec![0.0], |profile| profile.knots());
    borders.retain(|&x| x < segment.length);
    borders.push(segment.length);
    let state = |pair: &[f64]| {
        let (initial, velocity) =
            (segment.initial_between(pair[0], pair[1]), segment.velocity_between(pair[0], pair[1]));
        let point = Point { stress: initial.stress, velocity, ..medium.deformed(&initial.deformed(medium.modulus)) };
        Start { x: pair[0], point }
    };
    let mut starts: Vec<Start> = borders.windows(2).map(state).collect();
    starts.dedup_by(|next, before| next.point == before.point);
    starts
}
