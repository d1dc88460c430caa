//! A run held against theory: sigma = rho c0 v while it is elastic, and the self-similar solution where it has one.

use super::{ElasticCheck, ErrorFigure};
use crate::bar::{Bar, Launch};
use crate::solver::fd::{Leapfrog, Quantity};

/// Where and when sigma = rho c0 v (9.34) is checked: next to the struck end, half-way between the first arrival of the
/// wave and the first return of one.
#[derive(Debug, Clone)]
pub struct ElasticProbe {
    step: usize,
    cell: usize,
    expected: f64,
    found: Option<f64>,
}

impl ElasticProbe {
    /// A probe for the first suddenly loaded end or joint, where there is one; `until` is the end time, s.
    pub fn new(bar: &Bar, solver: &Leapfrog, launches: &[Launch], until: f64) -> Option<Self> {
        let launch = launches.iter().find(|l| l.sudden)?;
        let segment = &bar.segments[launch.segment];
        // Another wave may come from the far side at once, or only as a reflection of this one.
        let transits = if launches.len() > 1 { 1.0 } else { 2.0 };
        let quiet = (transits * segment.length / segment.material.c0()).min(launch.loads_until).min(until);
        let part = &solver.grid().segments[launch.segment];
        let cell = if launch.direction > 0.0 { part.cells.start } else { part.cells.end - 1 };
        let expected = launch.sense.sign() * segment.material.impedance() * launch.fan.velocity;
        let step = (0.5 * quiet / solver.grid().dt).ceil() as usize;
        Some(Self { step, cell, expected, found: None })
    }

    /// Looks at the bar; only one step counts.
    pub fn look(&mut self, bar: &Leapfrog) {
        if bar.step() == self.step {
            self.found = Some(bar.value(Quantity::Stress, self.cell));
        }
    }

    /// The finding; none where the run ended before.
    pub fn check(&self) -> Option<ElasticCheck> {
        let (stress, expected) = (self.found?, self.expected);
        Some(ElasticCheck { stress, expected, relative: ((stress - expected) / expected).abs() })
    }
}

/// Relative L1 of stress over the bar's cells at the current time against the self-similar solution; none where the
/// scene has no such solution up to now: more than one fan, a driving value that changes, or a reflection.
pub fn against_similarity(bar: &Bar, solver: &Leapfrog, launches: &[Launch]) -> Option<ErrorFigure> {
    let ([launch], [segment]) = (launches, bar.segments.as_slice()) else { return None };
    let time = solver.time();
    let alone = launch.sudden && launch.loads_until.is_infinite();
    if !alone || time == 0.0 || segment.material.c0() * time > segment.length {
        return None;
    }
    let (mut missed, mut total) = (0.0, 0.0);
    for (cell, x) in solver.grid().centres().into_iter().enumerate() {
        let exact = launch.sense.sign() * launch.fan.state((x - launch.x).abs() / time).1;
        missed += (solver.value(Quantity::Stress, cell) - exact).abs();
        total += exact.abs();
    }
    (total > 0.0).then(|| ErrorFigure {
        value: missed / total,
        measure: "relative L1 of stress over the bar at the end time".into(),
        reference: "self-similar solution".into(),
    })
}
