//! Richardson extrapolation: the error of a run, computed from its differences from runs with fewer cells.

use super::Response;
use crate::record::{ErrorTable, Measure};

/// Largest order considered for runs with different ratios of cells, and number of bisections of the interval up to it.
const HIGHEST: f64 = 8.0;
const HALVINGS: usize = 60;

/// Ratio of the estimate to the extrapolated error if an order was observed. The error of a kink (the corner of a ramp)
/// depends on its position in a cell: it is up to three times the mean error, which is what differences show.
pub const SAFETY: f64 = 3.0;

/// Smallest accepted order, and largest accepted orders: for elastic bars and the net, and for grids with rate dependence.
const LOWEST: f64 = 0.5;
const SMOOTH: f64 = 2.0;
const RATE: f64 = 1.0;

/// Largest difference of two successive observed orders for which they are accepted; otherwise the orders are random.
const ORDER_TOLERANCE: f64 = 0.35;

/// Order that is assumed if no acceptable order is observed, and for grids whose bar has yielded without rate
/// dependence. It is the order of a front, whose width on a grid grows with the cube root of the number of cells when
/// measured in cells. Differences between two grids scatter with the positions of the fronts in their cells. For
/// fifteen bars with 128 to 2048 cells the true error was 0.46 to 1.75 times the difference from the run with half the
/// cells, for which this order predicts 1.7. The safety factor covers the rest, including that muscl is up to 10 %
/// worse.
const FRONTS: f64 = 2.0 / 3.0;
/// Ratio of the estimate to the extrapolated error for the order of fronts.
pub const SAFETY_OF_FRONTS: f64 = 1.25;

/// Orders that can be expected.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Rules {
    /// Elastic bars and the characteristic net.
    Smooth,
    /// Grids with rate dependence.
    Rate,
    /// Grids whose bar has yielded, without rate dependence.
    Fronts,
}

/// Difference between two runs.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Difference {
    value: f64,
    /// Ratio of the cells of the finer run to those of the coarser one, > 1.
    ratio: f64,
}

/// Estimate for the finest of several runs.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Estimate {
    /// Error, with the safety factor.
    pub value: f64,
    /// Order that was used.
    pub order: f64,
    /// True if the order was observed between the runs; false if it was assumed.
    pub observed: bool,
    /// Order with which finer grids can be expected to improve: the observed order, or else the largest accepted one.
    pub expected_order: f64,
}

/// Extrapolates every error from two to four runs with decreasing numbers of cells, the finest run first. Returns the
/// table of errors, and the estimate of the largest error. Differences of 0 mean no error: such waves are exact on
/// every grid.
pub fn extrapolate(rules: Rules, runs: &[(usize, &Response)]) -> (ErrorTable, Estimate) {
    let Some((_, finest)) = runs.first() else { return (ErrorTable::default(), estimate(&[], SMOOTH)) };
    let apart = |pair: &[(usize, &Response)]| {
        let [(fine, near), (coarse, far)] = [pair[0], pair[1]];
        (far.difference(near, finest), fine as f64 / coarse as f64)
    };
    let apart: Vec<(ErrorTable, f64)> = runs.windows(2).map(apart).collect();
    let mut worst: Option<Estimate> = None;
    let table = ErrorTable::of(|measure: Measure| {
        let difference = |&(table, ratio): &(ErrorTable, f64)| Some(Difference { value: table[measure]?, ratio });
        let differences: Vec<Difference> = apart.iter().map(difference).collect::<Option<_>>()?;
        let found = match rules {
            Rules::Smooth => estimate(&differences, SMOOTH),
            Rules::Rate => estimate(&differences, RATE),
            Rules::Fronts => assumed(&differences, 1.0, FRONTS),
        };
        if worst.is_none_or(|worst| found.value > worst.value || found.value.is_nan()) {
            worst = Some(found);
        }
        Some(found.value)
    });
    (table, worst.unwrap_or_else(|| estimate(&[], SMOOTH)))
}

