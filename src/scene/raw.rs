//! What the user typed: the mirror of a scene file. Every key is declared once, here, with unit, range and default.

use std::collections::BTreeMap;

use schemars::JsonSchema;
use serde::Deserialize;
use serde::de::value::{MapAccessDeserializer, SeqAccessDeserializer};
use serde::de::{Deserializer, MapAccess, SeqAccess, Visitor};
use toml::Spanned;

use crate::input::Number;
use crate::material::RawMaterial;
use crate::units::Quantity;

/// A scene: one bar, its two ends, how to solve it and what to record. Numbers are SI; a text is a number with
/// its unit, such as "10 in". x runs from the left end, velocities are positive in +x, tension is positive.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(title = "barwave scene")]
pub struct RawScene {
    /// One line for people. Default: the file's name.
    pub title: Option<String>,
    /// The bar: uniform, or a list of segments. Required.
    #[schemars(with = "RawBar")]
    pub bar: Option<Spanned<RawBar>>,
    /// What holds or drives the left end (x = 0). Required.
    #[schemars(with = "RawEnd")]
    pub left: Option<Spanned<RawEnd>>,
    /// What holds or drives the right end. Required.
    #[schemars(with = "RawEnd")]
    pub right: Option<Spanned<RawEnd>>,
    /// What is simulated beyond the curve itself, or "auto": the program finds out. Default: nothing.
    #[serde(default)]
    pub effects: EffectsChoice,
    /// How to solve. Required, for `until`.
    #[schemars(with = "RawSolve")]
    pub solve: Option<Spanned<RawSolve>>,
    /// What to record. Default: 200 frames of stress, strain and velocity.
    #[serde(default)]
    pub record: RawRecord,
}

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

// By hand: an untagged derive loses the places of the numbers inside, and the names of wrong keys.
impl<'de> Deserialize<'de> for MaterialChoice {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Choice;

        impl<'de> Visitor<'de> for Choice {
            type Value = MaterialChoice;

            fn expecting(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
                f.write_str("a material's name, the path of a material file, or a table with the material itself")
            }

            fn visit_str<E>(self, name: &str) -> Result<MaterialChoice, E> {
                Ok(MaterialChoice::Named(name.to_owned()))
            }

            fn visit_map<A: MapAccess<'de>>(self, map: A) -> Result<MaterialChoice, A::Error> {
                let material = RawMaterial::deserialize(MapAccessDeserializer::new(map))?;
                Ok(MaterialChoice::Inline(Box::new(material)))
            }
        }

        deserializer.deserialize_any(Choice)
    }
}

