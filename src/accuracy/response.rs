//! Response of a bar: the quantities compared between two runs.

use serde::{Deserialize, Serialize};

use super::Shape;
use super::joint_forces::{JointForces, Peak};
use crate::record::{ErrorTable, Measure};

/// Lower bound of the norm of a signal: its largest value over this fraction of the bar, or of the time.
const FLOOR: f64 = 0.01;

/// Strain below which stresses are rounding errors of a moving bar: the largest stress counts as at least that of this strain.
const ROUNDING_STRAIN: f64 = 1e-12;

/// Lower bound of the norm of the stress at the end time, relative to its mean over time: the remaining oscillation of
/// a bar that has rung down is not a suitable reference.
const OF_MEAN: f64 = 0.1;

/// Fraction of the largest force in the bar below which a peak force is negligible.
const NO_PEAK: f64 = 1e-3;

/// Smallest number of instants that are compared, if memory allows.
pub const INSTANTS: usize = 32;

/// Response of a bar up to the last of its instants.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct Response {
    /// Stress over the bar, Pa, at instants (s, increasing).
    pub fields: Vec<(f64, Shape)>,
    /// Plastic strain over the bar at the last instant.
    pub plastic: Option<Shape>,
    /// Stress at the left and right end over time, Pa.
    pub ends: Vec<Shape>,
    /// Stress at the gauges over time, Pa.
    pub gauges: Vec<Shape>,
    /// Peak forces of the left and the right end and of the joints.
    pub peaks: Vec<Peak>,
    /// Cross-sections of the ends, m^2.
    pub sections: [f64; 2],
    /// Smallest cross-section of the bar, m^2.
    pub least_section: f64,
    /// Lengths of the segments from left to right, m.
    pub lengths: Vec<f64>,
    /// Largest Young's modulus, Pa.
    pub modulus: f64,
}

/// Quantities to which differences of stress and strain are related.
struct Scale {
    /// Largest magnitude of the stress anywhere, Pa.
    stress: f64,
    /// Lower bound of the largest force in the bar, N.
    force: f64,
    /// Integral of |stress| over the bar, averaged over time, Pa m.
    field: f64,
    /// Lower bound of the largest strain.
    strain: f64,
    /// Duration of the response, s.
    duration: f64,
    length: f64,
    /// Total length of the segments that flow, m; of all segments if none flows.
    flowing: f64,
}

impl Response {
    /// Returns the last instant, s.
    pub fn time(&self) -> f64 {
        self.fields.last().map_or(0.0, |field| field.0)
    }

    /// Returns the instants of the fields, s, increasing.
    pub fn instants(&self) -> Vec<f64> {
        self.fields.iter().map(|field| field.0).collect()
    }

    /// Returns the errors against a reference, which must contain a field at (nearly) each instant of this response.
    pub fn errors(&self, reference: &Self) -> ErrorTable {
        self.difference(reference, reference)
    }

    /// Returns the differences from another response, relative to a third one, so that the differences of several pairs have the same scale.
    pub fn difference(&self, other: &Self, relative_to: &Self) -> ErrorTable {
        let scale = relative_to.scale();
        let over = |(apart, total): (f64, f64), floor: f64| {
            let scale = total.max(floor);
            if apart == 0.0 { 0.0 } else { apart / scale }
        };
        let (over_bar, over_time) = (FLOOR * scale.stress * scale.length, FLOOR * scale.stress * scale.duration);
        ErrorTable::of(|measure| match measure {
            Measure::Field => {
                let (apart, instants) = self.field_difference(other)?;
                Some(over((apart / instants, scale.field), over_bar))
            }
            Measure::FieldAtEnd => {
                let (time, own) = self.fields.last()?;
                let (reference, by) = (&other.nearest(*time)?.1, &relative_to.nearest(*time)?.1);
                let total = by.l1_difference(by).1.max(OF_MEAN * scale.field);
                Some(over((own.l1_difference(reference).0, total), over_bar))
            }
            Measure::Ends => {
                let apart: f64 = self.ends.iter().zip(&other.ends).map(|(own, other)| own.l1_difference(other).0).sum();
                let total: f64 = relative_to.ends.iter().map(|end| end.l1_difference(end).1).sum();
                Some(over((apart, total), over_time))
            }
            Measure::Gauges => {
                let gauges = self.gauges.iter().zip(&other.gauges).zip(&relative_to.gauges);
                let relative = gauges
                    .map(|((own, other), by)| over((own.l1_difference(other).0, by.l1_difference(by).1), over_time));
                relative.reduce(f64::max)
            }
            Measure::ResidualStrain => {
                let (own, other, by) = (self.plastic.as_ref()?, other.plastic.as_ref()?, relative_to.plastic.as_ref()?);
                Some(over((own.l1_difference(other).0, by.l1_difference(by).1), FLOOR * scale.strain * scale.flowing))
            }
            Measure::PeakForce => self.peaks_apart(other, relative_to, NO_PEAK * scale.force),
        })
    }

