//! Initial states that vary along the bar: against exact solutions, and against longer runs that they continue.

use std::f64::consts::PI;
use std::fmt::Write as _;

use barwave::assemble;
use barwave::record::View;
use barwave::solver::fd::Quantity;
use barwave::solver::moc::Settings;

use super::methods::{By, Seen, follow};
use super::{E, HARDENING, IMPEDANCE, YIELD, bar, material, parse, profile, scene, text};

const FREE: &str = "kind = \"free\"";
const SPEED: f64 = 5000.0;
/// Transit time of an elastic wave through the bar of 1 m, s.
const TRANSIT: f64 = 2e-4;
/// Largest step of the staircase in front tracking relative to the largest value, and its mean difference from the table.
const STEP: f64 = 0.01;
const MEAN_OF_STEP: f64 = 0.25;
const FRONT_TOLERANCE: f64 = 1e-3;

/// Returns `key = [[x, value], ...]`.
fn table(key: &str, rows: impl IntoIterator<Item = (f64, f64)>) -> String {
    let rows: Vec<String> = rows.into_iter().map(|(x, value)| format!("[{x:e}, {value:e}]")).collect();
    format!("{key} = [{}]", rows.join(", "))
}

/// Returns a table of values that are constant between `borders`.
fn stairs(key: &str, borders: &[f64], values: &[f64]) -> String {
    let rows = borders.windows(2).zip(values).flat_map(|(pair, &value)| [(pair[0], value), (pair[1], value)]);
    table(key, rows)
}

/// Returns the integral of f from 0 to x for a function that is continued as an odd one about both free ends of a bar of 1 m.
fn integral(inside: &impl Fn(f64) -> f64, x: f64) -> f64 {
    // The integral is even about 0 and 1, with the period 2; it vanishes over a period.
    let rest = x.rem_euclid(2.0);
    inside(if rest <= 1.0 { rest } else { 2.0 - rest })
}

/// Returns stress and velocity of a bar with free ends that starts at rest, at `time`, as means over a cell (m); `inside` is the integral of the
/// initial stress (D'Alembert).
fn dalembert(inside: &impl Fn(f64) -> f64, [from, to]: [f64; 2], time: f64) -> [f64; 2] {
    let shift = SPEED * time;
    let mean = |by: f64| (integral(inside, to + by) - integral(inside, from + by)) / (to - from);
    [0.5 * (mean(shift) + mean(-shift)), 0.5 * (mean(shift) - mean(-shift)) / IMPEDANCE]
}

/// Returns the mean differences of stress relative to `scale` (Pa), and of velocity relative to that of `scale`.
fn apart(seen: &Seen, inside: &impl Fn(f64) -> f64, scale: f64) -> [f64; 2] {
    let count = seen.x.len() as f64;
    let mut sums = [0.0; 2];
    for (i, x) in seen.x.iter().enumerate() {
        let [stress, velocity] = dalembert(inside, [x - 0.5 / count, x + 0.5 / count], seen.time);
        sums[0] += (seen.stress[i] - stress).abs() / scale / count;
        sums[1] += (seen.velocity[i] - velocity).abs() * IMPEDANCE / scale / count;
    }
    sums
}

