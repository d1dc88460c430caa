//! Stress-strain tables: which are refused, and the values that they give.

use barwave::material::{Beyond, Curve, UltimateReason};
use proptest::prelude::*;

const MPA: f64 = 1e6;

fn curve(rows: &[(f64, f64)], beyond: Beyond) -> Curve {
    let rows: Vec<_> = rows.iter().map(|&(e, s)| (e, s * MPA)).collect();
    Curve::new(&rows, beyond).expect("the table is right")
}

#[test]
fn wrong_tables_are_refused_by_row_and_value() {
    let refused = |rows: &[(f64, f64)], row: usize, words: &str| {
        let error = Curve::new(rows, Beyond::Error).expect_err("the table is wrong");
        assert_eq!(error.row, row, "{error}");
        assert!(error.message.contains(words), "{error}");
    };
    refused(&[], 0, "at least one row");
    refused(&[(0.0, 0.0)], 0, "at least one row");
    refused(&[(0.0, 0.0), (0.01, 1.0), (0.01, 2.0)], 2, "1e-2 is given twice");
    refused(&[(0.0, 0.0), (0.01, 1.0), (0.005, 2.0)], 2, "5e-3 is smaller than 1e-2");
    refused(&[(-0.01, 1.0)], 0, "strain -1e-2 is negative");
    refused(&[(0.01, 1.0), (0.02, -3.0)], 1, "stress -3e0 is negative");
    refused(&[(0.01, 1.0), (f64::NAN, 2.0)], 1, "strain is NaN");
    refused(&[(0.01, f64::INFINITY)], 0, "stress is inf");
    refused(&[(0.0, 5.0), (0.01, 6.0)], 0, "5e0 Pa at zero strain");
    refused(&[(0.0, 0.0), (0.01, 0.0), (0.02, 1.0)], 1, "does not rise");
    refused(&[(0.01, 0.0), (0.02, 1.0)], 0, "does not rise");
}

#[test]
fn a_missing_origin_is_added_and_rows_count_as_given() {
    let with = curve(&[(0.0, 0.0), (0.001, 100.0), (0.01, 150.0)], Beyond::Error);
    let without = curve(&[(0.001, 100.0), (0.01, 150.0)], Beyond::Error);
    assert_eq!(with, without);
    assert_eq!(with.steeper_than(90e9), Some((1, 100.0 * MPA / 0.001)));
    assert_eq!(with.steeper_than(100e9), None);
}

#[test]
fn stress_past_the_last_knot_follows_beyond() {
    let rows = [(0.001, 100.0), (0.003, 120.0)];
    // One rounding of a product and a sum of numbers near 1e8.
    let near = |a: f64, b: f64| assert!((a - b).abs() <= 1e-15 * b * 4.0, "{a} {b}");
    near(curve(&rows, Beyond::Extend).stress_at(0.004), 130.0 * MPA);
    near(curve(&rows, Beyond::Error).stress_at(0.004), 120.0 * MPA);
    near(curve(&rows, Beyond::Rupture).stress_at(0.004), 120.0 * MPA);
    near(curve(&rows, Beyond::Error).stress_at(0.002), 110.0 * MPA);
    assert_eq!(curve(&rows, Beyond::Error).stress_at(0.0), 0.0);
}

#[test]
fn the_elastic_limit_ends_where_the_slope_leaves_the_modulus() {
    let c = curve(&[(0.0005, 50.0), (0.001, 100.0), (0.01, 150.0)], Beyond::Error);
    assert_eq!(c.elastic_limit(100e9), (0.001, 100.0 * MPA));
    assert_eq!(c.elastic_limit(110e9), (0.0, 0.0));
}

#[test]
fn the_ultimate_point_is_the_first_that_has_the_largest_stress() {
    let ultimate =
        |rows: &[(f64, f64)], beyond| curve(rows, beyond).ultimate().map(|u| (u.strain, u.stress / MPA, u.reason));
    let necking = [(0.001, 100.0), (0.2, 300.0), (0.3, 250.0)];
    let rising = [(0.001, 100.0), (0.2, 300.0)];
    let level = [(0.001, 100.0), (0.2, 300.0), (0.25, 300.0), (0.3, 300.0)];
    let drop = [(0.001, 300.0), (0.002, 250.0), (0.02, 280.0)];
    for beyond in [Beyond::Rupture, Beyond::Extend, Beyond::Error] {
        assert_eq!(ultimate(&necking, beyond), Some((0.2, 300.0, UltimateReason::MaximumStress)));
        assert_eq!(ultimate(&level, beyond), Some((0.2, 300.0, UltimateReason::MaximumStress)));
    }
    assert_eq!(ultimate(&rising, Beyond::Rupture), Some((0.2, 300.0, UltimateReason::RuptureStrain)));
    assert_eq!(ultimate(&rising, Beyond::Extend), None);
    assert_eq!(ultimate(&rising, Beyond::Error), None);
    // An extrapolation that increases without limit exceeds any maximum; data that end below their maximum do not.
    assert_eq!(ultimate(&drop, Beyond::Extend), None);
    assert_eq!(ultimate(&drop, Beyond::Error), Some((0.001, 300.0, UltimateReason::MaximumStress)));
}

