//! Notes on problematic settings of a valid scene.

use std::sync::Arc;

use super::{HardeningRule, Method, Rate, Scene};
use crate::bar::{EndCondition, Initial, Joint, Segment};
use crate::law::Table;
use crate::law::rate::Overstress;
use crate::material::Sense;
use crate::units::{self, Dimension, System};

/// Ratio of the time step to the one that the other segments allow below which a grid is reported.
const SMALL_STEP: f64 = 0.5;
/// Number of time steps below which a contact of a ball is reported. On an elastic bar the peak force is 44 %, 15 % and 3.5 % too small with 2.6, 5
/// and 13 steps.
const STEPS_OF_CONTACT: f64 = 25.0;
/// Number of cells below which the decay length of the pulse of a striker is reported in a bar that yields. In a bilinear bar (plastic waves of 0.32
/// c0), the largest plastic strain is 87, 43, 10 and 6 % too small with leapfrog at 0.75, 3, 6 and 24 cells, and the absorbed energy 72, 24, 9 and
/// 3 %; with the Godunov scheme likewise.
const CELLS_OF_PULSE: f64 = 20.0;
/// Number of time steps below which an end time is reported.
const FEW_STEPS: f64 = 10.0;
/// Number of transits of elastic waves through the bar above which an end time is reported.
const MANY_TRANSITS: f64 = 1000.0;
/// Ratio of the time of the first change to the end time above which a history is reported.
const LATE: f64 = 10.0;

impl Scene {
    /// Returns whether anything in the scene can emit a stress jump.
    pub fn may_have_sharp_waves(&self) -> bool {
        let ends = [&self.left, &self.right].into_iter().any(EndCondition::is_sudden);
        ends || !self.bar.starts_at_rest() || self.effects.rupture.is_some()
    }

