//! Initial fans: the centred waves emitted by ends and joints at t = 0, computed from the curves alone, before any reflection.

use serde::{Deserialize, Serialize};

use super::uniform::same_section;
use super::{Bar, EndCondition, Joint, Segment};
use crate::material::{Curve, Sense};
use crate::root::bisect;
use crate::wave::similarity::{Edge, Fan, fan_at_stress, fan_at_velocity};

/// Number of cells that the slowest front of a fan travels while grid schemes follow the exact fan (if the bar is long enough) and while histories
/// show the exact state. Copper on a wall at 60 m/s, 200 cells: the first cell has 0.9 % too much strain with 6 cells, 0.4 % with 24. The error over
/// all benchmarks is smallest near 24. From there on bilinear steel, annealed copper and a foam with lock-up oscillate by less than 1 % of the
/// stress.
pub const START_CELLS: f64 = 24.0;

/// Origin of a fan.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Origin {
    /// The left end.
    Left,
    /// The right end.
    Right,
    /// The joint between this segment and the next, counted from 0.
    Joint(usize),
}

impl Origin {
    /// Returns the direction of waves from an end: +1 from the left end, -1 from the right end.
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

/// Quantity that drives a fan.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub enum Driver {
    /// A velocity: of an end, or of the other side of a joint.
    Velocity,
    /// A stress.
    Stress,
    /// A body that the bar decelerates.
    Body,
}

/// Mode of unloading behind a fan.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Unloads {
    /// By elastic waves.
    Elastically,
    /// Back along the curve, with the speed of the slowest front.
    AlongCurve,
}

/// A fan of fronts in one segment.
#[derive(Debug, Clone, PartialEq)]
pub struct InitialFan {
    /// Origin of the fan.
    pub origin: Origin,
    /// Position of the origin, m.
    pub x: f64,
    /// Index of the segment through which the fan travels.
    pub segment: usize,
    /// Direction of travel: +1 in +x, -1 in -x.
    pub direction: f64,
    /// Sense of the stress: tension or compression.
    pub sense: Sense,
    /// Fronts, in magnitudes.
    pub fan: Fan,
    /// Whether the slowest front is a shock.
    pub shock: bool,
    /// Velocity of the bar ahead, m/s.
    pub velocity_ahead: f64,
    /// Start of the fan, s: 0 unless a gap closes first or a wave starts it. The times below count from this start.
    pub from: f64,
    /// Segment through which the elastic wave arrives that starts the fan; `None` if no wave starts it.
    pub wave_through: Option<usize>,
    /// Number of earlier waves that have arrived at the origin through the segment of the fan.
    pub waves_before: usize,
    /// Whether the largest imposed value is applied at t = 0 and never changes.
    pub sudden: bool,
    /// Time from which on the driving quantity decreases within `holds_until`, by more than counts as steady, s; infinite if it does not decrease.
    pub decays_from: f64,
    /// Relative rate at which it decreases, 1/s.
    pub decay_rate: f64,
    /// Mode of unloading behind the fan.
    pub unloads: Unloads,
    /// Decrease of the stress behind the fan at which the bar yields in the other sense, Pa; infinite if this is not considered.
    pub yields_after: f64,
    /// First time at which the driving quantity falls back (or is released), s; infinite if it never does.
    pub loads_until: f64,
    /// Time up to which the driving quantity keeps its value at t = 0, s; 0 if it rises from zero. A striker is decelerated; it counts as steady
    /// while the force changes by less than 2 %. For fans that start on a grid: time up to which the quantity is constant or only decreases, see
    /// [`InitialFan::held_by`].
    pub holds_until: f64,
    /// Time at which one of its plastic fronts meets another plastic front, s; infinite if not known.
    pub meets_plastic_at: f64,
    /// Quantity that drives the fan.
    pub driver: Driver,
    /// Whether no other waves enter the bar until this fan meets a joint or the other end.
    pub alone: bool,
    /// Distance from the origin up to which the segment counts as uniform, m.
    pub uniform_for: f64,
    /// Times at which the fronts leave the origin, s, ascending; empty if all leave at once.
    pub delays: Vec<f64>,
}

