//! Free flight between two contacts.

use std::ops::ControlFlow;
use std::rc::Rc;

use super::cubic::LOOKS;
use super::{Contact, Horizon, Moment};
use crate::impact::oscillator::TERMS;
use crate::root::bisect;

impl Contact {
    /// From a separation to the next touch; true where there is none to come.
    pub(super) fn fly(
        &mut self,
        horizon: Horizon,
        look: &mut impl FnMut(Moment<'_>) -> ControlFlow<()>,
    ) -> ControlFlow<(), bool> {
        let none = [0.0; TERMS];
        // The first look after a separation is at a gap that has opened.
        let mut opened = false;
        while self.time < horizon.most {
            let separated = self.system.has_separated();
            if separated && self.time >= horizon.least {
                return ControlFlow::Continue(true);
            }
            let mut step = self.of_level(0);
            if self.time + step.dt > horizon.most {
                step = Rc::new(self.system.step(horizon.most - self.time));
            }
            let ahead = self.system.coasted(&step);
            let order = [0, 3, 1, 2];
            let met = order.into_iter().find(|&i| ahead[i] >= 0.0 && (opened || self.opens_before(LOOKS[i] * step.dt)));
            if let Some(i) = met.filter(|_| !separated) {
                let from = if opened { 0.0 } else { self.opening(LOOKS[i] * step.dt) };
                let apart = |dt: f64| self.system.coasted(&self.system.step(dt))[2] < 0.0;
                let dt = bisect([from, LOOKS[i] * step.dt], 1e-14 * step.dt, apart);
                let step = self.system.step(dt);
                self.take(&step, &none);
                self.show(look)?;
                return ControlFlow::Continue(false);
            }
            self.take(&step, &none);
            self.show(look)?;
            opened = true;
        }
        ControlFlow::Continue(self.system.has_separated())
    }

    /// Where the gap is open between now and then.
    fn opening(&self, then: f64) -> f64 {
        let parts = (1..64).map(|i| then * f64::from(i) / 64.0);
        parts.into_iter().find(|&dt| self.system.coasted(&self.system.step(dt))[2] < 0.0).unwrap_or(0.0)
    }

    fn opens_before(&self, then: f64) -> bool {
        self.opening(then) > 0.0
    }
}
