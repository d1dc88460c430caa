use std::path::Path;

use proptest::prelude::*;

use super::*;
use crate::bar::Joint;
use crate::error::{Error, InputError};
use crate::record::Compression;

/// Elastic steel, defined here so that the tests do not depend on the material library.
const STEEL: &str = r#"{ name = "steel", density = 7800, modulus = "200 GPa", beyond = "extend", curve = { table = [[0.001, 200e6], [0.1, 300e6]] } }"#;

fn base(rest: &str) -> String {
    format!(
        "[bar]\nlength = \"1 m\"\nmaterial = {STEEL}\n[left]\nkind = \"velocity\"\nvalue = \"-30 m/s\"\n[right]\n\
         kind = \"free\"\n[solve]\nuntil = \"200 us\"\n{rest}"
    )
}

fn read(text: &str, overrides: &[&str]) -> Result<Scene> {
    let overrides: Vec<String> = overrides.iter().map(|&o| o.to_owned()).collect();
    Scene::parse("runs/test-bar.toml", text, Path::new(""), &overrides)
}

fn scene(rest: &str, overrides: &[&str]) -> Scene {
    read(&base(rest), overrides).unwrap_or_else(|e| panic!("{e}"))
}

fn wrong(text: &str, overrides: &[&str]) -> InputError {
    match read(text, overrides) {
        Err(Error::Input(error)) => error,
        other => panic!("{other:?}"),
    }
}

#[test]
fn defaults_are_filled_in() {
    let scene = scene("", &[]);
    assert_eq!((scene.title.as_str(), scene.name.as_str()), ("test-bar", "test-bar"));
    assert_eq!(scene.effects, Effects::default());
    assert_eq!(
        scene.solve,
        Solve {
            until: 200e-6,
            method: Method::Leapfrog { cells: 1000, cfl: 1.0 },
            tolerance: None,
            estimate_error: false,
            audit_tolerance: 0.01,
        }
    );
    assert!(!scene.bar.area_given && scene.bar.segments[0].area == 1.0 && scene.bar.segments[0].velocity == 0.0);
    assert_eq!(scene.record.fields, [Field::Stress, Field::Strain, Field::Velocity]);
    assert_eq!((scene.record.precision, scene.record.compression), (Precision::F64, Compression::Deflate));
    assert_eq!(scene.record.times.len(), 200);
    assert_eq!(scene.text, base(""));
}

#[test]
fn front_tracking_has_its_own_defaults() {
    let tracked = scene("method = \"moc\"\n", &[]);
    assert_eq!(tracked.solve.method, Method::FrontTracking { front_tolerance: 1e-3, event_budget: 10_000_000 });
    assert_eq!((tracked.record.cells, tracked.record.paths), (Some(1000), true));
    let solve = &tracked.resolved_json()["solve"];
    assert_eq!((&solve["method"], &solve["front-tolerance"]), (&"moc".into(), &1e-3.into()));
    let exact = scene("method = \"moc\"\nfront-tolerance = 0\nmax-events = 5e3\n[record]\npaths = false\n", &[]);
    assert_eq!(exact.solve.method, Method::FrontTracking { front_tolerance: 0.0, event_budget: 5000 });
    assert!(!exact.record.paths);
    // A scene for a grid has neither.
    assert!(scene("", &[]).resolved_json()["record"].get("paths").is_none());
}

#[test]
fn a_grid_scene_becomes_a_tracked_one_on_the_command_line() {
    let overrides = ["solve.method=moc", "solve.cells=", "solve.front-tolerance=0.01"];
    let changed = scene("cells = 4000\n", &overrides);
    assert_eq!(changed.solve.method, Method::FrontTracking { front_tolerance: 0.01, event_budget: 10_000_000 });
}

