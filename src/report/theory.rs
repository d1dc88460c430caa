//! Panels that compare a run with theory: front speeds, the self-similar solution, and the path in the stress-strain plane.

use super::axis::Axis;
use super::drawing::{Stroke, THEORY};
use super::panel::{LinePanel, Series};
use super::plot::colour;
use super::profiles;
use super::view::{View, nearest};
use crate::error::Result;
use crate::record::{Field, FrontRow};

/// Returns the speed of every front against the strains ahead of it and behind it: theory as steps, measured speeds as circles at the mean strain.
pub(super) fn speeds(view: &View) -> Result<Option<LinePanel>> {
    let fronts = view.theory_fronts()?;
    if fronts.is_empty() {
        return Ok(None);
    }
    let unit = view.units.velocity();
    let step = |f: &FrontRow| {
        let speed = f.speed.abs() * unit.factor;
        [(f.strain_ahead, speed), (f.strain_behind, speed), (f.strain_behind, f64::NAN)]
    };
    let middle = |f: &FrontRow| (0.5 * (f.strain_ahead + f.strain_behind), f.speed_measured.abs() * unit.factor);
    let mut series =
        vec![Series::line(view.theory(), fronts.iter().flat_map(step).collect(), Stroke::new(colour(0), 2.2))];
    let measured: Vec<(f64, f64)> = fronts.iter().map(middle).filter(|p| p.1.is_finite()).collect();
    if !measured.is_empty() {
        series.push(Series::marks("measured in the fields", measured, Stroke::new(colour(1), 1.6)));
    }
    let x = Axis::around("strain", fronts.iter().flat_map(|f| [f.strain_ahead, f.strain_behind]));
    let speeds = series.iter().flat_map(|s| s.points.iter().map(|p| p.1));
    let y = Axis::logarithmic_around(unit.label("front speed"), speeds);
    Ok(Some(LinePanel { heading: "speed of the fronts".into(), x, y, series }))
}

/// Returns the style of theoretical lines: broad and pale, below the simulated ones.
fn broad() -> Stroke {
    Stroke::new(THEORY, 5.0).opacity(0.45)
}

/// Returns the style of the curve of the i-th material: each has its own tint.
fn of_material(i: usize) -> Stroke {
    const TINTS: [&str; 4] = [THEORY, "#b8860b", "#4682b4", "#6b8e23"];
    Stroke { colour: TINTS[i % TINTS.len()].into(), ..broad() }
}

/// Number of times in the self-similar panel.
const SIMILAR: usize = 3;

/// Returns the field against x/t: in a fan from one end, the curves of all times coincide, and theory gives them for strain and stress. Shows
/// the strain if it is recorded, unless a field was requested. Returns `None` without a fan from an end.
pub(super) fn similarity(view: &View) -> Result<Option<LinePanel>> {
    let fronts = view.theory_fronts()?;
    let Some(side) = ["left", "right"].into_iter().find(|side| fronts.iter().any(|f| f.origin == *side)) else {
        return Ok(None);
    };
    let mut fan: Vec<&FrontRow> = fronts.iter().filter(|f| f.origin == side).collect();
    fan.sort_by(|a, b| a.speed.abs().total_cmp(&b.speed.abs()));
    let field = if !view.asked && view.file.fields().contains(&Field::Strain) { Field::Strain } else { view.field };
    let unit = view.units.velocity();
    // Up to the first interaction of a front with another wave, or the first later change of the load, which theory does not include.
    let bounds = fan.iter().flat_map(|f| [f.last_seen, f.load_held_until]);
    let until = bounds.filter(|t| t.is_finite()).fold(view.end_time, f64::min);
    let last = 1.15 * fan.last().map_or(0.0, |f| f.speed.abs()) * unit.factor;
    let mut frames: Vec<usize> =
        (1..=SIMILAR).map(|i| nearest(&view.time, until * i as f64 / SIMILAR as f64)).collect();
    frames.dedup();
    frames.retain(|&i| view.time[i] > 0.0 && view.time[i] <= until * (1.0 + 1e-9));
    if frames.is_empty() || last == 0.0 {
        return Ok(None);
    }
    let theory = fan_of_theory(field, &fan, last, unit.factor, view.units.field(field).factor);
    let mut series: Vec<Series> =
        theory.map(|points| Series::line(view.theory(), points, broad())).into_iter().collect();
    for (number, &frame) in frames.iter().enumerate() {
        series.push(over_speed(view, field, side, frame, last)?.styled(profiles::stroke(number, frames.len())));
    }
    let name = view.name_of(field);
    let (heading, label) = if side == "left" {
        (format!("{name} over x/t"), "x/t")
    } else {
        (format!("{name} over (L \u{2212} x)/t"), "(L \u{2212} x)/t")
    };
    let limits: Vec<f64> = series.iter().flat_map(|s| view.limits(&s.points)).collect();
    let y = Axis::around(view.units.field(field).label(name), limits.into_iter().chain(View::zero(field)));
    Ok(Some(LinePanel { heading, x: Axis::new(unit.label(label), 0.0, last), y, series }))
}

