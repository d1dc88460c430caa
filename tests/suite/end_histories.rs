//! Histories of the ends: the state just after t = 0 with every method, and both sides of every jump.

use std::ops::ControlFlow;
use std::path::Path;

use barwave::record::Trace;
use barwave::run::{self, Solution};
use barwave::scene::Scene;

/// Impedance of steel with 200 GPa and 7800 kg/m^3, Pa s/m, and a velocity, m/s.
const IMPEDANCE: f64 = 39_496_835.316_263;
const SPEED: f64 = 5_063.696_835_418_333;

/// Returns the methods with a resolution of `cells` cells (front tracking has none). The net uses a bar with a strain rate that has no effect here.
fn methods(cells: usize) -> [(&'static str, String); 4] {
    [
        ("leapfrog", format!("cells = {cells}")),
        ("Godunov", format!("cells = {cells}\nscheme = \"muscl\"")),
        ("net", format!("cells = {cells}\nmethod = \"moc\"\n[effects]\nrate = {{ model = \"malvern\", k = 1e5 }}")),
        ("front tracking", "method = \"moc\"\nfront-tolerance = 1e-3".to_owned()),
    ]
}

/// Solves a bar of 1 m and 1 cm^2 with the initial velocity `velocity` (m/s), for `transits` transit times.
fn solve(left: &str, right: &str, velocity: f64, transits: f64, solve: &str) -> Solution {
    let until = transits / SPEED;
    let text = format!(
        "[[bar.segment]]\nlength = 1\narea = 1e-4\nvelocity = {velocity}\nmaterial = {{ name = \"steel\", density = 7800, \
         modulus = 2e11, beyond = \"extend\", curve = {{ table = [[0.002, 4e8], [0.1, 2e9]] }} }}\n\
         [left]\n{left}\n[right]\n{right}\n[record]\nframes = 2\n[solve]\nuntil = {until:e}\n{solve}\n"
    );
    let scene = Scene::parse("bar.toml", &text, Path::new("."), &[]).unwrap_or_else(|error| panic!("{error}"));
    run::solve(&scene, &mut |_| ControlFlow::Continue(())).expect("it runs")
}

/// The state on a grid is known only at whole steps.
#[test]
fn runs_of_a_few_steps_say_that_they_end_with_a_whole_one() {
    let notes = |until: f64, solve: &str| {
        let text = format!(
            "[bar]\nlength = 1\nmaterial = \"mild-steel\"\n[left]\nkind = \"velocity\"\nvalue = 1\n[right]\nkind = \"free\"\n\
             [solve]\nuntil = {until:e}\n{solve}\n"
        );
        Scene::parse("bar.toml", &text, Path::new("."), &[]).expect("a scene").notes().join("\n")
    };
    assert!(notes(1e-12, "cells = 1000").contains("time steps after the start"));
    assert_eq!([notes(1e-5, "cells = 1000"), notes(1e-12, "method = \"moc\"")], ["", ""]);
    assert!(notes(300.0, "").contains("a number without a unit is in seconds"));
    // The steps follow from the Courant number: 1000 of them per cell.
    let few = |text: String| text.contains("after the start");
    assert!(few(notes(1e-4, "cells = 10")) && !few(notes(1e-4, "cells = 10\ncfl = 1e-3\nscheme = \"muscl\"")));
    let step = 1.0 / Scene::parse("bar.toml", "[bar]\nlength = 1\nmaterial = \"mild-steel\"\n[left]\nkind = \"free\"\n[right]\nkind = \"free\"\n[solve]\nuntil = 1", Path::new("."), &[]).expect("a scene").bar.segments[0].material.c0();
    assert!(notes(step / 10.0, "cells = 10").contains("is 1 time step after the start"));
}

fn peak(end: &Trace) -> f64 {
    end.stress.iter().fold(0.0, |peak: f64, stress| peak.max(-stress))
}

/// Above the critical velocity, and with internal damping, the first row has the stress after the first step.
#[test]
fn the_first_row_of_an_end_that_flows_at_once_is_not_zero() {
    for extra in ["", "[effects]\ndamping = { internal = 1e3 }\nhardening = \"isotropic\""] {
        let [end, _] = solve("kind = \"velocity\"\nvalue = 400", "kind = \"free\"", 0.0, 0.3, extra).ends;
        assert!(end.time[0] == 0.0 && end.velocity[0] == 400.0 && end.stress[0] < -4e8, "{extra}: {:?}", end.stress[0]);
    }
}

#[test]
fn the_first_row_is_the_state_just_after_the_start() {
    for (left, velocity) in [
        ("kind = \"velocity\"\nvalue = 8", 0.0),
        ("kind = \"velocity\"\nvalue = 30", 0.0),
        ("kind = \"velocity\"\nhistory = [[0, 30], [50e-6, 0]]", 0.0),
        ("kind = \"velocity\"\nhistory = [[0, 0], [50e-6, 8]]", 0.0),
        ("kind = \"stress\"\nvalue = -2e8", 0.0),
        ("kind = \"stress\"\nvalue = -5e8", 0.0),
        ("kind = \"striker\"\nmass = 0.3\nvelocity = 8", 0.0),
        ("kind = \"striker\"\nmass = 0.3\nvelocity = 30", 0.0),
        ("kind = \"fixed\"", -8.0),
        ("kind = \"wall\"\ngap = 0", -8.0),
        ("kind = \"wall\"\ngap = 1e-4", -8.0),
        ("kind = \"dashpot\"\ncoefficient = 2000", -8.0),
        ("kind = \"spring\"\nstiffness = 1e7", -8.0),
        ("kind = \"free\"", -8.0),
        ("kind = \"absorbing\"", -8.0),
    ] {
        let first = methods(50).map(|(name, method)| {
            let yields = left.contains("30") || left.contains("5e8");
            let [end, _] = solve(left, "kind = \"free\"", velocity, 0.3, &method).ends;
            // Overstress, and the steps that front tracking makes of ramps, give other values.
            let same = !(yields && name == "net" || left.contains("[0, 0]") && name == "front tracking");
            (name, same, end.time[0], end.stress[0], end.velocity[0])
        });
        let (.., stress, velocity) = first[0];
        for (name, _, time, s, v) in first.into_iter().filter(|row| row.1) {
            let apart = (s - stress).abs() / IMPEDANCE + (v - velocity).abs();
            assert!(
                time == 0.0 && apart < 1e-6 * 30.0,
                "{left} by {name}: {s:e} Pa, {v} m/s; leapfrog {stress:e}, {velocity}"
            );
        }
    }
}

/// Returns the largest forces at both ends of a rod with a fixed end struck by a rigid mass, relative to rho c v A.
fn peaks(mass: f64, method: &str) -> [f64; 2] {
    let striker = format!("kind = \"striker\"\nmass = {}\nvelocity = 1", mass * 0.78);
    solve(&striker, "kind = \"fixed\"", 0.0, 10.0, method).ends.map(|end| peak(&end) / IMPEDANCE)
}

#[test]
fn peak_forces_under_a_striker_are_of_second_order() {
    let table = include_str!("../data/mass_on_rod_fixed.csv");
    for row in table.lines().filter(|line| line.starts_with(|c: char| c.is_ascii_digit())) {
        let numbers: Vec<f64> = row.split(',').map(|n| n.parse().expect("a number")).collect();
        let expected = [numbers[2], numbers[3]];
        let error = |cells: usize, k: usize| {
            let found = peaks(numbers[0], &methods(cells)[k].1);
            (0..2).map(|end| (found[end] / expected[end] - 1.0).abs()).fold(0.0, f64::max)
        };
        for k in 0..3 {
            let [coarse, fine] = [50, 800].map(|cells| error(cells, k));
            // The table has six digits.
            assert!(fine < 1e-5, "{row}: {} {fine:e}", methods(800)[k].0);
            assert!(coarse < 200.0 * (fine + 1e-5), "{row}: {} {coarse:e} {fine:e}", methods(50)[k].0);
        }
    }
}

/// A striker of a quarter of the mass of the rod: the force is 2 + exp(-8) at the struck end, where its first wave returns, and 2 + 2 exp(-8)
/// at the fixed end. Both sides of a jump are of third order, the waves in the bar of second order.
#[test]
fn peak_forces_under_a_light_striker_are_exact_to_five_digits() {
    let expected = [2.0 + (-8.0_f64).exp(), 2.0 + 2.0 * (-8.0_f64).exp()];
    for (name, method) in methods(800).into_iter().take(3) {
        let found = peaks(0.25, &method);
        for (end, (found, expected)) in found.into_iter().zip(expected).enumerate() {
            assert!((found / expected - 1.0).abs() < 1e-5, "{name}, end {end}: {found} for {expected}");
        }
    }
}

#[test]
fn nothing_pulls_at_an_end_that_is_struck_again() {
    for mass in [0.25, 1.0, 3.0] {
        for (name, method) in methods(100) {
            let striker = format!("kind = \"striker\"\nmass = {}\nvelocity = 1", mass * 0.78);
            let [left, _] = solve(&striker, "kind = \"fixed\"", 0.0, 10.0, &method).ends;
            let most = left.stress.iter().fold(0.0, |most: f64, stress| most.max(*stress));
            assert!(most < 1e-9 * IMPEDANCE, "{name}, mass {mass}: {most} Pa");
        }
    }
}

#[test]
fn a_front_that_arrives_has_two_rows() {
    for (name, method) in methods(100).into_iter().take(3) {
        let [left, right] = solve("kind = \"velocity\"\nvalue = 3", "kind = \"fixed\"", 0.0, 2.5, &method).ends;
        for (end, at, sides) in [(&left, 2.0, [1.0, 3.0]), (&right, 1.0, [0.0, 2.0])] {
            let k = end.time.windows(2).position(|pair| pair[0] == pair[1]).expect("a jump");
            assert!((end.time[k] * SPEED - at).abs() < 1e-9, "{name}: {}", end.time[k] * SPEED);
            for (row, expected) in [(k, sides[0]), (k + 1, sides[1])] {
                let stress = -end.stress[row] / (3.0 * IMPEDANCE);
                assert!((stress - expected).abs() < 1e-9, "{name}: {stress} for {expected}");
            }
            assert_eq!(end.time.len(), 252, "{name}: no other time comes twice");
        }
    }
}
