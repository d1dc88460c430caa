//! The library as used by other programs.

use std::ops::ControlFlow;
use std::path::Path;

use barwave::bar::History;
use barwave::error::{Error, InputError, Result};
use barwave::impact::{
    self, Beam, Blow, Elastic, Foundation, Plate, Section, Solid, Solution, Specimen, Spheres, Toughness,
};
use barwave::material::{
    Beyond, Curve, Law, Material, Measure, Sense, Tabulate, library, tabulate_law, tabulate_true_rows,
};
use barwave::record::store::{ResultFile, StoredScene};
use barwave::record::{Field, Measure as Measured, Summary};
use barwave::report::{self, Figure, PanelName};
use barwave::run;
use barwave::scene::{ImpactScene, IntoValue, Problem, Scene, SceneBuilder};
use barwave::study::bracket::{RateAndHeat, apparent};
use barwave::study::cost::{Hooks, cost};
use barwave::study::sweep::{self, Shard, Sweep};
use barwave::toml::Value;
use hdf5::types::VarLenUnicode;

use crate::common::impacts::{STEEL, ball, beam, plate};

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
    let (plate, beam) = (plate(), beam());
    let hertz = |solids| Spheres::Hertz { solids, tolerance: 1e-6 };
    assert!(solved(&plate).is_ok() && solved(&beam).is_ok() && solved(&hertz([ball(1.0), ball(0.5)])).is_ok());
    for wrong in [f64::NAN, 0.0, -1.0] {
        assert_names(&Plate { thickness: wrong, ..plate.clone() }, "thickness");
        assert_names(&Plate { tolerance: wrong, ..plate.clone() }, "tolerance");
        assert_names(&Plate { striker: ball(wrong), ..plate.clone() }, "striker.velocity");
        assert_names(&Beam { striker: ball(wrong), ..beam.clone() }, "striker.velocity");
        assert_names(&Beam { until: Some(wrong), ..beam.clone() }, "until");
        assert_names(&Beam { at: wrong, ..beam.clone() }, "at");
        let elastic = Elastic { density: wrong, ..STEEL };
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
    let allowed = |problem: &dyn impact::Problem| solved(problem).expect_err("out of range").allowed;
    assert!(allowed(&Beam { foundation: buckled, ..beam.clone() }).starts_with("axial < "));
    let masses = [1.0, 0.0];
    assert_eq!(allowed(&Spheres::Pendulum { masses, after: 1.0 }), "masses > 0");
    // Lengths of such magnitudes would make the buckling load infinite or NaN.
    for length in [1e300, 1e-300] {
        assert_names(&Beam { length, ..beam.clone() }, "length");
    }
    // Half of the area at each face: 2.5e-9 m^4.
    for inertia in [2.6e-9, 1e-7] {
        assert_names(&Beam { section: Section { inertia, ..beam.section }, ..beam.clone() }, "section.inertia");
    }
    assert!(solved(&Beam { section: Section { inertia: 2.5e-9, ..beam.section }, ..beam.clone() }).is_ok());
}

fn copper() -> Material {
    library::find("copper-annealed", Path::new("")).expect("a material")
}

fn refused<T>(ended: Result<T>) -> InputError {
    match ended {
        Err(Error::Input(error)) if !error.help.is_empty() && !error.help.contains("--") => error,
        Err(error) => panic!("{error:?}"),
        Ok(_) => panic!("accepted"),
    }
}

#[test]
fn an_apparent_critical_velocity_needs_the_constants_of_its_effects() {
    for (with, key, message) in [
        (RateAndHeat { rate: true, heat: false }, "rate", "`copper-annealed`: the material has no rate constants"),
        (RateAndHeat { rate: false, heat: true }, "heat", "`copper-annealed`: the material lacks constants of [heat]"),
    ] {
        let error = refused(apparent(&copper(), Sense::Tension, with, 0.2));
        assert!(error.key == key && error.message.starts_with(message), "{error:?}");
    }
    for length in [f64::NAN, 0.0, -1.0, f64::INFINITY, 1e-4] {
        let error = refused(apparent(&copper(), Sense::Tension, RateAndHeat::default(), length));
        assert_eq!((error.key.as_str(), error.allowed.as_str()), ("length", "0.001 <= length <= 1000 m"));
    }
}

#[test]
fn only_a_part_of_the_plastic_work_turns_into_heat() {
    let steel = library::find("steel-4340-jc", Path::new("")).expect("a material");
    assert!(steel.heated(Some(0.0)).is_ok() && steel.heated(Some(1.0)).is_ok());
    for fraction in [f64::NAN, f64::INFINITY, -0.1, 1.1] {
        let error = refused(steel.heated(Some(fraction)).map_err(Error::from));
        assert_eq!((error.key.as_str(), error.allowed.as_str()), ("fraction", "0 <= fraction <= 1"));
    }
    let boxed = || -> std::result::Result<Material, Box<dyn std::error::Error>> { Ok(copper().heated(None)?) };
    assert!(boxed().expect_err("it has no constants").to_string().contains("specific-heat"));
}

