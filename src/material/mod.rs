//! Materials: checked stress-strain tables, formulas converted to tables, and the library of files.

mod branch;
mod constants;
mod csv;
mod curve;
pub mod file;
mod formula;
mod heat_constants;
mod heating;
mod keys;
mod laws;
pub mod library;
mod mean_curve;
mod plausible;
mod rate;
mod raw;
mod row;
mod scatter;
mod softening;
mod tabulate;
mod to_table;
mod torsion;

use serde::{Deserialize, Serialize};

use crate::error::InputError;
use crate::input::positive;
use crate::units::Dimension;

pub use constants::Constants;
pub(crate) use curve::SLOPE_ROUND_OFF;
pub use curve::{Beyond, Curve, CurveError, Ultimate, UltimateReason};
pub use file::{read, resolve};
pub use formula::{Formula, Law};
pub use heat_constants::HeatConstants;
pub use heating::{DEFAULT_FRACTION, Heating, HeatingError, WorkTable};
pub(crate) use mean_curve::check_tests;
pub use mean_curve::{mean_curve, mean_modulus};
pub use rate::Rate;
pub(crate) use rate::{RateModel, RawRate, TEMPERATURE, tables as rate_tables};
pub use raw::RawMaterial;
pub use scatter::{Scatter, TestCurve};
pub use tabulate::{
    Tabulate, Tabulated, engineering_from_true, tabulate_law, tabulate_true_rows, true_from_engineering,
};
pub use torsion::{TORSION_TOLERANCE, TubeSection};

/// Sense of first loading from the virgin state.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum Sense {
    /// Positive stress.
    Tension,
    /// Negative stress; curves are given as magnitudes.
    Compression,
}

impl Sense {
    /// Returns the sense of a signed stress or strain (zero counts as tension).
    pub fn of(signed: f64) -> Self {
        if signed < 0.0 { Self::Compression } else { Self::Tension }
    }

    /// Returns +1 in tension, -1 in compression.
    pub fn sign(self) -> f64 {
        match self {
            Self::Tension => 1.0,
            Self::Compression => -1.0,
        }
    }

    /// Returns the index in pairs of tension and compression.
    pub fn index(self) -> usize {
        usize::from(self == Self::Compression)
    }

    /// Returns "tension" or "compression".
    pub fn name(self) -> &'static str {
        match self {
            Self::Tension => "tension",
            Self::Compression => "compression",
        }
    }
}

/// Measure of the strains and stresses of a curve.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Measure {
    /// Elongation over initial length; force over initial area.
    #[default]
    Engineering,
    /// Logarithmic strain; force over current area.
    True,
}

/// Loading for which a curve is given.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum Loading {
    /// Normal stress against elongation; the modulus is Young's.
    #[default]
    Axial,
    /// Shear stress against engineering shear strain; the modulus is the shear modulus.
    Shear,
}

impl Loading {
    #[expect(clippy::trivially_copy_pass_by_ref, reason = "serde calls it so")]
    fn is_axial(&self) -> bool {
        *self == Self::Axial
    }
}

