//! Riemann problem between two cells of one medium, as grid solvers pose it at every face and step. Simple cases are solved by fast
//! formulas, all others by [`solve`].
//!
//! - Both sides stay elastic: the acoustic solution for two equal impedances.
//! - Elastic unloading next to plastic flow, with falling slopes along the curve: a walk over the few lines between the states.
//! - Path-independent curve with falling slopes: loading is a fan (a sum over lines), unloading a single
//!   shock (a chord). The stress at which both meet is found by Newton's method inside a bracket.
//! - All other cases (stiffening curves and their hulls, unloading across zero stress, level curves): [`solve`].

use super::medium::{Flow, Lines, Medium, Point};
use super::{Side, Workspace, solve};
use crate::law::Reversals;

/// Tangent modulus over E up to which a segment of a curve counts as level: plastic waves travel there at most at 3 % of the
/// elastic speed.
const LEVEL: f64 = 1e-3;

/// State of the material of a cell at one of its faces.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct FaceState {
    /// Stress and velocity at the face, and history of the cell. For path-independent flow, also the strain at the face.
    pub point: Point,
    /// Sense in which the cell flows (+1 tension, -1 compression): its stress at the face then lies on the curve, too. 0 if
    /// it does not flow.
    pub flowing: f64,
    /// For elements in parallel: the reversals of the cell at the start of the step.
    pub reversals: Reversals,
}

/// Stress (Pa) and velocity (m/s) at a face.
#[derive(Debug, Clone, Copy, Default, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Flux {
    /// Stress, Pa, tension positive.
    pub stress: f64,
    /// Velocity, m/s, positive in +x.
    pub velocity: f64,
}

/// A line of a curve: stress is `offset + slope * z`, z = E times strain.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Straight {
    /// z at its start, Pa.
    pub start: f64,
    /// z at its end, Pa; infinite if the line has no end.
    pub end: f64,
    /// Stress at z = 0, Pa.
    pub offset: f64,
    /// d stress/dz.
    pub slope: f64,
    /// 1/(rho c), m/(s Pa); infinite if the line is level.
    pub compliance: f64,
}

/// A medium with precomputed data for its faces.
#[derive(Debug, Clone)]
pub struct Faces {
    /// The medium.
    pub medium: Medium,
    /// Half of rho c0, and half of its reciprocal.
    half_impedance: f64,
    half_compliance: f64,
    /// Whether slopes fall along both curves.
    concave: bool,
    /// Velocity change from zero stress to the start of every line, m/s.
    velocity_to_line: [Vec<f64>; 2],
    /// Whether the curves in tension and compression are the same.
    alike: bool,
}

/// Loading path of a side in one sense: elastic up to its limit, then along the lines of the curve.
struct LoadingPath<'a> {
    lines: &'a Lines,
    own: f64,
    limit: f64,
    line: usize,
    /// Stress of the path minus that of the curve at the same strain, Pa.
    shift: f64,
    elastic: bool,
}

impl LoadingPath<'_> {
    /// Returns the stress at the end of the current linear piece, Pa.
    fn next(&self) -> f64 {
        if self.elastic {
            return self.limit;
        }
        self.lines.y.get(self.line + 1).map_or(f64::INFINITY, |y| y + self.shift)
    }

    fn compliance(&self, elastic: f64) -> f64 {
        if self.elastic { elastic } else { self.lines.compliance[self.line] }
    }

    fn pass(&mut self, stress: f64) {
        if stress >= self.next() {
            if self.elastic {
                self.elastic = false;
            } else {
                self.line += 1;
            }
        }
    }
}

impl Faces {
    /// Precomputes the data for the faces of a medium.
    pub fn new(medium: Medium) -> Self {
        let impedance = medium.impedance();
        let falls = |lines: &Lines| lines.slope.windows(2).all(|pair| pair[1] <= pair[0]);
        let velocity_to_line = [1.0, -1.0].map(|sense| {
            let lines = medium.lines(sense);
            let mut sums = vec![0.0; lines.y.len()];
            for k in 1..sums.len() {
                let rise = lines.y[k] - lines.y[k - 1];
                sums[k] = sums[k - 1] + if rise > 0.0 { lines.compliance[k - 1] * rise } else { 0.0 };
            }
            sums
        });
        Self {
            half_impedance: 0.5 * impedance,
            half_compliance: 0.5 / impedance,
            concave: falls(medium.lines(1.0)) && falls(medium.lines(-1.0)),
            alike: medium.lines(1.0).are(medium.lines(-1.0)),
            velocity_to_line,
            medium,
        }
    }

