//! Records of split-Hopkinson tests: unequal bars, wrong gauge distances, gauges without a signal.

use crate::common::binary;
use crate::invert::{KOLSKY, Kolsky, MICRO, joined};

use barwave::study::invert::hopkinson::{ElasticBar, Moment, Options, Records, Setup, reduce};
use binary::{json, refused};

/// The one-wave strain rate accounts for different bars of steel and aluminium; with equal bars assumed, it would be 1.6 times too large.
#[test]
fn one_wave_and_three_waves_agree_in_equilibrium_between_unequal_bars() {
    let steel = ElasticBar { modulus: 200e9, density: 8000.0, area: 2e-4, distance: 1.0 };
    let aluminium = ElasticBar { modulus: 70e9, density: 2800.0, area: 3e-4, distance: 0.6 };
    let [i, r] = [1e-3, -7e-4];
    // E A: 40 MN and 21 MN.
    let t = 40.0 / 21.0 * (i + r);
    let setup = Setup { incident: steel, transmitted: aluminium, length: 0.01, area: 1e-4 };
    let way = setup.incident.distance / steel.c0();
    let later = way + setup.transmitted.distance / aluminium.c0();
    let on = |time: f64| f64::from(u8::from((0.0..100e-6).contains(&time)));
    let time: Vec<f64> = (0..8000).map(|k| 1e-7 * f64::from(k) - 5e-5).collect();
    let record = |strain: &dyn Fn(f64) -> f64| (time.clone(), time.iter().map(|&t| strain(t)).collect());
    let records = Records {
        incident: record(&|time| i * on(time) + r * on(time - 2.0 * way)),
        transmitted: record(&|time| t * on(time - later)),
    };
    let options = Options { equilibrium: 0.05, ..Options::default() };
    let reduced = reduce(&setup, &records, &options).expect("a test");
    // The faces approach each other with c1 (i - r) - c2 t; both bars have 5000 m/s.
    let rate = 5000.0 * (i - r - t) / 0.01;
    for part in [0.25, 0.5, 0.75] {
        let moment: Moment = reduced.moments[(part * reduced.moments.len() as f64) as usize];
        for found in [moment.rate, moment.rate_one_wave] {
            assert!((found / rate - 1.0).abs() < 1e-9, "{found} {rate}");
        }
        assert!((moment.strain_one_wave / moment.strain - 1.0).abs() < 1e-9, "{moment:?}");
        assert!((moment.stress_one_wave / moment.stress - 1.0).abs() < 1e-9, "{moment:?}");
    }
    assert_eq!(reduced.warnings, [""; 0]);
}

/// Returns the distance that the program proposes, m.
fn fitting(message: &str) -> f64 {
    let (_, rest) = message.split_once("a distance of ").unwrap_or_else(|| panic!("no distance: {message}"));
    rest.split_whitespace().next().and_then(|number| number.parse().ok()).expect("a number")
}

/// A stated gauge distance that is 5 cm too small, which gives a stress error of 4 %, causes a warning; one that is 5 cm too large is not reported as
/// too long an incident pulse.
#[test]
fn the_arrival_of_the_reflected_pulse_tells_the_distance_of_the_gauge() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path();
    // The gauge is 1 m from the specimen.
    Kolsky::of(200e-6).write(&path.join("test.csv"), MICRO, [0.0; 2]);
    let with = |distances: &'static str| -> Vec<&str> {
        let of = KOLSKY.iter().map(|a| if *a == "1m,1m" { distances } else { *a }).collect::<Vec<_>>();
        joined(&["invert", "hopkinson", "test.csv"], &of)
    };
    for right in ["1m,1m", "0.985m,1m", "1.01m,1m"] {
        assert_eq!(json(path, &joined(&with(right), &["--json"]))["warnings"].to_string(), "[]", "{right}");
    }
    for near in ["0.95m,1m", "0.8m,1m"] {
        let warnings = json(path, &joined(&with(near), &["--json"]))["warnings"].to_string();
        assert!(warnings.contains("after its time as computed") && warnings.contains("modulus"), "{warnings}");
        assert!((fitting(&warnings[warnings.find("wrong;").expect("a help")..]) - 1.0).abs() < 2e-3, "{warnings}");
    }
    for far in ["1.05m,1m", "1.3m,1m"] {
        let message = refused(path, &with(far));
        assert!(message.contains("before its computed time") && message.contains("--distances"), "{message}");
        assert!((fitting(&message) - 1.0).abs() < 2e-3, "{message}");
    }
}

