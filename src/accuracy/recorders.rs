//! Recording of the response of a bar during a simulation: on a grid, and by front tracking.

use serde::{Deserialize, Serialize};

use super::joint_forces::{JointForces, Peak};
use super::response::{Response, evenly};
use super::shape::{Cells, Shape};
use crate::bar::{Bar, Segment, SuddenLoad};
use crate::law::rupture::Rupture;
use crate::record::{EndHistories, Extreme, Stepped, Trace};
use crate::solver::fd::Quantity;
use crate::solver::moc::{FrontTracking, Piece};

/// Largest number of values of the fields, and of the histories: instants and rows are omitted if the bar has many cells or gauges.
const MOST_VALUES: usize = 1 << 22;
/// Distance between an instant and a step, in steps, up to which it is attributed to rounding.
const ON_STEP: f64 = 1e-6;
/// Smallest number of instants that are recorded, for any number of cells.
const LEAST_INSTANTS: usize = 4;
/// Smallest and largest number of rows of a history.
const ROWS: [usize; 2] = [1 << 10, 1 << 20];

/// Returns the instants to be recorded on a grid with this number of cells, selected from the requested ones (increasing).
fn instants(requested: &[f64], cells: usize) -> Vec<f64> {
    evenly(requested, (MOST_VALUES / cells.max(1)).clamp(LEAST_INSTANTS, requested.len().max(LEAST_INSTANTS)))
}

/// Recorder of the response of a bar on a grid.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct GridRecorder {
    /// Instants of the fields, s, increasing.
    due: Vec<f64>,
    /// Time step, s.
    dt: f64,
    /// Step before an instant that lies between two steps, and the stress and plastic strain after this step.
    before: Option<(usize, [Shape; 2])>,
    ends: [History; 2],
    gauges: Vec<History>,
    joints: JointForces,
    /// Sudden loads of the left and the right end.
    sudden: [Vec<SuddenLoad>; 2],
    response: Response,
}

impl GridRecorder {
    /// Creates the recorder of a bar before its first step. The fields are recorded at the instants `requested` (s,
    /// increasing) or at every second, fourth, ... of them. `gauges` is the number of gauges, and `joints` are the
    /// segments to the left of the joints.
    pub fn new(scene: &Bar, bar: &impl Stepped, requested: &[f64], gauges: usize, joints: &[usize]) -> Self {
        let (dt, cells) = (bar.grid().dt, bar.grid().cells());
        let rows = (MOST_VALUES / (gauges + 2)).clamp(ROWS[0], ROWS[1]);
        let mut joints = JointForces::new(scene, joints);
        let sudden = bar.sudden_loads();
        joints.start_under(&sudden.joints);
        Self {
            due: instants(requested, cells),
            dt,
            before: None,
            ends: [History::new(rows), History::new(rows)],
            gauges: vec![History::new(rows); gauges],
            joints,
            sudden: sudden.ends,
            response: empty(scene),
        }
    }

    /// Returns the step after which fields are read next; `None` after the last one.
    pub fn next(&self, step: usize) -> Option<usize> {
        let instant = *self.due.get(self.response.fields.len())?;
        let (first, weight) = self.place(instant);
        let last = if weight > 0.0 { first + 1 } else { first };
        [first, last].into_iter().find(|&due| due > step)
    }

    /// Returns the last step that is needed.
    pub fn last(&self) -> usize {
        self.due.last().map_or(0, |&instant| {
            let (first, weight) = self.place(instant);
            first + usize::from(weight > 0.0)
        })
    }

    /// Returns the step at or before an instant, and the fraction of a step from there to the instant.
    fn place(&self, instant: f64) -> (usize, f64) {
        let place = instant / self.dt;
        // An instant that differs from a step by rounding lies on it.
        if (place - place.round()).abs() < ON_STEP {
            (place.round() as usize, 0.0)
        } else {
            (place as usize, place.fract())
        }
    }

    /// Reads the fields if they are due. To be called before the first step and after each step returned by
    /// [`GridRecorder::next`]. Between two steps the fields are interpolated.
    pub fn read_fields(&mut self, bar: &impl Stepped) {
        while let Some(&instant) = self.due.get(self.response.fields.len()) {
            let (first, weight) = self.place(instant);
            let before = self.before.as_ref().filter(|(step, _)| *step == first && bar.step() == first + 1);
            if before.is_none() && bar.step() != first {
                return;
            }
            let now = [Quantity::Stress, Quantity::PlasticStrain].map(|quantity| profile(bar, quantity));
            let [stress, plastic] = match before {
                Some((_, before)) => [0, 1].map(|k| before[k].clone().towards(&now[k], weight)),
                None if weight > 0.0 => {
                    self.before = Some((first, now));
                    return;
                }
                None => now,
            };
            self.response.fields.push((instant, stress));
            if self.response.fields.len() == self.due.len() {
                self.response.plastic = Some(plastic);
                self.joints.close(bar.ruptures(), &bar.contacts());
            }
        }
    }

