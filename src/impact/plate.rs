//! Impact of a sphere on an infinite elastic plate: the coefficient of restitution of the handbook, and the integrated contact.

use std::f64::consts::PI;

use super::check::tolerance;
use super::contact::{Contact, Horizon, System};
use super::ellipse::Ellipse;
use super::oscillator::Oscillator;
use super::solid::{Elastic, Solid, judge, wide_for_plate};
use super::solution::{Figure, Line, Solution, Table, ratio};
use super::{Numerics, Problem, Watch};
use crate::bar::Hertz;
use crate::input::{Checked, positive};
use crate::units::Dimension::{self, Force, Length, None as Plain, Time, Velocity};

/// The coefficient of restitution tends to this factor times lambda^-5; by integration, the difference is below 0.1 % for lambda >= 3.
const REBOUND: f64 = 0.6793;
/// Coefficient of restitution below which a rebound is not noticeable.
const LEAST_REBOUND: f64 = 1e-6;
/// Disturbed radius over thickness below which thin-plate theory underestimates the radiated energy.
const LEAST_SPREAD: f64 = 3.0;
/// Disturbed radius over thickness below which thin-plate theory does not apply.
const NO_PLATE: f64 = 1.0;
/// Deflection over thickness above which linear bending theory is inaccurate.
const MOST_DEFLECTION: f64 = 0.5;

/// A sphere that strikes a plate at rest.
#[derive(Debug, Clone, PartialEq)]
pub struct Plate {
    /// Full thickness 2h, m, > 0.
    pub thickness: f64,
    /// Elastic constants of the plate: not rigid, and with a known density.
    pub elastic: Elastic,
    /// The sphere, with a velocity > 0.
    pub striker: Solid,
    /// Largest relative defect of Hertz's law between the nodes of a step, 1e-12 to 0.01.
    pub tolerance: f64,
    /// Latest end of the integration, s, > 0; `None`: 100 Hertz durations.
    pub until: Option<f64>,
}

/// Returns the handbook's coefficient of restitution, equation 9.13, with Hertz's contact time (9.14). `a2` is the squared radius of equation 9.8,
/// m^2. The result is negative if 0.56 m > h rho a^2.
pub fn handbook_restitution(mass: f64, half_thickness: f64, density: f64, a2: f64) -> f64 {
    let x = 0.56 * mass / (half_thickness * density * a2);
    (1.0 - x) / (1.0 + x)
}

/// Returns the squared radius of the disturbed region of a plate after a time, s, equation 9.8, m^2.
pub(super) fn disturbed(duration: f64, thickness: f64, elastic: &Elastic) -> f64 {
    let Elastic { modulus, poisson, density, .. } = elastic;
    PI * duration * 0.5 * thickness * (modulus / (3.0 * density * (1.0 - poisson.powi(2)))).sqrt()
}

impl Plate {
    /// Returns the ratio of the force to the velocity of the struck point, N s/m: 8 sqrt(D 2h rho) with the bending stiffness D. The velocity of
    /// the struck point is proportional to the force.
    pub fn impedance(&self) -> f64 {
        let bending = self.elastic.modulus * self.thickness.powi(3) / (12.0 * (1.0 - self.elastic.poisson.powi(2)));
        8.0 * (bending * self.thickness * self.elastic.density).sqrt()
    }

    /// Returns the contact law.
    pub fn contact(&self) -> Hertz {
        self.striker.contact(&self.elastic.half_space())
    }

    /// Returns Zener's inelasticity parameter lambda = m/(Z T) with T = (m^2/(k^2 v))^(1/5) and F = k a^(3/2).
    pub fn inelasticity(&self) -> f64 {
        let (mass, stiffness) = (self.striker.mass, self.contact().stiffness());
        let unit = (mass / stiffness).powf(0.4) * self.striker.velocity.powf(-0.2);
        mass / (self.impedance() * unit)
    }

