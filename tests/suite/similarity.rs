//! The self-similar solution against worked tables, closed forms and its own invariants.

use barwave::material::{Beyond, Curve, UltimateReason};
use barwave::wave::similarity::{
    Edge, critical, fan_at_stress, fan_at_velocity, hull, impact_velocities, impact_velocity,
};
use proptest::prelude::*;

const MPA: f64 = 1e6;

fn curve(rows: &[(f64, f64)], beyond: Beyond) -> Curve {
    let rows: Vec<_> = rows.iter().map(|&(e, s)| (e, s * MPA)).collect();
    Curve::new(&rows, beyond).expect("the table is right")
}

/// The worked values have ten digits.
fn near(value: f64, expected: f64) {
    assert!((value / expected - 1.0).abs() < 1e-6, "{value} is not {expected}");
}

fn table_a(beyond: Beyond) -> Curve {
    curve(&[(0.001, 100.0), (0.01, 150.0), (0.05, 230.0), (0.2, 330.0)], beyond)
}

fn table_b(beyond: Beyond) -> Curve {
    curve(&[(0.0015, 310.0), (0.0016, 250.0), (0.02, 250.0), (0.1, 380.0), (0.2, 430.0)], beyond)
}

fn table_c(beyond: Beyond) -> Curve {
    curve(&[(0.01, 1.0), (0.6, 1.2), (0.7, 5.0), (0.75, 20.0)], beyond)
}

#[test]
fn concave_table_has_a_front_for_each_segment() {
    let c = table_a(Beyond::Error);
    let speeds = [3535.5339, 833.3333, 500.0, 288.6751];
    let velocities = [3.535_534, 11.035_534, 31.035_534, 74.336_804];
    for (i, (&strain, &velocity)) in c.strain()[1..].iter().zip(&velocities).enumerate() {
        let fan = fan_at_velocity(&c, 8000.0, impact_velocity(&c, 8000.0, strain));
        near(fan.velocity, velocity);
        near(fan.strain, strain);
        assert_eq!(fan.edges.len(), i + 1);
        for (edge, &speed) in fan.edges.iter().zip(&speeds) {
            near(edge.speed, speed);
        }
        assert!(!fan.above_critical && !fan.beyond_data);
    }
    assert!(critical(&c, 8000.0).is_none());
}

#[test]
fn yield_drop_sends_one_front_to_the_tangent_point() {
    let c = table_b(Beyond::Error);
    let edges = hull(&c, 7850.0, 0.2);
    let speeds: Vec<f64> = edges.iter().map(|e| e.speed).collect();
    assert_eq!(speeds.len(), 3);
    near(speeds[0], 5130.9808);
    near(speeds[1], 300.8819);
    near(speeds[2], 252.3772);
    assert_eq!((edges[1].strain_ahead, edges[1].strain_behind), (0.0015, 0.1));
    near(impact_velocity(&c, 7850.0, 0.0015), 7.696_471);
    near(impact_velocity(&c, 7850.0, 0.1), 37.333_339);
    near(impact_velocity(&c, 7850.0, 0.2), 62.571_063);
    assert!(critical(&c, 7850.0).is_none());
    // Across the yield drop, the velocity does not increase, and the strain jumps to where the stress is reached again (0.0569).
    let before = fan_at_velocity(&c, 7850.0, 7.6964);
    let after = fan_at_velocity(&c, 7850.0, 7.6966);
    assert!(before.strain < 0.0015);
    assert!(after.strain > 0.02 + 60.0 / 130.0 * 0.08 && after.strain < 0.0570);
}

#[test]
fn lock_up_merges_the_fronts_behind_the_precursor_into_a_shock() {
    let c = table_c(Beyond::Error);
    let fan = fan_at_velocity(&c, 200.0, 124.544_469);
    assert_eq!(fan.edges.len(), 2);
    near(fan.edges[0].speed, 707.1068);
    near(fan.edges[1].speed, 170.2513);
    near(fan.strain, 0.7);
    let fan = fan_at_velocity(&c, 200.0, 272.212_539);
    near(fan.edges[1].speed, 358.2993);
    near(fan.strain, 0.75);
    assert!(critical(&c, 200.0).is_none());
}

