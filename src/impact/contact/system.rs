//! The linear bodies on both sides of a contact, advanced exactly over a step under a cubic force.

use super::cubic::{LOOKS, Nodal, impulse, lagrange, taylor};
use crate::impact::oscillator::{Kernel, Oscillator, TERMS};

/// Bodies in contact. The approach is minus the sum of shape times q over all oscillators, minus the displacements of the dashpot and of the
/// spring; the striker has the shape -1.
#[derive(Debug, Clone, Default)]
pub struct System {
    /// Oscillators, the striker first.
    pub modes: Vec<Oscillator>,
    /// Velocity per unit force of a body that responds as a dashpot, m/(N s); 0 if there is none.
    pub mobility: f64,
    /// Displacement of the dashpot, m.
    pub drift: f64,
    /// Displacement per unit force of a spring, which follows the force without delay, m/N; 0 if there is none.
    pub compliance: f64,
    /// Energy dissipated by the dashpot, J.
    pub radiated: f64,
    /// Energy dissipated by the damping of the oscillators, J: the work done on them less their energy.
    pub damped: f64,
}

/// Response over a step of a given length, independent of the state.
#[derive(Debug)]
pub(super) struct Step {
    pub dt: f64,
    /// Kernels of each mode at [`LOOKS`].
    kernels: Vec<[Kernel; TERMS]>,
    /// Reduction of the approach at [`LOOKS`] by unit forces at [`NODES`].
    pub receptance: [Nodal; TERMS],
}

impl System {
    /// Returns the approach under a contact force, m.
    pub fn approach(&self, force: f64) -> f64 {
        -self.modes.iter().map(|m| m.shape * m.q).sum::<f64>() - self.drift - self.compliance * force
    }

    /// Returns the rate of the approach without a contact force, m/s.
    pub(super) fn closing(&self) -> f64 {
        -self.modes.iter().map(|m| m.shape * m.v).sum::<f64>()
    }

    /// Whether the bodies cannot meet again in free motion.
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
            // Displacement of the spring.
            let at: Nodal = std::array::from_fn(|node| lagrange(node, LOOKS[look]));
            row.iter_mut().zip(at).for_each(|(value, at)| *value += self.compliance * at);
        }
        Step { dt, kernels, receptance }
    }

    /// Returns the approach at [`LOOKS`] without a force.
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
