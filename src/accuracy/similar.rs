//! Response of a bar with a single fan: the self-similar solution.

use super::joint_forces::JointForces;
use super::recorders::{empty, peak_of};
use super::response::Response;
use super::shape::Shape;
use crate::bar::{Bar, InitialFan};

/// Returns the response up to the last of the instants `times` (s, increasing), with gauges at these positions (m). It
/// is exact for the table of the curve.
pub fn similar_response(bar: &Bar, initial_fan: &InitialFan, times: &[f64], gauges: &[f64]) -> Response {
    let (length, modulus) = (bar.length(), bar.segments[initial_fan.segment].material.modulus);
    let until = times.last().copied().unwrap_or(0.0);
    let ends = [0.0, length].map(|x| similar_history(initial_fan, x, until));
    let peaks = ends.each_ref().map(|end| peak_of(Some(end)));
    Response {
        fields: times.iter().map(|&time| (time, similar_profile(initial_fan, length, time))).collect(),
        plastic: Some(profile(initial_fan, length, until, |strain, stress| strain - stress / modulus)),
        ends: ends.into(),
        gauges: gauges.iter().map(|&x| similar_history(initial_fan, x, until)).collect(),
        modulus,
        ..empty(bar)
    }
    .with_peaks(peaks, &JointForces::new(bar, &[]))
}

/// Returns the stress over the bar at a time.
fn similar_profile(initial_fan: &InitialFan, length: f64, time: f64) -> Shape {
    profile(initial_fan, length, time, |_, stress| stress)
}

/// Returns a function of the magnitudes of strain and stress over the bar, with the sign of the fan.
fn profile(initial_fan: &InitialFan, length: f64, time: f64, value: impl Fn(f64, f64) -> f64) -> Shape {
    let mut edges: Vec<f64> =
        initial_fan.fan.edges.iter().map(|e| initial_fan.x + initial_fan.direction * e.speed * time).collect();
    edges.retain(|x| (0.0..length).contains(x));
    edges.sort_by(f64::total_cmp);
    let borders = std::iter::once(0.0).chain(edges.iter().copied());
    let middles = borders.zip(edges.iter().copied().chain([length])).map(|(a, b)| 0.5 * (a + b));
    let at = |x: f64| {
        let (strain, stress, _) = initial_fan.fan.state((x - initial_fan.x).abs() / time);
        initial_fan.sense.sign() * value(strain, stress)
    };
    let values = middles.map(at).collect();
    Shape::Steps { edges, values, ends: [0.0, length] }
}

/// Returns the stress over time at a position.
fn similar_history(initial_fan: &InitialFan, x: f64, until: f64) -> Shape {
    let distance = (x - initial_fan.x).abs();
    let passing = initial_fan.fan.edges.iter().filter(|e| e.speed > 0.0 && distance <= e.speed * until);
    let (mut edges, mut values) = (Vec::new(), vec![0.0]);
    for edge in passing {
        edges.push(distance / edge.speed);
        values.push(initial_fan.sense.sign() * edge.stress_behind);
    }
    Shape::Steps { edges, values, ends: [0.0, until] }
}
