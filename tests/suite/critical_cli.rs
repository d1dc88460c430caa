//! `barwave critical`, `compare` and `materials` through the real binary.

use crate::common::binary;

use std::process::Output;

use binary::barwave;
use serde_json::Value;

fn json(output: &Output) -> Value {
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    serde_json::from_slice(&output.stdout).expect("stdout is one JSON value")
}

fn folder_with(files: &[(&str, &str)]) -> tempfile::TempDir {
    let folder = tempfile::tempdir().expect("a folder");
    for (name, text) in files {
        std::fs::write(folder.path().join(name), text).expect("a file");
    }
    folder
}

const T_A: &str = "[[0, 0], [0.001, \"100 MPa\"], [0.01, \"150 MPa\"], [0.05, \"230 MPa\"], [0.2, \"330 MPa\"]]";

fn material(table: &str, beyond: &str) -> String {
    format!("density = 8000\n[curve]\nbeyond = \"{beyond}\"\ntable = {table}\n")
}

#[test]
fn critical_prints_the_contracts_keys() {
    let folder = folder_with(&[]);
    let rows = json(&barwave(folder.path(), &["critical", "copper-annealed", "mild-steel", "--json"]));
    let rows = rows.as_array().expect("a list");
    assert_eq!(rows.len(), 2);
    let keys = [
        "material",
        "density_kg_m3",
        "critical_velocity_m_s",
        "strain_at_max",
        "stress_at_max_Pa",
        "yield_velocity_m_s",
        "reason",
    ];
    assert!(keys.iter().all(|key| rows[0].get(key).is_some()), "{rows:?}");
    assert_eq!(rows[0]["material"], "copper-annealed");
    assert_eq!(rows[0]["reason"], "maximum-stress");
    let v_c = rows[0]["critical_velocity_m_s"].as_f64().expect("a number");
    assert!((v_c - 90.07).abs() < 0.1, "{v_c}");
}

#[test]
fn a_rising_curve_is_never_given_a_critical_velocity() {
    let rising = (material(T_A, "error"), material(T_A, "extend"), material(T_A, "rupture"));
    let folder = folder_with(&[("error.toml", &rising.0), ("extend.toml", &rising.1), ("rupture.toml", &rising.2)]);
    let rows = json(&barwave(folder.path(), &["critical", "error.toml", "extend.toml", "rupture.toml", "--json"]));
    assert!(rows[0]["critical_velocity_m_s"].is_null() && rows[0]["strain_at_max"].is_null());
    assert!(rows[0]["reason"].as_str().is_some_and(|r| r.contains("still increases") && r.contains("0.2")));
    assert!(rows[1]["critical_velocity_m_s"].is_null());
    assert!(rows[1]["reason"].as_str().is_some_and(|r| r.contains("increases without limit")));
    assert_eq!(rows[2]["reason"], "rupture-strain");
    let v_c = rows[2]["critical_velocity_m_s"].as_f64().expect("a number");
    assert!((v_c / 74.336_804 - 1.0).abs() < 1e-6, "{v_c}");
    // sigma_y/(rho c0) = 100 MPa/(8000 * 3535.534).
    let v_y = rows[0]["yield_velocity_m_s"].as_f64().expect("a number");
    assert!((v_y / 3.535_534 - 1.0).abs() < 1e-6, "{v_y}");
}

#[test]
fn compression_has_its_own_answer() {
    let folder = folder_with(&[]);
    let rows = json(&barwave(folder.path(), &["critical", "copper-annealed", "--sense", "compression", "--json"]));
    assert!(rows[0]["critical_velocity_m_s"].is_null());
    assert_eq!(rows[0]["sense"], "compression");
}

