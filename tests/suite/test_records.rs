//! `barwave materials import` of records of known curves, through the real binary.

use crate::common::binary;
use crate::common::synthetic;

use std::fmt::Write as _;
use std::path::Path;

use barwave::test_record::{Reduce, combine, reduce, straighten};
use binary::barwave;
use serde_json::Value;
use synthetic::{BILINEAR, CLEAN, Faults, LABORATORY, RAMBERG_OSGOOD, Truth, csv, record};

const DENSITY: f64 = 7850.0;

fn import(folder: &Path, name: &str, text: &str, options: &[&str]) -> Value {
    std::fs::write(folder.join(name), text).expect("a file");
    let fixed = ["materials", "import", name, "--density", "7850", "--force", "--json", "-o", "m.toml"];
    let output = barwave(folder, &[&fixed, options].concat());
    assert!(output.status.success(), "{name}: {}", String::from_utf8_lossy(&output.stderr));
    serde_json::from_slice(&output.stdout).expect("JSON")
}

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or_else(|| panic!("{value} is no number"))
}

/// Checks that modulus, proof stress and critical velocity are within 1 % of those of the true curve.
fn within_a_percent(found: &Value, truth: &Truth, what: &str) {
    let reduction = &found["records"][0]["reduction"];
    for (name, value, expected) in [
        ("modulus", &found["modulus_Pa"], truth.modulus),
        ("proof stress", &reduction["proof_stress_Pa"], truth.proof_stress()),
        ("critical velocity", &found["critical"]["critical_velocity_m_s"], truth.critical_velocity(DENSITY)),
    ] {
        let value = number(value);
        assert!((value / expected - 1.0).abs() < 0.01, "{what}: {name} {value:e}, expected {expected:e}: {found:#}");
    }
    assert!(reduction["knots"].as_array().is_some_and(|knots| knots.len() < 100), "{what}: too many knots");
}

#[test]
fn noise_toe_unloading_and_fracture_cost_less_than_a_percent() {
    let folder = tempfile::tempdir().expect("a folder");
    let cases = [
        ("clean", Faults { fractures: true, ..CLEAN }),
        ("noise of 0.5 % of the reading", Faults { relative_noise: 0.005, fractures: true, ..CLEAN }),
        ("noise of 0.5 % of full scale", Faults { noise: 0.005, fractures: true, ..CLEAN }),
        ("toe", Faults { toe: 3e-4, fractures: true, ..CLEAN }),
        ("unloading", Faults { unloads: true, fractures: true, ..CLEAN }),
        ("all", LABORATORY),
        ("all, other numbers", Faults { seed: 2, ..LABORATORY }),
    ];
    for (truth, curve) in [(&RAMBERG_OSGOOD, "Ramberg-Osgood"), (&BILINEAR, "bilinear")] {
        for (name, faults) in &cases {
            let found = import(folder.path(), "a.csv", &csv(&record(truth, faults)), &[]);
            within_a_percent(&found, truth, &format!("{curve}, {name}"));
        }
    }
}

#[test]
fn formats_units_and_dimensions_of_instruments_give_the_same_curve() {
    let folder = tempfile::tempdir().expect("a folder");
    let rows = record(&RAMBERG_OSGOOD, &Faults { rows: 1500, ..LABORATORY });
    let expected = import(folder.path(), "a.csv", &csv(&rows), &[]);
    let area = std::f64::consts::FRAC_PI_4 * 6e-3 * 6e-3;
    let table = |line: &dyn Fn(f64, f64) -> String| rows.iter().map(|&(e, s)| line(e, s)).collect::<String>();
    let comma = |number: String| number.replace('.', ",");
    let zwick = String::from("Specimen;S1\n\n\"Zeit\";\"Standardweg\";\"Standardkraft\"\ns;mm;kN\n")
        + &table(&|e, s| {
            format!("0,1;{};{}\n", comma(format!("{:.9}", 25.0 * e)), comma(format!("{:.9}", s * area / 1e3)))
        });
    let tabs = String::from("Time (s)\tStrain (%)\tLoad (N)\n")
        + &table(&|e, s| format!("1\t{:.7}\t{:.6}\n", 100.0 * e, s * area));
    let psi = table(&|e, s| format!("{},{}\n", -e, -s / 6_894.757_293_168_361));
    let steps = ["--gauge-length", "25 mm", "--diameter", "6 mm"];
    let cases: [(&str, &str, &[&str]); 4] = [
        ("zwick.csv", &zwick, &[&steps[..], &["--extension-column", "Standardweg", "--force-column", "3"]].concat()),
        ("tabs.txt", &tabs, &["--area", "28.274333882308138 mm^2"]),
        ("psi.csv", &psi, &["--unit", "psi", "--sense", "compression"]),
        ("again.csv", &csv(&rows), &["--stress-column", "2", "--strain-column", "strain"]),
    ];
    for (name, text, options) in cases {
        let found = import(folder.path(), name, text, options);
        for key in ["modulus_Pa", "elastic_limit_Pa"] {
            assert!((number(&found[key]) / number(&expected[key]) - 1.0).abs() < 2e-3, "{name}: {key}: {found:#}");
        }
        let velocity = |found: &Value| number(&found["critical"]["critical_velocity_m_s"]);
        assert!((velocity(&found) / velocity(&expected) - 1.0).abs() < 2e-3, "{name}: {found:#}");
    }
}

