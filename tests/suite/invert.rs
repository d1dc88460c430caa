//! `barwave invert`: bars are simulated, noise is added to their gauges, and the inverted curves agree with the given ones within the stated
//! intervals.

use crate::common::binary;

use std::fmt::Write as _;
use std::path::Path;

use barwave::error::{Error, Result};
use barwave::material::{Curve, Sense, library};
use barwave::record::store::ResultFile;
use barwave::study::invert::{Record, Recording, arrivals, hopkinson, residual};
use binary::{barwave, done, json, refused};
use rand::{RngExt, SeedableRng};
use rand_xorshift::XorShiftRng;
use serde_json::Value;
use tempfile::TempDir;

const BAR: &str = r#"
[bar]
length = 1
area = 1e-4
material = "copper-annealed"
[left]
kind = "velocity"
value = -40
[right]
kind = "free"
[effects]
hardening = "isotropic"
[solve]
until = "450 us"
method = "moc"
[record]
frames = 2
gauges = { a = 0.02, b = 0.04, c = 0.08, d = 0.16, e = 0.32 }
"#;

fn simulated(scene: &str) -> TempDir {
    let folder = tempfile::tempdir().expect("a folder");
    std::fs::write(folder.path().join("scene.toml"), scene).expect("a file");
    done(folder.path(), &["run", "scene.toml", "-o", "bar.h5", "--quiet"]);
    folder
}

/// Returns the value of a record at a time; a front is two rows with the same time.
fn at(time: &[f64], values: &[f64], t: f64) -> f64 {
    let next = time.partition_point(|&own| own <= t);
    if next == 0 || next == time.len() {
        return values[next.saturating_sub(1)];
    }
    let (a, b) = (time[next - 1], time[next]);
    values[next - 1] + (values[next] - values[next - 1]) * ((t - a) / (b - a))
}

/// Returns records of gauges as CSV in us and percent, sampled every 0.1 us, with uniform noise whose standard deviation is the fraction `noise` of
/// the largest strain of each record.
fn records(result: &Path, names: &[&str], noise: f64, seed: u64) -> String {
    let gauges = ResultFile::open(result).expect("a result").gauges().expect("gauges");
    let traces: Vec<_> =
        names.iter().map(|name| &gauges.iter().find(|gauge| gauge.name == *name).expect("a gauge").trace).collect();
    let mut rng = XorShiftRng::seed_from_u64(seed);
    let mut text = format!("time (us);{}\n", names.iter().map(|n| format!("{n} (%)")).collect::<Vec<_>>().join(";"));
    let end = traces[0].time[traces[0].time.len() - 1];
    for k in 0..(end / 1e-7) as usize {
        let t = 1e-7 * k as f64;
        let _ = write!(text, "{}", 1e6 * t);
        for trace in &traces {
            let largest = trace.strain.iter().fold(0.0_f64, |top, e| top.max(e.abs()));
            // A uniform distribution of width w has the standard deviation w/sqrt(12).
            let error = noise * largest * 12.0_f64.sqrt() * (rng.random::<f64>() - 0.5);
            let _ = write!(text, ";{}", 100.0 * (at(&trace.time, &trace.strain, t) + error));
        }
        text.push('\n');
    }
    text
}

/// Returns the fraction of the points above a strain whose intervals contain the curve, the largest relative deviation and the largest relative
/// half-width.
fn against(curve: &Curve, points: &Value, from: f64) -> [f64; 3] {
    let (mut inside, mut count, mut deviation, mut width) = (0.0, 0.0, 0.0_f64, 0.0_f64);
    for point in points.as_array().expect("points") {
        let strain = point["strain"].as_f64().expect("a strain");
        if strain < from {
            continue;
        }
        let number = |key: &str| point["stress_Pa"][key].as_f64().expect("a number");
        let truth = curve.stress_at(strain);
        inside += f64::from(u8::from((number("low")..=number("high")).contains(&truth)));
        count += 1.0;
        deviation = deviation.max((number("value") / truth - 1.0).abs());
        width = width.max(0.5 * (number("high") - number("low")) / truth);
    }
    assert!(count > 5.0, "{count} points");
    [inside / count, deviation, width]
}

fn curve(name: &str) -> Curve {
    library::find(name, Path::new("")).expect("a material").branch(Sense::Tension).clone()
}

#[test]
fn noisy_records_give_back_the_curve_within_its_interval() {
    let folder = simulated(BAR);
    let path = folder.path();
    let copper = curve("copper-annealed");
    let facts = ["--density", "8960 kg/m^3", "--modulus", "115 GPa", "--length", "1 m", "--json"];
    let mut covered = 0.0;
    for seed in 1..=4 {
        std::fs::write(path.join("records.csv"), records(&path.join("bar.h5"), &["a", "b", "c", "d", "e"], 0.01, seed))
            .expect("a file");
        let mut arguments = vec!["invert", "arrivals", "records.csv", "--at", "20mm,40mm,80mm,160mm,320mm"];
        arguments.extend(facts);
        arguments.extend(["-o", "inverted.toml", "--force", "--csv", "curve.csv", "--plot", "curve.svg"]);
        let found = json(path, &arguments);
        let [inside, deviation, width] = against(&copper, &found["points"], 2e-3);
        covered += inside / 4.0;
        // Above 0.2 % of strain, the interval is narrow, and the curve is not far outside.
        assert!(width < 0.05 && deviation < 0.06, "{seed}: {deviation} {width}");
        let [_, deviation, width] = against(&copper, &found["points"], 0.02);
        assert!(width < 0.02 && deviation < 0.02, "{seed}: {deviation} {width}");
    }
    // Deviations accumulate along the curve, so that whole curves are inside or outside.
    assert!(covered >= 0.75, "{covered}");
    assert!(done(path, &["check", "inverted.toml"]).contains("ok"));
    // The inverted material can be simulated: the same impact gives the same stress.
    let stress = |material: &str| {
        let set = format!("bar.material=\"{material}\"");
        let run =
            json(path, &["run", "scene.toml", "-o", "again.h5", "--set", &set, "--set", "left.value=-35", "--json"]);
        run["left"]["stress_Pa"].as_f64().expect("a stress")
    };
    assert!((stress("inverted.toml") / stress("copper-annealed") - 1.0).abs() < 0.01);
}

#[test]
fn a_result_file_without_noise_gives_back_its_curve() {
    let folder = simulated(BAR);
    let copper = curve("copper-annealed");
    for extra in [&["--gauges", "a,e"][..], &["--gauges", "b", "--centred"], &[]] {
        let mut arguments = vec!["invert", "arrivals", "bar.h5", "--json"];
        arguments.extend(extra);
        let found = json(folder.path(), &arguments);
        let [_, deviation, _] = against(&copper, &found["points"], 1e-3);
        assert!(deviation < 0.01, "{extra:?}: {deviation}");
    }
    // Loaded from the right end, in compression.
    let pushed = BAR.replace("[left]", "[other]").replace("[right]", "[left]").replace("[other]", "[right]");
    let folder = simulated(&pushed.replace("a = 0.02, b = 0.04", "a = 0.98, b = 0.9"));
    let found = json(folder.path(), &["invert", "arrivals", "bar.h5", "--gauges", "a,b", "--json"]);
    let compression = library::find("copper-annealed", Path::new("")).expect("a material");
    let [_, deviation, _] = against(compression.branch(Sense::Compression), &found["points"], 1e-3);
    assert!(deviation < 0.01, "{deviation}");
}