    /// Returns the smaller elastic limit of first loading, Pa.
    pub fn yield_stress(&self) -> f64 {
        self.medium.lines(1.0).first_yield.min(self.medium.lines(-1.0).first_yield)
    }

    /// Returns the solution if both sides stay elastic. Kernels with their own implementation use the same form, and so obtain the
    /// same bits.
    #[inline(always)]
    pub fn acoustic(half_impedance: f64, half_compliance: f64, left: Flux, right: Flux) -> Flux {
        Flux {
            stress: 0.5 * (left.stress + right.stress) + half_impedance * (right.velocity - left.velocity),
            velocity: 0.5 * (left.velocity + right.velocity) + half_compliance * (right.stress - left.stress),
        }
    }

    /// Returns the halves of the elastic impedance and compliance, for [`Faces::acoustic`].
    pub fn halves(&self) -> [f64; 2] {
        [self.half_impedance, self.half_compliance]
    }

    /// Returns stress and velocity at a face between two states of this medium. If a level curve caps the stress, the velocity
    /// is the mean of both sides.
    pub fn solve(&self, left: &FaceState, right: &FaceState, work: &mut Workspace) -> Flux {
        match self.medium.flow {
            Flow::Plastic { kinematic } => self.plastic(kinematic, left, right, work),
            Flow::Overlay => self.overlay(left, right, work),
            Flow::PathIndependent => self.path_independent(left, right, work),
        }
    }

    pub(super) fn elastic(&self, left: &FaceState, right: &FaceState) -> Flux {
        Self::acoustic(self.half_impedance, self.half_compliance, left.flux(), right.flux())
    }

    /// Returns true if the side reaches this stress elastically.
    pub fn stays_elastic(&self, near: &FaceState, stress: f64) -> bool {
        let sense = if stress < near.point.stress { -1.0 } else { 1.0 };
        if self.medium.flow == Flow::Overlay {
            return sense * stress <= self.overlay_limit(near, sense);
        }
        let Flow::Plastic { kinematic } = self.medium.flow else {
            let z = near.point.stress + near.point.plastic;
            return z.abs() <= self.medium.lines(z).first_yield
                && stress.abs() <= self.medium.lines(stress).first_yield;
        };
        sense * stress <= self.loading_path(near, sense, kinematic).limit
    }

    fn plastic(&self, kinematic: f64, left: &FaceState, right: &FaceState, work: &mut Workspace) -> Flux {
        let elastic = self.elastic(left, right);
        let sense = if elastic.stress < left.point.back { -1.0 } else { 1.0 };
        if kinematic == 0.0 && sense * elastic.stress <= self.medium.lines(sense).first_yield {
            return elastic;
        }
        let sense_right = if elastic.stress < right.point.back { -1.0 } else { 1.0 };
        let (a, b) = (self.loading_path(left, sense, kinematic), self.loading_path(right, sense_right, kinematic));
        if sense * elastic.stress <= a.limit && sense_right * elastic.stress <= b.limit {
            return elastic;
        }
        let start = a.limit.min(b.limit);
        let low = |near: &FaceState, limit: f64| {
            if kinematic == 0.0 {
                -self.medium.lines(-sense).first_yield
            } else {
                2.0 * sense * near.point.back - limit
            }
        };
        let reached = start >= low(left, a.limit) && start >= low(right, b.limit);
        let walks = sense == sense_right && reached && (self.concave || one_line(&a, &b));
        if walks && let Some(flux) = self.walk(sense, left, right, a, b) {
            return flux;
        }
        self.general(left, right, work)
    }

