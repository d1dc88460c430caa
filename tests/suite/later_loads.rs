//! Ends and joints that are suddenly loaded after t = 0 by gaps that close and waves that arrive, or from an initial state: both schemes on a grid
//! against front tracking.

use serde_json::Value;

use barwave::record::Trace;
use barwave::record::store::{ResultFile, Side};

use crate::common::binary;

const COPPER: &str = "{ density = 8900, modulus = 115e9, beyond = \"extend\", curve = { table = [[0.0005, 57.5e6], [0.002, 90e6], [0.01, 130e6], [0.05, 200e6], [0.3, 330e6]] } }";
const BILINEAR: &str =
    "{ density = 7800, modulus = 200e9, beyond = \"extend\", curve = { table = [[0.001, 200e6], [0.021, 600e6]] } }";
const ELASTIC: &str = "{ density = 7800, modulus = 200e9, beyond = \"extend\", curve = { table = [[0.1, 20e9]] } }";
const ALUMINIUM: &str = "{ density = 2700, modulus = 70e9, beyond = \"extend\", curve = { table = [[0.1, 7e9]] } }";
const FREE: &str = "kind = \"free\"";

/// Returns a segment of 1 cm^2: length (m), material, velocity (m/s), and its joint to the next.
fn segment(length: f64, material: &str, velocity: f64, joint: &str) -> String {
    format!("[[bar.segment]]\nlength = {length}\narea = 1e-4\nmaterial = {material}\nvelocity = {velocity}\n{joint}\n")
}

fn gap(metres: f64) -> String {
    format!("joint = \"contact\"\ngap = {metres}")
}

fn velocity(metres_per_second: f64) -> String {
    format!("kind = \"velocity\"\nvalue = {metres_per_second}")
}

/// Segments, ends, and end time.
struct Case {
    bar: String,
    ends: [String; 2],
    until: &'static str,
}

impl Case {
    fn new(bar: String, left: &str, right: &str, until: &'static str) -> Self {
        Self { bar, ends: [left.to_owned(), right.to_owned()], until }
    }

    fn scene(&self, solve: &str) -> String {
        let Self { bar, ends: [left, right], until } = self;
        format!(
            "{bar}[left]\n{left}\n[right]\n{right}\n[effects]\nhardening = \"isotropic\"\n[solve]\nuntil = \"{until}\"\n{solve}\n\
             [record]\nframes = 2\n"
        )
    }

    /// Returns the smallest and the largest stress at a gauge between two times (s), Pa.
    fn gauge_between(&self, place: &str, [after, until]: [f64; 2], solve: &str) -> [f64; 2] {
        let trace = self.trace(place, solve);
        // Front tracking has rows only where the stress changes.
        let [first, end] = [after, until].map(|time| trace.time.partition_point(|row| *row <= time));
        let stresses = || trace.stress[first - 1..end].iter().copied();
        [stresses().fold(f64::INFINITY, f64::min), stresses().fold(f64::NEG_INFINITY, f64::max)]
    }

    /// Returns the stresses at a gauge after this time (s), Pa.
    fn gauge(&self, place: &str, after: f64, solve: &str) -> Vec<f64> {
        let trace = self.trace(place, solve);
        trace.time.iter().zip(trace.stress).filter(|(time, _)| **time > after).map(|(_, stress)| stress).collect()
    }

    /// Returns the history at a gauge.
    fn trace(&self, place: &str, solve: &str) -> Trace {
        let folder = tempfile::tempdir().expect("a folder");
        let scene = format!("{}gauges = {{ here = \"{place}\" }}\n", self.scene(solve));
        std::fs::write(folder.path().join("scene.toml"), &scene).expect("a folder to write to");
        binary::done(folder.path(), &["run", "scene.toml", "-o", "out.h5"]);
        let result = ResultFile::open(&folder.path().join("out.h5")).expect("a result file");
        result.gauges().expect("gauges").remove(0).trace
    }

    /// Returns a number of the summary.
    fn figure(&self, solve: &str, pointer: &str) -> f64 {
        let summary = binary::summary_of(&self.scene(solve));
        summary.pointer(pointer).and_then(Value::as_f64).unwrap_or_else(|| panic!("no {pointer} in {summary}"))
    }

    /// Checks that both schemes agree with front tracking within the relative difference `bound`, on grids with these numbers of cells.
    fn assert_near(&self, name: &str, pointer: &str, cells: &[usize], bound: f64) {
        let exact = self.figure("method = \"moc\"", &format!("/figures/{pointer}"));
        for scheme in ["leapfrog", "muscl"] {
            for cells in cells {
                let solve = format!("method = \"fd\"\nscheme = \"{scheme}\"\ncells = {cells}");
                let error = self.figure(&solve, &format!("/figures/{pointer}")) / exact - 1.0;
                println!("{name}, {pointer}, {scheme}, {cells} cells: {error:.5}");
                assert!(error.abs() < bound, "{name}, {pointer}, {scheme}, {cells} cells: {error}");
            }
        }
    }
}

/// An initial state that varies along the bar, or a taper, must not disable later fans independent of its position and of the arrival of its first
/// wave. Otherwise, forces are 6 to 8 % and strains 8 to 16 % too large.
#[test]
fn loads_start_with_the_fan_until_a_change_of_the_bar_is_felt() {
    let wall = "kind = \"wall\"\ngap = 3e-4";
    let bar = |state: &str| segment(0.5, BILINEAR, 0.0, "").replace("velocity = 0", state);
    let strained = "plastic-strain = [[0, 0.002], [0.1, 0], [0.5, 0]]";
    let far =
        segment(0.3, BILINEAR, 0.0, "").replace("velocity = 0", "velocity = [[0, 0], [0.2, 0], [0.2, 2], [0.3, 2]]");
    let jumps = "kind = \"velocity\"\nhistory = [[0, 0], [5e-6, 0], [5e-6, -15]]";
    for (name, bar, [left, right], place) in [
        ("gap", bar("velocity = [[0, 18], [0.25, 18], [0.25, 20], [0.5, 20]]"), [FREE, wall], "right"),
        ("jump", bar(strained), ["kind = \"fixed\"", jumps], "right"),
        ("other segment", segment(0.3, BILINEAR, 0.0, "") + &far, [&jumps.replace("-15", "15"), FREE], "left"),
    ] {
        let case = Case::new(bar, left, right, "40 us");
        case.assert_near(name, &format!("{place}/peak_force_N"), &[400, 1000], 0.005);
        case.assert_near(name, "largest_plastic_strain", &[400, 1000], 0.01);
    }
}

