//! Reading a TOML file so that every complaint can name file, line, key, value and what would be right.

use std::ops::Range;
use std::path::Path;
use std::sync::Arc;

use serde::de::DeserializeOwned;

use crate::error::{InputError, Place, Result};
use crate::units::{Dimension, Quantity};

/// A number in a file, with its place.
pub type Number = toml::Spanned<Quantity>;

/// A text file being read; every error of its content is made here.
#[derive(Debug, Clone)]
pub struct Document {
    /// Name to show.
    pub file: String,
    /// Whole text.
    pub text: Arc<str>,
}

/// An allowed range, shown as the user would write it.
#[derive(Debug, Clone, Copy)]
pub enum Allowed {
    /// Any finite number.
    Finite,
    /// > 0.
    Positive,
    /// >= 0.
    NotNegative,
    /// low..=high.
    Within(f64, f64),
    /// low < value <= high.
    Above(f64, f64),
}

impl Document {
    /// Reads a file; a missing or unreadable one is an input error with a help line.
    pub fn read(path: &Path) -> Result<Self> {
        let _ = path;
        todo!()
    }

    /// A document from text in memory.
    pub fn new(file: impl Into<String>, text: impl Into<Arc<str>>) -> Self {
        Self { file: file.into(), text: text.into() }
    }

    /// Parses into a serde mirror. An unknown key names the nearest right one; a syntax error keeps its line.
    pub fn parse<T: DeserializeOwned>(&self) -> Result<T> {
        todo!()
    }

    /// An error at a span of this document.
    pub fn error(&self, span: Range<usize>, key: &str, message: impl Into<String>) -> InputError {
        InputError::new(message).key(key).at(Place { file: self.file.clone(), text: self.text.clone(), span })
    }

    /// Converts and checks one number. `key` is dotted, as in `solve.cfl`.
    pub fn number(&self, value: &Number, key: &str, dimension: Dimension, allowed: Allowed) -> Result<f64> {
        let _ = (value, key, dimension, allowed);
        todo!()
    }
}
