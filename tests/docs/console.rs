//! Commands in ```` ```console ```` blocks and their output.
//!
//! The commands of a page run in order in one temporary folder that has `runs/`. A block with the mark `file: NAME` is first
//! written to that folder. Of the shown output, `...` stands for any number of lines. A command without output is only run. One that is
//! shown as interrupted receives SIGINT once its result file is there.

use std::fmt::Write as _;
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::Duration;

use crate::page::{Page, read, root, update};

/// Lines that depend on the machine: times and rounding residuals. Of these only the label is compared.
const VARYING: [&str; 4] = ["  time ", "  ledger ", "  expected time ", "  elastic check "];

const ELISION: &str = "...";

/// Characters of a number that are compared; later digits depend on the processor.
const DIGITS: usize = 11;

/// Numbers below this are rounding.
const ROUNDING: f64 = 1e-12;

/// A line with long numbers cut, and 0 for rounding.
fn cut(line: &str) -> String {
    let is_rounding = |word: &str| word.trim_end_matches(',').parse().is_ok_and(|value: f64| value.abs() < ROUNDING);
    let words: Vec<&str> = line.split(' ').map(|word| if is_rounding(word) { "0" } else { word }).collect();
    let line = words.join(" ");
    let mut length = 0;
    let keep = |c: &char| {
        length = if c.is_ascii_digit() || *c == '.' { length + 1 } else { 0 };
        length <= DIGITS
    };
    line.chars().filter(keep).collect()
}

fn same(shown: &str, printed: &str) -> bool {
    cut(shown) == cut(printed) || VARYING.iter().any(|label| shown.starts_with(label) && printed.starts_with(label))
}

/// Words of a command line; quotes group.
pub fn words(line: &str) -> Vec<String> {
    let (mut words, mut quote, mut inside) = (vec![String::new()], None, false);
    for c in line.chars() {
        match (quote, c) {
            (None, ' ') => {
                if inside {
                    words.push(String::new());
                }
                inside = false;
                continue;
            }
            (None, '"' | '\'') => quote = Some(c),
            (Some(q), _) if q == c => quote = None,
            _ => words.last_mut().expect("a word").push(c),
        }
        inside = true;
    }
    words.retain(|word| !word.is_empty());
    words
}

/// A folder with `runs/`.
pub fn folder_with_runs() -> tempfile::TempDir {
    let folder = tempfile::tempdir().expect("a folder");
    std::fs::create_dir(folder.path().join("runs")).expect("a folder");
    for scene in std::fs::read_dir(root().join("runs")).expect("runs").map(|entry| entry.expect("an entry").path()) {
        if scene.extension().is_some_and(|extension| extension == "toml") {
            std::fs::copy(&scene, folder.path().join("runs").join(scene.file_name().expect("a name"))).expect("a copy");
        }
    }
    folder
}

/// The same with the files that the page shows.
fn folder_of(page: &Page) -> tempfile::TempDir {
    let folder = folder_with_runs();
    for block in page.blocks() {
        if let Some(name) = block.marked("file") {
            std::fs::write(folder.path().join(name), block.text()).expect("a file");
        }
    }
    folder
}

pub fn run(folder: &Path, command: &str) -> (bool, Vec<String>) {
    let (code, lines) = run_until(folder, command, None);
    (code == Some(0), lines)
}

/// Exit code of an interrupted command.
const INTERRUPTED: i32 = 130;

/// Runs a command until it ends, or is interrupted once there is this file; its exit code and what it printed.
fn run_until(folder: &Path, command: &str, interrupted_at: Option<&str>) -> (Option<i32>, Vec<String>) {
    let arguments = words(command);
    assert_eq!(arguments[0], "barwave", "{command}");
    let mut child = Command::new(env!("CARGO_BIN_EXE_barwave"))
        .current_dir(folder)
        .args(&arguments[1..])
        .env_remove("BARWAVE_MATERIALS")
        .env_remove("COLUMNS")
        .stdin(Stdio::null())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .expect("the program starts");
    if let Some(file) = interrupted_at {
        while !folder.join(file).exists() && child.try_wait().expect("its state").is_none() {
            std::thread::sleep(Duration::from_millis(1));
        }
        Command::new("kill").args(["-INT", &child.id().to_string()]).status().expect("a signal");
    }
    let output = child.wait_with_output().expect("the program ends");
    let text = [output.stdout, output.stderr].concat();
    let lines = String::from_utf8(text).expect("text").lines().map(|line| line.trim_end().to_owned()).collect();
    (output.status.code(), lines)
}

