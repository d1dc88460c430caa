//! Exact wave solutions from the loading curve alone, and the Riemann problem between states with a history.

mod hull;
pub mod riemann;
pub mod similarity;
