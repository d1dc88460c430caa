//! Named hardening laws: flow stress against plastic strain (Hollomon: against total strain).

use serde::{Deserialize, Serialize};

/// A hardening law with its constants; stresses in Pa.
///
/// `e_p` is the plastic strain, `e` the total strain, both in the measure (true or engineering) that the material
/// file names. Every law but Hollomon's adds an elastic strain `stress/E`.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub enum Law {
    /// stress = K e^n of the total strain, from where that meets the elastic line. (Hollomon 1945)
    Hollomon {
        /// K, Pa, > 0.
        k: f64,
        /// n, 0 < n < 1.
        n: f64,
    },
    /// stress = yield + K `e_p`^n. (Ludwik 1909)
    Ludwik {
        /// Pa, > 0.
        yield_stress: f64,
        /// K, Pa, >= 0.
        k: f64,
        /// n, 0 < n <= 1.
        n: f64,
    },
    /// stress = K (prestrain + `e_p`)^n. (Swift 1952)
    Swift {
        /// K, Pa, > 0.
        k: f64,
        /// Strain, > 0.
        prestrain: f64,
        /// n, 0 < n <= 1.
        n: f64,
    },
    /// stress = saturation - (saturation - yield) exp(-`e_p`/strain). (Voce 1948)
    Voce {
        /// Pa, > 0.
        yield_stress: f64,
        /// Pa, > yield.
        saturation: f64,
        /// Characteristic plastic strain, > 0.
        strain: f64,
    },
    /// e = stress/E + offset (stress/yield)^n. (Ramberg and Osgood 1943)
    RambergOsgood {
        /// Stress at which the plastic strain is `offset`, Pa, > 0.
        yield_stress: f64,
        /// Plastic strain at the yield stress, > 0; usually 0.002.
        offset: f64,
        /// n, > 1.
        n: f64,
    },
    /// stress = A + B `e_p`^n: the static part of Johnson and Cook's law (1983).
    JohnsonCook {
        /// A, Pa, > 0.
        a: f64,
        /// B, Pa, >= 0.
        b: f64,
        /// n, 0 < n <= 1.
        n: f64,
    },
}

/// Name of a law, as in `formula = "hollomon"`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Formula {
    /// K e^n of the total strain.
    Hollomon,
    /// yield + K ep^n.
    Ludwik,
    /// K (prestrain + ep)^n.
    Swift,
    /// saturation - (saturation - yield) exp(-ep/strain).
    Voce,
    /// e = stress/E + offset (stress/yield)^n.
    RambergOsgood,
    /// A + B ep^n.
    JohnsonCook,
}

impl Law {
    /// True where the law's strain is the total one, not the plastic one.
    pub(super) fn of_total_strain(&self) -> bool {
        matches!(self, Self::Hollomon { .. })
    }

    /// Flow stress at a plastic (Hollomon: total) strain >= 0, Pa.
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

    /// Slope of the flow stress, Pa; infinite at zero strain for the powers below 1.
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
        const MPA: f64 = 1e6;
        match *self {
            Self::Hollomon { k, n } => write!(f, "Hollomon K e^n: K = {} MPa, n = {n}", k / MPA),
            Self::Ludwik { yield_stress, k, n } => {
                write!(f, "Ludwik yield + K ep^n: yield = {} MPa, K = {} MPa, n = {n}", yield_stress / MPA, k / MPA)
            }
            Self::Swift { k, prestrain, n } => {
                write!(f, "Swift K (prestrain + ep)^n: K = {} MPa, prestrain = {prestrain}, n = {n}", k / MPA)
            }
            Self::Voce { yield_stress, saturation, strain } => write!(
                f,
                "Voce saturation - (saturation - yield) exp(-ep/strain): yield = {} MPa, saturation = {} MPa, \
                 strain = {strain}",
                yield_stress / MPA,
                saturation / MPA
            ),
            Self::RambergOsgood { yield_stress, offset, n } => write!(
                f,
                "Ramberg-Osgood e = stress/E + offset (stress/yield)^n: yield = {} MPa, offset = {offset}, n = {n}",
                yield_stress / MPA
            ),
            Self::JohnsonCook { a, b, n } => {
                write!(f, "Johnson-Cook A + B ep^n: A = {} MPa, B = {} MPa, n = {n}", a / MPA, b / MPA)
            }
        }
    }
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