    /// Returns the largest relative difference of the peak forces above `least` (N), each relative to its own force.
    /// Returns `None` if all these peaks are without a limit.
    fn peaks_apart(&self, other: &Self, relative_to: &Self, least: f64) -> Option<f64> {
        let peaks = self.peaks.iter().zip(&other.peaks).zip(&relative_to.peaks);
        let (mut largest, mut unlimited) = (None, false);
        for ((own, other), by) in peaks.filter(|((own, other), _)| own.force.max(other.force) > least) {
            if own.has_no_limit || other.has_no_limit {
                unlimited = true;
            } else {
                let relative = (own.force - other.force).abs() / by.force.max(least);
                largest = Some(largest.map_or(relative, |largest: f64| largest.max(relative)));
            }
        }
        largest.or((!unlimited).then_some(0.0))
    }

    /// Sets the peaks of the ends, given as forces on a section of 1 m^2, and of the joints.
    #[must_use]
    pub(super) fn with_peaks(mut self, ends: [Peak; 2], joints: &JointForces) -> Self {
        let ends = ends.into_iter().zip(self.sections);
        let ends = ends.map(|(peak, section)| Peak { force: peak.force * section, ..peak });
        self.peaks = ends.chain(joints.peaks()).collect();
        self
    }

    /// Returns the field nearest in time.
    fn nearest(&self, time: f64) -> Option<&(f64, Shape)> {
        self.fields.iter().min_by(|a, b| (a.0 - time).abs().total_cmp(&(b.0 - time).abs()))
    }

    /// Returns the sum of the differences at all instants that both responses contain, and the number of these instants.
    fn field_difference(&self, other: &Self) -> Option<(f64, f64)> {
        let (mut sum, mut count) = (0.0, 0.0);
        let gap = if self.fields.len() > 1 { 0.5 * self.time() / self.fields.len() as f64 } else { f64::INFINITY };
        for (time, shape) in &self.fields {
            let nearest = other.nearest(*time)?;
            if (nearest.0 - time).abs() < gap {
                sum += shape.l1_difference(&nearest.1).0;
                count += 1.0;
            }
        }
        (count > 0.0).then_some((sum, count))
    }

    fn scale(&self) -> Scale {
        let field: f64 = self.fields.iter().map(|(_, shape)| shape.l1_difference(shape).1).sum();
        let peaks = self.fields.iter().map(|(_, shape)| shape).chain(&self.ends).chain(&self.gauges);
        let stress = peaks.map(Shape::largest).fold(ROUNDING_STRAIN * self.modulus, f64::max);
        let plastic = self.plastic.as_ref().map_or(0.0, Shape::largest);
        let length = self.lengths.iter().sum();
        Scale {
            stress,
            force: self.peaks.iter().map(|peak| peak.force).fold(stress * self.least_section, f64::max),
            field: field / (self.fields.len() as f64).max(1.0),
            strain: plastic.max(stress / self.modulus),
            duration: self.time(),
            length,
            flowing: self.flowing(FLOOR * plastic).unwrap_or(length),
        }
    }

    /// Returns the total length of the segments with a larger plastic strain than `least` anywhere, m; `None` if there
    /// are none. With this length the weight of a short specimen between long bars is not reduced.
    fn flowing(&self, least: f64) -> Option<f64> {
        let plastic = self.plastic.as_ref()?;
        let mut to = 0.0;
        let flows = self.lengths.iter().filter(|length| {
            let from = to;
            to += *length;
            plastic.largest_between([from, to]) > least
        });
        Some(flows.sum()).filter(|&length| length > 0.0)
    }
}

/// Returns at most `most` of the times (increasing), evenly spaced and including the last one; all of them if there are
/// no more. If `most` is halved, the selected times are a subset of those selected before.
pub fn evenly(times: &[f64], most: usize) -> Vec<f64> {
    let mut every = 1;
    while times.len().div_ceil(every) > most.max(1) {
        every *= 2;
    }
    let mut kept: Vec<f64> = times.iter().rev().step_by(every).copied().collect();
    kept.reverse();
    kept
}

#[cfg(test)]
mod tests {
    use super::*;

