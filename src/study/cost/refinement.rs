//! Order of the points of a study: the next point is always the one with the shortest expected time, as long as it fits into the remaining budget.

use super::Resolution;

/// Error bound below which a method is not refined further: below the finest tolerance that is evaluated.
const FINE_ENOUGH: f64 = 3e-5;

/// Fewest levels of every grid, so that an order and the growth can be fitted.
const LEAST_CELL_RUNGS: usize = 4;

/// Expected growth of the stepping time from one level to the next. On a grid, cells and steps double. The value for fronts is a guess until two
/// levels are known.
const CELLS_GROWTH: f64 = 4.0;
const FRONTS_GROWTH: f64 = 3.0;
/// Largest expected growth. Fronts can grow faster than the last two levels show, but a larger estimate would end a refinement after a single
/// disturbance of the clock.
const MOST_GROWTH: f64 = 10.0;
/// Growth of all other time from one level to the next: it is proportional to the output, and thus to the cells.
const OTHER_GROWTH: f64 = 2.0;

/// Time that a point took.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Spent {
    /// Stepping time of one run, s.
    pub step: f64,
    /// Number of runs.
    pub passes: f64,
    /// Total time, s.
    pub total: f64,
}

/// Result of a completed point, as needed for the refinement.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Ran {
    pub spent: Spent,
    /// Error, at least the uncertainty of the reference.
    pub bound: f64,
    /// Whether finer levels would give the same result.
    pub exact: bool,
    /// Whether the error is below the uncertainty of the reference.
    pub below_reference: bool,
}

/// Reason why a point has no result.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Halt {
    /// The user interrupted.
    Interrupted,
    /// The time ran out during the run.
    OutOfTime,
    /// The run stopped with an error.
    Failed(String),
}

/// Formats a time: two significant digits below 0.1 s, two decimals above.
fn seconds(time: f64) -> String {
    if time < 0.1 { format!("{time:.1e} s") } else { format!("{time:.2} s") }
}

/// Runs the points of a study. Tests use an implementation with a simulated clock.
pub(super) trait Runner {
    /// Runs one point of a family.
    fn run(&mut self, family: usize, resolution: Resolution) -> Result<Ran, Halt>;
    /// Returns the time since the start of the study, s.
    fn now(&self) -> f64;
}

/// A level that was skipped.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Left {
    pub family: usize,
    pub resolution: Resolution,
    /// Expected time, s.
    pub expected: Option<f64>,
    pub why: String,
}

/// Progress of the refinement of one family.
struct Refinement<'a> {
    levels: &'a [Resolution],
    ran: Vec<Ran>,
    done: bool,
}

/// Returns the expected time of the next level, s, including all repetitions and the whole run. `passes` returns the number of runs for a given
/// stepping time (s).
fn expected(ran: &[Ran], next: Resolution, passes: &dyn Fn(f64) -> f64) -> f64 {
    let Some(last) = ran.last().map(|r| r.spent) else { return 0.0 };
    let seen = ran.len().checked_sub(2).map(|k| last.step / ran[k].spent.step.max(f64::MIN_POSITIVE));
    let growth = match next {
        Resolution::Cells(_) => seen.unwrap_or(CELLS_GROWTH).clamp(CELLS_GROWTH, MOST_GROWTH),
        Resolution::FrontTolerance(_) => seen.unwrap_or(FRONTS_GROWTH).clamp(FRONTS_GROWTH, MOST_GROWTH),
    };
    let step = growth * last.step;
    let other = (last.total - last.passes * last.step).max(0.0);
    passes(step) * step + OTHER_GROWTH * other
}

/// Refines the families until time `until`, s. Returns the skipped levels, and whether the user stopped the study.
pub(super) fn refine(
    levels: &[&[Resolution]],
    until: f64,
    passes: &dyn Fn(f64) -> f64,
    runner: &mut dyn Runner,
) -> (Vec<Left>, bool) {
    let mut ladders: Vec<Refinement<'_>> =
        levels.iter().map(|levels| Refinement { levels, ran: Vec::new(), done: levels.is_empty() }).collect();
    let mut left = Vec::new();
    loop {
        let next = |l: &Refinement<'_>| expected(&l.ran, l.levels[l.ran.len()], passes);
        let open = ladders.iter().enumerate().filter(|(_, l)| !l.done);
        let Some((family, time)) = open.map(|(k, l)| (k, next(l))).min_by(|a, b| a.1.total_cmp(&b.1)) else {
            return (left, false);
        };
        let refinement = &mut ladders[family];
        let resolution = refinement.levels[refinement.ran.len()];
        let mut leave = |why: String, expected| left.push(Left { family, resolution, expected, why });
        let remaining = until - runner.now();
        if time > remaining {
            let (rest, are) = if remaining > 0.0 { (seconds(remaining), "are") } else { ("nothing".to_owned(), "is") };
            let why =
                format!("it would need about {}, and {rest} of the time for the points {are} left", seconds(time));
            leave(why, Some(time));
            refinement.done = true;
            continue;
        }
        match runner.run(family, resolution) {
            Ok(ran) => {
                refinement.ran.push(ran);
                refinement.done =
                    refinement.ran.len() == refinement.levels.len() || enough(&refinement.ran, resolution);
            }
            Err(Halt::Interrupted) => return (left, true),
            Err(Halt::OutOfTime) => {
                leave("the budget was used up while it ran".into(), None);
                refinement.done = true;
            }
            Err(Halt::Failed(why)) => {
                leave(why, None);
                refinement.done = true;
            }
        }
    }
}

