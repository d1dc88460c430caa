//! Scenes that need certain effects, and the choice of `effects = "auto"` for them.
//!
//! The correct choice is found by brute force: each scene is simulated with the chosen effects, and again with every single effect switched. The
//! change of the stress, measured as in the audit (largest L1 norm over the bar at any time, relative to the largest L1 norm of the stress), must
//! be above the tolerance for every effect that is on, and below it for every effect that is off.

use std::ops::ControlFlow;
use std::path::Path;

use barwave::assemble;
use barwave::record::{AutoChoice, Stepped};
use barwave::run::{self};
use barwave::scene::Scene;
use barwave::solver::fd::Quantity;

/// Effects that `auto` can choose, as written in a scene.
const WRITTEN: [(&str, &str); 5] = [
    ("hardening", "\"isotropic\""),
    ("rate", "\"material\""),
    ("heat", "{}"),
    ("rupture", "\"critical-strain\""),
    ("lateral-inertia", "true"),
];

/// Number of times at which stresses are compared.
const MOMENTS: usize = 100;

/// Number of cells of the runs that are compared.
const CELLS: usize = 400;

fn read(name: &str, overrides: &[String]) -> barwave::error::Result<Scene> {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/auto").join(name).with_extension("toml");
    Scene::read(&file, overrides)
}

/// Returns the stress of every cell at every time, on the grid with these effects, or `None` if they cannot be simulated.
fn answer(name: &str, effects: &[&str]) -> Option<Vec<Vec<f64>>> {
    let written: Vec<String> = WRITTEN
        .iter()
        .filter(|(key, _)| effects.contains(key))
        .map(|(key, value)| format!("{key} = {value}"))
        .collect();
    let effects = format!("effects={{ {} }}", written.join(", "));
    let scene = read(name, &[effects, "solve.method=fd".to_owned(), format!("solve.cells={CELLS}")]).ok()?;
    let mut bar = assemble::leapfrog(&scene, CELLS, 1.0);
    let steps = bar.grid().steps_to(scene.solve.until);
    let mut moments = Vec::new();
    for step in 1..=steps {
        bar.advance();
        if step * MOMENTS / steps > (step - 1) * MOMENTS / steps {
            let mut stress = vec![0.0; bar.grid().cells()];
            Stepped::profile(&bar, Quantity::Stress, &mut stress);
            moments.push(stress);
        }
    }
    Some(moments)
}

fn change(one: &[Vec<f64>], other: &[Vec<f64>]) -> f64 {
    let largest = |of: &dyn Fn(usize, usize) -> f64| {
        (0..one.len()).map(|t| (0..one[t].len()).map(|k| of(t, k)).sum::<f64>()).fold(0.0, f64::max)
    };
    let size = largest(&|t, k| one[t][k].abs()).max(largest(&|t, k| other[t][k].abs()));
    largest(&|t, k| (one[t][k] - other[t][k]).abs()) / size
}

/// Runs a scene with `auto` and compares its choice with the brute-force one and with `expected`.
fn check(name: &str, expected: &[&str]) {
    let scene = read(name, &[]).expect("a scene");
    let summary = run::run(&scene, None, &mut |_| ControlFlow::Continue(())).expect("it runs");
    let choices: Vec<AutoChoice> = summary.auto.clone().expect("auto");
    // An effect that another one requires is on, too.
    let on: Vec<&str> = WRITTEN
        .iter()
        .map(|(key, _)| *key)
        .filter(|key| summary.effects.iter().any(|e| e.split(':').next() == Some(key)))
        .collect();
    let tolerance = scene.solve.audit_tolerance;
    let chosen = answer(name, &on).expect("what auto chose can be simulated");
    let mut wrong = Vec::new();
    for (key, _) in WRITTEN {
        let others: Vec<&str> = on.iter().copied().filter(|k| *k != key).collect();
        let is_on = on.contains(&key);
        // Rate and heat require hardening; a run without it is a different problem.
        if key == "hardening" && others.iter().any(|k| ["rate", "heat"].contains(k)) {
            continue;
        }
        let with: Vec<&str> = if is_on { others.clone() } else { on.iter().copied().chain([key]).collect() };
        let Some(other) = answer(name, &with) else { continue };
        let true_change = change(&chosen, &other);
        let estimate = choices
            .iter()
            .find(|c| c.effect == key)
            .map(|c| c.estimate)
            .or_else(|| summary.audit.iter().find(|row| row.effect == key).map(|row| row.estimate));
        println!(
            "| {name} | {key} | {} | {:.4} | {true_change:.4} |",
            if is_on { "on" } else { "off" },
            estimate.unwrap_or(f64::NAN)
        );
        if is_on != (true_change > tolerance) {
            wrong.push(format!("{key} is {} and changes {true_change:.4}", if is_on { "on" } else { "off" }));
        }
    }
    assert!(wrong.is_empty(), "{name}: {wrong:?}; {choices:?}");
    assert_eq!(on, expected, "{name}: {choices:?}");
}

