//! `barwave compare`.

use crate::error::Result;

/// Options of `barwave compare`.
#[derive(Debug, clap::Args)]
pub(crate) struct Args {}

pub(crate) fn run(_args: &Args) -> Result<()> {
    todo!()
}
