//! Fracture that a run did not simulate: strain above the fracture strain, impacts above the critical velocity. It
//! changes the outcome, so that the estimate is 1.

use std::sync::Arc;

use serde::{Deserialize, Serialize};

use super::finding::{DECISIVE, Finding};
use super::places::moment;
use super::{AuditRow, View};
use crate::bar::{Bar, Driver, InitialFan, Segment};
use crate::law::rupture::Rupture;
use crate::law::{Limit, Reached};
use crate::material::{Loading, Material, Sense, UltimateReason};
use crate::solver::fd::{CELLS_TO_BREAK, NEAR_END, OVERSHOOT, Unresolved};
use crate::units::{Dimension, System, format};

/// Fraction of the critical strain from which it counts as reached; the difference from 1 is rounding.
const REACHED: f64 = 1.0 - 1e-12;

/// Warning about strains past the largest stress of a curve without rate dependence.
const LOCALIZES: &str = "; past the largest stress of its curve the strain localizes, and without rate dependence the largest strain and the \
                         width of that zone depend on the cell size";

/// Largest ratio of tensile strain to critical strain, over every cell or over all sections between fronts.
#[derive(Debug, Default, Serialize, Deserialize)]
pub(super) struct TensileStrain {
    largest: Option<Largest>,
    /// Right end (m) and critical strain of each segment of the scene, which can be simulated in pieces. The strain is infinite if it is not known.
    critical: Vec<(f64, f64)>,
    /// Number of cells of a grid in whose end cells the scheme may overestimate the strain; `None` otherwise.
    cells: Option<usize>,
}

#[derive(Debug, Clone, Copy, Serialize, Deserialize)]
struct Largest {
    /// Strain relative to the critical strain.
    share: f64,
    strain: f64,
    /// Time, s.
    time: f64,
    segment: usize,
    /// Position, m.
    x: f64,
}

impl TensileStrain {
    /// Creates the record; `cells` is the number of cells of a grid on which plastic flow is not rate-dependent.
    pub fn new(bar: &Bar, cells: Option<usize>) -> Self {
        let mut end = 0.0;
        let critical = |segment: &Segment| {
            end += segment.length;
            let ultimate = segment.material.branch(Sense::Tension).ultimate();
            (end, ultimate.map_or(f64::INFINITY, |ultimate| ultimate.strain))
        };
        Self { largest: None, critical: bar.segments.iter().map(critical).collect(), cells }
    }

    pub fn sample(&mut self, bar: &impl View) {
        let (time, mut cell, mut segment) = (bar.time(), 0, 0);
        bar.strains(&mut |x, strain| {
            while segment + 1 < self.critical.len() && x > self.critical[segment].0 {
                segment += 1;
            }
            let near_end = self.cells.is_some_and(|cells| cell < NEAR_END || cell + NEAR_END >= cells);
            let strain = if near_end { strain / OVERSHOOT } else { strain };
            let share = strain / self.critical[segment].1;
            if share > self.largest.map_or(0.0, |largest| largest.share) {
                self.largest = Some(Largest { share, strain, time, segment, x });
            }
            cell += 1;
        });
    }

    /// Returns the finding; `rate` is true if plastic flow depends on the strain rate, which determines the width of a localized zone.
    pub fn finding(&self, materials: &[Arc<Material>], rate: bool) -> Finding {
        let Some(Largest { share, strain, time, segment, x }) = self.largest else {
            let known = materials.iter().any(|m| m.branch(Sense::Tension).ultimate().is_some());
            return if known {
                Finding::nothing("no section was strained in tension")
            } else {
                Finding::lacks(&std::format!("the curve of {}", materials[0].name), "a fracture strain")
            };
        };
        let message = std::format!(
            "fracture was not simulated; the largest tensile strain is {strain:.4} ({}), {:.0} % of the fracture strain of {}",
            moment(time, x),
            100.0 * share,
            materials[segment].name,
        );
        let ultimate = materials[segment].branch(Sense::Tension).ultimate();
        let localizes = !rate && ultimate.is_some_and(|ultimate| ultimate.reason == UltimateReason::MaximumStress);
        if share >= REACHED {
            let message = if localizes { message + LOCALIZES } else { message };
            Finding::decisive(message, "rupture = \"critical-strain\"")
        } else {
            Finding::nothing(message)
        }
    }
}

fn broken(finding: String) -> AuditRow {
    AuditRow { effect: "rupture".into(), estimate: DECISIVE, threshold: DECISIVE, finding, ..AuditRow::default() }
}

/// Returns the row of a load that exceeds what the curve carries, known before the first step: an impact above the
/// critical velocity, or a stress above the ultimate stress. `None` if the load does not exceed it.
pub fn above_critical(initial_fan: &InitialFan, material: &Material, critical_velocity: f64) -> Option<AuditRow> {
    let fan = initial_fan;
    fan.fan.above_critical.then(|| {
        let (origin, name) = (fan.origin, &material.name);
        let ultimate = format(fan.fan.stress, Dimension::Stress, System::Si);
        let exceeds = if fan.driver == Driver::Stress {
            std::format!("the stress at the {origin} end exceeds the ultimate stress of {name} ({ultimate})")
        } else {
            let critical = format(critical_velocity, Dimension::Velocity, System::Si);
            std::format!("the impact velocity at the {origin} end exceeds the critical velocity of {name} ({critical} at {ultimate})")
        };
        let when = if fan.sudden { "at t = 0" } else { "once it is reached" };
        broken(exceeds + &localizes(material, fan.sense, when, " end"))
    })
}

