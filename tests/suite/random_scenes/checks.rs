//! Properties of any scene.

use std::any::Any;
use std::ops::ControlFlow;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;

use barwave::bar::EndCondition;
use barwave::error::{Error, RunError};
use barwave::law::Table;
use barwave::material::Sense;
use barwave::record::Summary;
use barwave::run::run;
use barwave::scene::Scene;
use barwave::solver::fd::Grid;

use super::spec::{MAX_EVENTS, Method, Spec};
use super::watch::{Figures, GIVES, Scaled, follow};

/// Property that does not hold.
#[derive(Debug, Clone)]
pub struct Failure {
    pub class: &'static str,
    pub detail: String,
}

impl Failure {
    pub fn new(class: &'static str, detail: String) -> Self {
        Self { class, detail }
    }
}

/// Result of a scene with one method.
pub enum Became {
    Refused,
    Stopped(String),
    Done(Box<Figures>),
}

/// Returns the first words of a reason, without its numbers.
fn without_figures(reason: &str) -> String {
    let words = reason.split_whitespace().filter(|word| !word.contains(|c: char| c.is_ascii_digit()));
    words.take(8).collect::<Vec<_>>().join(" ")
}

impl Became {
    pub fn word(&self) -> String {
        match self {
            Self::Refused => "refused".to_owned(),
            Self::Stopped(reason) => format!("stopped: {}", without_figures(reason)),
            Self::Done(_) => "done".to_owned(),
        }
    }

    fn figures(&self) -> Option<&Figures> {
        match self {
            Self::Done(figures) => Some(figures),
            _ => None,
        }
    }
}

/// Results of a scene with every method.
pub struct Checked {
    pub failures: Vec<(Method, Failure)>,
    pub became: Vec<(Method, Became)>,
}

pub fn check(spec: &Spec) -> Checked {
    let mut checked = Checked { failures: Vec::new(), became: Vec::new() };
    for method in Method::ALL {
        let (became, failures) = check_by(spec, method);
        checked.became.push((method, became));
        checked.failures.extend(failures.into_iter().map(|failure| (method, failure)));
    }
    let done: Vec<(Method, &Figures)> =
        checked.became.iter().filter_map(|(method, became)| Some((*method, became.figures()?))).collect();
    let slow = done.iter().any(|(_, figures)| figures.strain > RESOLVED);
    // The time and position at which a bar breaks, and the side of an end, depend on the resolution.
    // For falling curves see tests/suite/muscl_bounds.rs.
    let pairs = if slow || spec.has_effect("rupture") || spec.has_falling_curve() { &[][..] } else { &done };
    let disagree = pairs.windows(2).filter_map(|pair| Some((pair[0].0, methods_disagree(spec, pair)?)));
    let found: Vec<_> = disagree.chain(stops_alone(spec, &checked.became)).collect();
    checked.failures.extend(found);
    checked
}

/// Fractions of the strain at which one method stops that another method must reach, on the cells of the scene, or on much finer ones.
const NEAR: [f64; 2] = [0.5, 0.9];
/// Factors of refinement that show the largest strains of short loads, and of waves that converge; and the growth of a strain that is not resolved
/// yet.
const STILL_FINER: [usize; 3] = [16, 64, 256];
const GROWS: f64 = 1.5;

/// Returns the methods that stop at the end of the data, or in fully compressed material, although no other method comes near that strain, even on
/// finer cells.
fn stops_alone(spec: &Spec, became: &[(Method, Became)]) -> Vec<(Method, Failure)> {
    let done: Vec<_> = became.iter().filter_map(|(method, became)| Some((*method, became.figures()?))).collect();
    // Strain concentrated at a point depends on the cell size, and so does whether the bar breaks before its data end.
    if done.is_empty() || spec.has_effect("rupture") || done.iter().any(|(_, figures)| figures.gathers) {
        return Vec::new();
    }
    let comes_near = |limit: f64, &(by, figures): &(Method, &Figures)| {
        let finer = |n: usize| figures_of(&spec.text(by, n)).map(|figures| figures.strain_of_cell);
        let mut before = f64::INFINITY;
        figures.strain_of_cell >= NEAR[0] * limit
            || STILL_FINER.into_iter().any(|n| {
                // Without figures, the method stops, too.
                let strain = finer(n).unwrap_or(f64::INFINITY);
                let near = strain >= NEAR[1] * limit || strain > GROWS * before;
                before = strain;
                near
            })
    };
    let alone = |(method, became): &(Method, Became)| {
        let Became::Stopped(reason) = became else { return None };
        let limit = strain_of_stop(reason)?;
        let alone = !done.iter().any(|other| comes_near(limit, other));
        alone.then(|| (*method, Failure::new("stops alone", reason.clone())))
    };
    became.iter().filter_map(alone).collect()
}

