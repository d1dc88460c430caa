//! `[left]` and `[right]`.

use schemars::JsonSchema;
use serde::Deserialize;
use toml::Spanned;

use super::MaterialChoice;
use crate::input::Number;
use crate::units::Quantity;

/// Boundary condition of an end. A driven end needs exactly one of `value`, `history` and `csv`.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct RawEnd {
    /// Type of end. Required.
    #[schemars(with = "EndKind")]
    pub kind: Spanned<EndKind>,
    /// Velocity (m/s, positive in +x) or stress (Pa, tension positive) from t = 0 on; in torsion an angular velocity
    /// (rad/s), a torque (N m) or a shear stress (Pa).
    #[schemars(with = "Option<Quantity>")]
    pub value: Option<Number>,
    /// Rows [time, velocity or stress]; linear between rows; a repeated time is a jump; the last value is held.
    /// Times in s, >= 0, never decreasing.
    #[schemars(with = "Option<Vec<[Quantity; 2]>>")]
    pub history: Option<Spanned<Vec<Spanned<Vec<Number>>>>>,
    /// The same rows from a file with two columns, time and value; its path is relative to the scene file. A first
    /// line without numbers names the columns and, in brackets, their units: `time [us],velocity [ft/s]`.
    #[schemars(with = "Option<String>")]
    pub csv: Option<Spanned<String>>,
    /// For a velocity end: the time from which it is free, s, > 0. Default: never.
    #[schemars(with = "Option<Quantity>")]
    pub release: Option<Number>,
    /// For a wall: its distance from the end at the start, m, >= 0. Default: 0.
    #[schemars(with = "Option<Quantity>")]
    pub gap: Option<Number>,
    /// For a striker or a ball: its mass, kg, > 0; the bar needs an area. Required for a striker; a ball can state its
    /// density or material instead.
    #[schemars(with = "Option<Quantity>")]
    pub mass: Option<Number>,
    /// For a striker or a ball: its velocity at the start, m/s (of a striker in torsion rad/s), positive in +x. Required there.
    #[schemars(with = "Option<Quantity>")]
    pub velocity: Option<Number>,
    /// For a ball: its radius, m, > 0; or give `diameter`.
    #[schemars(with = "Option<Quantity>")]
    pub radius: Option<Number>,
    /// For a ball: its diameter, m, > 0; in place of `radius`.
    #[schemars(with = "Option<Quantity>")]
    pub diameter: Option<Number>,
    /// For a ball: its density, kg/m^3, > 0; in place of `mass`. Default: its material's.
    #[schemars(with = "Option<Quantity>")]
    pub density: Option<Number>,
    /// For a ball: its material, for density, modulus and Poisson's ratio. The ball stays elastic.
    #[schemars(with = "Option<MaterialChoice>")]
    pub material: Option<Spanned<MaterialChoice>>,
    /// For a ball: its elastic modulus, Pa, > 0. Default: its material's.
    #[schemars(with = "Option<Quantity>")]
    pub modulus: Option<Number>,
    /// For a ball: its Poisson's ratio, 0 to 0.5. Default: its material's.
    #[schemars(with = "Option<Quantity>")]
    pub poisson: Option<Number>,
    /// For a ball: rigid, in place of `modulus` and `poisson`. Default: false.
    #[schemars(with = "Option<bool>")]
    pub rigid: Option<Spanned<bool>>,
    /// For a ball: Poisson's ratio of the bar, 0 to 0.5. Default: that of the bar's material.
    #[serde(rename = "bar-poisson")]
    #[schemars(with = "Option<Quantity>")]
    pub bar_poisson: Option<Number>,
    /// In torsion, for a ball: the arm of the rigid lever that it strikes, m, > 0; the torque is force times arm. Required there.
    #[schemars(with = "Option<Quantity>")]
    pub arm: Option<Number>,
    /// In torsion, for a striker: its moment of inertia, kg m^2, > 0. Required there, in place of `mass`.
    #[schemars(with = "Option<Quantity>")]
    pub inertia: Option<Number>,
    /// For a spring: its stiffness, N/m (in torsion N m/rad), > 0. Required there; the bar needs an area.
    #[schemars(with = "Option<Quantity>")]
    pub stiffness: Option<Number>,
    /// For a dashpot: its coefficient c, N s/m (in torsion N m s/rad), >= 0. Required there; the bar needs an area. c = rho c0 A lets
    /// elastic waves leave without reflection.
    #[schemars(with = "Option<Quantity>")]
    pub coefficient: Option<Number>,
}

/// The kinds of ends.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum EndKind {
    /// Prescribed velocity.
    Velocity,
    /// Prescribed stress.
    Stress,
    /// In torsion: prescribed torque.
    Torque,
    /// No stress.
    Free,
    /// No motion.
    Fixed,
    /// Elastic waves leave without reflection.
    Absorbing,
    /// A linear dashpot to the ground.
    Dashpot,
    /// A rigid wall that pushes but does not pull.
    Wall,
    /// A rigid mass that touches the end at the start, pushes, and flies on where it would have to pull.
    Striker,
    /// An elastic ball that touches the end at the start; Hertz's contact, without a pull.
    Ball,
    /// A linear spring to the ground.
    Spring,
}
