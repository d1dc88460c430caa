//! Joints between two segments, and the faces that a fracture leaves. The same rules apply in every solver.
//!
//! A joint is an end with a bar on both sides. As in [`super::ends`], u is the velocity of a face **into** its own bar (m/s), p the
//! force that presses on it (N, compression positive), and each bar responds with `p = q + Y u` ([`Response`]). The gap between the
//! faces grows at the rate `w = u_l + u_r`; at a given w the force is ([`force_at`])
//!
//! ```text
//! p = (Y_r q_l + Y_l q_r + Y_l Y_r w)/(Y_l + Y_r)
//! ```
//!
//! - **Bonded**: w = 0, with a force of either sign.
//! - **Contact** (Signorini's condition): gap >= 0, p >= 0, gap p = 0. Over a step dt, faces with a gap g touch if a push is needed to
//!   bring them together at the end of the step: p > 0 at `w = -g/dt`, so that the impulse p dt is that of the fraction of the step in which they
//!   touch. Otherwise both are free, p = 0, and the gap grows at `w = -(q_l/Y_l + q_r/Y_r)` ([`free_rate`]). Momentum is exchanged
//!   exactly. Faces that meet within a step lose the work of p over the remaining distance, which is of first order
//!   in the step; the solver accounts for it with [`Contact::add_lost_energy`].
//! - **Fracture** leaves a contact that has just opened ([`Contact::broken`]).
//!
//! Limits: a contact without a gap under pressure is bonded; one that never closes is two free ends; against a far larger impedance
//! the face is fixed. No denominator vanishes in any of these limits. A solver whose bars are nonlinear solves its Riemann problem instead of
//! [`force_at`] and [`free_rate`].
//!
//! Reference: P. Wriggers, Computational Contact Mechanics, 2nd ed. (Springer, 2006).

use serde::{Deserialize, Serialize};

use super::ends::Response;
use super::sudden_load::SuddenLoad;

/// Force, relative to the largest force so far, up to which a contact counts as ended. A light striker stays in contact under a smaller force for
/// most of a run (on grids only in some steps), and the residues of cancelling waves are smaller.
pub(crate) const NO_FORCE: f64 = 1e-4;

/// Connection of two segments.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Joint {
    /// Welded: force and velocity are continuous.
    Bonded,
    /// In contact without tension; `gap` is the initial opening, m, >= 0.
    Contact {
        /// Initial opening, m.
        gap: f64,
    },
}

/// State, between steps, of a joint that can open.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Contact {
    /// Distance of the faces at t = 0, m.
    start: f64,
    gap: f64,
    open: bool,
    lost: f64,
    elapsed: f64,
    pressed: Pressed,
    /// A sudden load, with its force, N, tension positive.
    sudden: Option<(SuddenLoad, f64)>,
}

/// Contact forces of a joint so far, for solvers that advance in steps.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub struct Pressed {
    /// Largest force, N, compression positive.
    pub peak: f64,
    /// Start of the step in which the largest force first acted, s.
    pub time_of_peak: f64,
    /// Total duration of the steps in which the faces pressed on each other, s.
    pub duration: f64,
    /// End of the last of these steps, s.
    pub pressed_until: f64,
}

impl Contact {
    /// Returns the contact of a joint; `None` if it is bonded.
    pub fn new(joint: Joint) -> Option<Self> {
        let Joint::Contact { gap } = joint else { return None };
        Some(Self { start: gap, gap, open: gap > 0.0, ..Self::broken() })
    }

    /// Returns the contact of two fracture faces.
    pub fn broken() -> Self {
        Self { start: 0.0, gap: 0.0, open: true, lost: 0.0, elapsed: 0.0, pressed: Pressed::default(), sudden: None }
    }

    /// Returns the distance of the faces, m, >= 0.
    pub fn gap(&self) -> f64 {
        self.gap
    }

    /// Returns the displacement of the right face relative to the left one since t = 0, m.
    pub fn jump(&self) -> f64 {
        self.gap - self.start
    }

