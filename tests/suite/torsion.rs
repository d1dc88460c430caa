//! Bars in torsion: the mapping to the surface compared with axial bars, closed forms, and a rod of many layers.

use crate::common;

use std::ops::ControlFlow;
use std::path::Path;

use barwave::assemble;
use barwave::law::Row;
use barwave::material::{Beyond, Curve, Loading, Material, TubeSection};
use barwave::record::store::ResultFile;
use barwave::record::{Field, Summary, View};
use barwave::run::run;
use barwave::scene::{Effects, HardeningRule, Method, Scene};
use barwave::solver::fd::Sampling;
use barwave::solver::moc::Settings;

const TABLE: &str =
    "density = 7800, modulus = 80e9, beyond = \"extend\", curve = { table = [[0.002, 160e6], [0.1, 400e6]] }";

fn parse(text: &str) -> Scene {
    Scene::parse("torsion.toml", text, Path::new("."), &[]).unwrap_or_else(|e| panic!("{e}\n{text}"))
}

fn scene(bar: &str, left: &str, right: &str, rest: &str) -> Scene {
    parse(&format!("[bar]\n{bar}\n[left]\n{left}\n[right]\n{right}\n{rest}"))
}

fn tube(section: &str) -> String {
    format!("mode = \"torsion\"\nlength = 1\n{section}\nmaterial = {{ name = \"s\", loading = \"shear\", {TABLE} }}")
}

/// Returns stress, strain and velocity of the whole bar at the end of its run.
fn fields(scene: &Scene) -> [Vec<f64>; 3] {
    fn of<V: View>(bar: &V, places: &V::Places, count: usize) -> [Vec<f64>; 3] {
        [Field::Stress, Field::Strain, Field::Velocity].map(|field| {
            let mut row = vec![0.0; count];
            bar.sample(field, places, &mut row);
            row
        })
    }
    match scene.solve.method {
        Method::Leapfrog { cells, cfl } => {
            let mut bar = assemble::leapfrog(scene, cells, cfl);
            common::advance_to(&mut bar, scene.solve.until);
            of(&bar, &Sampling::cells(bar.grid()), bar.grid().cells())
        }
        Method::Muscl { cells, cfl } => {
            let mut bar = assemble::muscl(scene, cells, cfl);
            while bar.time() < scene.solve.until - 0.5 * bar.grid().dt {
                bar.advance();
            }
            of(&bar, &Sampling::cells(bar.grid()), bar.grid().cells())
        }
        Method::CharacteristicNet { cells } => {
            let mut bar = assemble::characteristic_net(scene, cells);
            while bar.time() < scene.solve.until {
                bar.advance();
            }
            let sampling = Sampling::cells(bar.grid());
            of(&bar, &sampling, bar.grid().cells())
        }
        Method::FrontTracking { front_tolerance, event_budget } => {
            let settings = Settings { front_tolerance, event_budget, ..Settings::default() };
            let mut bar = assemble::front_tracking(scene, settings);
            bar.advance_to(scene.solve.until).expect("within the budget");
            let places: Vec<f64> = (0..500).map(|i| (f64::from(i) + 0.5) / 500.0).collect();
            of(&bar, &places, 500)
        }
    }
}

#[test]
fn a_thin_tube_is_the_axial_bar_with_the_same_numbers_to_the_last_bit() {
    for (effects, solve) in [
        ("hardening = \"isotropic\"", "cells = 700"),
        ("", "cells = 700"),
        ("hardening = \"kinematic\"", "method = \"moc\"\nfront-tolerance = 0"),
        ("rate = { model = \"malvern\", k = 1e6 }", "cells = 700"),
    ] {
        let rest = format!("[effects]\n{effects}\n[solve]\nuntil = 5e-4\n{solve}\n");
        let left = "kind = \"velocity\"\nhistory = [[0, \"1500 rad/s\"], [4e-4, 1500], [4e-4, 0]]";
        let twisted = scene(&tube("diameter = \"26 mm\"\nwall = \"1 mm\""), left, "kind = \"free\"", &rest);
        let torsion = twisted.torsion.as_ref().expect("torsion");
        assert!((torsion.radius - 0.0125).abs() < 1e-17);
        let v = torsion.radius * 1500.0;
        let area = twisted.bar.segments[0].area;
        let axial = format!("length = 1\narea = {area:e}\nmaterial = {{ name = \"s\", {TABLE} }}");
        let left = format!("kind = \"velocity\"\nhistory = [[0, {v:e}], [4e-4, {v:e}], [4e-4, 0]]");
        let axial = scene(&axial, &left, "kind = \"free\"", &rest);
        let (here, there) = (fields(&twisted), fields(&axial));
        assert!(here[1].iter().any(|strain| strain.abs() > 0.004), "{effects}: it yields");
        for (a, b) in here.iter().zip(&there) {
            assert!(a.iter().zip(b).all(|(a, b)| a.to_bits() == b.to_bits()), "{effects}, {solve}");
        }
    }
}

