//! Pictures and pages from result files and studies.

pub mod plot;
