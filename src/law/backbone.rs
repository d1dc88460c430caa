//! Loading curves in stress units, in forms for fast evaluation by the kernels.
//!
//! A table is a function `y = g(z)` of z = E eps >= 0. It is linear between knots and never falls; its slopes dy/dz = `E_k/E` lie in 0..=1.
//! The first segment has slope exactly 1 up to the elastic limit, where g(z) is z itself.

use super::CHUNK;
use crate::material::{Beyond, Curve, SLOPE_ROUND_OFF};

/// A loading curve that a kernel can evaluate. `sign` has the sign of the loading (tension positive); only
/// [`TwoSided`] uses it.
pub trait Backbone: Send + Sync {
    /// Whether evaluation for many cells at once is faster than one by one.
    const AT_ONCE: bool = false;

    /// Returns g(z), Pa, for z >= 0.
    fn stress(&self, z: f64, sign: f64) -> f64;

    /// Returns [`Self::stress`] where it is below z, and a value >= z elsewhere.
    #[inline(always)]
    fn yielding_stress(&self, z: f64, sign: f64) -> f64 {
        self.stress(z, sign)
    }

    /// Writes [`Self::stress`] of neighbouring cells into `y`. All slices have the same length.
    #[inline(always)]
    fn stresses(&self, z: &[f64], sign: &[f64], y: &mut [f64]) {
        for ((y, z), sign) in y.iter_mut().zip(z).zip(sign) {
            *y = self.stress(*z, *sign);
        }
    }
}

/// One line of a table: `y = offset + slope * z` for z >= `start`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Line {
    /// z at which the line starts, Pa.
    pub start: f64,
    /// y at z = 0, Pa.
    pub offset: f64,
    /// dy/dz.
    pub slope: f64,
}

impl Line {
    #[inline(always)]
    fn at(self, z: f64) -> f64 {
        self.offset + self.slope * z
    }
}

/// A loading table: its lines in order, of which the last one is unbounded.
#[derive(Debug, Clone, PartialEq)]
pub struct Table {
    lines: Vec<Line>,
    end: f64,
}

/// Relative difference of slopes up to which two segments count as one line. The knots of tables computed from formulas lie that close to
/// their line, and any physical change of slope is far larger.
const SAME_SLOPE: f64 = 1e-12;

/// A chord of a table, with its distance from the table.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Chord {
    /// (z, y) at both ends, Pa.
    pub ends: [[f64; 2]; 2],
    /// Largest difference in stress between chord and table, Pa.
    pub distance: f64,
}

impl Chord {
    /// Returns the largest difference in stress divided by rho (velocity change)^2 of a wave that runs along the chord. `modulus` is that of the
    /// table, Pa.
    pub fn relative_distance(&self, modulus: f64) -> f64 {
        let [from, to] = self.ends;
        self.distance * modulus / ((to[1] - from[1]) * (to[0] - from[0]))
    }
}

/// Returns the slope of the line through two points (z, y).
fn slope(from: [f64; 2], to: [f64; 2]) -> f64 {
    (to[1] - from[1]) / (to[0] - from[0])
}

/// Returns the stress at z on the line through two points (z, y), Pa.
fn stress_on([from, to]: [[f64; 2]; 2], z: f64) -> f64 {
    from[1] + slope(from, to) * (z - from[0])
}

