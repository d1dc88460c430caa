//! Tapered segments: exact spherical waves in a cone, the ledger, and the staircase of the other methods.

use crate::common;

use std::ops::ControlFlow;
use std::path::Path;
use std::sync::Arc;

use barwave::assemble;
use barwave::bar::{Bar, EndCondition, Joint, Profile, Segment, Taper};
use barwave::record::{Field, Ledger, View};
use barwave::scene::{HardeningRule, Method, Scene};
use barwave::solver::fd::{Leapfrog, Quantity};
use barwave::solver::moc::{FrontTracking, Settings};

fn c0() -> f64 {
    (common::MODULUS / common::DENSITY).sqrt()
}

fn tapered(segment: Segment, profile: Profile, rows: &[(f64, f64)]) -> Segment {
    let taper = Taper::new(profile, rows).expect("rows are right");
    Segment { area: taper.mean(0.0, segment.length), taper: Some(Arc::new(taper)), ..segment }
}

/// Returns a cone of 1 m between the distances 1/2 and 3/2 from its apex, as far as diameters are concerned.
fn cone(material: barwave::material::Material) -> Segment {
    tapered(common::segment(material, 1.0), Profile::Diameter, &[(0.0, 0.01), (1.0, 0.03)])
}

const POINT: f64 = 0.5;

/// In a cone, x u = f(x - c t) exactly. f is smooth: sin^6 over a width of `LONG`, as a function of s = c t - (x - x0).
const LONG: f64 = 0.4;
const HIGH: f64 = 1e-5;

/// Returns f and its first derivative.
fn shape(s: f64) -> [f64; 2] {
    if !(0.0..LONG).contains(&s) {
        return [0.0; 2];
    }
    let k = std::f64::consts::PI / LONG;
    let (sin, cos) = (k * s).sin_cos();
    [HIGH * sin.powi(6), 6.0 * HIGH * k * sin.powi(5) * cos]
}

/// Returns stress and velocity of `u = f(s)/X`, where X is the distance from the apex of the cone.
fn exact(x: f64, t: f64) -> [f64; 2] {
    let point = POINT + x;
    let [f, slope] = shape(c0() * t - x);
    [-common::MODULUS * (slope / point + f / (point * point)), c0() * slope / point]
}

/// Returns the relative L1 errors of stress and velocity when the pulse is half-way.
fn cone_errors(cells: usize, cfl: f64) -> [f64; 2] {
    // Four thousand straight pieces approximate the smooth velocity to 1e-6 of it, a tenth of the smallest error below.
    let (rows, end) = (4000, LONG / c0());
    let row = |i: u32| f64::from(i) / f64::from(rows) * end;
    let drive: Vec<(f64, f64)> = (0..=rows).map(|i| (row(i), exact(0.0, row(i))[1])).collect();
    let ends = [common::moved_by(&drive), EndCondition::Free];
    let mut bar = common::leapfrog(vec![cone(common::elastic_steel())], ends, None, cells, cfl);
    common::advance_to(&mut bar, 0.85 / c0());
    let x = bar.grid().centres();
    [Quantity::Stress, Quantity::Velocity].map(|quantity| {
        let which = usize::from(quantity == Quantity::Velocity);
        let (mut missed, mut total) = (0.0, 0.0);
        for (value, &x) in common::profile(&bar, quantity).iter().zip(&x) {
            let wanted = exact(x, bar.time())[which];
            missed += (value - wanted).abs();
            total += wanted.abs();
        }
        missed / total
    })
}

#[test]
fn a_spherical_wave_in_a_cone_is_of_second_order() {
    for cfl in [1.0, 0.7] {
        let errors = [200, 400, 800].map(|cells| cone_errors(cells, cfl));
        println!("cfl {cfl}: {errors:?}");
        for which in [0, 1] {
            let [coarse, middle, fine] = errors.map(|e| e[which]);
            for ratio in [coarse / middle, middle / fine] {
                assert!((3.7..4.4).contains(&ratio), "cfl {cfl}: order {}", ratio.log2());
            }
            assert!(fine < 1e-3, "{fine:e}");
        }
    }
}

