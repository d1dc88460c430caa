//! The effect `heat`: adiabatic curves against closed forms, bars with adiabatic curves with both methods, and the law whose temperature is a state
//! variable.

use crate::common;

use std::ops::ControlFlow;
use std::path::Path;

use barwave::assemble::{flow, segment_law, stepped_law};
use barwave::bar::{Bar, EndCondition, Segment};
use barwave::law::Row;
use barwave::material::{Beyond, HeatConstants, HeatingError, Material, Sense};
use barwave::record::{Field, Ledger};
use barwave::run::solve;
use barwave::scene::{Effects, HardeningRule, Heat, Rate, Scene};
use barwave::solver::fd::{Grid, Leapfrog, Quantity};
use barwave::solver::moc::{FrontTracking, Settings};
use barwave::wave::similarity;
use common::{DENSITY, MODULUS, YIELD, assert_ledger, bilinear_steel, material, power_law_steel, profile, segment};
use proptest::prelude::*;

const REFERENCE: f64 = 300.0;
const MELTING: f64 = 1300.0;

/// Specific heat, J/(kg K), about a fiftieth of that of steel, so that the effect is large: 1 % of strain at 300 MPa is 35 K of the 1000 K to
/// melting.
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

fn effects(hardening: HardeningRule, rate: Option<Rate>) -> Effects {
    let heat = Some(Heat { fraction: None });
    Effects { hardening: Some(hardening), rate, heat, ..Effects::default() }
}

/// The general law, whose temperature is a state variable, with instantaneous flow.
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

/// Returns an end whose velocity rises smoothly to `velocity`, decreases, and which is then released.
fn pulse(velocity: f64) -> EndCondition {
    let rows: Vec<(f64, f64)> = (0..=64)
        .map(|k| f64::from(k) / 64.0)
        .map(|s| (0.6 * s / c0(), -velocity * (std::f64::consts::PI * s).sin().powi(2)))
        .collect();
    common::moved_by(&rows)
}

/// Returns the plastic strain whose work would heat the material to melting if the stress remained at yield.
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
        // Between the knots the tolerance of the table; at the knots rounding, of strain differences around 1.
        assert!(worst < 1e-4 && knots < 1e-12, "{beyond:?}: {worst:e} {knots:e}");
        let heating = warm.heating.as_ref().expect("it heats");
        // Solvers replace the falling curve by a level one, along which the plastic work is p Y until the metal melts.
        let level = heating.temperature(Sense::Tension, 0.1) - REFERENCE;
        assert!((level / ((MELTING - REFERENCE) * 0.1 / scale(fraction)) - 1.0).abs() < 1e-12, "{level}");
        assert_eq!(heating.temperature(Sense::Tension, 10.0), MELTING);
        assert!(
            curve.ultimate().is_some_and(|u| (u.stress - YIELD).abs() < 1.0),
            "the maximum is where it starts to flow"
        );
    }
}

/// Linear hardening f = Y + H p with m = 1: the stress is (Y + H p) exp(-(Y p + H p^2/2)/(rho c (Tm - Tr)/chi)), with its maximum where
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
    for (hardening, rate) in [
        (HardeningRule::Isotropic, None),
        (HardeningRule::Mixed(0.3), None),
        (HardeningRule::Mixed(0.3), Some(Rate::Malvern { k: 1e6 })),
        (HardeningRule::Isotropic, Some(Rate::JohnsonCook { c: 0.02, reference: 1.0 })),
    ] {
        let cold = Effects { heat: None, ..effects(hardening, rate) };
        let [zero, none] = [heated(power_law_steel(), 1.0, 0.0), power_law_steel()];
        assert_eq!(zero.tension, none.tension);
        let law = |m: &Material, e: &Effects| stepped_law(&segment(m.clone(), 1.0), e, 1e-6).law;
        let lens = [law(&zero, &effects(hardening, rate)).state_len(), law(&none, &cold).state_len()];
        assert_eq!(lens[0], lens[1], "no state for nothing");
        let mut with = bar(vec![segment(zero, 1.0)], ends(), &effects(hardening, rate), 600);
        let mut without = bar(vec![segment(none, 1.0)], ends(), &cold, 600);
        common::advance(&mut with, 1200);
        common::advance(&mut without, 1200);
        for quantity in [Quantity::Stress, Quantity::Strain, Quantity::Velocity, Quantity::AccumulatedPlasticStrain] {
            assert_eq!(profile(&with, quantity), profile(&without, quantity), "{hardening:?} {rate:?} {quantity:?}");
        }
        assert_eq!(with.energies(), without.energies());
        assert!(profile(&with, Quantity::Temperature).iter().all(|t| *t == REFERENCE));
        assert!(profile(&without, Quantity::Temperature).iter().all(|t| t.is_nan()));
    }
}

