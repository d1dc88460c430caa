//! The elastic part of a table with few rows.
//!
//! Rows read off a figure scatter about the elastic line: some pairs are steeper than others, and the steepest of them would give the modulus, with
//! an elastic limit of zero. If the stresses of the elastic part are given, a line replaces it.

use super::clean::count;
use super::fit::line;
use super::reduce::check_range;
use crate::error::InputError;
use crate::input::{Allowed, optional};
use crate::material::SLOPE_ROUND_OFF;
use crate::units::Dimension;

/// Smallest number of rows, including the origin, for a line.
const FEWEST: usize = 3;

/// A table that begins with a straight line.
#[derive(Debug, Clone, PartialEq)]
pub struct Straightened {
    /// Slope of the line, Pa.
    pub modulus: f64,
    /// Rows (strain, stress in Pa), increasing: the origin, the end of the line, and the rows above it.
    pub rows: Vec<(f64, f64)>,
    /// The change that was made, in one sentence.
    pub change: String,
}

/// Replaces the rows with stresses in `range` (Pa), and those below it, by the least-squares line through them, or by the line with the slope
/// `modulus` (Pa) through their mean. If `toe` is true, strains are shifted so that the line starts at zero; otherwise it passes through the
/// origin.
///
/// `rows` are strain and stress (Pa), increasing in strain.
///
/// # Errors
/// A number is out of range, the range has fewer than three rows, the line does not rise, or the row above it lies above the line.
pub fn straighten(
    rows: &[(f64, f64)],
    range: [f64; 2],
    modulus: Option<f64>,
    toe: bool,
) -> Result<Straightened, InputError> {
    let wrong = |message: String| {
        let error = InputError::new(message).key("elastic_range");
        error.allowed(format!("at least {FEWEST} rows that rise")).help("name the stresses of the elastic part")
    };
    check_range(range)?;
    optional("modulus", modulus, Dimension::Stress, Allowed::Positive)?;
    let past = rows.iter().position(|row| row.1 > range[1]).unwrap_or(rows.len());
    let inside: Vec<(f64, f64)> = rows[..past].iter().copied().filter(|row| row.1 >= range[0]).collect();
    let [low, high] = range.map(|stress| stress / 1e6);
    if inside.len() < FEWEST {
        return Err(wrong(format!("{} with a stress from {low} to {high} MPa", count(inside.len()))));
    }
    let mean = |of: fn(&(f64, f64)) -> f64| inside.iter().map(of).sum::<f64>() / inside.len() as f64;
    let (strain, stress) = (mean(|row| row.0), mean(|row| row.1));
    let free = line(inside.iter().map(|&(e, s)| (e - strain, s, 1.0))).map(|fit| fit.b);
    let [xx, xy] = inside.iter().fold([0.0; 2], |sum, &(e, s)| [sum[0] + e * e, sum[1] + e * s]);
    let fitted = if toe { free } else { (xx > 0.0).then(|| xy / xx) };
    let slope = modulus.or(fitted).filter(|slope| *slope > 0.0 && slope.is_finite());
    let Some(slope) = slope else { return Err(wrong(format!("the rows from {low} to {high} MPa have no slope"))) };
    let origin = if toe { strain - stress / slope } else { 0.0 };
    let limit = inside.iter().map(|row| row.1).fold(0.0, f64::max);
    let mut straight = vec![(0.0, 0.0), (limit / slope, limit)];
    for &(e, s) in &rows[past..] {
        let last = straight[straight.len() - 1];
        if s - last.1 > slope * (1.0 + SLOPE_ROUND_OFF) * (e - origin - last.0) {
            return Err(wrong(format!(
                "the row at strain {e} and {} MPa lies above the elastic line of {:.3} GPa",
                s / 1e6,
                slope / 1e9
            )));
        }
        straight.push((e - origin, s));
    }
    let change = format!(
        "elastic line of {:.3} GPa in place of {past} rows up to {} MPa; strains shifted by {:.3e}",
        slope / 1e9,
        limit / 1e6,
        -origin
    );
    Ok(Straightened { modulus: slope, rows: straight, change })
}

#[cfg(test)]
mod tests {
    use super::*;

    const ROWS: [(f64, f64); 6] =
        [(0.0, 0.0), (0.001, 70e6), (0.002, 141e6), (0.0025, 165e6), (0.005, 190e6), (0.01, 215e6)];

    #[test]
    fn rows_of_the_elastic_part_become_a_line() {
        let found = straighten(&ROWS, [0.0, 150e6], None, true).expect("a line");
        assert!((found.modulus - 70.5e9).abs() < 1.0, "{}", found.modulus);
        assert_eq!((found.rows.len(), found.rows[0], found.rows[1].1), (5, (0.0, 0.0), 141e6));
        assert!((found.rows[1].0 - 141e6 / 70.5e9).abs() < 1e-15);
        // The line through the mean of the rows meets zero stress 1/3 MPa below the origin.
        assert!((found.rows[2].0 - (0.0025 - (0.001 - 211e6 / 3.0 / 70.5e9))).abs() < 1e-15);
        let kept = straighten(&ROWS, [0.0, 150e6], Some(80e9), false).expect("a line");
        assert_eq!((kept.modulus, kept.rows[2]), (80e9, ROWS[3]));
    }

    #[test]
    fn ranges_that_make_no_line_are_refused() {
        let message = |range, modulus| straighten(&ROWS, range, modulus, false).expect_err("no line").message;
        assert_eq!(message([100e6, 150e6], None), "1 row with a stress from 100 to 150 MPa");
        assert_eq!(
            message([0.0, 150e6], Some(30e9)),
            "the row at strain 0.0025 and 165 MPa lies above the elastic line of 30.000 GPa"
        );
        let level = [(0.0, 0.0), (1e-3, 0.0), (2e-3, 0.0), (3e-3, 1.0)];
        assert!(straighten(&level, [0.0, 0.0], None, true).is_err());
    }
}
