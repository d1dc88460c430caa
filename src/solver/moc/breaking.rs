//! The fracture criterion at a point of the bar.

use crate::law::rupture::{Cause, Criteria, Criterion, Rupture, Strained};
use crate::wave::riemann::{Medium, Point};

/// Fracture criteria and fractures of a bar.
#[derive(Debug, Clone)]
pub(super) struct Breaking {
    pub criteria: Criteria,
    pub found: Vec<Rupture>,
}

/// Segment of a side, its state, and the state that would follow.
pub(super) type Answer = (u32, Point, Point);

impl Breaking {
    pub fn new(criteria: Criteria) -> Self {
        Self { criteria, found: Vec::new() }
    }

    /// Returns whether the state that would follow fractures a side. Strain that would gather there without bound (`gathers`) does, unless only the
    /// stress counts. Otherwise, material that has yielded and unloaded fractures only when it yields again.
    pub fn breaks(&self, &(segment, before, after): &Answer, medium: &Medium, notch: f64, gathers: bool) -> bool {
        let criterion = &self.criteria.segments[segment as usize];
        if after.stress <= medium.round_off {
            return false;
        }
        if gathers && criterion.met_by_unbounded_strain() {
            return true;
        }
        let loads = after.stress - before.stress > medium.round_off;
        let flows = after.accumulated > before.accumulated || after.accumulated == 0.0;
        let stress_counts = criterion.cause() == Cause::Spall;
        loads && (flows || stress_counts) && Criterion::is_met(criterion.share(&strained(medium, &after)), notch)
    }
}

pub(super) fn strained(medium: &Medium, point: &Point) -> Strained {
    Strained { stress: point.stress, plastic: point.plastic, work: 2.0 * medium.modulus * point.work }
}