#[test]
fn text_of_any_instrument_is_read() {
    let folder = tempfile::tempdir().expect("a folder");
    let rows = record(&RAMBERG_OSGOOD, &Faults { rows: 1500, ..LABORATORY });
    let expected = import(folder.path(), "a.csv", &csv(&rows), &[]);
    let table = |line: &dyn Fn(f64, f64) -> String| rows.iter().map(|&(e, s)| line(e, s)).collect::<String>();
    let blanks = String::from("# strain stress_MPa\n") + &table(&|e, s| format!("  {e:.8}   {:.5}\n", s / 1e6));
    let micro =
        String::from("Microstrain\tStress (MPa)\n") + &table(&|e, s| format!("{:.3}\t{:.5}\n", 1e6 * e, s / 1e6));
    let latin = String::from("Dehnung in %;Spannung in N/mm\u{b2}\n")
        + &table(&|e, s| format!("{:.6};{:.5}\n", 100.0 * e, s / 1e6).replace('.', ","));
    let thousands = String::from("Strain (%),Stress (psi)\n")
        + &table(&|e, s| {
            let psi = s / 6_894.757_293_168_361;
            let (kilo, rest) = ((psi / 1e3).trunc(), (psi % 1e3).abs());
            if kilo == 0.0 {
                format!("{:.6},{psi:.3}\n", 100.0 * e)
            } else {
                format!("{:.6},\"{kilo},{rest:07.3}\"\n", 100.0 * e)
            }
        });
    let single =
        |text: &str| text.chars().map(|c| u8::try_from(c).expect("a character of Latin-1")).collect::<Vec<u8>>();
    let utf16 = |text: &str| [0xFF, 0xFE].into_iter().chain(text.encode_utf16().flat_map(u16::to_le_bytes)).collect();
    let files: [(&str, Vec<u8>); 5] = [
        ("blanks.dat", blanks.clone().into()),
        ("micro.txt", micro.into()),
        ("latin.csv", single(&latin)),
        ("utf16.txt", utf16(&blanks)),
        ("thousands.csv", thousands.into()),
    ];
    for (name, bytes) in files {
        std::fs::write(folder.path().join(name), bytes).expect("a file");
        let fixed = ["materials", "import", name, "--density", "7850", "--force", "--json", "-o", "m.toml"];
        let output = barwave(folder.path(), &fixed);
        assert!(output.status.success(), "{name}: {}", String::from_utf8_lossy(&output.stderr));
        let found: Value = serde_json::from_slice(&output.stdout).expect("JSON");
        for key in ["modulus_Pa", "elastic_limit_Pa"] {
            assert!((number(&found[key]) / number(&expected[key]) - 1.0).abs() < 2e-3, "{name}: {key}: {found:#}");
        }
    }
}

#[test]
fn strains_in_percent_without_a_unit_are_refused() {
    let folder = tempfile::tempdir().expect("a folder");
    let rows = record(&RAMBERG_OSGOOD, &LABORATORY);
    let mut text = String::from("strain,stress_MPa\n");
    for (e, s) in &rows {
        let _ = writeln!(text, "{},{}", 100.0 * e, s / 1e6);
    }
    std::fs::write(folder.path().join("a.csv"), text).expect("a file");
    let with = |more: &[&str]| {
        barwave(folder.path(), &[&["materials", "import", "a.csv", "--density", "7850"], more].concat())
    };
    let refused = with(&[]);
    let message = String::from_utf8_lossy(&refused.stderr);
    assert_eq!(refused.status.code(), Some(2), "{message}");
    assert!(message.contains("--strain-unit") && message.contains("at most 2"), "{message}");
    assert!(!folder.path().join("a.toml").exists());
    assert!(with(&["--strain-unit", "%", "--strain-col", "1"]).status.success());
}

#[test]
fn true_stress_and_machine_compliance_are_converted() {
    let folder = tempfile::tempdir().expect("a folder");
    let rows = record(&RAMBERG_OSGOOD, &Faults { toe: 0.0, ..LABORATORY });
    let mut text = String::from("true strain,true stress (MPa)\n");
    for (e, s) in &rows {
        let _ = writeln!(text, "{:.8},{:.5}", e.ln_1p(), s * (1.0 + e) / 1e6);
    }
    within_a_percent(&import(folder.path(), "true.csv", &text, &[]), &RAMBERG_OSGOOD, "true stress");
    let soft: Vec<_> = rows.iter().map(|&(e, s)| (e + s / 100e9, s)).collect();
    let found = import(folder.path(), "soft.csv", &csv(&soft), &["--modulus", "205 GPa", "--compliance"]);
    within_a_percent(&found, &RAMBERG_OSGOOD, "compliance");
}

/// Returns engineering strain and stress (Pa) of a material with a sharp knee at 200 MPa (modulus 100 GPa) in logarithmic strain and true stress.
fn with_sharp_knee(plastic: f64) -> (f64, f64) {
    let stress = 200e6 + 400e6 * plastic.powf(0.6);
    let strain = stress / 100e9 + plastic;
    (strain.exp_m1(), stress * (-strain).exp())
}

/// Returns 40 rows up to the knee and 260 beyond: the exact ones, and as text with noise and rounding of the true stress (MPa).
fn sharp_knee_record(last: f64, noise: f64, step: f64) -> (Vec<(f64, f64)>, String) {
    let mut random = synthetic::Random::new(3);
    let elastic = (0..40).map(|i| 0.002 * f64::from(i) / 39.0).map(|e: f64| (e.exp_m1(), 100e9 * e * (-e).exp()));
    let plastic = (1..=260).map(|i| with_sharp_knee(last * f64::from(i) / 260.0));
    let rows: Vec<(f64, f64)> = elastic.chain(plastic).collect();
    let mut text = String::from("true strain,true stress (MPa)\n");
    for (e, s) in &rows {
        let read = s * (1.0 + e) / 1e6 + noise * random.normal();
        let rounded = if step > 0.0 { (read / step).round() * step } else { read };
        let _ = writeln!(text, "{:.9},{rounded:.6}", e.ln_1p());
    }
    (rows, text)
}

