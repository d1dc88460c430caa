//! Runs that are interrupted or killed and then resumed, through the real binary, have the same bits as uninterrupted ones.
#![cfg(unix)]

use crate::common;
use crate::common::binary;
use crate::common::results;

use std::path::{Path, PathBuf};
use std::process::{Child, Command, Output, Stdio};
use std::time::{Duration, Instant, SystemTime};

use barwave::bar::ends::{self, EndModel, Face, Push, Response, Step};
use barwave::bar::{EndCondition, Hertz};
use barwave::record::Field;
use barwave::record::store::{Checkpoint, ResultFile};
use binary::barwave;
use common::{BUSY_AREA, busy_ends};
use results::{assert_same, unlocked};
use serde_json::Value;

/// End of a scene that runs for some tenths of a second.
const SOLVE: &str = "[solve]\nuntil = \"2 ms\"\ncells = 600\n";
const RECORD: &str = "[record]\nframes = 50\ncells = 100\ngauges = { near = 0.1, far = 0.7 }\n";
const STEEL: &str = "name = \"steel\"\ndensity = 7800\nmodulus = \"200 GPa\"\npoisson = 0.3\nbeyond = \"extend\"\n\
                     curve = { table = [[0.001, \"200 MPa\"], [0.021, \"600 MPa\"]] }\n";
const HEAT: &str = "name = \"copper\"\ndensity = 8960\nmodulus = \"124 GPa\"\nbeyond = \"extend\"\n\
                    curve = { formula = \"johnson-cook\", A = \"90 MPa\", B = \"292 MPa\", n = 0.31 }\n\
                    heat = { specific-heat = 383, reference-temperature = 293, melting-temperature = 1356, m = 1.09 }\n";

/// Returns a steel bar with these ends, effects and solver.
fn scene(left: &str, right: &str, effects: &str, solve: &str) -> String {
    format!(
        "[bar]\nlength = 1\ndiameter = \"20 mm\"\nmaterial = \
         \"steel.toml\"\n[left]\n{left}\n[right]\n{right}\n[effects]\n{effects}\n\
         {SOLVE}{solve}\n{RECORD}"
    )
}

/// Returns the scene with a bar that is stressed and partly yielded at the start.
fn stressed(scene: &str) -> String {
    let state = "stress = [[0, 0], [0.5, \"40 MPa\"], [1, 0]]\nplastic-strain = [[0, 0.004], [0.3, 0]]";
    scene.replacen("[left]", &format!("{state}\n[left]"), 1)
}

