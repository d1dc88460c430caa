//! Two segments that meet: bonded, or in a joint that carries no tension.
//!
//! With f and g arriving from the left and from the right, and Y = A Z, the sides of a joint that holds together obey
//! `F - Y_l v_l = A_l f - D_l` and `F + Y_r v_r = A_r g - D_r`, D being A/4 of what the border node of a side flows in the
//! step: half of it before and half after the moment at which F and v hold. What leaves is `2 F/A - f` and `2 F/A - g`.

use serde::{Deserialize, Serialize};

use super::part::{Part, Work};
use crate::bar::Joint as Kind;
use crate::law::rate::{Flow, History};

/// What leaves a joint: g into the left segment and f into the right one.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Passed {
    pub to_left: f64,
    pub to_right: f64,
}

/// The joint between two neighbouring segments.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(super) struct Joint {
    /// Of a joint that can open: its distance at the start, and now, m, >= 0.
    contact: Option<[f64; 2]>,
    /// Energy lost where its sides met, J.
    lost: f64,
}

/// One side of a joint.
struct Side<'a> {
    part: &'a Part,
    /// Its border node.
    node: usize,
    /// Share of its plastic flow by which its stress falls: none at a rigid neighbour, all of it at a free end.
    share: f64,
}

impl Side<'_> {
    fn flow(&self, force: f64, dt: f64) -> (Flow, History) {
        self.part.borders.flow(&self.part.law, self.node, force / self.part.area, self.share, [1.0, dt])
    }

    /// The force after a flow.
    fn after(&self, force: f64, flow: Flow) -> f64 {
        force - self.part.area * self.share * flow.plastic
    }
}

impl Joint {
    pub fn new(kind: Kind) -> Self {
        let contact = if let Kind::Contact { gap } = kind { Some([gap, gap]) } else { None };
        Self { contact, lost: 0.0 }
    }

    /// One step.
    pub fn pass(&mut self, left: &mut Part, right: &mut Part, dt: f64) -> Passed {
        let Some([_, gap]) = &mut self.contact else { return hold(left, right, 0.0, dt).0 };
        // Velocities of free sides; they flow next to nothing without stress.
        let (v_left, v_right) = (-left.arriving(1) / left.impedance, right.arriving(0) / right.impedance);
        let ahead = *gap + dt * (v_right - v_left);
        if ahead >= 0.0 {
            *gap = ahead;
            return part_ways(left, right, dt);
        }
        let opening = -*gap / dt;
        *gap = 0.0;
        let (passed, force) = hold(left, right, opening, dt);
        self.lost += force * opening * dt;
        passed
    }

    /// How much farther apart the sides are than at the start, m.
    pub fn opened(&self) -> f64 {
        self.contact.map_or(0.0, |[start, gap]| gap - start)
    }

    /// Energy lost where the sides met, J.
    pub fn lost(&self) -> f64 {
        self.lost
    }
}

/// Sides that hold together, or come together with relative velocity `opening` (<= 0); and the force between them.
///
/// The sides flow one after the other; the mean of both orders keeps mirror images alike.
fn hold(left: &mut Part, right: &mut Part, opening: f64, dt: f64) -> (Passed, f64) {
    let (y_left, y_right) = (left.area * left.impedance, right.area * right.impedance);
    let sum = y_left + y_right;
    let last = left.f.len();
    let (from_left, from_right) = (left.arriving(1), right.arriving(0));
    let force = (y_right * (left.area * from_left) + y_left * (right.area * from_right)) / sum
        - y_left * y_right * opening / sum;
    let sides = [
        Side { node: last, share: 0.5 * y_right / sum, part: &*left },
        Side { node: 0, share: 0.5 * y_left / sum, part: &*right },
    ];
    let [(flow_left, left_history), (flow_right, right_history)] = flow_of_both(&sides, force, dt);
    let kept = y_right * (0.25 * left.area * flow_left.plastic) + y_left * (0.25 * right.area * flow_right.plastic);
    let force = force - kept / sum;
    account(left, last, force, flow_left, left_history);
    account(right, 0, force, flow_right, right_history);
    let passed =
        Passed { to_left: 2.0 * force / left.area - from_left, to_right: 2.0 * force / right.area - from_right };
    (passed, force)
}

/// Sides that do not touch: free ends.
fn part_ways(left: &mut Part, right: &mut Part, dt: f64) -> Passed {
    let passed = Passed { to_left: -left.arriving(1), to_right: -right.arriving(0) };
    let last = left.f.len();
    for (part, node) in [(left, last), (right, 0)] {
        let (flow, history) = part.borders.flow(&part.law, node, 0.0, 0.0, [1.0, dt]);
        account(part, node, 0.0, flow, history);
    }
    passed
}

/// Plastic flow of both sides and their histories.
fn flow_of_both([a, b]: &[Side<'_>; 2], force: f64, dt: f64) -> [(Flow, History); 2] {
    let (a_first, b_first) = (a.flow(force, dt), b.flow(force, dt));
    if a_first.0.plastic == 0.0 || b_first.0.plastic == 0.0 {
        // Where one side does not flow, the other's flow only takes it farther from flowing.
        return [a_first, b_first];
    }
    let a_second = a.flow(b.after(force, b_first.0), dt);
    let b_second = b.flow(a.after(force, a_first.0), dt);
    [mean(a, a_first, a_second), mean(b, b_first, b_second)]
}

fn mean(side: &Side<'_>, one: (Flow, History), other: (Flow, History)) -> (Flow, History) {
    let flow = Flow {
        plastic: 0.5 * (one.0.plastic + other.0.plastic),
        overstress: 0.5 * (one.0.overstress + other.0.overstress),
    };
    (flow, side.part.law.mean(&one.1, &other.1))
}

/// Books the flow of one side; the border of a joint is half a node.
fn account(part: &mut Part, node: usize, force: f64, flow: Flow, history: History) {
    if flow.plastic != 0.0 {
        let work = Work { total: 0.5 * force / part.area * flow.plastic, overstress: 0.5 * flow.overstress };
        part.work.add(work);
        part.borders.set(&part.law, node, history);
    }
}
