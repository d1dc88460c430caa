//! Deflection, bending moment and strain of a beam from its modes.

use super::Beam;
use crate::impact::oscillator::Oscillator;

/// Factors of a point of the beam: mode shapes, and the static response of the modes that are left out.
#[derive(Debug, Clone)]
pub(super) struct Place {
    /// Deflection and curvature at the point per unit of each mode.
    modes: Vec<[f64; 2]>,
    /// Deflection, m/N, and moment, N m/N, under a unit contact force, of the higher modes that follow it without delay.
    tail: [f64; 2],
    bending: f64,
    /// Internal damping times second moment of area, c1 I, N m^2 s.
    internal: f64,
    half_depth: f64,
}

/// Deflection, m; bending moment, N m; strain of the face away from the striker.
pub(super) type Readings = [f64; 3];

impl Beam {
    /// Returns the factors of a point for a beam with this number of modes.
    pub(super) fn place(&self, x: f64, count: usize) -> Place {
        let mode = |n: usize| [self.shape(n, x), self.shape(n, x) * self.wave_number(n).powi(2)];
        let [deflection, moment] = self.tail(count, x);
        let creeps = self.foundation.internal > 0.0;
        let unit = || self.tail(count, self.at)[0];
        let above = creeps.then(|| [deflection / unit(), moment / (self.bending() * unit())]);
        Place {
            modes: (1..=count).map(mode).chain(above).collect(),
            tail: if creeps { [0.0, 0.0] } else { [deflection, moment] },
            bending: self.bending(),
            internal: self.foundation.internal * self.section.inertia,
            half_depth: 0.5 * self.section.depth,
        }
    }

    /// Returns the static deflection and moment at x under a unit force at the point of impact, without those of the first `count` modes. The
    /// higher modes are so stiff that their inertia is negligible, and their wavelengths are so short that foundation and axial force are, too.
    pub(super) fn tail(&self, count: usize, x: f64) -> [f64; 2] {
        let [a, x] = if x <= self.at { [self.at, x] } else { [self.length - self.at, self.length - x] };
        let (l, b) = (self.length, self.length - a);
        let deflection = b * x * (l * l - b * b - x * x) / (6.0 * self.bending() * l);
        let mut tail = [deflection, b * x / l];
        for n in 1..=count {
            let k2 = self.wave_number(n).powi(2);
            let shapes = self.shape(n, a) * self.shape(n, x) * 2.0 / l;
            tail[0] -= shapes / (self.bending() * k2 * k2);
            tail[1] -= shapes / k2;
        }
        tail
    }
}

impl Place {
    /// Returns the point with the magnitudes of its factors.
    pub fn magnitude(&self) -> Self {
        Self { modes: self.modes.iter().map(|factors| factors.map(f64::abs)).collect(), ..self.clone() }
    }

    /// Computes the readings from the displacements and velocities of the modes and the contact force, N.
    pub fn read(&self, modes: &[Oscillator], force: f64) -> Readings {
        let (mut deflection, mut curvature, mut rate) = (0.0, 0.0, 0.0);
        for (mode, [shape, curved]) in modes.iter().zip(&self.modes) {
            deflection += shape * mode.q;
            curvature += curved * mode.q;
            rate += curved * mode.v;
        }
        let elastic = self.bending * curvature + self.tail[1] * force;
        let moment = elastic + self.internal * rate;
        [deflection + self.tail[0] * force, moment, self.half_depth * elastic / self.bending]
    }
}
