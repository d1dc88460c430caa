//! Front tracking against exact rational solutions, self-similar fans, closed forms and its own energy balance.

use crate::common::exact;

use std::sync::Arc;

use barwave::bar::{Bar, EndCondition, History, Segment};
use barwave::law::Table;
use barwave::material::{Beyond, Curve, Material};
use barwave::solver::moc::{EndStep, FrontTracking, Settings, Stopped};
use barwave::wave::riemann::{Flow, Medium, Point, Side, Workspace, solve};
use barwave::wave::similarity::fan_at_velocity;
use exact::{Case, cases, ends, number, numbers};
use proptest::prelude::*;

const ISOTROPIC: Flow = Flow::Plastic { kinematic: 0.0 };
const KINEMATIC: Flow = Flow::Plastic { kinematic: 1.0 };

fn material(rows: &[(f64, f64)], density: f64, beyond: Beyond) -> Arc<Material> {
    Arc::new(
        Material::from_curve("test", density, Curve::new(rows, beyond).expect("rows are right")).expect("a material"),
    )
}

/// Returns a material with `E = rho = sigma_y = 1` and plastic wave speed r.
fn bilinear(r: f64) -> Arc<Material> {
    material(&[(1.0, 1.0), (2.0, 1.0 + r * r)], 1.0, Beyond::Extend)
}

fn pushed(velocity: f64) -> EndCondition {
    EndCondition::Velocity { history: History::constant(velocity), release: None }
}

fn track(segments: Vec<Segment>, flow: Flow, ends: [EndCondition; 2]) -> FrontTracking {
    let bar = Bar { segments, area_given: true };
    FrontTracking::new(&bar, flow, ends, Settings::default())
}

/// Stresses and velocities of the cases are of order 1, so that relative and absolute errors are the same.
#[track_caller]
fn near(value: f64, expected: f64, what: &str) {
    assert!((value - expected).abs() <= 1e-12 * expected.abs().max(1.0), "{what}: {value} is not {expected}");
}

fn check_history(name: &str, steps: &[EndStep], expected: &[[String; 3]]) {
    for (k, (step, row)) in steps.iter().zip(expected).enumerate() {
        let [time, stress, velocity] = numbers(row);
        near(step.time, time, &format!("{name} time of step {k}"));
        near(step.stress, stress, &format!("{name} stress of step {k}"));
        near(step.velocity, velocity, &format!("{name} velocity of step {k}"));
    }
    assert_eq!(steps.len(), expected.len(), "{name}: {steps:?}");
}

fn check_case(case: &Case) {
    let name = &case.name;
    let length = number(&case.length);
    let flow = if case.iso { ISOTROPIC } else { KINEMATIC };
    let bar = Segment::new(length, 1.0, bilinear(number(&case.r))).with_velocity(number(&case.velocity));
    let mut bar = track(vec![bar], flow, ends(case));
    let start = bar.balance();
    bar.advance_to(number(&case.t_final)).expect("few events");
    let [left, right] = bar.ends();
    check_history(&format!("{name} left"), &left.steps, &case.left_history);
    check_history(&format!("{name} right"), &right.steps, &case.right_history);
    // Positions are exact to 1e-12 of the length: just inside a range, its own values apply.
    let inside = |from: f64, to: f64| [from + 1e-12 * length, 0.5 * (from + to), to - 1e-12 * length];
    for row in &case.ep_profile {
        let [from, to, plastic] = numbers(row);
        for x in inside(from, to) {
            near(bar.state_at(x).plastic_strain, plastic, &format!("{name} plastic strain at {x}"));
        }
    }
    for row in &case.state {
        let [from, to, stress, velocity] = numbers(row);
        for x in inside(from, to) {
            near(bar.state_at(x).stress, stress, &format!("{name} stress at {x}"));
            near(bar.state_at(x).velocity, velocity, &format!("{name} velocity at {x}"));
        }
    }
    let sum = bar.balance();
    near(sum.momentum, number(&case.momentum), &format!("{name} momentum"));
    near(sum.kinetic, number(&case.kinetic), &format!("{name} kinetic"));
    near(sum.elastic, number(&case.elastic), &format!("{name} elastic"));
    near(sum.total(), start.total() + sum.work[0] + sum.work[1], &format!("{name} energy"));
    near(sum.momentum, start.momentum + sum.impulse[0] + sum.impulse[1], &format!("{name} impulse"));
}

