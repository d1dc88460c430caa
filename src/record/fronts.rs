//! Tracking of fronts in the simulated field: position and speed of each edge of the theoretical fan, and arrival times
//! at gauges. The theoretical speed is not used.

use super::{FrontRow, Stepped};
use crate::bar::{Bar, EndCondition, InitialFan, Origin, acts_without_fan};
use crate::snapshot::{self, Snapshot, pack, unpack};
use crate::solver::fd::{Grid, Quantity};
use crate::wave::similarity::Edge;

/// Tracker of all fronts that a bar's ends and joints emit at the start.
#[derive(Debug, Clone)]
pub struct FrontTracker {
    fronts: Vec<Front>,
}

/// Number of cells ahead of a front that are searched, so that a trough of the oscillations behind a steep front is not
/// mistaken for the front itself: the oscillations are two to four cells long.
const LOOK_AHEAD: usize = 8;

/// Width of a steep front in cells.
const FRONT_WIDTH: f64 = 4.0;

/// Front: the place where the strain is midway between the strains ahead and behind.
#[derive(Debug, Clone)]
struct Front {
    initial_fan: InitialFan,
    edge: Edge,
    window: Window,
    /// Width of a steep front on this grid, m.
    width: f64,
    /// Magnitude of the strain that marks the front.
    level: f64,
    /// For a front from an end that slower fronts follow: time until which the load of that end is constant, s. Unloading then meets the slower fronts
    /// first, so that this front is undisturbed until the load is less than its own stress.
    followed: Option<f64>,
    /// Number of cells behind the front, counted from the origin.
    passed: usize,
    /// Times (s) and distances from the origin (m), recorded while no other wave can have interfered.
    track: Vec<(f64, f64)>,
    finished: bool,
}

/// Range of distances and times in which a fan is undisturbed, bounded by elastic waves from both sides.
#[derive(Debug, Clone, Copy)]
struct Window {
    length: f64,
    c0: f64,
    /// First time at which any other wave can enter at the far side, s.
    far: f64,
    /// First time at which any other wave can enter at the origin, s.
    near: f64,
}

impl Window {
    /// Returns true if a front at this distance cannot have met another wave yet; `margin` is the width of a front, m.
    fn undisturbed(&self, time: f64, distance: f64, margin: f64) -> bool {
        let from_far = self.length - self.c0 * (time - self.far).max(0.0);
        let from_near = self.c0 * (time - self.near).max(0.0);
        distance + margin <= from_far && distance >= from_near
    }
}

impl FrontTracker {
    /// Creates a tracker for the fans of a bar on a grid.
    pub fn new(bar: &Bar, grid: &Grid, initial_fans: &[InitialFan], ends: [&EndCondition; 2]) -> Self {
        let mut fronts = Vec::new();
        for initial_fan in initial_fans {
            let window = window(bar, initial_fan, initial_fans, ends);
            let at_end = matches!(initial_fan.origin, Origin::Left | Origin::Right);
            for (k, edge) in initial_fan.fan.edges.iter().enumerate() {
                let is_elastic = edge.is_elastic(window.c0);
                let is_followed = at_end && !is_elastic && k + 1 < initial_fan.fan.edges.len();
                // A later wave from the same origin cannot overtake an elastic front.
                let near = if is_elastic || is_followed { f64::INFINITY } else { window.near };
                let level = 0.5 * (edge.strain_ahead + edge.strain_behind);
                fronts.push(Front {
                    initial_fan: initial_fan.clone(),
                    edge: *edge,
                    window: Window { near, ..window },
                    width: FRONT_WIDTH * grid.segments[initial_fan.segment].spacing,
                    level,
                    followed: is_followed.then_some(window.near),
                    passed: 0,
                    track: Vec::new(),
                    // In a taper the strains of a front change on its way, so that no constant level marks it.
                    finished: bar.segments[initial_fan.segment].taper.is_some(),
                });
            }
        }
        Self { fronts }
    }

    /// Updates the positions of all fronts.
    pub fn observe(&mut self, bar: &impl Stepped) {
        for front in self.fronts.iter_mut().filter(|f| !f.finished) {
            front.observe(bar);
        }
    }