    /// Returns the squared radius that the flexural wave has reached at the end of a contact, equation 9.8, m^2.
    fn spread(&self, duration: f64) -> f64 {
        disturbed(duration, self.thickness, &self.elastic)
    }

    fn latest(&self) -> f64 {
        self.until.unwrap_or_else(|| 100.0 * self.contact().contact_time(self.striker.mass, self.striker.velocity))
    }

    /// Returns the results that need no integration.
    fn closed_forms(&self) -> Solution {
        let contact = self.contact();
        let (mass, velocity) = (self.striker.mass, self.striker.velocity);
        let duration = contact.contact_time(mass, velocity);
        let a2 = self.spread(duration);
        let restitution = handbook_restitution(mass, 0.5 * self.thickness, self.elastic.density, a2);
        let lambda = self.inelasticity();
        let mut solution = Solution {
            scheme: "zener",
            equation: "contact integrated: a = z - w, m z'' = -F, w' = F/Z, Z = 8 sqrt(2 h rho D), F by Hertz (Zener 1941); \
                       for comparison, (9.13) with (9.8) and Hertz's contact time (9.14)"
                .into(),
            validity: "thin plate, no reflection from its edges during the contact, elastic contact; (9.13) is of first order \
                       in the \
                       inelasticity lambda and negative above lambda = 1.128"
                .into(),
            ..Solution::default()
        };
        solution.add("lambda", Figure::new("inelasticity", Plain, "inelasticity parameter lambda", lambda));
        solution.figures.extend([
            Figure::new("hertz_duration", Time, "Hertz's duration of the contact, (9.14)", duration),
            Figure::new(
                "spread_radius",
                Length,
                "radius of the disturbed region of the plate at the end of Hertz's contact, (9.8)",
                a2.sqrt(),
            ),
            Figure::new(
                "spread_area",
                Dimension::Area,
                "area of the disturbed region of the plate at the end of Hertz's contact",
                PI * a2,
            ),
        ]);
        let values = [(a2.sqrt(), Length), (duration, Time)];
        solution.lines.push(Line::new("disturbed radius", "{} after Hertz's contact time {} (9.8)", &values));
        solution.add(
            "e by (9.13)",
            Figure::new("handbook_restitution", Plain, "coefficient of restitution by (9.13)", restitution),
        );
        self.warn(&mut solution, restitution, a2.sqrt());
        solution
    }

    fn warn(&self, solution: &mut Solution, restitution: f64, spread: f64) {
        if restitution < 0.0 {
            let warning =
                "(9.13) is negative, because lambda exceeds 1.128; it does not give a coefficient of restitution";
            solution.warnings.push(warning.into());
        }
        solution.warnings.extend(short_waves(spread / self.thickness));
    }
}

/// Warns if the waves of the contact are not long compared with the thickness. The energy is that of a Mindlin plate under Hertz's pulse for a
/// Poisson's ratio of 0.3: 2.47, 1.74, 1.30 and 1.09 times that of the thin plate at a disturbed radius of 1.5, 2, 3 and 5.2 thicknesses.
fn short_waves(spread: f64) -> Option<String> {
    let energy = 1.0 + 2.4 * spread.powi(-2) + 1.5 * spread.powf(-3.5);
    let size = if spread < NO_PLATE {
        "thin-plate theory does not hold for so short a contact".into()
    } else {
        format!(
            "with shear deformation and rotary inertia, which thin-plate theory neglects, the plate takes about {energy:.1} times the energy"
        )
    };
    (spread < LEAST_SPREAD).then(|| format!("the disturbed radius is {} of the thickness: {size}", ratio(spread, 3)))
}

impl Plate {
    /// Returns the warning for a sphere that is still in contact at the end time with this fraction of its velocity.
    fn in_contact_at_end(&self, kept: f64) -> String {
        let lambda = self.inelasticity();
        let restitution = REBOUND * lambda.powi(-5);
        if restitution > LEAST_REBOUND {
            return "the sphere is still in contact at the end time; increase `until` to include the rebound".into();
        }
        format!(
            "the contact has not ended at the end time, when the sphere has {} of its velocity; the rebound is negligible, \
             with a coefficient of restitution of {restitution:.1e} at lambda = {lambda:.1}",
            ratio(kept, 3)
        )
    }

