//! Growth of time and memory with the number of cells, the end time and the number of knots of the curves.

use std::sync::Arc;

use serde::Serialize;

use super::CostPoint;
use super::bench::memory;
use super::judge::exponent;
use super::measure::{self, Wanted, Watch};
use super::refinement::Halt;
use super::source::{Family, Resolution, Source};
use crate::error::Result;
use crate::material::Curve;
use crate::scene::Scene;

/// Resolutions at which the growth with the end time and with the knots is measured.
const CELLS: usize = 800;
const TOLERANCE: f64 = 1e-2;

/// Fractions of the end time, and numbers of knots of the curve.
const TIMES: [f64; 4] = [0.125, 0.25, 0.5, 1.0];
const KNOTS: [usize; 5] = [4, 8, 16, 32, 64];
/// Fewest and most runs of each variant, and the total time after which no further run is started (s). The shortest time is used, because growth is a
/// property of the work and not of the load of the machine.
const LEAST_PASSES: usize = 3;
const MOST_PASSES: usize = 41;
const PASSES_FOR: f64 = 0.05;

/// Growth of time and memory of one method with one quantity.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Growth {
    /// "fd" or "moc".
    pub method: String,
    /// "leapfrog", ...
    pub scheme: String,
    /// Quantity that varies: "cells", "`front_tolerance`", "`end_time`" or "knots".
    pub with: &'static str,
    /// Quantities that are kept constant.
    pub at: String,
    /// Values of the quantity (end time in s).
    pub values: Vec<f64>,
    /// Stepping times, s.
    pub step_wall_s: Vec<f64>,
    /// Solver memory, bytes.
    pub memory_bytes: Vec<f64>,
    /// Exponent a of time ~ value^a by least squares of logarithms; null for fewer than two values.
    pub time_exponent: Option<f64>,
    /// Exponent of the memory, likewise.
    pub memory_exponent: Option<f64>,
}

/// Creates the growth of a method from runs of (value, stepping time in s, memory in bytes).
fn row(family: &Family, with: &'static str, at: String, runs: &[(f64, f64, f64)]) -> Growth {
    let fit = |y: &dyn Fn(&(f64, f64, f64)) -> f64| exponent(&runs.iter().map(|r| (r.0, y(r))).collect::<Vec<_>>());
    Growth {
        method: family.names[0].into(),
        scheme: family.names[1].into(),
        with,
        at,
        values: runs.iter().map(|r| r.0).collect(),
        step_wall_s: runs.iter().map(|r| r.1).collect(),
        memory_bytes: runs.iter().map(|r| r.2).collect(),
        time_exponent: fit(&|r| r.1),
        memory_exponent: fit(&|r| r.2),
    }
}

/// Returns the growth with the resolution, from the finer half of the points of the refinement, in which fixed costs are negligible. `None` for fewer
/// than two points.
pub(super) fn with_resolution(family: &Family, points: &[&CostPoint], until: f64) -> Option<Growth> {
    let kept = &points[points.len() / 2..];
    let (with, value): (_, fn(&CostPoint) -> f64) = match family.levels[0] {
        Resolution::Cells(_) => ("cells", |p| p.by.cells.unwrap_or(0) as f64),
        Resolution::FrontTolerance(_) => ("front_tolerance", |p| p.by.front_tolerance.unwrap_or(0.0)),
    };
    let runs: Vec<_> =
        kept.iter().filter(|p| value(p) > 0.0).map(|p| (value(p), p.step_wall_s, p.memory_bytes as f64)).collect();
    (runs.len() > 1).then(|| row(family, with, format!("until {until:.4e} s"), &runs))
}

/// Measures the growth of one method with the end time and with the knots. Values for which the time is not sufficient are omitted.
pub(super) fn with_time_and_knots(
    source: &Source<'_>,
    family: &Family,
    watch: &mut Watch<'_>,
) -> Result<std::result::Result<Vec<Growth>, Halt>> {
    let (resolution, still) = match family.levels[0] {
        Resolution::Cells(_) => (Resolution::Cells(CELLS), format!("{CELLS} cells")),
        Resolution::FrontTolerance(_) => {
            (Resolution::FrontTolerance(TOLERANCE), format!("front-tolerance {TOLERANCE}"))
        }
    };
    let scene = source.at(family.choice, resolution)?;
    let mut rows = Vec::new();
    watch.what = format!("growth of {} with the end time", family.names[1]);
    let times = TIMES.map(|part| {
        let mut shorter = scene.clone();
        shorter.parts.solve.until *= part;
        (shorter.parts.solve.until, shorter)
    });
    let curves = KNOTS.map(|knots| Some((knots as f64, with_knots(&scene, knots)?)));
    let curves: Vec<(f64, Scene)> = curves.into_iter().flatten().collect();
    let parabolas = format!("{still}; parabolas between the yield point and the last knot");
    for (with, scenes, still) in [("end_time", times.as_slice(), still), ("knots", &curves, parabolas)] {
        watch.what = format!("growth of {} with {}", family.names[1], with.replace('_', " "));
        let mut runs = Vec::new();
        for (value, scene) in scenes {
            match timed(scene, watch) {
                Ok((seconds, bytes)) => runs.push((*value, seconds, bytes)),
                Err(Halt::Failed(_) | Halt::OutOfTime) => break,
                Err(halt) => return Ok(Err(halt)),
            }
        }
        if runs.len() > 1 {
            rows.push(row(family, with, still, &runs));
        }
    }
    Ok(Ok(rows))
}

fn timed(scene: &Scene, watch: &mut Watch<'_>) -> std::result::Result<(f64, f64), Halt> {
    let (mut shortest, mut bytes) = (f64::INFINITY, 0.0);
    let (mut passes, mut together) = (0, 0.0);
    while passes < LEAST_PASSES || (passes < MOST_PASSES && together < PASSES_FOR) {
        passes += 1;
        let pass = measure::pass(scene, Wanted::TIME, watch)?;
        together += pass.seconds;
        shortest = shortest.min(pass.seconds);
        bytes = memory(scene, &pass) as f64;
        watch.look()?;
    }
    Ok((shortest, bytes))
}

/// Returns the scene with every curve replaced by a parabola with `knots` knots between its yield point and its largest stress, or `None` if a curve
/// is a straight line.
fn with_knots(scene: &Scene, knots: usize) -> Option<Scene> {
    let mut scene = scene.clone();
    for segment in &mut scene.parts.bar.segments {
        let mut material = (*segment.material).clone();
        material.tension = parabola(&material.tension, material.modulus, knots)?;
        if let Some(compression) = &material.compression {
            material.compression = Some(parabola(compression, material.modulus, knots)?);
        }
        segment.material = Arc::new(material);
    }
    Some(scene)
}

/// Returns a curve whose stress increases as the square root of the strain beyond the elastic limit, at first at most as steeply as the elastic line.
fn parabola(curve: &Curve, modulus: f64, knots: usize) -> Option<Curve> {
    let (strain, stress) = curve.elastic_limit(modulus);
    let top = curve.stress().iter().copied().fold(0.0, f64::max);
    let last = curve.last_strain();
    if !(last > strain && top > stress) {
        return None;
    }
    let pieces = knots - 1;
    let part = |k: usize| (k as f64 / pieces as f64).powi(2);
    let mut rows = vec![(strain, stress)];
    for k in 1..=pieces {
        let e = strain + part(k) * (last - strain);
        let s = stress + (k as f64 / pieces as f64) * (top - stress);
        let (before, at) = rows[rows.len() - 1];
        rows.push((e, s.min(at + modulus * (e - before))));
    }
    Curve::new(&rows, curve.beyond()).ok()
}
