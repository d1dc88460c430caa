//! Fans at ends and joints that a grid scheme follows: those at t = 0, and those that start when gaps close or waves arrive.

use super::front_tracking;
use crate::bar::{
    Bar, Driver, EndCondition, History, InitialFan, Joint, Origin, Segment, at_rising_load, at_spring, ball_waves,
    drives_at_start, first_change, same_section, same_state, spring_waves,
};
use crate::law::Table;
use crate::material::Sense;
use crate::scene::{HardeningRule, Scene};
use crate::solver::fd::{DistributedForces, Grid};
use crate::solver::moc::Settings;
use crate::wave::similarity::fan_at_velocity;

/// Largest time by which a wave may arrive before or after a whole step, and largest delay that the cells of a segment may have caused, in steps, for
/// the wave to be as sharp as a fan start requires. In leapfrog, a wave that is 0.04 steps late rings at a free end by 20 % of its stress; in the
/// Godunov scheme no wave rings.
pub(super) const LATE_IN_LEAPFROG: f64 = 1e-3;
pub(super) const LATE_IN_MUSCL: f64 = 0.05;

/// Fraction of the time for which a fan is followed in which it takes shape: its slowest front travels 3 cells. In random bars of up to three
/// segments (100 cells) the mean error of the largest end force is 0.7 % with this value, 0.8 % if fans shorter than 6 cells are left out, and no
/// smaller with 2 cells. Where waves met a fan of 22 cells, the joint force was 27 % too large in the first step without the fan and correct with it.
const SHAPED: f64 = 0.125;

/// Event budget of the front tracking that looks for fans: some milliseconds of computing time.
const EVENTS: u64 = 5000;

/// Step into which that front tracking divides loads that grow or decay, as a fraction of the largest stress. Such loads start no fans, but jumps may
/// follow them, and finer steps would use up the events before these.
const STEP: f64 = 0.01;

/// Step with which it is repeated if the events are used up with [`STEP`]: the pulse of a light striker then crosses the bar.
const COARSE_STEP: f64 = 0.1;

/// Fraction of the time in which a wave crosses half a segment up to which that front tracking runs for the fans at t = 0.
const HARDLY_STARTED: f64 = 0.1;

/// Resolution of times within a step. Finer differences are rounding and would make a bar and its mirror image differ.
const TIMES_IN_STEP: f64 = (1_u64 << 36) as f64;

/// Longest rise of a load that gets a fan, in time steps. Without a fan, a stress that rises in 150 steps overshoots by 0.7 % of the strain of a
/// bilinear bar, and a velocity that does so by 1.2 % in aluminium; a stress that rises in 265 steps along a power law and falls again leaves 13 %
/// too little strain in the first cell.
const MOST_STEPS: f64 = 2000.0;

/// Longest rise of a wave that grids disperse like a sharp one, in time steps.
const SHARP_STEPS: f64 = 3.0;

/// Returns whether a load rises within so few steps of `dt` (s) that its waves are sharp.
pub(super) fn rise_within_steps(scene: &Scene, dt: f64) -> bool {
    let mut histories = [&scene.left, &scene.right].into_iter().filter_map(EndCondition::history);
    histories.any(|history| !history.rises(SHARP_STEPS * dt).is_empty())
}

/// Returns the fans that front tracking finds in a scene up to `until` (s). Loads that rise within [`MOST_STEPS`] steps of `dt` (s) count as jumps.
pub(super) fn tracked(scene: &Scene, dt: f64, until: f64) -> Vec<InitialFan> {
    let rises = Rises::new(scene, dt);
    let at_once = |origin: Origin, time: f64| {
        rises.until(origin, time).is_none() && (time == 0.0 || can_close(scene, origin) || jumps(scene, origin, time))
    };
    let follow = |scene: &Scene, step: f64| {
        let settings =
            Settings { event_budget: EVENTS, front_segments: true, ramp_step: Some(step), ..Settings::default() };
        front_tracking(scene, settings).later_fans(until, at_once)
    };
    let jumping = jumping(scene, dt);
    let (mut fans, known_until) = follow(&jumping, STEP);
    if let Some(holding) = holding(&jumping) {
        if known_until < until {
            let later = follow(&jumping, COARSE_STEP).0;
            fans.extend(later.into_iter().filter(|fan| fan.from > known_until));
        }
        let held = follow(&holding, STEP).0;
        hold(&mut fans, &held, &jumping);
    }
    fans
}

