//! Studies made of curves and runs.
