//! State of a characteristic net, for a checkpoint.

use super::end::End;
use super::part::NetSegment;
use super::stepping::Net;
use crate::snapshot::{Result, Snapshot, pack, unpack};

impl Snapshot for Net {
    fn save(&self) -> Result<Vec<u8>> {
        let parts: Vec<_> = self.parts.iter().map(|p| (&p.f, &p.g, &p.centres, &p.borders, p.work)).collect();
        pack(&(self.step, parts, self.ends.each_ref().map(End::state), &self.joints, &self.passed))
    }

    fn restore(&mut self, saved: &[u8]) -> Result<()> {
        let (parts, [left, right]): (Vec<_>, [_; 2]);
        (self.step, parts, [left, right], self.joints, self.passed) = unpack(saved)?;
        for (NetSegment { f, g, centres, borders, work, .. }, saved) in self.parts.iter_mut().zip(parts) {
            (*f, *g, *centres, *borders, *work) = saved;
        }
        self.ends[0].restore(left);
        self.ends[1].restore(right);
        Ok(())
    }
}
