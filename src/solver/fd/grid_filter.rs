//! Filter for grid-scale oscillations of the leapfrog scheme in yielded cells.
//!
//! There are three kinds of oscillation. None arises in an elastic run, which never calls this filter.
//!
//! **Odd-even mode.** At Courant number 1 the scheme solves the wave equation on two interleaved lattices (odd and even i + n). Elastic
//! waves are exact on both. Where a sharp unloading front crosses a plastic one, the two lattices stop flowing half a step apart, and the
//! offset remains as a stress that alternates from cell to cell, of the order of the yield stress. (Most of it is avoided, see
//! [`super::stopping_flow`].) The filter damps the strain rate of a cell if its sign is opposite to that of both neighbours. An elastic
//! front, however sharp, is monotone apart from small ripples, and is not changed. A sharp front that has just reached a flowing cell is
//! not changed either, although the strain rate of the cell is then opposite to that of both neighbours, which still flow.
//!
//! **Overshoot.** A plastic wave has a Courant number below 1: a dispersive wave train follows its front, and plastic flow keeps the peaks
//! as excess plastic strain. In a cell that flows and is strained further in the same sense, the filter damps the part of the strain rate
//! that exceeds twice the smaller of its neighbours'. This part is nonzero only at such peaks. A cell next to an end that loads it and is
//! not held has only one neighbour; it is compared with the strain rate that the force on the end supports.
//!
//! **Shocks.** Along a curve that stiffens, loading waves merge into shocks; along a curve that is followed in both directions, unloading
//! waves do. A shock dissipates energy, for which the scheme has no mechanism: the energy would remain as oscillations, whose peaks are
//! kept as plastic strain. Where there can be shocks, the filter therefore damps the whole strain rate of a flowing cell by an artificial
//! viscosity. It is proportional to the square of the velocity difference (von Neumann and Richtmyer) up to a limit, and linear above it
//! (Landshoff). A shock is then about four cells wide. The velocity difference is that at the time of the stresses, the mean of those
//! before and after the step: with this mean, viscosity dissipates energy at any size, and its delay does not act as dispersion. (Along a
//! curve that is followed in both directions, a shock from yield in tension to beyond yield in compression stops at yield, and slower
//! plastic waves follow. Dispersion holds them together.) In a cell that has flowed and is elastic again, the filter damps the part of the
//! strain rate that exceeds the mean of the neighbours', a hyperviscosity: elastic waves of a few cells that a shock leaves behind decay,
//! while long waves are preserved.
//!
//! All corrections are equal and opposite impulses on the two nodes of the cell: momentum is conserved to the last bit, and the energy
//! taken is recorded as `numerical` in the ledger. On bilinear bars (plastic wave speed 0.1 to 0.97 c0) the error in stress falls to about
//! half of the unfiltered scheme's, at 1000 and at 10000 cells.

use std::ops;

use multiversion::multiversion;

use super::sizes::MOST_CELLS;
use crate::elementary::{larger, lesser};
use crate::law::{Aligned, LANES};

/// Fraction of an alternating velocity difference that is redistributed between the two nodes of a cell in the time that an elastic wave
/// takes to cross the cell. Each step redistributes this fraction times the Courant number, so that the damping of a wave does not depend
/// on the time step. At Courant number 1 a pure odd-even mode shrinks by 1 - 4 x 1/8 = 1/2 per step; values from 0.06 to 0.25 give the same
/// errors within 5 %.
const ODD_EVEN_FRACTION: f64 = 0.125;

/// Likewise, fraction of the part of a flowing cell's velocity difference that exceeds what its neighbours support. At 1000 cells the error
/// of the bilinear benchmark is 2.0e-3 from 0.05 to 0.12 and grows above; that of the power-law benchmark grows slowly from 3.6e-4 at 0.05
/// to 4.0e-4 at 0.12; and the excess plastic strain behind a suddenly applied stress of three times the yield stress falls from 0.7 % to
/// 0.2 % between 0.05 and 0.1, and no further.
const OVERSHOOT_FRACTION: f64 = 0.1;

