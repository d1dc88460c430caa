//! Functions shared by the benches of effects.

use std::path::Path;
use std::time::Instant;

use barwave::assemble;
use barwave::scene::Scene;

/// Number of cells of the grid.
pub const CELLS: usize = 10_000;

/// Returns a bar of 1 m of bilinear steel whose left end moves; `bar`, `material` and `effects` are further keys, one per line.
pub fn scene(velocity: f64, bar: &str, material: &str, effects: &str) -> Scene {
    let text = format!(
        "[bar]\nlength = 1\n{bar}\n[bar.material]\nname = \"bench\"\ndensity = 7800\nmodulus = 200e9\n{material}\n\
         curve = {{ table = [[0.001, 200e6], [1, 20179.8e6]] }}\n[left]\nkind = \"velocity\"\nvalue = {velocity:?}\n\
         [right]\nkind = \"fixed\"\n[effects]\n{effects}\n[solve]\nuntil = 1.58e-4\nmethod = \"fd\"\ncells = {CELLS}\n"
    );
    Scene::parse("bench", &text, Path::new("."), &[]).unwrap_or_else(|error| panic!("{error}"))
}

/// Returns the shortest stepping time of several runs over 0.8 of the elastic wave's transit time, ns per cell and step.
pub fn shortest(scene: &Scene, runs: usize) -> f64 {
    let steps = CELLS * 4 / 5;
    let run = |_| {
        let mut bar = assemble::leapfrog(scene, CELLS, 1.0);
        let start = Instant::now();
        bar.advance_by(steps);
        start.elapsed().as_secs_f64() * 1e9 / (CELLS * steps) as f64
    };
    (0..runs).map(run).fold(f64::INFINITY, f64::min)
}
