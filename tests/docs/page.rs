//! Pages of the documentation and their fenced blocks.

use std::path::{Path, PathBuf};

/// A Markdown file; the path is relative to the package.
pub struct Page {
    pub path: PathBuf,
    pub text: String,
}

/// A fenced block: the language, the comment `<!-- mark -->` on the line before it, and its lines.
pub struct Block {
    pub language: String,
    pub mark: Option<String>,
    /// Index of the first line of the content in the page.
    pub first: usize,
    pub lines: Vec<String>,
}

pub fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// README.md, materials/README.md and all pages in docs/.
pub fn pages() -> Vec<Page> {
    let mut paths = vec![PathBuf::from("README.md"), PathBuf::from("materials/README.md")];
    let mut folders = vec![PathBuf::from("docs")];
    while let Some(folder) = folders.pop() {
        for entry in std::fs::read_dir(root().join(&folder)).expect("a folder") {
            let entry = entry.expect("an entry");
            let path = folder.join(entry.file_name());
            if entry.path().is_dir() {
                folders.push(path);
            } else if path.extension().is_some_and(|extension| extension == "md") {
                paths.push(path);
            }
        }
    }
    paths.sort();
    paths.into_iter().map(|path| Page { text: read(&path), path }).collect()
}

pub fn read(path: &Path) -> String {
    std::fs::read_to_string(root().join(path)).unwrap_or_else(|e| panic!("{}: {e}", path.display()))
}

/// True if `UPDATE_DOCS` is set: the tests rewrite the pages.
pub fn update() -> bool {
    std::env::var_os("UPDATE_DOCS").is_some()
}

impl Page {
    pub fn blocks(&self) -> Vec<Block> {
        let mut blocks: Vec<Block> = Vec::new();
        let (mut open, mut mark) = (false, None);
        for (number, line) in self.text.lines().enumerate() {
            if let Some(language) = line.strip_prefix("```") {
                if !open {
                    let (language, lines) = (language.trim().to_owned(), Vec::new());
                    blocks.push(Block { language, mark: mark.take(), first: number + 1, lines });
                }
                open = !open;
            } else if open {
                blocks.last_mut().expect("an open block").lines.push(line.to_owned());
            } else if !line.trim().is_empty() {
                let comment = line.trim().strip_prefix("<!-- ").and_then(|rest| rest.strip_suffix(" -->"));
                mark = comment.map(str::to_owned);
            }
        }
        assert!(!open, "{}: a block is not closed", self.path.display());
        blocks
    }

    /// Lines outside fenced blocks.
    pub fn prose(&self) -> Vec<&str> {
        let mut open = false;
        let mut lines = Vec::new();
        for line in self.text.lines() {
            if line.starts_with("```") {
                open = !open;
            } else if !open {
                lines.push(line);
            }
        }
        lines
    }
}

impl Block {
    pub fn text(&self) -> String {
        self.lines.iter().flat_map(|line| [line, "\n"]).collect()
    }

    /// What follows `key: ` in the mark.
    pub fn marked(&self, key: &str) -> Option<&str> {
        self.mark.as_deref()?.strip_prefix(key)?.strip_prefix(": ")
    }
}