/// Returns scenes by name. Materials and a history are in separate files.
fn scenes() -> Vec<(&'static str, String)> {
    let (pulled, free) = ("kind = \"velocity\"\nvalue = -12", "kind = \"free\"");
    let plastic = "hardening = \"isotropic\"";
    let steel = "{ name = \"hard\", density = 8000, modulus = \"200 GPa\", poisson = 0.3, beyond = \"extend\", curve = { table \
                 = [[0.01, \"2 GPa\"]] } }";
    let heated = scene(
        "kind = \"velocity\"\nvalue = -20",
        free,
        "rate = { model = \"johnson-cook\", C = 0.025, reference = \"1 1/s\" }\nheat = {}",
        "",
    )
    .replace("steel.toml", "copper.toml")
    .replace("2 ms", "0.2 ms");
    let ball = format!("kind = \"ball\"\ndiameter = \"30 mm\"\nvelocity = \"20 m/s\"\nmaterial = {steel}");
    let net = "method = \"moc\"";
    let joint = "[[bar.segment]]\nlength = 0.4\ndiameter = \"20 mm\"\nmaterial = \"steel.toml\"\njoint = \"contact\"\ngap = \
                 \"0.01 mm\"\n\
                 velocity = 14\n[[bar.segment]]\nlength = 0.6\ndiameter = \"16 mm\"\nmaterial = \"steel.toml\"\n";
    let in_contact = |solve: &str| {
        let whole = scene(free, free, plastic, solve);
        format!("{joint}{}", &whole[whole.find("[left]").expect("a left end")..])
    };
    let many_frames = scene(pulled, free, plastic, "").replace("2 ms", "20 us").replace("frames = 50", "frames = 2000");
    let pulled_apart = "kind = \"velocity\"\nhistory = [[0, 0], [\"1 ms\", -30], [\"2 ms\", -200]]";
    let stopped = scene(pulled_apart, free, plastic, "").replace("steel.toml", "brittle.toml");
    // The end of the data is reached early; with more cells, the run is still long enough to be interrupted.
    let stopped = stopped.replace("cells = 600", "cells = 4000");
    vec![
        ("plastic", scene("kind = \"velocity\"\ncsv = \"blow.csv\"", free, plastic, "")),
        ("kinematic", scene(pulled, "kind = \"fixed\"", "hardening = \"kinematic\"", "")),
        ("damped", scene(pulled, free, "damping = { internal = \"20 kPa*s\", external = 100, foundation = 1e7 }", "")),
        ("friction", scene(pulled, free, "hardening = \"isotropic\"\ndamping = { friction = 200 }", "")),
        ("stressed", stressed(&scene(pulled, free, plastic, ""))),
        (
            "stressed-damped",
            stressed(&scene(pulled, free, "hardening = \"isotropic\"\ndamping = { external = 100 }", "")),
        ),
        ("lateral", scene(pulled, free, "hardening = \"isotropic\"\nlateral-inertia = true", "")),
        (
            "rupture",
            scene(
                "kind = \"stress\"\nhistory = [[0, -180e6], [8e-6, -180e6], [8e-6, 0]]",
                free,
                "rupture = { spall = \"100 MPa\" }",
                "",
            ),
        ),
        ("torn-off", scene("kind = \"velocity\"\nvalue = -40", free, "rupture = { energy = 2e6 }", "")),
        ("contact", in_contact("")),
        ("heat", heated),
        ("muscl", scene("kind = \"velocity\"\ncsv = \"blow.csv\"", "kind = \"fixed\"", plastic, "scheme = \"muscl\"")),
        ("muscl-contact", in_contact("scheme = \"muscl\"")),
        ("net", scene(pulled, "kind = \"fixed\"", "rate = { model = \"malvern\", k = \"1e5 1/s\" }", net)),
        ("striker", scene("kind = \"striker\"\nmass = 0.5\nvelocity = 15", free, plastic, "")),
        (
            "striker-net",
            scene(
                "kind = \"striker\"\nmass = 0.5\nvelocity = 15",
                free,
                "rate = { model = \"malvern\", k = \"1e5 1/s\" }",
                net,
            ),
        ),
        ("ball", scene(&ball, free, plastic, "")),
        (
            "spring",
            scene(
                "kind = \"spring\"\nstiffness = 1e7",
                "kind = \"velocity\"\nvalue = 9\nrelease = \"100 us\"",
                plastic,
                "",
            ),
        ),
        (
            "dashpot",
            scene("kind = \"dashpot\"\ncoefficient = 9000", "kind = \"wall\"\ngap = \"0.1 mm\"", plastic, "")
                .replace("diameter = \"20 mm\"\nmaterial", "diameter = \"20 mm\"\nvelocity = 8\nmaterial"),
        ),
        ("stopped", stopped),
        ("frames-in-a-step", many_frames),
    ]
}

/// Returns a steel bar with front tracking.
fn tracked(left: &str, right: &str, effects: &str, solve: &str) -> String {
    scene(left, right, effects, &format!("method = \"moc\"\n{solve}")).replace("cells = 600\n", "")
}