    /// Returns the loading path of a side in a sense.
    fn loading_path(&self, near: &FaceState, sense: f64, kinematic: f64) -> LoadingPath<'_> {
        let lines = self.medium.lines(sense);
        let own = sense * near.point.stress;
        let (line, _, y) = lines.at_accumulated(near.point.accumulated);
        let limit = sense * near.point.back + lines.half_range(y, kinematic);
        if near.flowing != sense && own <= limit || !limit.is_finite() {
            return LoadingPath { lines, own, limit, line, shift: limit - y, elastic: true };
        }
        let line = self.line_at(lines, line, y + (own - limit));
        LoadingPath { lines, own, limit: own, line, shift: limit - y, elastic: true }
    }

    /// Returns the line on which the curve has stress y, searched from `line`. A level line is not left.
    fn line_at(&self, lines: &Lines, mut line: usize, y: f64) -> usize {
        while line > 0 && y < lines.y[line] - self.medium.round_off {
            line -= 1;
        }
        while line + 1 < lines.y.len() && y > lines.y[line + 1] + self.medium.round_off {
            line += 1;
        }
        line
    }

    /// Finds the solution by walking along two paths of the same sense. Returns `None` if the walk enters a part of the curve where slopes may
    /// increase.
    fn walk(
        &self,
        sense: f64,
        left: &FaceState,
        right: &FaceState,
        mut a: LoadingPath,
        mut b: LoadingPath,
    ) -> Option<Flux> {
        let elastic = 2.0 * self.half_compliance;
        let target = sense * (right.point.velocity - left.point.velocity);
        let mut stress = a.limit.min(b.limit);
        let (mut moved_a, mut moved_b) = (elastic * (stress - a.own), elastic * (stress - b.own));
        loop {
            let (soft_a, soft_b) = (a.compliance(elastic), b.compliance(elastic));
            let next = a.next().min(b.next());
            let soft = soft_a + soft_b;
            if soft == f64::INFINITY {
                // A level end caps the stress; after a level segment inside the curve the hull continues.
                if !self.concave {
                    return None;
                }
                break;
            }
            let step = ((target - (moved_a + moved_b)) / soft).max(0.0);
            if stress + step <= next {
                stress += step;
                moved_a += soft_a * step;
                moved_b += soft_b * step;
                break;
            }
            if !self.concave && !a.elastic && !b.elastic {
                return None;
            }
            moved_a += soft_a * (next - stress);
            moved_b += soft_b * (next - stress);
            stress = next;
            a.pass(stress);
            b.pass(stress);
        }
        let (from_left, from_right) = (left.point.velocity + sense * moved_a, right.point.velocity - sense * moved_b);
        Some(Flux { stress: sense * stress, velocity: 0.5 * (from_left + from_right) })
    }

    /// Returns the state of a side with its history moved along the curve to its stress at the face. This applies if the side flows, or if its slope
    /// lifts the stress at the face above the elastic limit.
    fn moved_along(&self, near: &FaceState, kinematic: f64) -> Point {
        let mut point = near.point;
        let flows = near.flowing != 0.0;
        let sense = if flows { near.flowing } else { 1.0_f64.copysign(point.stress - point.back) };
        let lines = self.medium.lines(sense);
        let (line, _, y) = lines.at_accumulated(point.accumulated);
        let limit = sense * point.back + lines.half_range(y, kinematic);
        if !limit.is_finite() {
            return point;
        }
        let rise = sense * point.stress - limit;
        if !flows && rise <= 0.0 {
            return point;
        }
        let line = self.line_at(lines, line, y + rise);
        let slope = lines.slope[line];
        if slope > 0.0 {
            let along = ((y + rise - lines.y[line]) / slope).max(0.0);
            point.accumulated = lines.p[line] + (1.0 - slope) * along;
            point.back += sense * kinematic * rise;
        }
        point
    }

    fn path_independent(&self, left: &FaceState, right: &FaceState, work: &mut Workspace) -> Flux {
        let elastic = self.elastic(left, right);
        let abscissa = |near: &FaceState| near.point.stress + near.point.plastic;
        let (z_left, z_right) = (abscissa(left), abscissa(right));
        let within = |z: f64| z.abs() <= self.medium.lines(z).first_yield;
        if within(z_left) && within(z_right) && within(elastic.stress) {
            return elastic;
        }
        let sense = if z_left + z_right < 0.0 { -1.0 } else { 1.0 };
        if sense * z_left >= 0.0 && sense * z_right >= 0.0 {
            let found = self.on_one_line(sense, left, right, [z_left, z_right]);
            let found = found.or_else(|| self.fan_and_shock(sense, left, right, [z_left, z_right]));
            if let Some(flux) = found {
                return flux;
            }
        }
        self.general(left, right, work)
    }

    /// Returns the state, moved onto a level segment of the curve if it lies within rounding of it.
    fn on_level(&self, point: &Point) -> Point {
        let z = point.stress + point.plastic;
        let sense = if z < 0.0 { -1.0 } else { 1.0 };
        let lines = self.medium.lines(sense);
        let line = lines.at(z.abs() + self.medium.round_off.max(1e-14 * z.abs()));
        if lines.slope[line] > 0.0 {
            return *point;
        }
        let stress = sense * lines.y[line];
        Point { stress, plastic: z - stress, ..*point }
    }

    /// Returns the solution if both states and the solution lie on one line of the curve, else `None`.
    fn on_one_line(&self, sense: f64, left: &FaceState, right: &FaceState, z: [f64; 2]) -> Option<Flux> {
        let lines = self.medium.lines(sense);
        let line = lines.at(sense * z[0]);
        let compliance = lines.compliance[line];
        if lines.at(sense * z[1]) != line || compliance.is_infinite() {
            return None;
        }
        let flux = Self::acoustic(0.5 / compliance, 0.5 * compliance, left.flux(), right.flux());
        let end = lines.y.get(line + 1).copied().unwrap_or(f64::INFINITY);
        (lines.y[line]..=end).contains(&(sense * flux.stress)).then_some(flux)
    }

    /// Returns the solution for falling slopes along the curve if neither side crosses zero stress: a side that loads emits a fan, a side that
    /// unloads a shock. Returns `None` for other solutions.
    fn fan_and_shock(&self, sense: f64, left: &FaceState, right: &FaceState, z: [f64; 2]) -> Option<Flux> {
        if !self.concave {
            return None;
        }
        let start = |near: &FaceState, z: f64| Branch::new(self, sense, sense * near.point.stress, sense * z);
        let (a, b) = (start(left, z[0]), start(right, z[1]));
        let target = sense * (right.point.velocity - left.point.velocity);
        let lines = self.medium.lines(sense);
        let last = lines.y.len() - 1;
        let cap = if lines.slope[last] == 0.0 { lines.y[last] } else { f64::INFINITY };
        let stress = intersection(&a, &b, target, cap)?;
        let (from_left, from_right) =
            (left.point.velocity + sense * a.change(stress).0, right.point.velocity - sense * b.change(stress).0);
        Some(Flux { stress: sense * stress, velocity: 0.5 * (from_left + from_right) })
    }

    pub(super) fn general(&self, left: &FaceState, right: &FaceState, work: &mut Workspace) -> Flux {
        let (left, right) = (self.placed(left), self.placed(right));
        let star = solve(Side::Face(&self.medium, &left), Side::Face(&self.medium, &right), work);
        let velocity = 0.5 * (star.velocity_left + star.velocity_right);
        Flux { stress: star.force / self.medium.area, velocity }
    }

    /// Returns a side in the form that [`solve`] expects: with the history that belongs to its stress.
    pub fn placed(&self, near: &FaceState) -> FaceState {
        match self.medium.flow {
            Flow::Plastic { kinematic } => FaceState { point: self.moved_along(near, kinematic), ..*near },
            Flow::PathIndependent => FaceState { point: self.on_level(&near.point), ..*near },
            Flow::Overlay => FaceState { reversals: self.reversals(near), ..*near },
        }
    }

    /// Returns the line of the curve at z >= 0, in magnitudes, for a sense of stress (+1 tension, -1 compression).
    pub fn line(&self, sense: f64, z: f64) -> Straight {
        let lines = self.medium.lines(sense);
        let k = lines.at(z);
        let slope = lines.slope[k];
        let (start, end) = (lines.z[k], lines.z.get(k + 1).copied().unwrap_or(f64::INFINITY));
        Straight { start, end, offset: lines.y[k] - slope * lines.z[k], slope, compliance: lines.compliance[k] }
    }

    /// Returns the stresses at the start and the end, Pa, and the compliance, m/(s Pa), of the line with this stress (Pa, in magnitude), which is
    /// `line` or the one that follows. If the curve does not rise along `line`, the stress does not tell how far the flow has advanced; `line` is
    /// then returned, with its infinite compliance.
    pub(super) fn line_with(&self, sense: f64, stress: f64, line: usize) -> [f64; 3] {
        let lines = self.medium.lines(sense);
        let here = lines.stresses(line);
        let [_, end, compliance] = here;
        if compliance.is_finite() && stress > end { lines.stresses(line + 1) } else { here }
    }

    /// Returns the same data for the line at z, Pa, in magnitude.
    pub(super) fn line_at_strain(&self, sense: f64, z: f64) -> [f64; 3] {
        let lines = self.medium.lines(sense);
        lines.stresses(lines.at(z))
    }

    /// Returns sense * stress at which a point with this history starts to flow, Pa; infinite if it never does.
    pub fn limit(&self, accumulated: f64, back: f64, sense: f64) -> f64 {
        self.located(accumulated, back, sense).1
    }

    /// Returns the limits in tension and compression, each with the line of the curve on which it lies.
    pub fn limits(&self, accumulated: f64, back: f64) -> [(usize, f64); 2] {
        let tension = self.located(accumulated, back, 1.0);
        [tension, if self.alike && back == 0.0 { tension } else { self.located(accumulated, back, -1.0) }]
    }

    fn located(&self, accumulated: f64, back: f64, sense: f64) -> (usize, f64) {
        match self.medium.flow {
            Flow::Plastic { kinematic } => self.medium.located(accumulated, back, sense, kinematic),
            Flow::PathIndependent => (0, f64::INFINITY),
            Flow::Overlay => (0, sense * back + self.medium.lines(sense).first_yield),
        }
    }

    /// Returns E times the strain (path-independent flow) or accumulated plastic strain from which on the curve is level or falls, in tension and
    /// compression, Pa; infinite if it rises throughout.
    pub fn levels(&self) -> [f64; 2] {
        [1.0, -1.0].map(|sense| {
            let lines = self.medium.lines(sense);
            let level = lines.slope.iter().position(|&slope| slope <= LEVEL);
            level.map_or(f64::INFINITY, |k| self.along(lines, k))
        })
    }

    /// Returns the position of knot `k` along the curve: E times the strain for path-independent flow, else E times the plastic strain, Pa.
    fn along(&self, lines: &Lines, k: usize) -> f64 {
        lines.z[k] - if self.medium.flow == Flow::PathIndependent { 0.0 } else { lines.y[k] }
    }

    /// Returns a flowing side moved back along its own wave, to the state before its stress increased by `gained` (Pa, >= 0) along the curve. The
    /// Riemann problem has the same solution, unless that lies below the stress moved back to. `outward` is +1 for the left side, -1 for the right.
    pub fn before(&self, near: FaceState, gained: f64, outward: f64, work: &mut Workspace) -> FaceState {
        let kinematic = match self.medium.flow {
            Flow::Plastic { kinematic } => kinematic,
            Flow::PathIndependent => return near,
            Flow::Overlay => return self.overlay_before(near, gained, outward, &mut work.left),
        };
        let FaceState { point, flowing: sense, .. } = near;
        let lines = self.medium.lines(sense);
        let (line, _, y) = lines.at_accumulated(point.accumulated);
        let top = y + sense * point.stress - (sense * point.back + lines.half_range(y, kinematic));
        let (from, to) = (self.moved(sense, top - gained, line), self.moved(sense, top, line));
        let change = to.0 - from.0;
        // A shock cannot be undone in part.
        if !change.is_finite() || !(self.concave || from.1 == to.1) {
            return near;
        }
        let point = Point {
            stress: point.stress - sense * gained,
            velocity: point.velocity - outward * sense * change,
            ..point
        };
        FaceState { point, ..near }
    }

    /// Returns the velocity change along the curve from zero stress to y, m/s, and the line of y, searched from `line`. A y within rounding above
    /// a knot counts as the knot: the line that follows may be level, and no velocity produces a rise along it.
    fn moved(&self, sense: f64, y: f64, mut line: usize) -> (f64, usize) {
        let lines = self.medium.lines(sense);
        let at_knot = y - self.medium.round_off;
        while line + 1 < lines.y.len() && lines.y[line + 1] < at_knot {
            line += 1;
        }
        while line > 0 && lines.y[line] >= at_knot {
            line -= 1;
        }
        let rise = y - lines.y[line];
        (self.velocity_to_line[side(sense)][line] + if rise > 0.0 { lines.compliance[line] * rise } else { 0.0 }, line)
    }

    /// Returns E times the strains (path-independent flow) or plastic strains beyond which the curve stiffens, in tension and compression,
    /// Pa. They are increased by rounding, so that a point at rest at a knot has not passed it.
    pub fn stiffenings(&self) -> [Vec<f64>; 2] {
        [1.0, -1.0].map(|sense| {
            let lines = self.medium.lines(sense);
            let at = |k: usize| self.along(lines, k) + self.medium.round_off;
            (1..lines.z.len()).filter(|&k| lines.slope[k] > lines.slope[k - 1]).map(at).collect()
        })
    }
}

