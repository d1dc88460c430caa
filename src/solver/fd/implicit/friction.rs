//! Coulomb (dry) friction along the bar.
//!
//! A force f per length acts against the velocity: -f sign(v) where the bar moves; where it is at rest, the force that holds it, up to f in
//! size. A velocity of the grid holds from one time of the stresses to the next, so the impulse of the step around a time of the stresses
//! belongs to two velocities, in halves. With F = dt f l the largest impulse on a node of mass m and length l, v* its velocity without
//! friction, and g = -F sign(v-) or, if it was at rest, the impulse that held it,
//!
//! ```text
//! v+ = v* + r/m,   r = -m v* if (g - F)/2 <= -m v* <= (g + F)/2: the node comes to rest,   otherwise the nearer bound
//! ```
//!
//! This is the trapezoidal rule in closed form, because the nodes are not coupled. A node at rest has a velocity of exactly 0, and the work
//! of friction between two steps, -v (r- + r+)/2, is never negative. A front that travels one cell per step loses f dx/(2 A) of its stress
//! per cell, as in the exact solution; a weaker front ends there. At an end, r is found together with the response of what holds or drives
//! the end.
//!
//! Limits: static and kinetic friction are equal; nothing is resolved that lasts less than a step or needs less than the friction of a
//! cell. C.-A. de Coulomb 1785 (Théorie des machines simples).

use super::{EndNode, Implicit};

/// Largest number of iterations to bring an end to rest; one is enough if what holds the end is linear.
const MOST_TRIES: usize = 100;

/// Smallest jump of the end's velocity past zero, relative to the range of velocities that friction can produce, for which the end does not
/// come to rest: there it separates from a body. Smaller jumps are rounding errors.
const JUMPS: f64 = 1e-6;

impl Implicit {
    /// Applies friction to the nodes between the ends, in a step whose velocity changes without friction are known.
    pub(super) fn apply_friction(&mut self) {
        let last = self.change.len() - 1;
        for (weights, nodes) in self.weights.nodes() {
            if weights.friction == 0.0 {
                continue;
            }
            let mass = self.weights.mass_of(weights);
            for j in nodes.start.max(1)..nodes.end.min(last) {
                let before = self.after[j];
                let [low, high] = range(weights.friction, self.started, before, self.friction_impulse[j]);
                let stopping = -mass * (before + self.change[j]);
                self.friction_impulse[j] = stopping.clamp(low, high);
                if self.friction_impulse[j] == stopping {
                    // Exactly at rest.
                    self.change[j] = -before;
                } else {
                    self.change[j] += self.friction_impulse[j] / mass;
                }
            }
        }
    }

    /// Computes the friction on the end nodes, in a step in which the bar gives them the impulses `pulls` (N s in +x). Returns these
    /// impulses including friction, and whether each end comes to rest.
    pub(super) fn apply_end_friction(&mut self, time: f64, pulls: [f64; 2], ends: [&EndNode; 2]) -> [(f64, bool); 2] {
        let last = self.change.len() - 1;
        [(0, 0), (1, last)].map(|(side, node)| {
            let end = ends[side];
            let range = range(self.weights.friction(node), self.started, self.after[node], self.friction_impulse[node]);
            let velocity = |impulse: f64| end.velocity_after() + end.answer(time, pulls[side] + impulse);
            let (impulse, rests) = against(range, velocity);
            self.friction_impulse[node] = impulse;
            (pulls[side] + impulse, rests)
        })
    }
}

/// Returns the smallest and largest friction impulse on a node in a step. `most` is the largest friction impulse of a whole step;
/// `velocity` and `held` are the velocity and the friction impulse before the step.
fn range(most: f64, started: bool, velocity: f64, held: f64) -> [f64; 2] {
    let previous = match (started, velocity == 0.0) {
        (false, _) => 0.0,
        (true, true) => held,
        (true, false) => -most.copysign(velocity),
    };
    [0.5 * (previous - most), 0.5 * (previous + most)]
}

/// Returns the friction impulse within a range on a node whose velocity increases with it, and whether that brings the node to rest.
fn against([least, most]: [f64; 2], velocity: impl Fn(f64) -> f64) -> (f64, bool) {
    // A node that comes to rest by itself needs no friction, not even as large as rounding errors.
    if least <= 0.0 && most >= 0.0 && velocity(0.0) == 0.0 {
        return (0.0, true);
    }
    let (mut low, mut high) = ((least, velocity(least)), (most, velocity(most)));
    if low.1 > 0.0 {
        return (low.0, false);
    }
    if high.1 < 0.0 {
        return (high.0, false);
    }
    if low.1 == high.1 {
        // The end itself holds the node at rest.
        return (0.0_f64.clamp(least, most), true);
    }
    let span = high.1 - low.1;
    let rounding = 4.0 * f64::EPSILON * span;
    for tries in 1..=MOST_TRIES {
        // Every third iteration bisects, for responses that have a kink.
        let part = if tries % 3 == 0 { 0.5 } else { -low.1 / (high.1 - low.1) };
        let impulse = low.0 + part * (high.0 - low.0);
        let found = velocity(impulse);
        if found.abs() <= rounding {
            return (impulse, true);
        }
        if found < 0.0 {
            low = (impulse, found);
        } else {
            high = (impulse, found);
        }
    }
    let jumps = high.1 - low.1 > JUMPS * span;
    (0.5 * (low.0 + high.0), !jumps)
}
