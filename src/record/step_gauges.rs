//! Exact gauge histories of a front-tracking bar, computed from the segments of the fronts that pass.

use serde::{Deserialize, Serialize};

use super::Trace;
use crate::bar::{Bar, Initial, Segment};
use crate::solver::moc::{FrontSegment, FrontTracking};

/// Distance, relative to the length of the bar, up to which two places are equal: fronts that meet at a point miss it by rounding.
const SAME_PLACE: f64 = 1e-12;

/// Time, relative to the duration of the run, by which crossings lag behind the current time. A crossing at exactly the
/// current time differs by rounding between the active front and the same front once it has ended; with the lag it is
/// counted once.
const HELD_BACK: f64 = 1e-11;

/// Histories at places, with two rows per step at one time: the state before it and the state after it.
#[derive(Debug, Serialize, Deserialize)]
pub struct StepGauges {
    gauges: Vec<StepGauge>,
    /// True if the temperature is recorded.
    heat: bool,
    /// Time up to which crossings are in the rows, s.
    done: f64,
    held_back: f64,
    /// Front segments that have ended after `done`.
    ended: Vec<FrontSegment>,
}

/// Gauge at one place. It reads the state just to the right of the place; at the right end of the bar, just to the left.
#[derive(Debug, Serialize, Deserialize)]
struct StepGauge {
    x: f64,
    /// Side on which the state is read: +1 in +x of the place, -1 in -x.
    side: f64,
    same_place: f64,
    state: State,
    crossings: Vec<Crossing>,
    started: bool,
    /// True if the temperature is recorded.
    heat: bool,
    rows: Trace,
}

/// Stress (Pa), strain, velocity (m/s) and temperature (K; unused without the effect of heat).
type State = [f64; 4];

/// Front that changes the state at the gauge.
#[derive(Debug, Clone, Copy, Serialize, Deserialize)]
struct Crossing {
    time: f64,
    /// True if the front moves away from the place into the side that is read; false if it arrives from that side.
    leaves: bool,
    /// Magnitude of the speed, m/s.
    speed: f64,
    after: State,
}

impl Crossing {
    /// Compares crossings at one place by time. At equal times, arriving fronts come first, the fastest (which lies
    /// nearest to the place) last; then come the fronts emitted by the interaction, the fastest first.
    fn order(&self, other: &Self) -> std::cmp::Ordering {
        let rank = |c: &Self| if c.leaves { -c.speed } else { c.speed };
        self.time.total_cmp(&other.time).then(self.leaves.cmp(&other.leaves)).then(rank(self).total_cmp(&rank(other)))
    }
}

impl StepGauges {
    /// Creates gauges at `places` (m) of a bar at t = 0; `until` is the end time, s.
    pub fn new(bar: &Bar, places: &[f64], until: f64) -> Self {
        let heat = bar.segments.iter().any(|s| s.material.heating.is_some());
        let gauges = places.iter().map(|&x| StepGauge::new(bar, x, heat)).collect();
        Self { gauges, heat, done: f64::NEG_INFINITY, held_back: HELD_BACK * until, ended: Vec::new() }
    }

    /// Adds the crossings since the last call; `ended` are the front segments that have ended since then.
    pub fn collect(&mut self, bar: &FrontTracking, ended: &[FrontSegment]) {
        self.collect_until(bar, ended, bar.time() - self.held_back);
    }

    /// Adds the remaining crossings at the end of the run, and closes every history with a row at that time.
    pub fn close(&mut self, bar: &FrontTracking, ended: &[FrontSegment]) {
        self.collect_until(bar, ended, f64::INFINITY);
        for gauge in &mut self.gauges {
            if gauge.rows.time.last() != Some(&bar.time()) {
                gauge.push(bar.time());
            }
        }
    }

    fn collect_until(&mut self, bar: &FrontTracking, ended: &[FrontSegment], until: f64) {
        if self.gauges.is_empty() {
            return;
        }
        self.ended.extend(ended);
        let ended = self.ended.iter().map(|piece| (*piece, false));
        for (piece, active) in ended.chain(bar.living_front_segments().map(|piece| (piece, true))) {
            let medium = bar.medium(piece.segment);
            for gauge in &mut self.gauges {
                let new = |c: &Crossing| self.done < c.time && c.time <= until;
                let point = &piece.behind;
                let temperature = if self.heat { bar.temperature(piece.segment, point) } else { 0.0 };
                let after = || [point.stress, medium.strain(point), point.velocity, temperature];
                gauge.crossings.extend(gauge.crossing(&piece, active, after).filter(new));
            }
        }
        self.done = until;
        self.ended.retain(|piece| piece.t[1] > until);
        if until >= 0.0 {
            self.gauges.iter_mut().for_each(StepGauge::add_rows);
        }
    }

