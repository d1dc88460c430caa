//! Cost of accuracy: the scene is solved by every method that supports it, at increasing resolution.

mod bench;
mod candidates;
mod effects;
mod growth;
mod judge;
mod measure;
mod points;
mod reference;
mod refinement;
mod results;
mod source;

use std::ops::ControlFlow;
use std::time::Instant;

pub use effects::EffectCost;
pub use growth::Growth;
pub use judge::{CostToTolerance, OrderFit, TOLERANCES};
pub use points::{CostPoint, Skipped};
pub use results::Cost;
pub use source::{Resolution, Unable};

use self::bench::Bench;
use self::measure::Watch;
use self::reference::Reference;
use self::refinement::Halt;
use self::source::{Family, Source};
use crate::accuracy::{INSTANTS, evenly};
use crate::error::{Error, InputError, Result};
use crate::input::{Checked, positive};
use crate::record::Measure;
use crate::run::check_start;
use crate::scene::{Method, Scene};
use crate::units::Dimension;

/// Fractions of the budget by which the stages of the study have to be finished. Unused time is available to the next stage.
const REFERENCE_BY: f64 = 0.4;
const LADDERS_BY: f64 = 0.8;
const EFFECTS_BY: f64 = 0.9;

/// Number of coarsest levels of each grid whose time steps are added to the instants of a tracked reference. The steps of finer grids are close
/// enough to the requested instants.
const RUNGS_WITH_INSTANTS: usize = 8;
/// Cells of the grid whose steps are the common instants of the comparison.
const COMMON_CELLS: f64 = 100.0;

/// Measure and instants of the comparison.
struct Instants {
    measure: Measure,
    /// Instants at which all runs are compared, s, increasing.
    common: Vec<f64>,
    /// Common instants, and the steps of every grid that are nearest to them, s, increasing.
    own: Vec<f64>,
}

/// Outcome of a whole run, from the start of its process to its end.
#[derive(Debug, Clone, PartialEq)]
pub enum Whole {
    /// Duration of the completed run, s.
    Took(f64),
    /// The user interrupted.
    Interrupted,
    /// The run exceeded the time limit, or was predicted to.
    OutOfTime,
    /// The run failed, for this reason.
    Failed(String),
}

/// Runs a scene with overrides in a separate process, with a time limit, s.
pub type WholeRun<'a> = &'a mut dyn FnMut(&[String], f64) -> Whole;

/// Settings and callbacks that the caller of a study provides.
pub struct Hooks<'a> {
    /// Time budget of the study, s, > 0.
    pub budget: f64,
    /// Quantity whose error is measured.
    pub measure: Measure,
    /// Runs the scene with these overrides in a separate process, with this time limit, s. If `None`, whole runs are not timed.
    pub whole: Option<WholeRun<'a>>,
    /// Called with the current activity and the elapsed time, s; `Break` stops the study.
    pub progress: &'a mut dyn FnMut(&str, f64) -> ControlFlow<()>,
}

/// Checks the time budget of a study, s.
pub(crate) fn check_budget(budget: f64) -> Checked {
    positive([("budget", budget, Dimension::Time)])
}

