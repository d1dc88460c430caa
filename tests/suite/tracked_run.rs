//! Result files of tracked runs compared with the fronts themselves.

use std::ops::ControlFlow;
use std::path::Path;

use serde_json::Value;

use barwave::assemble;
use barwave::record::store::{Gauge, ResultFile, Side};
use barwave::record::{Field, Trace};
use barwave::run::{self};
use barwave::scene::Scene;
use barwave::solver::moc::{FrontTracking, Settings};

use crate::common::binary;

/// End time, s. Later, fronts with incommensurate speeds interact by the million.
const UNTIL: f64 = 300e-6;

/// A bilinear bar in two pieces, struck and released: reflections, unloading, a joint.
const SCENE: &str = r#"
[[bar.segment]]
length = "0.6 m"
area = "2 cm^2"
material = { name = "a", density = 7800, modulus = 200e9, beyond = "extend", curve = { table = [[0.001, 200e6], [0.021, 600e6]] } }
[[bar.segment]]
length = "0.4 m"
area = "1 cm^2"
material = { name = "b", density = 2700, modulus = 70e9, beyond = "extend", curve = { table = [[0.004, 280e6], [0.05, 500e6]] } }
[left]
kind = "velocity"
value = "20 m/s"
release = "100 us"
[right]
kind = "fixed"
[effects]
hardening = "isotropic"
[solve]
until = "300 us"
method = "moc"
front-tolerance = TOLERANCE
[record]
frames = 31
cells = 400
fields = ["stress", "strain", "velocity", "displacement", "plastic_strain", "accumulated_plastic_strain"]
gauges = { start = 0, quarter = "0.25 m", joint = "0.6 m", end = "1 m" }
"#;

fn scene(tolerance: &str) -> Scene {
    let text = SCENE.replace("TOLERANCE", tolerance);
    Scene::parse("tracked.toml", &text, Path::new(""), &[]).unwrap_or_else(|e| panic!("{e}"))
}

fn tracked(scene: &Scene, tolerance: f64) -> FrontTracking {
    let settings = Settings { front_tolerance: tolerance, front_segments: true, ..Settings::default() };
    assemble::front_tracking(scene, settings)
}

/// Returns the result file of the scene.
fn result(scene: &Scene, folder: &Path) -> ResultFile {
    let path = folder.join("out.h5");
    run::run(scene, Some(&path), &mut |_| ControlFlow::Continue(())).unwrap_or_else(|e| panic!("{e}"));
    ResultFile::open(&path).unwrap_or_else(|e| panic!("{e}"))
}

#[test]
fn fields_are_those_of_the_fronts_at_the_asked_places_and_times() {
    let folder = tempfile::tempdir().expect("a folder");
    let scene = scene("0");
    let file = result(&scene, folder.path());
    let (time, x) = (file.time().expect("times"), file.x().expect("places"));
    assert_eq!((time.as_slice(), x.len()), (scene.record.times.as_slice(), 400));
    let field = |f| file.field(f, 0..time.len()).expect("a field");
    let (stress, strain) = (field(Field::Stress), field(Field::Strain));
    let (velocity, plastic) = (field(Field::Velocity), field(Field::PlasticStrain));
    let mut bar = tracked(&scene, 0.0);
    for (k, &t) in time.iter().enumerate() {
        bar.advance_to(t).expect("it goes on");
        for (i, &x) in x.iter().enumerate() {
            // Read in one pass or one by one, the state is the same, bit for bit.
            let state = bar.state_at(x);
            let written = [stress[(k, i)], strain[(k, i)], velocity[(k, i)], plastic[(k, i)]];
            assert_eq!(written, [state.stress, state.strain, state.velocity, state.plastic_strain], "t = {t}, x = {x}");
        }
    }
}

/// Returns the integral over time of a history that is linear between its rows.
fn integral(time: &[f64], value: &[f64]) -> f64 {
    time.windows(2).zip(value.windows(2)).map(|(t, v)| 0.5 * (v[0] + v[1]) * (t[1] - t[0])).sum()
}

fn assert_steps(trace: &Trace, name: &str) {
    assert!(trace.time.windows(2).all(|t| t[1] >= t[0]), "{name}: times go back");
    assert_eq!((trace.time[0], trace.time.last()), (0.0, Some(&UNTIL)), "{name}");
    for k in 1..trace.time.len() {
        let same_time = trace.time[k] == trace.time[k - 1];
        let same_state = trace.velocity[k] == trace.velocity[k - 1] && trace.stress[k] == trace.stress[k - 1];
        assert!(same_time || same_state, "{name}: row {k} is no step");
    }
}

/// Checks that the records of gauges at a time are the state of the bar there, to the bit.
fn assert_gauges_see(gauges: &[Gauge], bar: &FrontTracking, t: f64) {
    for gauge in gauges {
        let row = gauge.trace.time.partition_point(|&row| row <= t) - 1;
        let state = bar.state_at(gauge.x);
        let seen = [gauge.trace.stress[row], gauge.trace.strain[row], gauge.trace.velocity[row]];
        assert_eq!(seen, [state.stress, state.strain, state.velocity], "{} at t = {t}", gauge.name);
    }
}

