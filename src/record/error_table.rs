//! The errors of a run: one number for each recorded quantity.

use std::fmt;
use std::ops::Index;

use serde::ser::SerializeMap;
use serde::{Deserialize, Serialize, Serializer};

/// What an error is of. Each is the integral of |difference from the reference| over that of |reference|. Where the reference is nearly
/// zero nearly everywhere, its integral counts as if a hundredth of the bar or of the time had its largest value.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub enum Measure {
    /// Stress over the bar and over time.
    Field,
    /// Stress over the bar at the end time, relative to that or to a tenth of the mean over time, whichever is larger.
    FieldAtEnd,
    /// Stress at both ends over time.
    Ends,
    /// Stress at a gauge over time: the largest of all gauges.
    Gauges,
    /// Plastic strain over the bar at the end time.
    ResidualStrain,
    /// Largest magnitude of the force at an end or a joint, relative to its own: the largest error of all of them that are not negligible beside
    /// the largest force in the bar.
    PeakForce,
}

impl Measure {
    /// All of them.
    pub const ALL: [Self; 6] =
        [Self::Field, Self::FieldAtEnd, Self::Ends, Self::Gauges, Self::ResidualStrain, Self::PeakForce];

    /// Its key in summaries, result files and tables.
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

    /// In words.
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

    /// The measure of a key; "-" and "_" are alike.
    pub fn of_key(key: &str) -> Option<Self> {
        let key = key.replace('-', "_");
        Self::ALL.into_iter().find(|measure| measure.key() == key)
    }
}

/// The largest error of a run, and the largest of all others.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Worst {
    /// What it is of.
    pub measure: Measure,
    /// How large it is.
    pub error: f64,
    /// The largest of all others.
    pub others: f64,
}

impl fmt::Display for Worst {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { measure, error, others } = self;
        write!(f, "{} {error:.1e}, all others up to {others:.1e}", measure.key().replace('_', " "))
    }
}

/// An error for every measure; none where there is nothing to measure, as without gauges.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct ErrorTable([Option<f64>; 6]);

impl ErrorTable {
    /// Every entry by a function of its measure.
    pub fn of(value: impl FnMut(Measure) -> Option<f64>) -> Self {
        Self(Measure::ALL.map(value))
    }

    /// The largest entry; none in an empty table.
    pub fn largest(&self) -> Option<(Measure, f64)> {
        let known = Measure::ALL.into_iter().filter_map(|measure| Some((measure, self[measure]?)));
        known.reduce(|a, b| if b.1 > a.1 || b.1.is_nan() { b } else { a })
    }

    /// The largest entry and the largest of all others; none where there are not as many.
    pub fn worst(&self) -> Option<Worst> {
        let (measure, error) = self.largest()?;
        let others = Self::of(|other| self[other].filter(|_| other != measure));
        Some(Worst { measure, error, others: others.largest()?.1 })
    }

    /// The entries that there are.
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
