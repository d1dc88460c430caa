//! The hard cases with every method through the program: every check passes, and the page of the documentation shows the results.

use crate::common::binary;

use std::path::Path;

use barwave::study::hard_cases::CASES;
use binary::barwave;

/// `UPDATE_DOCS=1 cargo test --release --test suite hard_cases::` rewrites the page.
#[test]
fn every_method_passes_the_checks_or_says_why_not() {
    let folder = tempfile::tempdir().expect("a folder");
    let output = barwave(folder.path(), &["stability", "-o", "hard-cases.md"]);
    let text = String::from_utf8_lossy(&output.stdout);
    assert_eq!(output.status.code(), Some(0), "{text}{}", String::from_utf8_lossy(&output.stderr));
    let page = std::fs::read_to_string(folder.path().join("hard-cases.md")).expect("a page");
    let kept = Path::new(env!("CARGO_MANIFEST_DIR")).join("docs/hard-cases.md");
    if std::env::var_os("UPDATE_DOCS").is_some() {
        std::fs::write(&kept, &page).expect("a page");
    }
    assert_eq!(page, std::fs::read_to_string(&kept).expect("a page"), "docs/hard-cases.md is not up to date");
}

/// Every scene in the folder is a hard case with an explanation.
#[test]
fn every_scene_is_a_case() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/hard_cases");
    let mut names: Vec<String> = std::fs::read_dir(folder)
        .expect("a folder")
        .map(|entry| entry.expect("an entry").path())
        .map(|path| path.file_stem().expect("a name").to_string_lossy().into_owned())
        .collect();
    names.sort();
    assert_eq!(names, CASES.iter().map(|case| case.name.to_owned()).collect::<Vec<_>>());
    assert!(CASES.iter().all(|case| case.explanation().len() > 30));
}

#[test]
fn cases_are_shown_by_name() {
    let folder = tempfile::tempdir().expect("a folder");
    let unknown = barwave(folder.path(), &["stability", "21"]);
    assert_eq!(unknown.status.code(), Some(2), "{unknown:?}");
    let shown = barwave(folder.path(), &["stability", "--show", "11-grazing"]);
    let text = String::from_utf8_lossy(&shown.stdout).into_owned();
    assert!(text.contains("joint = \"contact\""), "{text}");
}
