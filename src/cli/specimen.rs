//! What `barwave run` and `barwave plan` say of a `[specimen]` scene.

use super::lines::Lines;
use crate::record::EnergySummary;
use crate::units::{Dimension, System, format};

/// The summary for people; without `outcome`, what can be said before.
pub(super) fn text(s: &EnergySummary, units: System, outcome: bool) -> String {
    let show = |value: f64, dimension| format(value, dimension, units);
    let mut lines = Lines::under(&s.scene);
    lines.add("method", std::format!("{} {}: no waves, no steps", s.method, s.scheme));
    lines.add("striker", std::format!("kinetic energy {}", show(s.available, Dimension::Energy)));
    let per_volume = show(s.capacity_per_volume, Dimension::EnergyDensity);
    lines.add("specimen", std::format!("absorbs {} ({per_volume})", show(s.capacity, Dimension::Energy)));
    lines.add("threshold", std::format!("fracture at {} and above", show(s.threshold_velocity, Dimension::Velocity)));
    if !outcome {
        return lines.text();
    }
    let velocity = show(s.residual_velocity, Dimension::Velocity);
    lines.add(
        "outcome",
        if s.breaks {
            std::format!("{}: the striker continues at {velocity}", s.outcome)
        } else {
            std::format!("{}: the specimen holds and stops the striker", s.outcome)
        },
    );
    if let Some(strain) = s.strain {
        lines.add("strain", show(strain, Dimension::None));
    }
    lines.add("result", &s.output);
    lines.text()
}
