//! Wave emitted by a stiff spring into a bar that moves against it at t = 0, or when a wave arrives. The force grows from zero, F' = k v, while the
//! end moves with the velocity v(F), which follows from the curve as behind any loading wave: along a line of the curve with impedance z, v falls as
//! exp(-k t/z), until the end is at rest.

use super::initial_fan::{at_ends, from_end};
use super::{Bar, Driver, EndCondition, InitialFan, Segment};
use crate::wave::similarity::{Edge, Fan};

/// Rise time Z/k of the force of a spring, in time steps, with Z the impedance of the bar, above which the scheme overshoots by less than 0.5 %
/// without the waves computed here (annealed copper at 30 m/s).
const MOST_STEPS: f64 = 100.0;

/// Remaining fraction of the velocity of an end at which the spring counts as fully loaded.
const AT_REST: f64 = 1e-4;

/// Returns the waves of springs at the ends of a bar at t = 0, if they rise within a limited number of steps of `dt` (s). Empty for a bar with an
/// initial state.
pub fn spring_waves(bar: &Bar, ends: [&EndCondition; 2], dt: f64) -> Vec<InitialFan> {
    // Behind the wave the end is at rest, as behind the fan of a wall.
    at_ends(bar, ends, |end, place, at| at_spring(&from_end(&EndCondition::Fixed, place, at)?, end, at, dt))
}

/// Returns the wave at the end of a segment, in steps of `dt` (s), if the end is a spring that is stiff and so far at rest; `wall` is the fan of a
/// rigid wall in its place. The wave has the same states, but starts without a force.
pub fn at_spring(wall: &InitialFan, end: &EndCondition, at: &Segment, dt: f64) -> Option<InitialFan> {
    let EndCondition::Spring { stiffness } = *end else { return None };
    let mass_per_length = at.material.density * at.end_areas()[usize::from(wall.direction < 0.0)];
    let rises = |edge: &Edge| mass_per_length * edge.speed / stiffness;
    let mut whole = wall.fan.clone();
    begin_elastically(&mut whole, at.material.c0());
    // A wave that meets the fan of the wall meets an elastic front sooner.
    let [slower, faster] = [&wall.fan, &whole].map(|fan| fan.edges.first().map_or(1.0, |edge| edge.speed));
    let holds_until = wall.holds_until * slower / faster;
    let first = whole.edges.first_mut().filter(|edge| rises(edge) < MOST_STEPS * dt)?;
    let thrown_back = Edge { stress_behind: 0.0, strain_behind: 0.0, ..*first };
    let is_stressed = first.stress_ahead != 0.0;
    (first.stress_ahead, first.strain_ahead) = (0.0, 0.0);
    whole.velocity -= thrown_back.velocity_jump();
    let (mut edges, mut delays) = in_steps(&whole, rises, dt);
    if is_stressed {
        edges.insert(0, thrown_back);
        delays.insert(0, 0.0);
    }
    let fan = Fan { edges, ..wall.fan.clone() };
    Some(InitialFan { fan, delays, holds_until, driver: Driver::Stress, sudden: false, ..wall.clone() })
}

/// Prepends an elastic front to a fan that starts at the yield stress with plastic fronts. A wall reflects an incoming wave of the yield stress as
/// plastic fronts alone. A spring first reflects it to zero stress, from where the bar is loaded elastically: the fan of the wall lacks this elastic
/// front.
fn begin_elastically(fan: &mut Fan, c0: f64) {
    let Some(first) = fan.edges.first().filter(|first| !first.is_elastic(c0) && first.stress_ahead != 0.0) else {
        return;
    };
    let elastic = Edge { strain_behind: first.strain_ahead, stress_behind: first.stress_ahead, speed: c0, ..*first };
    fan.edges.insert(0, elastic);
}

/// Divides the fronts of a fan into the parts that leave the end within each step. Returns them with the mean times at which they leave, s: the
/// displacement of the end is that of a continuously falling velocity. Along a front the velocity falls with the time constant `rises`, s.
fn in_steps(fan: &Fan, rises: impl Fn(&Edge) -> f64, dt: f64) -> (Vec<Edge>, Vec<f64>) {
    let (mut edges, mut delays) = (Vec::new(), Vec::new());
    let (mut time, mut velocity) = (0.0, fan.velocity);
    for edge in &fan.edges {
        let (begins, jump, rises) = (time, edge.velocity_jump(), rises(edge));
        let left = (velocity - jump).max(AT_REST * fan.velocity);
        let ends = begins + rises * (velocity / left).ln().max(0.0);
        let (mut gone, mut step, last) = (0.0, (begins / dt).floor(), velocity - jump);
        while gone < 1.0 {
            step += 1.0;
            let until = ends.min(step * dt);
            let part = if until < ends { velocity * -(-(until - begins) / rises).exp_m1() / jump } else { 1.0 };
            let (lost, left) = (jump * (part - gone), if part < 1.0 { velocity - jump * part } else { last });
            let mean = if lost > 0.0 { rises - left.max(0.0) * (until - time) / lost } else { 0.0 };
            edges.push(between(edge, gone, part));
            delays.push(time + mean.clamp(0.0, rises));
            (gone, time) = (part, until);
        }
        velocity = last;
    }
    (edges, delays)
}

/// Returns a part of a front, between two fractions of it.
pub(super) fn between(edge: &Edge, from: f64, to: f64) -> Edge {
    let at = |ahead: f64, behind: f64, part: f64| ahead + part * (behind - ahead);
    Edge {
        strain_ahead: at(edge.strain_ahead, edge.strain_behind, from),
        strain_behind: at(edge.strain_ahead, edge.strain_behind, to),
        stress_ahead: at(edge.stress_ahead, edge.stress_behind, from),
        stress_behind: at(edge.stress_ahead, edge.stress_behind, to),
        speed: edge.speed,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::material::{Beyond, Curve};
    use crate::wave::similarity::fan_at_velocity;

    /// The force of the spring is always its stiffness times the displacement of the end, however stiff it is.
    #[test]
    fn the_end_goes_as_far_as_the_force_compresses_the_spring() {
        let (density, area, dt) = (7850.0, 1e-4, 1e-7);
        let curve = Curve::new(&[(0.0, 0.0), (1e-3, 200e6), (0.05, 1180e6)], Beyond::Extend).expect("a curve");
        let fan = fan_at_velocity(&curve, density, 20.0);
        for stiffness in [1e9, 2e10, 1e12] {
            let (edges, delays) = in_steps(&fan, |edge| density * area * edge.speed / stiffness, dt);
            assert!(edges.len() == delays.len() && delays.is_sorted(), "{delays:?}");
            let lost = |edge: &Edge| edge.velocity_jump();
            assert!((edges.iter().map(lost).sum::<f64>() / 20.0 - 1.0).abs() < 1e-12);
            let way = |time: f64| {
                let back = |(edge, delay): (&Edge, &f64)| lost(edge) * (time - delay).max(0.0);
                20.0 * time - edges.iter().zip(&delays).map(back).sum::<f64>()
            };
            let whole = area * fan.stress / stiffness;
            for step in 1..2000 {
                let time = f64::from(step) * dt;
                // The part of the fan that has left the end by the end of a step.
                let stress =
                    edges.iter().zip(&delays).rev().find(|(_, delay)| **delay < time).expect("a front").0.stress_behind;
                let error = (way(time) - area * stress / stiffness) / whole;
                assert!(error.abs() < 1e-3, "{stiffness:e} N/m, step {step}: {error:e}");
            }
            assert!((way(1e-3) / whole - 1.0).abs() < 1e-9, "{stiffness:e}");
        }
    }
}
