//! The fronts from one event to the next.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use super::end::{Drive, End, EndRecord};
use super::list::{Kind, List, NONE, Node};
use super::{Settings, Stopped, Unsupported};
use crate::bar::{Bar, EndCondition, Joint};
use crate::law::Table;
use crate::material::Sense;
use crate::wave::riemann::{Emitted, Flow, Medium, Path, Point, Side, Workspace, solve};

/// Nodes closer than this part of the bar's length are at one point, and times closer than this part of the elastic
/// transit time are one time. Meetings carry a rounding of about 1e-15 of either; fronts that should meet in one
/// point miss it by that, and distinct events lie that close together only by chance.
const SAME_POINT: f64 = 1e-13;

/// Stresses closer than this part of the stress scale are one stress: a hundred times their rounding.
const SAME_STRESS: f64 = 1e-13;

/// A constant piece of the solution.
#[derive(Debug, Clone, Copy)]
pub struct Piece<'a> {
    /// Left edge now, m.
    pub from: f64,
    /// Right edge now, m.
    pub to: f64,
    /// Index of its segment.
    pub segment: usize,
    /// Its state.
    pub point: &'a Point,
}

/// A running front.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Front {
    /// Place now, m.
    pub x: f64,
    /// m/s, positive in +x.
    pub speed: f64,
    /// Index of the segment in which it runs.
    pub segment: usize,
    /// State ahead of it.
    pub ahead: Point,
    /// State behind it.
    pub behind: Point,
}

/// The bar at a place.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sample {
    /// Pa.
    pub stress: f64,
    /// Engineering strain.
    pub strain: f64,
    /// m/s.
    pub velocity: f64,
    /// Signed plastic strain.
    pub plastic_strain: f64,
}

/// The next meeting of two neighbours; out of date once one of them is gone or they are no longer neighbours.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Meeting {
    time: f64,
    left: u32,
    right: u32,
    left_stamp: u64,
    right_stamp: u64,
}

impl Eq for Meeting {}

impl PartialOrd for Meeting {
    fn partial_cmp(&self, other: &Self) -> Option<std::cmp::Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for Meeting {
    fn cmp(&self, other: &Self) -> std::cmp::Ordering {
        self.time.total_cmp(&other.time).then(self.left_stamp.cmp(&other.left_stamp))
    }
}

/// A bar whose fronts are tracked.
#[derive(Debug, Clone)]
pub struct FrontTracking {
    media: Vec<Medium>,
    pub(super) ends: [End; 2],
    end_nodes: [u32; 2],
    pub(super) list: List,
    queue: BinaryHeap<Reverse<Meeting>>,
    now: f64,
    events: u64,
    budget: u64,
    same_place: f64,
    same_time: f64,
    stress_scale: f64,
    hold: f64,
    fronts: usize,
    pub(super) concentrated: f64,
    work: Workspace,
    sent_left: Vec<Emitted>,
    sent_right: Vec<Emitted>,
}

impl FrontTracking {
    /// A bar at t = 0 with its ends; every segment flows as `flow` says.
    ///
    /// # Errors
    /// A joint that can open, or a history with a ramp (see [`super::stepped`]).
    pub fn new(bar: &Bar, flow: Flow, ends: [EndCondition; 2], settings: Settings) -> Result<Self, Unsupported> {
        let last = bar.segments.len() - 1;
        if let Some(k) = bar.segments[..last].iter().position(|s| s.joint != Joint::Bonded) {
            return Err(Unsupported::ContactJoint(k + 1));
        }
        let [left, right] = ends;
        let ends = [End::new(left, 1.0, bar.segments[0].velocity), End::new(right, -1.0, bar.segments[last].velocity)];
        for (end, name) in ends.iter().zip(["left", "right"]) {
            if end.has_ramp() {
                return Err(Unsupported::Ramp(name));
            }
        }
        let mut media: Vec<Medium> = bar.segments.iter().map(|s| medium(s, flow)).collect();
        let stress_scale = stress_scale(bar, &media, &ends);
        for medium in &mut media {
            medium.round_off = SAME_STRESS * stress_scale;
        }
        let mut tracking = Self {
            media,
            ends,
            end_nodes: [0, 0],
            list: List::default(),
            queue: BinaryHeap::new(),
            now: 0.0,
            events: 0,
            budget: settings.event_budget,
            same_place: SAME_POINT * bar.length(),
            same_time: SAME_POINT * bar.transit_time(),
            stress_scale,
            hold: settings.front_tolerance * stress_scale,
            fronts: 0,
            concentrated: 0.0,
            work: Workspace::default(),
            sent_left: Vec::new(),
            sent_right: Vec::new(),
        };
        tracking.lay_out(bar);
        Ok(tracking)
    }

