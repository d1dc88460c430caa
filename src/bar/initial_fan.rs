//! Initial fans: the centred waves emitted by ends and joints at t = 0, from the curves alone, before any reflection.

use serde::{Deserialize, Serialize};

use super::uniform::same_section;
use super::{Bar, EndCondition, Joint, Segment};
use crate::material::{Curve, Sense};
use crate::root::bisect;
use crate::wave::similarity::{Edge, Fan, fan_at_stress, fan_at_velocity};

/// Cells that the slowest front of a fan travels while schemes on a grid follow the exact fan, where the bar has room, and while histories show
/// the exact state. Copper on a wall at 60 m/s, 200 cells: the first cell has 0.9 % too much strain with 6, 0.4 % with 24; the error of all
/// benchmarks is least near 24. Bilinear steel, annealed copper and a foam that locks up oscillate by less than 1 % of the stress from there on.
pub const START_CELLS: f64 = 24.0;

/// Where a fan starts.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Origin {
    /// The left end.
    Left,
    /// The right end.
    Right,
    /// The joint between segments `0` and the next, counted from 0.
    Joint(usize),
}

impl Origin {
    /// In which waves run from an end: +1 from the left one, -1 from the right one.
    pub(super) fn direction(self) -> f64 {
        if self == Self::Left { 1.0 } else { -1.0 }
    }
}

impl std::fmt::Display for Origin {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Left => write!(f, "left"),
            Self::Right => write!(f, "right"),
            Self::Joint(k) => write!(f, "joint {}", k + 1),
        }
    }
}

/// What drives a fan.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub enum Driver {
    /// A velocity: of an end, or of the other side of a joint.
    Velocity,
    /// A stress.
    Stress,
    /// A body, which the bar slows down.
    Body,
}

/// How the bar behind a fan is unloaded.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Unloads {
    /// By elastic waves.
    Elastically,
    /// Back along the curve, as fast as the slowest front.
    AlongCurve,
}

/// One fan of fronts into one segment.
#[derive(Debug, Clone, PartialEq)]
pub struct InitialFan {
    /// Where it starts.
    pub origin: Origin,
    /// Place of the origin, m.
    pub x: f64,
    /// Segment that it runs through.
    pub segment: usize,
    /// +1 where it runs in +x, -1 in -x.
    pub direction: f64,
    /// Tension or compression.
    pub sense: Sense,
    /// The fronts, magnitudes.
    pub fan: Fan,
    /// The slowest of them is a shock.
    pub shock: bool,
    /// Velocity of the bar ahead, m/s.
    pub velocity_ahead: f64,
    /// When it starts, s: 0 but for a gap that closes first, or a wave. The times below count from then on.
    pub from: f64,
    /// The segment through which an elastic wave comes that starts it, if one does.
    pub wave_through: Option<usize>,
    /// Number of waves that have come to its origin through its segment before.
    pub waves_before: usize,
    /// The largest imposed value holds from t = 0 on and never changes.
    pub sudden: bool,
    /// From when on what drives it lessens while it holds, s, as a body does at once that the bar slows down; infinite where it does not.
    pub lessens_from: f64,
    /// Part of it that is gone per time as it lessens, 1/s.
    pub fades: f64,
    /// How it is unloaded then.
    pub unloads: Unloads,
    /// Stress that the bar behind it can lose before it yields the other way, Pa; infinite where that is not looked at.
    pub yields_after: f64,
    /// First time at which the driving value falls back (or is released), s; infinite where it never does.
    pub loads_until: f64,
    /// Time up to which what drives it stays as it is at t = 0, s: 0 where it grows from nothing. A striker is slowed down; it counts as
    /// steady while that changes the force by less than 2 %. Of fans that start on a grid: or up to which it only lessens, see [`InitialFan::held_by`].
    pub holds_until: f64,
    /// When one of its plastic fronts meets another plastic front, s; infinite where that is not known.
    pub meets_plastic_at: f64,
    /// What drives it.
    pub driver: Driver,
    /// Nothing else sends waves into the bar until this fan meets a joint or the other end.
    pub alone: bool,
    /// Distance from its origin up to which the segment counts as uniform, m.
    pub uniform_for: f64,
    /// When each of its fronts leaves the origin, s, in order; empty where all do at once.
    pub delays: Vec<f64>,
}

/// Part of the force of a striker that it may lose and still count as steady.
const STEADY: f64 = 0.02;

