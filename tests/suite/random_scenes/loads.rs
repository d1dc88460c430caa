//! Loads of ends and joints as in the summary: methods agree on largest forces, impulses and contact times.

use std::ops::ControlFlow;
use std::path::Path;

use barwave::record::{Summary, Trace};
use barwave::run::{run, solve};
use barwave::scene::Scene;

use super::checks::{Failure, RESOLVED, driven_beyond, figures_of};
use super::spec::{MAX_EVENTS, Method, Spec, Value};

/// Approximate number of cells of grids, and front tolerance and event limit of front tracking.
const CELLS: usize = 800;
const FRONT_TOLERANCE: f64 = 1e-3;
const EVENTS: u64 = 200_000;
/// Factor of refinement, with which a difference must decrease to this fraction, or be small.
const FINER: usize = 4;
const FALLS: f64 = 0.72;
/// Allowed difference of two loads relative to the larger one, or to this fraction of the largest load of the same kind in the bar.
const AGREE: f64 = 0.15;
const SMALL: f64 = 0.2;
/// Allowed difference at ends of bars of several segments: see `a_pulse_of_a_joint_that_yields_adds_to_the_peak_at_an_elastic_end`.
const PULSE: f64 = 0.6;

/// Peaks are those of stress without an area, and in torsion.
const KINDS: [&[&str]; 3] = [&["peak_force", "peak_stress"], &["impulse", "impulse_per_area"], &["contact_duration"]];

/// Fraction of the run after which peaks are not compared.
const ENDS: f64 = 0.95;
/// Fraction of the largest force below which that of a light striker remains for long. The time with a larger force agrees, although the contact time
/// does not, since grids are in contact in some steps only.
const PRESSES: f64 = 1e-3;
/// Cell size of the finer grid, relative to a segment if there are two.
const THIN: f64 = 2.0 / (CELLS * FINER) as f64;
/// Loads that count as zero: N or Pa, N s, and fractions of the time of the run. An end that no wave has reached has rounding, which may cause
/// contact.
const ROUNDING: [f64; 3] = [1e-3, 1e-6, 0.01];

/// Loads by place and kind: N or Pa, N s, and fractions of the time of the run.
type Loads = Vec<(Vec<String>, usize, f64)>;

/// Returns the run of a method with `by` times as many cells, or `None` if it stops.
fn summary(spec: &Spec, method: Method, by: usize) -> Option<(Scene, Summary)> {
    let scene = scene(spec, method, by)?;
    let summary = run(&scene, None, &mut |_| ControlFlow::Continue(())).ok()?;
    Some((scene, summary))
}

/// Returns the loads of the run with finer cells; and the same with the times above [`PRESSES`] of the largest force instead of contact times at
/// ends.
fn finer(spec: &Spec, method: Method) -> Option<[Loads; 2]> {
    let scene = scene(spec, method, FINER)?;
    let solution = solve(&scene, &mut |_| ControlFlow::Continue(())).ok()?;
    let all = loads(&scene, &solution.summary);
    let mut pressed = all.clone();
    for (place, kind, time) in &mut pressed {
        let end = ["left", "right"].iter().position(|end| place[..] == [*end]);
        if let Some(end) = end.filter(|_| *kind == 2) {
            *time = time_pressed(&solution.ends[end]) / scene.solve.until;
        }
    }
    Some([all, pressed])
}

/// Returns the time with more than [`PRESSES`] of the largest force, s.
fn time_pressed(Trace { time, stress, .. }: &Trace) -> f64 {
    let largest = stress.iter().fold(0.0, |largest: f64, stress| largest.max(-stress));
    let steps = time.windows(2).zip(stress.windows(2));
    steps
        .filter(|(_, stress)| -0.5 * (stress[0] + stress[1]) > PRESSES * largest)
        .map(|(time, _)| time[1] - time[0])
        .sum()
}

fn scene(spec: &Spec, method: Method, by: usize) -> Option<Scene> {
    let cells = by * CELLS.div_ceil(spec.cells);
    let tolerance = FRONT_TOLERANCE / by as f64;
    // With smaller Courant numbers, leapfrog oscillates behind sharp elastic waves by a quarter of them.
    let spec = Spec { front_tolerance: tolerance, cfl: 1.0, ..spec.clone() };
    let tracks = method == Method::Moc && !spec.has_effect("rate");
    let text = spec.text(method, if tracks { 1 } else { cells });
    let text = text.replace(&format!("max-events = {MAX_EVENTS}"), &format!("max-events = {EVENTS}"));
    Scene::parse("loads.toml", &text, Path::new("."), &[]).ok()
}

