//! `barwave sweep` and `barwave merge`: the table is the same for any number of threads and shards, and after interruptions.

use crate::common::binary;

use std::collections::BTreeSet;
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::Duration;

use binary::{barwave, done, failed};
use serde_json::Value;
use tempfile::TempDir;

const SCENE: &str = r#"
[bar]
length = 1
area = 1e-4
material = "copper-annealed"
[left]
kind = "velocity"
value = -30
[right]
kind = "free"
[solve]
until = "250 us"
method = "moc"
[record]
frames = 2
"#;

const SPEEDS: &str = "[sweep]\nscene = \"scene.toml\"\n[axes]\n\"left.value\" = { from = \"-5 m/s\", to = \"-115 m/s\", count = 12 }\n\
                      \"bar.material\" = [\"copper-annealed\", \"mild-steel\"]\n";

fn scenes(sweep: &str) -> TempDir {
    let folder = tempfile::tempdir().expect("a folder");
    std::fs::write(folder.path().join("scene.toml"), SCENE).expect("a file");
    std::fs::write(folder.path().join("sweep.toml"), sweep).expect("a file");
    folder
}

fn text(folder: &Path, name: &str) -> String {
    std::fs::read_to_string(folder.join(name)).unwrap_or_else(|e| panic!("{name}: {e}"))
}

/// Returns the rows of a table without its comment.
fn records(table: &str) -> Vec<csv::StringRecord> {
    let mut reader = csv::ReaderBuilder::new().comment(Some(b'#')).has_headers(false).from_reader(table.as_bytes());
    reader.records().collect::<Result<_, _>>().expect("a table")
}

/// All results of a table are for the same material: a sweep is not continued after a change of the material file.
#[test]
fn a_sweep_is_continued_only_with_unchanged_materials() {
    let axes = "\"bar.material\" = [\"copper-annealed\", \"own.toml\"]\n\"left.value\" = [-5, -30]\n";
    let folder = scenes(&format!("[sweep]\nscene = \"scene.toml\"\n[axes]\n{axes}"));
    let path = folder.path();
    let own = |stress: &str| {
        let curve = format!("curve = {{ table = [[0, 0], [0.001, 200e6], [0.1, {stress}]] }}");
        let text = format!("name = \"own\"\ndensity = 7800\nbeyond = \"extend\"\n{curve}\n");
        std::fs::write(path.join("own.toml"), text).expect("a file");
    };
    own("400e6");
    done(path, &["sweep", "sweep.toml", "-o", "out", "--shard", "1/2"]);
    done(path, &["sweep", "sweep.toml", "-o", "out", "--shard", "1/2", "--resume"]);
    own("500e6");
    let resumed = failed(path, &["sweep", "sweep.toml", "-o", "out", "--shard", "1/2", "--resume"], 2);
    assert!(resumed.contains("contains another sweep"), "{resumed}");
    done(path, &["sweep", "sweep.toml", "-o", "other", "--shard", "2/2"]);
    let merged = failed(path, &["merge", "out", "other", "-o", "all.h5"], 2);
    assert!(merged.contains("contain different sweeps"), "{merged}");
}

#[test]
fn rows_are_those_of_single_runs() {
    let folder = scenes(SPEEDS);
    let summary = done(folder.path(), &["sweep", "sweep.toml", "-o", "out"]);
    assert!(summary.starts_with("24 cases: "), "{summary}");
    let table = text(folder.path(), "out/table.csv");
    assert!(table.contains("\n# left.value in m/s\n"), "{table}");
    let records = records(&table);
    assert_eq!(records.len(), 25);
    let column = |name: &str| records[0].iter().position(|cell| cell == name).unwrap_or_else(|| panic!("{name}"));
    for row in [&records[1], &records[8], &records[24]] {
        let set = |key: &str| format!("{key}={}", &row[column(key)]);
        let json = done(
            folder.path(),
            &["run", "scene.toml", "-o", "a.h5", "--json", "--set", &set("left.value"), "--set", &set("bar.material")],
        );
        let run: Value = serde_json::from_str(&json).expect("JSON");
        let number = |name: &str| row[column(name)].parse::<f64>().expect("a number");
        assert_eq!(Some(number("left.stress_Pa")), run["left"]["stress_Pa"].as_f64());
        assert_eq!(Some(number("ledger.energy_residual")), run["ledger"]["energy_residual"].as_f64());
        assert_eq!(Some(&row[column("status")]), run["outcome"].as_str());
    }
}