    /// Adds rows of the histories; those of the joints follow those of the gauges. `ruptures` are the fractures of the bar so far.
    pub fn add_rows(&mut self, gauges: &[Trace], ends: &[Trace; 2], ruptures: &[Rupture]) {
        // The factor allows for rounding: times are sums of steps.
        let until = self.due.last().copied().unwrap_or(0.0) * (1.0 + 1e-9);
        self.joints.add_rows(&gauges[self.gauges.len()..], 0, until, ruptures);
        for (history, trace) in self.ends.iter_mut().zip(ends).chain(self.gauges.iter_mut().zip(gauges)) {
            for (&time, &stress) in trace.time.iter().zip(&trace.stress) {
                if time <= until {
                    history.add(time, stress);
                }
            }
        }
    }

    /// Returns the response recorded so far.
    pub fn response(&self) -> Response {
        let shape = |history: &History| Shape::Points(history.points());
        Response {
            ends: self.ends.iter().map(shape).collect(),
            gauges: self.gauges.iter().map(shape).collect(),
            ..self.response.clone()
        }
        .with_peaks(self.end_peaks(), &self.joints)
    }

    /// Returns the peaks of the ends, as forces on a section of 1 m^2.
    fn end_peaks(&self) -> [Peak; 2] {
        std::array::from_fn(|side| Peak::new(self.ends[side].largest, self.sudden[side].iter()))
    }
}

/// Returns a response without fields and histories.
pub(super) fn empty(bar: &Bar) -> Response {
    let modulus = bar.segments.iter().map(|segment| segment.material.modulus).fold(0.0, f64::max);
    let lengths = bar.segments.iter().map(|segment| segment.length).collect();
    let [first, last] = [&bar.segments[0], &bar.segments[bar.segments.len() - 1]];
    let sections = [first.end_areas()[0], last.end_areas()[1]];
    let least = bar.segments.iter().flat_map(Segment::end_areas).fold(f64::INFINITY, f64::min);
    Response { lengths, modulus, sections, least_section: least, ..Response::default() }
}

fn profile(bar: &impl Stepped, quantity: Quantity) -> Shape {
    let mut values = vec![0.0; bar.grid().cells()];
    bar.profile(quantity, &mut values);
    Shape::Cells(Cells { segments: bar.grid().segments.clone(), values })
}

/// History with a limited number of rows. If it would exceed the limit, every second step is removed, except at jumps, which have a row on each side.
#[derive(Debug, Clone, Serialize, Deserialize)]
struct History {
    rows: Vec<Row>,
    /// Last row added, stored or not.
    last: Option<Row>,
    most: usize,
    every: usize,
    /// Largest stress of all rows, including those that are not stored, Pa.
    largest: Extreme,
}

#[derive(Debug, Clone, Copy, Serialize, Deserialize)]
struct Row {
    step: usize,
    time: f64,
    stress: f64,
}

impl History {
    fn new(most: usize) -> Self {
        Self { rows: Vec::new(), last: None, most, every: 1, largest: Extreme::default() }
    }

    fn add(&mut self, time: f64, stress: f64) {
        self.largest.add(time, stress);
        let (step, other_side) = match self.last {
            None => (0, None),
            Some(last) if last.time == time => (last.step, Some(last)),
            Some(last) => (last.step + 1, None),
        };
        let row = Row { step, time, stress };
        self.last = Some(row);
        let kept = step.is_multiple_of(self.every);
        if let Some(before) = other_side.filter(|_| !kept) {
            self.rows.push(before);
        }
        if kept || other_side.is_some() {
            self.rows.push(row);
            if self.rows.len() > self.most {
                self.thin();
            }
        }
    }

    fn thin(&mut self) {
        self.every *= 2;
        let rows = &self.rows;
        let pairs = |k: usize, other: Option<usize>| {
            other.and_then(|k| rows.get(k)).is_some_and(|row| row.step == rows[k].step)
        };
        let kept =
            |&k: &usize| rows[k].step.is_multiple_of(self.every) || pairs(k, k.checked_sub(1)) || pairs(k, Some(k + 1));
        self.rows = (0..rows.len()).filter(kept).map(|k| rows[k]).collect();
        self.most = self.most.max(2 * self.rows.len());
    }

    fn points(&self) -> Vec<(f64, f64)> {
        self.rows.iter().map(|row| (row.time, row.stress)).collect()
    }
}

