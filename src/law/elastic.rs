//! Hooke's law, d sigma = E d eps: the kernel of every row of cells that has not yielded.

use multiversion::multiversion;

use super::LANES;

/// One elastic step of a row: `sigma += gain * (v[i+1] - v[i])`. Returns the largest |stress| afterwards, Pa;
/// NaN stresses make it NaN or leave it unchanged, never smaller.
///
/// `v` has one entry more than `sigma`; `gain` is E dt/dx, Pa s/m.
#[multiversion(targets("x86_64+avx512f+avx512dq+avx512vl+avx512bw", "x86_64+avx2"))]
pub fn elastic_row(gain: f64, v: &[f64], sigma: &mut [f64]) -> f64 {
    let cells = sigma.len();
    let (left, right) = (&v[..cells], &v[1..=cells]);
    let whole = cells - cells % LANES;
    let mut peak = [0.0_f64; LANES];
    for start in (0..whole).step_by(LANES) {
        let s = &mut sigma[start..start + LANES];
        let (l, r) = (&left[start..start + LANES], &right[start..start + LANES]);
        for lane in 0..LANES {
            s[lane] += gain * (r[lane] - l[lane]);
            let size = s[lane].abs();
            peak[lane] = if size > peak[lane] { size } else { peak[lane] };
        }
    }
    for i in whole..cells {
        sigma[i] += gain * (right[i] - left[i]);
        peak[0] = peak[0].max(sigma[i].abs());
    }
    peak.iter().fold(0.0, |m, &p| m.max(p))
}
