//! Finite differences on a staggered grid.

mod block;
mod contact;
mod device;
mod edge;
mod grid;
mod implicit;
mod initial;
mod leapfrog;
mod reader;
mod readings;
mod rest;
mod ripple;
mod rupture;
mod sample;
mod snapshot;
mod start;
mod stretch;
mod sweep;
mod taper;

pub use contact::ContactState;
pub use device::Device;
pub use grid::{Grid, SegmentGrid};
pub use implicit::Along;
pub use leapfrog::{Leapfrog, Log, LoggedCell, SegmentLaw};
pub use reader::Reader;
pub use readings::Quantity;
pub use rupture::{CELLS_TO_BREAK, Unresolved};
pub use sample::{Sampling, between};
pub use taper::BYTES_PER_CELL as TAPER_BYTES_PER_CELL;