#[test]
fn a_stress_over_x_sends_half_of_it_both_ways() {
    let top = 150e6;
    // A triangle with its peak at 0.3 m.
    let triangle = |x: f64| {
        let rise = x.min(0.3);
        let fall = (x - 0.3).max(0.0);
        top * (rise * rise / 0.6 + fall - fall * fall / 1.4)
    };
    let time = 3.3 * TRANSIT;
    for by in By::ALL {
        let state = table("stress", [(0.0, 0.0), (0.3, top), (1.0, 0.0)]);
        let state = format!("material = {}\n{state}", by.material(""));
        let text = text(&[(1.0, state)], [FREE, FREE], &by.effects(""), &by.solve_within(time, 200, 1.0));
        let seen = follow(&scene(&text), time);
        let [stress, velocity] = apart(&seen, &triangle, top);
        let allowed = match by {
            // Exact at Courant number 1: the means over the cells are exact, except for the velocities of the cells at the corners, which are means
            // of their nodes.
            By::Leapfrog => [1e-11, 1e-4],
            By::Net => [1e-11; 2],
            // Compared at points instead of means, at 400 samples.
            By::Fronts => [MEAN_OF_STEP * STEP + FRONT_TOLERANCE; 2],
            // Corners are clipped by the slopes of the adjacent cells.
            By::Godunov => [5e-3; 2],
        };
        assert!(stress < allowed[0] && velocity < allowed[1], "{by:?}: {stress:e} {velocity:e}");
        assert!(
            seen.ledger.worst_energy() < 1e-12 && seen.ledger.worst_momentum() < 1e-11,
            "{by:?}: {:?}",
            seen.ledger
        );
    }
}

#[test]
fn a_half_sine_swings_and_its_error_falls_as_the_cells_do() {
    let top = 150e6;
    let inside = |x: f64| top / PI * (1.0 - (PI * x).cos());
    let time = 2.7 * TRANSIT;
    for by in By::ALL {
        let errors = [50, 100, 200].map(|cells| {
            // Rows are much closer than cells.
            let rows = (0..=800).map(|i| f64::from(i) / 800.0).map(|x| (x, top * (PI * x).sin()));
            let state = format!("material = {}\n{}", by.material(""), table("stress", rows));
            let text = text(&[(1.0, state)], [FREE, FREE], &by.effects(""), &by.solve_within(time, cells, 0.8));
            // Half the energy of a bar with the largest stress everywhere.
            let stored = 0.25 * 1e-4 * top * top / E;
            let seen = follow(&scene(&text), time);
            assert!(seen.ledger.worst_energy() < 1e-12, "{by:?}: {:?}", seen.ledger);
            let start = assemble_start(&text);
            // Means over cells lose pi^2/12 divided by the square of their number; leapfrog, whose velocity is known half a step before and after,
            // loses pi^2 cfl^2/4.
            let lost = (PI * PI * (1.0 / 12.0 + 0.16) * 1.05) / (cells * cells) as f64;
            assert!(by == By::Fronts || (start / stored - 1.0).abs() < lost, "{by:?} {cells}: {start} {stored}");
            let [stress, velocity] = apart(&seen, &inside, top);
            stress + velocity
        });
        let order = (errors[0] / errors[2]).log2() / 2.0;
        match by {
            By::Net => assert!(errors[0] < 1e-5, "{errors:?}"),
            By::Fronts => assert!(errors[0] < 0.02, "{errors:?}"),
            _ => assert!(errors[2] < 1e-3 && order > 1.8, "{by:?}: {errors:?} {order}"),
        }
    }
}

/// Returns the energy of a bar at t = 0, J.
fn assemble_start(text: &str) -> f64 {
    struct Energy;
    impl assemble::Task for Energy {
        type Output = f64;

        fn on_grid(self, bar: impl barwave::record::Stepped + barwave::snapshot::Snapshot) -> f64 {
            bar.start().energy
        }

        fn by_fronts(self, _: Settings) -> f64 {
            f64::NAN
        }
    }
    let scene = scene(text);
    if scene.solve.method.tracks_fronts() {
        return assemble::front_tracking(&scene, Settings::default()).start().energy;
    }
    assemble::solve(&scene, Energy)
}

/// A stress end that makes the bar yield twice, and the second pulse alone.
const BOTH: &str = "kind = \"stress\"\nhistory = [[0, -260e6], [6e-5, -260e6], [6e-5, 0], [3e-4, 0], [3e-4, 290e6], [3.5e-4, \
                    290e6], [3.5e-4, 0]]";
