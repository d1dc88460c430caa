//! Exact solutions built from a curve alone, and the Riemann problem between states with a history.

mod chain;
pub mod riemann;
pub mod similarity;
