//! Distributed forces along the bar (damping, foundation, lateral inertia) against exact standing waves, and their energy balance.

use crate::common;

use std::f64::consts::PI;
use std::sync::Arc;

use barwave::assemble::segment_law;
use barwave::bar::{Bar, EndCondition, Segment};
use barwave::material::Material;
use barwave::record::Ledger;
use barwave::scene::{Effects, HardeningRule, Method, Scene};
use barwave::solver::fd::{DistributedForces, Grid, Leapfrog, Quantity};

const LENGTH: f64 = 1.0;
/// Cross-section, m^2.
const AREA: f64 = 0.01;
/// Largest velocity of a standing wave, m/s, far below yield.
const SPEED: f64 = 0.1;

fn c0() -> f64 {
    (common::MODULUS / common::DENSITY).sqrt()
}

fn nothing() -> DistributedForces {
    DistributedForces { lateral: vec![0.0], ..DistributedForces::default() }
}

fn internal(internal: f64) -> DistributedForces {
    DistributedForces { internal, ..nothing() }
}

fn external(external: f64) -> DistributedForces {
    DistributedForces { external, ..nothing() }
}

fn foundation(foundation: f64) -> DistributedForces {
    DistributedForces { foundation, ..nothing() }
}

fn friction(friction: f64) -> DistributedForces {
    DistributedForces { friction, ..nothing() }
}

fn lateral(square: f64) -> DistributedForces {
    DistributedForces { lateral: vec![square], ..nothing() }
}

fn bar_of(
    segments: Vec<Segment>,
    ends: [EndCondition; 2],
    along: &DistributedForces,
    cells: usize,
    cfl: f64,
) -> Leapfrog {
    let effects = Effects { hardening: Some(HardeningRule::Isotropic), ..Effects::default() };
    let laws = segments.iter().map(|s| segment_law(s, &effects)).collect();
    let count = segments.len();
    let lateral = along.lateral.iter().copied().cycle().take(count).collect();
    let bar = Bar { segments, area_given: true };
    let grid = Grid::new(&bar, cells, cfl);
    Leapfrog::with_along(&bar, grid, laws, ends, &DistributedForces { lateral, ..along.clone() })
}

fn piece(material: &Arc<Material>, length: f64, velocity: f64) -> Segment {
    Segment::new(length, AREA, material.clone()).with_velocity(velocity)
}

/// Returns a bar whose initial velocity is `half_waves` half-waves of a sine between fixed ends, or of a cosine between free ends. Every cell is
/// a segment of its own.
fn standing(half_waves: f64, fixed: bool, cells: usize, cfl: f64, along: &DistributedForces) -> Leapfrog {
    let material = Arc::new(common::elastic_steel());
    let dx = LENGTH / cells as f64;
    let k = half_waves * PI / LENGTH;
    let segment = |i: usize| {
        let phase = k * (i as f64 + 0.5) * dx;
        // With lateral inertia, an end that stops suddenly would excite vibrations, so the end cells start at rest.
        let at_fixed_end = fixed && along.lateral[0] > 0.0 && (i == 0 || i + 1 == cells);
        let shape = if fixed { phase.sin() } else { phase.cos() };
        piece(&material, dx, if at_fixed_end { 0.0 } else { SPEED * shape })
    };
    let end = if fixed { EndCondition::Fixed } else { EndCondition::Free };
    bar_of((0..cells).map(segment).collect(), [end.clone(), end], along, cells, cfl)
}

/// Returns the amplitude of the stress of a standing wave, by projection on the shape of its strain.
fn amplitude(bar: &Leapfrog, half_waves: f64, fixed: bool) -> f64 {
    let stress = common::profile(bar, Quantity::Stress);
    let n = stress.len() as f64;
    let k = half_waves * PI / LENGTH;
    let shape = |i: usize| {
        let phase = k * (i as f64 + 0.5) / n * LENGTH;
        if fixed { phase.cos() } else { -phase.sin() }
    };
    stress.iter().enumerate().map(|(i, s)| s * shape(i)).sum::<f64>() * 2.0 / n
}

