//! Comparison of a run with theory: sigma = rho c0 v while the bar is elastic, and the self-similar solution if it exists.

use super::{ElasticCheck, ErrorFigure, Stepped};
use crate::bar::{Bar, InitialFan};
use crate::snapshot::{self, Snapshot, pack, unpack};
use crate::solver::fd::{Grid, Quantity};

/// Check of sigma = rho c0 v (9.34) at one place and time: next to the struck end, half-way between the first arrival
/// of the wave and the first return of one.
#[derive(Debug, Clone)]
pub struct ElasticProbe {
    time: f64,
    x: f64,
    segment: usize,
    direction: f64,
    expected: f64,
    found: Option<f64>,
}

/// Distance of the probe from the origin of the wave, relative to the length of the segment: next to the origin, but not on it.
const INSIDE: f64 = 1e-6;

impl ElasticProbe {
    /// Creates a probe for the first suddenly loaded end or joint; `until` is the end time, s. Returns `None` if there
    /// is no such load, or if its segment is tapered.
    pub fn new(bar: &Bar, initial_fans: &[InitialFan], until: f64) -> Option<Self> {
        let initial_fan = initial_fans.iter().find(|l| l.sudden)?;
        let segment = Some(&bar.segments[initial_fan.segment]).filter(|segment| segment.taper.is_none())?;
        // Another wave may come from the far side immediately, or only as a reflection of this one.
        let transits = if initial_fan.alone { 2.0 } else { 1.0 };
        let quiet = (transits * segment.length / segment.material.c0()).min(initial_fan.loads_until).min(until);
        Some(Self {
            time: 0.5 * quiet,
            x: initial_fan.x + initial_fan.direction * INSIDE * segment.length,
            segment: initial_fan.segment,
            direction: initial_fan.direction,
            expected: initial_fan.sense.sign() * segment.material.impedance() * initial_fan.fan.velocity,
            found: None,
        })
    }

    /// Returns the time of the check, s.
    pub fn time(&self) -> f64 {
        self.time
    }

    /// Returns the place of the check, m.
    pub fn x(&self) -> f64 {
        self.x
    }

    /// Returns the step and the cell of the check on a grid.
    pub fn on_grid(&self, grid: &Grid) -> (usize, usize) {
        let cells = &grid.segments[self.segment].cells;
        let cell = if self.direction > 0.0 { cells.start } else { cells.end - 1 };
        ((self.time / grid.dt).ceil() as usize, cell)
    }

    /// Stores the simulated stress (Pa) at the place and time of the check.
    pub fn take(&mut self, stress: f64) {
        self.found = Some(stress);
    }

    /// Returns the result of the check; `None` if the run ended before it.
    pub fn check(&self) -> Option<ElasticCheck> {
        let (stress, expected) = (self.found?, self.expected);
        Some(ElasticCheck { stress, expected, relative: ((stress - expected) / expected).abs() })
    }
}

impl Snapshot for ElasticProbe {
    fn save(&self) -> snapshot::Result<Vec<u8>> {
        pack(&self.found)
    }

    fn restore(&mut self, saved: &[u8]) -> snapshot::Result<()> {
        self.found = unpack(saved)?;
        Ok(())
    }
}

/// Returns the relative L1 error of the stress over the bar's cells at the current time against the self-similar
/// solution. Returns `None` if the scene has no such solution up to this time: it has more than one fan, the driving
/// value changes, or a wave has been reflected.
pub fn against_similarity(bar: &Bar, solver: &impl Stepped, initial_fans: &[InitialFan]) -> Option<ErrorFigure> {
    let time = solver.time();
    let initial_fan = alone(bar, initial_fans, time)?;
    let (mut missed, mut total) = (0.0, 0.0);
    for (cell, x) in solver.grid().centres().into_iter().enumerate() {
        let exact = similar_stress(initial_fan, x, time);
        missed += (solver.value(Quantity::Stress, cell) - exact).abs();
        total += exact.abs();
    }
    figure(missed, total)
}

/// Returns the fan that is the whole solution up to `time` (s); `None` if there is no such fan.
pub fn alone<'a>(bar: &Bar, initial_fans: &'a [InitialFan], time: f64) -> Option<&'a InitialFan> {
    let ([initial_fan], [segment]) = (initial_fans, bar.segments.as_slice()) else { return None };
    let alone =
        initial_fan.alone && initial_fan.sudden && initial_fan.loads_until.is_infinite() && segment.taper.is_none();
    (alone && time > 0.0 && segment.material.c0() * time <= segment.length).then_some(initial_fan)
}

/// Returns the stress of a fan at a place and time, Pa, tension positive.
pub fn similar_stress(initial_fan: &InitialFan, x: f64, time: f64) -> f64 {
    initial_fan.sense.sign() * initial_fan.fan.state((x - initial_fan.x).abs() / time).1
}

fn figure(missed: f64, total: f64) -> Option<ErrorFigure> {
    (total > 0.0).then(|| ErrorFigure {
        value: missed / total,
        measure: "relative L1 of stress over the bar at the end time".into(),
        reference: "self-similar solution".into(),
        table: None,
    })
}
