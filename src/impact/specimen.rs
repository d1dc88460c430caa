//! The energy method: a specimen in tension fractures if the kinetic energy of the striker reaches the energy that it absorbs to fracture.
//!
//! The method neglects how the stress builds up, and that a fast striker can strain the end of the specimen faster than waves carry the strain
//! away: above the critical velocity a bar breaks with less energy. A simulation of the bar itself (`[bar]`) includes both.

use super::solution::{Figure, Line, Solution};
use super::{Numerics, Problem, Watch};
use crate::input::{Allowed, Checked, member, positive, positive_or_infinite};
use crate::material::{Curve, Ultimate};
use crate::units::Dimension::{Area, Energy, EnergyDensity, Length, Mass, None as Plain, Velocity};
use crate::units::{System, format};

/// A specimen in tension.
#[derive(Debug, Clone)]
pub struct Specimen {
    /// Length, m, > 0.
    pub length: f64,
    /// Cross-sectional area, m^2, > 0.
    pub area: f64,
    /// Energy that it can absorb.
    pub toughness: Toughness,
}

/// The energy that a specimen absorbs before it breaks.
#[derive(Debug, Clone)]
pub enum Toughness {
    /// Energy per volume in the whole specimen, J/m^3, > 0.
    PerVolume(f64),
    /// Work under a stress-strain curve up to its largest engineering stress, or to the end of data that end in rupture. At a notch or a poor weld
    /// the specimen breaks at the force of the largest stress divided by `notch` (>= 1); the rest is strained only as far as that force requires,
    /// and the energy absorbed by the short notch itself is neglected.
    Curve {
        /// Curve in tension.
        curve: Curve,
        /// Point of rupture.
        ultimate: Ultimate,
        /// Notch factor, >= 1; 1 for no notch.
        notch: f64,
        /// Strain at the elastic limit, >= 0.
        elastic: f64,
        /// Impact velocity above which a bar of this curve breaks at its struck end, m/s, > 0; infinite if there is none.
        critical: f64,
    },
}

/// A moving body and the specimen that has to stop it.
#[derive(Debug, Clone)]
pub struct Blow {
    /// The specimen.
    pub specimen: Specimen,
    /// Mass of the body, kg, > 0.
    pub mass: f64,
    /// Velocity of the body, m/s, >= 0.
    pub velocity: f64,
}

/// Result of a blow. Energies in J.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Outcome {
    /// Kinetic energy of the body.
    pub available: f64,
    /// Energy that the specimen can absorb.
    pub capacity: f64,
    /// Whether the specimen breaks.
    pub breaks: bool,
    /// Energy that the specimen has absorbed at the end.
    pub absorbed: f64,
    /// Whether the specimen stays elastic and returns all energy that it has absorbed.
    pub elastic: bool,
    /// Final velocity of the body, m/s: 0 if the specimen yields and stops it, negative if an elastic specimen throws it back.
    pub residual_velocity: f64,
    /// Lowest velocity of this body that breaks the specimen, m/s.
    pub threshold_velocity: f64,
    /// Largest uniform engineering strain of the specimen; `None` if no curve is given.
    pub strain: Option<f64>,
}

impl Specimen {
    /// Returns the volume, m^3.
    pub fn volume(&self) -> f64 {
        self.length * self.area
    }

    /// Returns the energy per volume that it can absorb, J/m^3.
    pub fn energy_per_volume(&self) -> f64 {
        match &self.toughness {
            Toughness::PerVolume(energy) => *energy,
            Toughness::Curve { curve, ultimate, notch, .. } => work(curve, break_strain(curve, *ultimate, *notch)),
        }
    }

    /// Returns the energy that it can absorb, J.
    pub fn capacity(&self) -> f64 {
        self.energy_per_volume() * self.volume()
    }
}

impl Blow {
    /// Computes the result of the blow.
    pub fn outcome(&self) -> Outcome {
        let (available, capacity) = (0.5 * self.mass * self.velocity * self.velocity, self.specimen.capacity());
        let (absorbed, breaks) = (available.min(capacity), available >= capacity);
        let (strain, limit) = match &self.specimen.toughness {
            Toughness::PerVolume(_) => (None, 0.0),
            Toughness::Curve { curve, ultimate, notch, elastic, .. } => {
                let most = break_strain(curve, *ultimate, *notch);
                (Some(strain_of(curve, absorbed / self.specimen.volume(), most)), *elastic)
            }
        };
        let elastic = !breaks && strain.is_some_and(|strain| strain > 0.0 && strain <= limit);
        let kept = (2.0 * (available - absorbed) / self.mass).sqrt();
        Outcome {
            available,
            capacity,
            breaks,
            absorbed,
            elastic,
            residual_velocity: if elastic { -self.velocity } else { kept },
            threshold_velocity: (2.0 * capacity / self.mass).sqrt(),
            strain,
        }
    }

