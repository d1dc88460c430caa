//! Frames at asked times. Output never bends the time step: a frame between two steps is interpolated in time.

use super::{Field, Frame};
use crate::solver::fd::{Leapfrog, Quantity, Sampling};

/// Makes the frames of a run, in order of time.
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
    pub fn take(&mut self, bar: &Leapfrog) -> Vec<Frame> {
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

    fn read(&self, bar: &Leapfrog) -> Frame {
        Frame { time: bar.time(), rows: self.fields.iter().map(|&f| read_field(bar, &self.sampling, f)).collect() }
    }
}

/// A field at every sample place at the bar's current time.
pub fn read_field(bar: &Leapfrog, sampling: &Sampling, field: Field) -> Vec<f64> {
    let mut row = vec![0.0; sampling.x().len()];
    let Some(quantity) = quantity(field) else {
        let centres = bar.displacements();
        sampling.read(|cell| centres[cell], &mut row);
        return row;
    };
    if sampling.is_every_cell() {
        bar.profile(quantity, &mut row);
    } else {
        sampling.read(|cell| bar.value(quantity, cell), &mut row);
    }
    row
}

/// What the solver calls a field; none for the displacement, which is summed up from the strain.
fn quantity(field: Field) -> Option<Quantity> {
    match field {
        Field::Stress => Some(Quantity::Stress),
        Field::Strain => Some(Quantity::Strain),
        Field::Velocity => Some(Quantity::Velocity),
        Field::PlasticStrain => Some(Quantity::PlasticStrain),
        Field::AccumulatedPlasticStrain => Some(Quantity::AccumulatedPlasticStrain),
        Field::Displacement => None,
    }
}

/// `share` of the earlier frame and the rest of the later one.
fn blend(later: &Frame, earlier: &Frame, share: f64, time: f64) -> Frame {
    let mix = |(l, e): (&f64, &f64)| l + share * (e - l);
    let rows = later.rows.iter().zip(&earlier.rows).map(|(l, e)| l.iter().zip(e).map(mix).collect()).collect();
    Frame { time, rows }
}
