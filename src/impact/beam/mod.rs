//! Impact of a sphere on a simply supported beam, with or without damping, an elastic foundation and an axial force.

mod approximation;
mod converge;
mod extremes;
mod observe;
mod shape;

use std::f64::consts::PI;

use super::check::tolerance;
use super::contact::{Horizon, System};
use super::ellipse::Ellipse;
use super::oscillator::Oscillator;
use super::solid::{Elastic, Solid};
use super::solution::{Figure, Line, Solution};
use super::{Numerics, Problem, Watch};
use crate::bar::Hertz;
use crate::error::InputError;
use crate::input::{Allowed, Checked, member, optional, positive, positive_or_infinite};
use crate::units::Dimension::{self, Area, Drag, Force, Length, None as Plain, SecondMomentOfArea, Time, Viscosity};
use crate::units::{self, System as Units};

/// A cross-section.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Section {
    /// Area, m^2, > 0.
    pub area: f64,
    /// Second moment of area, m^4, > 0.
    pub inertia: f64,
    /// Full depth in the direction of the impact, m, > 0.
    pub depth: f64,
    /// Surface that the sphere strikes.
    pub face: Face,
}

impl Section {
    /// Checks the section of a beam. The second moment of area is largest if half of the area is at each face.
    pub(crate) fn check(&self) -> Checked {
        let Self { area, inertia, depth, face } = *self;
        positive([("section.area", area, Area), ("section.depth", depth, Length)])?;
        positive([("section.inertia", inertia, SecondMomentOfArea)])?;
        if let Face::Flat { width } = face {
            positive_or_infinite("section.face.width", width, Length)?;
        }
        let most = 0.25 * area * depth * depth;
        if inertia <= most * (1.0 + ROUNDING) {
            return Ok(());
        }
        let [inertia, most] = [inertia, most].map(|value| units::format(value, SecondMomentOfArea, Units::Si));
        let message = format!("no section of this area and depth has a second moment of area of {inertia}");
        let error = InputError::new(message).key("section.inertia");
        Err(error
            .allowed(format!("inertia <= area*depth^2/4 = {most}"))
            .help("check the units of `area`, `inertia` and `depth`; a rectangle has a third of this"))
    }
}

/// Relative amount by which computed sections may exceed a limit.
const ROUNDING: f64 = 1e-9;

/// The struck face of a beam.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Face {
    /// A flat face.
    Flat {
        /// Width, m, > 0; infinite if unknown.
        width: f64,
    },
    /// The side of a cylinder, for a round section.
    Round,
}

/// Distributed damping and stiffness along the beam, and its axial force; 0 disables each.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Foundation {
    /// Internal damping c1, Pa s, >= 0.
    pub internal: f64,
    /// External damping c2, N s/m^2, >= 0.
    pub external: f64,
    /// Modulus k, N/m^2, >= 0.
    pub modulus: f64,
    /// Axial force, N, compression positive; below the buckling load.
    pub axial: f64,
}

/// A sphere that strikes a simply supported beam at rest.
#[derive(Debug, Clone, PartialEq)]
pub struct Beam {
    /// Length, m, > 0.
    pub length: f64,
    /// Cross-section.
    pub section: Section,
    /// Elastic constants of the beam: not rigid, and with a known density.
    pub elastic: Elastic,
    /// Damping, foundation, axial force.
    pub foundation: Foundation,
    /// The sphere, with a velocity > 0.
    pub striker: Solid,
    /// Point of impact, measured from the left support, m, inside the beam.
    pub at: f64,
    /// Gauges: name and distance from the left support, m, within the beam.
    pub gauges: Vec<(String, f64)>,
    /// Number of deflected shapes, evenly spaced in time, 0 to [`Beam::MOST_SHAPES`].
    pub shapes: usize,
    /// End time, s, > 0; `None`: when the sphere has left for good, but at least one period of the lowest mode.
    pub until: Option<f64>,
    /// Largest relative change of the results when the number of modes is doubled and the step tolerance is divided by 4, 1e-12 to 0.01; it
    /// determines the number of modes.
    pub tolerance: f64,
    /// Number of modes, 1 to [`Beam::MOST_MODES`]; `None`: determined by the tolerance.
    pub modes: Option<usize>,
}

/// Earliest and latest end of a run without an end time: the larger of these multiples of the period of the lowest mode and of the Hertz contact
/// time.
const PERIODS: [f64; 2] = [1.0, 50.0];
const CONTACT_TIMES: [f64; 2] = [1.5, 100.0];