/// Returns scenes with front tracking.
fn tracked_scenes() -> Vec<(&'static str, String)> {
    let (free, plastic) = ("kind = \"free\"", "hardening = \"isotropic\"");
    let let_go =
        include_str!("../../runs/copper-released.toml").replace("front-tolerance = 1e-3", "front-tolerance = 6e-3");
    let pulse = "kind = \"stress\"\nhistory = [[0, 0], [10e-6, -180e6], [20e-6, 0]]";
    let ramps = "kind = \"velocity\"\ncsv = \"blow.csv\"";
    let joint = "[[bar.segment]]\nlength = 0.4\ndiameter = \"20 mm\"\nmaterial = \"steel.toml\"\njoint = \"contact\"\n\
                 gap = \"0.01 mm\"\nvelocity = 14\n[[bar.segment]]\nlength = 0.6\ndiameter = \"16 mm\"\nmaterial = \
                 \"steel.toml\"\n";
    let fine = "front-tolerance = 2e-3";
    let contact = tracked(ramps, free, plastic, fine);
    let pulled_apart = "kind = \"velocity\"\nhistory = [[0, 0], [\"1 ms\", -30], [\"2 ms\", -200]]";
    vec![
        ("fronts", let_go),
        (
            "fronts-ramps",
            tracked(ramps, free, plastic, fine).replace("frames = 50", "frames = 50\ncompression = \"none\""),
        ),
        ("fronts-stressed", stressed(&tracked(ramps, free, plastic, fine))),
        ("fronts-striker", tracked("kind = \"striker\"\nmass = 0.5\nvelocity = 15", free, plastic, fine)),
        ("fronts-rupture", tracked(pulse, free, "rupture = { spall = \"100 MPa\" }", fine)),
        ("fronts-torn-off", tracked(pulled_apart, free, "rupture = { energy = 2e6 }", "front-tolerance = 5e-3")),
        ("fronts-contact", format!("{joint}{}", &contact[contact.find("[left]").expect("a left end")..])),
        ("fronts-stopped", tracked(pulled_apart, free, plastic, fine).replace("steel.toml", "brittle.toml")),
        ("fronts-spent", tracked(ramps, free, plastic, "front-tolerance = 1e-5\nmax-events = 50000")),
    ]
}

/// Returns scenes whose effects or method are selected automatically.
fn open_scenes() -> Vec<(&'static str, String)> {
    let auto = include_str!("../../runs/copper-auto.toml").replace("cells = 1000", "cells = 1500");
    // With leapfrog only, and not selected at the first attempt.
    let damped = include_str!("../../runs/copper-to-a-tolerance.toml")
        .replace("tolerance = 1e-3", "tolerance = 2e-2")
        .replace("[effects]", "[effects]\ndamping = { external = 100 }");
    let striker = tracked("kind = \"striker\"\nmass = 0.5\nvelocity = 15", "kind = \"free\"", "", "");
    let both =
        striker.replace("[effects]", "").replace("method = \"moc\"", "tolerance = 5e-2").replace("2 ms", "0.5 ms");
    vec![("auto", auto), ("tolerance", damped), ("auto-tolerance", format!("effects = \"auto\"\n{both}"))]
}

/// Returns a folder with all scenes and the files that they name.
fn folder() -> tempfile::TempDir {
    let folder = tempfile::tempdir().expect("a folder");
    for (name, text) in [scenes(), tracked_scenes(), open_scenes()].concat() {
        std::fs::write(folder.path().join(format!("{name}.toml")), text).expect("written");
    }
    write_named(folder.path());
    folder
}

fn write_named(folder: &Path) {
    let history = "time [us],velocity [m/s]\n0,-12\n60,-12\n60,5\n300,0\n";
    // The run stops at the end of its data.
    let brittle = STEEL.replace("beyond = \"extend\"\n", "");
    let named = [("steel.toml", STEEL), ("copper.toml", HEAT), ("brittle.toml", &brittle), ("blow.csv", history)];
    for (name, text) in named {
        std::fs::write(folder.join(name), text).expect("written");
    }
}

fn start(folder: &Path, arguments: &[&str]) -> Child {
    let mut command = Command::new(env!("CARGO_BIN_EXE_barwave"));
    command.args(arguments).current_dir(folder).env_remove("BARWAVE_MATERIALS").stdin(Stdio::null());
    command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().expect("it starts")
}

fn signal(child: &Child, name: &str) {
    // The process may have ended already.
    let _ = Command::new("kill").args([&format!("-{name}"), &child.id().to_string()]).stderr(Stdio::null()).status();
}

