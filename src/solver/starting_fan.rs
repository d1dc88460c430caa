//! The centred fan of an end or a joint that is suddenly loaded, as schemes on a grid start with it; see [`crate::wave::similarity`].

use serde::{Deserialize, Serialize};

use super::unloading::Unloading;
use crate::bar::{Driver, InitialFan, Origin, START_CELLS};
use crate::wave::similarity::Edge;

/// Velocities of two sides of a joint that differ by this part of their jumps are one.
const TOGETHER: f64 = 1e-9;

/// Places that differ by this part are one.
const SAME_PLACE: f64 = 1e-9;

/// Part of its velocity within which a fan has lost nothing.
const ROUND_OFF: f64 = 1e-12;

/// Part of its stress by which a cell may stay below the stress that it had, where it is unloaded while a front is still spread over it; and cells over
/// which fronts are spread at least. In annealed copper pulled at a velocity that rises and falls in 50 us each, the force was wrong by 10 % with 7, and is
/// by 5 % with 1 (200 cells).
const BELOW: f64 = 0.01;
const LEAST_RAMP: f64 = 1.0;

/// Part of the stress after which the bar behind a fan yields the other way that it may lose.
const MOST_LOST: f64 = 0.9;

/// A front of a fan.
#[derive(Debug, Clone, Copy, Serialize, Deserialize)]
struct Front {
    /// m/s.
    speed: f64,
    /// It stays sharp: schemes are exact for it.
    elastic: bool,
    /// Velocity (m/s, in +x) and stress (Pa, tension positive) ahead of it.
    ahead: [f64; 2],
    /// When it leaves the origin, s.
    delay: f64,
}

/// How a grid resolves a segment.
#[derive(Debug, Clone, Copy)]
pub struct Resolution {
    /// Cell size, m.
    pub dx: f64,
    /// Cells.
    pub cells: usize,
    /// Time step, s.
    pub dt: f64,
    /// Elastic, m/s.
    pub wave_speed: f64,
}

/// The fan of an end or of one side of a joint.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct StartingFan {
    /// 0: it starts at the left of its segment, 1: at the right.
    pub side: usize,
    /// It starts at a joint.
    pub at_joint: bool,
    /// What drives it.
    pub driver: Driver,
    /// How what drives it unloads the bar, where that lessens.
    unloading: Option<Unloading>,
    /// Stress that the bar behind it can lose before it yields the other way, Pa.
    yields_after: f64,
    /// How far its end had moved at its start, m, less what it has lost of its way since, where that follows from a stress.
    pub placed: f64,
    /// Momentum that schemes owe for both sides of its joint, or for the stress or the body at its end, N s in +x.
    pub owed: f64,
    /// Only the node where it starts is made to move as the fan does.
    pub only_origin: bool,
    /// Its segment, which it does not leave while it is imposed.
    pub segment: usize,
    /// The fastest first.
    fronts: Vec<Front>,
    /// Velocity behind the fan, that of the end or the joint, m/s.
    pub velocity_behind: f64,
    /// Stress behind it, Pa, tension positive.
    pub stress: f64,
    /// Of waves that unload the bar, and what a steady change of velocity makes of both waves, Pa s/m.
    impedance: f64,
    slow_impedance: f64,
    /// Length over which fronts that are not elastic are ramps, m.
    ramp: f64,
    /// When it starts, s.
    pub from: f64,
    /// A wave from elsewhere in the bar starts it.
    by_wave: bool,
    /// The first step at the end of which it is imposed, and those up to which it is, and up to which it is known.
    first: usize,
    steps: usize,
    known: usize,
    /// Nodes from the end on that it may set: none that one from the far side sets, nor that a wave from elsewhere reaches while it is imposed.
    pub nodes: usize,
}

/// Nodes from the end on that a fan which grows sets: farther in, its fronts are so far from each other that a scheme takes them over as they are.
const GROWING_NODES: usize = 64;

