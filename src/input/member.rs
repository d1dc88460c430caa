//! Checks of numbers that a program passes as members of a type or arguments of a function; those of files are checked where they are read.

use super::allowed::shown;
use super::{Allowed, last_part};
use crate::error::InputError;
use crate::units::Dimension;

/// Result of a check of members and arguments.
pub(crate) type Checked = Result<(), InputError>;

/// Checks that a number is in a range and has a meaningful magnitude.
pub(crate) fn member(name: &str, value: f64, dimension: Dimension, allowed: Allowed) -> Checked {
    let last = last_part(name);
    if !allowed.holds(value) {
        return Err(out_of_range(name, value, dimension).allowed(allowed.describe(last, dimension)));
    }
    let Some(bounds) = allowed.impossible(last, value, dimension) else { return Ok(()) };
    Err(out_of_range(name, value, dimension).allowed(bounds))
}

/// Checks that numbers are positive.
pub(crate) fn positive<const N: usize>(members: [(&str, f64, Dimension); N]) -> Checked {
    members.into_iter().try_for_each(|(name, value, dimension)| member(name, value, dimension, Allowed::Positive))
}

/// Checks that a number is positive; it may be infinite.
pub(crate) fn positive_or_infinite(name: &str, value: f64, dimension: Dimension) -> Checked {
    if value == f64::INFINITY { Ok(()) } else { member(name, value, dimension, Allowed::Positive) }
}

/// Checks that an optional number, if given, is in a range.
pub(crate) fn optional(name: &str, value: Option<f64>, dimension: Dimension, allowed: Allowed) -> Checked {
    value.map_or(Ok(()), |value| member(name, value, dimension, allowed))
}

/// Checks that the values of rows are finite.
pub(crate) fn finite(name: &str, values: impl IntoIterator<Item = f64>) -> Checked {
    let wrong = values.into_iter().enumerate().find(|(_, value)| !value.is_finite());
    let Some((row, value)) = wrong else { return Ok(()) };
    let error = InputError::new(format!("row {row} (counted from 0) is {value}")).key(name);
    Err(error.allowed("finite numbers").help("leave the row out, or correct it"))
}

/// Checks that two columns, given by name and length, have the same length.
pub(crate) fn equally_long([(one, rows), (other, others)]: [(&str, usize); 2]) -> Checked {
    if rows == others {
        return Ok(());
    }
    let error = InputError::new(format!("{others} rows for the {rows} of `{one}`")).key(other);
    Err(error.allowed(format!("{rows} rows")).help("give both columns for every row"))
}

fn out_of_range(name: &str, value: f64, dimension: Dimension) -> InputError {
    let value = format!("{} {}", shown(value), dimension.si_symbol());
    let error = InputError::new(format!("{} is out of range", value.trim_end()));
    error.key(name).help(format!("set `{name}` to a value in this range"))
}