/// Plastic waves between a striker and a gap must not exhaust the search for the fan of the other end, which they do not reach. Otherwise, the strain
/// there is 16 and 10 % too large.
#[test]
fn a_far_striker_does_not_use_up_the_search() {
    let aluminium =
        "{ density = 2700, modulus = 70e9, beyond = \"extend\", curve = { table = [[0.002, 140e6], [0.052, 300e6]] } }";
    let bar = segment(0.139, BILINEAR, 0.0, "stress = 40e6\njoint = \"bonded\"").replace("1e-4", "6e-4")
        + &segment(0.117, aluminium, -17.9, "plastic-strain = 0.003\njoint = \"contact\"").replace("1e-4", "6.6e-4")
        + &segment(0.102, aluminium, 0.0, "").replace("1e-4", "1.9e-4");
    let case = Case::new(bar, "kind = \"fixed\"", "kind = \"striker\"\nmass = 0.5\nvelocity = -13.5", "60 us");
    case.assert_near("fixed end", "segments/1/largest_plastic_strain", &[400, 1000], 0.01);
}

/// The fan of the driven end must end where waves from the gap meet it; otherwise, the impulse is 39 % too large. The step in which the gap closes
/// must not be the elastic impact of single cells; otherwise, the force there is up to 120 % too large.
#[test]
fn a_gap_closes_while_the_other_end_is_driven() {
    let bar = segment(0.13, COPPER, 0.0, &gap(1e-4)) + &segment(0.3, ELASTIC, -40.0, "");
    let case = Case::new(bar, &velocity(30.0), FREE, "60 us");
    case.assert_near("driven and struck", "left/impulse_N_s", &[400, 1000], 0.005);
    case.assert_near("driven and struck", "joints/1/peak_force_N", &[400, 1000], 0.002);
    case.assert_near("driven and struck", "residual_strain_largest", &[400, 1000], 0.02);
}

#[test]
fn two_gaps_close_one_after_the_other() {
    let bar = segment(0.1, ELASTIC, 40.0, &gap(1e-4))
        + &segment(0.1, COPPER, 0.0, &gap(2e-4))
        + &segment(0.1, ELASTIC, -40.0, "");
    let case = Case::new(bar, FREE, FREE, "30 us");
    for joint in ["joints/1/peak_force_N", "joints/2/peak_force_N"] {
        case.assert_near("two gaps", joint, &[500, 1000, 2000], 0.002);
    }
}

/// A wave arrives at a free face, which then moves until it meets the next bar. The force of the cells beside the open gap is not one between the
/// faces, and the step of closure is not an elastic impact; otherwise, the peak is 10 % too large with leapfrog and 1 % with the Godunov scheme (100
/// and 10 % for steel on copper).
#[test]
fn a_gap_closes_that_waves_have_come_to() {
    let bar = segment(0.1, ELASTIC, 40.0, "joint = \"contact\"")
        + &segment(0.1, ELASTIC, 0.0, &gap(5e-5))
        + &segment(0.1, BILINEAR, 0.0, "");
    let case = Case::new(bar, FREE, FREE, "50 us");
    case.assert_near("passed on", "joints/2/peak_force_N", &[300, 1200], 0.001);
    case.assert_near("passed on", "joints/2/impulse_N_s", &[300, 1200], 0.01);
    case.assert_near("passed on", "residual_strain_largest", &[300, 1200], 0.015);
}

#[test]
fn an_open_gap_has_no_force() {
    let bar = segment(0.1, ELASTIC, 40.0, "joint = \"contact\"")
        + &segment(0.1, ELASTIC, 0.0, &gap(0.01))
        + &segment(0.1, BILINEAR, 0.0, "");
    let case = Case::new(bar, FREE, FREE, "70 us");
    for scheme in ["leapfrog", "muscl"] {
        let force = case.figure(&format!("scheme = \"{scheme}\"\ncells = 300"), "/figures/joints/2/peak_force_N");
        assert!(force == 0.0, "{scheme}: {force}");
    }
}

/// The wave that a spring reflects is elastic, thus faster than the plastic one of a wall, and meets the plastic front of the driven end sooner.
/// Imposing it beyond that makes the impulse 4 % too small with leapfrog, and the largest force 6 % too large with the Godunov scheme.
#[test]
fn the_wave_of_a_spring_ends_where_a_plastic_front_meets_it() {
    for stiffness in [5e8, 3.33e8, 2.22e8] {
        let steel = "{ density = 7800, modulus = 200e9, beyond = \"extend\", curve = { table = [[0.001, 200e6], [0.051, 3200e6]] } }";
        let spring = format!("kind = \"spring\"\nstiffness = {stiffness:e}");
        let case = Case::new(segment(1.0, steel, 0.0, ""), &velocity(20.0), &spring, "500 us");
        case.assert_near("spring", "right/impulse_N_s", &[1000], 0.001);
        case.assert_near("spring", "right/peak_force_N", &[1000], 0.001);
        case.assert_near("spring", "residual_strain_largest", &[1000], 0.001);
    }
}

/// Under 1 GPa, annealed copper carries its largest stress, not 1 GPa, which would give the end of leapfrog four times the impulse of front tracking.
#[test]
fn a_stress_above_the_curve_gives_the_impulse_of_its_largest_stress() {
    let curve =
        "beyond = \"rupture\", curve = { table = [[0.0005, 57.5e6], [0.01, 130e6], [0.05, 200e6], [0.3, 230e6]] }";
    let bar = segment(0.5, &format!("{{ density = 8900, modulus = 115e9, {curve} }}"), 0.0, "");
    let left = "kind = \"stress\"\nhistory = [[0, 1e9], [\"50 us\", 1e9], [\"50 us\", 0]]";
    Case::new(bar, left, FREE, "100 us").assert_near("above the curve", "left/impulse_N_s", &[250, 1000], 0.001);
}

/// The node between two blocks must not be set by the fans of both ends of its segment.
#[test]
fn two_fans_in_one_segment_leave_each_other_alone() {
    let bar = segment(0.06, ELASTIC, 40.0, "joint = \"contact\"") + &segment(0.13, COPPER, 0.0, "");
    let case = Case::new(bar, FREE, &velocity(-30.0), "17 us");
    case.assert_near("struck and driven", "right/impulse_N_s", &[500, 1000], 0.005);
}

/// A scheme in which an arriving wave starts from rest overshoots. Without the fan, the first cells retain 14 to 16 % too much strain with leapfrog,
/// 5 to 10 % with the Godunov scheme, and the force is 2 to 4 % too large, at any resolution.
#[test]
fn a_wave_that_arrives_starts_the_fan_of_the_curve() {
    let fixed = "kind = \"fixed\"";
    let far_end =
        |material: &str, speed: f64| Case::new(segment(0.2, material, 0.0, ""), &velocity(speed), fixed, "60 us");
    for (name, case) in [("bilinear", far_end(BILINEAR, 12.0)), ("mild steel", far_end("\"mild-steel\"", 15.0))] {
        case.assert_near(name, "right/peak_force_N", &[200, 1000], 2e-4);
    }
    for (name, joint) in [("bonded", ""), ("in contact", "joint = \"contact\"")] {
        let bar = segment(0.2, ELASTIC, 0.0, joint) + &segment(0.2, BILINEAR, 0.0, "");
        let case = Case::new(bar, &velocity(12.0), FREE, "60 us");
        case.assert_near(name, "residual_strain_largest", &[200, 1000], 0.008);
    }
}