    /// Ends and joints in their places, and what they send at t = 0.
    fn lay_out(&mut self, bar: &Bar) {
        let (mut x, mut after) = (0.0, NONE);
        for (k, segment) in bar.segments.iter().enumerate() {
            let kind = if k == 0 { Kind::End } else { Kind::Joint };
            after = self.list.insert(after, node(kind, x, 0.0, 0.0, Point::moving(segment.velocity), k as u32));
            x += segment.length;
        }
        let last = bar.segments.len() - 1;
        let end = node(Kind::End, x, 0.0, 0.0, Point::default(), last as u32);
        self.end_nodes = [0, self.list.insert(after, end)];
        // Places were given out in order, so they number the ends and joints from left to right.
        for id in 0..=self.end_nodes[1] {
            self.resolve(id, id, self.list.get(id).x);
        }
    }

    /// Time, s.
    pub fn time(&self) -> f64 {
        self.now
    }

    /// Events so far: meetings, and steps of the ends.
    pub fn events(&self) -> u64 {
        self.events
    }

    /// The stress to which tolerances are relative, Pa: the largest imposed one, or the one at which the largest
    /// difference of the velocities imposed and initial meets a bar that was never loaded.
    pub fn stress_scale(&self) -> f64 {
        self.stress_scale
    }

    /// Number of segments.
    pub fn segments(&self) -> usize {
        self.media.len()
    }

    /// Material and section of a segment.
    pub fn medium(&self, segment: usize) -> &Medium {
        &self.media[segment]
    }

    /// What happened at the left and the right end.
    pub fn ends(&self) -> [&EndRecord; 2] {
        [&self.ends[0].record, &self.ends[1].record]
    }

    /// The constant pieces from left to right, empty ones left out.
    pub fn pieces(&self) -> impl Iterator<Item = Piece<'_>> {
        let right = self.list.iter().skip(1);
        self.list.iter().zip(right).filter_map(|(a, b)| {
            let (from, to) = (a.at(self.now), b.at(self.now));
            (to > from).then_some(Piece { from, to, segment: a.segment as usize, point: &a.right })
        })
    }