/// A material as the solvers use it: engineering tables, SI. Materials that were read or created by [`Material::from_curve`] are checked; after a
/// change of its members, check a material with [`Material::check`].
#[derive(Debug, Clone, Serialize)]
pub struct Material {
    /// Short name, as in file names and legends.
    pub name: String,
    /// Description, one line.
    pub description: String,
    /// Density, kg/m^3, > 0.
    pub density: f64,
    /// Elastic modulus, Pa: the slope of all unloading. If it is given, no slope of the curve exceeds it; otherwise it is the steepest slope of the
    /// curve.
    pub modulus: f64,
    /// Loading for which the curve and the modulus hold.
    #[serde(skip_serializing_if = "Loading::is_axial")]
    pub loading: Loading,
    /// Sense of loading in the test from which the main curve, `tension`, was obtained.
    #[serde(skip)]
    pub sense: Sense,
    /// Poisson's ratio, if the file states it.
    pub poisson: Option<f64>,
    /// Curve of first loading in tension (and in compression if `compression` is `None`).
    pub tension: Curve,
    /// Curve of first loading in compression, magnitudes.
    pub compression: Option<Curve>,
    /// Largest stress difference between the table and the formula it was made from, Pa; 0 for a table.
    pub table_error: f64,
    /// `table_error` of tension and of compression.
    #[serde(skip)]
    pub branch_errors: [f64; 2],
    /// Other data of the file: the law from which the table was made, rate and heat constants.
    pub constants: Constants,
    /// Ratio of the shear modulus to Young's modulus, for a curve that was converted from tension (see [`Material::in_shear`]); the constants of
    /// its rate laws are then those of tension.
    #[serde(skip)]
    pub shear_from_tension: Option<f64>,
    /// Heating by plastic work; the curves above are then the adiabatic ones, see [`Material::heated`].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub heating: Option<Box<Heating>>,
    /// Scatter of repeated tests about the curve, which runs ignore.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub scatter: Option<Box<Scatter>>,
    /// Source of the curve.
    pub provenance: Provenance,
}

/// Source of a curve.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize)]
pub struct Provenance {
    /// The publication, as stated in the file.
    pub citation: String,
    /// What was measured.
    pub measured: String,
    /// Confidence: `measured`, `fitted` or `handbook`.
    pub confidence: String,
    /// File from which the material was read, or "built-in", or "inline".
    pub origin: String,
}

impl Material {
    /// Creates a material with this density (kg/m^3) and one curve: the modulus is its steepest slope, and compression has the same curve.
    ///
    /// # Errors
    /// As for [`Material::check`].
    pub fn from_curve(name: impl Into<String>, density: f64, curve: Curve) -> Result<Self, InputError> {
        let material = Self {
            name: name.into(),
            description: String::new(),
            density,
            modulus: curve.steepest(),
            loading: Loading::Axial,
            sense: Sense::Tension,
            poisson: None,
            tension: curve,
            compression: None,
            table_error: 0.0,
            branch_errors: [0.0; 2],
            constants: Constants::default(),
            shear_from_tension: None,
            heating: None,
            scatter: None,
            provenance: Provenance::default(),
        };
        material.check()?;
        Ok(material)
    }

    /// Checks that waves can be computed with the material, which a change of its members may prevent.
    ///
    /// # Errors
    /// A density outside 1e-3 to 1e7 kg/m^3, or a modulus outside 1e-9 to 1e18 Pa or below a slope of a curve.
    pub fn check(&self) -> Result<(), InputError> {
        positive([("density", self.density, Dimension::Density), ("modulus", self.modulus, Dimension::Stress)])?;
        let steeper = |curve: &Curve| curve.steeper_than(self.modulus);
        let Some((_, slope)) = [Some(&self.tension), self.compression.as_ref()].into_iter().flatten().find_map(steeper)
        else {
            return Ok(());
        };
        let message = format!("a slope of the curve is {}", curve::above_modulus(slope, self.modulus));
        let error = InputError::new(message).key("modulus").allowed(format!("modulus >= {slope:e} Pa"));
        Err(error.help("set the modulus to the steepest slope of the curves"))
    }

    /// Returns the curve of first loading for a sense.
    pub fn branch(&self, sense: Sense) -> &Curve {
        match (sense, &self.compression) {
            (Sense::Compression, Some(curve)) => curve,
            _ => &self.tension,
        }
    }

    /// Returns the elastic bar wave speed sqrt(E/rho), m/s.
    pub fn c0(&self) -> f64 {
        (self.modulus / self.density).sqrt()
    }

    /// Returns the elastic impedance per unit area, rho c0, Pa s/m.
    pub fn impedance(&self) -> f64 {
        self.density * self.c0()
    }
}
