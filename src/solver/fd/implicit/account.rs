//! Energy and momentum of the nodes, and the work of dampers, friction, foundation and grid filter.

use std::ops::Range;

use multiversion::multiversion;
use serde::{Deserialize, Serialize};

use super::weights::NodeWeights;
use super::{Block, Implicit};
use crate::law::LANES;
use crate::solver::Energies;

/// Sums over the nodes of the work and impulse of one step's forces, with the two velocities between which they act.
#[derive(Debug, Clone, Copy, Default, Serialize, Deserialize)]
pub(super) struct StepWork {
    /// dt times the dampers' power, with the velocity before the step and after it, J.
    pub before: f64,
    pub after: f64,
    /// The same for friction.
    pub friction_work: [f64; 2],
    /// Impulse of external damping, friction and the foundation, N s in +x.
    pub impulse: f64,
}

impl StepWork {
    /// Returns dt times the dampers' power with the mean velocity, J, >= 0.
    fn mean(&self) -> f64 {
        0.5 * (self.before + self.after)
    }
}

impl Implicit {
    /// Records the work and impulse of dampers, friction and foundation in the step whose changes are known, by the trapezoidal rule in
    /// their forces: the form in which the staggered scheme balances energy and momentum to round-off.
    pub(super) fn record_step(&mut self) {
        let now = self.step_work(None);
        // Work of friction with the velocity between two steps. It can be negative only if a motion that starts suddenly opposes the bar's
        // own, or if the grid filter moves nodes; the negative part is then counted with the half steps.
        let friction_work = 0.5 * (self.latest.friction_work[1] + now.friction_work[0]);
        self.damped += 0.5 * (self.latest.after + now.before) + friction_work;
        self.damped_by_means += 0.5 * (self.latest.mean() + now.mean()) + friction_work.max(0.0);
        let impulse = 0.5 * (self.latest.impulse + now.impulse);
        self.impulse += impulse;
        self.throughput += impulse.abs();
        self.latest = now;
    }

    /// Resets the account.
    pub(super) fn count_from_here(&mut self) {
        [self.damped, self.damped_by_means, self.impulse, self.throughput] = [0.0; 4];
    }

    /// Returns the sums of a step, with the velocities before it in `after`. `shift`, if given, is added to the velocities after it.
    fn step_work(&self, shift: Option<&[f64]>) -> StepWork {
        let mut work = StepWork::default();
        let (v, w) = (&self.after[..], &self.change[..]);
        if self.active.internal {
            for (weights, Range { start, end }) in self.weights.cells() {
                let nodes = start..=end;
                let shift = shift.map(|shift| &shift[nodes.clone()]);
                let [before, after] = of_dampers(weights.viscous, &v[nodes.clone()], &w[nodes], shift);
                work.before += before;
                work.after += after;
            }
        }
        if self.active.external {
            for (weights, nodes) in self.weights.nodes() {
                let shift = shift.map(|shift| &shift[nodes.clone()]);
                let drag = [weights.drag, weights.drag_mass];
                let [before, after, impulse] = of_drag(drag, &v[nodes.clone()], &w[nodes], shift);
                work.before += before;
                work.after += after;
                work.impulse -= impulse;
            }
        }
        if !self.friction_impulse.is_empty() {
            let [before, after, impulse] = of_friction(&self.friction_impulse, v, w, shift);
            work.friction_work = [before, after];
            work.impulse -= impulse;
        }
        if !self.place.is_empty() {
            let dt = self.weights.dt;
            for (weights, nodes) in self.weights.nodes() {
                work.impulse -= dt * weights.spring * sum_of_places(dt, &self.place[nodes.clone()], &w[nodes]);
            }
        }
        work
    }

    /// Reads the velocities of the nodes after the grid filter in the latest step, and records the energy that it took: the blocks' own
    /// account includes only the masses of the nodes.
    pub fn adopt_filtered_velocities(&mut self, blocks: &[Block]) {
        self.shift.clear();
        self.filtered -= self.adopt_velocities(blocks);
    }

