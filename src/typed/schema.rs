//! JSON schema derived from the types of values, with units, ranges and defaults.

use std::borrow::Cow;

use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde_json::{Map, Value, json};

use super::values::{Count, Later, NotNegative, Of, Or, Placed, Range, Rows};
use crate::input::Allowed;
use crate::units::{Dimension, Measure};

/// Implements the schema of wrapper types as that of their content.
macro_rules! same_schema {
    ($($name:ident),*) => {$(
        impl<T: JsonSchema> JsonSchema for $name<T> {
            fn inline_schema() -> bool {
                T::inline_schema()
            }

            fn schema_name() -> Cow<'static, str> {
                T::schema_name()
            }

            fn schema_id() -> Cow<'static, str> {
                T::schema_id()
            }

            fn json_schema(generator: &mut SchemaGenerator) -> Schema {
                T::json_schema(generator)
            }
        }
    )*};
}

same_schema! { Later, Placed }

/// Keyword under which a schema describes its value in words: "quantity (m, > 0)".
pub const VALUE: &str = "x-value";
/// Placeholder for the name of a key, which is unknown in the schema of its value.
const NAME: &str = "{}";

fn unit(dimension: Dimension, in_torsion: Dimension) -> String {
    let (unit, twisted) = (dimension.si_symbol(), in_torsion.si_symbol());
    if unit == twisted { unit.to_owned() } else { format!("{unit}; in torsion {twisted}") }
}

fn range(allowed: Allowed) -> String {
    match allowed {
        Allowed::Finite => String::new(),
        Allowed::Positive => "> 0".to_owned(),
        Allowed::NotNegative => ">= 0".to_owned(),
        other => other.describe(NAME, Dimension::None),
    }
}

/// Returns the keywords of a JSON schema for a range.
fn bounds(allowed: Allowed) -> Value {
    match allowed {
        Allowed::Finite => json!({}),
        Allowed::Positive => json!({ "exclusiveMinimum": 0 }),
        Allowed::NotNegative => json!({ "minimum": 0 }),
        Allowed::Within(low, high) => json!({ "minimum": low, "maximum": high }),
        Allowed::Above(low, high) => json!({ "exclusiveMinimum": low, "maximum": high }),
        Allowed::Below(low, high) => json!({ "minimum": low, "exclusiveMaximum": high }),
        Allowed::Between(low, high) => json!({ "exclusiveMinimum": low, "exclusiveMaximum": high }),
    }
}

fn number_schema(kind: &str, word: &str, facts: [String; 2], allowed: Allowed) -> Schema {
    let facts: Vec<String> = facts.into_iter().filter(|fact| !fact.is_empty()).collect();
    let mut number = bounds(allowed);
    number["type"] = json!(kind);
    let value = if facts.is_empty() { word.to_owned() } else { format!("{word} ({})", facts.join(", ")) };
    json_schema!({ "anyOf": [number, { "type": "string" }], VALUE: value })
}

impl<D: Measure, R: Range> JsonSchema for Of<D, R> {
    fn inline_schema() -> bool {
        true
    }

    fn schema_name() -> Cow<'static, str> {
        "Number".into()
    }

    fn schema_id() -> Cow<'static, str> {
        std::any::type_name::<(D, R)>().into()
    }

    fn json_schema(_: &mut SchemaGenerator) -> Schema {
        let word = if D::DIMENSION == Dimension::None { "number" } else { "quantity" };
        number_schema("number", word, [unit(D::DIMENSION, D::IN_TORSION), range(R::ALLOWED)], R::ALLOWED)
    }
}

impl<K: JsonSchema, const N: i64, const PER: i64> JsonSchema for Or<K, N, PER> {
    fn inline_schema() -> bool {
        true
    }

    fn schema_name() -> Cow<'static, str> {
        K::schema_name()
    }

    fn schema_id() -> Cow<'static, str> {
        format!("{} or {N}/{PER}", K::schema_id()).into()
    }

    fn json_schema(generator: &mut SchemaGenerator) -> Schema {
        let mut schema = K::json_schema(generator);
        let default = if N % PER == 0 { json!(N / PER) } else { json!(N as f64 / PER as f64) };
        schema.insert("default".to_owned(), default);
        schema
    }
}

impl<X: Measure, D: Measure, R: Range> JsonSchema for Rows<X, D, R> {
    fn inline_schema() -> bool {
        true
    }

    fn schema_name() -> Cow<'static, str> {
        "Rows".into()
    }

    fn schema_id() -> Cow<'static, str> {
        std::any::type_name::<(X, D, R)>().into()
    }

    fn json_schema(generator: &mut SchemaGenerator) -> Schema {
        let columns = [Of::<X, NotNegative>::json_schema(generator), Of::<D, R>::json_schema(generator)];
        let value = columns.each_ref().map(|column| column.get(VALUE).and_then(Value::as_str).unwrap_or_default());
        let value = format!("rows [{}, {}]", value[0], value[1]);
        let row = json!({ "type": "array", "prefixItems": columns, "minItems": 2, "maxItems": 2 });
        json_schema!({ "type": "array", "items": row, VALUE: value })
    }
}

impl<const LOW: usize, const HIGH: usize> JsonSchema for Count<LOW, HIGH> {
    fn inline_schema() -> bool {
        true
    }

    fn schema_name() -> Cow<'static, str> {
        "Count".into()
    }

    fn schema_id() -> Cow<'static, str> {
        format!("Count{LOW}to{HIGH}").into()
    }

    fn json_schema(_: &mut SchemaGenerator) -> Schema {
        number_schema(
            "integer",
            "whole number",
            [String::new(), format!("{LOW} to {HIGH}")],
            Allowed::Within(LOW as f64, HIGH as f64),
        )
    }
}

/// Returns the JSON schema of a file. Descriptions of numbers end with unit and range. Null is not allowed, because TOML has none.
pub fn schema<T: JsonSchema>() -> Schema {
    let mut schema = schemars::schema_for!(T);
    if let Some(root) = schema.as_object_mut() {
        complete(root);
    }
    schema
}

fn complete(schema: &mut Map<String, Value>) {
    without_null(schema);
    if let Some(properties) = schema.get_mut("properties").and_then(Value::as_object_mut) {
        for (name, property) in
            properties.iter_mut().filter_map(|(name, property)| Some((name, property.as_object_mut()?)))
        {
            without_null(property);
            state_value(name, property);
        }
    }
    for value in schema.values_mut() {
        inside(value);
    }
}

fn inside(value: &mut Value) {
    match value {
        Value::Object(schema) => complete(schema),
        Value::Array(items) => items.iter_mut().for_each(inside),
        _ => {}
    }
}

fn without_null(schema: &mut Map<String, Value>) {
    let Some(options) = schema.get_mut("anyOf").and_then(Value::as_array_mut) else { return };
    options.retain(|option| option["type"] != "null");
    if let [Value::Object(only)] = options.as_mut_slice() {
        let only = std::mem::take(only);
        schema.remove("anyOf");
        for (key, value) in only {
            schema.entry(key).or_insert(value);
        }
    }
}

fn state_value(name: &str, property: &mut Map<String, Value>) {
    let Some(value) = property.get(VALUE).and_then(Value::as_str) else { return };
    let mut value = value.replace(NAME, name);
    if let Some(default) = property.get("default") {
        value = format!("{value}, default {default}");
    }
    let description = property.get("description").and_then(Value::as_str).unwrap_or_default();
    let description = format!("{description} Value: {value}.");
    property.insert("description".to_owned(), json!(description.trim()));
    property.insert(VALUE.to_owned(), json!(value));
}
