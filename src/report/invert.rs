//! Figures of inverted curves.

use super::axis::Axis;
use super::drawing::{Picture, Stroke};
use super::grid::{area, document, panel};
use super::panel::Series;
use super::plot::colour;
use crate::material::Curve;
use crate::study::invert::hopkinson::{Knot, Moment, Reduced};
use crate::study::invert::{Interval, WavePoint};

const MPA: f64 = 1e-6;
const PERCENT: f64 = 100.0;
const US: f64 = 1e6;

type Points = Vec<(f64, f64)>;

fn solid(i: usize) -> Stroke {
    Stroke::new(colour(i), 1.8)
}

/// A quantity against strain with its 95 % interval.
fn banded(name: &str, points: &[WavePoint], of: fn(&WavePoint) -> Interval, unit: f64) -> Vec<Series> {
    let line = |bound: fn(Interval) -> f64| -> Points {
        points.iter().map(|p| (PERCENT * p.strain, unit * bound(of(p)))).collect()
    };
    let thin = || Stroke::new(colour(0), 1.0).dashed("5 3");
    vec![
        Series::line(name, line(|i| i.value), solid(0)),
        Series::line("95 % interval", line(|i| i.low), thin()),
        Series::line("", line(|i| i.high), thin()),
    ]
}

/// The knots of a curve up to a strain.
fn knots(curve: &Curve, last: f64) -> Points {
    let inside = curve.strain().iter().zip(curve.stress()).filter(|(e, _)| **e < last);
    let end = (PERCENT * last, MPA * curve.stress_at(last));
    inside.map(|(e, s)| (PERCENT * e, MPA * s)).chain([end]).collect()
}

fn simulated(given: Option<&Curve>, last: f64) -> Option<Series> {
    given.map(|curve| {
        Series::line("simulated curve", knots(curve, last.min(curve.last_strain())), solid(1).dashed("2 3"))
    })
}

/// Stress, wave speed and impact velocity against strain, with their intervals. SVG text.
pub fn waves(title: &str, points: &[WavePoint], given: Option<&Curve>) -> Picture {
    const STRAIN: &str = "engineering strain (%)";
    let last = points.last().map_or(0.0, |p| p.strain);
    let mut stress = banded("inverted", points, |p| p.stress_pa, MPA);
    stress.extend(simulated(given, last));
    let start = Axis::around(STRAIN, [0.0, PERCENT * last].into_iter()).label;
    document(title, [2, 2], |drawing| {
        panel(drawing, area(0, 0), "(a)  stress", [&start, "engineering stress (MPa)"], &stress);
        let speed = banded("inverted", points, |p| p.wave_speed_m_s, 1.0);
        panel(drawing, area(1, 0), "(b)  wave speed", [STRAIN, "wave speed (m/s)"], &speed);
        let velocity = banded("inverted", points, |p| p.velocity_m_s, 1.0);
        panel(drawing, area(0, 1), "(c)  impact velocity", [STRAIN, "impact velocity (m/s)"], &velocity);
        let half =
            |p: &WavePoint| (PERCENT * p.strain, 50.0 * (p.stress_pa.high - p.stress_pa.low) / p.stress_pa.value);
        let relative = vec![Series::line("", points.iter().map(half).collect(), solid(0))];
        panel(drawing, area(1, 1), "(d)  uncertainty", [STRAIN, "half 95 % interval of stress (%)"], &relative);
    })
}

/// Pulses, stresses, strain rates and the curve of a split-Hopkinson test. SVG text.
pub fn hopkinson(title: &str, reduced: &Reduced, given: Option<&Curve>) -> Picture {
    const TIME: &str = "time since the pulse reached the specimen (\u{b5}s)";
    let history = |name: &str, i: usize, unit: f64, of: fn(&Moment) -> f64| {
        Series::line(name, reduced.moments.iter().map(|m| (US * m.time_s, unit * of(m))).collect(), solid(i))
    };
    document(title, [2, 2], |drawing| {
        let pulses = [
            history("incident", 0, 1e3, |m| m.incident),
            history("reflected", 1, 1e3, |m| m.reflected),
            history("transmitted", 2, 1e3, |m| m.transmitted),
        ];
        panel(
            drawing,
            area(0, 0),
            "(a)  pulses at the specimen",
            [TIME, "strain of the bars (10\u{207b}\u{b3})"],
            &pulses,
        );
        let forces = [
            history("face at the incident bar", 0, MPA, |m| m.stress_incident_face),
            history("face at the transmission bar (one wave)", 2, MPA, |m| m.stress_one_wave),
            history("mean (three waves)", 6, MPA, |m| m.stress),
        ];
        panel(drawing, area(1, 0), "(b)  stress of the specimen", [TIME, "engineering stress (MPa)"], &forces);
        let rates = [history("three waves", 6, 1.0, |m| m.rate), history("one wave", 2, 1.0, |m| m.rate_one_wave)];
        panel(drawing, area(0, 1), "(c)  strain rate", [TIME, "strain rate (1/s)"], &rates);
        panel(
            drawing,
            area(1, 1),
            "(d)  curve",
            ["engineering strain (%)", "engineering stress (MPa)"],
            &curve(reduced, given),
        );
    })
}

fn curve(reduced: &Reduced, given: Option<&Curve>) -> Vec<Series> {
    let moments = reduced.moments.iter();
    let thin = Stroke::new("#999", 0.8);
    let raw = moments.map(|m| (PERCENT * m.strain, MPA * m.stress)).collect();
    let line = |bound: fn(&Knot) -> f64| -> Points {
        reduced.curve.iter().map(|k| (PERCENT * k.strain, MPA * bound(k))).collect()
    };
    let bound = || Stroke::new(colour(0), 1.0).dashed("5 3");
    let last = reduced.curve.last().map_or(0.0, |k| k.strain);
    let mut series = vec![
        Series::line("three waves", raw, thin),
        Series::line("in equilibrium", line(|k| k.stress), solid(0)),
        Series::line("95 % interval", line(|k| k.stress - k.half_width), bound()),
        Series::line("", line(|k| k.stress + k.half_width), bound()),
    ];
    series.extend(simulated(given, last));
    series
}