#[test]
fn on_the_adiabatic_curve_a_cell_keeps_nothing_more() {
    let law = |m: Material| segment_law(&segment(m, 1.0), &effects(HardeningRule::Isotropic, None)).law.state_len();
    assert_eq!(law(heated(power_law_steel(), 1.0, 0.9)), law(power_law_steel()));
}

/// Returns the relative L1 difference of the stresses of two bars at several times of a run.
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
    FrontTracking::new(&bar, flow(&effects(HardeningRule::Isotropic, None)), ends, settings)
}

/// Loading, unloading and reflection from a fixed end: both methods use the same adiabatic curve.
#[test]
fn both_methods_agree_on_a_bar_that_warms() {
    let rows = [(0.001, YIELD), (0.004, 260e6), (0.02, 330e6), (0.06, 400e6)];
    let warm = heated(material(&rows, Beyond::Rupture), 1.09, 0.9);
    // Pulled suddenly, and released when the elastic wave is half-way.
    let left = || EndCondition::Velocity { history: common::history(&[(0.0, -25.0)]), release: Some(0.5 / c0()) };
    let by_cells = |cells: usize| {
        let mut tracked = tracked(&warm, [left(), EndCondition::Fixed]);
        let mut read = |time: f64, x: &[f64]| {
            tracked.advance_to(time).expect("within the budget");
            let mut stress = vec![0.0; x.len()];
            tracked.sweep(x, |k, _, point| stress[k] = point.stress);
            stress
        };
        difference((cells, left()), &warm, &mut read, &effects(HardeningRule::Isotropic, None))
    };
    let [coarse, fine] = [400, 1600].map(by_cells);
    // As without heat, the plastic fronts of a grid are a few cells wide.
    assert!(fine < 1e-2 && fine < 0.45 * coarse, "{coarse:e} {fine:e}");
}

/// In a whole bar with reflections, too, the general law agrees with the adiabatic curve if hardening is isotropic: the difference is the tolerance
/// of the table. (Elastic ripples in the unloaded bar, which are damped in some cells only, cause larger differences.)
#[test]
fn a_bar_whose_temperature_is_a_state_is_that_of_the_curve() {
    let warm = heated(power_law_steel(), 1.09, 0.9);
    let bars = [None, STATE].map(|rate| {
        let ends = [pulse(10.0), EndCondition::Fixed];
        let mut bar = bar(vec![segment(warm.clone(), 1.0)], ends, &effects(HardeningRule::Isotropic, rate), 400);
        common::advance(&mut bar, 800);
        bar
    });
    for (quantity, tolerance) in [(Quantity::AccumulatedPlasticStrain, 2e-4), (Quantity::Temperature, 2e-4)] {
        let [one, other] = bars.each_ref().map(|bar| profile(bar, quantity));
        let range =
            |values: &[f64]| values.iter().copied().fold(0.0, f64::max) - values.iter().copied().fold(1e9, f64::min);
        let off = one.iter().zip(&other).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max) / range(&one);
        assert!(off < tolerance, "{quantity:?}: {off:e}");
    }
}

