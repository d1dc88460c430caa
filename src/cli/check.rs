//! `barwave check`.

use crate::error::Result;

/// Options of `barwave check`.
#[derive(Debug, clap::Args)]
pub(crate) struct Args {}

pub(crate) fn run(_args: &Args) -> Result<()> {
    todo!()
}