#[test]
fn noise_and_intervals_follow_their_seed() {
    let folder = simulated(BAR);
    let found = |seed: &str| {
        done(
            folder.path(),
            &["invert", "arrivals", "bar.h5", "--noise", "1 %", "--replicates", "50", "--seed", seed, "--json"],
        )
    };
    assert_eq!(found("3"), found("3"));
    assert_ne!(found("3"), found("4"));
}

#[test]
fn a_rate_dependent_bar_is_reported() {
    let scene = BAR
        .replace("method = \"moc\"", "cells = 400")
        .replace(
            "hardening = \"isotropic\"",
            "hardening = \"isotropic\"\nrate = { model = \"malvern\", k = \"2e4 1/s\" }",
        )
        .replace("copper-annealed", "mild-steel");
    let folder = simulated(&scene);
    let found = json(folder.path(), &["invert", "arrivals", "bar.h5", "--gauges", "b,d,e", "--json"]);
    assert!(found["warnings"].to_string().contains("rate law"), "{}", found["warnings"]);
    // Near the loaded end the response is elastic: the curve is far above the static one.
    let [_, deviation, _] = against(&curve("mild-steel"), &found["points"], 2e-3);
    assert!(deviation > 0.5, "{deviation}");
}

pub fn joined<'a>(one: &[&'a str], two: &[&'a str]) -> Vec<&'a str> {
    [one, two].concat()
}

/// Returns arrival times (us) at gauges for the power law 500 MPa e^0.4 and 8960 kg/m^3, shifted by the given times.
fn table(displaced: &[f64]) -> String {
    let mut text = String::from("x_mm,strain_%,time_us\n");
    for level in 1..=10 {
        let strain = 0.005 * f64::from(level);
        let speed = (500e6 * 0.4 * strain.powf(-0.6) / 8960.0).sqrt();
        for (k, x) in [0.05, 0.1, 0.2].iter().enumerate() {
            let _ = writeln!(text, "{},{},{}", 1e3 * x, 100.0 * strain, 1e6 * x / speed + 30.0 + displaced[k]);
        }
    }
    text
}

#[test]
fn a_table_of_arrivals_is_inverted() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path();
    let write = |text: &str| std::fs::write(path.join("t.csv"), text).expect("a file");
    write(&table(&[0.0; 3]));
    let arguments = ["invert", "arrivals", "t.csv", "--density", "8960 kg/m^3", "--modulus", "115 GPa"];
    let found = json(path, &joined(&arguments, &["--json", "--time-error", "0.2 us"]));
    let points = found["points"].as_array().expect("points");
    assert_eq!(points.len(), 10);
    for point in points {
        let strain = point["strain"].as_f64().expect("a number");
        let ratio = point["stress_Pa"]["value"].as_f64().expect("a number") / (500e6 * strain.powf(0.4));
        // The elastic part, which the power law lacks, reduces the first level of 60 MPa by 7 MPa.
        assert!((ratio - 1.0).abs() < 0.12 * (0.005 / strain).powf(0.4), "{strain}: {ratio}");
    }
    // Reflected wave: 2 L - x = 0.3 m at 3583 m/s, 114 us with the start time.
    let late = refused(path, &joined(&arguments, &["--length", "0.25 m", "--start", "30 us"]));
    assert!(
        late.contains("t.csv:") && late.contains("reflected from the far end") && late.contains("allowed: t < "),
        "{late}"
    );
    // Two gauges have no scatter.
    write(
        &table(&[0.0; 3])
            .lines()
            .filter(|line| !line.starts_with("100,"))
            .map(|l| l.to_owned() + "\n")
            .collect::<String>(),
    );
    assert!(refused(path, &arguments).contains("scatter of the arrivals is unknown"));
    // One gauge: the characteristics start at the loaded end.
    write(
        &table(&[0.0; 3])
            .lines()
            .filter(|line| !line.starts_with("100,") && !line.starts_with("200,"))
            .map(|l| l.to_owned() + "\n")
            .collect::<String>(),
    );
    let message = refused(path, &joined(&arguments, &["--centred"]));
    assert!(message.contains("one arrival at each gauge"), "{message}");
    write(&table(&[0.0; 3]).replace("50,", "500,"));
    assert!(refused(path, &arguments).contains("arrive at the farther gauges first"));
    write("x_mm,strain,time\n50,abc,1\n");
    let message = refused(path, &arguments);
    assert!(message.contains("t.csv:2") && message.contains("`abc` is not a finite number"), "{message}");
    assert!(refused(path, &arguments[..3]).contains("--density"));
    let message = refused(path, &joined(&arguments, &["--time-error", "1 us", "--replicates", "5"]));
    assert!(message.contains("`--replicates`: 5 is out of range") && message.contains("100000"), "{message}");
    let output = barwave(path, &joined(&arguments, &["--length", "-1 m"]));
    assert_eq!(output.status.code(), Some(2));
}

#[test]
fn the_strain_left_along_a_hard_wire_gives_its_curve() {
    let wire = BAR
        .replace("copper-annealed", "aluminium-6061-t6-jc")
        .replace("length = 1\n", "length = 4\n")
        .replace("value = -40", "value = -40\nrelease = \"300 us\"")
        .replace("method = \"moc\"", "cells = 1600")
        .replace("450 us", "800 us")
        .replace("frames = 2", "frames = 17\ncells = 800\nfields = [\"stress\", \"strain\"]");
    let folder = simulated(&wire);
    let path = folder.path();
    let aluminium = curve("aluminium-6061-t6-jc");
    let mut covered = 0.0;
    for seed in ["1", "2", "3", "4"] {
        let found = json(
            path,
            &[
                "invert",
                "residual-strain",
                "bar.h5",
                "--noise",
                "1 %",
                "--seed",
                seed,
                "--json",
                "-o",
                "w.toml",
                "--force",
            ],
        );
        let [inside, deviation, width] = against(&aluminium, &found["points"], 0.0055);
        covered += inside / 4.0;
        assert!(width < 0.05 && deviation < 0.02, "{seed}: {deviation} {width}");
    }
    assert!(covered > 0.75, "{covered}");
    assert!(done(path, &["check", "w.toml"]).contains("ok"));
    // With the yield stress given, the integral of the wave speeds checks the impact velocity.
    let found = json(path, &["invert", "residual-strain", "bar.h5", "--yield-stress", "288.4 MPa", "--json"]);
    let integral = found["velocity_integral_m_s"]["value"].as_f64().expect("a number");
    assert!((integral / 40.0 - 1.0).abs() < 0.01, "{integral}");
    let wrong = json(path, &["invert", "residual-strain", "bar.h5", "--yield-stress", "388 MPa", "--json"]);
    assert!(wrong["warnings"].to_string().contains("not reliable"), "{}", wrong["warnings"]);
    // The end is still moving.
    let moving = json(path, &["invert", "residual-strain", "bar.h5", "--time", "250 us", "--json"]);
    let [_, deviation, _] = against(&aluminium, &moving["points"], 0.0055);
    assert!(deviation < 0.02, "{deviation}");
    // The material yields near 288 MPa, not where the first speed is 0.01 % below the elastic one; a simulation of the test runs to its end.
    let text = done(path, &["invert", "residual-strain", "bar.h5", "--time", "250 us", "-o", "moving.toml"]);
    assert!(text.contains("wrote moving.toml (past strain 0.03"), "{text}");
    let limit = library::find("moving.toml", path).expect("a material");
    let limit = limit.branch(Sense::Tension).elastic_limit(limit.modulus).1;
    assert!((230e6..310e6).contains(&limit), "{limit:e}");
    done(path, &["run", "scene.toml", "-o", "again.h5", "--quiet", "--set", "bar.material=w.toml"]);
}

