//! What every panel of a figure shows of a run, and in which units.

use super::display::{Unit, Units};
use crate::record::Field;
use crate::record::store::ResultFile;

/// What every panel needs to know of the run.
pub(super) struct View<'a> {
    pub file: &'a ResultFile,
    pub field: Field,
    pub units: Units,
    pub time: Vec<f64>,
    pub x: Vec<f64>,
    /// Of the bar, m.
    pub length: f64,
    /// s.
    pub end_time: f64,
}

impl View<'_> {
    pub fn time_unit(&self) -> Unit {
        Units::time(self.end_time)
    }

    pub fn length_unit(&self) -> Unit {
        self.units.length(self.length)
    }

    pub fn field_unit(&self) -> Unit {
        self.units.field(self.field)
    }
}

/// Index of the value nearest to `target` in an increasing list that is not empty.
pub(super) fn nearest(values: &[f64], target: f64) -> usize {
    let after = values.partition_point(|v| *v < target);
    if after == 0 {
        return 0;
    }
    if after == values.len() || target - values[after - 1] <= values[after] - target { after - 1 } else { after }
}
