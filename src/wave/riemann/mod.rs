//! Riemann problem of a bar: two states side by side, each with its own history, material and section.
//!
//! Along a wave running in -x the stress changes by `d sigma = rho c dv`, in +x by `d sigma = -rho c dv`. With
//! `phi(F)` the integral of `d sigma/(rho c)` from a state's own force to F along its own loading or unloading path,
//! continuity of force and velocity requires
//!
//! ```text
//! v_L + phi_L(F) = v_R - phi_R(F)
//! ```
//!
//! phi increases with F. If slopes fall along both paths, phi is piecewise linear, and F is found without iteration by walking over the knots of
//! both. Where a path stiffens (lock-up, return along a path-independent curve), the last edge of its hull is a chord that depends on F, phi is a
//! square root there, and F is found by bisection to the last bit. A path with a level end (perfect plasticity) limits F: the velocities of the two
//! sides then differ, and the jump remains at the interface. Sources: the graphical method of Bohnenblust (von Kármán, Bohnenblust and Hyers 1942)
//! and, for the hull, Holden and Risebro, Front Tracking for Hyperbolic Conservation Laws, chapter 2.

mod elastic;
mod face;
mod medium;
mod overlay;
mod path;
mod row;

pub use face::{FaceState, Faces, Flux, Straight};
pub use medium::{Flow, Medium, Point};
pub use path::{Emitted, Path};
pub use row::FlowingRow;

use crate::root::bisect;

/// One side of a Riemann problem.
#[derive(Debug, Clone, Copy)]
pub enum Side<'a> {
    /// A section of a bar.
    Bar(&'a Medium, &'a Point),
    /// A section of a bar at a face of a grid, in the form returned by [`Faces::placed`].
    Face(&'a Medium, &'a FaceState),
    /// A boundary that responds to a force F with the velocity change `compliance * (F - force)`: a rigid driver
    /// (compliance 0), or an elastic bar of infinite length.
    Straight {
        /// Force at which the boundary moves with `velocity`, N.
        force: f64,
        /// Velocity at that force, m/s.
        velocity: f64,
        /// Compliance 1/(A rho c), m/(s N), >= 0.
        compliance: f64,
    },
}

impl Side<'_> {
    fn force(&self) -> f64 {
        match *self {
            Self::Bar(medium, point) => medium.area * point.stress,
            Self::Face(medium, near) => medium.area * near.point.stress,
            Self::Straight { force, .. } => force,
        }
    }

    fn velocity(&self) -> f64 {
        match *self {
            Self::Bar(_, point) => point.velocity,
            Self::Face(_, near) => near.point.velocity,
            Self::Straight { velocity, .. } => velocity,
        }
    }

    fn fill(&self, path: &mut Path, sense: f64) {
        match *self {
            Self::Bar(medium, point) => path.fill(medium, point, sense),
            Self::Face(medium, near) => path.fill_at_face(medium, near, sense),
            Self::Straight { force, compliance, .. } => path.fill_straight(force, compliance, sense),
        }
    }
}

/// Paths of both sides, filled by [`solve`]. The waves of the solution are computed from them.
#[derive(Debug, Clone, Default)]
pub struct Workspace {
    /// Path of the left side.
    pub left: Path,
    /// Path of the right side.
    pub right: Path,
}

/// Solution at the interface.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Star {
    /// Force, N, tension positive.
    pub force: f64,
    /// Velocity of the left side at the interface, m/s.
    pub velocity_left: f64,
    /// Velocity of the right side at the interface, m/s; equal to that of the left side unless the force is capped.
    pub velocity_right: f64,
    /// Whether a level stress-strain curve limits the force, so that the velocities differ.
    pub capped: bool,
}

/// Solves the Riemann problem between two sides. Afterwards `work` contains their paths in the senses of the solution.
pub fn solve(left: Side, right: Side, work: &mut Workspace) -> Star {
    let gap = right.velocity() - left.velocity();
    let (force_left, force_right) = (left.force(), right.force());
    let left_is_low = force_left <= force_right;
    let (low, high) = if left_is_low { (left, right) } else { (right, left) };
    let (path_low, path_high) =
        if left_is_low { (&mut work.left, &mut work.right) } else { (&mut work.right, &mut work.left) };
    let (force, capped) = between_or_beyond(gap, low, high, path_low, path_high);
    let moved = |path: &mut Path| path.sense() * path.velocity((path.sense() * force / path.area()).min(path.cap()));
    Star {
        force,
        velocity_left: left.velocity() + moved(&mut work.left),
        velocity_right: right.velocity() - moved(&mut work.right),
        capped,
    }
}