fn message(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

/// Returns the summary without the times of the run; for a stopped run, its error.
fn summary(output: &Output) -> Value {
    if output.status.code() == Some(1) {
        return message(output).lines().filter(|line| line.starts_with("error: ")).collect::<String>().into();
    }
    assert_eq!(output.status.code(), Some(0), "{}", message(output));
    let mut summary: Value = serde_json::from_slice(&output.stdout).expect("one JSON value");
    for key in ["wall_s", "step_wall_s", "cell_steps_per_s", "events_per_s", "output"] {
        summary.as_object_mut().expect("an object").remove(key);
    }
    summary
}

/// Generator of numbers between 0 and 1 that are different in each run.
struct Chance(u64);

impl Chance {
    fn new() -> Self {
        let seed = SystemTime::now().duration_since(SystemTime::UNIX_EPOCH).expect("a time").as_nanos() as u64;
        println!("seed {seed}");
        Self(seed | 1)
    }

    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(0x5851_F42D_4C95_7F2D).wrapping_add(0x1405_7B7E_F767_814F);
        (self.0 >> 11) as f64 / 2.0_f64.powi(53)
    }
}

/// Returns the files in the folder that belong to a run with this result.
fn files(folder: &Path, result: &str) -> Vec<String> {
    let names = std::fs::read_dir(folder).expect("a folder").map(|e| e.expect("an entry").file_name());
    let mut names: Vec<String> = names.map(|name| name.to_string_lossy().into_owned()).collect();
    names.retain(|name| name.trim_start_matches('.').starts_with(result));
    names.sort();
    names
}

/// Returns true if the run has written the complete file.
fn has_ended(path: &Path) -> bool {
    path.exists()
        && ["done", "rupture", "stopped"]
            .contains(&ResultFile::open(path).expect("a result").metadata().outcome.as_str())
}

/// Compares a run in several parts with an uninterrupted one.
fn resumed_is_whole(folder: &Path, name: &str, chance: &mut Chance) {
    let (file, whole, parts) = (format!("{name}.toml"), format!("{name}-whole.h5"), format!("{name}-parts.h5"));
    let started = Instant::now();
    let expected = summary(&barwave(folder, &["run", &file, "-o", &whole, "--json"]));
    let time = started.elapsed().as_secs_f64();
    let begin = ["run", &file, "-o", &parts, "--json", "--checkpoint", "2ms"];
    let resume = ["run", "--resume", parts.as_str(), "--json"];
    // Computing times vary: a run that ends before it is interrupted is repeated.
    for _ in 0..40 {
        put_back(folder);
        let (mut interruptions, mut arguments) = (0, &begin[..]);
        loop {
            let child = start(folder, arguments);
            if interruptions < 2 {
                std::thread::sleep(Duration::from_secs_f64(time * chance.next()));
                signal(&child, if interruptions == 0 { "TERM" } else { "KILL" });
            }
            let output = child.wait_with_output().expect("it ends");
            match output.status.code() {
                Some(0 | 1) if interruptions > 0 => {
                    assert_eq!(summary(&output), expected, "{name}");
                    assert_same(&folder.join(&whole), &folder.join(&parts), name);
                    assert_eq!(files(folder, &parts), std::slice::from_ref(&parts), "{name}");
                    return;
                }
                Some(0 | 1) => break,
                Some(130) | None => {}
                Some(code) => panic!("{name}: exit code {code}: {}", message(&output)),
            }
            let kept = folder.join(format!("{parts}.checkpoint")).exists();
            if output.status.code().is_some() {
                let resume = format!("resume with: barwave run --resume {parts}");
                let said = message(&output);
                assert!(said.contains(if kept { &resume } else { "nothing can be resumed" }), "{said}");
            }
            // If it was killed at its very end, the result is complete. If it was interrupted during the selection, or killed before the first
            // checkpoint, it starts again.
            if !kept || has_ended(&folder.join(&parts)) {
                break;
            }
            interruptions += 1;
            arguments = &resume;
            // The result contains everything that the scene needs.
            for named in ["steel.toml", "copper.toml", "brittle.toml", "blow.csv", &file] {
                std::fs::rename(folder.join(named), folder.join(format!("{named}.away"))).ok();
            }
        }
    }
    panic!("{name} always ended before it was interrupted");
}

