//! Steps of the bodies at the ends, fitted to the waves that are about to arrive; and what can be read of the bodies.

use super::FrontTracking;
use super::contact::JointChange;
use super::list::{Kind, NONE};
use super::striker::StrikerState;
use crate::wave::riemann::Point;

/// A step is stretched by this much, at most, to end with the arrival of a front.
const STRETCH: f64 = 1.5;

impl FrontTracking {
    /// The striker at an end (0 left, 1 right), if there is one, now.
    pub fn striker(&self, which: usize) -> Option<StrikerState> {
        self.ends[which].striker(self.now)
    }

    /// When the striker at an end (0 left, 1 right) touched the bar and let go of it, in order; empty without one.
    ///
    /// A contact that dies away ends where the force, followed through the middles of the last steps, is zero; in the end's
    /// record the stress is zero from the next arrival of a wave on.
    pub fn striker_changes(&self, which: usize) -> &[JointChange] {
        self.ends[which].striker_changes()
    }

    /// Energy of the bodies at the left and the right end now, J: of motion for a striker, stored for a spring, 0 else.
    ///
    /// Where the present step of a body is over, it is what the body had at the start less the work done on the bar, to
    /// rounding; within a step the two differ by up to `x^2/4` of it for a step of x time constants.
    pub fn body_energy(&self) -> [f64; 2] {
        self.ends.each_ref().map(|end| end.body_energy(self.now))
    }

    /// Length of the next step of the body at an end, s, if one begins now: it ends with the arrival of a front.
    pub(super) fn body_step(&mut self, which: usize, bar: &Point, segment: u32) -> Option<f64> {
        let medium = &self.media[segment as usize];
        let (impedance, reach) = (medium.impedance(), STRETCH * medium.c0());
        let wish = self.ends[which].wish(bar, impedance)?;
        let arrival = self.arrival(which, reach * wish);
        Some(if arrival <= STRETCH * wish { arrival } else { wish })
    }

    /// When, from now, the first front gets to an end if nothing comes in its way, s, of those that are nearer to it than
    /// `reach` (m); infinite without one. Fronts too weak to break a step do not count.
    fn arrival(&self, which: usize, reach: f64) -> f64 {
        let end = self.list.get(self.end_nodes[which]);
        let weakest = self.ends[which].passing();
        let mut first = f64::INFINITY;
        let mut id = if which == 0 { end.next } else { end.prev };
        while id != NONE {
            let node = self.list.get(id);
            let distance = (node.at(self.now) - end.x).abs();
            if distance > reach || matches!(node.kind, Kind::End | Kind::Joint) {
                break;
            }
            let strength = (node.right.stress - self.list.get(node.prev).right.stress).abs();
            if node.speed * self.ends[which].inward < 0.0 && distance > self.same_place && strength > weakest {
                first = first.min(distance / node.speed.abs());
            }
            id = if which == 0 { node.next } else { node.prev };
        }
        first
    }
}
