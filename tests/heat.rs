//! The effect `heat`: adiabatic curves against closed forms, bars that run on them by both methods, and the law whose
//! temperature is a state of its own.

mod common;

use std::path::Path;
use std::sync::Arc;

use barwave::assemble::{flow, segment_law, stepped_law};
use barwave::bar::{Bar, EndCondition, Segment};
use barwave::law::RowLaw;
use barwave::material::{Beyond, HeatConstants, HeatingError, Material, Sense};
use barwave::record::{Field, Ledger, View};
use barwave::scene::{Effects, Heat, Rate, Scene, Unloading};
use barwave::solver::fd::{Grid, Leapfrog, Quantity};
use barwave::solver::moc::{FrontTracking, Settings};
use common::{
    DENSITY, MODULUS, YIELD, assert_ledger, bilinear_steel, material, moved, power_law_steel, profile, segment,
};
use proptest::prelude::*;

const REFERENCE: f64 = 300.0;
const MELTING: f64 = 1300.0;

/// Ten times lighter to warm than steel, so that it counts: 1 % of strain at 300 MPa is 35 K of the 1000 K to melting.
const SPECIFIC_HEAT: f64 = 10.0;

fn with_constants(mut material: Material, exponent: f64) -> Material {
    material.constants.heat = HeatConstants {
        specific_heat: Some(SPECIFIC_HEAT),
        fraction: None,
        reference_temperature: Some(REFERENCE),
        melting_temperature: Some(MELTING),
        exponent: Some(exponent),
    };
    material
}

fn heated(material: Material, exponent: f64, fraction: f64) -> Material {
    with_constants(material, exponent).heated(Some(fraction)).expect("all constants are there")
}

fn effects(unloading: Unloading, rate: Option<Rate>) -> Effects {
    let heat = Some(Heat { fraction: None });
    Effects { unloading: Some(unloading), rate, heat, ..Effects::default() }
}

/// The general law, whose temperature is a state, with flow that takes no time.
const STATE: Option<Rate> = Some(Rate::Malvern { k: 1e300 });

fn bar(segments: Vec<Segment>, ends: [EndCondition; 2], effects: &Effects, cells: usize) -> Leapfrog {
    let bar = Bar { segments, area_given: true };
    let grid = Grid::new(&bar, cells, 1.0);
    let laws = bar.segments.iter().map(|s| stepped_law(s, effects, grid.dt)).collect();
    Leapfrog::new(&bar, grid, laws, ends)
}

fn c0() -> f64 {
    (MODULUS / DENSITY).sqrt()
}

/// Rises smoothly to `velocity`, goes back, and is let go.
fn pulse(velocity: f64) -> EndCondition {
    let rows: Vec<(f64, f64)> = (0..=64)
        .map(|k| f64::from(k) / 64.0)
        .map(|s| (0.6 * s / c0(), -velocity * (std::f64::consts::PI * s).sin().powi(2)))
        .collect();
    common::moved_by(&rows)
}

/// Work that warms the material to melting if the stress stayed at the yield stress: plastic strain.
fn scale(fraction: f64) -> f64 {
    DENSITY * SPECIFIC_HEAT * (MELTING - REFERENCE) / (fraction * YIELD)
}

#[test]
fn perfect_plasticity_softens_exponentially() {
    let fraction = 0.9;
    for beyond in [Beyond::Rupture, Beyond::Extend] {
        let cold = material(&[(0.001, YIELD), (2.0, YIELD)], beyond);
        let warm = heated(cold, 1.0, fraction);
        let curve = &warm.tension;
        let (mut worst, mut knots) = (0.0_f64, 0.0_f64);
        for k in 1..=4000 {
            let p = 1.999 * f64::from(k) / 4000.0;
            let exact = YIELD * (-p / scale(fraction)).exp();
            worst = worst.max((curve.stress_at(p + exact / MODULUS) - exact).abs() / YIELD);
        }
        for (e, s) in curve.strain().iter().zip(curve.stress()).skip(1).take_while(|(e, _)| **e < 2.0) {
            knots = knots.max((s / YIELD - (-(e - s / MODULUS) / scale(fraction)).exp()).abs());
        }
        // Between the knots the table's own tolerance; at the knots rounding, of strain differences around 1.
        assert!(worst < 1e-4 && knots < 1e-12, "{beyond:?}: {worst:e} {knots:e}");
        let heating = warm.heating.as_ref().expect("it heats");
        // Solvers follow the falling curve level, so that there the work goes on as p Y, until the metal melts.
        let level = heating.temperature(Sense::Tension, 0.1) - REFERENCE;
        assert!((level / ((MELTING - REFERENCE) * 0.1 / scale(fraction)) - 1.0).abs() < 1e-12, "{level}");
        assert_eq!(heating.temperature(Sense::Tension, 10.0), MELTING);
        assert!(
            curve.ultimate().is_some_and(|u| (u.stress - YIELD).abs() < 1.0),
            "the maximum is where it starts to flow"
        );
    }
}

