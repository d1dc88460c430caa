//! Static flow stress as a function of plastic strain, derived from the loading curve.

use crate::law::{PieceIndex, Table};

/// A linear piece: `f = stress + slope (p - start)` for p >= `start`, where p is E times the plastic strain, Pa.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Piece {
    /// p at which the piece starts, Pa.
    pub start: f64,
    /// f at the start, Pa.
    pub stress: f64,
    /// df/dp, >= 0.
    pub slope: f64,
}

impl Piece {
    /// Returns the static flow stress at p, Pa.
    #[inline(always)]
    pub fn at(&self, p: f64) -> f64 {
        self.stress + self.slope * (p - self.start)
    }
}

/// Static flow stress of one loading table. The stress never falls with plastic strain; where the table is parallel to
/// the elastic line, it jumps.
#[derive(Debug, Clone, PartialEq)]
pub struct Hardening {
    pieces: Vec<Piece>,
    index: Option<PieceIndex>,
    /// Elastic limit of first loading, Pa.
    yield_stress: f64,
}

impl Hardening {
    /// Builds the pieces from a loading table. A point of a line `y = A + B z` (z = E eps = y + p) has `f = (A + B p)/(1 - B)`.
    pub fn new(table: &Table) -> Self {
        let mut pieces: Vec<Piece> = Vec::new();
        for line in table.lines().iter().filter(|line| line.slope < 1.0) {
            let stress = line.offset + line.slope * line.start;
            let before = pieces.last().map_or(0.0, |piece| piece.start);
            // Set to zero where the table leaves the elastic line, whatever the rounding there.
            let start = if pieces.is_empty() { 0.0 } else { (line.start - stress).max(before) };
            pieces.push(Piece { start, stress, slope: line.slope / (1.0 - line.slope) });
        }
        let yield_stress = pieces.first().map_or(f64::INFINITY, |piece| piece.stress);
        if pieces.is_empty() {
            pieces.push(Piece { start: 0.0, stress: f64::INFINITY, slope: 0.0 });
        }
        let starts: Vec<f64> = pieces.iter().map(|piece| piece.start).collect();
        Self { index: PieceIndex::new(&starts), pieces, yield_stress }
    }

    /// Returns the pieces in order; at least one. If the table never leaves the elastic line, it is one piece of infinite stress.
    pub fn pieces(&self) -> &[Piece] {
        &self.pieces
    }

    /// Returns the elastic limit of first loading, Pa; infinite if there is none.
    pub fn yield_stress(&self) -> f64 {
        self.yield_stress
    }

    /// Returns p at the end of piece `k`, Pa.
    #[inline(always)]
    pub fn end(&self, k: usize) -> f64 {
        self.pieces.get(k + 1).map_or(f64::INFINITY, |next| next.start)
    }

    /// Returns the index of the piece at p, without a starting point for the search.
    #[inline(always)]
    pub fn find(&self, p: f64) -> u32 {
        if let Some(index) = &self.index {
            return index.find(p);
        }
        let after = self.pieces.partition_point(|piece| piece.start <= p);
        after.saturating_sub(1) as u32
    }

    /// Returns the index of the piece at p; `from` is the index of a piece at or before it.
    #[inline]
    pub fn piece_at(&self, p: f64, from: u32) -> u32 {
        let mut k = from as usize;
        while k + 1 < self.pieces.len() && self.pieces[k + 1].start <= p {
            k += 1;
        }
        k as u32
    }
}

/// Static curves of tension and compression; both refer to the same curve if they are alike.
#[derive(Debug, Clone, Copy)]
pub(super) struct Sides<'a>(pub [&'a Hardening; 2]);

