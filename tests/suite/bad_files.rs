//! Files that are no valid scenes, tables or results, through the real binary: each ends in bounded time with one clear error.
#![cfg(unix)]

use crate::common::binary;

use std::path::Path;
use std::process::{Command, Output};
use std::time::{Duration, Instant};

use binary::barwave;

const SCENE: &str = "[bar]\nlength = 1\nmaterial = MATERIAL\n[left]\nkind = \"velocity\"\nDRIVE\n[right]\nkind = \"free\"\n\
                     [solve]\nuntil = \"50 us\"\ncells = 100\n";
const CURVE: &str = "{ density = 7800, modulus = 2e11, beyond = \"extend\", curve = { csv = \"FILE\" } }";

/// Returns a scene that reads its curve, or the history of an end, from this file.
fn scene(of_curve: bool, file: &str) -> String {
    let (material, drive) = if of_curve {
        (CURVE.replace("FILE", file), "value = -1".to_owned())
    } else {
        ("\"mild-steel\"".to_owned(), format!("csv = \"{file}\""))
    };
    // The rows of a curve are not velocities, but can be stresses.
    let kind = if of_curve { "velocity" } else { "stress" };
    SCENE.replace("MATERIAL", &material).replace("DRIVE", &drive).replace("velocity", kind)
}

fn message(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

/// Checks that the program exits with code 2 within some seconds, with one error that has help and contains the words.
fn assert_refused(folder: &Path, arguments: &[&str], words: &[&str]) {
    let started = Instant::now();
    let limited = "ulimit -v 4000000; exec \"$@\"";
    let mut command = Command::new("timeout");
    command.args(["20", "bash", "-c", limited, "bash", env!("CARGO_BIN_EXE_barwave")]).args(arguments);
    let output = command.current_dir(folder).env_remove("BARWAVE_MATERIALS").output().expect("it starts");
    let text = message(&output);
    assert_eq!(output.status.code(), Some(2), "{arguments:?}: {text}");
    assert!(started.elapsed() < Duration::from_secs(10), "{arguments:?}: {:?}", started.elapsed());
    assert_eq!(text.matches("error: ").count(), 1, "{text}");
    assert!(text.contains("\nhelp: ") && text.len() < 4000, "{text}");
    for word in words {
        assert!(text.contains(word), "{arguments:?}: expected `{word}`: {text}");
    }
}

#[test]
fn what_is_no_text_file_is_refused_in_bounded_time_and_memory() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = |name: &str| folder.path().join(name);
    assert!(Command::new("mkfifo").arg(path("pipe")).status().expect("mkfifo").success());
    std::fs::create_dir(path("folder")).expect("made");
    std::fs::File::create(path("large")).and_then(|file| file.set_len(1 << 30)).expect("made");
    std::fs::write(path("zeros"), [b'a', 0, 0, 0]).expect("written");
    std::fs::write(path("line"), "a".repeat(60_000_000)).expect("written");
    for (name, words) in [
        ("pipe", "it is a named pipe (FIFO)"),
        ("folder", "it is a folder"),
        ("large", "is too large: 1024 MiB"),
        ("zeros", "zero byte on line 1"),
        ("/dev/zero", "it is a device"),
        ("nowhere", "no such file"),
    ] {
        for command in ["run", "check", "plan"] {
            assert_refused(folder.path(), &[command, name], &[name, words]);
        }
        for of_curve in [true, false] {
            std::fs::write(path("scene.toml"), scene(of_curve, name)).expect("written");
            let key = if of_curve { "bar.material.curve.csv" } else { "left.csv" };
            assert_refused(folder.path(), &["check", "scene.toml"], &[key, name, words]);
        }
    }
    assert_refused(folder.path(), &["check", "line"], &["expected `=`", "..."]);
}