/// Returns the smallest axial force at which a mode has no stiffness, N: the minimum over n of E I (n pi/l)^2 + k/(n pi/l)^2.
pub(crate) fn buckling(length: f64, bending: f64, modulus: f64) -> f64 {
    let load = |n: f64| {
        let k2 = (n * PI / length).powi(2);
        bending * k2 + modulus / k2
    };
    // The optimum wave number is the fourth root of modulus/bending; one of the two neighbouring integers n gives the minimum.
    let best = ((modulus / bending).powf(0.25) * length / PI).floor().max(1.0);
    load(best).min(load(best + 1.0))
}

impl Beam {
    /// Largest number of modes that can be requested.
    pub const MOST_MODES: usize = 10_000;
    /// Largest number of deflected shapes that can be requested.
    pub const MOST_SHAPES: usize = 1000;

    /// Returns half the mass of the beam, which is the modal mass of every mode, kg.
    pub fn modal_mass(&self) -> f64 {
        0.5 * self.elastic.density * self.section.area * self.length
    }

    /// Returns the wave number of mode n, 1/m.
    fn wave_number(&self, n: usize) -> f64 {
        n as f64 * PI / self.length
    }

    /// Returns the bending stiffness E I, N m^2.
    fn bending(&self) -> f64 {
        self.elastic.modulus * self.section.inertia
    }

    /// Returns the undamped angular frequency (rad/s) and the damping number (1/s) of mode n, (9.24), with the axial force.
    pub fn frequency(&self, n: usize) -> [f64; 2] {
        let (k2, line) = (self.wave_number(n).powi(2), self.elastic.density * self.section.area);
        let stiffness = self.bending() * k2 * k2 - self.foundation.axial * k2 + self.foundation.modulus;
        let damping = self.foundation.internal * self.section.inertia * k2 * k2 + self.foundation.external;
        [(stiffness / line).sqrt(), 0.5 * damping / line]
    }

    /// Returns the shape of mode n at x. It is computed from the distance to the nearer support, so that rounding is small compared with the shape.
    fn shape(&self, n: usize, x: f64) -> f64 {
        let right = x > 0.5 * self.length;
        let near = if right { self.length - x } else { x };
        // Antisymmetric modes are exactly zero under a central impact.
        let place = n as f64 * near / self.length;
        let shape = if place.fract() == 0.0 { 0.0 } else { (PI * (place % 2.0)).sin() };
        if right && n.is_multiple_of(2) { -shape } else { shape }
    }

    /// Returns modes 1 to `count`, at rest.
    fn oscillators(&self, count: usize) -> impl Iterator<Item = Oscillator> + '_ {
        let mass = self.modal_mass();
        (1..=count).map(move |n| Oscillator::new(mass, self.frequency(n), self.shape(n, self.at)))
    }

    /// Returns modes 1 to `count` and, with internal damping, one more oscillator that represents all higher modes: it has their static compliance
    /// and the frequency and damping of the lowest of them. Overdamped modes creep at the rate E/c1 regardless of their number, so that one
    /// oscillator represents them all. Without internal damping the higher modes follow the force without delay.
    fn bending_modes(&self, count: usize) -> impl Iterator<Item = Oscillator> + '_ {
        let above = (self.foundation.internal > 0.0).then(|| {
            let [omega, delta] = self.frequency(count + 1);
            Oscillator::new(1.0 / (self.tail(count, self.at)[0] * omega * omega), [omega, delta], 1.0)
        });
        self.oscillators(count).chain(above)
    }

    /// Returns the contact law.
    pub fn contact(&self) -> Hertz {
        self.area_of_contact().law
    }

    /// Returns the contact law with the area of contact: on a round beam an ellipse with the longer axis along the beam.
    pub fn area_of_contact(&self) -> Ellipse {
        match self.section.face {
            Face::Flat { .. } => Ellipse::circle(self.striker.contact(&self.elastic.half_space())),
            Face::Round => self.striker.contact_with_cylinder(0.5 * self.section.depth, &self.elastic),
        }
    }

    /// Returns the striker and the beam with this number of modes.
    fn system(&self, count: usize) -> System {
        let striker = Oscillator { v: self.striker.velocity, ..Oscillator::new(self.striker.mass, [0.0, 0.0], -1.0) };
        let modes = std::iter::once(striker).chain(self.bending_modes(count)).collect();
        let compliance = if self.foundation.internal > 0.0 { 0.0 } else { self.tail(count, self.at)[0] };
        System { modes, compliance, ..System::default() }
    }

    /// Returns the period of the lowest mode, s.
    fn period(&self) -> f64 {
        2.0 * PI / self.frequency(1)[0]
    }

    /// Returns Hertz's contact time, s, for a sphere and a beam that does not move.
    fn contact_time(&self) -> f64 {
        self.contact().contact_time(self.striker.mass, self.striker.velocity)
    }

    /// Returns the earliest and the latest end of the run, s.
    fn ends(&self) -> [f64; 2] {
        let (period, contact) = (self.period(), self.contact_time());
        let free = || [0, 1].map(|i| (PERIODS[i] * period).max(CONTACT_TIMES[i] * contact));
        self.until.map_or_else(free, |until| [until, until])
    }
}

