//! The effect of the strain rate: which law, with which constants.

use toml::Spanned;

use super::super::Rate;
use super::super::raw::{RateChoice, RawModel, RawRate};
use super::Checker;
use crate::bar::Bar;
use crate::error::Result;
use crate::input::{Allowed, Number};
use crate::law::rate::Overstress;
use crate::units::Dimension;

impl RawModel {
    fn word(self) -> &'static str {
        match self {
            Self::Malvern => "malvern",
            Self::CowperSymonds => "cowper-symonds",
            Self::JohnsonCook => "johnson-cook",
        }
    }

    /// The constants that the model takes, with an example.
    fn constants(self) -> &'static [(&'static str, &'static str)] {
        match self {
            Self::Malvern => &[("k", "\"1e6 1/s\"")],
            Self::CowperSymonds => &[("D", "\"40 1/s\""), ("q", "5")],
            Self::JohnsonCook => &[("C", "0.014"), ("reference", "\"1 1/s\"")],
        }
    }

    fn example(self) -> String {
        let constants: Vec<String> = self.constants().iter().map(|(key, value)| format!("{key} = {value}")).collect();
        format!("rate = {{ model = \"{}\", {} }}", self.word(), constants.join(", "))
    }
}

impl Checker<'_> {
    pub(super) fn rate(&self, raw: &Spanned<RateChoice>, bar: &Bar) -> Result<Rate> {
        let raw_rate = match raw.get_ref() {
            RateChoice::Law(law) => law,
            RateChoice::Material(_) => return self.rate_of_materials(raw, bar),
        };
        let Some(model) = &raw_rate.model else {
            let help = format!("say which law, e.g. {}", RawModel::Malvern.example());
            return Err(self.missing(raw.span(), "effects.rate.model", &help));
        };
        let model = *model.get_ref();
        self.only_constants_of(raw_rate, model)?;
        let need = |value: &Option<Number>, name: &str, dimension: Dimension| -> Result<f64> {
            let key = format!("effects.rate.{name}");
            match value {
                Some(value) => self.document.number(value, &key, dimension, Allowed::Positive),
                None => Err(self.missing(raw.span(), &key, &format!("write e.g. {}", model.example()))),
            }
        };
        Ok(match model {
            RawModel::Malvern => Rate::Malvern { k: need(&raw_rate.k, "k", Dimension::Rate)? },
            RawModel::CowperSymonds => Rate::CowperSymonds {
                d: need(&raw_rate.d, "D", Dimension::Rate)?,
                q: need(&raw_rate.q, "q", Dimension::None)?,
            },
            RawModel::JohnsonCook => Rate::JohnsonCook {
                c: need(&raw_rate.c, "C", Dimension::None)?,
                reference: need(&raw_rate.reference, "reference", Dimension::Rate)?,
            },
        })
    }

    /// The materials' own constants; one material at least states some.
    fn rate_of_materials(&self, raw: &Spanned<RateChoice>, bar: &Bar) -> Result<Rate> {
        if bar.segments.iter().any(|s| Overstress::of(&s.material).is_some()) {
            return Ok(Rate::Material);
        }
        let name = &bar.segments[0].material.name;
        let error =
            self.error(raw.span(), "effects.rate", format!("no material of the bar states a rate: `{name}` has none"));
        let help = format!(
            "give the material [rate.johnson-cook], [rate.cowper-symonds] or [rate.malvern], or the scene a law, e.g. {}",
            RawModel::JohnsonCook.example()
        );
        Err(error.help(help).into())
    }

    fn only_constants_of(&self, raw: &RawRate, model: RawModel) -> Result<()> {
        let all = [("k", &raw.k), ("D", &raw.d), ("q", &raw.q), ("C", &raw.c), ("reference", &raw.reference)];
        for (name, value) in all {
            let Some(value) = value else { continue };
            if !model.constants().iter().any(|(key, _)| *key == name) {
                let key = format!("effects.rate.{name}");
                let error =
                    self.error(value.span(), &key, format!("is not a constant of model = \"{}\"", model.word()));
                let allowed: Vec<&str> = model.constants().iter().map(|(key, _)| *key).collect();
                return Err(error.allowed(allowed.join(", ")).help(format!("write e.g. {}", model.example())).into());
            }
        }
        Ok(())
    }
}
