//! The two ends: conversion of each kind (in torsion to quantities of the surface), and the prescribed histories.

use std::ops::Range;

use super::super::raw::{EndKind, RawEnd, RawHistory};
use super::{Checker, Torsion};
use crate::bar::{Bar, EndCondition, History, Segment};
use crate::error::{Error, Result};
use crate::input::Table;
use crate::typed::{Key, Of, Placed};
use crate::units::Measure;

/// End that is read: its key and position in the file, the segment there, and the radius of the surface, m, and J, m^4; both 1 in an axial bar.
pub(super) struct EndSite<'a> {
    pub(super) key: &'a str,
    pub(super) span: Range<usize>,
    pub(super) segment: &'a Segment,
    pub(super) radius: f64,
    polar: f64,
}

impl<'a> EndSite<'a> {
    pub(super) fn new(
        (key, span): (&'a str, Range<usize>),
        bar: &'a Bar,
        at: usize,
        torsion: Option<&Torsion>,
    ) -> Self {
        let (radius, polar) = torsion.map_or((1.0, 1.0), |torsion| (torsion.radius, torsion.polar[at]));
        Self { key, span, segment: &bar.segments[at], radius, polar }
    }
}

impl Checker<'_> {
    /// Returns the condition of an end, and the ratio of the arm of its lever to the radius of the surface.
    pub(super) fn end(
        &self,
        site: &EndSite<'_>,
        mut table: Table<'_>,
        area_given: bool,
    ) -> Result<(EndCondition, f64)> {
        let kind = RawEnd::kind(&mut table)?;
        self.kind_has_meaning(&kind, site.key, area_given)?;
        let raw = RawEnd::read(self.document, site.key, *kind.get_ref(), table, self.torsion)?;
        let (radius, polar) = (site.radius, site.polar);
        let lever = if let RawEnd::BallOnLever(raw) = &raw { self.si(&raw.arm)? / radius } else { 1.0 };
        let end = match raw {
            RawEnd::Velocity(raw) => EndCondition::Velocity {
                history: self.history(&raw.history_keys(), site)?.scaled(radius),
                release: self.si(&raw.release)?,
            },
            RawEnd::Stress(raw) => EndCondition::Stress { history: self.history(&raw.history_keys(), site)? },
            RawEnd::Torque(raw) => {
                EndCondition::Stress { history: self.history(&raw.history_keys(), site)?.scaled(radius / polar) }
            }
            RawEnd::Free(_) => EndCondition::Free,
            RawEnd::Fixed(_) => EndCondition::Fixed,
            RawEnd::Absorbing(_) => EndCondition::Absorbing,
            RawEnd::Dashpot(raw) => {
                EndCondition::Dashpot { coefficient: self.si(&raw.coefficient)? / (radius * radius) }
            }
            RawEnd::Wall(raw) => EndCondition::Wall { gap: self.si(&raw.gap)? },
            RawEnd::Striker(raw) => {
                EndCondition::Striker { mass: self.si(&raw.mass)?, velocity: self.si(&raw.velocity)? }
            }
            RawEnd::TwistingStriker(raw) => EndCondition::Striker {
                mass: self.si(&raw.inertia)? / (radius * radius),
                velocity: radius * self.si(&raw.velocity)?,
            },
            RawEnd::Ball(raw) => self.ball(&raw, site)?,
            RawEnd::BallOnLever(raw) => self.ball_on_lever(&raw, site)?,
            RawEnd::Spring(raw) => EndCondition::Spring { stiffness: self.si(&raw.stiffness)? / (radius * radius) },
        };
        Ok((end, lever))
    }

    fn kind_has_meaning(&self, kind: &Placed<EndKind>, key: &str, area_given: bool) -> Result<()> {
        match kind.get_ref() {
            EndKind::Wall if self.torsion => Err(self.not_in_torsion(kind, key)),
            _ if self.torsion => Ok(()),
            EndKind::Torque => Err(self.only_in_torsion(kind, key)),
            EndKind::Dashpot | EndKind::Striker | EndKind::Ball | EndKind::Spring if !area_given => {
                Err(self.needs_area(kind, key))
            }
            _ => Ok(()),
        }
    }