    /// The running fronts from left to right.
    pub fn fronts(&self) -> impl Iterator<Item = Front> + '_ {
        self.list.iter().filter(|n| n.kind == Kind::Front).map(|n| {
            let (left, right) = (self.list.get(n.prev).right, n.right);
            let (ahead, behind) = if n.speed > 0.0 { (right, left) } else { (left, right) };
            Front { x: n.at(self.now), speed: n.speed, segment: n.segment as usize, ahead, behind }
        })
    }

    /// The bar at x in 0..=length, now. On a front: the state behind it; on a contact or joint: the right one.
    pub fn state_at(&self, x: f64) -> Sample {
        let mut found = self.list.get(0);
        for node in self.list.iter().skip(1).filter(|n| n.kind != Kind::End) {
            let place = node.at(self.now);
            if place > x || (place == x && node.speed > 0.0) {
                break;
            }
            found = node;
        }
        let (medium, point) = (self.medium(found.segment as usize), &found.right);
        Sample {
            stress: point.stress,
            strain: medium.strain(point),
            velocity: point.velocity,
            plastic_strain: medium.plastic_strain(point),
        }
    }

    /// Follows the fronts up to and including `until` (s).
    ///
    /// # Errors
    /// [`Stopped::EventBudget`] with the bar standing at the time reached; [`Stopped::NotANumber`].
    pub fn advance_to(&mut self, until: f64) -> Result<(), Stopped> {
        loop {
            let meeting = self.next_meeting();
            let own: [f64; 2] = std::array::from_fn(|k| self.ends[k].next_time(self.now + self.same_time));
            let time = meeting.map_or(f64::INFINITY, |m| m.time).min(own[0]).min(own[1]);
            if time > until + self.same_time {
                self.now = self.now.max(until);
                return Ok(());
            }
            if self.events >= self.budget {
                return Err(Stopped::EventBudget { time: self.now, events: self.events, fronts: self.fronts });
            }
            self.events += 1;
            self.now = self.now.max(time);
            match meeting {
                Some(m) if m.time <= time => self.meet(m)?,
                _ => {
                    let k = usize::from(own[1] <= time);
                    self.gather(self.end_nodes[k], self.end_nodes[k], self.list.get(self.end_nodes[k]).x)?;
                }
            }
        }
    }

    /// The next meeting that still holds, left in the queue.
    fn next_meeting(&mut self) -> Option<Meeting> {
        while let Some(&Reverse(m)) = self.queue.peek() {
            let (left, right) = (self.list.get(m.left), self.list.get(m.right));
            if left.stamp == m.left_stamp && right.stamp == m.right_stamp && left.next == m.right {
                return Some(m);
            }
            self.queue.pop();
        }
        None
    }

    fn meet(&mut self, m: Meeting) -> Result<(), Stopped> {
        self.queue.pop();
        let (left, right) = (self.list.get(m.left), self.list.get(m.right));
        // What stands still tells the place exactly; else the slower one.
        let x = if right.speed.abs() < left.speed.abs() { right.at(self.now) } else { left.at(self.now) };
        self.gather(m.left, m.right, x)
    }

    /// Takes in all neighbours that are at x too, and resolves what meets there.
    fn gather(&mut self, mut first: u32, mut last: u32, mut x: f64) -> Result<(), Stopped> {
        let at = |list: &List, id: u32, x: f64| id != NONE && (list.get(id).at(self.now) - x).abs() <= self.same_place;
        while at(&self.list, self.list.get(first).prev, x) {
            first = self.list.get(first).prev;
        }
        while at(&self.list, self.list.get(last).next, x) {
            last = self.list.get(last).next;
        }
        let mut id = first;
        while id != NONE {
            if self.list.get(id).speed == 0.0 {
                x = self.list.get(id).x;
            }
            id = if id == last { NONE } else { self.list.get(id).next };
        }
        if !x.is_finite() {
            return Err(Stopped::NotANumber { time: self.now, x });
        }
        self.resolve(first, last, x);
        Ok(())
    }

    /// Solves the Riemann problem of the nodes `first..=last` that meet at x now, and puts what it sends in their place.
    fn resolve(&mut self, first: u32, last: u32, x: f64) {
        let fixed = self.clear(first, last);
        match fixed {
            Some(id) if id == self.end_nodes[0] => self.resolve_end(0, id, x),
            Some(id) if id == self.end_nodes[1] => self.resolve_end(1, id, x),
            Some(id) => {
                let prev = self.list.get(id).prev;
                self.resolve_inside(prev, Some(id), self.list.get(id).right, x);
            }
            None => {
                let prev = self.list.get(last).prev;
                let right = self.list.get(last).right;
                self.drop_node(last);
                self.resolve_inside(prev, None, right, x);
            }
        }
    }

    /// Removes the nodes `first..=last` but for an end or joint among them, which takes over the state to the right of
    /// them all and is returned; without one, the last node stays to be removed by the caller.
    fn clear(&mut self, first: u32, last: u32) -> Option<u32> {
        let right = self.list.get(last).right;
        let mut fixed = None;
        let mut id = first;
        loop {
            let node = *self.list.get(id);
            let is_fixed = matches!(node.kind, Kind::End | Kind::Joint);
            if matches!(node.kind, Kind::Contact | Kind::Joint) {
                self.concentrated += self.stretch_work(&node);
            }
            if is_fixed {
                fixed = Some(id);
            }
            if id == last {
                break;
            }
            id = node.next;
        }
        let Some(kept) = fixed else {
            self.remove_until(first, last);
            return None;
        };
        let mut id = first;
        loop {
            let next = self.list.get(id).next;
            if id != kept {
                self.drop_node(id);
            }
            if id == last {
                break;
            }
            id = next;
        }
        self.list.get_mut(kept).right = right;
        Some(kept)
    }

    /// Removes from `first` to just before `last`.
    fn remove_until(&mut self, first: u32, last: u32) {
        let mut id = first;
        while id != last {
            let next = self.list.get(id).next;
            self.drop_node(id);
            id = next;
        }
    }

    fn drop_node(&mut self, id: u32) {
        self.fronts -= usize::from(self.list.get(id).kind == Kind::Front);
        self.list.remove(id);
    }

    /// What a velocity jump at a place at rest has taken since the node was set, J.
    pub(super) fn stretch_work(&self, node: &Node) -> f64 {
        let (left, right) = (self.list.get(node.prev), node);
        let force = |n: &Node| self.media[n.segment as usize].area * n.right.stress;
        0.5 * (force(left) + force(right)) * (right.right.velocity - left.right.velocity) * (self.now - node.t)
    }

    /// Between the piece to the right of `prev` and the state `right`, at a joint or anywhere.
    fn resolve_inside(&mut self, prev: u32, joint: Option<u32>, right: Point, x: f64) {
        let left = self.list.get(prev).right;
        let left_segment = self.list.get(prev).segment;
        let right_segment = joint.map_or(left_segment, |id| self.list.get(id).segment);
        let (a, b) = (&self.media[left_segment as usize], &self.media[right_segment as usize]);
        let star = solve(Side::Bar(a, &left), Side::Bar(b, &right), &mut self.work);
        let force = if self.hold > 0.0 {
            held_back(star.force, self.hold, [(a, &left), (b, &right)], &mut self.work)
        } else {
            star.force
        };
        let (path_left, path_right) = (&mut self.work.left, &mut self.work.right);
        let tau = |path: &Path| (path.sense() * force / path.area()).min(path.cap());
        let behind_left = path_left.emit(tau(path_left), -1.0, 0.0, &mut self.sent_left);
        let behind_right = path_right.emit(tau(path_right), 1.0, 0.0, &mut self.sent_right);
        let round_off = a.round_off;
        let apart = star.capped
            || !behind_left.same_history(&behind_right, round_off)
            || (self.hold > 0.0 && !same_motion(&behind_left, &behind_right, a));
        let before_new = self.send_left(prev, x, left_segment);
        let middle = match joint {
            Some(id) => {
                let kept = self.list.get_mut(id);
                (kept.right, kept.t) = (behind_right, self.now);
                id
            }
            None if apart => {
                self.list.insert(before_new, node(Kind::Contact, x, self.now, 0.0, behind_right, left_segment))
            }
            None => before_new,
        };
        let after_new = self.send_right(middle, x, right, right_segment);
        self.schedule(prev);
        self.schedule(after_new);
    }

    /// Puts the fronts sent in -x behind `prev`; the last node before x afterwards.
    fn send_left(&mut self, prev: u32, x: f64, segment: u32) -> u32 {
        let mut after = prev;
        for k in 0..self.sent_left.len() {
            let Emitted { speed, behind } = self.sent_left[k];
            after = self.list.insert(after, node(Kind::Front, x, self.now, -speed, behind, segment));
        }
        self.fronts += self.sent_left.len();
        after
    }

    /// Puts the fronts sent in +x behind `after`, with `ahead` before them all; the last of them.
    fn send_right(&mut self, mut after: u32, x: f64, ahead: Point, segment: u32) -> u32 {
        for k in (0..self.sent_right.len()).rev() {
            let state = if k == 0 { ahead } else { self.sent_right[k - 1].behind };
            after = self.list.insert(after, node(Kind::Front, x, self.now, self.sent_right[k].speed, state, segment));
        }
        self.fronts += self.sent_right.len();
        after
    }

    fn resolve_end(&mut self, which: usize, id: u32, x: f64) {
        let prev = self.list.get(id).prev;
        let (bar, segment) = if which == 0 {
            (self.list.get(id).right, 0)
        } else {
            (self.list.get(prev).right, self.list.get(prev).segment)
        };
        let drive = self.ends[which].drive(self.now, self.same_time);
        let (behind, held, short) = self.answer_end(which, drive, bar, segment);
        let medium = &self.media[segment as usize];
        let end = &mut self.ends[which];
        end.settle(behind.stress, behind.velocity, held, medium.round_off, medium.impedance());
        if short {
            end.record.above_critical.get_or_insert(self.now);
        }
        if which == 0 {
            // The fan's innermost state is next to the end, the state ahead to the right of the fastest front.
            let nearest = self.sent_right.last().map_or(bar, |e| e.behind);
            self.list.get_mut(id).right = nearest;
            let last = self.send_right(id, x, bar, segment);
            self.schedule(last);
        } else {
            self.send_left(prev, x, segment);
            self.schedule(prev);
        }
    }

    /// The waves that an end sends into the bar: into the scratch of its side. State behind them, whether a wall holds
    /// the end, and whether the curve could not carry what was imposed.
    fn answer_end(&mut self, which: usize, drive: Drive, bar: Point, segment: u32) -> (Point, bool, bool) {
        match drive {
            Drive::Stress(stress) => {
                let (behind, short) = self.answer_stress(which, stress, bar, segment);
                (behind, false, short)
            }
            Drive::Velocity(velocity) => {
                let (behind, short) = self.answer_driver(which, velocity, 0.0, None, bar, segment);
                (behind, false, short)
            }
            Drive::Elastic(velocity) => {
                let medium = &self.media[segment as usize];
                let compliance = 1.0 / (medium.impedance() * medium.area);
                let (behind, _) = self.answer_driver(which, velocity, compliance, Some(0.0), bar, segment);
                (behind, false, false)
            }
            Drive::Push => {
                let (free, short) = self.answer_stress(which, 0.0, bar, segment);
                if self.ends[which].inward * free.velocity >= 0.0 {
                    return (free, false, short);
                }
                let (behind, short) = self.answer_driver(which, 0.0, 0.0, None, bar, segment);
                (behind, true, short)
            }
        }
    }

    fn answer_stress(&mut self, which: usize, stress: f64, bar: Point, segment: u32) -> (Point, bool) {
        let medium = &self.media[segment as usize];
        let sense = if stress < bar.stress { -1.0 } else { 1.0 };
        let (path, sent) = if which == 0 {
            (&mut self.work.right, &mut self.sent_right)
        } else {
            (&mut self.work.left, &mut self.sent_left)
        };
        path.fill(medium, &bar, sense);
        let tau = sense * stress;
        let short = tau > path.cap() + medium.round_off;
        (path.emit(tau.min(path.cap()), self.ends[which].inward, 0.0, sent), short)
    }

    /// A driver that moves with `velocity` at `force` (none: at the bar's own force) and gives way by `compliance`.
    fn answer_driver(
        &mut self,
        which: usize,
        velocity: f64,
        compliance: f64,
        force: Option<f64>,
        bar: Point,
        segment: u32,
    ) -> (Point, bool) {
        let medium = &self.media[segment as usize];
        let force = force.unwrap_or(medium.area * bar.stress);
        let driver = Side::Straight { force, velocity, compliance };
        let own = Side::Bar(medium, &bar);
        let (star, path, sent) = if which == 0 {
            (solve(driver, own, &mut self.work), &mut self.work.right, &mut self.sent_right)
        } else {
            (solve(own, driver, &mut self.work), &mut self.work.left, &mut self.sent_left)
        };
        let tau = (path.sense() * star.force / medium.area).min(path.cap());
        (path.emit(tau, self.ends[which].inward, self.hold, sent), star.capped)
    }

    /// Enters the meeting of a node with the next one, if they ever meet.
    fn schedule(&mut self, left: u32) {
        let a = self.list.get(left);
        if a.next == NONE {
            return;
        }
        let b = self.list.get(a.next);
        let closing = a.speed - b.speed;
        if closing > 0.0 {
            let distance = (b.at(self.now) - a.at(self.now)).max(0.0);
            self.queue.push(Reverse(Meeting {
                time: self.now + distance / closing,
                left,
                right: a.next,
                left_stamp: a.stamp,
                right_stamp: b.stamp,
            }));
        }
    }
}

