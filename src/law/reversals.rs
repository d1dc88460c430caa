//! Masing's rule: the stress after strain reversals, from the loading curve and the open reversal points.
//!
//! First loading follows the curve `f(z)`, z = E eps, mirrored for z < 0. Every later branch starts from a reversal at
//! (`z_r`, `sigma_r`) and follows the curve doubled in size,
//!
//! ```text
//! sigma = sigma_r + 2 f((z - z_r)/2),
//! ```
//!
//! until it returns to the previous reversal. The cycle between the two is then closed and forgotten, and the stress continues
//! along the branch in which the cycle began (Madelung's rules). Beyond the mirror image of the first reversal, first loading
//! continues. If the curve is piecewise linear and its slopes fall (`w_k = E_(k-1) - E_k > 0`), this is the stress of
//! elastic-perfectly-plastic elements in parallel, with the moduli `w_k` and the yield strains of the knots (Besseling's overlay).
//!
//! Sources: G. Masing, Proc. 2nd Int. Congr. Appl. Mech., Zurich 1926; J. F. Besseling, J. Appl. Mech. 25 (1958) 529;
//! M. Brokate and J. Sprekels, Hysteresis and Phase Transitions, Springer 1996, chapter 2.

use super::Backbone;

/// Largest number of reversals that a point remembers. Cycles of constant amplitude need at most 2. Oscillations of decreasing amplitude open one
/// more with every half-cycle that yields.
pub const MAX_REVERSALS: usize = 8;

/// Number of state variables in which [`Reversals`] are stored.
pub(super) const NUMBERS: usize = 3 + MAX_REVERSALS;

/// Number of bisections after which an interval has no length left.
const HALVINGS: usize = 64;

/// The open reversals of a point. The default is a point that has never yielded.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Reversals {
    /// E times the strains of the reversals, outermost first, Pa. The first `open` entries are valid.
    strains: [f64; MAX_REVERSALS],
    open: usize,
    /// Stress at the latest reversal, Pa.
    stress: f64,
    /// E times the strain at which the point last flowed, Pa.
    tip: f64,
}

impl Reversals {
    /// Reads the reversals from the state of a cell.
    pub(super) fn of(numbers: &[f64; NUMBERS]) -> Self {
        let [open, stress, tip, strains @ ..] = *numbers;
        Self { strains, open: open as usize, stress, tip }
    }

    /// Returns the reversals as state variables; all are 0 for a point that has never yielded.
    pub(super) fn numbers(&self) -> [f64; NUMBERS] {
        let mut numbers = [0.0; NUMBERS];
        numbers[..3].copy_from_slice(&[self.open as f64, self.stress, self.tip]);
        numbers[3..].copy_from_slice(&self.strains);
        numbers
    }

    /// Returns true if the point has never yielded.
    pub(super) fn is_virgin(&self) -> bool {
        self.open == 0 && self.tip == 0.0
    }

    /// Returns the sense in which the point last flowed: +1 tension, -1 compression.
    pub(crate) fn sense(&self) -> f64 {
        1.0_f64.copysign(self.tip - self.start())
    }

    /// Returns E times the strain at which the point last flowed, Pa.
    pub(crate) fn tip(&self) -> f64 {
        self.tip
    }

    /// Returns E times the strain at the start of the current branch, Pa.
    fn start(&self) -> f64 {
        if self.open == 0 { 0.0 } else { self.strains[self.open - 1] }
    }

    /// Returns the scale factor of the current branch relative to the curve: 1 or 2.
    fn scale(&self) -> f64 {
        if self.open == 0 { 1.0 } else { 2.0 }
    }

    /// Returns E times the strain (Pa) at which the current branch, followed in `sense`, meets the branch into which it continues; infinite if there
    /// is none.
    pub(crate) fn end(&self, sense: f64) -> f64 {
        match self.open {
            0 => sense * f64::INFINITY,
            1 => -self.strains[0],
            open => self.strains[open - 2],
        }
    }