/// Likewise, fraction of the part of a flowing end cell's velocity difference that exceeds what its end supports, see [`Neighbour::Loaded`].
/// Behind a stress that rises to 1.2 to 3 times the yield stress in 20 to 100 steps, in bilinear bars with plastic waves of 0.05 to 0.6 c0,
/// the excess strain is 9 to 43 % without this correction, 7 to 17 % with the fraction and the support of the other cells, and 1 to 5 %
/// with 0.25. With 0.1 it is up to 21 %.
const END_FRACTION: f64 = 0.25;

/// Likewise, largest fraction of the whole velocity difference of a flowing cell that artificial viscosity redistributes where there can be
/// shocks, in loading and in unloading. In `runs/lock-up.toml` the error of the strain behind the shock is twice as large with 0.1 as with
/// 0.5, for short time steps also with 0.2. In a twisted rod that unloads along its curve, the difference in stress from the Godunov scheme
/// is twice as large with 0.5 as with 0.2.
const VISCOUS_FRACTIONS: [f64; 2] = [0.5, 0.2];

/// Likewise, fraction of the velocity difference in a cell inside a shock that reverses the stress, once the cell has stopped unloading
/// along the curve. In bars that are pulled and then released or pushed, along five curves followed in both directions, the stress differs
/// from that of front tracking by 4.6 % of the mean with 200 cells and 1.7 % with 800 cells; with a fraction of 0.35 by 4.6 and 1.8 %, with
/// 0.5 by 4.8 and 1.5 %, and peaks behind shocks are then 2 % too large.
const CROSSING_FRACTION: f64 = 0.4;

/// Width of a shock, in cells. The stress that artificial viscosity adds is proportional to the square of the velocity difference (von
/// Neumann and Richtmyer), so that the damping of smooth waves is proportional to the square of the cell size. Where the velocity changes
/// linearly over this many cells, that stress equals the largest difference between the curve and the chord along which the shock runs.
const SHOCK_CELLS: f64 = 4.0;

/// As for [`ODD_EVEN_FRACTION`], fraction of the part of a velocity difference that exceeds the mean of its neighbours', in a cell that has
/// flowed and does not flow in this step, where there can be shocks. It damps the elastic waves of a few cells that a shock leaves behind:
/// a wave of 8 cells falls to a tenth over about 250 cells, one of 80 cells over 2.5e6 cells. The force at the end of a foam that locks up
/// oscillates with half the amplitude with 0.2 compared with 0.1; with larger values, rectangular pulses in metals have errors that are
/// larger by a third.
const RINGING_FRACTION: f64 = 0.2;

/// Largest fraction of a velocity difference that a step may redistribute: more would reverse an odd-even mode, and is unstable at Courant
/// number 1. Artificial viscosity counts half: with the fraction m of the mean of the differences before and after the step, and p of the
/// difference after it, the eigenvalues of a step for an odd-even mode (see [`largest_alternating_fraction`]) have the product 1 - 4 p - 4 m
/// and the sum 2 - 4 p - 4 m - 4 C^2 (1 - 4 p - 2 m). None exceeds 1 in magnitude if p + m/2 <= 1/4 and m <= 1/2.
const LARGEST_FRACTION: f64 = 0.25;

/// Returns the largest fraction of a velocity difference that alternates in sign with its neighbours: the one that damps an odd-even mode
/// critically. At Courant number C, a step changes the velocity v and the stress s of such a mode to v' = q (v + a s) and s' = s - b v',
/// with a b = 4 C^2 and q = 1 - 4 share, so that the eigenvalues have the product q and the sum 1 + q - 4 C^2 q. They are equal, and as
/// small as possible, for q = 1/(1 + 2 C)^2. A larger fraction (in the limit q = 0) removes the velocity and leaves the stress unchanged
/// for all later steps: it alternated by 35 MPa from cell to cell behind a shock of 250 MPa.
fn largest_alternating_fraction(courant: f64) -> f64 {
    0.25 * (1.0 - (1.0 + 2.0 * courant).powi(-2))
}

