//! A ball at an end: its size, its mass, and the moduli of its contact with the bar.

use std::f64::consts::PI;
use std::ops::Range;
use std::sync::Arc;

use toml::Spanned;

use super::super::raw::{MaterialChoice, RawEnd};
use super::Checker;
use super::bar::Named;
use crate::bar::{EndCondition, Hertz};
use crate::error::Result;
use crate::input::{Allowed, Number};
use crate::material::Material;
use crate::units::Dimension;

/// A key with what was given for it, its dimension and its range.
type Wanted<'a> = (Option<&'a Number>, &'a str, Dimension, Allowed);

/// What is given of an elastic ball, wherever it stands.
#[derive(Debug, Clone, Copy, Default)]
pub(in crate::scene) struct BallKeys<'a> {
    pub radius: Option<&'a Number>,
    pub diameter: Option<&'a Number>,
    pub mass: Option<&'a Number>,
    pub density: Option<&'a Number>,
    pub material: Option<&'a Spanned<MaterialChoice>>,
    pub modulus: Option<&'a Number>,
    pub poisson: Option<&'a Number>,
    pub rigid: Option<&'a Spanned<bool>>,
}

impl<'a> From<&'a RawEnd> for BallKeys<'a> {
    fn from(raw: &'a RawEnd) -> Self {
        Self {
            radius: raw.radius.as_ref(),
            diameter: raw.diameter.as_ref(),
            mass: raw.mass.as_ref(),
            density: raw.density.as_ref(),
            material: raw.material.as_ref(),
            modulus: raw.modulus.as_ref(),
            poisson: raw.poisson.as_ref(),
            rigid: raw.rigid.as_ref(),
        }
    }
}

