//! Joints with every method through the program: bonded joints, contacts and gaps have the same properties.

use crate::common::methods;

use std::ops::ControlFlow;
use std::path::Path;

use barwave::record::Field;
use barwave::record::LedgerRow;
use barwave::run;
use barwave::scene::Scene;
use methods::{AREA, BILINEAR, METHODS, Method, assert_ledger, finished, impedance};

/// Impedances of the second bar relative to that of the first.
const RATIOS: [f64; 5] = [1e-4, 1e-2, 1.0, 1e2, 1e4];

const FREE: &str = "kind = \"free\"";
const FIXED: &str = "kind = \"fixed\"";
const BONDED: &str = "joint = \"bonded\"";
/// Joint of the last segment: none.
const ALONE: &str = "";

/// Segment: length (m), area (m^2), velocity (m/s), and joint to the next.
type Piece<'a> = (f64, f64, f64, &'a str);

fn contact(gap: f64) -> String {
    format!("joint = \"contact\"\ngap = {gap:e}")
}

/// Returns a scene with 100 cells per metre, and samples at their centres.
fn scene((_, solve, effects): Method, pieces: &[Piece], [left, right]: [&str; 2], until: &str) -> String {
    let segment = |&(length, area, velocity, joint): &Piece| {
        format!(
            "[[bar.segment]]\nlength = {length}\narea = {area:e}\nvelocity = {velocity}\nmaterial = {BILINEAR}\n{joint}\n"
        )
    };
    let segments: String = pieces.iter().map(segment).collect();
    let cells = (100.0 * pieces.iter().map(|piece| piece.0).sum::<f64>()).round();
    let solve = solve.replace(", ", "\n").replace("cells = 100", &format!("cells = {cells}"));
    format!(
        "{segments}[left]\n{left}\n[right]\n{right}\n[effects]\n{effects}\n[solve]\nuntil = \"{until}\"\n{solve}\n\
         [record]\nframes = 41\ncells = {cells}\nfields = [\"stress\", \"strain\", \"displacement\"]\n"
    )
}

/// Values of every frame at every sample.
type Rows = Vec<Vec<f64>>;

/// Results of a scene, whose ledger has been checked.
struct Run {
    ledger: Vec<LedgerRow>,
    time: Vec<f64>,
    stress: Rows,
    strain: Rows,
    displacement: Rows,
}

impl Run {
    /// Returns the distance between the faces beside the sample `right`, m, from the displacements and strains of the cells there.
    fn gap(&self, frame: usize, right: usize, start: f64) -> f64 {
        let (u, strain) = (&self.displacement[frame], &self.strain[frame]);
        start + u[right] - u[right - 1] - 0.005 * (strain[right] + strain[right - 1])
    }
}

fn run(method: Method, pieces: &[Piece], ends: [&str; 2], until: &str) -> Run {
    let scene = scene(method, pieces, ends, until);
    let (_folder, file) = finished(method.0, &scene);
    let ledger = assert_ledger(method.0, &file, &scene);
    assert_momentum(method.0, &ledger);
    let time = file.time().expect("times");
    let [stress, strain, displacement] = [Field::Stress, Field::Strain, Field::Displacement].map(|field| {
        let rows = file.field(field, 0..time.len()).expect("a field");
        rows.rows().into_iter().map(|row| row.to_vec()).collect()
    });
    Run { ledger, time, stress, strain, displacement }
}

/// Checks that only the ends change the momentum.
fn assert_momentum(name: &str, ledger: &[LedgerRow]) {
    let start = ledger[0].energies.momentum - ledger[0].impulse;
    // Relative to the momentum of all moving parts, and not to the sum of those that move against each other.
    let motion = |row: &LedgerRow| row.energies.kinetic.max(row.energies.elastic).sqrt();
    let most = ledger.iter().map(motion).fold(0.0, f64::max);
    let scale = most * (AREA * 7800.0_f64).sqrt();
    for row in ledger {
        let residual = (row.energies.momentum - row.impulse - start) / scale;
        assert!(residual.abs() < 1e-10, "{name}: momentum residual {residual:e} at {}", row.time);
    }
}

fn size(rows: &Rows) -> f64 {
    rows.iter().flatten().fold(0.0, |most: f64, value| most.max(value.abs()))
}

