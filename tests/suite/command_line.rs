//! Properties of all commands: several inputs, standard streams, JSON, folders, width, help.
// Tests panic at the first unexpected error.
#![allow(clippy::unwrap_used)]

use std::path::Path;
use std::process::{Command, Output, Stdio};

use serde_json::Value;

use crate::common::binary::barwave;
use crate::common::results::unlocked;

const SCENE: &str = "[bar]\nlength = 1\narea = \"1 cm^2\"\nmaterial = \"mild-steel\"\n[left]\nkind = \"velocity\"\nvalue = -1\n\
                     [right]\nkind = \"free\"\n[solve]\nuntil = \"50 us\"\ncells = 100\n";

/// Returns a folder with the scenes `a.toml`, `b.toml` and `wrong.toml`, which is refused.
fn scenes() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    for (name, text) in [("a", SCENE.to_owned()), ("b", SCENE.into()), ("wrong", SCENE.replace("= 100", "= -1"))] {
        std::fs::write(folder.path().join(format!("{name}.toml")), text).unwrap();
    }
    folder
}

fn out(output: &Output) -> String {
    String::from_utf8_lossy(&output.stdout).into_owned()
}

fn err(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

/// Runs the program with this text on standard input.
fn piped(folder: &Path, arguments: &[&str], text: &str) -> Output {
    use std::io::Write as _;
    let mut command = Command::new(env!("CARGO_BIN_EXE_barwave"));
    command.args(arguments).current_dir(folder).stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped());
    let mut child = command.spawn().unwrap();
    child.stdin.take().unwrap().write_all(text.as_bytes()).unwrap();
    child.wait_with_output().unwrap()
}

#[test]
fn several_scenes_each_have_a_result_whatever_becomes_of_the_others() {
    let folder = scenes();
    let output =
        barwave(folder.path(), &["run", "a.toml", "wrong.toml", "b.toml", "--output-dir", "new/results", "--json"]);
    assert_eq!(output.status.code(), Some(2));
    let summaries: Vec<Value> = out(&output).lines().map(|line| serde_json::from_str(line).unwrap()).collect();
    let outputs: Vec<&str> = summaries.iter().map(|summary| summary["output"].as_str().unwrap()).collect();
    assert_eq!(outputs, ["new/results/a.h5", "new/results/b.h5"]);
    let error: Value = serde_json::from_str(&err(&output)).unwrap();
    assert_eq!((&error["error"]["input"], &error["error"]["key"]), (&"wrong.toml".into(), &"solve.cells".into()));

    let output = barwave(folder.path(), &["run", "a.toml", "wrong.toml", "b.toml"]);
    assert!(err(&output).starts_with("wrong.toml: error: `solve.cells`: -1 is out of range"), "{}", err(&output));
    assert_eq!(out(&output).matches("  outcome           done").count(), 2);
    // One file cannot hold two results, and two scenes of the same name would write the same file.
    let output = barwave(folder.path(), &["run", "a.toml", "b.toml", "-o", "c.h5"]);
    assert!(output.status.code() == Some(2) && err(&output).contains("--output-dir"), "{}", err(&output));
    std::fs::create_dir(folder.path().join("other")).unwrap();
    std::fs::copy(folder.path().join("a.toml"), folder.path().join("other/a.toml")).unwrap();
    let output = barwave(folder.path(), &["run", "a.toml", "other/a.toml", "--output-dir", "d", "--quiet"]);
    assert!(output.status.code() == Some(2) && err(&output).contains("an earlier scene"), "{}", err(&output));
}

