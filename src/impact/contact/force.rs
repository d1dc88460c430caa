//! The contact force over a step: Hertz's law at the nodes by Newton's method, and its defect between them.

use super::Contact;
use super::cubic::{Nodal, lagrange};
use super::system::Step;
use crate::root::bisect;

impl Contact {
    /// Returns the deviation of force and approach from Hertz's law between the nodes, N.
    pub(super) fn defect(&self, step: &Step, force: &Nodal) -> f64 {
        let lost: f64 = step.receptance[3].iter().zip(force).map(|(r, f)| r * f).sum();
        let approach = self.system.coasted(step)[3] - lost;
        let interpolated: f64 = force.iter().enumerate().map(|(node, f)| f * lagrange(node, 0.5)).sum();
        (self.law.force(approach) - interpolated).abs()
    }

    /// Returns the forces at the nodes that satisfy Hertz's law there, by Newton's method for the three approaches. `None` if it does not converge.
    pub(super) fn solve(&self, step: &Step) -> Option<Nodal> {
        let free = self.system.coasted(step);
        let free: [f64; 3] = std::array::from_fn(|i| free[i] - step.receptance[i][0] * self.force);
        let receptance: [[f64; 3]; 3] = std::array::from_fn(|i| std::array::from_fn(|j| step.receptance[i][j + 1]));
        let size = free.iter().fold(self.law.approach(self.scale), |a, b| a.max(b.abs()));
        let mut approach = free;
        for _ in 0..50 {
            let force = approach.map(|a| self.law.force(a));
            let slope = approach.map(|a| 1.5 * self.law.stiffness() * a.max(0.0).sqrt());
            let mut matrix = [[0.0; 4]; 3];
            for i in 0..3 {
                for j in 0..3 {
                    matrix[i][j] = receptance[i][j] * slope[j] + f64::from(u8::from(i == j));
                }
                let lost: f64 = (0..3).map(|j| receptance[i][j] * force[j]).sum();
                matrix[i][3] = free[i] - lost - approach[i];
            }
            let change = eliminate(matrix)?;
            approach.iter_mut().zip(change).for_each(|(a, c)| *a += c);
            if change.iter().all(|c| c.abs() <= 4.0 * f64::EPSILON * size) {
                let force = approach.map(|a| self.law.force(a));
                return Some([self.force, force[0], force[1], force[2]]);
            }
        }
        None
    }

    /// Returns the step that ends when the approach has returned to 0.
    pub(super) fn to_separation(&self, step: &Step) -> Step {
        let touching = |dt: f64| {
            let step = self.system.step(dt);
            self.solve(&step).is_some_and(|force| force[3] > 0.0)
        };
        self.system.step(bisect([0.0, step.dt], 1e-14 * step.dt, touching))
    }
}

/// Solves three linear equations with the right-hand side in the last column; `None` if they are singular.
fn eliminate(mut m: [[f64; 4]; 3]) -> Option<[f64; 3]> {
    for i in 0..3 {
        let pivot = (i..3).max_by(|&a, &b| m[a][i].abs().total_cmp(&m[b][i].abs()))?;
        m.swap(i, pivot);
        if m[i][i] == 0.0 || !m[i][i].is_finite() {
            return None;
        }
        for row in i + 1..3 {
            let factor = m[row][i] / m[i][i];
            let upper = m[i];
            m[row].iter_mut().zip(upper).skip(i).for_each(|(value, above)| *value -= factor * above);
        }
    }
    let mut x = [0.0; 3];
    for i in (0..3).rev() {
        let known: f64 = (i + 1..3).map(|j| m[i][j] * x[j]).sum();
        x[i] = (m[i][3] - known) / m[i][i];
    }
    Some(x)
}
