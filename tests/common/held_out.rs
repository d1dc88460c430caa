//! Scenes of other kinds than those used to determine the factors of the error estimates: bodies and springs at the ends, reflected pulses, gaps,
//! contact joints, a cone, shear, curves with increasing slope or with a different branch in compression, other kinds of hardening, rate
//! dependence, damping, lateral inertia.

use barwave::material::Sense;
use barwave::scene::Scene;

use super::{BILINEAR, ELASTIC, FOUR, ISOTROPIC, Known, LIGHT, POWER, TRANSIT, Truth, driven, let_go, one, two};

/// Density (kg/m^3) and elastic modulus (Pa) of the steel of the exact solutions.
const DENSITY: f64 = 7800.0;
const MODULUS: f64 = 200e9;

const S_SHAPED: &str = r#"{ name = "s", density = 7800, modulus = "200 GPa", beyond = "extend", curve = { table = [[0.001, "200 MPa"], [0.011, "250 MPa"], [0.031, "450 MPa"], [0.1, "600 MPa"]] } }"#;
const UNLIKE: &str = r#"{ name = "u", density = 7800, modulus = "200 GPa", beyond = "extend", curve = { table = [[0.001, "200 MPa"], [0.021, "600 MPa"]] }, compression = { table = [[0.0015, "300 MPa"], [0.01, "500 MPa"], [0.05, "700 MPa"]] } }"#;
const LEVEL: &str = r#"{ name = "v", density = 7800, modulus = "200 GPa", beyond = "extend", curve = { table = [[0.001, "200 MPa"], [0.008, "300 MPa"], [0.05, "300 MPa"]] } }"#;
const WIDENING: &str = r#"{ name = "w", density = 7800, modulus = "200 GPa", poisson = 0.29, beyond = "error", curve = { table = [[0.02, "4 GPa"]] } }"#;
const SHEARED: &str = r#"{ name = "soft", loading = "shear", density = 8900, modulus = "45 GPa", beyond = "extend", curve = { table = [[0.001, "45 MPa"], [0.02, "75 MPa"], [0.2, "150 MPa"]] } }"#;

/// Returns a scene with complete descriptions of both ends.
fn scene(bar: &str, left: &str, right: &str, effects: &str, until: f64) -> String {
    format!(
        "{bar}\n[left]\n{left}\n[right]\n{right}\n[effects]\n{effects}\n[solve]\nuntil = {until:e}\n[record]\nframes = 1\n"
    )
}

fn kind(kind: &str) -> String {
    format!("kind = \"{kind}\"")
}

/// Returns an end with a history; the times of `rows` are in transits, the values in SI units.
fn history(kind: &str, rows: &[(f64, f64)]) -> String {
    let rows: Vec<String> = rows.iter().map(|(t, v)| format!("[{:e}, {v:e}]", t * TRANSIT)).collect();
    format!("kind = \"{kind}\"\nhistory = [{}]", rows.join(", "))
}

fn struck_by(mass: f64, velocity: f64) -> String {
    format!("kind = \"striker\"\nmass = {mass}\nvelocity = {velocity}")
}

fn moving(material: &str, velocity: f64) -> String {
    format!("{}\nvelocity = {velocity}", one(material))
}

/// Returns a bar of two segments, the first of which flies into the second.
fn flying(first: (f64, f64, &str), second: (f64, f64, &str), velocity: f64, gap: f64) -> String {
    let joint = format!("\nvelocity = {velocity}\njoint = \"contact\"\ngap = {gap:e}\n[[bar.segment]]");
    two(first, second).replacen("\n[[bar.segment]]", &joint, 1)
}

