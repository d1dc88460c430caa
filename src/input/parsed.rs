//! Tables of a TOML text, which is parsed only once.

use std::ops::Range;

use serde::de::DeserializeOwned;
use toml::Spanned;
use toml::de::{DeTable, DeValue, Deserializer, ValueDeserializer};

use super::Document;
use super::deprecated::present;
use crate::error::Result;

/// Key of a table, with its position and that of its value.
#[derive(Debug, Clone)]
pub struct GivenKey {
    /// Name of the key.
    pub name: String,
    /// Position of the key.
    pub key: Range<usize>,
    /// Position of its value.
    pub value: Range<usize>,
}

/// Document parsed as TOML.
#[derive(Debug)]
pub struct Parsed<'a> {
    document: &'a Document,
    root: Spanned<DeTable<'a>>,
}

/// Value of a top-level key; a table, unless the scene is wrong.
#[derive(Debug)]
pub struct Table<'a> {
    document: &'a Document,
    value: Spanned<DeValue<'a>>,
}

impl Document {
    /// Parses the text. A syntax error retains its line.
    ///
    /// # Errors
    /// An input error if the text is not valid TOML.
    pub fn parsed(&self) -> Result<Parsed<'_>> {
        let root = DeTable::parse(&self.text).map_err(|e| self.explain(&e))?;
        Ok(Parsed { document: self, root })
    }

    /// Parses the text into a type with a serde implementation.
    ///
    /// # Errors
    /// As for [`Document::parsed`] and [`Parsed::read`].
    pub fn parse<T: DeserializeOwned>(&self) -> Result<T> {
        self.parsed()?.read()
    }

    /// Returns the dotted key ("bar.segment.0.length") whose key or value contains a span; empty at the top level.
    pub fn key_at(&self, span: &Range<usize>) -> String {
        let Ok(table) = DeTable::parse(&self.text) else { return String::new() };
        let mut path = Vec::new();
        walk_table(table.get_ref(), span, &mut path);
        path.join(".")
    }

    /// Returns the position of the value of a dotted key; `None` if the text does not contain the key.
    pub fn span_of(&self, key: &str) -> Option<Range<usize>> {
        let table = DeTable::parse(&self.text).ok()?;
        let mut parts = key.split('.');
        let mut value = table.get_ref().get(parts.next()?)?;
        for part in parts {
            value = match value.get_ref() {
                DeValue::Table(table) => table.get(part)?,
                DeValue::Array(items) => items.get(part.parse::<usize>().ok()?)?,
                _ => return None,
            };
        }
        Some(value.span())
    }
}

impl<'a> Parsed<'a> {
    /// Returns whether there is a top-level key of this name.
    pub fn has(&self, key: &str) -> bool {
        self.root.get_ref().contains_key(key)
    }

    /// Iterates over the keys at the top level.
    pub fn keys(&self) -> impl Iterator<Item = &str> {
        self.root.get_ref().keys().map(|key| key.get_ref().as_ref())
    }

    /// Returns the keys of a top-level table under their present names, in the order of the text; empty if there is no such table.
    pub fn keys_in(&self, table: &str) -> Vec<GivenKey> {
        let mut given = self.root.get_ref().get(table).map_or_else(Vec::new, |value| keys(value.get_ref()));
        for key in &mut given {
            key.name = present(table, &key.name).to_owned();
        }
        given
    }

    /// Removes the value of a top-level key, which is read later when its type is known.
    pub fn take(&mut self, key: &str) -> Option<Table<'a>> {
        let value = self.root.get_mut().remove(key)?;
        Some(Table { document: self.document, value })
    }

    /// Reads everything that has not been removed into a type with a serde implementation.
    ///
    /// # Errors
    /// An input error with its position: an unknown key (the most similar known key is suggested), a missing key, or a wrong type.
    pub fn read<T: DeserializeOwned>(self) -> Result<T> {
        T::deserialize(Deserializer::from(self.root)).map_err(|e| self.document.explain(&e).into())
    }
}

impl Table<'_> {
    /// Returns the position of the value.
    pub fn span(&self) -> Range<usize> {
        self.value.span()
    }

    /// Returns the keys of the table, in the order of the text.
    pub fn keys(&self) -> Vec<GivenKey> {
        keys(self.value.get_ref())
    }

    /// Removes one key and returns it as a table at the same position. A value that is not a table is returned unchanged.
    #[must_use]
    pub fn split_off(&mut self, key: &str) -> Self {
        let span = self.value.span();
        let part = match self.value.get_mut() {
            DeValue::Table(table) => DeValue::Table(table.remove_entry(key).into_iter().collect()),
            other => other.clone(),
        };
        Self { document: self.document, value: Spanned::new(span, part) }
    }

    /// Reads the value into a type with a serde implementation.
    ///
    /// # Errors
    /// As for [`Parsed::read`].
    pub fn read<T: DeserializeOwned>(self) -> Result<T> {
        T::deserialize(ValueDeserializer::from(self.value)).map_err(|e| self.document.explain(&e).into())
    }
}

fn keys(value: &DeValue<'_>) -> Vec<GivenKey> {
    let all = value.as_table().into_iter().flatten();
    let given =
        all.map(|(key, value)| GivenKey { name: key.get_ref().to_string(), key: key.span(), value: value.span() });
    let mut keys: Vec<GivenKey> = given.collect();
    keys.sort_by_key(|given| given.key.start);
    keys
}

fn covers(outer: &Range<usize>, inner: &Range<usize>) -> bool {
    outer.start <= inner.start && inner.end <= outer.end
}

/// Descends to the innermost key that contains the span; returns true if there is one.
fn walk_table(table: &DeTable<'_>, span: &Range<usize>, path: &mut Vec<String>) -> bool {
    for (key, value) in table {
        path.push(key.get_ref().to_string());
        if covers(&key.span(), span) || walk_value(value, span, path) {
            return true;
        }
        path.pop();
    }
    false
}

fn walk_value(value: &Spanned<DeValue<'_>>, span: &Range<usize>, path: &mut Vec<String>) -> bool {
    let inside = match value.get_ref() {
        // The parts of a [table] can be anywhere in the file, so that its own span does not show whether it contains this one.
        DeValue::Table(table) => walk_table(table, span, path),
        DeValue::Array(items) => items.iter().enumerate().any(|(i, item)| {
            path.push(i.to_string());
            let found = walk_value(item, span, path);
            if !found {
                path.pop();
            }
            found
        }),
        _ => false,
    };
    inside || covers(&value.span(), span)
}
