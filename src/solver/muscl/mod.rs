//! Conservative finite differences: velocity, stress and history in cells, forces and velocities at the faces between
//! them from the exact Riemann problem (MUSCL-Hancock; van Leer 1979, Toro, Riemann Solvers, chapter 14).
//!
//! A step of a cell with faces L and R:
//!
//! ```text
//! v'   = v + dt/(rho dx) (sigma_R - sigma_L)
//! E de = E dt/dx (v_R - v_L)            sigma', history' = law(sigma, history, E de)
//! ```
//!
//! The states on both sides of a face are those of their cells, carried to the face along limited slopes and half a step
//! on in time by the cell's own law. Slopes are those of stress and velocity, which are continuous where histories
//! differ; where the curve is followed both ways, strain stands for stress. A cell that flows lies on its curve at its
//! faces, too; else its history is the same throughout. What it gains
//! along the curve in the half step is only foreseen, and may be taken back along the curve. Cells inside shocks of a
//! stiffening curve, and near those that reverse the strain where the curve is followed both ways, have no slopes, cells
//! inside fronts along one of its lines steeper ones. Where the curve has a level
//! stretch, stresses at faces stay between those of the cells, and a cell to which slopes gave energy has none until that is
//! taken back. The flux is the Riemann
//! problem's answer, with the hull of stiffening curves: second order in smooth flow, no new extrema at fronts, and the
//! right shocks.
//!
//! Momentum is exact. So is energy: what a cell's faces bring in and its kinetic and internal energy do not take up is
//! the scheme's own dissipation, `dt/dx [(sigma_R - s)(v_R - w) - (sigma_L - s)(v_L - w)]` with s and w the means of the
//! cell's stress and velocity before and after the step. It is booked as `numerical`. In smooth flow
//! on coarse grids it may be slightly negative: slopes leave errors of second order, of either sign.
//!
//! Stable for Courant numbers up to 1, where elastic waves are exact.

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
