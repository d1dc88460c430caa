//! The effect `rupture`: time and position of fractures, against theory and between methods.

use std::ops::ControlFlow;
use std::path::Path;

use barwave::assemble;
use barwave::law::rupture::{Rupture, Site};
use barwave::record::{Field, View};
use barwave::scene::{Method, Scene};
use barwave::solver::fd::Quantity;
use barwave::solver::moc::Settings;

const STEEL: &str =
    r#"{ name = "s", density = 8000, modulus = 200e9, beyond = "extend", curve = { table = [[0.01, 2e9]] } }"#;
/// Material that yields at 200 MPa, hardens, and has its largest stress at a strain of 0.1.
const SOFT: &str = r#"{ name = "soft", density = 8000, modulus = 200e9, beyond = "rupture", curve = { table = [[0.001, 200e6], [0.02, 260e6], [0.05, 290e6], [0.1, 310e6], [0.2, 300e6]] } }"#;

fn scene(text: &str) -> Scene {
    Scene::parse("rupture.toml", text, Path::new("."), &[]).unwrap_or_else(|e| panic!("{e}\n{text}"))
}

fn bar(material: &str, left: &str, right: &str, effects: &str, solve: &str) -> Scene {
    scene(&format!(
        "[bar]\nlength = 0.2\narea = 1e-4\nmaterial = {material}\n[left]\n{left}\n[right]\n{right}\n[effects]\n{effects}\n\
         [solve]\n{solve}\n"
    ))
}

fn stepped(scene: &Scene) -> barwave::solver::fd::Leapfrog {
    let Method::Leapfrog { cells, cfl } = scene.solve.method else { panic!("a grid") };
    let mut bar = assemble::leapfrog(scene, cells, cfl);
    while bar.time() < scene.solve.until {
        bar.advance();
    }
    bar
}

fn tracked(scene: &Scene) -> barwave::solver::moc::FrontTracking {
    // Steps of 1e-3 of the peak; steps of a tenth of that would cause a hundred times as many interactions.
    let settings = Settings { ramp_step: Some(1e-3), ..Settings::default() };
    let mut bar = assemble::front_tracking(scene, settings);
    bar.advance_to(scene.solve.until).expect("within the budget");
    bar
}

fn both(material: &str, left: &str, right: &str, effects: &str, until: f64) -> [Vec<Rupture>; 2] {
    let by = |method: &str| bar(material, left, right, effects, &format!("until = {until}\n{method}"));
    let fd = stepped(&by("cells = 1000"));
    let moc = tracked(&by("method = \"moc\""));
    [fd.ruptures().to_vec(), moc.ruptures().to_vec()]
}

const PULSE: &str = "kind = \"stress\"\nhistory = [[0, -800e6], [8e-6, -800e6], [8e-6, 0]]";
const FREE: &str = "kind = \"free\"";

/// A rectangular pulse of length l breaks off l/2 at the free end, when its tail meets the reflection of its front there. The scab leaves with the
/// momentum of twice its length of the pulse: velocity 2 sigma/(rho c).
#[test]
fn a_rectangular_pulse_spalls_half_its_length_off_exactly_by_fronts() {
    let scene = bar(STEEL, PULSE, FREE, "rupture = { spall = 500e6 }", "until = 60e-6\nmethod = \"moc\"");
    let bar = tracked(&scene);
    let [rupture] = bar.ruptures() else { panic!("{:?}", bar.ruptures()) };
    assert!((rupture.x - 0.18).abs() < 1e-15 && (rupture.time - 44e-6).abs() < 1e-18, "{rupture:?}");
    assert!((rupture.stress - 800e6).abs() < 1.0);
    let mut v = [0.0; 4];
    bar.sample(Field::Velocity, &[0.05, 0.1799, 0.1801, 0.1999], &mut v);
    for (v, expected) in v.iter().zip([0.0, 0.0, 40.0, 40.0]) {
        assert!((v - expected).abs() < 1e-9, "{v} against {expected}");
    }
    let mut u = [0.0; 2];
    bar.sample(Field::Displacement, &[0.1799, 0.1801], &mut u);
    let gap = bar.contacts().next().expect("two faces").gap;
    // 16 us at 40 m/s.
    assert!((gap - 640e-6).abs() < 1e-12 && (u[1] - u[0] - gap).abs() < 1e-12, "{gap} {u:?}");
    let momentum = bar.balance().momentum;
    assert!((momentum - 800e6 * 1e-4 * 8e-6).abs() < 1e-12, "{momentum}");
}

