//! Exact state of an end or a joint that is suddenly loaded beyond yield.
//!
//! Such a load emits a fan of fronts, and the state behind the fan is constant until another wave arrives. On a grid, the first cells contain the fan
//! at first. Their mean stress differs from that behind the fan and overshoots in a scheme that starts from rest, by the same fraction at any
//! resolution. For 161 MPa behind the fan of a striker, the leapfrog scheme gave 65 MPa after the first step and then 169 MPa; for 5 MPa behind a
//! shock, the Godunov scheme gave 2.8 and then 7.5 MPa; the force between colliding faces was that of the elastic impact of half a cell, more than
//! twice the exact force. Histories and peaks therefore show the exact state at first. The solution in the bar, and its momentum and energy, are
//! those of the scheme.

use serde::{Deserialize, Serialize};

use crate::wave::similarity::Fan;

/// A sudden load: the state behind its fan, and the time during which histories and peaks show it.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct SuddenLoad {
    /// Stress behind the fan, Pa.
    pub stress: f64,
    /// Velocity behind the fan, m/s.
    pub velocity: f64,
    /// Derivative of the stress with respect to the velocity, Pa s/m, if the velocity of the end is taken from the scheme; else `None`. For an end
    /// driven by a body it is that of unloading; for an end above the critical velocity it is 0.
    pub(super) slope: Option<f64>,
    /// Start, s: later than 0 if a gap closes first.
    pub(super) from: f64,
    /// Duration, s.
    pub(super) lasts: f64,
    /// Decay of the load in a rate-dependent bar.
    pub(super) fading: Option<Fading>,
}

/// State behind a fan that changes with the logarithm of time, as the strain rates in the bar fall.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub(super) struct Fading {
    /// Times after the start, s: an early one, before which the state is constant, and a late one, at which it is that of the load.
    times: [f64; 2],
    /// Stress at the early time divided by that of the load.
    ratio: f64,
    /// Velocity at the early time minus that of the load, m/s.
    faster: f64,
}

/// Largest ratio of the stresses of a load at an early and a late time for which both belong to one decaying fan; a larger ratio means that the fan
/// relaxes.
const MOST_FADING: f64 = 1.4;

/// Relative difference of these stresses below which a bar starts best with the fan of a rate-independent bar. It is that of Johnson and Cook's law
/// with C = 0.003. Without the fan, steel has 1.4 to 2.4 % too much strain in the first cell with that C, and 4.3 to 4.8 % with a third of it; with
/// the fan it has 0.9 to 4.7 % and 0.3 to 1.9 % too little.
const NO_FADING: f64 = 0.015;

/// Fraction of its duration after which a load has reached the first cell: a step or more.
const STARTS: f64 = 0.05;

impl SuddenLoad {
    /// Returns stress (Pa) and velocity (m/s) of an end at `time` (s), given those of the scheme. `None` outside the duration of the load, or if the
    /// end carries no stress.
    pub fn end(&self, time: f64, [stress, velocity]: [f64; 2]) -> Option<[f64; 2]> {
        let weight = self.weight(time).filter(|_| !self.has_parted(time, stress))?;
        if let Some(slope) = self.slope {
            return Some([self.blend(time, self.stress + slope * (velocity - self.velocity), stress), velocity]);
        }
        let faster = self.fading.map_or(0.0, |fading| fading.faster * self.earliness(time));
        Some([self.blend(time, self.stress, stress), mean(weight, self.velocity + faster, velocity)])
    }

    /// Returns a quantity at `time` (s) that is proportional to the stress: in the first half of the load the `known` value, corrected for its decay,
    /// then a weighted mean that changes linearly to the value of the scheme at the end of the load.
    pub fn blend(&self, time: f64, known: f64, scheme: f64) -> f64 {
        if self.has_parted(time, scheme) {
            return scheme;
        }
        let known = self.fading.map_or(known, |fading| known * fading.ratio.powf(self.earliness(time)));
        self.weight(time).map_or(scheme, |weight| mean(weight, known, scheme))
    }

    /// Returns the load at the second of two `times` (s) after its start, with its decay; `early` is the load at the first. `None` if they are not
    /// the same load.
    pub(super) fn fading(self, early: &Self, times: [f64; 2]) -> Option<Self> {
        let (ratio, faster) = (early.stress / self.stress, early.velocity - self.velocity);
        let fades = (1.0 / MOST_FADING..MOST_FADING).contains(&ratio) && early.from == self.from;
        let fading = Fading { times, ratio, faster };
        fades.then_some(Self { fading: Some(fading), ..self })
    }

    /// Returns true if a peak at `time` (s) is that of this load and has no limit as the time step decreases.
    pub fn has_no_limit_at(&self, time: f64) -> bool {
        self.fading.is_some() && self.weight(time).is_some()
    }

    /// Returns true if the load hardly differs from that of a rate-independent bar.
    pub(super) fn hardly_fades(&self) -> bool {
        self.fading.is_none_or(|fading| (fading.ratio - 1.0).abs() < NO_FADING)
    }

    /// Returns 1 up to the early time of a load that decays, 0 at the late one.
    fn earliness(&self, time: f64) -> f64 {
        self.fading.map_or(0.0, |Fading { times: [early, late], .. }| {
            let elapsed = (time - self.from).max(early);
            (late / elapsed).ln() / (late / early).ln()
        })
    }

    /// Returns true if no stress is carried any more, as at an end that has fractured.
    fn has_parted(&self, time: f64, scheme: f64) -> bool {
        scheme == 0.0 && time - self.from > STARTS * self.lasts
    }

    fn weight(&self, time: f64) -> Option<f64> {
        let elapsed = (time - self.from) / self.lasts;
        (0.0..1.0).contains(&elapsed).then(|| (2.0 * (1.0 - elapsed)).min(1.0))
    }
}

/// Returns true if two fans agree, as they do in a rate-independent bar.
pub(super) fn hardly_differ(a: &Fan, b: &Fan) -> bool {
    let differ = |a: f64, b: f64| (a / b - 1.0).abs() >= NO_FADING;
    !differ(a.stress, b.stress) && !differ(a.velocity, b.velocity)
}

fn mean(weight: f64, known: f64, scheme: f64) -> f64 {
    weight * known + (1.0 - weight) * scheme
}
