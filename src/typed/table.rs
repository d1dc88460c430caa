//! Tables that are nothing else: derived code takes a list for a table, by position, and complains of its members.

use std::fmt::Formatter;
use std::marker::PhantomData;

use serde::de::value::MapAccessDeserializer;
use serde::de::{Deserialize, Deserializer, MapAccess, Visitor};
use toml::Spanned;

use super::Placed;

/// A table of which messages show an example.
pub trait Example {
    /// What to write, "a table such as ...".
    const EXPECTING: &str;
}

/// For fields that are tables, with `#[serde(deserialize_with = "table")]`.
pub fn table<'de, D: Deserializer<'de>, T: Deserialize<'de> + Example>(deserializer: D) -> Result<Placed<T>, D::Error> {
    Spanned::deserialize(deserializer).map(placed)
}

/// For fields that may be absent, with `#[serde(default, deserialize_with = "optional_table")]`.
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
        deserializer.deserialize_any(Map(PhantomData))
    }
}

struct Map<T>(PhantomData<T>);

impl<'de, T: Deserialize<'de> + Example> Visitor<'de> for Map<T> {
    type Value = Table<T>;

    fn expecting(&self, f: &mut Formatter<'_>) -> std::fmt::Result {
        f.write_str(T::EXPECTING)
    }

    fn visit_map<A: MapAccess<'de>>(self, map: A) -> Result<Table<T>, A::Error> {
        T::deserialize(MapAccessDeserializer::new(map)).map(Table)
    }
}