#[test]
fn frames_are_even_and_hold_both_ends() {
    let times = |rest: &str| scene(&format!("[record]\n{rest}"), &[]).parts.record.times;
    let five = times("frames = 5");
    assert_eq!((five.len(), five[0], five[4]), (5, 0.0, 200e-6));
    // A product and a quotient: two roundings of 1.1e-16.
    assert!(five.windows(2).all(|w| ((w[1] - w[0]) / 50e-6 - 1.0).abs() < 1e-14), "{five:?}");
    assert_eq!(times("frames = 1"), [200e-6]);
    assert_eq!(times("every = \"60 us\""), [0.0, 60e-6, 120e-6, 180e-6, 200e-6]);
    // 200 us is a multiple of 0.1 us only up to round-off: no sliver at the end.
    let fine = times("every = \"0.1 us\"");
    assert_eq!((fine.len(), fine.last()), (2001, Some(&200e-6)));
    assert_eq!(times("every = \"1 ms\""), [0.0, 200e-6]);
    assert_eq!(times("times = [0, \"200 us\"]"), [0.0, 200e-6]);
}

#[test]
fn bodies_need_the_section_on_which_they_act() {
    for end in ["striker\"\nmass = 2\nvelocity = -5", "spring\"\nstiffness = 1e7", "ball\"\nradius = 1"] {
        let text = base("").replace("kind = \"free\"", &format!("kind = \"{end}"));
        let error = wrong(&text, &[]);
        assert_eq!(error.key, "right.kind");
        assert!(error.to_string().contains("needs the cross-section"), "{error}");
    }
}

#[test]
fn joints_mean_what_they_say() {
    let two = |joint: &str| {
        let segment = format!("[[bar.segment]]\nlength = \"50 cm\"\nmaterial = {STEEL}\n");
        let text = base("")
            .replace(&format!("[bar]\nlength = \"1 m\"\nmaterial = {STEEL}\n"), &format!("{segment}{joint}{segment}"));
        read(&text, &[]).unwrap_or_else(|e| panic!("{e}")).bar.segments[0].joint
    };
    assert_eq!(two(""), Joint::Bonded);
    assert_eq!(two("joint = \"contact\"\n"), Joint::Contact { gap: 0.0 });
    assert_eq!(two("joint = \"contact\"\ngap = \"0.1 mm\"\n"), Joint::Contact { gap: 1e-4 });
}

#[test]
fn times_increase_for_any_step() {
    for i in 1..400 {
        let times = scene(&format!("[record]\nevery = {:e}\n", 1e-6 * f64::from(i) * 0.37), &[]).parts.record.times;
        assert!(times.windows(2).all(|w| w[1] > w[0]), "{i}");
        assert_eq!(times.last(), Some(&200e-6));
    }
}

#[test]
fn ends_mean_what_they_say() {
    let end = |text: &str| {
        let whole = base("").replace("kind = \"free\"", text).replace("[bar]\n", "[bar]\narea = 1\n");
        read(&whole, &[]).unwrap_or_else(|e| panic!("{e}")).parts.right
    };
    assert!(matches!(end("kind = \"wall\""), EndCondition::Wall { gap: 0.0 }));
    assert!(matches!(end("kind = \"wall\"\ngap = \"1 mm\""), EndCondition::Wall { gap } if gap == 1e-3));
    assert!(matches!(end("kind = \"fixed\""), EndCondition::Fixed));
    let striker = end("kind = \"striker\"\nmass = \"200 lb\"\nvelocity = \"-50 ft/s\"");
    let EndCondition::Striker { mass, velocity } = striker else { panic!("not a striker") };
    assert_eq!((mass, velocity), (90.718_474, -15.24));
    let ball = end("kind = \"ball\"\ndiameter = 2\nvelocity = 3\ndensity = 6\nrigid = true\nbar-poisson = 0.5");
    let EndCondition::Ball { mass, velocity, contact } = ball else { panic!("not a ball") };
    assert!((mass / (8.0 * std::f64::consts::PI) - 1.0).abs() < 1e-15);
    // The ball is rigid: E* = E/(1 - nu^2), with 200 GPa for the steel defined here.
    assert!(velocity == 3.0 && contact.radius == 1.0 && (contact.modulus * 0.75 / 200e9 - 1.0).abs() < 1e-15);
    let spring = end("kind = \"spring\"\nstiffness = \"10 kN/mm\"");
    assert!(matches!(spring, EndCondition::Spring { stiffness: 1e7 }));
    assert!(matches!(end("kind = \"absorbing\""), EndCondition::Absorbing));
    let EndCondition::Velocity { history, release } = end("kind = \"velocity\"\nvalue = 5\nrelease = \"10 us\"") else {
        panic!("not a velocity end");
    };
    assert_eq!((history.at(1.0), release), (5.0, Some(10e-6)));
    let EndCondition::Stress { history } = end("kind = \"stress\"\nhistory = [[0, \"1 MPa\"], [\"10 us\", 3e6]]")
    else {
        panic!("not a stress end");
    };
    assert_eq!(history.at(5e-6), 2e6);
}

