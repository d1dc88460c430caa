//! Errors and their messages: what is wrong, where, the value, the allowed range, and a help line.

pub(crate) mod text;

use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Result of functions that read, check, run or write. `?` converts an [`InputError`], a [`RunError`] and the errors of a material's curve and
/// heating into its error.
///
/// A program whose `main` returns this type ends with the message of the command line ([`Error::text`]) if it fails.
pub type Result<T> = std::result::Result<T, Error>;

/// The reasons for which a command ends without its result.
///
/// `Display` writes one line, without the line of the file and without help; `Debug` writes [`Error::text`].
#[derive(thiserror::Error)]
pub enum Error {
    /// The input is wrong; exit code 2.
    #[error(transparent)]
    Input(#[from] InputError),
    /// The run was stopped by an error; exit code 1.
    #[error(transparent)]
    Run(#[from] RunError),
    /// A file could not be read or written; exit code 1 (a missing input file is an [`InputError`]).
    #[error("{}: {reason}", path.display())]
    File {
        /// The file.
        path: PathBuf,
        /// Reason reported by the system or the HDF5 library.
        reason: String,
        /// What to do; empty if unknown.
        help: String,
    },
    /// The results fail their checks; exit code 1.
    #[error("{0}")]
    Checks(String),
    /// The user asked to stop (Ctrl-C); exit code 130.
    #[error("interrupted")]
    Interrupted,
}

impl Error {
    /// Returns the exit code of the process for this kind of error.
    pub fn exit_code(&self) -> u8 {
        match self {
            Self::Input(_) => 2,
            Self::Run(_) | Self::File { .. } | Self::Checks(_) => 1,
            Self::Interrupted => 130,
        }
    }

    /// Returns the message of the command line: what is wrong, where (with the line of the file), what is allowed, and help.
    pub fn text(&self) -> String {
        text::lines(self, text::Paint(false)).trim_end().to_owned()
    }

    /// Creates a file error from any reason that can be displayed.
    pub fn file(path: &Path, reason: impl std::fmt::Display) -> Self {
        Self::File { path: path.to_owned(), reason: reason.to_string(), help: String::new() }
    }
}

impl std::fmt::Debug for Error {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(&self.text())
    }
}

/// Position of an error in a text file, shown together with the line of the file.
#[derive(Debug, Clone)]
pub struct Place {
    /// File name as shown.
    pub file: String,
    /// Whole text of the file.
    pub text: Arc<str>,
    /// Byte range of the text that the error refers to.
    pub span: std::ops::Range<usize>,
}

impl Place {
    /// Returns the line number of the start of the span, from 1.
    pub fn line(&self) -> usize {
        let start = self.span.start.min(self.text.len());
        self.text.as_bytes()[..start].split(|&b| b == b'\n').count()
    }
}

/// An error in the input: one sentence that says what is wrong, its position, and what is allowed.
///
/// Built with [`InputError::new`] and the methods below, in the order in which they are shown. `Display` writes one line, without the line of the
/// file and without help; `Debug` writes [`InputError::text`].
#[derive(Clone)]
pub struct InputError {
    /// What is wrong, with the value that was given.
    pub message: String,
    /// The key, dotted as in `solve.cells`; empty if there is none.
    pub key: String,
    /// Allowed values, e.g. "0 < cfl <= 1"; empty if a range has no meaning.
    pub allowed: String,
    /// What to do.
    pub help: String,
    /// Position of the error in the input.
    pub place: Option<Box<Place>>,
}

impl InputError {
    /// Creates an error from its sentence; the methods below add the rest.
    pub fn new(message: impl Into<String>) -> Self {
        Self { message: message.into(), key: String::new(), allowed: String::new(), help: String::new(), place: None }
    }

    /// Sets the key, dotted as in `solve.cells`.
    #[must_use]
    pub fn key(mut self, key: impl Into<String>) -> Self {
        self.key = key.into();
        self
    }

    /// Sets the allowed values.
    #[must_use]
    pub fn allowed(mut self, allowed: impl Into<String>) -> Self {
        self.allowed = allowed.into();
        self
    }

    /// Sets the help line.
    #[must_use]
    pub fn help(mut self, help: impl Into<String>) -> Self {
        self.help = help.into();
        self
    }

    /// Returns the message of the command line: what is wrong, where (with the line of the file), what is allowed, and help.
    pub fn text(&self) -> String {
        text::lines_of_input(self, text::Paint(false)).trim_end().to_owned()
    }

    /// Sets the position in the file.
    #[must_use]
    pub fn at(mut self, place: Place) -> Self {
        self.place = Some(Box::new(place));
        self
    }
}

impl std::fmt::Display for InputError {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        if let Some(place) = &self.place {
            write!(f, "{}:{}: ", place.file, place.line())?;
        }
        if !self.key.is_empty() {
            write!(f, "`{}`: ", self.key)?;
        }
        write!(f, "{}", self.message)?;
        if !self.allowed.is_empty() {
            write!(f, " (allowed: {})", self.allowed)?;
        }
        Ok(())
    }
}

impl std::fmt::Debug for InputError {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(&self.text())
    }
}

impl std::error::Error for InputError {}

/// An error that stopped a run: reason, time and position.
#[derive(Debug, Clone)]
pub struct RunError {
    /// Reason, with the values involved.
    pub reason: String,
    /// Simulated time, s.
    pub time: f64,
    /// Position on the bar, m; `None` if the error has no position.
    pub x: Option<f64>,
    /// What to do about it.
    pub help: String,
}

impl std::fmt::Display for RunError {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "the run stopped at t = {:.6e} s", self.time)?;
        if let Some(x) = self.x {
            write!(f, ", x = {x:.6e} m")?;
        }
        write!(f, ": {}", self.reason)
    }
}

impl std::error::Error for RunError {}
