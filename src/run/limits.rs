//! Termination of a run at the limits of the material data.

use crate::assemble;
use crate::error::{Error, Result, RunError};
use crate::law::{Limit, Passed, Reached};
use crate::material::Material;
use crate::record::{self, AuditRow, Stepped};
use crate::scene::Scene;
use crate::solver::moc::PointAtLimit;

/// Point of the bar that has reached a limit of the data of its material.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct AtLimit {
    pub segment: usize,
    /// Time, s.
    pub time: f64,
    /// Position, m.
    pub x: f64,
    pub reached: Reached,
}

impl From<&PointAtLimit> for AtLimit {
    fn from(point: &PointAtLimit) -> Self {
        let PointAtLimit { segment, time, x, reached } = *point;
        Self { segment, time, x, reached }
    }
}

impl AtLimit {
    /// Converts a point of a grid with these cell centres (m) and this time step (s).
    pub fn on_grid(passed: &Passed, centres: &[f64], dt: f64) -> Self {
        let Passed { cell, segment, step, reached } = *passed;
        Self { segment, time: step as f64 * dt, x: centres[cell], reached }
    }

    /// Returns the end or joint that is suddenly loaded beyond the data at t = 0, if there is one.
    pub fn at_start(scene: &Scene) -> Option<Self> {
        let fan = assemble::starts_beyond_data(scene)?;
        let (limit, equivalent) = (Limit::EndOfData(fan.sense), fan.fan.strain);
        let reached = Reached { limit, strain: fan.sense.sign() * equivalent, equivalent };
        Some(Self { segment: fan.segment, time: 0.0, x: fan.x, reached })
    }

    fn material(self, scene: &Scene) -> &Material {
        &scene.bar.segments[self.segment].material
    }

    /// Returns whether the run must stop here because the material has no data beyond the limit.
    pub fn stops(self, scene: &Scene) -> bool {
        self.reached.limit.stops(self.material(scene))
    }

    /// Returns the error with which the run stops here.
    pub fn error(self, scene: &Scene) -> Error {
        let (reason, help) = record::at_limit(&self.reached, self.material(scene));
        RunError { reason, time: self.time, x: Some(self.x), help: help.to_owned() }.into()
    }

    /// Returns the row of the audit if the run continues and the point has failed. The failure is due to its own strain, not to earlier strain in the
    /// other sense.
    pub fn broken(self, scene: &Scene) -> Option<AuditRow> {
        let Limit::EndOfData(sense) = self.reached.limit else { return None };
        (!self.stops(scene)).then(|| record::past_data(sense, self.time, self.x, self.material(scene)))
    }
}

/// Checks that runs of the scene do not stop at t = 0.
///
/// # Errors
/// A [`RunError`] if a sudden load strains the bar beyond the data of its curve at once.
pub(crate) fn check_start(scene: &Scene) -> Result<()> {
    let stop = AtLimit::at_start(scene).filter(|limit| limit.stops(scene));
    stop.map_or(Ok(()), |limit| Err(limit.error(scene)))
}

/// Returns the points at which a bar on a grid reached a limit, in order of time.
pub(super) fn limits(bar: &impl Stepped) -> Vec<AtLimit> {
    let (centres, dt) = (bar.grid().centres(), bar.grid().dt);
    bar.limits_reached().in_order().map(|passed| AtLimit::on_grid(&passed, &centres, dt)).collect()
}
