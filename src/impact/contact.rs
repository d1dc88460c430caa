//! Hertz's contact of linear bodies, integrated in time: one integrator for spheres, plates, beams and rods.
//!
//! The contact force over a step is a cubic in time through four Lobatto nodes. The motion of every body is exact for it
//! ([`super::Oscillator`]), so that no frequency limits the step. At the nodes force and approach obey Hertz's law; between them, the
//! defect of the law sets the step. Separations and new contacts end a step.

use std::collections::HashMap;
use std::ops::ControlFlow;
use std::rc::Rc;

use super::oscillator::{Kernel, Oscillator, TERMS};
use crate::bar::Hertz;
use crate::root::bisect;

/// Lobatto's nodes of a step, and the place where the defect is looked at.
const NODES: [f64; TERMS] = [0.0, 0.276_393_202_250_021, 0.723_606_797_749_979, 1.0];
const LOOKS: [f64; TERMS] = [NODES[1], NODES[2], 1.0, 0.5];
/// A step of free flight is the Hertz duration over this: what elastic bodies do is read at the ends of steps.
const COARSEST: f64 = 128.0;
/// Halvings of the step of free flight.
const MOST_HALVINGS: i32 = 60;

/// Bodies in contact. The approach is minus the sum of shape q over all oscillators, minus the displacement of the dashpot and of the
/// spring: the striker has the shape -1.
#[derive(Debug, Clone, Default)]
pub struct System {
    /// Striker first.
    pub modes: Vec<Oscillator>,
    /// Velocity under a unit force of a body that answers as a dashpot, m/(N s); 0: there is none.
    pub mobility: f64,
    /// Displacement of that body, m.
    pub drift: f64,
    /// Displacement under a unit force of what follows it at once, m/N; 0: nothing.
    pub compliance: f64,
    /// Energy that the dashpot has taken, J.
    pub radiated: f64,
    /// Energy that the damping of the oscillators has taken, J: the work on them less what they hold.
    pub damped: f64,
}

/// The force over a step: values at [`NODES`].
type Nodal = [f64; TERMS];

/// What a step of one length does, whatever the state.
#[derive(Debug)]
struct Step {
    dt: f64,
    /// Of each mode, at [`LOOKS`].
    kernels: Vec<[Kernel; TERMS]>,
    /// Approach lost at [`LOOKS`] by unit forces at [`NODES`].
    receptance: [Nodal; TERMS],
}

/// One contact.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Touch {
    /// When it begins, s.
    pub start: f64,
    /// When it ends, s; the end of the run where it lasts on.
    pub end: f64,
    /// Largest force, N.
    pub peak_force: f64,
    /// When that is, s.
    pub peak_time: f64,
    /// Largest approach, m.
    pub approach: f64,
    /// N s.
    pub impulse: f64,
}

/// How an integration went.
#[derive(Debug, Clone, PartialEq)]
pub struct History {
    /// In order of time.
    pub touches: Vec<Touch>,
    /// Steps taken.
    pub steps: usize,
    /// Those of them in contact.
    pub contact_steps: usize,
    /// The bodies have separated and cannot meet again.
    pub separated: bool,
    /// s.
    pub end: f64,
}

/// A moment that is looked at.
#[derive(Debug, Clone, Copy)]
pub struct Moment<'a> {
    /// s.
    pub time: f64,
    /// N.
    pub force: f64,
    /// m; negative where the bodies are apart.
    pub approach: f64,
    /// All bodies.
    pub system: &'a System,
}

/// How long to integrate, and how closely.
#[derive(Debug, Clone, Copy)]
pub struct Horizon {
    /// Earliest end, s.
    pub least: f64,
    /// Latest end, s. In between the integration ends when the bodies have separated for good.
    pub most: f64,
    /// Largest defect of Hertz's law, relative to the largest force, > 0.
    pub tolerance: f64,
    /// How often the step of free flight, 1/128 of the Hertz duration, may be doubled in contact, >= 0.
    pub doublings: i32,
}

impl Horizon {
    /// Doublings where nothing but the contact is looked at: steps of up to a quarter of it.
    pub const CONTACT_ALONE: i32 = 5;
}

/// The integration of a contact that begins at t = 0 with the approach 0.
#[derive(Debug)]
pub struct Contact {
    law: Hertz,
    system: System,
    steps: HashMap<i32, Rc<Step>>,
    longest: f64,
    /// Largest force so far, or the expected one, N.
    scale: f64,
    time: f64,
    force: f64,
    taken: [usize; 2],
    halvings: i32,
}

