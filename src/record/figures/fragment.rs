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

/// Those of a bar of this length (m), at rest; none where it has not broken.
pub fn fragments(length: f64, ruptures: &[Rupture]) -> Vec<Fragment> {
    let mut borders: Vec<f64> = ruptures.iter().map(|rupture| rupture.x).collect();
    borders.retain(|&x| 0.0 < x && x < length);
    if borders.is_empty() {
        return Vec::new();
    }
    borders.extend([0.0, length]);
    borders.sort_by(f64::total_cmp);
    borders.dedup();
    borders.windows(2).map(|ends| Fragment { place: [ends[0], ends[1]], ..Fragment::default() }).collect()
}

/// Adds a part of the bar around the place `x` (m), of this mass (kg) and velocity (m/s).
pub fn add_to_fragments(fragments: &mut [Fragment], x: f64, [mass, velocity]: [f64; 2]) {
    let k = fragments.partition_point(|fragment| fragment.place[1] <= x);
    if let Some(fragment) = fragments.get_mut(k) {
        fragment.mass += mass;
        fragment.momentum += mass * velocity;
        fragment.kinetic += 0.5 * mass * velocity * velocity;
    }
}
