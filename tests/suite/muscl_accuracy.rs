//! Accuracy of the conservative scheme: second order in smooth flow, fronts, and correct shocks.

use crate::common;
use crate::common::muscl;

use std::sync::Arc;

use barwave::bar::{EndCondition, Segment};
use barwave::material::{Beyond, Curve, Material};
use barwave::scene::HardeningRule;
use barwave::solver::fd::Quantity;
use barwave::solver::muscl::Muscl;
use barwave::wave::similarity::{Fan, fan_at_velocity};
use common::{DENSITY, MODULUS, YIELD};

const ISOTROPIC: Option<HardeningRule> = Some(HardeningRule::Isotropic);

fn c0() -> f64 {
    (MODULUS / DENSITY).sqrt()
}

fn order(coarse: f64, fine: f64, refinement: f64) -> f64 {
    (coarse / fine).ln() / refinement.ln()
}

/// Returns the relative L1 error of a quantity at the cell centres.
fn error(bar: &Muscl, quantity: Quantity, exact: impl Fn(f64) -> f64) -> f64 {
    let (mut missed, mut total) = (0.0, 0.0);
    for (x, found) in bar.grid().centres().into_iter().zip(muscl::profile(bar, quantity)) {
        missed += (found - exact(x)).abs();
        total += exact(x).abs();
    }
    missed / total
}

/// Returns a bar of 1 m that is pushed from rest at t = 0, with an absorbing far end.
fn pushed(material: &Arc<Material>, velocity: f64, hardening: Option<HardeningRule>, cells: usize, time: f64) -> Muscl {
    pushed_at(1.0, material, velocity, hardening, cells, time)
}

fn pushed_at(
    cfl: f64,
    material: &Arc<Material>,
    velocity: f64,
    hardening: Option<HardeningRule>,
    cells: usize,
    time: f64,
) -> Muscl {
    let segment = Segment::new(1.0, 1.0, Arc::clone(material));
    let mut bar =
        muscl::muscl(vec![segment], [common::moved(velocity), EndCondition::Absorbing], hardening, cells, cfl);
    muscl::advance_to(&mut bar, time);
    bar
}

/// Returns the relative L1 error of stress against the self-similar solution of the table.
fn similarity_error(bar: &Muscl, fan: &Fan) -> f64 {
    let time = bar.time();
    error(bar, Quantity::Stress, |x| -fan.state(x / time).1)
}

/// Returns the error of P1, P2 or P3 at 0.8 L/c0.
fn benchmark(material: &Material, velocity: f64, cells: usize, hardening: Option<HardeningRule>) -> f64 {
    let material = Arc::new(material.clone());
    let fan = fan_at_velocity(&material.tension, material.density, velocity);
    similarity_error(&pushed(&material, velocity, hardening, cells, 0.8 / c0()), &fan)
}

#[test]
fn p1_is_exact() {
    // At Courant number 1, a cell receives the wave of its neighbour unchanged: 800 steps of one rounding each.
    let error = benchmark(&common::elastic_steel(), 10.0, 1000, None);
    assert!(error < 1e-12, "{error:e}");
}

/// Returns the stress of the smooth power law at x/t, see `tests/suite/benchmarks.rs`.
fn p3_exact(xi: f64) -> f64 {
    let (n, yield_strain) = (0.2_f64, YIELD / MODULUS);
    let largest = ((20.0 / (c0() * yield_strain) - 1.0) * 0.6 / n.sqrt() + 1.0).powf(1.0 / 0.6);
    let ratio = (xi / (n.sqrt() * c0())).powf(2.0 / (n - 1.0)).clamp(1.0, largest);
    if xi < c0() { YIELD * ratio.powf(n) } else { 0.0 }
}

/// Returns the error of P3 with a table of 1000 knots, which differs from the power law by less than 3e-6.
fn p3(cells: usize, hardening: Option<HardeningRule>) -> f64 {
    let bar = pushed(&Arc::new(common::power_law_table(1000)), 20.0, hardening, cells, 0.8 / c0());
    let time = bar.time();
    error(&bar, Quantity::Stress, |x| -p3_exact(x / time))
}

const CELLS: [usize; 3] = [500, 1000, 2000];

