//! What the members of an impact may be: scenes are checked where they are read, impacts put together in a program here.

use super::solid::{Elastic, Solid};
use crate::error::InputError;
use crate::input::Allowed;
use crate::units::Dimension;

pub(super) type Checked = Result<(), InputError>;

/// Tolerances of an integration.
pub(super) const TOLERANCES: Allowed = Allowed::Between(0.0, 1.0);

/// A number that has to lie in a range.
pub(super) fn member(name: &str, value: f64, dimension: Dimension, allowed: Allowed) -> Checked {
    if allowed.holds(value) {
        return Ok(());
    }
    let last = name.rsplit('.').next().unwrap_or(name);
    Err(out_of_range(name, value).allowed(allowed.describe(last, dimension)))
}

/// Numbers that have to be positive.
pub(super) fn positive<const N: usize>(members: [(&str, f64, Dimension); N]) -> Checked {
    members.into_iter().try_for_each(|(name, value, dimension)| member(name, value, dimension, Allowed::Positive))
}

/// A number that has to be positive, and may be infinite.
pub(super) fn positive_or_infinite(name: &str, value: f64, dimension: Dimension) -> Checked {
    if value == f64::INFINITY { Ok(()) } else { member(name, value, dimension, Allowed::Positive) }
}

fn out_of_range(name: &str, value: f64) -> InputError {
    InputError::new(format!("{value} is out of range")).key(name).help(format!("set `{name}` to a value in this range"))
}

/// Velocities (m/s) with which a striker meets another body, in the member of this name.
pub(super) fn meet(name: &str, striker: f64, struck: f64) -> Checked {
    let range = Dimension::Velocity.magnitudes();
    if range.most >= striker.abs() && range.most >= struck.abs() && striker - struck >= range.least {
        return Ok(());
    }
    let message = format!("the striker, at {striker} m/s, does not catch up with the struck body, at {struck} m/s");
    let allowed = format!(
        "a velocity at least {:e} m/s above that of the struck body, and velocities up to {:e} m/s",
        range.least, range.most
    );
    let help = "give the striker the larger velocity; both are positive in the direction of the impact";
    Err(InputError::new(message).key(name).allowed(allowed).help(help))
}

impl Elastic {
    /// Of the body of this name; `density` is needed.
    pub(super) fn check(&self, name: &str, density: bool) -> Checked {
        let of = |member: &str| format!("{name}.{member}");
        positive_or_infinite(&of("modulus"), self.modulus, Dimension::Stress)?;
        member(&of("poisson"), self.poisson, Dimension::None, Allowed::Within(0.0, 0.5))?;
        if density || !self.density.is_nan() {
            member(&of("density"), self.density, Dimension::Density, Allowed::Positive)?;
        }
        self.yield_stress.map_or(Ok(()), |stress| positive([(&of("yield_stress"), stress, Dimension::Stress)]))
    }

    /// The same of a body that bends.
    pub(super) fn check_of_struck(&self, name: &str) -> Checked {
        self.check(name, true)?;
        positive([(&format!("{name}.modulus"), self.modulus, Dimension::Stress)])
    }
}

impl Solid {
    /// Of the body of this name.
    pub(super) fn check(&self, name: &str) -> Checked {
        positive_or_infinite(&format!("{name}.radius"), self.radius, Dimension::Length)?;
        positive_or_infinite(&format!("{name}.mass"), self.mass, Dimension::Mass)?;
        self.elastic.check(&format!("{name}.elastic"), false)
    }

    /// Of a sphere that strikes a body at this velocity, m/s.
    pub(super) fn check_of_striker(&self, name: &str, struck: f64) -> Checked {
        self.check(name)?;
        let (radius, mass) = (format!("{name}.radius"), format!("{name}.mass"));
        positive([(&radius, self.radius, Dimension::Length), (&mass, self.mass, Dimension::Mass)])?;
        meet(&format!("{name}.velocity"), self.velocity, struck)
    }
}
