//! The effect `rupture`: its threshold, the notches, and whether anything in the bar can break.

use std::ops::Range;

use toml::Spanned;

use super::super::Rupture;
use super::super::raw::{RawBar, RawEffects, RawJoint, RawRupture, RawSegment};
use super::Checker;
use crate::bar::Bar;
use crate::error::Result;
use crate::input::{Allowed, Number};
use crate::law::rupture::Cause;
use crate::material::Sense;
use crate::units::Dimension;

/// Largest notch factor: sharper ones are cracks, which are another matter.
pub(in crate::scene) const MOST_NOTCH: f64 = 1000.0;

impl Checker<'_> {
    pub(super) fn rupture(&self, effects: &RawEffects, raw: &RawBar, bar: &Bar) -> Result<Option<Rupture>> {
        let segments = raw.segment.as_deref().unwrap_or_default();
        let Some(rupture) = &effects.rupture else {
            return self.no_notches(segments).map(|()| None);
        };
        let (cause, threshold) = match rupture.get_ref() {
            RawRupture::CriticalStrain => {
                self.some_strain_is_critical(rupture.span(), bar)?;
                (Cause::CriticalStrain, None)
            }
            RawRupture::Energy(energy) => {
                let key = "effects.rupture.energy";
                (Cause::Energy, Some(self.document.number(energy, key, Dimension::EnergyDensity, Allowed::Positive)?))
            }
            RawRupture::Spall(stress) => {
                let key = "effects.rupture.spall";
                (Cause::Spall, Some(self.document.number(stress, key, Dimension::Stress, Allowed::Positive)?))
            }
        };
        let factor = |i: usize, name: &str, value: Option<&Number>| -> Result<f64> {
            let key = format!("bar.segment.{i}.{name}");
            let given = self.document.optional(value, &key, Dimension::None, Allowed::Within(1.0, MOST_NOTCH))?;
            Ok(given.unwrap_or(1.0))
        };
        let (mut notches, mut joint_notches) = (vec![1.0; bar.segments.len()], vec![1.0; bar.segments.len()]);
        for (i, segment) in segments.iter().enumerate() {
            notches[i] = factor(i, "notch", segment.get_ref().notch.as_ref())?;
            joint_notches[i] = factor(i, "joint-notch", segment.get_ref().joint_notch.as_ref())?;
            self.joint_can_break(i, segment.get_ref(), i + 1 == segments.len())?;
        }
        Ok(Some(Rupture { cause, threshold, notches, joint_notches }))
    }

    fn no_notches(&self, segments: &[Spanned<RawSegment>]) -> Result<()> {
        for (i, segment) in segments.iter().enumerate() {
            let segment = segment.get_ref();
            for (name, value) in [("notch", &segment.notch), ("joint-notch", &segment.joint_notch)] {
                if let Some(value) = value {
                    let message = format!("`{name}` says where the bar breaks first, and this bar does not break");
                    let error = self.error(value.span(), &format!("bar.segment.{i}.{name}"), message);
                    return Err(error
                        .help("add e.g. rupture = \"critical-strain\" to [effects], or take it out")
                        .into());
                }
            }
        }
        Ok(())
    }

    /// A joint notch needs a joint that holds.
    fn joint_can_break(&self, i: usize, segment: &RawSegment, last: bool) -> Result<()> {
        let Some(notch) = &segment.joint_notch else { return Ok(()) };
        let contact = segment.joint.as_ref().is_some_and(|joint| *joint.get_ref() == RawJoint::Contact);
        if !last && !contact {
            return Ok(());
        }
        let why = if last { "the last segment has no joint to a next one" } else { "a contact joint holds nothing" };
        let error = self.error(notch.span(), &format!("bar.segment.{i}.joint-notch"), why);
        Err(error.help("take it out, or use `notch` for the whole segment").into())
    }

    fn some_strain_is_critical(&self, span: Range<usize>, bar: &Bar) -> Result<()> {
        let known = |s: &crate::bar::Segment| s.material.branch(Sense::Tension).ultimate().is_some();
        if bar.segments.iter().any(known) {
            return Ok(());
        }
        let name = &bar.segments[0].material.name;
        let message =
            format!("no strain of `{name}` is critical: its curve has no largest stress and does not end in rupture");
        let help = "give the curve up to its largest stress, say beyond = \"rupture\" where the data end in rupture, or use \
                    rupture = { energy = \"...\" } or { spall = \"...\" }";
        Err(self.error(span, "effects.rupture", message).help(help).into())
    }
}
