//! The fronts from one event to the next.

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

/// Room for Riemann problems: the paths of both sides, and the waves that they send.
#[derive(Debug, Clone, Default)]
pub(super) struct Scratch {
    pub work: Workspace,
    pub sent_left: Vec<Emitted>,
    pub sent_right: Vec<Emitted>,
}

/// Work of fronts that is not that of a state, J.
#[derive(Debug, Clone, Copy, Default, Serialize, Deserialize)]
pub(super) struct Unshown {
    /// Plastic work that did not turn into heat.
    pub plastic: f64,
    pub heat: f64,
    /// Of flow against the stress, to which merging has brought a front: <= 0, and the scheme's.
    pub against: f64,
}

/// What nodes that are gone leave in the accounts.
#[derive(Debug, Clone, Default, Serialize, Deserialize)]
pub(super) struct Booked {
    /// Work taken at single points, J.
    pub concentrated: f64,
    /// Work of fronts that the states behind them do not show, J.
    pub unshown: Unshown,
    pub shifted: Shifted,
    pub opened: Openings,
}

/// A bar whose fronts are tracked.
#[derive(Debug, Clone)]
pub struct FrontTracking {
    pub(super) media: Vec<Medium>,
    /// What each segment is made of.
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
    /// What the left and the right end impose; none once it has broken off.
    pub(super) loads: [Option<Load>; 2],
    pub(super) fronts: usize,
    pub(super) booked: Booked,
    pub(super) merging: FrontMerging,
    /// A ramp was made into steps, or a body moves in steps.
    pub(super) in_steps: bool,
    /// Front segments of fronts that ended; none where they are not asked for.
    pub(super) front_segments: Option<Vec<FrontSegment>>,
    pub(super) scratch: Scratch,
    /// Where and when the bar breaks; none where it never does.
    pub(super) rupture: Option<Box<Breaking>>,
}

impl FrontTracking {
    /// A bar at t = 0 with its ends; every segment flows as `flow` says.
    pub fn new(bar: &Bar, flow: Flow, ends: [EndCondition; 2], settings: Settings) -> Self {
        Self::that_breaks(bar, flow, (ends, bar.end_velocities()), settings, None)
    }

    /// The same of a bar that breaks where it meets one of `criteria`, and whose very ends move with these velocities (m/s) at t = 0: the steps of a
    /// staircase next to them have means.
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
            booked: Booked::default(),
            merging,
            in_steps,
            front_segments: settings.front_segments.then(Vec::new),
            scratch: Scratch::default(),
            rupture: criteria.map(|criteria| Box::new(Breaking::new(criteria))),
        };
        tracking.lay_out(bar, &starts);
        tracking
    }

    /// Ends and joints in their places, and what they send at t = 0.
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
        // Places were given out in order, so they number the ends and joints from left to right.
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

    /// Follows the fronts up to and including `until` (s); not at all where that is NaN.
    ///
    /// # Errors
    /// [`Stopped::EventBudget`] with the bar standing at the time reached; [`Stopped::NotANumber`]; [`Stopped::AtLimit`].
    pub fn advance_to(&mut self, until: f64) -> Result<(), Stopped> {
        // No event comes after a time that is no number.
        let until = if until.is_nan() { self.now } else { until };
        loop {
            self.limits.check(until)?;
            let interaction = self.next_interaction();
            let (own, id) = self.next_own();
            let time = interaction.map_or(f64::INFINITY, |m| m.time).min(own);
            // Not between events of one time, whose order is a matter of rounding.
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

    /// When an end or a joint next does something of its own accord, s, and its node.
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

    /// The next interaction that still holds, left in the queue.
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
        // What stands still tells the place exactly; else the slower one.
        let x = if right.speed.abs() < left.speed.abs() { right.at(self.now) } else { left.at(self.now) };
        self.gather(m.left, m.right, x)
    }

    /// Takes in all neighbours that are at x too, and resolves what meets there.
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

    /// Whether a node is at x, or next to it and not on its way from there; `towards` is +1 for one on the left. An end or a joint stays where
    /// it is: next to it, what leaves it and is slower than the waves that meet it would be brought back again and again.
    fn is_there(&self, id: u32, x: f64, towards: f64, slowest: f64) -> bool {
        if id == NONE {
            return false;
        }
        let node = self.list.get(id);
        let distance = (node.at(self.now) - x).abs();
        let is_left = node.is_fixed() && towards * slowest > 0.0;
        distance <= self.nearness.place || (distance <= self.nearness.near && towards * node.speed >= 0.0 && !is_left)
    }

    /// Where the nodes `first..=last` meet, m, if it is at x to within the nearness: at an end or a joint; at what stands still; where they
    /// are apart from each other, at the mean of their places by their steps in history, so that no flow is lost.
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

    /// Enters the interaction of a node with the next one, if there ever is one.
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

/// Every state at t = 0 with the number of its segment.
fn all_points(starts: &[Vec<Start>]) -> Vec<(usize, Point)> {
    let of = |(k, starts): (usize, &Vec<Start>)| starts.iter().map(|start| (k, start.point)).collect::<Vec<_>>();
    starts.iter().enumerate().flat_map(of).collect()
}

/// A state at t = 0, from a place on (m from the left end of its segment).
struct Start {
    x: f64,
    point: Point,
}

/// The states of a segment at t = 0 from left to right: one, or the mean between each two rows of its tables, which are those of
/// staircases; neighbours of one state are one.
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