fn loads(scene: &Scene, summary: &Summary) -> Loads {
    let mut loads = Loads::new();
    for group in &summary.figures.0 {
        for (kind, names) in KINDS.iter().enumerate() {
            let figure = |names: &[&str]| group.figures.iter().find(|figure| names.contains(&figure.name));
            // A load that still increases at the end depends on the end time, which may differ by a step.
            let grows = figure(&["time_of_peak"]).is_some_and(|time| time.value > ENDS * scene.solve.until);
            let unresolved = kind == 0 && grows;
            if let Some(load) = figure(names).filter(|_| !unresolved) {
                let unit = if kind == 2 { scene.solve.until } else { 1.0 };
                loads.push((group.path.clone(), kind, load.value.abs() / unit));
            }
        }
    }
    loads
}

fn worst(a: &Loads, b: &Loads, segments: usize) -> (f64, String) {
    let mut worst = (0.0, String::new());
    for (place, kind, own) in a {
        let Some((.., other)) = b.iter().find(|load| load.0 == *place && load.1 == *kind) else { continue };
        let largest =
            a.iter().chain(b).filter(|load| load.1 == *kind).map(|load| load.2).fold(ROUNDING[*kind], f64::max);
        let at_end = place[0] != "joints" && segments > 1;
        let agree = if at_end && *kind == 0 { PULSE } else { AGREE };
        let allowed = agree * own.max(*other).max(SMALL * largest);
        if (own - other).abs() > worst.0 * allowed {
            worst =
                ((own - other).abs() / allowed, format!("{} {}: {own:e} {other:e}", place.join(" "), KINDS[*kind][0]));
        }
    }
    worst
}

/// Returns true if rows of an initial state are closer than [`THIN`], but distinct.
fn has_thin_layer(spec: &Spec) -> bool {
    let is_thin = |value: &Value| match value {
        Value::Along(rows, length) | Value::SignedAlong(rows, length) => {
            rows.windows(2).map(|pair| pair[1].0 - pair[0].0).any(|gap| gap > 0.0 && gap < THIN * length)
        }
        _ => false,
    };
    spec.segments.iter().flatten().any(|(_, value)| is_thin(value))
}

/// Returns the loads on which two methods disagree, and do not converge to each other with finer cells.
pub fn disagree(spec: &Spec) -> Vec<(Method, Failure)> {
    // The time and position of a fracture depend on the resolution; for falling curves see tests/suite/muscl_bounds.rs. A layer of an initial state
    // thinner than a cell is averaged: see `a_thin_layer_of_initial_strain_is_lost_on_a_grid`.
    let unresolved =
        spec.has_effect("rupture") || spec.has_falling_curve() || driven_beyond(spec) || has_thin_layer(spec);
    if unresolved || spec.effects.is_none() {
        return Vec::new();
    }
    let is_slow = |summary: &Summary| {
        let strain = summary.figures.get(&[], "largest_plastic_strain").unwrap_or(0.0);
        summary.outcome != "done" || summary.above_critical || strain > RESOLVED
    };
    let done: Vec<_> = Method::ALL.into_iter().filter_map(|method| Some((method, summary(spec, method, 1)?))).collect();
    // Strain concentrated at a point unloads on a grid only, see `what_gathers_at_a_place_comes_back_on_a_grid_alone`.
    let gathers = |method: Method| figures_of(&spec.text(method, 1)).is_some_and(|figures| figures.gathers);
    if done.iter().any(|(method, (_, summary))| is_slow(summary) || gathers(*method)) {
        return Vec::new();
    }
    let mut failures = Vec::new();
    for pair in done.windows(2) {
        let [a, b] = [&pair[0], &pair[1]];
        let (size, _) = worst(&loads(&a.1.0, &a.1.1), &loads(&b.1.0, &b.1.1), spec.segments.len());
        if size <= 1.0 {
            continue;
        }
        let [Some(finer_a), Some(finer_b)] = [a.0, b.0].map(|method| finer(spec, method)) else { continue };
        let pairs = finer_a.iter().zip(&finer_b);
        let least = pairs.map(|(a, b)| worst(a, b, spec.segments.len())).min_by(|a, b| a.0.total_cmp(&b.0));
        let Some((finer, place)) = least else { continue };
        if finer > 1.0 && finer > FALLS * size {
            failures.push((b.0, Failure::new("methods disagree on a load", format!("{place}; {:?}", a.0))));
        }
    }
    failures
}
