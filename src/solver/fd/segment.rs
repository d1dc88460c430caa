//! Constants of a segment on the grid.

use std::sync::Arc;

use super::SegmentGrid;
use super::grid_filter::{Filter, Shocks};
use crate::bar::Segment;
use crate::law::{DataEnd, RowLaw};

/// Law of one segment, as assembled from its material and the effects.
#[derive(Clone)]
pub struct SegmentLaw {
    /// Law that advances the cells.
    pub law: Arc<dyn RowLaw>,
    /// Stress below which the law is elastic in both senses, Pa.
    pub yield_stress: f64,
    /// Where the data of the law end.
    pub end: DataEnd,
    /// Which of the segment's waves can be shocks.
    pub shocks: Shocks,
    /// Accumulated plastic strains at which the curve stiffens, times E, ascending, in tension and in compression, Pa; empty if the curve
    /// is followed in both directions.
    pub stiffenings: [Arc<[f64]>; 2],
}

/// Fractions of the strain, and of the velocity difference in one cell, at which loading reaches the part of the curve that stiffens. Above
/// them waves can be shocks: a shock is spread over about four cells from the first step on.
const NEAR_STRAIN: f64 = 0.5;
const NEAR_VELOCITY: f64 = 0.25;

impl SegmentLaw {
    /// Returns E times the smallest accumulated plastic strain at which the curve stiffens, Pa; infinite if it does not.
    pub(super) fn first_stiffening(&self) -> f64 {
        self.stiffenings.iter().filter_map(|knots| knots.first()).copied().fold(f64::INFINITY, f64::min)
    }

    /// Returns whether waves can be shocks: if E times the largest accumulated plastic strain is `reached` (Pa), or the velocity changes by
    /// `gap` (m/s) over a cell. Always true if the curve is followed in both directions, so that unloading waves are shocks.
    pub(super) fn has_shocks(&self, reached: f64, gap: f64) -> bool {
        let Shocks { loading, unloading, velocity } = self.shocks;
        if loading == [0.0; 2] || unloading != [0.0; 2] {
            return unloading != [0.0; 2];
        }
        reached > NEAR_STRAIN * self.first_stiffening() || gap > NEAR_VELOCITY * velocity
    }
}

/// Constants of a segment.
#[derive(Debug, Clone, Copy)]
pub(super) struct Constants {
    pub modulus: f64,
    pub stress_gain: f64,
    pub velocity_gain: f64,
    /// rho A dx, kg; with the mean area of a tapered segment.
    pub cell_mass: f64,
    /// A dx, m^3; likewise.
    pub cell_volume: f64,
    /// A, m^2; likewise.
    pub area: f64,
    /// Courant number: number of cells that an elastic wave crosses in a step.
    pub courant: f64,
    /// Whether elastic waves cross a cell in exactly one step, so that a uniform block can be carried as waves.
    pub travels: bool,
    /// Filter where waves can be shocks, and where they cannot.
    shock_filter: Filter,
    filter: Filter,
}

/// Difference from 1 up to which a Courant number counts as 1.
const ROUND_OFF: f64 = 4.0 * f64::EPSILON;

impl Constants {
    /// Computes the constants for steps of `dt` (s).
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
            travels: (courant - 1.0).abs() <= ROUND_OFF,
            shock_filter: Filter::new(c0, courant, shocks),
            filter: Filter::new(c0, courant, Shocks::NONE),
        }
    }

    /// Returns the constants with Love's lateral inertia of (nu r)^2 = `lateral` (m^2) in cells of `dx` (m), in which no waves are shocks.
    #[must_use]
    pub fn with_lateral(self, lateral: f64, dx: f64) -> Self {
        Self { filter: self.filter.with_mass(1.0 + 4.0 * lateral / (dx * dx)), ..self }
    }

    /// Returns the velocity difference of neighbouring nodes that counts as a rounding error, m/s.
    pub fn rounding(&self) -> f64 {
        self.filter.rounding
    }

    /// Returns the filter of a block in which waves can be shocks, or cannot.
    pub fn filter(&self, shocks: bool) -> &Filter {
        if shocks { &self.shock_filter } else { &self.filter }
    }
}