/// Returns the stresses of a cell along a strain path, with the general law in equal strain steps, and on the adiabatic curve.
fn along(material: &Material, path: &[f64], steps: usize, effects: &Effects) -> Vec<f64> {
    let law = stepped_law(&segment(material.clone(), 1.0), effects, 1e-6).law;
    let (mut sigma, mut state) = (vec![0.0], vec![0.0; law.state_len()]);
    let (mut strain, mut seen) = (0.0, Vec::new());
    for &to in path {
        let increment = (to - strain) / steps as f64;
        for _ in 0..steps {
            let v = [0.0, increment];
            let flow = &mut [0.0];
            let row =
                Row { gain: MODULUS, v: &v, sigma: &mut sigma, work: None, onset_correction: None, flow, cells: 0..1 };
            law.advance(row, &mut state);
        }
        strain = to;
        seen.extend([sigma[0] / YIELD, law.temperature(&state, 0) / REFERENCE]);
    }
    seen
}

/// The error of a cell with the general law along loading, further loading and elastic unloading is of second order in the step; in the limit it is
/// on the adiabatic curve, to the tolerance of the table.
#[test]
fn a_temperature_that_is_a_state_tends_to_that_of_the_curve() {
    let path = [0.01, 0.03, 0.029];
    let off = |one: &[f64], other: &[f64]| one.iter().zip(other).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    for exponent in [1.0, 1.09, 0.7] {
        let warm = heated(power_law_steel(), exponent, 0.9);
        let by_steps = |steps: usize| along(&warm, &path, steps, &effects(HardeningRule::Isotropic, STATE));
        let (limit, curve) = (by_steps(5000), along(&warm, &path, 5000, &effects(HardeningRule::Isotropic, None)));
        // Tolerance of the table, 1e-4 of the largest cold stress, relative to the yield stress.
        assert!(off(&limit, &curve) < 1e-4 * 2.2, "{exponent}: {:e}", off(&limit, &curve));
        let errors = [10, 40, 160].map(|steps| off(&by_steps(steps), &limit));
        assert!(errors[1] < errors[0] / 8.0 && errors[2] < errors[1] / 8.0, "{exponent}: {errors:?}");
    }
}

#[test]
fn reversed_loading_heats_in_both_senses() {
    for hardening in [HardeningRule::Kinematic, HardeningRule::Mixed(0.5)] {
        let warm = heated(bilinear_steel(), 1.0, 0.9);
        let seen = along(&warm, &[0.01, -0.01, 0.01, -0.01], 400, &effects(hardening, None));
        let temperatures: Vec<f64> = seen.chunks(2).map(|pair| pair[1]).collect();
        assert!(temperatures[0] > 1.0 && temperatures.is_sorted_by(|a, b| a < b), "{temperatures:?}");
    }
    // Kinematic hardening, Y = 200 MPa, reversed at f = 370 MPa: reverse flow starts at 370 - 2 200 MPa = -30 MPa.
    let law =
        |heat| along(&heated(bilinear_steel(), 1.0, heat), &[0.01, 0.0], 400, &effects(HardeningRule::Kinematic, None));
    let (warm, cold) = (law(0.9), law(0.0));
    assert!(warm[0] < cold[0] && warm[2] > cold[2], "soft in both senses: {warm:?} {cold:?}");
}

fn run(bar: &mut Leapfrog, steps: usize) -> Ledger {
    let mut ledger = Ledger::new(bar);
    for _ in 0..steps {
        bar.advance();
        ledger.row(bar);
    }
    ledger
}

/// Returns the heat in the cells, rho c (T - Tr) dV, J.
fn stored(bar: &Leapfrog) -> f64 {
    let rise: f64 = profile(bar, Quantity::Temperature).iter().map(|t| t - REFERENCE).sum();
    DENSITY * SPECIFIC_HEAT * rise / bar.grid().cells() as f64
}

