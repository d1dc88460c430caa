//! Reading of text files within limits of time and memory: regular files and pipes of at most [`MOST_BYTES`].

use std::cell::RefCell;
use std::fs::{File, Metadata};
use std::io::Read;
use std::path::Path;

use crate::error::InputError;
use crate::inputs;

/// Largest size of a text file that is read, bytes: a million rows of a record. A scene has a few kilobytes.
pub const MOST_BYTES: u64 = 64 << 20;

const TOO_LARGE: &str =
    "a scene or material is a text file of a few kilobytes; keep only every tenth or hundredth row of a long record";

/// The files that a scene names, with their contents, so that the scene can be read again if they have changed or are gone.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct NamedFiles {
    /// Folder of the scene.
    pub base: String,
    /// Folder of the user's materials.
    pub materials: Option<String>,
    /// Paths and contents.
    pub texts: Vec<(String, String)>,
}

/// Source of the files that a thread reads.
#[derive(Debug, Default)]
enum Reading {
    /// Files are read from the disk.
    #[default]
    Plain,
    /// Files are read from the disk, and their paths and contents are recorded.
    Recorded(Vec<(String, String)>),
    /// Only these files exist.
    Stored(NamedFiles),
}

thread_local! {
    // A thread-local, because materials and histories are read deep inside the checks of a scene; a parameter would pass through all of them.
    static READING: RefCell<Reading> = const { RefCell::new(Reading::Plain) };
}

/// Restores the previous source when it is dropped.
struct Scope(Reading);

impl Scope {
    fn enter(reading: Reading) -> Self {
        Self(READING.replace(reading))
    }
}

impl Drop for Scope {
    fn drop(&mut self) {
        READING.replace(std::mem::take(&mut self.0));
    }
}

/// Returns the result of `read` and the files that it read.
pub fn recorded<T>(read: impl FnOnce() -> T) -> (T, Vec<(String, String)>) {
    if let Some(stored) = of_store(|files| files.texts.clone()) {
        return (read(), stored);
    }
    let scope = Scope::enter(Reading::Recorded(Vec::new()));
    let result = read();
    let texts = READING.with_borrow_mut(|reading| match reading {
        Reading::Recorded(texts) => std::mem::take(texts),
        Reading::Plain | Reading::Stored(_) => Vec::new(),
    });
    drop(scope);
    // An enclosing recording has read these files, too.
    for (path, text) in &texts {
        record(path, text);
    }
    (result, texts)
}

fn record(path: &str, text: &str) {
    READING.with_borrow_mut(|reading| {
        if let Reading::Recorded(texts) = reading
            && texts.iter().all(|(known, _)| known != path)
        {
            texts.push((path.to_owned(), text.to_owned()));
        }
    });
}

/// Returns the result of `read` if only these files exist.
pub fn stored<T>(files: NamedFiles, read: impl FnOnce() -> T) -> T {
    let _scope = Scope::enter(Reading::Stored(files));
    read()
}

/// Queries the stored files; `None` if files are read from the disk.
pub fn of_store<T>(get: impl FnOnce(&NamedFiles) -> T) -> Option<T> {
    READING.with_borrow(|reading| match reading {
        Reading::Stored(files) => Some(get(files)),
        Reading::Plain | Reading::Recorded(_) => None,
    })
}

/// Whether the path is a regular file.
pub fn is_file(path: &Path) -> bool {
    let shown = path.display().to_string();
    of_store(|files| files.texts.iter().any(|(stored, _)| *stored == shown)).unwrap_or_else(|| path.is_file())
}

/// Returns the text of a file, without a byte-order mark.
///
/// # Errors
/// The file cannot be read or is not UTF-8 text of at most [`MOST_BYTES`].
pub fn read(path: &Path) -> Result<String, InputError> {
    let text = match from_store(path) {
        Some(stored) => stored?,
        None => from_disk(path)?,
    };
    record(&path.display().to_string(), &text);
    Ok(text)
}

/// Returns the text of a stored file; `None` if files are read from the disk.
fn from_store(path: &Path) -> Option<Result<String, InputError>> {
    let shown = path.display().to_string();
    let text = of_store(|files| files.texts.iter().find(|(stored, _)| *stored == shown).map(|(_, text)| text.clone()))?;
    let missing = || cannot_read(&shown, "it was not stored with the scene", "give the path of the scene again");
    Some(text.ok_or_else(missing))
}

/// Returns the text of an instrument's record, and its encoding if it is not UTF-8: UTF-16 with a byte-order mark, or Latin-1, in which any bytes
/// are text.
///
/// # Errors
/// As for [`read`].
pub fn read_record(path: &Path) -> Result<(String, Option<&'static str>), InputError> {
    let (text, encoding) = match from_store(path) {
        Some(stored) => (stored?, None),
        None => record_from_disk(path)?,
    };
    record(&path.display().to_string(), &text);
    Ok((text, encoding))
}

