//! Cells and time step of a net: one time step for all segments of a bar.

use crate::bar::Bar;
use crate::solver::fd::Grid;

/// Largest number of time steps that are tried in the search for the best one.
const MOST_TRIALS: usize = 200_000;
/// Relative change of the transit times at which the search stops: one hundredth of the error of a fine net.
const GOOD_SHIFT: f64 = 1e-7;

/// A time step, and the largest relative change of a transit time that it causes.
#[derive(Clone, Copy)]
struct Trial {
    dt: f64,
    shift: f64,
}

/// Returns a grid with a whole number of cells in every segment, each crossed by the elastic wave in one time step, see [`Grid::in_steps_of`]. It has
/// about `cells` cells, at least one in each segment: up to 10 % more if that suits the segments better, and up to four times as many if rounding
/// would otherwise change transit times by more than 0.1 %.
pub fn grid(bar: &Bar, cells: usize) -> Grid {
    let transits = bar.transit_times();
    let total: f64 = transits.iter().sum();
    let cells = cells.max(1) as f64;
    let near = best(&transits, total / cells, total / (1.1 * cells));
    let chosen = if near.shift > 1e-3 {
        let wide = best(&transits, total / cells, total / (4.0 * cells));
        if wide.shift < near.shift { wide } else { near }
    } else {
        near
    };
    let counts: Vec<usize> = transits.iter().map(|&transit| whole(transit, chosen.dt)).collect();
    Grid::with_counts(bar, &counts, 1.0).in_steps_of(bar, chosen.dt, |_| true)
}

fn whole(transit: f64, dt: f64) -> usize {
    ((transit / dt).round() as usize).max(1)
}

/// Returns the time step between `longest` and `shortest` that changes transit times least; the longest of equally good ones.
fn best(transits: &[f64], longest: f64, shortest: f64) -> Trial {
    let mut best = tuned(transits, longest);
    // Four trials for every cell by which the finest net exceeds the coarsest.
    let finest: f64 = transits.iter().map(|t| t / shortest - t / longest).sum();
    let trials = ((4.0 * finest).ceil() as usize).min(MOST_TRIALS);
    for k in 1..=trials {
        if best.shift < GOOD_SHIFT {
            break;
        }
        let part = k as f64 / trials as f64;
        let trial = tuned(transits, 1.0 / (1.0 / longest + part * (1.0 / shortest - 1.0 / longest)));
        if trial.shift < 0.999 * best.shift {
            best = trial;
        }
    }
    best
}

/// Determines the numbers of cells for a time step, and the time step that suits these numbers best.
fn tuned(transits: &[f64], dt: f64) -> Trial {
    let (mut low, mut high) = (f64::INFINITY, 0.0_f64);
    for &transit in transits {
        let own = transit / whole(transit, dt) as f64;
        low = low.min(own);
        high = high.max(own);
    }
    // The relative changes dt/own - 1 are as large upward as downward.
    let dt = 2.0 / (1.0 / low + 1.0 / high);
    Trial { dt, shift: (high - low) / (high + low) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_segment_takes_the_cells_asked_for() {
        let bar = Bar::elastic(&[(1.0, 7800.0)]);
        let lattice = grid(&bar, 1000);
        assert_eq!(lattice.cells(), 1000);
        assert_eq!(lattice.transit_shift(), 0.0);
        assert!((lattice.dt * 1000.0 - bar.transit_time()).abs() < 1e-15 * bar.transit_time());
    }

    #[test]
    fn segments_that_share_a_step_are_not_shifted() {
        let lattice = grid(&Bar::elastic(&[(0.3, 7800.0), (0.7, 7800.0)]), 1000);
        assert!(
            lattice.transit_shift() < 1e-15 && lattice.cells() == 1000,
            "{} {}",
            lattice.transit_shift(),
            lattice.cells()
        );
        // 9 to 16 in density: 3 to 4 in transit.
        let lattice = grid(&Bar::elastic(&[(0.5, 900.0), (0.5, 1600.0)]), 1000);
        assert!(
            lattice.transit_shift() < 1e-7 && lattice.cells() <= 1100,
            "{} {}",
            lattice.transit_shift(),
            lattice.cells()
        );
    }

    #[test]
    fn any_bar_gets_a_small_shift() {
        let parts = [(0.317, 7800.0), (0.0123, 2700.0), (0.71, 8960.0), (0.2, 4510.0)];
        let lattice = grid(&Bar::elastic(&parts), 1000);
        // Four transit times and a few hundred steps to choose from: about 1/N each.
        assert!(lattice.transit_shift() < 1e-2, "{}", lattice.transit_shift());
        for (part, segment) in lattice.segments.iter().zip(&Bar::elastic(&parts).segments) {
            let change = lattice.dt * part.cells.len() as f64 * segment.material.c0() / segment.length - 1.0;
            assert!(change.abs() <= lattice.transit_shift() * (1.0 + 1e-9), "{change} {}", lattice.transit_shift());
        }
    }

    #[test]
    fn a_sliver_has_one_cell_and_says_what_that_costs() {
        let lattice = grid(&Bar::elastic(&[(1.0, 7800.0), (1e-6, 7800.0)]), 10);
        assert_eq!(lattice.segments[1].cells.len(), 1);
        assert!(lattice.transit_shift() > 0.9);
    }
}