/// The force of a bonded joint is that between both sides, not that in the cell to its left, which has the incident wave (twice the force for these
/// sections).
#[test]
fn the_force_of_a_bonded_joint_is_that_between_both_sides() {
    let thick = segment(0.2, ELASTIC, 0.0, "").replace("area = 1e-4", "area = 3e-4");
    let case = Case::new(thick + &segment(0.4, ELASTIC, 0.0, ""), &velocity(1.0), FREE, "80 us");
    case.assert_near("3 : 1", "joints/1/peak_force_N", &[300, 1500], 1e-9);
}

/// Waves after the first one start fans, too, also where other waves meet them within 24 cells. Otherwise, forces at the end and at the joint are up
/// to 25 % too large with leapfrog, 8 % with the Godunov scheme, and 27 % with 300 cells.
#[test]
fn every_wave_that_arrives_starts_the_fan_of_the_curve() {
    let bar = segment(0.1, ALUMINIUM, -40.0, "") + &segment(0.2, BILINEAR, -40.0, "");
    let case = Case::new(bar, "kind = \"wall\"", FREE, "150 us");
    case.assert_near("on a wall", "left/peak_force_N", &[300, 1000], 2e-4);
    case.assert_near("on a wall", "joints/1/peak_force_N", &[300, 1000], 3e-4);
    let fixed = "kind = \"fixed\"";
    let bar = segment(0.3, ALUMINIUM, 0.0, "") + &segment(0.3, BILINEAR, 0.0, "");
    let case = Case::new(bar, &velocity(10.0), fixed, "300 us");
    case.assert_near("to and fro", "left/peak_force_N", &[300, 1000], 2e-4);
    case.assert_near("to and fro", "joints/1/peak_force_N", &[300, 1000], 0.003);
    let bar = segment(0.3, ELASTIC, 0.0, "") + &segment(0.3, COPPER, 0.0, "");
    Case::new(bar, &velocity(8.0), fixed, "300 us").assert_near(
        "met soon",
        "joints/1/peak_force_N",
        &[300, 1000],
        0.001,
    );
}

/// In cells that waves cross in 0.9998 steps, the force of a step must not overshoot by 8 % with leapfrog, or be 8 % too small with the Godunov
/// scheme.
#[test]
fn sharp_waves_in_two_materials_do_not_ring() {
    let bar = segment(0.3, ELASTIC, 0.0, "") + &segment(0.3, ALUMINIUM, 0.0, "");
    let case = Case::new(bar, &velocity(2.0), "kind = \"fixed\"", "300 us");
    for place in ["left", "joints/1", "right"] {
        case.assert_near("welded", &format!("{place}/peak_force_N"), &[300, 500, 1000], 1e-9);
    }
    let bar = segment(0.1, ELASTIC, 10.0, "joint = \"contact\"")
        + &segment(0.137, ALUMINIUM, 0.0, &gap(5e-5))
        + &segment(0.2, COPPER, 0.0, "");
    let case = Case::new(bar, FREE, FREE, "60 us");
    case.assert_near("a gap behind", "joints/2/peak_force_N", &[500, 2000], 0.002);
}

/// Cells stop flowing in whole steps, so that the wave can overshoot by 29 to 56 % with leapfrog, at any resolution. The remaining overshoot is a
/// known error.
#[test]
fn an_unloading_wave_that_has_overtaken_a_plastic_front_overshoots_a_little_by_leapfrog_alone() {
    let drive = format!("{}\nrelease = \"20 us\"", velocity(15.0));
    let case = Case::new(segment(0.4, BILINEAR, 0.0, ""), &drive, FREE, "55 us");
    let exact = case.gauge("0.1 m", 0.0, "method = \"moc\"");
    let (ahead, behind) = (exact.iter().copied().fold(0.0, f64::min), exact[exact.len() - 1]);
    let overshoot = |scheme: &str, cells: usize| {
        let stress = case.gauge("0.1 m", 0.0, &format!("scheme = \"{scheme}\"\ncells = {cells}"));
        let arrived = stress.iter().position(|s| *s < 0.9 * ahead).expect("a wave");
        (stress[arrived..].iter().copied().fold(ahead, f64::max) - behind) / (behind - ahead)
    };
    for cells in [500, 1000, 2000] {
        assert!(overshoot("muscl", cells) < 0.01, "{cells} cells");
        let missed = overshoot("leapfrog", cells);
        assert!(missed > 0.01 && missed < 0.1, "{cells} cells: {missed}");
    }
}

/// The wave that returns to the free end of the struck bar must not be filtered as an oscillation, which causes a spike of 13 to 29 % with leapfrog
/// at any resolution.
#[test]
fn a_sharp_wave_that_returns_from_a_free_end_is_no_oscillation() {
    let bar = segment(0.02, ALUMINIUM, 60.0, "joint = \"contact\"")
        + &segment(0.15, COPPER, 0.0, "")
        + &segment(0.03, ELASTIC, 0.0, "");
    let case = Case::new(bar, FREE, FREE, "56 us");
    // The wave arrives after 53.4 us.
    let range = |solve: &str| {
        let stress = case.gauge("0.1701 m", 53.4e-6, solve);
        [f64::min, f64::max].map(|of| stress.iter().copied().reduce(of).expect("rows"))
    };
    let exact = range("method = \"moc\"");
    for cells in [1000, 2000, 4000] {
        let found = range(&format!("scheme = \"leapfrog\"\ncells = {cells}"));
        let overshoot = (found[1] - exact[1]) / (exact[1] - exact[0]);
        assert!(overshoot.abs() < 0.03, "{cells} cells: {overshoot}");
    }
}

/// Without the fan, the first cells retain 4 to 18 % too much strain, at any resolution.
#[test]
fn a_bar_that_has_flowed_before_starts_with_the_exact_fan() {
    let bar = |material: &str, stress: f64, plastic: f64| {
        segment(0.2, material, 0.0, &format!("stress = {stress}\nplastic-strain = {plastic}"))
    };
    let cases = [
        ("stressed", bar(BILINEAR, -1.5e8, 0.0), velocity(30.0)),
        ("hardened", bar(BILINEAR, 0.0, -0.003), velocity(30.0)),
        ("at its yield stress, bilinear", bar(BILINEAR, -2.5e8, -0.003), velocity(30.0)),
        ("at its yield stress, copper", bar(COPPER, -1e8, -0.005), velocity(30.0)),
        ("under a stress", bar(BILINEAR, -2.5e8, -0.003), "kind = \"stress\"\nvalue = -6e8".to_owned()),
        ("struck", bar(BILINEAR, -2.5e8, -0.003), "kind = \"striker\"\nmass = 1\nvelocity = 30".to_owned()),
    ];
    for (name, bar, left) in cases {
        let case = Case::new(bar, &left, "kind = \"fixed\"", "35 us");
        case.assert_near(name, "residual_strain_largest", &[200, 600], 0.01);
    }
}

