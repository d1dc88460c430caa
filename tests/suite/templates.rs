//! The files that `barwave new` writes can be checked and run unchanged.

use crate::common::binary;

use std::path::Path;

use barwave::material::{Sense, library};
use binary::barwave;
use serde_json::Value;

fn succeed(folder: &Path, arguments: &[&str]) -> String {
    let output = barwave(folder, arguments);
    assert_eq!(output.status.code(), Some(0), "{arguments:?}: {}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout).expect("text")
}

/// Writes, checks and runs a template, and returns its summary.
fn run(kind: &str) -> Value {
    let folder = tempfile::tempdir().expect("a folder");
    let wrote = succeed(folder.path(), &["new", "--kind", kind, "mine"]);
    assert!(wrote.contains("`barwave run mine.toml`"), "{wrote}");
    assert_eq!(succeed(folder.path(), &["check", "mine.toml"]), "mine.toml: ok (scene)\n");
    let summary: Value =
        serde_json::from_str(&succeed(folder.path(), &["run", "--json", "mine.toml"])).expect("one JSON object");
    assert_eq!(summary["scene"], "mine");
    summary
}

fn number(summary: &Value, path: &str) -> f64 {
    summary.pointer(path).and_then(Value::as_f64).unwrap_or_else(|| panic!("{path}: {}", summary["figures"]))
}

#[test]
fn a_bar_is_pulled() {
    assert!(number(&run("bar"), "/figures/permanent_elongation_m") > 0.0);
}

#[test]
fn a_specimen_breaks_in_tension() {
    let summary = run("tension-impact");
    assert_eq!(summary["outcome"], "rupture");
    assert!(number(&summary, "/figures/permanent_elongation_m") > 0.05);
}

#[test]
fn a_taylor_cylinder_is_shortened_and_rebounds() {
    let summary = run("taylor");
    assert!((0.6..0.8).contains(&number(&summary, "/figures/final_length_ratio")));
    assert!(number(&summary, "/figures/left/restitution") > 0.0);
}

/// The gauges record complete pulses, and the specimen is compressed.
#[test]
fn a_hopkinson_pulse_goes_through_the_specimen() {
    let summary = run("hopkinson");
    let rho_c = (7850.0 * 200e9_f64).sqrt();
    let incident = number(&summary, "/figures/gauges/incident/peak_stress_Pa");
    assert!((incident / (-0.5 * rho_c * 12.0) - 1.0).abs() < 0.1, "{incident:e}");
    assert!(number(&summary, "/figures/segments/3/permanent_elongation_m") < -3e-4);
    assert!(number(&summary, "/figures/gauges/transmitted/peak_stress_Pa") < -50e6);
}

/// Runs the template with front tracking and other values.
fn hopkinson_by_fronts(folder: &Path, sets: &[String]) -> Value {
    let moc = ["solve.method=moc", "solve.cells=", "solve.scheme=", "solve.max-events=20000"].map(str::to_owned);
    let sets: Vec<&str> = moc.iter().chain(sets).flat_map(|set| ["--set", set]).collect();
    serde_json::from_str(&succeed(folder, &[&["run", "--json", "mine.toml"], &sets[..]].concat())).expect("JSON")
}

/// A front of 1e-3 Pa that arrives at the specimen must not open the joint, whose faces would close at the same instant, in an endless loop.
#[test]
fn a_split_hopkinson_bar_comes_to_its_end_with_any_front_tolerance() {
    let folder = tempfile::tempdir().expect("a folder");
    succeed(folder.path(), &["new", "--kind", "hopkinson", "mine"]);
    let even = |from: f64, to: f64, count: u32| {
        (0..count).map(move |k| from + (to - from) * f64::from(k) / f64::from(count - 1))
    };
    for tolerance in even(3.69e-3, 3.73e-3, 12).chain(even(4e-3, 2e-2, 30)) {
        let summary = hopkinson_by_fronts(folder.path(), &[format!("solve.front-tolerance={tolerance:.6e}")]);
        assert_eq!(summary["outcome"], "done", "{tolerance}");
    }
}

#[test]
fn random_split_hopkinson_bars_come_to_their_end() {
    let folder = tempfile::tempdir().expect("a folder");
    succeed(folder.path(), &["new", "--kind", "hopkinson", "mine"]);
    // Fractional parts of multiples of irrational numbers are evenly distributed.
    let spread = |k: u32, by: f64, from: f64, to: f64| from + (to - from) * (f64::from(k) * by).fract();
    for k in 1..=40 {
        let velocity = spread(k, 2_f64.sqrt(), 5.0, 20.0);
        let diameter = spread(k, 3_f64.sqrt(), 5.0, 15.0);
        let length = spread(k, 5_f64.sqrt(), 3.0, 10.0);
        let tolerance = spread(k, 7_f64.sqrt(), 4e-3, 2e-2);
        let sets = [
            format!("bar.segment.0.velocity={velocity:.3} m/s"),
            format!("bar.segment.2.diameter={diameter:.3} mm"),
            format!("bar.segment.2.length={length:.3} mm"),
            format!("solve.front-tolerance={tolerance:.6e}"),
        ];
        let summary = hopkinson_by_fronts(folder.path(), &sets);
        assert_eq!(summary["outcome"], "done", "{sets:?}");
        assert!(number(&summary, "/ledger/energy_residual") < 1e-9, "{sets:?}");
    }
}

/// The error of a bar with two free ends includes the peak forces of its joints: without them it would be 7e-14, beside a joint whose peak has an
/// error of 2.5e-3.
#[test]
fn the_error_of_a_hopkinson_bar_counts_the_peak_forces_of_its_joints() {
    let folder = tempfile::tempdir().expect("a folder");
    succeed(folder.path(), &["new", "--kind", "hopkinson", "mine"]);
    let run = |tolerance: f64| {
        hopkinson_by_fronts(
            folder.path(),
            &["solve.max-events=1000000".to_owned(), format!("solve.front-tolerance={tolerance}")],
        )
    };
    let (coarse, fine) = (run(4e-3), run(2e-4));
    let peak = |summary: &Value, joint: usize| number(summary, &format!("/figures/joints/{joint}/peak_force_N"));
    let off = |joint: usize| (peak(&coarse, joint) / peak(&fine, joint) - 1.0).abs();
    let largest = [1, 2, 3].map(off).into_iter().fold(0.0, f64::max);
    let stated = number(&coarse, "/errors/peak_force");
    assert!(largest > 1e-3 && stated > 0.7 * largest && stated < 10.0 * largest, "{stated} {largest}");
}

#[test]
fn the_curve_of_a_hopkinson_specimen_is_recovered_from_its_gauges() {
    let folder = tempfile::tempdir().expect("a folder");
    succeed(folder.path(), &["new", "-k", "hopkinson", "mine"]);
    succeed(folder.path(), &["run", "mine.toml", "-o", "mine.h5", "--quiet"]);
    for noise in ["0 %", "1 %"] {
        let json = succeed(folder.path(), &["invert", "hopkinson", "mine.h5", "--noise", noise, "--json"]);
        let found: Value = serde_json::from_str(&json).expect("JSON");
        let copper = library::find("copper-annealed", Path::new("")).expect("a material");
        let curve = found["curve"].as_array().expect("a curve");
        assert!(curve.len() > 10, "{noise}: {found:#}");
        for knot in curve {
            let value = |key: &str| knot[key].as_f64().expect("a number");
            let truth = copper.branch(Sense::Compression).stress_at(value("strain"));
            assert!((value("stress_Pa") / truth - 1.0).abs() < 0.05, "{noise}: {knot}, {truth:e}");
        }
    }
}

#[test]
fn a_falling_mass_rebounds() {
    let summary = run("drop-weight");
    assert!(number(&summary, "/figures/left/striker_velocity_after_m_s") < 0.0);
    assert!(number(&summary, "/figures/left/contact_duration_s") < number(&summary, "/end_time_s"));
}

#[test]
fn impacts_without_a_bar_have_templates() {
    assert_eq!(run("energy-method")["outcome"], "rupture");
    // Equal balls exchange their velocities.
    assert!((number(&run("spheres"), "/struck_velocity_m_s") - 1.0).abs() < 1e-9);
    assert!((0.9..1.0).contains(&number(&run("plate"), "/restitution")));
    assert!(number(&run("beam"), "/gauges/middle/peak_strain") > 0.0);
    // None of them exceeds the limits of the theory.
    for kind in ["spheres", "plate", "beam"] {
        assert_eq!(run(kind)["notes"].to_string(), "[]", "{kind}");
    }
}

#[test]
fn a_pulse_spalls() {
    let summary = run("spall");
    assert_eq!(summary["outcome"], "rupture");
    // Exact; a grid would fracture three steps late, with a residual stress of 800 MPa in the last cell of the scab.
    assert!((number(&summary, "/ruptures/0/x_m") - 0.18).abs() < 1e-9);
    assert!((number(&summary, "/ruptures/0/time_s") - 44e-6).abs() < 1e-12);
}

#[test]
fn a_sweep_comes_with_its_scene() {
    let folder = tempfile::tempdir().expect("a folder");
    let wrote = succeed(folder.path(), &["new", "-k", "sweep", "mine"]);
    assert!(wrote.contains("mine-scene.toml") && wrote.contains("`barwave sweep mine.toml`"), "{wrote}");
    succeed(folder.path(), &["check", "mine.toml", "mine-scene.toml"]);
    succeed(folder.path(), &["sweep", "mine.toml", "--quiet", "-o", "table"]);
    let table = std::fs::read_to_string(folder.path().join("table/table.csv")).expect("a table");
    assert_eq!(table.lines().filter(|line| line.contains(",done,")).count(), 8, "{table}");
    // Neither file is overwritten.
    let again = barwave(folder.path(), &["new", "-k", "sweep", "mine"]);
    assert_eq!(again.status.code(), Some(2));
    std::fs::remove_file(folder.path().join("mine.toml")).expect("a file");
    assert_eq!(barwave(folder.path(), &["new", "-k", "sweep", "mine"]).status.code(), Some(2));
    assert!(!folder.path().join("mine.toml").exists());
}
