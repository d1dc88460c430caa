//! Wrong scenes through the real binary: exit code 2, and a message with file, line, key, value, range and help.

use std::path::Path;
use std::process::{Command, Output};

/// A right scene; every case below changes one thing in it.
const RIGHT: &str = r#"title = "A right scene"

[bar]
length = "1 m"
area = "1 cm^2"
material = { name = "steel", density = "7800 kg/m^3", modulus = "200 GPa", beyond = "extend", curve = { table = [[0.001, "200 MPa"], [0.1, "400 MPa"]] } }

[left]
kind = "velocity"
value = "-30 m/s"

[right]
kind = "free"

[effects]
unloading = "isotropic"

[solve]
until = "200 us"
cells = 1000

[record]
frames = 101
fields = ["stress", "velocity"]
gauges = { middle = "0.5 m" }
"#;

/// One wrong scene: `from` is replaced by `to`.
struct Case {
    from: &'static str,
    to: &'static str,
    /// Text of the line that must be shown; empty where the complaint is about something that is not there.
    line: &'static str,
    key: &'static str,
    /// Everything that the message must hold: value, range, help.
    parts: &'static [&'static str],
}

const fn case(
    from: &'static str,
    to: &'static str,
    line: &'static str,
    key: &'static str,
    parts: &'static [&'static str],
) -> Case {
    Case { from, to, line, key, parts }
}

/// The material's line.
const MATERIAL: &str = r#"material = { name = "steel", density = "7800 kg/m^3", modulus = "200 GPa", beyond = "extend", curve = { table = [[0.001, "200 MPa"], [0.1, "400 MPa"]] } }"#;

/// The whole of `[bar]`.
const UNIFORM: &str = r#"[bar]
length = "1 m"
area = "1 cm^2"
material = { name = "steel", density = "7800 kg/m^3", modulus = "200 GPa", beyond = "extend", curve = { table = [[0.001, "200 MPa"], [0.1, "400 MPa"]] } }
"#;

