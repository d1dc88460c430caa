//! Joints between segments: a Riemann problem between two media, or two faces that touch and part.
//!
//! A step takes two faces that carry no tension on as free ones. Where the right one would end up to the left of the left
//! one, a push between them takes both to one place at the end of the step. What faces that meet lose of their energy is
//! of the first order in the cell size: it is booked.

use serde::{Deserialize, Serialize};

use super::block::Block;
use super::stepping::Part;
use crate::bar;
use crate::wave::riemann::{Flux, Near, Side, Workspace, solve};

/// A joint.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(super) struct Joint {
    /// The block to its left.
    pub edge: usize,
    /// Distance of the faces, m; none where they are bonded.
    gap: Option<f64>,
    start: f64,
    /// No force goes through it at present.
    open: bool,
    /// Lost by faces that met, J.
    pub lost: f64,
}

impl Joint {
    pub fn new(joint: bar::Joint, edge: usize) -> Self {
        let gap = if let bar::Joint::Contact { gap } = joint { Some(gap) } else { None };
        Self { edge, gap, start: gap.unwrap_or(0.0), open: gap.is_some_and(|gap| gap > 0.0), lost: 0.0 }
    }

    /// Displacement of the right face against the left one since the start, m.
    pub fn jump(&self) -> f64 {
        self.gap.unwrap_or(0.0) - self.start
    }

    /// Gives both sides what seems to lie beyond: as free ends if it is open, else with the gradients that one force and
    /// one velocity at the joint ask for, elastically.
    pub fn share(&self, left: &mut Block, right: &mut Block, parts: &[Part]) {
        let (a, b) = (&parts[left.part], &parts[right.part]);
        let (i, j) = (left.inside(1, 0), right.inside(0, 0));
        let (s, v) = ([left.sigma[i], right.sigma[j]], [left.v[i], right.v[j]]);
        if self.open {
            left.go_on(1, a, [-s[0], v[0], -left.reach(a, i)]);
            right.go_on(0, b, [-s[1], v[1], -right.reach(b, j)]);
            return;
        }
        let pull = 2.0 * (b.area * s[1] - a.area * s[0]) / (a.cell_mass() + b.cell_mass());
        let soft = |part: &Part| part.dx / (part.modulus * part.area);
        let loading = 2.0 * (v[1] - v[0]) / (soft(a) + soft(b));
        let (rise_a, rise_b) = (pull * a.cell_mass() / a.area, pull * b.cell_mass() / b.area);
        left.go_on(1, a, [s[0] + rise_a, v[0] + loading * soft(a), left.reach(a, i) + rise_a]);
        right.go_on(0, b, [s[1] - rise_b, v[1] - loading * soft(b), right.reach(b, j) - rise_b]);
    }

    /// What goes through its left and its right face in a step.
    pub fn settle(&mut self, dt: f64, parts: [&Part; 2], near: &[Near; 2], work: &mut Workspace) -> [Flux; 2] {
        let Some(gap) = self.gap else { return meeting(0.0, parts, near, work) };
        let free = [free(parts[0], &near[0], 1.0, work), free(parts[1], &near[1], -1.0, work)];
        let closed = meeting(gap / dt, parts, near, work);
        let opening = free[1].velocity - free[0].velocity;
        self.open = gap + dt * opening >= 0.0 || closed[0].stress >= 0.0;
        if self.open {
            self.gap = Some((gap + dt * opening).max(0.0));
            return free;
        }
        self.gap = Some(0.0);
        self.lost -= closed[0].stress * parts[0].area * gap;
        closed
    }
}

/// Both sides together; the faces come closer by `closing` (m/s).
fn meeting(closing: f64, [a, b]: [&Part; 2], [left, right]: &[Near; 2], work: &mut Workspace) -> [Flux; 2] {
    let half = 0.5 * closing;
    let (soft_a, soft_b) = (1.0 / (a.area * impedance(a)), 1.0 / (b.area * impedance(b)));
    let apart = (right.point.velocity - left.point.velocity) + closing;
    let held = soft_a * a.area * left.point.stress + soft_b * b.area * right.point.stress;
    let force = (apart + held) / (soft_a + soft_b);
    let stresses = [force / a.area, force / b.area];
    let elastic = a.faces.stays_elastic(left, stresses[0]) && b.faces.stays_elastic(right, stresses[1]);
    let (force, from_left, from_right) = if elastic {
        let from_left = left.point.velocity - half + soft_a * (force - a.area * left.point.stress);
        (force, from_left, right.point.velocity + half - soft_b * (force - b.area * right.point.stress))
    } else {
        let (mut left, mut right) = (a.faces.placed(left), b.faces.placed(right));
        left.point.velocity -= half;
        right.point.velocity += half;
        let star = solve(Side::Face(&a.faces.medium, &left), Side::Face(&b.faces.medium, &right), work);
        (star.force, star.velocity_left, star.velocity_right)
    };
    let middle = 0.5 * (from_left + from_right);
    [Flux { stress: force / a.area, velocity: middle + half }, Flux { stress: force / b.area, velocity: middle - half }]
}

/// A face under no force, with outward normal `normal`.
fn free(part: &Part, near: &Near, normal: f64, work: &mut Workspace) -> Flux {
    let point = &near.point;
    if part.faces.stays_elastic(near, 0.0) {
        return Flux { stress: 0.0, velocity: point.velocity - normal * point.stress / impedance(part) };
    }
    let sense = if point.stress > 0.0 { -1.0 } else { 1.0 };
    work.left.fill_at_face(&part.faces.medium, &part.faces.placed(near), sense);
    Flux { stress: 0.0, velocity: point.velocity + normal * sense * work.left.velocity(0.0) }
}

fn impedance(part: &Part) -> f64 {
    part.faces.medium.impedance()
}
