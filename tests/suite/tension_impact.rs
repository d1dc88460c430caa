//! `barwave study tension-impact` against the theory of von Kármán and Duwez.

use crate::common::binary;

use std::path::Path;
use std::process::Output;

use binary::barwave;
use serde_json::Value;

/// Options of a coarse specimen of a material.
const COARSE: [&str; 2] = ["--cells", "40"];

fn study(folder: &Path, more: &[&str], specimen: &[&str]) -> Output {
    barwave(folder, &[&["study", "tension-impact"], more, specimen].concat())
}

fn json(output: &Output) -> Value {
    assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
    serde_json::from_slice(&output.stdout).expect("JSON")
}

fn folder() -> tempfile::TempDir {
    tempfile::tempdir().expect("a folder")
}

/// Below the critical velocity (90.1 m/s), the whole bar is strained according to the static curve; above, it fractures at the struck end while the
/// rest has hardly yielded.
#[test]
fn elongation_falls_at_the_critical_velocity() {
    let folder = folder();
    let results = json(&study(
        folder.path(),
        &["copper-annealed", "--velocities", "3,60,85,89 m/s,92,110", "-o", "out", "--json"],
        &COARSE,
    ));
    let points = results["points"].as_array().expect("points");
    let column = |key: &str| points.iter().map(|point| point[key].as_f64()).collect::<Vec<_>>();
    let elongation = column("elongation");
    let at_end: Vec<_> = points.iter().map(|point| point["at_struck_end"].as_bool()).collect();
    assert_eq!(at_end, [false, false, false, false, true, true].map(Some));
    assert!(points.iter().all(|point| point["status"] == "rupture" && point["at_once"] == point["at_struck_end"]));
    let fixed = results["static_elongation"].as_f64().expect("a number");
    assert!(elongation.iter().all(|e| *e <= Some(1.01 * fixed)), "{elongation:?} {fixed}");
    // A slow test strains the bar uniformly.
    assert!(elongation[0] > Some(0.96 * fixed), "{elongation:?}");
    // The reflection at the fixed end fractures the bar early; below the critical velocity, the elongation is near its maximum again.
    assert!(elongation[1] < Some(0.8 * fixed) && elongation[3] > Some(0.93 * fixed), "{elongation:?}");
    assert!(elongation[4] < Some(0.5 * fixed) && elongation[5] < Some(0.1 * fixed), "{elongation:?}");
    let energy = column("energy_absorbed_J");
    assert!(energy[5] < energy[3].map(|energy| 0.1 * energy), "{energy:?}");
    assert_eq!(results["critical_between_m_s"], serde_json::json!([89.0, 92.0]));
    assert_eq!(column("fracture_position_m")[5], Some(0.0));
}

/// With heat, the values of the curve are those of the adiabatic one, and are named so.
#[test]
fn the_curve_is_named() {
    let folder = folder();
    let heated = SCENE.replace("rupture", "heat = {}\nrupture").replace("copper-annealed", "titanium-6al-4v-jc");
    std::fs::write(folder.path().join("scene.toml"), heated).expect("a scene");
    let named = |what: &str, curve: &str| {
        let cells: &[&str] = if what == "scene.toml" { &[] } else { &COARSE };
        let output = study(folder.path(), &[what, "--velocities", "200 m/s", "-o", curve], cells);
        let text = String::from_utf8_lossy(&output.stdout).into_owned();
        assert!(text.contains(&format!("m/s, from the {curve} curve")), "{text}");
        assert!(text.contains(&format!("({curve} curve 0.")), "{text}");
        let figure = std::fs::read_to_string(folder.path().join(curve).join("tension-impact.svg")).expect("a figure");
        assert!(figure.contains(&format!("{curve} curve")));
        let again = study(folder.path(), &[what, "--velocities", "200 m/s", "-o", curve, "--resume", "--json"], cells);
        let results = json(&again);
        assert_eq!(results["curve"], curve);
        results["critical_velocity_m_s"].as_f64().expect("a number")
    };
    assert!(named("scene.toml", "adiabatic") < 0.95 * named("titanium-6al-4v-jc", "static"));
}

/// A second run is refused; a resumed one runs nothing and changes nothing.
#[test]
fn a_study_is_resumed() {
    let folder = folder();
    let arguments =
        ["copper-annealed", "--velocities", "40 m/s", "--to", "120 m/s", "--count", "3", "-o", "out", "--json"];
    let first = json(&study(folder.path(), &arguments, &COARSE));
    assert_eq!(study(folder.path(), &arguments, &COARSE).status.code(), Some(2));
    let rows = std::fs::read_to_string(folder.path().join("out/rows.jsonl")).expect("rows");
    let (kept, _) = rows.trim_end().rsplit_once('\n').expect("three rows");
    std::fs::write(folder.path().join("out/rows.jsonl"), format!("{kept}\n")).expect("two rows");
    assert_eq!(json(&study(folder.path(), &[&arguments[..], &["--resume"]].concat(), &COARSE)), first);
    for file in ["tension-impact.csv", "tension-impact.h5", "tension-impact.svg"] {
        assert!(folder.path().join("out").join(file).metadata().is_ok_and(|file| file.len() > 100), "{file}");
    }
}

