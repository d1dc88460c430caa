//! barwave: one-dimensional elastic-plastic waves in bars.
//!
//! A scene is read from a file ([`scene::Scene::read`]) or built in a program, and simulated with output to a result file ([`run::run`]) or to arrays ([`run::solve`]):
//!
//! ```
//! use barwave::{record::Field, run, scene::Scene};
//! use std::ops::ControlFlow;
//!
//! let scene = Scene::builder()
//!     .set("bar.length", "1 m")
//!     .set("bar.material", "copper-annealed")
//!     .set("left.kind", "velocity")
//!     .set("left.value", "-60 m/s")
//!     .set("right.kind", "free")
//!     .set("solve.until", "200 us")
//!     .build()?;
//! let solution = run::solve(&scene, &mut |_| ControlFlow::Continue(()))?;
//! let stress = solution.last(Field::Stress).expect("a recorded field");
//! println!("{} samples, at the struck end {:.1} MPa", stress.len(), stress[0] / 1e6);
//! # assert!(stress[0] > 50e6);
//! # Ok::<(), barwave::error::Error>(())
//! ```
//!
//! Every file that is read or written is reported to the [`log`] facade at the level `Info`.
//!
//! The library is layered: a module imports only from those above it in this list.
//! Stress is engineering (nominal) stress, tension positive; x is the Lagrangian coordinate from the left
//! end; velocity is positive in +x; all values are in SI units.

pub mod error;

pub mod units;

mod elementary;

mod root;

mod inputs;

pub mod text_file;

pub mod destination;

pub mod input;

pub mod typed;

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