const MASS: f64 = 0.39;
const STIFFNESS: f64 = 1e8;
/// Release time in transits. It is not at a step of any tested grid, but at step 1557 of the grid of 3072 cells on a 20 cm bar of mild steel, and
/// so on the grids of the reference solutions.
const RELEASE: f64 = 0.099_957_353_468_467_99;
const PULSE: [(f64, f64); 4] = [(0.0, 0.0), (0.1, -100e6), (0.3, -100e6), (0.4, 0.0)];
const TRIANGLE: [(f64, f64); 3] = [(0.0, 0.0), (0.15, 80e6), (0.35, 0.0)];
const SHAKEN: [(f64, f64); 4] = [(0.0, 0.0), (0.1, 5.0), (0.3, 5.0), (0.45, 0.0)];
const PULLED: [(f64, f64); 2] = [(0.0, 0.0), (0.3, -20.0)];

/// Returns all held-out scenes.
pub fn held_out() -> Vec<Known> {
    let t = TRANSIT;
    let tracked = |name, text| Known { name, text, truth: Truth::Tracked };
    let exact = |name, formula, text| Known { name, text, truth: Truth::Formula(formula) };
    let of = |name, truth, text| Known { name, text, truth };
    let short = |material: &str| format!("[bar]\nlength = 0.2\narea = 1e-4\nmaterial = {material}");
    let cone = format!("[bar]\nlength = 1\ndiameter = [[0, 0.01], [1, 0.03]]\nmaterial = {ELASTIC}");
    let tube = format!("[bar]\nmode = \"torsion\"\nlength = 1\ndiameter = 0.025\nwall = 0.001\nmaterial = {SHEARED}");
    let torque = "kind = \"torque\"\nhistory = [[0, 0], [0, 60], [1e-4, 60], [1e-4, 0]]";
    let pushed_and_pulled = history("velocity", &[(0.0, -20.0), (0.4, -20.0), (0.4, 15.0)]);
    let stress_pulse = history("stress", &[(0.0, -320e6), (0.3, -320e6), (0.3, 0.0)]);
    let wall = |gap: f64| format!("kind = \"wall\"\ngap = {gap:e}");
    let spring = format!("kind = \"spring\"\nstiffness = {STIFFNESS:e}");
    let malvern = "hardening = \"isotropic\"\nrate = { model = \"malvern\", k = 1e5 }";
    let johnson = "rate = { model = \"johnson-cook\", C = 0.02, reference = 1 }";
    let damping = "damping = { external = 4e3 }";
    let thick = format!("[bar]\nlength = 1\ndiameter = 0.04\nmaterial = {WIDENING}");
    vec![
        exact("mass on a rod", mass_on_a_rod, scene(&one(ELASTIC), &struck_by(MASS, 5.0), &kind("fixed"), "", 1.6 * t)),
        exact(
            "pulse at a free end",
            pulse_at_a_free_end,
            scene(&one(ELASTIC), &history("stress", &PULSE), &kind("free"), "", 1.3 * t),
        ),
        exact(
            "pulse at a fixed end",
            pulse_at_a_fixed_end,
            scene(&one(ELASTIC), &history("stress", &TRIANGLE), &kind("fixed"), "", 1.1 * t),
        ),
        exact("spring at the end", spring_at_the_end, scene(&one(ELASTIC), &driven("5 m/s"), &spring, "", 1.7 * t)),
        exact("cone", wave_in_a_cone, scene(&cone, &history("velocity", &SHAKEN), &kind("absorbing"), "", 0.85 * t)),
        exact(
            "power law, ramp",
            ramp,
            scene(&one(POWER), &history("velocity", &PULLED), &kind("free"), ISOTROPIC, 0.9 * t),
        ),
        tracked(
            "unlike segments",
            scene(&two((0.3, 3e-4, FOUR), (0.7, 1e-4, LIGHT)), &driven("15 m/s"), &kind("fixed"), ISOTROPIC, 1.2 * t),
        ),
        tracked("gap before a wall", scene(&moving(BILINEAR, 12.0), &kind("free"), &wall(3e-4), ISOTROPIC, 2.5 * t)),
        tracked(
            "pulled, then pushed, kinematic",
            scene(&one(BILINEAR), &pushed_and_pulled, &kind("free"), "hardening = \"kinematic\"", 1.4 * t),
        ),
        tracked(
            "released, mixed hardening",
            scene(&one(FOUR), &let_go("-25 m/s", 0.4), &kind("fixed"), "hardening = { mixed = 0.3 }", 1.3 * t),
        ),
        tracked("S-shaped, reflected", scene(&one(S_SHAPED), &driven("-30 m/s"), &kind("fixed"), ISOTROPIC, 1.5 * t)),
        tracked(
            "unlike in compression",
            scene(&one(UNLIKE), &let_go("20 m/s", 0.4), &kind("free"), ISOTROPIC, 1.6 * t),
        ),
        tracked("plastic stress pulse", scene(&one(BILINEAR), &stress_pulse, &kind("fixed"), ISOTROPIC, 1.5 * t)),
        tracked("level curve", scene(&one(LEVEL), &driven("-12 m/s"), &kind("absorbing"), ISOTROPIC, 1.5 * t)),
        tracked(
            "striker bar, elastic",
            scene(
                &flying((0.3, 1e-4, ELASTIC), (0.7, 1e-4, ELASTIC), 10.0, 2e-4),
                &kind("free"),
                &kind("free"),
                "",
                1.5 * t,
            ),
        ),
        tracked(
            "striker bar, plastic",
            scene(
                &flying((0.3, 1e-4, BILINEAR), (0.7, 1.5e-4, BILINEAR), 18.0, 0.0),
                &kind("free"),
                &kind("absorbing"),
                ISOTROPIC,
                1.2 * t,
            ),
        ),
        tracked("torque pulse", scene(&tube, torque, &kind("fixed"), ISOTROPIC, 6e-4)),
        of(
            "mass on a plastic rod",
            Truth::Fine(1e-4),
            scene(&one(BILINEAR), &struck_by(MASS, 20.0), &kind("free"), ISOTROPIC, 0.9 * t),
        ),
        of(
            "Malvern, released",
            Truth::Net(6144),
            scene(&short("\"mild-steel\""), &let_go("12 m/s", RELEASE), &kind("fixed"), malvern, 60e-6),
        ),
        of(
            "Johnson and Cook",
            Truth::Net(6144),
            scene(&short(BILINEAR), &driven("-15 m/s"), &kind("free"), johnson, 35e-6),
        ),
        of("damped", Truth::Leapfrog(16384), scene(&one(ELASTIC), &driven("5 m/s"), &kind("fixed"), damping, 1.5 * t)),
        of(
            "lateral inertia",
            Truth::Leapfrog(8192),
            scene(&thick, &history("stress", &PULSE), &kind("free"), "lateral-inertia = true", 0.8 * t),
        ),
    ]
}

