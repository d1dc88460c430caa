//! What accuracy costs in time: the scene by every method that can do it, at one resolution after another.

mod effects;
mod growth;
mod judge;
mod ladder;
mod measure;
mod reference;
mod shape;
mod source;

use std::time::Instant;

use serde::Serialize;

pub use effects::EffectCost;
pub use growth::Growth;
pub use judge::{OrderFit, Reach, TOLERANCES};
pub use source::Resolution;

use self::ladder::{Halt, Ran, Runner, Spent};
use self::measure::{Pass, Wanted, Watch};
use self::reference::Reference;
use self::source::{Family, Source};
use super::plan::{Work, plan};
use crate::error::{Error, InputError, Result};
use crate::run::Wish;
use crate::scene::Scene;
use crate::solver::moc::FrontTracking;

/// Parts of the budget by which the stages of the study have to be done; what one leaves goes to the next.
const REFERENCE_BY: f64 = 0.25;
const LADDERS_BY: f64 = 0.8;
const EFFECTS_BY: f64 = 0.9;

/// Rungs of a grid whose end times a reference on a grid keeps: finer ones end within a step of its own.
const RUNGS_WITH_ENDS: usize = 10;

/// The study of a scene. Keys are those of `barwave cost --json`.
#[derive(Debug, Clone, Serialize)]
pub struct Cost {
    /// Scene title.
    pub scene: String,
    /// What errors are measured against.
    pub reference: String,
    /// Relative L1 difference of the two finest references, or rounding where the reference is exact.
    pub reference_uncertainty: f64,
    /// What `error` is.
    pub measure: &'static str,
    /// One a method and resolution, method by method, coarse to fine.
    pub points: Vec<CostPoint>,
    /// Observed order of each scheme, null where there is none.
    pub orders: serde_json::Map<String, serde_json::Value>,
    /// How these were found.
    pub order_fits: Vec<OrderFit>,
    /// The cheapest way to each tolerance.
    pub cheapest: Vec<Reach>,
    /// Every method's way to each tolerance.
    pub reach: Vec<Reach>,
    /// What each effect adds.
    pub effects: Vec<EffectCost>,
    /// How time and memory grow.
    pub growth: Vec<Growth>,
    /// What was left out, and why.
    pub skipped: Vec<Skipped>,
    /// Methods that cannot do the scene, and why.
    pub unable: Vec<Unable>,
    /// Time that the study was given, s.
    pub budget_s: f64,
    /// Time that it took, s.
    pub wall_s: f64,
    /// Load of the machine (processes that want to run, mean of a minute) before and after; null where unknown.
    pub load: [Option<f64>; 2],
    /// Threads that a long bar may take.
    pub threads: usize,
    /// The user stopped it.
    pub interrupted: bool,
}

/// One method at one resolution.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct CostPoint {
    /// "fd" or "moc".
    pub method: String,
    /// "leapfrog", "muscl", "front-tracking" or "characteristic-net".
    pub scheme: String,
    /// Cells of the bar.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub cells: Option<usize>,
    /// Front tolerance.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub front_tolerance: Option<f64>,
    /// Relative L1 of stress over the bar at the end time.
    pub error: f64,
    /// Largest relative L1 of stress over time of the gauges; null where there is none.
    pub gauge_error: Option<f64>,
    /// Median stepping time, s.
    pub step_wall_s: f64,
    /// Shortest stepping time, s: what is left where the machine has other work too.
    pub shortest_s: f64,
    /// Distance of the quartiles of the stepping times over their median; 0 for a single run.
    pub spread: f64,
    /// Runs that were timed.
    pub repetitions: usize,
    /// Time of the whole process, from its start to the finished result file, s; null where it was not measured.
    pub whole_wall_s: Option<f64>,
    /// Cell-steps or events.
    pub work: u64,
    /// "cell-steps" or "events".
    pub work_unit: &'static str,
    /// Solver memory, bytes.
    pub memory_bytes: u64,
    /// Nothing is both quicker and better.
    pub pareto: bool,
    /// The error is below what the reference is uncertain by: it says no more than that.
    pub below_reference: bool,
    /// Front tracking only: no wave was merged, so that the result is exact for the table.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub exact: Option<bool>,
}

/// A point that was not run, or came to no end.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Skipped {
    /// "fd" or "moc".
    pub method: String,
    /// "leapfrog", ...
    pub scheme: String,
    /// Cells of the bar.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub cells: Option<usize>,
    /// Front tolerance.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub front_tolerance: Option<f64>,
    /// Expected time with all repetitions, s.
    pub expected_s: Option<f64>,
    /// Why.
    pub why: String,
}

