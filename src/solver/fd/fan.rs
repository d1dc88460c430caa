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
    /// Steps in which it is imposed.
    pub steps: usize,
    /// Steps in which it is known.
    pub known: usize,
    /// Nodes from the end on that it may set: none that one from the far side sets.
    pub nodes: usize,
    /// Energy that the end gave for it, or the bar had, and the nodes did not get, J.
    pub lost: f64,
}

impl StartingFan {
    /// Velocity of the node where it starts in the step after `step` (m/s), which moved with `before` (m/s) in the last one. In the first
    /// step that was as if the bar stayed elastic: it makes up for that in the second.
    pub fn at_its_origin(&self, step: usize, before: f64) -> f64 {
        self.velocity_behind + if step == 1 { self.velocity_behind - before } else { 0.0 }
    }

    /// Mean velocity over the step from `time` on at `distance` (m) from where it starts, m/s.
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
        ahead + passing.map(|front| front.jump * share(front)).sum::<f64>()
    }
}
