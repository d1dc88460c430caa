//! Errors in tables of rows: histories, values over x, tapers.

use crate::error::{Error, InputError};

/// A rule that a row of a table violates. The message counts rows from 1, as in files; the [`InputError`] made from it counts from 0.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct RowError {
    /// First row (from 0) that violates the rule; `None` if the table has no rows.
    pub row: Option<usize>,
    /// Violated rule, in words that follow "row 3"; a complete sentence if there is no row.
    pub rule: &'static str,
}

impl RowError {
    /// Returns the error of a row (from 0).
    pub(crate) fn of(row: usize, rule: &'static str) -> Self {
        Self { row: Some(row), rule }
    }

    /// Returns the row (from 0) at which the error is reported.
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
