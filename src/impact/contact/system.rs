//! The linear bodies on both sides of a contact, advanced exactly over a step under a cubic force.

use super::cubic::{LOOKS, Nodal, impulse, lagrange, taylor};
use crate::impact::oscillator::{Kernel, Oscillator, TERMS};

/// Bodies in contact. The approach is minus the sum of shape q over all oscillators, minus the displacement of the dashpot and of the
/// spring: the striker has the shape -1.
#[derive(Debug, Clone, Default)]
pub struct System {
    /// Striker first.
    pub modes: Vec<Oscillator>,
    /// Velocity under a unit force of a body that answers as a dashpot, m/(N s); 0: there is none.
    pub mobility: f64,
    /// Displacement of that body, m.
    pub drift: f64,
    /// Displacement under a unit force of what follows it at once, m/N; 0: nothing.
    pub compliance: f64,
    /// Energy that the dashpot has taken, J.
    pub radiated: f64,
    /// Energy that the damping of the oscillators has taken, J: the work on them less what they hold.
    pub damped: f64,
}

/// What a step of one length does, whatever the state.
#[derive(Debug)]
pub(super) struct Step {
    pub dt: f64,
    /// Of each mode, at [`LOOKS`].
    kernels: Vec<[Kernel; TERMS]>,
    /// Approach lost at [`LOOKS`] by unit forces at [`NODES`].
    pub receptance: [Nodal; TERMS],
}

impl System {
    /// m.
    pub fn approach(&self, force: f64) -> f64 {
        -self.modes.iter().map(|m| m.shape * m.q).sum::<f64>() - self.drift - self.compliance * force
    }

    /// Rate of the approach without a force, m/s.
    pub(super) fn closing(&self) -> f64 {
        -self.modes.iter().map(|m| m.shape * m.v).sum::<f64>()
    }

    /// Nothing moves the bodies together again without a force.
    pub(super) fn has_separated(&self) -> bool {
        let rigid = || self.modes.iter().filter(|m| m.omega == 0.0);
        let approach = -rigid().map(|m| m.shape * m.q).sum::<f64>() - self.drift;
        let closing = -rigid().map(|m| m.shape * m.v).sum::<f64>();
        let elastic = || self.modes.iter().filter(|m| m.omega > 0.0 && m.shape != 0.0);
        let swing: f64 = elastic().map(|m| m.shape.abs() * m.amplitude()).sum();
        closing < 0.0 && (approach + swing < 0.0 || elastic().next().is_none())
    }

    pub(super) fn step(&self, dt: f64) -> Step {
        let kernels: Vec<[Kernel; TERMS]> = self.modes.iter().map(|m| LOOKS.map(|part| m.kernel(part * dt))).collect();
        let mut receptance = [[0.0; TERMS]; TERMS];
        for (look, row) in receptance.iter_mut().enumerate() {
            let mut terms = [0.0; TERMS];
            for (mode, kernels) in self.modes.iter().zip(&kernels) {
                let weight = mode.shape * mode.shape / mode.mass;
                for (k, term) in terms.iter_mut().enumerate() {
                    *term += weight * kernels[look][k + 2];
                }
            }
            let mut power = LOOKS[look] * dt;
            for (k, term) in terms.iter_mut().enumerate() {
                *term += self.mobility * power;
                power *= LOOKS[look] * dt / (k + 2) as f64;
            }
            for (node, value) in row.iter_mut().enumerate() {
                let mut unit = [0.0; TERMS];
                unit[node] = 1.0;
                *value = taylor(&unit, dt).iter().zip(&terms).map(|(f, g)| f * g).sum();
            }
            // What follows the force at once.
            let at: Nodal = std::array::from_fn(|node| lagrange(node, LOOKS[look]));
            row.iter_mut().zip(at).for_each(|(value, at)| *value += self.compliance * at);
        }
        Step { dt, kernels, receptance }
    }

    /// The approach at [`LOOKS`] without a force.
    pub(super) fn coasted(&self, step: &Step) -> [f64; TERMS] {
        let mut approach = [-self.drift; TERMS];
        for (mode, kernels) in self.modes.iter().zip(&step.kernels) {
            for (value, kernel) in approach.iter_mut().zip(kernels) {
                *value -= mode.shape * mode.coasted(kernel);
            }
        }
        approach
    }

    pub(super) fn advance(&mut self, step: &Step, force: &Nodal) {
        let terms = taylor(force, step.dt);
        for (mode, kernels) in self.modes.iter_mut().zip(&step.kernels) {
            let before = *mode;
            mode.advance(&kernels[2], &terms);
            if mode.delta > 0.0 {
                let inside = [0, 1].map(|node| {
                    let mut then = before;
                    then.advance(&kernels[node], &terms);
                    then.v
                });
                let velocities = [before.v, inside[0], inside[1], mode.v];
                let power: Nodal = std::array::from_fn(|node| mode.shape * velocities[node] * force[node]);
                self.damped += impulse(&power, step.dt) - (mode.energy() - before.energy());
            }
        }
        self.radiated += self.mobility * impulse(&force.map(|f| f * f), step.dt);
        self.drift += self.mobility * impulse(force, step.dt);
    }
}
