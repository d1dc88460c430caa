//! Failures around a run through the real binary: closed output, outputs that must not be replaced, full disks, special files.
#![cfg(unix)]

use crate::common::binary;
use crate::common::results::unlocked;

use std::fs::File;
use std::io::Write;
use std::path::Path;
use std::process::{Child, Command, Output, Stdio};
use std::time::{Duration, Instant};

use barwave::record::store::ResultFile;
use binary::barwave;

const SCENE: &str = "[bar]\nlength = 1\nmaterial = \"mild-steel\"\n[left]\nkind = \"velocity\"\nvalue = -1\n[right]\n\
                     kind = \"free\"\n[solve]\nuntil = \"50 us\"\ncells = 100\n";

/// Returns a folder with `s.toml`, a run of milliseconds, and `long.toml`, one of half a second and 14 MB.
fn folder() -> tempfile::TempDir {
    let folder = tempfile::tempdir().expect("a folder");
    let long = SCENE.replace("50 us", "20 ms").replace("cells = 100\n", "cells = 2000\n");
    std::fs::write(folder.path().join("s.toml"), SCENE).expect("written");
    std::fs::write(folder.path().join("long.toml"), long + "[record]\nframes = 400\ncells = 1000\n").expect("written");
    folder
}

/// Returns a command of the program in a folder.
fn program(folder: &Path, arguments: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_barwave"));
    command.args(arguments).current_dir(folder).env_remove("BARWAVE_MATERIALS").stdin(Stdio::null());
    command
}

/// Returns the output of a command, which must end within this time.
fn within_seconds(mut command: Command, seconds: u64) -> Output {
    let mut child: Child = command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().expect("it starts");
    let started = Instant::now();
    while child.try_wait().expect("a status").is_none() {
        if started.elapsed() > Duration::from_secs(seconds) {
            child.kill().expect("stopped");
            panic!("{command:?} took more than {seconds} s");
        }
        std::thread::sleep(Duration::from_millis(5));
    }
    child.wait_with_output().expect("its output")
}

