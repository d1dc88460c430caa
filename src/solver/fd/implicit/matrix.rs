//! The symmetric tridiagonal matrix of the node update: factored once, solved in every step.
//!
//! The two ends are eliminated last. The 2 x 2 matrix that remains for them gives each end one effective mass; its off-diagonal element is
//! the effect of one end on the other through the whole bar. The nodes between them are eliminated from both sides towards the middle, and
//! each half in two pieces if the far end of the first piece has no effect on the second: four chains of operations that a processor
//! executes in parallel.

/// Fraction of a node's own change below which its effect on another node is far below rounding.
const NEGLIGIBLE: f64 = 1e-20;

/// Values below this, in kg m/s or m/s, are set to zero. Otherwise the tail that every wave sends ahead would end in denormal numbers,
/// which processors handle a hundred times more slowly, and would never vanish.
const FLUSH_THRESHOLD: f64 = 1e-120;

/// Number of nodes between two checks for such tails.
const CHECK_INTERVAL: usize = 64;

/// Smallest length of a piece, as a multiple of the number of nodes ahead of it that affect it; these are processed twice.
const LEAST_PIECES: f64 = 2.0;

/// `A = A^T` over the nodes 0..=n. The nodes between the ends have the factors `W D W^T`. W has ones on its diagonal and one further
/// element per row, to the left of the diagonal up to the middle node and to the right of it beyond.
#[derive(Debug, Clone, Default)]
pub(super) struct Matrix {
    /// Number of nodes - 1.
    cells: usize,
    /// The node at which the eliminations from both sides meet.
    middle: usize,
    /// Elements of W in the rows of the nodes from the left end, and from the right end, up to the middle node, each towards that end; 0
    /// next to it.
    factor: [Vec<f64>; 2],
    /// Reciprocal of the pivot of row j. Unused at 0 and n.
    inverse: Vec<f64>,
    /// Number of nodes of each of the two pieces of a half that are processed in parallel; 0 if the halves are not split.
    piece: usize,
    /// Number of nodes ahead of a piece that affect it.
    ahead: usize,
    /// Whether the matrix is diagonal, so that the nodes are not coupled.
    diagonal: bool,
    /// Elements between the ends and their neighbours.
    off: [f64; 2],
    /// Diagonal of the matrix that remains for the ends, kg.
    own: [f64; 2],
    /// Off-diagonal element of that matrix, kg; 0 if the ends have no effect on each other.
    cross: f64,
    /// Response of the nodes to the left end, from node 1 on, and to the right end, from node n - 1 down, as far as it is not negligible.
    follow: [Vec<f64>; 2],
}

impl Matrix {
    /// Factors the matrix with this diagonal (one entry per node) and these elements between neighbouring nodes (one per cell, at least two
    /// cells). It must be positive definite.
    pub fn new(cells: usize, diagonal: impl Fn(usize) -> f64, between: impl Fn(usize) -> f64) -> Self {
        let middle = cells / 2;
        let mut inverse = vec![0.0; cells + 1];
        // The node at this depth from the left (0) or right (1) end.
        let node = |side: usize, depth: usize| if side == 0 { 1 + depth } else { cells - 1 - depth };
        let factor = [middle - 1, cells - 1 - middle].map(|nodes| vec![0.0; nodes + 1]);
        let mut matrix = Self {
            cells,
            middle,
            factor,
            diagonal: (0..cells).all(|i| between(i) == 0.0),
            off: [between(0), between(cells - 1)],
            ..Self::default()
        };
        let mut middle_pivot = diagonal(middle);
        for (side, factor) in matrix.factor.iter_mut().enumerate() {
            let last = factor.len() - 1;
            for depth in 0..=last {
                let j = node(side, depth);
                let element = if depth > 0 { between(if side == 0 { j - 1 } else { j }) } else { 0.0 };
                let before = if depth > 0 { inverse[node(side, depth - 1)] } else { 0.0 };
                factor[depth] = element * before;
                if depth < last {
                    inverse[j] = 1.0 / (diagonal(j) - element * factor[depth]);
                } else {
                    middle_pivot -= element * factor[depth];
                }
            }
        }
        inverse[middle] = 1.0 / middle_pivot;
        matrix.inverse = inverse;
        matrix.cut_halves();
        matrix.eliminate_ends([diagonal(0), diagonal(cells)]);
        matrix
    }

    /// Splits both halves in two if few nodes ahead of a place affect it.
    fn cut_halves(&mut self) {
        let piece = (self.middle - 1) / 2;
        let largest = self.factor.iter().flatten().fold(0.0, |largest: f64, factor| largest.max(factor.abs()));
        let ahead = (NEGLIGIBLE.ln() / largest.min(1.0).ln()).abs().ceil();
        if ahead * LEAST_PIECES <= piece as f64 {
            (self.piece, self.ahead) = (piece, ahead as usize);
        }
    }

