//! Studies made of curves and runs.

pub mod compare;
pub mod confirm;
pub mod cost;
pub mod critical;
pub mod hard_cases;
pub mod plan;
pub mod sweep;
