//! Time per cell and step, and memory per cell, from 10^2 to 10^7 cells with leapfrog on one and on two threads, with the memory bandwidth of the
//! machine for comparison.
//!
//! `cargo run --release --example growth > docs/growth.csv`; `python3 docs/growth.py` draws it. Free bars start with sinusoidal velocities of 125
//! cells per wave, so that every cell is active: an elastic bar, and a bilinear one with isotropic hardening in which all cells yield except those at
//! the nodes of the waves. Times are medians. Bytes per cell are the growth of the process's memory (Linux only; none below 10^5 cells, where it
//! is not measurable). The bandwidth is that of a triad `a = b + s c` on arrays of 160 MB, counting three numbers per element.

use std::path::Path;
use std::time::Instant;

use barwave::assemble;
use barwave::scene::Scene;
use rayon::prelude::*;

const SIZES: [usize; 11] = [100, 316, 1000, 3162, 10_000, 31_623, 100_000, 316_228, 1_000_000, 3_162_278, 10_000_000];
const THREADS: [usize; 2] = [1, 2];
/// Number of cell-steps of one measurement, and its smallest number of steps: as many as a long bar advances in one pass through the cache.
const WORK: usize = 30_000_000;
const LEAST_STEPS: usize = 32;
const ROUNDS: usize = 9;
const CELLS_A_WAVE: f64 = 125.0;
const TRIAD: usize = 20_000_000;
const BILINEAR: &str = "{ table = [[1e-3, 200e6], [21e-3, 600e6]] }";
const ELASTIC: &str = "{ table = [[0.1, 20e9]] }";

fn scene(curve: &str, cells: usize) -> Scene {
    let effects = if curve == BILINEAR { "[effects]\nhardening = \"isotropic\"" } else { "" };
    let text = format!(
        "[bar]\nlength = 1\n[bar.material]\ndensity = 7800\nmodulus = 200e9\nbeyond = \"extend\"\ncurve = {curve}\n\
         [left]\nkind = \"free\"\n[right]\nkind = \"free\"\n{effects}\n[solve]\nuntil = 1\ncells = {cells}\n"
    );
    Scene::parse("growth", &text, Path::new("."), &[]).unwrap_or_else(|error| panic!("{error}"))
}

/// Returns the memory of the process, bytes; `None` except on Linux.
fn memory() -> Option<f64> {
    let text = std::fs::read_to_string("/proc/self/statm").ok()?;
    let pages: f64 = text.split_whitespace().nth(1)?.parse().ok()?;
    Some(4096.0 * pages)
}

fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values[values.len() / 2]
}

/// Returns the time per cell and step, ns, and the memory per cell, bytes.
fn cell_step(curve: &str, cells: usize, threads: usize) -> (f64, Option<f64>) {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
    let scene = scene(curve, cells);
    let steps = (WORK / cells).max(LEAST_STEPS);
    let waves = (cells as f64 / CELLS_A_WAVE).max(1.0).round();
    pool.install(|| {
        let before = memory();
        let mut bytes = None;
        let once = || {
            let velocity = |x: f64| 20.0 * (2.0 * std::f64::consts::PI * waves * x).sin();
            let mut bar = assemble::leapfrog(&scene, cells, 1.0).moving(velocity);
            bar.advance_by(LEAST_STEPS);
            let start = Instant::now();
            bar.advance_by(steps);
            let time = start.elapsed().as_secs_f64();
            bytes = bytes.or_else(|| Some((memory()? - before?) / cells as f64));
            1e9 * time / (cells * steps) as f64
        };
        let time = median(std::iter::repeat_with(once).take(ROUNDS).collect());
        (time, bytes.filter(|_| cells >= 100_000))
    })
}

/// Returns the memory bandwidth, bytes per second.
fn bandwidth(threads: usize) -> f64 {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
    pool.install(|| {
        let (mut a, b, c) = (vec![0.0; TRIAD], vec![1.0; TRIAD], vec![2.0; TRIAD]);
        let once = || {
            let start = Instant::now();
            let part = TRIAD.div_ceil(threads);
            let parts = a.par_chunks_mut(part).zip(b.par_chunks(part)).zip(c.par_chunks(part));
            parts.for_each(|((a, b), c)| {
                for ((a, b), c) in a.iter_mut().zip(b).zip(c) {
                    *a = b + 3.0 * c;
                }
            });
            std::hint::black_box(&a);
            (3 * TRIAD * size_of::<f64>()) as f64 / start.elapsed().as_secs_f64()
        };
        median(std::iter::repeat_with(once).take(ROUNDS).collect())
    })
}

fn main() {
    println!("bar,threads,cells,time of a cell-step (ns),bytes a cell,triad (GB/s)");
    for (name, curve) in [("elastic", ELASTIC), ("bilinear", BILINEAR)] {
        for threads in THREADS {
            let triad = 1e-9 * bandwidth(threads);
            for cells in SIZES {
                let (time, bytes) = cell_step(curve, cells, threads);
                let bytes = bytes.map_or_else(String::new, |bytes| format!("{bytes:.1}"));
                println!("{name},{threads},{cells},{time:.4},{bytes},{triad:.1}");
            }
        }
    }
}