#[test]
fn segments_share_materials_and_state_areas_together() {
    let segments = format!(
        "[[bar.segment]]\nlength = 1\ndiameter = 2\nmaterial = {STEEL}\n\
         [[bar.segment]]\nlength = 2\narea = 1\nmaterial = {STEEL}\nvelocity = \"3 m/s\"\n"
    );
    let text = base("").replace(&format!("[bar]\nlength = \"1 m\"\nmaterial = {STEEL}\n"), &segments);
    let bar = read(&text, &[]).unwrap_or_else(|e| panic!("{e}")).parts.bar;
    assert_eq!(bar.segments.len(), 2);
    assert!(bar.area_given);
    assert_eq!(bar.segments[0].area, std::f64::consts::PI);
    assert_eq!((bar.segments[1].velocity, bar.segments[0].joint), (3.0, Joint::Bonded));
    let error = wrong(&text.replace("area = 1\n", ""), &[]);
    assert_eq!(error.key, "bar.segment.1.area");
}

#[test]
fn gauges_keep_the_order_of_the_file() {
    let scene = scene("[record]\ngauges = { z = \"0.9 m\", a = \"10 cm\", m = 0.5 }\n", &[]);
    let names: Vec<&str> = scene.record.gauges.iter().map(|(name, _)| name.as_str()).collect();
    assert_eq!(names, ["z", "a", "m"]);
}

#[test]
fn overrides_change_add_and_take_out() {
    let changed = scene("", &["left.value=-40 m/s", "solve.cells=4e3", "effects.hardening=kinematic", "title=x = y"]);
    assert!(matches!(changed.left, EndCondition::Velocity { ref history, .. } if history.at(0.0) == -40.0));
    assert_eq!(changed.solve.method, Method::Leapfrog { cells: 4000, cfl: 1.0 });
    assert_eq!(changed.effects.hardening, Some(HardeningRule::Kinematic));
    assert_eq!(changed.title, "x = y");
    assert_eq!(changed.text, base(""), "the text stays as read");
    assert_eq!(changed.overrides.len(), 4);
    let swapped = scene("", &["left.value=", "left.history=[[0, 0], [\"10 us\", \"-40 m/s\"]]"]);
    assert!(matches!(swapped.left, EndCondition::Velocity { ref history, .. } if history.at(5e-6) == -20.0));
    let deep = scene("", &["effects.hardening.mixed=0.25", "record.gauges.middle=0.5", "bar.material.density=8000"]);
    assert_eq!(deep.effects.hardening, Some(HardeningRule::Mixed(0.25)));
    assert_eq!(deep.record.gauges, [("middle".to_owned(), 0.5)]);
    assert_eq!(deep.bar.segments[0].material.density, 8000.0);
}

#[test]
fn overrides_reach_into_lists() {
    let segments = format!("[[bar.segment]]\nlength = 1\nmaterial = {STEEL}\n");
    let text = base("").replace(&format!("[bar]\nlength = \"1 m\"\nmaterial = {STEEL}\n"), &segments);
    let bar = read(&text, &["bar.segment.0.length=10 in"]).unwrap_or_else(|e| panic!("{e}")).parts.bar;
    assert_eq!(bar.length(), 0.254);
    let error = wrong(&text, &["bar.segment.1.length=10 in"]);
    assert!(error.message.contains("no item 1: the list has 1"), "{error}");
}

