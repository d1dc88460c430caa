//! Files of histories: two columns, or two columns of a record of an instrument.

use std::borrow::Cow;
use std::fmt::{Display, Formatter};

use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::Deserialize;
use serde::de::{Deserializer, Error, Visitor};
use serde_json::json;

use crate::typed::{Of, Placed, VALUE, text_or_table};
use crate::units::{Measure, measures};

/// File with rows [time, value].
#[derive(Debug)]
pub enum HistoryFile<D> {
    /// Path of a file with exactly these two columns.
    TwoColumns(String),
    /// Two columns of a file with any number of columns.
    Record(Box<RawHistoryRecord<D>>),
}

/// Columns of a record: any number of columns, with or without lines above their headings.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case", bound = "D: Measure")]
#[schemars(rename = "RawHistoryRecord")]
pub struct RawHistoryRecord<D> {
    /// Its path, relative to the scene file.
    pub file: Placed<String>,
    /// Column of the values: its heading, with or without the unit, or its number from 1. Default: the second.
    pub column: Option<Placed<Column>>,
    /// Column of the times, likewise. Default: the first.
    pub time_column: Option<Placed<Column>>,
    /// Time of the record at which the run begins; earlier rows are left out. Required if the record has negative times. Default: 0.
    pub start: Option<Of<measures::Time>>,
    /// Value of one unit of the column, instead of the unit in its heading; negative to change the sign. Default: 1 in the unit of the heading, or in SI units.
    #[schemars(with = "Option<AsValue>")]
    pub scale: Option<Of<D>>,
}

/// Schema of a quantity of the same kind as the history.
#[derive(JsonSchema)]
#[schemars(inline, extend("x-value" = "quantity, as `value`"))]
#[expect(dead_code, reason = "a schema alone")]
#[serde(untagged)]
enum AsValue {
    Number(f64),
    Text(String),
}

impl<'de, D: Measure> Deserialize<'de> for HistoryFile<D> {
    fn deserialize<R: Deserializer<'de>>(deserializer: R) -> Result<Self, R::Error> {
        let expecting = "the path of a file with two columns, or a table such as { file = \"record.csv\", column = 3 }";
        let path = |path: &str| Some(Self::TwoColumns(path.to_owned()));
        text_or_table(deserializer, expecting, path, |record| Self::Record(Box::new(record)))
    }
}

impl<D: Measure> JsonSchema for HistoryFile<D> {
    fn inline_schema() -> bool {
        true
    }

    fn schema_name() -> Cow<'static, str> {
        "HistoryFile".into()
    }

    fn schema_id() -> Cow<'static, str> {
        std::any::type_name::<D>().into()
    }

    fn json_schema(generator: &mut SchemaGenerator) -> Schema {
        // The schema does not depend on the quantity.
        let record = generator.subschema_for::<RawHistoryRecord<measures::Stress>>();
        json_schema!({ "anyOf": [{ "type": "string" }, record], VALUE: "string, or table" })
    }
}

/// Column, given by its heading or its number from 1.
#[derive(Debug)]
pub struct Column(String);

impl Display for Column {
    fn fmt(&self, f: &mut Formatter<'_>) -> std::fmt::Result {
        f.write_str(&self.0)
    }
}

impl<'de> Deserialize<'de> for Column {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(HeadingOrNumber)
    }
}

struct HeadingOrNumber;

impl Visitor<'_> for HeadingOrNumber {
    type Value = Column;

    fn expecting(&self, f: &mut Formatter<'_>) -> std::fmt::Result {
        f.write_str("the heading of a column, or its number from 1")
    }

    fn visit_str<E: Error>(self, heading: &str) -> Result<Column, E> {
        Ok(Column(heading.to_owned()))
    }

    fn visit_i64<E: Error>(self, number: i64) -> Result<Column, E> {
        Ok(Column(number.to_string()))
    }
}

impl JsonSchema for Column {
    fn inline_schema() -> bool {
        true
    }

    fn schema_name() -> Cow<'static, str> {
        "Column".into()
    }

    fn json_schema(_: &mut SchemaGenerator) -> Schema {
        let forms = json!([{ "type": "string" }, { "type": "integer", "minimum": 1 }]);
        json_schema!({ "anyOf": forms, VALUE: "string, or whole number from 1" })
    }
}
