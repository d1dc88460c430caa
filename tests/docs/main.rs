//! Everything that README.md and the pages in docs/ show: commands and their output, scenes, links, tables, generated pages.
//!
//! `UPDATE_DOCS=1 cargo test --release --test docs` rewrites generated pages and shown outputs. The Python blocks are run by
//! `tests/python/test_docs.py`.

mod console;
#[path = "../../examples/copper_bar.rs"]
mod example;
mod links;
mod page;
mod reference;
mod scenes;
mod shell;

use std::fmt::Write as _;
use std::path::Path;

use barwave::material::library;
use page::{Page, pages, read, root, update};
use rayon::prelude::*;
use reference::{Schema, Section, barwave, command_pages, commands};

fn readme() -> Page {
    let path = Path::new("README.md");
    Page { path: path.to_owned(), text: read(path) }
}

#[test]
fn commands_print_what_the_pages_show() {
    let checked: Vec<(String, usize)> = pages().par_iter().map(console::check).collect();
    let wrong: String = checked.iter().map(|(wrong, _)| wrong.as_str()).collect();
    assert!(wrong.is_empty() || update(), "\n{wrong}");
    assert!(checked.iter().map(|(_, count)| count).sum::<usize>() > 20);
}

#[test]
fn shell_commands_run_or_name_what_exists() {
    let checked: Vec<(String, usize)> = pages().par_iter().map(shell::wrong).collect();
    let wrong: String = checked.iter().map(|(wrong, _)| wrong.as_str()).collect();
    assert!(wrong.is_empty(), "\n{wrong}");
    assert!(checked.iter().map(|(_, count)| count).sum::<usize>() > 10);
}

#[test]
fn scenes_pass_the_check() {
    let checked: Vec<(String, usize)> = pages().par_iter().map(scenes::refused).collect();
    let wrong: String = checked.iter().map(|(wrong, _)| wrong.as_str()).collect();
    assert!(wrong.is_empty(), "\n{wrong}");
    assert!(checked.iter().map(|(_, count)| count).sum::<usize>() >= 8);
}

/// The table of effects and methods is what the program accepts.
#[test]
fn methods_support_the_effects_of_the_table() {
    let path = Path::new("docs/guide/methods.md");
    holds("docs/guide/methods.md", &barwave::scene::methods_table());
    let wrong = scenes::wrong_combinations(&Page { path: path.to_owned(), text: read(path) });
    assert!(wrong.is_empty(), "\n{wrong}");
}

#[test]
fn links_lead_somewhere() {
    let wrong: String = pages().iter().map(links::broken).collect();
    assert!(wrong.is_empty(), "\n{wrong}");
    assert_eq!(links::unlisted(&pages()), Vec::<String>::new(), "not in docs/SUMMARY.md");
}

/// Commands and options named in the text exist.
#[test]
fn commands_in_the_text_exist() {
    let known = commands(&barwave(&["--help"]));
    let mut wrong = String::new();
    for page in pages() {
        for span in page.prose().join("\n").split('`').skip(1).step_by(2).filter(|span| span.starts_with("barwave ")) {
            let words = console::words(span);
            let named =
                words.iter().skip(1).take_while(|word| commands_below(&known, word)).cloned().collect::<Vec<_>>();
            let options =
                words.iter().filter(|word| word.starts_with("--")).map(|word| word.split('=').next().unwrap_or(word));
            let help = named.first().map(|command| barwave(&[command, "--help"]));
            let missing = |option: &&str| !help.as_ref().is_some_and(|help| help.contains(*option));
            if words.len() > 1 && (named.is_empty() && !words[1].starts_with('-'))
                || options.clone().any(|o| missing(&o))
            {
                let _ = writeln!(wrong, "{}: {span}", page.path.display());
            }
        }
    }
    assert!(wrong.is_empty(), "\n{wrong}");
}

fn commands_below(known: &[String], word: &str) -> bool {
    known.iter().any(|name| name == word) || word == "help"
}