/// The force nearest to `force` at which one side sends no wave, or none past a knot of its path, if that is less than
/// `hold` (Pa) away; else `force`. The paths are left in the senses that it asks for.
///
/// The stress stays continuous, so momentum is kept exactly; what is held back is a velocity jump, which the next
/// front that passes takes with it.
fn held_back(force: f64, hold: f64, [left, right]: [(&Medium, &Point); 2], work: &mut Workspace) -> f64 {
    let (from_left, from_right) = (work.left.force_behind(force), work.right.force_behind(force));
    let nearest = if (from_left - force).abs() < (from_right - force).abs() { from_left } else { from_right };
    if (nearest - force).abs() > hold * left.0.area.min(right.0.area) {
        return force;
    }
    for (path, (medium, point)) in [(&mut work.left, left), (&mut work.right, right)] {
        let sense = if nearest < medium.area * point.stress { -1.0 } else { 1.0 };
        if sense != path.sense() {
            path.fill(medium, point, sense);
        }
    }
    nearest
}

/// Whether two points have one stress and one velocity, to rounding.
fn same_motion(a: &Point, b: &Point, medium: &Medium) -> bool {
    (a.stress - b.stress).abs() <= medium.round_off
        && (a.velocity - b.velocity).abs() * medium.impedance() <= medium.round_off
}