impl System {
    /// m.
    pub fn approach(&self, force: f64) -> f64 {
        -self.modes.iter().map(|m| m.shape * m.q).sum::<f64>() - self.drift - self.compliance * force
    }

    /// Rate of the approach without a force, m/s.
    fn closing(&self) -> f64 {
        -self.modes.iter().map(|m| m.shape * m.v).sum::<f64>()
    }

    /// Nothing moves the bodies together again without a force.
    fn has_separated(&self) -> bool {
        let rigid = || self.modes.iter().filter(|m| m.omega == 0.0);
        let approach = -rigid().map(|m| m.shape * m.q).sum::<f64>() - self.drift;
        let closing = -rigid().map(|m| m.shape * m.v).sum::<f64>();
        let elastic = || self.modes.iter().filter(|m| m.omega > 0.0 && m.shape != 0.0);
        let swing: f64 = elastic().map(|m| m.shape.abs() * m.amplitude()).sum();
        closing < 0.0 && (approach + swing < 0.0 || elastic().next().is_none())
    }

    fn step(&self, dt: f64) -> Step {
        let kernels: Vec<[Kernel; TERMS]> = self.modes.iter().map(|m| LOOKS.map(|part| m.kernel(part * dt))).collect();
        let mut receptance = [[0.0; TERMS]; TERMS];
        for (look, row) in receptance.iter_mut().enumerate() {
            let mut terms = [0.0; TERMS];
            for (mode, kernels) in self.modes.iter().zip(&kernels) {
                let weight = mode.shape * mode.shape / mode.mass;
                for (k, term) in terms.iter_mut().enumerate() {
                    *term += weight * kernels[look][k + 2];
                }
            }
            let mut power = LOOKS[look] * dt;
            for (k, term) in terms.iter_mut().enumerate() {
                *term += self.mobility * power;
                power *= LOOKS[look] * dt / (k + 2) as f64;
            }
            for (node, value) in row.iter_mut().enumerate() {
                let mut unit = [0.0; TERMS];
                unit[node] = 1.0;
                *value = taylor(&unit, dt).iter().zip(&terms).map(|(f, g)| f * g).sum();
            }
            // What follows the force at once.
            let at: Nodal = std::array::from_fn(|node| lagrange(node, LOOKS[look]));
            row.iter_mut().zip(at).for_each(|(value, at)| *value += self.compliance * at);
        }
        Step { dt, kernels, receptance }
    }

    /// The approach at [`LOOKS`] without a force.
    fn coasted(&self, step: &Step) -> [f64; TERMS] {
        let mut approach = [-self.drift; TERMS];
        for (mode, kernels) in self.modes.iter().zip(&step.kernels) {
            for (value, kernel) in approach.iter_mut().zip(kernels) {
                *value -= mode.shape * mode.coasted(kernel);
            }
        }
        approach
    }

    fn advance(&mut self, step: &Step, force: &Nodal) {
        let terms = taylor(force, step.dt);
        for (mode, kernels) in self.modes.iter_mut().zip(&step.kernels) {
            let before = *mode;
            mode.advance(&kernels[2], &terms);
            if mode.delta > 0.0 {
                let inside = [0, 1].map(|node| {
                    let mut then = before;
                    then.advance(&kernels[node], &terms);
                    then.v
                });
                let velocities = [before.v, inside[0], inside[1], mode.v];
                let power: Nodal = std::array::from_fn(|node| mode.shape * velocities[node] * force[node]);
                self.damped += impulse(&power, step.dt) - (mode.energy() - before.energy());
            }
        }
        self.radiated += self.mobility * impulse(&force.map(|f| f * f), step.dt);
        self.drift += self.mobility * impulse(force, step.dt);
    }
}

/// Value at a part of the step of the cubic that is 1 at one node and 0 at the others.
fn lagrange(node: usize, part: f64) -> f64 {
    let others = NODES.iter().enumerate().filter(|(other, _)| *other != node);
    others.map(|(_, x)| (part - x) / (NODES[node] - x)).product()
}

/// Coefficients of the cubic in powers of the part of the step.
fn powers(force: &Nodal) -> [f64; TERMS] {
    let mut sum = [0.0; TERMS];
    for (node, value) in force.iter().enumerate() {
        let mut polynomial = [1.0, 0.0, 0.0, 0.0];
        for (_, x) in NODES.iter().enumerate().filter(|(other, _)| *other != node) {
            let width = NODES[node] - x;
            for k in (0..TERMS).rev() {
                let below = if k == 0 { 0.0 } else { polynomial[k - 1] };
                polynomial[k] = (below - x * polynomial[k]) / width;
            }
        }
        sum.iter_mut().zip(polynomial).for_each(|(s, p)| *s += value * p);
    }
    sum
}

