//! A quantity as a function of time: linear between rows; a repeated time is a jump; the last value is held.

use super::RowError;

/// Smallest change that counts as a rise, relative to the largest magnitude; and largest number of rises: a noisy record has many.
const STEEP: f64 = 0.1;
const MOST_STEEP: usize = 8;

/// A validated history. Before its first row, and before t = 0, the value is zero.
#[derive(Debug, Clone, PartialEq)]
pub struct History {
    time: Vec<f64>,
    value: Vec<f64>,
}

/// Fault of a row of a history, or of a table over x.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum RowFault {
    /// There is no row.
    None,
    /// A number is not finite.
    NotFinite,
    /// The time (or x) is negative.
    Negative,
    /// The time (or x) is less than that of the row before.
    Falls,
    /// The third row with one time (or x).
    Third,
}

impl RowFault {
    /// Returns the fault of a row over time in words that follow "row 3".
    fn over_time(self) -> &'static str {
        match self {
            Self::None => "a history needs at least one row",
            Self::NotFinite => "is not finite",
            Self::Negative => "has a negative time",
            Self::Falls => "is earlier than the row before it",
            Self::Third => "is the third row with the same time",
        }
    }

    /// Returns the fault of a row over x in words that follow "row 3".
    pub(super) fn over_x(self) -> &'static str {
        match self {
            Self::None => "a table over x needs at least one row",
            Self::NotFinite => "is not finite",
            Self::Negative => "has a negative x",
            Self::Falls => "has a smaller x than the row before it",
            Self::Third => "is the third row with the same x",
        }
    }
}

impl History {
    /// Returns a history with a constant value from t = 0 on.
    pub fn constant(value: f64) -> Self {
        Self { time: vec![0.0], value: vec![value] }
    }

    /// Builds a history from rows (time in s, value): at least one, all finite, times >= 0 and never decreasing, and at most two
    /// rows with the same time (the first is the value before the jump, the second after it).
    ///
    /// # Errors
    /// Returns the first row that violates a rule, and the rule.
    pub fn new(rows: &[(f64, f64)]) -> Result<Self, RowError> {
        Self::of_rows(rows).map_err(|(row, fault)| RowError { row, rule: fault.over_time() })
    }

    /// Builds a history as [`Self::new`] does; returns the row and its fault if there is an error.
    pub(super) fn of_rows(rows: &[(f64, f64)]) -> Result<Self, (Option<usize>, RowFault)> {
        if rows.is_empty() {
            return Err((None, RowFault::None));
        }
        for (i, &(t, v)) in rows.iter().enumerate() {
            if !t.is_finite() || !v.is_finite() {
                return Err((Some(i), RowFault::NotFinite));
            }
            if t < 0.0 {
                return Err((Some(i), RowFault::Negative));
            }
            if i > 0 && t < rows[i - 1].0 {
                return Err((Some(i), RowFault::Falls));
            }
            if i > 1 && t == rows[i - 2].0 {
                return Err((Some(i), RowFault::Third));
            }
        }
        Ok(Self { time: rows.iter().map(|r| r.0).collect(), value: rows.iter().map(|r| r.1).collect() })
    }

    /// Returns the history with every value multiplied by `factor`.
    #[must_use]
    pub fn scaled(&self, factor: f64) -> Self {
        Self { time: self.time.clone(), value: self.value.iter().map(|v| factor * v).collect() }
    }

    /// Returns the history with every value below `low` replaced by `low`, and then every value above `high` by `high`; a NaN limit has no effect.
    #[must_use]
    pub fn within(&self, [low, high]: [f64; 2]) -> Self {
        let (mut time, mut value) = (Vec::with_capacity(self.time.len()), Vec::with_capacity(self.time.len()));
        let limited = |v: f64| v.max(low).min(high);
        for (k, (&t, &v)) in self.time.iter().zip(&self.value).enumerate() {
            if let Some((t0, v0)) = k.checked_sub(1).map(|k| (self.time[k], self.value[k])).filter(|(t0, _)| *t0 < t) {
                let mut limits = [low, high].map(|limit| (t0 + (t - t0) * ((limit - v0) / (v - v0)), limit));
                limits.sort_by(|a, b| a.0.total_cmp(&b.0));
                for (crossing, limit) in limits.into_iter().filter(|(crossing, _)| t0 < *crossing && *crossing < t) {
                    time.push(crossing);
                    value.push(limited(limit));
                }
            }
            time.push(t);
            value.push(limited(v));
        }
        Self { time, value }
    }

