//! Tolerances for equal positions, times and states.

use crate::wave::riemann::{Medium, Point};

/// Fraction of the bar length below which nodes are at the same point, and of the elastic transit time below which times are equal. Interactions have
/// a rounding of about 1e-15 of either; fronts that should meet at a point miss it by that, and distinct events are that close only by chance.
const SAME_POINT: f64 = 1e-13;

/// With a front tolerance, nodes closer than this times the tolerance times the length are at the same point. Waves that run to and fro between two
/// converging fronts end there; the fraction of the momentum that is lost with them is even smaller.
const NEAR: f64 = 1e-8;

/// Fraction of the stress scale below which stresses count as equal: a hundred times their rounding.
pub(super) const SAME_STRESS: f64 = 1e-13;

/// Multiple of the rounding below which states that differ are at rest relative to each other: a wave as weak as that would run to and fro between
/// two positions where histories differ, sustained by the rounding there.
pub(super) const REST: f64 = 8.0;

/// Multiple of the rounding below which states behind the waves of one interaction are made equal. It is much smaller than [`REST`], so that the
/// change does not make a wave strong enough to continue.
pub(super) const ONE_STATE: f64 = 2.0;

/// Distances and times below which positions and times count as equal.
#[derive(Debug, Clone, Copy)]
pub(super) struct Nearness {
    /// Distance below which nodes are at the same point, m.
    pub place: f64,
    /// Same for nodes that move towards each other, m.
    pub near: f64,
    /// Time difference, s.
    pub time: f64,
}

impl Nearness {
    /// Creates the tolerances for a bar of this length (m) and elastic transit time (s).
    pub fn new(length: f64, transit: f64, front_tolerance: f64) -> Self {
        Self { place: SAME_POINT * length, near: NEAR * front_tolerance * length, time: SAME_POINT * transit }
    }
}

/// Returns whether two faces of a joint have the same force and velocity, to a few roundings (see [`REST`]).
pub(super) fn in_balance(a: &Medium, left: &Point, b: &Medium, right: &Point) -> bool {
    let round_off = REST * a.round_off.min(b.round_off);
    (a.area * left.stress - b.area * right.stress).abs() <= round_off * a.area.min(b.area)
        && (left.velocity - right.velocity).abs() * a.impedance().max(b.impedance()) <= round_off
}

/// Returns whether two points have the same stress and velocity, to `times` the rounding.
pub(super) fn same_motion(a: &Point, b: &Point, medium: &Medium, times: f64) -> bool {
    let round_off = times * medium.round_off;
    (a.stress - b.stress).abs() <= round_off && (a.velocity - b.velocity).abs() * medium.impedance() <= round_off
}