    /// Reads the velocities of the blocks' nodes after the latest step. Returns the energy that the nodes gain by their change, J.
    pub fn adopt_velocities(&mut self, blocks: &[Block]) -> f64 {
        if !blocks.iter().any(|block| differ(&block.v, &self.after[block.cells.start..=block.cells.end])) {
            return 0.0;
        }
        // Added to the velocities before and after the step.
        let mut shift = std::mem::take(&mut self.shift);
        let earlier = shift.clone();
        shift.clear();
        shift.resize(self.after.len(), 0.0);
        for block in blocks {
            let here = block.cells.start..=block.cells.end;
            for ((shift, v), old) in shift[here.clone()].iter_mut().zip(block.v.iter()).zip(&self.after[here]) {
                *shift = v - old;
            }
        }
        let mut energy_gain = 0.0;
        for (weights, nodes) in self.weights.nodes() {
            let mass = weights.mass + 0.25 * self.weights.dt * self.weights.dt * weights.spring;
            let of = [&shift, &self.after, &self.change].map(|of| &of[nodes.clone()]);
            energy_gain += mass * energy_gain_at_nodes(of);
        }
        if self.active.lateral {
            for (weights, cells) in self.weights.cells() {
                let of = [&shift, &self.after, &self.change].map(|of| &of[cells.start..=cells.end]);
                energy_gain += weights.lateral * energy_gain_in_cells(of);
            }
        }
        self.after.iter_mut().zip(&self.change).for_each(|(v, change)| *v -= change);
        // The dampers acted with the velocities before any of these shifts.
        self.after.iter_mut().zip(&earlier).for_each(|(v, earlier)| *v -= earlier);
        shift.iter_mut().zip(&earlier).for_each(|(shift, earlier)| *shift += earlier);
        let work = self.step_work(Some(&shift));
        (self.latest.after, self.latest.friction_work[1]) = (work.after, work.friction_work[1]);
        // The same bits as the velocities with which the blocks are stepped.
        for block in blocks {
            self.after[block.cells.start..=block.cells.end].copy_from_slice(&block.v);
        }
        self.shift = shift;
        0.5 * energy_gain
    }

    /// Returns the impulse (N s in +x) that external damping, friction and the foundation have given so far, and the sum of its absolute
    /// values.
    pub fn impulse(&self) -> [f64; 2] {
        [self.impulse, self.throughput]
    }

    /// Returns energies and momentum at the current time. The work of dampers is counted with the mean velocity of each step. The
    /// difference from the work in the balance of the staggered scheme is in `half_step`, as is the part of the foundation's energy that
    /// depends on the velocities.
    pub fn sums(&self) -> Energies {
        let mut total = self.of_motion(|v, _| v);
        total.damping = self.damped_by_means;
        total.numerical = self.filtered;
        total.half_step += self.damped - self.damped_by_means;
        total.half_step += self.foundation_of_motion(|v, change| v - change) - self.spring_start;
        if !self.place.is_empty() {
            for (weights, nodes) in self.weights.nodes() {
                let squares = sum([&self.place[nodes]], |[u]| u * u);
                total.foundation += 0.5 * weights.spring * squares;
            }
        }
        total
    }

    /// Returns the kinetic energy and momentum before anything acted on the nodes. For use before the second step.
    pub fn initial(&self) -> Energies {
        self.of_motion(|v, change| v - change)
    }