#[test]
fn every_rational_case_is_met_to_rounding() {
    for case in cases() {
        check_case(case);
    }
}

fn scaled(rows: &[(f64, f64)]) -> Vec<(f64, f64)> {
    rows.iter().map(|&(e, s)| (e, s * 1e6)).collect()
}

/// Checks the fan of a struck end, in both senses, against the one that follows from the curve alone.
fn check_fan(rows: &[(f64, f64)], density: f64, velocity: f64, fronts: usize) {
    let material = material(rows, density, Beyond::Extend);
    let fan = fan_at_velocity(&material.tension, density, velocity);
    assert_eq!(fan.edges.len(), fronts);
    for (flow, sense) in [(ISOTROPIC, 1.0), (KINEMATIC, -1.0), (Flow::PathIndependent, 1.0)] {
        let mut bar = track(
            vec![Segment::new(1.0, 1.0, material.clone())],
            flow,
            [pushed(-sense * velocity), EndCondition::Free],
        );
        let time = 0.8 / material.c0();
        bar.advance_to(time).expect("no meeting");
        let tracked: Vec<_> = bar.fronts().collect();
        assert_eq!(tracked.len(), fan.edges.len());
        for (front, edge) in tracked.iter().rev().zip(&fan.edges) {
            near(front.x / (edge.speed * time), 1.0, "place");
            near(sense * front.behind.stress / edge.stress_behind, 1.0, "stress");
            near(sense * bar.medium(0).strain(&front.behind) / edge.strain_behind, 1.0, "strain");
        }
        let at_end = bar.state_at(0.0);
        near(sense * at_end.stress / fan.stress, 1.0, "stress at the end");
        near(-sense * at_end.velocity / velocity, 1.0, "velocity at the end");
        let sum = bar.balance();
        near(sum.total() / sum.work[0], 1.0, "energy");
        near(sum.momentum / sum.impulse[0], 1.0, "momentum");
    }
}

#[test]
fn fans_are_self_similar() {
    let a = scaled(&[(0.001, 100.0), (0.01, 150.0), (0.05, 230.0), (0.2, 330.0)]);
    check_fan(&a, 8000.0, 74.3, 4);
    check_fan(&a, 8000.0, 11.0, 2);
    // Yield drop: one front from the upper yield point to the tangent point.
    let b = scaled(&[(0.0015, 310.0), (0.0016, 250.0), (0.02, 250.0), (0.1, 380.0), (0.2, 430.0)]);
    check_fan(&b, 7850.0, 62.5, 3);
    check_fan(&b, 7850.0, 20.0, 2);
    // Lock-up: one shock behind the precursor.
    let c = scaled(&[(0.01, 1.0), (0.6, 1.2), (0.7, 5.0), (0.75, 20.0)]);
    check_fan(&c, 200.0, 124.5, 2);
    check_fan(&c, 200.0, 272.2, 2);
}

#[test]
fn bilinear_benchmark_has_its_plateau_and_fronts() {
    let steel = material(&scaled(&[(0.001, 200.0), (0.011, 400.0)]), 7800.0, Beyond::Extend);
    let ends = [pushed(20.0), EndCondition::Free];
    let mut bar = track(vec![Segment::new(1.0, 1.0, steel.clone())], ISOTROPIC, ends);
    let time = 0.8 / steel.c0();
    bar.advance_to(time).expect("no meeting");
    // sigma_y + rho c_t (v - sigma_y/(rho c0))
    let plateau = 200e6 + (20e9_f64 * 7800.0).sqrt() * (20.0 - 200e6 / steel.impedance());
    near(bar.state_at(0.1).stress / -plateau, 1.0, "plateau");
    let places: Vec<f64> = bar.fronts().map(|f| f.x).collect();
    near(places[0], 0.8 * 0.1_f64.sqrt(), "plastic front");
    near(places[1], 0.8, "elastic front");
}

#[test]
fn an_area_step_transmits_twice_a1_over_a1_plus_a2() {
    let steel = material(&scaled(&[(0.01, 2000.0), (0.02, 2100.0)]), 7800.0, Beyond::Extend);
    for area in [0.25, 1.0, 3.0] {
        let segments = vec![Segment::new(1.0, 1.0, steel.clone()), Segment::new(1.0, area, steel.clone())];
        let mut bar = track(segments, ISOTROPIC, [pushed(1.0), EndCondition::Absorbing]);
        bar.advance_to(1.5 / steel.c0()).expect("one meeting");
        let incoming = -steel.impedance();
        near(bar.state_at(1.2).stress / incoming, 2.0 / (1.0 + area), "transmitted");
        near(bar.state_at(0.9).stress / incoming, 2.0 * area / (1.0 + area), "in front of the step");
        let sum = bar.balance();
        near(sum.total() / sum.work[0], 1.0, "energy");
        near(sum.momentum / sum.impulse[0], 1.0, "momentum");
    }
}

