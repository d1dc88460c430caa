//! scratch
use barwave::{assemble, scene::Scene};
fn cpu() -> f64 {
    std::fs::read_to_string("/proc/self/schedstat").unwrap().split(' ').next().unwrap().parse::<f64>().unwrap() * 1e-9
}
fn main() {
    let args: Vec<String> = std::env::args().collect();
    let (file, cells, rounds) = (&args[1], args[2].parse::<usize>().unwrap(), args[3].parse::<usize>().unwrap());
    let scene = Scene::read(file.as_ref(), &[format!("solve.cells={cells}")]).unwrap();
    let (mut best, mut steps) = (f64::INFINITY, 0);
    for _ in 0..rounds {
        let mut bar = assemble::leapfrog(&scene, cells, 1.0);
        steps = (scene.solve.until / bar.grid().dt - 1e-9).ceil() as usize;
        let t = cpu();
        bar.advance_by(steps);
        best = best.min(cpu() - t);
    }
    println!("{file} {cells}: {best:.6} s, {:.3} ns per cell-step", best / (cells * steps) as f64 * 1e9);
}
