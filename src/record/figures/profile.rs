//! Plastic strain along the bar.

/// Number of equal parts of the undeformed bar.
const PARTS: usize = 10;

/// Mean plastic strain in equal parts of the undeformed bar, from left to right.
#[derive(Debug, Clone, PartialEq)]
pub struct ResidualProfile {
    length: f64,
    /// Integrals of the strain over the parts, m.
    integrals: [f64; PARTS],
}

impl ResidualProfile {
    /// Creates the profile of a bar of this length (m) without plastic strain.
    pub fn new(length: f64) -> Self {
        Self { length, integrals: [0.0; PARTS] }
    }

    /// Adds a section between two positions (m) with its plastic strain.
    pub fn add(&mut self, [from, to]: [f64; 2], strain: f64) {
        let width = self.length / PARTS as f64;
        let part = |x: f64| ((x / width) as usize).min(PARTS - 1);
        for k in part(from)..=part(to) {
            let low = from.max(k as f64 * width);
            let high = if k + 1 == PARTS { to } else { to.min((k + 1) as f64 * width) };
            self.integrals[k] += strain * (high - low).max(0.0);
        }
    }

    /// Returns the mean of each part.
    pub fn means(&self) -> Vec<f64> {
        self.integrals.iter().map(|integral| integral * PARTS as f64 / self.length).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sections_are_shared_by_the_parts_they_lie_in() {
        let mut profile = ResidualProfile::new(2.0);
        profile.add([0.0, 0.3], 0.1);
        profile.add([0.3, 2.0], 0.2);
        let means = profile.means();
        assert!((means[0] - 0.1).abs() < 1e-15 && (means[1] - 0.15).abs() < 1e-15, "{means:?}");
        assert!(means[2..].iter().all(|mean| (mean - 0.2).abs() < 1e-15), "{means:?}");
    }
}
