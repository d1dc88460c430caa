//! Initial state of a segment: uniform, or tables over x.

use serde::Serialize;

use super::history::RowFault;
use super::{History, RowError};
use crate::law::Deformed;

/// The state of a segment at t = 0. What held it is taken away then: where forces differ at joints and ends, waves start.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize)]
pub struct Initial {
    /// Pa, tension positive; of a tapered segment the same at every section.
    pub stress: f64,
    /// Signed plastic strain (engineering), as left by slow loading.
    pub plastic_strain: f64,
    /// Accumulated plastic strain, >= the size of the plastic strain; hardening that moves the elastic range does not read it.
    pub accumulated: f64,
    /// Temperature above the material's reference temperature, K, >= 0.
    pub temperature_rise: f64,
}

impl Initial {
    /// The law has to know of it: it has flowed, or is warm.
    pub fn is_of_a_law(&self) -> bool {
        self.plastic_strain != 0.0 || self.accumulated != 0.0 || self.temperature_rise != 0.0
    }

    /// What its law has to know of it, for an elastic modulus in Pa.
    pub fn deformed(&self, modulus: f64) -> Deformed {
        Deformed {
            plastic: modulus * self.plastic_strain,
            accumulated: modulus * self.accumulated,
            temperature_rise: self.temperature_rise,
        }
    }
}

/// The state of a segment at t = 0 that changes along it; x is measured from the segment's own left end, in m.
#[derive(Debug, Clone, PartialEq)]
pub struct InitialProfile {
    /// m/s, positive in +x.
    pub velocity: Distribution,
    /// Pa.
    pub stress: Distribution,
    /// Signed plastic strain.
    pub plastic_strain: Distribution,
    /// Accumulated plastic strain.
    pub accumulated: Distribution,
    /// K.
    pub temperature_rise: Distribution,
}

/// A quantity over x, straight between rows; a repeated x is a jump, and beyond the outermost rows their values hold.
#[derive(Debug, Clone, PartialEq)]
pub struct Distribution(History);

impl Distribution {
    /// The same value everywhere.
    pub fn constant(value: f64) -> Self {
        Self(History::constant(value))
    }

    /// From rows (x in m >= 0, value): at least one, finite, x never decreasing, at most two rows with one x.
    ///
    /// # Errors
    /// The first row that breaks a rule, and which rule.
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

    /// The rows.
    pub fn rows(&self) -> impl Iterator<Item = (f64, f64)> {
        self.0.time().iter().copied().zip(self.0.value().iter().copied())
    }

    /// The value just to the right of x.
    pub fn at(&self, x: f64) -> f64 {
        self.0.at(x)
    }

    /// The value just to the left of x.
    pub fn before(&self, x: f64) -> f64 {
        self.0.before(x)
    }

    /// The mean over `from..to`, exact.
    pub fn mean(&self, from: f64, to: f64) -> f64 {
        if self.0.value().len() == 1 { self.0.value()[0] } else { self.0.mean(from, to) }
    }

    /// The same with every value times `factor`.
    #[must_use]
    pub fn scaled(&self, factor: f64) -> Self {
        Self(self.0.scaled(factor))
    }

    /// The part over `from..to`, x counted from `from`.
    #[must_use]
    pub fn part(&self, from: f64, to: f64) -> Self {
        let inner = self.rows().filter(|&(x, _)| from < x && x < to).map(|(x, value)| (x - from, value));
        let rows = [(0.0, self.at(from))].into_iter().chain(inner).chain([(to - from, self.before(to))]);
        Self(History::new(&rows.collect::<Vec<_>>()).expect("rows of a table are in order"))
    }

    /// What `combine` makes of the values of some tables at one x, straight between the rows of any of them.
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

    /// The size of its values, with a row where it changes sign.
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

    /// The largest size of its values.
    pub fn largest(&self) -> f64 {
        self.0.extreme().abs()
    }
}

/// All x of some tables' rows, increasing, each once; 0 among them.
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

    /// All x at which a table has a row, m, increasing.
    pub fn knots(&self) -> Vec<f64> {
        knots(self.tables())
    }

    /// Nothing changes along the segment.
    pub fn is_uniform(&self) -> bool {
        self.tables().iter().all(|table| table.0.value().iter().all(|value| *value == table.0.value()[0]))
    }

    /// Some place of it is stressed, has flowed or is warm: not the velocity alone changes.
    pub fn has_state(&self) -> bool {
        let [_, state @ ..] = self.tables();
        state.iter().any(|table| table.largest() > 0.0)
    }

    /// A quantity changes between jumps.
    pub fn has_slopes(&self) -> bool {
        self.tables().iter().any(|table| table.0.has_ramp())
    }

    /// The state just to the left (`side` 0) or right (1) of x.
    pub fn beside(&self, x: f64, side: usize) -> Initial {
        let [stress, plastic_strain, accumulated, temperature_rise] =
            [&self.stress, &self.plastic_strain, &self.accumulated, &self.temperature_rise]
                .map(|table| if side == 0 { table.before(x) } else { table.at(x) });
        Initial { stress, plastic_strain, accumulated, temperature_rise }
    }

    /// Means over `from..to`.
    pub fn mean(&self, from: f64, to: f64) -> Initial {
        let [stress, plastic_strain, accumulated, temperature_rise] =
            [&self.stress, &self.plastic_strain, &self.accumulated, &self.temperature_rise]
                .map(|table| table.mean(from, to));
        Initial { stress, plastic_strain, accumulated: accumulated.max(plastic_strain.abs()), temperature_rise }
    }

    /// The part over `from..to`, x counted from `from`.
    #[must_use]
    pub fn part(&self, from: f64, to: f64) -> Self {
        self.map(|table| table.part(from, to))
    }

    /// Constant between the places of `borders` (m, increasing, from the left to the right end), by the means there.
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
        assert_eq!((stairs.beside(0.5, 0).stress, stairs.beside(0.5, 1).stress), (0.5, 2.5));
        assert_eq!(stairs.mean(0.0, 2.0).stress, 2.0);
    }
}