/// For a clean record, the curve passes through its rows, including the knee; with noise, it is as close as the noise allows.
#[test]
fn smoothing_keeps_a_sharp_knee() {
    let folder = tempfile::tempdir().expect("a folder");
    // Largest plastic strain, noise and rounding step in MPa; allowed errors of the elastic limit, the proof stress and the critical velocity in %,
    // and of rows beyond the knee in MPa.
    for (last, noise, step, limit, proof, velocity, off) in [
        (0.03, 0.0, 0.0, 0.5, 0.05, 0.2, 0.4),
        (0.2, 0.0, 0.0, 1.5, 0.1, 0.5, 0.6),
        (0.03, 0.1, 0.0, 1.0, 0.2, 0.3, 0.6),
        (0.2, 0.5, 0.0, 2.5, 0.6, 1.0, 2.0),
        (0.2, 0.0, 1.0, 2.5, 0.6, 1.0, 2.0),
    ] {
        let (rows, text) = sharp_knee_record(last, noise, step);
        let found = import(folder.path(), "a.csv", &text, &["--beyond", "rupture"]);
        let what = format!("{last}, noise {noise}, step {step}");
        let near = |name: &str, value: &Value, expected: f64, percent: f64| {
            let error = 100.0 * (number(value) / expected - 1.0);
            assert!(error.abs() < percent, "{what}: {name} {value}, expected {expected:e}, {error} % off");
        };
        let curve: Vec<(f64, f64)> =
            (0..=20_000).map(|i| with_sharp_knee(last * (f64::from(i) / 2e4).powi(3))).collect();
        let top = (0..curve.len()).max_by(|a, b| curve[*a].1.total_cmp(&curve[*b].1)).expect("points");
        let front = |(a, b): ((f64, f64), (f64, f64))| ((b.0 - a.0) * (b.1 - a.1).max(0.0) / DENSITY).sqrt();
        let knee = with_sharp_knee(0.0);
        let critical = front(((0.0, 0.0), knee)) + curve[..=top].windows(2).map(|p| front((p[0], p[1]))).sum::<f64>();
        let crossing = curve.iter().find(|(e, s)| *s <= 100e9 * (e - 0.002)).expect("a proof stress");
        near("elastic limit", &found["elastic_limit_Pa"], knee.1, limit);
        near("proof stress", &found["records"][0]["reduction"]["proof_stress_Pa"], crossing.1, proof);
        near("critical velocity", &found["critical"]["critical_velocity_m_s"], critical, velocity);
        let knots: Vec<(f64, f64)> =
            serde_json::from_value(found["records"][0]["reduction"]["knots"].clone()).expect("knots");
        for &(strain, stress) in rows[40..].iter().filter(|row| row.0 <= knots[knots.len() - 1].0) {
            let k = knots.partition_point(|knot| knot.0 <= strain).clamp(1, knots.len() - 1);
            let (a, b) = (knots[k - 1], knots[k]);
            let error = (a.1 + (b.1 - a.1) * (strain - a.0) / (b.0 - a.0) - stress) / 1e6;
            assert!(error.abs() < off, "{what}: {error} MPa off at strain {strain}");
        }
    }
}

/// Returns equidistant rows of two straight lines from 0, with strains rounded to a step.
fn rounded_strains(modulus: f64, knee: f64, spacing: f64, step: f64) -> Vec<(f64, f64)> {
    let stress = |e: f64| if e < knee { modulus * e } else { modulus * (knee + 0.01 * (e - knee)) };
    (0..300).map(|i| spacing * f64::from(i)).map(|e| ((e / step).round() * step, stress(e))).collect()
}

/// Up to the first extra step of the strain, the rows are exactly on a line, which must not be taken for the elastic one: the limit would be 18 to 91
/// % too low.
#[test]
fn rounded_strains_do_not_end_the_elastic_line() {
    let folder = tempfile::tempdir().expect("a folder");
    for (modulus, knee, spacing, step) in [
        (200e9, 0.0015, 0.03 / 298.0, 1e-5),
        (200e9, 0.0015, 0.03 / 249.0, 1e-5),
        (70e9, 250e6 / 70e9, 0.03 / 299.0, 1e-5),
        (70e9, 250e6 / 70e9, 1.02e-4, 5e-5),
        (210e9, 0.005, 5.306e-5, 1e-6),
    ] {
        let rows = rounded_strains(modulus, knee, spacing, step);
        let found = import(folder.path(), "a.csv", &csv(&rows), &[]);
        let what = format!("{modulus:e} Pa, spacing {spacing:e}, step {step:e}: {found:#}");
        assert!((number(&found["modulus_Pa"]) / modulus - 1.0).abs() < 0.03, "{what}");
        assert!((number(&found["elastic_limit_Pa"]) / (modulus * knee) - 1.0).abs() < 0.005, "{what}");
    }
}

/// With strains rounded to 1e-8 and to 1e-6, different intervals of nearly the same uncertainty are the best ones, and their slopes differ by 1.9
/// GPa: the stated uncertainty must cover this difference, and not be smaller by a factor of 2.6.
#[test]
fn the_uncertainty_of_the_modulus_covers_the_choice_of_the_interval() {
    let folder = tempfile::tempdir().expect("a folder");
    let text = include_str!("../data/noisy-elastic-line.csv");
    let lines: Vec<(f64, &str)> = text
        .lines()
        .skip(1)
        .map(|line| line.split_once(',').expect("two columns"))
        .map(|(strain, stress)| (strain.parse().expect("a number"), stress))
        .collect();
    let [(fine, error), (rounded, other)] = [8, 6].map(|digits| {
        let rows =
            lines.iter().fold(String::new(), |text, (strain, stress)| format!("{text}{strain:.digits$},{stress}\n"));
        let found = import(folder.path(), "a.csv", &format!("strain,stress (MPa)\n{rows}"), &[]);
        let line = &found["records"][0]["reduction"]["line"];
        (number(&line["slope_Pa"]), number(&line["standard_error_Pa"]))
    });
    let (apart, error) = ((fine - rounded).abs(), error.hypot(other));
    assert!(apart < 2.0 * error && error < 3e9, "{apart:e} Pa apart, {error:e} Pa");
}

/// The row at the upper yield point must not be removed as an outlier, which would make the limit 8 to 12 % too low.
#[test]
fn an_upper_yield_point_of_one_row_is_the_elastic_limit() {
    let folder = tempfile::tempdir().expect("a folder");
    for elastic_rows in [12, 16, 25] {
        let spacing = 1.75e-3 / f64::from(elastic_rows);
        let stress = |e: f64| if e < 1.7501e-3 { 200e9 * e } else { 300e6 + 3e9 * (e - 0.01).max(0.0) };
        let rows: Vec<_> = (0..32 * elastic_rows).map(|i| spacing * f64::from(i)).map(|e| (e, stress(e))).collect();
        let found = import(folder.path(), "a.csv", &csv(&rows), &[]);
        let error = number(&found["elastic_limit_Pa"]) / 350e6 - 1.0;
        assert!(error.abs() < 1e-3, "{elastic_rows} elastic rows: {error}: {found:#}");
        let knots: Vec<(f64, f64)> =
            serde_json::from_value(found["records"][0]["reduction"]["knots"].clone()).expect("knots");
        assert!((knots[2].1 / 300e6 - 1.0).abs() < 1e-3, "{elastic_rows} elastic rows: {knots:?}");
    }
}