#[test]
fn the_running_maximum_fills_drops_up_to_where_the_stress_returns() {
    let c = curve(&[(0.0015, 310.0), (0.0016, 250.0), (0.02, 250.0), (0.1, 380.0), (0.2, 430.0)], Beyond::Error);
    let filled = c.running_maximum();
    let back = 0.02 + (310.0 - 250.0) / (380.0 - 250.0) * (0.1 - 0.02);
    assert_eq!(filled.stress_at(0.01), 310.0 * MPA);
    // Two interpolations with a relative rounding of 1e-16 each, times the slope: far below 1e-12.
    assert!((filled.stress_at(back) / (310.0 * MPA) - 1.0).abs() < 1e-12);
    assert_eq!(filled.stress_at(0.1), 380.0 * MPA);
    assert!(filled.stress_at(back * 0.999) <= 310.0 * MPA);
    assert!(filled.stress_at(back * 1.001) > 310.0 * MPA);
}

#[test]
fn the_running_maximum_of_an_extension_crosses_after_the_last_knot() {
    let c = curve(&[(0.001, 300.0), (0.002, 200.0), (0.012, 250.0)], Beyond::Extend);
    let filled = c.running_maximum();
    // 5 MPa per 1e-3 of strain from (0.012, 250): back at 300 at 0.022.
    assert!((filled.stress_at(0.021) / (300.0 * MPA) - 1.0).abs() < 1e-12);
    assert!((filled.stress_at(0.042) / (400.0 * MPA) - 1.0).abs() < 1e-12);
}

/// Random tables of 1 to 12 segments, rising, level or falling, as `(d eps, stress)` steps.
fn tables() -> impl Strategy<Value = Vec<(f64, f64)>> {
    proptest::collection::vec((1e-4..0.1_f64, 1.0..500.0_f64), 1..12).prop_map(|steps| {
        let mut strain = 0.0;
        let row = |(d, stress): (f64, f64)| {
            strain += d;
            (strain, stress * MPA)
        };
        steps.into_iter().map(row).collect()
    })
}

proptest! {
    #[test]
    fn knots_are_returned_exactly(rows in tables()) {
        let c = Curve::new(&rows, Beyond::Error).expect("the table is right");
        for &(strain, stress) in &rows {
            prop_assert_eq!(c.stress_at(strain), stress);
        }
    }

    #[test]
    fn the_running_maximum_never_falls_and_lies_on_or_above_the_table(rows in tables(), extend: bool) {
        let beyond = if extend { Beyond::Extend } else { Beyond::Error };
        let c = Curve::new(&rows, beyond).expect("the table is right");
        let filled = c.running_maximum();
        prop_assert!(filled.stress().windows(2).all(|s| s[1] >= s[0]));
        prop_assert!(filled.strain().windows(2).all(|e| e[1] > e[0]));
        let mut highest: f64 = 0.0;
        for i in 0..=3000 {
            let strain = c.last_strain() * f64::from(i) / 2000.0;
            highest = highest.max(c.stress_at(strain));
            let filled_there = filled.stress_at(strain);
            // Below only by rounding of the interpolation; above by at most the part of a peak between two samples.
            prop_assert!(filled_there >= highest * (1.0 - 1e-9));
            prop_assert!(filled_there <= highest + c.steepest() * c.last_strain() / 2000.0);
        }
    }

    #[test]
    fn the_ultimate_point_is_nowhere_exceeded(rows in tables()) {
        for beyond in [Beyond::Rupture, Beyond::Extend, Beyond::Error] {
            let c = Curve::new(&rows, beyond).expect("the table is right");
            if let Some(u) = c.ultimate() {
                prop_assert_eq!(c.stress_at(u.strain), u.stress);
                prop_assert!((0..4000).all(|i| c.stress_at(c.last_strain() * f64::from(i) / 2000.0) <= u.stress));
                prop_assert!(c.strain().iter().zip(c.stress()).all(|(e, s)| *e >= u.strain || *s < u.stress));
            }
        }
    }
}
