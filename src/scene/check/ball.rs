//! Balls at an end: radius, mass, and the moduli of the contact with the bar.

use std::f64::consts::PI;
use std::ops::Range;
use std::sync::Arc;

use super::super::raw::{Ball, BallOnLever, BodyKeys, MaterialChoice};
use super::Checker;
use super::bar::Named;
use super::ends::EndSite;
use crate::bar::{EndCondition, Hertz};
use crate::error::Result;
use crate::material::{Loading, Material};
use crate::typed::{Key, Of, Placed};
use crate::units::{Dimension, Measure};

impl Checker<'_> {
    /// Reads a ball at the end of a bar.
    pub(super) fn ball(&self, raw: &Ball, site: &EndSite<'_>) -> Result<EndCondition> {
        let (radius, mass, ball) = self.ball_body(&raw.keys(), site)?;
        let bar = &site.segment.material;
        let poisson =
            self.given_or(raw.bar_poisson.as_ref(), bar.poisson, "bar-poisson", site.span.clone(), site.key)?;
        let contact = Hertz::new(radius, [ball, (bar.modulus, poisson)]);
        Ok(EndCondition::Ball { mass, velocity: self.si(&raw.velocity)?, contact })
    }

    /// Reads a ball on a rigid lever at the end of a bar in torsion, in terms of the surface. With r the ratio of the arm to the radius of the
    /// surface, the velocity of the surface is 1/r of that of the lever's end, and its force is r times that of the ball. Mass, velocity and contact
    /// modulus are chosen such that the energies are equal.
    pub(super) fn ball_on_lever(&self, raw: &BallOnLever, site: &EndSite<'_>) -> Result<EndCondition> {
        if let Some(rigid) = raw.rigid.as_ref().filter(|rigid| *rigid.get_ref()) {
            let message = "a rigid ball on a rigid lever has no contact compliance";
            return Err(self.error(rigid.span(), &format!("{}.rigid", site.key), message).help("remove it").into());
        }
        let ratio = self.si(&raw.arm)? / site.radius;
        let (radius, mass, ball) = self.ball_body(&raw.keys(), site)?;
        let contact = Hertz::new(radius, [ball, (f64::INFINITY, 0.0)]);
        let contact = Hertz { modulus: contact.modulus * ratio.powf(2.5), ..contact };
        Ok(EndCondition::Ball { mass: mass * ratio * ratio, velocity: self.si(&raw.velocity)? / ratio, contact })
    }

    /// Returns the radius and mass of the ball, and the moduli of its side of the contact.
    fn ball_body(&self, keys: &BodyKeys<'_>, site: &EndSite<'_>) -> Result<(f64, f64, (f64, f64))> {
        let (key, span) = (site.key, || site.span.clone());
        let radius = self.ball_radius(keys, span(), key)?;
        let material = self.ball_material(keys, key)?;
        let mass = self.ball_mass(keys, span(), key, radius, material.as_deref())?;
        Ok((radius, mass, self.ball_moduli(keys, span(), key, material.as_deref())?))
    }

    /// Returns the material that a body names, if any.
    pub(in crate::scene) fn ball_material(&self, raw: &BodyKeys<'_>, key: &str) -> Result<Option<Arc<Material>>> {
        raw.material.map(|choice| self.axial_material(choice, &format!("{key}.material"))).transpose()
    }

    /// Returns the material of a body under compression, bending or tension; refuses shear curves, whose modulus is not Young's modulus.
    pub(in crate::scene) fn axial_material(&self, choice: &Placed<MaterialChoice>, key: &str) -> Result<Arc<Material>> {
        let material = self.material(choice, key, &mut Named::new())?;
        if material.loading == Loading::Axial {
            return Ok(material);
        }
        let message = format!("`{}` has a shear curve, whose modulus is not Young's", material.name);
        Err(self.error(choice.span(), key, message).help("use a material with a tension curve").into())
    }

    /// Returns the given value, or else that of the material.
    pub(in crate::scene) fn given_or<D: Measure, R: crate::typed::Range>(
        &self,
        given: Option<&Of<D, R>>,
        known: Option<f64>,
        name: &str,
        span: Range<usize>,
        key: &str,
    ) -> Result<f64> {
        let (Some(known), None) = (known, given) else { return self.needed(given, name, span, key) };
        Ok(known)
    }

    pub(in crate::scene) fn ball_radius(&self, raw: &BodyKeys<'_>, span: Range<usize>, key: &str) -> Result<f64> {
        let Some(diameter) = raw.diameter else { return self.needed(raw.radius, "radius", span, key) };
        self.not_both(raw.radius.place(), key, ["radius", "diameter"])?;
        Ok(0.5 * self.si(diameter)?)
    }

    pub(in crate::scene) fn ball_mass(
        &self,
        raw: &BodyKeys<'_>,
        span: Range<usize>,
        key: &str,
        radius: f64,
        material: Option<&Material>,
    ) -> Result<f64> {
        let Some(mass) = raw.mass else {
            let density = self.given_or(raw.density, material.map(|m| m.density), "density", span, key)?;
            return self.mass_of_sphere(raw, radius, density, key);
        };
        self.not_both(raw.density.place(), key, ["density", "mass"])?;
        self.si(mass)
    }

    fn mass_of_sphere(&self, raw: &BodyKeys<'_>, radius: f64, density: f64, key: &str) -> Result<f64> {
        let (mass, range) = (4.0 / 3.0 * PI * radius.powi(3) * density, Dimension::Mass.magnitudes());
        if (range.least..=range.most).contains(&mass) {
            return Ok(mass);
        }
        let (name, size) = if raw.diameter.is_some() { ("diameter", raw.diameter) } else { ("radius", raw.radius) };
        let message = format!("a solid sphere of this {name} has a mass of {mass:e} kg, which is out of range");
        let span = size.map_or(0..0, Of::span);
        let error = self.error(span, &format!("{key}.{name}"), message);
        let allowed = format!("{:e} <= mass <= {:e} kg", range.least, range.most);
        Err(error.allowed(allowed).help(format!("change `{name}`, or give `mass`")).into())
    }

    /// Returns the modulus, Pa, and Poisson's ratio; infinity and 0 for a rigid body.
    pub(in crate::scene) fn ball_moduli(
        &self,
        raw: &BodyKeys<'_>,
        span: Range<usize>,
        key: &str,
        material: Option<&Material>,
    ) -> Result<(f64, f64)> {
        if raw.is_rigid() {
            self.not_both(raw.modulus.place(), key, ["modulus", "rigid"])?;
            self.not_both(raw.poisson.place(), key, ["poisson", "rigid"])?;
            return Ok((f64::INFINITY, 0.0));
        }
        let modulus = self.given_or(raw.modulus, material.map(|m| m.modulus), "modulus", span.clone(), key)?;
        Ok((modulus, self.given_or(raw.poisson, material.and_then(|m| m.poisson), "poisson", span, key)?))
    }

    /// Refuses the first of two redundant keys, if it is given together with the second.
    pub(in crate::scene) fn not_both(&self, first: Option<Range<usize>>, key: &str, names: [&str; 2]) -> Result<()> {
        let Some(span) = first else { return Ok(()) };
        let message = format!("`{}` and `{}` are both given for the ball", names[0], names[1]);
        let help = format!("keep `{}` or `{}`, not both", names[0], names[1]);
        Err(self.error(span, &format!("{key}.{}", names[0]), message).help(help).into())
    }
}