/// Standing wave with initial velocities and no initial strain: the modal mass m, damping c and stiffness s in m q'' + c q' + s q = 0 with q(0) = 0
/// and q'(0) = `SPEED`. The amplitude of the strain is k q.
struct Mode {
    mass: f64,
    damping: f64,
    stiffness: f64,
}

impl Mode {
    fn of(half_waves: f64, along: &DistributedForces) -> Self {
        let k = half_waves * PI / LENGTH;
        Self {
            mass: common::DENSITY * (1.0 + along.lateral[0] * k * k),
            damping: along.internal * k * k + along.external / AREA,
            stiffness: common::MODULUS * k * k + along.foundation / AREA,
        }
    }

    fn place(&self, time: f64) -> f64 {
        let decay = 0.5 * self.damping / self.mass;
        let omega = (self.stiffness / self.mass - decay * decay).sqrt();
        SPEED * (-decay * time).exp() * (omega * time).sin() / omega
    }
}

/// Returns the largest error of the stress amplitude over two elastic periods, relative to E k SPEED/omega.
fn mode_error(half_waves: f64, fixed: bool, cells: usize, cfl: f64, along: &DistributedForces) -> f64 {
    let mut bar = standing(half_waves, fixed, cells, cfl, along);
    let mode = Mode::of(half_waves, along);
    let k = half_waves * PI / LENGTH;
    let until = 2.0 * 2.0 * LENGTH / half_waves / c0();
    let mut worst = 0.0_f64;
    while bar.time() < until {
        bar.advance();
        let exact = common::MODULUS * k * mode.place(bar.time());
        worst = worst.max((amplitude(&bar, half_waves, fixed) - exact).abs());
    }
    worst / (common::DENSITY * c0() * SPEED)
}

/// Checks that the errors with 20, 40 and 80 cells decrease at least as cells^-1.9, and that the last one is below `bound`.
fn assert_second_order(what: &str, half_waves: f64, fixed: bool, along: &DistributedForces, bound: f64) {
    for cfl in [1.0, 0.6] {
        let errors = [20, 40, 80].map(|cells| mode_error(half_waves, fixed, cells, cfl, along));
        println!("{what}, cfl {cfl}: {errors:?}");
        for pair in errors.windows(2) {
            let order = (pair[0] / pair[1]).log2();
            assert!(order > 1.9, "{what}, cfl {cfl}: order {order:.2} of {errors:?}");
        }
        assert!(errors[2] < bound, "{what}, cfl {cfl}: {errors:?}");
    }
}

/// The damping reduces the amplitude to about a fifth in the two periods that are simulated.
#[test]
fn internal_damping_is_exact_to_second_order() {
    // The amplitude decays with the rate c1 k^2/(2 rho), over the time 4 L/c0.
    assert_second_order("internal", 1.0, true, &internal(2.5e6), 1e-3);
    assert_second_order("internal, free ends", 2.0, false, &internal(1e6), 5e-3);
}

#[test]
fn external_damping_is_exact_to_second_order() {
    // The decay rate c2/(2 rho A) is 2000 1/s, the period 0.4 ms.
    assert_second_order("external", 1.0, true, &external(3e5), 1e-3);
    assert_second_order("external, free ends", 1.0, false, &external(3e5), 1e-3);
}

#[test]
fn a_foundation_disperses_to_second_order() {
    // k/(rho A) is as large as c0^2 k^2.
    let along = foundation(common::MODULUS * AREA * PI * PI);
    assert_second_order("foundation", 1.0, true, &along, 2e-3);
    assert_second_order("foundation, free ends", 1.0, false, &along, 2e-3);
}

#[test]
fn lateral_inertia_disperses_to_second_order() {
    // nu r k = 0.3.
    let along = lateral((0.3 / PI).powi(2));
    assert_second_order("Love", 1.0, true, &along, 1e-3);
    assert_second_order("Love, free ends", 1.0, false, &along, 1e-3);
}

#[test]
fn all_together_are_of_second_order() {
    let along = DistributedForces { internal: 5e5, external: 1e5, foundation: 5e9, ..lateral((0.2 / PI).powi(2)) };
    assert_second_order("all", 1.0, true, &along, 1e-3);
    assert_second_order("all, free ends", 1.0, false, &along, 1e-3);
}