#[test]
fn tables_of_spreadsheets_and_instruments_are_read_or_refused_with_the_cause() {
    let folder = tempfile::tempdir().expect("a folder");
    let write = |of_curve: bool, bytes: &[u8]| {
        std::fs::write(folder.path().join("t.csv"), bytes).expect("written");
        std::fs::write(folder.path().join("scene.toml"), scene(of_curve, "t.csv")).expect("written");
    };
    let right: [&[u8]; 9] = [
        b"0.001,200e6\n0.02,300e6\n",
        b"\xEF\xBB\xBFstrain,stress\r\n0.001,200e6\r\n0.02,300e6\r\n",
        b"0.001;200e6\n0.02;300e6\n",
        b"0.001\t200e6\n0.02\t300e6\n",
        b"0.001 200e6\n0.02 300e6\n",
        b"strain;b\n0,001;199,5e6\n0,02;300e6\n",
        b"0,001\t200e6\n0,02\t300e6\n",
        b"\"0,001\",200e6\n\"0,02\",300e6\n",
        b"0.001,200e6,,\n\n# end\n0.02,300e6,,\n",
    ];
    for of_curve in [true, false] {
        for bytes in right {
            // The first column of a history is time; its heading says so.
            let heading = if of_curve { "strain" } else { "time" };
            let text = String::from_utf8_lossy(bytes).replace("strain", heading);
            write(of_curve, text.as_bytes());
            let output = barwave(folder.path(), &["check", "scene.toml"]);
            assert_eq!(output.status.code(), Some(0), "{text}: {}", message(&output));
        }
        for (bytes, words) in [
            (
                b"# 20 \xB0C\n0.001,200e6\n" as &[u8],
                &["t.csv", "not UTF-8", "line 1, column 6", "0xB0, which is `\u{b0}`"] as &[&str],
            ),
            (b"\xFF\xFE0\0,\x001\0", &["t.csv", "is UTF-16 text"]),
            (b"0.001;200,5\n0.02;300\n", &["t.csv:1", "`0.001` has a point and `200,5` a comma"]),
            (b"1;1,234\n2;2,345\n", &["t.csv:1", "`1,234` can be 1.234 or 1234"]),
            (b"0,001,200\n0,02,300\n", &["t.csv:1", "3 columns", "allowed: 2 columns", "semicolons"]),
            (b"0.001 about 200e6\n", &["t.csv:1", "1 column", "comma, a semicolon, a tab or blanks"]),
            (b"0.001,200e6\n0.02,3o0\n", &["t.csv:2", "3o0"]),
        ] {
            write(of_curve, bytes);
            assert_refused(folder.path(), &["check", "scene.toml"], words);
        }
        // Volts were read as pascals.
        for stress in ["stress_V", "stress (V)", "stress [V]"] {
            let abscissa = if of_curve { "strain" } else { "time" };
            write(of_curve, format!("{abscissa},{stress}\n0.001,200e6\n0.02,300e6\n").as_bytes());
            assert_refused(folder.path(), &["check", "scene.toml"], &["t.csv:1", "unknown unit `V`"]);
        }
    }
}

#[test]
fn a_decimal_comma_gives_the_same_curve_as_a_point() {
    let folder = tempfile::tempdir().expect("a folder");
    let shown = |text: &str| {
        std::fs::write(folder.path().join("t.csv"), text).expect("written");
        let material = "name = \"m\"\ndensity = 7800\n[curve]\ncsv = \"t.csv\"\n";
        std::fs::write(folder.path().join("m.toml"), material).expect("written");
        let output = barwave(folder.path(), &["materials", "show", "m.toml", "--json"]);
        assert_eq!(output.status.code(), Some(0), "{}", message(&output));
        output.stdout
    };
    let point = shown("strain,stress_MPa\n0.001,200.5\n0.02,300\n");
    assert_eq!(shown("strain;stress (MPa)\n0,001;200,5\n0,02;300\n"), point);
    assert_eq!(shown("\u{feff}strain\tstress_MPa\r\n0,001\t200,5\r\n0,02\t300\r\n"), point);
}

#[test]
fn what_would_take_too_much_is_refused_with_its_size() {
    let folder = tempfile::tempdir().expect("a folder");
    let text = SCENE.replace("MATERIAL", "\"mild-steel\"").replace("DRIVE", "value = -1");
    std::fs::write(folder.path().join("s.toml"), &text).expect("written");
    let gauges = (0..3000).map(|i| format!("g{i} = 0.5")).collect::<Vec<_>>().join("\n");
    std::fs::write(folder.path().join("gauges.toml"), text.clone() + "[record.gauges]\n" + &gauges).expect("written");
    let set = |one: &'static str| ["run", "s.toml", "-o", "a.h5", "--set", one];
    assert_refused(
        folder.path(),
        &set("solve.cells=1e8"),
        &["solve.cells", "100000000", "9.3 GiB of memory", "cells <= 10000000"],
    );
    assert_refused(folder.path(), &set("record.cells=1e9"), &["record.cells", "93.1 GiB of memory"]);
    assert_refused(folder.path(), &set("record.frames=1e12"), &["record.frames", "GiB", "frames <= 10000000"]);
    let mut frames = set("record.frames=1e7").to_vec();
    frames.extend(["--set", "record.cells=1000"]);
    assert_refused(folder.path(), &frames, &["record.frames", "224 GiB", "at most 64 GiB"]);
    assert_refused(folder.path(), &set("record.every=\"1e-17 s\""), &["record.every", "frames"]);
    assert_refused(
        folder.path(),
        &["run", "gauges.toml", "-o", "a.h5"],
        &["record.gauges", "3000 gauges", "GiB", "at most 1000"],
    );
    assert_refused(
        folder.path(),
        &["run", "s.toml", "--threads", "1000000"],
        &["--threads", "1953 GiB", "threads <= 1024"],
    );
    let environment = ["-c", "RAYON_NUM_THREADS=1000000 exec \"$0\" check s.toml", env!("CARGO_BIN_EXE_barwave")];
    let output = Command::new("bash").args(environment).current_dir(folder.path()).output().expect("bash");
    assert!(output.status.code() == Some(2) && message(&output).contains("RAYON_NUM_THREADS"), "{}", message(&output));
    assert!(!folder.path().join("a.h5").exists());
    // A million cells are allowed.
    let million = ["run", "s.toml", "--quiet", "-o", "a.h5", "--set", "solve.cells=1e6", "--set", "solve.until=1e-9"];
    let output = barwave(folder.path(), &[&million[..], &["--set", "record.frames=2"]].concat());
    assert_eq!(output.status.code(), Some(0), "{}", message(&output));
}