/// Without the fan, the force of the joint differs from that of its cells, and its stressed side retains four times its plastic strain.
#[test]
fn a_joint_of_unlike_initial_states_starts_with_the_exact_fans() {
    let hardened = "stress = -8e7\nplastic-strain = -0.01";
    let bar = segment(0.2, BILINEAR, 40.0, "") + &segment(0.2, COPPER, 0.0, hardened);
    let case = Case::new(bar, FREE, "kind = \"fixed\"", "35 us");
    case.assert_near("bonded", "residual_strain_largest", &[400, 1000], 0.01);
    case.assert_near("bonded", "joints/1/peak_force_N", &[400, 1000], 0.002);
}

/// The faces of equal bars come to rest side by side when the wave has returned. Where this is exact except for rounding, they must not remain in
/// contact.
#[test]
fn bars_that_rest_side_by_side_do_not_press_on_each_other() {
    let bar = segment(0.1, ELASTIC, 40.0, "joint = \"contact\"") + &segment(0.2, ELASTIC, 0.0, "");
    let case = Case::new(bar, FREE, FREE, "70 us");
    for pointer in ["joints/1/contact_duration_s", "joints/1/time_of_release_s"] {
        // With leapfrog a force acts over half steps, so that the contact is half a step longer at either end.
        case.assert_near("equal bars", pointer, &[300, 1000], 0.0051);
    }
}

/// Returns the summary of a steel or copper bar of 20 mm diameter with these ends.
fn summary(material: &str, velocity: f64, ends: [&str; 2], until: &str) -> Value {
    let folder = tempfile::tempdir().expect("a folder");
    let [left, right] = ends;
    let scene = format!(
        "[bar]\nlength = 0.5\ndiameter = \"20 mm\"\nmaterial = {material}\nvelocity = {velocity}\n[left]\n{left}\n[right]\n{right}\n\
         [solve]\nuntil = \"{until}\"\ncells = 200\n"
    );
    std::fs::write(folder.path().join("scene.toml"), &scene).expect("a folder to write to");
    let run = binary::barwave(folder.path(), &["run", "--json", "scene.toml"]);
    assert_eq!(run.status.code(), Some(0), "{}\n{scene}", String::from_utf8_lossy(&run.stderr));
    serde_json::from_slice(&run.stdout).expect("JSON")
}

/// A velocity above the critical one after the end of the run, or after the release, must not break the bar at t = 0.
#[test]
fn what_comes_after_the_run_or_the_release_breaks_nothing() {
    let copper = "\"copper-annealed\"";
    let of = |left: &str| summary(copper, 0.0, [left, FREE], "80 us");
    let moved = |more: &str| format!("kind = \"velocity\"\n{more}");
    for harmless in [
        "history = [[0, -20], [\"300 us\", -20], [\"300 us\", -115]]",
        "history = [[0, 0], [1, -2000]]",
        "history = [[0, -20], [\"50 us\", -20], [\"50 us\", -115]]\nrelease = \"40 us\"",
    ] {
        let found = of(&moved(harmless));
        assert_eq!((&found["outcome"], &found["above_critical"]), (&"done".into(), &false.into()), "{harmless}");
    }
    let reached = of(&moved("history = [[0, 0], [\"20 us\", -115]]"));
    assert_eq!((&reached["outcome"], &reached["above_critical"]), (&"rupture".into(), &true.into()));
    assert!(!reached["audit"].to_string().contains("at t = 0"), "{}", reached["audit"]);
}

/// The estimate of lateral inertia includes pulses shorter than the length over which it smooths edges, and bars that move against springs and
/// dashpots.
#[test]
fn lateral_inertia_is_estimated_for_short_pulses_and_for_moving_bars() {
    let steel =
        "{ density = 8000, modulus = 200e9, poisson = 0.3, curve = { table = [[0.002, 400e6], [0.02, 500e6]] } }";
    let estimate = |velocity: f64, ends: [&str; 2]| {
        let found = summary(steel, velocity, ends, "90 us");
        let rows = found["audit"].as_array().expect("an audit").clone();
        let row = rows.iter().find(|row| row["effect"] == "lateral-inertia").expect("an estimate").clone();
        row["estimate"].as_f64().unwrap_or_else(|| panic!("{row}"))
    };
    let pulse = |time: f64| estimate(0.0, [&format!("kind = \"velocity\"\nvalue = 5\nrelease = {time:e}"), FREE]);
    for time in [2e-7, 1e-6, 2e-6] {
        assert!(pulse(time) > 0.5, "{time}: {}", pulse(time));
    }
    let wall = estimate(5.0, [FREE, "kind = \"wall\""]);
    for stop in ["kind = \"spring\"\nstiffness = 1e12", "kind = \"dashpot\"\ncoefficient = 1e9"] {
        let found = estimate(5.0, [FREE, stop]);
        assert!((found / wall - 1.0).abs() < 0.05, "{stop}: {found} {wall}");
    }
}

/// The note must not propose a key that the scene cannot have: lateral inertia excludes contact joints.
#[test]
fn a_remedy_that_the_scene_cannot_have_is_not_offered() {
    let steel =
        "{ density = 8000, modulus = 200e9, poisson = 0.3, curve = { table = [[0.002, 400e6], [0.02, 500e6]] } }";
    let message = |joint: &str| {
        let bar = segment(0.2, steel, 5.0, joint) + &segment(0.3, steel, 0.0, "");
        let found = binary::summary_of(&Case::new(bar, FREE, FREE, "60 us").scene("cells = 200"));
        let rows = found["audit"].as_array().expect("an audit").clone();
        rows.iter().find(|row| row["effect"] == "lateral-inertia").expect("an estimate").to_string()
    };
    assert!(message("").contains("Add `lateral-inertia = true`"), "{}", message(""));
    let with_contact = message("joint = \"contact\"");
    assert!(!with_contact.contains("Add ") && with_contact.contains("together with contact joints"), "{with_contact}");
}

/// A velocity that jumps later starts with its fan, also if the jump is followed by a rise, even one after the end of the run. Otherwise, the force
/// at the end is 5 to 13 % too large, and the strain of the first cells by up to 26 %.
#[test]
fn a_velocity_jumps_later() {
    // A drift is small while the fan is followed, on fine grids only.
    let histories = [
        ("at rest at first", "[0, 0], [1e-5, 0], [1e-5, -20]", "90 us", &[500, 2000][..]),
        ("thrown back", "[0, -15], [3e-5, -15], [3e-5, 20]", "90 us", &[500, 2000]),
        ("faster", "[0, -15], [3e-5, -15], [3e-5, -25]", "90 us", &[500, 2000]),
        ("faster after the run", "[0, -15], [3e-5, -15], [3e-5, -25]", "20 us", &[500, 2000]),
        ("drifting", "[0, -15], [6e-5, -15.5]", "20 us", &[4000]),
    ];
    for (name, history, until, cells) in histories {
        let left = format!("kind = \"velocity\"\nhistory = [{history}]");
        let case = Case::new(segment(0.5, BILINEAR, 0.0, ""), &left, FREE, until);
        case.assert_near(name, "left/peak_force_N", cells, 0.001);
        case.assert_near(name, "residual_strain_largest", cells, 0.025);
    }
}

