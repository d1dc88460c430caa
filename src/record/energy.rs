//! The summary of a blow on a specimen.

use serde::Serialize;

use super::store::Figure;
use crate::impact::Blow;

/// The method's name in files and summaries.
pub const ENERGY: &str = "energy";

/// What `barwave run --json` prints of a `[specimen]` scene.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct EnergySummary {
    /// Scene title.
    pub scene: String,
    /// "rupture" where the specimen breaks, else "done".
    pub outcome: String,
    /// "energy".
    pub method: String,
    /// "closed-form".
    pub scheme: String,
    /// Always empty.
    pub effects: Vec<String>,
    /// The striker's energy of motion.
    #[serde(rename = "available_energy_J")]
    pub available: f64,
    /// What the specimen can absorb.
    #[serde(rename = "capacity_J")]
    pub capacity: f64,
    /// The same per volume.
    #[serde(rename = "capacity_J_m3")]
    pub capacity_per_volume: f64,
    /// What it has absorbed in the end.
    #[serde(rename = "absorbed_energy_J")]
    pub absorbed: f64,
    /// It breaks.
    pub breaks: bool,
    /// The striker's velocity when the specimen has broken; 0 where it stops the striker.
    #[serde(rename = "residual_velocity_m_s")]
    pub residual_velocity: f64,
    /// The least velocity of this striker that breaks the specimen.
    #[serde(rename = "threshold_velocity_m_s")]
    pub threshold_velocity: f64,
    /// Engineering strain all along the specimen in the end; null where no curve says.
    pub strain: Option<f64>,
    /// Everything, s.
    pub wall_s: f64,
    /// The result file; empty without one.
    pub output: String,
}

impl EnergySummary {
    /// Of a blow, for a scene with this title.
    pub fn new(scene: &str, blow: &Blow) -> Self {
        let outcome = blow.outcome();
        Self {
            scene: scene.to_owned(),
            outcome: if outcome.breaks { "rupture" } else { "done" }.to_owned(),
            method: ENERGY.to_owned(),
            scheme: "closed-form".to_owned(),
            effects: Vec::new(),
            available: outcome.available,
            capacity: outcome.capacity,
            capacity_per_volume: blow.specimen.energy_per_volume(),
            absorbed: outcome.absorbed,
            breaks: outcome.breaks,
            residual_velocity: outcome.residual_velocity,
            threshold_velocity: outcome.threshold_velocity,
            strain: outcome.strain,
            wall_s: 0.0,
            output: String::new(),
        }
    }

    /// What goes into the result file's group `/energy`.
    pub fn figures(&self) -> Vec<Figure> {
        let figure = |name, units, long_name, value| Figure { name, units, long_name, value };
        let mut figures = vec![
            figure("available", "J", "energy of motion of the striker", self.available),
            figure("capacity", "J", "energy that the specimen can absorb", self.capacity),
            figure("capacity_per_volume", "J/m^3", "energy that the specimen can absorb", self.capacity_per_volume),
            figure("absorbed", "J", "energy that the specimen has absorbed in the end", self.absorbed),
            figure("residual_velocity", "m/s", "velocity of the striker in the end", self.residual_velocity),
            figure("threshold_velocity", "m/s", "least velocity of this striker that breaks", self.threshold_velocity),
        ];
        let strain = |strain| figure("strain", "1", "engineering strain all along the specimen in the end", strain);
        figures.extend(self.strain.map(strain));
        figures
    }
}
