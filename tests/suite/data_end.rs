//! The end of the stress-strain data with every solver and through the real binary: a run stops if and only if a point flows beyond the data for the
//! sense in which it flows, in the step in which this happens.

use crate::common::binary;

use std::path::Path;
use std::process::Output;

use barwave::law::{DataEnd, Flowing, Limit, Reached, Table};
use barwave::material::{Beyond, Curve, Loading, Sense, library, true_from_engineering};
use barwave::record::Field;
use barwave::record::store::ResultFile;
use binary::barwave;
use serde_json::Value;

/// Name of a solver, its `[solve]` without the end time, and `[effects]`.
const SOLVERS: [(&str, &str, &str); 5] = [
    ("leapfrog", "cells = 400", r#"hardening = "isotropic""#),
    ("leapfrog with a rate", "cells = 400", r#"rate = { model = "malvern", k = "1e8 1/s" }"#),
    ("muscl", "scheme = \"muscl\", cells = 400", r#"hardening = "isotropic""#),
    ("front tracking", "method = \"moc\", front-tolerance = 0.02", r#"hardening = "isotropic""#),
    ("characteristic net", "method = \"moc\", cells = 400", r#"rate = { model = "malvern", k = "1e8 1/s" }"#),
];

/// Material whose data end at a strain of 0.02, with `beyond = "error"`.
const SHORT: &str = r#"{ name = "short", density = 8000, modulus = "200 GPa", beyond = "error", curve = { table = [[0.001, "200 MPa"], [0.02, "400 MPa"]] } }"#;

/// Material with low stress at all strains.
const SOFT: &str = r#"{ name = "soft", density = 8000, modulus = "200 GPa", beyond = "extend", curve = { table = [[0.001, "200 MPa"], [0.02, "400 MPa"]] } }"#;

/// Returns a scene for one of [`SOLVERS`].
fn scene((_, solve, effects): (&str, &str, &str), bar: &str, ends: [&str; 2], until: &str) -> String {
    let [left, right] = ends;
    format!(
        "bar = {{ {bar} }}\nleft = {{ {left} }}\nright = {{ {right} }}\neffects = {{ {effects} }}\n\
         solve = {{ until = \"{until}\", {solve} }}\n\
         record = {{ frames = 41, gauges = {{ near = \"1 mm\" }}, fields = [\"strain\", \"displacement\", \"accumulated_plastic_strain\"] }}\n"
    )
}

/// Runs a command of `barwave` on a scene in a folder of its own.
fn of(folder: &Path, command: &[&str], scene: &str) -> Output {
    std::fs::write(folder.join("scene.toml"), scene).expect("a folder to write to");
    let arguments: Vec<&str> = command.iter().copied().chain(["scene.toml"]).collect();
    barwave(folder, &arguments)
}

/// Returns the summary of a run that must finish.
fn summary(folder: &Path, scene: &str) -> Value {
    let output = of(folder, &["run", "--json", "-o", "out.h5"], scene);
    assert_eq!(output.status.code(), Some(0), "{}\n{scene}", String::from_utf8_lossy(&output.stderr));
    serde_json::from_slice(&output.stdout).expect("one JSON value")
}

/// Returns the message of a run that must stop with exit code 1.
fn stopped(folder: &Path, scene: &str) -> String {
    let output = of(folder, &["run", "--quiet", "-o", "out.h5"], scene);
    let text = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(1), "{text}\n{scene}");
    text
}

/// Returns the smallest and the largest value of a field over all frames.
fn range(file: &ResultFile, field: Field) -> [f64; 2] {
    let frames = file.time().expect("times").len();
    let values = file.field(field, 0..frames).expect("the field");
    [values.iter().copied().fold(f64::INFINITY, f64::min), values.iter().copied().fold(f64::NEG_INFINITY, f64::max)]
}

fn folder() -> tempfile::TempDir {
    tempfile::tempdir().expect("a folder")
}

/// A load at t = 0 beyond the data is reported before a method is searched for, not after pilot runs.
#[test]
fn a_load_beyond_the_data_at_t_0_is_told_before_a_method_is_searched_for() {
    let folder = folder();
    let bar = format!("length = \"0.5 m\", diameter = \"10 mm\", material = {SHORT}");
    let ends = [r#"kind = "striker", mass = "0.2 kg", velocity = "90 m/s""#, r#"kind = "fixed""#];
    let scene = scene(("any method", "tolerance = 0.05", r#"hardening = "isotropic""#), &bar, ends, "400 us");
    let told = |text: &str| assert!(text.contains("end of the data of short"), "{text}");
    let text = stopped(folder.path(), &scene);
    assert!(text.contains("t = 0.000000e0 s"), "{text}");
    told(&text);
    assert!(!folder.path().join("out.h5").exists(), "no run began: {text}");
    let plan = of(folder.path(), &["plan", "--json"], &scene);
    let plan: Value = serde_json::from_slice(&plan.stdout).expect("one JSON value");
    told(plan["choice"]["how"].as_str().expect("a sentence"));
    let fixed = scene.replace("tolerance = 0.05", "cells = 400");
    let cost = of(folder.path(), &["cost", "--budget", "1s"], &fixed);
    assert_eq!(cost.status.code(), Some(1));
    told(&String::from_utf8_lossy(&cost.stderr));
}

/// A Taylor cylinder of copper, 25.4 mm long and 7.62 mm in diameter, striking a wall.
fn taylor(solver: (&str, &str, &str), velocity: u32) -> String {
    let bar = format!(
        "length = \"25.4 mm\", diameter = \"7.62 mm\", material = \"copper-ofhc-taylor-jc\", velocity = \"-{velocity} m/s\""
    );
    scene(solver, &bar, ["kind = \"wall\"", "kind = \"free\""], "80 us")
}

#[test]
fn a_compressed_bar_that_unloads_is_not_past_its_tension_data() {
    for solver in SOLVERS {
        for velocity in [120, 190] {
            let folder = folder();
            let found = summary(folder.path(), &taylor(solver, velocity));
            assert_eq!(found["outcome"], "done", "{} {velocity}", solver.0);
            let [least, _] = range(&ResultFile::open(&folder.path().join("out.h5")).expect("a result"), Field::Strain);
            let expected = if velocity == 120 { -0.45..-0.25 } else { -0.60..-0.40 };
            assert!(expected.contains(&least), "{} {velocity}: {least}", solver.0);
        }
    }
}

#[test]
fn plan_does_not_take_compression_for_rupture_in_tension() {
    let folder = folder();
    for velocity in [120, 190] {
        let output = of(folder.path(), &["plan", "--json"], &taylor(SOLVERS[0], velocity));
        let plan: Value = serde_json::from_slice(&output.stdout).expect("one JSON value");
        let effects = plan["effects"].as_array().expect("a list");
        let rupture = effects.iter().find(|row| row["effect"] == "rupture").expect("a row");
        let estimate = rupture["estimate"].as_f64().expect("a number");
        assert!(estimate == 0.0, "{velocity}: {rupture}");
    }
}

#[test]
fn steel_that_was_compressed_by_15_percent_unloads() {
    let ends = ["kind = \"velocity\", value = \"130 m/s\", release = \"4 us\"", "kind = \"free\""];
    for solver in SOLVERS {
        let folder = folder();
        let bar = "length = \"50 mm\", area = \"1 cm^2\", material = \"steel-4340-jc\"";
        summary(folder.path(), &scene(solver, bar, ends, "40 us"));
        let [least, _] = range(&ResultFile::open(&folder.path().join("out.h5")).expect("a result"), Field::Strain);
        assert!((-0.25..-0.12).contains(&least), "{}: {least}", solver.0);
    }
}

#[test]
fn an_elastic_point_is_past_no_data_and_a_flowing_one_past_those_of_its_own_sense() {
    let curve = |end: f64| Curve::new(&[(0.001, 200e6), (end, 400e6)], Beyond::Error).expect("rows rise");
    let [tension, compression] = [curve(0.02), curve(0.5)].map(|curve| Table::new(&curve, 200e9));
    let end = DataEnd::new([&tension, &compression], 200e9, Loading::Axial);
    let point = |sense, accumulated: f64, strain: f64| Flowing {
        sense,
        accumulated: 200e9 * accumulated,
        strain: 200e9 * strain,
        held: false,
    };
    let limit = |point: Flowing, flows: bool| end.reached(&point, |_| flows).map(|Reached { limit, .. }| limit);
    // A compression of 0.2 is within the compression data, and beyond the tension data only if the point flows in tension.
    assert_eq!(limit(point(Sense::Compression, 0.198, -0.2), true), None);
    assert_eq!(limit(point(Sense::Tension, 0.198, -0.197), false), None);
    assert_eq!(limit(point(Sense::Tension, 0.198, -0.197), true), Some(Limit::EndOfDataReversed(Sense::Tension)));
    // The last knot has a plastic strain of 0.018.
    assert_eq!(limit(point(Sense::Tension, 0.0179, 0.0199), true), None);
    assert_eq!(limit(point(Sense::Tension, 0.0181, 0.0201), true), Some(Limit::EndOfData(Sense::Tension)));
    assert_eq!(limit(point(Sense::Compression, 1.1, -1.0), false), Some(Limit::FullCompression));
    let shear = DataEnd::new([&tension, &tension], 200e9, Loading::Shear);
    assert_eq!(shear.reached(&point(Sense::Compression, 1.1, -1.1), |_| false), None);
}

/// The strain along a last segment parallel to the elastic line is elastic, so that the plastic strain at its start equals that at the end of the
/// data. No solver may stop there.
#[test]
fn a_last_segment_parallel_to_the_elastic_line_belongs_to_the_data() {
    let foam = r#"{ name = "foam", density = 200, beyond = "error", curve = { table = [[0.01, "1 MPa"], [0.6, "1.2 MPa"], [0.7, "5 MPa"], [0.75, "20 MPa"]] } }"#;
    let bar = format!("length = \"1 m\", area = \"1 cm^2\", material = {foam}");
    let pulled = |solver, speed: u32, hardening: &str| {
        let ends = [&format!("kind = \"velocity\", value = \"-{speed} m/s\""), "kind = \"free\""];
        scene(solver, &bar, ends, "1 ms").replace("hardening = \"isotropic\"", hardening)
    };
    // One shock from (0.01, 1 MPa) to (e, s), with 150 m/s = 0.01 c + sqrt((s - 1 MPa) (e - 0.01)/rho) and s = 5 MPa + 300 MPa (e - 0.7). On grids
    // the elastic segment behind it oscillates; the mean stress is that of the impulse.
    let (strain, impulse) = (0.706_228, -686.839e-3);
    for solver in SOLVERS {
        let plastic = ["hardening = \"isotropic\"", "", "hardening = { mixed = 0.5 }"];
        let kinds = match solver.0 {
            "leapfrog" | "front tracking" => 3,
            // The scheme does not support mixed hardening along a curve that stiffens.
            "muscl" => 2,
            _ => 1,
        };
        for hardening in &plastic[..kinds] {
            let folder = folder();
            let text = pulled(solver, 150, hardening).replace(", \"accumulated_plastic_strain\"", "");
            let found = summary(folder.path(), &text);
            let number = |value: &Value| value.as_f64().expect("a number");
            let off = [
                number(&found["left"]["strain"]) / strain - 1.0,
                number(&found["figures"]["left"]["impulse_N_s"]) / impulse - 1.0,
            ];
            let most = if solver.0 == "front tracking" { 1e-5 } else { 1e-2 };
            assert!(off.iter().all(|off| off.abs() < most), "{} {hardening}: {off:?}", solver.0);
        }
        // This curve reaches the end of its data at 272.2 m/s.
        let text = stopped(folder().path(), &pulled(solver, 290, plastic[0]));
        assert!(text.contains("the end of the data of foam in tension (0.750"), "{}: {text}", solver.0);
    }
}

#[test]
fn library_materials_reach_the_strain_of_a_taylor_cylinder() {
    let mut fits = 0;
    for name in library::names() {
        let material = library::find(name, Path::new(".")).expect("a material of the library");
        let Some(compression) = &material.compression else { continue };
        let (strain, _) = true_from_engineering(Sense::Compression, compression.last_strain(), 0.0);
        assert!(strain > 1.2, "{name}: {strain}");
        fits += 1;
    }
    assert!(fits >= 5, "{fits}");
}

#[test]
fn a_table_to_a_tension_strain_of_2_has_a_compression_table_of_the_same_law() {
    let folder = folder();
    for (to, ends) in [("0.4", [0.4, 0.4]), ("2", [2.0, 0.9])] {
        let text = format!(
            "name = \"m\"\ndensity = 8000\nmodulus = \"124 GPa\"\nmeasure = \"true\"\nsymmetry = \"true\"\n[curve]\n\
             formula = \"johnson-cook\"\nA = \"105.6 MPa\"\nB = \"392.1 MPa\"\nn = 0.2136\ntabulate = {{ to-strain = {to} }}\n"
        );
        let path = folder.path().join("m.toml");
        std::fs::write(&path, text).expect("a folder to write to");
        let material = barwave::material::read(&path).expect("a material");
        let found = [Sense::Tension, Sense::Compression].map(|sense| material.branch(sense).last_strain());
        assert!((0..2).all(|k| (found[k] - ends[k]).abs() < 1e-9), "{to}: {found:?}");
        let curve = material.branch(Sense::Compression);
        for (&strain, &stress) in curve.strain().iter().zip(curve.stress()).filter(|knot| *knot.0 > 0.01) {
            let (strain, stress) = true_from_engineering(Sense::Compression, strain, stress);
            let plastic = strain - stress / 124e9;
            let law = 105.6e6 + 392.1e6 * plastic.powf(0.2136);
            assert!((stress / law - 1.0).abs() < 2e-3, "{strain}: {stress} {law}");
        }
    }
}

#[test]
fn a_run_stops_in_the_step_that_passes_the_data_and_records_nothing_of_it() {
    let bar = format!("length = \"100 mm\", area = \"1 cm^2\", material = {SHORT}");
    // The data suffice for 27 m/s, which the ramp reaches at 13.4 us, between two frames.
    let ramp = "kind = \"velocity\", history = [[0, 0], [20e-6, 40], [40e-6, 40]]";
    for solver in SOLVERS {
        for sense in ["", "-"] {
            let (folder, ends) = (folder(), [&ramp.replace("40]", &format!("{sense}40]")), "kind = \"free\""]);
            let text = stopped(folder.path(), &scene(solver, &bar, ends, "40 us"));
            let name = if sense.is_empty() { "compression" } else { "tension" };
            assert!(text.contains(&format!(" the end of the data of short in {name} (0.0200")), "{}: {text}", solver.0);
            let time: f64 =
                text.split("stopped at t = ").nth(1).and_then(|t| t.split(' ').next()?.parse().ok()).expect("a time");
            assert!((13.2e-6..14.2e-6).contains(&time), "{}: {time}", solver.0);
            let strain: f64 =
                text.split(": strain ").nth(1).and_then(|t| t.split(' ').next()?.parse().ok()).expect("a strain");
            assert!((0.0199..0.0215).contains(&strain), "{}: {strain}", solver.0);
            let file = ResultFile::open(&folder.path().join("out.h5")).expect("a result");
            let frames = file.time().expect("times");
            assert!(frames.len() >= 14 && frames.iter().all(|&t| t < time), "{}: {frames:?} {time}", solver.0);
            assert!(range(&file, Field::Strain).into_iter().all(|e| e.abs() <= 0.02), "{}", solver.0);
            let gauge = file.gauges().expect("gauges").remove(0).trace;
            assert!(
                // The message states the time with seven digits.
                gauge.time.iter().all(|&t| t <= time * (1.0 + 1e-6)) && gauge.strain.iter().all(|e| e.abs() <= 0.02),
                "{}",
                solver.0
            );
        }
    }
}

#[test]
fn data_that_end_at_once_stop_front_tracking_too() {
    let bar = format!("length = \"100 mm\", area = \"1 cm^2\", material = {SHORT}");
    for solver in SOLVERS {
        let folder = folder();
        let ends = ["kind = \"velocity\", value = \"100 m/s\"", "kind = \"free\""];
        let text = stopped(folder.path(), &scene(solver, &bar, ends, "10 us"));
        assert!(text.contains("the end of the data of short in compression"), "{}: {text}", solver.0);
        assert!(!text.contains("strain 0.0200 is beyond"), "{}: {text}", solver.0);
        let file = ResultFile::open(&folder.path().join("out.h5")).expect("a result");
        assert_eq!(file.time().expect("times"), [0.0], "{}", solver.0);
        assert_eq!(range(&file, Field::Strain), [0.0; 2], "{}", solver.0);
    }
}

/// The mean strain of the first cell of a bar struck by a light striker remains below the initial strain of its end. Grids must not continue with the
/// force at the end of the data where front tracking stops.
#[test]
fn a_light_striker_stops_every_method_at_once() {
    let bar = format!("length = \"100 mm\", area = \"1 cm^2\", material = {SHORT}");
    let struck = |velocity: u32| {
        [format!("kind = \"striker\", mass = \"0.2 g\", velocity = {velocity}"), "kind = \"free\"".to_owned()]
    };
    for solver in SOLVERS.into_iter().filter(|solver| !solver.2.contains("rate")) {
        let (stops, runs) = (struck(28), struck(26));
        let folder = folder();
        let text = stopped(folder.path(), &scene(solver, &bar, stops.each_ref().map(String::as_str), "10 us"));
        assert!(text.contains("t = 0.000000e0 s") && text.contains("end of the data of short"), "{}: {text}", solver.0);
        let file = ResultFile::open(&folder.path().join("out.h5")).expect("a result");
        assert_eq!(file.time().expect("times"), [0.0], "{}", solver.0);
        summary(folder.path(), &scene(solver, &bar, runs.each_ref().map(String::as_str), "10 us"));
    }
}

/// A wave in an elastic bar whose data end at yield must not count as one at the largest stress of the bar beside it, which would stop front tracking
/// with "strain 0.1000 is beyond the end of the data".
#[test]
fn an_elastic_bar_beside_one_that_flows_at_one_stress_is_past_no_data() {
    let level =
        "{ density = 8780, modulus = 2e11, beyond = \"extend\", curve = { table = [[1e-3, 2e8], [0.1, 2e8]] } }";
    let elastic = "{ density = 5290, modulus = 7e10, curve = { table = [[0.1, 7e9]] } }";
    let bar = format!(
        "segment = [{{ length = 0.0525, area = 204e-6, material = {level} }}, \
         {{ length = 0.0883, area = 933e-6, material = {elastic}, velocity = 14.2 }}]"
    );
    let ends = ["kind = \"free\"", "kind = \"fixed\""];
    for solver in [SOLVERS[0], SOLVERS[2], SOLVERS[3]] {
        let folder = folder();
        let found = summary(folder.path(), &scene(solver, &bar, ends, "20 us"));
        let force = found["figures"]["right"]["peak_force_N"].as_f64().expect("a force");
        assert!((force / -254.945e3 - 1.0).abs() < 1e-4, "{}: {force}", solver.0);
    }
}

/// The initial state of grids behind a sudden load must not come from one that the curve cannot transmit, a wave at the elastic speed with the
/// velocity of the striker and the largest stress of the data: the run must stop.
#[test]
fn a_bar_that_has_hardened_stops_as_one_that_has_not() {
    let bar =
        |velocity: &str| format!("length = 0.1, area = 1e-4, {velocity} material = {SHORT}, plastic-strain = 1e-4");
    let free = "kind = \"free\"";
    let faces = format!("segment = [{{ {} }}, {{ {} }}]", bar("velocity = 40,"), bar("velocity = -40,"));
    let cases = [
        (bar(""), ["kind = \"striker\", mass = 1, velocity = 40", free]),
        (bar(""), ["kind = \"velocity\", value = 40", free]),
        (faces, [free, free]),
    ];
    for solver in [SOLVERS[0], SOLVERS[2], SOLVERS[3]] {
        for (bar, ends) in &cases {
            let folder = folder();
            let text = stopped(folder.path(), &scene(solver, bar, *ends, "10 us"));
            assert!(text.contains("the end of the data of short in compression"), "{}: {text}", solver.0);
        }
    }
}

#[test]
fn a_bar_that_is_compressed_to_nothing_stops_the_run() {
    let bar = format!("length = \"100 mm\", area = \"1 cm^2\", material = {SOFT}");
    // A strain of -1 corresponds to 1151 m/s.
    let ramp = "kind = \"velocity\", history = [[0, 0], [20e-6, 2000], [40e-6, 2000]]";
    for solver in SOLVERS {
        let folder = folder();
        let text = stopped(folder.path(), &scene(solver, &bar, [ramp, "kind = \"free\""], "40 us"));
        assert!(
            text.contains("material fully compressed: the engineering strain of soft is -1."),
            "{}: {text}",
            solver.0
        );
        let file = ResultFile::open(&folder.path().join("out.h5")).expect("a result");
        let [least, _] = range(&file, Field::Strain);
        assert!(least > -1.0 && least < -0.5, "{}: {least}", solver.0);
    }
    let elastic = r#"{ name = "hard", density = 8000, modulus = "200 GPa", beyond = "extend", curve = { table = [[0.01, "2 GPa"]] } }"#;
    let bar = format!("length = \"100 mm\", area = \"1 cm^2\", material = {elastic}");
    for solver in SOLVERS {
        let (folder, ends) =
            (folder(), ["kind = \"velocity\", history = [[0, 0], [1e-8, 5100], [5e-6, 5100]]", "kind = \"free\""]);
        let text = stopped(folder.path(), &scene(solver, &bar, ends, "5 us"));
        assert!(text.contains("material fully compressed"), "{}: {text}", solver.0);
    }
}

#[test]
fn flow_that_reverses_after_a_large_compression_is_reported() {
    let bar = "length = \"100 mm\", area = \"1 cm^2\", material = \"copper-ofhc-taylor-jc\"";
    let pressed_and_pulled =
        "kind = \"stress\", history = [[0, -400e6], [50e-6, -400e6], [52e-6, 314e6], [90e-6, 314e6]]";
    for solver in SOLVERS {
        let folder = folder();
        let found = summary(folder.path(), &scene(solver, bar, [pressed_and_pulled, "kind = \"absorbing\""], "90 us"));
        let rows = found["audit"].as_array().expect("a list");
        let row =
            rows.iter().find(|row| row["effect"] == "reversal").unwrap_or_else(|| panic!("{}: {rows:?}", solver.0));
        // 400 MPa in compression, compared with at most 315 MPa on the tension curve.
        let estimate = row["estimate"].as_f64().expect("a number");
        assert!((0.18..0.25).contains(&estimate), "{}: {row}", solver.0);
        // No rupture, since nothing is stretched.
        assert_eq!(found["outcome"], "done", "{}", solver.0);
    }
}
