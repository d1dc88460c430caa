//! Every scene in runs/ through the real binary, and the properties of the output of `barwave run`.

use crate::common::binary;

use std::path::{Path, PathBuf};
use std::process::Output;

use binary::barwave;
use serde_json::Value;

fn runs() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("runs")
}

/// Runs a scene of runs/ with `--json` in a folder of its own and returns the summary.
fn run(name: &str, arguments: &[&str]) -> Value {
    run_in(name, tempfile::tempdir().expect("a folder").path(), arguments)
}

/// Runs a scene of runs/ in this folder, with the result `out.h5`, and returns the summary.
fn run_in(name: &str, folder: &Path, arguments: &[&str]) -> Value {
    let scene = runs().join(name).display().to_string();
    let all: Vec<&str> =
        ["run", &scene, "--json", "-o", "out.h5"].into_iter().chain(arguments.iter().copied()).collect();
    let output = barwave(folder, &all);
    assert_eq!(output.status.code(), Some(0), "{name}: {}", String::from_utf8_lossy(&output.stderr));
    assert!(output.stderr.is_empty(), "{name}: {}", String::from_utf8_lossy(&output.stderr));
    let file = barwave::record::store::ResultFile::open(&folder.join("out.h5"));
    assert!(file.is_ok(), "{name}: the result file does not open");
    // Stdout must contain exactly one JSON value: anything after it is an error here.
    serde_json::from_slice(&output.stdout).expect("stdout is one JSON value")
}

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or_else(|| panic!("{value} is no number"))
}

const KEYS: [&str; 23] = [
    "scene",
    "outcome",
    "method",
    "scheme",
    "effects",
    "cells",
    "steps",
    "events",
    "wall_s",
    "step_wall_s",
    "cell_steps_per_s",
    "end_time_s",
    "left",
    "right",
    "fronts",
    "critical_velocity_m_s",
    "above_critical",
    "elastic_check",
    "ledger",
    "error",
    "errors",
    "audit",
    "notes",
];
const FRONT_KEYS: [&str; 7] = [
    "strain_ahead",
    "strain_behind",
    "stress_ahead_Pa",
    "stress_behind_Pa",
    "speed_m_s",
    "speed_measured_m_s",
    "position_m",
];

fn assert_keys(value: &Value, keys: &[&str], what: &str) {
    let object = value.as_object().unwrap_or_else(|| panic!("{what} is no object"));
    let missing: Vec<&&str> = keys.iter().filter(|key| !object.contains_key(**key)).collect();
    assert!(missing.is_empty(), "{what}: no {missing:?}");
}

/// Checks the properties of the summary of every scene.
fn assert_contract(summary: &Value, name: &str) {
    assert_keys(summary, &KEYS, name);
    for side in ["left", "right"] {
        assert_keys(&summary[side], &["stress_Pa", "strain", "velocity_m_s"], side);
    }
    for front in summary["fronts"].as_array().expect("a list") {
        assert_keys(front, &FRONT_KEYS, "front");
    }
    assert_eq!(summary["output"], "out.h5", "{name}");
    let rate = summary["effects"].as_array().expect("a list").iter().any(|e| e.to_string().contains("rate: "));
    let tracked = summary["method"] == "moc" && !rate;
    let (method, scheme) = match (summary["method"] == "moc", rate) {
        (true, false) => ("moc", "front-tracking"),
        (true, true) => ("moc", "characteristic-net"),
        (false, _) if summary["scheme"] == "muscl" => ("fd", "muscl"),
        (false, _) => ("fd", "leapfrog"),
    };
    assert_eq!((&summary["method"], &summary["scheme"]), (&method.into(), &scheme.into()), "{name}");
    for key in ["energy_residual", "momentum_residual"] {
        let residual = number(&summary["ledger"][key]);
        // With a front tolerance, nodes closer than 1e-8 of it (times the length) count as one.
        let bound = if tracked { 1e-7 } else { 1e-10 };
        assert!(residual.abs() < bound, "{name}: {key} {residual:e}");
    }
    for key in ["cells", "steps", "step_wall_s", "cell_steps_per_s", "end_time_s"] {
        // Front tracking has no cells, and a run in which no fronts interact has no events.
        let zero = tracked && ["cells", "steps", "cell_steps_per_s"].contains(&key);
        assert!(number(&summary[key]) > 0.0 || zero, "{name}: {key}");
    }
    if tracked {
        assert_keys(summary, &["front_tolerance", "stress_scale_Pa", "fronts_under_way", "events_per_s"], name);
        assert_eq!((&summary["cells"], &summary["steps"]), (&0.into(), &summary["events"]), "{name}");
    }
}

/// Checks that fronts that could be followed have the theoretical speed. Returns their number.
///
/// A front is a few cells wide, and its position is where the strain passes the middle of its jump: over at least 100 cells, this determines the
/// distance to 2 %.
fn assert_speeds(summary: &Value, cell: f64, origin: f64, name: &str) -> usize {
    let mut followed = 0;
    for front in summary["fronts"].as_array().expect("a list") {
        let (Some(measured), Some(place)) = (front["speed_measured_m_s"].as_f64(), front["position_m"].as_f64()) else {
            continue;
        };
        if (place - origin).abs() < 100.0 * cell {
            continue;
        }
        let speed = number(&front["speed_m_s"]);
        assert!((measured / speed - 1.0).abs() < 0.02, "{name}: {measured} m/s is not {speed} m/s; {front}");
        followed += 1;
    }
    followed
}

/// Runs a scene with one fan from an end of the bar; `origin` and `length` are in m, `least_fronts` is the number of fronts that can be followed.
fn check(name: &str, [origin, length]: [f64; 2], least_fronts: usize) -> Value {
    let summary = run(name, &[]);
    assert_contract(&summary, name);
    let cell = length / number(&summary["cells"]);
    let followed = assert_speeds(&summary, cell, origin, name);
    println!("{name}: {followed} fronts followed");
    assert!(followed >= least_fronts, "{name}: {followed} fronts followed");
    assert_eq!(summary["above_critical"], name == "copper-above-critical.toml", "{name}");
    summary
}

#[test]
fn elastic_check() {
    let summary = check("elastic-check.toml", [0.0, 1.0], 1);
    let check = &summary["elastic_check"];
    assert!(number(&check["relative"]) < 1e-12, "{check}");
    // Value stated in the scene.
    assert!((number(&check["expected_Pa"]) + 394.968e6).abs() < 500.0, "{check}");
    assert!(number(&summary["error"]["value"]) < 1e-12);
    assert_eq!((&summary["outcome"], &summary["effects"]), (&"done".into(), &Value::Array(vec![])));
}

#[test]
fn bilinear_p2() {
    let summary = check("bilinear-p2.toml", [0.0, 1.0], 2);
    assert!(summary["elastic_check"].is_null());
    assert_eq!(summary["effects"], serde_json::json!(["plasticity", "hardening: isotropic"]));
    // Bound of the benchmark with 1000 cells.
    assert!(number(&summary["error"]["value"]) < 0.0036);
}

