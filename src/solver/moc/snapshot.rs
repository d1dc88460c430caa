//! State of a front-tracking bar, for a checkpoint. Media, limits of the data and tolerances follow from the scene.
//!
//! A binary heap that is restored from its own order keeps that order.

use super::FrontTracking;
use super::end::End;
use crate::law::rupture::{Rupture, Site};
use crate::snapshot::{Result, Snapshot, pack, unpack};

impl Snapshot for FrontTracking {
    fn save(&self) -> Result<Vec<u8>> {
        let clock = (self.now, self.events, self.fronts);
        let limits = (&self.limits.passed, self.limits.stop);
        let fronts = (&self.list, &self.queue, &self.front_segments);
        pack(&(
            clock,
            limits,
            fronts,
            &self.contacts,
            &self.removed_nodes,
            &self.merging,
            self.ruptures(),
            self.ends.each_ref().map(End::state),
        ))
    }

    fn restore(&mut self, saved: &[u8]) -> Result<()> {
        let (ruptures, ends): (Vec<Rupture>, [_; 2]);
        (
            (self.now, self.events, self.fronts),
            (self.limits.passed, self.limits.stop),
            (self.list, self.queue, self.front_segments),
            self.contacts,
            self.removed_nodes,
            self.merging,
            ruptures,
            ends,
        ) = unpack(saved)?;
        let places = self.ends.iter_mut().zip(&mut self.loads).zip([Site::Left, Site::Right]);
        for (((end, load), site), saved) in places.zip(ends) {
            let broken_off = ruptures.iter().any(|rupture| rupture.site == site);
            end.restore(saved, broken_off);
            *load = load.filter(|_| !broken_off);
        }
        if let Some(breaking) = &mut self.rupture {
            breaking.found = ruptures;
        }
        Ok(())
    }
}
