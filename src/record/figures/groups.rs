//! Grouping of the figures of a run by place.

use super::contact::{Site, sites};
use super::definitions::{BAR, END, FRAGMENT, Figured, GAUGE, JOINT, LOAD, PART, RESIDUAL_PROFILE};
use super::records::{Absorbed, Records, SegmentEnd, SegmentResults};
use super::{Figures, Group, Profile};
use crate::bar::Joint;

/// Largest number of fragments that the summary prints.
const MAX_FRAGMENTS_SHOWN: usize = 12;

impl Records<'_> {
    /// Computes the figures that exist.
    pub fn figures(&self) -> Figures {
        let mut groups = vec![self.whole()];
        let (ends, joints) = sites(self);
        let names = [("left", "load at left end"), ("right", "load at right end")];
        for ((path, label), site) in names.iter().zip(&ends) {
            groups.push(place(&[path], label, site, END));
        }
        for (k, site) in joints.iter().enumerate() {
            let number = (k + 1).to_string();
            groups.push(place(&["joints", &number], &format!("load at joint {number}"), site, JOINT));
        }
        for (name, gauge) in self.gauges.iter().zip(&self.tally.gauges) {
            groups.push(group(&["gauges", name], &format!("gauge {name}"), true, GAUGE.figures(gauge)));
        }
        if self.segments.len() > 1 {
            groups.extend((0..self.segments.len()).map(|k| self.segment(k)));
        }
        groups.extend(self.fragments.all().iter().enumerate().map(|(k, fragment)| {
            let number = (k + 1).to_string();
            let figures = FRAGMENT.figures(&(*fragment, self.bar.area_given));
            group(&["fragments", &number], &format!("fragment {number}"), k < MAX_FRAGMENTS_SHOWN, figures)
        }));
        groups.retain(|group| !group.figures.is_empty());
        Figures(groups)
    }

    fn whole(&self) -> Group {
        let mut end = SegmentEnd::default();
        self.segments.iter().for_each(|segment| end.add(segment));
        let inner = &self.bar.segments[..self.bar.segments.len() - 1];
        let bonded = inner.iter().all(|segment| segment.joint == Joint::Bonded);
        let length = self.bar.length();
        let energies = &self.account.energies;
        let absorbed =
            energies.plastic + energies.heat + energies.viscoplastic + energies.concentrated + energies.fracture;
        let volume: f64 = self.bar.segments.iter().map(|segment| segment.area * segment.length).sum();
        let part = SegmentResults {
            length: (bonded && !self.is_twisted()).then(|| lengths(length, &end)),
            twist: self.radius().filter(|_| bonded).map(|radius| twist(radius, length, &end)),
            end,
        };
        let absorbed = Absorbed {
            energy: self.bar.area_given.then_some(absorbed),
            // The strains within a twisted section differ from those of its surface.
            per_volume: (!self.is_twisted()).then(|| absorbed / volume),
        };
        let figures = [PART.figures(&part), BAR.figures(&absorbed)].concat();
        let (name, description) = RESIDUAL_PROFILE;
        let profile = Some(Profile { name, description, values: self.residual_profile.to_vec() });
        Group { profile, ..group(&[], "bar", end.accumulated > 0.0, figures) }
    }

    fn segment(&self, k: usize) -> Group {
        let (end, length) = (self.segments[k], self.bar.segments[k].length);
        let twist = self.radius().map(|radius| twist(radius, length, &end));
        let length = (!self.is_twisted()).then(|| lengths(length, &end));
        let part = SegmentResults { length, twist, end };
        let number = (k + 1).to_string();
        group(&["segments", &number], &format!("segment {number}"), end.accumulated > 0.0, PART.figures(&part))
    }
}

/// Returns the undeformed length and the length after elastic unloading, m.
fn lengths(length: f64, end: &SegmentEnd) -> [f64; 2] {
    [length, length + beyond_rounding(end.plastic_elongation, length)]
}

/// Returns the rotation of the right end relative to the left one, at the end of the run and after elastic unloading,
/// rad. The surface moves by the radius times the rotation.
fn twist(radius: f64, length: f64, end: &SegmentEnd) -> [f64; 2] {
    [end.elongation, end.plastic_elongation].map(|moved| beyond_rounding(moved, length) / radius)
}

/// Replaces an elongation by 0 if it is within the rounding of the length.
fn beyond_rounding(elongation: f64, length: f64) -> f64 {
    if elongation.abs() > 1e-11 * length { elongation } else { 0.0 }
}

fn place(path: &[&str], label: &str, site: &Site, more: &[super::Definition<Site>]) -> Group {
    let figures = LOAD.figures(site).into_iter().chain(more.figures(site)).collect();
    group(path, label, site.load.peak.largest.value != 0.0, figures)
}

fn group(path: &[&str], label: &str, in_summary: bool, figures: Vec<super::Figure>) -> Group {
    let path = path.iter().map(|&part| part.to_owned()).collect();
    Group { path, label: label.to_owned(), in_summary, figures, profile: None }
}
