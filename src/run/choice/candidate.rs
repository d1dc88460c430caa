//! Candidate method for a tolerance: its pilots so far, and its predicted cost.

use serde::{Deserialize, Serialize};

use super::super::accuracy::Coarse;
use crate::record::Worst;
use crate::scene::{MOST_EVENTS, Method, Rate, Scene};
use crate::solver::moc::COMPANION_RATIO;

/// Cells of the first pilot on a grid, with companions of a half, a quarter and an eighth of the cells.
pub(super) const FIRST_CELLS: usize = 128;
/// Front tolerance of the first pilot.
const FIRST_TOLERANCE: f64 = 0.1;

/// Finest resolutions that are tried.
pub(super) const MOST_CELLS: f64 = 5e6;
pub(super) const LEAST_TOLERANCE: f64 = 1e-8;

/// Largest factors by which the run may be finer than its method's last pilot: estimates that are extrapolated further miss the tolerance too often.
pub(super) const LEAP_CELLS: f64 = 2.5;
pub(super) const LEAP_TOLERANCE: f64 = 3.5;
/// Factor by which the run is finer than predicted, so that it rarely has to be repeated.
const MARGIN: f64 = 1.15;

/// Smallest refinement after a run that missed the tolerance.
const LEAST_STEP: f64 = 1.5;
/// Smallest order that is accepted from two pilots.
const LOWEST_ORDER: f64 = 0.3;

/// Stagnation of a grid: if the error is still larger than this fraction with this many times the cells, part of the error does not decrease with
/// refinement.
const STAGNATION: (f64, f64) = (0.8, 16.0);

/// Largest number of events of a first pilot while no other method has a prediction.
pub(super) const UNRIVALLED_EVENTS: u64 = 10_000_000;

/// Order in the front tolerance assumed until two pilots determine it, and the range of accepted orders.
pub(super) const FRONT_ORDER: f64 = 1.0;
pub(super) const FRONT_ORDERS: [f64; 2] = [0.5, 1.2];
/// Range of accepted exponents of 1/tolerance in the number of events; the first one is assumed until two pilots determine it.
const EVENT_GROWTH: [f64; 2] = [1.0, 3.0];

/// Number of events below which a pilot of front tracking is cheaper than a pilot on any grid.
pub(super) const FEW_EVENTS: u64 = 300;
/// Ratio to the expected cost of the best other candidate at which a pilot of front tracking is stopped.
pub(super) const MAX_COST_RATIO: f64 = 2.0;

/// Longest nominal time of a run for a tolerance, s.
pub(super) const MOST_TIME: f64 = 3600.0;
/// Fraction of [`MOST_TIME`] that the next pilot must take before a predicted run time above that limit counts: predictions of the first pilots are
/// too inaccurate.
const MIN_CONCLUSIVE_FRACTION: f64 = 0.01;

/// Returns the nominal time of a cell-step or an event, s, as reported by `barwave plan` and the benchmarks, mostly for yielded cells. Only the
/// ratios matter.
pub(super) fn nominal(scene: &Scene, method: Method) -> f64 {
    let malvern = matches!(scene.effects.rate, Some(Rate::Malvern { .. }));
    match (method, scene.effects.rate) {
        (Method::FrontTracking { .. }, _) => 1.3e-6,
        (Method::Muscl { .. }, _) => 60e-9,
        (Method::Leapfrog { .. }, None) => 2e-9,
        (Method::Leapfrog { .. }, Some(_)) => {
            if malvern {
                5e-9
            } else {
                14e-9
            }
        }
        (Method::CharacteristicNet { .. }, _) => {
            if malvern {
                20e-9
            } else {
                180e-9
            }
        }
    }
}

/// Candidate method with its pilots.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(super) struct Candidate {
    pub method: Method,
    pub pilots: Vec<Pilot>,
    /// Runs on grids, of pilots and their companions.
    pub runs: Vec<Coarse>,
    /// Reason for rejecting the candidate, if it is rejected.
    pub out: Option<String>,
    /// Work at which its next pilot was stopped as too expensive. The candidate is considered again if the others turn out to cost more.
    pub too_expensive: Option<u64>,
    /// Whether its last pilot was a run that missed the tolerance.
    pub missed: bool,
}