/// What holds or drives an end. A driven end takes exactly one of `value`, `history` and `csv`.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct RawEnd {
    /// What the end is. Required.
    #[schemars(with = "EndKind")]
    pub kind: Spanned<EndKind>,
    /// Velocity (m/s, positive in +x) or stress (Pa, tension positive) that holds from t = 0 on; in torsion an angular velocity
    /// (rad/s), a torque (N m) or a shear stress (Pa).
    #[schemars(with = "Option<Quantity>")]
    pub value: Option<Number>,
    /// Rows [time, velocity or stress]; straight between rows, a repeated time is a jump, the last value holds.
    /// Times in s, >= 0, never decreasing.
    #[schemars(with = "Option<Vec<[Quantity; 2]>>")]
    pub history: Option<Spanned<Vec<Spanned<Vec<Number>>>>>,
    /// The same rows from a file with two columns, time and value; its path is relative to the scene file. A first
    /// line without numbers names the columns and, in brackets, their units: `time [us],velocity [ft/s]`.
    #[schemars(with = "Option<String>")]
    pub csv: Option<Spanned<String>>,
    /// For a velocity end: the time from which it is free, s, > 0. Default: never.
    #[schemars(with = "Option<Quantity>")]
    pub release: Option<Number>,
    /// For a wall: its distance from the end at the start, m, >= 0. Default: 0.
    #[schemars(with = "Option<Quantity>")]
    pub gap: Option<Number>,
    /// For a striker or a ball: its mass, kg, > 0; the bar needs an area. Required for a striker; a ball can state its
    /// density or material instead.
    #[schemars(with = "Option<Quantity>")]
    pub mass: Option<Number>,
    /// For a striker or a ball: its velocity at the start, m/s (in torsion rad/s), positive in +x. Required there.
    #[schemars(with = "Option<Quantity>")]
    pub velocity: Option<Number>,
    /// For a ball: its radius, m, > 0; or give `diameter`.
    #[schemars(with = "Option<Quantity>")]
    pub radius: Option<Number>,
    /// For a ball: its diameter, m, > 0; in place of `radius`.
    #[schemars(with = "Option<Quantity>")]
    pub diameter: Option<Number>,
    /// For a ball: its density, kg/m^3, > 0; in place of `mass`. Default: its material's.
    #[schemars(with = "Option<Quantity>")]
    pub density: Option<Number>,
    /// For a ball: what it is made of, for its density, modulus and Poisson's ratio. It stays elastic.
    #[schemars(with = "Option<MaterialChoice>")]
    pub material: Option<Spanned<MaterialChoice>>,
    /// For a ball: its elastic modulus, Pa, > 0. Default: its material's.
    #[schemars(with = "Option<Quantity>")]
    pub modulus: Option<Number>,
    /// For a ball: its Poisson's ratio, 0 to 0.5. Default: its material's.
    #[schemars(with = "Option<Quantity>")]
    pub poisson: Option<Number>,
    /// For a ball: it does not give way, in place of `modulus` and `poisson`. Default: false.
    #[schemars(with = "Option<bool>")]
    pub rigid: Option<Spanned<bool>>,
    /// For a ball: Poisson's ratio of the bar, 0 to 0.5. Default: that of the bar's material.
    #[serde(rename = "bar-poisson")]
    #[schemars(with = "Option<Quantity>")]
    pub bar_poisson: Option<Number>,
    /// In torsion, for a striker: its moment of inertia, kg m^2, > 0. Required there, in place of `mass`.
    #[schemars(with = "Option<Quantity>")]
    pub inertia: Option<Number>,
    /// For a spring: its stiffness, N/m (in torsion N m/rad), > 0. Required there; the bar needs an area.
    #[schemars(with = "Option<Quantity>")]
    pub stiffness: Option<Number>,
}

/// The kinds of ends.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum EndKind {
    /// The end moves as told.
    Velocity,
    /// The end carries the stress it is told.
    Stress,
    /// In torsion: the end carries the torque it is told.
    Torque,
    /// No stress.
    Free,
    /// No motion.
    Fixed,
    /// Elastic waves leave without reflection.
    Absorbing,
    /// A rigid wall that pushes but does not pull.
    Wall,
    /// A rigid mass that touches the end at the start, pushes, and flies on where it would have to pull.
    Striker,
    /// An elastic ball that touches the end at the start; Hertz's contact, without a pull.
    Ball,
    /// A linear spring to the ground.
    Spring,
}

/// Which effects are simulated.
#[derive(Debug, JsonSchema)]
#[schemars(untagged)]
pub enum EffectsChoice {
    /// Those without which the answer would be another one, as the program finds.
    Auto(AutoWord),
    /// Those that are named.
    Table(Box<RawEffects>),
}

/// The word for it.
#[derive(Debug, Clone, Copy, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum AutoWord {
    /// The program finds the effects.
    Auto,
}

impl Default for EffectsChoice {
    fn default() -> Self {
        Self::Table(Box::default())
    }
}

// By hand, as for `MaterialChoice`.
impl<'de> Deserialize<'de> for EffectsChoice {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Choice;

        impl<'de> Visitor<'de> for Choice {
            type Value = EffectsChoice;

            fn expecting(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
                f.write_str("\"auto\", or a table of effects such as { unloading = \"isotropic\" }")
            }

            fn visit_str<E: serde::de::Error>(self, word: &str) -> Result<EffectsChoice, E> {
                match word {
                    "auto" => Ok(EffectsChoice::Auto(AutoWord::Auto)),
                    _ => Err(E::invalid_value(serde::de::Unexpected::Str(word), &self)),
                }
            }

