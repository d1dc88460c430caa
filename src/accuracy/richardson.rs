//! Richardson extrapolation: the error of a run from its differences to runs with fewer cells.

use super::Response;
use crate::record::{ErrorTable, Measure};

/// Largest order that is looked for between runs whose cells have other ratios, and halvings of what it lies in.
const HIGHEST: f64 = 8.0;
const HALVINGS: usize = 60;

/// The figure, over what the extrapolation says, where an order was seen. A kink (the corner of a ramp) is off by up to three
/// times its mean, which is what differences show, depending on where in a cell it lies.
pub const SAFETY: f64 = 3.0;

/// Orders that are believed, at least, and at most: of elastic bars and of the net, and of grids with a strain rate.
const LOWEST: f64 = 0.5;
const SMOOTH: f64 = 2.0;
const RATE: f64 = 1.0;

/// Two orders in a row that differ by no more than this make a rule; else what was seen is chance.
const ALIKE: f64 = 0.35;

/// Order where none is seen that can be believed, and of grids whose bar has yielded, without a strain rate: that of a front,
/// which a grid spreads over the cube root of its cells. What is seen between two grids is scattered by where fronts lie in
/// their cells. Over fifteen bars and 128 to 2048 cells the true error was 0.46 to 1.75 times the difference from half the
/// cells, for which this order says 1.7; the safety factor covers the rest, and that muscl is up to a tenth worse.
const FRONTS: f64 = 2.0 / 3.0;
/// The same where the order is that of fronts.
pub const SAFETY_OF_FRONTS: f64 = 1.25;

/// Which orders can be expected.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Rules {
    /// Elastic bars and the characteristic net.
    Smooth,
    /// A grid with a strain rate.
    Rate,
    /// A grid whose bar has yielded, without a strain rate.
    Fronts,
}

/// The difference of two runs.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Difference {
    apart: f64,
    /// Cells of the finer one over those of the coarser one, > 1.
    ratio: f64,
}

/// An estimate for the finest of several runs.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Estimate {
    /// The error, with the safety factor.
    pub value: f64,
    /// Order that was used.
    pub order: f64,
    /// It was seen between the runs; else assumed.
    pub seen: bool,
    /// Order by which finer grids can be expected to be better: what was seen, or else the highest that is believed.
    pub hope: f64,
}

