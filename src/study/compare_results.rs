//! Comparison of result files: norms of their differences, and the positions of the largest differences.
//!
//! The common grid consists of the samples and frames of the first file that lie within the bars and times of both files. The other file is
//! interpolated to it linearly in x and in time. A front that moves between two frames is therefore smeared over both. Means over x weight each
//! sample with the length of its cell: the cells of segments of different materials are unequal.

use std::path::PathBuf;

use ndarray::Array2;
use serde::Serialize;

use crate::error::{InputError, Result};
use crate::record::store::{ResultFile, Side};
use crate::record::{Field, Trace};
use crate::units::{Dimension, System, format as with_unit};

/// Norm of a difference, absolute and relative to the norm of the first file.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize)]
pub struct Norm {
    /// Norm in the unit of the field.
    pub value: f64,
    /// Ratio to the same norm of the first file; `None` if that is 0.
    pub relative: Option<f64>,
}

impl Norm {
    fn of(value: f64, reference: f64) -> Self {
        Self { value, relative: (reference > 0.0).then(|| value / reference) }
    }
}

/// Norms of a difference: means over the length and over t (L1), root mean squares (L2) and largest values.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize)]
pub struct Norms {
    /// Mean of |b - a|.
    pub l1: Norm,
    /// Root of the mean of (b - a)^2.
    pub l2: Norm,
    /// Largest |b - a|.
    pub max: Norm,
}

/// Position and time of the largest difference of a field.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize)]
pub struct Place {
    /// Time, s.
    pub time_s: f64,
    /// Distance from the left end, m.
    pub x_m: f64,
    /// Value in the first file.
    pub first: f64,
    /// Value in the other file.
    pub other: f64,
}

/// Difference of one field.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct FieldDifference {
    /// Field that is compared.
    pub field: Field,
    /// SI unit of the field.
    pub units: &'static str,
    /// Norms over x and t.
    #[serde(flatten)]
    pub norms: Norms,
    /// Position and time of the largest difference.
    pub largest: Place,
    /// L2 norm over x at each common time: (time in s, norm in the unit of the field).
    #[serde(skip)]
    pub history: Vec<(f64, f64)>,
}

/// Difference of a stress history at a gauge or an end.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct TraceDifference {
    /// Name of the gauge, or "left end", "right end".
    pub name: String,
    /// Norms over time, Pa.
    #[serde(flatten)]
    pub norms: Norms,
    /// Time of the largest difference, s.
    pub largest_at_s: f64,
}

/// Differences of a file from the first one.
#[derive(Debug, Clone, Serialize)]
pub struct Difference {
    /// Path of the other file.
    pub file: PathBuf,
    /// Title of the other file.
    pub title: String,
    /// Common part of the bars, m.
    pub x_m: [f64; 2],
    /// Common range of times, s.
    pub time_s: [f64; 2],
    /// Numbers of samples and frames of the common grid.
    pub grid: [usize; 2],
    /// Differences of the fields that both files have.
    pub fields: Vec<FieldDifference>,
    /// Differences of the stress histories at gauges of the same name and position, and at the ends.
    pub histories: Vec<TraceDifference>,
    /// Notes on what is not compared, or only in part.
    pub notes: Vec<String>,
}

/// Samples, their cells, and frames of a file.
struct Grid {
    x: Vec<f64>,
    cells: Vec<[f64; 2]>,
    time: Vec<f64>,
}

impl Grid {
    fn of(file: &ResultFile) -> Result<Self> {
        let grid = Self { x: file.x()?, cells: file.bounds()?, time: file.time()? };
        if grid.x.is_empty() || grid.time.is_empty() {
            let message = format!("{} has nothing to compare: it has no frames", file.path().display());
            return Err(InputError::new(message).help("run its scene again").into());
        }
        Ok(grid)
    }

    /// Returns the ends of the bar, m.
    fn bar(&self) -> [f64; 2] {
        [self.cells[0][0], self.cells[self.cells.len() - 1][1]]
    }

    fn span(&self) -> [f64; 2] {
        [self.time[0], self.time[self.time.len() - 1]]
    }
}

/// Returns the rounding error of frame times up to `last` (s), which scenes may state in other units.
fn slack(last: f64) -> f64 {
    1e-9 * last.abs()
}

fn common(a: [f64; 2], b: [f64; 2]) -> [f64; 2] {
    [a[0].max(b[0]), a[1].min(b[1])]
}

