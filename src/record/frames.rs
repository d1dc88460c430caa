//! Frames at given times. The time step is independent of the output: a frame between two steps is interpolated in time.

use super::{Field, Frame, Stepped, View};
use crate::error::Result;
use crate::snapshot::{self, Snapshot, pack, unpack};
use crate::solver::fd::Sampling;

/// Generator of the frames of a bar on a grid, in order of time.
#[derive(Debug)]
pub struct Frames {
    times: Vec<f64>,
    next: usize,
    fields: Vec<Field>,
    sampling: Sampling,
    twisted: Option<Twisted>,
    /// State at the step before the current one, kept while a frame lies between the two steps.
    before: Option<Frame>,
}

/// Factors that turn the surface quantities of a bar in torsion into torques, twists and angular velocities.
#[derive(Debug, Clone)]
pub struct Twisted {
    /// Radius R of the surface, m.
    pub radius: f64,
    /// Ratio of torque to surface stress, J/R, at each sample or of each segment, m^3.
    pub torque_per_stress: Vec<f64>,
}

/// Distance, relative to the time step, up to which a frame coincides with a step: times written as decimal numbers
/// come no closer to a multiple of dt.
const SAME_TIME: f64 = 1e-6;

impl Frames {
    /// Creates the generator of frames at `times` (s, increasing) of `fields` at the places of `sampling`.
    pub fn new(times: Vec<f64>, fields: Vec<Field>, sampling: Sampling) -> Self {
        Self { times, next: 0, fields, sampling, twisted: None, before: None }
    }

    /// Sets the factors of a bar in torsion; `None` for an axial bar.
    #[must_use]
    pub fn twisted(self, twisted: Option<Twisted>) -> Self {
        Self { twisted, ..self }
    }

    /// Returns the sample places, m.
    pub fn x(&self) -> &[f64] {
        self.sampling.x()
    }

    /// Returns true if a frame is due at the bar's current time.
    pub fn is_due(&self, bar: &impl Stepped) -> bool {
        self.times.get(self.next).is_some_and(|&t| t <= bar.time() + SAME_TIME * bar.grid().dt)
    }

    /// Passes the frames that are due up to the bar's current time to `keep`, one at a time and at most `most` of them,
    /// since all of them may exceed the memory. Returns true if more frames are due. It must be called after every
    /// step, and once at the start, until it returns false.
    ///
    /// # Errors
    /// The errors of `keep`.
    pub fn take(&mut self, bar: &impl Stepped, most: usize, mut keep: impl FnMut(Frame) -> Result<()>) -> Result<bool> {
        let (now, dt) = (bar.time(), bar.grid().dt);
        let mut current = None;
        let stop = self.next.saturating_add(most);
        while let Some(&time) = self.times.get(self.next).filter(|_| self.is_due(bar)) {
            if self.next == stop {
                return Ok(true);
            }
            let current: &Frame = current.get_or_insert_with(|| self.read(bar));
            let share = (now - time) / dt;
            keep(match &self.before {
                Some(before) if share > SAME_TIME => blend(current, before, share, time),
                _ => Frame { time, rows: current.rows.clone() },
            })?;
            self.next += 1;
        }
        let soon = self.times.get(self.next).is_some_and(|&t| t < now + dt * (1.0 - SAME_TIME));
        self.before = soon.then(|| current.unwrap_or_else(|| self.read(bar)));
        Ok(false)
    }

    /// Returns the next step after `step` after which [`Self::take`] must be called; `dt` is the time step, s. For a
    /// frame on a step this is the step itself; for a frame between two steps it is each of the two in turn.
    pub fn next_step(&self, step: usize, dt: f64) -> usize {
        let due = self.times.get(self.next).map_or(usize::MAX, |time| {
            let steps = time / dt;
            let on_step = (steps - steps.round()).abs() < 0.5 * SAME_TIME;
            (if on_step { steps.round() } else { steps.floor() }) as usize
        });
        due.max(step + 1)
    }

    fn read(&self, bar: &impl Stepped) -> Frame {
        read_frame(bar, &self.fields, &self.sampling, self.sampling.x().len(), self.twisted.as_ref())
    }
}

impl Snapshot for Frames {
    fn save(&self) -> snapshot::Result<Vec<u8>> {
        pack(&(self.next, &self.before))
    }

    fn restore(&mut self, saved: &[u8]) -> snapshot::Result<()> {
        (self.next, self.before) = unpack(saved)?;
        Ok(())
    }
}

/// Reads a frame at the bar's current time: `fields` at `places`, of which there are `count`; `twisted` are the factors of a bar in torsion.
pub fn read_frame<V: View>(
    bar: &V,
    fields: &[Field],
    places: &V::Places,
    count: usize,
    twisted: Option<&Twisted>,
) -> Frame {
    let row = |&field: &Field| {
        let mut row = vec![0.0; count];
        bar.sample(field.base(), places, &mut row);
        if let Some(twisted) = twisted {
            twisted.turn(field, &mut row);
        }
        row
    };
    Frame { time: bar.time(), rows: fields.iter().map(row).collect() }
}

impl Twisted {
    fn turn(&self, field: Field, row: &mut [f64]) {
        match field {
            Field::Torque => row.iter_mut().zip(&self.torque_per_stress).for_each(|(value, factor)| *value *= factor),
            Field::Twist | Field::AngularVelocity => row.iter_mut().for_each(|value| *value /= self.radius),
            _ => {}
        }
    }
}

/// Returns the weighted mean of two frames, with weight `share` of the earlier one and 1 - `share` of the later one.
fn blend(later: &Frame, earlier: &Frame, share: f64, time: f64) -> Frame {
    let mix = |(l, e): (&f64, &f64)| l + share * (e - l);
    let rows = later.rows.iter().zip(&earlier.rows).map(|(l, e)| l.iter().zip(e).map(mix).collect()).collect();
    Frame { time, rows }
}