/// Returns strain, stress (Pa) and wave speed (m/s) of a steel that yields at 300 MPa, for a plastic strain.
fn steel(plastic: f64) -> (f64, f64, f64) {
    let (stress, hardening) = (300e6 + 900e6 * plastic.powf(0.6), 540e6 * plastic.powf(-0.4));
    (stress, stress / 205e9 + plastic, (1.0 / (7850.0 * (1.0 / 205e9 + 1.0 / hardening))).sqrt())
}

/// Returns the stress of an inverted point of the steel relative to the true one, and whether its interval, wider by `rounding`, contains the true one.
fn against_steel(point: &Value, rounding: f64) -> (f64, bool) {
    let number = |key: &str| point["stress_Pa"][key].as_f64().expect("a number");
    let strain = point["strain"].as_f64().expect("a strain");
    let plastic = (0..40).fold(strain, |p, _| strain - steel(p.max(0.0)).0 / 205e9).max(0.0);
    let truth = steel(plastic).0.min(205e9 * strain);
    let interval = number("low") * (1.0 - rounding)..=number("high") * (1.0 + rounding);
    (number("value") / truth, interval.contains(&truth))
}

/// The waves that have passed the end of the profile must not be extrapolated with the power of the first two levels, which would give 49 MPa instead
/// of 320 MPa at a strain of 0.003.
#[test]
fn a_profile_that_ends_on_the_elastic_plateau_gives_the_curve() {
    let time = 300e-6;
    let at = |x: f64| {
        let (mut low, mut high) = (1e-9, 1.0);
        for _ in 0..200 {
            let middle = 0.5 * (low + high);
            if steel(middle).2 * time > x { low = middle } else { high = middle }
        }
        low
    };
    let largest = at(0.2);
    let rows = (1..=200).map(|k| 0.005 * f64::from(k)).map(|x| format!("{x},{}\n", steel(at(x).min(largest)).1));
    // The velocity behind all fronts.
    let parts: Vec<(f64, f64)> =
        (0..=4000).map(|k| steel(largest * f64::from(k) / 4000.0)).map(|(_, e, c)| (e, c)).collect();
    let past_yield: f64 = parts.windows(2).skip(1).map(|p| 0.5 * (p[0].1 + p[1].1) * (p[1].0 - p[0].0)).sum();
    let velocity = (205e9_f64 / 7850.0).sqrt() * parts[1].0 + past_yield;
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path();
    std::fs::write(path.join("wire.csv"), "x,strain\n".to_owned() + &rows.collect::<String>()).expect("a file");
    let (velocity, fixed) =
        (velocity.to_string(), ["--time", "300 us", "--density", "7850", "--modulus", "205 GPa", "--json"]);
    for (more, bound) in [(&[][..], 0.1), (&["--yield-stress", "300 MPa"][..], 0.05)] {
        let all = [&["invert", "residual-strain", "wire.csv", "--velocity", &velocity][..], &fixed, more].concat();
        let short = joined(&all, &["--length", "0.4 m"]);
        assert!(binary::failed(path, &short, 2).contains("the bar is 0.4 m long"), "sections past the end");
        let found = json(path, &all);
        for point in found["points"].as_array().expect("points") {
            let [strain, stress] =
                [&point["strain"], &point["stress_Pa"]["value"]].map(|v| v.as_f64().expect("a number"));
            let (mut low, mut high) = (1e-12, 1.0);
            for _ in 0..200 {
                let middle = 0.5 * (low + high);
                if steel(middle).1 < strain { low = middle } else { high = middle }
            }
            assert!(
                (stress / steel(low).0 - 1.0).abs() < bound,
                "{more:?}, {strain}: {stress:e}, not {:e}",
                steel(low).0
            );
        }
    }
}

/// Noise hid the wave that has passed the far end: 5 % to 25 % was missing from all stresses, and the intervals did not contain them.
#[test]
fn noise_does_not_hide_the_elastic_plateau_at_the_end_of_a_profile() {
    let (time, largest) = (300e-6, 0.06);
    let at = |x: f64| {
        let plastic = |low: f64, high: f64| {
            if steel(0.5 * (low + high)).2 * time > x { (0.5 * (low + high), high) } else { (low, 0.5 * (low + high)) }
        };
        (0..200).fold((1e-9, 1.0), |(low, high), _| plastic(low, high)).0.min(largest)
    };
    let parts: Vec<(f64, f64)> =
        (0..=4000).map(|k| steel(largest * f64::from(k) / 4000.0)).map(|(_, e, c)| (e, c)).collect();
    let past_yield: f64 = parts.windows(2).skip(1).map(|p| 0.5 * (p[0].1 + p[1].1) * (p[1].0 - p[0].0)).sum();
    let velocity = ((205e9_f64 / 7850.0).sqrt() * parts[1].0 + past_yield).to_string();
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path();
    let mut inside = 0;
    for seed in 0..4 {
        let mut rng = XorShiftRng::seed_from_u64(seed);
        let mut text = String::from("x,strain\n");
        for x in (1..=1000).map(|k| 1e-3 * f64::from(k)) {
            // Uniform noise of 300 microstrain, a fifth of the plateau.
            let _ = writeln!(text, "{x},{}", steel(at(x)).1 + 300e-6 * 12.0_f64.sqrt() * (rng.random::<f64>() - 0.5));
        }
        std::fs::write(path.join("wire.csv"), text).expect("a file");
        let arguments = "invert residual-strain wire.csv --time 300us --density 7850 --modulus 205GPa --length 4m --json --velocity";
        let found = json(path, &joined(&arguments.split_whitespace().collect::<Vec<_>>(), &[&velocity]));
        let points = found["points"].as_array().expect("points");
        let (ratio, contains) = against_steel(&points[points.len() - 1], 0.0);
        assert!((ratio - 1.0).abs() < 0.2, "{ratio}");
        inside += u32::from(contains);
    }
    assert_eq!(inside, 4);
}

#[test]
fn a_soft_wire_goes_on_yielding_after_its_release() {
    let wire = BAR
        .replace("length = 1\n", "length = 2\n")
        .replace("value = -40", "value = -40\nrelease = \"300 us\"")
        .replace("method = \"moc\"", "cells = 800")
        .replace("450 us", "700 us")
        .replace("frames = 2", "frames = 15\nfields = [\"strain\", \"plastic_strain\"]");
    let folder = simulated(&wire);
    let message = refused(folder.path(), &["invert", "residual-strain", "bar.h5"]);
    assert!(message.contains("more than the impact velocity") && message.contains("--time"), "{message}");
    let found = json(folder.path(), &["invert", "residual-strain", "bar.h5", "--time", "250 us", "--json"]);
    let [_, deviation, _] = against(&curve("copper-annealed"), &found["points"], 5e-3);
    assert!(deviation < 0.02, "{deviation}");
    let integral = found["velocity_integral_m_s"]["value"].as_f64().expect("a number");
    assert!((integral / 40.0 - 1.0).abs() < 0.01, "{integral}");
}