impl StartingFan {
    /// On this grid of its segment, of this density (kg/m^3); plastic fronts are spread over `ramp` cells. None of one that leaves the bar elastic,
    /// but for sides of joints, of one above critical, and of one that does not travel.
    pub fn new(initial_fan: &InitialFan, density: f64, grid: &Resolution, ramp: f64) -> Option<Self> {
        let &Resolution { dx, cells, dt, wave_speed } = grid;
        let fan = &initial_fan.fan;
        let [stress, velocity_behind] = initial_fan.state_behind()?;
        let at_joint = matches!(initial_fan.origin, Origin::Joint(_));
        let elastic = |edge: &Edge| edge.is_elastic(wave_speed);
        // A side of a joint that stays elastic belongs to it as well.
        fan.edges.last().filter(|edge| (at_joint || !elastic(edge)) && edge.speed > 0.0)?;
        let followed = initial_fan.followed_for(dx, wave_speed);
        let wanted = (followed / dt).ceil();
        let possible = (initial_fan.known_until(dx * cells as f64) / dt).floor() - 1.0;
        let until_other_fans = if initial_fan.alone { cells } else { (cells - 1) / 2 };
        // Whatever is rounding: a bar and its mirror image have as many.
        let uniform = (initial_fan.uniform_for / dx * (1.0 + SAME_PLACE)) as usize;
        let near = if initial_fan.delays.is_empty() { cells } else { GROWING_NODES };
        // Waves that start a fan arrive with a whole step; that within which a gap closes is part of the fan.
        let (started, by_wave) = (initial_fan.from / dt, initial_fan.wave_through.is_some());
        let first = if by_wave { started.round() } else { started.floor() };
        let fronts = fronts(initial_fan, wave_speed);
        let unloading_speed = initial_fan.unloading_speed(wave_speed);
        let brought = brought(&fronts, velocity_behind);
        Some(Self {
            side: usize::from(initial_fan.direction < 0.0),
            at_joint,
            driver: initial_fan.driver,
            unloading: initial_fan.lessens().then(|| Unloading::new(unloading_speed, brought)),
            yields_after: initial_fan.yields_after,
            placed: 0.0,
            owed: 0.0,
            only_origin: false,
            segment: initial_fan.segment,
            fronts,
            velocity_behind,
            stress,
            impedance: density * unloading_speed,
            slow_impedance: density * initial_fan.slowing(wave_speed),
            ramp: dx * ramp.min((2.0 * START_CELLS * BELOW / initial_fan.loses(followed)).max(LEAST_RAMP)),
            from: initial_fan.from,
            by_wave,
            first: first as usize,
            steps: (first + wanted.min(possible).max(0.0)) as usize,
            known: (first + possible.max(0.0)) as usize,
            nodes: until_other_fans.min(uniform).min(near),
        })
    }

    /// Both sides of a joint start with their fans, for as long as the one asks for it and both are known, or neither.
    pub fn keep_whole_joints(fans: &mut [Self], segments: usize) {
        let mut starts: Vec<f64> = fans.iter().map(|fan| fan.from).collect();
        starts.sort_by(f64::total_cmp);
        starts.dedup();
        for (segment, from) in (0..segments - 1).flat_map(|segment| starts.iter().map(move |&from| (segment, from))) {
            let beside = [(segment, 1), (segment + 1, 0)];
            let here = |fan: &Self| fan.at_joint && fan.from == from && beside.contains(&(fan.segment, fan.side));
            let sides: Vec<&Self> = fans.iter().filter(|fan| here(fan)).collect();
            let wanted = sides.iter().map(|fan| fan.steps).max().unwrap_or(0);
            let known = sides.iter().map(|fan| fan.known).min().unwrap_or(0);
            // Where a level curve carries no more, the sides part.
            let together = |a: &Self, b: &Self| {
                let jump = |fan: &Self| (fan.velocity_behind - fan.velocity_ahead()).abs();
                (a.velocity_behind - b.velocity_behind).abs() <= TOGETHER * (jump(a) + jump(b))
            };
            let steps = match sides[..] {
                [a, b] if together(a, b) => wanted.min(known),
                _ => 0,
            };
            fans.iter_mut().filter(|fan| here(fan)).for_each(|fan| fan.steps = steps);
        }
    }

    /// Its fronts leave its origin one after another.
    pub fn grows(&self) -> bool {
        self.grows_at(0.0)
    }

    /// Some of them leave after this time, s after its start.
    pub fn grows_at(&self, time: f64) -> bool {
        self.fronts.last().is_some_and(|front| front.delay > time.max(0.0))
    }