impl FaceState {
    fn flux(&self) -> Flux {
        Flux { stress: self.point.stress, velocity: self.point.velocity }
    }
}

fn side(sense: f64) -> usize {
    usize::from(sense < 0.0)
}

/// Returns true if both paths are beyond their limits from the start and lie on one line.
fn one_line(a: &LoadingPath, b: &LoadingPath) -> bool {
    a.limit == a.own && b.limit == b.own && a.line == b.line && a.shift == b.shift
}

/// Waves emitted by a state on a path-independent curve, in magnitudes of stress.
struct Branch<'a> {
    lines: &'a Lines,
    velocity_to_line: &'a [f64],
    own: f64,
    z: f64,
    /// Velocity change from zero stress to the stress of the state, m/s.
    base: f64,
    impedance2: f64,
}

impl<'a> Branch<'a> {
    fn new(faces: &'a Faces, sense: f64, own: f64, z: f64) -> Self {
        let (lines, velocity_to_line) = (faces.medium.lines(sense), &faces.velocity_to_line[side(sense)]);
        let line = lines.at(z.max(0.0));
        // Within rounding, a state may lie above a level segment.
        let rise = if lines.slope[line] > 0.0 { own - lines.y[line] } else { 0.0 };
        let base = velocity_to_line[line] + if rise > 0.0 { lines.compliance[line] * rise } else { 0.0 };
        Self { lines, velocity_to_line, own, z, base, impedance2: faces.medium.modulus * faces.medium.density }
    }

