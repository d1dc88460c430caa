//! How far the stresses of a run on a grid may be off: Richardson's extrapolation from runs of the same bar with a half, a
//! quarter and an eighth of the cells. Those hold no recorders; they take a third of the run's stepping time.

use serde::{Deserialize, Serialize};

use super::{Progress, Wish, companion};
use crate::assemble;
use crate::error::{Error, Result};
use crate::record::{ErrorFigure, Field, Stepped, View};
use crate::scene::{Method, Scene, Solve};
use crate::solver::fd::{Grid, Quantity, SegmentGrid};
use crate::solver::moc::FrontTracking;

/// The figure, over what the extrapolation says, where an order was seen. A kink (the corner of a ramp) is off by up to three
/// times its mean, which is what differences show, depending on where in a cell it lies.
const SAFETY: f64 = 3.0;

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
const SAFETY_OF_FRONTS: f64 = 1.25;

/// Steps that an eighth of the cells takes as one: profiles are compared after a multiple of so many.
const COMMON: usize = 8;

/// Cells on both sides of a pair that must be there for its curvature.
const BESIDE: usize = 2;

/// Cells below which nothing is halved.
const LEAST_CELLS: usize = 8;
/// Cells from which on an eighth of them is run too.
const LEAST_TO_CONFIRM: usize = 32;

/// Work between two calls of the progress function, cell-steps.
const WORK_BETWEEN_CALLS: usize = 4_000_000;

/// Stress over the cells of a bar at one time.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(super) struct Profile {
    grid: Grid,
    stress: Vec<f64>,
    /// Nothing has yielded.
    pub elastic: bool,
    /// Steps times cells.
    pub work: u64,
    /// s.
    pub time: f64,
}

impl Profile {
    pub fn of(bar: &impl Stepped) -> Self {
        let mut stress = vec![0.0; bar.grid().cells()];
        bar.profile(Quantity::Stress, &mut stress);
        Self {
            grid: bar.grid().clone(),
            stress,
            elastic: bar.stayed_elastic(),
            work: (bar.step() * bar.grid().cells()) as u64,
            time: bar.time(),
        }
    }

    /// Integrals over x of |difference from a coarser one|, read where that has its cells, and of its |stress|.
    fn apart(&self, coarser: &Self) -> (f64, f64) {
        let (mut apart, mut total) = (0.0, 0.0);
        for (own, part) in self.grid.segments.iter().zip(&coarser.grid.segments) {
            for cell in part.cells.clone() {
                let x = part.x0 + ((cell - part.cells.start) as f64 + 0.5) * part.dx;
                let fine = self.at(own, x);
                apart += (fine - coarser.stress[cell]).abs() * part.dx;
                total += fine.abs() * part.dx;
            }
        }
        (apart, total)
    }

    /// Relative L1 difference from a tracked bar of the same time, at the centres of the cells.
    pub fn apart_from_fronts(&self, bar: &FrontTracking) -> f64 {
        let mut tracked = vec![0.0; self.stress.len()];
        bar.sample(Field::Stress, &self.grid.centres(), &mut tracked);
        let (mut apart, mut total) = (0.0, 0.0);
        for part in &self.grid.segments {
            for cell in part.cells.clone() {
                apart += (self.stress[cell] - tracked[cell]).abs() * part.dx;
                total += tracked[cell].abs() * part.dx;
            }
        }
        if total > 0.0 { apart / total } else { 0.0 }
    }