/// A pulse much longer than the horn is transmitted as by a step in area; a short one grows as sqrt(A1/A2).
#[test]
fn a_short_pulse_grows_with_the_root_of_the_areas() {
    let thin = |segment| tapered(segment, Profile::Diameter, &[(0.0, 0.02), (1.0, 0.01)]);
    let pulse = common::loaded_by(&[(0.0, 0.0), (1e-6, -1e6), (3e-6, -1e6), (4e-6, 0.0)]);
    let ends = [pulse, EndCondition::Free];
    let mut bar = common::leapfrog(vec![thin(common::segment(common::elastic_steel(), 1.0))], ends, None, 2000, 1.0);
    common::advance_to(&mut bar, 0.9 / c0());
    let peak = common::profile(&bar, Quantity::Stress).iter().fold(0.0_f64, |m, s| m.min(*s));
    // The start of the level part has reached x = 0.9 - 0.005: diameter 11.05 mm. The relative stress behind the wave is about its length divided by
    // that of the cone.
    let grown = -1e6 * 20.0 / 11.05;
    assert!((peak / grown - 1.0).abs() < 0.01, "{peak} {grown}");
}

fn quantities(bar: &Leapfrog) -> Vec<Vec<f64>> {
    [Quantity::Stress, Quantity::Strain, Quantity::Velocity, Quantity::AccumulatedPlasticStrain]
        .map(|quantity| common::profile(bar, quantity))
        .to_vec()
}

#[test]
fn a_taper_that_changes_nothing_is_the_uniform_bar_to_the_last_bit() {
    let ends = [common::moved_by(&[(0.0, 20.0), (5e-5, 20.0), (5e-5, 0.0)]), EndCondition::Free];
    let plain = Segment::new(1.0, 2.0, common::bilinear_steel());
    let flat = tapered(plain.clone(), Profile::Area, &[(0.0, 2.0), (0.3, 2.0), (1.0, 2.0)]);
    let [mut uniform, mut level] = [plain, flat]
        .map(|s| common::leapfrog(vec![s], ends.clone(), Some(HardeningRule::Isotropic), 1301, 1.0).in_cells());
    for _ in 0..4 {
        common::advance(&mut uniform, 700);
        common::advance(&mut level, 700);
        assert_eq!(quantities(&uniform), quantities(&level));
        assert_eq!(uniform.right().velocity(), level.right().velocity());
        // The sums have another order.
        let [a, b] = [&uniform, &level].map(|bar| bar.energies().total());
        assert!((a / b - 1.0).abs() < 1e-13, "{a} {b}");
    }
    assert!(!uniform.stayed_elastic());
}

#[test]
fn a_scene_s_table_of_one_size_is_no_taper() {
    let text = |area: &str| {
        format!(
            "[bar]\nlength = 1\narea = {area}\nmaterial = \"mild-steel\"\n[left]\nkind = \"free\"\n[right]\nkind = \"free\"\n\
             [solve]\nuntil = 1e-4\n"
        )
    };
    let read = |area: &str| Scene::parse("s.toml", &text(area), Path::new("."), &[]).expect("a right scene");
    let (plain, table) = (read("\"1 cm^2\""), read("[[0, \"1 cm^2\"], [\"1 m\", \"1 cm^2\"]]"));
    assert!(table.bar.segments[0].taper.is_none());
    assert_eq!(plain.resolved_json(), table.resolved_json());
    // A uniform segment stores nothing for its cells.
    let wedge = read("[[0, \"1 cm^2\"], [\"1 m\", \"3 cm^2\"]]");
    assert!((wedge.bar.segments[0].area - 2e-4).abs() < 1e-18);
    assert_eq!(wedge.resolved_json()["bar"]["segment"][0]["taper"]["size"], serde_json::json!([1e-4, 3e-4]));
}

fn light(length: f64) -> Segment {
    let mut material = common::material(&[(0.002, 140e6), (0.05, 220e6)], barwave::material::Beyond::Extend);
    material.density = 2700.0;
    common::segment(material, length)
}