#[test]
fn gauges_are_exact_steps() {
    let folder = tempfile::tempdir().expect("a folder");
    for (text, tolerance) in [("0", 0.0), ("0.01", 0.01)] {
        let scene = scene(text);
        let file = result(&scene, folder.path());
        let gauges = file.gauges().expect("gauges");
        let names: Vec<&str> = gauges.iter().map(|g| g.name.as_str()).collect();
        assert_eq!(names, ["start", "quarter", "joint", "end"]);
        let mut bar = tracked(&scene, tolerance);
        // Times that are unrelated to any front.
        for k in 1..500 {
            let t = UNTIL * (f64::from(k) + 0.123_456) / 500.0;
            bar.advance_to(t).expect("it goes on");
            assert_gauges_see(&gauges, &bar, t);
        }
        for gauge in &gauges {
            assert_steps(&gauge.trace, &gauge.name);
        }
    }
}

/// Fronts that interact exactly at a gauge, at the times of frames: nothing is counted twice, and states of zero duration have no rows.
#[test]
fn a_gauge_where_fronts_meet_sees_only_what_lasts() {
    let text = "[bar]\nlength = 1\nmaterial = { name = \"a\", density = 7800, modulus = 200e9, beyond = \"extend\", \
                curve = { table = [[0.001, 200e6], [0.021, 600e6]] } }\n[left]\nkind = \"velocity\"\nvalue = 10\n\
                [right]\nkind = \"velocity\"\nvalue = -10\n[effects]\nhardening = \"isotropic\"\n[solve]\n\
                until = UNTIL\nmethod = \"moc\"\nfront-tolerance = 0\n[record]\nframes = 9\n\
                gauges = { start = 0, middle = 0.5, end = 1 }\n";
    let transit = (7800.0_f64 / 200e9).sqrt();
    // Four transits with a frame every half transit: each is at the time of an interaction, to rounding.
    let text = text.replace("UNTIL", &format!("{:e}", 4.0 * transit));
    let scene = Scene::parse("meeting.toml", &text, Path::new(""), &[]).unwrap_or_else(|e| panic!("{e}"));
    let folder = tempfile::tempdir().expect("a folder");
    let file = result(&scene, folder.path());
    let gauges = file.gauges().expect("gauges");
    let mut bar = tracked(&scene, 0.0);
    for k in 0..400 {
        let t = 4.0 * transit * (f64::from(k) + 0.371) / 400.0;
        bar.advance_to(t).expect("it goes on");
        assert_gauges_see(&gauges, &bar, t);
    }
    for gauge in &gauges {
        for k in 2..gauge.trace.time.len() {
            let times = &gauge.trace.time[k - 2..=k];
            assert!(times[0] < times[2], "{}: three rows at t = {}", gauge.name, times[0]);
        }
    }
    // By symmetry the middle never moves, and its first step is the interaction of the elastic waves.
    let middle = &gauges[1].trace;
    assert!(middle.velocity.iter().all(|v| v.abs() < 1e-12), "{:?}", middle.velocity);
    assert!((middle.time[1] / (0.5 * transit) - 1.0).abs() < 1e-14);
}

#[test]
fn displacements_are_the_integral_of_the_velocities_with_and_without_a_tolerance() {
    let folder = tempfile::tempdir().expect("a folder");
    for tolerance in ["0", "0.02"] {
        // Gauges at sample positions.
        let places = "record.gauges={ a = 0.00125, b = 0.25125, c = 0.60125, d = 0.99875 }";
        let scene = scene(tolerance).with(&[places]).expect("a right scene");
        let file = result(&scene, folder.path());
        let last = file.time().expect("times").len() - 1;
        let displacement = file.field(Field::Displacement, last..last + 1).expect("the field");
        for (gauge, sample) in file.gauges().expect("gauges").iter().zip([0, 100, 240, 399]) {
            let moved = integral(&gauge.trace.time, &gauge.trace.velocity);
            let field = displacement[(0, sample)];
            // A sum of some hundred pieces of up to 2 mm each, and openings that are located to 1/4096 of the bar.
            let allowed = if tolerance == "0" { 1e-15 } else { 1e-5 };
            assert!((moved - field).abs() < allowed, "{} with tolerance {tolerance}: {moved:e}, {field:e}", gauge.name);
        }
    }
}

#[test]
fn the_impulse_of_the_end_histories_is_the_momentum() {
    let folder = tempfile::tempdir().expect("a folder");
    let scene = scene("0");
    let file = result(&scene, folder.path());
    let (left, right) = (file.end(Side::Left).expect("left"), file.end(Side::Right).expect("right"));
    assert_steps(&left, "left");
    assert_steps(&right, "right");
    let ledger = file.ledger().expect("a ledger");
    let last = ledger.last().expect("a row");
    let impulse = 1e-4 * integral(&right.time, &right.stress) - 2e-4 * integral(&left.time, &left.stress);
    // About ten steps of 8 N s in total.
    assert!((impulse - last.energies.momentum).abs() < 1e-13, "{impulse:e} {:e}", last.energies.momentum);
    assert!(ledger.iter().all(|row| row.residual.abs() < 1e-13));
}

