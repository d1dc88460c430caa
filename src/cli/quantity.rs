//! Numbers with units on the command line.

use crate::units::{Dimension, Quantity};

/// Reads a quantity in SI; a plain number is SI.
fn read(text: &str, dimension: Dimension) -> Result<f64, String> {
    let Ok(quantity) = text.parse::<Quantity>();
    quantity.si(dimension)
}

/// A reader of numbers above zero.
pub(super) fn positive(dimension: Dimension) -> impl Fn(&str) -> Result<f64, String> + Clone {
    move |text| match read(text, dimension)? {
        value if value > 0.0 => Ok(value),
        _ => Err(format!("{text} is out of range (allowed: above 0), e.g. \"{}\"", dimension.example())),
    }
}

/// A reader of numbers that are not negative.
pub(super) fn not_negative(dimension: Dimension) -> impl Fn(&str) -> Result<f64, String> + Clone {
    move |text| match read(text, dimension)? {
        value if value >= 0.0 => Ok(value),
        _ => Err(format!("{text} is out of range (allowed: at least 0), e.g. \"{}\"", dimension.example())),
    }
}

/// A reader of any number.
pub(super) fn any(dimension: Dimension) -> impl Fn(&str) -> Result<f64, String> + Clone {
    move |text| read(text, dimension)
}
