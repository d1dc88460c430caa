//! `barwave compare` of result files, and of materials by pattern.

use crate::common::binary;

use binary::{done, refused};
use serde_json::Value;
use tempfile::TempDir;

const BAR: &str = r#"
[bar]
length = 1
material = { name = "elastic", density = 8000, modulus = 200e9, beyond = "extend", curve = { table = [[0.001, 200e6]] } }
[left]
kind = "stress"
value = -100e6
[right]
kind = "free"
[solve]
until = "160 us"
method = "moc"
[record]
frames = 17
cells = 100
gauges = { middle = 0.5 }
"#;

/// Returns a folder with the result of the scene, and results with changed keys.
fn results(changes: &[(&str, &[&str])]) -> TempDir {
    let folder = tempfile::tempdir().expect("a folder");
    std::fs::write(folder.path().join("scene.toml"), BAR).expect("a file");
    done(folder.path(), &["run", "scene.toml", "-o", "a.h5", "--quiet"]);
    for (name, sets) in changes {
        let mut arguments = vec!["run", "scene.toml", "-o", name, "--quiet"];
        sets.iter().for_each(|set| arguments.extend(["--set", set]));
        done(folder.path(), &arguments);
    }
    folder
}

fn norm(difference: &Value, name: &str, kind: &str) -> f64 {
    let mut all = difference["fields"]
        .as_array()
        .expect("fields")
        .iter()
        .chain(difference["histories"].as_array().expect("histories"));
    let found = all.find(|d| d["field"] == name || d["name"] == name).unwrap_or_else(|| panic!("{name}"));
    found[kind]["relative"].as_f64().unwrap_or(0.0)
}

#[test]
fn a_result_does_not_differ_from_itself_and_differs_by_its_load() {
    let folder = results(&[("same.h5", &[]), ("more.h5", &["left.value=-110e6"])]);
    let path = folder.path();
    let json: Value =
        serde_json::from_str(&done(path, &["compare", "a.h5", "same.h5", "more.h5", "--json"])).expect("JSON");
    for (difference, expected) in [(&json[0], 0.0), (&json[1], 0.1)] {
        for name in ["stress", "strain", "velocity", "middle", "left end"] {
            for kind in ["l1", "l2", "max"] {
                let found = norm(difference, name, kind);
                assert!((found - expected).abs() < 1e-9, "{name} {kind}: {found}");
            }
        }
    }
}

#[test]
fn other_grids_and_times_are_interpolated_on_the_common_part() {
    let folder = results(&[(
        "grid.h5",
        &["solve.method=fd", "solve.cells=400", "record.cells=40", "record.frames=33", "solve.until=\"120 us\""],
    )]);
    let path = folder.path();
    let text = done(path, &["compare", "a.h5", "grid.h5", "--plot", "c.svg"]);
    assert!(text.contains("only the common time is compared") && text.contains("wrote c.svg"), "{text}");
    let svg = std::fs::read_to_string(path.join("c.svg")).expect("a figure");
    assert!(
        svg.contains("stress at the left end") && !svg.contains("stress at the right end"),
        "the right end is free"
    );
    done(path, &["compare", "a.h5", "grid.h5", "-o", "c.csv"]);
    let table = std::fs::read_to_string(path.join("c.csv")).expect("a table");
    assert!(table.starts_with("file,what,unit,l1,") && table.contains("stress of left end"), "{table}");
    let json: Value = serde_json::from_str(&done(path, &["compare", "a.h5", "grid.h5", "--json"])).expect("JSON");
    // A front between two samples, 1 cm and 2.5 cm apart, in a bar of which half is stressed on average.
    assert!(norm(&json[0], "stress", "l1") < 0.06, "{json}");
    assert!(norm(&json[0], "middle", "l1") < 0.02, "{json}");
    assert!(json[0]["time_s"][1].as_f64().expect("a time") < 1.21e-4);
    let place = &json[0]["fields"][0]["largest"];
    // The largest difference is at the front, at c0 t = 5000 t.
    let front = 5000.0 * place["time_s"].as_f64().expect("a time");
    assert!((place["x_m"].as_f64().expect("a place") - front).abs() < 0.04, "{place}");
}

/// Frames of a result with other frame times are interpolated, and the note says so; the figure shows what is compared.
#[test]
fn frames_at_other_times_are_noted() {
    let folder = results(&[("fewer.h5", &["record.frames=5"]), ("same.h5", &[])]);
    let notes = |other: &str| {
        let all: Value =
            serde_json::from_str(&done(folder.path(), &["compare", "a.h5", other, "--json"])).expect("JSON");
        all[0]["notes"].to_string()
    };
    assert!(notes("fewer.h5").contains("the frames are at other times"), "{}", notes("fewer.h5"));
    assert!(!notes("same.h5").contains("times"), "{}", notes("same.h5"));
}

/// The note on a result with a single frame states that only this time is compared.
#[test]
fn a_single_frame_is_compared_at_its_time() {
    let folder = results(&[("b.h5", &["record.frames=1"])]);
    let text = done(folder.path(), &["compare", "a.h5", "b.h5"]);
    assert!(text.contains("only the common time is compared, also of gauges and ends"), "{text}");
}

