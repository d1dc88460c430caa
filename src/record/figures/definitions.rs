//! Definitions of all figures. Stresses and forces are positive in tension, impulses and velocities in +x. A figure
//! that does not exist for a scene is omitted.

use super::Figure;
use super::contact::Site;
use super::fragment::Fragment;
use super::key;
use super::records::{Absorbed, SegmentResults};
use super::tally::Gauge;
use crate::units::Dimension;

/// Definition of a figure that is computed from an `S`.
#[derive(Debug)]
pub struct Definition<S> {
    name: &'static str,
    dimension: Dimension,
    phrase: &'static str,
    description: &'static str,
    /// Computes the value in SI units; `None` if the figure does not exist.
    of: fn(&S) -> Option<f64>,
}

/// Table of definitions for one kind of object.
pub(super) trait Figured<S> {
    /// Returns the figures that exist.
    fn figures(&self, of: &S) -> Vec<Figure>;
}

impl<S> Figured<S> for [Definition<S>] {
    fn figures(&self, of: &S) -> Vec<Figure> {
        let figure = |d: &Definition<S>| {
            let &Definition { name, dimension, description, phrase, .. } = d;
            (d.of)(of).map(|value| Figure { name, dimension, description, phrase, value })
        };
        self.iter().filter_map(figure).collect()
    }
}

/// Creates a row of one of the tables below.
const fn row<S>(
    (name, dimension, phrase): (&'static str, Dimension, &'static str),
    description: &'static str,
    of: fn(&S) -> Option<f64>,
) -> Definition<S> {
    Definition { name, dimension, phrase, description, of }
}

/// Figures of the bar, and of each segment if there are several.
pub(super) static PART: &[Definition<SegmentResults>] = &[
    row(
        ("largest_plastic_strain", Dimension::None, ""),
        "largest accumulated plastic strain at the end of the run",
        |part| Some(part.end.accumulated),
    ),
    row(
        ("residual_strain_largest", Dimension::None, "residual strain up to"),
        "plastic strain of largest magnitude at the end of the run, with its sign",
        |part| Some(part.end.residual.value),
    ),
    row(
        ("residual_strain_position", Dimension::Length, "at x ="),
        "position of the largest residual strain, from the left end of the undeformed bar; absent without plastic strain",
        |part| (part.end.residual.value != 0.0).then_some(part.end.residual.at),
    ),
    row(
        ("final_length", Dimension::Length, ""),
        "length after elastic unloading of every section, the integral of 1 + plastic strain; of the bar only if all joints \
         are bonded",
        |part| part.length.map(|[_, last]| last),
    ),
    row(("final_length_ratio", Dimension::None, ""), "final length over initial length", |part| {
        part.length.map(|[first, last]| last / first)
    }),
    row(
        ("permanent_elongation", Dimension::Length, "permanent elongation"),
        "final length minus initial length, the integral of the plastic strain",
        |part| part.length.map(|[first, last]| last - first),
    ),
    row(
        ("angle_of_twist", Dimension::Angle, "angle of twist"),
        "rotation of the right end against the left one at the end of the run, the integral of the shear strain at the surface over its \
         radius, in torsion; of the bar only if all joints are bonded",
        |part| part.twist.map(|[now, _]| now),
    ),
    row(
        ("permanent_twist", Dimension::Angle, "permanent twist"),
        "angle of twist after elastic unloading of every section, the integral of the plastic shear strain at the surface over its radius",
        |part| part.twist.map(|[_, unloaded]| unloaded),
    ),
];

/// Figures of the bar alone: the energy balance exists only for the whole bar.
pub(super) static BAR: &[Definition<Absorbed>] = &[
    row(
        ("energy_absorbed", Dimension::Energy, "energy absorbed"),
        "energy dissipated in the bar by plastic flow, shocks and fracture; needs an area",
        |absorbed| absorbed.energy,
    ),
    row(
        ("energy_absorbed_per_volume", Dimension::EnergyDensity, ""),
        "energy absorbed over the volume of the whole bar, with that of segments that remain elastic",
        |absorbed| absorbed.per_volume,
    ),
];