/// Pilot run.
#[derive(Debug, Clone, Copy, Serialize, Deserialize)]
pub(super) struct Pilot {
    pub method: Method,
    /// Cells of its grid, which can differ from the requested number; 0 without a grid.
    pub cells: usize,
    pub estimate: f64,
    /// Position and kind of the largest error.
    pub worst: Option<Worst>,
    pub order: f64,
    pub work: u64,
}

impl Pilot {
    /// Returns whether the change of cost and estimate up to the next pilot shows a trend; with only a few fronts it does not.
    pub fn is_conclusive(&self) -> bool {
        !self.method.tracks_fronts() || self.work >= FEW_EVENTS
    }
}

impl Candidate {
    pub fn new(method: Method) -> Self {
        // The number of events is limited by the expected time instead.
        let method = match method {
            Method::FrontTracking { front_tolerance, .. } => {
                Method::FrontTracking { front_tolerance, event_budget: MOST_EVENTS as u64 }
            }
            grid => grid,
        };
        Self { method, pilots: Vec::new(), runs: Vec::new(), out: None, too_expensive: None, missed: false }
    }

    /// Returns the method of the next pilot.
    pub fn next(&self) -> Method {
        match (self.pilots.last(), self.method) {
            (None, Method::FrontTracking { .. }) => self.method.with_front_tolerance(FIRST_TOLERANCE),
            (None, _) => self.method.with_cells(FIRST_CELLS),
            (Some(last), _) => match last.method {
                Method::FrontTracking { front_tolerance, .. } => {
                    last.method.with_front_tolerance(front_tolerance / COMPANION_RATIO)
                }
                grid => grid.with_cells(2 * last.cells),
            },
        }
    }

    /// Returns the factor by which the run has to be finer than the last pilot, and its expected time, s. `None` before the first pilot; infinite if
    /// the candidate is rejected or too expensive.
    pub fn predicted(&self, scene: &Scene, tolerance: f64) -> Option<(f64, f64)> {
        if self.out.is_some() || self.too_expensive.is_some() {
            return Some((f64::INFINITY, f64::INFINITY));
        }
        self.carried_on(scene, tolerance)
    }

    /// Returns the prediction from the pilots alone, as for [`Self::predicted`].
    fn carried_on(&self, scene: &Scene, tolerance: f64) -> Option<(f64, f64)> {
        let last = self.pilots.last()?;
        let least = if self.missed { LEAST_STEP } else { 1.0 };
        let finer = if last.estimate <= tolerance {
            1.0
        } else {
            (MARGIN * (last.estimate / tolerance).powf(1.0 / self.order(last))).max(least)
        };
        Some((finer, nominal(scene, last.method) * last.work as f64 * finer.powf(self.growth())))
    }

    /// Returns the exponent of the resolution in the work: 2 for cells; for events, the value from the last two pilots.
    fn growth(&self) -> f64 {
        if !self.method.tracks_fronts() {
            return 2.0;
        }
        let [least, most] = EVENT_GROWTH;
        let [.., before, last] = &self.pilots[..] else { return least };
        if !before.is_conclusive() {
            return least;
        }
        let seen = (last.work as f64 / before.work as f64).ln() / refinement(before, last).ln();
        if seen.is_finite() { seen.clamp(least, most) } else { least }
    }

    /// Returns the order for extrapolating the last estimate: the order observed in the last two pilots, but at most that of the last pilot.
    fn order(&self, last: &Pilot) -> f64 {
        let [.., before, _] = &self.pilots[..] else { return last.order };
        if !before.is_conclusive() {
            return last.order;
        }
        let seen = (before.estimate / last.estimate).ln() / refinement(before, last).ln();
        if seen.is_finite() { seen.clamp(LOWEST_ORDER.min(last.order), last.order) } else { last.order }
    }

    /// Returns the expected time of the next pilot, s.
    pub fn next_pilot(&self, scene: &Scene) -> f64 {
        let finer: f64 = if self.method.tracks_fronts() { COMPANION_RATIO } else { 2.0 };
        let last = self.too_expensive.or(self.pilots.last().map(|last| last.work)).unwrap_or(0);
        finer.powf(self.growth()) * nominal(scene, self.method) * last as f64
    }