/// Recorded loads rise within some steps. Without their fan, the first cells overshoot by 15 to 2 % in strain and 6 to 1 % in force with any number
/// of cells, which error figures do not show. With 400 and 1000 cells, the rise takes a tenth of a step to 200 steps.
#[test]
fn loads_that_rise_within_some_steps_start_with_their_fan() {
    let histories = [
        ("at once", BILINEAR, "velocity", "[0, 0], [2e-8, -15]"),
        ("within a step", BILINEAR, "velocity", "[0, 0], [5e-6, 0], [5.02e-6, -15]"),
        ("within 2 to 5", BILINEAR, "velocity", "[0, 0], [5e-7, -15]"),
        ("later", COPPER, "velocity", "[0, 0], [5e-6, 0], [6e-6, -20]"),
        ("stress", BILINEAR, "stress", "[0, 0], [2e-6, 350e6]"),
        ("in rows", COPPER, "stress", "[0, 20e6], [1e-6, 40e6], [1.5e-6, 40e6], [1.5e-6, 60e6], [3e-6, 160e6]"),
        ("loaded before", BILINEAR, "velocity", "[0, -5], [1e-5, -5], [1.3e-5, -20]"),
        ("in 20 us", COPPER, "velocity", "[0, 0], [2e-5, -20]"),
    ];
    for (name, material, kind, history) in histories {
        let end = format!("kind = \"{kind}\"\nhistory = [{history}]");
        let case = Case::new(segment(0.5, material, 0.0, ""), FREE, &end, "40 us");
        case.assert_near(name, "right/peak_force_N", &[400, 1000], 0.001);
        case.assert_near(name, "largest_plastic_strain", &[400, 1000], 0.007);
    }
}

/// Blasts jump or rise within some steps, and decay. Without their fan, the strain of the first cells is 5 to 16 % too large (slow decay) or up to 68
/// % too small (decay within some cells), and the force up to 6 % too large.
#[test]
fn loads_that_decay_start_with_their_fan() {
    let histories = [
        ("slow", BILINEAR, "velocity", "[0, -15], [2.5e-4, 0]", 0.004),
        ("to a half", BILINEAR, "velocity", "[0, -15], [5e-5, -7.5]", 0.008),
        ("in a curve", BILINEAR, "velocity", "[0, -15], [1e-5, -12], [3e-5, -9], [6e-5, -7]", 0.02),
        ("after a rise", COPPER, "velocity", "[0, 0], [1e-6, -20], [2.5e-4, 0]", 0.005),
        ("stress", COPPER, "stress", "[0, 150e6], [2.5e-4, 0]", 0.015),
        ("stress after a rise", BILINEAR, "stress", "[0, 0], [5e-6, 0], [6e-6, 350e6], [5.5e-5, 0]", 0.01),
        ("holds at first", BILINEAR, "stress", "[0, 350e6], [5e-6, 350e6], [1e-4, 0]", 0.006),
        ("twice", COPPER, "velocity", "[0, -1.5], [1e-5, -1], [1e-5, -20], [2.5e-4, 0]", 0.01),
    ];
    for (name, material, kind, history, bound) in histories {
        let end = format!("kind = \"{kind}\"\nhistory = [{history}]");
        let case = Case::new(segment(0.5, material, 0.0, ""), FREE, &end, "60 us");
        case.assert_near(name, "right/peak_force_N", &[400, 1000], 0.012);
        case.assert_near(name, "largest_plastic_strain", &[400, 1000], bound);
        case.assert_near(name, "right/impulse_N_s", &[400, 1000], 0.015);
    }
}

/// Unloading waves are reflected by all fronts that they consume, not by the slowest front alone, which vanishes at once in metals whose curve has
/// many slopes. Otherwise, the error of the force at the end is up to a third of its largest value, and half with the Godunov scheme.
#[test]
fn the_force_of_a_load_that_falls_is_that_of_all_fronts_that_it_uses_up() {
    let triangle = "[0, 0], [5e-5, 8], [1e-4, 0]";
    for (name, history, until, cells, bound) in [
        ("while the fan is followed", "[0, 8], [1e-4, 0]", "36 us", [400, 500], 0.012),
        ("to the end", "[0, 8], [1e-4, 0]", "110 us", [200, 500], 0.06),
        ("triangle", triangle, "65 us", [500, 1000], 0.015),
        ("triangle to the end", triangle, "110 us", [200, 500], 0.06),
    ] {
        let end = format!("kind = \"velocity\"\nhistory = [{history}]");
        let case = Case::new(segment(0.5, "\"copper-annealed\"", 0.0, ""), &end, "kind = \"fixed\"", until);
        let force = |solve: &str| {
            let folder = tempfile::tempdir().expect("a folder");
            std::fs::write(folder.path().join("scene.toml"), case.scene(solve)).expect("a folder to write to");
            binary::done(folder.path(), &["run", "scene.toml", "-o", "out.h5"]);
            let end =
                ResultFile::open(&folder.path().join("out.h5")).and_then(|file| file.end(Side::Left)).expect("an end");
            let at = |time: f64| {
                let next = end.time.partition_point(|&row| row <= time);
                let ([t0, t1], [a, b]) =
                    ([end.time[next - 1], end.time[next]], [end.stress[next - 1], end.stress[next]]);
                a + (b - a) * ((time - t0) / (t1 - t0))
            };
            let last = end.time[end.time.len() - 1];
            (1..100).map(|k| at(last * f64::from(k) / 100.0)).collect::<Vec<f64>>()
        };
        let exact = force("method = \"moc\"");
        let largest = exact.iter().fold(0.0_f64, |most, stress| most.max(stress.abs()));
        for scheme in ["leapfrog", "muscl"] {
            for cells in cells {
                let found = force(&format!("scheme = \"{scheme}\"\ncells = {cells}"));
                let errors = found.iter().zip(&exact).map(|(a, b)| (a - b).abs() / largest);
                let error = errors.fold(0.0, f64::max);
                println!("{name}, {scheme}, {cells} cells: {error:.4}");
                assert!(error < bound, "{name}, {scheme}, {cells} cells: {error}");
            }
        }
    }
}

