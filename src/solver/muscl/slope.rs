//! Limited slopes.

/// The slope over a cell, as a difference, from those to its left and right: their mean, but no more than twice the lesser
/// and nothing where they differ in sign (monotonized central, van Leer 1977). Values at the faces then lie between
/// those of the neighbours.
#[inline(always)]
pub fn limited(left: f64, right: f64) -> f64 {
    let (a, b) = (left.abs(), right.abs());
    let lesser = if a < b { a } else { b };
    let mean = 0.5 * (left + right);
    let most = if left * right > 0.0 { 2.0 * lesser } else { 0.0 };
    let size = mean.abs();
    (if size < most { size } else { most }).copysign(mean)
}
