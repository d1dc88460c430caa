//! scratch
use barwave::{assemble, scene::Scene};
use std::time::Instant;
fn main() {
    let args: Vec<String> = std::env::args().collect();
    let (file, cells, rounds) = (&args[1], args[2].parse::<usize>().unwrap(), args[3].parse::<usize>().unwrap());
    let scene = Scene::read(file.as_ref(), &[format!("solve.cells={cells}")]).unwrap();
    let (mut best, mut steps) = (f64::INFINITY, 0);
    for _ in 0..rounds {
        let mut bar = assemble::leapfrog(&scene, cells, 1.0);
        steps = (scene.solve.until / bar.grid().dt - 1e-9).ceil() as usize;
        let t = Instant::now();
        bar.advance_by(steps);
        best = best.min(t.elapsed().as_secs_f64());
    }
    println!("{file} {cells}: {best:.6} s, {:.3} ns per cell-step", best / (cells * steps) as f64 * 1e9);
}