#[test]
fn a_split_hopkinson_test_gives_back_the_specimen_s_curve() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path();
    let scene = Path::new(env!("CARGO_MANIFEST_DIR")).join("runs/split-hopkinson.toml");
    done(path, &["run", &scene.to_string_lossy(), "-o", "bar.h5", "--quiet", "--set", "solve.cells=4000"]);
    let copper = library::find("copper-annealed", Path::new("")).expect("a material");
    let copper = copper.branch(Sense::Compression);
    std::fs::write(path.join("test.csv"), records(&path.join("bar.h5"), &["incident", "transmitted"], 0.01, 7))
        .expect("a file");
    let setup = "--bar-modulus 200GPa --bar-density 7850kg/m^3 --bar-diameter 16mm --distances 1m,1m --specimen-length 4mm \
                 --specimen-diameter 10mm --json --plot test.svg --csv moments.csv -o dynamic.toml";
    let mut arguments = vec!["invert", "hopkinson", "test.csv", "--density", "8960 kg/m^3"];
    arguments.extend(setup.split_whitespace());
    let measured = json(path, &arguments);
    let result = json(path, &["invert", "hopkinson", "bar.h5", "--json", "--noise", "1 %"]);
    for (found, fewest) in [(&measured, 20), (&result, 20)] {
        let knots = found["curve"].as_array().expect("a curve");
        assert!(knots.len() >= fewest, "{}", knots.len());
        let mut inside = 0;
        for knot in knots {
            let number = |key: &str| knot[key].as_f64().expect("a number");
            let (stress, half) = (number("stress_Pa"), number("stress_half_width_Pa"));
            let truth = copper.stress_at(number("strain"));
            assert!((stress / truth - 1.0).abs() < 0.03 && half < 0.05 * stress, "{knot}");
            inside += usize::from((stress - truth).abs() <= half);
        }
        assert!(10 * inside >= 9 * knots.len(), "{inside} of {}", knots.len());
        assert_eq!(found["sense"], "compression");
        let from = found["equilibrium_from_s"].as_f64().expect("equilibrium");
        assert!((10e-6..80e-6).contains(&from), "{from}");
    }
    assert!(done(path, &["check", "dynamic.toml"]).contains("ok"));
    // With the modulus of the specimen, the part before equilibrium is elastic; without it, the first chord is the modulus.
    assert!(measured["warnings"].to_string().contains("the material has no elastic part"), "{}", measured["warnings"]);
    let text = done(path, &["invert", "hopkinson", "bar.h5", "-o", "known.toml"]);
    assert!(text.contains("elastic part      up to ") && text.contains("a modulus of 115 GPa"), "{text}");
    let known = library::find("known.toml", path).expect("a material");
    let (strain, limit) = known.branch(Sense::Compression).elastic_limit(known.modulus);
    assert!(
        (known.modulus / 115e9 - 1.0).abs() < 1e-12 && strain < 0.002 && (50e6..150e6).contains(&limit),
        "{strain} {limit:e}"
    );
    // One wave and three waves agree on average: their stresses at the end of the loading differ by the imbalance.
    let table = std::fs::read_to_string(path.join("moments.csv")).expect("a table");
    assert!(table.lines().count() > 400 && table.starts_with("time_s,strain,rate_1_s,stress_Pa,strain_one_wave,"));
    // The mean strain rate is that of the rows between the two times stated with it.
    let rows = table.lines().skip(1).map(|line| line.split(',').map(|cell| cell.parse().expect("a number")).collect());
    let rows: Vec<Vec<f64>> = rows.collect();
    let [from, to] = [0, 1].map(|k| measured["mean_rate_between_s"][k].as_f64().expect("a time"));
    let rates: Vec<f64> = rows.iter().filter(|row| (from..=to).contains(&row[0])).map(|row| row[2]).collect();
    let mean = rates.iter().sum::<f64>() / rates.len() as f64;
    assert!((measured["mean_rate_1_s"].as_f64().expect("a rate") / mean - 1.0).abs() < 1e-6, "{mean}");
    // Nothing is written without equilibrium.
    arguments.extend(["--equilibrium", "0.01 %", "--force"]);
    arguments.retain(|argument| *argument != "--json");
    assert!(refused(path, &arguments).contains("does not reach equilibrium"));
    assert!(refused(path, &["invert", "hopkinson", "test.csv"]).contains("--distances"));
    // A result file contains the data of its bars; options for them are refused.
    for option in [["--bar-modulus", "100 GPa"], ["--distances", "1m,1m"], ["--specimen-diameter", "10 mm"]] {
        let message = refused(path, &joined(&["invert", "hopkinson", "bar.h5"], &option));
        assert!(message.contains(option[0]) && message.contains("result file"), "{message}");
    }
    std::fs::write(path.join("two.csv"), "time,incident\n0,0\n1,1\n").expect("a file");
    let mut wrong = vec!["invert", "hopkinson", "two.csv"];
    wrong.extend(setup.split_whitespace().take(12));
    assert!(refused(path, &wrong).contains("2 columns"));
}

/// The transmitted pulse takes 12 us through 15 mm of a soft polymer, which was said to be an error of the gauge distances.
#[test]
fn the_way_through_a_soft_specimen_is_no_wrong_distance() {
    let scene = std::fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join("runs/split-hopkinson.toml"));
    let soft = "{ name = \"soft\", density = 1200, modulus = \"2 GPa\", beyond = \"extend\", \
                curve = { table = [[0.01, \"20 MPa\"], [0.5, \"40 MPa\"]] } }";
    let scene = scene
        .expect("a scene")
        .replace("\"4 mm\"", "\"15 mm\"")
        .replace("\"copper-annealed\"", soft)
        .replace("3.404 m", "3.415 m")
        .replace("cells = 8000", "cells = 4000")
        .replace("frames = 101", "frames = 2");
    let folder = simulated(&scene);
    let path = folder.path();
    std::fs::write(path.join("test.csv"), records(&path.join("bar.h5"), &["incident", "transmitted"], 0.0, 7))
        .expect("a file");
    let transmitted = |arguments: &[&str]| -> Vec<String> {
        let found = json(path, &joined(&["invert", "hopkinson", "--json"], arguments));
        let warnings = found["warnings"].as_array().expect("warnings").iter().filter_map(Value::as_str);
        warnings.filter(|text| text.starts_with("the transmitted pulse arrives")).map(str::to_owned).collect()
    };
    assert_eq!(transmitted(&["bar.h5"]), [""; 0]);
    let bars = "test.csv --bar-modulus 200GPa --bar-density 7850kg/m^3 --bar-diameter 16mm --specimen-length 15mm \
                --specimen-diameter 10mm --distances";
    let bars: Vec<&str> = bars.split_whitespace().collect();
    let unknown: &[&str] = &[];
    let known: &[&str] = &["--modulus", "2 GPa", "--density", "1200 kg/m^3"];
    let with = |distances: &'static str, specimen: &[&'static str]| {
        transmitted(&joined(&joined(&bars, &[distances]), specimen))
    };
    for specimen in [unknown, known] {
        assert_eq!(with("1m,1m", specimen), [""; 0], "{specimen:?}");
    }
    // 10 cm are 20 us, 5 cm are 10 us. Without modulus and density, 21 us may be the way through the specimen.
    for (distances, specimen) in [("1m,0.9m", unknown), ("1m,0.9m", known), ("1m,0.95m", known)] {
        let warnings = with(distances, specimen);
        let [warning] = &warnings[..] else { panic!("{distances} {specimen:?}: {warnings:?}") };
        let words =
            "m: unless the wave takes that time through the specimen, stresses and strains are wrong; a distance of";
        assert!(warning.contains("us after its time") && warning.contains(words), "{warning}");
    }
    assert!(with("1m,1.1m", unknown)[0].contains("us before its time"));
}

