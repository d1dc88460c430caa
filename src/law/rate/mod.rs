//! Rate-dependent plastic flow: plastic strain rate as a function of the overstress over the static curve.
//!
//! `E d eps_p/dt = q(x, f)` with the overstress `x = |sigma - a| - r > 0`; no flow where x <= 0. Here f(p) is the static
//! flow stress at the accumulated plastic strain (the loading table), `h = f - sigma_y` its hardening, and with kinematic
//! fraction b: `r = sigma_y + (1 - b) h` half the elastic range, `da = b dh` in the sense of the flow the back stress. So
//! on first loading x = |sigma| - f whatever b is. Between the elastic limits nothing flows: unloading is elastic.
//! The functions q are those of [`Overstress`].
//!
//! While a cell flows, its stress falls by a fixed share of its plastic flow (what is around it decides which one), so
//! that along one piece of the static curve `dx = -(share + df/dp) dp`: [`RateLaw::flow`] goes along these pieces with
//! the closed solutions. Any step is stable, and the longest ones end on the static curve.
//!
//! References: V. V. Sokolovsky 1948 (Prikl. Mat. Mekh. 12, 261); L. E. Malvern 1951 (J. Appl. Mech. 18, 203);
//! N. Cristescu 1967 (Dynamic Plasticity, North-Holland).

mod cell;
mod hardening;
mod heated;
mod overstress;
mod split;

pub use cell::Timed;
pub use hardening::{Hardening, Piece};
pub use heated::Heated;
pub use overstress::Overstress;

use super::Table;

/// Plastic history of a cell.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct History {
    /// E times the accumulated plastic strain, Pa, >= 0.
    pub accumulated: f64,
    /// E times the signed plastic strain, Pa.
    pub signed: f64,
    /// Back stress, Pa.
    pub back: f64,
    /// Pieces of the static curves (tension, compression) reached so far.
    piece: [u32; 2],
}

/// What a cell did in a step.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Flow {
    /// E times the signed plastic strain of the step, Pa.
    pub plastic: f64,
    /// E times the work of the overstress, per volume, Pa^2, >= 0.
    pub overstress: f64,
    /// E times the work that the static flow stress of first loading would do, per volume, Pa^2, >= 0.
    pub first_loading: f64,
}

/// Steps of one length under one share, with what can be worked out beforehand.
#[derive(Debug, Clone, PartialEq)]
pub struct Pace {
    share: f64,
    time: f64,
    /// For laws that are linear in the overstress: what flows in a step along each piece, as a part of the overstress.
    parts: [Vec<f64>; 2],
}

/// A rate-dependent law over a static curve.
#[derive(Debug, Clone, PartialEq)]
pub struct RateLaw {
    overstress: Overstress,
    /// Tension, and compression where it has a curve of its own.
    hardening: Vec<Hardening>,
    kinematic: f64,
}

impl RateLaw {
    /// From the loading tables; `compression` only where it differs, and then `kinematic` (0 to 1) must be 0.
    pub fn new(overstress: Overstress, tension: &Table, compression: Option<&Table>, kinematic: f64) -> Self {
        let hardening = std::iter::once(tension).chain(compression).map(Hardening::new).collect();
        Self { overstress, hardening, kinematic }
    }

    /// Static curve for a sense: 0 tension, 1 compression.
    fn side(&self, sense: usize) -> &Hardening {
        &self.hardening[sense.min(self.hardening.len() - 1)]
    }

    /// A history from E times the accumulated and the signed plastic strain and the back stress, Pa.
    #[inline]
    pub fn history(&self, accumulated: f64, signed: f64, back: f64) -> History {
        let first = self.side(0).find(accumulated);
        let second = if self.hardening.len() > 1 { self.side(1).find(accumulated) } else { first };
        History { accumulated, signed, back, piece: [first, second] }
    }

    /// Stresses between which a cell is elastic, Pa: lower and upper.
    pub fn limits(&self, history: &History) -> [f64; 2] {
        let reach = |sense: usize| -> f64 {
            let side = self.side(sense);
            let f = side.pieces()[history.piece[sense] as usize].at(history.accumulated);
            if self.kinematic == 0.0 || f == f64::INFINITY { f } else { f - self.kinematic * (f - side.yield_stress()) }
        };
        let up = reach(0);
        let down = if self.hardening.len() == 1 { up } else { reach(1) };
        [history.back - down, history.back + up]
    }

