//! The library's layers: a module imports only from those above it in src/lib.rs, and the files of a folder have no circles of
//! imports.

#[path = "layering/circles.rs"]
mod circles;
#[path = "layering/source.rs"]
mod source;

use std::fmt::Write;
use std::path::Path;

use circles::circles;
use source::{Source, paths, sources};

const CIRCLES_ALLOWED: [&str; 0] = [];

/// Top-level modules in the order of lib.rs.
fn layers(lib: &str) -> Vec<String> {
    let name = |line: &str| {
        line.strip_prefix("pub ").unwrap_or(line).strip_prefix("mod ")?.strip_suffix(';').map(str::to_owned)
    };
    lib.lines().filter_map(|line| name(line.trim())).collect()
}

/// All top-level modules that a file names: (line, name). Climbing paths of tests are left out: they start inside the file.
fn mentions(source: &Source) -> Vec<(usize, String)> {
    let climb = vec!["super".to_owned(); source.module.len()];
    let absolute = paths(&source.code).into_iter().filter(|named| named.words[0] == "crate").map(|named| (named, 1));
    let climbing = paths(&source.product()).into_iter().filter(|named| named.words.starts_with(&climb));
    let all = absolute.chain(climbing.map(|named| (named, climb.len())));
    all.filter_map(|(named, root)| Some((named.line, named.words.get(root)?.clone()))).collect()
}

/// Imports of one file that go down: one line each.
fn wrong_imports(source: &Source, layers: &[String]) -> String {
    let rank = |name: &str| layers.iter().position(|l| l == name);
    let layer = &source.module[0];
    let own = rank(layer).unwrap_or_else(|| panic!("{} is in no layer of lib.rs", source.file));
    let mut wrong = String::new();
    for (line, name) in mentions(source) {
        let complaint = match rank(&name) {
            Some(other) if other <= own => continue,
            Some(_) => format!("`{layer}` stands above `{name}` in lib.rs and must not name it"),
            None => format!("`{name}` is no module of lib.rs"),
        };
        let _ = writeln!(wrong, "{}:{line}: {complaint}", source.file);
    }
    wrong
}

#[test]
fn no_module_imports_from_a_layer_below() {
    let lib = Path::new(env!("CARGO_MANIFEST_DIR")).join("src/lib.rs");
    let layers = layers(&std::fs::read_to_string(lib).expect("lib.rs"));
    assert!(layers.len() > 10, "{layers:?}");
    let wrong: String = sources().iter().map(|source| wrong_imports(source, &layers)).collect();
    assert!(wrong.is_empty(), "\n{wrong}");
}

#[test]
fn files_of_a_folder_import_each_other_in_no_circle() {
    let found = circles(&sources(), &CIRCLES_ALLOWED);
    assert!(found.is_empty(), "\n{found}");
}

#[test]
fn the_check_of_layers_finds_what_it_should() {
    let layers: Vec<String> = ["error", "law", "bar", "run"].map(str::to_owned).to_vec();
    let wrong = |file: &str, text: &str| wrong_imports(&Source::new(file, text), &layers);
    assert_eq!(wrong("bar/end.rs", "use crate::law::Table;\nuse super::History;\nlet a = crate::bar::B;\n"), "");
    assert!(wrong("law/mod.rs", "\n/// Of [`x`].\nuse crate::bar::Bar;\n").starts_with("src/law/mod.rs:3: `law`"));
    assert!(wrong("law/mod.rs", "fn f() -> crate::run::Run {}\n").starts_with("src/law/mod.rs:1:"));
    assert!(wrong("law/mod.rs", "use crate::{\n    error::{run, Error},\n    bar,\n};\n").contains("must not name it"));
    assert_eq!(wrong("law/mod.rs", "use crate::{\n    error::{run, Error},\n};\n"), "");
    assert!(wrong("law/a/b.rs", "use super::super::super::bar::Bar;\n").contains("`bar`"));
    assert_eq!(wrong("law/a/b.rs", "use super::super::bar;\n// crate::run\nlet t = \"crate::run\";\n"), "");
    assert!(wrong("error.rs", "use super::run;\n").contains("`run`"));
    assert!(wrong("run.rs", "use crate::nowhere;\n").contains("no module"));
    assert!(wrong("law/a.rs", "#[cfg(test)]\nmod tests {\n    use crate::run::Run;\n}\n").contains(":3:"));
}

/// The circles of a library of these files.
fn circles_of(files: &[(&str, &str)]) -> String {
    let sources: Vec<Source> = files.iter().map(|(file, text)| Source::new(file, text)).collect();
    circles(&sources, &["allowed"])
}

#[test]
fn the_check_of_circles_finds_what_it_should() {
    let pair = circles_of(&[("a/x.rs", "use super::y::{B, C};\n"), ("a/y.rs", "\nlet d = super::x::D;\n")]);
    assert_eq!(pair, "src/a: a circle of {\"x\", \"y\"}\n    x -> y: src/a/x.rs:1\n    y -> x: src/a/y.rs:2\n");
    let absolute =
        [("a/mod.rs", ""), ("a/x.rs", "use crate::{error::E, a::y};\n"), ("a/y.rs", "use super::{z::Z, x::X};\n")];
    assert!(circles_of(&absolute).contains("circle of {\"x\", \"y\"}"));
    // A name that the folder brings in from one of its files belongs to that file, however it is called there.
    let folder = ("a/mod.rs", "mod x;\nmod y;\npub use y::{B as C};\nuse x::X;\n");
    let through = [folder, ("a/x.rs", "use super::C;\n"), ("a/y.rs", "use super::X;\n")];
    assert!(circles_of(&through).contains("x -> y: src/a/x.rs:1"));
    // A file below a folder counts as the folder, from wherever it imports.
    let deep = [("a/x/mod.rs", ""), ("a/x/z.rs", "use super::super::y::Y;\n"), ("a/y.rs", "use super::x::X;\n")];
    assert!(circles_of(&deep).contains("x -> y: src/a/x/z.rs:1"));
    let three = [("a/x.rs", "use super::y;"), ("a/y.rs", "use super::z;"), ("a/z.rs", "use super::x;")];
    assert!(circles_of(&three).contains("{\"x\", \"y\", \"z\"}"));
}

#[test]
fn the_check_of_circles_leaves_alone_what_is_none() {
    let folder = ("a/mod.rs", "mod x;\nmod y;\npub use x::X;\npub struct Own;\n");
    let down = [folder, ("a/x.rs", "use super::{Own, y::Y};\n"), ("a/y.rs", "use super::Own;\n// super::x::X\n")];
    assert_eq!(circles_of(&down), "");
    let test = "#[cfg(test)]\nfn f() { super::x::X }\n#[cfg(test)]\nmod tests {\n    use super::super::x::X;\n}\n";
    assert_eq!(circles_of(&[("a/x.rs", "use super::y::Y;\n"), ("a/y.rs", test)]), "");
    let allowed = [("allowed/x.rs", "use super::y::Y;\n"), ("allowed/y.rs", "use super::x::X;\n")];
    assert_eq!(circles_of(&allowed), "");
}
