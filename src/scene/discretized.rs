//! Discretization of tapered segments into staircases of uniform pieces, for methods with uniform media, and of initial states that vary along a
//! segment into staircases, for front tracking.
//!
//! A piece has the exact mean area over its length. All pieces of a segment have the same length, so that waves that split at their joints meet again
//! in points. At a step from area A to B, the fraction (B - A)/(B + A) of the force of a wave is reflected. The number of pieces is at least the
//! smallest one that keeps this fraction below a limit r at every step, which bounds |A'/A| h by 2 r for pieces of length h. On a net a piece has at
//! most 32 cells. Compared with the true taper, the error of forces and velocities is of order h^2 for waves longer than the pieces. At a position
//! inside a piece the relative error of the stress is up to r, because the stress is the force divided by the mean area of the piece.
//!
//! The steps of the staircase of an initial state lie between the rows of its tables, and each step has the mean value of the table. Their number is
//! chosen such that no step is larger than the same fraction r of the largest magnitude of its quantity (for stress and velocity: of the larger of
//! stress and Z v). The mean deviation from the tables is at most r/4. Momentum and mean strain are those of the tables.

use std::sync::Arc;

use super::{Method, Scene};
use crate::bar::{Bar, InitialProfile, Joint, Origin, Segment, Taper};
use crate::law::rupture::Site;

/// Discretization of a scene whose tapered segments or initial states were divided into pieces, with the original scene.
#[derive(Debug, Clone)]
pub struct TaperDiscretization {
    /// Original scene with its tapers and initial states.
    pub original: Scene,
    /// Segment of the original scene to which each piece belongs.
    pub of: Vec<usize>,
    /// Upper bound of the fraction of a wave's force that a step reflects. Adjacent pieces can have equal areas, on the two sides of a thick section,
    /// without a step.
    pub share: f64,
    /// Largest fraction of a wave's force that is actually reflected at a step between two pieces of a segment.
    pub reflects: f64,
    /// Largest step of the staircase of an initial state, relative to the largest magnitude of its quantity; 0 without a staircase.
    pub largest_step: f64,
    /// Number of steps of the staircase of the initial state.
    pub steps: usize,
}

/// Largest number of pieces of a segment: the number of events of front tracking increases with its square.
pub const MOST_PIECES: usize = 2000;

/// Number of cells per piece on a net, unless the piece is short. (With 8 cells, the joints need more than half of the computing time.) Finer nets
/// have smaller pieces and follow the taper more closely, so that error estimates from coarser nets include the error of the pieces.
const CELLS_OF_A_PIECE: f64 = 32.0;

/// Largest fraction reflected at a step: on a net; for front tracking, relative to the front tolerance, and its bounds.
const ON_A_NET: f64 = 0.01;
const PER_TOLERANCE: f64 = 10.0;
const WITH_FRONTS: [f64; 2] = [0.002, 0.05];

impl TaperDiscretization {
    /// Returns whether any segment is tapered.
    pub fn has_tapers(&self) -> bool {
        self.original.bar.segments.iter().any(|segment| segment.taper.is_some())
    }
}

impl Scene {
    /// Returns the scene with tapered segments, and for front tracking varying initial states, divided into uniform pieces; `None` if the method
    /// needs no pieces.
    pub fn in_pieces(&self) -> Option<Self> {
        let share = share(&self.solve.method)?;
        let tapers = self.bar.segments.iter().any(|segment| segment.taper.is_some());
        (tapers || self.initial_state_needs_steps()).then(|| self.discretized_finer_than(share))
    }

    /// Returns whether the initial state must be discretized: front tracking requires states that are constant between jumps.
    fn initial_state_needs_steps(&self) -> bool {
        let slopes = |segment: &Segment| segment.profile.as_ref().is_some_and(|profile| profile.has_slopes());
        self.solve.method.tracks_fronts() && self.bar.segments.iter().any(slopes)
    }

