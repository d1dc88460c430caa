//! Dry friction along the bar against exact solutions: fronts that lose stress, bodies that stop permanently, loads that do not reach the far end;
//! and the energy balance.
//!
//! Consider an elastic bar at rest, pushed from t = 0. As long as everything behind the front moves in the same sense, `sigma - rho c v` increases by
//! f/A per length along characteristics to the right, and `sigma + rho c v` by f/A along those to the left. With `sigma = -rho c v` at the front, the
//! front has `sigma = -s + f x/(2 A)`.

use crate::common;

use barwave::assemble::segment_law;
use barwave::bar::{Bar, EndCondition, Segment};
use barwave::record::Ledger;
use barwave::scene::{Effects, HardeningRule};
use barwave::solver::fd::{DistributedForces, Grid, Leapfrog, Quantity};
use common::{DENSITY, MODULUS, profile};
use std::process::Command;

/// Cross-section, m^2.
const AREA: f64 = 1e-3;
/// Stress at the end, Pa, below yield.
const PUSH: f64 = 50e6;

fn c0() -> f64 {
    (MODULUS / DENSITY).sqrt()
}

/// Returns the friction per length that consumes the front over this length, N/m.
fn friction_over(length: f64) -> f64 {
    2.0 * AREA * PUSH / length
}

fn piece(length: f64, area: f64, velocity: f64) -> Segment {
    Segment::new(length, area, common::elastic_steel()).with_velocity(velocity)
}

fn bar_of(segments: Vec<Segment>, ends: [EndCondition; 2], friction: f64, cells: usize) -> Leapfrog {
    let effects = Effects { hardening: Some(HardeningRule::Isotropic), ..Effects::default() };
    let laws = segments.iter().map(|s| segment_law(s, &effects)).collect();
    let along = DistributedForces { friction, lateral: vec![0.0; segments.len()], ..DistributedForces::default() };
    let bar = Bar { segments, area_given: true };
    let grid = Grid::new(&bar, cells, 1.0);
    Leapfrog::with_along(&bar, grid, laws, ends, &along)
}

/// Returns the largest errors of stress and rho c v behind the front, relative to `PUSH`; `exact` gives both at (x, t).
fn errors(bar: &Leapfrog, exact: impl Fn(f64, f64) -> [f64; 2]) -> [f64; 2] {
    let (stress, velocity, time) = (profile(bar, Quantity::Stress), profile(bar, Quantity::Velocity), bar.time());
    let dx = bar.grid().segments[0].dx;
    let mut worst = [0.0_f64; 2];
    for (k, x) in bar.grid().centres().into_iter().enumerate() {
        // The cells next to the front are excluded.
        if (x - c0() * time).abs() < 1.6 * dx {
            continue;
        }
        let [sigma, v] = if x > c0() * time { [0.0; 2] } else { exact(x, time) };
        worst[0] = worst[0].max((stress[k] - sigma).abs() / PUSH);
        worst[1] = worst[1].max((DENSITY * c0() * velocity[k] - v).abs() / PUSH);
    }
    worst
}

#[test]
fn a_front_loses_stress_in_proportion_to_its_way() {
    let friction = friction_over(1.6);
    let slope = friction / (2.0 * AREA);
    let by_stress = |x: f64, t: f64| [-PUSH + slope * x, PUSH - slope * c0() * t];
    let by_velocity = |x: f64, t: f64| [-PUSH + slope * (2.0 * x - c0() * t), PUSH - slope * x];
    let speed = PUSH / (DENSITY * c0());
    for (what, end, exact) in [
        ("stress", common::loaded_by(&[(0.0, -PUSH)]), &by_stress as &dyn Fn(f64, f64) -> [f64; 2]),
        ("velocity", common::moved(speed), &by_velocity),
    ] {
        let found = [250, 500, 1000].map(|cells| {
            let mut bar = bar_of(vec![piece(1.0, AREA, 0.0)], [end.clone(), EndCondition::Free], friction, cells);
            common::advance_to(&mut bar, 0.8 / c0());
            errors(&bar, exact)
        });
        println!("{what}: {found:?}");
        // First order at most: the friction of half a cell.
        for (k, errors) in found.iter().enumerate() {
            assert!(errors.iter().all(|e| *e < 1.0 / (250.0 * f64::powi(2.0, k as i32))), "{what}: {found:?}");
        }
    }
}