fn run_to_file(scene: &Scene) -> (Summary, ResultFile, tempfile::TempDir) {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("out.h5");
    let summary = run(scene, Some(&path), &mut |_| ControlFlow::Continue(())).expect("it runs");
    let file = ResultFile::open(&path).expect("a result file");
    (summary, file, folder)
}

fn row_of(file: &ResultFile, field: Field, k: usize) -> Vec<f64> {
    file.field(field, k..k + 1).expect("a row").into_raw_vec_and_offset().0
}

#[test]
fn an_elastic_rod_carries_torque_at_the_shear_wave_s_speed() {
    let (radius, bore) = (0.01_f64, 0.006_f64);
    let polar = 0.5 * std::f64::consts::PI * (radius.powi(4) - bore.powi(4));
    let section = "diameter = \"20 mm\"\ninner-diameter = \"12 mm\"";
    let fields = "fields = [\"torque\", \"twist\", \"angular_velocity\", \"stress\"]\nframes = 3";
    let speed = (80e9_f64 / 7800.0).sqrt();
    for method in ["cells = 800", "method = \"moc\""] {
        let rest = format!("[solve]\nuntil = {:e}\n{method}\n[record]\n{fields}\n", 0.75 / speed);
        let (summary, file, _folder) =
            run_to_file(&scene(&tube(section), "kind = \"torque\"\nvalue = \"100 N*m\"", "kind = \"free\"", &rest));
        // T/J = G theta' and T = -(rho c J) omega behind a wave that travels to the right.
        let [twist, omega] = [100.0 / (80e9 * polar), -100.0 / (7800.0 * speed * polar)];
        let last = file.time().expect("times").len() - 1;
        let x = file.x().expect("places");
        for (field, expected) in [(Field::Torque, 100.0), (Field::Twist, twist), (Field::AngularVelocity, omega)] {
            let row = row_of(&file, field, last);
            for (value, x) in row.iter().zip(&x) {
                let expected = if *x < 0.75 { expected } else { 0.0 };
                // On the grid, the position of the front is known to a cell.
                if (x - 0.75).abs() > 2e-3 {
                    assert!(
                        (value - expected).abs() < 1e-9 * expected.abs().max(1e-3),
                        "{field:?} {x}: {value} {expected}"
                    );
                }
            }
        }
        assert!((summary.fronts[0].speed / speed - 1.0).abs() < 1e-12);
        assert!((summary.fronts[0].speed_measured.expect("followed") / speed - 1.0).abs() < 1e-9);
        let ends = summary.torsion.expect("torsion");
        assert!((ends.torque[0] - 100.0).abs() < 1e-9 && (ends.angular_velocity_rad_s[0] / omega - 1.0).abs() < 1e-9);
        assert!((ends.radius_m - radius).abs() < 1e-17);
    }
}

#[test]
fn a_flywheel_s_angular_momentum_and_energy_go_into_the_rod() {
    let rest = "[effects]\nhardening = \"isotropic\"\n[solve]\nuntil = 4e-4\ncells = 600\n[record]\nframes = 20\n";
    let left = "kind = \"striker\"\ninertia = \"1e-3 kg*m^2\"\nvelocity = \"3000 rad/s\"";
    for section in
        ["diameter = \"20 mm\"", "diameter = \"20 mm\"\ninner-diameter = \"18 mm\"", "diameter = 0.02\nwall = 1e-3"]
    {
        let scene = scene(&tube(section), left, "kind = \"free\"", rest);
        let (summary, file, _folder) = run_to_file(&scene);
        assert!(summary.ledger.energy_residual < 1e-12 && summary.ledger.momentum_residual < 1e-12);
        assert!(summary.effects.contains(&"plasticity".to_owned()));
        let ledger = file.ledger().expect("a ledger");
        let last = ledger[ledger.len() - 1];
        let omega = summary.left.striker.expect("a flywheel") / summary.torsion.expect("torsion").radius_m;
        // The loss of the flywheel since the start, to half a step's impulse, which is 1e-3 of the total.
        let lost = [1e-3 * (3000.0 - omega), 0.5e-3 * (3000.0_f64.powi(2) - omega.powi(2))];
        assert!((last.impulse / lost[0] - 1.0).abs() < 3e-3, "{section}: {} {lost:?}", last.impulse);
        assert!((last.work_left / lost[1] - 1.0).abs() < 3e-3, "{section}: {} {lost:?}", last.work_left);
        assert!((last.energies.momentum - last.impulse).abs() < 1e-12 * last.impulse);
        // rho J L omega: computed from the angular velocities.
        let torsion = scene.torsion.as_ref().expect("torsion");
        let velocity = row_of(&file, Field::Velocity, 19);
        let mean = velocity.iter().sum::<f64>() / velocity.len() as f64 / torsion.radius;
        assert!((7800.0 * torsion.polar[0] * mean / last.energies.momentum - 1.0).abs() < 5e-3, "{section}");
    }
}