/// Returns the strain at which a run stops: that at the end of the data, which the reason states last, or 1 for zero length.
fn strain_of_stop(reason: &str) -> Option<f64> {
    if reason.contains("fully compressed") {
        return Some(1.0);
    }
    let last = reason.contains("the end of the data").then(|| reason.rsplit('(').next())??;
    last.trim_end_matches([')', '.']).parse().ok()
}

/// Relative differences up to which two methods agree, on the cells of the scene, on twice as many, and on still more.
const AGREE: [f64; 3] = [0.04, 0.07, 0.15];
/// Factors of refinement: a load shorter than the time step is resolved only by the finer ones.
const FINER: [usize; 6] = [1, 2, 4, 8, 16, 32];
/// Strain above which plastic waves are so slow that some ten cells do not resolve them.
pub const RESOLVED: f64 = 0.1;
/// Stress up to which a bar counts as unstressed (in uniform motion), Pa.
const ROUNDING_STRESS: f64 = 1.0;
/// Largest ratio of a difference to that with half as many cells if it converges to zero; with fronts, it decreases as the square root of the cell
/// size. It is applied from the cells of the scene, or from the resolution of all parts of a load.
const FALLS: f64 = 0.85;

/// Returns a failure if the runs of two methods do not converge to each other as the cell size decreases.
fn methods_disagree(spec: &Spec, pair: &[(Method, &Figures)]) -> Option<Failure> {
    let [a, b] = [pair[0].1, pair[1].1];
    if a.is_unstressed() && b.is_unstressed() || are_different_problems(pair) {
        return None;
    }
    // Strain concentrated at a point depends on the cell size, and so does the work of an end on it: see
    // `what_gathers_in_cells_comes_back_by_their_size`.
    let gathers = a.gathers || b.gathers || driven_beyond(spec);
    let size = |differences: &Differences| differences.size(gathers);
    let (first, mut differences) = (resolved_from(spec), vec![a.differs(b)]);
    for (k, by) in FINER.into_iter().enumerate() {
        if by > 1 {
            // A run that stops on finer cells, as at the end of the data, has no result to compare.
            let finer = |method| figures_of(&spec.text(method, by)).filter(|_| runs(&spec.text(method, by)));
            let (finer_a, finer_b) = (finer(pair[0].0)?, finer(pair[1].0)?);
            if gathers_in_smaller_cells(a, &finer_a) || gathers_in_smaller_cells(b, &finer_b) {
                return None;
            }
            differences.push(finer_a.differs(&finer_b));
        }
        let last = size(&differences[k]);
        let falls = |finer: usize| finer > 0 && last < FALLS.powi(finer as i32) * size(&differences[k - finer]);
        if last < AGREE[k.min(AGREE.len() - 1)] || falls(k) || falls(k.saturating_sub(first)) {
            return None;
        }
    }
    if first + 1 >= FINER.len() {
        return None;
    }
    Some(Failure::new("methods disagree", format!("{:?}: {differences:.3?}", pair[1].0)))
}

/// Returns the index of the first of [`FINER`] whose time steps are not longer than the shortest part of a load.
fn resolved_from(spec: &Spec) -> usize {
    let Ok(scene) = Scene::parse("loads.toml", &spec.text(Method::Leapfrog, 1), Path::new("."), &[]) else { return 0 };
    let barwave::scene::Method::Leapfrog { cells, cfl } = scene.solve.method else { return 0 };
    let parts = |end: &EndCondition| match end {
        EndCondition::Stress { history } | EndCondition::Velocity { history, .. } => history
            .time()
            .windows(2)
            .map(|pair| pair[1] - pair[0])
            .filter(|part| *part > 0.0)
            .fold(f64::INFINITY, f64::min),
        _ => f64::INFINITY,
    };
    let (shortest, dt) = (parts(&scene.left).min(parts(&scene.right)), Grid::new(&scene.bar, cells, cfl).dt);
    FINER.iter().position(|by| dt <= f64::from(*by as u32) * shortest).unwrap_or(FINER.len())
}

/// Returns true for curves that are followed both ways where strain concentrates: see `what_gathers_at_a_place_comes_back_on_a_grid_alone` and,
/// between two grids, `what_gathers_in_cells_comes_back_by_their_size`.
fn are_different_problems(pair: &[(Method, &Figures)]) -> bool {
    let (a, b) = (pair[0].1, pair[1].1);
    a.returns && (a.gathers || b.gathers)
}

