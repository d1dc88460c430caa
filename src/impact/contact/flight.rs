//! Free flight between two contacts. The motion is known in closed form, and so is the time at which the bodies meet again.

use std::ops::ControlFlow;
use std::rc::Rc;

use super::{Contact, Horizon, Moment, System};
use crate::impact::oscillator::TERMS;
use crate::root::bisect;

/// Shortest duration of a penetration that is searched for, relative to the step of free flight.
const RESOLUTION: f64 = 1e-6;

impl Contact {
    /// Advances from a separation to the next contact. Returns true if there is none.
    pub(super) fn fly(
        &mut self,
        horizon: Horizon,
        look: &mut impl FnMut(Moment<'_>) -> ControlFlow<()>,
    ) -> ControlFlow<(), bool> {
        let meets = self.system.meets(self.longest, horizon.most - self.time).map(|after| self.time + after);
        let doublings = (horizon.least / (Horizon::ROWS * self.longest)).log2().ceil().max(0.0) as i32;
        let row = self.of_level(-doublings);
        while self.time < horizon.most {
            if self.time >= horizon.least && self.system.has_separated() {
                return ControlFlow::Continue(true);
            }
            let left = meets.unwrap_or(horizon.most) - self.time;
            let last = left <= row.dt;
            let step = if last { Rc::new(self.system.step(left)) } else { row.clone() };
            self.take(&step, &[0.0; TERMS]);
            self.show(step.dt, look)?;
            if last && meets.is_some() {
                return ControlFlow::Continue(false);
            }
        }
        ControlFlow::Continue(self.system.has_separated())
    }
}

impl System {
    /// Returns the time after which the bodies touch again in free motion, s; `None` if they do not within the given time. The search advances by
    /// intervals in which they cannot touch.
    fn meets(&self, longest: f64, within: f64) -> Option<f64> {
        let (mut time, mut now) = (0.0, self.clone());
        loop {
            let then = time + now.apart_for().max(RESOLUTION * longest);
            if then >= within || now.has_separated() {
                return None;
            }
            now = self.after(then);
            if now.approach(0.0) >= 0.0 && now.closing() > 0.0 {
                let apart = |time: f64| self.after(time).approach(0.0) < 0.0;
                return Some(bisect([time, then], 1e-14 * longest, apart));
            }
            time = then;
        }
    }

    /// Returns the system after a time of free motion.
    fn after(&self, time: f64) -> Self {
        Self { modes: self.modes.iter().map(|mode| mode.after(time)).collect(), ..*self }
    }

    /// Returns a lower bound of the time until the bodies touch in free motion, s, from a bound of the acceleration of the approach.
    fn apart_for(&self) -> f64 {
        let (gap, closing) = ((-self.approach(0.0)).max(0.0), self.closing());
        let most: f64 = self.modes.iter().map(|mode| mode.shape.abs() * mode.bend().q).sum();
        // Solves gap = closing t + most t^2/2.
        let root = (closing * closing + 2.0 * most * gap).sqrt();
        if closing > 0.0 {
            2.0 * gap / (closing + root)
        } else if most > 0.0 {
            (root - closing) / most
        } else {
            f64::INFINITY
        }
    }
}
