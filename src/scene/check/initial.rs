//! Initial stresses and plastic strains: what a segment can start with.

use std::ops::Range;

use toml::Spanned;

use super::super::raw::{RawBar, RawEffects};
use super::super::{Effects, Unloading};
use super::Checker;
use crate::bar::{Bar, Segment};
use crate::error::Result;
use crate::law::Table;
use crate::law::rate::Hardening;
use crate::material::Sense;

/// The key and place of a segment's initial stress, and of its initial plastic strain.
struct Given {
    stress: (String, Option<Range<usize>>),
    plastic_strain: (String, Option<Range<usize>>),
}

impl Given {
    /// Of the one that was given, the plastic strain first.
    fn any(&self) -> Option<(&str, Range<usize>)> {
        let both = [&self.plastic_strain, &self.stress];
        both.into_iter().find_map(|(key, span)| span.clone().map(|span| (key.as_str(), span)))
    }
}

/// Of every segment of a bar.
fn all_given(raw: &RawBar) -> Vec<Given> {
    let given = |key: &str, stress: Option<Range<usize>>, plastic: Option<Range<usize>>| Given {
        stress: (format!("{key}.stress"), stress),
        plastic_strain: (format!("{key}.plastic-strain"), plastic),
    };
    let span = |number: &Option<crate::input::Number>| number.as_ref().map(Spanned::span);
    let Some(list) = &raw.segment else { return vec![given("bar", span(&raw.stress), span(&raw.plastic_strain))] };
    let of = |(i, segment): (usize, &Spanned<super::super::raw::RawSegment>)| {
        let segment = segment.get_ref();
        given(&format!("bar.segment.{i}"), span(&segment.stress), span(&segment.plastic_strain))
    };
    list.iter().enumerate().map(of).collect()
}

impl Checker<'_> {
    /// Initial states that the materials can have, under effects that allow them.
    pub(super) fn initial_states(
        &self,
        raw: &RawBar,
        raw_effects: &RawEffects,
        effects: &Effects,
        bar: &Bar,
    ) -> Result<()> {
        for (given, segment) in all_given(raw).iter().zip(&bar.segments) {
            let Some((key, span)) = given.any() else { continue };
            if raw_effects.along().is_some() {
                let message = "initial stresses and plastic strains do not go with `damping` and `lateral-inertia`";
                return Err(self.error(span, key, message).help("take one of them out").into());
            }
            if let (key, Some(span)) = &given.plastic_strain {
                self.can_have_yielded(key, span.clone(), effects, segment)?;
            }
            self.stress_is_elastic(given, effects, segment)?;
        }
        Ok(())
    }

    fn can_have_yielded(&self, key: &str, span: Range<usize>, effects: &Effects, segment: &Segment) -> Result<()> {
        let plastic = segment.initial.plastic_strain;
        if effects.unloading.is_none() && effects.rate.is_none() {
            let message = "plastic strain needs a law of unloading: without it the curve is followed both ways";
            return Err(self.error(span, key, message).help("add unloading = \"isotropic\" to [effects]").into());
        }
        if effects.heat.is_some() {
            let message =
                "an initial plastic strain does not go with the effect `heat`, whose curve starts from a cold bar";
            return Err(self.error(span, key, message).help("take one of them out").into());
        }
        let (material, sense) = (&segment.material, Sense::of(plastic));
        let table = Table::new(material.branch(sense), material.modulus);
        let most = table.plastic_strain(table.end()) / material.modulus;
        if plastic.abs() > most {
            let name = &material.name;
            let message = format!("an initial plastic strain of {plastic} is beyond the data of {name}");
            let allowed = format!("at most {most:.4} in size, the plastic strain at the end of the curve");
            return Err(self.error(span, key, message).allowed(allowed).into());
        }
        Ok(())
    }

    fn stress_is_elastic(&self, given: &Given, effects: &Effects, segment: &Segment) -> Result<()> {
        let [low, high] = elastic_range(segment, effects);
        let stress = segment.initial.stress;
        if (low..=high).contains(&stress) {
            return Ok(());
        }
        let (key, span) = (given.stress.0.as_str(), given.stress.1.clone());
        let (key, span) = span.map_or_else(|| given.any().unwrap_or((key, 0..0)), |span| (key, span));
        let message = format!("an initial stress of {stress:.6e} Pa is outside the elastic range");
        let allowed = format!("{low:.6e} Pa to {high:.6e} Pa with this plastic strain");
        let help = "state the plastic strain with which the material carries this stress: `plastic-strain`";
        Err(self.error(span, key, message).allowed(allowed).help(help).into())
    }
}

/// Stresses between which a segment with its initial plastic strain is elastic, Pa.
fn elastic_range(segment: &Segment, effects: &Effects) -> [f64; 2] {
    let (material, plastic) = (&segment.material, segment.initial.plastic_strain);
    let p = material.modulus * plastic.abs();
    let hardening = |sense| Hardening::new(&Table::new(material.branch(sense), material.modulus));
    let [tension, compression] = [Sense::Tension, Sense::Compression].map(hardening);
    let flow = |side: &Hardening| {
        let pieces = side.pieces();
        pieces[side.find(p) as usize].at(p)
    };
    let kinematic = match effects.unloading {
        None | Some(Unloading::Isotropic) => return [-flow(&compression), flow(&tension)],
        Some(Unloading::Kinematic) => 1.0,
        Some(Unloading::Mixed(fraction)) => fraction,
    };
    // Hardening that moves the range needs one curve for both senses.
    let (first, grown) = (tension.yield_stress(), flow(&tension) - tension.yield_stress());
    let back = (kinematic * grown).copysign(plastic);
    let half = first + (1.0 - kinematic) * grown;
    [back - half, back + half]
}
