//! History of an end of a bar on a grid.
//!
//! A grid solver knows the state of an end as its mean over each step. Where the state varies smoothly, its value between
//! two steps is the average of the two means. Where it jumps between two steps, because a front arrives or a body strikes,
//! parabolas with the means over three steps before and after the jump give the values on both sides: two rows at one time,
//! of third order. During a sudden load the exact state replaces these values, see [`SuddenLoad`].

use serde::{Deserialize, Serialize};

use super::Trace;
use crate::bar::SuddenLoad;
use crate::solver::{EndSample, EndState};

/// Ratio of a change between two steps to the adjacent changes above which it is a jump. Over smooth data the ratio is about 1.
const JUMP_RATIO: f64 = 3.0;

/// Change, relative to the largest value, up to which a jump is attributed to rounding.
const ROUNDING: f64 = 1e-6;

/// Largest relative variation of the change from one step to the next for which a curvature is used; above it the data oscillate.
const MAX_CURVATURE_RATIO: f64 = 0.5;

/// Number of samples before and after a sample that are needed to write its row.
const BEHIND: usize = 2;
const AHEAD: usize = 3;

/// History of an end under construction.
#[derive(Debug, Clone, Default, Serialize, Deserialize)]
pub struct EndRows {
    /// Samples and their times (s), from [`BEHIND`] before the next row to be written onwards.
    samples: Vec<(f64, EndSample)>,
    /// Number of `samples` whose rows are written; fewer than [`BEHIND`] at the start of the run.
    written: usize,
    /// Sudden loads of the end, in order of time.
    sudden: Vec<SuddenLoad>,
    /// Largest magnitudes of the means over steps so far.
    largest: EndState,
    rows: Trace,
}

impl EndRows {
    /// Creates an empty history whose rows are collected in the columns `rows`, of an end with the given sudden loads.
    pub fn new(rows: Trace, sudden: Vec<SuddenLoad>) -> Self {
        Self { sudden, rows, ..Self::default() }
    }

    /// Returns the number of complete rows.
    pub fn ready(&self) -> usize {
        self.rows.time.len()
    }

    /// Adds samples, each one step after the previous one.
    pub fn add(&mut self, samples: impl Iterator<Item = (f64, EndSample)>) {
        let sudden = &self.sudden;
        self.samples.extend(samples.map(|(time, sample)| (time, with_sudden_load(sudden, time, sample))));
        self.write(AHEAD);
    }

    /// Writes the remaining rows at the end of a run.
    pub fn close(&mut self) {
        self.write(0);
    }

    /// Discards samples and rows from a time (s) onwards.
    pub fn drop_from(&mut self, time: f64) {
        self.samples.retain(|sample| sample.0 < time);
        self.written = self.written.min(self.samples.len());
        let kept = self.rows.time.partition_point(|&at| at < time);
        self.rows.columns_mut().into_iter().for_each(|column| column.truncate(kept));
    }

    /// Returns the rows since the last call; later rows are collected in `columns`.
    pub fn take(&mut self, columns: Trace) -> Trace {
        std::mem::replace(&mut self.rows, columns)
    }

    fn write(&mut self, ahead: usize) {
        let end = self.samples.len().saturating_sub(ahead);
        for k in self.written..end {
            self.write_row(k);
        }
        self.written = self.written.max(end);
        let past = self.written.saturating_sub(BEHIND);
        self.samples.drain(..past);
        self.written -= past;
    }

    fn write_row(&mut self, k: usize) {
        let (time, EndSample { now, latest }) = self.samples[k];
        let next = self.mean(k + 1);
        self.largest.stress = self.largest.stress.max(next.stress.abs());
        self.largest.velocity = self.largest.velocity.max(next.velocity.abs());
        let column = |of: fn(&EndState) -> f64| {
            let before = |steps: usize| k.checked_sub(steps).map_or(f64::NAN, |k| of(&self.mean(k)));
            let after = |steps: usize| of(&self.mean(k + 1 + steps));
            sides([of(&latest), before(1), before(2)], [of(&next), after(1), after(2)], ROUNDING * of(&self.largest))
        };
        let [stress, velocity] = [column(|state| state.stress), column(|state| state.velocity)];
        // If a sudden load makes the bar yield immediately, the state just after t = 0 is approximated by that after the first step.
        let after = self.samples.get(k + 1).map_or(EndState::UNKNOWN, |sample| sample.1.now);
        let smooth = [now, latest.mean(next), latest, next, after].into_iter().find(|state| !state.stress.is_nan());
        let smooth = smooth.unwrap_or_default();
        if stress.is_none() && velocity.is_none() {
            return self.push(time, smooth);
        }
        for side in [0, 1] {
            let read = |sides: Option<[f64; 2]>, smooth: f64| sides.map_or(smooth, |sides| sides[side]);
            self.push(
                time,
                EndState { stress: read(stress, smooth.stress), velocity: read(velocity, smooth.velocity) },
            );
        }
    }

    /// Returns the mean over the step before sample `k`; unknown beyond the last sample.
    fn mean(&self, k: usize) -> EndState {
        self.samples.get(k).map_or(EndState::UNKNOWN, |sample| sample.1.latest)
    }

    fn push(&mut self, time: f64, state: EndState) {
        self.rows.time.push(time);
        self.rows.stress.push(state.stress);
        self.rows.velocity.push(state.velocity);
    }
}