/// The options for the measure, the toe and the smoothing window, each compared with the default.
#[test]
fn measure_toe_and_smoothing_can_be_set() {
    let folder = tempfile::tempdir().expect("a folder");
    let rows = record(&RAMBERG_OSGOOD, &Faults { toe: 0.0, ..LABORATORY });
    let mut truth = String::from("strain,stress (MPa)\n");
    for (e, s) in &rows {
        let _ = writeln!(truth, "{:.8},{:.5}", e.ln_1p(), s * (1.0 + e) / 1e6);
    }
    let found = import(folder.path(), "true.csv", &truth, &["--measure", "true"]);
    within_a_percent(&found, &RAMBERG_OSGOOD, "true stress by --measure");
    // A window as wide as the knee of the curve rounds it; a narrow one does not.
    let clean = csv(&record(&RAMBERG_OSGOOD, &CLEAN));
    let found = import(folder.path(), "window.csv", &clean, &["--smooth", "0.1 %"]);
    within_a_percent(&found, &RAMBERG_OSGOOD, "a window of 0.1 %");
    let proof = |window: &str| {
        let found = import(folder.path(), "window.csv", &clean, &["--smooth", window]);
        number(&found["records"][0]["reduction"]["proof_stress_Pa"])
    };
    let [narrow, wide] = ["0.1 %", "8 %"].map(proof);
    assert!((wide / narrow - 1.0).abs() > 0.003, "{narrow} {wide}");
    // Strains that are all 0.1 % too high remain so.
    let shifted: Vec<_> = rows.iter().map(|&(e, s)| (e + 1e-3, s)).collect();
    let end = |toe: &str| {
        let found = import(folder.path(), "toe.csv", &csv(&shifted), &["--toe", toe]);
        let knots = found["records"][0]["reduction"]["knots"].as_array().expect("knots").clone();
        number(&knots[knots.len() - 1][0])
    };
    let off = end("off") - end("on");
    assert!((off / 1e-3 - 1.0).abs() < 0.05, "{off}");
}

/// A compression curve used in tension, and a record of negative loads imported as a tension test, are noted.
#[test]
fn the_sense_of_a_record_is_noted() {
    let folder = tempfile::tempdir().expect("a folder");
    let text = csv(&record(&RAMBERG_OSGOOD, &LABORATORY).into_iter().map(|(e, s)| (-e, -s)).collect::<Vec<_>>());
    let notes = |more: &[&str]| import(folder.path(), "a.csv", &text, more)["notes"].to_string();
    assert!(notes(&[]).contains("add `--sense compression`"), "{}", notes(&[]));
    assert!(notes(&["--sense", "compression"]).contains("import a tension test"));
}

#[test]
fn the_file_states_what_was_done_and_runs() {
    let folder = tempfile::tempdir().expect("a folder");
    let text = csv(&record(&RAMBERG_OSGOOD, &LABORATORY));
    let found = import(folder.path(), "a.csv", &text, &["--plot", "a.svg"]);
    let written = std::fs::read_to_string(folder.path().join("m.toml")).expect("the file");
    for part in [
        "of one unloading removed",
        "after the fracture removed",
        "toe: strains shifted",
        "points kept",
        "beyond = \"rupture\"",
    ] {
        assert!(written.contains(part), "{part}: {written}");
    }
    assert!(!written.contains("\nconfidence") && !written.contains("\ncitation"), "no source is stated: {written}");
    let svg = std::fs::read_to_string(folder.path().join("a.svg")).expect("the figure");
    assert!(["record", "knots", "proof stress", "fracture"].iter().all(|word| svg.contains(word)));
    let scene = "[bar]\nlength = \"1 m\"\nmaterial = \"m.toml\"\n[left]\nkind = \"velocity\"\nvalue = -20\n[right]\nkind = \"free\"\n\
                 [solve]\nuntil = \"100 us\"\nmethod = \"moc\"\n";
    std::fs::write(folder.path().join("s.toml"), scene).expect("a file");
    let run = barwave(folder.path(), &["run", "s.toml", "--json", "-o", "s.h5"]);
    assert!(run.status.success(), "{}", String::from_utf8_lossy(&run.stderr));
    let summary: Value = serde_json::from_slice(&run.stdout).expect("JSON");
    let (a, b) = (number(&summary["critical_velocity_m_s"]), number(&found["critical"]["critical_velocity_m_s"]));
    assert!((a / b - 1.0).abs() < 1e-9, "{a} {b}");
    let cited = import(folder.path(), "a.csv", &text, &["--citation", "N. N., Laboratory, 2026"]);
    assert!(cited["written"].is_string());
    let written = std::fs::read_to_string(folder.path().join("m.toml")).expect("the file");
    assert!(
        written.contains("citation = \"N. N., Laboratory, 2026\"") && written.contains("confidence = \"measured\"")
    );
}

#[test]
fn repeats_give_one_curve_with_a_band_that_critical_uses() {
    let folder = tempfile::tempdir().expect("a folder");
    let scales = [0.96, 0.98, 1.0, 1.02, 1.04];
    for (k, scale) in scales.iter().enumerate() {
        let rows = record(&RAMBERG_OSGOOD, &Faults { seed: 10 + k as u64, ..LABORATORY });
        // Strains and stresses are scaled by the same factor: the modulus is unchanged, the critical velocity is proportional to the factor.
        let scaled: Vec<_> = rows.into_iter().map(|(e, s)| (scale * e, scale * s)).collect();
        std::fs::write(folder.path().join(format!("{k}.csv")), csv(&scaled)).expect("a file");
    }
    let arguments = [
        "materials",
        "import",
        "0.csv",
        "1.csv",
        "2.csv",
        "3.csv",
        "4.csv",
        "--density",
        "7850",
        "-o",
        "m.toml",
        "--plot",
        "m.svg",
    ];
    let output = barwave(folder.path(), &arguments);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let svg = std::fs::read_to_string(folder.path().join("m.svg")).expect("the figure");
    assert!([", slow tension tests", ">records<", ">4.csv<"].iter().all(|words| svg.contains(words)), "{svg}");
    let critical = |threads: &str| {
        let output = barwave(folder.path(), &["critical", "m.toml", "--json", "--threads", threads]);
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        output.stdout
    };
    let text = critical("1");
    assert_eq!(text, critical("2"), "the bootstrap depends on the number of threads");
    let found: Value = serde_json::from_slice(&text).expect("JSON");
    let (row, scatter) = (&found[0], &found[0]["scatter"]);
    let truth = RAMBERG_OSGOOD.critical_velocity(DENSITY);
    for value in [&row["critical_velocity_m_s"], &scatter["mean_m_s"]] {
        assert!((number(value) / truth - 1.0).abs() < 0.01, "{found:#}");
    }
    // Standard deviation of 0.96 to 1.04: 0.0316.
    assert!((number(&scatter["standard_deviation_m_s"]) / truth / 0.0316 - 1.0).abs() < 0.15, "{found:#}");
    let (low, high) = (number(&scatter["interval_95_m_s"][0]), number(&scatter["interval_95_m_s"][1]));
    // Student's t with 4 degrees of freedom: 2.776 * 0.0316/sqrt(5) = 0.0393, which no resample of these five can exceed by much.
    assert!(low / truth < 0.975 && low / truth > 0.95 && high / truth > 1.025 && high / truth < 1.05, "{found:#}");
    assert_eq!(scatter["tests"].as_array().map(Vec::len), Some(5));
}

