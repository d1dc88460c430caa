//! The complete message of every kind of invalid input, as users see it. `BARWAVE_REWRITE=1 cargo test --test suite bad_inputs::` rewrites
//! `tests/bad_inputs/*.txt`; check the difference before committing it.

use crate::common::binary;

use std::path::Path;

use binary::barwave;

const STEEL: &str = "density = 7800\nmodulus = \"200 GPa\"\nbeyond = \"extend\"\n[curve]\ntable = [[0.001, \"200 MPa\"], [0.1, \"400 MPa\"]]\n";
const SCENE: &str = "[bar]\nlength = \"1 m\"\narea = \"1 cm^2\"\nmaterial = \"mild-steel\"\n\n[left]\nkind = \"velocity\"\n\
                     value = \"-3 m/s\"\n\n[right]\nkind = \"free\"\n\n[effects]\nhardening = \"isotropic\"\n\n[solve]\nuntil = \"20 us\"\n\
                     cells = 100\n\n[record]\nframes = 5\ngauges = { middle = \"0.5 m\" }\n";

/// Text of the scene that is replaced, and its replacement.
const SCENES: &[(&str, &str)] = &[
    ("[bar]", "[baar]"),
    ("length = \"1 m\"\n", ""),
    ("\"1 m\"", "\"1 kg\""),
    ("\"1 m\"", "\"-1 m\""),
    ("\"1 m\"", "\"1,5 m\""),
    ("\"1 m\"", "\"1 furlong\""),
    ("\"1 m\"", "true"),
    ("\"1 m\"", "nan"),
    ("\"1 m\"", "\"1 m"),
    ("\"1 cm^2\"", "\"1 cm\""),
    ("\"1 cm^2\"", "[[0, 1]]"),
    ("\"mild-steel\"", "\"mild-stel\""),
    ("\"mild-steel\"", "\"no/such/file.toml\""),
    ("\"mild-steel\"", "[1]"),
    ("\"mild-steel\"", "{ density = 7800, modulus = 2e11, beyond = \"extend\", curve = { table = [[1]] } }"),
    ("\"mild-steel\"", "{ density = 7800, modulus = 2e11, beyond = \"extend\", curve = [[0.001, 2e8], [0.1, 4e8]] }"),
    ("hardening = \"isotropic\"", "heat = [0.9]"),
    ("kind = \"velocity\"\n", ""),
    ("\"velocity\"", "\"velocty\""),
    ("\"velocity\"", "\"stress\""),
    ("value = \"-3 m/s\"", "history = [[0, 1, 2]]"),
    ("value = \"-3 m/s\"", "history = [[1, 1], [0, 2]]"),
    ("value = \"-3 m/s\"", "csv = \"nowhere.csv\""),
    ("value = \"-3 m/s\"\n", ""),
    ("[right]\nkind = \"free\"\n", ""),
    ("\"isotropic\"", "{ mixed = 2 }"),
    ("\"isotropic\"", "{ armstrong-frederick = { C = \"30 GPa\" } }"),
    ("\"isotropic\"", "3"),
    ("hardening", "hardning"),
    ("until = \"20 us\"\n", ""),
    ("\"20 us\"", "0"),
    ("cells = 100", "cells = 0.5"),
    ("cells = 100", "cells = 1e8"),
    ("cells = 100", "cfl = 2"),
    ("cells = 100", "cells = 100\ncells = 200"),
    ("cells = 100", "cells 100"),
    ("frames = 5", "frames = 1e12"),
    ("frames = 5", "every = \"1 us\"\nframes = 5"),
    ("frames = 5", "fields = [\"temprature\"]"),
    ("\"0.5 m\"", "\"2 m\""),
    ("{ middle = \"0.5 m\" }", "7"),
];

/// Text of the material file that is replaced, and its replacement.
const MATERIALS: &[(&str, &str)] = &[
    ("density = 7800\n", ""),
    ("7800", "\"7800 GPa\""),
    ("7800", "-1"),
    ("\"200 GPa\"", "\"1 GPa\""),
    ("\"extend\"", "\"bend\""),
    ("table = [[0.001, \"200 MPa\"], [0.1, \"400 MPa\"]]", ""),
    ("[0.1, \"400 MPa\"]", "[0.0001, \"400 MPa\"]"),
    ("[0.1, \"400 MPa\"]", "[0.1, \"400 MPa\", 3]"),
    ("[curve]", "[heat]\nm = 1e-30\n[curve]"),
    ("table = [[0.001, \"200 MPa\"], [0.1, \"400 MPa\"]]", "formula = \"hollomon\"\nK = \"500 MPa\"\nn = 1"),
    ("[curve]", "[rate.malvern]\nD = 40\n[curve]"),
    ("[0.1, \"400 MPa\"]", "[0.1, \"400 mm\"]"),
    ("[0.1, \"400 MPa\"]", "[-0.1, \"400 MPa\"]"),
    ("[[0.001, \"200 MPa\"], [0.1, \"400 MPa\"]]", "[]"),
    ("table = [[0.001, \"200 MPa\"], [0.1, \"400 MPa\"]]", "formula = \"holomon\""),
    ("[curve]", "[curve]\n[curve]"),
];