    /// Returns the velocity above which a bar of the specimen's material breaks at once, m/s; `None` if no curve is given.
    fn critical_velocity(&self) -> Option<f64> {
        let Toughness::Curve { critical, .. } = self.specimen.toughness else { return None };
        Some(critical)
    }

    fn warnings(&self, outcome: &Outcome) -> Vec<String> {
        let mut warnings = Vec::new();
        if outcome.elastic {
            warnings.push(
                "by the energy balance the specimen stays elastic: it gives the energy back, and the striker rebounds"
                    .into(),
            );
        }
        let Some(critical) = self.critical_velocity() else { return warnings };
        let shown = format(critical, Velocity, System::Si);
        let too_fast = self.velocity > critical;
        if outcome.threshold_velocity > critical {
            let also = if too_fast { "; the impact velocity exceeds it, too" } else { "" };
            warnings.push(std::format!(
                "the threshold is above the critical velocity of the material, {shown}, from which on a bar breaks at its \
                 struck end whatever the energy{also}"
            ));
        } else if too_fast {
            warnings.push(std::format!(
                "the impact velocity exceeds the critical velocity of the material, {shown}: the specimen breaks at its \
                 struck end, with less energy than is stated"
            ));
        }
        warnings
    }
}

impl Problem for Blow {
    fn kind(&self) -> &'static str {
        "energy"
    }

    fn check(&self) -> Checked {
        let Specimen { length, area, toughness } = &self.specimen;
        positive([("mass", self.mass, Mass), ("specimen.length", *length, Length), ("specimen.area", *area, Area)])?;
        member("velocity", self.velocity, Velocity, Allowed::Within(0.0, Velocity.magnitudes().most))?;
        match toughness {
            Toughness::PerVolume(energy) => positive([("specimen.toughness", *energy, EnergyDensity)]),
            Toughness::Curve { notch, elastic, critical, ultimate, .. } => {
                positive([("specimen.toughness.ultimate.strain", ultimate.strain, Plain)])?;
                member("specimen.toughness.notch", *notch, Plain, Allowed::Within(1.0, f64::INFINITY))?;
                member("specimen.toughness.elastic", *elastic, Plain, Allowed::NotNegative)?;
                positive_or_infinite("specimen.toughness.critical", *critical, Velocity)
            }
        }
    }

    fn planned(&self) -> Solution {
        let outcome = self.outcome();
        let per_volume = self.specimen.energy_per_volume();
        let line = Line::new;
        let critical =
            self.critical_velocity().map(|velocity| line("critical velocity", "{}", &[(velocity, Velocity)]));
        let threshold = line("threshold", "fracture at {} and above", &[(outcome.threshold_velocity, Velocity)]);
        Solution {
            outcome: if outcome.breaks { "rupture" } else { "done" },
            scheme: "closed-form",
            equation: "energy balance: fracture if m v^2/2 of the striker reaches the work that the specimen absorbs".into(),
            validity: "ductile specimen, strained uniformly, below the critical impact velocity; waves, and what a specimen that has \
                       yielded gives back, are neglected"
                .into(),
            warnings: self.warnings(&outcome),
            figures: self.figures(&outcome),
            flags: vec![("breaks", outcome.breaks)],
            lines: [
                line("striker", "kinetic energy {}", &[(outcome.available, Energy)]),
                line("specimen", "absorbs {} ({})", &[(outcome.capacity, Energy), (per_volume, EnergyDensity)]),
                threshold,
            ]
            .into_iter()
            .chain(critical)
            .collect(),
            ..Solution::default()
        }
    }

    fn solved(&self, _: Watch<'_>) -> Solution {
        let (mut solution, outcome) = (self.planned(), self.outcome());
        solution.lines.push(Line::new("striker after", "{}", &[(outcome.residual_velocity, Velocity)]));
        let strain = outcome.strain.map(|strain| Line::new("strain", "{}", &[(strain, Plain)]));
        solution.lines.extend(strain);
        solution
    }

    fn with(&self, _: Numerics) -> Box<dyn Problem> {
        Box::new(self.clone())
    }
}

