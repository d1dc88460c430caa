//! The stress of joints on a grid, from those of the cells beside them.

use crate::bar::Bar;
use crate::record::Trace;
use crate::solver::fd::Grid;

/// Joints that are read in the cells to their left and right.
///
/// At a joint the force is `F = (F_l m_r + F_r m_l)/(m_l + m_r)`, that between the halves of the node there: `F_l` and `F_r` are the forces of
/// the cells beside it, `m_l` and `m_r` their masses.
pub(super) struct JointRows {
    /// Centres of both cells, m.
    places: Vec<[f64; 2]>,
    /// Of their stresses in the stress of the joint, on the section to its left.
    weights: Vec<[f64; 2]>,
}

impl JointRows {
    /// Of the joints at these places, m, of a bar.
    pub fn new(bar: &Bar, grid: &Grid, joints: impl Iterator<Item = f64>) -> Self {
        let distance = |k: usize, x: f64| (grid.segments[k].x0 - x).abs();
        let right = |x: f64| (1..grid.segments.len()).min_by(|&a, &b| distance(a, x).total_cmp(&distance(b, x)));
        let (places, weights) = joints.filter_map(right).map(|k| beside(bar, grid, k)).unzip();
        Self { places, weights }
    }

    /// Where the stress is read, m: the cells to the left and to the right of each joint in turn.
    pub fn places(&self) -> impl Iterator<Item = f64> {
        self.places.iter().flatten().copied()
    }

    /// Makes one history of the two of each joint, which are the last of these.
    pub fn join(&self, histories: &mut Vec<Trace>) {
        let beside = histories.split_off(histories.len() - 2 * self.places.len());
        let mut beside = beside.into_iter();
        for [of_left, of_right] in &self.weights {
            let (Some(mut left), Some(right)) = (beside.next(), beside.next()) else { return };
            for (stress, right) in left.stress.iter_mut().zip(right.stress) {
                *stress = of_left * *stress + of_right * right;
            }
            histories.push(left);
        }
    }
}

/// The places and weights of the joint to the left of segment `k`.
fn beside(bar: &Bar, grid: &Grid, k: usize) -> ([f64; 2], [f64; 2]) {
    let ([left, right], [a, b]) =
        ([&bar.segments[k - 1], &bar.segments[k]], [&grid.segments[k - 1], &grid.segments[k]]);
    let ([_, left_area], [right_area, _]) = (left.end_areas(), right.end_areas());
    let [left_mass, right_mass] =
        [left.material.density * left_area * a.dx, right.material.density * right_area * b.dx];
    let both = left_mass + right_mass;
    let places = [b.x0 - 0.5 * a.spacing, b.x0 + 0.5 * b.spacing];
    (places, [right_mass / both, right_area / left_area * left_mass / both])
}