/// Returns whether both fans start at the same end or joint at the same time.
fn together(a: &InitialFan, b: &InitialFan) -> bool {
    a.origin == b.origin && a.from == b.from
}

/// Extends the fans to the time for which they would hold if no load decayed, as the `held` fans do. If the load of a fan itself decays, the
/// unloading behind the fan is known, see [`crate::solver::unloading`]; if the first wave of a decaying load starts the fan, the decay hardly changes
/// it for some time.
fn hold(fans: &mut Vec<InitialFan>, held: &[InitialFan], scene: &Scene) {
    let held: Vec<InitialFan> =
        held.chunk_by(together).flat_map(|fans| fans.iter().map(|fan| under_wave(fan, fans, scene))).collect();
    let same = |a: &InitialFan, b: &InitialFan| {
        a.origin == b.origin && a.segment == b.segment && (a.from - b.from).abs() <= SAME_TIME * a.from
    };
    // On a grid, the wave of a decaying load loses its front before it closes a gap, earlier than in the exact solution.
    let steady = steady_for(scene, STEADY);
    for fan in fans.iter_mut().filter(|fan| fan.wave_through.is_none() && fan.waves_before > 0) {
        fan.holds_until = fan.holds_until.min(steady);
    }
    for held in held {
        let found = fans.iter_mut().find(|fan| same(fan, &held));
        if held.wave_through.is_none() {
            if let Some(fan) = found.filter(|fan| fan.waves_before == 0) {
                fan.holds_until = held.holds_until;
            }
        } else if held.waves_before == 0 {
            match found {
                Some(fan) if fan.holds_until >= held.holds_until => {}
                Some(fan) => *fan = held,
                None => fans.push(held),
            }
        }
    }
    fans.sort_by(|a, b| a.from.total_cmp(&b.from));
}

/// Returns one of the `fans` of an end or joint as the first wave of a load starts it that may decay. If the wave comes to a joint through a segment
/// that stays elastic, the fan can follow its changes; elsewhere the wave has to stay nearly constant.
fn under_wave(fan: &InitialFan, fans: &[InitialFan], scene: &Scene) -> InitialFan {
    let c0 = |fan: &InitialFan| scene.bar.segments[fan.segment].material.c0();
    if fan.wave_through.is_none() || fan.waves_before > 0 {
        return fan.clone();
    }
    let largest = |of: &dyn Fn(&InitialFan) -> f64| fans.iter().map(of).fold(0.0, f64::max);
    let is_seen = fans.iter().any(|fan| fan.wave_through == Some(fan.segment) && is_elastic(fan, &scene.bar));
    if is_seen {
        let part = largest(&|fan| fan.can_lose(c0(fan)));
        return fan.clone().fading(part, steady_for(scene, part));
    }
    let steady = steady_for(scene, STEADY.min(STEADY_PLASTIC * largest(&|fan| fan.plastic_part(c0(fan)))));
    InitialFan { holds_until: fan.holds_until.min(steady), ..fan.clone() }
}

/// Largest relative change of the stress of the wave that starts a fan while the fan is followed. Steel under a striker had 19 % too much strain
/// without the fan; its wave changes by 5 % over 6 cells.
const STEADY: f64 = 0.05;

/// Same relative to the part of the wave beyond yield. At a fixed end, where the stress falls by twice as much, the elongation of a plastic zone that
/// ends where all of that part is lost is too large by the square of twice this value: 4 %.
const STEADY_PLASTIC: f64 = 0.1;

/// Time for which the first waves of loads that have begun lose at most the fraction `change` of their stress, s.
fn steady_for(scene: &Scene, change: f64) -> f64 {
    let bar = &scene.bar;
    let last = bar.segments.len() - 1;
    let of_end = |(end, segment, side): (&EndCondition, usize, usize)| {
        LoadedEnd { at: &bar.segments[segment], side, is_fresh: !bar.has_initial_state() }.steady_under(end, change)
    };
    [(&scene.left, 0, 0), (&scene.right, last, 1)].into_iter().map(of_end).fold(f64::INFINITY, f64::min)
}

/// An end of the bar with its segment.
struct LoadedEnd<'a> {
    at: &'a Segment,
    side: usize,
    /// Whether the bar has no initial stress and has not yielded.
    is_fresh: bool,
}