/// Returns the force at which both paths together change the velocity by `gap`, and whether it is capped.
fn between_or_beyond(gap: f64, low: Side, high: Side, path_low: &mut Path, path_high: &mut Path) -> (f64, bool) {
    let (bottom, top) = (low.force(), high.force());
    if bottom < top {
        high.fill(path_high, -1.0);
        let fall = path_high.velocity(-bottom / path_high.area());
        if gap > -fall {
            low.fill(path_low, 1.0);
            let rise = path_low.velocity(top / path_low.area());
            if gap < rise {
                let force = between(gap, bottom, top, path_low, path_high);
                let rounding = 2.0 * f64::EPSILON * bottom.abs().max(top.abs());
                let capped = path_low.is_at_cap(force, rounding) || path_high.is_at_cap(-force, rounding);
                return (force, capped);
            }
            high.fill(path_high, 1.0);
        } else {
            low.fill(path_low, -1.0);
        }
    } else {
        let sense = if gap < 0.0 { -1.0 } else { 1.0 };
        low.fill(path_low, sense);
        high.fill(path_high, sense);
    }
    let sense = path_low.sense();
    let (force, capped) = beyond(sense * gap, path_low, path_high);
    (sense * force, capped)
}

/// For paths of the same sense: returns sense * force at which their velocity changes add up to `target`, >= 0, and whether it is capped.
fn beyond(target: f64, a: &mut Path, b: &mut Path) -> (f64, bool) {
    let mut force = a.force(0).max(b.force(0));
    let (mut i, mut j) = (a.edge(force), b.edge(force));
    let mut sum = a.velocity(force / a.area()) + b.velocity(force / b.area());
    while a.is_straight(i) && b.is_straight(j) {
        let compliance = a.compliance(i) + b.compliance(j);
        let next = a.force(i + 1).min(b.force(j + 1));
        let there = sum + compliance * (next - force);
        if there >= target || next == f64::INFINITY {
            return (force + (target - sum).max(0.0) / compliance, false);
        }
        (force, sum) = (next, there);
        i += usize::from(a.force(i + 1) <= next);
        j += usize::from(b.force(j + 1) <= next);
    }
    bisect_beyond(target, force, a, b)
}

/// Solves the problem of [`beyond`] by bisection for forces from `low` on, for paths with a chord of a hull or a cap.
fn bisect_beyond(target: f64, low: f64, a: &mut Path, b: &mut Path) -> (f64, bool) {
    let cap = (a.cap() * a.area()).min(b.cap() * b.area());
    let mut total = |force: f64| a.velocity(force / a.area()) + b.velocity(force / b.area());
    let high = if cap.is_finite() {
        // Slightly below the cap, so that rounding of force/area cannot exceed it.
        let below = cap - 1e-15 * cap.abs();
        if total(below) <= target {
            return (cap, true);
        }
        below
    } else {
        let mut step = low.abs().max(f64::MIN_POSITIVE);
        while total(low + step) < target {
            step *= 2.0;
        }
        low + step
    };
    (force_between(low, high, |force| total(force) < target), false)
}

/// Returns the force for a solution between both forces: the low path rises to it, the high path falls to it.
fn between(gap: f64, bottom: f64, top: f64, low: &mut Path, high: &mut Path) -> f64 {
    let mut force = bottom;
    let (mut i, mut j) = (low.edge(force), high.edge(-force));
    let mut sum = -high.velocity(-force / high.area());
    if high.is_straight(j) {
        while low.is_straight(i) {
            let compliance = low.compliance(i) + high.compliance(j);
            let next = low.force(i + 1).min(-high.force(j));
            let there = sum + compliance * (next - force);
            if there >= gap || next >= top {
                return (force + (gap - sum).max(0.0) / compliance).min(top);
            }
            (force, sum) = (next, there);
            i += usize::from(low.force(i + 1) <= next);
            j -= usize::from(j > 0 && -high.force(j) <= next);
        }
    }
    let total =
        |f: f64, low: &mut Path, high: &mut Path| low.velocity(f / low.area()) - high.velocity(-f / high.area());
    force_between(force, top, |f| total(f, low, high) < gap)
}

/// Returns the force in `low..high` at which `below` changes from true to false, to the last significant bit.
fn force_between(low: f64, high: f64, below: impl FnMut(f64) -> bool) -> f64 {
    bisect([low, high], 0.5 * f64::EPSILON * low.abs().max(high.abs()), below)
}
