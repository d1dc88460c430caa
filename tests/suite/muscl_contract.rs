//! Properties of the conservative scheme for any scene: energy balance, symmetry, the same bits on any number of threads, and no energy from
//! nothing.

use crate::common;
use crate::common::muscl;

use barwave::assemble::{medium, stepped_law};
use barwave::bar::{Bar, EndCondition, Joint, Segment};
use barwave::record::View;
use barwave::scene::{Effects, HardeningRule, Rate};
use barwave::solver::fd::{Grid, Quantity};
use barwave::solver::muscl::Muscl;
use common::{DENSITY, MODULUS};

const ISOTROPIC: Option<HardeningRule> = Some(HardeningRule::Isotropic);

fn c0() -> f64 {
    (MODULUS / DENSITY).sqrt()
}

fn busy_ends() -> Vec<EndCondition> {
    common::busy_ends(common::BUSY_AREA)
}

fn bar_of(cells: usize, ends: [EndCondition; 2], velocity: f64, hardening: Option<HardeningRule>, cfl: f64) -> Muscl {
    let segment = Segment::new(1.0, common::BUSY_AREA, common::power_law_steel()).with_velocity(velocity);
    muscl::muscl(vec![segment], ends, hardening, cells, cfl)
}

/// Largest energy that the scheme may add, relative to the total: at an end that is moved to and fro over some ten cells, errors of second order have
/// either sign.
const GIVEN: f64 = 5e-3;

#[test]
fn the_ledger_closes_for_every_pair_of_ends() {
    for (k, left) in busy_ends().into_iter().enumerate() {
        for (j, right) in busy_ends().into_iter().enumerate() {
            for (cells, velocity, hardening, cfl) in
                [(300, 0.0, ISOTROPIC, 1.0), (270, -9.0, None, 0.83), (90, 7.0, Some(HardeningRule::Mixed(0.5)), 1.0)]
            {
                let what = format!("ends {k} and {j}, {cells} cells, {velocity} m/s, cfl {cfl}");
                let mut bar = bar_of(cells, [left.clone(), right.clone()], velocity, hardening, cfl);
                let start = bar.start().energy;
                let mut ledger = barwave::record::Ledger::new(&bar);
                for _ in 0..40 {
                    (0..cells / 12).for_each(|_| bar.advance());
                    ledger.row(&bar);
                    let account = bar.account();
                    let scale = start + account.energies.kinetic + account.energies.elastic + account.energies.plastic;
                    assert!(
                        account.energies.numerical >= -GIVEN * scale,
                        "{what}: {:e}",
                        account.energies.numerical / scale
                    );
                }
                assert_eq!(bar.not_finite(), None, "{what}");
                common::assert_ledger(&ledger, &what);
            }
        }
    }
}

/// Returns the energy of the body at the left end, J: kinetic for a striker, elastic for a spring.
fn body_energy(bar: &Muscl, end: &EndCondition) -> f64 {
    match *end {
        EndCondition::Striker { mass, .. } => 0.5 * mass * bar.striker_velocities()[0].expect("a striker").powi(2),
        EndCondition::Spring { stiffness } => {
            let stretch = bar.value(Quantity::Strain, 0) * bar.grid().segments[0].dx;
            0.5 * stiffness * (bar.displacements()[0] - 0.5 * stretch).powi(2)
        }
        _ => 0.0,
    }
}

/// The energy of a body at an end and the work of that end balance.
#[test]
fn what_a_body_loses_the_bar_gets() {
    for end in [
        EndCondition::Striker { mass: 3000.0, velocity: 14.0 },
        EndCondition::Spring { stiffness: 3e10 },
        EndCondition::Spring { stiffness: 1e15 },
    ] {
        let mut bar = bar_of(400, [end.clone(), EndCondition::Free], 5.0, ISOTROPIC, 1.0);
        let start = body_energy(&bar, &end);
        for _ in 0..1200 {
            bar.advance();
        }
        let lost = start - body_energy(&bar, &end);
        let scale = start + bar.energies().total();
        // Rounding of 1200 steps.
        assert!((lost - bar.work()[0]).abs() < 1e-12 * scale, "{lost} {}", bar.work()[0]);
    }
}

/// Returns two segments with a joint, or their mirror image.
fn two(joint: Joint, mirror: bool, hardening: Option<HardeningRule>) -> Muscl {
    let sense = if mirror { -1.0 } else { 1.0 };
    let struck = Segment::new(0.6, 1.5, common::power_law_steel()).with_velocity(20.0 * sense).with_joint(joint);
    let other = common::segment(common::bilinear_steel(), 0.4).with_joint(joint);
    let ramp = [(0.0, 0.0), (5e-5, -11.0 * sense), (2e-4, 9.0 * sense)];
    let (mut segments, mut ends) = (vec![struck, other], [common::moved_by(&ramp), EndCondition::Wall { gap: 1e-4 }]);
    if mirror {
        segments.reverse();
        ends.reverse();
    }
    muscl::muscl(segments, ends, hardening, 700, 0.9)
}

#[test]
fn mirrored_bars_are_equal_bit_for_bit() {
    for joint in [Joint::Bonded, Joint::Contact { gap: 0.0 }, Joint::Contact { gap: 3e-5 }] {
        for hardening in [None, ISOTROPIC, Some(HardeningRule::Kinematic), Some(HardeningRule::Mixed(0.3))] {
            let (mut bar, mut image) = (two(joint, false, hardening), two(joint, true, hardening));
            for step in 0..1500 {
                bar.advance();
                image.advance();
                if step % 100 != 0 {
                    continue;
                }
                for (quantity, sense) in
                    [(Quantity::Stress, 1.0), (Quantity::Velocity, -1.0), (Quantity::PlasticStrain, 1.0)]
                {
                    let mut other = muscl::profile(&image, quantity);
                    other.reverse();
                    let same = muscl::profile(&bar, quantity).iter().zip(&other).all(|(a, b)| *a == sense * b);
                    assert!(same, "{joint:?} {hardening:?} {quantity:?} step {step}");
                }
            }
        }
    }
}