impl LoadedEnd<'_> {
    /// Time for which the first wave of the load at this end loses at most the fraction `change` of its stress, s.
    fn steady_under(&self, end: &EndCondition, change: f64) -> f64 {
        let at = self.at;
        let needed = |stress: f64, sense: Sense| (1.0 - change) * self.arrives(stress, sense);
        let inward = [1.0, -1.0][self.side];
        let impedance = at.material.impedance();
        let behind = |jump: f64| {
            let sense = Sense::of(-inward * jump);
            (fan_at_velocity(at.material.branch(sense), at.material.density, jump.abs()).stress, sense)
        };
        let holds = |history: &History, rest: f64, allowed: &dyn Fn(f64) -> f64| {
            let begins = history.begins(rest);
            let value = history.at(begins);
            history.stays_near(begins, value, allowed(value)) - begins
        };
        match end {
            EndCondition::Velocity { history, .. } => holds(history, at.velocity, &|velocity| {
                let (stress, sense) = behind(velocity - at.velocity);
                (stress - needed(stress, sense)) / impedance
            }),
            EndCondition::Stress { history } => {
                holds(history, 0.0, &|stress| stress.abs() - needed(stress.abs(), Sense::of(stress)))
            }
            EndCondition::Striker { mass, velocity } => {
                let (stress, sense) = behind(velocity - at.velocity);
                mass / (impedance * at.end_areas()[self.side]) * (stress / needed(stress, sense)).ln()
            }
            _ => f64::INFINITY,
        }
    }

    /// Stress (Pa) of the first wave of a load with this stress (Pa). A load beyond yield sends the yield stress: as long as there are plastic fronts
    /// behind that wave, they absorb the unloading.
    fn arrives(&self, stress: f64, sense: Sense) -> f64 {
        let yields = if self.is_fresh { super::yield_stress(&self.at.material, sense) } else { f64::INFINITY };
        stress.min(yields)
    }
}

/// Factor on the mass of a striker that makes it so heavy that the bar does not slow it down.
const NEVER_SLOWED: f64 = 1e6;

/// Returns the scene with all loads held constant where they would decay; `None` if no load decays.
fn holding(scene: &Scene) -> Option<Scene> {
    let (mut held, last) = (scene.clone(), scene.bar.segments.len() - 1);
    for (end, segment) in [(&mut held.parts.left, 0), (&mut held.parts.right, last)] {
        match end {
            EndCondition::Velocity { history, .. } => *history = history.holding(scene.bar.segments[segment].velocity),
            EndCondition::Stress { history } => *history = history.holding(0.0),
            EndCondition::Striker { mass, .. } => *mass *= NEVER_SLOWED,
            _ => {}
        }
    }
    let changes = |end: &EndCondition, held: &EndCondition| {
        matches!(end, EndCondition::Striker { .. }) || end.history() != held.history()
    };
    (changes(&scene.left, &held.left) || changes(&scene.right, &held.right)).then_some(held)
}

/// Returns the scene with loads that jump at the start of every rise within [`MOST_STEPS`] steps of `dt`, s.
fn jumping(scene: &Scene, dt: f64) -> Scene {
    let mut scene = scene.clone();
    for end in [&mut scene.parts.left, &mut scene.parts.right] {
        if let EndCondition::Velocity { history, .. } | EndCondition::Stress { history } = end {
            *history = history.jumping(&history.rises(MOST_STEPS * dt));
        }
    }
    scene
}

/// Rises of the loads of the left and the right end within [`MOST_STEPS`] time steps: start and end times, s.
struct Rises([Vec<[f64; 2]>; 2]);

impl Rises {
    fn new(scene: &Scene, dt: f64) -> Self {
        let of_end = |end: &EndCondition| end.history().map_or_else(Vec::new, |history| history.rises(MOST_STEPS * dt));
        Self([of_end(&scene.left), of_end(&scene.right)])
    }

    /// Returns the end time (s) of the rise that begins at `time` (s) at this end; `None` for joints and if no rise begins then.
    fn until(&self, origin: Origin, time: f64) -> Option<f64> {
        let rises = match origin {
            Origin::Left => &self.0[0],
            Origin::Right => &self.0[1],
            Origin::Joint(_) => return None,
        };
        rises.iter().find(|[from, _]| (from - time).abs() <= time * SAME_TIME).map(|[_, until]| *until)
    }
}

