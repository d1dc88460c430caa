//! Method, work and estimates of a run, before it is started.

use std::ops::ControlFlow;
use std::time::{Duration, Instant};

use serde::Serialize;

use crate::assemble;
use crate::bar::{Segment, initial_fans};
use crate::error::Error;
use crate::law::Table;
use crate::material::Sense;
use crate::record::{AuditRow, AutoChoice, FrontSummary};
use crate::run::{self, Progress, Trial};
use crate::scene::{Effects, Method, Rate, Scene};
use crate::solver::fd::{DistributedForces, Grid, TAPER_BYTES_PER_CELL};
use crate::solver::moc::{FrontTracking, Settings};
use crate::solver::net::{self, Net};

/// Plan of a scene. Keys are those of `barwave plan --json`.
#[derive(Debug, Clone, Serialize)]
pub struct Plan {
    /// Scene title.
    pub scene: String,
    /// "fd" or "moc".
    pub method: String,
    /// "leapfrog", "front-tracking" or "characteristic-net".
    pub scheme: String,
    /// Simulated and neglected effects, with reasons.
    pub effects: Vec<PlannedEffect>,
    /// How the tolerance is met; null if the scene names its method.
    pub choice: Option<PlannedChoice>,
    /// Initial selection of `effects = "auto"`; the audit of the run may extend it. Omitted if the scene names its effects.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub auto: Option<Vec<AutoChoice>>,
    /// Work of the method; its keys are at the same level as the others.
    #[serde(flatten)]
    pub work: Work,
    /// Expected computing time on this machine; its keys are at the same level as the others.
    #[serde(flatten)]
    pub trial: Trial,
    /// Size of the fields before compression, bytes.
    pub field_bytes: usize,
    /// Fronts predicted to start at t = 0.
    pub fronts: Vec<FrontSummary>,
    /// Critical velocity of the struck material, m/s; null if its curve has none.
    #[serde(rename = "critical_velocity_m_s")]
    pub critical_velocity: Option<f64>,
    /// Whether the scene drives the bar above its critical velocity; not predicted for a bar with an initial state.
    pub above_critical: bool,
    /// Whether the bar is stressed or has yielded at t = 0; its first waves are then not predicted.
    pub initial_state: bool,
    /// Notes on problematic settings of the scene, one sentence each.
    pub notes: Vec<String>,
    /// Discretization of tapered segments into uniform pieces, for methods that need it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub staircase: Option<Staircase>,
    /// Discretization of an initial state that varies along the bar, for front tracking.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub initial_steps: Option<InitialSteps>,
}

/// Staircase approximation of an initial state.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct InitialSteps {
    /// Number of steps along the bar.
    pub steps: usize,
    /// Largest step, relative to the largest magnitude of its quantity; the mean error is at most a quarter of it.
    pub largest: f64,
}

/// Discretization of tapered segments into uniform pieces.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Staircase {
    /// Pieces of the whole bar, uniform segments included.
    pub pieces: usize,
    /// Largest fraction of a wave's force that is reflected at a step between two pieces.
    pub reflects: f64,
}

/// Size and cost of a run, by method.
#[derive(Debug, Clone, Serialize)]
#[serde(untagged)]
pub enum Work {
    /// Methods on a grid.
    Grid {
        /// Number of cells of the bar.
        cells: usize,
        /// Time step, s.
        dt_s: f64,
        /// Number of steps to the end time.
        steps: usize,
        /// Solver memory per cell while it is elastic.
        bytes_per_elastic_cell: usize,
        /// Solver memory per cell after its block has yielded.
        bytes_per_yielded_cell: usize,
        /// Largest solver memory, bytes: of the whole bar elastic or yielded, whichever is more.
        memory_bytes: usize,
        /// Largest relative change of a segment's transit time, which is rounded so that waves cross a cell in one time step.
        largest_transit_shift: f64,
        /// Further data of a characteristic net.
        #[serde(flatten)]
        net: Option<NetWork>,
    },
    /// Front tracking.
    Fronts {
        /// Front tolerance, relative to `stress_scale`.
        front_tolerance: f64,
        /// Stress scale of the tolerance: the largest stress that the loads and the initial state can cause.
        #[serde(rename = "stress_scale_Pa")]
        stress_scale: f64,
        /// Number of fronts just after t = 0.
        first_fronts: usize,
        /// Largest number of linear pieces of a curve.
        lines: usize,
        /// Largest number of front interactions of the run.
        event_budget: u64,
        /// Solver memory per front, bytes.
        bytes_per_front: usize,
    },
}

/// Numerical properties of a characteristic net.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct NetWork {
    /// Malvern's k times the time step. Above 1, the net determines the width of the fronts. Null for other laws.
    pub k_dt: Option<f64>,
}

