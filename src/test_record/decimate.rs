//! Reduction of a curve to the fewest knots within a tolerance.

/// Velocity difference that is neglected, relative to the largest velocity and to the tolerance: at the steep start and near the maximum no segment
/// is short enough for a relative criterion.
const VELOCITY_FLOOR: f64 = 0.02;

/// Returns knots whose connecting straight lines follow the curve (strain increasing). The stresses differ by at most `tolerance` times the largest
/// stress, and the velocity of each rising segment, the sum of sqrt(d stress d strain), by at most `tolerance` times itself. The first row, the
/// last one and the one of the largest stress are kept. Segments are split at the row farthest from them (Ramer 1972; Douglas and Peucker 1973).
pub(super) fn decimate(curve: &[(f64, f64)], tolerance: f64) -> Vec<(f64, f64)> {
    let Some(top) = (0..curve.len()).max_by(|a, b| curve[*a].1.total_cmp(&curve[*b].1)) else { return Vec::new() };
    let velocity = velocities(curve);
    let (stress_limit, velocity_floor) = (tolerance * curve[top].1, VELOCITY_FLOOR * tolerance * velocity[top]);
    let mut keep = vec![false; curve.len()];
    // The second row is the end of the elastic line.
    let second = 1.min(curve.len() - 1);
    for place in [0, second, top, curve.len() - 1] {
        keep[place] = true;
    }
    let mut open = vec![(second, top), (top, curve.len() - 1)];
    while let Some((from, to)) = open.pop() {
        let ((x, y), end) = (curve[from], curve[to]);
        let slope = (end.1 - y) / (end.0 - x);
        let off = |k: &usize| (curve[*k].1 - y - slope * (curve[*k].0 - x)).abs();
        let Some(farthest) = (from + 1..to).max_by(|a, b| off(a).total_cmp(&off(b))) else { continue };
        let pieces = velocity[to] - velocity[from];
        let lost = if to <= top { (piece(curve[from], end) - pieces).abs() } else { 0.0 };
        if off(&farthest) > stress_limit || lost > velocity_floor.max(tolerance * pieces) {
            keep[farthest] = true;
            open.extend([(from, farthest), (farthest, to)]);
        }
    }
    curve.iter().zip(keep).filter(|(_, keep)| *keep).map(|(row, _)| *row).collect()
}

/// Returns sqrt(d stress d strain): the velocity jump across a front times sqrt(density).
fn piece(from: (f64, f64), to: (f64, f64)) -> f64 {
    ((to.0 - from.0) * (to.1 - from.1)).max(0.0).sqrt()
}

fn velocities(curve: &[(f64, f64)]) -> Vec<f64> {
    let mut sums = vec![0.0];
    for pair in curve.windows(2) {
        sums.push(sums[sums.len() - 1] + piece(pair[0], pair[1]));
    }
    sums
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_curve_is_followed_within_the_tolerance() {
        let curve: Vec<(f64, f64)> = (0..=1000).map(|i| f64::from(i) / 1000.0).map(|x| (x, x * (1.6 - x))).collect();
        let knots = decimate(&curve, 1e-3);
        assert!(knots.len() < 40, "{}", knots.len());
        assert!(knots.contains(&(0.8, 0.8 * 0.8)));
        for &(x, y) in &curve {
            let k = knots.partition_point(|knot| knot.0 <= x).clamp(1, knots.len() - 1);
            let (a, b) = (knots[k - 1], knots[k]);
            assert!((a.1 + (b.1 - a.1) * (x - a.0) / (b.0 - a.0) - y).abs() <= 0.64e-3 * (1.0 + 1e-9));
        }
        let whole = velocities(&curve)[800];
        let rising: Vec<_> = knots.into_iter().filter(|knot| knot.0 <= 0.8).collect();
        assert!((velocities(&rising).last().expect("knots") / whole - 1.0).abs() < 1e-3);
    }
}