#[test]
fn any_number_of_threads_gives_the_same_bits() {
    let run = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("a pool");
        pool.install(|| {
            let ends = [common::moved(20.0), EndCondition::Fixed];
            let mut bar = bar_of(20_000, ends, 0.0, ISOTROPIC, 1.0);
            (0..400).for_each(|_| bar.advance());
            let mut all = muscl::profile(&bar, Quantity::Stress);
            all.extend(muscl::profile(&bar, Quantity::Velocity));
            let energies = bar.energies();
            all.extend([energies.total(), energies.numerical, energies.plastic, energies.momentum]);
            all
        })
    };
    assert!(run(1) == run(3));
}

/// Returns the relative energy that the scheme dissipates in a smooth loading wave.
fn taken(cells: usize) -> f64 {
    let rows: Vec<(f64, f64)> = (0..=2000)
        .map(|k| f64::from(k) / 2000.0)
        .map(|s| (0.5 / c0() * s, 4.0 * (std::f64::consts::PI * s).sin().powi(4)))
        .collect();
    let ends = [common::moved_by(&rows), EndCondition::Free];
    let mut bar = muscl::muscl(vec![common::segment(common::elastic_steel(), 1.0)], ends, None, cells, 0.6);
    muscl::advance_to(&mut bar, 0.9 / c0());
    bar.energies().numerical / bar.energies().total()
}

#[test]
fn what_the_scheme_takes_from_smooth_flow_vanishes_with_order() {
    let taken = [200, 400, 800].map(taken);
    let orders = [(taken[0] / taken[1]).log2(), (taken[1] / taken[2]).log2()];
    println!("taken {taken:?} orders {orders:?}");
    // Fourth derivative of the pulse times the cube of the cell size, except at its crest and feet.
    assert!(taken.iter().all(|&t| t > 0.0) && taken[2] < 2e-5, "{taken:?}");
    assert!(orders.iter().all(|&o| o > 2.3), "{orders:?}");
}

/// Four cases of a rigid mass on a bar with a free far end. Relative to the impact velocity, e = `V_bar` - `V_mass` is `m (1 - exp(-2/m)) -
/// exp(-2/m)`.
#[test]
fn a_striker_leaves_a_free_bar_as_theory_says() {
    for m in [0.5_f64, 1.0, 3.0] {
        let mass = m * DENSITY;
        let end = EndCondition::Striker { mass, velocity: 1.0 };
        let segment = common::segment(common::elastic_steel(), 1.0);
        let mut bar = muscl::muscl(vec![segment], [end, EndCondition::Free], None, 500, 1.0);
        muscl::advance_to(&mut bar, 2.6 / c0());
        let kept = bar.striker_velocities()[0].expect("a striker");
        let mean = bar.energies().momentum / bar.mass();
        let decay = (-2.0 / m).exp();
        let expected = m * (1.0 - decay) - decay;
        // Second order in the step: (2/500)^2.
        assert!((mean - kept - expected).abs() < 5e-4, "{m}: {} {expected}", mean - kept);
    }
}

#[test]
fn a_bar_at_rest_stays_at_rest_and_carries_no_state() {
    for end in [EndCondition::Free, EndCondition::Fixed, EndCondition::Absorbing, EndCondition::Wall { gap: 0.0 }] {
        let mut bar = bar_of(600, [end, EndCondition::Spring { stiffness: 1e11 }], 0.0, ISOTROPIC, 1.0);
        (0..1000).for_each(|_| bar.advance());
        assert!(muscl::profile(&bar, Quantity::Velocity).iter().all(|v| *v == 0.0));
        assert_eq!(bar.state_bytes(), 0);
    }
    // Two superposed elastic waves remain below yield, and so need no state variables.
    let mut bar = bar_of(600, [common::moved(2.0), EndCondition::Fixed], 0.0, ISOTROPIC, 1.0);
    (0..1100).for_each(|_| bar.advance());
    assert!(bar.stayed_elastic() && bar.value(Quantity::Stress, 599) < -150e6);
    assert_eq!(bar.state_bytes(), 0);
}

/// Scenes with such laws are refused; the scheme itself supports any number of state variables.
#[test]
fn a_law_of_more_than_four_state_numbers_is_no_panic() {
    let rate = Some(Rate::Malvern { k: 1e7 });
    let effects = Effects { hardening: Some(HardeningRule::Kinematic), rate, ..Effects::default() };
    let bar = Bar { segments: vec![common::segment(common::bilinear_steel(), 1.0)], area_given: true };
    let grid = Grid::new(&bar, 40, 1.0);
    let law = stepped_law(&bar.segments[0], &effects, grid.dt);
    assert!(law.law.state_len() > 4);
    let medium = medium(&bar.segments[0], &effects);
    let ends = [common::moved(12.0), EndCondition::Fixed];
    let mut bar = Muscl::new(&bar, grid, vec![law], vec![medium], ends);
    (0..100).for_each(|_| bar.advance());
    assert_eq!(bar.not_finite(), None);
    assert!(!bar.stayed_elastic());
}