/// Describes the consequences of localized strain for the place and for the run.
fn localizes(material: &Material, sense: Sense, when: &str, end: &str) -> String {
    let fails = match (material.loading, sense) {
        (Loading::Shear, _) => "the shear strain localizes and the bar fractures there",
        (Loading::Axial, Sense::Tension) => "the strain localizes and the bar fractures there",
        (Loading::Axial, Sense::Compression) => "the compressive strain localizes there",
    };
    let when = if when.is_empty() { String::new() } else { std::format!(" {when}") };
    std::format!("; {fails}{when}; the run continues with the{end} stress held at the ultimate stress")
}

/// Returns the row of a place whose strain exceeded the data of its material in one sense.
pub fn past_data(sense: Sense, time: f64, x: f64, material: &Material) -> AuditRow {
    let finding = std::format!(
        "the strain exceeded the end of the data of {} ({:.4}) at t = {}, x = {}; the run continued at the largest stress of \
         the curve",
        material.name,
        material.branch(sense).last_strain(),
        format(time, Dimension::Time, System::Si),
        format(x, Dimension::Length, System::Si),
    );
    broken(finding)
}

/// Returns the row of an end that exceeded the critical velocity in this sense at some time after the start.
pub fn broken_end(end: &str, time: f64, material: &Material, sense: Sense) -> AuditRow {
    let exceeds = std::format!(
        "from t = {} on, the velocity of the {end} end exceeds the critical velocity of {}",
        format(time, Dimension::Time, System::Si),
        material.name,
    );
    broken(exceeds + &localizes(material, sense, "", " end"))
}

/// Returns the row of a point inside the bar at which the curve is at its largest stress while its two sides continue to separate or approach.
pub fn broken_inside(time: f64, x: f64, material: &Material, sense: Sense) -> AuditRow {
    let reached = std::format!(
        "from t = {} on, waves that met at x = {} have brought {} to its ultimate stress",
        format(time, Dimension::Time, System::Si),
        format(x, Dimension::Length, System::Si),
        material.name,
    );
    broken(reached + &localizes(material, sense, "", ""))
}

/// Returns the row of a tension above the fracture criterion over fewer cells than are needed for fracture on a grid.
pub fn short_tension(unresolved: &Unresolved) -> AuditRow {
    let finding = std::format!(
        "the fracture criterion was exceeded by a factor of {:.2} at x = {} (t = {}) over fewer than {CELLS_TO_BREAK} cells; \
         so short a pulse cannot be distinguished from a numerical oscillation, and no fracture was simulated there",
        unresolved.share,
        format(unresolved.x, Dimension::Length, System::Si),
        format(unresolved.time, Dimension::Time, System::Si),
    );
    AuditRow { remedy: "Use more cells, or `method = \"moc\"`".into(), ..broken(finding) }
}

/// Relative difference from the elastic strain up to which a place counts as elastic.
const SAME_STRAIN: f64 = 1e-6;

/// Returns the row of a first fracture in a section that has not yielded, which a grid simulates some steps late;
/// `None` if the section has yielded. `modulus` is that of its material, Pa.
pub fn late_fracture(first: &Rupture, modulus: f64) -> Option<AuditRow> {
    let is_elastic = (modulus * first.strain - first.stress).abs() <= SAME_STRAIN * first.stress;
    let finding = std::format!(
        "on the grid the fracture at t = {} leaves tensile pulses of up to {}, some four cells long, that a sharp fracture does not have; later peaks of \
         forces and stresses may be theirs, and a fixed end doubles them, which can break the bar; method = \"moc\" has none",
        format(first.time, Dimension::Time, System::Si),
        format(first.stress, Dimension::Stress, System::Si),
    );
    is_elastic.then(|| broken(finding))
}

/// Largest number of decimals of strains in messages; smaller differences are rounding.
const MOST_DECIMALS: usize = 9;

/// Returns the sentence that a strain is beyond the end of the data, with as many decimals as distinguish the two. A strain that differs only by
/// rounding is at the end.
fn beyond_data([strain, end]: [f64; 2], name: &str, sense: &str) -> String {
    let shown = |decimals: usize| [strain, end].map(|value| std::format!("{value:.decimals$}"));
    let differ = |[strain, end]: &[String; 2]| strain != end;
    match (4..=MOST_DECIMALS).map(shown).find(differ) {
        Some([strain, end]) => {
            std::format!("strain {strain} is beyond the end of the data of {name} in {sense} ({end})")
        }
        None => std::format!("strain {strain:.4} reaches the end of the data of {name} in {sense} ({end:.4})"),
    }
}

/// Returns the reason for which a run stops at a limit of the data of its material, and the remedy.
pub fn at_limit(reached: &Reached, material: &Material) -> (String, &'static str) {
    match reached.limit {
        Limit::EndOfData(sense) | Limit::EndOfDataReversed(sense) => (
            beyond_data(
                [reached.equivalent, material.branch(sense).last_strain()],
                &material.name,
                if material.loading == Loading::Shear { "shear" } else { sense.name() },
            ),
            "extend the stress-strain data (for a formula, a larger `to-strain`), or set `beyond = \"rupture\"` or \
             `beyond = \"extend\"` in the material",
        ),
        Limit::FullCompression => (
            std::format!(
                "material fully compressed: the engineering strain of {} is {:.4} (-1 is zero length)",
                material.name,
                reached.strain
            ),
            "the load exceeds what the curve carries at any strain: reduce it, or use a compression curve that stiffens",
        ),
    }
}