/// Fraction of the elastic wave speed (the strain in a step) below which velocity differences count as rounding errors. Blocks at rest or
/// in uniform motion then have nothing to damp.
const ROUNDING: f64 = 1e-15;

/// Coefficients of the filter in the cells of a segment.
#[derive(Debug, Clone, Copy)]
pub(super) struct Filter {
    /// Velocity difference of neighbouring nodes that counts as a rounding error, m/s.
    pub rounding: f64,
    /// Fractions redistributed per step: [`ODD_EVEN_FRACTION`], [`OVERSHOOT_FRACTION`] and [`END_FRACTION`], times the Courant number.
    odd_even: f64,
    overshoot: f64,
    at_end: f64,
    /// Largest fraction of the whole velocity difference of a flowing cell, in loading and in unloading.
    viscous: [f64; 2],
    /// That fraction per velocity difference, s/m: in tension and in compression, each in loading and in unloading.
    rise: [[f64; 2]; 2],
    /// Fraction of the velocity difference inside a shock that reverses the stress.
    crossing: f64,
    /// Fraction of the part that exceeds the mean of the neighbours', in a cell that has flowed.
    ringing: f64,
    /// Largest total fraction where the difference alternates.
    alternating: f64,
}

/// Waves of a segment that can be shocks, in tension and in compression: the largest difference in stress between the curve and the chord
/// along which a shock runs, divided by rho (change of velocity)^2; 0 if there are no shocks.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Shocks {
    /// Loading waves, along a curve that stiffens.
    pub loading: [f64; 2],
    /// Unloading waves, along a curve that is followed in both directions.
    pub unloading: [f64; 2],
    /// Smallest change of velocity by which first loading reaches the part of the curve that stiffens, m/s; infinite if the curve does not
    /// stiffen.
    pub velocity: f64,
}

impl Shocks {
    /// No wave is a shock.
    pub const NONE: Self = Self { loading: [0.0; 2], unloading: [0.0; 2], velocity: f64::INFINITY };
}

impl Filter {
    /// Creates the filter for the elastic wave speed `c0` (m/s) and this Courant number.
    pub fn new(c0: f64, courant: f64, shocks: Shocks) -> Self {
        let rise = |distance: f64| SHOCK_CELLS * SHOCK_CELLS * distance * courant / c0;
        Self {
            rounding: ROUNDING * c0,
            odd_even: ODD_EVEN_FRACTION * courant,
            overshoot: OVERSHOOT_FRACTION * courant,
            at_end: END_FRACTION * courant,
            viscous: VISCOUS_FRACTIONS.map(|share| share * courant),
            rise: [0, 1].map(|side| [rise(shocks.loading[side]), rise(shocks.unloading[side])]),
            ringing: RINGING_FRACTION * courant,
            crossing: if shocks.unloading == [0.0; 2] { 0.0 } else { CROSSING_FRACTION * courant },
            alternating: largest_alternating_fraction(courant),
        }
    }

    /// Returns the filter for cells with lateral inertia, which adds mass to changes of their length: the mass of a mode that alternates
    /// from cell to cell is `mass` times that of the nodes. The impulses are smaller by this factor than those of cells without lateral
    /// inertia, so that the force of the filter remains that of a viscosity, which vanishes with the cell size. The full fractions would
    /// take so much of the lateral motion in every step that cells next to a free or loaded end would flow less, the smaller they are.
    #[must_use]
    pub fn with_mass(self, mass: f64) -> Self {
        let [odd_even, overshoot, at_end] = [self.odd_even, self.overshoot, self.at_end].map(|share| share / mass);
        Self { odd_even, overshoot, at_end, ..self }
    }