const CASES: &[Case] = &[
    // Words that do not exist: the nearest is named, and what is allowed.
    case(
        "length =",
        "lenght =",
        "lenght",
        "bar.lenght",
        &["unknown key `lenght`", "did you mean `length`?", "area, diameter"],
    ),
    case("[solve]", "[sovle]", "[sovle]", "sovle", &["unknown key `sovle`", "did you mean `solve`?"]),
    case(
        "cells = 1000",
        "cels = 1000",
        "cels",
        "solve.cels",
        &["did you mean `cells`?", "until, method, scheme, cells, cfl, front-tolerance, event-budget"],
    ),
    case(
        "\"free\"",
        "\"fre\"",
        "\"fre\"",
        "right.kind",
        &["unknown word `fre`", "did you mean `free`?", "\"absorbing\""],
    ),
    case(
        "\"isotropic\"",
        "\"isotopic\"",
        "isotopic",
        "effects.unloading",
        &["unknown word `isotopic`", "did you mean `isotropic`?"],
    ),
    case(
        "\"stress\", ",
        "\"stres\", ",
        "stres",
        "record.fields.0",
        &["unknown word `stres`", "did you mean `stress`?", "\"plastic_strain\""],
    ),
    case("frames = 101", "precision = \"f16\"", "f16", "record.precision", &["unknown word `f16`", "\"f64\", \"f32\""]),
    case("cells = 1000", "method = \"fdm\"", "fdm", "solve.method", &["unknown word `fdm`", "did you mean `fd`?"]),
    // Numbers out of their range.
    case(
        "cells = 1000",
        "cfl = 1.5",
        "cfl",
        "solve.cfl",
        &["1.5 is out of range", "allowed: 0 < cfl <= 1", "help: give `cfl`"],
    ),
    case("cells = 1000", "cfl = 0", "cfl", "solve.cfl", &["0 is out of range", "allowed: 0 < cfl <= 1"]),
    case(
        "cells = 1000",
        "cells = 1",
        "cells",
        "solve.cells",
        &["1 is out of range", "allowed: 2 <= cells <= 100000000"],
    ),
    case(
        "cells = 1000",
        "cells = 1000.5",
        "cells",
        "solve.cells",
        &["1000.5 is not a whole number", "e.g. cells = 1001"],
    ),
    case(
        "\"200 us\"",
        "\"-200 us\"",
        "until",
        "solve.until",
        &["-200 us is out of range", "allowed: until > 0", "above zero"],
    ),
    case("\"1 m\"", "0", "length", "bar.length", &["0 is out of range", "allowed: length > 0"]),
    case(
        "\"isotropic\"",
        "{ mixed = 1.5 }",
        "mixed",
        "effects.unloading.mixed",
        &["1.5 is out of range", "allowed: 0 <= mixed <= 1"],
    ),
    case(
        "\"0.5 m\"",
        "\"1.5 m\"",
        "middle",
        "record.gauges.middle",
        &["1.5 m is outside the bar", "0 <= middle <= 1 m", "from the left end"],
    ),
    case(
        "frames = 101",
        "times = [0, \"300 us\"]",
        "times",
        "record.times.1",
        &["300 us is after the end", "<= 200 us", "raise solve.until"],
    ),
    case(
        "frames = 101",
        "frames = 5e6",
        "frames",
        "record.frames",
        &["5000000 frames of 1000 cells and 2 fields are 75 GiB", "at most 64 GiB"],
    ),
    case(
        "kind = \"free\"",
        "kind = \"wall\"\ngap = \"-1 mm\"",
        "gap",
        "right.gap",
        &["-1 mm is out of range", "allowed: gap >= 0"],
    ),
    case("\"200 us\"", "inf", "until", "solve.until", &["inf is not a finite number", "until > 0"]),
    case(
        "frames = 101",
        "every = 1e-300",
        "every",
        "record.every",
        &["frames", "at most 10000000 frames", "longer time"],
    ),
    // Units.
    case(
        "\"-30 m/s\"",
        "\"-30 m\"",
        "value",
        "left.value",
        &["`-30 m` is a length, but a velocity is expected", "\"80 ft/s\"", "plain number is in m/s"],
    ),
    case("\"1 cm^2\"", "\"1 cm\"", "area", "bar.area", &["`1 cm` is a length, but an area is expected"]),
    case("\"200 us\"", "\"200 uss\"", "until", "solve.until", &["unknown unit `uss`; did you mean `us`?"]),
    case("\"1 m\"", "\"1\"", "length", "bar.length", &["`1` has no unit", "\"10 in\""]),
    case("\"1 m\"", "true", "length", "bar.length", &["boolean `true`", "help: write a number, or a text with a unit"]),
    // What must stand together, and what must not.
    case("[right]\nkind = \"free\"\n", "", "", "right", &["`right` is missing", "both ends are always stated"]),
    case("until = \"200 us\"\n", "", "[solve]", "solve.until", &["`until` is missing", "add the end time"]),
    case("length = \"1 m\"\n", "", "[bar]", "bar.length", &["`length` is missing", "length = \"1 m\""]),
    case("kind = \"free\"", "", "[right]", "right.kind", &["`kind` is missing", "add `kind` to `[right]`"]),
    case("value = \"-30 m/s\"", "", "[left]", "left.value", &["`value` is missing", "history = "]),
    case(
        "value = \"-30 m/s\"",
        "value = 1\nhistory = [[0, 1]]",
        "history",
        "left.history",
        &["`value` and `history` both", "one of value, history, csv", "keep one"],
    ),
    case(
        "value = \"-30 m/s\"",
        "history = [[0, 1], [0]]",
        "history",
        "left.history.1",
        &["a row has 1 entries", "[time, value]"],
    ),
    case(
        "value = \"-30 m/s\"",
        "history = [[1, 1], [0, 1]]",
        "history",
        "left.history.1",
        &["row 2 goes back in time", "order of time"],
    ),
    case(
        "value = \"-30 m/s\"",
        "csv = \"no-such.csv\"",
        "csv",
        "left.csv",
        &["no such file", "relative to the scene file"],
    ),
    case(
        "kind = \"free\"",
        "kind = \"free\"\nvalue = 1",
        "value = 1",
        "right.value",
        &["means nothing for an end of kind \"free\"", "kind alone"],
    ),
    case(
        "area = \"1 cm^2\"",
        "area = 1\ndiameter = 1",
        "diameter",
        "bar.diameter",
        &["both an area and a diameter", "not both"],
    ),
    case(
        "frames = 101",
        "frames = 101\nevery = \"1 us\"",
        "every",
        "record.every",
        &["`frames` and `every` both", "keep one"],
    ),
    case(
        "frames = 101",
        "times = [0, 0]",
        "times",
        "record.times.1",
        &["0 is not after the time before it", "in order"],
    ),
    case("\"stress\", ", "\"velocity\", ", "fields", "record.fields.1", &["`velocity` stands twice", "once"]),
    case(
        "unloading = \"isotropic\"\n\n[solve]\nuntil = \"200 us\"\ncells = 1000\n\n[record]\nframes = 101\nfields = [\"stress\"",
        "\n[solve]\nuntil = \"200 us\"\n\n[record]\nfields = [\"plastic_strain\"",
        "plastic_strain",
        "record.fields.0",
        &["`plastic_strain` does not exist", "unloading = \"isotropic\""],
    ),
    case(
        "[left]",
        "[[bar.segment]]\nlength = 1\n[left]",
        "length = \"1 m\"",
        "bar.length",
        &["`length` of the whole bar stands beside [[bar.segment]]"],
    ),
    // Materials, by name and in place.
    case(MATERIAL, "material = \"copper-anealed\"", "material", "bar.material", &["copper-anealed", "copper-annealed"]),
    case(MATERIAL, "material = \"./none.toml\"", "material", "bar.material", &["none.toml", "no such file"]),
    case(
        "\"7800 kg/m^3\"",
        "\"-7800 kg/m^3\"",
        "density",
        "bar.material.density",
        &["-7800 kg/m^3 is out of range", "density > 0"],
    ),
    case(
        "modulus =",
        "modulsu =",
        "modulsu",
        "bar.material.modulsu",
        &["unknown key `modulsu`", "did you mean `modulus`?"],
    ),
    // Segments.
    case(
        UNIFORM,
        "[[bar.segment]]\nlength = 1\nmaterial = \"mild-steel\"\ngap = \"1 mm\"\n[[bar.segment]]\nlength = 1\nmaterial = \"mild-steel\"\n",
        "\"1 mm\"",
        "bar.segment.0.gap",
        &["a bonded joint has no gap", "joint = \"contact\""],
    ),
    case(
        UNIFORM,
        "[[bar.segment]]\nlength = 1\nmaterial = \"mild-steel\"\narea = 1\n[[bar.segment]]\nlength = 1\nmaterial = \"mild-steel\"\n",
        "[[bar.segment]]",
        "bar.segment.1.area",
        &["some segments state an area", "in every segment, or in none"],
    ),
    case(
        UNIFORM,
        "[[bar.segment]]\nlength = 1\nmaterial = \"mild-steel\"\nnotch = 0.5\n",
        "notch",
        "bar.segment.0.notch",
        &["this bar does not break", "rupture"],
    ),
    case(
        UNIFORM,
        "[[bar.segment]]\nlength = 1\nmaterial = \"mild-steel\"\njoint = \"bonded\"\n",
        "joint",
        "bar.segment.0.joint",
        &["no next one"],
    ),
    case(UNIFORM, "[bar]\nsegment = []\n", "[bar]", "bar.segment", &["the bar has no segment"]),
    // Bodies at the ends.
    case(
        "kind = \"free\"",
        "kind = \"striker\"\nvelocity = \"-5 m/s\"",
        "[right]",
        "right.mass",
        &["`mass` is missing", "mass = \"200 lb\""],
    ),
    case(
        "kind = \"free\"",
        "kind = \"striker\"\nmass = 0\nvelocity = -5",
        "mass",
        "right.mass",
        &["0 is out of range", "mass > 0"],
    ),
    case(
        "kind = \"free\"",
        "kind = \"spring\"\nstiffness = \"10 MPa\"",
        "stiffness",
        "right.stiffness",
        &["a stiffness", "kN/mm"],
    ),
    case(
        "kind = \"free\"",
        "kind = \"wall\"\nmass = 1",
        "mass",
        "right.mass",
        &["`mass` means nothing for an end of kind \"wall\"", "kind, gap"],
    ),
    // Words for what this version does not simulate: refused by name, with the way out.
    case(
        "kind = \"free\"",
        "kind = \"ball\"\nmass = \"200 lb\"",
        "ball",
        "right.kind",
        &["does not simulate a ball", "help: drive the end"],
    ),
    // Keys that belong to the other method, and what front tracking cannot follow.
    case(
        "cells = 1000",
        "cells = 1000\nmethod = \"moc\"",
        "cells",
        "solve.cells",
        &["means nothing for method = \"moc\"", "front-tolerance, event-budget", "method = \"fd\", which has it"],
    ),
    case("cells = 1000", "method = \"moc\"\ncfl = 1", "cfl", "solve.cfl", &["means nothing for method = \"moc\""]),
    case(
        "cells = 1000",
        "scheme = \"leapfrog\"\nmethod = \"moc\"",
        "scheme",
        "solve.scheme",
        &["means nothing for method = \"moc\"", "method = \"fd\", which has it"],
    ),
    case(
        "cells = 1000",
        "front-tolerance = 1e-3",
        "front-tolerance",
        "solve.front-tolerance",
        &["means nothing for method = \"fd\"", "method = \"moc\", which has it"],
    ),
    case(
        "cells = 1000",
        "method = \"fd\"\nevent-budget = 1000",
        "event-budget",
        "solve.event-budget",
        &["means nothing for method = \"fd\"", "until, method, scheme, cells, cfl"],
    ),
    case(
        "cells = 1000",
        "method = \"moc\"\nfront-tolerance = 1",
        "front-tolerance",
        "solve.front-tolerance",
        &["1 is out of range", "allowed: 0 <= front-tolerance < 1"],
    ),
    case(
        "cells = 1000",
        "method = \"moc\"\nevent-budget = 0",
        "event-budget",
        "solve.event-budget",
        &["0 is out of range", "1 <= event-budget"],
    ),
    case("frames = 101", "paths = true", "paths", "record.paths", &["means nothing for method = \"fd\"", "\"moc\""]),
    case(
        "cells = 1000",
        "tolerance = 0.7",
        "tolerance",
        "solve.tolerance",
        &["0.7 is out of range", "0 < tolerance <= 0.5"],
    ),
    case(
        "unloading = \"isotropic\"",
        "heat = { fraction = 0.9 }",
        "heat",
        "effects.heat",
        &["heating by plastic work", "leave it out"],
    ),
    // The effect of the strain rate.
    case(
        "unloading = \"isotropic\"",
        "rate = { model = \"malvren\", k = \"1e6 1/s\" }",
        "malvren",
        "effects.rate.model",
        &["unknown word `malvren`", "did you mean `malvern`?", "\"cowper-symonds\""],
    ),
    case(
        "unloading = \"isotropic\"",
        "rate = { model = \"malvern\", k = \"0 1/s\" }",
        "malvern",
        "effects.rate.k",
        &["0 1/s is out of range", "allowed: k > 0"],
    ),
    case(
        "unloading = \"isotropic\"",
        "rate = { model = \"malvern\", k = \"1 us\" }",
        "malvern",
        "effects.rate.k",
        &["1 us", "a rate"],
    ),
    case(
        "unloading = \"isotropic\"",
        "rate = { model = \"malvern\" }",
        "malvern",
        "effects.rate.k",
        &["`k` is missing", "k = \"1e6 1/s\""],
    ),
    case(
        "unloading = \"isotropic\"",
        "rate = { k = 1e6 }",
        "k = 1e6",
        "effects.rate.model",
        &["`model` is missing", "model = \"malvern\""],
    ),
    case(
        "unloading = \"isotropic\"",
        "rate = { model = \"malvern\", D = 40 }",
        "malvern",
        "effects.rate.D",
        &["is not a constant of model = \"malvern\"", "allowed: k"],
    ),
    case(
        "cells = 1000",
        "method = \"fd\"\nevent-budget = 1000\n[effects.rate]\nmodel = \"malvern\"\nk = 1e6",
        "1000",
        "solve.event-budget",
        &["means nothing for a rate-dependent bar", "until, method, scheme, cells, cfl"],
    ),
    case(
        "cells = 1000",
        "front-tolerance = 0.1\n[effects.rate]\nmodel = \"malvern\"\nk = 1e6",
        "front-tolerance",
        "solve.front-tolerance",
        &["means nothing for a rate-dependent bar", "allowed: until, method, cells"],
    ),
    case("area =", "mode = \"torsion\"\narea =", "torsion", "bar.mode", &["torsion", "mode = \"axial\""]),
    // No TOML at all.
    case("length = \"1 m\"", "length = 1 m", "length", "", &["help: "]),
    case("title = ", "title = \"twice\"\ntitle = ", "title", "title", &["the key stands twice", "keep one of the two"]),
];

