//! Gathers the response of a bar while it is simulated: on a grid, and by front tracking.

use std::time::Instant;

use serde::{Deserialize, Serialize};

use super::response::{Response, evenly};
use super::shape::{Cells, Shape};
use crate::bar::Bar;
use crate::record::{Stepped, Trace, Traces};
use crate::solver::fd::{Quantity, Sampling};
use crate::solver::moc::{FrontTracking, Piece};

/// Values that the fields and the histories may hold, each: fewer instants and rows where the bar has more cells and gauges.
const MOST_VALUES: usize = 1 << 22;
/// Distance between an instant and a step that is rounding, in steps.
const ON_STEP: f64 = 1e-6;
/// Instants that are kept whatever the cells.
const LEAST_INSTANTS: usize = 4;
/// Rows of a history, at least and at most.
const ROWS: [usize; 2] = [1 << 10, 1 << 16];

/// Instants of a grid of so many cells, from those that were asked for (increasing).
fn instants(asked: &[f64], cells: usize) -> Vec<f64> {
    evenly(asked, (MOST_VALUES / cells.max(1)).clamp(LEAST_INSTANTS, asked.len().max(LEAST_INSTANTS)))
}

/// Gathers the response of a bar on a grid.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct GridListener {
    /// Instants of the fields, s, increasing.
    due: Vec<f64>,
    /// s.
    dt: f64,
    /// The step before an instant that lies between two steps, and the fields after it.
    before: Option<(usize, [Shape; 2])>,
    ends: [History; 2],
    gauges: Vec<History>,
    response: Response,
}

impl GridListener {
    /// For a bar before its first step, with fields at the instants `asked` (s, increasing, all or every second, fourth ... of them) and so
    /// many gauges.
    pub fn new(scene: &Bar, bar: &impl Stepped, asked: &[f64], gauges: usize) -> Self {
        let (dt, cells) = (bar.grid().dt, bar.grid().cells());
        let rows = (MOST_VALUES / (gauges + 2)).clamp(ROWS[0], ROWS[1]);
        Self {
            due: instants(asked, cells),
            dt,
            before: None,
            ends: [History::new(rows), History::new(rows)],
            gauges: vec![History::new(rows); gauges],
            response: empty(scene),
        }
    }

    /// The step after which fields are read next; none after the last.
    pub fn next(&self, step: usize) -> Option<usize> {
        let instant = *self.due.get(self.response.fields.len())?;
        let (first, weight) = self.place(instant);
        let last = if weight > 0.0 { first + 1 } else { first };
        [first, last].into_iter().find(|&due| due > step)
    }

    /// The last step that is of interest.
    pub fn last(&self) -> usize {
        self.due.last().map_or(0, |&instant| {
            let (first, weight) = self.place(instant);
            first + usize::from(weight > 0.0)
        })
    }

    /// The step at or before an instant, and how far towards the next one it lies.
    fn place(&self, instant: f64) -> (usize, f64) {
        let place = instant / self.dt;
        // What is a step but for rounding is one.
        if (place - place.round()).abs() < ON_STEP {
            (place.round() as usize, 0.0)
        } else {
            (place as usize, place.fract())
        }
    }

    /// Reads the fields, if they are due: to be called before the first step and after each that [`GridListener::next`] names. Between two
    /// steps fields are interpolated.
    pub fn look(&mut self, bar: &impl Stepped) {
        while let Some(&instant) = self.due.get(self.response.fields.len()) {
            let (first, weight) = self.place(instant);
            let now = [Quantity::Stress, Quantity::PlasticStrain].map(|quantity| profile(bar, quantity));
            let [stress, plastic] = match &self.before {
                _ if bar.step() == first && weight > 0.0 => {
                    self.before = Some((first, now));
                    return;
                }
                _ if bar.step() == first => now,
                Some((step, before)) if *step == first && bar.step() == first + 1 => {
                    [0, 1].map(|k| before[k].clone().towards(&now[k], weight))
                }
                _ => return,
            };
            self.response.fields.push((instant, stress));
            if self.response.fields.len() == self.due.len() {
                self.response.plastic = Some(plastic);
            }
        }
    }

    /// Takes in rows of the histories.
    pub fn hear(&mut self, gauges: &[Trace], ends: &[Trace; 2]) {
        let until = self.due.last().copied().unwrap_or(0.0);
        for (history, trace) in self.ends.iter_mut().zip(ends).chain(self.gauges.iter_mut().zip(gauges)) {
            for (&time, &stress) in trace.time.iter().zip(&trace.stress) {
                // Times are sums of steps: rounding.
                if time <= until * (1.0 + 1e-9) {
                    history.add(time, stress);
                }
            }
        }
    }

    /// What was gathered.
    pub fn response(&self) -> Response {
        let shape = |history: &History| Shape::Points(history.rows.clone());
        Response {
            ends: self.ends.iter().map(shape).collect(),
            gauges: self.gauges.iter().map(shape).collect(),
            peak: self.ends.iter().map(|end| end.largest).fold(0.0, f64::max),
            ..self.response.clone()
        }
    }
}

/// A bar on a grid that is to be stepped for its response alone.
#[derive(Debug, Clone, Copy)]
pub struct Course<'a> {
    /// Instants of the fields, s, increasing; none: nothing is read.
    pub instants: &'a [f64],
    /// Places of the gauges, m.
    pub gauges: &'a [f64],
    /// Steps to take at least.
    pub steps: usize,
    /// Cell-steps between two pauses.
    pub work: usize,
}

