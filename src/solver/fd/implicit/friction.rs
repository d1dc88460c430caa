//! Coulomb (dry) friction along the bar.
//!
//! A force f per length acts against the velocity: -f sign(v) where a place moves; where it rests, the force that holds it, of any size
//! up to f. The velocities of the grid hold from one stress to the next, so the impulse of the step around a stress belongs to two of
//! them, in halves. With F = dt f l the largest impulse on a node of mass m and length l, v* its velocity without friction, and
//! g = -F sign(v-) or, where it rested, the impulse that held it,
//!
//! ```text
//! v+ = v* + r/m,   r = -m v* where (g - F)/2 <= -m v* <= (g + F)/2: it rests,   else the bound that is nearer
//! ```
//!
//! which is the trapezoidal rule in closed form, because every node stands for itself. A node at rest has a velocity of exactly 0, and
//! the work of friction between two steps, -v (r- + r+)/2, is never negative. A front that travels a cell in each step loses
//! f dx/(2 A) of its stress in a cell, as it should; one below that ends there. An end finds r together with what holds or drives it.
//!
//! Limits: friction at rest is as large as in motion; nothing is resolved that lasts less than a step or needs less than the friction of
//! a cell. C.-A. de Coulomb 1785 (Théorie des machines simples).

use super::{EndNode, Implicit};

/// Most tries to bring an end to rest; one is enough where what holds the end is linear.
const MOST_TRIES: usize = 100;

/// Part of the velocities that friction can give by which they jump past zero where the end parts from a body: it does not come to rest.
/// Smaller jumps are rounding.
const JUMPS: f64 = 1e-6;

impl Implicit {
    /// Friction on the nodes between the ends, in a step whose changes without it are known.
    pub(super) fn rub_nodes(&mut self) {
        let last = self.change.len() - 1;
        for (weights, nodes) in self.weights.nodes() {
            if weights.friction == 0.0 {
                continue;
            }
            let mass = self.weights.mass_of(weights);
            for j in nodes.start.max(1)..nodes.end.min(last) {
                let before = self.after[j];
                let [low, high] = range(weights.friction, self.started, before, self.rubbing[j]);
                let stopping = -mass * (before + self.change[j]);
                self.rubbing[j] = stopping.clamp(low, high);
                if self.rubbing[j] == stopping {
                    // To the last bit at rest.
                    self.change[j] = -before;
                } else {
                    self.change[j] += self.rubbing[j] / mass;
                }
            }
        }
    }

    /// Friction on the end nodes, in a step in which the bar gives them the impulses `pulls` (N s in +x): these impulses with it, and
    /// whether an end comes to rest.
    pub(super) fn rub_ends(&mut self, time: f64, pulls: [f64; 2], ends: [&EndNode; 2]) -> [(f64, bool); 2] {
        let last = self.change.len() - 1;
        [(0, 0), (1, last)].map(|(side, node)| {
            let end = ends[side];
            let range = range(self.weights.friction(node), self.started, self.after[node], self.rubbing[node]);
            let velocity = |impulse: f64| end.velocity_after() + end.answer(time, pulls[side] + impulse);
            let (impulse, rests) = against(range, velocity);
            self.rubbing[node] = impulse;
            (pulls[side] + impulse, rests)
        })
    }
}

/// Impulses of friction that a node can have in a step: of at most `most` in size, at `velocity` and with the impulse `held` before it.
fn range(most: f64, started: bool, velocity: f64, held: f64) -> [f64; 2] {
    let passed_on = match (started, velocity == 0.0) {
        (false, _) => 0.0,
        (true, true) => held,
        (true, false) => -most.copysign(velocity),
    };
    [0.5 * (passed_on - most), 0.5 * (passed_on + most)]
}

/// The impulse of friction in a range on a node whose velocity rises with it, and whether that brings it to rest.
fn against([least, most]: [f64; 2], velocity: impl Fn(f64) -> f64) -> (f64, bool) {
    // What rests of itself needs none, not even that of rounding.
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
        // Held at rest by the end itself.
        return (0.0_f64.clamp(least, most), true);
    }
    let span = high.1 - low.1;
    let rounding = 4.0 * f64::EPSILON * span;
    for tries in 1..=MOST_TRIES {
        // Every third try halves, for answers that have a kink.
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
