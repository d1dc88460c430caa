//! `[left]` and `[right]`: the kinds of ends, and the keys of each kind.

use std::borrow::Cow;

use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::Deserialize;
use serde_json::json;

use super::MaterialChoice;
use super::along::Motion;
use super::body::{BodyKeys, raw_body};
use super::history_file::HistoryFile;
use crate::error::Result;
use crate::input::{Document, GivenKey, Table};
use crate::typed::{Either, NotNegative, Of, Or, Placed, Plain, Poisson, Positive, Rows, keys_of};
use crate::units::measures;

/// Declares the kinds. Each row contains the word, the variant of [`RawEnd`] and its keys, and the variant and keys in torsion if these differ.
macro_rules! kinds {
    ($($(#[doc = $doc:literal])* $word:literal: $kind:ident($keys:ident) $(, in torsion $twisted:ident($twisted_keys:ident))?;)*) => {
        /// Kind of an end.
        #[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
        pub enum EndKind {
            $($(#[doc = $doc])* #[serde(rename = $word)] $kind,)*
        }

        /// End with the keys of its kind.
        #[derive(Debug)]
        pub enum RawEnd {
            $($kind($keys), $($twisted($twisted_keys),)?)*
        }

        impl EndKind {
            /// Returns the kind as written in scenes.
            pub(in crate::scene) fn word(self) -> &'static str {
                match self { $(Self::$kind => $word,)* }
            }

            /// All kinds.
            pub(in crate::scene) const ALL: &[Self] = &[$(Self::$kind,)*];

            fn doc(self) -> &'static str {
                match self { $(Self::$kind => concat!($($doc),*),)* }
            }

            /// Returns the names of the keys of this kind, except `kind`.
            fn names(self, torsion: bool) -> &'static [&'static str] {
                match self {
                    $($(Self::$kind if torsion => keys_of::<$twisted_keys>(),)?
                      Self::$kind => keys_of::<$keys>(),)*
                }
            }

            /// Reads the keys of an end of this kind.
            fn keys(self, table: Table<'_>, torsion: bool) -> Result<RawEnd> {
                Ok(match self {
                    $($(Self::$kind if torsion => RawEnd::$twisted(table.read::<$twisted_keys>()?),)?
                      Self::$kind => RawEnd::$kind(table.read::<$keys>()?),)*
                })
            }
        }

        impl JsonSchema for RawEnd {
            fn schema_name() -> Cow<'static, str> {
                "RawEnd".into()
            }

            fn json_schema(generator: &mut SchemaGenerator) -> Schema {
                let kinds = [
                    $(of_kind::<$keys>(generator, EndKind::$kind, ""),
                      $(of_kind::<$twisted_keys>(generator, EndKind::$kind, " In torsion."),)?)*
                ];
                json_schema!({ "description": "Boundary condition of an end.", "anyOf": kinds })
            }
        }
    };
}

kinds! {
    /// Prescribed velocity: exactly one of `value`, `history` and `csv`.
    "velocity": Velocity(VelocityEnd);
    /// Prescribed stress, tension positive: exactly one of `value`, `history` and `csv`.
    "stress": Stress(StressEnd);
    /// In torsion: prescribed torque, likewise.
    "torque": Torque(TorqueEnd);
    /// No stress.
    "free": Free(NoKeys);
    /// No motion.
    "fixed": Fixed(NoKeys);
    /// Elastic waves leave without reflection.
    "absorbing": Absorbing(NoKeys);
    /// A linear dashpot to the ground; the bar needs an area.
    "dashpot": Dashpot(Dashpot);
    /// A rigid wall in unilateral contact (compression only); not in torsion.
    "wall": Wall(Wall);
    /// A rigid mass in contact with the end at t = 0; it separates when the contact force vanishes; the bar needs an area.
    "striker": Striker(Striker), in torsion TwistingStriker(TwistingStriker);
    /// An elastic ball in contact at t = 0; Hertzian contact, compression only; the bar needs an area.
    "ball": Ball(Ball), in torsion BallOnLever(BallOnLever);
    /// A linear spring to the ground; the bar needs an area.
    "spring": Spring(Spring);
}

/// Key that all kinds of ends have.
#[derive(Debug, Deserialize)]
pub struct AnyEnd {
    pub kind: Placed<EndKind>,
}

impl RawEnd {
    /// Removes the kind of an end from its table and returns it.
    pub(in crate::scene) fn kind(table: &mut Table<'_>) -> Result<Placed<EndKind>> {
        table.split_off("kind").read::<AnyEnd>().map(|end| end.kind)
    }

    /// Reads the remaining keys of an end; keys of other kinds are refused.
    pub(in crate::scene) fn read(
        document: &Document,
        end: &str,
        kind: EndKind,
        table: Table<'_>,
        torsion: bool,
    ) -> Result<Self> {
        only_its_keys(document, kind, end, &table, torsion)?;
        kind.keys(table, torsion)
    }
}

