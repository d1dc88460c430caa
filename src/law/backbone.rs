//! The loading curve in stress units, in forms for fast evaluation by the kernels.
//!
//! A table is `y = g(z)`, z = E eps >= 0, straight between knots, never falling, with slopes dy/dz = `E_k/E` in 0..=1.
//! The first segment has slope exactly 1 up to the elastic limit, so reading it there returns z itself.

use super::CHUNK;
use crate::material::{Beyond, Curve, SLOPE_ROUND_OFF};

/// A loading curve that a kernel can read. `sign` has the sign of the loading (tension positive); only
/// [`TwoSided`] looks at it.
pub trait Backbone: Send + Sync {
    /// Reading many at once is quicker than one by one.
    const AT_ONCE: bool = false;

    /// g(z), Pa, for z >= 0.
    fn stress(&self, z: f64, sign: f64) -> f64;

    /// [`Self::stress`] where it is below z; at least z elsewhere.
    #[inline(always)]
    fn yielding_stress(&self, z: f64, sign: f64) -> f64 {
        self.stress(z, sign)
    }

    /// [`Self::stress`] of neighbouring cells, into `y`; all of one length.
    #[inline(always)]
    fn stresses(&self, z: &[f64], sign: &[f64], y: &mut [f64]) {
        for ((y, z), sign) in y.iter_mut().zip(z).zip(sign) {
            *y = self.stress(*z, *sign);
        }
    }
}

/// One line of the table: `y = offset + slope * z` from `start` on.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Line {
    /// z from which it holds, Pa.
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

/// The table itself: its lines in order, the last one without end.
#[derive(Debug, Clone, PartialEq)]
pub struct Table {
    lines: Vec<Line>,
    end: f64,
}

/// Slopes closer than this (relative) are one line: knots of tables computed from formulas lie that close to
/// their line, and any physical change of slope is far larger.
const SAME_SLOPE: f64 = 1e-12;

/// A chord of a table.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Chord {
    /// (z, y) at both ends, Pa.
    pub ends: [[f64; 2]; 2],
    /// Largest difference in stress to the table between them, Pa.
    pub distance: f64,
}

impl Chord {
    /// Largest difference to the table over rho (change of velocity)^2 of a wave that runs along the chord, for the modulus of the table, Pa.
    pub fn relative_distance(&self, modulus: f64) -> f64 {
        let [from, to] = self.ends;
        self.distance * modulus / ((to[1] - from[1]) * (to[0] - from[0]))
    }
}

/// Slope of the line through two points (z, y).
fn slope(from: [f64; 2], to: [f64; 2]) -> f64 {
    (to[1] - from[1]) / (to[0] - from[0])
}

/// Stress at z of the line through two points (z, y), Pa.
fn stress_on([from, to]: [[f64; 2]; 2], z: f64) -> f64 {
    from[1] + slope(from, to) * (z - from[0])
}

