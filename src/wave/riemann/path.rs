//! Stress-strain path that a point follows when its stress starts to rise or to fall, and the waves along it.
//!
//! A path is stored in the sense of its stress change: tau = sense * sigma rises along it. It starts at the state of the point
//! and consists of the elastic line up to the yield stress of that sense, then the table, shifted so that both meet. It is
//! linear between knots. A wave that raises tau to tau* follows the upper concave hull of the path up to tau*,
//! with one front per edge, `dv = d tau/(rho c)`, `rho c^2 = d tau/d eps`. Where slopes fall along the path, the hull is the path.

use super::face::FaceState;
use super::medium::{Flow, Lines, Medium, Point};
use crate::law::Reversals;

/// Relative rounding of a stress computed from a force, by a product and a quotient.
const CAP_ROUNDING: f64 = 4.0 * f64::EPSILON;

/// One knot of a path.
#[derive(Debug, Clone, Copy)]
struct Knot {
    /// Stress in the sense of the path, Pa.
    tau: f64,
    /// E times the strain in the sense of the path, Pa; only differences are meaningful.
    z: f64,
    /// Velocity change from the start to the knot, m/s; valid up to `straight_to`.
    velocity: f64,
    /// Slope d tau/dz of the edge that follows.
    slope: f64,
    /// 1/(rho c) of the edge that follows, m/(s Pa).
    compliance: f64,
}

/// One front of a wave.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Emitted {
    /// Speed of the front, m/s, > 0.
    pub speed: f64,
    /// State behind the front.
    pub behind: Point,
}

/// A path with its work space. It is created once and filled repeatedly, so that nothing is allocated after the first uses.
#[derive(Debug, Clone, Default)]
pub struct Path {
    knots: Vec<Knot>,
    /// +1 if the stress rises along the path, -1 if it falls.
    sense: f64,
    area: f64,
    /// rho E, and E: for fronts along chords.
    impedance2: f64,
    modulus: f64,
    density: f64,
    /// Index of the last knot up to which the hull is the path itself; `None` if this holds for the whole path.
    straight_to: Option<usize>,
    /// Kinematic fraction, and tau from which on flow is plastic.
    kinematic: f64,
    plastic_from: f64,
    /// Whether the curve is followed in loading and unloading.
    returns: bool,
    round_off: f64,
    start: Point,
    hull: Vec<(f64, f64)>,
}

impl Path {
    /// Fills the path of a point of a bar. In an overlay, the point counts as never reversed.
    pub fn fill(&mut self, medium: &Medium, point: &Point, sense: f64) {
        self.fill_with(medium, point, &Reversals::default(), sense);
    }

    /// Fills the path of one side of a face.
    pub fn fill_at_face(&mut self, medium: &Medium, near: &FaceState, sense: f64) {
        self.fill_with(medium, &near.point, &near.reversals, sense);
    }

    fn fill_with(&mut self, medium: &Medium, point: &Point, reversals: &Reversals, sense: f64) {
        self.knots.clear();
        self.sense = sense;
        self.area = medium.area;
        self.modulus = medium.modulus;
        self.density = medium.density;
        self.impedance2 = medium.modulus * medium.density;
        self.round_off = medium.round_off;
        self.start = *point;
        match medium.flow {
            Flow::Plastic { kinematic } => self.fill_plastic(medium, kinematic),
            Flow::PathIndependent => self.fill_path_independent(medium),
            Flow::Overlay => self.fill_overlay(medium, reversals),
        }
        self.sum_velocities();
    }

    /// Fills an unbounded straight path, for a boundary. `compliance` is 1/(rho c A), m/(s N), 0 for a rigid one.
    pub(super) fn fill_straight(&mut self, force: f64, compliance: f64, sense: f64) {
        self.knots.clear();
        self.sense = sense;
        self.area = 1.0;
        self.straight_to = None;
        self.knots.push(Knot { tau: sense * force, z: 0.0, velocity: 0.0, slope: 1.0, compliance });
    }