#[test]
fn the_table_of_commands_is_complete() {
    let page = readme();
    let table: Vec<&str> = page.text.lines().filter(|line| line.starts_with("| `barwave ")).collect();
    for name in commands(&barwave(&["--help"])) {
        let named = |line: &&str| {
            let first = line.split('|').nth(1).unwrap_or_default();
            first.split(|c: char| !c.is_alphanumeric()).any(|word| word == name)
        };
        assert!(table.iter().any(named), "`{name}` is missing from the README's table");
    }
}

/// What README.md and docs/guide/materials.md say of the constants in the library.
#[test]
fn library_materials_have_the_stated_constants() {
    for name in library::names() {
        let material = library::find(name, Path::new("")).expect("a material");
        let (rate, missing) = (&material.constants.rate, material.constants.heat.missing());
        assert_eq!([!rate.is_empty(), missing.is_empty()], [name.ends_with("-jc"); 2], "{name}: {missing:?}");
        assert!(material.poisson.is_some_and(|poisson| (0.2..0.4).contains(&poisson)), "{name}");
    }
}

/// The blocks marked `the file NAME` are that file, but for comments on lines of their own and the visibility of `main`.
#[test]
fn files_are_shown_as_they_are() {
    let plain = |text: &str| {
        let lines: Vec<&str> = text.lines().filter(|line| !line.starts_with('#') && !line.starts_with("//")).collect();
        lines.join("\n").replace("pub(crate) fn main", "fn main").replace("\n\n\n", "\n\n").trim().to_owned()
    };
    let mut count = 0;
    for page in pages() {
        for block in page.blocks() {
            let Some(name) = block.mark.as_deref().and_then(|mark| mark.strip_prefix("the file ")) else { continue };
            assert_eq!(plain(&block.text()), plain(&read(Path::new(name))), "{}: {name}", page.path.display());
            count += 1;
        }
    }
    assert!(count >= 2);
}

/// The example of README.md runs.
#[test]
fn the_rust_example_runs() {
    example::main().expect("the example");
}

/// The error figure of a run.
fn error_of(scene: &str, cells: &str, folder: &Path) -> f64 {
    let result = folder.join("result.h5");
    let path = root().join(scene);
    let cells = format!("solve.cells={cells}");
    let (scene, result) = (path.to_string_lossy(), result.to_string_lossy());
    let summary = barwave(&["run", &scene, "--json", "--set", &cells, "-o", &result]);
    let summary: serde_json::Value = serde_json::from_str(&summary).expect("one JSON object");
    summary["error"]["value"].as_f64().expect("a scene with an exact solution")
}

#[test]
fn errors_are_those_of_the_table() {
    let folder = tempfile::tempdir().expect("a folder for results");
    let page = read(Path::new("docs/guide/accuracy.md"));
    let mut compared = 0;
    for row in page.lines().filter(|line| line.starts_with("| `runs/")) {
        let row: Vec<&str> = row.trim_matches('|').split('|').map(str::trim).collect();
        let scene = row[0].trim_matches('`');
        for (cells, printed) in [("1000", row[1]), ("10000", row[2])] {
            let printed: f64 = printed.parse().expect("a number");
            let error = error_of(scene, cells, folder.path());
            if printed < 1e-12 {
                // Rounding depends on the processor.
                assert!(error < 1e-12, "{scene}, {cells} cells: {error:e}");
            } else {
                // Two digits are printed: rounding alone moves 0.0011 by up to 4.5 %.
                assert!((error / printed - 1.0).abs() < 0.05, "{scene}, {cells} cells: {error:e}, not {printed:e}");
            }
            compared += 1;
        }
    }
    assert_eq!(compared, 6);
}

const BEGIN: &str = "<!-- generated -->\n";
const END: &str = "<!-- end of generated -->";