#[test]
fn threads_shards_and_merging_change_no_byte() {
    let folder = scenes(SPEEDS);
    let path = folder.path();
    done(path, &["sweep", "sweep.toml", "-o", "one", "--threads", "1"]);
    done(path, &["sweep", "sweep.toml", "-o", "two", "--threads", "2"]);
    let table = text(path, "one/table.csv");
    assert_eq!(table, text(path, "two/table.csv"));
    for shard in ["1/3", "3/3"] {
        done(path, &["sweep", "sweep.toml", "-o", "parts", "--shard", shard, "--quiet"]);
    }
    let message = failed(path, &["merge", "parts", "-o", "all.h5"], 1);
    assert!(message.contains("8 of 24 cases are missing: 1, 4, 7, 10, 13, 16, 19, 22;"), "{message}");
    assert!(!path.join("all.h5").exists());
    // The second shard, as a Slurm job array would run it.
    let mut slurm = Command::new(env!("CARGO_BIN_EXE_barwave"));
    slurm.current_dir(path).args(["sweep", "sweep.toml", "-o", "parts", "--quiet"]);
    let variables = [("SLURM_ARRAY_TASK_ID", "2"), ("SLURM_ARRAY_TASK_COUNT", "3"), ("SLURM_ARRAY_TASK_MIN", "1")];
    assert!(slurm.envs(variables).status().expect("it starts").success());
    done(path, &["merge", "parts", "-o", "all.h5"]);
    done(path, &["merge", "parts", "-o", "a/new/all.h5"]);
    assert!(path.join("a/new/all.csv").is_file());
    assert_eq!(table, text(path, "all.csv"));
    // Rows of another sweep are not mixed in.
    std::fs::write(path.join("other.toml"), SPEEDS.replace("count = 12", "count = 3")).expect("a file");
    done(path, &["sweep", "other.toml", "-o", "other"]);
    assert!(failed(path, &["merge", "one", "other", "-o", "mixed.h5"], 2).contains("contain different sweeps"));
}

/// User files with the names of the tables are not replaced.
#[test]
fn only_tables_of_sweeps_are_replaced() {
    let two = "[sweep]\nscene = \"scene.toml\"\nmetrics = [\"left.stress_Pa\"]\n[axes]\n\"left.value\" = [-5, -10]\n";
    let folder = scenes(two);
    let path = folder.path();
    let write = |name: &str| std::fs::write(path.join(name), "mine\n").expect("a file");
    for name in ["table.csv", "sweep.h5", "sweep.json"] {
        write(name);
        let message = failed(path, &["sweep", "sweep.toml", "-o", "."], 2);
        assert!(
            message.contains(name)
                && message.contains("already exists and is not")
                && message.contains("another folder"),
            "{message}"
        );
        assert_eq!(text(path, name), "mine\n");
        assert!(!path.join("rows.jsonl").exists(), "{name}");
        std::fs::remove_file(path.join(name)).expect("it is there");
    }
    done(path, &["sweep", "sweep.toml", "-o", "out"]);
    for name in ["all.csv", "all.h5"] {
        write(name);
        let message = failed(path, &["merge", "out", "-o", "all.h5"], 2);
        assert!(
            message.contains(&format!("{name} already exists and is not")) && message.contains("--force"),
            "{message}"
        );
        assert_eq!(text(path, name), "mine\n");
        done(path, &["merge", "out", "-o", "all.h5", "--force"]);
    }
    // A table may be replaced by the next one.
    std::fs::write(path.join("all.csv"), "").expect("a file");
    done(path, &["merge", "out", "-o", "all.h5"]);
    done(path, &["merge", "out", "-o", "all.h5"]);
    assert_eq!(text(path, "all.csv"), text(path, "out/table.csv"));
    // The result of a run is not a table.
    done(path, &["run", "scene.toml", "-o", "run.h5", "--quiet"]);
    assert!(failed(path, &["merge", "out", "-o", "run.h5"], 2).contains("is not the table of a sweep"));
}

