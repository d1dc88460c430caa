//! Outer faces of blocks, at ends and joints: the state of the bar there, and the flux.

use super::block::{Block, Stage};
use super::part::Part;
use super::slope::{cap, capped, limited};
use crate::bar::ends::Response;
use crate::law::flows;
use crate::wave::riemann::{FaceState, Flux, Point, Workspace};

/// Response of an elastic bar at its face. `inward` is +1 if the bar is to the right of the face and -1 if it is to the left.
pub(super) fn response(part: &Part, near: &Point, inward: f64) -> Response {
    let Point { stress, velocity, .. } = *near;
    let impedance = part.area * part.faces.medium.impedance();
    Response { force: -part.area * stress - impedance * inward * velocity, impedance }
}

/// Returns the flux through a face under a stress. Stress beyond what the curve can carry still acts on the face.
pub(super) fn under(stress: f64, inward: f64, part: &Part, near: &FaceState, work: &mut Workspace) -> Flux {
    let (point, impedance) = (&near.point, part.faces.medium.impedance());
    if part.faces.stays_elastic(near, stress) {
        return Flux { stress, velocity: point.velocity - inward * (stress - point.stress) / impedance };
    }
    let sense = if stress < point.stress { -1.0 } else { 1.0 };
    let path = &mut work.left;
    path.fill_at_face(&part.faces.medium, &part.faces.placed(near), sense);
    let carried = (sense * stress).min(path.cap());
    // The excess accelerates the face as if it were elastic.
    let change = path.velocity(carried) + (sense * stress - carried) / impedance;
    Flux { stress, velocity: point.velocity - inward * sense * change }
}

/// Relative difference up to which two stresses count as equal.
const EQUAL: f64 = 1e-9;

/// Returns E times the strain per stress of the first or last cell of a block for a stress that rises (`change` > 0) or falls: 1 if the cell stays
/// elastic. If it flows, the value is the ratio of the differences to the next cell, which represents the bend of the curve in coarse cells, limited
/// to the compliance of the curve: between cells that have flowed by different amounts the ratio may be anything, and between equal stresses it is
/// rounding.
pub(super) fn compliance_ratio(block: &Block, part: &Part, side: usize, change: f64, work: &mut Workspace) -> f64 {
    if block.stage != Stage::Plastic || change == 0.0 {
        return 1.0;
    }
    let (law, i, j) = (part.law.law.as_ref(), block.inside(side, 0), block.inside(side, 1));
    let (stress, z) = (block.sigma[i], block.e_equivalent_strain(part, i));
    let (accumulated, back) = (law.accumulated(&block.state, i), law.back_stress(&block.state, i));
    let point = Point { stress, accumulated, plastic: z - stress, back, ..Point::default() };
    let here = FaceState { point, flowing: 0.0, reversals: law.reversals(&block.state, i) };
    work.left.fill_at_face(&part.faces.medium, &part.faces.placed(&here), 1.0_f64.copysign(change));
    let slope = work.left.start_slope();
    // Along a level stretch no stress rises.
    let most = if slope > 0.0 { (1.0 / slope).max(1.0) } else { 1.0 };
    let (rise, stretch) = (block.sigma[j] - stress, block.e_equivalent_strain(part, j) - z);
    if rise.abs() > EQUAL * stress.abs() { (stretch / rise).clamp(1.0, most) } else { most }
}

/// Extrapolation of a cell to its outer face, half a step ahead.
struct ToFace {
    /// Index of the cell in the rows of its block.
    i: usize,
    /// Fraction of the slope to add: -1/2 at the left end of a block, 1/2 at the right.
    outward: f64,
    /// Whether the cell has no slopes.
    flat: bool,
    /// E times the strain increment of half a step, Pa.
    half_strain: f64,
    /// Slope of the stress, as a difference, Pa.
    rise: f64,
    /// Velocity at the face, m/s.
    velocity: f64,
}

impl ToFace {
    fn new(block: &Block, part: &Part, side: usize) -> Self {
        let i = block.inside(side, 0);
        let outward = if side == 0 { -0.5 } else { 0.5 };
        let flat = block.is_first_order(part, i);
        let slope = |row: &[f64]| if flat { 0.0 } else { limited(row[i] - row[i - 1], row[i + 1] - row[i]) };
        let (rise, dv) = (slope(&block.sigma), slope(&block.v));
        let velocity = block.v[i] + 0.5 * part.velocity_gain * rise + outward * dv;
        Self { i, outward, flat, half_strain: 0.5 * part.gain * dv, rise, velocity }
    }

    fn elastic(&self, block: &Block) -> FaceState {
        let stress = block.sigma[self.i] + self.half_strain + self.outward * self.rise;
        FaceState { point: Point { stress, velocity: self.velocity, ..Point::default() }, ..FaceState::default() }
    }

    /// Returns the face state from slopes of strain, where the curve is followed both ways.
    fn along_curve(&self, block: &Block, part: &Part, state: &mut [f64]) -> FaceState {
        let z = |i: usize| block.e_equivalent_strain(part, i);
        let i = self.i;
        let dz = if self.flat { 0.0 } else { limited(z(i) - z(i - 1), z(i + 1) - z(i)) };
        let (mut stress, mut flow) = ([0.0], [0.0]);
        part.law.law.strain(&[z(i) + self.half_strain + self.outward * dz], &mut stress, state, &mut flow);
        let point = Point { stress: stress[0], velocity: self.velocity, plastic: state[0], ..Point::default() };
        FaceState { point, ..FaceState::default() }
    }

    /// Returns the face state from slopes of stress, advanced by half a step with the law, where cells have histories.
    fn with_history(&self, block: &Block, part: &Part, state: &mut [f64], work: &mut Workspace) -> FaceState {
        let (law, i) = (part.law.law.as_ref(), self.i);
        for (number, value) in state.iter_mut().enumerate() {
            *value = block.state_at(number, i);
        }
        let (mut ahead, mut flow) = ([block.sigma[i]], [0.0]);
        law.strain(&[self.half_strain], &mut ahead, state, &mut flow);
        let reversals = law.reversals(&block.state, i);
        let (accumulated, back) = (law.accumulated(state, 0), law.back_stress(state, 0));
        let stress = ahead[0] + self.outward * self.rise;
        let mut point = Point { stress, velocity: self.velocity, accumulated, back, ..Point::default() };
        if !flows(flow[0], ahead[0]) {
            return FaceState { point, flowing: 0.0, reversals };
        }
        if part.most_energy_defect.is_some() {
            point.stress = capped(stress, cap(ahead[0], &block.sigma, i));
        }
        let sense = if ahead[0] < back { -1.0 } else { 1.0 };
        let start = part.faces.limit(law.accumulated(&block.state, i), law.back_stress(&block.state, i), sense);
        let gained = (sense * ahead[0] - start).max(0.0);
        part.faces.before(FaceState { point, flowing: sense, reversals }, gained, 2.0 * self.outward, work)
    }
}

/// Returns the state of the first or last cell of a block at its outer face, half a step ahead. `state` is scratch for its law state.
pub(super) fn near(block: &Block, part: &Part, side: usize, state: &mut Vec<f64>, work: &mut Workspace) -> FaceState {
    let to_face = ToFace::new(block, part, side);
    if block.stage != Stage::Plastic {
        return to_face.elastic(block);
    }
    state.clear();
    state.resize(part.law.law.state_len(), 0.0);
    if part.path_independent {
        to_face.along_curve(block, part, state)
    } else {
        to_face.with_history(block, part, state, work)
    }
}
