//! What effects cost a grid: nanoseconds of stepping for a cell and a step, off and on. Nothing is asserted: times depend on
//! the machine. `cargo bench --bench effects` runs it.

use std::path::Path;
use std::time::Instant;

use barwave::assemble;
use barwave::scene::Scene;

const RUNS: usize = 7;
const CELLS: usize = 10_000;

/// Effects by name, as lines under `[effects]`; the first is none.
const EFFECTS: &[(&str, &str)] = &[
    ("off", ""),
    ("lateral inertia", "lateral-inertia = true"),
    ("internal damping", "damping = { internal = 2e4 }"),
    ("external damping", "damping = { external = 1e3 }"),
    ("foundation", "damping = { foundation = 1e6 }"),
    ("all of these", "lateral-inertia = true\ndamping = { internal = 2e4, external = 1e3, foundation = 1e6 }"),
];

fn scene(velocity: f64, effects: &str) -> Scene {
    let text = format!(
        "[bar]\nlength = 1\narea = 1e-4\n[bar.material]\nname = \"bench\"\ndensity = 7800\nmodulus = 200e9\npoisson = 0.3\n\
         beyond = \"extend\"\ncurve = {{ table = [[0.001, 200e6], [1, 20179.8e6]] }}\n[left]\nkind = \"velocity\"\n\
         value = {velocity:?}\n[right]\nkind = \"fixed\"\n[effects]\nunloading = \"isotropic\"\n{effects}\n[solve]\n\
         until = 1.58e-4\ncells = {CELLS}\n"
    );
    Scene::parse("bench", &text, Path::new("."), &[]).unwrap_or_else(|error| panic!("{error}"))
}

/// Shortest of some runs over 0.8 of the elastic wave's way through the bar, ns.
fn shortest(scene: &Scene) -> f64 {
    let steps = CELLS * 4 / 5;
    let run = |_| {
        let mut bar = assemble::leapfrog(scene, CELLS, 1.0);
        let start = Instant::now();
        for _ in 0..steps {
            bar.advance();
        }
        start.elapsed().as_secs_f64() * 1e9 / (CELLS * steps) as f64
    };
    (0..RUNS).map(run).fold(f64::INFINITY, f64::min)
}

fn main() {
    // `cargo test --benches` only wants to know that this starts.
    if !std::env::args().any(|argument| argument == "--bench") {
        return;
    }
    println!("ns for a cell and a step at {CELLS} cells; shortest of {RUNS} runs");
    println!("{:<20}{:>10}{:>10}", "effect", "elastic", "bilinear");
    for (name, effects) in EFFECTS {
        let ns = [-4.0, -20.0].map(|velocity| shortest(&scene(velocity, effects)));
        println!("{name:<20}{:>10.2}{:>10.2}", ns[0], ns[1]);
    }
}
