//! How far the stresses of a run on a grid may be off: Richardson's extrapolation from runs of the same bar with a half and a
//! quarter of the cells. Those hold no recorders; they take a third of the run's stepping time.

use super::{Progress, Wish, companion};
use crate::assemble;
use crate::record::{ErrorFigure, Stepped};
use crate::scene::{Method, Scene, Solve};
use crate::solver::fd::{Grid, Quantity, SegmentGrid};

/// The figure, over what the extrapolation says. `docs/cost.md` has what was measured.
const SAFETY: f64 = 1.5;

/// Orders that are believed, at least, and at most: of elastic bars and of the net, and of grids with a strain rate. What
/// lies outside is chance.
const LOWEST: f64 = 0.5;
const SMOOTH: f64 = 2.0;
const RATE: f64 = 1.0;

/// Order of a grid whose bar has yielded, without a strain rate: that of a plastic front, which a grid spreads over the cube root
/// of its cells. It is assumed: what is seen between two grids is scattered by where fronts lie in their cells. Over fifteen
/// bars and 128 to 2048 cells the true error was 0.46 to 1.75 times the difference from half the cells, for which this order
/// says 1.7; the safety factor covers the rest.
const FRONTS: f64 = 2.0 / 3.0;
const SAFETY_OF_FRONTS: f64 = 1.1;

/// Steps that a quarter of the cells takes as one: profiles are compared after a multiple of so many.
const COMMON: usize = 4;

/// Cells below which nothing is halved.
const LEAST_CELLS: usize = 8;

/// Work between two calls of the progress function, cell-steps.
const WORK_BETWEEN_CALLS: usize = 4_000_000;

/// Stress over the cells of a bar at one time.
#[derive(Debug, Clone)]
pub(super) struct Profile {
    grid: Grid,
    stress: Vec<f64>,
    /// Nothing has yielded.
    elastic: bool,
    /// Steps times cells.
    pub work: u64,
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
}

impl Profile {
    /// Stress at a place of a segment. A straight line between two cells is what the mean of the two is: cells of a half
    /// and of the whole size agree in that however coarse both are. So the curvature counts, where both sides agree on it.
    fn at(&self, part: &SegmentGrid, x: f64) -> f64 {
        let last = part.cells.len() - 1;
        let place = ((x - part.x0) / part.dx - 0.5).clamp(0.0, last as f64);
        let left = (place.floor() as usize).min(last.saturating_sub(1));
        let weight = place - left as f64;
        let value = |k: usize| self.stress[part.cells.start + k.min(last)];
        let (here, next) = (value(left), value(left + 1));
        let straight = here + weight * (next - here);
        if left == 0 || left + 2 > last {
            return straight;
        }
        let bends = [value(left - 1) - 2.0 * here + next, here - 2.0 * next + value(left + 2)];
        let bend = if bends[0] * bends[1] > 0.0 { bends[0].abs().min(bends[1].abs()).copysign(bends[0]) } else { 0.0 };
        straight - 0.5 * weight * (1.0 - weight) * bend
    }
}

/// The last step up to `steps` at which coarser runs stand at the same time.
pub(super) fn common_step(steps: usize) -> usize {
    if steps < COMMON { steps } else { steps - steps % COMMON }
}

/// An estimate for the finest of three profiles of one time, each of half the cells of the one before.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Estimate {
    /// Relative L1 of stress, with the safety factor.
    pub value: f64,
    /// Order that was used.
    pub order: f64,
    /// It was seen between the runs; else assumed.
    pub seen: bool,
}

/// Extrapolates. Differences of 0 are no error at all: waves that are exact on every grid.
pub(super) fn extrapolate(scene: &Scene, method: Method, [fine, half, quarter]: [&Profile; 3]) -> Estimate {
    let (near, total) = fine.apart(half);
    let far = half.apart(quarter).0;
    match (method, scene.effects.rate) {
        _ if fine.elastic => estimate(near, far, total, SMOOTH),
        (Method::CharacteristicNet { .. }, _) => estimate(near, far, total, SMOOTH),
        (_, Some(_)) => estimate(near, far, total, RATE),
        (_, None) => {
            Estimate { value: extrapolated(near, total, FRONTS, SAFETY_OF_FRONTS), order: FRONTS, seen: false }
        }
    }
}

/// With the order seen between the runs, as far as it is believed.
fn estimate(near: f64, far: f64, total: f64, highest: f64) -> Estimate {
    let seen = (far / near).log2();
    let order = if seen.is_finite() { seen.clamp(LOWEST, highest) } else { highest };
    Estimate { value: extrapolated(near, total, order, SAFETY), order, seen: true }
}

