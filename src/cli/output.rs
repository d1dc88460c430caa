//! Output of commands to stdout (plain text, aligned tables, JSON) and to stderr.

use std::io::Write;
use std::path::{Path, PathBuf};
use std::sync::Mutex;

use serde::Serialize;

pub(crate) use super::width::table;
use super::{settings, width};
use crate::destination;
use crate::error::{Error, InputError, Result};
use crate::record::store;
use crate::report::is_own;

/// Writes text to stdout, wrapped at its width. A closed pipe (`barwave ... | head`) is not an error.
pub(crate) fn text(text: &str) -> Result<()> {
    match width::of_stdout() {
        Some(width) => bytes(width::wrap(text, width).as_bytes()),
        None => bytes(text.as_bytes()),
    }
}

/// Writes bytes to stdout, as [`text`] does.
pub(crate) fn bytes(bytes: &[u8]) -> Result<()> {
    let mut stdout = std::io::stdout().lock();
    match stdout.write_all(bytes).and_then(|()| stdout.flush()) {
        Err(e) if e.kind() != std::io::ErrorKind::BrokenPipe => Err(destination::cannot_print(&e)),
        _ => Ok(()),
    }
}

/// Writes text to stderr. Write errors are ignored: they do not affect the exit code.
pub(crate) fn note(text: &str) {
    let _ = std::io::stderr().lock().write_all(text.as_bytes());
}

/// Remarks on an error that has not been shown yet, for its JSON object.
static REMARKS: Mutex<Vec<String>> = Mutex::new(Vec::new());

/// Adds a remark to an error or an interruption that is about to be shown: lines on stderr, or with `--json` the `notes` of the error's object.
pub(crate) fn remark(text: &str) {
    if !settings::json() {
        return note(text);
    }
    if let Ok(mut remarks) = REMARKS.lock() {
        remarks.extend(text.lines().map(str::to_owned));
    }
}

/// Returns the remarks since the last call.
pub(crate) fn take_remarks() -> Vec<String> {
    REMARKS.lock().map(|mut remarks| std::mem::take(&mut *remarks)).unwrap_or_default()
}

/// Returns a path quoted for a shell.
pub(crate) fn shell_word(path: &Path) -> String {
    let plain = |c: char| c.is_alphanumeric() || "/._-+=,:@".contains(c);
    let shown = path.display().to_string();
    if shown.chars().all(plain) { shown } else { format!("'{}'", shown.replace('\'', "'\\''")) }
}

/// Returns the default folder of results: `runs/out` if there is a folder `runs`, else `beside`.
pub(crate) fn default_folder(beside: &Path) -> PathBuf {
    if Path::new("runs").is_dir() { PathBuf::from("runs/out") } else { beside.to_owned() }
}

/// Returns the name of the program with its version and, if known, its commit.
pub(crate) fn program() -> String {
    let revision = store::git_revision().map(|revision| format!(" ({revision})")).unwrap_or_default();
    format!("barwave {}{revision}", env!("CARGO_PKG_VERSION"))
}

/// Version of the layout of all JSON output, `schema_version`. It changes when a member is renamed or removed, or changes its meaning.
pub(crate) const SCHEMA_VERSION: u32 = 1;

/// A JSON object with the version of its layout.
#[derive(Debug, Serialize)]
struct Versioned<'a, T> {
    schema_version: u32,
    #[serde(flatten)]
    value: &'a T,
}

impl<'a, T> Versioned<'a, T> {
    fn new(value: &'a T) -> Self {
        Self { schema_version: SCHEMA_VERSION, value }
    }
}

fn failed(error: serde_json::Error) -> Error {
    Error::file(Path::new("stdout"), error)
}

/// Writes one JSON object and a line end to stdout.
pub(crate) fn json(value: &impl Serialize) -> Result<()> {
    bytes(json_text(value)?.as_bytes())
}

/// Returns one JSON object and a line end.
pub(crate) fn json_text(value: &impl Serialize) -> Result<String> {
    Ok(serde_json::to_string_pretty(&Versioned::new(value)).map_err(failed)? + "\n")
}

