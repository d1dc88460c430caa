//! Frames at asked times. Output never bends the time step: a frame between two steps is interpolated in time.

use super::{Field, Frame, Stepped, View};
use crate::solver::fd::Sampling;

/// Makes the frames of a bar on a grid, in order of time.
#[derive(Debug)]
pub struct Frames {
    times: Vec<f64>,
    next: usize,
    fields: Vec<Field>,
    sampling: Sampling,
    /// The bar at the step before the current one, kept while a frame lies between the two.
    before: Option<Frame>,
}

/// A frame closer to a step than this part of the time step is that step: times written as decimal numbers come no
/// nearer to a multiple of dt.
const SAME_TIME: f64 = 1e-6;

impl Frames {
    /// Frames at `times` (increasing, s) of `fields` at the places of `sampling`.
    pub fn new(times: Vec<f64>, fields: Vec<Field>, sampling: Sampling) -> Self {
        Self { times, next: 0, fields, sampling, before: None }
    }

    /// The sample places, m.
    pub fn x(&self) -> &[f64] {
        self.sampling.x()
    }

    /// The frames that fall due up to the bar's current time; call it after every step, and once at the start.
    pub fn take(&mut self, bar: &impl Stepped) -> Vec<Frame> {
        let (now, dt) = (bar.time(), bar.grid().dt);
        let mut due = Vec::new();
        let mut current = None;
        while let Some(&time) = self.times.get(self.next).filter(|&&t| t <= now + SAME_TIME * dt) {
            let current: &Frame = current.get_or_insert_with(|| self.read(bar));
            let share = (now - time) / dt;
            due.push(match &self.before {
                Some(before) if share > SAME_TIME => blend(current, before, share, time),
                _ => Frame { time, rows: current.rows.clone() },
            });
            self.next += 1;
        }
        let soon = self.times.get(self.next).is_some_and(|&t| t < now + dt * (1.0 - SAME_TIME));
        self.before = soon.then(|| current.unwrap_or_else(|| self.read(bar)));
        due
    }

    fn read(&self, bar: &impl Stepped) -> Frame {
        read_frame(bar, &self.fields, &self.sampling, self.sampling.x().len())
    }
}

/// The bar at its current time: `fields` at `places`, of which there are `count`.
pub fn read_frame<V: View>(bar: &V, fields: &[Field], places: &V::Places, count: usize) -> Frame {
    let row = |&field: &Field| {
        let mut row = vec![0.0; count];
        bar.sample(field, places, &mut row);
        row
    };
    Frame { time: bar.time(), rows: fields.iter().map(row).collect() }
}

/// `share` of the earlier frame and the rest of the later one.
fn blend(later: &Frame, earlier: &Frame, share: f64, time: f64) -> Frame {
    let mix = |(l, e): (&f64, &f64)| l + share * (e - l);
    let rows = later.rows.iter().zip(&earlier.rows).map(|(l, e)| l.iter().zip(e).map(mix).collect()).collect();
    Frame { time, rows }
}
