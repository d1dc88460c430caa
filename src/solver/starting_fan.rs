//! The centred fan of an end or joint that is suddenly loaded, as grid schemes impose it in the first steps; see [`crate::wave::similarity`].

use serde::{Deserialize, Serialize};

use super::unloading::Unloading;
use crate::bar::{Driver, InitialFan, Origin, START_CELLS};
use crate::wave::similarity::Edge;

/// Relative difference (of their velocity jumps) up to which the velocities of the two sides of a joint count as equal.
const TOGETHER: f64 = 1e-9;

/// Relative difference up to which two positions count as the same.
const SAME_PLACE: f64 = 1e-9;

/// Velocity losses below this fraction of the velocity jump count as rounding.
const ROUND_OFF: f64 = 1e-12;

/// Largest relative error of the peak stress in a cell that is unloaded while a front spread over a ramp still passes it, and least number of cells
/// over which fronts are spread. The ramps of decaying loads are shortened accordingly. In annealed copper pulled at a velocity that rises and falls
/// in 50 us each (200 cells), the force is wrong by 10 % with ramps of 7 cells and by 5 % with 1 cell.
const BELOW: f64 = 0.01;
const LEAST_RAMP: f64 = 1.0;

/// A fan ends once its end has lost this fraction of the stress drop after which the bar behind it yields in the opposite sense.
const MOST_LOST: f64 = 0.9;

/// A front of a fan.
#[derive(Debug, Clone, Copy, Serialize, Deserialize)]
struct Front {
    /// Speed, m/s.
    speed: f64,
    /// Whether it is elastic. Elastic fronts stay sharp: the schemes are exact for them.
    elastic: bool,
    /// Velocity (m/s, in +x) and stress (Pa, tension positive) ahead of the front.
    ahead: [f64; 2],
    /// Time at which the front leaves the origin, s after the start of the fan.
    delay: f64,
}

/// Resolution of a segment on a grid.
#[derive(Debug, Clone, Copy)]
pub struct Resolution {
    /// Cell size, m.
    pub dx: f64,
    /// Number of cells.
    pub cells: usize,
    /// Time step, s.
    pub dt: f64,
    /// Elastic wave speed, m/s.
    pub wave_speed: f64,
}

/// The fan of an end or of one side of a joint.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct StartingFan {
    /// Side of the segment at which the fan starts: 0 is left, 1 is right.
    pub side: usize,
    /// Whether the fan starts at a joint.
    pub at_joint: bool,
    /// Quantity or body that drives the fan.
    pub driver: Driver,
    /// Waves that unload the bar behind the fan; `None` if the load does not decay.
    unloading: Option<Unloading>,
    /// Decrease of stress at which the bar behind the fan yields in the opposite sense, Pa.
    yields_after: f64,
    /// Displacement of the end at the start of the fan (0 unless a stress drives it) minus the displacement lost to unloading since then, m.
    pub placed: f64,
    /// Impulse (N s, in +x) that the imposed motion has given to nodes and that the scheme still has to take back: at a joint from both sides, at an
    /// end with a prescribed stress or a ball from the nodes near it.
    pub unbalanced_impulse: f64,
    /// Whether only the node at the origin follows the fan.
    pub only_origin: bool,
    /// Index of the segment. The fan does not leave it while it is imposed.
    pub segment: usize,
    /// Fronts, fastest first.
    fronts: Vec<Front>,
    /// Velocity of the end or joint behind the fan, m/s.
    pub velocity_behind: f64,
    /// Stress behind the fan, Pa, tension positive.
    pub stress: f64,
    /// Impedance of the unloading waves, and ratio of stress to velocity change at the origin if the velocity changes steadily, so that unloading
    /// waves and their reflections from the slowest front act together, Pa s/m.
    impedance: f64,
    slow_impedance: f64,
    /// Length over which plastic fronts are spread as ramps, m.
    ramp: f64,
    /// Start time, s.
    pub from: f64,
    /// Whether a wave from elsewhere in the bar starts the fan.
    by_wave: bool,
    /// First step at the end of which the fan is imposed, step from which on it is no longer imposed, and step from which on it is no longer known.
    first: usize,
    steps: usize,
    known: usize,
    /// Number of nodes from the origin that the fan may set. It excludes nodes set by a fan from the far side and nodes that another wave reaches
    /// meanwhile.
    pub nodes: usize,
}