/// Returns the `first` fans and those of the `later` ones (given in order of time) that the grid can resolve as sharply.
pub(super) fn with_later(
    mut first: Vec<InitialFan>,
    later: &[InitialFan],
    scene: &Scene,
    (grid, late): (&Grid, f64),
) -> Vec<InitialFan> {
    // Where a load has started without its fan, the first cells are not in the state that front tracking assumes for later fans.
    let mut missed = Vec::new();
    let rises = Rises::new(scene, grid.dt);
    for fans in later.chunk_by(together) {
        let here = |fan: &InitialFan| fan.origin == fans[0].origin;
        if missed.contains(&fans[0].origin) {
            continue;
        }
        let rises_until = rises.until(fans[0].origin, fans[0].from);
        let follows = match rises_until {
            Some(until) => rising(fans, until, scene, grid, late),
            None if fans[0].from == 0.0 => at_start(fans, scene),
            None => after_start(fans, scene, grid, late),
        };
        let Some(fans) = follows else {
            if !is_ramp(scene, &fans[0]) {
                missed.push(fans[0].origin);
                first.extend(at_first_moment(fans, scene, grid, late));
            }
            continue;
        };
        let gone = |fan: &InitialFan| {
            let lasts = takes_shape(fan, scene, grid).min(fan.holds_until);
            // The first value of a load that rises starts a fan that is part of the fan of the whole rise.
            fan.from + lasts <= fans[0].from * (1.0 + SAME_TIME) || rises_until.is_some() && fan.from == fans[0].from
        };
        if first.iter().filter(|fan| here(fan)).all(|fan| is_elastic(fan, &scene.bar) || gone(fan)) {
            // Both sides of a joint must have fans from the same time.
            first.retain(|fan| !here(fan) || fan.from != fans[0].from);
            first.extend(fans);
        }
    }
    first
}

/// Returns the `first` fans of a bar that front tracking cannot follow, with those of loads that rise from t = 0 on. Until something unloads it, such
/// a bar follows its curves as under isotropic hardening.
pub(super) fn with_first_rises(first: Vec<InitialFan>, scene: &Scene, (grid, late): (&Grid, f64)) -> Vec<InitialFan> {
    let rises = Rises::new(scene, grid.dt);
    if !is_uniform(scene) || scene.bar.has_initial_state() || rises.0.iter().all(Vec::is_empty) {
        return first;
    }
    let mut stepped = super::as_stepped(scene, grid);
    stepped.parts.effects.hardening = Some(HardeningRule::Isotropic);
    let mut fans = tracked(&stepped, grid.dt, scene.solve.until);
    fans.retain(|fan| fan.from == 0.0 && rises.until(fan.origin, 0.0).is_some());
    with_later(first, &fans, &stepped, (grid, late))
}

/// Returns the `first` and later fans of a non-uniform bar, limited to the time in which no wave reaches them from where a section or an initial
/// state changes.
pub(super) fn until_changes_come(first: Vec<InitialFan>, scene: &Scene, (grid, late): (&Grid, f64)) -> Vec<InitialFan> {
    let first = if scene.bar.has_initial_state() { at_ends_of_segments(scene, grid.dt) } else { first };
    let stepped = super::as_stepped(scene, grid);
    let undisturbed = undisturbed_until(&stepped.bar);
    let latest = undisturbed.iter().copied().fold(0.0, f64::max).min(scene.solve.until);
    let tracked = tracked(&in_halves(&stepped), grid.dt, latest);
    let whole = tracked.chunk_by(together).filter_map(|fans| in_whole_segments(fans, &stepped.bar)).flatten();
    let rises = Rises::new(&stepped, grid.dt);
    let jumps = |fan: &InitialFan| fan.from == 0.0 && rises.until(fan.origin, 0.0).is_none();
    let (at_start, later): (Vec<InitialFan>, Vec<InitialFan>) = whole.partition(jumps);
    let started = |origin: Origin| first.iter().any(|fan| fan.origin == origin);
    let missed: Vec<Origin> = at_start.iter().map(|fan| fan.origin).filter(|&origin| !started(origin)).collect();
    let known = later.into_iter().filter(|fan| !missed.contains(&fan.origin)).filter_map(|fan| {
        // A wave from there meets the first front of the fan half-way.
        let holds_until = fan.holds_until.min(0.5 * (undisturbed[place(fan.origin, &stepped.bar)] - fan.from));
        let lasts = holds_until >= takes_shape(&fan, &stepped, grid);
        lasts.then_some(InitialFan { holds_until, ..fan })
    });
    with_later(first, &known.collect::<Vec<_>>(), &stepped, (grid, late))
}

