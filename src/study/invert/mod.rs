//! Stress-strain curves from measurements on bars and wires: the inverse problem of the simulation.
//!
//! - [`arrivals`]: arrival times of strain levels at gauges along a bar (simple-wave theory).
//! - [`residual`]: the strain along a wire during or after an impact (von Kármán and Duwez).
//! - [`hopkinson`]: the gauges on the bars of a split-Hopkinson set.
//!
//! Strains and stresses are magnitudes in engineering measure, positive in the sense of the loading.

pub mod arrivals;
mod bands;
mod curve;
mod given;
pub mod hopkinson;
mod isotonic;
mod material;
mod noise;
mod records;
pub mod residual;
mod setup;
mod table;
mod zero;

pub use curve::{Interval, WavePoint};
pub use material::{MaterialText, MeasuredKnot, extended, from_waves, material_text, with_elastic_part};
pub use records::{Record, Recording};
pub use setup::{REPLICATES, SEED};

use crate::material::Curve;

/// Returns the relative difference in stress of an inverted curve from `curve` at the strain at which it is largest in magnitude, and that strain.
pub fn against(curve: &Curve, points: &[WavePoint]) -> Option<(f64, f64)> {
    largest(curve, points.iter().map(|point| (point.strain, point.stress_pa.value)))
}

/// Returns the same difference for the curve of a specimen.
pub fn against_knots(curve: &Curve, knots: &[hopkinson::Knot]) -> Option<(f64, f64)> {
    largest(curve, knots.iter().map(|knot| (knot.strain, knot.stress)))
}

fn largest(curve: &Curve, points: impl Iterator<Item = (f64, f64)>) -> Option<(f64, f64)> {
    let inside = points.filter(|point| point.0 <= curve.last_strain() && curve.stress_at(point.0) > 0.0);
    let distance = |(strain, stress): (f64, f64)| (stress / curve.stress_at(strain) - 1.0, strain);
    inside.map(distance).max_by(|a, b| a.0.abs().total_cmp(&b.0.abs()))
}