    fn fill_plastic(&mut self, medium: &Medium, kinematic: f64) {
        self.returns = false;
        self.kinematic = kinematic;
        let lines = medium.lines(self.sense);
        let tau = self.sense * self.start.stress;
        let (mut k, mut z, mut y) = lines.at_accumulated(self.start.accumulated);
        let elastic = 1.0 / medium.impedance();
        if y.is_infinite() {
            self.plastic_from = f64::INFINITY;
            self.push(tau, 0.0, 1.0, elastic);
            return;
        }
        // A start within rounding of a knot is moved to the knot.
        while k + 1 < lines.z.len() && lines.z[k + 1] - z <= self.round_off.max(1e-14 * z) {
            k += 1;
            (z, y) = (lines.z[k], lines.y[k]);
        }
        let limit = self.sense * self.start.back + lines.half_range(y, kinematic);
        if limit - tau > self.round_off {
            self.push(tau, z - (limit - tau), 1.0, elastic);
            self.plastic_from = limit;
        } else {
            self.plastic_from = tau;
        }
        let shift = self.plastic_from - y;
        self.push(self.plastic_from, z, lines.slope[k], lines.compliance[k]);
        self.follow(lines, k + 1, shift);
    }

    fn fill_path_independent(&mut self, medium: &Medium) {
        self.returns = true;
        let tau = self.sense * self.start.stress;
        let z = self.sense * (self.start.stress + self.start.plastic);
        let (own, other) = (medium.lines(self.sense), medium.lines(-self.sense));
        let step = self.round_off.max(1e-14 * z.abs());
        if z + step < 0.0 {
            let k = other.at(-z - step);
            self.push(tau, z, other.slope[k], other.compliance[k]);
            for j in (1..=k).rev() {
                self.push(-other.y[j], -other.z[j], other.slope[j - 1], other.compliance[j - 1]);
            }
            self.follow(own, 0, 0.0);
        } else {
            let k = own.at(z + step);
            self.push(tau, z, own.slope[k], own.compliance[k]);
            self.follow(own, k + 1, 0.0);
        }
    }

    /// Appends the table from the start of line `from` on.
    fn follow(&mut self, lines: &Lines, from: usize, shift: f64) {
        for j in from..lines.z.len() {
            self.push(lines.y[j] + shift, lines.z[j], lines.slope[j], lines.compliance[j]);
        }
    }

    /// Adds a knot, unless the slope does not change.
    fn push(&mut self, tau: f64, z: f64, slope: f64, compliance: f64) {
        let last = self.knots.last();
        if last.is_none_or(|last| last.slope != slope) {
            // The shift may move the knot off a preceding level segment by rounding; no strain would then reach it along that segment.
            let tau = last.filter(|last| last.slope == 0.0).map_or(tau, |last| last.tau);
            self.knots.push(Knot { tau, z, velocity: 0.0, slope, compliance });
        }
    }

    /// Returns the stress of the point, Pa.
    pub(super) fn start_stress(&self) -> f64 {
        self.start.stress
    }

    /// Starts the path with the elastic line; E times the strain at the start is `z` in the sense of the path, Pa.
    pub(super) fn begin(&mut self, z: f64) {
        self.returns = false;
        let compliance = 1.0 / self.impedance2.sqrt();
        self.knots.push(Knot { tau: self.sense * self.start.stress, z, velocity: 0.0, slope: 1.0, compliance });
    }

    /// Appends a line from (tau, z) on, which may begin before the start.
    pub(super) fn go_along(&mut self, tau: f64, z: f64, slope: f64, compliance: f64) {
        let start = self.knots[0];
        if tau - start.tau > self.round_off {
            self.push(tau, z, slope, compliance);
        } else {
            self.knots.clear();
            self.knots.push(Knot { slope, compliance, ..start });
        }
    }