#[test]
fn wrong_materials_exit_with_2_and_say_where() {
    let folder = folder_with(&[("bad.toml", &material("[[0.001, 1e8], [0.001, 2e8]]", "error"))]);
    let cases: [(&[&str], &[&str]); 4] = [
        (&["critical", "mild-stel"], &["unknown material `mild-stel`", "mild-steel"]),
        (&["critical", "bad.toml"], &["bad.toml", "row 2", "1e-3"]),
        (&["critical", "nowhere.toml"], &["nowhere.toml", "no such file"]),
        (&["compare", "mild-steel", "-o", "x.eps"], &["x.eps", ".svg"]),
    ];
    for (arguments, words) in cases {
        let output = barwave(folder.path(), arguments);
        assert_eq!(output.status.code(), Some(2), "{arguments:?}");
        let message = String::from_utf8_lossy(&output.stderr).into_owned();
        assert!(words.iter().all(|w| message.contains(w)), "{message}");
        assert!(message.contains("help"), "{message}");
        assert!(output.stdout.is_empty());
    }
    assert!(!folder.path().join("x.pdf").exists());
}

#[test]
fn compare_writes_each_kind_of_file() {
    let folder = folder_with(&[("a.toml", &material(T_A, "error"))]);
    let starts: [(&str, &[u8]); 4] = [
        ("o.svg", b"<svg"),
        ("o.png", b"\x89PNG"),
        ("o.html", b"<!DOCTYPE html>"),
        ("o.csv", b"material,strain,stress_Pa"),
    ];
    for (name, start) in starts {
        let output = barwave(folder.path(), &["compare", "copper-annealed", "a.toml", "-o", name]);
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        assert!(String::from_utf8_lossy(&output.stdout).contains("copper-annealed"));
        let written = std::fs::read(folder.path().join(name)).expect("the file is there");
        assert!(written.starts_with(start), "{name}");
    }
    let svg = std::fs::read_to_string(folder.path().join("o.svg")).expect("text");
    assert!(["MPa", "m/s", "copper-annealed"].iter().all(|word| svg.contains(word)));
    // The last row of the table is the last knot of T-A: its slowest front and the sum of all jumps.
    let csv = std::fs::read_to_string(folder.path().join("o.csv")).expect("text");
    let last: Vec<f64> =
        csv.trim().lines().last().expect("rows").split(',').skip(1).map(|c| c.parse().expect("a number")).collect();
    assert!((last[2] / 288.675_1 - 1.0).abs() < 1e-6 && (last[3] / 74.336_804 - 1.0).abs() < 1e-6, "{last:?}");
    let compared = json(&barwave(folder.path(), &["compare", "a.toml", "--json"]));
    assert_eq!(compared[0]["fronts"].as_array().map(Vec::len), Some(4));
}

#[test]
fn materials_lists_shows_and_imports() {
    let folder = folder_with(&[("steel.csv", "strain,stress_MPa\n0.001,200\n0.02,300\n0.2,400\n0.3,350\n")]);
    let list = json(&barwave(folder.path(), &["materials", "list", "--json"]));
    assert!(list.as_array().is_some_and(|l| l.len() >= 8));
    let shown = barwave(folder.path(), &["materials", "show", "steel-4340-jc"]);
    let text = String::from_utf8_lossy(&shown.stdout).into_owned();
    assert!(
        ["A = 792 MPa", "C = 0.014", "Johnson and Cook 1983", "fitted"].iter().all(|word| text.contains(word)),
        "{text}"
    );

    let import = ["materials", "import", "steel.csv", "--density", "7.85 g/cm^3", "--beyond", "rupture"];
    let imported = barwave(folder.path(), &import);
    assert!(imported.status.success(), "{}", String::from_utf8_lossy(&imported.stderr));
    let rows = json(&barwave(folder.path(), &["critical", "steel.toml", "--json"]));
    assert_eq!((&rows[0]["strain_at_max"], &rows[0]["density_kg_m3"]), (&0.2.into(), &7850.0.into()));
    assert_eq!(barwave(folder.path(), &import).status.code(), Some(2), "it would overwrite");

    let user = folder.path().join("materials");
    std::fs::create_dir(&user).expect("a folder");
    std::fs::rename(folder.path().join("steel.toml"), user.join("steel.toml")).expect("moved");
    std::fs::rename(folder.path().join("steel.csv"), user.join("steel.csv")).expect("moved");
    assert!(barwave(folder.path(), &["critical", "steel"]).status.success());
    let path = barwave(folder.path(), &["materials", "path"]);
    assert!(String::from_utf8_lossy(&path.stdout).contains("materials"));
    let path = barwave(folder.path(), &["materials", "path", "--json"]);
    let found: Value = serde_json::from_slice(&path.stdout).expect("JSON");
    assert_eq!(found["folders"][0]["exists"], true, "{found:#}");
}