/// Time (s) at which the first wave from a change of section or initial state can reach each end and joint, from left to right. Between the halves of
/// a non-uniform segment nothing is known about the middle.
fn undisturbed_until(bar: &Bar) -> Vec<f64> {
    let transits = bar.transit_times();
    let mut times = vec![f64::INFINITY; bar.segments.len() + 1];
    for (k, segment) in bar.segments.iter().enumerate() {
        for (side, direction) in [(0, 1.0), (1, -1.0)] {
            let change = first_change(segment, direction);
            let parts = if change.is_finite() { (change / segment.length).min(0.5) } else { f64::INFINITY };
            times[k + side] = times[k + side].min(parts * transits[k]);
        }
    }
    for k in 0..transits.len() {
        times[k + 1] = times[k + 1].min(times[k] + transits[k]);
    }
    for k in (0..transits.len()).rev() {
        times[k] = times[k].min(times[k + 1] + transits[k]);
    }
    times
}

/// Index of an end or joint, counted from the left.
fn place(origin: Origin, bar: &Bar) -> usize {
    match origin {
        Origin::Left => 0,
        Origin::Joint(k) => k + 1,
        Origin::Right => bar.segments.len(),
    }
}

/// Returns the fans at t = 0 of a bar with an initial state, whatever its state is farther inside.
fn at_ends_of_segments(scene: &Scene, dt: f64) -> Vec<InitialFan> {
    let halves = in_halves(scene);
    // Up to this time no wave from the middle of a segment has reached an end or joint.
    let shortest = halves.bar.transit_times().into_iter().fold(f64::INFINITY, f64::min);
    let mut fans = tracked(&halves, dt, HARDLY_STARTED * shortest);
    let rises = Rises::new(scene, dt);
    fans.retain(|fan| fan.from == 0.0 && rises.until(fan.origin, 0.0).is_none());
    let of_one = fans.chunk_by(|a, b| a.origin == b.origin);
    of_one.filter_map(|fans| in_whole_segments(&at_start(fans, &halves)?, &scene.bar)).flatten().collect()
}

/// Largest relative change of the stress behind a fan by distributed forces while the fan is followed.
const HARDLY_CHANGED: f64 = 0.02;

/// Returns the fans at t = 0 of a bar with distributed forces, limited to the time in which these hardly change them. Returns none with internal
/// damping or lateral inertia, which disperse jumps at once.
pub(super) fn beside_forces(scene: &Scene, grid: &Grid, along: &DistributedForces) -> Vec<InitialFan> {
    if along.internal > 0.0 || along.lateral.iter().any(|&lateral| lateral > 0.0) {
        return Vec::new();
    }
    let mut fans = super::sudden_fans(scene, grid, LATE_IN_LEAPFROG);
    fans.retain(|fan| fan.from == 0.0);
    for fan in &mut fans {
        let segment = &scene.bar.segments[fan.segment];
        let (c0, [stress, _]) = (segment.material.c0(), fan.changes());
        let area = segment.end_areas()[usize::from(fan.direction < 0.0)];
        let velocity = fan.fan.velocity.abs().max(fan.velocity_ahead.abs());
        // Forces per length (N/m) behind an elastic wave: those that act at once, and those that grow with the displacement.
        let at_once = along.external * velocity + along.friction;
        let allowed = HARDLY_CHANGED * stress * area / c0;
        let displaced = along.foundation * velocity;
        let times = [allowed / at_once, (allowed / displaced).sqrt()];
        fan.holds_until = times.into_iter().fold(fan.holds_until, f64::min);
    }
    fans
}

/// Returns the waves of balls at t = 0.
pub(super) fn at_balls(scene: &Scene, grid: &Grid) -> Vec<InitialFan> {
    if !super::follows_curves(scene) {
        return Vec::new();
    }
    ball_waves(&scene.bar, [&scene.left, &scene.right], MOST_STEPS * grid.dt, grid.dt)
}

/// Returns the waves of stiff springs: of a bar that moves against a spring at t = 0, and those that the first wave causes in a bar at rest.
pub(super) fn at_springs(scene: &Scene, grid: &Grid, late: f64) -> Vec<InitialFan> {
    let ends = [&scene.left, &scene.right];
    if !super::follows_curves(scene) || !ends.iter().any(|end| matches!(end, EndCondition::Spring { .. })) {
        return Vec::new();
    }
    let mut waves = spring_waves(&scene.bar, ends, grid.dt);
    if waves.is_empty() && can_be_tracked(scene) && is_uniform(scene) {
        waves = when_waves_arrive(scene, grid, late);
    }
    waves
}