#[test]
fn tables_of_laws_and_true_stresses_end_within_a_tolerance() {
    let law = Law::Ludwik { yield_stress: 200e6, k: 300e6, n: 0.5 };
    let rows = [(0.001, 200e6), (0.2, 500e6)];
    let of_law = |tolerance: f64| {
        let how = Tabulate { tolerance, to_strain: None };
        tabulate_law(&law, 200e9, Measure::True, Sense::Tension, how)
    };
    let of_rows = |tolerance: f64| tabulate_true_rows(&rows, Some(200e9), Sense::Tension, tolerance);
    assert!(of_law(0.1).is_ok() && of_rows(1e-4).is_ok());
    for tolerance in [0.0, -1e-3, f64::NAN, f64::INFINITY, 0.2, 1e-9] {
        for ended in [of_law(tolerance), of_rows(tolerance)] {
            assert_eq!(refused(ended.map_err(Error::from)).key, "tolerance");
        }
    }
}

#[test]
fn a_study_of_cost_needs_a_budget() {
    let scene = pulled().build().expect("a right scene");
    for budget in [f64::NAN, 0.0, -1.0, f64::INFINITY] {
        let mut hooks =
            Hooks { budget, measure: Measured::Field, whole: None, progress: &mut |_, _| ControlFlow::Break(()) };
        assert_eq!(refused(cost(&scene, &mut hooks)).key, "budget");
    }
}

#[test]
fn a_sweep_has_no_other_cases_than_its_own() {
    let folder = tempfile::tempdir().expect("a folder");
    let scene = "[bar]\nlength = 0.1\nmaterial = 'mild-steel'\n[left]\nkind = 'velocity'\nvalue = -1\n[right]\nkind = 'free'\n\
                 [solve]\nuntil = 1e-5\n";
    std::fs::write(folder.path().join("scene.toml"), scene).expect("a file");
    let file = "[sweep]\nscene = 'scene.toml'\n[axes]\n'left.value' = [-1, -2, -3]\n";
    std::fs::write(folder.path().join("sweep.toml"), file).expect("a file");
    let sweep = Sweep::read(&folder.path().join("sweep.toml")).expect("a sweep");
    assert_eq!(sweep.plan.overrides(2).expect("the last case"), ["left.value=-3"]);
    for error in [refused(sweep.plan.overrides(3)), refused(sweep.problem(99).map(|_| ()))] {
        assert_eq!((error.key.as_str(), error.allowed.as_str()), ("case", "0 <= case < 3"));
    }
    let stop = std::sync::atomic::AtomicBool::new(false);
    for (index, count) in [(0, 0), (1, 0), (0, 2), (3, 2)] {
        let shard = Shard { index, count };
        assert!(!(0..6).any(|case| shard.has(case)), "{shard:?}");
        let out = folder.path().join("out");
        let error = refused(sweep::run(&sweep, &out, shard, false, &|_| {}, &stop));
        assert!(error.key == "shard" && !out.exists(), "{error:?}");
    }
}

#[test]
fn figures_have_a_size_that_memory_can_hold() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("out.h5");
    run_to(&pulled().build().expect("a right scene"), &path).expect("it runs");
    let file = ResultFile::open(&path).expect("a result");
    let figure = |size: [f64; 2]| Figure { size: Some(size), ..Figure::default() };
    assert!(report::draw(&file, &figure([10_000.0, 10_000.0])).is_ok());
    for size in [[1e9, 1e9], [800.0, 10_001.0], [f64::NAN, 600.0], [800.0, 0.0], [5.0, 5.0]] {
        let figure = figure(size);
        assert_eq!(refused(report::draw(&file, &figure)).key, "size");
        if size != [5.0, 5.0] {
            assert_eq!(refused(report::page(&file, &figure)).key, "size");
        }
    }
    let of_panel = Figure { panels: vec![PanelName::Gauges], ..Figure::default() };
    assert_eq!(refused(report::draw(&file, &of_panel)).key, "panels");
    assert_eq!(refused(report::plot::Format::of(Path::new("figure.bmp"))).key, "path");
}