/// With isotropic hardening, and with a curve that is followed both ways.
#[test]
fn p2_and_p3_meet_their_bounds_and_converge() {
    for hardening in [ISOTROPIC, None] {
        let bilinear = CELLS.map(|cells| benchmark(&common::bilinear_steel(), 20.0, cells, hardening));
        let power_law = CELLS.map(|cells| p3(cells, hardening));
        let orders = [bilinear, power_law].map(|errors| errors.windows(2).map(|e| order(e[0], e[1], 2.0)).collect());
        let orders: [Vec<f64>; 2] = orders;
        println!("{hardening:?}: P2 {bilinear:?} P3 {power_law:?} orders {orders:?}");
        assert!(bilinear[1] < 1.8e-3, "{bilinear:?}");
        assert!(power_law[1] < 1.5e-3, "{power_law:?}");
        // A front of constant width in cells is of first order; one that spreads over dx^(2/3) is not.
        assert!(orders.iter().flatten().all(|&o| o > 0.8), "{orders:?}");
    }
}

/// If a curve becomes level at its end, the scheme must not drop the slopes of all cells in which they have given energy, independent of their
/// position on the curve: the error would be three to five times as large.
#[test]
fn rows_of_a_curve_that_the_bar_never_comes_to_change_little() {
    let rows = [(0.0, 0.0), (1e-3, 200.0), (0.021, 600.0), (0.5, 600.0)];
    let [rising, level] =
        [&rows[..3], &rows].map(|rows| CELLS.map(|cells| benchmark(&table(rows, DENSITY), 20.0, cells, ISOTROPIC)));
    println!("{rising:?} {level:?}");
    for (rising, level) in rising.into_iter().zip(level) {
        assert!((level / rising - 1.0).abs() < 0.05, "{rising} {level}");
    }
}

/// Returns the measured speed of a front: the position where the strain passes the middle between its two sides, divided by time.
fn measured_speed(bar: &Muscl, strains: [f64; 2]) -> f64 {
    let level = 0.5 * (strains[0] + strains[1]);
    let strain = muscl::profile(bar, Quantity::Strain);
    let last = strain.iter().rposition(|e| -e > level).expect("a front");
    let (behind, ahead) = (-strain[last], -strain[last + 1]);
    let x = bar.grid().centres()[last] + bar.grid().segments[0].dx * (behind - level) / (behind - ahead);
    x / bar.time()
}

fn table(rows: &[(f64, f64)], density: f64) -> Arc<Material> {
    let rows: Vec<(f64, f64)> = rows.iter().map(|&(strain, mega)| (strain, mega * 1e6)).collect();
    Arc::new(
        Material::from_curve("table", density, Curve::new(&rows, Beyond::Extend).expect("rows are right"))
            .expect("a material"),
    )
}