/// Relative decrease of the force of a striker up to which it counts as steady.
const STEADY: f64 = 0.02;

/// Fraction of its plastic fronts that may be used up by unloading while a fan is followed.
const FOLLOWED: f64 = 0.9;

impl InitialFan {
    /// Returns a fan with these fronts, which starts at t = 0 in a direction in a segment (given with its index) and is driven by a constant
    /// velocity.
    fn at_start((origin, direction): (Origin, f64), (segment, at): (usize, &Segment), sense: Sense, fan: Fan) -> Self {
        let curve = at.material.branch(sense);
        let uniform_for = same_section(at, direction);
        Self {
            velocity_ahead: at.velocity,
            uniform_for,
            ..Self::steady((origin, direction), segment, (sense, curve), fan)
        }
    }

    /// Returns such a fan in a uniform bar at rest with this curve.
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
            decays_from: f64::INFINITY,
            decay_rate: 0.0,
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

    /// Returns the time (s) up to which the origin is in the state behind the fan, in a segment of this `length` (m): the driving quantity is
    /// constant, and no other wave has arrived. Returns 0 if that state is not known.
    pub fn known_until(&self, length: f64) -> f64 {
        if self.state_behind().is_some() { self.alone_for(length) } else { 0.0 }
    }

    /// Returns the time (s) up to which the driving quantity is constant and no other wave has arrived, in a segment of this `length` (m).
    pub(super) fn alone_for(&self, length: f64) -> f64 {
        let Some(first) = self.fan.edges.first() else { return 0.0 };
        // Other waves may approach from the far side.
        let room = if self.alone { length } else { 0.5 * length }.min(self.uniform_for);
        (room / first.speed).min(self.holds_until)
    }

    /// Returns the time (s) in which the slowest front travels [`START_CELLS`] cells of length `dx` (m); 0 if it is elastic. `c0` is the elastic wave
    /// speed, m/s.
    pub fn followed_for(&self, dx: f64, c0: f64) -> f64 {
        let slowest = self.fan.edges.last().filter(|edge| !edge.is_elastic(c0));
        let delay = self.delays.last().copied().unwrap_or(0.0);
        slowest.map_or(0.0, |edge| delay + START_CELLS * dx / edge.speed)
    }

    /// Returns the fraction of the driving quantity that is lost after the fan has been followed for a time, s.
    pub fn fraction_lost(&self, followed: f64) -> f64 {
        self.decay_rate * (followed.min(self.holds_until) - self.decays_from).max(0.0)
    }

    /// Returns true if the driving quantity decreases within `holds_until`.
    pub fn decays(&self) -> bool {
        self.decays_from < self.holds_until
    }

    /// Returns the fan, driven by this end of a segment. It holds as long as the quantity imposed by the end, from `settled` (s) on, is constant, or
    /// decreases without using up all plastic fronts.
    #[must_use]
    pub fn held_by(self, end: &EndCondition, at: &Segment, settled: f64) -> Self {
        let part = self.can_lose(at.material.c0());
        let change = match self.driver {
            Driver::Stress => self.sense.sign() * self.changes()[0],
            _ => -self.direction * self.sense.sign() * self.fan.velocity,
        };
        let (until, decays_from, decay_rate) = match end {
            EndCondition::Velocity { history, .. } | EndCondition::Stress { history } => {
                let steady = history.stays_near(settled, history.at(settled), DRIFT * change.abs());
                let falls = history.lessens_until(settled, history.at(settled) - change, part);
                let decay_rate = history.largest_decay_rate(settled, history.at(settled) - change, falls);
                if falls > steady { (falls, steady, decay_rate) } else { (steady, f64::INFINITY, 0.0) }
            }
            EndCondition::Striker { mass, .. } => {
                let area = at.end_areas()[usize::from(self.direction < 0.0)];
                let decay = mass / (at.material.impedance() * area);
                (self.from + part * decay, self.from + STEADY * decay, 1.0 / decay)
            }
            _ => (f64::INFINITY, f64::INFINITY, 0.0),
        };
        let holds_until = self.holds_until.min(until - self.from);
        Self { holds_until, decays_from: decays_from - self.from, decay_rate, ..self }
    }

