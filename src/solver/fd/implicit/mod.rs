//! What acts along the bar beside the stress of its curve: damping, a foundation, and Love's lateral inertia.
//!
//! With w = v+ - v- the change of the nodes' velocities in a step,
//!
//! ```text
//! M w + B w + (K dt^2/4) w + (dt/2) C w = dt (F - K u) - dt C v- + dt R
//! ```
//!
//! F is the force of the stresses, R that of the ends; M are the nodes' masses, B = rho nu^2 r^2 A/dx in the pattern of
//! neighbouring nodes (Love: the kinetic energy of the sideways motion is rho nu^2 r^2 (d eps/dt)^2/2 per volume), C the
//! dampers: internal ones c1 A/dx in the same pattern, external ones c2 dx at each node; K = k dx is the foundation. The
//! dampers act with the mean velocity of the step, the foundation with the mean (u- + 2 u + u+)/4 of the displacements: of
//! second order, stable for any constants at any Courant number that the plain scheme takes, and their work is known
//! exactly. External drag alone slows a node down by its exact exponential.
//!
//! The matrix never changes, so it is factored once; a step is one forward and one backward sweep. Everything goes on with
//! the same stresses as before: laws, blocks and ends know nothing of it.

mod matrix;
mod weights;

use std::ops::Range;

use super::block::Block;
use super::device::Device;
use super::grid::Grid;
use super::leapfrog::Constants;
use crate::law::LANES;
use matrix::Matrix;
use weights::{NodeWeights, Weights};

/// What acts along the bar; 0 where there is none of a kind.
#[derive(Debug, Clone, PartialEq)]
pub struct Along {
    /// c1: stress per strain rate (Kelvin, Voigt), Pa s, >= 0.
    pub internal: f64,
    /// c2: force per length and velocity, N s/m^2, >= 0.
    pub external: f64,
    /// k: force per length and displacement, N/m^2, >= 0.
    pub foundation: f64,
    /// Of each segment: square of Poisson's ratio times the section's polar radius of gyration, m^2, >= 0.
    pub lateral: Vec<f64>,
}

impl Along {
    /// Nothing acts along the bar.
    pub fn is_nothing(&self) -> bool {
        let mut all = self.lateral.iter().copied().chain([self.internal, self.external, self.foundation]);
        all.all(|x| x == 0.0)
    }

    /// Memory that a cell takes for it, before and after the bar has yielded, bytes; more only in the few cells next to the
    /// ends that follow them.
    pub fn bytes_per_cell(&self) -> [usize; 2] {
        let elastic = 4 + usize::from(self.foundation > 0.0);
        [elastic, elastic + 1].map(|numbers| numbers * size_of::<f64>())
    }
}

/// Sums over the nodes that the account needs: of one step's forces, in the two velocities between which they act.
#[derive(Debug, Clone, Copy, Default)]
struct Taken {
    /// dt times the dampers' power, with the velocity before the step and after it, J.
    before: f64,
    after: f64,
    /// Impulse of external damping and the foundation, N s in +x.
    impulse: f64,
}

/// The nodes of a bar along which something acts.
#[derive(Debug, Clone)]
pub(super) struct Implicit {
    weights: Weights,
    matrix: Matrix,
    /// Velocities half a step after the current time, m/s.
    after: Vec<f64>,
    /// Their change in the latest step.
    change: Vec<f64>,
    /// Displacements at the current time, m; empty without a foundation.
    place: Vec<f64>,
    /// For the ripple damping; empty until the bar yields.
    shift: Vec<f64>,
    /// There are internal and external dampers; some cells move sideways.
    internal: bool,
    external: bool,
    lateral: bool,
    latest: Taken,
    /// Energy taken by dampers so far, J, and by the ripple damping.
    damped: f64,
    ripples: f64,
    impulse: f64,
    throughput: f64,
    /// K dt^2/4 v^2/2 at the start, J: the foundation's energy is counted from there.
    spring_start: f64,
    /// The right end's change in the latest step, where the search for both ends' begins.
    right_change: f64,
    started: bool,
}