    /// Warns if the deflection is too large for linear bending theory, which neglects the stretching of the plate.
    fn bends_far(&self, deflection: f64) -> Option<String> {
        let ratio = deflection / self.thickness;
        (ratio > MOST_DEFLECTION).then(|| {
            format!(
                "the plate deflects by {ratio:.2} of its thickness during the contact: membrane forces, which linear bending \
                 theory neglects, are not small"
            )
        })
    }
}

fn contact_table() -> Table {
    Table::over_time(
        "contact",
        [
            ("force", Force, "contact force", "contact force"),
            ("approach", Length, "approach", "displacements"),
            ("deflection", Length, "deflection of the plate", "displacements"),
            ("contact_radius", Length, "radius of the circle of contact", "contact radius"),
            ("striker_velocity", Velocity, "velocity of the striker", "velocities"),
            ("plate_velocity", Velocity, "velocity of the struck point", "velocities"),
        ],
    )
}

fn ledger_table() -> Table {
    Table::ledger([
        ("kinetic", "kinetic energy of the striker"),
        ("contact", "elastic energy of the contact"),
        ("radiated", "energy radiated into the plate"),
    ])
}

impl Problem for Plate {
    fn kind(&self) -> &'static str {
        "plate"
    }

    fn check(&self) -> Checked {
        positive([("thickness", self.thickness, Length)])?;
        self.elastic.check_of_struck("elastic")?;
        self.striker.check_of_striker("striker", 0.0)?;
        tolerance(self.tolerance)?;
        self.until.map_or(Ok(()), |until| positive([("until", until, Time)]))
    }

    fn planned(&self) -> Solution {
        self.closed_forms()
    }

    fn solved(&self, watch: Watch<'_>) -> Solution {
        let (law, velocity) = (self.contact(), self.striker.velocity);
        let circle = Ellipse::circle(law);
        let mut solution = self.closed_forms();
        let striker = Oscillator { v: velocity, ..Oscillator::new(self.striker.mass, [0.0, 0.0], -1.0) };
        let system = System { modes: vec![striker], mobility: 1.0 / self.impedance(), ..System::default() };
        let (mut contact, mut ledger) = (contact_table(), ledger_table());
        let start = striker.energy();
        let latest = self.latest();
        let mut last = striker;
        let horizon =
            Horizon { least: 0.0, most: latest, tolerance: self.tolerance, doublings: Horizon::CONTACT_ALONE };
        let history = Contact::new(law, system).run(horizon, |moment| {
            last = moment.system.modes[0];
            let (approach, system) = (moment.approach, moment.system);
            let radius = circle.mean_radius(approach);
            let plate = moment.force * system.mobility;
            contact.push(&[moment.time, moment.force, approach, system.drift, radius, last.v, plate]);
            let (kinetic, stored) = (last.energy(), law.energy(approach));
            let residual = (kinetic + stored + system.radiated - start) / start;
            ledger.push(&[moment.time, kinetic, stored, system.radiated, residual]);
            watch(moment.time / latest)
        });
        if let Some(touch) = history.touches.first() {
            let restitution = if history.separated { -last.v / velocity } else { f64::NAN };
            solution.add(
                "e integrated",
                Figure::new("restitution", Plain, "coefficient of restitution, integrated", restitution),
            );
            solution.add("largest force", Figure::new("peak_force", Force, "largest contact force", touch.peak_force));
            solution.add(
                "contact time",
                Figure::new("contact_duration", Time, "duration of the contact", touch.duration()),
            );
            let long_name = "radius of the disturbed region of the plate at the end of the contact, (9.8)";
            let spread = self.spread(touch.duration()).sqrt();
            let line = Line::new("disturbed radius", "{} at the end of this contact (9.8)", &[(spread, Length)]);
            solution.lines.extend(spread.is_finite().then_some(line));
            solution.figures.push(Figure::new("contact_spread_radius", Length, long_name, spread));
            judge(&mut solution, &circle, [&self.striker.elastic, &self.elastic], touch.approach);
            solution.warnings.extend(wide_for_plate(&circle, touch.approach, self.thickness));
        }
        if !history.separated && !history.interrupted {
            solution.warnings.push(self.in_contact_at_end(last.v / velocity));
        }
        let deflection = contact.own("deflection").iter().fold(0.0, |most: f64, w| most.max(w.abs()));
        solution.warnings.extend(self.bends_far(deflection));
        let label = if history.separated { "striker after" } else { "striker at end" };
        let long_name = "velocity of the striker at the end";
        solution.add(label, Figure::new("striker_velocity", Velocity, long_name, last.v));
        super::account(&mut solution, &ledger, &history);
        solution.tables = vec![contact, ledger];
        solution
    }

    fn numerics(&self) -> Option<Numerics> {
        Some(Numerics { modes: None, tolerance: self.tolerance })
    }

    fn with(&self, numerics: Numerics) -> Box<dyn Problem> {
        Box::new(Self { tolerance: numerics.tolerance, ..self.clone() })
    }
}

