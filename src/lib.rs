//! barwave: one-dimensional elastic-plastic waves in bars.
//!
//! The library is layered: a module imports only from those above it in this list.
//! Stress is engineering (nominal) stress, tension positive; x is the Lagrangian coordinate from the left
//! end; velocity is positive in +x; everything inside is SI.

pub mod error;

pub mod units;

mod root;

pub mod text_file;

pub mod destination;

pub mod input;

pub mod columns;

pub mod material;

pub mod snapshot;

pub mod law;

pub mod wave;

pub mod test_record;

pub mod bar;

pub mod solver;

pub mod impact;

pub mod record;

pub mod simulate;

pub mod scene;

pub mod accuracy;

pub mod assemble;
pub mod run;

pub mod study;

pub mod report;

pub mod cli;
