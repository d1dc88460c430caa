//! Keys of `[bar]`: segments, sections, joints and materials.

use std::ops::Range;

use schemars::JsonSchema;
use serde::Deserialize;
use serde::de::Deserializer;

use super::along::{Distributed, Given, Motion, Section};
use crate::material::RawMaterial;
use crate::typed::{Key, NotNegative, Of, Or, Placed, Plain, Positive, Within, text_or_table};
use crate::units::measures::{Area, Length, Stress, Temperature};

/// Largest stress concentration factor; larger ones describe cracks, which need fracture mechanics.
const MOST_NOTCH: i64 = 1000;

/// Stress concentration factor.
pub type Notch = Or<Of<Plain, Within<1, MOST_NOTCH>>, 1>;

/// Keys that a uniform bar and a segment have in common.
#[derive(Debug, Clone)]
pub struct RawPiece<'a> {
    pub length: Option<&'a Of<Length, Positive>>,
    pub area: Option<&'a Placed<Section<Area>>>,
    pub diameter: Option<&'a Placed<Section<Length>>>,
    pub inner_diameter: Option<&'a Of<Length, Positive>>,
    pub wall: Option<&'a Of<Length, Positive>>,
    pub material: Option<&'a Placed<MaterialChoice>>,
    pub initial: RawInitial<'a>,
}

/// Initial values as typed, in the order of [`INITIAL`].
pub type RawInitial<'a> = [Option<Given<'a>>; 6];

/// Keys of the initial values, in this order.
pub(in crate::scene) const INITIAL: [&str; 6] =
    ["velocity", "stress", "strain", "plastic-strain", "accumulated-plastic-strain", "temperature"];

