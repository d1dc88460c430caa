//! Compares rate-dependent bars on the grid and on the characteristic net with leapfrog without rate dependence: stepping time in nanoseconds
//! per cell and step. Nothing is asserted: times depend on the machine. `cargo bench --bench net` runs it.

use std::path::Path;
use std::time::Instant;

use barwave::assemble;
use barwave::record::Stepped;
use barwave::scene::Scene;

const RUNS: usize = 7;

fn scene(velocity: f64, knots: usize, rate: &str, cells: usize) -> Scene {
    let knot = |k: usize| {
        let ratio = 50.0_f64.powf(k as f64 / (knots - 1) as f64);
        [0.001 * ratio, 200e6 * ratio.powf(0.2)]
    };
    let table: Vec<[f64; 2]> = (0..knots).map(knot).collect();
    let text = format!(
        "[bar]\nlength = 1\n[bar.material]\nname = \"bench\"\ndensity = 7800\nmodulus = 200e9\nbeyond = \"extend\"\n\
         curve = {{ table = {table:?} }}\n[left]\nkind = \"velocity\"\nvalue = {velocity:?}\n[right]\nkind = \"fixed\"\n\
         [effects]\nhardening = \"isotropic\"\n{rate}\n[solve]\nuntil = 1.58e-4\ncells = {cells}\n"
    );
    Scene::parse("bench", &text, Path::new("."), &[]).unwrap_or_else(|error| panic!("{error}"))
}

/// Returns the shortest stepping time of several runs over 0.8 of the elastic wave's transit time, ns per cell and step.
fn shortest(cells: usize, mut run: impl FnMut() -> f64) -> f64 {
    let steps = 0.8 * cells as f64;
    (0..RUNS).map(|_| run() * 1e9 / (cells as f64 * steps)).fold(f64::INFINITY, f64::min)
}

fn seconds(mut bar: impl Stepped, steps: usize) -> f64 {
    let start = Instant::now();
    bar.advance_by(steps);
    start.elapsed().as_secs_f64()
}

fn main() {
    // `cargo test --benches` only checks that this program starts.
    if !std::env::args().any(|argument| argument == "--bench") {
        return;
    }
    println!("ns for a cell and a step; shortest of {RUNS} runs");
    println!("{:<24}{:>8}{:>12}{:>14}{:>12}", "bar", "cells", "leapfrog", "with rate", "net");
    for (name, velocity, knots, rate) in [
        ("elastic", 4.0, 2, "rate = { model = \"malvern\", k = 1e5 }"),
        ("2 lines, malvern", 20.0, 2, "rate = { model = \"malvern\", k = 1e5 }"),
        ("60 lines, malvern", 20.0, 60, "rate = { model = \"malvern\", k = 1e5 }"),
        ("60 lines, cowper-symonds", 20.0, 60, "rate = { model = \"cowper-symonds\", D = 40, q = 5 }"),
        ("60 lines, johnson-cook", 20.0, 60, "rate = { model = \"johnson-cook\", C = 0.014, reference = 1 }"),
    ] {
        for cells in [1000, 10_000] {
            let steps = cells * 4 / 5;
            let plain = scene(velocity, knots, "", cells);
            let leapfrog = shortest(cells, || seconds(assemble::leapfrog(&plain, cells, 1.0), steps));
            let late = scene(velocity, knots, rate, cells);
            let on_grid = shortest(cells, || seconds(assemble::leapfrog(&late, cells, 1.0), steps));
            let net = shortest(cells, || seconds(assemble::characteristic_net(&late, cells), steps));
            println!("{name:<24}{cells:>8}{leapfrog:>12.3}{on_grid:>14.3}{net:>12.3}");
        }
    }
}