/// Compares result files with the first one.
///
/// # Errors
/// A file has no bar or no frames, only some of the bars are in torsion, or the bars or times have no common part.
pub fn compare_results(files: &[ResultFile]) -> Result<Vec<Difference>> {
    files.iter().try_for_each(ResultFile::needs_bar)?;
    let Some((first, others)) = files.split_first() else { return Ok(Vec::new()) };
    if let Some(other) = others.iter().find(|other| other.is_in_torsion() != first.is_in_torsion()) {
        let kind = |file: &ResultFile| if file.is_in_torsion() { "in torsion" } else { "loaded along its axis" };
        let [a, b] = [first, other].map(|file| format!("{} is a bar {}", file.path().display(), kind(file)));
        let help = "compare results in torsion with each other; stresses and velocities of others are other quantities";
        return Err(InputError::new(format!("{a}, and {b}")).help(help).into());
    }
    others.iter().map(|other| difference(first, other)).collect()
}

fn difference(first: &ResultFile, other: &ResultFile) -> Result<Difference> {
    let (a, b) = (Grid::of(first)?, Grid::of(other)?);
    let (x_m, time_s) = (common(a.bar(), b.bar()), common(a.span(), b.span()));
    let slack = slack(a.span()[1]);
    let columns = Column::all(&a, x_m);
    let rows: Vec<usize> =
        (0..a.time.len()).filter(|&k| (time_s[0] - slack..=time_s[1] + slack).contains(&a.time[k])).collect();
    if columns.is_empty() || rows.is_empty() {
        let message = format!("{} and {} have no common x and t", first.path().display(), other.path().display());
        return Err(InputError::new(message).help("compare results of bars and times that overlap").into());
    }
    let shared: Vec<Field> = first.fields().into_iter().filter(|field| other.fields().contains(field)).collect();
    let mut comparison = Difference {
        file: other.path().to_owned(),
        title: other.metadata().title.clone(),
        x_m,
        time_s,
        grid: [columns.len(), rows.len()],
        fields: Vec::new(),
        histories: Vec::new(),
        notes: notes(first, other, [&a, &b]),
    };
    for field in shared {
        let values = |file: &ResultFile, grid: &Grid| file.field(field, 0..grid.time.len());
        comparison.fields.push(of_field(field, (&a, &values(first, &a)?), (&b, &values(other, &b)?), &rows, &columns));
    }
    comparison.histories = histories(first, other, time_s)?;
    Ok(comparison)
}

fn notes(first: &ResultFile, other: &ResultFile, [a, b]: [&Grid; 2]) -> Vec<String> {
    let mut notes = Vec::new();
    let differ = |p: [f64; 2], q: [f64; 2]| (0..2).any(|i| (p[i] - q[i]).abs() > 1e-9 * (p[1] - p[0]).abs());
    if differ(a.bar(), b.bar()) {
        let [p, q] = [a, b].map(|grid| with_unit(grid.bar()[1], Dimension::Length, System::Si));
        notes.push(format!("the bars end at {p} and {q}: only the common part is compared"));
    }
    if differ(a.span(), b.span()) {
        let shown = |time| with_unit(time, Dimension::Time, System::Si);
        let [[a0, a1], [b0, b1]] = [a, b].map(|grid| grid.span().map(shown));
        notes.push(format!(
            "the frames are from {a0} to {a1} and from {b0} to {b1}: only the common time is compared, also of gauges and ends"
        ));
    }
    let common = common(a.span(), b.span());
    let between = |time: &f64| (common[0]..common[1]).contains(time) && apart(*time, &b.time) > 1e-9 * common[1].abs();
    if a.time.iter().any(between) {
        notes.push(format!(
            "the frames are at other times: {} is interpolated between its frames, which smears fronts; record the same number of frames",
            other.path().display()
        ));
    }
    let names = |file: &ResultFile| file.fields().iter().map(|f| f.name().to_owned()).collect::<Vec<_>>();
    let alone = |own: &[String], others: &[String]| -> Vec<String> {
        own.iter().filter(|name| !others.contains(name)).cloned().collect()
    };
    for (own, others, file) in [(names(first), names(other), first), (names(other), names(first), other)] {
        let missing = alone(&own, &others);
        if !missing.is_empty() {
            notes.push(format!("only {} has {}", file.path().display(), missing.join(", ")));
        }
    }
    notes
}

/// Returns the distance of a value from the nearest value in an increasing list.
fn apart(value: f64, list: &[f64]) -> f64 {
    let next = list.partition_point(|&other| other < value);
    let near = list[next.saturating_sub(1)..(next + 1).min(list.len())].iter();
    near.map(|other| (other - value).abs()).fold(f64::INFINITY, f64::min)
}

