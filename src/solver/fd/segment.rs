//! Constants of a segment on the grid.

use std::sync::Arc;

use super::SegmentGrid;
use super::grid_filter::{Filter, Shocks};
use crate::bar::Segment;
use crate::law::{DataEnd, RowLaw};

/// The law of one segment, as assembled from its material and the effects.
#[derive(Clone)]
pub struct SegmentLaw {
    /// Stepping law.
    pub law: Arc<dyn RowLaw>,
    /// Stress below which the law is elastic in both senses, Pa.
    pub yield_stress: f64,
    /// Where its data end.
    pub end: DataEnd,
    /// Which of its waves can be shocks.
    pub shocks: Shocks,
    /// Accumulated plastic strains at which its curve stiffens, times E, ascending, in tension and in compression, Pa; none where it is followed
    /// both ways.
    pub stiffenings: [Arc<[f64]>; 2],
}

/// Constants of a segment.
#[derive(Debug, Clone, Copy)]
pub(super) struct Constants {
    pub modulus: f64,
    pub stress_gain: f64,
    pub velocity_gain: f64,
    /// rho A dx, kg; of a tapered segment with its mean area.
    pub cell_mass: f64,
    /// A dx, m^3; likewise.
    pub cell_volume: f64,
    /// A, m^2; likewise.
    pub area: f64,
    /// Cells that an elastic wave passes in a step.
    pub courant: f64,
    pub filter: Filter,
}

impl Constants {
    /// In steps of `dt` (s).
    pub fn new(segment: &Segment, part: &SegmentGrid, dt: f64, shocks: Shocks) -> Self {
        let (modulus, density, c0) = (segment.material.modulus, segment.material.density, segment.material.c0());
        let courant = c0 * dt / part.dx;
        Self {
            modulus,
            stress_gain: modulus * dt / part.dx,
            velocity_gain: dt / (density * part.dx),
            cell_mass: density * segment.area * part.dx,
            cell_volume: segment.area * part.dx,
            area: segment.area,
            courant,
            filter: Filter::new(c0, courant, shocks),
        }
    }
}