/// Returns a wedge and a cone of two materials, with three blocks each.
fn two_tapers(joint: Joint) -> Vec<Segment> {
    let first = common::segment(common::bilinear_steel(), 0.6).with_velocity(12.0).with_joint(joint);
    let first = tapered(first, Profile::Area, &[(0.0, 3.0), (0.2, 1.0), (0.6, 2.0)]);
    vec![first, tapered(light(0.5), Profile::Diameter, &[(0.0, 1.2), (0.5, 0.4)])]
}

#[test]
fn momentum_and_energy_of_plastic_tapers_are_accounted_for_to_rounding() {
    let pulse = common::loaded_by(&[(0.0, -150e6), (4e-5, -150e6), (4e-5, 50e6)]);
    let lefts = [
        common::moved(25.0),
        pulse,
        EndCondition::Striker { mass: 4e3, velocity: 40.0 },
        EndCondition::Spring { stiffness: 1e11 },
        EndCondition::Wall { gap: 0.0 },
        EndCondition::Absorbing,
    ];
    for left in lefts {
        for joint in [Joint::Bonded, Joint::Contact { gap: 1e-4 }] {
            for hardening in [None, Some(HardeningRule::Isotropic), Some(HardeningRule::Mixed(0.4))] {
                let ends = [left.clone(), EndCondition::Absorbing];
                let mut bar = common::leapfrog(two_tapers(joint), ends, hardening, 2600, 1.0);
                let mut ledger = Ledger::new(&bar);
                for _ in 0..20 {
                    common::advance(&mut bar, 150);
                    ledger.row(&bar);
                }
                assert!(!bar.stayed_elastic());
                common::assert_ledger(&ledger, &format!("{left:?}, {joint:?}, {hardening:?}"));
            }
        }
    }
}

/// Returns the largest difference in stress between a bar with a neck, moved at one end, and its mirror image, relative to the yield stress.
fn mirror_difference(velocity: f64) -> f64 {
    let rows = [(0.0, 2.0), (0.25, 1.0), (1.0, 1.5)];
    let mirrored: Vec<(f64, f64)> = rows.iter().rev().map(|&(x, a)| (1.0 - x, a)).collect();
    let run = |rows: &[(f64, f64)], ends: [EndCondition; 2]| {
        let segments = vec![tapered(common::segment(common::bilinear_steel(), 1.0), Profile::Area, rows)];
        let mut bar = common::leapfrog(segments, ends, Some(HardeningRule::Isotropic), 1301, 1.0);
        common::advance(&mut bar, 2000);
        assert_eq!(bar.stayed_elastic(), velocity < 3.0);
        common::profile(&bar, Quantity::Stress)
    };
    let here = run(&rows, [common::moved(velocity), EndCondition::Free]);
    let there = run(&mirrored, [EndCondition::Free, common::moved(-velocity)]);
    here.iter().zip(there.iter().rev()).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max) / common::YIELD
}

#[test]
fn a_taper_and_its_mirror_image_agree() {
    // Not to the last bit: areas are interpolated from the other side, and the borders of blocks of cells are elsewhere.
    assert!(mirror_difference(1.5) < 1e-12, "{:e}", mirror_difference(1.5));
    // Where the bar yields, the grid filter depends on signs: zero in one image is rounding in the other.
    assert!(mirror_difference(20.0) < 1e-4, "{:e}", mirror_difference(20.0));
}

const STEEL: &str =
    r#"{ name = "s", density = 7800, modulus = 200e9, beyond = "extend", curve = { table = [[0.01, 2e9]] } }"#;

fn scene(bar: &str, left: &str, effects: &str, solve: &str) -> Scene {
    let text =
        format!("[bar]\n{bar}\n[left]\n{left}\n[right]\nkind = \"free\"\n[effects]\n{effects}\n[solve]\n{solve}\n");
    Scene::parse("taper.toml", &text, Path::new("."), &[]).unwrap_or_else(|e| panic!("{e}\n{text}"))
}