/// What the nodes know of energy and momentum, J and N s.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct NodeSums {
    pub kinetic: f64,
    pub momentum: f64,
    pub foundation: f64,
    pub damping: f64,
    pub viscous: f64,
}

impl Implicit {
    /// The nodes at t = 0, with these velocities, before anything acts on them.
    pub fn new(along: &Along, grid: &Grid, constants: &[Constants], velocities: Vec<f64>) -> Self {
        // In the step around t = 0 the dampers act for half of it.
        let weights = Weights::new(along, grid, constants, 0.5);
        let nodes = velocities.len();
        Self {
            matrix: factored(&weights),
            weights,
            after: velocities,
            change: vec![0.0; nodes],
            place: vec![0.0; if along.foundation > 0.0 { nodes } else { 0 }],
            shift: Vec::new(),
            internal: along.internal > 0.0,
            external: along.external > 0.0,
            lateral: along.lateral.iter().any(|&l| l > 0.0),
            latest: Taken::default(),
            damped: 0.0,
            ripples: 0.0,
            impulse: 0.0,
            throughput: 0.0,
            spring_start: 0.0,
            right_change: 0.0,
            started: false,
        }
    }

    /// The first step, around t = 0; all later ones have the whole damping.
    pub fn start(
        &mut self,
        along: &Along,
        grid: &Grid,
        constants: &[Constants],
        blocks: &[Block],
        [left, right]: [&mut Device; 2],
    ) {
        self.spring_start = self.foundation_of_motion(|j| self.after[j]);
        self.give_masses([&mut *left, &mut *right]);
        self.advance(0.0, blocks, [&mut *left, &mut *right]);
        self.weights = Weights::new(along, grid, constants, 1.0);
        self.matrix = factored(&self.weights);
        self.give_masses([left, right]);
    }

    /// Tells the ends what they move.
    fn give_masses(&self, [left, right]: [&mut Device; 2]) {
        let [first, last] = self.matrix.end_masses();
        left.set_mass(first);
        right.set_mass(last);
    }

    /// Takes the nodes from half a step before `time` to half a step after it. The ends know what they
    /// move.
    pub fn advance(&mut self, time: f64, blocks: &[Block], [left, right]: [&mut Device; 2]) {
        if self.started {
            let dt = self.weights.dt;
            self.place.iter_mut().zip(&self.after).for_each(|(u, v)| *u += dt * v);
        }
        self.impulses(blocks);
        let right_sides = self.sweep_forward();
        self.matrix.back(&mut self.change);
        let pulls = self.matrix.left_for_ends(right_sides, &self.change);
        self.move_ends(time, pulls, blocks, left, right);
        let n = self.change.len() - 1;
        let changes = [&*left, &*right].map(|end| end.velocity_after() - end.velocity_before());
        self.matrix.follow_ends(changes, &mut self.change);
        [self.change[0], self.change[n]] = changes;
        self.right_change = changes[1];
        self.account();
        self.after.iter_mut().zip(&self.change).for_each(|(v, change)| *v += change);
        // To the last bit what the ends say of themselves.
        [self.after[0], self.after[n]] = [left.velocity_after(), right.velocity_after()];
        self.started = true;
    }

    /// Into `change`: the impulse of every cell on the node to its left, dampers with the velocities before the step.
    fn impulses(&mut self, blocks: &[Block]) {
        for block in blocks {
            let cells = block.cells.clone();
            let w = self.weights.cell(cells.start);
            let out = &mut self.change[cells.clone()];
            for (out, sigma) in out.iter_mut().zip(&block.sigma) {
                *out = w.impulse * sigma;
            }
            if self.internal {
                let v = &self.after[cells.start..=cells.end];
                for (out, v) in out.iter_mut().zip(v.windows(2)) {
                    *out += w.viscous * (v[1] - v[0]);
                }
            }
        }
    }

