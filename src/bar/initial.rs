//! Initial state of a segment: uniform, or as tables over x.

use serde::Serialize;

use super::history::RowFault;
use super::{History, RowError};
use crate::law::Deformed;

/// State of a segment at t = 0. Whatever held it is removed at t = 0: waves start where forces differ at joints and ends.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize)]
pub struct Initial {
    /// Stress, Pa, tension positive; the same at every section of a tapered segment.
    pub stress: f64,
    /// Signed plastic strain (engineering), as left by slow loading.
    pub plastic_strain: f64,
    /// Accumulated plastic strain, >= |plastic strain|; not used by kinematic hardening.
    pub accumulated: f64,
    /// Temperature above the material's reference temperature, K, >= 0.
    pub temperature_rise: f64,
}

impl Initial {
    /// Returns true if the state concerns the material law: if there is plastic strain or a temperature rise.
    pub fn is_of_a_law(&self) -> bool {
        self.plastic_strain != 0.0 || self.accumulated != 0.0 || self.temperature_rise != 0.0
    }

    /// Returns the state in the form needed by the material law, for an elastic modulus in Pa.
    pub fn deformed(&self, modulus: f64) -> Deformed {
        Deformed {
            plastic: modulus * self.plastic_strain,
            accumulated: modulus * self.accumulated,
            temperature_rise: self.temperature_rise,
        }
    }
}

/// State of a segment at t = 0 that varies along it; x is measured from the left end of the segment, in m.
#[derive(Debug, Clone, PartialEq)]
pub struct InitialProfile {
    /// Velocity, m/s, positive in +x.
    pub velocity: Distribution,
    /// Stress, Pa.
    pub stress: Distribution,
    /// Signed plastic strain.
    pub plastic_strain: Distribution,
    /// Accumulated plastic strain.
    pub accumulated: Distribution,
    /// Temperature above the reference temperature, K.
    pub temperature_rise: Distribution,
}

/// A quantity as a function of x, linear between rows. A repeated x is a jump; beyond the outermost rows the value is constant.
#[derive(Debug, Clone, PartialEq)]
pub struct Distribution(History);

impl Distribution {
    /// Returns a uniform distribution.
    pub fn constant(value: f64) -> Self {
        Self(History::constant(value))
    }

    /// Builds a distribution from rows (x in m >= 0, value): at least one, all finite, x never decreasing, at most two rows with the same x.
    ///
    /// # Errors
    /// Returns the first row that violates a rule, and the rule.
    pub fn new(rows: &[(f64, f64)]) -> Result<Self, RowError> {
        let first = rows.first().filter(|row| row.0 > 0.0).map(|row| (0.0, row.1));
        let shift = usize::from(first.is_some());
        let all: Vec<(f64, f64)> = first.into_iter().chain(rows.iter().copied()).collect();
        let over_x = |(row, fault): (Option<usize>, RowFault)| RowError {
            row: row.map(|row| row.saturating_sub(shift)),
            rule: fault.over_x(),
        };
        History::of_rows(&all).map(Self).map_err(over_x)
    }

    /// Returns the rows.
    pub fn rows(&self) -> impl Iterator<Item = (f64, f64)> {
        self.0.time().iter().copied().zip(self.0.value().iter().copied())
    }

    /// Returns the value just to the right of x.
    pub fn at(&self, x: f64) -> f64 {
        self.0.at(x)
    }

    /// Returns the value just to the left of x.
    pub fn before(&self, x: f64) -> f64 {
        self.0.before(x)
    }

    /// Returns the exact mean over `from..to`.
    pub fn mean(&self, from: f64, to: f64) -> f64 {
        if self.0.value().len() == 1 { self.0.value()[0] } else { self.0.mean(from, to) }
    }

    /// Returns the distribution with every value multiplied by `factor`.
    #[must_use]
    pub fn scaled(&self, factor: f64) -> Self {
        Self(self.0.scaled(factor))
    }