/// The gap between the pieces of a bar that stays elastic is not part of its elongation, with front tracking, either: with copper that fractures at
/// 60 m/s, the elongation would be 0.72, and grow with the duration of the run.
#[test]
fn the_opening_of_a_fracture_is_no_elongation() {
    let scene = bar(STEEL, PULSE, FREE, "rupture = { spall = 500e6 }", "until = 60e-6\nmethod = \"moc\"");
    let summary = barwave::run::run(&scene, None, &mut |_| ControlFlow::Continue(())).expect("it runs");
    let [length] = summary.lengths[..] else { panic!("{:?}", summary.lengths) };
    assert_eq!(summary.outcome, "rupture");
    assert!((length.unloaded - 0.2).abs() < 1e-9 && (length.at_end - 0.2).abs() < 1e-9, "{length:?}");
}

/// On the grid, the fracture is within one cell and three steps of theory, at any resolution; there is only one, and the scab has its momentum.
#[test]
fn a_rectangular_pulse_spalls_within_a_cell_on_the_grid() {
    for cells in [500, 1000, 1100, 2200, 4000] {
        let text = format!("until = 60e-6\ncells = {cells}");
        let scene = bar(STEEL, PULSE, FREE, "rupture = { spall = 500e6 }", &text);
        let bar = stepped(&scene);
        let [rupture] = bar.ruptures() else { panic!("{cells}: {:?}", bar.ruptures()) };
        let dx = 0.2 / f64::from(cells);
        assert!((rupture.x - 0.18).abs() <= 1.01 * dx, "{cells}: {rupture:?}");
        assert!((rupture.time - 44e-6).abs() <= 3.01 * dx / 5000.0, "{cells}: {rupture:?}");
        let mut v = vec![0.0; bar.grid().cells()];
        bar.profile(Quantity::Velocity, &mut v);
        let node = (rupture.x / dx).round() as usize;
        let momentum: f64 = v[node..].iter().map(|v| v * 8000.0 * 1e-4 * dx).sum();
        let expected = 800e6 * 1e-4 * 8e-6;
        // The pulse that continues from the fracture is some cells long.
        let part = 6.0 * dx / 0.04;
        assert!((momentum / expected - 1.0).abs() < part, "{cells}: {momentum} against {expected}");
        let now = bar.energies();
        assert!(now.fracture >= 0.0 && now.fracture.is_finite());
    }
}

/// A triangular pulse of peak P and length l breaks off scabs of length l sigma/(2 P) as long as the rest of the pulse suffices: floor(P/sigma) of
/// them.
#[test]
fn a_triangular_pulse_spalls_several_times() {
    let pulse = "kind = \"stress\"\nhistory = [[0, 0], [0, -900e6], [16e-6, 0]]";
    let by = |method: &str| bar(STEEL, pulse, FREE, "rupture = { spall = 400e6 }", &format!("until = 70e-6\n{method}"));
    // The pulse is 8 cm long: scabs of 17.78 mm each.
    let expected = [0.2 - 0.08 * 4.0 / 18.0, 0.2 - 0.16 * 4.0 / 18.0];
    let near = |found: &[Rupture], tolerance: f64| {
        assert_eq!(found.len(), 2, "{found:?}");
        for (rupture, x) in found.iter().zip(expected) {
            assert!((rupture.x - x).abs() < tolerance, "{} against {x}", rupture.x);
        }
    };
    // Steps of 1e-3 of the peak, in the middle of their parts of the ramp.
    near(tracked(&by("method = \"moc\"")).ruptures(), 2e-4);
    // Two cells that must follow, four ahead of the release wave, and the cell itself.
    for cells in [1000, 4000] {
        near(stepped(&by(&format!("cells = {cells}"))).ruptures(), 7.0 * 0.2 / f64::from(cells));
    }
}