impl Table {
    /// Builds the table of a loading curve with elastic modulus `modulus` (Pa, >= every slope of the curve). Drops in
    /// stress are filled (see [`Curve::running_maximum`]), because a falling stress cannot travel as a wave.
    pub fn new(curve: &Curve, modulus: f64) -> Self {
        let curve = curve.running_maximum();
        let mut lines: Vec<Line> = Vec::with_capacity(curve.strain().len());
        for (k, slope) in curve.slopes().enumerate() {
            let relative = slope / modulus;
            let slope = if (relative - 1.0).abs() <= SLOPE_ROUND_OFF { 1.0 } else { relative.max(0.0) };
            if lines.last().is_some_and(|last| (last.slope - slope).abs() <= SAME_SLOPE) {
                continue;
            }
            // The strain of a knot on the elastic line is computed from its stress, so that both lines meet there exactly.
            let on_elastic_line = lines.len() == 1 && lines[0].slope == 1.0;
            let y = curve.stress()[k];
            let z = if on_elastic_line { y } else { modulus * curve.strain()[k] };
            lines.push(Line { start: z, offset: y - slope * z, slope });
        }
        if curve.beyond() != Beyond::Extend {
            let (z, y) = (modulus * curve.last_strain(), curve.stress()[curve.stress().len() - 1]);
            if lines.last().is_some_and(|last| last.slope > 0.0) {
                lines.push(Line { start: z, offset: y, slope: 0.0 });
            }
        }
        let end = match curve.beyond() {
            Beyond::Extend => f64::INFINITY,
            Beyond::Rupture | Beyond::Error => modulus * curve.last_strain(),
        };
        Self { lines, end }
    }

    /// Returns the lines, in order of `start`; at least one.
    pub fn lines(&self) -> &[Line] {
        &self.lines
    }

    /// Returns z of the last knot, Pa; infinite if the curve is extended.
    pub fn end(&self) -> f64 {
        self.end
    }

    /// Returns true if the last segment before the end of the data is parallel to the elastic line, or is the elastic line itself.
    pub fn ends_elastic(&self) -> bool {
        self.end.is_finite() && matches!(self.lines[..], [.., last, level] if last.slope == 1.0 && level.slope == 0.0)
    }

    /// Returns y at z >= 0, Pa.
    fn at(&self, z: f64) -> f64 {
        let k = self.lines.partition_point(|l| l.start <= z).max(1) - 1;
        self.lines[k].at(z)
    }

    /// Returns E times the plastic strain of a point that first loads to z, Pa; infinite if z is.
    pub fn plastic_strain(&self, z: f64) -> f64 {
        if z.is_finite() { z - self.at(z) } else { z }
    }

    /// Returns the end of the elastic line, Pa: 0 if the curve leaves it at the origin, infinite if it never leaves it.
    pub fn yield_stress(&self) -> f64 {
        if self.lines[0].slope < 1.0 { 0.0 } else { self.lines.get(1).map_or(f64::INFINITY, |l| l.start) }
    }

    /// Returns true if the hardening part consists of more than one line and slopes fall. Elastic-perfectly-plastic elements in parallel
    /// have such a curve; they differ from hardening along a single line.
    pub fn is_multilinear(&self) -> bool {
        self.lines.len() > 2 && self.is_concave()
    }

    /// Returns the chords of the concave hull that lie above the table by more than `scatter` times its stress. Loading waves that run along them
    /// are shocks.
    pub fn chords(&self, scatter: f64) -> Vec<Chord> {
        let mut knots: Vec<[f64; 2]> = self.lines.iter().map(|line| [line.start, line.at(line.start)]).collect();
        let last = self.lines[self.lines.len() - 1];
        if last.slope > 0.0 && last.start > 0.0 {
            knots.push([2.0 * last.start, last.at(2.0 * last.start)]);
        }
        let mut hull: Vec<usize> = Vec::new();
        for k in 0..knots.len() {
            while let [.., before, last] = hull[..]
                && slope(knots[before], knots[last]) <= slope(knots[last], knots[k])
            {
                hull.pop();
            }
            hull.push(k);
        }
        let chord = |from: usize, to: usize| {
            let ends = [knots[from], knots[to]];
            let below = knots[from + 1..to].iter().map(|&[z, y]| [stress_on(ends, z) - y, y]);
            let matters = below.clone().any(|[distance, stress]| distance > scatter * stress);
            matters.then(|| Chord { ends, distance: below.map(|[distance, _]| distance).fold(0.0, f64::max) })
        };
        hull.windows(2).filter_map(|pair| chord(pair[0], pair[1])).collect()
    }