    /// Returns the rows since the last call, gauge by gauge.
    pub fn take(&mut self) -> Vec<Trace> {
        self.gauges.iter_mut().map(|gauge| std::mem::take(&mut gauge.rows)).collect()
    }
}

/// Returns the state and the velocity at t = 0 just to the right of a place, `x` in m from the segment's left end; at
/// the right end of the segment, just to the left.
fn initial(segment: &Segment, x: f64, same_place: f64) -> (Initial, f64) {
    let Some(profile) = &segment.profile else { return (segment.initial, segment.velocity) };
    if x + same_place >= segment.length {
        return (profile.one_sided_limit(segment.length, 0), profile.velocity.before(segment.length));
    }
    (profile.one_sided_limit(x + same_place, 1), profile.velocity.at(x + same_place))
}

impl StepGauge {
    fn new(bar: &Bar, x: f64, heat: bool) -> Self {
        let length = bar.length();
        let same_place = SAME_PLACE * length;
        let (mut start, last) = (0.0, bar.segments.len() - 1);
        let mut k = 0;
        while k < last && x >= start + bar.segments[k].length - same_place {
            start += bar.segments[k].length;
            k += 1;
        }
        let segment = &bar.segments[k];
        let (Initial { stress, plastic_strain, .. }, velocity) = initial(segment, x - start, same_place);
        let strain = stress / segment.material.modulus + plastic_strain;
        let cold = segment.material.heating.as_ref().map_or(f64::NAN, |h| h.reference_temperature);
        Self {
            x,
            side: if x < length - same_place { 1.0 } else { -1.0 },
            same_place,
            state: [stress, strain, velocity, if heat { cold } else { 0.0 }],
            heat,
            crossings: Vec::new(),
            started: false,
            rows: Trace::default(),
        }
    }

    /// Returns the crossing of a front segment, if it changes the state at this gauge. Distances are measured from the
    /// place into the side that is read: a front that arrives from that side has passed all of it, and so has a front
    /// that leaves the place into it. An active front at the place itself has passed it only if it started there: one
    /// that arrives has not yet met what is there.
    fn crossing(&self, piece: &FrontSegment, active: bool, after: impl FnOnce() -> State) -> Option<Crossing> {
        let distance = |x: f64| {
            let distance = self.side * (x - self.x);
            if distance.abs() <= self.same_place { 0.0 } else { distance }
        };
        let ([from, to], [start, end]) = (piece.x.map(distance), piece.t);
        let leaves = self.side * piece.speed > 0.0;
        let passes = if leaves {
            from <= 0.0 && 0.0 < to || active && from == 0.0
        } else {
            0.0 < from && (to < 0.0 || to == 0.0 && !active)
        };
        passes.then(|| Crossing {
            // The time at which a front starts or ends here is known exactly.
            time: match (from == 0.0, to == 0.0) {
                (true, _) => start,
                (_, true) => end,
                _ => start + (self.x - piece.x[0]) / (piece.x[1] - piece.x[0]) * (end - start),
            },
            leaves,
            speed: piece.speed.abs(),
            after: after(),
        })
    }

    /// Adds two rows for each time at which the state changes; states of zero duration are omitted. Changes at t = 0
    /// are contained in the first row, without a second one.
    fn add_rows(&mut self) {
        let mut crossings = std::mem::take(&mut self.crossings);
        crossings.sort_by(Crossing::order);
        for group in crossings.chunk_by(|a, b| a.time == b.time) {
            let last = group[group.len() - 1];
            if last.time <= 0.0 {
                self.state = last.after;
                continue;
            }
            self.start();
            // A temperature that does not exist is NaN both before and after.
            let changed = |(after, before): (&f64, &f64)| after != before && !(after.is_nan() && before.is_nan());
            if last.after.iter().zip(&self.state).any(changed) {
                self.push(last.time);
                self.state = last.after;
                self.push(last.time);
            }
        }
        self.start();
        crossings.clear();
        self.crossings = crossings;
    }

    /// Adds the row at t = 0, once.
    fn start(&mut self) {
        if !self.started {
            self.started = true;
            self.push(0.0);
        }
    }

    fn push(&mut self, time: f64) {
        let [stress, strain, velocity, temperature] = self.state;
        self.rows.time.push(time);
        self.rows.stress.push(stress);
        self.rows.strain.push(strain);
        self.rows.velocity.push(velocity);
        if self.heat {
            self.rows.temperature.push(temperature);
        }
    }
}
