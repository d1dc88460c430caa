//! Compares the conservative scheme (muscl) with leapfrog: stepping time in nanoseconds per cell and step, and error against the self-similar
//! solution, for the benchmark problems at 0.8 L/c0. Nothing is asserted: times depend on the machine. `cargo bench --bench muscl` runs it.

use std::path::Path;
use std::time::Instant;

use barwave::assemble;
use barwave::bar::initial_fans;
use barwave::record::{Stepped, against_similarity};
use barwave::scene::Scene;

const RUNS: usize = 7;

fn scene(velocity: f64, table: &[[f64; 2]], hardening: &str, cells: usize) -> Scene {
    let text = format!(
        "[bar]\nlength = 1\n[bar.material]\nname = \"bench\"\ndensity = 7800\nmodulus = 200e9\nbeyond = \"extend\"\n\
         curve = {{ table = {table:?} }}\n[left]\nkind = \"velocity\"\nvalue = {velocity:?}\n[right]\nkind = \"free\"\n\
         {hardening}\n[solve]\nuntil = 1.5798734e-4\ncells = {cells}\n"
    );
    Scene::parse("bench", &text, Path::new("."), &[]).unwrap_or_else(|error| panic!("{error}"))
}

/// Returns the shortest stepping time of several runs, ns per cell and step, and the error.
fn measure<S: Stepped>(scene: &Scene, build: impl Fn() -> S) -> (f64, f64) {
    let mut shortest = f64::INFINITY;
    let mut error = f64::NAN;
    for _ in 0..RUNS {
        let mut bar = build();
        let steps = bar.grid().steps_to(scene.solve.until);
        let start = Instant::now();
        bar.advance_by(steps);
        let work = (bar.grid().cells() * steps) as f64;
        shortest = shortest.min(start.elapsed().as_secs_f64() * 1e9 / work);
        let initial_fans = initial_fans(&scene.bar, &scene.left, &scene.right);
        error = against_similarity(&scene.bar, &bar, &initial_fans).map_or(f64::NAN, |figure| figure.value);
    }
    (shortest, error)
}

fn main() {
    // `cargo test --benches` only checks that this program starts.
    if !std::env::args().any(|argument| argument == "--bench") {
        return;
    }
    let power_law: Vec<[f64; 2]> = (0..60)
        .map(|k| 50.0_f64.powf(f64::from(k) / 59.0))
        .map(|ratio| [0.001 * ratio, 200e6 * ratio.powf(0.2)])
        .collect();
    let bilinear = [[0.001, 200e6], [0.021, 600e6]];
    let isotropic = "[effects]\nhardening = \"isotropic\"";
    println!(
        "ns for a cell and a step (shortest of {RUNS} runs); error: relative L1 of stress against the curve's fan"
    );
    println!(
        "{:<26}{:>7}{:>12}{:>10}{:>8}{:>14}{:>12}",
        "problem", "cells", "leapfrog ns", "muscl ns", "ratio", "leapfrog err", "muscl err"
    );
    for (name, velocity, table, hardening) in [
        ("P1 elastic", 10.0, &[[0.01, 2e9]][..], ""),
        ("P2 bilinear", 20.0, &bilinear[..], isotropic),
        ("P2, curve both ways", 20.0, &bilinear[..], ""),
        ("P3, 60 knots", 20.0, &power_law[..], isotropic),
        ("P3, 60 knots, both ways", 20.0, &power_law[..], ""),
    ] {
        for cells in [1000, 10_000] {
            let scene = scene(velocity, table, hardening, cells);
            let (plain, plain_error) = measure(&scene, || assemble::leapfrog(&scene, cells, 1.0));
            let (here, error) = measure(&scene, || assemble::muscl(&scene, cells, 1.0));
            println!(
                "{name:<26}{cells:>7}{plain:>12.2}{here:>10.2}{:>8.1}{plain_error:>14.2e}{error:>12.2e}",
                here / plain
            );
        }
    }
}
