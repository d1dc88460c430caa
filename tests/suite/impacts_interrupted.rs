//! An interrupted impact retains its results so far, like a run of a bar.

use std::ops::ControlFlow;
use std::path::Path;

use barwave::error::Error;
use barwave::record::store::{ResultFile, StoredImpact};
use barwave::run::run_impact;
use barwave::scene::Problem;

/// Returns the outcome, the notes and the result of a scene whose run is stopped at this call of its observer.
fn stopped(name: &str, sets: &[&str], call: usize) -> (String, String, StoredImpact) {
    let scene = Path::new(env!("CARGO_MANIFEST_DIR")).join("runs").join(name);
    let sets: Vec<String> = sets.iter().map(ToString::to_string).collect();
    let Ok(Problem::Impact(scene)) = Problem::read(&scene, &sets) else { panic!("{name}") };
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("out.h5");
    let mut calls = 0;
    let ended = run_impact(&scene, Some(&path), &mut |_| {
        calls += 1;
        if calls == call { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    });
    assert!(matches!(ended, Err(Error::Interrupted)), "{name}");
    let file = ResultFile::open(&path).expect("a result file");
    let impact = file.impact().expect("it can be read").expect("an impact");
    (file.metadata().outcome.clone(), file.metadata().notes.join("; "), impact)
}

fn has(impact: &StoredImpact, long_name: &str) -> bool {
    impact.figures.iter().any(|figure| figure.long_name.contains(long_name))
}

#[test]
fn every_kind_keeps_its_histories_up_to_the_interruption() {
    for (name, call) in [("spheres.toml", 30), ("plate.toml", 40), ("beam.toml", 50), ("beam-damped.toml", 60)] {
        let (outcome, notes, impact) = stopped(name, &[], call);
        assert_eq!(outcome, "interrupted", "{name}");
        assert!(notes.contains("interrupted") && notes.contains("after the first contact"), "{name}: {notes}");
        // One row per call, the same in every history.
        for table in &impact.tables {
            assert!(table.columns.iter().all(|column| column.values.len() == call), "{name} {}", table.name);
        }
        assert!(!has(&impact, "after the impact") && !has(&impact, "coefficient of restitution, int"), "{name}");
        assert!(has(&impact, "largest residual"), "{name}");
    }
}

#[test]
fn a_beam_keeps_its_last_complete_integration() {
    // The level with 16 modes finishes within 1000 times; that with 32 is stopped.
    let (outcome, notes, impact) = stopped("beam.toml", &[], 1000);
    assert_eq!(outcome, "interrupted");
    assert!(notes.contains("interrupted after the integration with 16 modes: the error is not known"), "{notes}");
    assert!(has(&impact, "minus the ratio of final to initial velocity"), "its restitution");
    let end = impact.tables[0].columns[0].values.last().copied().expect("rows");
    assert!(end > 900e-6, "{end}");
}

#[cfg(unix)]
#[test]
fn signals_end_an_impact_in_order() {
    use std::process::{Command, Stdio};
    use std::time::Duration;
    for signal in ["INT", "TERM"] {
        let folder = tempfile::tempdir().expect("a folder");
        let scene = Path::new(env!("CARGO_MANIFEST_DIR")).join("runs/beam.toml");
        // Minutes of computing time.
        let child = Command::new(env!("CARGO_BIN_EXE_barwave"))
            .current_dir(folder.path())
            .args(["run", &scene.display().to_string(), "-o", "r.h5"])
            .args(["--set", "solve.modes=10000", "--set", "solve.until=\"100 ms\""])
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .expect("it starts");
        std::thread::sleep(Duration::from_secs(3));
        let sent = Command::new("kill").args([format!("-{signal}"), child.id().to_string()]).status();
        assert!(sent.is_ok_and(|status| status.success()), "still under way");
        let output = child.wait_with_output().expect("it ends");
        assert_eq!(output.status.code(), Some(130), "{signal}");
        let message = String::from_utf8_lossy(&output.stderr);
        assert!(message.contains("interrupted: the histories so far are in r.h5"), "{signal}: {message}");
        let file = ResultFile::open(&folder.path().join("r.h5")).expect("a result file");
        assert_eq!(file.metadata().outcome, "interrupted", "{signal}");
        let report = Command::new(env!("CARGO_BIN_EXE_barwave"))
            .current_dir(folder.path())
            .args(["report", "r.h5", "-o", "r.html"])
            .status();
        assert!(report.is_ok_and(|status| status.success()), "{signal}");
    }
}