    /// Computes the velocity changes at the knots, as far as the hull is the path.
    fn sum_velocities(&mut self) {
        self.straight_to = None;
        let mut velocity = 0.0;
        for i in 0..self.knots.len() {
            if i > 0 {
                let before = self.knots[i - 1];
                velocity += before.compliance * (self.knots[i].tau - before.tau);
                self.knots[i].velocity = velocity;
            }
            let slope = self.knots[i].slope;
            if slope == 0.0 || (i > 0 && slope > self.knots[i - 1].slope) {
                self.straight_to = Some(i);
                return;
            }
        }
    }

    /// Returns the largest tau that waves can produce, Pa: infinite, or the level end of the path.
    pub fn cap(&self) -> f64 {
        let last = self.knots[self.knots.len() - 1];
        if last.slope == 0.0 { last.tau } else { f64::INFINITY }
    }

    /// Returns true if a force in the sense of the path, N, is the largest that waves can produce, up to rounding.
    pub(super) fn is_at_cap(&self, force: f64, rounding: f64) -> bool {
        force + rounding >= self.cap() * self.area
    }

    /// Returns the sense of the path: +1 or -1.
    pub fn sense(&self) -> f64 {
        self.sense
    }

    /// Returns d tau/dz at the start: 1 if the path starts elastically.
    pub fn start_slope(&self) -> f64 {
        self.knots[0].slope
    }

    /// Returns the area A, m^2: forces are stresses times A.
    pub fn area(&self) -> f64 {
        self.area
    }

    /// Returns sense * force at knot i, N; infinite beyond the last knot.
    pub(super) fn force(&self, i: usize) -> f64 {
        self.knots.get(i).map_or(f64::INFINITY, |k| self.area * k.tau)
    }

    /// Returns true if the hull is the path itself along edge i.
    pub(super) fn is_straight(&self, i: usize) -> bool {
        self.straight_to.is_none_or(|end| i < end)
    }

    /// Returns d velocity / d force along edge i, m/(s N).
    pub(super) fn compliance(&self, i: usize) -> f64 {
        self.knots[i].compliance / self.area
    }

    /// Returns the edge on which sense * force lies; at a knot, the edge that follows.
    pub(super) fn edge(&self, force: f64) -> usize {
        self.knots.partition_point(|k| self.area * k.tau <= force).max(1) - 1
    }

    /// Returns the velocity change, m/s, of the wave that changes `sense * stress` to tau; 0 for tau at or below the start,
    /// infinite above [`Path::cap`]. A tau above the cap by rounding counts as the cap: two points on one level line may differ by that.
    pub fn velocity(&mut self, tau: f64) -> f64 {
        let cap = self.cap();
        let rounding = self.round_off.max(CAP_ROUNDING * cap.abs());
        let tau = if tau <= cap + rounding { tau.min(cap) } else { tau };
        let first = self.knots[0];
        if tau <= first.tau {
            return 0.0;
        }
        if tau > cap {
            return f64::INFINITY;
        }
        let i = self.knots.partition_point(|k| k.tau < tau).max(1) - 1;
        if self.is_straight(i) {
            let knot = self.knots[i];
            return knot.velocity + knot.compliance * (tau - knot.tau);
        }
        self.build_hull(tau);
        let impedance2 = self.impedance2;
        self.hull.windows(2).map(|w| chord_velocity(w[0], w[1], impedance2)).sum()
    }

    /// Computes the upper concave hull of the path up to tau, as (tau, z).
    fn build_hull(&mut self, tau: f64) {
        self.hull.clear();
        let inner = self.knots.iter().take_while(|k| k.tau < tau).count();
        for i in 0..inner {
            let knot = self.knots[i];
            self.add_to_hull((knot.tau, knot.z));
        }
        let last = self.knots[inner - 1];
        self.add_to_hull((tau, last.z + (tau - last.tau) / last.slope));
    }

    fn add_to_hull(&mut self, to: (f64, f64)) {
        while let [.., a, b] = self.hull[..] {
            if (b.0 - a.0) * (to.1 - b.1) > (to.0 - b.0) * (b.1 - a.1) {
                break;
            }
            self.hull.pop();
        }
        self.hull.push(to);
    }

