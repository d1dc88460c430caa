//! The two ends: what each kind states, and the histories that drive them.

use std::ops::Range;

use toml::Spanned;

use super::super::raw::{EndKind, RawEnd};
use super::Checker;
use super::end_keys::given;
use crate::bar::{Bar, EndCondition, History, Segment};
use crate::error::{Error, Result};
use crate::input::{Allowed, Number};
use crate::units::Dimension;

impl Checker<'_> {
    /// The end under `key` of a bar, at the segment `at`.
    pub(super) fn end(&self, raw: &Spanned<RawEnd>, key: &str, bar: &Bar, at: &Segment) -> Result<EndCondition> {
        let (span, raw) = (raw.span(), raw.get_ref());
        let kind = *raw.kind.get_ref();
        self.only_its_keys(raw, kind, key)?;
        if matches!(kind, EndKind::Dashpot | EndKind::Striker | EndKind::Ball | EndKind::Spring) {
            self.needs_area(raw, kind, key, bar.area_given)?;
        }
        let number =
            |value, name, dimension, allowed| self.own_number((value, name, dimension, allowed), span.clone(), key);
        Ok(match kind {
            EndKind::Velocity => EndCondition::Velocity {
                history: self.history(raw, span, key, Dimension::Velocity)?,
                release: self.release(raw, key)?,
            },
            EndKind::Stress => EndCondition::Stress { history: self.history(raw, span, key, Dimension::Stress)? },
            EndKind::Torque => return Err(self.only_in_torsion(raw, key)),
            EndKind::Free => EndCondition::Free,
            EndKind::Fixed => EndCondition::Fixed,
            EndKind::Absorbing => EndCondition::Absorbing,
            EndKind::Dashpot => {
                let (value, dimension) = (raw.coefficient.as_ref(), Dimension::DampingCoefficient);
                EndCondition::Dashpot { coefficient: number(value, "coefficient", dimension, Allowed::NotNegative)? }
            }
            EndKind::Wall => EndCondition::Wall { gap: self.gap(raw, key)? },
            EndKind::Striker => EndCondition::Striker {
                mass: number(raw.mass.as_ref(), "mass", Dimension::Mass, Allowed::Positive)?,
                velocity: number(raw.velocity.as_ref(), "velocity", Dimension::Velocity, Allowed::Finite)?,
            },
            EndKind::Ball => self.ball(raw, span, key, &at.material)?,
            EndKind::Spring => {
                let stiffness = raw.stiffness.as_ref();
                let stiffness = number(stiffness, "stiffness", Dimension::Stiffness, Allowed::Positive)?;
                EndCondition::Spring { stiffness }
            }
        })
    }

    fn only_in_torsion(&self, raw: &RawEnd, key: &str) -> Error {
        let message = "a torque acts on a bar in torsion only";
        let error = self.error(raw.kind.span(), &format!("{key}.kind"), message);
        error.help("use kind = \"stress\", or [bar] mode = \"torsion\"").into()
    }

    /// The distance of a wall, m.
    fn gap(&self, raw: &RawEnd, key: &str) -> Result<f64> {
        let (gap, key) = (raw.gap.as_ref(), format!("{key}.gap"));
        Ok(self.document.optional(gap, &key, Dimension::Length, Allowed::NotNegative)?.unwrap_or(0.0))
    }

    /// The time from which a driven end is free, s.
    pub(super) fn release(&self, raw: &RawEnd, key: &str) -> Result<Option<f64>> {
        self.document.optional(raw.release.as_ref(), &format!("{key}.release"), Dimension::Time, Allowed::Positive)
    }

    /// A body acts on the whole section: without an area its mass or stiffness has no meaning.
    fn needs_area(&self, raw: &RawEnd, kind: EndKind, key: &str, area_given: bool) -> Result<()> {
        if area_given {
            return Ok(());
        }
        let message =
            format!("an end of kind \"{}\" needs the section on which it acts, and the bar has none", kind.word());
        let help = "give [bar] (or every [[bar.segment]]) an area, e.g. area = \"1 cm^2\", or a diameter";
        Err(self.error(raw.kind.span(), &format!("{key}.kind"), message).help(help).into())
    }

    /// A number that this kind of end must have.
    pub(in crate::scene) fn own_number(
        &self,
        (value, name, dimension, allowed): (Option<&Number>, &str, Dimension, Allowed),
        span: Range<usize>,
        key: &str,
    ) -> Result<f64> {
        let key = format!("{key}.{name}");
        let Some(value) = value else {
            let help = format!("add {}, e.g. {name} = \"{}\"", dimension.describe(), dimension.example());
            return Err(self.missing(span, &key, &help));
        };
        self.document.number(value, &key, dimension, allowed)
    }

    fn only_its_keys(&self, raw: &RawEnd, kind: EndKind, key: &str) -> Result<()> {
        for (name, span) in given(raw) {
            if kind.keys().contains(&name) {
                continue;
            }
            let word = kind.word();
            let message = format!("`{name}` means nothing for an end of kind \"{word}\"");
            let allowed = match kind.keys() {
                [] => "kind alone".to_owned(),
                keys => format!("kind, {}", keys.join(", ")),
            };
            let help = format!("take `{name}` out, or give the end another kind");
            return Err(self.error(span, &format!("{key}.{name}"), message).allowed(allowed).help(help).into());
        }
        Ok(())
    }

    /// The history of a driven end, from exactly one of its three forms.
    pub(super) fn history(&self, raw: &RawEnd, span: Range<usize>, key: &str, dimension: Dimension) -> Result<History> {
        let forms: Vec<_> = given(raw).into_iter().filter(|(name, _)| *name != "release").collect();
        let unit = dimension.example();
        match forms.as_slice() {
            [_] => {}
            [] => {
                let help = format!(
                    "add value = \"{unit}\", or history = [[\"0 us\", \"{unit}\"], ...], or csv = \"file.csv\""
                );
                return Err(self.missing(span, &format!("{key}.value"), &help));
            }
            [(first, _), (second, span), ..] => {
                let message = format!("`{first}` and `{second}` both say what drives the end");
                let error = self.error(span.clone(), &format!("{key}.{second}"), message);
                return Err(error.allowed("one of value, history, csv").help("keep one of them").into());
            }
        }
        if let Some(value) = &raw.value {
            let value = self.document.number(value, &format!("{key}.value"), dimension, Allowed::Finite)?;
            return Ok(History::constant(value));
        }
        if let Some(rows) = &raw.history {
            return self.rows(rows, &format!("{key}.history"), dimension);
        }
        match &raw.csv {
            Some(path) => self.csv_history(path, &format!("{key}.csv"), dimension),
            None => Err(self.missing(span, &format!("{key}.value"), "say what drives the end")),
        }
    }

    fn rows(&self, rows: &Spanned<Vec<Spanned<Vec<Number>>>>, key: &str, dimension: Dimension) -> Result<History> {
        let mut pairs = Vec::with_capacity(rows.get_ref().len());
        for (i, row) in rows.get_ref().iter().enumerate() {
            let [time, value] = row.get_ref().as_slice() else {
                let count = row.get_ref().len();
                let error = self.error(row.span(), &format!("{key}.{i}"), format!("a row has {count} entries"));
                let help = format!("write [time, value], e.g. [\"10 us\", \"{}\"]", dimension.example());
                return Err(error.allowed("2 entries: time and value").help(help).into());
            };
            let t = self.document.number(time, &format!("{key}.{i}.time"), Dimension::Time, Allowed::NotNegative)?;
            let v = self.document.number(value, &format!("{key}.{i}.value"), dimension, Allowed::Finite)?;
            pairs.push((t, v));
        }
        History::new(&pairs).map_err(|(i, fault)| {
            let why = fault.over_time();
            let span = rows.get_ref().get(i).map_or_else(|| rows.span(), Spanned::span);
            let what = if pairs.is_empty() { why.to_owned() } else { format!("row {} {why}", i + 1) };
            self.error(span, &format!("{key}.{i}"), what).allowed(ROWS).help(ROWS_HELP).into()
        })
    }
}

/// What rows of a history obey.
pub(super) const ROWS: &str = "times never decrease, at most two rows with one time";
/// And how to write them.
pub(super) const ROWS_HELP: &str = "list the rows in the order of time; two rows with one time are a jump";
