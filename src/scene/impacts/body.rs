//! Striking and struck bodies, shared by all kinds of impacts.

use std::f64::consts::PI;
use std::ops::Range;
use std::sync::Arc;

use super::super::check::Checker;
use super::super::raw::{BodyKeys, MaterialChoice, raw_body};
use crate::error::Result;
use crate::impact::{Elastic, Solid, Tolerances};
use crate::material::{Material, Sense};
use crate::typed::{Of, Placed, Plain, Poisson, Positive};
use crate::units::{Dimension, measures};
use schemars::JsonSchema;
use serde::Deserialize;
use serde_json::{Value, json};

raw_body! {
    /// A solid sphere.
    RawSphere sphere {
        /// Velocity before the impact.
        pub velocity: Of<measures::Velocity, Positive>,
    }
}

/// Tolerance of an integration.
pub(super) type Tolerance = Of<Plain, Tolerances>;

/// Body, with its material if it names one.
pub(super) type Made<T> = (T, Option<Arc<Material>>);

/// Returns the elastic constants in SI units for the resolved scene.
pub(super) fn elastic_json(elastic: &Elastic) -> Value {
    let rigid = elastic.modulus.is_infinite();
    let number = |value: f64| if value.is_finite() { json!(value) } else { Value::Null };
    json!({
        "modulus": number(elastic.modulus), "poisson": elastic.poisson, "density": number(elastic.density),
        "yield_stress": elastic.yield_stress, "rigid": rigid,
    })
}

/// Returns the sphere or half-space in SI units for the resolved scene.
pub(super) fn solid_json(solid: &Solid) -> Value {
    let number = |value: f64| if value.is_finite() { json!(value) } else { Value::Null };
    json!({
        "radius": number(solid.radius), "mass": number(solid.mass), "velocity": solid.velocity,
        "elastic": elastic_json(&solid.elastic),
    })
}

/// Returns the density of a solid sphere of this mass, kg/m^3. Returns NaN if it is out of range: the body then only has a spherical face.
fn mean_density(mass: f64, radius: f64) -> f64 {
    let (density, range) = (mass / (4.0 / 3.0 * PI * radius.powi(3)), Dimension::Density.magnitudes());
    if (range.least..=range.most).contains(&density) { density } else { f64::NAN }
}

impl Checker<'_> {
    /// Reads a sphere for Hertz's contact law.
    pub(super) fn sphere(&self, raw: &Placed<RawSphere>, key: &str) -> Result<Made<Solid>> {
        let (span, raw) = (raw.span(), raw.get_ref());
        self.sphere_at(&raw.keys(), span, key, self.si(&raw.velocity)?)
    }

    /// Reads a sphere whose velocity is known.
    pub(super) fn sphere_at(
        &self,
        keys: &BodyKeys<'_>,
        span: Range<usize>,
        key: &str,
        velocity: f64,
    ) -> Result<Made<Solid>> {
        let radius = self.ball_radius(keys, span.clone(), key)?;
        let material = self.ball_material(keys, key)?;
        let known = material.as_deref();
        if keys.mass.is_none() && keys.density.is_none() {
            self.made_of_something(keys, span.clone(), key, "modulus, poisson and mass or density")?;
        }
        let mass = self.ball_mass(keys, span.clone(), key, radius, known)?;
        let density = keys.density.map(|density| self.si(density)).transpose()?;
        let density = density.or(known.map(|m| m.density)).unwrap_or_else(|| mean_density(mass, radius));
        let elastic = self.elastic_of(keys, known, span, key, density)?;
        Ok((Solid { radius, mass, velocity, elastic }, material))
    }

    /// Reads the elastic constants of a struck body, whose density must be known.
    pub(super) fn elastic(&self, keys: &BodyKeys<'_>, span: Range<usize>, key: &str) -> Result<Made<Elastic>> {
        let material = self.ball_material(keys, key)?;
        self.made_of_something(keys, span.clone(), key, "modulus, poisson and density")?;
        let known = material.as_ref().map(|m| m.density);
        let density = self.given_or(keys.density, known, "density", span.clone(), key)?;
        let elastic = self.elastic_of(keys, material.as_deref(), span, key, density)?;
        Ok((elastic, material))
    }

    /// Reads a half-space, whose density does not affect the contact.
    pub(super) fn half_space(&self, keys: &BodyKeys<'_>, span: Range<usize>, key: &str) -> Result<Made<Solid>> {
        let material = self.ball_material(keys, key)?;
        self.made_of_something(keys, span.clone(), key, "modulus and poisson")?;
        let known = material.as_ref().map_or(f64::NAN, |m| m.density);
        let density = keys.density.map_or(Ok(known), |density| self.si(density))?;
        let elastic = self.elastic_of(keys, material.as_deref(), span, key, density)?;
        Ok((elastic.half_space(), material))
    }

    fn elastic_of(
        &self,
        keys: &BodyKeys<'_>,
        material: Option<&Material>,
        span: Range<usize>,
        key: &str,
        density: f64,
    ) -> Result<Elastic> {
        if !keys.is_rigid() {
            self.made_of_something(keys, span.clone(), key, "modulus, poisson and density")?;
        }
        let (modulus, poisson) = self.ball_moduli(keys, span, key, material)?;
        let limit = |m: &Material| m.branch(Sense::Compression).elastic_limit(m.modulus).1;
        Ok(Elastic { modulus, poisson, density, yield_stress: material.map(limit) })
    }

    /// Refuses a body for which neither a material nor a modulus is given.
    fn made_of_something(&self, keys: &BodyKeys<'_>, span: Range<usize>, key: &str, instead: &str) -> Result<()> {
        if keys.material.is_some() || keys.modulus.is_some() || keys.is_rigid() {
            return Ok(());
        }
        let error = self.error(span, &format!("{key}.material"), "`material` is missing");
        let help = format!("add e.g. material = \"mild-steel\" with poisson = 0.3, or give {instead}");
        Err(error.help(help).into())
    }
}
