//! Implementation of [`View`] for a front-tracking bar, and the histories of its ends.

use serde::{Deserialize, Serialize};

use super::{Account, EndState, Field, Start, Trace, View};
use crate::law::rupture::Rupture;
use crate::solver::Energies;
use crate::solver::moc::{EndStep, FrontTracking};
use crate::wave::riemann::{Medium, Point};

impl View for FrontTracking {
    /// Sample places, m from the left end, increasing.
    type Places = [f64];

    fn time(&self) -> f64 {
        self.time()
    }

    fn sample(&self, field: Field, places: &[f64], out: &mut [f64]) {
        let value: fn(&Medium, &Point) -> f64 = match field {
            Field::Stress | Field::Torque => |_, p| p.stress,
            Field::Strain | Field::Twist => Medium::strain,
            Field::Velocity | Field::AngularVelocity => |_, p| p.velocity,
            Field::PlasticStrain => Medium::plastic_strain,
            Field::AccumulatedPlasticStrain => |m, p| p.accumulated / m.modulus,
            Field::Displacement => return self.displacements(places, out),
            Field::Temperature => {
                return self.sweep(places, |k, segment, point| out[k] = self.temperature(segment, point));
            }
        };
        self.sweep(places, |k, segment, point| out[k] = value(self.medium(segment), point));
    }

    fn strains(&self, each: &mut dyn FnMut(f64, f64)) {
        for piece in self.pieces() {
            each(0.5 * (piece.from + piece.to), self.medium(piece.segment).strain(piece.point));
        }
    }

    fn ends(&self) -> [EndState; 2] {
        self.ends().map(|record| {
            record.steps.last().map_or(EndState { stress: 0.0, velocity: 0.0 }, |s| EndState {
                stress: s.stress,
                velocity: s.velocity,
            })
        })
    }

    fn strikers(&self) -> [Option<f64>; 2] {
        [0, 1].map(|which| self.striker(which).map(|striker| striker.velocity))
    }

    fn ruptures(&self) -> &[Rupture] {
        self.ruptures()
    }

    fn start(&self) -> Start {
        let mut start = Start::default();
        for piece in self.pieces() {
            let (mass, medium) = (self.mass_of(&piece), self.medium(piece.segment));
            let stored = 0.5 * piece.point.stress * piece.point.stress / (medium.modulus * medium.density);
            start.energy += 0.5 * mass * piece.point.velocity * piece.point.velocity + mass * stored;
            start.momentum += mass * piece.point.velocity;
            start.mass += mass;
        }
        start
    }

    fn account(&self) -> Account {
        let now = self.balance();
        let mass: f64 = self.pieces().map(|piece| self.mass_of(&piece)).sum();
        Account {
            energies: Energies {
                kinetic: now.kinetic,
                elastic: now.elastic,
                plastic: now.plastic,
                heat: now.heat,
                numerical: now.numerical,
                concentrated: now.concentrated,
                momentum: now.momentum,
                ..Energies::default()
            },
            impulse_along: now.shifted,
            work: now.work,
            impulse: now.impulse,
            momentum_scale: (2.0 * now.kinetic * mass).sqrt().max(now.throughput),
        }
    }
}

/// Histories of both ends, passed on as their steps occur: two rows per step, before and after it, so that linear
/// interpolation between rows reproduces the step.
#[derive(Debug, Default, Serialize, Deserialize)]
pub struct EndHistories {
    /// Number of steps passed on so far.
    taken: [usize; 2],
    /// Last step passed on.
    last: [Option<EndStep>; 2],
}

impl EndHistories {
    /// Returns the rows since the last call, of the left and the right end.
    pub fn take(&mut self, bar: &FrontTracking) -> [Trace; 2] {
        let records = bar.ends();
        std::array::from_fn(|side| {
            let steps = &records[side].steps;
            let mut trace = Trace::default();
            let mut add = |time: f64, stress: f64, velocity: f64| {
                trace.time.push(time);
                trace.stress.push(stress);
                trace.velocity.push(velocity);
            };
            for k in self.taken[side]..steps.len() {
                let step = steps[k];
                // A step that is followed by another one at the same time has zero duration.
                if steps.get(k + 1).is_some_and(|next| next.time == step.time) {
                    continue;
                }
                if let Some(before) = self.last[side] {
                    add(step.time, before.stress, before.velocity);
                }
                add(step.time, step.stress, step.velocity);
                self.last[side] = Some(step);
            }
            self.taken[side] = steps.len();
            trace
        })
    }

    /// Returns the last row of each history at the end of the run: the state since the last step.
    pub fn last(bar: &FrontTracking) -> [Trace; 2] {
        View::ends(bar).map(|end| Trace {
            time: vec![bar.time()],
            stress: vec![end.stress],
            velocity: vec![end.velocity],
            ..Trace::default()
        })
    }
}
