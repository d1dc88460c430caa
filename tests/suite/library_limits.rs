//! Arguments of the library are checked like the values in a file: no endless loop, no panic, no silent NaN.

use std::ops::ControlFlow;
use std::path::Path;
use std::time::Duration;

use barwave::assemble;
use barwave::bar::History;
use barwave::error::{Error, InputError, Result};
use barwave::impact::{Beam, Plate, Problem, Spheres};
use barwave::input::Document;
use barwave::material::{Beyond, Curve, CurveError, Material, Sense, mean_curve, mean_modulus, tabulate_true_rows};
use barwave::record::Field;
use barwave::record::store::ResultFile;
use barwave::run::{self, Progress};
use barwave::scene::{Scene, SceneBuilder};
use barwave::solver::moc::Settings;
use barwave::study::bracket::{RateAndHeat, apparent, confirm};
use barwave::study::compare_results::profile_at;
use barwave::study::sweep::{Axis, Combine, Level, Sweep};
use barwave::wave::similarity::{fan_at_stress, fan_at_velocity};

use crate::common::impacts::{ball, beam, plate};

fn struck() -> SceneBuilder {
    Scene::builder()
        .set("bar.length", 0.5)
        .set("bar.material", "copper-annealed")
        .set("left.kind", "velocity")
        .set("left.value", "-20 m/s")
        .set("right.kind", "free")
        .set("solve.until", "50 us")
}

fn pulled() -> SceneBuilder {
    struck().set("solve.cells", 100)
}

fn key(ended: Result<()>) -> String {
    let Err(Error::Input(error)) = ended else { panic!("{ended:?}") };
    assert!(!error.help.is_empty() && !error.help.contains("--"), "{error:?}");
    error.key
}

fn go_on(_: Progress) -> ControlFlow<()> {
    ControlFlow::Continue(())
}

#[test]
fn tolerances_and_counts_of_impacts_are_those_that_scenes_allow() {
    let key_of = |problem: &dyn Problem| {
        let ended = problem.solve(&mut |_| ControlFlow::Continue(()));
        let error = ended.map(|_| ()).expect_err("out of range");
        assert!(!error.allowed.is_empty(), "{error:?}");
        error
    };
    let beam = beam();
    for tolerance in [f64::NAN, 1e-308, 1e-18, 9e-13, 0.011, 0.5] {
        let problems: [&dyn Problem; 3] = [
            &Plate { tolerance, ..plate() },
            &Beam { tolerance, ..beam.clone() },
            &Spheres::Hertz { solids: [ball(1.0), ball(0.0)], tolerance },
        ];
        for error in problems.map(key_of) {
            assert_eq!((error.key.as_str(), error.allowed.as_str()), ("tolerance", "1e-12 <= tolerance <= 0.01"));
        }
    }
    for modes in [0, 10_001, 1_000_000_000] {
        let error = key_of(&Beam { modes: Some(modes), ..beam.clone() });
        assert_eq!((error.key.as_str(), error.allowed.as_str()), ("modes", "1 <= modes <= 10000"));
    }
    assert_eq!(key_of(&Beam { shapes: 1001, ..beam.clone() }).key, "shapes");
}

#[test]
fn figures_and_columns_of_impacts_have_names() {
    let solution = plate().solve(&mut |_| ControlFlow::Continue(())).expect("a right plate");
    let force = solution.figure("peak_force").expect("a figure");
    assert!(force > 0.0 && solution.figure("peak_force_N") == Some(force));
    assert_eq!((solution.figure("nope"), solution.figure("peak_force_m")), (None, None));
    let table = &solution.tables[0];
    assert!(table.column("time").is_some_and(|time| time.len() > 2) && table.column("nope").is_none());
    let scene = pulled().set("bar.diameter", "20 mm").build().expect("a right scene");
    let figures = run::run(&scene, None, &mut go_on).expect("it runs").figures;
    let force = figures.get(&["left"], "peak_force").expect("a figure");
    assert_eq!((figures.get(&["left"], "peak_force_N"), figures.get(&["left"], "nope")), (Some(force), None));
}

fn curve() -> Curve {
    Curve::new(&[(0.001, 200e6), (0.1, 300e6), (0.3, 350e6)], Beyond::Rupture).expect("a curve")
}

fn steel() -> Material {
    Material::from_curve("steel", 7850.0, curve()).expect("a material")
}

#[test]
fn materials_without_waves_are_refused() {
    let of = |density: f64| Material::from_curve("m", density, curve()).map(|_| ()).map_err(Error::from);
    assert!(of(7850.0).is_ok());
    for wrong in [f64::NAN, f64::INFINITY, 0.0, -1.0, 1e-308, 1e308] {
        assert_eq!(key(of(wrong)), "density");
        for (material, name) in
            [(Material { density: wrong, ..steel() }, "density"), (Material { modulus: wrong, ..steel() }, "modulus")]
        {
            assert_eq!(key(material.check().map_err(Error::from)), name);
            assert_eq!(key(confirm(&material, Sense::Tension).map(|_| ())), name);
            let with = RateAndHeat::default();
            assert_eq!(key(apparent(&material, Sense::Tension, with, 1.0).map(|_| ())), name);
        }
    }
    let soft = Material { modulus: 100e9, ..steel() };
    assert_eq!(key(soft.check().map_err(Error::from)), "modulus");
}

#[test]
fn what_is_no_number_gives_no_fan() {
    for fan in [fan_at_velocity(&curve(), 7850.0, f64::NAN), fan_at_stress(&curve(), 7850.0, f64::NAN)] {
        assert!(fan.edges.is_empty() && fan.velocity.is_nan() && fan.stress.is_nan() && fan.strain.is_nan(), "{fan:?}");
    }
}

