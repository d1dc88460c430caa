//! From what the user typed to what it means: units, ranges, defaults, and what must or must not stand together.

mod ball;
mod bar;
mod csv_history;
mod damping;
mod end_keys;
mod ends;
mod hardening;
mod heat;
mod initial;
mod magnitude;
mod muscl;
mod rate;
mod record;
mod rupture;
mod section;
mod solve;
mod torsion;

use std::fmt::Write as _;
use std::ops::Range;
use std::path::Path;

pub(super) use bar::Named;
pub(super) use rupture::MOST_NOTCH;

use super::raw::{EffectsChoice, RawScene};
use super::{Auto, Effects, Scene, not_yet};
use crate::error::{Error, InputError, Result};
use crate::input::{Document, Number};
use crate::text_file::NamedFiles;
use crate::units::Dimension;

/// Most cells that a run can be asked for: with the frames that wait to be written they take about a gigabyte, and a wave needs as many
/// steps to pass them.
const MOST_CELLS: usize = 10_000_000;
/// Memory of a cell and of a sample over x, with the frames that wait to be written, bytes.
const BYTES_PER_CELL: f64 = 100.0;
const GIB: f64 = 1024.0 * 1024.0 * 1024.0;

/// The file being checked and the folder that its paths are relative to.
pub(super) struct Checker<'a> {
    pub document: &'a Document,
    pub base: &'a Path,
}

/// Checks a document; `text` and `overrides` of the scene are the caller's to fill.
pub(super) fn check(document: &Document, base: &Path) -> Result<Scene> {
    not_yet::refuse(document)?;
    let raw: RawScene = document.parse()?;
    let checker = Checker { document, base };
    let raw_bar = checker.required(raw.bar.as_ref(), "bar", "add [bar] with length and material")?;
    let twisted = raw_bar.get_ref().is_torsion();
    let mut bar = checker.bar(raw_bar)?;
    let torsion = if twisted {
        Some(checker.twist(raw_bar, &mut bar)?)
    } else {
        checker.nothing_of_torsion(raw_bar, &bar)?;
        None
    };
    let (auto, raw_effects) = match raw.effects {
        EffectsChoice::Auto(_) => (Some(Auto::default()), Box::default()),
        EffectsChoice::Table(effects) => (None, effects),
    };
    let heat = checker.heat(&raw_effects, &mut bar)?;
    let ends = "both ends are always stated: add e.g. [left] with kind = \"velocity\" and value = \"30 m/s\", and \
                [right] with kind = \"free\"";
    let end = |raw, key, segment: usize| {
        let raw = checker.required(raw, key, ends)?;
        match &torsion {
            Some(torsion) => checker.twisted_end(raw, key, torsion, torsion.polar[segment]),
            None => checker.end(raw, key, &bar, &bar.segments[segment]),
        }
    };
    let left = end(raw.left.as_ref(), "left", 0)?;
    let right = end(raw.right.as_ref(), "right", bar.segments.len() - 1)?;
    if twisted {
        checker.effects_of_torsion(&raw_effects)?;
    } else {
        checker.not_crushed_at_once(&bar, [&left, &right])?;
    }
    let effects = Effects {
        heat,
        rupture: checker.rupture(&raw_effects, raw_bar.get_ref(), &bar)?,
        damping: checker.damping(&raw_effects, &bar)?,
        lateral_inertia: checker.lateral_inertia(&raw_effects, &bar)?,
        ..checker.effects(&raw_effects, &bar)?
    };
    checker.along_goes(&raw_effects, &bar)?;
    let until = "add [solve] with until, the end time, e.g. until = \"200 us\"";
    let raw_solve = checker.required(raw.solve.as_ref(), "solve", until)?;
    let solve = checker.solve(raw_solve, &raw_effects, raw_bar.get_ref().has_initial_state())?;
    checker.steps_can_be_taken(raw_solve.get_ref(), &solve, &bar)?;
    checker.hardening_can_be_tracked(&raw_effects, &solve.method, &bar)?;
    checker.muscl_can(raw_solve.get_ref(), &solve.method, &raw_effects, auto.is_some(), &bar, [&left, &right])?;
    checker.initial_states(raw_bar.get_ref(), &raw_effects, &effects, &solve.method, &bar)?;
    checker.taper_can_be_solved(raw_bar.get_ref(), &bar, &solve.method)?;
    let record = checker.record(&raw.record, &bar, &effects, &solve, twisted)?;
    let name = Path::new(&document.file).file_stem().map_or_else(String::new, |s| s.to_string_lossy().into_owned());
    Ok(Scene {
        title: raw.title.unwrap_or_else(|| name.clone()),
        name,
        path: None,
        text: String::new(),
        overrides: Vec::new(),
        bar,
        left,
        right,
        effects,
        auto,
        base: base.to_owned(),
        files: NamedFiles::default(),
        solve,
        record,
        cut: None,
        torsion,
    })
}

impl Checker<'_> {
    pub(super) fn error(&self, span: Range<usize>, key: &str, message: impl Into<String>) -> InputError {
        self.document.error(span, key, message)
    }

    /// A count of cells or samples; for more than can be had the message says what they would take.
    fn count_of_cells(&self, value: &Number, key: &str, least: usize) -> Result<usize> {
        let asked = value.get_ref().si(Dimension::None).unwrap_or(0.0);
        self.document.count(value, key, least, MOST_CELLS).map_err(|e| match e {
            Error::Input(mut e) if asked > MOST_CELLS as f64 && asked.is_finite() => {
                // Writing to a String cannot fail.
                let _ = write!(e.message, ": as many take about {:.1} GiB of memory", asked * BYTES_PER_CELL / GIB);
                e.into()
            }
            other => other,
        })
    }

    /// A part that must be there; the help line says what to add.
    pub(super) fn required<'a, T>(&self, part: Option<&'a T>, key: &str, help: &str) -> Result<&'a T> {
        part.ok_or_else(|| self.missing(self.end_of_text(), key, help))
    }

    fn missing(&self, span: Range<usize>, key: &str, help: &str) -> Error {
        let name = key.rsplit('.').next().unwrap_or(key);
        self.error(span, key, format!("`{name}` is missing")).help(help).into()
    }

    /// Where a whole missing table would be added: the last line that has text.
    fn end_of_text(&self) -> Range<usize> {
        let end = self.document.text.trim_end().len();
        end..end
    }
}