/// Linear hardening f = Y + H p with m = 1: stress (Y + H p) exp(-(Y p + H p^2/2)/(rho c (Tm - Tr)/chi)), largest where
/// f^2 = H rho c (Tm - Tr)/chi.
#[test]
fn linear_hardening_has_its_largest_stress_where_softening_overtakes() {
    let warm = heated(bilinear_steel(), 1.0, 0.9);
    let hardening = 20e9 / (1.0 - 0.1);
    let capacity = DENSITY * SPECIFIC_HEAT * (MELTING - REFERENCE) / 0.9;
    let exact = |p: f64| (YIELD + hardening * p) * (-(YIELD * p + 0.5 * hardening * p * p) / capacity).exp();
    let largest = ((hardening * capacity).sqrt() - YIELD) / hardening;
    let top = warm.tension.ultimate().expect("softening overtakes");
    assert!((top.stress / exact(largest) - 1.0).abs() < 1e-6, "{top:?} {}", exact(largest));
    assert!((top.strain - largest - exact(largest) / MODULUS).abs() < 2e-3 * largest, "{top:?} {largest}");
    for k in 1..1000 {
        let p = 2.0 * largest * f64::from(k) / 1000.0;
        let error = warm.tension.stress_at(p + exact(p) / MODULUS) - exact(p);
        assert!(error.abs() < 1e-4 * 600e6, "{p}: {error:e}");
    }
    assert!(warm.tension.stress().iter().all(|s| *s >= 0.0));
}

#[test]
fn nothing_heats_where_the_fraction_is_zero() {
    let ends = || [pulse(30.0), EndCondition::Fixed];
    for (unloading, rate) in [
        (Unloading::Isotropic, None),
        (Unloading::Mixed(0.3), None),
        (Unloading::Mixed(0.3), Some(Rate::Malvern { k: 1e6 })),
        (Unloading::Isotropic, Some(Rate::JohnsonCook { c: 0.02, reference: 1.0 })),
    ] {
        let cold = Effects { heat: None, ..effects(unloading, rate) };
        let [zero, none] = [heated(power_law_steel(), 1.0, 0.0), power_law_steel()];
        assert_eq!(zero.tension, none.tension);
        let law = |m: &Material, e: &Effects| stepped_law(&segment(m.clone(), 1.0), e, 1e-6).law;
        let lens = [law(&zero, &effects(unloading, rate)).state_len(), law(&none, &cold).state_len()];
        assert_eq!(lens[0], lens[1], "no state for nothing");
        let mut with = bar(vec![segment(zero, 1.0)], ends(), &effects(unloading, rate), 600);
        let mut without = bar(vec![segment(none, 1.0)], ends(), &cold, 600);
        common::advance(&mut with, 1200);
        common::advance(&mut without, 1200);
        for quantity in [Quantity::Stress, Quantity::Strain, Quantity::Velocity, Quantity::AccumulatedPlasticStrain] {
            assert_eq!(profile(&with, quantity), profile(&without, quantity), "{unloading:?} {rate:?} {quantity:?}");
        }
        assert_eq!(with.energies(), without.energies());
        assert!(profile(&with, Quantity::Temperature).iter().all(|t| *t == REFERENCE));
        assert!(profile(&without, Quantity::Temperature).iter().all(|t| t.is_nan()));
    }
}