/// Returns a frame of the field against the distance from the end divided by time.
fn over_speed(view: &View, field: Field, side: &str, frame: usize, last: f64) -> Result<Series> {
    let (time, factor) = (view.time[frame], view.units.field(field).factor);
    let values = view.file.field(field, frame..frame + 1)?;
    let speed = |x: &f64| if side == "left" { x / time } else { (view.length - x) / time };
    let points = view.x.iter().zip(values.row(0)).map(|(x, v)| (speed(x) * view.units.velocity().factor, v * factor));
    let points: Vec<(f64, f64)> = points.filter(|p| p.0 <= last).collect();
    Ok(Series::line(view.time_unit().brief(time), points, Stroke::new(THEORY, 1.6)))
}

/// Returns the theoretical field against x/t, constant between the fronts, which are sorted by speed; `None` unless it is strain or stress.
fn fan_of_theory(field: Field, fan: &[&FrontRow], last: f64, speed: f64, factor: f64) -> Option<Vec<(f64, f64)>> {
    let [behind, ahead]: [fn(&FrontRow) -> f64; 2] = match field {
        Field::Strain => [|f| f.strain_behind, |f| f.strain_ahead],
        Field::Stress => [|f| f.stress_behind, |f| f.stress_ahead],
        _ => return None,
    };
    let (first, fastest) = (fan.first()?, fan.last()?);
    let mut points = vec![(0.0, behind(first) * factor)];
    points.extend(fan.iter().flat_map(|f| [behind(f), ahead(f)].map(|v| (f.speed.abs() * speed, v * factor))));
    points.push((last, ahead(fastest) * factor));
    Some(points)
}

/// Returns stress against strain at the gauges (or at four positions along the bar), with the curves of the materials. A position whose state
/// does not change has no path.
pub(super) fn path(view: &View) -> Result<Option<LinePanel>> {
    let unit = view.units.stress();
    let paths = gauge_paths(view)?;
    let sampled = paths.is_empty();
    let (mut paths, heading) = if sampled {
        (sampled_paths(view)?, "states in the stress-strain plane, frame by frame")
    } else {
        (paths, "path in the stress-strain plane")
    };
    paths.retain(|(_, points)| points.windows(2).any(|pair| pair[0] != pair[1]));
    if paths.is_empty() {
        return Ok(None);
    }
    let mut series: Vec<Series> = Vec::new();
    let lines = paths.into_iter().enumerate().map(|(i, (name, points))| {
        let points = points.into_iter().map(|(strain, stress)| (strain, stress * unit.factor)).collect();
        // Between two frames, the state may follow any path.
        let series = if sampled { Series::marks } else { Series::line };
        series(name, points, Stroke::new(colour(i), 1.6))
    });
    series.extend(lines);
    let x = Axis::around("strain", series.iter().flat_map(|s| s.points.iter().map(|p| p.0)).chain([0.0]));
    let limits: Vec<f64> = series.iter().flat_map(|s| view.limits(&s.points)).collect();
    let y = Axis::around(unit.label("stress"), limits.into_iter().chain([0.0]));
    for (i, material) in view.file.materials()?.iter().enumerate() {
        let [strain, stress] = &material.compression;
        let compression = strain.iter().zip(stress).rev().map(|(e, s)| (-e, -s * unit.factor));
        let [strain, stress] = &material.tension;
        let tension = strain.iter().zip(stress).map(|(e, s)| (*e, s * unit.factor));
        let curve: Vec<(f64, f64)> = compression.chain(tension).collect();
        let name = format!("curve of {}", material.name);
        series.insert(0, Series::line(name, within(&curve, &x, &y), of_material(i)));
    }
    Ok(Some(LinePanel { heading: heading.into(), x, y, series }))
}

