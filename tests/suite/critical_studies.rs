//! `barwave critical` with all materials, simulation, sensitivity, rate and repeats, through the real binary.

use crate::common::binary;

use std::path::Path;

use barwave::assemble;
use barwave::scene::Scene;
use barwave::solver::fd::Quantity;
use binary::barwave;
use serde_json::Value;

fn text(folder: &Path, arguments: &[&str]) -> String {
    let output = barwave(folder, arguments);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout).expect("text")
}

fn json(folder: &Path, arguments: &[&str]) -> Vec<Value> {
    serde_json::from_str(&text(folder, &[arguments, &["--json"]].concat())).expect("a JSON list")
}

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or_else(|| panic!("{value} is no number"))
}

#[test]
fn all_materials_are_sorted_and_fit_eighty_columns() {
    let folder = tempfile::tempdir().expect("a folder");
    let table = text(folder.path(), &["critical", "--all", "-o", "all.csv"]);
    assert!(table.lines().all(|line| line.chars().count() <= 80), "{table}");
    let rows = json(folder.path(), &["critical", "--all"]);
    assert!(rows.len() >= 18);
    let velocities: Vec<f64> = rows.iter().filter_map(|row| row["critical_velocity_m_s"].as_f64()).collect();
    assert!(velocities.windows(2).all(|pair| pair[0] >= pair[1]));
    let csv = std::fs::read_to_string(folder.path().join("all.csv")).expect("the table");
    assert_eq!(csv.lines().count(), rows.len() + 1);
}

#[test]
fn simulation_agrees_with_the_integral_to_a_thousandth_on_ten_materials() {
    let folder = tempfile::tempdir().expect("a folder");
    let names = [
        "aluminium-1100-o",
        "aluminium-2024-t3",
        "aluminium-6061-t6",
        "aluminium-7075-o",
        "copper-annealed",
        "copper-ofhc-jc",
        "magnesium-az31b-annealed",
        "mild-steel",
        "steel-304-annealed",
        "steel-4340-jc",
    ];
    let rows = json(folder.path(), &[&["critical", "--simulate"], &names[..]].concat());
    assert_eq!(rows.len(), 10);
    for row in &rows {
        let (velocity, simulated) = (number(&row["critical_velocity_m_s"]), &row["simulated"]);
        let [holds, breaks] = ["holds_m_s", "breaks_m_s"].map(|key| number(&simulated["fronts"][key]));
        assert!(holds < breaks && breaks - holds <= 1e-3 * breaks, "{row:#}");
        assert!((holds / velocity - 1.0).abs() <= 1e-3 && (breaks / velocity - 1.0).abs() <= 1e-3, "{row:#}");
        assert_eq!(simulated["confirmed"], true, "{row:#}");
        let grid = &simulated["grid"];
        let off = (number(&grid["holds_m_s"]) - velocity).abs();
        assert!(off <= 2.0 * number(&grid["resolution_m_s"]) + 2e-3 * velocity, "{row:#}");
    }
}

#[test]
fn parts_of_the_curve_add_up_to_the_critical_velocity() {
    let folder = tempfile::tempdir().expect("a folder");
    let row = &json(folder.path(), &["critical", "mild-steel", "--sensitivity"])[0];
    let intervals = row["sensitivity"].as_array().expect("intervals");
    let sum = |key: &str| intervals.iter().map(|i| number(&i[key])).sum::<f64>();
    let velocity = number(&row["critical_velocity_m_s"]);
    assert!((sum("contribution_m_s") / velocity - 1.0).abs() < 1e-9 && (sum("share") - 1.0).abs() < 1e-9);
    // 1 % more stress at all strains increases the velocity by half a percent.
    assert!((sum("per_percent_of_stress_m_s") / velocity / 0.005 - 1.0).abs() < 0.2, "{row:#}");
    let last = &intervals[intervals.len() - 1];
    assert_eq!(last["to"], row["strain_at_max"]);
    assert!(number(&last["per_percent_of_stress_m_s"]) > 0.0);
}

const RATE: &str = "density = 8000\nmodulus = \"200 GPa\"\nbeyond = \"rupture\"\n[curve]\ntable = [[0.001, \"200 MPa\"], [0.1, \
                    \"300 MPa\"], \
                    [0.2, \"250 MPa\"]]\n[rate.malvern]\nk = \"K 1/s\"\n";