fn put_back(folder: &Path) {
    for entry in std::fs::read_dir(folder).expect("a folder").flatten().map(|entry| entry.path()) {
        if entry.extension().is_some_and(|extension| extension == "away") {
            std::fs::rename(&entry, entry.with_extension("")).expect("moved");
        }
    }
}

#[test]
fn resumed_runs_have_the_bits_of_whole_ones() {
    let (folder, mut chance) = (folder(), Chance::new());
    for (name, _) in scenes() {
        resumed_is_whole(folder.path(), name, &mut chance);
        put_back(folder.path());
    }
}

#[test]
fn resumed_runs_by_front_tracking_have_the_bits_of_whole_ones() {
    let (folder, mut chance) = (folder(), Chance::new());
    for (name, _) in tracked_scenes() {
        resumed_is_whole(folder.path(), name, &mut chance);
        put_back(folder.path());
    }
}

#[test]
fn resumed_runs_do_not_choose_again() {
    let (folder, mut chance) = (folder(), Chance::new());
    for (name, _) in open_scenes() {
        resumed_is_whole(folder.path(), name, &mut chance);
        put_back(folder.path());
    }
}

#[test]
fn an_estimate_of_the_error_goes_with_a_resumed_run() {
    let folder = folder();
    let run = |arguments: &[&str]| barwave(folder.path(), &[&["run"], arguments].concat());
    let longer = ["--set", "solve.until=6 ms"];
    let expected = summary(&run(&[&["muscl.toml", "-o", "a.h5", "--json", "--estimate-error"], &longer[..]].concat()));
    assert!(expected["error"]["value"].as_f64().is_some(), "{expected}");
    let arguments = ["run", "muscl.toml", "-o", "b.h5", "--estimate-error", "--checkpoint", "1ms"];
    let child = start(folder.path(), &[&arguments[..], &longer].concat());
    while !folder.path().join("b.h5.checkpoint").exists() {
        std::thread::sleep(Duration::from_millis(1));
    }
    signal(&child, "TERM");
    assert_eq!(child.wait_with_output().expect("it ends").status.code(), Some(130));
    assert_eq!(summary(&run(&["--resume", "b.h5", "--json"])), expected);
    assert_same(&folder.path().join("a.h5"), &folder.path().join("b.h5"), "with an estimate");
}

/// Steps an end against a bar with this impedance (N s/m); returns its actions in each step, and its energy.
fn push(end: &mut dyn EndModel, steps: std::ops::Range<u32>, impedance: f64) -> Vec<[u64; 3]> {
    let (dt, mut displacement, mut done) = (1e-6, 0.0, Vec::new());
    for k in steps {
        let step = Step { time: f64::from(k) * dt, dt, displacement };
        let bar = Response { force: 1e4 * impedance.sqrt() * (0.3 * f64::from(k)).sin(), impedance };
        let relation = end.relation(&step, &bar);
        let [force, velocity] = relation.solve_with(&bar);
        let met = !relation.unilateral || force > 0.0;
        let force = if met { force } else { 0.0 };
        end.advance(&step, &Push { force, velocity, impulse: force * dt }, met);
        displacement += dt * velocity;
        done.push([force, velocity, end.energy(displacement)].map(f64::to_bits));
    }
    done
}

#[test]
fn every_kind_of_end_is_restored_from_its_state() {
    let face = Face { inward: 1.0, area: BUSY_AREA, impedance: 4e7 * BUSY_AREA, velocity: 0.0 };
    let contact = Hertz::new(0.5, [(200e9, 0.3), (200e9, 0.3)]);
    let mut all = busy_ends(BUSY_AREA);
    all.push(EndCondition::Ball { mass: 500.0, velocity: 20.0, contact });
    all.push(EndCondition::Dashpot { coefficient: 1e7 });
    let mut with_state = 0;
    for condition in all {
        let mut whole = ends::model(&condition, face);
        push(whole.as_mut(), 0..60, face.impedance);
        let mut resumed = ends::model(&condition, face);
        with_state += usize::from(resumed.state() != whole.state());
        resumed.restore(whole.state());
        let [a, b] = [&mut whole, &mut resumed].map(|end| push(end.as_mut(), 60..120, face.impedance));
        assert_eq!(a, b, "{condition:?}");
    }
    // Two strikers, a ball, and ends with a prescribed velocity that may be released.
    assert!(with_state >= 4, "{with_state} kinds have a state");
}

