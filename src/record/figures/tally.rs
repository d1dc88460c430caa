//! Peaks of stress and strain histories and times under load, collected while the histories are written.

use serde::{Deserialize, Serialize};

use crate::bar::joint::NO_FORCE;
use crate::bar::{Bar, SuddenLoad};
use crate::record::Trace;

/// Ratio by which a value must exceed the largest one so far to replace it. Rounding errors of a constant stress thus
/// do not shift the time of its peak.
const LARGER: f64 = 1.0 + 1e-9;

/// Stress, relative to the modulus, up to which a face counts as unloaded: waves that cancel leave rounding errors.
const NO_STRESS: f64 = 1e-12;

/// Value of largest magnitude in a history, with its sign, and the place or time at which it was first reached; both are 0 at the start.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub struct Extreme {
    /// Value of largest magnitude.
    pub value: f64,
    /// Time (s) or place (m) at which it was first reached.
    pub at: f64,
}

impl Extreme {
    /// Adds a value at a time or place.
    pub fn add(&mut self, at: f64, value: f64) {
        if value.abs() > LARGER * self.value.abs() {
            *self = Self { value, at };
        }
    }
}

/// Largest ratio of a stress to that two steps later for which it counts as a peak, if flow removes the elastic stress
/// within a step. Larger stresses belong to the step in which a wave arrives at a joint: at a fixed end of steel behind
/// aluminium (Johnson-Cook) they were 110 kN by leapfrog and 100 kN by the net, instead of 84 kN from the third step
/// on.
const SPIKE: f64 = 1.05;

/// Largest stress of a history.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub(super) struct Peak {
    /// Stress of largest magnitude, Pa, and the time at which it was first reached, s.
    pub largest: Extreme,
    /// True if a row counts only once the stress is known to last, see [`SPIKE`].
    needs_confirmation: bool,
    /// Times (s) and stresses (Pa) of the two latest rows, which do not count yet.
    pending: [Option<(f64, f64)>; 2],
}

impl Peak {
    fn add(&mut self, time: f64, stress: f64) {
        if !self.needs_confirmation {
            self.largest.add(time, stress);
            return;
        }
        let [before, last] = self.pending;
        if let Some((at, value)) = before.filter(|&(_, value)| value.abs() <= SPIKE * stress.abs()) {
            self.largest.add(at, value);
        }
        self.pending = [last, Some((time, stress))];
    }

    /// Counts the pending rows at the end of the history.
    fn close(&mut self) {
        for (time, stress) in std::mem::take(&mut self.pending).into_iter().flatten() {
            self.largest.add(time, stress);
        }
    }
}

/// Load that a face has carried.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub(super) struct Load {
    /// Largest stress.
    pub peak: Peak,
    /// Total time under stress, s.
    pub duration: f64,
    /// Last time under stress, s.
    pub loaded_until: f64,
    /// True if there is no stress in the last row.
    pub is_released: bool,
    /// Time of the last row, s.
    pub last_time: f64,
    no_stress: f64,
    /// Sudden load of a joint, and its stress on the side to which the rows refer, Pa.
    sudden: Option<(SuddenLoad, f64)>,
}

impl Load {
    fn new(modulus: f64, needs_confirmation: bool) -> Self {
        let peak = Peak { needs_confirmation, ..Peak::default() };
        Self { peak, no_stress: NO_STRESS * modulus, is_released: true, ..Self::default() }
    }

    /// Adds rows up to the time `last` (s). An interval between two rows counts as time under stress if both rows carry stress.
    fn add(&mut self, rows: &Trace, last: f64) {
        for (&time, &stress) in rows.time.iter().zip(&rows.stress).take_while(|&(&time, _)| time <= last) {
            self.peak.add(time, self.sudden.map_or(stress, |(load, known)| load.blend(time, known, stress)));
            let is_released = stress.abs() <= self.no_stress.max(NO_FORCE * self.peak.largest.value.abs());
            if !is_released && !self.is_released {
                self.duration += time - self.last_time;
                self.loaded_until = time;
            }
            (self.last_time, self.is_released) = (time, is_released);
        }
    }
}

/// Peaks at a gauge.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub(super) struct Gauge {
    pub stress: Peak,
    pub strain: Extreme,
}

/// Peaks and durations of the histories of a run so far.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Tally {
    pub(super) ends: [Load; 2],
    pub(super) gauges: Vec<Gauge>,
    pub(super) joints: Vec<Load>,
}

