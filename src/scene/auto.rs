//! `effects = "auto"`: the selected effects.

use serde::Serialize;

use crate::record::AutoChoice;

/// What was chosen so far.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct Auto {
    /// In the order in which it was chosen.
    pub choices: Vec<AutoChoice>,
}
