//! The exact state of an end or a joint that is suddenly loaded beyond yield.
//!
//! Such a load starts a fan of fronts, and the state behind the fan is constant until another wave arrives. On a grid, the first cells contain
//! the fan at first. Their mean stress differs from that behind it and, in a scheme that starts from rest, overshoots, by the same fraction at
//! any resolution: for 161 MPa behind the fan of a striker, leapfrog gave 65 MPa after the first step and then 169 MPa; for 5 MPa behind a
//! shock, the Godunov scheme gave 2.8 and then 7.5 MPa; the force between colliding faces was the elastic impact of half a cell, more than twice the exact one. Histories and
//! peaks therefore show the exact state at first. The solution in the bar, and its momentum and energy, are those of the scheme.

use serde::{Deserialize, Serialize};

use crate::wave::similarity::Fan;

/// A sudden load: the state behind its fan, and the time for which histories and peaks show it.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct SuddenLoad {
    /// Behind the fan, Pa.
    pub stress: f64,
    /// Behind the fan, m/s.
    pub velocity: f64,
    /// Where the velocity of the end is that of the scheme: change of stress with it, Pa s/m. Of an end that a body drives, that of unloading; 0 of one
    /// that moves faster than the curve carries away.
    pub(super) slope: Option<f64>,
    /// Start, s: later than 0 if a gap closes first.
    pub(super) from: f64,
    /// Duration, s.
    pub(super) lasts: f64,
    /// How it fades in a rate-dependent bar.
    pub(super) fading: Option<Fading>,
}

/// A state behind a fan that changes with the logarithm of the time, as the strain rates in the bar fall.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub(super) struct Fading {
    /// Times after the start, s: an early one, up to which it is as then, and that at which it is as the load says.
    times: [f64; 2],
    /// Stress at the early one over that of the load.
    ratio: f64,
    /// Velocity at the early one over that of the load, m/s.
    faster: f64,
}

/// Stresses of a load at an early and a late time that differ by a larger factor do not belong to one fan that fades: it relaxes.
const MOST_FADING: f64 = 1.4;

/// Part by which they differ in a bar that starts best with the fan of one that takes no time: Johnson and Cook's law with C = 0.003. Without the fan,
/// steel has 1.4 to 2.4 % too much strain in the first cell with that C, and 4.3 to 4.8 % with a third of it; with it, 0.9 to 4.7 and 0.3 to 1.9 % too little.
const NO_FADING: f64 = 0.015;

/// Part of its duration by which a load has come to the first cell: a step and more.
const STARTS: f64 = 0.05;

impl SuddenLoad {
    /// Stress (Pa) and velocity (m/s) of an end at `time` (s), given those of the scheme; none outside the time of the load, and where nothing is carried.
    pub fn end(&self, time: f64, [stress, velocity]: [f64; 2]) -> Option<[f64; 2]> {
        let weight = self.weight(time).filter(|_| !self.has_parted(time, stress))?;
        if let Some(slope) = self.slope {
            return Some([self.blend(time, self.stress + slope * (velocity - self.velocity), stress), velocity]);
        }
        let faster = self.fading.map_or(0.0, |fading| fading.faster * self.earliness(time));
        Some([self.blend(time, self.stress, stress), mean(weight, self.velocity + faster, velocity)])
    }

    /// A quantity at `time` (s) that goes with the stress: the `known` value in the first half of the load, as far as it has faded, then a mean with
    /// that of the scheme, which goes over to the scheme's at its end.
    pub fn blend(&self, time: f64, known: f64, scheme: f64) -> f64 {
        if self.has_parted(time, scheme) {
            return scheme;
        }
        let known = self.fading.map_or(known, |fading| known * fading.ratio.powf(self.earliness(time)));
        self.weight(time).map_or(scheme, |weight| mean(weight, known, scheme))
    }

    /// The load, as it is at the second of two `times` (s) after its start; `early` is the same load at the first. None where they are not the same.
    pub(super) fn fading(self, early: &Self, times: [f64; 2]) -> Option<Self> {
        let (ratio, faster) = (early.stress / self.stress, early.velocity - self.velocity);
        let fades = (1.0 / MOST_FADING..MOST_FADING).contains(&ratio) && early.from == self.from;
        let fading = Fading { times, ratio, faster };
        fades.then_some(Self { fading: Some(fading), ..self })
    }

    /// A peak at `time` (s) is that of this load and has no limit: the shorter the time step, the larger it is.
    pub fn has_no_limit_at(&self, time: f64) -> bool {
        self.fading.is_some() && self.weight(time).is_some()
    }

    /// It is as in a bar that takes no time to flow.
    pub(super) fn hardly_fades(&self) -> bool {
        self.fading.is_none_or(|fading| (fading.ratio - 1.0).abs() < NO_FADING)
    }

    /// 1 up to the early time of a load that fades, 0 at the late one.
    fn earliness(&self, time: f64) -> f64 {
        self.fading.map_or(0.0, |Fading { times: [early, late], .. }| {
            let elapsed = (time - self.from).max(early);
            (late / elapsed).ln() / (late / early).ln()
        })
    }

    /// Nothing is carried any more, as by an end that has fractured.
    fn has_parted(&self, time: f64, scheme: f64) -> bool {
        scheme == 0.0 && time - self.from > STARTS * self.lasts
    }

    fn weight(&self, time: f64) -> Option<f64> {
        let elapsed = (time - self.from) / self.lasts;
        (0.0..1.0).contains(&elapsed).then(|| (2.0 * (1.0 - elapsed)).min(1.0))
    }
}

/// Two fans are one in a bar that takes no time to flow.
pub(super) fn hardly_differ(a: &Fan, b: &Fan) -> bool {
    let differ = |a: f64, b: f64| (a / b - 1.0).abs() >= NO_FADING;
    !differ(a.stress, b.stress) && !differ(a.velocity, b.velocity)
}

fn mean(weight: f64, known: f64, scheme: f64) -> f64 {
    weight * known + (1.0 - weight) * scheme
}
