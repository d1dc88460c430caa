//! Builds bars for the conservative scheme (muscl), without scene files.
#![allow(dead_code, reason = "every test file takes what it needs")]

use barwave::assemble::{medium, segment_law};
use barwave::bar::{Bar, EndCondition, Segment};
use barwave::record::Ledger;
use barwave::scene::{Effects, HardeningRule};
use barwave::solver::fd::{Grid, Quantity};
use barwave::solver::muscl::Muscl;

/// Returns a bar at t = 0.
pub fn muscl(
    segments: Vec<Segment>,
    ends: [EndCondition; 2],
    hardening: Option<HardeningRule>,
    cells: usize,
    cfl: f64,
) -> Muscl {
    let effects = Effects { hardening, ..Effects::default() };
    let laws = segments.iter().map(|s| segment_law(s, &effects)).collect();
    let media = segments.iter().map(|s| medium(s, &effects)).collect();
    let bar = Bar { segments, area_given: true };
    let grid = Grid::new(&bar, cells, cfl);
    Muscl::new(&bar, grid, laws, media, ends)
}

/// Advances a bar to the step nearest to a time.
pub fn advance_to(bar: &mut Muscl, time: f64) {
    while bar.time() < time - 0.5 * bar.grid().dt {
        bar.advance();
    }
}

/// Advances a bar to the step nearest to a time, and returns its ledger.
pub fn advance_with_ledger(bar: &mut Muscl, time: f64) -> Ledger {
    let mut ledger = Ledger::new(bar);
    while bar.time() < time - 0.5 * bar.grid().dt {
        bar.advance();
        ledger.row(bar);
    }
    ledger
}

/// Returns a quantity in every cell.
pub fn profile(bar: &Muscl, quantity: Quantity) -> Vec<f64> {
    let mut values = vec![0.0; bar.grid().cells()];
    bar.profile(quantity, &mut values);
    values
}

/// Returns the largest difference of two profiles of equal length.
pub fn largest_difference(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}

/// Returns the mean difference of a profile from one with `by` times as many cells, averaged over each group of cells.
pub fn mean_difference(coarse: &[f64], fine: &[f64], by: usize) -> f64 {
    let groups = fine.chunks_exact(by).map(|group| group.iter().sum::<f64>() / by as f64);
    coarse.iter().zip(groups).map(|(c, f)| (c - f).abs()).sum::<f64>() / coarse.len() as f64
}