/// Factors of s^k/k! in the force, s being the time in the step.
fn taylor(force: &Nodal, dt: f64) -> [f64; TERMS] {
    let mut factor = 1.0;
    let mut terms = powers(force);
    for (k, term) in terms.iter_mut().enumerate() {
        *term *= factor;
        factor *= (k + 1) as f64 / dt;
    }
    terms
}

/// Integral over the step by Lobatto's rule, exact up to the power 5.
fn impulse(force: &Nodal, dt: f64) -> f64 {
    dt * (force[0] + 5.0 * (force[1] + force[2]) + force[3]) / 12.0
}

/// The largest value of the cubic inside the step, and its place.
fn peak(force: &Nodal) -> Option<[f64; 2]> {
    let [_, b, c, d] = powers(force);
    // b + 2 c x + 3 d x^2 = 0, falling there.
    let root = c * c - 3.0 * d * b;
    if root < 0.0 {
        return None;
    }
    let x = if c <= 0.0 { b / (root.sqrt() - c) } else { (-c - root.sqrt()) / (3.0 * d) };
    let value: f64 = force.iter().enumerate().map(|(node, f)| f * lagrange(node, x)).sum();
    (0.0..=1.0).contains(&x).then_some([x, value])
}

impl Contact {
    /// Bodies that touch and approach each other.
    pub fn new(law: Hertz, system: System) -> Self {
        let velocity = system.closing();
        let inertia = 1.0 / system.modes[0].mass
            + system.modes.iter().skip(1).filter(|m| m.omega == 0.0).map(|m| m.shape * m.shape / m.mass).sum::<f64>();
        let mass = 1.0 / inertia;
        let scale = law.force(law.largest_approach(mass, velocity));
        let longest = law.contact_time(mass, velocity) / COARSEST;
        Self { law, system, steps: HashMap::new(), longest, scale, time: 0.0, force: 0.0, taken: [0, 0], halvings: 0 }
    }

