//! What the front tolerance costs and what it changes: ten long runs, each with a row of tolerances.
//!
//! `cargo run --release --example front_tolerance [FINEST]` prints one line a run: events, fronts under way at the end,
//! time, relative L1 difference of the stress at the end from the run with the finest tolerance, the error figure that
//! the run states, and the energy it took.

use std::sync::Arc;
use std::time::Instant;

use barwave::bar::{Bar, EndCondition, History, Joint, Segment};
use barwave::material::{Beyond, Curve, Material};
use barwave::solver::moc::{FrontTracking, Settings};
use barwave::wave::riemann::Flow;

const SAMPLES: usize = 20_000;
const TOLERANCES: [f64; 7] = [1e-1, 3e-2, 1e-2, 3e-3, 1e-3, 3e-4, 1e-4];

struct Case {
    name: &'static str,
    bar: Bar,
    flow: Flow,
    ends: [EndCondition; 2],
}

fn material(rows: &[(f64, f64)], density: f64) -> Arc<Material> {
    Arc::new(Material::from_curve("study", density, Curve::new(rows, Beyond::Extend).expect("rows are right")))
}

/// A power law above yield, cut into `knots` at even steps of the logarithm of strain.
fn power_law(modulus: f64, density: f64, yield_stress: f64, exponent: f64, knots: i32) -> Arc<Material> {
    let first = yield_stress / modulus;
    let strain = |k: i32| first * (0.2 / first).powf(f64::from(k) / f64::from(knots - 1));
    let rows: Vec<_> = (0..knots).map(|k| (strain(k), yield_stress * (strain(k) / first).powf(exponent))).collect();
    material(&rows, density)
}

fn segment(length: f64, area: f64, material: &Arc<Material>) -> Segment {
    Segment { length, area, material: Arc::clone(material), velocity: 0.0, joint: Joint::Bonded }
}

fn bar(segments: Vec<Segment>) -> Bar {
    Bar { segments, area_given: true }
}

fn pulled(velocity: f64, release: f64) -> EndCondition {
    EndCondition::Velocity { history: History::constant(velocity), release: Some(release) }
}

fn pulse(stress: f64, until: f64) -> EndCondition {
    let history = History::new(&[(0.0, stress), (until, stress), (until, 0.0)]).expect("in order");
    EndCondition::Stress { history }
}

fn cases() -> Vec<Case> {
    use EndCondition::{Absorbing, Fixed, Free};
    let plastic = |kinematic| Flow::Plastic { kinematic };
    let copper = power_law(117e9, 8930.0, 33e6, 0.32, 40);
    let coarse = power_law(117e9, 8930.0, 33e6, 0.32, 10);
    let steel = material(&[(0.001, 200e6), (0.02, 210e6), (0.1, 600e6)], 7800.0);
    let hard = material(&[(0.001, 200e6), (0.1, 600e6)], 7800.0);
    let soft = material(&[(0.0005, 35e6), (0.02, 80e6), (0.2, 120e6)], 2700.0);
    let one = |m: &Arc<Material>| bar(vec![segment(1.0, 1.0, m)]);
    let two = bar(vec![segment(0.5, 1e-4, &hard), segment(0.5, 3e-4, &soft)]);
    let three = bar(vec![segment(0.3, 2.0, &copper), segment(0.4, 1.0, &hard), segment(0.3, 2.0, &copper)]);
    let step = bar(vec![segment(0.5, 1.0, &coarse), segment(0.5, 0.6, &coarse)]);
    let (c, s) = (copper.c0().recip(), hard.c0().recip());
    let case = |name, bar, flow, ends| Case { name, bar, flow, ends };
    vec![
        case("let go, free", one(&copper), plastic(0.0), [pulled(-30.0, c), Free]),
        case("let go, fixed", one(&copper), plastic(0.0), [pulled(-30.0, c), Fixed]),
        case("let go, kinematic", one(&copper), plastic(1.0), [pulled(-30.0, c), Free]),
        case("let go, mixed", one(&coarse), plastic(0.5), [pulled(-30.0, c), Fixed]),
        case("short pulse", one(&coarse), plastic(0.0), [pulse(-150e6, 0.2 * c), Free]),
        case("held, kinematic, two materials", two.clone(), plastic(1.0), [pulled(8.0, 9.0), Fixed]),
        case("let go, two materials", two, plastic(0.0), [pulled(8.0, 0.5 * s), Fixed]),
        case("three segments", three, plastic(0.0), [pulse(120e6, 0.5 * c), Absorbing]),
        case("area step", step, plastic(0.0), [pulled(20.0, 0.7 * c), Free]),
        case("yield plateau", one(&steel), plastic(0.0), [pulled(12.0, 0.5 * s), Free]),
    ]
}

fn stresses(run: &FrontTracking, length: f64) -> Vec<f64> {
    (0..SAMPLES).map(|i| run.state_at(length * (i as f64 + 0.5) / SAMPLES as f64).stress).collect()
}

fn difference(a: &[f64], b: &[f64]) -> f64 {
    let sum = |values: &mut dyn Iterator<Item = f64>| values.map(f64::abs).sum::<f64>();
    sum(&mut a.iter().zip(b).map(|(a, b)| a - b)) / sum(&mut b.iter().copied())
}

fn main() {
    let finest: f64 = std::env::args().nth(1).and_then(|a| a.parse().ok()).unwrap_or(3e-4);
    for case in cases() {
        let until = 10.0 * case.bar.transit_time();
        println!("{}", case.name);
        let mut runs: Vec<(f64, Vec<f64>, String)> = Vec::new();
        for tolerance in TOLERANCES.into_iter().filter(|&t| t >= 0.999 * finest) {
            let settings = Settings { front_tolerance: tolerance, event_budget: 3_000_000, ..Settings::default() };
            let mut run = FrontTracking::new(&case.bar, case.flow, case.ends.clone(), settings);
            let start = Instant::now();
            if let Err(stopped) = run.advance_to(until) {
                println!("  {tolerance:.0e}: {stopped}");
                continue;
            }
            let seconds = start.elapsed().as_secs_f64();
            let field = stresses(&run, case.bar.length());
            let mean = field.iter().map(|s| s.abs()).sum::<f64>() / SAMPLES as f64;
            let (changed, energy) = run.thinning();
            let balance = run.balance();
            let text = format!(
                "events {} fronts {} {seconds:.3} s  {:.0} ns/event changed {:.2e} energy {:.1e} residual {:.1e}",
                run.events(),
                run.fronts().count(),
                1e9 * seconds / run.events() as f64,
                changed / (mean * case.bar.length()),
                energy / balance.total(),
                (balance.total() + energy - balance.work[0] - balance.work[1]) / balance.total()
            );
            runs.push((tolerance, field, text));
        }
        for k in 0..runs.len() {
            let errors: Vec<_> =
                runs[k + 1..].iter().map(|r| format!("{:.1e}", difference(&runs[k].1, &r.1))).collect();
            println!("  {:.0e}: {} | {}", runs[k].0, runs[k].2, errors.join(" "));
        }
    }
}