impl Table {
    /// The table of a loading curve with elastic modulus `modulus` (Pa, >= every slope of the curve). Drops in
    /// stress are filled (see [`Curve::running_maximum`]): a falling stress cannot travel as a wave.
    pub fn new(curve: &Curve, modulus: f64) -> Self {
        let curve = curve.running_maximum();
        let mut lines: Vec<Line> = Vec::with_capacity(curve.strain().len());
        for (k, slope) in curve.slopes().enumerate() {
            let relative = slope / modulus;
            let slope = if (relative - 1.0).abs() <= SLOPE_ROUND_OFF { 1.0 } else { relative.max(0.0) };
            if lines.last().is_some_and(|last| (last.slope - slope).abs() <= SAME_SLOPE) {
                continue;
            }
            // On the elastic line a knot lies where its stress says, so that both lines meet there exactly.
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

    /// The lines, in order of `start`; at least one.
    pub fn lines(&self) -> &[Line] {
        &self.lines
    }

    /// z of the last knot, Pa; infinite where the curve goes on.
    pub fn end(&self) -> f64 {
        self.end
    }

    /// True where the curve comes to its last knot along a line parallel to the elastic one, or along that itself.
    pub fn ends_elastic(&self) -> bool {
        self.end.is_finite() && matches!(self.lines[..], [.., last, level] if last.slope == 1.0 && level.slope == 0.0)
    }

    /// y at z >= 0, Pa.
    fn at(&self, z: f64) -> f64 {
        let k = self.lines.partition_point(|l| l.start <= z).max(1) - 1;
        self.lines[k].at(z)
    }

    /// E times the plastic strain of a point that first loads to z, Pa; infinite where z is.
    pub fn plastic_strain(&self, z: f64) -> f64 {
        if z.is_finite() { z - self.at(z) } else { z }
    }

    /// End of the elastic line, Pa: 0 where the curve leaves it at once, infinite where it never does.
    pub fn yield_stress(&self) -> f64 {
        if self.lines[0].slope < 1.0 { 0.0 } else { self.lines.get(1).map_or(f64::INFINITY, |l| l.start) }
    }

    /// True where hardening runs along more than one line and slopes fall: elastic-perfectly-plastic elements in parallel
    /// have this curve, and differ from one line of hardening.
    pub fn is_multilinear(&self) -> bool {
        self.lines.len() > 2 && self.is_concave()
    }

    /// The chords of the concave hull under which the table lies by more than this part of its stress. Loading waves that run along them are
    /// shocks.
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

    /// Chords from the origin to points of the table beyond yield, up to twice the strain of its last knot, each sqrt(2) times as long as the one
    /// before; none without knots beyond the elastic line. Shocks of unloading along the table run along such chords.
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

    /// Plastic strains of first loading at the knots at which slopes grow, times E, ascending, Pa.
    pub fn stiffenings(&self) -> impl Iterator<Item = f64> {
        let plastic = |line: &Line| line.start - line.at(line.start);
        self.lines.windows(2).filter(|w| w[1].slope > w[0].slope).map(move |w| plastic(&w[1]))
    }

    /// E times the change of velocity, over c0, by which first loading comes to the first knot at which slopes grow, Pa; infinite without one.
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

    /// True where slopes never grow along the table: it is then the lowest of its lines.
    pub fn is_concave(&self) -> bool {
        self.lines.windows(2).all(|w| w[1].slope <= w[0].slope)
    }
}

/// Few lines of a concave table: g(z) is the lowest of them; no look-up at all. `K` lines, padded by repetition; the first one is the elastic
/// line.
#[derive(Debug, Clone)]
pub struct Envelope<const K: usize> {
    offset: [f64; K],
    slope: [f64; K],
}

impl<const K: usize> Envelope<K> {
    /// None where the table has more than `K` lines or is not concave.
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

/// Most bins that an [`Indexed`] table may use. Only those it does use take part in the cache.
const BINS: usize = 4096;

/// Many lines: a grid of bins over z, no more than one knot in each, so that one comparison picks the line.
///
/// The bin is read off the leading bits of the number `z + bias`: its exponent and the first bits of its mantissa.
/// Bins are thus evenly spaced near zero (below `bias`) and grow in proportion to z beyond, as the knots of
/// stress-strain tables do; and the bin of a number costs an addition, a shift and a subtraction.
#[derive(Debug, Clone)]
pub struct Indexed {
    grid: BinGrid,
    lines: Vec<Line>,
    /// Number of the line with which a bin begins.
    line: Box<[u16; BINS]>,
    knot: Box<[f64; BINS]>,
    offset: Box<[f64; 2 * BINS]>,
    slope: Box<[f64; 2 * BINS]>,
}

/// Maps z >= 0 to a bin, never falling.
#[derive(Debug, Clone, Copy, PartialEq)]
struct BinGrid {
    bias: f64,
    shift: u32,
    first: u64,
    /// z from which everything is in the last bin.
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

    /// The grid with the fewest bins that keeps all knots apart, which rise from 0; none where that takes more than [`BINS`].
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

/// Which of many pieces holds at z, where nothing else has to be known of them.
#[derive(Debug, Clone, PartialEq)]
pub struct PieceIndex {
    grid: BinGrid,
    /// The piece with which a bin begins, and where the next one starts if it starts in it.
    bins: Vec<(u32, f64)>,
}

impl PieceIndex {
    /// Of pieces that start at these places, which rise from 0; none where there is only one, or they lie so unevenly that the grid would
    /// need more than 4096 bins.
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

    /// The piece at z; the first one below 0.
    #[inline(always)]
    pub fn find(&self, z: f64) -> u32 {
        let (piece, next) = self.bins[self.grid.bin(if z > 0.0 { z } else { 0.0 })];
        piece + u32::from(z >= next)
    }
}

impl Indexed {
    /// None where knots lie so unevenly that the grid would need more than 4096 bins.
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

/// A boxed array of one value, made on the heap.
fn boxed<T: Copy, const N: usize>(value: T) -> Box<[T; N]> {
    vec![value; N].into_boxed_slice().try_into().unwrap_or_else(|_| Box::new([value; N]))
}

impl Indexed {
    /// The line that holds at z.
    #[inline(always)]
    fn line_at(&self, z: f64) -> usize {
        let bin = self.grid.bin(z) & (BINS - 1);
        usize::from(self.line[bin]) + usize::from(z >= self.knot[bin])
    }
}

/// Reading all lines between two, one after the other for many cells, costs more than finding each cell's own beyond this
/// number.
const LINES_AT_ONCE: usize = 32;

impl Backbone for Indexed {
    const AT_ONCE: bool = true;

    /// Neighbouring cells mostly lie on few lines: those between the lines of the least and the largest z are gone through in
    /// order, for all cells side by side.
    #[inline(always)]
    fn stresses(&self, z: &[f64], sign: &[f64], y: &mut [f64]) {
        // Numbers >= 0 compare as their bits do, for which compilers know better loops.
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

/// Any table at all: binary search. For tables that [`Indexed`] cannot hold.
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
    /// For a positive sign.
    pub tension: B,
    /// For a negative sign, magnitudes.
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