/// Part of its plastic fronts up to which a fan is followed as it is unloaded.
const FOLLOWED: f64 = 0.9;

impl InitialFan {
    /// Of these fronts, which start at t = 0 and run through a segment, given with its number, in a direction: driven by a velocity that never changes.
    fn at_start((origin, direction): (Origin, f64), (segment, at): (usize, &Segment), sense: Sense, fan: Fan) -> Self {
        let curve = at.material.branch(sense);
        let uniform_for = same_section(at, direction);
        Self {
            velocity_ahead: at.velocity,
            uniform_for,
            ..Self::steady((origin, direction), segment, (sense, curve), fan)
        }
    }

    /// The same in a bar at rest that is uniform, of this curve.
    pub fn steady(
        (origin, direction): (Origin, f64),
        segment: usize,
        (sense, curve): (Sense, &Curve),
        fan: Fan,
    ) -> Self {
        Self {
            origin,
            x: 0.0,
            segment,
            direction,
            sense,
            shock: fan.edges.last().is_some_and(|edge| edge.is_shock(curve)),
            fan,
            velocity_ahead: 0.0,
            from: 0.0,
            wave_through: None,
            waves_before: 0,
            sudden: false,
            lessens_from: f64::INFINITY,
            fades: 0.0,
            unloads: Unloads::Elastically,
            yields_after: f64::INFINITY,
            loads_until: f64::INFINITY,
            holds_until: f64::INFINITY,
            meets_plastic_at: f64::INFINITY,
            driver: Driver::Velocity,
            alone: false,
            uniform_for: f64::INFINITY,
            delays: Vec::new(),
        }
    }

    /// Time (s) up to which its origin is in the state behind it, in a segment of this `length` (m): what drives it does not change, and no
    /// other wave has come. 0 where that state is not known.
    pub fn known_until(&self, length: f64) -> f64 {
        if self.state_behind().is_some() { self.alone_for(length) } else { 0.0 }
    }

    /// Time (s) up to which what drives it does not change, and no other wave has come, in a segment of this `length` (m).
    pub(super) fn alone_for(&self, length: f64) -> f64 {
        let Some(first) = self.fan.edges.first() else { return 0.0 };
        // Other waves may come to meet it from the far side.
        let room = if self.alone { length } else { 0.5 * length }.min(self.uniform_for);
        (room / first.speed).min(self.holds_until)
    }

    /// Time (s) after which its slowest front has travelled [`START_CELLS`] cells of this length, m; 0 of one that is elastic: `c0` is the speed (m/s)
    /// of such waves.
    pub fn followed_for(&self, dx: f64, c0: f64) -> f64 {
        let slowest = self.fan.edges.last().filter(|edge| !edge.is_elastic(c0));
        let delay = self.delays.last().copied().unwrap_or(0.0);
        slowest.map_or(0.0, |edge| delay + START_CELLS * dx / edge.speed)
    }

    /// Part of what drives it that is gone when it has been followed for a time, s.
    pub fn loses(&self, followed: f64) -> f64 {
        self.fades * (followed.min(self.holds_until) - self.lessens_from).max(0.0)
    }

    /// What drives it lessens while it holds.
    pub fn lessens(&self) -> bool {
        self.lessens_from < self.holds_until
    }

    /// The same, driven by this end of a segment: for as long as what that imposes from `settled` (s) on stays as it is, or lessens and does not use up
    /// all plastic fronts.
    #[must_use]
    pub fn held_by(self, end: &EndCondition, at: &Segment, settled: f64) -> Self {
        let part = self.can_lose(at.material.c0());
        let change = match self.driver {
            Driver::Stress => self.sense.sign() * self.changes()[0],
            _ => -self.direction * self.sense.sign() * self.fan.velocity,
        };
        let (until, lessens_from, fades) = match end {
            EndCondition::Velocity { history, .. } | EndCondition::Stress { history } => {
                let steady = history.stays_near(settled, history.at(settled), DRIFT * change.abs());
                let falls = history.lessens_until(settled, history.at(settled) - change, part);
                let fades = history.fades(settled, history.at(settled) - change, falls);
                if falls > steady { (falls, steady, fades) } else { (steady, f64::INFINITY, 0.0) }
            }
            EndCondition::Striker { mass, .. } => {
                let area = at.end_areas()[usize::from(self.direction < 0.0)];
                let decay = mass / (at.material.impedance() * area);
                (self.from + part * decay, self.from + STEADY * decay, 1.0 / decay)
            }
            _ => (f64::INFINITY, f64::INFINITY, 0.0),
        };
        let holds_until = self.holds_until.min(until - self.from);
        Self { holds_until, lessens_from: lessens_from - self.from, fades, ..self }
    }

