//! Time integration of the Hertz contact of linear bodies: one integrator for spheres, plates, beams and rods.
//!
//! The contact force over a step is a cubic in time through four Lobatto nodes. The motion of every body under it is exact ([`super::Oscillator`]),
//! so that no frequency limits the step. At the nodes, force and approach satisfy Hertz's law; between them, the defect of the law controls the
//! step size. Separations and new contacts end a step.

mod cubic;
mod flight;
mod force;
mod system;

use std::collections::HashMap;
use std::ops::ControlFlow;
use std::rc::Rc;

use cubic::{Nodal, impulse, peak};
use system::Step;
pub use system::System;

use crate::bar::Hertz;

/// Largest number of halvings of the step of free flight.
const MOST_HALVINGS: i32 = 60;

/// One contact, from touch to separation.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Touch {
    /// Start, s.
    pub start: f64,
    /// End, s; the end of the run if the contact lasts longer.
    pub end: f64,
    /// Whether the bodies separate at the end.
    pub ended: bool,
    /// Largest force, N.
    pub peak_force: f64,
    /// Time of the largest force, s.
    pub peak_time: f64,
    /// Largest approach, m.
    pub approach: f64,
    /// Impulse, N s.
    pub impulse: f64,
}

/// The contacts and the statistics of an integration.
#[derive(Debug, Clone, PartialEq)]
pub struct History {
    /// Contacts in order of time.
    pub touches: Vec<Touch>,
    /// Number of steps.
    pub steps: usize,
    /// Number of steps in contact.
    pub contact_steps: usize,
    /// Whether the bodies have separated and cannot meet again.
    pub separated: bool,
    /// End of the integration, s.
    pub end: f64,
    /// Whether the observer stopped the integration early.
    pub interrupted: bool,
}

/// A state that is shown to the observer.
#[derive(Debug, Clone, Copy)]
pub struct Moment<'a> {
    /// Time, s.
    pub time: f64,
    /// Contact force, N.
    pub force: f64,
    /// Duration of the free motion since the previous observation, s; 0 in contact.
    pub flown: f64,
    /// Approach, m; negative if the bodies are separated.
    pub approach: f64,
    /// State of all bodies.
    pub system: &'a System,
}

/// Duration and accuracy of an integration.
#[derive(Debug, Clone, Copy)]
pub struct Horizon {
    /// Earliest end, s.
    pub least: f64,
    /// Latest end, s. After `least` the integration ends as soon as the bodies have separated for good.
    pub most: f64,
    /// Largest defect of Hertz's law, relative to the largest force, > 0.
    pub tolerance: f64,
    /// Number of times that the step of free flight, 1/128 of the Hertz duration, may be doubled in contact, >= 0.
    pub doublings: i32,
}

impl Horizon {
    /// Hertz duration over the step of free flight: the motion of elastic bodies is sampled at the ends of steps.
    pub const COARSEST: f64 = 128.0;
    /// Largest number of steps of free flight up to the earliest end; the step is doubled until there are no more.
    pub const ROWS: f64 = 4096.0;
    /// Number of doublings if only the contact is observed: steps of up to a quarter of its duration.
    pub const CONTACT_ALONE: i32 = 5;
}

/// The integration of a contact that begins at t = 0 with an approach of 0.
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

impl Touch {
    /// Returns the duration, s; NaN if the bodies do not separate.
    pub fn duration(&self) -> f64 {
        if self.ended { self.end - self.start } else { f64::NAN }
    }

    /// Creates a contact that begins at a time, s.
    fn at(start: f64) -> Self {
        Self { start, end: start, ended: false, peak_force: 0.0, peak_time: start, approach: 0.0, impulse: 0.0 }
    }
}

impl Contact {
    /// Starts with bodies that touch and approach each other.
    pub fn new(law: Hertz, system: System) -> Self {
        let velocity = system.closing();
        let inertia = 1.0 / system.modes[0].mass
            + system.modes.iter().skip(1).filter(|m| m.omega == 0.0).map(|m| m.shape * m.shape / m.mass).sum::<f64>();
        let mass = 1.0 / inertia;
        let scale = law.force(law.largest_approach(mass, velocity));
        let longest = law.contact_time(mass, velocity) / Horizon::COARSEST;
        Self { law, system, steps: HashMap::new(), longest, scale, time: 0.0, force: 0.0, taken: [0, 0], halvings: 0 }
    }