fn tracked(scene: &Scene) -> FrontTracking {
    let Method::FrontTracking { front_tolerance, event_budget } = scene.solve.method else { panic!("fronts") };
    let settings = Settings { front_tolerance, event_budget, ..Settings::default() };
    let mut bar = assemble::front_tracking(scene, settings);
    bar.advance_to(scene.solve.until).expect("within the budget");
    bar
}

/// f' is constant over a length of 0.2 m: the velocity of the end is a rectangular pulse, and after it nothing moves there.
fn rectangular(x: f64, t: f64) -> [f64; 2] {
    let (point, slope) = (POINT + x, 1e-3);
    let s = c0() * t - x;
    let (f, slope) = if s < 0.0 {
        (0.0, 0.0)
    } else if s < 0.2 {
        (slope * s, slope)
    } else {
        (0.2 * slope, 0.0)
    };
    [-common::MODULUS * (slope / point + f / (point * point)), c0() * slope / point]
}

#[test]
fn the_staircase_of_fronts_converges_to_the_spherical_wave() {
    let velocity = rectangular(0.0, 1e-12)[1];
    let pulse =
        format!("kind = \"velocity\"\nhistory = [[0, {velocity}], [{0:e}, {velocity}], [{0:e}, 0]]", 0.2 / c0());
    let bar = format!("length = 1\ndiameter = [[0, 0.01], [1, 0.03]]\nmaterial = {STEEL}");
    let solve = format!("until = {:e}\nmethod = \"moc\"\nfront-tolerance = 0", 0.83 / c0());
    let scene = scene(&bar, &pulse, "", &solve);
    let errors = [0.04, 0.02, 0.01].map(|share| {
        let cut = scene.discretized_finer_than(share);
        let reflects = cut.discretized.as_ref().expect("pieces").reflects;
        assert!(reflects <= share && reflects > 0.5 * share, "{reflects}");
        let bar = tracked(&cut);
        assert!(bar.balance().numerical.abs() < 1e-12 * bar.balance().total());
        let x: Vec<f64> = (0..1000).map(|i| (f64::from(i) + 0.5) / 1000.0).collect();
        [Field::Stress, Field::Velocity].map(|field| {
            let mut values = vec![0.0; x.len()];
            bar.sample(field, &x, &mut values);
            let which = usize::from(field == Field::Velocity);
            let wanted = x.iter().map(|&x| rectangular(x, scene.solve.until)[which]);
            let missed: f64 = values.iter().zip(wanted.clone()).map(|(v, w)| (v - w).abs()).sum();
            missed / wanted.map(f64::abs).sum::<f64>()
        })
    });
    println!("{errors:?}");
    // Levels within a piece have errors of up to the stated fraction: of first order in it. The error of the velocity depends on the positions of the
    // fronts within their pieces, which two halvings hardly average out.
    assert!(errors[0][0] / errors[2][0] > 3.5 && errors[0][1] / errors[2][1] > 1.8, "{errors:?}");
    assert!(errors[2].iter().all(|&e| e < 0.01), "{errors:?}");
}

const BILINEAR: &str = r#"{ name = "b", density = 7800, modulus = 200e9, beyond = "extend", curve = { table = [[0.001, 200e6], [0.021, 600e6]] } }"#;

/// Returns a plastic pulse into a cone, with front tracking.
fn plastic_horn(front_tolerance: f64) -> Scene {
    let bar = format!("length = 1\ndiameter = [[0, 0.04], [0.6, 0.02], [1, 0.025]]\nmaterial = {BILINEAR}");
    let left = "kind = \"velocity\"\nhistory = [[0, 0], [20e-6, 8], [60e-6, 8], [80e-6, 0]]";
    let solve = format!("until = 160e-6\nmethod = \"moc\"\nfront-tolerance = {front_tolerance:e}");
    scene(&bar, left, "hardening = \"isotropic\"", &solve)
}