/// Plain numbers are in SI units: the unit of an axis is that in which the scene reads its key, for any kind of end and mode.
#[test]
fn axes_of_plain_numbers_have_units_and_rows_their_values() {
    let axes = "\"left.value\" = { from = -5, to = \"-18 km/h\", count = 1 }\n\"bar.length\" = [0.5, 1]\n\"solve.until\" = [1e-4]\n\
                \"right.kind\" = [\"free\", \"fixed\"]\n\"solve.front-tolerance\" = { from = 0.01, to = 0.02, count = 1 }\n";
    let folder = scenes(&format!("[sweep]\nscene = \"scene.toml\"\nmetrics = [\"left.stress_Pa\"]\n[axes]\n{axes}"));
    let path = folder.path();
    let rows = done(path, &["sweep", "sweep.toml", "-o", "out", "--json"]);
    let table = text(path, "out/table.csv");
    assert!(table.contains("\n# left.value in m/s; bar.length in m; solve.until in s\n"), "{table}");
    let mut rows: Vec<Value> = rows.lines().map(|line| serde_json::from_str(line).expect("JSON")).collect();
    rows.sort_by_key(|row| row["case"].as_u64());
    let axes = |length: f64, kind: &str| serde_json::json!({ "left.value": -5.0, "bar.length": length, "solve.until": 1e-4, "right.kind": kind, "solve.front-tolerance": 0.01 });
    let expected = [axes(0.5, "free"), axes(0.5, "fixed"), axes(1.0, "free"), axes(1.0, "fixed")];
    assert_eq!(rows.iter().map(|row| row["axes"].clone()).collect::<Vec<_>>(), expected);
    let scene = text(path, "scene.toml").replace("\"velocity\"", "\"stress\"");
    std::fs::write(path.join("scene.toml"), scene).expect("a file");
    let axis = "[sweep]\nscene = \"scene.toml\"\nmetrics = [\"left.stress_Pa\"]\n[axes]\n\"left.value\" = { from = 1e6, to = 2e6, count = 2 }\n";
    std::fs::write(path.join("stress.toml"), axis).expect("a file");
    done(path, &["sweep", "stress.toml", "-o", "stress"]);
    assert!(text(path, "stress/table.csv").contains("\n# left.value in Pa\n"));
    let file = hdf5::File::open(path.join("stress/sweep.h5")).expect("a table");
    let units = file.dataset("left.value").and_then(|axis| axis.attr("units")).expect("units");
    assert_eq!(units.read_scalar::<hdf5::types::VarLenUnicode>().expect("text").as_str(), "Pa");
}

