//! Forces, contact, gauges, residual deformation and rebound in exact cases, with every method, through the program.

use crate::common::binary;
use crate::common::exact;
use crate::common::methods;

use barwave::record::store::ResultFile;
use exact::{Case, cases, number, numbers};
use methods::{AREA, BILINEAR, METHODS, Method, impedance};
use serde_json::Value;

const LENGTH: f64 = 0.5;
const CELLS: f64 = 100.0;

/// Returns the elastic transit time of the bar, s.
fn transit() -> f64 {
    LENGTH * AREA * 7800.0 / impedance()
}

/// Returns the mass of the bar, kg.
fn mass() -> f64 {
    7800.0 * AREA * LENGTH
}

/// Returns the figures of a scene.
fn summary(name: &str, scene: &str, output: &[&str]) -> Value {
    whole_summary(name, scene, output)["figures"].clone()
}

/// Returns the summary of a scene.
fn whole_summary(name: &str, scene: &str, output: &[&str]) -> Value {
    let folder = tempfile::tempdir().expect("a folder");
    std::fs::write(folder.path().join("scene.toml"), scene).expect("a folder to write to");
    let arguments = [&["run", "--json", "scene.toml"], output].concat();
    let run = binary::barwave(folder.path(), &arguments);
    assert_eq!(run.status.code(), Some(0), "{name}: {}\n{scene}", String::from_utf8_lossy(&run.stderr));
    let summary: Value = serde_json::from_slice(&run.stdout).expect("JSON");
    if !output.is_empty() {
        assert_file(folder.path().join("out.h5").as_path(), &summary["figures"]);
    }
    summary
}

/// Opens the result file; `tests/python` checks that it contains every number of the summary.
fn assert_file(path: &std::path::Path, figures: &Value) {
    ResultFile::open(path).expect("a result");
    assert!(figures.is_object());
}

fn scene((_, solve, effects): Method, bar: &str, [left, right]: [&str; 2], until: f64) -> String {
    let solve = solve.replace(", ", "\n");
    format!(
        "{bar}\n[left]\n{left}\n[right]\n{right}\n[effects]\n{effects}\n[solve]\nuntil = {until:e}\n{solve}\n[record]\nframes = 3\n\
         gauges = {{ middle = {} }}\n",
        0.5 * LENGTH
    )
}

fn uniform(velocity: f64) -> String {
    format!("[bar]\nlength = {LENGTH}\narea = {AREA:e}\nmaterial = {BILINEAR}\nvelocity = {velocity}")
}

#[track_caller]
fn assert_near(what: &str, found: &Value, expected: f64, tolerance: f64) {
    let found = found.as_f64().unwrap_or_else(|| panic!("{what}: {found}"));
    assert!((found - expected).abs() <= tolerance, "{what}: {found:e}, expected {expected:e}");
}

const FREE: &str = "kind = \"free\"";
const WALL: &str = "kind = \"wall\"";

/// Rounding of sums over some hundred steps.
const ROUNDING: f64 = 1e-9;

/// Two bodies separate at once. The grid rounds lengths to whole steps of transit time, here by up to 0.3 %: the mass that this adds to a body must
/// be included in its momentum, as it would otherwise appear as an impulse of the joint.
#[test]
fn a_joint_that_carries_no_force_has_no_impulse() {
    let segment = |length: f64, material: &str, more: &str| {
        format!("[[bar.segment]]\nlength = {length}\narea = 8e-4\nmaterial = \"{material}\"\n{more}\n")
    };
    let bar = segment(0.605, "copper-annealed", "velocity = -8.1\njoint = \"contact\"")
        + &segment(0.857, "mild-steel", "velocity = 2");
    for solve in
        ["method = \"fd\"\ncells = 100", "method = \"fd\"\nscheme = \"muscl\"\ncells = 100", "method = \"moc\""]
    {
        let ends = "[left]\nkind = \"free\"\n[right]\nkind = \"free\"\n";
        let text = format!("{bar}{ends}[effects]\nhardening = \"isotropic\"\n[solve]\nuntil = 3e-4\n{solve}\n");
        let figures = summary(solve, &text, &[]);
        assert_eq!(figures["joints"]["1"]["impulse_N_s"], 0.0, "{solve}: {figures}");
    }
}