    /// Forms the right sides in `change` and takes them forward; returns those of the ends.
    fn sweep_forward(&mut self) -> [f64; 2] {
        let dt = self.weights.dt;
        let (v, place, change) = (&self.after[..], &self.place[..], &mut self.change[..]);
        let n = change.len() - 1;
        let held = |w: &NodeWeights, j: usize| {
            let foundation = if place.is_empty() { 0.0 } else { dt * w.spring * place[j] };
            w.drag * v[j] + foundation
        };
        // The last entry is no cell's impulse: beyond the right end there is nothing.
        change[n] = 0.0;
        let (mut before, mut result, mut ends) = (0.0, 0.0, [0.0; 2]);
        for (w, run) in self.weights.nodes() {
            for j in run {
                let right_side = change[j] - before - held(w, j);
                before = change[j];
                if j == 0 || j == n {
                    ends[usize::from(j == n)] = right_side;
                } else {
                    result = self.matrix.forward(j, right_side, result);
                    change[j] = result;
                }
            }
        }
        ends
    }

    /// The ends take their step with the impulses (N s in +x) that all nodes between them leave. Each acts on the other
    /// through the bar: the changes that fit both are the fixed point of answering each other, a contraction of straight
    /// pieces, which is extrapolated.
    fn move_ends(&self, time: f64, pulls: [f64; 2], blocks: &[Block], left: &mut Device, right: &mut Device) {
        let cross = self.matrix.cross();
        let mut guess = self.right_change;
        if cross == 0.0 {
            guess = 0.0;
        } else {
            let answer = |guess: f64| {
                let change = left.answer(time, pulls[0] - cross * guess);
                right.answer(time, pulls[1] - cross * change)
            };
            for _ in 0..MOST_ANSWERS {
                let first = answer(guess);
                if (first - guess).abs() <= 2.0 * f64::EPSILON * first.abs() {
                    break;
                }
                let second = answer(first);
                let bend = second - 2.0 * first + guess;
                let ahead = guess - (first - guess) * (first - guess) / bend;
                guess = if ahead.is_finite() { ahead } else { second };
            }
        }
        let (first, last) = (&blocks[0], &blocks[blocks.len() - 1]);
        left.advance_by(time, pulls[0] - cross * guess, first.sigma[0]);
        let change = left.velocity_after() - left.velocity_before();
        right.advance_by(time, pulls[1] - cross * change, last.sigma[last.sigma.len() - 1]);
    }

    /// Books what the dampers and the foundation did in the step whose changes are known, by the trapezoidal rule in their
    /// forces: the form in which the staggered scheme balances energy and momentum to round-off.
    fn account(&mut self) {
        let now = self.taken(|_| 0.0);
        self.damped += 0.5 * (self.latest.after + now.before);
        let impulse = 0.5 * (self.latest.impulse + now.impulse);
        self.impulse += impulse;
        self.throughput += impulse.abs();
        self.latest = now;
    }

