//! Conservative finite differences: velocity, stress and history in cells, and stresses and velocities at the faces between them from the exact
//! Riemann problem (MUSCL-Hancock; van Leer 1979; Toro, Riemann Solvers, chapter 14).
//!
//! Step of a cell with the faces L and R:
//!
//! ```text
//! v'   = v + dt/(rho dx) (sigma_R - sigma_L)
//! E de = E dt/dx (v_R - v_L)            sigma', history' = law(sigma, history, E de)
//! ```
//!
//! The states on both sides of a face are extrapolated from their cells along limited slopes and advanced by half a step with the law of the cell.
//! Slopes are those of stress and velocity, which are continuous where histories differ; where the curve is followed both ways, strain replaces
//! stress. A cell that flows lies on its curve at its faces, too; otherwise its history is uniform. The stress that a cell gains along the curve in
//! the half step is only predicted, and may be taken back along the curve.
//!
//! Cells inside shocks of a stiffening curve, and near shocks that reverse the strain where the curve is followed both ways, have no slopes; cells
//! inside fronts along one line of the curve have steeper ones. Where the curve has a level stretch, stresses at faces stay between those of the
//! cells, and a cell that received energy from its slopes has none until that energy is dissipated. The flux is the solution of the Riemann problem,
//! with the hull of stiffening curves: second order in smooth flow, no new extrema at fronts, and the correct shocks.
//!
//! Momentum is conserved exactly. So is energy: the work at the faces of a cell that its kinetic and internal energy do not take up is the
//! dissipation of the scheme, `dt/dx [(sigma_R - s)(v_R - w) - (sigma_L - s)(v_L - w)]`, with s and w the means of the cell's stress and velocity
//! before and after the step. It counts as `numerical`. In smooth flow on coarse grids it may be slightly negative, because slopes leave second-order
//! errors of either sign.
//!
//! The scheme is stable for Courant numbers up to 1, at which elastic waves are exact.

mod block;
mod end;
mod face;
mod first_order;
mod front;
mod history;
mod joint;
mod kernel;
mod part;
mod readings;
mod slope;
mod snapshot;
mod stepping;

pub use part::Part;
pub use stepping::Muscl;
