//! Conversion of a raw scene to a checked one: units, ranges, defaults, required and excluded keys.

mod ball;
mod bar;
mod csv_history;
mod damping;
mod distribution;
mod ends;
mod hardening;
mod heat;
mod history_file;
mod initial;
mod magnitude;
mod rate;
mod record;
mod rupture;
mod section;
mod solve;
mod torsion;

use std::ops::Range;
use std::path::Path;

use ends::EndSite;

use super::capability::{Asked, all_go_together, not_a_key};
use super::raw::{EffectsChoice, MOST_CELLS, RawBar, RawEffects, RawScene};
use super::{Auto, Effects, Heat, Scene, SceneParts, Torsion};
use crate::bar::{Bar, EndCondition};
use crate::error::{Error, InputError, Result};
use crate::input::{Document, GivenKey, Table};
use crate::text_file::NamedFiles;
use crate::typed::{Key, Placed};
use crate::units::{Dimension, Measure};

/// Memory per cell and per sample over x, including the frames that wait to be written, bytes.
const BYTES_PER_CELL: f64 = 100.0;
const GIB: f64 = 1024.0 * 1024.0 * 1024.0;

/// Help for a missing required table.
const ENDS: &str = "both ends are required: add e.g. [left] with kind = \"velocity\" and value = \"30 m/s\", and \
                    [right] with kind = \"free\"";
const UNTIL: &str = "add [solve] with until, the end time, e.g. until = \"200 us\"";

/// File that is checked, and the folder to which its paths are relative.
pub(super) struct Checker<'a> {
    pub document: &'a Document,
    pub base: &'a Path,
    /// Whether the bar is in torsion, which changes the dimensions of some keys.
    pub torsion: bool,
    /// Keys given in `[bar]` and in `[solve]`; empty for scenes without a bar.
    pub keys: [Vec<GivenKey>; 2],
}

/// Checks a document; the caller sets `text` and `overrides` of the scene.
pub(super) fn check(document: &Document, base: &Path) -> Result<Scene> {
    let mut parsed = document.parsed()?;
    let keys = ["bar", "solve"].map(|table| parsed.keys_in(table));
    let ends = ["left", "right"].map(|end| parsed.take(end));
    let has_bar = parsed.has("bar");
    let raw: RawScene = parsed.read().map_err(|error| not_a_key(error, has_bar))?;
    let torsion = raw.bar.as_ref().is_some_and(|bar| bar.get_ref().is_torsion());
    Checker { document, base, torsion, keys }.scene(raw, ends)
}