/// Messages use the terms of users, not those of the TOML parser.
#[test]
fn the_words_of_the_parser_reach_nobody() {
    let folder = tempfile::tempdir().expect("a folder");
    let text = SCENE.replace("DRIVE", "value = -1");
    let material = |table: &str| {
        let inline = format!("{{ density = 7800, modulus = 2e11, beyond = \"extend\", curve = {table} }}");
        text.replace("MATERIAL", &inline)
    };
    let steel = text.replace("MATERIAL", "\"mild-steel\"");
    let cases = [
        (material("{ table = [[0.001]] }"), "found a list of 1, expected a row [strain, stress]"),
        (material("{ table = [[0.001, 2e8, 3]] }"), "found a list of 3, expected a row [strain, stress]"),
        (material("{ table = [0.001, 2e8] }"), "found floating point `0.001`, expected a row [strain, stress]"),
        (material("[]"), "found a list, expected a table such as { table ="),
        (material("[[1]]"), "found a list, expected a table such as"),
        (steel.clone() + "[record]\ngauges = 3\n", "found integer `3`, expected a table"),
        (
            steel.clone() + "[record]\ngauges = 99999999999999999999\n",
            "found integer `99999999999999999999`, expected a table",
        ),
        (steel.clone() + "[effects]\nrate = \"fast\"\n", "found string \"fast\", expected \"material\""),
        (steel.clone() + "[effects]\nhardening = { mixed = [] }\n", "expected"),
        (steel.replace("[left]\nkind = \"velocity\"\nvalue = -1", "[left]\nvalue = -1"), "`kind` is missing"),
        (steel.replace("[bar]\n", "[bar]\n[bar]\n"), "duplicate key"),
    ];
    for (scene, words) in cases {
        std::fs::write(folder.path().join("s.toml"), scene).expect("written");
        assert_refused(folder.path(), &["check", "s.toml"], &["s.toml:", words]);
        let text = message(&barwave(folder.path(), &["check", "s.toml"]));
        for jargon in
            ["invalid length", "invalid type", "tuple", "untagged", "missing field", "struct", "i128", "a map"]
        {
            assert!(!text.contains(jargon), "`{jargon}`: {text}");
        }
    }
}

/// Returns a small result in a folder of its own, and its path.
fn result() -> (tempfile::TempDir, std::path::PathBuf) {
    let folder = tempfile::tempdir().expect("a folder");
    let text = SCENE.replace("MATERIAL", "\"mild-steel\"").replace("DRIVE", "value = -1");
    std::fs::write(folder.path().join("s.toml"), text + "[record]\nframes = 5\ngauges = { a = 0.5 }\n")
        .expect("written");
    let output = barwave(folder.path(), &["run", "s.toml", "-o", "a.h5", "--quiet"]);
    assert!(output.status.success(), "{}", message(&output));
    let path = folder.path().join("a.h5");
    (folder, path)
}

#[test]
fn results_that_were_cut_off_are_not_called_locked() {
    let (folder, path) = result();
    let whole = std::fs::read(&path).expect("a result");
    for length in [0, 7, 8, 50, 96, 100, 512, 2048, whole.len() / 2, whole.len() - 1] {
        std::fs::write(&path, &whole[..length]).expect("written");
        assert_refused(folder.path(), &["report", "a.h5", "-o", "a.svg"], &["a.h5"]);
        let text = message(&barwave(folder.path(), &["report", "a.h5", "-o", "a.svg"]));
        assert!(!text.contains("lock"), "{length} bytes: {text}");
        let cut = if length < 8 { "not an HDF5 file" } else { "truncated" };
        assert!(text.contains(cut), "{length} bytes: {text}");
    }
}

