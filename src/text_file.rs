//! Text files that a user names, read within bounds of time and memory: regular files and pipes of at most [`MOST_BYTES`].

use std::fs::{File, Metadata};
use std::io::Read;
use std::path::Path;

use crate::error::InputError;

/// Largest text that is read, bytes: a million rows of a record. A scene has some kilobytes.
pub const MOST_BYTES: u64 = 64 << 20;

const TOO_LARGE: &str =
    "a scene or material is a text file of some kilobytes; write only every tenth or hundredth row of a long record";

/// The text of a file, without a byte-order mark.
///
/// # Errors
/// What the file is instead of a text of at most [`MOST_BYTES`] in UTF-8.
pub fn read(path: &Path) -> Result<String, InputError> {
    let shown = path.display().to_string();
    let failed = |e: std::io::Error| cannot_read(&shown, &plain_reason(&e), help_for(e.kind()));
    let metadata = std::fs::metadata(path).map_err(failed)?;
    if let Some((what, help)) = unreadable(path, &metadata) {
        return Err(cannot_read(&shown, what, help));
    }
    if metadata.is_file() && metadata.len() > MOST_BYTES {
        let size = metadata.len().div_ceil(1 << 20);
        return Err(too_large(&shown, &format!("{size} MiB")));
    }
    let bytes = bounded(File::open(path).map_err(failed)?, &shown)?;
    decode(bytes, &shown)
}

/// The text on standard input, without a byte-order mark; `shown` names it in messages.
///
/// # Errors
/// As for [`read`].
pub fn read_stdin(shown: &str) -> Result<String, InputError> {
    decode(bounded(std::io::stdin().lock(), shown)?, shown)
}

fn bounded(source: impl Read, shown: &str) -> Result<Vec<u8>, InputError> {
    let mut bytes = Vec::new();
    let failed = |e: std::io::Error| cannot_read(shown, &plain_reason(&e), help_for(e.kind()));
    source.take(MOST_BYTES + 1).read_to_end(&mut bytes).map_err(failed)?;
    if bytes.len() as u64 > MOST_BYTES {
        return Err(too_large(shown, &format!("more than {} MiB", MOST_BYTES >> 20)));
    }
    Ok(bytes)
}

fn too_large(shown: &str, size: &str) -> InputError {
    InputError::new(format!("`{shown}` is too large: {size}"))
        .allowed(format!("at most {} MiB", MOST_BYTES >> 20))
        .help(TOO_LARGE)
}

fn decode(bytes: Vec<u8>, shown: &str) -> Result<String, InputError> {
    if bytes.starts_with(&[0xFF, 0xFE]) || bytes.starts_with(&[0xFE, 0xFF]) {
        return Err(InputError::new(format!("`{shown}` is UTF-16 text, not UTF-8")).help("save the file as UTF-8"));
    }
    let line_of = |bytes: &[u8]| bytes.split(|&b| b == b'\n').count();
    if let Some(at) = bytes.iter().position(|&b| b == 0) {
        let line = line_of(&bytes[..at]);
        let message = format!("`{shown}` is not a text file: it has a zero byte on line {line}");
        return Err(InputError::new(message).help("name a text file"));
    }
    let mut text = String::from_utf8(bytes).map_err(|e| not_utf8(shown, &e))?;
    if text.starts_with('\u{feff}') {
        text.drain(..'\u{feff}'.len_utf8());
    }
    Ok(text)
}

/// Names the first byte that is not UTF-8, and the character that it is in Latin-1, which most such files are written in.
fn not_utf8(shown: &str, error: &std::string::FromUtf8Error) -> InputError {
    let at = error.utf8_error().valid_up_to();
    let (before, byte) = (&error.as_bytes()[..at], error.as_bytes()[at]);
    let line = before.split(|&b| b == b'\n').count();
    let start = before.iter().rposition(|&b| b == b'\n').map_or(0, |i| i + 1);
    let column = String::from_utf8_lossy(&before[start..]).chars().count() + 1;
    let latin = if byte < 0xA0 { String::new() } else { format!(", which is `{}` in Latin-1", char::from(byte)) };
    InputError::new(format!(
        "`{shown}` is not UTF-8 text: line {line}, column {column} has the byte 0x{byte:02X}{latin}"
    ))
    .help("save the file as UTF-8 (on the command line: iconv -f latin1 -t utf-8)")
}

fn cannot_read(shown: &str, reason: &str, help: &str) -> InputError {
    InputError::new(format!("cannot read `{shown}`: {reason}")).help(help)
}

fn help_for(kind: std::io::ErrorKind) -> &'static str {
    match kind {
        std::io::ErrorKind::NotFound => "check the spelling and the folder you are in",
        std::io::ErrorKind::IsADirectory => "name a file in it",
        _ => "check that the file may be read",
    }
}

fn plain_reason(error: &std::io::Error) -> String {
    match error.kind() {
        std::io::ErrorKind::NotFound => "there is no such file".into(),
        std::io::ErrorKind::IsADirectory => "it is a folder".into(),
        std::io::ErrorKind::PermissionDenied => "permission denied".into(),
        _ => error.to_string(),
    }
}

/// What keeps this from being read as a file, and what to do; none of regular files and of pipes that a shell has opened. A named
/// pipe is refused: opening one that nobody writes to never returns.
fn unreadable(path: &Path, metadata: &Metadata) -> Option<(&'static str, &'static str)> {
    const USE_STDIN: &str = "name a file, or `-` for a scene on standard input";
    if metadata.is_dir() {
        return Some(("it is a folder", "name a file in it"));
    }
    if metadata.is_file() {
        return None;
    }
    match special(metadata) {
        // What a shell has opened has no place in the file system, only a descriptor.
        "named pipe" if path.starts_with("/dev") || std::fs::canonicalize(path).is_err() => None,
        "named pipe" => Some(("it is a named pipe (FIFO)", USE_STDIN)),
        "device" => Some(("it is a device", USE_STDIN)),
        _ => Some(("it is neither a file nor a pipe", USE_STDIN)),
    }
}

/// What something is that is neither a regular file nor a folder: "named pipe", "device" or "socket".
#[cfg(unix)]
pub fn special(metadata: &Metadata) -> &'static str {
    use std::os::unix::fs::FileTypeExt;
    let kind = metadata.file_type();
    if kind.is_fifo() {
        "named pipe"
    } else if kind.is_char_device() || kind.is_block_device() {
        "device"
    } else {
        "socket"
    }
}

/// What something is that is neither a regular file nor a folder.
#[cfg(not(unix))]
pub fn special(_: &Metadata) -> &'static str {
    "device"
}