#[test]
fn a_killed_sweep_is_resumed_and_runs_no_case_twice() {
    let slow = "[sweep]\nscene = \"scene.toml\"\nmetrics = [\"left.stress_Pa\"]\n[axes]\n\"left.value\" = { from = -10, to = -60, count = 60 }\n\
                \"solve.method\" = [\"fd\"]\n\"solve.cells\" = [1500]\n";
    let folder = scenes(slow);
    let path = folder.path();
    done(path, &["sweep", "sweep.toml", "-o", "whole"]);
    let started = || {
        let mut sweep = Command::new(env!("CARGO_BIN_EXE_barwave"));
        sweep.current_dir(path).args(["sweep", "sweep.toml", "-o", "killed", "--resume", "--quiet"]);
        sweep.stdout(Stdio::null()).stderr(Stdio::null()).spawn().expect("it starts")
    };
    for _ in 0..3 {
        let mut child = started();
        std::thread::sleep(Duration::from_millis(60));
        child.kill().expect("killed");
        child.wait().expect("it ends");
    }
    // A row that is incomplete because the process was killed.
    let rows = path.join("killed/rows.jsonl");
    let mut cut = std::fs::read_to_string(&rows).unwrap_or_default();
    let kept = cut.lines().count();
    cut.push_str("{\"case\": 5, \"sta");
    std::fs::write(&rows, &cut).expect("a file");
    assert!(kept < 60, "nothing was left to resume");
    done(path, &["sweep", "sweep.toml", "-o", "killed", "--resume"]);
    assert_eq!(text(path, "whole/table.csv"), text(path, "killed/table.csv"));
    let cases: Vec<u64> = text(path, "killed/rows.jsonl")
        .lines()
        .map(|line| serde_json::from_str::<Value>(line).expect("a row")["case"].as_u64().expect("a number"))
        .collect();
    assert_eq!((cases.len(), cases.iter().collect::<BTreeSet<_>>().len()), (60, 60));
    // A finished sweep remains unchanged, and another sweep is not continued in its folder.
    done(path, &["sweep", "sweep.toml", "-o", "killed", "--resume"]);
    assert!(failed(path, &["sweep", "sweep.toml", "-o", "killed"], 2).contains("already contains a sweep"));
    std::fs::write(path.join("scene.toml"), SCENE.replace("250 us", "200 us")).expect("a file");
    assert!(failed(path, &["sweep", "sweep.toml", "-o", "killed", "--resume"], 2).contains("contains another sweep"));
}

#[test]
fn a_case_that_fails_is_a_row_with_its_reason() {
    let folder = scenes(
        "[sweep]\nscene = \"scene.toml\"\ncombine = \"zip\"\n[axes]\n\"bar.length\" = [\"1 m\", \"-1 m\"]\n\"left.value\" = [-10, -20]\n",
    );
    let summary = done(folder.path(), &["sweep", "sweep.toml", "-o", "out"]);
    assert!(summary.starts_with("2 cases: 1 done, 1 refused\n  reason  of 1 case: `bar.length`"), "{summary}");
    let table = records(&text(folder.path(), "out/table.csv"));
    assert_eq!((&table[1][3], &table[2][3]), ("done", "refused"));
    assert!(table[2][4].contains("bar.length") && table[2][4].contains("-1 m"), "{:?}", table[2]);
    let lines = done(folder.path(), &["sweep", "sweep.toml", "-o", "again", "--json"]);
    assert!(
        lines.lines().all(|line| serde_json::from_str::<Value>(line).is_ok_and(|row| row["status"].is_string())),
        "{lines}"
    );
    let wrong = "[sweep]\nscene = \"scene.toml\"\n[axes]\n\"left.valve\" = [-10, -20]\n";
    std::fs::write(folder.path().join("sweep.toml"), wrong).expect("a file");
    let message = failed(folder.path(), &["sweep", "sweep.toml", "-o", "typo"], 2);
    assert!(message.contains("every case is refused") && message.contains("valve"), "{message}");
    // Nothing is left, and existing files remain.
    assert!(!folder.path().join("typo").exists());
    std::fs::create_dir(folder.path().join("typo")).expect("a folder");
    std::fs::write(folder.path().join("typo/notes.txt"), "mine").expect("a file");
    failed(folder.path(), &["sweep", "sweep.toml", "-o", "typo"], 2);
    assert_eq!(std::fs::read_dir(folder.path().join("typo")).expect("a folder").count(), 1);
    // Shards keep their rows for the others, and the corrected sweep uses their folder.
    failed(folder.path(), &["sweep", "sweep.toml", "-o", "typo", "--shard", "1/2"], 2);
    assert!(folder.path().join("typo/shard-1-of-2/rows.jsonl").exists());
    std::fs::write(folder.path().join("sweep.toml"), wrong.replace("valve", "value")).expect("a file");
    done(folder.path(), &["sweep", "sweep.toml", "-o", "typo", "--shard", "1/2"]);
    done(folder.path(), &["sweep", "sweep.toml", "-o", "right"]);
    assert!(failed(folder.path(), &["sweep", "sweep.toml", "-o", "right"], 2).contains("already contains a sweep"));
    let message = failed(folder.path(), &["merge", "right", "-o", "right.txt"], 2);
    assert!(message.contains(".h5") && !folder.path().join("right.txt").exists(), "{message}");
    let message = failed(folder.path(), &["report", "right/sweep.h5"], 2);
    assert!(message.contains("the table of a sweep") && message.contains("--plot"), "{message}");
}