#[test]
fn two_materials_share_force_and_velocity() {
    let hard = material(&scaled(&[(0.001, 200.0), (0.1, 600.0)]), 7800.0, Beyond::Extend);
    let soft = material(&scaled(&[(0.0005, 35.0), (0.02, 80.0), (0.2, 120.0)]), 2700.0, Beyond::Extend);
    let segments = vec![Segment::new(0.5, 1e-4, hard.clone()), Segment::new(0.5, 3e-4, soft.clone())];
    let mut bar = track(segments, KINEMATIC, [pushed(8.0), EndCondition::Fixed]);
    // Soon afterwards, two plastic fronts approach each other, and waves bounce between them at increasing frequency.
    bar.advance_to(1.95 / hard.c0()).expect("few events");
    let (left, right) = (bar.state_at(0.5 - 1e-12), bar.state_at(0.5 + 1e-12));
    near(left.stress * 1e-4 / (right.stress * 3e-4), 1.0, "force");
    near(left.velocity / right.velocity, 1.0, "velocity");
    let sum = bar.balance();
    near(sum.total() / (sum.work[0] + sum.work[1]), 1.0, "energy");
    near(sum.momentum / (sum.impulse[0] + sum.impulse[1]), 1.0, "momentum");
}

#[test]
fn an_absorbing_end_takes_elastic_waves_whole() {
    let steel = material(&scaled(&[(0.01, 2000.0), (0.02, 2100.0)]), 7800.0, Beyond::Extend);
    let history = History::new(&[(0.0, -1e8), (1e-4, -1e8), (1e-4, 0.0)]).expect("in order");
    let ends = [EndCondition::Stress { history }, EndCondition::Absorbing];
    let mut bar = track(vec![Segment::new(1.0, 1.0, steel.clone())], ISOTROPIC, ends);
    bar.advance_to(1e-3).expect("few events");
    assert_eq!(bar.fronts().count(), 0);
    assert!(bar.state_at(0.5).stress.abs() < 1e-4 && bar.state_at(0.5).velocity.abs() < 1e-11);
    // Two steps inwards, two steps outwards.
    assert_eq!(bar.ends()[1].steps.len(), 3);
}

#[test]
fn a_wall_is_reached_after_its_gap() {
    let steel = bilinear(0.5);
    let ends = [EndCondition::Wall { gap: 0.25 }, EndCondition::Free];
    let mut bar = track(vec![Segment::new(1.0, 1.0, steel.clone()).with_velocity(-0.5)], ISOTROPIC, ends);
    bar.advance_to(4.0).expect("few events");
    let steps = &bar.ends()[0].steps;
    // Free flight to 0.5, elastic contact for 2 L/c0, then rebound with the velocity reversed.
    for (step, [time, stress, velocity]) in steps.iter().zip([[0.0, 0.0, -0.5], [0.5, -0.5, 0.0], [2.5, 0.0, 0.5]]) {
        near(step.time, time, "time");
        near(step.stress, stress, "stress");
        near(step.velocity, velocity, "velocity");
    }
    assert_eq!(steps.len(), 3);
}

#[test]
fn a_level_curve_keeps_the_velocity_jump_at_the_end() {
    // Perfect plasticity: at most sigma_y is transmitted, with v = sigma_y/(rho c0) behind the front.
    let perfect = material(&[(1.0, 1.0), (2.0, 1.0)], 1.0, Beyond::Extend);
    let mut bar = track(vec![Segment::new(1.0, 1.0, perfect.clone())], ISOTROPIC, [pushed(3.0), EndCondition::Free]);
    bar.advance_to(0.5).expect("no meeting");
    near(bar.state_at(0.25).stress, -1.0, "stress");
    near(bar.state_at(0.25).velocity, 1.0, "velocity");
    assert_eq!(bar.ends()[0].above_critical.map(|from| [from.time, from.stress]), Some([0.0, -1.0]));
    // Two such bars that collide: the velocity jump remains at the joint and dissipates sigma_y times its value per time and area.
    let segments = vec![
        Segment::new(1.0, 1.0, perfect.clone()).with_velocity(3.0),
        Segment::new(1.0, 1.0, perfect.clone()).with_velocity(-3.0),
    ];
    let mut bar = track(segments, ISOTROPIC, [EndCondition::Free, EndCondition::Free]);
    bar.advance_to(0.5).expect("no meeting");
    let sum = bar.balance();
    near(sum.concentrated, 1.0 * 4.0 * 0.5, "work at the joint");
    near(sum.total(), 9.0, "energy");
}