/// A striker bar separates from a longer one after 2 L/c0 = 200 us, with e = L/(1 m). Later waves are reflected by the open faces every 200 us. A
/// front that starts there at the very end time must not hide that the joint has released, and it has no measured speed yet.
#[test]
fn a_wave_at_an_open_joint_at_the_end_time_leaves_the_joint_released() {
    let material = "{ density = 8000, modulus = 2e11, beyond = \"extend\", curve = { table = [[0.1, 2e10]] } }";
    let segment = |length: f64, more: &str| {
        format!("[[bar.segment]]\nlength = {length}\narea = {AREA:e}\nmaterial = {material}\n{more}\n")
    };
    let bar = segment(0.5, "velocity = 10\njoint = \"contact\"") + &segment(1.0, "");
    for until in ["400 us", "600 us", "700 us", "800 us", "1000 us", "1200 us"] {
        let solve = format!("[solve]\nuntil = \"{until}\"\nmethod = \"moc\"\n");
        let ends = format!("[left]\n{FREE}\n[right]\n{FREE}\n");
        let whole = whole_summary(until, &(bar.clone() + &ends + &solve), &[]);
        let joint = &whole["figures"]["joints"]["1"];
        assert_near(until, &joint["time_of_release_s"], 2e-4, 1e-12);
        assert_near(until, &joint["contact_duration_s"], 2e-4, 1e-12);
        assert_near(until, &joint["restitution"], 0.5, ROUNDING);
        assert_near(until, &joint["left_velocity_after_m_s"], 0.0, ROUNDING);
        assert_near(until, &joint["right_velocity_after_m_s"], 5.0, ROUNDING);
        for front in whole["fronts"].as_array().expect("fronts") {
            let speed = front["speed_m_s"].as_f64().expect("a speed");
            let same = |measured: f64| (measured / speed - 1.0).abs() < 1e-6;
            assert!(front["speed_measured_m_s"].as_f64().is_none_or(same), "{until}: {front}");
        }
    }
}

/// Every method gives the stress on the section to the left of a joint, also behind a taper, whose pieces have other sections.
#[test]
fn joints_in_torsion_show_the_stress_to_their_left_by_every_method() {
    let steel =
        "{ density = 7800, modulus = \"80 GPa\", loading = \"shear\", curve = { table = [[0.01, \"800 MPa\"]] } }";
    let tube = |inside: &str| {
        format!("[[bar.segment]]\nlength = 0.2\ndiameter = 0.02\ninner-diameter = {inside}\nmaterial = {steel}\n")
    };
    let bar = format!("[bar]\nmode = \"torsion\"\n{}{}", tube("0.016"), tube("0.01"));
    let scene = format!(
        "{bar}[left]\nkind = \"velocity\"\nvalue = \"100 rad/s\"\n[right]\nkind = \"absorbing\"\n[solve]\nuntil = \"100 us\"\n"
    );
    // Moments of area of the left and the right tube: the joint transmits 2 J_r/(J_l + J_r) of the incident stress.
    let [left, right] = [0.016_f64, 0.01].map(|inside| 0.02_f64.powi(4) - inside.powi(4));
    let incoming = -7800.0 * (80e9_f64 / 7800.0).sqrt() * 100.0 * 0.01;
    for solve in ["cells = 200", "cells = 200\nscheme = \"muscl\"", "method = \"moc\""] {
        let figures = summary("torsion", &format!("{scene}{solve}\n"), &[]);
        let peak = figures["joints"]["1"]["peak_stress_Pa"].as_f64().expect("a stress");
        assert!((peak / (incoming * 2.0 * right / (left + right)) - 1.0).abs() < 1e-6, "{solve}: {peak:e}");
    }
}

/// The net cuts a taper into pieces. A joint behind a taper keeps its own number, not that among the pieces, also in the note on separation; its
/// stress is not that in the last piece.
#[test]
fn joints_behind_a_taper_keep_their_number_on_a_net() {
    let segment = |area: &str, more: &str| {
        format!("[[bar.segment]]\nlength = 0.1\narea = {area}\nmaterial = {BILINEAR}\n{more}\n")
    };
    let bar = segment("[[0, 1e-4], [0.1, 2e-4]]", "joint = \"contact\"") + &segment("1e-4", "velocity = 2");
    let ends = "[left]\nkind = \"stress\"\nvalue = -1e8\n[right]\nkind = \"free\"\n";
    let effects = "[effects]\nrate = { model = \"cowper-symonds\", D = 40, q = 5 }\n";
    let text = format!("{bar}{ends}{effects}[solve]\nuntil = 4e-5\nmethod = \"moc\"\ncells = 40\n");
    let whole = whole_summary("taper", &text, &[]);
    let joint = &whole["figures"]["joints"]["1"];
    assert_eq!([&joint["peak_force_N"], &joint["contact_duration_s"]], [0.0, 0.0], "{joint}");
    let notes = whole["notes"].to_string();
    assert!(notes.contains("move apart at joint 1 "), "{notes}");
}