/// A gauge without a signal on the transmission bar, which would give half the stresses of the other gauge, is refused.
#[test]
fn a_gauge_on_the_transmission_bar_without_a_pulse_is_refused() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path();
    let refusal = |name: &str| refused(path, &joined(&["invert", "hopkinson", name], &KOLSKY));
    let mut test = Kolsky::of(200e-6);
    test.transmitted.fill(0.0);
    test.write(&path.join("noise.csv"), MICRO, [0.0, 20e-6]);
    let message = refusal("noise.csv");
    assert!(message.contains("noise.csv") && message.contains("records no pulse beyond its noise"), "{message}");
    let row = |(t, i): (&f64, &f64)| format!("{},{},0", 1e6 * t, 1e6 * i);
    let rows: Vec<String> = test.time.iter().zip(&test.incident).map(row).collect();
    std::fs::write(path.join("dead.csv"), format!("{MICRO}\n{}\n", rows.join("\n"))).expect("a file");
    let message = refusal("dead.csv");
    assert!(message.contains("transmission bar records no pulse") && !message.contains("noise"), "{message}");
}

/// Only the distance of the gauge on the incident bar was checked: 10 cm on the transmission bar changed the stresses by up to 7 %.
#[test]
fn the_arrival_of_the_transmitted_pulse_tells_the_distance_of_its_gauge() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path();
    Kolsky::of(200e-6).write(&path.join("test.csv"), MICRO, [0.0; 2]);
    for (distances, than) in [("1m,0.9m", "after"), ("1m,1.1m", "before"), ("0.95m,0.9m", "after"), ("1m,1.01m", "")] {
        let of = KOLSKY.iter().map(|a| if *a == "1m,1m" { distances } else { *a }).collect::<Vec<_>>();
        let found = json(path, &joined(&["invert", "hopkinson", "test.csv", "--json"], &of));
        let all = found["warnings"].as_array().expect("warnings");
        let warnings: Vec<&str> =
            all.iter().filter_map(|text| text.as_str()).filter(|text| text.starts_with("the transmitted")).collect();
        if than.is_empty() {
            assert!(all.is_empty(), "{all:?}");
            continue;
        }
        let [warning] = warnings[..] else { panic!("{distances}: {all:?}") };
        assert!(warning.contains(&format!("us {than} its time as computed")), "{warning}");
        assert!((fitting(&warning[warning.find("wrong;").expect("a help")..]) - 1.0).abs() < 0.01, "{warning}");
    }
}

/// A reflected pulse of less than a quarter of the incident one was said to arrive 396 us before its time.
#[test]
fn a_weak_reflected_pulse_is_not_called_early() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path();
    for limit in [430e6, 460e6, 490e6] {
        Kolsky::yielding_at(limit, 200e-6).write(&path.join("test.csv"), MICRO, [0.0; 2]);
        let found = json(path, &joined(&["invert", "hopkinson", "test.csv", "--json"], &KOLSKY));
        assert_eq!(found["warnings"].to_string(), "[]", "{limit:e}");
        let of = KOLSKY.iter().map(|a| if *a == "1m,1m" { "0.95m,1m" } else { *a }).collect::<Vec<_>>();
        let found = json(path, &joined(&["invert", "hopkinson", "test.csv", "--json"], &of));
        assert!(found["warnings"].to_string().contains("the reflected pulse arrives 19."), "{limit:e}: {found}");
    }
}

/// The records of an analog-to-digital converter without noise had intervals of no width.
#[test]
fn intervals_contain_the_rounding_of_the_records() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path();
    let test = Kolsky::of(200e-6);
    let exact = |step: f64| {
        let round = |e: f64| if step > 0.0 { step * (1e6 * e / step).round() } else { 1e6 * e };
        let row = |((t, i), d): ((&f64, &f64), &f64)| format!("{},{},{}", 1e6 * t, round(*i), round(*d));
        let rows: Vec<String> = test.time.iter().zip(&test.incident).zip(&test.transmitted).map(row).collect();
        std::fs::write(path.join("test.csv"), format!("{MICRO}\n{}\n", rows.join("\n"))).expect("a file");
        let found = json(path, &joined(&["invert", "hopkinson", "test.csv", "--json"], &KOLSKY));
        let knots = found["curve"].as_array().expect("a curve").clone();
        let values = |knot: &serde_json::Value| {
            ["strain", "stress_Pa", "stress_half_width_Pa"].map(|key| knot[key].as_f64().expect("a number"))
        };
        knots.iter().map(values).collect::<Vec<_>>()
    };
    let truth = exact(0.0);
    let at = |strain: f64| {
        let k = truth.partition_point(|knot| knot[0] < strain).clamp(1, truth.len() - 1);
        let [a, b] = [truth[k - 1], truth[k]];
        a[1] + (b[1] - a[1]) * (strain - a[0]) / (b[0] - a[0])
    };
    let found = exact(12.0);
    let inside = found.iter().filter(|knot| (knot[1] - at(knot[0])).abs() <= knot[2]).count();
    assert!(20 * inside >= 19 * found.len(), "{inside} of {}", found.len());
    // E A/A_s times 12 ue: 6 MPa.
    let widest =
        |knots: &[[f64; 3]]| knots.iter().filter(|knot| knot[0] > 0.02).map(|knot| knot[2]).fold(0.0, f64::max);
    let widest = [&found, &truth].map(|knots| widest(knots));
    assert!(widest[0] < 13e6 && widest[1] < 2e6, "{widest:?}");
}

