//! Tapered segments as staircases of uniform pieces, for methods whose media are uniform; and initial states that change along a segment as
//! staircases, for front tracking.
//!
//! A piece has the exact mean area over its length, and all pieces of a segment have one length, so that waves that split at
//! their joints meet again in points. At a step from area A to B a wave leaves the part (B - A)/(B + A) of its force behind.
//! The number of pieces is at least the one that keeps this below a share r at every step, which bounds |A'/A| h by 2 r for
//! pieces of length h; on a net a piece has at most 32 cells. Against the true taper, forces and velocities of waves longer than
//! the pieces are right to h^2; at a place inside a piece the stress is off by up to r, since it is the force over the piece's mean area.
//!
//! A staircase of an initial state has steps between the rows of its tables only, with the mean in each, and as many that none of them is
//! larger than the same share r of the largest size of its quantity (of the larger of stress and Z v for both of these). Its mean distance
//! from the tables is r/4 at the most; momentum and mean strain are those of the tables.

use std::sync::Arc;

use super::{Method, Scene};
use crate::bar::{Bar, InitialProfile, Joint, Origin, Segment, Taper};
use crate::law::rupture::Site;

/// Of a scene whose tapered segments were cut into pieces: what was asked for.
#[derive(Debug, Clone)]
pub struct TaperDiscretization {
    /// The scene with its tapers.
    pub original: Scene,
    /// For each piece, the segment of the scene that was asked for.
    pub of: Vec<usize>,
    /// No step was to be larger: those on either side of a thick place may be equal, and leave none.
    pub share: f64,
    /// Largest part of a wave's force that a step between two pieces of a segment reflects.
    pub reflects: f64,
    /// Largest step of the staircase of an initial state, relative to the largest size of its quantity; 0 where there is none.
    pub largest_step: f64,
    /// Steps of that staircase.
    pub steps: usize,
}

/// Most pieces of a segment: events of front tracking grow with their square.
pub const MOST_PIECES: usize = 2000;

/// Cells of a piece on a net, unless it is short (with 8 the joints take more than half of the time): finer nets follow the taper more
/// closely, and errors that are estimated from coarser ones hold that of the pieces.
const CELLS_OF_A_PIECE: f64 = 32.0;

/// What a step may reflect on a net; by front tracking, in parts of the front tolerance, and its bounds.
const ON_A_NET: f64 = 0.01;
const PER_TOLERANCE: f64 = 10.0;
const WITH_FRONTS: [f64; 2] = [0.002, 0.05];

impl TaperDiscretization {
    /// Some segment is tapered.
    pub fn has_tapers(&self) -> bool {
        self.original.bar.segments.iter().any(|segment| segment.taper.is_some())
    }
}

impl Scene {
    /// The same scene with uniform pieces in the place of its tapered segments; none where the method needs no pieces.
    pub fn in_pieces(&self) -> Option<Self> {
        let share = share(&self.solve.method)?;
        let tapers = self.bar.segments.iter().any(|segment| segment.taper.is_some());
        (tapers || self.initial_state_needs_steps()).then(|| self.discretized_finer_than(share))
    }

    /// Front tracking follows states that are constant between jumps.
    fn initial_state_needs_steps(&self) -> bool {
        let slopes = |segment: &Segment| segment.profile.as_ref().is_some_and(|profile| profile.has_slopes());
        self.solve.method.tracks_fronts() && self.bar.segments.iter().any(slopes)
    }

    /// The same with at most this part of a wave reflected at each step, 0 < share < 1.
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

    /// The segment of the scene that was asked for, of which this one is a piece.
    pub fn original_segment(&self, segment: usize) -> usize {
        self.discretized.as_ref().map_or(segment, |cut| cut.of[segment])
    }

    /// The joint or end of the scene that was asked for.
    pub fn original_origin(&self, origin: Origin) -> Origin {
        match (&self.discretized, origin) {
            (Some(cut), Origin::Joint(k)) => Origin::Joint(cut.of[k]),
            _ => origin,
        }
    }

    /// The segments on the left of the joints of the original scene.
    pub fn joints(&self) -> Vec<usize> {
        let is_joint = |&k: &usize| self.original_segment(k) != self.original_segment(k + 1);
        (0..self.bar.segments.len() - 1).filter(is_joint).collect()
    }

    /// The place in the scene that was asked for: a joint between two pieces is inside their segment.
    pub fn original_site(&self, site: Site) -> Site {
        match (&self.discretized, site) {
            (Some(cut), Site::Joint(k)) if cut.of.get(k + 1) == Some(&cut.of[k]) => Site::Inside(cut.of[k]),
            (Some(cut), Site::Joint(k)) => Site::Joint(cut.of[k]),
            (Some(cut), Site::Inside(k)) => Site::Inside(cut.of[k]),
            _ => site,
        }
    }
}

/// What a step may reflect; none for a method that follows the taper itself.
fn share(method: &Method) -> Option<f64> {
    match *method {
        // The scheme muscl is refused one.
        Method::Leapfrog { .. } | Method::Muscl { .. } => None,
        Method::CharacteristicNet { .. } => Some(ON_A_NET),
        Method::FrontTracking { front_tolerance, .. } => {
            Some((PER_TOLERANCE * front_tolerance).clamp(WITH_FRONTS[0], WITH_FRONTS[1]))
        }
    }
}

/// Pieces that a tapered segment needs by this method; 1 where it follows the taper, or there is none.
pub(super) fn pieces_needed(segment: &Segment, method: &Method) -> f64 {
    match (&segment.taper, share(method)) {
        (Some(taper), Some(share)) => needed(taper, segment.length, share),
        _ => 1.0,
    }
}

fn needed(taper: &Taper, length: f64, share: f64) -> f64 {
    // Neighbouring means differ by a factor of at most e^(change/pieces), which reflects tanh of half its exponent.
    let steps = (taper.steepest() * length / (2.0 * share)).ceil().max(1.0);
    // Pieces that each have both sides of a thick or thin place would all be alike.
    let seen = |[part, grown]: [f64; 2]| if grown.abs() > share && part < length { 2.0 * length / part } else { 1.0 };
    taper.stretches().into_iter().map(seen).fold(steps, f64::max).ceil()
}

fn pieces(scene: &Scene, segment: &Segment, share: f64) -> Vec<Segment> {
    let Some(taper) = &segment.taper else { return vec![segment.clone()] };
    let mut count = needed(taper, segment.length, share);
    if let Method::CharacteristicNet { cells } = scene.solve.method {
        // A whole number of cells in each piece, as nearly as may be.
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

/// Of stress and Z v (Pa), of plastic strain, and of the rise in temperature (K), over the bar; 1 where all are 0. A uniform motion is no
/// part of v.
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

/// Steps of the staircases of the initial states of a bar by this method; 0 where it needs none.
pub(super) fn steps_needed(bar: &Bar, method: &Method) -> usize {
    let Some(share) = share(method).filter(|_| method.tracks_fronts()) else { return 0 };
    let largest = largest_sizes(bar);
    let of = |segment: &Segment| {
        let profile = segment.profile.as_ref().filter(|profile| profile.has_slopes());
        profile.map_or(0, |profile| borders(segment, profile, largest, share).0.len() - 2)
    };
    bar.segments.iter().map(of).sum()
}

/// Where the steps of a segment's staircase are, m, ends included, and the largest of them, relative to the `largest` sizes in the bar. None
/// is larger than `share`.
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