    /// How far its origin has moved `time` (s) after its start, m; before its start, at negative times, it moves with the bar ahead.
    pub fn moved(&self, time: f64) -> f64 {
        if !self.grows() {
            return if time < 0.0 { self.velocity_ahead() } else { self.velocity_behind } * time;
        }
        let behind = self.fronts.iter().skip(1).map(|front| front.ahead[0]).chain([self.velocity_behind]);
        let since = |(front, behind): (&Front, f64)| (behind - front.ahead[0]) * (time - front.delay).max(0.0);
        self.velocity_ahead() * time + self.fronts.iter().zip(behind).map(since).sum::<f64>()
    }

    /// Velocity of the bar ahead of it, m/s.
    fn velocity_ahead(&self) -> f64 {
        self.fronts[0].ahead[0]
    }

    /// It is imposed at the end of this step.
    pub fn is_imposed_at(&self, step: usize) -> bool {
        (self.first..self.steps).contains(&step)
    }

    /// It is imposed at the end of this step or of a later one.
    pub fn is_imposed_from(&self, step: usize) -> bool {
        step < self.steps && self.first < self.steps
    }

    /// It is imposed at the end of this step for the last time, if it has started.
    pub fn end_after(&mut self, step: usize) {
        self.steps = self.steps.min(step + 1);
    }

    /// This is the first step at the end of which it is imposed.
    pub fn begins_at(&self, step: usize) -> bool {
        step == self.first
    }

    /// How far its slowest front travels in steps of `dt` (s) while it is imposed, m.
    pub fn imposed_over(&self, dt: f64) -> f64 {
        self.fronts.last().map_or(0.0, |front| front.speed * self.steps.saturating_sub(self.first) as f64 * dt)
    }

    /// Nodes get this impulse (N s in +x) from nobody at the end of this step. Returns what somebody has to give now: as it ends, all of it.
    pub fn owe(&mut self, step: usize, impulse: f64) -> f64 {
        self.owed += impulse;
        if self.ends_at(step) { std::mem::take(&mut self.owed) } else { 0.0 }
    }

    /// This is the last step at the end of which it is imposed.
    pub fn ends_at(&self, step: usize) -> bool {
        step + 1 == self.steps
    }

    /// Mean velocity (m/s) and stress (Pa) at its origin over the step of `dt` (s) in which a gap closes, or a velocity jumps, and it starts.
    pub fn starts_within(&self, step: usize, dt: f64) -> Option<[f64; 2]> {
        let part = (step + 1) as f64 - self.from / dt;
        let (ahead, behind) = (self.fronts[0].ahead, [self.velocity_behind, self.stress]);
        let mean = [0, 1].map(|i| ahead[i] + part * (behind[i] - ahead[i]));
        (!self.by_wave && !self.grows() && self.from > 0.0 && self.begins_at(step) && self.first < self.steps)
            .then_some(mean)
    }

    /// The first step, this one or a later one, at the end of which one of these is imposed.
    pub fn next_step(fans: &[Self], step: usize) -> Option<usize> {
        fans.iter().filter(|fan| fan.is_imposed_from(step)).map(|fan| fan.first.max(step)).min()
    }

    /// How far its fronts, as spread over ramps, get within `time` (s) of its start, m.
    pub fn reach(&self, time: f64) -> f64 {
        self.reach_of(&self.fronts, time)
    }

    /// It is imposed on more than its origin: not where it is elastic and a wave starts it, which may come through its segment and change.
    pub fn is_imposed_inside(&self) -> bool {
        !(self.by_wave && self.stays_elastic())
    }

    /// How far it is imposed then. Where a wave starts it, up to its plastic fronts: that wave may change behind its own, and schemes follow elastic fronts by
    /// themselves. 0 where there is none.
    pub fn imposed_reach(&self, time: f64) -> f64 {
        self.reach_of(self.fronts.iter().filter(|front| !(self.by_wave && front.elastic)), time)
    }

