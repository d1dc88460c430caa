//! Scenes and materials in ```` ```toml ```` blocks.
//!
//! A block that has `[solve]` is a scene, one that has a `density` at the top is a material. Any other block is a fragment: its
//! keys replace those of the scene that the mark `changes: runs/NAME.toml` names.

use std::fmt::Write as _;
use std::path::Path;
use std::process::Command;

use toml::{Table, Value};

use crate::page::{Block, Page, root};

/// Replaces the keys of `base` by those of `change`, table by table. An end, and a bar with segments, is replaced as a whole.
fn merge(base: &mut Table, change: Table) {
    for (key, value) in change {
        let whole = |old: &Table, new: &Table| {
            matches!(key.as_str(), "left" | "right") || new.contains_key("segment") != old.contains_key("segment")
        };
        match (base.get_mut(&key), value) {
            (Some(Value::Table(old)), Value::Table(new)) if !whole(old, &new) => merge(old, new),
            (_, value) => drop(base.insert(key, value)),
        }
    }
}

/// The scene or material to check.
fn whole(block: &str, base: Option<&str>) -> Result<String, String> {
    let table: Table = block.parse().map_err(|e: toml::de::Error| e.to_string())?;
    if ["solve", "density", "specimen", "spheres", "plate", "beam"].iter().any(|key| table.contains_key(*key))
        && base.is_none()
    {
        return Ok(block.to_owned());
    }
    let base = base.ok_or("a fragment needs <!-- changes: runs/NAME.toml -->")?;
    let text = std::fs::read_to_string(root().join(base)).map_err(|e| format!("{base}: {e}"))?;
    let mut scene: Table = text.parse().map_err(|e: toml::de::Error| e.to_string())?;
    merge(&mut scene, table);
    toml::to_string(&scene).map_err(|e| e.to_string())
}

/// Blocks of a page that `barwave check` refuses, and the number of blocks.
pub fn refused(page: &Page) -> (String, usize) {
    let folder = tempfile::tempdir().expect("a folder");
    let (mut wrong, mut count) = (String::new(), 0);
    let blocks = page.blocks();
    // Records that scenes of the page read.
    for block in blocks.iter().filter(|block| block.language == "csv") {
        if let Some(name) = block.marked("file") {
            std::fs::write(folder.path().join(name), block.text()).expect("a file");
        }
    }
    // A file that a command of the page reads is checked by that command.
    let console: String = blocks.iter().filter(|block| block.language == "console").map(Block::text).collect();
    let is_read = |block: &&Block| block.marked("file").is_some_and(|name| console.contains(&format!(" {name}")));
    for block in blocks.iter().filter(|block| block.language == "toml" && !is_read(block)) {
        count += 1;
        let place = format!("{}:{}", page.path.display(), block.first + 1);
        match whole(&block.text(), block.marked("changes")) {
            Err(error) => drop(writeln!(wrong, "{place}: {error}")),
            Ok(text) => {
                let file = folder.path().join("block.toml");
                std::fs::write(&file, text).expect("a file");
                wrong += &check(&file).map_or_else(String::new, |message| format!("{place}: {message}\n"));
            }
        }
    }
    (wrong, count)
}

fn check(file: &Path) -> Option<String> {
    let output = Command::new(env!("CARGO_BIN_EXE_barwave"))
        .arg("check")
        .arg(file)
        .env_remove("BARWAVE_MATERIALS")
        .output()
        .expect("the program starts");
    (!output.status.success()).then(|| String::from_utf8_lossy(&[output.stdout, output.stderr].concat()).into_owned())
}

/// A bar of 1 m with an area, struck at its left end.
const BAR: &str = "[bar]\nlength = 1\n";
const ROUND: &str = "diameter = 0.01\n";
const STRUCK: &str = "kind = \"velocity\"\nvalue = 5\n";
const MALVERN: &str = "rate = { model = \"malvern\", k = 1e5 }\n";