#[test]
fn fields_are_kept_where_they_are_asked_for() {
    let folder =
        scenes("[sweep]\nscene = \"scene.toml\"\nfields = [\"stress\"]\n[axes]\n\"left.value\" = [-10, -20]\n");
    done(folder.path(), &["sweep", "sweep.toml", "-o", "out"]);
    let file = barwave::record::store::ResultFile::open(&folder.path().join("out/case-000001.h5")).expect("a result");
    assert_eq!(file.metadata().overrides, ["left.value=-20", "record.fields=[\"stress\"]"]);
}

#[test]
fn wrong_sweep_files_have_one_error_with_its_place() {
    for (text, words) in [
        ("[sweep]\nscene = \"nowhere.toml\"\n[axes]\n\"left.value\" = [1]\n", "`sweep.scene`: cannot read the scene"),
        ("[sweep]\nscene = \"scene.toml\"\n[axes]\n", "there are no axes"),
        (
            "[sweep]\nscene = \"scene.toml\"\n[axes]\n\"left.value\" = { from = 1, to = 2 }\n",
            "`axes.left.value`: give `count`",
        ),
        (
            "[sweep]\nscene = \"scene.toml\"\n[axes]\n\"left.value\" = [\"-1 m/s\", \"5 kN\"]\n",
            "\"-1 m/s\" and \"5 kN\" are of different dimensions",
        ),
        ("[sweep]\nscene = \"scene.toml\"\n[axes]\nleft.value = [1, 2]\n", "quote the key of an axis: \"left.value\""),
        (
            "[sweep]\nscene = \"scene.toml\"\ncombine = \"zip\"\n[axes]\na = [1, 2]\nb = [1]\n",
            "equal numbers of values: a has 2, b has 1",
        ),
        ("[sweep]\nscene = \"scene.toml\"\ncombien = \"zip\"\n[axes]\na = [1]\n", "combine"),
    ] {
        let folder = scenes(text);
        for command in ["sweep", "check"] {
            let message = failed(folder.path(), &[command, "sweep.toml"], 2);
            assert!(message.contains(words) && message.contains("help: "), "{text}: {message}");
        }
    }
    let folder = scenes(SPEEDS);
    assert!(done(folder.path(), &["check", "sweep.toml"]).contains("ok (sweep)"));
    assert!(failed(folder.path(), &["sweep", "sweep.toml", "--shard", "4/3"], 2).contains("write I/N"));
    assert!(failed(folder.path(), &["merge", ".", "-o", "a.h5"], 2).contains("contains no sweep"));
}

#[test]
fn the_table_has_decimal_values_and_no_column_of_an_object() {
    let folder = scenes(
        "[sweep]\nscene = \"scene.toml\"\nmetrics = []\n[axes]\n\"solve.until\" = { from = \"10 us\", to = \"10.3 us\", step = \"0.1 us\" }\n\
         \"bar.material\" = [\"copper-annealed\", \"steel-4340-jc\"]\n\"left.value\" = [-5]\n",
    );
    done(folder.path(), &["sweep", "sweep.toml", "-o", "out", "--quiet"]);
    let table = text(folder.path(), "out/table.csv");
    let rows = records(&table);
    let times: Vec<&str> = rows[1..].iter().step_by(2).map(|row| &row[1]).collect();
    assert_eq!(times, ["1e-5", "1.01e-5", "1.02e-5", "1.03e-5"]);
    // The steel bar stays elastic: its elastic check is an object, and null for copper.
    let names: Vec<&str> = rows[0].iter().filter(|name| name.starts_with("elastic_check")).collect();
    assert_eq!(names, ["elastic_check.expected_Pa", "elastic_check.relative", "elastic_check.stress_Pa"]);
}

