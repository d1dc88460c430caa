//! Critical velocity reported by a run.

use std::borrow::Cow;

use super::Scene;
use crate::bar::{EndCondition, initial_fans};
use crate::material::Sense;
use crate::wave::similarity::critical;

impl Scene {
    /// Returns the end conditions with their histories truncated at the end of the run.
    pub fn ends_in_run(&self) -> [Cow<'_, EndCondition>; 2] {
        [&self.left, &self.right].map(|end| end.until(self.solve.until))
    }

    /// Returns the critical velocity for the loading of the bar, m/s: that of the struck material in the sense of the impact, at its initial
    /// temperature if this is uniform, without initial stress and plastic strain. Returns `None` if the data of the curve contain none.
    pub fn critical_velocity(&self) -> Option<f64> {
        let [left, right] = self.ends_in_run();
        let bar = self.bar.on_warm_curves().without_initial_state();
        let fans = initial_fans(&bar, &left, &right);
        let (segment, sense) = fans.first().map_or((0, Sense::Tension), |fan| (fan.segment, fan.sense));
        let material = &bar.segments[segment].material;
        critical(material.branch(sense), material.density).map(|critical| critical.velocity)
    }

    /// Returns whether the bar is loaded above its critical velocity from the start; false, because unknown, for a bar that is stressed, has yielded,
    /// or has a nonuniform temperature.
    pub fn is_above_critical(&self) -> bool {
        let [left, right] = self.ends_in_run();
        initial_fans(&self.bar.on_warm_curves(), &left, &right).iter().any(|fan| fan.fan.above_critical)
    }
}
