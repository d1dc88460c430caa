//! `[bar]`: segments, sections, joints, and what they are made of.

use std::marker::PhantomData;

use schemars::JsonSchema;
use serde::Deserialize;
use serde::de::value::{MapAccessDeserializer, SeqAccessDeserializer};
use serde::de::{Deserializer, Error as _, MapAccess, SeqAccess, Unexpected, Visitor};
use toml::Spanned;

use super::choice::text_or_table;
use crate::input::Number;
use crate::material::RawMaterial;
use crate::units::Quantity;

/// A uniform bar (length, material, ...), or `[[bar.segment]]` tables from left to right.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct RawBar {
    /// Length, m, > 0. Required for a uniform bar.
    #[schemars(with = "Option<Quantity>")]
    pub length: Option<Number>,
    /// Cross-section, m^2, > 0; or give `diameter`. For a tapered bar: rows [x, area] with x in m from the left end, increasing from 0 to
    /// the length; linear between rows. Default: none, forces and energies are then per m^2.
    #[schemars(with = "Option<Section>")]
    pub area: Option<Spanned<Section>>,
    /// Diameter of a round section, m, > 0; in place of `area`, and as a table likewise (a cone is straight between rows).
    #[schemars(with = "Option<Section>")]
    pub diameter: Option<Spanned<Section>>,
    /// In torsion: inner diameter of a tube, m, > 0, below `diameter`, which is then the outer one; stresses and strains are those
    /// of the outer surface. Default: none, a solid rod.
    #[serde(rename = "inner-diameter")]
    #[schemars(with = "Option<Quantity>")]
    pub inner_diameter: Option<Number>,
    /// In torsion, in place of `inner-diameter`: wall of a thin tube, m, > 0, at most `diameter`/20; stress and strain are uniform over
    /// it, at its mean radius.
    #[schemars(with = "Option<Quantity>")]
    pub wall: Option<Number>,
    /// Material: a library name, a path to a material file, or an inline table. Required for a uniform bar.
    #[schemars(with = "Option<MaterialChoice>")]
    pub material: Option<Spanned<MaterialChoice>>,
    /// Initial velocity, m/s (in torsion rad/s), positive in +x, any finite number; where it changes along the bar: x from its left end,
    /// rows [x, velocity] or { csv = "file.csv" }, as for all initial values. Default: 0.
    #[schemars(with = "Option<RawDistribution>")]
    pub velocity: Option<Spanned<RawDistribution>>,
    /// Initial stress, Pa, tension positive, within the elastic range; in torsion the shear stress of the surface. What held the bar is
    /// taken away at t = 0. Default: 0.
    #[schemars(with = "Option<RawDistribution>")]
    pub stress: Option<Spanned<RawDistribution>>,
    /// Initial strain (engineering, plastic strain included), in place of `stress`.
    #[schemars(with = "Option<RawDistribution>")]
    pub strain: Option<Spanned<RawDistribution>>,
    /// Initial plastic strain (engineering), positive where the bar was stretched, as left by slow loading; it hardens. With the effect
    /// `unloading` or `rate`; with `heat` by leapfrog. Default: 0.
    #[serde(rename = "plastic-strain")]
    #[schemars(with = "Option<RawDistribution>")]
    pub plastic_strain: Option<Spanned<RawDistribution>>,
    /// Initial accumulated plastic strain, at least the size of `plastic-strain`; with isotropic hardening, which depends on it. Default:
    /// the size of `plastic-strain`, that of loading in one sense.
    #[serde(rename = "accumulated-plastic-strain")]
    #[schemars(with = "Option<RawDistribution>")]
    pub accumulated_plastic_strain: Option<Spanned<RawDistribution>>,
    /// Initial temperature, K, at least the material's reference temperature and below melting; with the effect `heat`, by leapfrog.
    /// Default: the reference temperature.
    #[schemars(with = "Option<RawDistribution>")]
    pub temperature: Option<Spanned<RawDistribution>>,
    /// Type of wave. Default: "axial". In torsion every segment has a `diameter`, velocities are angular (rad/s), and materials have
    /// shear curves (loading = "shear").
    #[schemars(with = "Option<Mode>")]
    pub mode: Option<Spanned<Mode>>,
    /// In torsion: "von-mises" converts tension curves to shear. Default: none; tension curves are refused.
    #[schemars(with = "Option<RawShear>")]
    pub shear: Option<Spanned<RawShear>>,
    /// Segments, left to right; in place of the keys above (`mode` and tables of initial values excepted).
    #[schemars(with = "Option<Vec<RawSegment>>")]
    pub segment: Option<Vec<Spanned<RawSegment>>>,
}

