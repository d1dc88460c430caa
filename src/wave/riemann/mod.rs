//! The Riemann problem of a bar: two states side by side, each with its own history, material and section.
//!
//! Along a wave running in -x the stress changes by `d sigma = rho c dv`, in +x by `d sigma = -rho c dv`. With
//! `phi(F)` the integral of `d sigma/(rho c)` from a state's own force to F along its own loading or unloading path,
//! continuity of force and velocity asks for
//!
//! ```text
//! v_L + phi_L(F) = v_R - phi_R(F)
//! ```
//!
//! phi rises with F. As long as slopes fall along both paths it is piecewise linear, and F is found by walking over
//! the knots of both: no iteration. Where a path stiffens (lock-up, return along a path-independent curve) the last
//! edge of its hull is a chord that depends on F, phi is a root of F there, and F is found by halving down to the
//! last bit. A path that ends level (perfect plasticity) caps F: the velocities then differ and the jump stays at the
//! point. Sources: the graphical method of Bohnenblust (von Kármán, Bohnenblust and Hyers 1942) and, for the hull,
//! Holden and Risebro, Front Tracking for Hyperbolic Conservation Laws, chapter 2.

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
    /// A piece of bar.
    Bar(&'a Medium, &'a Point),
    /// The same, at a face of a grid: as [`Faces::placed`] has it.
    Face(&'a Medium, &'a FaceState),
    /// Something that answers a force F with the velocity change `compliance * (F - force)`: a rigid driver
    /// (compliance 0), or an elastic bar without end.
    Straight {
        /// Force at which it moves with `velocity`, N.
        force: f64,
        /// m/s.
        velocity: f64,
        /// 1/(A rho c), m/(s N), >= 0.
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

/// Paths of both sides, filled by [`solve`]; from them the waves of the answer are sent.
#[derive(Debug, Clone, Default)]
pub struct Workspace {
    /// Path of the left side.
    pub left: Path,
    /// Path of the right side.
    pub right: Path,
}

/// The answer at the point itself.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Star {
    /// Force, N, tension positive.
    pub force: f64,
    /// Velocity of the left side's edge, m/s.
    pub velocity_left: f64,
    /// Velocity of the right side's edge, m/s: the same, unless the force is capped.
    pub velocity_right: f64,
    /// True where a level stress-strain curve caps the force, so that the velocities stay apart.
    pub capped: bool,
}

/// Solves the Riemann problem between two sides. Afterwards `work` holds their paths in the senses of the answer.
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

/// The force at which both paths together change the velocity by `gap`, and whether it is capped.
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

/// Both paths run in one sense: sense * force at which their velocity changes add up to `target`, >= 0.
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
    halve_beyond(target, force, a, b)
}

/// As [`beyond`], from `low` on, where a chord of a hull or a cap takes part.
fn halve_beyond(target: f64, low: f64, a: &mut Path, b: &mut Path) -> (f64, bool) {
    let cap = (a.cap() * a.area()).min(b.cap() * b.area());
    let mut total = |force: f64| a.velocity(force / a.area()) + b.velocity(force / b.area());
    let high = if cap.is_finite() {
        // A hair below the cap, so that rounding of force/area cannot lift it over.
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

/// The answer lies between both forces: the low path rises to it, the high path falls to it.
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

/// The force in `low..high` at which `below` turns from true to false, to the last bit that matters.
fn force_between(low: f64, high: f64, below: impl FnMut(f64) -> bool) -> f64 {
    bisect([low, high], 0.5 * f64::EPSILON * low.abs().max(high.abs()), below)
}