const SECOND: &str = "kind = \"stress\"\nhistory = [[0, 0], [1e-4, 0], [1e-4, 290e6], [1.5e-4, 290e6], [1.5e-4, 0]]";
/// The same loads with ramps instead of jumps.
const BOTH_SMOOTH: &str = "kind = \"stress\"\nhistory = [[0, 0], [3e-5, -260e6], [6e-5, -260e6], [9e-5, 0], [3e-4, 0], \
                           [3.3e-4, 290e6], [3.6e-4, 290e6], [3.9e-4, 0]]";
const SECOND_SMOOTH: &str =
    "kind = \"stress\"\nhistory = [[0, 0], [1e-4, 0], [1.3e-4, 290e6], [1.6e-4, 290e6], [1.9e-4, 0]]";
const PART: f64 = 2e-4;
const WHOLE: f64 = 5e-4;

/// Returns the tables of the state of a bar on a grid.
fn state_of(seen: &Seen, accumulated: Option<&[f64]>) -> String {
    let cells = seen.x.len() as f64;
    let borders: Vec<f64> = (0..=seen.x.len()).map(|i| i as f64 / cells).collect();
    let mut state = String::new();
    for (key, values) in [("stress", &seen.stress), ("velocity", &seen.velocity), ("plastic-strain", &seen.plastic)] {
        let _ = writeln!(state, "{}", stairs(key, &borders, values));
    }
    if let Some(values) = accumulated {
        let _ = writeln!(state, "{}", stairs("accumulated-plastic-strain", &borders, values));
    }
    state
}

fn mean_apart(a: &Seen, b: &Seen) -> f64 {
    let stress: f64 = a.stress.iter().zip(&b.stress).map(|(a, b)| (a - b).abs()).sum::<f64>() / YIELD;
    let plastic: f64 = a.plastic.iter().zip(&b.plastic).map(|(a, b)| (a - b).abs()).sum::<f64>() / 1e-3;
    (stress + plastic) / a.stress.len() as f64
}

#[test]
fn a_run_goes_on_from_the_state_in_which_another_one_ended() {
    for (by, hardening) in [
        (By::Leapfrog, "hardening = \"isotropic\""),
        (By::Leapfrog, "hardening = \"kinematic\""),
        (By::Godunov, "hardening = \"isotropic\""),
        (By::Net, "hardening = \"isotropic\""),
    ] {
        let errors = [100, 200, 400, 800].map(|cells| {
            let run = |state: &str, left: &str, until: f64| {
                let state = format!("material = {}\n{state}", by.material(""));
                let solve = by.solve(2.0 * WHOLE, cells);
                follow(&scene(&text(&[(1.0, state)], [left, FREE], &by.effects(hardening), &solve)), until)
            };
            let first = run("", BOTH_SMOOTH, PART);
            assert!(first.plastic.iter().any(|p| *p < -1e-3) && first.plastic.contains(&0.0));
            let next = run(&state_of(&first, None), SECOND_SMOOTH, WHOLE - PART);
            let long = run("", BOTH_SMOOTH, WHOLE);
            assert!(next.ledger.worst_energy() < 1e-12, "{by:?}: {:?}", next.ledger);
            let flowed = long.plastic.iter().zip(&first.plastic).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
            assert!(flowed > 1e-4, "the second pulse makes it flow: {flowed:e}");
            mean_apart(&next, &long)
        });
        let order = (errors[0] / errors[3]).log2() / 3.0;
        let small = errors[2] < 6e-3 && errors[3] < 2e-3;
        assert!(small && (order > 0.8 || errors[0] < 1e-9), "{by:?} {hardening}: {errors:?} {order}");
    }
}

