//! Exact solutions built from a curve alone.

pub mod similarity;
