//! Values that no bar has, and values that look like a wrong unit or sign, through the real binary.

use crate::common::binary;

use std::path::Path;

use binary::barwave;

const SCENE: &str = r#"
[bar]
length = "1 m"
area = "1 cm^2"
material = { name = "steel", density = 7800, modulus = "200 GPa", beyond = "extend", curve = { table = [[0.001, "200 MPa"], [0.1, "400 MPa"]] } }
[left]
kind = "velocity"
value = "3 m/s"
[right]
kind = "free"
[effects]
hardening = "isotropic"
[solve]
until = "50 us"
cells = 50
[record]
frames = 3
"#;
const LEFT: &str = "kind = \"velocity\"\nvalue = \"3 m/s\"";
const TABLE: &str = "[[0.001, \"200 MPa\"], [0.1, \"400 MPa\"]]";

fn with(from: &str, to: &str) -> String {
    assert!(SCENE.contains(from), "{from}");
    SCENE.replacen(from, to, 1)
}

/// Returns the exit code and all text of a command on a scene in this folder.
fn says(folder: &Path, command: &str, scene: &str) -> (Option<i32>, String) {
    std::fs::write(folder.join("s.toml"), scene).expect("written");
    let arguments: &[&str] = if command == "run" { &["run", "s.toml", "-o", "s.h5"] } else { &[command, "s.toml"] };
    let output = barwave(folder, arguments);
    let text = [output.stdout, output.stderr].map(|bytes| String::from_utf8_lossy(&bytes).into_owned()).concat();
    // Joined to one line, independent of the width of the terminal.
    (output.status.code(), text.split_whitespace().collect::<Vec<_>>().join(" "))
}

fn assert_refused(scene: &str, words: &[&str]) {
    let folder = tempfile::tempdir().expect("a folder");
    for command in ["check", "plan", "run"] {
        let (code, text) = says(folder.path(), command, scene);
        assert_eq!(code, Some(2), "{scene}\n{text}");
        assert!(text.contains("s.toml:") && text.contains("help: ") && text.contains("allowed: "), "{text}");
        for word in words {
            assert!(text.contains(word), "{command}: expected `{word}`: {text}");
        }
    }
    assert!(!folder.path().join("s.h5").exists());
}

/// Checks that every command notes it, and that the run is done nevertheless.
fn assert_noted(scene: &str, words: &[&str]) {
    let folder = tempfile::tempdir().expect("a folder");
    for command in ["check", "plan", "run"] {
        let (code, text) = says(folder.path(), command, scene);
        assert_eq!(code, Some(0), "{scene}\n{text}");
        for word in words {
            assert!(text.contains("note: ") && text.contains(word), "{command}: expected `{word}`: {text}");
        }
    }
}

/// Values that would give a NaN in the balance, a residual of 0.6 %, or an error without its cause are refused with the allowed range.
#[test]
fn what_no_bar_has_is_refused_with_its_range() {
    for (from, to, words) in [
        ("\"200 GPa\"", "1e200", ["beyond the range of a stress", "1e-9 <= modulus <= 1e18 Pa"]),
        ("\"200 GPa\"", "1e-200", ["beyond the range of a stress", "diamond one of 1.2e12 Pa"]),
        ("\"400 MPa\"", "1e200", ["|stress| <= 1e18 Pa", "beyond the range of a stress"]),
        ("7800", "1e-150", ["beyond the range of a density", "osmium"]),
        ("\"3 m/s\"", "1e150", ["beyond the range of a velocity", "nothing moves faster than light"]),
        ("\"3 m/s\"", "4e8", ["|value| <= 2.99792458e8 m/s", "nothing moves faster than light"]),
        ("\"1 cm^2\"", "1e-320", ["beyond the range of an area", "1e-24 <= area <= 1e12 m^2"]),
        ("\"1 m\"", "1e150", ["beyond the range of a length", "1e-12 <= length <= 1e9 m"]),
        ("\"50 us\"", "1e-100", ["beyond the range of a time", "1e-18 <= until <= 1e12 s"]),
        (
            "kind = \"velocity\"\nvalue = \"3 m/s\"",
            "kind = \"stress\"\nvalue = 1e200",
            ["|value| <= 1e18 Pa", "left.value"],
        ),
        (LEFT, "kind = \"striker\"\nmass = 1e-300\nvelocity = 3", ["beyond the range of a mass", "left.mass"]),
    ] {
        assert_refused(&with(from, to), &words);
    }
}

