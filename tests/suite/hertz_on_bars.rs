//! Bars struck by a ball with Hertzian contact, axially and in torsion: the bar solvers against the sum over the modes of the bar.

use std::f64::consts::PI;
use std::ops::ControlFlow;
use std::path::Path;

use barwave::bar::Hertz;
use barwave::impact::{Contact, Horizon, Oscillator, System};
use barwave::run;
use barwave::scene::Scene;

const LENGTH: f64 = 0.05;
const DIAMETER: f64 = 0.012;
const RHO: f64 = 7800.0;
const E: f64 = 200e9;
const G: f64 = 80e9;
/// Radius of the steel ball, m.
const RADIUS: f64 = 0.005;

fn ball_mass() -> f64 {
    4.0 / 3.0 * PI * RADIUS.powi(3) * RHO
}

/// Returns the velocity after the first contact of a ball (kg, m/s) with the end of a free bar of `mass` (kg) and wave speed c: one rigid and many
/// elastic modes.
fn by_modes(law: Hertz, ball: [f64; 2], mass: f64, c: f64) -> f64 {
    const MODES: usize = 4000;
    let striker = Oscillator { v: ball[1], ..Oscillator::new(ball[0], [0.0, 0.0], -1.0) };
    let rigid = Oscillator::new(mass, [0.0, 0.0], 1.0);
    let elastic = (1..=MODES).map(|n| Oscillator::new(0.5 * mass, [n as f64 * PI * c / LENGTH, 0.0], 1.0));
    let system = System { modes: [striker, rigid].into_iter().chain(elastic).collect(), ..System::default() };
    let mut velocity = ball[1];
    let horizon = Horizon { least: 0.0, most: 120e-6, tolerance: 1e-6, doublings: 0 };
    let _ = Contact::new(law, system).run(horizon, |moment| {
        velocity = moment.system.modes[0].v;
        // Only the end of the first contact is needed.
        if moment.time > 0.0 && moment.force == 0.0 { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    });
    velocity
}

/// Returns the velocity of the ball at the end of a run, m/s, or rad/s times the radius of the surface.
fn by_solver(scene: &str, sets: &[String]) -> f64 {
    let scene = Scene::parse("test.toml", scene, Path::new("."), sets).unwrap_or_else(|e| panic!("{e}"));
    let summary = run::run(&scene, None, &mut |_| ControlFlow::Continue(())).unwrap_or_else(|e| panic!("{e}"));
    let summary = serde_json::to_value(&summary).expect("JSON");
    summary["left"]["striker_velocity_m_s"].as_f64().unwrap_or_else(|| panic!("{summary}"))
}

const STEEL: &str = "beyond = \"extend\", curve = { table = [[0, 0], [0.1, ";

fn axial() -> String {
    format!(
        "[bar]\nlength = {LENGTH}\ndiameter = {DIAMETER}\nmaterial = {{ density = {RHO}, modulus = {E}, poisson = 0.3, {STEEL}{}]] }} }}\n\
         [left]\nkind = \"ball\"\nradius = {RADIUS}\nvelocity = 2\ndensity = {RHO}\nmodulus = {E}\npoisson = 0.3\n\
         [right]\nkind = \"free\"\n[solve]\nuntil = \"60 us\"\nmethod = \"fd\"\ncells = 2000\n",
        0.1 * E
    )
}

#[test]
fn a_ball_on_the_end_of_a_rod() {
    let area = PI / 4.0 * DIAMETER * DIAMETER;
    let law = Hertz::new(RADIUS, [(E, 0.3), (E, 0.3)]);
    let modes = by_modes(law, [ball_mass(), 2.0], RHO * area * LENGTH, (E / RHO).sqrt());
    for sets in [vec![], vec!["solve.method=moc".to_owned(), "solve.cells=".to_owned()]] {
        let solver = by_solver(&axial(), &sets);
        // The measured difference is 2e-6 m/s.
        assert!((solver - modes).abs() < 1e-5, "{sets:?}: {solver} {modes}");
    }
}

#[test]
fn a_ball_on_a_lever_that_twists_a_rod() {
    let arm = 0.03;
    let polar = PI / 32.0 * DIAMETER.powi(4);
    let scene = format!(
        "[bar]\nmode = \"torsion\"\nlength = {LENGTH}\ndiameter = {DIAMETER}\n\
         material = {{ loading = \"shear\", density = {RHO}, modulus = {G}, {STEEL}{}]] }} }}\n\
         [left]\nkind = \"ball\"\narm = {arm}\nradius = {RADIUS}\nvelocity = 2\ndensity = {RHO}\nmodulus = {E}\npoisson = 0.3\n\
         [right]\nkind = \"free\"\n[solve]\nuntil = \"70 us\"\nmethod = \"fd\"\ncells = 2000\n",
        0.1 * G
    );
    // In terms of the lever, the end moves by arm times the angle, and its inertia is J divided by the square of the arm.
    let law = Hertz::new(RADIUS, [(E, 0.3), (f64::INFINITY, 0.0)]);
    let modes = by_modes(law, [ball_mass(), 2.0], RHO * polar * LENGTH / (arm * arm), (G / RHO).sqrt());
    let solver = by_solver(&scene, &[]);
    // The measured difference is 2e-6 m/s.
    assert!((solver - modes).abs() < 1e-5, "{solver} {modes}");
}