    fn reach_of<'a>(&self, fronts: impl IntoIterator<Item = &'a Front>, time: f64) -> f64 {
        let spread = |front: &Front| if front.elastic { 0.0 } else { 0.5 * self.ramp };
        let front = |front: &Front| front.speed * (time - front.delay).max(0.0) + spread(front);
        fronts.into_iter().map(front).fold(0.0, f64::max)
    }

    /// +1 where it runs in +x, -1 in -x.
    pub fn direction(&self) -> f64 {
        if self.side == 0 { 1.0 } else { -1.0 }
    }

    /// Velocity (m/s) at its origin over the step from `time` (s) on, counted from its start.
    pub fn velocity_at_origin(&self, time: f64, dt: f64) -> f64 {
        if self.grows() {
            self.means(0.0, time, dt)[0]
        } else {
            self.velocity_behind - self.lost(0.0, time + 0.5 * dt)[0]
        }
    }

    /// Stress at its origin at a time, Pa: behind its fronts that have left, less what the bar is unloaded there.
    pub fn stress_at_origin(&self, time: f64, dt: f64) -> f64 {
        let from = (time - 0.5 * dt).max(0.0);
        if self.grows() {
            self.means(0.0, from, time + 0.5 * dt - from)[1]
        } else {
            self.stress + self.lost(0.0, time)[1]
        }
    }

    /// The same of a fan from t = 0, each front of which leaves within a step: the stress at the end of a step, without what leaves beside it.
    pub fn stress_of_departed(&self, time: f64) -> f64 {
        let left = self.fronts.partition_point(|front| front.delay < time);
        self.fronts.get(left).map_or(self.stress, |front| front.ahead[1]) + self.lost(0.0, time)[1]
    }

    /// What the bar has lost at a time (s after its start) at a distance (m): velocity, m/s in +x, and what that adds to the stress, Pa.
    fn lost(&self, distance: f64, time: f64) -> [f64; 2] {
        let [velocity, stress] = self.unloading.as_ref().map_or([0.0; 2], |unloading| unloading.lost(distance, time));
        [velocity, self.direction() * self.impedance * stress]
    }

    /// How its end answers at a time, s after its start: the stress (Pa) of an end that moves with [`Self::velocity_behind`], and by how much it
    /// falls in size with the velocity, Pa s/m.
    pub fn answer(&self, time: f64) -> [f64; 2] {
        let Some(unloading) = &self.unloading else { return [self.stress, self.slow_impedance] };
        let [factor, summand] = unloading.stress_for_velocity(time);
        [self.stress + self.direction() * self.impedance * summand, factor * self.impedance]
    }

    /// Its end moves with this velocity (m/s) at a time (s after its start) in this step.
    pub fn lose(&mut self, step: usize, time: f64, velocity: f64) {
        self.note_lost(step, time, self.loss(self.velocity_behind - velocity));
    }

    /// Its end has lost this velocity (m/s) at a time (s after its start) in this step.
    fn note_lost(&mut self, step: usize, time: f64, velocity: f64) {
        if let Some(unloading) = &mut self.unloading {
            unloading.note_velocity(time, velocity);
        }
        self.end_before_it_yields(step, time);
    }

    /// The wave that starts both fans of its joint changes behind its front.
    pub fn follows_wave(&self) -> bool {
        self.at_joint && self.by_wave && self.unloading.is_some()
    }

    /// None of its fronts is plastic.
    pub fn stays_elastic(&self) -> bool {
        self.fronts.iter().all(|front| front.elastic)
    }

    /// Stress (Pa) of the waves that come to its origin, where the bar has this stress (Pa) and velocity (m/s).
    fn arriving(&self, [stress, velocity]: [f64; 2]) -> f64 {
        0.5 * (stress + self.direction() * self.impedance * velocity)
    }

    /// Takes both fans of a joint, that of the left side first, on to the step from `time` (s after their start) on, as far as the wave that starts them has changed.
    /// It comes through the one that stays elastic: `beside` are its stress (Pa) and velocity (m/s) at the joint on both sides. Sections in m^2.
    pub fn follow_wave(
        fans: [&mut Self; 2],
        step: usize,
        [time, dt]: [f64; 2],
        beside: [[f64; 2]; 2],
        areas: [f64; 2],
    ) {
        let through = usize::from(!fans[0].stays_elastic());
        let (elastic, plastic, areas) = (&fans[through], &fans[1 - through], [areas[through], areas[1 - through]]);
        let middle = time + 0.5 * dt;
        let (inward, behind) = (plastic.direction(), plastic.velocity_behind);
        let [stress, impedance] = plastic.answer(middle);
        // Both have one force: twice that of the wave less what moves along, and what is behind the plastic fronts.
        let force =
            areas[1] * (stress + inward * impedance * behind) - 2.0 * areas[0] * elastic.arriving(beside[through]);
        let velocity = inward * force / (areas[1] * impedance + areas[0] * elastic.impedance);
        let lost = plastic.loss(behind - velocity);
        for fan in fans {
            fan.note_lost(step, middle, lost);
        }
    }

    /// A loss of velocity (m/s) or none: what rounding adds is no loss.
    fn loss(&self, lost: f64) -> f64 {
        let jump = self.velocity_behind - self.velocity_ahead();
        if lost * jump > ROUND_OFF * jump * jump { lost } else { 0.0 }
    }

    /// Its end carries this stress (Pa) at a time (s after its start) in this step.
    pub fn carry(&mut self, step: usize, time: f64, stress: f64) {
        let lost = self.loss(self.direction() * (stress - self.stress) / self.impedance);
        if let Some(unloading) = &mut self.unloading {
            unloading.note_stress(time, lost);
        }
        self.end_before_it_yields(step, time);
    }

    /// It ends with this step as soon as its end has lost most of the stress after which the bar yields the other way.
    fn end_before_it_yields(&mut self, step: usize, time: f64) {
        if !self.stays_elastic() && self.lost(0.0, time)[1].abs() > MOST_LOST * self.yields_after {
            self.end_after(step);
        }
    }

    /// Velocity (m/s, in +x) that its end has lost at a time, s after its start.
    pub fn slowed(&self, time: f64) -> f64 {
        self.lost(0.0, time)[0]
    }

    /// Mean velocity (m/s) and stress (Pa) over the step from `time` on, counted from its start, at `distance` (m) from where it starts.
    pub fn means(&self, distance: f64, time: f64, dt: f64) -> [f64; 2] {
        let (mut fronts, mut behind) = (&self.fronts[..], [self.velocity_behind, self.stress]);
        let [slowed, unloaded] = self.lost(distance, time + 0.5 * dt);
        if slowed != 0.0 {
            // The unloading waves that come after the fan take its slowest fronts away.
            behind = [behind[0] - slowed, behind[1] + unloaded];
            let is_left = |front: &Front| (behind[0] - front.ahead[0]) * slowed > 0.0;
            fronts = &fronts[..fronts.partition_point(is_left).max(1)];
        }
        self.through(fronts, behind, distance, time, dt)
    }

    /// The same of the first of its fronts, with the state `behind` the last of these.
    fn through(&self, fronts: &[Front], behind: [f64; 2], distance: f64, time: f64, dt: f64) -> [f64; 2] {
        // No front is felt in the first step, in which nodes are at rest.
        let half_ramp = |speed: f64| (0.5 * self.ramp).min(distance - speed * dt).max(0.0);
        // Fronts that have passed before the step count in full, those that arrive after it not at all.
        let gone = |front: &Front, time: f64| front.speed * (time - front.delay);
        let passed = fronts.partition_point(|front| gone(front, time) >= distance + half_ramp(front.speed));
        let arrives = |front: &&Front| gone(front, time + dt) > distance - half_ramp(front.speed);
        let ahead = |k: usize| fronts.get(k).map_or(behind, |front| front.ahead);
        let mut means = ahead(passed);
        for (k, &Front { speed, elastic, delay, .. }) in (passed..).zip(fronts[passed..].iter().take_while(arrives)) {
            let arrival = delay + distance / speed;
            let width = if elastic { 0.0 } else { 2.0 * half_ramp(speed) / speed };
            let share = (ramped(time + dt - arrival, width) - ramped(time - arrival, width)) / dt;
            let (before, after) = (ahead(k), ahead(k + 1));
            means = [0, 1].map(|i| means[i] + (after[i] - before[i]) * share);
        }
        means
    }
}