type Path = (String, Vec<(f64, f64)>);

fn gauge_paths(view: &View) -> Result<Vec<Path>> {
    let path = |gauge: crate::record::store::Gauge| {
        let points: Vec<(f64, f64)> =
            gauge.trace.strain.iter().copied().zip(gauge.trace.stress.iter().copied()).collect();
        (gauge.name, points)
    };
    Ok(view.file.gauges()?.into_iter().map(path).collect())
}

/// Returns the states at the left end, at a quarter, in the middle and at the right end of the bar, frame by frame.
fn sampled_paths(view: &View) -> Result<Vec<Path>> {
    let fields = view.file.fields();
    if !(fields.contains(&Field::Stress) && fields.contains(&Field::Strain)) {
        return Ok(Vec::new());
    }
    let mut samples = [0.0, 0.25, 0.5, 1.0].map(|part| nearest(&view.x, part * view.length)).to_vec();
    samples.dedup();
    let (strain, stress) = (view.columns(Field::Strain, &samples)?, view.columns(Field::Stress, &samples)?);
    let unit = view.length_unit();
    let path = |(k, &sample): (usize, &usize)| {
        let points = strain[k].iter().copied().zip(stress[k].iter().copied()).collect();
        (format!("x = {}", unit.brief(view.x[sample])), points)
    };
    Ok(samples.iter().enumerate().map(path).collect())
}

/// Returns the part of a curve inside the axes, with the points where it crosses their limits.
fn within(curve: &[(f64, f64)], x: &Axis, y: &Axis) -> Vec<(f64, f64)> {
    let mut kept = Vec::new();
    for pair in curve.windows(2) {
        let [a, b] = [pair[0], pair[1]];
        let (mut from, mut to) = (0.0_f64, 1.0_f64);
        for (start, end, low, high) in [(a.0, b.0, x.low, x.high), (a.1, b.1, y.low, y.high)] {
            let mut at = [(low - start) / (end - start), (high - start) / (end - start)];
            if end == start {
                at = if (low..=high).contains(&start) { [0.0, 1.0] } else { [2.0, 2.0] };
            }
            at.sort_by(f64::total_cmp);
            (from, to) = (from.max(at[0]), to.min(at[1]));
        }
        if from <= to {
            let at = |part: f64| (a.0 + part * (b.0 - a.0), a.1 + part * (b.1 - a.1));
            kept.extend([at(from), at(to)]);
        }
    }
    kept
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn curves_end_where_the_axes_do() {
        let curve = [(-1.0, -10.0), (0.0, 0.0), (1.0, 10.0), (3.0, 12.0)];
        let kept = within(&curve, &Axis::new("", -0.1, 2.0), &Axis::new("", -5.0, 20.0));
        // Crossings are exact only to rounding.
        let near = |found: (f64, f64), exact: (f64, f64)| (found.0 - exact.0).hypot(found.1 - exact.1) < 1e-12;
        assert!(near(kept[0], (-0.1, -1.0)) && near(kept[kept.len() - 1], (2.0, 11.0)), "{kept:?}");
        assert!(within(&curve, &Axis::new("", 5.0, 6.0), &Axis::new("", -5.0, 20.0)).is_empty());
    }

    #[test]
    fn the_theory_of_a_fan_is_a_staircase_from_slow_to_fast() {
        let front = |speed, behind, ahead| FrontRow {
            origin: "left".into(),
            strain_behind: behind,
            strain_ahead: ahead,
            stress_behind: 0.0,
            stress_ahead: 0.0,
            speed,
            speed_measured: f64::NAN,
            position: f64::NAN,
            last_seen: 1.0,
            load_held_until: f64::INFINITY,
            arrivals: Vec::new(),
        };
        let fan = [front(500.0, 0.02, 0.001), front(5000.0, 0.001, 0.0)];
        let line = fan_of_theory(Field::Strain, &[&fan[0], &fan[1]], 6000.0, 1.0, 1.0).expect("strain has a theory");
        let expected = [(0.0, 0.02), (500.0, 0.02), (500.0, 0.001), (5000.0, 0.001), (5000.0, 0.0), (6000.0, 0.0)];
        assert_eq!(line, expected);
        assert!(fan_of_theory(Field::Velocity, &[&fan[0]], 6000.0, 1.0, 1.0).is_none());
    }
}