    /// Returns the fan in a bar that unloads along its curve. It is then not known how much a stress may decrease.
    #[must_use]
    pub fn unloading_along_curve(self) -> Self {
        let steady = if self.driver == Driver::Stress { self.decays_from } else { f64::INFINITY };
        Self { holds_until: self.holds_until.min(steady), unloads: Unloads::AlongCurve, ..self }
    }

    /// Returns the speed of the waves that unload the bar behind the fan, m/s; `c0` is the elastic wave speed.
    pub fn unloading_speed(&self, c0: f64) -> f64 {
        let slowest = self.fan.edges.last().map_or(0.0, |edge| edge.speed);
        if self.unloads == Unloads::Elastically { c0 } else { slowest }
    }

    /// Returns the ratio of the stress decrease to the velocity decrease of the end at the beginning of a steady decrease, divided by the density,
    /// m/s.
    pub fn slowing(&self, c0: f64) -> f64 {
        let (waves, front) = (self.unloading_speed(c0), self.fan.edges.last().map_or(0.0, |edge| edge.speed));
        2.0 * front * waves * waves / (waves * waves + front * front)
    }

    /// Returns the fraction of the driving quantity that the end can lose before the fronts are used up.
    pub fn can_lose(&self, c0: f64) -> f64 {
        let slowest = self.fan.edges.last().map_or(0.0, |edge| edge.speed);
        let size = |edge: &Edge| match self.driver {
            Driver::Stress => edge.stress_behind - edge.stress_ahead,
            _ => edge.velocity_jump(),
        };
        let plastic = self.fan.edges.iter().filter(|edge| !edge.is_elastic(c0));
        // Fraction of a loss at the end that arrives at the slowest front.
        let [squared, squared_slow] = [c0 * c0, slowest * slowest];
        let arrives = match self.driver {
            // Stress lost at the front over that lost at the end, which is rho c times the velocity.
            Driver::Stress => (squared - squared_slow) / (2.0 * squared),
            _ => (squared - squared_slow) / (squared + squared_slow),
        };
        FOLLOWED * (plastic.map(size).sum::<f64>() / (arrives * self.fan.edges.iter().map(size).sum::<f64>())).min(1.0)
    }

    /// Returns the fan, started by an elastic wave that loses the fraction `part` of its strength within a time (s).
    #[must_use]
    pub fn fading(self, part: f64, time: f64) -> Self {
        Self { holds_until: self.holds_until.min(time), decays_from: 0.0, decay_rate: part / time, ..self }
    }

    /// Returns the fraction of the velocity change that is due to plastic fronts; `c0` is the elastic wave speed, m/s.
    pub fn plastic_part(&self, c0: f64) -> f64 {
        let plastic = self.fan.edges.iter().filter(|edge| !edge.is_elastic(c0));
        plastic.map(Edge::velocity_jump).sum::<f64>() / self.fan.velocity
    }

    /// Returns true if the fan starts from the same origin as another one, but earlier, and is held for some time.
    pub fn precedes(&self, other: &Self) -> bool {
        self.origin == other.origin && self.from < other.from && self.holds_until > 0.0
    }

    /// Returns the magnitudes of the changes of stress (Pa) and strain across the fan.
    pub fn changes(&self) -> [f64; 2] {
        let ahead = self.fan.edges.first().map_or([0.0; 2], |edge| [edge.stress_ahead, edge.strain_ahead]);
        [self.fan.stress - ahead[0], self.fan.strain - ahead[1]]
    }

