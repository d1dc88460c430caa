//! What the README says is so: its error figures, its commands, its example scene.

use std::path::{Path, PathBuf};
use std::process::{Command, Output};

const README: &str = include_str!("../README.md");

fn root() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR"))
}

fn barwave(arguments: &[&str]) -> Output {
    let output = Command::new(env!("CARGO_BIN_EXE_barwave")).current_dir(root()).args(arguments).output();
    output.expect("the program starts")
}

/// The error figure of a run.
fn error_of(scene: &str, cells: &str, folder: &Path) -> f64 {
    let result = folder.join("result.h5");
    let cells = format!("solve.cells={cells}");
    let output = barwave(&["run", scene, "--json", "--set", &cells, "-o", &result.to_string_lossy()]);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let summary: serde_json::Value = serde_json::from_slice(&output.stdout).expect("one JSON object");
    summary["error"]["value"].as_f64().expect("a scene with an exact solution")
}

/// The cells of the table rows that start with the given text.
fn rows(start: &str) -> impl Iterator<Item = Vec<&str>> {
    let lines = README.lines().filter(move |line| line.starts_with(start));
    lines.map(|line| line.trim_matches('|').split('|').map(str::trim).collect())
}

#[test]
fn errors_are_those_of_the_table() {
    let folder = tempfile::tempdir().expect("a folder for results");
    let mut compared = 0;
    for row in rows("| `runs/") {
        let scene = row[0].trim_matches('`');
        for (cells, printed) in [("1000", row[1]), ("10000", row[2])] {
            let printed: f64 = printed.parse().expect("a number");
            let error = error_of(scene, cells, folder.path());
            if printed < 1e-12 {
                // Round-off: its digits belong to the processor.
                assert!(error < 1e-12, "{scene}, {cells} cells: {error:e}");
            } else {
                // The README prints two digits: rounding alone moves 0.0011 by up to 4.5 %.
                assert!((error / printed - 1.0).abs() < 0.05, "{scene}, {cells} cells: {error:e}, not {printed:e}");
            }
            compared += 1;
        }
    }
    assert_eq!(compared, 6);
}

#[test]
fn the_table_of_commands_is_complete() {
    let help = String::from_utf8(barwave(&["--help"]).stdout).expect("text");
    let names = help.lines().skip_while(|line| *line != "Commands:").skip(1).take_while(|line| !line.is_empty());
    let table: Vec<&str> = README.lines().filter(|line| line.starts_with("| `barwave ")).collect();
    for name in names.filter_map(|line| line.split_whitespace().next()).filter(|name| *name != "help") {
        let named = |line: &&str| {
            let first = line.split('|').nth(1).unwrap_or_default();
            first.split(|c: char| !c.is_alphanumeric()).any(|word| word == name)
        };
        assert!(table.iter().any(named), "`{name}` is missing from the README's table");
    }
}

#[test]
fn the_example_scene_is_the_file() {
    let file = std::fs::read_to_string(root().join("runs/copper-below-critical.toml")).expect("the scene");
    let wanted: Vec<&str> = file.lines().filter(|line| !line.starts_with('#')).collect();
    let block = README.split("```toml\n").nth(1).and_then(|rest| rest.split("```").next()).expect("a scene");
    let shown: Vec<&str> = block.lines().filter(|line| !line.starts_with('#')).collect();
    let text = |lines: &[&str]| lines.join("\n").replace("\n\n\n", "\n\n").trim().to_owned();
    assert_eq!(text(&shown), text(&wanted));
}

/// Lines of a run's text that differ from machine to machine, or stand for more.
fn varies(line: &str) -> bool {
    ["  time ", "  ledger ", "  (more "].iter().any(|start| line.starts_with(start))
}

/// Every output of `barwave run` in the README is what the program prints, but for times and rounding.
#[test]
fn outputs_are_what_the_program_prints() {
    let folder = tempfile::tempdir().expect("a folder");
    std::fs::create_dir(folder.path().join("runs")).expect("a folder");
    let mut seen = 0;
    for block in README.split("```console\n").skip(1) {
        let mut shown = block.split("```").next().unwrap_or_default().lines();
        let Some(command) = shown.next().and_then(|line| line.strip_prefix("$ barwave run ")) else { continue };
        std::fs::copy(root().join(command), folder.path().join(command)).expect("the scene");
        let output =
            Command::new(env!("CARGO_BIN_EXE_barwave")).current_dir(folder.path()).args(["run", command]).output();
        let printed = String::from_utf8(output.expect("the program starts").stdout).expect("text");
        for line in shown.filter(|line| !varies(line)) {
            assert!(printed.lines().any(|printed| printed == line), "{command}: {line}\nis not in\n{printed}");
        }
        seen += 1;
    }
    assert!(seen >= 2, "{seen} outputs");
}