#[test]
fn wrong_comparisons_are_refused() {
    let folder = results(&[]);
    let path = folder.path();
    assert!(refused(path, &["compare", "a.h5"]).contains("at least 2 result files"));
    assert!(refused(path, &["compare", "a.h5", "mild-steel"]).contains("1 of 2 names"));
    assert!(refused(path, &["compare", "a.h5", "b.h5"]).contains("no such file"));
    assert!(refused(path, &["compare", "a.h5", "a.h5", "--field", "temperature"]).contains("temperature"));
    let tube = concat!(env!("CARGO_MANIFEST_DIR"), "/runs/torsion-tube.toml");
    done(path, &["run", tube, "-o", "tube.h5", "--quiet"]);
    let message = refused(path, &["compare", "tube.h5", "a.h5"]);
    assert!(
        message.contains("tube.h5 is a bar in torsion") && message.contains("a.h5 is a bar loaded along"),
        "{message}"
    );
    assert!(refused(path, &["compare", "unobtainium*"]).contains("no material matches"));
}

#[test]
fn materials_are_found_by_pattern() {
    let folder = tempfile::tempdir().expect("a folder");
    let names = |arguments: &[&str]| -> Vec<String> {
        let json: Value = serde_json::from_str(&done(folder.path(), arguments)).expect("JSON");
        let name = |m: &Value| m["critical"]["material"].as_str().expect("a name").to_owned();
        json.as_array().expect("a list").iter().map(name).collect()
    };
    let steels = names(&["compare", "steel*", "steel-4340-jc", "--json"]);
    assert!(steels.len() >= 4 && steels.iter().all(|name| name.starts_with("steel")), "{steels:?}");
    assert_eq!(steels.iter().filter(|name| *name == "steel-4340-jc").count(), 1);
    let all = names(&["compare", "--all", "--json"]);
    assert!(all.len() >= 18);
    done(folder.path(), &["compare", "--all", "-o", "all.svg"]);
    let svg = std::fs::read_to_string(folder.path().join("all.svg")).expect("a figure");
    // Every material is named beside its bar, and its number is at the ends of its lines.
    for name in all {
        assert!(svg.contains(&format!(">{name}</text>")), "{name}");
    }
}

#[test]
fn bars_start_at_zero_and_materials_have_no_fields() {
    // 100 samples on 23.47 mm: the first cell centre minus half the spacing is 7e-18 m.
    let folder = results(&[("short.h5", &["bar.length=0.02347", "record.gauges.middle=0.01"])]);
    let text = done(folder.path(), &["compare", "short.h5", "short.h5"]);
    assert!(text.contains("samples from 0 m to 23.47 mm"), "{text}");
    let message = refused(folder.path(), &["compare", "copper-annealed", "mild-steel", "--field", "strain"]);
    assert!(message.contains("--field") && message.contains("result files"), "{message}");
}

/// The cells of segments of different materials are unequal: means weight each sample with the length of its cell, and the bar ends at the outer
/// bounds of its cells.
#[test]
fn means_over_unequal_cells_are_means_over_the_length() {
    // The wave speeds are 316 and 6325 m/s: most of the cells lie in the first tenth of the bar.
    let material = |name: &str, density: f64, modulus: f64| {
        format!(
            "{{ name = \"{name}\", density = {density:?}, modulus = {modulus:?}, beyond = \"extend\", \
             curve = {{ table = [[0.01, {:?}]] }} }}",
            0.01 * modulus
        )
    };
    let scene = format!(
        "[[bar.segment]]\nlength = 0.1\nmaterial = {}\n[[bar.segment]]\nlength = 0.9\nmaterial = {}\n\
         [left]\nkind = \"stress\"\nvalue = -1e6\n[right]\nkind = \"free\"\n\
         [solve]\nuntil = \"100 us\"\nmethod = \"fd\"\ncells = 100\n[record]\nframes = 1\n",
        material("slow", 10000.0, 1e9),
        material("fast", 2500.0, 100e9),
    );
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path();
    std::fs::write(path.join("scene.toml"), scene).expect("a file");
    for (name, set) in [("a.h5", "left.value=-1e6"), ("more.h5", "left.value=-1.1e6"), ("fine.h5", "solve.cells=300")] {
        done(path, &["run", "scene.toml", "-o", name, "--quiet", "--set", set]);
    }
    let json: Value =
        serde_json::from_str(&done(path, &["compare", "a.h5", "more.h5", "fine.h5", "--json"])).expect("JSON");
    for difference in json.as_array().expect("a list") {
        assert_eq!(difference["x_m"], serde_json::json!([0.0, 1.0]));
        assert!(difference["notes"].as_array().expect("notes").is_empty(), "{difference}");
    }
    // Of 1 m, the wave of 1 MPa has reached c t = 31.6 mm: its mean is 31.6 kPa.
    let stress = json[0]["fields"].as_array().expect("fields").iter().find(|f| f["field"] == "stress").expect("stress");
    let expected = 0.1e6 * 1e5_f64.sqrt() * 100e-6;
    let mean = stress["l1"]["value"].as_f64().expect("a norm");
    assert!((mean / expected - 1.0).abs() < 0.02, "{mean} against {expected}");
}
