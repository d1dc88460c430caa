//! The files of the library and the module paths that they name.

use std::path::{Path, PathBuf};

/// One file of src: its module path from the root of the crate, and its code without comments and texts.
pub struct Source {
    /// As in a message: `src/bar/end.rs`.
    pub file: String,
    /// `["bar", "end"]`; of `bar/mod.rs`: `["bar"]`.
    pub module: Vec<String>,
    pub code: String,
}

impl Source {
    pub fn new(file: &str, text: &str) -> Self {
        let path = file.trim_end_matches(".rs").trim_end_matches("/mod");
        let module = path.split('/').map(str::to_owned).collect();
        Self { file: format!("src/{file}"), module, code: code_only(text) }
    }

    /// The code without modules and items that only tests have, byte for byte as long.
    pub fn product(&self) -> String {
        let mut product = String::with_capacity(self.code.len());
        let mut rest = self.code.as_str();
        while let Some(at) = rest.find("#[cfg(test)]") {
            let end = at + end_of_item(&rest[at..]);
            product += &rest[..at];
            product.extend(rest[at..end].chars().map(|c| if c == '\n' { c } else { ' ' }));
            rest = &rest[end..];
        }
        product + rest
    }
}

/// All files of src but the two roots of the crate and files of tests alone, which no layer and no circle counts.
pub fn sources() -> Vec<Source> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    let mut paths = Vec::new();
    files(&root, &mut paths);
    assert!(paths.len() > 50, "{} files", paths.len());
    let name = |path: &Path| path.strip_prefix(&root).expect("in src").display().to_string().replace('\\', "/");
    paths
        .iter()
        .map(|path| (name(path), path))
        .filter(|(file, _)| file != "lib.rs" && file != "main.rs")
        .map(|(file, path)| Source::new(&file, &std::fs::read_to_string(path).expect("text")))
        .collect()
}

fn files(folder: &Path, found: &mut Vec<PathBuf>) {
    for entry in std::fs::read_dir(folder).expect("a folder") {
        let path = entry.expect("an entry").path();
        if path.is_dir() {
            files(&path, found);
        } else if path.extension().is_some_and(|e| e == "rs") {
            found.push(path);
        }
    }
    found.sort();
}

/// Source without comments and texts, line by line, so that lines keep their numbers. Raw texts and characters that hold
/// quotes are cut off at the line's end.
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

/// Where the item ends that starts here: at its closing brace, or at a semicolon outside of braces.
fn end_of_item(code: &str) -> usize {
    let mut depth = 0;
    for (at, c) in code.char_indices() {
        match c {
            '{' => depth += 1,
            '}' => depth -= 1,
            _ => {}
        }
        if depth == 0 && matches!(c, '}' | ';') {
            return at + 1;
        }
    }
    code.len()
}

/// A path that a file names: `crate::a::B`, or one that starts with `super` or `self`.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Named {
    pub line: usize,
    pub words: Vec<String>,
    /// In a `use`: the name under which it is known here.
    pub alias: String,
}

/// All paths with a root, in `use` declarations and in code, lists in braces taken apart.
pub fn paths(code: &str) -> Vec<Named> {
    let starts = |at: usize| !code[..at].ends_with(|c: char| c.is_alphanumeric() || c == '_' || c == ':');
    let roots = ["crate::", "super::", "self::"].iter().flat_map(|root| code.match_indices(root));
    let mut found = Vec::new();
    for (at, _) in roots.filter(|(at, _)| starts(*at)) {
        tree(&code[at..], &[], code[..at].matches('\n').count() + 1, &mut found);
    }
    found
}

/// All that `use` declarations bring in, whatever they start with.
pub fn uses(code: &str) -> Vec<Named> {
    let mut found = Vec::new();
    for (at, word) in code.match_indices("use ") {
        if !code[..at].ends_with(|c: char| c.is_alphanumeric() || c == '_') {
            let after = code[at + word.len()..].trim_start_matches(':');
            tree(after, &[], code[..at].matches('\n').count() + 1, &mut found);
        }
    }
    found
}

/// Reads `a::b`, `a::{b, c::d}`, `a as b`; returns the length of what was read.
fn tree(code: &str, before: &[String], line: usize, found: &mut Vec<Named>) -> usize {
    let blank = |from: usize| code[from..].len() - code[from..].trim_start().len();
    let (mut words, mut at) = (before.to_vec(), blank(0));
    loop {
        if code[at..].starts_with('{') {
            at += 1;
            loop {
                at += blank(at);
                match code[at..].chars().next() {
                    Some(',') => at += 1,
                    None | Some('}') => return at + 1,
                    Some(_) => at += tree(&code[at..], &words, line, found).max(1),
                }
            }
        }
        let word = word(&code[at..]);
        at += word.len();
        words.extend((!word.is_empty()).then(|| word.to_owned()));
        if word.is_empty() || !code[at..].starts_with("::") {
            break;
        }
        at += 2;
    }
    let renamed = code[at..].trim_start().strip_prefix("as ");
    let alias = renamed.map(|name| name.split(|c: char| !c.is_alphanumeric() && c != '_').next().unwrap_or_default());
    let alias = alias.map(str::to_owned).or_else(|| words.last().cloned()).unwrap_or_default();
    found.push(Named { line, words, alias });
    at + code[at..].find([',', '}', ';', '\n']).unwrap_or(0)
}

fn word(code: &str) -> &str {
    &code[..code.find(|c: char| !c.is_alphanumeric() && c != '_').unwrap_or(code.len())]
}
