//! Inputs found by fuzzing, through the entry points that the fuzz targets call; see docs/extending.md.

#[path = "../../fuzz/src/entries.rs"]
mod entries;

use std::fs;
use std::path::{Path, PathBuf};

/// Returns the files of a folder of the package, sorted; none if it does not exist.
fn files(folder: &str) -> Vec<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join(folder);
    let mut files: Vec<PathBuf> =
        fs::read_dir(folder).into_iter().flatten().map(|entry| entry.expect("an entry").path()).collect();
    files.retain(|path| path.is_file());
    files.sort();
    files
}

fn each(folders: &[&str], entry: impl Fn(&[u8])) {
    for path in folders.iter().flat_map(|folder| files(folder)) {
        println!("{}", path.display());
        entry(&fs::read(&path).expect("read"));
    }
}

#[test]
fn scenes_that_were_found_and_those_of_the_package() {
    each(&["fuzz/cases/scene", "runs", "tests/hard_cases", "tests/data/auto"], entries::scene);
}

#[test]
fn materials_that_were_found_and_those_of_the_package() {
    each(&["fuzz/cases/material", "materials"], entries::material);
}

#[test]
fn columns_that_were_found() {
    let folder = tempfile::tempdir().expect("a folder");
    each(&["fuzz/cases/csv", "fuzz/seeds/csv"], |bytes| entries::csv(bytes, folder.path()));
}

#[test]
fn result_files_that_were_found() {
    let folder = tempfile::tempdir().expect("a folder");
    each(&["fuzz/cases/result"], |bytes| entries::result(bytes, folder.path()));
}
