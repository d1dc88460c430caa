//! State of a bar stepped by the Godunov scheme, for a checkpoint.

use super::end::End;
use super::stepping::Muscl;
use crate::snapshot::{Result, Snapshot, pack, unpack};

impl Snapshot for Muscl {
    fn save(&self) -> Result<Vec<u8>> {
        pack(&(self.step, &self.blocks, self.ends.each_ref().map(End::state), &self.joints, &self.fans, &self.passed))
    }

    fn restore(&mut self, saved: &[u8]) -> Result<()> {
        let [left, right];
        (self.step, self.blocks, [left, right], self.joints, self.fans, self.passed) = unpack(saved)?;
        self.ends[0].restore(left);
        self.ends[1].restore(right);
        Ok(())
    }
}