    /// Returns the fraction of the velocity difference `mean` at the time of the stresses that artificial viscosity redistributes in a cell
    /// with this [flow](Cells::flow) and stress; 0 if the cell does not continue to flow. A shock that reverses the stress `crosses` the
    /// elastic range and loads in the other sense: there the fraction is constant.
    #[inline(always)]
    fn viscosity(&self, mean: f64, flow: f64, sigma: f64, crosses: bool) -> f64 {
        let rises = if sigma < 0.0 { self.rise[1] } else { self.rise[0] };
        let (unloads, size) = (flow * sigma < 0.0, mean.abs());
        let goes_on = crosses && flow == 0.0 || flow * mean > 0.0;
        if !goes_on || size <= self.rounding {
            0.0
        } else if crosses && !unloads {
            self.crossing
        } else {
            lesser(rises[usize::from(unloads)] * size, self.viscous[usize::from(unloads)])
        }
    }

    /// Returns the flow that is missing in a cell that a sharp wave unloads, relative to the plastic strain of the step before (see
    /// [`super::stopping_flow`]). Returns 0 where there can be shocks: most unloading there is ringing of the cells inside a shock, and the
    /// excess strain that a shock leaves would grow.
    pub fn missing_flow(&self) -> f64 {
        if self.takes_shocks() { 0.0 } else { 0.5 + self.overshoot }
    }

    /// Returns whether the middle one of three neighbouring velocity differences (m/s) is an oscillation from cell to cell.
    pub fn oscillates(&self, differences: [f64; 3]) -> bool {
        let (_, size, neighbours) = seen_from(differences);
        alternates(size, neighbours, *self)
    }

    /// Returns whether there can be shocks, so that differences which support each other are damped, too.
    pub fn takes_shocks(&self) -> bool {
        self.rise != [[0.0; 2]; 2]
    }
}

/// Fraction of a velocity difference up to which its neighbours count as ripples beside a sharp front, not as an oscillation. A sharp wave
/// that has passed through a plastic front has ripples of some percent ahead of it and behind it. With 0.1 a bar that is elastic for a
/// thousand transits gains 1 % of energy, with 0.05 none.
const RIPPLES: f64 = 0.05;

/// Largest velocity difference that its neighbours support, as a multiple of the smaller of theirs.
const SUPPORT: f64 = 2.0;

/// Velocity differences of a block's cells, and of the cells next to it on both sides.
#[derive(Debug)]
pub(super) struct VelocityDifferences {
    /// The differences of the block start at index [`LANES`], so that they are aligned as the velocities are.
    w: Aligned<[f64; MOST_CELLS + 2 * LANES]>,
    cells: usize,
    outside: [Neighbour; 2],
    smooth: bool,
    largest: f64,
}

/// State of the cells that the filter reads.
#[derive(Debug, Clone, Copy)]
pub(super) struct Cells<'a> {
    /// Whether some of the cells flowed in the latest step.
    pub flows: bool,
    /// Flow of each cell in the latest step, see [`Row::flow`]; empty if the block has not yielded.
    ///
    /// [`Row::flow`]: crate::law::Row::flow
    pub flow: &'a [f32],
    /// Flow history of each cell, see [`note_flow`]; empty if there can be no shocks.
    pub have_flowed: &'a [i8],
    /// Stresses, Pa.
    pub sigma: &'a [f64],
    /// Velocity differences at the time of the stresses, m/s; empty if there can be no shocks.
    pub mean: &'a [f64],
}

/// Neighbour of a row of nodes on one side.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Neighbour {
    /// Node of the same segment, with this velocity, m/s.
    Node(f64),
    /// End that moves freely: the bar is continued by its mirror image.
    Mirror,
    /// End whose force makes the adjacent cell flow and supports a velocity difference of this size (m/s) there. A mirror image would
    /// support none: at plastic waves of 0.1 c0, the cell would lag behind the load by 10 steps and keep too little strain.
    Loaded(f64),
    /// End whose velocity is prescribed; it absorbs impulses.
    Held,
    /// Joint or gap; it absorbs no impulses.
    Joint,
}