#[test]
fn front_tracking_goes_on_exactly_from_its_own_state() {
    let solve = By::Fronts.solve(WHOLE, 0);
    let effects = "hardening = \"isotropic\"";
    let scene_of = |state: &str, left: &str| {
        let state = format!("material = {}\n{state}", material(YIELD, ""));
        scene(&text(&[(1.0, state)], [left, FREE], effects, &solve))
    };
    let first = scene_of("", BOTH);
    let mut tracked = assemble::front_tracking(&first, Settings { front_tolerance: 0.0, ..Settings::default() });
    tracked.advance_to(PART).expect("it runs");
    let pieces: Vec<_> = tracked.pieces().map(|piece| ([piece.from, piece.to], *piece.point)).collect();
    let mut borders: Vec<f64> = pieces.iter().map(|piece| piece.0[0]).collect();
    borders.push(1.0);
    let values =
        |of: &dyn Fn(&barwave::wave::riemann::Point) -> f64| pieces.iter().map(|p| of(&p.1)).collect::<Vec<f64>>();
    let state = [
        stairs("stress", &borders, &values(&|point| point.stress)),
        stairs("velocity", &borders, &values(&|point| point.velocity)),
        stairs("plastic-strain", &borders, &values(&|point| point.plastic / E)),
        stairs("accumulated-plastic-strain", &borders, &values(&|point| point.accumulated / E)),
    ];
    let next = follow(&scene_of(&state.join("\n"), SECOND), WHOLE - PART);
    let long = follow(&first, WHOLE);
    let apart = mean_apart(&next, &long);
    // A sample may lie between the positions of a front, which differ by rounding.
    assert!(apart < 1e-9, "{apart:e}");
    assert!(next.ledger.worst_energy() < 1e-12, "{:?}", next.ledger);
}

#[test]
fn what_has_flowed_both_ways_has_hardened_though_no_strain_is_left() {
    let flow = YIELD + HARDENING / (1.0 - HARDENING / E) * 0.01;
    for by in By::ALL {
        let state = format!("material = {}\naccumulated-plastic-strain = 0.01", by.material(""));
        let drive = format!("kind = \"velocity\"\nvalue = {}", 0.98 * flow / IMPEDANCE);
        let effects = by.effects("hardening = \"isotropic\"");
        let at = |drive: &str| {
            let text = text(&[(1.0, state.clone())], [drive, FREE], &effects, &by.solve(TRANSIT, 200));
            follow(&scene(&text), 0.9 * TRANSIT).plastic.iter().map(|p| p.abs()).fold(0.0, f64::max)
        };
        // The bar yields only above the raised limit.
        assert_eq!(at(&drive), 0.0, "{by:?}");
        assert!(at(&drive.replace("value = ", "value = 1")) > 1e-3, "{by:?}");
    }
}

#[test]
fn a_table_of_the_whole_bar_is_shared_out_over_its_segments() {
    let rows = [(0.0, 20e6), (0.25, 90e6), (0.4, -30e6), (1.0, 60e6)];
    let part = |state: &str| format!("material = {}\n{state}", material(YIELD, ""));
    let solve = By::Leapfrog.solve(TRANSIT, 200);
    let whole = text(&[(1.0, part(&table("stress", rows)))], [FREE, FREE], "", &solve);
    let parts = text(&[(0.4, part("")), (0.6, part(""))], [FREE, FREE], "", &solve);
    let parts = parts.replacen("[bar]\n", &format!("[bar]\n{}\n", table("stress", rows)), 1);
    let own = text(
        &[
            (0.4, part(&table("stress", rows[..3].iter().copied()))),
            (0.6, part(&table("stress", [(0.0, -30e6), (0.6, 60e6)]))),
        ],
        [FREE, FREE],
        "",
        &solve,
    );
    let [whole, parts, own] = [whole, parts, own].map(|text| follow(&scene(&text), 0.7 * TRANSIT).stress);
    for i in 0..200 {
        assert!((parts[i] - whole[i]).abs() < 1e-5 && (own[i] - whole[i]).abs() < 1e-5, "{i}");
    }
}

