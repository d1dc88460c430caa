//! Solves many faces at once between cells that flow along one line of the curve. [`Faces::solve`] finds the same solutions by a walk over lines.

use std::ops::Range;

use multiversion::multiversion;

use super::face::Faces;
use super::medium::Flow;

/// Lines of the curve along which the cells of a row flow. Stresses are multiplied by the sense of the flow.
#[derive(Debug, Clone)]
pub struct FlowingRow<const N: usize> {
    /// Sense of the flow, +1 in tension and -1 in compression; 0 in cells whose faces are to be solved by other means.
    sense: [f64; N],
    /// The line: stresses at its start and its end, Pa, and its compliance, m/(s Pa).
    start: [f64; N],
    end: [f64; N],
    compliance: [f64; N],
    /// Increase of the stress at the faces along the curve in half a step, Pa, >= 0, see [`Faces::before`].
    gained: [f64; N],
}

/// Stresses and velocities of cells at one side of faces.
pub type AtFaces<'a> = [&'a [f64]; 2];

impl<const N: usize> FlowingRow<N> {
    /// Returns a row in which no cell flows.
    pub fn resting() -> Self {
        let zeros = [0.0; N];
        Self { sense: zeros, start: zeros, end: zeros, compliance: zeros, gained: zeros }
    }

    /// Marks cell `i` as not flowing.
    pub fn rest(&mut self, i: usize) {
        self.sense[i] = 0.0;
    }

    /// Returns true if any of these cells flows.
    pub fn any(&self, mut cells: Range<usize>) -> bool {
        cells.any(|i| self.sense[i] != 0.0)
    }

    /// Marks cell `i` as flowing in this sense, after an increase of the stress by `gained` (Pa). The cell lies at `stress` (Pa, in magnitude) of the
    /// isotropic curve, on `line`, on which it started to flow, or on the line that follows.
    pub fn flow(&mut self, i: usize, faces: &Faces, sense: f64, gained: f64, (stress, line): (f64, usize)) {
        self.gained[i] = gained;
        self.put(i, sense, faces.line_with(sense, stress, line));
    }

    /// Marks cell `i` as lying beyond the elastic limit of a path-independent curve; z is E times its strain, Pa.
    pub fn lie_at(&mut self, i: usize, faces: &Faces, z: f64) {
        let sense = 1.0_f64.copysign(z);
        self.gained[i] = 0.0;
        self.put(i, sense, faces.line_at_strain(sense, z.abs()));
    }

    fn put(&mut self, i: usize, sense: f64, [start, end, compliance]: [f64; 3]) {
        self.sense[i] = if compliance.is_finite() { sense } else { 0.0 };
        (self.start[i], self.end[i], self.compliance[i]) = (start, end, compliance);
    }

