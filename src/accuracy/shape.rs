//! Quantity over the bar at one time, or over time at one point, and the norm of the difference of two such quantities.

use serde::{Deserialize, Serialize};

use crate::solver::fd::SegmentGrid;

/// Quantity over an abscissa (m or s).
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub enum Shape {
    /// Piecewise constant, as in front tracking and in the self-similar solution.
    Steps {
        /// Edges of the pieces, increasing.
        edges: Vec<f64>,
        /// Values of the pieces, one more than edges; an edge belongs to the piece on its left.
        values: Vec<f64>,
        /// Start of the first piece and end of the last one.
        ends: [f64; 2],
    },
    /// Values at points (increasing), interpolated linearly and constant outside.
    Points(Vec<(f64, f64)>),
    /// Means over the cells of a bar.
    Cells(Cells),
}

/// Means over the cells of a bar.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Cells {
    /// Segments from left to right.
    pub segments: Vec<SegmentGrid>,
    /// Value of each cell.
    pub values: Vec<f64>,
}

/// Side from which a value is read where the quantity jumps.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Side {
    Before,
    After,
}

/// Number of cells on each side of a pair that are needed for the curvature between the two.
const BESIDE: usize = 2;

/// Relative difference of positions or times up to which they are equal: times are sums of steps, and two runs meet a
/// wave at the same time up to this.
const ROUNDING: f64 = 1e-9;

impl Shape {
    /// Creates steps from a history with two rows for each of its steps.
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

    /// Returns the value at a position.
    fn at(&self, x: f64, side: Side) -> f64 {
        match self {
            Self::Steps { edges, values, .. } => values[edges.partition_point(|&edge| side.is_past(edge, x))],
            Self::Points(points) => between(points, x, side),
            Self::Cells(cells) => cells.at(x),
        }
    }

    /// Interpolates cells linearly in time towards those of a later step, with weight `weight` of the latter. Other shapes are returned unchanged.
    #[must_use]
    pub fn towards(mut self, later: &Self, weight: f64) -> Self {
        if let (Self::Cells(cells), Self::Cells(later)) = (&mut self, later) {
            for (value, later) in cells.values.iter_mut().zip(&later.values) {
                *value += weight * (later - *value);
            }
        }
        self
    }

    /// Returns the largest magnitude.
    pub fn largest(&self) -> f64 {
        self.largest_between([f64::MIN, f64::MAX])
    }

    /// Returns the largest magnitude between two positions inside the shape; for cells and points, that of the cells and points between them.
    pub fn largest_between(&self, [from, to]: [f64; 2]) -> f64 {
        let within = |x: f64| (from..=to).contains(&x);
        let magnitudes: &mut dyn Iterator<Item = f64> = match self {
            Self::Steps { edges, values, .. } => {
                let [first, last] = [(from, Side::After), (to, Side::Before)]
                    .map(|(x, side)| edges.partition_point(|&edge| side.is_past(edge, x)));
                &mut values[first..=last.max(first)].iter().copied()
            }
            Self::Points(points) => &mut points.iter().filter(|point| within(point.0)).map(|point| point.1),
            Self::Cells(cells) => {
                &mut cells.parts().zip(&cells.values).filter(|((_, x), _)| within(*x)).map(|(_, &value)| value)
            }
        };
        magnitudes.fold(0.0, |most, value| most.max(value.abs()))
    }

    /// Returns the integrals of |difference| and of the reference's magnitude. Points are read at their positions (the
    /// second of two points at one position after the jump) and cells at their centres, each weighted with the interval
    /// that it represents. Two piecewise constant shapes are integrated exactly.
    pub fn l1_difference(&self, reference: &Self) -> (f64, f64) {
        let sum = |parts: &mut dyn Iterator<Item = (f64, f64, Side)>| {
            parts.fold((0.0, 0.0), |(apart, total), (width, x, side)| {
                let expected = reference.at(x, side);
                (apart + width * (self.at(x, side) - expected).abs(), total + width * expected.abs())
            })
        };
        let before = |(width, x)| (width, x, Side::Before);
        match (self, reference) {
            (Self::Cells(cells), _) | (Self::Steps { .. }, Self::Cells(cells)) => sum(&mut cells.parts().map(before)),
            (Self::Points(points), _) | (_, Self::Points(points)) => sum(&mut readings(points)),
            (Self::Steps { edges, ends, .. }, Self::Steps { edges: other, .. }) => {
                let mut all: Vec<f64> = edges.iter().chain(other).chain(ends).copied().collect();
                all.retain(|x| (ends[0]..=ends[1]).contains(x));
                all.sort_by(f64::total_cmp);
                sum(&mut all.windows(2).map(|pair| before((pair[1] - pair[0], 0.5 * (pair[0] + pair[1])))))
            }
        }
    }
}

