//! How long the steps of a moving device (a striker, a spring) at an end are.
//!
//! While nothing arrives, a device on an elastically answering bar relaxes like exp(-t/T), T being `M/(A rho c0)` for a
//! mass and `A rho c0/k` for a spring. A step of x T is exact but for x^3/12 of the stress that still has to relax, s.
//! For a given number of steps the sum of these errors is smallest where x goes with s^(-1/3).

/// Longest step, in units of T: farther the step's rule would no longer be a good picture of an exponential.
const LONGEST: f64 = 0.25;

/// Where waves are held back, the steps must make waves that are not, by this factor: else all of them would be.
const ABOVE_HOLD: f64 = 4.0;

/// A rest that is too weak for that is relaxed in steps as long as this.
const COARSEST: f64 = 1.0;

/// First step after a jump, in units of T: the stress right after the jump is off by half of this.
const FIRST: f64 = 1e-7;

/// A wave that changes the stress by more than this many steps' worth is a jump.
const JUMP: f64 = 8.0;

/// A wave that changes the stress by less than this part of a step's worth does not break a step.
const PASSING: f64 = 0.1;

/// What the lengths of steps depend on.
#[derive(Debug, Clone)]
pub(super) struct Pace {
    /// T, s.
    constant: f64,
    /// Length of a step at stress `level`, in units of T.
    step: f64,
    /// Pa.
    level: f64,
    /// Waves weaker than this are held back elsewhere, Pa.
    hold: f64,
    /// Most that the next step may take, in units of T.
    grown: f64,
}

impl Pace {
    /// For a device with time constant `constant` (s).
    pub fn new(constant: f64) -> Self {
        Self { constant, step: 1e-3, level: 1.0, hold: 0.0, grown: FIRST }
    }

    /// Steps of `step` (> 0) of `level` (Pa); waves weaker than `hold` (Pa, >= 0) are held back elsewhere.
    pub fn set(&mut self, step: f64, level: f64, hold: f64) {
        (self.step, self.level, self.hold) = (step.min(LONGEST), level, hold);
        self.restart();
    }

    /// The next step starts after a jump.
    pub fn restart(&mut self) {
        self.grown = FIRST;
    }

    /// Whether a change of the stress by `change` is a jump, at a stress of `stress` (Pa).
    pub fn is_jump(&self, change: f64, stress: f64) -> bool {
        change > JUMP * self.step * self.level.max(stress.abs())
    }

    /// Waves weaker than this (Pa) do not break a step: the end goes along with them, and the next step deals with them.
    pub fn passing(&self) -> f64 {
        self.hold.max(PASSING * self.step * self.level)
    }

    /// Length of the next step, s, while `strength` (Pa) has to relax. Steps after a jump double.
    pub fn next(&mut self, strength: f64) -> f64 {
        let strength = strength.abs().max(f64::MIN_POSITIVE);
        let fine = (self.step * (self.level / strength).cbrt()).min(LONGEST);
        let coarse = (ABOVE_HOLD * self.hold / strength).min(COARSEST);
        let part = fine.min(self.grown).max(coarse);
        self.grown = 2.0 * part;
        part * self.constant
    }
}

/// The first time > 0 at which `start + rise * t - fall * t^2` is zero, with `fall` > 0; none where it never is.
pub(super) fn first_zero(start: f64, rise: f64, fall: f64) -> Option<f64> {
    let inside = rise * rise + 4.0 * fall * start;
    if start < 0.0 {
        // Rises to zero, if it does, at the smaller root.
        return (inside >= 0.0 && rise > 0.0).then(|| -2.0 * start / (rise + inside.sqrt()));
    }
    let root = if rise >= 0.0 { (rise + inside.sqrt()) / (2.0 * fall) } else { 2.0 * start / (inside.sqrt() - rise) };
    (root > 0.0).then_some(root)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn zeros_of_the_account_are_found_from_both_sides() {
        // 2 + t - 3 t^2 = (1 - t)(2 + 3 t); -2 + 5 t - 3 t^2 = -(1 - t)(2 - 3 t).
        assert_eq!(first_zero(2.0, 1.0, 3.0), Some(1.0));
        assert_eq!(first_zero(-2.0, 5.0, 3.0), Some(2.0 / 3.0));
        assert_eq!(first_zero(0.0, 6.0, 3.0), Some(2.0));
        assert_eq!(first_zero(0.0, -6.0, 3.0), None);
        assert_eq!(first_zero(-2.0, 1.0, 3.0), None);
        assert_eq!(first_zero(-2.0, -7.0, 3.0), None);
    }

    #[test]
    fn steps_double_after_a_jump_up_to_their_length() {
        let mut pace = Pace::new(2.0);
        pace.set(1e-3, 8.0, 0.0);
        let steps: Vec<f64> = (0..20).map(|_| pace.next(1.0)).collect();
        assert_eq!(steps[0], 2e-7);
        assert_eq!(steps[5], 64e-7);
        // An eighth of the level: twice the step.
        assert!((steps[19] / 4e-3 - 1.0).abs() < 1e-12);
    }
}
