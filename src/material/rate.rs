//! The laws of the strain rate, each declared once: its name and its constants, as scenes and material files state them.
//! The equations are those of [`crate::law::rate::Overstress`].

use std::ops::Range;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::keys::Keys;
use super::{HeatConstants, Material};
use crate::error::{InputError, Result};
use crate::input::Document;
use crate::typed::{Key, NotNegative, Of, Placed, Plain, Positive};
use crate::units::{Dimension, Measure, System, format, measures};

/// A constant of a law.
struct Constant {
    key: &'static str,
    dimension: Dimension,
    example: &'static str,
    of: fn(&RawRate) -> &dyn Key<Si = Option<f64>>,
}

/// What a key measures.
const fn dimension<D: Measure, R>(_: fn(&RawRate) -> &Option<Of<D, R>>) -> Dimension {
    D::DIMENSION
}

macro_rules! constant {
    ($constant:ident, $key:literal, $example:literal) => {
        Constant { key: $key, dimension: dimension(|raw| &raw.$constant), example: $example, of: |raw| &raw.$constant }
    };
}

/// Declares the laws. A row: its name in Rust, in scenes, and of its table in a material; its constants with key and an example, as
/// [`RawRate`] declares them. A material that states several laws uses the first of them here.
macro_rules! rate_laws {
    ($(
        $(#[doc = $doc:literal])*
        $law:ident, $name:literal, $table:ident {
            $($(#[doc = $meaning:literal])* $c:ident: $key:literal, $example:literal;)*
        }
    )*) => {
        /// A law of the strain rate with its constants, SI.
        #[derive(Debug, Clone, Copy, PartialEq, Serialize)]
        #[serde(tag = "model", rename_all = "kebab-case")]
        pub enum Rate {
            $($(#[doc = $doc])* $law { $($(#[doc = $meaning])* #[serde(rename = $key)] $c: f64,)* },)*
            /// Each segment by the constants of its own material.
            Material,
        }

        /// The laws of the strain rate by name.
        #[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize, JsonSchema)]
        #[serde(rename_all = "kebab-case")]
        pub(crate) enum RateModel {
            $($(#[doc = $doc])* $law,)*
        }

        /// `[rate]`: constants of rate laws.
        #[derive(Debug, Clone, Default, Deserialize, JsonSchema)]
        #[serde(deny_unknown_fields, rename_all = "kebab-case")]
        pub struct RawRates {
            $($(#[doc = $doc])* $table: Option<Placed<RawRate>>,)*
        }

        impl RateModel {
            const ALL: &[Self] = &[$(Self::$law,)*];

            fn name(self) -> &'static str {
                match self { $(Self::$law => $name,)* }
            }

            fn constants(self) -> &'static [Constant] {
                match self { $(Self::$law => const { &[$(constant!($c, $key, $example),)*] },)* }
            }

            /// The law with the constants that `number` gives.
            fn law(self, number: impl Fn(&Constant) -> Result<f64>) -> Result<Rate> {
                Ok(match self {
                    $(Self::$law => Rate::$law {
                        $($c: number(&constant!($c, $key, $example))?,)*
                    },)*
                })
            }
        }

        impl RawRates {
            /// The laws that are stated.
            fn stated(&self) -> impl Iterator<Item = (RateModel, &Placed<RawRate>)> {
                [$((RateModel::$law, self.$table.as_ref()),)*].into_iter().filter_map(|(law, raw)| Some((law, raw?)))
            }
        }

        impl Rate {
            /// Name and constants; none for those of the materials.
            fn parts(self) -> Option<(RateModel, Vec<f64>)> {
                match self {
                    $(Self::$law { $($c,)* } => Some((RateModel::$law, vec![$($c,)*])),)*
                    Self::Material => None,
                }
            }
        }
    };
}

rate_laws! {
    /// Johnson and Cook: stress = static (1 + C ln(rate/reference)) above the static curve.
    JohnsonCook, "johnson-cook", johnson_cook {
        /// C, >= 0.
        c: "C", "0.014";
        /// Plastic strain rate at which the curve holds, 1/s, > 0.
        reference: "reference", "\"1 1/s\"";
    }
    /// Zerilli and Armstrong, body-centred cubic metals: stress = static + s(rate, T) - s(reference, T) above the static curve, with
    /// s = C1 exp(-C3 T + C4 T ln(rate/(1/s))) and T the material's `reference-temperature`, with the effect of heat that of the cell.
    ZerilliArmstrong, "zerilli-armstrong", zerilli_armstrong {
        /// C1, Pa, > 0.
        c1: "C1", "\"1 GPa\"";
        /// C3, 1/K, > 0.
        c3: "C3", "\"0.007 1/K\"";
        /// C4, 1/K, > 0.
        c4: "C4", "\"0.0004 1/K\"";
        /// Plastic strain rate at which the curve holds, 1/s, > 0.
        reference: "reference", "\"1e-3 1/s\"";
    }
    /// Cowper and Symonds (Perzyna): plastic strain rate = D (stress/static - 1)^q.
    CowperSymonds, "cowper-symonds", cowper_symonds {
        /// 1/s, > 0.
        d: "D", "\"40 1/s\"";
        /// > 0.
        q: "q", "5";
    }
    /// Malvern and Sokolovsky: plastic strain rate = k (stress - static)/E.
    Malvern, "malvern", malvern {
        /// 1/s, > 0.
        k: "k", "\"1e6 1/s\"";
    }
}

/// Rate law and its constants: `{ model = "malvern", k = "1e6 1/s" }`,
/// `{ model = "cowper-symonds", D = "40 1/s", q = 5 }` or `{ model = "johnson-cook", C = 0.014, reference = "1 1/s" }`; in a material file the name of the table is the law, without `model`.
#[derive(Debug, Clone, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct RawRate {
    /// Rate law. Required in a scene.
    pub(crate) model: Option<Placed<RateModel>>,
    /// Malvern: plastic strain rate per excess of the elastic strain over that of the static curve.
    k: Option<Of<measures::Rate, Positive>>,
    /// Cowper-Symonds: plastic strain rate at twice the static stress.
    #[serde(rename = "D")]
    d: Option<Of<measures::Rate, Positive>>,
    /// Cowper-Symonds: the exponent.
    q: Option<Of<Plain, Positive>>,
    /// Johnson-Cook: the coefficient of the strain rate.
    #[serde(rename = "C")]
    c: Option<Of<Plain, NotNegative>>,
    /// Zerilli-Armstrong: stress of the thermal part.
    #[serde(rename = "C1")]
    c1: Option<Of<measures::Stress, Positive>>,
    /// Zerilli-Armstrong: its temperature coefficient.
    #[serde(rename = "C3")]
    c3: Option<Of<measures::ReciprocalTemperature, Positive>>,
    /// Zerilli-Armstrong: its strain-rate coefficient.
    #[serde(rename = "C4")]
    c4: Option<Of<measures::ReciprocalTemperature, Positive>>,
    /// Johnson-Cook, Zerilli-Armstrong: plastic strain rate of the quasi-static curve.
    reference: Option<Of<measures::Rate, Positive>>,
}

impl RateModel {
    /// How a scene states it.
    pub(crate) fn example(self) -> String {
        let constants: Vec<String> = self.constants().iter().map(|c| format!("{} = {}", c.key, c.example)).collect();
        format!("rate = {{ model = \"{}\", {} }}", self.name(), constants.join(", "))
    }
}

impl RawRate {
    /// The law `model` with the constants that stand under `key` at `span` of a document; others are refused.
    pub(crate) fn law(&self, model: RateModel, document: &Document, key: &str, span: Range<usize>) -> Result<Rate> {
        let error = |span, constant: &str, message: String| -> InputError {
            let help = format!("write e.g. {}", model.example());
            document.error(span, &format!("{key}.{constant}"), message).help(help)
        };
        let own: Vec<&str> = model.constants().iter().map(|c| c.key).collect();
        let mut others = RateModel::ALL.iter().flat_map(|law| law.constants()).filter(|c| !own.contains(&c.key));
        if let Some((other, place)) = others.find_map(|c| Some((c, (c.of)(self).place()?))) {
            let message = format!("is not a constant of model = \"{}\"", model.name());
            return Err(error(place, other.key, message).allowed(own.join(", ")).into());
        }
        model.law(|constant| {
            let missing = || error(span.clone(), constant.key, format!("`{}` is missing", constant.key)).into();
            (constant.of)(self).si(document, false)?.ok_or_else(missing)
        })
    }
}

/// The laws that a material states.
pub(super) fn resolve(raw: &RawRates, heat: &HeatConstants, keys: Keys<'_>) -> Result<Vec<Rate>> {
    let law = |(model, raw): (RateModel, &Placed<RawRate>)| {
        let key = format!("rate.{}", model.name());
        if let Some(word) = &raw.get_ref().model {
            let error = keys.error(word.span(), &format!("{key}.model"), "the name of the table selects the law");
            return Err(error.help("remove `model`").into());
        }
        let law = raw.get_ref().law(model, keys.doc, &keys.key(&key), raw.span())?;
        if law.has_temperature() && heat.reference_temperature.is_none() {
            let error = keys.error(raw.span(), &key, "needs the reference temperature of the curve");
            return Err(error.help(TEMPERATURE).into());
        }
        Ok(law)
    };
    raw.stated().map(law).collect()
}

/// The way out where a law depends on temperature.
pub(crate) const TEMPERATURE: &str = "add it to the material, e.g. heat = { reference-temperature = \"293 K\" }";

impl Rate {
    /// The law depends on the temperature.
    fn has_temperature(self) -> bool {
        matches!(self, Self::ZerilliArmstrong { .. })
    }

    /// A material that can flow does not state the temperature on which the law depends.
    pub(crate) fn lacks_temperature(self, material: &Material) -> bool {
        let stated = material.constants.heat.reference_temperature.is_some();
        self.has_temperature() && !stated && material.can_flow()
    }

    /// As it is listed: "malvern k = 1e6 1/s".
    pub fn describe(self) -> String {
        let Some((model, values)) = self.parts() else { return "material".to_owned() };
        let one = |(constant, value): (&Constant, &f64)| {
            format!("{} = {}", constant.key, format(*value, constant.dimension, System::Si))
        };
        let constants: Vec<String> = model.constants().iter().zip(&values).map(one).collect();
        format!("{} {}", model.name(), constants.join(", "))
    }
}