impl Blow {
    fn figures(&self, outcome: &Outcome) -> Vec<Figure> {
        let figure =
            |name, key, dimension, long_name, value| Figure { key, ..Figure::new(name, dimension, long_name, value) };
        let per_volume = self.specimen.energy_per_volume();
        let residual = "final velocity of the striker";
        let threshold = "lowest velocity of this striker that causes fracture";
        let critical = "impact velocity from which on a bar of the material breaks at its struck end";
        vec![
            figure("available", "available_energy", Energy, "kinetic energy of the striker", outcome.available),
            figure("capacity", "capacity", Energy, "energy absorbed to fracture", outcome.capacity),
            figure(
                "capacity_per_volume",
                "capacity",
                EnergyDensity,
                "energy absorbed to fracture per volume",
                per_volume,
            ),
            figure("absorbed", "absorbed_energy", Energy, "energy absorbed by the specimen", outcome.absorbed),
            figure("residual_velocity", "residual_velocity", Velocity, residual, outcome.residual_velocity),
            figure("threshold_velocity", "threshold_velocity", Velocity, threshold, outcome.threshold_velocity),
            figure(
                "critical_velocity",
                "critical_velocity",
                Velocity,
                critical,
                self.critical_velocity().unwrap_or(f64::NAN),
            ),
            figure(
                "strain",
                "strain",
                Plain,
                "largest uniform engineering strain of the specimen",
                outcome.strain.unwrap_or(f64::NAN),
            ),
        ]
    }
}

/// Returns the uniform strain of the specimen at fracture: that of the largest stress over the notch factor, on the rising part of the curve.
fn break_strain(curve: &Curve, ultimate: Ultimate, notch: f64) -> f64 {
    if notch == 1.0 {
        return ultimate.strain;
    }
    let carried = curve.stress_at(ultimate.strain) / notch;
    let pieces = curve.strain().windows(2).zip(curve.stress().windows(2));
    for (strain, stress) in pieces {
        if stress[1] >= carried {
            return strain[0] + (strain[1] - strain[0]) * ((carried - stress[0]) / (stress[1] - stress[0]));
        }
    }
    ultimate.strain
}

/// Iterates over the segments of the curve up to a strain: strain and stress at both ends.
fn pieces(curve: &Curve, until: f64) -> impl Iterator<Item = ([f64; 2], [f64; 2])> + '_ {
    let knots = curve.strain().iter().copied().filter(move |&strain| strain < until).chain([until]);
    let ends = curve.strain().iter().copied().filter(move |&strain| strain > 0.0 && strain < until).chain([until]);
    knots.zip(ends).map(|(a, b)| ([a, b], [curve.stress_at(a), curve.stress_at(b)]))
}

/// Returns the work per volume up to a strain, J/m^3.
fn work(curve: &Curve, strain: f64) -> f64 {
    pieces(curve, strain).map(|(e, s)| 0.5 * (s[0] + s[1]) * (e[1] - e[0])).sum()
}