    /// Returns chords from the origin to points of the table beyond yield, up to twice the strain of its last knot; the lengths form a geometric
    /// series with ratio sqrt(2). Empty if the table has no knots beyond the elastic line. Unloading shocks along the table run along such chords.
    pub fn chords_from_origin(&self) -> impl Iterator<Item = Chord> {
        let [first, last] = match self.lines[..] {
            [_, first, .., last] => [first.start, 2.0 * last.start],
            [_, only] => [only.start, 2.0 * only.start],
            _ => [0.0; 2],
        };
        let ends = std::iter::successors(Some(last), |end| Some(end / std::f64::consts::SQRT_2));
        ends.take_while(move |&end| end > first).map(|end| {
            let ends = [[0.0; 2], [end, self.at(end)]];
            let knots = self.lines.iter().take_while(|line| line.start < end);
            let above = knots.map(|line| line.at(line.start) - stress_on(ends, line.start));
            Chord { ends, distance: above.fold(0.0, f64::max) }
        })
    }

    /// Returns E times the plastic strains of first loading at the knots at which the slope increases, ascending, Pa.
    pub fn stiffenings(&self) -> impl Iterator<Item = f64> {
        let plastic = |line: &Line| line.start - line.at(line.start);
        self.lines.windows(2).filter(|w| w[1].slope > w[0].slope).map(move |w| plastic(&w[1]))
    }

    /// Returns E/c0 times the velocity change by which first loading reaches the first knot at which the slope increases, Pa; infinite if there is
    /// none.
    pub fn velocity_to_stiffening(&self) -> f64 {
        let mut velocity = 0.0;
        for pair in self.lines.windows(2) {
            velocity += pair[0].slope.max(0.0).sqrt() * (pair[1].start - pair[0].start);
            if pair[1].slope > pair[0].slope {
                return velocity;
            }
        }
        f64::INFINITY
    }

    /// Returns true if the slope never increases along the table. The table is then the minimum of its lines.
    pub fn is_concave(&self) -> bool {
        self.lines.windows(2).all(|w| w[1].slope <= w[0].slope)
    }
}

/// Concave table with few lines: g(z) is the minimum of the lines, without a table look-up. Holds `K` lines, padded by repetition; the first one is
/// the elastic line.
#[derive(Debug, Clone)]
pub struct Envelope<const K: usize> {
    offset: [f64; K],
    slope: [f64; K],
}

impl<const K: usize> Envelope<K> {
    /// Builds the envelope. Returns `None` if the table has more than `K` lines or is not concave.
    pub fn new(table: &Table) -> Option<Self> {
        let elastic = Line { start: 0.0, offset: 0.0, slope: 1.0 };
        let beyond = table.lines().iter().filter(|line| line.slope < 1.0);
        let lines: Vec<Line> = std::iter::once(elastic).chain(beyond.copied()).collect();
        if lines.len() > K || !table.is_concave() {
            return None;
        }
        let line = |k: usize| lines[k.min(lines.len() - 1)];
        Some(Self { offset: std::array::from_fn(|k| line(k).offset), slope: std::array::from_fn(|k| line(k).slope) })
    }
}

impl<const K: usize> Backbone for Envelope<K> {
    #[inline(always)]
    fn stress(&self, z: f64, _sign: f64) -> f64 {
        let mut y = self.offset[0] + self.slope[0] * z;
        for k in 1..K {
            let other = self.offset[k] + self.slope[k] * z;
            y = if other < y { other } else { y };
        }
        y
    }

    #[inline(always)]
    fn yielding_stress(&self, z: f64, _sign: f64) -> f64 {
        const { assert!(K > 1, "the elastic line and one beyond") };
        let mut y = self.offset[1] + self.slope[1] * z;
        for k in 2..K {
            let other = self.offset[k] + self.slope[k] * z;
            y = if other < y { other } else { y };
        }
        y
    }
}

