//! Material and section of a bar, and the state of one of its points, as needed by the Riemann problem.

use serde::{Deserialize, Serialize};

use crate::law::{Backbone, Deformed, PieceIndex, Table};

/// Flow rule: behaviour of a yielded point when its stress decreases.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Flow {
    /// sigma = f(eps) in loading and unloading.
    PathIndependent,
    /// Elastic unloading; the fraction `kinematic` (0 to 1) of the hardening moves the elastic range, the rest widens it.
    Plastic {
        /// 0 isotropic, 1 kinematic. Must be 0 if the curves in tension and compression differ.
        kinematic: f64,
    },
    /// Elements in parallel, described by their open reversals: kinematic hardening along a curve whose slopes fall, the same in
    /// tension and compression, see [`crate::law::Overlay`].
    Overlay,
}

/// State of a point of the bar. Strains are multiplied by E, so all quantities except velocity and work are in Pa.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub struct Point {
    /// Stress, Pa, tension positive.
    pub stress: f64,
    /// Velocity, m/s.
    pub velocity: f64,
    /// E times the accumulated plastic strain, >= 0 (0 in path-independent flow).
    pub accumulated: f64,
    /// E times the signed plastic strain; in path-independent flow, `E eps - sigma`.
    pub plastic: f64,
    /// Back stress: middle of the elastic range, as far as hardening moves it.
    pub back: f64,
    /// Energy per volume that is neither kinetic nor elastic (`sigma^2/(2E)`): plastic work and the dissipation of shocks, J/m^3.
    pub work: f64,
}

impl Point {
    /// Returns a point without stress and history that moves with `velocity` (m/s).
    pub fn moving(velocity: f64) -> Self {
        Self { velocity, ..Self::default() }
    }

    /// Returns this point plus `factor` times another one, in all variables. Used to superpose step functions.
    #[must_use]
    pub fn plus(&self, other: &Self, factor: f64) -> Self {
        Self {
            stress: self.stress + factor * other.stress,
            velocity: self.velocity + factor * other.velocity,
            accumulated: self.accumulated + factor * other.accumulated,
            plastic: self.plastic + factor * other.plastic,
            back: self.back + factor * other.back,
            work: self.work + factor * other.work,
        }
    }

    /// Returns true if two points have the same history, so that no contact discontinuity has to be kept between them. Flow within the rounding of
    /// the medium, and its work, count as no difference.
    pub fn same_history(&self, other: &Self, medium: &Medium) -> bool {
        let near = |a: f64, b: f64| (a - b).abs() <= medium.round_off.max(1e-13 * a.abs());
        let work = medium.round_off * self.stress.abs() / medium.modulus;
        near(self.accumulated, other.accumulated)
            && near(self.plastic, other.plastic)
            && near(self.back, other.back)
            && (self.work - other.work).abs() <= work.max(1e-11 * self.work.abs())
    }
}

/// Relative stress change of a line below which the line counts as level: rounding of the stress would otherwise change its plastic strain.
const LEVEL: f64 = 1e-10;

/// A loading table with the data needed by paths along it, one entry per line.
#[derive(Debug, Clone)]
pub(super) struct Lines {
    /// E times the strain, and the stress, at the start of the line, Pa.
    pub z: Vec<f64>,
    pub y: Vec<f64>,
    /// z - y at the start: E times the plastic strain of a point that first loads to the start, Pa.
    pub p: Vec<f64>,
    /// Slope dy/dz.
    pub slope: Vec<f64>,
    /// 1/(rho c) of the line, m/(s Pa); infinite if it is level.
    pub compliance: Vec<f64>,
    /// Yield stress of first loading, Pa; infinite for a curve that never leaves the elastic line.
    pub first_yield: f64,
    /// Index that finds the line, counted from `plastic_from`, at an accumulated plastic strain; `None` if there are few lines.
    index: Option<PieceIndex>,
    plastic_from: usize,
    /// Index that finds the line at z, likewise.
    index_z: Option<PieceIndex>,
}

