//! Striking and struck solids, and the limits of Hertz's theory of their contact.

use std::f64::consts::PI;

use super::solution::{Figure, Line, Solution};
use crate::bar::Hertz;
use crate::units::Dimension;

/// Largest pressure of a Hertz contact at first yield over the yield stress: 1.60 for von Mises' criterion and a Poisson's ratio of
/// 0.3 (K. L. Johnson, Contact Mechanics (1985), section 6.2).
const PRESSURE_AT_YIELD: f64 = 1.6;
/// Contact radius over radius of a body from which on the theory of small contacts is poor.
const LARGEST_CONTACT: f64 = 0.2;

/// The elastic constants of a solid.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Elastic {
    /// Pa, > 0; infinite where it is rigid.
    pub modulus: f64,
    /// 0 to 0.5.
    pub poisson: f64,
    /// kg/m^3, > 0; NaN where it is not known.
    pub density: f64,
    /// In compression, Pa, > 0; none where it is not known.
    pub yield_stress: Option<f64>,
}

/// A solid sphere, or a half-space.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Solid {
    /// m, > 0; infinite for a flat.
    pub radius: f64,
    /// kg, > 0; infinite for a half-space.
    pub mass: f64,
    /// m/s; of a striker larger than that of the struck body.
    pub velocity: f64,
    /// What it is made of.
    pub elastic: Elastic,
}

impl Solid {
    /// The contact with another solid.
    pub fn contact(&self, other: &Self) -> Hertz {
        let side = |solid: &Self| (solid.elastic.modulus, solid.elastic.poisson);
        Hertz::new(1.0 / (1.0 / self.radius + 1.0 / other.radius), [side(self), side(other)])
    }
}

impl Elastic {
    /// Flat and fixed.
    pub fn half_space(self) -> Solid {
        Solid { radius: f64::INFINITY, mass: f64::INFINITY, velocity: 0.0, elastic: self }
    }
}

/// A warning that a contact under a largest force (N) yields, where the softer solid has this yield stress (Pa), with the ratio of its largest
/// pressure to that at first yield; none where it stays elastic.
pub fn contact_yields(contact: &Hertz, force: f64, limit: f64) -> Option<(f64, String)> {
    let pressure = pressure(contact, contact.approach(force));
    Some((pressure / (PRESSURE_AT_YIELD * limit), yields(pressure, limit)?))
}

/// A warning that a contact under a largest force (N) is not small beside the ball or a bar of this radius (m), with the ratio of its radius to
/// the largest that passes; none where it is.
pub fn contact_is_wide(contact: &Hertz, force: f64, bar: f64) -> Option<(f64, String)> {
    let radius = contact_radius(contact, contact.approach(force));
    let body = if bar < contact.radius { (bar, "the bar") } else { (contact.radius, "curvature") };
    Some((radius / (LARGEST_CONTACT * body.0), wide(radius, body)?))
}

fn wide(radius: f64, (body, what): (f64, &str)) -> Option<String> {
    (radius > LARGEST_CONTACT * body).then(|| {
        format!(
            "the contact radius is {:.2} of the radius of {what}; Hertz's theory needs a contact that is small compared with the bodies",
            radius / body
        )
    })
}

fn yields(pressure: f64, limit: f64) -> Option<String> {
    (pressure > PRESSURE_AT_YIELD * limit).then(|| {
        format!(
            "the contact yields: the largest pressure is {:.2} times the yield stress in compression of {:.1} MPa and yield begins at \
             {PRESSURE_AT_YIELD}; \
             the elastic solution overestimates the force and the rebound velocity",
            pressure / limit,
            limit / 1e6
        )
    })
}

/// Radius of the circle of contact at an approach, m.
pub(super) fn contact_radius(contact: &Hertz, approach: f64) -> f64 {
    (contact.radius * approach.max(0.0)).sqrt()
}

/// Largest pressure at an approach, Pa.
fn pressure(contact: &Hertz, approach: f64) -> f64 {
    2.0 * contact.modulus / PI * (approach.max(0.0) / contact.radius).sqrt()
}

/// Adds contact radius and pressure of the largest approach, and warns where the contact yields or is no longer small.
pub(super) fn judge(solution: &mut Solution, contact: &Hertz, solids: [&Elastic; 2], approach: f64) {
    let (radius, pressure) = (contact_radius(contact, approach), pressure(contact, approach));
    let figure = |name, dimension, long_name, value| Figure::new(name, dimension, long_name, value);
    solution.figures.extend([
        figure("contact_radius", Dimension::Length, "largest radius of the circle of contact", radius),
        figure("contact_area", Dimension::Area, "largest area of contact", PI * radius * radius),
        figure("contact_pressure", Dimension::Stress, "largest pressure in the contact", pressure),
    ]);
    let values = [(radius, Dimension::Length), (pressure, Dimension::Stress)];
    solution.lines.push(Line::new("contact", "radius up to {}, pressure up to {}", &values));
    solution.warnings.extend(wide(radius, (contact.radius, "curvature")));
    let Some(limit) = solids.iter().filter_map(|s| s.yield_stress).reduce(f64::min) else {
        return;
    };
    let ratio = pressure / (PRESSURE_AT_YIELD * limit);
    solution.warnings.extend(yields(pressure, limit));
    // The largest pressure goes with the power 1/5 of the energy of the impact.
    solution.figures.push(figure(
        "yield_ratio",
        Dimension::None,
        "ratio of the largest pressure to that at first yield",
        ratio,
    ));
}
