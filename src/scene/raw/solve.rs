//! Keys of `[solve]`.

use schemars::JsonSchema;
use serde::Deserialize;

use crate::typed::{Above, Below, Between, Count, Of, Or, Placed, Plain, Positive};
use crate::units::measures::Time;

/// Largest number of cells of a run. With the frames that wait to be written they need about a gigabyte, and a wave needs as many steps to cross
/// them.
pub(in crate::scene) const MOST_CELLS: usize = 10_000_000;
/// Largest number of events of a run: at about 140 bytes each, 56 GB of memory.
pub const MOST_EVENTS: usize = 400_000_000;

/// Numerical method and end time.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub struct RawSolve {
    /// End time.
    #[schemars(required)]
    pub until: Option<Of<Time, Positive>>,
    /// Method. Default: "fd"; with `rate` but neither rupture nor heat "moc".
    pub method: Option<Placed<RawMethod>>,
    /// Instead of a method: largest relative error of the stress over the bar and time, at the ends and gauges, of the residual plastic strain and of the peak force. The cheapest method and resolution are selected.
    pub tolerance: Option<Of<Plain, Above<0, 1, 2>>>,
    /// Scheme of the method "fd". Default: "leapfrog".
    pub scheme: Option<Placed<RawScheme>>,
    /// For the method "fd", and for "moc" with the effect `rate`: cells over the whole bar.
    #[schemars(default)]
    pub cells: Or<Count<2, MOST_CELLS>, 1000>,
    /// For the method "fd": Courant number of the fastest wave.
    #[schemars(default)]
    pub cfl: Or<Of<Plain, Above<0, 1>>, 1>,
    /// Relative change of the stress above which the audit reports a neglected effect and `effects = "auto"` includes it. Default: 0.01,
    /// or the `tolerance`.
    pub audit_tolerance: Option<Of<Plain, Between<0, 1>>>,
    /// For the method "moc": height of the steps of which smooth waves and loads consist, relative to the largest stress possible in the scene: waves that are closer together are merged. 0 tracks all waves.
    #[schemars(default)]
    pub front_tolerance: Or<Of<Plain, Below<0, 1>>, 1, 1000>,
    /// For the method "moc": largest number of front interactions.
    #[serde(rename = "max-events", alias = "event-budget")]
    #[schemars(default)]
    pub event_budget: Or<Count<1, MOST_EVENTS>, 10_000_000>,
}

/// Methods of the scene language.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum RawMethod {
    /// Finite differences.
    Fd,
    /// Method of characteristics: fronts are tracked.
    Moc,
}

/// Schemes of the method "fd".
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum RawScheme {
    /// Staggered in space and time.
    Leapfrog,
    /// Conservative (Godunov with MUSCL slopes): exact Riemann problems at the faces between cells.
    Muscl,
}
