//! Results that must be the same to the last bit: of a scene and its mirror image, and on any number of threads.

mod common;

use std::sync::Arc;

use barwave::bar::{EndCondition, History, Joint, Segment};
use barwave::scene::Unloading;
use barwave::solver::fd::{Leapfrog, Quantity};

const QUANTITIES: [Quantity; 5] = [
    Quantity::Stress,
    Quantity::Strain,
    Quantity::Velocity,
    Quantity::PlasticStrain,
    Quantity::AccumulatedPlasticStrain,
];

#[derive(Clone)]
struct Setup {
    segments: Vec<Segment>,
    ends: [EndCondition; 2],
    unloading: Option<Unloading>,
    cells: usize,
    cfl: f64,
}

impl Setup {
    fn new(segments: Vec<Segment>, ends: [EndCondition; 2]) -> Self {
        // A number of cells that is no multiple of any block size or vector width.
        Self { segments, ends, unloading: Some(Unloading::Isotropic), cells: 1301, cfl: 1.0 }
    }

    fn bar(&self) -> Leapfrog {
        common::leapfrog(self.segments.clone(), self.ends.clone(), self.unloading, self.cells, self.cfl)
    }

    /// Left and right swapped: what stood at x stands at L - x, and moves the other way.
    fn mirrored(&self) -> Self {
        let joint = |k: usize| if k == 0 { Joint::Bonded } else { self.segments[k - 1].joint };
        let segment = |(k, s): (usize, &Segment)| Segment { velocity: -s.velocity, joint: joint(k), ..s.clone() };
        let [left, right] = &self.ends;
        Self {
            segments: self.segments.iter().enumerate().rev().map(segment).collect(),
            ends: [mirrored_end(right), mirrored_end(left)],
            ..self.clone()
        }
    }
}

fn mirrored_end(end: &EndCondition) -> EndCondition {
    let EndCondition::Velocity { history, release } = end else { return end.clone() };
    let rows: Vec<(f64, f64)> = history.time().iter().zip(history.value()).map(|(&t, &v)| (t, -v)).collect();
    EndCondition::Velocity { history: History::new(&rows).expect("in order"), release: *release }
}

/// Steps both images and compares every field on the way, and the ends.
fn assert_mirrored(setup: &Setup, plastic: bool) {
    let (mut bar, mut image) = (setup.bar(), setup.mirrored().bar());
    let steps = 3 * setup.cells;
    for _ in 0..12 {
        common::advance(&mut bar, steps / 12);
        common::advance(&mut image, steps / 12);
        for quantity in QUANTITIES {
            let sign = if quantity == Quantity::Velocity { -1.0 } else { 1.0 };
            let (here, there) = (common::profile(&bar, quantity), common::profile(&image, quantity));
            let differs = here.iter().zip(there.iter().rev()).position(|(a, b)| *a != sign * b);
            assert_eq!(differs, None, "{quantity:?} at step {}", bar.step());
        }
        assert_eq!(bar.left().stress(), image.right().stress());
        assert_eq!(bar.right().velocity(), -image.left().velocity());
        assert_eq!(bar.left().work(), image.right().work());
        assert_eq!(bar.right().displacement(), -image.left().displacement());
    }
    assert_eq!(bar.stayed_elastic(), !plastic);
    assert!(common::profile(&bar, Quantity::Stress).iter().any(|s| *s != 0.0), "nothing happened");
}

fn steel(length: f64) -> Segment {
    common::segment(common::bilinear_steel(), length)
}

/// Aluminium-like: softer, lighter, with a table of three slopes.
fn light(length: f64, area: f64) -> Segment {
    let rows = [(0.002, 140e6), (0.01, 180e6), (0.05, 220e6)];
    let mut material = common::material(&rows, barwave::material::Beyond::Extend);
    material.density = 2700.0;
    Segment { area, ..common::segment(material, length) }
}

