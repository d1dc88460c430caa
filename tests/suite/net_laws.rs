//! Properties of the characteristic net for any bar: limits, symmetries, balances.

use crate::common;
use crate::common::net;

use std::sync::Arc;

use barwave::bar::{EndCondition, History, Joint, Segment};
use barwave::law::rate::{NodeStep, Overstress};
use barwave::material::{Beyond, Curve, Material};
use barwave::solver::fd::Quantity;
use barwave::solver::net::Net;
use common::{DENSITY, MODULUS, YIELD, bilinear_steel, elastic_steel, moved, power_law_table, segment};
use proptest::prelude::*;

const QUANTITIES: [Quantity; 5] = [
    Quantity::Stress,
    Quantity::Strain,
    Quantity::Velocity,
    Quantity::PlasticStrain,
    Quantity::AccumulatedPlasticStrain,
];

fn c0() -> f64 {
    (MODULUS / DENSITY).sqrt()
}

/// Returns two pieces of different sections, which are pulled and released.
fn stepped_bar(material: &Material) -> Vec<Segment> {
    vec![Segment::new(0.5, 2.0, material.clone()), segment(material.clone(), 0.5)]
}

fn pulse(velocity: f64) -> EndCondition {
    let history = common::history(&[(0.0, 0.0), (0.05 / c0(), velocity), (0.4 / c0(), velocity), (0.45 / c0(), 0.0)]);
    EndCondition::Velocity { history, release: Some(0.6 / c0()) }
}

#[test]
fn slow_flow_leaves_the_elastic_bar_bit_for_bit() {
    let ends = || [pulse(25.0), EndCondition::Wall { gap: 1e-5 }];
    // So slow that no representable flow occurs within a step.
    let mut slow = net::malvern(stepped_bar(&bilinear_steel()), ends(), 1e-320, 300);
    let mut elastic = net::malvern(stepped_bar(&elastic_steel()), ends(), 1e6, 300);
    for _ in 0..1500 {
        slow.advance();
        elastic.advance();
        for quantity in [Quantity::Stress, Quantity::Velocity, Quantity::Strain] {
            assert_eq!(net::profile(&slow, quantity), net::profile(&elastic, quantity));
        }
    }
    assert!(elastic.stayed_elastic());
    assert!(net::profile(&slow, Quantity::Stress).iter().any(|s| s.abs() > 1.2 * YIELD), "it would have yielded");
}

#[test]
fn an_elastic_wave_is_exact_through_all_its_reflections() {
    let velocity = 5.0;
    let mut bar = net::malvern(vec![segment(elastic_steel(), 1.0)], [moved(velocity), EndCondition::Fixed], 1e6, 64);
    let step = (MODULUS * DENSITY).sqrt() * velocity;
    for passage in 0..9 {
        for cell in 0..64_usize {
            bar.advance();
            // Every passage adds one step behind the front.
            let behind = if passage % 2 == 0 { cell } else { 63 - cell };
            let ahead = if passage % 2 == 0 { behind + 1 } else { behind.wrapping_sub(1) };
            let stress = |i: usize| bar.value(Quantity::Stress, i);
            assert!((stress(behind) / -step - f64::from(passage + 1)).abs() < 1e-13, "{passage} {cell}");
            if ahead < 64 {
                assert!((stress(ahead) / -step - f64::from(passage)).abs() < 1e-13, "{passage} {cell}");
            }
        }
    }
}

#[test]
fn no_flow_rate_rings_or_blows_up() {
    let dt = 1.0 / c0() / 400.0;
    // Behind the front, compression only increases towards the struck end. On a straight part of the curve the net satisfies this to rounding; at a
    // knot, two neighbours change slope in different steps, which gives 1e-6 at most.
    for (material, ripple) in [(bilinear_steel(), 1e-12), (power_law_table(30), 2e-6)] {
        for exponent in -6..=12 {
            let k = 10.0_f64.powi(exponent) / dt;
            let ends = [moved(20.0), EndCondition::Free];
            let mut bar = net::malvern(vec![segment(material.clone(), 1.0)], ends, k, 400);
            let balance = net::Balance::new(&bar);
            for _ in 0..360 {
                bar.advance();
            }
            let stress = net::profile(&bar, Quantity::Stress);
            let scale = (MODULUS * DENSITY).sqrt() * 20.0;
            for pair in stress.windows(2) {
                assert!(pair[0] <= pair[1] + ripple * scale, "k dt = 1e{exponent}: {pair:?}");
            }
            assert!(stress[0] >= -scale * (1.0 + 1e-12), "k dt = 1e{exponent}: {}", stress[0]);
            assert!(balance.residuals(&bar).iter().all(|r| *r < 1e-12), "k dt = 1e{exponent}");
        }
    }
}