impl Checker<'_> {
    /// The ball under `key` on a bar of this material.
    pub(super) fn ball(&self, raw: &RawEnd, span: Range<usize>, key: &str, bar: &Material) -> Result<EndCondition> {
        let velocity = (raw.velocity.as_ref(), "velocity", Dimension::Velocity, Allowed::Finite);
        let velocity = self.own_number(velocity, span.clone(), key)?;
        let keys = BallKeys::from(raw);
        let radius = self.ball_radius(&keys, span.clone(), key)?;
        let material = self.ball_material(&keys, key)?;
        let material = material.as_deref();
        let mass = self.ball_mass(&keys, span.clone(), key, radius, material)?;
        let ball = self.ball_moduli(&keys, span.clone(), key, material)?;
        let poisson = (raw.bar_poisson.as_ref(), "bar-poisson", Dimension::None, Allowed::Within(0.0, 0.5));
        let poisson = self.own_or(poisson, bar.poisson, span, key)?;
        Ok(EndCondition::Ball { mass, velocity, contact: Hertz::new(radius, [ball, (bar.modulus, poisson)]) })
    }

    /// The ball under `key` on a rigid lever at the end of a bar in torsion, in terms of the surface at `surface` (m): with r the arm
    /// over that radius, the surface moves by 1/r of the lever's end and carries r times the force. Mass, velocity and contact are
    /// those that give the same energies.
    pub(super) fn ball_on_lever(
        &self,
        raw: &RawEnd,
        span: Range<usize>,
        key: &str,
        surface: f64,
    ) -> Result<EndCondition> {
        let own = |wanted| self.own_number(wanted, span.clone(), key);
        let velocity = own((raw.velocity.as_ref(), "velocity", Dimension::Velocity, Allowed::Finite))?;
        let arm = own((raw.arm.as_ref(), "arm", Dimension::Length, Allowed::Positive))?;
        let keys = BallKeys::from(raw);
        let radius = self.ball_radius(&keys, span.clone(), key)?;
        let material = self.ball_material(&keys, key)?;
        let mass = self.ball_mass(&keys, span.clone(), key, radius, material.as_deref())?;
        let ball = self.ball_moduli(&keys, span.clone(), key, material.as_deref())?;
        let contact = Hertz::new(radius, [ball, (f64::INFINITY, 0.0)]);
        let ratio = arm / surface;
        let contact = Hertz { modulus: contact.modulus * ratio.powf(2.5), ..contact };
        Ok(EndCondition::Ball { mass: mass * ratio * ratio, velocity: velocity / ratio, contact })
    }

    /// The material that a ball names, if it names one.
    pub(in crate::scene) fn ball_material(&self, raw: &BallKeys<'_>, key: &str) -> Result<Option<Arc<Material>>> {
        raw.material.map(|m| self.material(m, &format!("{key}.material"), &mut Named::new())).transpose()
    }

    /// What the end states, or else what its material says.
    pub(in crate::scene) fn own_or(
        &self,
        wanted: Wanted<'_>,
        known: Option<f64>,
        span: Range<usize>,
        key: &str,
    ) -> Result<f64> {
        let (Some(known), None) = (known, wanted.0) else { return self.own_number(wanted, span, key) };
        Ok(known)
    }

    pub(in crate::scene) fn ball_radius(&self, raw: &BallKeys<'_>, span: Range<usize>, key: &str) -> Result<f64> {
        let Some(diameter) = raw.diameter else {
            let radius = (raw.radius, "radius", Dimension::Length, Allowed::Positive);
            return self.own_number(radius, span, key);
        };
        self.not_both(raw.radius.map(Spanned::span), key, ["radius", "diameter"])?;
        Ok(0.5 * self.document.number(diameter, &format!("{key}.diameter"), Dimension::Length, Allowed::Positive)?)
    }

    pub(in crate::scene) fn ball_mass(
        &self,
        raw: &BallKeys<'_>,
        span: Range<usize>,
        key: &str,
        radius: f64,
        material: Option<&Material>,
    ) -> Result<f64> {
        let Some(mass) = raw.mass else {
            let density = (raw.density, "density", Dimension::Density, Allowed::Positive);
            let density = self.own_or(density, material.map(|m| m.density), span, key)?;
            return Ok(4.0 / 3.0 * PI * radius.powi(3) * density);
        };
        self.not_both(raw.density.map(Spanned::span), key, ["density", "mass"])?;
        self.document.number(mass, &format!("{key}.mass"), Dimension::Mass, Allowed::Positive)
    }

    /// Modulus, Pa, and Poisson's ratio; infinite and 0 where it is rigid.
    pub(in crate::scene) fn ball_moduli(
        &self,
        raw: &BallKeys<'_>,
        span: Range<usize>,
        key: &str,
        material: Option<&Material>,
    ) -> Result<(f64, f64)> {
        if raw.rigid.is_some_and(|rigid| *rigid.get_ref()) {
            self.not_both(raw.modulus.map(Spanned::span), key, ["modulus", "rigid"])?;
            self.not_both(raw.poisson.map(Spanned::span), key, ["poisson", "rigid"])?;
            return Ok((f64::INFINITY, 0.0));
        }
        let modulus = (raw.modulus, "modulus", Dimension::Stress, Allowed::Positive);
        let poisson = (raw.poisson, "poisson", Dimension::None, Allowed::Within(0.0, 0.5));
        Ok((
            self.own_or(modulus, material.map(|m| m.modulus), span.clone(), key)?,
            self.own_or(poisson, material.and_then(|m| m.poisson), span, key)?,
        ))
    }

    /// Refuses the first of two keys that say the same, where it was given beside the second.
    pub(in crate::scene) fn not_both(&self, first: Option<Range<usize>>, key: &str, names: [&str; 2]) -> Result<()> {
        let Some(span) = first else { return Ok(()) };
        let message = format!("`{}` and `{}` both say what the ball is", names[0], names[1]);
        let help = format!("keep `{}` or `{}`, not both", names[0], names[1]);
        Err(self.error(span, &format!("{key}.{}", names[0]), message).help(help).into())
    }
}