    /// The same in a bar that is unloaded along its curve. How much of a stress it can lose then is not known.
    #[must_use]
    pub fn unloading_along_curve(self) -> Self {
        let steady = if self.driver == Driver::Stress { self.lessens_from } else { f64::INFINITY };
        Self { holds_until: self.holds_until.min(steady), unloads: Unloads::AlongCurve, ..self }
    }

    /// Speed of the waves that unload the bar behind it, m/s; `c0` is that of elastic waves.
    pub fn unloading_speed(&self, c0: f64) -> f64 {
        let slowest = self.fan.edges.last().map_or(0.0, |edge| edge.speed);
        if self.unloads == Unloads::Elastically { c0 } else { slowest }
    }

    /// Stress that its end loses with its velocity as that falls steadily at first, over the density, m/s.
    pub fn slowing(&self, c0: f64) -> f64 {
        let (waves, front) = (self.unloading_speed(c0), self.fan.edges.last().map_or(0.0, |edge| edge.speed));
        2.0 * front * waves * waves / (waves * waves + front * front)
    }

    /// Part of what drives it that its end can lose before its fronts are used up.
    pub fn can_lose(&self, c0: f64) -> f64 {
        let slowest = self.fan.edges.last().map_or(0.0, |edge| edge.speed);
        let size = |edge: &Edge| match self.driver {
            Driver::Stress => edge.stress_behind - edge.stress_ahead,
            _ => edge.velocity_jump(),
        };
        let plastic = self.fan.edges.iter().filter(|edge| !edge.is_elastic(c0));
        // What is left of a loss at the front.
        let [squared, squared_slow] = [c0 * c0, slowest * slowest];
        let arrives = match self.driver {
            // The stress that is lost there over that at the end, rho c times the velocity.
            Driver::Stress => (squared - squared_slow) / (2.0 * squared),
            _ => (squared - squared_slow) / (squared + squared_slow),
        };
        FOLLOWED * (plastic.map(size).sum::<f64>() / (arrives * self.fan.edges.iter().map(size).sum::<f64>())).min(1.0)
    }

    /// The same, started by an elastic wave that lessens for a time (s), in which this part of it goes.
    #[must_use]
    pub fn fading(self, part: f64, time: f64) -> Self {
        Self { holds_until: self.holds_until.min(time), lessens_from: 0.0, fades: part / time, ..self }
    }

    /// Part of its change of velocity that its plastic fronts bring, where elastic waves travel with `c0`, m/s.
    pub fn plastic_part(&self, c0: f64) -> f64 {
        let plastic = self.fan.edges.iter().filter(|edge| !edge.is_elastic(c0));
        plastic.map(Edge::velocity_jump).sum::<f64>() / self.fan.velocity
    }

    /// It starts at the same place before another one, and what drives it holds for some time.
    pub fn precedes(&self, other: &Self) -> bool {
        self.origin == other.origin && self.from < other.from && self.holds_until > 0.0
    }

    /// What it changes, >= 0: stress (Pa) and strain.
    pub fn changes(&self) -> [f64; 2] {
        let ahead = self.fan.edges.first().map_or([0.0; 2], |edge| [edge.stress_ahead, edge.strain_ahead]);
        [self.fan.stress - ahead[0], self.fan.strain - ahead[1]]
    }

    /// Stress ahead of it, Pa.
    pub fn stress_ahead(&self) -> f64 {
        self.fan.edges.first().map_or(0.0, |edge| self.sense.sign() * edge.stress_ahead)
    }

    /// Stress (Pa) and velocity (m/s) behind it; none above the critical velocity or beyond the data of the curve.
    pub fn state_behind(&self) -> Option<[f64; 2]> {
        (!self.fan.above_critical && !self.fan.beyond_data).then(|| self.behind_fronts())
    }

    /// The same of an end that moves faster than the curve carries away: the ultimate stress, and the velocity of the bar.
    pub(super) fn state_above_critical(&self) -> Option<[f64; 2]> {
        (self.fan.above_critical && self.driver != Driver::Stress).then(|| self.behind_fronts())
    }