#[test]
fn unloading_is_elastic() {
    let mut bar = net::malvern(vec![segment(bilinear_steel(), 1.0)], [pulse(-30.0), EndCondition::Absorbing], 1e6, 200);
    let mut unloaded = 0;
    let mut before: Vec<_> = QUANTITIES.map(|q| net::profile(&bar, q)).to_vec();
    for _ in 0..400 {
        // If a cell is below the static stress before and after a step, it flows in neither half of it.
        let idle = |bar: &Net| -> Vec<bool> {
            let below = |i| bar.value(Quantity::Stress, i).abs() < bar.static_stress(i).abs();
            (0..200).map(below).collect()
        };
        let idle_before = idle(&bar);
        bar.advance();
        let after: Vec<_> = QUANTITIES.map(|q| net::profile(&bar, q)).to_vec();
        for (i, (was, is)) in idle_before.into_iter().zip(idle(&bar)).enumerate() {
            if was && is {
                assert_eq!(before[3][i], after[3][i], "plastic strain of cell {i}");
                unloaded += usize::from(after[3][i] != 0.0 && before[0][i] != after[0][i]);
            }
        }
        before = after;
    }
    assert!(unloaded > 10_000, "{unloaded} steps of cells that were unloading");
}

#[test]
fn mirrored_bars_are_equal_bit_for_bit() {
    let soft_material = common::material(&[(0.001, 90e6), (0.05, 200e6)], Beyond::Extend);
    let soft = |velocity: f64| Segment::new(0.45, 1.5, soft_material.clone()).with_velocity(velocity);
    let hard = || segment(bilinear_steel(), 0.55);
    let law = Overstress::Malvern { k: 2e5 };
    let cases = [
        (EndCondition::Wall { gap: 1e-5 }, EndCondition::Wall { gap: 1e-5 }, Joint::Bonded),
        (
            EndCondition::Striker { mass: 3e3, velocity: -12.0 },
            EndCondition::Striker { mass: 3e3, velocity: 12.0 },
            Joint::Contact { gap: 2e-5 },
        ),
        (
            EndCondition::Spring { stiffness: 1e11 },
            EndCondition::Spring { stiffness: 1e11 },
            Joint::Contact { gap: 0.0 },
        ),
    ];
    for (right, right_in_image, joint) in cases {
        let joined = |a: Segment, b: Segment| vec![Segment { joint, ..a }, b];
        let mut bar = net::net(joined(hard(), soft(-3.0)), [pulse(30.0), right], law, 0.3, 301);
        let mut image = net::net(joined(soft(3.0), hard()), [right_in_image, pulse(-30.0)], law, 0.3, 301);
        for _ in 0..900 {
            bar.advance();
            image.advance();
            for quantity in QUANTITIES {
                let sign = if quantity == Quantity::Velocity { -1.0 } else { 1.0 };
                let reversed: Vec<f64> = net::profile(&image, quantity).into_iter().rev().map(|v| sign * v).collect();
                assert_eq!(net::profile(&bar, quantity), reversed, "{quantity:?} in step {}, {joint:?}", bar.step());
            }
            let (ends, image_ends) = (bar.ends(), image.ends());
            assert_eq!(ends[0].stress, image_ends[1].stress);
            assert_eq!(ends[1].velocity, -image_ends[0].velocity);
        }
        assert!(!bar.stayed_elastic());
    }
}