/// A method that cannot do the scene.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Unable {
    /// "fd" or "moc".
    pub method: String,
    /// The scheme, where the method has several.
    pub scheme: Option<String>,
    /// Why.
    pub why: String,
}

/// A whole run from the start of its process to its end.
#[derive(Debug, Clone, PartialEq)]
pub enum Whole {
    /// It took so long, s.
    Took(f64),
    /// The user asked to stop.
    Interrupted,
    /// It would take, or took, longer than allowed.
    OutOfTime,
    /// It did not get to its end.
    Failed(String),
}

/// What a study needs of its caller.
pub struct Hooks<'a> {
    /// Time for all of it, s, > 0.
    pub budget: f64,
    /// Runs the scene with these overrides in a process of its own, for at most so long (s).
    pub whole: &'a mut dyn FnMut(&[String], f64) -> Whole,
    /// Told what is under way and how much time has gone, s.
    pub progress: &'a mut dyn FnMut(&str, f64) -> Wish,
}

/// What the errors are.
const MEASURE: &str = "relative L1 of stress over the bar at the end time";

impl CostPoint {
    /// Its resolution.
    pub fn resolution(&self) -> Resolution {
        match (self.front_tolerance, self.cells) {
            (Some(tolerance), _) => Resolution::FrontTolerance(tolerance),
            (None, cells) => Resolution::Cells(cells.unwrap_or(0)),
        }
    }

    /// A point with nothing but its resolution, error and stepping time.
    #[cfg(test)]
    pub(crate) fn plain(method: &str, resolution: Resolution, error: f64, step_wall_s: f64) -> Self {
        let (cells, front_tolerance) = parts(resolution);
        Self {
            method: method.into(),
            scheme: if cells.is_some() { "leapfrog" } else { "front-tracking" }.into(),
            cells,
            front_tolerance,
            error,
            gauge_error: None,
            step_wall_s,
            shortest_s: step_wall_s,
            spread: 0.0,
            repetitions: 1,
            whole_wall_s: None,
            work: 0,
            work_unit: "cell-steps",
            memory_bytes: 0,
            pareto: false,
            below_reference: false,
            exact: None,
        }
    }
}

/// Cells and front tolerance of a resolution.
fn parts(resolution: Resolution) -> (Option<usize>, Option<f64>) {
    match resolution {
        Resolution::Cells(cells) => (Some(cells), None),
        Resolution::FrontTolerance(tolerance) => (None, Some(tolerance)),
    }
}

/// Studies a scene that was read from text.
///
/// # Errors
/// An input error where no method can do the scene or no error can be measured; the error of a reference that cannot be run
/// at all; [`Error::Interrupted`] where the user stopped it before there was anything to show.
pub fn cost(scene: &Scene, hooks: &mut Hooks<'_>) -> Result<Cost> {
    let started = Instant::now();
    if scene.auto.is_some() {
        let message = "methods are compared for one set of effects, and effects = \"auto\" leaves that open";
        let help = "name the effects in an [effects] table; `barwave plan` says which ones it would choose";
        return Err(InputError::new(message).key("effects").help(help).into());
    }
    let load = load();
    let source = Source::new(scene);
    let (families, unable) = source.families();
    if families.is_empty() {
        return Err(InputError::new("no method can do this scene").help("try `barwave check` on it").into());
    }
    let budget = hooks.budget;
    let mut watch =
        Watch { started, until: REFERENCE_BY * budget, what: "reference".into(), progress: &mut *hooks.progress };
    let ends = end_times(&source, &families)?;
    let reference = reference::find(scene, &source, &families, &ends, &mut watch)?.map_err(|h| no_reference(&h))?;
    watch.until = LADDERS_BY * budget;
    let mut bench = Bench {
        source: &source,
        families: &families,
        reference: &reference,
        whole: &mut *hooks.whole,
        watch,
        points: vec![Vec::new(); families.len()],
    };
    let rungs: Vec<&[Resolution]> =
        families.iter().enumerate().map(|(k, family)| below_reference(&reference, k, &family.rungs)).collect();
    let (left, mut interrupted) = ladder::climb(&rungs, LADDERS_BY * budget, &measure::passes, &mut bench);
    let Bench { points, mut watch, .. } = bench;
    let (mut effects, mut growth) = (Vec::new(), resolution_growth(&families, &points, scene));
    if !interrupted {
        watch.until = EFFECTS_BY * budget;
        (effects, interrupted) = effects::effects(scene, &source, &families, &mut watch);
    }
    for family in &families {
        if interrupted {
            break;
        }
        watch.until = budget;
        match growth::with_time_and_knots(&source, family, &mut watch)? {
            Ok(rows) => growth.extend(rows),
            Err(_) => interrupted = true,
        }
    }
    let skipped = left.into_iter().map(|left| {
        let [method, scheme] = families[left.family].names.map(str::to_owned);
        let (cells, front_tolerance) = parts(left.resolution);
        Skipped { method, scheme, cells, front_tolerance, expected_s: left.expected, why: left.why }
    });
    let mut cost = Cost {
        scene: scene.title.clone(),
        reference: reference.name.clone(),
        reference_uncertainty: reference.uncertainty,
        measure: MEASURE,
        points: points.into_iter().flatten().collect(),
        orders: serde_json::Map::new(),
        order_fits: Vec::new(),
        cheapest: Vec::new(),
        reach: Vec::new(),
        effects,
        growth,
        skipped: skipped.collect(),
        unable,
        budget_s: budget,
        wall_s: 0.0,
        load: [load, self::load()],
        threads: rayon::current_num_threads(),
        interrupted,
    };
    if cost.points.is_empty() && interrupted {
        return Err(Error::Interrupted);
    }
    cost.judge();
    cost.wall_s = started.elapsed().as_secs_f64();
    Ok(cost)
}