    fn behind_fronts(&self) -> [f64; 2] {
        let sense = self.sense.sign();
        [sense * self.fan.stress, self.velocity_ahead - self.direction * sense * self.fan.velocity]
    }
}

/// All fans of a bar with its ends, left to right; none of a bar with an initial state, in which waves do not start from zero stress.
pub fn initial_fans(bar: &Bar, left: &EndCondition, right: &EndCondition) -> Vec<InitialFan> {
    fans(bar, left, right, Imposed::at_most)
}

/// Those of the largest or of the first values that ends impose.
fn fans(bar: &Bar, left: &EndCondition, right: &EndCondition, imposed: Drive) -> Vec<InitialFan> {
    if bar.has_initial_state() {
        return Vec::new();
    }
    let last = bar.segments.len() - 1;
    let mut all = Vec::new();
    let from_end = |end: &EndCondition, origin: Origin, x: f64, segment: usize| {
        let at = &bar.segments[segment];
        of_end(imposed(at, end, origin.direction())?, origin, x, segment, at)
    };
    all.extend(from_end(left, Origin::Left, 0.0, 0));
    let mut x = 0.0;
    for k in 0..last {
        x += bar.segments[k].length;
        all.extend(from_joint(k, x, &bar.segments[k], &bar.segments[k + 1]));
    }
    all.extend(from_end(right, Origin::Right, bar.length(), last));
    let [at_left, at_right] = [0, last].map(|k| bar.segments[k].velocity);
    let acts = acts_without_fan(left, 1.0, at_left) || acts_without_fan(right, -1.0, at_right);
    let closes = |k: usize| gap_closes(bar, [left, right], Origin::Joint(k)).is_some_and(|time| time > 0.0);
    let alone = all.len() == 1 && !acts && !(0..last).any(closes);
    for fan in &mut all {
        fan.alone = alone;
    }
    all
}

/// The first fans of a bar: those at t = 0 or, of a bar in which nothing happens before one gap closes, that of a wall or of one joint, those
/// of that moment.
pub fn first_fans(bar: &Bar, left: &EndCondition, right: &EndCondition) -> Vec<InitialFan> {
    let fans = initial_fans(bar, left, right);
    if fans.is_empty() { at_gap(bar, [left, right]).unwrap_or_default() } else { fans }
}

/// The same, with ends as they move at first: a history that starts with 15 m/s and jumps to 25 m/s later starts the fan of 15 m/s.
pub fn starting_fans(bar: &Bar, left: &EndCondition, right: &EndCondition) -> Vec<InitialFan> {
    let largest = initial_fans(bar, left, right);
    if largest.is_empty() {
        return at_gap(bar, [left, right]).unwrap_or_default();
    }
    let mut fans = fans(bar, left, right, Imposed::at_first);
    for fan in &mut fans {
        let at = &bar.segments[fan.segment];
        match fan.origin {
            Origin::Left => *fan = fan.clone().held_by(left, at, 0.0),
            Origin::Right => *fan = fan.clone().held_by(right, at, 0.0),
            Origin::Joint(_) => {}
        }
    }
    // Another end may act later.
    let alone = largest.iter().all(|fan| fan.alone);
    for fan in &mut fans {
        fan.alone &= alone;
    }
    fans
}

fn at_gap(bar: &Bar, ends: [&EndCondition; 2]) -> Option<Vec<InitialFan>> {
    let mut closed = bar.clone();
    for segment in &mut closed.segments {
        if let Joint::Contact { gap } = &mut segment.joint {
            *gap = 0.0;
        }
    }
    let [left_end, right_end] =
        ends.map(|end| if wall_gap(end).is_some() { EndCondition::Wall { gap: 0.0 } } else { end.clone() });
    let mut fans = initial_fans(&closed, &left_end, &right_end);
    let origin = fans.first()?.origin;
    let [left, right] = [0, bar.segments.len() - 1].map(|k| bar.segments[k].velocity);
    let acts = acts_without_fan(&left_end, 1.0, left) || acts_without_fan(&right_end, -1.0, right);
    if acts || fans.iter().any(|fan| fan.origin != origin) {
        return None;
    }
    let from = gap_closes(bar, ends, origin)?;
    for fan in &mut fans {
        fan.from = from;
    }
    Some(fans)
}

