//! The bar: a uniform piece or a list of segments, with their sections, materials and joints.

use std::collections::HashMap;
use std::ops::Range;
use std::sync::Arc;

use super::super::raw::{INITIAL, MaterialChoice, RawBar, RawJoint, RawPiece, RawSegment};
use super::Checker;
use super::distribution::Values;
use crate::bar::{Bar, Joint, Segment};
use crate::error::{Error, Result};
use crate::input::GivenKey;
use crate::material::{self, Material};
use crate::typed::{Key, Placed};

/// Materials by name, so that each is read only once and is shared by its segments.
pub(in crate::scene) type Named = HashMap<String, Arc<Material>>;

impl Checker<'_> {
    pub(super) fn bar(&self, raw: &Placed<RawBar>) -> Result<Bar> {
        let (span, raw) = (raw.span(), raw.get_ref());
        let piece = raw.piece();
        let mut named = Named::new();
        let none = || std::array::from_fn(|_| None);
        let Some(list) = &raw.segment else {
            let (segment, area_given) = self.piece(&piece, span, "bar", &mut named)?;
            let values = self.distributions(&piece.initial, "bar", segment.length)?;
            let mut bar = Bar { segments: vec![segment], area_given };
            self.start_with(raw, &mut bar, &[values], &none())?;
            return Ok(bar);
        };
        self.no_uniform_keys(&piece)?;
        let mut bar = self.segments(list, span, &mut named)?;
        let whole = self.distributions(&piece.initial, "bar", bar.length())?;
        let own = list.iter().zip(&bar.segments).enumerate().map(|(k, (raw, segment))| {
            self.distributions(&raw.get_ref().piece().initial, &format!("bar.segment.{k}"), segment.length)
        });
        let own = own.collect::<Result<Vec<Values>>>()?;
        self.start_with(raw, &mut bar, &own, &whole)?;
        Ok(bar)
    }

    /// Refuses `[bar]` keys that belong in the segments if there are segments.
    fn no_uniform_keys(&self, piece: &RawPiece<'_>) -> Result<()> {
        // Tables of initial values are functions of x over the whole bar.
        let table = |name: &str| {
            let which = INITIAL.iter().position(|key| *key == name);
            which.is_some_and(|which| piece.initial[which].as_ref().is_some_and(|given| given.uniform().is_none()))
        };
        let own = |name: &str| ["mode", "shear", "segment"].contains(&name);
        let given = self.keys[0].iter().find(|given| !own(&given.name) && !table(&given.name));
        let Some(GivenKey { name, value: span, .. }) = given else { return Ok(()) };
        let message = format!("`{name}` of [bar] cannot be combined with [[bar.segment]]");
        let help = format!("move `{name}` into each [[bar.segment]], or remove the segments");
        Err(self.error(span.clone(), &format!("bar.{name}"), message).help(help).into())
    }

    fn segments(&self, list: &[Placed<RawSegment>], span: Range<usize>, named: &mut Named) -> Result<Bar> {
        let mut segments = Vec::with_capacity(list.len());
        let mut with_area = Vec::with_capacity(list.len());
        for (i, raw) in list.iter().enumerate() {
            let key = format!("bar.segment.{i}");
            let last = i + 1 == list.len();
            let (span, raw) = (raw.span(), raw.get_ref());
            let (mut segment, area_given) = self.piece(&raw.piece(), span, &key, named)?;
            segment.joint = self.joint(raw, &key, last)?;
            segments.push(segment);
            with_area.push(area_given);
        }
        if segments.is_empty() {
            let help = "add [[bar.segment]] tables, or length and material to [bar]";
            return Err(self.error(span, "bar.segment", "the bar has no segment").help(help).into());
        }
        if let Some(i) = with_area.iter().position(|&given| given != with_area[0]) {
            let without = if with_area[0] { i } else { 0 };
            let message = "other segments have an area and this one has none";
            let error = self.error(list[without].span(), &format!("bar.segment.{without}.area"), message);
            return Err(error.help("give `area` or `diameter` in every segment, or in none").into());
        }
        Ok(Bar { segments, area_given: with_area[0] })
    }

    /// Reads a uniform piece, bonded to the next one. Returns whether its area was given.
    fn piece(&self, piece: &RawPiece<'_>, span: Range<usize>, key: &str, named: &mut Named) -> Result<(Segment, bool)> {
        let Some(length) = piece.length else {
            let help = format!("add the length to `{key}`, e.g. length = \"1 m\"");
            return Err(self.missing(span, &format!("{key}.length"), &help));
        };
        let Some(choice) = piece.material else {
            let help = format!(
                "add a material to `{key}`: a library name (see `material::library::names`), a path, or an inline table"
            );
            return Err(self.missing(span, &format!("{key}.material"), &help));
        };
        let length = self.si(length)?;
        let section = self.section(piece, key, length)?;
        let material = self.material(choice, &format!("{key}.material"), named)?;
        let area = section.as_ref().map_or(1.0, |section| section.area);
        let segment = Segment {
            taper: section.as_ref().and_then(|section| section.taper.clone()),
            ..Segment::new(length, area, material)
        };
        Ok((segment, section.is_some()))
    }

    pub(in crate::scene) fn material(
        &self,
        choice: &Placed<MaterialChoice>,
        key: &str,
        named: &mut Named,
    ) -> Result<Arc<Material>> {
        match choice.get_ref() {
            MaterialChoice::Inline(raw) => {
                material::resolve((**raw).clone(), self.document, key, self.base).map(Arc::new)
            }
            MaterialChoice::Named(name) => {
                if let Some(known) = named.get(name) {
                    return Ok(known.clone());
                }
                let found = material::library::find(name, self.base).map_err(|e| self.placed(e, choice, key))?;
                let shared = Arc::new(found);
                named.insert(name.clone(), shared.clone());
                Ok(shared)
            }
        }
    }

    /// Adds the position at which the scene names the material to an error without a position of its own, such as an unknown material.
    fn placed(&self, error: Error, choice: &Placed<MaterialChoice>, key: &str) -> Error {
        let Error::Input(error) = error else { return error };
        if error.place.is_some() {
            return error.into();
        }
        error.key(key).at(self.document.place(choice.span())).into()
    }

    fn joint(&self, raw: &RawSegment, key: &str, last: bool) -> Result<Joint> {
        let kind = raw.joint.as_ref().map_or(RawJoint::Bonded, |j| *j.get_ref());
        let (joint_key, gap_key) = (format!("{key}.joint"), format!("{key}.gap"));
        let gap = self.si(&raw.gap)?;
        if let (Some(joint), true) = (&raw.joint, last) {
            let error = self.error(joint.span(), &joint_key, "the last segment has no next segment");
            return Err(error.help("remove it; [right] is the boundary condition of this end").into());
        }
        if let (Some(gap), RawJoint::Bonded) = (raw.gap.place(), kind) {
            let error = self.error(gap, &gap_key, "a bonded joint has no gap");
            return Err(error.help("remove `gap`, or set joint = \"contact\"").into());
        }
        match kind {
            RawJoint::Bonded => Ok(Joint::Bonded),
            RawJoint::Contact => Ok(Joint::Contact { gap }),
        }
    }
}
