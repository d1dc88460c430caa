//! The Riemann problem at an end of the bar: the relation a u + b p = c of the end against the waves of the bar.

use super::FrontTracking;
use super::end::{Answer, Arrival, EndStep};
use super::list::NONE;
use super::nearness::{REST, same_motion};
use crate::bar::ends::{Face, Relation, Response};
use crate::wave::riemann::{Point, Side, solve};

/// Longest step relative to the wanted one: a step is extended up to this length to end with the arrival of a front.
const LONGEST_STEP: f64 = 1.5;

/// Largest number of Newton iterations for a body and a bar that flows.
const MOST_REPEATS: usize = 20;

impl FrontTracking {
    pub(super) fn resolve_end(&mut self, which: usize, id: u32, x: f64) {
        let prev = self.list.get(id).prev;
        let (bar, segment) = if which == 0 {
            (self.list.get(id).right, 0)
        } else {
            (self.list.get(prev).right, self.list.get(prev).segment)
        };
        let mut answer = self.answer_end(which, &bar, segment);
        if self.rupture.is_some() && self.breaks_at_end(which, (segment, bar, answer.behind), answer.short) {
            self.break_off(which);
            answer = self.answer_stress(which, 0.0, &bar, segment);
        }
        self.note_limit(1 - which, segment, [&bar, &answer.behind], x, false);
        let end = &mut self.ends[which];
        end.update(&answer);
        if answer.short && end.demands {
            let Point { stress, velocity, .. } = answer.behind;
            end.record.above_critical.get_or_insert(EndStep { time: self.now, stress, velocity });
        }
        if which == 0 {
            // The innermost state of the fan is next to the end, the state ahead is to the right of the fastest front.
            let nearest = self.scratch.sent_right.last().map_or(bar, |e| e.behind);
            self.list.get_mut(id).right = nearest;
            let last = self.send_right(id, x, bar, segment);
            self.schedule(last);
        } else {
            self.send_left(prev, x, segment);
            self.schedule(prev);
        }
    }

    /// Computes the waves that an end emits into the bar.
    fn answer_end(&mut self, which: usize, bar: &Point, segment: u32) -> Answer {
        match self.ends[which].arrive(self.now, bar) {
            Arrival::Passes => {
                self.scratch.sent_left.clear();
                self.scratch.sent_right.clear();
                let velocity = self.ends[which].face.inward * bar.velocity;
                return Answer { behind: *bar, velocity, short: false, answers: false };
            }
            Arrival::Within => {
                let answer = self.answer(which, &self.ends[which].relation(), bar, segment);
                if !self.pulls(which, &answer) {
                    return answer;
                }
            }
            Arrival::Ends => {}
        }
        self.begin_step(which, bar, segment);
        let answer = self.answer_step(which, bar, segment);
        if self.pulls(which, &answer) {
            self.ends[which].part();
            return self.answer_stress(which, 0.0, bar, segment);
        }
        answer
    }

    /// Returns whether a body or wall would have to pull.
    fn pulls(&self, which: usize, answer: &Answer) -> bool {
        answer.behind.stress > 0.0 && self.ends[which].can_part()
    }

    /// Begins the next step of an end. If a body moves with the end, the step ends with the arrival of a front where possible.
    fn begin_step(&mut self, which: usize, bar: &Point, segment: u32) {
        let free = self.free_velocity(which, bar, segment);
        let length = self.ends[which].end_step(bar, free).map(|wish| {
            let reach = LONGEST_STEP * self.media[segment as usize].c0();
            let arrival = self.arrival(which, reach * wish);
            if arrival <= LONGEST_STEP * wish { arrival } else { wish }
        });
        self.ends[which].begin_step(length, bar, free);
    }

    /// Velocity of the face without load, m/s, into the bar. A bar whose stress falls may flow, so that its face moves faster than that of an elastic
    /// bar; a body is found separated from a face with this velocity.
    fn free_velocity(&mut self, which: usize, bar: &Point, segment: u32) -> f64 {
        self.answer_stress(which, 0.0, bar, segment).velocity
    }

    /// Returns the time until the first front that is within `reach` (m) of an end arrives there if nothing intervenes, s; infinite if there is none.
    /// Fronts too weak to end a step do not count.
    fn arrival(&self, which: usize, reach: f64) -> f64 {
        let end = self.list.get(self.end_nodes[which]);
        let weakest = self.ends[which].passing();
        let mut first = f64::INFINITY;
        let mut id = if which == 0 { end.next } else { end.prev };
        while id != NONE {
            let node = self.list.get(id);
            let distance = (node.at(self.now) - end.x).abs();
            if distance > reach || node.is_fixed() {
                break;
            }
            let strength = (node.right.stress - self.list.get(node.prev).right.stress).abs();
            if node.speed * self.ends[which].face.inward < 0.0 && distance > self.nearness.place && strength > weakest {
                first = first.min(distance / node.speed.abs());
            }
            id = if which == 0 { node.next } else { node.prev };
        }
        first
    }