/// Studies the cost of accuracy of a scene that was read from text.
///
/// # Errors
/// An input error if the budget is not positive, the effects are selected automatically, no method supports the scene or no error can be measured;
/// the error of a scene whose runs stop at t = 0; the error of a reference that cannot be run; [`Error::Interrupted`] if the user stopped the study
/// before it had a result.
pub fn cost(scene: &Scene, hooks: &mut Hooks<'_>) -> Result<Cost> {
    let started = Instant::now();
    check_budget(hooks.budget)?;
    if scene.auto.is_some() {
        let message = "methods are compared for a fixed set of effects, and effects = \"auto\" does not fix it";
        let help = "name the effects in an [effects] table; `barwave plan` shows its selection";
        return Err(InputError::new(message).key("effects").help(help).into());
    }
    if hooks.measure == Measure::Gauges && scene.record.gauges.is_empty() {
        let error = InputError::new("the scene has no gauges").key("measure");
        return Err(error.help("add some in [record] gauges, or choose another measure").into());
    }
    check_start(scene)?;
    let load = load();
    let source = Source::new(scene);
    let (families, unable) = source.families();
    if families.is_empty() {
        return Err(InputError::new("no method can simulate this scene").help("try `barwave check` on it").into());
    }
    let budget = hooks.budget;
    let mut watch =
        Watch { started, until: REFERENCE_BY * budget, what: "reference".into(), progress: &mut *hooks.progress };
    let instants = instants(scene, &source, &families, hooks.measure)?;
    let reference = reference::find(scene, &source, &families, &instants, &mut watch)?.map_err(|h| no_reference(&h))?;
    watch.until = LADDERS_BY * budget;
    let mut bench = Bench {
        source: &source,
        families: &families,
        reference: &reference,
        instants: &instants,
        whole: hooks.whole.as_mut().map(|whole| &mut **whole as WholeRun<'_>),
        watch,
        points: vec![Vec::new(); families.len()],
    };
    let levels: Vec<&[Resolution]> =
        families.iter().enumerate().map(|(k, family)| below_reference(&reference, k, &family.levels)).collect();
    let (left, mut interrupted) = refinement::refine(&levels, LADDERS_BY * budget, &measure::passes, &mut bench);
    let Bench { mut points, mut watch, .. } = bench;
    let uncertainty = reference.uncertainty_beside(&points);
    for point in points.iter_mut().flatten() {
        point.below_reference = point.error <= uncertainty;
    }
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
        let by = left.resolution.solved_by(families[left.family].names);
        Skipped { by, expected_s: left.expected, why: left.why }
    });
    let mut cost = Cost {
        scene: scene.title.clone(),
        reference: reference.name.clone(),
        reference_uncertainty: uncertainty,
        measure: hooks.measure.describe(),
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

/// Returns the levels at which a family is studied. If the reference is a run of the same scheme, the scheme is only studied with at most a quarter
/// of its cells: the errors of both have the same sign, so at half the cells little more than half of the error would be visible.
fn below_reference<'a>(reference: &Reference, family: usize, levels: &'a [Resolution]) -> &'a [Resolution] {
    let Some((own, most)) = reference.grid else { return levels };
    let coarser = |r: &Resolution| own != family || matches!(r, Resolution::Cells(cells) if 4 * cells <= most);
    &levels[..levels.iter().take_while(|r| coarser(r)).count()]
}

/// Returns the instants at which runs are compared: steps of a coarse grid, which finer grids share or approximate closely.
fn instants(scene: &Scene, source: &Source<'_>, families: &[Family], measure: Measure) -> Result<Instants> {
    let cfl = if let Method::Leapfrog { cfl, .. } | Method::Muscl { cfl, .. } = scene.solve.method { cfl } else { 1.0 };
    let step = (cfl * scene.bar.transit_time() / COMMON_CELLS).min(scene.solve.until);
    let steps = (scene.solve.until / step * (1.0 + 1e-9)).floor() as usize;
    let all: Vec<f64> = (1..=steps).map(|k| k as f64 * step).collect();
    let common = evenly(&all, 2 * INSTANTS);
    let mut own = common.clone();
    for family in families {
        for &resolution in family.levels.iter().take(RUNGS_WITH_INSTANTS) {
            if let Some(dt) = measure::time_step(&source.at(family.choice, resolution)?) {
                own.extend(common.iter().map(|t| (t / dt).round().max(1.0) * dt));
            }
        }
    }
    own.sort_by(f64::total_cmp);
    own.dedup_by(|a, b| (*a - *b).abs() <= 1e-9 * step);
    Ok(Instants { measure, common, own })
}

fn no_reference(halt: &Halt) -> Error {
    match halt {
        Halt::Interrupted => Error::Interrupted,
        Halt::OutOfTime => {
            InputError::new("the budget is too short for a reference, against which errors are measured")
                .key("budget")
                .help("give more time")
                .into()
        }
        Halt::Failed(why) => InputError::new(format!("no reference could be run: {why}"))
            .help("`barwave run` on the scene gives the details")
            .into(),
    }
}

fn resolution_growth(families: &[Family], points: &[Vec<CostPoint>], scene: &Scene) -> Vec<Growth> {
    let rows = families.iter().zip(points).filter_map(|(family, points)| {
        growth::with_resolution(family, &points.iter().collect::<Vec<_>>(), scene.solve.until)
    });
    rows.collect()
}

/// Returns the load of the machine: the mean number of runnable processes over the last minute.
fn load() -> Option<f64> {
    std::fs::read_to_string("/proc/loadavg").ok()?.split_whitespace().next()?.parse().ok()
}