    /// Returns the stress ahead of the fan, Pa.
    pub fn stress_ahead(&self) -> f64 {
        self.fan.edges.first().map_or(0.0, |edge| self.sense.sign() * edge.stress_ahead)
    }

    /// Returns stress (Pa) and velocity (m/s) behind the fan; `None` above the critical velocity or beyond the data of the curve.
    pub fn state_behind(&self) -> Option<[f64; 2]> {
        (!self.fan.above_critical && !self.fan.beyond_data).then(|| self.behind_fronts())
    }

    /// Returns stress and velocity behind the fan of an end above the critical velocity: the ultimate stress, and the velocity of the bar. Otherwise
    /// `None`.
    pub(super) fn state_above_critical(&self) -> Option<[f64; 2]> {
        (self.fan.above_critical && self.driver != Driver::Stress).then(|| self.behind_fronts())
    }

    fn behind_fronts(&self) -> [f64; 2] {
        let sense = self.sense.sign();
        [sense * self.fan.stress, self.velocity_ahead - self.direction * sense * self.fan.velocity]
    }
}

/// Returns all fans of a bar and its ends, from left to right. Empty for a bar with an initial state, where waves do not start from zero stress.
pub fn initial_fans(bar: &Bar, left: &EndCondition, right: &EndCondition) -> Vec<InitialFan> {
    fans(bar, left, right, Imposed::at_most)
}

/// Returns the fans of the largest or of the first values that the ends impose.
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

/// Returns the first fans of a bar: those at t = 0. If nothing happens before one gap (of a wall or of one joint) closes, returns the fans
/// at that time.
pub fn first_fans(bar: &Bar, left: &EndCondition, right: &EndCondition) -> Vec<InitialFan> {
    let fans = initial_fans(bar, left, right);
    if fans.is_empty() { at_gap(bar, [left, right]).unwrap_or_default() } else { fans }
}

/// Returns the first fans, with ends as they move at first: a history that starts with 15 m/s and later jumps to 25 m/s emits the fan of 15 m/s.
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
    // Another end may start to move later.
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

/// Returns the time at which a gap closes if both sides keep their velocities of t = 0, s. `None` if there is no gap, or if it does not close.
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

/// Returns true if an end that emits no fan sends waves into the bar before any wave arrives: because a bar that moves at `rest` (m/s) loads it, or a
/// body strikes the end. `direction` is +1 at the left end and -1 at the right one.
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

/// Returns the quantity that drives the end of a segment at t = 0, and the latest time up to which it does, s. `None` if the end imposes nothing at
/// once.
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

/// Returns the waves that the ends of a bar emit at t = 0, as computed by `wave` from each end, its origin, position (m) and segment index, and the
/// segment. Empty for a bar with an initial state.
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
    // A wave that travels in +x and increases the velocity in +x compresses the bar; mirrored for waves in -x.
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

/// Function that returns the value imposed by the end of a segment, given the direction of its waves: +1 at the left end, -1 at the right end.
type Drive = fn(&Segment, &EndCondition, f64) -> Option<Imposed>;

/// Relative change of a value up to which it counts as constant. The excess displacement of the end remains in the first
/// cell as strain: after 24 cells, twelve times this fraction of the velocity over the speed of the slowest front.
const DRIFT: f64 = 0.001;

/// Returns the driver and the history of an end, the value (m/s or Pa) of an undriven bar, and the time at which the end is released, s. `None` for
/// ends without a history.
fn prescribed<'a>(at: &Segment, end: &'a EndCondition) -> Option<(Driver, &'a super::History, [f64; 2])> {
    match end {
        EndCondition::Velocity { history, release } => {
            Some((Driver::Velocity, history, [at.velocity, release.unwrap_or(f64::INFINITY)]))
        }
        EndCondition::Stress { history } => Some((Driver::Stress, history, [0.0, f64::INFINITY])),
        _ => None,
    }
}

