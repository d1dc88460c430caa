//! Interactions of neighbouring fronts, ordered by time.

use serde::{Deserialize, Serialize};

/// Next interaction of two neighbours; obsolete once one of them is removed or they are no longer neighbours.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub(super) struct Interaction {
    pub time: f64,
    pub left: u32,
    pub right: u32,
    pub left_stamp: u64,
    pub right_stamp: u64,
}

impl Eq for Interaction {}

impl PartialOrd for Interaction {
    fn partial_cmp(&self, other: &Self) -> Option<std::cmp::Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for Interaction {
    fn cmp(&self, other: &Self) -> std::cmp::Ordering {
        self.time.total_cmp(&other.time).then(self.left_stamp.cmp(&other.left_stamp))
    }
}
