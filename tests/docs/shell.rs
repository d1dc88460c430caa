//! Commands in ```` ```sh ```` blocks: those of barwave run; of the others, which build, measure or need a cluster, everything they name exists.

use std::fmt::Write as _;
use std::path::Path;

use crate::console;
use crate::page::{Block, Page, read, root};

/// What is wrong in the `sh` blocks of a page, and the number of commands looked at. A block that shows a file is compared with that file.
pub fn wrong(page: &Page) -> (String, usize) {
    let blocks = page.blocks();
    let shown =
        |block: &&Block| block.language == "sh" && block.mark.as_deref().is_none_or(|m| !m.starts_with("the file"));
    let (mut wrong, mut count) = (String::new(), 0);
    for line in blocks.iter().filter(shown).flat_map(|block| &block.lines) {
        let command = line.split("  #").next().unwrap_or_default().trim();
        if let Some(missing) = missing(command) {
            let _ = writeln!(wrong, "{}: {command}: {missing}", page.path.display());
        }
        count += 1;
    }
    (wrong, count)
}

/// What a command needs and has not; none if it can be run.
fn missing(command: &str) -> Option<String> {
    let words = console::words(command);
    // Variables set for the command alone, or from its output.
    let is_variable = |word: &&String| {
        word.split_once('=').is_some_and(|(name, _)| name.chars().all(|c| c.is_ascii_uppercase() || c == '_'))
    };
    let words: Vec<&str> = words.iter().skip_while(is_variable).map(String::as_str).collect();
    let exists = |path: &str| root().join(path).exists();
    let file = |path: &str| (!exists(path)).then(|| format!("there is no {path}"));
    match words[..] {
        ["barwave", ..] => runs(command),
        ["cargo", "run", "--release", "--example", name, ..] => file(&format!("examples/{name}.rs")),
        ["cargo", "run", "--release", "--", "run", scene] => file(scene),
        ["cargo", "test", "--release", "--test", "suite", name, ..] => test(name),
        ["cargo", "+nightly", "fuzz", "run", target, ..] => file(&format!("fuzz/fuzz_targets/{target}.rs")),
        ["python" | "python3", script, ..] => file(script),
        // tests/slurm.sh runs the script that sbatch submits.
        ["cargo", "install", "cargo-fuzz"] | ["sbatch", ..] => None,
        [assigned, ..] if assigned.contains("$(sbatch") => words
            .iter()
            .find(|word| word.ends_with(".sbatch"))
            .map_or(Some("no script".to_owned()), |script| file(script)),
        [script] if script.starts_with("tests/") => file(script),
        _ => Some("neither run nor looked at by this test".to_owned()),
    }
}

fn runs(command: &str) -> Option<String> {
    let folder = console::folder_with_runs();
    let (success, printed) = console::run(folder.path(), command);
    (!success).then(|| printed.join("\n"))
}

/// A test of the suite by its path, `module::function`.
fn test(name: &str) -> Option<String> {
    let (module, function) = name.split_once("::").unwrap_or((name, ""));
    let source = root().join(format!("tests/suite/{module}.rs"));
    let text = if source.exists() { read(Path::new(&format!("tests/suite/{module}.rs"))) } else { String::new() };
    (!text.contains(&format!("fn {function}"))).then(|| format!("there is no test {name}"))
}
