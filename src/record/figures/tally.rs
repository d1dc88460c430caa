//! Peaks, times and impulses of stress and strain histories, collected while the histories are written.

use serde::{Deserialize, Serialize};

use crate::bar::joint::NO_FORCE;
use crate::bar::{Bar, SuddenLoad};
use crate::record::Trace;

/// A value counts as larger than the largest so far if it exceeds it by this part: the ripple of rounding on a constant stress does not
/// move the time of its peak.
const LARGER: f64 = 1.0 + 1e-9;

/// Stresses up to this part of the modulus are none: what rounding leaves of waves that cancel.
const NO_STRESS: f64 = 1e-12;

/// The largest magnitude of a history with its sign, and where or when it was first reached; both 0 at the start.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub struct Extreme {
    /// The value.
    pub value: f64,
    /// Time (s) or place (m).
    pub at: f64,
}

impl Extreme {
    /// Takes a value at a time or place.
    pub fn add(&mut self, at: f64, value: f64) {
        if value.abs() > LARGER * self.value.abs() {
            *self = Self { value, at };
        }
    }
}

/// A stress is no peak of which two steps later less than one part in this is left, where flow takes the elastic stress away within a step: it is that of
/// the step in which a wave comes to a joint. At a fixed end of steel behind aluminium (Johnson-Cook) it was 110 kN by leapfrog and 100 kN by the net,
/// for 84 kN from the third step on.
const SPIKE: f64 = 1.05;

/// The largest stress of a history.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub(super) struct Peak {
    /// Pa, and when it was first reached, s.
    pub largest: Extreme,
    /// Rows count only once it is seen that they last, see [`SPIKE`].
    waits: bool,
    /// Times (s) and stresses (Pa) of the two latest rows that do not count yet.
    waiting: [Option<(f64, f64)>; 2],
}

impl Peak {
    fn add(&mut self, time: f64, stress: f64) {
        if !self.waits {
            self.largest.add(time, stress);
            return;
        }
        let [before, last] = self.waiting;
        if let Some((at, value)) = before.filter(|&(_, value)| value.abs() <= SPIKE * stress.abs()) {
            self.largest.add(at, value);
        }
        self.waiting = [last, Some((time, stress))];
    }

    /// No more rows come.
    fn close(&mut self) {
        for (time, stress) in std::mem::take(&mut self.waiting).into_iter().flatten() {
            self.largest.add(time, stress);
        }
    }
}

/// What a face carried.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub(super) struct Load {
    /// Stress.
    pub peak: Peak,
    /// Total time under stress, s.
    pub duration: f64,
    /// When it was last under stress, s.
    pub loaded_until: f64,
    /// No stress in the last row.
    pub is_released: bool,
    /// Of the last row, s.
    pub last_time: f64,
    no_stress: f64,
    /// A sudden load of a joint, with its stress in the rows, Pa.
    sudden: Option<(SuddenLoad, f64)>,
}

impl Load {
    fn new(modulus: f64, waits: bool) -> Self {
        let peak = Peak { waits, ..Peak::default() };
        Self { peak, no_stress: NO_STRESS * modulus, is_released: true, ..Self::default() }
    }

    /// A row counts to the next one if both carry stress; none counts after `last` (s).
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

/// What a gauge saw.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub(super) struct Gauge {
    pub stress: Peak,
    pub strain: Extreme,
}

/// What the histories of a run came to so far.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Tally {
    pub(super) ends: [Load; 2],
    pub(super) gauges: Vec<Gauge>,
    pub(super) joints: Vec<Load>,
}

impl Tally {
    /// Of a bar with so many gauges. Histories of the stress beside its joints follow those of the gauges. `relaxes`: flow takes the elastic stress of
    /// sharp waves away within a step.
    pub fn new(bar: &Bar, gauges: usize, relaxes: bool) -> Self {
        let loads: Vec<Load> =
            bar.segments.iter().map(|segment| Load::new(segment.material.modulus, relaxes)).collect();
        let last = loads.len() - 1;
        let gauge = Gauge { stress: Peak { waits: relaxes, ..Peak::default() }, ..Gauge::default() };
        Self { ends: [loads[0], loads[last]], gauges: vec![gauge; gauges], joints: loads[..last].to_vec() }
    }

    /// No more rows come.
    pub fn close(&mut self) {
        self.gauges.iter_mut().for_each(|gauge| gauge.stress.close());
        self.ends.iter_mut().chain(&mut self.joints).for_each(|load| load.peak.close());
    }

    /// Joints are suddenly loaded: each with the stress beside it (Pa). The rows of ends include their sudden loads.
    pub fn start_under(&mut self, joints: impl Iterator<Item = (usize, SuddenLoad, f64)>) {
        for (joint, load, stress) in joints {
            self.joints[joint].sudden = Some((load, stress));
        }
    }

    /// Number of the scene's gauges.
    pub fn gauges(&self) -> usize {
        self.gauges.len()
    }

    /// Takes rows: of the gauges and the joints, and of both ends. `breaks`: when each joint breaks, s; infinite while it holds. From then on the
    /// stress beside it is that of a fragment, not of the joint.
    pub fn hear(&mut self, gauges: &[Trace], ends: &[Trace; 2], breaks: &[f64]) {
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

    /// Stresses that last for a step or two are no peaks where flow takes them away, whatever batches rows come in; a wave that ends the run is one.
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
