//! Stress of joints on a grid, computed from the stresses of the adjacent cells.

use super::Trace;
use crate::bar::Bar;
use crate::solver::fd::Grid;

/// Histories of joints, read in the cells to their left and right. The force of the joint is the smaller of the two
/// forces, and 0 if they have opposite signs. A wave that has reached one of the cells has not yet passed the joint,
/// and where one of the cells yields, the other first responds as if it did not: between a soft and a hard bar the mean
/// of both was 17.0 kN instead of 8.7 kN, at any resolution.
#[derive(Debug)]
pub struct JointRows {
    /// Centres of the two adjacent cells, m.
    places: Vec<[f64; 2]>,
    /// Ratio of the cross-section on the right of each joint to that on its left. The stress of a joint refers to the section on its left.
    sections: Vec<f64>,
}

impl JointRows {
    /// Creates the histories of the joints on the right of the given segments of a bar.
    pub fn new(bar: &Bar, grid: &Grid, joints: &[usize]) -> Self {
        let (places, sections) = joints.iter().map(|k| beside(bar, grid, k + 1)).unzip();
        Self { places, sections }
    }

    /// Returns the places where the stress is read, m: for each joint in turn, the cells to its left and to its right.
    pub fn places(&self) -> impl Iterator<Item = f64> {
        self.places.iter().flatten().copied()
    }

    /// Replaces the two histories of each joint, which are the last ones of `histories`, by one.
    pub fn join(&self, histories: &mut Vec<Trace>) {
        let beside = histories.split_off(histories.len() - 2 * self.places.len());
        let mut beside = beside.into_iter();
        for sections in &self.sections {
            let (Some(mut left), Some(right)) = (beside.next(), beside.next()) else { return };
            for (stress, right) in left.stress.iter_mut().zip(right.stress) {
                *stress = transmitted_stress(*stress, sections * right);
            }
            histories.push(left);
        }
    }
}

/// Returns the centres of the cells at the joint to the left of segment `k`, m, and the ratio of the cross-section on its right to that on its left.
fn beside(bar: &Bar, grid: &Grid, k: usize) -> ([f64; 2], f64) {
    let [a, b] = [&grid.segments[k - 1], &grid.segments[k]];
    let [left, right] = [bar.segments[k - 1].end_areas()[1], bar.segments[k].end_areas()[0]];
    ([b.x0 - 0.5 * a.spacing, b.x0 + 0.5 * b.spacing], right / left)
}

/// Returns the stress that a joint transmits, given the stresses on its two sides: the one of smaller magnitude, or 0 if they have opposite signs.
fn transmitted_stress(a: f64, b: f64) -> f64 {
    if a * b > 0.0 { a.signum() * a.abs().min(b.abs()) } else { 0.0 }
}