#[test]
fn the_energy_account_closes_with_the_heat_in_it() {
    let warm = heated(power_law_steel(), 1.0, 0.7);
    for (hardening, rate) in [
        (HardeningRule::Isotropic, None),
        (HardeningRule::Kinematic, None),
        (HardeningRule::Mixed(0.4), Some(Rate::Malvern { k: 1e6 })),
        (HardeningRule::Isotropic, Some(Rate::CowperSymonds { d: 40.0, q: 5.0 })),
        (HardeningRule::Isotropic, Some(Rate::JohnsonCook { c: 0.02, reference: 1.0 })),
    ] {
        let mut missed = Vec::new();
        for cells in [200, 800] {
            let ends = [pulse(15.0), EndCondition::Fixed];
            let mut bar = bar(vec![segment(warm.clone(), 1.0)], ends, &effects(hardening, rate), cells);
            assert_ledger(&run(&mut bar, 2 * cells), &format!("{hardening:?} {rate:?}"));
            let sum = bar.energies();
            assert!(sum.heat > 0.0 && sum.plastic > 0.0);
            if rate.is_none() {
                // Without a rate, heat and plastic energy together are the whole plastic work.
                assert!((sum.heat / (sum.plastic + sum.heat) - 0.7).abs() < 1e-12, "{sum:?}");
            }
            missed.push((stored(&bar) / sum.heat - 1.0).abs());
        }
        // The ledger computes the work of a step with its mean stress: second order. The damping of ripples adds a small part.
        assert!(missed[1] < 1e-4 && missed[1] < missed[0], "{hardening:?} {rate:?}: {missed:?}");
    }
}

#[test]
fn by_front_tracking_the_heat_is_that_of_the_plastic_work() {
    let rows = [(0.001, YIELD), (0.004, 260e6), (0.02, 330e6), (0.06, 400e6)];
    let warm = heated(material(&rows, Beyond::Rupture), 1.09, 0.9);
    let mut bar = tracked(&warm, [common::moved_by(&[(0.0, -20.0)]), EndCondition::Fixed]);
    let mut ledger = Ledger::new(&bar);
    for k in 1..=10 {
        bar.advance_to(1.5 / c0() * f64::from(k) / 10.0).expect("within the budget");
        ledger.row(&bar);
    }
    assert_ledger(&ledger, "tracked");
    let sum = bar.balance();
    let (mut heat, mut flowed) = (0.0, 0);
    for piece in bar.pieces() {
        let temperature = bar.temperature(0, piece.point);
        heat += DENSITY * SPECIFIC_HEAT * (temperature - REFERENCE) * (piece.to - piece.from);
        // States along a curve that never stiffens are on it, so that their work is that of the curve.
        let of_curve =
            warm.heating.as_ref().expect("it heats").temperature(Sense::Tension, piece.point.accumulated / MODULUS);
        flowed += usize::from(piece.point.accumulated > 0.0);
        // Interactions that the front tolerance averages conserve strain and energy, but not their relation.
        assert!((temperature - of_curve).abs() < 1e-3 * (MELTING - REFERENCE), "{temperature} {of_curve}");
    }
    assert!(flowed > 5 && (heat / sum.heat - 1.0).abs() < 1e-12, "{flowed} {heat} {}", sum.heat);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(60))]

    /// No load on a cell causes melting, stress from nothing, or NaN.
    #[test]
    fn no_load_is_too_violent(
        steps in prop::collection::vec(-3.0_f64..3.0, 1..40),
        exponent in 0.2_f64..4.0,
        kinematic in 0.0_f64..1.0,
        rate in 0_usize..4,
    ) {
        let rate = [
            None,
            Some(Rate::Malvern { k: 1e6 }),
            Some(Rate::CowperSymonds { d: 40.0, q: 5.0 }),
            Some(Rate::JohnsonCook { c: 0.02, reference: 1.0 }),
        ][rate];
        let warm = heated(power_law_steel(), exponent, 1.0);
        let mut strain = 0.0;
        let path: Vec<f64> = steps.iter().map(|s| { strain += s.signum() * 10.0_f64.powf(s.abs() - 4.0); strain }).collect();
        for pair in along(&warm, &path, 3, &effects(HardeningRule::Mixed(kinematic), rate)).chunks(2) {
            let (stress, temperature) = (pair[0] * YIELD, pair[1] * REFERENCE);
            prop_assert!(stress.is_finite() && temperature.is_finite());
            prop_assert!((REFERENCE * (1.0 - 1e-15)..=MELTING * (1.0 + 1e-15)).contains(&temperature), "{temperature}");
        }
    }

    /// The adiabatic curve of any curve is never above the cold one at the same plastic strain, is never negative, and extends to the same plastic
    /// strain; the temperature never decreases.
    #[test]
    fn any_curve_can_be_heated(
        steps in prop::collection::vec((1e-4_f64..0.05, -0.3_f64..1.0), 1..12),
        exponent in 0.2_f64..4.0,
        fraction in 0.01_f64..1.0,
        extends in any::<bool>(),
    ) {
        let mut rows = vec![(0.001, YIELD)];
        for (width, rise) in steps {
            let (e, s) = rows[rows.len() - 1];
            // No slope is steeper than the elastic one, and no stress is negative.
            rows.push((e + width, (s + rise * width.min(1e-3) * MODULUS).max(0.1 * YIELD)));
        }
        let beyond = if extends { Beyond::Extend } else { Beyond::Rupture };
        let cold = material(&rows, beyond);
        let warm = heated(cold.clone(), exponent, fraction);
        let heating = warm.heating.as_ref().expect("it heats");
        let of = |m: &Material, k: usize| (m.tension.strain()[k], m.tension.stress()[k]);
        let last_plastic = { let (e, s) = of(&cold, cold.tension.strain().len() - 1); e - s / MODULUS };
        let (mut temperature, mut reached) = (REFERENCE, 0.0_f64);
        for k in 0..warm.tension.strain().len() {
            let (e, s) = of(&warm, k);
            let p = e - s / MODULUS;
            prop_assert!(s.is_finite() && s >= 0.0);
            reached = reached.max(p);
            let now = heating.temperature(Sense::Tension, p);
            prop_assert!(now >= temperature - 1e-9 && now <= MELTING, "{now} after {temperature}");
            temperature = now.max(temperature);
        }
        prop_assert!(reached >= last_plastic * (1.0 - 1e-9));
        let top = |m: &Material| m.tension.stress().iter().copied().fold(0.0, f64::max);
        prop_assert!(extends || top(&warm) <= top(&cold) * (1.0 + 1e-12));
    }
}