/// Largest number of bins of an [`Indexed`] table. Only the bins in use occupy the cache.
const BINS: usize = 4096;

/// Table with many lines: a grid of bins over z with at most one knot each, so that one comparison selects the line.
///
/// The bin is given by the leading bits of the number `z + bias`: its exponent and the first bits of its mantissa.
/// Bins are thus evenly spaced near zero (below `bias`), and their width grows in proportion to z beyond, as the knot spacing of
/// stress-strain tables does. Finding the bin of a number costs an addition, a shift and a subtraction.
#[derive(Debug, Clone)]
pub struct Indexed {
    grid: BinGrid,
    lines: Vec<Line>,
    /// Index of the line at the start of each bin.
    line: Box<[u16; BINS]>,
    knot: Box<[f64; BINS]>,
    offset: Box<[f64; 2 * BINS]>,
    slope: Box<[f64; 2 * BINS]>,
}

/// Monotonic map from z >= 0 to a bin.
#[derive(Debug, Clone, Copy, PartialEq)]
struct BinGrid {
    bias: f64,
    shift: u32,
    first: u64,
    /// z from which on all values lie in the last bin.
    top: f64,
}

impl BinGrid {
    fn new(bias: f64, shift: u32, top: f64) -> Self {
        Self { bias, shift, first: bias.to_bits() >> shift, top }
    }

    #[inline(always)]
    fn bin(&self, z: f64) -> usize {
        let z = if z < self.top { z } else { self.top };
        (((z + self.bias).to_bits() >> self.shift) - self.first) as usize
    }

    /// Returns the grid with the fewest bins in which no two knots share a bin; knots ascend from 0. Returns `None` if this takes more than [`BINS`].
    fn for_knots(knots: &[f64]) -> Option<Self> {
        let top = knots[knots.len() - 1];
        let mut best: Option<Self> = None;
        for halvings in 0..40 {
            let bias = top * 0.5_f64.powi(halvings - 4);
            for bits in 0..=12 {
                let grid = Self::new(bias, 52 - bits, top);
                let fits = grid.bin(top) < BINS;
                let apart = knots.windows(2).all(|w| grid.bin(w[1]) > grid.bin(w[0]));
                if fits && apart && best.is_none_or(|b| grid.bin(top) < b.bin(top)) {
                    best = Some(grid);
                }
            }
        }
        best
    }
}

/// Index that finds which of many pieces contains z, independent of what the pieces are.
#[derive(Debug, Clone, PartialEq)]
pub struct PieceIndex {
    grid: BinGrid,
    /// For each bin, the piece at its start, and the start of the next piece if that lies in the bin (else infinite).
    bins: Vec<(u32, f64)>,
}

impl PieceIndex {
    /// Builds the index for pieces with these starts, which ascend from 0. Returns `None` if there is only one piece, or if the starts are so
    /// unevenly spaced that the grid would need more than 4096 bins.
    pub fn new(starts: &[f64]) -> Option<Self> {
        if starts.len() < 2 {
            return None;
        }
        let grid = BinGrid::for_knots(starts)?;
        let mut bins = vec![(0, f64::INFINITY); grid.bin(grid.top) + 1];
        let mut piece = 0;
        for (bin, entry) in bins.iter_mut().enumerate() {
            entry.0 = piece as u32;
            if piece + 1 < starts.len() && grid.bin(starts[piece + 1]) == bin {
                piece += 1;
                entry.1 = starts[piece];
            }
        }
        Some(Self { grid, bins })
    }

    /// Returns the piece at z; the first one for z < 0.
    #[inline(always)]
    pub fn find(&self, z: f64) -> u32 {
        let (piece, next) = self.bins[self.grid.bin(if z > 0.0 { z } else { 0.0 })];
        piece + u32::from(z >= next)
    }
}