impl Lines {
    fn new(table: &Table, modulus: f64, density: f64) -> Self {
        let lines = table.lines();
        let z: Vec<f64> = lines.iter().map(|l| l.start).collect();
        let mut y: Vec<f64> = lines.iter().map(|l| l.offset + l.slope * l.start).collect();
        let mut slope: Vec<f64> = lines.iter().map(|l| l.slope).collect();
        // A line that follows a level one must start exactly at its stress: no strain along the level line would reach a higher stress.
        for k in 1..y.len() {
            if (y[k] - y[k - 1]).abs() <= LEVEL * y[k] {
                (slope[k - 1], y[k]) = (0.0, y[k - 1]);
            }
        }
        let compliance = slope.iter().map(|s| 1.0 / (density * modulus * s).sqrt()).collect();
        // Summed instead of z - y, so that an elastic line adds exactly nothing.
        let mut p = vec![0.0; z.len()];
        for k in 1..z.len() {
            p[k] = p[k - 1] + (1.0 - slope[k - 1]) * (z[k] - z[k - 1]);
        }
        let plastic_from = p.partition_point(|&start| start <= 0.0) - 1;
        let index = PieceIndex::new(&p[plastic_from..]);
        let index_z = PieceIndex::new(&z);
        let mut lines = Self { z, y, p, slope, compliance, first_yield: 0.0, index, plastic_from, index_z };
        lines.first_yield = lines.at_accumulated(0.0).2;
        lines
    }

    /// Returns true if both are the same curve.
    pub fn are(&self, other: &Self) -> bool {
        self.z == other.z && self.y == other.y && self.slope == other.slope
    }

    /// Returns the point of the table with this accumulated plastic strain: line, z and y, Pa. On a segment of
    /// elastic slope it is the far end.
    pub fn at_accumulated(&self, p: f64) -> (usize, f64, f64) {
        // Rounding may leave a point that never flowed just below 0, which must not select the first, elastic line.
        let p = p.max(0.0);
        let k = match &self.index {
            Some(index) => self.plastic_from + index.find(p) as usize,
            None => self.p.partition_point(|&start| start <= p).max(1) - 1,
        };
        // Only a last line can be elastic here: its far end is at infinity.
        if self.slope[k] == 1.0 {
            return (k, f64::INFINITY, f64::INFINITY);
        }
        let beyond = (p - self.p[k]) / (1.0 - self.slope[k]);
        (k, self.z[k] + beyond, self.y[k] + self.slope[k] * beyond)
    }

    /// Returns half the elastic range, Pa: the distance from the back stress to the elastic limit, if isotropic hardening would have raised the flow
    /// stress to y (Pa) and the fraction `kinematic` (0 to 1) of that hardening moves the back stress instead. Infinite for a curve that never leaves
    /// the elastic line.
    pub fn half_range(&self, y: f64, kinematic: f64) -> f64 {
        if y.is_finite() { y - kinematic * (y - self.first_yield) } else { y }
    }

    /// Returns the flow stress at this accumulated plastic strain minus that of first yield, Pa; 0 for a curve that never leaves the elastic line.
    fn hardening_at(&self, p: f64) -> f64 {
        let rise = self.at_accumulated(p).2 - self.first_yield;
        if rise.is_finite() { rise } else { 0.0 }
    }

    /// Returns the z >= 0 at which the stress y >= 0 is first reached; the last knot if y lies above a level end.
    pub fn z_at(&self, y: f64) -> f64 {
        let k = self.y.partition_point(|&start| start < y).max(1) - 1;
        self.z[k] + if self.slope[k] > 0.0 { (y - self.y[k]) / self.slope[k] } else { 0.0 }
    }

    /// Returns the line at z >= 0; at a knot, the one that follows.
    pub fn at(&self, z: f64) -> usize {
        match &self.index_z {
            Some(index) => index.find(z) as usize,
            None => self.z.partition_point(|&start| start <= z).max(1) - 1,
        }
    }

