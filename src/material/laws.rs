//! Declaration of material laws as stated in files, each once with its constants: the formulas of curves and the rate laws.

use std::ops::Range;

use serde::Serializer;
use serde_json::json;

use crate::error::Result;
use crate::input::{Allowed, Document, Number};
use crate::typed::{self, Key, Of, Or};
use crate::units::{Dimension, Measure};

/// Type of the key of a constant; the key is optional, since other laws do not use it.
pub(super) trait ConstantKey: Key {
    const DIMENSION: Dimension;
    const ALLOWED: Allowed;
    const DEFAULT: Option<f64> = None;
}

impl<D: Measure, R: typed::Range> ConstantKey for Option<Of<D, R>> {
    const DIMENSION: Dimension = D::DIMENSION;
    const ALLOWED: Allowed = R::ALLOWED;
}

impl<D: Measure, R: typed::Range, const N: i64, const PER: i64> ConstantKey for Or<Of<D, R>, N, PER> {
    const DIMENSION: Dimension = D::DIMENSION;
    const ALLOWED: Allowed = R::ALLOWED;
    const DEFAULT: Option<f64> = Some(N as f64 / PER as f64);
}

/// A constant, which is a key of the table `Raw`.
pub(super) struct Constant<Raw> {
    pub(super) key: &'static str,
    /// Example of its value as written in a file.
    pub(super) example: &'static str,
    pub(super) dimension: Dimension,
    pub(super) allowed: Allowed,
    pub(super) default: Option<f64>,
    pub(super) typed: fn(&Raw) -> Option<&Number>,
}

impl<Raw> Constant<Raw> {
    pub(super) const fn new<K: ConstantKey>(key: &'static str, typed: fn(&Raw) -> Option<&Number>) -> Self {
        Self { key, example: "", dimension: K::DIMENSION, allowed: K::ALLOWED, default: K::DEFAULT, typed }
    }

    /// Returns its key and position if it is given.
    pub(super) fn given(&self, raw: &Raw) -> Option<(&'static str, Range<usize>)> {
        Some((self.key, (self.typed)(raw)?.span()))
    }
}

/// A law as stated in files.
pub(super) struct LawKeys<Raw: 'static> {
    /// Key that selects the law by its name.
    pub(super) selector: &'static str,
    pub(super) name: &'static str,
    /// First line of the description.
    pub(super) title: &'static str,
    pub(super) constants: &'static [Constant<Raw>],
}

impl<Raw> LawKeys<Raw> {
    fn join(&self, one: impl FnMut(&Constant<Raw>) -> String) -> String {
        self.constants.iter().map(one).collect::<Vec<_>>().join(", ")
    }

    /// Returns the keys of its constants.
    fn keys(&self) -> String {
        self.join(|constant| constant.key.to_owned())
    }

    /// Returns an example of its constants as written in a file.
    pub(super) fn example(&self) -> String {
        self.join(|constant| format!("{} = {}", constant.key, constant.example))
    }

    /// Returns its constants for display: "K = 530 MPa, n = 0.44".
    pub(super) fn list(&self, values: &[f64], show: impl Fn(f64, Dimension) -> String) -> String {
        let mut values = values.iter();
        self.join(|constant| {
            let value = values.next().map_or_else(String::new, |&value| show(value, constant.dimension));
            format!("{} = {value}", constant.key)
        })
    }

    /// Serializes the law as stated in files.
    pub(super) fn serialize<S: Serializer>(
        &self,
        values: &[f64],
        serializer: S,
    ) -> std::result::Result<S::Ok, S::Error> {
        let constants = self.constants.iter().zip(values).map(|(constant, value)| (constant.key, json!(value)));
        serializer.collect_map(std::iter::once((self.selector, json!(self.name))).chain(constants))
    }

    /// Returns the constants in order, given under `key` at `span` of a document; other constants of `all` are rejected.
    pub(super) fn numbers<const N: usize>(
        &self,
        raw: &Raw,
        all: &[Constant<Raw>],
        document: &Document,
        key: &str,
        span: &Range<usize>,
    ) -> Result<[f64; N]> {
        let selected = format!("{} = \"{}\"", self.selector, self.name);
        let error = |span, constant: &str, message: String| {
            let help = format!("{selected} uses {}; e.g. {}", self.keys(), self.example());
            document.error(span, &format!("{key}.{constant}"), message).help(help)
        };
        let own = |key: &str| self.constants.iter().any(|constant| constant.key == key);
        if let Some((other, place)) = all.iter().filter_map(|c| c.given(raw)).find(|(key, _)| !own(key)) {
            let message = format!("`{other}` is not a constant of {selected}");
            return Err(error(place, other, message).allowed(self.keys()).into());
        }
        let mut numbers = [0.0; N];
        for (number, constant) in numbers.iter_mut().zip(self.constants) {
            let missing = || error(span.clone(), constant.key, format!("`{}` is missing", constant.key));
            *number = match (constant.typed)(raw) {
                Some(typed) => document.number_at(typed, constant.dimension, constant.allowed)?,
                None => constant.default.ok_or_else(missing)?,
            };
        }
        Ok(numbers)
    }
}

