//! Fragments of a fractured bar.

use crate::law::rupture::Rupture;

/// Fragment of a fractured bar at the end of a run.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Fragment {
    /// Positions of its ends in the undeformed bar, m from the left end.
    pub place: [f64; 2],
    /// Mass, kg.
    pub mass: f64,
    /// Momentum, N s, positive in +x.
    pub momentum: f64,
    /// Kinetic energy, J.
    pub kinetic: f64,
}

/// Fragments of a fractured bar from left to right; empty if the bar is whole.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Fragments(Vec<Fragment>);

impl Fragments {
    /// Creates the fragments of a bar of this length (m), with zero mass.
    pub fn new(length: f64, ruptures: &[Rupture]) -> Self {
        let mut borders: Vec<f64> = ruptures.iter().map(|rupture| rupture.x).collect();
        borders.retain(|&x| 0.0 < x && x < length);
        if borders.is_empty() {
            return Self::default();
        }
        borders.extend([0.0, length]);
        borders.sort_by(f64::total_cmp);
        borders.dedup();
        let fragment = |ends: &[f64]| Fragment { place: [ends[0], ends[1]], ..Fragment::default() };
        Self(borders.windows(2).map(fragment).collect())
    }

    /// Adds a part of the bar at the position `x` (m), of this mass (kg) and velocity (m/s), to its fragment.
    pub fn add(&mut self, x: f64, mass: f64, velocity: f64) {
        let k = self.0.partition_point(|fragment| fragment.place[1] <= x);
        if let Some(fragment) = self.0.get_mut(k) {
            fragment.mass += mass;
            fragment.momentum += mass * velocity;
            fragment.kinetic += 0.5 * mass * velocity * velocity;
        }
    }

    /// Returns all fragments.
    pub fn all(&self) -> &[Fragment] {
        &self.0
    }
}