/// Name and description of the profile along the bar.
pub(super) const RESIDUAL_PROFILE: (&str, &str) = (
    "residual_strain_profile",
    "mean plastic strain in each tenth of the undeformed bar, from the left, at the end of the run; `.0` to `.9` in the table \
     of a sweep",
);

/// Figures of both ends and all joints.
pub(super) static LOAD: &[Definition<Site>] = &[
    row(
        ("peak_force", Dimension::Force, "peak"),
        "force of largest magnitude with its sign, tension positive; at a fractured joint, including later contact of the fragments; \
         needs an area",
        |site| site.area.map(|area| area * site.load.peak.largest.value),
    ),
    row(
        ("peak_stress", Dimension::Stress, "peak"),
        "stress of largest magnitude with its sign, at a joint on the section to its left, in place of the force in bars without an area \
         and in torsion",
        |site| if site.area.is_none() { Some(site.load.peak.largest.value) } else { None },
    ),
    row(
        ("peak_torque", Dimension::Torque, "torque"),
        "torque of largest magnitude with its sign, in torsion",
        |site| site.torque_per_stress.map(|torque| torque * site.load.peak.largest.value),
    ),
    row(
        ("time_of_peak", Dimension::Time, "at"),
        "time at which the peak is first reached; absent if there is no force",
        |site| (site.load.peak.largest.value != 0.0).then_some(site.load.peak.largest.at),
    ),
    row(
        ("impulse", Dimension::Impulse, "impulse"),
        "impulse given to the bar at this end, or across this joint to the part on its right, positive in +x; needs an area",
        |site| site.area.and(site.impulse),
    ),
    row(
        ("impulse_per_area", Dimension::Viscosity, "impulse"),
        "impulse per area of the section, in bars without an area",
        |site| if site.area.is_none() && site.radius.is_none() { site.impulse } else { None },
    ),
    row(
        ("angular_impulse", Dimension::AngularImpulse, "angular impulse"),
        "angular impulse given to the bar at this end, or across this joint to the part on its right, in torsion",
        |site| Some(site.radius? * site.impulse?),
    ),
    row(
        ("contact_duration", Dimension::Time, "contact for"),
        "total time under contact force, at ends and joints that can open",
        |site| site.contact.map(|contact| contact.duration),
    ),
    row(
        ("time_of_release", Dimension::Time, "released at"),
        "time at which the contact force last became zero; absent if it acts at the end of the run",
        |site| site.contact.and_then(|contact| contact.released),
    ),
    row(
        ("restitution", Dimension::None, "restitution"),
        "coefficient of restitution, relative velocity of separation over that of approach, with mass-mean velocities; absent \
         if one of the \
         bodies has another contact. A fixed far end counts as a body at rest, an absorbing one as a body that keeps its \
         initial velocity",
        |site| site.restitution,
    ),
];

/// Figures of the ends.
pub(super) static END: &[Definition<Site>] = &[
    row(
        ("striker_velocity_after", Dimension::Velocity, "striker velocity"),
        "velocity of the striker or ball after its last contact; of a ball on a lever its own, of a twisting striker that of the surface",
        |site| site.striker_after,
    ),
    row(
        ("bar_velocity_after", Dimension::Velocity, "bar velocity"),
        "mass-mean velocity after the last contact of the bar, or of its part up to the next joint that can open",
        |site| site.bodies_after.into_iter().flatten().next(),
    ),
];

/// Figures of the joints.
pub(super) static JOINT: &[Definition<Site>] = &[
    row(
        ("left_velocity_after", Dimension::Velocity, "velocity of left part"),
        "mass-mean velocity of the part on the left of the joint after its last contact",
        |site| site.bodies_after[0],
    ),
    row(
        ("right_velocity_after", Dimension::Velocity, "velocity of right part"),
        "mass-mean velocity of the part on the right of the joint after its last contact",
        |site| site.bodies_after[1],
    ),
];