/// As in the template and in the guide.
#[test]
fn a_range_of_whole_numbers_is_rounded() {
    let folder = scenes(
        "[sweep]\nscene = \"scene.toml\"\n[axes]\n\"solve.method\" = [\"fd\"]\n\"solve.cells\" = { from = 10, to = 100, count = 4, scale = \"log\" }\n",
    );
    let summary = done(folder.path(), &["sweep", "sweep.toml", "-o", "out"]);
    assert!(summary.starts_with("4 cases: 4 done\n"), "{summary}");
    let table = records(&text(folder.path(), "out/table.csv"));
    assert_eq!(table[1..].iter().map(|row| &row[2]).collect::<Vec<_>>(), ["10.0", "22.0", "46.0", "100.0"]);
}

#[test]
fn every_name_of_a_summary_is_a_metric() {
    let folder = scenes(SPEEDS);
    for solve in ["solve.method=\"moc\"", "solve.method=\"fd\""] {
        let run = done(folder.path(), &["run", "scene.toml", "--json", "--set", solve]);
        let summary: Value = serde_json::from_str(&run).expect("JSON");
        let keys = |value: &Value, before: &str| -> Vec<String> {
            value.as_object().into_iter().flatten().map(|(key, _)| format!("{before}{key}")).collect()
        };
        let mut names = keys(&summary, "");
        names.retain(|name| name != "schema_version" && name != "figures");
        names.extend(keys(&summary["figures"], ""));
        names.extend(["left", "right"].into_iter().flat_map(|end| keys(&summary[end], &format!("{end}."))));
        let of_ends = |end: &str| keys(&summary["figures"][end], &format!("figures.{end}."));
        names.extend(["left", "right"].into_iter().flat_map(of_ends));
        assert!(names.len() > 40, "{names:?}");
        let sweep = SPEEDS.replace("[axes]", &format!("metrics = {names:?}\n[axes]"));
        std::fs::write(folder.path().join("sweep.toml"), sweep).expect("a file");
        done(folder.path(), &["check", "sweep.toml"]);
    }
}

#[test]
fn wrong_keys_and_metrics_are_named() {
    let sweep = |metrics: &str, key: &str| {
        format!("[sweep]\nscene = \"scene.toml\"\nmetrics = [{metrics}]\n[axes]\n\"{key}\" = [0.5, 0.6]\n")
    };
    let folder = scenes(&sweep("", "bar.lenght"));
    let message = failed(folder.path(), &["sweep", "sweep.toml", "-o", "out"], 2);
    assert!(message.contains("every case is refused") && message.contains("did you mean `length`?"), "{message}");
    let folder = scenes(&sweep("\"left.peak_forc_N\", \"left.peak_force_N\"", "bar.length"));
    let message = failed(folder.path(), &["sweep", "sweep.toml", "-o", "out"], 2);
    assert!(message.contains("unknown metric `left.peak_forc_N`"), "{message}");
    assert!(message.contains("did you mean `left.peak_force_N`?") && !folder.path().join("out").exists(), "{message}");
    // A metric that exists for other bars.
    let folder = scenes(&sweep("\"left.restitution\", \"left.peak_force_N\"", "bar.length"));
    let output = barwave(folder.path(), &["sweep", "sweep.toml", "-o", "out"]);
    let message = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success() && message.contains("no case has the metric `left.restitution`"), "{message}");
    assert_eq!(message.matches("warning").count(), 1, "{message}");
    let folder = scenes(&sweep("", "bar.length").replace("[0.5, 0.6]", "{ log-uniform = [1, 2], samples = 3 }"));
    let message = failed(folder.path(), &["sweep", "sweep.toml", "-o", "out"], 2);
    assert!(message.contains("unknown field `log-uniform`"), "{message}");
    // The message of a refused case names the key that is out of range, without its position in the command line.
    let folder = scenes(&sweep("", "bar.length").replace("[0.5, 0.6]", "[0.5, -1]"));
    done(folder.path(), &["sweep", "sweep.toml", "-o", "out"]);
    let table = text(folder.path(), "out/table.csv");
    assert!(table.contains("refused,") && table.contains("`bar.length`") && !table.contains("--set"), "{table}");
}