/// When a gap closes if both sides move as at t = 0, s; none where there is none, or it does not close.
fn gap_closes(bar: &Bar, ends: [&EndCondition; 2], origin: Origin) -> Option<f64> {
    let velocity = |k: usize| bar.segments[k].velocity;
    let (gap, closing) = match origin {
        Origin::Left => (wall_gap(ends[0])?, -velocity(0)),
        Origin::Right => (wall_gap(ends[1])?, velocity(bar.segments.len() - 1)),
        Origin::Joint(k) => {
            let Joint::Contact { gap } = bar.segments[k].joint else { return None };
            (gap, velocity(k) - velocity(k + 1))
        }
    };
    (closing > 0.0).then(|| gap / closing)
}

fn wall_gap(end: &EndCondition) -> Option<f64> {
    if let EndCondition::Wall { gap } = end { Some(*gap) } else { None }
}

/// Whether an end that starts no fan sends waves into the bar before any have come to it: a bar that moves at `rest` (m/s) loads it, or a body
/// comes to it. `direction` is +1 at the left end and -1 at the right one.
pub(crate) fn acts_without_fan(end: &EndCondition, direction: f64, rest: f64) -> bool {
    match end {
        EndCondition::Spring { .. } => rest != 0.0,
        EndCondition::Wall { gap } => *gap > 0.0 && rest * direction < 0.0,
        EndCondition::Ball { velocity, .. } => (velocity - rest) * direction > 0.0,
        // An absorbing end moves with the bar.
        EndCondition::Free
        | EndCondition::Absorbing
        | EndCondition::Fixed
        | EndCondition::Velocity { .. }
        | EndCondition::Stress { .. }
        | EndCondition::Dashpot { .. }
        | EndCondition::Striker { .. } => false,
    }
}

/// What drives the end of a segment at t = 0, and until when at the latest, s. None of ends that do nothing of their own at once.
pub(crate) fn drives_at_start(end: &EndCondition, direction: f64, at: &Segment) -> Option<(Driver, f64)> {
    Imposed::at_first(at, end, direction).map(|imposed| (imposed.driver, imposed.holds_until))
}

pub(super) fn from_end(
    end: &EndCondition,
    (origin, x, segment): (Origin, f64, usize),
    at: &Segment,
) -> Option<InitialFan> {
    of_end(Imposed::at_most(at, end, origin.direction())?, origin, x, segment, at)
}

/// What waves start from the ends of a bar of themselves, each end given with its origin, its place (m), the number of its segment and that segment; none
/// in a bar with an initial state.
pub(super) fn at_ends(
    bar: &Bar,
    ends: [&EndCondition; 2],
    wave: impl Fn(&EndCondition, (Origin, f64, usize), &Segment) -> Option<InitialFan>,
) -> Vec<InitialFan> {
    if bar.has_initial_state() {
        return Vec::new();
    }
    let last = bar.segments.len() - 1;
    let places = [(Origin::Left, 0.0, 0), (Origin::Right, bar.length(), last)];
    let of_end = |(end, place): (&EndCondition, (Origin, f64, usize))| wave(end, place, &bar.segments[place.2]);
    ends.into_iter().zip(places).filter_map(of_end).collect()
}

fn of_end(imposed: Imposed, origin: Origin, x: f64, segment: usize, at: &Segment) -> Option<InitialFan> {
    let (direction, density) = (origin.direction(), at.material.density);
    // A wave running in +x behind which the bar moves faster in +x compresses it, and likewise mirrored.
    let under_stress = imposed.driver == Driver::Stress;
    let sense = Sense::of(if under_stress { imposed.change } else { -direction * imposed.change });
    let (curve, change) = (at.material.branch(sense), imposed.change.abs());
    let fan =
        if under_stress { fan_at_stress(curve, density, change) } else { fan_at_velocity(curve, density, change) };
    let Imposed { driver, sudden, loads_until, holds_until, .. } = imposed;
    (!fan.edges.is_empty() || fan.above_critical).then_some(InitialFan {
        x,
        sudden,
        loads_until,
        holds_until,
        driver,
        ..InitialFan::at_start((origin, direction), (segment, at), sense, fan)
    })
}

/// What the end of a segment imposes, from which waves run in a direction: +1 at its left, -1 at its right.
type Drive = fn(&Segment, &EndCondition, f64) -> Option<Imposed>;

/// Part of its change by which a value may drift and still count as the one that it was. What the end moves farther than its fan stays in the first
/// cell as strain: 24 cells on, twelve times that part of the velocity over the speed of the slowest front.
const DRIFT: f64 = 0.001;

