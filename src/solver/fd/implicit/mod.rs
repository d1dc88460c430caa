//! Distributed forces along the bar: damping, a foundation, and Love's lateral inertia.
//!
//! With w = v+ - v- the change of the nodes' velocities in a step,
//!
//! ```text
//! M w + B w + (K dt^2/4) w + (dt/2) C w = dt (F - K u) - dt C v- + dt R
//! ```
//!
//! F is the force of the stresses, R that of the ends, and M are the nodes' masses. B = rho nu^2 r^2 A/dx couples neighbouring nodes (Love:
//! the kinetic energy of the lateral motion is rho nu^2 r^2 (d eps/dt)^2/2 per volume). C are the dampers: internal ones c1 A/dx, which
//! couple neighbouring nodes in the same way, and external ones c2 dx at each node. K = k dx is the foundation. The dampers act with the
//! mean velocity of the step, the foundation with the mean (u- + 2 u + u+)/4 of the displacements. This is of second order, stable for any
//! constants at any Courant number that the plain scheme allows, and the work of both is known exactly. External drag alone slows a node
//! down by its exact exponential. Dry friction, which requires B and c1 to be zero, is added to the motion of a node without it, see
//! [`friction`].
//!
//! The matrix never changes, so it is factored once; a step is one forward and one backward sweep. The rest of the scheme is unchanged:
//! laws, blocks and ends are independent of these forces.

mod account;
mod friction;
mod matrix;
mod weights;

use multiversion::multiversion;
use serde::{Deserialize, Serialize};

use super::block::Block;
use super::end_node::EndNode;
use super::grid::Grid;
use super::segment::Constants;
use crate::root::{Tolerance, fixed_point};
use account::StepWork;
use matrix::Matrix;
use weights::{CellWeights, Weights};

/// Forces distributed along the bar; 0 for each kind that is absent.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct DistributedForces {
    /// c1: stress per strain rate (Kelvin, Voigt), Pa s, >= 0.
    pub internal: f64,
    /// c2: force per length and velocity, N s/m^2, >= 0.
    pub external: f64,
    /// k: force per length and displacement, N/m^2, >= 0.
    pub foundation: f64,
    /// f: force per length against the velocity (Coulomb), N/m, >= 0; must be 0 unless `internal` and `lateral` are 0.
    pub friction: f64,
    /// For each segment: square of the product of Poisson's ratio and the section's polar radius of gyration, m^2, >= 0.
    pub lateral: Vec<f64>,
}

impl DistributedForces {
    /// Returns true if no force acts along the bar.
    pub fn is_nothing(&self) -> bool {
        let mut all =
            self.lateral.iter().copied().chain([self.internal, self.external, self.foundation, self.friction]);
        all.all(|x| x == 0.0)
    }

    /// Returns the additional memory per cell before and after the bar has yielded, bytes. The few cells next to the ends that follow them
    /// need more.
    pub fn bytes_per_cell(&self) -> [usize; 2] {
        let elastic = 4 + usize::from(self.foundation > 0.0) + usize::from(self.friction > 0.0);
        [elastic, elastic + 1].map(|numbers| numbers * size_of::<f64>())
    }
}

/// Kinds of forces that are present: internal and external dampers, and lateral inertia in some cells.
#[derive(Debug, Clone, Copy, Serialize, Deserialize)]
struct ActiveForces {
    internal: bool,
    external: bool,
    lateral: bool,
}

