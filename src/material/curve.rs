//! A first-loading stress-strain curve: a checked table, straight between its knots.

use serde::Serialize;

/// What happens past the last knot.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Beyond {
    /// The last knot is where the specimen broke.
    Rupture,
    /// The last slope goes on.
    Extend,
    /// The data say nothing: a run that gets there stops.
    Error,
}

/// The point on which a critical impact velocity rests.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Ultimate {
    /// Strain at that point.
    pub strain: f64,
    /// Stress at that point, Pa.
    pub stress: f64,
    /// Why it is the ultimate point.
    pub reason: UltimateReason,
}

/// Why a curve has an ultimate point.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum UltimateReason {
    /// The engineering stress has its largest value inside the data and does not rise after it.
    MaximumStress,
    /// The data end by fracture while the stress still rises.
    RuptureStrain,
}

/// Why a table is refused: the row (from 0) and the values that are wrong.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error("row {}: {message}", row + 1)]
pub struct CurveError {
    /// Row of the table as given, from 0.
    pub row: usize,
    /// What is wrong, with the value.
    pub message: String,
}

/// Straight between knots, starting at (0, 0); magnitudes; strain strictly increasing. Stress may fall (a yield
/// drop, necking) and slopes may grow (lock-up).
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Curve {
    strain: Vec<f64>,
    stress: Vec<f64>,
    beyond: Beyond,
}

impl Curve {
    /// Checks a table of (strain, stress in Pa) magnitudes. A missing first row (0, 0) is added.
    ///
    /// # Errors
    /// Fewer than two knots, a value that is not finite or negative, strain that does not increase, stress at
    /// zero strain, a first slope that is not positive.
    pub fn new(rows: &[(f64, f64)], beyond: Beyond) -> Result<Self, CurveError> {
        let _ = (rows, beyond);
        todo!()
    }

    /// Knot strains, from 0.
    pub fn strain(&self) -> &[f64] {
        &self.strain
    }

    /// Knot stresses, Pa, from 0.
    pub fn stress(&self) -> &[f64] {
        &self.stress
    }

    /// What happens past the last knot.
    pub fn beyond(&self) -> Beyond {
        self.beyond
    }

    /// Slopes of the segments, Pa; one fewer than knots.
    pub fn slopes(&self) -> impl Iterator<Item = f64> + '_ {
        self.strain.windows(2).zip(self.stress.windows(2)).map(|(e, s)| (s[1] - s[0]) / (e[1] - e[0]))
    }

    /// The steepest slope, Pa.
    pub fn steepest(&self) -> f64 {
        self.slopes().fold(0.0, f64::max)
    }

    /// Strain of the last knot.
    pub fn last_strain(&self) -> f64 {
        self.strain[self.strain.len() - 1]
    }

    /// End of the part that follows `modulus` from the origin (strain, stress): the elastic limit. (0, 0) where
    /// the first slope is smaller than `modulus`.
    pub fn elastic_limit(&self, modulus: f64) -> (f64, f64) {
        let _ = modulus;
        todo!()
    }

    /// Stress at a strain >= 0; past the last knot the last slope goes on with `Beyond::Extend`, otherwise the
    /// last stress is held.
    pub fn stress_at(&self, strain: f64) -> f64 {
        let _ = strain;
        todo!()
    }

    /// The point on which the critical velocity rests, or none within the data.
    pub fn ultimate(&self) -> Option<Ultimate> {
        todo!()
    }

    /// The curve with every drop filled: f(e) = max over e' <= e of the table. This is what waves can carry into
    /// the bar, since a falling stress has no wave speed; with its upper concave hull unchanged.
    #[must_use]
    pub fn running_maximum(&self) -> Self {
        todo!()
    }
}