/// Number of nodes from the origin that a growing fan sets. Farther in, its fronts are so far apart that a scheme takes them over as they are.
const GROWING_NODES: usize = 64;

impl StartingFan {
    /// Creates the fan for a grid of its segment with this density (kg/m^3); plastic fronts are spread over at most `ramp` cells. Returns `None` if
    /// the fan leaves the bar elastic (except on a side of a joint), if it is above critical or beyond the data, or if its slowest front does not
    /// travel.
    pub fn new(initial_fan: &InitialFan, density: f64, grid: &Resolution, ramp: f64) -> Option<Self> {
        let &Resolution { dx, cells, dt, wave_speed } = grid;
        let fan = &initial_fan.fan;
        let [stress, velocity_behind] = initial_fan.state_behind()?;
        let at_joint = matches!(initial_fan.origin, Origin::Joint(_));
        let elastic = |edge: &Edge| edge.is_elastic(wave_speed);
        // An elastic side of a joint is kept because it belongs to the plastic fan of the other side.
        fan.edges.last().filter(|edge| (at_joint || !elastic(edge)) && edge.speed > 0.0)?;
        let followed = initial_fan.followed_for(dx, wave_speed);
        let wanted = (followed / dt).ceil();
        let possible = (initial_fan.known_until(dx * cells as f64) / dt).floor() - 1.0;
        let until_other_fans = if initial_fan.alone { cells } else { (cells - 1) / 2 };
        // The margin removes rounding, so that a bar and its mirror image get the same number of nodes.
        let uniform = (initial_fan.uniform_for / dx * (1.0 + SAME_PLACE)) as usize;
        let near = if initial_fan.delays.is_empty() { cells } else { GROWING_NODES };
        // A wave that starts a fan arrives at the end of a whole step. The step within which a gap closes is part of the fan.
        let (started, by_wave) = (initial_fan.from / dt, initial_fan.wave_through.is_some());
        let first = if by_wave { started.round() } else { started.floor() };
        let fronts = fronts(initial_fan, wave_speed);
        let unloading_speed = initial_fan.unloading_speed(wave_speed);
        let brought = brought(&fronts, velocity_behind);
        Some(Self {
            side: usize::from(initial_fan.direction < 0.0),
            at_joint,
            driver: initial_fan.driver,
            unloading: initial_fan.decays().then(|| Unloading::new(unloading_speed, brought)),
            yields_after: initial_fan.yields_after,
            placed: 0.0,
            unbalanced_impulse: 0.0,
            only_origin: false,
            segment: initial_fan.segment,
            fronts,
            velocity_behind,
            stress,
            impedance: density * unloading_speed,
            slow_impedance: density * initial_fan.slowing(wave_speed),
            ramp: dx * ramp.min((2.0 * START_CELLS * BELOW / initial_fan.fraction_lost(followed)).max(LEAST_RAMP)),
            from: initial_fan.from,
            by_wave,
            first: first as usize,
            steps: (first + wanted.min(possible).max(0.0)) as usize,
            known: (first + possible.max(0.0)) as usize,
            nodes: until_other_fans.min(uniform).min(near),
        })
    }

    /// Makes both fans of each joint last equally long: as long as either needs, if both are known so far. Removes both if one is missing or if the
    /// sides separate.
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
            // The sides separate where a level curve carries no more.
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

    /// Returns whether the fronts leave the origin one after another.
    pub fn grows(&self) -> bool {
        self.grows_at(0.0)
    }

    /// Returns whether some fronts leave the origin later than `time` (s) after the start.
    pub fn grows_at(&self, time: f64) -> bool {
        self.fronts.last().is_some_and(|front| front.delay > time.max(0.0))
    }

    /// Returns the displacement of the origin `time` (s) after the start, m. Before the start (negative times) it moves with the bar ahead.
    pub fn moved(&self, time: f64) -> f64 {
        if !self.grows() {
            return if time < 0.0 { self.velocity_ahead() } else { self.velocity_behind } * time;
        }
        let behind = self.fronts.iter().skip(1).map(|front| front.ahead[0]).chain([self.velocity_behind]);
        let since = |(front, behind): (&Front, f64)| (behind - front.ahead[0]) * (time - front.delay).max(0.0);
        self.velocity_ahead() * time + self.fronts.iter().zip(behind).map(since).sum::<f64>()
    }

