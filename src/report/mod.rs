//! Pictures and pages from result files.
