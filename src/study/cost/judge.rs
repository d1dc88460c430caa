//! Evaluation of the points: observed orders, the Pareto front, and the cheapest method for each tolerance.

use serde::Serialize;

use super::candidates::SHOWN_ORDERS;
use super::{CostPoint, Resolution};

/// Tolerances of the cost summary.
pub const TOLERANCES: [f64; 4] = [1e-1, 1e-2, 1e-3, 1e-4];

/// Smallest ratio of the error of a point to the uncertainty of the reference for which the point is used for an order.
const CLEAR: f64 = 3.0;
/// Smallest order for which an error counts as decreasing.
const LEAST_ORDER: f64 = 0.01;
/// Largest difference from the finest local order for which a local order belongs to the asymptotic range.
const ALIKE: f64 = 0.35;
/// Most points of a fit.
const MOST_FITTED: usize = 5;

/// Value of [`CostToTolerance::how`] if the reference is too uncertain to decide on a tolerance.
const UNDECIDED: &str = "not decidable";

/// Observed order of convergence.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct OrderFit {
    /// "fd" or "moc".
    pub method: String,
    /// "leapfrog", ...
    pub scheme: String,
    /// Exponent p of error ~ cells^-p, or of error ~ tolerance^p.
    pub order: f64,
    /// "cells" or "`front_tolerance`".
    pub against: &'static str,
    /// Exponent q of error ~ time^-q over the same points; null if finer points took no longer.
    pub order_in_time: Option<f64>,
    /// Resolutions of the fitted points.
    pub fitted: Vec<f64>,
    /// How the points were chosen.
    pub how: String,
}

/// Cost at which a method reaches a tolerance.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct CostToTolerance {
    /// Tolerance.
    pub tolerance: f64,
    /// "fd" or "moc"; null if no method reaches the tolerance.
    pub method: Option<String>,
    /// "leapfrog", ...
    pub scheme: Option<String>,
    /// Cells, interpolated or those of the point.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub cells: Option<f64>,
    /// Front tolerance, interpolated or that of the point.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub front_tolerance: Option<f64>,
    /// Stepping time, s.
    pub step_wall_s: Option<f64>,
    /// "interpolated" between two points; "point" if the coarsest point or an exact one meets the tolerance; "not reached"; or "not decidable" if the
    /// reference is too uncertain.
    pub how: &'static str,
    /// Index of the first point of the refinement that meets the tolerance.
    pub point: Option<usize>,
    /// Error of that point.
    pub error: Option<f64>,
    /// Time of the whole run of that point, s.
    pub whole_wall_s: Option<f64>,
}

/// Returns the fineness of a point: the number of cells, or the reciprocal of the tolerance.
fn fineness(point: &CostPoint) -> f64 {
    match point.resolution() {
        Resolution::Cells(cells) => cells as f64,
        Resolution::FrontTolerance(tolerance) => 1.0 / tolerance,
    }
}

/// Returns the exponent a of y ~ x^a by least squares of logarithms, or `None` for fewer than two different x.
pub(super) fn exponent(points: &[(f64, f64)]) -> Option<f64> {
    let logs: Vec<(f64, f64)> =
        points.iter().filter(|p| p.0 > 0.0 && p.1 > 0.0).map(|p| (p.0.ln(), p.1.ln())).collect();
    let count = logs.len() as f64;
    let mean = logs.iter().fold((0.0, 0.0), |m, p| (m.0 + p.0 / count, m.1 + p.1 / count));
    let (mut xy, mut xx) = (0.0, 0.0);
    for (x, y) in &logs {
        xy += (x - mean.0) * (y - mean.1);
        xx += (x - mean.0) * (x - mean.0);
    }
    (xx > 0.0).then(|| xy / xx)
}