    /// Returns the intervals (start and end, s) in which the magnitude rises without interruption, within at most `longest` (s), by more than a tenth
    /// of the largest magnitude. Empty if there are more than eight: a noisy record has many.
    pub fn rises(&self, longest: f64) -> Vec<[f64; 2]> {
        let (time, value, least) = (&self.time, &self.value, STEEP * self.extreme().abs());
        let change = |k: usize| value[k + 1] - value[k];
        let pairs: Vec<usize> = (0..time.len() - 1).filter(|&k| change(k) != 0.0).collect();
        let goes_on = |&a: &usize, &b: &usize| b == a + 1 && (change(a) > 0.0) == (change(b) > 0.0);
        let ends = |run: &[usize]| (run[0], run[run.len() - 1] + 1);
        let is_steep = |&(first, last): &(usize, usize)| {
            let lasts = time[last] - time[first];
            let grows = value[last].abs() > value[first].abs();
            grows && 0.0 < lasts && lasts <= longest && (value[last] - value[first]).abs() > least
        };
        let rises: Vec<[f64; 2]> =
            pairs.chunk_by(goes_on).map(ends).filter(is_steep).map(|(a, b)| [time[a], time[b]]).collect();
        if rises.len() > MOST_STEEP { Vec::new() } else { rises }
    }

    /// Returns the history with each of these [`Self::rises`] replaced by a jump at its start.
    #[must_use]
    pub fn jumping(&self, rises: &[[f64; 2]]) -> Self {
        let mut jumps = self.clone();
        for &[from, until] in rises {
            let [first, last] = [from, until].map(|t| jumps.time.partition_point(|&row| row < t));
            let (ahead, behind) = (jumps.before(from), jumps.before(until));
            jumps.time.splice(first..last, [from, from]);
            jumps.value.splice(first..last, [ahead, behind]);
        }
        jumps
    }

    /// Returns the times of the rows, s.
    pub fn time(&self) -> &[f64] {
        &self.time
    }

    /// Returns the values of the rows.
    pub fn value(&self) -> &[f64] {
        &self.value
    }

    /// Returns the history truncated at a time, s; `None` if all rows are before it.
    pub fn until(&self, end: f64) -> Option<Self> {
        let kept = self.time.partition_point(|&row| row < end);
        if kept == self.time.len() {
            return None;
        }
        if kept == 0 {
            return Some(Self::constant(0.0));
        }
        let (mut time, mut value) = (self.time[..kept].to_vec(), self.value[..kept].to_vec());
        time.push(end);
        value.push(self.before(end));
        Some(Self { time, value })
    }

    /// Returns true if the value never changes after t = 0.
    pub fn is_constant(&self) -> bool {
        self.time[0] == 0.0 && self.value.iter().all(|&v| v == self.value[0])
    }

    /// Returns true if the value changes other than by jumps.
    pub fn has_ramp(&self) -> bool {
        self.time.windows(2).zip(self.value.windows(2)).any(|(t, v)| t[1] > t[0] && v[1] != v[0])
    }

    /// Returns the value just after `t`; at a jump, the value after the jump.
    pub fn at(&self, t: f64) -> f64 {
        let next = self.time.partition_point(|&row| row <= t);
        if next == 0 {
            return 0.0;
        }
        if next == self.time.len() {
            return self.value[next - 1];
        }
        let (t0, t1) = (self.time[next - 1], self.time[next]);
        let (v0, v1) = (self.value[next - 1], self.value[next]);
        v0 + (v1 - v0) * ((t - t0) / (t1 - t0))
    }

    /// Returns the value just before `t`; at a jump, the value before the jump.
    pub fn before(&self, t: f64) -> f64 {
        let next = self.time.partition_point(|&row| row < t);
        if next < self.time.len() && self.time[next] == t { self.value[next] } else { self.at(t) }
    }