fn c0() -> f64 {
    (MODULUS / DENSITY).sqrt()
}

/// Returns the value of a history that is linear between its rows and constant after the last one; times of `rows` in transits.
fn at(rows: &[(f64, f64)], time: f64) -> f64 {
    let time = time / TRANSIT;
    let after = rows.partition_point(|row| row.0 <= time);
    match (after.checked_sub(1).map(|k| rows[k]), rows.get(after)) {
        (None, _) => 0.0,
        (Some((t0, v0)), Some((t1, v1))) => v0 + (v1 - v0) * (time - t0) / (t1 - t0),
        (Some((_, v)), None) => v,
    }
}

/// The end decelerates with the mass, A rho c0 v = -m dv/dt; the fixed end reflects the stress wave with the same sign.
fn mass_on_a_rod(_: &Scene, x: f64, time: f64) -> f64 {
    let impedance = DENSITY * c0();
    let wave = |since: f64| if since > 0.0 { -impedance * 5.0 * (-1e-4 * impedance / MASS * since).exp() } else { 0.0 };
    wave(time - x / c0()) + wave(time - (2.0 - x) / c0())
}

fn pulse_at_a_free_end(_: &Scene, x: f64, time: f64) -> f64 {
    at(&PULSE, time - x / c0()) - at(&PULSE, time - (2.0 - x) / c0())
}