#[test]
fn what_is_missing_is_said() {
    let bare = bilinear_steel().heated(None);
    let Err(HeatingError::Missing(keys)) = bare else { panic!("{bare:?}") };
    assert_eq!(keys, ["specific-heat", "reference-temperature", "melting-temperature", "m"]);
    let mut some = with_constants(bilinear_steel(), 1.0);
    some.constants.heat.melting_temperature = None;
    assert_eq!(some.heated(None).expect_err("one is missing"), HeatingError::Missing(vec!["melting-temperature"]));
    // An elastic bar has no plastic work that could heat it.
    assert!(common::elastic_steel().heated(None).expect("nothing is needed").heating.is_none());
    let own = |m: Material, f| m.heated(f).expect("all there").heating.expect("it heats").fraction;
    let mut stated = with_constants(bilinear_steel(), 1.0);
    stated.constants.heat.fraction = Some(0.5);
    assert_eq!(
        [own(stated.clone(), None), own(stated, Some(0.7)), own(with_constants(bilinear_steel(), 1.0), None)],
        [0.5, 0.7, 0.9]
    );
}

/// Returns a scene with a soft metal of small heat capacity.
fn scene(effects: &str, solve: &str) -> Result<Scene, String> {
    pulled_at(60.0, effects, solve)
}

fn pulled_at(velocity: f64, effects: &str, solve: &str) -> Result<Scene, String> {
    let text = format!(
        "[bar]\nlength = 0.2\narea = 1e-4\n[bar.material]\nname = \"soft\"\ndensity = 8000\nmodulus = 200e9\nbeyond = \
         \"rupture\"\n\
         curve = {{ table = [[0.001, 200e6], [0.02, 260e6], [0.05, 290e6], [0.1, 310e6], [0.2, 330e6]] }}\n\
         heat = {{ specific-heat = 100, reference-temperature = 300, melting-temperature = 900, m = 1 }}\n\
         [left]\nkind = \"velocity\"\nvalue = -{velocity:?}\n[right]\nkind = \"fixed\"\n[effects]\n{effects}\n\
         [solve]\nuntil = 2e-4\n{solve}\n"
    );
    Scene::parse("heat.toml", &text, Path::new("."), &[]).map_err(|e| e.to_string())
}