/// Returns the observed order of one method over the asymptotic range of its points, coarse to fine, or `None` if that range has fewer than two
/// points or the error does not decrease. `uncertainty` is that of the reference.
pub(super) fn order(points: &[&CostPoint], uncertainty: f64) -> Option<OrderFit> {
    let first = points.first()?;
    let clear: Vec<&CostPoint> = points
        .iter()
        .copied()
        .filter(|p| p.error > CLEAR * uncertainty && p.error > 0.0 && fineness(p).is_finite())
        .collect();
    let local =
        |k: usize| exponent(&[(fineness(clear[k]), clear[k].error), (fineness(clear[k + 1]), clear[k + 1].error)]);
    let last = local(clear.len().checked_sub(2)?)?;
    let mut from = clear.len() - 2;
    while from > 0 && clear.len() - from < MOST_FITTED && local(from - 1).is_some_and(|o| (o - last).abs() <= ALIKE) {
        from -= 1;
    }
    let fitted = &clear[from..];
    let by = |x: &dyn Fn(&CostPoint) -> f64| exponent(&fitted.iter().map(|p| (x(p), p.error)).collect::<Vec<_>>());
    let (against, value): (_, fn(&CostPoint) -> f64) = match first.resolution() {
        Resolution::Cells(_) => ("cells", fineness),
        Resolution::FrontTolerance(_) => ("front_tolerance", |p| 1.0 / fineness(p)),
    };
    let falls = |order: &f64| *order >= LEAST_ORDER;
    Some(OrderFit {
        method: first.by.method.clone(),
        scheme: first.by.scheme.clone(),
        order: by(&fineness).map(|exponent| -exponent).filter(falls)?,
        against,
        order_in_time: by(&|p| p.step_wall_s).map(|exponent| -exponent).filter(falls),
        fitted: fitted.iter().map(|p| value(p)).collect(),
        how: format!(
            "least squares of logarithms over the {} finest points whose error is more than {CLEAR} times the reference's \
             uncertainty and whose local orders differ from the finest one by at most {ALIKE}",
            fitted.len()
        ),
    })
}

/// Number of finest points of another method over which the error must stop decreasing before it contradicts a reference that is a run on a grid.
const STALLED: usize = 3;

/// Returns the uncertainty of a reference that is itself a run of family `own`, given the points of all families. `by_itself` is the estimate from
/// its own runs, `as_chosen` includes the contradictions by other candidates when it was chosen. The finest point of front tracking, or the nearest
/// finest point of the other grids if there is none, can reduce the latter, because it is finer than the candidates were. If the error of another
/// method stops decreasing, its remaining error contradicts the reference.
pub(super) fn uncertainty(points: &[Vec<CostPoint>], own: usize, [by_itself, as_chosen]: [f64; 2]) -> f64 {
    let others = || points.iter().enumerate().filter(|(family, _)| *family != own).map(|(_, points)| &points[..]);
    let finest = |tracks: bool| {
        let tracked = |point: &CostPoint| matches!(point.resolution(), Resolution::FrontTolerance(_));
        let of_kind = others().filter_map(<[CostPoint]>::last).filter(move |point| tracked(point) == tracks);
        of_kind.map(|point| point.error).reduce(f64::min)
    };
    let witness = finest(true).or_else(|| finest(false)).unwrap_or(f64::INFINITY);
    let left = others().filter_map(left_over).fold(by_itself, f64::max);
    left.max(as_chosen.min(witness))
}

/// Returns the error at which the points of a method stop decreasing, or `None` if it still decreases.
fn left_over(points: &[CostPoint]) -> Option<f64> {
    let finest = &points[points.len().checked_sub(STALLED)?..];
    let falls = |pair: &[CostPoint]| {
        let pair = [&pair[0], &pair[1]].map(|point| (fineness(point), point.error));
        exponent(&pair).is_none_or(|exponent| -exponent >= SHOWN_ORDERS[0])
    };
    (!finest.windows(2).any(falls)).then(|| finest.last().map_or(0.0, |point| point.error))
}

/// Returns for each point whether no other point is both faster and more accurate. Errors below the `uncertainty` of the reference count as equal to
/// it. Of points that are equal in both, the first counts.
pub(super) fn pareto(points: &[CostPoint], uncertainty: f64) -> Vec<bool> {
    let bound = |p: &CostPoint| p.error.max(uncertainty);
    let beats = |(i, a): (usize, &CostPoint), (j, b): (usize, &CostPoint)| {
        let no_worse = a.step_wall_s <= b.step_wall_s && bound(a) <= bound(b);
        let better = a.step_wall_s < b.step_wall_s || bound(a) < bound(b) || i < j;
        i != j && no_worse && better
    };
    let all = || points.iter().enumerate();
    all().map(|b| !all().any(|a| beats(a, b))).collect()
}

