//! `barwave invert`: stress-strain curves from measurements.

mod arrivals;
mod hopkinson;
mod residual;
mod shared;

use clap::Subcommand;

use super::options;
use crate::error::Result;

/// Options of `barwave invert`.
#[derive(Debug, clap::Args)]
#[command(
    after_help = "Examples:\n  barwave invert arrivals --help\n  barwave invert hopkinson test.h5 -o steel-dynamic.toml"
)]
pub(crate) struct Args {
    #[command(subcommand)]
    command: Command,
}

#[derive(Debug, Subcommand)]
enum Command {
    /// The curve from arrival times of strain levels at gauges along a bar (simple-wave theory).
    Arrivals(arrivals::Args),
    /// The curve from the strain along a wire after an impact (von Kármán and Duwez).
    ResidualStrain(residual::Args),
    /// The specimen's stress, strain and strain rate from the gauges of a split-Hopkinson set.
    Hopkinson(hopkinson::Args),
}

pub(crate) fn run(args: &Args) -> Result<()> {
    match &args.command {
        Command::Arrivals(args) => arrivals::run(args).map_err(|error| options::name(error, arrivals::OPTIONS)),
        Command::ResidualStrain(args) => residual::run(args).map_err(|error| options::name(error, residual::OPTIONS)),
        Command::Hopkinson(args) => hopkinson::run(args).map_err(|error| options::name(error, hopkinson::OPTIONS)),
    }
}