#[test]
fn velocities_over_x_start_the_bar_moving() {
    // v = v0 cos(pi x) oscillates between free ends: stress Z v0 sin(pi x) sin(w t).
    let v0 = 3.0;
    let rows: Vec<_> = (0..=400).map(|i| f64::from(i) / 400.0).map(|x| (x, v0 * (PI * x).cos())).collect();
    for by in By::ALL {
        let state = format!("material = {}\n{}", by.material(""), table("velocity", rows.clone()));
        let time = 1.3 * TRANSIT;
        let text = text(&[(1.0, state)], [FREE, FREE], &by.effects(""), &by.solve_within(time, 200, 1.0));
        let seen = follow(&scene(&text), time);
        let exact = |x: f64| -IMPEDANCE * v0 * (PI * x).sin() * (PI * seen.time / TRANSIT).sin();
        let apart =
            seen.x.iter().zip(&seen.stress).map(|(&x, s)| (s - exact(x)).abs()).sum::<f64>() / seen.x.len() as f64;
        assert!(apart < 2e-3 * IMPEDANCE * v0, "{by:?}: {}", apart / IMPEDANCE / v0);
        assert!(seen.ledger.worst_energy() < 1e-12, "{by:?}: {:?}", seen.ledger);
    }
}

#[test]
fn the_balance_closes_with_forces_along_the_bar() {
    let forces = [
        "damping = { external = 2000 }",
        "damping = { internal = 2e5 }",
        "damping = { foundation = 1e9 }",
        "damping = { friction = 2e4 }",
        "lateral-inertia = true",
        "lateral-inertia = true\ndamping = { internal = 1e5, external = 500, foundation = 1e8 }",
    ];
    let ends = [
        FREE,
        "kind = \"fixed\"",
        "kind = \"absorbing\"",
        "kind = \"dashpot\"\ncoefficient = 1000",
        "kind = \"spring\"\nstiffness = 1e7",
        "kind = \"striker\"\nmass = 0.3\nvelocity = 4",
        "kind = \"wall\"",
        "kind = \"stress\"\nvalue = -5e7",
        "kind = \"velocity\"\nvalue = 3",
    ];
    for (force, left) in forces.iter().flat_map(|force| ends.map(|end| (force, end))) {
        let steel = material(YIELD, ", poisson = 0.3");
        let first = format!("material = {steel}\n{}\nvelocity = 2", table("stress", [(0.0, -1.5e8), (0.2, 0.9e8)]));
        let second = format!("material = {steel}\nplastic-strain = 0.004\nstress = 2.1e8");
        let solve = "until = 5e-4\ncells = 50\ncfl = 0.9";
        let effects = format!("hardening = \"isotropic\"\n{force}");
        let seen = follow(&scene(&text(&[(0.3, first), (0.5, second)], [left, FREE], &effects, solve)), 5e-4);
        let (energy, momentum) = (seen.ledger.worst_energy(), seen.ledger.worst_momentum());
        assert!(energy < 1e-11 && momentum < 1e-10, "{force} {left}: {energy:e} {momentum:e}");
    }
}