impl Neighbour {
    /// Returns the velocity difference beyond an outer node of velocity `v`; `None` at a held end or a joint. `outwards` is -1 at the left
    /// and 1 at the right, and the last argument holds the differences of the outermost cell and its neighbour.
    fn difference(self, outwards: f64, v: f64, [outer, inner]: [f64; 2]) -> Option<f64> {
        match self {
            Self::Node(velocity) => Some(outwards * (velocity - v)),
            Self::Mirror | Self::Loaded(_) => Some(if inner.abs() < RIPPLES * outer.abs() { 0.0 } else { -outer }),
            Self::Held | Self::Joint => None,
        }
    }
}

impl VelocityDifferences {
    /// Creates an instance with room for the longest block.
    pub const fn new() -> Self {
        Self {
            w: Aligned([0.0; MOST_CELLS + 2 * LANES]),
            cells: 0,
            outside: [Neighbour::Joint; 2],
            smooth: true,
            largest: 0.0,
        }
    }

    /// Computes the velocity differences of a row of nodes.
    pub fn read(&mut self, v: &[f64], outside: [Neighbour; 2], rounding: f64) {
        let cells = v.len() - 1;
        let [any, all, least, largest] = differences(v, &mut self.w.0[LANES..]);
        let mut range = Range { any, all, least, largest };
        let w = &self.w.0[LANES..];
        let beyond = [
            outside[0].difference(-1.0, v[0], [w[0], w[1.min(cells - 1)]]),
            outside[1].difference(1.0, v[cells], [w[cells - 1], w[cells.saturating_sub(2)]]),
        ];
        for w in beyond.into_iter().flatten() {
            range.add(w);
        }
        [self.w.0[LANES - 1], self.w.0[LANES + cells]] = beyond.map(Option::unwrap_or_default);
        (self.smooth, self.largest) = (range.is_smooth(rounding), f64::from_bits(range.largest));
        (self.cells, self.outside) = (cells, outside);
    }

    /// Returns the largest size of the differences, m/s.
    pub fn largest(&self) -> f64 {
        self.largest
    }

    /// Returns true if no cell can have an impulse, judged from the differences as a whole: all are rounding errors, or all have one sign
    /// and are so similar that each supports its neighbours. Always false for flowing cells where there can be shocks.
    pub fn are_smooth(&self, flows: bool, filter: Filter) -> bool {
        self.smooth && !(filter.takes_shocks() && flows)
    }

    /// Computes the impulses as velocity differences, one per cell, into `impulses`, and returns whether any is nonzero. At a prescribed
    /// end or a joint, the outermost cell has no neighbour to be compared with, and receives only artificial viscosity.
    pub fn find(&self, cells: &Cells<'_>, filter: Filter, impulses: &mut [f64]) -> bool {
        let Cells { flows, flow, sigma, mean, .. } = *cells;
        let w = &self.w.0[LANES - 1..=LANES + self.cells];
        let shocks = !cells.have_flowed.is_empty();
        let mut anything = match (shocks, flows) {
            (true, false) if none_crosses(cells.have_flowed) => find_shocks::<false>(w, cells, filter, impulses),
            (true, _) => find_shocks::<true>(w, cells, filter, impulses),
            (false, true) => find_flowing(w, flow, filter, impulses),
            (false, false) => find(w, filter, impulses),
        };
        for (cell, outside) in [0, self.cells - 1].into_iter().zip(self.outside) {
            impulses[cell] = match outside {
                Neighbour::Loaded(supported) if !shocks => {
                    let w = [w[cell], w[cell + 1], w[cell + 2]];
                    ripples::<true>(w, f64::from(flow[cell]), filter, [filter.at_end, supported])
                }
                Neighbour::Node(_) | Neighbour::Mirror | Neighbour::Loaded(_) => impulses[cell],
                Neighbour::Held | Neighbour::Joint if shocks => {
                    let (flow, w) = (f64::from(flow[cell]), mean[cell]);
                    w * filter.viscosity(w, flow, sigma[cell], crosses(cells.have_flowed[cell]))
                }
                Neighbour::Held | Neighbour::Joint => 0.0,
            };
            anything |= impulses[cell] != 0.0;
        }
        if self.cells == 1 && self.outside.contains(&Neighbour::Joint) {
            impulses[0] = 0.0;
        }
        anything
    }
}