/// A page whose middle is generated.
fn holds(path: &str, generated: &str) {
    let kept = read(Path::new(path));
    let (before, rest) = kept.split_once(BEGIN).expect("the beginning of the generated part");
    let (_, after) = rest.split_once(END).expect("the end of the generated part");
    let fresh = format!("{before}{BEGIN}\n{generated}\n{END}{after}");
    if update() {
        std::fs::write(root().join(path), &fresh).expect("the page");
    }
    assert_eq!(fresh, read(Path::new(path)), "{path} is not up to date: UPDATE_DOCS=1");
}

const fn section(heading: &'static str, definition: &'static str) -> Section {
    Section { heading, definition }
}

#[test]
fn the_reference_of_commands_is_up_to_date() {
    holds("docs/reference/commands.md", &command_pages());
}

#[test]
fn the_reference_of_scene_keys_is_up_to_date() {
    let sections = [
        section("Top level", ""),
        section("`[bar]`", "RawBar"),
        section("`[[bar.segment]]`", "RawSegment"),
        section("Initial values from a file", "RawTableFile"),
        section("`[left]` and `[right]`", "RawEnd"),
        section("A history from a record: `csv`", "RawHistoryRecord"),
        section("`[effects]`", "RawEffects"),
        section("`effects.rate`", "RawRate"),
        section("`effects.heat`", "RawHeat2"),
        section("`effects.damping`", "RawDamping"),
        section("`[solve]`", "RawSolve"),
        section("`[record]`", "RawRecord"),
    ];
    let scene = Schema::of("scene").tables_without(&sections, &["RawMaterial"]);
    let specimen = [
        section("Energy method: top level", ""),
        section("`[specimen]`", "RawSpecimen"),
        section("`[striker]`", "RawStriker"),
    ];
    let specimen = Schema::of("specimen").tables_without(&specimen, &["RawMaterial"]);
    let kind = |key: &str, name: &'static str, tables: &[[&'static str; 2]], striker: &'static str| {
        let sphere = section("`[striker]`", striker);
        let own = tables.iter().map(|[title, table]| section(title, table));
        let sections: Vec<_> = [section(name, "")].into_iter().chain(own).chain([sphere]).collect();
        Schema::of(key).tables_without(&sections, &["RawMaterial"])
    };
    let spheres = [["`[spheres]`", "RawSpheres"], ["`[solve]` of spheres", "RawSpheresSolve"]];
    let plate = [["`[plate]`", "RawPlate"], ["`[solve]` of a plate", "RawPlateSolve"]];
    let beam =
        [["`[beam]`", "RawBeam"], ["`[solve]` of a beam", "RawBeamSolve"], ["`[record]` of a beam", "RawBeamRecord"]];
    let impacts = [
        kind("spheres", "Spheres: top level", &spheres, "RawStrikingSphere"),
        kind("plate", "Plate: top level", &plate, "RawSphere"),
        kind("beam", "Beam: top level", &beam, "RawSphere"),
    ];
    holds("docs/reference/scene.md", &format!("{scene}\n{specimen}\n{}", impacts.join("\n")));
}

#[test]
fn the_reference_of_figures_is_up_to_date() {
    let mut table = "| at | key | unit | figure |\n|---|---|---|---|".to_owned();
    for [place, key, unit, description] in barwave::record::definitions() {
        let _ = write!(table, "\n| {place} | `{key}` | {unit} | {description} |");
    }
    holds("docs/reference/figures.md", &(table + "\n"));
}

#[test]
fn the_reference_of_material_keys_is_up_to_date() {
    let sections = [
        section("Top level", ""),
        section("`[curve]` and `[compression]`", "RawCurve"),
        section("`tabulate`", "RawTabulate"),
        section("`[rate]`", "RawRates"),
        section("A rate law, as in `[rate.malvern]`", "RawRate"),
        section("`[heat]`", "RawHeat"),
        section("`[band]`", "RawBand"),
        section("`[[band.test]]`", "RawTest"),
        section("`[source]`", "RawSource"),
    ];
    holds("docs/reference/material.md", &Schema::of("material").tables_without(&sections, &[]));
}
