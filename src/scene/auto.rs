//! `effects = "auto"`: the selected effects.

use serde::Serialize;

use crate::record::AutoChoice;

/// Selections made so far.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct Auto {
    /// Decisions on effects, in the order in which they were made.
    pub choices: Vec<AutoChoice>,
}
