//! Cross-section of a segment: constant, or a table along the segment.

use std::f64::consts::PI;
use std::sync::Arc;

use super::super::Method;
use super::super::discretized::{MOST_PIECES, pieces_needed};
use super::super::raw::{Given, RawBar, RawPiece};
use super::Checker;
use crate::bar::{Bar, Profile, Taper};
use crate::error::Result;
use crate::typed::Placed;
use crate::units::{Dimension, System, format};

/// Checked section.
pub(super) struct Section {
    /// Area, m^2; the mean area of a taper.
    pub area: f64,
    pub taper: Option<Arc<Taper>>,
}

/// Relative difference (of the length) up to which the last row of a taper counts as being at the segment's right end.
const SAME_PLACE: f64 = 1e-9;

const ROWS: &str = "x increasing from 0 to the length, sizes > 0";

impl Checker<'_> {
    /// Reads the section of a piece of length `length`, m; `None` if it has none.
    pub(super) fn section(&self, piece: &RawPiece<'_>, key: &str, length: f64) -> Result<Option<Section>> {
        if let (Some(_), Some(diameter)) = (piece.area, piece.diameter) {
            let message = "the section has both an area and a diameter";
            let error = self.error(diameter.span(), &format!("{key}.diameter"), message);
            return Err(error.help("keep `area` or `diameter`, not both").into());
        }
        if let Some(area) = piece.area {
            return self.one_or_table(&area.given(), &format!("{key}.area"), Profile::Area, length).map(Some);
        }
        let diameter =
            |d: &Placed<_>| self.one_or_table(&d.given(), &format!("{key}.diameter"), Profile::Diameter, length);
        piece.diameter.map(diameter).transpose()
    }

    /// Checks the number of steps in the staircases into which methods with uniform media divide tapers and initial states.
    pub(super) fn staircases_are_short(&self, raw: &RawBar, bar: &Bar, method: &Method) -> Result<()> {
        self.staircase_is_short(raw, bar, method)?;
        self.taper_can_be_solved(raw, bar, method)
    }

    fn taper_can_be_solved(&self, raw: &RawBar, bar: &Bar, method: &Method) -> Result<()> {
        let steepest = bar.segments.iter().position(|s| pieces_needed(s, method) > MOST_PIECES as f64);
        let Some(k) = steepest else { return Ok(()) };
        let (key, span) = raw.section_of(k).unwrap_or_default();
        let pieces = pieces_needed(&bar.segments[k], method);
        let message =
            format!("method = \"moc\" discretizes the taper into uniform pieces and would need {pieces:.3e} of them");
        let error = self.error(span, &key, message).allowed(format!("at most {MOST_PIECES}"));
        Err(error.help("use method = \"fd\", which resolves the taper directly, or a less steep taper").into())
    }

    fn one_or_table(&self, given: &Given<'_>, key: &str, profile: Profile, length: f64) -> Result<Section> {
        if let Some(size) = given.uniform() {
            let size = self.document.number_at(&size, given.dimension(self.torsion), given.allowed)?;
            return Ok(Section { area: area(profile, size), taper: None });
        }
        let rows = given.rows();
        let name = if profile == Profile::Area { "area" } else { "diameter" };
        let mut pairs = self.rows(given, key, name)?;
        let place = |i: usize| rows.get(i).map_or_else(|| given.span.clone(), Placed::span);
        if let Some(last) = pairs.last_mut() {
            if (last.0 - length).abs() > SAME_PLACE * length {
                let message = format!("the last row is at x = {}", format(last.0, Dimension::Length, System::Si));
                let end = format(length, Dimension::Length, System::Si);
                let help = "the table covers the segment from its own left end to its right end; give a row at both";
                let error = self.error(place(rows.len() - 1), &format!("{key}.{}", rows.len() - 1), message);
                return Err(error.allowed(format!("x = {end}, the segment's length")).help(help).into());
            }
            last.0 = length;
        }
        let taper = Taper::new(profile, &pairs).map_err(|error| {
            let help = "sort the rows by x; for a step in the section use two segments";
            let row = error.at();
            self.error(place(row), &format!("{key}.{row}"), error.to_string()).allowed(ROWS).help(help)
        })?;
        // A table of constant area is not a taper, so that the result is bit-identical to that of a uniform bar.
        let uniform = taper.is_uniform();
        let area = if uniform { area(profile, pairs[0].1) } else { taper.mean(0.0, length) };
        Ok(Section { area, taper: (!uniform).then(|| Arc::new(taper)) })
    }
}

fn area(profile: Profile, size: f64) -> f64 {
    match profile {
        Profile::Area => size,
        Profile::Diameter => PI / 4.0 * size * size,
    }
}
