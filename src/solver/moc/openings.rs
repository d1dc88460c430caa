//! Stationary velocity jumps, and the strain localized at them.

use serde::{Deserialize, Serialize};

/// A stationary position whose two sides differ in velocity.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Opening {
    /// Position, m.
    pub x: f64,
    /// Time since which it exists, s.
    pub since: f64,
    /// Velocity of the right side minus that of the left, m/s: positive if it opens.
    pub velocity: f64,
    /// Segment and stress (Pa) of the left and of the right side.
    pub sides: [(usize, f64); 2],
}

/// Number of parts of the bar for which openings are summed: each opening is small, and there can be millions.
const PARTS: usize = 4096;

/// Permanent openings of stationary velocity jumps, summed over small parts of the bar.
#[derive(Debug, Clone, Default, Serialize, Deserialize)]
pub(super) struct Openings {
    /// Sum for each part, m; empty until there is an opening.
    parts: Vec<f64>,
}

impl Openings {
    pub fn add(&mut self, share: f64, opening: f64) {
        self.parts.resize(PARTS, 0.0);
        self.parts[((share * PARTS as f64) as usize).min(PARTS - 1)] += opening;
    }

    /// Adds to `out`, for every position of `x` (increasing), the openings to its left.
    pub fn add_up(&self, x: &[f64], length: f64, out: &mut [f64]) {
        if self.parts.is_empty() {
            return;
        }
        let (mut k, mut sum) = (0, 0.0);
        for (x, out) in x.iter().zip(out) {
            let place = x / length * PARTS as f64;
            while k < PARTS && (k + 1) as f64 <= place {
                sum += self.parts[k];
                k += 1;
            }
            // Within a part, openings are distributed evenly.
            *out += sum + self.parts.get(k).map_or(0.0, |part| part * (place - k as f64));
        }
    }
}