    /// Returns the front table, with arrival times at gauges (name, place in m).
    pub fn rows(&self, gauges: &[(String, f64)]) -> Vec<FrontRow> {
        self.fronts.iter().map(|f| f.row(gauges)).collect()
    }
}

impl Snapshot for FrontTracker {
    fn save(&self) -> snapshot::Result<Vec<u8>> {
        pack(
            &self
                .fronts
                .iter()
                .map(|front| (front.passed, &front.track, front.finished, front.window.near))
                .collect::<Vec<_>>(),
        )
    }

    fn restore(&mut self, saved: &[u8]) -> snapshot::Result<()> {
        for (front, saved) in self.fronts.iter_mut().zip(unpack::<Vec<_>>(saved)?) {
            (front.passed, front.track, front.finished, front.window.near) = saved;
        }
        Ok(())
    }
}

impl Front {
    fn observe(&mut self, bar: &impl Stepped) {
        let part = &bar.grid().segments[self.initial_fan.segment];
        let cells = part.cells.len();
        let sign = self.initial_fan.sense.sign();
        let from_origin = |k: usize| {
            let cell = if self.initial_fan.direction > 0.0 { part.cells.start + k } else { part.cells.end - 1 - k };
            sign * bar.value(Quantity::Strain, cell)
        };
        let mut cell = self.passed;
        while cell < cells && cell < self.passed + LOOK_AHEAD {
            if from_origin(cell) >= self.level {
                self.passed = cell + 1;
            }
            cell += 1;
        }
        if self.passed == 0 {
            return;
        }
        let (behind, ahead) = (from_origin(self.passed - 1), from_origin(self.passed.min(cells - 1)));
        if self.passed == cells || behind < self.level {
            self.finished = true;
            return;
        }
        self.notice_unloading(bar);
        let within = (behind - self.level) / (behind - ahead);
        let distance = (self.passed as f64 - 0.5 + within) * part.spacing;
        if self.window.undisturbed(bar.time(), distance, self.width) {
            self.track.push((bar.time(), distance));
        } else {
            self.finished = true;
        }
    }

    /// Sets the time from which waves from the origin can disturb the front, once the stress there is less than that behind the front.
    fn notice_unloading(&mut self, bar: &impl Stepped) {
        let Some(held) = self.followed.filter(|_| self.window.near.is_infinite() && self.passed > LOOK_AHEAD) else {
            return;
        };
        let cells = &bar.grid().segments[self.initial_fan.segment].cells;
        let origin = if self.initial_fan.direction > 0.0 { cells.start } else { cells.end - 1 };
        let stress = self.initial_fan.sense.sign() * bar.value(Quantity::Stress, origin);
        if stress < self.edge.stress_behind {
            // A sudden unloading takes the time of a front's width to show in the cell at the origin.
            self.window.near = held.max(bar.time() - self.width / self.window.c0);
        }
    }

    /// Returns the speed of a straight line fitted to the later half of the track, m/s; NaN if the front moved by less than its own width there.
    fn speed(&self) -> f64 {
        let late = &self.track[self.track.len() / 2..];
        let moved = late.last().map_or(0.0, |end| end.1 - late[0].1);
        if moved < self.width {
            return f64::NAN;
        }
        let n = late.len() as f64;
        let (mean_t, mean_x) = late.iter().fold((0.0, 0.0), |m, p| (m.0 + p.0 / n, m.1 + p.1 / n));
        let (mut tt, mut tx) = (0.0, 0.0);
        for (t, x) in late {
            tt += (t - mean_t).powi(2);
            tx += (t - mean_t) * (x - mean_x);
        }
        tx / tt
    }

    /// Returns the time at which the front reached a distance from its origin, s, interpolated linearly; NaN if it did not.
    fn arrival(&self, distance: f64) -> f64 {
        let after = self.track.partition_point(|p| p.1 < distance);
        let Some(&(t1, x1)) = self.track.get(after) else { return f64::NAN };
        let (t0, x0) = if after == 0 { (0.0, 0.0) } else { self.track[after - 1] };
        if x1 > x0 { t0 + (t1 - t0) * (distance - x0) / (x1 - x0) } else { t1 }
    }