    fn only_in_torsion(&self, kind: &Placed<EndKind>, key: &str) -> Error {
        let message = "a torque acts on a bar in torsion only";
        let error = self.error(kind.span(), &format!("{key}.kind"), message);
        error.help("use kind = \"stress\", or [bar] mode = \"torsion\"").into()
    }

    fn not_in_torsion(&self, kind: &Placed<EndKind>, key: &str) -> Error {
        let message = format!("an end of kind \"{}\" is not available in torsion", kind.get_ref().word());
        let error = self.error(kind.span(), &format!("{key}.kind"), message);
        let others = EndKind::ALL.iter().filter(|other| *other != kind.get_ref());
        let others: Vec<&str> = others.map(|other| other.word()).collect();
        error
            .allowed(others.join(", "))
            .help("use kind = \"fixed\" or \"free\", or impose a velocity or a torque")
            .into()
    }

    /// Returns the error for a body at an end of a bar without an area: it acts on the whole section, so that its mass or stiffness would be
    /// meaningless.
    fn needs_area(&self, kind: &Placed<EndKind>, key: &str) -> Error {
        let word = kind.get_ref().word();
        let message = format!("an end of kind \"{word}\" needs the cross-section of the bar");
        let help = "give [bar] (or every [[bar.segment]]) an area, e.g. area = \"1 cm^2\", or a diameter";
        self.error(kind.span(), &format!("{key}.kind"), message).help(help).into()
    }

    /// Reads a number that is required.
    pub(in crate::scene) fn needed<D: Measure, R: crate::typed::Range>(
        &self,
        given: Option<&Of<D, R>>,
        name: &str,
        span: Range<usize>,
        key: &str,
    ) -> Result<f64> {
        let Some(given) = given else {
            let help = format!("add {}, e.g. {name} = \"{}\"", D::DIMENSION.describe(), D::DIMENSION.example());
            return Err(self.missing(span, &format!("{key}.{name}"), &help));
        };
        self.si(given)
    }

    /// Reads the history of a driven end, from exactly one of its three forms.
    fn history<D: Measure>(&self, keys: &RawHistory<'_, D>, site: &EndSite<'_>) -> Result<History> {
        let key = site.key;
        let forms = [
            ("value", keys.value.place()),
            ("history", keys.history.map(Placed::span)),
            ("csv", keys.csv.map(Placed::span)),
        ];
        self.at_most_one(key, forms)?;
        if let Some(value) = keys.value {
            return self.si(value).map(History::constant);
        }
        if let Some(rows) = keys.history {
            let key = format!("{key}.history");
            let pairs = rows.get_ref().pairs(self.document, self.torsion, &key, ["time", "value"])?;
            return History::new(&pairs).map_err(|error| {
                let row = error.at();
                let span = rows.get_ref().place(row).unwrap_or_else(|| rows.span());
                self.error(span, &format!("{key}.{row}"), error.to_string()).allowed(ROWS).help(ROWS_HELP).into()
            });
        }
        if let Some(file) = keys.csv {
            return self.history_file(file, &format!("{key}.csv"));
        }
        let unit = self.dimension::<D>().example();
        let help = format!("add value = \"{unit}\", or history = [[\"0 us\", \"{unit}\"], ...], or csv = \"file.csv\"");
        Err(self.missing(site.span.clone(), &format!("{key}.value"), &help))
    }
}

/// Conditions for the rows of a history.
pub(super) const ROWS: &str = "times do not decrease; at most two rows have the same time";
/// Help on how to write the rows of a history.
pub(super) const ROWS_HELP: &str = "sort the rows by time; two rows with the same time are a jump";