/// At 1.02 of the critical velocity, the bar fractures at the pulled end at once (on the grid, as soon as the first cell has been strained that far);
/// at 0.98, it never does.
#[test]
fn a_bar_breaks_above_its_critical_velocity_and_not_below() {
    let material = SOFT;
    let free = bar(material, FREE, FREE, "", "until = 1e-6");
    let table = &free.bar.segments[0].material;
    let critical = barwave::wave::similarity::critical(&table.tension, table.density).expect("one").velocity;
    for (part, breaks) in [(0.98, false), (1.02, true)] {
        let left = format!("kind = \"velocity\"\nvalue = {}", -part * critical);
        let effects = "hardening = \"isotropic\"\nrupture = \"critical-strain\"";
        // Until the slowest wave is well away from the struck end, but before the elastic one returns.
        let [fd, moc] = both(material, &left, "kind = \"absorbing\"", effects, 60e-6);
        assert_eq!((fd.len(), moc.len()), (usize::from(breaks), usize::from(breaks)), "{part}: {fd:?} {moc:?}");
        if breaks {
            assert!(moc[0].time == 0.0 && moc[0].x == 0.0 && fd[0].x == 0.0);
            assert!(fd[0].time < 10e-6, "{fd:?}");
        }
    }
}

/// A notch divides the threshold, in a whole segment or at a joint only.
#[test]
fn notches_break_first() {
    let text = |first: &str, method: &str| {
        format!(
            "[[bar.segment]]\nlength = 0.1\nmaterial = {STEEL}\n{first}\n[[bar.segment]]\nlength = 0.1\nmaterial = {STEEL}\n\
             [left]\nkind = \"stress\"\nvalue = 300e6\n[right]\nkind = \"free\"\n[effects]\nrupture = {{ spall = 500e6 }}\n\
             [solve]\nuntil = 30e-6\n{method}\n"
        )
    };
    let cases = [
        ("", None),
        ("joint-stress-concentration = 1.5", None),
        ("joint-stress-concentration = 2", Some(0.1)),
        ("stress-concentration = 2", Some(0.0)),
    ];
    for (first, expected) in cases {
        let fd = stepped(&scene(&text(first, "cells = 400"))).ruptures().to_vec();
        let moc = tracked(&scene(&text(first, "method = \"moc\""))).ruptures().to_vec();
        for (name, found, cell) in [("fd", fd, 5e-4), ("moc", moc, 0.0)] {
            let x: Vec<f64> = found.iter().map(|r| r.x).collect();
            assert_eq!(x.len(), usize::from(expected.is_some()), "{name} {first}: {found:?}");
            if let Some(expected) = expected {
                assert!((x[0] - expected).abs() <= 4.0 * cell + 1e-12, "{name} {first}: {x:?}");
            }
        }
    }
}

/// Two pieces that separate, rebound from walls and meet: their faces are in contact again.
#[test]
fn broken_faces_press_again() {
    let text = |until: f64, method: &str| {
        format!(
            "[[bar.segment]]\nlength = 0.1\nmaterial = {STEEL}\nvelocity = -10\njoint-stress-concentration = 1000\n[[bar.segment]]\n\
             length = 0.1\nmaterial = {STEEL}\nvelocity = 10\n[left]\nkind = \"wall\"\n[right]\nkind = \"wall\"\n[effects]\n\
             rupture = {{ spall = 500e6 }}\n[solve]\nuntil = {until}\n{method}\n"
        )
    };
    // They separate at 20 m/s until the waves of the walls arrive at 20 us, then approach with the same velocity.
    let (fd, moc) = (stepped(&scene(&text(30e-6, "cells = 400"))), tracked(&scene(&text(30e-6, "method = \"moc\""))));
    assert_eq!((fd.ruptures().len(), moc.ruptures().len()), (1, 1));
    let gaps = [fd.contacts().next().expect("faces").gap, moc.contacts().next().expect("faces").gap];
    assert!((gaps[1] - 200e-6).abs() < 1e-12, "{gaps:?}");
    // The grid breaks the joint some steps late.
    assert!((gaps[0] - 200e-6).abs() < 6.0 * 20.0 * 1e-7, "{gaps:?}");
    let (fd, moc) = (stepped(&scene(&text(50e-6, "cells = 400"))), tracked(&scene(&text(50e-6, "method = \"moc\""))));
    let contact = fd.contacts().next().expect("faces");
    assert!(contact.gap == 0.0 && (contact.force / -400e6 - 1.0).abs() < 1e-2, "{contact:?}");
    let mut stress = [0.0; 2];
    moc.sample(Field::Stress, &[0.099, 0.101], &mut stress);
    assert!(stress.iter().all(|s| (s / -400e6 - 1.0).abs() < 1e-12), "{stress:?}");
    let now = fd.energies();
    assert!(now.fracture >= 0.0 && now.fracture < 0.02 * now.total(), "{now:?}");
}