    /// Returns the time of the first row whose value differs from `rest`, s; that of the last row if there is none.
    pub fn begins(&self, rest: f64) -> f64 {
        let first = self.value.iter().position(|&value| value != rest);
        self.time[first.unwrap_or(self.time.len() - 1)]
    }

    /// Returns the rate of change just after `t`, without jumps, 1/s.
    pub fn rate(&self, t: f64) -> f64 {
        let next = self.time.partition_point(|&row| row <= t);
        if next == 0 || next == self.time.len() {
            return 0.0;
        }
        (self.value[next] - self.value[next - 1]) / (self.time[next] - self.time[next - 1])
    }

    /// Returns the mean over `from..to` (s, from < to), exact for linear pieces and jumps.
    ///
    /// A solver that applies means instead of point values transmits exactly the prescribed impulse or displacement.
    pub fn mean(&self, from: f64, to: f64) -> f64 {
        let last = self.time.len() - 1;
        if from >= self.time[last] {
            return self.value[last];
        }
        let mut integral = 0.0;
        // Rows before the last one at or before `from` do not contribute.
        let first = self.time.partition_point(|&row| row <= from).saturating_sub(1);
        for k in (first..last).take_while(|&k| self.time[k] < to) {
            let (a, b) = (self.time[k].max(from), self.time[k + 1].min(to));
            if b > a {
                let slope = (self.value[k + 1] - self.value[k]) / (self.time[k + 1] - self.time[k]);
                let middle = self.value[k] + slope * (0.5 * (a + b) - self.time[k]);
                integral += middle * (b - a);
            }
        }
        let tail = to - self.time[last].max(from);
        if tail > 0.0 {
            integral += self.value[last] * tail;
        }
        integral / (to - from)
    }

    /// Returns true if the value jumps at a time from `from` to `to` (s), both included.
    pub fn jumps_between(&self, from: f64, to: f64) -> bool {
        let first = self.time.partition_point(|&row| row < from);
        let rows = self.time[first..].iter().take_while(|&&row| row <= to).count();
        self.time[first..first + rows].windows(2).any(|pair| pair[0] == pair[1])
    }

    /// Returns the time up to which the value stays within `drift` of `value` from `from` on, s; `from` if it is not within `drift` at `from`.
    pub fn stays_near(&self, from: f64, value: f64, drift: f64) -> f64 {
        let is_near = |other: f64| (other - value).abs() <= drift;
        if !is_near(self.at(from)) {
            return from;
        }
        let next = self.time.partition_point(|&row| row <= from);
        let Some(k) = (next..self.time.len()).find(|&k| !is_near(self.value[k])) else { return f64::INFINITY };
        let (t, v) = if k == next { (from, self.at(from)) } else { (self.time[k - 1], self.value[k - 1]) };
        // Linear interpolation from the row before.
        let part = (drift - (v - value).abs()) / (self.value[k] - v).abs();
        t + (self.time[k] - t) * part.clamp(0.0, 1.0)
    }

    /// Returns the time (s) up to which, from `from` on, the value only falls back towards `rest`, without a jump and by less than the fraction
    /// `part` of its difference from `rest`; `from` if it does not.
    pub fn lessens_until(&self, from: f64, rest: f64, part: f64) -> f64 {
        let change = self.at(from) - rest;
        let left = |value: f64| (value - rest) / change;
        let (mut time, mut least) = (from, 1.0);
        for (&t, &v) in self.time.iter().zip(&self.value).skip_while(|row| *row.0 <= from) {
            let now = left(v);
            if now > least || t == time {
                return time;
            }
            if now < 1.0 - part {
                return time + (t - time) * ((least - (1.0 - part)) / (least - now));
            }
            (time, least) = (t, now);
        }
        f64::INFINITY
    }

    /// Returns the largest mean rate, relative to the difference from `rest` at `from`, at which the value falls back towards `rest` between `from`
    /// and any time up to `until`, 1/s; times in s.
    pub fn largest_decay_rate(&self, from: f64, rest: f64, until: f64) -> f64 {
        let change = self.at(from) - rest;
        let first = self.time.partition_point(|&row| row <= from);
        let rows = self.time[first..].iter().zip(&self.value[first..]).map(|(&t, &v)| (t, v));
        let last = until.is_finite().then(|| (until, self.before(until)));
        let rate = |(t, v): (f64, f64)| (1.0 - (v - rest) / change) / (t - from);
        rows.take_while(|row| row.0 < until).chain(last).filter(|row| row.0 > from).map(rate).fold(0.0, f64::max)
    }