#[test]
fn errors_of_overrides_say_so() {
    let error = wrong(&base(""), &["solve.cfl=1.5"]);
    assert_eq!(error.to_string(), "changes:1: `solve.cfl`: 1.5 is out of range (allowed: 0 < cfl <= 1)");
    let error = wrong(&base(""), &["solve.cell=1000"]);
    assert!(error.to_string().starts_with("changes:1: `solve.cell`: unknown key"), "{error}");
    let error = wrong(&base(""), &["solve.until.deep=1"]);
    assert!(error.message.contains("cannot be set inside"), "{error}");
    assert!(wrong(&base(""), &["solve.cfl"]).message.contains("missing `=`"));
    assert!(wrong(&base(""), &["=1"]).message.contains("incomplete"));
    let taken = read(&base(""), &["solve.cfl=", "effects.rate="]).unwrap_or_else(|e| panic!("{e}"));
    assert_eq!(taken.text, base(""));
}

#[test]
fn errors_beside_overrides_keep_their_line_in_the_file() {
    let text = base("[record]\ncells = 0\n");
    let line = text.lines().position(|l| l == "cells = 0").map(|i| i + 1);
    // The new table is written above the wrong line.
    let error = wrong(&text, &["effects.hardening=isotropic"]);
    assert_eq!(error.place.map(|p| p.line()), line);
}

#[test]
fn a_critical_velocity_is_that_of_a_bar_in_no_initial_state() {
    let of = |overrides: &[&str]| scene("[effects]\nhardening = \"isotropic\"\n", overrides);
    let pulled = of(&["bar.material.beyond=rupture"]);
    let hardened = of(&["bar.material.beyond=rupture", "bar.plastic-strain=0.01"]);
    assert!(pulled.critical_velocity().is_some() && pulled.notes().is_empty());
    assert_eq!(hardened.critical_velocity(), pulled.critical_velocity());
    assert_eq!(hardened.notes(), ["the critical velocity is that of a bar without initial stress and plastic strain"]);
    // In compression the data end earlier.
    let compression = "bar.material.compression={ table = [[0.001, 200e6], [0.05, 250e6]] }";
    let pushed = of(&["bar.material.beyond=rupture", "bar.plastic-strain=0.01", compression, "left.value=30"]);
    assert!(pushed.critical_velocity() < pulled.critical_velocity(), "{:?}", pushed.critical_velocity());
    // A curve that is extended without limit has no critical velocity.
    assert!(of(&["bar.plastic-strain=0.01"]).notes().is_empty());
}

#[test]
fn sharp_waves_that_leapfrog_disperses_are_noted() {
    let notes = |overrides: &[&str]| scene("", overrides).notes();
    assert!(notes(&[]).is_empty());
    let noted = notes(&["solve.cfl=0.95"]);
    assert!(noted.len() == 1 && noted[0].contains("Courant number 0.95"), "{noted:?}");
    assert!(notes(&["solve.cfl=0.95", "solve.scheme=muscl"]).is_empty());
    // The load rises linearly.
    assert!(notes(&["solve.cfl=0.95", "left.value=", "left.history=[[0, 0], [1e-5, -30]]"]).is_empty());
}

