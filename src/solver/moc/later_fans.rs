//! Fans that start at ends and joints when gaps close or waves arrive, for grid schemes.

use std::collections::BTreeMap;

use super::{FrontSegment, FrontTracking, Stopped};
use crate::bar::{InitialFan, Origin};
use crate::material::Sense;
use crate::wave::similarity::{Edge, Fan, is_elastic};

/// Fraction of the bar length within which a front has reached a position.
const SAME_PLACE: f64 = 1e-9;

/// Largest velocity difference between the two sides of a joint that move together, relative to the velocity change of the fans.
const SAME_VELOCITY: f64 = 1e-6;

/// Fronts that arrive at and leave an end or joint at one time, by index.
#[derive(Debug, Default)]
struct Visit {
    arrive: Vec<usize>,
    leave: Vec<usize>,
}

/// Visits by time, s (numbers >= 0 are ordered as their bits), and place: the left end of a segment, or the right end of the bar.
type Visits = BTreeMap<(u64, usize), Visit>;

impl FrontTracking {
    /// Advances the bar up to `until` (s), or as far as its event budget permits, and returns the plastic fans that start at ends and joints, ordered
    /// by time. A place counts as long as only sharp waves have arrived there: elastic waves of loads that start `at_once`, not those of plastic
    /// fronts or of growing loads. Also returns the time (s) up to which all fans are known, infinite for the whole run. Requires settings that keep
    /// the front segments.
    pub fn later_fans(mut self, until: f64, at_once: impl Fn(Origin, f64) -> bool) -> (Vec<InitialFan>, f64) {
        // Fronts that are active at the end of the run meet nothing within it.
        let end = match self.advance_to(until) {
            Ok(()) => f64::INFINITY,
            Err(Stopped::EventBudget { time, .. }) => time,
            Err(_) => return (Vec::new(), f64::INFINITY),
        };
        let mut fronts = self.take_front_segments();
        fronts.extend(self.living_front_segments());
        let visits = self.visits(&fronts);
        let (mut is_sharp, mut found) = (vec![false; fronts.len()], Vec::new());
        let mut only_sharp = vec![true; self.segments() + 1];
        // Segments through which waves have arrived at each place.
        let mut came: Vec<Vec<usize>> = vec![Vec::new(); self.segments() + 1];
        for (&(time, place), visit) in &visits {
            only_sharp[place] &= visit.arrive.iter().all(|&k| is_sharp[k]);
            if !only_sharp[place] {
                continue;
            }
            let came = &mut came[place];
            let is_jump = !visit.arrive.is_empty() || at_once(self.origin(place), f64::from_bits(time));
            let is_elastic = |&k: &usize| self.is_elastic(&fronts[k]);
            for k in &visit.leave {
                is_sharp[*k] = is_jump && is_elastic(k);
            }
            if !visit.leave.iter().all(is_elastic) {
                let later =
                    visits.range((time + 1, 0)..).find(|((_, other), next)| *other == place && !next.leave.is_empty());
                let next = later.map_or(end, |((time, _), _)| f64::from_bits(*time));
                let fans = self.fans(place, visit, &fronts, next).into_iter();
                let before = |fan: &InitialFan| came.iter().filter(|&&segment| segment == fan.segment).count();
                found.extend(fans.map(|fan| InitialFan { waves_before: before(&fan), ..fan }));
            }
            came.extend(visit.arrive.iter().map(|&k| fronts[k].segment));
        }
        (found, end)
    }

    fn visits(&self, fronts: &[FrontSegment]) -> Visits {
        let places: Vec<f64> = (0..=self.segments()).map(|place| self.list.get(place as u32).x).collect();
        let near = SAME_PLACE * places[self.segments()];
        let place_at = |x: f64| places.iter().position(|place| (place - x).abs() <= near);
        let mut visits = Visits::new();
        // A front that ends when it starts was part of a response at that time.
        for (k, front) in fronts.iter().enumerate().filter(|(_, front)| front.t[1] > front.t[0]) {
            let [from, to] = front.t.map(f64::to_bits);
            if let Some(place) = places.iter().position(|&place| place == front.x[0]) {
                visits.entry((from, place)).or_default().leave.push(k);
            }
            if let Some(place) = place_at(front.x[1]) {
                visits.entry((to, place)).or_default().arrive.push(k);
            }
        }
        visits
    }