    fn response(front: f64, level: f64) -> Response {
        let steps = |edge: f64| Shape::Steps { edges: vec![edge], values: vec![level, 0.0], ends: [0.0, 1.0] };
        Response {
            fields: vec![(0.5, steps(0.5 * front)), (1.0, steps(front))],
            plastic: Some(Shape::Steps { edges: vec![], values: vec![0.0], ends: [0.0, 1.0] }),
            ends: vec![Shape::Steps { edges: vec![], values: vec![level], ends: [0.0, 1.0] }; 2],
            gauges: vec![],
            peaks: vec![Peak { force: level, has_no_limit: false }; 2],
            sections: [1.0; 2],
            least_section: 1.0,
            lengths: vec![1.0],
            modulus: 1e3,
        }
    }

    #[test]
    fn each_error_is_relative_to_what_the_reference_has() {
        let errors = response(0.5, 2.0).errors(&response(0.6, 2.0));
        let near = |measure: Measure, value: f64| (errors[measure].expect("measured") - value).abs() < 1e-12;
        assert!(near(Measure::Field, 0.075 / 0.45) && near(Measure::FieldAtEnd, 0.1 / 0.6), "{errors:?}");
        assert!(near(Measure::Ends, 0.0) && near(Measure::PeakForce, 0.0) && near(Measure::ResidualStrain, 0.0));
        assert_eq!(errors[Measure::Gauges], None);
        let errors = response(0.6, 2.2).errors(&response(0.6, 2.0));
        assert!((errors[Measure::PeakForce].expect("measured") - 0.1).abs() < 1e-12, "{errors:?}");
    }

    #[test]
    fn every_peak_force_counts_unless_it_is_negligible_or_has_no_limit() {
        let with = |forces: [f64; 3], has_no_limit: bool| {
            let peaks = forces.map(|force| Peak { force, has_no_limit: has_no_limit && force > 1.0 });
            Response { peaks: peaks.to_vec(), ..response(0.5, 2.0) }
        };
        let error = |own, reference, unlimited| {
            with(own, unlimited).errors(&with(reference, unlimited))[Measure::PeakForce].map(|e| (e * 1e6).round())
        };
        // A joint between free ends, the smaller of two ends, and a negligible joint.
        assert_eq!(error([0.0, 0.0, 10.1], [0.0, 0.0, 10.0], false), Some(1e4));
        assert_eq!(error([10.0, 5.1, 0.0], [10.0, 5.0, 0.0], false), Some(2e4));
        assert_eq!(error([10.0, 5.0, 0.009], [10.0, 5.0, 0.003], false), Some(0.0));
        assert_eq!(error([12.0, 0.51, 0.0], [10.0, 0.5, 0.0], true), Some(2e4));
        assert_eq!(error([12.0, 0.0, 0.0], [10.0, 0.0, 0.0], true), None);
    }

    #[test]
    fn a_bar_that_rang_down_is_measured_by_what_was_in_it() {
        let quiet = |left: f64| {
            let mut response = response(0.5, 2.0);
            response.fields.push((1.5, Shape::Steps { edges: vec![], values: vec![left], ends: [0.0, 1.0] }));
            response
        };
        let errors = quiet(1e-9).errors(&quiet(0.0));
        assert!(errors[Measure::FieldAtEnd].expect("measured") < 1e-7, "{errors:?}");
    }

    /// The error of a short specimen is relative to its own plastic strain, although it is shorter than 1 % of the bar.
    #[test]
    fn a_short_specimen_is_measured_by_what_is_in_it() {
        let flowed = |plastic: f64| {
            let edges = vec![0.5, 0.501];
            let shape = Shape::Steps { edges, values: vec![0.0, plastic, 0.0], ends: [0.0, 1.0] };
            Response { plastic: Some(shape), lengths: vec![0.5, 0.001, 0.499], ..response(0.5, 1e-6) }
        };
        let error = flowed(0.09).errors(&flowed(0.1))[Measure::ResidualStrain].expect("measured");
        assert!((error - 0.1).abs() < 1e-9, "{error}");
    }

    #[test]
    fn fewer_instants_are_among_more() {
        let times: Vec<f64> = (1..=100).map(f64::from).collect();
        let (many, few) = (evenly(&times, 32), evenly(&times, 16));
        assert_eq!(many.len(), 25);
        assert!(few.iter().all(|t| many.contains(t)) && few.last() == Some(&100.0));
        assert_eq!(evenly(&[1.0, 2.0], 32), [1.0, 2.0]);
    }
}