#[test]
fn the_resolved_scene_is_complete() {
    let scene = scene("[record]\ngauges = { middle = 0.5 }\n[effects]\nhardening = { mixed = 0.3 }\n", &[]);
    let json = scene.resolved_json();
    assert_eq!(json["solve"]["cells"], 1000);
    assert_eq!(json["effects"]["hardening"]["mixed"], 0.3);
    let old = scene.text.replace("hardening", "unloading");
    let old = Scene::parse("test.toml", &old, Path::new("."), &[]).expect("an old name");
    assert_eq!(old.effects, scene.effects);
    let changed = Scene::parse("test.toml", &old.text, Path::new("."), &["effects.hardening=kinematic".to_owned()]);
    assert_eq!(changed.expect("an override").effects.hardening, Some(HardeningRule::Kinematic));
    assert_eq!(old.notes(), ["the key `unloading` in [effects] is deprecated; use `hardening`"]);
    assert_eq!(json["left"]["history"][0][1], -30.0);
    assert_eq!(json["record"]["times"].as_array().map(Vec::len), Some(200));
    assert_eq!(json["record"]["gauges"]["middle"], 0.5);
    let segment = &json["bar"]["segment"][0];
    assert_eq!(segment["material"]["density"], 7800.0);
    assert!(segment["material"]["tension"]["strain"].as_array().is_some_and(|knots| knots.len() == 3));
}

#[test]
fn csv_histories_take_units_from_the_header_or_the_cells() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let write = |text: &str| std::fs::write(folder.path().join("h.csv"), text).expect("written");
    let text = base("").replace("value = \"-30 m/s\"", "csv = \"h.csv\"");
    let read = || Scene::parse("a.toml", &text, folder.path(), &[]);
    for content in [
        "time [us],velocity [ft/s]\n0,0\n10,-100\n",
        "time_us,end_velocity_ft/s\n0,0\n10,-100\n",
        "time [us],velocity_ft/s\n0,0\n10,-100\n",
        "time us,end 2 velocity ft/s\n0,0\n10,-100\n",
        "# measured\n\"time (us)\";\"v (ft/s)\"\r\n0;0\r\n10;-100\r\n\r\n",
        "0\t0\n1e-5\t-30.48\n",
        "time_rel,velocity_left\n0,0\n1e-5,-30.48\n",
        "0,0\n10 us,-100 ft/s",
    ] {
        write(content);
        let left = read().unwrap_or_else(|e| panic!("{content}: {e}")).parts.left;
        assert!(matches!(left, EndCondition::Velocity { ref history, .. } if (history.at(5e-6) + 15.24).abs() < 1e-12));
    }
    for (content, line, part) in [
        ("time,v\n0,0\n1,2,3\n", 3, "3 columns"),
        ("time,v\n1e-6,0\n0,0\n", 3, "is earlier than the row before it"),
        ("time [kg],v\n1,0\n", 1, "is a mass, but a time"),
        ("0,0\nx,y\n", 2, "does not start with a number"),
        ("0,0\n-1,0\n", 2, "out of range"),
        ("time,v\n", 1, "at least one row"),
        ("time_us,end_velocity_FT/s\n0,0\n", 1, "unknown unit `FT`; did you mean `ft`?"),
        ("time_us,stress_MPa\n0,0\n", 1, "`MPa` is a stress, but a velocity is expected"),
        ("time_us,stress Mpa\n0,0\n", 1, "unknown unit `Mpa`; did you mean `MPa`?"),
        ("time_us,force_N/mm2\n0,0\n", 1, "in the heading `force_N/mm2`"),
        ("time_mm,v\n0,0\n", 1, "`mm` is a length, but a time is expected"),
        ("time_usec,v\n0,0\n", 1, "unknown unit `usec`"),
        ("velocity [m/s],time [us]\n0,0\n", 1, "the first column is `velocity [m/s]`, not a time"),
    ] {
        write(content);
        let Err(Error::Input(error)) = read() else { panic!("{content}: accepted") };
        assert!(error.message.contains(part), "{content}: {error}");
        let place = error.place.expect("a place in the CSV file");
        assert!(place.file.ends_with("h.csv") && place.line() == line, "{content}: {}:{}", place.file, place.line());
    }
    std::fs::remove_file(folder.path().join("h.csv")).expect("removed");
    let Err(Error::Input(error)) = read() else { panic!("accepted without a file") };
    assert_eq!((error.key.as_str(), error.place.map(|p| p.file)), ("left.csv", Some("a.toml".into())));
}

