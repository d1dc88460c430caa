//! What a run gives in memory is what it writes to a file.

use std::ops::ControlFlow;

use barwave::record::store::ResultFile;
use barwave::run;
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
    let solution = run::solve(scene, &mut |_| ControlFlow::Continue(())).expect("it runs");
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
    let gauge = &solution.gauges["middle"];
    assert!(gauge.time.len() > 10 && gauge.stress.len() == gauge.time.len());
    assert!(solution.ends.iter().all(|end| end.time.len() == end.stress.len() && !end.time.is_empty()));
}

#[test]
fn a_solution_is_that_of_the_file_by_every_method() {
    let grid = |scheme: &str| pulled().set("solve.method", "fd").set("solve.scheme", scheme).set("solve.cells", 200);
    for scene in [grid("leapfrog"), grid("muscl"), pulled().set("solve.method", "moc")] {
        let scene = scene.set("record.fields", vec!["stress", "velocity"]);
        assert_same(&scene.build().unwrap_or_else(|e| panic!("{e}")));
    }
}

#[test]
fn a_solution_to_a_tolerance_is_that_of_the_method_chosen() {
    assert_same(&pulled().set("solve.tolerance", 3e-2).build().expect("a right scene"));
}
