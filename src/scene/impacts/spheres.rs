//! `[spheres]` scenes: direct central impact of two bodies.

use std::sync::Arc;

use super::super::check::{Checker, first_given};
use super::super::raw::{BodyKeys, MaterialChoice, raw_body};
use super::Parts;
use super::body::{Tolerance, solid_json};
use crate::error::Result;
use crate::impact::{Solid, Spheres};
use crate::typed::{Key, Of, Or, Placed, Plain, Poisson, Positive, Within};
use crate::units::{Dimension, measures};
use schemars::JsonSchema;
use serde::Deserialize;
use serde_json::json;

/// Direct central impact of two bodies. Numbers are SI; a text is a number with its unit, such as "10 mm".
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(title = "barwave spheres scene")]
pub struct RawSpheresScene {
    /// Title, one line. Default: the file's name.
    pub title: Option<String>,
    /// The struck body, and how the bodies collide. Required.
    pub spheres: Placed<RawSpheres>,
    /// The striking body. Required.
    #[schemars(with = "RawStrikingSphere")]
    pub striker: Option<Placed<RawStrikingSphere>>,
    /// Accuracy of the contact integration.
    #[serde(default)]
    pub solve: RawSpheresSolve,
}

raw_body! {
    /// The striking body.
    RawStrikingSphere sphere {
        /// Velocity before the impact.
        pub velocity: Option<Of<measures::Velocity>>,
    }
}

raw_body! {
    /// The struck body. With `restitution` the velocities follow from equation 9.3, with `velocity-after` from 9.4; with neither, the contact is integrated by Hertz's law.
    RawSpheres sphere {
        /// Velocity before the impact, below that of the striker.
        #[schemars(default)]
        pub velocity: Or<Of<measures::Velocity>, 0>,
        /// Coefficient of restitution. Needs only the masses and velocities of the bodies.
        pub restitution: Option<Of<Plain, Within<0, 1>>>,
        /// Ballistic pendulum: velocity of both bodies after the striker has embedded in the struck body at rest. Needs only the masses of the bodies.
        pub velocity_after: Option<Of<measures::Velocity, Positive>>,
        /// The struck body is a fixed half-space. Default: false.
        pub half_space: Option<Placed<bool>>,
    }
}

/// Accuracy of the contact integration.
#[derive(Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct RawSpheresSolve {
    /// Largest defect of Hertz's law between the nodes of a time step, relative to the largest force.
    #[schemars(default)]
    pub tolerance: Or<Tolerance, 1, 100_000_000>,
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

impl RawSpheres {
    fn is_half_space(&self) -> bool {
        self.half_space.as_ref().is_some_and(|half_space| *half_space.get_ref())
    }
}

/// Problem with the data of both bodies, and their materials.
type Bodies = (Spheres, Vec<Arc<crate::material::Material>>);

