//! Values that are either a string or a table.

use std::fmt::Formatter;

use serde::Deserialize;
use serde::de::value::MapAccessDeserializer;
use serde::de::{Deserializer, Error, MapAccess, Unexpected, Visitor};

/// Visitor with the expected input and the conversions of strings and tables; strings for which `text` returns `None` are refused.
struct TextOrTable<T, R> {
    expecting: &'static str,
    text: fn(&str) -> Option<T>,
    table: fn(R) -> T,
}

/// Reads a string or a table. A derived untagged enum would lose the positions of the numbers inside, and the names of unknown keys.
pub fn text_or_table<'de, D: Deserializer<'de>, T, R: Deserialize<'de>>(
    deserializer: D,
    expecting: &'static str,
    text: fn(&str) -> Option<T>,
    table: fn(R) -> T,
) -> Result<T, D::Error> {
    deserializer.deserialize_any(TextOrTable { expecting, text, table })
}

impl<'de, T, R: Deserialize<'de>> Visitor<'de> for TextOrTable<T, R> {
    type Value = T;

    fn expecting(&self, f: &mut Formatter<'_>) -> std::fmt::Result {
        f.write_str(self.expecting)
    }

    fn visit_str<E: Error>(self, text: &str) -> Result<T, E> {
        (self.text)(text).ok_or_else(|| E::invalid_value(Unexpected::Str(text), &self))
    }

    fn visit_map<A: MapAccess<'de>>(self, map: A) -> Result<T, A::Error> {
        R::deserialize(MapAccessDeserializer::new(map)).map(self.table)
    }
}