/// Returns whether finer levels would give no further information.
fn enough(ran: &[Ran], resolution: Resolution) -> bool {
    let Some(last) = ran.last() else { return false };
    let seen = match resolution {
        Resolution::Cells(_) => ran.len() >= LEAST_CELL_RUNGS,
        Resolution::FrontTolerance(_) => true,
    };
    let blind = ran.len() >= 2 && ran[ran.len() - 2..].iter().all(|r| r.below_reference);
    seen && (last.exact || last.bound <= FINE_ENOUGH || blind)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Cells: time n^2/1e8 s, error 10/n. Fronts: time 1e-3/tolerance s, error as the tolerance.
    struct Fake {
        clock: f64,
        order: Vec<(usize, Resolution)>,
        stop_after: usize,
    }

    impl Runner for Fake {
        fn run(&mut self, family: usize, resolution: Resolution) -> Result<Ran, Halt> {
            if self.order.len() == self.stop_after {
                return Err(Halt::Interrupted);
            }
            self.order.push((family, resolution));
            let (step, bound) = match resolution {
                Resolution::Cells(n) => ((n * n) as f64 / 1e8, 10.0 / n as f64),
                Resolution::FrontTolerance(t) => (1e-3 / t, t),
            };
            self.clock += 2.0 * step;
            let spent = Spent { step, passes: 2.0, total: 2.0 * step };
            Ok(Ran { spent, bound, exact: false, below_reference: false })
        }

        fn now(&self) -> f64 {
            self.clock
        }
    }

    fn cells(count: u32) -> Vec<Resolution> {
        (0..count).map(|k| Resolution::Cells(1000 << k)).collect()
    }

    fn tolerances() -> Vec<Resolution> {
        [0.1, 0.03, 0.01, 0.003, 0.001].map(Resolution::FrontTolerance).into()
    }

    fn fake() -> Fake {
        Fake { clock: 0.0, order: Vec::new(), stop_after: usize::MAX }
    }

    #[test]
    fn the_cheapest_next_point_comes_first() {
        let (cells, tolerances) = (cells(3), tolerances());
        let mut fake = fake();
        let (left, interrupted) = refine(&[&cells, &tolerances], 1e9, &|_| 2.0, &mut fake);
        assert!(left.is_empty() && !interrupted);
        // 0.01 s for 1000 cells, then tolerances of 0.01, 0.033 s before 2000 cells (0.04 s) and so on.
        let families: Vec<usize> = fake.order.iter().map(|o| o.0).collect();
        assert_eq!(families, [0, 1, 1, 0, 1, 0, 1, 1]);
    }

    #[test]
    fn what_does_not_fit_into_the_budget_is_left_out_and_named() {
        let cells = cells(10);
        let mut fake = fake();
        let (left, _) = refine(&[&cells], 10.0, &|_| 2.0, &mut fake);
        // 0.02 + 0.08 + 0.32 + 1.28 + 5.12 = 6.82 s; the next one takes 20.48 s.
        assert_eq!(fake.order.len(), 5);
        assert!(fake.clock <= 10.0);
        assert_eq!(left.len(), 1);
        assert_eq!(left[0].resolution, Resolution::Cells(32_000));
        assert!((left[0].expected.expect("it was predicted") - 20.48).abs() < 1e-9);
        assert!(left[0].why.contains("3.18 s of the time for the points are left"), "{}", left[0].why);
    }

    #[test]
    fn a_ladder_ends_where_it_is_fine_enough_but_a_grid_not_before_four_rungs() {
        let fine = [Resolution::Cells(500_000), Resolution::Cells(500_001), Resolution::Cells(500_002)];
        let fine: Vec<_> = fine.into_iter().chain([Resolution::Cells(500_003), Resolution::Cells(500_004)]).collect();
        let mut fake = fake();
        refine(&[&fine], f64::INFINITY, &|_| 2.0, &mut fake);
        assert_eq!(fake.order.len(), LEAST_CELL_RUNGS);
    }

    #[test]
    fn stopping_keeps_what_there_is() {
        let cells = cells(10);
        let mut fake = Fake { stop_after: 3, ..fake() };
        let (left, interrupted) = refine(&[&cells], 1e9, &|_| 2.0, &mut fake);
        assert!(interrupted && left.is_empty());
        assert_eq!(fake.order.len(), 3);
    }
}
