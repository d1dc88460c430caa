//! What the front tolerance costs and what it changes: ten long runs, each with a row of tolerances.
//!
//! `cargo run --release --example front_tolerance [SECONDS] > docs/front-tolerance.csv` prints events, fronts under way at
//! the end, time, relative L1 error of the end (of stress or plastic strain, the larger) against a run with a hundredth of
//! the tolerance, the estimate that `barwave run` states of it, and the relative energy dissipated. The error is left empty
//! where the finer run takes more than 3e7 events, or where SECONDS (240 where not given) are over.

#[path = "../tests/common/long_bars.rs"]
mod long_bars;

use std::time::{Duration, Instant};

use barwave::solver::moc::{FrontTracking, Settings};
use long_bars::{Case, cases, error, estimate};
use rayon::prelude::*;

const TOLERANCES: [f64; 3] = [1e-1, 3e-2, 1e-2];
const MOST_EVENTS: u64 = 30_000_000;
/// Events between two looks at the clock.
const BURST: u64 = 500_000;
/// The shortest of so many runs is the time.
const REPEATS: usize = 3;

/// A run up to its end; none where it takes too many events or too long.
fn finer(case: &Case, tolerance: f64, deadline: Instant) -> Option<FrontTracking> {
    let mut run = case.start(Settings { front_tolerance: tolerance, event_budget: MOST_EVENTS, ..Settings::default() });
    while !run.advance_for(case.until(), BURST).ok()? {
        if Instant::now() > deadline {
            return None;
        }
    }
    Some(run)
}

/// A run and how long it took, s.
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

/// The lines of one bar: time and events first, then the true errors.
fn lines(case: &Case, runs: &[(f64, FrontTracking, f64)], deadline: Instant) -> Vec<String> {
    // Where one finer run does not get there, the next one would not either.
    let mut reached = true;
    let mut line = |(tolerance, run, seconds): &(f64, FrontTracking, f64)| {
        let truth = if reached { finer(case, 0.01 * tolerance, deadline) } else { None };
        reached = truth.is_some();
        let error = truth.map_or_else(String::new, |truth| format!("{:.3e}", error(case, run, &truth)));
        let settings = Settings { front_tolerance: *tolerance, event_budget: MOST_EVENTS, ..Settings::default() };
        let estimate =
            estimate(case, run, settings).map_or_else(|_| String::new(), |estimate| format!("{estimate:.3e}"));
        let balance = run.balance();
        let taken = balance.thinned / balance.total();
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
    // Timed one after the other; only the finer runs go side by side.
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
