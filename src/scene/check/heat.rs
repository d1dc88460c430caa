//! The effect `heat`: heats the materials of the bar, and says which methods can follow it.

use std::sync::Arc;

use super::super::Heat;
use super::super::raw::{RawEffects, RawMethod, RawUnloading};
use super::Checker;
use crate::bar::Bar;
use crate::error::Result;
use crate::material::HeatingError;

impl Checker<'_> {
    /// The effect; the materials of `bar` become those that it makes of them.
    pub(super) fn heat(&self, effects: &RawEffects, bar: &mut Bar) -> Result<Option<Heat>> {
        let Some(raw) = &effects.heat else { return Ok(None) };
        let fraction = self.si(&raw.get_ref().fraction)?;
        for segment in &mut bar.segments {
            let heated = segment.material.heated(fraction).map_err(|error| {
                let name = &segment.material.name;
                let (message, help) = match error {
                    HeatingError::Missing(keys) => (
                        format!("heat needs constants that the material `{name}` does not state: {}", keys.join(", ")),
                        "add them to the material's [heat] table, e.g. specific-heat = \"385 J/(kg*K)\", \
                         reference-temperature = \"293 K\", melting-temperature = \"1356 K\", m = 1; or take `heat` out",
                    ),
                    HeatingError::Curve(error) => {
                        (format!("the curve of `{name}` cannot be softened: {error}"), "take `heat` out")
                    }
                };
                self.error(raw.span(), "effects.heat", message).help(help)
            })?;
            segment.material = Arc::new(heated);
        }
        Ok(Some(Heat { fraction }))
    }

    /// Front tracking runs on one curve, and heat makes one of it only where hardening is isotropic and takes no time.
    pub(super) fn heat_can_be_followed(&self, effects: &RawEffects, method: RawMethod) -> Result<()> {
        let (Some(heat), RawMethod::Moc) = (&effects.heat, method) else { return Ok(()) };
        let isotropic = |u: &RawUnloading| matches!(u, RawUnloading::Isotropic);
        let what = if effects.rate.is_some() {
            "a rate-dependent bar on a characteristic net"
        } else if effects.unloading.as_ref().is_some_and(|u| !isotropic(u.get_ref())) {
            "kinematic hardening by front tracking"
        } else {
            return Ok(());
        };
        let message = format!("heat is not followed in {what}, method = \"moc\"");
        let help = "use method = \"fd\", which follows it";
        Err(self.error(heat.span(), "effects.heat", message).allowed("method = \"fd\"").help(help).into())
    }
}
