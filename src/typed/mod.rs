//! Typed values of keys: a value has its position in the text, and the type of a number includes its dimension, range and default. Reading, messages
//! and the JSON schema follow from the declaration.

mod choice;
mod names;
mod schema;
mod table;
mod values;

pub use choice::text_or_table;
pub use names::keys_of;
pub use schema::{VALUE, schema};
pub use table::{Example, optional_table, table};
pub use values::{
    Above, Below, Between, Count, Either, Finite, Key, Later, NotNegative, Of, OneNumber, Or, Placed, Poisson,
    Positive, Range, Row, Rows, Within, pairs,
};

/// Dimensionless number; "50 %" is also accepted.
pub use crate::units::measures::None as Plain;

#[cfg(test)]
mod tests {
    use schemars::JsonSchema;
    use serde::Deserialize;

    use super::*;
    use crate::error::{Error, InputError};
    use crate::input::Document;
    use crate::units::measures::{AngularVelocity, Length, Velocity};

    #[derive(Debug, Deserialize, JsonSchema)]
    #[serde(deny_unknown_fields, rename_all = "kebab-case")]
    struct Table {
        /// How long.
        length: Of<Length, Positive>,
        velocity: Option<Of<Either<Velocity, AngularVelocity>>>,
        #[schemars(default)]
        front_tolerance: Or<Of<Plain, Below<0, 1>>, 1, 1000>,
        #[schemars(default)]
        cells: Or<Count<2, 100>, 10>,
    }

    fn read(text: &str) -> (Document, crate::error::Result<Table>) {
        let document = Document::new("t.toml", text);
        let table = document.parse();
        (document, table)
    }

    fn wrong(text: &str, si: impl Fn(&Table, &Document) -> crate::error::Result<f64>) -> InputError {
        let (document, table) = read(text);
        match table.and_then(|table| si(&table, &document)) {
            Err(Error::Input(error)) => error,
            other => panic!("{other:?}"),
        }
    }

    #[test]
    fn numbers_are_read_in_si_with_their_defaults() {
        let (document, table) = read("length = \"10 mm\"\nvelocity = \"3 rad/s\"\ncells = 7");
        let table = table.expect("right");
        assert_eq!(table.length.si(&document, false).expect("a length"), 0.01);
        assert_eq!(table.velocity.si(&document, true).expect("in torsion"), Some(3.0));
        assert!(table.velocity.si(&document, false).is_err());
        assert_eq!(table.front_tolerance.si(&document, false).expect("the default"), 1e-3);
        assert_eq!(table.cells.si(&document, false).expect("a count"), 7);
        assert!(table.front_tolerance.place().is_none());
        assert_eq!(table.cells.place().map(|span| &document.text[span]), Some("7"));
    }

    #[test]
    fn messages_follow_from_the_declaration() {
        let error = wrong("velocity = 1", |table, document| table.length.si(document, false));
        assert_eq!((error.key.as_str(), error.help.as_str()), ("length", "add a length, e.g. length = \"10 in\""));
        let error =
            wrong("length = 1\nfront-tolerance = 1", |table, document| table.front_tolerance.si(document, false));
        assert_eq!((error.key.as_str(), error.allowed.as_str()), ("front-tolerance", "0 <= front-tolerance < 1"));
        let error =
            wrong("length = 1\ncells = 2.5", |table, document| table.cells.si(document, false).map(|n| n as f64));
        assert!(error.message.contains("2.5 is not a whole number"), "{error}");
        // A list is not accepted as a table, although it has an entry for every key.
        let document = Document::new("t.toml", "t = [1]");
        let taken = document.parsed().expect("TOML").take("t").expect("there is one");
        assert!(taken.read::<Table>().is_err());
    }

    #[test]
    fn the_schema_has_units_ranges_and_defaults() {
        let schema = schema::<Table>();
        let of = |key: &str| schema.as_value()["properties"][key].clone();
        assert_eq!(of("length")["description"], "How long. Value: quantity (m, > 0).");
        assert_eq!(of("length")["anyOf"][0]["exclusiveMinimum"], 0);
        assert_eq!(of("velocity")[VALUE], "quantity (m/s; in torsion rad/s)");
        assert_eq!(of("front-tolerance")[VALUE], "number (0 <= front-tolerance < 1), default 0.001");
        assert_eq!(of("cells")[VALUE], "whole number (2 to 100), default 10");
        assert_eq!(schema.as_value()["required"], serde_json::json!(["length"]));
        assert!(!schema.as_value().to_string().contains("null"));
        assert_eq!(keys_of::<Table>(), ["length", "velocity", "front-tolerance", "cells"]);
    }
}