#[test]
fn the_event_budget_stops_a_run_where_it_is() {
    let bar = Bar { segments: vec![Segment::new(1.0, 1.0, bilinear(0.5)).with_velocity(-3.0)], area_given: true };
    let settings = Settings { event_budget: 10, ..Settings::default() };
    let ends = [EndCondition::Wall { gap: 0.0 }, EndCondition::Free];
    let mut bar = FrontTracking::new(&bar, ISOTROPIC, ends, settings);
    let stopped = bar.advance_to(100.0).expect_err("more than ten events");
    let Stopped::EventBudget { time, events, .. } = stopped else { panic!("{stopped}") };
    assert_eq!((time, events), (bar.time(), 10));
    assert!(time > 1.0 && time < 10.0);
}

fn foam() -> Arc<Material> {
    material(&scaled(&[(0.01, 1.0), (0.6, 1.2), (0.7, 5.0), (0.75, 20.0)]), 200.0, Beyond::Extend)
}

#[test]
fn two_stiffening_bars_meet_like_one_and_a_wall() {
    // The chords of the hull on both sides depend on the solution: by symmetry it is the one-sided fan.
    let foam = foam();
    let fan = fan_at_velocity(&foam.tension, 200.0, 150.0);
    let segments = vec![
        Segment::new(1.0, 2.0, foam.clone()).with_velocity(150.0),
        Segment::new(1.0, 2.0, foam.clone()).with_velocity(-150.0),
    ];
    let mut bar = track(segments, ISOTROPIC, [EndCondition::Free, EndCondition::Free]);
    bar.advance_to(0.5 / foam.c0()).expect("no meeting");
    let middle = bar.state_at(1.0);
    near(-middle.stress / fan.stress, 1.0, "stress");
    near(-middle.strain / fan.strain, 1.0, "strain");
    near(middle.velocity / 150.0, 0.0, "velocity");
    assert_eq!(bar.fronts().count(), 2 * fan.edges.len());
}

#[test]
fn a_stiffening_bar_shares_force_and_velocity_with_another() {
    let (foam, steel) = (foam(), material(&scaled(&[(0.001, 200.0), (0.1, 600.0)]), 7800.0, Beyond::Extend));
    for flow in [ISOTROPIC, Flow::PathIndependent] {
        let segments =
            vec![Segment::new(1.0, 1e-2, foam.clone()).with_velocity(120.0), Segment::new(1.0, 1e-4, steel.clone())];
        let mut bar = track(segments, flow, [EndCondition::Free, EndCondition::Free]);
        let start = bar.balance();
        bar.advance_to(0.9 / steel.c0()).expect("no meeting");
        let (left, right) = (bar.state_at(1.0 - 1e-9), bar.state_at(1.0 + 1e-9));
        near(left.stress * 1e-2 / (right.stress * 1e-4), 1.0, "force");
        near(left.velocity / right.velocity, 1.0, "velocity");
        near(bar.balance().total() / start.total(), 1.0, "energy");
        near(bar.balance().momentum / start.momentum, 1.0, "momentum");
    }
}

/// Returns the relative L1 difference of stress over the bar.
fn difference(a: &FrontTracking, b: &FrontTracking) -> f64 {
    let stresses =
        |t: &FrontTracking| -> Vec<f64> { (0..2000).map(|i| t.state_at(5e-4 * (f64::from(i) + 0.5)).stress).collect() };
    let (a, b) = (stresses(a), stresses(b));
    let apart: f64 = a.iter().zip(&b).map(|(a, b)| (a - b).abs()).sum();
    apart / b.iter().map(|b| b.abs()).sum::<f64>()
}