#[test]
fn a_stressed_bar_on_dampers_and_a_foundation_swings_as_one_mode() {
    // sigma = S sin(pi x), u = -S/(E pi) cos(pi x): an eigenmode of the bar between free ends, also with distributed forces.
    let (top, area, density) = (1e8, 1e-4, 8000.0);
    let wave = PI * SPEED;
    for (force, per_mass, spring, inertia) in [
        ("damping = { external = 4000 }", 4000.0 / (density * area), 0.0, 1.0),
        ("damping = { internal = 3e5 }", 3e5 * PI * PI / density, 0.0, 1.0),
        ("damping = { foundation = 3e8 }", 0.0, 3e8 / (density * area), 1.0),
        ("lateral-inertia = true", 0.0, 0.0, 1.0 + 0.09 * area / (2.0 * PI) * PI * PI),
    ] {
        // u'' + d u' + w^2 u = 0, u(0) = 1, u'(0) = 0. The foundation has no force at t = 0: its displacement is relative to that time, so that it
        // adds an oscillation about another equilibrium.
        let (d, stiffness) = (0.5 * per_mass / inertia, (wave * wave + spring) / inertia);
        let rest = spring / (wave * wave + spring);
        let errors = [50, 100, 200].map(|cells| {
            let rows = (0..=800).map(|i| f64::from(i) / 800.0).map(|x| (x, top * (PI * x).sin()));
            let state = format!("material = {}\n{}", material(YIELD, ", poisson = 0.3"), table("stress", rows));
            let text = text(&[(1.0, state)], [FREE, FREE], force, &format!("until = 6e-4\ncells = {cells}\ncfl = 0.9"));
            let seen = follow(&scene(&text), 5.1e-4);
            let swing = (stiffness - d * d).sqrt();
            let t = seen.time;
            let mode = (-d * t).exp() * ((swing * t).cos() + d / swing * (swing * t).sin());
            let exact = top * (rest + (1.0 - rest) * mode);
            let middle = cells as usize / 2;
            // The cell next to the middle has the mean of the sine there.
            let mean = |x: f64, half: f64| ((PI * (x - half)).cos() - (PI * (x + half)).cos()) / (2.0 * PI * half);
            (seen.stress[middle] - exact * mean(seen.x[middle], 0.5 / f64::from(cells))).abs() / top
        });
        let order = (errors[0] / errors[2]).log2() / 2.0;
        assert!(errors[2] < 1e-3 && order > 1.7, "{force}: {errors:?} {order}");
    }
}

#[test]
fn friction_holds_a_bar_whose_stress_is_below_it() {
    // A stress gradient of -10 MPa per metre exerts a force of 1000 N/m on 1 cm^2.
    let run = |friction: f64| {
        let state =
            format!("material = {}\n{}", material(YIELD, ""), table("stress", [(0.0, 0.0), (0.5, 5e6), (1.0, 0.0)]));
        let effects = format!("damping = {{ friction = {friction} }}");
        follow(&scene(&text(&[(1.0, state)], [FREE, FREE], &effects, "until = 4e-4\ncells = 100")), 5e-5)
    };
    let largest = |seen: &Seen| seen.velocity.iter().fold(0.0, |most: f64, v| most.max(v.abs()));
    assert_eq!(largest(&run(1010.0)), 0.0);
    assert!(largest(&run(900.0)) > 1e-3);
}

const HOT: &str = ", heat = { specific-heat = 460, reference-temperature = 293, melting-temperature = 1793, m = 1 }";

#[test]
fn a_warm_bar_yields_at_the_softened_stress() {
    // Halfway to melting: half the flow stress at its plastic strain.
    let flow = 0.5 * (YIELD + HARDENING / (1.0 - HARDENING / E) * 0.01);
    let state = format!("material = {}\nplastic-strain = -0.01\ntemperature = \"1043 K\"", material(YIELD, HOT));
    let effects = "hardening = \"isotropic\"\nheat = {}";
    let at = |part: f64| {
        let drive = format!("kind = \"velocity\"\nvalue = {}", part * flow / IMPEDANCE);
        let text = text(&[(1.0, state.clone())], [&drive, FREE], effects, "until = 2e-4\ncells = 200");
        let mut bar = bar(&scene(&text));
        (0..150).for_each(|_| bar.advance());
        (profile(&bar, Quantity::PlasticStrain)[20], profile(&bar, Quantity::Temperature))
    };
    let (plastic, temperature) = at(0.99);
    assert_eq!(plastic, -0.01);
    assert!(temperature.iter().all(|t| *t == 1043.0));
    let (plastic, temperature) = at(1.2);
    assert!(plastic < -0.0101 && temperature[20] > 1043.03 && temperature[190] == 1043.0, "{plastic} {temperature:?}");
}