#[test]
fn true_rows_have_increasing_strains_above_0() {
    let of = |rows: &[(f64, f64)]| tabulate_true_rows(rows, None, Sense::Tension, 1e-3).map_err(Error::from);
    assert!(of(&[(0.001, 200e6), (0.1, 300e6)]).is_ok());
    for wrong in [0.0, -1.0, 0.1, 0.2, 28.0, 1e308] {
        assert_eq!(key(of(&[(wrong, 200e6), (0.1, 300e6)]).map(|_| ())), "rows");
    }
}

#[test]
fn the_mean_of_no_test_is_an_error() {
    assert_eq!(key(mean_modulus(&[]).map(|_| ()).map_err(Error::from)), "tests");
    assert_eq!(key(mean_curve(&[], 200e9).map(|_| ()).map_err(Error::from)), "tests");
}

#[test]
fn errors_of_curves_count_rows_like_others() {
    let wrong = Curve::new(&[(0.001, 200e6), (0.0005, 300e6)], Beyond::Error).expect_err("it falls");
    let error = InputError::from(wrong.clone());
    assert!(error.message.starts_with("row 1 (counted from 0): strain") && error.key == "rows", "{error:?}");
    assert!(!error.allowed.is_empty() && wrong.to_string().starts_with("row 2: "), "{error:?}");
    assert_eq!(wrong, CurveError { row: 1, ..wrong.clone() });
    let sheared = || -> Result<Material> { Ok(steel().in_shear()?) };
    assert_eq!(key(sheared().map(|_| ())), "poisson");
}

#[test]
fn a_history_can_be_limited_by_anything() {
    let history = History::new(&[(0.0, 0.0), (1.0, 1.0)]).expect("rows");
    assert_eq!(history.within([f64::NAN, f64::NAN]), history);
    assert_eq!(history.within([f64::NAN, 0.5]).extreme(), 0.5);
    assert!(history.within([2.0, 0.5]).value().iter().all(|&value| value == 0.5));
}

#[test]
fn profiles_are_read_between_the_frames() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("out.h5");
    run::run(&pulled().build().expect("a right scene"), Some(&path), &mut go_on).expect("it runs");
    let file = ResultFile::open(&path).expect("a result");
    let last = *file.time().expect("times").last().expect("a frame");
    assert!(profile_at(&file, Field::Stress, last).is_ok() && profile_at(&file, Field::Stress, 0.5 * last).is_ok());
    for wrong in [f64::NAN, f64::INFINITY, -1e-6, 1.01 * last] {
        assert_eq!(key(profile_at(&file, Field::Stress, wrong).map(|_| ())), "time");
    }
}

#[test]
fn a_run_without_an_end_of_its_interval_is_resumed() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("out.h5");
    let scene = pulled().set("solve.cells", 8000).build().expect("a right scene");
    let mut calls = 0;
    let mut stop = |_: Progress| {
        calls += 1;
        if calls > 1 { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    };
    let ended = run::run_with_checkpoints(&scene, &path, Duration::MAX, &mut stop);
    assert!(matches!(ended, Err(Error::Interrupted)), "{ended:?}");
    let resumed = run::resume(&path, None, &mut go_on).expect("it goes on");
    let whole = run::run(&scene, None, &mut go_on).expect("it runs");
    assert_eq!(resumed.left.stress, whole.left.stress);
}

#[test]
fn a_sweep_has_cases_of_its_axes() {
    let scene = pulled().build().expect("a right scene");
    let axis = |key: &str, values: &[f64]| Axis {
        key: key.into(),
        unit: String::new(),
        levels: values.iter().map(|v| Level { typed: v.to_string(), si: Some(*v) }).collect(),
        logarithmic: false,
    };
    let sweep = |axes: Vec<Axis>, combine: Combine, metric: &str| {
        let document = Document::new("scene.toml", scene.text.as_str());
        let metrics = vec![metric.to_owned()];
        Sweep::of_scene("s".into(), document, Path::new("scene.toml"), axes, combine, metrics, Vec::new()).map(|_| ())
    };
    let (velocity, length) = (axis("left.value", &[-1.0, -2.0]), axis("bar.length", &[1.0]));
    let product = |axes: Vec<Axis>| sweep(axes, Combine::Product, "left.strain");
    assert!(product(vec![velocity.clone(), length.clone()]).is_ok());
    assert_eq!(key(product(Vec::new())), "axes");
    assert_eq!(key(product(vec![axis("left.value", &[])])), "axes.0.levels");
    assert_eq!(key(product(vec![velocity.clone(), length.clone(), velocity.clone()])), "axes");
    assert_eq!(key(sweep(vec![velocity.clone(), length], Combine::Zip, "left.strain")), "combine");
    let Err(Error::Input(error)) = sweep(vec![velocity], Combine::Product, "left.strian") else { panic!("no metric") };
    assert!(error.key == "metrics.0" && error.help.contains("`left.strain`"), "{error:?}");
}

#[test]
fn fronts_are_not_followed_to_a_time_that_is_no_number() {
    let scene = struck().set("solve.until", "300 us").set("solve.method", "moc").build().expect("a right scene");
    let mut bar = assemble::front_tracking(&scene, Settings::default());
    let before = bar.events();
    assert!(bar.advance_for(f64::NAN, 10).expect("nothing happens"));
    assert!(bar.advance_for(scene.solve.until, 1_000_000).expect("it gets there") && bar.events() > before);
}

#[test]
fn no_grid_has_a_courant_number_that_scenes_cannot_have() {
    let scene = pulled().build().expect("a right scene");
    for cfl in [f64::NAN, -1.0, 0.0, 5.0] {
        assert!(std::panic::catch_unwind(|| assemble::leapfrog(&scene, 10, cfl)).is_err(), "{cfl}");
    }
}
