//! Limits of a law: strains beyond the end of its stress-strain data, and full compression.
//!
//! A table ends at its last knot, at the plastic strain `p_end = eps_end - sigma_end/E`. A point is past the end while it flows in
//! the sense (tension or compression) of that table with an accumulated plastic strain of `p_end` or more. An elastic point is never
//! past the end, whatever its history, and the data of the other sense do not count. If the last segment is parallel to the
//! elastic line, all its strain is elastic: its start has the same plastic strain `p_end`, and only a larger plastic strain is past
//! the end. These rules hold for every hardening rule and every solver, and are implemented in [`DataEnd::reached`] alone.
//!
//! At an axial engineering strain of -1 no length is left: no table is valid from there on.

use std::ops::Range;

use serde::{Deserialize, Serialize};

use super::{CellLaw, Table, cell_state};
use crate::material::{Loading, Material, Sense};

/// Rounding of a strain, relative to the strain at the end of the data. A point that a level line holds at the end of its data may lack that much.
const ROUNDING: f64 = 1e-12;

/// Relative shortfall of the strain of a point from the strain at the end of its data up to which the point counts as having reached the end by that
/// strain, rather than by plastic strain accumulated in the other sense.
const REVERSED: f64 = 1e-6;

/// Strain increment that makes a point on its yield surface flow, relative to its elastic strain.
const NUDGE: f64 = 1e-9;

/// Limit of validity of the law of a point.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub enum Limit {
    /// The last knot of the table of the sense in which the point flows, reached by its strain in that sense.
    EndOfData(Sense),
    /// The same knot, reached by plastic strain that the point accumulated in the other sense.
    EndOfDataReversed(Sense),
    /// An engineering strain of -1.
    FullCompression,
}

impl Limit {
    /// Returns true if a run of a bar of this material cannot continue past the limit.
    pub fn stops(self, material: &Material) -> bool {
        match self {
            Self::EndOfData(sense) | Self::EndOfDataReversed(sense) => material.branch(sense).stops_at_end(),
            Self::FullCompression => true,
        }
    }
}

/// A limit that a point has reached.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Reached {
    /// The limit.
    pub limit: Limit,
    /// Engineering strain of the point, signed.
    pub strain: f64,
    /// Strain of first loading that gives the accumulated plastic strain of the point, i.e. its position along the table, >= 0.
    pub equivalent: f64,
}

/// A point that may flow, with the quantities that decide whether it has reached a limit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Flowing {
    /// Sense in which the point flows, if it flows.
    pub sense: Sense,
    /// E times the accumulated plastic strain, Pa, >= 0.
    pub accumulated: f64,
    /// E times the engineering strain, Pa, signed.
    pub strain: f64,
    /// Whether the point is known to be held on a level line. It then counts as being at the end of the data without plastic strain past the end.
    pub held: bool,
}

/// End of the data of a material. Strains are multiplied by E, Pa.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DataEnd {
    modulus: f64,
    /// E times the strain of the last knot in tension and in compression, Pa; infinite if the curve is extended.
    strain: [f64; 2],
    /// E times the plastic strain there, Pa.
    plastic: [f64; 2],
    /// Whether the last segment is parallel to the elastic line, in tension and in compression.
    ends_elastic: [bool; 2],
    /// E times the compressive strain at which no length is left, Pa; infinite in shear.
    full: f64,
    /// E times the accumulated plastic strain (Pa) below which a point that has yielded has reached no limit.
    least: f64,
}

impl DataEnd {
    /// Returns the ends of the material's own curves.
    pub fn of(material: &Material) -> Self {
        let table = |sense| Table::new(material.branch(sense), material.modulus);
        Self::new([&table(Sense::Tension), &table(Sense::Compression)], material.modulus, material.loading)
    }

    /// Returns the ends of the tables in tension and compression, given the elastic modulus, Pa.
    pub fn new(tables: [&Table; 2], modulus: f64, loading: Loading) -> Self {
        let ends = |table: &&Table| table.end().is_finite();
        let plastic = tables.map(|table| if ends(&table) { table.plastic_strain(table.end()) } else { f64::INFINITY });
        let full = if loading == Loading::Axial { modulus } else { f64::INFINITY };
        // |stress| is at most about the stress of the table: half of the plastic strain there leaves a margin for overstress. A bar that
        // stays elastic up to full compression has no plastic strain to detect it by, but a stress of -E.
        let crushed = tables.map(|table| 0.5 * table.plastic_strain(full)).into_iter().filter(|plastic| *plastic > 0.0);
        let least = plastic.into_iter().chain(crushed).fold(f64::INFINITY, f64::min);
        let strain = tables.map(Table::end);
        let least = least - ROUNDING * strain[0].min(strain[1]).min(modulus);
        Self { modulus, strain, plastic, ends_elastic: tables.map(Table::ends_elastic), full, least }
    }

    /// Returns true if a point with this E times accumulated plastic strain (Pa) and stress (Pa) has certainly reached no limit. A quick test.
    pub fn is_far(&self, accumulated: f64, stress: f64) -> bool {
        accumulated < self.least && stress > -self.full
    }

