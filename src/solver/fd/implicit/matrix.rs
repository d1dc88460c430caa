//! The symmetric tridiagonal matrix of the node update: factored once, solved in every step.
//!
//! The two ends are eliminated last. What is left for them is a matrix of two rows, so that a device sees one effective
//! mass; it is the effect of one end on the other, through the whole bar, that its off-diagonal holds. The nodes between
//! them are eliminated from both sides towards the middle: two chains of operations that a processor runs side by side.

/// Below this part of an end's own change its effect on another node is far below rounding.
const NEGLIGIBLE: f64 = 1e-20;

/// Changes below this, in kg m/s or m/s, are none. Otherwise the tail that every wave sends ahead would end in numbers
/// that processors handle a hundred times slower, and go on for ever as the smallest of them.
const NOTHING: f64 = 1e-120;

/// Nodes between two looks for such tails.
const LOOK: usize = 64;

/// `A = A^T` over the nodes 0..=n; the nodes between the ends in the factors `W D W^T`, W with ones on its diagonal, and
/// beside it left of it up to the middle node, right of it beyond.
#[derive(Debug, Clone, Default)]
pub(super) struct Matrix {
    /// Nodes - 1.
    cells: usize,
    /// The node at which the eliminations from both sides meet.
    middle: usize,
    /// Element of W in the row of node j, towards the end from which it is reached; at the middle node that to its left,
    /// 0 next to the ends, and unused at them.
    beside: Vec<f64>,
    /// That of the middle node to its right.
    middle_right: f64,
    /// 1 over the pivot of row j. Unused at 0 and n.
    inverse: Vec<f64>,
    /// Each node stands for itself.
    diagonal: bool,
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
        let middle = cells / 2;
        let (mut beside, mut inverse) = (vec![0.0; cells + 1], vec![0.0; cells + 1]);
        for j in 1..middle {
            let element = if j > 1 { between(j - 1) } else { 0.0 };
            beside[j] = element * inverse[j - 1];
            inverse[j] = 1.0 / (diagonal(j) - element * beside[j]);
        }
        for j in (middle + 1..cells).rev() {
            let element = if j + 1 < cells { between(j) } else { 0.0 };
            beside[j] = element * inverse[j + 1];
            inverse[j] = 1.0 / (diagonal(j) - element * beside[j]);
        }
        let left = if middle > 1 { between(middle - 1) } else { 0.0 };
        let right = if middle + 1 < cells { between(middle) } else { 0.0 };
        beside[middle] = left * inverse[middle - 1];
        let middle_right = right * inverse[middle + 1];
        inverse[middle] = 1.0 / (diagonal(middle) - left * beside[middle] - right * middle_right);
        let off = [between(0), between(cells - 1)];
        let follow = [Vec::new(), Vec::new()];
        let diagonal_alone = (0..cells).all(|i| between(i) == 0.0);
        let mut matrix = Self {
            cells,
            middle,
            beside,
            middle_right,
            inverse,
            diagonal: diagonal_alone,
            off,
            own: [0.0; 2],
            cross: 0.0,
            follow,
        };
        matrix.eliminate_ends([diagonal(0), diagonal(cells)]);
        matrix
    }

    /// What the ends keep of their diagonal, and how the other nodes follow them.
    fn eliminate_ends(&mut self, diagonal: [f64; 2]) {
        let (n, off) = (self.cells, self.off);
        let [mut left, mut right] = [(1, off[0]), (n - 1, off[1])].map(|(node, element)| {
            let mut x = vec![0.0; n + 1];
            x[node] = element;
            self.solve(&mut x);
            x
        });
        self.own = [diagonal[0] - off[0] * left[1], diagonal[1] - off[1] * right[n - 1]];
        let cross = -off[1] * left[n - 1];
        self.cross = if cross.abs() < NEGLIGIBLE * self.own[0].min(self.own[1]) { 0.0 } else { cross };
        right.reverse();
        self.follow = [&mut left, &mut right].map(|x| {
            let inner = &x[1..n];
            let reach = inner.iter().position(|f| f.abs() < NEGLIGIBLE).unwrap_or(inner.len());
            inner[..reach].to_vec()
        });
    }

    /// Solves for the nodes between the ends, both ends at 0; `x` holds the right sides, and then the solution.
    pub fn solve(&self, x: &mut [f64]) {
        let n = self.cells;
        if self.diagonal {
            x[1..n].iter_mut().zip(&self.inverse[1..n]).for_each(|(x, inverse)| *x *= inverse);
            return;
        }
        self.eliminate(x);
        self.substitute(x);
    }

    /// From both ends to the middle node, which is solved for.
    #[inline(always)]
    fn eliminate(&self, x: &mut [f64]) {
        let (n, middle) = (self.cells, self.middle);
        let (beside, x) = (&self.beside[..=n], &mut x[..=n]);
        let both = middle - 1;
        let (mut left, mut right) = (0.0, 0.0);
        for start in (0..both).step_by(LOOK) {
            for k in start..(start + LOOK).min(both) {
                let (i, j) = (1 + k, n - 1 - k);
                left = x[i] - beside[i] * left;
                right = x[j] - beside[j] * right;
                (x[i], x[j]) = (left, right);
            }
            (left, right) = (something(left), something(right));
        }
        // With an odd number of cells there is one node more on the right.
        for j in (middle + 1..n - both).rev() {
            right = x[j] - beside[j] * right;
            x[j] = right;
        }
        x[middle] = (x[middle] - beside[middle] * left - self.middle_right * right) * self.inverse[middle];
    }

    /// Back, outwards: what is beside a node stands in the row of its neighbour.
    #[inline(always)]
    fn substitute(&self, x: &mut [f64]) {
        let (n, middle) = (self.cells, self.middle);
        let (beside, inverse, x) = (&self.beside[..=n], &self.inverse[..=n], &mut x[..=n]);
        let both = middle - 1;
        let (mut element_left, mut element_right) = (beside[middle], self.middle_right);
        let (mut left, mut right) = (x[middle], x[middle]);
        for j in middle + 1..n - both {
            right = x[j] * inverse[j] - element_right * right;
            element_right = beside[j];
            x[j] = right;
        }
        for start in (0..both).step_by(LOOK) {
            for k in start..(start + LOOK).min(both) {
                let (i, j) = (middle - 1 - k, n - both + k);
                left = x[i] * inverse[i] - element_left * left;
                right = x[j] * inverse[j] - element_right * right;
                (element_left, element_right) = (beside[i], beside[j]);
                (x[i], x[j]) = (left, right);
            }
            (left, right) = (something(left), something(right));
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
        self.beside.len() + self.inverse.len() + self.follow[0].len() + self.follow[1].len()
    }
}

fn something(x: f64) -> f64 {
    if x.abs() < NOTHING { 0.0 } else { x }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Solves with the ends free to move: no force but the right sides.
    fn solve(matrix: &Matrix, right_side: &[f64]) -> Vec<f64> {
        let n = right_side.len() - 1;
        let mut x = right_side.to_vec();
        matrix.solve(&mut x);
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
