//! Contributions of strain intervals to the critical velocity.

use serde::Serialize;

use crate::material::{Beyond, Curve, Material, Sense};
use crate::wave::similarity;

/// Ends of the intervals beyond the elastic one, engineering strain.
const ENDS: [f64; 14] = [0.002, 0.005, 0.01, 0.02, 0.05, 0.1, 0.15, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8];

/// Smallest remainder of a truncated interval, relative to its full length, that is kept as an interval of its own.
const SHORT: f64 = 0.5;

/// Relative change of the stress for the finite differences. It is small because near the maximum the velocity depends on the stress like a square
/// root.
const CHANGE: f64 = 1e-3;
const PERCENT: f64 = 0.01;

/// Strain interval and its contribution to the critical velocity.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Interval {
    /// Engineering strain at the start of the interval.
    pub from: f64,
    /// Engineering strain at the end of the interval.
    pub to: f64,
    /// Sum of c d eps over the fronts within the interval, m/s. The contributions add up to the critical velocity.
    pub contribution_m_s: f64,
    /// Contribution relative to the critical velocity.
    pub share: f64,
    /// Derivative of the critical velocity with respect to the stress, m/s per 1 % of stress. The change of stress is largest in the middle of the
    /// interval and decreases linearly to zero at the middles of its neighbours. Central difference of changes by +0.1 % and -0.1 %.
    pub per_percent_of_stress_m_s: f64,
}

/// Returns the intervals of a curve up to its ultimate point; empty if there is no critical velocity. The first interval ends at the elastic limit.
pub fn sensitivity(material: &Material, sense: Sense) -> Vec<Interval> {
    let curve = material.branch(sense);
    let (Some(critical), Some(ultimate)) = (similarity::critical(curve, material.density), curve.ultimate()) else {
        return Vec::new();
    };
    let limit = curve.elastic_limit(material.modulus).0;
    let ends = ends(limit, ultimate.strain);
    let starts = std::iter::once(0.0).chain(ends.iter().copied());
    let intervals: Vec<(f64, f64)> = starts.zip(ends.iter().copied()).collect();
    let middles: Vec<f64> = intervals.iter().map(|(from, to)| 0.5 * (from + to)).collect();
    let fronts = similarity::hull(curve, material.density, ultimate.strain);
    let one = |(k, &(from, to)): (usize, &(f64, f64))| {
        let overlap = |front: &similarity::Edge| (front.strain_behind.min(to) - front.strain_ahead.max(from)).max(0.0);
        let contribution = fronts.iter().map(|front| front.speed * overlap(front)).sum::<f64>();
        let changed = |change: f64| {
            let raised = raised(curve, &middles, k, change)?;
            similarity::critical(&raised, material.density).map(|c| c.velocity)
        };
        let difference = changed(CHANGE)
            .zip(changed(-CHANGE))
            .map_or(f64::NAN, |(more, less)| 0.5 * (more - less) * PERCENT / CHANGE);
        Interval {
            from,
            to,
            contribution_m_s: contribution,
            share: contribution / critical.velocity,
            per_percent_of_stress_m_s: difference,
        }
    };
    intervals.iter().enumerate().map(one).collect()
}

/// Returns the ends of the intervals from the elastic limit to the ultimate strain. A short remainder of an interval between two of [`ENDS`] is
/// merged with its neighbour, because the sensitivity to an interval depends on its length.
fn ends(limit: f64, ultimate: f64) -> Vec<f64> {
    let last = ENDS[ENDS.len() - 1];
    let starts = std::iter::once(0.0).chain(ENDS);
    let nexts = ENDS.into_iter().skip(1).chain([2.0 * last]);
    let long = |from: f64, to: f64| ultimate.min(to) - limit.max(from) >= SHORT * (to - from);
    let kept = starts.zip(ENDS).zip(nexts).filter(|((start, end), next)| long(*start, *end) && long(*end, *next));
    let elastic = (limit > 0.0 && limit < ultimate).then_some(limit);
    elastic.into_iter().chain(kept.map(|((_, end), _)| end)).chain([ultimate]).collect()
}

/// Returns the curve with its stress increased around the middle of interval `k`. The weights of all intervals add up to 1.
fn raised(curve: &Curve, middles: &[f64], k: usize, change: f64) -> Option<Curve> {
    let mut strains: Vec<f64> = curve.strain().iter().copied().chain(middles.iter().copied()).collect();
    strains.sort_by(f64::total_cmp);
    strains.dedup();
    let rows: Vec<(f64, f64)> =
        strains.into_iter().map(|e| (e, curve.stress_at(e) * (1.0 + change * weight(middles, k, e)))).collect();
    // The ultimate point may move to the last row, where a curve that does not end by fracture has none.
    let beyond = if curve.beyond() == Beyond::Extend { Beyond::Extend } else { Beyond::Rupture };
    Curve::new(&rows, beyond).ok()
}

/// Returns the weight of interval `k` at a strain: 1 in its middle, 0 at the middles of its neighbours, linear in between. Outside the middles of the
/// first and of the last interval the weight is 1.
fn weight(middles: &[f64], k: usize, strain: f64) -> f64 {
    let middle = middles[k];
    let neighbour = if strain < middle { k.checked_sub(1).map(|j| middles[j]) } else { middles.get(k + 1).copied() };
    neighbour.map_or(1.0, |other| (1.0 - (strain - middle) / (other - middle)).max(0.0))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_interval_is_a_sliver() {
        assert_eq!(ends(0.0019, 0.1505), [0.0019, 0.005, 0.01, 0.02, 0.05, 0.1, 0.1505]);
        assert_eq!(ends(0.0005, 0.19), [0.0005, 0.002, 0.005, 0.01, 0.02, 0.05, 0.1, 0.15, 0.19]);
        assert_eq!(ends(0.0, 0.0006), [0.0006]);
        assert_eq!(ends(0.3, 0.3), [0.3]);
    }

    #[test]
    fn contributions_add_up_and_a_straight_curve_answers_in_closed_form() {
        let rows = [(0.001, 200e6), (0.1, 400e6)];
        let curve = Curve::new(&rows, Beyond::Rupture).expect("a curve");
        let material = Material::from_curve("bilinear", 8000.0, curve).expect("a material");
        let intervals = sensitivity(&material, Sense::Tension);
        let velocity = similarity::critical(&material.tension, 8000.0).expect("critical").velocity;
        let sum: f64 = intervals.iter().map(|i| i.contribution_m_s).sum();
        assert!((sum / velocity - 1.0).abs() < 1e-12);
        assert!((intervals[0].contribution_m_s - 200e6 / (8000.0 * 5000.0)).abs() < 1e-9);
        // 1 % everywhere raises the velocity by half a percent; what the hull cuts off between intervals is of second order.
        let all: f64 = intervals.iter().map(|i| i.per_percent_of_stress_m_s).sum();
        assert!((all / velocity / 0.005 - 1.0).abs() < 0.15, "{}", all / velocity);
    }
}
