//! Tolerances for equal positions, times and states.

use crate::wave::riemann::{Medium, Point};

/// Nodes closer than this part of the bar's length are at one point, and times closer than this part of the elastic
/// transit time are one time. Meetings carry a rounding of about 1e-15 of either; fronts that should meet in one
/// point miss it by that, and distinct events lie that close together only by chance.
const SAME_POINT: f64 = 1e-13;

/// With a front tolerance: nodes closer than this times the tolerance times the length are at one point. Waves that run
/// to and fro between two fronts that close in on each other come to an end there; the part of the momentum that
/// is lost with them is smaller yet.
const NEAR: f64 = 1e-8;

/// Stresses closer than this part of the stress scale are one stress: a hundred times their rounding.
pub(super) const SAME_STRESS: f64 = 1e-13;

/// States that differ by less than this times the rounding are at rest with each other: a wave as weak as that would
/// run to and fro between two places where histories differ, fed by the rounding that it meets there.
pub(super) const REST: f64 = 8.0;

/// States behind the waves of one interaction that differ by less than this times the rounding are made one. Far less than [`REST`]: what this adds to a
/// wave must not make one of it that is strong enough to run on.
pub(super) const ONE_STATE: f64 = 2.0;

/// Distances and times that count as none.
#[derive(Debug, Clone, Copy)]
pub(super) struct Nearness {
    /// Nodes closer than this are at one point, m.
    pub place: f64,
    /// And those that are closer than this and run towards each other, m.
    pub near: f64,
    /// s.
    pub time: f64,
}

impl Nearness {
    /// On a bar of this length (m) and elastic transit time (s).
    pub fn new(length: f64, transit: f64, front_tolerance: f64) -> Self {
        Self { place: SAME_POINT * length, near: NEAR * front_tolerance * length, time: SAME_POINT * transit }
    }
}

/// Whether two faces of a joint have one force and one velocity, to a few roundings (see [`REST`]).
pub(super) fn in_balance(a: &Medium, left: &Point, b: &Medium, right: &Point) -> bool {
    let round_off = REST * a.round_off.min(b.round_off);
    (a.area * left.stress - b.area * right.stress).abs() <= round_off * a.area.min(b.area)
        && (left.velocity - right.velocity).abs() * a.impedance().max(b.impedance()) <= round_off
}

/// Whether two points have one stress and one velocity, to `times` the rounding.
pub(super) fn same_motion(a: &Point, b: &Point, medium: &Medium, times: f64) -> bool {
    let round_off = times * medium.round_off;
    (a.stress - b.stress).abs() <= round_off && (a.velocity - b.velocity).abs() * medium.impedance() <= round_off
}
