//! Keys of `[record]`.

use std::collections::BTreeMap;

use schemars::JsonSchema;
use serde::Deserialize;

use super::solve::MOST_CELLS;
use crate::record::{Compression, Precision};
use crate::typed::{Count, NotNegative, Of, Or, Placed, Positive};
use crate::units::measures::{Length, Time};

/// Largest number of frames; a larger number is assumed to be a mistake.
pub(in crate::scene) const MOST_FRAMES: usize = 10_000_000;

/// Gauges: name and position from the left end.
pub type Gauges = BTreeMap<String, Of<Length>>;

/// Output. At most one of `frames`, `every` and `times`.
#[derive(Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct RawRecord {
    /// Frames of the fields, evenly spaced from t = 0 to the end, both included; 1: end time only.
    #[schemars(default)]
    pub frames: Or<Count<1, MOST_FRAMES>, 200>,
    /// Time between frames; the first is at t = 0, the end is included.
    pub every: Option<Of<Time, Positive>>,
    /// Times of the frames, increasing, from 0 to `solve.until`.
    pub times: Option<Placed<Vec<Of<Time, NotNegative>>>>,
    /// Samples of the fields over x, at the cell centres of a uniform grid. Default: the cells of the solver; 1000 for front tracking.
    pub cells: Option<Count<1, MOST_CELLS>>,
    /// For the method "moc": record the straight segments of all fronts. Default: true.
    pub paths: Option<Placed<bool>>,
    /// Fields: "stress", "strain", "velocity", "displacement"; with hardening also `"plastic_strain"` and
    /// `"accumulated_plastic_strain"`, with heat `"temperature"`. Default: stress, strain and velocity.
    pub fields: Option<Vec<Placed<String>>>,
    /// Full-rate histories: name = position from the left end, m, within the bar. Default: none.
    #[serde(default)]
    pub gauges: Gauges,
    /// Floating-point format of the fields in the file. Default: "f64".
    pub precision: Option<Precision>,
    /// Compression of the fields and front segments in the file. Default: "deflate".
    pub compression: Option<Compression>,
}
