//! Parsers of quantities with units on the command line.

use crate::units::{Dimension, Quantity};

/// Returns the SI value of a quantity; a plain number is in SI units.
fn read(text: &str, dimension: Dimension) -> Result<f64, String> {
    let Ok(quantity) = text.parse::<Quantity>();
    quantity.si(dimension)
}

/// Returns a parser of values above zero.
pub(super) fn positive(dimension: Dimension) -> impl Fn(&str) -> Result<f64, String> + Clone {
    move |text| match read(text, dimension)? {
        value if value > 0.0 => Ok(value),
        _ => Err(format!("{text} is out of range (allowed: above 0), e.g. \"{}\"", dimension.example())),
    }
}

/// Returns a parser of values of at least zero.
pub(super) fn not_negative(dimension: Dimension) -> impl Fn(&str) -> Result<f64, String> + Clone {
    move |text| match read(text, dimension)? {
        value if value >= 0.0 => Ok(value),
        _ => Err(format!("{text} is out of range (allowed: at least 0), e.g. \"{}\"", dimension.example())),
    }
}

/// Returns a parser of any value.
pub(super) fn any(dimension: Dimension) -> impl Fn(&str) -> Result<f64, String> + Clone {
    move |text| read(text, dimension)
}