fn node(kind: Kind, x: f64, t: f64, speed: f64, right: Point, segment: u32) -> Node {
    Node { kind, x, t, speed, right, segment, prev: NONE, next: NONE, stamp: 0 }
}

fn medium(segment: &crate::bar::Segment, flow: Flow) -> Medium {
    let material = &segment.material;
    let table = |sense| Table::new(material.branch(sense), material.modulus);
    let (tension, compression) = (table(Sense::Tension), table(Sense::Compression));
    Medium::new([&tension, &compression], material.modulus, material.density, segment.area, flow, 0.0)
}

/// See [`FrontTracking::stress_scale`].
fn stress_scale(bar: &Bar, media: &[Medium], ends: &[End; 2]) -> f64 {
    let reach = ends.each_ref().map(End::reach);
    let velocities = || bar.segments.iter().map(|s| s.velocity).chain(reach.iter().flat_map(|r| r.1));
    let range = velocities().fold(f64::MIN, f64::max) - velocities().fold(f64::MAX, f64::min);
    let imposed = reach[0].0.max(reach[1].0);
    let mut work = Workspace::default();
    let struck = media.iter().map(|medium| {
        let driver = Side::Straight { force: 0.0, velocity: -range, compliance: 0.0 };
        (solve(driver, Side::Bar(medium, &Point::default()), &mut work).force / medium.area).abs()
    });
    struck.fold(imposed, f64::max)
}
