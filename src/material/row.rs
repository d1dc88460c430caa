//! A row of a table in a material file.

use serde::Deserialize;
use serde::de::value::SeqAccessDeserializer;
use serde::de::{Deserializer, Error as _, SeqAccess, Visitor};

use crate::input::Number;

/// A row [strain, stress] of a curve.
#[derive(Debug, Clone)]
pub struct TableRow(pub Number, pub Number);

// Written by hand, because a pair would ignore a third value.
impl<'de> Deserialize<'de> for TableRow {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Row;

        impl<'de> Visitor<'de> for Row {
            type Value = TableRow;

            fn expecting(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
                f.write_str("a row [strain, stress]")
            }

            fn visit_seq<A: SeqAccess<'de>>(self, row: A) -> Result<TableRow, A::Error> {
                let values = Vec::deserialize(SeqAccessDeserializer::new(row))?;
                let found = values.len();
                let pair = <[Number; 2]>::try_from(values).map_err(|_| A::Error::invalid_length(found, &self))?;
                let [strain, stress] = pair;
                Ok(TableRow(strain, stress))
            }
        }

        deserializer.deserialize_seq(Row)
    }
}
