//! What the effect `rupture` costs a grid: nanoseconds of stepping for a cell and a step, off and on with a threshold that
//! is never reached. Nothing is asserted: times depend on the machine. `cargo bench --bench rupture` runs it.

use std::path::Path;
use std::time::Instant;

use barwave::assemble;
use barwave::scene::Scene;

const RUNS: usize = 7;
const CELLS: usize = 10_000;

fn scene(velocity: f64, rupture: &str) -> Scene {
    let text = format!(
        "[bar]\nlength = 1\n[bar.material]\nname = \"bench\"\ndensity = 7800\nmodulus = 200e9\nbeyond = \"rupture\"\n\
         curve = {{ table = [[0.001, 200e6], [1, 20179.8e6]] }}\n[left]\nkind = \"velocity\"\nvalue = {velocity:?}\n[right]\n\
         kind = \"fixed\"\n[effects]\nunloading = \"isotropic\"\n{rupture}\n[solve]\nuntil = 1.58e-4\ncells = {CELLS}\n"
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
    println!("{:<10}{:>8}{:>16}{:>10}{:>10}", "bar", "off", "critical-strain", "energy", "spall");
    for (name, velocity) in [("elastic", -4.0), ("bilinear", -20.0)] {
        let ns = ["", "rupture = \"critical-strain\"", "rupture = { energy = 1e12 }", "rupture = { spall = 1e12 }"]
            .map(|rupture| shortest(&scene(velocity, rupture)));
        println!("{name:<10}{:>8.2}{:>16.2}{:>10.2}{:>10.2}", ns[0], ns[1], ns[2], ns[3]);
    }
}