    /// Returns the velocity change on the way to `stress`, and its derivative.
    fn change(&self, stress: f64) -> (f64, f64) {
        let lines = self.lines;
        // At a knot, the line below it is used: the one above may be level.
        let line = lines.y.partition_point(|&y| y < stress).max(1) - 1;
        let (compliance, slope) = (lines.compliance[line], lines.slope[line]);
        let rise = stress - lines.y[line];
        if stress >= self.own {
            let along = if rise > 0.0 { compliance * rise } else { 0.0 };
            return (self.velocity_to_line[line] + along - self.base, compliance);
        }
        let (fall, back) = (self.own - stress, self.z - (lines.z[line] + if rise > 0.0 { rise / slope } else { 0.0 }));
        let change = (fall * back / self.impedance2).max(0.0).sqrt();
        let steepness =
            if change > 0.0 { 0.5 * (back + fall / slope) / (change * self.impedance2) } else { compliance };
        (-change, steepness)
    }
}

/// Largest number of Newton steps, or bisections where a step leaves the bracket. Newton steps double the digits, so few are ever needed.
const MOST_STEPS: usize = 80;

/// Returns the stress in 0..cap at which both velocity changes add up to `target`. `None` if there is none.
fn intersection(a: &Branch, b: &Branch, target: f64, cap: f64) -> Option<f64> {
    let total = |stress: f64| {
        let ((first, steep_first), (second, steep_second)) = (a.change(stress), b.change(stress));
        (first + second - target, steep_first + steep_second)
    };
    let mut stress = (0.5 * (a.own + b.own)).min(cap);
    let (mut low, mut high) = (0.0_f64, cap);
    let resolution = 2.0 * f64::EPSILON * a.own.max(b.own);
    for _ in 0..MOST_STEPS {
        let (missed, steepness) = total(stress);
        if missed == 0.0 {
            return Some(stress);
        }
        if missed > 0.0 {
            high = stress;
        } else {
            low = stress;
        }
        let step = -missed / steepness;
        let mut next = stress + step;
        if step.abs() <= resolution {
            return (next >= 0.0 && next <= cap).then_some(next);
        }
        // The ends of the bracket are tested before bisection: the solution may lie outside of it.
        if next.partial_cmp(&low) != Some(std::cmp::Ordering::Greater) || next >= high {
            let (at_zero, at_cap) = (low == 0.0 && step < 0.0, high == cap && step > 0.0);
            if (at_zero && total(0.0).0 > 0.0) || (at_cap && (cap.is_infinite() || total(cap).0 < 0.0)) {
                return None;
            }
            next = 0.5 * (low + high);
        }
        stress = next;
    }
    Some(stress)
}
