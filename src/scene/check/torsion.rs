//! Bars in torsion: what they may state, and what a scene then means in terms of the surface: a bar in tension with the
//! area J/R^2, see [`crate::material::TubeSection`] and [`crate::scene::Torsion`].

use std::collections::HashMap;
use std::collections::hash_map::Entry;
use std::f64::consts::PI;
use std::ops::Range;
use std::sync::Arc;

use toml::Spanned;

use super::super::Torsion;
use super::super::raw::{EndKind, RawBar, RawEffects, RawEnd, RawSegment, Section};
use super::Checker;
use super::end_keys::given;
use crate::bar::{Bar, EndCondition, InitialProfile, Joint};
use crate::error::{Error, InputError, Result};
use crate::input::{Allowed, Number};
use crate::material::{CurveError, Loading, Material, TubeSection};
use crate::units::Dimension;

/// The wall of a tube in which stress is taken as even, in parts of its diameter: J is then right to 0.3 %.
const THINNEST: f64 = 20.0;

/// Radii closer than this (relative) are one.
const SAME_RADIUS: f64 = 1e-9;

/// What one segment states of its section.
struct Given<'a> {
    area: Option<&'a Spanned<Section>>,
    diameter: Option<&'a Spanned<Section>>,
    inner: Option<&'a Number>,
    wall: Option<&'a Number>,
    material: Option<Range<usize>>,
    key: String,
    span: Range<usize>,
}

/// A round section: the radius whose stress and strain stand for it, J, and the hollow to integrate over (none: thin).
struct Round {
    radius: f64,
    polar: f64,
    hollow: Option<TubeSection>,
}

fn all_given(raw: &Spanned<RawBar>) -> Vec<Given<'_>> {
    let (span, raw) = (raw.span(), raw.get_ref());
    let Some(list) = &raw.segment else {
        return vec![Given {
            area: raw.area.as_ref(),
            diameter: raw.diameter.as_ref(),
            inner: raw.inner_diameter.as_ref(),
            wall: raw.wall.as_ref(),
            material: raw.material.as_ref().map(Spanned::span),
            key: "bar".into(),
            span,
        }];
    };
    list.iter().enumerate().map(|(i, segment)| one_given(i, segment)).collect()
}

fn one_given(i: usize, segment: &Spanned<RawSegment>) -> Given<'_> {
    let (span, raw) = (segment.span(), segment.get_ref());
    Given {
        area: raw.area.as_ref(),
        diameter: raw.diameter.as_ref(),
        inner: raw.inner_diameter.as_ref(),
        wall: raw.wall.as_ref(),
        material: raw.material.as_ref().map(Spanned::span),
        key: format!("bar.segment.{i}"),
        span,
    }
}