    /// Returns the history with values held wherever they would fall back towards `rest`, until they jump or rise again.
    #[must_use]
    pub fn holding(&self, rest: f64) -> Self {
        let left = |value: f64| (value - rest).abs();
        let falls = |k: usize| {
            self.time[k] < self.time[k + 1]
                && left(self.value[k + 1]) < left(self.value[k])
                && (self.value[k + 1] - rest) * (self.value[k] - rest) >= 0.0
        };
        let last = self.time.len() - 1;
        let (mut time, mut value) = (vec![self.time[0]], vec![self.value[0]]);
        for k in 0..last {
            let held = value[value.len() - 1];
            if falls(k) {
                // The last value is held for ever if no row follows.
                let goes_on = k + 1 == last || falls(k + 1) || self.time[k + 2] == self.time[k + 1];
                time.push(self.time[k + 1]);
                value.push(held);
                if !goes_on {
                    time.push(self.time[k + 1]);
                    value.push(self.value[k + 1]);
                }
            } else {
                time.push(self.time[k + 1]);
                value.push(self.value[k + 1]);
            }
        }
        Self { time, value }
    }

    /// Returns true if the value starts from 0 and never jumps.
    pub fn is_continuous(&self) -> bool {
        self.value[0] == 0.0 && !self.jumps_between(0.0, f64::INFINITY)
    }

