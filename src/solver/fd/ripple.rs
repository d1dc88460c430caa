//! Damping of the ripples that the leapfrog scheme makes at the scale of its cells, where the bar yields.
//!
//! Two kinds arise, neither in a run that stays elastic, and such a run never gets here.
//!
//! **Zigzag.** At Courant number 1 the scheme solves the wave equation on two interleaved lattices (odd and even
//! i + n) that know nothing of each other. Elastic waves are exact on both. But where a sharp unloading front crosses
//! a plastic one, the two lattices stop flowing half a step apart, and the offset between them stays for ever as a
//! stress that alternates from cell to cell, of the order of the yield stress. The strain rate of a cell is damped
//! where it alternates in sign with those of both neighbours; an elastic front, however sharp, is monotone and is
//! left as it is.
//!
//! **Overshoot.** A plastic wave has a Courant number below 1, so its front runs ahead of a train of ripples, and
//! plastic flow keeps their peaks: too much plastic strain, for good. In a cell that is flowing, the part of the
//! strain rate is damped that stands out above twice the lesser of its neighbours', as it does where the front turns
//! into its peak and not within it.
//!
//! Both are equal and opposite impulses on the cell's two nodes: momentum is kept to the last bit, and the energy
//! they take is booked as viscous in the ledger. On bilinear bars (plastic wave speed 0.1 to 0.97 c0) the error in
//! stress falls to about half of the undamped scheme's, at 1000 and at 10000 cells.

use multiversion::multiversion;

use crate::law::LANES;

/// Share of an alternating velocity difference that a step hands over between two nodes. A pure zigzag shrinks by
/// 1 - 4 x 1/8 = 1/2 a step; 0.06 to 0.25 give the same errors within 5 %.
const ZIGZAG_SHARE: f64 = 0.125;

/// Share of the velocity difference of a flowing cell that stands out above its neighbours'. At 1000 cells
/// the error of the bilinear benchmark is 2.0e-3 from 0.05 to 0.12 and grows beyond; that of the power-law benchmark
/// grows slowly from 3.6e-4 at 0.05 to 4.0e-4 at 0.12; and the excess plastic strain behind a suddenly applied stress
/// of three times the yield stress falls from 0.7 % to 0.2 % between 0.05 and 0.1, and no further.
const OVERSHOOT_SHARE: f64 = 0.1;

/// Velocity differences below this part of the elastic wave speed (strain in a step) are rounding and no zigzag. Where
/// the bar is at rest or moves evenly, blocks then have nothing to damp.
pub(super) const ROUNDING: f64 = 1e-15;

/// The velocity difference `w` where it alternates with both neighbours', its products with theirs below -`rounding`.
#[inline(always)]
fn alternating(left: f64, w: f64, right: f64, rounding: f64) -> f64 {
    if left * w < -rounding && w * right < -rounding { w } else { 0.0 }
}

/// How much of a velocity difference the lesser of its neighbours' supports.
const SUPPORT: f64 = 2.0;

/// The part of `w` above what its neighbours support: nothing where a sign differs, and nothing where its square is within
/// `rounding`.
#[inline(always)]
fn standing_out(left: f64, w: f64, right: f64, rounding: f64) -> f64 {
    let lesser = if left.abs() < right.abs() { left.abs() } else { right.abs() };
    let supported = if left * w > 0.0 && w * right > 0.0 { SUPPORT * lesser } else { 0.0 };
    let above = w.abs() - supported;
    (if above > 0.0 && w * w > rounding { above } else { 0.0 }).copysign(w)
}

/// True where no cell of a row of nodes can have anything to hand over, found from the velocity differences as a whole:
/// they are all rounding, or of one sign and so alike that each supports its neighbours. `outside` are the nodes next to
/// the row.
pub(super) fn is_smooth(v: &[f64], outside: [Option<f64>; 2], rounding: f64) -> bool {
    let mut range = Range::of(v);
    let ends = [outside[0].map(|o| v[0] - o), outside[1].map(|o| o - v[v.len() - 1])];
    for w in ends.into_iter().flatten() {
        range.add(w);
    }
    let [least, largest] = [range.least, range.largest].map(f64::from_bits);
    largest * largest <= rounding || range.is_of_one_sign() && least > 0.0 && largest <= SUPPORT * least
}

/// The velocity differences of a row of nodes: what they have in common as bits, for which compilers know better loops than
/// for numbers. Sizes compare as their bits do; that of NaN is larger than any.
#[derive(Debug, Clone, Copy)]
struct Range {
    any: u64,
    all: u64,
    least: u64,
    largest: u64,
}

impl Range {
    const SIZE: u64 = !(1 << 63);

    fn of(v: &[f64]) -> Self {
        let [any, all, least, largest] = ranges(v);
        Self { any, all, least, largest }
    }

    #[inline(always)]
    fn add(&mut self, w: f64) {
        let bits = w.to_bits();
        self.any |= bits;
        self.all &= bits;
        self.least = self.least.min(bits & Self::SIZE);
        self.largest = self.largest.max(bits & Self::SIZE);
    }

    fn is_of_one_sign(self) -> bool {
        self.any & !Self::SIZE == 0 || self.all & !Self::SIZE != 0
    }
}

/// See [`Range`]: any, all, least, largest.
#[multiversion(targets("x86_64+avx512f+avx512dq+avx512vl+avx512bw", "x86_64+avx2"))]
fn ranges(v: &[f64]) -> [u64; 4] {
    let cells = v.len() - 1;
    let (left, right) = (&v[..cells], &v[1..=cells]);
    let mut range = Range { any: 0, all: !0, least: !0, largest: 0 };
    for i in 0..cells {
        range.add(right[i] - left[i]);
    }
    [range.any, range.all, range.least, range.largest]
}