/// The phase velocity of a Love rod, `c0/sqrt(1 + nu^2 r_p^2 k^2)`, is that of the period of a standing wave to 1e-3.
#[test]
fn the_love_rod_has_its_phase_speed() {
    // A round steel bar of 40 mm and 1 m: r_p = 14.1 mm, nu = 0.29.
    let square = (0.29 * 0.02 / 2f64.sqrt()).powi(2);
    for half_waves in [1.0, 5.0, 20.0, 50.0, 100.0] {
        let cells = 2000;
        let mut bar = standing(half_waves, true, cells, 1.0, &lateral(square));
        let k = half_waves * PI / LENGTH;
        let expected = c0() / (1.0 + square * k * k).sqrt();
        // Zeros of the amplitude are half a period apart.
        let (mut zeros, mut before) = (Vec::new(), 0.0);
        while zeros.len() < 3 {
            bar.advance();
            let now = amplitude(&bar, half_waves, true);
            if before * now < 0.0 {
                zeros.push(bar.time() - bar.grid().dt * now / (now - before));
            }
            before = now;
        }
        let speed = PI / k / (0.5 * (zeros[2] - zeros[0]));
        println!("k = {k:.1}: {speed:.3} m/s, exact {expected:.3}, off by {:.1e}", speed / expected - 1.0);
        assert!((speed / expected - 1.0).abs() < 1e-3, "k = {k}: {speed} for {expected}");
        assert!(half_waves < 50.0 || expected < 0.93 * c0(), "no dispersion to speak of");
    }
}

/// Returns the plastic strain of the face, in bilinear steel. With lateral inertia, the face under a stress p acts as a mass on a spring: the total
/// force of the bar there is that of p, so that rho (nu r)^2 d^2(strain)/dt^2 = p - stress, independent of the rest of the bar.
fn plastic_strain_of_the_face(square: f64, pressure: impl Fn(f64) -> f64, until: f64) -> f64 {
    let (steps, tangent) = (200_000, 20e9);
    let (hardening, dt) = (common::MODULUS * tangent / (common::MODULUS - tangent), until / f64::from(steps));
    let (mut rate, mut stress, mut plastic) = (0.0, 0.0, 0.0);
    for step in 0..steps {
        rate += dt * (pressure(f64::from(step) * dt) - stress) / (common::DENSITY * square);
        let tried: f64 = stress + common::MODULUS * rate * dt;
        let flow = (tried.abs() - common::YIELD - hardening * plastic).max(0.0) / (common::MODULUS + hardening);
        stress = tried - (common::MODULUS * flow).copysign(tried);
        plastic += flow;
    }
    plastic
}

/// The plastic strain of the first cells converges to that of the face. The grid filter must not remove momentum of their lateral motion in every
/// step: otherwise the plastic strain of the first cell decreases with the cell size, and that of its neighbours increases.
#[test]
fn cells_at_a_loaded_end_flow_as_its_face_does_with_lateral_inertia() {
    let (square, top) = (0.01 * 0.01, 400e6);
    let (rise, until) = (20e-6, 60e-6);
    let sudden = |_: f64| top;
    let pulse = |t: f64| top * (1.0 - (t / rise - 1.0).abs()).max(0.0);
    let exact = [plastic_strain_of_the_face(square, sudden, until), plastic_strain_of_the_face(square, pulse, until)];
    // A sudden stress strains the face until its work equals that of the curve: 0.001 Y/2 + Y e + Et e^2/2 = p (0.001 + e).
    let above: f64 = top - common::YIELD;
    let e = (above + (above.powi(2) + 2.0 * 20e9 * 0.001 * (top - 0.5 * common::YIELD)).sqrt()) / 20e9;
    assert!((exact[0] / (0.9 * e) - 1.0).abs() < 1e-3, "{} for {}", exact[0], 0.9 * e);
    let loads = [common::loaded_by(&[(0.0, -top)]), common::loaded_by(&[(0.0, 0.0), (rise, -top), (2.0 * rise, 0.0)])];
    for (load, exact) in loads.into_iter().zip(exact) {
        let errors = [1000, 2000, 4000].map(|cells| {
            let segments = vec![common::segment(common::bilinear_steel(), 0.4)];
            let mut bar = bar_of(segments, [load.clone(), EndCondition::Free], &lateral(square), cells, 1.0);
            let mut ledger = Ledger::new(&bar);
            while bar.time() < until {
                bar.advance();
                ledger.row(&bar);
            }
            common::assert_ledger(&ledger, "loaded");
            let strains = common::profile(&bar, Quantity::PlasticStrain);
            strains[..4].iter().map(|strain| (strain.abs() / exact - 1.0).abs()).fold(0.0, f64::max)
        });
        println!("plastic strain {exact:.5}: off by {errors:?}");
        assert!(errors[1] < 0.6 * errors[0] && errors[2] < 0.6 * errors[1] && errors[2] < 0.03, "{errors:?}");
    }
}