    /// Returns each end with its name, its segment, and the side of the segment on which it lies.
    fn ends_and_segments(&self) -> [(&'static str, &EndCondition, &Segment, usize); 2] {
        let segments = &self.bar.segments;
        [("left", &self.left, &segments[0], 0), ("right", &self.right, &segments[segments.len() - 1], 1)]
    }

    /// Returns the notes, one sentence each; for a discretized scene those of the original scene.
    pub fn notes(&self) -> Vec<String> {
        if let Some(cut) = &self.discretized {
            return cut.original.notes();
        }
        let segments = &self.bar.segments;
        let seen = |k: usize| segments[..k].iter().any(|s| Arc::ptr_eq(&s.material, &segments[k].material));
        let materials = (0..segments.len()).filter(|&k| !seen(k)).flat_map(|k| segments[k].material.notes());
        let bar = self.short_segment().into_iter().chain(self.rate_independent_segments());
        let bar = bar.chain(self.hardening_that_gives_back()).chain(self.critical_velocity_of_another_state());
        let deprecated = super::deprecated::notes(&self.text, &self.overrides);
        let bar = bar.chain(self.sharp_waves_that_disperse());
        let bar = bar
            .chain(self.short_contacts())
            .chain(self.short_pulses())
            .chain(self.few_steps())
            .chain(self.many_transits());
        let bar = bar.chain(self.jumps_against_dampers());
        bar.chain(self.misses()).chain(self.late_histories()).chain(materials).chain(deprecated).collect()
    }

    /// Notes segments whose material has no rate constants, if those of the materials are used.
    fn rate_independent_segments(&self) -> Option<String> {
        let rate @ Rate::Material = self.effects.rate? else { return None };
        let segments = self.bar.segments.iter().enumerate();
        let without = segments.filter(|(_, s)| Overstress::of(rate, &s.material).is_none());
        let names: Vec<String> = without.map(|(k, s)| format!("segment {} ({})", k + 1, s.material.name)).collect();
        (!names.is_empty()).then(|| {
            format!(
                "{} has no rate constants: plastic flow follows its quasi-static curve at all strain rates",
                names.join(", ")
            )
        })
    }

    /// Leapfrog is exact for elastic waves only at Courant number 1.
    fn sharp_waves_that_disperse(&self) -> Option<String> {
        let Method::Leapfrog { cfl, .. } = self.solve.method else { return None };
        (cfl < 1.0 && self.may_have_sharp_waves()).then(|| {
            format!(
                "at the Courant number {cfl} leapfrog disperses sharp elastic waves: they overshoot by 15 to 50 % of their jump, and more cells do \
                 not help; remove `cfl`, or use scheme = \"muscl\" or method = \"moc\""
            )
        })
    }

    /// Notes that the critical velocity is not that of the initial state of the bar.
    fn critical_velocity_of_another_state(&self) -> Option<String> {
        let bar = self.bar.on_warm_curves();
        let changed = |segment: &Segment| {
            segment.initial != Initial::default() || segment.profile.as_ref().is_some_and(|profile| profile.has_state())
        };
        let warm = if bar.segments.iter().any(Segment::starts_warm) { ", at the reference temperature" } else { "" };
        (bar.segments.iter().any(changed) && self.critical_velocity().is_some())
            .then(|| format!("the critical velocity is that of a bar without initial stress and plastic strain{warm}"))
    }

    /// Notes curves with several hardening lines whose back stress depends on the accumulated plastic strain, for more than half of their hardening.
    fn hardening_that_gives_back(&self) -> Option<String> {
        let overlaid = self.effects.rate.is_none() && self.effects.heat.is_none();
        match self.effects.hardening? {
            HardeningRule::Mixed(fraction) if fraction > 0.5 => (),
            HardeningRule::Kinematic if !overlaid => (),
            _ => return None,
        }
        let several = |s: &&Segment| Table::new(&s.material.tension, s.material.modulus).is_multilinear();
        let segment = self.bar.segments.iter().find(several)?;
        Some(format!(
            "the hardening curve of {} has several straight segments, and the back stress depends on the accumulated plastic \
             strain{}: reverse flow may return more plastic work than was stored; use hardening = \"kinematic\" without rate and \
             heat, or {{ mixed = 0.5 }} or less",
            segment.material.name,
            match self.effects.hardening? {
                HardeningRule::Kinematic =>
                    ", as with { mixed = 1 } (the overlay model of \"kinematic\" needs rate and heat to be off)",
                _ => "",
            }
        ))
    }

    /// Notes strikers, balls, walls and contact joints whose two sides move apart at the start.
    fn misses(&self) -> Vec<String> {
        let segments = &self.bar.segments;
        let speeds = |k: usize| segments[k].end_velocities();
        let ends =
            [("left", &self.left, speeds(0)[0], 1.0), ("right", &self.right, speeds(segments.len() - 1)[1], -1.0)];
        let at_end = ends.into_iter().filter_map(|(side, end, own, inward)| {
            let (what, velocity) = match *end {
                EndCondition::Striker { velocity, .. } => ("striker", velocity),
                EndCondition::Ball { velocity, .. } => ("ball", velocity),
                EndCondition::Wall { .. } => ("wall", 0.0),
                _ => return None,
            };
            let [own_shown, shown] = [own, velocity].map(|v| self.velocity_of_body(v, end, side));
            (inward * (velocity - own) < 0.0).then(|| {
                let bar = if self.torsion.is_some() && what == "ball" { "lever" } else { "bar" };
                format!("the {bar} and the {what} at the {side} end move apart (at {own_shown}, {what} at {shown})")
            })
        });
        let at_joint = segments.windows(2).enumerate().filter_map(|(k, pair)| {
            let (ahead, behind) = (pair[0].end_velocities()[1], pair[1].end_velocities()[0]);
            (matches!(pair[0].joint, Joint::Contact { .. }) && behind > ahead)
                .then(|| format!("the segments move apart at joint {} ({ahead} m/s and {behind} m/s)", k + 1))
        });
        let rule = if self.torsion.is_some() {
            "velocities are positive in the same sense of rotation at both ends, and a body meets the bar at the left end if its velocity is the \
             larger one, at the right end if it is the smaller one"
        } else {
            "velocities are positive in +x, from left to right"
        };
        at_end.chain(at_joint).map(|note| format!("{note}: {rule}")).collect()
    }

    /// Returns a velocity at an end in terms of its body, as text. In torsion it is that of the surface; the velocity of a ball is that at the lever
    /// that it strikes.
    fn velocity_of_body(&self, velocity: f64, end: &EndCondition, side: &str) -> String {
        let shown = |value, dimension| units::format(value, dimension, System::Si);
        match (&self.torsion, end) {
            (None, _) => shown(velocity, Dimension::Velocity),
            (Some(torsion), EndCondition::Ball { .. }) => {
                shown(velocity * torsion.levers[usize::from(side == "right")], Dimension::Velocity)
            }
            (Some(torsion), _) => shown(velocity / torsion.radius, Dimension::AngularVelocity),
        }
    }

    /// Notes balls whose contact lasts only a few time steps: on a grid their force is too small, or too large if the bar yields.
    fn short_contacts(&self) -> Vec<String> {
        let Some(cells) = self.solve.method.cells() else { return Vec::new() };
        let step = self.bar.transit_time() / cells as f64;
        let note = |(side, end, at, k): (&str, &EndCondition, &Segment, usize)| {
            let EndCondition::Ball { mass, velocity, contact } = end else { return None };
            let closing = (velocity - at.end_velocities()[k]).abs();
            let impedance = at.material.impedance() * at.end_areas()[k];
            let time = contact.time_under(contact.most_force(*mass, closing, impedance), closing);
            let steps = time / step;
            (steps < STEPS_OF_CONTACT).then(|| {
                let needed = cells as f64 * STEPS_OF_CONTACT / steps;
                format!(
                    "the contact of the ball at the {side} end lasts about {time:.2e} s, or {steps:.1} time steps: its peak force can be \
                     in error by more than 1 %; use at least {needed:.0} cells, or method = \"moc\""
                )
            })
        };
        self.ends_and_segments().into_iter().filter_map(note).collect()
    }

    /// Notes strikers whose pulse decays within a few cells and makes the bar yield: on a grid the bar yields too little.
    fn short_pulses(&self) -> Vec<String> {
        let Some(cells) = self.solve.method.cells().filter(|_| self.effects.hardening.is_some()) else {
            return Vec::new();
        };
        let cell = self.bar.transit_time() / cells as f64;
        let note = |(side, end, at, k): (&str, &EndCondition, &Segment, usize)| {
            let EndCondition::Striker { mass, velocity } = end else { return None };
            let impedance = at.material.impedance();
            let closing = [1.0, -1.0][k] * (velocity - at.end_velocities()[k]);
            let yields =
                impedance * closing > at.material.branch(Sense::Compression).elastic_limit(at.material.modulus).1;
            let decay = mass / (impedance * at.end_areas()[k]) / cell;
            (yields && decay < CELLS_OF_PULSE).then(|| {
                let needed = (cells as f64 * CELLS_OF_PULSE / decay).ceil();
                let exact = if self.effects.rate.is_none() { ", or method = \"moc\"" } else { "" };
                format!(
                    "the pulse of the light striker at the {side} end decays within {decay:.1} cells: plastic strain and absorbed energy \
                     are too small; use at least {needed:.0} cells{exact}"
                )
            })
        };
        self.ends_and_segments().into_iter().filter_map(note).collect()
    }

    /// Notes end times after only a few time steps; runs on a grid end with a whole step.
    fn few_steps(&self) -> Option<String> {
        let per_cell = match self.solve.method {
            Method::Leapfrog { cfl, .. } | Method::Muscl { cfl, .. } => 1.0 / cfl,
            Method::CharacteristicNet { .. } | Method::FrontTracking { .. } => 1.0,
        };
        let steps = self.solve.until * self.solve.method.cells()? as f64 * per_cell / self.bar.transit_time();
        (steps < FEW_STEPS).then(|| {
            let steps = units::format(steps, Dimension::None, System::Si);
            let plural = if steps == "1" { "" } else { "s" };
            format!(
                "the end time is {steps} time step{plural} after the start: a run on a grid ends with a whole step, and its forces and impulses are \
                 means over steps; use more cells, or method = \"moc\""
            )
        })
    }

    /// Notes long runs, which mostly result from end times without a unit.
    fn many_transits(&self) -> Option<String> {
        let transits = self.solve.until / self.bar.transit_time();
        (transits > MANY_TRANSITS).then(|| {
            let [until, transits] = [(self.solve.until, Dimension::Time), (transits, Dimension::None)]
                .map(|(value, dimension)| units::format(value, dimension, System::Si));
            format!(
                "the end time is {until}, in which elastic waves cross the bar {transits} times: the histories of such a run make a large file; \
                 a number without a unit is in seconds"
            )
        })
    }

    /// Notes ends whose velocity jumps with internal damping: the strain rate next to the end is then unbounded, and so is the damping force.
    fn jumps_against_dampers(&self) -> Option<String> {
        self.effects.damping.filter(|damping| damping.internal > 0.0)?;
        let jumps = |(_, end, at, k): &(&str, &EndCondition, &Segment, usize)| {
            let velocity = at.end_velocities()[*k];
            match end {
                EndCondition::Velocity { history, .. } => {
                    history.value()[0] != velocity || history.jumps_between(0.0, self.solve.until)
                }
                EndCondition::Striker { velocity: own, .. } => *own != velocity,
                EndCondition::Fixed => velocity != 0.0,
                _ => false,
            }
        };
        let (side, end, ..) = self.ends_and_segments().into_iter().find(jumps)?;
        let remedy = match end {
            EndCondition::Velocity { .. } => "give the velocity as a `history` that rises over some time steps",
            _ => "disregard the peak force of that end",
        };
        Some(format!(
            "the velocity of the {side} end jumps, and with internal damping the force has no finite peak there: it grows with the number of \
             cells; {remedy}"
        ))
    }

    /// Notes histories that have hardly started when the run ends, which mostly result from times without a unit.
    fn late_histories(&self) -> Option<String> {
        let until = self.solve.until;
        [("left", &self.left), ("right", &self.right)].into_iter().find_map(|(side, end)| {
            let history = end.history()?;
            let first = history.value()[0];
            let change = history.value().iter().position(|&value| value != first)?;
            let time = history.time()[change];
            (time > until * LATE).then(|| {
                format!(
                    "the history at the {side} end has its first change at {time} s, long after the end of the run \
                     ({until:.3e} s): give its times a unit, such as \"10 us\", or in a CSV file the header `time [us]`"
                )
            })
        })
    }

    /// Notes a segment that is shorter than a cell of the other segments: it is a single cell, whose time step limits that of the whole bar.
    fn short_segment(&self) -> Option<String> {
        let (Method::Leapfrog { cells, cfl } | Method::Muscl { cells, cfl }) = self.solve.method else { return None };
        let (bar, transit) = (&self.bar, self.bar.transit_time());
        let cell_transits: Vec<f64> = bar
            .segments
            .iter()
            .map(|segment| {
                let time = segment.length / segment.material.c0();
                time / (cells as f64 * time / transit).round().max(1.0)
            })
            .collect();
        let (shortest, step) = cell_transits.iter().enumerate().min_by(|a, b| a.1.total_cmp(b.1))?;
        let longest = cell_transits.iter().copied().fold(0.0, f64::max);
        let courant = cfl * step / longest;
        (step / longest < SMALL_STEP).then(|| {
            format!(
                "segment {} ({:.3e} m) is shorter than a cell of the other segments and limits the time step: the Courant \
                 number elsewhere is {courant:.2e}, fronts are smeared there, and the run needs {:.0} times as many steps; \
                 merge it with its neighbour, or use more cells or method = \"moc\"",
                shortest + 1,
                bar.segments[shortest].length,
                longest / step,
            )
        })
    }
}
