//! Units of the pages of all runs.

use std::collections::BTreeSet;
use std::path::Path;

use barwave::units::{Dimension, System, scale_for};

use crate::common::binary;

/// Symbols of a system, as pages print them.
fn symbols(system: System) -> BTreeSet<String> {
    let powers = -15..16;
    let all = Dimension::ALL.iter().flat_map(|&dimension| {
        powers.clone().map(move |power| scale_for(10_f64.powi(power), dimension, system).symbol)
    });
    all.map(|symbol| symbol.replace('*', "\u{b7}").replace("^2", "\u{b2}").replace("^3", "\u{b3}")).collect()
}

/// The lines of a page without its scene.
fn lines(page: &str) -> Vec<String> {
    let (_, mut rest) = page.split_once("<main>").expect("a body");
    let mut text = String::new();
    while let Some((before, tag)) = rest.split_once('<') {
        text = text + before + "\n";
        let skipped = ["script", "pre"].iter().find(|name| tag.starts_with(*name)).map(|name| format!("</{name}>"));
        let end = skipped.as_deref().unwrap_or(">");
        rest = tag.split_once(end).map_or("", |(_, after)| after);
    }
    text.lines().map(str::to_owned).collect()
}

/// Units behind a number or in brackets.
fn units(line: &str) -> impl Iterator<Item = &str> {
    let is_number = |word: &str| word.trim_start_matches('(').replace('\u{2212}', "-").parse::<f64>().is_ok();
    let words: Vec<&str> = line.split(' ').collect();
    let shown = move |k: usize| words[k].starts_with('(') || (k > 0 && is_number(words[k - 1]));
    let all: Vec<&str> = line.split(' ').collect();
    all.into_iter()
        .enumerate()
        .filter(move |(k, _)| shown(*k))
        .map(|(_, word)| word.trim_matches(['(', ')', ',', ';', '.']))
}

/// Momenta and impulses stayed in N s in US reports, and areas of impacts were in in^2.
#[test]
fn pages_in_inch_pound_units_have_no_others() {
    let us = symbols(System::Us);
    let mut si: BTreeSet<String> = symbols(System::Si).difference(&us).cloned().collect();
    si.insert("rad/m".to_owned());
    assert!(
        ["N\u{b7}s", "N\u{b7}m\u{b7}s", "kJ/m\u{b2}", "MPa", "m"].iter().all(|symbol| si.contains(*symbol)),
        "{si:?}"
    );
    assert!(!si.contains("K") && !si.contains("s") && !si.contains(""));
    let folder = tempfile::tempdir().expect("a folder");
    let mut wrong = Vec::new();
    for scene in std::fs::read_dir(Path::new(env!("CARGO_MANIFEST_DIR")).join("runs")).expect("runs") {
        let path = scene.expect("a file").path();
        if path.extension().is_none_or(|ending| ending != "toml") {
            continue;
        }
        let scene = path.to_str().expect("a name");
        binary::done(folder.path(), &["run", scene, "-o", "a.h5", "--quiet"]);
        binary::done(folder.path(), &["report", "a.h5", "--units", "us", "-o", "a.html"]);
        let page = std::fs::read_to_string(folder.path().join("a.html")).expect("a page");
        let lines = lines(&page);
        assert!(lines.len() > 20, "{scene}");
        for line in lines {
            // A number with its unit, and no sentence.
            let is_value = line.split(' ').count() == 2;
            let found = units(&line).any(|unit| si.contains(unit) || (is_value && unit.contains('^')));
            if found {
                wrong.push(format!("{scene}: {line}"));
            }
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}