impl Indexed {
    /// Builds the index. Returns `None` if the table has only one line, or if knots are so unevenly spaced that the grid would need more than 4096
    /// bins.
    pub fn new(table: &Table) -> Option<Self> {
        let lines = table.lines();
        if lines.len() < 2 {
            return None;
        }
        let knots: Vec<f64> = lines.iter().map(|line| line.start).collect();
        let grid = BinGrid::for_knots(&knots)?;
        let mut index = Self {
            grid,
            lines: lines.to_vec(),
            line: boxed(0),
            knot: boxed(f64::INFINITY),
            offset: boxed(0.0),
            slope: boxed(0.0),
        };
        let mut line = 0;
        for bin in 0..BINS {
            let before = line;
            index.line[bin] = before as u16;
            if line + 1 < lines.len() && grid.bin(lines[line + 1].start) == bin {
                line += 1;
                index.knot[bin] = lines[line].start;
            }
            for (side, k) in [before, line].into_iter().enumerate() {
                index.offset[2 * bin + side] = lines[k].offset;
                index.slope[2 * bin + side] = lines[k].slope;
            }
        }
        Some(index)
    }
}

/// Returns a boxed array filled with one value, allocated on the heap.
fn boxed<T: Copy, const N: usize>(value: T) -> Box<[T; N]> {
    vec![value; N].into_boxed_slice().try_into().unwrap_or_else(|_| Box::new([value; N]))
}

impl Indexed {
    /// Returns the index of the line at z.
    #[inline(always)]
    fn line_at(&self, z: f64) -> usize {
        let bin = self.grid.bin(z) & (BINS - 1);
        usize::from(self.line[bin]) + usize::from(z >= self.knot[bin])
    }
}

/// Largest number of lines that are evaluated one after the other for all cells at once. Beyond this number, finding the line of each
/// cell is faster.
const LINES_AT_ONCE: usize = 32;

impl Backbone for Indexed {
    const AT_ONCE: bool = true;

    /// Evaluates many cells at once. Neighbouring cells mostly lie on few lines: all lines between those of the smallest and the largest z are
    /// evaluated in order, for all cells side by side.
    #[inline(always)]
    fn stresses(&self, z: &[f64], sign: &[f64], y: &mut [f64]) {
        // Non-negative numbers are compared by their bits, for which compilers generate faster loops.
        let (mut least, mut largest) = (u64::MAX, 0);
        for z in z {
            least = least.min(z.to_bits());
            largest = largest.max(z.to_bits());
        }
        let (first, last) = (self.line_at(f64::from_bits(least)), self.line_at(f64::from_bits(largest)));
        if last > first + LINES_AT_ONCE {
            for ((y, z), sign) in y.iter_mut().zip(z).zip(sign) {
                *y = self.stress(*z, *sign);
            }
            return;
        }
        let line = self.lines[first];
        for (y, z) in y.iter_mut().zip(z) {
            *y = line.at(*z);
        }
        for line in &self.lines[first + 1..=last] {
            for (y, z) in y.iter_mut().zip(z) {
                let own = line.at(*z);
                *y = if *z >= line.start { own } else { *y };
            }
        }
    }

    #[inline(always)]
    fn stress(&self, z: f64, _sign: f64) -> f64 {
        let bin = self.grid.bin(z) & (BINS - 1);
        let entry = (2 * bin + usize::from(z >= self.knot[bin])) & (2 * BINS - 1);
        self.offset[entry] + self.slope[entry] * z
    }
}

/// Any table, evaluated by binary search. For tables that [`Indexed`] cannot hold.
#[derive(Debug, Clone)]
pub struct Searched(pub Table);

impl Backbone for Searched {
    #[inline]
    fn stress(&self, z: f64, _sign: f64) -> f64 {
        self.0.at(z)
    }
}

/// Different tables in tension and compression.
#[derive(Debug, Clone)]
pub struct TwoSided<B> {
    /// Table for a positive sign.
    pub tension: B,
    /// Table for a negative sign, in magnitudes.
    pub compression: B,
}

