//! scratch
use barwave::{assemble, scene::Scene, solver::fd::Quantity};
fn main() {
    let args: Vec<String> = std::env::args().collect();
    let cells = 10000;
    let scene = Scene::read(args[1].as_ref(), &[format!("solve.cells={cells}")]).unwrap();
    let mut bar = assemble::leapfrog(&scene, cells, 1.0);
    let steps = (scene.solve.until / bar.grid().dt - 1e-9).ceil() as usize;
    for k in 1..=4 {
        bar.advance_by(steps * k / 4 - bar.step() - 1);
        let read = |b: &barwave::solver::fd::Leapfrog, q| {
            let mut o = vec![0.0; cells];
            b.profile(q, &mut o);
            o
        };
        let (p0, s0) = (read(&bar, Quantity::AccumulatedPlasticStrain), read(&bar, Quantity::Stress));
        bar.advance_by(1);
        let (p1, s1) = (read(&bar, Quantity::AccumulatedPlasticStrain), read(&bar, Quantity::Stress));
        let count = |tol: f64| {
            p0.chunks(64).zip(p1.chunks(64)).filter(|(a, b)| a.iter().zip(*b).any(|(a, b)| (b - a).abs() > tol)).count()
        };
        let moves = |tol: f64| {
            s0.chunks(64)
                .zip(s1.chunks(64))
                .filter(|(a, b)| a.iter().zip(*b).any(|(a, b)| (b - a).abs() > tol * 2e8))
                .count()
        };
        println!(
            "k {k}: chunks flowing >0: {} >1e-18: {} >1e-17: {}, >1e-16 {} >1e-15 {} >1e-14 {} >1e-12 {} >1e-9 {}; stress moving >0 {} >1e-15 {} >1e-13 {} >1e-11 {} >1e-9 {}",
            count(0.0),
            count(1e-18),
            count(1e-17),
            count(1e-16),
            count(1e-15),
            count(1e-14),
            count(1e-12),
            count(1e-9),
            moves(0.0),
            moves(1e-15),
            moves(1e-13),
            moves(1e-11),
            moves(1e-9)
        );
    }
}
