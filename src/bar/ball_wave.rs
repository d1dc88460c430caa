//! Wave emitted by a ball into a bar that yields. Until another wave arrives, the end moves with the velocity v(F) that follows from the curve, as
//! behind any loading wave. Force and wave thus depend on the ball and the curve alone. Up to the largest force, the wave is that of a prescribed
//! stress.

use super::ends::{self, EndModel, Face, Push, Response, Step};
use super::initial_fan::{at_ends, from_end};
use super::{Bar, EndCondition, History, InitialFan, Origin, Segment, at_rising_load};
use crate::material::{Curve, Sense};
use crate::wave::similarity::{Edge, fan_at_stress};

/// Number of steps within the contact time on an elastic bar.
const STEPS: f64 = 2000.0;

/// Largest number of steps in which the force rises, and in which it falls.
const MOST_STEPS: usize = 40_000;

/// Returns the waves emitted at t = 0 by balls at the ends of a bar that yields under them, for forces that rise within `longest` (s), in steps of
/// `dt` (s). Empty for a bar with an initial state.
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
    // The largest force occurs for an elastic bar.
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

/// Impact of a ball on an end that no wave reaches.
struct Impact {
    ball: Box<dyn EndModel>,
    face: Face,
    /// Time step, s.
    dt: f64,
    /// Velocity of the end after the latest step, m/s, into the bar.
    velocity: f64,
    /// Stress of the end so far, as rows of a history.
    course: Vec<(f64, f64)>,
}

impl Impact {
    /// Computes the impact up to the largest force, with the response given by these edges of the curve. Returns `None` if one of them is a shock, or
    /// if they end below the largest force.
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

    /// Computes the impact from there on, with an end of this impedance, N s/m.
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

    /// Returns time (s) and stress (Pa) of the latest step.
    fn latest(&self) -> (f64, f64) {
        self.course[self.course.len() - 1]
    }

    /// Returns the force of the latest step, N, compression positive.
    fn latest_force(&self) -> f64 {
        -self.face.area * self.latest().1
    }

    fn step(&self) -> Step {
        // A ball uses neither time nor displacement.
        Step { time: 0.0, dt: self.dt, displacement: 0.0 }
    }

    /// Returns the push of a step against a bar with this response.
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
