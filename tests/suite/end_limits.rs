//! Ends in limiting cases, with every method through the program: light and heavy masses, soft and rigid springs, dashpots, contacts that open and
//! close, sudden impacts; and properties that every ledger must have.

use crate::common::binary;
use crate::common::methods;

use barwave::record::LedgerRow;
use barwave::record::Trace;
use barwave::record::store::{ResultFile, Side};
use binary::barwave;
use methods::{AREA, BILINEAR, METHODS, Method, assert_ledger, finished, impedance};
use serde_json::Value;

struct Run {
    ledger: Vec<LedgerRow>,
    left: Trace,
}

impl Run {
    /// Returns the largest compressive stress at the left end, Pa.
    fn peak(&self) -> f64 {
        self.left.stress.iter().fold(0.0, |most: f64, stress| most.max(stress.abs()))
    }

    /// Returns the stress at the left end at the end of the run, Pa.
    fn last(&self) -> f64 {
        *self.left.stress.last().expect("a row")
    }
}

fn scene((_, solve, effects): Method, bar: &str, ends: [&str; 2], until: &str) -> String {
    let [left, right] = ends;
    format!(
        "bar = {{ {bar} }}\nleft = {{ {left} }}\nright = {{ {right} }}\neffects = {{ {effects} }}\n\
         solve = {{ until = \"{until}\", {solve} }}\nrecord = {{ frames = 101 }}\n"
    )
}

fn run(method: Method, bar: &str, ends: [&str; 2], until: &str) -> Run {
    run_scene(method.0, &scene(method, bar, ends, until))
}

fn run_scene(name: &str, scene: &str) -> Run {
    let (_folder, file) = finished(name, scene);
    let ledger = assert_ledger(name, &file, scene);
    let left = file.end(Side::Left).expect("an end");
    Run { ledger, left }
}

fn bar(velocity: f64) -> String {
    format!("length = 1, area = {AREA}, velocity = {velocity}, material = {BILINEAR}")
}

const FREE: &str = "kind = \"free\"";

#[test]
fn a_striker_lighter_than_a_cell_gives_its_momentum_and_no_more() {
    // 100 cells of 7.8 g each; masses down to a millionth of that.
    for method in METHODS {
        for mass in [7.8e-3, 7.8e-4, 1e-6, 1e-9] {
            let striker = format!("kind = \"striker\", mass = {mass:e}, velocity = 5");
            let found = run(method, &bar(0.0), [&striker, FREE], "150 us");
            let momentum = found.ledger.last().expect("a row").energies.momentum;
            // The velocity of the mass has decayed as exp(-Y t/M), or the far end has reflected the pulse by then.
            assert!((momentum / (mass * 5.0) - 1.0).abs() < 1e-4, "{} {mass}: {momentum:e}", method.0);
            let start = 0.5 * mass * 25.0;
            for row in &found.ledger {
                let stored = row.energies.kinetic + row.energies.elastic;
                assert!(stored <= start * (1.0 + 1e-9), "{} {mass}: {stored:e} of {start:e}", method.0);
            }
        }
    }
}

#[test]
fn a_massive_striker_prescribes_the_velocity() {
    for method in METHODS {
        let heavy = run(method, &bar(0.0), ["kind = \"striker\", mass = 1e9, velocity = 8", FREE], "150 us");
        let driven = run(method, &bar(0.0), ["kind = \"velocity\", value = 8", FREE], "150 us");
        let apart = (heavy.last() / driven.last() - 1.0).abs();
        // A driven end of leapfrog starts with the exact fan, a struck one with the solution on the grid.
        let allowed = if method.0 == "leapfrog" { 5e-3 } else { 1e-6 };
        assert!(apart < allowed, "{}: {:e} {:e}", method.0, heavy.last(), driven.last());
    }
}