/// 200 lb at 80 ft/s break the bar of the textbook's example, 50 lb at 30 ft/s do not.
#[test]
fn the_example_of_the_energy_method() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("runs/energy-method-breaks.toml");
    let light = ["bar.segment.1.area=176.056 in^2".to_owned(), "bar.segment.1.velocity=30 ft/s".to_owned()];
    for (overrides, breaks) in [(&[][..], true), (&light[..], false)] {
        let bar = stepped(&Scene::read(&path, overrides).expect("a right scene"));
        assert_eq!(bar.ruptures().len(), usize::from(breaks), "{:?}", bar.ruptures());
        if let [rupture] = bar.ruptures() {
            // 981.75 ft lbf for uniform strain; the strain below the threshold elsewhere reduces this.
            let whole = 981.75 * 1.355_818;
            assert!((0.5..1.05).contains(&(rupture.bar_absorbed / whole)), "{rupture:?}");
            assert!((rupture.absorbed / 41.3685e6 - 1.0).abs() < 1e-3, "{rupture:?}");
        }
    }
}

/// A threshold that is not reached gives the same bits as the disabled effect; disabled, it needs no memory.
#[test]
fn off_is_free_and_unreached_changes_no_bit() {
    let left = "kind = \"velocity\"\nvalue = -12";
    let run = |effects: &str| stepped(&bar(SOFT, left, "kind = \"fixed\"", effects, "until = 100e-6\ncells = 500"));
    let (off, on) = (run("hardening = \"isotropic\""), run("hardening = \"isotropic\"\nrupture = { spall = 1e12 }"));
    for quantity in [Quantity::Stress, Quantity::Strain, Quantity::Velocity] {
        let read = |bar: &barwave::solver::fd::Leapfrog| {
            let mut out = vec![0.0; 500];
            bar.profile(quantity, &mut out);
            out.into_iter().map(f64::to_bits).collect::<Vec<_>>()
        };
        assert_eq!(read(&off), read(&on));
    }
    assert_eq!(on.state_bytes() - off.state_bytes(), 500 * 8);
    assert!(off.ruptures().is_empty() && on.ruptures().is_empty());
}

/// The table exists if the effect is on, with one row for each rupture, and does not exist if it is off.
#[test]
fn the_file_has_a_table_of_ruptures() {
    let folder = tempfile::tempdir().expect("a folder");
    for (effects, rows) in
        [("", None), ("rupture = { spall = 500e6 }", Some(1)), ("rupture = { spall = 2e9 }", Some(0))]
    {
        let path = folder.path().join("out.h5");
        let scene = bar(STEEL, PULSE, FREE, effects, "until = 60e-6\ncells = 400");
        let summary = barwave::run::run(&scene, Some(&path), &mut |_| ControlFlow::Continue(())).expect("it runs");
        assert_eq!(summary.outcome, if rows == Some(1) { "rupture" } else { "done" });
        assert_eq!(summary.ruptures.map(|r| r.len()), rows);
        let file = hdf5::File::open(&path).expect("a file");
        assert_eq!(file.dataset("ruptures/time").ok().map(|column| column.shape()[0]), rows);
        assert_eq!(
            file.dataset("ledger/fracture").expect("a column").shape(),
            file.dataset("ledger/time").expect("a column").shape()
        );
    }
}

