//! Joints of two segments: bonded, or a contact joint, see [`crate::bar::joint`].
//!
//! With f and g arriving from the left and from the right the sides are `q_l = -A_l f`, `q_r = -A_r g` and `Y = A Z`. Where a border
//! node flows, its side answers with `q + D`, D being A/4 of what it flows in the step: half of it before and half after the moment at
//! which force and velocity hold. What leaves is `-2 p/A - f` and `-2 p/A - g`.

use serde::{Deserialize, Serialize};

use super::part::{INSIDE, Load, Part};
use crate::bar::ends::Response;
use crate::bar::joint::{Contact, force_at, free_rate};
use crate::bar::{Joint as Kind, SuddenLoad};
use crate::law::rate::{Flow, History};

/// Rounds in which the flows of two sides adapt to each other: each halves what is missing, and both are treated alike.
const ROUNDS: usize = 8;

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
        let load = Load { stress: -force / self.part.area, share: self.share, time: dt };
        self.part.flow_of_border(self.node, load)
    }

    /// The force at the reading.
    fn after(&self, force: f64, flow: Flow) -> f64 {
        force + self.part.area * self.share * flow.before
    }
}

impl Joint {
    pub fn new(kind: Kind) -> Self {
        Self { contact: Contact::new(kind) }
    }

    /// The faces are suddenly loaded like this; see [`Contact::load`].
    pub fn load(&mut self, load: SuddenLoad, force: f64) {
        if let Some(contact) = &mut self.contact {
            contact.load(load, force);
        }
    }

    /// One step.
    pub fn pass(&mut self, left: &mut Part, right: &mut Part, dt: f64) -> Passed {
        let bars = [bar(left, 1), bar(right, 0)];
        let Some(contact) = &mut self.contact else { return couple(left, right, &bars, Some(0.0), dt).0 };
        let (gap, rate) = (contact.gap(), contact.closing_rate(dt));
        // Free sides flow next to nothing without stress.
        let touches = contact.advance(dt, force_at(rate, &bars), free_rate(&bars));
        let (passed, [force, read]) = couple(left, right, &bars, touches.then_some(rate), dt);
        if touches {
            contact.lose(force, gap);
            contact.note(dt, read, f64::INFINITY);
        }
        passed
    }

    /// How much farther apart the sides are than at the start, m.
    pub fn opened(&self) -> f64 {
        self.contact.map_or(0.0, |contact| contact.jump())
    }

    /// The joint, if it can open.
    pub fn contact(&self) -> Option<&Contact> {
        self.contact.as_ref()
    }
}

/// How a segment answers at its left (0) or right (1) border before that flows.
fn bar(part: &Part, side: usize) -> Response {
    Response { force: -part.area * part.arriving(side), impedance: part.area * part.impedance }
}

/// Sides that hold together while their gap grows at `rate` (m/s), or do not touch without one; and the force between them, half-way through
/// their flow, and as it is read.
fn couple(left: &mut Part, right: &mut Part, bars: &[Response; 2], rate: Option<f64>, dt: f64) -> (Passed, [f64; 2]) {
    let force_of = |bars: &[Response; 2]| rate.map_or(0.0, |rate| force_at(rate, bars));
    let held = if rate.is_some() { INSIDE / (bars[0].impedance + bars[1].impedance) } else { 0.0 };
    let nodes = [left.f.len(), 0];
    let sides = [
        Side { node: nodes[0], share: held * bars[1].impedance, part: &*left },
        Side { node: nodes[1], share: held * bars[0].impedance, part: &*right },
    ];
    let [(flow_left, left_history), (flow_right, right_history)] = flow_of_both(&sides, force_of(bars), dt);
    let after = |flowed: [f64; 2]| {
        let areas = [left.area, right.area];
        force_of(&[0, 1].map(|k| Response { force: bars[k].force + areas[k] * flowed[k], ..bars[k] }))
    };
    let force = after([0.25 * flow_left.plastic, 0.25 * flow_right.plastic]);
    let read = after([0.5 * flow_left.before, 0.5 * flow_right.before]);
    left.account(nodes[0], -force / left.area, &flow_left, left_history);
    right.account(nodes[1], -force / right.area, &flow_right, right_history);
    let leaves = |part: &Part, side: usize| -2.0 * force / part.area - part.arriving(side);
    (Passed { to_left: leaves(left, 1), to_right: leaves(right, 0) }, [force, read])
}

/// Plastic flow of both sides and their histories: each flows under the force that the other's flow leaves at the reading.
fn flow_of_both(sides: &[Side<'_>; 2], force: f64, dt: f64) -> [(Flow, History); 2] {
    let [a, b] = sides;
    let mut flows = [a.flow(force, dt), b.flow(force, dt)];
    // Where one side does not flow, the other's flow only takes it farther from flowing.
    if flows.iter().any(|(flow, _)| flow.plastic == 0.0) {
        return flows;
    }
    for _ in 0..ROUNDS {
        let (beside_b, beside_a) = (a.after(force, flows[0].0), b.after(force, flows[1].0));
        flows = [mean(a, flows[0], a.flow(beside_a, dt)), mean(b, flows[1], b.flow(beside_b, dt))];
    }
    flows
}

fn mean(side: &Side<'_>, one: (Flow, History), other: (Flow, History)) -> (Flow, History) {
    (one.0.mean(&other.0), side.part.law.mean(&one.1, &other.1))
}