fn message(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

/// Checks the exit code and that there is one error, which contains the words.
fn assert_fails(output: &Output, code: i32, words: &[&str]) {
    let text = message(output);
    assert_eq!(output.status.code(), Some(code), "{text}");
    assert_eq!(text.matches("error: ").count(), 1, "{text}");
    assert!(code != 2 || text.contains("\nhelp: "), "{text}");
    for word in words {
        assert!(text.contains(word), "expected `{word}`: {text}");
    }
}

fn mkfifo(path: &Path) {
    assert!(Command::new("mkfifo").arg(path).status().expect("mkfifo").success());
}

const COMMANDS: [&[&str]; 9] = [
    &["run", "s.toml", "-o", "a.h5"],
    &["run", "s.toml", "-o", "a.h5", "--json"],
    &["check", "s.toml"],
    &["new", "fresh"],
    &["plan", "s.toml"],
    &["report", "a.h5"],
    &["critical", "mild-steel"],
    &["compare", "mild-steel"],
    &["materials"],
];

#[test]
fn a_reader_that_has_gone_is_no_error() {
    let folder = folder();
    for arguments in COMMANDS {
        let (reader, writer) = std::io::pipe().expect("a pipe");
        drop(reader);
        let output =
            program(folder.path(), arguments).stdout(writer).stderr(Stdio::piped()).output().expect("it starts");
        assert_eq!((output.status.code(), message(&output)), (Some(0), String::new()), "{arguments:?}");
    }
}

#[test]
fn a_full_device_as_output_is_one_error() {
    if !Path::new("/dev/full").exists() {
        println!("skipped: this system has no /dev/full");
        return;
    }
    let folder = folder();
    assert!(barwave(folder.path(), &["run", "s.toml", "-o", "a.h5"]).status.success());
    for arguments in COMMANDS {
        let full = || File::options().write(true).open("/dev/full").expect("it opens");
        let output = program(folder.path(), arguments).stdout(full()).output().expect("it starts");
        if arguments.contains(&"--json") {
            let error: serde_json::Value = serde_json::from_slice(&output.stderr).expect("one JSON object");
            assert_eq!((output.status.code(), &error["error"]["file"]), (Some(1), &"stdout".into()), "{error}");
        } else {
            assert_fails(&output, 1, &["stdout: No space left on device", "\nhelp: redirect the output"]);
        }
        // If stderr is full as well, no message can be written.
        let _ = std::fs::remove_file(folder.path().join("fresh.toml"));
        let silent = program(folder.path(), arguments).stdout(full()).stderr(full()).status().expect("it starts");
        assert_eq!(silent.code(), Some(1), "{arguments:?}");
        let _ = std::fs::remove_file(folder.path().join("fresh.toml"));
    }
}

#[test]
fn nothing_but_files_is_replaced() {
    let folder = folder();
    let at = |name: &str| folder.path().join(name);
    assert!(barwave(folder.path(), &["run", "s.toml", "-o", "a.h5"]).status.success());
    for (name, what) in [("pipe", "is a named pipe"), ("folder", "is a folder"), ("link", "is a broken symbolic link")]
    {
        for extension in ["h5", "svg", "csv", "toml"] {
            let file = format!("{name}.{extension}");
            match name {
                "pipe" => mkfifo(&at(&file)),
                "folder" => std::fs::create_dir(at(&file)).expect("made"),
                _ => std::os::unix::fs::symlink("no/such/file", at(&file)).expect("made"),
            }
        }
        let file = |extension: &str| format!("{name}.{extension}");
        let (h5, svg, csv) = (file("h5"), file("svg"), file("csv"));
        for arguments in [
            &["run", "s.toml", "-o", &h5] as &[&str],
            &["run", "s.toml", "--force", "-o", &h5],
            &["report", "a.h5", "-o", &svg],
            &["compare", "mild-steel", "-o", &svg],
            &["compare", "mild-steel", "-o", &csv],
            &["cost", "s.toml", "--budget", "1s", "-o", &csv],
        ] {
            let before = at(arguments[arguments.len() - 1]).symlink_metadata().expect("it stands").file_type();
            let output = within_seconds(program(folder.path(), arguments), 20);
            assert_fails(&output, 2, &[what]);
            let after = at(arguments[arguments.len() - 1]).symlink_metadata().expect("it stands").file_type();
            assert_eq!(before, after, "{arguments:?}");
        }
        // `new` refuses an existing path of any kind.
        assert_fails(&barwave(folder.path(), &["new", name]), 2, &["exists already"]);
    }
    assert_fails(&barwave(folder.path(), &["run", "s.toml", "-o", "-"]), 2, &["-o", "standard output"]);
    assert!(!at("-").exists());
}

#[test]
fn a_result_replaces_results_and_nothing_else_unless_forced() {
    let folder = folder();
    let path = |name: &str| folder.path().join(name);
    std::fs::write(path("text.h5"), "my notes").expect("written");
    hdf5_file(&path("foreign.h5"));
    for name in ["text.h5", "foreign.h5"] {
        let before = std::fs::read(path(name)).expect("a file");
        let refused = barwave(folder.path(), &["run", "s.toml", "-o", name]);
        assert_fails(&refused, 2, &["already exists", "--force"]);
        assert_eq!(std::fs::read(path(name)).expect("a file"), before, "{name}");
        let arguments = ["run", "s.toml", "-o", name, "--quiet"];
        assert!(barwave(folder.path(), &[&arguments[..], &["--force"]].concat()).status.success());
        // It is now a result file, which the next run may replace.
        assert!(barwave(folder.path(), &arguments).status.success());
        assert_eq!(ResultFile::open(&path(name)).expect("a result").metadata().outcome, "done");
    }
    // An empty file may be replaced, since it has no content; a link is written through.
    std::fs::write(path("empty.h5"), "").expect("written");
    std::os::unix::fs::symlink("empty.h5", path("link.h5")).expect("made");
    assert!(barwave(folder.path(), &["run", "s.toml", "-o", "link.h5"]).status.success());
    assert!(path("link.h5").symlink_metadata().expect("it stands").is_symlink());
    assert!(ResultFile::open(&path("empty.h5")).is_ok());
}

/// Creates an HDF5 file that barwave did not write.
fn hdf5_file(path: &Path) {
    let file = unlocked().create(path).expect("a file");
    file.new_dataset::<f64>().shape(3).create("a").expect("a dataset").write_raw(&[1.0, 2.0, 3.0]).expect("written");
}

#[test]
fn default_outputs_of_different_runs_differ() {
    let folder = folder();
    let output_of = |arguments: &[&str]| {
        let output = barwave(folder.path(), &[&["run", "--json"], arguments].concat());
        assert_eq!(output.status.code(), Some(0), "{}", message(&output));
        let summary: serde_json::Value = serde_json::from_slice(&output.stdout).expect("one JSON value");
        let path = summary["output"].as_str().expect("a path").to_owned();
        assert!(folder.path().join(&path).is_file(), "{path}");
        path
    };
    for name in ["a-1.5.toml", "a-1.6.toml"] {
        std::fs::copy(folder.path().join("s.toml"), folder.path().join(name)).expect("copied");
    }
    std::fs::create_dir(folder.path().join("runs")).expect("a folder");
    assert_eq!(output_of(&["a-1.5.toml"]), "runs/out/a-1.5.h5");
    assert_eq!(output_of(&["a-1.6.toml"]), "runs/out/a-1.6.h5");
    assert_eq!(output_of(&["s.toml", "--set", "solve.cells=50"]), "runs/out/s_solve.cells=50.h5");
    assert_eq!(
        output_of(&["s.toml", "--set", "solve.cells=50", "--set", "left.value=-2"]),
        "runs/out/s_solve.cells=50_left.value=-2.h5"
    );
    let [feet, metres] =
        ["\"-2 ft/s\"", "\"-2 m/s\""].map(|v| output_of(&["s.toml", "--set", &format!("left.value={v}")]));
    assert!(feet.starts_with("runs/out/s_left.value=--2-ft-s-_") && feet.len() < 60, "{feet}");
    let tail = |path: &str| path.rsplit('_').next().map(str::to_owned);
    assert_ne!(tail(&feet), tail(&metres));
    let titles = [0, 1].map(|k| format!("title={}{k}", "x".repeat(300)));
    let [one, other] = titles.map(|title| output_of(&["s.toml", "--set", &title]));
    assert!(one != other && one.len() < 200, "{one}");
}

/// Starts the long run and waits until its first frames are on the disk.
fn start_long(folder: &Path, output: &str) -> Child {
    let mut command =
        program(folder, &["run", "long.toml", "--quiet", "-o", output, "--set", "solve.until=\"200 ms\""]);
    let child = command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().expect("it starts");
    let started = Instant::now();
    while !folder.join(output).is_file() {
        assert!(started.elapsed() < Duration::from_secs(20), "no file");
        std::thread::sleep(Duration::from_millis(2));
    }
    child
}

#[test]
fn a_folder_that_is_gone_is_an_error() {
    let folder = folder();
    std::fs::create_dir(folder.path().join("out")).expect("made");
    let child = start_long(folder.path(), "out/a.h5");
    std::thread::sleep(Duration::from_millis(50));
    std::fs::remove_dir_all(folder.path().join("out")).expect("removed");
    let output = child.wait_with_output().expect("its output");
    assert_fails(&output, 1, &["out/a.h5", "removed, moved or replaced during the run"]);
}

#[test]
fn two_runs_to_one_file_are_an_error_of_the_second() {
    let folder = folder();
    let mut first = start_long(folder.path(), "a.h5");
    std::thread::sleep(Duration::from_millis(50));
    let second = barwave(folder.path(), &["run", "s.toml", "-o", "a.h5"]);
    assert_fails(&second, 2, &["a.h5", "is being written by another run"]);
    assert_fails(&barwave(folder.path(), &["report", "a.h5"]), 2, &["locked by the run that writes it"]);
    first.kill().expect("stopped");
    first.wait().expect("ended");
    // The file of a killed run can be replaced.
    assert!(barwave(folder.path(), &["run", "s.toml", "-o", "a.h5", "--quiet"]).status.success());
}

#[test]
fn of_runs_that_start_together_one_at_most_succeeds() {
    let folder = folder();
    for round in 0..10 {
        let name = format!("{round}.h5");
        let start = || {
            let mut command =
                program(folder.path(), &["run", "s.toml", "--quiet", "-o", &name, "--set", "solve.until=\"5 ms\""]);
            command.stderr(Stdio::piped()).spawn().expect("it starts")
        };
        let outputs = [start(), start()].map(|child| child.wait_with_output().expect("its output"));
        let done = outputs.iter().filter(|output| output.status.success()).count();
        let texts: Vec<String> = outputs.iter().map(message).collect();
        let file = ResultFile::open(&folder.path().join(&name));
        // Runs one after the other do not conflict.
        assert!(done >= 1 || texts.iter().all(|text| text.contains("error: ")), "{texts:?}");
        assert!(done == 0 || file.is_ok_and(|file| file.metadata().outcome == "done"), "{texts:?}");
    }
}

/// Checks that the frames of a run stopped by the disk are stored, and that its message says so.
fn assert_kept(path: &Path, output: &Output, words: &[&str]) {
    assert_fails(output, 1, words);
    let file = ResultFile::open(path).expect("a result file");
    let frames = file.time().expect("times").len();
    assert!((10..400).contains(&frames), "{frames} frames");
    assert_eq!(file.metadata().outcome, "stopped");
    let field = file.field(barwave::record::Field::Stress, 0..frames).expect("a field");
    assert!(field.iter().all(|stress| stress.is_finite()));
    let svg = path.with_extension("svg").file_name().map(|name| name.to_string_lossy().into_owned()).expect("a name");
    let elsewhere = tempfile::tempdir().expect("a folder");
    let drawn = barwave(elsewhere.path(), &["report", path.to_str().expect("UTF-8"), "-o", &svg]);
    assert_eq!(drawn.status.code(), Some(0), "{}", message(&drawn));
}

#[test]
fn a_file_that_may_not_grow_keeps_its_frames() {
    let folder = folder();
    let script = format!("ulimit -f 6000; exec '{}' run long.toml --quiet -o a.h5", env!("CARGO_BIN_EXE_barwave"));
    let output = Command::new("bash").args(["-c", &script]).current_dir(folder.path()).output().expect("bash");
    assert_kept(
        &folder.path().join("a.h5"),
        &output,
        &["largest size allowed", "written before are kept, up to t = ", "help: make room there"],
    );
}

/// The same of figures: one error, and no file under the temporary name.
#[test]
fn a_figure_that_may_not_grow_leaves_nothing() {
    let folder = folder();
    assert!(barwave(folder.path(), &["run", "s.toml", "--quiet", "-o", "a.h5"]).status.success());
    let script = format!("ulimit -f 8; exec '{}' report a.h5 -o a.svg", env!("CARGO_BIN_EXE_barwave"));
    let output = Command::new("bash").args(["-c", &script]).current_dir(folder.path()).output().expect("bash");
    assert_fails(&output, 1, &["a.svg: cannot write it: ", "largest size allowed", "\nhelp: raise the limit"]);
    let left = std::fs::read_dir(folder.path()).expect("a folder").flatten().map(|entry| entry.file_name());
    assert!(!left.into_iter().any(|name| name.to_string_lossy().contains("svg")));
}

#[test]
fn a_place_where_nothing_may_be_written_is_an_error_with_help() {
    let folder = folder();
    // /proc refuses new files to every user.
    let output = barwave(folder.path(), &["new", "/proc/barwave/a"]);
    assert_fails(&output, 1, &["cannot write it: ", "\nhelp: choose a folder in which files may be written"]);
}

#[test]
fn interrupted_hard_cases_say_so() {
    use std::io::{BufRead as _, BufReader, Read as _};
    let folder = folder();
    let mut command = program(folder.path(), &["stability"]);
    let mut child = command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().expect("it starts");
    // The first run has ended, and later ones take seconds.
    let mut lines = BufReader::new(child.stdout.take().expect("a pipe"));
    lines.read_line(&mut String::new()).expect("a line");
    let sent = Command::new("kill").args(["-INT", &child.id().to_string()]).status();
    assert!(sent.is_ok_and(|status| status.success()), "still under way");
    let mut text = String::new();
    child.stderr.take().expect("a pipe").read_to_string(&mut text).expect("text");
    assert_eq!(child.wait().expect("it ends").code(), Some(130), "{text}");
    assert!(text.contains("interrupted: nothing is kept"), "{text}");
}

#[test]
fn figures_replace_figures_and_nothing_else_unless_forced() {
    let folder = folder();
    let path = |name: &str| folder.path().join(name);
    assert!(barwave(folder.path(), &["run", "s.toml", "--quiet", "-o", "a.h5"]).status.success());
    let compared = ["compare", "mild-steel", "copper-annealed"];
    let cases: [(&[&str], &[&str]); 3] = [
        (&["report", "a.h5"], &["svg", "png", "pdf", "html"]),
        (&compared, &["svg", "png", "pdf", "html", "csv"]),
        (&["compare", "a.h5", "a.h5"], &["svg", "csv"]),
    ];
    for (arguments, endings) in cases {
        for ending in endings {
            let name = format!("{}.{ending}", arguments.concat());
            std::fs::write(path(&name), "my notes").expect("written");
            let with = |more: &[&str]| barwave(folder.path(), &[arguments, &["-o", &name], more].concat());
            assert_fails(&with(&[]), 2, &["exists already and was not written by barwave", "--force"]);
            assert_eq!(std::fs::read(path(&name)).expect("a file"), b"my notes", "{name}");
            assert!(with(&["--force"]).status.success(), "{name}");
            // It is now a figure or table of barwave, which may be replaced.
            assert!(with(&[]).status.success(), "{name}");
        }
    }
}

/// File system of 6 MB, unmounted when the value is dropped.
struct SmallDisk<'a>(&'a Path);

