//! Exact piecewise-constant solutions of bilinear bars with unloading and reflections, against the leapfrog scheme.
//!
//! The cases (`tests/data/exact_bar_cases.json`) are in units of rho = c0 = E = `sigma_y` = 1; they were computed in
//! rational arithmetic by following every wave front.

use std::sync::Arc;

use barwave::assemble::segment_law;
use barwave::bar::{Bar, EndCondition, History, Joint, Segment};
use barwave::material::{Beyond, Curve, Material};
use barwave::record::Ledger;
use barwave::scene::{Effects, Unloading};
use barwave::solver::fd::{Grid, Leapfrog, Quantity};
use serde::Deserialize;

const CELLS: usize = 2000;

#[derive(Deserialize)]
struct Cases {
    wall: Vec<Case>,
    pulse: Vec<Case>,
    tension: Vec<Case>,
    hardening: Vec<Case>,
}

#[derive(Deserialize)]
struct Case {
    name: String,
    #[serde(rename = "L")]
    length: String,
    r: String,
    #[serde(rename = "V0")]
    velocity: String,
    iso: bool,
    t_final: String,
    momentum: String,
    ep_profile: Vec<[String; 3]>,
    left_history: Vec<[String; 3]>,
    right_history: Vec<[String; 3]>,
    state: Vec<[String; 4]>,
}

/// "-9/8" and the like.
fn number(text: &str) -> f64 {
    let (n, d) = text.split_once('/').unwrap_or((text, "1"));
    n.parse::<f64>().expect("numerator") / d.parse::<f64>().expect("denominator")
}

fn numbers<const N: usize>(row: &[String; N]) -> [f64; N] {
    std::array::from_fn(|k| number(&row[k]))
}

fn bilinear(r: f64) -> Material {
    let rows = [(1.0, 1.0), (2.0, 1.0 + r * r)];
    Material::from_curve("bilinear", 1.0, Curve::new(&rows, Beyond::Extend).expect("rows rise"))
}

fn ends(case: &Case) -> [EndCondition; 2] {
    let velocity = |v: f64, release| EndCondition::Velocity { history: History::constant(v), release };
    let (kind, rest) = case.name.split_once('_').expect("kind_...");
    let strength = |mark: char| number(&rest[rest.rfind(mark).expect("strength") + 1..]);
    match kind {
        "wall" => [EndCondition::Wall { gap: 0.0 }, EndCondition::Free],
        "stresspulse" => {
            let s = -strength('S');
            let rows = [(0.0, s), (1.0, s), (1.0, 0.0)];
            [EndCondition::Stress { history: History::new(&rows).expect("in order") }, EndCondition::Absorbing]
        }
        "velpulse" => [velocity(strength('V'), Some(1.0)), EndCondition::Absorbing],
        "tension" => {
            let far = if rest.starts_with("fixed") { EndCondition::Fixed } else { EndCondition::Free };
            [velocity(-strength('V'), None), far]
        }
        other => panic!("unknown case {other}"),
    }
}

fn bar(case: &Case) -> Leapfrog {
    let segment = Segment {
        length: number(&case.length).min(60.0),
        area: 1.0,
        material: Arc::new(bilinear(number(&case.r))),
        velocity: number(&case.velocity),
        joint: Joint::Bonded,
    };
    let unloading = if case.iso { Unloading::Isotropic } else { Unloading::Kinematic };
    let law = segment_law(&segment, &Effects { unloading: Some(unloading) });
    let bar = Bar { segments: vec![segment], area_given: true };
    let grid = Grid::new(&bar, CELLS, 1.0);
    Leapfrog::new(&bar, grid, vec![law], ends(case))
}

/// Mean and largest deviation from `expected` of the entries of `history` well inside `from..to`.
fn deviation(history: &[(f64, f64)], from: f64, to: f64, expected: f64) -> (f64, f64) {
    let margin = 0.25 * (to - from);
    let inside: Vec<f64> = history.iter().filter(|p| p.0 > from + margin && p.0 < to - margin).map(|p| p.1).collect();
    let mean = inside.iter().sum::<f64>() / inside.len() as f64;
    let worst = inside.iter().map(|v| (v - expected).abs()).fold(0.0, f64::max);
    (mean - expected, worst)
}

