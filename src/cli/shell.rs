//! `barwave completions`, `man` and `schema`: what other tools read about this one.

use crate::error::Result;

/// Options of `barwave completions`.
#[derive(Debug, clap::Args)]
pub(crate) struct CompletionsArgs {}

/// Options of `barwave man`.
#[derive(Debug, clap::Args)]
pub(crate) struct ManArgs {}

/// Options of `barwave schema`.
#[derive(Debug, clap::Args)]
pub(crate) struct SchemaArgs {}

pub(crate) fn completions(_args: &CompletionsArgs) -> Result<()> {
    todo!()
}

pub(crate) fn man(_args: &ManArgs) -> Result<()> {
    todo!()
}

pub(crate) fn schema(_args: &SchemaArgs) -> Result<()> {
    todo!()
}
