//! Pauses of a run between two events: reports progress, stops on request, writes checkpoints and resumes from them.

use std::ops::ControlFlow;

use super::Run;
use crate::error::{Error, Result};
use crate::record::store::Checkpoint;
use crate::run::Progress;
use crate::snapshot::{self, Snapshot, join, pack, split, unpack};

impl Run<'_> {
    /// Reports the progress of the run.
    pub(super) fn report(&mut self) -> ControlFlow<()> {
        (self.progress)(Progress::Fronts {
            time: self.bar.time(),
            until: self.recorder.scene.solve.until,
            events: self.bar.events(),
            fronts: self.bar.front_count(),
        })
    }

    /// Reports progress, and writes a checkpoint if one is due. Everything up to the current time has been recorded.
    pub(super) fn pause(&mut self) -> Result<()> {
        let flow = self.report();
        if self.recorder.checkpoint_is_due() {
            self.keep_checkpoint()?;
        }
        if flow.is_break() { Err(Error::Interrupted) } else { Ok(()) }
    }

    /// Writes a checkpoint. The histories are part of it and are not passed to the writer: histories of the ends omit steps of zero duration, and
    /// further events at the current time may follow.
    pub(super) fn keep_checkpoint(&mut self) -> Result<()> {
        if !self.recorder.keeps_checkpoints() {
            return Ok(());
        }
        let state = self.save();
        self.recorder.keep_checkpoint(state)
    }

    /// Continues from a checkpoint.
    pub(super) fn resume(&mut self, checkpoint: &Checkpoint) -> Result<()> {
        let restored = self.restore(&checkpoint.state);
        self.recorder.resume(checkpoint, restored)
    }
}

/// State of a run between two events. The pauses follow from the scene; only the number of those that remain is saved.
impl Snapshot for Run<'_> {
    fn save(&self) -> snapshot::Result<Vec<u8>> {
        let probe = self.elastic_check.as_ref().map(Snapshot::save).transpose()?;
        let histories = (&self.gauges, &self.ends, &self.response_recorder);
        let fronts = (&self.fronts, &self.paths, &self.breaks, self.yielded);
        Ok(join(&[
            self.bar.save()?,
            self.ledger.save()?,
            self.audit.as_ref().map(Snapshot::save).transpose()?.unwrap_or_default(),
            probe.unwrap_or_default(),
            pack(&(self.pauses.len(), self.recorder.stepping, &self.recorder.tally, histories, fronts))?,
        ]))
    }

    fn restore(&mut self, saved: &[u8]) -> snapshot::Result<()> {
        let [bar, ledger, audit, probe, rest] = split(saved)?;
        self.bar.restore(bar)?;
        self.ledger.restore(ledger)?;
        if let Some(own) = &mut self.audit {
            own.restore(audit)?;
        }
        if let Some(own) = &mut self.elastic_check {
            own.restore(probe)?;
        }
        let pauses;
        (
            pauses,
            self.recorder.stepping,
            self.recorder.tally,
            (self.gauges, self.ends, self.response_recorder),
            (self.fronts, self.paths, self.breaks, self.yielded),
        ) = unpack(rest)?;
        self.pauses.truncate(pauses);
        Ok(())
    }
}