/// Returns the energies of the sampled fields over the true taper, J: kinetic and elastic energy, and plastic work from the plastic strain.
fn field_energies(scene: &Scene, bar: &FrontTracking, samples: u32) -> [f64; 2] {
    let taper = scene.bar.segments[0].taper.as_ref().expect("a horn");
    let dx = scene.bar.length() / f64::from(samples);
    let hardening = 20e9 / 0.9;
    let mut sums = [0.0; 2];
    for i in 0..samples {
        let x = (f64::from(i) + 0.5) * dx;
        let (state, volume) = (bar.state_at(x), taper.area(x) * dx);
        let p = state.plastic_strain.abs();
        sums[0] += volume * 0.5 * (common::DENSITY * state.velocity.powi(2) + state.stress.powi(2) / common::MODULUS);
        sums[1] += volume * (common::YIELD + 0.5 * hardening * p) * p;
    }
    sums
}

/// A sample represents its cell: next to a front, its error is up to half of the cell, and decreases with the cell size. The remaining error
/// decreases with the front tolerance: within a piece of the staircase, the area at a position is not the mean of the piece, which averages out over
/// whole pieces only; and where plastic strains were merged, the ledger has the work of each, the field that of their mean.
#[test]
fn the_field_energy_of_a_tracked_taper_is_the_ledger_s_to_the_sampling_error() {
    const FRONT_TOLERANCES: [f64; 2] = [1e-2, 3e-3];
    let missed = FRONT_TOLERANCES.map(|front_tolerance| {
        let scene = plastic_horn(front_tolerance);
        let bar = tracked(&scene);
        let sum = bar.balance();
        let all = sum.kinetic + sum.elastic + sum.plastic;
        assert!((sum.total() - sum.work[0]).abs() < 1e-10 * all);
        [200, 2000, 20_000].map(|samples| {
            let [moving, plastic] = field_energies(&scene, &bar, samples);
            [moving - sum.kinetic - sum.elastic, moving + plastic - all].map(|missed| missed.abs() / all)
        })
    });
    println!("{missed:?}");
    for (by_samples, front_tolerance) in missed.into_iter().zip(FRONT_TOLERANCES) {
        let [coarse, middle, fine] = by_samples.map(|missed| missed[0]);
        assert!(coarse < 2e-2 && middle < 2e-3 && fine < 0.05 * front_tolerance, "{missed:?}");
    }
    let [coarse, fine] = missed.map(|by_samples| by_samples[2][1]);
    assert!(coarse < 1e-2 && fine < 1e-3 && fine < coarse, "{missed:?}");
}

/// Plastic strains remain after waves have passed, and those of a coarse staircase have larger errors than its stresses.
#[test]
fn the_error_of_a_tracked_taper_covers_its_plastic_strain() {
    let scene = plastic_horn(1e-2);
    let summary = barwave::run::run(&scene, None, &mut |_| ControlFlow::Continue(())).expect("it runs");
    let figure = summary.error.expect("an error").value;
    let (bar, better) = (tracked(&scene), tracked(&plastic_horn(2e-3)));
    let off = |(apart, total): (f64, f64)| apart / total;
    let [stress, plastic] = [off(better.stress_difference(&bar)), off(better.plastic_difference(&bar))];
    println!("figure {figure:.2e}, stress {stress:.2e}, plastic strain {plastic:.2e}");
    assert!(plastic > stress && figure > plastic, "{figure} {stress} {plastic}");
}

/// A net must not cut a slight taper into two pieces with any number of cells: its error would be 3 % with an estimate of zero, and the impulse at
/// the end not that of the force.
#[test]
fn the_pieces_of_a_net_become_finer_with_its_cells() {
    let bar = format!("length = 0.3\ndiameter = [[0, 0.02], [0.3, 0.0203]]\nmaterial = {STEEL}");
    let left = "kind = \"stress\"\nhistory = [[0, 0], [20e-6, -240e6], [300e-6, -240e6]]";
    let of = |cells: usize| {
        let solve = format!("until = 300e-6\nmethod = \"moc\"\ncells = {cells}");
        let scene = scene(&bar, left, "rate = { model = \"malvern\", k = 1e6 }", &solve);
        barwave::run::run(&scene, None, &mut |_| ControlFlow::Continue(())).expect("it runs")
    };
    let force = 240e6 * std::f64::consts::PI * 1e-4;
    let impulse = of(1600).figures.get(&["left"], "impulse").expect("an impulse");
    assert!((impulse / (force * 290e-6) - 1.0).abs() < 1e-3, "{impulse}");
}