    /// Returns the part over `from..to`, with x measured from `from`.
    #[must_use]
    pub fn part(&self, from: f64, to: f64) -> Self {
        let inner = self.rows().filter(|&(x, _)| from < x && x < to).map(|(x, value)| (x - from, value));
        let rows = [(0.0, self.at(from))].into_iter().chain(inner).chain([(to - from, self.before(to))]);
        Self(History::new(&rows.collect::<Vec<_>>()).expect("rows of a table are in order"))
    }

    /// Returns the distribution of `combine` applied to the values of several tables at the same x, linear between the rows of all tables.
    pub fn combined<const N: usize>(tables: [&Self; N], combine: impl Fn([f64; N]) -> f64) -> Self {
        let mut rows = Vec::new();
        for x in knots(tables) {
            let [before, after] = [tables.map(|table| table.before(x)), tables.map(|table| table.at(x))].map(&combine);
            if x > 0.0 && before != after {
                rows.push((x, before));
            }
            rows.push((x, after));
        }
        Self(History::new(&rows).expect("knots are in order"))
    }

    /// Returns the distribution of the magnitudes, with an additional row at each change of sign.
    #[must_use]
    pub fn size(&self) -> Self {
        let rows: Vec<(f64, f64)> = self.rows().collect();
        let mut all = Vec::with_capacity(rows.len());
        for (k, &(x, value)) in rows.iter().enumerate() {
            if let Some(&(x0, before)) =
                k.checked_sub(1).map(|k| &rows[k]).filter(|row| row.1 * value < 0.0 && row.0 < x)
            {
                all.push((x0 + (x - x0) * before / (before - value), 0.0));
            }
            all.push((x, value.abs()));
        }
        Self(History::new(&all).expect("rows of a table are in order"))
    }

    /// Returns the largest magnitude.
    pub fn largest(&self) -> f64 {
        self.0.extreme().abs()
    }
}

/// Returns all x of the rows of several tables, ascending and without duplicates; 0 is included.
fn knots<'a>(tables: impl IntoIterator<Item = &'a Distribution>) -> Vec<f64> {
    let mut knots: Vec<f64> = tables.into_iter().flat_map(|table| table.0.time()).copied().collect();
    knots.push(0.0);
    knots.sort_by(f64::total_cmp);
    knots.dedup();
    knots
}

impl InitialProfile {
    fn tables(&self) -> [&Distribution; 5] {
        [&self.velocity, &self.stress, &self.plastic_strain, &self.accumulated, &self.temperature_rise]
    }

    fn map(&self, change: impl Fn(&Distribution) -> Distribution) -> Self {
        let [velocity, stress, plastic_strain, accumulated, temperature_rise] = self.tables().map(change);
        Self { velocity, stress, plastic_strain, accumulated, temperature_rise }
    }

    /// Returns all x at which a table has a row, m, ascending.
    pub fn knots(&self) -> Vec<f64> {
        knots(self.tables())
    }

    /// Returns true if no quantity varies along the segment.
    pub fn is_uniform(&self) -> bool {
        self.tables().iter().all(|table| table.0.value().iter().all(|value| *value == table.0.value()[0]))
    }

    /// Returns true if any part of the segment is stressed, has flowed or is warm, so that not only the velocity varies.
    pub fn has_state(&self) -> bool {
        let [_, state @ ..] = self.tables();
        state.iter().any(|table| table.largest() > 0.0)
    }

    /// Returns true if a quantity varies other than by jumps.
    pub fn has_slopes(&self) -> bool {
        self.tables().iter().any(|table| table.0.has_ramp())
    }

    /// Returns the state just to the left (`side` 0) or right (1) of x.
    pub fn one_sided_limit(&self, x: f64, side: usize) -> Initial {
        let [stress, plastic_strain, accumulated, temperature_rise] =
            [&self.stress, &self.plastic_strain, &self.accumulated, &self.temperature_rise]
                .map(|table| if side == 0 { table.before(x) } else { table.at(x) });
        Initial { stress, plastic_strain, accumulated, temperature_rise }
    }

