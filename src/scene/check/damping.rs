//! The effects `damping` and `lateral-inertia`: constants, requirements on the bar, and exclusions.

use super::super::damping::{Damping, Key, Per};
use super::super::raw::RawEffects;
use super::Checker;
use crate::bar::Bar;
use crate::error::Result;

impl Checker<'_> {
    /// Returns the distributed forces of a bar; `None` if all constants are zero.
    pub(super) fn damping(&self, effects: &RawEffects, bar: &Bar) -> Result<Option<Damping>> {
        let Some(raw) = &effects.damping else { return Ok(None) };
        let (span, raw) = (raw.span(), raw.get_ref());
        let (keys, damping) = (raw.keys(), raw.read(self.document)?);
        if keys.iter().all(|key| key.place.is_none()) {
            let help = "write e.g. damping = { external = \"300 N*s/m^2\" }, or remove `damping`";
            let error = self.error(span, "effects.damping", "`damping` is empty");
            return Err(error.allowed(Damping::NAMES.join(", ")).help(help).into());
        }
        for Key { name, place, per } in &keys {
            if let (Some(span), Per::Length, false) = (place, per, bar.area_given) {
                let message = format!("`{name}` is a force per length and needs the cross-section of the bar");
                let key = format!("effects.damping.{name}");
                return Err(self.error(span.clone(), &key, message).help(AREA).into());
            }
        }
        let lateral = || effects.lateral_inertia().map(|_| "`lateral-inertia`");
        let other = if damping.internal > 0.0 { Some("`internal`") } else { lateral() };
        if let (Some(other), true) = (other, damping.friction > 0.0) {
            let message =
                format!("friction is not simulated together with {other}, which couples the nodes of the grid");
            let error = self.error(span, "effects.damping", message);
            return Err(error.help(format!("remove `friction` or {other}")).into());
        }
        Ok(Some(damping).filter(|damping| *damping != Damping::default()))
    }

    /// Returns whether lateral inertia is simulated.
    pub(super) fn lateral_inertia(&self, effects: &RawEffects, bar: &Bar) -> Result<bool> {
        let Some(lateral) = effects.lateral_inertia() else { return Ok(false) };
        let key = "effects.lateral-inertia";
        if !bar.area_given {
            let message = "lateral inertia needs the cross-section of the bar";
            return Err(self.error(lateral.span(), key, message).help(AREA).into());
        }
        if let Some(segment) = bar.segments.iter().find(|s| s.material.poisson.is_none()) {
            let name = &segment.material.name;
            let message = format!("lateral inertia needs Poisson's ratio, which `{name}` does not have");
            let help =
                "add e.g. poisson = 0.29 to the material (a copy of its file beside the scene, or an inline table)";
            return Err(self.error(lateral.span(), key, message).allowed("0 <= poisson <= 0.5").help(help).into());
        }
        Ok(true)
    }
}

/// Help for a bar without a cross-section.
const AREA: &str = "give [bar] (or every [[bar.segment]]) an area, e.g. area = \"1 cm^2\", or a diameter";