fn check(case: &Case) {
    let mut bar = bar(case);
    let end = number(&case.t_final);
    let mut ledger = Ledger::new(&bar);
    let mut sides = [(Vec::new(), Vec::new()), (Vec::new(), Vec::new())];
    while bar.time() < end - 0.5 * bar.grid().dt {
        bar.advance();
        for (side, device) in sides.iter_mut().zip([bar.left(), bar.right()]) {
            side.0.push((bar.time(), device.stress()));
            side.1.push((bar.time(), device.velocity()));
        }
        if bar.step().is_multiple_of(100) {
            ledger.row(&bar);
        }
    }
    println!("{}: {} steps", case.name, bar.step());
    for (label, history, (stress, velocity)) in
        [("left", &case.left_history, &sides[0]), ("right", &case.right_history, &sides[1])]
    {
        for (k, row) in history.iter().enumerate() {
            let [from, s, v] = numbers(row);
            let to = history.get(k + 1).map_or(end, |next| number(&next[0]));
            println!(
                "  {label} {from:.3}..{to:.3} s {s:.3} {:?} v {v:.3} {:?}",
                deviation(stress, from, to, s),
                deviation(velocity, from, to, v)
            );
        }
    }
    let x = bar.grid().centres();
    for row in &case.ep_profile {
        let [from, to, expected] = numbers(row);
        let profile: Vec<(f64, f64)> =
            x.iter().enumerate().map(|(i, &x)| (x, bar.value(Quantity::PlasticStrain, i))).collect();
        println!("  ep {from:.3}..{to:.3} {expected:.3} {:?}", deviation(&profile, from, to, expected));
    }
    for row in &case.state {
        let [from, to, s, v] = numbers(row);
        let profile = |q| -> Vec<(f64, f64)> { x.iter().enumerate().map(|(i, &x)| (x, bar.value(q, i))).collect() };
        println!(
            "  state {from:.3}..{to:.3} {s:.3} {:?} {v:.3} {:?}",
            deviation(&profile(Quantity::Stress), from, to, s),
            deviation(&profile(Quantity::Velocity), from, to, v)
        );
    }
    println!(
        "  momentum {} {}  ledger {:e} {:e}",
        number(&case.momentum),
        bar.energies().momentum,
        ledger.worst_energy(),
        ledger.worst_momentum()
    );
}

#[test]
fn cases() {
    let cases: Cases = serde_json::from_str(include_str!("data/exact_bar_cases.json")).expect("valid file");
    for case in cases.wall.iter().chain(&cases.pulse).chain(&cases.tension).chain(&cases.hardening) {
        check(case);
    }
}

#[test]
fn spikes() {
    let cases: Cases = serde_json::from_str(include_str!("data/exact_bar_cases.json")).expect("valid file");
    for case in cases.wall.iter().chain(&cases.tension).chain(&cases.hardening) {
        println!("{}", case.name);
        let mut bar = bar(case);
        let mut last = 0.0;
        while bar.time() < 8.5 {
            bar.advance();
            if case.name == "wall_r1/2_V3/2" && (bar.step() == 2720 || bar.step() == 2721 || bar.step() == 3000) {
                for i in (1250..1420).step_by(1) {
                    println!(
                        "cell {} {i} s {:.4} v {:.4} ep {:.4}",
                        bar.step(),
                        bar.value(Quantity::Stress, i),
                        bar.value(Quantity::Velocity, i),
                        bar.value(Quantity::PlasticStrain, i)
                    );
                }
            }
            if bar.step().is_multiple_of(250) {
                let q = |i: usize| bar.value(Quantity::Stress, i);
                let odd: f64 =
                    (200..1800).map(|i| (q(i - 1) - 2.0 * q(i) + q(i + 1)).abs() / 4.0).sum::<f64>() / 1600.0;
                if (odd - last).abs() > 1e-4 {
                    println!("{:.3} {odd:.5}", bar.time());
                    last = odd;
                }
            }
        }
    }
}