#[test]
fn below_yield_the_stress_is_impedance_times_velocity() {
    let c = curve(&[(0.001, 200.0), (0.1, 2180.0)], Beyond::Extend);
    let fan = fan_at_velocity(&c, 7800.0, 4.0);
    // rho c0 v = sqrt(E rho) v: three roundings.
    assert!((fan.stress / ((200e9_f64 * 7800.0).sqrt() * 4.0) - 1.0).abs() < 1e-14);
    assert!((fan.strain / (4.0 / (200e9_f64 / 7800.0).sqrt()) - 1.0).abs() < 1e-14);
    assert_eq!(fan.edges.len(), 1);
}

#[test]
fn bilinear_plateau_is_the_closed_form() {
    // E 200 GPa, E_t 20 GPa, yield 200 MPa, rho 7800, 20 m/s: sigma_y + rho c_t (v - v_y).
    let c = curve(&[(0.001, 200.0), (0.01, 380.0)], Beyond::Extend);
    let fan = fan_at_velocity(&c, 7800.0, 20.0);
    let (impedance, plastic) = ((200e9_f64 * 7800.0).sqrt(), (20e9_f64 * 7800.0).sqrt());
    let expected = 200e6 + plastic * (20.0 - 200e6 / impedance);
    assert!((fan.stress / expected - 1.0).abs() < 1e-12);
    near(fan.stress, 386.554e6);
    assert!(!fan.beyond_data);
}

#[test]
fn nothing_imposed_sends_nothing() {
    for fan in
        [fan_at_velocity(&table_a(Beyond::Error), 8000.0, 0.0), fan_at_stress(&table_a(Beyond::Error), 8000.0, 0.0)]
    {
        assert!(fan.edges.is_empty());
        assert_eq!((fan.strain, fan.stress, fan.velocity), (0.0, 0.0, 0.0));
    }
}

#[test]
fn above_the_ultimate_point_the_fan_stops_there() {
    let c = curve(&[(0.001, 100.0), (0.2, 300.0), (0.3, 250.0)], Beyond::Error);
    let v_c = critical(&c, 8000.0).expect("the maximum is inside the data");
    assert_eq!((v_c.strain, v_c.stress, v_c.reason), (0.2, 300.0 * MPA, UltimateReason::MaximumStress));
    let at = fan_at_velocity(&c, 8000.0, v_c.velocity);
    assert!(!at.above_critical && at.strain == 0.2);
    for fan in [fan_at_velocity(&c, 8000.0, v_c.velocity * 1.001), fan_at_stress(&c, 8000.0, 300.1 * MPA)] {
        assert!(fan.above_critical && !fan.beyond_data);
        assert_eq!((fan.strain, fan.stress, fan.velocity), (0.2, 300.0 * MPA, v_c.velocity));
    }
    // A specimen that fractures while its stress increases: the last knot is critical, and this is stated as the reason.
    let c = table_a(Beyond::Rupture);
    let v_c = critical(&c, 8000.0).expect("it broke");
    near(v_c.velocity, 74.336_804);
    assert_eq!(v_c.reason, UltimateReason::RuptureStrain);
}

#[test]
fn past_the_data_is_not_critical() {
    let fan = fan_at_velocity(&table_a(Beyond::Error), 8000.0, 80.0);
    assert!(fan.beyond_data && !fan.above_critical && fan.strain == 0.2);
    let fan = fan_at_velocity(&table_a(Beyond::Extend), 8000.0, 80.0);
    assert!(!fan.beyond_data && !fan.above_critical);
    near(fan.strain, 0.2 + (80.0 - 74.336_804) / 288.6751);
    let fan = fan_at_stress(&table_a(Beyond::Error), 8000.0, 340.0 * MPA);
    assert!(fan.beyond_data && fan.stress == 330.0 * MPA);
}

#[test]
fn the_state_in_the_fan_is_the_one_behind_the_fronts_that_have_passed() {
    let fan = fan_at_velocity(&table_a(Beyond::Error), 8000.0, 31.035_534);
    assert_eq!(fan.state(4000.0), (0.0, 0.0, 0.0));
    assert_eq!(fan.state(fan.edges[0].speed).0, 0.001);
    let (strain, stress, velocity) = fan.state(600.0);
    assert_eq!((strain, stress), (0.01, 150.0 * MPA));
    near(velocity, 11.035_534);
    near(fan.state(0.0).0, 0.05);
}

