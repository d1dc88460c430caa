//! Saves and restores the state of a bar on the staggered grid, for checkpoints.

use super::end_node::EndNode;
use super::leapfrog::Leapfrog;
use crate::snapshot::{Result, Snapshot, pack, unpack};

impl Snapshot for Leapfrog {
    fn save(&self) -> Result<Vec<u8>> {
        let broken = self.rupture.as_ref().map(|breaking| breaking.state());
        let ends = [&self.left, &self.right].map(EndNode::state);
        pack(&(
            self.step,
            &self.blocks,
            &self.edges,
            &self.contacts,
            ends,
            &self.fans,
            self.lost_to_fans,
            broken,
            &self.implicit,
        ))
    }

    fn restore(&mut self, saved: &[u8]) -> Result<()> {
        let ([left, right], broken, implicit);
        (
            self.step,
            self.blocks,
            self.edges,
            self.contacts,
            [left, right],
            self.fans,
            self.lost_to_fans,
            broken,
            implicit,
        ) = unpack(saved)?;
        if let (Some(breaking), Some(broken)) = (&mut self.rupture, broken) {
            breaking.restore(broken);
            for (gone, end) in breaking.ends_gone().into_iter().zip([&mut self.left, &mut self.right]) {
                if gone {
                    end.release();
                }
            }
        }
        self.left.restore(left);
        self.right.restore(right);
        if let (Some(nodes), Some(implicit)) = (&mut self.implicit, implicit) {
            nodes.restore(implicit);
        }
        Ok(())
    }
}
