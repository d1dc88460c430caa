//! Rate-dependent bars that are stressed, or have yielded, at t = 0, with the characteristic net and with leapfrog.

use super::methods::{By, follow};
use super::{E, HARDENING, IMPEDANCE, YIELD, material, scene, text};

/// Transit time of an elastic wave through the bar, s.
const TRANSIT: f64 = 2e-4;

#[test]
fn the_front_in_a_rate_dependent_bar_decays_to_the_raised_yield_stress() {
    // Overstress above the static curve behind the front: x exp(-k t/2) (Malvern 1951).
    let (sigma, plastic, k, velocity, time) = (-50e6, -0.004_f64, 5e4, 15.0, 0.4 * TRANSIT);
    let limit = YIELD + HARDENING / (1.0 - HARDENING / E) * plastic.abs();
    let struck = IMPEDANCE * velocity - sigma;
    let exact = -(limit + (struck - limit) * (-0.5 * k * time).exp());
    let errors = [100, 200, 400].map(|cells| {
        let rate = format!(", rate.malvern = {{ k = {k} }}");
        let state = format!("material = {}\nstress = {sigma}\nplastic-strain = {plastic}", material(YIELD, &rate));
        let drive = format!("kind = \"velocity\"\nvalue = {velocity}");
        let effects = "hardening = \"isotropic\"\nrate = \"material\"";
        let text = text(&[(1.0, state)], [&drive, "kind = \"fixed\""], effects, &By::Net.solve(time, cells));
        let seen = follow(&scene(&text), time);
        assert!(seen.ledger.worst_energy() < 1e-12, "{:?}", seen.ledger);
        let front = (0.4 * cells as f64).round() as usize;
        // Ahead of the front, the bar has its initial state.
        assert!(seen.plastic[front..].iter().all(|p| *p == plastic));
        let to_front = 1.5 * seen.stress[front - 1] - 0.5 * seen.stress[front - 2];
        ((to_front - exact) / exact).abs()
    });
    let order = (errors[0] / errors[2]).log2() / 2.0;
    assert!(errors[2] < 1e-4 && order > 1.8, "{errors:?} {order}");
}

/// Returns the mean differences of stress and plastic strain between the net and leapfrog, for a bar of three segments with Malvern's law.
fn net_and_leapfrog(hardening: &str, cells: usize) -> [f64; 2] {
    let segment = |length: f64, state: &str| {
        (length, format!("material = {}\n{state}", material(YIELD, ", rate.malvern = { k = 1e5 }")))
    };
    let segments = [
        segment(0.3, "stress = 1.2e8\nplastic-strain = 0.003\nvelocity = 8"),
        segment(0.4, "stress = -1.9e8\nvelocity = -4"),
        segment(0.3, "stress = -2.3e8\nplastic-strain = -0.003\nvelocity = -14"),
    ];
    let effects = format!("hardening = {hardening}\nrate = \"material\"");
    let ends = ["kind = \"velocity\"\nvalue = 25", "kind = \"spring\"\nstiffness = 1e7"];
    let [net, leapfrog] = [By::Net, By::Leapfrog].map(|by| {
        let seen = follow(&scene(&text(&segments, ends, &effects, &by.solve(2.0 * TRANSIT, cells))), 1.3 * TRANSIT);
        assert!(seen.ledger.worst_energy() < 1e-12, "{by:?}: {:?}", seen.ledger);
        seen
    });
    assert!((net.time - leapfrog.time).abs() < 1e-9 * TRANSIT);
    // Every segment yields.
    for (third, start) in [(0.15, 0.003), (0.5, 0.0), (0.85, -0.003)] {
        let near = net.x.iter().zip(&net.plastic).filter(|(x, _)| (*x - third).abs() < 0.15);
        let most = near.map(|(_, p)| (p - start).abs()).fold(0.0, f64::max);
        assert!(most > 1e-5, "{hardening} {third}: {most:e}");
    }
    let mean = |a: &[f64], b: &[f64], scale: f64| {
        a.iter().zip(b).map(|(a, b)| (a - b).abs() / scale).sum::<f64>() / cells as f64
    };
    [mean(&net.stress, &leapfrog.stress, YIELD), mean(&net.plastic, &leapfrog.plastic, 0.001)]
}

#[test]
fn the_net_and_leapfrog_come_to_one_bar() {
    for hardening in ["\"isotropic\"", "\"kinematic\"", "{ mixed = 0.4 }"] {
        let apart = [100, 200, 400].map(|cells| net_and_leapfrog(hardening, cells));
        for k in 0..2 {
            let order = (apart[0][k] / apart[2][k]).log2() / 2.0;
            assert!(apart[2][k] < 0.01 && order > 0.8, "{hardening}: {apart:?} {order}");
        }
    }
}