/// A result file can be run like its scene, with the material and the history that the scene reads from files.
#[test]
fn a_scene_runs_again_from_its_result_alone() {
    let folder = scenes();
    let material =
        "density = 7800\nmodulus = 200e9\n[curve]\nbeyond = \"extend\"\ntable = [[0.001, 200e6], [0.1, 400e6]]\n";
    std::fs::write(folder.path().join("steel.toml"), material).unwrap();
    std::fs::write(folder.path().join("pull.csv"), "0,0\n1e-5,-3\n").unwrap();
    let scene = SCENE.replace("\"mild-steel\"", "\"./steel.toml\"").replace("value = -1", "csv = \"pull.csv\"");
    std::fs::write(folder.path().join("a.toml"), scene).unwrap();
    let first = barwave(folder.path(), &["run", "a.toml", "--set", "solve.cells=80", "--quiet"]);
    assert_eq!(first.status.code(), Some(0), "{}", err(&first));
    for gone in ["steel.toml", "pull.csv", "a.toml"] {
        std::fs::remove_file(folder.path().join(gone)).unwrap();
    }
    let again = barwave(folder.path(), &["run", "a_solve.cells=80.h5", "--json"]);
    assert_eq!(again.status.code(), Some(0), "{}", err(&again));
    let summary: Value = serde_json::from_str(&out(&again)).unwrap();
    assert_eq!((&summary["cells"], &summary["output"]), (&80.into(), &"a_solve.cells=80_rerun.h5".into()));
    let stress = |name: &str| {
        unlocked().open(folder.path().join(name)).unwrap().dataset("stress").unwrap().read_raw::<f64>().unwrap()
    };
    assert_eq!(stress("a_solve.cells=80.h5"), stress("a_solve.cells=80_rerun.h5"));
    // A file of another format version cannot be read as a result, but its scene can be run.
    let old = unlocked().open_rw(folder.path().join("a_solve.cells=80.h5")).unwrap();
    old.attr("format_version").unwrap().write_scalar(&1_u32).unwrap();
    old.close().unwrap();
    let again =
        barwave(folder.path(), &["run", "a_solve.cells=80.h5", "-o", "b.h5", "--set", "solve.cells=40", "--quiet"]);
    assert_eq!(again.status.code(), Some(0), "{}", err(&again));
    assert_eq!(stress("b.h5").len() / 40, stress("a_solve.cells=80_rerun.h5").len() / 80);
}

#[test]
fn errors_are_json_on_stderr() {
    let folder = scenes();
    let error_of = |arguments: &[&str]| -> (Option<i32>, Value) {
        let output = barwave(folder.path(), arguments);
        assert!(output.stdout.is_empty(), "{arguments:?}");
        let error: Value = serde_json::from_str(&err(&output)).unwrap_or_else(|e| panic!("{e}: {}", err(&output)));
        assert_eq!(error["schema_version"], 1);
        (output.status.code(), error["error"].clone())
    };
    for arguments in [["--json", "run", "wrong.toml"], ["run", "--json", "wrong.toml"], ["run", "wrong.toml", "--json"]]
    {
        let (code, error) = error_of(&arguments);
        assert_eq!((code, &error["kind"], &error["exit_code"]), (Some(2), &"input".into(), &2.into()));
        assert_eq!((&error["file"], &error["line"], &error["column"]), (&"wrong.toml".into(), &12.into(), &9.into()));
        assert!(error["allowed"].as_str().unwrap().contains("<= cells <="));
    }
    let (code, error) = error_of(&["run", "--no-such-option", "--json"]);
    assert_eq!((code, &error["kind"]), (Some(2), &"usage".into()));
    // The message is the whole first paragraph, not only its first line.
    let (code, error) = error_of(&["sweep", "--json"]);
    assert_eq!(code, Some(2));
    assert!(error["message"].as_str().is_some_and(|text| text.contains("not provided: <")), "{error}");
    let (code, error) = error_of(&["man", "--json"]);
    assert_eq!((code, &error["key"]), (Some(2), &"--json".into()));
}

#[test]
fn a_file_in_place_of_a_subcommand_is_answered_with_the_subcommands() {
    let folder = scenes();
    for (line, names) in [("invert a.toml", "arrivals, residual-strain, hopkinson"), ("study a.toml", "tension-impact")]
    {
        let arguments: Vec<&str> = line.split(' ').collect();
        let output = barwave(folder.path(), &arguments);
        assert_eq!(output.status.code(), Some(2), "{line}");
        assert!(err(&output).contains(&format!("has the subcommands {names}")), "{}", err(&output));
        let output = barwave(folder.path(), &[&arguments[..], &["--json"]].concat());
        let error: Value = serde_json::from_str(&err(&output)).expect("JSON");
        assert!(error["error"]["help"].as_str().is_some_and(|help| help.contains(names)), "{error}");
    }
}