    /// Returns true if no force is transmitted at present.
    pub fn is_open(&self) -> bool {
        self.open
    }

    /// Returns the energy lost by faces that met, J.
    pub fn lost(&self) -> f64 {
        self.lost
    }

    /// Returns the contact forces so far, as recorded by [`Self::record_force`].
    pub fn pressed(&self) -> Pressed {
        self.pressed
    }

    /// Sets a sudden load of the faces, with this `force` (N, tension positive).
    pub fn load(&mut self, load: SuddenLoad, force: f64) {
        self.sudden = Some((load, force));
    }

    /// Records the force (N) of the latest step. For the peak, it is limited to `most` (N).
    pub fn record_force(&mut self, dt: f64, force: f64, most: f64) {
        let time = self.elapsed - dt;
        let known = |scheme: f64| self.sudden.map_or(scheme, |(load, known)| load.blend(time, -known, scheme));
        let (force, shown) = (known(force), known(force.min(most)));
        if shown > self.pressed.peak * (1.0 + 1e-9) {
            (self.pressed.peak, self.pressed.time_of_peak) = (shown, time);
        }
        if force > NO_FORCE * self.pressed.peak {
            self.pressed.duration += dt;
            self.pressed.pressed_until = self.elapsed;
        }
    }

    /// Records the force (N) of a contact that lasted for a single step and is over, if [`Self::record_force`] has recorded no force.
    pub fn record_single_step(&mut self, force: f64) {
        if self.pressed.peak == 0.0 {
            (self.pressed.peak, self.pressed.time_of_peak) = (force, self.pressed.pressed_until);
        }
    }

    /// Returns true if the faces press on each other, by more than rounding.
    pub fn presses(&self) -> bool {
        self.pressed.duration > 0.0 && self.pressed.pressed_until == self.elapsed
    }

    /// Returns the rate (m/s, <= 0) that closes the gap at the end of a step.
    pub fn closing_rate(&self, dt: f64) -> f64 {
        -self.gap / dt
    }

    /// Advances by a step in which the force is `force` (N) at the [`Self::closing_rate`], and the gap grows at `free_rate` (m/s) without force.
    /// Returns true if the faces touch.
    pub fn advance(&mut self, dt: f64, force: f64, free_rate: f64) -> bool {
        // Both comparisons are equivalent except for rounding, which must not produce a force.
        self.open = force <= 0.0 || self.gap + dt * free_rate >= 0.0;
        self.elapsed += dt;
        if self.open {
            self.widen(dt, free_rate);
        } else {
            self.close();
        }
        !self.open
    }

    /// Updates faces without a gap at an instant; `force` (N) is that of faces held together, and counts as zero up to `round_off`. Returns true if
    /// the faces touch.
    pub fn press(&mut self, force: f64, round_off: f64) -> bool {
        self.open = force <= round_off;
        !self.open
    }

    /// Opens (or closes) the gap at `rate` (m/s) for a time `dt` (s).
    pub fn widen(&mut self, dt: f64, rate: f64) {
        self.gap = (self.gap + dt * rate).max(0.0);
    }

    /// Sets the gap to zero.
    pub fn close(&mut self) {
        self.gap = 0.0;
    }

    /// Adds the work of `force` (N) over the approach `closer` (m) of the faces to the lost energy.
    pub fn add_lost_energy(&mut self, force: f64, closer: f64) {
        self.lost += force * closer;
    }
}

/// Returns the force between two faces (N, compression positive) whose gap grows at `rate` (m/s).
pub fn force_at(rate: f64, [left, right]: &[Response; 2]) -> f64 {
    let [y_left, y_right] = [left.impedance, right.impedance];
    (y_right * left.force + y_left * right.force + y_left * y_right * rate) / (y_left + y_right)
}

/// Rounding of the force between two faces, relative to the forces that the bars bring: it is their difference if both move with one velocity.
const ROUND_OFF: f64 = 1e-13;

/// Returns true if a force between two faces (N, compression positive) is rounding.
pub fn is_round_off(force: f64, [left, right]: &[Response; 2]) -> bool {
    force.abs() <= ROUND_OFF * (left.force.abs() + right.force.abs())
}

