//! Front tracking at the limit of resolution of positions, times and tolerances.

use std::ops::ControlFlow;
use std::path::Path;

use barwave::run::{self};
use barwave::scene::Scene;
use barwave::solver::moc::{FINEST_STEP, Settings};

/// Returns a bilinear bar whose left end moves according to `history`.
fn scene(history: &str, tolerance: f64) -> Scene {
    let text = format!(
        r#"
[[bar.segment]]
length = "1 m"
area = "1 cm^2"
material = {{ name = "a", density = 7800, modulus = 200e9, beyond = "extend", curve = {{ table = [[0.001, 200e6], [0.021, 600e6]] }} }}
[left]
kind = "velocity"
history = {history}
[right]
kind = "free"
[effects]
hardening = "isotropic"
[solve]
until = "300 us"
method = "moc"
front-tolerance = {tolerance:e}
"#
    );
    Scene::parse("spike.toml", &text, Path::new(""), &[]).unwrap_or_else(|e| panic!("{e}"))
}

#[test]
fn a_velocity_spike_of_any_length_leaves_the_ledger_closed() {
    for length in [1e-8, 1e-10, 1e-12, 1e-14] {
        let half = 0.5 * length;
        let shapes = [
            format!("[[0, 20], [{length:e}, 20], [{length:e}, 0]]"),
            format!("[[0, 0], [{half:e}, 20], [{length:e}, 0]]"),
            format!("[[0, 0], [1e-5, 0], [{}, 20], [{}, 0]]", 1e-5 + half, 1e-5 + length),
            format!("[[0, 20], [1e-4, 20], [{}, 40], [{}, 20]]", 1e-4 + half, 1e-4 + length),
        ];
        for (k, shape) in shapes.iter().enumerate() {
            let summary = run::run(&scene(shape, 1e-3), None, &mut |_| ControlFlow::Continue(()))
                .unwrap_or_else(|e| panic!("{e}"));
            let ledger = &summary.ledger;
            println!("{length:e} s, shape {k}: {ledger:?}, {:?}", summary.error);
            assert_eq!(summary.outcome, "done");
            assert!(ledger.energy_residual <= 1e-10, "{length:e} s, shape {k}: energy {:e}", ledger.energy_residual);
            assert!(
                ledger.momentum_residual <= 1e-10,
                "{length:e} s, shape {k}: momentum {:e}",
                ledger.momentum_residual
            );
        }
    }
}

#[test]
fn a_smaller_front_tolerance_never_takes_coarser_ramps() {
    let step = |front_tolerance| Settings { front_tolerance, ..Settings::default() }.step();
    let tolerances = [0.0, 1e-300, 1e-14, 1e-9, 1e-6, 1e-5, 1e-4, 1e-3, 1e-2, 0.5];
    for pair in tolerances.windows(2) {
        assert!(step(pair[0]) <= step(pair[1]), "{pair:?}");
    }
    assert_eq!(step(0.0), FINEST_STEP);
}

#[test]
fn steps_of_a_ramp_count_as_events_from_the_first_on() {
    let settings = Settings { ramp_step: Some(1e-14), event_budget: 1000, ..Settings::default() };
    let scene = scene("[[0, 0], [1e-4, 5]]", 0.0);
    let before = std::time::Instant::now();
    let mut bar = barwave::assemble::front_tracking(&scene, settings);
    bar.advance_to(1e-4).expect_err("a ramp of 1e14 steps, no more than 1e6 of which a transit time holds");
    assert_eq!(bar.events(), 1000);
    assert!(before.elapsed().as_secs_f64() < 1.0, "{:?}", before.elapsed());
}
