//! The library as other programs use it.

use std::ops::ControlFlow;
use std::path::Path;

use barwave::error::{Error, InputError, Result};
use barwave::impact::{
    self, Beam, Blow, Elastic, Face, Foundation, Plate, Section, Solid, Solution, Specimen, Spheres, Toughness,
};
use barwave::material::{Beyond, Curve};
use barwave::record::store::{ResultFile, StoredScene};
use barwave::record::{Field, Summary};
use barwave::run;
use barwave::scene::{ImpactScene, Problem, Scene, SceneBuilder};
use hdf5::types::VarLenUnicode;

fn pulled() -> SceneBuilder {
    Scene::builder()
        .set("bar.length", 0.5)
        .set("bar.diameter", "20 mm")
        .set("bar.material", "copper-annealed")
        .set("left.kind", "velocity")
        .set("left.value", "-20 m/s")
        .set("right.kind", "free")
        .set("solve.until", "50 us")
        .set("solve.cells", 100)
}

fn run_to(scene: &Scene, path: &Path) -> Result<Summary> {
    run::run(scene, Some(path), &mut |_| ControlFlow::Continue(()))
}

const SPHERES: &str = "[spheres]\nradius = 0.01\nmaterial = \"mild-steel\"\npoisson = 0.3\n[striker]\nradius = 0.01\n\
                       velocity = 1\nmaterial = \"mild-steel\"\npoisson = 0.3\n";

fn spheres_scene() -> Box<ImpactScene> {
    let Ok(Problem::Impact(impact)) = Problem::parse("spheres.toml", SPHERES, Path::new(""), &[]) else {
        panic!("an impact")
    };
    impact
}

#[test]
fn only_results_are_replaced() {
    let folder = tempfile::tempdir().expect("a folder");
    let (table, scene) = (folder.path().join("table.csv"), pulled().build().expect("a right scene"));
    std::fs::write(&table, "1,2\n").expect("written");
    let impact = spheres_scene();
    let interval = std::time::Duration::from_secs(60);
    let refused = [
        run_to(&scene, &table).map(|_| ()),
        run::run_with_checkpoints(&scene, &table, interval, &mut |_| ControlFlow::Continue(())).map(|_| ()),
        run::run_impact(&impact, Some(&table), &mut |_| ControlFlow::Continue(())).map(|_| ()),
    ];
    for ended in refused {
        let Err(Error::Input(error)) = ended else { panic!("{ended:?}") };
        assert!(error.message.contains("is not a result file") && !error.help.contains("--"), "{error:?}");
    }
    assert_eq!(std::fs::read(&table).expect("it is still there"), b"1,2\n");
    let result = folder.path().join("new/folder/out.h5");
    for _ in 0..2 {
        run_to(&scene, &result).expect("folders are made, and a result is replaced");
    }
}

#[test]
fn runs_to_one_path_leave_the_result_of_one() {
    let folder = tempfile::tempdir().expect("a folder");
    let (path, scene) = (folder.path().join("out.h5"), pulled().build().expect("a right scene"));
    let ended: Vec<Result<Summary>> = std::thread::scope(|scope| {
        let threads: Vec<_> = (0..4).map(|_| scope.spawn(|| run_to(&scene, &path))).collect();
        threads.into_iter().map(|thread| thread.join().expect("no panic")).collect()
    });
    assert!(ended.iter().any(Result::is_ok), "{ended:?}");
    assert_eq!(ResultFile::open(&path).expect("a result").metadata().outcome, "done");
    let left = std::fs::read_dir(folder.path()).expect("a folder").count();
    assert_eq!(left, 1, "nothing else is left");
}

