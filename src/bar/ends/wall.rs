//! Rigid wall in unilateral contact with the end.

use super::{Boundary, EndModel, Push, Relation, Response, Step};

/// A rigid wall: in contact, the velocity over a step is the one that brings the face to the wall.
#[derive(Debug, Clone)]
pub(super) struct Wall {
    /// Distance at t = 0, m, >= 0.
    pub gap: f64,
}

impl EndModel for Wall {
    fn relation(&self, step: &Step, _: &Response) -> Relation {
        Relation::velocity(-(self.gap + step.displacement) / step.dt).without_pull()
    }

    fn gap(&self, displacement: f64) -> Option<f64> {
        // In contact, rounding may move the face beyond the wall.
        Some((self.gap + displacement).max(0.0))
    }

    fn is_conservative(&self) -> bool {
        // A wall does no work. In a step in which the face arrives, force times velocity is not zero only because both are means over the step.
        true
    }

    fn boundary(&self, _: &Step, _: &Push, met: bool) -> Boundary {
        if met { Boundary::FIXED } else { Boundary::FREE }
    }

    fn boxed(&self) -> Box<dyn EndModel> {
        Box::new(self.clone())
    }
}