/// A plastic pulse into a cone with all three methods; on the net, flow is faster than a step.
#[test]
fn methods_agree_on_a_plastic_taper() {
    let steel = r#"{ name = "b", density = 7800, modulus = 200e9, beyond = "extend", curve = { table = [[0.001, 200e6], [0.021, 600e6]] } }"#;
    let bar = format!("length = 1\ndiameter = [[0, 0.04], [0.6, 0.02], [1, 0.025]]\nmaterial = {steel}");
    let left = "kind = \"velocity\"\nhistory = [[0, 0], [20e-6, 8], [60e-6, 8], [80e-6, 0]]";
    let with = |effects: &str, solve: &str| scene(&bar, left, effects, &format!("until = 160e-6\n{solve}"));
    let x: Vec<f64> = (0..200).map(|i| (f64::from(i) + 0.5) / 200.0).collect();
    let grid = {
        let scene = with("hardening = \"isotropic\"", "cells = 2000");
        let mut bar = assemble::leapfrog(&scene, 2000, 1.0);
        common::advance_to(&mut bar, scene.solve.until);
        assert!(!bar.stayed_elastic());
        let sampling = barwave::solver::fd::Sampling::at(bar.grid(), x.clone());
        let mut stress = vec![0.0; x.len()];
        bar.sample(Field::Stress, &sampling, &mut stress);
        stress
    };
    let fronts = {
        let bar = tracked(&with("hardening = \"isotropic\"", "method = \"moc\"\nfront-tolerance = 2e-3"));
        let mut stress = vec![0.0; x.len()];
        bar.sample(Field::Stress, &x, &mut stress);
        stress
    };
    let net = {
        let scene = with("rate = { model = \"malvern\", k = 1e9 }", "cells = 2000");
        let mut bar = assemble::characteristic_net(&scene, 2000);
        while bar.time() < scene.solve.until - 0.5 * bar.grid().dt {
            bar.advance();
        }
        let sampling = barwave::solver::fd::Sampling::at(bar.grid(), x.clone());
        let mut stress = vec![0.0; x.len()];
        bar.sample(Field::Stress, &sampling, &mut stress);
        stress
    };
    let scale: f64 = grid.iter().map(|s| s.abs()).sum();
    for (name, other) in [("fronts", &fronts), ("net", &net)] {
        let off: f64 = grid.iter().zip(other).map(|(a, b)| (a - b).abs()).sum();
        println!("{name}: {:e}", off / scale);
        // The steps of the staircase are 1 to 2 % of the stress, the mean error half of that, and larger near fronts.
        assert!(off / scale < 0.02, "{name}: {:e}", off / scale);
    }
}

#[test]
fn a_growing_front_breaks_the_taper_by_both_methods_and_the_site_is_the_user_s_segment() {
    let bar = format!("length = 0.5\ndiameter = [[0, 0.04], [0.3, 0.02], [0.5, 0.04]]\nmaterial = {STEEL}");
    let left = "kind = \"stress\"\nvalue = 150e6";
    let with = |solve: &str| scene(&bar, left, "rupture = { spall = 220e6 }", &format!("until = 600e-6\n{solve}"));
    let folder = tempfile::tempdir().expect("a folder");
    let by = ["cells = 1000", "method = \"moc\"\nfront-tolerance = 0.01"].map(|solve| {
        let out = folder.path().join("out.h5");
        let summary = barwave::run::run(&with(solve), Some(&out), &mut |_| ControlFlow::Continue(())).expect("it runs");
        let rupture = summary.ruptures.expect("an effect")[0].clone();
        assert_eq!(rupture.site, "segment 1");
        (serde_json::to_value(rupture).expect("json"), summary.ledger)
    });
    println!("{by:?}");
    let place = |k: usize| by[k].0["x_m"].as_f64().expect("a place");
    // The front reaches the threshold where the diameter is 4 cm 150/220. The grid requires neighbouring cells to reach it, too; the staircase has
    // pieces of 4 mm.
    assert!([0, 1].iter().all(|&k| (place(k) - 0.191).abs() < 0.012), "{by:?}");
}

