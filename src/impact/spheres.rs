//! Collision of two spheres along the line of their centres: coefficient of restitution, ballistic pendulum, Hertz's theory.

use std::f64::consts::PI;
use std::ops::ControlFlow;

use super::check::{self, meet};
use super::contact::{Contact, Horizon, System};
use super::ellipse::Ellipse;
use super::oscillator::Oscillator;
use super::solid::{Elastic, Solid, judge};
use super::solution::{Figure, Line, Solution, Table};
use super::{Numerics, Problem, Watch};
use crate::bar::Hertz;
use crate::input::{Allowed, Checked, member, positive, positive_or_infinite};
use crate::units::Dimension::{self, Energy, Force, Length, Mass, None as Plain, Time, Velocity};

/// Share of the energy in vibration of the spheres, or in waves, above which Hertz's theory is inaccurate.
const MOST_VIBRATION: f64 = 0.01;
/// Integral of s sqrt(1 - s^(5/2)) from 0 to 1: 2/5 B(4/5, 3/2).
const PULSE: f64 = 0.353_736_587;

/// An impact of two spheres.
#[derive(Debug, Clone, PartialEq)]
pub enum Spheres {
    /// Newton's law, equations 9.1 to 9.3. Masses, kg, and velocities before the impact, m/s, of striker and struck body.
    Restitution {
        /// Masses, kg, > 0; the second is infinite for a half-space.
        masses: [f64; 2],
        /// Velocities, m/s, the first larger than the second.
        velocities: [f64; 2],
        /// Coefficient of restitution, 0 to 1.
        restitution: f64,
    },
    /// A body that embeds in another at rest, equation 9.4.
    Pendulum {
        /// Masses, kg, > 0.
        masses: [f64; 2],
        /// Common velocity after the impact, m/s, > 0.
        after: f64,
    },
    /// Hertz's theory.
    Hertz {
        /// Striker and struck body; the striker is the faster one, and at least one of them is not rigid.
        solids: [Solid; 2],
        /// Largest relative defect of Hertz's law between the nodes of a step, 1e-12 to 0.01.
        tolerance: f64,
    },
}

/// Returns the velocities after an impact, equation 9.3, m/s; the second mass may be infinite.
pub fn velocities_after(masses: [f64; 2], velocities: [f64; 2], restitution: f64) -> [f64; 2] {
    let ([mu, mx], [u, x]) = (masses, velocities);
    let (momentum, closing) = (mu * u + mx * x, restitution * (u - x));
    if mx.is_infinite() {
        return [x - closing, x];
    }
    [(momentum - mx * closing) / (mu + mx), (momentum + mu * closing) / (mu + mx)]
}

/// Returns the velocity of a body before it embeds in another at rest, equation 9.4, m/s.
pub fn velocity_before(masses: [f64; 2], after: f64) -> f64 {
    (masses[0] + masses[1]) * after / masses[0]
}

/// Returns the kinetic energy lost in an impact at this closing velocity, m/s, in J. It is computed from the relative motion, because the
/// difference of the kinetic energies before and after would cancel.
fn energy_lost(masses: [f64; 2], closing: f64, restitution: f64) -> f64 {
    0.5 * reduced(masses) * closing * closing * (1.0 - restitution) * (1.0 + restitution)
}