#[test]
fn heat_implies_unloading_and_says_which_method_follows_it() {
    let parsed = scene("heat = {}", "").expect("a right scene");
    assert_eq!(parsed.effects.hardening, Some(HardeningRule::Isotropic));
    assert_eq!(parsed.effects.names(), ["hardening: isotropic", "heat"]);
    let rate = "rate = { model = \"malvern\", k = 1e6 }";
    assert_eq!(
        scene(&format!("heat = {{}}\n{rate}"), "").expect("on the grid").solve.method.names(),
        ["fd", "leapfrog"]
    );
    for (effects, what) in [
        (
            format!("heat = {{}}\n{rate}"),
            "(a characteristic net) does not simulate the effect `heat`: it stores no temperature",
        ),
        (
            "heat = {}\nhardening = \"kinematic\"".to_owned(),
            "(front tracking) does not simulate the effect `heat` with kinematic or mixed hardening",
        ),
    ] {
        let refused = scene(&effects, "method = \"moc\"").expect_err("moc cannot");
        assert!(refused.contains(what) && refused.contains("allowed: \"fd\""), "{refused}");
    }
}

/// A rate-independent bar with isotropic hardening and heat follows its adiabatic curve, which is all that the conservative scheme needs.
#[test]
fn the_conservative_scheme_follows_the_adiabatic_curve_too() {
    let effects = "heat = { fraction = 0.8 }";
    let plain = pulled_at(20.0, effects, "cells = 1000").expect("a right scene");
    let other = pulled_at(20.0, effects, "cells = 1000\nscheme = \"muscl\"").expect("muscl can");
    let mut leapfrog = barwave::assemble::leapfrog(&plain, 1000, 1.0);
    let mut muscl = barwave::assemble::muscl(&other, 1000, 1.0);
    let mut ledger = Ledger::new(&muscl);
    // Until shortly before the elastic wave returns.
    for _ in 0..1900 {
        leapfrog.advance();
        muscl.advance();
        ledger.row(&muscl);
    }
    assert_ledger(&ledger, "muscl");
    let missed = |quantity, level: f64| {
        let (mut a, mut b) = (vec![0.0; 1000], vec![0.0; 1000]);
        leapfrog.profile(quantity, &mut a);
        muscl.profile(quantity, &mut b);
        let total: f64 = a.iter().map(|a| (a - level).abs()).sum();
        assert!(total > 0.0);
        a.iter().zip(&b).map(|(a, b)| (a - b).abs()).sum::<f64>() / total
    };
    // With both schemes, fronts are a few cells wide, much less than the plastic zone.
    assert!(missed(Quantity::Stress, 0.0) < 5e-3, "{}", missed(Quantity::Stress, 0.0));
    assert!(missed(Quantity::Temperature, 300.0) < 2e-2, "{}", missed(Quantity::Temperature, 300.0));
    let sum = muscl.energies();
    assert!((sum.heat / (sum.plastic + sum.heat) - 0.8).abs() < 1e-12 && sum.heat > 0.0, "{sum:?}");
    let refused = pulled_at(20.0, "heat = {}\nhardening = \"kinematic\"", "scheme = \"muscl\"").expect_err("a state");
    assert!(refused.contains("heat") && refused.contains("leapfrog"), "{refused}");
}

