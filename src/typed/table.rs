//! Values that must be tables: a derived implementation would also accept a list, by position, and report errors of its entries.

use serde::de::{Deserialize, Deserializer};
use toml::Spanned;

use super::Placed;
use super::choice::text_or_table;

/// Table for which messages show an example.
pub trait Example {
    /// Expected input: "a table such as ...".
    const EXPECTING: &str;
}

/// Deserializes a table, for fields with `#[serde(deserialize_with = "table")]`.
pub fn table<'de, D: Deserializer<'de>, T: Deserialize<'de> + Example>(deserializer: D) -> Result<Placed<T>, D::Error> {
    Spanned::deserialize(deserializer).map(placed)
}

/// Deserializes an optional table, for fields with `#[serde(default, deserialize_with = "optional_table")]`.
pub fn optional_table<'de, D: Deserializer<'de>, T: Deserialize<'de> + Example>(
    deserializer: D,
) -> Result<Option<Placed<T>>, D::Error> {
    Option::deserialize(deserializer).map(|table| table.map(placed))
}

fn placed<T>(table: Spanned<Table<T>>) -> Placed<T> {
    let span = table.span();
    Placed(Spanned::new(span, table.into_inner().0))
}

struct Table<T>(T);

impl<'de, T: Deserialize<'de> + Example> Deserialize<'de> for Table<T> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        text_or_table(deserializer, T::EXPECTING, |_| None, Self)
    }
}
