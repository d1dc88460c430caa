//! Neglected elastic unloading, estimated from yielded sections that unload along the loading curve.
//!
//! Along the curve, a stress drop d sigma with the strain drop d eps travels at `c = sqrt(d sigma/(rho d eps))`;
//! elastic unloading would have carried it at c0, and thus c0/c times as far. The length that it has not reached is
//! c0/c - 1 times the length that has unloaded. The change is `(c0/c - 1) d sigma = sqrt(E d eps d sigma) - d sigma`
//! per unloaded length, and at most the integral of the stress over the rest of the bar.

use std::sync::Arc;

use serde::{Deserialize, Serialize};

use super::Reading;
use super::finding::Finding;
use super::places::Places;
use crate::material::{Material, Sense};
use crate::units::{Dimension, System, format};

/// Fraction of its largest strain by which a yielded place must unload before it counts as unloaded. The oscillations
/// of the scheme are smaller, except in a few cells next to a struck end.
const UNLOADED_BY: f64 = 0.02;

/// Number of adjacent cells that must have unloaded, for the same reason.
const CELLS_TOGETHER: usize = 8;

#[derive(Debug, Serialize, Deserialize)]
pub(super) struct Unloading {
    /// Elastic limit strain of each place in tension and in compression.
    limit: Vec<[f64; 2]>,
    /// Signed strain of largest magnitude so far, and the magnitude of the stress at that time, Pa.
    largest: Vec<(f64, f64)>,
    unloaded: Vec<bool>,
    /// Time (s) and place of the first unloading.
    first: Option<(f64, usize)>,
    worst: f64,
    /// Largest change of all samples, Pa m.
    change: f64,
    /// Number of adjacent places that must have unloaded.
    together: usize,
}

impl Unloading {
    pub fn new(places: &Places, materials: &[Arc<Material>], cells: Option<usize>) -> Self {
        let count = places.x.len();
        let limit = |k: &usize| {
            let m = &materials[*k];
            [Sense::Tension, Sense::Compression].map(|sense| m.branch(sense).elastic_limit(m.modulus).0)
        };
        let together = cells.map_or(1, |cells| (CELLS_TOGETHER * count).div_ceil(cells).max(2));
        Self {
            limit: places.segment.iter().map(limit).collect(),
            largest: vec![(0.0, 0.0); count],
            unloaded: vec![false; count],
            first: None,
            worst: 0.0,
            change: 0.0,
            together,
        }
    }

    pub fn sample(&mut self, now: &Reading, places: &Places, materials: &[Arc<Material>]) {
        let (mut change, mut held, mut start) = (0.0, 0.0, 0);
        let count = now.strain.len();
        for k in 0..=count {
            if k < count && self.has_unloaded(k, now) {
                continue;
            }
            if k - start >= self.together {
                change += (start..k).map(|k| self.missed(k, now, places, materials)).sum::<f64>();
                self.note(start..k, now);
            }
            if k < count {
                held += places.weight[k] * now.stress[k].abs();
            }
            start = k + 1;
        }
        self.change = self.change.max(change.min(held));
    }

    /// Updates the largest strain of a place; returns true if the place has yielded and unloaded since.
    fn has_unloaded(&mut self, k: usize, now: &Reading) -> bool {
        let (strain, stress) = (now.strain[k], now.stress[k]);
        if strain.abs() > self.largest[k].0.abs() {
            self.largest[k] = (strain, stress.abs());
        }
        let largest = self.largest[k].0;
        let limit = self.limit[k][usize::from(largest < 0.0)];
        largest.abs() > limit && 1.0 - strain / largest > UNLOADED_BY
    }

    fn missed(&self, k: usize, now: &Reading, places: &Places, materials: &[Arc<Material>]) -> f64 {
        let (largest, peak) = self.largest[k];
        let back = (largest - now.strain[k]).abs();
        let drop = (peak - now.stress[k] * largest.signum()).max(0.0);
        let elastic = materials[places.segment[k]].modulus * back;
        places.weight[k] * ((elastic * drop).sqrt() - drop).max(0.0)
    }

    fn note(&mut self, run: std::ops::Range<usize>, now: &Reading) {
        self.first.get_or_insert((now.time, run.start));
        for k in run {
            self.unloaded[k] = true;
            self.worst = self.worst.max(1.0 - now.strain[k] / self.largest[k].0);
        }
    }

    pub fn finding(&self, places: &Places, share: impl Fn(f64) -> f64) -> Finding {
        let Some((time, place)) = self.first else {
            return Finding::nothing("no yielded section unloaded");
        };
        let lengths = |of: &dyn Fn(usize) -> bool| -> f64 {
            (0..places.x.len()).filter(|&k| of(k)).map(|k| places.weight[k]).sum()
        };
        let yielded = |k: usize| self.largest[k].0.abs() > self.limit[k][usize::from(self.largest[k].0 < 0.0)];
        let show = |length| format(length, Dimension::Length, System::Si);
        let basis = std::format!(
            "{} of {} of yielded length unloaded, by up to {:.0} % of the largest strain, first at {}",
            show(lengths(&|k| self.unloaded[k])),
            show(lengths(&yielded)),
            100.0 * self.worst,
            places.moment(time, place),
        );
        Finding::of(share(self.change), "elastic unloading", &basis, "hardening = \"isotropic\"")
    }
}