/// Returns the largest difference of two fields at common samples, relative to the largest value of the first.
fn apart(one: &Rows, other: &Rows) -> f64 {
    let pairs = one.iter().zip(other).flat_map(|(a, b)| a.iter().zip(b));
    pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max) / size(one)
}

/// Returns the mean difference relative to the mean magnitude of the first field.
fn apart_on_the_mean(one: &Rows, other: &Rows) -> f64 {
    let pairs = one.iter().zip(other).flat_map(|(a, b)| a.iter().zip(b));
    pairs.map(|(a, b)| (a - b).abs()).sum::<f64>() / one.iter().flatten().map(|value| value.abs()).sum::<f64>()
}

fn driven(velocity: f64) -> String {
    format!("kind = \"velocity\"\nvalue = {velocity}")
}

#[test]
fn pressed_faces_are_as_good_as_bonded() {
    // Struck at the left, clamped at the right; elastic and plastic, with equal and different sections.
    for method in METHODS {
        for (velocity, ratio) in [(4.0, 1.0), (4.0, 0.3), (20.0, 1.0), (20.0, 2.0)] {
            let [bonded, touching] = [BONDED, &contact(0.0)].map(|joint| {
                let pieces = [(0.5, AREA, 0.0, joint), (0.5, ratio * AREA, 0.0, ALONE)];
                run(method, &pieces, [&driven(velocity), FIXED], "190 us").stress
            });
            let apart = apart(&bonded, &touching);
            assert!(apart < 1e-12, "{} {velocity} {ratio}: {apart:e}", method.0);
        }
    }
}

#[test]
fn faces_that_do_not_press_are_free_ends() {
    // The second bar is out of reach, or touches one that is pulled away from it.
    for method in METHODS {
        for (velocity, gap) in [(4.0, 1.0), (20.0, 1.0), (-4.0, 0.0), (-20.0, 0.0)] {
            let (joint, until) = (contact(gap), if velocity > 0.0 { "290 us" } else { "190 us" });
            let pieces = [(0.5, AREA, 0.0, joint.as_str()), (0.5, 2.0 * AREA, 0.0, ALONE)];
            let two = run(method, &pieces, [&driven(velocity), FREE], until).stress;
            let one = run(method, &[(0.5, AREA, 0.0, ALONE)], [&driven(velocity), FREE], until).stress;
            let apart = apart_on_the_mean(&one, &two);
            // The grid filter damps the node at an end of a bar that has yielded, but not those at joints.
            let filtered = method.0 == "leapfrog" && velocity.abs() > 10.0;
            let allowed = if filtered { 3e-3 } else { 1e-12 };
            assert!(apart < allowed, "{} {velocity} {gap}: {apart:e}", method.0);
            let beyond: Rows = two.iter().map(|row| row[50..].to_vec()).collect();
            assert_eq!(size(&beyond), 0.0, "{} {velocity} {gap}", method.0);
        }
    }
}

#[test]
fn an_impact_has_the_force_of_both_impedances() {
    // A bar at 1 m/s strikes one at rest: p = v Y Y'/(Y + Y') in both, until the first wave from an end arrives.
    for method in METHODS {
        for ratio in RATIOS {
            let joint = contact(0.0);
            let pieces = [(0.5, AREA, 1.0, joint.as_str()), (0.5, ratio * AREA, 0.0, ALONE)];
            let found = run(method, &pieces, [FREE, FREE], "80 us");
            let force = impedance() * ratio / (1.0 + ratio);
            let last = found.stress.last().expect("a frame");
            for (cells, area) in [(30..48, AREA), (52..70, ratio * AREA)] {
                for cell in cells {
                    let missed = last[cell] / (-force / area) - 1.0;
                    assert!(missed.abs() < 1e-9, "{} {ratio} cell {cell}: {missed:e}", method.0);
                }
            }
        }
    }
}