/// Waves that open a contact and close it again within a step, or arrive at it in one, must not be combined into a force of a single step. Otherwise,
/// the peak is 32 % too large with the Godunov scheme and 300 cells, and correct with 600.
#[test]
fn a_force_of_a_single_step_is_no_peak() {
    let strong = "{ density = 7850, modulus = 200e9, beyond = \"extend\", curve = { table = [[0.01, 2e9]] } }";
    let soft = "{ density = 8900, modulus = 120e9, beyond = \"extend\", curve = { table = [[0.001, 120e6], [0.101, 320e6], [0.301, 520e6]] } }";
    let area = |diameter: f64| format!("{:e}", 0.25 * std::f64::consts::PI * diameter * diameter);
    let piece = |length: f64, diameter: f64, material: &str, velocity: f64, joint: &str| {
        segment(length, material, velocity, joint).replace("1e-4", &area(diameter))
    };
    let bar = piece(0.2996, 0.02, strong, 9.23, "joint = \"bonded\"")
        + &piece(0.1793, 0.014, "\"mild-steel\"", 0.0, &gap(5e-4))
        + &piece(0.1085, 0.01, soft, 0.0, "");
    let case = Case::new(bar, FREE, "kind = \"wall\"\ngap = 1e-4", "150 us");
    let peak = |solve: &str| case.figure(solve, "/figures/joints/2/peak_force_N");
    let exact = peak("method = \"moc\"");
    for cells in [300, 600] {
        let error = peak(&format!("scheme = \"muscl\"\ncells = {cells}")) / exact - 1.0;
        assert!(error.abs() < 0.04, "{cells} cells: {error}");
    }
}

/// With kinematic hardening, a bar unloaded by twice its yield stress yields in reverse, behind a front that the waves of elastic unloading do not
/// include.
#[test]
fn loads_that_decay_far_are_right_with_kinematic_hardening() {
    let end = "kind = \"stress\"\nhistory = [[0, 700e6], [1e-4, 0]]";
    let case = Case::new(segment(0.5, BILINEAR, 0.0, ""), FREE, end, "90 us");
    let by = |solve: &str| {
        let summary = binary::summary_of(&case.scene(solve).replace("isotropic", "kinematic"));
        ["residual_strain_largest", "right/impulse_N_s"]
            .map(|name| summary.pointer(&format!("/figures/{name}")).and_then(Value::as_f64).expect("a figure"))
    };
    let exact = by("method = \"moc\"");
    for scheme in ["leapfrog", "muscl"] {
        let found = by(&format!("scheme = \"{scheme}\"\ncells = 1000"));
        let errors = [0, 1].map(|k| found[k] / exact[k] - 1.0);
        println!("{scheme}: {errors:?}");
        assert!(errors[0].abs() < 0.02 && errors[1].abs() < 0.005, "{scheme}: {errors:?}");
    }
}

/// The search for fans must not treat a striker that flies away as one that pulls the bar: the fixed end, where nothing happens, would carry 3.8 kN.
#[test]
fn a_striker_that_flies_away_does_nothing() {
    let case = Case::new(
        segment(0.5, BILINEAR, 0.0, ""),
        "kind = \"striker\"\nmass = 2\nvelocity = -26",
        "kind = \"fixed\"",
        "240 us",
    );
    for solve in ["cells = 400", "scheme = \"muscl\"\ncells = 400", "method = \"moc\""] {
        let summary = binary::summary_of(&case.scene(solve));
        let force = summary.pointer("/figures/right/peak_force_N").and_then(Value::as_f64);
        assert_eq!(force.unwrap_or(0.0), 0.0, "{solve}: {summary}");
    }
}

/// The waves of a load that changes slowly must not exhaust the search for fans, or meet the fan of the far end at once. Otherwise, the load of a
/// fixed end is 2 to 3 % too large, and its cells have 15 to 20 % too much strain, at any number of cells. The striker of 0.8 kg leaves the near end
/// elastic.
#[test]
fn the_first_wave_of_a_load_that_decays_starts_the_fan_of_the_far_end() {
    let soft = "{ density = 7800, modulus = 200e9, beyond = \"extend\", curve = { table = [[0.001, 200e6], [0.021, 300e6]] } }";
    let ends = [
        ("falls", "kind = \"velocity\"\nhistory = [[0, -12], [1e-4, -11]]"),
        ("striker", "kind = \"striker\"\nmass = 8\nvelocity = -12"),
        ("elastic striker", "kind = \"striker\"\nmass = 0.8\nvelocity = -5"),
        ("elastic stress", "kind = \"stress\"\nhistory = [[0, -190e6], [1e-4, -150e6]]"),
    ];
    for (name, right) in ends {
        let case = Case::new(segment(0.5, soft, 0.0, ""), "kind = \"fixed\"", right, "140 us");
        case.assert_near(name, "left/peak_force_N", &[400, 1600], 0.001);
        case.assert_near(name, "largest_plastic_strain", &[400, 1600], 0.01);
    }
}

/// The many plastic waves of a striker must not exhaust the search for fans before the first wave reaches the far end. Otherwise, the force there is
/// 4 % too large on every grid, so that no error estimate can detect it.
#[test]
fn the_first_wave_of_a_striker_that_is_soon_slowed_starts_the_fan_of_the_far_end() {
    let right = "kind = \"striker\"\nmass = 0.1\nvelocity = -15";
    let case = Case::new(segment(0.5, BILINEAR, 0.0, ""), "kind = \"fixed\"", right, "140 us");
    case.assert_near("striker", "left/peak_force_N", &[400, 1600], 0.004);
}

/// The waves of a light striker, of which the first ends early, must not exhaust the search at 4 us either, and fans that travel less than six cells
/// must be included.
#[test]
fn the_first_wave_of_a_light_striker_starts_the_fan_of_the_far_end() {
    let right = "kind = \"striker\"\nmass = 0.0255\nvelocity = -15";
    let case = Case::new(segment(0.5, BILINEAR, 0.0, ""), "kind = \"fixed\"", right, "140 us");
    case.assert_near("light striker", "left/peak_force_N", &[200, 300, 400], 0.004);
}

/// Loads that rise over more than 200 time steps have fans, too: otherwise, the first cell has 13 % too little strain with leapfrog, and 4 % with the
/// Godunov scheme. (The difference here is due to the distance from the end to the middle of the first cell.)
#[test]
fn a_load_that_rises_slowly_and_falls_again_starts_with_its_fan() {
    let material = "{ density = 8000, modulus = 100e9, beyond = \"extend\", curve = { formula = \"ludwik\", yield = 100e6, K = 500e6, n = 0.5, \
                    tabulate = { to-strain = 0.3, tolerance = 1e-4 } } }";
    let left = "kind = \"stress\"\nhistory = [[0, 0], [1.5e-4, -3e8], [3e-4, 0]]";
    let case = Case::new(segment(2.0, material, 0.0, ""), left, "kind = \"absorbing\"", "330 us");
    case.assert_near("slow load", "largest_plastic_strain", &[1000, 2000], 0.03);
}

