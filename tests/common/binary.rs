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