#[test]
fn zero_coefficients_are_the_plain_scheme_bit_for_bit() {
    let segments = || vec![common::segment(common::bilinear_steel(), 1.0)];
    let ends = || [common::moved(20.0), EndCondition::Free];
    let mut plain = common::leapfrog(segments(), ends(), Some(HardeningRule::Isotropic), 700, 1.0);
    let mut zero = bar_of(segments(), ends(), &nothing(), 700, 1.0);
    common::advance(&mut plain, 1500);
    common::advance(&mut zero, 1500);
    for quantity in [Quantity::Stress, Quantity::Velocity, Quantity::PlasticStrain] {
        let (here, there) = (common::profile(&plain, quantity), common::profile(&zero, quantity));
        assert!(here.iter().zip(&there).all(|(a, b)| a.to_bits() == b.to_bits()), "{quantity:?}");
    }
    assert_eq!(plain.energies(), zero.energies());
    assert_eq!(plain.state_bytes(), zero.state_bytes());
}

/// With negligible damping, the update of nodes with distributed forces reproduces the bar without them, including plastic waves and grid filter.
#[test]
fn a_tiny_damping_is_the_plain_plastic_bar() {
    let segments = || vec![common::segment(common::bilinear_steel(), 1.0)];
    let ends = || [common::moved(20.0), EndCondition::Free];
    // Up to the first reflection. After two transits, the bar without damping itself changes by 1e-3 in this norm if its Courant number changes by
    // 1e-12, because cells at their yield stress either flow or do not.
    for (steps, bounds) in [(800, [2e-2, 2e-3, 1e-5]), (2500, [2e-2, 3e-3, 2e-3])] {
        let mut plain = common::leapfrog(segments(), ends(), Some(HardeningRule::Isotropic), 1000, 1.0);
        common::advance(&mut plain, steps);
        let stress = common::profile(&plain, Quantity::Stress);
        let total: f64 = stress.iter().map(|s| s.abs()).sum();
        for (size, bound) in [1e-1, 1e-3, 1e-6].into_iter().zip(bounds) {
            let lateral = vec![1e-6 * size];
            let along = DistributedForces {
                internal: 1e4 * size,
                external: 1e4 * size,
                foundation: 1e6 * size,
                lateral,
                ..nothing()
            };
            let mut bar = bar_of(segments(), ends(), &along, 1000, 1.0);
            common::advance(&mut bar, steps);
            let damped = common::profile(&bar, Quantity::Stress);
            let apart = stress.iter().zip(&damped).map(|(a, b)| (a - b).abs()).sum::<f64>() / total;
            let viscous = bar.energies().numerical / plain.energies().numerical;
            println!("{steps} steps, {size:e}: {apart:.1e} apart; ripples took {viscous:.4} of the plain bar's");
            assert!(apart < bound, "{steps} steps, {size:e}: {apart:e}");
        }
    }
}

