//! Runs scenes with known solutions to several tolerances, both those used to determine the factors of the error estimates and those held out:
//! the chosen method, its estimated error, its true error, and its time compared with the cheapest way that `barwave cost` finds. Then the same
//! with leapfrog and with muscl as the only method.
//!
//! `cargo run --release --example tolerance [SECONDS [SET]] > docs/tolerance.csv`; SECONDS (default 10) is the budget of the cost study of each
//! scene. With 0, there is no study, and its columns are empty. SET is "settled on", "held out" or the name of a scene.

#[path = "../tests/common/known.rs"]
mod known;

use std::ops::ControlFlow;
use std::time::Instant;

use barwave::record::Summary;
use barwave::run;
use barwave::scene::Method;
use barwave::study::cost::{Cost, CostToTolerance, Hooks, cost};
use known::{Known, held_out, known};

/// Tolerances with a free choice of the method, and with one method only.
const TOLERANCES: [f64; 4] = [1e-1, 1e-2, 1e-3, 1e-4];
const ALONE: [f64; 3] = [1e-1, 3e-2, 1e-2];

/// Number of timed repeats of the chosen run, of which the shortest counts; a run longer than LONG, s, is timed once.
const REPEATS: usize = 5;
const LONG: f64 = 0.3;

/// Returns the cost study of a scene, without whole processes; `None` if there is no budget or the study fails.
fn study(case: &Known, budget: f64) -> Option<Cost> {
    let scene = case.scene("");
    let mut hooks = Hooks {
        budget,
        measure: barwave::record::Measure::Field,
        whole: None,
        progress: &mut |_, _| ControlFlow::Continue(()),
    };
    (budget > 0.0).then(|| cost(&scene, &mut hooks).ok()).flatten()
}

/// Returns the shortest stepping time with the resolution that a run ended with, s.
fn stepping(case: &Known, summary: &Summary) -> f64 {
    let last = summary.choice.as_ref().and_then(|c| c.tried.last()).map(|t| &t.by).expect("a choice");
    let solve = match (last.cells, last.front_tolerance) {
        (Some(cells), _) if last.method == "moc" => format!("method = \"moc\"\ncells = {cells}"),
        (Some(cells), _) => format!("method = \"fd\"\nscheme = \"{}\"\ncells = {cells}", last.scheme),
        (None, tolerance) => format!("method = \"moc\"\nfront-tolerance = {:e}", tolerance.unwrap_or(0.0)),
    };
    let scene = case.scene(&solve);
    let time = |_| run::run(&scene, None, &mut |_| ControlFlow::Continue(())).map_or(f64::NAN, |s| s.step_wall_s);
    let first = time(0);
    // A long run is hardly affected by short disturbances.
    if first > LONG { first } else { (1..REPEATS).map(time).fold(first, f64::min) }
}

/// Prints one row: a scene to a tolerance, by the chosen method, or by `alone` as the only method.
fn row(set: &str, case: &Known, uncertainty: f64, study: Option<&Cost>, alone: Option<&str>, tolerance: f64) {
    let meant = |method: &Method| alone.is_none_or(|alone| method.names()[1] == alone);
    let scene = case.scene(&format!("tolerance = {tolerance:e}")).with_methods(meant);
    if scene.solve.tolerance.as_ref().is_none_or(|asked| !asked.methods.iter().all(meant)) {
        return;
    }
    let head = format!("{set},\"{}\",{},{tolerance:e}", case.name, alone.unwrap_or("any"));
    let started = Instant::now();
    let summary = match run::run(&scene, None, &mut |_| ControlFlow::Continue(())) {
        Ok(summary) => summary,
        Err(error) => {
            println!("{head},\"{}\",,,,,,,,,,,,", error.to_string().replace('"', "'").replace('\n', " "));
            return;
        }
    };
    let all = started.elapsed().as_secs_f64();
    let tried = summary.choice.as_ref().map_or(&[][..], |c| &c.tried);
    let number = |value: Option<f64>| value.map_or_else(String::new, |v| format!("{v:.2e}"));
    let last = tried.last().map(|t| &t.by);
    let (error, stepping) = (case.true_error(&scene, &summary), stepping(case, &summary));
    let reaches = study.into_iter().flat_map(|s| &s.reach).filter(|r| r.tolerance == tolerance);
    let own = reaches.filter(|r| r.step_wall_s.is_some() && alone.is_none_or(|a| r.scheme.as_deref() == Some(a)));
    let time = |r: &CostToTolerance| r.step_wall_s.unwrap_or(f64::INFINITY);
    let best = own.min_by(|a, b| time(a).total_cmp(&time(b)));
    let cheapest = best.map(time);
    println!(
        "{head},{},{},{},{},{},{error:.2e},{},{uncertainty:.0e},{stepping:.2e},{all:.2e},{},{},{}",
        summary.scheme,
        last.and_then(|l| l.cells).map_or_else(String::new, |c| c.to_string()),
        number(last.and_then(|l| l.front_tolerance)),
        tried.len(),
        number(summary.error.as_ref().map(|e| e.value)),
        if error > tolerance { "yes" } else { "no" },
        best.and_then(|b| b.scheme.clone()).unwrap_or_default(),
        number(cheapest),
        number(cheapest.map(|c| stepping / c)),
    );
}

fn main() {
    let mut arguments = std::env::args().skip(1);
    let budget = arguments.next().and_then(|a| a.parse().ok()).unwrap_or(10.0);
    let only: Option<String> = arguments.next();
    println!(
        "set,scene,methods,tolerance,scheme,cells,front tolerance,runs,estimate,true error,missed,answer uncertain by,stepping \
         (s),all (s),cheapest scheme,cheapest stepping (s),overshoot"
    );
    for (set, cases) in [("settled on", known()), ("held out", held_out())] {
        let wanted = |case: &&Known| only.as_deref().is_none_or(|only| [set, case.name].contains(&only));
        for case in cases.iter().filter(wanted) {
            let study = study(case, budget);
            let uncertainty = case.uncertainty();
            for tolerance in TOLERANCES {
                row(set, case, uncertainty, study.as_ref(), None, tolerance);
            }
            for alone in ["leapfrog", "muscl"] {
                for tolerance in ALONE {
                    row(set, case, uncertainty, study.as_ref(), Some(alone), tolerance);
                }
            }
        }
    }
}