#[test]
fn power_law_p3() {
    check("power-law-p3.toml", [0.0, 1.0], 10);
}

#[test]
fn copper_below_critical() {
    let summary = check("copper-below-critical.toml", [0.0, 1.0], 10);
    assert_eq!(summary["outcome"], "done");
    assert!((number(&summary["critical_velocity_m_s"]) - 90.0).abs() < 1.0);
}

#[test]
fn auto_finds_effects_and_says_why() {
    let summary = run("copper-auto.toml", &[]);
    let auto = summary["auto"].as_array().expect("a list");
    for key in ["hardening", "rate"] {
        let choice = auto.iter().find(|choice| choice["effect"] == key).unwrap_or_else(|| panic!("{key}: {auto:?}"));
        assert_eq!(choice["on"], true, "{choice}");
        assert!(
            number(&choice["estimate"]) > 0.01
                && choice["why"].as_str().is_some_and(|w| w.contains('%') && !w.contains("neglected")),
            "{choice}"
        );
    }
    let effects = summary["effects"].to_string();
    assert!(effects.contains("rate: material") && effects.contains("hardening: isotropic"), "{effects}");
    // What remains is below the tolerance, or unknown, or a limitation of the hardening rules that no effect removes.
    for row in summary["audit"].as_array().expect("a list") {
        let estimate = row["estimate"].as_f64().unwrap_or(0.0);
        assert!(estimate < number(&row["threshold"]) || row["effect"] == "reversal", "{row}");
    }
}

#[test]
fn copper_above_critical() {
    let summary = check("copper-above-critical.toml", [0.0, 1.0], 10);
    assert_eq!(summary["outcome"], "rupture");
    let audit = summary["audit"].as_array().expect("a list");
    assert!(!audit.is_empty());
}

#[test]
fn spall() {
    let summary = run("spall.toml", &[]);
    assert_contract(&summary, "spall.toml");
    assert_eq!(summary["outcome"], "rupture");
    let [rupture] = &summary["ruptures"].as_array().expect("a list")[..] else { panic!("{}", summary["ruptures"]) };
    assert_eq!((&rupture["cause"], &rupture["site"]), (&"spall".into(), &"segment 1".into()));
    // Half the length of the pulse from the free end, to a cell.
    assert!((number(&rupture["x_m"]) - 0.18).abs() < 2.1e-4, "{rupture}");
    // Grids fracture some steps late; front tracking does not.
    assert!(summary["audit"].to_string().contains("leaves tensile pulses of up to 800 MPa"), "{}", summary["audit"]);
    assert!(!by_characteristics("spall.toml")["audit"].to_string().contains("tensile pulses"));
}

#[test]
fn energy_method_breaks() {
    let summary = run("energy-method-breaks.toml", &[]);
    assert_contract(&summary, "energy-method-breaks.toml");
    assert_eq!(summary["outcome"], "rupture");
    let rupture = &summary["ruptures"][0];
    assert_eq!(rupture["cause"], "energy");
    assert!((number(&rupture["absorbed_J_m3"]) / 41.3685e6 - 1.0).abs() < 1e-3, "{rupture}");
}

#[test]
fn love_rod() {
    let with = run("love-rod.toml", &[]);
    assert_contract(&with, "love-rod.toml");
    assert_eq!(with["effects"], serde_json::json!(["lateral-inertia"]));
    // The elastic check and the self-similar solution do not include lateral inertia.
    assert!(with["elastic_check"].is_null() && with["error"].is_null());
    let without = run("love-rod.toml", &["--set", "effects.lateral-inertia=false"]);
    assert_eq!(without["effects"], serde_json::json!([]));
    // The front arrives later than without lateral inertia, since it spreads over a few diameters.
    let speed = |summary: &Value| number(&summary["fronts"][0]["speed_measured_m_s"]);
    assert!(speed(&with) < 0.999 * speed(&without) && speed(&with) > 0.98 * speed(&without), "{}", speed(&with));
}

#[test]
fn copper_heated() {
    let summary = check("copper-heated.toml", [0.0, 1.0], 10);
    let effects = summary["effects"].to_string();
    assert!(effects.contains("hardening: isotropic") && effects.contains("heat: fraction 0.9"), "{effects}");
    let rise = number(&summary["largest_temperature_rise_K"]);
    assert!((1.0..10.0).contains(&rise), "{rise}");
    let audit = summary["audit"].to_string();
    assert!(!audit.contains("heat"), "{audit}");
    let cold = run(
        "copper-heated.toml",
        &["--set", "effects.heat=", "--set", "effects.hardening=isotropic", "--set", "record.fields="],
    );
    assert!(cold.get("largest_temperature_rise_K").is_none());
    assert!(number(&summary["left"]["stress_Pa"]) < number(&cold["left"]["stress_Pa"]));
    assert!(number(&summary["left"]["strain"]) > number(&cold["left"]["strain"]));
    let tracked = by_characteristics("copper-heated.toml");
    // Next to the end, the strain of the grid is too large by a fifth, since the stress overshoots there.
    assert!((number(&tracked["largest_temperature_rise_K"]) / rise - 1.0).abs() < 0.2, "{rise}");
    assert!((number(&tracked["left"]["stress_Pa"]) / number(&summary["left"]["stress_Pa"]) - 1.0).abs() < 1e-3);
}

#[test]
fn damped_bar() {
    let summary = run("damped-bar.toml", &[]);
    assert_contract(&summary, "damped-bar.toml");
    let effects = summary["effects"].to_string();
    assert!(effects.contains("damping: internal = ") && effects.contains("foundation = "), "{effects}");
    // The weight has rebounded.
    assert!(number(&summary["left"]["striker_velocity_m_s"]) < 0.0);
}

#[test]
fn mild_steel_wall() {
    let summary = check("mild-steel-wall.toml", [0.2, 0.2], 1);
    // It has left the wall and moves back, more slowly than it arrived.
    assert_eq!(number(&summary["right"]["stress_Pa"]), 0.0);
    let velocity = number(&summary["right"]["velocity_m_s"]);
    assert!(velocity < 0.0 && velocity > -60.0, "{velocity}");
}

#[test]
fn mild_steel_precursor() {
    precursor("mild-steel-precursor.toml");
}

#[test]
fn mild_steel_precursor_on_the_grid() {
    precursor("mild-steel-rate-on-the-grid.toml");
}