impl Tally {
    /// Creates the tally of a bar with a number of gauges. The histories of the stress at its joints follow those of
    /// the gauges. `relaxes` is true if flow removes the elastic stress of sharp waves within a step.
    pub fn new(bar: &Bar, gauges: usize, relaxes: bool) -> Self {
        let loads: Vec<Load> =
            bar.segments.iter().map(|segment| Load::new(segment.material.modulus, relaxes)).collect();
        let last = loads.len() - 1;
        let gauge = Gauge { stress: Peak { needs_confirmation: relaxes, ..Peak::default() }, ..Gauge::default() };
        Self { ends: [loads[0], loads[last]], gauges: vec![gauge; gauges], joints: loads[..last].to_vec() }
    }

    /// Counts the pending rows at the end of the run.
    pub fn close(&mut self) {
        self.gauges.iter_mut().for_each(|gauge| gauge.stress.close());
        self.ends.iter_mut().chain(&mut self.joints).for_each(|load| load.peak.close());
    }

    /// Sets the sudden loads of joints, each with the stress on the left of the joint (Pa). The rows of the ends already include their sudden loads.
    pub fn start_under(&mut self, joints: impl Iterator<Item = (usize, SuddenLoad, f64)>) {
        for (joint, load, stress) in joints {
            self.joints[joint].sudden = Some((load, stress));
        }
    }

    /// Returns the number of the scene's gauges.
    pub fn gauges(&self) -> usize {
        self.gauges.len()
    }

    /// Adds rows of the gauges and joints, and of both ends. `breaks` are the times at which the joints fracture, s,
    /// infinite for a joint that holds; from this time on the stress next to a joint is that of a fragment, not of the
    /// joint.
    pub fn add_rows(&mut self, gauges: &[Trace], ends: &[Trace; 2], breaks: &[f64]) {
        let (gauges, joints) = gauges.split_at(self.gauges.len().min(gauges.len()));
        for (tally, rows) in self.gauges.iter_mut().zip(gauges) {
            for ((&time, &stress), &strain) in rows.time.iter().zip(&rows.stress).zip(&rows.strain) {
                tally.stress.add(time, stress);
                tally.strain.add(time, strain);
            }
        }
        for ((load, rows), &breaks) in self.joints.iter_mut().zip(joints).zip(breaks) {
            load.add(rows, breaks);
        }
        for (load, rows) in self.ends.iter_mut().zip(ends) {
            load.add(rows, f64::INFINITY);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn rows(rows: &[(f64, f64)]) -> Trace {
        let (time, stress) = rows.iter().copied().unzip();
        Trace { time, stress, ..Trace::default() }
    }

    #[test]
    fn time_under_stress_is_that_between_loaded_rows_of_any_batch() {
        let all = [(0.0, 0.0), (1.0, 0.0), (1.0, -5.0), (3.0, -5.0), (3.0, 0.0), (4.0, 0.0), (4.0, 2.0), (4.5, 2.0)];
        for cut in 0..all.len() {
            let mut load = Load::new(1.0, false);
            load.add(&rows(&all[..cut]), 4.5);
            load.add(&rows(&all[cut..]), 4.5);
            assert_eq!((load.duration, load.loaded_until, load.is_released), (2.5, 4.5, false), "{cut}");
            assert_eq!(load.peak.largest, Extreme { value: -5.0, at: 1.0 });
        }
    }

    #[test]
    fn ripples_of_rounding_do_not_move_a_peak() {
        let mut load = Load::new(1.0, false);
        load.add(
            &rows(&[(0.0, 0.0), (1.0, 3.0), (2.0, 3.0 * (1.0 + 1e-13)), (3.0, 1e-15), (4.0, -1e-15), (5.0, 9.0)]),
            4.0,
        );
        assert_eq!((load.peak.largest.at, load.duration, load.is_released), (1.0, 1.0, true));
    }

    /// Stresses that flow removes within two steps are not peaks, however the rows are batched; a wave in the last rows of the run is one.
    #[test]
    fn what_flow_takes_away_within_two_steps_is_no_peak() {
        let all = [0.0, -110.0, -90.0, -79.0, -79.5, -84.0, -83.0, -82.0, -82.0, -90.0, -91.0];
        let all: Vec<(f64, f64)> = all.iter().enumerate().map(|(k, &stress)| (k as f64, stress)).collect();
        for cut in 0..all.len() {
            let mut load = Load::new(1.0, true);
            load.add(&rows(&all[..cut]), 20.0);
            load.add(&rows(&all[cut..]), 20.0);
            assert_eq!(load.peak.largest, Extreme { value: -84.0, at: 5.0 }, "{cut}");
            load.peak.close();
            assert_eq!(load.peak.largest, Extreme { value: -91.0, at: 10.0 }, "{cut}");
        }
    }
}