/// Returns the cost at which one method reaches a tolerance. `points` are its points, coarse to fine, with their indices. The `uncertainty` of the
/// reference is added to each error, because the reference may deviate in the same direction.
pub(super) fn reach(points: &[(usize, &CostPoint)], tolerance: f64, uncertainty: f64) -> CostToTolerance {
    let bound = |p: &CostPoint| p.error + uncertainty;
    let names = points.first().map(|(_, p)| (p.by.method.clone(), p.by.scheme.clone()));
    let (method, scheme) = names.unzip();
    // All finer points must meet the tolerance, too: a point that meets it by chance does not count.
    let Some(k) = (0..points.len()).find(|&k| points[k..].iter().all(|(_, p)| bound(p) <= tolerance)) else {
        let undecided = points.last().is_some_and(|(_, p)| p.error - uncertainty <= tolerance);
        return CostToTolerance {
            tolerance,
            method,
            scheme,
            cells: None,
            front_tolerance: None,
            step_wall_s: None,
            how: if undecided { UNDECIDED } else { "not reached" },
            point: None,
            error: None,
            whole_wall_s: None,
        };
    };
    let (index, found) = points[k];
    let before = k.checked_sub(1).map(|k| points[k].1);
    // Fraction of the logarithmic distance from the previous point. The cost of an exact point is not interpolated.
    let part = before
        .filter(|_| bound(found) > 0.0 && found.exact != Some(true))
        .map(|b| ((bound(b) / tolerance).ln() / (bound(b) / bound(found)).ln()).clamp(0.0, 1.0));
    let at = |value: &dyn Fn(&CostPoint) -> f64| match (part, before) {
        (Some(part), Some(b)) if value(b) > 0.0 && value(found) > 0.0 => {
            value(b) * (value(found) / value(b)).powf(part)
        }
        _ => value(found),
    };
    let fine = 1.0 / at(&|p| 1.0 / fineness(p));
    let is_cells = matches!(found.resolution(), Resolution::Cells(_));
    CostToTolerance {
        tolerance,
        method,
        scheme,
        cells: is_cells.then_some(fine),
        front_tolerance: (!is_cells).then(|| 1.0 / fine),
        step_wall_s: Some(at(&|p| p.step_wall_s)),
        how: if part.is_some() { "interpolated" } else { "point" },
        point: Some(index),
        error: Some(found.error),
        whole_wall_s: found.whole_wall_s,
    }
}

