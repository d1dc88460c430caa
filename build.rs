//! Notes the commit that the program is built from, for the provenance in result files. Without git, or outside its
//! own repository (a source archive), nothing is noted and the build goes on.

use std::path::Path;
use std::process::Command;

fn main() {
    for path in ["build.rs", "src", "Cargo.toml"] {
        println!("cargo::rerun-if-changed={path}");
    }
    // An archive unpacked inside somebody else's repository must not take that repository's commit for its own.
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

/// What git prints, without its line end; none where there is no git or no repository.
fn git(arguments: &[&str]) -> Option<String> {
    let output = Command::new("git").args(arguments).output().ok()?;
    let text = String::from_utf8(output.stdout).ok()?;
    output.status.success().then(|| text.trim().to_owned())
}
