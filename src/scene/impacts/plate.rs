//! `[plate]` scenes: a sphere on an infinite elastic plate.

use std::sync::Arc;

use schemars::JsonSchema;
use serde::Deserialize;
use serde_json::json;
use toml::Spanned;

use super::super::check::{BallKeys, Checker};
use super::super::raw::MaterialChoice;
use super::Parts;
use super::body::{RawSphere, elastic_json, raw_body, solid_json};
use crate::error::Result;
use crate::impact::Plate;
use crate::input::{Allowed, Number};
use crate::units::{Dimension, Quantity};

/// A sphere strikes an infinite elastic plate at rest. Numbers are SI; a text is a number with its unit, such as "10 mm".
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(title = "barwave plate scene")]
pub struct RawPlateScene {
    /// Title, one line. Default: the file's name.
    pub title: Option<String>,
    /// The plate. Required.
    #[schemars(with = "RawPlate")]
    pub plate: Spanned<RawPlate>,
    /// The sphere. Required.
    #[schemars(with = "RawSphere")]
    pub striker: Option<Spanned<RawSphere>>,
    /// How closely and how long the contact is integrated.
    #[serde(default)]
    pub solve: RawPlateSolve,
}

raw_body! {
    /// The plate. Its edges are so far away that no wave returns from them during the contact.
    RawPlate {
        /// Thickness, m, > 0. Required.
        #[schemars(with = "Quantity")]
        pub thickness: Option<Number>,
    }
}

/// How closely and how long the contact is integrated.
#[derive(Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct RawPlateSolve {
    /// Largest defect of Hertz's law between the nodes of a time step, relative to the largest force, 1e-12 to 1e-2. Default: 1e-8.
    #[schemars(with = "Option<f64>")]
    pub tolerance: Option<Number>,
    /// Latest end, s, > 0. Default: 100 Hertz contact times.
    #[schemars(with = "Option<Quantity>")]
    pub until: Option<Number>,
}

pub(super) fn check(checker: &Checker<'_>) -> Result<Parts> {
    let raw: RawPlateScene = checker.document.parse()?;
    let help = "add [striker] with radius, material and velocity";
    let striker = checker.required(raw.striker.as_ref(), "striker", help)?;
    let (span, own) = (raw.plate.span(), raw.plate.get_ref());
    let thickness = (own.thickness.as_ref(), "thickness", Dimension::Length, Allowed::Positive);
    let thickness = checker.own_number(thickness, span.clone(), "plate")?;
    let (elastic, one) = checker.elastic(&own.keys(), span, "plate")?;
    let (striker, two) = checker.sphere(striker, "striker", Allowed::Positive)?;
    let tolerance = checker.contact_tolerance(raw.solve.tolerance.as_ref(), 1e-8)?;
    let until = (raw.solve.until.as_ref(), "solve.until", Dimension::Time, Allowed::Positive);
    let until = checker.document.optional(until.0, until.1, until.2, until.3)?;
    let plate = Plate { thickness, elastic, striker, tolerance, until };
    let resolved = json!({
        "plate": { "thickness": thickness, "elastic": elastic_json(&elastic) },
        "striker": solid_json(&striker),
        "solve": { "tolerance": tolerance, "until": until },
    });
    let materials = [one, two].into_iter().flatten().collect();
    Ok(Parts { title: raw.title, problem: Arc::new(plate), materials, resolved })
}
