//! `[specimen]` scenes: a striker and a specimen, solved by the energy method.

use std::f64::consts::PI;
use std::sync::Arc;

use super::super::check::Checker;
use super::super::raw::{MaterialChoice, Notch};
use super::Parts;
use crate::error::Result;
use crate::impact::{Blow, Specimen, Toughness};
use crate::material::{Material, Sense};
use crate::typed::{Key, NotNegative, Of, Placed, Positive};
use crate::units::measures;
use crate::wave::similarity::critical;
use schemars::JsonSchema;
use serde::Deserialize;
use serde_json::{Value, json};

/// A tension specimen struck along its length, by the energy method: does it break? Numbers are SI; a text is a number
/// with its unit, such as "10 in".
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(title = "barwave specimen scene")]
pub struct RawSpecimenScene {
    /// Title, one line. Default: the file's name.
    pub title: Option<String>,
    /// The specimen. Required.
    pub specimen: Placed<RawSpecimen>,
    /// The striking body. Required.
    #[schemars(with = "RawStriker")]
    pub striker: Option<Placed<RawStriker>>,
}

/// The specimen: its dimensions and its energy to fracture.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct RawSpecimen {
    /// Length.
    pub length: Of<measures::Length, Positive>,
    /// Cross-section; or give `diameter`.
    pub area: Option<Of<measures::Area, Positive>>,
    /// Diameter of a round section; in place of `area`.
    pub diameter: Option<Of<measures::Length, Positive>>,
    /// Energy per volume absorbed to fracture; or give `material`.
    pub energy: Option<Of<measures::EnergyDensity, Positive>>,
    /// Material; the energy to fracture is the work under its curve up to the largest engineering stress.
    pub material: Option<Placed<MaterialChoice>>,
    /// Stress concentration factor of a notched specimen with a `material`: fracture at the largest stress of the curve divided by this
    /// factor; strain and energy are those at that stress.
    #[serde(rename = "stress-concentration", alias = "notch")]
    #[schemars(default)]
    pub notch: Notch,
}

/// The striking body.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct RawStriker {
    /// Mass.
    pub mass: Of<measures::Mass, Positive>,
    /// Velocity.
    pub velocity: Of<measures::Velocity, NotNegative>,
}

pub(super) fn check(checker: &Checker<'_>) -> Result<Parts> {
    let raw: RawSpecimenScene = checker.document.parse()?;
    let (span, specimen) = (raw.specimen.span(), raw.specimen.get_ref());
    let help = "add [striker] with mass and velocity, e.g. mass = \"200 lb\" and velocity = \"80 ft/s\"";
    let striker = checker.required(raw.striker.as_ref(), "striker", help)?;
    let material = checker.specimen_material(specimen)?;
    let body = striker.get_ref();
    let blow = Blow {
        mass: checker.si(&body.mass)?,
        velocity: checker.si(&body.velocity)?,
        specimen: Specimen {
            length: checker.si(&specimen.length)?,
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
            "stress-concentration": notch,
        },
        "striker": { "mass": blow.mass, "velocity": blow.velocity },
    })
}

impl Checker<'_> {
    fn specimen_area(&self, raw: &RawSpecimen, span: std::ops::Range<usize>) -> Result<f64> {
        let Some(diameter) = &raw.diameter else {
            return self.needed(raw.area.as_ref(), "area", span, "specimen");
        };
        if raw.area.is_some() {
            let message = "the section has both an area and a diameter";
            let error = self.error(diameter.span(), "specimen.diameter", message);
            return Err(error.help("keep `area` or `diameter`, not both").into());
        }
        let diameter = self.si(diameter)?;
        Ok(PI / 4.0 * diameter * diameter)
    }

    fn specimen_material(&self, raw: &RawSpecimen) -> Result<Option<Arc<Material>>> {
        raw.material.as_ref().map(|choice| self.axial_material(choice, "specimen.material")).transpose()
    }

    fn toughness(
        &self,
        raw: &RawSpecimen,
        material: Option<&Material>,
        span: std::ops::Range<usize>,
    ) -> Result<Toughness> {
        let Some((material, choice)) = material.zip(raw.material.as_ref()) else {
            if let Some(notch) = raw.notch.place() {
                let message = "a stress concentration needs the stress-strain curve of the specimen";
                let error = self.error(notch, "specimen.stress-concentration", message);
                return Err(error
                    .help("give `material` in place of `energy`, or remove `stress-concentration`")
                    .into());
            }
            return self.needed(raw.energy.as_ref(), "energy", span, "specimen").map(Toughness::PerVolume);
        };
        if let Some(energy) = &raw.energy {
            let message = "`energy` and `material` are both given";
            let error = self.error(energy.span(), "specimen.energy", message);
            return Err(error.help("keep `energy` or `material`, not both").into());
        }
        let curve = material.branch(Sense::Tension).clone();
        let Some(ultimate) = curve.ultimate() else {
            let message = format!(
                "`{}` has no fracture strain: its curve has no largest stress and does not end in rupture",
                material.name
            );
            let error = self.error(choice.span(), "specimen.material", message);
            let help = "set beyond = \"rupture\" if its data end in rupture, or give `energy` in place of it";
            return Err(error.help(help).into());
        };
        let critical = critical(&curve, material.density).map_or(f64::INFINITY, |critical| critical.velocity);
        let elastic = curve.elastic_limit(material.modulus).0;
        Ok(Toughness::Curve { curve, ultimate, notch: self.si(&raw.notch)?, elastic, critical })
    }
}