/// Returns a field along the bar at `time` (s), which is interpolated linearly between frames as in comparisons.
///
/// # Errors
/// A time outside the range of the frames; a file that cannot be read.
pub fn profile_at(file: &ResultFile, field: Field, time: f64) -> Result<Vec<f64>> {
    let times = file.time()?;
    let [first, last] = [times.first(), times.last()].map(|end| end.copied().unwrap_or(f64::NAN));
    let slack = slack(last);
    if !(first - slack..=last + slack).contains(&time) {
        let error = InputError::new(format!("{time:e} s is not among the frames")).key("time");
        let allowed = format!("{first:e} s <= time <= {last:e} s");
        return Err(error.allowed(allowed).help("give a time from the first to the last frame").into());
    }
    let at = Between::of(&times, time);
    let frames = file.field(field, at.low..at.low + at.step + 1)?;
    let pair = frames.row(0).iter().zip(frames.row(at.step)).map(|(a, b)| at.mean(*a, *b)).collect();
    Ok(pair)
}

/// Weighted sums for the norms of the difference (index 0) and of the first file (index 1).
#[derive(Default)]
struct Sums {
    weight: f64,
    l1: [f64; 2],
    l2: [f64; 2],
    max: [f64; 2],
}

impl Sums {
    /// Adds a value of the first file and the difference of the other file from it.
    fn add(&mut self, weight: f64, value: f64, difference: f64) {
        self.weight += weight;
        for (k, size) in [difference.abs(), value.abs()].into_iter().enumerate() {
            self.l1[k] += weight * size;
            self.l2[k] += weight * size * size;
            self.max[k] = self.max[k].max(size);
        }
    }

    fn norms(&self) -> Norms {
        let mean = |sums: [f64; 2]| sums.map(|sum| sum / self.weight);
        let [l1, l2] = [mean(self.l1), mean(self.l2).map(f64::sqrt)];
        Norms { l1: Norm::of(l1[0], l1[1]), l2: Norm::of(l2[0], l2[1]), max: Norm::of(self.max[0], self.max[1]) }
    }
}

/// Sample of the first file that lies within the bars of both files.
struct Column {
    index: usize,
    /// Length of the common part of the bars in the cell of the sample, m.
    length: f64,
}

impl Column {
    /// Returns the samples of `grid` between the ends `bar` (m).
    fn all(grid: &Grid, bar: [f64; 2]) -> Vec<Self> {
        let inside = grid.x.iter().enumerate().filter(|(_, x)| (bar[0]..=bar[1]).contains(*x));
        let column = |(index, _)| {
            let [start, end] = common(grid.cells[index], bar);
            Self { index, length: end - start }
        };
        inside.map(column).collect()
    }
}

type Values<'a> = (&'a Grid, &'a Array2<f64>);

fn of_field(field: Field, a: Values<'_>, b: Values<'_>, rows: &[usize], columns: &[Column]) -> FieldDifference {
    let mut sums = Sums::default();
    let mut found = FieldDifference {
        field,
        units: field.units(),
        norms: Norms::default(),
        largest: Place::default(),
        history: Vec::with_capacity(rows.len()),
    };
    let across: Vec<Between> = columns.iter().map(|c| Between::of(&b.0.x, a.0.x[c.index])).collect();
    let mut most = -1.0;
    for &row in rows {
        let time = a.0.time[row];
        let along = Between::of(&b.0.time, time);
        let weight = step(&a.0.time, row, rows);
        let (mut squares, mut length) = (0.0, 0.0);
        for (column, across) in columns.iter().zip(&across) {
            let first = a.1[[row, column.index]];
            let at = |frame: usize| across.mean(b.1[[frame, across.low]], b.1[[frame, across.low + across.step]]);
            let other = along.mean(at(along.low), at(along.low + along.step));
            let difference = other - first;
            if !difference.is_finite() {
                continue;
            }
            sums.add(weight * column.length, first, difference);
            squares += column.length * difference * difference;
            length += column.length;
            if difference.abs() > most {
                most = difference.abs();
                found.largest = Place { time_s: time, x_m: a.0.x[column.index], first, other };
            }
        }
        if length > 0.0 {
            found.history.push((time, (squares / length).sqrt()));
        }
    }
    found.norms = sums.norms();
    found
}

/// Returns the weight of a frame in means over time (trapezoidal rule); 1 for a single frame.
fn step(time: &[f64], row: usize, rows: &[usize]) -> f64 {
    let (first, last) = (rows[0], rows[rows.len() - 1]);
    if first == last {
        return 1.0;
    }
    0.5 * (time[(row + 1).min(last)] - time[row.max(first + 1) - 1])
}

