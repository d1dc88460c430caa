//! What random scenes found: defects that are cured, and rules that explain what looks like one.

use std::ops::ControlFlow;
use std::path::Path;

use barwave::assemble;
use barwave::record::{Field, View};
use barwave::run::run;
use barwave::scene::Scene;
use barwave::solver::Energies;
use barwave::solver::fd::Sampling;

use super::checks::figures_of;
use super::spec::{Keys, Method, Spec, Value};
use super::watch::follow;

const STEEL: &str =
    "{ density = 7800, modulus = 2e11, beyond = \"extend\", curve = { table = [[0.001, 2e8], [0.1, 4e8]] } }";

fn bar(material: &str) -> String {
    format!("[bar]\nlength = 0.19\narea = 1e-4\nmaterial = {material}\n")
}

/// A bar with its right end free.
fn text(bar: &str, left: &str, effects: &str, solve: &str) -> String {
    format!(
        "{bar}[left]\n{left}\n[right]\nkind = \"free\"\n[effects]\n{effects}\n[solve]\n{solve}\n[record]\nframes = 2\n"
    )
}

fn scene(text: &str) -> Scene {
    Scene::parse("found.toml", text, Path::new("."), &[]).unwrap_or_else(|e| panic!("{e}\n{text}"))
}

/// The static stress is 0 at the origin, over which an overstress has no ratio: a panic.
#[test]
fn a_curve_that_bends_at_the_origin_flows_by_the_law_of_cowper_and_symonds() {
    let material = "{ density = 4310, modulus = \"3 GPa\", beyond = \"extend\", curve = { table = [[1e-3, 2.5e6], [1e-2, 10e6]] } }";
    let by = |method: &str| {
        let effects = "rate = { model = \"cowper-symonds\", D = 5730, q = 1.39 }";
        let solve = format!("until = 15e-5\nmethod = \"{method}\"\ncells = 200");
        let text = text(&bar(material), "kind = \"velocity\"\nvalue = 3", effects, &solve);
        run(&scene(&text), None, &mut |_| ControlFlow::Continue(())).unwrap_or_else(|e| panic!("{e}")).left.stress
    };
    let [grid, net] = [by("fd"), by("moc")];
    assert!((grid / net - 1.0).abs() < 0.01, "{grid:e} {net:e}");
}

/// A first slope that is the modulus to rounding was one of hardening, and the elastic limit 0.
#[test]
fn a_first_slope_within_rounding_of_the_modulus_is_elastic() {
    let text =
        text(&bar(&STEEL.replace("2e8]", "1.9999999999e8]")), "kind = \"velocity\"\nvalue = 1", "", "until = 9e-5");
    let summary = run(&scene(&text), None, &mut |_| ControlFlow::Continue(())).unwrap_or_else(|e| panic!("{e}"));
    assert!(summary.effects.is_empty(), "{:?}", summary.effects);
}

/// The work of the end was that of its node, not that of the motion imposed: 13 % of the energy was missing.
#[test]
fn a_sudden_stress_that_makes_the_bar_yield_keeps_its_account() {
    for (material, stress) in [("\"copper-annealed\"", 112e6), (STEEL, 250e6)] {
        for velocity in ["", "velocity = 36.8\n"] {
            for cfl in [1.0, 0.7] {
                let solve = format!("until = 1e-4\ncells = 80\ncfl = {cfl}");
                let left = format!("kind = \"stress\"\nvalue = {stress}");
                let text = text(&format!("{}{velocity}", bar(material)), &left, "unloading = \"isotropic\"", &solve);
                let mut failures = Vec::new();
                follow(&scene(&text), 1e-4, &mut failures);
                assert!(failures.is_empty(), "{material} {velocity} {cfl}: {:?}", failures[0]);
            }
        }
    }
}

/// The bar behind the first joint was set in motion long before a wave came there, by a second copy of the fan of the end.
#[test]
fn the_fan_of_an_end_stays_in_its_segment() {
    let part = "[[bar.segment]]\nlength = 0.5\narea = 1e-4\nmaterial = \"copper-annealed\"\n";
    let solve = "until = 20e-6\ncells = 200";
    let left = "kind = \"velocity\"\nvalue = 20";
    let whole = part.replace("[[bar.segment]]", "[bar]").replace("0.5", "1");
    let profile = |bar: &str| {
        let scene = scene(&text(bar, left, "unloading = \"isotropic\"", solve));
        let barwave::scene::Method::Leapfrog { cells, cfl } = scene.solve.method else {
            panic!("{:?}", scene.solve.method)
        };
        let mut bar = assemble::leapfrog(&scene, cells, cfl);
        while View::time(&bar) < scene.solve.until {
            bar.advance_by(1);
        }
        let mut values = vec![0.0; bar.grid().cells()];
        bar.sample(Field::Velocity, &Sampling::cells(bar.grid()), &mut values);
        values
    };
    let (one, two) = (profile(&whole), profile(&part.repeat(2)));
    let most = one.iter().zip(&two).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    assert!(two[100..].iter().all(|&v| v == 0.0) && most < 1e-9, "{most}");
}