/// Many frames, of which a few are written at a time.
const MANY: &str = "frames = 1500\nfields = [\"stress\"]";

/// Returns all frames in a file.
fn frames(path: &Path) -> Vec<Vec<u64>> {
    let file = ResultFile::open(path).expect("a killed run leaves a result that opens");
    let count = file.time().expect("times").len();
    let mut frames: Vec<Vec<u64>> = file.time().expect("times").iter().map(|time| vec![time.to_bits()]).collect();
    let values = file.field(Field::Stress, 0..count).expect("frames that were flushed are readable");
    for (frame, row) in frames.iter_mut().zip(values.rows()) {
        frame.extend(row.iter().map(|value| value.to_bits()));
    }
    frames
}

#[test]
fn a_run_killed_at_any_moment_keeps_its_frames_and_is_resumed() {
    let (pulled, plastic) = ("kind = \"velocity\"\nvalue = -12", "hardening = \"isotropic\"");
    let many = scene(pulled, "kind = \"free\"", plastic, "").replace("frames = 50", MANY).replace("2 ms", "1 ms");
    killed_at_any_moment(&many, 50);
}

#[test]
fn a_run_by_front_tracking_killed_at_any_moment_keeps_its_frames_and_is_resumed() {
    let ramps = "kind = \"velocity\"\ncsv = \"blow.csv\"";
    let many = tracked(ramps, "kind = \"free\"", "hardening = \"isotropic\"", "front-tolerance = 2e-3");
    killed_at_any_moment(&many.replace("frames = 50", MANY).replace("2 ms", "1 ms"), 30);
}

fn killed_at_any_moment(scene: &str, most: usize) {
    let (folder, mut chance) = (folder(), Chance::new());
    let path = |name: &str| folder.path().join(name);
    std::fs::write(path("many.toml"), scene).expect("written");
    let started = Instant::now();
    let expected = summary(&barwave(folder.path(), &["run", "many.toml", "-o", "whole.h5", "--json"]));
    let time = started.elapsed().as_secs_f64();
    let whole = frames(&path("whole.h5"));
    assert_eq!(whole.len(), 1500);
    let (mut kills, mut resumed, mut ended) = (0, 0, 0);
    let begin = ["run", "many.toml", "-o", "k.h5", "--json", "--checkpoint", "1ms"];
    let resume = ["run", "--resume", "k.h5", "--json"];
    let mut arguments = &begin[..];
    // The number of kills after the first checkpoint depends on the load of the machine.
    while kills < most || (resumed <= most / 5 && kills < 20 * most) {
        let child = start(folder.path(), arguments);
        std::thread::sleep(Duration::from_secs_f64(time * (0.05 + 0.9 * chance.next())));
        signal(&child, "KILL");
        let output = child.wait_with_output().expect("it ends");
        if let Some(code) = output.status.code() {
            assert_eq!(code, 0, "{}", message(&output));
            assert_eq!(summary(&output), expected);
            assert_same(&path("whole.h5"), &path("k.h5"), &format!("after {kills} kills"));
            assert_eq!(files(folder.path(), "k.h5"), ["k.h5"]);
            (arguments, ended) = (&begin, ended + 1);
            continue;
        }
        kills += 1;
        if has_ended(&path("k.h5")) {
            assert_same(&path("whole.h5"), &path("k.h5"), "killed as its last act");
            arguments = &begin;
            continue;
        }
        let checkpoint = Checkpoint::read(&path("k.h5")).expect("a checkpoint is whole");
        if path("k.h5").exists() {
            let kept = frames(&path("k.h5"));
            assert!(whole.starts_with(&kept), "{} frames", kept.len());
            if let Some(checkpoint) = &checkpoint {
                assert!(kept.len() >= checkpoint.rows.frames, "{} frames of {:?}", kept.len(), checkpoint.rows);
            }
        }
        // A third of the runs is repeated from the start, and replaces what the killed run left.
        let anew = checkpoint.is_none() || chance.next() < 0.3;
        arguments = if anew { &begin } else { &resume };
        resumed += usize::from(!anew);
    }
    assert!(resumed > most / 5, "{resumed} resumed");
    println!("{kills} kills, {resumed} resumed, {ended} ran to their end before that");
    let last = barwave(folder.path(), arguments);
    assert_eq!(summary(&last), expected);
    assert_same(&path("whole.h5"), &path("k.h5"), "the last one");
    assert_eq!(files(folder.path(), "k.h5"), ["k.h5"]);
}