    /// Integrates, shows every moment, and stops where `watch` breaks off. The last moment is the state at the end.
    pub fn run(
        mut self,
        horizon: Horizon,
        mut look: impl FnMut(Moment<'_>) -> ControlFlow<()>,
    ) -> ControlFlow<(), History> {
        let mut touches = Vec::new();
        self.show(&mut look)?;
        let mut separated = false;
        while self.time < horizon.most {
            touches.extend(self.touch(horizon, &mut look)?);
            separated = self.fly(horizon, &mut look)?;
            if separated {
                break;
            }
        }
        ControlFlow::Continue(History {
            touches,
            steps: self.taken[0],
            contact_steps: self.taken[1],
            separated,
            end: self.time,
        })
    }

    fn show(&self, look: &mut impl FnMut(Moment<'_>) -> ControlFlow<()>) -> ControlFlow<()> {
        let approach = self.system.approach(self.force);
        look(Moment { time: self.time, force: self.force, approach, system: &self.system })
    }

    /// The step of free flight halved so often; doubled for negative numbers.
    fn of_level(&mut self, halvings: i32) -> Rc<Step> {
        let (system, longest) = (&self.system, self.longest);
        self.steps.entry(halvings).or_insert_with(|| Rc::new(system.step(longest * 0.5_f64.powi(halvings)))).clone()
    }

    /// From the first touch to the separation.
    fn touch(
        &mut self,
        horizon: Horizon,
        look: &mut impl FnMut(Moment<'_>) -> ControlFlow<()>,
    ) -> ControlFlow<(), Option<Touch>> {
        let start = self.time;
        let mut touch = Touch { start, end: start, peak_force: 0.0, peak_time: start, approach: 0.0, impulse: 0.0 };
        // The force starts as the power 3/2 of time: short steps first.
        self.halvings = ((1.0 / horizon.tolerance).log2() * 2.0 / 3.0) as i32 + 2;
        while self.time < horizon.most {
            let (step, force, defect) = self.trial(horizon);
            let end = self.law_approach(force[3]);
            let ended = end <= 0.0;
            let step = if ended { Rc::new(self.to_separation(&step)) } else { step };
            let force = if ended { self.solve(&step).unwrap_or([self.force, 0.0, 0.0, 0.0]) } else { force };
            self.note(&mut touch, &step, &force);
            self.take(&step, &force);
            self.taken[1] += 1;
            touch.end = self.time;
            self.show(look)?;
            if ended {
                self.force = 0.0;
                break;
            }
            if defect < 0.02 * horizon.tolerance * self.scale {
                self.halvings = (self.halvings - 1).max(-horizon.doublings);
            }
        }
        ControlFlow::Continue((touch.end > touch.start).then_some(touch))
    }

    /// Of a force of the law, m; not above 0 where there is none.
    fn law_approach(&self, force: f64) -> f64 {
        if force > 0.0 { (force / self.law.stiffness()).powf(2.0 / 3.0) } else { 0.0 }
    }

    /// A step short enough for the tolerance, its force, and its defect.
    fn trial(&mut self, horizon: Horizon) -> (Rc<Step>, Nodal, f64) {
        loop {
            let mut step = self.of_level(self.halvings);
            if self.time + step.dt > horizon.most {
                step = Rc::new(self.system.step(horizon.most - self.time));
            }
            let solved = self.solve(&step).map(|force| (force, self.defect(&step, &force)));
            match solved {
                Some((force, defect)) if defect <= horizon.tolerance * self.scale => return (step, force, defect),
                Some((force, defect)) if self.halvings >= MOST_HALVINGS => return (step, force, defect),
                None if self.halvings >= MOST_HALVINGS => return (step, [self.force, 0.0, 0.0, 0.0], 0.0),
                _ => self.halvings += 1,
            }
        }
    }

    /// How far force and approach are from the law between the nodes, N.
    fn defect(&self, step: &Step, force: &Nodal) -> f64 {
        let lost: f64 = step.receptance[3].iter().zip(force).map(|(r, f)| r * f).sum();
        let approach = self.system.coasted(step)[3] - lost;
        let interpolated: f64 = force.iter().enumerate().map(|(node, f)| f * lagrange(node, 0.5)).sum();
        (self.law.force(approach) - interpolated).abs()
    }

    /// The forces at the nodes that obey the law there: Newton's method for the three approaches. None where it does not converge.
    fn solve(&self, step: &Step) -> Option<Nodal> {
        let free = self.system.coasted(step);
        let free: [f64; 3] = std::array::from_fn(|i| free[i] - step.receptance[i][0] * self.force);
        let receptance: [[f64; 3]; 3] = std::array::from_fn(|i| std::array::from_fn(|j| step.receptance[i][j + 1]));
        let size = free.iter().fold(self.law_approach(self.scale), |a, b| a.max(b.abs()));
        let mut approach = free;
        for _ in 0..50 {
            let force = approach.map(|a| self.law.force(a));
            let slope = approach.map(|a| 1.5 * self.law.stiffness() * a.max(0.0).sqrt());
            let mut matrix = [[0.0; 4]; 3];
            for i in 0..3 {
                for j in 0..3 {
                    matrix[i][j] = receptance[i][j] * slope[j] + f64::from(u8::from(i == j));
                }
                let lost: f64 = (0..3).map(|j| receptance[i][j] * force[j]).sum();
                matrix[i][3] = free[i] - lost - approach[i];
            }
            let change = eliminate(matrix)?;
            approach.iter_mut().zip(change).for_each(|(a, c)| *a += c);
            if change.iter().all(|c| c.abs() <= 4.0 * f64::EPSILON * size) {
                let force = approach.map(|a| self.law.force(a));
                return Some([self.force, force[0], force[1], force[2]]);
            }
        }
        None
    }

    /// The step that ends where the approach is back at 0.
    fn to_separation(&self, step: &Step) -> Step {
        let touching = |dt: f64| {
            let step = self.system.step(dt);
            self.solve(&step).is_some_and(|force| force[3] > 0.0)
        };
        self.system.step(bisect([0.0, step.dt], 1e-14 * step.dt, touching))
    }

    fn take(&mut self, step: &Step, force: &Nodal) {
        self.system.advance(step, force);
        self.time += step.dt;
        self.force = force[3];
        self.taken[0] += 1;
    }

    fn note(&mut self, touch: &mut Touch, step: &Step, force: &Nodal) {
        touch.impulse += impulse(force, step.dt);
        let inside = peak(force);
        for [part, value] in inside.into_iter().chain([[1.0, force[3]]]) {
            if value > touch.peak_force {
                touch.peak_force = value;
                touch.peak_time = self.time + part * step.dt;
                touch.approach = self.law_approach(value);
            }
        }
        self.scale = self.scale.max(touch.peak_force);
    }

    /// From a separation to the next touch; true where there is none to come.
    fn fly(&mut self, horizon: Horizon, look: &mut impl FnMut(Moment<'_>) -> ControlFlow<()>) -> ControlFlow<(), bool> {
        let none = [0.0; TERMS];
        // The first look after a separation is at a gap that has opened.
        let mut opened = false;
        while self.time < horizon.most {
            let separated = self.system.has_separated();
            if separated && self.time >= horizon.least {
                return ControlFlow::Continue(true);
            }
            let mut step = self.of_level(0);
            if self.time + step.dt > horizon.most {
                step = Rc::new(self.system.step(horizon.most - self.time));
            }
            let ahead = self.system.coasted(&step);
            let order = [0, 3, 1, 2];
            let met = order.into_iter().find(|&i| ahead[i] >= 0.0 && (opened || self.opens_before(LOOKS[i] * step.dt)));
            if let Some(i) = met.filter(|_| !separated) {
                let from = if opened { 0.0 } else { self.opening(LOOKS[i] * step.dt) };
                let apart = |dt: f64| self.system.coasted(&self.system.step(dt))[2] < 0.0;
                let dt = bisect([from, LOOKS[i] * step.dt], 1e-14 * step.dt, apart);
                let step = self.system.step(dt);
                self.take(&step, &none);
                self.show(look)?;
                return ControlFlow::Continue(false);
            }
            self.take(&step, &none);
            self.show(look)?;
            opened = true;
        }
        ControlFlow::Continue(self.system.has_separated())
    }

    /// Where the gap is open between now and then.
    fn opening(&self, then: f64) -> f64 {
        let parts = (1..64).map(|i| then * f64::from(i) / 64.0);
        parts.into_iter().find(|&dt| self.system.coasted(&self.system.step(dt))[2] < 0.0).unwrap_or(0.0)
    }

    fn opens_before(&self, then: f64) -> bool {
        self.opening(then) > 0.0
    }
}

/// Solves three linear equations, the right side in the last column; none where they are singular.
fn eliminate(mut m: [[f64; 4]; 3]) -> Option<[f64; 3]> {
    for i in 0..3 {
        let pivot = (i..3).max_by(|&a, &b| m[a][i].abs().total_cmp(&m[b][i].abs()))?;
        m.swap(i, pivot);
        if m[i][i] == 0.0 || !m[i][i].is_finite() {
            return None;
        }
        for row in i + 1..3 {
            let factor = m[row][i] / m[i][i];
            let upper = m[i];
            m[row].iter_mut().zip(upper).skip(i).for_each(|(value, above)| *value -= factor * above);
        }
    }
    let mut x = [0.0; 3];
    for i in (0..3).rev() {
        let known: f64 = (i + 1..3).map(|j| m[i][j] * x[j]).sum();
        x[i] = (m[i][3] - known) / m[i][i];
    }
    Some(x)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn striker(mass: f64, velocity: f64) -> Oscillator {
        Oscillator { v: velocity, ..Oscillator::new(mass, [0.0, 0.0], -1.0) }
    }

    fn integrate(law: Hertz, system: System, tolerance: f64) -> (History, System) {
        let horizon = Horizon { least: 0.0, most: 1.0, tolerance, doublings: Horizon::CONTACT_ALONE };
        let mut last = system.clone();
        let run = Contact::new(law, system).run(horizon, |moment| {
            last = moment.system.clone();
            ControlFlow::Continue(())
        });
        let ControlFlow::Continue(history) = run else { panic!("nothing stops it") };
        (history, last)
    }

    #[test]
    fn a_body_on_a_fixed_flat_follows_the_closed_forms() {
        let law = Hertz { radius: 0.005, modulus: 109.89e9 };
        let system = System { modes: vec![striker(0.004, 3.0)], ..System::default() };
        let (history, last) = integrate(law, system, 1e-10);
        let [touch] = history.touches.as_slice() else { panic!("{history:?}") };
        let close = |a: f64, b: f64, most: f64| assert!((a / b - 1.0).abs() < most, "{a} {b}: {:e}", a / b - 1.0);
        close(touch.end, law.contact_time(0.004, 3.0), 1e-9);
        close(touch.peak_time, 0.5 * touch.end, 1e-7);
        close(touch.approach, law.largest_approach(0.004, 3.0), 1e-9);
        close(-last.modes[0].v, 3.0, 1e-10);
        close(touch.impulse, 0.024, 1e-10);
        assert!(history.separated && history.steps < 600, "{}", history.steps);
    }
}
