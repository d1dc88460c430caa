//! What the front tolerance costs and what it changes: ten long runs, each with a row of tolerances.
//!
//! `cargo run --release --example front_tolerance [COARSEST]` prints, as CSV, events, fronts under way at the end, time,
//! relative L1 error of the stress at the end against a run with a hundredth of the tolerance, three times the difference from a
//! run with three times the tolerance (the figure that `barwave run` states), and the relative energy taken.

#[path = "../tests/common/long_bars.rs"]
mod long_bars;

use std::time::Instant;

use long_bars::{Case, cases, difference};

const BUDGET: u64 = 200_000_000;

fn line(case: &Case, tolerance: f64) -> Option<String> {
    let start = Instant::now();
    let (run, ended) = case.run(tolerance, BUDGET);
    let seconds = start.elapsed().as_secs_f64();
    ended.ok()?;
    let (companion, _) = case.run(3.0 * tolerance, BUDGET);
    let (better, reached) = case.run(0.01 * tolerance, BUDGET);
    let error = if reached.is_ok() { difference(&run, &better) } else { f64::NAN };
    let figure = 3.0 * difference(&companion, &run);
    let balance = run.balance();
    Some(format!(
        "{},{tolerance:.0e},{},{},{seconds:.4},{:.0},{error:.2e},{figure:.2e},{:.1},{:.1e}",
        case.name,
        run.events(),
        run.fronts().count(),
        1e9 * seconds / run.events() as f64,
        figure / error,
        balance.thinned / balance.total(),
    ))
}

fn main() {
    let coarsest: f64 = std::env::args().nth(1).and_then(|a| a.parse().ok()).unwrap_or(1e-1);
    println!("case,front tolerance,events,fronts at end,s,ns an event,error,figure,figure/error,energy taken");
    for case in cases() {
        for part in [1.0, 0.3] {
            if let Some(line) = line(&case, part * coarsest) {
                println!("{line}");
            }
        }
    }
}
