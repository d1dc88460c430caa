//! Keys of `[effects]`.

use schemars::JsonSchema;
use serde::{Deserialize, Deserializer};

use super::super::damping::RawDamping;
use crate::material::RawRate;
use crate::typed::{Example, Of, Placed, Plain, Positive, Within, optional_table, text_or_table};
use crate::units::measures::{EnergyDensity, Stress};

/// Effects that are simulated.
#[derive(Debug, JsonSchema)]
#[schemars(untagged)]
pub enum EffectsChoice {
    /// Effects selected by the program: those that change the result by more than the tolerance of the audit.
    Auto(AutoWord),
    /// The named effects.
    Table(Box<RawEffects>),
}

/// The value "auto".
#[derive(Debug, Clone, Copy, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum AutoWord {
    /// The program selects the effects.
    Auto,
}

impl Default for EffectsChoice {
    fn default() -> Self {
        Self::Table(Box::default())
    }
}

impl<'de> Deserialize<'de> for EffectsChoice {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let expecting = "\"auto\", or a table of effects such as { hardening = \"isotropic\" }";
        let word = |word: &str| (word == "auto").then_some(Self::Auto(AutoWord::Auto));
        text_or_table(deserializer, expecting, word, |effects| Self::Table(Box::new(effects)))
    }
}

/// Optional effects; only the effects named here are simulated.
#[derive(Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub struct RawEffects {
    /// Hardening rule with elastic unloading. Default: none; unloading follows the loading curve.
    #[serde(alias = "unloading")]
    pub hardening: Option<Placed<RawHardening>>,
    /// Rate-dependent plastic flow; implies hardening = "isotropic" unless `hardening` is set. Solved with method = "moc"
    /// on a characteristic net. Default: none; the quasi-static curve is used at all strain rates.
    /// "material": each segment uses the constants of its own material.
    pub rate: Option<Placed<RateChoice>>,
    /// Adiabatic heating by plastic work, and thermal softening: `{ fraction = 0.9 }`, or `{}`; implies
    /// hardening = "isotropic" unless `hardening` is set. Needs the materials' `[heat]` constants. Default: none; the temperature is
    /// constant.
    #[serde(default, deserialize_with = "optional_table")]
    pub heat: Option<Placed<RawHeat>>,
    /// Fracture; the simulation continues with the fragments: "critical-strain", `{ energy = "500 ft*lbf/in^3" }` or
    /// `{ spall = "2 GPa" }`. Default: none; the bar does not fracture.
    pub rupture: Option<Placed<RawRupture>>,
    /// Damping and a foundation along the whole bar. For the method "fd". Default: none.
    pub damping: Option<Placed<RawDamping>>,
    /// Love's correction for the inertia of lateral motion, with the materials' `poisson`; a section given by its area only is assumed to be round. For the method "fd". Default: false.
    pub lateral_inertia: Option<Placed<bool>>,
}

/// Adiabatic heating by plastic work.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct RawHeat {
    /// Fraction of the plastic work converted to heat. Default: that of the material, else 0.9.
    pub fraction: Option<Of<Plain, Within<0, 1>>>,
}

impl Example for RawHeat {
    const EXPECTING: &str = "a table such as { fraction = 0.9 }";
}

/// Fracture criterion. Only tension causes fracture.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum RawRupture {
    /// At the nominal strain at the largest engineering stress of the curve, or at the end of data that end in rupture.
    CriticalStrain,
    /// If the strain work per volume reaches this value.
    Energy(Of<EnergyDensity, Positive>),
    /// At this tensile stress.
    Spall(Of<Stress, Positive>),
}

/// Source of the rate-dependent flow law.
#[derive(Debug, JsonSchema)]
#[schemars(untagged)]
pub enum RateChoice {
    /// Constants of the materials: the first law of Johnson-Cook, Zerilli-Armstrong, Cowper-Symonds and Malvern for which the material has constants.
    /// A material without constants is rate-independent.
    Material(MaterialWord),
    /// Law given in the scene, the same for all segments.
    Law(Box<RawRate>),
}

/// The value "material".
#[derive(Debug, Clone, Copy, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum MaterialWord {
    /// The constants of each segment's material.
    Material,
}

impl<'de> Deserialize<'de> for RateChoice {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let expecting = "\"material\", or a table such as { model = \"malvern\", k = \"1e6 1/s\" }";
        let word = |word: &str| (word == "material").then_some(Self::Material(MaterialWord::Material));
        text_or_table(deserializer, expecting, word, |law| Self::Law(Box::new(law)))
    }
}

/// Hardening rule: dependence of the yield stress on plastic flow.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum RawHardening {
    /// Isotropic hardening: tension and compression harden equally.
    Isotropic,
    /// The elastic range keeps its size and moves. Unloading and reverse loading follow the curve doubled in size (Masing's
    /// rule), and closed cycles restore the state: elastic-perfectly-plastic elements in parallel (Besseling). Needs a curve that never
    /// stiffens. With `rate` or `heat` it is equivalent to `{ mixed = 1 }`.
    Kinematic,
    /// The elastic range moves by this fraction of the hardening, and widens by the rest; the hardening is that of the
    /// curve at the accumulated plastic strain.
    Mixed(Of<Plain, Within<0, 1>>),
    /// Nonlinear kinematic hardening: the back stress a has da = C d(plastic strain) - gamma a dp, p being the accumulated plastic
    /// strain, and the elastic range is as wide as first loading along the curve requires. C/gamma must be less than the flow stress. For the
    /// method "fd".
    ArmstrongFrederick(RawArmstrongFrederick),
}

/// Constants of the back stress.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct RawArmstrongFrederick {
    /// Initial slope of the back stress over the plastic strain.
    #[serde(rename = "C")]
    pub c: Of<Stress, Positive>,
    /// Rate of saturation: the back stress tends to C/gamma.
    pub gamma: Of<Plain, Positive>,
}
