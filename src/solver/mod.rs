//! Solvers. They depend on laws, bars and ends, not on named effects or file formats.

mod end_state;
mod energies;
pub mod fd;
pub mod moc;
pub mod muscl;
pub mod net;
mod starting_fan;
mod unloading;

pub use end_state::{EndSample, EndState};
pub use energies::Energies;
use starting_fan::{Resolution, StartingFan};