const METHODS: [(&str, f64); 4] = [
    ("cells = 800", 3e-3),
    ("scheme = \"muscl\"\ncells = 800", 3e-3),
    // Displacements are sampled 1e-9 of the length beside joints.
    ("method = \"moc\"\nfront-tolerance = 0", 1e-8),
    // The characteristic net is for rate-dependent bars.
    ("method = \"moc\"\ncells = 800\n[effects]\nrate = { model = \"malvern\", k = 1e6 }", 3e-3),
];

/// Angular impulses and angles of twist: a torque T for a time t gives T t, and the wave twists the rod with G J theta' = T.
#[test]
fn a_constant_torque_gives_its_angular_impulse_to_an_elastic_rod() {
    let polar = 0.5 * std::f64::consts::PI * 0.01_f64.powi(4);
    let speed = (80e9_f64 / 7800.0).sqrt();
    let segment = |length: f64| {
        format!(
            "[[bar.segment]]\nlength = {length}\ndiameter = 0.02\nmaterial = {{ name = \"s\", loading = \"shear\", {TABLE} }}\n"
        )
    };
    for (solve, tolerance) in METHODS {
        let text = format!(
            "[bar]\nmode = \"torsion\"\n{}{}[left]\nkind = \"torque\"\nvalue = 100\n[right]\nkind = \"free\"\n\
             [solve]\nuntil = {:e}\n{solve}\n",
            segment(0.25),
            segment(0.75),
            0.75 / speed
        );
        let (summary, file, _folder) = run_to_file(&parse(&text));
        let time = summary.end_time_s;
        let near = |path: &[&str], name: &str, expected: f64| {
            let found = summary.figures.get(path, name).unwrap_or_else(|| panic!("{solve}: no {name} at {path:?}"));
            let scale = expected.abs().max(1e-9);
            assert!((found - expected).abs() <= tolerance * scale, "{solve} {path:?} {name}: {found:e} {expected:e}");
        };
        // A positive torque turns the left end in the negative sense, as tension pulls it.
        near(&["left"], "angular_impulse", -100.0 * time);
        near(&["right"], "angular_impulse", 0.0);
        near(&["joints", "1"], "angular_impulse", -100.0 * (time - 0.25 / speed));
        near(&[], "angle_of_twist", 100.0 / (80e9 * polar) * speed * time);
        near(&["segments", "1"], "angle_of_twist", 100.0 / (80e9 * polar) * 0.25);
        near(&[], "permanent_twist", 0.0);
        let stored = file.figures().expect("figures");
        let left = stored.iter().find(|place| place.kind == "left").expect("the left end");
        let impulse = left.figures.iter().find(|figure| figure.name == "angular_impulse").expect("an impulse");
        assert_eq!(
            (impulse.units.as_str(), Some(impulse.value)),
            ("N m s", summary.figures.get(&["left"], "angular_impulse"))
        );
    }
}

