//! The serde mirror of a material file; `file` converts it.

use schemars::JsonSchema;
use serde::Deserialize;
use serde::de::value::SeqAccessDeserializer;
use serde::de::{Deserializer, Error as _, SeqAccess, Visitor};

use super::rate::RawRates;
use super::{Beyond, Formula, Loading, Measure, Sense};
use crate::input::Number;
use crate::typed::{NotNegative, Of, Or, Placed, Plain, Poisson, Positive, Within};
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
    pub curve: Placed<RawCurve>,
    /// First loading in compression, if different; magnitudes.
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

/// A row [strain, stress] of a curve.
#[derive(Debug, Clone)]
pub struct TableRow(pub Number, pub Number);

// By hand: a pair would ignore a third value.
impl<'de> Deserialize<'de> for TableRow {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Row;

        impl<'de> Visitor<'de> for Row {
            type Value = TableRow;

            fn expecting(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
                f.write_str("a row [strain, stress]")
            }

            fn visit_seq<A: SeqAccess<'de>>(self, row: A) -> Result<TableRow, A::Error> {
                let values = Vec::deserialize(SeqAccessDeserializer::new(row))?;
                let found = values.len();
                let pair = <[Number; 2]>::try_from(values).map_err(|_| A::Error::invalid_length(found, &self))?;
                let [strain, stress] = pair;
                Ok(TableRow(strain, stress))
            }
        }

        deserializer.deserialize_seq(Row)
    }
}

/// A curve: exactly one of `table`, `csv` and `formula`.
#[derive(Debug, Clone, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub struct RawCurve {
    /// Rows [strain, stress]; magnitudes; strain increasing. Plain stresses are in `unit`.
    #[schemars(with = "Option<Vec<(Quantity, Quantity)>>")]
    pub table: Option<Vec<TableRow>>,
    /// A file with the columns strain, stress, relative to this one. A header may give units: `stress_MPa` or
    /// `stress (MPa)`, `strain (%)`.
    pub csv: Option<Placed<String>>,
    /// A named law; its constants are in the same table.
    pub formula: Option<Placed<Formula>>,
    /// Unit of plain stresses in `table` or `csv`, e.g. "MPa" (default: Pa).
    pub unit: Option<Placed<String>>,
    /// As at the top level.
    pub measure: Option<Placed<Measure>>,
    /// As at the top level.
    pub sense: Option<Placed<Sense>>,
    /// As at the top level.
    pub beyond: Option<Placed<Beyond>>,
    /// Hollomon, Ludwik, Swift: strength coefficient; 0 in Ludwik's law alone.
    #[serde(rename = "K")]
    pub k: Option<Of<Stress, NotNegative>>,
    /// All but Voce: exponent; 1e-4 to 0.99 in Hollomon's law, 1.01 to 1000 in that of Ramberg and Osgood, up to 1 in the others.
    pub n: Option<Of<Plain, Positive>>,
    /// Johnson-Cook: yield stress.
    #[serde(rename = "A")]
    pub a: Option<Of<Stress, Positive>>,
    /// Johnson-Cook: hardening coefficient.
    #[serde(rename = "B")]
    pub b: Option<Of<Stress, NotNegative>>,
    /// Ludwik, Voce, Ramberg-Osgood: yield stress.
    #[serde(rename = "yield")]
    pub yield_stress: Option<Of<Stress, Positive>>,
    /// Voce: saturation stress, above the yield stress.
    pub saturation: Option<Of<Stress, Positive>>,
    /// Voce: characteristic plastic strain.
    pub strain: Option<Of<Plain, Positive>>,
    /// Swift: strain before the test.
    pub prestrain: Option<Of<Plain, Positive>>,
    /// Ramberg-Osgood: plastic strain at the yield stress.
    #[schemars(default)]
    pub offset: Or<Of<Plain, Positive>, 2, 1000>,
    /// Conversion of a formula to a table.
    pub tabulate: Option<RawTabulate>,
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

/// Conversion of a formula (or a true table) to an engineering table.
#[derive(Debug, Clone, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub struct RawTabulate {
    /// Largest error of the stress, relative to the largest stress.
    #[schemars(default)]
    pub tolerance: Or<Of<Plain, Within<1, 10_000_000, 100_000_000>>, 1, 1000>,
    /// Engineering strain at the end of the table; at most 0.9 for a compression table from symmetry = "true". Default: 1.5 times the true strain at the largest engineering stress; without a maximum 0.5, and 0.777 (a true strain of 1.5) in compression of true stress and strain.
    pub to_strain: Option<Of<Plain, Positive>>,
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

/// How sure a curve is.
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