/// Returns strains, wave speeds and velocities of the steel up to 5 % of plastic strain, which the end reaches in 25 us.
fn levels_of_steel() -> Vec<(f64, f64, f64)> {
    let states: Vec<_> = (1..=2000).map(|k| steel(0.05 * (f64::from(k) / 2000.0).powi(4))).collect();
    let (c0, limit) = ((205e9_f64 / 7850.0).sqrt(), 300e6 / 205e9);
    let mut levels = vec![(0.0, c0, 0.0), (limit, c0, limit * c0)];
    for (_, strain, speed) in states {
        let before = levels[levels.len() - 1];
        levels.push((strain, speed, before.2 + 0.5 * (before.1 + speed) * (strain - before.0)));
    }
    levels
}

/// Records without noise, rounded to 0.1 % of strain, had intervals that did not contain the stresses.
#[test]
fn the_intervals_of_arrivals_contain_the_rounding() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path();
    let levels = levels_of_steel();
    let fastest = levels[levels.len() - 1].2;
    let strain: Vec<f64> = levels.iter().map(|level| level.0).collect();
    let arrivals = [0.03, 0.06, 0.12, 0.24]
        .map(|x| levels.iter().map(|level| 25e-6 * level.2 / fastest + x / level.1).collect::<Vec<f64>>());
    let mut text = String::from("time_us,a_%,b_%,c_%,d_%\n");
    for k in 0..900 {
        let t = 1e-6 * f64::from(k) - 20e-6;
        let _ = write!(text, "{}", 1e6 * t);
        for arrivals in &arrivals {
            let _ = write!(text, ",{:.1}", 100.0 * at(arrivals, &strain, t));
        }
        text.push('\n');
    }
    std::fs::write(path.join("records.csv"), text).expect("a file");
    let arguments = "invert arrivals records.csv --at 30mm,60mm,120mm,240mm --density 7850kg/m^3 --modulus 205GPa --length 4m --json";
    let found = json(path, &arguments.split_whitespace().collect::<Vec<_>>());
    let points = found["points"].as_array().expect("points");
    let inside = points.iter().filter(|point| against_steel(point, 1e-3).1);
    let inside = inside.count();
    assert!(10 * inside >= 9 * points.len(), "{inside} of {}", points.len());
}

#[test]
fn noise_does_not_lower_the_stresses_of_arrivals() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path();
    // The end gets to 5 % of plastic strain in 25 us.
    let levels = levels_of_steel();
    let (top, _, fastest) = levels[levels.len() - 1];
    let strain: Vec<f64> = levels.iter().map(|level| level.0).collect();
    let (mut deviation, mut inside) = (0.0, 0);
    for seed in 1..=8 {
        let mut rng = XorShiftRng::seed_from_u64(seed);
        let mut text = String::from("time_us,a,b,c,d\n");
        let arrivals = [0.03, 0.06, 0.12, 0.24]
            .map(|x| levels.iter().map(|level| 25e-6 * level.2 / fastest + x / level.1).collect::<Vec<f64>>());
        for k in 0..900 {
            let t = 1e-6 * f64::from(k) - 20e-6;
            let _ = write!(text, "{}", 1e6 * t);
            for arrivals in &arrivals {
                let noise = 0.01 * top * 12.0_f64.sqrt() * (rng.random::<f64>() - 0.5);
                let _ = write!(text, ",{}", at(arrivals, &strain, t) + noise);
            }
            text.push('\n');
        }
        std::fs::write(path.join("records.csv"), text).expect("a file");
        let arguments = "invert arrivals records.csv --at 30mm,60mm,120mm,240mm --density 7850kg/m^3 --modulus 205GPa --length 4m --json";
        let found = json(path, &arguments.split_whitespace().collect::<Vec<_>>());
        let points = found["points"].as_array().expect("points");
        let (ratio, contains) = against_steel(&points[points.len() - 1], 0.0);
        deviation += (ratio - 1.0) / 8.0;
        inside += u32::from(contains);
    }
    // Single records scatter by 3.5 %: three standard errors of the mean of eight.
    assert!(deviation.abs() < 0.037 && inside >= 7, "{deviation} {inside}");
}

/// A split-Hopkinson test: gauges 1 m from a specimen of 5 mm length and 10 mm diameter, bars of 16 mm, records that start 100 us before the pulse.
/// The specimen is elastic (70 GPa) up to 300 MPa + 400 MPa `e_p^0.4`, and always in equilibrium.
pub struct Kolsky {
    pub time: Vec<f64>,
    pub incident: Vec<f64>,
    pub transmitted: Vec<f64>,
}

pub const KOLSKY: [&str; 12] = [
    "--bar-modulus",
    "200 GPa",
    "--bar-density",
    "7850 kg/m^3",
    "--bar-diameter",
    "16 mm",
    "--distances",
    "1m,1m",
    "--specimen-length",
    "5 mm",
    "--specimen-diameter",
    "10 mm",
];

impl Kolsky {
    /// Returns a test with a pulse of 12 m/s of this length (s), with edges of 15 us.
    pub fn of(length: f64) -> Self {
        Self::yielding_at(300e6, length)
    }

    /// Returns a test with another elastic limit, Pa.
    pub fn yielding_at(limit: f64, length: f64) -> Self {
        let c0 = (200e9_f64 / 7850.0).sqrt();
        let (dt, edge, ratio) = (1e-7, 15e-6, (10.0_f64 / 16.0).powi(2));
        let pulse = |t: f64| 12.0 / (2.0 * c0) * (t / edge).min((length + edge - t) / edge).clamp(0.0, 1.0);
        let (mut strain, mut plastic, mut stress) = (0.0_f64, 0.0_f64, 0.0_f64);
        let mut reflected_transmitted = Vec::new();
        for k in 0..((length + 4.0 * edge) / dt) as usize {
            let incident = pulse(dt * k as f64);
            strain += 2.0 * c0 / 5e-3 * (incident - ratio * stress / 200e9) * dt;
            while 70e9 * (strain - plastic) > limit + 400e6 * plastic.powf(0.4) {
                plastic += 1e-7;
            }
            stress = (70e9 * (strain - plastic)).max(0.0);
            let transmitted = ratio * stress / 200e9;
            reflected_transmitted.push((transmitted - incident, transmitted));
        }
        let at = |t: f64| reflected_transmitted.get((t / dt).round() as usize).filter(|_| t >= 0.0).copied();
        let (start, way) = (100e-6, 2.0 / c0);
        let time: Vec<f64> = (0..1800).map(|k| 5e-7 * f64::from(k)).collect();
        let incident =
            time.iter().map(|&t| -pulse(t - start) - at(t - start - way).map_or(0.0, |pair| pair.0)).collect();
        let transmitted = time.iter().map(|&t| -at(t - start - way).map_or(0.0, |pair| pair.1)).collect();
        Self { time, incident, transmitted }
    }

    /// Writes the records in microstrain, with zero offsets and uniform noise of 2 microstrain.
    pub fn write(&self, path: &Path, header: &str, offsets: [f64; 2]) {
        let mut rng = XorShiftRng::seed_from_u64(3);
        let mut text = format!("{header}\n");
        for ((t, i), d) in self.time.iter().zip(&self.incident).zip(&self.transmitted) {
            let [i, d] = [(i, offsets[0]), (d, offsets[1])]
                .map(|(e, offset)| 1e6 * (e + offset) + 2.0 * 12.0_f64.sqrt() * (rng.random::<f64>() - 0.5));
            let _ = writeln!(text, "{},{i},{d}", 1e6 * t);
        }
        std::fs::write(path, text).expect("a file");
    }
}

