//! Reading of TOML files with errors that state file, line, key, value and remedy.

mod allowed;
mod deprecated;
pub mod dimensions;
mod explain;
mod kind;
mod member;
mod parsed;

use std::ops::Range;
use std::path::Path;
use std::sync::Arc;

use crate::error::{Error, InputError, Place, Result};
use crate::text_file;
use crate::units::{Dimension, Quantity};

pub use allowed::Allowed;
pub use deprecated::DEPRECATED_KEYS;
pub use kind::FileKind;
pub(crate) use member::{Checked, equally_long, finite, member, optional, positive, positive_or_infinite};
pub use parsed::{GivenKey, Parsed, Table};

/// Number in a file, with its position.
pub type Number = toml::Spanned<Quantity>;

/// Text file that is read; creates all errors about its content.
#[derive(Debug, Clone)]
pub struct Document {
    /// Name shown in messages.
    pub file: String,
    /// Complete text.
    pub text: Arc<str>,
}

impl Document {
    /// Reads a file; a missing or unreadable file is an input error with a help line.
    pub fn read(path: &Path) -> Result<Self> {
        Ok(Self::new(path.display().to_string(), text_file::read(path)?))
    }

    /// Reads the record of an instrument; for the path `-`, standard input. Returns the encoding of the text if it is not UTF-8.
    ///
    /// # Errors
    /// An input error if the file cannot be read, or does not contain text.
    pub fn read_record(path: &Path) -> Result<(Self, Option<&'static str>)> {
        if path == Path::new("-") {
            return Ok((Self::read_scene(path)?, None));
        }
        let (text, encoding) = text_file::read_record(path)?;
        Ok((Self::new(path.display().to_string(), text), encoding))
    }

    /// Reads a scene from a file or, for the path `-`, from standard input.
    pub fn read_scene(path: &Path) -> Result<Self> {
        if path == Path::new("-") { Ok(Self::new("stdin", text_file::read_stdin("stdin")?)) } else { Self::read(path) }
    }

    /// Creates a document from text in memory.
    pub fn new(file: impl Into<String>, text: impl Into<Arc<str>>) -> Self {
        Self { file: file.into(), text: text.into() }
    }

    /// Returns an error at a span of this document.
    pub fn error(&self, span: Range<usize>, key: &str, message: impl Into<String>) -> InputError {
        InputError::new(message).key(key).at(self.place(span))
    }

    /// Returns a span of this document as the position of an error that was found elsewhere.
    pub fn place(&self, span: Range<usize>) -> Place {
        Place { file: self.file.clone(), text: self.text.clone(), span }
    }

    /// Converts and checks one number. `key` is dotted, as in `solve.cfl`.
    pub fn number(&self, value: &Number, key: &str, dimension: Dimension, allowed: Allowed) -> Result<f64> {
        let name = last_part(key);
        // Evaluated only for errors: files of histories contain a hundred thousand numbers.
        let range = || allowed.describe(name, dimension);
        let typed = value.get_ref();
        let si = typed.si(dimension).map_err(|reason| {
            self.error(value.span(), key, reason).allowed(range()).help(number_help(name, dimension))
        })?;
        if allowed.holds(si) {
            dimensions::note(self, &value.span(), dimension);
            return self.of_possible_magnitude(value, si, key, dimension, allowed);
        }
        let help = match allowed {
            Allowed::Finite => format!("e.g. {name} = \"{}\"", dimension.example()),
            Allowed::Positive => format!("set `{name}` to a value above zero"),
            Allowed::NotNegative => format!("set `{name}` to zero or a positive value"),
            Allowed::Within(..) | Allowed::Above(..) | Allowed::Between(..) | Allowed::Below(..) => {
                format!("set `{name}` to a value in the allowed range")
            }
        };
        Err(self.error(value.span(), key, format!("{typed} is out of range")).allowed(range()).help(help).into())
    }

    /// Converts and checks a number of the text; its key is determined from its position.
    pub fn number_at(&self, value: &Number, dimension: Dimension, allowed: Allowed) -> Result<f64> {
        self.number_under(value, || self.key_at(&value.span()), dimension, allowed)
    }

