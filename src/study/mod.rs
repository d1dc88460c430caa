//! Studies made of curves and runs.

pub mod compare;
pub mod critical;
