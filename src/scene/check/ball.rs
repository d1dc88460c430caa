//! A ball at an end: its size, its mass, and the moduli of its contact with the bar.

use std::f64::consts::PI;
use std::ops::Range;

use toml::Spanned;

use super::super::raw::RawEnd;
use super::Checker;
use super::bar::Named;
use crate::bar::{EndCondition, Hertz};
use crate::error::Result;
use crate::input::{Allowed, Number};
use crate::material::Material;
use crate::units::Dimension;

/// A key with what was given for it, its dimension and its range.
type Wanted<'a> = (Option<&'a Number>, &'a str, Dimension, Allowed);

impl Checker<'_> {
    /// The ball under `key` on a bar of this material.
    pub(super) fn ball(&self, raw: &RawEnd, span: Range<usize>, key: &str, bar: &Material) -> Result<EndCondition> {
        let velocity = (raw.velocity.as_ref(), "velocity", Dimension::Velocity, Allowed::Finite);
        let velocity = self.own_number(velocity, span.clone(), key)?;
        let radius = self.ball_radius(raw, span.clone(), key)?;
        let choice = raw.material.as_ref();
        let material = choice.map(|m| self.material(m, &format!("{key}.material"), &mut Named::new())).transpose()?;
        let material = material.as_deref();
        let mass = self.ball_mass(raw, span.clone(), key, radius, material)?;
        let ball = self.ball_moduli(raw, span.clone(), key, material)?;
        let poisson = (raw.bar_poisson.as_ref(), "bar-poisson", Dimension::None, Allowed::Within(0.0, 0.5));
        let poisson = self.own_or(poisson, bar.poisson, span, key)?;
        Ok(EndCondition::Ball { mass, velocity, contact: Hertz::new(radius, [ball, (bar.modulus, poisson)]) })
    }

    /// What the end states, or else what its material says.
    fn own_or(&self, wanted: Wanted<'_>, known: Option<f64>, span: Range<usize>, key: &str) -> Result<f64> {
        let (Some(known), None) = (known, wanted.0) else { return self.own_number(wanted, span, key) };
        Ok(known)
    }

    fn ball_radius(&self, raw: &RawEnd, span: Range<usize>, key: &str) -> Result<f64> {
        let Some(diameter) = &raw.diameter else {
            let radius = (raw.radius.as_ref(), "radius", Dimension::Length, Allowed::Positive);
            return self.own_number(radius, span, key);
        };
        self.not_both(raw.radius.as_ref().map(Spanned::span), key, ["radius", "diameter"])?;
        Ok(0.5 * self.document.number(diameter, &format!("{key}.diameter"), Dimension::Length, Allowed::Positive)?)
    }

    fn ball_mass(
        &self,
        raw: &RawEnd,
        span: Range<usize>,
        key: &str,
        radius: f64,
        material: Option<&Material>,
    ) -> Result<f64> {
        let Some(mass) = &raw.mass else {
            let density = (raw.density.as_ref(), "density", Dimension::Density, Allowed::Positive);
            let density = self.own_or(density, material.map(|m| m.density), span, key)?;
            return Ok(4.0 / 3.0 * PI * radius.powi(3) * density);
        };
        self.not_both(raw.density.as_ref().map(Spanned::span), key, ["density", "mass"])?;
        self.document.number(mass, &format!("{key}.mass"), Dimension::Mass, Allowed::Positive)
    }

    /// Modulus, Pa, and Poisson's ratio; infinite and 0 where it is rigid.
    fn ball_moduli(
        &self,
        raw: &RawEnd,
        span: Range<usize>,
        key: &str,
        material: Option<&Material>,
    ) -> Result<(f64, f64)> {
        if raw.rigid.as_ref().is_some_and(|rigid| *rigid.get_ref()) {
            self.not_both(raw.modulus.as_ref().map(Spanned::span), key, ["modulus", "rigid"])?;
            self.not_both(raw.poisson.as_ref().map(Spanned::span), key, ["poisson", "rigid"])?;
            return Ok((f64::INFINITY, 0.0));
        }
        let modulus = (raw.modulus.as_ref(), "modulus", Dimension::Stress, Allowed::Positive);
        let poisson = (raw.poisson.as_ref(), "poisson", Dimension::None, Allowed::Within(0.0, 0.5));
        Ok((
            self.own_or(modulus, material.map(|m| m.modulus), span.clone(), key)?,
            self.own_or(poisson, material.and_then(|m| m.poisson), span, key)?,
        ))
    }

    /// Refuses the first of two keys that say the same, where it was given beside the second.
    fn not_both(&self, first: Option<Range<usize>>, key: &str, names: [&str; 2]) -> Result<()> {
        let Some(span) = first else { return Ok(()) };
        let message = format!("`{}` and `{}` both say what the ball is", names[0], names[1]);
        let help = format!("keep `{}` or `{}`, not both", names[0], names[1]);
        Err(self.error(span, &format!("{key}.{}", names[0]), message).help(help).into())
    }
}