/// Largest relative difference of a wave's stress from that of a wave into a bar at rest that is attributed to rounding.
const FIRST: f64 = 1e-9;

/// Returns the waves of springs that the first wave causes. A fixed end would send the same fronts, except for the first.
fn when_waves_arrive(scene: &Scene, grid: &Grid, late: f64) -> Vec<InitialFan> {
    let mut held = super::as_stepped(scene, grid);
    for end in [&mut held.parts.left, &mut held.parts.right] {
        if matches!(end, EndCondition::Spring { .. }) {
            *end = EndCondition::Fixed;
        }
    }
    let wave = |wall: &InitialFan| {
        let (end, at) = (end_at(scene, wall.origin)?, &scene.bar.segments[wall.segment]);
        let came = at.material.impedance() * wall.velocity_ahead;
        let is_first = (wall.stress_ahead() - wall.direction * came).abs() <= FIRST * came.abs();
        let [wall] = &after_start(std::slice::from_ref(wall), &held, grid, late)?[..] else { return None };
        (is_first && at.velocity == 0.0 && wall.from > 0.0).then(|| at_spring(wall, end, at, grid.dt)).flatten()
    };
    tracked(&held, grid.dt, scene.solve.until).iter().filter_map(wave).collect()
}

/// Returns the fans of an end or joint of the halved bar in terms of whole segments; `None` for the joint between two halves of a segment.
fn in_whole_segments(fans: &[InitialFan], bar: &Bar) -> Option<Vec<InitialFan>> {
    let origin = match fans[0].origin {
        Origin::Joint(k) if k % 2 == 0 => return None,
        Origin::Joint(k) => Origin::Joint(k / 2),
        end => end,
    };
    let area = |fan: &InitialFan| bar.segments[fan.segment / 2].end_areas()[usize::from(fan.direction < 0.0)];
    let force = fans.iter().map(|fan| area(fan) * fan.changes()[0]).fold(0.0, f64::max);
    let whole = |fan: &InitialFan| {
        let (segment, direction) = (fan.segment / 2, fan.direction);
        let at = &bar.segments[segment];
        let uniform_for =
            same_section(at, direction).min(same_state(at, direction, force / area(fan), fan.changes()[1]));
        let wave_through = fan.wave_through.map(|half| half / 2);
        InitialFan { origin, segment, wave_through, uniform_for, ..fan.clone() }
    };
    Some(fans.iter().map(whole).collect())
}

/// Returns the scene with each segment replaced by two uniform halves: one in the state at its left end, one in that at its right end.
fn in_halves(scene: &Scene) -> Scene {
    let half = |segment: &Segment, side: usize| {
        let x = [0.0, segment.length][side];
        let initial = segment.profile.as_ref().map_or(segment.initial, |profile| profile.one_sided_limit(x, 1 - side));
        Segment {
            length: 0.5 * segment.length,
            area: segment.end_areas()[side],
            taper: None,
            velocity: segment.end_velocities()[side],
            initial,
            profile: None,
            joint: if side == 0 { Joint::Bonded } else { segment.joint },
            ..segment.clone()
        }
    };
    let mut halves = scene.clone();
    halves.parts.bar.segments =
        scene.bar.segments.iter().flat_map(|segment| [half(segment, 0), half(segment, 1)]).collect();
    // At t = 0 nothing has fractured.
    halves.parts.effects.rupture = None;
    halves
}

/// Returns the fans with which an end or joint of a bar with an initial state starts; `None` if the end drives nothing at t = 0.
fn at_start(fans: &[InitialFan], scene: &Scene) -> Option<Vec<InitialFan>> {
    let fan = &fans[0];
    let Some(end) = end_at(scene, fan.origin) else {
        return Some(fans.iter().map(|fan| driven(fan, Driver::Velocity, f64::INFINITY)).collect());
    };
    let at = &scene.bar.segments[fan.segment];
    let (driver, holds_until) = drives_at_start(end, fan.direction, at)?;
    (holds_until > 0.0).then(|| vec![driven(fan, driver, holds_until).held_by(end, at, 0.0)])
}

/// Returns the fan with this driver, and not alone: other waves may come to meet it at any time.
fn driven(fan: &InitialFan, driver: Driver, holds_until: f64) -> InitialFan {
    InitialFan { driver, holds_until, alone: false, ..fan.clone() }
}