impl Drop for SmallDisk<'_> {
    fn drop(&mut self) {
        let _ = Command::new("umount").arg("-l").arg(self.0).status();
    }
}

#[test]
fn a_full_disk_keeps_the_frames() {
    let folder = folder();
    let disk = folder.path().join("disk");
    std::fs::create_dir(&disk).expect("made");
    let mount =
        Command::new("mount").args(["-t", "tmpfs", "-o", "size=6m", "tmpfs"]).arg(&disk).stderr(Stdio::null()).status();
    if !mount.is_ok_and(|status| status.success()) {
        println!("skipped: a small file system can be mounted by root only");
        return;
    }
    let disk = SmallDisk(&disk);
    let output = barwave(folder.path(), &["run", "long.toml", "--quiet", "-o", "disk/a.h5"]);
    assert_kept(
        &disk.0.join("a.h5"),
        &output,
        &["the disk is full", "written before are kept, up to t = ", "help: make room there"],
    );
}

#[test]
fn a_result_takes_no_more_of_the_disk_than_it_holds() {
    use std::os::unix::fs::MetadataExt;
    let folder = folder();
    assert!(barwave(folder.path(), &["run", "s.toml", "--quiet", "-o", "a.h5"]).status.success());
    let metadata = folder.path().join("a.h5").metadata().expect("a file");
    assert!(metadata.len() < 500_000 && metadata.blocks() * 512 < 600_000, "{} {}", metadata.len(), metadata.blocks());
}