/// Nodes of a bar with distributed forces.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(super) struct Implicit {
    #[serde(skip)]
    weights: Weights,
    #[serde(skip)]
    matrix: Matrix,
    /// Velocities half a step after the current time, m/s.
    after: Vec<f64>,
    /// Velocity changes in the latest step, m/s.
    change: Vec<f64>,
    /// Displacements at the current time, m; empty without a foundation.
    place: Vec<f64>,
    /// Impulses of friction on the nodes in the latest step, N s in +x; empty without friction.
    friction_impulse: Vec<f64>,
    /// Velocity changes by the grid filter and by fans in the latest step, m/s; empty until the bar yields.
    shift: Vec<f64>,
    active: ActiveForces,
    latest: StepWork,
    /// Energy dissipated by dampers so far, J, as the staggered scheme balances it, and with the mean velocity of each step; and energy
    /// taken by the grid filter, J.
    damped: f64,
    damped_by_means: f64,
    filtered: f64,
    impulse: f64,
    throughput: f64,
    /// K dt^2/4 v^2/2 at the start, J, from which the foundation's energy is counted.
    spring_start: f64,
    /// Velocity change of the right end in the latest step, m/s, where the search for those of both ends begins.
    right_change: f64,
    started: bool,
}

impl Implicit {
    /// Creates the nodes at t = 0, with these velocities, before anything acts on them.
    pub fn new(along: &DistributedForces, grid: &Grid, constants: &[Constants], velocities: Vec<f64>) -> Self {
        // In the step around t = 0 the dampers act for half of it.
        let weights = Weights::new(along, grid, constants, 0.5);
        let nodes = velocities.len();
        Self {
            matrix: factored(&weights),
            weights,
            after: velocities,
            change: vec![0.0; nodes],
            place: vec![0.0; if along.foundation > 0.0 { nodes } else { 0 }],
            friction_impulse: vec![0.0; if along.friction > 0.0 { nodes } else { 0 }],
            shift: Vec::new(),
            active: ActiveForces {
                internal: along.internal > 0.0,
                external: along.external > 0.0,
                lateral: along.lateral.iter().any(|&l| l > 0.0),
            },
            latest: StepWork::default(),
            damped: 0.0,
            damped_by_means: 0.0,
            filtered: 0.0,
            impulse: 0.0,
            throughput: 0.0,
            spring_start: 0.0,
            right_change: 0.0,
            started: false,
        }
    }

    /// Restores saved nodes. Their weights and matrix are not saved, as these do not change.
    pub fn restore(&mut self, saved: Self) {
        let before = std::mem::replace(self, saved);
        (self.weights, self.matrix) = (before.weights, before.matrix);
    }

    /// Takes the first step, around t = 0, with half the damping; all later steps have the full damping.
    pub fn start(
        &mut self,
        along: &DistributedForces,
        grid: &Grid,
        constants: &[Constants],
        blocks: &[Block],
        [left, right]: [&mut EndNode; 2],
    ) {
        self.spring_start = self.foundation_of_motion(|v, _| v);
        self.give_masses([&mut *left, &mut *right]);
        self.advance(0.0, blocks, [&mut *left, &mut *right]);
        self.weights = Weights::new(along, grid, constants, 1.0);
        self.matrix = factored(&self.weights);
        self.give_masses([left, right]);
    }

    /// Takes the first step of a bar under initial stress: from half a step before t = 0, with the velocities from which stresses and
    /// dampers would have produced the initial ones, to half a step after it. Friction acts from t = 0 on, where the account starts.
    pub fn start_under(
        &mut self,
        along: &DistributedForces,
        grid: &Grid,
        constants: &[Constants],
        blocks: &[Block],
        [left, right]: [&mut EndNode; 2],
    ) {
        self.form_right_sides(blocks);
        self.solve_free();
        self.after.iter_mut().zip(&self.change).for_each(|(v, change)| *v -= 0.5 * change);
        self.weights = Weights::new(along, grid, constants, 1.0);
        self.matrix = factored(&self.weights);
        self.give_masses([&mut *left, &mut *right]);
        let n = self.after.len() - 1;
        left.start_before(self.after[0]);
        right.start_before(self.after[n]);
        self.spring_start = self.foundation_of_motion(|v, _| v);
        self.advance(0.0, blocks, [&mut *left, &mut *right]);
        // The friction that holds a node at rest has acted for half a step only.
        let resting = self.friction_impulse.iter_mut().zip(&self.after).filter(|(_, v)| **v == 0.0);
        resting.for_each(|(impulse, _)| *impulse *= 2.0);
        self.count_from_here();
    }