    fn row(&self, gauges: &[(String, f64)]) -> FrontRow {
        let (sign, direction) = (self.initial_fan.sense.sign(), self.initial_fan.direction);
        let (last_seen, distance) = self.track.last().copied().unwrap_or((f64::NAN, f64::NAN));
        let arrivals = gauges.iter().map(|(_, x)| {
            let distance = direction * (x - self.initial_fan.x);
            if (0.0..=self.window.length).contains(&distance) { self.arrival(distance) } else { f64::NAN }
        });
        FrontRow {
            origin: self.initial_fan.origin.to_string(),
            strain_behind: sign * self.edge.strain_behind,
            strain_ahead: sign * self.edge.strain_ahead,
            stress_behind: sign * self.edge.stress_behind,
            stress_ahead: sign * self.edge.stress_ahead,
            speed: direction * self.edge.speed,
            speed_measured: direction * self.speed(),
            position: self.initial_fan.x + direction * distance,
            last_seen,
            load_held_until: self.initial_fan.holds_until,
            arrivals: arrivals.collect(),
        }
    }
}

/// Returns the positions of the ends that send waves into the bar without a fan, m.
fn acting_ends(bar: &Bar, ends: [&EndCondition; 2]) -> impl Iterator<Item = f64> {
    let last = bar.segments.len() - 1;
    let acts = [(0, 1.0, 0.0), (last, -1.0, bar.length())].into_iter().zip(ends);
    let acts = acts.filter(|((k, direction, _), end)| acts_without_fan(end, *direction, bar.segments[*k].velocity));
    acts.map(|((_, _, x), _)| x).collect::<Vec<_>>().into_iter()
}

/// Returns the window of a fan. Elastic waves are the fastest, so their transit times bound when anything else can interfere.
fn window(bar: &Bar, initial_fan: &InitialFan, initial_fans: &[InitialFan], ends: [&EndCondition; 2]) -> Window {
    let segment = &bar.segments[initial_fan.segment];
    let last = bar.segments.len() - 1;
    let far_x = initial_fan.x + initial_fan.direction * segment.length;
    let others = |x: f64| {
        let foreign = initial_fans.iter().filter(|l| l.origin != initial_fan.origin).map(|l| l.x);
        foreign.chain(acting_ends(bar, ends)).map(|from| transit(bar, x, from)).fold(f64::INFINITY, f64::min)
    };
    let at_bar_end = if initial_fan.direction > 0.0 { initial_fan.segment == last } else { initial_fan.segment == 0 };
    let far_end = ends[usize::from(initial_fan.direction > 0.0)];
    let reflects = !(at_bar_end && matches!(far_end, EndCondition::Absorbing));
    let reflection = if reflects { transit(bar, initial_fan.x, far_x) } else { f64::INFINITY };
    // The force of a heavy striker counts as constant for some time.
    let loads_until = initial_fan.loads_until.max(initial_fan.holds_until);
    let near = match initial_fan.origin {
        Origin::Left | Origin::Right => loads_until,
        Origin::Joint(k) => {
            let neighbour = &bar.segments[if initial_fan.direction > 0.0 { k } else { k + 1 }];
            loads_until.min(2.0 * neighbour.length / neighbour.material.c0()).min(others(initial_fan.x))
        }
    };
    Window { length: segment.length, c0: segment.material.c0(), far: reflection.min(others(far_x)), near }
}

/// Returns the transit time of an elastic wave between two positions, s.
fn transit(bar: &Bar, a: f64, b: f64) -> f64 {
    let (low, high) = (a.min(b), a.max(b));
    let (mut x0, mut time) = (0.0, 0.0);
    for segment in &bar.segments {
        let x1 = x0 + segment.length;
        time += (high.min(x1) - low.max(x0)).max(0.0) / segment.material.c0();
        x0 = x1;
    }
    time
}
