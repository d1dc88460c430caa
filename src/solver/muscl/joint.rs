//! Joints between segments: a Riemann problem between two media, or two faces in unilateral contact, see [`crate::bar::joint`].

use serde::{Deserialize, Serialize};

use super::block::Block;
use super::face::{response, under};
use super::part::Part;
use crate::bar::joint::{Contact, force_at};
use crate::bar::{self, SuddenLoad};
use crate::wave::riemann::{FaceState, Flux, Point, Side, Star, Workspace, solve};

/// A joint.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(super) struct Joint {
    /// Index of the block to its left.
    pub edge: usize,
    /// State of the contact; `None` if the joint is bonded.
    contact: Option<Contact>,
    /// Force on the faces in the previous step, N. A force that lasts for one step only comes from waves that the cells beside the joint have mixed,
    /// and does not count as a peak.
    before: f64,
}

impl Joint {
    pub fn new(joint: bar::Joint, edge: usize) -> Self {
        Self { edge, contact: Contact::new(joint), before: 0.0 }
    }

    /// Applies a sudden load at t = 0 to the faces; see [`Contact::load`].
    pub fn load(&mut self, load: SuddenLoad, force: f64) {
        self.contact.iter_mut().for_each(|contact| contact.load(load, force));
    }

    /// Displacement of the right face relative to the left one since the start, m.
    pub fn jump(&self) -> f64 {
        self.contact.map_or(0.0, |contact| contact.jump())
    }

    /// Returns whether there is a gap between the faces.
    pub fn is_apart(&self) -> bool {
        self.contact.is_some_and(|contact| contact.gap() > 0.0)
    }

    /// Returns the contact of a joint that can open; `None` if the joint is bonded.
    pub fn contact(&self) -> Option<&Contact> {
        self.contact.as_ref()
    }

    /// Sets the ghost cells of both sides: as at free ends if the cells pull at each other, otherwise with the elastic gradients for a common force
    /// and velocity at the joint. Whether the joint was open in the previous step is not used: for faces that only touch, rounding decides that.
    pub fn share(&self, dt: f64, left: &mut Block, right: &mut Block, parts: &[Part]) {
        let (a, b) = (&parts[left.part], &parts[right.part]);
        let (i, j) = (left.inside(1, 0), right.inside(0, 0));
        let (s, v) = ([left.sigma[i], right.sigma[j]], [left.v[i], right.v[j]]);
        let near = |k: usize| Point { stress: s[k], velocity: v[k], ..Point::default() };
        let bars = [response(a, &near(0), -1.0), response(b, &near(1), 1.0)];
        if self.contact.is_some_and(|contact| force_at(contact.closing_rate(dt), &bars) <= 0.0) {
            left.fill_ghost_cells(1, a, [-s[0], v[0], -left.e_equivalent_strain(a, i)]);
            right.fill_ghost_cells(0, b, [-s[1], v[1], -right.e_equivalent_strain(b, j)]);
            return;
        }
        let pull = 2.0 * (b.area * s[1] - a.area * s[0]) / (a.cell_mass() + b.cell_mass());
        let soft = |part: &Part| part.dx / (part.modulus * part.area);
        let loading = 2.0 * (v[1] - v[0]) / (soft(a) + soft(b));
        let (rise_a, rise_b) = (pull * a.cell_mass() / a.area, pull * b.cell_mass() / b.area);
        left.fill_ghost_cells(1, a, [s[0] + rise_a, v[0] + loading * soft(a), left.e_equivalent_strain(a, i) + rise_a]);
        right.fill_ghost_cells(
            0,
            b,
            [s[1] - rise_b, v[1] - loading * soft(b), right.e_equivalent_strain(b, j) - rise_b],
        );
    }

    /// Returns the fluxes through the left and the right face in a step; `known` are those behind fans.
    pub fn step_flux(
        &mut self,
        dt: f64,
        parts: [&Part; 2],
        near: &[FaceState; 2],
        known: Option<[Flux; 2]>,
        work: &mut Workspace,
    ) -> [Flux; 2] {
        let apart = self.is_apart();
        let Some(contact) = &mut self.contact else {
            return known.unwrap_or_else(|| closed_fluxes(0.0, parts, near, work));
        };
        let free = [under(0.0, -1.0, parts[0], &near[0], work), under(0.0, 1.0, parts[1], &near[1], work)];
        let is_known = known.is_some();
        let closed = known.unwrap_or_else(|| closed_fluxes(contact.closing_rate(dt), parts, near, work));
        let force = -closed[0].stress * parts[0].area;
        if !contact.advance(dt, force, free[1].velocity - free[0].velocity) {
            if self.before > 0.0 {
                contact.record_single_step(self.before);
            }
            self.before = 0.0;
            return free;
        }
        if apart {
            contact.add_lost_energy(force, dt * (closed[0].velocity - closed[1].velocity));
        }
        contact.record_force(dt, force, if is_known { f64::INFINITY } else { self.before });
        self.before = force;
        closed
    }
}

/// Returns the fluxes of two sides that move together while their gap grows at `rate` (m/s).
fn closed_fluxes(rate: f64, [a, b]: [&Part; 2], [left, right]: &[FaceState; 2], work: &mut Workspace) -> [Flux; 2] {
    let half = 0.5 * rate;
    let bars = [response(a, &left.point, -1.0), response(b, &right.point, 1.0)];
    let force = force_at(rate, &bars);
    let elastic = a.faces.stays_elastic(left, -force / a.area) && b.faces.stays_elastic(right, -force / b.area);
    // As for a bonded joint whose sides each move towards the other by an additional half of the rate.
    let (force, velocity) = if elastic {
        let (from_left, from_right) = (half - bars[0].velocity(force), bars[1].velocity(force) - half);
        (force, 0.5 * (from_left + from_right))
    } else {
        let (mut left, mut right) = (a.faces.placed(left), b.faces.placed(right));
        left.point.velocity += half;
        right.point.velocity -= half;
        let star = solve(Side::Face(&a.faces.medium, &left), Side::Face(&b.faces.medium, &right), work);
        (-star.force, together(&star, work))
    };
    [
        Flux { stress: -force / a.area, velocity: velocity - half },
        Flux { stress: -force / b.area, velocity: velocity + half },
    ]
}

/// Velocity of the joint. If a level curve caps the force, the side that could carry more moves with the joint, and the velocity jump strains the
/// other side.
fn together(star: &Star, work: &Workspace) -> f64 {
    let (left, right) = (star.velocity_left, star.velocity_right);
    let carries = [&work.left, &work.right].map(|path| path.cap() * path.area());
    if star.capped && carries[0] > carries[1] {
        left
    } else if star.capped && carries[1] > carries[0] {
        right
    } else {
        0.5 * (left + right)
    }
}