    /// Maps a point (z, stress) of the curve, in magnitudes, to the current branch. Returns E times the strain, and the stress, Pa.
    pub(crate) fn branch_point(&self, sense: f64, z: f64, stress: f64) -> (f64, f64) {
        (self.start() + sense * self.scale() * z, self.stress + sense * self.scale() * stress)
    }

    /// Returns z of the curve for a point of the current branch, given E times its strain; Pa, signed.
    pub(crate) fn curve_abscissa(&self, strain: f64) -> f64 {
        (strain - self.start()) / self.scale()
    }

    /// Returns the stress on the current branch at E times the strain `strain`, Pa.
    pub(crate) fn stress_at(&self, curve: &impl Backbone, strain: f64) -> f64 {
        self.stress + self.scale() * mirrored(curve, self.curve_abscissa(strain))
    }

    /// Computes the stress at the latest reversal from the strains of all reversals, Pa.
    fn stress_from_strains(&self, curve: &impl Backbone) -> f64 {
        let rise = |pair: &[f64]| 2.0 * mirrored(curve, 0.5 * (pair[1] - pair[0]));
        let open = &self.strains[..self.open];
        open.first().map_or(0.0, |first| mirrored(curve, *first)) + open.windows(2).map(rise).sum::<f64>()
    }

    /// Flows to E times the strain `strain` (Pa), which must lie outside the elastic range. Returns the stress there. `last_knot` is z of
    /// the curve's last knot: a branch of that length has forgotten its whole history.
    pub(super) fn flow_to(&mut self, curve: &impl Backbone, last_knot: f64, strain: f64) -> f64 {
        let sense = 1.0_f64.copysign(strain - self.tip);
        self.turn(curve, sense);
        self.close(curve, sense, strain);
        if self.open >= 2 && sense * self.curve_abscissa(strain) >= last_knot {
            self.strains[0] = strain - 2.0 * sense * last_knot;
            self.open = 1;
            self.stress = self.stress_from_strains(curve);
            self.close(curve, sense, strain);
        }
        self.tip = strain;
        self.stress_at(curve, strain)
    }

    /// Sets the sense of loading. If the point last flowed in the other sense, opens a reversal at the tip.
    pub(crate) fn turn(&mut self, curve: &impl Backbone, sense: f64) {
        if self.is_virgin() || sense == self.sense() {
            return;
        }
        if self.open == MAX_REVERSALS {
            return self.merge(curve);
        }
        self.strains[self.open] = self.tip;
        self.open += 1;
        self.stress = self.stress_from_strains(curve);
    }

    /// Closes the loops whose ends lie before `strain`.
    fn close(&mut self, curve: &impl Backbone, sense: f64, strain: f64) {
        let open = self.open;
        while self.open > 0 && sense * (strain - self.end(sense)) > 0.0 {
            self.open = self.open.saturating_sub(2);
        }
        if self.open < open {
            self.stress = self.stress_from_strains(curve);
        }
    }

    /// Flows to the end of the current branch, followed in `sense`, and changes to the branch that it meets there. Returns false if the branch has no
    /// end.
    pub(crate) fn pass_end(&mut self, curve: &impl Backbone, sense: f64) -> bool {
        let end = self.end(sense);
        if end.is_finite() {
            self.open = self.open.saturating_sub(2);
            self.stress = self.stress_from_strains(curve);
            self.tip = end;
        }
        end.is_finite()
    }

    /// Flows in `sense` to a stress, Pa, or back to it along the current branch. `z_at` returns z of the curve at a stress, both >= 0.
    /// If that z is at most `yield_stress`, the branch is still elastic, and the reversal that started it is removed.
    pub(crate) fn flow_to_stress(
        &mut self,
        curve: &impl Backbone,
        z_at: impl Fn(f64) -> f64,
        sense: f64,
        stress: f64,
        yield_stress: f64,
    ) {
        self.turn(curve, sense);
        while sense * stress >= sense * self.stress_at(curve, self.end(sense)) && self.pass_end(curve, sense) {}
        let z = z_at((sense * (stress - self.stress) / self.scale()).max(0.0));
        if z > yield_stress {
            self.tip = self.start() + sense * self.scale() * z;
        } else if self.open > 0 {
            self.open -= 1;
            self.tip = self.strains[self.open];
            self.stress = self.stress_from_strains(curve);
        } else {
            *self = Self::default();
        }
    }