#[test]
fn a_file_of_the_wrong_kind_is_named_with_the_commands_that_read_it() {
    let folder = scenes();
    let write = |name: &str, text: &str| std::fs::write(folder.path().join(name), text).expect("written");
    write("m.toml", "name = \"m\"\ndensity = 7800\nmodulus = 200e9\n[curve]\ntable = [[0.001, 2e8], [0.1, 4e8]]\n");
    write("w.toml", "[sweep]\nscene = \"a.toml\"\n[axes]\n\"bar.length\" = [1, 2]\n");
    assert_eq!(barwave(folder.path(), &["run", "a.toml", "--quiet", "-o", "a.h5"]).status.code(), Some(0));
    for (line, message, help) in [
        ("run m.toml", "is a material, not a scene", "`barwave critical`"),
        ("plan w.toml", "is a sweep file, not a scene", "`barwave sweep`"),
        ("cost m.toml", "is a material, not a scene", "`barwave compare`"),
        ("critical a.toml", "is a scene, not a material", "`barwave run`"),
        ("compare w.toml m.toml", "is a sweep file, not a material", "`barwave sweep`"),
        ("sweep a.toml -o x", "is a scene, not a sweep file", "`barwave plan`"),
        ("sweep m.toml -o x", "is a material, not a sweep file", "`barwave critical`"),
        ("sweep a.h5 -o x", "is an HDF5 file, not a text file", "`barwave report`"),
        ("critical a.h5", "unknown material `a.h5`", "`barwave report`"),
    ] {
        let output = barwave(folder.path(), &line.split(' ').collect::<Vec<_>>());
        let text = err(&output);
        assert_eq!((output.status.code(), text.matches("error: ").count()), (Some(2), 1), "{line}: {text}");
        assert!(text.contains(message) && text.contains("help: ") && text.contains(help), "{line}: {text}");
    }
}

/// `--json` may precede the command, and every result states the version of its layout.
#[test]
fn results_of_every_command_are_versioned_json() {
    let folder = scenes();
    assert_eq!(barwave(folder.path(), &["run", "a.toml", "--quiet"]).status.code(), Some(0));
    for line in [
        "run a.toml",
        "plan a.toml",
        "check a.toml",
        "critical mild-steel",
        "compare mild-steel copper-annealed",
        "compare a.h5 a.h5",
        "materials",
        "materials list",
        "materials show mild-steel",
        "report a.h5 -o new/a.svg",
        "new folder/c",
    ] {
        let arguments: Vec<&str> = ["--json"].into_iter().chain(line.split(' ')).collect();
        let output = barwave(folder.path(), &arguments);
        assert_eq!(output.status.code(), Some(0), "{line}: {}", err(&output));
        let value: Value =
            serde_json::from_str(&out(&output)).unwrap_or_else(|e| panic!("{line}: {e}: {}", out(&output)));
        let first = value.as_array().map_or(&value, |list| &list[0]);
        assert_eq!(first["schema_version"], 1, "{line}");
    }
    assert!(folder.path().join("new/a.svg").is_file() && folder.path().join("folder/c.toml").is_file());
}

#[test]
fn standard_streams_are_read_and_written() {
    let folder = scenes();
    let template = barwave(folder.path(), &["new", "-"]);
    let ran = piped(folder.path(), &["run", "-", "-o", "deep/er/a.h5", "--json"], &out(&template));
    assert_eq!(ran.status.code(), Some(0), "{}", err(&ran));
    let drawn = barwave(folder.path(), &["report", "deep/er/a.h5", "-o", "-"]);
    assert!(out(&drawn).starts_with("<svg"), "{}", err(&drawn));
    let table = barwave(folder.path(), &["critical", "mild-steel", "-o", "-"]);
    assert!(out(&table).starts_with("material,") && err(&table).contains("v_c m/s"), "{}", out(&table));
    let table = barwave(folder.path(), &["compare", "mild-steel", "-o", "-"]);
    assert!(out(&table).starts_with("material,strain,") && err(&table).contains("c0 m/s"), "{}", out(&table));
    let material =
        "density = 7800\nmodulus = 200e9\n[curve]\nbeyond = \"extend\"\ntable = [[0.001, 200e6], [0.1, 400e6]]\n";
    for arguments in
        [&["critical", "-", "--json"][..], &["materials", "show", "-", "--json"], &["check", "-", "--json"]]
    {
        let output = piped(folder.path(), arguments, material);
        assert_eq!(output.status.code(), Some(0), "{arguments:?}: {}", err(&output));
    }
    // Two outputs would be mixed on standard output.
    let output = barwave(folder.path(), &["critical", "mild-steel", "-o", "-", "--json"]);
    assert!(output.status.code() == Some(2) && err(&output).contains("standard output"), "{}", err(&output));
    let output = barwave(folder.path(), &["run", "a.toml", "-o", "-"]);
    assert!(output.status.code() == Some(2) && err(&output).contains("standard output"), "{}", err(&output));
}