pub const MICRO: &str = "time_us,incident (ue),transmitted (ue)";

#[test]
fn a_record_that_resolves_the_elastic_limit_gives_it() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path();
    Kolsky::yielding_at(200e6, 200e-6).write(&path.join("test.csv"), MICRO, [0.0; 2]);
    let arguments = "invert hopkinson test.csv --modulus 70GPa --density 2700kg/m^3 -o known.toml --json";
    let found = json(path, &joined(&arguments.split_whitespace().collect::<Vec<_>>(), &KOLSKY));
    let known = library::find("known.toml", path).expect("a material");
    let limit = known.branch(Sense::Compression).elastic_limit(known.modulus).1;
    // Rows at the elastic limit are 4e-4 of strain apart: 28 MPa.
    assert!((limit - 200e6).abs() < 28e6, "{limit:e}");
    // Between the knots, too.
    let knots: Vec<[f64; 2]> = found["curve"]
        .as_array()
        .expect("a curve")
        .iter()
        .map(|knot| ["strain", "stress_Pa"].map(|key| knot[key].as_f64().expect("a number")))
        .collect();
    for pair in knots.windows(2).filter(|pair| pair[0][0] > 0.003) {
        let [strain, stress] = [0, 1].map(|k| 0.5 * (pair[0][k] + pair[1][k]));
        let plastic = (0..40).fold(strain, |p, _| strain - (200e6 + 400e6 * p.max(0.0).powf(0.4)) / 70e9);
        let truth = 200e6 + 400e6 * plastic.max(0.0).powf(0.4);
        assert!((stress / truth - 1.0).abs() < 0.03, "{strain}: {stress:e}, {truth:e}");
    }
}

#[test]
fn zero_offsets_of_the_gauges_are_removed() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path();
    let test = Kolsky::of(200e-6);
    test.write(&path.join("clean.csv"), MICRO, [0.0; 2]);
    test.write(&path.join("offset.csv"), MICRO, [30e-6, 15e-6]);
    let reduced = |name: &str| json(path, &joined(&["invert", "hopkinson", name, "--json"], &KOLSKY));
    let (clean, offset) = (reduced("clean.csv"), reduced("offset.csv"));
    let number = |value: &Value| value.as_f64().expect("a number");
    for (k, expected) in [30e-6, 15e-6].into_iter().enumerate() {
        let found = number(&offset["zero_offsets"][k]) - number(&clean["zero_offsets"][k]);
        assert!((found / expected - 1.0).abs() < 1e-9 && number(&offset["noise"][k]) < 2.5e-6, "{found}");
    }
    let knots = |value: &Value| value["curve"].as_array().expect("a curve").clone();
    let (clean, offset) = (knots(&clean), knots(&offset));
    assert!(clean.len() > 30 && clean.len() == offset.len(), "{} {}", clean.len(), offset.len());
    let mut inside = 0;
    for (a, b) in clean.iter().zip(&offset) {
        let [stress, strain, half] = ["stress_Pa", "strain", "stress_half_width_Pa"].map(|key| number(&b[key]));
        assert!((stress / number(&a["stress_Pa"]) - 1.0).abs() < 1e-9, "{a} {b}");
        // The total strain of a specimen that flows plastically.
        let plastic = (0..40).fold(strain, |p, _| strain - (300e6 + 400e6 * p.max(0.0).powf(0.4)) / 70e9);
        inside += usize::from((stress - 300e6 - 400e6 * plastic.max(0.0).powf(0.4)).abs() <= half);
        assert!(half < 0.02 * stress || strain < 0.01, "{b}");
    }
    assert!(10 * inside >= 8 * clean.len(), "{inside} of {}", clean.len());
    let text = done(path, &joined(&["invert", "hopkinson", "offset.csv"], &KOLSKY));
    assert!(text.contains("zero offsets") && text.contains("ue transmitted, removed"), "{text}");
    assert!(text.contains("sense             compression, since the incident pulse is negative"), "{text}");
    let pulled = joined(&["invert", "hopkinson", "offset.csv", "--sense", "tension", "--json"], &KOLSKY);
    assert_eq!(json(path, &pulled)["sense"], "tension");
    // The table ends with the loading.
    assert!(text.contains("the table ends there"), "{text}");
    let rates = text.lines().skip_while(|line| !line.contains("rate 1/s")).skip(1);
    let rates: Vec<f64> = rates.filter_map(|line| line.split_whitespace().nth(2)?.parse().ok()).collect();
    assert!(rates.len() > 5 && rates.iter().all(|rate| *rate > 0.0), "{text}");
}

/// An offset of 50 microstrain would increase the stress by 6 %.
#[test]
fn zero_offsets_of_gauges_along_a_bar_are_removed() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path();
    // Elastic up to 60 MPa (120 GPa), then 2 GPa; pulled at 20 m/s, 20 us after the start of the record.
    let c = [120e9_f64, 2e9].map(|modulus| (modulus / 8000.0).sqrt());
    let largest = 5e-4 + (20.0 - 5e-4 * c[0]) / c[1];
    let places = [0.05, 0.1, 0.2];
    let write = |name: &str, offset: f64| {
        let mut rng = XorShiftRng::seed_from_u64(5);
        let mut text = String::from("time_us,a_ue,b_ue,c_ue\n");
        for k in 0..2000 {
            let t = 2e-7 * f64::from(k) - 20e-6;
            let _ = write!(text, "{}", 1e6 * t);
            for x in places {
                let strain = if t > x / c[1] {
                    largest
                } else if t > x / c[0] {
                    5e-4
                } else {
                    0.0
                };
                let noise = 2.0 * 12.0_f64.sqrt() * (rng.random::<f64>() - 0.5);
                let _ = write!(text, ",{}", 1e6 * (strain + offset) + noise);
            }
            text.push('\n');
        }
        std::fs::write(path.join(name), text).expect("a file");
    };
    write("clean.csv", 0.0);
    write("offset.csv", 2e-4);
    let fixed = ["--at", "50mm,100mm,200mm", "--density", "8000", "--modulus", "120 GPa"];
    let found = |name: &str| json(path, &joined(&["invert", "arrivals", name, "--json"], &fixed));
    let last = |found: &Value| {
        let points = found["points"].as_array().expect("points");
        points[points.len() - 1]["stress_Pa"]["value"].as_f64().expect("a number")
    };
    let (clean, offset) = (found("clean.csv"), found("offset.csv"));
    assert!((last(&offset) / last(&clean) - 1.0).abs() < 0.005, "{} {}", last(&clean), last(&offset));
    for found in offset["zero_offsets"].as_array().expect("offsets") {
        assert!((found.as_f64().expect("a number") / 2e-4 - 1.0).abs() < 0.02, "{found}");
    }
    let short = joined(&["invert", "arrivals", "offset.csv", "--length", "150 mm"], &fixed);
    assert!(refused(path, &short).contains("the bar is 0.15 m long"), "a gauge past the end");
    let text = done(path, &joined(&["invert", "arrivals", "offset.csv"], &fixed));
    assert!(text.contains("zero offsets      ") && text.contains("ue, removed"), "{text}");
}

