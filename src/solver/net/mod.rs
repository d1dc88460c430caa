//! The characteristic net: the method of characteristics for rate-dependent bars.
//!
//! Where plastic strain takes time, all characteristics are straight: `d(sigma -+ rho c0 v) = -q dt` along
//! `dx = +-c0 dt`, and plastic strain grows along `dx = 0`, with q = E times the plastic strain rate
//! ([`crate::law::rate`]). The net has a node in the middle of every cell at whole steps and one on every cell border,
//! ends and joints included, at half steps, so that both families run from node to node at Courant number 1 exactly:
//!
//! ```text
//!   t + dt      o     o     o          o  cells
//!              / \   / \   / \         |  on a border: f comes from the left cell, g from the right one
//!   t + dt/2  o   o o   o o   o
//!              \ /   \ /   \ /
//!   t           o     o     o
//! ```
//!
//! What travels are f = sigma - rho c0 v (to the right) and g = sigma + rho c0 v (to the left). A node meets them every dt
//! and lets its plastic strain grow over that dt, a part of it before the moment at which it is read: rates of flow at both ends of
//! all three characteristics, so second order. Where the flow is smooth that part is half; elsewhere it is such that stiff
//! materials neither limit the step nor ring: for k dt >> 1 the stress ends on the static curve (`law/rate/node.rs`). Front widths
//! below dx are then those of the net, not of the material.
//!
//! A bar that is strained steadily has the overstress of its strain rate in steps of any length. Limits: where the flow begins,
//! ends, or has an extremum along the bar, the part is not half, and a step that strains by more than the overstress over which the
//! rate changes by a factor e (C f/E by Johnson and Cook's law) is of first order. What the net dissipates there is accounted for
//! as `numerical`.
//!
//! A jump that starts at an end or a joint at a whole step runs on the lines between the nodes: it stays within one cell,
//! whatever it meets, and no node ever sits on it.
//!
//! f and g of a node are what it radiates, so that the sum of its momentum and energy is known exactly: the stress drop of
//! a node takes away just the plastic work, and the balance of the whole bar holds to rounding.

mod end;
mod joint;
mod lattice;
mod part;
mod read;
mod snapshot;
mod stepping;

pub use lattice::grid;
pub use stepping::Net;