#[test]
fn paths_are_the_straight_pieces_of_all_fronts() {
    let folder = tempfile::tempdir().expect("a folder");
    let scene = scene("0");
    let file = result(&scene, folder.path());
    let paths = file.paths().expect("paths");
    let mut bar = tracked(&scene, 0.0);
    bar.advance_to(UNTIL).expect("it goes on");
    let ended = bar.take_front_segments();
    assert_eq!(paths.len(), ended.len() + bar.living_front_segments().count());
    for path in &paths {
        assert!(path.t1 > path.t0 && path.stress_jump != 0.0, "{path:?}");
        // The position where a front reaches an end is known to rounding.
        let inside = |x: f64| (-1e-15..=1.0 + 1e-15).contains(&x);
        assert!(inside(path.x0) && inside(path.x1), "{path:?}");
        // Two subtractions of numbers of order one.
        let speed = (path.x1 - path.x0) / (path.t1 - path.t0);
        assert!((path.speed / speed - 1.0).abs() < 1e-12, "{path:?}");
    }
    // The active fronts are in the front table: first those of the theoretical fans, then the others.
    let fronts = file.fronts().expect("fronts");
    let under_way = fronts.iter().filter(|f| f.last_seen == UNTIL).count();
    assert_eq!(under_way, bar.living_front_segments().count());
    let first = &fronts[0];
    assert_eq!((first.origin.as_str(), first.position), ("left", 0.6));
    // The gauge at a quarter of the length: 0.25 m at c0.
    assert!((first.arrivals[1] / (0.25 / 5_063.696_835_418_334) - 1.0).abs() < 1e-13, "{:?}", first.arrivals);
}

#[test]
fn a_run_that_is_interrupted_keeps_what_it_has() {
    let folder = tempfile::tempdir().expect("a folder");
    let (scene, path) = (scene("0"), folder.path().join("out.h5"));
    let mut calls = 0;
    let stopped = run::run(&scene, Some(&path), &mut |_| {
        calls += 1;
        if calls > 20 { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    });
    assert_eq!(stopped.expect_err("it was stopped").exit_code(), 130);
    let file = ResultFile::open(&path).expect("a result file");
    assert_eq!((file.metadata().outcome.as_str(), file.time().expect("times").len()), ("interrupted", 20));
    assert!(!file.paths().expect("paths").is_empty());
}

/// The bar is elastic: its end exchanges energy with a falling weight in every step, and the energy concentrated at the face is exactly zero, not
/// rounding of either sign.
#[test]
fn an_elastic_bar_dissipates_nothing_and_nothing_below_zero() {
    let text = std::fs::read_to_string("runs/falling-weight.toml").expect("a scene of the examples");
    let scene = Scene::parse("falling-weight.toml", &text, Path::new("runs"), &[]).unwrap_or_else(|e| panic!("{e}"));
    let folder = tempfile::tempdir().expect("a folder");
    let ledger = result(&scene, folder.path()).ledger().expect("a ledger");
    assert!(ledger.len() > 10, "{} rows", ledger.len());
    for row in ledger {
        let all = row.energies;
        let dissipated = [all.plastic, all.heat, all.viscoplastic, all.concentrated, all.fracture];
        let least = dissipated.into_iter().fold(f64::INFINITY, f64::min);
        assert!(least == 0.0, "{least:e} J at {} s", row.time);
    }
}

/// A front that reaches a gauge at exactly the time of an output must not be lost: the gauge, and the figures of a joint there, would stay at zero.
#[test]
fn a_front_that_comes_to_a_gauge_as_the_run_is_looked_at_is_seen() {
    let half = "[[bar.segment]]\nlength = 0.1\narea = 1e-4\nmaterial = { density = 8000, modulus = 200e9, beyond = \"extend\", \
                curve = { table = [[0, 0], [0.003, 600e6]] } }\n";
    let stress = -40e6;
    for (left, right) in
        [("kind = \"free\"", "kind = \"velocity\"\nvalue = -1"), ("kind = \"velocity\"\nvalue = 1", "kind = \"free\"")]
    {
        for until in [35, 41, 45] {
            let text = format!(
                "{half}{half}[left]\n{left}\n[right]\n{right}\n[solve]\nuntil = \"{until} us\"\nmethod = \"moc\"\n[record]\ngauges = {{ here = 0.1 }}\n"
            );
            let folder = tempfile::tempdir().expect("a folder");
            std::fs::write(folder.path().join("scene.toml"), text).expect("a folder to write to");
            let summary = binary::json(folder.path(), &["run", "scene.toml", "--json"]);
            let number = |pointer: &str| summary.pointer(pointer).and_then(Value::as_f64).expect("a number");
            assert!((number("/figures/gauges/here/peak_stress_Pa") / stress - 1.0).abs() < 1e-9, "{until}: {summary}");
            assert!(
                (number("/figures/joints/1/peak_force_N") / (1e-4 * stress) - 1.0).abs() < 1e-9,
                "{until}: {summary}"
            );
        }
    }
}
