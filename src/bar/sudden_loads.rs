//! Ends and joints of a bar that are suddenly loaded beyond yield.

use super::initial_fan::Driver;
use super::sudden_load::hardly_differ;
use super::{Bar, InitialFan, Origin, SuddenLoad};

/// The sudden loads of a bar.
#[derive(Debug, Clone, Default)]
pub struct SuddenLoads {
    /// Loads of the left and of the right end, in order of time.
    pub ends: [Vec<SuddenLoad>; 2],
    /// Loads of joints: the segment to the left, the load, and its force (N, tension positive).
    pub joints: Vec<(usize, SuddenLoad, f64)>,
}

impl SuddenLoads {
    /// Computes the sudden loads of a bar from its fans; `dx` are the cell lengths of the segments, m.
    pub fn new(bar: &Bar, fans: &[InitialFan], dx: &[f64]) -> Self {
        let load = |fan: &InitialFan| behind(fan, bar, dx[fan.segment]);
        let end = |origin: Origin| fans.iter().filter(|fan| fan.origin == origin).filter_map(load).collect();
        let joint = |k: usize| {
            let here = |fan: &&InitialFan| fan.origin == Origin::Joint(k);
            let first = fans.iter().find(|fan| here(fan) && load(fan).is_some())?;
            let both = || fans.iter().filter(|fan| here(fan) && fan.from == first.from);
            let known =
                both().map(|fan| fan.known_until(bar.segments[fan.segment].length)).fold(f64::INFINITY, f64::min);
            let area = |fan: &InitialFan| bar.segments[fan.segment].end_areas()[usize::from(fan.segment == k)];
            let loads = both().filter_map(|fan| Some((load(fan)?, area(fan))));
            let (load, area) = loads.min_by(|(a, _), (b, _)| a.lasts.total_cmp(&b.lasts))?;
            (known > 0.0).then(|| (k, SuddenLoad { lasts: load.lasts.min(known), ..load }, area * load.stress))
        };
        let joints = (0..bar.segments.len() - 1).filter_map(joint).collect();
        Self { ends: [end(Origin::Left), end(Origin::Right)], joints }
    }

    /// Returns the loads of a rate-dependent bar at the second of two `times` (s) after the start of each, with their decay; `early` are the loads at
    /// the first.
    #[must_use]
    pub fn fading(self, early: &Self, times: [f64; 2]) -> Self {
        let end = |side: usize| {
            let pair = |load: SuddenLoad| early.ends[side].iter().find_map(|early| load.fading(early, times));
            self.ends[side].iter().copied().filter_map(pair).collect()
        };
        let joint = |&(k, load, force): &(usize, SuddenLoad, f64)| {
            let (_, early, _) = early.joints.iter().find(|joint| joint.0 == k)?;
            Some((k, load.fading(early, times)?, force))
        };
        Self { ends: [end(0), end(1)], joints: self.joints.iter().filter_map(joint).collect() }
    }

    /// Returns true if a fan brings a load that hardly differs from that of a rate-independent bar. A fan that rises gradually is compared with that
    /// of the `early` time.
    pub fn hardly_fades(&self, fan: &InitialFan, early: &[InitialFan]) -> bool {
        if !fan.delays.is_empty() {
            let same = |other: &&InitialFan| other.origin == fan.origin && other.from == fan.from;
            return early.iter().find(same).is_some_and(|early| hardly_differ(&early.fan, &fan.fan));
        }
        let at_end = |side: usize| self.ends[side].iter().find(|load| load.from == fan.from);
        let load = match fan.origin {
            Origin::Left => at_end(0),
            Origin::Right => at_end(1),
            Origin::Joint(k) => self.joints.iter().find(|joint| joint.0 == k).map(|joint| &joint.1),
        };
        load.is_some_and(SuddenLoad::hardly_fades)
    }
}

/// Number of cells that elastic waves cross before schemes reach the stress of an end above the critical velocity. In rate-dependent copper
/// the stress is 2 % too small after 12 cells, and correct after 20.
const EXCEEDED_CELLS: f64 = 48.0;

/// Cells that elastic waves cross while a joint shows the force just after a decaying wave has arrived: the first two steps. The cells beside the joint
/// show a force only after the wave has decayed for some three cells.
const FIRST_CELLS: f64 = 2.0;

/// Returns the load behind a fan, for cells of length `dx` (m). `None` if the segment stays elastic, where grids are exact.
fn behind(fan: &InitialFan, bar: &Bar, dx: f64) -> Option<SuddenLoad> {
    let segment = &bar.segments[fan.segment];
    let (material, c0) = (&segment.material, segment.material.c0());
    let ([stress, velocity], lasts, slope) = if let Some(state) = fan.state_above_critical() {
        (state, fan.alone_for(segment.length).min(EXCEEDED_CELLS * dx / c0), Some(0.0))
    } else {
        let by_body = || -fan.direction * material.density * fan.slowing(c0);
        let lasts = fan.known_until(segment.length).min(fan.followed_for(dx, c0));
        (fan.state_behind()?, lasts, (fan.driver == Driver::Body).then(by_body))
    };
    let decays = fan.driver != Driver::Body && lasts > fan.decays_from;
    let lasts = match fan.origin {
        Origin::Joint(_) if decays => lasts.min(FIRST_CELLS * dx / c0),
        _ => lasts,
    };
    // Schemes show the states of ends behind fans whose loads change themselves.
    let shown = fan.delays.is_empty() && (!decays || matches!(fan.origin, Origin::Joint(_)));
    (lasts > 0.0 && shown).then_some(SuddenLoad { stress, velocity, slope, from: fan.from, lasts, fading: None })
}
