//! `barwave cost` through the real binary: keys, columns, files, budget, interruption. Nothing here depends on the speed of the machine: every study
//! ends with what its budget allows.

use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};

use serde_json::Value;

fn scene(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("runs").join(name)
}

fn command(folder: &Path, name: &str, arguments: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_barwave"));
    command.arg("cost").arg(scene(name)).args(arguments).current_dir(folder);
    command
}

fn cost(folder: &Path, name: &str, arguments: &[&str]) -> Output {
    command(folder, name, arguments).output().expect("the binary runs")
}

fn json(output: &Output) -> Value {
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    serde_json::from_slice(&output.stdout).expect("stdout is one JSON value")
}

fn list<'a>(value: &'a Value, key: &str) -> &'a [Value] {
    value[key].as_array().unwrap_or_else(|| panic!("{key} is no list"))
}

fn number(value: &Value, key: &str) -> f64 {
    value[key].as_f64().unwrap_or_else(|| panic!("{key} of {value} is no number"))
}

#[test]
fn json_has_the_contracts_keys_and_front_tracking_is_exact_where_a_grid_is_not() {
    let folder = tempfile::tempdir().expect("a folder");
    let found = json(&cost(folder.path(), "bilinear-p2.toml", &["--json", "--budget", "4s"]));
    for key in ["scene", "reference", "points", "orders", "cheapest", "effects", "growth", "skipped", "unable"] {
        assert!(found.get(key).is_some(), "{key} is missing");
    }
    assert!(found["reference"].as_str().is_some_and(|r| r.contains("self-similar")), "{}", found["reference"]);
    for point in list(&found, "points") {
        for key in ["error", "step_wall_s", "work"] {
            assert!(number(point, key) >= 0.0);
        }
        assert!(point.get("whole_wall_s").is_some());
        let resolution = [point.get("cells"), point.get("front_tolerance")];
        assert_eq!(resolution.iter().flatten().count(), 1, "{point}");
    }
    let tracked = list(&found, "points").iter().find(|p| p["scheme"] == "front-tracking").expect("it can do this");
    // Rounding of sums of a dozen products.
    assert!(number(tracked, "error") < 1e-13 && tracked["exact"] == true, "{tracked}");
    let cells: Vec<&Value> = list(&found, "points").iter().filter(|p| p["scheme"] == "leapfrog").collect();
    let falls = |pair: &[&Value]| number(pair[1], "error") < number(pair[0], "error");
    assert!(cells.len() >= 2 && cells.windows(2).all(falls), "{cells:?}");
    assert_eq!(number(cells[1], "work"), 4.0 * number(cells[0], "work"));
    let tolerances: Vec<f64> = list(&found, "cheapest").iter().map(|c| number(c, "tolerance")).collect();
    assert_eq!(tolerances, [0.1, 0.01, 0.001, 0.0001]);
    assert!(list(&found, "cheapest").iter().all(|c| c["method"].is_string() && c["step_wall_s"].is_number()));
    let effect = &list(&found, "effects")[0];
    assert_eq!(effect["effect"], "hardening: isotropic");
    assert!(["ns_per_cell_step", "ns_spread", "ratio_to_none"].iter().all(|key| effect.get(key).is_some()));
}

#[test]
fn a_table_has_a_row_a_point_under_its_headings() {
    let folder = tempfile::tempdir().expect("a folder");
    let arguments = ["--quiet", "--budget", "3s", "-o", "points.csv", "--set", "left.value=15 m/s"];
    let output = cost(folder.path(), "bilinear-p2.toml", &arguments);
    assert!(output.status.success() && output.stdout.is_empty(), "{}", String::from_utf8_lossy(&output.stderr));
    let mut table = csv::Reader::from_path(folder.path().join("points.csv")).expect("a table");
    let headings = table.headers().expect("headings").clone();
    let column = |name: &str| headings.iter().position(|h| h == name).unwrap_or_else(|| panic!("no column {name}"));
    let [scheme, cells, tolerance, error, time] =
        ["scheme", "cells", "front_tolerance", "error", "step_wall_s"].map(column);
    let rows: Vec<csv::StringRecord> = table.records().map(|r| r.expect("a row")).collect();
    assert!(rows.len() >= 3, "{rows:?}");
    for row in &rows {
        assert_eq!(row[cells].is_empty(), &row[scheme] == "front-tracking");
        assert_eq!(row[tolerance].is_empty(), &row[scheme] != "front-tracking");
        assert!(row[error].parse::<f64>().is_ok() && row[time].parse::<f64>().is_ok());
    }
}

#[test]
fn pictures_are_drawn_and_name_every_method() {
    let folder = tempfile::tempdir().expect("a folder");
    let output = cost(folder.path(), "mild-steel-precursor.toml", &["--budget", "4s", "-o", "figure.svg"]);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let svg = std::fs::read_to_string(folder.path().join("figure.svg")).expect("a picture");
    // A rate law uses the net and the grid, but no tracked fronts.
    assert!(svg.contains("characteristic-net") && svg.contains("leapfrog") && !svg.contains("front-tracking"));
    assert!(svg.contains("0.01 %") && svg.contains("Pareto front"));
    let text = String::from_utf8(output.stdout).expect("text");
    assert!(text.contains("a finer run of the same scheme: errors are estimates"), "{text}");
}