#[test]
fn what_is_wrong_is_said() {
    let wrong = |segment: &str, effects: &str, solve: &str| {
        let text = format!(
            "[[bar.segment]]\nlength = 0.1\nmaterial = {STEEL}\n{segment}\n[left]\nkind = \"free\"\n[right]\nkind = \"free\"\n\
             [effects]\n{effects}\n[solve]\nuntil = 1e-6\n{solve}\n"
        );
        Scene::parse("x.toml", &text, Path::new("."), &[]).expect_err("wrong").to_string()
    };
    assert!(wrong("stress-concentration = 2", "", "").contains("fracture is not simulated"));
    assert!(wrong("stress-concentration = 0.5", "rupture = { spall = 1e9 }", "").contains("0.5"));
    assert!(wrong("joint-stress-concentration = 2", "rupture = { spall = 1e9 }", "").contains("no joint"));
    assert!(wrong("", "rupture = \"critical-strain\"", "").contains("has no critical strain"));
    assert!(wrong("", "rupture = { spall = \"1 m\" }", "").contains("stress"));
    let stressed = |effects: &str| wrong("stress-concentration = 2\nstress = 1e8", effects, "");
    assert!(stressed("rupture = { spall = 2e8 }").contains("less than 1.000000e8 Pa"));
    assert!(wrong("", "rupture = { energy = 0 }", "").contains('0'));
    let rate = "rate = { model = \"malvern\", k = 1e6 }\nrupture = { spall = 1e9 }";
    assert!(wrong("", rate, "method = \"moc\"").contains("characteristic net"));
}

/// Pulls two SOFT bars apart at the notch of the joint, with the given rate law (or none: instantaneous plastic flow).
fn pulled_at(rate: &str, velocity: f64, cells: usize) -> Vec<Rupture> {
    let effects = format!("hardening = \"isotropic\"\nrupture = \"critical-strain\"\n{rate}");
    let left = format!("kind = \"velocity\"\nvalue = {}", -velocity);
    let solve = format!("until = 60e-6\nmethod = \"fd\"\ncells = {cells}");
    stepped(&bar(SOFT, &left, "kind = \"absorbing\"", &effects, &solve)).ruptures().to_vec()
}

/// An end that is pulled hard enough fractures there, at the threshold, and not further inside, as with front tracking.
#[test]
fn a_pulled_end_breaks_at_the_threshold() {
    let left = |velocity: f64| format!("kind = \"velocity\"\nvalue = {}", -velocity);
    let effects = "hardening = \"isotropic\"\nrupture = \"critical-strain\"";
    let first = |velocity: f64| {
        let solve = "until = 60e-6\nmethod = \"fd\"\ncells = 1000";
        let found =
            stepped(&bar(SOFT, &left(velocity), "kind = \"absorbing\"", effects, solve)).ruptures().first().copied();
        found.expect("above the critical velocity, 40 m/s")
    };
    for velocity in [41.0, 50.0, 60.0] {
        let rupture = first(velocity);
        // The threshold, and the increment of a step: velocity times dt/dx.
        let (threshold, step) = (0.1, velocity / 5000.0);
        assert_eq!((rupture.site, rupture.x), (Site::Left, 0.0), "{rupture:?}");
        assert!((threshold..threshold + step).contains(&rupture.strain), "{velocity}: {rupture:?}");
    }
}

/// An end that has broken off no longer drives the bar, as its history shows. It must not follow the fan of its load for 24 cells, beside which the
/// bar would fracture again and again.
#[test]
fn an_end_that_has_broken_off_drives_no_fan() {
    let left = "kind = \"velocity\"\nvalue = -30";
    let effects = "hardening = \"isotropic\"\nrupture = { energy = 500e3 }";
    let of = |cells: usize| {
        let solve = format!("until = 30e-6\nmethod = \"fd\"\ncells = {cells}");
        stepped(&bar(SOFT, left, "kind = \"free\"", effects, &solve)).ruptures().to_vec()
    };
    for cells in [500, 2000] {
        let ruptures = of(cells);
        assert!(ruptures.len() == 1 && ruptures[0].site == Site::Left, "{cells}: {ruptures:?}");
    }
}

