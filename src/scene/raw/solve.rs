//! `[solve]`.

use schemars::JsonSchema;
use serde::Deserialize;
use toml::Spanned;

use crate::input::Number;
use crate::units::Quantity;

/// Numerical method and end time.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct RawSolve {
    /// End time, s, > 0. Required.
    #[schemars(with = "Quantity")]
    pub until: Option<Number>,
    /// Method. Default: "fd"; "moc" where the effects include `rate`, no rupture and no heat.
    #[schemars(with = "Option<RawMethod>")]
    pub method: Option<Spanned<RawMethod>>,
    /// In place of a method: the largest error allowed, 0 < tolerance <= 0.5: of stress over the bar and time, at the ends
    /// and gauges, of the residual plastic strain and of the peak force, each relative. The cheapest method and resolution that meet it
    /// are chosen.
    #[schemars(with = "Option<f64>")]
    pub tolerance: Option<Number>,
    /// Scheme of the method "fd". Default: "leapfrog".
    #[schemars(with = "Option<RawScheme>")]
    pub scheme: Option<Spanned<RawScheme>>,
    /// For the method "fd", and for "moc" with the effect `rate`: cells over the whole bar, a whole number, 2 to
    /// 10000000. Default: 1000.
    #[schemars(with = "Option<u64>")]
    pub cells: Option<Number>,
    /// For the method "fd": Courant number of the fastest wave, 0 < cfl <= 1. Default: 1.
    #[schemars(with = "Option<f64>")]
    pub cfl: Option<Number>,
    /// Relative change of the stress above which the audit reports a neglected effect and `effects = "auto"` includes it; 0 <
    /// audit-tolerance < 1. Default: 0.01.
    #[serde(rename = "audit-tolerance")]
    #[schemars(with = "Option<f64>")]
    pub audit_tolerance: Option<Number>,
    /// For the method "moc": smallest stress jump that is tracked as a front of its own, relative to the largest stress that the scene's
    /// data can reach, 0 <= front-tolerance < 1; 0 tracks all waves. Default: 0.001.
    #[serde(rename = "front-tolerance")]
    #[schemars(with = "Option<f64>")]
    pub front_tolerance: Option<Number>,
    /// For the method "moc": largest number of front interactions, a whole number, 1 to 1000000000000. Default:
    /// 10000000.
    #[serde(rename = "event-budget")]
    #[schemars(with = "Option<u64>")]
    pub event_budget: Option<Number>,
}

/// The methods.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum RawMethod {
    /// Finite differences.
    Fd,
    /// Method of characteristics: fronts are tracked.
    Moc,
}

/// The schemes of the method "fd".
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum RawScheme {
    /// Staggered in space and time.
    Leapfrog,
    /// Conservative (Godunov with MUSCL slopes): exact Riemann problems at the faces between cells.
    Muscl,
}