/// Selection of the method for a tolerance. The method and resolution of the plan are those from which the run would start.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct PlannedChoice {
    /// Requested tolerance.
    pub tolerance: f64,
    /// Schemes that support the scene.
    pub schemes: Vec<String>,
    /// Selected scheme, with the reason.
    pub how: String,
}

/// An effect in a plan.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct PlannedEffect {
    /// Name or description, e.g. "plasticity".
    pub effect: String,
    /// Whether it is simulated.
    pub on: bool,
    /// Reason.
    pub why: String,
    /// Estimated relative change of the stress due to the effect; null if unknown or not estimated.
    pub estimate: Option<f64>,
    /// Estimate above which the effect matters: the tolerance of the audit; null without an estimate.
    pub threshold: Option<f64>,
}

/// Time limit of the coarse runs of a plan, which `tolerance`, `effects = "auto"` and the estimates of neglected effects need.
const LIMIT: Duration = Duration::from_millis(800);

/// Creates the plan of a scene, with the effects with which `effects = "auto"` would start. Coarse runs are stopped after about a second, and the
/// plan then states what is unknown. The run itself is tried for some tenths of a second.
pub fn plan(scene: &Scene) -> Plan {
    let started = Instant::now();
    let within =
        &mut |_: Progress| if started.elapsed() < LIMIT { ControlFlow::Continue(()) } else { ControlFlow::Break(()) };
    let undecided = "the coarse runs that select the effects exceed the time limit of `plan`; `run` selects them";
    let decided = run::choose(scene, within);
    let mut notes: Vec<String> = decided.is_err().then(|| undecided.to_owned()).into_iter().collect();
    let scene = decided.as_ref().unwrap_or(scene);
    let (chosen, choice) = choose(scene, within).unzip();
    let scene = chosen.as_ref().unwrap_or(scene);
    let [left, right] = scene.ends_in_run();
    let all = initial_fans(&scene.bar, &left, &right);
    let (asked, cut) = (scene, scene.in_pieces());
    let scene = cut.as_ref().unwrap_or(scene);
    let [method, scheme] = scene.solve.method.names();
    let (work, cells) = work(scene);
    let samples = scene.record.cells.unwrap_or(cells) * scene.record.times.len() * scene.record.fields.len();
    Plan {
        scene: scene.title.clone(),
        method: method.into(),
        scheme: scheme.into(),
        effects: effects(asked, &all, within, &mut notes),
        choice,
        auto: scene.auto.as_ref().map(|auto| auto.choices.clone()),
        work,
        trial: run::trial(scene),
        field_bytes: samples * size_of::<f64>(),
        fronts: all.iter().flat_map(fronts).collect(),
        critical_velocity: asked.critical_velocity(),
        above_critical: scene.is_above_critical(),
        initial_state: scene.bar.on_warm_curves().has_initial_state(),
        notes: scene.notes().into_iter().chain(notes).collect(),
        staircase: scene
            .discretized
            .as_ref()
            .filter(|cut| cut.has_tapers())
            .map(|cut| Staircase { pieces: cut.of.len(), reflects: cut.reflects }),
        initial_steps: scene
            .discretized
            .as_ref()
            .filter(|cut| cut.steps > 0)
            .map(|cut| InitialSteps { steps: cut.steps, largest: cut.largest_step }),
    }
}

/// Selects the method for a tolerance. Returns the scene with the method and resolution from which its run would start, or `None` if the scene names
/// its method.
fn choose(scene: &Scene, within: &mut dyn FnMut(Progress) -> ControlFlow<()>) -> Option<(Scene, PlannedChoice)> {
    let tolerance = scene.solve.tolerance.as_ref()?;
    let schemes: Vec<String> = tolerance.methods.iter().map(|m| m.names()[1].to_owned()).collect();
    let mut chosen = scene.clone();
    let how = match run::predict(scene, within) {
        Ok(Some((method, why))) => {
            chosen.parts.solve.method = method;
            format!("{why}; the run refines further if its own error estimate exceeds the tolerance")
        }
        Err(Error::Interrupted) => {
            "the coarse runs that select the method exceed the time limit of `plan`; `run` performs them and shows its \
             progress; method, grid and time below are those of the scene without a tolerance"
                .into()
        }
        Err(Error::Run(error)) => error.reason,
        Ok(None) | Err(_) => "no method is expected to reach the tolerance".into(),
    };
    Some((chosen, PlannedChoice { tolerance: tolerance.value, schemes, how }))
}

/// Returns the largest solver memory of a scene on a grid, bytes; 0 for front tracking.
pub fn memory(scene: &Scene) -> usize {
    match work(scene).0 {
        Work::Grid { memory_bytes, .. } => memory_bytes,
        Work::Fronts { .. } => 0,
    }
}

