//! Figures of inverted stress-strain curves.

use super::axis::Axis;
use super::drawing::{Picture, Stroke};
use super::grid::{area, document, panel};
use super::panel::Series;
use super::plot::colour;
use crate::material::Curve;
use crate::study::invert::hopkinson::{Knot, Moment, Reduced};
use crate::study::invert::{Interval, WavePoint};
use crate::units::{Dimension, Scale, System};

const PERCENT: f64 = 100.0;
const US: f64 = 1e6;

type Points = Vec<(f64, f64)>;

fn solid(i: usize) -> Stroke {
    Stroke::new(colour(i), 1.8)
}

fn stress_label(unit: Scale) -> String {
    format!("engineering stress ({})", unit.symbol)
}

/// Returns the lines of a quantity against strain and of its 95 % interval.
fn banded(name: &str, points: &[WavePoint], of: fn(&WavePoint) -> Interval, unit: Scale) -> Vec<Series> {
    let line = |bound: fn(Interval) -> f64| -> Points {
        points.iter().map(|p| (PERCENT * p.strain, unit.of(bound(of(p))))).collect()
    };
    let thin = || Stroke::new(colour(0), 1.0).dashed("5 3");
    vec![
        Series::line(name, line(|i| i.value), solid(0)),
        Series::line("95 % interval", line(|i| i.low), thin()),
        Series::line("", line(|i| i.high), thin()),
    ]
}

/// Returns the knots of a curve below a strain, and its point at that strain.
fn knots(curve: &Curve, last: f64, unit: Scale) -> Points {
    let inside = curve.strain().iter().zip(curve.stress()).filter(|(e, _)| **e < last);
    let end = (PERCENT * last, unit.of(curve.stress_at(last)));
    inside.map(|(e, s)| (PERCENT * e, unit.of(*s))).chain([end]).collect()
}

fn simulated(given: Option<&Curve>, last: f64, stress: Scale) -> Option<Series> {
    given.map(|curve| {
        Series::line("simulated curve", knots(curve, last.min(curve.last_strain()), stress), solid(1).dashed("2 3"))
    })
}

/// Draws stress, wave speed and impact velocity against strain with their 95 % intervals, and the relative uncertainty of the stress.
pub fn waves(title: &str, points: &[WavePoint], given: Option<&Curve>, units: System) -> Picture {
    const STRAIN: &str = "engineering strain (%)";
    let last = points.last().map_or(0.0, |p| p.strain);
    let [stress_unit, unit] = [Dimension::Stress, Dimension::Velocity].map(|dimension| units.of_columns(dimension));
    let mut stress = banded("inverted", points, |p| p.stress_pa, stress_unit);
    stress.extend(simulated(given, last, stress_unit));
    let start = Axis::around(STRAIN, [0.0, PERCENT * last].into_iter()).label;
    document(title, [2, 2], |drawing| {
        panel(drawing, area(0, 0), "(a)  stress", [&start, &stress_label(stress_unit)], &stress);
        let speed = banded("inverted", points, |p| p.wave_speed_m_s, unit);
        panel(drawing, area(1, 0), "(b)  wave speed", [STRAIN, &format!("wave speed ({})", unit.symbol)], &speed);
        let velocity = banded("inverted", points, |p| p.velocity_m_s, unit);
        panel(
            drawing,
            area(0, 1),
            "(c)  impact velocity",
            [STRAIN, &format!("impact velocity ({})", unit.symbol)],
            &velocity,
        );
        let half =
            |p: &WavePoint| (PERCENT * p.strain, 50.0 * (p.stress_pa.high - p.stress_pa.low) / p.stress_pa.value);
        let relative = vec![Series::line("", points.iter().map(half).collect(), solid(0))];
        panel(drawing, area(1, 1), "(d)  uncertainty", [STRAIN, "half 95 % interval of stress (%)"], &relative);
    })
}

/// Draws the pulses, stresses, strain rates and the curve of a split-Hopkinson test.
pub fn hopkinson(title: &str, reduced: &Reduced, given: Option<&Curve>, units: System) -> Picture {
    const TIME: &str = "time since the pulse reached the specimen (\u{b5}s)";
    let unit = units.of_columns(Dimension::Stress);
    let history = |name: &str, i: usize, factor: f64, of: fn(&Moment) -> f64| {
        Series::line(name, reduced.moments.iter().map(|m| (US * m.time_s, factor * of(m))).collect(), solid(i))
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
            history("face at the incident bar", 0, 1.0 / unit.si, |m| m.stress_incident_face),
            history("face at the transmission bar (one wave)", 2, 1.0 / unit.si, |m| m.stress_one_wave),
            history("mean (three waves)", 6, 1.0 / unit.si, |m| m.stress),
        ];
        panel(drawing, area(1, 0), "(b)  stress of the specimen", [TIME, &stress_label(unit)], &forces);
        let rates = [history("three waves", 6, 1.0, |m| m.rate), history("one wave", 2, 1.0, |m| m.rate_one_wave)];
        panel(drawing, area(0, 1), "(c)  strain rate", [TIME, "strain rate (1/s)"], &rates);
        panel(
            drawing,
            area(1, 1),
            "(d)  curve",
            ["engineering strain (%)", &stress_label(unit)],
            &curve(reduced, given, unit),
        );
    })
}

fn curve(reduced: &Reduced, given: Option<&Curve>, unit: Scale) -> Vec<Series> {
    let moments = reduced.moments.iter();
    let thin = Stroke::new("#999", 0.8);
    let raw = moments.map(|m| (PERCENT * m.strain, unit.of(m.stress))).collect();
    let line = |bound: fn(&Knot) -> f64| -> Points {
        reduced.curve.iter().map(|k| (PERCENT * k.strain, unit.of(bound(k)))).collect()
    };
    let bound = || Stroke::new(colour(0), 1.0).dashed("5 3");
    let last = reduced.curve.last().map_or(0.0, |k| k.strain);
    let mut series = vec![
        Series::line("three waves", raw, thin),
        Series::line("in equilibrium", line(|k| k.stress), solid(0)),
        Series::line("95 % interval", line(|k| k.stress - k.half_width), bound()),
        Series::line("", line(|k| k.stress + k.half_width), bound()),
    ];
    series.extend(simulated(given, last, unit));
    series
}