fn precursor(name: &str) {
    let folder = tempfile::tempdir().expect("a folder");
    let scene = runs().join(name).display().to_string();
    let output = barwave(folder.path(), &["run", &scene, "--json", "-o", "out.h5"]);
    let summary: Value = serde_json::from_slice(&output.stdout).expect("one JSON value");
    assert_contract(&summary, name);
    assert_eq!(summary["method"] == "fd", name.contains("on-the-grid"), "{name}");
    // Balances of momentum and energy close to the rounding of 8e6 cell-steps.
    assert!(number(&summary["ledger"]["energy_residual"]) < 1e-12, "{summary}");
    let file = barwave::record::store::ResultFile::open(&folder.path().join("out.h5")).expect("a result file");
    let (c0, rho_c0): (f64, f64) = ((207e9_f64 / 7850.0).sqrt(), (207e9_f64 * 7850.0).sqrt());
    let elastic_limit = file.fronts().expect("fronts")[0].stress_behind.abs();
    for gauge in file.gauges().expect("gauges") {
        let front = elastic_limit + (rho_c0 * 20.0 - elastic_limit) * (-1e5 * gauge.x / (2.0 * c0)).exp();
        let peak = gauge.trace.stress.iter().fold(0.0_f64, |m, s| m.max(s.abs()));
        // The gauge is between two cells of 0.1 mm, k dt = 2e-3: a step and a cell correspond to about 1e-3 of the overstress.
        assert!((peak / front - 1.0).abs() < 2e-3, "{}: {peak:e} {front:e}", gauge.name);
    }
}

#[test]
fn pulse_tension_us() {
    // The velocity rises over 10 us: its fronts have no sharp start.
    let summary = run("pulse-tension-us.toml", &[]);
    assert_contract(&summary, "pulse-tension-us.toml");
    assert_eq!(summary["above_critical"], false);
    assert_eq!(summary["effects"], serde_json::json!(["plasticity", "hardening: mixed 0.3"]));
}

#[test]
fn stepped_bar() {
    let summary = run("stepped-bar.toml", &[]);
    assert_contract(&summary, "stepped-bar.toml");
    assert_eq!((&summary["above_critical"], &summary["effects"]), (&false.into(), &Value::Array(vec![])));
}

/// The summary states the final length; `tests/suite/taylor_cylinders.rs` compares it with measurements.
#[test]
fn taylor_cylinder() {
    let summary = run("taylor-6061-t6.toml", &[]);
    assert_contract(&summary, "taylor-6061-t6.toml");
    let length = |key: &str| summary["lengths"][0][key].as_f64().expect("a length");
    assert!((length("initial_m") - 23.47e-3).abs() < 1e-15);
    assert!((0.66..0.70).contains(&(length("unloaded_m") / length("initial_m"))), "{summary}");
    assert!((length("final_m") / length("unloaded_m") - 1.0).abs() < 0.01, "{summary}");
    let folder = tempfile::tempdir().expect("a folder");
    let sets = ["--set", "effects.rate=material", "--set", "effects.lateral-inertia=true", "--set", "solve.method=fd"];
    let scene = runs().join("taylor-6061-t6.toml").display().to_string();
    let output = barwave(folder.path(), &[&["run", &scene, "-o", "out.h5"], &sets[..]].concat());
    let text = String::from_utf8_lossy(&output.stdout).into_owned();
    assert!(text.contains("final length"), "{text}{}", String::from_utf8_lossy(&output.stderr));
}

#[test]
fn tapered_horn() {
    let sets = ["solve.method=moc", "solve.front-tolerance=0.002", "solve.cells=", "solve.until=\"110 us\""];
    let sets: Vec<&str> = sets.iter().flat_map(|set| ["--set", set]).collect();
    let mut peaks = [0.0; 2];
    for (peak, sets) in peaks.iter_mut().zip([&[][..], &sets]) {
        let folder = tempfile::tempdir().expect("a folder");
        let summary = run_in("tapered-horn.toml", folder.path(), sets);
        assert_contract(&summary, "tapered-horn.toml");
        assert_eq!(summary["effects"], serde_json::json!(["plasticity", "hardening: isotropic"]));
        let file = barwave::record::store::ResultFile::open(&folder.path().join("out.h5")).expect("a result file");
        // From the arrival of the front until the first wave returns from the free end.
        let gauges = file.gauges().expect("gauges");
        let tip = gauges.iter().find(|gauge| gauge.name == "tip").expect("a gauge");
        let early = tip.trace.time.iter().zip(&tip.trace.velocity).filter(|(t, _)| **t < 110e-6);
        *peak = early.map(|(_, v)| *v).fold(0.0, f64::max);
    }
    // Stresses within pieces of the staircase have errors of up to 2 %, velocities smaller ones.
    assert!(peaks[0] > 4.0 && (peaks[0] / peaks[1] - 1.0).abs() < 0.02, "{peaks:?}");
}

#[test]
fn torsion_tube() {
    let moc = ["--set", "solve.method=moc", "--set", "solve.cells="];
    for sets in [&[][..], &moc] {
        let summary = run("torsion-tube.toml", sets);
        assert_contract(&summary, "torsion-tube.toml");
        assert_eq!(summary["effects"], serde_json::json!(["plasticity", "hardening: isotropic"]));
        let torsion = &summary["torsion"];
        assert!((number(&torsion["radius_m"]) - 0.012).abs() < 1e-15);
        // After the release, it has no torque.
        assert_eq!(number(&torsion["torque_N_m"][0]), 0.0);
        let speed = (45e9_f64 / 8900.0).sqrt();
        assert!((number(&summary["fronts"][0]["speed_m_s"]) / speed - 1.0).abs() < 1e-12);
    }
}

#[test]
fn stored_torque() {
    let folder = tempfile::tempdir().expect("a folder");
    let summary = run_in("stored-torque.toml", folder.path(), &[]);
    assert_contract(&summary, "stored-torque.toml");
    let file = barwave::record::store::ResultFile::open(&folder.path().join("out.h5")).expect("a result file");
    let gauges = file.gauges().expect("gauges");
    let pulse = &gauges.iter().find(|gauge| gauge.name == "pulse").expect("a gauge").trace;
    // Half the stored stress, from 1 m of travel on, for the time that a wave takes to the clamped end and back.
    let c0 = (27e9_f64 / 2810.0).sqrt();
    for (&time, &stress) in pulse.time.iter().zip(&pulse.stress) {
        let [start, end] = [1.0 / c0, 3.0 / c0];
        let expected = if (start..end).contains(&time) { 30e6 } else { 0.0 };
        let at_front = (time - start).abs() < 1e-5 || (time - end).abs() < 1e-5;
        assert!(at_front || (stress - expected).abs() < 1e-3 * 30e6, "{time}: {stress}");
    }
    assert!(number(&summary["ledger"]["energy_residual"]) < 1e-12);
}

#[test]
fn torsion_rod() {
    let moc = ["--set", "solve.method=moc", "--set", "solve.cells="];
    let mut torques = [0.0; 2];
    for (torque, sets) in torques.iter_mut().zip([&[][..], &moc]) {
        let folder = tempfile::tempdir().expect("a folder");
        let summary = run_in("torsion-rod.toml", folder.path(), sets);
        assert_contract(&summary, "torsion-rod.toml");
        *torque = number(&summary["torsion"]["torque_N_m"][0]);
        let file = barwave::record::store::ResultFile::open(&folder.path().join("out.h5")).expect("a result file");
        let names: Vec<String> = file.materials().expect("materials").into_iter().map(|m| m.name).collect();
        assert_eq!(names, ["steel, rod", "steel, tube of diameter ratio 0.6"]);
        assert!(file.fields().contains(&barwave::record::Field::Torque));
    }
    // The bored part has 87 % of the torque: the reflection from the joint has hardly reached the flywheel.
    assert!(torques[0] < -300.0 && (torques[0] / torques[1] - 1.0).abs() < 0.01, "{torques:?}");
}

