//! Checks of records that are passed to an inversion by a program. Records from files satisfy them.

use crate::error::InputError;
use crate::input::{Checked, equally_long, finite};

/// Returns the first row (from 0) whose value is less than that of the previous row, or with `each` not greater.
pub(super) fn turns_back(values: &[f64], each: bool) -> Option<usize> {
    let wrong = |pair: &[f64]| pair[1] < pair[0] || each && pair[1] == pair[0];
    values.windows(2).position(wrong).map(|row| row + 1)
}

/// Checks the record of a gauge: times that do not decrease, and as many strains.
pub(super) fn check_record(name: &str, time: &[f64], strain: &[f64]) -> Checked {
    let [of_time, of_strain] = ["time", "strain"].map(|column| format!("{name}.{column}"));
    equally_long([(&of_time, time.len()), (&of_strain, strain.len())])?;
    finite(&of_time, time.iter().copied())?;
    finite(&of_strain, strain.iter().copied())?;
    let Some(row) = turns_back(time, false) else { return Ok(()) };
    let message = format!("the time of row {row} (counted from 0) is smaller than that of the row before");
    Err(InputError::new(message).key(of_time).allowed("times that do not fall").help("sort the rows"))
}