fn check(file: &Path) -> Output {
    Command::new(env!("CARGO_BIN_EXE_barwave")).arg("check").arg(file).output().expect("barwave starts")
}

fn stderr(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

#[test]
fn the_base_scene_is_right() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let file = folder.path().join("right.toml");
    std::fs::write(&file, RIGHT).expect("written");
    let output = check(&file);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    assert!(String::from_utf8_lossy(&output.stdout).trim_end().ends_with("right.toml: ok (scene)"));
    assert!(output.stderr.is_empty(), "{}", stderr(&output));
}

#[test]
fn every_wrong_scene_says_what_is_wrong_and_where() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    for (i, case) in CASES.iter().enumerate() {
        assert_eq!(RIGHT.matches(case.from).count().min(1), 1, "case {i}: `{}` is not in the scene", case.from);
        let text = RIGHT.replacen(case.from, case.to, 1);
        let file = folder.path().join(format!("wrong-{i}.toml"));
        std::fs::write(&file, &text).expect("written");
        let output = check(&file);
        let shown = stderr(&output);
        let told = format!("case {i}, `{}` -> `{}`:\n{shown}", case.from, case.to);
        assert_eq!(output.status.code(), Some(2), "{told}");
        assert!(output.stdout.is_empty(), "{told}");
        assert!(shown.contains("\nhelp: ") && !shown.contains('\u{1b}'), "{told}");
        let key = if case.key.is_empty() { "error: ".to_owned() } else { format!("error: `{}`: ", case.key) };
        assert!(shown.starts_with(&key), "expected {key}\n{told}");
        let place = shown.lines().find_map(|l| l.trim_start().strip_prefix("--> ")).expect(&told);
        let mut place = place.rsplitn(3, ':');
        let line: usize = place.nth(1).and_then(|n| n.parse().ok()).expect(&told);
        assert!(place.next().is_some_and(|f| f.ends_with(&format!("wrong-{i}.toml"))), "{told}");
        let at = text.lines().nth(line - 1).unwrap_or_default();
        assert!(at.contains(case.line), "line {line} is `{at}`\n{told}");
        for part in case.parts {
            assert!(shown.contains(part), "expected `{part}`\n{told}");
        }
    }
}