/// Returns true if the load exceeds what the curve can transmit for a short time only: the strain of a cell increases as the cell size decreases.
fn gathers_in_smaller_cells(own: &Figures, finer: &Figures) -> bool {
    own.returns && finer.strain_of_cell > RESOLVED && finer.strain_of_cell > 2.0 * own.strain_of_cell
}

/// Returns true if an end has a stress above the largest one that its curve carries, so that strain concentrates there with any method. After flow in
/// the other sense, a curve carries less by twice the motion of the elastic range: see `an_end_that_is_turned_round_carries_less`.
pub fn driven_beyond(spec: &Spec) -> bool {
    let scene = Scene::parse("driven.toml", &spec.text(Method::Leapfrog, 1), Path::new("."), &[]);
    scene.is_ok_and(|scene| {
        let last = scene.bar.segments.len() - 1;
        let kinematic = scene.effects.hardening.map_or(0.0, barwave::scene::HardeningRule::kinematic_fraction);
        [(&scene.left, 0), (&scene.right, last)].into_iter().any(|(end, segment)| {
            let EndCondition::Stress { history } = end else { return false };
            let material = &scene.bar.segments[segment].material;
            [(Sense::Tension, 1.0), (Sense::Compression, -1.0)].iter().any(|&(sense, sign)| {
                let curve = material.branch(sense);
                let most = curve.running_maximum().stress().iter().fold(0.0, |a: f64, b| a.max(*b));
                let largest = |sign: f64| history.value().iter().fold(0.0, |a: f64, b| a.max(sign * b));
                let flow_stress = Table::new(curve, material.modulus).yield_stress();
                let moved = 2.0 * kinematic * (largest(-sign) - flow_stress).max(0.0);
                largest(sign) > most - moved
            })
        })
    })
}

/// Returns true if the run, as started by a user, finishes.
fn runs(text: &str) -> bool {
    let scene = Scene::parse("finer.toml", text, Path::new("."), &[]);
    scene.is_ok_and(|scene| run(&scene, None, &mut |_| ControlFlow::Continue(())).is_ok())
}

/// Returns the figures of a run without checks, or `None` if it stops.
pub fn figures_of(text: &str) -> Option<Figures> {
    let scene = Scene::parse("finer.toml", text, Path::new("."), &[]).ok()?;
    let mut failures = Vec::new();
    let figures = follow(&scene, scene.solve.until, &mut failures);
    (figures.ended && failures.is_empty()).then_some(figures)
}

/// Checks a scene with one method. A panic counts as a failure.
pub fn check_by(spec: &Spec, method: Method) -> (Became, Vec<Failure>) {
    let mut failures = Vec::new();
    let became = catch_unwind(AssertUnwindSafe(|| by_method(spec, method, &mut failures)));
    let became = became.unwrap_or_else(|panic| {
        failures.push(Failure::new("panic", words(&*panic)));
        Became::Refused
    });
    (became, failures)
}

fn words(panic: &(dyn Any + Send)) -> String {
    let text = panic.downcast_ref::<String>().cloned();
    text.or_else(|| panic.downcast_ref::<&str>().map(|&text| text.to_owned())).unwrap_or_default()
}

fn by_method(spec: &Spec, method: Method, failures: &mut Vec<Failure>) -> Became {
    let scene = match Scene::parse("random.toml", &spec.text(method, 1), Path::new("."), &[]) {
        Ok(scene) => scene,
        Err(Error::Input(error)) => {
            if error.help.is_empty() || error.place.is_none() {
                failures.push(Failure::new("refused without help", error.to_string()));
            }
            return Became::Refused;
        }
        Err(error) => {
            failures.push(Failure::new("refused by another error", error.to_string()));
            return Became::Refused;
        }
    };
    let above_critical = match run(&scene, None, &mut |_| ControlFlow::Continue(())) {
        Ok(summary) => {
            summary_is_finite(&summary, failures);
            summary.above_critical
        }
        Err(Error::Run(error)) => {
            stopped_for_a_reason(&error, failures);
            return Became::Stopped(error.reason);
        }
        Err(error) => {
            failures.push(Failure::new("stopped by another error", error.to_string()));
            return Became::Refused;
        }
    };
    if scene.auto.is_some() {
        return Became::Refused;
    }
    let mut figures = follow(&scene, scene.solve.until, failures);
    figures.gathers |= above_critical;
    if failures.iter().any(|failure| failure.class == GIVES) && vanishes_on_finer_cells(spec, method, &figures) {
        failures.retain(|failure| failure.class != GIVES);
    }
    mirror_agrees(spec, method, &figures, failures);
    Became::Done(Box::new(figures))
}

