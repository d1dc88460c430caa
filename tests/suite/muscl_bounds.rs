//! Curves with a level stretch (perfect plasticity, yield drop, softening): strains of the conservative scheme are bounded by the imposed velocity,
//! and the scheme never adds more energy to the bar than it has dissipated.

use crate::common;
use crate::common::muscl;

use std::path::Path;

use barwave::assemble;
use barwave::bar::EndCondition;
use barwave::material::{Beyond, Curve, Material, TubeSection};
use barwave::record::{Ledger, View};
use barwave::scene::{HardeningRule, Method, Scene};
use barwave::solver::fd::Quantity;
use barwave::solver::muscl::Muscl;

const ISOTROPIC: Option<HardeningRule> = Some(HardeningRule::Isotropic);
const VELOCITY: f64 = 20.0;
const UNTIL: f64 = 1e-3;

fn perfectly_plastic() -> Material {
    common::material(&[(0.001, 200e6), (0.5, 200e6)], Beyond::Extend)
}

fn yield_drop() -> Material {
    let rows = [(0.0015, 300e6), (0.0016, 250e6), (0.02, 250e6), (0.1, 380e6), (0.2, 430e6)];
    common::material(&rows, Beyond::Extend)
}

fn softening() -> Material {
    common::material(&[(0.001, 200e6), (0.01, 300e6), (0.05, 250e6), (0.2, 100e6)], Beyond::Extend)
}

fn level_in_the_middle() -> Material {
    common::material(&[(0.001, 200e6), (0.01, 300e6), (0.03, 300e6), (0.2, 500e6)], Beyond::Extend)
}

/// Returns a perfectly plastic shear curve of a rod (q = 0) or a thick tube.
fn twisted(q: f64) -> Material {
    let curve = Curve::new(&[(0.002, 160e6), (0.5, 160e6)], Beyond::Extend).expect("rows rise");
    let shear = Material::from_curve("steel", common::DENSITY, curve).expect("a material");
    (*shear.in_torsion(TubeSection { q }).expect("a curve")).clone()
}

/// Extreme values over a run; energies are relative to the largest energy of the bar so far.
struct Extremes {
    largest_strain: f64,
    /// Smallest `numerical`; at most 0.
    least_numerical: f64,
    /// True if strains of three neighbouring cells alternate in sign by more than the remainders of elastic waves.
    alternates: bool,
}

fn follow(bar: &mut Muscl, until: f64, what: &str) -> Extremes {
    let start = bar.start().energy;
    let mut ledger = Ledger::new(bar);
    let mut met = Extremes { largest_strain: 0.0, least_numerical: 0.0, alternates: false };
    let mut scale = start;
    while bar.time() < until {
        bar.advance();
        ledger.row(bar);
        let energies = bar.account().energies;
        scale = f64::max(scale, start + energies.kinetic + energies.elastic + energies.plastic);
        met.least_numerical = met.least_numerical.min(energies.numerical / scale);
        let strains = muscl::profile(bar, Quantity::Strain);
        met.largest_strain = strains.iter().fold(met.largest_strain, |most, strain| most.max(strain.abs()));
        let alternates = |w: &[f64]| w[0] * w[1] < 0.0 && w[1] * w[2] < 0.0 && w.iter().all(|e| e.abs() > 5e-3);
        met.alternates |= strains.windows(3).any(alternates);
    }
    assert_eq!(bar.not_finite(), None, "{what}");
    common::assert_ledger(&ledger, what);
    met
}

/// Checks that the imposed velocity bounds the strains, and that the scheme adds no energy.
fn assert_bounded(bar: &mut Muscl, until: f64, what: &str) {
    let met = follow(bar, until, what);
    // The whole imposed displacement in one cell, and the strain of elastic waves.
    let allowed = VELOCITY * bar.time() / bar.grid().segments[0].dx + 0.01;
    let Extremes { largest_strain, least_numerical, alternates } = met;
    println!("{what}: strain {largest_strain} of {allowed}, least {least_numerical:e}");
    assert!(largest_strain < allowed, "{what}: {largest_strain} {allowed}");
    assert!(!alternates, "{what}: strains of alternating signs");
    // The scheme adds at most what it has dissipated; the rest is rounding.
    assert!(least_numerical > -1e-12, "{what}: {least_numerical:e}");
}

