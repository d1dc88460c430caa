//! Named hardening laws: flow stress as a function of plastic strain (Hollomon: total strain).

use std::ops::Range;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize, Serializer};

use super::keys::Keys;
use super::laws::{Constant, LawKeys, laws};
use super::row::TableRow;
use super::{Beyond, Measure, Sense};
use crate::error::Result;
use crate::input::{Allowed, Document};
use crate::typed::{Key, NotNegative, Of, Or, Placed, Plain, Positive, Within};
use crate::units::measures::Stress;
use crate::units::{Dimension, Quantity};

laws! {
    /// A hardening law with its constants, SI.
    ///
    /// `ep` is the plastic strain, `e` the total strain, both in the measure (true or engineering) that the material
    /// file names. Every law but Hollomon's adds an elastic strain `stress/E`.
    enum Law {}
    /// Name of a law, as in `formula = "hollomon"`.
    pub enum Formula by "formula";
    /// A curve: exactly one of `table`, `csv` and `formula`.
    struct RawCurve {
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
        /// Conversion of a formula to a table.
        pub tabulate: Option<RawTabulate>,
    }
    constants {
        /// Hollomon, Ludwik, Swift: strength coefficient; 0 in Ludwik's law alone.
        k "K": Option<Of<Stress, NotNegative>>;
        /// All but Voce: exponent; 1e-4 to 0.99 in Hollomon's law, 1.01 to 1000 in that of Ramberg and Osgood, up to 1 in the others.
        n "n": Option<Of<Plain, Positive>>;
        /// Johnson-Cook: yield stress.
        a "A": Option<Of<Stress, Positive>>;
        /// Johnson-Cook: hardening coefficient.
        b "B": Option<Of<Stress, NotNegative>>;
        /// Ludwik, Voce, Ramberg-Osgood: yield stress.
        yield_stress "yield": Option<Of<Stress, Positive>>;
        /// Voce: saturation stress, above the yield stress.
        saturation "saturation": Option<Of<Stress, Positive>>;
        /// Voce: characteristic plastic strain.
        strain "strain": Option<Of<Plain, Positive>>;
        /// Swift: strain before the test.
        prestrain "prestrain": Option<Of<Plain, Positive>>;
        /// Ramberg-Osgood: plastic strain at the yield stress.
        #[schemars(default)]
        offset "offset": Or<Of<Plain, Positive>, 2, 1000>;
    }
    laws {
        /// Hollomon K e^n
        /// of the total strain, from where that meets the elastic line (1945).
        // n = 1 would be a straight line that either coincides with the elastic line or never meets it.
        Hollomon "hollomon" { k = "530 MPa" in Allowed::Positive, n = 0.44 in Allowed::Within(1e-4, 0.99) }
        /// Ludwik yield + K ep^n
        /// (1909).
        Ludwik "ludwik" { yield_stress = "90 MPa", k = "300 MPa", n = 0.4 in UP_TO_1 }
        /// Swift K (prestrain + ep)^n
        /// (1952).
        Swift "swift" { k = "600 MPa" in Allowed::Positive, prestrain = 0.002, n = 0.2 in UP_TO_1 }
        /// Voce saturation - (saturation - yield) exp(-ep/strain)
        /// (1948).
        Voce "voce" { yield_stress = "20 MPa", saturation = "308 MPa", strain = 0.17 }
        /// Ramberg-Osgood e = stress/E + offset (stress/yield)^n
        /// (1943).
        RambergOsgood "ramberg-osgood" {
            yield_stress = "250 MPa", offset = 0.002, n = 10 in Allowed::Within(1.01, 1000.0)
        }
        /// Johnson-Cook A + B ep^n
        /// (1983): the static part of their law.
        JohnsonCook "johnson-cook" { a = "792 MPa", b = "510 MPa", n = 0.26 in UP_TO_1 }
    }
}

const UP_TO_1: Allowed = Allowed::Above(0.0, 1.0);

/// Range of tolerances of tables: 1e-8 to 0.1.
pub(super) type ToTabulate = Within<1, 10_000_000, 100_000_000>;

/// Conversion of a formula (or a true table) to an engineering table.
#[derive(Debug, Clone, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub struct RawTabulate {
    /// Largest error of the stress, relative to the largest stress.
    #[schemars(default)]
    pub tolerance: Or<Of<Plain, ToTabulate>, 1, 1000>,
    /// Engineering strain at the end of the table; at most 0.9 for a compression table from symmetry = "true". Default: 1.5 times the true strain at the largest engineering stress; without a maximum 0.5, and 0.777 (a true strain of 1.5) in compression of true stress and strain.
    pub to_strain: Option<Of<Plain, Positive>>,
}

impl Law {
    /// Whether the strain of the law is the total strain, not the plastic strain.
    pub(super) fn of_total_strain(&self) -> bool {
        matches!(self, Self::Hollomon { .. })
    }