fn two_segments(velocity: f64) -> Vec<Segment> {
    let mut light =
        common::material(&[(0.002, 140e6), (0.01, 180e6), (0.05, 220e6)], barwave::material::Beyond::Extend);
    light.density = 2700.0;
    let steel = Arc::new(common::bilinear_steel());
    vec![
        piece(&steel, 0.5, velocity),
        Segment { area: 0.5 * AREA, ..piece(&Arc::new(light), 0.3, 0.0) },
        piece(&steel, 0.2, -velocity),
    ]
}

fn mirrored(end: EndCondition) -> EndCondition {
    match end {
        EndCondition::Striker { mass, velocity } => EndCondition::Striker { mass, velocity: -velocity },
        other => other,
    }
}

fn strengths() -> Vec<DistributedForces> {
    let all = |size: f64| DistributedForces {
        internal: 2e4 * size,
        external: 2e4 * size,
        foundation: 1e8 * size,
        ..lateral(1e-5 * size)
    };
    let rubbing = DistributedForces { external: 2e4, foundation: 1e8, ..friction(2e5) };
    let laws = [internal(1e5), external(1e5), foundation(1e9), lateral(3e-5), friction(2e5), friction(1e7), rubbing];
    laws.into_iter().chain([1.0, 1e3, 1e9].map(all)).collect()
}

/// The balances of energy and momentum close to rounding with every kind of end, in elastic and plastic bars of two materials and areas.
#[test]
fn the_ledger_closes_with_every_end() {
    let ends = common::busy_ends(AREA);
    for (k, along) in strengths().iter().enumerate() {
        for (i, left) in ends.iter().enumerate() {
            let right = mirrored(ends[(i + 3) % ends.len()].clone());
            for (velocity, cells) in [(0.0, 300), (8.0, 40), (8.0, 7)] {
                let what = format!("strength {k}, left {left:?}, right {right:?}, {velocity} m/s, {cells} cells");
                let mut bar = bar_of(two_segments(velocity), [left.clone(), right.clone()], along, cells, 1.0);
                let mut ledger = Ledger::new(&bar);
                for _ in 0..4 * cells {
                    bar.advance();
                    ledger.row(&bar);
                }
                assert_eq!(bar.not_finite(), None, "{what}");
                common::assert_ledger(&ledger, &what);
            }
        }
    }
}

/// Damping of any strength only dissipates energy, and the solution remains bounded.
#[test]
fn huge_coefficients_are_stable() {
    let strong =
        [internal(1e7), internal(1e11), internal(1e15), external(1e8), external(1e15), lateral(1.0), lateral(1e6)];
    for along in strong {
        for cells in [5, 64, 300] {
            let mut bar = bar_of(two_segments(5.0), [EndCondition::Free, EndCondition::Free], &along, cells, 1.0);
            let start = bar.initial().kinetic;
            common::advance(&mut bar, 20 * cells);
            let (now, what) = (bar.energies(), format!("{along:?}, {cells} cells"));
            // The energy of the bar never exceeds the initial energy.
            assert!(now.total().is_finite() && now.elastic <= start, "{what}: {} of {start}", now.elastic);
            // The largest impulses are at least 1e4 times those that move a cell, and so is their rounding.
            let rounding =
                if along.internal.max(along.external) > 1e11 || along.lateral[0] > 1e3 { 1e-2 } else { 1e-9 };
            let missing = now.total() / start - 1.0;
            assert!(missing.abs() < rounding, "{what}: {missing:e}");
        }
    }
}

/// A very stiff foundation prevents all motion.
#[test]
fn a_huge_foundation_is_stable() {
    for stiffness in [1e12, 1e16, 1e20] {
        let ends = [common::loaded_by(&[(0.0, -100e6)]), EndCondition::Free];
        let mut bar = bar_of(two_segments(0.0), ends, &foundation(stiffness), 100, 1.0);
        let mut ledger = Ledger::new(&bar);
        for _ in 0..2000 {
            bar.advance();
            ledger.row(&bar);
        }
        // Rounding of forces that are up to 1e9 times those that move a cell.
        assert!(ledger.worst_energy() < 1e-8 && ledger.worst_momentum() < 1e-8, "{stiffness}");
        // The force of 1 MN at the end deflects the half cell next to it, by at most twice the static deflection.
        let expected = -1e6 / (stiffness * 0.5 * bar.grid().segments[0].dx);
        let place = bar.left().displacement().abs();
        assert!(place <= 2.0 * expected.abs() * (1.0 + 1e-9), "{stiffness}: {place} of {expected}");
    }
}

