//! `[spheres]` scenes: two bodies in direct central impact.

use std::sync::Arc;

use schemars::JsonSchema;
use serde::Deserialize;
use serde_json::json;
use toml::Spanned;

use super::super::check::{BallKeys, Checker};
use super::super::raw::MaterialChoice;
use super::Parts;
use super::body::{RawSphere, raw_body, solid_json};
use crate::error::Result;
use crate::impact::{Solid, Spheres};
use crate::input::{Allowed, Number};
use crate::units::{Dimension, Quantity};

/// Direct central impact of two bodies. Numbers are SI; a text is a number with its unit, such as "10 mm".
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(title = "barwave spheres scene")]
pub struct RawSpheresScene {
    /// Title, one line. Default: the file's name.
    pub title: Option<String>,
    /// The struck body, and how the bodies collide. Required.
    #[schemars(with = "RawSpheres")]
    pub spheres: Spanned<RawSpheres>,
    /// The striking body. Required.
    #[schemars(with = "RawSphere")]
    pub striker: Option<Spanned<RawSphere>>,
    /// How closely the contact is integrated.
    #[serde(default)]
    pub solve: RawSpheresSolve,
}

raw_body! {
    /// The struck body. With `restitution` the velocities follow from equation 9.3, with `velocity-after` from 9.4; with neither the contact
    /// is Hertz's.
    RawSpheres sphere "Velocity before the impact, m/s, below that of the striker. Default: 0." {
        /// Coefficient of restitution, 0 to 1. Of the bodies, masses and velocities are then required, and nothing else.
        #[schemars(with = "Option<f64>")]
        pub restitution: Option<Number>,
        /// Ballistic pendulum: velocity of both bodies after the striker has embedded in the struck one at rest, m/s, > 0. Of the bodies,
        /// masses are then required, and nothing else.
        #[serde(rename = "velocity-after")]
        #[schemars(with = "Option<Quantity>")]
        pub velocity_after: Option<Number>,
        /// The struck body is a fixed half-space. Default: false.
        #[serde(rename = "half-space")]
        #[schemars(with = "Option<bool>")]
        pub half_space: Option<Spanned<bool>>,
    }
}

/// How closely the contact is integrated.
#[derive(Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct RawSpheresSolve {
    /// Largest defect of Hertz's law between the nodes of a time step, relative to the largest force, 1e-12 to 1e-2. Default: 1e-8.
    #[schemars(with = "Option<f64>")]
    pub tolerance: Option<Number>,
}

pub(super) fn check(checker: &Checker<'_>) -> Result<Parts> {
    let raw: RawSpheresScene = checker.document.parse()?;
    let help = "add [striker] with mass or radius, material and velocity";
    let striker = checker.required(raw.striker.as_ref(), "striker", help)?;
    let spheres = raw.spheres.get_ref();
    let (problem, materials) = if spheres.restitution.is_some() || spheres.velocity_after.is_some() {
        (checker.by_momentum(&raw.spheres, striker)?, Vec::new())
    } else {
        checker.by_hertz(&raw, striker)?
    };
    let resolved = match &problem {
        Spheres::Restitution { masses, velocities, restitution } => json!({
            "spheres": { "mass": masses[1], "velocity": velocities[1], "restitution": restitution },
            "striker": { "mass": masses[0], "velocity": velocities[0] },
        }),
        Spheres::Pendulum { masses, after } => json!({
            "spheres": { "mass": masses[1], "velocity-after": after }, "striker": { "mass": masses[0] },
        }),
        Spheres::Hertz { solids, tolerance } => json!({
            "spheres": solid_json(&solids[1]), "striker": solid_json(&solids[0]), "solve": { "tolerance": tolerance },
        }),
    };
    Ok(Parts { title: raw.title, problem: Arc::new(problem), materials, resolved })
}

/// What is known of both bodies, and their materials.
type Bodies = (Spheres, Vec<Arc<crate::material::Material>>);

