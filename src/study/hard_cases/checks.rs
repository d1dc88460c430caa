//! Conditions that every result must satisfy.
//!
//! - All numbers are finite.
//! - Kinetic, elastic and foundation energies are not negative; dissipated energies are not negative and never decrease.
//! - The numerical scheme adds at most 1 % of the largest energy to the bar.
//! - Fields stay within the bounds that the scene states.
//! - The total variation of stress and velocity does not exceed that imposed by the data, see [`super::variation`].

use super::scenes::Bound;
use super::variation;
use crate::error::Result;
use crate::record::store::{ResultFile, Side};
use crate::record::{Field, LedgerRow};
use crate::solver::Energies;
use crate::units::{Dimension, Quantity};

/// Largest energy residual for which the energy balance counts as closed.
pub(super) const MOST_RESIDUAL: f64 = 1e-6;

/// Tolerance for rounding, relative to the largest energy of a run: by this amount an energy may be negative, or a dissipated energy may decrease.
const ROUNDING: f64 = 1e-9;

/// Largest energy that the numerical scheme may add to the bar, relative to the largest energy of the run. Second-order schemes add energy where the
/// motion is smooth.
const MOST_GIVEN: f64 = 0.01;

/// Extreme values of a result and the failed checks.
pub(super) struct Found {
    /// Largest magnitude of the stress, Pa.
    pub largest_stress: f64,
    pub largest_strain: f64,
    /// Largest magnitude of the velocity, m/s.
    pub largest_velocity: f64,
    pub failed: Vec<String>,
}

/// Name of an energy and its accessor.
type Column = (&'static str, fn(&Energies) -> f64);

/// Stored energies, which are never negative.
const STORED: [Column; 3] = [("kinetic", |e| e.kinetic), ("elastic", |e| e.elastic), ("foundation", |e| e.foundation)];

/// Dissipated energies, which are never negative and never decrease.
const DISSIPATED: [Column; 6] = [
    ("plastic", |e| e.plastic),
    ("heat", |e| e.heat),
    ("viscoplastic", |e| e.viscoplastic),
    ("concentrated", |e| e.concentrated),
    ("fracture", |e| e.fracture),
    ("damping", |e| e.damping),
];

pub(super) fn check(file: &ResultFile, bounds: &[Bound]) -> Result<Found> {
    let (mut largest, mut failed) = ([0.0; 3], Vec::new());
    let frames = file.time()?.len();
    for (largest, field) in largest.iter_mut().zip([Field::Stress, Field::Strain, Field::Velocity]) {
        if file.fields().contains(&field) {
            *largest = magnitude(file.field(field, 0..frames)?.iter(), field.name(), &mut failed);
        }
    }
    for side in [Side::Left, Side::Right] {
        let trace = file.end(side)?;
        largest[0] = f64::max(largest[0], magnitude(trace.stress.iter(), "stress at an end", &mut failed));
        largest[2] = f64::max(largest[2], magnitude(trace.velocity.iter(), "velocity at an end", &mut failed));
    }
    failed.extend(bounds.iter().filter_map(|bound| exceeded(bound, largest)));
    failed.extend(check_ledger(&file.ledger()?));
    let [largest_stress, largest_strain, largest_velocity] = largest;
    Ok(Found { largest_stress, largest_strain, largest_velocity, failed })
}

/// Returns the larger of the total variations of stress and velocity, each relative to the jump that the data impose.
pub(super) fn variation(file: &ResultFile, imposed: [f64; 2]) -> Result<f64> {
    let frames = file.time()?.len();
    let mut most = 0.0_f64;
    for (field, imposed) in [Field::Stress, Field::Velocity].into_iter().zip(imposed) {
        most = most.max(variation::largest(&file.field(field, 0..frames)?) / imposed);
    }
    Ok(most)
}

/// Returns the largest magnitude. If a value is not finite, appends a message to `failed` and returns NaN.
fn magnitude<'a>(mut values: impl Iterator<Item = &'a f64>, what: &str, failed: &mut Vec<String>) -> f64 {
    let largest = values.try_fold(0.0_f64, |most, value| value.is_finite().then(|| most.max(value.abs())));
    largest.unwrap_or_else(|| {
        failed.push(format!("a {what} is not a finite number"));
        f64::NAN
    })
}

fn exceeded(bound: &Bound, [stress, strain, velocity]: [f64; 3]) -> Option<String> {
    let (largest, dimension) = match bound.field.as_str() {
        "stress" => (stress, Dimension::Stress),
        "velocity" => (velocity, Dimension::Velocity),
        _ => (strain, Dimension::None),
    };
    let most = bound.value.parse::<Quantity>().ok().and_then(|value| value.si(dimension).ok()).unwrap_or(0.0);
    (largest.is_nan() || largest > most)
        .then(|| format!("{} reaches {largest:.4e}, more than {}", bound.field, bound.value))
}

fn check_ledger(rows: &[LedgerRow]) -> Vec<String> {
    let mut failed = Vec::new();
    let all = || rows.iter().flat_map(|row| row.energies.values());
    if !all().all(f64::is_finite) {
        failed.push("an energy is not a finite number".to_owned());
    }
    let scale = all().fold(0.0_f64, |most, energy| most.max(energy.abs()));
    let least = |(_, of): &Column| rows.iter().map(|row| of(&row.energies)).fold(0.0, f64::min);
    let falls = |(_, of): &Column| {
        rows.windows(2).map(|pair| of(&pair[0].energies) - of(&pair[1].energies)).fold(0.0, f64::max)
    };
    for column in STORED.iter().chain(&DISSIPATED).filter(|column| least(column) < -ROUNDING * scale) {
        failed.push(format!("{} energy is negative: {:.1e} of the largest energy", column.0, least(column) / scale));
    }
    for column in DISSIPATED.iter().filter(|column| falls(column) > ROUNDING * scale) {
        failed.push(format!("{} energy decreases by {:.1e} of the largest energy", column.0, falls(column) / scale));
    }
    let given = -least(&("numerical", |e| e.numerical)) / scale;
    if given > MOST_GIVEN {
        failed.push(format!("the method added {:.1} % of the largest energy to the bar", 100.0 * given));
    }
    failed
}