#[test]
fn scenes_are_changed_by_their_keys_and_checked_again() {
    let folder = tempfile::tempdir().expect("a folder");
    let (path, scene) = (folder.path().join("out.h5"), pulled().build().expect("a right scene"));
    for wrong in ["bar.length=-1", "solve.until=-1", "solve.cells=0", "solve.cfl=2", "record.gauges={ a = 9 }"] {
        let Err(Error::Input(error)) = scene.with(&[wrong]) else { panic!("{wrong} was accepted") };
        assert!(error.place.is_some(), "{error:?}");
    }
    let faster = scene.with(&["left.value=-30 m/s"]).and_then(|faster| faster.with(&["solve.cells=200"]));
    let ran = run_to(&faster.expect("a right scene"), &path).expect("it runs");
    let stored = StoredScene::read(&path).expect("a scene");
    let again = Scene::parse("again.toml", &stored.text, Path::new(""), &stored.overrides).expect("a right scene");
    let again = run::run(&again, None, &mut |_| ControlFlow::Continue(())).expect("it runs");
    assert_eq!((ran.cells, ran.left.stress), (200, again.left.stress));
}

fn solved(problem: &dyn impact::Problem) -> std::result::Result<Solution, InputError> {
    problem.solve(&mut |_| ControlFlow::Continue(()))
}

fn assert_names(problem: &dyn impact::Problem, member: &str) {
    let error = solved(problem).expect_err(member);
    assert!(error.key == member && !error.allowed.is_empty() && !error.help.is_empty(), "{error:?}");
}

#[test]
fn impacts_out_of_range_are_errors_that_name_the_member() {
    let steel = Elastic { modulus: 207e9, poisson: 0.3, density: 7850.0, yield_stress: None };
    let ball = |velocity: f64| Solid { radius: 0.005, mass: 0.0041, velocity, elastic: steel };
    let plate = Plate { thickness: 0.01, elastic: steel, striker: ball(1.0), tolerance: 1e-6, until: None };
    let beam = Beam {
        length: 0.15,
        section: Section { area: 1e-4, inertia: 8e-10, depth: 0.01, face: Face::Flat { width: 0.01 } },
        elastic: steel,
        foundation: Foundation::default(),
        striker: ball(0.01),
        at: 0.075,
        gauges: Vec::new(),
        shapes: 0,
        until: None,
        tolerance: 1e-3,
        modes: None,
    };
    let hertz = |solids| Spheres::Hertz { solids, tolerance: 1e-6 };
    assert!(solved(&plate).is_ok() && solved(&beam).is_ok() && solved(&hertz([ball(1.0), ball(0.5)])).is_ok());
    for wrong in [f64::NAN, 0.0, -1.0] {
        assert_names(&Plate { thickness: wrong, ..plate.clone() }, "thickness");
        assert_names(&Plate { tolerance: wrong, ..plate.clone() }, "tolerance");
        assert_names(&Plate { striker: ball(wrong), ..plate.clone() }, "striker.velocity");
        assert_names(&Beam { striker: ball(wrong), ..beam.clone() }, "striker.velocity");
        assert_names(&Beam { until: Some(wrong), ..beam.clone() }, "until");
        assert_names(&Beam { at: wrong, ..beam.clone() }, "at");
        let elastic = Elastic { density: wrong, ..steel };
        assert_names(&Beam { elastic, ..beam.clone() }, "elastic.density");
        assert_names(&hertz([ball(1.0), Solid { mass: wrong, ..ball(0.0) }]), "solids.1.mass");
        let masses = [wrong, 1.0];
        assert_names(&Spheres::Pendulum { masses, after: 1.0 }, "masses.0");
        assert_names(&Spheres::Restitution { masses, velocities: [1.0, 0.0], restitution: 1.0 }, "masses.0");
        let specimen = Specimen { length: 0.1, area: 1e-4, toughness: Toughness::PerVolume(1e8) };
        assert_names(&Blow { specimen, mass: wrong, velocity: 1.0 }, "mass");
    }
    for struck in [1.0, 2.0, f64::NAN] {
        assert_names(&hertz([ball(1.0), ball(struck)]), "solids.0.velocity");
    }
    let buckled = Foundation { axial: 1e9, ..Foundation::default() };
    assert_names(&Beam { foundation: buckled, ..beam.clone() }, "foundation.axial");
}

