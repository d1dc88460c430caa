//! Finite differences on a staggered grid.

mod block;
mod device;
mod grid;
mod leapfrog;
mod ripple;
mod sample;

pub use device::Device;
pub use grid::{Grid, SegmentGrid};
pub use leapfrog::{Energies, Leapfrog, Passed, Quantity, SegmentLaw};
pub use sample::Sampling;
