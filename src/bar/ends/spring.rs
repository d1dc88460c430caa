//! A linear spring between the face and the ground, without force at the start: p = -k d.

use super::{Boundary, EndModel, Push, Relation, Relaxation, Response, Step, relaxation_weight};

/// Over a step `p = -k (d + theta dt u)`; against the bar's impedance Y the displacement relaxes with the time Y/k, and theta is the
/// [`relaxation_weight`] for it: second order where the step resolves the spring, stable for any stiffness, and a rigid one is
/// a fixed end.
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

    fn follows_place(&self) -> bool {
        true
    }

    fn stores(&self) -> bool {
        true
    }

    fn boxed(&self) -> Box<dyn EndModel> {
        Box::new(self.clone())
    }
}