#[test]
fn bilinear_p2_moc() {
    let summary = run("bilinear-p2-moc.toml", &[]);
    assert_contract(&summary, "bilinear-p2-moc.toml");
    assert!(number(&summary["events"]) > 10.0);
    let fronts = summary["fronts"].as_array().expect("a list");
    let origins: Vec<&str> = fronts.iter().filter_map(|f| f["origin"].as_str()).collect();
    assert_eq!(origins[..2], ["left", "left"]);
    assert!(origins.len() > 2 && origins[2..].iter().all(|o| *o == "interior"), "{origins:?}");
    for front in fronts {
        // Both are computed from the same few numbers.
        let ratio = number(&front["speed_measured_m_s"]) / number(&front["speed_m_s"]);
        assert!((ratio - 1.0).abs() < 1e-12, "{front}");
    }
    // Before any reflection, the run is compared with the exact solution.
    let short = run("bilinear-p2-moc.toml", &["--set", "solve.until=\"157.98734 us\""]);
    assert!(number(&short["error"]["value"]) < 1e-14, "{}", short["error"]);
}

#[test]
fn a_scene_with_a_tolerance_says_how_it_was_solved_and_stays_below() {
    let summary = run("copper-to-a-tolerance.toml", &[]);
    assert_contract(&summary, "copper-to-a-tolerance.toml");
    let choice = &summary["choice"];
    assert_eq!(choice["tolerance"], 1e-3);
    let tried = choice["tried"].as_array().expect("a list");
    assert_eq!(tried[tried.len() - 1]["scheme"], summary["scheme"]);
    assert!(number(&summary["error"]["value"]) <= 1e-3, "{}", summary["error"]);
}

#[test]
fn copper_released() {
    let summary = run("copper-released.toml", &[]);
    assert_contract(&summary, "copper-released.toml");
    assert_eq!(summary["outcome"], "done");
    assert!(number(&summary["events"]) > 1000.0);
    // Released, and with a free far end: both stresses are zero.
    assert_eq!((number(&summary["left"]["stress_Pa"]), number(&summary["right"]["stress_Pa"])), (0.0, 0.0));
}

/// A striker that slows down unloads the slowest front first. The others are followed for as long as the load exceeds their own stress, and have the
/// speed of theory.
#[test]
fn the_fronts_of_a_slowing_striker_are_followed() {
    let changes = [
        "left.kind=striker",
        "left.value=",
        "left.mass=\"20 kg\"",
        "left.velocity=\"30 m/s\"",
        "bar.area=\"5 cm^2\"",
        "effects.hardening=isotropic",
        "solve.cells=1000",
    ];
    let summary = run("copper-below-critical.toml", &changes.map(|change| ["--set", change]).concat());
    let fronts = summary["fronts"].as_array().expect("a list");
    let (_, others) = fronts.split_last().expect("fronts");
    assert!(others.len() > 10 && others.iter().all(|front| front["speed_measured_m_s"].is_number()), "{others:?}");
    // The bar is 1 m long.
    assert!(assert_speeds(&summary, 1e-3, 0.0, "a slowing striker") > 10, "{others:?}");
}

#[test]
fn lock_up() {
    let summary = check("lock-up.toml", [0.0, 1.0], 2);
    let shock = &summary["fronts"][1];
    // Value stated in the scene. The shock overshoots a little in its cells, and plastic flow retains this as strain: 0.3 %.
    assert!((number(&shock["speed_m_s"]) - 170.2513).abs() < 1e-3, "{shock}");
    assert!((number(&shock["speed_measured_m_s"]) / 170.2513 - 1.0).abs() < 5e-3, "{shock}");
    assert!(number(&summary["error"]["value"]) < 1e-2, "{}", summary["error"]);
    assert!((number(&summary["left"]["stress_Pa"]) / -5e6 - 1.0).abs() < 1e-2, "{}", summary["left"]);
}

/// Artificial viscosity makes a shock a few cells wide; elastic waves of a few cells behind it decay. The shock is a little slow, since its cells
/// overshoot and plastic flow retains this as strain. The remaining error decreases not with the cell size, but with the time step.
#[test]
fn lock_up_by_leapfrog() {
    for (cfl, error, speed) in [("1", 2.4e-2, 0.023), ("0.5", 2e-2, 0.016), ("0.125", 1.3e-2, 0.009)] {
        let set = ["--set", "solve.scheme=leapfrog", "--set", &format!("solve.cfl={cfl}")];
        let summary = run("lock-up.toml", &set);
        assert_contract(&summary, "lock-up.toml");
        assert!(number(&summary["error"]["value"]) < error, "cfl {cfl}: {}", summary["error"]);
        let measured = number(&summary["fronts"][1]["speed_measured_m_s"]);
        assert!((measured / 170.2513 - 1.0).abs() < speed, "cfl {cfl}: {measured}");
    }
}

/// Scenes written for other methods, with the conservative scheme.
#[test]
fn muscl_runs_what_leapfrog_runs() {
    let set = ["--set", "solve.scheme=muscl", "--set", "solve.method=fd", "--set", "solve.cells=1000"];
    let summary = run("bilinear-p2.toml", &set);
    assert_contract(&summary, "bilinear-p2.toml");
    assert!(number(&summary["error"]["value"]) < 3.1e-3, "{}", summary["error"]);
    for name in ["elastic-check.toml", "stepped-bar.toml", "pulse-tension-us.toml", "falling-weight.toml"] {
        assert_contract(&run(name, &set), name);
    }
}

#[test]
fn falling_weight() {
    let fd = ["--set", "solve.method=fd", "--set", "solve.cells=1000"];
    let mut velocities = [0.0; 2];
    for (velocity, sets) in velocities.iter_mut().zip([&[][..], &fd[..]]) {
        let summary = run("falling-weight.toml", sets);
        assert_contract(&summary, "falling-weight.toml");
        // The striker has separated: nothing acts on the struck end any more, and it moves back.
        assert_eq!(number(&summary["left"]["stress_Pa"]), 0.0);
        assert!(number(&summary["ledger"]["momentum_residual"]) < 1e-10, "{summary}");
        assert!(number(&summary["ledger"]["energy_residual"]) < 1e-10, "{summary}");
        *velocity = number(&summary["left"]["striker_velocity_m_s"]);
        assert!(summary["right"].get("striker_velocity_m_s").is_none());
    }
    // Both are of second order, in steps of about a thousandth.
    assert!(velocities[0] < -3.0 && (velocities[0] / velocities[1] - 1.0).abs() < 1e-4, "{velocities:?}");
}

/// Foot-pound, J.
const FOOT_POUND: f64 = 1.355_817_948_331_400_4;

