//! Limited slopes, and limited stresses at faces.

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

/// The largest stress at the faces of flowing cell `i`, in the sense in which it flows: its own, `ahead` by half a step, or a
/// neighbour's. Towards a level stretch the wave speed tends to zero, and half a step and half a slope together may exceed all
/// stress that the curve can carry: the velocity that goes with such a stress is a thousand times that of the bar.
#[inline]
pub fn cap(ahead: f64, sigma: &[f64], i: usize) -> f64 {
    let largest = |a: f64, b: f64| if ahead < 0.0 { a.min(b) } else { a.max(b) };
    sigma[i - 1..=i + 1].iter().copied().fold(ahead, largest)
}

/// A stress no larger than that.
#[inline]
pub fn capped(stress: f64, cap: f64) -> f64 {
    if cap < 0.0 { stress.max(cap) } else { stress.min(cap) }
}