#[test]
fn tension_is_compression_with_the_other_sign() {
    for (overstress, kinematic) in [
        (Overstress::Malvern { k: 2e5 }, 0.0),
        (Overstress::CowperSymonds { rate: MODULUS * 40.0, exponent: 5.0 }, 0.4),
        (Overstress::JohnsonCook { c: 0.014, rate: MODULUS }, 1.0),
    ] {
        let bar = |v: f64| {
            net::net(stepped_bar(&power_law_table(20)), [pulse(v), EndCondition::Free], overstress, kinematic, 200)
        };
        let (mut pulled, mut pushed) = (bar(-30.0), bar(30.0));
        for _ in 0..600 {
            pulled.advance();
            pushed.advance();
        }
        for quantity in QUANTITIES {
            let sign = if quantity == Quantity::AccumulatedPlasticStrain { 1.0 } else { -1.0 };
            let other: Vec<f64> = net::profile(&pushed, quantity).into_iter().map(|v| sign * v).collect();
            assert_eq!(net::profile(&pulled, quantity), other, "{quantity:?}");
        }
    }
}

fn material_from(rows: Vec<(f64, f64)>, density: f64, yield_stress: f64, compression: bool) -> Material {
    let mut table = vec![(yield_stress / MODULUS, yield_stress)];
    for (strain, part) in rows {
        let (e, s) = table[table.len() - 1];
        table.push((e + strain, s + part * strain * MODULUS));
    }
    let mut material = Material::from_curve("random", density, Curve::new(&table, Beyond::Extend).expect("rows rise"))
        .expect("a material");
    material.modulus = MODULUS;
    if compression {
        let other: Vec<_> = table.iter().map(|(e, s)| (e * 1.3, s * 1.3)).collect();
        material.compression = Some(Curve::new(&other, Beyond::Extend).expect("rows rise"));
    }
    material
}

fn overstress() -> impl Strategy<Value = Overstress> {
    let rate = || (-2.0..14.0_f64).prop_map(|e| 10.0_f64.powf(e));
    prop_oneof![
        rate().prop_map(|k| Overstress::Malvern { k }),
        (rate(), 0.3..8.0_f64).prop_map(|(d, exponent)| Overstress::CowperSymonds { rate: MODULUS * d, exponent }),
        (0.001..0.3_f64, rate()).prop_map(|(c, rate)| Overstress::JohnsonCook { c, rate: MODULUS * rate }),
    ]
}

/// Slopes may increase and decrease along the curve, up to the elastic one.
fn curves() -> impl Strategy<Value = Vec<(f64, f64)>> {
    prop::collection::vec(((-4.5..-2.0_f64).prop_map(|e| 10.0_f64.powf(e)), 0.0..1.0_f64), 1..9)
}

