//! Hardening laws as tables: how accurately the table follows the law, and the positions of its corners.

use barwave::material::{
    Beyond, Curve, Law, Measure, Sense, Tabulate, engineering_from_true, tabulate_law, tabulate_true_rows,
    true_from_engineering,
};
use barwave::wave::similarity::critical;
use proptest::prelude::*;

const LAWS: [Law; 6] = [
    Law::Hollomon { k: 530e6, n: 0.44 },
    Law::Ludwik { yield_stress: 90e6, k: 300e6, n: 0.4 },
    Law::Swift { k: 600e6, prestrain: 0.002, n: 0.2 },
    Law::Voce { yield_stress: 20e6, saturation: 308e6, strain: 0.17 },
    Law::RambergOsgood { yield_stress: 250e6, offset: 0.002, n: 10.0 },
    Law::JohnsonCook { a: 792e6, b: 510e6, n: 0.26 },
];
const E: f64 = 115e9;

fn how(tolerance: f64) -> Tabulate {
    Tabulate { tolerance, to_strain: None }
}

/// Returns the engineering point of a law at its own parameter, by the conversions alone.
fn exact(law: &Law, measure: Measure, sense: Sense, x: f64) -> (f64, f64) {
    let stress = law.stress(x);
    let total = if matches!(law, Law::Hollomon { .. }) { x } else { x + stress / E };
    match measure {
        Measure::Engineering => (total, stress),
        Measure::True => engineering_from_true(sense, total, stress),
    }
}

#[test]
fn tables_follow_their_laws_within_the_tolerance() {
    for law in &LAWS {
        for measure in [Measure::Engineering, Measure::True] {
            for sense in [Sense::Tension, Sense::Compression] {
                for tolerance in [1e-2, 1e-3, 1e-4] {
                    let table = tabulate_law(law, E, measure, sense, how(tolerance)).expect("it can be tabulated");
                    let curve = Curve::new(&table.rows, Beyond::Error).expect("the table is right");
                    let top = curve.stress().iter().copied().fold(0.0, f64::max);
                    let start = curve.elastic_limit(E).0;
                    assert!(start > 0.0, "{law}: the first slope is the modulus");
                    assert!(table.error <= tolerance * top);
                    for i in 1..4000 {
                        let (strain, stress) = exact(law, measure, sense, 1e-7 * 1.005_f64.powi(i));
                        if strain > start && strain < curve.last_strain() {
                            let off = (curve.stress_at(strain) - stress).abs();
                            // The elastic parts of the two conversions differ by 1.5 (stress/E)^2 of strain, with a slope of at most the modulus; and
                            // the tolerance is sampled, not proven.
                            let elastic = 1.5 * (stress / E).powi(2) * E;
                            assert!(
                                off <= 1.1 * tolerance * top + elastic,
                                "{law} {measure:?} {sense:?} at {strain}: {off}"
                            );
                        }
                    }
                    assert!(curve.steeper_than(E).is_none(), "{law} {measure:?} {sense:?}");
                }
            }
        }
    }
}

#[test]
fn the_largest_engineering_stress_is_a_knot() {
    // Considere: the true slope equals the true stress; K e^n has this point at e = n.
    let table = tabulate_law(&LAWS[0], E, Measure::True, Sense::Tension, how(1e-2)).expect("it can be tabulated");
    let curve = Curve::new(&table.rows, Beyond::Error).expect("the table is right");
    let u = curve.ultimate().expect("the maximum is inside");
    assert!((u.strain / 0.44_f64.exp_m1() - 1.0).abs() < 1e-12, "{}", u.strain);
    assert!((u.stress / (530e6 * 0.44_f64.powf(0.44) * (-0.44_f64).exp()) - 1.0).abs() < 1e-12);
    // For the other laws, no point of the law is above the knot, which is a maximum of the law.
    for law in &LAWS[1..] {
        let table = tabulate_law(law, E, Measure::True, Sense::Tension, how(1e-2)).expect("it can be tabulated");
        let curve = Curve::new(&table.rows, Beyond::Error).expect("the table is right");
        let u = curve.ultimate().expect("the maximum is inside");
        let highest = (1..60_000)
            .map(|i| exact(law, Measure::True, Sense::Tension, 1e-4 * f64::from(i)))
            .fold(0.0, |m: f64, p| m.max(p.1));
        // The elastic parts of the two conversions differ by 1.5 (true stress/E)^2 of strain, and the stress accordingly.
        let elastic = 1.5 * (u.stress * (1.0 + u.strain) / E).powi(2);
        assert!((u.stress / highest - 1.0).abs() < elastic + 1e-8, "{law}: {} {highest}", u.stress);
    }
}

#[test]
fn engineering_laws_and_compression_have_no_maximum() {
    for law in &LAWS {
        let true_end = -(-Tabulate::DEFAULT_TRUE_END).exp_m1();
        for (measure, sense, end) in [
            (Measure::Engineering, Sense::Tension, Tabulate::DEFAULT_END),
            (Measure::Engineering, Sense::Compression, Tabulate::DEFAULT_END),
            (Measure::True, Sense::Compression, true_end),
        ] {
            let table = tabulate_law(law, E, measure, sense, how(1e-3)).expect("it can be tabulated");
            let curve = Curve::new(&table.rows, Beyond::Error).expect("the table is right");
            assert_eq!(curve.ultimate(), None, "{law}");
            assert!((curve.last_strain() - end).abs() < 1e-9);
        }
    }
}