/// Positions of cells on the static curve of the sense of their stress.
pub(super) struct Located<const W: usize> {
    /// Sense of the stress: 0 tension, 1 compression.
    pub side: [u32; W],
    /// Index of the piece.
    pub piece: [u32; W],
    /// Static flow stress, Pa.
    pub stress: [f64; W],
    /// df/dp.
    pub slope: [f64; W],
    /// E times the plastic strain at the end of the piece, Pa.
    pub end: [f64; W],
    /// Static flow stress in the other sense, Pa; undefined if the elastic step does not change the sign of the stress.
    pub across: [f64; W],
}

impl Sides<'_> {
    #[inline(always)]
    fn are_alike(self) -> bool {
        std::ptr::eq(self.0[0], self.0[1])
    }

    /// Returns the common piece of both curves, if they are alike and consist of one piece.
    #[inline(always)]
    pub fn single(self) -> Option<Piece> {
        match self.0[0].pieces() {
            [piece] if self.are_alike() => Some(*piece),
            _ => None,
        }
    }

    /// Locates cells from their stresses, elastic predictors (Pa), and E times their accumulated plastic strains (Pa).
    #[inline(always)]
    pub fn locate<const W: usize>(self, sigma: &[f64; W], predictor: &[f64; W], p: &[f64; W]) -> Located<W> {
        let (zeros, none) = ([0.0; W], [0; W]);
        let mut located = Located { side: none, piece: none, stress: zeros, slope: zeros, end: zeros, across: zeros };
        if let Some(piece) = self.single() {
            let stress = p.map(|p| piece.at(p));
            return Located { stress, slope: [piece.slope; W], end: [f64::INFINITY; W], across: stress, ..located };
        }
        for i in 0..W {
            let side = usize::from(sigma[i].is_sign_negative());
            let curve = self.0[side];
            let k = curve.find(p[i]);
            let piece = curve.pieces()[k as usize];
            (located.side[i], located.piece[i]) = (side as u32, k);
            located.stress[i] = piece.at(p[i]);
            located.slope[i] = piece.slope;
            located.end[i] = curve.end(k as usize);
            located.across[i] = located.stress[i];
        }
        if !self.are_alike() {
            for i in 0..W {
                if sigma[i].is_sign_negative() != predictor[i].is_sign_negative() {
                    let other = self.0[1 - located.side[i] as usize];
                    located.across[i] = other.pieces()[other.find(p[i]) as usize].at(p[i]);
                }
            }
        }
        located
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::material::{Beyond, Curve};

    #[test]
    fn it_is_the_table_against_plastic_strain() {
        let modulus = 200e9;
        let rows = [(0.001, 200e6), (0.004, 260e6), (0.01, 300e6), (0.0105, 400e6), (0.05, 420e6)];
        let table = Table::new(&Curve::new(&rows, Beyond::Rupture).expect("rows rise"), modulus);
        let hardening = Hardening::new(&table);
        assert_eq!(hardening.yield_stress(), 200e6);
        // The fourth row rises with the elastic slope: a jump of 100 MPa at constant plastic strain.
        let jump = &hardening.pieces()[1..3];
        assert!((jump[0].at(jump[1].start) - 300e6).abs() < 1.0 && (jump[1].stress - 400e6).abs() < 1.0);
        let on_first_loading =
            [rows[0], (0.002, 220e6), rows[1], (0.007, 280e6), (0.0303, 410.025_316e6), rows[4], (0.09, 420e6)];
        for (strain, stress) in on_first_loading {
            let p = modulus * strain - stress;
            let piece = &hardening.pieces()[hardening.piece_at(p * (1.0 + 1e-12), 0) as usize];
            assert!((piece.at(p) - stress).abs() < 1e-6 * stress, "{strain}: {} {stress}", piece.at(p));
        }
    }

    #[test]
    fn a_bar_that_never_yields_has_an_infinite_flow_stress() {
        let table = Table::new(&Curve::new(&[(0.01, 2e9)], Beyond::Extend).expect("rows rise"), 200e9);
        assert_eq!(Hardening::new(&table).yield_stress(), f64::INFINITY);
    }
}