fn record_from_disk(path: &Path) -> Result<(String, Option<&'static str>), InputError> {
    let bytes = bytes_of(path)?;
    if let Some(text) = utf16(&bytes) {
        return Ok((text, Some("UTF-16")));
    }
    if !bytes.contains(&0) && std::str::from_utf8(&bytes).is_err() {
        return Ok((bytes.into_iter().map(char::from).collect(), Some("Latin-1")));
    }
    Ok((decode(bytes, &path.display().to_string())?, None))
}

/// Decodes text after a UTF-16 byte-order mark; `None` without the mark or if the rest is not UTF-16.
fn utf16(bytes: &[u8]) -> Option<String> {
    let unit = match bytes.get(..2)? {
        [0xFF, 0xFE] => u16::from_le_bytes,
        [0xFE, 0xFF] => u16::from_be_bytes,
        _ => return None,
    };
    let units: Vec<u16> = bytes[2..].chunks_exact(2).map(|pair| unit([pair[0], pair[1]])).collect();
    String::from_utf16(&units).ok()
}

fn from_disk(path: &Path) -> Result<String, InputError> {
    decode(bytes_of(path)?, &path.display().to_string())
}

fn bytes_of(path: &Path) -> Result<Vec<u8>, InputError> {
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
    inputs::protect(path);
    bounded(File::open(path).map_err(failed)?, &shown)
}

/// Returns the text on standard input, without a byte-order mark; `shown` names it in messages.
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
    log::info!("read {shown}: {} bytes", bytes.len());
    Ok(bytes)
}

fn too_large(shown: &str, size: &str) -> InputError {
    InputError::new(format!("`{shown}` is too large: {size}"))
        .allowed(format!("at most {} MiB", MOST_BYTES >> 20))
        .help(TOO_LARGE)
}

/// First bytes of every HDF5 file.
pub const HDF5_SIGNATURE: [u8; 8] = *b"\x89HDF\r\n\x1a\n";

/// Returns the first bytes of a file, as many as the signature of HDF5 has.
///
/// # Errors
/// The file cannot be read.
pub fn signature(path: &Path) -> std::io::Result<Vec<u8>> {
    let mut start = Vec::new();
    File::open(path)?.take(HDF5_SIGNATURE.len() as u64).read_to_end(&mut start)?;
    Ok(start)
}

/// Returns true if the path is a regular file that starts with the signature of HDF5.
pub fn is_hdf5(path: &Path) -> bool {
    path.is_file() && signature(path).is_ok_and(|start| start == HDF5_SIGNATURE)
}

fn decode(bytes: Vec<u8>, shown: &str) -> Result<String, InputError> {
    if bytes.starts_with(&[0xFF, 0xFE]) || bytes.starts_with(&[0xFE, 0xFF]) {
        return Err(InputError::new(format!("`{shown}` is UTF-16 text, not UTF-8")).help("save the file as UTF-8"));
    }
    if bytes.starts_with(&HDF5_SIGNATURE) {
        let message = format!("`{shown}` is an HDF5 file, not a text file");
        return Err(
            InputError::new(message).help("name a text file; `barwave report` and `barwave compare` read result files")
        );
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

/// Reports the first byte that is not UTF-8, and the character that it is in Latin-1, the encoding of most such files.
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

/// Returns the system's reason why a file cannot be read, in plain words.
pub fn plain_reason(error: &std::io::Error) -> String {
    match error.kind() {
        std::io::ErrorKind::NotFound => "no such file".into(),
        std::io::ErrorKind::NotADirectory => "it is not a folder".into(),
        std::io::ErrorKind::IsADirectory => "it is a folder".into(),
        std::io::ErrorKind::PermissionDenied => "permission denied".into(),
        _ => error.to_string(),
    }
}

/// Returns the reason why this cannot be read as a file, and what to do; `None` for regular files and for pipes that a shell has opened. A named
/// pipe is refused, because opening one without a writer never returns.
fn unreadable(path: &Path, metadata: &Metadata) -> Option<(&'static str, &'static str)> {
    const USE_STDIN: &str = "name a file, or `-` for standard input";
    if metadata.is_dir() {
        return Some(("it is a folder", "name a file in it"));
    }
    if metadata.is_file() {
        return None;
    }
    match special(metadata) {
        // A pipe that a shell has opened has no path in the file system, only a descriptor.
        "named pipe" if path.starts_with("/dev") || std::fs::canonicalize(path).is_err() => None,
        "named pipe" => Some(("it is a named pipe (FIFO)", USE_STDIN)),
        "device" => Some(("it is a device", USE_STDIN)),
        _ => Some(("it is neither a file nor a pipe", USE_STDIN)),
    }
}

/// Returns the kind of something that is neither a regular file nor a folder: "named pipe", "device" or "socket".
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

/// Returns the kind of something that is neither a regular file nor a folder.
#[cfg(not(unix))]
pub fn special(_: &Metadata) -> &'static str {
    "device"
}
