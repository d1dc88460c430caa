//! Stepping times of the three benchmark problems with every method, measured by Criterion: medians with their confidence intervals, and the change
//! since the previous measurement. `against_c` compares them with a program in C.
//!
//! `cargo bench --bench stepping` runs it. Elements are cells times steps; for front tracking, events.

use std::path::Path;

use barwave::assemble;
use barwave::record::Stepped;
use barwave::scene::Scene;
use barwave::solver::moc::Settings;
use criterion::{BatchSize, Bencher, BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};

const CELLS: [usize; 2] = [1000, 4000];

fn scene(name: &str) -> Scene {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("runs").join(name).with_extension("toml");
    Scene::read(&path, &[]).unwrap_or_else(|error| panic!("{error}"))
}

/// Measures whole runs on a grid, without recording.
fn grid<S: Stepped>(bencher: &mut Bencher<'_>, steps: usize, build: impl Fn() -> S) {
    let run = |mut bar: S| {
        bar.advance_by(steps);
        bar
    };
    bencher.iter_batched(&build, run, BatchSize::LargeInput);
}

fn problem(criterion: &mut Criterion, name: &str) {
    let scene = scene(name);
    let mut group = criterion.benchmark_group(name);
    group.sample_size(20);
    for cells in CELLS {
        let steps = assemble::leapfrog(&scene, cells, 1.0).grid().steps_to(scene.solve.until);
        group.throughput(Throughput::Elements((cells * steps) as u64));
        group.bench_with_input(BenchmarkId::new("leapfrog", cells), &cells, |bencher, &cells| {
            grid(bencher, steps, || assemble::leapfrog(&scene, cells, 1.0));
        });
        group.bench_with_input(BenchmarkId::new("muscl", cells), &cells, |bencher, &cells| {
            grid(bencher, steps, || assemble::muscl(&scene, cells, 1.0));
        });
    }
    let track = || {
        let mut bar = assemble::front_tracking(&scene, Settings::default());
        bar.advance_to(scene.solve.until).unwrap_or_else(|stopped| panic!("{stopped}"));
        bar
    };
    group.throughput(Throughput::Elements(track().events()));
    group.bench_function("front tracking", |bencher| bencher.iter(track));
    group.finish();
}

fn problems(criterion: &mut Criterion) {
    for name in ["elastic-check", "bilinear-p2", "power-law-p3"] {
        problem(criterion, name);
    }
}

criterion_group!(benches, problems);
criterion_main!(benches);