/// Returns the first of several keys that is given.
pub(super) fn first_given<const N: usize>(
    keys: [(&'static str, Option<Range<usize>>); N],
) -> Option<(&'static str, Range<usize>)> {
    keys.into_iter().find_map(|(name, place)| Some((name, place?)))
}

fn auto_or_table(choice: EffectsChoice) -> (Option<Auto>, Box<RawEffects>) {
    match choice {
        EffectsChoice::Auto(_) => (Some(Auto::default()), Box::default()),
        EffectsChoice::Table(effects) => (None, effects),
    }
}

impl Checker<'_> {
    fn scene(&self, raw: RawScene, ends: [Option<Table<'_>>; 2]) -> Result<Scene> {
        let placed_bar = self.required(raw.bar.as_ref(), "bar", "add [bar] with length and material")?;
        let raw_bar = placed_bar.get_ref();
        let (auto, raw_effects) = auto_or_table(raw.effects);
        let mut bar = self.bar(placed_bar)?;
        all_go_together(self.document, raw_bar, &raw_effects, &bar)?;
        let mut torsion = self.twist_or_not(placed_bar, &mut bar)?;
        let heat = self.heat(&raw_effects, &mut bar)?;
        let ends = self.ends(ends, &bar, torsion.as_mut())?;
        let effects = self.all_effects(&raw_effects, raw_bar, heat, &bar)?;
        let raw_solve = self.required(raw.solve.as_ref(), "solve", UNTIL)?;
        let asked = Asked { effects: &raw_effects, auto: auto.is_some(), bar: &bar, ends: &ends };
        let solve = self.solve(raw_solve, &asked)?;
        self.steps_can_be_taken(raw_solve.get_ref(), &solve, &bar)?;
        self.initial_states(raw_bar, &raw_effects, &effects, &bar)?;
        self.staircases_are_short(raw_bar, &bar, &solve.method)?;
        let record = self.record(&raw.record, &bar, (&effects, auto.is_some()), &solve)?;
        let [left, right] = ends;
        let name = self.name();
        let (title, base) = (raw.title.unwrap_or_else(|| name.clone()), self.base.to_owned());
        let parts = SceneParts {
            title,
            name,
            path: None,
            text: String::new(),
            overrides: Vec::new(),
            bar,
            left,
            right,
            effects,
            auto,
            base,
            files: NamedFiles::default(),
            solve,
            record,
            discretized: None,
            torsion,
        };
        Ok(Scene { parts })
    }

    /// Returns the stem of the file.
    pub(super) fn name(&self) -> String {
        Path::new(&self.document.file).file_stem().map_or_else(String::new, |s| s.to_string_lossy().into_owned())
    }

    /// Converts a bar in torsion to quantities of its surface; refuses keys of torsion in an axial bar.
    fn twist_or_not(&self, raw: &Placed<RawBar>, bar: &mut Bar) -> Result<Option<Torsion>> {
        if self.torsion {
            return self.twist(raw, bar).map(Some);
        }
        self.nothing_of_torsion(raw, bar).map(|()| None)
    }

    /// Reads the left and the right end.
    fn ends(&self, raw: [Option<Table<'_>>; 2], bar: &Bar, torsion: Option<&mut Torsion>) -> Result<[EndCondition; 2]> {
        let end = |raw: Option<Table<'_>>, key, segment| {
            let table = self.required(raw, key, ENDS)?;
            self.end(&EndSite::new((key, table.span()), bar, segment, torsion.as_deref()), table, bar.area_given)
        };
        let [left, right] = raw;
        let [(left, at_left), (right, at_right)] =
            [end(left, "left", 0)?, end(right, "right", bar.segments.len() - 1)?];
        match torsion {
            Some(torsion) => torsion.levers = [at_left, at_right],
            None => self.not_crushed_at_once(bar, [&left, &right])?,
        }
        Ok([left, right])
    }

    fn all_effects(&self, raw: &RawEffects, raw_bar: &RawBar, heat: Option<Heat>, bar: &Bar) -> Result<Effects> {
        Ok(Effects {
            heat,
            rupture: self.rupture(raw, raw_bar, bar)?,
            damping: self.damping(raw, bar)?,
            lateral_inertia: self.lateral_inertia(raw, bar)?,
            ..self.effects(raw, bar)?
        })
    }

    pub(super) fn error(&self, span: Range<usize>, key: &str, message: impl Into<String>) -> InputError {
        self.document.error(span, key, message)
    }

    /// Reads a number in SI units.
    pub(super) fn si<K: Key>(&self, key: &K) -> Result<K::Si> {
        key.si(self.document, self.torsion)
    }

    /// Returns the dimension of a number.
    fn dimension<D: Measure>(&self) -> Dimension {
        if self.torsion { D::IN_TORSION } else { D::DIMENSION }
    }

    /// Reads a count. If it exceeds `most`, the text returned by `takes` is added to the message: what such a count would need.
    fn count<K: Key>(&self, key: &K, most: usize, takes: impl Fn(f64) -> String) -> Result<K::Si> {
        let asked = key.typed().and_then(|typed| typed.get_ref().si(Dimension::None).ok()).unwrap_or(0.0);
        self.si(key).map_err(|e| match e {
            Error::Input(mut e) if asked > most as f64 && asked.is_finite() => {
                e.message += &takes(asked);
                e.into()
            }
            other => other,
        })
    }

    /// Reads a number of cells or samples.
    fn count_of_cells<K: Key>(&self, key: &K) -> Result<K::Si> {
        let gib = |asked| format!(": they need about {:.1} GiB of memory", asked * BYTES_PER_CELL / GIB);
        self.count(key, MOST_CELLS, gib)
    }

    /// Refuses the second of several keys of a table that exclude each other.
    fn at_most_one<const N: usize>(&self, table: &str, keys: [(&str, Option<Range<usize>>); N]) -> Result<()> {
        let names = keys.each_ref().map(|(name, _)| *name).join(", ");
        let mut given = keys.into_iter().filter_map(|(name, place)| Some((name, place?)));
        let (Some((first, _)), Some((second, place))) = (given.next(), given.next()) else { return Ok(()) };
        let message = format!("`{first}` and `{second}` are both given");
        let error = self.error(place, &format!("{table}.{second}"), message);
        Err(error.allowed(format!("one of {names}")).help("keep one of them").into())
    }

    /// Returns a required part; the help line of the error states what to add.
    pub(super) fn required<T>(&self, part: Option<T>, key: &str, help: &str) -> Result<T> {
        part.ok_or_else(|| self.missing(self.end_of_text(), key, help))
    }

    fn missing(&self, span: Range<usize>, key: &str, help: &str) -> Error {
        let name = key.rsplit('.').next().unwrap_or(key);
        self.error(span, key, format!("`{name}` is missing")).help(help).into()
    }

    /// Returns the position at which a missing table would be added: the end of the last line with text.
    fn end_of_text(&self) -> Range<usize> {
        let end = self.document.text.trim_end().len();
        end..end
    }
}
