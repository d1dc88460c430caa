//! Front table of a front-tracking bar: the initial fans edge by edge, and all active fronts at the end time. Positions, times and speeds are exact.

use serde::{Deserialize, Serialize};

use super::{FrontRow, PathRow};
use crate::bar::{Driver, InitialFan};
use crate::solver::moc::{FrontSegment, FrontTracking};
use crate::wave::similarity::Edge;

/// Origin of a front that is not an edge of an initial fan: it started later, at an end or a joint, or where other fronts met.
pub const INTERIOR: &str = "interior";

/// Difference, relative to the stress scale, up to which two stresses are equal: the theoretical edges and the tracked
/// fronts are computed from one table in two ways.
const SAME_LEVEL: f64 = 1e-9;

/// The same tolerance for the fan of a striking body, which the bar slows down in the first step.
const SLOWED_LEVEL: f64 = 1e-4;

/// Duration, relative to the present time, up to which a front has only just started: the distance that it has travelled
/// consists of rounding.
const JUST_STARTED: f64 = 1e-9;

/// Largest number of rows of `/paths`, about 100 MB.
const MOST_PATHS: usize = 2_000_000;

/// Front segments that the front table needs.
#[derive(Debug, Default, Serialize, Deserialize)]
pub struct TrackedFronts {
    /// Front segments that started at t = 0 and have ended, each extended by the segments that continue it.
    first: Vec<FrontSegment>,
}

impl TrackedFronts {
    /// Adds front segments that have ended.
    pub fn collect(&mut self, ended: &[FrontSegment]) {
        for piece in ended {
            if piece.t[0] == 0.0 {
                self.first.push(*piece);
            } else {
                self.lengthen(piece);
            }
        }
    }

    /// Extends the segment that `piece` continues; returns false if there is none.
    fn lengthen(&mut self, piece: &FrontSegment) -> bool {
        let before = self.first.iter_mut().find(|before| continues(piece, before));
        let found = before.map(|before| (before.t[1], before.x[1]) = (piece.t[1], piece.x[1]));
        found.is_some()
    }

    /// Returns the front table, with the arrival times of each front at gauges (name, place in m) along its straight segment.
    pub fn rows(&self, bar: &FrontTracking, initial_fans: &[InitialFan], gauges: &[(String, f64)]) -> Vec<FrontRow> {
        let mut ended = Self { first: self.first.clone() };
        let living: Vec<FrontSegment> = bar.living_front_segments().filter(|piece| !ended.lengthen(piece)).collect();
        let all: Vec<FrontSegment> = ended.first.iter().chain(&living).copied().collect();
        let mut taken = vec![false; all.len()];
        let mut rows = Vec::new();
        for initial_fan in initial_fans {
            for edge in &initial_fan.fan.edges {
                let found = all.iter().zip(&taken).position(|(t, taken)| !taken && is_edge(bar, initial_fan, edge, t));
                if let Some(k) = found {
                    taken[k] = true;
                }
                rows.push(edge_row(initial_fan, edge, found.map(|k| &all[k]), gauges));
            }
        }
        let rest = living.iter().zip(&taken[self.first.len()..]).filter(|(_, taken)| !**taken);
        rows.extend(rest.map(|(piece, _)| front_row(bar, piece, gauges)));
        rows
    }
}

/// Returns true if a segment starts where another one ended, with the same speed and stresses, as if a wave behind a front only came near it.
fn continues(piece: &FrontSegment, before: &FrontSegment) -> bool {
    let same = |a: f64, b: f64| (a - b).abs() <= SAME_LEVEL * (a.abs() + b.abs());
    piece.t[0] == before.t[1]
        && piece.x[0] == before.x[1]
        && same(piece.speed, before.speed)
        && same(piece.ahead.stress, before.ahead.stress)
        && same(piece.behind.stress, before.behind.stress)
}

/// Returns true if a segment is this edge of this fan.
fn is_edge(bar: &FrontTracking, initial_fan: &InitialFan, edge: &Edge, piece: &FrontSegment) -> bool {
    let sign = initial_fan.sense.sign();
    let level = if initial_fan.driver == Driver::Body { SLOWED_LEVEL } else { SAME_LEVEL };
    let same = |found: f64, theory: f64| (found - sign * theory).abs() <= level * bar.stress_scale();
    piece.t[0] == 0.0
        && piece.segment == initial_fan.segment
        && piece.speed * initial_fan.direction > 0.0
        && (piece.x[0] - initial_fan.x).abs() <= SAME_LEVEL * initial_fan.x.abs()
        && same(piece.ahead.stress, edge.stress_ahead)
        && same(piece.behind.stress, edge.stress_behind)
}