    /// Solves the faces between cells `first - 1` and `first`, and so on, given the states at their left and right. If both cells flow along one line
    /// and the solution lies on it too, writes it into `through` and sets `solved` to 1. Otherwise leaves `through` unchanged and sets `solved` to 0.
    /// On entry `through` contains the acoustic solution; with isotropic hardening it is kept for stresses up to `limit`, Pa.
    pub fn solve(
        &self,
        faces: &Faces,
        limit: f64,
        first: usize,
        [left, right]: [AtFaces<'_>; 2],
        through: [&mut [f64]; 2],
        solved: &mut [f64],
    ) {
        let (of_left, of_right) = (first - 1..first - 1 + solved.len(), first..first + solved.len());
        let constants = [limit, 2.0 * faces.halves()[1]];
        let [sense, start, gained] = [&self.sense, &self.start, &self.gained]
            .map(|values| [&values[of_left.clone()], &values[of_right.clone()]]);
        let line = [&self.end, &self.compliance].map(|values| &values[of_left.clone()]);
        if faces.medium.flow == Flow::PathIndependent {
            solve::<true>(constants, sense, start, gained, line, left, right, through, solved);
        } else {
            solve::<false>(constants, sense, start, gained, line, left, right, through, solved);
        }
    }
}

/// Vectorized part of [`FlowingRow::solve`], for the cells on both sides (a left, b right) of the faces; `line` data are those of the left cells.
///
/// With s the stress and v the velocity in the sense of the flow, and c the compliance of each side on its way to the solution,
/// `s = s_a + (v - v_a)/c_a` and `s = s_b - (v - v_b)/c_b`. A side reaches a stress below its own elastically, and a stress above it along the line;
/// if the curve is followed `BOTH_WAYS`, both along the line.
#[expect(clippy::too_many_arguments)]
#[multiversion(targets("x86_64+avx512f+avx512dq+avx512vl+avx512bw", "x86_64+avx2"))]
fn solve<const BOTH_WAYS: bool>(
    [limit, elastic]: [f64; 2],
    [sense_a, sense_b]: [&[f64]; 2],
    [start_a, start_b]: [&[f64]; 2],
    [gained_a, gained_b]: [&[f64]; 2],
    [end, compliance]: [&[f64]; 2],
    [stress_a, velocity_a]: AtFaces<'_>,
    [stress_b, velocity_b]: AtFaces<'_>,
    [stress, velocity]: [&mut [f64]; 2],
    solved: &mut [f64],
) {
    let faces = solved.len();
    let (sense_a, sense_b, start_a, start_b) =
        (&sense_a[..faces], &sense_b[..faces], &start_a[..faces], &start_b[..faces]);
    let (gained_a, gained_b, end, compliance) =
        (&gained_a[..faces], &gained_b[..faces], &end[..faces], &compliance[..faces]);
    let (stress_a, velocity_a, stress_b, velocity_b) =
        (&stress_a[..faces], &velocity_a[..faces], &stress_b[..faces], &velocity_b[..faces]);
    let (stress, velocity) = (&mut stress[..faces], &mut velocity[..faces]);
    for i in 0..faces {
        let (sense, flowing) = (sense_a[i], compliance[i]);
        let (top_a, top_b) = (sense * stress_a[i], sense * stress_b[i]);
        let (a, b) = (top_a - gained_a[i], top_b - gained_b[i]);
        let v_a = sense * velocity_a[i] - flowing * gained_a[i];
        let v_b = sense * velocity_b[i] + flowing * gained_b[i];
        let (low, high) = if a < b { (a, b) } else { (b, a) };
        let gap = v_b - v_a;
        let [unloads, loads] =
            [!BOTH_WAYS && gap <= elastic * (low - high), BOTH_WAYS || gap >= flowing * (high - low)];
        let c_a = if unloads || (!loads && a > b) { elastic } else { flowing };
        let c_b = if unloads || (!loads && b > a) { elastic } else { flowing };
        let s = (c_a * a + c_b * b + gap) / (c_a + c_b);
        let v = 0.5 * ((v_a + c_a * (s - a)) + (v_b - c_b * (s - b)));
        let top = if top_a > top_b { top_a } else { top_b };
        let one_line = sense != 0.0 && sense == sense_b[i] && start_a[i] == start_b[i];
        let least = if BOTH_WAYS { start_a[i] } else { 0.0 };
        let asked = BOTH_WAYS || stress[i].abs() > limit;
        let on_it = asked && one_line && low >= start_a[i] && top <= end[i] && s >= least && s <= end[i];
        solved[i] = if on_it { 1.0 } else { 0.0 };
        stress[i] = if on_it { sense * s } else { stress[i] };
        velocity[i] = if on_it { sense * v } else { velocity[i] };
    }
}

#[cfg(test)]
mod tests {
    use super::super::{FaceState, Medium, Point, Workspace};
    use super::*;
    use crate::law::Table;
    use crate::material::{Beyond, Curve};

    const CELLS: usize = 400;

    fn faces(flow: Flow) -> Faces {
        let knot = |k: i32| 1e-3 * 1.3_f64.powi(k);
        let rows: Vec<(f64, f64)> = (0..12).map(|k| (knot(k), 2e8 * (knot(k) / 1e-3).powf(0.3))).collect();
        let table = Table::new(&Curve::new(&rows, Beyond::Extend).expect("a curve"), 2e11);
        Faces::new(Medium::new([&table, &table], 2e11, 7800.0, 1.0, flow, 1e-5))
    }