/// With almost instantaneous flow, the bar fractures as with instantaneous flow; with slower flow it fractures later, since the overstress transmits
/// the strain.
#[test]
fn with_a_rate_the_bar_breaks_later_and_without_delay_as_before() {
    // Above the critical velocity, 40 m/s.
    let velocity = 60.0;
    let plain = pulled_at("", velocity, 1000);
    let [first] = &plain[..] else { panic!("{plain:?}") };
    let time = |k: f64| {
        let found = pulled_at(&format!("rate = {{ model = \"malvern\", k = {k:e} }}"), velocity, 1000);
        let [rupture] = &found[..] else { panic!("{k}: {found:?}") };
        assert_eq!(rupture.x, 0.0, "{rupture:?}");
        rupture.time
    };
    let times = [1e7, 3e7, 1e8, 1e10].map(time);
    assert!(times.windows(2).all(|pair| pair[1] < pair[0]), "{times:?}");
    // A cell is crossed in 40 ns; the relaxation time is 0.1 ns.
    assert!((times[3] - first.time).abs() <= 2.0 * 40e-9, "{times:?} {first:?}");
}

/// The energy criterion uses the whole work of strain, including that of the overstress of a rate law.
#[test]
fn with_a_rate_energy_and_spall_break_as_they_should() {
    let pulse = "kind = \"velocity\"\nvalue = 15\nrelease = 4e-6";
    let rate = "hardening = \"isotropic\"\nrate = { model = \"cowper-symonds\", D = 40, q = 5 }";
    let run = |rupture: &str| {
        let effects = format!("{rate}\nrupture = {rupture}");
        stepped(&bar(SOFT, pulse, FREE, &effects, "until = 60e-6\nmethod = \"fd\"\ncells = 2000"))
    };
    let spalled = run("{ spall = 200e6 }");
    let [rupture, ..] = spalled.ruptures() else { panic!("no spall") };
    // Half the pulse (2 cm) from the free end, or nearer to it where the tail has spread.
    assert!(rupture.x > 0.185 && rupture.x < 0.2 && rupture.stress >= 200e6, "{rupture:?}");
    let absorbed = run("{ energy = 5e6 }");
    for rupture in absorbed.ruptures() {
        assert!(rupture.absorbed >= 5e6, "{rupture:?}");
    }
    for bar in [spalled, absorbed] {
        let now = bar.energies();
        assert!(now.total().is_finite() && now.fracture >= 0.0);
    }
}

/// A hardened bar fractures to the right of its middle, and its mirror image to the left; both pieces must continue alike. The part on the right must
/// not respond as if it had flowed.
#[test]
fn a_hardened_bar_and_its_mirror_image_break_alike() {
    let parted = |profile: &str| {
        let state = format!("{SOFT}\nplastic-strain = 0.005\nvelocity = {profile}");
        let effects = "rupture = { spall = 100e6 }\nhardening = \"isotropic\"";
        stepped(&bar(&state, FREE, FREE, effects, "until = 80e-6\nmethod = \"fd\"\ncells = 50\ncfl = 0.626"))
    };
    let bars = ["[[0, 0], [0.12, 0], [0.12, 6], [0.2, 6]]", "[[0, -6], [0.08, -6], [0.08, 0], [0.2, 0]]"].map(parted);
    let [found, mut mirrored] = bars.each_ref().map(|bar| {
        assert!(!bar.ruptures().is_empty());
        let mut stress = vec![0.0; bar.grid().cells()];
        bar.profile(Quantity::Stress, &mut stress);
        stress
    });
    mirrored.reverse();
    for (cell, (a, b)) in found.iter().zip(&mirrored).enumerate() {
        assert!((a - b).abs() < 1.0, "cell {cell}: {a} and {b} Pa");
    }
}