fn pulse_at_a_fixed_end(_: &Scene, x: f64, time: f64) -> f64 {
    at(&TRIANGLE, time - x / c0()) + at(&TRIANGLE, time - (2.0 - x) / c0())
}

/// At the spring, A sigma = -K u and sigma = rho c0 (u' - 2 v) while the wave of velocity v arrives: sigma tends to -2 rho c0 v as
/// 1 - exp(-K t/(A rho c0)).
fn spring_at_the_end(_: &Scene, x: f64, time: f64) -> f64 {
    let step = DENSITY * c0() * 5.0;
    let (incoming, back) = (time - x / c0(), time - (2.0 - x) / c0());
    let coming = if incoming > 0.0 { -step } else { 0.0 };
    let rate = STIFFNESS / (1e-4 * DENSITY * c0());
    coming + if back > 0.0 { step - 2.0 * step * (1.0 - (-rate * back).exp()) } else { 0.0 }
}

/// u = a U(t - x/c0)/X, where X is the distance from the apex of the cone, a that of the driven end, and U its displacement.
fn wave_in_a_cone(_: &Scene, x: f64, time: f64) -> f64 {
    const POINT: f64 = 0.5;
    let since = time - x / c0();
    if since <= 0.0 {
        return 0.0;
    }
    let mut corners: Vec<f64> = SHAKEN.iter().map(|row| row.0 * TRANSIT).filter(|t| *t < since).collect();
    corners.push(since);
    // The velocity is linear between corners, so the mean of both values is that of the interval.
    let moved: f64 = corners.windows(2).map(|w| 0.5 * (at(&SHAKEN, w[0]) + at(&SHAKEN, w[1])) * (w[1] - w[0])).sum();
    let place = POINT + x;
    -MODULUS * POINT * (moved / (place * place) + at(&SHAKEN, since) / (c0() * place))
}

/// A simple wave: each straight segment of a concave curve has its own wave speed, and transmits its part of the velocity of the end at this
/// speed.
fn ramp(scene: &Scene, x: f64, time: f64) -> f64 {
    let curve = scene.bar.segments[0].material.branch(Sense::Tension);
    let (mut before, mut stress) = (0.0, 0.0);
    for (strain, level) in curve.strain().windows(2).zip(curve.stress().windows(2)) {
        let speed = ((level[1] - level[0]) / (strain[1] - strain[0]) / DENSITY).sqrt();
        let next = before + speed * (strain[1] - strain[0]);
        let pulled = -at(&PULLED, time - x / speed);
        stress += DENSITY * speed * (pulled.clamp(before, next) - before);
        before = next;
    }
    stress
}

impl Known {
    /// Returns the uncertainty of the reference solution: its difference from the one with half the resolution, relative L1 of stress at the end
    /// time; 0 if it is exact.
    pub fn uncertainty(&self) -> f64 {
        let scene = self.scene("");
        let coarser = match self.truth {
            Truth::Tracked | Truth::Travelling | Truth::Formula(_) => return 0.0,
            Truth::Net(cells) => Truth::Net(cells / 2),
            Truth::Leapfrog(cells) => Truth::Leapfrog(cells / 2),
            Truth::Fine(step) => Truth::Fine(2.0 * step),
        };
        // Cell centres of a grid that is neither of the two.
        let x: Vec<f64> = (0..1531).map(|k| (f64::from(k) + 0.5) / 1531.0 * scene.bar.length()).collect();
        let mut found = vec![0.0; x.len()];
        let coarser = Known { name: self.name, text: self.text.clone(), truth: coarser };
        coarser.answer(&scene, scene.solve.until, &x, &mut found);
        self.error_at(&scene, scene.solve.until, &x, &found)
    }
}