#[test]
fn a_fast_rate_law_gives_the_static_value_and_a_slow_one_more() {
    let folder = tempfile::tempdir().expect("a folder");
    let velocity = |k: &str, length: &str| {
        std::fs::write(folder.path().join("m.toml"), RATE.replace("K 1/s", &format!("{k} 1/s"))).expect("a file");
        let arguments = ["critical", "m.toml", "--rate", "--length", length, "-o", "v.csv"];
        let row = json(folder.path(), &arguments).remove(0);
        let (fixed, grid) = (number(&row["critical_velocity_m_s"]), &row["apparent"]["grid"]);
        assert!(row["apparent"]["definition"].as_str().is_some_and(|text| text.contains("2 L/c0")));
        let apparent = 0.5 * (number(&grid["holds_m_s"]) + number(&grid["breaks_m_s"]));
        let table = std::fs::read_to_string(folder.path().join("v.csv")).expect("a table");
        let [names, cells] = [0, 1].map(|line| table.lines().nth(line).expect("a line").split(',').collect::<Vec<_>>());
        let column = |name: &str| cells[names.iter().position(|own| *own == name).expect("a column")];
        let written: f64 = column("apparent_velocity_m_s").parse().expect("a number");
        assert!((written / apparent - 1.0).abs() < 1e-12 && column("adiabatic_velocity_m_s").is_empty(), "{table}");
        apparent / fixed
    };
    let (fast, slow) = (velocity("1e7", "1 m"), velocity("1e4", "1 m"));
    assert!((fast - 1.0).abs() < 0.02, "{fast}");
    assert!(slow > 1.02, "{slow}");
    assert!(velocity("1e4", "100 mm") > slow, "a shorter bar has less time");
}

/// The strain is evaluated before the wave from the far end unloads the cells; afterwards, the result would be 58.2 m/s although runs at 57.5 m/s
/// exceed the strain.
#[test]
fn the_apparent_critical_velocity_is_that_of_runs_before_the_wave_returns() {
    let folder = tempfile::tempdir().expect("a folder");
    let row = json(folder.path(), &["critical", "steel-s7-jc", "--rate", "--length", "200 mm"]).remove(0);
    let apparent = &row["apparent"];
    let [holds, breaks] = ["holds_m_s", "breaks_m_s"].map(|key| number(&apparent["grid"][key]));
    let limit = number(&apparent["strain_limit"]);
    // Largest value at any time before the wave returns to the end.
    let largest = |velocity: f64| {
        let text = format!(
            "[bar]\nlength = 0.2\narea = 1\nmaterial = \"steel-s7-jc\"\n[left]\nkind = \"velocity\"\nvalue = {}\n[right]\nkind = \
             \"free\"\n[effects]\nhardening = \"isotropic\"\nrate = \"material\"\n[solve]\nuntil = 1e-4\nmethod = \"fd\"\ncells = \
             400\ncfl = 1\n",
            -velocity
        );
        let scene = Scene::parse("steel.toml", &text, Path::new("."), &[]).unwrap_or_else(|e| panic!("{e}"));
        let mut bar = assemble::leapfrog(&scene, 400, 1.0);
        let mean = |_| {
            bar.advance_by(1);
            (0..4).map(|cell| bar.value(Quantity::Strain, cell)).sum::<f64>() / 4.0
        };
        (0..800).map(mean).fold(0.0, f64::max)
    };
    assert!(largest(holds) <= limit && largest(breaks) > limit, "{holds} {breaks}");
}

#[test]
fn a_repeat_that_rises_up_to_the_fracture_does_not_stretch_the_mean_curve() {
    let folder = tempfile::tempdir().expect("a folder");
    // Saturating hardening up to 14 % of plastic strain; then the stress decreases, or increases by the noise of a test.
    let material = |after: f64| {
        let stress = |p: f64| 430e6 - 150e6 * (-p / 0.035).exp();
        let row = |p: f64, s: f64| format!("[{}, {s}]", p + s / 70e9);
        let rows = (0..=28).map(|k| f64::from(k) * 0.005).map(|p| row(p, stress(p)));
        let table: Vec<String> = rows.chain([row(0.17, stress(0.14) + after)]).collect();
        format!("density = 2700\nmodulus = \"70 GPa\"\nbeyond = \"rupture\"\n[curve]\ntable = [{}]\n", table.join(", "))
    };
    for (name, after) in [("a", -1e6), ("b", 1e5), ("c", -1e6)] {
        std::fs::write(folder.path().join(format!("{name}.toml")), material(after)).expect("a file");
    }
    let row = &json(folder.path(), &["critical", "a.toml", "b.toml", "c.toml", "--repeats"])[0];
    let of_tests: Vec<f64> = (0..3).map(|k| number(&row["scatter"]["tests"][k]["critical_velocity_m_s"])).collect();
    let (low, high) = (of_tests[0].min(of_tests[1]), of_tests[0].max(of_tests[1]));
    // The mean of curves that are equal up to the largest stress is that of the two that decrease.
    let velocity = number(&row["critical_velocity_m_s"]);
    assert!((low * (1.0 - 1e-6)..=high).contains(&velocity), "{row:#}");
    assert!((number(&row["strain_at_max"]) / (0.14 + 427.3e6 / 70e9) - 1.0).abs() < 1e-3, "{row:#}");
}