/// A tube with linear hardening, twisted at one end: an elastic and a plastic front travel at different speeds.
#[test]
fn the_permanent_twist_of_a_tube_is_that_of_its_plastic_front() {
    let (radius, omega) = (0.0125, 1500.0);
    let (elastic, plastic) = ((80e9_f64 / 7800.0).sqrt(), (240e6_f64 / 0.098 / 7800.0).sqrt());
    let behind = 0.002 + (radius * omega - 0.002 * elastic) / plastic;
    let stress = 160e6 + 240e6 / 0.098 * (behind - 0.002);
    for (solve, tolerance) in &METHODS[..3] {
        let rest = format!("[effects]\nhardening = \"isotropic\"\n[solve]\nuntil = 2e-4\n{solve}\n");
        let left = format!("kind = \"velocity\"\nvalue = \"{omega} rad/s\"");
        let scene = scene(&tube("diameter = \"26 mm\"\nwall = \"1 mm\""), &left, "kind = \"free\"", &rest);
        let (summary, _, _folder) = run_to_file(&scene);
        let time = summary.end_time_s;
        let get = |name: &str| summary.figures.get(&[], name).unwrap_or_else(|| panic!("{solve}: no {name}"));
        let permanent = -(behind - stress / 80e9) * plastic * time / radius;
        println!(
            "{solve}: {:e} {permanent:e}, {:e} {:e}",
            get("permanent_twist"),
            get("angle_of_twist"),
            -omega * time
        );
        assert!((get("permanent_twist") / permanent - 1.0).abs() < 3.0 * tolerance, "{solve}");
        // The right end has not moved yet.
        assert!((get("angle_of_twist") / (-omega * time) - 1.0).abs() < *tolerance, "{solve}");
        let whole = summary.figures.0.iter().find(|group| group.path.is_empty()).expect("the bar");
        let profile = &whole.profile.as_ref().expect("a profile").values;
        let of_profile = profile.iter().sum::<f64>() / profile.len() as f64 / radius;
        assert!((get("permanent_twist") / of_profile - 1.0).abs() < 1e-9, "{solve}");
        assert!(summary.figures.get(&[], "permanent_elongation").is_none(), "{solve}");
    }
}

/// A step from solid to bored: T and omega are continuous, and J determines the reflection.
#[test]
fn a_change_of_bore_reflects_as_the_polar_moments_say() {
    let text = "[bar]\nmode = \"torsion\"\n[[bar.segment]]\nlength = 0.5\ndiameter = 0.02\nmaterial = MAT\n\
                [[bar.segment]]\nlength = 0.5\ndiameter = 0.02\ninner-diameter = 0.015\nmaterial = MAT\n\
                [left]\nkind = \"torque\"\nvalue = 10\n[right]\nkind = \"free\"\n\
                [solve]\nuntil = 2.2e-4\nmethod = \"moc\"\n[record]\nframes = 1\nfields = [\"torque\"]\n";
    let material = format!("{{ name = \"s\", loading = \"shear\", {TABLE} }}");
    let (_, file, _folder) = run_to_file(&parse(&text.replace("MAT", &material)));
    let row = row_of(&file, Field::Torque, 0);
    let ratio = 1.0 - 0.75_f64.powi(4);
    let passed = 10.0 * 2.0 * ratio / (1.0 + ratio);
    for x in [450, 499, 500, 600] {
        assert!((row[x] / passed - 1.0).abs() < 1e-12, "{} {passed}", row[x]);
    }
}

/// Tables made from a law are converted at their rows only: knots between them would stiffen.
#[test]
fn kinematic_hardening_takes_laws_in_shear() {
    for material in ["\"titanium-6al-4v-jc\"", "\"aluminium-1100-o\""] {
        let bar = format!(
            "mode = \"torsion\"\nshear = \"von-mises\"\nlength = 1\ndiameter = 0.02\ninner-diameter = 0.017\nmaterial = {material}"
        );
        let rest = "[effects]\nhardening = \"kinematic\"\n[solve]\nuntil = 1e-4\ncells = 100\n";
        let scene = scene(&bar, "kind = \"velocity\"\nvalue = 100", "kind = \"free\"", rest);
        assert!(scene.bar.segments[0].material.table_error > 0.0, "{material}");
    }
}

#[test]
fn a_tension_material_is_converted_only_if_that_is_said() {
    let bar = |more: &str| {
        format!(
            "mode = \"torsion\"\nlength = 1\ndiameter = 0.02\n{more}\nmaterial = {{ name = \"t\", poisson = 0.25, density = 7800, \
             modulus = 200e9, beyond = \"extend\", curve = {{ table = [[0.001, 200e6], [0.1, 400e6]] }} }}"
        )
    };
    let end = "kind = \"free\"";
    let text = |bar: &str| format!("[bar]\n{bar}\n[left]\n{end}\n[right]\n{end}\n[solve]\nuntil = 1e-4\n");
    let refused = Scene::parse("s.toml", &text(&bar("")), Path::new("."), &[]).expect_err("tension");
    assert!(refused.to_string().contains("has a tension curve"), "{refused}");
    let scene = parse(&text(&bar("shear = \"von-mises\"")));
    let material = &scene.bar.segments[0].material;
    assert_eq!(material.loading, Loading::Shear);
    assert!((material.modulus - 80e9).abs() < 1.0);
    // True stress at the engineering strain 0.001.
    assert!((material.tension.elastic_limit(material.modulus).1 - 200.2e6 / 3.0_f64.sqrt()).abs() < 1.0);
    assert_eq!(scene.resolved_json()["bar"]["mode"], "torsion");
}