/// A cone whose velocity increases along it has the momentum of its mass distribution: the plain mean of the velocity would give an impulse 48 % too
/// large, and a restitution of 0.40 instead of 0.58.
#[test]
fn a_cone_that_moves_unevenly_has_the_momentum_of_its_mass() {
    let cone = format!(
        "[[bar.segment]]\nlength = 0.2\ndiameter = [[0, 0.03], [0.2, 0.01]]\nmaterial = {BILINEAR}\nvelocity = [[0, 0], [0.2, 6]]\njoint = \"contact\"\n"
    );
    let rod = format!("[[bar.segment]]\nlength = 0.3\ndiameter = 0.02\nmaterial = {BILINEAR}\n");
    let ends = "[left]\nkind = \"free\"\n[right]\nkind = \"free\"\n[effects]\nhardening = \"isotropic\"\n";
    let text = format!("{cone}{rod}{ends}[solve]\nuntil = \"400 us\"\n");
    let mass = 7800.0 * std::f64::consts::PI * 0.01 * 0.01 * 0.3;
    for solve in ["method = \"fd\"\n", "method = \"moc\"\n"] {
        let joint = summary(solve, &(text.clone() + solve), &[])["joints"]["1"].clone();
        let after = joint["right_velocity_after_m_s"].as_f64().expect("it flies off");
        assert_near(solve, &joint["impulse_N_s"], mass * after, 0.002);
        assert_near(solve, &joint["restitution"], 0.579, 0.003);
    }
}

/// A ball on a lever has its own velocity, not that of the surface (a fifth of it), and a torque.
#[test]
fn a_ball_on_a_lever_has_its_own_velocity() {
    let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("runs/ball-on-lever.toml");
    let scene = std::fs::read_to_string(path).expect("a scene");
    let end = summary("lever", &scene.replace("until = \"300 us\"", "until = \"1 ms\""), &[])["left"].clone();
    assert_near("velocity", &end["striker_velocity_after_m_s"], 0.02334, 2e-4);
    assert_near("torque", &end["peak_torque_N_m"], -3.219, 0.01);
}

/// A contact of 2.6 time steps, whose force is 44 % too small, is noted.
#[test]
fn a_contact_of_a_few_steps_is_noted() {
    let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("runs/ball-on-bar.toml");
    let scene = std::fs::read_to_string(path).expect("a scene");
    let notes = |scene: &str| whole_summary("ball", scene, &[])["notes"].to_string();
    assert!(!notes(&scene).contains("time steps"));
    let small = scene.replace("diameter = \"10 mm\"", "diameter = \"0.1 mm\"");
    assert!(notes(&small).contains("or 2.6 time steps: its peak force can be in error"), "{}", notes(&small));
}

/// A striker of 3 g, whose pulse decays within 0.75 cells of 4 g: the absorbed energy is 72 % too small by leapfrog.
#[test]
fn a_striker_whose_pulse_is_shorter_than_the_grid_resolves_is_noted() {
    let notes = |velocity: f64, solve: &str| {
        let scene = format!(
            "[bar]\nlength = 1\narea = 1e-4\nmaterial = {{ density = 8000, modulus = 2e11, beyond = \"extend\", curve = {{ table = [[0.001, 2e8], [0.501, 1.02e10]] }} }}\n\
             [left]\nkind = \"striker\"\nmass = 0.003\nvelocity = {velocity}\n[right]\nkind = \"free\"\n[effects]\nhardening = \"isotropic\"\n\
             [solve]\nuntil = \"10 us\"\n{solve}\n"
        );
        whole_summary("striker", &scene, &[])["notes"].to_string()
    };
    let coarse = notes(20.0, "cells = 200");
    assert!(coarse.contains("decays within 0.8 cells") && coarse.contains("use at least 5334 cells"), "{coarse}");
    for (velocity, solve) in
        [(20.0, "cells = 5400"), (20.0, "method = \"moc\""), (4.0, "cells = 200"), (-20.0, "cells = 200")]
    {
        let notes = notes(velocity, solve);
        assert!(!notes.contains("light striker"), "{velocity} m/s, {solve}: {notes}");
    }
}

