//! Rupture that a run passed over: strain past what the material takes, impacts above the critical velocity. The answer
//! is then another one: the estimate is 1.

use std::sync::Arc;

use serde::{Deserialize, Serialize};

use super::finding::Finding;
use super::places::Places;
use super::{AuditRow, Reading};
use crate::bar::InitialFan;
use crate::law::{Limit, Reached};
use crate::material::{Material, Sense};
use crate::solver::fd::{CELLS_TO_BREAK, Unresolved};
use crate::units::{Dimension, System, format};

/// Estimate for a bar that would have broken.
const ANOTHER_ANSWER: f64 = 1.0;

/// A share of the critical strain from here on counts as all of it: what is missing is rounding.
const REACHED: f64 = 1.0 - 1e-12;

/// The largest tensile strain against the critical one.
#[derive(Debug, Default, Serialize, Deserialize)]
pub(super) struct TensileStrain {
    /// Share of the critical strain, strain, time, place.
    largest: Option<(f64, f64, f64, usize)>,
}

impl TensileStrain {
    pub fn look(&mut self, now: &Reading, places: &Places, materials: &[Arc<Material>]) {
        let critical = |m: &Arc<Material>| m.branch(Sense::Tension).ultimate().map_or(f64::INFINITY, |u| u.strain);
        let mut k = 0;
        for (segment, material) in materials.iter().enumerate() {
            let critical = critical(material);
            while k < now.strain.len() && places.segment[k] == segment {
                let share = now.strain[k] / critical;
                if share > self.largest.map_or(0.0, |l| l.0) {
                    self.largest = Some((share, now.strain[k], now.time, k));
                }
                k += 1;
            }
        }
    }

    pub fn finding(&self, materials: &[Arc<Material>], places: &Places) -> Finding {
        let Some((share, strain, time, place)) = self.largest else {
            let known = materials.iter().any(|m| m.branch(Sense::Tension).ultimate().is_some());
            return if known {
                Finding::nothing("nothing was strained in tension")
            } else {
                Finding::unknown(std::format!("the curve of {} knows no strain at which it breaks", materials[0].name))
            };
        };
        let message = std::format!(
            "the strain in tension came to {strain:.4} ({}), {:.0} % of that at which {} breaks",
            places.moment(time, place),
            100.0 * share,
            materials[places.segment[place]].name,
        );
        if share >= REACHED {
            Finding::of(ANOTHER_ANSWER, message, "rupture = \"critical-strain\"")
        } else {
            Finding::nothing(message)
        }
    }
}

fn broken(finding: String) -> AuditRow {
    AuditRow {
        effect: "rupture".into(),
        estimate: ANOTHER_ANSWER,
        threshold: ANOTHER_ANSWER,
        finding,
        remedy: String::new(),
    }
}

/// An impact above the critical velocity, seen before the first step.
pub fn above_critical(initial_fan: &InitialFan, material: &Material, critical_velocity: f64) -> Option<AuditRow> {
    initial_fan.fan.above_critical.then(|| {
        let finding = std::format!(
            "the bar is driven from the {} beyond what {} can carry away ({} at {}); strain gathers there, \
             the bar breaks at that place at t = 0, and goes on under the ultimate stress",
            initial_fan.origin,
            material.name,
            format(critical_velocity, Dimension::Velocity, System::Si),
            format(initial_fan.fan.stress, Dimension::Stress, System::Si),
        );
        broken(finding)
    })
}

/// A place that broke at the end of its material's data for one sense.
pub fn past_data(sense: Sense, time: f64, x: f64, material: &Material) -> AuditRow {
    let finding = std::format!(
        "the strain passed the end of the data of {} ({:.4}) at t = {}, x = {}; the bar went on under the \
         largest stress of the curve",
        material.name,
        material.branch(sense).last_strain(),
        format(time, Dimension::Time, System::Si),
        format(x, Dimension::Length, System::Si),
    );
    broken(finding)
}

/// An end that was driven beyond what the curve can carry away, at some time after the start.
pub fn broken_end(end: &str, time: f64, material: &Material) -> AuditRow {
    let finding = std::format!(
        "from t = {} the {end} end is driven beyond what {} can carry away; strain gathers there, the bar breaks at \
         that place, and goes on under the ultimate stress",
        format(time, Dimension::Time, System::Si),
        material.name,
    );
    broken(finding)
}

/// A place inside the bar at which the curve can carry no more while its two sides go on apart or together.
pub fn broken_inside(time: f64, x: f64, material: &Material) -> AuditRow {
    let finding = std::format!(
        "from t = {} on, strain gathers at x = {}, where waves met and {} can carry no more; the bar breaks at that \
         place, and goes on under the ultimate stress",
        format(time, Dimension::Time, System::Si),
        format(x, Dimension::Length, System::Si),
        material.name,
    );
    broken(finding)
}

/// A tension that a rupture criterion asks for, over fewer cells than a rupture takes on a grid.
pub fn short_tension(unresolved: &Unresolved) -> AuditRow {
    let finding = std::format!(
        "the rupture criterion was exceeded {:.2} times at x = {} (t = {}) over fewer than {CELLS_TO_BREAK} cells, which the grid cannot tell \
         from a numerical pulse; the bar did not break there",
        unresolved.share,
        format(unresolved.x, Dimension::Length, System::Si),
        format(unresolved.time, Dimension::Time, System::Si),
    );
    AuditRow { remedy: "Use more cells, or method = \"moc\"".into(), ..broken(finding) }
}

/// Why a run stops that has reached a limit of what its law knows, and what to do.
pub fn at_limit(reached: &Reached, material: &Material) -> (String, &'static str) {
    match reached.limit {
        Limit::EndOfData(sense) | Limit::EndOfDataReversed(sense) => (
            std::format!(
                "strain {:.4} is past the end of the data of {} in {} ({:.4})",
                reached.equivalent,
                material.name,
                sense.name(),
                material.branch(sense).last_strain()
            ),
            "give the material more data (a formula: a larger `to-strain`), or say what happens there with \
             beyond = \"rupture\" or \"extend\"",
        ),
        Limit::FullCompression => (
            std::format!(
                "material fully compressed: the engineering strain of {} is {:.4}, and -1 leaves no length",
                material.name,
                reached.strain
            ),
            "the load is more than the curve can carry at any length: reduce it, or give a compression curve that stiffens",
        ),
    }
}
