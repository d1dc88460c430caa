//! Curves that are level, or nearly so: the conservative scheme stays bounded. Where a curve cannot answer a velocity with a
//! stress, strain stays where it is imposed.

mod common;
#[path = "common/muscl.rs"]
mod muscl;

use barwave::bar::{EndCondition, Segment};
use barwave::material::{Beyond, Curve, Hollow, Material};
use barwave::record::{Ledger, View};
use barwave::scene::Unloading;
use barwave::solver::fd::Quantity;
use barwave::solver::muscl::Muscl;

const ISOTROPIC: Option<Unloading> = Some(Unloading::Isotropic);
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

/// A perfectly plastic shear curve, as a rod (q = 0) or a thick tube has it.
fn twisted(q: f64) -> Material {
    let curve = Curve::new(&[(0.002, 160e6), (0.5, 160e6)], Beyond::Extend).expect("rows rise");
    let shear = Material::from_curve("steel", common::DENSITY, curve);
    (*shear.in_torsion(Hollow { q }).expect("a curve")).clone()
}

/// What a run met on its way.
struct Met {
    largest_strain: f64,
    /// Most the scheme returned in a step, and least it had taken in all, over the energy of the bar.
    returned: f64,
    least_taken: f64,
    zigzag: bool,
}

fn follow(bar: &mut Muscl, what: &str) -> Met {
    let start = bar.start().kinetic;
    let mut ledger = Ledger::new(bar);
    let mut met = Met { largest_strain: 0.0, returned: 0.0, least_taken: 0.0, zigzag: false };
    let (mut taken, mut scale) = (0.0, start);
    while bar.time() < UNTIL {
        bar.advance();
        ledger.row(bar);
        let account = bar.account();
        scale = f64::max(scale, start + account.kinetic + account.elastic + account.plastic);
        met.returned = met.returned.max((taken - account.viscous) / scale);
        met.least_taken = met.least_taken.min(account.viscous / scale);
        taken = account.viscous;
        let strains = muscl::profile(bar, Quantity::Strain);
        met.largest_strain = strains.iter().fold(met.largest_strain, |most, strain| most.max(strain.abs()));
        // Beyond what elastic waves alone may leave.
        let alternates = |w: &[f64]| w[0] * w[1] < 0.0 && w[1] * w[2] < 0.0 && w.iter().all(|e| e.abs() > 5e-3);
        met.zigzag |= strains.windows(3).any(alternates);
    }
    assert_eq!(bar.not_finite(), None, "{what}");
    common::assert_ledger(&ledger, what);
    met
}

/// Ends, and the velocity of the bar at the start.
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

/// Slopes, and the half step ahead at the ends, leave errors of second order in what the scheme takes: at most this part of
/// the energy of the bar in a step.
const RETURNED: [(usize, f64); 3] = [(3, 3e-2), (20, 6e-3), (200, 6e-3)];

fn check(name: &str, material: &Material, unloadings: &[Option<Unloading>]) {
    for &unloading in unloadings {
        for (cells, returned) in RETURNED {
            for cfl in [1.0, 0.7] {
                for (scene, ends, velocity) in scenes() {
                    let what = format!("{name}, {scene}, {unloading:?}, {cells} cells, cfl {cfl}");
                    let segment = Segment { velocity, ..common::segment(material.clone(), 1.0) };
                    let mut bar = muscl::muscl(vec![segment], ends, unloading, cells, cfl);
                    let met = follow(&mut bar, &what);
                    // All of what is imposed in one cell, and elastic waves.
                    let allowed = VELOCITY * bar.time() / bar.grid().segments[0].dx + 0.01;
                    println!("{what}: {} of {allowed}, {:e} {:e}", met.largest_strain, met.returned, met.least_taken);
                    assert!(met.largest_strain < allowed, "{what}: {} {allowed}", met.largest_strain);
                    assert!(!met.zigzag, "{what}: strains of alternating signs");
                    // A curve that is followed both ways gives back energy that its shocks have lost.
                    assert!(unloading.is_none() || met.returned < returned, "{what}: {:e}", met.returned);
                    assert!(unloading.is_none() || met.least_taken > -1e-12, "{what}: {:e}", met.least_taken);
                }
            }
        }
    }
}

/// Strains of 158 in both senses, and 3000 times the work of the end from nowhere.
#[test]
fn a_perfectly_plastic_rod_in_torsion_stays_bounded() {
    check("rod", &twisted(0.0), &[None, ISOTROPIC, Some(Unloading::Kinematic)]);
}

#[test]
fn a_perfectly_plastic_tube_in_torsion_stays_bounded() {
    check("tube", &twisted(0.6), &[None, ISOTROPIC, Some(Unloading::Mixed(0.5))]);
}

#[test]
fn perfect_plasticity_stays_bounded() {
    check("perfectly plastic", &perfectly_plastic(), &[None, ISOTROPIC, Some(Unloading::Kinematic)]);
}

#[test]
fn a_yield_drop_stays_bounded() {
    check("yield drop", &yield_drop(), &[None, ISOTROPIC]);
}

#[test]
fn softening_stays_bounded() {
    check("softening", &softening(), &[None, ISOTROPIC, Some(Unloading::Mixed(0.5))]);
}

#[test]
fn a_level_stretch_inside_a_curve_stays_bounded() {
    check("level in the middle", &level_in_the_middle(), &[None, ISOTROPIC]);
}
