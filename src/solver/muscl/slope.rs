//! Limited slopes, and limited stresses at faces.

/// Returns the slope over a cell, as a difference, from the differences to its left and right: their harmonic mean, or 0 if they differ in sign (van
/// Leer 1974). Values at the faces then lie between those of the neighbours.
///
/// Steeper limiters sharpen fronts but ring where a sudden load splits into an elastic and a plastic front: in the bilinear benchmark with 1000 cells
/// the plateau is off by 1e-3 with twice the smaller difference, and by 1e-6 with this limiter. The smaller difference itself (minmod) makes plastic
/// fronts 1.5 times as wide.
#[inline(always)]
pub fn limited(left: f64, right: f64) -> f64 {
    let product = left * right;
    let slope = 2.0 * product / (left + right);
    if product > 0.0 { slope } else { 0.0 }
}

/// Largest ratio of a steep slope to the smaller difference. From 1.5 on, an advected jump stays within a few cells for ever, with 2 within the
/// fewest; but fronts then leave ripples of 5e-5 in the bilinear benchmark (1000 cells), and of less than 3e-5 with this value.
const STEEP: f64 = 1.6;

/// Returns a steep slope without new extrema: the larger difference, limited to [`STEEP`] times the smaller one (Sweby 1984). It turns smooth waves
/// into steps, so that it is for fronts only.
#[inline(always)]
pub fn steep(left: f64, right: f64) -> f64 {
    if left * right <= 0.0 {
        return 0.0;
    }
    let (lesser, greater) = if left.abs() < right.abs() { (left, right) } else { (right, left) };
    if STEEP * lesser.abs() < greater.abs() { STEEP * lesser } else { greater }
}

/// Returns the largest stress allowed at the faces of the flowing cell `i`, in the sense in which it flows: its own stress `ahead` after half a step,
/// or that of a neighbour. Towards a level stretch the wave speed tends to zero, and half a step plus half a slope may exceed every stress that the
/// curve can carry; the velocity for such a stress would be a thousand times that of the bar.
#[inline]
pub fn cap(ahead: f64, sigma: &[f64], i: usize) -> f64 {
    let largest = |a: f64, b: f64| if ahead < 0.0 { a.min(b) } else { a.max(b) };
    sigma[i - 1..=i + 1].iter().copied().fold(ahead, largest)
}

/// Limits the magnitude of a stress to `cap`, which has the sense of flow.
#[inline]
pub fn capped(stress: f64, cap: f64) -> f64 {
    if cap < 0.0 { stress.max(cap) } else { stress.min(cap) }
}
