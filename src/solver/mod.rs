//! Solvers. They know laws, bars and ends; never an effect by name, never a file format.

pub mod fd;
pub mod moc;
pub mod muscl;
pub mod net;
