//! Studies of materials, scenes and results: critical velocities, comparisons, cost of accuracy, sweeps and inversion of measurements.

pub mod bracket;
pub mod compare;
pub mod compare_results;
pub mod cost;
pub mod critical;
pub mod hard_cases;
pub mod impact_cost;
pub mod invert;
mod moments;
pub mod plan;
mod random;
pub mod sensitivity;
pub mod sweep;
pub mod tension;
pub mod uncertainty;