/// A bar with a free far end follows its slow end without fracture.
#[test]
fn a_free_bar_is_pulled_along_below_the_critical_velocity() {
    let folder = folder();
    let arguments = ["copper-annealed", "--far-end", "free", "--velocities", "5 m/s,100 m/s", "-o", "out", "--json"];
    let results = json(&study(folder.path(), &arguments, &COARSE));
    let points = &results["points"];
    assert_eq!((&points[0]["status"], &points[0]["elongation"]), (&"done".into(), &Value::Null));
    assert_eq!((&points[1]["status"], &points[1]["at_struck_end"]), (&"rupture".into(), &true.into()));
}

const SCENE: &str = "[bar]\nlength = 0.1\ndiameter = 0.01\nmaterial = \"copper-annealed\"\n[left]\nkind = \"velocity\"\nvalue \
                     = -1\n[right]\n\
                     kind = \"fixed\"\n[effects]\nhardening = \"isotropic\"\nrupture = \"critical-strain\"\n[solve]\nuntil = \
                     1\nmethod = \
                     \"fd\"\ncells = 30\n[record]\nframes = 2\n";

/// Writes the scene with front tracking that stops at this number of events.
fn limited(folder: &Path, tolerance: f64, events: u32) {
    let method = format!("method = \"moc\"\nfront-tolerance = {tolerance}\nmax-events = {events}\n");
    let text = SCENE.replace("method = \"fd\"\ncells = 30\n", &method).replace("length = 0.1", "length = 0.2");
    std::fs::write(folder.join("scene.toml"), text).expect("a scene");
}

/// A run that stops before a wave has returned from the far end decides nothing: it is no bound of the critical velocity, and has no numbers.
#[test]
fn a_run_that_stopped_undecided_is_no_bound() {
    let folder = folder();
    limited(folder.path(), 0.003, 40);
    let arguments = ["scene.toml", "--velocities", "85,91,95", "-o", "out", "--json"];
    let results = json(&study(folder.path(), &arguments, &[]));
    let points = results["points"].as_array().expect("points");
    assert_eq!(points[0]["status"], "stopped");
    for (key, others) in [("at_once", true), ("at_struck_end", true)] {
        assert_eq!(
            points.iter().map(|point| point[key].as_bool()).collect::<Vec<_>>(),
            [None, Some(others), Some(others)]
        );
    }
    assert_eq!(results["critical_between_m_s"], Value::Null);
    let table = std::fs::read_to_string(folder.path().join("out/tension-impact.csv")).expect("a table");
    assert!(
        table.lines().nth(1).is_some_and(|row| row.starts_with("85.0,stopped,") && row.ends_with(",,,,,,")),
        "{table}"
    );
    let figure = std::fs::read_to_string(folder.path().join("out/tension-impact.svg")).expect("a figure");
    assert!(!figure.contains("85.0 m/s") && figure.contains("91.0 m/s"), "it has no residual strain");
    // A study without any result is an error, after its table is written.
    let output = study(folder.path(), &["scene.toml", "--velocities", "85", "-o", "one"], &[]);
    let said = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(1), "{said}");
    assert!(said.contains("no run has reached its end; the first one: the run stopped at"), "{said}");
    let figure = std::fs::read_to_string(folder.path().join("one/tension-impact.svg")).expect("a figure");
    assert!(figure.contains("critical velocity") && !figure.contains(">simulated<"), "{figure}");
}

/// A run that stops after a fracture keeps it.
#[test]
fn the_fracture_of_a_stopped_run_is_kept() {
    let folder = folder();
    limited(folder.path(), 0.02, 7000);
    let results = json(&study(folder.path(), &["scene.toml", "--velocities", "60,95", "-o", "out", "--json"], &[]));
    let point = &results["points"][0];
    assert_eq!((&point["status"], &point["elongation"]), (&"stopped".into(), &Value::Null));
    assert!(point["fracture_time_s"].as_f64().is_some_and(|time| (1.1e-3..1.3e-3).contains(&time)), "{point}");
    assert!(point["fracture_position_m"].as_f64().is_some_and(|x| (0.1..0.2).contains(&x)), "{point}");
    assert_eq!([&point["at_once"], &point["at_struck_end"]], [&Value::Bool(false); 2]);
    assert_eq!(results["critical_between_m_s"], serde_json::json!([60.0, 95.0]));
}