/// An empty cell, and decimal commas between commas, are errors of their lines in all commands that read records.
#[test]
fn incomplete_rows_of_records_are_refused() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path();
    let import = "materials import test.csv --density 7850";
    let import: Vec<&str> = import.split_whitespace().collect();
    for (headings, command) in
        [(MICRO, joined(&["invert", "hopkinson", "test.csv"], &KOLSKY)), ("strain,stress (MPa),force (N)", import)]
    {
        let second = headings.split(',').nth(1).expect("a column");
        for (rows, words) in [
            ("1,2,3\n2,,3\n", format!("test.csv:3:1: the cell in column `{second}` is empty")),
            ("1,2,3\n2,3,4\n3,,\n", format!("test.csv:4:1: the cell in column `{second}` is empty")),
            ("1,5,2,5,3,5\n2,5,3,5,4,5\n", "test.csv:2:1: this line has 6 columns".into()),
        ] {
            std::fs::write(path.join("test.csv"), format!("{headings}\n{rows}")).expect("a file");
            let message = refused(path, &command).replace("error: ", "");
            let (place, what) = words.split_once(": ").expect("a place");
            assert!(message.contains(place) && message.contains(what), "{words}: {message}");
        }
    }
}

/// The strain counted from the arrival, after a twentieth of the pulse had passed: 7 us late for a rise of 80 us, which made an elastic specimen stiffer.
#[test]
fn strains_count_from_the_start_of_a_slow_rise() {
    let bar = ElasticBar { modulus: 200e9, density: 8000.0, area: 2e-4, distance: 1.0 };
    let setup = Setup { incident: bar, transmitted: bar, length: 0.01, area: 1e-4 };
    let way = 2.0 * bar.distance / bar.c0();
    let incident = |t: f64| {
        let rise = |t: f64| (t / 80e-6).clamp(0.0, 1.0).powi(2) * (3.0 - 2.0 * (t / 80e-6).clamp(0.0, 1.0));
        1e-3 * (rise(t) - rise(t - 200e-6))
    };
    let dt = 1e-7;
    let time: Vec<f64> = (0..9000).map(|k| dt * f64::from(k) - 1e-4).collect();
    // An elastic specimen of 115 GPa in equilibrium: strain rate 2 c (i - t)/L, t = stress A_s/(E A).
    let (mut strain, mut transmitted) = (0.0, Vec::new());
    for &t in &time {
        transmitted.push(115e9 * strain * setup.area / (bar.modulus * bar.area));
        strain += dt * 2.0 * bar.c0() * (incident(t) - transmitted[transmitted.len() - 1]) / setup.length;
    }
    let shift = (way / dt).round() as usize;
    let later = |values: &dyn Fn(usize) -> f64| {
        (0..time.len()).map(|k| k.checked_sub(shift).map_or(0.0, values)).collect::<Vec<_>>()
    };
    let reflected = later(&|k| transmitted[k] - incident(time[k]));
    let records = Records {
        incident: (time.clone(), time.iter().zip(&reflected).map(|(&t, r)| incident(t) + r).collect()),
        transmitted: (time.clone(), later(&|k| transmitted[k])),
    };
    let reduced = reduce(&setup, &records, &Options::default()).expect("a test");
    assert!(reduced.curve.len() > 20);
    for knot in &reduced.curve {
        // 10 microstrain are 1.2 MPa.
        assert!((knot.stress / 115e9 - knot.strain).abs() < 10e-6, "{knot:?}");
    }
}
