//! The characteristic net: the method of characteristics for rate-dependent bars.
//!
//! In a rate-dependent bar all characteristics are straight: `d(sigma -+ rho c0 v) = -q dt` along `dx = +-c0 dt`, and plastic strain grows along
//! `dx = 0`, where q is E times the plastic strain rate ([`crate::law::rate`]). The net has a node in the middle of every cell at whole steps and a
//! node on every cell border, including ends and joints, at half steps. Both families of characteristics thus run from node to node at Courant
//! number 1 exactly:
//!
//! ```text
//!   t + dt      o     o     o          o  cells
//!              / \   / \   / \         |  on a border: f comes from the left cell, g from the right one
//!   t + dt/2  o   o o   o o   o
//!              \ /   \ /   \ /
//!   t           o     o     o
//! ```
//!
//! The travelling quantities are f = sigma - rho c0 v (to the right) and g = sigma + rho c0 v (to the left). They meet at a node every dt. The
//! plastic strain of the node grows over that dt, partly before the time at which the node is read: flow rates at both ends of all three
//! characteristics make this second-order accurate. In smooth flow half of the strain grows before the reading; elsewhere the fraction is chosen such
//! that stiff materials neither limit the step nor ring: for k dt >> 1 the stress ends on the static curve (`law/rate/node.rs`). Front widths below
//! dx are then those of the net, not of the material.
//!
//! A bar that is strained steadily has the overstress of its strain rate for any step length. Limits: where flow begins, ends, or has an extremum
//! along the bar, the fraction is not half, and a step whose strain exceeds the overstress over which the rate changes by a factor e (C f/E in the
//! Johnson-Cook law) is first-order accurate. The dissipation of the net there counts as `numerical`.
//!
//! A jump that starts at an end or joint at a whole step runs along the lines between the nodes: it stays within one cell, whatever it meets, and
//! never lies on a node.
//!
//! f and g leaving a node are the waves that it radiates, so that momentum and energy are known exactly: the stress drop of a node removes exactly
//! the plastic work, and the energy of the whole bar balances to rounding.

mod end;
mod joint;
mod lattice;
mod part;
mod read;
mod snapshot;
mod stepping;

pub use lattice::grid;
pub use stepping::Net;