    /// Integrates and calls `look` at every step; the last call shows the final state. Ends early if `look` breaks.
    pub fn run(mut self, horizon: Horizon, mut look: impl FnMut(Moment<'_>) -> ControlFlow<()>) -> History {
        let mut touches = Vec::new();
        let ended = self.integrate(horizon, &mut touches, &mut look);
        History {
            touches,
            steps: self.taken[0],
            contact_steps: self.taken[1],
            separated: ended == ControlFlow::Continue(true),
            end: self.time,
            interrupted: ended.is_break(),
        }
    }

    /// Integrates contacts and free flights in turn. Returns true if the bodies have separated for good.
    fn integrate(
        &mut self,
        horizon: Horizon,
        touches: &mut Vec<Touch>,
        look: &mut impl FnMut(Moment<'_>) -> ControlFlow<()>,
    ) -> ControlFlow<(), bool> {
        self.show(0.0, look)?;
        while self.time < horizon.most {
            let mut touch = Touch::at(self.time);
            let flow = self.touch(&mut touch, horizon, look);
            touches.extend((touch.end > touch.start).then_some(touch));
            flow?;
            if self.fly(horizon, look)? {
                return ControlFlow::Continue(true);
            }
        }
        ControlFlow::Continue(false)
    }

    fn show(&self, flown: f64, look: &mut impl FnMut(Moment<'_>) -> ControlFlow<()>) -> ControlFlow<()> {
        let approach = self.system.approach(self.force);
        look(Moment { time: self.time, force: self.force, flown, approach, system: &self.system })
    }

    /// Returns the step of free flight halved this many times; doubled for negative numbers.
    fn of_level(&mut self, halvings: i32) -> Rc<Step> {
        let (system, longest) = (&self.system, self.longest);
        self.steps.entry(halvings).or_insert_with(|| Rc::new(system.step(longest * 0.5_f64.powi(halvings)))).clone()
    }

    /// Integrates from touch to separation.
    fn touch(
        &mut self,
        touch: &mut Touch,
        horizon: Horizon,
        look: &mut impl FnMut(Moment<'_>) -> ControlFlow<()>,
    ) -> ControlFlow<()> {
        // The force starts as t^(3/2), which needs short steps first.
        self.halvings = ((1.0 / horizon.tolerance).log2() * 2.0 / 3.0) as i32 + 2;
        while self.time < horizon.most {
            let (step, force, defect) = self.trial(horizon);
            let end = self.law.approach(force[3]);
            let ended = end <= 0.0;
            let step = if ended { Rc::new(self.to_separation(&step)) } else { step };
            let force = if ended { self.solve(&step).unwrap_or([self.force, 0.0, 0.0, 0.0]) } else { force };
            self.note(touch, &step, &force);
            self.take(&step, &force);
            self.taken[1] += 1;
            touch.end = self.time;
            touch.ended = ended;
            self.show(0.0, look)?;
            if ended {
                self.force = 0.0;
                break;
            }
            if defect < 0.02 * horizon.tolerance * self.scale {
                self.halvings = (self.halvings - 1).max(-horizon.doublings);
            }
        }
        ControlFlow::Continue(())
    }

    /// Returns a step short enough for the tolerance, its force, and its defect.
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
                touch.approach = self.law.approach(value);
            }
        }
        self.scale = self.scale.max(touch.peak_force);
    }
}

#[cfg(test)]
mod tests {
    use super::super::oscillator::Oscillator;
    use super::*;

    fn striker(mass: f64, velocity: f64) -> Oscillator {
        Oscillator { v: velocity, ..Oscillator::new(mass, [0.0, 0.0], -1.0) }
    }

    fn integrate(law: Hertz, system: System, tolerance: f64) -> (History, System) {
        let horizon = Horizon { least: 0.0, most: 1.0, tolerance, doublings: Horizon::CONTACT_ALONE };
        let mut last = system.clone();
        let history = Contact::new(law, system).run(horizon, |moment| {
            last = moment.system.clone();
            ControlFlow::Continue(())
        });
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
