//! Front tracking: computing time per run and per event. Nothing is asserted: times depend on the machine.
//! `cargo bench --bench front_tracking` runs it.

use std::ops::ControlFlow;
use std::path::Path;
use std::time::Instant;

use barwave::assemble;
use barwave::run;
use barwave::scene::Scene;
use barwave::solver::moc::{FrontTracking, Settings};

const RUNS: usize = 7;

/// Returns a steel bar of 1 m whose left end moves, with `knots` knots of a power law above yield.
fn steel(knots: usize, velocity: f64, release: &str, until: f64) -> Scene {
    let knot = |k: usize| {
        let ratio = 50.0_f64.powf(k as f64 / (knots - 1) as f64);
        [0.001 * ratio, 200e6 * ratio.powf(0.2)]
    };
    let table: Vec<[f64; 2]> = (0..knots).map(knot).collect();
    // With two knots, the table is that of the bilinear benchmark.
    let table = if knots == 2 { vec![[0.001, 200e6], [0.05, 1180e6]] } else { table };
    let text = format!(
        "[bar]\nlength = 1\n[bar.material]\nname = \"bench\"\ndensity = 7800\nmodulus = 200e9\nbeyond = \"extend\"\n\
         curve = {{ table = {table:?} }}\n[left]\nkind = \"velocity\"\nvalue = {velocity:?}\n{release}\n[right]\n\
         kind = \"free\"\n[effects]\nhardening = \"isotropic\"\n[solve]\nuntil = {until:e}\nmethod = \"moc\"\n"
    );
    Scene::parse("bench", &text, Path::new("."), &[]).unwrap_or_else(|error| panic!("{error}"))
}

/// Returns the shortest time of [`RUNS`] runs, s, and the bar of that run.
fn shortest(scene: &Scene, settings: Settings) -> (f64, FrontTracking) {
    let run = || {
        let start = Instant::now();
        let mut bar = assemble::front_tracking(scene, settings);
        bar.advance_to(scene.solve.until).unwrap_or_else(|stopped| panic!("{stopped}"));
        (start.elapsed().as_secs_f64(), bar)
    };
    let runs = (0..RUNS).map(|_| run());
    runs.min_by(|a, b| a.0.total_cmp(&b.0)).expect("there are runs")
}

fn line(name: &str, scene: &Scene, front_tolerance: f64, front_segments: bool) -> f64 {
    let settings = Settings { front_tolerance, event_budget: 100_000_000, front_segments, ..Settings::default() };
    let (seconds, bar) = shortest(scene, settings);
    let an_event = 1e9 * seconds / bar.events().max(1) as f64;
    println!("{name:<46}{front_tolerance:>10.0e}{:>10}{:>14.1}{an_event:>12.0}", bar.events(), 1e6 * seconds);
    seconds
}

fn main() {
    // `cargo test --benches` only checks that this program starts.
    if !std::env::args().any(|argument| argument == "--bench") {
        return;
    }
    println!("shortest of {RUNS} runs");
    println!("{:<46}{:>10}{:>10}{:>14}{:>12}", "bar", "tolerance", "events", "us", "ns an event");
    line("P2, bilinear, to 0.8 L/c0", &steel(2, 20.0, "", 1.58e-4), 0.0, false);
    line("P3, 60 knots, to 0.8 L/c0", &steel(60, 20.0, "", 1.58e-4), 0.0, false);
    // Ten transits of 197 us each; released after one.
    let let_go = steel(10, -30.0, "release = 2e-4", 1.97e-3);
    for tolerance in [1e-2, 3e-3, 1e-3] {
        line("10 knots, pulled and released, ten transits", &let_go, tolerance, false);
    }
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("runs/copper-released.toml");
    let copper = Scene::read(&file, &[]).unwrap_or_else(|error| panic!("{error}"));
    let plain = line("copper-released, ten transits", &copper, 1e-3, false);
    let front_segments = line("copper-released, with front_segments kept", &copper, 1e-3, true);
    let start = Instant::now();
    run::run(&copper, None, &mut |_| ControlFlow::Continue(())).unwrap_or_else(|error| panic!("{error}"));
    let whole = start.elapsed().as_secs_f64();
    println!(
        "copper-released as `barwave run` without a file, with its companion: {:.0} us; {:.0} % of it stepping, {:.0} % front_segments",
        1e6 * whole,
        100.0 * plain / whole,
        100.0 * (front_segments - plain) / whole
    );
}