/// Returns the fan of a load that rises until `until` (s); `None` if it has none.
fn rising(fans: &[InitialFan], until: f64, scene: &Scene, grid: &Grid, late: f64) -> Option<Vec<InitialFan>> {
    let jump = after_start(fans, &jumping(scene, grid.dt), grid, late)?.pop()?;
    // A bar that follows its curve both ways unloads by shocks.
    let unloads_first = jump.sense.sign() * jump.stress_ahead() < 0.0;
    if unloads_first && super::is_followed_both_ways(&scene.effects) {
        return None;
    }
    let end = end_at(scene, jump.origin)?;
    let curve = scene.bar.segments[jump.segment].material.branch(jump.sense);
    at_rising_load(&jump, end, curve, until, grid.dt).map(|fan| vec![fan])
}

/// Returns the fans that start after t = 0, with times as this grid can resolve them; `None` if it cannot.
fn after_start(fans: &[InitialFan], scene: &Scene, grid: &Grid, late: f64) -> Option<Vec<InitialFan>> {
    let from = start(fans, scene, grid, late)?;
    let driver = drives_alone(scene, fans[0].origin)?;
    let lasts = |fan: &InitialFan| {
        let held = held(&InitialFan { driver, ..fan.clone() }, scene);
        let holds_until = held.holds_until.min(held.meets_plastic_at - spread(fan, grid));
        InitialFan { from, holds_until: in_parts(holds_until.max(0.0) / grid.dt) * grid.dt, ..held }
    };
    Some(fans.iter().map(lasts).collect())
}

/// Steps for which a fan that is too short for the grid gives the force of its joint: the first one or two.
const FIRST_STEPS: f64 = 1.5;

/// Returns the fans that a sharp wave starts at a joint and that end before the grid can follow them, as under a light striker. They give the
/// joint its force just after the wave has arrived. Empty for ends, and for waves that have spread on the grid.
fn at_first_moment(fans: &[InitialFan], scene: &Scene, grid: &Grid, late: f64) -> Vec<InitialFan> {
    let fan = &fans[0];
    let is_sharp = fan.wave_through.is_some_and(|through| arrives_sharp(fan, through, scene, grid, late));
    if !matches!(fan.origin, Origin::Joint(_)) || !is_sharp {
        return Vec::new();
    }
    let from = (fan.from / grid.dt).round() * grid.dt;
    let short =
        |fan: &InitialFan| InitialFan { from, holds_until: FIRST_STEPS * grid.dt, decays_from: 0.0, ..fan.clone() };
    fans.iter().map(short).collect()
}

/// Number of cells over which grids spread a plastic front.
const SPREAD: f64 = 7.0;

/// Time (s) between the first contact of a fan's plastic front, as spread on the grid, with one that comes towards it and their exact meeting.
fn spread(fan: &InitialFan, grid: &Grid) -> f64 {
    let slowest = fan.fan.edges.last().map_or(f64::INFINITY, |edge| edge.speed);
    0.5 * SPREAD * grid.segments[fan.segment].dx / slowest
}

/// Returns whether front tracking follows the laws of this scene exactly.
pub(super) fn can_be_tracked(scene: &Scene) -> bool {
    let several_lines = |segment: &Segment| {
        let table = |sense| Table::new(segment.material.branch(sense), segment.material.modulus);
        [Sense::Tension, Sense::Compression].into_iter().any(|sense| table(sense).is_multilinear())
    };
    let segments = &scene.bar.segments;
    match scene.effects.hardening {
        Some(HardeningRule::ArmstrongFrederick { .. }) => false,
        Some(HardeningRule::Kinematic) => !segments.iter().any(several_lines),
        _ => true,
    }
}

/// Returns whether front tracking needs no steps in space for this scene.
pub(super) fn is_uniform(scene: &Scene) -> bool {
    scene.bar.segments.iter().all(|segment| segment.taper.is_none() && segment.profile.is_none())
}

fn is_elastic(fan: &InitialFan, bar: &Bar) -> bool {
    let c0 = bar.segments[fan.segment].material.c0();
    fan.fan.edges.iter().all(|edge| edge.is_elastic(c0))
}

