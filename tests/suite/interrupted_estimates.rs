//! A run whose error estimate is interrupted is not done, and the searches beside a run end when they are asked to.

use barwave::error::Error;
use barwave::record::store::ResultFile;
use barwave::run::{self, Progress};
use barwave::scene::Scene;
use barwave::study::plan::{Plan, plan};
use std::ops::ControlFlow;

/// A copper bar pulled at one end for a while.
fn scene(solve: &str) -> Scene {
    let text = format!(
        "[bar]\nlength = 1\nmaterial = \"copper-annealed\"\n[left]\nkind = \"velocity\"\nvalue = -20\n\
         release = \"20 us\"\n[right]\nkind = \"free\"\n[effects]\nhardening = \"isotropic\"\n[solve]\n{solve}\n"
    );
    Scene::parse("scene.toml", &text, ".".as_ref(), &[]).unwrap_or_else(|e| panic!("{e}"))
}

/// Runs with a stop at the first call of `progress` for which `due` holds: the error, and the outcome in the file.
fn stopped(scene: &Scene, mut due: impl FnMut(&Progress) -> bool) -> (Error, String) {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("out.h5");
    let ended = run::run(scene, Some(&path), &mut |at| {
        if due(&at) { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    });
    let file = ResultFile::open(&path).expect("a result file");
    (ended.map(|_| ()).expect_err("interrupted"), file.metadata().outcome.clone())
}

#[test]
fn a_run_on_a_grid_whose_estimate_is_interrupted_is_not_done() {
    let scene = scene("until = \"200 us\"\ncells = 400").with_error_estimate();
    // The companions have fewer cells.
    let (error, outcome) = stopped(&scene, |at| matches!(at, Progress::Steps { cells, .. } if *cells < 400));
    assert!(matches!(error, Error::Interrupted), "{error}");
    assert_eq!(outcome, "interrupted");
}

#[test]
fn a_tracked_run_whose_estimate_is_interrupted_is_not_done() {
    let scene = scene("method = \"moc\"\nuntil = \"200 us\"\nfront-tolerance = 0.01");
    let mut complete = false;
    let (error, outcome) = stopped(&scene, |at| {
        let Progress::Fronts { time, until, .. } = at else { return false };
        // The next call after the end is the companion's.
        std::mem::replace(&mut complete, time >= until)
    });
    assert!(matches!(error, Error::Interrupted), "{error}");
    assert_eq!(outcome, "interrupted");
}

#[test]
fn a_spent_event_budget_is_followed_by_no_more_than_another_one() {
    let scene = scene("method = \"moc\"\nuntil = \"1 ms\"\nfront-tolerance = 1e-5\nmax-events = 5000");
    let (mut last, mut all, mut calls) = (0, 0, 0);
    let ended = run::run(&scene, None, &mut |at| {
        if let Progress::Fronts { events, .. } = at {
            all += if events >= last { events - last } else { events };
            (last, calls) = (events, calls + 1);
        }
        ControlFlow::Continue(())
    });
    let error = ended.map(|_| ()).expect_err("the budget is spent").to_string();
    assert!(error.contains("its limit of 5000 events"), "{error}");
    assert!(calls > 3 && all <= 2 * 5000, "{calls} calls, {all} events");
    // The search can be interrupted as well.
    let mut spent = false;
    let ended = run::run(&scene, None, &mut |at| {
        let Progress::Fronts { events, .. } = at else { return ControlFlow::Continue(()) };
        let stop = spent && events < 5000;
        spent |= events >= 5000;
        if stop { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    });
    assert!(matches!(ended, Err(Error::Interrupted)));
}

#[test]
fn a_plan_stops_its_coarse_runs_and_says_so() {
    let long = "until = \"100 s\"\n";
    let notes = |plan: &Plan| plan.notes.join("\n");
    let fixed = plan(&scene(&format!("{long}cells = 400")));
    assert!(notes(&fixed).contains("cover the first"), "{}", notes(&fixed));
    let open = plan(&scene(&format!("{long}tolerance = 1e-4")));
    let how = open.choice.expect("a tolerance").how;
    assert!(how.contains("exceed the time limit of `plan`"), "{how}");
}
