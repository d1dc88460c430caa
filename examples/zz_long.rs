//! scratch
use barwave::{assemble, bar::EndCondition, scene::Scene};
use std::time::Instant;
fn main() {
    let args: Vec<String> = std::env::args().collect();
    let (file, waves, threads, rounds) = (
        &args[1],
        args[2].parse::<f64>().unwrap(),
        args[3].parse::<usize>().unwrap(),
        args[4].parse::<usize>().unwrap(),
    );
    let cells = 1_000_000;
    let mut scene = Scene::read(file.as_ref(), &[format!("solve.cells={cells}")]).unwrap();
    (scene.left, scene.right) = (EndCondition::Free, EndCondition::Free);
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
    pool.install(|| {
        let mut best = f64::INFINITY;
        for _ in 0..rounds {
            let mut bar = assemble::leapfrog(&scene, cells, 1.0)
                .moving(|x| 20.0 * (2.0 * std::f64::consts::PI * waves * x).sin());
            let t = Instant::now();
            bar.advance_by(200);
            best = best.min(t.elapsed().as_secs_f64());
        }
        println!("{file} {waves} waves {threads} threads: {:.3} ns per cell-step", best / (cells * 200) as f64 * 1e9);
    });
}
