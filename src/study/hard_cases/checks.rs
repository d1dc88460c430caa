//! Conditions that every result must satisfy.
//!
//! - No number is missing or infinite.
//! - Kinetic, elastic and stored energies are not negative; dissipated ones never decrease.
//! - The method has not added energy to the bar.
//! - Fields stay within the bounds that the scene states.
//! - The total variation of stress and velocity stays below that of the data, see [`super::variation`].

use super::scenes::Bound;
use super::variation;
use crate::error::Result;
use crate::record::store::{ResultFile, Side};
use crate::record::{Field, LedgerRow};
use crate::solver::Energies;
use crate::units::{Dimension, Quantity};

/// Energy residual up to which a ledger is closed.
pub(super) const MOST_RESIDUAL: f64 = 1e-6;

/// Part of the largest energy of a run by which rounding may make an energy negative, or smaller than before.
const ROUNDING: f64 = 1e-9;

/// Part of the largest energy of a run that a method may give to the bar: schemes of second order do where the bar moves smoothly.
const MOST_GIVEN: f64 = 0.01;

/// What was found.
pub(super) struct Found {
    /// Pa.
    pub largest_stress: f64,
    pub largest_strain: f64,
    /// m/s.
    pub largest_velocity: f64,
    pub failed: Vec<String>,
}

/// A name, and how to read the energy.
type Column = (&'static str, fn(&Energies) -> f64);

/// Never negative.
const STORED: [Column; 3] = [("kinetic", |e| e.kinetic), ("elastic", |e| e.elastic), ("foundation", |e| e.foundation)];

/// Never negative and never decreasing.
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

/// The total variations of stress and velocity over those that the data impose; the larger one.
pub(super) fn variation(file: &ResultFile, imposed: [f64; 2]) -> Result<f64> {
    let frames = file.time()?.len();
    let mut most = 0.0_f64;
    for (field, imposed) in [Field::Stress, Field::Velocity].into_iter().zip(imposed) {
        most = most.max(variation::largest(&file.field(field, 0..frames)?) / imposed);
    }
    Ok(most)
}

/// The largest magnitude; says so where a number is none.
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
