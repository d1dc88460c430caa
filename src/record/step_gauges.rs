//! Exact gauge histories of a front-tracking bar, from the segments of the fronts that pass.

use serde::{Deserialize, Serialize};

use super::Trace;
use crate::bar::{Bar, Initial, Segment};
use crate::solver::moc::{FrontSegment, FrontTracking};

/// Places closer than this part of the bar's length are one: fronts that meet in a point miss it by rounding.
const SAME_PLACE: f64 = 1e-12;

/// Part of the run's time by which crossings are held back from the rows of a moment, so that one at just that moment,
/// which a front still under way and the same front ended tell apart by rounding, is counted once.
const HELD_BACK: f64 = 1e-11;

/// Histories at places, two rows a step: the state before and after it, at one time.
#[derive(Debug, Serialize, Deserialize)]
pub struct StepGauges {
    gauges: Vec<StepGauge>,
    /// The temperature is read too.
    heat: bool,
    /// Crossings up to this time are in the rows, s.
    done: f64,
    held_back: f64,
    /// Front segments that have ended since, with what they do just then.
    ended: Vec<FrontSegment>,
}

/// One place. It sees the state just right of it; at the right end of the bar, just left.
#[derive(Debug, Serialize, Deserialize)]
struct StepGauge {
    x: f64,
    /// +1: the state in +x of the place counts, -1: that in -x.
    side: f64,
    same_place: f64,
    state: State,
    crossings: Vec<Crossing>,
    started: bool,
    /// The temperature is read.
    heat: bool,
    rows: Trace,
}

/// Stress (Pa), strain, velocity (m/s) and temperature (K; not used without the effect of heat).
type State = [f64; 4];

/// A front that changes what the gauge sees.
#[derive(Debug, Clone, Copy, Serialize, Deserialize)]
struct Crossing {
    time: f64,
    /// It moves away from the place into the side that counts, or came to the place from there.
    leaves: bool,
    /// Magnitude, m/s.
    speed: f64,
    after: State,
}

impl Crossing {
    /// Order at one place: by time; at one time what arrives comes first (the fastest last, it lies nearest), then what
    /// the meeting sends out, the fastest first.
    fn order(&self, other: &Self) -> std::cmp::Ordering {
        let rank = |c: &Self| if c.leaves { -c.speed } else { c.speed };
        self.time.total_cmp(&other.time).then(self.leaves.cmp(&other.leaves)).then(rank(self).total_cmp(&rank(other)))
    }
}

impl StepGauges {
    /// Gauges at `places` (m) of a bar at t = 0; `until` is the end time, s.
    pub fn new(bar: &Bar, places: &[f64], until: f64) -> Self {
        let heat = bar.segments.iter().any(|s| s.material.heating.is_some());
        let gauges = places.iter().map(|&x| StepGauge::new(bar, x, heat)).collect();
        Self { gauges, heat, done: f64::NEG_INFINITY, held_back: HELD_BACK * until, ended: Vec::new() }
    }

    /// Takes in what passed since the last call; `ended` are the front segments that ended since then.
    pub fn collect(&mut self, bar: &FrontTracking, ended: &[FrontSegment]) {
        self.collect_until(bar, ended, bar.time() - self.held_back);
    }

    /// Takes in the rest at the end of the run, and closes every history with a row at that time.
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
        for piece in self.ended.iter().copied().chain(bar.living_front_segments()) {
            let medium = bar.medium(piece.segment);
            for gauge in &mut self.gauges {
                let new = |c: &Crossing| self.done < c.time && c.time <= until;
                let point = &piece.behind;
                let temperature = if self.heat { bar.temperature(piece.segment, point) } else { 0.0 };
                let after = || [point.stress, medium.strain(point), point.velocity, temperature];
                gauge.crossings.extend(gauge.crossing(&piece, after).filter(new));
            }
        }
        self.done = until;
        self.ended.retain(|piece| piece.t[1] > until);
        if until >= 0.0 {
            self.gauges.iter_mut().for_each(StepGauge::add_rows);
        }
    }

    /// Hands on the rows since the last call, gauge by gauge.
    pub fn take(&mut self) -> Vec<Trace> {
        self.gauges.iter_mut().map(|gauge| std::mem::take(&mut gauge.rows)).collect()
    }
}

/// The state at t = 0 just right of a place, m from the segment's left end, and its velocity; at the right end, just left.
fn initial(segment: &Segment, x: f64, same_place: f64) -> (Initial, f64) {
    let Some(profile) = &segment.profile else { return (segment.initial, segment.velocity) };
    if x + same_place >= segment.length {
        return (profile.beside(segment.length, 0), profile.velocity.before(segment.length));
    }
    (profile.beside(x + same_place, 1), profile.velocity.at(x + same_place))
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

    /// When and how a piece changes what is seen here, if it does. Distances are counted from the place into the side
    /// that counts: a front that comes from there and reaches the place has passed all of that side, and so has one
    /// that leaves the place into it.
    fn crossing(&self, piece: &FrontSegment, after: impl FnOnce() -> State) -> Option<Crossing> {
        let distance = |x: f64| {
            let distance = self.side * (x - self.x);
            if distance.abs() <= self.same_place { 0.0 } else { distance }
        };
        let ([from, to], [start, end]) = (piece.x.map(distance), piece.t);
        let leaves = from < to;
        let passes = if leaves { from <= 0.0 && 0.0 < to } else { to <= 0.0 && 0.0 < from };
        let length = piece.x[1] - piece.x[0];
        passes.then(|| Crossing {
            // A front that starts or ends here does so at a time that is known exactly.
            time: match (from == 0.0, to == 0.0) {
                (true, _) => start,
                (_, true) => end,
                _ => start + (self.x - piece.x[0]) / length * (end - start),
            },
            leaves,
            speed: (length / (end - start)).abs(),
            after: after(),
        })
    }

    /// Two rows for each moment at which the state changes; what lasts no time leaves none. What happens at t = 0 is the
    /// first row alone.
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
            // Where there is no temperature it is not a number, before and after.
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

    /// The row at t = 0, once.
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