#[test]
fn histories_are_read_from_columns_of_records() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let record = "Model,X1\nRecord Length,5\n\nTIME (us),CH1 (V),Speed_ft/s\n-10,0,0\n-4,1,-20\n0,2,-40\n10,2,-40\n";
    std::fs::write(folder.path().join("r.csv"), record).expect("written");
    let read = |keys: &str| {
        let text = base("").replace("value = \"-30 m/s\"", &format!("csv = {{ file = \"r.csv\"{keys} }}"));
        Scene::parse("a.toml", &text, folder.path(), &[])
    };
    for keys in [
        ", column = \"ch1\", start = \"-8 us\", scale = \"-20 ft/s\"",
        ", column = 3, start = \"-8 us\"",
        ", column = \"speed_ft/s\", time-column = 1, start = -8e-6",
    ] {
        let scene = read(keys).unwrap_or_else(|e| panic!("{keys}: {e}"));
        let EndCondition::Velocity { history, .. } = &scene.left else { panic!("{:?}", scene.left) };
        // The run begins after a third of the first rise; the rows of -4, 0 and 10 us follow.
        for (time, feet) in [(0.0, -20.0 / 3.0), (4e-6, -20.0), (8e-6, -40.0), (18e-6, -40.0)] {
            assert!((history.at(time) / 0.3048 - feet).abs() < 1e-12, "{keys}: {:?}", history.at(time) / 0.3048);
        }
        assert_eq!(history.time().len(), 4, "{keys}");
    }
    for (keys, file, line, part) in [
        (", column = 3", "r.csv", 5, "the times of the record start below zero"),
        (", start = \"-8 us\"", "r.csv", 4, "unknown unit `V`"),
        (", column = 4", "a.toml", 6, "there is no column 4 in"),
        (", column = \"CH2\"", "a.toml", 6, "there is no column `CH2` in"),
        (", column = 3, start = \"11 us\"", "a.toml", 6, "the record ends at 10 us"),
        (", column = 3, start = \"1 m\"", "a.toml", 6, "is a length, but a time"),
    ] {
        let Err(Error::Input(error)) = read(keys) else { panic!("{keys}: accepted") };
        assert!(error.message.contains(part), "{keys}: {error}");
        assert!(!error.help.is_empty(), "{keys}: {error}");
        let place = error.place.expect("a place");
        assert!(place.file.ends_with(file) && place.line() == line, "{keys}: {}:{}", place.file, place.line());
    }
}

/// Scene with a key from every part of the scene language, which is the starting point for random mistakes.
fn ground() -> String {
    base(
        "scheme = \"leapfrog\"\ncfl = 0.9\ncells = 100\n[effects]\nhardening = { mixed = 0.3 }\n[record]\nevery = \"10 us\"\n\
          gauges = { middle = 0.5 }\nfields = [\"stress\"]\n",
    )
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(1000))]

    /// A random mistake results in a valid scene or in an input error with a help line, never in a panic.
    #[test]
    fn slips_are_answered(at in 0.0..1.0_f64, cut in 0..12_usize, put in "[-\\[\\]{}=\"#.,a-z0-9 \n]{0,4}") {
        let mut text = ground();
        let start = (at * text.len() as f64) as usize;
        let end = (start + cut).min(text.len());
        text.replace_range(start..end, &put);
        match read(&text, &[]) {
            Err(Error::Input(error)) => prop_assert!(!error.help.is_empty(), "{}", error),
            Err(other) => prop_assert!(false, "{}", other),
            Ok(_) => {}
        }
    }

    /// The same holds for an override.
    #[test]
    fn overrides_are_answered(
        key in "(bar|left|solve|record|effects|title)(\\.[a-z0-9]{1,4}|\\.value|\\.gauges|\\.until|\\.0){0,3}",
        value in "[-\\[\\]{}=\"#.,a-z0-9 ]{0,6}",
    ) {
        let typed = format!("{key}={value}");
        match read(&ground(), &[&typed]) {
            Err(Error::Input(error)) => prop_assert!(!error.help.is_empty(), "{}", error),
            Err(other) => prop_assert!(false, "{}", other),
            Ok(_) => {}
        }
    }
}