    /// Static flow stress of first loading at a cell's plastic strain, Pa: 0 tension, 1 compression.
    pub fn static_stress(&self, history: &History, sense: usize) -> f64 {
        self.side(sense).pieces()[history.piece[sense] as usize].at(history.accumulated)
    }

    /// The law of overstress.
    pub fn overstress(&self) -> Overstress {
        self.overstress
    }

    /// Steps of length `time` in which the stress falls by `share` of what flows.
    pub fn pace(&self, share: f64, time: f64) -> Pace {
        let part = |piece: &Piece| self.overstress.flow(1.0, piece.stress, share + piece.slope, time);
        let linear = !self.overstress.needs_static_stress();
        let parts = [0, 1].map(|sense| {
            let pieces = self.side(sense).pieces();
            if linear { pieces.iter().map(part).collect() } else { Vec::new() }
        });
        Pace { share, time, parts }
    }

    /// [`Self::flow`] in a step of a pace made by [`Self::pace`].
    #[inline]
    pub fn flow_at(&self, pace: &Pace, excess: f64, sense: usize, history: &mut History) -> Flow {
        let part = pace.parts[sense].get(history.piece[sense] as usize).copied();
        self.advance(excess, sense, [pace.share, pace.time], part, history)
    }

    /// Flow within `time` of a cell whose stress is `excess` > 0 beyond an elastic limit (`sense` 0: the upper one, 1: the
    /// lower one) and falls by `share` (>= 0) of what flows. The history is taken to the end of the step.
    pub fn flow(&self, excess: f64, sense: usize, share: f64, time: f64, history: &mut History) -> Flow {
        self.advance(excess, sense, [share, time], None, history)
    }

    /// `part` is what flows along the present piece if it goes on to the end of the step, as a part of the overstress,
    /// where that is known.
    #[inline]
    fn advance(
        &self,
        excess: f64,
        sense: usize,
        [share, time]: [f64; 2],
        mut part: Option<f64>,
        history: &mut History,
    ) -> Flow {
        let side = self.side(sense);
        let pieces = side.pieces();
        let (mut x, mut left, mut p) = (excess, time, history.accumulated);
        let mut k = history.piece[sense] as usize;
        let f_before = pieces[k].at(p);
        let (mut work, mut on_curve) = (0.0, 0.0);
        // Not a number, or nothing to do: no loop.
        while x > 0.0 && left > 0.0 {
            let piece = &pieces[k];
            let room = pieces.get(k + 1).map_or(f64::INFINITY, |next| next.start - p);
            let (f, gain) = (piece.at(p), share + piece.slope);
            let flow = match part.take() {
                Some(part) => part * x,
                None => self.along_piece(x, f, piece.slope, gain, left),
            };
            if flow < room || room == f64::INFINITY {
                work += flow * (x - 0.5 * gain * flow).max(0.0);
                on_curve += flow * (f + 0.5 * piece.slope * flow);
                p += flow;
                break;
            }
            let to = x - gain * room;
            work += room * (x - 0.5 * gain * room).max(0.0);
            on_curve += room * (f + 0.5 * piece.slope * room);
            if room > 0.0 && to > 0.0 {
                left -= self.overstress.time([x, to], f + 0.5 * piece.slope * room, gain, room);
            }
            k += 1;
            p = pieces[k].start;
            // Where the table rises as steeply as the elastic line, the static stress jumps here.
            x = to - (pieces[k].stress - (f + piece.slope * room));
        }
        let sign = if sense == 0 { 1.0 } else { -1.0 };
        let flow = p - history.accumulated;
        history.accumulated = p;
        history.signed += sign * flow;
        history.piece[sense] = k as u32;
        if self.hardening.len() > 1 {
            history.piece[1 - sense] = self.side(1 - sense).piece_at(p, history.piece[1 - sense]);
        } else {
            history.piece[1 - sense] = k as u32;
        }
        if self.kinematic > 0.0 {
            history.back += sign * self.kinematic * (pieces[k].at(p) - f_before);
        }
        Flow { plastic: sign * flow, overstress: work, first_loading: on_curve }
    }

    /// [`Self::flow`] at fixed strain of a cell in which all stresses of the static curve, the overstress that a rate asks for
    /// among them, are `softening` (> 0) times those of the law; `excess` is that beyond the softened limit.
    ///
    /// Stresses divided by the factor follow the law itself, with a share that is as much larger; only Malvern's law, which
    /// asks for the overstress alone, is as much slower.
    pub fn flow_softened(&self, excess: f64, sense: usize, softening: f64, time: f64, history: &mut History) -> Flow {
        let time = if self.overstress.needs_static_stress() { time } else { softening * time };
        let flow = self.flow(excess / softening, sense, softening.recip(), time, history);
        Flow { overstress: softening * flow.overstress, ..flow }
    }