/// Number of steps after unloading in flow in which a cell may still be inside a shock: four cells at a quarter of the elastic wave speed.
const CROSSING: i8 = 16;

/// Records how the cells of a row have flowed: 0 if never, 1 if some time ago, and larger values if they unload in flow or did so in the
/// last [`CROSSING`] steps.
pub(super) fn note_flow(flows: bool, flow: &[f32], sigma: &[f64], have_flowed: &mut [i8]) {
    // Without flow, the values 0 and 1 do not change.
    if flows || !none_crosses(have_flowed) {
        note_new_flow(flow, sigma, have_flowed);
    }
}

#[multiversion(targets("x86_64+avx512f+avx512dq+avx512vl+avx512bw", "x86_64+avx2"))]
fn note_new_flow(flow: &[f32], sigma: &[f64], have_flowed: &mut [i8]) {
    let cells = have_flowed.len();
    let (flow, sigma) = (&flow[..cells], &sigma[..cells]);
    let [mut flowing, mut unloading] = [[0; MOST_CELLS]; 2];
    let (flowing, unloading) = (&mut flowing[..cells], &mut unloading[..cells]);
    // The flags are found first, as compilers do not vectorize loops over numbers of different sizes.
    for i in 0..cells {
        flowing[i] = i8::from(flow[i] != 0.0);
        unloading[i] = i8::from(f64::from(flow[i]) * sigma[i] < 0.0);
    }
    for i in 0..cells {
        let have = have_flowed[i];
        let older = if have > 1 { have - 1 } else { have | flowing[i] };
        have_flowed[i] = if unloading[i] != 0 { CROSSING + 1 } else { older };
    }
}

/// Returns whether a cell may be inside a shock that reverses the stress.
#[inline(always)]
fn crosses(have_flowed: i8) -> bool {
    have_flowed > 1
}

/// Returns whether no cell may be inside such a shock.
fn none_crosses(have_flowed: &[i8]) -> bool {
    have_flowed.iter().fold(0, |any, have| any | have) <= 1
}

/// Bit patterns that the velocity differences of a row of nodes have in common, for which compilers generate faster loops than for
/// floating-point numbers. Sizes compare as their bit patterns do; that of NaN is larger than any other.
#[derive(Debug, Clone, Copy)]
struct Range {
    any: u64,
    all: u64,
    least: u64,
    largest: u64,
}

impl Range {
    const SIZE: u64 = !(1 << 63);

    #[inline(always)]
    fn add(&mut self, w: f64) {
        let bits = w.to_bits();
        self.any |= bits;
        self.all &= bits;
        self.least = self.least.min(bits & Self::SIZE);
        self.largest = self.largest.max(bits & Self::SIZE);
    }

    fn is_smooth(self, rounding: f64) -> bool {
        let [least, largest] = [self.least, self.largest].map(f64::from_bits);
        let one_sign = self.any & !Self::SIZE == 0 || self.all & !Self::SIZE != 0;
        largest <= rounding || one_sign && least > 0.0 && largest <= SUPPORT * least
    }
}

/// Computes the differences of neighbouring velocities into `w`. Returns the fields of their [`Range`]: any, all, least, largest.
#[multiversion(targets("x86_64+avx512f+avx512dq+avx512vl+avx512bw", "x86_64+avx2"))]
fn differences(v: &[f64], w: &mut [f64]) -> [u64; 4] {
    let cells = v.len() - 1;
    let (left, right, w) = (&v[..cells], &v[1..=cells], &mut w[..cells]);
    let mut range = Range { any: 0, all: !0, least: !0, largest: 0 };
    for i in 0..cells {
        w[i] = right[i] - left[i];
        range.add(w[i]);
    }
    [range.any, range.all, range.least, range.largest]
}

