//! The solution that a run returns in memory is the one that it writes to a file.

use std::ops::ControlFlow;

use barwave::error::Error;
use barwave::record::store::ResultFile;
use barwave::record::{Field, FrontRow};
use barwave::run::{self, Progress, Solution};
use barwave::scene::{Scene, SceneBuilder};

fn pulled() -> SceneBuilder {
    Scene::builder()
        .set("bar.length", 0.5)
        .set("bar.diameter", "20 mm")
        .set("bar.material", "copper-annealed")
        .set("left.kind", "velocity")
        .set("left.value", "-20 m/s")
        .set("right.kind", "free")
        .set("effects.hardening", "isotropic")
        .set("solve.until", "200 us")
        .set("record.frames", 11)
        .set("record.gauges.middle", 0.25)
        .set("record.gauges.before", 0.1)
}

fn assert_same(scene: &Scene) {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("out.h5");
    run::run(scene, Some(&path), &mut |_| ControlFlow::Continue(())).expect("it runs");
    let file = ResultFile::open(&path).expect("a result file");
    let solution = run::solution(scene).expect("it runs");
    assert_eq!(solution.time.to_vec(), file.time().expect("times"));
    assert_eq!(solution.x.to_vec(), file.x().expect("samples"));
    assert_eq!(solution.ledger.len(), solution.time.len());
    assert!(!solution.fields.is_empty());
    for (field, values) in &solution.fields {
        assert_eq!(*values, file.field(*field, 0..solution.time.len()).expect("a field"), "{field:?}");
    }
    let places: Vec<(String, f64)> =
        file.gauges().expect("gauges").into_iter().map(|gauge| (gauge.name, gauge.x)).collect();
    assert_eq!(solution.gauge_places, places);
    let arrivals = |fronts: &[FrontRow]| -> Vec<(String, Vec<u64>)> {
        fronts.iter().map(|row| (row.origin.clone(), row.arrivals.iter().map(|t| t.to_bits()).collect())).collect()
    };
    assert!(!solution.fronts.is_empty() && solution.fronts[0].arrivals.len() == places.len());
    assert_eq!(arrivals(&solution.fronts), arrivals(&file.fronts().expect("fronts")));
    assert_eq!(solution.paths, file.paths().unwrap_or_default());
    assert_eq!(solution.paths_complete, scene.record.paths);
    assert_eq!(solution.paths.is_empty(), !scene.record.paths);
    let gauge = &solution.gauges["middle"];
    assert!(gauge.time.len() > 10 && gauge.stress.len() == gauge.time.len());
    assert!(solution.ends.iter().all(|end| end.time.len() == end.stress.len() && !end.time.is_empty()));
}

#[test]
fn a_solution_is_that_of_the_file_by_every_method() {
    let grid = |scheme: &str| pulled().set("solve.method", "fd").set("solve.scheme", scheme).set("solve.cells", 200);
    let moc = || pulled().set("solve.method", "moc");
    for scene in [grid("leapfrog"), grid("muscl"), moc(), moc().set("record.paths", true)] {
        let scene = scene.set("record.fields", vec!["stress", "velocity"]);
        assert_same(&scene.build().unwrap_or_else(|e| panic!("{e}")));
    }
}

#[test]
fn a_solution_to_a_tolerance_is_that_of_the_method_chosen() {
    assert_same(&pulled().set("solve.tolerance", 3e-2).build().expect("a right scene"));
}

/// Runs a scene that is stopped at the first call of `progress` for which `due` holds.
fn stopped(scene: SceneBuilder, mut due: impl FnMut(&Progress) -> bool) -> barwave::error::Result<Solution> {
    run::solve(&scene.build().expect("a right scene"), &mut |at| {
        if due(&at) { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    })
}

#[test]
fn a_run_that_is_stopped_leaves_what_it_has_done() {
    let past_half = |at: &Progress| match *at {
        Progress::Steps { step, steps, .. } => 2 * step > steps,
        Progress::Fronts { time, until, .. } => 2.0 * time > until,
        _ => false,
    };
    let grid = pulled().set("solve.method", "fd").set("solve.cells", 4000);
    let fronts = pulled().set("solve.method", "moc").set("record.paths", true);
    for (scene, paths) in [(grid, false), (fronts, true)] {
        let whole = run::solution(&scene.clone().build().expect("a right scene")).expect("it runs");
        let solution = stopped(scene, past_half).expect("what was simulated");
        let frames = solution.time.len();
        assert_eq!((whole.summary.outcome.as_str(), solution.summary.outcome.as_str()), ("done", "interrupted"));
        assert!((2..11).contains(&frames) && solution.summary.end_time_s < 2e-4, "{frames}");
        let stress = |solution: &Solution| solution.field(Field::Stress).expect("recorded").row(frames - 1).to_vec();
        assert_eq!(stress(&solution), stress(&whole));
        assert_eq!((solution.paths.is_empty(), solution.paths_complete), (!paths, false));
        assert!(solution.gauges["middle"].time.len() < whole.gauges["middle"].time.len());
    }
}

#[test]
fn a_search_for_a_method_that_is_stopped_has_no_solution() {
    let ended = stopped(pulled().set("solve.tolerance", 3e-2), |at| matches!(at, Progress::Tried { .. }));
    assert!(matches!(ended, Err(Error::Interrupted)), "{ended:?}");
}
