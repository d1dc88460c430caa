//! Audit of neglected effects: estimates the change of the stress by every effect that is off.
//!
//! The result to which the audit refers is the stress. An estimate is the largest L1 change of the stress over the bar
//! at any time of the run, relative to the largest L1 norm of the stress:
//! `max_t int |d sigma| dx / max_t int |sigma| dx`. It is computed from the run without the effect, to first order: it
//! includes the direct contribution of the effect, not its consequences. A change of the outcome (the bar fractures)
//! counts as 1.
//!
//! The state is sampled at about 128 places, [`AUDIT_SAMPLES`] times per run, and only after some section has yielded, which is
//! cheap compared with the stepping. Tensile strains can be largest in a single cell and are therefore read in every
//! cell. The evaluation of each effect is in a file of its own.

mod finding;
mod heat;
mod joints;
mod lateral;
mod places;
mod rate;
mod reversal;
mod rupture;
mod spread;
mod unloading;

use std::sync::Arc;

use finding::Finding;
use heat::Heat;
use joints::Joints;
use places::Places;
use rate::RateRise;
pub use rate::unresolved_flow;
pub use reversal::reversed_flow;
use rupture::TensileStrain;
pub use rupture::{above_critical, at_limit, broken_end, broken_inside, late_fracture, past_data, short_tension};
use serde::{Deserialize, Serialize};
use spread::Spread;
use unloading::Unloading;

use super::{AuditRow, Field, View};
use crate::bar::{Bar, EndCondition};
use crate::material::Material;
use crate::snapshot::{self, Snapshot, pack, unpack};

/// Number of times that the bar is sampled during a run.
pub const AUDIT_SAMPLES: usize = 64;

/// Effects that are off. Effects that are on get no row.
#[derive(Debug, Clone, Copy, Default)]
#[expect(clippy::struct_excessive_bools, reason = "one field per key of the scene")]
pub struct Off {
    /// `hardening`.
    pub unloading: bool,
    /// `rate`.
    pub rate: bool,
    /// `heat`.
    pub heat: bool,
    /// `rupture`.
    pub rupture: bool,
    /// `lateral-inertia`.
    pub lateral_inertia: bool,
}

/// Data of a run for the audit, known before it starts.
#[derive(Debug, Clone, Copy)]
pub struct Case<'a> {
    /// Bar of the run.
    pub bar: &'a Bar,
    /// Boundary conditions of the left and the right end.
    pub ends: [&'a EndCondition; 2],
    /// End time, s.
    pub until: f64,
    /// Relative change above which an effect is significant.
    pub tolerance: f64,
    /// Effects that are off.
    pub off: Off,
    /// True if the bar is twisted: heat and rupture are not simulated in torsion.
    pub torsion: bool,
    /// Number of cells of the grid; `None` without a grid.
    pub cells: Option<usize>,
}

/// Estimates of the effects that a run neglects.
#[derive(Debug)]
pub struct Audit {
    off: Off,
    torsion: bool,
    tolerance: f64,
    materials: Vec<Arc<Material>>,
    places: Places,
    now: Reading,
    looked: bool,
    /// Largest int |sigma| dx of all samples, Pa m.
    peak: f64,
    unloading: Unloading,
    heat: Heat,
    rate: RateRise,
    tensile: TensileStrain,
    joints: Joints,
    lateral: AuditRow,
}

/// State at every place at one sampling time.
#[derive(Debug, Default, Serialize, Deserialize)]
struct Reading {
    /// Time of the sample, s.
    time: f64,
    /// Time since the previous sample (or the start), s.
    lapse: f64,
    stress: Vec<f64>,
    strain: Vec<f64>,
    /// Accumulated plastic strain since the start.
    plastic: Vec<f64>,
}

impl Audit {
    /// Creates the audit of a bar at t = 0.
    pub fn new(case: &Case<'_>) -> Self {
        let materials: Vec<Arc<Material>> = case.bar.segments.iter().map(|s| Arc::clone(&s.material)).collect();
        let places = Places::new(case.bar);
        let count = places.x.len();
        let zeros = vec![0.0; count];
        Self {
            off: case.off,
            torsion: case.torsion,
            tolerance: case.tolerance,
            now: Reading { stress: zeros.clone(), strain: zeros.clone(), plastic: zeros, ..Reading::default() },
            looked: false,
            peak: 0.0,
            unloading: Unloading::new(&places, &materials, case.cells),
            heat: Heat::new(&materials, count, Spread::new(case.bar, &places)),
            rate: RateRise::new(&materials, count, Spread::new(case.bar, &places)),
            tensile: TensileStrain::new(case.bar, case.cells.filter(|_| case.off.rate)),
            joints: Joints::new(case.bar, &places),
            lateral: lateral::row(case),
            materials,
            places,
        }
    }