/// Estimates the error with the observed order, if two successive ones agree, and otherwise with that of fronts.
/// `differences` are those of the two finest runs, the next two, and so on, in the unit of the estimate.
fn estimate(differences: &[Difference], highest: f64) -> Estimate {
    let orders: Vec<f64> = differences.windows(2).map(|pair| order(pair[0], pair[1])).collect();
    match orders[..] {
        _ if largest(differences, highest) == 0.0 => {
            Estimate { value: 0.0, order: highest, observed: true, expected_order: highest }
        }
        [order, before, ..] if (order - before).abs() <= ORDER_TOLERANCE && order >= LOWEST => {
            let order = order.min(highest);
            Estimate {
                value: SAFETY * remaining(differences, highest, order),
                order,
                observed: true,
                expected_order: order,
            }
        }
        _ => assumed(differences, highest, highest),
    }
}

/// Estimates the error with the order of fronts.
fn assumed(differences: &[Difference], highest: f64, expected_order: f64) -> Estimate {
    let value = SAFETY_OF_FRONTS * remaining(differences, highest, FRONTS);
    Estimate { value, order: FRONTS, observed: false, expected_order }
}

/// Returns the order p for which errors C n^-p with n cells reproduce the two differences. The ratio of the coarser to
/// the finer difference is `r^p (s^p - 1)/(r^p - 1)` for ratios of cells r (finer) and s (coarser), and increases with
/// p. If r and s differ and no positive order fits, the result is 0.
fn order(near: Difference, far: Difference) -> f64 {
    let apart = far.value / near.value;
    if near.ratio == far.ratio || !apart.is_finite() {
        return apart.log2() / near.ratio.log2();
    }
    let (mut low, mut high) = (0.0, HIGHEST);
    for _ in 0..HALVINGS {
        let middle = 0.5 * (low + high);
        if 1.0 / difference_ratio(near.ratio, far.ratio, middle) < apart { low = middle } else { high = middle }
    }
    low
}

/// Returns the ratio of the finer difference to the coarser one for an order; `near` and `far` are their ratios of cells.
fn difference_ratio(near: f64, far: f64, order: f64) -> f64 {
    let [near, far] = [near, far].map(|ratio| ratio.powf(order));
    (near - 1.0) / (near * (far - 1.0))
}

/// Returns the difference of the two finest runs, or that predicted from the next difference with the highest order,
/// whichever is larger: a difference can be small by chance, if both grids have the same error, but seldom twice.
fn largest(differences: &[Difference], highest: f64) -> f64 {
    match *differences {
        [near, far, ..] => near.value.max(far.value * difference_ratio(near.ratio, far.ratio, highest)),
        [near] => near.value,
        [] => 0.0,
    }
}

/// Returns the remaining error of the finest run, extrapolated from the largest difference with an order.
fn remaining(differences: &[Difference], highest: f64, order: f64) -> f64 {
    let ratio = differences.first().map_or(1.0, |near| near.ratio);
    largest(differences, highest) / (ratio.powf(order) - 1.0)
}

#[cfg(test)]
mod tests {
    use super::super::{Cells, Shape};
    use super::*;
    use crate::solver::fd::SegmentGrid;

    fn shape(values: Vec<f64>) -> Shape {
        let cells = values.len();
        Shape::Cells(Cells {
            segments: vec![SegmentGrid {
                cells: 0..cells,
                x0: 0.0,
                spacing: 1.0 / cells as f64,
                dx: 1.0 / cells as f64,
            }],
            values,
        })
    }

    /// Differences of runs, each with half as many cells as the one before.
    fn halved(apart: &[f64]) -> Vec<Difference> {
        apart.iter().map(|&value| Difference { value, ratio: 2.0 }).collect()
    }

    #[test]
    fn errors_of_a_known_order_are_found_again_whatever_the_ratios_of_the_cells() {
        for order in [0.6, 1.0, 1.7] {
            for cells in [[400.0_f64, 200.0, 100.0, 50.0], [322.0, 213.0, 109.0, 15.0], [426.0, 213.0, 109.0, 15.0]] {
                let error = |k: usize| (cells[0] / cells[k]).powf(order);
                let difference =
                    |k: usize| Difference { value: error(k + 1) - error(k), ratio: cells[k] / cells[k + 1] };
                let found = estimate(&[0, 1, 2].map(difference), SMOOTH);
                assert!((found.order - order).abs() < 1e-9 && found.observed, "{cells:?}: {found:?}");
                assert!((found.value - SAFETY).abs() < 1e-9, "{cells:?}: {found:?}");
            }
        }
    }