    /// Returns the kinetic energy of the mean of the velocities before the step and those after it (`after` of each velocity and its
    /// change), the difference between v- (M + B) v+/2 and that energy, and the momentum M (v- + v+)/2.
    #[inline(always)]
    fn of_motion(&self, after: impl Fn(f64, f64) -> f64) -> Energies {
        let mut total = Energies::default();
        let (v, w) = (&self.after[..], &self.change[..]);
        for (weights, nodes) in self.weights.nodes() {
            let of = [&v[nodes.clone()], &w[nodes]];
            let both = |[v, w]: [f64; 2]| after(v, w) + (v - w);
            let product = sum(of, |[v, w]| after(v, w) * (v - w));
            let square = sum(of, |of| both(of) * both(of));
            total.kinetic += 0.125 * weights.mass * square;
            total.half_step += weights.mass * (0.5 * product - 0.125 * square);
            total.momentum += 0.5 * weights.mass * sum(of, both);
        }
        if self.active.lateral {
            for (weights, Range { start, end }) in self.weights.cells() {
                let [[v0, v1], [w0, w1]] = [v, w].map(|of| [&of[start..end], &of[start + 1..=end]]);
                let after = |v0, v1, w0, w1| after(v1, w1) - after(v0, w0);
                let before = |v0: f64, v1: f64, w0: f64, w1: f64| (v1 - w1) - (v0 - w0);
                let of = [v0, v1, w0, w1];
                let product = sum(of, |[v0, v1, w0, w1]| after(v0, v1, w0, w1) * before(v0, v1, w0, w1));
                let square = sum(of, |[v0, v1, w0, w1]| {
                    let both = after(v0, v1, w0, w1) + before(v0, v1, w0, w1);
                    both * both
                });
                total.kinetic += 0.125 * weights.lateral * square;
                total.half_step += weights.lateral * (0.5 * product - 0.125 * square);
            }
        }
        total
    }

    /// Returns the part of the foundation's energy that depends on the velocities, v- (K dt^2/4) v+/2, J.
    pub(super) fn foundation_of_motion(&self, before: impl Fn(f64, f64) -> f64) -> f64 {
        if self.place.is_empty() {
            return 0.0;
        }
        let dt = self.weights.dt;
        let of = |(weights, nodes): (&NodeWeights, Range<usize>)| {
            let product = sum([&self.after[nodes.clone()], &self.change[nodes]], |[v, w]| v * before(v, w));
            0.125 * dt * dt * weights.spring * product
        };
        self.weights.nodes().map(of).sum()
    }
}

/// Returns dt times the power of internal dampers with the velocity before the step and after it. `v` are the velocities before the step of
/// the nodes of their cells, and `w` the velocity changes.
#[multiversion(targets("x86_64+avx512f+avx512dq+avx512vl+avx512bw", "x86_64+avx2"))]
fn of_dampers(viscous: f64, v: &[f64], w: &[f64], shift: Option<&[f64]>) -> [f64; 2] {
    let cells = v.len() - 1;
    let [[v0, v1], [w0, w1]] = [v, w].map(|of| [&of[..cells], &of[1..]]);
    // Rate before the step, its change, and the impulse.
    let of = |v0: f64, v1: f64, w0: f64, w1: f64| {
        let (rate, change) = (v1 - v0, w1 - w0);
        (rate, change, viscous * (rate + 0.5 * change))
    };
    let before = sum([v0, v1, w0, w1], |[v0, v1, w0, w1]| {
        let (rate, _, impulse) = of(v0, v1, w0, w1);
        impulse * rate
    });
    let after = match shift {
        None => sum([v0, v1, w0, w1], |[v0, v1, w0, w1]| {
            let (rate, change, impulse) = of(v0, v1, w0, w1);
            impulse * (rate + change)
        }),
        Some(shift) => sum([v0, v1, w0, w1, &shift[..cells], &shift[1..]], |[v0, v1, w0, w1, s0, s1]| {
            let (rate, change, impulse) = of(v0, v1, w0, w1);
            impulse * (rate + change + (s1 - s0))
        }),
    };
    [before, after]
}

/// As [`of_dampers`], for external dampers (impulse per velocity before the step, and per change). Also returns the sum of the impulses,
/// against the motion, N s.
#[multiversion(targets("x86_64+avx512f+avx512dq+avx512vl+avx512bw", "x86_64+avx2"))]
fn of_drag([drag, drag_mass]: [f64; 2], v: &[f64], w: &[f64], shift: Option<&[f64]>) -> [f64; 3] {
    at_nodes([v, w, v], shift, |[v, w, _]| drag * v + drag_mass * w)
}

/// As [`of_drag`], for friction; `friction_impulse` are its impulses on the nodes.
#[multiversion(targets("x86_64+avx512f+avx512dq+avx512vl+avx512bw", "x86_64+avx2"))]
fn of_friction(friction_impulse: &[f64], v: &[f64], w: &[f64], shift: Option<&[f64]>) -> [f64; 3] {
    at_nodes([v, w, friction_impulse], shift, |[_, _, friction_impulse]| -friction_impulse)
}

