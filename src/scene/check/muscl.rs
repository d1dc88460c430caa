//! What the scheme muscl cannot do.

use super::super::Method;
use super::super::raw::{RawEffects, RawScheme, RawSolve, RawUnloading};
use super::Checker;
use crate::bar::{Bar, EndCondition};
use crate::error::Result;
use crate::law::Table;
use crate::material::Sense;
use crate::typed::Placed;

/// Beside leapfrog.
const NET: &str = ", or method = \"moc\" (a characteristic net)";
const FRONTS: &str = ", or method = \"moc\" (front tracking)";

impl Checker<'_> {
    /// Refuses what the scheme muscl does not simulate, at the scheme's name, with the schemes that do. `auto`: effects are
    /// to be chosen by the run.
    pub(super) fn muscl_can(
        &self,
        raw: &RawSolve,
        method: &Method,
        effects: &RawEffects,
        auto: bool,
        bar: &Bar,
        ends: [&EndCondition; 2],
    ) -> Result<()> {
        let Method::Muscl { .. } = method else { return Ok(()) };
        let tapered = bar.segments.iter().any(|segment| segment.taper.is_some());
        let ball = ends.into_iter().any(|end| matches!(end, EndCondition::Ball { .. }));
        let moves = effects.unloading.as_ref().is_some_and(|u| !matches!(u.get_ref(), RawUnloading::Isotropic));
        let stiffens = bar.segments.iter().any(|segment| {
            let curve = |sense| Table::new(segment.material.branch(sense), segment.material.modulus);
            !curve(Sense::Tension).is_concave() || !curve(Sense::Compression).is_concave()
        });
        let asked = [
            (auto, "effects = \"auto\"", ""),
            (effects.rate.is_some(), "the effect `rate`", NET),
            (effects.heat.is_some() && moves, "the effect `heat` with kinematic hardening", ""),
            (effects.rupture.is_some(), "the effect `rupture`", FRONTS),
            (effects.along().is_some(), "the effects `damping` and `lateral-inertia`", ""),
            (moves && stiffens, "kinematic hardening along a curve that stiffens or drops", FRONTS),
            (tapered, "tapered segments", FRONTS),
            (ball, "a ball at an end", FRONTS),
        ];
        let Some((_, what, instead)) = asked.into_iter().find(|row| row.0) else { return Ok(()) };
        let span = raw.scheme.as_ref().map_or(0..0, Placed::span);
        let message = format!("scheme = \"muscl\" does not simulate {what}");
        let help = format!("use scheme = \"leapfrog\", which does{instead}");
        Err(self.error(span, "solve.scheme", message).allowed("\"leapfrog\"").help(help).into())
    }
}

impl RawSolve {
    /// The scheme muscl is asked for.
    pub(super) fn is_muscl(&self) -> bool {
        self.scheme.as_ref().is_some_and(|scheme| *scheme.get_ref() == RawScheme::Muscl)
    }
}