#[test]
fn repeats_are_one_material_and_a_band_moves_the_curve() {
    let folder = tempfile::tempdir().expect("a folder");
    for (name, scale) in [("a", 0.95), ("b", 1.0), ("c", 1.05)] {
        let table = format!("[[0.001, {}], [0.1, {}], [0.2, {}]]", 200e6 * scale, 300e6 * scale, 250e6 * scale);
        let material = format!("density = 8000\nbeyond = \"rupture\"\n[curve]\ntable = {table}\n");
        std::fs::write(folder.path().join(format!("{name}.toml")), material).expect("a file");
    }
    let names = ["critical", "a.toml", "b.toml", "c.toml"];
    let each = json(folder.path(), &names);
    let row = &json(folder.path(), &[&names[..], &["--repeats"]].concat())[0];
    let mean = each.iter().map(|r| number(&r["critical_velocity_m_s"])).sum::<f64>() / 3.0;
    assert!((number(&row["scatter"]["mean_m_s"]) / mean - 1.0).abs() < 1e-12);
    assert!((number(&row["critical_velocity_m_s"]) / mean - 1.0).abs() < 5e-3, "{row:#}");
    let band = "density = 8000\nbeyond = \"rupture\"\n[curve]\ntable = [[0.001, 2e8], [0.1, 3e8], [0.2, 2.5e8]]\n[band]\nunit \
                = \"MPa\"\n\
                deviation = [[0.001, 8], [0.1, 12]]\n";
    std::fs::write(folder.path().join("d.toml"), band).expect("a file");
    let row = &json(folder.path(), &["critical", "d.toml"])[0];
    // The velocity at the elastic limit changes by 8 MPa/Z = 0.2 m/s, and the jump sqrt(d sigma d eps/rho) = 35.18 m/s behind it by 2.01 %: d sigma
    // of 100 MPa by 4 MPa, d eps of 0.099 by 4 MPa/E.
    assert!((number(&row["scatter"]["standard_deviation_m_s"]) / 0.907 - 1.0).abs() < 0.06, "{row:#}");
    assert_eq!(row["scatter"]["basis"], "deviation");
    // The flow stress changes by the same amount d at all plastic strains: d/Z.
    std::fs::write(folder.path().join("e.toml"), band.replace("12]", "8]")).expect("a file");
    let row = &json(folder.path(), &["critical", "e.toml"])[0];
    assert!((number(&row["scatter"]["standard_deviation_m_s"]) / 0.2 - 1.0).abs() < 0.06, "{row:#}");
    std::fs::write(folder.path().join("bad.toml"), band.replace("[0.1, 12]", "[0.001, 12]")).expect("a file");
    for (arguments, words) in [
        (&["critical", "bad.toml"][..], "band.deviation"),
        (&["critical", "a.toml", "--repeats"], "repeats need at least two materials"),
        (&["critical", "a.toml", "--rate"], "has no rate constants"),
        (&["critical", "a.toml", "--heat"], "lacks constants of [heat]"),
        (&["critical", "a.toml", "--length", "1 m"], "does not depend on the length"),
        (&["critical", "a.toml", "--bootstrap", "5"], "100 <= N"),
        (&["critical", "a.toml", "-o", "a.pdf"], ".csv"),
    ] {
        let output = barwave(folder.path(), arguments);
        let message = String::from_utf8_lossy(&output.stderr).into_owned();
        assert_eq!(output.status.code(), Some(2), "{message}");
        assert!(message.contains(words), "{words}: {message}");
    }
}