#[test]
fn energy_method() {
    let folder = tempfile::tempdir().expect("a folder");
    let light = ["--set", "striker.mass=50 lb", "--set", "striker.velocity=30 ft/s"];
    // (arguments, outcome, energies in ft lbf, threshold and residual velocity in ft/s), as printed with four digits.
    for (sets, outcome, available, threshold, residual) in
        [(&[][..], "rupture", 19_892.0, 17.77, 78.0), (&light[..], "done", 699.3, 35.55, 0.0)]
    {
        let summary = run("energy-method.toml", sets);
        assert_eq!((&summary["outcome"], &summary["method"]), (&outcome.into(), &"energy".into()));
        let close = |key: &str, expected: f64| {
            let found = number(&summary[key]);
            assert!((found - expected).abs() <= 5e-4 * expected, "{key}: {found} {expected}");
        };
        close("available_energy_J", available * FOOT_POUND);
        close("capacity_J", 981.7 * FOOT_POUND);
        close("absorbed_energy_J", f64::min(available, 981.7) * FOOT_POUND);
        close("threshold_velocity_m_s", threshold * 0.3048);
        close("residual_velocity_m_s", residual * 0.3048);
        assert_eq!(summary["breaks"], outcome == "rupture");
        assert!(summary["strain"].is_null());
    }
    // Sentences use the units of the rest.
    let auto = runs().join("copper-auto.toml").display().to_string();
    let output = barwave(folder.path(), &["run", &auto, "--units", "us", "-o", "auto.h5"]);
    let text = String::from_utf8_lossy(&[output.stdout, output.stderr].concat()).into_owned();
    assert!(output.status.success() && text.contains("bar radius 197 mil, rise time 0 s"), "{text}");
    assert!(text.contains("at a stress of 31.5975 ksi") && !text.contains(" mm") && !text.contains(" MPa"), "{text}");
    let scene = runs().join("energy-method.toml").display().to_string();
    let output = barwave(folder.path(), &["plan", &scene, "--units", "us"]);
    let text = String::from_utf8_lossy(&output.stdout).into_owned();
    assert!(output.status.success() && text.contains("17.77") && !text.contains("outcome"), "{text}");
    assert!(barwave(folder.path(), &["check", &scene]).status.success());
    assert!(barwave(folder.path(), &["run", &scene, "-o", "r.h5", "--quiet"]).status.success());
    let drawn = barwave(folder.path(), &["report", "r.h5"]);
    assert_eq!(drawn.status.code(), Some(2));
    assert!(String::from_utf8_lossy(&drawn.stderr).contains("nothing to plot"));
}

/// `tests/suite/impacts.rs` tests their numbers.
#[test]
fn other_impacts() {
    for name in [
        "spheres.toml",
        "spheres-restitution.toml",
        "ballistic-pendulum.toml",
        "plate.toml",
        "beam.toml",
        "beam-three-contacts.toml",
        "beam-damped.toml",
    ] {
        let summary = run(name, &[]);
        assert_keys(
            &summary,
            &["scene", "outcome", "method", "scheme", "effects", "equation", "validity", "notes", "wall_s", "output"],
            name,
        );
        assert_eq!(summary["outcome"], "done", "{summary}");
    }
}

#[test]
fn ball_on_lever() {
    let summary = run("ball-on-lever.toml", &[]);
    assert_contract(&summary, "ball-on-lever.toml");
    assert!(number(&summary["ledger"]["energy_residual"]) < 1e-10, "{summary}");
    // The shaft absorbs almost all of the 2 m/s (tests/suite/hertz_on_bars.rs has the sum over modes).
    let velocity = number(&summary["left"]["striker_velocity_m_s"]);
    assert!(velocity.abs() < 0.05 * 2.0, "{velocity}");
}

#[test]
fn split_hopkinson() {
    for sets in [&[][..], &["--set", "solve.method=moc", "--set", "solve.cells="]] {
        let summary = run("split-hopkinson.toml", sets);
        assert_contract(&summary, "split-hopkinson.toml");
        // The striker is at rest; the transmission bar is moving.
        assert!(number(&summary["left"]["velocity_m_s"]).abs() < 0.01, "{summary}");
        assert!(number(&summary["right"]["velocity_m_s"]) > 1.0, "{summary}");
        assert!(number(&summary["ledger"]["momentum_residual"]) < 1e-10, "{summary}");
        assert!(number(&summary["ledger"]["energy_residual"]) < 1e-9, "{summary}");
    }
}

#[test]
fn ball_on_bar() {
    let summary = run("ball-on-bar.toml", &[]);
    assert_contract(&summary, "ball-on-bar.toml");
    assert!(number(&summary["ledger"]["momentum_residual"]) < 1e-10, "{summary}");
    assert!(number(&summary["ledger"]["energy_residual"]) < 1e-10, "{summary}");
    // On a rigid rod it would rebound with 5 m/s; the rod absorbs a sixth of that (tests/suite/ball.rs has the equation).
    let velocity = number(&summary["left"]["striker_velocity_m_s"]);
    assert!((-4.12..-4.10).contains(&velocity), "{velocity}");
    let fast = ["--set", "effects.rate={ model = \"malvern\", k = 1e6 }"];
    let net = number(&run("ball-on-bar.toml", &fast)["left"]["striker_velocity_m_s"]);
    // The rod stays elastic; both are of second order in steps of a hundredth of the contact.
    assert!((net / velocity - 1.0).abs() < 1e-4, "{net} {velocity}");
    let fronts = ["--set", "solve.method=moc", "--set", "solve.cells="];
    let tracked = run("ball-on-bar.toml", &fronts);
    assert_contract(&tracked, "ball-on-bar.toml");
    let tracked = number(&tracked["left"]["striker_velocity_m_s"]);
    assert!((tracked / velocity - 1.0).abs() < 1e-4, "{tracked} {velocity}");
}

#[test]
fn striker_bar() {
    for sets in [&[][..], &["--set", "solve.method=fd", "--set", "solve.front-tolerance=", "--set", "solve.cells=1800"]]
    {
        let summary = run("striker-bar.toml", sets);
        assert_contract(&summary, "striker-bar.toml");
        // The short bar comes to rest where it strikes, and the long one moves on; nothing else could have momentum.
        assert_eq!(number(&summary["left"]["stress_Pa"]), 0.0);
        assert!(number(&summary["left"]["velocity_m_s"]).abs() < 0.02, "{summary}");
        assert!(number(&summary["ledger"]["momentum_residual"]) < 1e-10, "{summary}");
        assert!(number(&summary["ledger"]["energy_residual"]) < 1e-10, "{summary}");
    }
}

#[test]
fn the_energy_method_s_lighter_weight_does_not_break_the_bar() {
    let light = ["--set", "bar.segment.1.area=176.056 in^2", "--set", "bar.segment.1.velocity=30 ft/s"];
    let holds = run("energy-method-breaks.toml", &light);
    assert_eq!(holds["outcome"], "done", "{holds}");
}