/// Returns the cheapest of all methods for a tolerance.
pub(super) fn cheapest(all: &[CostToTolerance], tolerance: f64) -> CostToTolerance {
    let reached = all.iter().filter(|r| r.tolerance == tolerance && r.step_wall_s.is_some());
    let time = |r: &CostToTolerance| r.step_wall_s.unwrap_or(f64::INFINITY);
    let best = reached.min_by(|a, b| time(a).total_cmp(&time(b)));
    let none = || {
        let undecided = all.iter().find(|r| r.tolerance == tolerance && r.how == UNDECIDED);
        let none = undecided.cloned().unwrap_or_else(|| reach(&[], tolerance, 0.0));
        CostToTolerance { method: None, scheme: None, ..none }
    };
    best.cloned().unwrap_or_else(none)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn point(cells: usize, error: f64, time: f64) -> CostPoint {
        CostPoint::plain("fd", Resolution::Cells(cells), error, time)
    }

    /// error = 20 n^-p beyond 400 cells, far larger before.
    fn refinement(p: f64) -> Vec<CostPoint> {
        let error = |n: usize| 20.0 * (n as f64).powf(-p) * if n < 400 { 3.0 } else { 1.0 };
        (0..6).map(|k| 100 << k).map(|n| point(n, error(n), 1e-8 * (n * n) as f64)).collect()
    }

    #[test]
    fn the_order_is_that_of_the_asymptotic_part() {
        let points = refinement(0.66);
        let all: Vec<_> = points.iter().collect();
        let fit = order(&all, 0.0).expect("there are points");
        assert!((fit.order - 0.66).abs() < 1e-12, "{}", fit.order);
        assert!((fit.order_in_time.expect("finer points take longer") - 0.33).abs() < 1e-12);
        assert_eq!(fit.fitted, [400.0, 800.0, 1600.0, 3200.0]);
    }

    #[test]
    fn points_near_the_reference_s_own_error_are_left_out_of_the_order() {
        let mut points = refinement(1.0);
        // The error of the finest point is masked by that of the reference.
        points[5].error = 0.0061;
        let all: Vec<_> = points.iter().collect();
        let fit = order(&all, 0.004).expect("there are points");
        assert!((fit.order - 1.0).abs() < 1e-12, "{}", fit.order);
        assert_eq!(*fit.fitted.last().expect("a point"), 1600.0);
        assert!(order(&all, 1.0).is_none());
    }

    #[test]
    fn an_error_that_does_not_fall_has_no_order() {
        for errors in [[1e-4, 1e-4, 1e-4], [1e-4, 2e-4, 5e-4]] {
            let points = [100, 200, 400].map(|n| point(n, 0.0, 1e-8 * (n * n) as f64));
            let points: Vec<_> = points.into_iter().zip(errors).map(|(p, error)| CostPoint { error, ..p }).collect();
            assert_eq!(order(&points.iter().collect::<Vec<_>>(), 1e-12), None, "{errors:?}");
        }
        // Finer points that took less time have an order in cells alone.
        let points = [point(100, 1e-2, 2e-3), point(200, 5e-3, 1e-3)];
        let fit = order(&points.iter().collect::<Vec<_>>(), 1e-12).expect("it falls");
        assert!((fit.order - 1.0).abs() < 1e-12 && fit.order_in_time.is_none(), "{fit:?}");
    }

    #[test]
    fn a_method_that_comes_to_an_end_elsewhere_contradicts_the_reference() {
        let of = |errors: &[f64]| -> Vec<CostPoint> {
            errors.iter().enumerate().map(|(k, &error)| point(100 << k, error, 1.0)).collect()
        };
        let own = of(&[1e-5, 1e-5, 1e-5]);
        let against = |errors: &[f64]| uncertainty(&[own.clone(), of(errors)], 0, [1e-7; 2]);
        assert_eq!(against(&[4e-4, 1e-4, 5e-5, 4.9e-5, 4.8e-5]), 4.8e-5);
        assert_eq!(against(&[4e-4, 2e-4, 1e-4]), 1e-7);
        assert_eq!(against(&[1e-4, 1e-4]), 1e-7);
        // A contradiction from the choice of the reference counts only as far as no finer run is closer to the reference.
        let chosen = |errors: &[f64]| uncertainty(&[own.clone(), of(errors)], 0, [1e-7, 1e-2]);
        assert_eq!(chosen(&[4e-3, 2e-4]), 2e-4);
        assert_eq!(chosen(&[4e-2]), 1e-2);
    }

    #[test]
    fn what_the_reference_cannot_tell_is_not_decidable_for_the_cheapest_either() {
        let points = [point(100, 0.1, 1.0), point(200, 0.0001, 4.0)];
        let all: Vec<_> = points.iter().enumerate().collect();
        let best = |tolerance, uncertainty| cheapest(&[reach(&all, tolerance, uncertainty)], tolerance);
        assert_eq!((best(1e-3, 1e-2).how, best(1e-3, 1e-2).scheme), ("not decidable", None));
        assert_eq!(best(1e-5, 1e-12).how, "not reached");
    }

    #[test]
    fn the_pareto_front_holds_what_nothing_beats() {
        let points =
            [point(1, 0.1, 1.0), point(2, 0.05, 2.0), point(3, 0.2, 1.5), point(4, 0.01, 2.0), point(5, 0.01, 2.0)];
        assert_eq!(pareto(&points, 0.0), [true, false, false, true, false]);
        // With an uncertainty of 0.07 of the reference, smaller errors are no improvement.
        assert_eq!(pareto(&points, 0.07), [true, true, false, false, false]);
    }

    #[test]
    fn a_tolerance_is_reached_between_two_points() {
        let points = [point(100, 0.1, 1.0), point(200, 0.05, 4.0), point(400, 0.025, 16.0)];
        let all: Vec<_> = points.iter().enumerate().collect();
        let found = reach(&all, 0.05 / 2_f64.sqrt(), 0.0);
        assert_eq!((found.how, found.point), ("interpolated", Some(2)));
        assert!((found.step_wall_s.expect("reached") - 8.0).abs() < 1e-12);
        assert!((found.cells.expect("a grid") - 200.0 * 2_f64.sqrt()).abs() < 1e-9);
        assert_eq!(reach(&all, 0.3, 0.0).how, "point");
        assert_eq!(reach(&all, 0.3, 0.0).step_wall_s, Some(1.0));
        assert_eq!(reach(&all, 0.01, 0.0).how, "not reached");
        // A tolerance below or just above the uncertainty of the reference is not decidable.
        assert_eq!(reach(&all, 0.03, 0.04).how, "not decidable");
        assert_eq!(reach(&all, 0.03, 0.01).how, "not decidable");
        assert_eq!(reach(&all, 0.01, 0.01).how, "not reached");
        assert_eq!(reach(&all, 0.04, 0.01).how, "interpolated");
    }

    #[test]
    fn a_point_that_meets_a_tolerance_by_chance_does_not_count() {
        let points = [point(100, 0.009, 1.0), point(200, 0.05, 4.0), point(400, 0.005, 16.0)];
        let all: Vec<_> = points.iter().enumerate().collect();
        assert_eq!(reach(&all, 0.01, 0.0).point, Some(2));
    }

    #[test]
    fn the_cheapest_is_the_one_in_the_shortest_time() {
        let slow = [point(100, 0.1, 1.0), point(200, 0.001, 4.0)];
        let quick =
            [CostPoint { exact: Some(true), ..CostPoint::plain("moc", Resolution::FrontTolerance(0.1), 0.0, 0.5) }];
        let reaches =
            [reach(&slow.iter().enumerate().collect::<Vec<_>>(), 0.01, 0.0), reach(&[(2, &quick[0])], 0.01, 1e-12)];
        let best = cheapest(&reaches, 0.01);
        assert_eq!((best.method.as_deref(), best.point, best.step_wall_s), (Some("moc"), Some(2), Some(0.5)));
        assert_eq!(cheapest(&reaches, 0.1).method, None);
    }
}