    /// Returns the mean state over `from..to`.
    pub fn mean(&self, from: f64, to: f64) -> Initial {
        let [stress, plastic_strain, accumulated, temperature_rise] =
            [&self.stress, &self.plastic_strain, &self.accumulated, &self.temperature_rise]
                .map(|table| table.mean(from, to));
        Initial { stress, plastic_strain, accumulated: accumulated.max(plastic_strain.abs()), temperature_rise }
    }

    /// Returns the part over `from..to`, with x measured from `from`.
    #[must_use]
    pub fn part(&self, from: f64, to: f64) -> Self {
        self.map(|table| table.part(from, to))
    }

    /// Returns the profile that is constant between the positions `borders` (m, ascending, from the left to the right end), with the mean values.
    #[must_use]
    pub fn staircase(&self, borders: &[f64]) -> Self {
        self.map(|table| {
            let steps = borders.windows(2).map(|pair| (pair[0], pair[1], table.mean(pair[0], pair[1])));
            let rows: Vec<_> = steps.flat_map(|(from, to, value)| [(from, value), (to, value)]).collect();
            Distribution(History::new(&rows).expect("borders increase"))
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn table(rows: &[(f64, f64)]) -> Distribution {
        Distribution::new(rows).expect("rows are right")
    }

    #[test]
    fn values_hold_beyond_the_rows_and_jump_where_x_is_repeated() {
        let table = table(&[(1.0, 2.0), (2.0, 4.0), (2.0, 1.0), (3.0, 1.0)]);
        assert_eq!([0.0, 0.5, 1.5, 2.0, 9.0].map(|x| table.at(x)), [2.0, 2.0, 3.0, 1.0, 1.0]);
        assert_eq!([2.0, 3.0, 0.0].map(|x| table.before(x)), [4.0, 1.0, 2.0]);
        assert_eq!((table.mean(0.0, 2.0), table.mean(1.0, 4.0)), (2.5, 5.0 / 3.0));
        let said = |rows: &[(f64, f64)]| Distribution::new(rows).expect_err("wrong").to_string();
        assert_eq!(said(&[(1.0, 0.0), (0.5, 0.0)]), "row 2 has a smaller x than the row before it");
        assert_eq!(said(&[]), "a table over x needs at least one row");
    }

    #[test]
    fn parts_and_combinations_are_the_tables_again() {
        let whole = table(&[(0.0, 0.0), (2.0, 4.0), (2.0, 1.0), (3.0, -1.0)]);
        let [left, right] = [whole.part(0.0, 2.0), whole.part(2.0, 3.0)];
        assert_eq!((left.at(1.0), left.before(2.0), right.at(0.0), right.at(0.5)), (2.0, 4.0, 1.0, 0.0));
        let sum = Distribution::combined([&whole, &table(&[(0.0, 1.0), (1.0, 3.0)])], |[a, b]| a + b);
        assert_eq!([0.5, 1.5, 2.5].map(|x| sum.at(x)), [3.0, 6.0, 3.0]);
        assert_eq!((sum.before(2.0), sum.at(2.0)), (7.0, 4.0));
        let size = whole.size();
        assert_eq!((size.at(2.5), size.at(2.75), size.at(3.0)), (0.0, 0.5, 1.0));
    }

    #[test]
    fn a_staircase_has_the_means() {
        let ramp = table(&[(0.0, 0.0), (2.0, 4.0)]);
        let zero = Distribution::constant(0.0);
        let profile = InitialProfile {
            velocity: zero.clone(),
            stress: ramp,
            plastic_strain: zero.clone(),
            accumulated: zero.clone(),
            temperature_rise: zero,
        };
        let stairs = profile.staircase(&[0.0, 0.5, 2.0]);
        assert_eq!((stairs.one_sided_limit(0.5, 0).stress, stairs.one_sided_limit(0.5, 1).stress), (0.5, 2.5));
        assert_eq!(stairs.mean(0.0, 2.0).stress, 2.0);
    }
}