#[test]
fn a_spring_of_any_stiffness_up_to_a_fixed_end() {
    for method in METHODS {
        let fixed = run(method, &bar(-10.0), ["kind = \"fixed\"", FREE], "150 us");
        let mut before = 0.0;
        for stiffness in [1e3, 1e6, 1e8, 1e10, 1e11, 1e13, 1e15] {
            let spring = format!("kind = \"spring\", stiffness = {stiffness:e}");
            let found = run(method, &bar(-10.0), [&spring, FREE], "150 us");
            // A bilinear bar struck at 10 m/s carries 262 MPa behind its fan; leapfrog overshoots a little. With a rate, the response is elastic at
            // first.
            let most = if method.0 == "net" { 1.001 * 10.0 * impedance() / AREA } else { 1.1 * 262e6 };
            assert!(found.peak() < most, "{} {stiffness:e}: {:e}", method.0, found.peak());
            assert!(found.peak() > 0.98 * before, "{} {stiffness:e}: {:e} after {before:e}", method.0, found.peak());
            before = found.peak();
            if stiffness > 1e12 {
                let apart = (found.last() / fixed.last() - 1.0).abs();
                // The same as for a heavy striker.
                let allowed = if method.0 == "leapfrog" { 1e-2 } else { 1e-3 };
                assert!(apart < allowed, "{} {stiffness:e}: {:e} {:e}", method.0, found.last(), fixed.last());
            }
        }
    }
}

#[test]
fn a_dashpot_reflects_as_its_coefficient_says() {
    // An elastic pulse of 1 m/s: behind its reflection the face moves with 2 Z/(Z + c) v and carries a stress of c times that.
    for method in METHODS {
        for part in [0.0, 0.1, 1.0, 10.0, 1e9] {
            let c = part * impedance();
            let dashpot = format!("kind = \"dashpot\", coefficient = {c:e}");
            let found = run(method, &bar(0.0), [&dashpot, "kind = \"velocity\", value = -1"], "300 us");
            let velocity = 2.0 / (1.0 + part);
            let stress = -c * velocity / AREA;
            let scale = impedance() / AREA;
            assert!((found.last() - stress).abs() < 1e-6 * scale, "{} {part}: {:e} {stress:e}", method.0, found.last());
            let last = found.left.velocity.last().expect("a row");
            assert!((last + velocity).abs() < 1e-6, "{} {part}: {last} {velocity}", method.0);
        }
    }
}

#[test]
fn a_dashpot_of_the_bars_impedance_is_the_absorbing_end() {
    for method in METHODS {
        let c = impedance();
        let dashpot = format!("kind = \"dashpot\", coefficient = {c:.17e}");
        let ends = |left| [left, "kind = \"stress\", value = \"-120 MPa\""];
        let one = run(method, &bar(0.0), ends(dashpot.as_str()), "700 us");
        let other = run(method, &bar(0.0), ends("kind = \"absorbing\""), "700 us");
        for (a, b) in one.left.stress.iter().zip(&other.left.stress) {
            assert!((a - b).abs() < 1e-9 * 120e6, "{}: {a:e} {b:e}", method.0);
        }
    }
}

#[test]
fn a_dashpot_only_takes_energy() {
    for method in METHODS {
        for part in [0.3, 3.0] {
            let dashpot = format!("kind = \"dashpot\", coefficient = {:e}", part * impedance());
            let found = run(method, &bar(-9.0), [&dashpot, "kind = \"fixed\""], "1 ms");
            let mut least = 0.0;
            for row in &found.ledger {
                // Relative to the initial energy of the bar; the rest is rounding.
                assert!(row.work_left <= least + 1e-9 * 39.0, "{} {part}: {:e} {least:e}", method.0, row.work_left);
                least = row.work_left;
            }
            assert!(least < -1.0, "{} {part}: {least:e}", method.0);
        }
    }
}

/// Means over a step in which a face arrives at a wall have both a force and a velocity. Their product is energy that the scheme loses, not work of the wall.
#[test]
fn a_wall_does_no_work() {
    for method in METHODS {
        for velocity in [3.0, 9.0] {
            let ends = ["kind = \"wall\", gap = 1e-4", "kind = \"wall\", gap = 1.3e-4"];
            let found = run(method, &bar(velocity), ends, "3 ms");
            let lost = found.ledger.last().map_or(0.0, |row| row.energies.numerical + row.energies.half_step);
            println!("{} {velocity} m/s: {lost:.3} J lost", method.0);
            for row in &found.ledger {
                assert_eq!([row.work_left, row.work_right], [0.0; 2], "{} {velocity} m/s", method.0);
            }
        }
    }
}