/// Returns rows of a material with the largest stress at a strain of 12 %, up to the strain `end`, with noise relative to the largest stress.
fn noisy(rows: u32, end: f64, noise: f64, seed: u64) -> Vec<(f64, f64)> {
    let mut rows = record(&RAMBERG_OSGOOD, &Faults { rows, noise, seed, ..CLEAN });
    rows.retain(|row| row.0 <= end);
    rows
}

/// The mean modulus in the file must not be rounded to a value below the first slope.
#[test]
fn repeats_of_any_modulus_are_written() {
    let folder = tempfile::tempdir().expect("a folder");
    for scatter in 0..8_u32 {
        let names = [0, 1, 2].map(|test| {
            let scale = 1.0 + 0.013 * f64::from(test) + 0.0017 * f64::from(scatter);
            let seed = u64::from(3 * scatter + test);
            let rows: Vec<_> = noisy(400, 0.25, 1e-3, seed).into_iter().map(|(e, s)| (e, scale * s)).collect();
            let name = format!("{test}.csv");
            std::fs::write(folder.path().join(&name), csv(&rows)).expect("a file");
            name
        });
        let found =
            import(folder.path(), "a.csv", &csv(&noisy(400, 0.25, 1e-3, 1)), &[&names[0], &names[1], &names[2]]);
        assert!(number(&found["modulus_Pa"]) > 190e9, "{found:#}");
    }
    let text = csv(&noisy(400, 0.25, 1e-3, 1));
    for modulus in ["29700 ksi", "29600 ksi", "29800 ksi", "29900 ksi"] {
        import(folder.path(), "a.csv", &text, &["--modulus", modulus]);
    }
}

/// Returns a record with these headings: time, crosshead displacement, extensometer with a gauge length of 50 mm, and force on 100 mm^2.
fn machine_record(headings: &str) -> String {
    let rows = noisy(400, 0.25, 1e-4, 1);
    let mut text = String::from(headings) + "\n";
    for (k, (e, s)) in rows.iter().enumerate() {
        let force = s * 100e-6 / 1e3;
        let _ = writeln!(text, "{k},{:.7},{:.7},{force:.6}", 60.0 * e + force / 15.0, 50.0 * e);
    }
    text
}

#[test]
fn an_extensometer_is_taken_before_a_crosshead() {
    let folder = tempfile::tempdir().expect("a folder");
    let specimen = ["--gauge-length", "50 mm", "--area", "100 mm^2"];
    for other in ["Crosshead (mm)", "Displacement (mm)", "Extension (mm)", "Stroke [mm]", "Crosshead strain (%)"] {
        let text = machine_record(&format!("Time (s),{other},Extensometer (mm),Load (kN)"));
        let found = import(folder.path(), "a.csv", &text, &specimen);
        assert!((number(&found["modulus_Pa"]) / 205e9 - 1.0).abs() < 0.01, "{other}: {found:#}");
        let columns = found["records"][0]["columns"].as_str().expect("a text");
        assert!(columns.contains("extension `Extensometer (mm)`"), "{columns}");
        assert!(columns.contains(&format!("not used: `{other}`")), "{columns}");
    }
}

/// The modulus of a crosshead record, and a shear record imported as an axial one, are noted.
#[test]
fn records_of_a_crosshead_and_of_shear_are_noted() {
    let folder = tempfile::tempdir().expect("a folder");
    let specimen = ["--gauge-length", "50 mm", "--area", "100 mm^2"];
    let crosshead = machine_record("Time (s),Crosshead (mm),Other,Load (kN)");
    let found = import(folder.path(), "a.csv", &crosshead, &specimen);
    assert!(found["notes"].to_string().contains("deformation of machine and grips"), "{found:#}");
    let corrected = [&specimen[..], &["--modulus", "205 GPa", "--compliance"]].concat();
    let found = import(folder.path(), "a.csv", &crosshead, &corrected);
    assert!(!found["notes"].to_string().contains("deformation of machine and grips"), "{found:#}");
    let shear = csv(&noisy(400, 0.25, 1e-4, 1)).replace("strain,stress_MPa", "shear strain,shear stress (MPa)");
    let found = import(folder.path(), "a.csv", &shear, &[]);
    assert!(found["notes"].to_string().contains("in place of `sense`"), "{found:#}");
}

#[test]
fn headings_name_the_measure_in_several_languages() {
    let folder = tempfile::tempdir().expect("a folder");
    let rows = record(&RAMBERG_OSGOOD, &Faults { rows: 1500, ..CLEAN });
    let table = |header: &str| {
        let mut text = String::from(header) + "\n";
        for (e, s) in &rows {
            let _ = writeln!(text, "{:.8},{:.5}", e.ln_1p(), s * (1.0 + e) / 1e6);
        }
        text
    };
    for header in [
        "Logarithmic strain,True stress (MPa)",
        "log strain,Cauchy stress (MPa)",
        "wahre Dehnung,wahre Spannung (MPa)",
        "D\u{e9}formation vraie,Contrainte vraie (MPa)",
    ] {
        let found = import(folder.path(), "a.csv", &table(header), &[]);
        within_a_percent(&found, &RAMBERG_OSGOOD, header);
        assert_eq!(found["records"][0]["measure"], "true", "{header}");
    }
    let with = |more: &[&str]| {
        barwave(folder.path(), &[&["materials", "import", "a.csv", "--density", "7850", "--force"], more].concat())
    };
    for header in ["True strain,Stress (MPa)", "Strain,True stress (MPa)", "True strain,Engineering stress (MPa)"] {
        std::fs::write(folder.path().join("a.csv"), table(header)).expect("a file");
        let _ = std::fs::remove_file(folder.path().join("a.toml"));
        let refused = with(&[]);
        let message = String::from_utf8_lossy(&refused.stderr);
        assert!(refused.status.code() == Some(2) && !folder.path().join("a.toml").exists(), "{message}");
        assert!(message.contains("is named as true") && message.contains("--measure true"), "{message}");
    }
    let stated = with(&["--measure", "true"]);
    assert!(String::from_utf8_lossy(&stated.stdout).contains("measure       true (by --measure)"));
    std::fs::write(folder.path().join("a.csv"), csv(&rows)).expect("a file");
    assert!(String::from_utf8_lossy(&with(&[]).stdout).contains("measure       engineering (assumed"));
}

