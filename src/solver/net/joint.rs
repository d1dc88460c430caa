//! Joints of two segments: bonded joints and contact joints, see [`crate::bar::joint`].
//!
//! With f arriving from the left and g from the right, the sides have `q_l = -A_l f`, `q_r = -A_r g` and `Y = A Z`. If the border node of a side
//! flows, that side responds with `q + D`, where D is A/4 times its plastic flow in the step: half of it occurs before and half after the time at
//! which force and velocity hold. The leaving waves are `-2 p/A - f` and `-2 p/A - g`.

use serde::{Deserialize, Serialize};

use super::part::{INSIDE, Load, NetSegment};
use crate::bar::ends::Response;
use crate::bar::joint::{Contact, force_at, free_rate, is_round_off};
use crate::bar::{Joint as Kind, SuddenLoad};
use crate::law::rate::{Flow, History};

/// Number of iterations in which the flows of the two sides adapt to each other. Each halves the error, and both sides are treated alike.
const ROUNDS: usize = 8;

/// Waves that leave a joint: g into the left segment and f into the right one.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct LeavingWaves {
    pub to_left: f64,
    pub to_right: f64,
}

/// Joint between two neighbouring segments.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(super) struct Joint {
    /// State of the contact; `None` if the joint is bonded.
    contact: Option<Contact>,
}

/// One side of a joint.
struct Side<'a> {
    part: &'a NetSegment,
    /// Index of the border node.
    node: usize,
    /// Ratio of its stress drop to its plastic flow: 0 at a free face, [`INSIDE`] at a rigid neighbour.
    share: f64,
}

impl Side<'_> {
    fn flow(&self, force: f64, dt: f64) -> (Flow, History) {
        let load = Load { stress: -force / self.part.area, share: self.share, time: dt };
        self.part.flow_of_border(self.node, load)
    }

    /// Returns the force at the reading, after the flow that precedes it.
    fn after(&self, force: f64, flow: Flow) -> f64 {
        force + self.part.area * self.share * flow.before
    }
}

impl Joint {
    pub fn new(kind: Kind) -> Self {
        Self { contact: Contact::new(kind) }
    }

    /// Applies a sudden load to the faces; see [`Contact::load`].
    pub fn load(&mut self, load: SuddenLoad, force: f64) {
        if let Some(contact) = &mut self.contact {
            contact.load(load, force);
        }
    }

    /// Advances the joint by one step and returns the waves that leave it.
    pub fn transmit(&mut self, left: &mut NetSegment, right: &mut NetSegment, dt: f64) -> LeavingWaves {
        let bars = [bar(left, 1), bar(right, 0)];
        let Some(contact) = &mut self.contact else { return couple(left, right, &bars, Some(0.0), dt).0 };
        let (gap, rate) = (contact.gap(), contact.closing_rate(dt));
        // Without stress, free sides hardly flow, so that the elastic response decides whether they touch.
        let touches = contact.advance(dt, force_at(rate, &bars), free_rate(&bars));
        let (passed, [force, read]) = couple(left, right, &bars, touches.then_some(rate), dt);
        if touches {
            contact.add_lost_energy(force, gap);
            if !is_round_off(read, &bars) {
                contact.record_force(dt, read, f64::INFINITY);
            }
        }
        passed
    }

    /// Increase of the distance between the sides since the start, m.
    pub fn opened(&self) -> f64 {
        self.contact.map_or(0.0, |contact| contact.jump())
    }

    /// Returns the contact of a joint that can open; `None` if the joint is bonded.
    pub fn contact(&self) -> Option<&Contact> {
        self.contact.as_ref()
    }
}

/// Response of a segment at its left (0) or right (1) border before the border node flows.
fn bar(part: &NetSegment, side: usize) -> Response {
    Response { force: -part.area * part.arriving(side), impedance: part.area * part.impedance }
}

/// Couples two sides whose gap grows at `rate` (m/s), or that do not touch if `rate` is `None`. Returns the waves that leave, and the force between
/// the sides half-way through their flow and at the reading.
fn couple(
    left: &mut NetSegment,
    right: &mut NetSegment,
    bars: &[Response; 2],
    rate: Option<f64>,
    dt: f64,
) -> (LeavingWaves, [f64; 2]) {
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
    left.record_flow(nodes[0], -force / left.area, &flow_left, left_history);
    right.record_flow(nodes[1], -force / right.area, &flow_right, right_history);
    let leaves = |part: &NetSegment, side: usize| -2.0 * force / part.area - part.arriving(side);
    (LeavingWaves { to_left: leaves(left, 1), to_right: leaves(right, 0) }, [force, read])
}

/// Returns plastic flow and history of both sides. Each side flows under the force that the other's flow leaves at the reading.
fn flow_of_both(sides: &[Side<'_>; 2], force: f64, dt: f64) -> [(Flow, History); 2] {
    let [a, b] = sides;
    let mut flows = [a.flow(force, dt), b.flow(force, dt)];
    // If one side does not flow, the flow of the other only takes it farther from yield.
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