    /// Returns the sampling places, m, increasing.
    pub fn places(&self) -> &[f64] {
        &self.places.x
    }

    /// Samples a bar in which some section has yielded; `at` are [`Audit::places`] in the form in which the bar reads them.
    pub fn sample<V: View>(&mut self, bar: &V, at: &V::Places) {
        let now = &mut self.now;
        (now.lapse, now.time) = (bar.time() - now.time, bar.time());
        bar.sample(Field::Stress, at, &mut now.stress);
        bar.sample(Field::Strain, at, &mut now.strain);
        if self.off.unloading {
            // Unloading follows the curve: the plastic strain is the part of the strain that is not elastic.
            for (k, plastic) in now.plastic.iter_mut().enumerate() {
                let elastic = now.stress[k] / self.materials[self.places.segment[k]].modulus;
                *plastic = (now.strain[k] - elastic).abs();
            }
        } else if self.off.heat || self.off.rate {
            bar.sample(Field::AccumulatedPlasticStrain, at, &mut now.plastic);
            now.plastic.iter_mut().zip(&self.places.at_start).for_each(|(plastic, start)| *plastic -= start);
        }
        if self.off.rupture {
            self.tensile.sample(bar);
        }
        self.take_in();
    }

    fn take_in(&mut self) {
        let (now, places) = (&self.now, &self.places);
        self.looked = true;
        self.peak = self.peak.max(now.stress.iter().zip(&places.weight).map(|(s, w)| s.abs() * w).sum());
        self.joints.sample(now);
        if self.off.unloading {
            self.unloading.sample(now, places, &self.materials);
        }
        if self.off.heat {
            self.heat.sample(now, places);
        }
        if self.off.rate {
            self.rate.sample(now, places);
        }
    }

    /// Returns one row for each effect that was off; `broken` are the rows of fractures.
    pub fn rows(&self, broken: Vec<AuditRow>) -> Vec<AuditRow> {
        let row = |effect: &str, find: &dyn Fn() -> Finding| {
            let finding = if self.looked { find() } else { Finding::nothing("the bar stays elastic") };
            finding.row(effect, self.tolerance)
        };
        let share = |sum: f64| if sum > 0.0 { (sum / self.peak).min(1.0) } else { 0.0 };
        let (materials, places) = (&self.materials, &self.places);
        let axial = |finding: Finding| if self.torsion { finding.not_with("torsion") } else { finding };
        let mut rows = Vec::new();
        if self.off.unloading {
            rows.push(row("hardening", &|| self.unloading.finding(places, share)));
        }
        if self.off.rate {
            rows.push(row("rate", &|| self.rate.finding(materials, places, share)));
        }
        if self.off.heat {
            rows.push(row("heat", &|| axial(self.heat.finding(materials, places, share))));
        }
        if broken.is_empty() && self.off.rupture {
            rows.push(row("rupture", &|| axial(self.tensile.finding(materials, !self.off.rate))));
        }
        rows.extend(broken.into_iter().map(|row| AuditRow { threshold: self.tolerance, ..row }));
        rows.extend(self.joints.row());
        if self.off.lateral_inertia {
            rows.push(self.lateral.clone());
        }
        rows
    }
}

impl Snapshot for Audit {
    fn save(&self) -> snapshot::Result<Vec<u8>> {
        let Self { now, looked, peak, unloading, heat, rate, tensile, joints, .. } = self;
        pack(&(now, looked, peak, unloading, heat, rate, tensile, joints))
    }

    fn restore(&mut self, saved: &[u8]) -> snapshot::Result<()> {
        let before = (std::mem::take(&mut self.heat.media), std::mem::take(&mut self.rate.media));
        (self.now, self.looked, self.peak, self.unloading, self.heat, self.rate, self.tensile, self.joints) =
            unpack(saved)?;
        (self.heat.media, self.rate.media) = before;
        Ok(())
    }
}