/// An error in the values of an axis is at its place in the sweep file, in text and JSON; it names no option that was not given.
#[test]
fn wrong_values_are_found_in_the_sweep_file() {
    let axes = "\"left.value\" = [-5, -6]\n\"bar.material\" = [\"no-such\"]\n";
    let file = |fields: &str, axes: &str| format!("[sweep]\nscene = \"scene.toml\"\n{fields}[axes]\n{axes}");
    for (text, key, line) in [
        (file("", axes), "axes.bar.material", 5),
        (file("", "\"left.valve\" = [-5]\n"), "axes.left.valve", 4),
        (file("", "\"left..value\" = [-5]\n"), "axes.left..value", 4),
        (file("fields = [\"stres\"]\n", "\"left.value\" = [-5]\n"), "sweep.fields", 3),
    ] {
        let folder = scenes(&text);
        let message = failed(folder.path(), &["sweep", "sweep.toml", "-o", "out"], 2);
        assert!(message.contains(&format!("`{key}`")) && message.contains(&format!("sweep.toml:{line}:")), "{message}");
        assert!(!message.contains("--set:"), "{message}");
        let message = failed(folder.path(), &["sweep", "sweep.toml", "-o", "out", "--json"], 2);
        let error: Value = serde_json::from_str(message.lines().last().expect("a line")).expect("JSON");
        let error = &error["error"];
        let place = ["key", "file", "line"].map(|name| error[name].clone());
        assert_eq!(place, [Value::from(key), Value::from("sweep.toml"), Value::from(line)], "{message}");
    }
}

/// A shard whose cases are all refused ends as the whole sweep does, of which other cases run.
#[test]
fn a_shard_is_refused_only_with_the_whole_sweep() {
    let folder = scenes(
        "[sweep]\nscene = \"scene.toml\"\nmetrics = [\"left.stress_Pa\"]\n[axes]\n\
         \"bar.material\" = [\"copper-annealed\", \"no-such\"]\n",
    );
    let shard = ["sweep", "sweep.toml", "-o", "out", "--shard", "2/2"];
    for arguments in [&shard[..], &[&shard[..], &["--resume"]].concat()] {
        let output = barwave(folder.path(), arguments);
        assert_eq!((output.status.code(), &output.stderr[..]), (Some(0), &b""[..]), "no warning, either");
        let summary = String::from_utf8_lossy(&output.stdout);
        assert!(summary.starts_with("1 case: 1 refused\n  reason  of 1 case: "), "{summary}");
    }
    done(folder.path(), &["sweep", "sweep.toml", "-o", "out", "--shard", "1/2"]);
    done(folder.path(), &["merge", "out", "-o", "merged.h5"]);
}

/// An axis of equal ratios is drawn logarithmically, plain numbers in the legend have their unit.
#[test]
fn the_figure_has_logarithmic_axes_and_units_in_its_legend() {
    let folder = scenes(
        "[sweep]\nscene = \"scene.toml\"\nmetrics = [\"left.peak_force_N\", \"left.peak_stress_Pa\"]\n[axes]\n\
         \"bar.length\" = { from = 0.1, to = 10, count = 3, scale = \"log\" }\n\"left.value\" = [-5, -10]\n",
    );
    done(folder.path(), &["sweep", "sweep.toml", "-o", "out", "--plot", "a.svg"]);
    let figure = text(folder.path(), "a.svg");
    // The middle one of three equal ratios is in the middle of the axis.
    let circle = |circle: &str| circle.split("cx=\"").nth(1)?.split('"').next()?.parse::<f64>().ok();
    let places: Vec<f64> = figure.split("<circle").skip(1).take(3).filter_map(circle).collect();
    assert!((places[0] + places[2] - 2.0 * places[1]).abs() < 1.0, "{places:?}");
    assert!(figure.contains("velocity of the left end -10 m/s"), "{figure}");
}