    /// Solves for the velocity changes of all nodes from the impulses in `change`, with free ends.
    fn solve_free(&mut self) {
        let n = self.change.len() - 1;
        let right_sides = [self.change[0], self.change[n]];
        self.matrix.solve(&mut self.change);
        let [left, right] = self.matrix.left_for_ends(right_sides, &self.change);
        let ([first, last], cross) = (self.matrix.end_masses(), self.matrix.cross());
        let determinant = first * last - cross * cross;
        let ends = [(left * last - cross * right) / determinant, (right * first - cross * left) / determinant];
        self.matrix.follow_ends(ends, &mut self.change);
        [self.change[0], self.change[n]] = ends;
    }

    /// Passes their effective masses to the ends.
    fn give_masses(&self, [left, right]: [&mut EndNode; 2]) {
        let [first, last] = self.matrix.end_masses();
        left.set_mass(first);
        right.set_mass(last);
    }

    /// Advances the nodes from half a step before `time` to half a step after it. The ends must have their effective masses.
    pub fn advance(&mut self, time: f64, blocks: &[Block], [left, right]: [&mut EndNode; 2]) {
        if self.started {
            let dt = self.weights.dt;
            self.place.iter_mut().zip(&self.after).for_each(|(u, v)| *u += dt * v);
        }
        self.form_right_sides(blocks);
        let n = self.change.len() - 1;
        let right_sides = [self.change[0], self.change[n]];
        self.matrix.solve(&mut self.change);
        let pulls = self.matrix.left_for_ends(right_sides, &self.change);
        left.prepare_for(pulls[0], blocks[0].flowed_lately());
        right.prepare_for(pulls[1], blocks[blocks.len() - 1].flowed_lately());
        if self.friction_impulse.is_empty() {
            self.move_ends(time, pulls, blocks, left, right);
        } else {
            self.apply_friction();
            let [(first, left_rests), (second, right_rests)] = self.apply_end_friction(time, pulls, [&*left, &*right]);
            self.move_ends(time, [first, second], blocks, left, right);
            for (rests, end) in [(left_rests, &mut *left), (right_rests, &mut *right)] {
                if rests {
                    end.stop();
                }
            }
        }
        let changes = [&*left, &*right].map(|end| end.velocity_after() - end.velocity_before());
        self.matrix.follow_ends(changes, &mut self.change);
        [self.change[0], self.change[n]] = changes;
        self.right_change = changes[1];
        self.record_step();
        self.after.iter_mut().zip(&self.change).for_each(|(v, change)| *v += change);
        // The same bits as the velocities of the ends.
        [self.after[0], self.after[n]] = [left.velocity_after(), right.velocity_after()];
        self.started = true;
    }

    /// Stores the impulses on the nodes in `change`, those of dampers with the velocities before the step.
    fn form_right_sides(&mut self, blocks: &[Block]) {
        let (v, change) = (&self.after[..], &mut self.change[..]);
        let mut from_left = 0.0;
        for block in blocks {
            let (from, to) = (block.cells.start, block.cells.end);
            let w = self.weights.cell(from);
            let (sigma, v) = (&block.sigma[..], &v[from..=to]);
            let impulse = |i: usize| w.impulse * sigma[i] + w.viscous * (v[i + 1] - v[i]);
            change[from] = impulse(0) - from_left;
            stress_impulses(w, sigma, v, &mut change[from + 1..to]);
            from_left = impulse(sigma.len() - 1);
        }
        let n = change.len() - 1;
        change[n] = -from_left;
        if self.active.external {
            for (w, nodes) in self.weights.nodes() {
                for (change, v) in change[nodes.clone()].iter_mut().zip(&v[nodes]) {
                    *change -= w.drag * v;
                }
            }
        }
        if !self.place.is_empty() {
            for (w, nodes) in self.weights.nodes() {
                let spring = self.weights.dt * w.spring;
                for (change, u) in change[nodes.clone()].iter_mut().zip(&self.place[nodes]) {
                    *change -= spring * u;
                }
            }
        }
    }

