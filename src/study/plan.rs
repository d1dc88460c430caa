//! What a run would do and cost, without running it.

use std::time::Instant;

use serde::Serialize;

use crate::assemble;
use crate::bar::{Segment, launches};
use crate::law::{Table, elastic_row};
use crate::material::Sense;
use crate::record::FrontSummary;
use crate::run;
use crate::scene::{Method, Scene};
use crate::solver::fd::Grid;
use crate::solver::moc::{FrontTracking, Settings};

/// The plan of a scene. Keys are those of `barwave plan --json`.
#[derive(Debug, Clone, Serialize)]
pub struct Plan {
    /// Scene title.
    pub scene: String,
    /// "fd" or "moc".
    pub method: String,
    /// "leapfrog" or "front-tracking".
    pub scheme: String,
    /// What is simulated, what is not, and why.
    pub effects: Vec<PlannedEffect>,
    /// What the method takes; its keys stand beside the others.
    #[serde(flatten)]
    pub work: Work,
    /// Fields before compression, bytes.
    pub field_bytes: usize,
    /// Fronts that the theory sends out at the start.
    pub fronts: Vec<FrontSummary>,
    /// Of the struck material; null where the data hold none.
    #[serde(rename = "critical_velocity_m_s")]
    pub critical_velocity: Option<f64>,
    /// The scene drives the bar beyond it.
    pub above_critical: bool,
}

/// Size and cost of a run, by method.
#[derive(Debug, Clone, Serialize)]
#[serde(untagged)]
pub enum Work {
    /// On a grid.
    Grid {
        /// Cells of the bar.
        cells: usize,
        /// Time step, s.
        dt_s: f64,
        /// Steps to the end time.
        steps: usize,
        /// Solver memory of a cell while it is elastic.
        bytes_per_elastic_cell: usize,
        /// Solver memory of a cell after its block has yielded.
        bytes_per_yielded_cell: usize,
        /// Solver memory if the whole bar yields, bytes.
        memory_bytes: usize,
        /// Stepping time if every cell is at work all the time, s: between an elastic and an all-plastic run.
        expected_s: [f64; 2],
    },
    /// By fronts: how many meet depends on what they make of each other, which only the run finds out.
    Fronts {
        /// Of the largest stress that the scene's data can reach.
        front_tolerance: f64,
        /// The same in Pa: weaker waves are held back.
        #[serde(rename = "held_back_Pa")]
        held_back: f64,
        /// Fronts under way after t = 0.
        first_fronts: usize,
        /// Straight pieces of the curve with the most of them.
        lines: usize,
        /// Meetings that the run may take.
        event_budget: u64,
        /// Solver memory of a front under way.
        bytes_per_front: usize,
        /// Time if the whole budget is used, s.
        longest_s: f64,
    },
}

/// An effect in a plan.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct PlannedEffect {
    /// e.g. "plasticity".
    pub effect: String,
    /// Simulated or not.
    pub on: bool,
    /// Why.
    pub why: String,
}

/// Time of one step of one yielded cell over that of an elastic cell, all kernels and the ripple damping included.
/// Measured on bilinear and 60-knot curves at 10000 cells; it differs by a factor of two between processors.
const PLASTIC_COST: f64 = 6.0;

/// Makes the plan.
pub fn plan(scene: &Scene) -> Plan {
    let all = launches(&scene.bar, &scene.left, &scene.right);
    let [method, scheme] = scene.solve.method.names();
    let (work, cells) = match scene.solve.method {
        Method::Leapfrog { cells, cfl } => grid_work(scene, &Grid::new(&scene.bar, cells, cfl)),
        Method::FrontTracking { front_tolerance, event_budget } => {
            (front_work(scene, front_tolerance, event_budget), 0)
        }
    };
    let samples = scene.record.cells.unwrap_or(cells) * scene.record.times.len() * scene.record.fields.len();
    Plan {
        scene: scene.title.clone(),
        method: method.into(),
        scheme: scheme.into(),
        effects: effects(scene, &all),
        work,
        field_bytes: samples * size_of::<f64>(),
        fronts: all.iter().flat_map(fronts).collect(),
        critical_velocity: run::critical_velocity(scene, &all),
        above_critical: all.iter().any(|l| l.fan.above_critical),
    }
}