/// Returns the work of the scene's method, and its cells.
fn work(scene: &Scene) -> (Work, usize) {
    match scene.solve.method {
        Method::Leapfrog { cells, cfl } => {
            let grid = assemble::grid(scene, cells, cfl);
            grid_work(scene, &grid, &leapfrog_cell(scene, &grid))
        }
        Method::Muscl { cells, cfl } => grid_work(scene, &assemble::grid(scene, cells, cfl), &muscl_cell(scene)),
        Method::CharacteristicNet { cells } => {
            let grid = net::grid(&scene.bar, cells);
            grid_work(scene, &grid, &net_cell(scene, &grid))
        }
        Method::FrontTracking { front_tolerance, event_budget } => {
            (front_work(scene, front_tolerance, event_budget), 0)
        }
    }
}

/// Solver memory of a cell, bytes, elastic and after yielding, and the properties of a net.
struct Cell {
    bytes: [usize; 2],
    net: Option<NetWork>,
}

/// Returns the work on a grid, and its cells.
fn grid_work(scene: &Scene, grid: &Grid, cell: &Cell) -> (Work, usize) {
    let (cells, steps) = (grid.cells(), grid.steps_to(scene.solve.until));
    let [elastic, yielded] = cell.bytes;
    let work = Work::Grid {
        cells,
        dt_s: grid.dt,
        steps,
        bytes_per_elastic_cell: elastic,
        bytes_per_yielded_cell: yielded,
        memory_bytes: cells * elastic.max(yielded),
        largest_transit_shift: grid.transit_shift(),
        net: cell.net,
    };
    (work, cells)
}

fn leapfrog_cell(scene: &Scene, grid: &Grid) -> Cell {
    let law = assemble::stepped_law(&scene.bar.segments[0], &scene.effects, grid.dt);
    let number = size_of::<f64>();
    // In a bar that can fracture, each cell stores its plastic work.
    let work_kept = usize::from(scene.effects.rupture.is_some()) * number;
    // Each cell stores stress and velocity; after yielding, also the state of the law and the flow of the latest step.
    let tapered = scene.bar.segments.iter().any(|segment| segment.taper.is_some());
    let sections = if tapered { TAPER_BYTES_PER_CELL } else { 0 };
    let along = assemble::distributed_forces(&scene.bar, &scene.effects);
    let [nodes, yielded_nodes] = along.as_ref().map_or([0; 2], DistributedForces::bytes_per_cell);
    // Elastic cells can be stored as two waves in addition, and yielded cells too if the law states up to which stress they are elastic again.
    let waves = if along.is_none() && scene.effects.rupture.is_none() { 2 * number } else { 0 };
    let state = vec![0.0; law.law.state_len()];
    let waves_again = if law.law.elastic_up_to(law.yield_stress, &state) > 0.0 { waves } else { 0 };
    let elastic = 2 * number + waves + sections + nodes;
    let yielded = (2 + state.len()) * number + size_of::<f32>() + waves_again + work_kept + sections + yielded_nodes;
    Cell { bytes: [elastic, yielded], net: None }
}

fn muscl_cell(scene: &Scene) -> Cell {
    let law = assemble::segment_law(&scene.bar.segments[0], &scene.effects);
    let bytes = [2, 2 + law.law.state_len()].map(|numbers| numbers * size_of::<f64>());
    Cell { bytes, net: None }
}

fn net_cell(scene: &Scene, grid: &Grid) -> Cell {
    let k = if let Some(Rate::Malvern { k }) = scene.effects.rate { Some(k) } else { None };
    Cell { bytes: [Net::BYTES_PER_CELL; 2], net: Some(NetWork { k_dt: k.map(|k| k * grid.dt) }) }
}

fn front_work(scene: &Scene, front_tolerance: f64, event_budget: u64) -> Work {
    let settings = Settings { front_tolerance, event_budget, ..Settings::default() };
    // Constructing the bar determines the stress scale and the number of fronts.
    let start = assemble::front_tracking(scene, settings);
    let table = |s: &Segment, sense| Table::new(s.material.branch(sense), s.material.modulus).lines().len();
    let lines = |s| table(s, Sense::Tension).max(table(s, Sense::Compression));
    Work::Fronts {
        front_tolerance,
        stress_scale: start.stress_scale(),
        first_fronts: start.front_count(),
        lines: scene.bar.segments.iter().map(lines).max().unwrap_or(0),
        event_budget,
        bytes_per_front: FrontTracking::BYTES_PER_FRONT,
    }
}