/// Runs a scene written for the grid with front tracking.
fn by_characteristics(name: &str) -> Value {
    let sets = ["--set", "solve.method=moc", "--set", "solve.front-tolerance=0"];
    let text = std::fs::read_to_string(runs().join(name)).expect("the scene");
    let cells = if text.lines().any(|l| l.starts_with("cells = ")) { &["--set", "solve.cells="][..] } else { &[] };
    let summary = run(name, &[&sets[..], cells].concat());
    assert_contract(&summary, name);
    summary
}

#[test]
fn both_methods_tell_the_same_story_of_an_elastic_bar() {
    let (grid, tracked) = (run("elastic-check.toml", &[]), by_characteristics("elastic-check.toml"));
    for key in ["outcome", "effects", "above_critical", "audit", "critical_velocity_m_s"] {
        assert_eq!(grid[key], tracked[key], "{key}");
    }
    assert!(number(&tracked["elastic_check"]["relative"]) < 1e-12, "{tracked}");
    assert!(number(&tracked["error"]["value"]) < 1e-14, "{tracked}");
}

#[test]
fn both_methods_tell_the_same_story_above_the_critical_velocity() {
    let (grid, tracked) = (run("copper-above-critical.toml", &[]), by_characteristics("copper-above-critical.toml"));
    for key in ["outcome", "effects", "above_critical", "critical_velocity_m_s"] {
        assert_eq!(grid[key], tracked[key], "{key}");
    }
    assert_eq!(tracked["outcome"], "rupture");
    // The note on the fracture of the pulled end at t = 0 is the same. Only the grid has strain beyond the data in the first cell: here, it is
    // concentrated at a point.
    let [of_grid, of_tracked] = [&grid, &tracked].map(|summary| {
        let mut rows = summary["audit"].as_array().expect("a list").iter();
        rows.find(|row| row["effect"] == "rupture").expect("a row on rupture")
    });
    let message = &of_tracked["message"];
    assert!(message.as_str().is_some_and(|m| m.contains("fractures there at t = 0")), "{message}");
    assert_eq!((of_grid, of_tracked["estimate"].as_f64()), (of_tracked, Some(1.0)));
    // The run continues with the end stress held at the ultimate stress: the same to the accuracy of the grid.
    let ratio = number(&grid["left"]["stress_Pa"]) / number(&tracked["left"]["stress_Pa"]);
    assert!((ratio - 1.0).abs() < 1e-4, "{ratio}");
    // The edge of the bar follows only as fast as waves transmit strain: at the critical velocity.
    let (edge, critical) = (number(&tracked["left"]["velocity_m_s"]), number(&tracked["critical_velocity_m_s"]));
    assert!((edge / -critical - 1.0).abs() < 1e-9, "{edge}");
}

/// Critical velocity 20.3 m/s: 5.1 m/s up to yield and 15.2 m/s up to the largest stress. The left end pulls at 14 m/s.
const WEAK: &str = r#"
[bar]
length = 1
material = { name = "weak", density = 7800, modulus = 200e9, beyond = "rupture", curve = { table = [[0.001, 200e6], [0.01, 400e6], [0.02, 400e6]] } }
[left]
kind = "velocity"
value = -14
[right]
RIGHT
[effects]
hardening = "isotropic"
[solve]
until = "700 us"
SOLVE
"#;

#[test]
fn both_methods_tell_the_same_story_where_waves_meet_above_the_critical_velocity() {
    let folder = tempfile::tempdir().expect("a folder");
    // Where the waves meet, at a fixed end or in the middle, the stress is that of twice 14 m/s.
    for right in ["kind = \"fixed\"", "kind = \"velocity\"\nvalue = 14"] {
        let [grid, tracked] = ["cells = 1000", "method = \"moc\""].map(|solve| -> Value {
            let text = WEAK.replace("RIGHT", right).replace("SOLVE", solve);
            std::fs::write(folder.path().join("weak.toml"), text).expect("written");
            let output = barwave(folder.path(), &["run", "weak.toml", "--json"]);
            serde_json::from_slice(&output.stdout).unwrap_or_else(|e| panic!("{e}: {output:?}"))
        });
        for key in ["outcome", "above_critical", "effects", "critical_velocity_m_s"] {
            assert_eq!(grid[key], tracked[key], "{right}: {key}");
        }
        assert_eq!((&tracked["outcome"], &tracked["above_critical"]), (&"rupture".into(), &false.into()), "{right}");
        for summary in [&grid, &tracked] {
            let notes = summary["audit"].as_array().expect("a list");
            let matters = |row: &Value| number(&row["estimate"]) >= number(&row["threshold"]);
            assert!(notes.iter().any(|row| row["effect"] == "rupture" && matters(row)), "{right}: {notes:?}");
        }
    }
}

#[test]
fn an_event_budget_that_runs_out_keeps_the_frames() {
    let folder = tempfile::tempdir().expect("a folder");
    let scene = runs().join("copper-released.toml").display().to_string();
    let output = barwave(
        folder.path(),
        &["run", &scene, "-o", "a.h5", "--set", "solve.max-events=5000", "--set", "solve.front-tolerance=1e-4"],
    );
    let message = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(1), "{message}");
    for part in ["the run stopped at t = ", "its limit of 5000 events", "help: ", "front-tolerance = ", "a.h5"] {
        assert!(message.contains(part), "expected `{part}`: {message}");
    }
    let file = barwave::record::store::ResultFile::open(&folder.path().join("a.h5")).expect("a result file");
    assert_eq!(file.metadata().outcome, "stopped");
    assert!(file.metadata().reason.as_ref().is_some_and(|r| r.contains("5000 events")));
    let frames = file.time().expect("times").len();
    assert!(frames > 10 && frames < 201, "{frames} frames");
    assert!(!file.paths().expect("paths").is_empty() && !file.fronts().expect("fronts").is_empty());
}

/// Two elastic bars and a striker.
const TWO_BARS: &str = r#"
[[bar.segment]]
length = 1
area = 2e-4
material = { density = 7800, modulus = 195e9, beyond = "extend", curve = { table = [[0.5, 97.5e9]] } }
[[bar.segment]]
length = 0.3
area = 1.5e-4
material = { density = 8500, modulus = 76.5e9, beyond = "extend", curve = { table = [[0.5, 38.25e9]] } }
[left]
kind = "striker"
mass = 0.5
velocity = 8
[right]
kind = "fixed"
[solve]
until = 0.0015
method = "moc"
"#;

/// Returns the message of the run of the two bars, which exceeds its event limit.
fn out_of_events(settings: &str) -> String {
    let folder = tempfile::tempdir().expect("a folder");
    std::fs::write(folder.path().join("scene.toml"), TWO_BARS.to_owned() + settings).expect("a file");
    binary::failed(folder.path(), &["run", "scene.toml"], 1)
}

/// Returns the front tolerance that such a message recommends.
fn advised(message: &str) -> &str {
    let advised = message.split("set front-tolerance = ").nth(1).and_then(|rest| rest.split(' ').next());
    advised.unwrap_or_else(|| panic!("{message}"))
}

