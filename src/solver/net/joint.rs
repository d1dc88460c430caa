//! Two segments bonded together: one force, one velocity, a plastic history on either side.

use super::part::{Part, Work};
use crate::law::rate::{Flow, History};

/// What leaves a joint: g into the left segment and f into the right one.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Passed {
    pub to_left: f64,
    pub to_right: f64,
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
        self.part.borders.flow(&self.part.law, self.node, force / self.part.area, self.share, dt)
    }

    /// The force after a flow.
    fn after(&self, force: f64, flow: Flow) -> f64 {
        force - self.part.area * self.share * flow.plastic
    }
}

/// The joint between two neighbouring segments over one step. `flowed` is set where either side flows.
///
/// With Y = A Z the sides' force obeys `F - Y_l v = A_l f - D_l` and `F + Y_r v = A_r g - D_r`, D being A/4 of the plastic
/// flow of a side: half of it before and half after the moment at which F and v hold. The sides flow one after the
/// other; the mean of both orders keeps mirror images alike.
pub(super) fn pass(left: &mut Part, right: &mut Part, dt: f64) -> Passed {
    let (y_left, y_right) = (left.area * left.impedance, right.area * right.impedance);
    let sum = y_left + y_right;
    let last = left.f.len();
    let (from_left, from_right) = (left.area * left.f[last - 1], right.area * right.g[0]);
    let force = (y_right * from_left + y_left * from_right) / sum;
    let velocity = (from_right - from_left) / sum;
    let sides = [
        Side { node: last, share: 0.5 * y_right / sum, part: &*left },
        Side { node: 0, share: 0.5 * y_left / sum, part: &*right },
    ];
    let [(flow_left, left_history), (flow_right, right_history)] = flow_of_both(&sides, force, dt);
    let held_left = 0.25 * left.area * flow_left.plastic;
    let held_right = 0.25 * right.area * flow_right.plastic;
    let force = force - (y_right * held_left + y_left * held_right) / sum;
    let velocity = velocity + (held_left - held_right) / sum;
    account(left, last, force, flow_left, left_history);
    account(right, 0, force, flow_right, right_history);
    Passed {
        to_left: (force + y_left * velocity - held_left) / left.area,
        to_right: (force - y_right * velocity - held_right) / right.area,
    }
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
