//! `tolerance` in place of a method: the true error is below what was asked, and the run says how it got there. The whole
//! study of twenty scenes is `examples/tolerance.rs`; here is what takes seconds.

#[path = "common/known.rs"]
mod known;

use std::path::Path;
use std::process::Command;

use barwave::run::{self, Wish};
use known::known;
use serde_json::Value;

/// Tolerances of the fast subset; the finest is for the scenes whose fronts are few.
const TOLERANCES: [f64; 3] = [1e-1, 1e-2, 1e-3];

/// Cell-steps that make a scene too slow for this suite.
const SLOW: [&str; 1] = ["Cowper and Symonds"];

#[test]
fn the_true_error_is_below_the_tolerance() {
    let mut wrong = Vec::new();
    for case in known().iter().filter(|case| !SLOW.contains(&case.name)) {
        for tolerance in TOLERANCES {
            let scene = case.scene(&format!("tolerance = {tolerance:e}"));
            let summary = run::run(&scene, None, &mut |_| Wish::GoOn);
            let summary = summary.unwrap_or_else(|e| panic!("{} at {tolerance}: {e}", case.name));
            let estimate = summary.error.as_ref().map_or(f64::NAN, |e| e.value);
            let error = case.true_error(&scene, &summary);
            let line =
                format!("{} at {tolerance}: {}, estimate {estimate:.1e}, error {error:.1e}", case.name, summary.scheme);
            println!("{line}");
            if !(error <= tolerance && estimate <= tolerance) {
                wrong.push(line);
            }
        }
    }
    assert!(wrong.is_empty(), "{wrong:#?}");
}

/// Fronts are so few in most of these scenes that tracking them is exact and no grid is ever chosen: here they have to do it
/// alone.
#[test]
fn grids_meet_a_tolerance_too() {
    let mut wrong = Vec::new();
    for case in known().iter().filter(|case| !SLOW.contains(&case.name)) {
        for tolerance in [1e-1, 3e-2] {
            let mut scene = case.scene(&format!("tolerance = {tolerance:e}"));
            let asked = scene.solve.tolerance.as_mut().expect("a tolerance");
            asked.methods.retain(|method| method.names()[1] == "leapfrog");
            let summary = run::run(&scene, None, &mut |_| Wish::GoOn);
            let summary = summary.unwrap_or_else(|e| panic!("{} at {tolerance}: {e}", case.name));
            let estimate = summary.error.as_ref().map_or(f64::NAN, |e| e.value);
            let error = case.true_error(&scene, &summary);
            let line = format!(
                "{} at {tolerance}: {} cells, estimate {estimate:.1e}, error {error:.1e}",
                case.name, summary.cells
            );
            println!("{line}");
            if !(error <= tolerance && estimate <= tolerance) {
                wrong.push(line);
            }
        }
    }
    assert!(wrong.is_empty(), "{wrong:#?}");
}

fn barwave(folder: &Path, arguments: &[&str]) -> std::process::Output {
    Command::new(env!("CARGO_BIN_EXE_barwave")).args(arguments).current_dir(folder).output().expect("the binary runs")
}

fn json(output: &std::process::Output) -> Value {
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    serde_json::from_slice(&output.stdout).expect("stdout is one JSON value")
}

fn folder_with(name: &str, solve: &str) -> tempfile::TempDir {
    let folder = tempfile::tempdir().expect("a folder");
    let case = known().into_iter().find(|case| case.name == name).expect("one of them");
    let text = case.text.replace("[solve]\n", &format!("[solve]\n{solve}\n"));
    std::fs::write(folder.path().join("scene.toml"), text).expect("a file");
    folder
}

#[test]
fn the_summary_says_what_was_chosen_and_the_plan_what_there_is_to_choose() {
    let folder = folder_with("let go, 2.5 transits", "tolerance = 1e-3");
    let plan = json(&barwave(folder.path(), &["plan", "scene.toml", "--json"]));
    let schemes: Vec<&str> =
        plan["choice"]["schemes"].as_array().expect("a list").iter().filter_map(Value::as_str).collect();
    assert!(schemes.contains(&"front-tracking") && schemes.contains(&"leapfrog"), "{schemes:?}");
    assert_eq!(plan["scheme"], "front-tracking", "{plan}");
    let summary = json(&barwave(folder.path(), &["run", "scene.toml", "--json", "-o", "out.h5"]));
    let choice = &summary["choice"];
    assert_eq!(choice["tolerance"], 1e-3);
    assert!(choice["why"].as_str().is_some_and(|why| why.contains("front-tracking")), "{choice}");
    let last = choice["tried"].as_array().and_then(|t| t.last()).expect("what was run");
    assert_eq!(last["scheme"], summary["scheme"]);
    assert_eq!(last["estimate"], summary["error"]["value"]);
    assert!(summary["error"]["value"].as_f64().is_some_and(|e| e <= 1e-3));
    let file = barwave::record::store::ResultFile::open(&folder.path().join("out.h5")).expect("it opens");
    let error = file.facts().error.as_ref().expect("an error figure");
    assert_eq!(Some(error.value), summary["error"]["value"].as_f64());
}

#[test]
fn a_tolerance_stands_alone() {
    for (solve, key) in [
        ("tolerance = 1e-3\nmethod = \"fd\"", "solve.method"),
        ("tolerance = 1e-3\ncells = 100", "solve.cells"),
        ("tolerance = 0", "solve.tolerance"),
        ("tolerance = 0.6", "solve.tolerance"),
    ] {
        let folder = folder_with("P2 bilinear", solve);
        let output = barwave(folder.path(), &["run", "scene.toml"]);
        let message = String::from_utf8_lossy(&output.stderr).into_owned();
        assert_eq!(output.status.code(), Some(2), "{message}");
        assert!(message.contains(key), "{message}");
    }
}

#[test]
fn a_grid_says_how_far_it_may_be_off_where_that_is_asked_for() {
    let folder = folder_with("bilinear, free, 3 transits", "cells = 800");
    let without = json(&barwave(folder.path(), &["run", "scene.toml", "--json", "-o", "a.h5"]));
    assert!(without["error"].is_null());
    let with = json(&barwave(folder.path(), &["run", "scene.toml", "--json", "-o", "b.h5", "--estimate-error"]));
    let error = &with["error"];
    assert!(
        error["reference"].as_str().is_some_and(|r| r.contains("400 and 200 cells") && r.contains("Richardson")),
        "{error}"
    );
    let case = known().into_iter().find(|c| c.name == "bilinear, free, 3 transits").expect("one of them");
    let truth = case.error_of(&case.scene("cells = 800"));
    let value = error["value"].as_f64().expect("a figure");
    println!("estimate {value:.2e}, error {truth:.2e}");
    assert!(value >= truth && value < 10.0 * truth, "{value} {truth}");
    // The companions change nothing of the run itself.
    for key in ["cells", "steps", "left", "right", "ledger"] {
        assert_eq!(with[key], without[key], "{key}");
    }
}