impl Side {
    /// Returns true if what is at `place` precedes what is read at `x`.
    fn is_past(self, place: f64, x: f64) -> bool {
        match self {
            Self::Before => place < x - ROUNDING * x.abs(),
            Self::After => place <= x + ROUNDING * x.abs(),
        }
    }
}

impl Cells {
    /// Returns the size and centre of each cell, m.
    fn parts(&self) -> impl Iterator<Item = (f64, f64)> + '_ {
        self.segments.iter().flat_map(|part| {
            let centre = |cell: usize| part.x0 + ((cell - part.cells.start) as f64 + 0.5) * part.spacing;
            part.cells.clone().map(move |cell| (part.spacing, centre(cell)))
        })
    }

    /// Returns the value at a position. Linear interpolation midway between two cells equals their mean, so that a grid
    /// and one with half as many cells agree there however coarse both are. The curvature is therefore included, also
    /// at kinks, but not at a front, where it changes its sign from cell to cell.
    fn at(&self, x: f64) -> f64 {
        let segment = self.segments.partition_point(|part| part.x0 <= x).max(1) - 1;
        let part = &self.segments[segment];
        let last = part.cells.len() - 1;
        let place = ((x - part.x0) / part.spacing - 0.5).clamp(0.0, last as f64);
        // The value at a centre is read unchanged, whatever the rounding of its position.
        let place = if (place - place.round()).abs() < CENTRE { place.round() } else { place };
        let left = (place.floor() as usize).min(last.saturating_sub(1));
        let weight = place - left as f64;
        let value = |k: usize| self.values[part.cells.start + k.min(last)];
        let (here, next) = (value(left), value(left + 1));
        let straight = here + weight * (next - here);
        if weight == 0.0 || left < BESIDE || left + BESIDE + 1 > last {
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

/// Distance from the centre of a cell, in cells, up to which it is attributed to rounding.
const CENTRE: f64 = 1e-6;

fn between(points: &[(f64, f64)], x: f64, side: Side) -> f64 {
    let after = points.partition_point(|point| side.is_past(point.0, x));
    match (after.checked_sub(1).map(|k| points[k]), points.get(after)) {
        (Some((x0, y0)), Some(&(x1, y1))) if x1 > x0 => y0 + (y1 - y0) * ((x - x0) / (x1 - x0)).clamp(0.0, 1.0),
        (_, Some(&(_, y))) | (Some((_, y)), None) => y,
        (None, None) => 0.0,
    }
}

/// Returns the interval that each point represents, its position, and its side of a jump.
fn readings(points: &[(f64, f64)]) -> impl Iterator<Item = (f64, f64, Side)> + '_ {
    widths(points).into_iter().enumerate().map(|(k, width)| {
        let x = points[k].0;
        let second = k > 0 && !Side::Before.is_past(points[k - 1].0, x);
        (width, x, if second { Side::After } else { Side::Before })
    })
}

/// Returns the interval that each point represents: half-way to its neighbours, and equally far outwards at the ends.
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

    /// Returns the relative L1 distance; `None` if the reference is zero everywhere.
    fn distance(shape: &Shape, reference: &Shape) -> Option<f64> {
        let (apart, total) = shape.l1_difference(reference);
        (total > 0.0).then(|| apart / total)
    }

    fn steps(edges: &[f64], values: &[f64]) -> Shape {
        Shape::Steps { edges: edges.to_vec(), values: values.to_vec(), ends: [0.0, 1.0] }
    }

    fn cells(values: &[f64]) -> Shape {
        let count = values.len();
        let segments =
            vec![SegmentGrid { cells: 0..count, x0: 0.0, spacing: 1.0 / count as f64, dx: 1.0 / count as f64 }];
        Shape::Cells(Cells { segments, values: values.to_vec() })
    }

    #[test]
    fn steps_are_compared_exactly() {
        // 2 on the first half against 2 on the first 0.6: the difference is 0.1 * 2, relative to 1.2.
        let distance = distance(&steps(&[0.5], &[2.0, 0.0]), &steps(&[0.6], &[2.0, 0.0]));
        assert!((distance.expect("not zero") - 0.2 / 1.2).abs() < 1e-15);
    }

    #[test]
    fn points_and_cells_are_read_where_they_are() {
        let points = |values: &[f64]| {
            Shape::Points(values.iter().enumerate().map(|(i, &v)| (0.125 + 0.25 * i as f64, v)).collect())
        };
        // A front on the boundary between two cells is represented exactly.
        for shape in [points, cells] {
            assert_eq!(distance(&shape(&[3.0, 3.0, 0.0, 0.0]), &steps(&[0.5], &[3.0, 0.0])), Some(0.0));
            assert_eq!(distance(&shape(&[3.0, 3.0, 1.0, 0.0]), &steps(&[0.5], &[3.0, 0.0])), Some(1.0 / 6.0));
            assert_eq!(shape(&[0.0, 1.0, 2.0, 3.0]).at(0.25, Side::Before), 0.5);
            assert_eq!(shape(&[0.0, 1.0, 2.0, 3.0]).at(-1.0, Side::Before), 0.0);
            assert_eq!(shape(&[0.0, 1.0, 2.0, 3.0]).at(9.0, Side::Before), 3.0);
        }
    }

    #[test]
    fn a_jump_that_both_histories_have_is_no_difference() {
        // The wave arrives at 1 s, in the other history up to rounding; the value is 0 before it, and 5 and decreasing after it.
        let history = |count: usize, arrival: f64| {
            let before = (0..count).map(|k| (k as f64 / count as f64, 0.0));
            let behind = (0..=count).map(|k| (arrival + k as f64 / count as f64, 5.0 - k as f64 / count as f64));
            Shape::Points(before.chain([(arrival, 0.0)]).chain(behind).collect())
        };
        for arrival in [1.0 - 2e-16, 1.0, 1.0 + 2e-16] {
            let apart = history(10, 1.0).l1_difference(&history(40, arrival)).0;
            assert!(apart < 1e-14, "{arrival} {apart}");
            let apart = history(10, 1.0).l1_difference(&steps(&[arrival], &[0.0, 5.0])).0;
            assert!((apart - 0.55).abs() < 1e-14, "{arrival} {apart}");
        }
        assert!(history(10, 1.0).l1_difference(&history(40, 1.05)).0 > 0.2);
    }

    #[test]
    fn nothing_is_no_measure() {
        assert_eq!(distance(&steps(&[], &[1.0]), &steps(&[], &[0.0])), None);
    }

    #[test]
    fn a_history_with_two_rows_a_step_becomes_steps() {
        let shape = Shape::from_rows(&[0.0, 0.3, 0.3, 0.7, 0.7, 1.0], &[0.0, 0.0, 5.0, 5.0, 2.0, 2.0]);
        assert_eq!(shape, steps(&[0.3, 0.7], &[0.0, 5.0, 2.0]));
    }

    #[test]
    fn a_front_between_cells_of_both_grids_makes_no_difference() {
        let front =
            |count: usize| cells(&(0..count).map(|k| if 2 * k < count { 7.0 } else { 0.0 }).collect::<Vec<_>>());
        let (apart, total) = front(20).l1_difference(&front(40));
        assert!(apart == 0.0 && (total - 3.5).abs() < 1e-12, "{apart} {total}");
        // The middle cell of five lies on the front.
        assert!(front(5).l1_difference(&front(40)).0 > 0.0);
    }
}