/// Figures of the fragments of a fractured bar, each given with whether the scene states an area.
pub(super) static FRAGMENT: &[Definition<(Fragment, bool)>] = &[
    row(("position", Dimension::Length, "from x ="), "left end in the undeformed bar", |(fragment, _)| {
        Some(fragment.place[0])
    }),
    row(("length", Dimension::Length, "length"), "length in the undeformed bar", |(fragment, _)| {
        Some(fragment.place[1] - fragment.place[0])
    }),
    row(("mass", Dimension::Mass, "mass"), "mass; needs an area", |&(fragment, has_area)| {
        has_area.then_some(fragment.mass)
    }),
    row(("velocity", Dimension::Velocity, "velocity"), "mass-mean velocity at the end of the run", |(fragment, _)| {
        (fragment.mass > 0.0).then(|| fragment.momentum / fragment.mass + 0.0)
    }),
    row(
        ("kinetic_energy", Dimension::Energy, "kinetic energy"),
        "kinetic energy at the end of the run, with that of its vibration; needs an area",
        |&(fragment, has_area)| has_area.then_some(fragment.kinetic),
    ),
];

/// Figures of the gauges.
pub(super) static GAUGE: &[Definition<Gauge>] = &[
    row(("peak_stress", Dimension::Stress, "peak stress"), "stress of largest magnitude with its sign", |gauge| {
        Some(gauge.stress.largest.value)
    }),
    row(("time_of_peak_stress", Dimension::Time, "at"), "time at which it is first reached", |gauge| {
        (gauge.stress.largest.value != 0.0).then_some(gauge.stress.largest.at)
    }),
    row(
        ("peak_strain", Dimension::None, "peak strain"),
        "engineering strain of largest magnitude with its sign",
        |gauge| Some(gauge.strain.value),
    ),
    row(("time_of_peak_strain", Dimension::Time, "at"), "time at which it is first reached", |gauge| {
        (gauge.strain.value != 0.0).then_some(gauge.strain.at)
    }),
];

/// Returns the names of all figures in the order of their definitions; some names occur at several kinds of places.
pub fn names() -> Vec<&'static str> {
    fn of<S>(table: &[Definition<S>]) -> impl Iterator<Item = &'static str> {
        table.iter().map(|d| d.name)
    }
    of(PART)
        .chain(of(BAR))
        .chain(of(LOAD))
        .chain(of(END))
        .chain(of(JOINT))
        .chain(of(FRAGMENT))
        .chain(of(GAUGE))
        .collect()
}

/// Returns every figure for the reference page: its group, JSON key, unit and description.
pub fn definitions() -> Vec<[String; 4]> {
    fn rows<S>(place: &str, table: &[Definition<S>]) -> Vec<[String; 4]> {
        let row = |d: &Definition<S>| {
            [place.to_owned(), key(d.name, d.dimension), d.dimension.units(), d.description.to_owned()]
        };
        table.iter().map(row).collect()
    }
    let (name, description) = RESIDUAL_PROFILE;
    let profile = [["bar", name, "1", description].map(str::to_owned)].to_vec();
    let tables = [
        profile,
        rows("bar, `segments.N`", PART),
        rows("bar", BAR),
        rows("`left`, `right`, `joints.N`", LOAD),
        rows("`left`, `right`", END),
        rows("`joints.N`", JOINT),
        rows("`fragments.N`", FRAGMENT),
        rows("`gauges.NAME`", GAUGE),
    ];
    tables.concat()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The energy balance exists only for the whole bar, not for its segments.
    #[test]
    fn the_energy_absorbed_is_that_of_the_bar() {
        let places = definitions().into_iter().filter(|[_, key, ..]| key.starts_with("energy_absorbed"));
        assert_eq!(places.map(|[place, ..]| place).collect::<Vec<_>>(), ["bar", "bar"]);
    }
}
