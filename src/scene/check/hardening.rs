//! The effect `hardening`, and the effects that imply it.

use super::super::capability::MIXED;
use super::super::raw::{RawEffects, RawUnloading};
use super::super::{Effects, Unloading};
use super::Checker;
use crate::bar::{Bar, Segment};
use crate::error::Result;
use crate::law::Table;

impl Checker<'_> {
    /// Hardening and rate; what else the scene names comes on top.
    pub(super) fn effects(&self, raw: &RawEffects, bar: &Bar) -> Result<Effects> {
        let rate = raw.rate.as_ref().map(|rate| self.rate(rate, bar)).transpose()?;
        let Some(unloading) = &raw.unloading else {
            // A curve that is followed both ways has no plastic strain that could take time or warm the bar.
            let implied = rate.is_some() || raw.heat.is_some();
            return Ok(Effects { unloading: implied.then_some(Unloading::Isotropic), rate, ..Effects::default() });
        };
        let key = "effects.hardening";
        let kind = match unloading.get_ref() {
            RawUnloading::Isotropic => Unloading::Isotropic,
            RawUnloading::Kinematic => Unloading::Kinematic,
            RawUnloading::Mixed(fraction) => Unloading::Mixed(self.si(fraction)?),
        };
        let two_branches = bar.segments.iter().find(|s| s.material.compression.is_some());
        if let (Some(segment), Unloading::Kinematic | Unloading::Mixed(_)) = (two_branches, kind) {
            let name = &segment.material.name;
            let message = format!("kinematic hardening needs one curve for both senses; `{name}` has two");
            let help = "use hardening = \"isotropic\", or a material without a compression curve of its own";
            return Err(self.error(unloading.span(), key, message).allowed("\"isotropic\"").help(help).into());
        }
        if raw.overlays()
            && let Some(segment) = bar.segments.iter().find(|s| !table(s).is_concave())
        {
            let name = &segment.material.name;
            let message = format!("kinematic hardening needs a curve that does not stiffen; that of `{name}` does");
            let help = format!("{MIXED}, or hardening = \"isotropic\"");
            let allowed = "\"isotropic\" or { mixed = 0 to 1 }";
            return Err(self.error(unloading.span(), key, message).allowed(allowed).help(help).into());
        }
        Ok(Effects { unloading: Some(kind), rate, ..Effects::default() })
    }
}

fn table(segment: &Segment) -> Table {
    Table::new(&segment.material.tension, segment.material.modulus)
}
