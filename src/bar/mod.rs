//! The bar: segments, joints, ends and their histories, as plain data that is the same for every solver.

mod ball_wave;
mod end;
pub mod ends;
mod hertz;
mod history;
mod initial;
mod initial_fan;
pub mod joint;
mod rising_load;
mod rows;
mod spring_wave;
mod sudden_load;
mod sudden_loads;
mod taper;
mod uniform;

use std::sync::Arc;

pub use ball_wave::ball_waves;
pub use end::EndCondition;
pub use hertz::Hertz;
pub use history::History;
pub use initial::{Distribution, Initial, InitialProfile};
pub use initial_fan::{Driver, InitialFan, Origin, START_CELLS, Unloads, first_fans, initial_fans, starting_fans};
pub(crate) use initial_fan::{acts_without_fan, drives_at_start};
pub use joint::Joint;
pub use rising_load::at_rising_load;
pub use rows::RowError;
pub use spring_wave::{at_spring, spring_waves};
pub use sudden_load::SuddenLoad;
pub use sudden_loads::SuddenLoads;
pub use taper::{Profile, Taper};
pub(crate) use uniform::{first_change, same_section, same_state};

use crate::material::Material;

/// A bar: segments from left to right.
#[derive(Debug, Clone)]
pub struct Bar {
    /// Segments from left to right; at least one.
    pub segments: Vec<Segment>,
    /// Whether the scene gives an area. If not, every segment has 1 m^2, and forces and energies are per m^2.
    pub area_given: bool,
}

/// A segment of the bar, of one material.
#[derive(Debug, Clone)]
pub struct Segment {
    /// Length, m, > 0.
    pub length: f64,
    /// Cross-sectional area, m^2, > 0; of a tapered segment the mean along it.
    pub area: f64,
    /// Variation of the cross-section along the segment; `None` if it is uniform.
    pub taper: Option<Arc<Taper>>,
    /// Material of the segment.
    pub material: Arc<Material>,
    /// Initial velocity, m/s, positive in +x; if it varies along the segment, that of its centre of mass.
    pub velocity: f64,
    /// Joint to the next segment (not used for the last segment).
    pub joint: Joint,
    /// Stress, plastic strain and temperature at t = 0; if they vary along the segment, their means.
    pub initial: Initial,
    /// Variation of the state at t = 0 along the segment; `None` if it is uniform.
    pub profile: Option<Arc<InitialProfile>>,
}

impl Segment {
    /// Returns a uniform segment of this length (m) and area (m^2), at rest, without stress, bonded to the next.
    pub fn new(length: f64, area: f64, material: impl Into<Arc<Material>>) -> Self {
        Self {
            length,
            area,
            taper: None,
            material: material.into(),
            velocity: 0.0,
            joint: Joint::Bonded,
            initial: Initial::default(),
            profile: None,
        }
    }

    /// Returns the segment with another initial velocity, m/s.
    #[must_use]
    pub fn with_velocity(self, velocity: f64) -> Self {
        Self { velocity, ..self }
    }

    /// Returns the segment with another joint to the next one.
    #[must_use]
    pub fn with_joint(self, joint: Joint) -> Self {
        Self { joint, ..self }
    }

    /// Returns the cross-sections at the left and the right end, m^2.
    pub fn end_areas(&self) -> [f64; 2] {
        self.taper.as_ref().map_or([self.area; 2], |taper| [0.0, self.length].map(|x| taper.area(x)))
    }

    /// Returns the mean state at t = 0 between two positions, in m from the left end of the segment, from < to.
    pub fn initial_between(&self, from: f64, to: f64) -> Initial {
        self.profile.as_ref().map_or(self.initial, |profile| profile.mean(from, to))
    }

    /// Returns the mean velocity (m/s) at t = 0 between two positions, in m from the left end of the segment, from < to.
    pub fn velocity_between(&self, from: f64, to: f64) -> f64 {
        self.profile.as_ref().map_or(self.velocity, |profile| profile.velocity.mean(from, to))
    }

