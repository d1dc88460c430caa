//! `[bar]`: segments, sections, joints, and what they are made of.

use schemars::JsonSchema;
use serde::Deserialize;
use serde::de::value::SeqAccessDeserializer;
use serde::de::{Deserializer, SeqAccess, Visitor};
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
    /// Cross-section, m^2, > 0; or give `diameter`. Where it changes along the bar, rows [x, area]: x in m from the left end,
    /// increasing, from 0 to the length; straight between rows. Default: none, forces and energies are then per m^2.
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
    /// In torsion, in place of `inner-diameter`: wall of a thin tube, m, > 0, at most `diameter`/20; stress and strain are taken as
    /// even over it, at its mean radius.
    #[schemars(with = "Option<Quantity>")]
    pub wall: Option<Number>,
    /// Material: a library name, a path to a material file, or an inline table. Required for a uniform bar.
    #[schemars(with = "Option<MaterialChoice>")]
    pub material: Option<Spanned<MaterialChoice>>,
    /// Initial velocity, m/s, positive in +x, any finite number. Default: 0.
    #[schemars(with = "Option<Quantity>")]
    pub velocity: Option<Number>,
    /// Initial stress, Pa, tension positive, within the elastic range; in torsion the shear stress of the surface. What held the bar is
    /// taken away at t = 0. By every method, without `damping` and `lateral-inertia`. Default: 0.
    #[schemars(with = "Option<Quantity>")]
    pub stress: Option<Number>,
    /// Initial plastic strain (engineering), positive where the bar was stretched, as left by slow loading in one sense; it hardens.
    /// By every method, with the effect `unloading` or `rate`, without `heat`. Default: 0.
    #[serde(rename = "plastic-strain")]
    #[schemars(with = "Option<Quantity>")]
    pub plastic_strain: Option<Number>,
    /// What kind of wave. Default: "axial". In torsion every segment states its `diameter`, velocities are angular ones
    /// (rad/s), and materials are known in shear (loading = "shear").
    #[schemars(with = "Option<Mode>")]
    pub mode: Option<Spanned<Mode>>,
    /// In torsion: "von-mises" makes shear curves of materials that are known in tension. Default: none, such are refused.
    #[schemars(with = "Option<RawShear>")]
    pub shear: Option<Spanned<RawShear>>,
    /// Segments, left to right; in place of the keys above (`mode` excepted).
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
    /// Round rods and tubes that are twisted.
    Torsion,
}

/// How a curve in tension becomes one in shear.
#[derive(Debug, Clone, Copy, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum RawShear {
    /// By von Mises' rule; needs Poisson's ratio.
    VonMises,
}

/// A uniform piece of the bar.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct RawSegment {
    /// Length, m, > 0. Required.
    #[schemars(with = "Option<Quantity>")]
    pub length: Option<Number>,
    /// Cross-section, m^2, > 0; or give `diameter`. All segments state one, or none does. Where it changes along the
    /// segment, rows [x, area]: x in m from the segment's own left end, increasing, from 0 to its length.
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
    /// In torsion, in place of `inner-diameter`: wall of a thin tube, m, > 0, at most `diameter`/20; stress and strain are taken as
    /// even over it, at its mean radius.
    #[schemars(with = "Option<Quantity>")]
    pub wall: Option<Number>,
    /// Material: a library name, a path to a material file, or an inline table. Required.
    #[schemars(with = "Option<MaterialChoice>")]
    pub material: Option<Spanned<MaterialChoice>>,
    /// Initial velocity, m/s, positive in +x, any finite number. Default: 0.
    #[schemars(with = "Option<Quantity>")]
    pub velocity: Option<Number>,
    /// Initial stress, Pa, tension positive, within the elastic range; in torsion the shear stress of the surface. What held the bar is
    /// taken away at t = 0. By every method, without `damping` and `lateral-inertia`. Default: 0.
    #[schemars(with = "Option<Quantity>")]
    pub stress: Option<Number>,
    /// Initial plastic strain (engineering), positive where the bar was stretched, as left by slow loading in one sense; it hardens.
    /// By every method, with the effect `unloading` or `rate`, without `heat`. Default: 0.
    #[serde(rename = "plastic-strain")]
    #[schemars(with = "Option<Quantity>")]
    pub plastic_strain: Option<Number>,
    /// How this segment meets the next. Default: "bonded".
    #[schemars(with = "Option<RawJoint>")]
    pub joint: Option<Spanned<RawJoint>>,
    /// Initial opening of a contact joint, m, >= 0. Default: 0.
    #[schemars(with = "Option<Quantity>")]
    pub gap: Option<Number>,
    /// With the effect `rupture`: notch factor all over the segment, >= 1; what breaks it is divided by it. Default: 1.
    #[schemars(with = "Option<f64>")]
    pub notch: Option<Number>,
    /// With the effect `rupture`: the same at the joint to the next segment alone (a notch or a poor weld), on top of
    /// `notch` on both sides. Default: 1.
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

// By hand: an untagged derive loses the places of the numbers inside.
impl<'de> Deserialize<'de> for Section {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Choice;

        impl<'de> Visitor<'de> for Choice {
            type Value = Section;

            fn expecting(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
                f.write_str("a number, a text with a unit such as \"1 cm^2\", or rows [x, size] of a taper")
            }

            fn visit_f64<E>(self, value: f64) -> Result<Section, E> {
                Ok(Section::Uniform(Quantity::Number(value)))
            }

            fn visit_i64<E>(self, value: i64) -> Result<Section, E> {
                Ok(Section::Uniform(Quantity::Number(value as f64)))
            }

            fn visit_u64<E>(self, value: u64) -> Result<Section, E> {
                Ok(Section::Uniform(Quantity::Number(value as f64)))
            }

            fn visit_str<E>(self, value: &str) -> Result<Section, E> {
                Ok(Section::Uniform(Quantity::Text(value.to_owned())))
            }

            fn visit_seq<A: SeqAccess<'de>>(self, rows: A) -> Result<Section, A::Error> {
                Vec::deserialize(SeqAccessDeserializer::new(rows)).map(Section::Table)
            }
        }

        deserializer.deserialize_any(Choice)
    }
}

/// How two segments meet.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum RawJoint {
    /// Welded: force and velocity are continuous.
    Bonded,
    /// Touching; carries no tension.
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
