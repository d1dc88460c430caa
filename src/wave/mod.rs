//! Exact solutions built from a curve alone.

mod chain;
pub mod similarity;
