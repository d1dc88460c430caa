//! `barwave merge`: joins the shards of a sweep.

use std::path::PathBuf;

use super::output;
use super::result_file::is_result;
use crate::destination;
use crate::error::{InputError, Result};
use crate::study::sweep::{check_tables, merge};

/// Options of `barwave merge`.
#[derive(Debug, clap::Args)]
#[command(
    after_help = "Examples:\n  barwave merge speeds -o speeds.h5\n  barwave merge node1/speeds node2/speeds -o speeds.h5"
)]
pub(crate) struct Args {
    /// Folders of sweeps, or folders with `shard-I-of-N` folders inside.
    #[arg(required = true, value_name = "DIR")]
    folders: Vec<PathBuf>,
    /// HDF5 file to write; the table is written beside it, as .csv.
    #[arg(short, long, value_name = "OUT.h5")]
    output: PathBuf,
    /// Write the table even if cases are missing.
    #[arg(long)]
    partial: bool,
    /// Replace files that are not tables of sweeps.
    #[arg(long)]
    force: bool,
}

pub(crate) fn run(args: &Args) -> Result<()> {
    if !is_result(&args.output) {
        return Err(InputError::new(format!("`{}` is not the name of an HDF5 file", args.output.display()))
            .key("-o")
            .allowed("a file name ending in .h5 or .hdf5")
            .help("the table is written beside it, as .csv: such as -o speeds.h5")
            .into());
    }
    let output = destination::resolve(&args.output)?;
    let table = output.with_extension("csv");
    check_tables(&table, &output, args.force).map_err(|error| {
        let help = format!("{}; --force replaces it", error.help);
        error.key("-o").help(help)
    })?;
    let rows = merge(&args.folders, &output, args.partial)?;
    let said = format!("{rows} rows in {} and {}\n", output.display(), table.display());
    output::written(&[&output, &table], &said)
}