#[test]
fn on_the_adiabatic_curve_a_cell_keeps_nothing_more() {
    let law = |m: Material| segment_law(&segment(m, 1.0), &effects(Unloading::Isotropic, None)).law.state_len();
    assert_eq!(law(heated(power_law_steel(), 1.0, 0.9)), law(power_law_steel()));
}

/// Relative L1 difference of the stresses of two bars over the looks of a run.
fn difference(
    (cells, left): (usize, EndCondition),
    material: &Material,
    reference: &mut dyn FnMut(f64, &[f64]) -> Vec<f64>,
    effects: &Effects,
) -> f64 {
    let ends = [left, EndCondition::Fixed];
    let mut grid = bar(vec![segment(material.clone(), 1.0)], ends, effects, cells);
    let x = grid.grid().centres();
    let (mut missed, mut total) = (0.0, 0.0);
    for look in 1..=20 {
        common::advance_to(&mut grid, 2.0 / c0() * f64::from(look) / 20.0);
        let exact = reference(grid.time(), &x);
        for (found, exact) in profile(&grid, Quantity::Stress).iter().zip(&exact) {
            missed += (found - exact).abs();
            total += exact.abs();
        }
    }
    missed / total
}

fn tracked(material: &Material, ends: [EndCondition; 2]) -> FrontTracking {
    let bar = Bar { segments: vec![segment(material.clone(), 1.0)], area_given: true };
    let settings = Settings { front_tolerance: 3e-4, ..Settings::default() };
    FrontTracking::new(&bar, flow(&effects(Unloading::Isotropic, None)), ends, settings)
}

/// Loading, unloading and reflection from a fixed end: both methods run on the one adiabatic curve.
#[test]
fn both_methods_agree_on_a_bar_that_warms() {
    let rows = [(0.001, YIELD), (0.004, 260e6), (0.02, 330e6), (0.06, 400e6)];
    let warm = heated(material(&rows, Beyond::Rupture), 1.09, 0.9);
    eprintln!("knots {}", warm.tension.strain().len());
    // Pulled at once, and let go when the elastic wave is half-way through.
    let left = || EndCondition::Velocity { history: common::history(&[(0.0, -25.0)]), release: Some(0.5 / c0()) };
    let by_cells = |cells: usize| {
        let mut tracked = tracked(&warm, [left(), EndCondition::Fixed]);
        let mut read = |time: f64, x: &[f64]| {
            tracked.advance_to(time).expect("within the budget");
            let mut stress = vec![0.0; x.len()];
            tracked.sweep(x, |k, _, point| stress[k] = point.stress);
            stress
        };
        difference((cells, left()), &warm, &mut read, &effects(Unloading::Isotropic, None))
    };
    let [coarse, fine] = [400, 1600].map(by_cells);
    eprintln!("curve: fd to moc {coarse:e} {fine:e}");
    assert!(fine < 2e-3 && fine < 0.5 * coarse, "{coarse:e} {fine:e}");
}

/// The general law is that of the curve where hardening is isotropic: what it is off goes down with the step.
#[test]
fn a_temperature_that_is_a_state_tends_to_that_of_the_curve() {
    let warm = heated(power_law_steel(), 1.09, 0.9);
    let top = warm.tension.ultimate().unwrap();
    eprintln!("{top:?} {:?}", barwave::wave::similarity::critical(&warm.tension, DENSITY));
    for v in [5.0, 10.0, 15.0, 20.0, 25.0] {
        let by_cells = |cells: usize| {
            let ends = [pulse(v), EndCondition::Fixed];
            let mut curve = bar(vec![segment(warm.clone(), 1.0)], ends, &effects(Unloading::Isotropic, None), cells);
            let mut read = |time: f64, _: &[f64]| {
                common::advance_to(&mut curve, time);
                profile(&curve, Quantity::Stress)
            };
            difference((cells, pulse(v)), &warm, &mut read, &effects(Unloading::Isotropic, STATE))
        };
        let errors = [100, 200, 400, 800, 1600].map(by_cells);
        eprintln!("state to curve {v} {errors:?}");
    }
}
