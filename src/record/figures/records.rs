//! Records from which the figures of a run are computed.

use super::fragment::Fragments;
use super::tally::{Extreme, Tally};
use crate::bar::{Bar, EndCondition};
use crate::record::{Account, ContactReading, Twisted};

/// State of a segment at the end of a run.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct SegmentEnd {
    /// Mass with which the solver computes, kg. Grids round the lengths of segments, see [`crate::solver::fd::Grid::in_whole_steps`].
    pub mass: f64,
    /// Elongation, m.
    pub elongation: f64,
    /// Plastic part of the elongation, m.
    pub plastic_elongation: f64,
    /// Momentum, N s, positive in +x.
    pub momentum: f64,
    /// Signed plastic strain of largest magnitude, and its position, m.
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

/// Records from which the figures are computed.
#[derive(Debug)]
pub struct Records<'a> {
    /// Bar as the scene states it.
    pub bar: &'a Bar,
    /// Boundary conditions of its ends.
    pub ends: [&'a EndCondition; 2],
    /// Ratio of torque to surface stress of each segment, for a bar in torsion, whose stresses are those of its surface.
    pub twisted: Option<Twisted>,
    /// Ratio of the velocity of the striking body at each end to the velocity that it imposes on the bar there; 1 without a lever.
    pub levers: [f64; 2],
    /// Names of the gauges.
    pub gauges: Vec<&'a str>,
    /// Peaks and durations collected from the histories.
    pub tally: &'a Tally,
    /// Cross-section to which the history of each joint refers, m^2.
    pub joint_areas: Vec<f64>,
    /// Mean plastic strain in equal parts of the bar.
    pub residual_profile: &'a [f64],
    /// States of the segments at the end of the run.
    pub segments: Vec<SegmentEnd>,
    /// Energies and impulses at the end of the run.
    pub account: Account,
    /// Joints that can open.
    pub contacts: Vec<ContactReading>,
    /// Velocities of the strikers at the end of the run, m/s.
    pub strikers: [Option<f64>; 2],
    /// Force at which each joint fractured, N, and its time, s; 0 while the joint holds.
    pub breaks: Vec<Extreme>,
    /// True if the bar fractured.
    pub broken: bool,
    /// Fragments of the fractured bar from left to right.
    pub fragments: &'a Fragments,
}

/// State of a segment, or of the whole bar, at the end of the run.
pub(super) struct SegmentResults {
    /// Initial length and length after elastic unloading, m; `None` if the bar has joints that can open, and in torsion.
    pub length: Option<[f64; 2]>,
    /// Rotation of the right end relative to the left one, at the end of the run and after elastic unloading, rad;
    /// `None` if the bar has joints that can open, and in axial bars.
    pub twist: Option<[f64; 2]>,
    pub end: SegmentEnd,
}

/// Energy absorbed by the whole bar.
pub(super) struct Absorbed {
    /// Energy, J; `None` if the scene gives no area.
    pub energy: Option<f64>,
    /// Energy per volume, J/m^3; `None` in torsion.
    pub per_volume: Option<f64>,
}
