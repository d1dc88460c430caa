//! A segment of the scheme.

use crate::bar::Segment;
use crate::solver::fd::{SegmentGrid, SegmentLaw};
use crate::wave::riemann::{Faces, Flow, Medium};

/// Energy that slopes may give to a cell, relative to its elastic energy at yield.
const MOST_ENERGY_DEFECT: f64 = 1e-3;

/// A segment with its law and the data for its faces.
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
    /// compression, Pa; `None` for most curves.
    pub(super) stiffens: Option<[Vec<f64>; 2]>,
    /// Stress up to which all is elastic, Pa.
    pub(super) limit: f64,
    /// Energy that slopes may give to a cell, W/m^2, if the curve has a level or falling part; `None` for other curves.
    pub(super) most_energy_defect: Option<f64>,
    /// E times the strains (of a curve followed both ways) or accumulated plastic strains from which the curve is level or falls, in tension and
    /// compression, Pa; infinite if it rises throughout.
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

    /// Returns whether hardening is isotropic: the elastic range grows about zero stress, so that stresses within the first limit always stay
    /// elastic.
    pub(super) fn isotropic(&self) -> bool {
        self.faces.medium.flow == Flow::Plastic { kinematic: 0.0 }
    }

    /// Returns whether the dissipation of shocks remains in the material as plastic work. Where the curve is followed both ways it does not.
    pub(super) fn keeps_shocks(&self) -> bool {
        self.stiffens.is_some() && !self.path_independent
    }

    /// Returns whether a cell at these values (Pa, in tension and in compression) of the quantity that [`Part::levels`] counts is on a level or
    /// falling part of the curve.
    pub(super) fn is_level(&self, along: [f64; 2]) -> bool {
        along.iter().zip(self.levels).any(|(&along, level)| along >= level)
    }

    /// Returns whether some cells may have no slopes.
    pub(super) fn may_be_first_order(&self) -> bool {
        self.path_independent || self.stiffens.is_some() || self.most_energy_defect.is_some()
    }

    /// Mass of a cell, rho A dx, kg.
    pub(super) fn cell_mass(&self) -> f64 {
        self.density * self.area * self.dx
    }

    /// Volume of a cell, A dx, m^3.
    pub(super) fn cell_volume(&self) -> f64 {
        self.area * self.dx
    }
}
