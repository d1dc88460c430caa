//! Flow at no strain rate of its own: what goes of an overstress while the stress falls by a share of what flows.
//!
//! Along one piece of the static curve `dx = -(share + df/dp) dp`: [`RateLaw::flow`] goes along these pieces with the closed
//! solutions. Any step is stable, and the longest ones end on the static curve.

use super::{Driven, Flow, History, Piece, RateLaw, RelaxationStep};

/// An overstress, Pa, with the time left to it, s, that falls by `share` of what flows.
#[derive(Clone, Copy)]
struct Falling {
    excess: f64,
    time: f64,
    share: f64,
}

impl RateLaw {
    /// Flow within `time` of a cell whose stress is `excess` > 0 beyond an elastic limit (`sense` 0: the upper one, 1: the
    /// lower one) and falls by `share` (>= 0) of what flows. The history is taken to the end of the step.
    pub fn flow(&self, excess: f64, sense: usize, share: f64, time: f64, history: &mut History) -> Flow {
        self.walk(Falling { excess, time, share }, None, sense, history)
    }

    /// [`Self::flow`] in a step made by [`Self::relaxation_step`].
    #[inline]
    pub fn flow_at(&self, relaxation_step: &RelaxationStep, excess: f64, sense: usize, history: &mut History) -> Flow {
        let part = relaxation_step.parts[sense].get(history.piece[sense] as usize).map(|[start, _]| *start);
        self.walk(Falling { excess, time: relaxation_step.time, share: relaxation_step.share }, part, sense, history)
    }

    /// `part` is what flows along the present piece if it goes on to the end of the step, as a part of the overstress,
    /// where that is known.
    #[inline]
    fn walk(&self, mut falling: Falling, mut part: Option<f64>, sense: usize, history: &mut History) -> Flow {
        let pieces = self.side(sense).pieces();
        let (mut p, mut k) = (history.accumulated, history.piece[sense] as usize);
        let mut work = 0.0;
        // Not a number, or nothing to do: no loop.
        while falling.excess > 0.0 && falling.time > 0.0 {
            let (piece, x) = (&pieces[k], falling.excess);
            let room = pieces.get(k + 1).map_or(f64::INFINITY, |next| next.start - p);
            let (f, gain) = (piece.at(p), falling.share + piece.slope);
            let flow = match part.take() {
                Some(part) => part * x,
                None => self.along_piece(falling, f, piece),
            };
            if flow < room || room == f64::INFINITY {
                work += flow * (x - 0.5 * gain * flow).max(0.0);
                p += flow;
                break;
            }
            let to = x - gain * room;
            work += room * (x - 0.5 * gain * room).max(0.0);
            if room > 0.0 && to > 0.0 {
                falling.time -= self.overstress.time([x, to], f + 0.5 * piece.slope * room, gain, room);
            }
            k += 1;
            p = pieces[k].start;
            // Where the table rises as steeply as the elastic line, the static stress jumps here.
            falling.excess = to - (pieces[k].stress - (f + piece.slope * room));
        }
        let flow = p - history.accumulated;
        self.arrive(p, flow, sense, history);
        Flow { plastic: if sense == 0 { flow } else { -flow }, overstress: work }
    }

    /// Flow along one piece. Where the law asks for f, it takes that of half the flow: second order, as is the rest.
    fn along_piece(&self, falling: Falling, f: f64, piece: &Piece) -> f64 {
        let driven = Driven { excess: falling.excess, rise: 0.0, time: falling.time };
        let gain = falling.share + piece.slope;
        let flow = self.overstress.flow(driven, gain, f);
        if piece.slope > 0.0 && self.overstress.needs_static_stress() {
            return self.overstress.flow(driven, gain, f + 0.5 * piece.slope * flow);
        }
        flow
    }
}