/// Returns the sign and the size of a velocity difference, and its neighbours, positive if they have its sign.
#[inline(always)]
fn seen_from([left, w, right]: [f64; 3]) -> (f64, f64, [f64; 2]) {
    let sense = 1.0_f64.copysign(w);
    (sense, w.abs(), [sense * left, sense * right])
}

/// Returns whether a difference of this size has the opposite sign of both its neighbours, and these are more than ripples beside a sharp
/// front.
#[inline(always)]
fn alternates(size: f64, [left, right]: [f64; 2], filter: Filter) -> bool {
    larger(left, right) < -larger(filter.rounding, RIPPLES * size)
}

/// Returns the impulse that damps the odd-even part of a difference of this size; 0 if the difference does not alternate.
#[inline(always)]
fn alternating(size: f64, neighbours: [f64; 2], filter: Filter) -> f64 {
    if alternates(size, neighbours, filter) { filter.odd_even * size } else { 0.0 }
}

/// Returns the size of the impulse for the part of a velocity difference that exceeds the mean of its neighbours', in a cell that `rings`.
/// (Never less than 0: an impulse that enlarged the difference would add energy where the neighbours have none.)
#[inline(always)]
fn ringing(w: [f64; 3], rings: bool, filter: Filter) -> f64 {
    let (_, size, neighbours) = seen_from(w);
    let above = larger(size - 0.5 * (neighbours[0] + neighbours[1]), 0.0);
    if rings && size > filter.rounding { filter.ringing * above } else { 0.0 }
}

/// Returns the impulse of a cell as a velocity difference: the odd-even part of `w` and, if the cell is strained further in the sense of
/// its `flow`, the overshoot. (Not if the strain rate has reversed: the kinetic energy is that of the mean of this difference and the one a
/// step before, which was larger and of the other sign, so that reducing this one would add energy.) With `STOPS`, a cell whose strain rate
/// is opposite to its flow does not count as alternating: a sharp wave stops its flow.
#[inline(always)]
fn impulse<const STOPS: bool>(w: [f64; 3], flow: f64, filter: Filter) -> f64 {
    let (_, _, neighbours) = seen_from(w);
    let supported = SUPPORT * larger(lesser(neighbours[0], neighbours[1]), 0.0);
    ripples::<STOPS>(w, flow, filter, [filter.overshoot, supported])
}

/// As [`impulse`], with the overshoot given by a `share` of the part above the `supported` size.
#[inline(always)]
fn ripples<const STOPS: bool>(w: [f64; 3], flow: f64, filter: Filter, [share, supported]: [f64; 2]) -> f64 {
    let (sense, size, neighbours) = seen_from(w);
    let above = larger(size - supported, 0.0);
    let overshoot = if flow * w[1] > 0.0 { share * above } else { 0.0 };
    let stops = STOPS && flow * w[1] < 0.0;
    let alternating = if stops { 0.0 } else { alternating(size, neighbours, filter) };
    sense * (alternating + overshoot)
}

/// Computes the impulses of the cells of a block in which nothing flows; `w` holds their differences and one more on either side. Returns
/// whether any is nonzero.
#[multiversion(targets("x86_64+avx512f+avx512dq+avx512vl+avx512bw", "x86_64+avx2"))]
fn find(w: &[f64], filter: Filter, impulses: &mut [f64]) -> bool {
    let cells = impulses.len();
    let (left, here, right) = (&w[..cells], &w[1..=cells], &w[2..cells + 2]);
    let mut bits = 0;
    for i in 0..cells {
        let (sense, size, neighbours) = seen_from([left[i], here[i], right[i]]);
        impulses[i] = sense * alternating(size, neighbours, filter);
        bits |= impulses[i].to_bits();
    }
    bits & Range::SIZE != 0
}