/// Extrapolates every error from two to four runs with fewer and fewer cells, the finest one first, and gives the estimate of the largest one too.
/// Differences of 0 are no error at all: waves that are exact on every grid.
pub fn extrapolate(rules: Rules, runs: &[(usize, &Response)]) -> (ErrorTable, Estimate) {
    let Some((_, finest)) = runs.first() else { return (ErrorTable::default(), estimate(&[], SMOOTH)) };
    let apart = |pair: &[(usize, &Response)]| {
        let [(fine, near), (coarse, far)] = [pair[0], pair[1]];
        (far.apart(near, finest), fine as f64 / coarse as f64)
    };
    let apart: Vec<(ErrorTable, f64)> = runs.windows(2).map(apart).collect();
    let mut worst: Option<Estimate> = None;
    let table = ErrorTable::of(|measure: Measure| {
        let difference = |&(table, ratio): &(ErrorTable, f64)| Some(Difference { apart: table[measure]?, ratio });
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

/// With the order seen between the runs, where two in a row agree; else with that of fronts. `differences` are those of the
/// finest two, the next two, and so on, in what the value is to be in.
fn estimate(differences: &[Difference], highest: f64) -> Estimate {
    let orders: Vec<f64> = differences.windows(2).map(|pair| order(pair[0], pair[1])).collect();
    match orders[..] {
        _ if largest(differences, highest) == 0.0 => Estimate { value: 0.0, order: highest, seen: true, hope: highest },
        [order, before, ..] if (order - before).abs() <= ALIKE && order >= LOWEST => {
            let order = order.min(highest);
            Estimate { value: SAFETY * remaining(differences, highest, order), order, seen: true, hope: order }
        }
        _ => assumed(differences, highest, highest),
    }
}

/// With the order of fronts.
fn assumed(differences: &[Difference], highest: f64, hope: f64) -> Estimate {
    let value = SAFETY_OF_FRONTS * remaining(differences, highest, FRONTS);
    Estimate { value, order: FRONTS, seen: false, hope }
}

/// The order p of errors C n^-p of n cells that makes the differences what they are. Those of ratios r and s are to each other as
/// `r^p (s^p - 1)/(r^p - 1)`, which rises with p. 0 where no positive order does.
fn order(near: Difference, far: Difference) -> f64 {
    let apart = far.apart / near.apart;
    if near.ratio == far.ratio || !apart.is_finite() {
        return apart.log2() / near.ratio.log2();
    }
    let (mut low, mut high) = (0.0, HIGHEST);
    for _ in 0..HALVINGS {
        let middle = 0.5 * (low + high);
        if 1.0 / shrinks(near.ratio, far.ratio, middle) < apart { low = middle } else { high = middle }
    }
    low
}

/// Difference of the finest two, of this ratio of cells, over the next one, by an order.
fn shrinks(near: f64, far: f64, order: f64) -> f64 {
    let [near, far] = [near, far].map(|ratio| ratio.powf(order));
    (near - 1.0) / (near * (far - 1.0))
}

/// The difference of the finest two, or what the next one makes of it at the highest order, whichever is more: it can be small
/// by chance, where both grids are off by the same, but seldom twice.
fn largest(differences: &[Difference], highest: f64) -> f64 {
    match *differences {
        [near, far, ..] => near.apart.max(far.apart * shrinks(near.ratio, far.ratio, highest)),
        [near] => near.apart,
        [] => 0.0,
    }
}

/// What is left of an error of which the largest difference went between the finest two.
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

    /// Differences of runs with a half of the cells each.
    fn halved(apart: &[f64]) -> Vec<Difference> {
        apart.iter().map(|&apart| Difference { apart, ratio: 2.0 }).collect()
    }

    #[test]
    fn errors_of_a_known_order_are_found_again_whatever_the_ratios_of_the_cells() {
        for order in [0.6, 1.0, 1.7] {
            for cells in [[400.0_f64, 200.0, 100.0, 50.0], [322.0, 213.0, 109.0, 15.0], [426.0, 213.0, 109.0, 15.0]] {
                let error = |k: usize| (cells[0] / cells[k]).powf(order);
                let difference =
                    |k: usize| Difference { apart: error(k + 1) - error(k), ratio: cells[k] / cells[k + 1] };
                let found = estimate(&[0, 1, 2].map(difference), SMOOTH);
                assert!((found.order - order).abs() < 1e-9 && found.seen, "{cells:?}: {found:?}");
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
            assert!((found.order - order).abs() < 1e-12 && found.seen);
            assert!((found.value - SAFETY).abs() < 1e-12);
        }
    }

    #[test]
    fn no_difference_is_no_error_and_orders_by_chance_are_not_believed() {
        assert_eq!(estimate(&halved(&[0.0, 0.0, 0.0]), SMOOTH).value, 0.0);
        // One order alone, two that differ, and two that are too low: that of fronts.
        for differences in [&[1.0, 4.0][..], &[1.0, 4.0, 6.0], &[1.0, 1.1, 1.2]] {
            let found = estimate(&halved(differences), SMOOTH);
            assert!(!found.seen && found.order == FRONTS, "{found:?}");
        }
        assert_eq!(estimate(&halved(&[1.0, 6.0, 36.0]), SMOOTH).order, SMOOTH);
        assert_eq!(estimate(&halved(&[1.0, 6.0, 36.0]), RATE).order, RATE);
    }

    #[test]
    fn two_grids_that_are_off_by_the_same_do_not_hide_it() {
        // Nothing between the finest two, but 0.4 before: no order above 2 makes less than 0.1 of that.
        assert_eq!(largest(&halved(&[0.0, 0.4, 0.5]), SMOOTH), 0.1);
        assert_eq!(largest(&halved(&[0.0, 0.0, 1.6]), SMOOTH), 0.0);
        assert!(estimate(&halved(&[0.0, 0.4, 0.5]), SMOOTH).value > 0.1);
    }

    #[test]
    fn a_kink_is_seen_wherever_it_lies() {
        // Cells that hold the mean of a ramp from a corner on: halves of them have the same means.
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
            let differences = [half.apart(&fine).0, quarter.apart(&half).0, eighth.apart(&quarter).0];
            // At a cell's centre the mean is off by an eighth of the cell at most, over a cell.
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
        let apart = |cells: usize| profile(cells / 2).apart(&profile(cells)).0;
        let found = estimate(&halved(&[256, 128, 64].map(apart)), SMOOTH);
        // The cells at the ends have no bend.
        let truth = 1.0 / 12.0 / 256.0_f64.powi(2);
        assert!((found.order - 2.0).abs() < 0.05, "{}", found.order);
        assert!((found.value / SAFETY / truth - 1.0).abs() < 0.05, "{} {truth}", found.value / SAFETY);
    }
}
