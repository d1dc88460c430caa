//! Sweeps: many runs of one scene, with keys that vary along axes. Every case gives one row of results.

mod axis;
mod file;
mod journal;
mod merge;
mod metrics;
mod names;
mod plan;
mod run;
mod shard;
mod table;

pub use axis::{Axis, Level};
pub(crate) use file::RawFile;
pub use file::Sweep;
pub use merge::merge;
pub use metrics::{FullRow, Row, Status};
pub use plan::{Combine, Plan};
pub use run::{Finished, case_file, rows, run};
pub use shard::Shard;
pub use table::check_tables;