#[test]
fn a_front_tolerance_saves_events_and_keeps_the_account() {
    let hard = material(&scaled(&[(0.001, 200.0), (0.1, 600.0)]), 7800.0, Beyond::Extend);
    let soft = material(&scaled(&[(0.0005, 35.0), (0.02, 80.0), (0.2, 120.0)]), 2700.0, Beyond::Extend);
    let bar = Bar {
        segments: vec![Segment::new(0.5, 1e-4, hard.clone()), Segment::new(0.5, 3e-4, soft.clone())],
        area_given: true,
    };
    let run = |front_tolerance| {
        let settings = Settings { front_tolerance, ..Settings::default() };
        let ends = [pushed(8.0), EndCondition::Fixed];
        let mut bar = FrontTracking::new(&bar, KINEMATIC, ends, settings);
        bar.advance_to(4.0 / hard.c0()).expect("few events");
        let sum = bar.balance();
        let missed = [sum.total() / (sum.work[0] + sum.work[1]), sum.momentum / (sum.impulse[0] + sum.impulse[1])];
        // Nodes closer than 1e-8 of the tolerance (times the length) count as one.
        assert!(missed.iter().all(|part| (part - 1.0).abs() < 1e-4 * front_tolerance), "{missed:?}");
        bar
    };
    let [coarse, middle, fine, finest] = [1e-2, 1e-3, 1e-4, 1e-5].map(run);
    assert!(middle.events() < fine.events() && fine.events() < finest.events());
    let error = |bar: &FrontTracking| difference(bar, &finest);
    // There is no proven bound, and the error is not proportional to the tolerance, but it decreases.
    assert!(error(&middle) < 0.5 * error(&coarse) && error(&fine) < error(&middle));
    assert!(error(&coarse) < 1e-2 && error(&middle) < 1e-3, "{} {}", error(&coarse), error(&middle));
}

#[test]
fn the_riemann_problem_serves_as_a_flux() {
    let steel = material(&scaled(&[(0.001, 200.0), (0.1, 600.0)]), 7800.0, Beyond::Extend);
    let table = Table::new(&steel.tension, steel.modulus);
    let medium = Medium::new([&table, &table], steel.modulus, steel.density, 1.0, ISOTROPIC, 0.0);
    let mut work = Workspace::default();
    let (left, right) = (Point { stress: 5e7, ..Point::moving(0.5) }, Point { stress: -2e7, ..Point::moving(1.0) });
    let elastic = solve(Side::Bar(&medium, &left), Side::Bar(&medium, &right), &mut work);
    // (sigma_L + sigma_R + rho c0 (v_R - v_L))/2 and (v_L + v_R + (sigma_R - sigma_L)/(rho c0))/2
    near(elastic.force / (0.5 * (3e7 + steel.impedance() * 0.5)), 1.0, "elastic stress");
    near(elastic.velocity_left / (0.75 - 3.5e7 / steel.impedance()), 1.0, "elastic velocity");
    near(elastic.velocity_left / elastic.velocity_right, 1.0, "velocities");
    // A point that has yielded at 400 MPa and is unloaded stays elastic up to this stress, in compression, too.
    let hardened = Point { accumulated: table_plastic(&table, 4e8), ..Point::default() };
    for sense in [1.0, -1.0] {
        let pulled = Side::Straight { force: 0.0, velocity: -20.0 * sense, compliance: 0.0 };
        let star = solve(pulled, Side::Bar(&medium, &hardened), &mut work);
        near(
            star.force / (sense * (4e8 + (20.0 - 4e8 / steel.impedance()) * (steel.density * 400e6 / 0.099).sqrt())),
            1.0,
            "stress",
        );
    }
}

/// Returns E times the plastic strain of first loading to a stress on the second line of a table.
fn table_plastic(table: &Table, stress: f64) -> f64 {
    let line = table.lines()[1];
    (stress - line.offset) / line.slope - stress
}