    /// Computes the wave that changes `sense * stress` to tau (at most [`Path::cap`]). Writes its fronts into `fronts`, fastest
    /// first, and returns the state behind all of them.
    ///
    /// `direction` is +1 for a wave in +x, -1 in -x: `d v = -direction d sigma/(rho c)`. A wave, or the last front of
    /// a wave, within rounding is not emitted.
    pub fn emit(&mut self, tau: f64, direction: f64, fronts: &mut Vec<Emitted>) -> Point {
        fronts.clear();
        let mut behind = self.start;
        if tau - self.knots[0].tau <= self.round_off {
            return behind;
        }
        let edge = self.edge(self.area * tau);
        let straight =
            self.is_straight(edge) || self.straight_to.is_some_and(|k| tau - self.knots[k].tau <= self.round_off);
        if straight {
            let mut i = 0;
            while i + 1 < self.knots.len() && self.is_straight(i) && self.knots[i + 1].tau - tau <= self.round_off {
                let (from, to) = (self.knots[i], self.knots[i + 1]);
                behind = self.along(&behind, &from, (to.tau, to.z), direction);
                fronts.push(Emitted { speed: 1.0 / (self.density * from.compliance), behind });
                i += 1;
            }
            let from = self.knots[i];
            if tau - from.tau > self.round_off && from.slope > 0.0 {
                let to = (tau, from.z + (tau - from.tau) / from.slope);
                behind = self.along(&behind, &from, to, direction);
                fronts.push(Emitted { speed: 1.0 / (self.density * from.compliance), behind });
            }
            return behind;
        }
        self.build_hull(tau);
        for i in 1..self.hull.len() {
            let (from, to) = (self.hull[i - 1], self.hull[i]);
            if i + 1 < self.hull.len() || to.0 - from.0 > self.round_off {
                let compliance = chord_velocity(from, to, self.impedance2) / (to.0 - from.0);
                behind = self.behind(&behind, from, to, compliance, direction);
                fronts.push(Emitted { speed: 1.0 / (self.density * compliance), behind });
            }
        }
        behind
    }

    /// Returns the state behind a front along the line that starts at the knot `from`. Along an elastic line the plastic strain is unchanged to the
    /// last bit.
    fn along(&self, ahead: &Point, from: &Knot, to: (f64, f64), direction: f64) -> Point {
        let mut behind = self.behind(ahead, (from.tau, from.z), to, from.compliance, direction);
        if self.returns && from.slope == 1.0 {
            (behind.plastic, behind.work) = (ahead.plastic, ahead.work);
        }
        behind
    }

    /// Returns the state behind a front along the chord `from`-`to` of the path; `ahead` is the state before it.
    fn behind(&self, ahead: &Point, from: (f64, f64), to: (f64, f64), compliance: f64, direction: f64) -> Point {
        let stress = self.sense * to.0;
        let rise = to.0 - from.0;
        let elastic = !self.returns && to.0 <= self.plastic_from;
        let flow = if elastic { 0.0 } else { to.1 - from.1 - rise };
        let mut point = Point {
            stress,
            velocity: ahead.velocity - direction * self.sense * compliance * rise,
            plastic: ahead.plastic + self.sense * flow,
            work: ahead.work + 0.5 * (ahead.stress + stress) * self.sense * flow / self.modulus,
            ..*ahead
        };
        if !elastic && !self.returns {
            point.accumulated += flow;
            point.back += self.sense * self.kinematic * (to.0 - from.0.max(self.plastic_from));
        }
        point
    }
}

/// Returns the velocity change over a front along a chord: `sqrt([tau][eps]/rho)`.
fn chord_velocity(from: (f64, f64), to: (f64, f64), impedance2: f64) -> f64 {
    ((to.0 - from.0) * (to.1 - from.1) / impedance2).max(0.0).sqrt()
}