#[test]
fn records_that_cannot_be_reduced_are_refused() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path();
    let test = Kolsky::of(200e-6);
    let refusal = |name: &str, parts: &[&str]| {
        let arguments = joined(&["invert", "hopkinson", name, "--density", "2700 kg/m^3", "-o", "curve.toml"], &KOLSKY);
        let message = refused(path, &arguments);
        for part in parts {
            assert!(message.contains(part), "{part}: {message}");
        }
        assert!(!path.join("curve.toml").exists(), "{name}");
    };
    // 2 m/c0 = 396.2 us.
    Kolsky::of(450e-6).write(&path.join("long.csv"), MICRO, [0.0; 2]);
    refusal("long.csv", &["long.csv", "cannot be separated", "396.2 us", "striker shorter", "move the gauge"]);
    test.write(&path.join("plain.csv"), "time_us,incident,transmitted", [0.0; 2]);
    refusal("plain.csv", &["plain.csv:", "unit is not given", "|strain| <= 0.02", "incident_ue"]);
    // A record in microseconds without a unit, read as seconds, is refused with a message on the unit.
    test.write(&path.join("seconds.csv"), "time,incident (ue),transmitted (ue)", [0.0; 2]);
    refusal(
        "seconds.csv",
        &["seconds.csv:", " s, as a plain number since the unit is not given", "<= 0.1 s", "time_us"],
    );
    test.write(&path.join("usec.csv"), "time_usec,incident (ue),transmitted (ue)", [0.0; 2]);
    refusal("usec.csv", &["usec.csv:1:1", "unknown unit `usec`", "a unit of a time, or none", "`time [s]`"]);
    test.write(&path.join("mm.csv"), "time_mm,incident (ue),transmitted (ue)", [0.0; 2]);
    refusal("mm.csv", &["mm.csv:1:1", "`mm` is a length, but a time is expected"]);
    // Volts were read as strains.
    for unit in ["V", "mV", "MPa", "kN", "mm"] {
        for heading in [format!("incident_{unit}"), format!("incident ({unit})"), format!("incident [{unit}]")] {
            test.write(&path.join("units.csv"), &format!("time_us,{heading},transmitted (ue)"), [0.0; 2]);
            refusal(
                "units.csv",
                &["units.csv:1:9", &format!("in the heading `{heading}`"), &format!("`{unit}`"), "% or ue"],
            );
        }
    }
    let kept = |rows: &[f64], late: bool| rows.iter().skip(if late { 240 } else { 0 }).copied().collect();
    let late = Kolsky {
        time: kept(&test.time, true),
        incident: kept(&test.incident, true),
        transmitted: kept(&test.transmitted, true),
    };
    late.write(&path.join("late.csv"), MICRO, [0.0; 2]);
    refusal("late.csv", &["late.csv", "starts inside the pulse", "pre-trigger"]);
    let exchanged = Kolsky {
        time: kept(&test.time, false),
        incident: kept(&test.transmitted, false),
        transmitted: kept(&test.incident, false),
    };
    exchanged.write(&path.join("exchanged.csv"), MICRO, [0.0; 2]);
    refusal("exchanged.csv", &["exchanged.csv", "before the incident pulse", "are exchanged"]);
    let negative = Kolsky {
        time: kept(&test.time, false),
        incident: kept(&test.incident, false),
        transmitted: test.transmitted.iter().map(|e| -e).collect(),
    };
    negative.write(&path.join("negative.csv"), MICRO, [0.0; 2]);
    refusal("negative.csv", &["negative.csv", "transmitted pulse", "the same sign", "wrong sign"]);
}

#[test]
fn a_specimen_wider_than_the_bars_is_noted() {
    let folder = tempfile::tempdir().expect("a folder");
    Kolsky::of(200e-6).write(&folder.path().join("test.csv"), MICRO, [0.0; 2]);
    let arguments: Vec<&str> = KOLSKY.iter().map(|a| if *a == "10 mm" { "20 mm" } else { *a }).collect();
    let found = json(folder.path(), &joined(&["invert", "hopkinson", "test.csv", "--json"], &arguments));
    assert!(found["warnings"].to_string().contains("wider than the bars"), "{}", found["warnings"]);
}

/// Returns stress (Pa) and wave speed (m/s) of a steel that yields sharply at 200 MPa.
fn sharp(strain: f64) -> [f64; 2] {
    let (density, past) = (7850.0, strain - 1e-3);
    if past < 0.0 {
        return [200e9 * strain, (200e9_f64 / density).sqrt()];
    }
    let stress = 200e6 + 600e6 * ((past + 1e-4).powf(0.45) - 1e-4_f64.powf(0.45));
    [stress, (600e6 * 0.45 * (past + 1e-4).powf(-0.55) / density).sqrt()]
}

#[test]
fn what_lies_between_the_levels_of_a_table_is_in_the_interval() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path();
    let arguments = ["invert", "arrivals", "t.csv", "--density", "7850", "--modulus", "200 GPa", "--length", "5m"];
    for levels in [&[0.002, 0.003, 0.005, 0.01, 0.02, 0.04][..], &[0.0005, 0.002, 0.003, 0.005, 0.01, 0.02, 0.04]] {
        let mut text = String::from("x_mm,strain_%,time_us\n");
        for level in levels {
            for x in [20.0, 40.0, 80.0, 160.0, 320.0] {
                let _ = writeln!(text, "{x},{},{:.3}", 100.0 * level, 1e3 * x / sharp(*level)[1]);
            }
        }
        std::fs::write(path.join("t.csv"), text).expect("a file");
        let found = json(path, &joined(&arguments, &["--json"]));
        let points = found["points"].as_array().expect("points");
        assert_eq!(points.len(), levels.len());
        for (point, level) in points.iter().zip(levels) {
            let number = |key: &str| point["stress_Pa"][key].as_f64().expect("a number");
            let [truth, _] = sharp(*level);
            assert!((number("low")..=number("high")).contains(&truth), "{level}: {truth:e} {point}");
            assert!((number("low")..=number("high")).contains(&number("value")), "{point}");
        }
    }
    std::fs::write(path.join("t.csv"), "x_mm,strain,time_us\n20,0.5,23\n40,0.5,47\n20,1,29\n40,1,59\n")
        .expect("a file");
    let message = refused(path, &arguments);
    assert!(message.contains("t.csv:5") && message.contains("unit is not given"), "{message}");
    assert!(message.contains("strain_%"), "{message}");
}

#[test]
fn results_of_other_impacts_are_named() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path();
    let scene = Path::new(env!("CARGO_MANIFEST_DIR")).join("runs/spheres.toml");
    done(path, &["run", &scene.to_string_lossy(), "-o", "spheres.h5", "--quiet"]);
    for arguments in [
        &["invert", "arrivals", "spheres.h5"][..],
        &["invert", "hopkinson", "spheres.h5"],
        &["invert", "residual-strain", "spheres.h5"],
        &["compare", "spheres.h5", "spheres.h5"],
    ] {
        let message = refused(path, arguments);
        assert!(message.contains("an impact of the kind `spheres`") && !message.contains("damaged"), "{message}");
        assert!(message.contains("[bar]") && message.contains("barwave report"), "{message}");
    }
}

/// Checks that a value is refused with the name of its key, without options of the command line.
fn names<T>(ended: Result<T>, key: &str) {
    let Err(Error::Input(error)) = ended.map(|_| ()) else { panic!("{key} is accepted") };
    assert!(error.key == key && !error.allowed.is_empty() && !error.help.contains("--"), "{key}: {error:?}");
}

const REPLICATES_OUT_OF_RANGE: [usize; 5] = [0, 1, 19, 100_001, usize::MAX];

const NONE: [f64; 4] = [f64::NAN, f64::INFINITY, 0.0, -1.0];