#[test]
fn spheres_that_hardly_close_are_refused() {
    let text = SPHERES.replace("velocity = 1\n", "velocity = 1e-160\n");
    let read = Problem::parse("spheres.toml", &text, Path::new(""), &[]);
    let Err(Error::Input(error)) = read else { panic!("accepted") };
    assert!(error.key == "striker.velocity" && error.message.contains("closing velocity of 1e-160 m/s"), "{error}");
}

#[test]
fn errors_of_a_main_function_read_as_those_of_the_command_line() {
    let error = pulled().set("solve.cfl", 1.5).build().expect_err("a wrong scene");
    let shown = format!("{error:?}");
    assert_eq!(shown, error.text());
    assert!(shown.starts_with("`solve.cfl`: 1.5 is out of range\n") && !shown.contains("copper"), "{shown}");
    for part in ["--> scene:", "cfl = 1.5", "allowed: 0 < cfl <= 1", "\nhelp: "] {
        assert!(shown.contains(part), "no `{part}` in {shown}");
    }
    assert!(!error.to_string().contains('\n'));
    let curve = || -> Result<Curve> { Ok(Curve::new(&[(0.0, 0.0), (0.2, 5e8), (0.1, 6e8)], Beyond::Extend)?) };
    assert!(curve().expect_err("strains that fall").text().starts_with("row 3: "));
}

#[test]
fn wrong_calls_of_a_result_file_are_not_said_to_be_damage() {
    let folder = tempfile::tempdir().expect("a folder");
    let (path, spheres) = (folder.path().join("out.h5"), folder.path().join("spheres.h5"));
    run_to(&pulled().set("record.frames", 11).build().expect("a right scene"), &path).expect("it runs");
    let file = ResultFile::open(&path).expect("a result");
    let impact = spheres_scene();
    run::run_impact(&impact, Some(&spheres), &mut |_| ControlFlow::Continue(())).expect("it runs");
    let of_impact = ResultFile::open(&spheres).expect("a result");
    assert!(file.field(Field::Stress, 0..11).is_ok());
    #[expect(clippy::reversed_empty_ranges, reason = "a mistake of the caller")]
    let backwards = file.field(Field::Stress, 3..2);
    for (ended, message) in [
        (file.field(Field::Stress, 0..10_000).map(|_| ()), "the frames 0..10000 are not in the file"),
        (backwards.map(|_| ()), "the frames 3..2 are not in the file"),
        (file.field(Field::Temperature, 0..1).map(|_| ()), "the file has no field `temperature`"),
        (of_impact.time().map(|_| ()), "the file holds an impact of the kind `spheres`"),
        (of_impact.ledger().map(|_| ()), "the file holds an impact of the kind `spheres`"),
        (of_impact.field(Field::Stress, 0..1).map(|_| ()), "the file holds an impact of the kind `spheres`"),
    ] {
        let Err(Error::Input(error)) = ended else { panic!("{message}: {ended:?}") };
        assert!(error.message.contains(message) && !error.allowed.is_empty(), "{error:?}");
    }
}

#[test]
fn files_of_impacts_spell_units_as_those_of_bars_and_name_each_material_once() {
    let folder = tempfile::tempdir().expect("a folder");
    let (path, bar) = (folder.path().join("spheres.h5"), folder.path().join("bar.h5"));
    let impact = spheres_scene();
    run::run_impact(&impact, Some(&path), &mut |_| ControlFlow::Continue(())).expect("it runs");
    let file = ResultFile::open(&path).expect("a result");
    let stored = file.impact().expect("readable").expect("an impact");
    let units: Vec<&str> = stored.figures.iter().map(|figure| figure.units.as_str()).collect();
    assert!(units.contains(&"N s") && !units.iter().any(|units| units.contains('*')), "{units:?}");
    assert_eq!(file.materials().expect("readable").len(), 1);
    run_to(&pulled().build().expect("a right scene"), &bar).expect("it runs");
    let stress = hdf5::File::open(&bar).expect("HDF5").dataset("material/copper-annealed/compression_stress");
    let name = stress.and_then(|stress| stress.attr("long_name")).and_then(|name| name.read_scalar::<VarLenUnicode>());
    assert_eq!(name.expect("a long name").as_str(), "magnitude of the engineering stress in compression");
}
