//! A run whose error estimate is interrupted is not complete, and searches beside a run end when interrupted.

use barwave::error::Error;
use barwave::record::store::ResultFile;
use barwave::run::{self, Progress};
use barwave::scene::Scene;
use barwave::study::plan::{Plan, plan};
use std::ops::ControlFlow;

/// Returns a copper bar that is pulled at one end for a while.
fn scene(solve: &str) -> Scene {
    let text = format!(
        "[bar]\nlength = 1\nmaterial = \"copper-annealed\"\n[left]\nkind = \"velocity\"\nvalue = -20\n\
         release = \"20 us\"\n[right]\nkind = \"free\"\n[effects]\nhardening = \"isotropic\"\n[solve]\n{solve}\n"
    );
    Scene::parse("scene.toml", &text, ".".as_ref(), &[]).unwrap_or_else(|e| panic!("{e}"))
}

/// Runs a scene that is stopped at the first call of `progress` for which `due` holds. Returns the error, and the outcome in the file.
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
    // The companion runs have fewer cells.
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
        // The next call after the end is that of the companion run.
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
    // The search can be interrupted, too.
    let mut spent = false;
    let ended = run::run(&scene, None, &mut |at| {
        let Progress::Fronts { events, .. } = at else { return ControlFlow::Continue(()) };
        let stop = spent && events < 5000;
        spent |= events >= 5000;
        if stop { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    });
    assert!(matches!(ended, Err(Error::Interrupted)));
}

/// A search of several minutes reports the runs made to select the method.
#[test]
fn a_search_for_a_method_says_what_it_has_tried() {
    let (scene, mut tried) = (scene("until = \"200 us\"\ntolerance = 1e-6"), Vec::new());
    let ended = run::run(&scene, None, &mut |at| {
        if let Progress::Tried { tried: now, tolerance } = at {
            assert!(tolerance == 1e-6 && now.work > 0, "{now:?}");
            tried.push(now.by.scheme);
        }
        if tried.len() < 6 { ControlFlow::Continue(()) } else { ControlFlow::Break(()) }
    });
    assert!(matches!(ended, Err(Error::Interrupted)));
    assert!(["leapfrog", "front-tracking"].iter().all(|scheme| tried.iter().any(|by| by == scheme)), "{tried:?}");
}

/// The message states the state of the search, not that the run has not begun.
#[cfg(unix)]
#[test]
fn an_interrupted_search_says_how_far_it_came() {
    use std::process::{Command, Stdio};
    let folder = tempfile::tempdir().expect("a folder");
    let text = scene("until = \"400 us\"\ntolerance = 1e-6").text.replace("length = 1\n", "length = 0.5\n");
    let text = text.replace("value = -20", "value = -30").replace("20 us", "50 us");
    std::fs::write(folder.path().join("scene.toml"), text).expect("a file");
    // Half a minute of computing time.
    let child = Command::new(env!("CARGO_BIN_EXE_barwave"))
        .current_dir(folder.path())
        .args(["run", "scene.toml", "-o", "r.h5"])
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .expect("it starts");
    std::thread::sleep(std::time::Duration::from_secs(4));
    let sent = Command::new("kill").args(["-INT", &child.id().to_string()]).status();
    assert!(sent.is_ok_and(|status| status.success()), "still under way");
    let output = child.wait_with_output().expect("it ends");
    assert_eq!(output.status.code(), Some(130));
    let message = String::from_utf8_lossy(&output.stderr);
    assert!(message.contains("interrupted while the method for `tolerance` was selected, after "), "{message}");
    assert!(message.contains("tolerance: "), "{message}");
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