    /// Velocity of the bar ahead of the fan, m/s.
    fn velocity_ahead(&self) -> f64 {
        self.fronts[0].ahead[0]
    }

    /// Returns whether the fan is imposed at the end of this step.
    pub fn is_imposed_at(&self, step: usize) -> bool {
        (self.first..self.steps).contains(&step)
    }

    /// Returns whether the fan is imposed at the end of this step or of a later one.
    pub fn is_imposed_from(&self, step: usize) -> bool {
        step < self.steps && self.first < self.steps
    }

    /// Makes this step the last one at the end of which the fan is imposed.
    pub fn end_after(&mut self, step: usize) {
        self.steps = self.steps.min(step + 1);
    }

    /// Returns whether this is the first step at the end of which the fan is imposed.
    pub fn begins_at(&self, step: usize) -> bool {
        step == self.first
    }

    /// Distance that the slowest front travels while the fan is imposed in steps of `dt` (s), m.
    pub fn imposed_over(&self, dt: f64) -> f64 {
        self.fronts.last().map_or(0.0, |front| front.speed * self.steps.saturating_sub(self.first) as f64 * dt)
    }

    /// Adds an impulse (N s, in +x) that nodes get at the end of this step without a source. Returns the impulse to be taken back: the whole sum in
    /// the last step of the fan, else 0.
    pub fn add_unbalanced_impulse(&mut self, step: usize, impulse: f64) -> f64 {
        self.unbalanced_impulse += impulse;
        if self.ends_at(step) { std::mem::take(&mut self.unbalanced_impulse) } else { 0.0 }
    }

    /// Returns whether this is the last step at the end of which the fan is imposed.
    pub fn ends_at(&self, step: usize) -> bool {
        step + 1 == self.steps
    }

    /// Returns mean velocity (m/s) and stress (Pa) at the origin over the step of `dt` (s) within which a gap closes or a velocity jumps and the fan
    /// starts. `None` in all other steps, and for fans that start at t = 0, that grow, or that a wave starts.
    pub fn starts_within(&self, step: usize, dt: f64) -> Option<[f64; 2]> {
        let part = (step + 1) as f64 - self.from / dt;
        let (ahead, behind) = (self.fronts[0].ahead, [self.velocity_behind, self.stress]);
        let mean = [0, 1].map(|i| ahead[i] + part * (behind[i] - ahead[i]));
        (!self.by_wave && !self.grows() && self.from > 0.0 && self.begins_at(step) && self.first < self.steps)
            .then_some(mean)
    }

    /// Returns the first step, from `step` on, at the end of which one of these fans is imposed.
    pub fn next_step(fans: &[Self], step: usize) -> Option<usize> {
        fans.iter().filter(|fan| fan.is_imposed_from(step)).map(|fan| fan.first.max(step)).min()
    }

    /// Distance that the fronts, including their ramps, have covered `time` (s) after the start, m.
    pub fn reach(&self, time: f64) -> f64 {
        self.reach_of(&self.fronts, time)
    }

    /// Returns whether the fan is imposed beyond its origin. It is not if it is elastic and started by a wave: that wave may come through its segment
    /// and change.
    pub fn is_imposed_inside(&self) -> bool {
        !(self.by_wave && self.stays_elastic())
    }

    /// Distance over which the fan is imposed `time` (s) after the start, m. If a wave starts the fan, only plastic fronts count: the wave may change
    /// behind its own front, and schemes follow elastic fronts by themselves. 0 if there are no such fronts.
    pub fn imposed_reach(&self, time: f64) -> f64 {
        self.reach_of(self.fronts.iter().filter(|front| !(self.by_wave && front.elastic)), time)
    }