    /// Returns the stresses at the start and the end of a line (infinite if it has no end), Pa, and its compliance, m/(s Pa).
    pub fn stresses(&self, line: usize) -> [f64; 3] {
        [self.y[line], self.y.get(line + 1).copied().unwrap_or(f64::INFINITY), self.compliance[line]]
    }
}

impl Backbone for Lines {
    fn stress(&self, z: f64, _sign: f64) -> f64 {
        let k = self.at(z);
        self.y[k] + self.slope[k] * (z - self.z[k])
    }
}

/// Material, section and flow rule of a section of a bar.
#[derive(Debug, Clone)]
pub struct Medium {
    /// Elastic modulus E, Pa.
    pub modulus: f64,
    /// Density rho, kg/m^3.
    pub density: f64,
    /// Cross-sectional area A, m^2.
    pub area: f64,
    /// Flow rule.
    pub flow: Flow,
    /// Stress differences below this (Pa) count as rounding: no wave is emitted for them.
    pub round_off: f64,
    /// Loading tables in tension and compression.
    pub(super) lines: [Lines; 2],
}

impl Medium {
    /// Builds a medium from the loading tables in tension and compression (in units of stress, see [`Table`]).
    ///
    /// `round_off` (Pa, >= 0) should be slightly above the rounding of the stresses that will occur.
    pub fn new(
        [tension, compression]: [&Table; 2],
        modulus: f64,
        density: f64,
        area: f64,
        flow: Flow,
        round_off: f64,
    ) -> Self {
        let lines = [Lines::new(tension, modulus, density), Lines::new(compression, modulus, density)];
        Self { modulus, density, area, flow, round_off, lines }
    }

    /// Returns the elastic wave speed, m/s.
    pub fn c0(&self) -> f64 {
        (self.modulus / self.density).sqrt()
    }

    /// Returns the elastic impedance per area, rho c0, Pa s/m.
    pub fn impedance(&self) -> f64 {
        (self.modulus * self.density).sqrt()
    }

    /// Returns the engineering strain of a point.
    pub fn strain(&self, point: &Point) -> f64 {
        (point.stress + point.plastic) / self.modulus
    }

    /// Returns the total energy of a point, J/m^3: kinetic, elastic, and `work`.
    pub fn energy(&self, point: &Point) -> f64 {
        let kinetic = 0.5 * self.density * point.velocity * point.velocity;
        kinetic + 0.5 * point.stress * point.stress / self.modulus + point.work
    }

    /// Returns true if a point has never flowed. For path-independent flow: if it lies on the elastic line, up to rounding.
    pub fn is_on_elastic_line(&self, point: &Point) -> bool {
        let rounding = if self.flow == Flow::PathIndependent { self.round_off } else { 0.0 };
        point.plastic.abs() <= rounding && point.accumulated == 0.0
    }

    /// Returns the amount by which a point exceeds the states that flow can produce, Pa: that of its stress above its yield stress, or of its back
    /// stress above that of flow in one sense. It is <= 0 for admissible states. For path-independent flow it is the amount by which a point of the
    /// elastic line exceeds the end of that line, and 0 for other points.
    pub fn overstress(&self, point: &Point) -> f64 {
        let kinematic = match self.flow {
            Flow::PathIndependent if self.is_on_elastic_line(point) => {
                return point.stress.abs() - self.lines(point.stress).first_yield;
            }
            Flow::PathIndependent => return 0.0,
            Flow::Plastic { kinematic } => kinematic,
            Flow::Overlay => 1.0,
        };
        let from_middle = point.stress - point.back;
        let over = from_middle.abs() - self.limit(point.accumulated, 0.0, from_middle, kinematic);
        if kinematic == 0.0 {
            return over;
        }
        let back = kinematic * self.lines(point.back).hardening_at(point.accumulated);
        over.max(point.back.abs() - back)
    }

    /// Returns sense * stress at which a point with this accumulated plastic strain (times E, Pa) and back stress (Pa) starts to flow, Pa, if the
    /// fraction `kinematic` (0 to 1) of the hardening is kinematic; infinite for a curve that never leaves its elastic line.
    pub(super) fn limit(&self, accumulated: f64, back: f64, sense: f64, kinematic: f64) -> f64 {
        self.located(accumulated, back, sense, kinematic).1
    }

