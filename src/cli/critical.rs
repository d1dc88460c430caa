//! `barwave critical`.

use crate::error::Result;

/// Options of `barwave critical`.
#[derive(Debug, clap::Args)]
pub(crate) struct Args {}

pub(crate) fn run(_args: &Args) -> Result<()> {
    todo!()
}
