//! Paths and faces of elements in parallel, see [`crate::law::Reversals`]: their branches are the curve doubled in size.

use super::Workspace;
use super::face::{FaceState, Faces, Flux};
use super::medium::{Medium, Point};
use super::path::Path;
use crate::law::Reversals;

impl Path {
    /// Builds the path from the start on: the elastic line to the point of last flow, or back from there, then branch after branch. Slopes
    /// fall along it.
    pub(super) fn fill_overlay(&mut self, medium: &Medium, reversals: &Reversals) {
        let (sense, lines) = (self.sense(), medium.lines(1.0));
        let mut branch = *reversals;
        branch.turn(lines, sense);
        let tip = branch.tip();
        let back = sense * (branch.stress_at(lines, tip) - self.start_stress());
        self.begin(sense * tip - back);
        loop {
            let at_tip = (sense * branch.curve_abscissa(branch.tip())).max(0.0);
            for line in lines.at(at_tip)..lines.z.len() {
                let z = lines.z[line].max(at_tip);
                if sense * (branch.branch_point(sense, z, 0.0).0 - branch.end(sense)) >= 0.0 && z > at_tip {
                    break;
                }
                let y = lines.y[line] + lines.slope[line] * (z - lines.z[line]);
                let (strain, stress) = branch.branch_point(sense, z, y);
                self.go_along(sense * stress, sense * strain, lines.slope[line], lines.compliance[line]);
            }
            if !branch.pass_end(lines, sense) {
                break;
            }
        }
    }
}

impl Faces {
    /// Returns sense * stress up to which a side stays elastic, Pa.
    pub(super) fn overlay_limit(&self, near: &FaceState, sense: f64) -> f64 {
        let (own, range) = (sense * near.point.stress, self.yield_stress());
        if near.flowing == sense {
            own
        } else if near.flowing == -sense {
            own + 2.0 * range
        } else {
            own.max(sense * near.point.back + range)
        }
    }

    pub(super) fn overlay(&self, left: &FaceState, right: &FaceState, work: &mut Workspace) -> Flux {
        let elastic = self.elastic(left, right);
        if self.stays_elastic(left, elastic.stress) && self.stays_elastic(right, elastic.stress) {
            return elastic;
        }
        self.general(left, right, work)
    }

    /// Returns the reversals of a side after it has reached its stress.
    pub(super) fn reversals(&self, near: &FaceState) -> Reversals {
        let (mut reversals, stress, range) = (near.reversals, near.point.stress, self.yield_stress());
        let outside = stress - near.point.back;
        let sense = if near.flowing == 0.0 { 1.0_f64.copysign(outside) } else { near.flowing };
        if near.flowing != 0.0 || outside.abs() > range {
            let lines = self.medium.lines(1.0);
            reversals.flow_to_stress(lines, |y| lines.z_at(y), sense, stress, range);
        }
        reversals
    }

    /// Implements [`Faces::before`] for overlays.
    pub(super) fn overlay_before(&self, near: FaceState, gained: f64, outward: f64, path: &mut Path) -> FaceState {
        let (sense, stress) = (near.flowing, near.point.stress);
        let start = FaceState { point: Point { stress: stress - sense * gained, ..near.point }, ..near };
        path.fill_at_face(&self.medium, &self.placed(&start), sense);
        let change = path.velocity(sense * stress);
        if !change.is_finite() {
            return near;
        }
        let velocity = near.point.velocity - outward * sense * change;
        FaceState { point: Point { velocity, ..start.point }, ..near }
    }
}