    /// Computes the response to the step that begins. The relation of a body depends on the impedance of the bar: if the bar flows, both are found
    /// together by iteration.
    fn answer_step(&mut self, which: usize, bar: &Point, segment: u32) -> Answer {
        let mut answer = self.answer(which, &self.ends[which].relation(), bar, segment);
        let elastic = self.ends[which].face.impedance;
        let mut response = self.tangent(which, bar, &answer);
        if response.impedance == elastic {
            return answer;
        }
        let Some(step) = self.ends[which].body_step() else { return answer };
        let round_off = REST * self.media[segment as usize].round_off;
        for _ in 0..MOST_REPEATS {
            let before = answer.behind.stress;
            self.ends[which].agree_with(&step, &response);
            answer = self.answer(which, &self.ends[which].relation(), bar, segment);
            if (answer.behind.stress - before).abs() <= round_off {
                break;
            }
            response = self.tangent(which, bar, &answer);
        }
        answer
    }

    /// Returns the linearized response of the bar around a response in the scratch: a secant from half of the way to it.
    fn tangent(&mut self, which: usize, bar: &Point, answer: &Answer) -> Response {
        let path = if which == 0 { &mut self.scratch.work.right } else { &mut self.scratch.work.left };
        let Face { area, impedance, .. } = self.ends[which].face;
        let [from, to] = [bar.stress, answer.behind.stress].map(|stress| path.sense() * stress);
        let middle = 0.5 * (from + to);
        let change = path.velocity(to.min(path.cap())) - path.velocity(middle);
        let tangent = area * (to - middle) / change;
        // The bar is elastic but for rounding, or the change is too small to evaluate a secant.
        let elastic = !(tangent > 0.0 && tangent < (1.0 - 1e-6) * impedance);
        let impedance = if elastic { impedance } else { tangent };
        Response { force: -area * answer.behind.stress - impedance * answer.velocity, impedance }
    }

    /// Solves the Riemann problem against a relation.
    fn answer(&mut self, which: usize, relation: &Relation, bar: &Point, segment: u32) -> Answer {
        let Relation { of_velocity: a, of_force: b, value: c, .. } = *relation;
        let (face, medium) = (self.ends[which].face, &self.media[segment as usize]);
        if a == 0.0 {
            return self.answer_stress(which, -c / b / face.area, bar, segment);
        }
        // Chosen from the side of the relation that loses no digits.
        let (force, velocity) = if b == 0.0 {
            (medium.area * bar.stress, c / a)
        } else if a > b * face.impedance {
            (0.0, c / a)
        } else {
            (-c / b, 0.0)
        };
        let driver = Side::Straight { force, velocity: face.inward * velocity, compliance: b / a };
        let own = Side::Bar(medium, bar);
        let (star, path, sent) = if which == 0 {
            (solve(driver, own, &mut self.scratch.work), &mut self.scratch.work.right, &mut self.scratch.sent_right)
        } else {
            (solve(own, driver, &mut self.scratch.work), &mut self.scratch.work.left, &mut self.scratch.sent_left)
        };
        let asked = path.sense() * star.force / medium.area;
        // A bar that is already at the largest stress of its curve cannot carry the difference to the force of the end.
        let capped = star.capped || asked > path.cap();
        let behind = path.emit(asked.min(path.cap()), face.inward, sent);
        let behind = self.unless_at_rest(which, behind, bar, segment);
        // The face moves ahead of a bar that cannot follow. If the end is stiff, its relation gives the velocity to more digits than the bar.
        let exact = a > b * face.impedance || capped;
        let velocity = if exact { (c + b * face.area * behind.stress) / a } else { face.inward * behind.velocity };
        Answer { behind, velocity, short: capped, answers: true }
    }

    fn answer_stress(&mut self, which: usize, stress: f64, bar: &Point, segment: u32) -> Answer {
        let inward = self.ends[which].face.inward;
        let (behind, short) = self.emit_under(stress, inward, bar, segment);
        let behind = self.unless_at_rest(which, behind, bar, segment);
        Answer { behind, velocity: inward * behind.velocity, short, answers: true }
    }

    /// Emits the waves of a face under a stress `inward` (+1: to the right) into the scratch of that side. Returns the state behind them, and whether
    /// the stress exceeds what the curve can carry.
    pub(super) fn emit_under(&mut self, stress: f64, inward: f64, bar: &Point, segment: u32) -> (Point, bool) {
        let medium = &self.media[segment as usize];
        let sense = if stress < bar.stress { -1.0 } else { 1.0 };
        let (path, sent) = if inward > 0.0 {
            (&mut self.scratch.work.right, &mut self.scratch.sent_right)
        } else {
            (&mut self.scratch.work.left, &mut self.scratch.sent_left)
        };
        path.fill(medium, bar, sense);
        let tau = sense * stress;
        let short = tau > path.cap() + medium.round_off;
        (path.emit(tau.min(path.cap()), inward, sent), short)
    }

    /// Returns the state behind the wave of an end. With a front tolerance, a wave of a few roundings is not emitted (see [`REST`]).
    fn unless_at_rest(&mut self, which: usize, behind: Point, bar: &Point, segment: u32) -> Point {
        if !self.merging.is_on() || !same_motion(&behind, bar, &self.media[segment as usize], REST) {
            return behind;
        }
        let sent = if which == 0 { &mut self.scratch.sent_right } else { &mut self.scratch.sent_left };
        sent.clear();
        *bar
    }
}
