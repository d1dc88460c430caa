//! Data and units of a run that all panels of a figure share.

use super::display::{Unit, Units, field_name};
use crate::error::Result;
use crate::record::store::{ResultFile, StoredRupture};
use crate::record::{Field, FrontRow, INTERIOR};

/// Data of a run for the panels.
pub(super) struct View<'a> {
    pub file: &'a ResultFile,
    pub field: Field,
    /// True if the field was requested, rather than chosen by default.
    pub asked: bool,
    pub units: Units,
    pub time: Vec<f64>,
    pub x: Vec<f64>,
    /// Length of the bar, m.
    pub length: f64,
    /// Time of the last frame, s.
    pub end_time: f64,
    pub ruptures: Vec<StoredRupture>,
    /// True for a bar in torsion, whose fields are those at its surface.
    pub torsion: bool,
}

impl View<'_> {
    pub fn time_unit(&self) -> Unit {
        Units::time(self.end_time)
    }

    pub fn length_unit(&self) -> Unit {
        self.units.length(self.length)
    }

    /// Returns the name of the field for axes.
    pub fn field_name(&self) -> &'static str {
        self.name_of(self.field)
    }

    pub fn name_of(&self, field: Field) -> &'static str {
        field_name(field, self.torsion)
    }

    pub fn field_unit(&self) -> Unit {
        self.units.field(self.field)
    }

    /// Returns the value that the axis of a field always includes: zero, or `None` for temperatures.
    pub fn zero(field: Field) -> Option<f64> {
        (field != Field::Temperature).then_some(0.0)
    }

    /// Returns the name of the theory of the fans, which follows the quasi-static curve at all strain rates.
    pub fn theory(&self) -> &'static str {
        let with_rate = self.file.metadata().effects.iter().any(|effect| effect.starts_with("rate"));
        if with_rate { "theory without rate" } else { "theory" }
    }

    /// Returns the fronts that theory predicts: those of the fans from the ends and joints.
    pub fn theory_fronts(&self) -> Result<Vec<FrontRow>> {
        let mut fronts = self.file.fronts()?;
        fronts.retain(|front| front.origin != INTERIOR);
        Ok(fronts)
    }

    /// Returns the history of a field at each of some samples. Frames are read in blocks, since a field may be larger than memory.
    pub fn columns(&self, field: Field, samples: &[usize]) -> Result<Vec<Vec<f64>>> {
        const BLOCK: usize = 64;
        let mut columns = vec![Vec::with_capacity(self.time.len()); samples.len()];
        for start in (0..self.time.len()).step_by(BLOCK) {
            let block = self.file.field(field, start..(start + BLOCK).min(self.time.len()))?;
            for row in block.rows() {
                for (column, &sample) in columns.iter_mut().zip(samples) {
                    column.push(row[sample]);
                }
            }
        }
        Ok(columns)
    }

    /// Returns the values that the axis of a line must contain: all values with front tracking, otherwise the extremes without spikes of a few
    /// samples.
    pub fn limits(&self, points: &[(f64, f64)]) -> Vec<f64> {
        // With front tracking, steps at fronts have few samples and are not spikes.
        if self.file.metadata().method == "moc" { points.iter().map(|p| p.1).collect() } else { without_spikes(points) }
    }
}

/// Returns the lowest and the highest value for the axis. A sudden start can leave a few samples far outside (the first step contains the whole
/// jump). If omitting the five most extreme samples halves the range, the axis omits them.
fn without_spikes(points: &[(f64, f64)]) -> Vec<f64> {
    const SPIKE: usize = 5;
    let mut values: Vec<f64> = points.iter().map(|p| p.1).filter(|v| v.is_finite()).collect();
    values.sort_by(f64::total_cmp);
    let (Some(&low), Some(&high)) = (values.first(), values.last()) else {
        return values;
    };
    if values.len() < 40 * SPIKE {
        return vec![low, high];
    }
    let (inner_low, inner_high) = (values[SPIKE], values[values.len() - 1 - SPIKE]);
    let keep = |outer: f64, inner: f64| if (outer - inner).abs() > 0.5 * (high - low) { inner } else { outer };
    vec![keep(low, inner_low), keep(high, inner_high)]
}

/// Returns the index of the value nearest to `target` in an increasing list that is not empty.
pub(super) fn nearest(values: &[f64], target: f64) -> usize {
    let after = values.partition_point(|v| *v < target);
    if after == 0 {
        return 0;
    }
    if after == values.len() || target - values[after - 1] <= values[after] - target { after - 1 } else { after }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_spike_of_a_few_samples_does_not_set_the_axis() {
        let mut points: Vec<(f64, f64)> = (0..1000).map(|i| (f64::from(i), f64::from(i % 100))).collect();
        assert_eq!(without_spikes(&points), [0.0, 99.0]);
        points[3].1 = -5000.0;
        assert_eq!(without_spikes(&points), [0.0, 99.0]);
        // A long pulse is not a spike.
        points[10..30].iter_mut().for_each(|p| p.1 = -5000.0);
        assert_eq!(without_spikes(&points), [-5000.0, 99.0]);
    }

    #[test]
    fn nearest_takes_the_closer_neighbour_and_stays_inside() {
        let values = [0.5, 1.5, 2.5];
        let found: Vec<_> = [-1.0, 0.9, 1.1, 2.0, 9.0].iter().map(|t| nearest(&values, *t)).collect();
        assert_eq!(found, [0, 0, 1, 1, 2]);
    }
}