/// Returns the choices for a scene with overrides, and the method that was used.
fn choices(name: &str, overrides: &[&str]) -> (Vec<AutoChoice>, [String; 2]) {
    let overrides: Vec<String> = overrides.iter().map(|&o| o.to_owned()).collect();
    let scene = read(name, &overrides).expect("a scene");
    let summary = run::run(&scene, None, &mut |_| ControlFlow::Continue(())).expect("it runs");
    (summary.auto.expect("auto"), [summary.method, summary.scheme])
}

#[test]
fn of_effects_that_do_not_go_together_the_larger_is_simulated() {
    // Rupture of a bar with lateral inertia cannot be simulated.
    let (all, _) = choices("rupture", &["bar.diameter=40 mm", "bar.material.poisson=0.3"]);
    let of = |effect: &str| all.iter().find(|c| c.effect == effect).unwrap_or_else(|| panic!("{effect}: {all:?}"));
    let (rupture, lateral) = (of("rupture"), of("lateral-inertia"));
    assert!(rupture.on && !lateral.on && rupture.estimate > lateral.estimate, "{all:?}");
    assert!(lateral.why.contains("cannot be simulated here"), "{}", lateral.why);
}

#[test]
fn what_the_estimate_missed_the_audit_of_the_run_adds() {
    let (all, _) = choices("missed-at-first", &[]);
    let [unloading] = &all[..] else { panic!("{all:?}") };
    assert!(unloading.effect == "hardening" && unloading.on && unloading.round == 1, "{unloading:?}");
    assert!(unloading.estimate > 0.01, "{unloading:?}");
}

/// A scene that records plastic strains turns the effect on; it is not refused with the advice to name the effect.
#[test]
fn a_field_that_is_recorded_turns_its_effect_on() {
    let record = "record.fields=[\"stress\", \"plastic_strain\"]";
    let (all, _) = choices("lateral", &[record]);
    let first = &all[0];
    assert!(first.effect == "hardening" && first.on && first.round == 0, "{all:?}");
    assert_eq!(first.why, "`plastic_strain` is recorded");
    assert!(all.iter().any(|choice| choice.effect == "lateral-inertia" && choice.on), "{all:?}");
    // Missing material data are reported as for a scene that names the effect.
    let scene = read("released", &["record.fields=[\"temperature\"]".to_owned()]).expect("a scene");
    let refusal = run::choose(&scene, &mut |_| ControlFlow::Continue(())).expect_err("no constants of heat");
    assert!(refusal.to_string().contains("heat"), "{refusal}");
}

#[test]
fn a_method_that_the_scene_names_stays() {
    let moc = ["solve.method=moc", "solve.cells=", "solve.front-tolerance=0.01"];
    let (released, method) = choices("released", &moc);
    assert_eq!((released.len(), method), (1, ["moc".to_owned(), "front-tracking".to_owned()]), "{released:?}");
    // The characteristic net of a rate-dependent bar has no front tolerance.
    let (rate, method) = choices("rate", &moc);
    assert!(rate.iter().any(|c| c.effect == "rate" && c.on), "{rate:?}");
    assert_eq!(method, ["moc", "characteristic-net"]);
    // Lateral inertia requires the grid.
    let (lateral, method) = choices("lateral", &["solve.method=moc", "solve.cells="]);
    assert!(lateral.iter().any(|c| c.effect == "lateral-inertia" && !c.on), "{lateral:?}");
    assert_eq!(method, ["moc", "front-tracking"]);
}

#[test]
fn a_scene_with_its_choice_written_out_is_the_same_run() {
    let scene = read("rate", &[]).expect("a scene");
    let chosen = run::choose(&scene, &mut |_| ControlFlow::Continue(())).expect("a choice");
    let written = read("rate", &["effects={ rate = \"material\" }".to_owned()]).expect("a scene");
    assert_eq!((&chosen.effects, &chosen.solve), (&written.effects, &written.solve));
    let resolved = chosen.resolved_json();
    assert_eq!(resolved["effects"], written.resolved_json()["effects"]);
    assert_eq!(resolved["auto"][0]["effect"], "rate");
    // The effects of a scene that names them are not changed.
    assert!(run::choose(&written, &mut |_| ControlFlow::Continue(())).expect("a choice").auto.is_none());
}

macro_rules! scenes {
    ($($test:ident: $name:literal => [$($effect:literal),*];)*) => {
        $(#[test] fn $test() { check($name, &[$($effect),*]); })*
    };
}

scenes! {
    elastic: "elastic" => [];
    loaded_once: "loaded-once" => [];
    released: "released" => ["hardening"];
    late_reflection: "late-reflection" => ["hardening"];
    two_materials: "two-materials" => ["hardening"];
    rate: "rate" => ["hardening", "rate"];
    rate_too_quick: "rate-too-quick" => [];
    heat: "heat" => ["hardening", "heat"];
    heat_too_little: "heat-too-little" => [];
    rate_and_heat: "rate-and-heat" => ["hardening", "rate", "heat"];
    rate_ahead_of_the_plastic_wave: "rate-ahead-of-the-plastic-wave" => ["hardening", "rate"];
    heat_after_release: "heat-after-release" => ["hardening", "rate", "heat"];
    rupture: "rupture" => ["hardening", "rupture"];
    lateral: "lateral" => ["lateral-inertia"];
    thin: "thin" => [];
}