/// The history that an end follows, the value (m/s or Pa) of a bar that nothing drives, and when the end is released, s; none of other ends.
fn prescribed<'a>(at: &Segment, end: &'a EndCondition) -> Option<(Driver, &'a super::History, [f64; 2])> {
    match end {
        EndCondition::Velocity { history, release } => {
            Some((Driver::Velocity, history, [at.velocity, release.unwrap_or(f64::INFINITY)]))
        }
        EndCondition::Stress { history } => Some((Driver::Stress, history, [0.0, f64::INFINITY])),
        _ => None,
    }
}

/// What an end imposes on the bar.
#[derive(Clone, Copy)]
struct Imposed {
    driver: Driver,
    /// Of the velocity, m/s; of the stress where that drives, Pa.
    change: f64,
    sudden: bool,
    loads_until: f64,
    holds_until: f64,
}

impl Imposed {
    /// One value for ever.
    fn steady(driver: Driver, change: f64) -> Self {
        Self { driver, change, sudden: true, loads_until: f64::INFINITY, holds_until: f64::INFINITY }
    }

    /// At first, for as long as that holds.
    fn at_first(at: &Segment, end: &EndCondition, direction: f64) -> Option<Self> {
        let Some((driver, history, [rest, released])) = prescribed(at, end) else {
            return Self::at_most(at, end, direction).map(|imposed| Self { holds_until: f64::INFINITY, ..imposed });
        };
        let change = history.at(0.0) - rest;
        let holds_until = if change == 0.0 { 0.0 } else { released };
        Some(Self { sudden: history.is_constant(), holds_until, ..Self::steady(driver, change) })
    }

    /// At its strongest.
    fn at_most(at: &Segment, end: &EndCondition, direction: f64) -> Option<Self> {
        if let Some((driver, history, [rest, released])) = prescribed(at, end) {
            let (peak, until) = peak(history, rest);
            let rounding = ROUND_OFF * (rest.abs() + peak.abs());
            return Some(Self {
                driver,
                change: peak,
                sudden: history.is_constant(),
                loads_until: until.min(released),
                holds_until: history.stays_near(0.0, rest + peak, rounding).min(released),
            });
        }
        let (rest, area) = (at.velocity, at.end_areas()[usize::from(direction < 0.0)]);
        match end {
            EndCondition::Fixed => Some(Self::steady(Driver::Velocity, -rest)),
            // The bar moves towards a wall at the left when its velocity is negative.
            EndCondition::Wall { gap } if *gap == 0.0 && rest * direction < 0.0 => {
                Some(Self::steady(Driver::Velocity, -rest))
            }
            EndCondition::Dashpot { coefficient } if *coefficient > 0.0 => {
                Some(Self::steady(Driver::Stress, against_dashpot(at, *coefficient, direction, area)))
            }
            // Strongest at the first touch: from then on the bar slows it down.
            EndCondition::Striker { mass, velocity } if (velocity - rest) * direction > 0.0 => {
                Some(Self {
                    driver: Driver::Body,
                    change: velocity - rest,
                    sudden: false,
                    loads_until: 0.0,
                    holds_until: STEADY * mass / (at.material.impedance() * area),
                })
            }
            EndCondition::Wall { .. }
            | EndCondition::Free
            | EndCondition::Absorbing
            | EndCondition::Dashpot { .. }
            | EndCondition::Striker { .. }
            // Its force starts from nothing.
            | EndCondition::Ball { .. }
            | EndCondition::Spring { .. }
            | EndCondition::Velocity { .. }
            | EndCondition::Stress { .. } => None,
        }
    }
}

/// Stress (Pa) behind the fan of a bar that moves against a dashpot (N s/m): its force is that at which both together take up the velocity of the bar.
fn against_dashpot(at: &Segment, coefficient: f64, direction: f64, area: f64) -> f64 {
    if at.velocity == 0.0 {
        return 0.0;
    }
    let sense = Sense::of(direction * at.velocity);
    let curve = at.material.branch(sense);
    let taken = |force: f64| fan_at_stress(curve, at.material.density, force / area).velocity + force / coefficient;
    sense.sign() * joint_force(at.velocity.abs(), taken, area * strongest(curve)) / area
}

