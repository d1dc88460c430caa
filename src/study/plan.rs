//! What a run would do and cost, without running it.

use std::time::Instant;

use serde::Serialize;

use crate::assemble;
use crate::bar::launches;
use crate::law::elastic_row;
use crate::material::Sense;
use crate::record::FrontSummary;
use crate::run;
use crate::scene::{Method, Scene};
use crate::solver::fd::Grid;

/// The plan of a scene. Keys are those of `barwave plan --json`.
#[derive(Debug, Clone, Serialize)]
pub struct Plan {
    /// Scene title.
    pub scene: String,
    /// "fd".
    pub method: String,
    /// "leapfrog".
    pub scheme: String,
    /// What is simulated, what is not, and why.
    pub effects: Vec<PlannedEffect>,
    /// Cells of the bar.
    pub cells: usize,
    /// Time step, s.
    pub dt_s: f64,
    /// Steps to the end time.
    pub steps: usize,
    /// Solver memory of a cell while it is elastic.
    pub bytes_per_elastic_cell: usize,
    /// Solver memory of a cell after its block has yielded.
    pub bytes_per_yielded_cell: usize,
    /// Solver memory if the whole bar yields, bytes.
    pub memory_bytes: usize,
    /// Fields before compression, bytes.
    pub field_bytes: usize,
    /// Stepping time if every cell is at work all the time, s: between an elastic and an all-plastic run.
    pub expected_s: [f64; 2],
    /// Fronts that the theory sends out at the start.
    pub fronts: Vec<FrontSummary>,
    /// Of the struck material; null where the data hold none.
    #[serde(rename = "critical_velocity_m_s")]
    pub critical_velocity: Option<f64>,
    /// The scene drives the bar beyond it.
    pub above_critical: bool,
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
    let Method::Leapfrog { cells, cfl } = scene.solve.method;
    let grid = Grid::new(&scene.bar, cells, cfl);
    let (cells, steps) = (grid.cells(), run::steps(scene, grid.dt));
    let all = launches(&scene.bar, &scene.left, &scene.right);
    let law = assemble::segment_law(&scene.bar.segments[0], &scene.effects);
    let number = size_of::<f64>();
    // Stress and velocity; then the law's state and a byte for the damping.
    let (elastic, yielded) = (2 * number, (2 + law.law.state_len()) * number + 1);
    let samples = scene.record.cells.unwrap_or(cells) * scene.record.times.len() * scene.record.fields.len();
    let quickest = elastic_seconds_per_cell_step() * (cells * steps) as f64;
    Plan {
        scene: scene.title.clone(),
        method: "fd".into(),
        scheme: "leapfrog".into(),
        effects: effects(scene, &all),
        cells,
        dt_s: grid.dt,
        steps,
        bytes_per_elastic_cell: elastic,
        bytes_per_yielded_cell: yielded,
        memory_bytes: cells * yielded,
        field_bytes: samples * number,
        expected_s: [quickest, PLASTIC_COST * quickest],
        fronts: all.iter().flat_map(fronts).collect(),
        critical_velocity: run::critical_velocity(scene, &all),
        above_critical: all.iter().any(|l| l.fan.above_critical),
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
