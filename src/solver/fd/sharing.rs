//! Distribution of the cells of a grid over the segments of a bar.
//!
//! All segments have one time step, the shortest transit time of a cell times the Courant number. Where cells take longer to cross, the
//! elastic waves of the scheme disperse: in a bar of two segments with lengths 1 and 2, the force of a wave overshoots by 10 % with 333 and
//! 667 cells, and is transmitted exactly with 333 and 666. The number of cells may therefore differ from the requested one.

/// Largest relative difference from the requested number of cells.
const NEARBY: f64 = 0.02;

/// Largest difference in the number of cells of a segment: among so many numbers, a better one further away is unlikely.
const MOST: usize = 100;

/// Resolution with which shortfalls of the mean Courant number are compared.
const ALIKE: f64 = 1e-7;

/// Returns the number of cells of each segment, about `cells` in all, for these transit times (s): near that number, those with the largest
/// mean Courant number.
pub(super) fn share_out(transits: &[f64], cells: usize) -> Vec<usize> {
    let total: f64 = transits.iter().sum();
    let asked = |transit: &f64| ((cells as f64 * transit / total).round() as usize).max(1);
    let counts: Vec<usize> = transits.iter().map(asked).collect();
    let trials = transits.iter().zip(&counts).flat_map(|(transit, &count)| {
        let around = ((NEARBY * count as f64) as usize).min(MOST);
        (count - around..=count + around).map(move |own| exact_for(transit / own as f64, transits))
    });
    let rank = |counts: &Vec<usize>| {
        let sum: usize = counts.iter().sum();
        let shortfall = 1.0 - shortest(transits, counts) * sum as f64 / total;
        ((shortfall / ALIKE).round() as u64, sum.abs_diff(cells), sum)
    };
    let near = |counts: &Vec<usize>| counts.iter().sum::<usize>().abs_diff(cells) as f64 <= NEARBY * cells as f64;
    let best = trials.filter(near).min_by_key(rank);
    best.filter(|best| rank(best) < rank(&counts)).unwrap_or(counts)
}

/// Returns the largest numbers of cells for which waves take at least `dt` (s) to cross a cell.
fn exact_for(dt: f64, transits: &[f64]) -> Vec<usize> {
    transits.iter().map(|transit| ((transit / dt * (1.0 + ALIKE)) as usize).max(1)).collect()
}

/// Returns the shortest transit time of a cell, s.
fn shortest(transits: &[f64], counts: &[usize]) -> f64 {
    transits.iter().zip(counts).map(|(transit, &count)| transit / count as f64).fold(f64::INFINITY, f64::min)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Least Courant number of a segment.
    fn least(transits: &[f64], counts: &[usize]) -> f64 {
        let dt = shortest(transits, counts);
        transits.iter().zip(counts).map(|(transit, &count)| dt * count as f64 / transit).fold(1.0, f64::min)
    }

    #[test]
    fn segments_that_share_a_step_have_it() {
        assert_eq!(share_out(&[2e-5, 4e-5], 1000), [333, 666]);
        assert_eq!(share_out(&[2e-5, 4e-5], 300), [100, 200]);
        assert_eq!(share_out(&[4e-5], 1000), [1000]);
        assert_eq!(share_out(&[1e-5; 3], 1000), [333; 3]);
    }

    #[test]
    fn other_segments_nearly_have_one() {
        for transits in [[3.0, 2.0_f64.sqrt()], [1.0, std::f64::consts::E]] {
            for (cells, bound) in [(400, 2e-3), (1000, 2e-4), (10_000, 2e-5)] {
                let counts = share_out(&transits, cells);
                let sum: usize = counts.iter().sum();
                assert!(sum.abs_diff(cells) <= cells / 40, "{counts:?}");
                let shortfall = 1.0 - least(&transits, &counts);
                assert!(shortfall < bound, "{transits:?} {counts:?} {shortfall}");
                let mirrored = share_out(&[transits[1], transits[0]], cells);
                assert_eq!([mirrored[1], mirrored[0]], counts[..]);
            }
        }
    }

    #[test]
    fn a_sliver_has_one_cell() {
        assert_eq!(share_out(&[1.0, 1e-6, 1.0], 10), [5, 1, 5]);
        let counts = share_out(&[1.0, 1e-6, 2.0], 1000);
        assert!(counts[1] == 1 && counts.iter().sum::<usize>() <= 1020, "{counts:?}");
        assert_eq!(share_out(&[1.0, 1e-6], 1), [1, 1]);
    }
}
