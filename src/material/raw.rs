//! Serde types that mirror a material file; the module `file` converts them.

use schemars::JsonSchema;
use serde::Deserialize;

use super::formula::RawCurve;
use super::rate::RawRates;
use super::row::TableRow;
use super::{Beyond, Loading, Measure, Sense};
use crate::typed::{Example, Of, Placed, Plain, Poisson, Positive, Within, optional_table, table};
use crate::units::Quantity;
use crate::units::measures::{Density, SpecificHeat, Stress, Temperature};

/// A material file, or an inline table `material = { ... }` in a scene.
#[derive(Debug, Clone, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub struct RawMaterial {
    /// Short name. Default: the file name.
    pub name: Option<String>,
    /// Description, one line.
    pub description: Option<String>,
    /// Mass per volume.
    pub density: Of<Density, Positive>,
    /// Elastic modulus: slope of elastic unloading, not exceeded by the curve. Default: the steepest slope of the curve. Required for formulas.
    pub modulus: Option<Of<Stress, Positive>>,
    /// Loading of the curve: "axial" (default), or "shear": shear stress against engineering shear strain, and `modulus` is
    /// the shear modulus; for bars with mode = "torsion".
    pub loading: Option<Placed<Loading>>,
    /// Poisson's ratio.
    pub poisson: Option<Of<Plain, Poisson>>,
    /// Engineering (nominal, default) or true stress and strain. Also accepted in `[curve]`.
    pub measure: Option<Placed<Measure>>,
    /// Whether the curve was measured in tension (default) or compression. Also accepted in `[curve]`.
    pub sense: Option<Placed<Sense>>,
    /// Behaviour beyond the last row: "rupture" (the specimen fractured there), "extend" (extrapolation with the last slope) or "error"
    /// (default: the run stops). Also accepted in `[curve]`.
    pub beyond: Option<Placed<Beyond>>,
    /// Curve in the other sense without `[compression]`: "engineering" (default) mirrors the engineering
    /// curve; "true" converts the same true curve to compression.
    pub symmetry: Option<Placed<Measure>>,
    /// The stress-strain curve of first loading.
    #[serde(deserialize_with = "table")]
    pub curve: Placed<RawCurve>,
    /// First loading in compression, if different; magnitudes.
    #[serde(default, deserialize_with = "optional_table")]
    pub compression: Option<Placed<RawCurve>>,
    /// Constants of rate laws.
    pub rate: Option<RawRates>,
    /// Constants for heating and thermal softening.
    pub heat: Option<RawHeat>,
    /// Scatter of repeated tests about the curve; runs ignore it.
    pub band: Option<RawBand>,
    /// Source of the curve.
    pub source: Option<RawSource>,
}

/// `[band]`: the scatter of repeated tests. `barwave critical` uses it, runs ignore it.
#[derive(Debug, Clone, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub struct RawBand {
    /// Unit of plain stresses here, e.g. "MPa" (default: Pa).
    pub unit: Option<Placed<String>>,
    /// Rows [engineering strain, standard deviation of the engineering stress], strain increasing.
    #[schemars(with = "Option<Vec<(Quantity, Quantity)>>")]
    pub deviation: Option<Placed<Vec<TableRow>>>,
    /// The curve of each test.
    pub test: Option<Vec<RawTest>>,
}

/// `[[band.test]]`: the curve of one test.
#[derive(Debug, Clone, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub struct RawTest {
    /// Name of the record.
    pub record: Option<String>,
    /// Elastic modulus of this test; default: the steepest slope.
    pub modulus: Option<Of<Stress, Positive>>,
    /// Behaviour beyond the last row; default: that of the material.
    pub beyond: Option<Beyond>,
    /// Rows [engineering strain, engineering stress]; magnitudes; strain increasing.
    #[schemars(with = "Vec<(Quantity, Quantity)>")]
    pub table: Placed<Vec<TableRow>>,
}

/// `[heat]`: constants for heating and thermal softening.
#[derive(Debug, Clone, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub struct RawHeat {
    /// Heat per mass and kelvin.
    pub specific_heat: Option<Of<SpecificHeat, Positive>>,
    /// Fraction of the plastic work converted to heat.
    pub fraction: Option<Of<Plain, Within<0, 1>>>,
    /// Temperature of the curve.
    pub reference_temperature: Option<Of<Temperature, Positive>>,
    /// Melting temperature, above the reference temperature.
    pub melting_temperature: Option<Of<Temperature, Positive>>,
    /// Softening exponent m.
    #[serde(rename = "m")]
    pub exponent: Option<Of<Plain, Within<1, 10_000, 100>>>,
}

impl Example for RawCurve {
    const EXPECTING: &str = "a table such as { table = [[strain, stress], ...] }";
}

/// `[source]`: origin of the curve.
#[derive(Debug, Clone, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub struct RawSource {
    /// The publication.
    pub citation: Option<String>,
    /// What was measured.
    pub measured: Option<String>,
    /// Grade of the source.
    pub confidence: Option<Confidence>,
}

/// Confidence in the curve of a source.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum Confidence {
    /// The table is a measurement.
    Measured,
    /// A law fitted to measurements that the source shows.
    Fitted,
    /// Constants from a handbook or a secondary source.
    Handbook,
}