#[test]
fn items_of_lists_are_set_by_their_numbers() {
    let segment = |length: f64| {
        let mut segment = toml::Table::from_iter([("length".to_owned(), Value::from(length))]);
        segment.insert("material".to_owned(), "copper-annealed".into());
        segment
    };
    let of_two = Scene::builder()
        .set("bar.segment", vec![segment(0.2), segment(0.3)])
        .set("bar.segment.1.length", "400 mm")
        .set("left.kind", "free")
        .set("right.kind", "free")
        .set("solve.until", 1e-4);
    let scene = of_two.clone().build().expect("a right scene");
    assert_eq!(scene.bar.segments.iter().map(|segment| segment.length).collect::<Vec<_>>(), [0.2, 0.4]);
    let error = refused(of_two.set("bar.segment.3.length", 0.1).build());
    assert!(error.key == "bar.segment.3.length" && error.message.contains("the list has 2"), "{error:?}");
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
    let history = || -> Result<History> { Ok(History::new(&[(0.0, 1.0), (1e-3, f64::NAN)])?) };
    assert_eq!(history().expect_err("no number").to_string(), "`rows`: row 1 (counted from 0) is not finite");
    let curve = || -> Result<Curve> { Ok(Curve::new(&[(0.0, 0.0), (0.2, 5e8), (0.1, 6e8)], Beyond::Extend)?) };
    assert!(curve().expect_err("strains that fall").text().contains("row 2 (counted from 0): "));
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

#[test]
fn a_material_from_a_program_is_that_of_the_library() {
    for (material, effects) in [
        ("copper-annealed", "{ hardening = 'isotropic' }"),
        ("steel-4340-jc", "{ hardening = 'isotropic', heat = {} }"),
        ("steel-4340-jc", "{ rate = 'material' }"),
    ] {
        let scene = pulled().set("effects", effects.parse::<Value>().expect("a table"));
        let by_name = scene.clone().set("bar.material", material).build().expect("a right scene");
        let found = library::find(material, Path::new("")).expect("a material");
        let given = scene.set("bar.material", &found).build().expect("a right scene");
        let changed = by_name.with_value("bar.material", &found).expect("a right scene");
        let expected = run::solution(&by_name).expect("it runs");
        assert!(expected.summary.left.strain > 1e-3);
        for scene in [given, changed] {
            let solution = run::solution(&scene).expect("it runs");
            assert_eq!(solution.fields, expected.fields, "{material}");
            assert_eq!(solution.ends[0].stress, expected.ends[0].stress, "{material}");
        }
    }
    let curve = Curve::new(&[(0.001, 2e8), (0.1, 3e8)], Beyond::Error).expect("a curve");
    let scene = pulled().set("bar.material", Material::from_curve("mine", 7850.0, curve.clone()).expect("a material"));
    let scene = scene.set("bar.material.curve", &curve).build().expect("a right scene");
    assert_eq!(scene.bar.segments[0].material.tension, curve);
}

#[test]
fn values_of_rust_are_those_of_a_file() {
    let rows = "[[0.0, 1.0], [1e-5, 0.0]]".parse::<Value>().expect("rows");
    let (pairs, arrays) = (vec![(0.0, 1.0), (1e-5, 0.0)], [[0.0, 1.0], [1e-5, 0.0]]);
    assert_eq!((&pairs).into_value(), rows);
    assert_eq!(arrays.to_vec().into_value(), rows);
    assert_eq!(arrays.as_slice().into_value(), rows);
    assert_eq!(ndarray::arr2(&arrays).into_value(), rows);
    let times = [0.0, 2.5e-5, 5e-5];
    let with = |times: Value| pulled().set("record.times", times).build().expect("a right scene").record.times.clone();
    for value in [times.into_value(), times[..].into_value(), (&ndarray::Array1::linspace(0.0, 5e-5, 3)).into_value()] {
        assert_eq!(with(value), times);
    }
    let cells: usize = 150;
    assert_eq!(pulled().set("solve.cells", cells).build().expect("a right scene").solve.method.cells(), Some(cells));
}

#[test]
fn errors_of_changes_are_in_the_words_of_the_library() {
    let scene = pulled().build().expect("a right scene");
    let error = refused(scene.with(&["left.value"]));
    assert_eq!((error.key.as_str(), error.message.as_str()), ("changes", "left.value: missing `=`"));
    for error in [refused(scene.with(&["solve.until=-1"])), refused(scene.with_value("solve.until", -1.0))] {
        assert_eq!((error.key.as_str(), error.place.expect("a place").file.as_str()), ("solve.until", "changes"));
    }
    let error = refused(scene.with_value("left.value", f64::NAN));
    assert!(error.key == "left.value" && error.message.starts_with("NaN"), "{error:?}");
    let unknown = refused(library::find("copper", Path::new("")));
    let impact = refused(Scene::parse("spheres.toml", SPHERES, Path::new(""), &[]));
    for error in [unknown, impact] {
        assert!(!format!("{error:?}").contains("barwave ") && !error.message.contains("command"), "{error:?}");
    }
}

#[test]
fn a_result_without_a_checkpoint_is_named_as_the_argument() {
    let folder = tempfile::tempdir().expect("a folder");
    let (path, scene) = (folder.path().join("out.h5"), pulled().set("solve.cells", 20_000).build().expect("right"));
    let ended = run::run(&scene, Some(&path), &mut |_| ControlFlow::Break(()));
    assert!(matches!(ended, Err(Error::Interrupted)));
    assert_eq!(refused(run::resume(&path, None, &mut |_| ControlFlow::Continue(()))).key, "output");
}