    /// Advances the ends with the impulses (N s in +x) that remain after the elimination of all nodes between them. Each end acts on the
    /// other through the bar: the velocity changes that satisfy both ends are the fixed point of their responses to each other.
    fn move_ends(&self, time: f64, pulls: [f64; 2], blocks: &[Block], left: &mut EndNode, right: &mut EndNode) {
        let cross = self.matrix.cross();
        let change = if cross == 0.0 { 0.0 } else { self.right_end_change(time, pulls, left, right) };
        let (first, last) = (&blocks[0], &blocks[blocks.len() - 1]);
        left.advance_by(time, pulls[0] - cross * change, first.sigma[0]);
        let change = left.velocity_after() - left.velocity_before();
        right.advance_by(time, pulls[1] - cross * change, last.sigma[last.sigma.len() - 1]);
    }

    /// Returns the velocity change of the right end that is consistent with the left end's response to it. An impulse moves an end by at
    /// most as much as it moves the end's mass alone: the response is a contraction, which bounds the root.
    fn right_end_change(&self, time: f64, pulls: [f64; 2], left: &EndNode, right: &EndNode) -> f64 {
        let (cross, [first, last]) = (self.matrix.cross(), self.matrix.end_masses());
        let answer = |guess: f64| {
            let change = left.answer(time, pulls[0] - cross * guess);
            right.answer(time, pulls[1] - cross * change)
        };
        let guess = self.right_change;
        let reach = 2.0 * (answer(guess) - guess).abs() / (1.0 - cross * cross / (first * last));
        fixed_point(guess, [guess - reach, guess + reach], TO_ROUNDING, answer)
    }

    /// Copies the velocities of its nodes to a block.
    pub fn share(&self, block: &mut Block) {
        block.v.copy_from_slice(&self.after[block.cells.start..=block.cells.end]);
    }

    /// Returns the velocities of a node half a step before and after the current time, m/s.
    pub fn velocities(&self, node: usize) -> [f64; 2] {
        [self.after[node] - self.change[node], self.after[node]]
    }

    /// Returns the velocity of a node at the current time, m/s.
    pub fn velocity(&self, node: usize) -> f64 {
        let [before, after] = self.velocities(node);
        0.5 * (before + after)
    }

    /// Returns the memory used, bytes.
    pub fn bytes(&self) -> usize {
        let nodes = [&self.after, &self.change, &self.place, &self.friction_impulse, &self.shift].map(Vec::len);
        (nodes.iter().sum::<usize>() + self.matrix.len()) * size_of::<f64>()
    }
}

/// Tolerance of the velocity changes of the ends.
const TO_ROUNDING: Tolerance = Tolerance { relative: 2.0 * f64::EPSILON, absolute: 0.0 };

fn factored(weights: &Weights) -> Matrix {
    Matrix::new(weights.count(), |j| weights.diagonal(j), |i| weights.between(i))
}

/// Computes the impulses of stresses and internal dampers on the nodes inside a block; `v` are the velocities of all its nodes.
#[multiversion(targets("x86_64+avx512f+avx512dq+avx512vl+avx512bw", "x86_64+avx2"))]
fn stress_impulses(w: &CellWeights, sigma: &[f64], v: &[f64], out: &mut [f64]) {
    let nodes = out.len();
    let (left, right) = (&sigma[..nodes], &sigma[1..=nodes]);
    let (before, here, after) = (&v[..nodes], &v[1..=nodes], &v[2..nodes + 2]);
    for i in 0..nodes {
        out[i] = w.impulse * (right[i] - left[i]) + w.viscous * ((after[i] - here[i]) - (here[i] - before[i]));
    }
}