    /// Returns the value of largest magnitude (the first one, if several are equal).
    pub fn extreme(&self) -> f64 {
        self.value.iter().fold(0.0, |m: f64, &v| if v.abs() > m.abs() { v } else { m })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rises_are_short_and_large_and_end_where_the_value_holds_or_falls() {
        let history = |rows: &[(f64, f64)]| History::new(rows).expect("rows are right");
        let pulse = [(0.0, 0.0), (5.0, 0.0), (5.2, 1.0), (5.5, 4.0), (9.0, 4.0), (9.0, 2.0), (9.3, 0.0), (9.5, 0.1)];
        let pulse = history(&pulse);
        assert_eq!(pulse.rises(0.4), Vec::<[f64; 2]>::new());
        assert_eq!(pulse.rises(0.5), [[5.0, 5.5]]);
        let jumps = [(0.0, 0.0), (5.0, 0.0), (5.0, 4.0), (5.5, 4.0), (9.0, 4.0), (9.0, 2.0), (9.3, 0.0), (9.5, 0.1)];
        assert_eq!(pulse.jumping(&pulse.rises(0.5)), history(&jumps));
        let from_start = history(&[(0.0, 0.0), (0.5, 4.0), (9.0, 4.0)]);
        assert_eq!(
            from_start.jumping(&from_start.rises(1.0)),
            history(&[(0.0, 0.0), (0.0, 4.0), (0.5, 4.0), (9.0, 4.0)])
        );
        assert_eq!(History::constant(3.0).rises(1.0), Vec::<[f64; 2]>::new());
        let noisy: Vec<(f64, f64)> = (0..20).map(|k| (0.1 * f64::from(k), f64::from(k % 2))).collect();
        assert_eq!(history(&noisy).rises(1.0), Vec::<[f64; 2]>::new());
    }

    #[test]
    fn a_value_lessens_until_it_rises_jumps_or_has_lost_its_part() {
        let until =
            |rows: &[(f64, f64)], from: f64| History::new(rows).expect("rows are right").lessens_until(from, 1.0, 0.5);
        assert_eq!(until(&[(0.0, 5.0), (4.0, 1.0)], 0.0), 2.0);
        assert_eq!(until(&[(0.0, -3.0), (1.0, -2.0), (3.0, 0.0)], 0.0), 2.0);
        assert_eq!(until(&[(0.0, 5.0), (1.0, 4.0), (2.0, 4.5)], 0.0), 1.0);
        assert_eq!(until(&[(0.0, 5.0), (1.0, 4.0), (1.0, 3.5)], 0.0), 1.0);
        assert_eq!(until(&[(0.0, 5.0), (1.0, 6.0)], 0.0), 0.0);
        assert_eq!(until(&[(0.0, 1.0), (3.0, 1.0), (3.0, 5.0), (4.0, 4.0)], 3.0), f64::INFINITY);
    }

    #[test]
    fn a_value_holds_in_place_of_falling_back() {
        let history = |rows: &[(f64, f64)]| History::new(rows).expect("rows are right");
        let falls = history(&[(0.0, 5.0), (1.0, 4.0), (2.0, 3.0), (3.0, 6.0), (4.0, 5.0), (4.0, 7.0), (5.0, 2.0)]);
        let holds = [(0.0, 5.0), (1.0, 5.0), (2.0, 5.0), (2.0, 3.0), (3.0, 6.0), (4.0, 6.0), (4.0, 7.0), (5.0, 7.0)];
        assert_eq!(falls.holding(0.0), history(&holds));
        let rises = history(&[(0.0, 0.0), (1.0, 4.0), (2.0, 4.0)]);
        assert_eq!(rises.holding(0.0), rises);
    }

    #[test]
    fn mean_is_exact_across_ramps_and_jumps() {
        let h = History::new(&[(0.0, 0.0), (2.0, 4.0), (2.0, 1.0), (3.0, 1.0)]).expect("rows are right");
        assert_eq!(h.mean(0.0, 2.0), 2.0);
        assert_eq!(h.mean(1.0, 3.0), 2.0);
        assert_eq!(h.mean(-1.0, 1.0), 0.5);
        assert_eq!(h.mean(5.0, 9.0), 1.0);
        assert_eq!(h.at(2.0), 1.0);
        assert_eq!(h.at(1.0), 2.0);
    }

    #[test]
    fn limits_are_met_where_the_value_crosses_them() {
        let h = History::new(&[(0.0, 0.0), (2.0, 4.0), (2.0, -8.0), (4.0, 0.0)]).expect("rows are right");
        let limited = h.within([-4.0, 2.0]);
        assert_eq!(limited.time(), [0.0, 1.0, 2.0, 2.0, 3.0, 4.0]);
        assert_eq!(limited.value(), [0.0, 2.0, 2.0, -4.0, -4.0, 0.0]);
        assert_eq!(h.within([f64::NEG_INFINITY, f64::INFINITY]), h);
        let through_both = History::new(&[(0.0, -3.0), (1.0, 3.0)]).expect("rows are right").within([-1.0, 2.0]);
        assert_eq!(through_both.value(), [-1.0, -1.0, 2.0, 2.0]);
    }

    #[test]
    fn long_histories_are_searched_not_scanned() {
        let rows: Vec<(f64, f64)> = (0..200_000).map(|k| (f64::from(k / 2), f64::from(k % 7))).collect();
        let h = History::new(&rows).expect("rows are right");
        let whole: f64 = (0..99_999).map(|k| 0.5 * (rows[2 * k + 1].1 + rows[2 * k + 2].1)).sum();
        assert!((h.mean(0.0, 99_999.0) * 99_999.0 - whole).abs() < 1e-9 * whole);
        // 10^6 look-ups in 10^5 rows: seconds if each of them read all rows, as this test would show by its time.
        let looked: usize =
            (0..1_000_000).filter(|k| h.jumps_between(f64::from(k / 11), f64::from(k / 11) + 0.5)).count();
        assert_eq!(looked, 1_000_000);
        assert!(!h.jumps_between(0.25, 0.75));
        assert_eq!(h.mean(3.0, 3.5), 0.5 * (2.0 * rows[7].1 + 0.5 * (rows[8].1 - rows[7].1)));
    }

    #[test]
    fn wrong_rows_are_refused_by_index() {
        assert_eq!(History::new(&[]).expect_err("wrong").at(), 0);
        assert_eq!(History::new(&[(1.0, 0.0), (0.5, 0.0)]).expect_err("wrong").at(), 1);
        assert_eq!(History::new(&[(0.0, 0.0), (0.0, 1.0), (0.0, 2.0)]).expect_err("wrong").at(), 2);
        assert_eq!(History::new(&[(0.0, f64::NAN)]).expect_err("wrong").at(), 0);
    }
}
