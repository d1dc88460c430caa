//! Pictures and pages from result files and studies.

pub mod compare;
pub mod plot;