    fn reach_of<'a>(&self, fronts: impl IntoIterator<Item = &'a Front>, time: f64) -> f64 {
        let spread = |front: &Front| if front.elastic { 0.0 } else { 0.5 * self.ramp };
        let front = |front: &Front| front.speed * (time - front.delay).max(0.0) + spread(front);
        fronts.into_iter().map(front).fold(0.0, f64::max)
    }

    /// Direction of travel: +1 in +x, -1 in -x.
    pub fn direction(&self) -> f64 {
        if self.side == 0 { 1.0 } else { -1.0 }
    }

    /// Mean velocity (m/s) at the origin over the step that begins `time` (s) after the start.
    pub fn velocity_at_origin(&self, time: f64, dt: f64) -> f64 {
        if self.grows() {
            self.means(0.0, time, dt)[0]
        } else {
            self.velocity_behind - self.lost(0.0, time + 0.5 * dt)[0]
        }
    }

    /// Stress (Pa) at the origin `time` (s) after the start: that behind the fronts that have left, reduced by the unloading of the bar.
    pub fn stress_at_origin(&self, time: f64, dt: f64) -> f64 {
        let from = (time - 0.5 * dt).max(0.0);
        if self.grows() {
            self.means(0.0, from, time + 0.5 * dt - from)[1]
        } else {
            self.stress + self.lost(0.0, time)[1]
        }
    }

    /// Same for a fan from t = 0 whose fronts each leave within one step: stress at the end of a step, not averaged over the fronts that leave around
    /// that time.
    pub fn stress_of_departed(&self, time: f64) -> f64 {
        let left = self.fronts.partition_point(|front| front.delay < time);
        self.fronts.get(left).map_or(self.stress, |front| front.ahead[1]) + self.lost(0.0, time)[1]
    }

    /// Returns the velocity (m/s, in +x) that the bar has lost at `distance` (m) and `time` (s after the start), and the resulting change of stress,
    /// Pa.
    fn lost(&self, distance: f64, time: f64) -> [f64; 2] {
        let [velocity, stress] = self.unloading.as_ref().map_or([0.0; 2], |unloading| unloading.lost(distance, time));
        [velocity, self.direction() * self.impedance * stress]
    }

    /// Response of the end `time` (s) after the start: stress (Pa) of an end that moves with [`Self::velocity_behind`], and decrease of its magnitude
    /// per velocity lost, Pa s/m.
    pub fn answer(&self, time: f64) -> [f64; 2] {
        let Some(unloading) = &self.unloading else { return [self.stress, self.slow_impedance] };
        let [factor, summand] = unloading.stress_for_velocity(time);
        [self.stress + self.direction() * self.impedance * summand, factor * self.impedance]
    }

    /// Records the velocity (m/s) of the end at `time` (s after the start) in this step.
    pub fn record_velocity(&mut self, step: usize, time: f64, velocity: f64) {
        self.record_lost_velocity(step, time, self.loss(self.velocity_behind - velocity));
    }

    /// Records the velocity (m/s) that the end has lost at `time` (s after the start) in this step.
    fn record_lost_velocity(&mut self, step: usize, time: f64, velocity: f64) {
        if let Some(unloading) = &mut self.unloading {
            unloading.record_velocity(time, velocity);
        }
        self.end_before_it_yields(step, time);
    }

    /// Returns whether the wave that starts both fans of the joint changes behind its front.
    pub fn follows_wave(&self) -> bool {
        self.at_joint && self.by_wave && self.unloading.is_some()
    }

    /// Returns whether none of the fronts is plastic.
    pub fn stays_elastic(&self) -> bool {
        self.fronts.iter().all(|front| front.elastic)
    }

    /// Stress (Pa) of the waves that arrive at the origin if the bar has this stress (Pa) and velocity (m/s) there.
    fn arriving(&self, [stress, velocity]: [f64; 2]) -> f64 {
        0.5 * (stress + self.direction() * self.impedance * velocity)
    }

    /// Updates both fans of a joint (left side first) for the change of the wave that starts them, in the step that begins `time` (s) after their
    /// start. The wave comes through the side that stays elastic. `beside` are stress (Pa) and velocity (m/s) at the joint on both sides, `areas` the
    /// sections in m^2.
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
        // Both sides carry the same force: on the elastic side that of the arriving wave, doubled, less what radiates back; on the other that behind
        // the plastic fronts.
        let force =
            areas[1] * (stress + inward * impedance * behind) - 2.0 * areas[0] * elastic.arriving(beside[through]);
        let velocity = inward * force / (areas[1] * impedance + areas[0] * elastic.impedance);
        let lost = plastic.loss(behind - velocity);
        for fan in fans {
            fan.record_lost_velocity(step, middle, lost);
        }
    }

    /// Returns a velocity loss (m/s), or 0 if it is a gain or within rounding.
    fn loss(&self, lost: f64) -> f64 {
        let jump = self.velocity_behind - self.velocity_ahead();
        if lost * jump > ROUND_OFF * jump * jump { lost } else { 0.0 }
    }

    /// Records the stress (Pa) of the end at `time` (s after the start) in this step.
    pub fn record_stress(&mut self, step: usize, time: f64, stress: f64) {
        let lost = self.loss(self.direction() * (stress - self.stress) / self.impedance);
        if let Some(unloading) = &mut self.unloading {
            unloading.record_stress(time, lost);
        }
        self.end_before_it_yields(step, time);
    }

    /// Ends the fan with this step once the end has lost most of the stress after which the bar yields in the opposite sense.
    fn end_before_it_yields(&mut self, step: usize, time: f64) {
        if !self.stays_elastic() && self.lost(0.0, time)[1].abs() > MOST_LOST * self.yields_after {
            self.end_after(step);
        }
    }

    /// Velocity (m/s, in +x) that the end has lost `time` (s) after the start.
    pub fn slowed(&self, time: f64) -> f64 {
        self.lost(0.0, time)[0]
    }

    /// Mean velocity (m/s) and stress (Pa) over the step that begins `time` (s) after the start, at `distance` (m) from the origin.
    pub fn means(&self, distance: f64, time: f64, dt: f64) -> [f64; 2] {
        let (mut fronts, mut behind) = (&self.fronts[..], [self.velocity_behind, self.stress]);
        let [slowed, unloaded] = self.lost(distance, time + 0.5 * dt);
        if slowed != 0.0 {
            // Unloading waves that follow the fan cancel its slowest fronts.
            behind = [behind[0] - slowed, behind[1] + unloaded];
            let is_left = |front: &Front| (behind[0] - front.ahead[0]) * slowed > 0.0;
            fronts = &fronts[..fronts.partition_point(is_left).max(1)];
        }
        self.through(fronts, behind, distance, time, dt)
    }

    /// Same for these leading fronts only, with the state `behind` the last of them.
    fn through(&self, fronts: &[Front], behind: [f64; 2], distance: f64, time: f64, dt: f64) -> [f64; 2] {
        // No front acts in the first step, in which nodes are at rest.
        let half_ramp = |speed: f64| (0.5 * self.ramp).min(distance - speed * dt).max(0.0);
        // Fronts that passed before the step count in full, those that arrive after it not at all.
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

/// Returns the fronts of a fan, fastest first, for this elastic wave speed (m/s).
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

/// Returns speed (m/s), departure time (s) and velocity jump (m/s) of every front, slowest first.
fn brought(fronts: &[Front], velocity_behind: f64) -> Vec<[f64; 3]> {
    let mut behind = velocity_behind;
    let mut brings = |front: &Front| std::mem::replace(&mut behind, front.ahead[0]) - front.ahead[0];
    fronts.iter().rev().map(|front| [front.speed, front.delay, brings(front)]).collect()
}

/// Integral up to `t` (s) of a front of height 1 that passes at 0 and rises over `width` (s). The polynomial has continuous slope and curvature:
/// kinks would make a scheme ring.
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

    /// Returns the fan of a bilinear bar whose left end suddenly moves at 30 m/s.
    fn starting(driver: Driver, ramp: f64) -> StartingFan {
        let curve = Curve::new(&[(0.0, 0.0), (1e-3, 200e6), (0.05, 1180e6)], Beyond::Extend).expect("a curve");
        let fan = fan_at_velocity(&curve, DENSITY, 30.0);
        let initial_fan = InitialFan {
            sudden: true,
            decays_from: if driver == Driver::Body { 0.0 } else { f64::INFINITY },
            driver,
            alone: true,
            ..InitialFan::steady((Origin::Left, 1.0), 0, (Sense::Compression, &curve), fan)
        };
        let wave_speed = (MODULUS / DENSITY).sqrt();
        StartingFan::new(&initial_fan, DENSITY, &Resolution { wave_speed, ..GRID }, ramp).expect("a fan")
    }

    /// Whatever the width of their ramps, fronts cause the same displacement and impulse at a position as sharp ones.
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

    /// At the slowest front, the unloading by a body lies on the chord of the front; inside the front it conserves momentum.
    #[test]
    fn unloading_waves_fit_the_front_and_the_body() {
        let mut fan = starting(Driver::Body, 0.0);
        for step in 0..=60 {
            let elapsed = (f64::from(step) + 0.5) * GRID.dt;
            fan.record_velocity(0, elapsed, fan.velocity_behind - 0.1 * elapsed / (60.5 * GRID.dt));
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