/// The first shown line that the output does not have; none if all agree.
fn difference<'a>(shown: &'a [String], printed: &[String]) -> Option<&'a str> {
    let mut at = 0;
    let mut skip = false;
    for line in shown {
        if line == ELISION {
            skip = true;
            continue;
        }
        let here = if skip { printed[at..].iter().position(|p| same(line, p)) } else { Some(0) };
        skip = false;
        match here.map(|k| at + k).filter(|&k| printed.get(k).is_some_and(|p| same(line, p))) {
            Some(found) => at = found + 1,
            None => return Some(line),
        }
    }
    (!skip && at != printed.len()).then_some("(end of the output)")
}

/// What a page should show in place of `shown`: as many lines before the first and after the last elision. Of the lines between
/// elisions only the label has to be right, the text before two spaces.
fn fresh(shown: &[String], printed: &[String]) -> Vec<String> {
    let Some(first) = shown.iter().position(|line| line == ELISION) else { return printed.to_vec() };
    let last = shown.iter().rposition(|line| line == ELISION).unwrap_or(first);
    let tail = (shown.len() - last - 1).min(printed.len());
    let head = first.min(printed.len() - tail);
    let mut at = head;
    // Lines of one label follow each other in the order of the output.
    let mut labelled = |line: &String| {
        let label = line.trim().split("  ").next().unwrap_or_default();
        let Some(k) = printed[at..].iter().position(|printed| printed.trim().starts_with(label)) else {
            return line.clone();
        };
        at += k + 1;
        printed[at - 1].clone()
    };
    let between = shown[first..=last].iter().map(|line| if line == ELISION { line.clone() } else { labelled(line) });
    [&printed[..head], &between.collect::<Vec<_>>(), &printed[printed.len() - tail..]].concat()
}

/// Runs all commands of a page; the differences between what it shows and what is printed, and the number of commands.
pub fn check(page: &Page) -> (String, usize) {
    let blocks: Vec<_> = page.blocks().into_iter().filter(|block| block.language == "console").collect();
    if blocks.is_empty() {
        return (String::new(), 0);
    }
    let folder = folder_of(page);
    let mut lines: Vec<String> = page.text.lines().map(str::to_owned).collect();
    let mut edits = Vec::new();
    let (mut wrong, mut count) = (String::new(), 0);
    for block in blocks {
        let starts: Vec<usize> = (0..block.lines.len()).filter(|&k| block.lines[k].starts_with("$ ")).collect();
        assert_eq!(starts.first(), Some(&0), "{}: a block without a command", page.path.display());
        for (k, &start) in starts.iter().enumerate() {
            let end = starts.get(k + 1).copied().unwrap_or(block.lines.len());
            let (command, shown) = (&block.lines[start][2..], &block.lines[start + 1..end]);
            let interrupted_at =
                shown.iter().find_map(|line| line.strip_prefix("interrupted: the frames so far are in "));
            let (code, printed) = run_until(folder.path(), command, interrupted_at);
            count += 1;
            let is_error = |line: &String| line.starts_with("error") || line.contains("\"error\":{\"kind\"");
            let expected = match code {
                _ if interrupted_at.is_some() => code == Some(INTERRUPTED),
                Some(code) if shown.iter().any(is_error) => code != 0,
                _ => code == Some(0),
            };
            let place = format!("{}:{}: {command}", page.path.display(), block.first + start + 1);
            if !expected {
                let _ = writeln!(wrong, "{place}\nexit code: {code:?}\n{}", printed.join("\n"));
            }
            if let Some(line) = difference(shown, &printed).filter(|_| !shown.is_empty()) {
                let _ = writeln!(wrong, "{place}\n{line}\nis not in\n{}\n", printed.join("\n"));
                edits.push((block.first + start + 1..block.first + end, fresh(shown, &printed)));
            }
        }
    }
    if update() && !edits.is_empty() {
        for (range, fresh) in edits.into_iter().rev() {
            lines.splice(range, fresh);
        }
        std::fs::write(root().join(&page.path), lines.join("\n") + "\n").expect("the page");
        assert!(read(&page.path).len() > 1);
    }
    (wrong, count)
}