/// Returns a sample as the history shows it: with the exact state during a sudden load.
fn with_sudden_load(sudden: &[SuddenLoad], time: f64, sample: EndSample) -> EndSample {
    let EndState { stress, velocity } = if sample.now.stress.is_nan() { sample.latest } else { sample.now };
    // The latest load that has started replaces those before it.
    match sudden.iter().rev().find_map(|load| load.end(time, [stress, velocity])) {
        Some([stress, velocity]) => EndSample { now: EndState { stress, velocity }, latest: EndState::UNKNOWN },
        None => sample,
    }
}

/// Returns the values on both sides of a jump, from the means over the steps before and after it, the nearest first; `None` if there is no jump.
fn sides(before: [f64; 3], after: [f64; 3], rounding: f64) -> Option<[f64; 2]> {
    let jump = (after[0] - before[0]).abs();
    let changes = [before, after].map(|means| means[1] - means[0]);
    let beside = changes.into_iter().filter(|change| !change.is_nan()).map(f64::abs).reduce(f64::max)?;
    (jump > JUMP_RATIO * beside && jump > rounding).then(|| [edge(before), edge(after)])
}

/// Returns the value at the beginning of the first of three steps, from the means over them.
fn edge(means: [f64; 3]) -> f64 {
    let [first, second] = [means[1] - means[0], means[2] - means[1]];
    if first.is_nan() {
        return means[0];
    }
    let bend = second - first;
    means[0] - 0.5 * first + if bend.abs() <= MAX_CURVATURE_RATIO * first.abs() { bend / 3.0 } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    const UNTIL: f64 = 4.0;

    /// Returns the rows of a stress with a known integral, computed from its means over steps.
    fn rows(integral: impl Fn(f64) -> f64, steps: usize, batch: usize) -> Trace {
        let (dt, start) = (UNTIL / steps as f64, EndState { stress: 0.0, velocity: 1.0 });
        let sample = |k: usize| {
            let time = k as f64 * dt;
            let mean = (integral(time) - integral(time - dt)) / dt;
            let latest = if k == 0 { EndState::UNKNOWN } else { EndState { stress: mean, velocity: 1.0 } };
            (time, EndSample { now: if k == 0 { start } else { EndState::UNKNOWN }, latest })
        };
        let mut rows = EndRows::default();
        let samples: Vec<_> = (0..=steps).map(sample).collect();
        samples.chunks(batch).for_each(|batch| rows.add(batch.iter().copied()));
        rows.close();
        rows.take(Trace::default())
    }

    /// Integral of exp(-t), to which 2 exp(-(t - 2)) is added from t = 2 on.
    fn struck(t: f64) -> f64 {
        let pulse = |t: f64, height: f64| if t > 0.0 { height * -(-t).exp_m1() } else { 0.0 };
        pulse(t, 1.0) + pulse(t - 2.0, 2.0)
    }

    #[test]
    fn values_on_both_sides_of_a_jump_are_of_third_order() {
        let error = |steps: usize| {
            let rows = rows(struck, steps, 7);
            let at = rows.time.windows(2).position(|pair| pair[0] == pair[1]).expect("a jump");
            let jumps = rows.time.windows(2).filter(|pair| pair[0] == pair[1]).count();
            assert_eq!((rows.time[at], jumps, rows.time.len()), (2.0, 1, steps + 2));
            let before = (-2.0_f64).exp();
            let errors = [rows.stress[at] - before, rows.stress[at + 1] - 2.0 - before];
            errors.map(f64::abs).into_iter().fold(0.0, f64::max)
        };
        let [coarse, fine] = [40, 80].map(error);
        assert!(coarse < 1e-3 && (7.0..9.0).contains(&(coarse / fine)), "{coarse} {fine}");
    }

    #[test]
    fn batches_make_no_difference() {
        let whole = rows(struck, 40, 41);
        for batch in 1..9 {
            assert_eq!(rows(struck, 40, batch), whole);
        }
    }

    #[test]
    fn smooth_histories_have_a_row_a_step() {
        for power in [2.0, 2.5, 3.0] {
            let rows = rows(|t: f64| t.max(0.0).powf(power), 50, 50);
            assert_eq!(rows.time.len(), 51);
            assert!(rows.velocity.iter().all(|&v| v == 1.0));
        }
        let wave = rows(|t: f64| (3.0 * t).sin(), 200, 200);
        assert_eq!(wave.time.len(), 201);
        for (t, stress) in wave.time.iter().zip(&wave.stress).take(200).skip(1) {
            assert!((stress - 3.0 * (3.0 * t).cos()).abs() < 2e-3, "{t}");
        }
    }

    #[test]
    fn a_solver_that_knows_the_present_is_believed_where_means_are_not_known() {
        let known = EndSample { now: EndState { stress: 5.0, velocity: 2.0 }, latest: EndState::UNKNOWN };
        let mut rows = EndRows::default();
        rows.add((0..6).map(|k| (f64::from(k), known)));
        rows.drop_from(4.0);
        rows.close();
        let rows = rows.take(Trace::default());
        assert_eq!((rows.time, rows.stress, rows.velocity), (vec![0.0, 1.0, 2.0, 3.0], vec![5.0; 4], vec![2.0; 4]));
    }
}