            fn visit_map<A: MapAccess<'de>>(self, map: A) -> Result<EffectsChoice, A::Error> {
                let effects = RawEffects::deserialize(MapAccessDeserializer::new(map))?;
                Ok(EffectsChoice::Table(Box::new(effects)))
            }
        }

        deserializer.deserialize_any(Choice)
    }
}

/// What is simulated beyond the curve itself: only what is named.
#[derive(Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct RawEffects {
    /// Elastic unloading of yielded points. Default: none, the curve is followed both ways.
    #[schemars(with = "Option<RawUnloading>")]
    pub unloading: Option<Spanned<RawUnloading>>,
    /// Plastic strain takes time; implies unloading = "isotropic" where no unloading is named. Solved with method = "moc"
    /// on a characteristic net. Default: none, the curve holds at any rate.
    /// "material": each segment by the constants that its own material states.
    #[schemars(with = "Option<RateChoice>")]
    pub rate: Option<Spanned<RateChoice>>,
    /// Plastic work warms the bar, and warm metal yields earlier: `{ fraction = 0.9 }`, or `{}`; implies
    /// unloading = "isotropic" where no unloading is named. Needs the materials' `[heat]` constants. Default: none, the bar
    /// stays as cold as its curve.
    #[schemars(with = "Option<RawHeat>")]
    pub heat: Option<Spanned<RawHeat>>,
    /// The bar breaks, and its pieces go on: "critical-strain", `{ energy = "500 ft*lbf/in^3" }` or
    /// `{ spall = "2 GPa" }`. Default: none, the bar holds for ever.
    #[schemars(with = "Option<RawRupture>")]
    pub rupture: Option<Spanned<RawRupture>>,
    /// Damping and a foundation along the whole bar. For the method "fd". Default: none.
    #[schemars(with = "Option<RawDamping>")]
    pub damping: Option<Spanned<RawDamping>>,
    /// Love's correction: the inertia of the sideways motion of a bar that is strained, by the materials' `poisson` and, for
    /// a section given by its area alone, that of a round bar. For the method "fd". Default: false.
    #[serde(rename = "lateral-inertia")]
    #[schemars(with = "Option<bool>")]
    pub lateral_inertia: Option<Spanned<bool>>,
}

/// Forces along the bar, the same in all segments: `{ internal = "20 kPa*s" }`, `{ external = "300 N*s/m^2" }`,
/// `{ foundation = "50 MN/m^2" }`, or several of them.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct RawDamping {
    /// Kelvin and Voigt: stress per strain rate, Pa s, >= 0. Default: 0.
    #[schemars(with = "Option<Quantity>")]
    pub internal: Option<Number>,
    /// Force against the motion, per length of the bar and velocity, N s/m^2, >= 0; the bar needs an area. Default: 0.
    #[schemars(with = "Option<Quantity>")]
    pub external: Option<Number>,
    /// Force against the displacement, per length of the bar and displacement, N/m^2, >= 0; the bar needs an area.
    /// Default: 0.
    #[schemars(with = "Option<Quantity>")]
    pub foundation: Option<Number>,
}

/// Adiabatic heating by plastic work.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct RawHeat {
    /// Fraction of the plastic work that turns into heat, 0 to 1. Default: the material's own, else 0.9.
    #[schemars(with = "Option<f64>")]
    pub fraction: Option<Number>,
}

/// When the bar breaks. Only tension breaks it.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum RawRupture {
    /// At the nominal strain at the largest engineering stress of the curve, or at the end of data that end in rupture.
    CriticalStrain,
    /// Where this energy has been absorbed per volume (all work of strain), J/m^3, > 0.
    #[schemars(with = "Quantity")]
    Energy(Number),
    /// At this tensile stress, Pa, > 0.
    #[schemars(with = "Quantity")]
    Spall(Number),
}

/// Where the law of the strain rate comes from.
#[derive(Debug, JsonSchema)]
#[schemars(untagged)]
pub enum RateChoice {
    /// From the materials: Johnson-Cook, Cowper-Symonds or Malvern, the first of them that a material states; a material
    /// that states none does not feel the rate.
    Material(MaterialWord),
    /// From the scene, the same for all segments.
    Law(Box<RawRate>),
}

