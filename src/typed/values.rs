//! Types of values, and how they are read.

use std::marker::PhantomData;
use std::ops::Range as Span;

use serde::de::{Deserialize, Deserializer};
use toml::Spanned;

use crate::error::Result;
use crate::input::{Allowed, Document, Number};
use crate::units::{Dimension, Measure};

/// Value with its position in the text.
#[derive(Debug, Clone)]
pub struct Placed<T>(pub(super) Spanned<T>);

impl<T> Placed<T> {
    /// Returns the byte range of the value in the text.
    pub fn span(&self) -> Span<usize> {
        self.0.span()
    }

    /// Returns the value.
    pub fn get_ref(&self) -> &T {
        self.0.get_ref()
    }
}

impl<'de, T: Deserialize<'de>> Deserialize<'de> for Placed<T> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> std::result::Result<Self, D::Error> {
        Spanned::deserialize(deserializer).map(Self)
    }
}

/// Range of numbers, as a type.
pub trait Range {
    /// Range.
    const ALLOWED: Allowed;
}

/// Declares ranges. Each row contains the Rust name, which is that of the variant of [`Allowed`]; bounds are multiples of 1/PER.
macro_rules! ranges {
    ($($(#[doc = $doc:literal])* $name:ident $(($low:ident, $high:ident))?;)*) => {
        $(
            $(#[doc = $doc])*
            #[derive(Debug, Clone, Copy)]
            pub struct $name $(<const $low: i64, const $high: i64, const PER: i64 = 1>)?;

            impl $(<const $low: i64, const $high: i64, const PER: i64>)? Range for $name $(<$low, $high, PER>)? {
                const ALLOWED: Allowed = Allowed::$name $(($low as f64 / PER as f64, $high as f64 / PER as f64))?;
            }
        )*
    };
}

ranges! {
    /// Any finite number.
    Finite;
    /// value > 0.
    Positive;
    /// value >= 0.
    NotNegative;
    /// LOW/PER <= value <= HIGH/PER.
    Within(LOW, HIGH);
    /// LOW/PER < value <= HIGH/PER.
    Above(LOW, HIGH);
    /// LOW/PER <= value < HIGH/PER.
    Below(LOW, HIGH);
    /// LOW/PER < value < HIGH/PER.
    Between(LOW, HIGH);
}

/// Range of Poisson's ratio: 0 to 0.5.
pub type Poisson = Within<0, 1, 2>;

/// Quantity with one dimension in an axial bar and another one in torsion.
#[derive(Debug, Clone, Copy)]
pub struct Either<A, T>(PhantomData<(A, T)>);

impl<A: Measure, T: Measure> Measure for Either<A, T> {
    const DIMENSION: Dimension = A::DIMENSION;
    const IN_TORSION: Dimension = T::DIMENSION;
}

/// Number with its dimension and range; required unless inside an [`Option`].
#[derive(Debug, Clone)]
pub struct Of<D, R = Finite>(Number, PhantomData<(D, R)>);

/// Whole number from LOW to HIGH.
#[derive(Debug, Clone)]
pub struct Count<const LOW: usize, const HIGH: usize>(Number);

/// Number with the default N/PER. (The attribute `schemars(default)` marks it as optional in the schema.)
#[derive(Debug, Clone)]
pub struct Or<K, const N: i64, const PER: i64 = 1>(Option<K>);

/// Row of a table.
pub type Row = Placed<Vec<Number>>;

/// Rows [x, value] with x >= 0.
#[derive(Debug, Clone)]
pub struct Rows<X, D, R = Finite>(Vec<Row>, PhantomData<(X, D, R)>);

/// Table whose keys depend on other keys; it is read when these are known, see [`Parsed::take`](crate::input::Parsed::take).
#[derive(Debug, Clone)]
pub struct Later<T>(PhantomData<T>);

impl<'de, T> Deserialize<'de> for Later<T> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> std::result::Result<Self, D::Error> {
        serde::de::IgnoredAny::deserialize(deserializer).map(|_| Self(PhantomData))
    }
}

/// Key whose value is a number.
pub trait Key {
    /// Type of the number in SI units; an option if the key may be absent.
    type Si;

    /// Returns the number in SI units.
    ///
    /// # Errors
    /// An input error with its position, if the unit is wrong or the number is out of range.
    fn si(&self, document: &Document, torsion: bool) -> Result<Self::Si>;

    /// Returns the number as it was typed, if it is given.
    fn typed(&self) -> Option<&Number>;

    /// Returns the position of the number, if it is given.
    fn place(&self) -> Option<Span<usize>> {
        self.typed().map(Number::span)
    }
}

impl<X: Measure, D: Measure, R: Range> Rows<X, D, R> {
    /// Returns the position of a row; `None` beyond the last row.
    pub fn place(&self, row: usize) -> Option<Span<usize>> {
        self.0.get(row).map(Placed::span)
    }

    /// Returns the rows in SI units; `key` is the key of the list, `names` are the names of the columns.
    ///
    /// # Errors
    /// An input error with its position: a row with a wrong number of entries, a wrong unit, or a value out of range.
    pub fn pairs(&self, document: &Document, torsion: bool, key: &str, names: [&str; 2]) -> Result<Vec<(f64, f64)>> {
        let dimension = if torsion { D::IN_TORSION } else { D::DIMENSION };
        pairs(&self.0, document, key, names, ([X::DIMENSION, dimension], R::ALLOWED))
    }
}

/// Returns rows with two columns in SI units, the first column >= 0, as [`Rows::pairs`] does, for dimensions that are known only at run time.
///
/// # Errors
/// As for [`Rows::pairs`].
pub fn pairs(
    rows: &[Row],
    document: &Document,
    key: &str,
    names: [&str; 2],
    (dimensions, allowed): ([Dimension; 2], Allowed),
) -> Result<Vec<(f64, f64)>> {
    let pair = |(i, row): (usize, &Row)| {
        let [x, value] = row.get_ref().as_slice() else {
            let message = format!("a row has {} entries", row.get_ref().len());
            let error = document.error(row.span(), &format!("{key}.{i}"), message);
            let [at, example] = dimensions.map(Dimension::example);
            let help = format!("write [{}, {}], e.g. [\"{at}\", \"{example}\"]", names[0], names[1]);
            return Err(error.allowed(format!("2 entries: {} and {}", names[0], names[1])).help(help).into());
        };
        let under = |name: &str| format!("{key}.{i}.{name}");
        let x = document.number_under(x, || under(names[0]), dimensions[0], Allowed::NotNegative)?;
        Ok((x, document.number_under(value, || under(names[1]), dimensions[1], allowed)?))
    };
    rows.iter().enumerate().map(pair).collect()
}

impl<D: Measure, R: Range> Of<D, R> {
    /// Returns the number in SI units; `allowed` is a narrower range that depends on other values.
    ///
    /// # Errors
    /// As for [`Key::si`].
    pub fn si_within(&self, document: &Document, allowed: Allowed) -> Result<f64> {
        document.number_at(&self.0, D::DIMENSION, allowed)
    }

    /// Returns the position of the number.
    pub fn span(&self) -> Span<usize> {
        self.0.span()
    }
}

impl<const LOW: usize, const HIGH: usize> Count<LOW, HIGH> {
    /// Returns the position of the number.
    pub fn span(&self) -> Span<usize> {
        self.0.span()
    }
}

impl<D, R> std::fmt::Display for Of<D, R> {
    /// Writes the number as it was typed.
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        self.0.get_ref().fmt(f)
    }
}

/// Key with exactly one number.
pub trait OneNumber: Key {
    /// Converts a number in SI units into the value of the key.
    fn of(si: f64) -> Self::Si;
}

impl<D: Measure, R: Range> OneNumber for Of<D, R> {
    fn of(si: f64) -> f64 {
        si
    }
}

impl<const LOW: usize, const HIGH: usize> OneNumber for Count<LOW, HIGH> {
    fn of(si: f64) -> usize {
        si as usize
    }
}

impl<D: Measure, R: Range> Key for Of<D, R> {
    type Si = f64;

    fn si(&self, document: &Document, torsion: bool) -> Result<f64> {
        let dimension = if torsion { D::IN_TORSION } else { D::DIMENSION };
        document.number_at(&self.0, dimension, R::ALLOWED)
    }

    fn typed(&self) -> Option<&Number> {
        Some(&self.0)
    }
}

impl<K: OneNumber, const N: i64, const PER: i64> Key for Or<K, N, PER> {
    type Si = K::Si;

    fn si(&self, document: &Document, torsion: bool) -> Result<K::Si> {
        self.0.as_ref().map_or(Ok(K::of(N as f64 / PER as f64)), |given| given.si(document, torsion))
    }

    fn typed(&self) -> Option<&Number> {
        self.0.typed()
    }
}

impl<const LOW: usize, const HIGH: usize> Key for Count<LOW, HIGH> {
    type Si = usize;

    fn si(&self, document: &Document, _: bool) -> Result<usize> {
        document.count_at(&self.0, LOW, HIGH)
    }

    fn typed(&self) -> Option<&Number> {
        Some(&self.0)
    }
}

impl<K: Key> Key for &K {
    type Si = K::Si;

    fn si(&self, document: &Document, torsion: bool) -> Result<Self::Si> {
        (*self).si(document, torsion)
    }

    fn typed(&self) -> Option<&Number> {
        (*self).typed()
    }
}

impl<K: Key> Key for Option<K> {
    type Si = Option<K::Si>;

    fn si(&self, document: &Document, torsion: bool) -> Result<Self::Si> {
        self.as_ref().map(|key| key.si(document, torsion)).transpose()
    }

    fn typed(&self) -> Option<&Number> {
        self.as_ref().and_then(Key::typed)
    }
}

impl<K, const N: i64, const PER: i64> Default for Or<K, N, PER> {
    fn default() -> Self {
        Self(None)
    }
}

impl<'de, D: Measure, R> Deserialize<'de> for Of<D, R> {
    fn deserialize<S: Deserializer<'de>>(deserializer: S) -> std::result::Result<Self, S::Error> {
        let number = Number::deserialize(deserializer).map_err(|error| missing::<D, S::Error>(error))?;
        Ok(Self(number, PhantomData))
    }
}

