//! Energy and momentum of the nodes, and the work of dampers, foundation and grid filter.

use std::ops::Range;

use serde::{Deserialize, Serialize};

use super::weights::NodeWeights;
use super::{Block, Implicit};
use crate::law::LANES;
use crate::solver::Energies;

/// Sums over the nodes that the account needs: of one step's forces, in the two velocities between which they act.
#[derive(Debug, Clone, Copy, Default, Serialize, Deserialize)]
pub(super) struct Taken {
    /// dt times the dampers' power, with the velocity before the step and after it, J.
    pub before: f64,
    pub after: f64,
    /// The same of friction.
    pub rubbed: [f64; 2],
    /// Impulse of external damping, friction and the foundation, N s in +x.
    pub impulse: f64,
}

impl Taken {
    /// dt times the dampers' power with the mean velocity, J, >= 0.
    fn mean(&self) -> f64 {
        0.5 * (self.before + self.after)
    }
}

impl Implicit {
    /// Books what the dampers and the foundation did in the step whose changes are known, by the trapezoidal rule in their
    /// forces: the form in which the staggered scheme balances energy and momentum to round-off.
    pub(super) fn account(&mut self) {
        let now = self.taken(|_| 0.0);
        // What friction takes with the velocity between two steps. It can be less than 0 only where a motion that starts suddenly is
        // against the bar's own, or where the grid filter moves nodes; that is then of the half steps.
        let rubbed = 0.5 * (self.latest.rubbed[1] + now.rubbed[0]);
        self.damped += 0.5 * (self.latest.after + now.before) + rubbed;
        self.damped_by_means += 0.5 * (self.latest.mean() + now.mean()) + rubbed.max(0.0);
        let impulse = 0.5 * (self.latest.impulse + now.impulse);
        self.impulse += impulse;
        self.throughput += impulse.abs();
        self.latest = now;
    }

    /// Forgets what was booked before now.
    pub(super) fn count_from_here(&mut self) {
        [self.damped, self.damped_by_means, self.impulse, self.throughput] = [0.0; 4];
    }

    /// Sums of a step, `after` holding the velocities before it. `shift` is what is added to those after it.
    fn taken(&self, shift: impl Fn(usize) -> f64) -> Taken {
        let mut taken = Taken::default();
        if self.acts.internal {
            self.take_inside(&shift, &mut taken);
        }
        if self.acts.external {
            self.take_outside(&shift, &mut taken);
        }
        if !self.rubbing.is_empty() {
            let [before, after, impulse] = self.at_nodes(0..self.after.len(), &shift, |j| -self.rubbing[j]);
            taken.rubbed = [before, after];
            taken.impulse -= impulse;
        }
        if !self.place.is_empty() {
            let dt = self.weights.dt;
            for (weights, nodes) in self.weights.nodes() {
                let [subdomain] = sums(nodes, |j| [self.place[j] + 0.25 * dt * self.change[j]]);
                taken.impulse -= dt * weights.spring * subdomain;
            }
        }
        taken
    }

    /// By the internal dampers.
    #[inline(always)]
    fn take_inside(&self, shift: &impl Fn(usize) -> f64, taken: &mut Taken) {
        let (v, w) = (&self.after[..], &self.change[..]);
        for (weights, cells) in self.weights.cells() {
            let [before, after] = sums(cells, |i| {
                let (rate, change) = (v[i + 1] - v[i], w[i + 1] - w[i]);
                let impulse = weights.viscous * (rate + 0.5 * change);
                [impulse * rate, impulse * (rate + change + (shift(i + 1) - shift(i)))]
            });
            taken.before += before;
            taken.after += after;
        }
    }

    /// By the external ones.
    #[inline(always)]
    fn take_outside(&self, shift: &impl Fn(usize) -> f64, taken: &mut Taken) {
        let (v, w) = (&self.after[..], &self.change[..]);
        for (weights, nodes) in self.weights.nodes() {
            let impulse = |j: usize| weights.drag * v[j] + weights.drag_mass * w[j];
            let [before, after, impulse] = self.at_nodes(nodes, shift, impulse);
            taken.before += before;
            taken.after += after;
            taken.impulse -= impulse;
        }
    }

    /// Sums over nodes of impulses against the motion (N s): times the velocity before and after the step, and alone.
    #[inline(always)]
    fn at_nodes(&self, nodes: Range<usize>, shift: &impl Fn(usize) -> f64, impulse: impl Fn(usize) -> f64) -> [f64; 3] {
        let (v, w) = (&self.after[..], &self.change[..]);
        sums(nodes, |j| {
            let impulse = impulse(j);
            [impulse * v[j], impulse * (v[j] + w[j] + shift(j)), impulse]
        })
    }