impl Problem for Spheres {
    fn kind(&self) -> &'static str {
        "spheres"
    }

    fn check(&self) -> Checked {
        match self {
            Self::Restitution { masses, velocities: [striker, struck], restitution } => {
                positive([("masses.0", masses[0], Mass)])?;
                positive_or_infinite("masses.1", masses[1], Mass)?;
                member("restitution", *restitution, Plain, Allowed::Within(0.0, 1.0))?;
                meet("velocities.0", *striker, *struck)
            }
            Self::Pendulum { masses: [striker, struck], after } => {
                positive([("masses.0", *striker, Mass), ("masses.1", *struck, Mass)])?;
                meet("after", *after, 0.0)
            }
            Self::Hertz { solids: [striker, struck], tolerance } => {
                struck.check("solids.1")?;
                striker.check_of_striker("solids.0", struck.velocity)?;
                if [striker, struck].iter().all(|solid| solid.elastic.modulus.is_infinite()) {
                    positive([("solids.1.elastic.modulus", struck.elastic.modulus, Dimension::Stress)])?;
                }
                check::tolerance(*tolerance)
            }
        }
    }

    fn solved(&self, watch: Watch<'_>) -> Solution {
        match self {
            Self::Restitution { masses, velocities, restitution } => by_restitution(*masses, *velocities, *restitution),
            Self::Pendulum { masses, after } => pendulum(*masses, *after),
            Self::Hertz { solids, tolerance } => hertz(solids, *tolerance, watch),
        }
    }

    fn planned(&self) -> Solution {
        match self {
            Self::Hertz { solids, .. } => closed_forms(solids),
            // These methods need no integration.
            closed => closed.solved(&mut |_| ControlFlow::Continue(())),
        }
    }

    fn numerics(&self) -> Option<Numerics> {
        let Self::Hertz { tolerance, .. } = self else { return None };
        Some(Numerics { modes: None, tolerance: *tolerance })
    }

    fn with(&self, numerics: Numerics) -> Box<dyn Problem> {
        let mut other = self.clone();
        if let Self::Hertz { tolerance, .. } = &mut other {
            *tolerance = numerics.tolerance;
        }
        Box::new(other)
    }
}

const STRIKER_AFTER: &str = "velocity of the striker after the impact";
const STRUCK_AFTER: &str = "velocity of the struck body after the impact";

fn by_restitution(masses: [f64; 2], velocities: [f64; 2], restitution: f64) -> Solution {
    let after = velocities_after(masses, velocities, restitution);
    let lost = energy_lost(masses, velocities[0] - velocities[1], restitution);
    let mut solution = Solution {
        scheme: "restitution",
        equation: "(9.1) to (9.3): Newton's law of restitution and the conservation of momentum".into(),
        validity: "any two bodies in direct central impact whose coefficient of restitution is known".into(),
        ..Solution::default()
    };
    solution.add("striker after", Figure::new("striker_velocity", Velocity, STRIKER_AFTER, after[0]));
    solution.add("struck after", Figure::new("struck_velocity", Velocity, STRUCK_AFTER, after[1]));
    solution.add("energy lost", Figure::new("energy_lost", Energy, "kinetic energy lost in the impact", lost));
    solution.figures.push(Figure::new("restitution", Plain, "coefficient of restitution", restitution));
    solution
}

fn pendulum(masses: [f64; 2], after: f64) -> Solution {
    let before = velocity_before(masses, after);
    let lost = energy_lost(masses, before, 0.0);
    let mut solution = Solution {
        scheme: "pendulum",
        equation: "(9.4): conservation of momentum of a body that embeds in another at rest".into(),
        validity: "the pendulum does not move while the body embeds in it".into(),
        ..Solution::default()
    };
    let long_name = "velocity of the striker before the impact";
    solution.add("striker before", Figure::new("striker_velocity_before", Velocity, long_name, before));
    solution.add("energy lost", Figure::new("energy_lost", Energy, "kinetic energy lost in the impact", lost));
    solution.figures.push(Figure::new("striker_velocity", Velocity, STRIKER_AFTER, after));
    solution.figures.push(Figure::new("struck_velocity", Velocity, STRUCK_AFTER, after));
    solution
}

/// Returns the reduced mass, kg; either mass may be infinite.
fn reduced(masses: [f64; 2]) -> f64 {
    1.0 / masses.map(f64::recip).iter().sum::<f64>()
}

/// Returns the results that need no integration.
fn closed_forms(solids: &[Solid; 2]) -> Solution {
    let contact = solids[0].contact(&solids[1]);
    let (mass, closing) = (reduced([solids[0].mass, solids[1].mass]), solids[0].velocity - solids[1].velocity);
    let approach = contact.largest_approach(mass, closing);
    let mut solution = theory(solids[1].mass.is_infinite());
    solution.lines.push(Line::new("closing velocity", "{}, reduced mass {}", &[(closing, Velocity), (mass, Mass)]));
    let long_name = "velocity of the striker relative to the struck body before the impact";
    solution.figures.push(Figure::new("closing_velocity", Velocity, long_name, closing));
    solution.figures.push(Figure::new("reduced_mass", Mass, "reduced mass of both bodies", mass));
    solution.add("largest approach", Figure::new("approach", Length, "largest approach of the centres", approach));
    solution.add("largest force", Figure::new("peak_force", Force, "largest contact force", contact.force(approach)));
    let duration = contact.contact_time(mass, closing);
    solution.add("contact time", Figure::new("contact_duration", Time, "duration of the contact", duration));
    judge(&mut solution, &Ellipse::circle(contact), [&solids[0].elastic, &solids[1].elastic], approach);
    if solids[1].mass.is_infinite() {
        radiation(&mut solution, solids, &contact);
    } else {
        vibration(&mut solution, solids, closing);
    }
    solution
}