/// Complete tables of strain and stress.
const TABLES: &[&str] = &[
    "",
    "strain,stress\n",
    "0.001\n",
    "0.001,200e6,5\n",
    "0,001,200\n",
    "0.001;200,5\n",
    "1;1,234\n",
    "strain,stress_MPa\n0.001,200\n0.1,4o0\n",
    "strain,stress_furlong\n0.001,200\n",
    "stress,strain\n200e6,0.001\n",
    "0.001,200e6\n0.001,300e6\n",
    "0.001,nan\n",
];

/// Texts of impact scenes in `runs/` that are replaced, and their replacements.
const IMPACTS: &[(&str, &[(&str, &str)])] = &[
    (
        "spheres-restitution.toml",
        &[
            ("\"2 kg\"", "\"-2 kg\""),
            ("\"2 kg\"", "0"),
            ("\"2 kg\"", "\"2 m\""),
            ("mass = \"2 kg\"\n", ""),
            ("restitution = 0.6", "restitution = 1.2"),
            ("restitution = 0.6", "restitution = -0.1"),
            ("restitution = 0.6", "restitution = \"0.6 m/s\""),
            ("restitution = 0.6", "velocity-after = 1"),
            ("velocity = \"5 m/s\"", "velocity = \"-5 m/s\""),
            ("velocity = \"5 m/s\"", "velocity = \"5 m/s\"\nradius = 1"),
            ("velocity = \"5 m/s\"\n", ""),
        ],
    ),
    (
        "spheres.toml",
        &[
            ("velocity = \"1 m/s\"", "velocity = 0"),
            ("radius = \"10 mm\"", "radius = 0"),
            ("radius = \"10 mm\"", "radius = nan"),
            ("radius = \"10 mm\"", "radius = \"10 mm\"\ndiameter = \"20 mm\""),
            ("radius = \"10 mm\"\n", ""),
            ("radius = \"10 mm\"", "half-space = true\nradius = \"10 mm\""),
            ("poisson = 0.3", "poisson = 0.6"),
            ("poisson = 0.3\n", ""),
            ("modulus = \"207 GPa\"", "modulus = \"207 kg\""),
            ("modulus = \"207 GPa\"\n", ""),
            ("modulus = \"207 GPa\"", "rigid = true"),
            ("density = \"7850 kg/m^3\"", "density = \"7850 kg/m^3\"\nmass = -1"),
            ("[striker]", "[stricker]"),
            ("[striker]", "[solve]\ntolerance = 0\n[striker]"),
        ],
    ),
    (
        "plate.toml",
        &[
            ("\"10 mm\"", "\"-10 mm\""),
            ("\"10 mm\"", "\"10 s\""),
            ("thickness = \"10 mm\"\n", ""),
            ("material = \"steel-4340-tempered-315c\"\n", ""),
            ("\"steel-4340-tempered-315c\"", "\"steel-4340\""),
            ("\"0.1 m/s\"", "\"-0.1 m/s\""),
        ],
    ),
    (
        "beam.toml",
        &[
            ("radius = \"1 cm\"", "radius = \"10 cm\""),
            ("radius = \"1 cm\"\nvelocity = \"1 cm/s\"", "radius = \"5 cm\"\nvelocity = \"1 km/s\""),
            ("poisson = 0.3", "poisson = 0.6"),
            ("length = \"15.35 cm\"", "length = \"-15.35 cm\""),
            ("width = \"1 cm\"\n", ""),
            ("width = \"1 cm\"", "diameter = \"1 cm\""),
            ("width = \"1 cm\"", "area = \"1 cm\""),
            ("modulus = \"2.2e6 kgf/cm^2\"\n", ""),
            ("depth = \"1 cm\"", "depth = \"1 cm\"\nat = \"16 cm\""),
            ("depth = \"1 cm\"", "depth = \"1 cm\"\naxial-force = \"80 kN\""),
            ("depth = \"1 cm\"", "depth = \"1 cm\"\nfoundation = \"1 N/m\""),
            ("depth = \"1 cm\"", "depth = \"1 cm\"\ninternal-damping = -1"),
            ("depth = \"1 cm\"", "depth = \"1 cm\"\nexternal-dampening = 1"),
            ("tolerance = 1e-5", "modes = 0"),
            ("tolerance = 1e-5", "tolerance = 2"),
            ("tolerance = 1e-5", "until = \"-1 ms\""),
            ("tolerance = 1e-5", "until = \"1 min\""),
            ("length = \"15.35 cm\"", "length = \"100 m\""),
            ("\"7.675 cm\"", "\"17 cm\""),
            ("[record]", "[record]\nshapes = 2000"),
            ("[striker]", "[bar]\n[striker]"),
            ("[beam]", "[beem]"),
        ],
    ),
];

