//! Many runs of one scene: keys of it vary along axes, and every case gives a row of figures.

mod axis;
mod file;
mod journal;
mod merge;
mod metrics;
mod plan;
mod run;
mod shard;
mod table;

pub use axis::{Axis, Level};
pub use file::Sweep;
pub use merge::merge;
pub use metrics::{Row, Status};
pub use plan::{Combine, Plan};
pub use run::{Finished, case_file, rows, run};
pub use shard::Shard;
