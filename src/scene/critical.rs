//! The critical velocity that a run states.

use std::borrow::Cow;

use super::Scene;
use crate::bar::{EndCondition, initial_fans};
use crate::material::Sense;
use crate::wave::similarity::critical;

impl Scene {
    /// The ends with what they impose before the end of the run.
    pub fn ends_in_run(&self) -> [Cow<'_, EndCondition>; 2] {
        [&self.left, &self.right].map(|end| end.until(self.solve.until))
    }

    /// The critical velocity that goes with the bar's loading: of the struck material in the sense in which it is struck, without initial stress and
    /// plastic strain; m/s. None where the data of its curve hold none.
    pub fn critical_velocity(&self) -> Option<f64> {
        let [left, right] = self.ends_in_run();
        let fans = initial_fans(&self.bar.without_initial_state(), &left, &right);
        let (segment, sense) = fans.first().map_or((0, Sense::Tension), |fan| (fan.segment, fan.sense));
        let material = &self.bar.segments[segment].material;
        critical(material.branch(sense), material.density).map(|critical| critical.velocity)
    }
}