/// Returns the strain, at most `most`, at which the work per volume equals `energy`, J/m^3.
fn strain_of(curve: &Curve, energy: f64, most: f64) -> f64 {
    let mut left = energy;
    if left == 0.0 {
        return 0.0;
    }
    for (e, s) in pieces(curve, most) {
        let (width, rise) = (e[1] - e[0], s[1] - s[0]);
        let piece = 0.5 * (s[0] + s[1]) * width;
        if left < piece {
            // Solves s0 x + rise/(2 width) x^2 = left in a form without cancellation.
            let root = (s[0] * s[0] + 2.0 * rise / width * left).max(0.0).sqrt();
            return (e[0] + 2.0 * left / (s[0] + root)).min(e[1]);
        }
        left -= piece;
    }
    most
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::material::Beyond;

    /// ft*lbf in J, lb in kg, ft in m, in in m.
    const FOOT_POUND: f64 = 1.355_817_948_331_400_4;
    const POUND: f64 = 0.453_592_37;
    const FOOT: f64 = 0.3048;
    const INCH: f64 = 0.0254;

    /// The chapter's bar, 10 in by 0.5 in of 500 ft*lbf per cubic inch, struck by pounds at feet per second.
    fn blow(pounds: f64, velocity: f64) -> Outcome {
        let area = std::f64::consts::PI / 4.0 * (0.5 * INCH).powi(2);
        let toughness = Toughness::PerVolume(500.0 * FOOT_POUND / INCH.powi(3));
        let specimen = Specimen { length: 10.0 * INCH, area, toughness };
        Blow { specimen, mass: pounds * POUND, velocity: velocity * FOOT }.outcome()
    }

    #[test]
    fn the_textbook_s_heavy_weight_breaks_the_bar_and_the_light_one_does_not() {
        let heavy = blow(200.0, 80.0);
        assert!(heavy.breaks);
        // "20,000 ft-lb" of "approximately 1,000 ft-lb"; with 32.174 ft/s^2: as printed to four digits.
        let close = |value: f64, expected: f64| (value / expected - 1.0).abs() < 5e-5;
        assert!(close(heavy.capacity / FOOT_POUND, 981.75), "{}", heavy.capacity / FOOT_POUND);
        assert!(close(heavy.available / FOOT_POUND, 19_892.0), "{}", heavy.available / FOOT_POUND);
        assert!((heavy.threshold_velocity / FOOT - 17.77).abs() < 5e-3);
        // What is left of the energy: sqrt(80^2 - 17.77^2).
        assert!((heavy.residual_velocity / FOOT - 78.0).abs() < 1e-2, "{}", heavy.residual_velocity / FOOT);
        let light = blow(50.0, 30.0);
        assert!(!light.breaks && light.residual_velocity == 0.0);
        assert!(close(light.available / FOOT_POUND, 699.3), "{}", light.available / FOOT_POUND);
        assert!((light.threshold_velocity / FOOT - 35.55).abs() < 5e-3);
        assert_eq!(light.absorbed, light.available);
    }

    /// Elastic to 200 MPa at 0.001, straight to 400 MPa at 0.101, falling from there.
    fn curve() -> Curve {
        let rows = [(0.001, 200e6), (0.101, 400e6), (0.201, 300e6)];
        Curve::new(&rows, Beyond::Rupture).expect("rows are right")
    }

    fn drawn(notch: f64, velocity: f64) -> Outcome {
        let curve = curve();
        let ultimate = curve.ultimate().expect("400 MPa");
        let toughness = Toughness::Curve { curve, ultimate, notch, elastic: 0.001, critical: f64::INFINITY };
        let specimen = Specimen { length: 0.2, area: 1e-4, toughness };
        Blow { specimen, mass: 2.0, velocity }.outcome()
    }

    #[test]
    fn a_curve_gives_its_area_up_to_the_largest_stress() {
        let outcome = drawn(1.0, 10.0);
        // (0.1 + 30) MJ/m^3 in 2e-5 m^3.
        assert!((outcome.capacity / 602.0 - 1.0).abs() < 1e-14, "{}", outcome.capacity);
        assert!(!outcome.breaks);
        // 100 J: 5 MJ/m^3 = 0.1e6 + 200e6 x + 1e9 x^2.
        let x = (-200e6 + (4e16 + 4e9 * 4.9e6_f64).sqrt()) / 2e9;
        assert!((outcome.strain.expect("a curve") / (0.001 + x) - 1.0).abs() < 1e-13);
        // A hair's breadth on both sides of the threshold.
        let limit = outcome.threshold_velocity;
        assert!(!drawn(1.0, limit * (1.0 - 1e-12)).breaks && drawn(1.0, limit * (1.0 + 1e-12)).breaks);
    }

    #[test]
    fn a_striker_at_rest_strains_nothing() {
        let outcome = drawn(1.0, 0.0);
        assert_eq!((outcome.strain, outcome.elastic, outcome.residual_velocity), (Some(0.0), false, 0.0));
    }

    #[test]
    fn a_notch_leaves_next_to_nothing_to_the_rest() {
        // 300 MPa: half of the plastic part, at 0.051.
        let mild = drawn(4.0 / 3.0, 100.0);
        assert!((mild.capacity / (2e-5 * (0.1e6 + 250e6 * 0.05)) - 1.0).abs() < 1e-12, "{}", mild.capacity);
        assert!((mild.strain.expect("a curve") - 0.051).abs() < 1e-15);
        // 160 MPa is below yield: sigma^2/(2E), with E = 200 GPa.
        let sharp = drawn(2.5, 100.0);
        assert!(sharp.breaks && (sharp.capacity / (2e-5 * 160e6 * 0.0004) - 1.0).abs() < 1e-12, "{}", sharp.capacity);
    }
}