#[test]
fn a_hot_run_goes_on_from_the_state_in_which_another_one_ended() {
    for effects in [
        "hardening = \"isotropic\"\nheat = {}",
        "hardening = \"isotropic\"\nrate = \"material\"\nheat = {}",
        "hardening = \"kinematic\"\nheat = {}",
    ] {
        let errors = [100, 200, 400].map(|cells| {
            let run = |state: &str, left: &str, until: f64| {
                let state = format!(
                    "material = {}\n{state}",
                    material(YIELD, &format!("{HOT}, rate.malvern = {{ k = \"2e6 1/s\" }}"))
                );
                let solve = By::Leapfrog.solve(2.0 * WHOLE, cells);
                let scene = scene(&text(&[(1.0, state)], [left, FREE], effects, &solve));
                let mut bar = bar(&scene);
                while bar.time() < until - 0.5 * bar.grid().dt {
                    bar.advance();
                }
                let read = |quantity| profile(&bar, quantity);
                let seen = follow(&scene, until);
                (seen, read(Quantity::Temperature), read(Quantity::AccumulatedPlasticStrain))
            };
            let (first, temperature, _) = run("", BOTH_SMOOTH, PART);
            let borders: Vec<f64> = (0..=cells).map(|i| i as f64 / cells as f64).collect();
            let state = state_of(&first, None) + &stairs("temperature", &borders, &temperature);
            let (next, after, _) = run(&state, SECOND_SMOOTH, WHOLE - PART);
            let (long, hottest, _) = run("", BOTH_SMOOTH, WHOLE);
            let rise = hottest.iter().map(|t| t - 293.0).fold(0.0, f64::max);
            let apart = after.iter().zip(&hottest).map(|(a, b)| (a - b).abs()).sum::<f64>() / rise / cells as f64;
            assert!(next.ledger.worst_energy() < 1e-12);
            mean_apart(&next, &long) + apart
        });
        let order = (errors[0] / errors[2]).log2() / 2.0;
        assert!(errors[2] < 0.02 && order > 0.7, "{effects}: {errors:?} {order}");
    }
}