    /// Rejects the candidate if its run is expected to exceed [`MOST_TIME`].
    pub fn check_reach(&mut self, scene: &Scene, tolerance: f64) {
        let Some((finer, time)) = self.carried_on(scene, tolerance) else { return };
        if self.out.is_none() && time > MOST_TIME && self.next_pilot(scene) > MIN_CONCLUSIVE_FRACTION * MOST_TIME {
            let method = self.finer(finer);
            self.out = Some(format!("{} would be needed, nominally {time:.0e} s", resolution(method)));
        }
    }

    /// Returns the smallest error that can be expected of a run within [`MOST_TIME`] and its event limit; `None` before the first pilot.
    pub fn within_reach(&self, scene: &Scene) -> Option<f64> {
        let last = self.pilots.iter().rfind(|pilot| pilot.estimate.is_finite())?;
        let most = match self.method {
            Method::FrontTracking { event_budget, .. } => {
                MOST_TIME.min(event_budget as f64 * nominal(scene, self.method))
            }
            _ => MOST_TIME,
        };
        let longer = most / (nominal(scene, last.method) * last.work as f64);
        let finer = longer.max(1.0).powf(1.0 / self.growth());
        Some(last.estimate * finer.powf(-self.order(last)))
    }

    /// Adds a pilot. Rejects a grid whose error does not decrease with more cells.
    pub fn add(&mut self, pilot: Pilot, tolerance: f64) {
        self.pilots.push(pilot);
        let stuck = |before: &&Pilot| {
            !self.method.tracks_fronts()
                && refinement(before, &pilot) >= STAGNATION.1
                && before.estimate > tolerance
                && pilot.estimate > STAGNATION.0 * before.estimate
        };
        if let Some(before) = self.pilots.iter().find(stuck) {
            self.out = Some(format!(
                "its error hardly falls with more cells ({:.1e} with {}, {:.1e} with {})",
                before.estimate, before.cells, pilot.estimate, pilot.cells
            ));
        }
    }

    /// Returns the method with a resolution finer than that of the last pilot by the factor `by`.
    pub fn finer(&self, by: f64) -> Method {
        let last = self.pilots.last().map_or(self.method, |p| p.method.with_cells(p.cells));
        refined(last, by)
    }
}

/// Returns the resolution of a method, in words.
fn resolution(method: Method) -> String {
    match method {
        Method::FrontTracking { front_tolerance, .. } => format!("a front tolerance of {front_tolerance:.0e}"),
        grid => format!("about {:.0e} cells", grid.cells().unwrap_or(0) as f64),
    }
}

/// Returns the ratio of the resolutions of two pilots of a method.
fn refinement(before: &Pilot, last: &Pilot) -> f64 {
    match (before.method, last.method) {
        (
            Method::FrontTracking { front_tolerance: before, .. },
            Method::FrontTracking { front_tolerance: last, .. },
        ) => before / last,
        _ => last.cells as f64 / before.cells as f64,
    }
}

