//! Raw keys of a scene file, read by serde. Every key is declared once: its type contains the dimension, range and default, from which reading,
//! messages, schema and reference are derived.

mod along;
mod bar;
mod body;
mod effects;
mod ends;
mod history_file;
mod record;
mod solve;

use schemars::JsonSchema;
use serde::Deserialize;

use crate::typed::{Later, Placed};

pub(super) use along::{Given, RawDistribution};
pub(super) use bar::{INITIAL, MaterialChoice, Notch, RawBar, RawInitial, RawJoint, RawPiece, RawSegment};
pub(super) use body::{BodyKeys, raw_body};
pub(super) use effects::{EffectsChoice, RateChoice, RawEffects, RawHardening, RawRupture};
pub(super) use ends::{Ball, BallOnLever, EndKind, RawEnd, RawHistory};
pub(super) use history_file::{Column, HistoryFile, RawHistoryRecord};
pub(super) use record::{Gauges, MOST_FRAMES, RawRecord};
pub use solve::MOST_EVENTS;
pub(super) use solve::{MOST_CELLS, RawMethod, RawScheme, RawSolve};

/// A scene: one bar, its two ends, how to solve it and what to record. Numbers are SI; a text is a number with
/// its unit, such as "10 in". x runs from the left end, velocities are positive in +x, tension is positive.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(title = "barwave scene")]
pub struct RawScene {
    /// Title, one line. Default: the file's name.
    pub title: Option<String>,
    /// The bar: uniform, or a list of segments. Required.
    #[schemars(with = "RawBar")]
    pub bar: Option<Placed<RawBar>>,
    /// Boundary condition at the left end (x = 0). Required.
    #[schemars(with = "RawEnd")]
    pub left: Option<Later<RawEnd>>,
    /// Boundary condition at the right end. Required.
    #[schemars(with = "RawEnd")]
    pub right: Option<Later<RawEnd>>,
    /// Optional effects, or "auto": selected by the program. Default: none.
    #[serde(default)]
    pub effects: EffectsChoice,
    /// Numerical method and end time. Required, for `until`.
    #[schemars(with = "RawSolve")]
    pub solve: Option<Placed<RawSolve>>,
    /// Output. Default: 200 frames of stress, strain and velocity.
    #[serde(default)]
    pub record: RawRecord,
}