/// Recorder of the response of a front-tracking bar.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct FrontRecorder {
    gauges: Vec<(Vec<f64>, Vec<f64>)>,
    joints: JointForces,
    response: Response,
}

impl FrontRecorder {
    /// Creates the recorder of a bar at t = 0 with this number of gauges; `joints` are the segments to the left of the joints.
    pub fn new(scene: &Bar, gauges: usize, joints: &[usize]) -> Self {
        let gauges = vec![(Vec::new(), Vec::new()); gauges];
        Self { gauges, joints: JointForces::new(scene, joints), response: empty(scene) }
    }

    /// Records the stress over the bar at the current time.
    pub fn read_fields(&mut self, bar: &FrontTracking) {
        self.response.fields.push((bar.time(), stress_of(bar)));
    }

    /// Adds rows of the gauges, followed by those of the joints; `ruptures` are the fractures of the bar so far.
    pub fn add_rows(&mut self, gauges: &[Trace], ruptures: &[Rupture]) {
        // In front tracking, joints are read on their right side.
        self.joints.add_rows(&gauges[self.gauges.len()..], 1, f64::INFINITY, ruptures);
        for ((times, stresses), trace) in self.gauges.iter_mut().zip(gauges) {
            times.extend(&trace.time);
            stresses.extend(&trace.stress);
        }
    }

    /// Returns the response up to the bar's current time.
    pub fn response(mut self, bar: &FrontTracking) -> Response {
        self.response.plastic = Some(steps(bar, |piece| bar.medium(piece.segment).plastic_strain(piece.point)));
        self.response.gauges = self.gauges.iter().map(|(time, stress)| Shape::from_rows(time, stress)).collect();
        for (mut rows, last) in EndHistories::default().take(bar).into_iter().zip(EndHistories::last(bar)) {
            rows.time.extend(last.time);
            rows.stress.extend(last.stress);
            self.response.ends.push(Shape::from_rows(&rows.time, &rows.stress));
        }
        self.joints.close(bar.ruptures(), &[]);
        let ends = std::array::from_fn(|side| peak_of(self.response.ends.get(side)));
        self.response.with_peaks(ends, &self.joints)
    }
}

/// Returns the peak of a history without a fading sudden load, as a force on a section of 1 m^2.
pub(super) fn peak_of(history: Option<&Shape>) -> Peak {
    Peak { force: history.map_or(0.0, Shape::largest), has_no_limit: false }
}

/// Returns the stress over a front-tracking bar at the current time.
fn stress_of(bar: &FrontTracking) -> Shape {
    steps(bar, |piece| piece.point.stress)
}

fn steps(bar: &FrontTracking, value: impl Fn(&Piece<'_>) -> f64) -> Shape {
    let (mut edges, mut values, mut length) = (Vec::new(), Vec::new(), 0.0);
    for piece in bar.pieces() {
        let here = value(&piece);
        length = piece.to;
        if values.last() == Some(&here) {
            continue;
        }
        if !values.is_empty() {
            edges.push(piece.from);
        }
        values.push(here);
    }
    if values.is_empty() {
        values.push(0.0);
    }
    Shape::Steps { edges, values, ends: [0.0, length] }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_long_history_is_thinned_evenly_and_keeps_its_peak() {
        let mut history = History::new(16);
        for k in 0..1000 {
            history.add(f64::from(k), if k == 501 { -9.0 } else { 1.0 });
        }
        assert!(history.rows.len() <= 17 && history.rows.len() > 8, "{}", history.rows.len());
        let gaps: Vec<f64> = history.rows.windows(2).map(|pair| pair[1].time - pair[0].time).collect();
        assert!(gaps.iter().all(|gap| *gap == gaps[0]), "{gaps:?}");
        assert_eq!(history.largest, Extreme { value: -9.0, at: 501.0 });
    }

    #[test]
    fn jumps_outlast_the_thinning_of_a_history() {
        let mut history = History::new(16);
        for k in 0..1000 {
            history.add(f64::from(k), if k <= 333 { 0.0 } else { 1.0 });
            if k == 333 {
                history.add(f64::from(k), 1.0);
            }
        }
        let at: Vec<f64> = history.points().iter().filter(|row| row.0 == 333.0).map(|row| row.1).collect();
        assert_eq!((at, history.rows.len() <= 18), (vec![0.0, 1.0], true));
        // A history that consists of jumps keeps all its rows.
        let mut history = History::new(16);
        for k in 0..100 {
            history.add(f64::from(k), 0.0);
            history.add(f64::from(k), 1.0);
        }
        assert_eq!(history.rows.len(), 200);
    }
}