/// Returns the equations and their range of validity.
fn theory(half_space: bool) -> Solution {
    let hertz = "Hertz's theory: F = 4/3 E* sqrt(R) a^(3/2), contact time 2.9433 a/v";
    let [loss, validity] = if half_space {
        [
            "the energy of waves in the half-space by Lamb's problem for slow forces (Hunter 1957)",
            "elastic sphere on an elastic half-space, contact small compared with the sphere, little energy in waves",
        ]
    } else {
        [
            "(9.5) for the vibration of the spheres",
            "elastic spheres, contact small compared with the spheres, contact time long compared with their lowest \
             period: little energy in vibration by (9.5)",
        ]
    };
    Solution { scheme: "hertz", equation: format!("{hertz}; {loss}"), validity: validity.into(), ..Solution::default() }
}

/// Adds the energy that waves carry into the half-space, relative to the kinetic energy: J/(2 pi G c2) times the integral of F'^2 over time for
/// Hertz's force. J, from Lamb's problem at low frequency (Miller and Pursey 1954), depends on Poisson's ratio only; the polynomial is within 1 %
/// of it. For two equal solids the ratio is 1.09 to 1.16 (v/c0)^(3/5), where Hunter (1957) has 1.04.
fn radiation(solution: &mut Solution, [sphere, ground]: &[Solid; 2], contact: &Hertz) {
    let Elastic { modulus, poisson, density, .. } = ground.elastic;
    if !(modulus.is_finite() && density.is_finite()) {
        return;
    }
    let closing = sphere.velocity - ground.velocity;
    let approach = contact.largest_approach(sphere.mass, closing);
    let force = contact.force(approach);
    let shear = 0.5 * modulus / (1.0 + poisson);
    let lamb = 1.348 - poisson * (1.946 - 1.1 * poisson);
    let radiated =
        lamb / (2.0 * PI * shear * (shear / density).sqrt()) * 4.5 * PULSE * force * force * closing / approach;
    let part = radiated / (0.5 * sphere.mass * closing * closing);
    let share = if part < 1.0 { part } else { f64::NAN };
    let long_name = "energy of waves in the half-space over kinetic energy, at small loss";
    solution.add("waves", Figure::new("radiated_ratio", Plain, long_name, share));
    if part > MOST_VIBRATION {
        let size = if part < 0.5 {
            format!("about {:.1} % of the energy leaves", 100.0 * part)
        } else {
            "a large part of the energy leaves".into()
        };
        solution.warnings.push(format!(
            "{size} in waves in the half-space, which Hertz's theory neglects: the sphere rebounds with less than the velocity given here"
        ));
    }
}

/// Adds the energy of vibration by equation 9.5, with the slower of the known wave speeds.
fn vibration(solution: &mut Solution, solids: &[Solid; 2], closing: f64) {
    let speeds = solids.iter().filter(|s| s.mass.is_finite()).map(|s| (s.elastic.modulus / s.elastic.density).sqrt());
    let Some(speed) = speeds.filter(|c| c.is_finite()).reduce(f64::min) else { return };
    let ratio = closing / speed / 50.0;
    let share = if ratio < 1.0 { ratio } else { f64::NAN };
    solution.add(
        "vibration",
        Figure::new("vibration_ratio", Plain, "energy of vibration over kinetic energy, (9.5)", share),
    );
    if ratio >= 1.0 {
        let warning = "the energy of vibration by (9.5) exceeds the kinetic energy: the estimate is outside its range, and so is \
                       Hertz's theory, which neglects vibration";
        solution.warnings.push(warning.into());
    } else if ratio > MOST_VIBRATION {
        let percent = 100.0 * ratio;
        solution.warnings.push(format!(
            "{percent:.1} % of the energy goes into vibration of the spheres by (9.5), which Hertz's theory neglects"
        ));
    }
}

