//! Striking and struck solids, and the limits of Hertz's theory of their contact.

use std::f64::consts::PI;

use super::ellipse::Ellipse;
use super::solution::{Figure, Line, Solution};
use crate::bar::Hertz;
use crate::units::Dimension;

/// Largest pressure of a Hertz contact at first yield over the yield stress: 1.60 for von Mises' criterion and a Poisson's ratio of 0.3 (K. L.
/// Johnson, Contact Mechanics (1985), section 6.2). It is larger for an ellipse, 1.64 at an axis ratio of 2 and 1.71 at 5, and 1.79 for a line
/// contact.
const PRESSURE_AT_YIELD: f64 = 1.6;
/// Contact radius over the radius of a body above which the theory of small contacts is inaccurate.
const LARGEST_CONTACT: f64 = 0.2;

/// The elastic constants of a solid.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Elastic {
    /// Young's modulus, Pa, > 0; infinite for a rigid body.
    pub modulus: f64,
    /// Poisson's ratio, 0 to 0.5.
    pub poisson: f64,
    /// Density, kg/m^3, > 0; NaN if unknown.
    pub density: f64,
    /// Yield stress in compression, Pa, > 0; `None` if unknown.
    pub yield_stress: Option<f64>,
}

/// A solid sphere, or a half-space.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Solid {
    /// Radius, m, > 0; infinite for a flat.
    pub radius: f64,
    /// Mass, kg, > 0; infinite for a half-space.
    pub mass: f64,
    /// Velocity, m/s; that of a striker is larger than that of the struck body.
    pub velocity: f64,
    /// Elastic constants.
    pub elastic: Elastic,
}

impl Solid {
    /// Returns the contact law with another solid.
    pub fn contact(&self, other: &Self) -> Hertz {
        Hertz::new(relative(self.radius, other.radius), [self.elastic.side(), other.elastic.side()])
    }

    /// Returns the contact of a sphere with the side of a cylinder of this radius, m; the longer axis is along the cylinder.
    pub fn contact_with_cylinder(&self, radius: f64, cylinder: &Elastic) -> Ellipse {
        Ellipse::new([self.radius, relative(self.radius, radius)], [self.elastic.side(), cylinder.side()])
    }
}

/// Returns the relative radius of curvature of two bodies.
fn relative(one: f64, other: f64) -> f64 {
    1.0 / (1.0 / one + 1.0 / other)
}

impl Elastic {
    /// Returns the modulus and Poisson's ratio.
    fn side(&self) -> (f64, f64) {
        (self.modulus, self.poisson)
    }

    /// Returns a fixed half-space of this material.
    pub fn half_space(self) -> Solid {
        Solid { radius: f64::INFINITY, mass: f64::INFINITY, velocity: 0.0, elastic: self }
    }
}

/// Returns a warning if a contact yields under its largest force (N), with the ratio of its largest pressure to that at first yield; `None` if it
/// stays elastic. `limit` is the yield stress of the softer solid, Pa.
pub fn contact_yields(contact: &Hertz, force: f64, limit: f64) -> Option<(f64, String)> {
    let pressure = Ellipse::circle(*contact).pressure(contact.approach(force));
    Some((pressure / (PRESSURE_AT_YIELD * limit), yields(pressure, limit)?))
}

/// Returns a warning if a contact under its largest force (N) is not small compared with the ball or a bar of radius `bar` (m), with the ratio of
/// its radius to the largest acceptable one; `None` if it is small.
pub fn contact_is_wide(contact: &Hertz, force: f64, bar: f64) -> Option<(f64, String)> {
    let radius = Ellipse::circle(*contact).mean_radius(contact.approach(force));
    let body =
        if bar < contact.radius { (bar, "the radius of the bar") } else { (contact.radius, "the radius of curvature") };
    Some((radius / (LARGEST_CONTACT * body.0), wide(("contact radius", radius), body)?))
}

/// Returns a warning if a contact is not small compared with the thickness of a plate, m.
pub(super) fn wide_for_plate(contact: &Ellipse, approach: f64, thickness: f64) -> Option<String> {
    wide(("contact radius", contact.mean_radius(approach)), (thickness, "the thickness of the plate"))
}

fn wide((name, size): (&str, f64), (body, what): (f64, &str)) -> Option<String> {
    (size > LARGEST_CONTACT * body).then(|| {
        format!(
            "the {name} is {:.2} of {what}; Hertz's theory needs a contact that is small compared with the bodies",
            size / body
        )
    })
}

/// Returns a warning if a contact is not small compared with the radii of curvature.
fn wide_for_curvature(contact: &Ellipse, approach: f64) -> Option<String> {
    // The short semi-axis is the larger one relative to its radius of curvature.
    let [_, across] = contact.semi_axes(approach);
    let name = if contact.is_circle() { "contact radius" } else { "semi-axis of the contact across the beam" };
    wide((name, across), (contact.radii[1], "the radius of curvature"))
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

/// Adds size and pressure of the contact at the largest approach, and warns if the contact yields or is not small.
pub(super) fn judge(solution: &mut Solution, contact: &Ellipse, solids: [&Elastic; 2], approach: f64) {
    let (radius, pressure) = (contact.mean_radius(approach), contact.pressure(approach));
    let figure = |name, dimension, long_name, value| Figure::new(name, dimension, long_name, value);
    let long_name = if contact.is_circle() {
        "largest radius of the circle of contact"
    } else {
        "radius of the circle with the largest area of the contact ellipse"
    };
    solution.figures.extend([
        figure("contact_radius", Dimension::Length, long_name, radius),
        figure("contact_area", Dimension::Area, "largest area of contact", PI * radius * radius),
        figure("contact_pressure", Dimension::Stress, "largest pressure in the contact", pressure),
    ]);
    add_size(solution, contact, approach);
    solution.warnings.extend(wide_for_curvature(contact, approach));
    let Some(limit) = solids.iter().filter_map(|s| s.yield_stress).reduce(f64::min) else {
        return;
    };
    let ratio = pressure / (PRESSURE_AT_YIELD * limit);
    solution.warnings.extend(yields(pressure, limit));
    // The largest pressure grows with the power 1/5 of the energy of the impact.
    solution.figures.push(figure(
        "yield_ratio",
        Dimension::None,
        "ratio of the largest pressure to that at first yield",
        ratio,
    ));
}

/// Adds the line of the summary, and the semi-axes of an ellipse.
fn add_size(solution: &mut Solution, contact: &Ellipse, approach: f64) {
    use Dimension::{Length, Stress};
    let ([along, across], pressure) = (contact.semi_axes(approach), (contact.pressure(approach), Stress));
    if contact.is_circle() {
        let values = [(along, Length), pressure];
        solution.lines.push(Line::new("contact", "radius up to {}, pressure up to {}", &values));
        return;
    }
    let text = "semi-axes up to {} along and {} across the beam, pressure up to {}";
    solution.lines.push(Line::new("contact", text, &[(along, Length), (across, Length), pressure]));
    solution.figures.extend([
        Figure::new(
            "contact_semi_axis_along",
            Length,
            "largest semi-axis of the contact ellipse along the beam",
            along,
        ),
        Figure::new(
            "contact_semi_axis_across",
            Length,
            "largest semi-axis of the contact ellipse across the beam",
            across,
        ),
    ]);
}
