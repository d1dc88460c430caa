//! Keys of striking and struck bodies, shared by all kinds of impacts.

use std::f64::consts::PI;
use std::ops::Range;
use std::sync::Arc;

use schemars::JsonSchema;
use serde::Deserialize;
use serde_json::{Value, json};
use toml::Spanned;

use super::super::check::{BallKeys, Checker};
use super::super::raw::MaterialChoice;
use crate::error::Result;
use crate::impact::{Elastic, Solid};
use crate::input::{Allowed, Number};
use crate::material::{Material, Sense};
use crate::units::{Dimension, Quantity};

/// The raw table of a body: its own keys, then those of its material, with the method `keys`. With `sphere`, those of a sphere in between,
/// and what its velocity is. (`serde(flatten)` would lose the places of values and the check of unknown keys.)
macro_rules! raw_body {
    ($(#[$meta:meta])* $name:ident sphere $velocity:literal { $($own:tt)* }) => {
        raw_body! { @table $(#[$meta])* $name {
            $($own)*
            /// Radius, m, > 0; or give `diameter`.
            #[schemars(with = "Option<Quantity>")]
            pub radius: Option<Number>,
            /// Diameter, m, > 0; in place of `radius`.
            #[schemars(with = "Option<Quantity>")]
            pub diameter: Option<Number>,
            /// Mass, kg, > 0. Default: that of a solid sphere.
            #[schemars(with = "Option<Quantity>")]
            pub mass: Option<Number>,
            #[doc = $velocity]
            #[schemars(with = "Option<Quantity>")]
            pub velocity: Option<Number>,
            /// It does not give way, in place of `modulus` and `poisson`. Default: false.
            #[schemars(with = "Option<bool>")]
            pub rigid: Option<Spanned<bool>>,
        } }

        impl $name {
            pub(super) fn keys(&self) -> BallKeys<'_> {
                BallKeys {
                    radius: self.radius.as_ref(),
                    diameter: self.diameter.as_ref(),
                    mass: self.mass.as_ref(),
                    rigid: self.rigid.as_ref(),
                    ..self.material_keys()
                }
            }
        }
    };
    ($(#[$meta:meta])* $name:ident { $($own:tt)* }) => {
        raw_body! { @table $(#[$meta])* $name { $($own)* } }

        impl $name {
            pub(super) fn keys(&self) -> BallKeys<'_> {
                self.material_keys()
            }
        }
    };
    (@table $(#[$meta:meta])* $name:ident { $($own:tt)* }) => {
        $(#[$meta])*
        #[derive(Debug, Deserialize, JsonSchema)]
        #[serde(deny_unknown_fields)]
        pub struct $name {
            $($own)*
            /// What it is made of, for its density, modulus and Poisson's ratio. It stays elastic.
            #[schemars(with = "Option<MaterialChoice>")]
            pub material: Option<Spanned<MaterialChoice>>,
            /// Density, kg/m^3, > 0. Default: its material's.
            #[schemars(with = "Option<Quantity>")]
            pub density: Option<Number>,
            /// Elastic modulus, Pa, > 0. Default: its material's.
            #[schemars(with = "Option<Quantity>")]
            pub modulus: Option<Number>,
            /// Poisson's ratio, 0 to 0.5. Default: its material's.
            #[schemars(with = "Option<f64>")]
            pub poisson: Option<Number>,
        }

        impl $name {
            fn material_keys(&self) -> BallKeys<'_> {
                BallKeys {
                    material: self.material.as_ref(),
                    density: self.density.as_ref(),
                    modulus: self.modulus.as_ref(),
                    poisson: self.poisson.as_ref(),
                    ..BallKeys::default()
                }
            }
        }
    };
}
pub(super) use raw_body;

raw_body! {
    /// A solid sphere.
    RawSphere sphere "Velocity before the impact, m/s." {}
}

/// A body with the material that it names.
pub(super) type Made<T> = (T, Option<Arc<Material>>);

/// SI, for the resolved scene.
pub(super) fn elastic_json(elastic: &Elastic) -> Value {
    let rigid = elastic.modulus.is_infinite();
    let number = |value: f64| if value.is_finite() { json!(value) } else { Value::Null };
    json!({
        "modulus": number(elastic.modulus), "poisson": elastic.poisson, "density": number(elastic.density),
        "yield_stress": elastic.yield_stress, "rigid": rigid,
    })
}

/// SI, for the resolved scene.
pub(super) fn solid_json(solid: &Solid) -> Value {
    let number = |value: f64| if value.is_finite() { json!(value) } else { Value::Null };
    json!({
        "radius": number(solid.radius), "mass": number(solid.mass), "velocity": solid.velocity,
        "elastic": elastic_json(&solid.elastic),
    })
}

impl Checker<'_> {
    /// A sphere with Hertz's contact; `velocity` is what its key may be.
    pub(super) fn sphere(&self, raw: &Spanned<RawSphere>, key: &str, velocity: Allowed) -> Result<Made<Solid>> {
        let (span, raw) = (raw.span(), raw.get_ref());
        let velocity = (raw.velocity.as_ref(), "velocity", Dimension::Velocity, velocity);
        let velocity = self.own_number(velocity, span.clone(), key)?;
        self.sphere_at(&raw.keys(), span, key, velocity)
    }

    /// The same with a velocity that is known.
    pub(super) fn sphere_at(
        &self,
        keys: &BallKeys<'_>,
        span: Range<usize>,
        key: &str,
        velocity: f64,
    ) -> Result<Made<Solid>> {
        let radius = self.ball_radius(keys, span.clone(), key)?;
        let material = self.ball_material(keys, key)?;
        let known = material.as_deref();
        if keys.mass.is_none() && keys.density.is_none() {
            self.made_of_something(keys, span.clone(), key, "mass or density")?;
        }
        let mass = self.ball_mass(keys, span.clone(), key, radius, known)?;
        let elastic = self.elastic_of(keys, known, span, key, mass / (4.0 / 3.0 * PI * radius.powi(3)))?;
        Ok((Solid { radius, mass, velocity, elastic }, material))
    }

    /// The elastic constants of a struck body, whose density must be known.
    pub(super) fn elastic(&self, keys: &BallKeys<'_>, span: Range<usize>, key: &str) -> Result<Made<Elastic>> {
        let material = self.ball_material(keys, key)?;
        self.made_of_something(keys, span.clone(), key, "density")?;
        let density = (keys.density, "density", Dimension::Density, Allowed::Positive);
        let density = self.own_or(density, material.as_ref().map(|m| m.density), span.clone(), key)?;
        let elastic = self.elastic_of(keys, material.as_deref(), span, key, density)?;
        Ok((elastic, material))
    }

    fn elastic_of(
        &self,
        keys: &BallKeys<'_>,
        material: Option<&Material>,
        span: Range<usize>,
        key: &str,
        density: f64,
    ) -> Result<Elastic> {
        if !keys.rigid.is_some_and(|rigid| *rigid.get_ref()) {
            self.made_of_something(keys, span.clone(), key, "density, modulus and poisson")?;
        }
        let (modulus, poisson) = self.ball_moduli(keys, span, key, material)?;
        let limit = |m: &Material| m.branch(Sense::Compression).elastic_limit(m.modulus).1;
        Ok(Elastic { modulus, poisson, density, yield_stress: material.map(limit) })
    }

    /// Refuses a body of which neither a material nor a modulus is given.
    fn made_of_something(&self, keys: &BallKeys<'_>, span: Range<usize>, key: &str, instead: &str) -> Result<()> {
        let rigid = keys.rigid.is_some_and(|rigid| *rigid.get_ref());
        if keys.material.is_some() || keys.modulus.is_some() || rigid {
            return Ok(());
        }
        let error = self.error(span, &format!("{key}.material"), "`material` is missing");
        let help =
            format!("add e.g. material = \"mild-steel\" with poisson = 0.3, or give modulus, poisson and {instead}");
        Err(error.help(help.replace("poisson and density, modulus and poisson", "poisson and density")).into())
    }

    /// The step tolerance or the tolerance of the results.
    pub(super) fn contact_tolerance(&self, raw: Option<&Number>, default: f64) -> Result<f64> {
        let range = Allowed::Within(1e-12, 1e-2);
        Ok(self.document.optional(raw, "solve.tolerance", Dimension::None, range)?.unwrap_or(default))
    }
}
