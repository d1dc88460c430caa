//! The centred fan of an end or a joint that is suddenly loaded, as [`super::start`] imposes it on the nodes.

use serde::{Deserialize, Serialize};

/// Integral up to `t` (s) of a front of height 1 that passes at 0 and rises over `width` (s), by a polynomial without kinks in slope and
/// curvature: from those the scheme would ring.
fn ramped(t: f64, width: f64) -> f64 {
    if t >= 0.5 * width {
        t
    } else if t <= -0.5 * width {
        0.0
    } else {
        let s = t / width + 0.5;
        width * s.powi(4) * (2.5 + s * (s - 3.0))
    }
}

/// A front of a fan.
#[derive(Debug, Clone, Copy, Serialize, Deserialize)]
pub(super) struct Front {
    /// m/s.
    pub speed: f64,
    /// It stays sharp: the scheme is exact for it.
    pub elastic: bool,
    /// Velocity jump, m/s, in +x.
    pub jump: f64,
    /// Velocity ahead of it, m/s.
    pub velocity_ahead: f64,
}

/// The fan of an end or of one side of a joint.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(super) struct StartingFan {
    /// 0: it starts at the left of its segment, 1: at the right.
    pub side: usize,
    /// It starts at a joint.
    pub at_joint: bool,
    /// The end where it starts is under a given stress.
    pub under_stress: bool,
    /// Where a body drives the end: [`crate::bar::InitialFan::relief`], s/m.
    pub relief: Option<f64>,
    /// Velocity that the end has lost since it started, m/s, in +x: that of a body falls.
    pub slowed: f64,
    /// Only the node where it starts is made to move: the artificial viscosity for shocks keeps the cells beyond from overshooting.
    pub only_origin: bool,
    /// Its segment, which it does not leave while it is imposed.
    pub segment: usize,
    /// The fastest first.
    pub fronts: Vec<Front>,
    /// Velocity behind the fan, that of the end or the joint, m/s.
    pub velocity_behind: f64,
    /// Stress behind it, Pa, tension positive.
    pub stress: f64,
    /// Length over which fronts that are not elastic are ramps, m.
    pub ramp: f64,
    /// When it starts, s.
    pub from: f64,
    /// The first step at the end of which it is imposed, and those up to which it is, and up to which it is known.
    pub first: usize,
    pub steps: usize,
    pub known: usize,
    /// Nodes from the end on that it may set: none that one from the far side sets.
    pub nodes: usize,
    /// Energy that the end gave for it, or the bar had, and the nodes did not get, J.
    pub lost: f64,
}

impl StartingFan {
    /// Mean velocity over the step from `time` on, counted from its start, at `distance` (m) from where it starts, m/s.
    pub fn mean_velocity(&self, distance: f64, time: f64, dt: f64) -> f64 {
        // No front is felt in the first step, in which nodes are at rest.
        let half_ramp = |speed: f64| (0.5 * self.ramp).min(distance - speed * dt).max(0.0);
        // Fronts that have passed before the step count in full, those that arrive after it not at all.
        let passed = self.fronts.partition_point(|front| front.speed * time >= distance + half_ramp(front.speed));
        let arrives = |front: &&Front| front.speed * (time + dt) > distance - half_ramp(front.speed);
        let passing = self.fronts[passed..].iter().take_while(arrives);
        let share = |&Front { speed, elastic, .. }: &Front| {
            let arrival = distance / speed;
            let width = if elastic { 0.0 } else { 2.0 * half_ramp(speed) / speed };
            (ramped(time + dt - arrival, width) - ramped(time - arrival, width)) / dt
        };
        let ahead = self.fronts.get(passed).map_or(self.velocity_behind, |front| front.velocity_ahead);
        let steady = ahead + passing.map(|front| front.jump * share(front)).sum::<f64>();
        // The unloading waves that a body sends after the fan take its slowest fronts away.
        let left = (1.0 - self.relief.unwrap_or(0.0) * distance / (time + 0.5 * dt)).max(0.0);
        let unloaded = self.velocity_behind - self.slowed * left;
        if self.slowed > 0.0 {
            steady.min(unloaded)
        } else if self.slowed < 0.0 {
            steady.max(unloaded)
        } else {
            steady
        }
    }
}
