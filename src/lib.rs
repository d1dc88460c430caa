//! barwave: one-dimensional elastic-plastic waves in bars.
//!
//! A scene is read from a file ([`scene::Scene::read`]) or built in a program, and simulated with output to a result file ([`run::run`]) or to
//! arrays ([`run::solution`], or [`run::solve`] to see its progress and to stop it):
//!
//! ```
//! use barwave::{record::Field, run, scene::Scene};
//!
//! let scene = Scene::builder()
//!     .set("bar.length", "1 m")
//!     .set("bar.material", "copper-annealed")
//!     .set("left.kind", "velocity")
//!     .set("left.value", "-60 m/s")
//!     .set("right.kind", "free")
//!     .set("solve.until", "200 us")
//!     .build()?;
//! let solution = run::solution(&scene)?;
//! let stress = solution.last(Field::Stress).expect("a recorded field");
//! println!("{} samples, at the struck end {:.1} MPa", stress.len(), stress[0] / 1e6);
//! # assert!(stress[0] > 50e6);
//! # Ok::<(), barwave::error::Error>(())
//! ```
//!
//! # Materials and segments
//!
//! A key has the same values as in a scene file, given as Rust values ([`scene::IntoValue`]): a number in SI, a text with its unit, a list, rows as
//! pairs, an array of `ndarray`, or a material. Items of a list are numbered:
//!
//! ```
//! use barwave::material::{Beyond, Curve, Material};
//! use barwave::{run, scene::Scene};
//!
//! let (strain, stress) = ([0.0015, 0.05, 0.2], [300e6, 380e6, 450e6]);
//! let rows: Vec<(f64, f64)> = strain.into_iter().zip(stress).collect();
//! let steel = Material::from_curve("my steel", 7850.0, Curve::new(&rows, Beyond::Extend)?)?;
//! let scene = Scene::builder()
//!     .set("bar.segment.0.length", 0.5)
//!     .set("bar.segment.0.area", 1e-4)
//!     .set("bar.segment.0.material", &steel)
//!     .set("bar.segment.1.length", 0.5)
//!     .set("bar.segment.1.area", 2e-4)
//!     .set("bar.segment.1.material", &steel)
//!     .set("left.kind", "velocity")
//!     .set("left.value", -20.0)
//!     .set("right.kind", "free")
//!     .set("solve.until", 1e-4)
//!     .build()?;
//! // The same scene at other velocities: changed keys are checked again.
//! for velocity in [-10.0, -40.0] {
//!     let solution = run::solution(&scene.with_value("left.value", velocity)?)?;
//!     println!("{velocity} m/s: {:.4}", solution.summary.left.strain);
//! }
//! # Ok::<(), barwave::error::Error>(())
//! ```
//!
//! # Result files
//!
//! ```
//! use barwave::record::{Field, store::ResultFile};
//! use barwave::{run, scene::Scene};
//! use std::ops::ControlFlow;
//!
//! # let folder = tempfile::tempdir().expect("a folder");
//! # let path = folder.path().join("out.h5");
//! # let scene = Scene::builder().set("bar.length", 1.0).set("bar.material", "copper-annealed").set("left.kind", "velocity")
//! #     .set("left.value", -30.0).set("right.kind", "free").set("solve.until", 1e-4).set("record.gauges.middle", 0.5).build()?;
//! run::run(&scene, Some(&path), &mut |_| ControlFlow::Continue(()))?;
//! let file = ResultFile::open(&path)?;
//! let (x, time) = (file.x()?, file.time()?);
//! let stress = file.field(Field::Stress, 0..time.len())?;
//! assert_eq!(stress.dim(), (time.len(), x.len()));
//! let middle = &file.gauges()?[0];
//! println!("{}: {} rows at {} m", middle.name, middle.trace.time.len(), middle.x);
//! # Ok::<(), barwave::error::Error>(())
//! ```
//!
//! # Other impacts
//!
//! [`scene::Problem`] reads scenes of any kind, from a file or from text; [`run::run_impact`] solves those that are not waves in a bar. A program
//! can also construct an impact from the types of [`impact`].
//!
//! ```
//! use barwave::{run, scene::Problem};
//! use std::{ops::ControlFlow, path::Path};
//!
//! let text = "[spheres]\nradius = '10 mm'\nmaterial = 'mild-steel'\npoisson = 0.3\n\
//!             [striker]\nradius = '10 mm'\nmaterial = 'mild-steel'\npoisson = 0.3\nvelocity = '1 m/s'\n";
//! if let Problem::Impact(scene) = Problem::parse("spheres.toml", text, Path::new(""), &[])? {
//!     let summary = run::run_impact(&scene, None, &mut |_| ControlFlow::Continue(()))?;
//!     let force = summary.solution.figure("peak_force").expect("a figure");
//!     println!("peak force {force:.0} N");
//!     # assert!(force > 900.0);
//! }
//! # Ok::<(), barwave::error::Error>(())
//! ```
//!
//! # Building
//!
//! HDF5 is compiled from source, which needs a C compiler, and cmake 3.26 or newer on `PATH` or named by the variable `CMAKE`. Build programs with
//! `--release`; debug builds are slow. The crates that provide the values of keys and the arrays of a solution are re-exported: [`toml`] and
//! [`ndarray`], as `barwave::toml` and `barwave::ndarray`.
//!
//! # Layers
//!
//! Every file that is read or written is reported to the [`log`] facade at the level `Info`.
//!
//! The library is layered: a module imports only from those above it in this list. Stress is engineering (nominal) stress, tension positive; x is
//! the Lagrangian coordinate from the left end; velocity is positive in +x; all values are in SI units.

pub use ndarray;
pub use toml;

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
