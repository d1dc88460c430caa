//! The effect `hardening`, and the effects that imply it.

use super::super::capability::MIXED;
use super::super::raw::{RawEffects, RawHardening};
use super::super::{Effects, HardeningRule};
use super::Checker;
use crate::bar::{Bar, Segment};
use crate::error::Result;
use crate::law::rate::Hardening;
use crate::law::{BackStress, Table};
use crate::typed::Placed;
use crate::units::{Dimension, System, format};

impl Checker<'_> {
    /// Returns the effects `hardening` and `rate`; the caller adds the others.
    pub(super) fn effects(&self, raw: &RawEffects, bar: &Bar) -> Result<Effects> {
        let rate = raw.rate.as_ref().map(|rate| self.rate(rate, bar)).transpose()?;
        let Some(hardening) = &raw.hardening else {
            // Rate dependence and heating act on plastic strain, which does not exist if unloading follows the loading curve.
            let implied = rate.is_some() || raw.heat.is_some();
            return Ok(Effects { hardening: implied.then_some(HardeningRule::Isotropic), rate, ..Effects::default() });
        };
        let key = "effects.hardening";
        let kind = match hardening.get_ref() {
            RawHardening::Isotropic => HardeningRule::Isotropic,
            RawHardening::Kinematic => HardeningRule::Kinematic,
            RawHardening::Mixed(fraction) => HardeningRule::Mixed(self.si(fraction)?),
            RawHardening::ArmstrongFrederick(back) => {
                HardeningRule::ArmstrongFrederick { c: self.si(&back.c)?, gamma: self.si(&back.gamma)? }
            }
        };
        let two_branches = bar.segments.iter().find(|s| s.material.compression.is_some());
        if let Some(segment) = two_branches.filter(|_| kind != HardeningRule::Isotropic) {
            let name = &segment.material.name;
            let rule = match kind {
                HardeningRule::Isotropic | HardeningRule::Kinematic => "kinematic",
                HardeningRule::Mixed(_) => "mixed",
                HardeningRule::ArmstrongFrederick { .. } => "Armstrong-Frederick",
            };
            let message = format!("{rule} hardening needs one curve for tension and compression; `{name}` has two");
            let help = "use hardening = \"isotropic\", or a copy of the material file without its compression curve: `[compression]`, or symmetry = \
                        \"true\", as in the material library";
            return Err(self.error(hardening.span(), key, message).allowed("\"isotropic\"").help(help).into());
        }
        if raw.overlays()
            && let Some(segment) = bar.segments.iter().find(|s| !table(s).is_concave())
        {
            let name = &segment.material.name;
            let message = format!("kinematic hardening needs a curve that does not stiffen; that of `{name}` does");
            let help = format!("{MIXED}, or hardening = \"isotropic\"");
            let allowed = "\"isotropic\" or { mixed = 0 to 1 }";
            return Err(self.error(hardening.span(), key, message).allowed(allowed).help(help).into());
        }
        if let HardeningRule::ArmstrongFrederick { c, gamma } = kind {
            self.leaves_an_elastic_range(hardening, [c, gamma], bar)?;
        }
        Ok(Effects { hardening: Some(kind), rate, ..Effects::default() })
    }

    /// Checks that the back stress of Armstrong-Frederick hardening is less than the flow stress at every plastic strain.
    fn leaves_an_elastic_range(&self, hardening: &Placed<RawHardening>, [c, gamma]: [f64; 2], bar: &Bar) -> Result<()> {
        for segment in &bar.segments {
            let modulus = segment.material.modulus;
            let curve = Hardening::new(&table(segment));
            let Some(p) = BackStress::new(c, gamma, modulus).uses_up(curve.pieces()) else { continue };
            let message = format!(
                "no elastic range is left: the back stress comes to the flow stress of `{}` at a plastic strain of {}, and tends to C/gamma = {}",
                segment.material.name,
                format(p / modulus, Dimension::None, System::Si),
                format(c / gamma, Dimension::Stress, System::Si)
            );
            let help = "reduce C, or increase gamma";
            let allowed = "(C/gamma)(1 - exp(-gamma p)) less than the flow stress at any plastic strain p";
            return Err(self
                .error(hardening.span(), "effects.hardening.armstrong-frederick", message)
                .allowed(allowed)
                .help(help)
                .into());
        }
        Ok(())
    }
}

fn table(segment: &Segment) -> Table {
    Table::new(&segment.material.tension, segment.material.modulus)
}