/// Declares laws: the enum of the laws (with one more variant, if declared, that has no constants and cannot be selected by name), the enum of
/// their names, and the table of a file in which their constants are keys. A row of a constant consists of its name in Rust, its key, and the type
/// of the key. A row of a law consists of its names in Rust and in files, and its constants by their names in Rust, each with an example, and with
/// a range if it is narrower than that of the key.
macro_rules! laws {
    (
        $(#[doc = $law_doc:literal])*
        enum $law:ident { $($(#[doc = $other_doc:literal])* $other:ident $other_name:literal)? }
        $(#[doc = $name_doc:literal])*
        $vis:vis enum $name:ident by $selector:literal;
        $(#[doc = $raw_doc:literal])*
        struct $raw:ident { $($field:tt)* }
        constants {$(
            $(#[doc = $meaning:literal])*
            $(#[schemars($default:ident)])?
            $c:ident $key:literal: $key_type:ty;
        )*}
        laws {$(
            #[doc = $title:literal]
            $(#[doc = $doc:literal])*
            $variant:ident $text:literal { $($constant:ident = $example:literal $(in $range:expr)?),* }
        )*}
    ) => {
        // Declared properties of a constant, by its name.
        macro_rules! constant {$(
            ($c key) => { Constant::new::<$key_type>($key, |raw: &$raw| raw.$c.typed()) };
            ($c meaning) => { concat!($($meaning,)* " (`", stringify!($key_type), "`)") };
        )*}

        $(#[doc = $law_doc])*
        #[derive(Debug, Clone, Copy, PartialEq)]
        pub enum $law {
            $(
                #[doc = $title]
                $(#[doc = $doc])*
                $variant { $(#[doc = constant!($constant meaning)] $constant: f64,)* },
            )*
            $($(#[doc = $other_doc])* $other,)?
        }

        $(#[doc = $name_doc])*
        #[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize, JsonSchema)]
        $vis enum $name {
            $(#[doc = $title] $(#[doc = $doc])* #[serde(rename = $text)] $variant,)*
        }

        $(#[doc = $raw_doc])*
        #[derive(Debug, Clone, Deserialize, JsonSchema)]
        #[serde(deny_unknown_fields, rename_all = "kebab-case")]
        pub struct $raw {
            $($field)*
            $($(#[doc = $meaning])* $(#[schemars($default)])? #[serde(rename = $key)] $c: $key_type,)*
        }

        impl $raw {
            const CONSTANTS: &'static [Constant<Self>] = &[$(constant!($c key)),*];
        }

        impl $name {
            fn keys(self) -> LawKeys<$raw> {
                let (name, title, constants): (_, &str, &[_]) = match self {
                    $(Self::$variant => ($text, $title, const {
                        &[$(Constant {
                            example: stringify!($example),
                            $(allowed: $range,)?
                            ..constant!($constant key)
                        }),*]
                    }),)*
                };
                LawKeys { selector: $selector, name, title: title.trim_ascii(), constants }
            }

            /// Returns the law with its constants, given under `key` at `span` of a document; constants of other laws are rejected.
            pub(crate) fn law(self, raw: &$raw, document: &Document, key: &str, span: Range<usize>) -> Result<$law> {
                let keys = self.keys();
                Ok(match self {$(
                    Self::$variant => {
                        let [$($constant),*] = keys.numbers(raw, $raw::CONSTANTS, document, key, &span)?;
                        $law::$variant { $($constant),* }
                    }
                )*})
            }
        }

        impl $law {
            /// Returns the keys of the law, and the values of its constants.
            fn stated(self) -> (LawKeys<$raw>, Vec<f64>) {
                match self {
                    $(Self::$variant { $($constant),* } => ($name::$variant.keys(), vec![$($constant),*]),)*
                    $(Self::$other => {
                        (LawKeys { selector: $selector, name: $other_name, title: "", constants: &[] }, Vec::new())
                    })?
                }
            }
        }

        impl Serialize for $law {
            fn serialize<S: Serializer>(&self, serializer: S) -> std::result::Result<S::Ok, S::Error> {
                let (keys, values) = self.stated();
                keys.serialize(&values, serializer)
            }
        }
    };
}
pub(super) use laws;