    /// Returns the fans of a visit into both sides; none if waves arrive from both. Nothing else starts there before `next` (s).
    fn fans(&self, place: usize, visit: &Visit, fronts: &[FrontSegment], next: f64) -> Vec<InitialFan> {
        let leaving: Vec<&FrontSegment> = visit.leave.iter().map(|&k| &fronts[k]).collect();
        let through = visit.arrive.first().map(|&k| fronts[k].segment);
        if visit.arrive.iter().any(|&k| Some(fronts[k].segment) != through) {
            return Vec::new();
        }
        let meets = |front: &&FrontSegment| (front.t[1] < self.now).then_some(front.t[1]);
        let until = leaving.iter().filter_map(meets).fold(next, f64::min);
        let origin = self.origin(place);
        let sides = [place.checked_sub(1).map(|segment| (segment, -1.0)), Some((place, 1.0))];
        let sides = sides.into_iter().flatten().filter(|&(segment, _)| segment < self.segments());
        let fan = |(segment, direction): (usize, f64)| {
            let mut here: Vec<&FrontSegment> =
                leaving.iter().filter(|front| front.segment == segment).copied().collect();
            here.sort_by(|a, b| speed(b).total_cmp(&speed(a)));
            let fan = self.fan(&here)?;
            let meets_plastic_at =
                here.iter().filter_map(|front| self.meets_plastic(front, fronts)).fold(f64::INFINITY, f64::min);
            let (holds_until, meets_plastic_at) = (until - fan.from, meets_plastic_at - fan.from);
            Some(InitialFan { origin, direction, wave_through: through, holds_until, meets_plastic_at, ..fan })
        };
        let mut fans: Vec<InitialFan> = sides.map(fan).collect::<Option<_>>().unwrap_or_default();
        let above_critical = self.is_above_critical(&fans);
        for fan in &mut fans {
            fan.fan.above_critical = above_critical;
        }
        fans
    }

    /// Returns the time at which a plastic front meets another one that comes towards it, s; `None` if it meets none.
    fn meets_plastic(&self, front: &FrontSegment, fronts: &[FrontSegment]) -> Option<f64> {
        let near = SAME_PLACE * self.list.get(self.end_nodes[1]).x;
        let ended = front.t[1] < self.now && !self.is_elastic(front);
        let meets = |other: &FrontSegment| {
            other.segment == front.segment
                && other.t[1] == front.t[1]
                && (other.x[1] - front.x[1]).abs() <= near
                && (other.x[1] - other.x[0]) * (front.x[1] - front.x[0]) < 0.0
                && !self.is_elastic(other)
        };
        (ended && fronts.iter().any(meets)).then_some(front.t[1])
    }

    fn origin(&self, place: usize) -> Origin {
        match place {
            0 => Origin::Left,
            _ if place == self.segments() => Origin::Right,
            _ => Origin::Joint(place - 1),
        }
    }

    /// Returns whether the driver of the fans of an end or joint is above critical: the bar does not follow the end, or the sides of the joint move
    /// apart.
    fn is_above_critical(&self, fans: &[InitialFan]) -> bool {
        let short = |which: usize| self.ends[which].record.above_critical.is_some_and(|from| from.time <= fans[0].from);
        match fans {
            [InitialFan { origin: Origin::Left, .. }] => short(0),
            [InitialFan { origin: Origin::Right, .. }] => short(1),
            [left, right] => match [left, right].map(InitialFan::state_behind) {
                [Some([stress, left_velocity]), Some([_, right_velocity])] => {
                    let change = left.fan.velocity.max(right.fan.velocity);
                    stress != 0.0 && (left_velocity - right_velocity).abs() > SAME_VELOCITY * change
                }
                _ => false,
            },
            _ => false,
        }
    }

    /// Returns the fan of fronts of one segment, fastest first, that start together. Its direction is +x and its driver a constant velocity until the
    /// caller sets them.
    fn fan(&self, fronts: &[&FrontSegment]) -> Option<InitialFan> {
        let (first, last) = (fronts.first()?, fronts.last()?);
        let (ahead, behind, segment) = (first.ahead, last.behind, first.segment);
        let sense = Sense::of(behind.stress - ahead.stress);
        let edges: Vec<Edge> = fronts.iter().map(|front| self.edge(front, sense)).collect();
        let slowest = *edges.last()?;
        let fan = Fan {
            edges,
            strain: slowest.strain_behind,
            stress: slowest.stress_behind,
            velocity: (behind.velocity - ahead.velocity).abs(),
            above_critical: false,
            beyond_data: false,
        };
        let curve = self.materials[segment].branch(sense);
        Some(InitialFan {
            x: first.x[0],
            velocity_ahead: ahead.velocity,
            from: first.t[0],
            alone: true,
            ..InitialFan::steady((Origin::Left, 1.0), segment, (sense, curve), fan)
        })
    }

    fn is_elastic(&self, front: &FrontSegment) -> bool {
        let medium = &self.media[front.segment];
        is_elastic(speed(front), (medium.modulus / medium.density).sqrt())
    }

    fn edge(&self, front: &FrontSegment, sense: Sense) -> Edge {
        let medium = &self.media[front.segment];
        let sides = [front.ahead, front.behind];
        let [strain_ahead, strain_behind] = sides.map(|point| sense.sign() * medium.strain(&point));
        let [stress_ahead, stress_behind] = sides.map(|point| sense.sign() * point.stress);
        let speed = ((stress_behind - stress_ahead) / (medium.density * (strain_behind - strain_ahead))).sqrt();
        Edge { strain_ahead, strain_behind, stress_ahead, stress_behind, speed }
    }
}

fn speed(front: &FrontSegment) -> f64 {
    ((front.x[1] - front.x[0]) / (front.t[1] - front.t[0])).abs()
}
