//! The fans at ends and joints that a scheme on a grid follows: those at t = 0, and those that start when gaps close or waves arrive.

use crate::bar::{Bar, EndCondition, InitialFan, Origin, START_CELLS, Segment, gap_closes};
use crate::law::Table;
use crate::material::Sense;
use crate::scene::{HardeningRule, Scene};
use crate::solver::fd::Grid;

/// Part by which speeds and times may differ that are the same.
const SAME: f64 = 1e-9;

/// Part of a step by which a wave may arrive before or after one.
const SAME_STEP: f64 = 1e-3;

/// Times in a step that are told apart: what is left of rounding would tell a bar from its mirror image.
const TIMES_IN_STEP: f64 = (1 << 20) as f64;

/// The `first` fans and, at ends and joints that have no plastic one, those of the `later` ones that are as sharp on the grid.
pub(super) fn with_later(
    mut first: Vec<InitialFan>,
    later: &[InitialFan],
    scene: &Scene,
    grid: &Grid,
) -> Vec<InitialFan> {
    for fans in later.chunk_by(|a, b| a.origin == b.origin) {
        let origin = fans[0].origin;
        let stays_elastic = first.iter().filter(|fan| fan.origin == origin).all(|fan| is_elastic(fan, &scene.bar));
        let from = start(fans, scene, grid).filter(|_| stays_elastic && moves_alone(scene, origin));
        if let Some(from) = from {
            // Both sides of a joint have their fans from one moment.
            first.retain(|fan| fan.origin != origin || !matches!(origin, Origin::Joint(_)));
            first.extend(fans.iter().map(|fan| InitialFan { from, holds_until: lasts(fan, grid.dt), ..fan.clone() }));
        }
    }
    first
}

/// Front tracking finds the waves of this scene. A bar with an initial state has no fans at t = 0 either.
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
    rule && segments.iter().all(|segment| segment.taper.is_none()) && !scene.bar.has_initial_state()
}

fn is_elastic(fan: &InitialFan, bar: &Bar) -> bool {
    let c0 = bar.segments[fan.segment].material.c0();
    fan.fan.edges.iter().all(|edge| edge.speed >= c0 * (1.0 - SAME))
}

/// When the fans of an end or a joint start, s. None where the grid does not have what starts them as sharply: a wave that is a jump between two
/// cells, as it is where waves travel a cell in a step, or a gap between bodies to which none have come yet.
fn start(fans: &[InitialFan], scene: &Scene, grid: &Grid) -> Option<f64> {
    let (bar, from) = (&scene.bar, fans[0].from);
    if let Some(through) = fans[0].wave_through {
        let courant = bar.segments[through].material.c0() * grid.dt / grid.segments[through].dx;
        let (steps, is_exact) = (from / grid.dt, (courant - 1.0).abs() < SAME);
        let is_sharp = is_exact && (steps - steps.round()).abs() < SAME_STEP;
        return (is_sharp && fans.iter().all(|fan| has_room(fan, scene, grid))).then(|| steps.round() * grid.dt);
    }
    let untouched = |fan: &InitialFan| fan.velocity_ahead == bar.segments[fan.segment].velocity;
    gap_closes(bar, [&scene.left, &scene.right], fans[0].origin).filter(|_| fans.iter().all(untouched))
}

/// Nothing meets a fan before its slowest front has travelled [`START_CELLS`] cells: the plastic fronts that it meets on a grid are spread over some
/// cells.
fn has_room(fan: &InitialFan, scene: &Scene, grid: &Grid) -> bool {
    let slowest = fan.fan.edges.last().map_or(0.0, |edge| edge.speed);
    let wanted = if is_elastic(fan, &scene.bar) { 0.0 } else { START_CELLS * grid.segments[fan.segment].dx / slowest };
    fan.known_until(scene.bar.segments[fan.segment].length) >= wanted
}

/// For how long what drives a fan stays as it is, s.
fn lasts(fan: &InitialFan, dt: f64) -> f64 {
    (fan.holds_until / dt * TIMES_IN_STEP).round() / TIMES_IN_STEP * dt
}

/// Waves do not change how this end moves; or it is a joint.
fn moves_alone(scene: &Scene, origin: Origin) -> bool {
    let end = match origin {
        Origin::Left => &scene.left,
        Origin::Right => &scene.right,
        Origin::Joint(_) => return true,
    };
    matches!(end, EndCondition::Fixed | EndCondition::Velocity { .. } | EndCondition::Wall { .. })
}
