//! The symmetric tridiagonal matrix of the node update: factored once, solved in every step.
//!
//! The two ends are eliminated last. What is left for them is a matrix of two rows, so that a device sees one effective
//! mass; it is the effect of one end on the other, through the whole bar, that its off-diagonal holds.

/// Below this part of an end's own change its effect on another node is far below rounding.
const NEGLIGIBLE: f64 = 1e-20;

/// `A = A^T` over the nodes 0..=n, in the factors `L D L^T` of the nodes between the ends.
#[derive(Debug, Clone)]
pub(super) struct Matrix {
    /// Nodes - 1.
    cells: usize,
    /// Row j of L: its element left of the diagonal. 0 at 0, 1 and n.
    lower: Vec<f64>,
    /// 1 over the pivot of row j. Unused at 0 and n.
    inverse: Vec<f64>,
    /// Elements between the ends and their neighbours.
    off: [f64; 2],
    /// Diagonal of what is left for the ends, kg.
    own: [f64; 2],
    /// Its off-diagonal, kg; 0 where the ends know nothing of each other.
    cross: f64,
    /// How far the nodes follow the left end, from node 1 on, and the right end, from node n - 1 down; as long as it is
    /// not negligible.
    follow: [Vec<f64>; 2],
}

impl Matrix {
    /// From its diagonal (one entry a node) and the elements between neighbouring nodes (one a cell, at least two cells).
    /// It must be positive definite.
    pub fn new(cells: usize, diagonal: impl Fn(usize) -> f64, between: impl Fn(usize) -> f64) -> Self {
        let (mut lower, mut inverse) = (vec![0.0; cells + 1], vec![0.0; cells + 1]);
        inverse[1] = 1.0 / diagonal(1);
        for j in 2..cells {
            let element = between(j - 1);
            lower[j] = element * inverse[j - 1];
            inverse[j] = 1.0 / (diagonal(j) - element * lower[j]);
        }
        let off = [between(0), between(cells - 1)];
        let mut matrix =
            Self { cells, lower, inverse, off, own: [0.0; 2], cross: 0.0, follow: [Vec::new(), Vec::new()] };
        let [mut left, mut right] = [matrix.unit(1, off[0]), matrix.unit(cells - 1, off[1])];
        matrix.own = [diagonal(0) - off[0] * left[1], diagonal(cells) - off[1] * right[cells - 1]];
        let cross = -off[1] * left[cells - 1];
        matrix.cross = if cross.abs() < NEGLIGIBLE * matrix.own[0].min(matrix.own[1]) { 0.0 } else { cross };
        left.truncate(cells);
        left.remove(0);
        right.truncate(cells);
        right.remove(0);
        right.reverse();
        matrix.follow = [left, right].map(|mut follow| {
            let reach = follow.iter().position(|f| f.abs() < NEGLIGIBLE).unwrap_or(follow.len());
            follow.truncate(reach);
            follow.shrink_to_fit();
            follow
        });
        matrix
    }

    /// The solution between the ends for a right side of one value at one node.
    fn unit(&self, node: usize, value: f64) -> Vec<f64> {
        let mut x = vec![0.0; self.cells + 1];
        x[node] = value;
        for j in node + 1..self.cells {
            x[j] = -self.lower[j] * x[j - 1];
        }
        self.back(&mut x);
        x
    }

    /// Forward step of node `j` between the ends: from its right side and the neighbour's result.
    #[inline(always)]
    pub fn forward(&self, j: usize, right_side: f64, before: f64) -> f64 {
        right_side - self.lower[j] * before
    }

    /// The backward steps of all nodes between the ends, both ends at 0.
    pub fn back(&self, x: &mut [f64]) {
        let n = self.cells;
        let (lower, inverse, x) = (&self.lower[1..=n], &self.inverse[1..n], &mut x[1..n]);
        let mut after = 0.0;
        for j in (0..x.len()).rev() {
            after = x[j] * inverse[j] - lower[j + 1] * after;
            x[j] = after;
        }
    }

    /// What the nodes between the ends leave of the right sides of the two ends; `x` is their solution with both ends at 0.
    pub fn left_for_ends(&self, right_sides: [f64; 2], x: &[f64]) -> [f64; 2] {
        [right_sides[0] - self.off[0] * x[1], right_sides[1] - self.off[1] * x[self.cells - 1]]
    }

    /// Adds what the ends' own changes make of the nodes between them.
    pub fn follow_ends(&self, ends: [f64; 2], x: &mut [f64]) {
        let inner = &mut x[1..self.cells];
        for (x, follow) in inner.iter_mut().zip(&self.follow[0]) {
            *x -= ends[0] * follow;
        }
        for (x, follow) in inner.iter_mut().rev().zip(&self.follow[1]) {
            *x -= ends[1] * follow;
        }
    }

    /// Effective masses of the ends, kg.
    pub fn end_masses(&self) -> [f64; 2] {
        self.own
    }

    /// What couples the ends directly, kg.
    pub fn cross(&self) -> f64 {
        self.cross
    }

    /// Numbers in memory.
    pub fn len(&self) -> usize {
        self.lower.len() + self.inverse.len() + self.follow[0].len() + self.follow[1].len()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Solves with the ends free to move: no force but the right sides.
    fn solve(matrix: &Matrix, right_side: &[f64]) -> Vec<f64> {
        let n = right_side.len() - 1;
        let mut x = right_side.to_vec();
        for j in 2..n {
            x[j] = matrix.forward(j, x[j], x[j - 1]);
        }
        matrix.back(&mut x);
        let [a, b] = matrix.left_for_ends([right_side[0], right_side[n]], &x);
        let ([p, q], c) = (matrix.end_masses(), matrix.cross());
        let ends = [(q * a - c * b) / (p * q - c * c), (p * b - c * a) / (p * q - c * c)];
        matrix.follow_ends(ends, &mut x);
        [x[0], x[n]] = ends;
        x
    }

    #[test]
    fn the_matrix_times_the_solution_is_the_right_side() {
        for cells in [2, 3, 4, 17, 200] {
            for stiffness in [0.0, 0.3, 1e3, 1e8] {
                let diagonal = |j: usize| {
                    let neighbours = if j == 0 || j == cells { 1.0 } else { 2.0 };
                    1.0 + 0.1 * (j as f64).sin() + neighbours * stiffness
                };
                let matrix = Matrix::new(cells, diagonal, |_| -stiffness);
                let right_side: Vec<f64> = (0..=cells).map(|j| (0.7 * j as f64 + 0.2).cos()).collect();
                let x = solve(&matrix, &right_side);
                let largest = x.iter().fold(1.0, |m: f64, x| m.max(x.abs()));
                for j in 0..=cells {
                    let left = if j > 0 { -stiffness * x[j - 1] } else { 0.0 };
                    let right = if j < cells { -stiffness * x[j + 1] } else { 0.0 };
                    let missing = diagonal(j) * x[j] + left + right - right_side[j];
                    // Rounding of sums of terms of this size.
                    let scale = diagonal(j) * largest;
                    assert!(missing.abs() < 1e-14 * scale, "{cells} cells, {stiffness}: row {j} misses {missing:e}");
                }
            }
        }
    }

    #[test]
    fn ends_of_a_long_bar_know_nothing_of_each_other() {
        let matrix = Matrix::new(1000, |_| 1.5, |_| -0.25);
        assert_eq!(matrix.cross(), 0.0);
        assert!(matrix.follow[0].len() < 40 && matrix.follow[1].len() < 40);
    }
}