#[test]
fn wrong_input_is_refused_before_anything_runs() {
    let folder = tempfile::tempdir().expect("a folder");
    let refused = |arguments: &[&str]| {
        let output = cost(folder.path(), "bilinear-p2.toml", arguments);
        assert_eq!(output.status.code(), Some(2), "{arguments:?}");
        String::from_utf8(output.stderr).expect("text")
    };
    assert!(refused(&["--budget", "0"]).contains("help:"));
    assert!(refused(&["--budget", "5 m"]).contains("--budget"));
    assert!(refused(&["-o", "figure.eps"]).contains(".csv, .svg, .png, .pdf, .html or .json"));
    assert!(refused(&["--set", "solve.method=magic"]).contains("method"));
    assert!(refused(&["--measure", "strain"]).contains("residual-strain, peak-force"));
    assert!(refused(&["--measure", "gauges", "--set", "record.gauges={}"]).contains("the scene has no gauges"));
}

/// A copper bar under a decreasing stress. All leapfrog grids give the same peak force, that of the exact start of the wave. Leapfrog with 3200 cells
/// must not serve as the reference, with an "uncertainty" of 6e-12, since front tracking and the Godunov scheme differ from it by about 1e-5.
const BLAST: &str = r#"
bar = { length = "0.5 m", diameter = "10 mm", material = "copper-annealed" }
left = { kind = "stress", history = [["0 us", "-120 MPa"], ["40 us", "0 MPa"]] }
right = { kind = "fixed" }
effects = { hardening = "isotropic" }
solve = { until = "250 us", cells = 400 }
record = { frames = 2 }
"#;

#[test]
fn grids_that_agree_with_each_other_alone_are_no_certain_reference() {
    let folder = tempfile::tempdir().expect("a folder");
    std::fs::write(folder.path().join("blast.toml"), BLAST).expect("a folder to write to");
    let scene = folder.path().join("blast.toml");
    let scene = scene.to_str().expect("a path in UTF-8");
    let arguments = ["--json", "--budget", "6s", "--measure", "peak-force"];
    let found = json(&cost(folder.path(), scene, &arguments));
    let (reference, uncertainty) =
        (found["reference"].as_str().expect("a name"), number(&found, "reference_uncertainty"));
    let points = list(&found, "points").iter();
    let others = points.filter(|point| !reference.starts_with(point["scheme"].as_str().expect("a name")));
    let nearest = others.map(|point| number(point, "error")).fold(f64::INFINITY, f64::min);
    println!("{reference}, uncertain by {uncertainty}; nearest of another method {nearest}");
    assert!(uncertainty > 1e-6 && nearest + uncertainty > 1e-5, "{reference}: {uncertainty}, {nearest}");
    // Without a decrease of the error there is no order.
    let orders = found["orders"].as_object().expect("orders").values();
    assert!(orders.filter_map(Value::as_f64).all(|order| order > 0.0), "{}", found["orders"]);
}

/// The pulse has left the bar at the end time: the relative error of the stress at that time is undefined, but that over the bar and time is not.
#[test]
fn methods_are_compared_in_a_bar_without_stress_at_the_end() {
    let folder = tempfile::tempdir().expect("a folder");
    let pulse = [
        "left.release=20us",
        "right={kind=\"absorbing\"}",
        "solve.until=500us",
        "solve.method=\"fd\"",
        "solve.cells=100",
    ];
    for measure in ["field", "peak-force"] {
        let mut arguments = vec!["--json", "--budget", "4s", "--measure", measure];
        arguments.extend(pulse.iter().flat_map(|set| ["--set", set]));
        let found = json(&cost(folder.path(), "bilinear-p2.toml", &arguments));
        let points = list(&found, "points");
        for scheme in ["leapfrog", "muscl", "front-tracking"] {
            let own: Vec<&Value> = points.iter().filter(|point| point["scheme"] == scheme).collect();
            assert!(!own.is_empty(), "{scheme} by {measure}: {}", found["skipped"]);
            for point in own {
                assert_eq!(point["error"], point["errors"][measure.replace('-', "_")], "{point}");
                assert!(number(point, "error") < 1.0, "{point}");
            }
        }
    }
}

#[cfg(unix)]
#[test]
fn an_interrupted_study_shows_what_there_is_and_exits_with_130() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut command = command(folder.path(), "copper-released.toml", &["--json", "--budget", "600s"]);
    let child = command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().expect("it starts");
    std::thread::sleep(std::time::Duration::from_secs(2));
    let killed = Command::new("kill").args(["-INT", &child.id().to_string()]).status().expect("kill is there");
    assert!(killed.success());
    let output = child.wait_with_output().expect("it ends");
    assert_eq!(output.status.code(), Some(130));
    let said = String::from_utf8_lossy(&output.stderr);
    assert!(said.contains("measured"), "it says what is kept: {said}");
    // Either no output, or a complete report that states the interruption.
    if !output.stdout.is_empty() {
        let found: Value = serde_json::from_slice(&output.stdout).expect("one JSON value");
        assert_eq!(found["interrupted"], true);
    }
}