/// Returns a method refined by a factor; the number of cells is a multiple of four, so that companions fit.
fn refined(method: Method, by: f64) -> Method {
    match (method, method.cells()) {
        (Method::FrontTracking { front_tolerance, .. }, _) => method.with_front_tolerance(front_tolerance / by),
        (_, Some(cells)) => method.with_cells(4 * (cells as f64 * by / 4.0).ceil() as usize),
        _ => method,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn candidate(method: Method, pilots: &[(f64, u64)]) -> Candidate {
        let mut candidate = Candidate::new(method);
        for &(estimate, work) in pilots {
            let method = candidate.next();
            let cells = method.cells().unwrap_or(0);
            candidate.pilots.push(Pilot { method, cells, estimate, worst: None, order: 1.0, work });
        }
        candidate
    }

    #[test]
    fn pilots_are_refined_step_by_step() {
        let grid = Method::Leapfrog { cells: 1000, cfl: 1.0 };
        assert_eq!(candidate(grid, &[]).next().cells(), Some(128));
        assert_eq!(candidate(grid, &[(0.1, 1), (0.1, 1)]).next().cells(), Some(512));
        let fronts = Method::FrontTracking { front_tolerance: 1e-3, event_budget: 9 };
        let next = candidate(fronts, &[(0.1, 1)]).next();
        // The expected time decides, not the default of `max-events`.
        assert!(matches!(next, Method::FrontTracking { front_tolerance, event_budget: 400_000_000 }
            if (front_tolerance - 0.1 / 3.0).abs() < 1e-15));
    }

    #[test]
    fn estimates_that_hardly_fall_are_carried_on_as_slowly() {
        let grid = Method::Leapfrog { cells: 1000, cfl: 1.0 };
        // The order is first one, then one half.
        assert!(
            (candidate(grid, &[(0.1, 1), (0.05, 1)]).order(&candidate(grid, &[(0.1, 1)]).pilots[0]) - 1.0).abs()
                < 1e-12
        );
        let slow = candidate(grid, &[(0.1, 1), (0.1 / 2_f64.sqrt(), 1)]);
        assert!((slow.order(&slow.pilots[1]) - 0.5).abs() < 1e-12);
        let stuck = candidate(grid, &[(0.1, 1), (0.2, 1)]);
        assert_eq!(stuck.order(&stuck.pilots[1]), LOWEST_ORDER);
    }

    #[test]
    fn a_grid_that_more_cells_do_not_help_is_out() {
        let out = |method: Method, estimates: &[f64]| {
            let mut candidate = Candidate::new(method);
            for &estimate in estimates {
                let method = candidate.next();
                let cells = method.cells().unwrap_or(0);
                candidate.add(Pilot { method, cells, estimate, worst: None, order: 1.0, work: 1 }, 1e-2);
            }
            candidate.out
        };
        let grid = Method::Leapfrog { cells: 1000, cfl: 1.0 };
        assert_eq!(out(grid, &[0.1, 0.05, 0.03, 0.02, 0.012, 0.012, 0.012, 0.012]), None);
        let why = out(grid, &[0.1, 0.05, 0.03, 0.02, 0.012, 0.012, 0.012, 0.012, 0.012]).expect("a reason");
        assert_eq!(why, "its error hardly falls with more cells (1.2e-2 with 2048, 1.2e-2 with 32768)");
        // An estimate below the tolerance that was later refuted does not count, and numbers of fronts vary at random.
        assert_eq!(out(grid, &[0.1, 0.009, 0.012, 0.011, 0.011, 0.0105]), None);
        let fronts = Method::FrontTracking { front_tolerance: 1e-3, event_budget: 9 };
        assert_eq!(out(fronts, &[0.1; 6]), None);
    }

    #[test]
    fn events_that_grow_fast_are_expected_to_do_so() {
        let fronts = Method::FrontTracking { front_tolerance: 1e-3, event_budget: 9 };
        let growth =
            |works: &[u64]| candidate(fronts, &works.iter().map(|&work| (0.1, work)).collect::<Vec<_>>()).growth();
        assert_eq!([growth(&[]), growth(&[1000]), growth(&[1000, 500])], [1.0; 3]);
        assert!((growth(&[1000, 9000]) - 2.0).abs() < 1e-12);
        assert_eq!(growth(&[1000, 900_000]), 3.0);
        assert_eq!(candidate(Method::CharacteristicNet { cells: 128 }, &[(0.1, 1), (0.1, 9)]).growth(), 2.0);
    }

    #[test]
    fn what_takes_longer_than_the_longest_run_is_out_of_reach() {
        let scene = Scene::pulled();
        let mut grid = candidate(Method::Leapfrog { cells: 1000, cfl: 1.0 }, &[(0.1, 100_000), (0.05, 400_000)]);
        // First order: 1e6 times the cells are needed, but the next pilot is too short for a conclusion.
        grid.check_reach(&scene, 1e-8);
        assert_eq!(grid.out, None);
        grid.pilots[0].work = 4_000_000_000;
        grid.pilots[1].work = 16_000_000_000;
        grid.check_reach(&scene, 1e-2);
        assert_eq!(grid.out, None);
        grid.check_reach(&scene, 1e-3);
        let why = grid.out.as_deref().expect("out");
        assert!(why.starts_with("about 1e4 cells would be needed, nominally 1e5 s"), "{why}");
        // The last pilot takes 32 s, and ten times the cells take an hour.
        let least = grid.within_reach(&scene).expect("pilots");
        assert!((least / 0.05 - (32.0_f64 / 3600.0).sqrt()).abs() < 1e-9, "{least}");
    }

    #[test]
    fn cells_are_refined_to_multiples_of_four() {
        assert_eq!(refined(Method::CharacteristicNet { cells: 128 }, 1.3).cells(), Some(168));
        assert_eq!(refined(Method::CharacteristicNet { cells: 128 }, 1.0).cells(), Some(128));
    }
}
