//! The energy balance of every solver. Each entry is declared once, here, for the ledger, result files and reports.

use serde::{Deserialize, Serialize};

/// Declares [`Energies`] with its entries: doc comment, name, and long name of the dataset.
macro_rules! energies {
    ($($(#[doc = $doc:literal])* $name:ident: $long_name:literal,)*) => {
        /// Energies of a bar at one time, J (per m^2 if the scene gives no area), and its momentum.
        ///
        /// All entries except `half_step` are >= 0 within rounding, with these exceptions. `numerical` may be negative with the Godunov scheme in
        /// smooth flow, with leapfrog by up to the energy of one cell of the bar (4 % of the total energy was observed with 20 cells), and with front
        /// tracking within a few front tolerances. `plastic` may decrease if the curve is followed both ways, and if a back stress returns the work
        /// that it stored (with `mixed` hardening along a multilinear curve it may return more).
        #[derive(Debug, Clone, Copy, Default, PartialEq, Serialize)]
        pub struct Energies {
            $($(#[doc = $doc])* pub $name: f64,)*
            /// Momentum, N s, positive in +x.
            pub momentum: f64,
        }

        impl Energies {
            /// Name and long name of every energy.
            pub const COLUMNS: &[[&str; 2]] = &[$([stringify!($name), $long_name],)*];

            /// Every energy, in the order of [`Energies::COLUMNS`], J.
            pub fn values(&self) -> [f64; Self::COLUMNS.len()] {
                [$(self.$name,)*]
            }

            /// Collects energies by name; entries for which `of` returns `None` are 0.
            pub fn by_name(mut of: impl FnMut(&str) -> Option<f64>) -> Self {
                Self { $($name: of(stringify!($name)).unwrap_or(0.0),)* momentum: 0.0 }
            }
        }
    };
}

energies! {
    /// Kinetic energy of the velocities at this time; with lateral inertia, it includes that of the lateral motion.
    kinetic: "kinetic energy",
    /// Recoverable strain energy, sigma^2/(2E) per volume.
    elastic: "recoverable strain energy",
    /// Plastic work since the start on the quasi-static curve, and dissipation by shocks: the area between the curve and the chord along which a
    /// shock loads. On a grid, the latter is the numerical dissipation in the cells of a shock; where the curve is followed both ways it is part of
    /// `numerical`. With the effect of heat, the part of both that was not converted to heat.
    plastic: "energy dissipated in plastic flow and shocks since the start, excluding heat",
    /// Plastic work converted to heat since the start, including that of the overstress; 0 without the effect of heat. It is a constant fraction of
    /// all plastic work, and decreases in reverse flow in which a back stress returns work.
    heat: "plastic work converted to heat since the start",
    /// Plastic work of the overstress of a rate-dependent bar since the start, excluding heat.
    viscoplastic: "work of the overstress of a rate-dependent bar since the start",
    /// Dissipated since the start by the method itself, shocks excluded: by the grid filter, by the merging of fronts, and where faces or bodies meet
    /// within a step; 0 in an elastic run without any of these.
    numerical: "energy dissipated since the start by the numerical method",
    /// Energy due to the half-step offset of the staggered grid, of either sign and of first order in the cell size. Velocities are known half a step
    /// before and after the stresses, and forces of ends and joints act in halves. A cell that flows in both senses within a step, or crosses its
    /// elastic range and flows at the other side, flows under another stress than the mean of the step.
    half_step: "energy due to the half-step offset of velocities and stresses, of either sign",
    /// Dissipated since the start at single points of discontinuous velocity, where a level curve lets no strain propagate away.
    concentrated: "energy dissipated since the start at points of discontinuous velocity",
    /// Dissipated since the start by fractures.
    fracture: "energy dissipated since the start by fractures",
    /// Dissipated since the start by internal and external damping and by friction.
    damping: "energy dissipated since the start by internal and external damping and by friction",
    /// Energy stored in the elastic foundation.
    foundation: "energy stored in the elastic foundation",
}

impl Energies {
    /// Adds a dissipation by flow (J), of which this fraction was converted to heat.
    pub(super) fn add_flow(&mut self, dissipated: f64, heat_fraction: f64) {
        self.plastic += (1.0 - heat_fraction) * dissipated;
        self.heat += heat_fraction * dissipated;
    }

    /// Total energy of the bar including all dissipation, J.
    pub fn total(&self) -> f64 {
        self.values().iter().sum()
    }
}

/// Dissipation of a grid method in the cells of shocks, summed over steps. The sum oscillates from step to step; shocks do not return energy, so that
/// their dissipation is the largest sum so far.
#[derive(Debug, Clone, Copy, Default, Serialize, Deserialize)]
pub(super) struct ShockLoss {
    sum: f64,
    largest: f64,
}

impl ShockLoss {
    /// Adds the dissipation of one step.
    pub fn note(&mut self, taken: f64) {
        self.sum += taken;
        self.largest = self.largest.max(self.sum);
    }

    /// Returns the energy dissipated by shocks so far.
    pub fn dissipated(&self) -> f64 {
        self.largest
    }
}