#[test]
fn every_file_is_checked_and_every_error_shown() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let write = |name: &str, text: &str| {
        let file = folder.path().join(name);
        std::fs::write(&file, text).expect("written");
        file
    };
    let files = [
        write("a.toml", &RIGHT.replace("1000", "1")),
        write("b.toml", RIGHT),
        write("c.toml", "hello = 1\n"),
        folder.path().join("missing.toml"),
    ];
    let output = Command::new(env!("CARGO_BIN_EXE_barwave")).arg("check").args(&files).output().expect("starts");
    assert_eq!(output.status.code(), Some(2));
    let (out, err) = (String::from_utf8_lossy(&output.stdout), stderr(&output));
    assert_eq!(out.lines().count(), 1, "{out}");
    assert!(out.contains("b.toml: ok"), "{out}");
    assert_eq!(err.matches("error: ").count(), 3, "{err}");
    assert_eq!(err.matches("help: ").count(), 3, "{err}");
    assert!(err.contains("is neither a scene nor a material") && err.contains("there is no such file"), "{err}");
}

#[test]
fn new_writes_a_right_scene_and_never_overwrites() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let new = || {
        let mut command = Command::new(env!("CARGO_BIN_EXE_barwave"));
        command.current_dir(folder.path()).args(["new", "first"]).output().expect("barwave starts")
    };
    assert_eq!(new().status.code(), Some(0));
    let file = folder.path().join("first.toml");
    let before = std::fs::read_to_string(&file).expect("written");
    assert_eq!(check(&file).status.code(), Some(0), "{}", stderr(&check(&file)));
    let again = new();
    assert_eq!(again.status.code(), Some(2));
    assert!(stderr(&again).contains("exists already") && stderr(&again).contains("help: "));
    assert_eq!(std::fs::read_to_string(&file).expect("still there"), before);
}