/// Returns sums over nodes of impulses against the motion (N s): times the velocity before and after the step, and alone. `impulse`
/// computes them from the velocity, its change, and the entry of `own` of each node.
#[inline(always)]
fn at_nodes([v, w, own]: [&[f64]; 3], shift: Option<&[f64]>, impulse: impl Fn([f64; 3]) -> f64) -> [f64; 3] {
    let of_before = sum([v, w, own], |[v, w, own]| impulse([v, w, own]) * v);
    let of_after = match shift {
        None => sum([v, w, own], |[v, w, own]| impulse([v, w, own]) * (v + w)),
        Some(shift) => sum([v, w, own, shift], |[v, w, own, shift]| impulse([v, w, own]) * (v + w + shift)),
    };
    [of_before, of_after, sum([v, w, own], &impulse)]
}

/// Returns the sum over nodes of the displacements with which a foundation acts in a step, m.
#[multiversion(targets("x86_64+avx512f+avx512dq+avx512vl+avx512bw", "x86_64+avx2"))]
fn sum_of_places(dt: f64, place: &[f64], w: &[f64]) -> f64 {
    sum([place, w], |[u, w]| u + 0.25 * dt * w)
}

/// Returns whether two columns of equal length differ. All entries are compared, in parallel, since mostly they are equal.
#[multiversion(targets("x86_64+avx512f+avx512dq+avx512vl+avx512bw", "x86_64+avx2"))]
fn differ(a: &[f64], b: &[f64]) -> bool {
    a.iter().zip(b).map(|(a, b)| u64::from(a != b)).sum::<u64>() > 0
}

/// Returns the energy that nodes of mass 2 gain by shifts, from the shifts, the velocities before them, and the velocity changes in the
/// step.
#[multiversion(targets("x86_64+avx512f+avx512dq+avx512vl+avx512bw", "x86_64+avx2"))]
fn energy_gain_at_nodes(of: [&[f64]; 3]) -> f64 {
    sum(of, |[shift, after, change]| shift * (2.0 * after - change + shift))
}

/// Likewise, returns the energy gained in the relative motion of neighbouring nodes.
#[multiversion(targets("x86_64+avx512f+avx512dq+avx512vl+avx512bw", "x86_64+avx2"))]
fn energy_gain_in_cells([shift, after, change]: [&[f64]; 3]) -> f64 {
    let cells = shift.len() - 1;
    let [[s0, s1], [v0, v1], [w0, w1]] = [shift, after, change].map(|of| [&of[..cells], &of[1..]]);
    sum([s0, s1, v0, v1, w0, w1], |[s0, s1, v0, v1, w0, w1]| {
        let both = |v: f64, w: f64, s: f64| 2.0 * v - w + s;
        (s1 - s0) * (both(v1, w1, s1) - both(v0, w0, s0))
    })
}

/// Number of partial sums: as many as the processor adds in the time of one addition.
const WIDE: usize = 4 * LANES;

/// Returns the sum of `term` over columns of equal length, in lanes that the processor evaluates in parallel. (Compilers do so for one sum
/// only, not for several.)
#[expect(
    clippy::needless_range_loop,
    reason = "closures of iterators and arrays are calls here, and cost more than the sums"
)]
#[inline(always)]
fn sum<const M: usize>(columns: [&[f64]; M], term: impl Fn([f64; M]) -> f64) -> f64 {
    let (mut lanes, mut values) = ([0.0; WIDE], [0.0; M]);
    let (cells, groups) = (columns[0].len(), columns[0].len() / WIDE);
    let mut chunks: [&[[f64; WIDE]]; M] = [&[]; M];
    for c in 0..M {
        chunks[c] = &columns[c].as_chunks().0[..groups];
    }
    for k in 0..groups {
        for lane in 0..WIDE {
            for c in 0..M {
                values[c] = chunks[c][k][lane];
            }
            lanes[lane] += term(values);
        }
    }
    for i in WIDE * groups..cells {
        for c in 0..M {
            values[c] = columns[c][i];
        }
        lanes[0] += term(values);
    }
    lanes.iter().sum()
}
