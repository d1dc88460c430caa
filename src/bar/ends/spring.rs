//! Linear spring between the face and the ground, without force at t = 0: p = -k d.

use super::{Boundary, EndModel, Push, Relation, Relaxation, Response, Step, relaxation_weight};

/// A spring with `p = -k (d + theta dt u)` over a step. Against the bar's impedance Y the displacement relaxes with the time constant Y/k, and theta
/// is the [`relaxation_weight`] for it: second order where the step resolves the spring, and stable for any stiffness. A rigid spring is a fixed end.
#[derive(Debug, Clone)]
pub(super) struct Spring {
    /// k, N/m, >= 0.
    stiffness: f64,
}

impl Spring {
    pub fn new(stiffness: f64) -> Self {
        Self { stiffness }
    }
}

impl EndModel for Spring {
    fn relation(&self, step: &Step, bar: &Response) -> Relation {
        let k_dt = self.stiffness * step.dt;
        Relation {
            of_velocity: k_dt * relaxation_weight(k_dt / bar.impedance),
            of_force: 1.0,
            value: -self.stiffness * step.displacement,
            unilateral: false,
        }
    }

    fn boundary(&self, step: &Step, latest: &Push, _: bool) -> Boundary {
        Boundary::Force { value: -self.stiffness * step.displacement, rate: -self.stiffness * latest.velocity }
    }

    fn relaxation(&self, displacement: f64, bar: &Response) -> Option<Relaxation> {
        let force = (bar.force + self.stiffness * displacement).abs();
        Some(Relaxation { time: bar.impedance / self.stiffness, force })
    }

    fn energy(&self, displacement: f64) -> f64 {
        0.5 * self.stiffness * displacement * displacement
    }

    fn depends_on_displacement(&self) -> bool {
        true
    }

    fn is_conservative(&self) -> bool {
        true
    }

    fn boxed(&self) -> Box<dyn EndModel> {
        Box::new(self.clone())
    }
}
