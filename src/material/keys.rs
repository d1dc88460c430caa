//! The keys of a material in a document: full names, numbers, and errors at their position.

use std::ops::Range;
use std::path::Path;

use crate::error::{Error, InputError, Result};
use crate::input::{Allowed, Document, Number};
use crate::typed::Key;
use crate::units::Dimension;

/// A document with the position of a material in it.
#[derive(Debug, Clone, Copy)]
pub(super) struct Keys<'a> {
    pub(super) doc: &'a Document,
    pub(super) prefix: &'a str,
    /// Folder to which the paths of CSV files are relative.
    pub(super) base_dir: &'a Path,
}

impl Keys<'_> {
    pub(super) fn key(&self, key: &str) -> String {
        if self.prefix.is_empty() { key.to_owned() } else { format!("{}.{key}", self.prefix) }
    }

    pub(super) fn error(&self, span: Range<usize>, key: &str, message: impl Into<String>) -> InputError {
        self.doc.error(span, &self.key(key), message)
    }

    /// Returns the position of the value of a key; `None` if the text does not have this key.
    pub(super) fn span_of(&self, key: &str) -> Option<Range<usize>> {
        self.doc.span_of(&self.key(key))
    }

    pub(super) fn si<K: Key>(&self, key: &K) -> Result<K::Si> {
        key.si(self.doc, false)
    }

    pub(super) fn number(&self, value: &Number, key: &str, dimension: Dimension, allowed: Allowed) -> Result<f64> {
        self.doc.number(value, &self.key(key), dimension, allowed)
    }

    /// Returns a number in a row of a table, as [`Keys::number`] does; an error also states the row, counted from 1.
    pub(super) fn number_in_row(
        &self,
        value: &Number,
        (table, row, column): (&str, usize, &str),
        dimension: Dimension,
        allowed: Allowed,
    ) -> Result<f64> {
        self.number(value, &format!("{table}.{row}.{column}"), dimension, allowed).map_err(|error| match error {
            Error::Input(e) => InputError { message: format!("row {}: {}", row + 1, e.message), ..e }.into(),
            other => other,
        })
    }
}