    #[test]
    fn errors_of_a_known_order_are_found_again() {
        for order in [0.6, 1.0, 1.7] {
            // Errors 1, 2^p, 4^p and 8^p of one sign.
            let step = |k: f64| 2_f64.powf(k * order);
            let differences = [1.0, 2.0, 3.0].map(|k| step(k) - step(k - 1.0));
            let found = estimate(&halved(&differences), SMOOTH);
            assert!((found.order - order).abs() < 1e-12 && found.observed);
            assert!((found.value - SAFETY).abs() < 1e-12);
        }
    }

    #[test]
    fn no_difference_is_no_error_and_orders_by_chance_are_not_believed() {
        assert_eq!(estimate(&halved(&[0.0, 0.0, 0.0]), SMOOTH).value, 0.0);
        // A single order, two different orders, and two orders that are too low: the order of fronts is used.
        for differences in [&[1.0, 4.0][..], &[1.0, 4.0, 6.0], &[1.0, 1.1, 1.2]] {
            let found = estimate(&halved(differences), SMOOTH);
            assert!(!found.observed && found.order == FRONTS, "{found:?}");
        }
        assert_eq!(estimate(&halved(&[1.0, 6.0, 36.0]), SMOOTH).order, SMOOTH);
        assert_eq!(estimate(&halved(&[1.0, 6.0, 36.0]), RATE).order, RATE);
    }

    #[test]
    fn two_grids_that_are_off_by_the_same_do_not_hide_it() {
        // The two finest runs are equal, but the next difference is 0.4: with an order of at most 2 it decreases to 0.1.
        assert_eq!(largest(&halved(&[0.0, 0.4, 0.5]), SMOOTH), 0.1);
        assert_eq!(largest(&halved(&[0.0, 0.0, 1.6]), SMOOTH), 0.0);
        assert!(estimate(&halved(&[0.0, 0.4, 0.5]), SMOOTH).value > 0.1);
    }

    #[test]
    fn a_kink_is_seen_wherever_it_lies() {
        // Cells contain the mean of a ramp that starts at a corner; half cells have consistent means.
        for corner in [0.5, 0.5004, 0.5017, 0.5031] {
            let profile = |cells: usize| {
                let h = 1.0 / cells as f64;
                let part = |k: usize| {
                    ((k + 1) as f64 * h - corner).max(0.0).powi(2) - (k as f64 * h - corner).max(0.0).powi(2)
                };
                let stress = (0..cells).map(|k| 0.5 * part(k) / h).collect::<Vec<f64>>();
                shape(stress)
            };
            let [fine, half, quarter, eighth] = [256, 128, 64, 32].map(profile);
            let differences =
                [half.l1_difference(&fine).0, quarter.l1_difference(&half).0, eighth.l1_difference(&quarter).0];
            // At the centre of a cell the mean differs by at most an eighth of the cell size, over one cell.
            let most = 0.125 / 256.0_f64.powi(2);
            let found = estimate(&halved(&differences), SMOOTH);
            assert!(found.value >= most && found.value < 10.0 * most, "{corner}: {found:?} {most:e}");
        }
    }

    #[test]
    fn means_over_cells_are_no_values_at_their_centres() {
        // Cells that hold the mean of a parabola, as the leapfrog of an elastic bar does: the error of each at its centre is
        // a 24th of the square of its size, times 2.
        let profile = |cells: usize| {
            let h = 1.0 / cells as f64;
            shape((0..cells).map(|k| ((k as f64 + 0.5) * h).powi(2) + h * h / 12.0).collect())
        };
        let apart = |cells: usize| profile(cells / 2).l1_difference(&profile(cells)).0;
        let found = estimate(&halved(&[256, 128, 64].map(apart)), SMOOTH);
        // The cells at the ends have no curvature.
        let truth = 1.0 / 12.0 / 256.0_f64.powi(2);
        assert!((found.order - 2.0).abs() < 0.05, "{}", found.order);
        assert!((found.value / SAFETY / truth - 1.0).abs() < 0.05, "{} {truth}", found.value / SAFETY);
    }
}
