//! Pauses of a run between two steps: reports progress, stops on request, writes checkpoints and resumes from them.

use std::time::Instant;

use super::Run;
use crate::error::{Error, Result};
use crate::record::Stepped;
use crate::record::store::Checkpoint;
use crate::run::Progress;
use crate::snapshot::{self, Snapshot, join, pack, split, unpack};

impl<S: Stepped + Snapshot> Run<'_, S> {
    /// Reports progress, and writes a checkpoint if one is due. Everything of the current step has been recorded except for frames.
    pub(super) fn pause(&mut self) -> Result<()> {
        let (step, steps, cells) = (self.bar.step(), self.steps, self.bar.grid().cells());
        let flow = (self.progress)(Progress::Steps { step, steps, cells });
        if self.recorder.checkpoint_is_due() {
            self.keep_checkpoint()?;
        }
        self.latest_call = Instant::now();
        if flow.is_break() { Err(Error::Interrupted) } else { Ok(()) }
    }

    /// Writes a checkpoint. The histories are passed to the writer first, so that the checkpoint need not contain them.
    pub(super) fn keep_checkpoint(&mut self) -> Result<()> {
        if !self.recorder.keeps_checkpoints() {
            return Ok(());
        }
        self.write_traces()?;
        let state = self.save();
        self.recorder.keep_checkpoint(state)
    }

    /// Continues from a checkpoint.
    pub(super) fn resume(&mut self, checkpoint: &Checkpoint) -> Result<()> {
        let restored = self.restore(&checkpoint.state);
        self.resumed = true;
        self.recorder.resume(checkpoint, restored)
    }
}

/// State of a run between two steps. The limits that have been reached follow from the state of the bar.
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
            pack(&(&self.response_recorder, self.recorder.stepping, &self.recorder.tally, self.traces.waiting()))?,
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
        let waiting;
        (self.response_recorder, self.recorder.stepping, self.recorder.tally, waiting) = unpack(rest)?;
        self.traces.restore(waiting);
        Ok(())
    }
}