fn ends() -> impl Strategy<Value = EndCondition> {
    let history = || {
        prop::collection::vec((0.0..0.6_f64, -1.0..1.0_f64), 1..6).prop_map(|rows| {
            let mut time = 0.0;
            let row = |(step, value): (f64, f64)| {
                // One in three rows is a jump.
                time += if step < 0.2 { 0.0 } else { step / c0() };
                (time, value)
            };
            let rows: Vec<_> = rows.into_iter().map(row).collect();
            History::new(&rows).unwrap_or_else(|_| History::constant(rows[0].1))
        })
    };
    let scaled = |history: History, by: f64| {
        let rows: Vec<_> = history.time().iter().zip(history.value()).map(|(&t, &v)| (t, by * v)).collect();
        History::new(&rows).expect("in order")
    };
    prop_oneof![
        (history(), prop::option::of(0.1..2.0_f64))
            .prop_map(move |(h, r)| EndCondition::Velocity { history: scaled(h, 40.0), release: r.map(|r| r / c0()) }),
        history().prop_map(move |h| EndCondition::Stress { history: scaled(h, 1.5 * YIELD) }),
        Just(EndCondition::Free),
        Just(EndCondition::Fixed),
        Just(EndCondition::Absorbing),
        (0.0..1e-3_f64).prop_map(|gap| EndCondition::Wall { gap }),
        (10.0..1e5_f64, -40.0..40.0_f64).prop_map(|(mass, velocity)| EndCondition::Striker { mass, velocity }),
        (6.0..14.0_f64).prop_map(|e| EndCondition::Spring { stiffness: 10.0_f64.powf(e) }),
    ]
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 400, ..ProptestConfig::default() })]

    #[test]
    fn any_bar_stays_finite_balanced_and_above_its_static_curve(
        rows in curves(),
        more in curves(),
        law in overstress(),
        own_compression in any::<bool>(),
        kinematic in 0.0..1.0_f64,
        both in (ends(), ends()),
        area in 0.3..3.0_f64,
        velocity in -20.0..20.0_f64,
        density in 2000.0..9000.0_f64,
        joint in prop_oneof![Just(Joint::Bonded), (0.0..1e-3_f64).prop_map(|gap| Joint::Contact { gap })],
    ) {
        let kinematic = if own_compression || kinematic < 0.3 { 0.0 } else { kinematic };
        let first = Arc::new(material_from(rows, DENSITY, YIELD, own_compression));
        let second = Arc::new(material_from(more, density, 0.6 * YIELD, own_compression));
        let part = |material: &Arc<Material>, length, area, velocity| {
            Segment::new(length, area, material.clone()).with_velocity(velocity).with_joint(joint)
        };
        let segments = vec![part(&first, 0.6, 1.0, 0.0), part(&second, 0.4, area, velocity)];
        let mut bar = net::net(segments, [both.0, both.1], law, kinematic, 60);
        let balance = net::Balance::new(&bar);
        let (mut taken, mut lost) = (bar.energies(), 0.0);
        for _ in 0..200 {
            bar.advance();
            prop_assert_eq!(bar.not_finite(), None);
            let now = bar.energies();
            // Sums of 1e4 terms with errors of 1e-16 each.
            let round_off = 1e-11 * (now.total() + now.plastic.abs() + bar.work()[0].abs() + bar.work()[1].abs());
            prop_assert!(now.viscoplastic >= taken.viscoplastic - round_off, "the overstress gives work back");
            if kinematic == 0.0 {
                prop_assert!(now.plastic >= taken.plastic - round_off, "flow gives work back");
            }
            let met: f64 = bar.contacts().map(|(_, contact)| contact.lost()).sum();
            prop_assert!(met >= lost, "sides that meet give work back");
            lost = met;
            let residuals = balance.residuals(&bar);
            prop_assert!(residuals.iter().all(|r| *r < 1e-10), "{:?} at step {}", residuals, bar.step());
            taken = now;
        }
        for cell in 0..bar.grid().cells() {
            let (stress, limit) = (bar.value(Quantity::Stress, cell), bar.static_stress(cell));
            prop_assert!(stress.is_finite() && !limit.is_nan());
        }
    }

    #[test]
    fn a_flowing_node_never_falls_below_its_static_stress(
        rows in curves(),
        law in overstress(),
        excess in (-6.0..2.0_f64).prop_map(|e| YIELD * 10.0_f64.powf(e)),
        time in (-12.0..3.0_f64).prop_map(|e| 10.0_f64.powf(e)),
        share in 0.05..1.0_f64,
        kinematic in 0.0..1.0_f64,
        sense in 0..2_usize,
    ) {
        let law = net::law(&material_from(rows, DENSITY, YIELD, false), law, kinematic);
        let mut history = barwave::law::rate::History::default();
        let sign = if sense == 0 { 1.0 } else { -1.0 };
        let flow = law.flow(NodeStep { excess, share, smooth: 0.0, time }, sense, &mut history);
        let stress = sign * (YIELD + excess) - share * flow.plastic;
        let limit = law.limits(&history)[1 - sense];
        // The flow is solved to 1e-13 relative, and the static stress follows it along the curve, whose slope may be a thousand times the elastic
        // one.
        let start = barwave::law::rate::History::default();
        let before = law.limits(&law.flowed((1.0 - 1e-13) * flow.plastic, &start))[1 - sense];
        let round_off = 1e-13 * (YIELD + excess + history.accumulated) + (limit - before).abs();
        prop_assert!(sign * (stress - limit) >= -round_off, "{} {}", stress, limit);
        prop_assert!(flow.overstress >= 0.0 && sign * flow.plastic >= 0.0);
        prop_assert!(flow.overstress <= excess * flow.plastic.abs() * (1.0 + 1e-12));
    }
}