impl<B: Backbone> Backbone for TwoSided<B> {
    const AT_ONCE: bool = B::AT_ONCE;

    #[inline(always)]
    fn stresses(&self, z: &[f64], sign: &[f64], y: &mut [f64]) {
        let mut other = [0.0; CHUNK];
        let other = &mut other[..z.len()];
        self.tension.stresses(z, sign, y);
        self.compression.stresses(z, sign, other);
        for ((y, other), sign) in y.iter_mut().zip(other).zip(sign) {
            *y = if *sign < 0.0 { *other } else { *y };
        }
    }

    #[inline(always)]
    fn stress(&self, z: f64, sign: f64) -> f64 {
        let (tension, compression) = (self.tension.stress(z, sign), self.compression.stress(z, sign));
        if sign < 0.0 { compression } else { tension }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn power_law() -> Table {
        let (modulus, yield_strain) = (200e9, 1e-3_f64);
        let rows: Vec<(f64, f64)> = (0..60)
            .map(|k| yield_strain * 50.0_f64.powf(f64::from(k) / 59.0))
            .map(|e| (e, 200e6 * (e / yield_strain).powf(0.2)))
            .collect();
        Table::new(&Curve::new(&rows, Beyond::Extend).expect("rows rise"), modulus)
    }

    #[test]
    fn every_form_reads_the_same_table() {
        let table = power_law();
        let (indexed, searched) = (Indexed::new(&table).expect("fits"), Searched(table));
        for k in 0..20_000 {
            let z = 1.2e10 * f64::from(k) / 20_000.0;
            assert_eq!(indexed.stress(z, 1.0), searched.stress(z, 1.0), "z = {z}");
        }
        let short = Curve::new(&[(0.001, 200e6), (0.01, 400e6), (0.1, 500e6)], Beyond::Rupture).expect("rows rise");
        let short = Table::new(&short, 200e9);
        let envelope = Envelope::<4>::new(&short).expect("4 lines with the flat end");
        let searched = Searched(short);
        for k in 0..20_000 {
            let z = 4e10 * f64::from(k) / 20_000.0;
            // Neighbouring lines meet at their knot up to rounding, so the lowest may be the neighbour by an ulp or two.
            assert!((envelope.stress(z, 1.0) - searched.stress(z, 1.0)).abs() <= 4e-16 * 6e8, "z = {z}");
        }
    }

    #[test]
    fn the_elastic_line_returns_its_argument() {
        let table = power_law();
        let indexed = Indexed::new(&table).expect("fits");
        for k in 0..1000 {
            let z = 199_999_999.0 * f64::from(k) / 1000.0;
            assert_eq!(indexed.stress(z, 1.0), z);
        }
        assert!((table.yield_stress() - 200e6).abs() < 1e-6);
    }

    #[test]
    fn a_curve_that_stiffens_lies_below_chords_of_its_hull() {
        let chords = |rows: &[(f64, f64)], scatter: f64| {
            Table::new(&Curve::new(rows, Beyond::Rupture).expect("rows rise"), 200e9).chords(scatter)
        };
        assert!(power_law().chords(1e-12).is_empty() && chords(&[(0.001, 200e6)], 0.0).is_empty());
        // At (0.011, 210 MPa) the chord from (0.001, 200 MPa) to (0.021, 400 MPa) is at 300 MPa.
        let rows = [(0.001, 200e6), (0.011, 210e6), (0.021, 400e6)];
        let [Chord { ends: [from, to], .. }] = chords(&rows, 0.42)[..] else { panic!("one chord") };
        assert!((from[0] - 2e8).abs() < 1.0 && (to[0] - 4.2e9).abs() < 1.0 && (to[1] - 4e8).abs() < 1.0);
        assert!(chords(&rows, 0.43).is_empty());
    }

    #[test]
    fn nan_is_passed_on_without_panic() {
        assert!(Indexed::new(&power_law()).expect("fits").stress(f64::NAN, 1.0).is_nan());
    }
}
