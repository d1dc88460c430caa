//! What a user should know of a scene that is right, but asks for something that does not go well.

use super::{Method, Rate, Scene};
use crate::law::rate::Overstress;

/// A grid is noted where its step is below this part of what the other segments could take.
const SMALL_STEP: f64 = 0.5;

impl Scene {
    /// A sentence each.
    pub fn notes(&self) -> Vec<String> {
        self.short_segment().into_iter().chain(self.rate_independent_segments()).collect()
    }

    /// Beside segments that feel the strain rate, those whose material states no constants for it.
    fn rate_independent_segments(&self) -> Option<String> {
        let rate @ Rate::Material = self.effects.rate? else { return None };
        let segments = self.bar.segments.iter().enumerate();
        let without = segments.filter(|(_, s)| Overstress::of(rate, &s.material).is_none());
        let names: Vec<String> = without.map(|(k, s)| format!("segment {} ({})", k + 1, s.material.name)).collect();
        (!names.is_empty()).then(|| {
            format!(
                "no rate constants are stated for {}: plastic flow follows the quasi-static curve there at any strain rate",
                names.join(", ")
            )
        })
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
                "segment {} ({:.3e} m) is shorter than a cell of the others: its step brings the Courant number down to {courant:.2e} \
                 elsewhere, where fronts are spread and the run takes {:.0} times as many steps; join it to its neighbour, or take \
                 more cells or method = \"moc\"",
                shortest + 1,
                bar.segments[shortest].length,
                longest / step,
            )
        })
    }
}