/// An elastic bar of length L leaves a rigid wall after 2 L/c0 with its velocity reversed. Every method is exact at Courant number 1, except for the
/// step in which the contact begins.
#[test]
fn an_elastic_bar_rebounds_from_a_wall() {
    for method in METHODS {
        let name = method.0;
        let figures = summary(name, &scene(method, &uniform(-2.0), [WALL, FREE], 3.5 * transit()), &["-o", "out.h5"]);
        let (left, step) = (&figures["left"], transit() / CELLS);
        assert_near(name, &left["peak_force_N"], -2.0 * impedance(), ROUNDING * impedance());
        assert_near(name, &left["impulse_N_s"], 4.0 * mass(), ROUNDING);
        assert_near(name, &left["contact_duration_s"], 2.0 * transit(), 1.001 * step);
        assert_near(name, &left["time_of_release_s"], 2.0 * transit(), 1.001 * step);
        assert_near(name, &left["time_of_peak_s"], 0.0, 1.001 * step);
        assert_near(name, &left["restitution"], 1.0, ROUNDING);
        assert_near(name, &left["bar_velocity_after_m_s"], 2.0, ROUNDING);
        let gauge = &figures["gauges"]["middle"];
        assert_near(name, &gauge["peak_stress_Pa"], -2.0 * impedance() / AREA, 1.0);
        assert_near(name, &gauge["peak_strain"], -2.0 * impedance() / (AREA * 200e9), 1e-12);
        assert_near(name, &gauge["time_of_peak_stress_s"], 0.5 * transit(), 2.001 * step);
        assert_near(name, &figures["final_length_m"], LENGTH, 1e-15);
        assert_near(name, &figures["residual_strain_largest"], 0.0, 0.0);
        // A free end has no force and no contact.
        assert_near(name, &figures["right"]["peak_force_N"], 0.0, ROUNDING * impedance());
        assert!(figures["right"]["contact_duration_s"].is_null() && figures["right"]["time_of_peak_s"].is_null());
    }
}

/// The mirror image has the same figures at the other end, with velocities and impulses reversed.
#[test]
fn mirror_images_have_the_same_figures() {
    for method in METHODS {
        let run = |velocity, ends| summary(method.0, &scene(method, &uniform(velocity), ends, 12.0 * transit()), &[]);
        let (one, other) = (run(-30.0, [WALL, FREE]), run(30.0, [FREE, WALL]));
        for key in ["peak_force_N", "contact_duration_s", "restitution"] {
            let expected = one["left"][key].as_f64().expect("a number");
            assert_near(method.0, &other["right"][key], expected, 1e-9 * expected.abs());
        }
        for key in ["impulse_N_s", "bar_velocity_after_m_s"] {
            let expected = -one["left"][key].as_f64().expect("a number");
            assert_near(method.0, &other["right"][key], expected, 1e-9 * expected.abs());
        }
    }
}

/// A moving bar with an absorbing end is infinitely long: a striker reaches its velocity, as one comes to rest on a bar at rest.
#[test]
fn a_striker_does_not_rebound_from_a_bar_without_end() {
    let striker = "kind = \"striker\"\nmass = 0.1\nvelocity = 2";
    for velocity in [0.0, 1.0, -2.0] {
        for method in METHODS {
            let text = scene(method, &uniform(velocity), [striker, "kind = \"absorbing\""], 20.0 * transit());
            let left = &summary(method.0, &text, &[])["left"];
            assert_near(method.0, &left["restitution"], 0.0, 1e-6);
            assert_near(method.0, &left["striker_velocity_after_m_s"], velocity, 1e-6);
        }
    }
}

/// The load decreases from the start, but nothing overtakes the elastic front: grids must follow it through the bar, and not only for a few cells, to
/// report its measured speed and arrivals.
#[test]
fn the_elastic_front_of_a_striker_is_followed_through_the_bar() {
    for velocity in [2.0, 15.0] {
        let striker = format!("kind = \"striker\"\nmass = 0.2\nvelocity = {velocity}");
        for method in METHODS {
            let text = scene(method, &uniform(0.0), [&striker, "kind = \"absorbing\""], 0.95 * transit());
            let front = whole_summary(method.0, &text, &[])["fronts"][0].clone();
            println!("{} {velocity}: {front}", method.0);
            assert_near(method.0, &front["speed_measured_m_s"], LENGTH / transit(), 0.01 * LENGTH / transit());
            assert!(front["position_m"].as_f64().is_some_and(|x| x > 0.9 * LENGTH), "{}: {front}", method.0);
        }
    }
}

