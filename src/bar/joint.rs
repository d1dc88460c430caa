//! Joints: how two segments meet, and the faces that a rupture leaves. One rule for every solver.
//!
//! A joint is an end with a bar on both sides. As in [`super::ends`], u is the velocity of a face **into** its own bar (m/s), p the
//! force that presses on it (N, compression positive), and each bar answers with `p = q + Y u` ([`Response`]). The gap between the
//! faces grows at `w = u_l + u_r`; at a given w the force is ([`force_at`])
//!
//! ```text
//! p = (Y_r q_l + Y_l q_r + Y_l Y_r w)/(Y_l + Y_r)
//! ```
//!
//! - **Bonded**: w = 0, with a force of either sign.
//! - **Contact** (Signorini's condition): gap >= 0, p >= 0, gap p = 0. Over a step dt the faces of a gap g touch if it takes a push to
//!   bring them to one place at its end: p > 0 at `w = -g/dt`, so that the impulse p dt is that of the fraction of the step in which they
//!   touch. Otherwise both are free, p = 0, and the gap grows at `w = -(q_l/Y_l + q_r/Y_r)` ([`free_rate`]). Momentum is exchanged
//!   exactly. Faces that meet inside a step lose the work of p on the distance that they had still to go, which is of the first order
//!   in the step: the solver books it with [`Contact::lose`].
//! - **Rupture** leaves a contact that has just opened ([`Contact::broken`]).
//!
//! Limits: a contact without a gap under pressure is bonded; one that never closes is two free ends; against a far larger impedance
//! the face is fixed. No quotient vanishes in any of them. A solver whose bars are not linear solves its Riemann problem in place of
//! [`force_at`] and [`free_rate`].
//!
//! Reference: P. Wriggers, Computational Contact Mechanics, 2nd ed. (Springer, 2006).

use serde::{Deserialize, Serialize};

use super::ends::Response;
use super::sudden_load::SuddenLoad;

/// Part of the largest force so far up to which a contact counts as over. A light striker rides along under less than that for most of a run, on
/// grids in some steps only, and what is left of waves that cancel is less.
pub(crate) const NO_FORCE: f64 = 1e-4;

/// How two segments meet.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Joint {
    /// Welded: force and velocity are continuous.
    Bonded,
    /// Touching, carries no tension; `gap` is the initial opening, m, >= 0.
    Contact {
        /// Initial opening, m.
        gap: f64,
    },
}

/// A joint that can open, between steps.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Contact {
    /// Distance of the faces at the start, m.
    start: f64,
    gap: f64,
    open: bool,
    lost: f64,
    elapsed: f64,
    pressed: Pressed,
    /// A sudden load, with its force, N, tension positive.
    sudden: Option<(SuddenLoad, f64)>,
}

/// What the faces of a joint carried so far, where a solver goes on in steps.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub struct Pressed {
    /// Largest force, N, compression positive.
    pub peak: f64,
    /// Start of the step in which it acted first, s.
    pub time_of_peak: f64,
    /// Total time of the steps in which they pressed on each other, s.
    pub duration: f64,
    /// End of the last of them, s.
    pub pressed_until: f64,
}

impl Contact {
    /// At a joint; none where it is bonded.
    pub fn new(joint: Joint) -> Option<Self> {
        let Joint::Contact { gap } = joint else { return None };
        Some(Self { start: gap, gap, open: gap > 0.0, ..Self::broken() })
    }

    /// Where a bar breaks.
    pub fn broken() -> Self {
        Self { start: 0.0, gap: 0.0, open: true, lost: 0.0, elapsed: 0.0, pressed: Pressed::default(), sudden: None }
    }

    /// Distance of the faces, m, >= 0.
    pub fn gap(&self) -> f64 {
        self.gap
    }

    /// Displacement of the right face against the left one since the start, m.
    pub fn jump(&self) -> f64 {
        self.gap - self.start
    }

    /// No force passes at present.
    pub fn is_open(&self) -> bool {
        self.open
    }

    /// Energy lost by faces that met, J.
    pub fn lost(&self) -> f64 {
        self.lost
    }

    /// What the faces carried so far; forces are those of [`Self::note`].
    pub fn pressed(&self) -> Pressed {
        self.pressed
    }

    /// The faces are suddenly loaded, with this `force` (N, tension positive).
    pub fn load(&mut self, load: SuddenLoad, force: f64) {
        self.sudden = Some((load, force));
    }

    /// Notes the force (N) of the step that was taken, of which a peak may show no more than `most` (N).
    pub fn note(&mut self, dt: f64, force: f64, most: f64) {
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

    /// The faces part that pressed on each other by this force (N) in a single step, of which [`Self::note`] has shown nothing.
    pub fn part_after(&mut self, force: f64) {
        if self.pressed.peak == 0.0 {
            (self.pressed.peak, self.pressed.time_of_peak) = (force, self.pressed.pressed_until);
        }
    }

    /// The faces press on each other, by more than rounding.
    pub fn presses(&self) -> bool {
        self.pressed.duration > 0.0 && self.pressed.pressed_until == self.elapsed
    }

    /// Rate (m/s, <= 0) at which the gap is closed at the end of a step.
    pub fn closing_rate(&self, dt: f64) -> f64 {
        -self.gap / dt
    }

    /// Takes a step in which `force` (N) goes with the [`Self::closing_rate`] and `free_rate` (m/s) with no force. True if the faces touch.
    pub fn advance(&mut self, dt: f64, force: f64, free_rate: f64) -> bool {
        // Both comparisons say the same but for rounding, which must not invent a force.
        self.open = force <= 0.0 || self.gap + dt * free_rate >= 0.0;
        self.elapsed += dt;
        if self.open {
            self.widen(dt, free_rate);
        } else {
            self.close();
        }
        !self.open
    }

    /// The same of faces without a gap at a moment: `force` (N) is that of faces that are held together; up to `round_off` is none.
    pub fn press(&mut self, force: f64, round_off: f64) -> bool {
        self.open = force <= round_off;
        !self.open
    }

    /// Faces apart, or about to part, for a time dt.
    pub fn widen(&mut self, dt: f64, rate: f64) {
        self.gap = (self.gap + dt * rate).max(0.0);
    }

    /// The faces are in one place.
    pub fn close(&mut self) {
        self.gap = 0.0;
    }

    /// Books the work of `force` (N) on faces that came closer by `closer` (m) as lost.
    pub fn lose(&mut self, force: f64, closer: f64) {
        self.lost += force * closer;
    }
}

/// Force between two faces (N, compression positive) whose gap grows at `rate` (m/s).
pub fn force_at(rate: f64, [left, right]: &[Response; 2]) -> f64 {
    let [y_left, y_right] = [left.impedance, right.impedance];
    (y_right * left.force + y_left * right.force + y_left * y_right * rate) / (y_left + y_right)
}

/// Rate at which the gap of two free faces grows, m/s.
pub fn free_rate([left, right]: &[Response; 2]) -> f64 {
    -(left.force / left.impedance + right.force / right.impedance)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sides(forces: [f64; 2], impedances: [f64; 2]) -> [Response; 2] {
        [0, 1].map(|k| Response { force: forces[k], impedance: impedances[k] })
    }

    /// Bars that press, pull or do nothing, with impedances over eight decades.
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
                // Rounding is that of the velocities of the free faces.
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
            contact.note(0.25, force, f64::INFINITY);
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
