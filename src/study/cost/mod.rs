//! What accuracy costs in time: the scene by every method that can do it, at one resolution after another.

mod bench;
mod effects;
mod found;
mod growth;
mod judge;
mod ladder;
mod measure;
mod reference;
mod results;
mod rivals;
mod shape;
mod source;

use std::time::Instant;

pub use effects::EffectCost;
pub use found::{CostPoint, Skipped};
pub use growth::Growth;
pub use judge::{OrderFit, Reach, TOLERANCES};
pub use results::Cost;
pub use source::{Resolution, Unable};

use self::bench::Bench;
use self::ladder::Halt;
use self::measure::Watch;
use self::reference::Reference;
use self::source::{Family, Source};
use super::plan::{Work, plan};
use crate::error::{Error, InputError, Result};
use crate::run::Wish;
use crate::scene::Scene;

/// Parts of the budget by which the stages of the study have to be done; what one leaves goes to the next.
const REFERENCE_BY: f64 = 0.4;
const LADDERS_BY: f64 = 0.8;
const EFFECTS_BY: f64 = 0.9;

/// Rungs of a grid whose end times a reference on a grid keeps: finer ones end within a step of its own.
const RUNGS_WITH_ENDS: usize = 10;

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
        let by = left.resolution.solved_by(families[left.family].names);
        Skipped { by, expected_s: left.expected, why: left.why }
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

/// Where the reference is a run of a scheme itself, that scheme is judged at a quarter of its cells or fewer: both are off to the
/// same side, and at half the cells little more than half of the error would be seen.
fn below_reference<'a>(reference: &Reference, family: usize, rungs: &'a [Resolution]) -> &'a [Resolution] {
    let Some((own, most)) = reference.grid else { return rungs };
    let coarser = |r: &Resolution| own != family || matches!(r, Resolution::Cells(cells) if 4 * cells <= most);
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

/// Load of the machine: mean number of processes that wanted to run over the last minute.
fn load() -> Option<f64> {
    std::fs::read_to_string("/proc/loadavg").ok()?.split_whitespace().next()?.parse().ok()
}
