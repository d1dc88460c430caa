//! A stress over the bar at one time, or over time at one place, and how far two of them are apart.

/// A stress in Pa over an abscissa (m or s).
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Shape {
    /// Constant between edges: as front tracking and the self-similar solution have it.
    Steps {
        /// Increasing.
        edges: Vec<f64>,
        /// One more than edges; an edge belongs to the piece on its left.
        values: Vec<f64>,
        /// Where the first piece begins and the last one ends.
        ends: [f64; 2],
    },
    /// Known at points, increasing; straight between them and level outside.
    Points(Vec<(f64, f64)>),
}

impl Shape {
    /// Steps from the two rows that a history has for each of its steps.
    pub fn from_rows(time: &[f64], stress: &[f64]) -> Self {
        let (mut edges, mut values) = (Vec::new(), vec![stress.first().copied().unwrap_or(0.0)]);
        for k in 1..time.len() {
            if stress[k] != stress[k - 1] {
                edges.push(time[k]);
                values.push(stress[k]);
            }
        }
        let ends = [0.0, time.last().copied().unwrap_or(0.0)];
        Self::Steps { edges, values, ends }
    }

    /// Value at a place.
    pub fn at(&self, x: f64) -> f64 {
        match self {
            Self::Steps { edges, values, .. } => values[edges.partition_point(|&edge| edge < x)],
            Self::Points(points) => between(points, x),
        }
    }

    /// Integrals of |difference| and of the reference's magnitude. Points are read where they are, each for the stretch
    /// that it stands for; two rows of steps are integrated exactly.
    pub fn apart(&self, reference: &Self) -> (f64, f64) {
        let sum = |parts: &mut dyn Iterator<Item = (f64, f64)>| {
            parts.fold((0.0, 0.0), |(apart, total), (width, x)| {
                let expected = reference.at(x);
                (apart + width * (self.at(x) - expected).abs(), total + width * expected.abs())
            })
        };
        match (self, reference) {
            (Self::Points(points), _) | (_, Self::Points(points)) => {
                sum(&mut widths(points).into_iter().zip(points).map(|(width, point)| (width, point.0)))
            }
            (Self::Steps { edges, ends, .. }, Self::Steps { edges: other, .. }) => {
                let mut all: Vec<f64> = edges.iter().chain(other).chain(ends).copied().collect();
                all.retain(|x| (ends[0]..=ends[1]).contains(x));
                all.sort_by(f64::total_cmp);
                sum(&mut all.windows(2).map(|pair| (pair[1] - pair[0], 0.5 * (pair[0] + pair[1]))))
            }
        }
    }

    /// Relative L1 distance; none where the reference is nothing but zeros.
    pub fn distance(&self, reference: &Self) -> Option<f64> {
        let (apart, total) = self.apart(reference);
        (total > 0.0).then(|| apart / total)
    }
}

fn between(points: &[(f64, f64)], x: f64) -> f64 {
    let after = points.partition_point(|point| point.0 < x);
    match (after.checked_sub(1).map(|k| points[k]), points.get(after)) {
        (Some((x0, y0)), Some(&(x1, y1))) if x1 > x0 => y0 + (y1 - y0) * (x - x0) / (x1 - x0),
        (_, Some(&(_, y))) | (Some((_, y)), None) => y,
        (None, None) => 0.0,
    }
}

/// The stretch that each point stands for: half-way to its neighbours, and as far out at the ends.
fn widths(points: &[(f64, f64)]) -> Vec<f64> {
    let last = points.len().saturating_sub(1);
    let gap = |k: usize| points[k + 1].0 - points[k].0;
    let width = |k: usize| match (k, last) {
        (_, 0) => 1.0,
        (0, _) => gap(0),
        (k, last) if k == last => gap(k - 1),
        (k, _) => 0.5 * (gap(k - 1) + gap(k)),
    };
    (0..points.len()).map(width).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn steps(edges: &[f64], values: &[f64]) -> Shape {
        Shape::Steps { edges: edges.to_vec(), values: values.to_vec(), ends: [0.0, 1.0] }
    }

    #[test]
    fn steps_are_compared_exactly() {
        // 2 on the first half against 2 on the first 0.6: 0.1 * 2 apart, over 1.2.
        let distance = steps(&[0.5], &[2.0, 0.0]).distance(&steps(&[0.6], &[2.0, 0.0]));
        assert!((distance.expect("not zero") - 0.2 / 1.2).abs() < 1e-15);
    }

    #[test]
    fn points_are_read_where_they_are() {
        let cells = |values: &[f64]| {
            Shape::Points(values.iter().enumerate().map(|(i, &v)| (0.125 + 0.25 * i as f64, v)).collect())
        };
        // A front on the border of two cells is met exactly.
        assert_eq!(cells(&[3.0, 3.0, 0.0, 0.0]).distance(&steps(&[0.5], &[3.0, 0.0])), Some(0.0));
        assert_eq!(cells(&[3.0, 3.0, 1.0, 0.0]).distance(&steps(&[0.5], &[3.0, 0.0])), Some(1.0 / 6.0));
        assert_eq!(cells(&[0.0, 1.0, 2.0, 3.0]).at(0.25), 0.5);
        assert_eq!(cells(&[0.0, 1.0, 2.0, 3.0]).at(-1.0), 0.0);
        assert_eq!(cells(&[0.0, 1.0, 2.0, 3.0]).at(9.0), 3.0);
    }

    #[test]
    fn nothing_is_no_measure() {
        assert_eq!(steps(&[], &[1.0]).distance(&steps(&[], &[0.0])), None);
    }

    #[test]
    fn a_history_with_two_rows_a_step_becomes_steps() {
        let shape = Shape::from_rows(&[0.0, 0.3, 0.3, 0.7, 0.7, 1.0], &[0.0, 0.0, 5.0, 5.0, 2.0, 2.0]);
        assert_eq!(shape, steps(&[0.3, 0.7], &[0.0, 5.0, 2.0]));
    }
}
