//! Hooke's law, d sigma = E d eps: the kernel for rows of cells that have not yielded.

use multiversion::multiversion;

/// Advances a row by one elastic step, `sigma += gain * (v[i+1] - v[i])`. Returns the largest |stress| afterwards, Pa;
/// NaN if a stress is NaN.
///
/// `v` has one entry more than `sigma`; `gain` is E dt/dx, Pa s/m.
#[multiversion(targets("x86_64+avx512f+avx512dq+avx512vl+avx512bw", "x86_64+avx2"))]
pub fn elastic_row(gain: f64, v: &[f64], sigma: &mut [f64]) -> f64 {
    let cells = sigma.len();
    let (left, right) = (&v[..cells], &v[1..=cells]);
    // Magnitudes are compared by their bits, for which compilers generate faster loops; the bits of NaN compare larger than any number.
    let mut peak = 0;
    for i in 0..cells {
        sigma[i] += gain * (right[i] - left[i]);
        peak = peak.max(sigma[i].to_bits() & !(1 << 63));
    }
    f64::from_bits(peak)
}
