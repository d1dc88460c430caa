//! `[record]`.

use std::collections::BTreeMap;

use schemars::JsonSchema;
use serde::Deserialize;
use toml::Spanned;

use crate::input::Number;
use crate::units::Quantity;

/// What is recorded. At most one of `frames`, `every` and `times`.
#[derive(Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct RawRecord {
    /// Frames of the fields, evenly spaced from t = 0 to the end, both included; 1 is the end alone. A whole
    /// number, 1 to 10000000. Default: 200.
    #[schemars(with = "Option<u64>")]
    pub frames: Option<Number>,
    /// Time between frames, s, > 0; the first is at t = 0, the end is included.
    #[schemars(with = "Option<Quantity>")]
    pub every: Option<Number>,
    /// Times of the frames, s, increasing, from 0 to `solve.until`.
    #[schemars(with = "Option<Vec<Quantity>>")]
    pub times: Option<Spanned<Vec<Number>>>,
    /// Samples of the fields over x, at the cell centres of an even grid; a whole number, 1 to 10000000.
    /// Default: the solver's own cells; 1000 where fronts are tracked, which needs none.
    #[schemars(with = "Option<u64>")]
    pub cells: Option<Number>,
    /// For the method "moc": record the straight pieces of all fronts. Default: true.
    #[schemars(with = "Option<bool>")]
    pub paths: Option<Spanned<bool>>,
    /// Fields: "stress", "strain", "velocity", "displacement"; with unloading also `"plastic_strain"` and
    /// `"accumulated_plastic_strain"`, with heat `"temperature"`. Default: stress, strain and velocity.
    #[schemars(with = "Option<Vec<String>>")]
    pub fields: Option<Vec<Spanned<String>>>,
    /// Full-rate histories: name = place, m from the left end, within the bar. Default: none.
    #[schemars(with = "BTreeMap<String, Quantity>")]
    #[serde(default)]
    pub gauges: BTreeMap<String, Number>,
    /// Numbers of the fields in the file. Default: "f64".
    pub precision: Option<RawPrecision>,
    /// Compression of the fields, and of the pieces of fronts, in the file. Default: "deflate".
    pub compression: Option<RawCompression>,
}

/// Size of the numbers in the file.
#[derive(Debug, Clone, Copy, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum RawPrecision {
    /// 8 bytes.
    F64,
    /// 4 bytes.
    F32,
}

/// Compression of the fields in the file.
#[derive(Debug, Clone, Copy, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum RawCompression {
    /// Shuffle and deflate: small.
    Deflate,
    /// Shuffle and lzf: faster, larger.
    Lzf,
    /// None.
    None,
}