#[test]
fn a_key_that_is_not_there_can_be_taken_out() {
    let folder = scenes();
    let arguments =
        ["run", "a.toml", "--set", "solve.cfl=", "--set", "record.gauges.middle=", "--set", "effects.rate=", "--json"];
    let output = barwave(folder.path(), &arguments);
    assert_eq!(output.status.code(), Some(0), "{}", err(&output));
    let taken = barwave(folder.path(), &["run", "a.toml", "--set", "solve.until=", "--quiet"]);
    assert!(taken.status.code() == Some(2) && err(&taken).contains("until"), "{}", err(&taken));
}

/// Only single long words may be wider than the terminal.
#[test]
fn texts_and_tables_fit_80_columns() {
    let folder = scenes();
    let narrow = |line: &str| {
        let mut command = Command::new(env!("CARGO_BIN_EXE_barwave"));
        command.args(line.split(' ')).current_dir(folder.path()).env("COLUMNS", "80").output().unwrap()
    };
    for line in [
        "run a.toml",
        "plan a.toml",
        "check a.toml",
        "critical --all --sensitivity",
        "compare mild-steel copper-annealed",
        "compare a.h5 a.h5",
        "materials",
        "materials show copper-annealed",
        "--help",
        "run --help",
    ] {
        let output = narrow(line);
        assert_eq!(output.status.code(), Some(0), "{line}: {}", err(&output));
        for text in out(&output).lines().filter(|text| text.chars().count() > 80) {
            assert!(text.trim().split(' ').count() == 1, "{line}: {text}");
        }
        assert!(!output.stdout.is_empty());
    }
    let fronts = out(&narrow("run a.toml"));
    assert!(fronts.contains("  front  strain from"), "{fronts}");
}

/// Every help text ends with examples.
#[test]
fn examples_are_in_every_help() {
    let folder = scenes();
    let mut waiting = vec![String::new()];
    let mut found = 0;
    while let Some(path) = waiting.pop() {
        let arguments: Vec<&str> = path.split(' ').filter(|word| !word.is_empty()).chain(["--help"]).collect();
        let help = out(&barwave(folder.path(), &arguments));
        let (before, examples) = help.split_once("Examples:\n").unwrap_or_else(|| panic!("no examples: {path}"));
        // Long lines are wrapped; unit tests of the command line parse each example.
        assert!(examples.trim_start().starts_with("barwave "), "{path}: {examples}");
        found += 1;
        let listed = before.lines().skip_while(|line| *line != "Commands:").skip(1).take_while(|line| !line.is_empty());
        let names = listed.filter(|line| !line.starts_with("   ")).filter_map(|line| line.split_whitespace().next());
        waiting.extend(names.filter(|name| *name != "help").map(|name| format!("{path} {name}")));
    }
    assert!(found >= 24, "{found}");
}

#[test]
fn colours_and_details_are_as_asked_for() {
    let folder = scenes();
    let is_coloured =
        |when: &str| err(&barwave(folder.path(), &["--color", when, "run", "wrong.toml"])).contains('\x1b');
    assert_eq!(["always", "never", "auto"].map(is_coloured), [true, false, false]);
    let shows = |arguments: &[&str], expected: &[&str]| {
        let said = err(&barwave(folder.path(), &[arguments, &["-v"]].concat()));
        assert!(expected.iter().all(|part| said.contains(part)), "{said}");
    };
    shows(&["run", "a.toml", "--quiet"], &["barwave 0", "threads", "read a.toml: ", "writing a.h5", "time steps"]);
    shows(&["report", "a.h5", "-o", "a.svg"], &["reading a.h5", "wrote a.svg: "]);
    shows(&["check", "a.toml"], &["read a.toml: "]);
    shows(&["new", "fresh"], &["wrote fresh.toml: "]);
    assert_eq!(err(&barwave(folder.path(), &["check", "a.toml"])), "");
}

