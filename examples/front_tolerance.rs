//! Cost and effect of the front tolerance: ten long runs, each with several tolerances.
//!
//! `cargo run --release --example front_tolerance [SECONDS] > docs/front-tolerance.csv` prints the number of events, the number of active fronts at
//! the end, the computing time, the relative L1 error at the end time (of stress or plastic strain, whichever is larger) against a run with a
//! hundredth of the tolerance, the error estimate of `barwave run`, and the relative energy dissipated. The error is empty if the finer run takes
//! more than 3e7 events, or if SECONDS (default 240) have passed.

#[path = "../tests/common/long_bars.rs"]
mod long_bars;

use std::time::{Duration, Instant};

use barwave::solver::moc::{FrontTracking, Settings};
use long_bars::{Case, cases, error, estimate};
use rayon::prelude::*;

const TOLERANCES: [f64; 3] = [1e-1, 3e-2, 1e-2];
const MOST_EVENTS: u64 = 30_000_000;
/// Number of events between two checks of the time limit.
const BURST: u64 = 500_000;
/// Number of timed runs, of which the shortest counts.
const REPEATS: usize = 3;

/// Returns a finished run, or `None` if it needs too many events or too much time.
fn finer(case: &Case, tolerance: f64, deadline: Instant) -> Option<FrontTracking> {
    let mut run = case.start(Settings { front_tolerance: tolerance, event_budget: MOST_EVENTS, ..Settings::default() });
    while !run.advance_for(case.until(), BURST).ok()? {
        if Instant::now() > deadline {
            return None;
        }
    }
    Some(run)
}

/// Returns a run and its computing time, s, or `None` if it needs too many events.
fn timed(case: &Case, tolerance: f64) -> Option<(FrontTracking, f64)> {
    let mut shortest = f64::INFINITY;
    let mut last = None;
    for _ in 0..REPEATS {
        let start = Instant::now();
        let (run, ended) = case.run(tolerance, MOST_EVENTS);
        shortest = shortest.min(start.elapsed().as_secs_f64());
        ended.ok()?;
        last = Some(run);
    }
    last.map(|run| (run, shortest))
}

/// Returns the lines of one bar. The runs are complete; the true errors are computed here.
fn lines(case: &Case, runs: &[(f64, FrontTracking, f64)], deadline: Instant) -> Vec<String> {
    // If one finer run cannot be completed, the next one, with a smaller tolerance, cannot be either.
    let mut reached = true;
    let mut line = |(tolerance, run, seconds): &(f64, FrontTracking, f64)| {
        let truth = if reached { finer(case, 0.01 * tolerance, deadline) } else { None };
        reached = truth.is_some();
        let error = truth.map_or_else(String::new, |truth| format!("{:.3e}", error(case, run, &truth)));
        let settings = Settings { front_tolerance: *tolerance, event_budget: MOST_EVENTS, ..Settings::default() };
        let estimate =
            estimate(case, run, settings).map_or_else(|_| String::new(), |estimate| format!("{estimate:.3e}"));
        let balance = run.balance();
        let taken = balance.numerical / balance.total();
        let (events, fronts) = (run.events(), run.front_count());
        format!("\"{}\",{tolerance:e},{events},{fronts},{seconds:.2e},{error},{estimate},{taken:.1e}", case.name)
    };
    runs.iter().map(&mut line).collect()
}

fn main() {
    let seconds = std::env::args().nth(1).and_then(|a| a.parse().ok()).unwrap_or(240);
    let deadline = Instant::now() + Duration::from_secs(seconds);
    println!("case,front tolerance,events,fronts at end,time (s),error,estimate,energy dissipated");
    let run = |case: &Case, tolerance| timed(case, tolerance).map(|(run, seconds)| (tolerance, run, seconds));
    // The timed runs are sequential; only the finer runs are parallel.
    let all: Vec<_> = cases()
        .into_iter()
        .map(|case| {
            let runs: Vec<_> = TOLERANCES.iter().filter_map(|&tolerance| run(&case, tolerance)).collect();
            (case, runs)
        })
        .collect();
    let rows: Vec<Vec<String>> = all.par_iter().map(|(case, runs)| lines(case, runs, deadline)).collect();
    for row in rows.concat() {
        println!("{row}");
    }
}