/// Mirror image, and tension.
#[test]
fn the_sign_of_the_motion_does_not_matter() {
    let friction = friction_over(0.7);
    let run = |sign: f64, from_left: bool| {
        let load = common::loaded_by(&[(0.0, sign * PUSH)]);
        let ends = if from_left { [load, EndCondition::Free] } else { [EndCondition::Free, load] };
        let mut bar = bar_of(vec![piece(1.0, AREA, 0.0)], ends, friction, 200);
        common::advance(&mut bar, 500);
        let mut stress = profile(&bar, Quantity::Stress);
        if !from_left {
            stress.reverse();
        }
        stress.into_iter().map(|s| sign * s).collect::<Vec<f64>>()
    };
    let first = run(-1.0, true);
    for other in [run(1.0, true), run(-1.0, false), run(1.0, false)] {
        let off = first.iter().zip(&other).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        assert!(off < 1e-12 * PUSH, "{off:e}");
    }
}

/// The front vanishes at t = 2 A s/f; all moving parts stop at that moment, permanently, with `sigma = -s + f x/(2 A)`.
#[test]
fn a_pushed_bar_stops_all_at_once_and_stays() {
    let way = 0.6;
    let friction = friction_over(way);
    for cells in [200, 800] {
        let ends = [common::loaded_by(&[(0.0, -PUSH)]), EndCondition::Free];
        let mut bar = bar_of(vec![piece(1.0, AREA, 0.0)], ends, friction, cells);
        let dx = 1.0 / cells as f64;
        common::advance_to(&mut bar, (way + 4.0 * dx) / c0());
        assert!(profile(&bar, Quantity::Velocity).iter().all(|v| *v == 0.0), "{cells}");
        assert_eq!(bar.right().displacement(), 0.0);
        let stress = profile(&bar, Quantity::Stress);
        let exact = |x: f64| -PUSH * (1.0 - x / way).max(0.0);
        let centres = bar.grid().centres();
        let off = centres.iter().zip(&stress).map(|(x, s)| (s - exact(*x)).abs() / PUSH).fold(0.0, f64::max);
        println!("{cells} cells: {off:.1e} of the stress at the end");
        assert!(off < 2.0 * dx / way, "{off:e}");
        let energies = bar.energies();
        common::advance(&mut bar, 10 * cells);
        assert_eq!(profile(&bar, Quantity::Stress), stress, "it creeps");
        assert_eq!((bar.energies().damping, bar.energies().kinetic), (energies.damping, 0.0));
    }
}

/// A bar in free motion decelerates by f L/M and stops permanently, for any number of cells.
#[test]
fn a_flying_bar_slows_down_as_a_rigid_body_and_stops() {
    let (friction, speed) = (2e4, 3.0);
    let slowing = friction / (DENSITY * AREA);
    for cells in [3, 50, 64] {
        let mut bar = bar_of(vec![piece(1.0, AREA, speed)], [EndCondition::Free, EndCondition::Free], friction, cells);
        let start = bar.initial().kinetic;
        while bar.time() < 0.8 * speed / slowing {
            bar.advance();
            let half_a_step_on = bar.time() + 0.5 * bar.grid().dt;
            let exact = speed - slowing * half_a_step_on;
            assert!((bar.left().velocity_after() - exact).abs() < 1e-10 * speed, "{} {exact}", bar.time());
        }
        common::advance_to(&mut bar, 1.2 * speed / slowing);
        let (rest, place) = (bar.energies(), bar.left().displacement());
        assert_eq!((rest.kinetic, rest.momentum), (0.0, 0.0));
        // Rounding of a thousand steps.
        assert!((rest.damping / start - 1.0).abs() < 1e-11, "{} of {start}", rest.damping);
        let way = 0.5 * speed * speed / slowing;
        // It stops within a step, not at its end.
        let step = slowing * bar.grid().dt / speed;
        assert!((place / way - 1.0).abs() < step * step, "{place} {way}");
        common::advance(&mut bar, 1000);
        assert_eq!((bar.energies(), bar.left().displacement()), (rest, place));
    }
}

/// If the end is pushed slowly, its force is f times the length that has moved: a load below f L never moves the far end, one above it does. A sudden
/// load moves twice that length.
#[test]
fn a_load_below_the_friction_of_the_bar_never_arrives() {
    let push = |part: f64, rise: f64, length: f64| {
        let load = common::loaded_by(&[(0.0, 0.0), (rise, -PUSH)]);
        let ends = [load, EndCondition::Free];
        let friction = AREA * PUSH / (part * length);
        let mut bar = bar_of(vec![piece(length, AREA, 0.0)], ends, friction, 100);
        common::advance_to(&mut bar, rise + 4.0 * length / c0());
        (bar.right().displacement(), bar.energies().kinetic)
    };
    let slow = 400.0 / c0();
    assert_eq!(push(0.96, slow, 1.0), (0.0, 0.0));
    assert!(push(1.04, slow, 1.0).0 > 0.0);
    assert_eq!(push(0.48, 1e-12, 1.0), (0.0, 0.0));
    assert!(push(0.52, 1e-12, 1.0).0 > 0.0);
}