/// Returns the rate at which the gap of two free faces grows, m/s.
pub fn free_rate([left, right]: &[Response; 2]) -> f64 {
    -(left.force / left.impedance + right.force / right.impedance)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sides(forces: [f64; 2], impedances: [f64; 2]) -> [Response; 2] {
        [0, 1].map(|k| Response { force: forces[k], impedance: impedances[k] })
    }

    /// Bars that press, pull or are unloaded, with impedances over eight decades.
    fn pairs() -> impl Iterator<Item = [Response; 2]> {
        let forces = [-3.0, -0.1, 0.0, 2.0, 40.0];
        let all = forces.into_iter().flat_map(move |a| forces.map(|b| [a, b]));
        all.flat_map(|forces| (-4..=4).map(move |k| sides(forces, [1.0, 10.0_f64.powi(k)])))
    }

    #[test]
    fn one_force_holds_for_both_faces_and_mirror_images_are_equal() {
        for pair in pairs() {
            for rate in [-2.0, 0.0, 0.7] {
                let force = force_at(rate, &pair);
                let [left, right] = pair.each_ref().map(|side| side.velocity(force));
                // The rounding is that of the velocities of the free faces.
                let scale = pair.iter().map(|side| (side.force / side.impedance).abs()).fold(1.0, f64::max);
                assert!((left + right - rate).abs() <= 1e-14 * scale, "{pair:?}: {left} {right}");
                let [a, b] = pair;
                assert_eq!(force, force_at(rate, &[b, a]));
                assert_eq!(free_rate(&pair), free_rate(&[b, a]));
            }
        }
    }

    #[test]
    fn the_gap_or_the_force_vanishes_and_neither_is_negative() {
        for pair in pairs() {
            for gap in [0.0, 1e-9, 0.1, 3.0] {
                let mut contact = Contact::new(Joint::Contact { gap }).expect("a contact");
                let dt = 0.25;
                let (force, free) = (force_at(contact.closing_rate(dt), &pair), free_rate(&pair));
                let touches = contact.advance(dt, force, free);
                assert_eq!(touches, contact.gap() == 0.0 && force > 0.0, "{pair:?} {gap}");
                assert_eq!(touches, !contact.is_open());
                assert!(contact.gap() >= 0.0);
                let expected = if touches { 0.0 } else { gap + dt * free };
                assert_eq!(contact.gap(), expected, "{pair:?} {gap}");
            }
        }
    }

    #[test]
    fn rounding_is_no_pressing() {
        let mut contact = Contact::new(Joint::Contact { gap: 0.0 }).expect("a contact");
        for (force, presses) in [(2.0, true), (1.0, true), (1e-15, false), (0.0, false), (1.0, true), (1e-15, false)] {
            contact.advance(0.25, force, 0.0);
            contact.record_force(0.25, force, f64::INFINITY);
            assert_eq!(contact.presses(), presses, "{force}");
        }
        assert_eq!((contact.pressed().duration, contact.pressed().pressed_until), (0.75, 1.25));
    }

    #[test]
    fn a_rigid_neighbour_fixes_the_face_and_none_leaves_it_free() {
        let bar = Response { force: 5.0, impedance: 2.0 };
        let beside = |impedance: f64| force_at(0.0, &[bar, Response { force: 0.0, impedance }]);
        assert!((beside(1e12) / bar.force - 1.0).abs() < 1e-11);
        assert!(beside(1e-12) < 1e-11);
    }

    #[test]
    fn faces_that_touch_at_a_moment_press_or_part() {
        let mut contact = Contact::new(Joint::Contact { gap: 0.5 }).expect("a contact");
        contact.widen(1.0, -0.25);
        assert_eq!((contact.gap(), contact.jump()), (0.25, -0.25));
        contact.close();
        assert!(contact.press(1.0, 1e-9) && !contact.press(1e-9, 1e-9) && contact.is_open());
        assert!(Contact::new(Joint::Bonded).is_none());
    }
}