/// A row of a CSV file has the same range.
#[test]
fn a_curve_in_a_file_is_held_to_the_same_range() {
    let folder = tempfile::tempdir().expect("a folder");
    std::fs::write(folder.path().join("curve.csv"), "0.001,200e6\n0.1,1e200\n").expect("written");
    let scene = with(&format!("table = {TABLE}"), "csv = \"curve.csv\"").replace("modulus = \"200 GPa\", ", "");
    let (code, text) = says(folder.path(), "check", &scene);
    assert_eq!(code, Some(2), "{text}");
    assert!(text.contains("curve.csv:2") && text.contains("row 2: strain 1e-1 with stress 1e200 Pa"), "{text}");
}

#[test]
fn an_end_that_is_pushed_in_faster_than_the_wave_runs_away_is_refused() {
    let words = ["pushed into the bar", "elastic wave speed (5063.7 m/s)", "less than 5063.7 m/s"];
    assert_refused(&with("\"3 m/s\"", "6000"), &words);
    assert_refused(&with(LEFT, "kind = \"striker\"\nmass = 1\nvelocity = 6000"), &words);
    assert_refused(
        &with(LEFT, "kind = \"fixed\"").replace("length = \"1 m\"", "length = \"1 m\"\nvelocity = -6000"),
        &words,
    );
    assert_refused(&with("[right]\nkind = \"free\"", "[right]\nkind = \"velocity\"\nvalue = -6000"), &words);
    // Pulled at this velocity, the curve determines the result.
    let folder = tempfile::tempdir().expect("a folder");
    let (code, text) = says(folder.path(), "check", &with("\"3 m/s\"", "-6000"));
    assert_eq!(code, Some(0), "{text}");
}

/// A bar as soft as foam by a wrong unit of the curve is refused.
#[test]
fn a_curve_in_another_unit_than_its_modulus_is_refused_with_the_unit() {
    for (table, unit) in [
        ("[[0.001, 200], [0.1, 400]]", "MPa"),
        ("[[0.001, 0.2], [0.1, 0.4]]", "GPa"),
        ("[[0.001, 29], [0.1, 58]]", "ksi"),
        ("[[0.001, 29e3], [0.1, 58e3]]", "psi"),
        ("[[0.002, 200], [0.1, 400]]", "MPa"),
    ] {
        assert_refused(&with(TABLE, table), &["bar.material.curve.table", &format!("seem to be in {unit}, not in Pa")]);
    }
    // If the unit is stated, the modulus is more likely wrong.
    let table = "[[1e-3, 200e-3], [0.1, 400e-3]], unit = \"MPa\"";
    assert_refused(&with(TABLE, table), &["bar.material.curve.table", "help: check the modulus, and the unit"]);
}

#[test]
fn a_material_that_looks_wrong_is_noted() {
    assert_noted(
        &with("\"200 GPa\"", "\"1399 GPa\"")
            .replace("0.001, \"200 MPa\"", "0.001, \"1399 MPa\"")
            .replace("400 MPa", "1400 MPa"),
        &["the modulus of `steel` is 1399 GPa: stiffer than diamond (1220 GPa)"],
    );
    assert_noted(&with("7800", "78000"), &["denser than osmium"]);
    assert_noted(&with("\"200 MPa\"", "\"100 MPa\""), &["`steel` has no elastic part", "0.500 of the modulus"]);
}

#[test]
fn a_striker_that_moves_away_is_noted() {
    assert_noted(
        &with(LEFT, "kind = \"striker\"\nmass = 1\nvelocity = -3"),
        &["the bar and the striker at the left end move apart (at 0 m/s, striker at -3 m/s)"],
    );
    let ball = "kind = \"ball\"\nradius = 0.01\ndensity = 7800\nrigid = true\nbar-poisson = 0.3\nvelocity = 3";
    assert_noted(
        &with("[right]\nkind = \"free\"", &format!("[right]\n{ball}")),
        &["the bar and the ball at the right end move apart (at 0 m/s, ball at 3 m/s)"],
    );
}

/// A lever is struck by a ball with a velocity of its own; x has no meaning for a rotation.
#[test]
fn a_ball_that_leaves_a_lever_is_noted_with_its_own_velocity() {
    let ball =
        "kind = \"ball\"\narm = \"20 mm\"\nradius = \"5 mm\"\ndensity = 7800\nmodulus = \"200 GPa\"\npoisson = 0.3";
    let scene = "title = \"t\"\n[bar]\nmode = \"torsion\"\nlength = 0.5\ndiameter = \"30 mm\"\n\
                 material = { name = \"s\", loading = \"shear\", density = 7800, modulus = \"80 GPa\", beyond = \"extend\", \
                 curve = { table = [[0, 0], [0.5, \"40 GPa\"]] } }\n[left]\nkind = \"free\"\n[solve]\nuntil = \"100 us\"\n";
    let right = |velocity: &str| format!("{scene}[right]\n{ball}\nvelocity = {velocity}\n");
    assert_noted(
        &right("2"),
        &[
            "the lever and the ball at the right end move apart (at 0 m/s, ball at 2 m/s)",
            "positive in the same sense of rotation at both ends",
        ],
    );
    let folder = tempfile::tempdir().expect("a folder");
    let (code, text) = says(folder.path(), "check", &right("-2"));
    assert!(code == Some(0) && !text.contains("move apart"), "{text}");
    assert!(!says(folder.path(), "check", &right("2")).1.contains("+x"));
}