#[test]
fn an_elastic_bar() {
    let ends = [common::moved_by(&[(0.0, 1.5), (4e-5, 1.5), (4e-5, 0.0), (9e-5, -0.8)]), EndCondition::Free];
    let mut setup = Setup::new(vec![steel(1.0)], ends);
    assert_mirrored(&setup, false);
    setup.cfl = 0.7;
    assert_mirrored(&setup, false);
}

#[test]
fn a_bilinear_bar_struck_at_20_m_s() {
    for unloading in [None, Some(Unloading::Isotropic), Some(Unloading::Kinematic), Some(Unloading::Mixed(0.4))] {
        let mut setup = Setup::new(vec![steel(1.0)], [common::moved(20.0), EndCondition::Free]);
        setup.unloading = unloading;
        assert_mirrored(&setup, true);
    }
}

#[test]
fn a_power_law_bar_loaded_by_a_pulse() {
    let pulse = common::loaded_by(&[(0.0, 0.0), (2e-5, -350e6), (6e-5, -350e6), (6e-5, 100e6)]);
    let segment = common::segment(common::power_law_steel(), 1.0);
    let mut setup = Setup::new(vec![segment], [pulse, EndCondition::Absorbing]);
    setup.cfl = 0.9;
    assert_mirrored(&setup, true);
}

#[test]
fn a_bar_that_hits_a_wall() {
    for gap in [0.0, 1e-3] {
        let flying = Segment { velocity: -15.0, ..steel(1.0) };
        assert_mirrored(&Setup::new(vec![flying], [EndCondition::Wall { gap }, EndCondition::Free]), true);
    }
}

#[test]
fn two_materials_with_a_step_in_area() {
    let flying = Segment { velocity: 12.0, area: 2.0, ..steel(0.6) };
    let released = EndCondition::Velocity { history: History::constant(25.0), release: Some(5e-5) };
    assert_mirrored(&Setup::new(vec![flying, light(0.5, 0.7)], [released, EndCondition::Fixed]), true);
}

/// 40 segments of 1750 cells that run into each other, two and two: three blocks and a half each.
fn many_collisions(speed: f64) -> Setup {
    let material = Arc::new(common::bilinear_steel());
    let segment = |k: u32| Segment {
        length: 0.1,
        area: 1.0,
        taper: None,
        material: Arc::clone(&material),
        velocity: if k.is_multiple_of(2) { speed } else { -0.5 * speed },
        joint: Joint::Bonded,
    };
    let mut setup = Setup::new((0..40).map(segment).collect(), [EndCondition::Free, EndCondition::Absorbing]);
    setup.cells = 70_000;
    setup
}

/// The bar after some steps on a pool of its own.
fn on_threads(setup: &Setup, threads: usize) -> Leapfrog {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("a pool");
    pool.install(|| {
        let mut bar = setup.bar();
        common::advance(&mut bar, 1200);
        bar
    })
}

fn assert_same_on_two_threads(speed: f64, plastic: bool) {
    let setup = many_collisions(speed);
    let (one, two) = (on_threads(&setup, 1), on_threads(&setup, 2));
    assert_eq!(one.grid().cells(), 70_000);
    assert_eq!(one.stayed_elastic(), !plastic);
    for quantity in QUANTITIES {
        let (here, there) = (common::profile(&one, quantity), common::profile(&two, quantity));
        assert!(here.iter().zip(&there).all(|(a, b)| a.to_bits() == b.to_bits()), "{quantity:?}");
    }
    // The sums over cells too.
    assert_eq!(one.energies(), two.energies());
    assert_eq!(one.right().work(), two.right().work());
}

#[test]
fn an_elastic_bar_on_one_and_two_threads() {
    assert_same_on_two_threads(3.0, false);
}

#[test]
fn a_plastic_bar_on_one_and_two_threads() {
    assert_same_on_two_threads(30.0, true);
}
