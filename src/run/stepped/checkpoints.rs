//! Pauses of a run between two steps: reports progress, stops on request, writes checkpoints and resumes from them.

use std::path::Path;
use std::time::{Duration, Instant};

use super::Run;
use crate::error::{Error, Result};
use crate::record::Stepped;
use crate::record::store::{Checkpoint, checksum};
use crate::run::Progress;
use crate::scene::Scene;
use crate::snapshot::{self, Snapshot, join, pack, split, unpack};

/// Schedule of the checkpoints of a run.
pub(super) struct Checkpoints {
    /// Wall time between two of them.
    every: Duration,
    latest: Instant,
    /// Of the resolved scene.
    checksum: u32,
}

impl Checkpoints {
    pub fn new(every: Duration, scene: &Scene) -> Self {
        Self { every, latest: Instant::now(), checksum: checksum(&scene.resolved_json().to_string()) }
    }
}

impl<S: Stepped + Snapshot> Run<'_, S> {
    /// Reports progress; writes a checkpoint if one is due or the run is asked to stop. Everything of the current step has been recorded
    /// except for frames.
    pub(super) fn pause(&mut self) -> Result<()> {
        let (step, steps, cells) = (self.bar.step(), self.steps, self.bar.grid().cells());
        let stops = (self.progress)(Progress::Steps { step, steps, cells }).is_break();
        if self.checkpoints.as_ref().is_some_and(|kept| stops || kept.latest.elapsed() >= kept.every) {
            self.keep_checkpoint()?;
        }
        self.latest_call = Instant::now();
        if stops { Err(Error::Interrupted) } else { Ok(()) }
    }

    /// Histories go to the writer first, so that the checkpoint need not hold them.
    fn keep_checkpoint(&mut self) -> Result<()> {
        self.write_traces()?;
        let state = self.save().map_err(|e| Error::file(Path::new(&self.recorder.output), e))?;
        let (Some(kept), Some(writer)) = (&mut self.checkpoints, &mut self.recorder.writer) else { return Ok(()) };
        kept.latest = Instant::now();
        writer.checkpoint(Checkpoint {
            scene: kept.checksum,
            estimate_error: self.recorder.scene.solve.estimate_error,
            every: kept.every.as_secs_f64(),
            wall_seconds: self.recorder.started.elapsed().as_secs_f64(),
            state,
            ..Checkpoint::default()
        })
    }

    /// Continues from a checkpoint.
    pub(super) fn resume(&mut self, checkpoint: &Checkpoint) -> Result<()> {
        self.restore(&checkpoint.state).map_err(|e| Error::file(Path::new(&self.recorder.output), e))?;
        let before = Duration::from_secs_f64(checkpoint.wall_seconds);
        self.recorder.started = self.recorder.started.checked_sub(before).unwrap_or(self.recorder.started);
        self.resumed = true;
        Ok(())
    }
}

/// The state of a run between two steps. Where it came to limits follows from that of the bar.
impl<S: Stepped + Snapshot> Snapshot for Run<'_, S> {
    fn save(&self) -> snapshot::Result<Vec<u8>> {
        let probe = self.elastic_check.as_ref().map(|probe| probe.check.save()).transpose()?;
        Ok(join(&[
            self.bar.save()?,
            self.frames.save()?,
            self.ledger.save()?,
            self.tracker.save()?,
            self.audit.save()?,
            probe.unwrap_or_default(),
            pack(&(&self.listener, self.recorder.stepping))?,
        ]))
    }

    fn restore(&mut self, saved: &[u8]) -> snapshot::Result<()> {
        let [bar, frames, ledger, tracker, audit, probe, rest] = split(saved)?;
        self.bar.restore(bar)?;
        self.frames.restore(frames)?;
        self.ledger.restore(ledger)?;
        self.tracker.restore(tracker)?;
        self.audit.restore(audit)?;
        if let Some(own) = &mut self.elastic_check {
            own.check.restore(probe)?;
        }
        (self.listener, self.recorder.stepping) = unpack(rest)?;
        Ok(())
    }
}
