//! Final lengths of Taylor cylinders against measurements, and the page of the documentation that shows them.

use std::fmt::Write as _;
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};

use barwave::report::lines::{self, Line, Panel, Style};
use barwave::run::{self};
use barwave::scene::Scene;
use rayon::prelude::*;

/// Length (mm) and velocity (m/s) of a cylinder of 6061-T6 with a diameter of 7.6 mm, and its final length relative to the initial one: Wilkins and
/// Guinan, J. Appl. Phys. 44 (1973) 1200.
const SHOTS: [(f64, f64, f64); 9] = [
    (23.47, 169.0, 0.920),
    (23.47, 262.0, 0.844),
    (23.47, 373.0, 0.703),
    (23.47, 478.0, 0.562),
    (23.47, 603.0, 0.370),
    (46.94, 132.0, 0.952),
    (46.94, 275.0, 0.823),
    (46.94, 367.0, 0.722),
    (46.94, 484.0, 0.552),
];

const HEAT: &str = "effects.heat={ fraction = 0.9 }";
const RATE_LAW: &str = "effects.rate=material";
const GRID: &str = "solve.method=fd";

/// Column of the table: its heading and its changes of the scene.
const MODELS: [(&str, &[&str]); 6] = [
    ("power law", &["bar.material=aluminium-6061-t6"]),
    ("Johnson-Cook, quasi-static", &[]),
    ("with heat", &[GRID, HEAT]),
    ("with rate", &[GRID, RATE_LAW]),
    ("with rate and heat", &[GRID, RATE_LAW, HEAT]),
    ("with rate and lateral inertia", &[GRID, RATE_LAW, "effects.lateral-inertia=true"]),
];
const QUASI_STATIC: usize = 1;
const RATE: usize = 3;
const LATERAL: usize = 5;

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// Returns the unloaded final length relative to the initial one, for the scene in runs/ with these settings.
fn final_length((length, speed, _): (f64, f64, f64), changes: &[&str]) -> f64 {
    let mut overrides = vec![format!("bar.length={length}e-3"), format!("bar.velocity={}", -speed)];
    overrides.push("solve.cells=400".to_owned());
    // The long cylinders need twice the time to leave the wall.
    overrides.push(format!("solve.until={}", 150e-6 * (length / 23.47).round()));
    overrides.extend(changes.iter().map(|&change| change.to_owned()));
    let scene = Scene::read(&root().join("runs/taylor-6061-t6.toml"), &overrides).expect("a scene");
    let summary = run::run(&scene, None, &mut |_| ControlFlow::Continue(())).expect("a run");
    summary.lengths[0].unloaded / summary.lengths[0].initial
}

/// Returns the final lengths with every model, one row for each shot.
fn computed() -> Vec<Vec<f64>> {
    let row = |shot: &(f64, f64, f64)| MODELS.iter().map(|(_, changes)| final_length(*shot, changes)).collect();
    SHOTS.par_iter().map(row).collect()
}

fn table(computed: &[Vec<f64>]) -> String {
    let mut text = String::from("| length, mm | speed, m/s | measured |");
    for (name, _) in MODELS {
        write!(text, " {name} |").expect("text");
    }
    text += "\n|---|---|---|";
    text += &"---|".repeat(MODELS.len());
    for ((length, speed, measured), row) in SHOTS.iter().zip(computed) {
        write!(text, "\n| {length} | {speed} | {measured:.3} |").expect("text");
        for value in row {
            write!(text, " {value:.3} |").expect("text");
        }
    }
    text
}

/// Index of the colour black.
const BLACK: usize = 6;

fn figure(computed: &[Vec<f64>]) -> String {
    // Short cylinders only, with one line for each model.
    let points = |value: &dyn Fn(usize) -> f64| (0..5).map(|k| (SHOTS[k].1, value(k))).collect::<Vec<_>>();
    let line = |name: &str, colour, style, value: &dyn Fn(usize) -> f64| Line {
        name: name.into(),
        points: points(value),
        colour,
        style,
    };
    let mut lines = vec![line("measured", BLACK, Style::Marks, &|k| SHOTS[k].2)];
    for (colour, model) in [QUASI_STATIC, RATE, LATERAL].into_iter().enumerate() {
        lines.push(line(MODELS[model].0, colour, Style::Solid, &|k| computed[k][model]));
    }
    let labels = ["impact velocity (m/s)", "final length / initial length"].map(String::from);
    lines::figure("Taylor cylinders of 6061-T6, 23.47 mm long", &[Panel { title: String::new(), labels, lines }]).svg()
}

/// Returns the page with the table inserted between its two markers.
fn with_table(page: &str, table: &str) -> String {
    let (before, rest) = page.split_once("<!-- table -->\n").expect("the beginning of the table");
    let (_, after) = rest.split_once("<!-- end -->").expect("the end of the table");
    format!("{before}<!-- table -->\n{table}\n<!-- end -->{after}")
}

/// `UPDATE_DOCS=1 cargo test --release --test suite taylor_cylinders::` rewrites the table and the figure.
#[test]
fn cylinders_end_as_long_as_measured() {
    let computed = computed();
    for (&(length, speed, measured), row) in SHOTS.iter().zip(&computed) {
        let error = row[RATE] - measured;
        // The remaining difference is three-dimensional: the theory does not include the mushrooming of the struck end, which dominates at high
        // velocity.
        let bound = if speed < 400.0 { 0.02 } else { 0.10 };
        assert!(error.abs() < bound, "{length} mm at {speed} m/s: {error}");
        assert!(row[QUASI_STATIC] < row[RATE], "the overstress of the rate shortens less");
        assert!(speed > 500.0 || row[QUASI_STATIC] < measured, "without rate the cylinder is too soft");
    }
    let page: PathBuf = root().join("docs/taylor.md");
    let kept = std::fs::read_to_string(&page).expect("the page");
    let fresh = with_table(&kept, &table(&computed));
    if std::env::var_os("UPDATE_DOCS").is_some() {
        std::fs::write(&page, &fresh).expect("the page");
        std::fs::write(root().join("docs/taylor.svg"), figure(&computed)).expect("the figure");
    }
    assert_eq!(fresh, std::fs::read_to_string(&page).expect("the page"), "docs/taylor.md is not up to date");
}

/// The table has results of 400 cells; its third digit is accurate to a few units.
#[test]
fn final_lengths_converge() {
    let by = |cells: &str| final_length(SHOTS[2], &[cells]);
    let [coarse, middle, fine] = ["solve.cells=200", "solve.cells=400", "solve.cells=800"].map(by);
    let [first, second] = [(coarse - middle).abs(), (middle - fine).abs()];
    assert!(second < 0.003 && second < 0.75 * first, "{coarse} {middle} {fine}");
}

/// The net must flow where the overstress is more than 600 times that which changes the rate by a factor of e.
#[test]
fn the_characteristic_net_agrees_with_the_grid() {
    for shot in [SHOTS[0], SHOTS[2], SHOTS[4]] {
        let [net, grid] = ["solve.method=moc", GRID].map(|method| final_length(shot, &[RATE_LAW, method]));
        assert!((net - grid).abs() < 0.006, "{shot:?}: {net} by the net, {grid} by the grid");
    }
}
