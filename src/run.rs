//! The time loop.
