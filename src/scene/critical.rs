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

    /// The critical velocity that goes with the bar's loading: of the struck material in the sense in which it is struck, at its initial temperature
    /// where that is uniform, without initial stress and plastic strain; m/s. None where the data of its curve hold none.
    pub fn critical_velocity(&self) -> Option<f64> {
        let [left, right] = self.ends_in_run();
        let bar = self.bar.on_warm_curves().without_initial_state();
        let fans = initial_fans(&bar, &left, &right);
        let (segment, sense) = fans.first().map_or((0, Sense::Tension), |fan| (fan.segment, fan.sense));
        let material = &bar.segments[segment].material;
        critical(material.branch(sense), material.density).map(|critical| critical.velocity)
    }

    /// It is driven above its critical velocity from the start on; not known of a bar that is stressed, has flowed, or is warmer at one place than at another.
    pub fn is_above_critical(&self) -> bool {
        let [left, right] = self.ends_in_run();
        initial_fans(&self.bar.on_warm_curves(), &left, &right).iter().any(|fan| fan.fan.above_critical)
    }
}