    /// Computes the effective masses of the ends, their coupling, and the response of the other nodes to them.
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
            let extent = inner.iter().position(|f| f.abs() < NEGLIGIBLE).unwrap_or(inner.len());
            inner[..extent].to_vec()
        });
    }

    /// Solves for the nodes between the ends, with both ends at 0; `x` holds the right-hand sides, which are replaced by the solution.
    pub fn solve(&self, x: &mut [f64]) {
        let n = self.cells;
        if self.diagonal {
            x[1..n].iter_mut().zip(&self.inverse[1..n]).for_each(|(x, inverse)| *x *= inverse);
            return;
        }
        self.eliminate(x);
        self.substitute(x);
    }

    /// Eliminates the nodes from both ends to the middle node, and solves for the latter.
    #[inline(always)]
    fn eliminate(&self, x: &mut [f64]) {
        let [factor_left, factor_right] = &self.factor;
        let (x_left, x_middle, x_right) = self.halves(x);
        let (both, nodes) = (x_left.len(), x_right.len());
        let [mut left, mut right] = self.eliminate_pieces(x_left, x_right);
        for start in (2 * self.piece..both).step_by(CHECK_INTERVAL) {
            for k in start..(start + CHECK_INTERVAL).min(both) {
                left = x_left[k] - factor_left[k] * left;
                right = x_right[nodes - 1 - k] - factor_right[k] * right;
                (x_left[k], x_right[nodes - 1 - k]) = (left, right);
            }
            [left, right] = [left, right].map(flush_to_zero);
        }
        // With an odd number of cells there is one more node on the right.
        for k in both..nodes {
            right = x_right[nodes - 1 - k] - factor_right[k] * right;
            x_right[nodes - 1 - k] = right;
        }
        *x_middle = (*x_middle - factor_left[both] * left - factor_right[nodes] * right) * self.inverse[self.middle];
    }

    /// Eliminates the pieces of both halves, starting from the ends. Returns the last values.
    #[inline(always)]
    fn eliminate_pieces(&self, x_left: &mut [f64], x_right: &mut [f64]) -> [f64; 2] {
        let (piece, [factor_left, factor_right]) = (self.piece, &self.factor);
        let nodes = x_right.len();
        let [mut a, mut b, mut c, mut d] = [0.0; 4];
        for k in piece - self.ahead..piece {
            b = x_left[k] - factor_left[k] * b;
            d = x_right[nodes - 1 - k] - factor_right[k] * d;
        }
        let (beside_a, beside_b) = (&factor_left[..piece], &factor_left[piece..2 * piece]);
        let (beside_c, beside_d) = (&factor_right[..piece], &factor_right[piece..2 * piece]);
        let (x_a, x_b) = x_left[..2 * piece].split_at_mut(piece);
        let (x_d, x_c) = x_right[nodes - 2 * piece..].split_at_mut(piece);
        for start in (0..piece).step_by(CHECK_INTERVAL) {
            for k in start..(start + CHECK_INTERVAL).min(piece) {
                let back = piece - 1 - k;
                a = x_a[k] - beside_a[k] * a;
                b = x_b[k] - beside_b[k] * b;
                c = x_c[back] - beside_c[k] * c;
                d = x_d[back] - beside_d[k] * d;
                (x_a[k], x_b[k], x_c[back], x_d[back]) = (a, b, c, d);
            }
            [a, b, c, d] = [a, b, c, d].map(flush_to_zero);
        }
        [b, d]
    }

    /// Substitutes back, from the middle outwards: the element of W beside a node is in the row of its neighbour.
    #[inline(always)]
    fn substitute(&self, x: &mut [f64]) {
        let (middle, [factor_left, factor_right]) = (self.middle, &self.factor);
        let (inverse_left, inverse_right) = (&self.inverse[1..middle], &self.inverse[middle + 1..self.cells]);
        let (x_left, x_middle, x_right) = self.halves(x);
        let (both, nodes) = (x_left.len(), x_right.len());
        let [mut left, mut right] = self.substitute_pieces(x_left, *x_middle, x_right);
        for start in (2 * self.piece..both).step_by(CHECK_INTERVAL) {
            for k in start..(start + CHECK_INTERVAL).min(both) {
                let i = both - 1 - k;
                left = x_left[i] * inverse_left[i] - factor_left[i + 1] * left;
                right = x_right[k] * inverse_right[k] - factor_right[nodes - k] * right;
                (x_left[i], x_right[k]) = (left, right);
            }
            [left, right] = [left, right].map(flush_to_zero);
        }
        for k in both..nodes {
            right = x_right[k] * inverse_right[k] - factor_right[nodes - k] * right;
            x_right[k] = right;
        }
    }

    /// Substitutes back in the pieces of both halves, starting from the middle. Returns the last values.
    #[inline(always)]
    fn substitute_pieces(&self, x_left: &mut [f64], middle: f64, x_right: &mut [f64]) -> [f64; 2] {
        let (piece, [factor_left, factor_right]) = (self.piece, &self.factor);
        let (inverse_left, inverse_right) = (&self.inverse[1..self.middle], &self.inverse[self.middle + 1..self.cells]);
        let (both, nodes) = (x_left.len(), x_right.len());
        let [mut a, mut b, mut c, mut d] = [middle, 0.0, middle, 0.0];
        for k in piece - self.ahead..piece {
            let i = both - 1 - k;
            b = x_left[i] * inverse_left[i] - factor_left[i + 1] * b;
            d = x_right[k] * inverse_right[k] - factor_right[nodes - k] * d;
        }
        // Slices of equal length, so that no index needs a bounds check.
        let ([far, near], first) = ([both - 2 * piece, both - piece], nodes - 2 * piece);
        let (inverse_a, inverse_b) = (&inverse_left[near..near + piece], &inverse_left[far..far + piece]);
        let (inverse_c, inverse_d) = (&inverse_right[..piece], &inverse_right[piece..2 * piece]);
        let (beside_a, beside_b) = (&factor_left[near + 1..][..piece], &factor_left[far + 1..][..piece]);
        let (beside_c, beside_d) = (&factor_right[first + piece + 1..][..piece], &factor_right[first + 1..][..piece]);
        let (x_b, x_a) = x_left[far..].split_at_mut(piece);
        let (x_c, x_d) = x_right[..2 * piece].split_at_mut(piece);
        for start in (0..piece).step_by(CHECK_INTERVAL) {
            for k in start..(start + CHECK_INTERVAL).min(piece) {
                let back = piece - 1 - k;
                a = x_a[back] * inverse_a[back] - beside_a[back] * a;
                b = x_b[back] * inverse_b[back] - beside_b[back] * b;
                c = x_c[k] * inverse_c[k] - beside_c[back] * c;
                d = x_d[k] * inverse_d[k] - beside_d[back] * d;
                (x_a[back], x_b[back], x_c[k], x_d[k]) = (a, b, c, d);
            }
            [a, b, c, d] = [a, b, c, d].map(flush_to_zero);
        }
        if piece > 0 { [b, d] } else { [middle; 2] }
    }

    /// Returns the nodes left of the middle one, the middle one, and those right of it, without the ends.
    #[inline(always)]
    fn halves<'a>(&self, x: &'a mut [f64]) -> (&'a mut [f64], &'a mut f64, &'a mut [f64]) {
        let (left, rest) = x[1..self.cells].split_at_mut(self.middle - 1);
        let (middle, right) = rest.split_first_mut().expect("at least two cells");
        (left, middle, right)
    }

    /// Returns what the nodes between the ends leave of the right-hand sides of the two ends; `x` is their solution with both ends at 0.
    pub fn left_for_ends(&self, right_sides: [f64; 2], x: &[f64]) -> [f64; 2] {
        [right_sides[0] - self.off[0] * x[1], right_sides[1] - self.off[1] * x[self.cells - 1]]
    }

    /// Adds the response of the nodes between the ends to the ends' own changes.
    pub fn follow_ends(&self, ends: [f64; 2], x: &mut [f64]) {
        let inner = &mut x[1..self.cells];
        for (x, follow) in inner.iter_mut().zip(&self.follow[0]) {
            *x -= ends[0] * follow;
        }
        for (x, follow) in inner.iter_mut().rev().zip(&self.follow[1]) {
            *x -= ends[1] * follow;
        }
    }

    /// Returns the effective masses of the ends, kg.
    pub fn end_masses(&self) -> [f64; 2] {
        self.own
    }

    /// Returns the direct coupling between the ends, kg.
    pub fn cross(&self) -> f64 {
        self.cross
    }

    /// Returns the number of stored floating-point numbers.
    pub fn len(&self) -> usize {
        self.factor[0].len() + self.factor[1].len() + self.inverse.len() + self.follow[0].len() + self.follow[1].len()
    }
}

fn flush_to_zero(x: f64) -> f64 {
    if x.abs() < FLUSH_THRESHOLD { 0.0 } else { x }
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
        for cells in [2, 3, 4, 17, 200, 1000, 1001, 1003] {
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
    fn halves_are_cut_where_nodes_far_away_are_not_felt() {
        let matrix = |cells: usize, stiffness: f64| Matrix::new(cells, |_| 1.0 + 2.0 * stiffness, |_| -stiffness);
        assert_eq!(matrix(1001, 0.3).piece, 249);
        assert_eq!([matrix(100, 0.3).piece, matrix(1001, 1e3).piece], [0, 0]);
    }

    #[test]
    fn ends_of_a_long_bar_know_nothing_of_each_other() {
        let matrix = Matrix::new(1000, |_| 1.5, |_| -0.25);
        assert_eq!(matrix.cross(), 0.0);
        assert!(matrix.follow[0].len() < 40 && matrix.follow[1].len() < 40);
    }
}