/// The recommended front tolerance uses most of the events; 2.1e-3 would use only a seventh.
#[test]
fn the_front_tolerance_that_is_advised_uses_the_events() {
    let message = out_of_events("max-events = 1000000\nfront-tolerance = 1e-4\n");
    let set = format!("solve.front-tolerance={}", advised(&message));
    let folder = tempfile::tempdir().expect("a folder");
    std::fs::write(folder.path().join("scene.toml"), TWO_BARS.to_owned() + "max-events = 1000000\n").expect("a file");
    let summary = binary::json(folder.path(), &["run", "scene.toml", "--json", "--set", &set]);
    let events = summary["events"].as_u64().expect("a number");
    assert!((250_000..=1_000_000).contains(&events), "{set}: {events}");
}

/// The error of stresses is about the front tolerance, so that 0.5 must not be recommended.
#[test]
fn no_front_tolerance_is_advised_that_makes_large_errors() {
    let message = out_of_events("max-events = 10000\n");
    let tolerance: f64 = advised(&message).parse().expect("a number");
    assert!(tolerance <= 0.1, "{message}");
    let message = out_of_events("max-events = 1000\n");
    let help = "does not complete with any front-tolerance up to 0.1: use method = \"fd\", or increase max-events";
    assert!(message.contains(help), "{message}");
}

/// The audit notes what grids leave behind a fracture: `notes` of `--json` must contain this and all other findings of the audit.
#[test]
fn the_notes_of_json_are_those_of_the_text() {
    let folder = tempfile::tempdir().expect("a folder");
    let scene = Path::new(env!("CARGO_MANIFEST_DIR")).join("runs/spall.toml");
    std::fs::copy(scene, folder.path().join("spall.toml")).expect("a scene");
    let run = ["run", "spall.toml", "--set", "solve.cells=400"];
    let text = binary::done(folder.path(), &run);
    let printed: Vec<&str> = text.lines().filter_map(|line| line.strip_prefix("  note: ")).collect();
    let json = binary::json(folder.path(), &[&run[..], &["--json", "--force"]].concat());
    assert!(printed.iter().any(|note| note.starts_with("On the grid the fracture at ")), "{text}");
    assert_eq!(json["notes"], serde_json::json!(printed));
}

/// Only sharp waves need to cross a cell in exactly one step.
#[test]
fn plans_state_by_how_much_transit_times_are_rounded() {
    let dir = tempfile::tempdir().expect("a folder");
    let shift = |drive: &str| {
        let scene = format!(
            "[[bar.segment]]\nlength = 0.3\nmaterial = \"copper-ofhc-jc\"\n[[bar.segment]]\nlength = 0.3\nmaterial = \"mild-steel\"\n\
             [left]\nkind = \"velocity\"\n{drive}\n[right]\nkind = \"fixed\"\n[solve]\nmethod = \"fd\"\ncells = 500\nuntil = \"100 us\"\n"
        );
        std::fs::write(dir.path().join("scene.toml"), scene).expect("a folder to write to");
        let json = binary::json(dir.path(), &["plan", "scene.toml", "--json"]);
        let shift = json["largest_transit_shift"].as_f64().expect("a number");
        let text = binary::done(dir.path(), &["plan", "scene.toml"]);
        let line = format!("transit times     rounded by up to {shift:.1e}: waves cross a cell in a step");
        assert_eq!(text.contains(&line), shift > 0.0, "{text}");
        shift
    };
    let sudden = shift("value = 2");
    assert!(sudden > 1e-7 && sudden < 1e-3, "{sudden}");
    assert_eq!(shift("history = [[0, 0], [1e-5, 2]]"), 0.0);
    assert!(shift("history = [[0, 0], [1e-5, 2], [1e-5, 1]]") > 0.0);
}

#[test]
fn plans_of_both_methods_are_made() {
    let plan = |name: &str| -> Value {
        let output = barwave(&runs(), &["plan", name, "--json"]);
        assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
        serde_json::from_slice(&output.stdout).expect("one JSON value")
    };
    assert_keys(&plan("bilinear-p2.toml"), &["cells", "dt_s", "steps", "memory_bytes", "expected_s"], "fd");
    let tracked = plan("copper-released.toml");
    let keys = ["front_tolerance", "stress_scale_Pa", "first_fronts", "lines", "event_budget", "expected_s"];
    assert_keys(&tracked, &keys, "moc");
    assert!(tracked.get("cells").is_none() && tracked.get("steps").is_none());
    let text = String::from_utf8(barwave(&runs(), &["plan", "copper-released.toml"]).stdout).expect("text");
    assert!(text.contains("at most 10000000") && text.contains("expected time"), "{text}");
    let exact = plan("bilinear-p2-moc.toml");
    let folder = tempfile::tempdir().expect("a folder");
    let output = folder.path().join("a.h5").display().to_string();
    let run = barwave(&runs(), &["run", "bilinear-p2-moc.toml", "-o", &output, "--json"]);
    let run: Value = serde_json::from_slice(&run.stdout).expect("one JSON value");
    assert_eq!((&exact["tried_share"], &exact["expected_events"]), (&1.0.into(), &run["events"]));
}

#[test]
fn no_scene_of_runs_is_left_out() {
    let source = include_str!("run_binary.rs");
    for entry in std::fs::read_dir(runs()).expect("runs") {
        let path = entry.expect("an entry").path();
        if path.extension().is_some_and(|e| e == "toml") {
            let name = path.file_name().expect("a name").to_string_lossy().into_owned();
            assert!(source.contains(&format!("\"{name}\"")), "runs/{name} is in no test");
        }
    }
}

/// Returns a small scene in a folder of its own.
fn small_scene() -> (tempfile::TempDir, String) {
    let folder = tempfile::tempdir().expect("a folder");
    let text = "[bar]\nlength = 1\nmaterial = \"mild-steel\"\n[left]\nkind = \"velocity\"\nvalue = -1\n\
                [right]\nkind = \"free\"\n[solve]\nuntil = \"50 us\"\ncells = 100\n";
    std::fs::write(folder.path().join("small.toml"), text).expect("written");
    (folder, "small.toml".into())
}

#[test]
fn the_default_output_is_beside_the_scene_or_in_runs_out() {
    let (folder, scene) = small_scene();
    let output_of = |scene: &str| {
        let output = barwave(folder.path(), &["run", scene, "--json"]);
        let summary: Value = serde_json::from_slice(&output.stdout).expect("one JSON value");
        summary["output"].as_str().expect("a path").to_owned()
    };
    assert_eq!(output_of(&scene), "small.h5");
    std::fs::create_dir(folder.path().join("inside")).expect("a folder");
    std::fs::copy(folder.path().join(&scene), folder.path().join("inside/a.toml")).expect("a copy");
    assert_eq!(output_of("inside/a.toml"), "inside/a.h5");
    std::fs::create_dir(folder.path().join("runs")).expect("a folder");
    assert_eq!(output_of(&scene), "runs/out/small.h5");
    assert!(folder.path().join("runs/out/small.h5").is_file());
}

