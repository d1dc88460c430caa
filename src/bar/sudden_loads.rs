//! Which ends and joints of a bar are suddenly loaded beyond yield.

use super::initial_fan::{Driver, acts_without_fan};
use super::{Bar, EndCondition, InitialFan, Joint, Origin, SuddenLoad, initial_fans};

/// Cells that the slowest front of a fan travels before the schemes on a grid know the state behind it. Bilinear steel,
/// annealed copper and a foam that locks up oscillate by less than 1 % of the stress from there on.
const START_CELLS: f64 = 24.0;

/// What is suddenly loaded in a bar.
#[derive(Debug, Clone, Default)]
pub struct SuddenLoads {
    /// Left and right end.
    pub ends: [Option<SuddenLoad>; 2],
    /// Joints, by the segment to their left, with the section (m^2) of the side whose stress it is.
    pub joints: Vec<(usize, SuddenLoad, f64)>,
}

impl SuddenLoads {
    /// Of a bar with these ends, the segments of which have cells of these lengths, m.
    pub fn new(bar: &Bar, ends: [&EndCondition; 2], dx: &[f64]) -> Self {
        let loads = Self::of_fans(bar, &initial_fans(bar, ends[0], ends[1]), dx);
        if loads.is_empty() { Self::at_gap(bar, ends, dx).unwrap_or_default() } else { loads }
    }

    fn is_empty(&self) -> bool {
        self.joints.is_empty() && self.ends == [None; 2]
    }

    fn of_fans(bar: &Bar, fans: &[InitialFan], dx: &[f64]) -> Self {
        let load = |fan: &InitialFan| behind(fan, bar, dx[fan.segment]);
        let end = |origin: Origin| fans.iter().find(|fan| fan.origin == origin).and_then(load);
        let joint = |k: usize| {
            let both = || fans.iter().filter(|fan| fan.origin == Origin::Joint(k));
            let lasts =
                both().map(|fan| fan.known_until(bar.segments[fan.segment].length)).fold(f64::INFINITY, f64::min);
            let area = |fan: &InitialFan| bar.segments[fan.segment].end_areas()[usize::from(fan.segment == k)];
            let loads = both().filter_map(|fan| Some((load(fan)?, area(fan))));
            let (load, area) = loads.min_by(|(a, _), (b, _)| a.lasts.total_cmp(&b.lasts))?;
            (lasts > 0.0).then(|| (k, SuddenLoad { lasts: load.lasts.min(lasts), ..load }, area))
        };
        let joints = (0..bar.segments.len() - 1).filter_map(joint).collect();
        Self { ends: [end(Origin::Left), end(Origin::Right)], joints }
    }

    /// Where nothing happens before one gap closes: that of a wall, or of one joint.
    fn at_gap(bar: &Bar, ends: [&EndCondition; 2], dx: &[f64]) -> Option<Self> {
        if !initial_fans(bar, ends[0], ends[1]).is_empty() {
            return None;
        }
        let (mut closed, mut gaps) = (bar.clone(), Vec::new());
        for (k, segment) in closed.segments.iter_mut().enumerate() {
            if let Joint::Contact { gap } = &mut segment.joint
                && *gap > 0.0
            {
                gaps.push((Origin::Joint(k), std::mem::take(gap)));
            }
        }
        let closed_ends = ends
            .map(|end| if let EndCondition::Wall { .. } = end { EndCondition::Wall { gap: 0.0 } } else { end.clone() });
        for (origin, end) in [Origin::Left, Origin::Right].into_iter().zip(ends) {
            if let EndCondition::Wall { gap } = end {
                gaps.push((origin, *gap));
            }
        }
        let fans = initial_fans(&closed, &closed_ends[0], &closed_ends[1]);
        let first = fans.first()?;
        let [left, right] = [bar.segments[0].velocity, bar.segments[bar.segments.len() - 1].velocity];
        let quiet = !acts_without_fan(&closed_ends[0], 1.0, left) && !acts_without_fan(&closed_ends[1], -1.0, right);
        if !quiet || fans.iter().any(|fan| fan.origin != first.origin) {
            return None;
        }
        let gap = gaps.iter().find(|gap| gap.0 == first.origin)?.1;
        let closing = match first.origin {
            Origin::Left => left.abs(),
            Origin::Right => right.abs(),
            Origin::Joint(k) => bar.segments[k].velocity - bar.segments[k + 1].velocity,
        };
        let mut loads = Self::of_fans(&closed, &fans, dx);
        let ends = loads.ends.iter_mut().flatten();
        ends.chain(loads.joints.iter_mut().map(|(_, load, _)| load)).for_each(|load| load.from = gap / closing);
        Some(loads)
    }
}

/// The state behind a fan, on cells of length `dx` (m); none where the segment stays elastic: grids are exact there.
fn behind(fan: &InitialFan, bar: &Bar, dx: f64) -> Option<SuddenLoad> {
    let segment = &bar.segments[fan.segment];
    let slowest = fan.fan.edges.last()?.speed;
    let elastic = slowest >= segment.material.c0() * (1.0 - 1e-9);
    let lasts = fan.known_until(segment.length).min(START_CELLS * dx / slowest);
    (!elastic && lasts > 0.0).then(|| SuddenLoad {
        stress: fan.sense.sign() * fan.fan.stress,
        velocity: fan.velocity_ahead - fan.direction * fan.sense.sign() * fan.fan.velocity,
        by_body: (fan.driver == Driver::Body).then(|| -fan.direction * segment.material.impedance()),
        from: 0.0,
        lasts,
    })
}