    /// Takes over what the grid filter made of the nodes after the latest step, and books what it took: the blocks' own
    /// account knows only the masses of the nodes.
    pub fn take_filtered(&mut self, blocks: &[Block]) {
        let changed = |block: &&Block| block.v[..] != self.after[block.cells.start..=block.cells.end];
        if !blocks.iter().any(|block| changed(&block)) {
            return;
        }
        // What the damping adds to the velocities before and after the step.
        let mut shift = std::mem::take(&mut self.shift);
        shift.resize(self.after.len(), 0.0);
        for block in blocks {
            let here = block.cells.start..=block.cells.end;
            for ((shift, v), old) in shift[here.clone()].iter_mut().zip(block.v.iter()).zip(&self.after[here]) {
                *shift = v - old;
            }
        }
        let both = |j: usize| 2.0 * self.after[j] - self.change[j] + shift[j];
        let mut lost = 0.0;
        for (weights, nodes) in self.weights.nodes() {
            let mass = weights.mass + 0.25 * self.weights.dt * self.weights.dt * weights.spring;
            let [sum] = sums(nodes, |j| [shift[j] * both(j)]);
            lost += mass * sum;
        }
        if self.acts.lateral {
            for (weights, cells) in self.weights.cells() {
                let [sum] = sums(cells, |i| [(shift[i + 1] - shift[i]) * (both(i + 1) - both(i))]);
                lost += weights.lateral * sum;
            }
        }
        self.filtered -= 0.5 * lost;
        self.after.iter_mut().zip(&self.change).for_each(|(v, change)| *v -= change);
        let taken = self.taken(|j| shift[j]);
        (self.latest.after, self.latest.rubbed[1]) = (taken.after, taken.rubbed[1]);
        for ((v, change), shift) in self.after.iter_mut().zip(&self.change).zip(&shift) {
            *v = *v + change + shift;
        }
        // To the last bit what the blocks step with.
        for block in blocks {
            self.after[block.cells.start..=block.cells.end].copy_from_slice(&block.v);
        }
        self.shift = shift;
    }

    /// Impulse (N s in +x) that external damping and the foundation gave so far, and the sum of its sizes.
    pub fn impulse(&self) -> [f64; 2] {
        [self.impulse, self.throughput]
    }

    /// Energies and momentum at the current time. What dampers take is counted with the mean velocity of each step; where the balance of
    /// the staggered scheme has it otherwise, the difference is in `half_step`, as is the foundation's share that goes with motion.
    pub fn sums(&self) -> Energies {
        let mut total = self.of_motion(|j| self.after[j]);
        total.damping = self.damped_by_means;
        total.numerical = self.filtered;
        total.half_step += self.damped - self.damped_by_means;
        total.half_step += self.foundation_of_motion(|j| self.after[j] - self.change[j]) - self.spring_start;
        if !self.place.is_empty() {
            for (weights, nodes) in self.weights.nodes() {
                let [squares] = sums(nodes, |j| [self.place[j] * self.place[j]]);
                total.foundation += 0.5 * weights.spring * squares;
            }
        }
        total
    }

    /// Kinetic energy and momentum before anything acted on the nodes; before the second step.
    pub fn initial(&self) -> Energies {
        self.of_motion(|j| self.after[j] - self.change[j])
    }

    /// Kinetic energy of the mean of the velocities before the step and these after it, what v- (M + B) v+/2 is beside it, and momentum
    /// M (v- + v+)/2.
    #[inline(always)]
    fn of_motion(&self, after: impl Fn(usize) -> f64) -> Energies {
        let mut total = Energies::default();
        let before = |j: usize| self.after[j] - self.change[j];
        for (weights, nodes) in self.weights.nodes() {
            let [product, square, sum] = sums(nodes, |j| {
                let (after, before) = (after(j), before(j));
                [after * before, (after + before) * (after + before), after + before]
            });
            total.kinetic += 0.125 * weights.mass * square;
            total.half_step += weights.mass * (0.5 * product - 0.125 * square);
            total.momentum += 0.5 * weights.mass * sum;
        }
        if self.acts.lateral {
            for (weights, cells) in self.weights.cells() {
                let [product, square] = sums(cells, |i| {
                    let (after, before) = (after(i + 1) - after(i), before(i + 1) - before(i));
                    [after * before, (after + before) * (after + before)]
                });
                total.kinetic += 0.125 * weights.lateral * square;
                total.half_step += weights.lateral * (0.5 * product - 0.125 * square);
            }
        }
        total
    }

    /// The foundation's share that goes with motion, v- (K dt^2/4) v+/2, J.
    pub(super) fn foundation_of_motion(&self, before: impl Fn(usize) -> f64) -> f64 {
        if self.place.is_empty() {
            return 0.0;
        }
        let dt = self.weights.dt;
        let of = |(weights, nodes): (&NodeWeights, Range<usize>)| {
            let [product] = sums(nodes, |j| [self.after[j] * before(j)]);
            0.125 * dt * dt * weights.spring * product
        };
        self.weights.nodes().map(of).sum()
    }
}

/// Sums over a range, in lanes that the processor can take side by side.
#[inline(always)]
fn sums<const N: usize>(range: Range<usize>, term: impl Fn(usize) -> [f64; N]) -> [f64; N] {
    let mut lanes = [[0.0; LANES]; N];
    let whole = range.start + range.len() - range.len() % LANES;
    for start in (range.start..whole).step_by(LANES) {
        for lane in 0..LANES {
            let terms = term(start + lane);
            for (sum, term) in lanes.iter_mut().zip(terms) {
                sum[lane] += term;
            }
        }
    }
    for i in whole..range.end {
        for (sum, term) in lanes.iter_mut().zip(term(i)) {
            sum[0] += term;
        }
    }
    lanes.map(|lane| lane.iter().sum())
}