impl Checker<'_> {
    /// In an axial bar: nothing that belongs to torsion alone.
    pub(super) fn nothing_of_torsion(&self, raw: &Spanned<RawBar>, bar: &Bar) -> Result<()> {
        if let Some(shear) = &raw.get_ref().shear {
            let error = self.error(shear.span(), "bar.shear", "`shear` means nothing for an axial bar");
            return Err(error.help("take it out, or say mode = \"torsion\" in [bar]").into());
        }
        for (given, segment) in all_given(raw).into_iter().zip(&bar.segments) {
            for (name, value) in [("inner-diameter", given.inner), ("wall", given.wall)] {
                if let Some(value) = value {
                    let message = format!("`{name}` belongs to a bar in torsion");
                    let error = self.error(value.span(), &format!("{}.{name}", given.key), message);
                    return Err(error.help("give the section's `area`, or say mode = \"torsion\" in [bar]").into());
                }
            }
            if segment.material.loading == Loading::Shear {
                let message = format!("the curve of `{}` is one of shear, and the bar is axial", segment.material.name);
                let span = given.material.unwrap_or(given.span);
                let error = self.error(span, &format!("{}.material", given.key), message);
                return Err(error.help("say mode = \"torsion\" in [bar], or take a material known in tension").into());
            }
        }
        Ok(())
    }

    fn no_nominal_curve(&self, given: &Given, shear: &Material, fault: &CurveError) -> InputError {
        let message = format!("the shear curve of `{}` gives no curve of torque over twist: {fault}", shear.name);
        let span = given.material.clone().unwrap_or_else(|| given.span.clone());
        let help = "end its table at strains that can occur, or give a thin-walled section";
        self.error(span, &format!("{}.material", given.key), message).help(help)
    }

    /// Makes of a bar as it was read one in terms of its surface.
    pub(super) fn twist(&self, raw: &Spanned<RawBar>, bar: &mut Bar) -> Result<Torsion> {
        let mut torsion = Torsion { radius: 0.0, polar: Vec::new() };
        // Each different material of each different section once, so that segments share it.
        let mut shared: HashMap<(usize, u64), Arc<Material>> = HashMap::new();
        for (k, given) in all_given(raw).into_iter().enumerate() {
            let segment = &mut bar.segments[k];
            if segment.joint != Joint::Bonded {
                let help = "bond it, or cut the scene there with an end that says what acts on it";
                let error =
                    self.error(given.span, &format!("{}.joint", given.key), "a contact joint carries no torque");
                return Err(error.help(help).into());
            }
            let round = self.round(&given)?;
            if k == 0 {
                torsion.radius = round.radius;
            }
            self.same_radius(&given, round.radius, torsion.radius)?;
            let shear = self.in_shear(raw.get_ref(), &given, &segment.material)?;
            if let Some(hollow) = round.hollow {
                let key = (Arc::as_ptr(&segment.material) as usize, hollow.q.to_bits());
                let twisted = match shared.entry(key) {
                    Entry::Occupied(entry) => entry.into_mut(),
                    Entry::Vacant(entry) => {
                        let curve = shear.in_torsion(hollow);
                        entry.insert(curve.map_err(|fault| self.no_nominal_curve(&given, &shear, &fault))?)
                    }
                };
                segment.material = Arc::clone(twisted);
            } else {
                segment.material = shear;
            }
            segment.area = round.polar / (torsion.radius * torsion.radius);
            segment.velocity *= torsion.radius;
            if let Some(profile) = &mut segment.profile {
                let velocity = profile.velocity.scaled(torsion.radius);
                *profile = Arc::new(InitialProfile { velocity, ..(**profile).clone() });
            }
            torsion.polar.push(round.polar);
        }
        Ok(torsion)
    }

    fn same_radius(&self, given: &Given<'_>, radius: f64, first: f64) -> Result<()> {
        if (radius / first - 1.0).abs() <= SAME_RADIUS {
            return Ok(());
        }
        let message = "in torsion all segments have one outer diameter (thin tubes: one mean diameter)";
        let span = given.diameter.map_or(given.span.clone(), Spanned::span);
        let error = self.error(span, &format!("{}.diameter", given.key), message);
        Err(error.allowed(format!("{} m", 2.0 * first)).help("change the section by `inner-diameter` instead").into())
    }

    fn round(&self, given: &Given<'_>) -> Result<Round> {
        if let Some(area) = given.area {
            let error = self.error(area.span(), &format!("{}.area", given.key), "an area says nothing of torsion");
            return Err(error.help("give the `diameter`; for a tube `inner-diameter` or `wall`, too").into());
        }
        let key = format!("{}.diameter", given.key);
        let Some(diameter) = given.diameter else {
            let help = "a bar in torsion is a round rod or tube: add e.g. diameter = \"20 mm\"";
            return Err(self.missing(given.span.clone(), &key, help));
        };
        let Section::Uniform(size) = diameter.get_ref() else {
            let error = self.error(diameter.span(), &key, "a taper in torsion is not followed");
            return Err(error.help("give one diameter; `inner-diameter` can differ from segment to segment").into());
        };
        let outer = Number::new(diameter.span(), size.clone());
        let outer = self.document.number(&outer, &key, Dimension::Length, Allowed::Positive)?;
        let (inner_key, wall_key) = (format!("{}.inner-diameter", given.key), format!("{}.wall", given.key));
        match (given.inner, given.wall) {
            (Some(_), Some(wall)) => {
                let error = self.error(wall.span(), &wall_key, "the tube has both an inner diameter and a wall");
                Err(error.help("keep `inner-diameter`, or `wall` for a thin tube").into())
            }
            (None, Some(wall)) => {
                let range = Allowed::Above(0.0, outer / THINNEST);
                let wall = self.document.number(wall, &wall_key, Dimension::Length, range)?;
                let radius = 0.5 * (outer - wall);
                Ok(Round { radius, polar: 2.0 * PI * radius.powi(3) * wall, hollow: None })
            }
            (inner, None) => {
                // Thinner walls than this are lost in rounding.
                let range = Allowed::Above(0.0, outer * (1.0 - 1e-6));
                let inner = self.document.optional(inner, &inner_key, Dimension::Length, range)?.unwrap_or(0.0);
                let q = inner / outer;
                let polar = PI / 32.0 * outer.powi(4) * (1.0 - q) * (1.0 + q) * (1.0 + q * q);
                Ok(Round { radius: 0.5 * outer, polar, hollow: Some(TubeSection { q }) })
            }
        }
    }

    fn in_shear(&self, raw: &RawBar, given: &Given<'_>, material: &Arc<Material>) -> Result<Arc<Material>> {
        if material.loading == Loading::Shear {
            return Ok(Arc::clone(material));
        }
        let refuse = |message: String, help: &str| {
            let span = given.material.clone().unwrap_or_else(|| given.span.clone());
            let error = self.error(span, &format!("{}.material", given.key), message);
            Err(error.help(help).into())
        };
        if raw.shear.is_none() {
            let message = format!("the curve of `{}` is one of tension, and the bar is twisted", material.name);
            let help = "give a material with loading = \"shear\" (shear stress against shear strain, `modulus` is the shear \
                        modulus), or say shear = \"von-mises\" in [bar], which converts the curve";
            return refuse(message, help);
        }
        match material.in_shear() {
            Ok(shear) => Ok(Arc::new(shear)),
            Err(why) => refuse(
                format!("`{}` cannot be converted to shear: {why}", material.name),
                "add it to the material, or give the curve in shear (loading = \"shear\")",
            ),
        }
    }

    /// What acts on a tension or compression alone, or knows lengths, areas or masses, is not there in torsion.
    pub(super) fn effects_of_torsion(&self, raw: &RawEffects) -> Result<()> {
        let goes_on = "take it out: a run says when the data of the curve end, or the torque can rise no more";
        let axial = "take it out, or use mode = \"axial\"";
        let spans = [
            ("rupture", raw.rupture.as_ref().map(Spanned::span), goes_on),
            ("heat", raw.heat.as_ref().map(Spanned::span), axial),
            ("damping", raw.damping.as_ref().map(Spanned::span), axial),
            ("lateral-inertia", raw.lateral_inertia.as_ref().map(Spanned::span), axial),
        ];
        let Some((name, Some(span), help)) = spans.into_iter().find(|(_, span, _)| span.is_some()) else {
            return Ok(());
        };
        let message = format!("`{name}` in torsion is not followed");
        Err(self.error(span, &format!("effects.{name}"), message).help(help).into())
    }

    /// The end under `key` of a bar in torsion of this radius; `polar` is J of the segment there.
    pub(super) fn twisted_end(
        &self,
        raw: &Spanned<RawEnd>,
        key: &str,
        [radius, polar]: [f64; 2],
    ) -> Result<EndCondition> {
        let (span, raw) = (raw.span(), raw.get_ref());
        let kind = *raw.kind.get_ref();
        self.only_keys_of_twist(raw, kind, key)?;
        let history = |dimension| self.history(raw, span.clone(), key, dimension);
        let number =
            |value, name, dimension, allowed| self.own_number((value, name, dimension, allowed), span.clone(), key);
        Ok(match kind {
            EndKind::Velocity => EndCondition::Velocity {
                history: history(Dimension::AngularVelocity)?.scaled(radius),
                release: self.release(raw, key)?,
            },
            EndKind::Stress => EndCondition::Stress { history: history(Dimension::Stress)? },
            EndKind::Torque => EndCondition::Stress { history: history(Dimension::Torque)?.scaled(radius / polar) },
            EndKind::Free => EndCondition::Free,
            EndKind::Fixed => EndCondition::Fixed,
            EndKind::Absorbing => EndCondition::Absorbing,
            EndKind::Dashpot => {
                let (value, dimension) = (raw.coefficient.as_ref(), Dimension::TorsionalDampingCoefficient);
                let coefficient = number(value, "coefficient", dimension, Allowed::NotNegative)?;
                EndCondition::Dashpot { coefficient: coefficient / (radius * radius) }
            }
            EndKind::Striker => {
                let (inertia, velocity) = (raw.inertia.as_ref(), raw.velocity.as_ref());
                let inertia = number(inertia, "inertia", Dimension::MomentOfInertia, Allowed::Positive)?;
                let velocity = number(velocity, "velocity", Dimension::AngularVelocity, Allowed::Finite)?;
                EndCondition::Striker { mass: inertia / (radius * radius), velocity: radius * velocity }
            }
            EndKind::Spring => {
                let (value, dimension) = (raw.stiffness.as_ref(), Dimension::TorsionalStiffness);
                let stiffness = number(value, "stiffness", dimension, Allowed::Positive)?;
                EndCondition::Spring { stiffness: stiffness / (radius * radius) }
            }
            EndKind::Ball => self.ball_on_lever(raw, span, key, radius)?,
            EndKind::Wall => return Err(self.not_in_torsion(raw, key)),
        })
    }

    fn not_in_torsion(&self, raw: &RawEnd, key: &str) -> Error {
        let message = format!("an end of kind \"{}\" means nothing in torsion", raw.kind.get_ref().word());
        let error = self.error(raw.kind.span(), &format!("{key}.kind"), message);
        let allowed = "velocity, stress, torque, free, fixed, absorbing, dashpot, striker, ball, spring";
        error.allowed(allowed).help("use kind = \"fixed\" or \"free\", or drive the end").into()
    }

    fn only_keys_of_twist(&self, raw: &RawEnd, kind: EndKind, key: &str) -> Result<()> {
        let keys: &[&str] = match kind {
            EndKind::Striker => &["inertia", "velocity"],
            EndKind::Ball => {
                &["arm", "radius", "diameter", "velocity", "mass", "density", "material", "modulus", "poisson"]
            }
            // Refused by name.
            EndKind::Wall => return Ok(()),
            kind => kind.keys(),
        };
        let Some((name, span)) = given(raw).into_iter().find(|(name, _)| !keys.contains(name)) else { return Ok(()) };
        let message = format!("`{name}` means nothing for an end of kind \"{}\" in torsion", kind.word());
        let allowed = if keys.is_empty() { "kind alone".to_owned() } else { format!("kind, {}", keys.join(", ")) };
        let help =
            if name == "mass" { "give the striker's `inertia`, e.g. inertia = \"2 kg*m^2\"" } else { "take it out" };
        Err(self.error(span, &format!("{key}.{name}"), message).allowed(allowed).help(help).into())
    }
}