/// Returns a concave table with decreasing slopes below 1, in units of E = 1.
fn concave(slopes: &[f64], widths: &[f64]) -> Arc<Material> {
    let (mut strain, mut stress, mut slope) = (1.0, 1.0, 1.0);
    let mut rows = vec![(strain, stress)];
    for (factor, width) in slopes.iter().zip(widths) {
        slope *= factor;
        strain += width;
        stress += slope * width;
        rows.push((strain, stress));
    }
    material(&rows, 1.0, Beyond::Extend)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(1000))]

    #[test]
    fn random_tables_and_steps_keep_order_account_and_dissipation(
        slopes in prop::collection::vec(0.2..0.9_f64, 1..5),
        widths in prop::collection::vec(0.2..3.0_f64, 5),
        velocities in prop::collection::vec(-3.0..3.0_f64, 1..5),
        flow in prop::sample::select(vec![
            ISOTROPIC, Flow::Plastic { kinematic: 0.4 }, KINEMATIC, Flow::PathIndependent,
        ]),
        front_tolerance in prop::sample::select(vec![0.0, 1e-2]),
        area in 0.3..3.0_f64,
        far in 0..4_usize,
    ) {
        let steel = concave(&slopes, &widths);
        let rows: Vec<(f64, f64)> = velocities.iter().enumerate()
            .flat_map(|(k, &v)| [(0.37 * k as f64, v), (0.37 * (k + 1) as f64, v)]).collect();
        let left = EndCondition::Velocity { history: History::new(&rows).expect("in order"), release: Some(2.0) };
        let right = [EndCondition::Free, EndCondition::Fixed, EndCondition::Absorbing, EndCondition::Wall { gap: 0.1 }];
        let segments = vec![Segment::new(0.6, 1.0, steel.clone()), Segment::new(0.4, area, steel.clone())];
        let bar = Bar { segments, area_given: true };
        let settings = Settings { event_budget: 2000, front_tolerance, ..Settings::default() };
        let mut bar = FrontTracking::new(&bar, flow, [left, right[far].clone()], settings);
        let mut plastic = 0.0;
        for step in 1..=30 {
            let stopped = bar.advance_to(0.1 * f64::from(step)).is_err();
            let mut at = 0.0;
            for piece in bar.pieces() {
                prop_assert!((piece.from - at).abs() < 1e-11 && piece.point.stress.is_finite());
                at = piece.to;
            }
            let sum = bar.balance();
            let scale = sum.total().max(sum.work[0].abs()).max(1.0);
            // Fronts closer than 1e-13 count as one, with a front tolerance 1e-8 of that; up to 2000 events, few of which shift anything by as much.
            let bound = if front_tolerance == 0.0 { 1e-10 } else { 1e-5 * front_tolerance };
            prop_assert!((sum.total() - sum.work[0] - sum.work[1]).abs() < bound * scale, "{sum:?}");
            prop_assert!((sum.momentum - sum.impulse[0] - sum.impulse[1]).abs() < bound * scale, "{sum:?}");
            // Kinematic hardening stores energy and returns it; only isotropic plastic work is dissipation. It decreases by the energy shifted where
            // a wave overtakes a plastic one so close to its origin that they count as one, which the run reports.
            let moved = (1e-12 + bar.unresolved()) * scale;
            prop_assert!(flow != ISOTROPIC || sum.plastic >= plastic - moved, "{sum:?}");
            plastic = sum.plastic;
            if stopped {
                break;
            }
        }
    }
}

#[test]
fn trails_are_the_straight_lives_of_all_fronts() {
    let case = cases().iter().max_by_key(|c| c.left_history.len() + c.right_history.len()).expect("there are cases");
    let flow = if case.iso { ISOTROPIC } else { KINEMATIC };
    let segments =
        vec![Segment::new(number(&case.length), 1.0, bilinear(number(&case.r))).with_velocity(number(&case.velocity))];
    let bar = Bar { segments, area_given: true };
    let settings = Settings { front_segments: true, ..Settings::default() };
    let mut bar = FrontTracking::new(&bar, flow, ends(case), settings);
    let mut front_segments = Vec::new();
    for part in 1..=3 {
        bar.advance_to(number(&case.t_final) * f64::from(part) / 3.0).expect("few events");
        front_segments.extend(bar.take_front_segments());
    }
    front_segments.extend(bar.living_front_segments());
    assert!(front_segments.len() > 4);
    // A gauge that is read from the front segments has the state of the bar: the last front that crossed a position left its state there.
    for x in [0.1234, 0.4321, 0.8765].map(|share| share * number(&case.length)) {
        let crossing =
            |t: &&barwave::solver::moc::FrontSegment| (t.x[0] <= x && x < t.x[1]) || (t.x[1] <= x && x < t.x[0]);
        let time =
            |t: &barwave::solver::moc::FrontSegment| t.t[0] + (x - t.x[0]) / (t.x[1] - t.x[0]) * (t.t[1] - t.t[0]);
        let last =
            front_segments.iter().filter(crossing).max_by(|a, b| time(a).total_cmp(&time(b))).expect("a front came by");
        near(last.behind.stress, bar.state_at(x).stress, "stress left behind");
        near(last.behind.velocity, bar.state_at(x).velocity, "velocity left behind");
    }
}
