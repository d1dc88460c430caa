//! The contact force over a time step: a cubic through the Lobatto nodes.

use crate::impact::oscillator::TERMS;

/// Lobatto nodes of a step, as fractions of it.
pub(super) const NODES: [f64; TERMS] = [0.0, 0.276_393_202_250_021, 0.723_606_797_749_979, 1.0];
/// Fractions of the step at which the approach is computed: the nodes after the first, and the point at which the defect is evaluated.
pub(super) const LOOKS: [f64; TERMS] = [NODES[1], NODES[2], 1.0, 0.5];
/// Force over a step: values at [`NODES`].
pub(super) type Nodal = [f64; TERMS];

/// Returns the value, at a fraction of the step, of the cubic that is 1 at one node and 0 at the others.
pub(super) fn lagrange(node: usize, part: f64) -> f64 {
    let others = NODES.iter().enumerate().filter(|(other, _)| *other != node);
    others.map(|(_, x)| (part - x) / (NODES[node] - x)).product()
}

/// Returns the coefficients of the cubic in powers of the fraction of the step.
fn powers(force: &Nodal) -> [f64; TERMS] {
    let mut sum = [0.0; TERMS];
    for (node, value) in force.iter().enumerate() {
        let mut polynomial = [1.0, 0.0, 0.0, 0.0];
        for (_, x) in NODES.iter().enumerate().filter(|(other, _)| *other != node) {
            let width = NODES[node] - x;
            for k in (0..TERMS).rev() {
                let below = if k == 0 { 0.0 } else { polynomial[k - 1] };
                polynomial[k] = (below - x * polynomial[k]) / width;
            }
        }
        sum.iter_mut().zip(polynomial).for_each(|(s, p)| *s += value * p);
    }
    sum
}

/// Returns the factors of s^k/k! in the force, where s is the time within the step.
pub(super) fn taylor(force: &Nodal, dt: f64) -> [f64; TERMS] {
    let mut factor = 1.0;
    let mut terms = powers(force);
    for (k, term) in terms.iter_mut().enumerate() {
        *term *= factor;
        factor *= (k + 1) as f64 / dt;
    }
    terms
}

/// Returns the integral over the step by Lobatto's rule, exact for polynomials up to degree 5.
pub(super) fn impulse(force: &Nodal, dt: f64) -> f64 {
    dt * (force[0] + 5.0 * (force[1] + force[2]) + force[3]) / 12.0
}

/// Returns the fraction of the step and the value of the local maximum of the cubic; `None` if there is none within the step.
pub(super) fn peak(force: &Nodal) -> Option<[f64; 2]> {
    let [_, b, c, d] = powers(force);
    // Root of b + 2 c x + 3 d x^2 = 0 at which the derivative decreases.
    let root = c * c - 3.0 * d * b;
    if root < 0.0 {
        return None;
    }
    let x = if c <= 0.0 { b / (root.sqrt() - c) } else { (-c - root.sqrt()) / (3.0 * d) };
    let value: f64 = force.iter().enumerate().map(|(node, f)| f * lagrange(node, x)).sum();
    (0.0..=1.0).contains(&x).then_some([x, value])
}