#[test]
fn a_split_hopkinson_set_of_a_program_is_checked() {
    let bar = hopkinson::ElasticBar { modulus: 200e9, density: 8000.0, area: 2e-4, distance: 1.0 };
    let set = hopkinson::Setup { incident: bar, transmitted: bar, length: 0.01, area: 1e-4 };
    let options = hopkinson::Options { equilibrium: 0.05, ..hopkinson::Options::default() };
    let (time, on): (Vec<f64>, _) =
        ((0..8000).map(|k| 1e-7 * f64::from(k) - 5e-5).collect(), |t: f64| (0.0..1e-4).contains(&t));
    let strain = |part: f64, from: f64| time.iter().map(|t| if on(t - from) { part } else { 0.0 }).collect::<Vec<_>>();
    let sum = |one: Vec<f64>, other: Vec<f64>| one.iter().zip(other).map(|(a, b)| a + b).collect::<Vec<f64>>();
    let records = hopkinson::Records {
        incident: (time.clone(), sum(strain(-1e-3, 0.0), strain(5e-4, 4e-4))),
        transmitted: (time.clone(), strain(-5e-4, 4e-4)),
    };
    let reduce = |set: hopkinson::Setup, options: hopkinson::Options| hopkinson::reduce(&set, &records, &options);
    assert!(reduce(set.clone(), options.clone()).is_ok());
    for wrong in NONE {
        names(reduce(hopkinson::Setup { length: wrong, ..set.clone() }, options.clone()), "length");
        names(reduce(hopkinson::Setup { area: wrong, ..set.clone() }, options.clone()), "area");
        let incident = hopkinson::ElasticBar { modulus: wrong, ..bar };
        names(reduce(hopkinson::Setup { incident, ..set.clone() }, options.clone()), "incident.modulus");
        let transmitted = hopkinson::ElasticBar { density: wrong, ..bar };
        names(reduce(hopkinson::Setup { transmitted, ..set.clone() }, options.clone()), "transmitted.density");
        names(reduce(set.clone(), hopkinson::Options { window: Some(wrong), ..options.clone() }), "window");
        names(reduce(set.clone(), hopkinson::Options { equilibrium: wrong, ..options.clone() }), "equilibrium");
        names(reduce(set.clone(), hopkinson::Options { speed: Some(wrong), ..options.clone() }), "speed");
    }
    let given = |records: hopkinson::Records| hopkinson::reduce(&set, &records, &options);
    let with = |change: &dyn Fn(&mut hopkinson::Records)| {
        let mut records = records.clone();
        change(&mut records);
        given(records)
    };
    names(with(&|records| records.incident.1.truncate(3000)), "incident.strain");
    names(with(&|records| records.transmitted.0.truncate(3000)), "transmitted.strain");
    names(with(&|records| records.incident.1[3000] = f64::NAN), "incident.strain");
    names(with(&|records| records.transmitted.0[3000] = f64::INFINITY), "transmitted.time");
    names(with(&|records| records.transmitted.0.reverse()), "transmitted.time");
}

#[test]
fn records_of_a_program_are_checked_before_their_inversion() {
    let record = |distance: f64| {
        let time: Vec<f64> = (0..4000).map(|k| 1e-7 * f64::from(k)).collect();
        // d eps such that the speed is 3 km/s/sqrt(1 + eps/0.002).
        let strain =
            |t: &f64| if distance < 3000.0 * t { 0.002 * ((3000.0 * t / distance).powi(2) - 1.0) } else { 0.0 };
        let strain = time.iter().map(|t| strain(t).min(0.02)).collect();
        Record { name: distance.to_string(), distance, time, strain }
    };
    let recording = Recording {
        records: [0.05, 0.1, 0.2].map(record).to_vec(),
        sense: Sense::Tension,
        density: None,
        modulus: None,
        length: None,
        given: None,
        simulated: false,
        notes: Vec::new(),
    };
    let options = arrivals::Options { density: 8960.0, replicates: 20, ..arrivals::Options::default() };
    assert!(arrivals::of_records(&recording, &options).is_ok());
    names(arrivals::of_records(&recording, &arrivals::Options::default()), "density");
    for replicates in REPLICATES_OUT_OF_RANGE {
        names(arrivals::of_records(&recording, &arrivals::Options { replicates, ..options.clone() }), "replicates");
    }
    for wrong in NONE {
        let with = |options: arrivals::Options| arrivals::of_records(&recording, &options);
        names(with(arrivals::Options { density: wrong, ..options.clone() }), "density");
        names(with(arrivals::Options { modulus: Some(wrong), ..options.clone() }), "modulus");
        names(with(arrivals::Options { length: Some(wrong), ..options.clone() }), "length");
        if wrong != 0.0 {
            names(with(arrivals::Options { position_error: wrong, ..options.clone() }), "position_error");
        }
        if !wrong.is_finite() {
            names(with(arrivals::Options { start: wrong, ..options.clone() }), "start");
        }
    }
    let with = |change: &dyn Fn(&mut Record)| {
        let mut recording = recording.clone();
        change(&mut recording.records[1]);
        arrivals::of_records(&recording, &options)
    };
    names(with(&|record| record.strain.truncate(100)), "records.1.strain");
    names(with(&|record| record.strain[100] = f64::NAN), "records.1.strain");
    names(with(&|record| record.time.swap(100, 200)), "records.1.time");
    names(with(&|record| record.distance = f64::NAN), "records.1.distance");
}

#[test]
fn a_profile_of_a_program_is_checked_before_its_inversion() {
    let distance: Vec<f64> = (1..=60).map(|k| 0.01 * f64::from(k)).collect();
    // While the end moves, a strain is at x = c t.
    let strain = distance.iter().map(|x| (0.002 * ((3000.0 * 2e-4 / x).powi(2) - 1.0)).clamp(0.0, 0.02)).collect();
    let profile = residual::Profile { distance, strain, sense: Sense::Tension };
    let options = residual::Options {
        state: residual::State::Loaded,
        time: 2e-4,
        velocity: 40.0,
        density: 8960.0,
        modulus: 115e9,
        replicates: 20,
        ..residual::Options::default()
    };
    assert!(residual::invert(&profile, &options).is_ok());
    names(residual::invert(&profile, &residual::Options::default()), "time");
    for replicates in REPLICATES_OUT_OF_RANGE {
        names(residual::invert(&profile, &residual::Options { replicates, ..options.clone() }), "replicates");
    }
    for wrong in NONE {
        let with = |options: residual::Options| residual::invert(&profile, &options);
        names(with(residual::Options { time: wrong, ..options.clone() }), "time");
        names(with(residual::Options { velocity: wrong, ..options.clone() }), "velocity");
        names(with(residual::Options { density: wrong, ..options.clone() }), "density");
        names(with(residual::Options { modulus: wrong, ..options.clone() }), "modulus");
        names(with(residual::Options { length: Some(wrong), ..options.clone() }), "length");
    }
    let with = |change: &dyn Fn(&mut residual::Profile)| {
        let mut profile = profile.clone();
        change(&mut profile);
        residual::invert(&profile, &options)
    };
    names(with(&|profile| profile.distance.truncate(50)), "profile.strain");
    names(with(&|profile| profile.strain.truncate(50)), "profile.strain");
    names(with(&|profile| profile.strain[20] = f64::NAN), "profile.strain");
    names(with(&|profile| profile.distance.reverse()), "profile.distance");
    let few = |profile: &mut residual::Profile| {
        profile.distance.truncate(4);
        profile.strain.truncate(4);
    };
    names(with(&few), "profile");
}
