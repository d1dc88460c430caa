//! `[specimen]` scenes: a striker and a specimen that has to absorb its energy.

use std::f64::consts::PI;
use std::sync::Arc;

use schemars::JsonSchema;
use serde::Deserialize;
use serde_json::{Value, json};
use toml::Spanned;

use super::super::check::{Checker, MOST_NOTCH, Named};
use super::super::raw::MaterialChoice;
use super::Parts;
use crate::error::Result;
use crate::impact::{Blow, Specimen, Toughness};
use crate::input::{Allowed, Number};
use crate::material::{Material, Sense};
use crate::units::{Dimension, Quantity};

/// A tension specimen struck along its length, by the energy method: does it break? Numbers are SI; a text is a number
/// with its unit, such as "10 in".
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(title = "barwave specimen scene")]
pub struct RawSpecimenScene {
    /// Title, one line. Default: the file's name.
    pub title: Option<String>,
    /// The specimen. Required.
    #[schemars(with = "RawSpecimen")]
    pub specimen: Spanned<RawSpecimen>,
    /// The body that strikes it. Required.
    #[schemars(with = "RawStriker")]
    pub striker: Option<Spanned<RawStriker>>,
}

/// The specimen: its size, and what it can absorb.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct RawSpecimen {
    /// Length, m, > 0. Required.
    #[schemars(with = "Quantity")]
    pub length: Option<Number>,
    /// Cross-section, m^2, > 0; or give `diameter`.
    #[schemars(with = "Option<Quantity>")]
    pub area: Option<Number>,
    /// Diameter of a round section, m, > 0; in place of `area`.
    #[schemars(with = "Option<Quantity>")]
    pub diameter: Option<Number>,
    /// Energy that it absorbs per volume before it breaks, J/m^3, > 0; or give `material`.
    #[schemars(with = "Option<Quantity>")]
    pub energy: Option<Number>,
    /// Material, whose curve says what it absorbs: the work up to its largest engineering stress.
    #[schemars(with = "Option<MaterialChoice>")]
    pub material: Option<Spanned<MaterialChoice>>,
    /// Notch factor, >= 1, of a specimen with a `material`: it breaks at its largest stress divided by this, and is
    /// strained no farther. Default: 1.
    #[schemars(with = "Option<f64>")]
    pub notch: Option<Number>,
}

/// The striking body.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct RawStriker {
    /// Mass, kg, > 0. Required.
    #[schemars(with = "Quantity")]
    pub mass: Option<Number>,
    /// Velocity, m/s, >= 0. Required.
    #[schemars(with = "Quantity")]
    pub velocity: Option<Number>,
}

pub(super) fn check(checker: &Checker<'_>) -> Result<Parts> {
    let raw: RawSpecimenScene = checker.document.parse()?;
    let (span, specimen) = (raw.specimen.span(), raw.specimen.get_ref());
    let help = "add [striker] with mass and velocity, e.g. mass = \"200 lb\" and velocity = \"80 ft/s\"";
    let striker = checker.required(raw.striker.as_ref(), "striker", help)?;
    let length = (specimen.length.as_ref(), "length", Dimension::Length, Allowed::Positive);
    let material = checker.specimen_material(specimen)?;
    let own = |wanted| checker.own_number(wanted, striker.span(), "striker");
    let body = striker.get_ref();
    let blow = Blow {
        mass: own((body.mass.as_ref(), "mass", Dimension::Mass, Allowed::Positive))?,
        velocity: own((body.velocity.as_ref(), "velocity", Dimension::Velocity, Allowed::NotNegative))?,
        specimen: Specimen {
            length: checker.own_number(length, span.clone(), "specimen")?,
            area: checker.specimen_area(specimen, span.clone())?,
            toughness: checker.toughness(specimen, material.as_deref(), span)?,
        },
    };
    let resolved = resolved(&blow, material.as_deref());
    let materials = material.into_iter().collect();
    Ok(Parts { title: raw.title, problem: Arc::new(blow), materials, resolved })
}

fn resolved(blow: &Blow, material: Option<&Material>) -> Value {
    let specimen = &blow.specimen;
    let notch = if let Toughness::Curve { notch, .. } = specimen.toughness { notch } else { 1.0 };
    json!({
        "specimen": {
            "length": specimen.length,
            "area": specimen.area,
            "energy": specimen.energy_per_volume(),
            "material": material,
            "notch": notch,
        },
        "striker": { "mass": blow.mass, "velocity": blow.velocity },
    })
}

impl Checker<'_> {
    fn specimen_area(&self, raw: &RawSpecimen, span: std::ops::Range<usize>) -> Result<f64> {
        let Some(diameter) = &raw.diameter else {
            return self.own_number((raw.area.as_ref(), "area", Dimension::Area, Allowed::Positive), span, "specimen");
        };
        if raw.area.is_some() {
            let message = "the section has both an area and a diameter";
            let error = self.error(diameter.span(), "specimen.diameter", message);
            return Err(error.help("keep `area` or `diameter`, not both").into());
        }
        let diameter = self.document.number(diameter, "specimen.diameter", Dimension::Length, Allowed::Positive)?;
        Ok(PI / 4.0 * diameter * diameter)
    }

    fn specimen_material(&self, raw: &RawSpecimen) -> Result<Option<Arc<Material>>> {
        let key = "specimen.material";
        raw.material.as_ref().map(|choice| self.material(choice, key, &mut Named::new())).transpose()
    }

    fn toughness(
        &self,
        raw: &RawSpecimen,
        material: Option<&Material>,
        span: std::ops::Range<usize>,
    ) -> Result<Toughness> {
        let energy = (raw.energy.as_ref(), "energy", Dimension::EnergyDensity, Allowed::Positive);
        let Some((material, choice)) = material.zip(raw.material.as_ref()) else {
            if let Some(notch) = &raw.notch {
                let message = "how far the rest of a notched specimen is strained is known from its curve alone";
                let error = self.error(notch.span(), "specimen.notch", message);
                return Err(error.help("give `material` in place of `energy`, or take `notch` out").into());
            }
            return self.own_number(energy, span, "specimen").map(Toughness::PerVolume);
        };
        if let Some(energy) = &raw.energy {
            let message = "`energy` and `material` both say what the specimen absorbs";
            let error = self.error(energy.span(), "specimen.energy", message);
            return Err(error.help("keep `energy` or `material`, not both").into());
        }
        let curve = material.branch(Sense::Tension).clone();
        let Some(ultimate) = curve.ultimate() else {
            let message = format!(
                "`{}` never breaks: its curve has no largest stress and does not end in rupture",
                material.name
            );
            let error = self.error(choice.span(), "specimen.material", message);
            let help = "say beyond = \"rupture\" where its data end in rupture, or give `energy` in place of it";
            return Err(error.help(help).into());
        };
        let (key, range) = ("specimen.notch", Allowed::Within(1.0, MOST_NOTCH));
        let notch = self.document.optional(raw.notch.as_ref(), key, Dimension::None, range)?;
        Ok(Toughness::Curve { curve, ultimate, notch: notch.unwrap_or(1.0) })
    }
}
