//! Errors and their messages: what, where, the value, the allowed range, and a help line.

pub(crate) mod text;

use std::path::{Path, PathBuf};
use std::sync::Arc;

/// What functions return that read, check, run or write; an [`InputError`], a [`RunError`] and the errors of a material's curve and heating
/// become its error by `?`.
///
/// In a program whose `main` returns it, a failure ends with the message of the command line ([`Error::text`]).
pub type Result<T> = std::result::Result<T, Error>;

/// The ways in which a command can end without its result.
///
/// `Display` is one line, without the line of the file and without help; `Debug` is [`Error::text`].
#[derive(thiserror::Error)]
pub enum Error {
    /// The input is wrong; exit code 2.
    #[error(transparent)]
    Input(#[from] InputError),
    /// The run was stopped by an error; exit code 1.
    #[error(transparent)]
    Run(#[from] RunError),
    /// A file could not be read or written; exit code 1 (an input file that is missing is an [`InputError`]).
    #[error("{}: {reason}", path.display())]
    File {
        /// The file.
        path: PathBuf,
        /// What the system or the HDF5 library said.
        reason: String,
        /// What to do; empty where nothing is known.
        help: String,
    },
    /// Results that do not satisfy what they must; exit code 1.
    #[error("{0}")]
    Checks(String),
    /// The user asked to stop (Ctrl-C); exit code 130.
    #[error("interrupted")]
    Interrupted,
}

impl Error {
    /// The process exit code that the contract gives to this kind of error.
    pub fn exit_code(&self) -> u8 {
        match self {
            Self::Input(_) => 2,
            Self::Run(_) | Self::File { .. } | Self::Checks(_) => 1,
            Self::Interrupted => 130,
        }
    }

    /// The message of the command line: what is wrong, where with the line of the file, what is allowed, and help.
    pub fn text(&self) -> String {
        text::lines(self, text::Paint(false)).trim_end().to_owned()
    }

    /// A file error from anything that can say what happened.
    pub fn file(path: &Path, reason: impl std::fmt::Display) -> Self {
        Self::File { path: path.to_owned(), reason: reason.to_string(), help: String::new() }
    }
}

impl std::fmt::Debug for Error {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(&self.text())
    }
}

/// Where in a text file an error lies: shown with the line of the file.
#[derive(Debug, Clone)]
pub struct Place {
    /// Name to show.
    pub file: String,
    /// The file's whole text.
    pub text: Arc<str>,
    /// Bytes of the text that are meant.
    pub span: std::ops::Range<usize>,
}

impl Place {
    /// Line number of the span's start, from 1.
    pub fn line(&self) -> usize {
        let start = self.span.start.min(self.text.len());
        self.text.as_bytes()[..start].split(|&b| b == b'\n').count()
    }
}

/// A wrong input: one clear sentence, its place, and what would be right.
///
/// Built with [`InputError::new`] and the methods below, in the order in which they are shown.
/// `Display` is one line, without the line of the file and without help; `Debug` is [`InputError::text`].
#[derive(Clone)]
pub struct InputError {
    /// What is wrong, with the value that was given.
    pub message: String,
    /// The key, dotted as in `solve.cells`; empty where there is none.
    pub key: String,
    /// What would be allowed, e.g. "0 < cfl <= 1"; empty where a range means nothing.
    pub allowed: String,
    /// What to do.
    pub help: String,
    /// Where it stands.
    pub place: Option<Box<Place>>,
}

impl InputError {
    /// An error with its sentence; the rest is added by the methods below.
    pub fn new(message: impl Into<String>) -> Self {
        Self { message: message.into(), key: String::new(), allowed: String::new(), help: String::new(), place: None }
    }

    /// Names the key, dotted as in `solve.cells`.
    #[must_use]
    pub fn key(mut self, key: impl Into<String>) -> Self {
        self.key = key.into();
        self
    }

    /// States what is allowed.
    #[must_use]
    pub fn allowed(mut self, allowed: impl Into<String>) -> Self {
        self.allowed = allowed.into();
        self
    }

    /// Says what to do.
    #[must_use]
    pub fn help(mut self, help: impl Into<String>) -> Self {
        self.help = help.into();
        self
    }

    /// The message of the command line: what is wrong, where with the line of the file, what is allowed, and help.
    pub fn text(&self) -> String {
        text::lines_of_input(self, text::Paint(false)).trim_end().to_owned()
    }

    /// Points at the place in the file.
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

/// The error that stopped a run: reason, time and place.
#[derive(Debug, Clone)]
pub struct RunError {
    /// Reason, with the values involved.
    pub reason: String,
    /// Simulated time, s.
    pub time: f64,
    /// Place on the bar, m; none if the error has no place.
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