    /// Stress at a place of a segment. A straight line between two cells is what the mean of the two is: cells of a half
    /// and of the whole size agree in that however coarse both are. So the curvature counts, that of kinks too, but not at a
    /// front, where it changes its sign from cell to cell.
    fn at(&self, part: &SegmentGrid, x: f64) -> f64 {
        let last = part.cells.len() - 1;
        let place = ((x - part.x0) / part.dx - 0.5).clamp(0.0, last as f64);
        let left = (place.floor() as usize).min(last.saturating_sub(1));
        let weight = place - left as f64;
        let value = |k: usize| self.stress[part.cells.start + k.min(last)];
        let (here, next) = (value(left), value(left + 1));
        let straight = here + weight * (next - here);
        if left < BESIDE || left + BESIDE + 1 > last {
            return straight;
        }
        let bend = |k: usize| value(k - 1) - 2.0 * value(k) + value(k + 1);
        let around = [left - 1, left, left + 1, left + 2].map(bend);
        if around.iter().any(|b| *b > 0.0) && around.iter().any(|b| *b < 0.0) {
            return straight;
        }
        straight - 0.25 * weight * (1.0 - weight) * (around[1] + around[2])
    }
}

/// The last step up to `steps` at which coarser runs stand at the same time.
pub(super) fn common_step(steps: usize) -> usize {
    if steps < COMMON { steps } else { steps - steps % COMMON }
}

/// An estimate for the finest of several profiles of one time, each of half the cells of the one before.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Estimate {
    /// Relative L1 of stress, with the safety factor.
    pub value: f64,
    /// Order that was used.
    pub order: f64,
    /// It was seen between the runs; else assumed.
    pub seen: bool,
    /// Order by which finer grids can be expected to be better: what was seen, or else the highest that is believed.
    pub hope: f64,
}

/// Extrapolates from three profiles or four, the finest one first. Differences of 0 are no error at all: waves that are exact
/// on every grid.
pub(super) fn extrapolate(scene: &Scene, method: Method, profiles: &[&Profile]) -> Estimate {
    let apart: Vec<(f64, f64)> = profiles.windows(2).map(|pair| pair[0].apart(pair[1])).collect();
    let differences: Vec<f64> = apart.iter().map(|a| a.0).collect();
    let total = apart.first().map_or(0.0, |a| a.1);
    let elastic = profiles.first().is_some_and(|p| p.elastic);
    let net = matches!(method, Method::CharacteristicNet { .. });
    let found = match scene.effects.rate {
        _ if elastic || net => estimate(&differences, SMOOTH),
        Some(_) => estimate(&differences, RATE),
        None => assumed(largest(&differences, 1.0), FRONTS),
    };
    Estimate { value: if total > 0.0 { found.value / total } else { 0.0 }, ..found }
}

/// With the order seen between the runs, where two in a row agree; else with that of fronts. `differences` are those of the
/// finest two, the next two, and so on, in what the value is to be in.
fn estimate(differences: &[f64], highest: f64) -> Estimate {
    let near = largest(differences, highest);
    let orders: Vec<f64> = differences.windows(2).map(|pair| (pair[1] / pair[0]).log2()).collect();
    match orders[..] {
        _ if near == 0.0 => Estimate { value: 0.0, order: highest, seen: true, hope: highest },
        [order, before, ..] if (order - before).abs() <= ALIKE && order >= LOWEST => {
            let order = order.min(highest);
            Estimate { value: SAFETY * remaining(near, order), order, seen: true, hope: order }
        }
        _ => assumed(near, highest),
    }
}

/// With the order of fronts.
fn assumed(near: f64, hope: f64) -> Estimate {
    Estimate { value: SAFETY_OF_FRONTS * remaining(near, FRONTS), order: FRONTS, seen: false, hope }
}

/// The difference of the finest two, or what the next one makes of it at the highest order, whichever is more: it can be small
/// by chance, where both grids are off by the same, but seldom twice.
fn largest(differences: &[f64], highest: f64) -> f64 {
    match *differences {
        [near, far, ..] => near.max(far * 2_f64.powf(-highest)),
        _ => differences.iter().sum(),
    }
}

/// What is left of an error of which `near` went by halving the cells.
fn remaining(near: f64, order: f64) -> f64 {
    near / (2_f64.powf(order) - 1.0)
}