fn edge_row(initial_fan: &InitialFan, edge: &Edge, piece: Option<&FrontSegment>, gauges: &[(String, f64)]) -> FrontRow {
    let sign = initial_fan.sense.sign();
    FrontRow {
        origin: initial_fan.origin.to_string(),
        strain_behind: sign * edge.strain_behind,
        strain_ahead: sign * edge.strain_ahead,
        stress_behind: sign * edge.stress_behind,
        stress_ahead: sign * edge.stress_ahead,
        speed: initial_fan.direction * edge.speed,
        speed_measured: piece.map_or(f64::NAN, measured_speed),
        position: piece.map_or(f64::NAN, |t| t.x[1]),
        last_seen: piece.map_or(f64::NAN, |t| t.t[1]),
        load_held_until: initial_fan.holds_until,
        arrivals: gauges.iter().map(|(_, x)| piece.map_or(f64::NAN, |t| arrival(t, *x))).collect(),
    }
}

fn front_row(bar: &FrontTracking, piece: &FrontSegment, gauges: &[(String, f64)]) -> FrontRow {
    let medium = bar.medium(piece.segment);
    let (ahead, behind) = (&piece.ahead, &piece.behind);
    FrontRow {
        origin: INTERIOR.into(),
        strain_behind: medium.strain(behind),
        strain_ahead: medium.strain(ahead),
        stress_behind: behind.stress,
        stress_ahead: ahead.stress,
        speed: medium.front_speed(ahead, behind).copysign(piece.speed),
        speed_measured: measured_speed(piece),
        position: piece.x[1],
        last_seen: piece.t[1],
        load_held_until: f64::NAN,
        arrivals: gauges.iter().map(|(_, x)| arrival(piece, *x)).collect(),
    }
}

/// Returns the speed, m/s, positive in +x; NaN for a front that has only just started.
fn measured_speed(piece: &FrontSegment) -> f64 {
    let ([from, to], [start, end]) = (piece.x, piece.t);
    if end - start <= JUST_STARTED * end { f64::NAN } else { (to - from) / (end - start) }
}

/// Returns the time at which a front passed a place, s; NaN if it did not.
fn arrival(piece: &FrontSegment, x: f64) -> f64 {
    let [from, to] = piece.x;
    if x < from.min(to) || x > from.max(to) || from == to {
        return f64::NAN;
    }
    piece.t[0] + (x - from) / (to - from) * (piece.t[1] - piece.t[0])
}

/// Generator of the rows of `/paths`, up to a maximum number.
#[derive(Debug, Serialize, Deserialize)]
pub struct Paths {
    /// Number of rows that may still be added.
    room: usize,
    left_out: bool,
}

impl Default for Paths {
    fn default() -> Self {
        Self { room: MOST_PATHS, left_out: false }
    }
}

impl Paths {
    /// Returns the rows of front segments with a positive duration.
    pub fn rows(&mut self, front_segments: impl Iterator<Item = FrontSegment>) -> Vec<PathRow> {
        let mut lasting = front_segments.filter(|t| t.t[1] > t.t[0]).map(|t| row(&t));
        let rows: Vec<PathRow> = lasting.by_ref().take(self.room).collect();
        self.left_out |= lasting.next().is_some();
        self.room -= rows.len();
        rows
    }

    /// Returns true if every segment so far has its row.
    pub fn complete(&self) -> bool {
        !self.left_out
    }
}

fn row(piece: &FrontSegment) -> PathRow {
    PathRow {
        x0: piece.x[0],
        t0: piece.t[0],
        x1: piece.x[1],
        t1: piece.t[1],
        stress_jump: piece.behind.stress - piece.ahead.stress,
        speed: piece.speed,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::wave::riemann::Point;

    fn piece(from: f64, to: f64) -> FrontSegment {
        let behind = Point { stress: -1e6, ..Point::default() };
        FrontSegment { x: [0.0, to - from], t: [from, to], speed: 1.0, segment: 0, ahead: Point::default(), behind }
    }

    #[test]
    fn paths_past_the_limit_are_left_out_and_said_to_be() {
        let mut paths = Paths { room: 3, left_out: false };
        // A segment of zero duration has no row and does not count.
        let rows = paths.rows([piece(0.0, 1.0), piece(1.0, 1.0), piece(1.0, 3.0)].into_iter());
        assert_eq!(
            rows.iter().map(|r| (r.t0, r.t1, r.stress_jump, r.speed)).collect::<Vec<_>>(),
            [(0.0, 1.0, -1e6, 1.0), (1.0, 3.0, -1e6, 1.0)]
        );
        assert!(paths.complete());
        assert_eq!(paths.rows([piece(3.0, 4.0)].into_iter()).len(), 1);
        assert!(paths.complete());
        assert_eq!(paths.rows([piece(4.0, 5.0)].into_iter()).len(), 0);
        assert!(!paths.complete());
    }

    #[test]
    fn a_front_arrives_where_it_passes_and_nowhere_else() {
        let piece = FrontSegment { x: [0.5, 0.25], t: [1.0, 2.0], ..piece(0.0, 1.0) };
        assert_eq!((arrival(&piece, 0.375), arrival(&piece, 0.25)), (1.5, 2.0));
        assert!(arrival(&piece, 0.6).is_nan() && arrival(&piece, 0.2).is_nan());
        assert_eq!(measured_speed(&piece), -0.25);
        let newborn = FrontSegment { x: [0.5, 0.5 + 1e-16], t: [1.0, 1.0 + 1e-15], ..piece };
        assert!(measured_speed(&newborn).is_nan());
    }
}