/// A taper so slight that front tracking makes it of one piece was cut into infinitely many for the estimate of the error: a panic.
#[test]
fn a_taper_of_one_piece_is_tracked() {
    let bar = bar(STEEL).replace("1e-4", "[[0, 7.1e-5], [0.19, 6.98e-5]]");
    let solve = "until = 5e-5\nmethod = \"moc\"\nfront-tolerance = 1e-3";
    let text = text(&bar, "kind = \"velocity\"\nvalue = 10", "unloading = \"isotropic\"", solve);
    let summary = run(&scene(&text), None, &mut |_| ControlFlow::Continue(())).unwrap_or_else(|e| panic!("{e}"));
    assert!(summary.left.stress < -2e8, "{}", summary.left.stress);
}

fn keys(of: &[(&'static str, Value)]) -> Keys {
    of.to_vec()
}

fn same(text: &str) -> Value {
    Value::Same(text.to_owned())
}

/// A scene of leapfrog with these segments and ends.
fn spec(segments: Vec<Keys>, ends: [Keys; 2], effects: &[(&'static str, Value)], solve: (f64, usize, f64)) -> Spec {
    let (until, cells, cfl) = solve;
    let joints = vec![Keys::new(); segments.len() - 1];
    Spec {
        bar: Keys::new(),
        segments,
        joints,
        ends,
        effects: Some(keys(effects)),
        until,
        cells,
        cfl,
        front_tolerance: 1e-3,
    }
}

fn assert_mirrored(spec: &Spec) {
    let figures = |spec: &Spec| figures_of(&spec.text(Method::Leapfrog, 1)).expect("it runs");
    let differs = figures(spec).mirrored().differs(&figures(&spec.mirrored()));
    assert!(differs.largest() < 1e-9, "{differs:?}");
}

/// While the fan of an end was imposed no ripples spread; in the step after it they went through all blocks at once, but only to the right.
#[test]
fn the_grid_filter_starts_alike_in_the_mirrored_bar() {
    let horn = keys(&[
        ("length", Value::number(0.768)),
        ("area", Value::Taper(vec![(0.0, 0.0016), (0.768, 0.00214)], 0.768)),
        ("velocity", Value::Signed(6.74, "m/s")),
        (
            "material",
            same(
                "{ density = 2300, modulus = \"200 GPa\", beyond = \"rupture\", measure = \"true\", symmetry = \"true\", curve = { formula = \"voce\", yield = \"970 MPa\", saturation = \"2910 MPa\", strain = 0.0755 } }",
            ),
        ),
    ]);
    let rod = keys(&[
        ("length", Value::number(0.496)),
        ("diameter", Value::unit(30.8, "mm")),
        (
            "material",
            same(
                "{ density = 1420, modulus = \"70 GPa\", beyond = \"error\", curve = { table = [[8.22e-4, 5.754e7], [2.11254e-3, 7.154235e7], [1.246974e-2, 1.672428e8], [2.186273e-2, 1.765496e8]] } }",
            ),
        ),
    ]);
    let ends =
        [keys(&[("kind", same("\"fixed\""))]), keys(&[("kind", same("\"stress\"")), ("value", Value::number(1.24e8))])];
    assert_mirrored(&spec(vec![horn, rod], ends, &[("rupture", same("{ energy = 17200 }"))], (3.36e-5, 38, 0.674)));
}

/// Of cells at one stress, as along a level part of a curve, the leftmost broke.
#[test]
fn a_bar_under_level_tension_breaks_alike_in_the_mirrored_bar() {
    let horn = keys(&[
        ("length", Value::number(0.104)),
        ("area", Value::Taper(vec![(0.0, 1.07e-4), (0.052, 1.85e-4), (0.104, 1.09e-4)], 0.104)),
        (
            "material",
            same(
                "{ density = 5670, modulus = \"120 GPa\", curve = { table = [[5.87e-4, 7.0439999e7], [1.2e-3, 7.0439999e7]] } }",
            ),
        ),
        ("velocity", Value::Signed(-15.5, "m/s")),
    ]);
    let rod = keys(&[
        ("length", Value::number(0.327)),
        ("area", Value::Taper(vec![(0.0, 537e-6), (0.327, 811e-6)], 0.327)),
        (
            "material",
            same("{ density = 2250, modulus = \"200 GPa\", curve = { table = [[1.61e-3, 3.22e8], [1.5e-2, 1.6e9]] } }"),
        ),
        ("velocity", Value::Signed(13.9, "m/s")),
    ]);
    let ends = [keys(&[("kind", same("\"free\""))]), keys(&[("kind", same("\"fixed\""))])];
    let effects = [("unloading", same("\"isotropic\"")), ("rupture", same("{ spall = \"26.1 MPa\" }"))];
    assert_mirrored(&spec(vec![horn, rod], ends, &effects, (1e-5, 90, 0.631)));
}

/// Cells that came to their yield stress and flowed by rounding were filtered as flowing ones, others not.
#[test]
fn rounding_of_the_yield_stress_is_no_flow() {
    let horn = keys(&[
        ("length", Value::number(0.0541)),
        ("area", Value::Taper(vec![(0.0, 369e-6), (2.705e-2, 565e-6), (5.41e-2, 364e-6)], 0.0541)),
        (
            "material",
            same(
                "{ density = 5220, modulus = \"70 GPa\", beyond = \"extend\", curve = { table = [[4.57e-3, 3.198999999997e8], [1.2796e-2, 3.198999999997e8]] } }",
            ),
        ),
    ]);
    let rod = keys(&[
        ("length", Value::number(0.114)),
        ("diameter", Value::unit(18.3, "mm")),
        (
            "material",
            same(
                "{ density = 2350, modulus = \"70 GPa\", beyond = \"error\", curve = { table = [[9.69e-4, 6.782999999993e7]] } }",
            ),
        ),
    ]);
    let rows = vec![(0.0, -32.8), (1.55e-6, 22.2), (2.97e-6, -9.78), (4.19e-5, -9.78), (4.19e-5, 32.1)];
    let left = keys(&[
        ("kind", same("\"velocity\"")),
        ("history", Value::SignedRows(rows)),
        ("release", Value::number(4.12e-5)),
    ]);
    let right = keys(&[("kind", same("\"wall\"")), ("gap", Value::unit(9.86e-3, "mm"))]);
    let isotropic = [("unloading", same("\"isotropic\""))];
    assert_mirrored(&spec(vec![horn, rod], [left, right], &isotropic, (8.5e-5, 47, 1.0)));
}

/// The rule of heat: a fraction of all plastic work, that included which a back stress gives back in reverse flow. It then decreases.
#[test]
fn heat_is_a_fraction_of_all_plastic_work() {
    let text = r#"
[[bar.segment]]
length = 0.0629
velocity = "16.6 m/s"
[bar.segment.material]
density = 6190
modulus = "200 GPa"
beyond = "rupture"
heat = { specific-heat = 648, reference-temperature = 293, melting-temperature = 1140, m = 0.745 }
curve = { table = [[2.78e-3, 5.56e8], [6.4774e-3, 5.56e8]] }
[[bar.segment]]
length = 0.07
[bar.segment.material]
density = 4130
modulus = "70 GPa"
beyond = "extend"
heat = { specific-heat = 393, reference-temperature = 293, melting-temperature = 920, m = 1.09 }
curve = { table = [[7.59e-4, 5.313e7], [1.16127e-2, 2.64343e8]] }
[left]
kind = "stress"
value = 321000000
[right]
kind = "velocity"
value = -14.3
[effects]
unloading = { mixed = 0.868 }
heat = { fraction = 0.5 }
[solve]
until = 4.44e-5
method = "fd"
cells = 80
"#;
    let scene = scene(text);
    let barwave::scene::Method::Leapfrog { cells, cfl } = scene.solve.method else {
        panic!("{:?}", scene.solve.method)
    };
    let mut bar = assemble::leapfrog(&scene, cells, cfl);
    let (mut most, mut fall) = (0.0_f64, 0.0_f64);
    while View::time(&bar) < scene.solve.until {
        bar.advance_by(1);
        let Energies { heat, plastic, .. } = bar.account().energies;
        assert!((heat - 0.5 * (heat + plastic)).abs() <= 1e-12 * heat, "{heat:e} and {plastic:e} J");
        most = most.max(heat);
        fall = fall.max(most - heat);
    }
    assert!(fall > 1e-3 * most, "no reverse flow under a back stress: heat falls by {fall:e} of {most:e} J");
}

/// Where the elastic stress of an impact is more than 600 C f above the static curve, nothing flowed on the characteristic net by the law of
/// Johnson and Cook: the bar stayed elastic.
#[test]
fn a_net_flows_by_the_law_of_johnson_and_cook_at_any_overstress() {
    let effects = "rate = { model = \"johnson-cook\", C = 0.00226, reference = \"1 1/s\" }";
    let by = |method: &str, velocity: f64| {
        let solve = format!("until = 4e-6\nmethod = \"{method}\"\ncells = 400");
        let left = format!("kind = \"velocity\"\nvalue = {velocity}");
        let text = text(&bar(STEEL).replace("0.19", "0.0289"), &left, effects, &solve);
        run(&scene(&text), None, &mut |_| ControlFlow::Continue(())).unwrap_or_else(|e| panic!("{e}")).left.stress
    };
    for velocity in [7.0, 30.0] {
        let [grid, net] = [by("fd", velocity), by("moc", velocity)];
        assert!((grid / net - 1.0).abs() < 0.02, "{velocity} m/s: {grid:e} {net:e}");
    }
}

/// A cell that went from compression to flow in tension within a step did plastic work under the mean stress of the step, a negative one.
#[test]
fn a_cell_that_turns_within_a_step_does_no_negative_plastic_work() {
    let text = r#"
[[bar.segment]]
length = 0.0329
diameter = "7.29 mm"
material = { density = 3340, modulus = "3 GPa", beyond = "extend", measure = "true", symmetry = "true", curve = { formula = "ramberg-osgood", yield = "1.1 MPa", n = 9.09 } }
[[bar.segment]]
length = 0.0287
area = [[0, 0.000162], [1.435e-2, 0.000207], [2.87e-2, 0.000293]]
material = { density = 5220, modulus = "70 GPa", beyond = "extend", curve = { table = [[3.77e-4, 2.639e7]] } }
velocity = "25.8 m/s"
[left]
kind = "fixed"
[right]
kind = "velocity"
history = [[0, 0], [1.9e-6, 6.47]]
release = 0.00000114
[effects]
unloading = "isotropic"
[solve]
until = 2.39e-5
cells = 47
"#;
    let scene = scene(text);
    let barwave::scene::Method::Leapfrog { cells, cfl } = scene.solve.method else {
        panic!("{:?}", scene.solve.method)
    };
    let mut bar = assemble::leapfrog(&scene, cells, cfl);
    let (mut most, mut fall, mut energy) = (0.0_f64, 0.0_f64, 0.0_f64);
    while View::time(&bar) < scene.solve.until {
        bar.advance_by(1);
        let energies = bar.account().energies;
        energy = energy.max(energies.kinetic);
        most = most.max(energies.plastic);
        fall = fall.max(most - energies.plastic);
    }
    assert!(fall <= 1e-12 * energy, "plastic work falls by {fall:e} of {energy:e} J");
}

/// The rule that exempts work and impulse of ends above critical: a level curve lets no strain leave an end that is driven beyond it. The
/// end cell of a grid has inertia and moves ever faster, the smaller it is; front tracking knows no such cell. The bars agree.
#[test]
fn what_goes_into_a_place_where_strain_gathers_depends_on_the_cells() {
    let level = "{ density = 7940, modulus = 7e10, curve = { table = [[3.24e-4, 2.268e7], [0.1, 2.268e7]] } }";
    let by = |solve: &str| {
        let left = "kind = \"stress\"\nhistory = [[0, 0], [5.83e-4, -114e6]]";
        let bar = bar(level).replace("0.19", "0.835");
        figures_of(&text(&bar, left, "unloading = \"isotropic\"", &format!("until = 2.2e-4\n{solve}")))
            .expect("it runs")
    };
    let tracked = by("method = \"moc\"");
    for cells in [60, 240] {
        let differs = by(&format!("cells = {cells}")).differs(&tracked);
        assert!(differs.stress < 0.01 && differs.velocity < 0.05, "{cells} cells: {differs:?}");
        assert!(differs.work > 0.2, "{cells} cells: {differs:?}");
    }
}

/// The face of a spring went along with the bar's edge, at 36 m/s, where the bar pressed it with all that its level curve carries: the
/// spring took in 5 times the energy of the bar.
#[test]
fn a_bar_at_its_largest_stress_does_not_push_a_spring_along() {
    let level = "{ density = 1890, modulus = 3e9, curve = { table = [[4.24e-4, 1.272e6], [1e-2, 1.272e6]] } }";
    let bar = format!("{}velocity = -36.2\n", bar(level).replace("0.19", "0.0301").replace("1e-4", "9.73e-4"));
    let solve = "until = 6.46e-5\nmethod = \"moc\"\nfront-tolerance = 1e-2";
    let text = text(&bar, "kind = \"spring\"\nstiffness = 88400000", "unloading = \"isotropic\"", solve);
    let mut failures = Vec::new();
    follow(&scene(&text), 6.46e-5, &mut failures);
    assert!(failures.is_empty(), "{:?}", failures[0]);
}
