//! A segment of the scheme.

use crate::bar::Segment;
use crate::solver::fd::{SegmentGrid, SegmentLaw};
use crate::wave::riemann::{Faces, Flow, Medium};

/// Energy that slopes may give to a cell, as a part of its elastic energy at yield.
const MOST_ENERGY_DEFECT: f64 = 1e-3;

/// A segment with its law and what its faces need.
#[derive(Clone)]
pub struct Part {
    pub(super) law: SegmentLaw,
    pub(super) faces: Faces,
    pub(super) path_independent: bool,
    pub(super) modulus: f64,
    pub(super) density: f64,
    pub(super) area: f64,
    pub(super) dx: f64,
    /// E dt/dx, Pa s/m.
    pub(super) gain: f64,
    /// dt/(rho dx), m/s per Pa.
    pub(super) velocity_gain: f64,
    /// E times the strains (of a curve followed both ways) or accumulated plastic strains at which the curve stiffens, in tension and
    /// compression, Pa; none along most curves.
    pub(super) stiffens: Option<[Vec<f64>; 2]>,
    /// Stress up to which everything is elastic, Pa.
    pub(super) limit: f64,
    /// Energy that slopes may give to a cell, W/m^2, where the curve has a level or falling stretch; none along other curves.
    pub(super) most_energy_defect: Option<f64>,
    /// E times the strains (of a curve followed both ways) or accumulated plastic strains from which the curve is level or falls, in tension and
    /// compression, Pa; infinite where it rises throughout.
    pub(super) levels: [f64; 2],
}

impl Part {
    pub(super) fn new(segment: &Segment, grid: &SegmentGrid, dt: f64, law: SegmentLaw, medium: Medium) -> Self {
        let faces = Faces::new(medium);
        let limit = law.yield_stress.min(faces.yield_stress());
        let gain = segment.material.modulus * dt / grid.dx;
        let levels = faces.levels();
        Self {
            path_independent: faces.medium.flow == Flow::PathIndependent,
            modulus: segment.material.modulus,
            density: segment.material.density,
            area: segment.area,
            dx: grid.dx,
            gain,
            velocity_gain: dt / (segment.material.density * grid.dx),
            stiffens: Some(faces.stiffenings()).filter(|all| all.iter().any(|knots| !knots.is_empty())),
            limit,
            most_energy_defect: levels
                .iter()
                .any(|level| level.is_finite())
                .then(|| MOST_ENERGY_DEFECT * limit * limit / (2.0 * gain)),
            levels,
            faces,
            law,
        }
    }

    /// The elastic range grows evenly, about zero stress: what is within the first limit is elastic for ever.
    pub(super) fn isotropic(&self) -> bool {
        self.faces.medium.flow == Flow::Plastic { kinematic: 0.0 }
    }

    /// Shocks leave their dissipation in the material: along a curve that is followed both ways it is not plastic work.
    pub(super) fn keeps_shocks(&self) -> bool {
        self.stiffens.is_some() && !self.path_independent
    }

    /// A cell that has come so far along the curve in tension and in compression is where that is level or falls, Pa, as [`Part::levels`] counts.
    pub(super) fn is_level(&self, along: [f64; 2]) -> bool {
        along.iter().zip(self.levels).any(|(&along, level)| along >= level)
    }

    /// Some cells may have no slopes.
    pub(super) fn may_be_first_order(&self) -> bool {
        self.path_independent || self.stiffens.is_some() || self.most_energy_defect.is_some()
    }

    /// rho A dx, kg.
    pub(super) fn cell_mass(&self) -> f64 {
        self.density * self.area * self.dx
    }

    /// A dx, m^3.
    pub(super) fn cell_volume(&self) -> f64 {
        self.area * self.dx
    }
}