/// The word for it.
#[derive(Debug, Clone, Copy, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum MaterialWord {
    /// Each segment's own material.
    Material,
}

// By hand, as for `MaterialChoice`.
impl<'de> Deserialize<'de> for RateChoice {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Choice;

        impl<'de> Visitor<'de> for Choice {
            type Value = RateChoice;

            fn expecting(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
                f.write_str("\"material\", or a table such as { model = \"malvern\", k = \"1e6 1/s\" }")
            }

            fn visit_str<E: serde::de::Error>(self, word: &str) -> Result<RateChoice, E> {
                match word {
                    "material" => Ok(RateChoice::Material(MaterialWord::Material)),
                    _ => Err(E::invalid_value(serde::de::Unexpected::Str(word), &self)),
                }
            }

            fn visit_map<A: MapAccess<'de>>(self, map: A) -> Result<RateChoice, A::Error> {
                Ok(RateChoice::Law(Box::new(RawRate::deserialize(MapAccessDeserializer::new(map))?)))
            }
        }

        deserializer.deserialize_any(Choice)
    }
}

/// A law of the strain rate with its constants: `{ model = "malvern", k = "1e6 1/s" }`,
/// `{ model = "cowper-symonds", D = "40 1/s", q = 5 }` or `{ model = "johnson-cook", C = 0.014, reference = "1 1/s" }`.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct RawRate {
    /// Which law. Required.
    #[schemars(with = "RawModel")]
    pub model: Option<Spanned<RawModel>>,
    /// Malvern: plastic strain rate = k (stress - static)/E; 1/s, > 0.
    #[schemars(with = "Option<Quantity>")]
    pub k: Option<Number>,
    /// Cowper-Symonds: plastic strain rate = D (stress/static - 1)^q; 1/s, > 0.
    #[serde(rename = "D")]
    #[schemars(with = "Option<Quantity>")]
    pub d: Option<Number>,
    /// Cowper-Symonds: the exponent, > 0.
    #[schemars(with = "Option<f64>")]
    pub q: Option<Number>,
    /// Johnson-Cook: stress = static (1 + C ln(rate/reference)), > 0.
    #[serde(rename = "C")]
    #[schemars(with = "Option<f64>")]
    pub c: Option<Number>,
    /// Johnson-Cook: the plastic strain rate at which the curve holds; 1/s, > 0.
    #[schemars(with = "Option<Quantity>")]
    pub reference: Option<Number>,
}

/// The laws of the strain rate.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum RawModel {
    /// Malvern and Sokolovsky: linear in the overstress.
    Malvern,
    /// Cowper and Symonds (Perzyna): a power of the overstress.
    CowperSymonds,
    /// Johnson and Cook: exponential in the overstress.
    JohnsonCook,
}

/// How the yield stress moves with plastic flow.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum RawUnloading {
    /// Tension and compression harden alike.
    Isotropic,
    /// The elastic range keeps its size and moves.
    Kinematic,
    /// This fraction of the hardening is kinematic, 0 to 1.
    #[schemars(with = "Quantity")]
    Mixed(Number),
}

