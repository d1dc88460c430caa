//! The limits of a law: strains beyond the end of its stress-strain data, and full compression.
//!
//! A table ends at its last knot, at the plastic strain `p_end = eps_end - sigma_end/E`. A point is past it while it flows in
//! the sense (tension or compression) of that table with an accumulated plastic strain of `p_end` or more. An elastic point is
//! past nothing, whatever it was before, and the data of the other sense do not count. Along a last segment that is parallel to the
//! elastic line all strain is elastic: `p_end` is that of its start, too, and only more than that is past the end. This holds for
//! every hardening rule and every solver, and is decided in [`DataEnd::reached`] alone.
//!
//! An axial engineering strain of -1 leaves no length: no table says anything from there on.

use std::ops::Range;

use serde::{Deserialize, Serialize};

use super::{CellLaw, Table, cell_state};
use crate::material::{Loading, Material, Sense};

/// A point held at the end of its data by a level line lacks no more than rounding, as a part of the strain there.
const ROUNDING: f64 = 1e-12;

/// A point whose own strain lacks no more than this part of the strain at the end of its data came there by that strain.
const REVERSED: f64 = 1e-6;

/// A strain increment that makes a point flow that is on its yield surface, as a part of its elastic strain.
const NUDGE: f64 = 1e-9;

/// Where the law of a point ends.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub enum Limit {
    /// At the last knot of the table of the sense in which the point flows, by its strain in that sense.
    EndOfData(Sense),
    /// At the same knot, by plastic strain that it accumulated in the other sense.
    EndOfDataReversed(Sense),
    /// At an engineering strain of -1.
    FullCompression,
}

impl Limit {
    /// True where nothing is known of a bar of this material from there on.
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
    /// Which one.
    pub limit: Limit,
    /// Engineering strain of the point, signed.
    pub strain: f64,
    /// Strain of first loading that gives the point's accumulated plastic strain: where it is along the table, >= 0.
    pub equivalent: f64,
}

/// A point that may flow, as the limits see it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Flowing {
    /// The sense in which it flows if it flows.
    pub sense: Sense,
    /// E times the accumulated plastic strain, Pa, >= 0.
    pub accumulated: f64,
    /// E times the engineering strain, Pa, signed.
    pub strain: f64,
    /// A level line is known to hold it: no plastic strain past the end is needed to tell that it is there.
    pub held: bool,
}

/// Where the data of a material end. Strains are times E, Pa.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DataEnd {
    modulus: f64,
    /// Of the last knot in tension and in compression; infinite if the curve is extended.
    strain: [f64; 2],
    /// Plastic strain there.
    plastic: [f64; 2],
    /// The last segment is parallel to the elastic line.
    ends_elastic: [bool; 2],
    /// Compressive strain that leaves no length; infinite in shear.
    full: f64,
    /// Accumulated plastic strain below which a point that has yielded has reached no limit.
    least: f64,
}

impl DataEnd {
    /// Of the material's own curves.
    pub fn of(material: &Material) -> Self {
        let table = |sense| Table::new(material.branch(sense), material.modulus);
        Self::new([&table(Sense::Tension), &table(Sense::Compression)], material.modulus, material.loading)
    }

    /// Of the tables in tension and compression over a modulus, Pa.
    pub fn new(tables: [&Table; 2], modulus: f64, loading: Loading) -> Self {
        let ends = |table: &&Table| table.end().is_finite();
        let plastic = tables.map(|table| if ends(&table) { table.plastic_strain(table.end()) } else { f64::INFINITY });
        let full = if loading == Loading::Axial { modulus } else { f64::INFINITY };
        // |stress| is at most about that of the table: half of the plastic strain there leaves room for overstress. A bar that
        // stays elastic until then has no plastic strain to tell it by, but a stress of -E.
        let crushed = tables.map(|table| 0.5 * table.plastic_strain(full)).into_iter().filter(|plastic| *plastic > 0.0);
        let least = plastic.into_iter().chain(crushed).fold(f64::INFINITY, f64::min);
        let strain = tables.map(Table::end);
        let least = least - ROUNDING * strain[0].min(strain[1]).min(modulus);
        Self { modulus, strain, plastic, ends_elastic: tables.map(Table::ends_elastic), full, least }
    }

    /// A quick look at a point with this accumulated plastic strain and stress (times E, and Pa): it has reached no limit.
    pub fn is_far(&self, accumulated: f64, stress: f64) -> bool {
        accumulated < self.least && stress > -self.full
    }

    /// The same of points that have never yielded, under stresses of at most `peak` and a yield stress in either sense of at least
    /// `yield_stress`, Pa: below that none flows.
    pub fn is_far_below_yield(&self, peak: f64, yield_stress: f64) -> bool {
        let flows = peak * (1.0 + 2.0 * NUDGE) >= yield_stress;
        self.is_far(if flows { 0.0 } else { f64::NEG_INFINITY }, -peak)
    }

    /// The limit that a point has reached, if it has. Where it must flow for that, `flows` is asked, with the limit.
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
    /// The cell.
    pub cell: usize,
    /// Its segment.
    pub segment: usize,
    /// The step at whose end it was seen.
    pub step: usize,
    /// What it has reached.
    pub reached: Reached,
}

/// The first cell of each segment to reach each limit; of several in one step the one that is farthest past it.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct FirstPassed(Vec<Passed>);

impl FirstPassed {
    /// In the order of time.
    pub fn in_order(mut self) -> impl Iterator<Item = Passed> {
        self.0.sort_by_key(|passed| passed.step);
        self.0.into_iter()
    }

    fn of(&self, segment: usize, limit: Limit) -> Option<usize> {
        self.0.iter().position(|known| known.segment == segment && known.reached.limit == limit)
    }

    /// True where a cell that reaches this limit in this step is not the first.
    fn knows(&self, segment: usize, limit: Limit, step: usize) -> bool {
        self.of(segment, limit).is_some_and(|k| self.0[k].step < step)
    }

    /// Takes in a cell.
    pub fn note(&mut self, new: Passed) {
        let rank = |passed: &Passed| (std::cmp::Reverse(passed.step), passed.reached.equivalent);
        match self.of(new.segment, new.reached.limit) {
            None => self.0.push(new),
            Some(k) if rank(&new) > rank(&self.0[k]) => self.0[k] = new,
            Some(_) => {}
        }
    }

    /// Takes in what another one knows.
    pub fn merge(&mut self, other: &Self) {
        other.0.iter().for_each(|passed| self.note(*passed));
    }
}

/// A row of cells after a step, for the look at its limits.
#[derive(Debug)]
pub struct StrainedRow<'a> {
    /// Stresses, Pa.
    pub sigma: &'a [f64],
    /// State of the law, one variable after the other; empty while the row is elastic.
    pub state: &'a [f64],
    /// The cells of the row that are looked at.
    pub cells: Range<usize>,
    /// Number of the first of them in the bar.
    pub first: usize,
    /// Their segment.
    pub segment: usize,
    /// The step.
    pub step: usize,
}

/// Notes the cells of a row that have reached a limit.
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

/// Whether a cell flows in its sense: whether the least strain in that sense makes it.
pub(super) fn yields<L: CellLaw<N>, const N: usize>(law: &L, sigma: f64, state: [f64; N]) -> bool {
    let nudge = NUDGE * sigma.abs().copysign(law.sense(sigma, state).sign());
    law.respond(sigma, law.base(sigma, state) + nudge, state).plastic != 0.0
}