/// Noise must not make a largest stress, and with it a critical velocity, of records that end at two thirds of the strain of their largest stress.
#[test]
fn noise_makes_no_largest_stress() {
    let folder = tempfile::tempdir().expect("a folder");
    for seed in 0..12 {
        let text = csv(&noisy(1200, 0.1, 0.005, seed));
        let found = import(folder.path(), "a.csv", &text, &[]);
        assert!(found["critical"]["critical_velocity_m_s"].is_null(), "{seed}: {found:#}");
        // With fracture at the end, the critical velocity is close to that of the curve up to there.
        let found = import(folder.path(), "a.csv", &text, &["--beyond", "rupture"]);
        let points: Vec<_> = (0..=20_000).map(|i| 0.1 * (f64::from(i) / 2e4).powi(3)).collect();
        let front = |pair: &[f64]| {
            let rise = RAMBERG_OSGOOD.stress(pair[1]) - RAMBERG_OSGOOD.stress(pair[0]);
            ((pair[1] - pair[0]) * rise / DENSITY).sqrt()
        };
        let expected: f64 = points.windows(2).map(front).sum();
        let velocity = number(&found["critical"]["critical_velocity_m_s"]);
        assert!((velocity / expected - 1.0).abs() < 0.04, "{seed}: {velocity}, not {expected}");
        assert_eq!(found["critical"]["reason"], "rupture-strain");
        let whole = import(folder.path(), "a.csv", &csv(&noisy(1200, 0.25, 0.005, seed)), &[]);
        let velocity = number(&whole["critical"]["critical_velocity_m_s"]);
        let expected = RAMBERG_OSGOOD.critical_velocity(DENSITY);
        assert!((velocity / expected - 1.0).abs() < 0.02, "{seed}: {velocity}, not {expected}");
    }
}

/// Tests that stop while the stress increases and unload in a few rows have no fracture, and no critical velocity.
#[test]
fn a_quick_unloading_at_the_end_is_no_fracture() {
    let folder = tempfile::tempdir().expect("a folder");
    let loaded: Vec<_> = (0..600_u32).map(|i| f64::from(i) * 1e-4).map(|e| (e, RAMBERG_OSGOOD.stress(e))).collect();
    let (strain, stress) = loaded[loaded.len() - 1];
    for (rows, part) in [(10, 1.0), (40, 1.0), (10, 0.5), (40, 0.5)] {
        let fall = (1..=rows).map(|i| part * stress * f64::from(i) / f64::from(rows));
        let unloading = fall.map(|fall| (strain - fall / RAMBERG_OSGOOD.modulus, stress - fall));
        let whole: Vec<_> = loaded.iter().copied().chain(unloading).collect();
        let found = import(folder.path(), "a.csv", &csv(&whole), &[]);
        assert!(found["records"][0]["reduction"]["fracture"].is_null(), "{rows}, {part}: {found:#}");
        assert!(found["critical"]["critical_velocity_m_s"].is_null(), "{rows}, {part}: {found:#}");
    }
}

/// The end of the shorter record is not its largest stress, which would decrease the mean by 5 %.
#[test]
fn a_repeat_that_was_stopped_early_does_not_end_the_mean() {
    let folder = tempfile::tempdir().expect("a folder");
    for (k, end) in [0.25, 0.25, 0.07].into_iter().enumerate() {
        let rows = noisy(1200, end, 1e-3, 5 + k as u64);
        std::fs::write(folder.path().join(format!("{k}.csv")), csv(&rows)).expect("a file");
    }
    let arguments = ["materials", "import", "0.csv", "1.csv", "2.csv", "--density", "7850", "-o", "m.toml", "--json"];
    let output = barwave(folder.path(), &arguments);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let found: Value = serde_json::from_slice(&output.stdout).expect("JSON");
    let velocity = number(&found["critical"]["critical_velocity_m_s"]);
    let expected = RAMBERG_OSGOOD.critical_velocity(DENSITY);
    assert!((velocity / expected - 1.0).abs() < 0.004, "{velocity}, not {expected}");
    assert!(found["changes"][0].as_str().is_some_and(|note| note.contains("2.csv ends at strain 0.0")), "{found:#}");
    let text = barwave(folder.path(), &["critical", "m.toml"]).stdout;
    let text = String::from_utf8_lossy(&text);
    for part in
        ["3 tests", "none: it ends while the stress rises", "none: 2 of 3 tests have a critical velocity, 3 are"]
    {
        assert!(text.contains(part), "{part}: {text}");
    }
}

#[test]
fn the_mean_of_equal_records_is_the_curve_of_each() {
    let folder = tempfile::tempdir().expect("a folder");
    let text = csv(&noisy(1200, 0.25, 1e-3, 1));
    let one = import(folder.path(), "a.csv", &text, &[]);
    let names = ["b.csv", "c.csv"];
    for name in names {
        std::fs::write(folder.path().join(name), &text).expect("a file");
    }
    let mean = import(folder.path(), "a.csv", &text, &names);
    for key in ["modulus_Pa", "elastic_limit_Pa"] {
        assert!((number(&mean[key]) / number(&one[key]) - 1.0).abs() < 1e-5, "{key}: {mean:#}");
    }
    let [a, b] = [one, mean].map(|found| number(&found["critical"]["critical_velocity_m_s"]));
    assert!((a / b - 1.0).abs() < 2.5e-4, "{a} {b}");
}

/// The message states the range as given, and not as stresses of the fitted line, which differ if the rows are not straight.
#[test]
fn a_range_with_the_knee_in_it_is_named() {
    let folder = tempfile::tempdir().expect("a folder");
    let text = csv(&noisy(3000, 0.25, 1e-4, 1));
    let range = |range: &str| {
        let found = import(folder.path(), "a.csv", &text, &["--elastic-range", range]);
        let reduction = found["records"][0]["reduction"].clone();
        let [low, high] = [0, 1].map(|k| number(&reduction["line"]["fitted_between_Pa"][k]) / 1e6);
        let bent = reduction["changes"].to_string().contains("are not on one line");
        (low, high, bent)
    };
    let (low, high, bent) = range("20MPa..430MPa");
    assert!((15.0..40.0).contains(&low) && (415.0..431.0).contains(&high) && bent, "{low} {high} {bent}");
    let (low, high, bent) = range("20MPa..200MPa");
    assert!((15.0..40.0).contains(&low) && (180.0..201.0).contains(&high) && !bent, "{low} {high} {bent}");
}

