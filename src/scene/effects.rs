//! Effects of a scene beyond path-independent loading.

use serde::Serialize;

use super::Damping;
use crate::law::rupture::Cause;
pub use crate::material::Rate;
use crate::units::{Dimension, System, format};

/// Effects beyond path-independent loading. The default is none.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct Effects {
    /// Hardening rule with elastic unloading; `None`: unloading follows the loading curve.
    pub hardening: Option<HardeningRule>,
    /// Rate-dependent plastic flow; requires a hardening rule.
    pub rate: Option<Rate>,
    /// Adiabatic heating and thermal softening; requires a hardening rule.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub heat: Option<Heat>,
    /// Fracture.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub rupture: Option<Rupture>,
    /// Distributed damping, friction and foundation.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub damping: Option<Damping>,
    /// Love's correction for the inertia of lateral motion.
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    pub lateral_inertia: bool,
}

/// Dependence of the yield stress on plastic flow.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum HardeningRule {
    /// Isotropic hardening: tension and compression harden equally.
    Isotropic,
    /// Kinematic hardening: the elastic range keeps its size and moves. [`crate::law::Overlay`]; with a single hardening line, rate dependence or
    /// heating, [`crate::law::Mixed`] with the fraction 1.
    Kinematic,
    /// The elastic range moves by the given fraction (0 to 1) of the hardening at the accumulated plastic strain.
    Mixed(f64),
    /// Armstrong-Frederick hardening: the back stress a satisfies `da = C d(eps_p) - gamma a dp`, see [`crate::law::ArmstrongFrederick`].
    #[serde(rename = "armstrong-frederick")]
    ArmstrongFrederick {
        /// Initial slope C of the back stress, Pa, > 0.
        #[serde(rename = "C")]
        c: f64,
        /// Rate of saturation gamma, > 0.
        gamma: f64,
    },
}

/// Adiabatic heating, see [`crate::material::Heating`]; the other constants are those of the materials.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Heat {
    /// Fraction of the plastic work that is converted to heat (Taylor-Quinney coefficient), 0 to 1; `None` for that of each material.
    pub fraction: Option<f64>,
}

/// Fracture criterion, see [`crate::law::rupture`].
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Rupture {
    /// The criterion.
    pub cause: Cause,
    /// Energy per volume (J/m^3) or tensile stress (Pa); `None` for the critical strain, which depends on the material.
    pub threshold: Option<f64>,
    /// Stress concentration factor of each segment, >= 1.
    pub notches: Vec<f64>,
    /// Stress concentration factor of the joint to the right of each segment, >= 1, multiplied by those of the segments.
    pub joint_notches: Vec<f64>,
}

impl Effects {
    /// Keys of the scene language, in the order in which effects are listed.
    pub const KEYS: [&'static str; 6] = ["hardening", "rate", "heat", "rupture", "damping", "lateral-inertia"];

    /// Returns an effect as it is written to files and summaries, for example "hardening: isotropic"; `None` if it is disabled. `key` is one of
    /// [`Effects::KEYS`].
    pub fn named(&self, key: &str) -> Option<String> {
        match key {
            "hardening" => self.hardening.map(|u| format!("hardening: {}", u.describe())),
            "rate" => self.rate.map(|r| format!("rate: {}", r.describe())),
            "heat" => self.heat.map(|h| match h.fraction {
                Some(fraction) => format!("heat: fraction {fraction}"),
                None => "heat".to_owned(),
            }),
            "rupture" => self.rupture.as_ref().map(|r| format!("rupture: {}", r.describe())),
            "damping" => self.damping.map(|d| format!("damping: {}", d.describe())),
            "lateral-inertia" => self.lateral_inertia.then(|| "lateral-inertia".to_owned()),
            _ => None,
        }
    }

    /// Returns all enabled effects, as [`Effects::named`] writes them.
    pub fn names(&self) -> Vec<String> {
        Self::KEYS.iter().filter_map(|key| self.named(key)).collect()
    }
}

impl HardeningRule {
    /// Returns the fraction of the hardening along the curve that moves the elastic range, 0 to 1; 0 for Armstrong-Frederick hardening, whose back
    /// stress does not follow the curve.
    pub fn kinematic_fraction(self) -> f64 {
        match self {
            Self::Isotropic | Self::ArmstrongFrederick { .. } => 0.0,
            Self::Kinematic => 1.0,
            Self::Mixed(fraction) => fraction,
        }
    }

    /// Returns whether the elastic range moves.
    pub fn moves(self) -> bool {
        self != Self::Isotropic
    }

    fn describe(self) -> String {
        match self {
            Self::Isotropic => "isotropic".to_owned(),
            Self::Kinematic => "kinematic".to_owned(),
            Self::Mixed(fraction) => format!("mixed {fraction}"),
            Self::ArmstrongFrederick { c, gamma } => {
                format!("armstrong-frederick C = {}, gamma = {gamma}", format(c, Dimension::Stress, System::Si))
            }
        }
    }
}

impl Rupture {
    fn describe(&self) -> String {
        match (self.cause, self.threshold) {
            (Cause::Energy, Some(energy)) => {
                format!("energy = {}", format(energy, Dimension::EnergyDensity, System::Si))
            }
            (Cause::Spall, Some(stress)) => format!("spall = {}", format(stress, Dimension::Stress, System::Si)),
            (cause, _) => cause.name().to_owned(),
        }
    }
}
