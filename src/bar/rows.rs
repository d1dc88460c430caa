//! Errors of tables of rows: histories, values over x, tapers.

use crate::error::{Error, InputError};

/// A rule that the rows of a table break. Its message counts rows from 1, as in files, that of the [`InputError`] it becomes from 0.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct RowError {
    /// The first row (from 0) that breaks it; none where there is no row.
    pub row: Option<usize>,
    /// What is wrong, in words after "row 3"; a whole sentence where there is no row.
    pub rule: &'static str,
}

impl RowError {
    /// Of a row (from 0).
    pub(crate) fn of(row: usize, rule: &'static str) -> Self {
        Self { row: Some(row), rule }
    }

    /// The row (from 0) at which it is shown.
    pub(crate) fn at(self) -> usize {
        self.row.unwrap_or(0)
    }
}

impl std::fmt::Display for RowError {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self.row {
            Some(row) => write!(f, "row {} {}", row + 1, self.rule),
            None => f.write_str(self.rule),
        }
    }
}

impl std::error::Error for RowError {}

impl From<RowError> for InputError {
    fn from(error: RowError) -> Self {
        let message = error.row.map(|row| format!("row {row} (counted from 0) {}", error.rule));
        let error = Self::new(message.unwrap_or_else(|| error.rule.to_owned())).key("rows");
        error.help("check the rows, and their order")
    }
}

impl From<RowError> for Error {
    fn from(error: RowError) -> Self {
        InputError::from(error).into()
    }
}
