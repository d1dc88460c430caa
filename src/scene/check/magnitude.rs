//! Checks of values that are possible individually but not together.

use super::Checker;
use crate::bar::{Bar, EndCondition, Segment};
use crate::error::Result;

impl Checker<'_> {
    /// Checks that no end is pushed into the bar at or above the elastic wave speed. A front of speed c leaves the strain -v/c, which must be above
    /// -1.
    pub(super) fn not_crushed_at_once(&self, bar: &Bar, ends: [&EndCondition; 2]) -> Result<()> {
        let last = bar.segments.len() - 1;
        for (key, side, segment, inward) in [("left", 0, 0, 1.0), ("right", 1, last, -1.0)] {
            let (end, segment): (&EndCondition, &Segment) = (ends[side], &bar.segments[segment]);
            let (velocity, of) = match end {
                EndCondition::Velocity { history, .. } => (history.at(0.0), "value"),
                EndCondition::Striker { velocity, .. } => (*velocity, "velocity"),
                EndCondition::Fixed | EndCondition::Wall { gap: 0.0 } => (0.0, "kind"),
                _ => continue,
            };
            let (pushed, c0) = (inward * (velocity - segment.end_velocities()[side]), segment.material.c0());
            if pushed < c0 {
                continue;
            }
            let given = format!("{key}.{of}");
            let span = self.document.span_of(&given).or_else(|| self.document.span_of(key)).unwrap_or(0..0);
            let message = format!(
                "the {key} end is pushed into the bar at {pushed:.1} m/s, at or above its elastic wave speed ({c0:.1} m/s)"
            );
            let error = self.error(span, &given, message).allowed(format!("less than {c0:.1} m/s"));
            let help = "the end would be compressed beyond zero length; check the velocity, the modulus and the density with \
                        their units";
            return Err(error.help(help).into());
        }
        Ok(())
    }
}