fn table() -> Table {
    Table::over_time(
        "contact",
        [
            ("force", Force, "contact force", "contact force"),
            ("approach", Length, "approach of the centres", "approach"),
            ("contact_radius", Length, "radius of the circle of contact", "contact radius"),
            ("striker_velocity", Velocity, "velocity of the striker", "velocities"),
            ("struck_velocity", Velocity, "velocity of the struck body", "velocities"),
        ],
    )
}

fn ledger() -> Table {
    Table::ledger([("kinetic", "kinetic energy of both bodies"), ("contact", "elastic energy of the contact")])
}

fn hertz(solids: &[Solid; 2], tolerance: f64, watch: Watch<'_>) -> Solution {
    let mut solution = closed_forms(solids);
    let law = solids[0].contact(&solids[1]);
    let shapes = [-1.0, 1.0];
    let body = |(solid, shape): (&Solid, f64)| Oscillator {
        v: solid.velocity,
        ..Oscillator::new(solid.mass, [0.0, 0.0], shape)
    };
    let modes = solids.iter().zip(shapes).filter(|(s, _)| s.mass.is_finite()).map(body).collect();
    let duration = solution.figure("contact_duration").unwrap_or(f64::NAN);
    let (mut contact, mut ledger) = (table(), ledger());
    let circle = Ellipse::circle(law);
    let mut start = None;
    let horizon = Horizon { least: 0.0, most: 10.0 * duration, tolerance, doublings: Horizon::CONTACT_ALONE };
    let system = System { modes, ..System::default() };
    let history = Contact::new(law, system).run(horizon, |moment| {
        let velocity = |i: usize| moment.system.modes.get(i).map_or(0.0, |m| m.v);
        let radius = circle.mean_radius(moment.approach);
        contact.push(&[moment.time, moment.force, moment.approach, radius, velocity(0), velocity(1)]);
        let kinetic: f64 = moment.system.modes.iter().map(Oscillator::energy).sum();
        let stored = law.energy(moment.approach);
        let first = *start.get_or_insert(kinetic);
        ledger.push(&[moment.time, kinetic, stored, (kinetic + stored - first) / first]);
        watch(moment.time / duration)
    });
    let last = |name| contact.own(name).last().copied().filter(|_| history.separated).unwrap_or(f64::NAN);
    let after = ["striker_velocity", "struck_velocity"].map(last);
    solution.add("striker after", Figure::new("striker_velocity", Velocity, STRIKER_AFTER, after[0]));
    solution.add("struck after", Figure::new("struck_velocity", Velocity, STRUCK_AFTER, after[1]));
    let impulse = history.touches.iter().map(|t| t.impulse).sum();
    solution.add("impulse", Figure::new("impulse", Dimension::Impulse, "impulse of the contact force", impulse));
    super::account(&mut solution, &ledger, &history);
    solution.tables = vec![contact, ledger];
    solution
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_textbook_s_spheres_and_pendulum() {
        let after = velocities_after([2.0, 3.0], [5.0, -1.0], 0.6);
        assert!((after[0] + 0.76).abs() < 1e-15 && (after[1] - 2.84).abs() < 1e-15, "{after:?}");
        assert!((velocity_before([0.01, 2.0], 1.5) - 301.5).abs() < 1e-12);
    }

    #[test]
    fn the_energy_lost_does_not_cancel() {
        // As small beside the kinetic energy as 1e-16 of it: by the relative motion, in exact arithmetic.
        for (masses, velocities, restitution, exact) in [
            ([1e6, 1e-6], [1.0, 0.0], 0.5, 3.75e-7 / (1.0 + 1e-12)),
            ([1e6, 1e-9], [1.0, 0.0], 1.0, 0.0),
            ([2.0, 3.0], [1000.0 + 0.5_f64.powi(10), 1000.0], 0.5, 0.5 * 1.2 * 0.75 * 0.5_f64.powi(20)),
        ] {
            let lost = by_restitution(masses, velocities, restitution).figure("energy_lost").expect("a figure");
            assert!((lost - exact).abs() <= 1e-14 * exact, "{masses:?}: {lost} {exact}");
        }
        // 1 mg that is at rest takes m v^2/2 of a ton.
        let lost = pendulum([1e3, 1e-6], 1.0 / (1.0 + 1e-9)).figure("energy_lost").expect("a figure");
        assert!((lost / (0.5e-6 / (1.0 + 1e-9)) - 1.0).abs() < 1e-14, "{lost}");
    }
}