/// Stress of a bar on a grid after about `time` (s), stepped without recorders; none where the caller asked to stop, or the
/// method has no grid. This is the one place where companions choose solvers.
pub(super) fn profile(
    scene: &Scene,
    method: Method,
    time: f64,
    progress: &mut dyn FnMut(Progress) -> Wish,
) -> Option<Profile> {
    let cut = Scene { solve: Solve { method, ..scene.solve.clone() }, ..scene.clone() }.in_pieces();
    let scene = cut.as_ref().unwrap_or(scene);
    match method {
        Method::Leapfrog { cells, cfl } => stepped(assemble::leapfrog(scene, cells, cfl), time, progress),
        Method::Muscl { cells, cfl } => stepped(assemble::muscl(scene, cells, cfl), time, progress),
        Method::CharacteristicNet { cells } => stepped(assemble::characteristic_net(scene, cells), time, progress),
        Method::FrontTracking { .. } => None,
    }
}

fn stepped<S: Stepped>(mut bar: S, time: f64, progress: &mut dyn FnMut(Progress) -> Wish) -> Option<Profile> {
    let cells = bar.grid().cells();
    let steps = (time / bar.grid().dt).round() as usize;
    let burst = (WORK_BETWEEN_CALLS / cells).max(1);
    while bar.step() < steps {
        bar.advance_by(burst.min(steps - bar.step()));
        if progress(Progress::Steps { step: bar.step(), steps, cells }) == Wish::Stop {
            return None;
        }
    }
    Some(Profile::of(&bar))
}