/// Impacts without waves in a bar have figures of their own; a sweep without numbers to draw still has a summary.
#[test]
fn other_scenes_are_drawn_too() {
    let scene = concat!(env!("CARGO_MANIFEST_DIR"), "/runs/plate.toml");
    let folder = scenes(&format!("[sweep]\nscene = \"{scene}\"\n[axes]\n\"plate.thickness\" = [\"2 mm\", \"5 mm\"]\n"));
    let summary = done(folder.path(), &["sweep", "sweep.toml", "-o", "out", "--plot", "a.svg"]);
    assert!(summary.starts_with("2 cases: 2 done\n") && text(folder.path(), "a.svg").contains("peak"), "{summary}");
    let folder = scenes("[sweep]\nscene = \"scene.toml\"\n[axes]\n\"bar.material\" = [\"mild-steel\"]\n");
    let output = barwave(folder.path(), &["sweep", "sweep.toml", "-o", "out", "--plot", "a.svg"]);
    let summary = String::from_utf8_lossy(&output.stdout);
    assert!(output.status.code() == Some(2) && summary.starts_with("1 case: 1 done\n"), "{summary}");
    assert!(summary.contains("table.csv") && !summary.contains("a.svg"), "{summary}");
}

/// Random samples have no order, and are drawn without a line.
#[test]
fn samples_are_drawn_as_points() {
    let folder = scenes(
        "[sweep]\nscene = \"scene.toml\"\nmetrics = [\"left.stress_Pa\"]\n[axes]\n\
         \"left.value\" = { normal = [\"-10 m/s\", \"1 m/s\"], samples = 6, seed = 3 }\n",
    );
    done(folder.path(), &["sweep", "sweep.toml", "-o", "out", "--plot", "a.svg"]);
    let figure = text(folder.path(), "a.svg");
    assert!(figure.matches("<circle").count() == 6 && !figure.contains("<path"), "{figure}");
}

#[test]
fn the_figure_has_a_line_for_every_material() {
    let folder = scenes(SPEEDS);
    let summary = done(folder.path(), &["sweep", "sweep.toml", "-o", "out", "--plot", "a.svg"]);
    assert!(summary.contains("\n  figure  a.svg\n") && summary.contains("cases/s"), "{summary}");
    let figure = text(folder.path(), "a.svg");
    for word in [
        "Sweep sweep",
        "velocity of the left end (m/s)",
        "peak force at the left end (kN)",
        "material mild-steel",
        "bar fractured",
    ] {
        assert!(figure.contains(word), "{word}");
    }
    // The right end is free.
    assert!(!figure.contains("peak force at the right end") && !figure.contains("left.peak_force_N"));
    // A mark for every case, and axes that end at zero if no value lies beyond.
    assert!(figure.matches("<circle").count() >= 24, "{figure}");
    let attribute = figure.split("data-x=\"").nth(1).and_then(|rest| rest.split('"').next()).expect("an axis");
    let ends: Vec<f64> = attribute.split(' ').map(|end| end.parse().expect("a number")).collect();
    assert!(ends[0] < -115.0 && ends[1] <= 0.0, "{ends:?}");
    // A finished sweep is drawn without running a case.
    let summary = done(folder.path(), &["sweep", "sweep.toml", "-o", "out", "--resume", "--plot", "b.svg"]);
    assert!(!summary.contains("cases/s"), "{summary}");
    assert_eq!(text(folder.path(), "b.svg"), figure);
    let message = failed(folder.path(), &["sweep", "sweep.toml", "-o", "other", "--plot", "a.eps"], 2);
    assert!(message.contains("--plot") && !folder.path().join("other").exists(), "{message}");
}
