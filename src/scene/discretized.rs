//! Tapered segments as staircases of uniform pieces, for methods whose media are uniform.
//!
//! A piece has the exact mean area over its length, and all pieces of a segment have one length, so that waves that split at
//! their joints meet again in points. At a step from area A to B a wave leaves the part (B - A)/(B + A) of its force behind.
//! The number of pieces is the smallest that keeps this below a share r at every step, which bounds |A'/A| h by 2 r for
//! pieces of length h. Against the true taper, forces and velocities of waves longer than the pieces are right to h^2; at a
//! place inside a piece the stress is off by up to r, since it is the force over the piece's mean area.

use super::{Method, Scene};
use crate::bar::{Joint, Origin, Segment};
use crate::law::rupture::Site;

/// Of a scene whose tapered segments were cut into pieces: what was asked for.
#[derive(Debug, Clone)]
pub struct TaperDiscretization {
    /// The scene with its tapers.
    pub original: Scene,
    /// For each piece, the segment of the scene that was asked for.
    pub of: Vec<usize>,
    /// Largest part of a wave's force that a step between two pieces of a segment reflects.
    pub reflects: f64,
}

/// Most pieces of a segment: events of front tracking grow with their square.
pub const MOST_PIECES: usize = 2000;

/// What a step may reflect on a net; by front tracking, in parts of the front tolerance, and its bounds.
const ON_A_NET: f64 = 0.01;
const PER_TOLERANCE: f64 = 10.0;
const WITH_FRONTS: [f64; 2] = [0.002, 0.05];

impl Scene {
    /// The same scene with uniform pieces in the place of its tapered segments; none where the method needs no pieces.
    pub fn in_pieces(&self) -> Option<Self> {
        let share = share(&self.solve.method)?;
        self.bar.segments.iter().any(|segment| segment.taper.is_some()).then(|| self.discretized_finer_than(share))
    }

    /// The same with at most this part of a wave reflected at each step, 0 < share < 1.
    #[must_use]
    pub fn discretized_finer_than(&self, share: f64) -> Self {
        let mut scene = self.clone();
        scene.bar.segments.clear();
        let (mut of, mut notches, mut joint_notches) = (Vec::new(), Vec::new(), Vec::new());
        for (k, segment) in self.bar.segments.iter().enumerate() {
            let pieces = pieces(self, segment, share);
            let last = pieces.len() - 1;
            for (i, piece) in pieces.into_iter().enumerate() {
                scene.bar.segments.push(piece);
                of.push(k);
                if let Some(rupture) = &self.effects.rupture {
                    notches.push(rupture.notches[k]);
                    joint_notches.push(if i == last { rupture.joint_notches[k] } else { 1.0 });
                }
            }
        }
        if let Some(rupture) = &mut scene.effects.rupture {
            (rupture.notches, rupture.joint_notches) = (notches, joint_notches);
        }
        let steps = scene.bar.segments.windows(2).zip(of.windows(2)).filter(|(_, of)| of[0] == of[1]);
        let reflected = |pair: &[Segment]| ((pair[1].area - pair[0].area) / (pair[1].area + pair[0].area)).abs();
        let reflects = steps.map(|(pair, _)| reflected(pair)).fold(0.0, f64::max);
        scene.discretized = Some(Box::new(TaperDiscretization { original: self.clone(), of, reflects }));
        scene
    }

    /// The joint or end of the scene that was asked for.
    pub fn original_origin(&self, origin: Origin) -> Origin {
        match (&self.discretized, origin) {
            (Some(cut), Origin::Joint(k)) => Origin::Joint(cut.of[k]),
            _ => origin,
        }
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
        (Some(taper), Some(share)) => needed(taper.steepest() * segment.length, share),
        _ => 1.0,
    }
}

fn needed(change: f64, share: f64) -> f64 {
    // Neighbouring means differ by a factor of at most e^(change/pieces), which reflects tanh of half its exponent.
    (change / (2.0 * share)).ceil().max(1.0)
}

fn pieces(scene: &Scene, segment: &Segment, share: f64) -> Vec<Segment> {
    let Some(taper) = &segment.taper else { return vec![segment.clone()] };
    let mut count = needed(taper.steepest() * segment.length, share);
    if let Method::CharacteristicNet { cells } = scene.solve.method {
        // A whole number of cells in each piece, as nearly as may be.
        let own = cells as f64 * segment.length / segment.material.c0() / scene.bar.transit_time();
        let in_a_piece = (own / count).floor().max(1.0);
        count = (own / in_a_piece).round().max(1.0);
    }
    let count = count as usize;
    let border = |i: usize| segment.length * (i as f64 / count as f64);
    let piece = |i: usize| Segment {
        length: segment.length / count as f64,
        area: taper.mean(border(i), border(i + 1)),
        taper: None,
        joint: if i + 1 == count { segment.joint } else { Joint::Bonded },
        ..segment.clone()
    };
    (0..count).map(piece).collect()
}