#[test]
fn a_piece_of_a_bar_of_three_tapers_keeps_the_joints() {
    let text = "[[bar.segment]]\nlength = 0.2\ndiameter = [[0, 0.02], [0.2, 0.01]]\nmaterial = MAT\n\
                [[bar.segment]]\nlength = 0.3\ndiameter = 0.01\nmaterial = MAT\njoint = \"contact\"\ngap = 1e-3\n\
                [[bar.segment]]\nlength = 0.2\narea = [[0, 1e-4], [0.2, 3e-4]]\nmaterial = MAT\nvelocity = -3\n\
                [left]\nkind = \"free\"\n[right]\nkind = \"free\"\n[solve]\nuntil = 1e-3\nmethod = \"moc\"\n";
    let text = text.replace("MAT", STEEL);
    let scene = Scene::parse("s.toml", &text, Path::new("."), &[]).expect("a right scene");
    let cut = scene.in_pieces().expect("tapers");
    let of = &cut.discretized.as_ref().expect("pieces").of;
    let second = of.iter().position(|&k| k == 1).expect("it is there");
    assert_eq!(cut.bar.segments[second].joint, Joint::Contact { gap: 1e-3 });
    assert_eq!(cut.bar.segments.iter().filter(|s| s.joint != Joint::Bonded).count(), 1);
    assert!((cut.bar.length() - scene.bar.length()).abs() < 1e-12);
    let volume = |bar: &Bar| bar.segments.iter().map(|s| s.area * s.length).sum::<f64>();
    assert!((volume(&cut.bar) / volume(&scene.bar) - 1.0).abs() < 1e-12);
    assert_eq!(cut.resolved_json(), scene.resolved_json());
    assert_eq!(cut.original_site(barwave::law::rupture::Site::Joint(second)).to_string(), "joint 2");
    assert_eq!(cut.original_site(barwave::law::rupture::Site::Joint(second + 3)).to_string(), "segment 3");
    assert_eq!(cut.original_origin(barwave::bar::Origin::Joint(second)).to_string(), "joint 2");
}

/// The pulse leaves plastic strain in the thin rod only, which merging must preserve: differences of plastic strain matter although the imposed
/// stress is below the yield stress. Otherwise, they are averaged over the whole rod as soon as it has a few waves to merge.
#[test]
fn merging_keeps_the_plastic_strain_of_a_thin_part() {
    let runs = Path::new(env!("CARGO_MANIFEST_DIR")).join("runs/tapered-horn.toml");
    let scene = Scene::read(&runs, &["solve.method=moc".into(), "solve.cells=".into()]).expect("a scene");
    let Method::FrontTracking { front_tolerance, event_budget } = scene.solve.method else { panic!("fronts") };
    let mut bar = assemble::front_tracking(&scene, Settings { front_tolerance, event_budget, ..Settings::default() });
    let places: Vec<f64> = (0..30).map(|k| 0.401 + 1e-3 * f64::from(k)).collect();
    let mut plastic = [vec![0.0; 30], vec![0.0; 30]];
    for (time, plastic) in [160e-6, 200e-6].into_iter().zip(&mut plastic) {
        bar.advance_to(time).expect("within the budget");
        View::sample(&bar, Field::PlasticStrain, &places, plastic);
    }
    // Plastic strains of the rod with leapfrog, with 1000 and 4000 cells, at 5, 13, 21 and 29 mm from the joint.
    for (place, on_a_grid) in [(4, -1.885e-3), (12, -1.488e-3), (20, -1.077e-3), (28, -0.637e-3)] {
        // The steps of merged fronts are a few percent of the plastic strain.
        assert!((plastic[0][place] - on_a_grid).abs() < 4e-5, "{place}: {}", plastic[0][place]);
    }
    // The plastic strain there does not change after the pulse has passed.
    for (before, after) in plastic[0].iter().zip(&plastic[1]) {
        assert!((before - after).abs() < 1e-6, "{before} {after}");
    }
}