/// Declares a table with the common keys of a piece of a bar, followed by its own keys.
macro_rules! pieces {
    ($($(#[$meta:meta])* $name:ident { $($own:tt)* })*) => {
        $(
            $(#[$meta])*
            #[derive(Debug, Deserialize, JsonSchema)]
            #[serde(deny_unknown_fields, rename_all = "kebab-case")]
            pub struct $name {
                /// Length. Required, except for a bar of segments.
                pub length: Option<Of<Length, Positive>>,
                /// Cross-section; or give `diameter`. Required in all segments or in none. For a taper: rows [x, area] with x from the left end of the segment, increasing from 0 to the length; linear between rows. Default: none; forces and energies are per m^2.
                pub area: Option<Placed<Section<Area>>>,
                /// Diameter of a round section; instead of `area`; also as rows [x, diameter] (conical between rows).
                pub diameter: Option<Placed<Section<Length>>>,
                /// In torsion: inner diameter of a tube, less than the outer `diameter`; stresses and strains are those of the outer surface. Default: none (solid rod).
                pub inner_diameter: Option<Of<Length, Positive>>,
                /// In torsion, instead of `inner-diameter`: wall thickness of a thin tube, at most `diameter`/20; stress and strain are uniform over the wall, at its mean radius.
                pub wall: Option<Of<Length, Positive>>,
                /// Material: a library name, a path to a material file, or an inline table. Required, except for a bar of segments.
                pub material: Option<Placed<MaterialChoice>>,
                /// Initial velocity, positive in +x. Like all initial values, a constant, rows [x, value] with x from the left end of the bar or segment, or { csv = "file.csv" }. Default: 0.
                pub velocity: Option<Placed<Distributed<Motion>>>,
                /// Initial stress, tension positive, within the elastic range; in torsion the shear stress at the surface. External supports are removed at t = 0. Default: 0.
                pub stress: Option<Placed<Distributed<Stress>>>,
                /// Initial strain (engineering, including plastic strain), instead of `stress`.
                pub strain: Option<Placed<Distributed<Plain>>>,
                /// Initial plastic strain (engineering) from quasi-static loading, positive in tension; it hardens. Needs the effect `hardening` or `rate`; with `heat`, leapfrog only. Default: 0.
                pub plastic_strain: Option<Placed<Distributed<Plain>>>,
                /// Initial accumulated plastic strain, at least the magnitude of `plastic-strain`; for isotropic hardening. Default: the magnitude of `plastic-strain` (monotonic loading).
                pub accumulated_plastic_strain: Option<Placed<Distributed<Plain, NotNegative>>>,
                /// Initial temperature, from the reference temperature of the material to below its melting temperature; needs the effect `heat` and leapfrog. Default: the reference temperature.
                pub temperature: Option<Placed<Distributed<Temperature, Positive>>>,
                $($own)*
            }

            impl $name {
                pub(in crate::scene) fn piece(&self) -> RawPiece<'_> {
                    RawPiece {
                        length: self.length.as_ref(),
                        area: self.area.as_ref(),
                        diameter: self.diameter.as_ref(),
                        inner_diameter: self.inner_diameter.as_ref(),
                        wall: self.wall.as_ref(),
                        material: self.material.as_ref(),
                        initial: [
                            self.velocity.as_ref().map(Placed::given),
                            self.stress.as_ref().map(Placed::given),
                            self.strain.as_ref().map(Placed::given),
                            self.plastic_strain.as_ref().map(Placed::given),
                            self.accumulated_plastic_strain.as_ref().map(Placed::given),
                            self.temperature.as_ref().map(Placed::given),
                        ],
                    }
                }
            }
        )*
    };
}

pieces! {
    /// A uniform bar (length, material, ...), or `[[bar.segment]]` tables from left to right.
    RawBar {
        /// Type of wave. Default: "axial". In torsion every segment has a `diameter`, velocities are angular (rad/s), and materials have
        /// shear curves (loading = "shear").
        pub mode: Option<Placed<Mode>>,
        /// In torsion: "von-mises" converts tension curves to shear. Default: none; tension curves are refused.
        pub shear: Option<Placed<RawShear>>,
        /// Segments, left to right; instead of the keys above (except `mode` and tables of initial values).
        pub segment: Option<Vec<Placed<RawSegment>>>,
    }

    /// A uniform piece of the bar.
    RawSegment {
        /// Joint to the next segment. Default: "bonded".
        pub joint: Option<Placed<RawJoint>>,
        /// Initial opening of a contact joint.
        #[schemars(default)]
        pub gap: Or<Of<Length, NotNegative>, 0>,
        /// With the effect `rupture`: stress concentration factor of the whole segment; the fracture criterion is divided by it.
        #[serde(rename = "stress-concentration", alias = "notch")]
        #[schemars(default)]
        pub notch: Notch,
        /// With the effect `rupture`: stress concentration factor of the joint to the next segment (a notch or a poor weld), multiplied by
        /// the `stress-concentration` of both sides.
        #[serde(rename = "joint-stress-concentration", alias = "joint-notch")]
        #[schemars(default)]
        pub joint_notch: Notch,
    }
}

impl RawBar {
    /// Returns whether the bar is in torsion.
    pub(in crate::scene) fn is_torsion(&self) -> bool {
        self.mode.as_ref().is_some_and(|mode| *mode.get_ref() == Mode::Torsion)
    }

    /// Returns the key and the position of the size of a segment's section.
    pub(in crate::scene) fn section_of(&self, segment: usize) -> Option<(String, Range<usize>)> {
        let own = self.segment.as_ref().map(|list| list[segment].get_ref().piece());
        let parent = own.as_ref().map_or_else(|| "bar".to_owned(), |_| format!("bar.segment.{segment}"));
        let piece = own.unwrap_or_else(|| self.piece());
        let (name, span) = match (piece.area, piece.diameter) {
            (Some(area), _) => ("area", area.span()),
            (_, diameter) => ("diameter", diameter?.span()),
        };
        Some((format!("{parent}.{name}"), span))
    }

    /// Returns the key and the position of an initial value of a segment, given in the segment or as a table for the whole bar.
    pub(in crate::scene) fn initial_of(&self, segment: usize, which: usize) -> Option<(String, Range<usize>)> {
        let own = self.segment.as_ref().map(|list| list[segment].get_ref().piece().initial);
        let own = own.and_then(|initial| initial.into_iter().nth(which).flatten());
        let own = own.map(|value| (format!("bar.segment.{segment}.{}", INITIAL[which]), value.span));
        let whole = || self.piece().initial.into_iter().nth(which).flatten();
        own.or_else(|| whole().map(|value| (format!("bar.{}", INITIAL[which]), value.span)))
    }
}

impl RawSegment {
    /// Returns the keys of the stress concentration factors, with their positions if they are given.
    pub(in crate::scene) fn notches(&self) -> [(&'static str, Option<Range<usize>>); 2] {
        [("stress-concentration", self.notch.place()), ("joint-stress-concentration", self.joint_notch.place())]
    }
}

/// Type of wave in the bar.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Mode {
    /// Tension and compression.
    Axial,
    /// Torsion of round rods and tubes.
    Torsion,
}

/// Conversion of a tension curve into a shear curve.
#[derive(Debug, Clone, Copy, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum RawShear {
    /// By the von Mises yield criterion; needs Poisson's ratio.
    VonMises,
}

/// Connection of two segments.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum RawJoint {
    /// Welded: force and velocity are continuous.
    Bonded,
    /// Unilateral contact; carries no tension.
    Contact,
}

/// Material: its name, the path of its file, or the material itself.
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