impl RawBar {
    /// The bar is twisted.
    pub(in crate::scene) fn is_torsion(&self) -> bool {
        self.mode.as_ref().is_some_and(|mode| *mode.get_ref() == Mode::Torsion)
    }
}

/// What kind of wave runs along the bar.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Mode {
    /// Tension and compression.
    Axial,
    /// Torsion of round rods and tubes.
    Torsion,
}

/// How a curve in tension becomes one in shear.
#[derive(Debug, Clone, Copy, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum RawShear {
    /// By the von Mises yield criterion; needs Poisson's ratio.
    VonMises,
}

/// A uniform piece of the bar.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct RawSegment {
    /// Length, m, > 0. Required.
    #[schemars(with = "Option<Quantity>")]
    pub length: Option<Number>,
    /// Cross-section, m^2, > 0; or give `diameter`. All segments state one, or none does. For a tapered segment: rows [x, area] with x in
    /// m from its own left end, increasing from 0 to its length.
    #[schemars(with = "Option<Section>")]
    pub area: Option<Spanned<Section>>,
    /// Diameter of a round section, m, > 0; in place of `area`, and as a table likewise.
    #[schemars(with = "Option<Section>")]
    pub diameter: Option<Spanned<Section>>,
    /// In torsion: inner diameter of a tube, m, > 0, below `diameter`, which is then the outer one; stresses and strains are those
    /// of the outer surface. Default: none, a solid rod.
    #[serde(rename = "inner-diameter")]
    #[schemars(with = "Option<Quantity>")]
    pub inner_diameter: Option<Number>,
    /// In torsion, in place of `inner-diameter`: wall of a thin tube, m, > 0, at most `diameter`/20; stress and strain are uniform over
    /// it, at its mean radius.
    #[schemars(with = "Option<Quantity>")]
    pub wall: Option<Number>,
    /// Material: a library name, a path to a material file, or an inline table. Required.
    #[schemars(with = "Option<MaterialChoice>")]
    pub material: Option<Spanned<MaterialChoice>>,
    /// Initial velocity, m/s (in torsion rad/s), positive in +x, any finite number; where it changes along the segment: x from its own
    /// left end, rows [x, velocity] or { csv = "file.csv" }, as for all initial values. Default: 0.
    #[schemars(with = "Option<RawDistribution>")]
    pub velocity: Option<Spanned<RawDistribution>>,
    /// Initial stress, Pa, tension positive, within the elastic range; in torsion the shear stress of the surface. What held the bar is
    /// taken away at t = 0. Default: 0.
    #[schemars(with = "Option<RawDistribution>")]
    pub stress: Option<Spanned<RawDistribution>>,
    /// Initial strain (engineering, plastic strain included), in place of `stress`.
    #[schemars(with = "Option<RawDistribution>")]
    pub strain: Option<Spanned<RawDistribution>>,
    /// Initial plastic strain (engineering), positive where the bar was stretched, as left by slow loading; it hardens. With the effect
    /// `unloading` or `rate`; with `heat` by leapfrog. Default: 0.
    #[serde(rename = "plastic-strain")]
    #[schemars(with = "Option<RawDistribution>")]
    pub plastic_strain: Option<Spanned<RawDistribution>>,
    /// Initial accumulated plastic strain, at least the size of `plastic-strain`; with isotropic hardening, which depends on it. Default:
    /// the size of `plastic-strain`, that of loading in one sense.
    #[serde(rename = "accumulated-plastic-strain")]
    #[schemars(with = "Option<RawDistribution>")]
    pub accumulated_plastic_strain: Option<Spanned<RawDistribution>>,
    /// Initial temperature, K, at least the material's reference temperature and below melting; with the effect `heat`, by leapfrog.
    /// Default: the reference temperature.
    #[schemars(with = "Option<RawDistribution>")]
    pub temperature: Option<Spanned<RawDistribution>>,
    /// Joint to the next segment. Default: "bonded".
    #[schemars(with = "Option<RawJoint>")]
    pub joint: Option<Spanned<RawJoint>>,
    /// Initial opening of a contact joint, m, >= 0. Default: 0.
    #[schemars(with = "Option<Quantity>")]
    pub gap: Option<Number>,
    /// With the effect `rupture`: stress concentration factor of the whole segment, >= 1; the fracture criterion is divided by it.
    /// Default: 1.
    #[schemars(with = "Option<f64>")]
    pub notch: Option<Number>,
    /// With the effect `rupture`: stress concentration factor of the joint to the next segment (a notch or a poor weld), multiplied by
    /// the `notch` of both sides. Default: 1.
    #[serde(rename = "joint-notch")]
    #[schemars(with = "Option<f64>")]
    pub joint_notch: Option<Number>,
}

