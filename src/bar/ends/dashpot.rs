//! Linear dashpot between the face and a support: p = -c (u - u0).

use super::{Boundary, EndModel, Face, Push, Relation, Response, Step};

/// A dashpot, which dissipates c (u - u0)^2 dt >= 0 in a step. With c = rho c0 A elastic waves leave without reflection (Lysmer and Kuhlemeyer, J.
/// Eng. Mech. Div. ASCE 95, 1969); c = 0 gives a free end, c to infinity a fixed one.
#[derive(Debug, Clone)]
pub(super) struct Dashpot {
    /// Coefficient c, N s/m, >= 0.
    coefficient: f64,
    /// Velocity u0 of the support, m/s, into the bar.
    support: f64,
}

impl Dashpot {
    /// Returns a dashpot with a fixed support; `coefficient` in N s/m, >= 0.
    pub fn to_ground(coefficient: f64) -> Self {
        Self { coefficient, support: 0.0 }
    }

    /// Returns the dashpot that represents an infinite elastic bar of the same section and the same initial velocity.
    pub fn absorbing(face: Face) -> Self {
        Self { coefficient: face.impedance, support: face.velocity }
    }
}

impl EndModel for Dashpot {
    fn relation(&self, _: &Step, _: &Response) -> Relation {
        let of_velocity = self.coefficient;
        Relation { of_velocity, of_force: 1.0, value: of_velocity * self.support, unilateral: false }
    }

    fn boundary(&self, _: &Step, _: &Push, _: bool) -> Boundary {
        Boundary::Open
    }

    fn boxed(&self) -> Box<dyn EndModel> {
        Box::new(self.clone())
    }
}