/// The striker loses its velocity to the bar and remains in contact under a force below a ten-thousandth of the largest one. With the Godunov scheme
/// it then touches in some steps only; the reported contact must still be 0.285 ms as with front tracking, and not a third of that.
#[test]
fn a_light_striker_is_in_contact_as_long_by_every_method() {
    let material =
        "{ density = 6190, modulus = \"120 GPa\", curve = { table = [[1.11e-3, 1.332e8], [2.63e-2, 2.1439e9]] } }";
    let bar = format!("[bar]\nlength = 1.5\narea = 1.43e-3\nmaterial = {material}\nvelocity = 3.36");
    let ends = ["kind = \"striker\"\nmass = 0.354\nvelocity = 36.4", "kind = \"stress\"\nvalue = 211e6"];
    let hardening = "hardening = \"isotropic\"";
    let methods = [("moc", ""), ("fd", "cells = 6400"), ("fd", "cells = 6400\nscheme = \"muscl\"")];
    let durations = methods.map(|(method, solve)| {
        let text = format!(
            "{bar}\n[left]\n{}\n[right]\n{}\n[effects]\n{hardening}\n[solve]\nuntil = 2.85e-4\nmethod = \"{method}\"\n{solve}\n",
            ends[0], ends[1]
        );
        summary("light striker", &text, &[])["left"]["contact_duration_s"].as_f64().expect("it touches")
    });
    assert!(durations[0] < 2.6e-4, "{durations:?}");
    assert!(durations.iter().all(|duration| (duration / durations[0] - 1.0).abs() < 0.04), "{durations:?}");
}

/// Odd-even waves ahead of cells that have flowed must not open the contact in every second step once its force is small. Leapfrog would then have
/// 34.5 to 40.2 us instead of 40.5 us, and 17.8 us instead of 51.7 us in a bar that flows slowly, with a recorded force that alternates with zero.
#[test]
fn a_light_striker_stays_in_contact_on_any_grid() {
    let striker = |velocity: f64| format!("kind = \"striker\"\nmass = 0.02\nvelocity = {velocity}");
    let duration = |material: &str, effects: &str, velocity: f64, solve: &str| {
        let bar = format!("[bar]\nlength = 0.3\narea = 3e-4\nmaterial = {material}");
        let text = format!(
            "{bar}\n[left]\n{}\n[right]\n{FREE}\n[effects]\n{effects}\n[solve]\nuntil = 8e-5\n{solve}\n",
            striker(velocity)
        );
        summary("light striker", &text, &[])["left"]["contact_duration_s"].as_f64().expect("it touches")
    };
    let material = "{ density = 2700, modulus = 1.2e11, beyond = \"extend\", curve = { table = [[4.1666666666666667e-4, 50e6], [0.0804, 146e6]] } }";
    let by = |solve: &str| duration(material, "hardening = \"isotropic\"", 8.0, solve);
    let expected = by("scheme = \"muscl\"");
    for cells in [200, 300, 500, 1000, 2000, 4000] {
        let (found, step) = (by(&format!("cells = {cells}")), 0.3 / f64::from(cells) / 6667.0);
        assert!((found - expected).abs() < 5e-8 + 2.0 * step, "{cells} cells: {found:e} for {expected:e} s");
    }

    let material = "{ density = 7850, modulus = 2e11, beyond = \"extend\", curve = { table = [[0.001, 200e6], [0.08, 400e6]] }, rate = { cowper-symonds = { D = 40.4, q = 5 } } }";
    let by = |solve: &str| duration(material, "hardening = \"isotropic\"\nrate = \"material\"", 20.0, solve);
    let expected = by("");
    for cells in [250, 1000, 4000] {
        let found = by(&format!("method = \"fd\"\ncells = {cells}"));
        assert!((found / expected - 1.0).abs() < 0.01, "with rate, {cells} cells: {found:e} for {expected:e} s");
    }
}