fn fronts(initial_fan: &crate::bar::InitialFan) -> Vec<FrontSummary> {
    let sign = initial_fan.sense.sign();
    let front = |e: &crate::wave::similarity::Edge| FrontSummary {
        origin: initial_fan.origin.to_string(),
        strain_ahead: sign * e.strain_ahead,
        strain_behind: sign * e.strain_behind,
        stress_ahead: sign * e.stress_ahead,
        stress_behind: sign * e.stress_behind,
        speed: initial_fan.direction * e.speed,
        speed_measured: None,
        position: None,
        last_seen_s: None,
    };
    initial_fan.fan.edges.iter().map(front).collect()
}

fn effects(
    scene: &Scene,
    initial_fans: &[crate::bar::InitialFan],
    within: &mut dyn FnMut(Progress) -> ControlFlow<()>,
    notes: &mut Vec<String>,
) -> Vec<PlannedEffect> {
    let mut stopped = false;
    let (rows, reached) = run::estimate(scene, &mut |at| {
        let flow = within(at);
        stopped |= flow.is_break();
        flow
    });
    if stopped {
        let share = 100.0 * reached / scene.solve.until;
        notes.push(format!("the estimates of neglected effects cover the first {share:.2} % of the run"));
    }
    let planned = |key: &&str| match scene.effects.named(key) {
        Some(effect) => on(scene, key, effect),
        None => off(scene, key, rows.iter().find(|row| row.effect == **key)),
    };
    std::iter::once(plasticity(scene, initial_fans)).chain(Effects::KEYS.iter().map(planned)).collect()
}

/// Returns whether the first waves yield the bar. Reflections may do so later, which only the run shows.
fn plasticity(scene: &Scene, initial_fans: &[crate::bar::InitialFan]) -> PlannedEffect {
    let yields = initial_fans.iter().any(|l| {
        let material = &scene.bar.segments[l.segment].material;
        l.fan.stress > material.branch(l.sense).elastic_limit(material.modulus).1
    });
    let linear = scene.bar.segments.iter().all(|s| {
        [Sense::Tension, Sense::Compression].iter().all(|&sense| s.material.branch(sense).strain().len() == 2)
    });
    let worked = scene.bar.segments.iter().any(Segment::has_yielded);
    let why = match (linear, yields) {
        (true, _) => "the curves are straight lines",
        _ if worked => "the bar has an initial plastic strain",
        _ if scene.bar.has_initial_state() => {
            "the first waves of a bar with an initial stress are not predicted; plastic flow starts if a wave exceeds the \
             elastic limit"
        }
        (_, true) => "the first waves exceed the elastic limit",
        (_, false) => "the first waves are elastic; plastic flow starts if a later wave exceeds the elastic limit",
    };
    let (effect, on) = ("plasticity".into(), !linear);
    PlannedEffect { effect, on, why: why.into(), estimate: None, threshold: None }
}

fn chosen<'a>(scene: &'a Scene, key: &str) -> Option<&'a AutoChoice> {
    scene.auto.as_ref()?.choices.iter().find(|choice| choice.effect == key)
}

fn on(scene: &Scene, key: &str, effect: String) -> PlannedEffect {
    let choice = chosen(scene, key);
    let why = match (choice, &scene.auto) {
        (Some(choice), _) => choice.why.clone(),
        (None, Some(_)) => "another effect needs it".into(),
        (None, None) => "requested by the scene".into(),
    };
    let estimate = choice.map(|c| c.estimate).filter(|estimate| estimate.is_finite());
    PlannedEffect { effect, on: true, why, estimate, threshold: estimate.map(|_| scene.solve.audit_tolerance) }
}

fn off(scene: &Scene, key: &str, row: Option<&AuditRow>) -> PlannedEffect {
    let torsion = scene.torsion.is_some();
    let finding = || row.map_or_else(|| without(key, torsion).to_owned(), AuditRow::advice);
    let why = match (chosen(scene, key), &scene.auto) {
        (Some(choice), _) => choice.why.clone(),
        (None, Some(_)) => format!("not needed; {}", finding()),
        (None, None) => format!("not requested; {}", finding()),
    };
    let estimate = row.map(|row| row.estimate).filter(|e| !e.is_nan());
    PlannedEffect {
        effect: key.to_owned(),
        on: false,
        why,
        estimate,
        threshold: estimate.and(row.map(|row| row.threshold)),
    }
}

/// Returns the assumption that a run makes without an effect.
fn without(key: &str, torsion: bool) -> &'static str {
    match key {
        "hardening" => "unloading follows the loading curve; the run reports if a yielded section unloads",
        "rate" => "the quasi-static curve is used at all strain rates",
        "heat" => "the temperature stays constant",
        "rupture" => "fracture is not simulated",
        "damping" => "the only dissipation is plastic work",
        _ if torsion => "round sections in torsion have no lateral inertia",
        _ => "lateral inertia is neglected",
    }
}
