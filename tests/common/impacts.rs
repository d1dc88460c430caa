//! Runs impact scenes of `runs/` with the program.

use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use barwave::impact::{Beam, Elastic, Face, Foundation, Plate, Section, Solid};
use barwave::record::store::{ResultFile, StoredImpact};
use serde_json::Value;

/// Elastic constants of steel.
pub const STEEL: Elastic = Elastic { modulus: 207e9, poisson: 0.3, density: 7850.0, yield_stress: None };

/// Returns a steel ball with a radius of 5 mm and this velocity, m/s.
pub fn ball(velocity: f64) -> Solid {
    Solid { radius: 0.005, mass: 0.0041, velocity, elastic: STEEL }
}

/// Returns a steel plate struck by the ball at 1 m/s.
pub fn plate() -> Plate {
    Plate { thickness: 0.01, elastic: STEEL, striker: ball(1.0), tolerance: 1e-6, until: None }
}

/// Returns a steel beam struck by the ball in the middle at 0.01 m/s.
pub fn beam() -> Beam {
    Beam {
        length: 0.15,
        section: Section { area: 1e-4, inertia: 8e-10, depth: 0.01, face: Face::Flat { width: 0.01 } },
        elastic: STEEL,
        foundation: Foundation::default(),
        striker: ball(0.01),
        at: 0.075,
        gauges: Vec::new(),
        shapes: 0,
        until: None,
        tolerance: 1e-3,
        modes: None,
    }
}

/// Returns the path of a scene in `runs/`.
pub fn scene(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("runs").join(name)
}

/// Runs a command of the program on a scene in `runs/`.
pub fn barwave(folder: &Path, command: &str, name: &str, sets: &[&str], more: &[&str]) -> Output {
    let mut program = Command::new(env!("CARGO_BIN_EXE_barwave"));
    program.current_dir(folder).arg(command).arg(scene(name)).args(more);
    for set in sets {
        program.arg("--set").arg(set);
    }
    program.output().expect("barwave starts")
}

/// Runs a scene and returns its summary.
pub fn run(name: &str, sets: &[&str]) -> Value {
    recorded(name, sets).0
}

/// Runs a scene and returns its summary and the contents of its result file.
pub fn recorded(name: &str, sets: &[&str]) -> (Value, StoredImpact) {
    let folder = tempfile::tempdir().expect("a folder");
    let output = barwave(folder.path(), "run", name, sets, &["-o", "r.h5", "--json"]);
    assert_eq!(output.status.code(), Some(0), "{name} {sets:?}: {}", String::from_utf8_lossy(&output.stderr));
    let file = ResultFile::open(&folder.path().join("r.h5")).expect("a result file");
    let impact = file.impact().expect("it can be read").expect("an impact");
    (serde_json::from_slice(&output.stdout).expect("one JSON value"), impact)
}

/// Returns a number of a summary, by its JSON pointer or its key.
#[track_caller]
pub fn number(summary: &Value, key: &str) -> f64 {
    let value = if key.starts_with('/') { summary.pointer(key) } else { summary.get(key) };
    value.and_then(Value::as_f64).unwrap_or_else(|| panic!("no {key} in {summary}"))
}

#[track_caller]
pub fn within(summary: &Value, key: &str, expected: f64, most: f64) {
    let value = number(summary, key);
    assert!((value - expected).abs() <= most, "{key}: {value}, expected {expected} within {most}");
}

/// Checks that a number agrees with `expected` to the six digits that are printed.
#[track_caller]
pub fn to_six_digits(summary: &Value, key: &str, expected: f64) {
    within(summary, key, expected, 5.1e-6 * expected.abs());
}