/// A rigid striker of mass m on a free bar of mass M separates when the first wave returns, with the velocity V exp(-2 M/m) (St Venant).
#[test]
fn a_striker_leaves_a_free_bar_when_the_wave_returns() {
    let (m, velocity) = (0.8, 3.0);
    let after = velocity * (-2.0 * mass() / m).exp();
    let bar_after = m * (velocity - after) / mass();
    let striker = format!("kind = \"striker\"\nmass = {m}\nvelocity = {velocity}");
    for method in METHODS {
        let name = method.0;
        let figures = summary(name, &scene(method, &uniform(0.0), [&striker, FREE], 3.2 * transit()), &[]);
        let left = &figures["left"];
        // The mass of half a cell, and one step of the staircase of front tracking.
        let share = 0.01;
        assert_near(name, &left["peak_force_N"], -velocity * impedance(), share * velocity * impedance());
        assert_near(name, &left["contact_duration_s"], 2.0 * transit(), 3.0 * transit() / CELLS);
        assert_near(name, &left["striker_velocity_after_m_s"], after, share * velocity);
        assert_near(name, &left["bar_velocity_after_m_s"], bar_after, share * velocity);
        assert_near(name, &left["restitution"], (bar_after - after) / velocity, share);
        // What one body loses the other one gains, at any resolution.
        let (given, kept) = (&left["impulse_N_s"], left["striker_velocity_after_m_s"].as_f64().expect("a number"));
        assert_near(name, given, m * (velocity - kept), 1e-6);
        assert_near(name, &left["bar_velocity_after_m_s"], given.as_f64().expect("a number") / mass(), 1e-6);
    }
}

/// Two equal elastic bars exchange their velocities in 2 L/c0. The joint in the second one transmits the first wave.
#[test]
fn equal_bars_exchange_their_velocities() {
    let piece = |length: f64, velocity: f64, joint: &str| {
        format!(
            "[[bar.segment]]\nlength = {length}\narea = {AREA:e}\nmaterial = {BILINEAR}\nvelocity = {velocity}\n{joint}\n"
        )
    };
    let half = 0.5 * LENGTH;
    let bar =
        [piece(half, 2.0, "joint = \"contact\""), piece(0.5 * half, 0.0, ""), piece(0.5 * half, 0.0, "")].concat();
    for method in METHODS {
        let name = method.0;
        let figures = summary(name, &scene(method, &bar, [FREE, FREE], 1.5 * transit()), &[]);
        let (joint, bonded, step) = (&figures["joints"]["1"], &figures["joints"]["2"], transit() / CELLS);
        assert_near(name, &joint["peak_force_N"], -impedance(), ROUNDING * impedance());
        assert_near(name, &joint["impulse_N_s"], mass(), ROUNDING);
        assert_near(name, &joint["contact_duration_s"], transit(), 1.001 * step);
        assert_near(name, &joint["restitution"], 1.0, ROUNDING);
        assert_near(name, &joint["left_velocity_after_m_s"], 0.0, ROUNDING);
        assert_near(name, &joint["right_velocity_after_m_s"], 2.0, ROUNDING);
        assert_near(name, &bonded["peak_force_N"], -impedance(), ROUNDING * impedance());
        assert_near(name, &bonded["time_of_peak_s"], 0.25 * transit(), 2.001 * step);
        assert!(bonded["contact_duration_s"].is_null() && bonded["restitution"].is_null());
        // The length is reported only for a single piece of matter.
        assert!(figures["final_length_m"].is_null());
        assert_near(name, &figures["segments"]["1"]["final_length_m"], half, 1e-15);
    }
}

/// The kinetic energy that two cells lose where a gap closes within a step is not absorbed by the bar, with the Godunov scheme and the net, too.
#[test]
fn elastic_bars_that_meet_absorb_nothing() {
    let piece = |velocity: f64, joint: &str| {
        let length = 0.5 * LENGTH;
        format!(
            "[[bar.segment]]\nlength = {length}\narea = {AREA:e}\nmaterial = {BILINEAR}\nvelocity = {velocity}\n{joint}\n"
        )
    };
    let bar = [piece(2.0, "joint = \"contact\"\ngap = 1.07e-6"), piece(0.0, "")].concat();
    for method in METHODS {
        let figures = summary(method.0, &scene(method, &bar, [FREE, FREE], 1.5 * transit()), &[]);
        assert!(figures["joints"]["1"]["peak_force_N"].as_f64().is_some_and(|force| force < 0.0), "{}", method.0);
        assert_near(method.0, &figures["energy_absorbed_J"], 0.0, ROUNDING);
    }
}

/// Units of the exact cases: the yield stress, the yield velocity, and the transit time.
struct Units {
    stress: f64,
    velocity: f64,
    strain: f64,
}

const UNITS: Units = Units { stress: 200e6, velocity: 200e6 / 39_496_835.316_263, strain: 1e-3 };