/// Nominal stress of an elastic-perfectly-plastic rod of many layers, each with its own plastic strain.
struct Layers {
    stress: Vec<f64>,
    strain: f64,
}

const G: f64 = 80e9;
const TAU: f64 = 160e6;

impl Layers {
    fn new() -> Self {
        Self { stress: vec![0.0; 2000], strain: 0.0 }
    }

    fn place(&self, i: usize) -> f64 {
        (i as f64 + 0.5) / self.stress.len() as f64
    }

    fn turn_to(&mut self, strain: f64) -> f64 {
        let step = strain - self.strain;
        self.strain = strain;
        let mut moment = 0.0;
        for i in 0..self.stress.len() {
            let s = self.place(i);
            self.stress[i] = (self.stress[i] + G * s * step).clamp(-TAU, TAU);
            moment += self.stress[i] * s * s / self.stress.len() as f64;
        }
        4.0 * moment
    }
}

/// Effect of the residual stress pattern of a rod, which the nominal curve does not include. Twisted to five times its yield strain and back, a rod
/// of layers unloads elastically over twice the yield stress (beyond zero torque), and then yields gradually.
#[test]
fn the_pattern_of_stress_that_a_rod_keeps_is_felt_only_past_zero_torque() {
    let curve = Curve::new(&[(TAU / G, TAU), (0.5, TAU)], Beyond::Extend).expect("rows rise");
    let mut shear = Material::from_curve("s", 7800.0, curve).expect("a material");
    shear.loading = Loading::Shear;
    let rod = shear.in_torsion(TubeSection { q: 0.0 }).expect("a curve");
    let segment = barwave::bar::Segment::new(1.0, 1.0, rod);
    let top = 5.0 * TAU / G;
    let path = |rule: HardeningRule| {
        let effects = Effects { hardening: Some(rule), ..Effects::default() };
        let law = assemble::segment_law(&segment, &effects).law;
        let (mut sigma, mut state) = ([0.0], vec![0.0; law.state_len()]);
        let (mut layers, mut strain) = (Layers::new(), 0.0);
        // Largest differences in loading, in unloading to zero torque, and in reverse loading to the same strain.
        let mut worst = [0.0_f64; 3];
        for i in 1..=3000 {
            let next = if i <= 1000 { top * f64::from(i) / 1000.0 } else { top * (1.0 - f64::from(i - 1000) / 1000.0) };
            let v = &[strain, next];
            let flow = &mut [0.0];
            let row = Row { gain: G, v, sigma: &mut sigma, work: None, onset_correction: None, flow, cells: 0..1 };
            law.advance(row, &mut state);
            strain = next;
            let truth = layers.turn_to(next);
            let part = if i <= 1000 {
                0
            } else if truth > 0.0 {
                1
            } else {
                2
            };
            worst[part] = worst[part].max((sigma[0] - truth).abs() / TAU);
        }
        worst
    };
    let (isotropic, kinematic) = (path(HardeningRule::Isotropic), path(HardeningRule::Kinematic));
    println!("isotropic {isotropic:?}, kinematic {kinematic:?}");
    for worst in [isotropic, kinematic] {
        // Loading and unloading to zero torque: the tolerance of the table (1e-4 of 4/3), and 1e-4 of the layers.
        assert!(worst[0] < 4e-4 && worst[1] < 4e-4, "{worst:?}");
    }
    // Twisted as far in the other sense, as docs/guide/bars.md states: isotropic hardening yields too late, with an error of at most 0.28 of the
    // yield stress; kinematic hardening is correct: the layers are parallel elements.
    assert!((isotropic[2] - 0.28).abs() < 0.01 && kinematic[2] < 4e-4, "{isotropic:?} {kinematic:?}");
}

