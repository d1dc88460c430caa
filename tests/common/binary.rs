//! Runs the compiled program and checks how it ends.

use std::path::Path;
use std::process::{Command, Output};

/// Runs the program in a folder, without material folders of the user.
pub fn barwave(folder: &Path, arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_barwave"))
        .args(arguments)
        .current_dir(folder)
        .env_remove("BARWAVE_MATERIALS")
        .output()
        .expect("the program starts")
}

/// Runs the program, which must succeed, and returns its standard output.
pub fn done(folder: &Path, arguments: &[&str]) -> String {
    let output = barwave(folder, arguments);
    assert!(output.status.success(), "{arguments:?}: {}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout).expect("text")
}

/// Runs the program, which must succeed, and returns the JSON that it prints.
pub fn json(folder: &Path, arguments: &[&str]) -> serde_json::Value {
    serde_json::from_str(&done(folder, arguments)).expect("JSON")
}

/// Runs the program, which must end with the exit code `code`, and returns its message.
pub fn failed(folder: &Path, arguments: &[&str], code: i32) -> String {
    let output = barwave(folder, arguments);
    let message = String::from_utf8(output.stderr).expect("text");
    assert_eq!(output.status.code(), Some(code), "{arguments:?}: {message}");
    message
}

/// Runs the program, which must refuse its input, and returns the message, which must contain help.
pub fn refused(folder: &Path, arguments: &[&str]) -> String {
    let message = failed(folder, arguments, 2);
    assert!(message.contains("help: "), "{message}");
    message
}

/// Runs a scene, which must end without an error, and returns its summary.
pub fn summary_of(scene: &str) -> serde_json::Value {
    let folder = tempfile::tempdir().expect("a folder");
    std::fs::write(folder.path().join("scene.toml"), scene).expect("a folder to write to");
    let run = barwave(folder.path(), &["run", "--json", "scene.toml"]);
    assert_eq!(run.status.code(), Some(0), "{}\n{scene}", String::from_utf8_lossy(&run.stderr));
    serde_json::from_slice(&run.stdout).expect("JSON")
}
