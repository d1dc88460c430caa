//! Impacts without waves in a bar: the energy method, spheres, plates and beams.
//!
//! A kind of impact is a type that implements [`Problem`], in one file or folder here, and a file in `scene/impacts/` that reads it.

mod beam;
mod check;
pub(crate) mod contact;
mod decay;
mod ellipse;
mod oscillator;
mod plate;
mod pulse;
mod solid;
mod solution;
mod specimen;
mod spheres;

use std::fmt::Debug;
use std::ops::ControlFlow;

pub(crate) use beam::buckling;
pub use beam::{Beam, Face, Foundation, Section};
pub(crate) use check::Tolerances;
pub use contact::{Contact, History, Horizon, Moment, System, Touch};
pub use ellipse::Ellipse;
pub use oscillator::Oscillator;
pub use plate::{Plate, handbook_restitution};
pub use pulse::{Pulse, phi_psi};
pub use solid::{Elastic, Solid, contact_is_wide, contact_yields};
pub use solution::{Column, Figure, Line, Shapes, Solution, Table};
pub use specimen::{Blow, Outcome, Specimen, Toughness};
pub use spheres::{Spheres, velocities_after, velocity_before};

use crate::error::InputError;
use crate::units::{self, Dimension, format};

/// Callback that receives the progress, 0 to 1, and can interrupt an integration.
pub type Watch<'a> = &'a mut dyn FnMut(f64) -> ControlFlow<()>;

/// An impact of any kind: constructed from its public type, or read from a scene.
///
/// ```
/// use barwave::impact::{Elastic, Plate, Problem, Solid};
/// use std::ops::ControlFlow;
///
/// let steel = Elastic { modulus: 207e9, poisson: 0.3, density: 7850.0, yield_stress: None };
/// let ball = Solid { radius: 0.005, mass: 0.0041, velocity: 0.5, elastic: steel };
/// let plate = Plate { thickness: 0.01, elastic: steel, striker: ball, tolerance: 1e-8, until: None };
/// let solution = plate.solve(&mut |_| ControlFlow::Continue(()))?;
/// println!("restitution {:.3}", solution.figure("restitution").expect("it rebounds"));
/// assert!(Plate { thickness: 0.0, ..plate }.solve(&mut |_| ControlFlow::Continue(())).is_err());
/// # Ok::<(), barwave::error::Error>(())
/// ```
pub trait Problem: Debug + Send + Sync {
    /// Name of the scene's table and of the group in the result file.
    fn kind(&self) -> &'static str;

    /// Name of the method in files and summaries.
    fn method(&self) -> &'static str {
        self.kind()
    }

    /// Checks that the members are within their documented ranges.
    ///
    /// # Errors
    /// The first member out of its range, by its name.
    fn check(&self) -> Result<(), InputError>;

    /// Returns the results that need no integration; the members are within their ranges.
    fn planned(&self) -> Solution;

    /// Returns the result; the members are within their ranges. If `watch` breaks, the result so far, with the outcome "interrupted".
    fn solved(&self, watch: Watch<'_>) -> Solution;

    /// Checks the members and returns the results that need no integration.
    ///
    /// # Errors
    /// As for [`Problem::check`].
    fn plan(&self) -> Result<Solution, InputError> {
        self.check().map(|()| self.planned())
    }

    /// Checks the members and returns the result; if `watch` breaks, the result so far, with the outcome "interrupted".
    ///
    /// # Errors
    /// As for [`Problem::check`].
    fn solve(&self, watch: Watch<'_>) -> Result<Solution, InputError> {
        self.check().map(|()| self.solved(watch))
    }

    /// Returns the parameters that determine the accuracy of the result; `None` for a closed form.
    fn numerics(&self) -> Option<Numerics> {
        None
    }

    /// Returns the same impact with other numerical parameters, and without histories that the contact does not need.
    fn with(&self, numerics: Numerics) -> Box<dyn Problem>;
}

/// Numerical parameters of an impact.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Numerics {
    /// Number of modes of the struck body; `None` if it has no modes or the tolerance determines their number.
    pub modes: Option<usize>,
    /// Largest defect of Hertz's law between the nodes of a step, relative to the largest force; for a beam, the tolerance of its results.
    pub tolerance: f64,
}

/// Adds the outcome, the largest residual of the energy ledger, and the number of steps.
fn account(solution: &mut Solution, ledger: &Table, history: &History) {
    if history.interrupted {
        solution.outcome = Solution::INTERRUPTED;
        let time = format(history.end, Dimension::Time, units::System::Si);
        solution
            .warnings
            .push(std::format!("interrupted {time} after the first contact: results for the whole impact are missing"));
    }
    let residual = ledger.own("residual").iter().fold(0.0, |most: f64, r| most.max(r.abs()));
    let long_name = "largest residual of the energy ledger, relative to the energy at the start";
    solution.figures.push(Figure::new("energy_residual", Dimension::None, long_name, residual));
    solution.figures.push(Figure::count("steps", "time steps", history.steps));
    solution.figures.push(Figure::count("contact_steps", "time steps in contact", history.contact_steps));
    solution.lines.push(Line::new("energy", "largest residual {}", &[(residual, Dimension::None)]));
}