#[test]
fn a_bar_that_moves_away_from_what_it_shall_hit_is_noted() {
    let flies = |scene: String, velocity: &str| {
        scene.replace("length = \"1 m\"", &format!("length = \"1 m\"\nvelocity = {velocity}"))
    };
    let wall = with(LEFT, "kind = \"wall\"");
    assert_noted(
        &flies(wall.clone(), "5"),
        &["the bar and the wall at the left end move apart (at 5 m/s, wall at 0 m/s)"],
    );
    let folder = tempfile::tempdir().expect("a folder");
    let (code, text) = says(folder.path(), "check", &flies(wall, "-5"));
    assert!(code == Some(0) && !text.contains("move apart"), "{text}");
}

/// Metals have wave speeds of 1000 to 13000 m/s.
#[test]
fn a_wave_speed_of_no_solid_is_noted() {
    assert_noted(&with("7800", "7.8"), &["the elastic wave speed of `steel` is 160128 m/s", "the density, 7.8 kg/m^3"]);
    let megapascals = with("\"200 GPa\"", "200000").replace("\"200 MPa\"", "200").replace("\"400 MPa\"", "400");
    assert_noted(&megapascals.replace("3 m/s", "1 m/s"), &["is 5.0637 m/s", "the modulus, 2e5 Pa"]);
}

#[test]
fn a_history_in_microseconds_without_a_unit_is_noted() {
    let rows = with("value = \"3 m/s\"", "history = [[0, 0], [10, 3], [100, 3]]");
    assert_noted(&rows, &["the history at the left end has its first change at 10 s", "`time [us]`"]);
}

/// 50 Hz must not be read as 50 rad/s.
#[test]
fn a_frequency_is_no_angular_velocity() {
    let twisted =
        with("length = \"1 m\"\narea = \"1 cm^2\"", "mode = \"torsion\"\nlength = \"1 m\"\ndiameter = \"2 cm\"")
            .replace("name = \"steel\"", "name = \"steel\", loading = \"shear\"");
    let turning = |speed: &str| twisted.replace("\"3 m/s\"", speed);
    assert_refused(&turning("\"50 Hz\""), &["`50 Hz` is a frequency; as an angular velocity it is 314.159265 rad/s"]);
    assert_refused(&turning("\"1 kHz\""), &["6283.185307 rad/s"]);
    let folder = tempfile::tempdir().expect("a folder");
    for right in ["\"50 rad/s\"", "\"3000 rpm\""] {
        let (code, text) = says(folder.path(), "check", &turning(right));
        assert_eq!(code, Some(0), "{text}");
    }
}

#[test]
fn a_history_whose_first_column_is_not_a_time_is_refused() {
    let folder = tempfile::tempdir().expect("a folder");
    let scene = with("value = \"3 m/s\"", "csv = \"h.csv\"");
    let checked = |header: &str| {
        std::fs::write(folder.path().join("h.csv"), format!("{header}\n0,1\n1e-5,3\n")).expect("written");
        says(folder.path(), "check", &scene)
    };
    for (header, help) in [
        ("foo,bar", "help: name the columns"),
        ("velocity,time", "help: exchange the columns"),
        ("velocity [m/s],time [s]", "help: exchange the columns"),
    ] {
        let (code, text) = checked(header);
        assert_eq!(code, Some(2), "{text}");
        assert!(text.contains("h.csv:1") && text.contains("not a time") && text.contains(help), "{text}");
    }
    for header in ["time,velocity", "t (us),v", "Zeit;v", "x [us],y", "Time_s,v"] {
        let header = header.replace(';', ",");
        let (code, text) = checked(&header);
        assert_eq!(code, Some(0), "{header}: {text}");
    }
}

#[test]
fn a_row_of_three_entries_is_refused() {
    let folder = tempfile::tempdir().expect("a folder");
    let (code, text) = says(folder.path(), "check", &with("[0.1, \"400 MPa\"]", "[0.1, \"400 MPa\", 3]"));
    assert_eq!(code, Some(2), "{text}");
    assert!(text.contains("found a list of 3") && text.contains("help: "), "{text}");
}
