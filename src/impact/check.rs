//! Checks of the members of an impact. Scenes are checked where they are read, impacts constructed in a program here.

use super::solid::{Elastic, Solid};
use crate::error::InputError;
use crate::input::{Allowed, Checked, member, positive, positive_or_infinite};
use crate::typed::{Range, Within};
use crate::units::Dimension;

/// Tolerances of an integration, 1e-12 to 0.01, in scenes and in programs: smaller ones are below round-off.
pub(crate) type Tolerances = Within<1, 10_000_000_000, 1_000_000_000_000>;

/// Checks the tolerance of an integration.
pub(super) fn tolerance(value: f64) -> Checked {
    member("tolerance", value, Dimension::None, Tolerances::ALLOWED)
}

/// Checks the velocities (m/s) of a striker and a struck body; `name` is the member that holds the velocity of the striker.
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
    /// Checks the constants of the body of this name; the density must be known if `density` is true.
    pub(super) fn check(&self, name: &str, density: bool) -> Checked {
        let of = |member: &str| format!("{name}.{member}");
        positive_or_infinite(&of("modulus"), self.modulus, Dimension::Stress)?;
        member(&of("poisson"), self.poisson, Dimension::None, Allowed::Within(0.0, 0.5))?;
        if density || !self.density.is_nan() {
            member(&of("density"), self.density, Dimension::Density, Allowed::Positive)?;
        }
        self.yield_stress.map_or(Ok(()), |stress| positive([(&of("yield_stress"), stress, Dimension::Stress)]))
    }

    /// Checks the constants of a body that bends: its density is known, and it is not rigid.
    pub(super) fn check_of_struck(&self, name: &str) -> Checked {
        self.check(name, true)?;
        positive([(&format!("{name}.modulus"), self.modulus, Dimension::Stress)])
    }
}

impl Solid {
    /// Checks the body of this name.
    pub(super) fn check(&self, name: &str) -> Checked {
        positive_or_infinite(&format!("{name}.radius"), self.radius, Dimension::Length)?;
        positive_or_infinite(&format!("{name}.mass"), self.mass, Dimension::Mass)?;
        self.elastic.check(&format!("{name}.elastic"), false)
    }

    /// Checks a sphere that strikes a body with the velocity `struck`, m/s.
    pub(super) fn check_of_striker(&self, name: &str, struck: f64) -> Checked {
        self.check(name)?;
        let (radius, mass) = (format!("{name}.radius"), format!("{name}.mass"));
        positive([(&radius, self.radius, Dimension::Length), (&mass, self.mass, Dimension::Mass)])?;
        meet(&format!("{name}.velocity"), self.velocity, struck)
    }
}