/// Rows of the table of effects and methods: the first cell, and bar, left end and effects of a scene.
fn rows() -> Vec<(&'static str, String, &'static str, String)> {
    let material = |extra: &str, lines: &str| {
        format!(
            "{{ name = \"a\", density = 7800, modulus = \"200 GPa\", beyond = \"extend\", {extra} curve = {{ table = [[0.001, \"200 MPa\"], {lines}] }} }}\n"
        )
    };
    let heat = "poisson = 0.3, heat = { specific-heat = 450, reference-temperature = 293, melting-temperature = 1800, m = 1 },";
    let steel = material(heat, "[0.02, \"400 MPa\"], [0.2, \"600 MPa\"]");
    let bar = |section: &str| format!("{BAR}{section}material = {steel}");
    let two = format!(
        "[[bar.segment]]\nlength = 1\n{ROUND}velocity = 5\njoint = \"contact\"\nmaterial = {steel}[[bar.segment]]\nlength = 1\n{ROUND}material = {steel}"
    );
    let ball: &str =
        "kind = \"ball\"\ndiameter = 0.01\nvelocity = 5\ndensity = 7800\nmodulus = \"200 GPa\"\npoisson = 0.3\n";
    let shear = material("loading = \"shear\",", "[0.2, \"600 MPa\"]");
    let plain = || bar(ROUND);
    let on = |effect: &str| format!("{effect}\n");
    vec![
        ("`hardening` isotropic, mixed", plain(), STRUCK, on("hardening = { mixed = 0.3 }")),
        ("`hardening` kinematic", plain(), STRUCK, on("hardening = \"kinematic\"")),
        (
            "`hardening` Armstrong-Frederick",
            plain(),
            STRUCK,
            on("hardening = { armstrong-frederick = { C = 1e9, gamma = 100 } }"),
        ),
        ("`rate`", plain(), STRUCK, String::new()),
        ("`heat`, isotropic", plain(), STRUCK, on("heat = {}")),
        (
            "`heat` with `rate`, kinematic or mixed hardening",
            plain(),
            STRUCK,
            on("heat = {}\nhardening = { mixed = 0.3 }"),
        ),
        ("`rupture`", plain(), STRUCK, on("hardening = \"isotropic\"\nrupture = { spall = \"1 GPa\" }")),
        (
            "`heat` with an initial temperature or plastic strain",
            bar("diameter = 0.01\ntemperature = 400\n"),
            STRUCK,
            on("heat = {}\nhardening = \"isotropic\""),
        ),
        ("`damping`", plain(), STRUCK, on("damping = { internal = 1e4 }")),
        ("`lateral-inertia`", plain(), STRUCK, on("lateral-inertia = true")),
        (
            "`hardening` mixed, along a curve that stiffens or drops",
            format!("{BAR}{ROUND}material = {}", material("", "[0.02, \"210 MPa\"], [0.03, \"600 MPa\"]")),
            STRUCK,
            on("hardening = { mixed = 0.3 }"),
        ),
        ("contact joints", two, "kind = \"free\"\n", on("hardening = \"isotropic\"")),
        ("tapers", bar("diameter = [[0, 0.02], [1, 0.01]]\n"), STRUCK, on("hardening = \"isotropic\"")),
        ("end `ball`", plain(), ball, on("hardening = \"isotropic\"")),
        (
            "torsion",
            format!("{BAR}{ROUND}mode = \"torsion\"\nmaterial = {shear}"),
            STRUCK,
            on("hardening = \"isotropic\""),
        ),
    ]
}

/// Cells of the table of effects and methods that `barwave check` contradicts.
pub fn wrong_combinations(page: &Page) -> String {
    let methods = ["method = \"fd\"", "method = \"fd\"\nscheme = \"muscl\"", "method = \"moc\"", "method = \"moc\""];
    let folder = tempfile::tempdir().expect("a folder");
    let mut wrong = String::new();
    let lines = page.text.lines().skip_while(|line| !line.starts_with("| | leapfrog")).skip(2);
    let titles = lines.take_while(|line| !line.is_empty()).filter_map(|line| line.split(" | ").next());
    // Effects are chosen, and checkpoints written, as a scene runs.
    let unchecked = |title: &str| title.starts_with("| `effects = ") || title == "| checkpoints";
    for title in titles.filter(|title| !unchecked(title)) {
        if !rows().iter().any(|row| title == format!("| {}", row.0)) {
            let _ = writeln!(wrong, "{title} is not checked");
        }
    }
    for (name, bar, left, effects) in rows() {
        let Some(row) = page.text.lines().find(|line| line.starts_with(&format!("| {name} |"))) else {
            let _ = writeln!(wrong, "no row {name}");
            continue;
        };
        let cells: Vec<&str> = row.trim_matches('|').split('|').map(str::trim).skip(1).collect();
        for (k, (method, cell)) in methods.iter().zip(cells).enumerate().filter(|(_, (_, cell))| !cell.is_empty()) {
            let rate = if k == 3 || name == "`rate`" { MALVERN } else { "" };
            let scene = format!(
                "{bar}[left]\n{left}[right]\nkind = \"free\"\n[effects]\n{effects}{rate}[solve]\nuntil = 1e-4\n{method}\n"
            );
            let file = folder.path().join("block.toml");
            std::fs::write(&file, scene).expect("a file");
            let refused = check(&file);
            // "curves with one hardening line": the curve of the scene has two.
            if refused.is_some() != (cell == "no" || cell.starts_with("curves with one")) {
                let _ = writeln!(wrong, "{name}, {method}: {cell}, but {refused:?}");
            }
        }
    }
    wrong
}
