//! The fans at ends and joints that a scheme on a grid follows: those at t = 0, and those that start when gaps close or waves arrive.

use crate::bar::{Bar, Driver, EndCondition, InitialFan, Origin, Segment, drives_at_start};
use crate::law::Table;
use crate::material::Sense;
use crate::scene::{HardeningRule, Scene};
use crate::solver::fd::Grid;

/// Parts of a step by which a wave may arrive before or after one, and by which cells of a segment may have delayed it, to be as sharp as the start of
/// a fan has to be. In leapfrog a wave that is 0.04 late rings beside a free face by 20 % of its stress; in the Godunov scheme none does.
pub(super) const LATE_IN_LEAPFROG: f64 = 1e-3;
pub(super) const LATE_IN_MUSCL: f64 = 0.05;

/// Part of the time for which a fan is followed that it takes shape: its slowest front travels 6 cells. Where waves met one of 22 cells, the force at a
/// joint was 27 % too large in the first step without a fan, and none was with it.
const SHAPED: f64 = 0.25;

/// Times in a step that are told apart: what is left of rounding would tell a bar from its mirror image.
const TIMES_IN_STEP: f64 = (1_u64 << 36) as f64;

/// The `first` fans and those of the `later` ones, in order of time, that are as sharp on the grid.
pub(super) fn with_later(
    mut first: Vec<InitialFan>,
    later: &[InitialFan],
    scene: &Scene,
    (grid, late): (&Grid, f64),
) -> Vec<InitialFan> {
    for fans in later.chunk_by(|a, b| a.origin == b.origin && a.from == b.from) {
        let here = |fan: &InitialFan| fan.origin == fans[0].origin;
        let Some(fans) =
            (if fans[0].from == 0.0 { at_start(fans, scene) } else { after_start(fans, scene, grid, late) })
        else {
            continue;
        };
        let gone = |fan: &InitialFan| fan.from + takes_shape(fan, scene, grid) <= fans[0].from;
        if first.iter().filter(|fan| here(fan)).all(|fan| is_elastic(fan, &scene.bar) || gone(fan)) {
            // Both sides of a joint have their fans from one moment.
            first.retain(|fan| !here(fan) || fan.from != fans[0].from);
            first.extend(fans);
        }
    }
    first
}

/// Those with which an end or a joint of a bar with an initial state starts.
fn at_start(fans: &[InitialFan], scene: &Scene) -> Option<Vec<InitialFan>> {
    let fan = &fans[0];
    let Some(end) = end_at(scene, fan.origin) else {
        return Some(fans.iter().map(|fan| driven(fan, Driver::Velocity, f64::INFINITY)).collect());
    };
    let (driver, holds_until) = drives_at_start(end, fan.direction, &scene.bar.segments[fan.segment])?;
    (holds_until > 0.0).then(|| vec![driven(fan, driver, holds_until)])
}

/// Waves may come to meet it as soon as they can.
fn driven(fan: &InitialFan, driver: Driver, holds_until: f64) -> InitialFan {
    InitialFan { driver, holds_until, alone: false, ..fan.clone() }
}

/// Those that start later, on this grid.
fn after_start(fans: &[InitialFan], scene: &Scene, grid: &Grid, late: f64) -> Option<Vec<InitialFan>> {
    let from = start(fans, scene, grid, late).filter(|_| moves_alone(scene, fans[0].origin))?;
    let lasts = |fan: &InitialFan| InitialFan { from, holds_until: lasts(fan, grid.dt), ..fan.clone() };
    Some(fans.iter().map(lasts).collect())
}

/// Front tracking finds the waves of this scene, without steps in space of its own.
pub(super) fn can_be_tracked(scene: &Scene) -> bool {
    let several_lines = |segment: &Segment| {
        let table = |sense| Table::new(segment.material.branch(sense), segment.material.modulus);
        [Sense::Tension, Sense::Compression].into_iter().any(|sense| table(sense).is_multilinear())
    };
    let segments = &scene.bar.segments;
    let rule = match scene.effects.hardening {
        Some(HardeningRule::ArmstrongFrederick { .. }) => false,
        Some(HardeningRule::Kinematic) => !segments.iter().any(several_lines),
        _ => true,
    };
    rule && segments.iter().all(|segment| segment.taper.is_none() && segment.profile.is_none())
}

fn is_elastic(fan: &InitialFan, bar: &Bar) -> bool {
    let c0 = bar.segments[fan.segment].material.c0();
    fan.fan.edges.iter().all(|edge| edge.is_elastic(c0))
}

/// When the fans of an end or a joint start, s. None where the grid does not have what starts them as sharply: a wave that is a jump between two
/// cells, as it is where waves travel a cell in a step, or a gap between bodies to which only such waves have come.
fn start(fans: &[InitialFan], scene: &Scene, grid: &Grid, late: f64) -> Option<f64> {
    let (bar, steps) = (&scene.bar, fans[0].from / grid.dt);
    // By what it comes late on the grid, a wave has spread.
    let is_sharp = |segment: usize| {
        let courant = bar.segments[segment].material.c0() * grid.dt / grid.segments[segment].dx;
        steps * (1.0 - courant) < late
    };
    if let Some(through) = fans[0].wave_through {
        let arrives = is_sharp(through) && (steps - steps.round()).abs() < late;
        return (arrives && fans.iter().all(|fan| has_room(fan, scene, grid))).then(|| steps.round() * grid.dt);
    }
    let untouched = |fan: &InitialFan| fan.velocity_ahead == bar.segments[fan.segment].velocity;
    let closes = can_close(scene, fans[0].origin) && fans.iter().all(|fan| untouched(fan) || is_sharp(fan.segment));
    closes.then(|| in_parts(steps) * grid.dt)
}

/// It is a joint, or an end that a wall may stop.
fn can_close(scene: &Scene, origin: Origin) -> bool {
    end_at(scene, origin).is_none_or(|end| matches!(end, EndCondition::Wall { .. }))
}

/// What holds or drives an end; none of a joint.
fn end_at(scene: &Scene, origin: Origin) -> Option<&EndCondition> {
    match origin {
        Origin::Left => Some(&scene.left),
        Origin::Right => Some(&scene.right),
        Origin::Joint(_) => None,
    }
}

/// Steps, rounded to parts of one.
fn in_parts(steps: f64) -> f64 {
    (steps * TIMES_IN_STEP).round() / TIMES_IN_STEP
}

/// Nothing meets a fan for a time, in which its fronts take the shape that they have on the grid.
fn has_room(fan: &InitialFan, scene: &Scene, grid: &Grid) -> bool {
    fan.known_until(scene.bar.segments[fan.segment].length) >= takes_shape(fan, scene, grid)
}

/// Time in which the fronts of a fan take the shape that they have on the grid, s.
fn takes_shape(fan: &InitialFan, scene: &Scene, grid: &Grid) -> f64 {
    let c0 = scene.bar.segments[fan.segment].material.c0();
    SHAPED * fan.followed_for(grid.segments[fan.segment].dx, c0)
}

/// For how long what drives a fan stays as it is, s.
fn lasts(fan: &InitialFan, dt: f64) -> f64 {
    in_parts(fan.holds_until / dt) * dt
}

/// Waves do not change how this end moves; or it is a joint.
fn moves_alone(scene: &Scene, origin: Origin) -> bool {
    let alone = |end: &EndCondition| {
        matches!(end, EndCondition::Fixed | EndCondition::Velocity { .. } | EndCondition::Wall { .. })
    };
    end_at(scene, origin).is_none_or(alone)
}