/// Returns ln Gamma for x > 0 by Lanczos' series (g = 7, nine terms), accurate to 1e-14.
fn ln_gamma(x: f64) -> f64 {
    const TERMS: [f64; 9] = [
        0.999_999_999_999_809_9,
        676.520_368_121_885_1,
        -1_259.139_216_722_402_8,
        771.323_428_777_653_1,
        -176.615_029_162_140_6,
        12.507_343_278_686_905,
        -0.138_571_095_265_720_12,
        9.984_369_578_019_572e-6,
        1.505_632_735_149_311_6e-7,
    ];
    let x = x - 1.0;
    let t = x + 7.5;
    let series = TERMS[0] + (1..9).map(|i| TERMS[i] / (x + i as f64)).sum::<f64>();
    0.5 * (2.0 * std::f64::consts::PI).ln() + (x + 0.5) * t.ln() - t + series.ln()
}

#[test]
fn true_stress_power_law_has_its_closed_form_critical_velocity() {
    // B(1/2, 3/2) = pi/2; the series is accurate to 1e-14.
    let check = (ln_gamma(0.5) + ln_gamma(1.5) - ln_gamma(2.0)).exp();
    assert!((check - std::f64::consts::FRAC_PI_2).abs() < 1e-13, "{check}");
    for (k, n, density) in [(530e6, 0.44, 8960.0), (600e6, 0.21, 7850.0), (410e6, 0.05, 2700.0)] {
        // Knots in geometric progression from far below any yield strain, one at the maximum, and some beyond it.
        let ratio = (n / 1e-16_f64).powf(1.0 / 6000.0);
        let rows: Vec<_> = (0..6100)
            .map(|i| {
                let strain = if i == 6000 { n } else { 1e-16 * ratio.powi(i) };
                (strain.exp_m1(), k * strain.powf(n) / strain.exp())
            })
            .collect();
        let c = Curve::new(&rows, Beyond::Error).expect("the table is right");
        let v_c = critical(&c, density).expect("the maximum is inside");
        let beta = (ln_gamma(0.5 * (n + 1.0)) + ln_gamma(1.5) - ln_gamma(0.5 * n + 2.0)).exp();
        let expected = (k / density).sqrt() * n.powf(1.0 + 0.5 * n) * beta;
        // Chords near the maximum (width w) gain 0.04 sqrt(-sigma''/rho) w^1.5 each: 3e-5 of the whole here.
        let error = v_c.velocity / expected - 1.0;
        assert!(error.abs() < 1e-4, "n = {n}: {} is not {expected}", v_c.velocity);
        // The velocity of a chord is never below that of the curve (Cauchy-Schwarz); 1e-10 for the rounding of the sum.
        assert!(error > -1e-10, "n = {n}: {error:e}");
        assert!((v_c.strain / n.exp_m1() - 1.0).abs() < 1e-12);
    }
}

/// Returns random tables that rise, fall, are level or stiffen, as steps of strain and stress.
fn tables() -> impl Strategy<Value = Curve> {
    let level = proptest::bool::weighted(0.15);
    let steps = proptest::collection::vec((1e-4..0.1_f64, 1.0..500.0_f64, level), 1..14);
    (steps, 0..3_usize).prop_map(|(steps, beyond)| {
        let (mut strain, mut before) = (0.0, 0.0);
        let row = |(d, stress, level): (f64, f64, bool)| {
            strain += d;
            before = if level && before > 0.0 { before } else { stress };
            (strain, before * MPA)
        };
        let rows: Vec<_> = steps.into_iter().map(row).collect();
        let beyond = [Beyond::Error, Beyond::Extend, Beyond::Rupture][beyond];
        Curve::new(&rows, beyond).expect("the table is right")
    })
}

const RHO: f64 = 5000.0;

/// Returns the effect of rounding of stress and strain on the velocity jump sqrt(d sigma d eps/rho) of a front. It is small, but a large fraction of
/// the jump if the stress hardly increases across the front. On a steep part of the curve, rounding of the strain causes a larger rounding of the
/// stress.
fn rounding_of_jump(edge: &Edge, curve: &Curve) -> f64 {
    let rise = edge.stress_behind - edge.stress_ahead;
    let steepest = curve.slopes().fold(0.0, |a: f64, b| a.max(b.abs()));
    let rounding = 4.0 * f64::EPSILON * (edge.stress_behind + steepest * edge.strain_behind);
    let jump = |rise: f64| (rise.max(0.0) * (edge.strain_behind - edge.strain_ahead) / RHO).sqrt();
    jump(rise + rounding) - jump(rise - rounding)
}