/// Every dataset in turn is missing, or has another shape, including shapes too large for any memory.
#[test]
fn damaged_results_are_one_error_and_no_allocation() {
    let (folder, path) = result();
    let whole = std::fs::read(&path).expect("a result");
    let shapes: [Option<&[usize]>; 6] =
        [None, Some(&[]), Some(&[3]), Some(&[2, 3, 4]), Some(&[1_000_000_000]), Some(&[1_000_000_000, 1000])];
    let mut refused = 0;
    for name in [
        "time",
        "x",
        "stress",
        "fronts/origin",
        "fronts/speed",
        "ends/left/time",
        "gauges/a/stress",
        "ledger/time",
        "audit/effect",
        "material/mild-steel/strain",
    ] {
        for shape in shapes {
            // A new file, since a program started by another test at the same time inherits the old one with its lock.
            std::fs::remove_file(&path).expect("a result");
            std::fs::write(&path, &whole).expect("written");
            reshape(&path, name, shape);
            for output in ["a.svg", "a.html"] {
                let arguments = ["report", "a.h5", "-o", output];
                let limited = ["-c", "ulimit -v 4000000; exec \"$@\"", "bash", env!("CARGO_BIN_EXE_barwave")];
                let drawn = Command::new("bash")
                    .args(limited)
                    .args(arguments)
                    .current_dir(folder.path())
                    .output()
                    .expect("bash");
                let text = message(&drawn);
                let code = drawn.status.code();
                assert!(code == Some(0) || code == Some(2), "{name} {shape:?}: {code:?} {text}");
                assert!(!text.contains("H5"), "a function of the HDF5 library: {text}");
                let errors = usize::from(code == Some(2));
                assert_eq!(
                    (text.matches("error: ").count(), text.matches("help: ").count()),
                    (errors, errors),
                    "{text}"
                );
                refused += errors;
            }
        }
    }
    // Datasets that a report does not use may be invalid.
    assert!(refused > 60, "{refused}");
}

/// The HDF5 library allocates as many bytes as the stated length of a text before it looks for the text. A damaged length causes one error, whether
/// or not the memory is available.
#[test]
fn a_damaged_length_of_a_text_is_one_error() {
    let (folder, path) = result();
    let at = {
        let file = hdf5::File::open(&path).expect("a result");
        file.dataset("fronts/origin").expect("names").offset().expect("contiguous") as usize
    };
    let mut bytes = std::fs::read(&path).expect("a result");
    bytes[at..at + 4].copy_from_slice(&0x7ff8_0000_u32.to_le_bytes());
    std::fs::remove_file(&path).expect("a result");
    std::fs::write(&path, &bytes).expect("written");
    for kilobytes in [1_500_000, 5_000_000] {
        let limited = format!("ulimit -v {kilobytes}; exec \"$@\"");
        let arguments = ["-c", &limited, "bash", env!("CARGO_BIN_EXE_barwave"), "report", "a.h5", "-o", "a.svg"];
        let drawn = Command::new("bash").args(arguments).current_dir(folder.path()).output().expect("bash");
        let text = message(&drawn);
        assert_eq!((drawn.status.code(), text.matches("error: ").count()), (Some(2), 1), "{text}");
        assert!(text.contains("the result file is damaged"), "{text}");
    }
}

/// A heap of texts with a free-space size of 0, in which the HDF5 library would loop without end, causes one error.
#[test]
fn a_heap_without_an_end_is_one_error() {
    let (folder, path) = result();
    let mut bytes = std::fs::read(&path).expect("a result");
    let number =
        |bytes: &[u8], at: usize| u64::from_le_bytes(bytes[at..at + 8].try_into().expect("eight bytes")) as usize;
    // Free space of the first heap that has any.
    let heaps = (0..bytes.len() - 8).filter(|&at| bytes[at..at + 8] == *b"GCOL\x01\0\0\0");
    let free = heaps.filter_map(|heap| {
        let (mut at, end) = (heap + 16, heap + number(&bytes, heap + 8));
        while at + 16 <= end && bytes[at..at + 2] != [0, 0] {
            at += 16 + number(&bytes, at + 8).next_multiple_of(8);
        }
        (at + 16 <= end).then_some(at)
    });
    let at = free.min().expect("a heap with free space");
    bytes[at + 8..at + 16].fill(0);
    std::fs::write(&path, &bytes).expect("written");
    let text = message(&barwave(folder.path(), &["report", "a.h5", "-o", "a.svg"]));
    assert!(text.contains("a list of texts in it has no end") && text.matches("error: ").count() == 1, "{text}");
}

/// Replaces a dataset by one of numbers with this shape, or removes it.
fn reshape(path: &Path, name: &str, shape: Option<&[usize]>) {
    let file = hdf5::File::open_rw(path).expect("a result");
    file.unlink(name).expect("it was there");
    let Some(shape) = shape else { return };
    let builder = file.new_dataset::<f64>();
    let made = if shape.iter().product::<usize>() > 1000 {
        builder.chunk(vec![1000; shape.len()]).shape(shape).create(name)
    } else {
        builder.shape(shape).create(name)
    };
    made.expect("a dataset");
}