    /// Returns the scene divided into pieces such that at most the fraction `share` of a wave is reflected at each step, 0 < share < 1.
    #[must_use]
    pub fn discretized_finer_than(&self, share: f64) -> Self {
        let mut scene = self.clone();
        scene.parts.bar.segments.clear();
        let (mut of, mut notches, mut joint_notches) = (Vec::new(), Vec::new(), Vec::new());
        for (k, segment) in self.bar.segments.iter().enumerate() {
            let pieces = pieces(self, segment, share);
            let last = pieces.len() - 1;
            for (i, piece) in pieces.into_iter().enumerate() {
                scene.parts.bar.segments.push(piece);
                of.push(k);
                if let Some(rupture) = &self.effects.rupture {
                    notches.push(rupture.notches[k]);
                    joint_notches.push(if i == last { rupture.joint_notches[k] } else { 1.0 });
                }
            }
        }
        if let Some(rupture) = &mut scene.parts.effects.rupture {
            (rupture.notches, rupture.joint_notches) = (notches, joint_notches);
        }
        let (mut steps, mut largest_step) = (0, 0.0_f64);
        if self.initial_state_needs_steps() {
            let largest = largest_sizes(&scene.bar);
            for segment in &mut scene.parts.bar.segments {
                let Some(profile) = &segment.profile else { continue };
                let (borders, step) = borders(segment, profile, largest, share);
                steps += borders.len() - 2;
                largest_step = largest_step.max(step);
                segment.profile = Some(Arc::new(profile.staircase(&borders)));
            }
        }
        let joints = scene.bar.segments.windows(2).zip(of.windows(2)).filter(|(_, of)| of[0] == of[1]);
        let reflected = |pair: &[Segment]| ((pair[1].area - pair[0].area) / (pair[1].area + pair[0].area)).abs();
        let reflects = joints.map(|(pair, _)| reflected(pair)).fold(0.0, f64::max);
        scene.parts.discretized =
            Some(Box::new(TaperDiscretization { original: self.clone(), of, share, reflects, largest_step, steps }));
        scene
    }

    /// Returns the segment of the original scene to which a segment belongs.
    pub fn original_segment(&self, segment: usize) -> usize {
        self.discretized.as_ref().map_or(segment, |cut| cut.of[segment])
    }

    /// Returns the joint or end of the original scene.
    pub fn original_origin(&self, origin: Origin) -> Origin {
        match (&self.discretized, origin) {
            (Some(cut), Origin::Joint(k)) => Origin::Joint(cut.of[k]),
            _ => origin,
        }
    }

    /// Returns the segments to the left of the joints of the original scene.
    pub fn joints(&self) -> Vec<usize> {
        let is_joint = |&k: &usize| self.original_segment(k) != self.original_segment(k + 1);
        (0..self.bar.segments.len() - 1).filter(is_joint).collect()
    }

    /// Returns the site in the original scene: a joint between two pieces is inside their segment.
    pub fn original_site(&self, site: Site) -> Site {
        match (&self.discretized, site) {
            (Some(cut), Site::Joint(k)) if cut.of.get(k + 1) == Some(&cut.of[k]) => Site::Inside(cut.of[k]),
            (Some(cut), Site::Joint(k)) => Site::Joint(cut.of[k]),
            (Some(cut), Site::Inside(k)) => Site::Inside(cut.of[k]),
            _ => site,
        }
    }
}

/// Returns the largest fraction that a step may reflect; `None` for a method that resolves tapers directly.
fn share(method: &Method) -> Option<f64> {
    match *method {
        // Tapers are refused for the scheme muscl.
        Method::Leapfrog { .. } | Method::Muscl { .. } => None,
        Method::CharacteristicNet { .. } => Some(ON_A_NET),
        Method::FrontTracking { front_tolerance, .. } => {
            Some((PER_TOLERANCE * front_tolerance).clamp(WITH_FRONTS[0], WITH_FRONTS[1]))
        }
    }
}

/// Returns the number of pieces that a segment needs with this method; 1 for a uniform segment, or if the method resolves tapers directly.
pub(super) fn pieces_needed(segment: &Segment, method: &Method) -> f64 {
    match (&segment.taper, share(method)) {
        (Some(taper), Some(share)) => needed(taper, segment.length, share),
        _ => 1.0,
    }
}

fn needed(taper: &Taper, length: f64, share: f64) -> f64 {
    // Adjacent mean areas differ by a factor of at most e^(change/pieces); the reflected fraction is the tanh of half this exponent.
    let steps = (taper.steepest() * length / (2.0 * share)).ceil().max(1.0);
    // Pieces that extend over both sides of a thick or thin section would all have the same area, so every monotonic part has at least two pieces.
    let seen = |[part, grown]: [f64; 2]| if grown.abs() > share && part < length { 2.0 * length / part } else { 1.0 };
    taper.stretches().into_iter().map(seen).fold(steps, f64::max).ceil()
}