#[test]
fn a_scene_from_a_pipe_is_read() {
    let folder = folder();
    let path = folder.path();
    for arguments in
        [&["run", "-", "--quiet", "-o", "a.h5"] as &[&str], &["check", "-"], &["plan", "-"], &["check", "/dev/stdin"]]
    {
        let mut child = program(path, arguments)
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .expect("it starts");
        child.stdin.take().expect("a pipe").write_all(SCENE.as_bytes()).expect("written");
        let output = child.wait_with_output().expect("its output");
        assert_eq!(output.status.code(), Some(0), "{arguments:?}: {}", message(&output));
    }
    let script = format!("'{}' run <(cat s.toml) --quiet -o b.h5", env!("CARGO_BIN_EXE_barwave"));
    assert!(Command::new("bash").args(["-c", &script]).current_dir(path).status().expect("bash").success());
    let script = format!("'{}' run <(cat s.toml) --quiet", env!("CARGO_BIN_EXE_barwave"));
    assert!(Command::new("bash").args(["-c", &script]).current_dir(path).status().expect("bash").success());
    assert!(["a.h5", "b.h5", "scene.h5"].iter().all(|name| path.join(name).is_file()));
    // The name of a run that has no file, and errors in a file.
    let mut child =
        program(path, &["run", "-"]).stdin(Stdio::piped()).stderr(Stdio::piped()).spawn().expect("it starts");
    child.stdin.take().expect("a pipe").write_all(SCENE.replace("100\n", "1\n").as_bytes()).expect("written");
    assert_fails(&child.wait_with_output().expect("its output"), 2, &["--> stdin:11:9", "1 is out of range"]);
    assert_fails(&barwave(path, &["cost", "-"]), 2, &["can be read only once"]);
}