/// Tables T-A, T-B and T-C with the impact velocity, and (speed, strain ahead, strain behind) of their fronts.
type Printed = (&'static str, Arc<Material>, f64, Vec<(f64, f64, f64)>);

fn printed() -> Vec<Printed> {
    let a = table(&[(0.001, 100.0), (0.01, 150.0), (0.05, 230.0), (0.2, 330.0)], 8000.0);
    let b = table(&[(0.0015, 310.0), (0.0016, 250.0), (0.02, 250.0), (0.1, 380.0), (0.2, 430.0)], 7850.0);
    let c = table(&[(0.01, 1.0), (0.6, 1.2), (0.7, 5.0), (0.75, 20.0)], 200.0);
    vec![
        (
            "T-A",
            a,
            74.336_804,
            vec![(3535.5339, 0.0, 0.001), (833.3333, 0.001, 0.01), (500.0, 0.01, 0.05), (288.6751, 0.05, 0.2)],
        ),
        ("T-B", b, 62.571_063, vec![(5130.9808, 0.0, 0.0015), (300.8819, 0.0015, 0.1), (252.3772, 0.1, 0.2)]),
        ("T-C", Arc::clone(&c), 124.544_469, vec![(707.1068, 0.0, 0.01), (170.2513, 0.01, 0.7)]),
        ("T-C, further", c, 272.212_539, vec![(707.1068, 0.0, 0.01), (358.2993, 0.01, 0.75)]),
    ]
}

/// The solution has the fronts of the hull, with their speeds and the plateau behind them, and no others. With slopes inside shocks, T-B's two slow
/// fronts would travel as one of 281 m/s at any resolution.
///
/// With hardening, the overshoot of a strong shock in its cells remains as strain, and slows the shock: 1 % of the speed and of the stress at Courant
/// number 0.5, at any resolution. (Leapfrog's shock in T-C is 6 % slow.)
#[test]
fn printed_tables_have_their_fronts() {
    for (name, material, velocity, fronts) in printed() {
        let fan = fan_at_velocity(&material.tension, material.density, velocity);
        for (hardening, cfl, kept) in [(None, 0.5, 0.0), (ISOTROPIC, 0.5, 0.01)] {
            let errors = [300, 500].map(|cells| {
                // While the precursor is in the bar, and when the fastest front behind it has travelled most of the way.
                let stages = [(0.9 / fronts[0].0, &fronts[..1]), (0.8 / fronts[1].0, &fronts[1..])];
                let mut bar = pushed_at(cfl, &material, velocity, hardening, cells, 0.0);
                for (time, fronts) in stages {
                    muscl::advance_to(&mut bar, time);
                    for &(speed, ahead, behind) in fronts {
                        let found = measured_speed(&bar, [ahead, behind]);
                        println!("{name} {hardening:?} {cells}: {speed} {found}");
                        // The position of a front is known to its cell, and to its delay while the first cells were loaded.
                        let near = 3.0 * bar.grid().segments[0].dx / bar.time() + kept * speed;
                        assert!((found - speed).abs() < near, "{name} {hardening:?} {cells}: {speed} {found}");
                    }
                }
                let stress = muscl::profile(&bar, Quantity::Stress);
                let slowest = fronts[fronts.len() - 1].0 * bar.time() / bar.grid().segments[0].dx;
                let (plateau, inside) = (-fan.state(0.0).1, (0.1 * slowest) as usize..(0.9 * slowest) as usize);
                let mean = stress[inside.clone()].iter().sum::<f64>() / inside.len() as f64;
                assert!((mean / plateau - 1.0).abs() < 5e-3 + kept, "{name} {hardening:?} {cells}: {mean} {plateau}");
                similarity_error(&bar, &fan)
            });
            println!("{name} {hardening:?}: {errors:?} order {}", order(errors[0], errors[1], 5.0 / 3.0));
            assert!(errors.iter().all(|&e| e < 0.015), "{name} {hardening:?}: {errors:?}");
        }
    }
}

/// Returns the error of a smooth pulse below yield, sin^4 with a length of 0.2 L, against sigma = -rho c0 v(t - x/c0).
fn smooth_pulse(cells: usize, cfl: f64) -> f64 {
    let history = common::smooth_pulse(0.2 / c0());
    let pushed = EndCondition::Velocity { history: history.clone(), release: None };
    let segment = common::segment(common::elastic_steel(), 1.0);
    let mut bar = muscl::muscl(vec![segment], [pushed, EndCondition::Free], None, cells, cfl);
    muscl::advance_to(&mut bar, 0.8 / c0());
    let (time, impedance) = (bar.time(), DENSITY * c0());
    error(&bar, Quantity::Stress, |x| -impedance * history.at(time - x / c0()))
}

#[test]
fn a_smooth_elastic_pulse_converges_with_order_two() {
    let errors = [500, 1000, 2000].map(|cells| smooth_pulse(cells, 0.5));
    let orders: Vec<f64> = errors.windows(2).map(|e| order(e[0], e[1], 2.0)).collect();
    println!("elastic pulse {errors:?} {orders:?}");
    assert!(errors[1] < 3e-3, "{errors:?}");
    // The scheme is of first order at the crest, where slopes change sign, in a decreasing fraction of the cells: the order approaches two from
    // below.
    assert!(orders.iter().all(|&o| o > 1.8), "{orders:?}");
    // At Courant number 1, the only error is that of the end, which uses the mean over a step for the middle of it.
    assert!(smooth_pulse(1000, 1.0) < 1e-4);
}

const FLATTENS: f64 = 0.02;

/// Returns `sigma = E (eps - eps^2/(2 FLATTENS))` as a table of 16000 lines up to three quarters of the maximum: smooth for any grid here.
fn parabola() -> Arc<Material> {
    let row = |k: u32| {
        let strain = 0.75 * FLATTENS * f64::from(k) / 16_000.0;
        (strain, MODULUS * (strain - strain * strain / (2.0 * FLATTENS)))
    };
    let rows: Vec<(f64, f64)> = (1..=16_000).map(row).collect();
    Arc::new(common::material(&rows, Beyond::Extend))
}

/// Returns the strain at which a simple wave has this velocity: `v = 2/3 c0 FLATTENS (1 - (1 - eps/FLATTENS)^(3/2))`.
fn parabola_strain(velocity: f64) -> f64 {
    FLATTENS * (1.0 - (1.0 - 1.5 * velocity / (c0() * FLATTENS)).powf(2.0 / 3.0))
}

/// Returns the error of a bar pushed with smoothly increasing velocity into plastic flow: a simple wave, in which every velocity has its own speed.
fn smooth_loading(cells: usize, hardening: Option<HardeningRule>) -> f64 {
    let material = parabola();
    let (top, rise) = (0.4 * c0() * FLATTENS, 0.4 / c0());
    let imposed = |t: f64| {
        let s = (t / rise).clamp(0.0, 1.0);
        top * s * s * s * (10.0 - 15.0 * s + 6.0 * s * s)
    };
    let rows: Vec<(f64, f64)> =
        (0..=20_000).map(|k| 1.1 / c0() * f64::from(k) / 2e4).map(|t| (t, imposed(t))).collect();
    let segment = Segment::new(1.0, 1.0, material);
    let ends = [common::moved_by(&rows), EndCondition::Free];
    let mut bar = muscl::muscl(vec![segment], ends, hardening, cells, 1.0);
    muscl::advance_to(&mut bar, 0.9 / c0());
    let time = bar.time();
    error(&bar, Quantity::Strain, |x| {
        let speed = |t: f64| c0() * (1.0 - parabola_strain(imposed(t)) / FLATTENS).sqrt();
        let (mut early, mut late) = (0.0_f64.min(time - x / c0()), time);
        for _ in 0..80 {
            let middle = 0.5 * (early + late);
            if speed(middle) * (time - middle) > x { early = middle } else { late = middle }
        }
        -parabola_strain(imposed(early))
    })
}

#[test]
fn smooth_plastic_loading_converges_with_order_two() {
    for hardening in [ISOTROPIC, None, Some(HardeningRule::Mixed(0.4))] {
        let errors = [200, 400, 800].map(|cells| smooth_loading(cells, hardening));
        let orders: Vec<f64> = errors.windows(2).map(|e| order(e[0], e[1], 2.0)).collect();
        println!("plastic loading {hardening:?} {errors:?} {orders:?}");
        assert!(errors[0] < 1e-4, "{errors:?}");
        // The curvature jumps at the crest of the velocity and at the foot of the wave: the order approaches two from below.
        assert!(orders.iter().all(|&o| o > 1.75), "{hardening:?}: {orders:?}");
    }
}

/// No front has a stress outside the values of its two sides, except for the error of the first cells of a sudden load: behind them the plateau is
/// uniform to 3e-5 or 5e-4 (60 knots), and the difference decreases with the cell size.
#[test]
fn fronts_are_monotone() {
    for (material, velocity, rounding) in [
        (common::elastic_steel(), 10.0, 1e-12),
        (common::bilinear_steel(), 20.0, 3e-5),
        (common::power_law_steel(), 20.0, 5e-4),
    ] {
        for hardening in [ISOTROPIC, None] {
            let material = Arc::new(material.clone());
            let bar = pushed(&material, velocity, hardening, 1000, 0.8 / c0());
            let fan = fan_at_velocity(&material.tension, material.density, velocity);
            let (plateau, stress) = (fan.state(0.0).1, muscl::profile(&bar, Quantity::Stress));
            let mut lowest = -stress[0];
            for (i, found) in stress.iter().map(|s| -s).enumerate() {
                assert!(found < plateau * (1.0 + rounding), "{hardening:?} cell {i}: {found} of {plateau}");
                assert!(found < lowest + rounding * plateau, "{hardening:?} cell {i}: rises by {}", found - lowest);
                lowest = lowest.min(found);
            }
        }
    }
}