#[test]
fn files_that_never_got_their_name_are_removed() {
    let folder = folder();
    let path = |name: &str| folder.path().join(name);
    let mut ended = start(folder.path(), &["--version"]);
    ended.wait().expect("it ends");
    let stray = [
        format!(".a.h5.{}.tmp", ended.id()),
        ".a.h5.checkpoint.tmp".to_owned(),
        "a.h5.checkpoint".to_owned(),
        ".a.h5.journal".to_owned(),
    ];
    // Files of a running process and of another result, and one that the program did not write.
    let kept = [format!(".a.h5.{}.tmp", std::process::id()), format!(".b.h5.{}.tmp", ended.id()), ".a.h5.x.tmp".into()];
    for name in stray.iter().chain(&kept) {
        std::fs::write(path(name), "stray").expect("written");
    }
    let output = barwave(folder.path(), &["run", "plastic.toml", "-o", "a.h5"]);
    assert!(output.status.success(), "{}", message(&output));
    for name in &stray {
        assert_eq!(
            path(name).exists(),
            name == &format!(".a.h5.{}.tmp", ended.id()) && !Path::new("/proc/self").exists(),
            "{name}"
        );
    }
    assert!(kept.iter().all(|name| path(name).exists()));
}

#[test]
fn a_run_of_few_steps_and_millions_of_frames_stops_when_asked() {
    let folder = folder();
    let text = scene("kind = \"velocity\"\nvalue = -1", "kind = \"free\"", "", "")
        .replace("cells = 600", "cells = 100")
        .replace("2 ms", "100 us")
        .replace("frames = 50", "frames = 1000000");
    std::fs::write(folder.path().join("million.toml"), text).expect("written");
    for (name, arguments) in [("TERM", &[][..]), ("INT", &["--checkpoint", "100ms"])] {
        let child = start(folder.path(), &[&["run", "million.toml", "-o", "a.h5"], arguments].concat());
        while frames_in(&folder.path().join("a.h5")) == 0 {
            std::thread::sleep(Duration::from_millis(20));
        }
        std::thread::sleep(Duration::from_millis(300));
        let asked = Instant::now();
        signal(&child, name);
        let output = child.wait_with_output().expect("it ends");
        assert_eq!(output.status.code(), Some(130), "{}", message(&output));
        // An interruption takes about 20 ms beside the data that remain to be written; the rest is for machines under load.
        assert!(asked.elapsed() < Duration::from_secs(4), "{:?}", asked.elapsed());
        let file = ResultFile::open(&folder.path().join("a.h5")).expect("a result");
        assert_eq!(file.metadata().outcome, "interrupted");
        let frames = file.time().expect("times").len();
        assert!((1..1_000_000).contains(&frames), "{frames} frames");
        std::fs::remove_file(folder.path().join("a.h5")).expect("removed");
    }
}

/// Returns the size of a file, bytes; 0 if it does not exist.
fn frames_in(path: &Path) -> u64 {
    std::fs::metadata(path).map_or(0, |metadata| metadata.len())
}

/// Interrupts the run of a bar and returns its checkpoint.
fn interrupted(folder: &Path, output: &str) -> PathBuf {
    let child = start(folder, &["run", "long.toml", "-o", output, "--checkpoint", "1ms"]);
    while !folder.join(format!("{output}.checkpoint")).exists() {
        std::thread::sleep(Duration::from_millis(1));
    }
    signal(&child, "TERM");
    let ended = child.wait_with_output().expect("it ends");
    assert_eq!(ended.status.code(), Some(130), "{}", message(&ended));
    folder.join(format!("{output}.checkpoint"))
}