impl<'de, K: Deserialize<'de>, const N: i64, const PER: i64> Deserialize<'de> for Or<K, N, PER> {
    fn deserialize<S: Deserializer<'de>>(deserializer: S) -> std::result::Result<Self, S::Error> {
        // Deserialized as an option, so that the key may be absent.
        Option::deserialize(deserializer).map(Self)
    }
}

impl<'de, X, D, R> Deserialize<'de> for Rows<X, D, R> {
    fn deserialize<S: Deserializer<'de>>(deserializer: S) -> std::result::Result<Self, S::Error> {
        Vec::deserialize(deserializer).map(|rows| Self(rows, PhantomData))
    }
}

impl<'de, const LOW: usize, const HIGH: usize> Deserialize<'de> for Count<LOW, HIGH> {
    fn deserialize<S: Deserializer<'de>>(deserializer: S) -> std::result::Result<Self, S::Error> {
        Number::deserialize(deserializer).map(Self)
    }
}

/// Adds to the error for a missing key what to write; [`Document::parse`] converts it into the help line.
fn missing<D: Measure, E: serde::de::Error>(error: E) -> E {
    let text = error.to_string();
    let Some(name) = text.strip_prefix("missing field `").and_then(|rest| rest.split('`').next()) else { return error };
    let add = |dimension: Dimension| format!("{}, e.g. {name} = \"{}\"", dimension.describe(), dimension.example());
    let (axial, twisted) = (D::DIMENSION, D::IN_TORSION);
    let also = if axial == twisted { String::new() } else { format!("; in torsion {}", add(twisted)) };
    E::custom(format!("missing field `{name}`\nadd {}{also}", add(axial)))
}