#[test]
fn the_critical_velocity_of_a_table_is_within_its_tolerance() {
    for law in &LAWS {
        let v_c = |tolerance| {
            let table =
                tabulate_law(law, E, Measure::True, Sense::Tension, how(tolerance)).expect("it can be tabulated");
            critical(&Curve::new(&table.rows, Beyond::Error).expect("right"), 8960.0).expect("inside").velocity
        };
        let fine = v_c(1e-7);
        for tolerance in [1e-2, 1e-3, 1e-4] {
            let error = (v_c(tolerance) / fine - 1.0).abs();
            assert!(error < tolerance, "{law}: {error} at {tolerance}");
        }
    }
}

#[test]
fn the_table_goes_as_far_as_it_is_told_and_not_less_than_the_elastic_part() {
    let to = |strain| {
        tabulate_law(&LAWS[5], E, Measure::True, Sense::Tension, Tabulate { tolerance: 1e-3, to_strain: Some(strain) })
    };
    let table = to(0.123).expect("it can be tabulated");
    assert!((table.rows[table.rows.len() - 1].0 - 0.123).abs() < 1e-12);
    assert!(to(0.001).expect_err("the elastic limit is at 0.0069").message.contains("elastic limit"));
}

#[test]
fn a_true_table_gets_a_knot_where_necking_starts() {
    // Linear true hardening 400 MPa + 1000 MPa e: the largest engineering stress is where 1000 = 400 + 1000 e.
    let rows = [(0.002, 400e6), (1.002, 1400e6)];
    let table = tabulate_true_rows(&rows, Some(200e9), Sense::Tension, 1e-3).expect("right");
    let curve = Curve::new(&table.rows, Beyond::Rupture).expect("the table is right");
    let u = curve.ultimate().expect("inside");
    assert!((u.strain / 0.602_f64.exp_m1() - 1.0).abs() < 1e-12);
    assert!((u.stress / (1000e6 * (-0.602_f64).exp()) - 1.0).abs() < 1e-12);
    assert!(curve.elastic_limit(200e9).1 > 399e6);
    assert!(table.error <= 1e-3 * u.stress);
    for i in 3..1000 {
        let e = 0.001 * f64::from(i);
        let (strain, stress) = engineering_from_true(Sense::Tension, e, 400e6 + 1000e6 * (e - 0.002));
        // The tolerance is sampled at eight positions per segment.
        assert!((curve.stress_at(strain) - stress).abs() <= 1.02e-3 * u.stress, "{e}");
    }
}

#[test]
fn compression_turns_concave_up() {
    let table = tabulate_law(
        &LAWS[0],
        E,
        Measure::True,
        Sense::Compression,
        Tabulate { tolerance: 1e-4, to_strain: Some(0.8) },
    )
    .expect("it can be tabulated");
    let curve = Curve::new(&table.rows, Beyond::Error).expect("the table is right");
    let slopes: Vec<_> = curve.slopes().collect();
    let lowest = slopes.iter().copied().fold(f64::INFINITY, f64::min);
    assert!(slopes[slopes.len() - 1] > 2.0 * lowest);
}

proptest! {
    #[test]
    fn conversions_are_each_others_inverse(strain in 1e-6..0.9_f64, stress in 1.0..2e9_f64, compress: bool) {
        let sense = if compress { Sense::Compression } else { Sense::Tension };
        let (e, s) = engineering_from_true(sense, strain, stress);
        let (strain2, stress2) = true_from_engineering(sense, e, s);
        // ln(1 - e) near e = 0.6 loses a digit; 1e-13 allows for three.
        prop_assert!((strain2 / strain - 1.0).abs() < 1e-13);
        prop_assert!((stress2 / stress - 1.0).abs() < 1e-13);
        prop_assert_eq!(s < stress, !compress);
    }

    #[test]
    fn power_laws_of_any_constants_become_concave_tables(k in 50e6..3e9_f64, n in 0.02..0.9_f64, e in 40e9..220e9_f64) {
        let table = tabulate_law(&Law::Hollomon { k, n }, e, Measure::True, Sense::Tension, how(1e-3)).expect("it can be tabulated");
        let curve = Curve::new(&table.rows, Beyond::Error).expect("the table is right");
        prop_assert!(curve.steeper_than(e).is_none());
        prop_assert!(curve.elastic_limit(e).0 > 0.0);
        let u = curve.ultimate().expect("inside");
        // If n is below the strain of the elastic limit, the curve decreases from there.
        prop_assert!((u.strain / n.exp_m1() - 1.0).abs() < 1e-9 || u.strain == curve.elastic_limit(e).0);
        prop_assert!(table.rows.len() < 400, "{}", table.rows.len());
    }
}

#[test]
fn tables_stay_short() {
    for law in &LAWS {
        let rows = tabulate_law(law, E, Measure::True, Sense::Tension, how(1e-3)).expect("right").rows.len();
        // The number of rows grows as tolerance^-1/2; these laws need 30 to 60 rows.
        println!("{rows} {law}");
        assert!(rows < 80, "{law}: {rows} rows");
    }
}
