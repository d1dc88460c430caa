//! A linear dashpot between the face and a support: p = -c (u - u0).

use super::{Boundary, EndModel, Face, Push, Relation, Response, Step};

/// It dissipates c (u - u0)^2 dt >= 0 in a step. With c = rho c0 A elastic waves leave without reflection (Lysmer and Kuhlemeyer, J. Eng. Mech. Div. ASCE 95,
/// 1969); c = 0 is a free end, c without bound a fixed one.
#[derive(Debug, Clone)]
pub(super) struct Dashpot {
    /// c, N s/m, >= 0.
    coefficient: f64,
    /// u0: velocity of the support, m/s, into the bar.
    support: f64,
}

impl Dashpot {
    /// Its other side is fixed; `coefficient` in N s/m, >= 0.
    pub fn to_ground(coefficient: f64) -> Self {
        Self { coefficient, support: 0.0 }
    }

    /// The bar continues without end, elastic, of the same section and in the same motion.
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