    /// Returns pseudorandom numbers between 0 and 1.
    fn number(seed: &mut u64) -> f64 {
        *seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (*seed >> 11) as f64 / (1_u64 << 53) as f64
    }

    /// Cells beyond yield, in either sense, with steps and slopes of some percent; the state of each at its left and its right face.
    struct Cells {
        row: FlowingRow<CELLS>,
        gained: Vec<f64>,
        at: Vec<[FaceState; 2]>,
    }

    fn cells(faces: &Faces) -> Cells {
        let both_ways = faces.medium.flow == Flow::PathIndependent;
        let (mut seed, mut row) = (1, FlowingRow::resting());
        let (mut gains, mut at) = (Vec::new(), Vec::new());
        for i in 0..CELLS {
            let sense = if i < CELLS / 2 { 1.0 } else { -1.0 };
            let lines = faces.medium.lines(sense);
            let z = 2.5e8 + 4e8 * (i % (CELLS / 2)) as f64 / CELLS as f64 + 1e6 * number(&mut seed);
            let on_curve = |z: f64| {
                let line = lines.at(z);
                (line, lines.y[line] + lines.slope[line] * (z - lines.z[line]))
            };
            let (line, stress) = on_curve(z);
            let gained = if both_ways { 0.0 } else { 1e6 * number(&mut seed) };
            let velocity = 2.0 * (number(&mut seed) - 0.5);
            let half = 2e6 * (number(&mut seed) - 0.5);
            at.push([-half, half].map(|by| {
                let (at_face, velocity) = (on_curve(z + by).1, velocity + 1e-7 * by);
                let point = if both_ways {
                    Point { stress: sense * at_face, velocity, plastic: sense * (z + by - at_face), ..Point::default() }
                } else {
                    Point { stress: sense * at_face, velocity, accumulated: z - stress, ..Point::default() }
                };
                FaceState { point, flowing: if both_ways { 0.0 } else { sense }, ..FaceState::default() }
            }));
            if both_ways {
                row.lie_at(i, faces, sense * z);
            } else {
                row.flow(i, faces, sense, gained, (stress, line.saturating_sub(i % 2)));
            }
            gains.push(gained);
        }
        Cells { row, gained: gains, at }
    }

    #[test]
    fn faces_between_cells_on_one_line_have_the_answers_of_the_walk() {
        for flow in [Flow::Plastic { kinematic: 0.0 }, Flow::PathIndependent] {
            let (faces, mut work) = (faces(flow), Workspace::default());
            let Cells { row, gained, at } = cells(&faces);
            let side = |side: usize, cells: Range<usize>| {
                let points = || at[cells.clone()].iter().map(|at| at[side].point);
                [points().map(|p| p.stress).collect(), points().map(|p| p.velocity).collect::<Vec<_>>()]
            };
            let (left, right) = (side(1, 0..CELLS - 1), side(0, 1..CELLS));
            // The initial values make all acoustic solutions exceed the limit.
            let [mut stress, mut velocity] = [vec![f64::INFINITY; CELLS - 1], vec![0.0; CELLS - 1]];
            let mut solved = vec![0.0; CELLS - 1];
            let through = [&mut stress[..], &mut velocity[..]];
            let states = [&left, &right].map(|side| side.each_ref().map(|row| &row[..]));
            row.solve(&faces, 2e8, 1, states, through, &mut solved);
            let mut most: f64 = 0.0;
            for i in (0..CELLS - 1).filter(|&i| solved[i] != 0.0) {
                let a = faces.before(at[i][1], gained[i], 1.0, &mut work);
                let b = faces.before(at[i + 1][0], gained[i + 1], -1.0, &mut work);
                let answer = faces.solve(&a, &b, &mut work);
                let off = (answer.stress - stress[i]).abs() / 2e8 + (answer.velocity - velocity[i]).abs() / 5.0;
                most = most.max(off);
                assert!(off < 1e-12, "{flow:?} {i}: {answer:?} {} {}", stress[i], velocity[i]);
            }
            let share = solved.iter().sum::<f64>() / solved.len() as f64;
            println!("{flow:?}: {share} of the faces, {most:e}");
            assert!((0.5..0.98).contains(&share), "{flow:?}: {share}");
        }
    }
}