/// The constants of rate laws must be converted from tension, too: otherwise, a tube twisted at 1000 1/s has 35 % too much stress with Zerilli and
/// Armstrong's law.
#[test]
fn von_mises_rule_converts_rate_laws_as_well() {
    let (modulus, yields, twisting) = (208e9_f64, 277e6_f64, 1000.0_f64);
    let (c1, c3, c4, temperature) = (1e9_f64, 7e-3_f64, 4e-4_f64, 293.0_f64);
    let rate = twisting / 3.0_f64.sqrt();
    let thermal = |rate: f64| c1 * (-c3 * temperature + c4 * temperature * rate.ln()).exp();
    let laws = [
        ("{ model = \"malvern\", k = 2e6 }", modulus * rate / 2e6),
        ("{ model = \"cowper-symonds\", D = 40, q = 5 }", yields * (rate / 40.0).powf(0.2)),
        ("{ model = \"johnson-cook\", C = 0.014, reference = 1 }", 0.014 * yields * rate.ln()),
        (
            "{ model = \"zerilli-armstrong\", C1 = 1e9, C3 = 7e-3, C4 = 4e-4, reference = 1e-3 }",
            thermal(rate) - thermal(1e-3),
        ),
    ];
    for (law, excess) in laws {
        let omega = twisting * 0.01 / 9.5e-3;
        let bar = format!(
            "mode = \"torsion\"\nshear = \"von-mises\"\nlength = 0.01\ndiameter = 0.02\nwall = 1e-3\n\
             velocity = [[0, 0], [0.01, {omega}]]\n\
             material = {{ name = \"s\", density = 7800, modulus = {modulus}, poisson = 0.3, measure = \"true\", \
             beyond = \"extend\", curve = {{ table = [[0, 0], [{}, {yields}], [0.5, {yields}]] }}, \
             heat = {{ reference-temperature = {temperature} }} }}",
            yields / modulus
        );
        let right = format!("kind = \"velocity\"\nvalue = {omega}");
        for method in ["fd", "moc"] {
            let rest = format!("[effects]\nrate = {law}\n[solve]\nuntil = 6e-5\nmethod = \"{method}\"\ncells = 40");
            let [stress, ..] = fields(&scene(&bar, "kind = \"fixed\"", &right, &rest));
            let expected = (yields + excess) / 3.0_f64.sqrt();
            for stress in stress {
                assert!((stress / expected - 1.0).abs() < 2e-3, "{law} by {method}: {stress:e} for {expected:e}");
            }
        }
    }
}

/// The audit must not recommend effects that torsion does not support.
#[test]
fn no_advice_is_given_that_torsion_refuses() {
    let bar = "mode = \"torsion\"\nshear = \"von-mises\"\nlength = 0.3\ndiameter = 0.02\nmaterial = \"steel-1006-jc\"";
    let left = "kind = \"velocity\"\nvalue = \"8000 rad/s\"";
    let rest = "[effects]\nhardening = \"isotropic\"\n[solve]\nuntil = 2e-4\ncells = 100\naudit-tolerance = 1e-4\n";
    let twisted = scene(bar, left, "kind = \"free\"", rest);
    let summary = run(&twisted, None, &mut |_| ControlFlow::Continue(())).unwrap_or_else(|e| panic!("{e}"));
    let heat = summary.audit.iter().find(|row| row.effect == "heat").expect("an estimate");
    assert!(
        heat.estimate > 1e-3 && heat.remedy.is_empty() && heat.finding.contains("not simulated together with torsion")
    );
    assert!(summary.audit.iter().all(|row| !row.remedy.contains("rupture") && !row.remedy.contains("lateral")));
}

/// The error states the allowed diameter, and not the given one.
#[test]
fn a_thin_tube_beside_a_rod_is_told_its_mean_diameter() {
    let material = format!("material = {{ name = \"s\", loading = \"shear\", {TABLE} }}");
    let text = format!(
        "[bar]\nmode = \"torsion\"\n[[bar.segment]]\nlength = 1\ndiameter = 0.02\n{material}\n[[bar.segment]]\nlength = 1\n\
         diameter = 0.02\nwall = 1e-3\n{material}\n[left]\nkind = \"free\"\n[right]\nkind = \"free\"\n[solve]\nuntil = 1e-5\n"
    );
    let parsed = |text: &str| Scene::parse("torsion.toml", text, Path::new("."), &[]);
    let error = parsed(&text).expect_err("two radii").to_string();
    assert!(error.contains("the mean diameter here is 0.019 m, that of the first segment 0.02 m"), "{error}");
    assert!(parsed(&text.replace("diameter = 0.02\nwall", "diameter = 0.021\nwall")).is_ok());
}