#[test]
fn a_wrong_csv_is_refused_before_anything_is_written() {
    let folder = folder_with(&[("a.csv", "0.001,2e8\n0.0005,3e8\n")]);
    let output = barwave(folder.path(), &["materials", "import", "a.csv", "--density", "7850"]);
    assert_eq!(output.status.code(), Some(2));
    assert!(String::from_utf8_lossy(&output.stderr).contains("row 2"));
    assert!(!folder.path().join("a.toml").exists());
}

/// Repeats tested in tension, compression or shear must not be averaged together.
#[test]
fn repeats_have_one_loading() {
    let folder = tempfile::tempdir().expect("a folder");
    let write = |name: &str, more: &str| {
        let rows = "beyond = \"rupture\"\n[curve]\ntable = [[1e-3, 200e6], [0.1, 400e6]]";
        std::fs::write(folder.path().join(name), format!("density = 7850\n{more}\n{rows}\n")).expect("a file");
    };
    write("pulled.toml", "sense = \"tension\"");
    write("pressed.toml", "sense = \"compression\"");
    write("sheared.toml", "loading = \"shear\"");
    for (other, name) in [("pressed.toml", "compression"), ("sheared.toml", "shear")] {
        let output = barwave(folder.path(), &["critical", "--repeats", "pulled.toml", other]);
        let message = String::from_utf8_lossy(&output.stderr).into_owned();
        assert_eq!(output.status.code(), Some(2), "{message}");
        assert!(message.contains("in tension") && message.contains(&format!("in {name}")), "{message}");
        assert!(message.contains(other) && message.contains("--repeats"), "{message}");
    }
}

#[test]
fn repeats_have_one_density() {
    let light = material(T_A, "rupture").replace("8000", "2700");
    let folder = folder_with(&[("a.toml", &material(T_A, "rupture")), ("b.toml", &light)]);
    let output = barwave(folder.path(), &["critical", "--repeats", "a.toml", "b.toml"]);
    let message = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(2), "{message}");
    assert!(message.contains("--repeats") && message.contains("2700") && message.contains("one density"), "{message}");
}

#[test]
fn a_critical_velocity_is_confirmed_on_a_grid_that_has_converged() {
    let falls = "name = \"falls\"\ndensity = 7850\nbeyond = \"rupture\"\n[curve]\nunit = \"MPa\"\n\
                 table = [[0.001, 200], [0.01, 150], [0.2, 350], [0.3, 320], [0.35, 380]]\n";
    let folder = folder_with(&[("falls.toml", falls)]);
    let rows = json(&barwave(folder.path(), &["critical", "falls.toml", "--simulate", "--json"]));
    let simulated = &rows[0]["simulated"];
    let number = |value: &Value| value.as_f64().expect("a number");
    // 400 cells give another velocity than 200 cells.
    assert!(number(&simulated["grid"]["cells"]) > 400.0, "{simulated}");
    let change = number(&simulated["grid"]["resolution_m_s"]) / number(&rows[0]["critical_velocity_m_s"]);
    assert_eq!(simulated["confirmed"] == true, change < 0.01, "{simulated}");
}