/// A joint transmits 2 A1/(A1 + A2) of the stress of the front, which then decreases by f/(2 A2) per length.
#[test]
fn a_front_crosses_a_joint() {
    let friction = friction_over(4.0);
    for area in [0.5 * AREA, 2.0 * AREA] {
        let ends = [common::loaded_by(&[(0.0, -PUSH)]), EndCondition::Free];
        let cells = 2000;
        let mut bar = bar_of(vec![piece(0.5, AREA, 0.0), piece(0.5, area, 0.0)], ends, friction, cells);
        for time in [0.55, 0.7, 0.95] {
            common::advance_to(&mut bar, time / c0());
            let stress = profile(&bar, Quantity::Stress);
            let arrives = -PUSH + friction * 0.5 / (2.0 * AREA);
            let exact = 2.0 * AREA / (AREA + area) * arrives + friction * (time - 0.5) / (2.0 * area);
            // Two cells behind the front.
            let found = stress[(time * cells as f64) as usize - 3];
            println!("area {area}, x = {time}: {found:.0} Pa, exact {exact:.0}");
            assert!((found / exact - 1.0).abs() < 3e-3, "{area} {time}: {found} {exact}");
        }
    }
}

/// The energy dissipated by friction never decreases, with every kind of end, and the energy balance closes.
#[test]
fn the_account_of_friction_closes_and_only_grows() {
    for left in common::busy_ends(AREA) {
        for friction in [1e2, 1e5, 1e8] {
            let segments = vec![piece(0.5, AREA, 0.0), piece(0.3, 2.0 * AREA, 6.0)];
            let mut bar = bar_of(segments, [left.clone(), EndCondition::Free], friction, 120);
            let (mut ledger, mut taken) = (Ledger::new(&bar), 0.0);
            for _ in 0..1000 {
                bar.advance();
                ledger.row(&bar);
                let now = bar.energies().damping;
                assert!(now >= taken, "{left:?} {friction}: {now} after {taken}");
                taken = now;
            }
            common::assert_ledger(&ledger, &format!("{left:?} {friction}"));
            assert!(taken > 0.0);
        }
    }
}

const SCENE: &str = "[bar]\nlength = 1\narea = \"10 cm^2\"\n[bar.material]\nname = \"steel\"\ndensity = 7800\nmodulus = 200e9\n\
                     poisson = 0.3\nbeyond = \"extend\"\ncurve = { table = [[0.001, 200e6], [0.021, 600e6]] }\n[left]\nkind = \"velocity\"\n\
                     value = 10\n[right]\nkind = \"free\"\n[effects]\nhardening = \"isotropic\"\ndamping = { friction = \"20 kN/m\" }\n\
                     [solve]\nuntil = \"1 ms\"\ncells = 200\n";

fn barwave(scene: &str, arguments: &[&str]) -> (bool, String) {
    let folder = tempfile::tempdir().expect("a folder");
    std::fs::write(folder.path().join("scene.toml"), scene).expect("written");
    let output = Command::new(env!("CARGO_BIN_EXE_barwave")).args(arguments).current_dir(folder.path()).output();
    let output = output.expect("the binary runs");
    let text = [&output.stdout[..], &output.stderr[..]].concat();
    (output.status.success(), String::from_utf8_lossy(&text).into_owned())
}

#[test]
fn a_scene_with_friction_runs_and_says_so() {
    let (right, text) = barwave(SCENE, &["run", "scene.toml", "--json", "-o", "out.h5"]);
    assert!(right, "{text}");
    let summary: serde_json::Value = serde_json::from_str(&text).expect("one JSON value");
    assert!(text.contains("damping: friction = 20 kN/m"), "{text}");
    assert!(summary["ledger"]["energy_residual"].as_f64().expect("a residual").abs() < 1e-10, "{text}");
    let (right, plan) = barwave(SCENE, &["plan", "scene.toml"]);
    assert!(right && plan.contains("friction = 20 kN/m"), "{plan}");
}

#[test]
fn what_friction_does_not_go_with_is_refused() {
    for (from, to, says) in [
        ("friction = \"20 kN/m\"", "friction = \"-1 N/m\"", "friction >= 0"),
        ("friction = \"20 kN/m\"", "friction = \"1 MPa\"", "a force per length is expected"),
        ("friction =", "internal = 1, friction =", "not simulated together with `internal`"),
        ("hardening = \"isotropic\"", "lateral-inertia = true", "not simulated together with `lateral-inertia`"),
        ("area = \"10 cm^2\"\n", "", "`friction` is a force per length and needs the cross-section"),
        ("[solve]", "[solve]\nmethod = \"moc\"", "does not simulate the effect `damping`"),
        ("[solve]", "[solve]\nscheme = \"muscl\"", "use scheme = \"leapfrog\""),
    ] {
        let (right, text) = barwave(&SCENE.replace(from, to), &["check", "scene.toml"]);
        assert!(!right && text.contains(says), "{to}: {text}");
    }
}