/// Writes one JSON list of objects and a line end to stdout.
pub(crate) fn json_list<T: Serialize>(values: &[T]) -> Result<()> {
    let values: Vec<Versioned<T>> = values.iter().map(Versioned::new).collect();
    bytes((serde_json::to_string_pretty(&values).map_err(failed)? + "\n").as_bytes())
}

/// Writes one JSON object as a line to stdout.
pub(crate) fn json_line(value: &impl Serialize) -> Result<()> {
    bytes((serde_json::to_string(&Versioned::new(value)).map_err(failed)? + "\n").as_bytes())
}

/// Checks that the outputs can be written and that at most one goes to standard output, before any work is done.
pub(crate) fn check<'a>(json: bool, files: impl IntoIterator<Item = Option<&'a Path>>) -> Result<()> {
    let mut on_stdout = usize::from(json);
    for file in files.into_iter().flatten() {
        if destination::is_stdout(file) {
            on_stdout += 1;
        } else {
            destination::resolve(file)?;
        }
    }
    if on_stdout < 2 {
        return Ok(());
    }
    let error = InputError::new("two outputs cannot both go to standard output (`-`, --json)");
    Err(error.help("name a file for one of them").into())
}

/// Refuses a figure or table at a path with a file that this program did not write; `force` allows it. Tables start with the line `heading`.
pub(crate) fn check_replaced(path: &Path, heading: Option<&str>, force: bool) -> Result<()> {
    if force || destination::is_stdout(path) || !path.exists() || is_own(path, heading) {
        return Ok(());
    }
    let error =
        InputError::new(format!("`{}` exists already and was not written by barwave", path.display())).key("-o");
    Err(error.help("name another file with -o, or overwrite it with --force").into())
}

/// Writes text to stdout, or to stderr if one of the outputs goes to stdout.
pub(crate) fn text_beside<'a>(files: impl IntoIterator<Item = Option<&'a Path>>, said: &str) -> Result<()> {
    if files.into_iter().flatten().any(destination::is_stdout) {
        note(said);
        return Ok(());
    }
    text(said)
}

/// Returns the message that a file was written, or `None` for standard output.
pub(crate) fn wrote(path: &Path) -> Option<String> {
    (!destination::is_stdout(path)).then(|| format!("wrote {}", path.display()))
}

/// Reports the files that were written: as this text, or as a JSON list of paths.
pub(crate) fn written(paths: &[&Path], said: &str) -> Result<()> {
    if !settings::json() {
        return text(said);
    }
    let paths: Vec<String> = paths.iter().map(|path| path.display().to_string()).collect();
    json(&serde_json::json!({ "output": paths }))
}

/// Writes one JSON object as a line to stderr.
pub(crate) fn json_note(value: &impl Serialize) {
    // Serialization errors are ignored.
    let _ = serde_json::to_string(&Versioned::new(value)).map(|line| note(&(line + "\n")));
}

/// Returns true if a file has this ending or is standard output.
pub(crate) fn has_ending(path: &Path, ending: &str) -> bool {
    destination::is_stdout(path) || path.extension().is_some_and(|own| own.eq_ignore_ascii_case(ending))
}

/// Returns true if a file is a table, by its name.
pub(crate) fn is_csv(path: &Path) -> bool {
    has_ending(path, "csv")
}

/// Returns a number with `digits` decimals, or a dash. A value that rounds to zero has no sign.
pub(crate) fn fixed(value: Option<f64>, digits: usize) -> String {
    let text = value.map_or_else(|| "-".into(), |v| format!("{v:.digits$}"));
    let zero = text.strip_prefix('-').filter(|rest| !rest.is_empty() && rest.chars().all(|c| c == '0' || c == '.'));
    zero.map_or(text.clone(), str::to_owned)
}

/// Returns a count with its noun: "1 case", "2 cases".
pub(crate) fn counted(count: usize, thing: &str) -> String {
    if count == 1 { format!("1 {thing}") } else { format!("{count} {thing}s") }
}
