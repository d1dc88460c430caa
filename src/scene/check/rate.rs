//! The effect `rate`: its law and constants.

use super::super::Rate;
use super::super::raw::RateChoice;
use super::Checker;
use crate::bar::Bar;
use crate::error::Result;
use crate::law::rate::Overstress;
use crate::material::{RateModel, TEMPERATURE, rate_tables};
use crate::typed::Placed;

impl Checker<'_> {
    pub(super) fn rate(&self, raw: &Placed<RateChoice>, bar: &Bar) -> Result<Rate> {
        let raw_rate = match raw.get_ref() {
            RateChoice::Law(law) => law,
            RateChoice::Material(_) => return self.rate_of_materials(raw, bar),
        };
        let Some(model) = &raw_rate.model else {
            let help = format!("set the law, e.g. {}", RateModel::Malvern.example());
            return Err(self.missing(raw.span(), "effects.rate.model", &help));
        };
        let model = *model.get_ref();
        let law = model.law(raw_rate, self.document, "effects.rate", raw.span())?;
        if let Some(segment) = bar.segments.iter().find(|s| law.lacks_temperature(&s.material)) {
            let message = format!("needs the reference temperature of the curve of `{}`", segment.material.name);
            return Err(self.error(raw.span(), "effects.rate", message).help(TEMPERATURE).into());
        }
        Ok(law)
    }

    /// Selects the constants of the materials; at least one material must have some.
    fn rate_of_materials(&self, raw: &Placed<RateChoice>, bar: &Bar) -> Result<Rate> {
        if bar.segments.iter().any(|s| Overstress::of(Rate::Material, &s.material).is_some()) {
            return Ok(Rate::Material);
        }
        let name = &bar.segments[0].material.name;
        let error =
            self.error(raw.span(), "effects.rate", format!("no material of the bar has rate constants, e.g. `{name}`"));
        let help = format!(
            "give the material {}, or set a law in the scene, e.g. {}",
            rate_tables(),
            RateModel::JohnsonCook.example()
        );
        Err(error.help(help).into())
    }
}