impl Cost {
    /// Schemes in the order of the points, each with its points and their indices.
    pub fn schemes(&self) -> Vec<(&str, Vec<(usize, &CostPoint)>)> {
        let mut schemes: Vec<(&str, Vec<(usize, &CostPoint)>)> = Vec::new();
        for (k, point) in self.points.iter().enumerate() {
            match schemes.iter_mut().find(|s| s.0 == point.scheme) {
                Some(scheme) => scheme.1.push((k, point)),
                None => schemes.push((&point.scheme, vec![(k, point)])),
            }
        }
        schemes
    }

    /// What follows from the points.
    fn judge(&mut self) {
        let uncertainty = self.reference_uncertainty;
        let pareto = judge::pareto(&self.points, uncertainty);
        for (point, pareto) in self.points.iter_mut().zip(pareto) {
            point.pareto = pareto;
        }
        let (mut orders, mut fits, mut reaches) = (serde_json::Map::new(), Vec::new(), Vec::new());
        for (scheme, points) in self.schemes() {
            let alone: Vec<&CostPoint> = points.iter().map(|p| p.1).collect();
            let fit = judge::order(&alone, uncertainty);
            orders.insert(scheme.into(), fit.as_ref().map(|f| f.order).into());
            fits.extend(fit);
            reaches.extend(TOLERANCES.map(|tolerance| judge::reach(&points, tolerance, uncertainty)));
        }
        self.cheapest = TOLERANCES.map(|tolerance| judge::cheapest(&reaches, tolerance)).into();
        (self.orders, self.order_fits, self.reach) = (orders, fits, reaches);
    }
}

/// Where the reference is a run of a scheme itself, that scheme is judged at half its cells or fewer.
fn below_reference<'a>(reference: &Reference, family: usize, rungs: &'a [Resolution]) -> &'a [Resolution] {
    let Some((own, most)) = reference.grid else { return rungs };
    let coarser = |r: &Resolution| own != family || matches!(r, Resolution::Cells(cells) if 2 * cells <= most);
    &rungs[..rungs.iter().take_while(|r| coarser(r)).count()]
}

/// End times of the grids: each ends with the first step that reaches the scene's end time, s, increasing.
fn end_times(source: &Source<'_>, families: &[Family]) -> Result<Vec<f64>> {
    let mut times = Vec::new();
    for family in families {
        for &resolution in family.rungs.iter().take(RUNGS_WITH_ENDS) {
            if let Resolution::Cells(_) = resolution
                && let Work::Grid { dt_s, steps, .. } = plan(&source.at(family.way, resolution)?).work
            {
                times.push(dt_s * steps as f64);
            }
        }
    }
    times.sort_by(f64::total_cmp);
    times.dedup();
    Ok(times)
}

fn no_reference(halt: &Halt) -> Error {
    match halt {
        Halt::Interrupted => Error::Interrupted,
        Halt::OutOfTime => {
            InputError::new("the budget is too short for a reference, against which errors are measured")
                .key("--budget")
                .help("give more time, e.g. --budget 300s")
                .into()
        }
        Halt::Failed(why) => InputError::new(format!("no reference could be run: {why}"))
            .help("`barwave run` on the scene says more")
            .into(),
    }
}

