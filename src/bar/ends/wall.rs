//! A rigid wall in unilateral contact with the end.

use super::{Boundary, EndModel, Push, Relation, Response, Step};

/// It takes up just the velocity that would carry the face into it.
#[derive(Debug, Clone)]
pub(super) struct Wall {
    /// Distance at the start, m, >= 0.
    pub gap: f64,
}

impl EndModel for Wall {
    fn relation(&self, step: &Step, _: &Response) -> Relation {
        Relation::velocity(-(self.gap + step.displacement) / step.dt).without_pull()
    }

    fn gap(&self, displacement: f64) -> Option<f64> {
        // At the wall, rounding may take the face past it.
        Some((self.gap + displacement).max(0.0))
    }

    fn boundary(&self, _: &Step, _: &Push, met: bool) -> Boundary {
        if met { Boundary::FIXED } else { Boundary::FREE }
    }

    fn boxed(&self) -> Box<dyn EndModel> {
        Box::new(self.clone())
    }
}