/// How the scene is solved.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct RawSolve {
    /// End time, s, > 0. Required.
    #[schemars(with = "Quantity")]
    pub until: Option<Number>,
    /// Method. Default: "fd"; "moc" where the effects include `rate`, no rupture and no heat.
    #[schemars(with = "Option<RawMethod>")]
    pub method: Option<Spanned<RawMethod>>,
    /// In place of a method: the error that the run is to stay below, relative L1 of stress over the bar at the end time,
    /// 0 < tolerance <= 0.5. The cheapest method and resolution that meet it are chosen.
    #[schemars(with = "Option<f64>")]
    pub tolerance: Option<Number>,
    /// Scheme of the method "fd". Default: "leapfrog".
    #[schemars(with = "Option<RawScheme>")]
    pub scheme: Option<Spanned<RawScheme>>,
    /// For the method "fd", and for "moc" with the effect `rate`: cells over the whole bar, a whole number, 2 to
    /// 100000000. Default: 1000.
    #[schemars(with = "Option<u64>")]
    pub cells: Option<Number>,
    /// For the method "fd": Courant number of the fastest wave, 0 < cfl <= 1. Default: 1; 0.995 with contact joints or a
    /// wall across a gap, where at 1 the grid can ring.
    #[schemars(with = "Option<f64>")]
    pub cfl: Option<Number>,
    /// Relative change of the stress from which on the audit says that an effect that was left out matters, and
    /// `effects = "auto"` turns it on; 0 < audit-tolerance < 1. Default: 0.01.
    #[serde(rename = "audit-tolerance")]
    #[schemars(with = "Option<f64>")]
    pub audit_tolerance: Option<Number>,
    /// For the method "moc": waves weaker than this part of the largest stress that the scene's data can reach are held
    /// back until the next front passes, 0 <= front-tolerance < 1; 0 sends every wave. Default: 0.001.
    #[serde(rename = "front-tolerance")]
    #[schemars(with = "Option<f64>")]
    pub front_tolerance: Option<Number>,
    /// For the method "moc": most meetings of fronts that the run may take, a whole number, 1 to 1000000000000. Default:
    /// 10000000.
    #[serde(rename = "event-budget")]
    #[schemars(with = "Option<u64>")]
    pub event_budget: Option<Number>,
}

/// The methods.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum RawMethod {
    /// Finite differences.
    Fd,
    /// Characteristics: the fronts themselves are followed.
    Moc,
}

/// The schemes of the method "fd".
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum RawScheme {
    /// Staggered in space and time.
    Leapfrog,
    /// Conservative: limited slopes in cells, the exact Riemann problem at the faces between them.
    Muscl,
}

/// What is recorded. At most one of `frames`, `every` and `times`.
#[derive(Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct RawRecord {
    /// Frames of the fields, evenly spaced from t = 0 to the end, both included; 1 is the end alone. A whole
    /// number, 1 to 10000000. Default: 200.
    #[schemars(with = "Option<u64>")]
    pub frames: Option<Number>,
    /// Time between frames, s, > 0; the first is at t = 0, the end is included.
    #[schemars(with = "Option<Quantity>")]
    pub every: Option<Number>,
    /// Times of the frames, s, increasing, from 0 to `solve.until`.
    #[schemars(with = "Option<Vec<Quantity>>")]
    pub times: Option<Spanned<Vec<Number>>>,
    /// Samples of the fields over x, at the cell centres of an even grid; a whole number, 1 to 100000000.
    /// Default: the solver's own cells; 1000 where fronts are tracked, which needs none.
    #[schemars(with = "Option<u64>")]
    pub cells: Option<Number>,
    /// For the method "moc": record the straight pieces of all fronts. Default: true.
    #[schemars(with = "Option<bool>")]
    pub paths: Option<Spanned<bool>>,
    /// Fields: "stress", "strain", "velocity", "displacement"; with unloading also `"plastic_strain"` and
    /// `"accumulated_plastic_strain"`, with heat `"temperature"`. Default: stress, strain and velocity.
    #[schemars(with = "Option<Vec<String>>")]
    pub fields: Option<Vec<Spanned<String>>>,
    /// Full-rate histories: name = place, m from the left end, within the bar. Default: none.
    #[schemars(with = "BTreeMap<String, Quantity>")]
    #[serde(default)]
    pub gauges: BTreeMap<String, Number>,
    /// Numbers of the fields in the file. Default: "f64".
    pub precision: Option<RawPrecision>,
    /// Compression of the fields in the file. Default: "deflate".
    pub compression: Option<RawCompression>,
}

/// Size of the numbers in the file.
#[derive(Debug, Clone, Copy, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum RawPrecision {
    /// 8 bytes.
    F64,
    /// 4 bytes.
    F32,
}

/// Compression of the fields in the file.
#[derive(Debug, Clone, Copy, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum RawCompression {
    /// Shuffle and deflate: small.
    Deflate,
    /// Shuffle and lzf: faster, larger.
    Lzf,
    /// None.
    None,
}
