//! The records from which the figures of a run are computed.

use super::fragment::Fragments;
use super::tally::{Extreme, Tally};
use crate::bar::{Bar, EndCondition};
use crate::record::{Account, ContactReading, Twisted};

/// A segment at the end of a run.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct SegmentEnd {
    /// Mass with which the solver computes, kg: grids round lengths, see [`crate::solver::fd::Grid::in_whole_steps`].
    pub mass: f64,
    /// Elongation, m.
    pub elongation: f64,
    /// The plastic part of it, m.
    pub plastic_elongation: f64,
    /// N s in +x.
    pub momentum: f64,
    /// Signed plastic strain.
    pub residual: Extreme,
    /// Largest accumulated plastic strain.
    pub accumulated: f64,
}

impl SegmentEnd {
    /// Adds a part of the segment.
    pub fn add(&mut self, part: &Self) {
        self.elongation += part.elongation;
        self.plastic_elongation += part.plastic_elongation;
        self.mass += part.mass;
        self.momentum += part.momentum;
        self.residual.add(part.residual.at, part.residual.value);
        self.accumulated = self.accumulated.max(part.accumulated);
    }
}

/// Everything that figures are computed from.
#[derive(Debug)]
pub struct Records<'a> {
    /// The bar as the scene states it.
    pub bar: &'a Bar,
    /// Its ends.
    pub ends: [&'a EndCondition; 2],
    /// Of a bar that is twisted, whose stresses are those of its surface: torque over stress of each segment.
    pub twisted: Option<Twisted>,
    /// Velocities of bodies at the ends of their own over those with which they move the bar there.
    pub levers: [f64; 2],
    /// Names of the gauges.
    pub gauges: Vec<&'a str>,
    /// What the histories came to.
    pub tally: &'a Tally,
    /// Sections to which the histories beside joints belong, m^2.
    pub joint_areas: Vec<f64>,
    /// Mean plastic strain in equal parts of the bar.
    pub residual_profile: &'a [f64],
    /// The segments at the end.
    pub segments: Vec<SegmentEnd>,
    /// Energies and impulses at the end.
    pub account: Account,
    /// Joints that can open.
    pub contacts: Vec<ContactReading>,
    /// Velocities of the strikers at the end, m/s.
    pub strikers: [Option<f64>; 2],
    /// The force at which each joint broke, N, with its time; 0 while it holds.
    pub breaks: Vec<Extreme>,
    /// The bar broke.
    pub broken: bool,
    /// The pieces that are left of it then, from the left.
    pub fragments: &'a Fragments,
}

/// A part of the bar, or all of it, at the end.
pub(super) struct Part {
    /// None where the parts are not joined, and in torsion.
    pub length: Option<[f64; 2]>,
    /// Rotation of its right end against the left one, and what is left of it after elastic unloading, rad; none where the parts are not joined,
    /// and in axial bars.
    pub twist: Option<[f64; 2]>,
    pub end: SegmentEnd,
}

/// What the whole bar has absorbed.
pub(super) struct Absorbed {
    /// J; none where the scene gives no area.
    pub energy: Option<f64>,
    /// J/m^3; none in torsion.
    pub per_volume: Option<f64>,
}
