//! The constants of formulas in a file: the keys of each law and their ranges.

use std::ops::Range;

use super::keys::Keys;
use super::raw::RawCurve;
use super::{Formula, Law};
use crate::error::Result;
use crate::input::{Allowed, Number};
use crate::units::Dimension;

type Get = fn(&RawCurve) -> Option<&Number>;

/// Every key that some law takes.
const CONSTANTS: [(&str, Get); 9] = [
    ("K", |c| c.k.as_ref()),
    ("n", |c| c.n.as_ref()),
    ("A", |c| c.a.as_ref()),
    ("B", |c| c.b.as_ref()),
    ("yield", |c| c.yield_stress.as_ref()),
    ("saturation", |c| c.saturation.as_ref()),
    ("strain", |c| c.strain.as_ref()),
    ("prestrain", |c| c.prestrain.as_ref()),
    ("offset", |c| c.offset.as_ref()),
];

/// Name of a formula in files, and the keys it takes.
fn keys_of(formula: Formula) -> (&'static str, &'static [&'static str]) {
    match formula {
        Formula::Hollomon => ("hollomon", &["K", "n"]),
        Formula::Ludwik => ("ludwik", &["yield", "K", "n"]),
        Formula::Swift => ("swift", &["K", "prestrain", "n"]),
        Formula::Voce => ("voce", &["yield", "saturation", "strain"]),
        Formula::RambergOsgood => ("ramberg-osgood", &["yield", "offset", "n"]),
        Formula::JohnsonCook => ("johnson-cook", &["A", "B", "n"]),
    }
}

struct Reader<'a> {
    formula: Formula,
    span: Range<usize>,
    curve: &'a RawCurve,
    name: &'a str,
    keys: Keys<'a>,
}

impl Reader<'_> {
    fn optional(&self, key: &str, dimension: Dimension, allowed: Allowed) -> Result<Option<f64>> {
        let get = CONSTANTS.iter().find(|(name, _)| *name == key).map(|(_, get)| get);
        let value = get.and_then(|get| get(self.curve));
        self.keys.optional(value, &format!("{}.{key}", self.name), dimension, allowed)
    }

    fn need(&self, key: &str, dimension: Dimension, allowed: Allowed) -> Result<f64> {
        self.optional(key, dimension, allowed)?.ok_or_else(|| {
            let (formula, keys) = keys_of(self.formula);
            let error = self.keys.error(self.span.clone(), &format!("{}.{key}", self.name), "is missing");
            error.help(format!("formula = \"{formula}\" uses {}", keys.join(", "))).into()
        })
    }

    fn stress(&self, key: &str) -> Result<f64> {
        self.need(key, Dimension::Stress, Allowed::Positive)
    }

    fn hardening(&self, key: &str) -> Result<f64> {
        self.need(key, Dimension::Stress, Allowed::NotNegative)
    }

    fn strain(&self, key: &str) -> Result<f64> {
        self.need(key, Dimension::None, Allowed::Positive)
    }

    fn exponent(&self) -> Result<f64> {
        self.need("n", Dimension::None, Allowed::Above(0.0, 1.0))
    }
}

/// Reads a law's constants; keys of other laws are refused.
pub(super) fn read(formula: Formula, span: Range<usize>, curve: &RawCurve, name: &str, keys: Keys<'_>) -> Result<Law> {
    let (formula_name, takes) = keys_of(formula);
    for (key, value) in given(curve) {
        if !takes.contains(&key) {
            let error = keys.error(value.span(), &format!("{name}.{key}"), "is not a constant of this formula");
            let help = format!("formula = \"{formula_name}\" uses {}", takes.join(", "));
            return Err(error.help(help).into());
        }
    }
    let reader = Reader { formula, span, curve, name, keys };
    Ok(match formula {
        // n = 1 would be a straight line that never leaves the elastic one, or never meets it.
        Formula::Hollomon => {
            let n = reader.need("n", Dimension::None, Allowed::Within(1e-4, 0.99))?;
            Law::Hollomon { k: reader.stress("K")?, n }
        }
        Formula::Ludwik => {
            Law::Ludwik { yield_stress: reader.stress("yield")?, k: reader.hardening("K")?, n: reader.exponent()? }
        }
        Formula::Swift => {
            Law::Swift { k: reader.stress("K")?, prestrain: reader.strain("prestrain")?, n: reader.exponent()? }
        }
        Formula::Voce => voce(&reader)?,
        Formula::RambergOsgood => Law::RambergOsgood {
            yield_stress: reader.stress("yield")?,
            offset: reader.optional("offset", Dimension::None, Allowed::Positive)?.unwrap_or(0.002),
            n: reader.need("n", Dimension::None, Allowed::Within(1.01, 1000.0))?,
        },
        Formula::JohnsonCook => {
            Law::JohnsonCook { a: reader.stress("A")?, b: reader.hardening("B")?, n: reader.exponent()? }
        }
    })
}

fn voce(reader: &Reader<'_>) -> Result<Law> {
    let yield_stress = reader.stress("yield")?;
    let above = Allowed::Above(yield_stress, f64::MAX);
    let saturation = reader.stress("saturation")?;
    if !above.holds(saturation) {
        let message = format!("{saturation:e} Pa is not above the yield stress {yield_stress:e} Pa");
        let key = format!("{}.saturation", reader.name);
        let span = reader.curve.saturation.as_ref().map_or(0..0, toml::Spanned::span);
        return Err(reader
            .keys
            .error(span, &key, message)
            .allowed("saturation > yield")
            .help("set `saturation` to the stress that the curve approaches from below")
            .into());
    }
    Ok(Law::Voce { yield_stress, saturation, strain: reader.strain("strain")? })
}

/// Refuses constants where there is no formula.
pub(super) fn refuse_constants(curve: &RawCurve, name: &str, keys: Keys<'_>) -> Result<()> {
    let Some((key, value)) = given(curve).next() else { return Ok(()) };
    let error =
        keys.error(value.span(), &format!("{name}.{key}"), "is a constant of a formula, but `formula` is not given");
    Err(error.help("add e.g. formula = \"hollomon\", or remove the constant").into())
}

fn given(curve: &RawCurve) -> impl Iterator<Item = (&'static str, &Number)> {
    CONSTANTS.iter().filter_map(move |(key, get)| get(curve).map(|value| (*key, value)))
}