impl Checker<'_> {
    /// Equations 9.3 and 9.4: masses and velocities alone.
    fn by_momentum(&self, raw: &Spanned<RawSpheres>, striker: &Spanned<RawSphere>) -> Result<Spheres> {
        let (span, struck) = (raw.span(), raw.get_ref());
        let mass = |value, span, key| self.own_number((value, "mass", Dimension::Mass, Allowed::Positive), span, key);
        let body = striker.get_ref();
        self.not_elastic(&body.keys(), "striker")?;
        self.not_elastic(&struck.keys(), "spheres")?;
        let masses =
            [mass(body.mass.as_ref(), striker.span(), "striker")?, mass(struck.mass.as_ref(), span, "spheres")?];
        if let Some(after) = &struck.velocity_after {
            for (given, key) in [
                (struck.restitution.as_ref(), "spheres.restitution"),
                (struck.velocity.as_ref(), "spheres.velocity"),
                (body.velocity.as_ref(), "striker.velocity"),
            ] {
                if let Some(given) = given {
                    let message = "with `velocity-after` the velocity of the striker is the result, and the struck body is at rest";
                    return Err(self.error(given.span(), key, message).help("remove it or `velocity-after`").into());
                }
            }
            let key = "spheres.velocity-after";
            let after = self.document.number(after, key, Dimension::Velocity, Allowed::Positive)?;
            return Ok(Spheres::Pendulum { masses, after });
        }
        let restitution = (struck.restitution.as_ref(), "restitution", Dimension::None, Allowed::Within(0.0, 1.0));
        let restitution = self.own_number(restitution, raw.span(), "spheres")?;
        let velocities = self.closing_velocities(struck, striker)?;
        Ok(Spheres::Restitution { masses, velocities, restitution })
    }

    /// Refuses keys of the contact where it has no part.
    fn not_elastic(&self, keys: &BallKeys<'_>, key: &str) -> Result<()> {
        let given = [
            (keys.radius.map(Spanned::span), "radius"),
            (keys.diameter.map(Spanned::span), "diameter"),
            (keys.density.map(Spanned::span), "density"),
            (keys.material.map(Spanned::span), "material"),
            (keys.modulus.map(Spanned::span), "modulus"),
            (keys.poisson.map(Spanned::span), "poisson"),
            (keys.rigid.map(Spanned::span), "rigid"),
        ];
        let Some((span, name)) = given.into_iter().find_map(|(span, name)| Some((span?, name))) else { return Ok(()) };
        let message =
            format!("`{name}` has no effect: with `restitution` or `velocity-after` only masses and velocities count");
        let help = "remove it and give `mass`; or remove `restitution` or `velocity-after` for Hertz's contact";
        Err(self.error(span, &format!("{key}.{name}"), message).help(help).into())
    }

    fn closing_velocities(&self, struck: &RawSpheres, striker: &Spanned<RawSphere>) -> Result<[f64; 2]> {
        let given = striker.get_ref().velocity.as_ref();
        let own = (given, "velocity", Dimension::Velocity, Allowed::Finite);
        let velocity = self.own_number(own, striker.span(), "striker")?;
        let key = "spheres.velocity";
        let other = self.document.optional(struck.velocity.as_ref(), key, Dimension::Velocity, Allowed::Finite)?;
        let other = other.unwrap_or(0.0);
        if velocity > other {
            return Ok([velocity, other]);
        }
        let message = format!("the striker, at {velocity} m/s, does not catch up with the struck body, at {other} m/s");
        let span = given.map_or(striker.span(), Spanned::span);
        let error = self.error(span, "striker.velocity", message).allowed(format!("velocity > {other} m/s"));
        Err(error.help("give the striker the larger velocity; both are positive in the direction of the impact").into())
    }

    fn by_hertz(&self, raw: &RawSpheresScene, striker: &Spanned<RawSphere>) -> Result<Bodies> {
        let (span, struck) = (raw.spheres.span(), raw.spheres.get_ref());
        let velocities = self.closing_velocities(struck, striker)?;
        let (first, one) = self.sphere_at(&striker.get_ref().keys(), striker.span(), "striker", velocities[0])?;
        let (second, two) = if struck.half_space.as_ref().is_some_and(|h| *h.get_ref()) {
            self.nothing_of_a_sphere(struck)?;
            let (elastic, material) = self.elastic(&struck.keys(), span, "spheres")?;
            (elastic.half_space(), material)
        } else {
            self.sphere_at(&struck.keys(), span.clone(), "spheres", velocities[1])?
        };
        self.one_gives_way([&first, &second], striker)?;
        let tolerance = self.contact_tolerance(raw.solve.tolerance.as_ref(), 1e-8)?;
        let materials = [one, two].into_iter().flatten().collect();
        Ok((Spheres::Hertz { solids: [first, second], tolerance }, materials))
    }

    /// Refuses two rigid bodies: their contact has no duration.
    fn one_gives_way(&self, solids: [&Solid; 2], striker: &Spanned<RawSphere>) -> Result<()> {
        if solids.iter().any(|solid| solid.elastic.modulus.is_finite()) {
            return Ok(());
        }
        let error = self.error(striker.span(), "striker.rigid", "both bodies are rigid: their contact has no duration");
        Err(error.help("give one of them a material, or give `restitution`").into())
    }

    fn nothing_of_a_sphere(&self, struck: &RawSpheres) -> Result<()> {
        let given = [
            (&struck.radius, "radius"),
            (&struck.diameter, "diameter"),
            (&struck.mass, "mass"),
            (&struck.velocity, "velocity"),
        ];
        let Some((value, name)) = given.into_iter().find_map(|(value, name)| Some((value.as_ref()?, name))) else {
            return Ok(());
        };
        let error = self.error(value.span(), &format!("spheres.{name}"), format!("a fixed half-space has no `{name}`"));
        Err(error.help(format!("remove `{name}` or `half-space`")).into())
    }
}