fn resolution_growth(families: &[Family], points: &[Vec<CostPoint>], scene: &Scene) -> Vec<Growth> {
    let rows = families.iter().zip(points).filter_map(|(family, points)| {
        growth::with_resolution(family, &points.iter().collect::<Vec<_>>(), scene.solve.until)
    });
    rows.collect()
}

/// Solver memory of a finished run, bytes.
fn memory(scene: &Scene, pass: &Pass) -> u64 {
    match &pass.tracked {
        Some(bar) => (bar.pieces().count() * FrontTracking::BYTES_PER_FRONT) as u64,
        None => match plan(scene).work {
            Work::Grid { memory_bytes, .. } => memory_bytes as u64,
            Work::Fronts { .. } => 0,
        },
    }
}

/// Load of the machine: mean number of processes that wanted to run over the last minute.
fn load() -> Option<f64> {
    std::fs::read_to_string("/proc/loadavg").ok()?.split_whitespace().next()?.parse().ok()
}

/// Runs the points of the ladders.
struct Bench<'a> {
    source: &'a Source<'a>,
    families: &'a [Family],
    reference: &'a Reference,
    whole: &'a mut dyn FnMut(&[String], f64) -> Whole,
    watch: Watch<'a>,
    points: Vec<Vec<CostPoint>>,
}

/// Whole runs that take less than this are repeated, s.
const SHORT_WHOLE: f64 = 0.2;
const WHOLE_REPEATS: usize = 3;

impl Runner for Bench<'_> {
    fn run(&mut self, family: usize, resolution: Resolution) -> std::result::Result<Ran, Halt> {
        let from = self.watch.now();
        let Family { way, names, .. } = self.families[family];
        let (cells, front_tolerance) = parts(resolution);
        self.watch.what = match (cells, front_tolerance) {
            (Some(cells), _) => format!("{}, {cells} cells", names[1]),
            (None, tolerance) => format!("{}, front-tolerance {}", names[1], tolerance.unwrap_or(0.0)),
        };
        let scene = self.source.at(way, resolution).map_err(|e| Halt::Failed(e.to_string()))?;
        let pass = measure::pass(&scene, Wanted::RESULT, &mut self.watch)?;
        let (error, gauge_error) = self.reference.errors(&pass);
        let nothing = "no stress is left at the end time, so that no relative error can be measured";
        let error = error.ok_or_else(|| Halt::Failed(nothing.into()))?;
        let timing = measure::repeated(&scene, pass.seconds, &mut self.watch)?;
        let whole_wall_s = self.whole(&self.source.overrides(way, Some(resolution)))?;
        let whole = scene.in_pieces().is_none();
        let exact = pass.tracked.as_ref().map(|bar| whole && bar.is_exact());
        let below_reference = error <= self.reference.uncertainty;
        self.points[family].push(CostPoint {
            method: names[0].into(),
            scheme: names[1].into(),
            cells: cells.map(|_| pass.cells),
            front_tolerance,
            error,
            gauge_error,
            step_wall_s: timing.median,
            shortest_s: timing.shortest,
            spread: timing.spread,
            repetitions: timing.repetitions,
            whole_wall_s,
            work: pass.work,
            work_unit: if cells.is_some() { "cell-steps" } else { "events" },
            memory_bytes: memory(&scene, &pass),
            pareto: false,
            below_reference,
            exact,
        });
        let passes = measure::passes(pass.seconds);
        let spent = Spent { step: timing.median, passes, total: self.watch.now() - from };
        let bound = error.max(self.reference.uncertainty);
        Ok(Ran { spent, bound, exact: exact == Some(true), below_reference })
    }

    fn now(&self) -> f64 {
        self.watch.now()
    }
}

impl Bench<'_> {
    /// Median time of the whole process, s; none where it takes too long or stops.
    fn whole(&mut self, overrides: &[String]) -> std::result::Result<Option<f64>, Halt> {
        let mut times: Vec<f64> = Vec::new();
        while times.len() < WHOLE_REPEATS && times.iter().all(|t| *t < SHORT_WHOLE) {
            self.watch.look()?;
            match (self.whole)(overrides, self.watch.until - self.watch.now()) {
                Whole::Took(seconds) => times.push(seconds),
                Whole::Interrupted => return Err(Halt::Interrupted),
                Whole::OutOfTime | Whole::Failed(_) => break,
            }
        }
        Ok((!times.is_empty()).then(|| measure::timing(times).median))
    }
}