/// Returns the stress in the left of two bars that meet at 1 m/s between fixed ends, relative to rho c0 v; x in lengths of a bar, t in transits.
fn between_walls(x: f64, t: f64) -> f64 {
    let t = t % 3.0;
    let (pressed, pulled) = if t < 1.0 {
        (x > 1.0 - t, x < t)
    } else if t < 2.0 {
        (x < t - 1.0, false)
    } else {
        (x < 3.0 - t, false)
    };
    f64::from(u8::from(pulled)) - f64::from(u8::from(pressed))
}

#[test]
fn a_contact_that_opens_and_closes_stays_exact() {
    let piece = |velocity: f64, joint: &str| {
        format!(
            "[[bar.segment]]\nlength = 0.3\narea = {AREA}\nvelocity = {velocity}\n{joint}material = {{ name = \"elastic\", density = 7800, modulus = 200e9, beyond = \"extend\", curve = {{ table = [[0.01, 2000e6]] }} }}\n"
        )
    };
    for until in [0.25e-3, 10e-3] {
        for cells in [20_usize, 21, 50, 100, 101, 200, 400] {
            let scene = format!(
                "{}{}[left]\nkind = \"fixed\"\n[right]\nkind = \"fixed\"\n[solve]\nuntil = {until}\ncells = {cells}\n[record]\ntimes = [{until}]\nfields = [\"stress\"]\n",
                piece(1.0, "joint = \"contact\"\n"),
                piece(-1.0, "")
            );
            let folder = tempfile::tempdir().expect("a folder");
            std::fs::write(folder.path().join("scene.toml"), &scene).expect("a folder to write to");
            let output = barwave(folder.path(), &["run", "--quiet", "-o", "out.h5", "scene.toml"]);
            assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
            let file = ResultFile::open(&folder.path().join("out.h5")).expect("a result");
            let stress = file.field(barwave::record::Field::Stress, 0..1).expect("a field");
            let c0 = (200e9_f64 / 7800.0).sqrt();
            let (half, scale) = (stress.len() / 2, impedance() / AREA);
            let exact = |x: f64| between_walls(x, until * c0 / 0.3);
            let (fine, mut missed, mut sampled, mut size) = (200, 0.0, 0.0, 0.0);
            for cell in 0..half {
                let at = |k: usize| (cell as f64 + (k as f64 + 0.5) / f64::from(fine)) / half as f64;
                let mean = (0..fine as usize).map(|k| exact(at(k))).sum::<f64>() / f64::from(fine);
                for k in 0..fine as usize {
                    missed += (stress[[0, cell]] / scale - exact(at(k))).abs();
                    sampled += (mean - exact(at(k))).abs();
                    size += exact(at(k)).abs();
                }
            }
            // Error of sampling cell means, and half a cell of one front where the fronts coincide with the grid.
            let allowed = 2.0 * sampled / size + 0.5 / half as f64;
            assert!(missed / size < allowed, "{cells} cells, {until} s: {:.4} for {allowed:.4}", missed / size);
        }
    }
}