    /// Sums of a step, `after` holding the velocities before it. `shift` is what is added to those after it.
    fn taken(&self, shift: impl Fn(usize) -> f64) -> Taken {
        let (v, w) = (&self.after[..], &self.change[..]);
        let mut taken = Taken::default();
        if self.internal {
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
        if self.external {
            for (weights, nodes) in self.weights.nodes() {
                let [before, after, impulse] = sums(nodes, |j| {
                    let impulse = weights.drag * v[j] + weights.drag_mass * w[j];
                    [impulse * v[j], impulse * (v[j] + w[j] + shift(j)), impulse]
                });
                taken.before += before;
                taken.after += after;
                taken.impulse -= impulse;
            }
        }
        if !self.place.is_empty() {
            let dt = self.weights.dt;
            for (weights, nodes) in self.weights.nodes() {
                let [stretch] = sums(nodes, |j| [self.place[j] + 0.25 * dt * w[j]]);
                taken.impulse -= dt * weights.spring * stretch;
            }
        }
        taken
    }

    /// Takes over what the ripple damping made of the nodes after the latest step, and books what it took: the blocks' own
    /// account knows only the masses of the nodes.
    pub fn take_ripples(&mut self, blocks: &[Block]) {
        let changed = |block: &&Block| block.v[..] != self.after[block.cells.start..=block.cells.end];
        if !blocks.iter().any(|block| changed(&block)) {
            return;
        }
        // What the damping adds to the velocities before and after the step.
        let mut shift = std::mem::take(&mut self.shift);
        shift.resize(self.after.len(), 0.0);
        for block in blocks {
            let here = block.cells.start..=block.cells.end;
            for ((shift, v), old) in shift[here.clone()].iter_mut().zip(&block.v).zip(&self.after[here]) {
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
        if self.lateral {
            for (weights, cells) in self.weights.cells() {
                let [sum] = sums(cells, |i| [(shift[i + 1] - shift[i]) * (both(i + 1) - both(i))]);
                lost += weights.lateral * sum;
            }
        }
        self.ripples -= 0.5 * lost;
        self.after.iter_mut().zip(&self.change).for_each(|(v, change)| *v -= change);
        self.latest.after = self.taken(|j| shift[j]).after;
        for ((v, change), shift) in self.after.iter_mut().zip(&self.change).zip(&shift) {
            *v = *v + change + shift;
        }
        // To the last bit what the blocks step with.
        for block in blocks {
            self.after[block.cells.start..=block.cells.end].copy_from_slice(&block.v);
        }
        self.shift = shift;
    }

    /// Gives a block its nodes' velocities.
    pub fn share(&self, block: &mut Block) {
        block.v.copy_from_slice(&self.after[block.cells.start..=block.cells.end]);
    }

    /// Velocities of a node half a step before and after the current time, m/s.
    pub fn velocities(&self, node: usize) -> [f64; 2] {
        [self.after[node] - self.change[node], self.after[node]]
    }

    /// Impulse (N s in +x) that external damping and the foundation gave so far, and the sum of its sizes.
    pub fn impulse(&self) -> [f64; 2] {
        [self.impulse, self.throughput]
    }

    /// Energies and momentum at the current time.
    pub fn sums(&self) -> NodeSums {
        let mut total = NodeSums {
            damping: self.damped,
            viscous: self.ripples,
            foundation: self.foundation_of_motion(|j| self.after[j] - self.change[j]) - self.spring_start,
            ..self.of_motion(|j| self.after[j])
        };
        if !self.place.is_empty() {
            for (weights, nodes) in self.weights.nodes() {
                let [squares] = sums(nodes, |j| [self.place[j] * self.place[j]]);
                total.foundation += 0.5 * weights.spring * squares;
            }
        }
        total
    }

    /// Kinetic energy and momentum before anything acted on the nodes; before the second step.
    pub fn initial(&self) -> NodeSums {
        self.of_motion(|j| self.after[j] - self.change[j])
    }

    /// Kinetic energy v- (M + B) v+/2 and momentum M (v- + v+)/2 of the velocities before the step and these after it.
    #[inline(always)]
    fn of_motion(&self, after: impl Fn(usize) -> f64) -> NodeSums {
        let mut total = NodeSums::default();
        let before = |j: usize| self.after[j] - self.change[j];
        for (weights, nodes) in self.weights.nodes() {
            let [product, sum] = sums(nodes, |j| [after(j) * before(j), after(j) + before(j)]);
            total.kinetic += 0.5 * weights.mass * product;
            total.momentum += 0.5 * weights.mass * sum;
        }
        if self.lateral {
            for (weights, cells) in self.weights.cells() {
                let [product] = sums(cells, |i| [(after(i + 1) - after(i)) * (before(i + 1) - before(i))]);
                total.kinetic += 0.5 * weights.lateral * product;
            }
        }
        total
    }

    /// The foundation's share that goes with motion, v- (K dt^2/4) v+/2, J.
    fn foundation_of_motion(&self, before: impl Fn(usize) -> f64) -> f64 {
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

    /// Memory, bytes.
    pub fn bytes(&self) -> usize {
        (self.after.len() + self.change.len() + self.place.len() + self.shift.len() + self.matrix.len())
            * size_of::<f64>()
    }
}

/// Most answers of the ends to each other in a step. Two give the fixed point where neither goes over to another piece.
const MOST_ANSWERS: usize = 100;

fn factored(weights: &Weights) -> Matrix {
    Matrix::new(weights.count(), |j| weights.diagonal(j), |i| weights.between(i))
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
