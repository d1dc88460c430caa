//! The steps to which the values of a record are rounded.

/// Returns the step to which stresses are rounded, Pa: their smallest difference (infinite if all are equal) if at least a quarter of them equal
/// the previous one; otherwise 0.
pub fn stress_step(stresses: impl Iterator<Item = f64>) -> f64 {
    let mut stresses: Vec<f64> = stresses.collect();
    let repeated = stresses.windows(2).filter(|pair| pair[0] == pair[1]).count();
    if 4 * repeated < stresses.len() {
        return 0.0;
    }
    stresses.sort_by(f64::total_cmp);
    let least = 1e-9 * stresses.last().map_or(0.0, |s| s.abs());
    stresses.windows(2).map(|pair| pair[1] - pair[0]).filter(|step| *step > least).fold(f64::INFINITY, f64::min)
}

/// Difference between two spacings, relative to the largest strain, that is neglected: instruments store seven digits.
const SAME: f64 = 3e-7;

/// Returns the step to which strains are rounded: the smallest difference between a spacing and its two neighbours, which are equal, if all
/// spacings are multiples of it; otherwise 0. Even spacings, and those of a test at two rates, are exact.
pub fn strain_step(strains: impl Iterator<Item = f64>) -> f64 {
    let strains: Vec<f64> = strains.collect();
    let same = SAME * strains.iter().fold(0.0, |a: f64, b| a.max(b.abs()));
    let spacings: Vec<f64> = strains.windows(2).map(|pair| pair[1] - pair[0]).collect();
    let between_alike = spacings.windows(3).filter(|three| (three[0] - three[2]).abs() <= same);
    let steps: Vec<f64> = between_alike.map(|three| (three[1] - three[0]).abs()).filter(|step| *step > same).collect();
    let least = steps.iter().copied().fold(f64::INFINITY, f64::min);
    // The mean is used because a spacing of many steps multiplies the error of a single step.
    let single = steps.iter().filter(|step| **step < 1.5 * least);
    let step = single.clone().sum::<f64>() / single.count() as f64;
    let is_multiple = |spacing: &f64| (spacing - step * (spacing / step).round()).abs() <= same;
    if !steps.is_empty() && spacings.iter().all(is_multiple) { step } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rounded_stresses_are_told_by_repetition() {
        let rounded = |step: f64| (0..1000).map(move |i| (f64::from(i) * 0.11e6 / step).round() * step);
        assert!((stress_step(rounded(1e6)) / 1e6 - 1.0).abs() < 1e-9);
        assert_eq!(stress_step(rounded(10.0)), 0.0);
    }

    #[test]
    fn rounded_strains_are_told_by_their_spacings() {
        let rounded = |spacing: f64, step: f64| (0..300).map(move |i| (f64::from(i) * spacing / step).round() * step);
        for spacing in [0.3e-5, 1.5e-5, 1.003e-4] {
            assert!((strain_step(rounded(spacing, 1e-5)) / 1e-5 - 1.0).abs() < 1e-6, "{spacing}");
        }
        assert_eq!(strain_step(rounded(1.003e-4, 1e-12)), 0.0);
        let two_rates = (0..200).map(|i| if i < 100 { 1e-5 * f64::from(i) } else { 1e-3 + 2e-5 * f64::from(i - 100) });
        assert_eq!(strain_step(two_rates), 0.0);
    }
}