/// Bars of a bilinear metal with tangent modulus r^2 E that strike a wall: times, forces, momentum and plastic strains as rational numbers.
#[test]
fn plastic_rebound_agrees_with_the_exact_cases() {
    let walls: Vec<&Case> = cases().iter().filter(|case| case.name.starts_with("wall") && case.iso).collect();
    assert!(walls.len() > 3);
    for case in walls {
        let r = number(&case.r);
        let material = format!(
            "{{ name = \"bilinear\", density = 7800, modulus = 200e9, beyond = \"extend\", curve = {{ table = [[0.001, 200e6], [0.021, {}]] }} }}",
            200e6 + 0.02 * r * r * 200e9
        );
        let velocity = number(&case.velocity) * UNITS.velocity;
        let bar = format!("[bar]\nlength = {LENGTH}\narea = {AREA:e}\nmaterial = {material}\nvelocity = {velocity}");
        let force = case.left_history.iter().map(|row| numbers(row)[1]).fold(0.0, f64::min) * UNITS.stress * AREA;
        let profile: Vec<[f64; 3]> = case.ep_profile.iter().map(numbers).collect();
        let elongation: f64 = profile.iter().map(|[from, to, strain]| (to - from) * strain).sum();
        let largest = profile.iter().map(|row| row[2]).fold(0.0, f64::min);
        let impulse = (number(&case.momentum) - number(&case.velocity)) * UNITS.velocity * mass();
        let rebound = number(&case.momentum) / -number(&case.velocity);
        for method in &METHODS[..3] {
            // First-order errors of some cells at the fronts; front tracking is exact.
            let exact = method.0 == "front tracking";
            let share = if exact { 1e-9 } else { 0.03 };
            // The first cells of a suddenly loaded end retain up to 12 % too much strain, and its first steps have up to 4 % too much stress.
            let first_cells = if exact { 1e-9 } else { 0.15 };
            let what = format!("{} {}", method.0, case.name);
            let until = number(&case.t_final) * transit();
            let scene = scene(*method, &bar, [WALL, FREE], until).replace("cells = 100", "cells = 400");
            let figures = summary(&what, &scene, &[]);
            let left = &figures["left"];
            assert_near(&what, &left["peak_force_N"], force, if exact { 1e-9 } else { 0.05 } * force.abs());
            assert_near(&what, &left["impulse_N_s"], impulse, share * impulse);
            assert_near(&what, &left["restitution"], rebound, share);
            assert_near(
                &what,
                &figures["permanent_elongation_m"],
                elongation * UNITS.strain * LENGTH,
                share * 1e-3 * LENGTH,
            );
            // The profile contains the whole elongation, most of it at the struck end.
            let profile = figures["residual_strain_profile"].as_array().expect("a list");
            let profile: Vec<f64> = profile.iter().map(|mean| mean.as_f64().expect("a number")).collect();
            let mean = profile.iter().sum::<f64>() / 10.0;
            let whole = figures["permanent_elongation_m"].as_f64().expect("a number") / LENGTH;
            assert!(
                profile.len() == 10 && (mean - whole).abs() < 1e-9 + 1e-6 * whole.abs(),
                "{what}: {profile:?} {whole}"
            );
            let strain = &figures["residual_strain_largest"];
            assert_near(&what, strain, largest * UNITS.strain, first_cells * largest.abs() * UNITS.strain);
            assert_near(&what, &figures["largest_plastic_strain"], -strain.as_f64().expect("a number"), share * 1e-3);
        }
    }
}

/// Without an area, figures are per area; in torsion there are no forces and lengths.
#[test]
fn figures_follow_what_the_scene_has() {
    let bar = uniform(-2.0).replace(&format!("area = {AREA:e}\n"), "");
    let figures = summary("no area", &scene(METHODS[0], &bar, [WALL, FREE], 3.5 * transit()), &[]);
    let left = &figures["left"];
    assert!(left["peak_force_N"].is_null() && left["impulse_N_s"].is_null() && figures["energy_absorbed_J"].is_null());
    assert_near("stress", &left["peak_stress_Pa"], -2.0 * impedance() / AREA, 1.0);
    assert_near("impulse", &left["impulse_per_area_Pa_s"], 4.0 * mass() / AREA, 1e-5);
    assert_near("restitution", &left["restitution"], 1.0, ROUNDING);
}

