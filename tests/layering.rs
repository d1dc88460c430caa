//! The library's layers: a module imports only from those above it in src/lib.rs.

use std::fmt::Write;
use std::path::{Path, PathBuf};

/// Top-level modules in the order of lib.rs.
fn layers(lib: &str) -> Vec<String> {
    let name = |line: &str| line.strip_prefix("pub mod ")?.strip_suffix(';').map(str::to_owned);
    lib.lines().filter_map(|line| name(line.trim())).collect()
}

fn sources(folder: &Path, found: &mut Vec<PathBuf>) {
    for entry in std::fs::read_dir(folder).expect("a folder") {
        let path = entry.expect("an entry").path();
        if path.is_dir() {
            sources(&path, found);
        } else if path.extension().is_some_and(|e| e == "rs") {
            found.push(path);
        }
    }
}

/// Source without comments and texts, byte for byte as long, so that lines keep their numbers. Raw texts and
/// characters that hold quotes are cut off at the line's end.
fn code_only(text: &str) -> String {
    let mut code = String::with_capacity(text.len());
    for line in text.lines() {
        let (mut in_text, mut escaped, mut previous) = (false, false, ' ');
        for c in line.chars() {
            if !in_text && c == '/' && previous == '/' {
                code.pop();
                break;
            }
            if c == '"' && !escaped && previous != '\'' {
                in_text = !in_text;
            }
            escaped = in_text && c == '\\' && !escaped;
            code.push(if in_text { ' ' } else { c });
            previous = c;
        }
        code.push('\n');
    }
    code
}

/// What follows a path's root (`crate::` or the last `super::`): one name, or the first names of a braced list.
fn names(after: &str) -> Vec<&str> {
    let word = |text: &'_ str| text.find(|c: char| !c.is_alphanumeric() && c != '_').unwrap_or(text.len());
    let Some(list) = after.strip_prefix('{') else { return vec![&after[..word(after)]] };
    let (mut depth, mut start, mut found) = (1, 0, Vec::new());
    for (at, c) in list.char_indices() {
        match c {
            '{' => depth += 1,
            '}' => depth -= 1,
            _ => {}
        }
        if depth == 0 || (depth == 1 && c == ',') {
            let item = list[start..at].trim();
            found.extend((!item.is_empty()).then(|| &item[..word(item)]));
            start = at + 1;
        }
        if depth == 0 {
            break;
        }
    }
    found
}

/// All top-level modules that a file names: (line, name). `depth` is how many modules deep the file is.
fn mentions(code: &str, depth: usize) -> Vec<(usize, String)> {
    let line_of = |at: usize| code[..at].matches('\n').count() + 1;
    let mut found = Vec::new();
    let mut add = |at: usize, after: usize| {
        found.extend(names(&code[after..]).into_iter().map(|name| (line_of(at), name.to_owned())));
    };
    for (at, root) in code.match_indices("crate::") {
        add(at, at + root.len());
    }
    // A path that climbs to the top of the crate. Modules inside a file climb one step less far: they are its tests.
    let climb = "super::".repeat(depth);
    let product = code.find("#[cfg(test)]").unwrap_or(code.len());
    for (at, _) in code[..product].match_indices(&climb) {
        add(at, at + climb.len());
    }
    found
}

/// Imports of one file that go down: one line each.
fn wrong_imports(file: &str, text: &str, layers: &[String]) -> String {
    let modules: Vec<&str> = file.trim_end_matches(".rs").trim_end_matches("/mod").split('/').collect();
    let rank = |name: &str| layers.iter().position(|l| l == name);
    let own = rank(modules[0]).unwrap_or_else(|| panic!("src/{file} is in no layer of lib.rs"));
    let mut wrong = String::new();
    for (line, name) in mentions(&code_only(text), modules.len()) {
        let complaint = match rank(&name) {
            Some(other) if other <= own => continue,
            Some(_) => format!("`{}` stands above `{name}` in lib.rs and must not name it", modules[0]),
            None => format!("`{name}` is no module of lib.rs"),
        };
        let _ = writeln!(wrong, "src/{file}:{line}: {complaint}");
    }
    wrong
}

#[test]
fn no_module_imports_from_a_layer_below() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    let layers = layers(&std::fs::read_to_string(root.join("lib.rs")).expect("lib.rs"));
    assert!(layers.len() > 10, "{layers:?}");
    let mut files = Vec::new();
    sources(&root, &mut files);
    assert!(files.len() > 50, "{} files", files.len());
    let mut wrong = String::new();
    for path in files {
        let file = path.strip_prefix(&root).expect("in src").display().to_string().replace('\\', "/");
        // The crate's two roots are above all layers.
        if file != "lib.rs" && file != "main.rs" {
            wrong += &wrong_imports(&file, &std::fs::read_to_string(&path).expect("text"), &layers);
        }
    }
    assert!(wrong.is_empty(), "\n{wrong}");
}

#[test]
fn the_check_finds_what_it_should() {
    let layers: Vec<String> = ["error", "law", "bar", "run"].map(str::to_owned).to_vec();
    let wrong = |file: &str, text: &str| wrong_imports(file, text, &layers);
    assert_eq!(wrong("bar/end.rs", "use crate::law::Table;\nuse super::History;\nlet a = crate::bar::B;\n"), "");
    assert!(wrong("law/mod.rs", "\n/// Of [`x`].\nuse crate::bar::Bar;\n").starts_with("src/law/mod.rs:3: `law`"));
    assert!(wrong("law/mod.rs", "fn f() -> crate::run::Run {}\n").starts_with("src/law/mod.rs:1:"));
    assert!(wrong("law/mod.rs", "use crate::{\n    error::{run, Error},\n    bar,\n};\n").contains("must not name it"));
    assert_eq!(wrong("law/mod.rs", "use crate::{\n    error::{run, Error},\n};\n"), "");
    assert!(wrong("law/a/b.rs", "use super::super::super::bar::Bar;\n").contains("`bar`"));
    assert_eq!(wrong("law/a/b.rs", "use super::super::bar;\n// crate::run\nlet t = \"crate::run\";\n"), "");
    assert!(wrong("error.rs", "use super::run;\n").contains("`run`"));
    assert!(wrong("run.rs", "use crate::nowhere;\n").contains("no module"));
}