/// Start time of the fans of an end or joint on the grid, s. `None` if the grid does not resolve their cause sharply enough: the cause must be a wave
/// that is a jump between two cells (which requires that waves travel one cell per step), or a gap to which only such waves have come.
fn start(fans: &[InitialFan], scene: &Scene, grid: &Grid, late: f64) -> Option<f64> {
    let steps = fans[0].from / grid.dt;
    if let Some(through) = fans[0].wave_through {
        let arrives = arrives_sharp(&fans[0], through, scene, grid, late);
        return (arrives && fans.iter().all(|fan| has_room(fan, scene, grid))).then(|| steps.round() * grid.dt);
    }
    let starts = can_close(scene, fans[0].origin) || jumps(scene, fans[0].origin, fans[0].from);
    let is_known = |fan: &InitialFan| fan.waves_before == 0 || stays_sharp(fan, fan.segment, scene, grid, late);
    (starts && fans.iter().all(is_known)).then(|| in_parts(steps) * grid.dt)
}

/// Returns whether the wave that starts a fan arrives through this segment as a jump between two cells, at a whole step.
fn arrives_sharp(fan: &InitialFan, through: usize, scene: &Scene, grid: &Grid, late: f64) -> bool {
    let steps = fan.from / grid.dt;
    stays_sharp(fan, through, scene, grid, late) && (steps - steps.round()).abs() < late
}

/// Returns whether elastic waves of this segment are still jumps between two cells when a fan starts. The delay of a wave on the grid measures how far
/// it has spread.
fn stays_sharp(fan: &InitialFan, segment: usize, scene: &Scene, grid: &Grid, late: f64) -> bool {
    let courant = scene.bar.segments[segment].material.c0() * grid.dt / grid.segments[segment].dx;
    fan.from / grid.dt * (1.0 - courant) < late
}

/// Relative tolerance for a time to count as that of a jump.
const SAME_TIME: f64 = 1e-12;

/// Returns whether the velocity or stress that an end prescribes jumps at `time`, s.
fn jumps(scene: &Scene, origin: Origin, time: f64) -> bool {
    let history = end_at(scene, origin).and_then(EndCondition::history);
    history.is_some_and(|history| history.jumps_between(time * (1.0 - SAME_TIME), time * (1.0 + SAME_TIME)))
}

/// Returns whether the fan is a step by which front tracking follows an end whose velocity or stress changes gradually.
fn is_ramp(scene: &Scene, fan: &InitialFan) -> bool {
    let driven = end_at(scene, fan.origin).is_some_and(|end| end.history().is_some());
    driven && fan.wave_through.is_none() && !jumps(scene, fan.origin, fan.from)
}

/// Returns whether the origin is a joint, or an end that a wall may stop.
fn can_close(scene: &Scene, origin: Origin) -> bool {
    end_at(scene, origin).is_none_or(|end| matches!(end, EndCondition::Wall { .. }))
}

/// Returns the end condition of an end; `None` for a joint.
fn end_at(scene: &Scene, origin: Origin) -> Option<&EndCondition> {
    match origin {
        Origin::Left => Some(&scene.left),
        Origin::Right => Some(&scene.right),
        Origin::Joint(_) => None,
    }
}

/// Rounds a number of steps to the resolution [`TIMES_IN_STEP`].
fn in_parts(steps: f64) -> f64 {
    (steps * TIMES_IN_STEP).round() / TIMES_IN_STEP
}

/// Returns whether nothing meets a fan before its fronts have taken the shape that they have on the grid.
fn has_room(fan: &InitialFan, scene: &Scene, grid: &Grid) -> bool {
    fan.known_until(scene.bar.segments[fan.segment].length) >= takes_shape(fan, scene, grid)
}

/// Time in which the fronts of a fan take the shape that they have on the grid, s.
fn takes_shape(fan: &InitialFan, scene: &Scene, grid: &Grid) -> f64 {
    let c0 = scene.bar.segments[fan.segment].material.c0();
    SHAPED * fan.followed_for(grid.segments[fan.segment].dx, c0)
}

/// Returns the fan limited to the time for which its driver holds.
fn held(fan: &InitialFan, scene: &Scene) -> InitialFan {
    let at = &scene.bar.segments[fan.segment];
    let held = |end| fan.clone().held_by(end, at, fan.from * (1.0 + SAME_TIME));
    end_at(scene, fan.origin).map_or_else(|| fan.clone(), held)
}

/// Returns the quantity that arriving waves leave unchanged: the stress or the velocity of an end, the common velocity of a joint. `None` if both
/// change.
fn drives_alone(scene: &Scene, origin: Origin) -> Option<Driver> {
    match end_at(scene, origin) {
        Some(EndCondition::Stress { .. }) => Some(Driver::Stress),
        None | Some(EndCondition::Fixed | EndCondition::Velocity { .. } | EndCondition::Wall { .. }) => {
            Some(Driver::Velocity)
        }
        Some(_) => None,
    }
}