/// A spall needs five cells at the threshold on a grid; a pulse of four cells is reported.
#[test]
fn a_pulse_too_short_for_the_grid_is_reported() {
    // 4 mm long, which is four cells of 200 and forty of 2000: half of it breaks off.
    let pulse = "kind = \"stress\"\nhistory = [[0, -800e6], [0.8e-6, -800e6], [0.8e-6, 0]]";
    let short = |cells: usize| {
        let solve = format!("until = 60e-6\nmethod = \"fd\"\ncells = {cells}");
        let scene = bar(STEEL, pulse, FREE, "rupture = { spall = 500e6 }", &solve);
        let summary = barwave::run::run(&scene, None, &mut |_| ControlFlow::Continue(())).expect("a run");
        let rows: Vec<_> = summary.audit.into_iter().filter(|row| row.effect == "rupture").collect();
        (summary.ruptures.expect("a row for each").len(), rows)
    };
    let (broken, rows) = short(200);
    assert_eq!(broken, 0);
    assert!(rows.len() == 1 && rows[0].matters() && rows[0].finding.contains("a factor of 1.60"), "{rows:?}");
    let (broken, rows) = short(2000);
    assert!(broken >= 1 && rows.len() == 1 && rows[0].finding.contains("leaves tensile pulses"), "{broken} {rows:?}");
}

/// Waves that meet at a fixed end strain a bar beyond the largest stress of its falling curve: stresses and energies do not depend on the cell size,
/// but the largest strain does, and the run notes this.
#[test]
fn a_softening_bar_says_that_its_strain_depends_on_the_cells() {
    let curve = "[[0.001, 200e6], [0.01, 300e6], [0.05, 250e6], [0.2, 100e6]]";
    let material = format!(
        "{{ name = \"falls\", density = 7800, modulus = 200e9, beyond = \"extend\", curve = {{ table = {curve} }} }}"
    );
    let by = |cells: usize, effects: &str| {
        let (left, right) = ("kind = \"velocity\"\nvalue = -12", "kind = \"fixed\"");
        let scene = bar(&material, left, right, effects, &format!("until = 120e-6\nmethod = \"fd\"\ncells = {cells}"));
        let solution =
            barwave::run::solve(&scene, &mut |_| ControlFlow::Continue(())).unwrap_or_else(|e| panic!("{e}"));
        let strain =
            solution.last(Field::Strain).expect("a recorded field").iter().fold(0.0_f64, |most, e| most.max(*e));
        let note =
            solution.summary.audit.iter().find(|row| row.effect == "rupture").expect("it is off").finding.clone();
        (strain, note, solution.ledger.last().expect("a row").energies.plastic)
    };
    let [(coarse, note, few), (fine, _, many)] = [100, 400].map(|cells| by(cells, "hardening = \"isotropic\""));
    assert!(fine > 1.5 * coarse && (few / many - 1.0).abs() < 0.01, "{coarse} and {fine}, {few} and {many} J");
    assert!(note.contains("the strain localizes") && note.contains("depend on the cell size"), "{note}");
    let (_, with_rate, _) = by(100, "hardening = \"isotropic\"\nrate = { model = \"cowper-symonds\", D = 40, q = 5 }");
    assert!(!with_rate.contains("cell size"), "{with_rate}");
}

/// The audit uses the strain of the first cell, 115 % of the fracture strain, and not that between the first cells, 99 % of it.
#[test]
fn a_bar_that_would_break_in_one_cell_says_so() {
    let pulled = |effects: &str| {
        let (left, right) = ("kind = \"velocity\"\nvalue = -46", "kind = \"free\"");
        let text = format!(
            "[bar]\nlength = 0.5\nmaterial = \"copper-ofhc-jc\"\n[left]\n{left}\n[right]\n{right}\n[effects]\n{effects}\n\
             [solve]\nuntil = 150e-6\ncells = 400\n"
        );
        let summary = barwave::run::run(&scene(&text), None, &mut |_| ControlFlow::Continue(()));
        summary.unwrap_or_else(|e| panic!("{e}"))
    };
    let summary = pulled("hardening = \"isotropic\"\nrate = \"material\"");
    let row = summary.audit.iter().find(|row| row.effect == "rupture").expect("it is off");
    assert!(row.matters() && row.finding.contains("115 % of the fracture strain"), "{row:?}");
    let broken = pulled("hardening = \"isotropic\"\nrate = \"material\"\nrupture = \"critical-strain\"");
    assert_eq!(broken.ruptures.expect("asked for").len(), 1);
}