/// Lateral inertia takes up an impulse in the two steps in which a gap closes. The force of the second step is not this impulse divided by the time
/// step: 3 to 5 MN, the larger the smaller the steps.
#[test]
fn the_impulse_of_lateral_inertia_as_a_gap_closes_is_no_peak() {
    let bar = "[bar]\nlength = 0.3\narea = 24e-4\nvelocity = 5\nmaterial = { density = 7800, modulus = 200e9, poisson = 0.29, \
               beyond = \"extend\", curve = { table = [[0.05, 10e9]] } }\n[left]\nkind = \"free\"\n";
    let peak = |gap: f64, cells: usize| {
        let scene = format!(
            "{bar}[right]\nkind = \"wall\"\ngap = {gap}\n[effects]\nlateral-inertia = true\n[solve]\nuntil = 1e-4\ncells = {cells}\n\
             [record]\nframes = 2\n"
        );
        binary::summary_of(&scene).pointer("/figures/right/peak_force_N").and_then(Value::as_f64).expect("a peak")
    };
    for cells in [250, 1000] {
        let [later, at_start] = [1e-4, 0.0].map(|gap| peak(gap, cells));
        assert!((later / at_start - 1.0).abs() < 1e-3, "{later} {at_start}");
    }
}

/// The waves of a ramp are nowhere steeper than the ramp: a joint that yields under them starts without a fan of its own.
#[test]
fn what_a_rising_load_sends_through_the_bar_is_no_jump() {
    let bar = segment(0.2, ELASTIC, 0.0, "") + &segment(0.3, BILINEAR, 0.0, "");
    let case = Case::new(bar, "kind = \"velocity\"\nhistory = [[0, 0], [4e-6, 15]]", FREE, "70 us");
    case.assert_near("through a joint", "segments/2/largest_plastic_strain", &[1000, 4000], 0.03);
    case.assert_near("through a joint", "joints/1/peak_force_N", &[1000, 4000], 0.01);
}

/// Rounding must not decide whether the fan of the first velocity has ended when the second one starts: with 330 to 340 and 380 to 400 cells, the
/// strain would be 18 % too large.
#[test]
fn a_velocity_jumps_while_its_first_fan_is_narrow() {
    let left = "kind = \"velocity\"\nhistory = [[0, -20], [2e-5, -20], [2e-5, -60]]";
    let case = Case::new(segment(0.5, "\"copper-annealed\"", 0.0, ""), left, FREE, "60 us");
    case.assert_near("narrow", "residual_strain_largest", &[340, 360, 400], 0.01);
    case.assert_near("narrow", "left/peak_force_N", &[340, 360, 400], 0.001);
}

/// A stress that jumps later starts with its fan, and the steps of a ramp before it do not exhaust the search for fans. Otherwise, the strain of the
/// first cells is 2 to 9 % too large with leapfrog, and 1 to 5 % with the Godunov scheme.
#[test]
fn a_stress_jumps_later() {
    let histories = [
        ("at rest at first", BILINEAR, "[0, 0], [2.03e-5, 0], [2.03e-5, -350e6]"),
        ("elastic at first", BILINEAR, "[0, -150e6], [2e-5, -150e6], [2e-5, -350e6]"),
        ("three jumps", BILINEAR, "[0, -250e6], [2e-5, -250e6], [2e-5, -350e6], [4e-5, -350e6], [4e-5, -450e6]"),
        ("after a ramp", BILINEAR, "[0, 0], [1e-5, -100e6], [2.03e-5, -100e6], [2.03e-5, -350e6]"),
        ("thrown back", BILINEAR, "[0, -300e6], [2e-5, -300e6], [2e-5, 300e6]"),
        ("copper", COPPER, "[0, -100e6], [2e-5, -100e6], [2e-5, -180e6]"),
    ];
    for (name, material, history) in histories {
        let left = format!("kind = \"stress\"\nhistory = [{history}]");
        let case = Case::new(segment(0.5, material, 0.0, ""), &left, "kind = \"absorbing\"", "60 us");
        case.assert_near(name, "residual_strain_largest", &[300, 1500], 0.01);
    }
}

/// A fan that is followed until it meets the plastic front of an earlier load, which is spread over cells on a grid, must not take an impulse from
/// it: 1.2 % of that of the stress.
#[test]
fn a_fan_that_meets_a_plastic_front_takes_no_impulse_from_it() {
    let left = "kind = \"stress\"\nhistory = [[0, -300e6], [2e-5, -300e6], [2e-5, 300e6]]";
    let kinematic = |cells: usize| {
        let case = Case::new(segment(0.5, BILINEAR, 0.0, ""), left, "kind = \"absorbing\"", "60 us");
        let summary = binary::summary_of(&case.scene(&format!("cells = {cells}")).replace("isotropic", "kinematic"));
        [&summary["figures"]["left"]["impulse_N_s"], &summary["end_time_s"]].map(|n| n.as_f64().expect("a number"))
    };
    let [impulse, time] = kinematic(300);
    // A compression of -300 MPa for 20 us accelerates the bar in +x, then 300 MPa pull it.
    let exact = 300e6 * 1e-4 * (2e-5 - (time - 2e-5));
    assert!((impulse / exact - 1.0).abs() < 1e-3, "{impulse} for {exact}");
}

/// The row before a jump within a step must not combine the stress behind it with the velocity before it.
#[test]
fn no_row_before_a_jump_has_the_stress_behind_it() {
    let left = "kind = \"velocity\"\nhistory = [[0, -15], [3e-5, -15], [3e-5, 20]]";
    let case = Case::new(segment(0.5, BILINEAR, 0.0, ""), left, FREE, "40 us");
    let folder = tempfile::tempdir().expect("a folder");
    std::fs::write(folder.path().join("scene.toml"), case.scene("cells = 1000\n")).expect("a folder to write to");
    binary::done(folder.path(), &["run", "scene.toml", "-o", "out.h5"]);
    let result = ResultFile::open(&folder.path().join("out.h5")).expect("a result file");
    let rows = result.end(Side::Left).expect("a history");
    let pulled = rows
        .time
        .iter()
        .zip(&rows.velocity)
        .zip(&rows.stress)
        .filter(|((time, velocity), _)| **time > 1e-5 && **velocity < 0.0);
    let stresses: Vec<f64> = pulled.map(|(_, stress)| *stress).collect();
    assert!(
        stresses.len() > 100 && stresses.iter().all(|stress| (stress / 324.1e6 - 1.0).abs() < 0.01),
        "{stresses:?}"
    );
}

const BILINEAR_ALUMINIUM: &str = "{ density = 2700, modulus = 70e9, beyond = \"extend\", curve = { table = [[0.0021428571, 150e6], [0.1035714286, 250e6]] } }";

/// A joint behind which a bar yields follows the wave of a striker, which decreases by 5 %. It must not keep the velocity of the first moment, nor
/// the elastic bar before it the state of that moment up to the reflected front: 5 us later, the stress would be 1.4 MPa instead of -34.3 MPa, and
/// -141 MPa instead of -150 MPa behind the joint.
#[test]
fn a_joint_that_yields_follows_the_wave_that_comes_to_it() {
    let bar = segment(0.5, ELASTIC, 0.0, "") + &segment(0.3, BILINEAR_ALUMINIUM, 0.0, "");
    let case = Case::new(bar, "kind = \"striker\"\nmass = 1.5\nvelocity = 15", "kind = \"absorbing\"", "180 us");
    for (place, after, until) in [("0.25 m", 151e-6, 179e-6), ("0.65 m", 131e-6, 179e-6)] {
        let between = |solve: &str| case.gauge_between(place, [after, until], solve);
        let exact = between("method = \"moc\"\nfront-tolerance = 5e-4");
        for solve in ["cells = 500", "cells = 1000", "scheme = \"muscl\"\ncells = 1000"] {
            let [low, high] = between(solve);
            println!("{place}, {solve}: {low:e} to {high:e}, exactly {exact:?}");
            assert!(
                (low - exact[0]).abs() < 3.5e6 && (high - exact[1]).abs() < 3.5e6,
                "{solve}: {low:e} {high:e} for {exact:?}"
            );
        }
    }
}