fn pieces(scene: &Scene, segment: &Segment, share: f64) -> Vec<Segment> {
    let Some(taper) = &segment.taper else { return vec![segment.clone()] };
    let mut count = needed(taper, segment.length, share);
    if let Method::CharacteristicNet { cells } = scene.solve.method {
        // Each piece has a whole number of cells, as nearly as possible.
        let own = cells as f64 * segment.length / segment.material.c0() / scene.bar.transit_time();
        count = count.max((own / CELLS_OF_A_PIECE).min(MOST_PIECES as f64));
        let in_a_piece = (own / count).floor().max(1.0);
        count = (own / in_a_piece).round().max(1.0);
    }
    let count = count as usize;
    let border = |i: usize| segment.length * (i as f64 / count as f64);
    let piece = |i: usize| Segment {
        length: segment.length / count as f64,
        area: taper.mean(border(i), border(i + 1)),
        taper: None,
        velocity: segment.velocity_between(border(i), border(i + 1)),
        initial: segment.initial_between(border(i), border(i + 1)),
        profile: segment.profile.as_ref().map(|profile| Arc::new(profile.part(border(i), border(i + 1)))),
        joint: if i + 1 == count { segment.joint } else { Joint::Bonded },
        ..segment.clone()
    };
    (0..count).map(piece).collect()
}

/// Returns the largest magnitudes over the bar of stress and Z v (Pa), of plastic strain and of temperature rise (K); 1 if a quantity is zero
/// everywhere. A uniform motion of the bar does not count in v.
fn largest_sizes(bar: &Bar) -> [f64; 3] {
    let (mut largest, mut impedance) = ([0.0_f64; 3], 0.0_f64);
    let (mut slowest, mut fastest) = (f64::INFINITY, f64::NEG_INFINITY);
    for segment in &bar.segments {
        let initial = &segment.initial;
        let sizes = segment.profile.as_ref().map_or_else(
            || [initial.stress.abs(), initial.accumulated, initial.temperature_rise],
            |p| [&p.stress, &p.accumulated, &p.temperature_rise].map(crate::bar::Distribution::largest),
        );
        largest.iter_mut().zip(sizes).for_each(|(most, size)| *most = most.max(size));
        let along = segment.profile.iter().flat_map(|profile| profile.velocity.rows().map(|row| row.1));
        for velocity in along.chain(segment.profile.is_none().then_some(segment.velocity)) {
            (slowest, fastest) = (slowest.min(velocity), fastest.max(velocity));
        }
        impedance = impedance.max(segment.material.impedance());
    }
    let velocity = (fastest - slowest).min(fastest.abs().max(slowest.abs()));
    largest[0] = largest[0].max(impedance * velocity);
    largest.map(|size| if size > 0.0 { size } else { 1.0 })
}

/// Returns the number of steps in the staircases of the initial states of a bar for this method; 0 if it needs none.
pub(super) fn steps_needed(bar: &Bar, method: &Method) -> usize {
    let Some(share) = share(method).filter(|_| method.tracks_fronts()) else { return 0 };
    let largest = largest_sizes(bar);
    let of = |segment: &Segment| {
        let profile = segment.profile.as_ref().filter(|profile| profile.has_slopes());
        profile.map_or(0, |profile| borders(segment, profile, largest, share).0.len() - 2)
    };
    bar.segments.iter().map(of).sum()
}

/// Returns the positions of the steps of a segment's staircase, m, including both ends, and the largest step relative to the `largest` magnitudes in
/// the bar. No step is larger than `share`, unless the number of steps is limited by [`MOST_PIECES`].
fn borders(segment: &Segment, profile: &InitialProfile, largest: [f64; 3], share: f64) -> (Vec<f64>, f64) {
    let sizes = [segment.material.impedance() / largest[0], 1.0 / largest[0], 1.0 / largest[1], 1.0 / largest[2]];
    let length = segment.length;
    let mut knots = profile.knots();
    knots.retain(|&x| x < length);
    knots.push(length);
    let (mut borders, mut largest) = (vec![0.0], 0.0_f64);
    let tables = [&profile.velocity, &profile.stress, &profile.accumulated, &profile.temperature_rise];
    for pair in knots.windows(2) {
        let changes =
            tables.iter().zip(sizes).map(|(table, size)| size * (table.before(pair[1]) - table.at(pair[0])).abs());
        let change = changes.fold(0.0, f64::max);
        let count = (change / share).ceil().clamp(1.0, MOST_PIECES as f64) as usize;
        largest = largest.max(change / count as f64);
        let place = |i: usize| pair[0] + (pair[1] - pair[0]) * (i as f64 / count as f64);
        borders.extend((1..count).map(place).chain([pair[1]]));
    }
    (borders, largest)
}