/// Rows read from a figure: the second pair is steeper than the first.
const READ_OFF: &str = "Strain [%];Stress [MPa]\n0;0\n0,1;70\n0,2;141\n0,25;165\n0,5;190\n1;215\n5;305\n30;410\n";

/// Stresses rounded to ten digits are not exactly on a line: one slope is the steepest, which must not make the elastic limit 0, or the modulus of
/// the record too small.
#[test]
fn a_record_on_a_line_is_elastic_whatever_its_digits() {
    let folder = tempfile::tempdir().expect("a folder");
    let forces = [0, 2, 4, 5].map(f64::from);
    let rows = [0.0, 0.05, 0.1, 0.5].iter().zip(forces).map(|(extension, force)| format!("{extension},{force}\n"));
    let record = format!("extension (mm),force (kN)\n{}", rows.collect::<String>());
    for area in [28.0, 3.0, 7.0, 29.0, 61.0] {
        let size = format!("{area} mm^2");
        let modulus = format!("{} GPa", 2000.0 / area);
        let range = format!("0 MPa..{} MPa", 4200.0 / area);
        for options in [
            &[][..],
            &["--modulus", &modulus],
            &["--elastic-range", &range],
            &["--elastic-range", &range, "--toe", "off"],
        ] {
            let options = [&["--gauge-length", "50 mm", "--area", &size][..], options].concat();
            let found = import(folder.path(), "line.csv", &record, &options);
            let off = [
                number(&found["elastic_limit_Pa"]) * area / 4e9 - 1.0,
                number(&found["modulus_Pa"]) * area / 2e12 - 1.0,
            ];
            assert!(off.iter().all(|off| off.abs() < 1e-12), "{options:?}: {off:?}");
        }
    }
}

#[test]
fn the_elastic_part_of_a_short_table_is_fitted_where_its_stresses_are_named() {
    let folder = tempfile::tempdir().expect("a folder");
    let kept = import(folder.path(), "a.csv", READ_OFF, &[]);
    assert_eq!((number(&kept["elastic_limit_Pa"]), number(&kept["modulus_Pa"])), (0.0, 71e9));
    assert!(kept["notes"][0].as_str().is_some_and(|note| note.contains("no elastic part")), "{kept:#}");
    let fitted = import(folder.path(), "a.csv", READ_OFF, &["--elastic-range", "0 MPa..150 MPa"]);
    assert!((number(&fitted["modulus_Pa"]) / 70.5e9 - 1.0).abs() < 1e-6, "{fitted:#}");
    assert!((number(&fitted["elastic_limit_Pa"]) / 141e6 - 1.0).abs() < 1e-6, "{fitted:#}");
    assert_eq!(fitted["notes"], serde_json::json!([]));
    let file = std::fs::read_to_string(folder.path().join("m.toml")).expect("a material");
    assert!(file.contains("# - elastic line of 70.500 GPa in place of 3 rows up to 141 MPa"), "{file}");
    for (options, words) in [
        (&["--smooth", "0.01"][..], "has 8 rows, which are kept as they are"),
        (&["--elastic-range", "100 MPa..150 MPa"], "1 row with a stress from 100 to 150 MPa"),
        (&["--keep-rows", "--elastic-range", "0 MPa..150 MPa"], "cannot be used with"),
        (&["--plot", "a.svg"], "no reduction to plot"),
    ] {
        let fixed = ["materials", "import", "a.csv", "--density", "7850", "-o", "n.toml"];
        let output = barwave(folder.path(), &[&fixed, options].concat());
        let message = String::from_utf8_lossy(&output.stderr).into_owned();
        assert!(output.status.code() == Some(2) && message.contains(words), "{options:?}: {message}");
    }
}

/// The force of rows at the limit of the extensometer, up to the fracture, was averaged into the stress at the largest strain: the critical velocity was 6 % too large.
#[test]
fn an_extensometer_at_its_limit_ends_the_curve() {
    let folder = tempfile::tempdir().expect("a folder");
    let rows = record(&RAMBERG_OSGOOD, &Faults { rows: 900, ..CLEAN });
    let largest = rows[rows.len() - 1].0;
    let at_limit: Vec<_> = rows.iter().map(|&(e, s)| (e.min(0.4 * largest), s)).collect();
    let until: Vec<_> = rows.iter().copied().filter(|row| row.0 <= 0.4 * largest).collect();
    let options = ["--beyond", "rupture"];
    let [found, expected] = [&at_limit, &until].map(|rows| import(folder.path(), "a.csv", &csv(rows), &options));
    let velocity = |found: &Value| number(&found["critical"]["critical_velocity_m_s"]);
    assert!((velocity(&found) / velocity(&expected) - 1.0).abs() < 3e-3, "{found:#} {expected:#}");
    let changes = found["records"][0]["reduction"]["changes"].to_string();
    assert!(changes.contains("the extensometer is at its limit") && !changes.contains("averaged"), "{changes}");
}