/// Returns true if the energy added by a leapfrog grid is an error of first order: with a quarter of the cell size, it is less than half. Coarse
/// cells can contain several jumps of the initial motion.
fn vanishes_on_finer_cells(spec: &Spec, method: Method, figures: &Figures) -> bool {
    let finer = || {
        let scene = Scene::parse("finer.toml", &spec.text(method, 4), Path::new("."), &[]).ok()?;
        let finer = follow(&scene, scene.solve.until, &mut Vec::new());
        finer.ended.then_some(finer.given)
    };
    method == Method::Leapfrog && finer().is_some_and(|given| given < 0.5 * figures.given)
}

fn summary_is_finite(summary: &Summary, failures: &mut Vec<Failure>) {
    let ends = [summary.left, summary.right];
    let figures = ends.iter().flat_map(|end| [end.stress, end.strain, end.velocity, end.striker.unwrap_or(0.0)]);
    let ledger = [summary.ledger.energy_residual, summary.ledger.momentum_residual, summary.end_time_s];
    let rest = [summary.critical_velocity, summary.temperature_rise, summary.error.as_ref().map(|error| error.value)];
    let rest = rest.into_iter().flatten();
    if figures.chain(ledger).chain(rest).any(|value| !value.is_finite()) {
        let text = serde_json::to_string(summary).unwrap_or_default();
        failures.push(Failure::new("summary not finite", text.chars().take(600).collect()));
    }
}

/// A run may stop at the end of the data; a stop because of an internal error is a failure.
fn stopped_for_a_reason(error: &RunError, failures: &mut Vec<Failure>) {
    let reason = &error.reason;
    let class = if reason.contains("not a finite number") {
        "stopped: not finite"
    } else if reason.contains("is not conserved") {
        "stopped: balance does not close"
    } else if error.help.is_empty() || !error.time.is_finite() {
        "stopped without help"
    } else {
        return;
    };
    failures.push(Failure::new(class, error.to_string()));
}

/// Largest relative difference between a scene and its mirror image, due to rounding, which flow along level curves amplifies. With front tracking,
/// it is in front tolerances: rounding decides whether two fronts are merged.
const MIRRORED: f64 = 1e-6;
const MIRRORED_FRONTS: f64 = 3.0;
/// Twice that is allowed if a fifth of the tolerance gives less than half: in tapered bars, many fronts are merged.
const MIRRORED_FALLING: f64 = 6.0;
/// Relative changes of the time step, or of the front tolerance, of the order of rounding and well above it, but far below any relevant change.
const DISTURBANCES: [f64; 4] = [1e-14, 1e-13, 1e-12, 1e-11];
/// Number of multiples of each that are tried until one causes as large a difference as the mirror image. Where rounding decides, each is one more
/// sample of its effect; the mirror image has the largest of five differences in a fifth of all such scenes.
const SAMPLES: u32 = 16;

fn mirror_agrees(spec: &Spec, method: Method, figures: &Figures, failures: &mut Vec<Failure>) {
    let text = spec.mirrored().text(method, 1);
    let mirrored = match Scene::parse("mirrored.toml", &text, Path::new("."), &[]) {
        Ok(scene) => follow(&scene, scene.solve.until, &mut Vec::new()),
        Err(error) => {
            failures.push(Failure::new("mirror refused", error.to_string()));
            return;
        }
    };
    // All differences of a bar in uniform motion are rounding, too.
    if figures.is_unstressed() || !figures.ended || !mirrored.ended {
        return;
    }
    let differs = figures.mirrored().differs(&mirrored);
    let allowed = match method {
        Method::Moc => MIRRORED.max(MIRRORED_FRONTS * spec.front_tolerance),
        Method::Leapfrog | Method::Muscl => MIRRORED,
    };
    let size = differs.size(method == Method::Moc && figures.gathers);
    if size <= allowed || (size <= MIRRORED_FALLING * spec.front_tolerance && mirror_falls(spec, method, size)) {
        return;
    }
    // A single cell that flows or not causes the same difference in both, to rounding.
    let amplified = amplified(spec, method, figures, size / 1.001);
    if size > 1.001 * amplified && !is_tie(spec, method) {
        failures.push(Failure::new("mirror differs", format!("{differs:?}, by disturbances {amplified:e}")));
    }
}