#[test]
fn the_scenes_of_this_project_are_right() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("runs");
    let entries = std::fs::read_dir(folder).expect("runs/ is there");
    let scenes: Vec<_> =
        entries.filter_map(|e| Some(e.ok()?.path())).filter(|p| p.extension().is_some_and(|e| e == "toml")).collect();
    assert!(scenes.len() >= 7, "{scenes:?}");
    for scene in scenes {
        let output = check(&scene);
        assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    }
}

#[test]
fn schema_man_pages_and_completions_are_written() {
    let run = |args: &[&str]| {
        let output = Command::new(env!("CARGO_BIN_EXE_barwave")).args(args).output().expect("barwave starts");
        assert_eq!(output.status.code(), Some(0), "{args:?}: {}", stderr(&output));
        String::from_utf8(output.stdout).expect("UTF-8")
    };
    for kind in ["scene", "material"] {
        let schema: serde_json::Value = serde_json::from_str(&run(&["schema", kind])).expect("JSON");
        assert!(schema["properties"].is_object(), "{schema}");
        assert_eq!(schema["additionalProperties"], false);
    }
    assert!(run(&["man"]).contains(".TH barwave"));
    assert!(run(&["completions", "bash"]).contains("_barwave"));
    let folder = tempfile::tempdir().expect("a temporary folder");
    run(&["man", "--output", folder.path().to_str().expect("UTF-8")]);
    assert!(folder.path().join("barwave-check.1").exists());
}

/// Annealed copper is the same in tension and compression only in true stress: two engineering curves.
#[test]
fn kinematic_hardening_needs_one_curve() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let file = folder.path().join("two.toml");
    let text = RIGHT.replace(MATERIAL, "material = \"copper-annealed\"").replace("isotropic", "kinematic");
    std::fs::write(&file, text).expect("written");
    let output = check(&file);
    let shown = stderr(&output);
    assert_eq!(output.status.code(), Some(2), "{shown}");
    assert!(shown.starts_with("error: `effects.unloading`: kinematic hardening needs one curve"), "{shown}");
    assert!(shown.contains("help: use unloading = \"isotropic\""), "{shown}");
}