/// The work on a grid, and its cells.
fn grid_work(scene: &Scene, grid: &Grid) -> (Work, usize) {
    let (cells, steps) = (grid.cells(), run::steps(scene, grid.dt));
    let law = assemble::segment_law(&scene.bar.segments[0], &scene.effects);
    let number = size_of::<f64>();
    // Stress and velocity; then the law's state and a byte for the damping.
    let (elastic, yielded) = (2 * number, (2 + law.law.state_len()) * number + 1);
    let quickest = elastic_seconds_per_cell_step() * (cells * steps) as f64;
    let work = Work::Grid {
        cells,
        dt_s: grid.dt,
        steps,
        bytes_per_elastic_cell: elastic,
        bytes_per_yielded_cell: yielded,
        memory_bytes: cells * yielded,
        expected_s: [quickest, PLASTIC_COST * quickest],
    };
    (work, cells)
}

/// Time of one event. Measured on curves of 10 to 60 straight pieces; it differs by a factor of two between processors.
const SECONDS_PER_EVENT: f64 = 1e-6;

fn front_work(scene: &Scene, front_tolerance: f64, event_budget: u64) -> Work {
    let settings = Settings { front_tolerance, event_budget, ..Settings::default() };
    // What its start shows is worth a plan of its own.
    let start = assemble::front_tracking(scene, settings);
    let table = |s: &Segment, sense| Table::new(s.material.branch(sense), s.material.modulus).lines().len();
    let lines = |s| table(s, Sense::Tension).max(table(s, Sense::Compression));
    Work::Fronts {
        front_tolerance,
        held_back: front_tolerance * start.stress_scale(),
        first_fronts: start.front_count(),
        lines: scene.bar.segments.iter().map(lines).max().unwrap_or(0),
        event_budget,
        bytes_per_front: FrontTracking::BYTES_PER_FRONT,
        longest_s: SECONDS_PER_EVENT * event_budget as f64,
    }
}

fn fronts(launch: &crate::bar::Launch) -> Vec<FrontSummary> {
    let sign = launch.sense.sign();
    let front = |e: &crate::wave::similarity::Edge| FrontSummary {
        origin: launch.origin.to_string(),
        strain_ahead: sign * e.strain_ahead,
        strain_behind: sign * e.strain_behind,
        stress_ahead: sign * e.stress_ahead,
        stress_behind: sign * e.stress_behind,
        speed: launch.direction * e.speed,
        speed_measured: None,
        position: None,
        last_seen_s: None,
    };
    launch.fan.edges.iter().map(front).collect()
}

/// The first waves decide whether a bar yields; reflections may make it yield later, which the run itself finds out.
fn effects(scene: &Scene, launches: &[crate::bar::Launch]) -> Vec<PlannedEffect> {
    let yields = launches.iter().any(|l| {
        let material = &scene.bar.segments[l.segment].material;
        l.fan.stress > material.branch(l.sense).elastic_limit(material.modulus).1
    });
    let linear = scene.bar.segments.iter().all(|s| {
        [Sense::Tension, Sense::Compression].iter().all(|&sense| s.material.branch(sense).strain().len() == 2)
    });
    let why = match (linear, yields) {
        (true, _) => "the curves are straight lines",
        (_, true) => "the first waves carry more than the elastic limit",
        (_, false) => {
            "the first waves stay below the elastic limit: the elastic kernel runs, and the law takes over in the \
             step in which a reflection first yields a cell, if one does"
        }
    };
    let mut list = vec![PlannedEffect { effect: "plasticity".into(), on: yields && !linear, why: why.into() }];
    let unloading = run::effect_names(&scene.effects, false).into_iter().next();
    list.push(match unloading {
        Some(effect) => PlannedEffect { effect, on: true, why: "the scene asks for it".into() },
        None => PlannedEffect {
            effect: "unloading".into(),
            on: false,
            why: "the scene does not ask for it; the run says so if a yielded point unloads".into(),
        },
    });
    list
}

/// Time of the elastic kernel on this machine: the shortest of some runs over one row in the cache.
fn elastic_seconds_per_cell_step() -> f64 {
    let (v, mut sigma) = (vec![0.0; 513], vec![0.0; 512]);
    let mut best = f64::INFINITY;
    for _ in 0..20 {
        let start = Instant::now();
        for _ in 0..100 {
            std::hint::black_box(elastic_row(1.0, std::hint::black_box(&v), &mut sigma));
        }
        best = best.min(start.elapsed().as_secs_f64() / 51_200.0);
    }
    // The velocity half of the step costs about as much again.
    2.0 * best
}