    /// Returns [`Self::is_far`] for points that have never yielded, under stresses of at most `peak` and with a yield stress of at least
    /// `yield_stress` in either sense, Pa. Below the yield stress none of them flows.
    pub fn is_far_below_yield(&self, peak: f64, yield_stress: f64) -> bool {
        let flows = peak * (1.0 + 2.0 * NUDGE) >= yield_stress;
        self.is_far(if flows { 0.0 } else { f64::NEG_INFINITY }, -peak)
    }

    /// Returns the limit that a point has reached, if any. If the limit requires that the point flows, calls `flows` with it.
    pub fn reached(&self, point: &Flowing, flows: impl FnOnce(Limit) -> bool) -> Option<Reached> {
        let Flowing { sense, accumulated, strain, held } = *point;
        let (end, past) = (self.strain[sense.index()], accumulated - self.plastic[sense.index()]);
        let rounding = if self.ends_elastic[sense.index()] && !held { ROUNDING } else { -ROUNDING };
        let reached = |limit, equivalent| Reached { limit, strain: strain / self.modulus, equivalent };
        if strain <= -self.full {
            return Some(reached(Limit::FullCompression, -strain / self.modulus));
        }
        if end.is_infinite() || past < rounding * end {
            return None;
        }
        let direct = sense.sign() * strain - end >= -REVERSED * end;
        let limit = if direct { Limit::EndOfData(sense) } else { Limit::EndOfDataReversed(sense) };
        flows(limit).then(|| reached(limit, (end + past) / self.modulus))
    }
}

/// A cell of a grid that has reached a limit.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Passed {
    /// Index of the cell.
    pub cell: usize,
    /// Index of its segment.
    pub segment: usize,
    /// Step at whose end the limit was detected.
    pub step: usize,
    /// The limit reached.
    pub reached: Reached,
}

/// The first cell of each segment to reach each limit. Of several cells in one step, the one farthest past the limit.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct FirstPassed(Vec<Passed>);

impl FirstPassed {
    /// Returns the cells in order of time.
    pub fn in_order(mut self) -> impl Iterator<Item = Passed> {
        self.0.sort_by_key(|passed| passed.step);
        self.0.into_iter()
    }

    fn of(&self, segment: usize, limit: Limit) -> Option<usize> {
        self.0.iter().position(|known| known.segment == segment && known.reached.limit == limit)
    }

    /// Returns true if another cell of the segment reached this limit in an earlier step.
    fn knows(&self, segment: usize, limit: Limit, step: usize) -> bool {
        self.of(segment, limit).is_some_and(|k| self.0[k].step < step)
    }

    /// Records a cell, unless an earlier one, or one farther past the limit, is known.
    pub fn note(&mut self, new: Passed) {
        let rank = |passed: &Passed| (std::cmp::Reverse(passed.step), passed.reached.equivalent);
        match self.of(new.segment, new.reached.limit) {
            None => self.0.push(new),
            Some(k) if rank(&new) > rank(&self.0[k]) => self.0[k] = new,
            Some(_) => {}
        }
    }

    /// Records the cells of another set.
    pub fn merge(&mut self, other: &Self) {
        other.0.iter().for_each(|passed| self.note(*passed));
    }
}

/// A row of cells after a step, as needed to detect its limits.
#[derive(Debug)]
pub struct StrainedRow<'a> {
    /// Stresses, Pa.
    pub sigma: &'a [f64],
    /// State of the law, one variable after the other; empty while the row is elastic.
    pub state: &'a [f64],
    /// Range of the cells of the row that are tested.
    pub cells: Range<usize>,
    /// Index in the bar of the first of them.
    pub first: usize,
    /// Index of their segment.
    pub segment: usize,
    /// Index of the step.
    pub step: usize,
}

/// Records the cells of a row that have reached a limit.
pub(super) fn note_limits<L: CellLaw<N>, const N: usize>(
    law: &L,
    end: &DataEnd,
    row: &StrainedRow<'_>,
    passed: &mut FirstPassed,
) {
    let elastic = row.state.is_empty();
    for i in row.cells.clone() {
        let (sigma, state) = (row.sigma[i], if elastic { [0.0; N] } else { cell_state(row.state, i) });
        let accumulated = law.along_table(state);
        if end.is_far(accumulated, sigma) {
            continue;
        }
        let sense = law.sense(sigma, state);
        let point = Flowing { sense, accumulated, strain: sigma + law.plastic_strain(state), held: false };
        let flows = |limit| !passed.knows(row.segment, limit, row.step) && law.yields(sigma, state);
        if let Some(reached) = end.reached(&point, flows) {
            let cell = row.first + i - row.cells.start;
            passed.note(Passed { cell, segment: row.segment, step: row.step, reached });
        }
    }
}

/// Returns true if the cell flows under a minimal strain increment in its sense.
pub(super) fn yields<L: CellLaw<N>, const N: usize>(law: &L, sigma: f64, state: [f64; N]) -> bool {
    let nudge = NUDGE * sigma.abs().copysign(law.sense(sigma, state).sign());
    law.respond(sigma, law.base(sigma, state) + nudge, state).plastic != 0.0
}