/// Refuses keys of other kinds, and unknown keys.
fn only_its_keys(document: &Document, kind: EndKind, end: &str, table: &Table<'_>, torsion: bool) -> Result<()> {
    let own = kind.names(torsion);
    let of_another =
        |name: &str| EndKind::ALL.iter().any(|k| [false, true].iter().any(|&t| k.names(t).contains(&name)));
    let foreign = table.keys().into_iter().find(|given| !own.contains(&&*given.name));
    let Some(GivenKey { name, key, value }) = foreign else { return Ok(()) };
    let path = format!("{end}.{name}");
    if !of_another(&name) {
        return Err(document.key_error(key, &path, &name, &[&["kind"], own].concat()).into());
    }
    let wherever = if torsion { " in torsion" } else { "" };
    let message = format!("`{name}` does not apply to an end of kind \"{}\"{wherever}", kind.word());
    let allowed = if own.is_empty() { "kind alone".to_owned() } else { format!("kind, {}", own.join(", ")) };
    let help = match (name.as_str(), kind) {
        ("mass", EndKind::Striker) if torsion => "give the striker's `inertia`, e.g. inertia = \"2 kg*m^2\"".to_owned(),
        _ => format!("remove `{name}`, or use another kind of end"),
    };
    Err(document.error(value, &path, message).allowed(allowed).help(help).into())
}

/// Returns the schema of the keys of a kind.
fn of_kind<T: JsonSchema>(generator: &mut SchemaGenerator, kind: EndKind, also: &str) -> Schema {
    let mut schema = T::json_schema(generator);
    schema.insert("description".to_owned(), json!(format!("{}{also}", kind.doc().trim())));
    let kind = json!({ "const": kind.word() });
    if let Some(object) = schema.as_object_mut() {
        let properties = object.entry("properties").or_insert_with(|| json!({}));
        properties["kind"] = kind;
        let required = object.entry("required").or_insert_with(|| json!([]));
        required.as_array_mut().into_iter().for_each(|required| required.push(json!("kind")));
    }
    schema
}

/// Keys of an end without keys of its own.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct NoKeys {}

/// Declares an end with a prescribed quantity, and its own keys.
macro_rules! driven {
    ($name:ident by $measure:ty { $($own:tt)* }) => {
        #[derive(Debug, Deserialize, JsonSchema)]
        #[serde(deny_unknown_fields)]
        pub struct $name {
            /// Constant value from t = 0 on.
            pub value: Option<Of<$measure>>,
            /// Rows [time, value]; 0 before the first row; linear between rows; a repeated time is a jump; the last value is held. Times never decrease.
            pub history: Option<Placed<Rows<measures::Time, $measure>>>,
            /// The same rows from a file with two columns, time and value; its path is relative to the scene file. A header line gives the names of the columns and, in brackets or behind an underscore, their units: `time [us],velocity [ft/s]` or `time_us,velocity_ft/s`. Or columns of a record, as a table.
            pub csv: Option<Placed<HistoryFile<$measure>>>,
            $($own)*
        }

        impl $name {
            pub(in crate::scene) fn history_keys(&self) -> RawHistory<'_, $measure> {
                RawHistory { value: self.value.as_ref(), history: self.history.as_ref(), csv: self.csv.as_ref() }
            }
        }
    };
}

/// Keys that prescribe the value or history of an end.
#[derive(Debug)]
pub struct RawHistory<'a, D> {
    pub value: Option<&'a Of<D>>,
    pub history: Option<&'a Placed<Rows<measures::Time, D>>>,
    pub csv: Option<&'a Placed<HistoryFile<D>>>,
}

driven! { StressEnd by measures::Stress {} }

driven! { TorqueEnd by measures::Torque {} }

driven! { VelocityEnd by Motion {
    /// The time from which the end is free. Default: never.
    pub release: Option<Of<measures::Time, Positive>>,
} }

#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Dashpot {
    /// Its coefficient c; c = rho c0 A lets elastic waves leave without reflection.
    pub coefficient: Of<Either<measures::DampingCoefficient, measures::TorsionalDampingCoefficient>, NotNegative>,
}

#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Wall {
    /// Initial distance from the end.
    #[schemars(default)]
    pub gap: Or<Of<measures::Length, NotNegative>, 0>,
}

#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Striker {
    /// Its mass.
    pub mass: Of<measures::Mass, Positive>,
    /// Initial velocity, positive in +x.
    pub velocity: Of<measures::Velocity>,
}

#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct TwistingStriker {
    /// Its moment of inertia.
    pub inertia: Of<measures::MomentOfInertia, Positive>,
    /// Initial velocity, positive in the same sense of rotation at both ends.
    pub velocity: Of<measures::AngularVelocity>,
}

raw_body! {
    Ball sphere {
        /// Initial velocity, positive in +x.
        pub velocity: Of<measures::Velocity>,
        /// Poisson's ratio of the bar. Default: that of the bar's material.
        pub bar_poisson: Option<Of<Plain, Poisson>>,
    }
}

raw_body! {
    BallOnLever sphere {
        /// Initial velocity, positive in the same sense of rotation at both ends: a ball on a lever at rest meets it with a positive velocity at the left end, with a negative one at the right end.
        pub velocity: Of<measures::Velocity>,
        /// The arm of the rigid lever that it strikes; the torque is force times arm.
        pub arm: Of<measures::Length, Positive>,
    }
}

#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Spring {
    /// Its stiffness.
    pub stiffness: Of<Either<measures::Stiffness, measures::TorsionalStiffness>, Positive>,
}
