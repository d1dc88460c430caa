//! Records the commit from which the program is built, for the provenance in result files. Without git, or outside the repository of barwave
//! (such as in a source archive), nothing is recorded and the build continues.

use std::path::Path;
use std::process::Command;

fn main() {
    for path in ["build.rs", "src", "Cargo.toml"] {
        println!("cargo::rerun-if-changed={path}");
    }
    // An archive unpacked inside another repository must not record the commit of that repository.
    if git(&["rev-parse", "--show-prefix"]).is_none_or(|prefix| !prefix.is_empty()) {
        return;
    }
    if let Some(log) = git(&["rev-parse", "--git-path", "logs/HEAD"])
        && Path::new(&log).exists()
    {
        println!("cargo::rerun-if-changed={log}");
    }
    if let Some(revision) = git(&["describe", "--always", "--abbrev=12", "--dirty=+", "--exclude=*"]) {
        println!("cargo::rustc-env=BARWAVE_GIT_REVISION={revision}");
    }
}

/// Returns the output of git without its line end, or `None` without git or outside a repository.
fn git(arguments: &[&str]) -> Option<String> {
    let output = Command::new("git").args(arguments).output().ok()?;
    let text = String::from_utf8(output.stdout).ok()?;
    output.status.success().then(|| text.trim().to_owned())
}
