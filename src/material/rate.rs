//! The rate laws, as stated in scenes and material files. Their equations are those of [`crate::law::rate::Overstress`].

use std::ops::Range;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize, Serializer};

use super::keys::Keys;
use super::laws::{Constant, LawKeys, laws};
use super::torsion::ROOT_3;
use super::{HeatConstants, Material};
use crate::error::Result;
use crate::input::Document;
use crate::typed::{Key, NotNegative, Of, Placed, Plain, Positive};
use crate::units::measures::{self, ReciprocalTemperature, Stress};
use crate::units::{System, format};

/// Declares the rate laws, each with the name of its table in a material. If a material states several laws, the first of them in this order is
/// used.
macro_rules! rate_laws {
    (constants $constants:tt $($(#[doc = $doc:literal])* $law:ident $name:literal as $table:ident $own:tt)*) => {
        laws! {
            /// A rate law with its constants, SI.
            enum Rate {
                /// For each segment, the law of its own material.
                Material "material"
            }
            /// Rate laws by name.
            pub(crate) enum RateModel by "model";
            /// Rate law and its constants: `{ model = "malvern", k = "1e6 1/s" }`,
            /// `{ model = "cowper-symonds", D = "40 1/s", q = 5 }` or `{ model = "johnson-cook", C = 0.014, reference = "1 1/s" }`; in a material file the name of the table is the law, without `model`.
            struct RawRate {
                /// Rate law. Required in a scene.
                pub(crate) model: Option<Placed<RateModel>>,
            }
            constants $constants
            laws { $($(#[doc = $doc])* $law $name $own)* }
        }

        /// `[rate]`: constants of rate laws.
        #[derive(Debug, Clone, Deserialize, JsonSchema)]
        #[serde(deny_unknown_fields, rename_all = "kebab-case")]
        pub struct RawRates {
            $($(#[doc = $doc])* $table: Option<Placed<RawRate>>,)*
        }

        /// Returns the names of the tables of the rate laws in a material file, for messages.
        pub(crate) fn tables() -> String {
            let names = [$(concat!("[rate.", $name, "]")),*];
            let (last, first) = names.split_last().unwrap_or((&"", &[]));
            format!("{} or {last}", first.join(", "))
        }

        impl RawRates {
            /// Iterates over the laws that are stated.
            fn stated(&self) -> impl Iterator<Item = (RateModel, &Placed<RawRate>)> {
                [$((RateModel::$law, self.$table.as_ref()),)*].into_iter().filter_map(|(law, raw)| Some((law, raw?)))
            }
        }
    };
}

rate_laws! {
    constants {
        /// Malvern: plastic strain rate per excess of the elastic strain over that of the static curve.
        k "k": Option<Of<measures::Rate, Positive>>;
        /// Cowper-Symonds: plastic strain rate at twice the static stress.
        d "D": Option<Of<measures::Rate, Positive>>;
        /// Cowper-Symonds: the exponent.
        q "q": Option<Of<Plain, Positive>>;
        /// Johnson-Cook: the coefficient of the strain rate.
        c "C": Option<Of<Plain, NotNegative>>;
        /// Zerilli-Armstrong: stress of the thermal part.
        c1 "C1": Option<Of<Stress, Positive>>;
        /// Zerilli-Armstrong: its temperature coefficient.
        c3 "C3": Option<Of<ReciprocalTemperature, Positive>>;
        /// Zerilli-Armstrong: its strain-rate coefficient.
        c4 "C4": Option<Of<ReciprocalTemperature, Positive>>;
        /// Johnson-Cook, Zerilli-Armstrong: plastic strain rate of the quasi-static curve.
        reference "reference": Option<Of<measures::Rate, Positive>>;
    }
    /// Johnson and Cook: stress = static (1 + C ln(rate/reference)) above the static curve.
    JohnsonCook "johnson-cook" as johnson_cook { c = 0.014, reference = "1 1/s" }
    /// Zerilli and Armstrong, body-centred cubic metals: stress = static + s(rate, T) - s(reference, T) above the static curve, with
    /// s = C1 exp(-C3 T + C4 T ln(rate/(1/s))) and T the material's `reference-temperature`, with heating the temperature of the cell.
    ZerilliArmstrong "zerilli-armstrong" as zerilli_armstrong {
        c1 = "1 GPa", c3 = "0.007 1/K", c4 = "0.0004 1/K", reference = "1e-3 1/s"
    }
    /// Cowper and Symonds (Perzyna): plastic strain rate = D (stress/static - 1)^q.
    CowperSymonds "cowper-symonds" as cowper_symonds { d = "40 1/s", q = 5 }
    /// Malvern and Sokolovsky: plastic strain rate = k (stress - static)/E.
    Malvern "malvern" as malvern { k = "1e6 1/s" }
}

impl RateModel {
    /// Returns an example of the law as stated in a scene.
    pub(crate) fn example(self) -> String {
        let keys = self.keys();
        format!("rate = {{ model = \"{}\", {} }}", keys.name, keys.example())
    }
}

/// Returns the laws that a material states.
pub(super) fn resolve(raw: &RawRates, heat: &HeatConstants, keys: Keys<'_>) -> Result<Vec<Rate>> {
    let law = |(model, raw): (RateModel, &Placed<RawRate>)| {
        let key = format!("rate.{}", model.keys().name);
        if let Some(word) = &raw.get_ref().model {
            let error = keys.error(word.span(), &format!("{key}.model"), "the name of the table selects the law");
            return Err(error.help("remove `model`").into());
        }
        let law = model.law(raw.get_ref(), keys.doc, &keys.key(&key), raw.span())?;
        if law.has_temperature() && heat.reference_temperature.is_none() {
            let error = keys.error(raw.span(), &key, "needs the reference temperature of the curve");
            return Err(error.help(TEMPERATURE).into());
        }
        Ok(law)
    };
    raw.stated().map(law).collect()
}

/// Help text for a law that depends on temperature.
pub(crate) const TEMPERATURE: &str = "add it to the material, e.g. heat = { reference-temperature = \"293 K\" }";

impl Rate {
    /// Whether the law depends on the temperature.
    fn has_temperature(self) -> bool {
        matches!(self, Self::ZerilliArmstrong { .. })
    }

    /// Whether the law depends on a temperature that the material, which can flow, does not state.
    pub(crate) fn lacks_temperature(self, material: &Material) -> bool {
        let stated = material.constants.heat.reference_temperature.is_some();
        self.has_temperature() && !stated && material.can_flow()
    }

    /// Converts a law of tension to shear by von Mises' rule: tau = sigma/sqrt(3), and the plastic shear strain rate is sqrt(3) times the plastic
    /// strain rate. `ratio` is the shear modulus over Young's modulus.
    #[must_use]
    pub fn in_shear(self, ratio: f64) -> Self {
        match self {
            Self::Malvern { k } => Self::Malvern { k: 3.0 * ratio * k },
            Self::CowperSymonds { d, q } => Self::CowperSymonds { d: ROOT_3 * d, q },
            Self::JohnsonCook { c, reference } => Self::JohnsonCook { c, reference: ROOT_3 * reference },
            Self::ZerilliArmstrong { c1, c3, c4, reference } => {
                Self::ZerilliArmstrong { c1: c1 / ROOT_3, c3: c3 + c4 * ROOT_3.ln(), c4, reference: ROOT_3 * reference }
            }
            Self::Material => self,
        }
    }

    /// Returns the entry in the table `[rate]` of a material file; `None` if the law has no constants of its own.
    pub(super) fn to_entry(self) -> Option<(String, toml::Value)> {
        let (keys, values) = self.stated();
        let constants =
            keys.constants.iter().zip(values).map(|(constant, value)| (constant.key.to_owned(), value.into()));
        let constants: toml::Table = constants.collect();
        (!constants.is_empty()).then(|| (keys.name.to_owned(), constants.into()))
    }

    /// Returns the law as it is listed: "malvern k = 1e6 1/s".
    pub fn describe(self) -> String {
        let (keys, values) = self.stated();
        let constants = keys.list(&values, |value, dimension| format(value, dimension, System::Si));
        format!("{} {constants}", keys.name).trim_end().to_owned()
    }
}