/// A bar in free flight is decelerated by external damping alone, exactly and for damping of any strength.
#[test]
fn drag_slows_a_flying_bar_exactly() {
    let material = Arc::new(common::elastic_steel());
    for drag in [1e3, 1e5, 1e7] {
        let segments = vec![piece(&material, LENGTH, 3.0)];
        let mut bar = bar_of(segments, [EndCondition::Free, EndCondition::Free], &external(drag), 50, 1.0);
        common::advance(&mut bar, 40);
        let half_a_step_on = bar.time() + 0.5 * bar.grid().dt;
        let expected = 3.0 * (-drag / (common::DENSITY * AREA) * half_a_step_on).exp();
        let velocity = bar.left().velocity_after();
        // Rounding of 40 steps. That of the first ones, at 3 m/s, leaves a stress that is visible once the bar has almost stopped.
        let rounding = 1e-12 * expected.max(1e-6);
        assert!((velocity - expected).abs() < rounding, "{drag}: {velocity} for {expected}");
    }
}

/// Two cells that form a rigid link between the ends, so that each end acts on the other without delay.
#[test]
fn short_stiff_bars_move_as_one() {
    let material = Arc::new(common::elastic_steel());
    let segments = vec![piece(&material, 0.01, 0.0)];
    let ends = [common::loaded_by(&[(0.0, -1e6)]), EndCondition::Spring { stiffness: 1e7 }];
    // Lateral inertia and internal damping are so large that no cell is strained.
    let along = DistributedForces { internal: 1e8, ..lateral(0.01) };
    let mut bar = bar_of(segments, ends, &along, 2, 1.0);
    let mut ledger = Ledger::new(&bar);
    let mass = bar.mass();
    let omega = (1e7 / mass).sqrt();
    while bar.time() < 1.0 / omega {
        bar.advance();
        ledger.row(&bar);
    }
    // A rigid mass on a spring under a sudden force of 1e4 N.
    let expected = 1e4 / 1e7 * (1.0 - (omega * bar.time()).cos());
    let (left, right) = (bar.left().displacement(), bar.right().displacement());
    assert!((left / expected - 1.0).abs() < 1e-3 && (right / expected - 1.0).abs() < 1e-3, "{left} {right} {expected}");
    common::assert_ledger(&ledger, "rigid");
}

/// A scene with `rate` and damping uses the grid by default, and its energy balance closes.
#[test]
fn rate_laws_go_with_damping_on_the_grid() {
    let text = "[bar]\nlength = 1\ndiameter = \"30 mm\"\n[bar.material]\nname = \"steel\"\ndensity = 7800\nmodulus = 200e9\n\
                poisson = 0.3\nbeyond = \"extend\"\ncurve = { table = [[0.001, 200e6], [0.021, 600e6]] }\n[left]\n\
                kind = \"velocity\"\nvalue = 20\n[right]\nkind = \"free\"\n[effects]\nlateral-inertia = true\n\
                damping = { internal = \"5 kPa*s\", external = \"50 N*s/m^2\" }\n\
                rate = { model = \"malvern\", k = \"1e6 1/s\" }\n[solve]\nuntil = \"300 us\"\ncells = 500\n";
    let scene = Scene::parse("rate", text, std::path::Path::new("."), &[]).unwrap_or_else(|e| panic!("{e}"));
    assert_eq!(scene.solve.method, Method::Leapfrog { cells: 500, cfl: 1.0 });
    let mut bar = barwave::assemble::leapfrog(&scene, 500, 1.0);
    let mut ledger = Ledger::new(&bar);
    for _ in 0..1500 {
        bar.advance();
        ledger.row(&bar);
    }
    common::assert_ledger(&ledger, "rate");
    let now = bar.energies();
    assert!(now.viscoplastic > 0.0 && now.damping > 0.0 && now.plastic > 0.0 && !bar.stayed_elastic(), "{now:?}");
}