/// Returns ends, and the initial velocity of the bar.
fn scenes() -> [(&'static str, [EndCondition; 2], f64); 5] {
    let striker = EndCondition::Striker { mass: 3000.0, velocity: VELOCITY };
    [
        ("pushed, free", [common::moved(VELOCITY), EndCondition::Free], 0.0),
        ("pushed, fixed", [common::moved(VELOCITY), EndCondition::Fixed], 0.0),
        ("pulled, absorbing", [common::moved(-VELOCITY), EndCondition::Absorbing], 0.0),
        ("against a fixed end", [EndCondition::Fixed, EndCondition::Free], -VELOCITY),
        ("struck", [striker, EndCondition::Fixed], 0.0),
    ]
}

fn check(name: &str, material: &Material, hardenings: &[Option<HardeningRule>]) {
    for &hardening in hardenings {
        for cells in [3, 20, 200] {
            for cfl in [1.0, 0.7] {
                for (scene, ends, velocity) in scenes() {
                    let what = format!("{name}, {scene}, {hardening:?}, {cells} cells, cfl {cfl}");
                    let segment = common::segment(material.clone(), 1.0).with_velocity(velocity);
                    let mut bar = muscl::muscl(vec![segment], ends, hardening, cells, cfl);
                    assert_bounded(&mut bar, UNTIL, &what);
                }
            }
        }
    }
}

/// With slopes in flowing cells, the strain at the twisted end would be +5.98: opposite to the imposed velocity, and far beyond what it can
/// cause.
#[test]
fn a_suddenly_twisted_perfectly_plastic_rod_stays_bounded() {
    let text = r#"
[bar]
mode = "torsion"
length = 1
diameter = 0.02
[bar.material]
name = "s"
loading = "shear"
density = 7800
modulus = 80e9
beyond = "extend"
curve = { table = [[0.002, 160e6], [0.5, 160e6]] }
[left]
kind = "velocity"
history = [[0, "2000 rad/s"], [1, 2000]]
[right]
kind = "free"
[effects]
hardening = "isotropic"
[solve]
until = 1e-3
method = "fd"
scheme = "muscl"
cells = 20
"#;
    let scene = Scene::parse("rod.toml", text, Path::new("."), &[]).unwrap_or_else(|e| panic!("{e}"));
    let Method::Muscl { cells, cfl } = scene.solve.method else { panic!("{:?}", scene.solve.method) };
    let mut bar = assemble::muscl(&scene, cells, cfl);
    assert_bounded(&mut bar, scene.solve.until, "twisted rod");
    // The end turns in the sense of negative strain, and is never turned back.
    let strain = muscl::profile(&bar, Quantity::Strain)[0];
    assert!(strain < 0.0, "{strain}");
}

/// The nominal curve of a rod becomes level gradually.
#[test]
fn a_perfectly_plastic_rod_in_torsion_stays_bounded() {
    check("rod", &twisted(0.0), &[None, ISOTROPIC, Some(HardeningRule::Kinematic)]);
}

#[test]
fn a_perfectly_plastic_tube_in_torsion_stays_bounded() {
    check("tube", &twisted(0.6), &[None, ISOTROPIC, Some(HardeningRule::Mixed(0.5))]);
}

#[test]
fn perfect_plasticity_stays_bounded() {
    check("perfectly plastic", &perfectly_plastic(), &[None, ISOTROPIC, Some(HardeningRule::Kinematic)]);
}

#[test]
fn a_yield_drop_stays_bounded() {
    check("yield drop", &yield_drop(), &[None, ISOTROPIC]);
}

#[test]
fn softening_stays_bounded() {
    check("softening", &softening(), &[None, ISOTROPIC, Some(HardeningRule::Mixed(0.5))]);
}

#[test]
fn a_level_stretch_inside_a_curve_stays_bounded() {
    check("level in the middle", &level_in_the_middle(), &[None, ISOTROPIC]);
}

/// A side with more stress than the level curve beside it can carry must unload, and not be compressed further: otherwise, the bar gains up to 30 %
/// of all energy, at any resolution.
#[test]
fn a_joint_beside_a_curve_that_falls_to_nothing_gives_no_energy() {
    let material = |rows: &[(f64, f64)]| common::material(rows, Beyond::Rupture);
    let (hardens, falls) = (material(&[(0.00025, 50e6), (0.0148, 574e6)]), material(&[(0.00044, 88e6), (0.0174, 0.0)]));
    let segment = |material: &Material, length: f64| common::segment(material.clone(), length);
    for (cells, sense) in [(67, 1.0), (200, 1.0), (67, -1.0), (200, -1.0)] {
        for mirrored in [false, true] {
            let mut segments = vec![
                segment(&hardens, 0.2).with_velocity(29.0 * sense),
                segment(&falls, 1.0).with_velocity(-30.0 * sense),
            ];
            let mut ends = [EndCondition::Free, EndCondition::Wall { gap: 0.0 }];
            if mirrored {
                segments.reverse();
                ends.reverse();
            }
            let mut bar = muscl::muscl(segments, ends, ISOTROPIC, cells, 1.0);
            let met = follow(&mut bar, UNTIL, "falls to nothing");
            assert!(met.least_numerical > -1e-12, "{cells} {sense} {mirrored}: {}", met.least_numerical);
        }
    }
}
