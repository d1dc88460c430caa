//! `barwave study`: classical experiments.

mod tension_impact;

use clap::Subcommand;

use crate::error::Result;

/// Options of `barwave study`.
#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:\n  barwave study tension-impact copper-annealed")]
pub(crate) struct Args {
    #[command(subcommand)]
    study: Study,
}

#[derive(Debug, Subcommand)]
enum Study {
    /// Elongation at fracture, energy absorbed and place of fracture against impact velocity.
    TensionImpact(tension_impact::Args),
}

pub(crate) fn run(args: &Args) -> Result<()> {
    match &args.study {
        Study::TensionImpact(args) => tension_impact::run(args),
    }
}
