//! The effects `damping` and `lateral-inertia`: their numbers, what they need of the bar, and what they do not go with.

use std::ops::Range;

use super::super::damping::{Damping, Key, Per};
use super::super::raw::{RawEffects, RawMethod, RawSolve};
use super::Checker;
use crate::bar::{Bar, Joint};
use crate::error::Result;
use crate::typed::Placed;

impl RawEffects {
    /// What acts along the bar, with its key and place: the first of the two effects that is on.
    pub(super) fn along(&self) -> Option<(&'static str, Range<usize>)> {
        let damping = self.damping.as_ref().map(|damping| ("damping", damping.span()));
        damping.or_else(|| {
            let lateral = self.lateral_inertia.as_ref().filter(|lateral| *lateral.get_ref());
            lateral.map(|lateral| ("lateral-inertia", lateral.span()))
        })
    }
}

impl Checker<'_> {
    /// The damping of a bar, if there is one; zeros alone are none.
    pub(super) fn damping(&self, effects: &RawEffects, bar: &Bar) -> Result<Option<Damping>> {
        let Some(raw) = &effects.damping else { return Ok(None) };
        let (span, raw) = (raw.span(), raw.get_ref());
        let (keys, damping) = (raw.keys(), raw.read(self.document)?);
        if keys.iter().all(|key| key.place.is_none()) {
            let help = "write e.g. damping = { external = \"300 N*s/m^2\" }, or take `damping` out";
            let error = self.error(span, "effects.damping", "no kind of damping is named");
            return Err(error.allowed(Damping::NAMES.join(", ")).help(help).into());
        }
        for Key { name, place, per } in &keys {
            if let (Some(span), Per::Length, false) = (place, per, bar.area_given) {
                let message = format!("`{name}` is a force per length on the whole section, and the bar has none");
                let key = format!("effects.damping.{name}");
                return Err(self.error(span.clone(), &key, message).help(AREA).into());
            }
        }
        let lateral = effects.lateral_inertia.as_ref().is_some_and(|lateral| *lateral.get_ref());
        let other = if damping.internal > 0.0 { Some("`internal`") } else { lateral.then_some("`lateral-inertia`") };
        if let (Some(other), true) = (other, damping.friction > 0.0) {
            let message =
                format!("friction is not followed together with {other}, which couples the nodes of the grid");
            let error = self.error(span, "effects.damping", message);
            return Err(error.help(format!("take `friction` or {other} out")).into());
        }
        Ok(Some(damping).filter(|damping| *damping != Damping::default()))
    }

    /// Whether the sideways motion has inertia.
    pub(super) fn lateral_inertia(&self, effects: &RawEffects, bar: &Bar) -> Result<bool> {
        let Some(lateral) = effects.lateral_inertia.as_ref().filter(|lateral| *lateral.get_ref()) else {
            return Ok(false);
        };
        let key = "effects.lateral-inertia";
        if !bar.area_given {
            let message = "lateral inertia depends on the size of the section, and the bar has none";
            return Err(self.error(lateral.span(), key, message).help(AREA).into());
        }
        if let Some(segment) = bar.segments.iter().find(|s| s.material.poisson.is_none()) {
            let name = &segment.material.name;
            let message = format!("lateral inertia needs Poisson's ratio, and `{name}` does not state it");
            let help =
                "add e.g. poisson = 0.29 to the material (a copy of its file beside the scene, or an inline table)";
            return Err(self.error(lateral.span(), key, message).allowed("0 <= poisson <= 0.5").help(help).into());
        }
        Ok(true)
    }

    /// What acts along the bar is solved for all nodes at once, on a grid whose nodes stay together.
    pub(super) fn along_goes(&self, effects: &RawEffects, bar: &Bar) -> Result<()> {
        let Some((name, _)) = effects.along() else { return Ok(()) };
        if let Some(rupture) = &effects.rupture {
            let message = format!("rupture of a bar with `{name}` is not followed");
            let help =
                format!("take `rupture` or `{name}` out of [effects]: method = \"fd\" follows each without the other");
            return Err(self.error(rupture.span(), "effects.rupture", message).help(help).into());
        }
        let (name, span) = effects.along().unwrap_or((name, 0..0));
        if let Some(k) = bar.segments.iter().position(|s| s.taper.is_some()) {
            let message = format!("`{name}` is not followed in a bar whose section changes along segment {}", k + 1);
            let help =
                format!("make it of uniform segments, or take `{name}` out of [effects]: both methods then follow it");
            return Err(self.error(span, &format!("effects.{name}"), message).help(help).into());
        }
        let Some(k) = bar.segments.iter().position(|s| matches!(s.joint, Joint::Contact { .. })) else { return Ok(()) };
        let message =
            format!("`{name}` is not followed in a bar with joints that can open, as that behind segment {}", k + 1);
        let help = format!("bond the joint, or take `{name}` out of [effects]: both methods then follow such joints");
        Err(self.error(span, &format!("effects.{name}"), message).help(help).into())
    }

    /// Characteristics are straight only without what acts along the bar.
    pub(super) fn along_is_on_a_grid(&self, effects: &RawEffects, raw: &RawSolve, method: RawMethod) -> Result<()> {
        let (Some((name, _)), RawMethod::Moc) = (effects.along(), method) else { return Ok(()) };
        let span = raw.method.as_ref().map_or(0..0, Placed::span);
        let message = format!("method = \"moc\" does not follow `{name}`");
        let help = format!("use method = \"fd\", which does, or take `{name}` out of [effects]");
        Err(self.error(span, "solve.method", message).allowed("\"fd\"").help(help).into())
    }
}

/// The way out for a bar without a section.
const AREA: &str = "give [bar] (or every [[bar.segment]]) an area, e.g. area = \"1 cm^2\", or a diameter";