#[test]
fn wrong_records_are_refused_with_one_clear_error() {
    let folder = tempfile::tempdir().expect("a folder");
    let good = csv(&record(&RAMBERG_OSGOOD, &Faults { rows: 200, ..CLEAN }));
    let line = |k: u32, text: &str| {
        let mut lines: Vec<String> = good.lines().map(str::to_owned).collect();
        lines[k as usize] = text.into();
        lines.join("\n")
    };
    let units = good.replace("stress_MPa", "stress");
    // Stresses so small that they would all be zero in the file.
    let mut tiny = String::from("strain,stress\n");
    for (e, s) in record(&RAMBERG_OSGOOD, &Faults { rows: 200, ..CLEAN }) {
        let _ = writeln!(tiny, "{e:.8},{:.8}", s / 9.8e6);
    }
    // Text, options, and the texts that the message contains; a line number is followed by a colon.
    let machine = machine_record("Time (s),Crosshead (mm),Extensometer (mm),Load (kN)");
    let cases: [(&str, &[&str], &str); 33] = [
        (&machine, &["--gauge-length", "50", "--area", "100 mm^2"], "`50` has no unit and would be 50 m"),
        (&machine, &["--gauge-length", "50 mm", "--diameter", "6"], "`6` has no unit and would be 6 m"),
        (
            &machine,
            &["--gauge-length", "50 mm", "--area", "100 mm^2", "--measure", "true"],
            "an extension over the initial gauge length",
        ),
        ("time,load\n0,1\n1,2\n", &[], "no column of strain or extension"),
        (&line(7, "0.1,abc"), &[], "8: `abc` is not a number"),
        (&line(7, "0.1,nan"), &[], "8: `nan` is not a number"),
        (&line(7, "0.1"), &[], "8: this line has only 1 column"),
        (&line(7, "0.1,"), &[], "8: the cell in column `stress_MPa` is empty"),
        ("strain,stress_MPa\n", &[], "fewer than two lines"),
        ("strain,strain,stress_MPa\n1,1,2\n2,2,3\n", &[], "2 columns of strain"),
        ("strain (furlong),stress_MPa\n1,2\n2,3\n", &[], "`furlong` is not a unit of strain"),
        ("1,2,3\n2,3,4\n", &[], "3 columns without headings"),
        ("extension (mm),load (kN)\n1,2\n2,3\n", &[], "extension needs the gauge length"),
        (&good, &["--area", "1 mm^2"], "needs no cross-section"),
        (&good, &["--unit", "MPa"], "given twice"),
        (&units, &[], "the unit of stress or force is not given"),
        (&good, &["--strain-column", "7"], "there is no column 7"),
        (&good, &["--elastic-range", "20..320"], "`20` has no unit and would be 20 Pa"),
        (&good, &["--elastic-range", "0..320"], "`320` has no unit and would be 320 Pa"),
        (&good, &["--modulus", "100 GPa"], "100.0000 GPa is less than the slope of the record, 187."),
        (&good, &["--modulus", "100 GPa"], "at least 174."),
        (&good, &["--modulus", "29.5"], "`29.5` has no unit and would be 29.5 Pa"),
        (&good, &["--smooth", "50"], "a window of strain 50 is too wide"),
        (&good, &["--elastic-range", "95 MPa..90 MPa"], "95 MPa to 90 MPa is an empty interval"),
        (&good, &["--tolerance", "0.5"], "0.5 is out of range"),
        (&good, &["--elastic-range", "90 GPa..95 GPa"], "no line can be fitted between 90000 and 95000 MPa"),
        (&good, &["-o", "a.csv"], "`a.csv` is not a name of a material file"),
        (&tiny, &[], "the unit of stress or force is not given"),
        (&tiny.replace("stress", "stress (Pa)"), &[], "2: no curve can be made of a.csv"),
        (&good.replace("stress_MPa", "\"Stress, stones/acre\""), &[], "`stones/acre` is not a unit of stress"),
        (&good.replace("stress_MPa", "stress_V"), &[], "`V` is not a unit of stress"),
        (&good.replace("strain,", "strain_mV,"), &[], "`mV` is not a unit of strain"),
        (&good.replace("stress_MPa", "Stress (kgfmm2)"), &[], "did you mean `kgf/mm^2`?"),
    ];
    for (text, options, words) in cases {
        std::fs::write(folder.path().join("a.csv"), text).expect("a file");
        let output =
            barwave(folder.path(), &[&["materials", "import", "a.csv", "--density", "7850"], options].concat());
        let message = String::from_utf8_lossy(&output.stderr).into_owned();
        assert_eq!(output.status.code(), Some(2), "{words}: {message}");
        let (line, words) = words.split_once(": ").unwrap_or(("", words));
        assert!(line.is_empty() || message.contains(&format!("a.csv:{line}:")), "line {line}: {message}");
        assert!(message.contains(words) && message.contains("help"), "`{words}` is not in: {message}");
        assert!(!folder.path().join("a.toml").exists() && output.stdout.is_empty());
    }
}

#[test]
fn numbers_of_a_program_are_checked_as_those_of_the_command_line() {
    let how = Reduce {
        modulus: None,
        compliance: false,
        elastic_range: None,
        toe: true,
        window: None,
        tolerance: Reduce::TOLERANCE,
        stress_step: 0.0,
        strain_step: 0.0,
    };
    let row = |k: i32| {
        let strain = 1e-5 * f64::from(k);
        (strain, (200e9 * strain).min(200e6 + 5e9 * (strain - 1e-3)))
    };
    let record: Vec<(f64, f64)> = (0..2000).map(row).collect();
    let refused = |record: &[(f64, f64)], how: Reduce, key: &str| {
        let error = reduce(record, &how).expect_err(key);
        assert!(error.key == key && !error.allowed.is_empty() && !error.help.contains("--"), "{error:?}");
    };
    assert!(reduce(&record, &how).is_ok());
    for wrong in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        let with = |row: (f64, f64)| {
            let mut record = record.clone();
            record[700] = row;
            record
        };
        refused(&with((0.007, wrong)), how, "record.stress");
        refused(&with((wrong, 230e6)), how, "record.strain");
    }
    for wrong in [f64::NAN, f64::INFINITY, -1.0, 0.0] {
        let modulus = Some(wrong);
        refused(&record, Reduce { modulus, ..how }, "modulus");
        refused(&record, Reduce { modulus, compliance: true, ..how }, "modulus");
        refused(&record, Reduce { window: Some(wrong), ..how }, "window");
        refused(&record, Reduce { tolerance: wrong, ..how }, "tolerance");
        refused(&record, Reduce { elastic_range: Some([100e6, wrong]), ..how }, "elastic_range");
    }
    for step in [f64::NAN, -1.0] {
        refused(&record, Reduce { stress_step: step, ..how }, "stress_step");
        refused(&record, Reduce { strain_step: step, ..how }, "strain_step");
    }
    refused(&record, Reduce { window: Some(50.0), ..how }, "window");
    refused(&record, Reduce { elastic_range: Some([90e9, 95e9]), ..how }, "elastic_range");
    refused(&record[..20], how, "record");
    assert_eq!(combine(&[], Reduce::TOLERANCE).expect_err("there is nothing").key, "tests");
    let reduced = reduce(&record, &how).expect("a record");
    assert_eq!(combine(&[("a".into(), reduced)], f64::NAN).expect_err("no tolerance").key, "tolerance");
    assert_eq!(straighten(&record, [0.0, f64::NAN], None, true).expect_err("no range").key, "elastic_range");
}
