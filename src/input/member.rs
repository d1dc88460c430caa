//! Numbers that a program gives, as members of a type or arguments of a function: those of files are checked where they are read.

use super::allowed::shown;
use super::{Allowed, last_part};
use crate::error::InputError;
use crate::units::Dimension;

/// What a check of members and arguments says.
pub(crate) type Checked = Result<(), InputError>;

/// A number that has to lie in a range, and to have a magnitude that is possible.
pub(crate) fn member(name: &str, value: f64, dimension: Dimension, allowed: Allowed) -> Checked {
    let last = last_part(name);
    if !allowed.holds(value) {
        return Err(out_of_range(name, value, dimension).allowed(allowed.describe(last, dimension)));
    }
    let Some(bounds) = allowed.impossible(last, value, dimension) else { return Ok(()) };
    Err(out_of_range(name, value, dimension).allowed(bounds))
}

/// Numbers that have to be positive.
pub(crate) fn positive<const N: usize>(members: [(&str, f64, Dimension); N]) -> Checked {
    members.into_iter().try_for_each(|(name, value, dimension)| member(name, value, dimension, Allowed::Positive))
}

/// A number that has to be positive, and may be infinite.
pub(crate) fn positive_or_infinite(name: &str, value: f64, dimension: Dimension) -> Checked {
    if value == f64::INFINITY { Ok(()) } else { member(name, value, dimension, Allowed::Positive) }
}

/// A number that need not be given, and else has to lie in a range.
pub(crate) fn optional(name: &str, value: Option<f64>, dimension: Dimension, allowed: Allowed) -> Checked {
    value.map_or(Ok(()), |value| member(name, value, dimension, allowed))
}

/// Values of rows that have to be finite.
pub(crate) fn finite(name: &str, values: impl IntoIterator<Item = f64>) -> Checked {
    let wrong = values.into_iter().enumerate().find(|(_, value)| !value.is_finite());
    let Some((row, value)) = wrong else { return Ok(()) };
    let error = InputError::new(format!("row {row} (counted from 0) is {value}")).key(name);
    Err(error.allowed("finite numbers").help("leave the row out, or correct it"))
}

/// Columns that have to be of one length: the name of each, and its length.
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
