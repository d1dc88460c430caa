//! Isotonic regression: the monotone sequence nearest to noisy values.
//!
//! It smooths without a bandwidth parameter, keeps jumps sharp and averages over plateaus. The records of gauges passed by plastic fronts have such
//! jumps and plateaus (R. E. Barlow et al., Statistical Inference under Order Restrictions, Wiley, 1972).

/// Returns the non-decreasing sequence with the smallest weighted sum of squared deviations, by the pool-adjacent-violators algorithm. `weight`
/// returns the weight of each value, > 0.
pub(super) fn non_decreasing(values: &[f64], weight: impl Fn(usize) -> f64) -> Vec<f64> {
    // Blocks of equal values: mean, weight, length.
    let mut blocks: Vec<(f64, f64, usize)> = Vec::new();
    for (i, &value) in values.iter().enumerate() {
        let mut last = (value, weight(i), 1);
        while let Some(&(mean, weight, length)) = blocks.last().filter(|block| block.0 >= last.0) {
            let sum = weight + last.1;
            last = ((mean * weight + last.0 * last.1) / sum, sum, length + last.2);
            blocks.pop();
        }
        blocks.push(last);
    }
    blocks.into_iter().flat_map(|(mean, _, length)| std::iter::repeat_n(mean, length)).collect()
}

/// Returns the position at which a non-decreasing sequence first reaches a level, by linear interpolation. `None` if the sequence starts at or above
/// the level or stays below it.
pub(super) fn first_reach(places: &[f64], values: &[f64], level: f64) -> Option<f64> {
    let next = values.partition_point(|&value| value < level);
    if next == 0 || next >= values.len() {
        return None;
    }
    let (a, b) = (values[next - 1], values[next]);
    Some(places[next - 1] + (places[next] - places[next - 1]) * (level - a) / (b - a))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn violators_are_pooled_to_their_mean() {
        assert_eq!(non_decreasing(&[1.0, 3.0, 2.0, 4.0], |_| 1.0), [1.0, 2.5, 2.5, 4.0]);
        assert_eq!(non_decreasing(&[4.0, 1.0, 1.0], |_| 1.0), [2.0, 2.0, 2.0]);
        assert_eq!(non_decreasing(&[3.0, 0.0], |i| [1.0, 2.0][i]), [1.0, 1.0]);
        assert!(non_decreasing(&[], |_| 1.0).is_empty());
    }

    #[test]
    fn levels_are_reached_between_the_samples() {
        let (places, values) = ([0.0, 1.0, 2.0, 3.0], [0.0, 0.0, 4.0, 4.0]);
        assert_eq!(first_reach(&places, &values, 1.0), Some(1.25));
        assert_eq!(first_reach(&places, &values, 4.0), Some(2.0));
        assert_eq!(first_reach(&places, &values, 4.1), None);
        assert_eq!(first_reach(&places, &values, 0.0), None);
    }
}
