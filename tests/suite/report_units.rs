//! Units on the pages of all runs.

use std::collections::BTreeSet;
use std::fmt::Write as _;
use std::path::Path;

use barwave::units::{Dimension, System, scale_for};

use crate::common::binary;

/// Returns the symbols of a system as they are printed on pages.
fn symbols(system: System) -> BTreeSet<String> {
    let powers = -15..16;
    let all = Dimension::ALL.iter().flat_map(|&dimension| {
        powers.clone().map(move |power| scale_for(10_f64.powi(power), dimension, system).symbol)
    });
    all.map(|symbol| symbol.replace('*', "\u{b7}").replace("^2", "\u{b2}").replace("^3", "\u{b3}")).collect()
}

/// Returns the lines of a page without its scene.
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

/// Returns the units behind a number or in brackets.
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

/// All units on pages with US units are US units, including momenta, impulses, and areas of impacts.
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
            // A number with its unit, not a sentence.
            let is_value = line.split(' ').count() == 2;
            let found = units(&line).any(|unit| si.contains(unit) || (is_value && unit.contains('^')));
            if found {
                wrong.push(format!("{scene}: {line}"));
            }
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

/// Returns the numbers of a line of text, except those that are parts of words.
fn numbers(line: &str) -> Vec<f64> {
    line.split_whitespace().filter_map(|word| word.parse().ok()).collect()
}

#[test]
fn tables_of_materials_and_studies_have_the_units_asked_for() {
    const FOOT: f64 = 0.3048;
    const KSI: f64 = 6.894_757e6;
    let folder = tempfile::tempdir().expect("a folder");
    let text = |line: &str| binary::done(folder.path(), &line.split(' ').collect::<Vec<_>>());
    let near = |found: f64, wanted: f64, size: f64| assert!((found - wanted).abs() < size, "{found} for {wanted}");
    let row = |text: &str| numbers(text.lines().find(|line| line.starts_with("copper-annealed")).expect("its row"));

    let (si, us) = (text("critical copper-annealed"), text("critical copper-annealed --units us"));
    assert!(us.starts_with("material         v_c ft/s  v_y ft/s  strain  stress ksi"), "{us}");
    let (si, us) = (row(&si), row(&us));
    for (column, factor) in [FOOT, FOOT, 1.0, KSI / 1e6].into_iter().enumerate() {
        near(us[column] * factor, si[column], 0.4 * factor.max(0.5));
    }
    let (si, us) = (text("compare copper-annealed -o si.svg"), text("compare copper-annealed --units us -o us.svg"));
    assert!(us.contains("rho lb/in^3    E ksi  c0 ft/s"), "{us}");
    let (si, us) = (row(&si), row(&us));
    for (column, factor) in [27_679.9, KSI / 1e9, FOOT, FOOT, FOOT, FOOT, FOOT].into_iter().enumerate() {
        near(us[column] * factor / si[column], 1.0, 0.05);
    }
    let svg = std::fs::read_to_string(folder.path().join("us.svg")).expect("a figure");
    assert!(svg.contains("(ft/s)") && svg.contains("(ksi)") && !svg.contains("(MPa)") && !svg.contains("(m/s)"));
    assert!(binary::refused(folder.path(), &["compare", "a.h5", "b.h5", "--units", "us"]).contains("SI units"));

    let us = binary::done(
        folder.path(),
        &["study", "tension-impact", "copper-annealed", "--velocities", "320 ft/s", "--units", "us", "-o", "study"],
    );
    assert!(us.contains("energy ft*lbf  fracture at in") && us.contains("295.67 ft/s, from"), "{us}");
    let found = us.lines().find(|line| line.starts_with("320.00")).expect("its row");
    assert!(found.contains("at once"), "{us}");
    let svg = std::fs::read_to_string(folder.path().join("study/tension-impact.svg")).expect("a figure");
    assert!(svg.contains("(ft·lbf)") && svg.contains("(ft/s)") && !svg.contains("(m/s)"));
}

#[test]
fn inverted_curves_have_the_units_asked_for() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut table = String::from("x_mm,strain,time_us\n");
    for x in [50, 100, 200] {
        for (strain, speed) in [(0.01, 1000.0), (0.05, 500.0), (0.1, 300.0)] {
            // Writing to a String cannot fail.
            let _ = writeln!(table, "{x},{strain},{}", 1e3 * f64::from(x) / speed);
        }
    }
    std::fs::write(folder.path().join("t.csv"), table).expect("a file");
    let inverted = |units: &str| {
        let arguments =
            "invert arrivals t.csv --density 8960kg/m^3 --modulus 115GPa --time-error 0.2us --plot c.svg --units";
        let arguments: Vec<&str> = arguments.split(' ').chain([units]).collect();
        binary::done(folder.path(), &arguments)
    };
    let first = |text: &str| numbers(text.lines().find(|line| line.trim_start().starts_with("0.01")).expect("its row"));
    let (si, us) = (first(&inverted("si")), first(&inverted("us")));
    for (column, factor) in [(1, 0.3048), (4, 6.894_757), (7, 0.3048)] {
        assert!((us[column] * factor / si[column] - 1.0).abs() < 1e-2, "{us:?} for {si:?}");
    }
    let text = inverted("us");
    assert!(text.contains("0.323701 lb/in^3") && text.contains("c ft/s") && text.contains("stress ksi"), "{text}");
    let svg = std::fs::read_to_string(folder.path().join("c.svg")).expect("a figure");
    assert!(svg.contains("(ksi)") && svg.contains("wave speed (ft/s)") && !svg.contains("(m/s)"));
}
