//! Values of keys as the raw tables of files declare them: each with its place, and numbers with dimension, range and default as parts of
//! their type. How they are read, messages and the JSON schema follow from the declaration.

mod names;
mod schema;
mod values;

pub use names::keys_of;
pub use schema::{VALUE, schema};
pub use values::{
    Above, Below, Between, Count, Either, Finite, Key, Later, NotNegative, Of, OneNumber, Or, Placed, Poisson,
    Positive, Range, Row, Rows, Within, pairs,
};

/// A plain number; "50 %" is one, too.
pub use crate::units::measures::None as Plain;