/// The fan at a fixed end must not be held while the wave that started it decreases by 5 % and almost all of its plastic part has vanished. With a
/// stress that decreases from 80 to 40 MPa, the permanent strain would be 2.1 times the exact one, and the reflected wave 5 % too small.
#[test]
fn a_decaying_wave_that_hardly_makes_a_fixed_end_yield_is_not_held() {
    let left = "kind = \"stress\"\nhistory = [[0, -80e6], [200e-6, -40e6]]";
    let case = Case::new(segment(0.5, BILINEAR_ALUMINIUM, 0.0, ""), left, "kind = \"fixed\"", "150 us");
    case.assert_near("elongation", "permanent_elongation_m", &[1000], 0.07);
    case.assert_near("energy", "energy_absorbed_J", &[1000], 0.07);
    let between = |solve: &str| case.gauge_between("0.25 m", [149e-6, 1.0], solve);
    let (found, exact) = (between("cells = 1000"), between("method = \"moc\"\nfront-tolerance = 5e-4"));
    assert!((found[0] / exact[0] - 1.0).abs() < 0.01, "{found:?} for {exact:?}");
}

/// Two plastic fronts that approach each other are spread over some cells: the fan of the one must end before it reaches the other. Otherwise, the
/// momentum taken from it returns as a pulse, and the largest force at the far end is 8 % too small with leapfrog, 3 % with the Godunov scheme.
#[test]
fn fans_end_before_a_front_that_comes_towards_them_touches_theirs() {
    let material = |limit: f64, hardening: f64| {
        let (strain, last) = (limit / 200e3, limit + 50.0 * hardening);
        format!(
            "{{ density = 7800, modulus = 200e9, beyond = \"extend\", curve = {{ table = [[{strain}, \"{limit} MPa\"], [{}, \"{last} MPa\"]] }} }}",
            strain + 0.05
        )
    };
    let segment = |length: f64, diameter: f64, material: &str| {
        format!("[[bar.segment]]\nlength = {length}\ndiameter = \"{diameter} mm\"\nmaterial = {material}\n")
    };
    let bar = segment(0.1475, 11.577, &material(300.0, 2.0))
        + &segment(0.051, 9.561, &material(150.0, 5.0))
        + &segment(0.3748, 15.118, &material(200.0, 2.0));
    let left = "kind = \"velocity\"\nvalue = 14.64\nrelease = \"43.35 us\"";
    let case = Case::new(bar, left, "kind = \"fixed\"", "249 us");
    case.assert_near("far end", "right/peak_force_N", &[200, 400], 0.01);
}

/// At a joint with a greater force than the arriving wave, the decrease of its velocity must be followed, too. Otherwise, both sides of the joint
/// separate, the Godunov scheme loses a quarter of the energy, and leapfrog absorbs 28 % too much.
#[test]
fn a_joint_to_a_larger_section_follows_the_wave_that_comes_to_it() {
    let hard = "{ density = 7800, modulus = 200e9, beyond = \"extend\", curve = { table = [[0.1, 20e9]] } }";
    let soft = "{ density = 7800, modulus = 200e9, beyond = \"extend\", curve = { table = [[0.001, 200e6], [0.101, 2200e6]] } }";
    let segment =
        |area: f64, material: &str| format!("[[bar.segment]]\nlength = 0.5\narea = {area}\nmaterial = {material}\n");
    let left = "kind = \"velocity\"\nhistory = [[0, 15], [60e-6, 0]]";
    for area in [3e-4, 2e-4] {
        let case = Case::new(segment(1e-4, hard) + &segment(area, soft), left, FREE, "190 us");
        case.assert_near("joint", "energy_absorbed_J", &[400, 800], 0.04);
        for scheme in ["leapfrog", "muscl"] {
            let summary = binary::summary_of(&case.scene(&format!("scheme = \"{scheme}\"\ncells = 400")));
            let residual = summary.pointer("/ledger/energy_residual").and_then(Value::as_f64).expect("a number");
            assert!(residual < 1e-12, "{scheme}: {residual:e}");
        }
    }
}

/// The force of a joint must not be read in the cells beside it only after the wave has decayed for some three cells. Otherwise, it is 6 % (200 cells) and
/// 2 % (800 cells) too small under a striker of 0.5 kg, and 19 and 9 % under one of 0.05 kg, whose wave decays too fast for the fan of the joint to be
/// followed.
#[test]
fn a_joint_has_the_force_of_the_moment_in_which_a_decaying_wave_arrives() {
    let bar = segment(0.5, ELASTIC, 0.0, "") + &segment(0.5, BILINEAR, 0.0, "").replace("area = 1e-4", "area = 3e-4");
    for mass in [0.5, 0.05] {
        let left = format!("kind = \"striker\"\nmass = {mass}\nvelocity = 15");
        let case = Case::new(bar.clone(), &left, "kind = \"absorbing\"", "160 us");
        case.assert_near(&format!("{mass} kg"), "joints/1/peak_force_N", &[100, 200, 800], 1e-4);
    }
}

/// The fan of a gap that the wave of a light striker closes must not be held for as long as its elastic front has its stress in exact theory, 61 us,
/// since on the grid it vanishes earlier. Otherwise, the bar absorbs three times the energy of the striker, and the Godunov scheme stops after adding
/// 255 % of the energy.
#[test]
fn a_gap_that_a_decaying_wave_closes_adds_no_energy() {
    let steel = "{ density = 7800, modulus = 200e9, beyond = \"extend\", curve = { table = [[0.001359, 271.8e6], [0.004077, 425.6e6], [0.009513, 553.3e6], \
                 [0.020385, 638.6e6], [0.04213, 714.9e6], [0.54213, 1632.8e6]] } }";
    let left = "kind = \"striker\"\nmass = 0.06057\nvelocity = 13.763";
    let case = Case::new(segment(1.0127, steel, 0.0, ""), left, "kind = \"wall\"\ngap = 1e-6", "390 us");
    for cells in [100, 200, 400] {
        let summary = binary::summary_of(&case.scene(&format!("cells = {cells}")));
        let absorbed = summary.pointer("/figures/energy_absorbed_J").and_then(Value::as_f64).expect("a number");
        assert!((absorbed / 4.12 - 1.0).abs() < 0.2, "{cells} cells: {absorbed} J");
    }
}
