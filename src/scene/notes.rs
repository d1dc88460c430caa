//! Notes on problematic settings of a valid scene.

use std::sync::Arc;

use super::{HardeningRule, Method, Rate, Scene};
use crate::bar::{EndCondition, Segment};
use crate::law::Table;
use crate::law::rate::Overstress;

/// A grid is noted where its step is below this part of what the other segments could take.
const SMALL_STEP: f64 = 0.5;

impl Scene {
    /// A sentence each.
    pub fn notes(&self) -> Vec<String> {
        let segments = &self.bar.segments;
        let seen = |k: usize| segments[..k].iter().any(|s| Arc::ptr_eq(&s.material, &segments[k].material));
        let materials = (0..segments.len()).filter(|&k| !seen(k)).flat_map(|k| segments[k].material.notes());
        let bar = self.short_segment().into_iter().chain(self.rate_independent_segments());
        let bar = bar.chain(self.hardening_that_gives_back());
        let deprecated = super::deprecated::notes(&self.text, &self.overrides);
        bar.chain(self.misses()).chain(materials).chain(deprecated).collect()
    }

    /// Beside segments that feel the strain rate, those whose material states no constants for it.
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

    /// Curves of several lines whose back stress follows the accumulated plastic strain, for more than half of their hardening.
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
             strain: reverse flow may return more plastic work than was stored; use hardening = \"kinematic\" without rate and \
             heat, or {{ mixed = 0.5 }} or less",
            segment.material.name
        ))
    }

    /// Strikers and balls that move away from the bar.
    fn misses(&self) -> Vec<String> {
        let last = self.bar.segments.len() - 1;
        let ends = [("left", &self.left, 0, 1.0), ("right", &self.right, last, -1.0)];
        let note = |(side, end, segment, inward): (&str, &EndCondition, usize, f64)| {
            let (word, velocity) = match *end {
                EndCondition::Striker { velocity, .. } => ("striker", velocity),
                EndCondition::Ball { velocity, .. } => ("ball", velocity),
                _ => return None,
            };
            let own = self.bar.segments[segment].end_velocities()[usize::from(inward < 0.0)];
            (inward * (velocity - own) < 0.0).then(|| {
                format!(
                    "the {word} at the {side} end moves away from the bar, at {velocity} against {own} m/s: velocities are \
                     positive in +x, \
                     from left to right"
                )
            })
        };
        ends.into_iter().filter_map(note).collect()
    }

    /// A segment too short for a cell of the others' transit time is one cell, and its step holds for the whole bar.
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
