//! Limited slopes.

/// The slope over a cell, as a difference, from those to its left and right: their harmonic mean, and nothing where they
/// differ in sign (van Leer 1974). Values at the faces then lie between those of the neighbours.
///
/// Steeper limiters sharpen fronts but ring where a sudden load splits into an elastic and a plastic front: with that of
/// twice the lesser slope the plateau of the bilinear benchmark is off by 1e-3 (1000 cells), with this one by 1e-6. The
/// lesser slope itself (minmod) makes plastic fronts half as wide again.
#[inline(always)]
pub fn limited(left: f64, right: f64) -> f64 {
    let product = left * right;
    let slope = 2.0 * product / (left + right);
    if product > 0.0 { slope } else { 0.0 }
}

/// How many times the lesser difference a steep slope may be. From 1.5 on a jump that is carried along stays within a few
/// cells for ever, with 2 within the fewest; but fronts then leave ripples of 5e-5 in the bilinear benchmark (1000
/// cells), with this less than 3e-5.
const STEEP: f64 = 1.6;

/// A steep slope without new extrema: the greater difference, or [`STEEP`] times the lesser one if that is less (Sweby
/// 1984). It makes steps of smooth waves, too: for fronts only.
#[inline(always)]
pub fn steep(left: f64, right: f64) -> f64 {
    if left * right <= 0.0 {
        return 0.0;
    }
    let (lesser, greater) = if left.abs() < right.abs() { (left, right) } else { (right, left) };
    if STEEP * lesser.abs() < greater.abs() { STEEP * lesser } else { greater }
}