#[test]
fn set_changes_the_scene() {
    let (folder, scene) = small_scene();
    let arguments = ["run", &scene, "--json", "--set", "solve.cells=250", "--set", "left.value=\"2 m/s\""];
    let summary: Value = serde_json::from_slice(&barwave(folder.path(), &arguments).stdout).expect("one JSON value");
    assert_eq!(summary["cells"], 250);
    assert_eq!(number(&summary["left"]["velocity_m_s"]), 2.0);
}

#[test]
fn quiet_prints_nothing() {
    let (folder, scene) = small_scene();
    let output = barwave(folder.path(), &["run", &scene, "--quiet"]);
    assert_eq!((output.status.code(), output.stdout.len(), output.stderr.len()), (Some(0), 0, 0));
    let loud = barwave(folder.path(), &["run", &scene]);
    assert!(String::from_utf8_lossy(&loud.stdout).contains("ledger"));
}

/// Checks that the exit code is 2, stdout is empty, and the message contains the words and help.
fn assert_refused(output: &Output, words: &[&str]) {
    let message = String::from_utf8_lossy(&output.stderr);
    assert_eq!((output.status.code(), output.stdout.len()), (Some(2), 0), "{message}");
    assert!(message.contains("help:") && words.iter().all(|word| message.contains(word)), "{message}");
}

#[test]
fn wrong_places_are_refused() {
    let (folder, scene) = small_scene();
    let scene_as_folder = format!("{scene}/a.h5");
    let refused = barwave(folder.path(), &["run", &scene, "-o", &scene_as_folder]);
    assert_eq!(refused.status.code(), Some(1), "{}", String::from_utf8_lossy(&refused.stderr));
    assert_refused(&barwave(folder.path(), &["run", &scene, "-o", "."]), &["is a folder"]);
    assert_refused(&barwave(folder.path(), &["run", "smal.toml"]), &["smal.toml", "no such file"]);
    // In particular, the scene must not be replaced.
    let before = std::fs::read(folder.path().join(&scene)).expect("a scene");
    assert_refused(&barwave(folder.path(), &["run", &scene, "-o", &scene]), &["is a file that this command reads"]);
    assert_eq!(std::fs::read(folder.path().join(&scene)).expect("a scene"), before);
    assert_refused(&barwave(folder.path(), &["report", ".", "-o", "a.svg"]), &["is a folder"]);
    for (set, words) in [
        ("bar.segment.5.length=1", ["bar.segment.5.length", "no item 5: the scene has no such list"]),
        ("solve.cells.x=5", ["solve.cells.x", "cannot be set inside"]),
        ("solve=3", ["solve", "integer `3`, expected a table"]),
    ] {
        assert_refused(&barwave(folder.path(), &["run", &scene, "--set", set]), &words);
    }
    let wrong = ["run", &scene, "--set", "solve.cfl=1.5"];
    assert_refused(&barwave(folder.path(), &wrong), &["solve.cfl", "1.5", "0 < cfl <= 1"]);
    // No file is left.
    assert_eq!(std::fs::read_dir(folder.path()).expect("a folder").count(), 1);
}

/// A segment shorter than a cell reduces the time step of the whole bar. Every command that reads such a scene notes this, and the result file stores
/// the note.
#[test]
fn a_segment_shorter_than_a_cell_is_noted() {
    let folder = tempfile::tempdir().expect("a folder");
    let scene = |length: &str, solve: &str| {
        let steel = "material = { name = \"steel\", density = 7800, modulus = 200e9, beyond = \"extend\", curve = { table = \
                     [[0.001, 200e6]] } }";
        format!(
            "[[bar.segment]]\nlength = 0.1\n{steel}\n[[bar.segment]]\nlength = {length}\n{steel}\n[left]\nkind = \
             \"velocity\"\nvalue = 1\n\
             [right]\nkind = \"free\"\n[solve]\nuntil = 2e-5\n{solve}\n"
        )
    };
    for (name, text, noted) in [
        ("short.toml", scene("1e-5", "cells = 100"), true),
        ("muscl.toml", scene("1e-5", "cells = 100\nscheme = \"muscl\""), true),
        ("even.toml", scene("0.1", "cells = 100"), false),
        ("tracked.toml", scene("1e-5", "method = \"moc\""), false),
    ] {
        std::fs::write(folder.path().join(name), text).expect("a file");
        for command in [&["check", name] as &[&str], &["plan", name], &["run", name, "-o", "out.h5"]] {
            let output = barwave(folder.path(), command);
            let stdout = String::from_utf8_lossy(&output.stdout);
            assert_eq!(output.status.code(), Some(0), "{command:?}: {}", String::from_utf8_lossy(&output.stderr));
            assert_eq!(stdout.contains("  note: segment 2"), noted, "{command:?}: {stdout}");
        }
        for command in [&["plan", name, "--json"] as &[&str], &["run", name, "--json", "-o", "out.h5"]] {
            let output = barwave(folder.path(), command);
            let value: Value = serde_json::from_slice(&output.stdout).expect("one JSON value");
            assert_eq!(value["notes"].as_array().map(Vec::len), Some(usize::from(noted)), "{command:?}: {value}");
        }
        let file = barwave::record::store::ResultFile::open(&folder.path().join("out.h5")).expect("a result file");
        assert_eq!(file.metadata().notes.len(), usize::from(noted), "{name}");
    }
}

/// A perfectly plastic rod in torsion. Stresses at faces beyond those that the curve can carry would drive the Godunov scheme to strains of 158 with
/// energy from nothing. The whole imposed rotation in one cell is a strain of 0.42.
#[test]
fn a_perfectly_plastic_rod_in_torsion_keeps_its_energy() {
    let folder = tempfile::tempdir().expect("a folder");
    let scene = |solve: &str| {
        format!(
            "[bar]\nmode = \"torsion\"\nlength = 1\ndiameter = 0.02\n\
             material = {{ name = \"level\", loading = \"shear\", density = 7800, modulus = 80e9, beyond = \"extend\", \
             curve = {{ table = [[0.002, 160e6], [0.5, 160e6]] }} }}\n[left]\nkind = \"velocity\"\nvalue = 2000\n[right]\nkind \
             = \"free\"\n\
             [effects]\nhardening = \"isotropic\"\n[solve]\nuntil = \"1 ms\"\ncells = 20\n{solve}\n"
        )
    };
    for solve in ["scheme = \"muscl\"", "scheme = \"leapfrog\""] {
        std::fs::write(folder.path().join("rod.toml"), scene(solve)).expect("a file");
        let output = barwave(folder.path(), &["run", "--quiet", "rod.toml", "-o", "out.h5"]);
        assert_eq!(output.status.code(), Some(0), "{solve}: {}", String::from_utf8_lossy(&output.stderr));
        let file = barwave::record::store::ResultFile::open(&folder.path().join("out.h5")).expect("a result file");
        let largest =
            file.field(barwave::record::Field::Strain, 0..file.time().expect("times").len()).expect("strains");
        let largest = largest.iter().fold(0.0_f64, |most, strain| most.max(strain.abs()));
        assert!(largest < 0.42, "{solve}: {largest}");
    }
}
