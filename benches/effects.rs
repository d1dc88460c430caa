//! Cost of effects on a grid: stepping time in nanoseconds per cell and step, without and with each effect. Nothing is asserted: times depend on
//! the machine. `cargo bench --bench effects` runs it.

mod common;

use std::time::Instant;

use barwave::assemble;
use barwave::record::{AUDIT_SAMPLES, Audit, Case, Off};
use barwave::solver::fd::Sampling;
use common::{CELLS, scene, shortest};

const RUNS: usize = 3;

/// Effects with their lines under `[effects]`; the first entry has none.
const EFFECTS: &[(&str, &str)] = &[
    ("off", ""),
    ("lateral inertia", "lateral-inertia = true"),
    ("internal damping", "damping = { internal = 2e4 }"),
    ("external damping", "damping = { external = 1e3 }"),
    ("foundation", "damping = { foundation = 1e6 }"),
    ("all of these", "lateral-inertia = true\ndamping = { internal = 2e4, external = 1e3, foundation = 1e6 }"),
    ("heat", "heat = { fraction = 0.9 }"),
    ("rate", "rate = { model = \"malvern\", k = 1e7 }"),
    ("rate and heat", "heat = { fraction = 0.9 }\nrate = { model = \"malvern\", k = 1e7 }"),
    ("Johnson-Cook", "rate = { model = \"johnson-cook\", C = 0.014, reference = 1 }"),
    ("Johnson-Cook, heat", "heat = { fraction = 0.9 }\nrate = { model = \"johnson-cook\", C = 0.014, reference = 1 }"),
    ("Cowper-Symonds", "rate = { model = \"cowper-symonds\", D = 40, q = 5 }"),
    ("kinematic", "hardening = \"kinematic\""),
    ("Armstrong-Frederick", "hardening = { armstrong-frederick = { C = 5e9, gamma = 50 } }"),
    ("kinematic, rate", "hardening = \"kinematic\"\nrate = { model = \"malvern\", k = 1e7 }"),
    (
        "kinematic, JC, heat",
        "hardening = \"kinematic\"\nheat = { fraction = 0.9 }\nrate = { model = \"johnson-cook\", C = 0.014, reference = 1 }",
    ),
];

/// A constant area, and a table of areas.
const UNIFORM: &str = "1e-4";
const TAPERED: &str = "[[0, 1e-4], [1, 1.2e-4]]";

const POISSON_AND_HEAT: &str = "poisson = 0.3\nbeyond = \"extend\"\nheat = { specific-heat = 480, \
                                reference-temperature = 293, melting-temperature = 1800, m = 1 }";

fn of_steel(area: &str, velocity: f64, effects: &str) -> f64 {
    let hardening = if effects.starts_with("hardening") { "" } else { "hardening = \"isotropic\"\n" };
    let effects = format!("{hardening}{effects}");
    shortest(&scene(velocity, &format!("area = {area}"), POISSON_AND_HEAT, &effects), RUNS)
}

/// Returns the time of all evaluations of the audit relative to the stepping time.
fn share_of_audit(cells: usize, rates: &str) -> f64 {
    let scene = scene(-20.0, "", &format!("beyond = \"extend\"\n{rates}"), "");
    let scene = scene.with(&["solve.until=3e-4"]).unwrap_or_else(|e| panic!("{e}"));
    let mut bar = assemble::leapfrog(&scene, cells, 1.0);
    let off = Off { unloading: true, rate: true, heat: true, rupture: true, lateral_inertia: true };
    let (until, ends) = (scene.solve.until, [&scene.left, &scene.right]);
    let mut audit =
        Audit::new(&Case { bar: &scene.bar, ends, until, tolerance: 0.01, off, torsion: false, cells: Some(cells) });
    let places = Sampling::at(bar.grid(), audit.places().to_vec());
    let steps = (until / bar.grid().dt) as usize;
    let (mut stepping, mut looking) = (0.0, 0.0);
    for step in 1..=steps {
        let start = Instant::now();
        bar.advance();
        stepping += start.elapsed().as_secs_f64();
        if step.is_multiple_of(steps / AUDIT_SAMPLES) {
            let start = Instant::now();
            audit.sample(&bar, &places);
            looking += start.elapsed().as_secs_f64();
        }
    }
    looking / stepping
}

fn main() {
    // `cargo test --benches` only checks that this program starts.
    if !std::env::args().any(|argument| argument == "--bench") {
        return;
    }
    println!("ns for a cell and a step at {CELLS} cells; shortest of {RUNS} runs");
    println!("{:<20}{:>10}{:>10}", "effect", "elastic", "bilinear");
    for (name, effects) in EFFECTS {
        let ns = [-4.0, -20.0].map(|velocity| of_steel(UNIFORM, velocity, effects));
        println!("{name:<20}{:>10.2}{:>10.2}", ns[0], ns[1]);
    }
    let ns = [-4.0, -20.0].map(|velocity| of_steel(TAPERED, velocity, ""));
    println!("{:<20}{:>10.2}{:>10.2}", "taper", ns[0], ns[1]);
    println!("\naudit, % of the time of stepping; shortest of {RUNS} runs");
    println!("{:<20}{:>10}{:>10}", "the material states", "1000", "10000");
    let constants = "rate = { johnson-cook = { C = 0.02, reference = 1 } }\nheat = { specific-heat = 460, \
                     reference-temperature = 293, melting-temperature = 1790, m = 1 }";
    for (name, stated) in [("nothing", ""), ("rate and heat", constants)] {
        let share =
            [1000, 10_000].map(|cells| (0..RUNS).map(|_| share_of_audit(cells, stated)).fold(f64::INFINITY, f64::min));
        println!("{name:<20}{:>10.2}{:>10.2}", 100.0 * share[0], 100.0 * share[1]);
    }
}