    /// The history half-way between two that one cell could have come to.
    pub fn mean(&self, one: &History, other: &History) -> History {
        let accumulated = 0.5 * (one.accumulated + other.accumulated);
        let piece = |sense: usize| {
            let from = one.piece[sense].min(other.piece[sense]);
            self.side(sense).piece_at(accumulated, from)
        };
        History {
            accumulated,
            signed: 0.5 * (one.signed + other.signed),
            back: 0.5 * (one.back + other.back),
            piece: [piece(0), piece(1)],
        }
    }

    /// Flow along one piece. Where the law asks for f, it takes that of half the flow: second order, as is the rest.
    fn along_piece(&self, x: f64, f: f64, slope: f64, gain: f64, time: f64) -> f64 {
        let flow = self.overstress.flow(x, f, gain, time);
        if slope > 0.0 && self.overstress.needs_static_stress() {
            return self.overstress.flow(x, f + 0.5 * slope * flow, gain, time);
        }
        flow
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::material::{Beyond, Curve};

    const MODULUS: f64 = 200e9;

    fn table() -> Table {
        let rows = [(0.001, 200e6), (0.004, 260e6), (0.01, 300e6), (0.05, 340e6)];
        Table::new(&Curve::new(&rows, Beyond::Extend).expect("rows rise"), MODULUS)
    }

    fn law(k: f64, kinematic: f64) -> RateLaw {
        RateLaw::new(Overstress::Malvern { k }, &table(), None, kinematic)
    }

    #[test]
    fn two_half_steps_are_one_step_of_malvern() {
        let law = law(1e6, 0.0);
        for excess in [1e6, 50e6, 500e6] {
            let (mut once, mut twice) = (History::default(), History::default());
            let whole = law.flow(excess, 0, 0.5, 2e-6, &mut once);
            let first = law.flow(excess, 0, 0.5, 1e-6, &mut twice);
            let stress = 200e6 + excess - 0.5 * first.plastic;
            let second = law.flow(stress - law.limits(&twice)[1], 0, 0.5, 1e-6, &mut twice);
            // A dozen operations of 1e-16 each.
            assert!((once.accumulated - twice.accumulated).abs() < 1e-14 * excess, "{excess}");
            assert!((whole.overstress - first.overstress - second.overstress).abs() < 1e-12 * whole.overstress);
        }
    }

    #[test]
    fn the_longest_step_ends_on_the_static_curve() {
        for overstress in [
            Overstress::Malvern { k: 1e6 },
            Overstress::CowperSymonds { rate: MODULUS * 40.0, exponent: 5.0 },
            Overstress::JohnsonCook { c: 0.014, rate: MODULUS },
        ] {
            let law = RateLaw::new(overstress, &table(), None, 0.0);
            let mut history = History::default();
            let flow = law.flow(400e6, 0, 1.0, 1e60, &mut history);
            let (stress, limit) = (600e6 - flow.plastic, law.limits(&history)[1]);
            // With share 1 the total strain stays: 600 MPa / E = 0.003, where the table has 240 MPa.
            assert!((limit - 240e6).abs() < 1e-3 && (stress - limit).abs() < 1e-3, "{overstress:?} {stress} {limit}");
        }
    }

    #[test]
    fn first_loading_does_not_depend_on_the_kind_of_hardening() {
        for sense in [0, 1] {
            let flows = [0.0, 0.3, 1.0].map(|b| law(1e6, b).flow(120e6, sense, 0.5, 1e-6, &mut History::default()));
            assert_eq!(flows[0], flows[1]);
            assert_eq!(flows[0], flows[2]);
        }
        let (law, mut history) = (law(1e6, 1.0), History::default());
        law.flow(120e6, 0, 0.5, 1e-6, &mut history);
        let [low, high] = law.limits(&history);
        assert!((high - low - 400e6).abs() < 1e-3, "the elastic range moves and keeps its size");
    }

    #[test]
    fn not_a_number_ends() {
        let mut history = History::default();
        assert_eq!(law(1e6, 0.0).flow(f64::NAN, 0, 0.5, 1e-6, &mut history).plastic, 0.0);
        law(1e300, 0.0).flow(1e300, 0, 0.0, 1e300, &mut history);
    }
}