#[cfg(test)]
mod tests {
    use std::ops::ControlFlow;

    use super::*;

    /// A plate with a given lambda: the sphere's mass and the contact are fixed, the thickness is chosen.
    fn plate(lambda: f64) -> Plate {
        let elastic = Elastic { modulus: 207e9, poisson: 0.3, density: 7850.0, yield_stress: None };
        let striker = Solid { radius: 0.005, mass: 0.0041, velocity: 0.5, elastic };
        let plate = Plate { thickness: 0.01, elastic, striker, tolerance: 1e-11, until: None };
        // Z grows with the square of the thickness.
        let thickness = 0.01 * (plate.inelasticity() / lambda).sqrt();
        Plate { thickness, ..plate }
    }

    #[test]
    fn zener_s_table_is_that_of_any_plate() {
        let mut rows = 0;
        for row in include_str!("zener_e_lambda.csv").lines().skip(1) {
            let row: Vec<f64> = row.split(',').map(|cell| cell.parse().expect("a number")).collect();
            let [lambda, dop853, time, rk4, handbook] = row[..] else { panic!("five columns") };
            rows += 1;
            // The row of lambda = 0 is the limit of thick plates, with four digits of the contact time.
            let plate = plate(lambda.max(1e-9));
            let solution = plate.solved(&mut |_| ControlFlow::Continue(()));
            let figure = |name| solution.figure(name).expect("a figure");
            let unit = (plate.striker.mass / plate.contact().stiffness()).powf(0.4) * plate.striker.velocity.powf(-0.2);
            let (duration, most) = (figure("contact_duration") / unit, if lambda > 0.0 { 1e-8 } else { 5e-4 });
            assert!((duration - time).abs() < most * time, "{lambda}: {duration} {time}");
            let e = figure("restitution");
            // The two columns of the table differ by up to 4.2e-10.
            let most = if lambda > 0.0 { 1e-10 } else { 2e-9 };
            assert!((e - rk4).abs() < most && (e - dop853).abs() < 5e-10_f64.max(most), "{lambda}: {e} {rk4}");
            // The column of (9.13) was made with 0.8863 lambda; 0.56 m/(h rho a^2) is 0.886255 lambda.
            assert!((figure("handbook_restitution") - handbook).abs() < 3e-5, "{lambda}");
            assert_eq!(handbook < 0.0, solution.warnings.iter().any(|w| w.contains("negative")), "{lambda}");
            assert!(figure("energy_residual").abs() < 1e-9, "{:e}", figure("energy_residual"));
        }
        assert_eq!(rows, 10);
    }
}