/// The fronts of a fan, the fastest first, where elastic waves have this speed (m/s).
fn fronts(initial_fan: &InitialFan, wave_speed: f64) -> Vec<Front> {
    let mut ahead = [initial_fan.velocity_ahead, initial_fan.stress_ahead()];
    let delays = initial_fan.delays.iter().copied().chain(std::iter::repeat(0.0));
    let front = |(edge, delay): (&Edge, f64)| {
        let rise = initial_fan.sense.sign() * (edge.stress_behind - edge.stress_ahead);
        let jump = -initial_fan.direction * initial_fan.sense.sign() * edge.velocity_jump();
        let front = Front { speed: edge.speed, elastic: edge.is_elastic(wave_speed), ahead, delay };
        ahead = [ahead[0] + jump, ahead[1] + rise];
        front
    };
    initial_fan.fan.edges.iter().zip(delays).map(front).collect()
}

/// Speeds of fronts (m/s), when they leave the end (s), and the velocities that they bring (m/s), the slowest first.
fn brought(fronts: &[Front], velocity_behind: f64) -> Vec<[f64; 3]> {
    let mut behind = velocity_behind;
    let mut brings = |front: &Front| std::mem::replace(&mut behind, front.ahead[0]) - front.ahead[0];
    fronts.iter().rev().map(|front| [front.speed, front.delay, brings(front)]).collect()
}