/// How far the stresses of a run may be off whose profile at `time` (s) is `fine`. None where there are too few cells.
///
/// # Errors
/// [`Error::Interrupted`] where the caller asked to stop.
pub(super) fn error_figure(
    scene: &Scene,
    fine: &Profile,
    time: f64,
    progress: &mut dyn FnMut(Progress) -> Wish,
) -> Result<Option<ErrorFigure>> {
    let method = scene.solve.method;
    let Some(cells) = method.cells().filter(|&cells| cells >= LEAST_CELLS) else { return Ok(None) };
    let parts: &[usize] = if cells < LEAST_TO_CONFIRM { &[2, 4] } else { &[2, 4, 8] };
    let mut coarser = Vec::new();
    for part in parts {
        let coarse = profile(scene, method.with_cells(cells / part), time, progress);
        coarser.push(coarse.ok_or(Error::Interrupted)?);
    }
    let all: Vec<&Profile> = std::iter::once(fine).chain(&coarser).collect();
    let found = extrapolate(scene, method, &all);
    let (how, safety) = if found.seen { ("seen between them", SAFETY) } else { ("of fronts", SAFETY_OF_FRONTS) };
    let cells: Vec<String> = coarser.iter().map(|profile| profile.grid.cells().to_string()).collect();
    let cells = match &cells[..] {
        [others @ .., last] => format!("{} and {last}", others.join(", ")),
        [] => String::new(),
    };
    let reference = format!(
        "runs with {cells} cells: Richardson's extrapolation with the order {:.2} {how}, times {safety}: an estimate",
        found.order
    );
    Ok(Some(ErrorFigure { value: found.value, measure: companion::MEASURE.into(), reference }))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn errors_of_a_known_order_are_found_again() {
        for order in [0.6, 1.0, 1.7] {
            // Errors 1, 2^p, 4^p and 8^p of one sign.
            let step = |k: f64| 2_f64.powf(k * order);
            let differences = [1.0, 2.0, 3.0].map(|k| step(k) - step(k - 1.0));
            let found = estimate(&differences, SMOOTH);
            assert!((found.order - order).abs() < 1e-12 && found.seen);
            assert!((found.value - SAFETY).abs() < 1e-12);
        }
    }

    #[test]
    fn no_difference_is_no_error_and_orders_by_chance_are_not_believed() {
        assert_eq!(estimate(&[0.0, 0.0, 0.0], SMOOTH).value, 0.0);
        // One order alone, two that differ, and two that are too low: that of fronts.
        for differences in [&[1.0, 4.0][..], &[1.0, 4.0, 6.0], &[1.0, 1.1, 1.2]] {
            let found = estimate(differences, SMOOTH);
            assert!(!found.seen && found.order == FRONTS, "{found:?}");
        }
        assert_eq!(estimate(&[1.0, 6.0, 36.0], SMOOTH).order, SMOOTH);
        assert_eq!(estimate(&[1.0, 6.0, 36.0], RATE).order, RATE);
    }

    #[test]
    fn two_grids_that_are_off_by_the_same_do_not_hide_it() {
        // Nothing between the finest two, but 0.4 before: no order above 2 makes less than 0.1 of that.
        assert_eq!(largest(&[0.0, 0.4, 0.5], SMOOTH), 0.1);
        assert_eq!(largest(&[0.0, 0.0, 1.6], SMOOTH), 0.0);
        assert!(estimate(&[0.0, 0.4, 0.5], SMOOTH).value > 0.1);
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
                let stress = (0..cells).map(|k| 0.5 * part(k) / h).collect();
                let segments = vec![SegmentGrid { cells: 0..cells, x0: 0.0, dx: h }];
                Profile { grid: Grid { segments, dt: 1.0 }, stress, elastic: true, work: 0, time: 1.0 }
            };
            let [fine, half, quarter, eighth] = [256, 128, 64, 32].map(profile);
            let differences = [fine.apart(&half).0, half.apart(&quarter).0, quarter.apart(&eighth).0];
            // At a cell's centre the mean is off by an eighth of the cell at most, over a cell.
            let most = 0.125 / 256.0_f64.powi(2);
            let found = estimate(&differences, SMOOTH);
            assert!(found.value >= most && found.value < 10.0 * most, "{corner}: {found:?} {most:e}");
        }
    }

    #[test]
    fn means_over_cells_are_no_values_at_their_centres() {
        // Cells that hold the mean of a parabola, as the leapfrog of an elastic bar does: the error of each at its centre is
        // a 24th of the square of its size, times 2.
        let profile = |cells: usize| {
            let h = 1.0 / cells as f64;
            let segments = vec![SegmentGrid { cells: 0..cells, x0: 0.0, dx: h }];
            let stress = (0..cells).map(|k| ((k as f64 + 0.5) * h).powi(2) + h * h / 12.0).collect();
            Profile { grid: Grid { segments, dt: 1.0 }, stress, elastic: true, work: 0, time: 1.0 }
        };
        let apart = |cells: usize| profile(cells).apart(&profile(cells / 2)).0;
        let found = estimate(&[256, 128, 64].map(apart), SMOOTH);
        // The cells at the ends have no bend.
        let truth = 1.0 / 12.0 / 256.0_f64.powi(2);
        assert!((found.order - 2.0).abs() < 0.05, "{}", found.order);
        assert!((found.value / SAFETY / truth - 1.0).abs() < 0.05, "{} {truth}", found.value / SAFETY);
    }

    #[test]
    fn a_front_between_cells_of_both_grids_makes_no_difference() {
        let profile = |cells: usize| {
            let segments = vec![SegmentGrid { cells: 0..cells, x0: 0.0, dx: 1.0 / cells as f64 }];
            let stress = (0..cells).map(|k| if 2 * k < cells { 7.0 } else { 0.0 }).collect();
            Profile { grid: Grid { segments, dt: 1.0 }, stress, elastic: true, work: 0, time: 1.0 }
        };
        let (apart, total) = profile(40).apart(&profile(20));
        assert!(apart == 0.0 && (total - 3.5).abs() < 1e-12, "{apart} {total}");
        // Its middle cell lies on the front.
        assert!(profile(40).apart(&profile(5)).0 > 0.0);
        assert_eq!([3, 8, 19, 800].map(common_step), [3, 8, 16, 800]);
    }
}