    /// Returns the flow stress at a plastic (Hollomon: total) strain >= 0, Pa.
    pub fn stress(&self, strain: f64) -> f64 {
        match *self {
            Self::Hollomon { k, n } => k * strain.powf(n),
            Self::Ludwik { yield_stress: a, k: b, n } | Self::JohnsonCook { a, b, n } => a + b * strain.powf(n),
            Self::Swift { k, prestrain, n } => k * (prestrain + strain).powf(n),
            Self::Voce { yield_stress, saturation, strain: scale } => {
                saturation - (saturation - yield_stress) * (-strain / scale).exp()
            }
            Self::RambergOsgood { yield_stress, offset, n } => yield_stress * (strain / offset).powf(1.0 / n),
        }
    }

    /// Returns the slope of the flow stress, Pa; infinite at zero strain for exponents below 1.
    pub fn slope(&self, strain: f64) -> f64 {
        match *self {
            Self::Hollomon { k, n } => k * n * strain.powf(n - 1.0),
            Self::Ludwik { k: b, n, .. } | Self::JohnsonCook { b, n, .. } if b > 0.0 => b * n * strain.powf(n - 1.0),
            Self::Ludwik { .. } | Self::JohnsonCook { .. } => 0.0,
            Self::Swift { k, prestrain, n } => k * n * (prestrain + strain).powf(n - 1.0),
            Self::Voce { yield_stress, saturation, strain: scale } => {
                (saturation - yield_stress) / scale * (-strain / scale).exp()
            }
            Self::RambergOsgood { n, .. } => self.stress(strain) / (n * strain),
        }
    }
}

impl std::fmt::Display for Law {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let (keys, values) = self.stated();
        let constants = keys.list(&values, |value, dimension| match dimension {
            Dimension::Stress => format!("{} MPa", value / 1e6),
            _ => value.to_string(),
        });
        write!(f, "{}: {constants}", keys.title)
    }
}

/// Reads the law of a curve that is given under the key `name`.
pub(super) fn read(formula: &Placed<Formula>, curve: &RawCurve, name: &str, keys: Keys<'_>) -> Result<Law> {
    let law = formula.get_ref().law(curve, keys.doc, &keys.key(name), formula.span())?;
    if let Law::Voce { yield_stress, saturation, .. } = law
        && saturation <= yield_stress
    {
        let message = format!("{saturation:e} Pa is not above the yield stress {yield_stress:e} Pa");
        let place = curve.saturation.place().unwrap_or_default();
        let help = "set `saturation` to the stress that the curve approaches from below";
        let error = keys.error(place, &format!("{name}.saturation"), message);
        return Err(error.allowed("saturation > yield").help(help).into());
    }
    Ok(law)
}

/// Rejects constants without a formula.
pub(super) fn refuse_constants(curve: &RawCurve, name: &str, keys: Keys<'_>) -> Result<()> {
    let given = RawCurve::CONSTANTS.iter().find_map(|constant| constant.given(curve));
    let Some((key, place)) = given else { return Ok(()) };
    let error = keys.error(place, &format!("{name}.{key}"), "is a constant of a formula, but `formula` is not given");
    Err(error.help("add e.g. formula = \"hollomon\", or remove the constant").into())
}

#[cfg(test)]
mod tests {
    use super::*;

    const LAWS: [Law; 6] = [
        Law::Hollomon { k: 530e6, n: 0.44 },
        Law::Ludwik { yield_stress: 90e6, k: 300e6, n: 0.4 },
        Law::Swift { k: 600e6, prestrain: 0.002, n: 0.2 },
        Law::Voce { yield_stress: 20e6, saturation: 308e6, strain: 0.17 },
        Law::RambergOsgood { yield_stress: 250e6, offset: 0.002, n: 10.0 },
        Law::JohnsonCook { a: 792e6, b: 510e6, n: 0.26 },
    ];

    #[test]
    fn slopes_are_the_derivatives_of_the_stresses() {
        for law in LAWS {
            for strain in [1e-4, 0.01, 0.3] {
                let h = 1e-5 * strain;
                let difference = (law.stress(strain + h) - law.stress(strain - h)) / (2.0 * h);
                // Central differences: h^2 times a third derivative, 1e-10, and round-off 1e-16/1e-5.
                assert!((law.slope(strain) / difference - 1.0).abs() < 1e-8, "{law} at {strain}");
            }
        }
    }

    #[test]
    fn constants_are_the_stresses_they_name() {
        assert_eq!(LAWS[3].stress(0.0), 20e6);
        assert_eq!(LAWS[4].stress(0.002), 250e6);
        assert_eq!(LAWS[5].stress(0.0), 792e6);
        assert_eq!(LAWS[0].stress(1.0), 530e6);
    }
}