impl Checker<'_> {
    /// Reads a problem that is solved from masses and velocities alone (equations 9.3 and 9.4).
    fn by_momentum(&self, raw: &Placed<RawSpheres>, striker: &Placed<RawStrikingSphere>) -> Result<Spheres> {
        let struck = raw.get_ref();
        let masses = self.masses(raw, striker)?;
        if let Some(after) = &struck.velocity_after {
            self.pendulum_swings(struck, striker.get_ref())?;
            return Ok(Spheres::Pendulum { masses, after: self.si(after)? });
        }
        let restitution = self.needed(struck.restitution.as_ref(), "restitution", raw.span(), "spheres")?;
        let velocities = self.closing_velocities(struck, striker)?;
        Ok(Spheres::Restitution { masses, velocities, restitution })
    }

    /// Returns the masses of the striker and the struck body, kg.
    fn masses(&self, raw: &Placed<RawSpheres>, striker: &Placed<RawStrikingSphere>) -> Result<[f64; 2]> {
        let (struck, body) = (raw.get_ref(), striker.get_ref());
        if struck.is_half_space() {
            self.nothing_of_a_sphere(struck)?;
        }
        self.not_elastic(&body.keys(), "striker")?;
        self.not_elastic(&struck.keys(), "spheres")?;
        let first = self.needed(body.mass.as_ref(), "mass", striker.span(), "striker")?;
        if struck.is_half_space() {
            return Ok([first, f64::INFINITY]);
        }
        Ok([first, self.needed(struck.mass.as_ref(), "mass", raw.span(), "spheres")?])
    }

    /// Refuses keys that contradict a struck body that is at rest before the impact and moves after it.
    fn pendulum_swings(&self, struck: &RawSpheres, body: &RawStrikingSphere) -> Result<()> {
        let at_rest = "with `velocity-after` the velocity of the striker is the result, and the struck body is at rest";
        let fixed = "with `velocity-after` the struck body moves after the impact; a half-space is fixed";
        let half_space = struck.half_space.as_ref().filter(|_| struck.is_half_space());
        for (given, key, message) in [
            (half_space.map(Placed::span), "spheres.half-space", fixed),
            (struck.restitution.place(), "spheres.restitution", at_rest),
            (struck.velocity.place(), "spheres.velocity", at_rest),
            (body.velocity.place(), "striker.velocity", at_rest),
        ] {
            if let Some(given) = given {
                return Err(self.error(given, key, message).help("remove it or `velocity-after`").into());
            }
        }
        Ok(())
    }

    /// Refuses keys of the contact if it is not simulated.
    fn not_elastic(&self, keys: &BodyKeys<'_>, key: &str) -> Result<()> {
        let given = first_given([
            ("radius", keys.radius.place()),
            ("diameter", keys.diameter.place()),
            ("density", keys.density.place()),
            ("material", keys.material.map(Placed::span)),
            ("modulus", keys.modulus.place()),
            ("poisson", keys.poisson.place()),
            ("rigid", keys.rigid.map(Placed::span)),
        ]);
        let Some((name, span)) = given else { return Ok(()) };
        let message = format!(
            "`{name}` has no effect: with `restitution` or `velocity-after` only masses and velocities are used"
        );
        let help = "remove it and give `mass`; or remove `restitution` or `velocity-after` for Hertz's contact";
        Err(self.error(span, &format!("{key}.{name}"), message).help(help).into())
    }

    fn closing_velocities(&self, struck: &RawSpheres, striker: &Placed<RawStrikingSphere>) -> Result<[f64; 2]> {
        let given = striker.get_ref().velocity.as_ref();
        let velocity = self.needed(given, "velocity", striker.span(), "striker")?;
        let other = self.si(&struck.velocity)?;
        let (closing, least) = (velocity - other, Dimension::Velocity.magnitudes().least);
        if closing >= least {
            return Ok([velocity, other]);
        }
        let (message, allowed) = if closing > 0.0 {
            let message = format!("a closing velocity of {closing:e} m/s is beyond the range of a velocity");
            (message, format!("velocity >= {other} m/s + {least:e} m/s"))
        } else {
            let message =
                format!("the striker, at {velocity} m/s, does not catch up with the struck body, at {other} m/s");
            (message, format!("velocity > {other} m/s"))
        };
        let span = given.place().unwrap_or_else(|| striker.span());
        let error = self.error(span, "striker.velocity", message).allowed(allowed);
        Err(error.help("give the striker the larger velocity; both are positive in the direction of the impact").into())
    }

    fn by_hertz(&self, raw: &RawSpheresScene, striker: &Placed<RawStrikingSphere>) -> Result<Bodies> {
        let (span, struck) = (raw.spheres.span(), raw.spheres.get_ref());
        let velocities = self.closing_velocities(struck, striker)?;
        let (first, one) = self.sphere_at(&striker.get_ref().keys(), striker.span(), "striker", velocities[0])?;
        let (second, two) = if struck.is_half_space() {
            self.nothing_of_a_sphere(struck)?;
            self.half_space(&struck.keys(), span, "spheres")?
        } else {
            self.sphere_at(&struck.keys(), span.clone(), "spheres", velocities[1])?
        };
        self.one_gives_way([&first, &second], striker)?;
        let tolerance = self.si(&raw.solve.tolerance)?;
        let materials = [one, two].into_iter().flatten().collect();
        Ok((Spheres::Hertz { solids: [first, second], tolerance }, materials))
    }

    /// Refuses two rigid bodies, whose contact has no duration.
    fn one_gives_way(&self, solids: [&Solid; 2], striker: &Placed<RawStrikingSphere>) -> Result<()> {
        if solids.iter().any(|solid| solid.elastic.modulus.is_finite()) {
            return Ok(());
        }
        let error = self.error(striker.span(), "striker.rigid", "both bodies are rigid: their contact has no duration");
        Err(error.help("give one of them a material, or give `restitution`").into())
    }

    fn nothing_of_a_sphere(&self, struck: &RawSpheres) -> Result<()> {
        let given = first_given([
            ("radius", struck.radius.place()),
            ("diameter", struck.diameter.place()),
            ("mass", struck.mass.place()),
            ("velocity", struck.velocity.place()),
        ]);
        let Some((name, span)) = given else { return Ok(()) };
        let error = self.error(span, &format!("spheres.{name}"), format!("a fixed half-space has no `{name}`"));
        Err(error.help(format!("remove `{name}` or `half-space`")).into())
    }
}
