//! The wave that a ball sends into a bar that yields. Until another wave comes to that end it moves with the velocity v(F) as behind any wave of
//! loading: force and wave follow from the ball and the curve alone, up to the largest force as those of a stress whose course is known.

use super::ends::{self, EndModel, Face, Push, Response, Step};
use super::initial_fan::{at_ends, from_end};
use super::{Bar, EndCondition, History, InitialFan, Origin, Segment, at_rising_load};
use crate::material::{Curve, Sense};
use crate::wave::similarity::{Edge, fan_at_stress};

/// Steps in the time of a contact with an elastic bar.
const STEPS: f64 = 2000.0;

/// Steps in which the force rises or falls at most.
const MOST_STEPS: usize = 40_000;

/// The waves of balls at the ends of a bar at t = 0 that make it yield, with a force that rises within `longest` (s), in steps of `dt` (s); none in a
/// bar with an initial state.
pub fn ball_waves(bar: &Bar, ends: [&EndCondition; 2], longest: f64, dt: f64) -> Vec<InitialFan> {
    at_ends(bar, ends, |end, place, at| ball_wave(end, place, at, [longest, dt]))
}

fn ball_wave(
    end: &EndCondition,
    (origin, x, segment): (Origin, f64, usize),
    at: &Segment,
    [longest, dt]: [f64; 2],
) -> Option<InitialFan> {
    let EndCondition::Ball { mass, velocity, contact } = *end else { return None };
    let (inward, c0, density) = (origin.direction(), at.material.c0(), at.material.density);
    let area = at.end_areas()[usize::from(inward < 0.0)];
    let face = Face { inward, area, impedance: area * at.material.impedance(), velocity: inward * at.velocity };
    let closing = inward * velocity - face.velocity;
    if closing <= 0.0 {
        return None;
    }
    let curve = at.material.branch(Sense::Compression);
    // An elastic bar meets the ball with the largest force.
    let most = contact.most_force(mass, closing, face.impedance);
    let edges = fan_at_stress(curve, density, most / area).edges;
    let (elastic, plastic) = edges.split_at(edges.partition_point(|edge| edge.is_elastic(c0)));
    if plastic.is_empty() {
        return None;
    }
    let mut impact = Impact {
        ball: ends::model(end, face),
        face,
        dt: dt.min(contact.time_under(most, closing) / STEPS),
        velocity: face.velocity,
        course: vec![(0.0, 0.0)],
    };
    impact.rise(&edges, curve)?;
    let (until, peak) = impact.latest();
    let jump = from_end(&EndCondition::Stress { history: History::constant(peak) }, (origin, x, segment), at)?;
    impact.fall(area * density * jump.slowing(c0));
    let end = EndCondition::Stress { history: History::new(&impact.course).ok()? };
    let jump = jump.held_by(&end, at, until);
    let yield_stress = elastic.last().map_or(0.0, |edge| edge.stress_behind);
    let yields_at = impact.course.iter().find(|row| -row.1 > yield_stress)?.0;
    let is_known = until <= longest && yields_at < jump.alone_for(at.length);
    is_known.then(|| at_rising_load(&jump, &end, curve, until, dt)).flatten()
}

/// A ball against an end to which no wave comes.
struct Impact {
    ball: Box<dyn EndModel>,
    face: Face,
    /// Of its steps, s.
    dt: f64,
    /// Of the end after the latest step, m/s, into the bar.
    velocity: f64,
    /// The stress of the end so far, rows of a history.
    course: Vec<(f64, f64)>,
}

impl Impact {
    /// Up to the largest force, as these edges of the curve carry it. None where one of them is a shock, or they do not carry it.
    fn rise(&mut self, edges: &[Edge], curve: &Curve) -> Option<()> {
        let mut ahead = self.velocity;
        let mut steps = 0;
        for edge in edges {
            if edge.is_shock(curve) || edge.speed == 0.0 {
                return None;
            }
            let carried = self.face.area * edge.stress_behind;
            let impedance = self.face.area * (edge.stress_behind - edge.stress_ahead) / edge.velocity_jump();
            ahead += edge.velocity_jump();
            let bar = Response { force: carried - impedance * ahead, impedance };
            loop {
                let push = self.push(&bar);
                if push.force > carried {
                    break;
                }
                if push.force <= self.latest_force() {
                    return Some(());
                }
                self.take(&push);
                steps += 1;
                if steps > MOST_STEPS {
                    return None;
                }
            }
        }
        None
    }

    /// From there on, where the end answers with this impedance, N s/m.
    fn fall(&mut self, impedance: f64) {
        let bar = Response { force: self.latest_force() - impedance * self.velocity, impedance };
        for _ in 0..MOST_STEPS {
            let push = self.push(&bar);
            if push.force <= 0.0 {
                break;
            }
            self.take(&push);
        }
    }

    /// Time (s) and stress (Pa) of the latest step.
    fn latest(&self) -> (f64, f64) {
        self.course[self.course.len() - 1]
    }

    /// N.
    fn latest_force(&self) -> f64 {
        -self.face.area * self.latest().1
    }

    fn step(&self) -> Step {
        // Neither matters to a ball.
        Step { time: 0.0, dt: self.dt, displacement: 0.0 }
    }

    /// What a step gives a bar that answers like this.
    fn push(&self, bar: &Response) -> Push {
        let [force, velocity] = self.ball.relation(&self.step(), bar).solve_with(bar);
        Push { force, velocity, impulse: force * self.dt }
    }

    fn take(&mut self, push: &Push) {
        let middle = (self.course.len() as f64 - 0.5) * self.dt;
        self.course.push((middle, -push.force / self.face.area));
        self.velocity = push.velocity;
        self.ball.advance(&self.step(), push, true);
    }
}
