//! The energy balance of every solver: each entry is declared once, here, for the ledger, result files and reports.

use serde::{Deserialize, Serialize};

/// Declares [`Energies`] with its entries: name, a line for its dataset, and what it is.
macro_rules! energies {
    ($($(#[doc = $doc:literal])* $name:ident: $long_name:literal,)*) => {
        /// Energies of a bar at a moment, J (per m^2 where the scene gives no area), and its momentum.
        ///
        /// All but `half_step` are >= 0 to rounding, with these exceptions: `numerical` may be negative by the Godunov scheme in smooth
        /// flow, by leapfrog by up to the energy of a cell of the bar (4 % of all energy with 20 cells was seen), and by front tracking
        /// within a few front tolerances; `plastic` where the curve is followed both ways, and where a back stress gives back what it
        /// stored (with `mixed` hardening along a curve of several lines it may give back more).
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

            /// Energies by their names; what `of` does not know is 0.
            pub fn by_name(mut of: impl FnMut(&str) -> Option<f64>) -> Self {
                Self { $($name: of(stringify!($name)).unwrap_or(0.0),)* momentum: 0.0 }
            }
        }
    };
}

energies! {
    /// Kinetic energy of the velocities at this time; with lateral inertia that of the sideways motion is in it.
    kinetic: "kinetic energy",
    /// Recoverable strain energy, sigma^2/(2E) per volume.
    elastic: "recoverable strain energy",
    /// Plastic work since the start on the quasi-static curve, and what shocks dissipate: the area between the curve and the chord along which
    /// a shock runs. On a grid the latter is what the method takes in the cells of a shock; where the curve is followed both ways it is in
    /// `numerical`. With the effect of heat, what of both did not turn into heat.
    plastic: "energy dissipated in plastic flow and shocks since the start, excluding heat",
    /// Plastic work that turned into heat since the start, that of the overstress with it; 0 without the effect of heat. It is the same
    /// fraction of all plastic work, and decreases in reverse flow in which a back stress gives work back.
    heat: "plastic work converted to heat since the start",
    /// Plastic work of the overstress of a rate-dependent bar since the start, as far as it did not turn into heat.
    viscoplastic: "work of the overstress of a rate-dependent bar since the start",
    /// Taken since the start by the method itself, shocks excluded: by the grid filter, the merging of fronts, or where faces or
    /// bodies meet within a step; 0 in an elastic run without such.
    numerical: "energy dissipated since the start by the numerical method",
    /// What the staggered grid holds between two of its half steps, of either sign and of first order in the cell size: velocities are
    /// known half a step before and after the stresses, forces of ends and joints act in halves, and a cell that goes from one side of its
    /// elastic range to flow on the other within a step, or flows on both, flows under another stress than the mean of the step.
    half_step: "energy due to the half-step offset of velocities and stresses, of either sign",
    /// Taken since the start at single points where velocities differ, because a level curve lets no strain leave.
    concentrated: "energy dissipated since the start at points of discontinuous velocity",
    /// Taken since the start by fractures.
    fracture: "energy dissipated since the start by fractures",
    /// Taken since the start by internal and external damping and by friction.
    damping: "energy dissipated since the start by internal and external damping and by friction",
    /// Stored in the elastic foundation.
    foundation: "energy stored in the elastic foundation",
}

impl Energies {
    /// Adds a dissipation by flow, J, of which this fraction turned into heat.
    pub(super) fn add_flow(&mut self, dissipated: f64, heat_fraction: f64) {
        self.plastic += (1.0 - heat_fraction) * dissipated;
        self.heat += heat_fraction * dissipated;
    }

    /// All energy in the bar, dissipated included, J.
    pub fn total(&self) -> f64 {
        self.values().iter().sum()
    }
}

/// What a grid method takes in the cells of shocks, summed over steps. The sum swings from step to step; what shocks dissipate never comes
/// back, so that it is the largest sum so far.
#[derive(Debug, Clone, Copy, Default, Serialize, Deserialize)]
pub(super) struct ShockLoss {
    sum: f64,
    largest: f64,
}

impl ShockLoss {
    /// Adds what was taken in a step.
    pub fn note(&mut self, taken: f64) {
        self.sum += taken;
        self.largest = self.largest.max(self.sum);
    }

    /// What shocks have dissipated.
    pub fn dissipated(&self) -> f64 {
        self.largest
    }
}