#[test]
fn sudden_impacts_have_the_force_and_the_strain_of_theory_at_the_struck_end() {
    let copper = |velocity: f64| {
        format!(
            "length = \"23.47 mm\", diameter = \"7.62 mm\", velocity = {velocity}, material = \"copper-ofhc-taylor-jc\""
        )
    };
    for velocity in [30.0, 60.0, 123.0] {
        for cells in [100, 200, 400] {
            let solve = format!("cells = {cells}");
            let scene = format!(
                "bar = {{ {} }}\nleft = {{ kind = \"wall\" }}\nright = {{ kind = \"free\" }}\neffects = {{ hardening = \"isotropic\" }}\nsolve = {{ until = \"6 us\", {solve} }}\nrecord = {{ frames = 2, fields = [\"strain\"] }}\n",
                copper(-velocity)
            );
            let folder = tempfile::tempdir().expect("a folder");
            std::fs::write(folder.path().join("scene.toml"), &scene).expect("a folder to write to");
            let output = barwave(folder.path(), &["run", "--json", "-o", "out.h5", "scene.toml"]);
            assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
            let summary: Value = serde_json::from_slice(&output.stdout).expect("one JSON value");
            let front = summary["fronts"].as_array().expect("fronts").last().expect("a front").clone();
            let theory = |key: &str| front[key].as_f64().expect("a number");
            let file = ResultFile::open(&folder.path().join("out.h5")).expect("a result");
            let end = file.end(Side::Left).expect("an end");
            let peak = end.stress.iter().fold(0.0, |most: f64, stress| most.max(-stress));
            let strains = file.field(barwave::record::Field::Strain, 1..2).expect("a field");
            let (force, strain) = (peak / -theory("stress_behind_Pa"), strains[[0, 0]] / theory("strain_behind"));
            assert!((force - 1.0).abs() < 0.02, "{velocity} m/s, {cells} cells: force {force}");
            assert!((strain - 1.0).abs() < 0.02, "{velocity} m/s, {cells} cells: strain {strain}");
        }
    }
}

#[test]
fn waves_do_not_stop_between_blocks_where_forces_act_along_the_bar() {
    let piece = |velocity: f64| {
        format!(
            "[[bar.segment]]\nlength = 0.5\narea = \"1 cm^2\"\nmaterial = \"steel-304l-jc\"\nvelocity = {velocity}\n"
        )
    };
    let scene = |effects: &str| {
        format!(
            "{}{}[left]\nkind = \"free\"\n[right]\nkind = \"free\"\n[effects]\n{effects}\n[solve]\nuntil = \"80 us\"\nmethod = \"fd\"\ncells = 1000\n[record]\nframes = 2\ngauges = {{ a = 0.15, b = 0.45, c = 0.55, d = 0.85 }}\n",
            piece(5.0),
            piece(0.0)
        )
    };
    for along in ["external = 1e-6", "internal = 1e-6", "foundation = 1e-6"] {
        let folder = tempfile::tempdir().expect("a folder");
        let effects = format!("hardening = \"isotropic\"\ndamping = {{ {along} }}");
        std::fs::write(folder.path().join("scene.toml"), scene(&effects)).expect("a folder to write to");
        let output = barwave(folder.path(), &["run", "--quiet", "-o", "out.h5", "scene.toml"]);
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        let file = ResultFile::open(&folder.path().join("out.h5")).expect("a result");
        for gauge in file.gauges().expect("gauges") {
            let (name, trace) = (&gauge.name, &gauge.trace);
            let (stress, velocity) = (trace.stress.last().expect("a row"), trace.velocity.last().expect("a row"));
            // rho c0 times half of 5 m/s.
            assert!((stress / -97.6e6 - 1.0).abs() < 2e-3, "{along}, {name}: {stress:e}");
            assert!((velocity - 2.5).abs() < 1e-3, "{along}, {name}: {velocity}");
        }
    }
}

#[test]
fn the_grid_filter_takes_as_much_at_any_courant_number() {
    // The same front crosses the same cells, in three times as many steps.
    let taken = |cfl: f64| {
        let method =
            ("leapfrog", Box::leak(format!("cells = 400, cfl = {cfl}").into_boxed_str()) as &str, METHODS[0].2);
        let found = run(method, &bar(0.0), ["kind = \"velocity\", value = 20", FREE], "150 us");
        found.ledger.last().expect("a row").energies.numerical
    };
    let [one, third] = [0.9, 0.3].map(taken);
    // The ripples of the scheme vary a little with the Courant number. A filter applied per step would dissipate three times as much.
    assert!((third / one - 1.0).abs() < 0.6, "{one:e} {third:e}");
}
