//! The effect `heat`: thermal constants of the materials of the bar.

use std::sync::Arc;

use super::super::Heat;
use super::super::raw::RawEffects;
use super::Checker;
use crate::bar::Bar;
use crate::error::Result;
use crate::material::HeatingError;

impl Checker<'_> {
    /// Returns the effect, and replaces the materials of `bar` by their adiabatic versions.
    pub(super) fn heat(&self, effects: &RawEffects, bar: &mut Bar) -> Result<Option<Heat>> {
        let Some(raw) = &effects.heat else { return Ok(None) };
        let fraction = self.si(&raw.get_ref().fraction)?;
        for segment in &mut bar.segments {
            let heated = segment.material.heated(fraction).map_err(|error| {
                let name = &segment.material.name;
                let (message, help) = match error {
                    HeatingError::Missing(keys) => (
                        format!("`heat` needs constants that the material `{name}` does not have: {}", keys.join(", ")),
                        "add them to the material's [heat] table, e.g. specific-heat = \"385 J/(kg*K)\", \
                         reference-temperature = \"293 K\", melting-temperature = \"1356 K\", m = 1; or remove `heat`",
                    ),
                    HeatingError::Curve(error) => {
                        (format!("the curve of `{name}` cannot be softened: {error}"), "remove `heat`")
                    }
                    HeatingError::Fraction(_) => (error.to_string(), "state a fraction from 0 to 1"),
                };
                self.error(raw.span(), "effects.heat", message).help(help)
            })?;
            segment.material = Arc::new(heated);
        }
        Ok(Some(Heat { fraction }))
    }
}
