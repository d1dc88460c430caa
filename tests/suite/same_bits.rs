//! Results that must be the same to the last bit: those of a scene and of its mirror image, and those with any number of threads.

use crate::common;

use std::sync::Arc;

use barwave::bar::{EndCondition, History, Joint, Segment};
use barwave::scene::HardeningRule;
use barwave::solver::EndSample;
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
    hardening: Option<HardeningRule>,
    cells: usize,
    cfl: f64,
}

impl Setup {
    fn new(segments: Vec<Segment>, ends: [EndCondition; 2]) -> Self {
        // A number of cells that is not a multiple of any block size or vector width.
        Self { segments, ends, hardening: Some(HardeningRule::Isotropic), cells: 1301, cfl: 1.0 }
    }

    fn bar(&self) -> Leapfrog {
        common::leapfrog(self.segments.clone(), self.ends.clone(), self.hardening, self.cells, self.cfl)
    }

    /// Returns the mirror image: the state at x is at L - x, with the opposite velocity.
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

/// Returns a segment of a metal like aluminium: softer, lighter, with a table of three slopes.
fn light(length: f64, area: f64) -> Segment {
    let rows = [(0.002, 140e6), (0.01, 180e6), (0.05, 220e6)];
    let mut material = common::material(&rows, barwave::material::Beyond::Extend);
    material.density = 2700.0;
    Segment::new(length, area, material)
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
    for hardening in
        [None, Some(HardeningRule::Isotropic), Some(HardeningRule::Kinematic), Some(HardeningRule::Mixed(0.4))]
    {
        let mut setup = Setup::new(vec![steel(1.0)], [common::moved(20.0), EndCondition::Free]);
        setup.hardening = hardening;
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

/// Returns 40 segments of 1750 cells (three and a half blocks) that collide in pairs.
fn many_collisions(speed: f64) -> Setup {
    let material = Arc::new(common::bilinear_steel());
    let segment = |k: u32| {
        let velocity = if k.is_multiple_of(2) { speed } else { -0.5 * speed };
        Segment::new(0.1, 1.0, Arc::clone(&material)).with_velocity(velocity)
    };
    let mut setup = Setup::new((0..40).map(segment).collect(), [EndCondition::Free, EndCondition::Absorbing]);
    setup.cells = 70_000;
    setup
}

/// Returns the bar after some steps in a thread pool of its own.
fn on_threads(setup: &Setup, threads: usize) -> Leapfrog {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("a pool");
    pool.install(|| {
        let mut bar = setup.bar();
        common::advance(&mut bar, 1200);
        bar
    })
}

/// Compares fields, sums over cells, and ends.
fn assert_same(one: &Leapfrog, other: &Leapfrog, what: &str) {
    for quantity in QUANTITIES {
        let (here, there) = (common::profile(one, quantity), common::profile(other, quantity));
        assert!(here.iter().zip(&there).all(|(a, b)| a.to_bits() == b.to_bits()), "{what}: {quantity:?}");
    }
    assert_eq!(one.energies(), other.energies(), "{what}");
    assert_eq!(one.left().work(), other.left().work(), "{what}");
    assert_eq!(one.right().work(), other.right().work(), "{what}");
    assert!(one.contacts().eq(other.contacts()), "{what}");
}

fn assert_same_on_many_threads(speed: f64, plastic: bool) {
    let setup = many_collisions(speed);
    let one = on_threads(&setup, 1);
    assert_eq!(one.grid().cells(), 70_000);
    assert_eq!(one.stayed_elastic(), !plastic);
    for threads in [2, 3, 4] {
        assert_same(&one, &on_threads(&setup, threads), &format!("{threads} threads"));
    }
}

#[test]
fn an_elastic_bar_on_one_and_many_threads() {
    assert_same_on_many_threads(3.0, false);
}

#[test]
fn a_plastic_bar_on_one_and_many_threads() {
    assert_same_on_many_threads(30.0, true);
}

/// Returns bars with everything that complicates stepping several blocks at once: joints, contacts, ends that separate, walls.
fn busy_setups() -> Vec<Setup> {
    let flying = Segment { velocity: 12.0, area: 2.0, joint: Joint::Contact { gap: 1e-5 }, ..steel(0.6) };
    let released = EndCondition::Velocity { history: History::constant(25.0), release: Some(5e-5) };
    let pieces = vec![flying.clone(), light(0.5, 0.7), Segment { velocity: -9.0, ..steel(0.3) }];
    let mut setups = vec![
        Setup::new(pieces.clone(), [released, EndCondition::Fixed]),
        Setup::new(
            pieces,
            [EndCondition::Striker { mass: 1e4, velocity: 30.0 }, EndCondition::Spring { stiffness: 1e9 }],
        ),
        Setup::new(
            vec![Segment { velocity: -15.0, ..steel(1.0) }],
            [EndCondition::Wall { gap: 1e-4 }, EndCondition::Free],
        ),
        Setup::new(vec![steel(1.0)], [common::moved(20.0), EndCondition::Absorbing]),
        Setup::new(vec![steel(0.01)], [common::moved(20.0), EndCondition::Fixed]),
    ];
    setups.push(Setup { cells: 200, ..setups[3].clone() });
    setups.push(Setup { cells: 3, ..setups[3].clone() });
    setups.push(Setup { cells: 12_345, ..setups[0].clone() });
    for setup in &mut setups {
        setup.cfl = 0.995;
    }
    setups
}

#[test]
fn many_steps_in_one_go_and_one_by_one() {
    for (k, setup) in busy_setups().into_iter().enumerate() {
        let (mut together, mut alone) = (setup.bar(), setup.bar());
        for steps in [1, 2, 7, 31, 32, 33, 100, 1000] {
            together.advance_by(steps);
            (0..steps).for_each(|_| alone.advance());
            assert_eq!(together.step(), alone.step());
            assert_same(&together, &alone, &format!("setup {k}, step {}", alone.step()));
        }
    }
}

#[test]
fn a_log_says_what_was_there_after_each_step() {
    for setup in busy_setups() {
        let (mut logging, mut alone) = (setup.bar(), setup.bar());
        let last = alone.grid().cells() - 1;
        let mut cells = vec![0, 1, last / 3, last / 2, last / 2 + 1, last];
        cells.dedup();
        logging.watch(&cells);
        for steps in [1, 40, 500] {
            logging.advance_by(steps);
            let log = logging.log();
            assert_eq!((log.cells.len(), log.ends[0].len()), (cells.len(), steps));
            for step in 0..steps {
                alone.advance();
                for (cell, rows) in cells.iter().zip(&log.cells) {
                    let wanted =
                        [Quantity::Stress, Quantity::Strain, Quantity::Velocity].map(|q| alone.value(q, *cell));
                    assert_eq!(rows.after(step)[..3], wanted, "cell {cell}, step {}", alone.step());
                }
                // Compared as bits, since unknown means are NaN.
                let bits = |EndSample { now, latest }: EndSample| {
                    [now.stress, now.velocity, latest.stress, latest.velocity].map(f64::to_bits)
                };
                let logged = [log.ends[0][step], log.ends[1][step]];
                assert_eq!(logged.map(bits), alone.end_samples().map(bits));
            }
            logging.clear_log();
        }
    }
}

#[test]
fn a_free_bar_swings_as_it_was_set_moving() {
    // v = cos(3 pi x/L) is a standing wave: after its period everything is as at the start, and after half of it reversed. This is exact at Courant
    // number 1. Below that, a phase of one turn is late by the fraction (k dx)^2 (1 - cfl^2)/24, 1.2e-5; it is compared within half a step (0.007) of
    // its turning point.
    for (cfl, bound) in [(1.0, 1e-12), (0.9, 1e-7)] {
        let mut setup = Setup::new(vec![steel(1.0)], [EndCondition::Free, EndCondition::Free]);
        (setup.cells, setup.cfl) = (600, cfl);
        let wave = |x: f64| (3.0 * std::f64::consts::PI * x).cos();
        let mut bar = setup.bar().moving(wave);
        let centres = bar.grid().centres();
        let start = bar.initial();
        for (half, sign) in [(1, -1.0), (2, 1.0)] {
            let period = 2.0 / 3.0 / (common::MODULUS / common::DENSITY).sqrt();
            common::advance_to(&mut bar, 0.5 * f64::from(half) * period);
            let behind = bar.time() - 0.5 * f64::from(half) * period;
            // The velocity of a cell is the mean of those of its nodes.
            let mean = (1.5 * std::f64::consts::PI * bar.grid().segments[0].dx).cos();
            let swing = sign * mean * (2.0 * std::f64::consts::PI * behind / period).cos();
            let velocity = common::profile(&bar, Quantity::Velocity);
            let missed = centres.iter().zip(velocity).map(|(&x, v)| (v - swing * wave(x)).abs()).fold(0.0, f64::max);
            assert!(missed < bound, "Courant number {cfl}: {missed}");
        }
        let now = bar.energies();
        assert!((now.total() - start.kinetic).abs() < 1e-12 * start.kinetic);
        assert!(now.momentum.abs() < 1e-9);
    }
}