fn extrapolated(near: f64, total: f64, order: f64, safety: f64) -> f64 {
    if near > 0.0 && total > 0.0 { safety * near / (2_f64.powf(order) - 1.0) / total } else { 0.0 }
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
        for _ in 0..burst.min(steps - bar.step()) {
            bar.advance();
        }
        if progress(Progress::Steps { step: bar.step(), steps, cells }) == Wish::Stop {
            return None;
        }
    }
    Some(Profile::of(&bar))
}

/// How far the stresses of a run may be off whose profile at `time` (s) is `fine`. None where there are too few cells, or
/// the caller asked to stop.
pub(super) fn error_figure(
    scene: &Scene,
    fine: &Profile,
    time: f64,
    progress: &mut dyn FnMut(Progress) -> Wish,
) -> Option<ErrorFigure> {
    let method = scene.solve.method;
    let cells = method.cells()?;
    if cells < LEAST_CELLS {
        return None;
    }
    let half = profile(scene, method.with_cells(cells / 2), time, progress)?;
    let quarter = profile(scene, method.with_cells(cells / 4), time, progress)?;
    let found = extrapolate(scene, method, [fine, &half, &quarter]);
    let (how, safety) =
        if found.seen { ("seen between them", SAFETY) } else { ("of plastic fronts", SAFETY_OF_FRONTS) };
    let reference = format!(
        "runs with {} and {} cells: Richardson's extrapolation with the order {:.2} {how}, times {safety}: an estimate",
        half.grid.cells(),
        quarter.grid.cells(),
        found.order
    );
    Some(ErrorFigure { value: found.value, measure: companion::MEASURE.into(), reference })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn errors_of_a_known_order_are_found_again() {
        for order in [0.6, 1.0, 1.7] {
            // Errors 1, 2^p and 4^p of one sign.
            let step = |k: f64| 2_f64.powf(k * order);
            let found = estimate(step(1.0) - 1.0, step(2.0) - step(1.0), 10.0, SMOOTH);
            assert!((found.order - order).abs() < 1e-12);
            assert!((found.value - 0.1 * SAFETY).abs() < 1e-12);
        }
    }

    #[test]
    fn no_difference_is_no_error_and_orders_by_chance_are_not_believed() {
        assert_eq!(estimate(0.0, 0.0, 1.0, SMOOTH).value, 0.0);
        assert_eq!(estimate(0.0, 1.0, 1.0, SMOOTH).value, 0.0);
        assert_eq!(estimate(1.0, 0.9, 1.0, SMOOTH).order, LOWEST);
        assert_eq!(estimate(1.0, 100.0, 1.0, SMOOTH).order, SMOOTH);
        assert_eq!(estimate(1.0, 100.0, 1.0, RATE).order, RATE);
    }

    #[test]
    fn means_over_cells_are_no_values_at_their_centres() {
        // Cells that hold the mean of a parabola, as the leapfrog of an elastic bar does: the error of each at its centre is
        // a 24th of the square of its size, times 2.
        let profile = |cells: usize| {
            let h = 1.0 / cells as f64;
            let segments = vec![SegmentGrid { cells: 0..cells, x0: 0.0, dx: h }];
            let stress = (0..cells).map(|k| ((k as f64 + 0.5) * h).powi(2) + h * h / 12.0).collect();
            Profile { grid: Grid { segments, dt: 1.0 }, stress, elastic: true, work: 0 }
        };
        let (near, total) = profile(256).apart(&profile(128));
        let found = estimate(near, profile(128).apart(&profile(64)).0, total, SMOOTH);
        // Relative to the mean of 1/3; the cells at the ends have no bend.
        let truth = 3.0 / 12.0 / 256.0_f64.powi(2);
        assert!((found.order - 2.0).abs() < 0.05, "{}", found.order);
        assert!((found.value / SAFETY / truth - 1.0).abs() < 0.05, "{} {truth}", found.value / SAFETY);
    }

    #[test]
    fn a_front_between_cells_of_both_grids_makes_no_difference() {
        let profile = |cells: usize| {
            let segments = vec![SegmentGrid { cells: 0..cells, x0: 0.0, dx: 1.0 / cells as f64 }];
            let stress = (0..cells).map(|k| if 2 * k < cells { 7.0 } else { 0.0 }).collect();
            Profile { grid: Grid { segments, dt: 1.0 }, stress, elastic: true, work: 0 }
        };
        let (apart, total) = profile(40).apart(&profile(20));
        assert!(apart == 0.0 && (total - 3.5).abs() < 1e-12, "{apart} {total}");
        // Its middle cell lies on the front.
        assert!(profile(40).apart(&profile(5)).0 > 0.0);
        assert_eq!([3, 4, 11, 800].map(common_step), [3, 4, 8, 800]);
    }
}
