//! The pieces into which a bar has broken.

use crate::law::rupture::Rupture;

/// A piece of a broken bar at the end of a run.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Fragment {
    /// Its ends in the undeformed bar, m from the left end.
    pub place: [f64; 2],
    /// kg.
    pub mass: f64,
    /// N s in +x.
    pub momentum: f64,
    /// J.
    pub kinetic: f64,
}

/// The pieces of a broken bar, from the left; none of a whole one.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Fragments(Vec<Fragment>);

impl Fragments {
    /// Of a bar of this length (m), nothing of which is added yet.
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

    /// Adds a part of the bar around the place `x` (m), of this mass (kg) and velocity (m/s).
    pub fn add(&mut self, x: f64, mass: f64, velocity: f64) {
        let k = self.0.partition_point(|fragment| fragment.place[1] <= x);
        if let Some(fragment) = self.0.get_mut(k) {
            fragment.mass += mass;
            fragment.momentum += mass * velocity;
            fragment.kinetic += 0.5 * mass * velocity * velocity;
        }
    }

    /// Each of them.
    pub fn all(&self) -> &[Fragment] {
        &self.0
    }
}