/// The value that an end imposes on the bar.
#[derive(Clone, Copy)]
struct Imposed {
    driver: Driver,
    /// Change of the velocity, m/s, or of the stress if that drives the fan, Pa.
    change: f64,
    sudden: bool,
    loads_until: f64,
    holds_until: f64,
}

impl Imposed {
    /// Returns a constant value.
    fn steady(driver: Driver, change: f64) -> Self {
        Self { driver, change, sudden: true, loads_until: f64::INFINITY, holds_until: f64::INFINITY }
    }

    /// Returns the first value of an end, up to its release.
    fn at_first(at: &Segment, end: &EndCondition, direction: f64) -> Option<Self> {
        let Some((driver, history, [rest, released])) = prescribed(at, end) else {
            return Self::at_most(at, end, direction).map(|imposed| Self { holds_until: f64::INFINITY, ..imposed });
        };
        let change = history.at(0.0) - rest;
        let holds_until = if change == 0.0 { 0.0 } else { released };
        Some(Self { sudden: history.is_constant(), holds_until, ..Self::steady(driver, change) })
    }

    /// Returns the largest value of an end.
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
            // The bar moves towards a wall at the left if its velocity is negative.
            EndCondition::Wall { gap } if *gap == 0.0 && rest * direction < 0.0 => {
                Some(Self::steady(Driver::Velocity, -rest))
            }
            EndCondition::Dashpot { coefficient } if *coefficient > 0.0 => {
                Some(Self::steady(Driver::Stress, against_dashpot(at, *coefficient, direction, area)))
            }
            // The load is largest at first contact: from then on the bar decelerates the striker.
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
            // These forces start from zero.
            | EndCondition::Ball { .. }
            | EndCondition::Spring { .. }
            | EndCondition::Velocity { .. }
            | EndCondition::Stress { .. } => None,
        }
    }
}

/// Returns the stress (Pa) behind the fan of a bar that moves against a dashpot (N s/m). At its force the velocity changes of both add up to the
/// velocity of the bar.
fn against_dashpot(at: &Segment, coefficient: f64, direction: f64, area: f64) -> f64 {
    if at.velocity == 0.0 {
        return 0.0;
    }
    let sense = Sense::of(direction * at.velocity);
    let curve = at.material.branch(sense);
    let taken = |force: f64| fan_at_stress(curve, at.material.density, force / area).velocity + force / coefficient;
    sense.sign() * joint_force(at.velocity.abs(), taken, area * strongest(curve)) / area
}

/// Returns the first extreme of a history relative to `rest`, and the time at which the history first falls back from it.
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

/// Relative rounding of a velocity.
const ROUND_OFF: f64 = 1e-14;

/// Returns the fans of two segments that start with different velocities, for the force at which the velocities at the joint agree.
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

/// Returns the largest stress of the curve, Pa; infinite if it increases without limit.
fn strongest(curve: &Curve) -> f64 {
    match curve.beyond() {
        crate::material::Beyond::Extend if curve.ultimate().is_none() => f64::INFINITY,
        _ => curve.stress().iter().fold(0.0, |m, &s| m.max(s)),
    }
}

/// Returns the force in 0..=limit at which the non-decreasing `velocity(force)` reaches `target`; to the last bit, by bisection.
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

    /// -34.1 + 68.4 is not 34.3 in floating point: with an exact comparison the end would have no fan, and the first cell 22 % too much strain.
    #[test]
    fn a_velocity_holds_whatever_rounding_makes_of_its_difference_to_that_of_the_bar() {
        let history = History::constant(34.3);
        let (peak, _) = peak(&history, -34.1);
        assert_eq!(history.stays_near(0.0, -34.1 + peak, ROUND_OFF * 100.0), f64::INFINITY);
        assert_ne!(-34.1 + peak, 34.3);
    }
}
