//! Errors of a run: one number for each recorded quantity.

use std::fmt;
use std::ops::Index;

use serde::ser::SerializeMap;
use serde::{Deserialize, Serialize, Serializer};

/// Quantity of which an error is measured. The error is the integral of |difference from the reference| over that of
/// |reference|. If the reference is nearly zero nearly everywhere, its integral is at least that of its largest value
/// over a hundredth of the bar or of the time.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub enum Measure {
    /// Stress over the bar and over time.
    Field,
    /// Stress over the bar at the end time, relative to the reference at the end time or to a tenth of its mean over time, whichever is larger.
    FieldAtEnd,
    /// Stress at both ends over time.
    Ends,
    /// Stress at a gauge over time; the largest error of all gauges.
    Gauges,
    /// Plastic strain over the bar at the end time.
    ResidualStrain,
    /// Largest magnitude of the force at an end or a joint, relative to that force; the largest error of all ends and
    /// joints whose force is not negligible compared with the largest force in the bar.
    PeakForce,
}

impl Measure {
    /// Every measure.
    pub const ALL: [Self; 6] =
        [Self::Field, Self::FieldAtEnd, Self::Ends, Self::Gauges, Self::ResidualStrain, Self::PeakForce];

    /// Returns the key in summaries, result files and tables.
    pub fn key(self) -> &'static str {
        match self {
            Self::Field => "field",
            Self::FieldAtEnd => "field_at_end",
            Self::Ends => "ends",
            Self::Gauges => "gauges",
            Self::ResidualStrain => "residual_strain",
            Self::PeakForce => "peak_force",
        }
    }

    /// Returns a description.
    pub fn describe(self) -> &'static str {
        match self {
            Self::Field => "relative L1 of stress over the bar and time",
            Self::FieldAtEnd => "relative L1 of stress over the bar at the end time",
            Self::Ends => "relative L1 of the stress at the ends over time",
            Self::Gauges => "relative L1 of the stress at the worst gauge over time",
            Self::ResidualStrain => "relative L1 of plastic strain over the bar at the end time",
            Self::PeakForce => "relative error of the peak force of an end or a joint",
        }
    }

    /// Returns the measure of a key, in which "-" and "_" are equivalent; `None` if the key is unknown.
    pub fn of_key(key: &str) -> Option<Self> {
        let key = key.replace('-', "_");
        Self::ALL.into_iter().find(|measure| measure.key() == key)
    }
}

/// Largest error of a run, and the largest of its other errors.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Worst {
    /// Measure of the largest error.
    pub measure: Measure,
    /// Largest error.
    pub error: f64,
    /// Largest of the other errors.
    pub others: f64,
}

impl fmt::Display for Worst {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { measure, error, others } = self;
        write!(f, "{} {error:.1e}, all others up to {others:.1e}", measure.key().replace('_', " "))
    }
}

/// Error of every measure; `None` if there is nothing to measure, such as gauges.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct ErrorTable([Option<f64>; 6]);

impl ErrorTable {
    /// Creates a table whose entries are given by a function of the measure.
    pub fn of(value: impl FnMut(Measure) -> Option<f64>) -> Self {
        Self(Measure::ALL.map(value))
    }

    /// Returns the largest entry; `None` if the table is empty.
    pub fn largest(&self) -> Option<(Measure, f64)> {
        let known = Measure::ALL.into_iter().filter_map(|measure| Some((measure, self[measure]?)));
        known.reduce(|a, b| if b.1 > a.1 || b.1.is_nan() { b } else { a })
    }

    /// Returns the largest entry and the largest of the others; `None` if there are fewer than two entries.
    pub fn worst(&self) -> Option<Worst> {
        let (measure, error) = self.largest()?;
        let others = Self::of(|other| self[other].filter(|_| other != measure));
        Some(Worst { measure, error, others: others.largest()?.1 })
    }

    /// Returns the entries that exist.
    pub fn entries(&self) -> impl Iterator<Item = (Measure, f64)> + '_ {
        Measure::ALL.into_iter().filter_map(|measure| Some((measure, self[measure]?)))
    }
}

impl Index<Measure> for ErrorTable {
    type Output = Option<f64>;

    fn index(&self, measure: Measure) -> &Option<f64> {
        &self.0[measure as usize]
    }
}

impl fmt::Display for ErrorTable {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (k, (measure, value)) in self.entries().enumerate() {
            let comma = if k > 0 { ", " } else { "" };
            write!(f, "{comma}{} {value:.1e}", measure.key().replace('_', " "))?;
        }
        Ok(())
    }
}

impl Serialize for ErrorTable {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut map = serializer.serialize_map(Some(self.0.len()))?;
        for measure in Measure::ALL {
            map.serialize_entry(measure.key(), &self[measure])?;
        }
        map.end()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_largest_entry_is_named_and_what_is_not_known_left_out() {
        let table = ErrorTable::of(|measure| match measure {
            Measure::Ends => Some(0.2),
            Measure::Gauges => None,
            _ => Some(0.1),
        });
        assert_eq!(table.largest(), Some((Measure::Ends, 0.2)));
        assert_eq!(
            table.worst().map(|worst| worst.to_string()).as_deref(),
            Some("ends 2.0e-1, all others up to 1.0e-1")
        );
        assert_eq!((ErrorTable::default().largest(), ErrorTable::default().worst()), (None, None));
        let json = serde_json::to_value(table).expect("a map");
        assert!(json["gauges"].is_null() && json["peak_force"] == 0.1);
    }

    #[test]
    fn every_measure_is_found_by_its_key() {
        for measure in Measure::ALL {
            assert_eq!(Measure::of_key(&measure.key().replace('_', "-")), Some(measure));
        }
        assert_eq!(Measure::of_key("fields"), None);
    }
}