impl Beam {
    /// Returns the approximate number of time steps of one integration up to its earliest end: those of free flight.
    pub fn expected_steps(&self) -> f64 {
        self.finest_steps().min(Horizon::ROWS)
    }

    /// Returns the number of finest steps up to the earliest end: between samples the readings at gauges are searched for extremes.
    pub fn finest_steps(&self) -> f64 {
        self.ends()[0] / self.finest()
    }

    /// Returns the finest step of free flight, s.
    fn finest(&self) -> f64 {
        self.contact_time() / Horizon::COARSEST
    }

    /// Returns the approximate size of the histories, bytes.
    pub fn expected_bytes(&self) -> f64 {
        self.expected_steps() * 8.0 * observe::columns(self.gauges.len()) as f64
    }
}

impl Problem for Beam {
    fn kind(&self) -> &'static str {
        "beam"
    }

    fn check(&self) -> Checked {
        positive([("length", self.length, Length)])?;
        self.section.check()?;
        self.elastic.check_of_struck("elastic")?;
        self.striker.check_of_striker("striker", 0.0)?;
        let Foundation { internal, external, modulus, axial } = self.foundation;
        member("foundation.internal", internal, Viscosity, Allowed::NotNegative)?;
        member("foundation.external", external, Drag, Allowed::NotNegative)?;
        member("foundation.modulus", modulus, Dimension::Foundation, Allowed::NotNegative)?;
        let most = buckling(self.length, self.bending(), modulus);
        member("foundation.axial", axial, Force, Allowed::Between(f64::NEG_INFINITY, most))?;
        member("at", self.at, Length, Allowed::Between(0.0, self.length))?;
        let within = |(name, x): &(String, f64)| {
            member(&format!("gauges.{name}"), *x, Length, Allowed::Within(0.0, self.length))
        };
        self.gauges.iter().try_for_each(within)?;
        tolerance(self.tolerance)?;
        self.until.map_or(Ok(()), |until| positive([("until", until, Time)]))?;
        member("shapes", self.shapes as f64, Plain, Allowed::Within(0.0, Self::MOST_SHAPES as f64))?;
        optional("modes", self.modes.map(|modes| modes as f64), Plain, Allowed::Within(1.0, Self::MOST_MODES as f64))
    }

    fn planned(&self) -> Solution {
        let mut solution = self.approximation();
        let modes = match self.modes {
            Some(modes) => format!("{modes}"),
            None => {
                format!("{}, doubled until the results change by less than {:e}", converge::FIRST_MODES, self.tolerance)
            }
        };
        solution.lines.push(Line::new("modes", modes, &[]));
        let steps =
            format!("about {:.0} per integration, up to {{}} or the last contact", self.expected_steps().ceil());
        solution.lines.push(Line::new("steps", steps, &[(self.ends()[0], Time)]));
        let mebibytes = self.expected_bytes() / f64::from(1 << 20);
        solution.lines.push(Line::new("histories", format!("about {mebibytes:.1} MiB"), &[]));
        solution.figures.extend([
            Figure::count(
                "expected_steps",
                "approximate time steps per integration",
                self.expected_steps().ceil() as usize,
            ),
            Figure::new("expected_bytes", Plain, "approximate size of the histories in bytes", self.expected_bytes()),
        ]);
        solution
    }

    fn solved(&self, watch: Watch<'_>) -> Solution {
        self.converge(watch)
    }

    fn numerics(&self) -> Option<Numerics> {
        Some(Numerics { modes: self.modes, tolerance: self.tolerance })
    }

    fn with(&self, numerics: Numerics) -> Box<dyn Problem> {
        let Numerics { modes, tolerance } = numerics;
        Box::new(Self { modes, tolerance, gauges: Vec::new(), shapes: 0, ..self.clone() })
    }
}