/// Velocity difference to hand over in a cell; `flow` is 1 where the cell flows in this step, else 0.
#[inline(always)]
fn hand(left: f64, w: f64, right: f64, flow: u8, rounding: f64) -> f64 {
    let share = if flow == 0 { 0.0 } else { OVERSHOOT_SHARE };
    ZIGZAG_SHARE * alternating(left, w, right, rounding) + share * standing_out(left, w, right, rounding)
}

/// Velocity differences to hand over, one a cell of a block, into `handed`. `v` are the block's node velocities, `flow`
/// is as in [`hand`] (empty where the block has not yielded); `outside` are the nodes next to the block on both
/// sides, none where the segment ends there: its last cell is then not damped, since its outer node belongs to a
/// joint or to an end whose velocity is prescribed. Returns whether there is anything to hand over.
pub(super) fn find(v: &[f64], flow: &[u8], outside: [Option<f64>; 2], rounding: f64, handed: &mut [f64]) -> bool {
    let cells = handed.len();
    if flow.is_empty() {
        find_inner(v, rounding, handed);
    } else {
        find_inner_flowing(v, flow, rounding, handed);
    }
    let w = |i: usize| v[i + 1] - v[i];
    let flow = |i: usize| flow.get(i).copied().unwrap_or(0);
    let left_of = |i: usize| if i > 0 { Some(w(i - 1)) } else { outside[0].map(|o| v[0] - o) };
    let right_of = |i: usize| if i + 1 < cells { Some(w(i + 1)) } else { outside[1].map(|o| o - v[cells]) };
    for i in [0, cells - 1] {
        handed[i] = match (left_of(i), right_of(i)) {
            (Some(left), Some(right)) => hand(left, w(i), right, flow(i), rounding),
            _ => 0.0,
        };
    }
    // Every bit of every number: no early exit, so that it is done many at a time.
    handed.iter().fold(0, |bits, h| bits | h.to_bits()) != 0
}

/// The cells that have both neighbours inside the block, in a block that has not yielded.
#[multiversion(targets("x86_64+avx512f+avx512dq+avx512vl+avx512bw", "x86_64+avx2"))]
fn find_inner(v: &[f64], rounding: f64, handed: &mut [f64]) {
    let Some((out, [a, b, c, d])) = windows(v, handed) else { return };
    for i in 0..out.len() {
        out[i] = ZIGZAG_SHARE * alternating(b[i] - a[i], c[i] - b[i], d[i] - c[i], rounding);
    }
}

/// The same in a block with yielded cells.
#[multiversion(targets("x86_64+avx512f+avx512dq+avx512vl+avx512bw", "x86_64+avx2"))]
fn find_inner_flowing(v: &[f64], flow: &[u8], rounding: f64, handed: &mut [f64]) {
    let Some((out, [a, b, c, d])) = windows(v, handed) else { return };
    let flow = &flow[1..=out.len()];
    for i in 0..out.len() {
        out[i] = hand(b[i] - a[i], c[i] - b[i], d[i] - c[i], flow[i], rounding);
    }
}

/// The inner cells' outputs and their four nodes, all of one length; none where there is no inner cell.
#[inline(always)]
fn windows<'a>(v: &'a [f64], handed: &'a mut [f64]) -> Option<(&'a mut [f64], [&'a [f64]; 4])> {
    let inner = handed.len().checked_sub(2).filter(|&n| n > 0)?;
    let nodes = std::array::from_fn(|k| &v[k..k + inner]);
    Some((&mut handed[1..=inner], nodes))
}

/// Hands the differences over to the nodes inside a block. `gain` is dt/(rho dx). Returns the sum over nodes of twice
/// the energy taken, per node mass, (m/s)^2.
///
/// With v before and after, and g = gain times the stress difference at the node, a node loses
/// m (v - v') (v + v' - g)/2 of the energy that the scheme conserves (see the ledger's kinetic energy).
#[multiversion(targets("x86_64+avx512f+avx512dq+avx512vl+avx512bw", "x86_64+avx2"))]
pub(super) fn hand_over(gain: f64, sigma: &[f64], handed: &[f64], v: &mut [f64]) -> f64 {
    let nodes = v.len();
    let (left, right) = (&handed[..nodes], &handed[1..=nodes]);
    let (below, above) = (&sigma[..nodes], &sigma[1..=nodes]);
    let mut lost = [0.0; LANES];
    let whole = nodes - nodes % LANES;
    for start in (0..whole).step_by(LANES) {
        let lanes = start..start + LANES;
        let (l, r, v) = (&left[lanes.clone()], &right[lanes.clone()], &mut v[lanes.clone()]);
        let (b, a) = (&below[lanes.clone()], &above[lanes]);
        for lane in 0..LANES {
            lost[lane] += node(gain * (a[lane] - b[lane]), r[lane] - l[lane], &mut v[lane]);
        }
    }
    for i in whole..nodes {
        lost[0] += node(gain * (above[i] - below[i]), right[i] - left[i], &mut v[i]);
    }
    lost.iter().sum()
}

/// One node: takes on the velocity change and returns (v - v') (v + v' - g).
#[inline(always)]
pub(super) fn node(g: f64, change: f64, v: &mut f64) -> f64 {
    let before = *v;
    *v = before + change;
    -change * (before + *v - g)
}