#[test]
fn what_cannot_be_resumed_is_one_error() {
    let folder = folder();
    let path = |name: &str| folder.path().join(name);
    let refused = |arguments: &[&str], words: &[&str]| {
        let output = barwave(folder.path(), &[&["run"], arguments].concat());
        let text = message(&output);
        assert_eq!(output.status.code(), Some(2), "{arguments:?}: {text}");
        assert_eq!((text.matches("error: ").count(), text.matches("\nhelp: ").count()), (1, 1), "{text}");
        for word in words {
            assert!(text.contains(word), "{arguments:?}: expected `{word}`: {text}");
        }
    };
    let solved = |name: &str, output: &str| {
        let output = barwave(folder.path(), &["run", name, "-o", output]);
        assert!(output.status.success(), "{}", message(&output));
    };
    let long = scene("kind = \"velocity\"\nvalue = -12", "kind = \"free\"", "", "").replace("2 ms", "20 ms");
    std::fs::write(path("long.toml"), long).expect("written");
    solved("long.toml", "done.h5");
    refused(&["--resume", "done.h5"], &["the run has ended", "`done`"]);
    refused(&["--resume", "none.h5"], &["no such file"]);
    std::fs::write(path("text.h5"), "no result").expect("written");
    refused(&["--resume", "text.h5"], &["not an HDF5 file"]);
    let foreign = unlocked().create(path("foreign.h5")).expect("a file");
    foreign.close().expect("closed");
    refused(&["--resume", "foreign.h5"], &["not a barwave result"]);

    let checkpoint = interrupted(folder.path(), "a.h5");
    let whole = std::fs::read(&checkpoint).expect("a checkpoint");
    for (arguments, what) in [
        (&["plastic.toml", "--resume", "a.h5"][..], "a scene cannot be used"),
        (&["--resume", "a.h5", "--set", "solve.cells=10"], "--set cannot be used"),
        (&["--resume", "a.h5", "-o", "b.h5"], "-o cannot be used"),
        (&["--resume", "a.h5", "--estimate-error"], "--estimate-error cannot be used"),
        (&["--resume", "a.h5", "--force"], "--force cannot be used"),
        (&["--resume", "a.h5", "--checkpoint", "0s"], "the interval 0 s is out of range"),
        (&["plastic.toml", "--checkpoint", "5 m"], "--checkpoint"),
    ] {
        refused(arguments, &[what]);
    }
    let mut damaged = whole.clone();
    let middle = damaged.len() / 2;
    damaged[middle] ^= 1;
    for bytes in [&damaged[..], &whole[..middle], b""] {
        std::fs::write(&checkpoint, bytes).expect("written");
        refused(&["--resume", "a.h5"], &["a.h5.checkpoint", "the checkpoint is damaged"]);
    }
    let text = String::from_utf8_lossy(&whole[..60]).into_owned();
    let line = text.lines().next().expect("a line");
    let later = [b"barwave checkpoint 99", &whole[line.len()..]].concat();
    std::fs::write(&checkpoint, later).expect("written");
    refused(&["--resume", "a.h5"], &["the checkpoint has version 99"]);
    let other = interrupted(folder.path(), "b.h5");
    std::fs::copy(&other, &checkpoint).expect("copied");
    refused(&["--resume", "a.h5"], &["is the checkpoint of another run"]);
    std::fs::remove_file(&checkpoint).expect("removed");
    refused(&["--resume", "a.h5"], &["there is no checkpoint", "--checkpoint 60s"]);
    // With its own checkpoint restored, it can be resumed.
    std::fs::write(&checkpoint, &whole).expect("written");
    let output = barwave(folder.path(), &["run", "--resume", "a.h5"]);
    assert!(output.status.success(), "{}", message(&output));
    assert_same(&path("done.h5"), &path("a.h5"), "after all");
}
