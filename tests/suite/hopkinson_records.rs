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
    let options = Options { window: None, limit: None, equilibrium: 0.05, poisson: 0.29 };
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
