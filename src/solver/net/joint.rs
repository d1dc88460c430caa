//! Two segments that meet: bonded, or in a joint that can open, see [`crate::bar::joint`].
//!
//! With f and g arriving from the left and from the right the sides are `q_l = -A_l f`, `q_r = -A_r g` and `Y = A Z`. Where a border
//! node flows, its side answers with `q + D`, D being A/4 of what it flows in the step: half of it before and half after the moment at
//! which force and velocity hold. What leaves is `-2 p/A - f` and `-2 p/A - g`.

use serde::{Deserialize, Serialize};

use super::part::{INSIDE, Part, Work};
use crate::bar::Joint as Kind;
use crate::bar::ends::Response;
use crate::bar::joint::{Contact, force_at, free_rate};
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
    /// None where it is bonded.
    contact: Option<Contact>,
}

/// One side of a joint.
struct Side<'a> {
    part: &'a Part,
    /// Its border node.
    node: usize,
    /// Share of its plastic flow by which its stress falls: none at a rigid neighbour.
    share: f64,
}

impl Side<'_> {
    fn flow(&self, force: f64, dt: f64) -> (Flow, History) {
        self.part.borders.flow(&self.part.law, self.node, -force / self.part.area, self.share, dt)
    }

    /// The force after a flow.
    fn after(&self, force: f64, flow: Flow) -> f64 {
        force + self.part.area * self.share * flow.plastic
    }
}

impl Joint {
    pub fn new(kind: Kind) -> Self {
        Self { contact: Contact::new(kind) }
    }

    /// One step.
    pub fn pass(&mut self, left: &mut Part, right: &mut Part, dt: f64) -> Passed {
        let bars = [bar(left, 1), bar(right, 0)];
        let Some(contact) = &mut self.contact else { return meet(left, right, &bars, Some(0.0), dt).0 };
        let (gap, rate) = (contact.gap(), contact.closing_rate(dt));
        // Free sides flow next to nothing without stress.
        let touches = contact.advance(dt, force_at(rate, &bars), free_rate(&bars));
        let (passed, force) = meet(left, right, &bars, touches.then_some(rate), dt);
        if touches {
            contact.lose(force, gap);
        }
        passed
    }

    /// How much farther apart the sides are than at the start, m.
    pub fn opened(&self) -> f64 {
        self.contact.map_or(0.0, |contact| contact.jump())
    }

    /// Energy lost where the sides met, J.
    pub fn lost(&self) -> f64 {
        self.contact.map_or(0.0, |contact| contact.lost())
    }
}

/// How a segment answers at its left (0) or right (1) border before that flows.
fn bar(part: &Part, side: usize) -> Response {
    Response { force: -part.area * part.arriving(side), impedance: part.area * part.impedance }
}

/// Sides that hold together while their gap grows at `rate` (m/s), or do not touch without one; and the force between them.
///
/// The sides flow one after the other; the mean of both orders keeps mirror images alike.
fn meet(left: &mut Part, right: &mut Part, bars: &[Response; 2], rate: Option<f64>, dt: f64) -> (Passed, f64) {
    let force_of = |bars: &[Response; 2]| rate.map_or(0.0, |rate| force_at(rate, bars));
    let held = if rate.is_some() { INSIDE / (bars[0].impedance + bars[1].impedance) } else { 0.0 };
    let nodes = [left.f.len(), 0];
    let sides = [
        Side { node: nodes[0], share: held * bars[1].impedance, part: &*left },
        Side { node: nodes[1], share: held * bars[0].impedance, part: &*right },
    ];
    let [(flow_left, left_history), (flow_right, right_history)] = flow_of_both(&sides, force_of(bars), dt);
    let flowed = |k: usize, part: &Part, flow: Flow| Response {
        force: bars[k].force + part.area * (0.25 * flow.plastic),
        ..bars[k]
    };
    let force = force_of(&[flowed(0, left, flow_left), flowed(1, right, flow_right)]);
    account(left, nodes[0], force, flow_left, left_history);
    account(right, nodes[1], force, flow_right, right_history);
    let leaves = |part: &Part, side: usize| -2.0 * force / part.area - part.arriving(side);
    (Passed { to_left: leaves(left, 1), to_right: leaves(right, 0) }, force)
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
        let work = Work { total: -0.5 * force / part.area * flow.plastic, overstress: 0.5 * flow.overstress };
        part.work.add(work);
        part.borders.set(&part.law, node, history);
    }
}