/// Returns two rods of sections 2 and 1 cm^2, joined by a notch.
fn joined(notch: f64, length: f64, left: &str, solve: &str) -> Scene {
    scene(&format!(
        "[[bar.segment]]\nlength = {length}\narea = 2e-4\nmaterial = {STEEL}\njoint-stress-concentration = {notch}\n\
         [[bar.segment]]\nlength = {length}\narea = 1e-4\nmaterial = {STEEL}\n[left]\n{left}\n[right]\nkind = \"free\"\n\
         [effects]\nrupture = {{ spall = 600e6 }}\n[solve]\n{solve}\n"
    ))
}

/// The cells that must be equally close to fracture exclude those of the thicker rod, which never are; otherwise, the joint would never fracture on a
/// grid.
#[test]
fn a_notched_joint_of_unlike_sections_breaks_on_grids() {
    let pulled = "kind = \"stress\"\nvalue = 150e6";
    for (notch, breaks) in [(2.9, false), (3.1, true), (3.75, true)] {
        let fd = stepped(&joined(notch, 0.2, pulled, "until = 70e-6\ncells = 400"));
        let moc = tracked(&joined(notch, 0.2, pulled, "until = 70e-6\nmethod = \"moc\""));
        for found in [fd.ruptures(), moc.ruptures()] {
            assert_eq!(found.len(), usize::from(breaks), "{notch}: {found:?}");
            // The thinner rod has 200 MPa when the wave has arrived.
            assert!(
                found.iter().all(|rupture| rupture.site == Site::Joint(0) && (rupture.time / 40e-6 - 1.0).abs() < 0.02)
            );
            assert!(found.iter().all(|rupture| (rupture.stress / 200e6 - 1.0).abs() < 0.01 && rupture.segment == 1));
        }
    }
}

/// A pulse is reflected from both ends, and the reflections reach the joint simultaneously from both sides: their sum must not count as the previous
/// state.
#[test]
fn a_joint_breaks_under_waves_that_come_from_both_sides_at_once() {
    let pulse = "kind = \"stress\"\nhistory = [[0, -300e6], [8e-6, -300e6], [8e-6, 0]]";
    for (length, notch, breaks) in [(0.1, 1.45, false), (0.1, 2.0, true), (0.1, 3.0, true)] {
        let found = tracked(&joined(notch, length, pulse, "until = 75e-6\nmethod = \"moc\"")).ruptures().to_vec();
        assert_eq!(found.len(), usize::from(breaks), "{notch}: {found:?}");
        // The thinner rod has 400 MPa, and fractures.
        assert!(
            found.iter().all(|rupture| rupture.segment == 1 && (rupture.stress / 400e6 - 1.0).abs() < 1e-9),
            "{found:?}"
        );
    }
}

/// A pulse of 800 MPa and 40 mm length breaks off 20 mm, which move with twice the particle velocity of the pulse; the rest has the remainder.
#[test]
fn fragments_have_their_mass_velocity_and_energy() {
    for (method, near) in [("method = \"moc\"", 1e-9), ("cells = 1000", 0.025)] {
        let scene = bar(STEEL, PULSE, FREE, "rupture = { spall = 500e6 }", &format!("until = 60e-6\n{method}"));
        let summary = barwave::run::run(&scene, None, &mut |_| ControlFlow::Continue(())).expect("a run");
        let figures = |number: &str| {
            let group = summary.figures.0.iter().find(|group| group.path == ["fragments", number]).expect("a fragment");
            move |name: &str| group.figures.iter().find(|figure| figure.name == name).expect("a figure").value
        };
        let (rest, scab) = (figures("1"), figures("2"));
        assert!(summary.figures.0.iter().all(|group| group.path != ["fragments", "3"]));
        // rho c = 4e7: 800 MPa correspond to a particle velocity of 20 m/s.
        let (mass, velocity) = (8000.0 * 1e-4 * 0.02, 40.0);
        for (found, exact) in [
            (scab("position"), 0.18),
            (scab("length"), 0.02),
            (scab("mass"), mass),
            (scab("velocity"), velocity),
            (scab("kinetic_energy"), 0.5 * mass * velocity * velocity),
            (rest("length"), 0.18),
        ] {
            assert!((found / exact - 1.0).abs() < near, "{method}: {found} for {exact}");
        }
        // The scab has the whole momentum of the pulse.
        assert!(rest("velocity").abs() < near * velocity, "{method}: {}", rest("velocity"));
    }
}
