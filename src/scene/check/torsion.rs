//! Bars in torsion: allowed keys, and the conversion to quantities of the surface, i.e. to a bar in tension with the area J/R^2, see
//! [`crate::material::TubeSection`] and [`crate::scene::Torsion`].

use std::collections::HashMap;
use std::collections::hash_map::Entry;
use std::f64::consts::PI;
use std::ops::Range;
use std::sync::Arc;

use super::super::Torsion;
use super::super::raw::{RawBar, RawPiece};
use super::Checker;
use crate::bar::{Bar, InitialProfile};
use crate::error::{InputError, Result};
use crate::input::Allowed;
use crate::material::{CurveError, Loading, Material, TubeSection};
use crate::typed::Placed;
use crate::units::Dimension;

/// Smallest ratio of diameter to wall thickness of a tube whose stress is taken as uniform over the wall; the error of J is then at most 0.3 %.
const THINNEST: f64 = 20.0;

/// Relative difference up to which radii count as equal.
const SAME_RADIUS: f64 = 1e-9;

/// Keys of the section of one segment.
struct Given<'a> {
    piece: RawPiece<'a>,
    key: String,
    span: Range<usize>,
}

/// Round section: the radius at which stress and strain are given, m, J, m^4, and the tube section for the integration (`None` for a thin tube).
struct Round {
    radius: f64,
    polar: f64,
    hollow: Option<TubeSection>,
    /// Wall thickness of a thin tube, m.
    wall: Option<f64>,
}

fn all_given(raw: &Placed<RawBar>) -> Vec<Given<'_>> {
    let (span, raw) = (raw.span(), raw.get_ref());
    let Some(list) = &raw.segment else {
        return vec![Given { piece: raw.piece(), key: "bar".into(), span }];
    };
    let segments = list.iter().enumerate();
    segments
        .map(|(i, segment)| Given {
            piece: segment.get_ref().piece(),
            key: format!("bar.segment.{i}"),
            span: segment.span(),
        })
        .collect()
}

impl Given<'_> {
    /// Returns the position of the material, or that of the segment if it has none.
    fn material(&self) -> Range<usize> {
        self.piece.material.map_or_else(|| self.span.clone(), Placed::span)
    }
}