/// Position of a value between two neighbours in an increasing list.
struct Between {
    low: usize,
    /// Offset of the upper neighbour: 1, or 0 outside the range of the list.
    step: usize,
    part: f64,
}

impl Between {
    fn of(values: &[f64], target: f64) -> Self {
        let next = values.partition_point(|&value| value <= target);
        if next == 0 || next == values.len() {
            return Self { low: next.saturating_sub(1), step: 0, part: 0.0 };
        }
        let (a, b) = (values[next - 1], values[next]);
        Self { low: next - 1, step: 1, part: (target - a) / (b - a) }
    }

    fn mean(&self, a: f64, b: f64) -> f64 {
        a + self.part * (b - a)
    }
}

/// Compares the stress histories that both files have.
fn histories(first: &ResultFile, other: &ResultFile, span: [f64; 2]) -> Result<Vec<TraceDifference>> {
    let mut all = Vec::new();
    let others = other.gauges()?;
    for gauge in first.gauges()? {
        let same = others.iter().find(|own| own.name == gauge.name && (own.x - gauge.x).abs() <= 1e-9 * gauge.x.abs());
        all.extend(same.and_then(|own| of_traces(&gauge.name, &gauge.trace, &own.trace, span)));
    }
    for side in [Side::Left, Side::Right] {
        let name = format!("{} end", side.name());
        all.extend(of_traces(&name, &first.end(side)?, &other.end(side)?, span));
    }
    Ok(all)
}

/// Compares two stress histories at the midpoints between the times of both, so that jumps (two rows at one time) lie between the sampled times.
fn of_traces(name: &str, a: &Trace, b: &Trace, span: [f64; 2]) -> Option<TraceDifference> {
    let within = |t: &&f64| (span[0]..=span[1]).contains(*t);
    let mut times: Vec<f64> = a.time.iter().chain(&b.time).filter(within).copied().collect();
    times.sort_by(f64::total_cmp);
    times.dedup();
    let stress = |trace: &Trace, t: f64| {
        let along = Between::of(&trace.time, t);
        Some(along.mean(*trace.stress.get(along.low)?, *trace.stress.get(along.low + along.step)?))
    };
    let mut sums = Sums::default();
    let (mut most, mut when) = (-1.0, 0.0);
    for pair in times.windows(2) {
        let middle = 0.5 * (pair[0] + pair[1]);
        let (first, other) = (stress(a, middle)?, stress(b, middle)?);
        let difference = other - first;
        if !difference.is_finite() {
            continue;
        }
        sums.add(pair[1] - pair[0], first, difference);
        if difference.abs() > most {
            (most, when) = (difference.abs(), middle);
        }
    }
    (most >= 0.0).then(|| TraceDifference { name: name.to_owned(), norms: sums.norms(), largest_at_s: when })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_linear_field_on_another_grid_has_no_difference() {
        let grid = |cells: usize, frames: usize| Grid {
            x: (0..cells).map(|i| (i as f64 + 0.5) / cells as f64).collect(),
            cells: (0..cells).map(|i| [i, i + 1].map(|edge| edge as f64 / cells as f64)).collect(),
            time: (0..frames).map(|k| k as f64 / (frames - 1) as f64).collect(),
        };
        let field = |grid: &Grid, shift: f64| {
            let value = |(k, i): (usize, usize)| 2.0 * grid.x[i] - 3.0 * grid.time[k] + shift;
            Array2::from_shape_fn((grid.time.len(), grid.x.len()), value)
        };
        let (a, b) = (grid(10, 5), grid(40, 9));
        let (rows, columns): (Vec<_>, Vec<_>) = ((0..5).collect(), Column::all(&a, [0.0, 1.0]));
        let of = |shift: f64| of_field(Field::Stress, (&a, &field(&a, 0.0)), (&b, &field(&b, shift)), &rows, &columns);
        assert!(of(0.0).norms.max.value < 1e-12);
        let shifted = of(0.25);
        for norm in [shifted.norms.l1, shifted.norms.l2, shifted.norms.max] {
            assert!((norm.value - 0.25).abs() < 1e-12);
        }
        // The largest value of the field is -3 + 0.1 in the first cell at the end.
        assert!((shifted.norms.max.relative.expect("a field") - 0.25 / 2.9).abs() < 1e-12);
        assert_eq!(shifted.history.len(), 5);
    }
}
