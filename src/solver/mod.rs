//! Solvers. They know laws, bars and ends; never an effect by name, never a file format.

mod energies;
pub mod fd;
pub mod moc;
pub mod muscl;
pub mod net;

pub use energies::Energies;