/// Steps a bar without recorders: its response, and the time spent in the solver, s. `pause` is called now and then, and may end it.
///
/// # Errors
/// What `pause` returns.
pub fn respond<S: Stepped, E>(
    scene: &Bar,
    bar: &mut S,
    course: Course<'_>,
    mut pause: impl FnMut(&S, usize) -> Result<(), E>,
) -> Result<(Response, f64), E> {
    let mut listening = (!course.instants.is_empty()).then(|| {
        let listener = GridListener::new(scene, bar, course.instants, course.gauges.len());
        (listener, Traces::new(Sampling::at(bar.grid(), course.gauges.to_vec()), false))
    });
    if let Some((listener, traces)) = &mut listening {
        bar.watch(traces);
        bar.add_to(traces);
        listener.look(bar);
    }
    let steps = listening.as_ref().map_or(course.steps, |(listener, _)| course.steps.max(listener.last()));
    let burst = (course.work / bar.grid().cells()).max(1);
    let mut seconds = 0.0;
    while bar.step() < steps {
        let due = listening.as_ref().and_then(|(listener, _)| listener.next(bar.step()));
        let stop = due.unwrap_or(steps).min(bar.step() + burst).min(steps);
        let before = Instant::now();
        match &mut listening {
            Some((_, traces)) => bar.advance_logging(stop - bar.step(), traces),
            None => bar.advance_by(stop - bar.step()),
        }
        seconds += before.elapsed().as_secs_f64();
        if let Some((listener, traces)) = &mut listening {
            listener.look(bar);
            if traces.is_full() || bar.step() == steps {
                let (gauges, ends) = traces.take();
                listener.hear(&gauges, &ends);
            }
        }
        pause(bar, steps)?;
    }
    Ok((listening.map_or_else(Response::default, |(listener, _)| listener.response()), seconds))
}

fn empty(bar: &Bar) -> Response {
    let modulus = bar.segments.iter().map(|segment| segment.material.modulus).fold(0.0, f64::max);
    Response { length: bar.length(), modulus, ..Response::default() }
}

fn profile(bar: &impl Stepped, quantity: Quantity) -> Shape {
    let mut values = vec![0.0; bar.grid().cells()];
    bar.profile(quantity, &mut values);
    Shape::Cells(Cells { segments: bar.grid().segments.clone(), values })
}

/// A history in no more than so many rows: every second one is dropped where it would get longer.
#[derive(Debug, Clone, Serialize, Deserialize)]
struct History {
    rows: Vec<(f64, f64)>,
    most: usize,
    every: usize,
    seen: usize,
    /// Largest magnitude of all rows.
    largest: f64,
}

impl History {
    fn new(most: usize) -> Self {
        Self { rows: Vec::new(), most, every: 1, seen: 0, largest: 0.0 }
    }

    fn add(&mut self, time: f64, stress: f64) {
        self.largest = self.largest.max(stress.abs());
        if self.seen.is_multiple_of(self.every) {
            self.rows.push((time, stress));
            if self.rows.len() > self.most {
                let mut k = 0;
                self.rows.retain(|_| {
                    k += 1;
                    k % 2 == 1
                });
                self.every *= 2;
            }
        }
        self.seen += 1;
    }
}

/// Gathers the response of a bar whose fronts are tracked.
#[derive(Debug, Clone)]
pub struct FrontListener {
    gauges: Vec<(Vec<f64>, Vec<f64>)>,
    response: Response,
}

impl FrontListener {
    /// For a bar at t = 0 with so many gauges.
    pub fn new(scene: &Bar, gauges: usize) -> Self {
        Self { gauges: vec![(Vec::new(), Vec::new()); gauges], response: empty(scene) }
    }

    /// Reads the stress over the bar now.
    pub fn look(&mut self, bar: &FrontTracking) {
        self.response.fields.push((bar.time(), stress_of(bar)));
    }

    /// Takes in rows of the gauges.
    pub fn hear(&mut self, gauges: &[Trace]) {
        for ((times, stresses), trace) in self.gauges.iter_mut().zip(gauges) {
            times.extend(&trace.time);
            stresses.extend(&trace.stress);
        }
    }

    /// What was gathered up to the bar's time.
    pub fn response(mut self, bar: &FrontTracking) -> Response {
        let now = bar.time();
        self.response.plastic = Some(steps(bar, |piece| bar.medium(piece.segment).plastic_strain(piece.point)));
        self.response.gauges = self.gauges.iter().map(|(time, stress)| Shape::from_rows(time, stress)).collect();
        for record in bar.ends() {
            let (mut edges, mut values) = (Vec::new(), Vec::new());
            for (k, step) in record.steps.iter().enumerate() {
                // What another step follows at once lasts no time.
                if record.steps.get(k + 1).is_some_and(|next| next.time == step.time) {
                    continue;
                }
                if !values.is_empty() {
                    edges.push(step.time);
                }
                values.push(step.stress);
            }
            if values.is_empty() {
                values.push(0.0);
            }
            self.response.ends.push(Shape::Steps { edges, values, ends: [0.0, now] });
        }
        self.response.peak = self.response.ends.iter().map(Shape::largest).fold(0.0, f64::max);
        self.response
    }
}

/// Stress over a tracked bar now.
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
        let gaps: Vec<f64> = history.rows.windows(2).map(|pair| pair[1].0 - pair[0].0).collect();
        assert!(gaps.iter().all(|gap| *gap == gaps[0]), "{gaps:?}");
        assert_eq!(history.largest, 9.0);
    }
}
