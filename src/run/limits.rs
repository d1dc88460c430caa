//! Termination of a run at the limits of the material data.

use crate::assemble;
use crate::error::{Error, Result, RunError};
use crate::law::{Limit, Passed, Reached};
use crate::material::Material;
use crate::record::{self, AuditRow, Stepped};
use crate::scene::Scene;
use crate::solver::moc::PointAtLimit;

/// A point of the bar at such a limit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct AtLimit {
    pub segment: usize,
    /// s.
    pub time: f64,
    /// m.
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
    /// On a grid with these cell centres (m) and time step (s).
    pub fn on_grid(passed: &Passed, centres: &[f64], dt: f64) -> Self {
        let Passed { cell, segment, step, reached } = *passed;
        Self { segment, time: step as f64 * dt, x: centres[cell], reached }
    }

    /// The end or joint that is suddenly loaded beyond the data at t = 0.
    pub fn at_start(scene: &Scene) -> Option<Self> {
        let fan = assemble::starts_beyond_data(scene)?;
        let (limit, equivalent) = (Limit::EndOfData(fan.sense), fan.fan.strain);
        let reached = Reached { limit, strain: fan.sense.sign() * equivalent, equivalent };
        Some(Self { segment: fan.segment, time: 0.0, x: fan.x, reached })
    }

    fn material(self, scene: &Scene) -> &Material {
        &scene.bar.segments[self.segment].material
    }

    /// Nothing is known from here on.
    pub fn stops(self, scene: &Scene) -> bool {
        self.reached.limit.stops(self.material(scene))
    }

    /// Why the run stops here.
    pub fn error(self, scene: &Scene) -> Error {
        let (reason, help) = record::at_limit(&self.reached, self.material(scene));
        RunError { reason, time: self.time, x: Some(self.x), help: help.to_owned() }.into()
    }

    /// The row of the audit, where the point broke: by its own strain, not by what it was strained in the other sense before.
    pub fn broken(self, scene: &Scene) -> Option<AuditRow> {
        let Limit::EndOfData(sense) = self.reached.limit else { return None };
        (!self.stops(scene)).then(|| record::past_data(sense, self.time, self.x, self.material(scene)))
    }
}

/// Before anything is tried of a scene: every run of it would stop at t = 0.
///
/// # Errors
/// A sudden load strains the bar beyond the data of its curve at once.
pub(crate) fn check_start(scene: &Scene) -> Result<()> {
    let stop = AtLimit::at_start(scene).filter(|limit| limit.stops(scene));
    stop.map_or(Ok(()), |limit| Err(limit.error(scene)))
}

/// Where a bar on a grid came to a limit, in the order of time.
pub(super) fn limits(bar: &impl Stepped) -> Vec<AtLimit> {
    let (centres, dt) = (bar.grid().centres(), bar.grid().dt);
    bar.passed().in_order().map(|passed| AtLimit::on_grid(&passed, &centres, dt)).collect()
}
