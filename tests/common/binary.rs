//! The program itself.

use std::path::Path;
use std::process::{Command, Output};

/// Runs it in a folder, with no library of materials but its own.
pub fn barwave(folder: &Path, arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_barwave"))
        .args(arguments)
        .current_dir(folder)
        .env_remove("BARWAVE_MATERIALS")
        .output()
        .expect("the program starts")
}

/// What it prints where it succeeds.
pub fn done(folder: &Path, arguments: &[&str]) -> String {
    let output = barwave(folder, arguments);
    assert!(output.status.success(), "{arguments:?}: {}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout).expect("text")
}

/// The JSON that it prints.
pub fn json(folder: &Path, arguments: &[&str]) -> serde_json::Value {
    serde_json::from_str(&done(folder, arguments)).expect("JSON")
}

/// Its message where it ends with an error.
pub fn failed(folder: &Path, arguments: &[&str], code: i32) -> String {
    let output = barwave(folder, arguments);
    let message = String::from_utf8(output.stderr).expect("text");
    assert_eq!(output.status.code(), Some(code), "{arguments:?}: {message}");
    message
}

/// Its message where the input is wrong: it says how to mend it.
pub fn refused(folder: &Path, arguments: &[&str]) -> String {
    let message = failed(folder, arguments, 2);
    assert!(message.contains("help: "), "{message}");
    message
}

/// The summary of a scene that runs to its end.
pub fn summary_of(scene: &str) -> serde_json::Value {
    let folder = tempfile::tempdir().expect("a folder");
    std::fs::write(folder.path().join("scene.toml"), scene).expect("a folder to write to");
    let run = barwave(folder.path(), &["run", "--json", "scene.toml"]);
    assert_eq!(run.status.code(), Some(0), "{}\n{scene}", String::from_utf8_lossy(&run.stderr));
    serde_json::from_slice(&run.stdout).expect("JSON")
}
