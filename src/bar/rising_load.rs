//! Fan of an end whose velocity or stress rises within some time steps. Its fronts are those of a jump; each of them leaves the end when the load
//! reaches it. If none of them is a shock, later fronts are slower, and none meets another.

use super::spring_wave::between;
use super::{Driver, EndCondition, History, InitialFan};
use crate::material::Curve;
use crate::wave::similarity::{Edge, Fan};

/// Relative difference from the change of the fan up to which two loads count as equal.
const SAME: f64 = 1e-6;

/// Returns the fan of an end whose load rises from the start of the fan of a `jump` to the time `until` (s), in steps of `dt` (s). Returns `None` if
/// the fan has shocks, if the end prescribes no history, or if the load falls or exceeds that of the fan.
pub fn at_rising_load(jump: &InitialFan, end: &EndCondition, curve: &Curve, until: f64, dt: f64) -> Option<InitialFan> {
    let (driver, history) = match end {
        EndCondition::Velocity { history, .. } => (Driver::Velocity, history),
        EndCondition::Stress { history } => (Driver::Stress, history),
        _ => return None,
    };
    let (size, sense): (fn(&Edge) -> f64, f64) = match driver {
        Driver::Stress => (|edge| edge.stress_behind - edge.stress_ahead, jump.sense.sign()),
        _ => (Edge::velocity_jump, -jump.direction * jump.sense.sign()),
    };
    let whole: f64 = jump.fan.edges.iter().map(size).sum();
    let at_end = history.before(until);
    // Part of the fan (in units of the load) that has left the end at a value of the load, from 0 to the whole.
    let gone = |value: f64| whole + sense * (value - at_end);
    let pieces = pieces(history, [jump.from, until], dt, gone);
    // The course starts at 0, so that a fall of the load is detected even if rounding places the start before a jump.
    let course: Vec<f64> = std::iter::once(0.0).chain(pieces.iter().flat_map(|piece| piece.gone)).collect();
    let falls = course.windows(2).any(|pair| pair[1] < pair[0] - SAME * whole);
    if falls || gone(history.at(jump.from)) > whole || jump.fan.edges.iter().any(|edge| edge.is_shock(curve)) {
        return None;
    }
    let (mut edges, mut delays, mut ahead) = (Vec::new(), Vec::new(), 0.0);
    for edge in &jump.fan.edges {
        let jump = size(edge);
        for step in pieces.chunk_by(|a, b| a.step == b.step) {
            let [from, to] =
                [step[0].gone[0], step[step.len() - 1].gone[1]].map(|gone| gone.clamp(ahead, ahead + jump));
            if from < to {
                edges.push(between(edge, (from - ahead) / jump, (to - ahead) / jump));
                delays.push(mean_time(step, [from, to]));
            }
        }
        ahead += jump;
    }
    let fan = Fan { edges, ..jump.fan.clone() };
    (!fan.edges.is_empty()).then(|| InitialFan { fan, delays, driver, sudden: false, alone: false, ..jump.clone() })
}

/// A part of a time step in which the load changes linearly.
struct Piece {
    step: usize,
    /// Start and end, s after the start of the fan.
    times: [f64; 2],
    /// Part of the fan that has left the end at these times.
    gone: [f64; 2],
}

/// Divides a history between two times (s) into such parts.
fn pieces(history: &History, [from, until]: [f64; 2], dt: f64, gone: impl Fn(f64) -> f64) -> Vec<Piece> {
    let first = (from / dt).floor() as usize;
    let steps = (first + 1..).map(|step| step as f64 * dt).take_while(|&end| end < until);
    let mut times: Vec<f64> = history.time().iter().copied().filter(|&row| from < row && row < until).collect();
    times.extend(steps.chain([from, until]));
    times.sort_by(f64::total_cmp);
    let mut pieces = Vec::new();
    // The part of the fan that has left the end before a jump.
    let mut last = 0.0;
    for pair in times.windows(2) {
        let step = (0.5 * (pair[0] + pair[1]) / dt) as usize;
        let [start, end] = [history.at(pair[0]), history.before(pair[1])].map(&gone);
        let times = [pair[0] - from, pair[1] - from];
        if start > last {
            pieces.push(Piece { step, times: [times[0]; 2], gone: [last, start] });
        }
        pieces.push(Piece { step, times, gone: [start, end] });
        last = end;
    }
    pieces
}

/// Returns the mean time at which the load changes from one value to another in these parts, s after the start. The values are those of `gone`.
fn mean_time(pieces: &[Piece], [from, to]: [f64; 2]) -> f64 {
    let mut moment = 0.0;
    for Piece { times, gone, .. } in pieces {
        let [a, b] = gone.map(|gone| gone.clamp(from, to));
        if a < b {
            let time = |value: f64| times[0] + (times[1] - times[0]) * (value - gone[0]) / (gone[1] - gone[0]);
            moment += (b - a) * time(0.5 * (a + b));
        }
    }
    moment / (to - from)
}