proptest! {
    #[test]
    fn the_hull_is_concave_connected_and_above_the_curve(c in tables(), part in 0.01..1.0_f64) {
        let strain = part * c.last_strain();
        let edges = hull(&c, RHO, strain);
        prop_assert_eq!(edges[0].strain_ahead, 0.0);
        prop_assert_eq!(edges[edges.len() - 1].strain_behind, strain);
        for pair in edges.windows(2) {
            prop_assert!(pair[1].speed < pair[0].speed);
            prop_assert_eq!(pair[1].strain_ahead, pair[0].strain_behind);
            prop_assert_eq!(pair[1].stress_ahead, pair[0].stress_behind);
        }
        for edge in &edges {
            let slope = RHO * edge.speed.powi(2);
            for i in 0..=50 {
                let e = edge.strain_ahead + (edge.strain_behind - edge.strain_ahead) * f64::from(i) / 50.0;
                // Stresses up to 500 MPa, and slopes up to 5e12 Pa times the rounding of strain: below 1 Pa.
                prop_assert!(c.stress_at(e) <= edge.stress_ahead + slope * (e - edge.strain_ahead) + 1.0);
            }
        }
    }

    #[test]
    fn the_velocity_search_finds_what_the_hull_sums(c in tables(), part in 0.001..1.3_f64) {
        let most = impact_velocity(&c, RHO, c.last_strain());
        let velocity = part * most;
        let fan = fan_at_velocity(&c, RHO, velocity);
        if fan.above_critical || fan.beyond_data {
            prop_assert!(fan.velocity < velocity);
            prop_assert_eq!(fan.above_critical, c.ultimate().is_some());
        } else {
            // The closed-form root and the sum of up to 14 terms have a few roundings each.
            let allowed = 1e-11 * velocity + fan.edges.iter().map(|edge| rounding_of_jump(edge, &c)).sum::<f64>();
            prop_assert!((fan.velocity - velocity).abs() < allowed, "{} {}", fan.velocity, velocity);
            prop_assert!((impact_velocity(&c, RHO, fan.strain) - velocity).abs() < allowed);
        }
        let jumps: f64 = fan.edges.iter().map(Edge::velocity_jump).sum();
        prop_assert!((jumps / fan.velocity - 1.0).abs() < 1e-12);
        let momentum: f64 = fan.edges.iter().map(|e| RHO * e.speed * e.velocity_jump()).sum();
        prop_assert!((momentum / fan.stress - 1.0).abs() < 1e-12);
        prop_assert_eq!(fan.state(0.0).0, fan.strain);
    }

    #[test]
    fn velocity_and_stress_searches_agree(c in tables(), part in 0.001..0.999_f64) {
        let fan = fan_at_velocity(&c, RHO, part * impact_velocity(&c, RHO, c.last_strain()));
        let same = fan_at_stress(&c, RHO, fan.stress);
        prop_assert!((same.velocity / fan.velocity - 1.0).abs() < 1e-9);
    }

    #[test]
    fn more_velocity_means_more_strain_and_stress(c in tables(), a in 0.0..1.2_f64, b in 0.0..1.2_f64) {
        let most = impact_velocity(&c, RHO, c.last_strain());
        let (low, high) = (fan_at_velocity(&c, RHO, a.min(b) * most), fan_at_velocity(&c, RHO, a.max(b) * most));
        prop_assert!(low.strain <= high.strain && low.stress <= high.stress && low.velocity <= high.velocity);
    }

    #[test]
    fn one_pass_gives_the_same_velocities(c in tables()) {
        for (strain, velocity) in impact_velocities(&c, RHO).into_iter().skip(1) {
            let single = impact_velocity(&c, RHO, strain);
            prop_assert!((velocity - single).abs() <= 1e-12 * single);
        }
    }

    #[test]
    fn the_critical_velocity_is_the_most_that_the_curve_carries(c in tables()) {
        if let Some(v_c) = critical(&c, RHO) {
            prop_assert!(!fan_at_velocity(&c, RHO, v_c.velocity).above_critical);
            prop_assert!(fan_at_velocity(&c, RHO, v_c.velocity * (1.0 + 1e-9)).above_critical);
            prop_assert!(impact_velocity(&c, RHO, c.last_strain()) <= v_c.velocity * (1.0 + 1e-12));
        }
    }
}