/// No input of a command is replaced, even with `--force`.
#[test]
fn inputs_are_no_outputs() {
    let folder = scenes();
    std::fs::write(folder.path().join("pull.csv"), "0,0\n1e-5,-3\n").unwrap();
    let driven = SCENE.replace("value = -1", "csv = \"pull.csv\"");
    std::fs::write(folder.path().join("driven.toml"), &driven).unwrap();
    for arguments in [
        ["run", "a.toml", "-o", "a.toml", "--force"],
        ["run", "driven.toml", "-o", "./pull.csv", "--force"],
        ["run", "driven.toml", "-o", "driven.toml", "--force"],
    ] {
        let output = barwave(folder.path(), &arguments);
        let said = err(&output);
        assert!(output.status.code() == Some(2) && said.contains("is a file that this command reads"), "{said}");
    }
    assert_eq!(std::fs::read_to_string(folder.path().join("a.toml")).unwrap(), SCENE);
    assert_eq!(std::fs::read_to_string(folder.path().join("driven.toml")).unwrap(), driven);
    let run = ["run", "a.toml", "-o", "a.h5", "--quiet"];
    assert_eq!(barwave(folder.path(), &run).status.code(), Some(0));
    assert_eq!(barwave(folder.path(), &run).status.code(), Some(0), "an earlier result is replaced");
    let itself = barwave(folder.path(), &["run", "a.h5", "-o", "a.h5", "--quiet"]);
    assert!(itself.status.code() == Some(2) && err(&itself).contains("this command reads"), "{}", err(&itself));
}

#[test]
fn numbers_out_of_place_are_answered_with_right_ones() {
    let folder = scenes();
    let refused = |line: &str| {
        let output = barwave(folder.path(), &line.split(' ').collect::<Vec<_>>());
        assert_eq!(output.status.code(), Some(2), "{line}: {}", err(&output));
        err(&output)
    };
    assert!(refused("run a.toml --threads 0").contains("allowed: 1 <= threads <= 1024"));
    let said = refused("run a.toml --set solve.cells=abc");
    assert!(said.contains("help: write a whole number, e.g. cells = 1000") && !said.contains("10 in"), "{said}");
    assert!(refused("run a.toml --set lleft.value=abc").contains("--> --set:1:1\n"));
    assert!(refused("run a.toml --set effects.rupture=true").contains("\"critical-strain\", or a table"));
    for negative in ["critical copper-annealed --rate --length -1", "study tension-impact copper-annealed --length -1"]
    {
        let said = refused(negative);
        assert!(said.contains("allowed: ") && !said.contains("unexpected argument"), "{said}");
    }
    assert!(refused("stability 01 -o x.txt").contains(".md"));
    assert!(refused("compare a.h5").contains("at least 2 result files"));
    assert!(!refused("cost a.toml --budget 2x").contains("did you mean"));
    assert!(refused("cost a.toml --budget 2m").contains("a minute is `min`"));
}

/// The bar may yield later, and the run then simulates it.
#[test]
fn plasticity_is_on_in_plans_of_elastic_first_waves() {
    let folder = scenes();
    let output = barwave(folder.path(), &["plan", "a.toml", "--json"]);
    let plan: Value = serde_json::from_str(&out(&output)).unwrap();
    let plasticity =
        plan["effects"].as_array().unwrap().iter().find(|effect| effect["effect"] == "plasticity").unwrap();
    assert_eq!(plasticity["on"], true, "{plasticity}");
}

#[test]
fn equal_results_have_no_place_of_the_largest_difference() {
    let folder = scenes();
    assert_eq!(barwave(folder.path(), &["run", "a.toml", "--quiet"]).status.code(), Some(0));
    let table = out(&barwave(folder.path(), &["compare", "a.h5", "a.h5"]));
    let stress = table.lines().find(|line| line.trim_start().starts_with("stress")).unwrap_or_default();
    assert!(stress.trim_end().ends_with('-') && !stress.contains("e0"), "{table}");
}