const ARGUMENTS: &[&[&str]] = &[
    &["run", "nowhere.toml"],
    &["run", "."],
    &["run", "s.toml", "-o", "-"],
    &["run", "s.toml", "-o", "."],
    &["run", "s.toml", "-o", "s.toml"],
    &["run", "s.toml", "s.toml", "-o", "a.h5"],
    &["run", "s.toml", "--set", "solve.cells"],
    &["run", "s.toml", "--set", "solve.cels=3"],
    &["run", "s.toml", "--set", "solve.cells=many"],
    &["run", "s.toml", "--threads", "100000"],
    &["check", "empty.toml"],
    &["critical", "unobtainium"],
    &["compare", "mild-steel", "-o", "a.eps"],
    &["cost", "s.toml", "--budget", "0"],
    &["report", "s.toml"],
    &["report", "nowhere.h5"],
    &["report", "."],
    &["materials", "show", "mild-stel"],
    &["new", ".."],
    &["new", "s"],
];

/// Returns the message of a command, below a line that states what is wrong in the input.
fn message(folder: &Path, what: &str, arguments: &[&str]) -> String {
    let output = barwave(folder, arguments);
    let text = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!((output.status.code(), output.stdout.len()), (Some(2), 0), "{what}: {text}");
    assert_eq!((text.matches("error: ").count(), text.matches("\nhelp: ").count()), (1, 1), "{what}: {text}");
    let quoted: String = what.lines().flat_map(|line| ["## ", line, "\n"]).collect();
    format!("{quoted}{text}\n")
}

/// Compares messages with the stored ones, or stores them.
fn assert_kept(name: &str, messages: &str) {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/bad_inputs").join(name);
    if std::env::var_os("BARWAVE_REWRITE").is_some() {
        std::fs::write(path, messages).expect("written");
        return;
    }
    let kept = std::fs::read_to_string(path).expect("the messages as they were");
    for (found, kept) in messages.split("\n\n").zip(kept.split("\n\n")) {
        assert_eq!(found, kept);
    }
    assert_eq!(messages, kept);
}

fn edited(original: &str, from: &str, to: &str) -> String {
    assert!(original.contains(from), "`{from}` is not in the file");
    original.replacen(from, to, 1)
}

#[test]
fn wrong_scenes() {
    let folder = tempfile::tempdir().expect("a folder");
    let all = SCENES.iter().map(|(from, to)| {
        std::fs::write(folder.path().join("s.toml"), edited(SCENE, from, to)).expect("written");
        message(folder.path(), &format!("{} -> {}", from.trim(), to.trim()), &["check", "s.toml"])
    });
    assert_kept("scenes.txt", &all.collect::<String>());
}

#[test]
fn wrong_materials() {
    let folder = tempfile::tempdir().expect("a folder");
    let all = MATERIALS.iter().map(|(from, to)| {
        std::fs::write(folder.path().join("m.toml"), edited(STEEL, from, to)).expect("written");
        message(folder.path(), &format!("{} -> {}", from.trim(), to.trim()), &["check", "m.toml"])
    });
    assert_kept("materials.txt", &all.collect::<String>());
}

#[test]
fn wrong_impacts() {
    let folder = tempfile::tempdir().expect("a folder");
    let edits = IMPACTS.iter().flat_map(|(name, edits)| edits.iter().map(move |edit| (name, edit)));
    let all = edits.map(|(name, (from, to))| {
        let scene = Path::new(env!("CARGO_MANIFEST_DIR")).join("runs").join(name);
        let text = std::fs::read_to_string(scene).expect("a scene");
        std::fs::write(folder.path().join(name), edited(&text, from, to)).expect("written");
        message(folder.path(), &format!("{name}: {} -> {}", from.trim(), to.trim()), &["check", name])
    });
    assert_kept("impacts.txt", &all.collect::<String>());
}

#[test]
fn wrong_tables() {
    let folder = tempfile::tempdir().expect("a folder");
    let material = edited(STEEL, "table = [[0.001, \"200 MPa\"], [0.1, \"400 MPa\"]]", "csv = \"t.csv\"");
    std::fs::write(folder.path().join("m.toml"), material).expect("written");
    let all = TABLES.iter().map(|table| {
        std::fs::write(folder.path().join("t.csv"), table).expect("written");
        message(folder.path(), &format!("t.csv: {table:?}"), &["check", "m.toml"])
    });
    assert_kept("tables.txt", &all.collect::<String>());
}

#[test]
fn wrong_arguments() {
    let folder = tempfile::tempdir().expect("a folder");
    std::fs::write(folder.path().join("s.toml"), SCENE).expect("written");
    std::fs::write(folder.path().join("empty.toml"), "").expect("written");
    let all = ARGUMENTS.iter().map(|arguments| message(folder.path(), &arguments.join(" "), arguments));
    assert_kept("arguments.txt", &all.collect::<String>());
}