    /// Returns the velocities (m/s) at t = 0 of the left and the right end.
    pub fn end_velocities(&self) -> [f64; 2] {
        self.profile
            .as_ref()
            .map_or([self.velocity; 2], |profile| [profile.velocity.at(0.0), profile.velocity.before(self.length)])
    }

    /// Returns true if any part of the segment has flowed before t = 0.
    pub fn has_yielded(&self) -> bool {
        let along = self.profile.as_ref().map_or(0.0, |profile| profile.accumulated.largest());
        self.initial.accumulated != 0.0 || along > 0.0
    }

    /// Returns true if any part of the segment is warmer than the material's reference temperature at t = 0.
    pub fn starts_warm(&self) -> bool {
        let along = self.profile.as_ref().map_or(0.0, |profile| profile.temperature_rise.largest());
        self.initial.temperature_rise != 0.0 || along > 0.0
    }

    /// Returns the mean cross-section between two positions, in m from the left end of the segment, from < to; m^2.
    pub fn mean_area(&self, from: f64, to: f64) -> f64 {
        self.taper.as_ref().map_or(self.area, |taper| taper.mean(from, to))
    }
}

impl Bar {
    /// Returns true if any segment is stressed, warm or has yielded at t = 0, or has a velocity that varies along it.
    pub fn has_initial_state(&self) -> bool {
        self.segments.iter().any(|segment| segment.profile.is_some() || segment.initial != Initial::default())
    }

    /// Returns true if the bar starts at rest and without stress, with bonded joints only.
    pub fn starts_at_rest(&self) -> bool {
        let bonded = |k: usize| self.segments[k].joint == Joint::Bonded;
        let resting = self.segments.iter().all(|segment| segment.velocity == 0.0);
        resting && !self.has_initial_state() && (0..self.segments.len() - 1).all(bonded)
    }

    /// Returns the velocities (m/s) at t = 0 of the left and the right end of the bar.
    pub fn end_velocities(&self) -> [f64; 2] {
        let last = self.segments.len() - 1;
        [self.segments[0].end_velocities()[0], self.segments[last].end_velocities()[1]]
    }

    /// Returns the bar with the stress-strain curves of the initial temperature for segments that are uniformly warm at t = 0.
    #[must_use]
    pub fn on_warm_curves(&self) -> Self {
        let mut bar = self.clone();
        for segment in bar.segments.iter_mut().filter(|segment| segment.profile.is_none()) {
            let rise = segment.initial.temperature_rise;
            if rise > 0.0
                && let Some(warm) = segment.material.at_rise(rise)
            {
                segment.material = Arc::new(warm);
                segment.initial.temperature_rise = 0.0;
            }
        }
        bar
    }

    /// Returns the bar without stress, temperature rise and plastic strain at t = 0; velocities that vary along a segment are replaced by their
    /// means.
    #[must_use]
    pub fn without_initial_state(&self) -> Self {
        let mut bar = self.clone();
        for segment in &mut bar.segments {
            (segment.initial, segment.profile) = (Initial::default(), None);
        }
        bar
    }

    /// Returns the total length, m.
    pub fn length(&self) -> f64 {
        self.segments.iter().map(|s| s.length).sum()
    }

    /// Returns the transit time of an elastic wave from end to end, s.
    pub fn transit_time(&self) -> f64 {
        self.transit_times().iter().sum()
    }

    /// Returns the transit times of an elastic wave through the segments, s.
    pub fn transit_times(&self) -> Vec<f64> {
        self.segments.iter().map(|s| s.length / s.material.c0()).collect()
    }
}

#[cfg(test)]
impl Bar {
    /// Of elastic segments of 200 GPa with these lengths (m) and densities (kg/m^3).
    pub(crate) fn elastic(parts: &[(f64, f64)]) -> Self {
        use crate::material::{Beyond, Curve};
        let segment = |&(length, density): &(f64, f64)| {
            let curve = Curve::new(&[(0.01, 2e9)], Beyond::Extend).expect("rows rise");
            Segment::new(length, 1.0, Material::from_curve("m", density, curve).expect("a material"))
        };
        Self { segments: parts.iter().map(segment).collect(), area_given: true }
    }
}