/// The first extreme of a history relative to `rest`, and when the history first falls back from it.
fn peak(history: &super::History, rest: f64) -> (f64, f64) {
    let mut best = 0.0_f64;
    let mut previous_time = 0.0;
    for (&time, &value) in history.time().iter().zip(history.value()) {
        let relative = value - rest;
        if best != 0.0 && (relative * best < 0.0 || relative.abs() < best.abs()) {
            return (best, previous_time);
        }
        best = relative;
        previous_time = time;
    }
    (best, f64::INFINITY)
}

/// Part of a velocity within which it is another one to rounding.
const ROUND_OFF: f64 = 1e-14;

/// Two segments that start with different velocities: the force at which both fans agree on the joint's velocity.
fn from_joint(k: usize, x: f64, left: &Segment, right: &Segment) -> Vec<InitialFan> {
    let closing = left.velocity - right.velocity;
    let carries = closing > 0.0 || left.joint == Joint::Bonded;
    if closing == 0.0 || !carries || matches!(left.joint, Joint::Contact { gap } if gap > 0.0) {
        return Vec::new();
    }
    let sense = Sense::of(-closing);
    let ([_, left_area], [right_area, _]) = (left.end_areas(), right.end_areas());
    let fan = |s: &Segment, stress: f64| fan_at_stress(s.material.branch(sense), s.material.density, stress);
    let both = |force: f64| fan(left, force / left_area).velocity + fan(right, force / right_area).velocity;
    let limit = |s: &Segment, area: f64| area * strongest(s.material.branch(sense));
    let force = joint_force(closing.abs(), both, limit(left, left_area).min(limit(right, right_area)));
    [(k, left, left_area, -1.0), (k + 1, right, right_area, 1.0)]
        .into_iter()
        .map(|(segment, at, area, direction)| {
            let fan = InitialFan::at_start((Origin::Joint(k), direction), (segment, at), sense, fan(at, force / area));
            InitialFan { x, sudden: true, ..fan }
        })
        .collect()
}

/// Largest stress of the curve, Pa; infinite if it increases without limit.
fn strongest(curve: &Curve) -> f64 {
    match curve.beyond() {
        crate::material::Beyond::Extend if curve.ultimate().is_none() => f64::INFINITY,
        _ => curve.stress().iter().fold(0.0, |m, &s| m.max(s)),
    }
}

/// The force in 0..=limit at which `velocity(force)`, never falling, reaches `target`; to the last bit by bisection.
fn joint_force(target: f64, velocity: impl Fn(f64) -> f64, limit: f64) -> f64 {
    let (low, mut high) = (0.0, if limit.is_finite() { limit } else { 1.0 });
    while limit.is_infinite() && velocity(high) < target {
        high *= 2.0;
    }
    if velocity(high) <= target {
        return high;
    }
    bisect([low, high], 0.0, |force| velocity(force) < target)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bar::History;

    #[test]
    fn a_history_holds_its_value_up_to_the_row_before_another() {
        let until = |rows: &[(f64, f64)], value: f64| {
            History::new(rows).expect("rows are in order").stays_near(0.0, value, 0.0)
        };
        assert_eq!(until(&[(0.0, 3.0)], 3.0), f64::INFINITY);
        assert_eq!(until(&[(0.0, 0.0), (0.0, 3.0), (2.0, 3.0), (2.0, 0.0)], 3.0), 2.0);
        assert_eq!(until(&[(0.0, 3.0), (1.0, 3.0), (2.0, 0.0), (4.0, 3.0)], 3.0), 1.0);
        assert_eq!(until(&[(0.0, 3.0), (2.0, 0.0)], 3.0), 0.0);
        assert_eq!(until(&[(0.0, 0.0), (2.0, 3.0)], 3.0), 0.0);
        assert_eq!(until(&[(1.0, 3.0), (2.0, 3.0)], 3.0), 0.0);
        let drifting = History::new(&[(0.0, 3.0), (1.0, 3.0), (2.0, 4.0)]).expect("rows are in order");
        assert_eq!(drifting.stays_near(0.0, 3.0, 0.25), 1.25);
    }

    /// -34.1 + 68.4 is not 34.3: the end had no fan, and the first cell 22 % too much strain.
    #[test]
    fn a_velocity_holds_whatever_rounding_makes_of_its_difference_to_that_of_the_bar() {
        let history = History::constant(34.3);
        let (peak, _) = peak(&history, -34.1);
        assert_eq!(history.stays_near(0.0, -34.1 + peak, ROUND_OFF * 100.0), f64::INFINITY);
        assert_ne!(-34.1 + peak, 34.3);
    }
}
