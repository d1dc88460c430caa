//! The constants of formulas in a file: the keys of each law, and their ranges where these are narrower than those of the keys.

use std::ops::Range;

use super::keys::Keys;
use super::raw::RawCurve;
use super::{Formula, Law};
use crate::error::{InputError, Result};
use crate::input::Allowed;
use crate::typed::{self, Key, Of};
use crate::units::Measure;

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

/// The curve under a name, with the place of its formula.
struct Reader<'a> {
    formula: Formula,
    span: Range<usize>,
    name: &'a str,
    keys: Keys<'a>,
}

impl Reader<'_> {
    /// An error at one of the curve's keys.
    fn error(&self, span: Range<usize>, key: &str, message: String) -> InputError {
        self.keys.error(span, &format!("{}.{key}", self.name), message)
    }

    fn uses(&self) -> String {
        let (formula, keys) = keys_of(self.formula);
        format!("formula = \"{formula}\" uses {}", keys.join(", "))
    }

    fn needed<T>(&self, key: &str, constant: Option<T>) -> Result<T> {
        let missing = || self.error(self.span.clone(), key, "is missing".to_owned()).help(self.uses()).into();
        constant.ok_or_else(missing)
    }

    fn number<D: Measure, R: typed::Range>(&self, key: &str, of: Option<&Of<D, R>>) -> Result<f64> {
        self.keys.si(self.needed(key, of)?)
    }

    fn within<D: Measure, R: typed::Range>(&self, key: &str, of: Option<&Of<D, R>>, allowed: Allowed) -> Result<f64> {
        self.needed(key, of)?.si_within(self.keys.doc, allowed)
    }
}

/// Reads a law's constants; keys of other laws are refused.
pub(super) fn read(formula: Formula, span: Range<usize>, curve: &RawCurve, name: &str, keys: Keys<'_>) -> Result<Law> {
    let reader = Reader { formula, span, name, keys };
    let (_, uses) = keys_of(formula);
    if let Some((key, place)) = given(curve).find(|(key, _)| !uses.contains(key)) {
        let error = reader.error(place, key, "is not a constant of this formula".to_owned());
        return Err(error.help(reader.uses()).into());
    }
    let n = |allowed| reader.within("n", curve.n.as_ref(), allowed);
    let exponent = || n(Allowed::Above(0.0, 1.0));
    let yield_stress = || reader.number("yield", curve.yield_stress.as_ref());
    Ok(match formula {
        // n = 1 would be a straight line that never leaves the elastic one, or never meets it.
        Formula::Hollomon => Law::Hollomon {
            n: n(Allowed::Within(1e-4, 0.99))?,
            k: reader.within("K", curve.k.as_ref(), Allowed::Positive)?,
        },
        Formula::Ludwik => {
            Law::Ludwik { yield_stress: yield_stress()?, k: reader.number("K", curve.k.as_ref())?, n: exponent()? }
        }
        Formula::Swift => Law::Swift {
            k: reader.within("K", curve.k.as_ref(), Allowed::Positive)?,
            prestrain: reader.number("prestrain", curve.prestrain.as_ref())?,
            n: exponent()?,
        },
        Formula::Voce => voce(&reader, curve)?,
        Formula::RambergOsgood => Law::RambergOsgood {
            yield_stress: yield_stress()?,
            offset: keys.si(&curve.offset)?,
            n: n(Allowed::Within(1.01, 1000.0))?,
        },
        Formula::JohnsonCook => Law::JohnsonCook {
            a: reader.number("A", curve.a.as_ref())?,
            b: reader.number("B", curve.b.as_ref())?,
            n: exponent()?,
        },
    })
}

fn voce(reader: &Reader<'_>, curve: &RawCurve) -> Result<Law> {
    let yield_stress = reader.number("yield", curve.yield_stress.as_ref())?;
    let saturation = reader.number("saturation", curve.saturation.as_ref())?;
    if saturation <= yield_stress {
        let message = format!("{saturation:e} Pa is not above the yield stress {yield_stress:e} Pa");
        let error = reader.error(curve.saturation.place().unwrap_or_default(), "saturation", message);
        let help = "set `saturation` to the stress that the curve approaches from below";
        return Err(error.allowed("saturation > yield").help(help).into());
    }
    Ok(Law::Voce { yield_stress, saturation, strain: reader.number("strain", curve.strain.as_ref())? })
}

/// Refuses constants where there is no formula.
pub(super) fn refuse_constants(curve: &RawCurve, name: &str, keys: Keys<'_>) -> Result<()> {
    let Some((key, place)) = given(curve).next() else { return Ok(()) };
    let error = keys.error(place, &format!("{name}.{key}"), "is a constant of a formula, but `formula` is not given");
    Err(error.help("add e.g. formula = \"hollomon\", or remove the constant").into())
}

/// The constants that are given, with their places.
fn given(curve: &RawCurve) -> impl Iterator<Item = (&'static str, Range<usize>)> {
    let all = [
        ("K", curve.k.place()),
        ("n", curve.n.place()),
        ("A", curve.a.place()),
        ("B", curve.b.place()),
        ("yield", curve.yield_stress.place()),
        ("saturation", curve.saturation.place()),
        ("strain", curve.strain.place()),
        ("prestrain", curve.prestrain.place()),
        ("offset", curve.offset.place()),
    ];
    all.into_iter().filter_map(|(key, place)| Some((key, place?)))
}