#[test]
fn a_gap_closes_when_the_bars_have_crossed_it_and_never_overlaps() {
    for method in METHODS {
        for ratio in RATIOS {
            for gap in [0.0, 1e-6, 4e-4] {
                let joint = contact(gap);
                let pieces = [(0.5, AREA, 8.0, joint.as_str()), (0.5, ratio * AREA, 0.0, ALONE)];
                let found = run(method, &pieces, [FREE, FIXED], "1 ms");
                let closes = gap / 8.0;
                for (frame, &time) in found.time.iter().enumerate() {
                    let pressed = size(&vec![found.stress[frame].clone()]) > 0.0;
                    // A step of the grid is 2 us.
                    if (time - closes).abs() > 4e-6 {
                        assert_eq!(pressed, time > closes, "{} {ratio} {gap} {time:e}", method.0);
                    }
                    let rest = found.gap(frame, 50, gap);
                    // A tracked front may lie between a sample and the joint.
                    let allowed = if method.0 == "front tracking" { 0.01 * size(&found.strain) } else { 1e-12 };
                    assert!(rest > -allowed, "{} {ratio} {gap} {time:e}: {rest:e}", method.0);
                }
                // Leapfrog stores velocities half a step apart from stresses: an energy error of first order in the cell size.
                let allowed = if method.0 == "leapfrog" { 1e-2 } else { 1e-9 };
                let stored = |row: &LedgerRow| row.energies.kinetic + row.energies.elastic;
                let start = stored(&found.ledger[0]);
                for row in &found.ledger {
                    let gained = stored(row) / start - 1.0;
                    assert!(gained < allowed, "{} {ratio} {gap}: {gained:e} at {}", method.0, row.time);
                }
            }
        }
    }
}

fn mirrored(
    [(a, area_a, v_a, first), (b, area_b, v_b, second), (c, area_c, v_c, _)]: [Piece<'_>; 3],
) -> [Piece<'_>; 3] {
    [(c, area_c, -v_c, second), (b, area_b, -v_b, first), (a, area_a, -v_a, ALONE)]
}

#[test]
fn mirror_images_are_equal() {
    for mut method in METHODS {
        if method.0 == "front tracking" {
            // Fronts are merged from left to right.
            method.1 = "method = \"moc\", front-tolerance = 0";
        }
        for (first, second) in [(0.0, 1e-5), (2e-5, 0.0)] {
            let (first, second) = (contact(first), contact(second));
            let pieces =
                [(0.4, AREA, 9.0, first.as_str()), (0.3, 2.0 * AREA, 0.0, second.as_str()), (0.3, AREA, -3.0, ALONE)];
            let bar = run(method, &pieces, [FREE, FIXED], "200 us").stress;
            let mut image = run(method, &mirrored(pieces), [FIXED, FREE], "200 us").stress;
            for row in &mut image {
                row.reverse();
            }
            let apart = apart(&bar, &image);
            assert!(apart < 1e-12, "{}: {apart:e}", method.0);
        }
    }
}

/// A gauge at a joint of different sections has the state to its right with every method.
#[test]
fn a_gauge_on_a_joint_has_the_state_to_its_right_by_every_method() {
    let steel = "material = { name = \"s\", density = 8000, modulus = 200e9, beyond = \"extend\", curve = { table = [[0.01, 2e9]] } }";
    let text = format!(
        "[[bar.segment]]\nlength = 0.1\narea = 4e-4\n{steel}\n[[bar.segment]]\nlength = 0.2\narea = 4e-4\n{steel}\n\
         [[bar.segment]]\nlength = 0.2\narea = 1e-4\n{steel}\n[left]\nkind = \"stress\"\nvalue = -100e6\n\
         [right]\nkind = \"absorbing\"\n[record]\nframes = 1\ngauges = {{ step = 0.3 }}\n"
    );
    for solve in ["method = \"moc\"", "cells = 500", "cells = 500\nscheme = \"muscl\""] {
        let text = format!("{text}[solve]\nuntil = 8e-5\n{solve}\n");
        let scene = Scene::parse("joint", &text, Path::new("."), &[]).unwrap_or_else(|e| panic!("{e}"));
        let solution = run::solve(&scene, &mut |_| ControlFlow::Continue(())).unwrap_or_else(|e| panic!("{e}"));
        let last = solution.gauges["step"].stress.last().expect("rows");
        // The force is 2/(1 + 4) of twice the incident one; the thin rod has a quarter of the section.
        assert!((last / -160e6 - 1.0).abs() < 1e-3, "{solve}: {last:e}");
    }
}