/// Integral up to `t` (s) of a front of height 1 that passes at 0 and rises over `width` (s), by a polynomial without kinks in slope and
/// curvature: from those a scheme would ring.
fn ramped(t: f64, width: f64) -> f64 {
    if t >= 0.5 * width {
        t
    } else if t <= -0.5 * width {
        0.0
    } else {
        let s = t / width + 0.5;
        width * s.powi(4) * (2.5 + s * (s - 3.0))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::material::{Beyond, Curve, Sense};
    use crate::wave::similarity::fan_at_velocity;

    const DENSITY: f64 = 7850.0;
    const MODULUS: f64 = 200e9;
    const GRID: Resolution = Resolution { dx: 1e-3, cells: 200, dt: 1.9e-7, wave_speed: 5047.5 };

    /// Of a bilinear bar whose left end suddenly moves with 30 m/s.
    fn starting(driver: Driver, ramp: f64) -> StartingFan {
        let curve = Curve::new(&[(0.0, 0.0), (1e-3, 200e6), (0.05, 1180e6)], Beyond::Extend).expect("a curve");
        let fan = fan_at_velocity(&curve, DENSITY, 30.0);
        let initial_fan = InitialFan {
            sudden: true,
            lessens_from: if driver == Driver::Body { 0.0 } else { f64::INFINITY },
            driver,
            alone: true,
            ..InitialFan::steady((Origin::Left, 1.0), 0, (Sense::Compression, &curve), fan)
        };
        let wave_speed = (MODULUS / DENSITY).sqrt();
        StartingFan::new(&initial_fan, DENSITY, &Resolution { wave_speed, ..GRID }, ramp).expect("a fan")
    }

    /// Whatever they are spread over, fronts bring a place the displacement and the impulse of sharp ones.
    #[test]
    fn ramps_take_nothing() {
        let [sharp, spread] = [0.0, 7.0].map(|ramp| {
            let fan = starting(Driver::Velocity, ramp);
            let mut sums = [0.0; 2];
            for step in 0..60 {
                let means = fan.means(5.0 * GRID.dx, f64::from(step) * GRID.dt, GRID.dt);
                sums = [0, 1].map(|k| sums[k] + means[k]);
            }
            sums
        });
        for k in [0, 1] {
            assert!((sharp[k] / spread[k] - 1.0).abs() < 1e-12, "{sharp:?} {spread:?}");
        }
    }

    /// At the slowest front the unloading that a body sends lies on the chord of the front, and inside it keeps momentum.
    #[test]
    fn unloading_waves_fit_the_front_and_the_body() {
        let mut fan = starting(Driver::Body, 0.0);
        for step in 0..=60 {
            let elapsed = (f64::from(step) + 0.5) * GRID.dt;
            fan.lose(0, elapsed, fan.velocity_behind - 0.1 * elapsed / (60.5 * GRID.dt));
        }
        let (time, slowest) = (60.0 * GRID.dt, fan.fronts[1].speed);
        let elapsed = time + 0.5 * GRID.dt;
        let lost = |distance: f64| {
            let [velocity, stress] = fan.means(distance, time, GRID.dt);
            [fan.velocity_behind - velocity, stress - fan.stress]
        };
        let [velocity, stress] = lost(slowest * time * (1.0 - 1e-9));
        assert!((stress / (DENSITY * slowest * velocity) - 1.0).abs() < 0.02, "{stress} {velocity}");
        let [near, far] = [1.0, 3.0].map(|cells| lost(cells * GRID.dx)[1]);
        let gradient = DENSITY * 0.1 / elapsed * 2.0 * GRID.dx;
        assert!(((near - far) / gradient - 1.0).abs() < 1e-9, "{near} {far} {gradient}");
    }
}