    /// Returns the line of the curve on which [`Self::limit`] lies, and the limit.
    pub(super) fn located(&self, accumulated: f64, back: f64, sense: f64, kinematic: f64) -> (usize, f64) {
        let lines = self.lines(sense);
        let (line, _, y) = lines.at_accumulated(accumulated);
        (line, sense * back + lines.half_range(y, kinematic))
    }

    /// Returns the signed plastic strain of a point.
    pub fn plastic_strain(&self, point: &Point) -> f64 {
        point.plastic / self.modulus
    }

    /// Returns a point at rest and without stress after slow loading and unloading. A back stress is that of first loading. For overlays and
    /// path-independent flow, returns a point that has never been loaded.
    pub fn deformed(&self, &Deformed { plastic, accumulated, .. }: &Deformed) -> Point {
        let Flow::Plastic { kinematic } = self.flow else { return Point::default() };
        let sense = 1.0_f64.copysign(plastic);
        let accumulated = if kinematic == 0.0 { accumulated } else { plastic.abs() };
        let back = if kinematic == 0.0 { 0.0 } else { sense * kinematic * self.lines(sense).hardening_at(accumulated) };
        Point { accumulated, plastic, back, ..Point::default() }
    }

    /// Returns the speed of a front between two points of this medium, m/s: `rho c^2 = [sigma]/[eps]`.
    pub fn front_speed(&self, a: &Point, b: &Point) -> f64 {
        let stress = a.stress - b.stress;
        (self.modulus / self.density * (stress / (stress + a.plastic - b.plastic))).sqrt()
    }

    pub(super) fn lines(&self, sense: f64) -> &Lines {
        &self.lines[usize::from(sense < 0.0)]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::material::{Beyond, Curve};

    fn medium(rows: &[(f64, f64)], flow: Flow) -> Medium {
        let table = Table::new(&Curve::new(rows, Beyond::Extend).expect("a curve"), 2e11);
        Medium::new([&table, &table], 2e11, 7800.0, 1e-4, flow, 1e-5)
    }

    #[test]
    fn the_line_of_a_point_is_the_last_that_starts_at_or_before_its_strain() {
        let power = |k: i32| 1e-3 * 1.2_f64.powi(k);
        let rows: Vec<(f64, f64)> = (0..40).map(|k| (power(k), 2e8 * (power(k) / 1e-3).powf(0.2))).collect();
        for rows in [&rows[..], &rows[..2], &rows[..1]] {
            let medium = medium(rows, Flow::Plastic { kinematic: 0.0 });
            let lines = medium.lines(1.0);
            let knots = lines.p.iter().flat_map(|&p| [p, p.next_up(), p.next_down(), 1.01 * p, 1e3 * p]);
            for p in knots.filter(|p| *p >= 0.0) {
                let last = lines.p.iter().rposition(|&start| start <= p);
                assert_eq!(Some(lines.at_accumulated(p).0), last, "{p:e} of {} lines", lines.p.len());
            }
            let knots = lines.z.iter().flat_map(|&z| [z, z.next_up(), z.next_down(), 1.01 * z, 1e3 * z]);
            for z in knots.filter(|z| *z >= 0.0) {
                let last = lines.z.iter().rposition(|&start| start <= z);
                assert_eq!(Some(lines.at(z)), last, "{z:e} of {} lines", lines.z.len());
            }
        }
    }

    #[test]
    fn a_curve_that_never_leaves_its_elastic_line_has_no_limit() {
        for kinematic in [0.0, 0.4, 1.0] {
            let medium = medium(&[(1e-3, 2e8)], Flow::Plastic { kinematic });
            for sense in [1.0, -1.0] {
                assert_eq!(medium.limit(0.0, 0.0, sense, kinematic), f64::INFINITY);
            }
        }
    }
}