/// Returns true if a scene and its mirror image differ by less than half of `size` with a fifth of the front tolerance.
fn mirror_falls(spec: &Spec, method: Method, size: f64) -> bool {
    let events = [MAX_EVENTS, 30 * MAX_EVENTS].map(|events| format!("max-events = {events}"));
    let figures =
        [spec, &spec.mirrored()].map(|spec| figures_of(&spec.text(method, 5).replace(&events[0], &events[1])));
    let [Some(figures), Some(mirrored)] = figures else { return false };
    let differs = figures.mirrored().differs(&mirrored);
    method == Method::Moc && differs.size(figures.gathers) < 0.5 * size
}

/// Returns the effect of disturbances of the order of rounding: along falling curves, and level ones that are followed both ways, the equations are
/// ill-posed and amplify any. Where a cell is at its yield stress to the last bit, some of them decide whether it flows. Returns the first effect
/// that is at least `enough`, otherwise the largest one.
fn amplified(spec: &Spec, method: Method, figures: &Figures, enough: f64) -> f64 {
    let differs = |disturbance: f64| {
        let part = 1.0 - disturbance;
        let disturbed = Spec { cfl: part * spec.cfl, front_tolerance: part * spec.front_tolerance, ..spec.clone() };
        figures_of(&disturbed.text(method, 1)).map_or(0.0, |disturbed| figures.differs(&disturbed).largest())
    };
    let mut largest = 0.0_f64;
    for by in 1..=SAMPLES {
        for disturbance in DISTURBANCES {
            largest = largest.max(differs(f64::from(by) * disturbance));
            if largest >= enough {
                return largest;
            }
        }
    }
    largest
}

/// Returns true if the difference vanishes with another time step: at Courant number 1, a bar returns to a wall exactly at the end of a step, and
/// rounding decides whether contact begins in this step or in the next.
fn is_tie(spec: &Spec, method: Method) -> bool {
    let other = Spec { cfl: 0.97 * spec.cfl, ..spec.clone() };
    let figures = [&other, &other.mirrored()].map(|spec| figures_of(&spec.text(method, 1)));
    let [Some(figures), Some(mirrored)] = figures else { return false };
    method != Method::Moc && figures.mirrored().differs(&mirrored).largest() <= MIRRORED
}

/// Differences of two runs: means over the bar of stress and velocity, and impulse and work of the ends.
#[derive(Debug, Clone, Copy)]
pub struct Differences {
    pub stress: f64,
    pub velocity: f64,
    pub impulse: f64,
    pub work: f64,
}

impl Differences {
    /// Returns the largest difference; without those of the ends if strain `gathers` at a point.
    fn size(self, gathers: bool) -> f64 {
        if gathers { self.stress.max(self.velocity) } else { self.largest() }
    }

    pub fn largest(self) -> f64 {
        self.stress.max(self.velocity).max(self.impulse).max(self.work)
    }
}

impl Figures {
    /// Returns true if the bar moves uniformly, so that its stresses are rounding.
    fn is_unstressed(&self) -> bool {
        self.stress.scale < ROUNDING_STRESS
    }

    pub fn mirrored(&self) -> Self {
        let reversed = |of: &Scaled<Vec<f64>>, sign: f64| Scaled {
            values: of.values.iter().rev().map(|value| sign * value).collect(),
            scale: of.scale,
        };
        let [left, right] = self.impulse.values;
        Self {
            stress: reversed(&self.stress, 1.0),
            velocity: reversed(&self.velocity, -1.0),
            impulse: Scaled { values: [-right, -left], ..self.impulse },
            work: Scaled { values: [self.work.values[1], self.work.values[0]], ..self.work },
            ..*self
        }
    }

    pub fn differs(&self, other: &Self) -> Differences {
        Differences {
            stress: self.stress.differs(&other.stress),
            velocity: self.velocity.differs(&other.velocity),
            impulse: self.impulse.differs(&other.impulse),
            work: self.work.differs(&other.work),
        }
    }
}

impl<T: AsRef<[f64]>> Scaled<T> {
    /// Returns the mean difference relative to the larger of the two scales.
    fn differs(&self, other: &Self) -> f64 {
        let (a, b) = (self.values.as_ref(), other.values.as_ref());
        let mean = a.iter().zip(b).map(|(a, b)| (a - b).abs()).sum::<f64>() / a.len() as f64;
        if mean == 0.0 { 0.0 } else { mean / self.scale.max(other.scale) }
    }
}