impl Checker<'_> {
    /// Refuses keys and materials of torsion in an axial bar.
    pub(super) fn nothing_of_torsion(&self, raw: &Placed<RawBar>, bar: &Bar) -> Result<()> {
        if let Some(shear) = &raw.get_ref().shear {
            let error = self.error(shear.span(), "bar.shear", "`shear` does not apply to an axial bar");
            return Err(error.help("remove it, or set mode = \"torsion\" in [bar]").into());
        }
        for (given, segment) in all_given(raw).into_iter().zip(&bar.segments) {
            for (name, value) in [("inner-diameter", given.piece.inner_diameter), ("wall", given.piece.wall)] {
                if let Some(value) = value {
                    let message = format!("`{name}` applies to a bar in torsion only");
                    let error = self.error(value.span(), &format!("{}.{name}", given.key), message);
                    return Err(error
                        .help("give the `area` of the section, or set mode = \"torsion\" in [bar]")
                        .into());
                }
            }
            if segment.material.loading == Loading::Shear {
                let message = format!("`{}` has a shear curve, and the bar is axial", segment.material.name);
                let error = self.error(given.material(), &format!("{}.material", given.key), message);
                return Err(error
                    .help("set mode = \"torsion\" in [bar], or use a material with a tension curve")
                    .into());
            }
        }
        Ok(())
    }

    fn no_nominal_curve(&self, given: &Given, shear: &Material, fault: &CurveError) -> InputError {
        let message =
            format!("the shear curve of `{}` cannot be converted to torque against twist: {fault}", shear.name);
        let help = "end its table at strains that can occur, or give a thin-walled section";
        self.error(given.material(), &format!("{}.material", given.key), message).help(help)
    }

    /// Converts a bar, as read, to quantities of its surface.
    pub(super) fn twist(&self, raw: &Placed<RawBar>, bar: &mut Bar) -> Result<Torsion> {
        let mut torsion = Torsion { radius: 0.0, polar: Vec::new(), levers: [1.0; 2] };
        // Each distinct material with each distinct section is converted once and shared by its segments.
        let mut shared: HashMap<(usize, u64), Arc<Material>> = HashMap::new();
        for (k, given) in all_given(raw).into_iter().enumerate() {
            let segment = &mut bar.segments[k];
            let round = self.round(&given)?;
            if k == 0 {
                torsion.radius = round.radius;
            }
            self.same_radius(&given, &round, torsion.radius)?;
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

    fn same_radius(&self, given: &Given<'_>, round: &Round, first: f64) -> Result<()> {
        if (round.radius / first - 1.0).abs() <= SAME_RADIUS {
            return Ok(());
        }
        let (common, own) = (2.0 * first, 2.0 * round.radius);
        let (kind, allowed) = match round.wall {
            Some(wall) => ("mean", common + wall),
            None => ("outer", common),
        };
        let message = format!(
            "in torsion all segments have one diameter, rods and thick tubes the outer one, thin tubes (`wall`) the mean one: the {kind} diameter here \
             is {own} m, that of the first segment {common} m"
        );
        let span = given.piece.diameter.map_or(given.span.clone(), Placed::span);
        let error = self.error(span, &format!("{}.diameter", given.key), message);
        Err(error.allowed(format!("{allowed} m")).help("change the section by `inner-diameter` instead").into())
    }

    fn round(&self, given: &Given<'_>) -> Result<Round> {
        if let Some(area) = given.piece.area {
            let error =
                self.error(area.span(), &format!("{}.area", given.key), "an area does not define a section in torsion");
            return Err(error.help("give the `diameter`; for a tube `inner-diameter` or `wall`, too").into());
        }
        let key = format!("{}.diameter", given.key);
        let Some(diameter) = given.piece.diameter else {
            let help = "a bar in torsion is a round rod or tube: add e.g. diameter = \"20 mm\"";
            return Err(self.missing(given.span.clone(), &key, help));
        };
        let Some(size) = diameter.given().uniform() else {
            let error = self.error(diameter.span(), &key, "a taper is not simulated in torsion");
            return Err(error.help("give one diameter; `inner-diameter` can differ from segment to segment").into());
        };
        let outer = self.document.number_at(&size, Dimension::Length, Allowed::Positive)?;
        match (given.piece.inner_diameter, given.piece.wall) {
            (Some(_), Some(wall)) => {
                let key = format!("{}.wall", given.key);
                let error = self.error(wall.span(), &key, "the tube has both an inner diameter and a wall");
                Err(error.help("keep `inner-diameter`, or `wall` for a thin tube").into())
            }
            (None, Some(wall)) => {
                let range = Allowed::Above(0.0, outer / THINNEST);
                let wall = wall.si_within(self.document, range)?;
                let radius = 0.5 * (outer - wall);
                Ok(Round { radius, polar: 2.0 * PI * radius.powi(3) * wall, hollow: None, wall: Some(wall) })
            }
            (inner, None) => {
                // Thinner walls than this would be lost in rounding.
                let range = Allowed::Above(0.0, outer * (1.0 - 1e-6));
                let inner = inner.map_or(Ok(0.0), |inner| inner.si_within(self.document, range))?;
                let q = inner / outer;
                let polar = PI / 32.0 * outer.powi(4) * (1.0 - q) * (1.0 + q) * (1.0 + q * q);
                Ok(Round { radius: 0.5 * outer, polar, hollow: Some(TubeSection { q }), wall: None })
            }
        }
    }

    fn in_shear(&self, raw: &RawBar, given: &Given<'_>, material: &Arc<Material>) -> Result<Arc<Material>> {
        if material.loading == Loading::Shear {
            return Ok(Arc::clone(material));
        }
        let refuse = |message: String, help: &str| {
            let error = self.error(given.material(), &format!("{}.material", given.key), message);
            Err(error.help(help).into())
        };
        if raw.shear.is_none() {
            let message = format!("`{}` has a tension curve, and the bar is in torsion", material.name);
            let help = "give a material with loading = \"shear\" (shear stress against shear strain, `modulus` is the shear \
                        modulus), or set shear = \"von-mises\" in [bar], which converts the curve";
            return refuse(message, help);
        }
        match material.in_shear() {
            Ok(shear) => Ok(Arc::new(shear)),
            Err(why) => refuse(
                format!("`{}` cannot be converted to shear: {}", material.name, why.message),
                "add it to the material, or give the curve in shear (loading = \"shear\")",
            ),
        }
    }
}
