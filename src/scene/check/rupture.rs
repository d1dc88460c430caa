//! The effect `rupture`: threshold, stress concentrations, and whether the bar can fracture.

use std::ops::Range;

use super::super::Rupture;
use super::super::raw::{RawBar, RawEffects, RawJoint, RawRupture, RawSegment};
use super::Checker;
use super::distribution::{STRAIN, STRESS};
use crate::bar::Bar;
use crate::error::Result;
use crate::law::rupture::Cause;
use crate::material::Sense;
use crate::typed::{Key, Placed};

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
            RawRupture::Energy(energy) => (Cause::Energy, Some(self.si(energy)?)),
            RawRupture::Spall(stress) => (Cause::Spall, Some(self.si(stress)?)),
        };
        let (mut notches, mut joint_notches) = (vec![1.0; bar.segments.len()], vec![1.0; bar.segments.len()]);
        for (i, segment) in segments.iter().enumerate() {
            notches[i] = self.si(&segment.get_ref().notch)?;
            joint_notches[i] = self.si(&segment.get_ref().joint_notch)?;
            self.joint_can_break(i, segment.get_ref(), i + 1 == segments.len())?;
        }
        if let (Cause::Spall, Some(strength)) = (cause, threshold) {
            self.holds_at_first(strength, &notches, raw, bar)?;
        }
        Ok(Some(Rupture { cause, threshold, notches, joint_notches }))
    }

    fn no_notches(&self, segments: &[Placed<RawSegment>]) -> Result<()> {
        for (i, segment) in segments.iter().enumerate() {
            for (name, place) in segment.get_ref().notches() {
                if let Some(span) = place {
                    let message = format!("`{name}` applies to the fracture criterion, and fracture is not simulated");
                    let error = self.error(span, &format!("bar.segment.{i}.{name}"), message);
                    return Err(error.help("add e.g. rupture = \"critical-strain\" to [effects], or remove it").into());
                }
            }
        }
        Ok(())
    }

    /// Refuses a stress concentration factor of a joint that cannot fracture.
    fn joint_can_break(&self, i: usize, segment: &RawSegment, last: bool) -> Result<()> {
        let Some(span) = segment.joint_notch.place() else { return Ok(()) };
        let contact = segment.joint.as_ref().is_some_and(|joint| *joint.get_ref() == RawJoint::Contact);
        if !last && !contact {
            return Ok(());
        }
        let why =
            if last { "the last segment has no joint to a next segment" } else { "a contact joint carries no tension" };
        let error = self.error(span, &format!("bar.segment.{i}.joint-stress-concentration"), why);
        Err(error.help("remove it, or use `stress-concentration` for the whole segment").into())
    }

    /// Refuses a segment whose initial stress reaches its spall strength: it would fracture at all positions at once, and there is no solution.
    fn holds_at_first(&self, strength: f64, notches: &[f64], raw: &RawBar, bar: &Bar) -> Result<()> {
        for (k, (segment, notch)) in bar.segments.iter().zip(notches).enumerate() {
            let along = segment.profile.as_deref().map(|profile| &profile.stress);
            let most = along.map_or(segment.initial.stress, |along| {
                along.rows().fold(f64::NEG_INFINITY, |most, (_, stress)| most.max(stress))
            });
            let most_allowed = strength / notch;
            if most < most_allowed {
                continue;
            }
            let (key, span) =
                [STRESS, STRAIN].into_iter().find_map(|which| raw.initial_of(k, which)).unwrap_or_default();
            let message = format!("an initial stress of {most:.6e} Pa is not below the spall strength");
            let error = self.error(span, &key, message).allowed(format!("less than {most_allowed:.6e} Pa"));
            let help =
                "the segment would fracture at all places at t = 0; use a lower initial stress, or remove `rupture`";
            return Err(error.help(help).into());
        }
        Ok(())
    }

    fn some_strain_is_critical(&self, span: Range<usize>, bar: &Bar) -> Result<()> {
        let known = |s: &crate::bar::Segment| s.material.branch(Sense::Tension).ultimate().is_some();
        if bar.segments.iter().any(known) {
            return Ok(());
        }
        let name = &bar.segments[0].material.name;
        let message =
            format!("`{name}` has no critical strain: its curve has no largest stress and does not end in rupture");
        let help = "extend the curve to its largest stress, set beyond = \"rupture\" if the data end in rupture, or use \
                    rupture = { energy = \"...\" } or { spall = \"...\" }";
        Err(self.error(span, "effects.rupture", message).help(help).into())
    }
}