/// As [`find`], for a block with cells that flow.
#[multiversion(targets("x86_64+avx512f+avx512dq+avx512vl+avx512bw", "x86_64+avx2"))]
fn find_flowing(w: &[f64], flow: &[f32], filter: Filter, impulses: &mut [f64]) -> bool {
    let cells = impulses.len();
    let (left, here, right, flow) = (&w[..cells], &w[1..=cells], &w[2..cells + 2], &flow[..cells]);
    let mut bits = 0;
    for i in 0..cells {
        impulses[i] = impulse::<true>([left[i], here[i], right[i]], f64::from(flow[i]), filter);
        bits |= impulses[i].to_bits();
    }
    bits & Range::SIZE != 0
}

/// As [`find`], where there can be shocks. `FLOWS`: some cell flows, or crosses the elastic range inside a shock.
#[multiversion(targets("x86_64+avx512f+avx512dq+avx512vl+avx512bw", "x86_64+avx2"))]
fn find_shocks<const FLOWS: bool>(w: &[f64], row: &Cells<'_>, filter: Filter, impulses: &mut [f64]) -> bool {
    let cells = impulses.len();
    let (left, here, right) = (&w[..cells], &w[1..=cells], &w[2..cells + 2]);
    let (flow, have_flowed, sigma) = (&row.flow[..cells], &row.have_flowed[..cells], &row.sigma[..cells]);
    let mean = &row.mean[..cells];
    let mut bits = 0;
    for i in 0..cells {
        let w = [left[i], here[i], right[i]];
        let (_, size, neighbours) = seen_from(w);
        let [ripples, viscosity] = if FLOWS {
            let flow = f64::from(flow[i]);
            let viscosity = filter.viscosity(mean[i], flow, sigma[i], crosses(have_flowed[i]));
            [impulse::<false>(w, flow, filter).abs(), viscosity]
        } else {
            [alternating(size, neighbours, filter), 0.0]
        };
        let ringing = ringing(w, have_flowed[i] > 0 && !(FLOWS && flow[i] != 0.0), filter);
        let most = if alternates(size, neighbours, filter) { filter.alternating } else { LARGEST_FRACTION };
        let most = if crosses(have_flowed[i]) && viscosity > 0.0 { 0.0 } else { larger(most - 0.5 * viscosity, 0.0) };
        impulses[i] = lesser(ripples + ringing, most * size).copysign(here[i]) + viscosity * mean[i];
        bits |= impulses[i].to_bits();
    }
    bits & Range::SIZE != 0
}

/// Applies the impulses to these nodes inside a block. `gain` is dt/(rho dx). Returns the sum over the nodes of twice the energy taken per
/// node mass, (m/s)^2.
///
/// With v and v' the velocities before and after, and g = gain times the stress difference at the node, a node loses m (v - v') (v + v' -
/// g)/2 of the energy that the scheme conserves (see the ledger's kinetic energy).
#[multiversion(targets("x86_64+avx512f+avx512dq+avx512vl+avx512bw", "x86_64+avx2"))]
pub(super) fn apply_impulses(
    gain: f64,
    sigma: &[f64],
    impulses: &[f64],
    v: &mut [f64],
    nodes: ops::Range<usize>,
) -> f64 {
    let (impulses, sigma, v) = (&impulses[nodes.start - 1..], &sigma[nodes.start - 1..], &mut v[nodes]);
    let nodes = v.len();
    let (left, right) = (&impulses[..nodes], &impulses[1..=nodes]);
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

/// Adds the velocity change to a node and returns (v - v') (v + v' - g).
#[inline(always)]
pub(super) fn node(g: f64, change: f64, v: &mut f64) -> f64 {
    let before = *v;
    *v = before + change;
    -change * (before + *v - g)
}