/// An area or a diameter: one, or a table of them along the segment.
#[derive(Debug, JsonSchema)]
#[schemars(untagged)]
pub enum Section {
    /// All along.
    Uniform(Quantity),
    /// Rows [x, size].
    Table(#[schemars(with = "Vec<[Quantity; 2]>")] Vec<Spanned<Vec<Number>>>),
}

impl AlongBar for Section {
    const EXPECTED: &str = "a number, a text with a unit such as \"1 cm^2\", or rows [x, size] of a taper";
    const UNIFORM: fn(Quantity) -> Self = Self::Uniform;
    const TABLE: fn(Rows) -> Self = Self::Table;
    const CSV: Option<fn(RawTableFile) -> Self> = None;
}

impl<'de> Deserialize<'de> for Section {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(Choice(PhantomData))
    }
}

/// A quantity along the bar: one value, or a table over x.
#[derive(Debug, JsonSchema)]
#[schemars(untagged)]
pub enum RawDistribution {
    /// All along.
    Uniform(Quantity),
    /// Rows [x, value]: x in m, never decreasing; straight between rows, a repeated x is a jump, beyond the outermost rows their values
    /// hold.
    Table(#[schemars(with = "Vec<[Quantity; 2]>")] Vec<Spanned<Vec<Number>>>),
    /// The same rows from a file.
    Csv(RawTableFile),
}

/// A file with two columns, x and value.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct RawTableFile {
    /// Its path, relative to the scene file. A first line without numbers names the columns and, in brackets, their units:
    /// `x [mm],stress [MPa]`.
    #[schemars(with = "String")]
    pub csv: Spanned<String>,
}

impl AlongBar for RawDistribution {
    const EXPECTED: &str = "a number, a text with a unit, rows [x, value], or { csv = \"file.csv\" }";
    const UNIFORM: fn(Quantity) -> Self = Self::Uniform;
    const TABLE: fn(Rows) -> Self = Self::Table;
    const CSV: Option<fn(RawTableFile) -> Self> = Some(Self::Csv);
}

impl<'de> Deserialize<'de> for RawDistribution {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(Choice(PhantomData))
    }
}

/// Rows [x, value] with their places in the text.
type Rows = Vec<Spanned<Vec<Number>>>;

/// What is given by one value, or along the bar.
trait AlongBar: Sized {
    /// What can be written, for messages.
    const EXPECTED: &str;
    const UNIFORM: fn(Quantity) -> Self;
    const TABLE: fn(Rows) -> Self;
    /// None where it cannot be in a file of its own.
    const CSV: Option<fn(RawTableFile) -> Self>;
}

/// By hand: an untagged derive loses the places of the numbers inside.
struct Choice<T>(PhantomData<T>);

impl<'de, T: AlongBar> Visitor<'de> for Choice<T> {
    type Value = T;

    fn expecting(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(T::EXPECTED)
    }

    fn visit_f64<E>(self, value: f64) -> Result<T, E> {
        Ok(T::UNIFORM(Quantity::Number(value)))
    }

    fn visit_i64<E>(self, value: i64) -> Result<T, E> {
        Ok(T::UNIFORM(Quantity::Number(value as f64)))
    }

    fn visit_u64<E>(self, value: u64) -> Result<T, E> {
        Ok(T::UNIFORM(Quantity::Number(value as f64)))
    }

    fn visit_str<E>(self, value: &str) -> Result<T, E> {
        Ok(T::UNIFORM(Quantity::Text(value.to_owned())))
    }

    fn visit_seq<A: SeqAccess<'de>>(self, rows: A) -> Result<T, A::Error> {
        Vec::deserialize(SeqAccessDeserializer::new(rows)).map(T::TABLE)
    }

    fn visit_map<A: MapAccess<'de>>(self, file: A) -> Result<T, A::Error> {
        let csv = T::CSV.ok_or_else(|| A::Error::invalid_type(Unexpected::Map, &self))?;
        RawTableFile::deserialize(MapAccessDeserializer::new(file)).map(csv)
    }
}

/// How two segments meet.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum RawJoint {
    /// Welded: force and velocity are continuous.
    Bonded,
    /// Unilateral contact; carries no tension.
    Contact,
}

/// A material: by name or path, or given in place.
#[derive(Debug, JsonSchema)]
#[schemars(untagged)]
pub enum MaterialChoice {
    /// A library name, or the path of a material file.
    Named(String),
    /// The material itself.
    Inline(Box<RawMaterial>),
}

impl<'de> Deserialize<'de> for MaterialChoice {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let expecting = "a material's name, the path of a material file, or a table with the material itself";
        let named = |name: &str| Some(Self::Named(name.to_owned()));
        text_or_table(deserializer, expecting, named, |material| Self::Inline(Box::new(material)))
    }
}
