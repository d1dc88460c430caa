//! Values that are constant or vary along the bar.

use std::borrow::Cow;
use std::marker::PhantomData;
use std::ops::Range as Span;

use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::Deserialize;
use serde::de::value::{MapAccessDeserializer, SeqAccessDeserializer};
use serde::de::{Deserializer, Error as _, MapAccess, SeqAccess, Unexpected, Visitor};
use serde_json::{Value, json};

use crate::input::{Allowed, Number};
use crate::typed::{Either, Finite, Of, Placed, Positive, Range, Row, Rows, VALUE};
use crate::units::measures::{AngularVelocity, Length, Velocity};
use crate::units::{Dimension, Measure, Quantity};

/// Velocity of a bar and its ends: angular in torsion.
pub type Motion = Either<Velocity, AngularVelocity>;

/// Quantity along the bar, as typed.
#[derive(Debug)]
pub enum RawDistribution {
    /// Constant along the bar.
    Uniform(Quantity),
    /// Rows [x, value] with x in m, nondecreasing. The value is linear between rows; a repeated x is a jump; outside the outermost rows it is
    /// constant.
    Table(Vec<Row>),
    /// Rows from a file.
    Csv(RawTableFile),
}

/// Quantity along the bar with its dimension and range. If `CSV` is true, it can be given by a file.
#[derive(Debug)]
pub struct Distributed<D, R = Finite, const CSV: bool = true>(RawDistribution, PhantomData<(D, R)>);

/// Area or diameter: a constant, or a table along the segment.
pub type Section<D> = Distributed<D, Positive, false>;

/// Value along the bar with everything that is needed to read it.
#[derive(Debug, Clone)]
pub struct Given<'a> {
    pub span: Span<usize>,
    pub value: &'a RawDistribution,
    /// Dimension in an axial bar, and in torsion.
    dimensions: [Dimension; 2],
    pub allowed: Allowed,
}

impl Given<'_> {
    pub fn dimension(&self, torsion: bool) -> Dimension {
        self.dimensions[usize::from(torsion)]
    }

    /// Returns the constant value; `None` for a table.
    pub fn uniform(&self) -> Option<Number> {
        let RawDistribution::Uniform(value) = self.value else { return None };
        Some(Number::new(self.span.clone(), value.clone()))
    }

    /// Returns the rows of a table; empty if the value is not a table in the scene file.
    pub fn rows(&self) -> &[Row] {
        if let RawDistribution::Table(rows) = self.value { rows } else { &[] }
    }
}

impl<D: Measure, R: Range, const CSV: bool> Placed<Distributed<D, R, CSV>> {
    pub(in crate::scene) fn given(&self) -> Given<'_> {
        let dimensions = [D::DIMENSION, D::IN_TORSION];
        Given { span: self.span(), value: &self.get_ref().0, dimensions, allowed: R::ALLOWED }
    }
}

/// A file with two columns, x and value.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct RawTableFile {
    /// Its path, relative to the scene file. A header line gives the names of the columns and, in brackets, their units:
    /// `x [mm],stress [MPa]`.
    pub csv: Placed<String>,
}

impl<D: Measure, R: Range, const CSV: bool> JsonSchema for Distributed<D, R, CSV> {
    fn inline_schema() -> bool {
        true
    }

    fn schema_name() -> Cow<'static, str> {
        "Distributed".into()
    }

    fn schema_id() -> Cow<'static, str> {
        std::any::type_name::<Self>().into()
    }

    fn json_schema(generator: &mut SchemaGenerator) -> Schema {
        let uniform = Of::<D, R>::json_schema(generator);
        let rows = Rows::<Length, D, R>::json_schema(generator);
        let words = |schema: &Schema| schema.get(VALUE).and_then(Value::as_str).unwrap_or_default().to_owned();
        let mut value = format!("{}, rows [x, value]", words(&uniform));
        let mut forms = vec![json!(uniform), json!(rows)];
        if CSV {
            forms.push(json!(generator.subschema_for::<RawTableFile>()));
            value += ", { csv = \"file.csv\" }";
        }
        json_schema!({ "anyOf": forms, VALUE: value })
    }
}

impl<'de, D, R, const CSV: bool> Deserialize<'de> for Distributed<D, R, CSV> {
    fn deserialize<S: Deserializer<'de>>(deserializer: S) -> Result<Self, S::Error> {
        deserializer.deserialize_any(Choice::<CSV>).map(|along| Self(along, PhantomData))
    }
}

/// Visitor, since a derived untagged enum would lose the positions of the numbers inside.
struct Choice<const CSV: bool>;

impl<'de, const CSV: bool> Visitor<'de> for Choice<CSV> {
    type Value = RawDistribution;

    fn expecting(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(if CSV {
            "a number, a string with a unit, rows [x, value], or { csv = \"file.csv\" }"
        } else {
            "a number, a string with a unit such as \"1 cm^2\", or rows [x, size] of a taper"
        })
    }

    fn visit_f64<E>(self, value: f64) -> Result<RawDistribution, E> {
        Ok(RawDistribution::Uniform(Quantity::Number(value)))
    }

    fn visit_i64<E>(self, value: i64) -> Result<RawDistribution, E> {
        Ok(RawDistribution::Uniform(Quantity::Number(value as f64)))
    }

    fn visit_u64<E>(self, value: u64) -> Result<RawDistribution, E> {
        Ok(RawDistribution::Uniform(Quantity::Number(value as f64)))
    }

    fn visit_str<E>(self, value: &str) -> Result<RawDistribution, E> {
        Ok(RawDistribution::Uniform(Quantity::Text(value.to_owned())))
    }

    fn visit_seq<A: SeqAccess<'de>>(self, rows: A) -> Result<RawDistribution, A::Error> {
        Vec::deserialize(SeqAccessDeserializer::new(rows)).map(RawDistribution::Table)
    }

    fn visit_map<A: MapAccess<'de>>(self, file: A) -> Result<RawDistribution, A::Error> {
        if !CSV {
            return Err(A::Error::invalid_type(Unexpected::Map, &self));
        }
        RawTableFile::deserialize(MapAccessDeserializer::new(file)).map(RawDistribution::Csv)
    }
}