/// With a criterion of energy or stress the curve needs no maximum. The critical velocity is that of the curve up to the strain of fracture.
#[test]
fn a_material_without_largest_stress_breaks_by_energy_or_stress() {
    let folder = folder();
    let curve = "curve = { table = [[0.001, 200e6], [0.05, 350e6], [0.1, 400e6]] }";
    let material = format!("{{ name = \"m\", density = 7850, modulus = 200e9, beyond = \"extend\", {curve} }}");
    let scene = SCENE.replace("\"copper-annealed\"", &material).replace("cells = 30", "cells = 100");
    // 32.325 MJ/m^3 is the area below the curve up to the strain 0.1, where the stress is 400 MPa.
    for (k, criterion) in ["energy = 32.325e6", "spall = 400e6"].iter().enumerate() {
        let text = scene.replace("\"critical-strain\"", &format!("{{ {criterion} }}"));
        std::fs::write(folder.path().join("scene.toml"), text).expect("a scene");
        let out = format!("out{k}");
        let results = json(&study(folder.path(), &["scene.toml", "-o", &out, "--json"], &[]));
        let number = |key: &str| results[key].as_f64().expect("a number");
        // 200 MPa/(rho c0) + sqrt(150 MPa 0.049/rho) + sqrt(50 MPa 0.05/rho)
        assert!((number("critical_velocity_m_s") - (5.0475 + 30.599 + 17.846)).abs() < 0.02, "{results}");
        assert!((number("static_elongation") - 0.098).abs() < 1e-9, "{results}");
        let bound = |i: usize| results["critical_between_m_s"][i].as_f64().expect("a number");
        assert!(bound(0) < number("critical_velocity_m_s") && number("critical_velocity_m_s") < bound(1), "{results}");
    }
    // A material alone breaks by the critical strain, which this one does not have.
    let alone = format!("name = \"m\"\ndensity = 7850\nmodulus = 200e9\nbeyond = \"extend\"\n{curve}\n");
    std::fs::write(folder.path().join("m.toml"), alone).expect("a material");
    let output = study(folder.path(), &["m.toml"], &[]);
    let said = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.code() == Some(2) && said.contains("give a scene with rupture"), "{said}");
}

#[test]
fn scenes_are_tested_and_wrong_input_is_explained() {
    let folder = folder();
    std::fs::write(folder.path().join("scene.toml"), SCENE).expect("a scene");
    // A plain number is in SI units.
    let short = ["copper-annealed", "--length", "0.1", "--velocities", "100", "-o", "short", "--json"];
    assert_eq!(json(&study(folder.path(), &short, &COARSE))["length_m"], 0.1);
    let results = json(&study(folder.path(), &["scene.toml", "--velocities", "300 ft/s", "-o", "out", "--json"], &[]));
    assert_eq!(results["length_m"], 0.1);
    assert!((results["points"][0]["velocity_m_s"].as_f64().expect("a number") - 91.44).abs() < 1e-9);
    std::fs::write(folder.path().join("whole.toml"), SCENE.replace("rupture = \"critical-strain\"\n", ""))
        .expect("a scene");
    std::fs::write(folder.path().join("free.toml"), SCENE.replace("\"velocity\"\nvalue = -1", "\"free\""))
        .expect("a scene");
    let beam = Path::new(env!("CARGO_MANIFEST_DIR")).join("runs/beam.toml");
    std::fs::copy(beam, folder.path().join("beam.toml")).expect("a scene");
    for (arguments, words) in [
        (&["coper-annealed"][..], "copper-annealed"),
        (&["beam.toml"], "a scene with [beam] has no bar that is pulled"),
        (&["whole.toml"], "rupture = \"critical-strain\""),
        (&["free.toml"], "kind = \"velocity\""),
        (&["copper-annealed", "--velocities=-5 m/s"], "not an impact velocity"),
        (&["copper-annealed", "--velocities", "5 m"], "not an impact velocity"),
        (
            &["copper-annealed", "--velocities", "5,6", "--to", "9", "--count", "2"],
            "a range needs exactly one start velocity",
        ),
        (&["copper-annealed", "--length", "0 m"], "`--length`"),
        (&["copper-annealed", "--cells", "1"], "`--cells`"),
        (&["copper-annealed", "--figure", "a.eps"], ".svg"),
        (&["scene.toml", "--length", "0.1"], "`--length`: scene.toml is a scene: this option is for a material"),
        (&["scene.toml", "--diameter", "1 cm"], "set `bar.diameter` in the scene"),
        (&["scene.toml", "--far-end", "free"], "set `right.kind` in the scene"),
        (&["scene.toml", "--cells", "50"], "set `solve.cells` in the scene"),
    ] {
        let arguments = [&["study", "tension-impact"], arguments].concat();
        let output = barwave(folder.path(), &arguments);
        let said = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{arguments:?}: {said}");
        assert!(said.contains(words) && said.contains("help"), "{arguments:?}: {said}");
    }
    assert!(!folder.path().join("runs").exists());
}
