//! Checkpoints of a run, independent of the method: when they are due, and their content in addition to the state of the solver.

use std::path::Path;
use std::time::{Duration, Instant};

use super::{RunRecorder, Target};
use crate::error::{Error, Result};
use crate::record::store::{Checkpoint, checksum};
use crate::scene::Scene;
use crate::snapshot::{self, pack};

/// Schedule of the checkpoints of a run.
pub(super) struct Checkpoints {
    /// Wall time between two checkpoints.
    every: Duration,
    latest: Instant,
    /// Checksum of the resolved scene.
    checksum: u32,
    /// Selected effects and method, serialized.
    chosen: snapshot::Result<Vec<u8>>,
}

impl Checkpoints {
    /// Returns the schedule; `None` if the run writes no checkpoints.
    pub fn of(target: &Target<'_>, scene: &Scene) -> Option<Self> {
        let every = target.every?;
        let checksum = checksum(&scene.resolved_json().to_string());
        Some(Self { every, latest: Instant::now(), checksum, chosen: pack(&target.chosen) })
    }
}

impl RunRecorder<'_> {
    /// Returns whether the run writes checkpoints.
    pub fn keeps_checkpoints(&self) -> bool {
        self.checkpoints.is_some()
    }

    /// Returns whether the next checkpoint is due.
    pub fn checkpoint_is_due(&self) -> bool {
        self.checkpoints.as_ref().is_some_and(|kept| kept.latest.elapsed() >= kept.every)
    }

    /// Saves the state of a run, consistent with the data passed to the writer so far.
    pub fn keep_checkpoint(&mut self, state: snapshot::Result<Vec<u8>>) -> Result<()> {
        let (Some(kept), Some(writer)) = (&mut self.checkpoints, self.writer.writer()) else { return Ok(()) };
        let failed = |e| Error::file(Path::new(&self.output), e);
        kept.latest = Instant::now();
        writer.checkpoint(Checkpoint {
            scene: kept.checksum,
            estimate_error: self.scene.solve.estimate_error,
            every: kept.every.as_secs_f64(),
            wall_seconds: self.started.elapsed().as_secs_f64(),
            chosen: kept.chosen.clone().map_err(failed)?,
            state: state.map_err(failed)?,
            ..Checkpoint::default()
        })
    }

    /// Continues after a checkpoint; `restored` is the result of restoring the state of the run.
    pub fn resume(&mut self, checkpoint: &Checkpoint, restored: snapshot::Result<()>) -> Result<()> {
        restored.map_err(|e| Error::file(Path::new(&self.output), e))?;
        let before = Duration::try_from_secs_f64(checkpoint.wall_seconds).unwrap_or_default();
        self.started = self.started.checked_sub(before).unwrap_or(self.started);
        Ok(())
    }
}
