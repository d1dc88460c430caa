//! Twenty scenes with known answers, four tolerances each: what is chosen, what it says its error is, what it is, and how its
//! time compares with the cheapest way that `barwave cost` finds.
//!
//! `cargo run --release --example tolerance [SECONDS] > docs/tolerance.csv`; SECONDS (10 where not given) is the budget of the
//! cost study of each scene. With 0 there is none, and its columns stay empty.

#[path = "../tests/common/known.rs"]
mod known;

use std::time::Instant;

use barwave::record::Summary;
use barwave::run::{self, Wish};
use barwave::study::cost::{Cost, Hooks, Whole, cost};
use known::{Known, known};

const TOLERANCES: [f64; 4] = [1e-1, 1e-2, 1e-3, 1e-4];

/// The chosen run is timed so many times; the shortest counts.
const REPEATS: usize = 5;

/// The study of a scene, without whole processes.
fn study(case: &Known, budget: f64) -> Option<Cost> {
    let scene = case.scene("");
    let mut whole = |_: &[String], _: f64| Whole::Failed("not wanted".into());
    let mut hooks = Hooks { budget, whole: &mut whole, progress: &mut |_, _| Wish::GoOn };
    (budget > 0.0).then(|| cost(&scene, &mut hooks).ok()).flatten()
}

/// Shortest stepping time of the resolution that a run ended with, s.
fn stepping(case: &Known, summary: &Summary) -> f64 {
    let last = summary.choice.as_ref().and_then(|c| c.tried.last()).expect("a choice");
    let solve = match (last.cells, last.front_tolerance) {
        (Some(cells), _) if last.method == "moc" => format!("method = \"moc\"\ncells = {cells}"),
        (Some(cells), _) => format!("method = \"fd\"\nscheme = \"{}\"\ncells = {cells}", last.scheme),
        (None, tolerance) => format!("method = \"moc\"\nfront-tolerance = {:e}", tolerance.unwrap_or(0.0)),
    };
    let scene = case.scene(&solve);
    let time = |_| run::run(&scene, None, &mut |_| Wish::GoOn).map_or(f64::NAN, |s| s.step_wall_s);
    (0..REPEATS).map(time).fold(f64::INFINITY, f64::min)
}

fn main() {
    let budget = std::env::args().nth(1).and_then(|a| a.parse().ok()).unwrap_or(10.0);
    println!(
        "scene,tolerance,scheme,cells,front tolerance,runs,estimate,true error,stepping (s),all (s),cheapest scheme,cheapest \
         stepping (s),overshoot"
    );
    for case in known() {
        let study = study(&case, budget);
        for tolerance in TOLERANCES {
            let scene = case.scene(&format!("tolerance = {tolerance:e}"));
            let started = Instant::now();
            let summary = match run::run(&scene, None, &mut |_| Wish::GoOn) {
                Ok(summary) => summary,
                Err(error) => {
                    println!("\"{}\",{tolerance:e},\"{error}\",,,,,,,,,,", case.name);
                    continue;
                }
            };
            let all = started.elapsed().as_secs_f64();
            let tried = summary.choice.as_ref().map_or(&[][..], |c| &c.tried);
            let number = |value: Option<f64>| value.map_or_else(String::new, |v| format!("{v:.2e}"));
            let last = tried.last();
            let (error, stepping) = (case.true_error(&scene, &summary), stepping(&case, &summary));
            let best = study.as_ref().and_then(|s| s.cheapest.iter().find(|c| c.tolerance == tolerance));
            let cheapest = best.and_then(|b| b.step_wall_s);
            println!(
                "\"{}\",{tolerance:e},{},{},{},{},{},{error:.2e},{stepping:.2e},{all:.2e},{},{},{}",
                case.name,
                summary.scheme,
                last.and_then(|l| l.cells).map_or_else(String::new, |c| c.to_string()),
                number(last.and_then(|l| l.front_tolerance)),
                tried.len(),
                number(summary.error.as_ref().map(|e| e.value)),
                best.and_then(|b| b.scheme.clone()).unwrap_or_default(),
                number(cheapest),
                number(cheapest.map(|c| stepping / c)),
            );
        }
    }
}