    /// Converts and checks a number; `key` is called only if there is an error, for its message.
    pub fn number_under(
        &self,
        value: &Number,
        key: impl Fn() -> String,
        dimension: Dimension,
        allowed: Allowed,
    ) -> Result<f64> {
        self.number(value, "", dimension, allowed).or_else(|_| self.number(value, &key(), dimension, allowed))
    }

    /// Refuses values outside the range of meaningful magnitudes.
    fn of_possible_magnitude(
        &self,
        value: &Number,
        si: f64,
        key: &str,
        dimension: Dimension,
        allowed: Allowed,
    ) -> Result<f64> {
        let Some(bounds) = allowed.impossible(last_part(key), si, dimension) else { return Ok(si) };
        let message = format!("{} is beyond the range of {}", value.get_ref(), dimension.describe());
        let help = format!("check the number and its unit: {}", dimension.magnitudes().reason);
        Err(self.error(value.span(), key, message).allowed(bounds).help(help).into())
    }

    /// Reads a whole number of the text within `low..=high`; 1e5 is also a whole number.
    pub fn count_at(&self, value: &Number, low: usize, high: usize) -> Result<usize> {
        let range = Allowed::Within(low as f64, high as f64);
        let is_number = || value.get_ref().si(Dimension::None).is_ok();
        let number = self.number_at(value, Dimension::None, range).map_err(|error| match error {
            Error::Input(e) if !is_number() => {
                let help = format!("write a whole number, e.g. {} = {}", last_part(&e.key), 1000.clamp(low, high));
                e.help(help).into()
            }
            other => other,
        })?;
        if number.fract() == 0.0 {
            return Ok(number as usize);
        }
        let key = self.key_at(&value.span());
        let allowed = format!("{}, a whole number", range.describe(last_part(&key), Dimension::None));
        let error = self.error(value.span(), &key, format!("{number} is not a whole number")).allowed(allowed);
        Err(error.help(format!("write e.g. {} = {}", last_part(&key), number.round())).into())
    }
}

/// Returns the word of a list that is most similar to `word`; `None` if none is similar.
pub fn nearest<'a>(word: &str, known: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    let plain = |text: &str| text.to_lowercase().replace('_', "-");
    let word = plain(word);
    known
        .into_iter()
        .map(|k| (strsim::jaro_winkler(&plain(k), &word), k))
        .filter(|(likeness, _)| *likeness > 0.78)
        .max_by(|a, b| a.0.total_cmp(&b.0))
        .map(|(_, k)| k)
}

/// Returns the last part of a dotted key that is not an index, which is the name of the value in ranges.
fn last_part(key: &str) -> &str {
    key.rsplit('.').find(|part| part.parse::<usize>().is_err()).unwrap_or(key)
}

fn number_help(name: &str, dimension: Dimension) -> String {
    match dimension.si_symbol() {
        "" => format!("write a plain number, e.g. {name} = {}", dimension.example()),
        symbol => format!("write e.g. {name} = \"{}\"; a plain number is in {symbol}", dimension.example()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_out_of_range_show_value_and_range() {
        let document = Document::new("test.toml", "cfl = 1.5\n");
        let value = Number::new(6..9, Quantity::Number(1.5));
        let range = Allowed::Above(0.0, 1.0);
        let Err(Error::Input(error)) = document.number(&value, "solve.cfl", Dimension::None, range) else {
            panic!("1.5 was accepted");
        };
        assert_eq!(error.to_string(), "test.toml:1: `solve.cfl`: 1.5 is out of range (allowed: 0 < cfl <= 1)");
        assert!(!error.help.is_empty());
    }

    #[test]
    fn a_missing_file_is_an_input_error() {
        let Err(error) = Document::read(Path::new("no/such/scene.toml")) else { panic!("there is one") };
        assert_eq!(error.exit_code(), 2);
        assert!(error.to_string().contains("no such file"), "{error}");
    }
}