#[test]
fn wrong_tables_are_refused_at_their_rows() {
    let of = |state: &str, effects: &str, solve: &str| {
        let state = format!("material = {}\n{state}", material(YIELD, HOT));
        parse(&text(&[(1.0, state)], [FREE, FREE], effects, &format!("until = 1e-4\n{solve}")))
    };
    let isotropic = "hardening = \"isotropic\"";
    for (state, effects, solve, words) in [
        ("stress = [[0, 0], [1.1, 1e6]]", "", "", &["row 2 lies beyond the right end", "0 <= x <= 1 m"][..]),
        ("stress = [[0.5, 0], [0.2, 1e6]]", "", "", &["row 2 has a smaller x than the row before it"]),
        ("stress = [[0.5, 0], [0.5, 1e6], [0.5, 2e6]]", "", "", &["row 3 is the third row with the same x"]),
        ("stress = [[0, 0, 3]]", "", "", &["a row has 3 entries"]),
        ("stress = []", "", "", &["a table over x needs at least one row"]),
        (
            "stress = [[0, 0], [0.5, 2.5e8]]",
            "",
            "",
            &["2.500000e8 Pa at x = 500 mm is outside the elastic range", "-2.000000e8 Pa to 2.000000e8 Pa"],
        ),
        (
            "stress = 3e8\nplastic-strain = [[0, 0.01], [1, 0]]",
            isotropic,
            "",
            &["at x = ", "is outside the elastic range"],
        ),
        ("plastic-strain = [[0, 0.01], [1, 0]]", "", "", &["an initial plastic strain needs a hardening rule"]),
        (
            "plastic-strain = [[0, 0.01]]\naccumulated-plastic-strain = 0.005",
            isotropic,
            "",
            &["is less than the plastic strain, 0.01"],
        ),
        (
            "accumulated-plastic-strain = 0.005",
            "hardening = \"kinematic\"",
            "",
            &["does not determine the elastic range"],
        ),
        ("accumulated-plastic-strain = [[0, -0.1]]", isotropic, "", &["out of range"]),
        ("stress = 1e6\nstrain = 1e-5", "", "", &["`stress` and `strain` are both given"]),
        ("temperature = 400", "", "", &["an initial temperature needs the effect `heat`"]),
        (
            "temperature = [[0, 300], [1, 1800]]",
            "hardening = \"isotropic\"\nheat = {}",
            "",
            &["1800 K at x = 1 m is out of range", "< 1793 K"],
        ),
        (
            "temperature = 400",
            "hardening = \"isotropic\"\nheat = {}",
            "scheme = \"muscl\"",
            &["does not simulate the effect `heat` with an initial temperature or plastic strain"],
        ),
        (
            "plastic-strain = 0.01",
            "hardening = \"isotropic\"\nheat = {}",
            "method = \"moc\"",
            &["does not simulate the effect `heat` with an initial temperature or plastic strain"],
        ),
        ("velocity = { csv = \"none.csv\" }", "", "", &["none.csv"]),
        ("velocity = { file = \"none.csv\" }", "", "", &["file"]),
    ] {
        let error = of(state, effects, solve).expect_err(state);
        assert!(words.iter().all(|words| error.contains(words)), "{state}\n{error}");
    }
    let twisted = "[bar]\nmode = \"torsion\"\nlength = 1\ndiameter = 0.01\nstrain = 1e-4\nmaterial = { density = 8000, modulus \
                   = 8e10, \
                   loading = \"shear\", curve = { table = [[0.001, 8e7]] } }\n[left]\nkind = \"free\"\n[right]\nkind = \
                   \"free\"\n[solve]\nuntil = 1e-4\n";
    assert!(parse(twisted).expect_err("a strain").contains("an initial strain is not available in torsion"));
    let noisy = table("stress", (0..4000).map(|i| (f64::from(i) / 4000.0, if i % 2 == 0 { 0.0 } else { 1e7 })));
    let error = of(&noisy, "", "method = \"moc\"").expect_err("too many steps");
    assert!(error.contains("discretizes the initial state") && error.contains("at most 2000"), "{error}");
}

#[test]
fn tables_come_from_files_with_headed_columns() {
    let folder = std::env::temp_dir().join(format!("barwave-initial-{}", std::process::id()));
    std::fs::create_dir_all(&folder).expect("a folder");
    std::fs::write(folder.join("state.csv"), "x [mm],stress [MPa]\n0,0\n500,100\n1000,-50\n").expect("written");
    std::fs::write(folder.join("wrong.csv"), "x [mm],stress [MPa]\n0,0\n1500,100\n").expect("written");
    std::fs::write(folder.join("headed.csv"), "foo,bar\n0,0\n1,100\n").expect("written");
    let read = |file: &str| {
        let state = format!("material = {}\nstress = {{ csv = \"{file}\" }}", material(YIELD, ""));
        let text = text(&[(1.0, state)], [FREE, FREE], "", "until = 1e-4\ncells = 4");
        barwave::scene::Scene::parse("scene.toml", &text, &folder, &[]).map_err(|error| error.to_string())
    };
    let scene = read("state.csv").expect("it is right");
    assert_eq!(profile(&bar(&scene), Quantity::Stress), [25e6, 75e6, 62.5e6, -12.5e6]);
    let resolved = scene.resolved_json();
    assert_eq!(resolved["bar"]["segment"][0]["initial_over_x"]["stress"][1], serde_json::json!([0.5, 100e6]));
    let wrong = read("wrong.csv").expect_err("beyond the bar");
    assert!(wrong.contains("wrong.csv:3") && wrong.contains("lies beyond the right end"), "{wrong}");
    let headed = read("headed.csv").expect_err("no x");
    assert!(headed.contains("the first column is `foo`, not a place"), "{headed}");
    std::fs::remove_dir_all(&folder).expect("it was there");
}
