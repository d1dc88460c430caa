//! `[plate]` scenes: impact of a sphere on an infinite elastic plate.

use std::sync::Arc;

use super::super::check::Checker;
use super::super::raw::{BodyKeys, MaterialChoice, raw_body};
use super::Parts;
use super::body::{RawSphere, Tolerance, elastic_json, solid_json};
use crate::error::Result;
use crate::impact::Plate;
use crate::typed::{Of, Or, Placed, Plain, Poisson, Positive};
use crate::units::measures;
use schemars::JsonSchema;
use serde::Deserialize;
use serde_json::json;

/// A sphere strikes an infinite elastic plate at rest. Numbers are SI; a text is a number with its unit, such as "10 mm".
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(title = "barwave plate scene")]
pub struct RawPlateScene {
    /// Title, one line. Default: the file's name.
    pub title: Option<String>,
    /// The plate. Required.
    pub plate: Placed<RawPlate>,
    /// The sphere. Required.
    #[schemars(with = "RawSphere")]
    pub striker: Option<Placed<RawSphere>>,
    /// Accuracy and duration of the contact integration.
    #[serde(default)]
    pub solve: RawPlateSolve,
}

raw_body! {
    /// The plate, assumed infinite: no reflections from its edges during the contact.
    RawPlate {
        /// Thickness.
        pub thickness: Of<measures::Length, Positive>,
    }
}

/// Accuracy and duration of the contact integration.
#[derive(Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct RawPlateSolve {
    /// Largest defect of Hertz's law between the nodes of a time step, relative to the largest force.
    #[schemars(default)]
    pub tolerance: Or<Tolerance, 1, 100_000_000>,
    /// Latest end time. Default: 100 Hertz contact times.
    pub until: Option<Of<measures::Time, Positive>>,
}

pub(super) fn check(checker: &Checker<'_>) -> Result<Parts> {
    let raw: RawPlateScene = checker.document.parse()?;
    let help = "add [striker] with radius, material and velocity";
    let striker = checker.required(raw.striker.as_ref(), "striker", help)?;
    let (span, own) = (raw.plate.span(), raw.plate.get_ref());
    let thickness = checker.si(&own.thickness)?;
    let (elastic, one) = checker.elastic(&own.keys(), span, "plate")?;
    let (striker, two) = checker.sphere(striker, "striker")?;
    let (tolerance, until) = (checker.si(&raw.solve.tolerance)?, checker.si(&raw.solve.until)?);
    let plate = Plate { thickness, elastic, striker, tolerance, until };
    let resolved = json!({
        "plate": { "thickness": thickness, "elastic": elastic_json(&elastic) },
        "striker": solid_json(&striker),
        "solve": { "tolerance": tolerance, "until": until },
    });
    let materials = [one, two].into_iter().flatten().collect();
    Ok(Parts { title: raw.title, problem: Arc::new(plate), materials, resolved })
}