/// Ends without separation have no contact, and a clamped end has no rebound velocity.
#[test]
fn figures_that_do_not_exist_are_absent() {
    let scene =
        scene(METHODS[0], &uniform(0.0), ["kind = \"velocity\"\nvalue = -1", "kind = \"fixed\""], 2.2 * transit());
    let figures = summary("held", &scene, &[]);
    for side in ["left", "right"] {
        for key in ["contact_duration_s", "time_of_release_s", "restitution", "bar_velocity_after_m_s"] {
            assert!(figures[side][key].is_null(), "{side} {key}");
        }
        assert!(figures[side]["peak_force_N"].as_f64() > Some(0.0));
    }
    // Still in contact at the end of the run.
    let pressed = summary("pressed", &self::scene(METHODS[0], &uniform(-2.0), [WALL, FREE], transit()), &[]);
    assert!(pressed["left"]["time_of_release_s"].is_null() && pressed["left"]["bar_velocity_after_m_s"].is_null());
    assert_near("pressed", &pressed["left"]["contact_duration_s"], transit(), 0.02 * transit());
}

/// The load of a joint that breaks is the force that breaks it, 6 kN, and not the stress in the cell beside it after the fracture (20.9 kN without
/// any contact). Front tracking must report it, too, although the front that breaks the joint leaves free faces behind.
#[test]
fn the_load_of_a_joint_that_breaks_is_what_breaks_it() {
    let rod = |area: &str| format!("[[bar.segment]]\nlength = {LENGTH}\narea = {area}\nmaterial = {BILINEAR}\n");
    let scene = |right: &str, first: &str, method: &str| {
        format!(
            "{}joint-stress-concentration = 20\n{}[left]\nkind = \"stress\"\n\
             history = [{first}, [30e-6, 60e6], [35e-6, 0], [200e-6, 0], [204e-6, -380e6], [208e-6, 0]]\n\
             [right]\nkind = \"free\"\n[effects]\nhardening = \"isotropic\"\nrupture = {{ spall = \"1 GPa\" }}\n\
             [solve]\nuntil = 4.05e-4\nmethod = {method}\n",
            rod("1e-4"),
            rod(right)
        )
    };
    let ramp = "[0, 0], [5e-6, 60e6]";
    let sudden = "[0, 60e6]";
    // Two thirds of the stress are transmitted into twice the area: 4/3 of the force.
    for (right, first, method, force) in [
        ("1e-4", ramp, "\"fd\"\ncells = 100", 6000.0),
        ("1e-4", sudden, "\"moc\"", 6000.0),
        ("2e-4", sudden, "\"moc\"", 8000.0),
    ] {
        let figures = summary("a joint that breaks", &scene(right, first, method), &[]);
        assert_near(method, &figures["joints"]["1"]["peak_force_N"], force, 1e-6 * force);
    }
}

/// A shock that crushes a foam dissipates the area between the chord and the curve, two fifths of all energy absorbed here. On a grid it is
/// dissipated by the scheme in the cells of the shock, and must be included.
#[test]
fn the_energy_of_a_crushed_foam_is_that_of_its_chord() {
    const STRESS: f64 = 3e6;
    const DENSITY: f64 = 200.0;
    const UNTIL: f64 = 5e-4;
    let foam = "{ name = \"foam\", density = 200, modulus = \"100 MPa\", beyond = \"extend\", curve = { table = \
                [[0, 0], [0.01, \"1 MPa\"], [0.6, \"1.2 MPa\"], [0.7, \"5 MPa\"]] } }";
    let bar = format!("[bar]\nlength = 0.4\narea = {AREA:e}\nmaterial = {foam}");
    // From the end of the elastic line at the plateau to the locked state.
    let [yields, locked] = [[0.01, 1e6], [0.6 + 0.1 * (STRESS - 1.2e6) / 3.8e6, STRESS]];
    let speed = ((locked[1] - yields[1]) / (DENSITY * (locked[0] - yields[0]))).sqrt();
    let work = 0.5 * (yields[1] + locked[1]) * (locked[0] - yields[0]) + 0.5 * yields[0] * yields[1];
    let expected = AREA * speed * UNTIL * (work - 0.5 * STRESS * STRESS / 100e6);
    let methods = [
        ("cells = 200", 0.05),
        ("cells = 1000", 0.005),
        ("scheme = \"muscl\"\ncells = 1000", 0.01),
        ("method = \"moc\"", 1e-9),
    ];
    for (method, near) in methods {
        let scene = format!(
            "{bar}\n[left]\nkind = \"stress\"\nvalue = {:e}\n[right]\nkind = \"free\"\n[effects]\nhardening = \"isotropic\"\n\
             [solve]\nuntil = {UNTIL}\n{method}\n",
            -STRESS
        );
        let figures = summary("foam", &scene, &[]);
        assert_near(method, &figures["energy_absorbed_J"], expected, near * expected);
    }
}