    /// Opens a reversal at the tip when [`MAX_REVERSALS`] are already open. Of the four latest, tip included, the middle two are forgotten, and the
    /// first is moved inwards such that strain and stress at the tip are unchanged, as if the point had come there by
    /// way of that reversal. The outer loops remain exact; on the way back to them the stress has an error. Measured for aluminium with a yield
    /// stress of 95 MPa in 40 lines: at most 4.2 MPa after 60 half-cycles starting at a strain of 1 %, each smaller than the previous one by
    /// 1 % to 20 %; and at most 5.8 MPa in 300 histories of 100 random strains up to 1 % (with 0.4 merges per history).
    fn merge(&mut self, curve: &impl Backbone) {
        let stress = self.stress_at(curve, self.tip);
        let (mut inner, mut outer) = (self.strains[MAX_REVERSALS - 1], self.strains[MAX_REVERSALS - 3]);
        let sense = 1.0_f64.copysign(outer - inner);
        self.strains[MAX_REVERSALS - 2] = self.tip;
        self.open = MAX_REVERSALS - 1;
        for _ in 0..HALVINGS {
            let middle = 0.5 * (inner + outer);
            self.strains[MAX_REVERSALS - 3] = middle;
            if sense * (self.stress_from_strains(curve) - stress) > 0.0 {
                inner = middle;
            } else {
                outer = middle;
            }
        }
        self.stress = stress;
        self.strains[MAX_REVERSALS - 1] = 0.0;
    }
}

/// Returns the curve as an odd function of z.
fn mirrored(curve: &impl Backbone, z: f64) -> f64 {
    curve.stress(z.abs(), 1.0).copysign(z)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::law::{Searched, Table};
    use crate::material::{Beyond, Curve};

    fn curve() -> Searched {
        let rows = [(1.0, 1.0), (2.0, 1.6), (4.0, 2.2), (7.0, 2.5)];
        Searched(Table::new(&Curve::new(&rows, Beyond::Extend).expect("rows rise"), 1.0))
    }

    /// Returns a point after strain oscillations of decreasing amplitude, at its last reversal.
    fn swung(turns: u32, ratio: f64) -> Reversals {
        let mut point = Reversals::default();
        for k in 0..turns {
            point.flow_to(&curve(), 4.0, 3.0 * (-ratio).powi(k as i32));
        }
        point
    }

    #[test]
    fn numbers_and_back() {
        let point = swung(5, 0.9);
        assert_eq!((point.open, Reversals::of(&point.numbers())), (4, point));
        assert_eq!(Reversals::default().numbers(), [0.0; NUMBERS]);
    }

    #[test]
    fn one_reversal_too_many_keeps_strain_and_stress() {
        let full = swung(MAX_REVERSALS as u32 + 1, 0.95);
        assert_eq!(full.open, MAX_REVERSALS);
        let mut point = full;
        let stress = point.stress_at(&curve(), point.tip());
        point.turn(&curve(), -full.sense());
        assert_eq!((point.open, point.tip(), point.stress), (MAX_REVERSALS - 1, full.tip(), stress));
        assert!((point.stress_from_strains(&curve()) - stress).abs() < 1e-14);
        // Loops are still nested, and the outer ones are unchanged.
        assert_eq!(point.strains[..MAX_REVERSALS - 3], full.strains[..MAX_REVERSALS - 3]);
        let ranges: Vec<f64> = point.strains[..point.open].windows(2).map(|w| (w[1] - w[0]).abs()).collect();
        assert!(ranges.windows(2).all(|w| w[1] < w[0]), "{ranges:?}");
    }
}