/// Softening moves the maximum of the engineering stress, and with it the critical strain, to less than half the strain of the cold curve; with both
/// methods the bar fractures there.
#[test]
fn a_bar_that_warms_breaks_at_the_largest_stress_of_the_adiabatic_curve() {
    let effects = "heat = { fraction = 1 }\nrupture = \"critical-strain\"";
    let probe = scene(effects, "").expect("a right scene").bar.segments[0].material.clone();
    let cold = &probe.heating.as_ref().expect("it heats").cold[0];
    let limit = |curve| similarity::critical(curve, probe.density).expect("it ends").velocity;
    let [warm, cold] = [limit(&probe.tension), limit(cold)];
    assert!(warm < 0.9 * cold, "{warm} {cold}");
    let velocity = 0.5 * (warm + cold);
    let at = |effects, solve| pulled_at(velocity, effects, solve).expect("a right scene");
    let (fd, moc) = (at(effects, "cells = 1000"), at(effects, "method = \"moc\""));
    let critical = fd.bar.segments[0].material.tension.ultimate().expect("it softens");
    assert!(critical.strain < 0.1, "{critical:?}");
    let mut tracked =
        barwave::assemble::front_tracking(&moc, Settings { front_tolerance: 1e-3, ..Settings::default() });
    tracked.advance_to(moc.solve.until).expect("within the budget");
    let mut grid = barwave::assemble::leapfrog(&fd, 1000, 1.0);
    while grid.time() < fd.solve.until {
        grid.advance();
    }
    let (by_fronts, by_cells) = (&tracked.ruptures()[0], &grid.ruptures()[0]);
    assert!((by_fronts.strain / critical.strain - 1.0).abs() < 1e-9 && by_fronts.time == 0.0, "{by_fronts:?}");
    // On the grid, strain must accumulate in the first cell of the end, with an excess of a fifth.
    assert!(by_cells.strain > critical.strain && by_cells.strain < 1.3 * critical.strain, "{by_cells:?}");
    let cold = at("rupture = \"critical-strain\"\nhardening = \"isotropic\"", "method = \"moc\"");
    let mut cold_bar =
        barwave::assemble::front_tracking(&cold, Settings { front_tolerance: 1e-3, ..Settings::default() });
    cold_bar.advance_to(cold.solve.until).expect("within the budget");
    assert!(cold_bar.ruptures().first().is_none_or(|r| r.time > 0.0), "{:?}", cold_bar.ruptures());
}

/// A bar at 1043 K carries half the stress of the cold one. Its critical velocity is not that of the cold bar, 57.8 m/s, and its temperature rise is
/// relative to its own initial temperature (20 K, and not 770 K).
#[test]
fn a_warm_bar_has_its_own_critical_velocity_and_rises_from_its_own_temperature() {
    let scene = |velocity: f64, fraction: f64| {
        let text = format!(
            "[bar]\nlength = 0.3\narea = 1e-4\ntemperature = 1043\n[bar.material]\nname = \"s\"\ndensity = 7800\n\
             modulus = 200e9\nbeyond = \"rupture\"\ncurve = {{ table = [[0, 0], [0.0015, 300e6], [0.1015, 500e6]] }}\n\
             heat = {{ specific-heat = 450, reference-temperature = 293, melting-temperature = 1793, m = 1 }}\n\
             [left]\nkind = \"velocity\"\nvalue = {velocity}\n[right]\nkind = \"free\"\n\
             [effects]\nheat = {{ fraction = {fraction} }}\n[solve]\nuntil = 4e-5\ncells = 300\n\
             [record]\nframes = 2\nfields = [\"temperature\"]\n"
        );
        Scene::parse("warm", &text, Path::new("."), &[]).unwrap_or_else(|e| panic!("{e}"))
    };
    // 150 MPa, then half the plastic slope 200 MPa/(0.1 - 0.001), along which it reaches 250 MPa.
    let (density, modulus, slope) = (7800.0_f64, 200e9_f64, 100e6 / (0.1 - 0.001));
    let tangent = slope * modulus / (slope + modulus);
    let exact = 150e6 / (density * modulus).sqrt() + 100e6 / (density * tangent).sqrt();
    let found = scene(-20.0, 1e-9).critical_velocity().expect("the curve has one");
    assert!((found / exact - 1.0).abs() < 1e-6, "{found} {exact}");
    let heated = scene(-20.0, 0.9).critical_velocity().expect("the curve has one");
    assert!((0.9 * exact..exact).contains(&heated), "{heated} {exact}");
    assert!(!scene(-0.99 * heated, 0.9).is_above_critical() && scene(-1.01 * heated, 0.9).is_above_critical());
    let solution = solve(&scene(-20.0, 0.9), &mut |_| ControlFlow::Continue(())).unwrap_or_else(|e| panic!("{e}"));
    let temperature = solution.field(Field::Temperature).expect("recorded");
    let highest = temperature.iter().copied().fold(0.0, f64::max);
    let rise = solution.summary.temperature_rise.expect("the bar heats");
    assert!((rise - (highest - 1043.0)).abs() < 1e-9 && (1.0..20.0).contains(&rise), "{rise} {highest}");
}
