//! Ramps, strikers, springs and contact joints in front tracking, against closed forms and their energy balance.

use std::sync::Arc;

use barwave::bar::{Bar, EndCondition, History, Joint, Segment};
use barwave::material::{Beyond, Curve, Material};
use barwave::solver::moc::{FrontTracking, Settings};
use barwave::wave::riemann::Flow;

const ISOTROPIC: Flow = Flow::Plastic { kinematic: 0.0 };

fn material(rows: &[(f64, f64)]) -> Arc<Material> {
    Arc::new(
        Material::from_curve("test", 1.0, Curve::new(rows, Beyond::Extend).expect("rows are right"))
            .expect("a material"),
    )
}

/// Returns a material with `E = rho = c0 = 1` and no yield.
fn elastic() -> Arc<Material> {
    material(&[(1e6, 1e6)])
}

fn segment(length: f64, area: f64, material: &Arc<Material>, velocity: f64) -> Segment {
    Segment::new(length, area, Arc::clone(material)).with_velocity(velocity).with_joint(Joint::Contact { gap: 0.0 })
}

fn with_step(ramp_step: f64) -> Settings {
    Settings { ramp_step: Some(ramp_step), event_budget: 40_000_000, ..Settings::default() }
}

fn track(segments: Vec<Segment>, ends: [EndCondition; 2], settings: Settings) -> FrontTracking {
    FrontTracking::new(&Bar { segments, area_given: true }, ISOTROPIC, ends, settings)
}

#[track_caller]
fn near(value: f64, expected: f64, tolerance: f64, what: &str) {
    assert!(
        (value - expected).abs() <= tolerance * expected.abs().max(1e-3),
        "{what}: {value} is not {expected} ({:.1e})",
        (value / expected - 1.0).abs()
    );
}

/// Returns a bar struck with velocity 1 by a mass of m times its own.
fn struck(m: f64, far: EndCondition, settings: Settings) -> FrontTracking {
    let ends = [EndCondition::Striker { mass: m, velocity: 1.0 }, far];
    track(vec![segment(1.0, 1.0, &elastic(), 0.0)], ends, settings)
}

/// Follows the bar until the striker has separated, and returns that time.
fn until_separation(bar: &mut FrontTracking, limit: f64) -> f64 {
    let mut t = 0.0;
    while t < limit {
        t += 0.01;
        bar.advance_to(t).expect("enough events");
        if let [_, apart, ..] = bar.striker_changes(0) {
            assert!(apart.open);
            return apart.time;
        }
    }
    panic!("still in contact at {t}: {:?}", bar.striker(0));
}

fn largest(bar: &FrontTracking, which: usize) -> f64 {
    bar.ends()[which].steps.iter().map(|s| -s.stress).fold(0.0, f64::max)
}

#[test]
fn a_mass_on_a_rod_with_a_fixed_end_has_the_tabulated_contact() {
    let table = include_str!("../data/mass_on_rod_fixed.csv");
    let rows: Vec<_> = table.lines().filter(|line| line.starts_with(|c: char| c.is_ascii_digit())).collect();
    assert_eq!(rows.len(), 5);
    for row in rows {
        let numbers: Vec<f64> = row.split(',').map(|n| n.parse().expect("a number")).collect();
        let [m, contact, at_struck, at_fixed, velocity] = numbers[..] else { panic!("five columns: {row}") };
        // Second order in the step; heavier masses, in contact longer, reach the same accuracy with a finer step, and fewer fronts.
        let mut bar = struck(m, EndCondition::Fixed, with_step(if m < 3.0 { 2e-3 } else { 1e-3 }));
        let time = until_separation(&mut bar, 12.0);
        let after = bar.striker(0).expect("there").velocity;
        // Waves on their way to the fixed end also count.
        bar.advance_to(time + 1.0).expect("enough events");
        // The table has five decimals; to these, 1e-6.
        let digits = |value: f64, expected: f64, what: &str| {
            let allowed = 0.5e-5 + 1e-6 * expected.abs();
            assert!((value - expected).abs() <= allowed, "m = {m}: {what} {value} is not {expected}");
        };
        digits(time, contact, "contact");
        digits(largest(&bar, 0), at_struck, "struck end");
        digits(largest(&bar, 1), at_fixed, "fixed end");
        digits(after, velocity, "velocity");
    }
}

/// The mean of the first steps behind the jump of an impact must not replace it: otherwise, largest stresses are up to 0.6 % too small with a front
/// tolerance of 1e-3.
#[test]
fn merged_waves_of_a_striker_keep_the_largest_stresses() {
    for (m, struck_end) in
        [(0.25_f64, 2.0 + (-8.0_f64).exp()), (0.5, 2.0 + (-4.0_f64).exp()), (1.0, 2.0 + (-2.0_f64).exp())]
    {
        let fixed_end = 2.0 * (1.0 + (-2.0 / m).exp());
        for (front_tolerance, allowed) in [(1e-2, 1e-5), (3e-3, 1e-6), (1e-3, 5e-7)] {
            let mut bar = struck(m, EndCondition::Fixed, Settings { front_tolerance, ..Settings::default() });
            bar.advance_to(4.0).expect("enough events");
            near(largest(&bar, 0), struck_end, allowed, "largest stress at the struck end");
            near(largest(&bar, 1), fixed_end, allowed, "largest stress at the fixed end");
        }
    }
}

#[test]
fn a_fixed_end_feels_twice_one_plus_exp_minus_two_over_m() {
    for m in [0.7, 1.0, 3.0, 5.0] {
        let mut bar = struck(m, EndCondition::Fixed, with_step(2e-3));
        bar.advance_to(3.5).expect("enough events");
        near(largest(&bar, 1), 2.0 * (1.0 + (-2.0 / m).exp()), 1e-6, "largest stress at the fixed end");
    }
}

#[test]
fn a_mass_leaves_a_free_bar_after_two_transits() {
    for m in [0.3, 1.0, 2.5, 8.0] {
        let mut bar = struck(m, EndCondition::Free, with_step(2e-3));
        let time = until_separation(&mut bar, 2.5);
        near(time, 2.0, 1e-12, "contact");
        bar.advance_to(2.5).expect("enough events");
        let after = bar.striker(0).expect("there").velocity;
        let restitution = bar.balance().momentum - after;
        let left = (-2.0 / m).exp();
        near(restitution, m * (1.0 - left) - left, 1e-6, "restitution");
        // The bar has what the mass has lost, to rounding, as a step ends at the arrival.
        let sum = bar.balance();
        near(sum.total() + bar.body_energy()[0], 0.5 * m, 1e-12, "energy");
        near(sum.momentum + m * after, m, 1e-12, "momentum");
    }
}

#[test]
fn a_striker_on_an_elastic_bar_is_exact_in_any_step() {
    for step in [0.2, 1e-2, 2.5e-3] {
        let mut bar = struck(1.0, EndCondition::Free, with_step(step));
        bar.advance_to(2.5).expect("enough events");
        let velocity = bar.striker(0).expect("there").velocity;
        near(velocity, (-2.0_f64).exp(), 1e-12, "velocity");
    }
}

#[test]
fn strikers_at_both_ends_are_mirrored() {
    let left = EndCondition::Striker { mass: 2.0, velocity: 1.0 };
    let right = EndCondition::Striker { mass: 2.0, velocity: -1.0 };
    let mut bar = track(vec![segment(1.0, 1.0, &elastic(), 0.0)], [left, right], with_step(1e-2));
    bar.advance_to(2.5).expect("enough events");
    let [a, b] = [0, 1].map(|k| bar.striker(k).expect("there"));
    near(a.velocity, -b.velocity, 1e-12, "velocity");
    near(bar.balance().momentum, 0.0, 1e-9, "momentum");
    let spent = 2.0 - bar.body_energy()[0] - bar.body_energy()[1];
    near(bar.balance().total(), spent, 1e-4, "energy, within a step");
    // By symmetry, this is a bar of half the length against a fixed end.
    let mut half = struck(4.0, EndCondition::Fixed, with_step(1e-2));
    half.advance_to(5.0).expect("enough events");
    near(a.velocity, half.striker(0).expect("there").velocity, 5e-4, "half the bar");
}

#[test]
fn a_striker_on_a_plastic_bar_keeps_the_account() {
    let plastic = material(&[(1.0, 1.0), (2.0, 1.2), (5.0, 1.5)]);
    // With a fixed end, the number of fronts of a plastic bar grows without limit.
    for (far, front_tolerance) in [(EndCondition::Free, 0.0), (EndCondition::Fixed, 1e-2), (EndCondition::Free, 1e-2)] {
        let settings = Settings { front_tolerance, event_budget: 100_000, ..with_step(2e-2) };
        let ends = [EndCondition::Striker { mass: 1.5, velocity: 3.0 }, far];
        let mut bar = track(vec![segment(1.0, 1.0, &plastic, 0.0)], ends, settings);
        let mut plastic = 0.0;
        for k in 1..=30 {
            bar.advance_to(0.1 * f64::from(k)).expect("enough events");
            let (sum, striker) = (bar.balance(), bar.striker(0).expect("there"));
            near(sum.momentum + 1.5 * striker.velocity - sum.impulse[1], 4.5, 1e-9, "momentum");
            // Within a step of x time constants, the energy defect is up to x^2/4 of the energy of the mass; x is about 2e-2.
            near(sum.total() + bar.body_energy()[0], 6.75, 1e-3, "energy");
            near(sum.total(), sum.work[0], 1e-9, "the bar's own account");
            assert!(sum.plastic >= plastic - 1e-12);
            plastic = sum.plastic;
        }
    }
}

#[test]
fn a_spring_brings_a_moving_bar_to_rest_exponentially() {
    let (stiffness, area) = (3.0, 0.5);
    for (which, inward) in [(0, 1.0), (1, -1.0)] {
        let mut ends = [EndCondition::Absorbing, EndCondition::Absorbing];
        ends[which] = EndCondition::Spring { stiffness };
        let mut bar = track(vec![segment(1.0, area, &elastic(), 1.0)], ends, with_step(2e-3));
        for t in [0.1, 0.5, 0.9] {
            bar.advance_to(t).expect("enough events");
            let step = bar.ends()[which].steps.last().expect("started");
            let stretch = area / stiffness * (1.0 - (-stiffness / area * t).exp());
            let stored = 0.5 * stiffness * stretch * stretch;
            // The stress of the end is the mean of a step, the energy of the spring that of an instant.
            near(step.stress, inward * stiffness * stretch / area, 2e-3, "stress");
            near(bar.body_energy()[which], stored, 1e-3, "energy");
        }
        // After a long time all of the energy is in the spring: k u = A Z v.
        bar.advance_to(6.0).expect("enough events");
        let stored = 0.5 * area * area / stiffness;
        near(bar.body_energy()[which], stored, 1e-6, "energy at rest");
        near(-bar.balance().work[which], stored, 1e-6, "work");
    }
}

#[test]
fn a_bar_between_springs_keeps_its_energy() {
    let plastic = material(&[(1.0, 1.0), (2.0, 1.2), (5.0, 1.5)]);
    for (bar_material, velocity) in [(elastic(), 1.0), (plastic, 2.0)] {
        let ends = [EndCondition::Spring { stiffness: 0.7 }, EndCondition::Spring { stiffness: 20.0 }];
        let settings = Settings { front_tolerance: 1e-2, event_budget: 300_000, ..with_step(2e-2) };
        let mut bar = track(vec![segment(1.0, 1.0, &bar_material, velocity)], ends, settings);
        for k in 1..=20 {
            bar.advance_to(0.2 * f64::from(k)).expect("enough events");
            let sum = bar.balance();
            let held = sum.total() + bar.body_energy().iter().sum::<f64>();
            // As above: up to x^2/4 of the energy of the spring within a step, and x grows where little is left to relax.
            near(held, 0.5 * velocity * velocity, 1e-3, "energy");
            near(sum.momentum - sum.impulse[0] - sum.impulse[1], velocity, 1e-9, "momentum");
        }
    }
}

fn two_bars(gap: f64, first: Segment, second: Segment) -> FrontTracking {
    let segments = vec![Segment { joint: Joint::Contact { gap }, ..first }, second];
    track(segments, [EndCondition::Free, EndCondition::Free], Settings::default())
}

#[test]
fn two_elastic_bars_touch_for_two_transits_of_the_shorter() {
    for (short, gap) in [(0.4, 0.0), (0.4, 0.3), (0.25, 0.1), (1.0, 0.2)] {
        let steel = elastic();
        let mut bar = two_bars(gap, segment(short, 2.0, &steel, 1.0), segment(1.0, 2.0, &steel, 0.0));
        bar.advance_to(gap + 3.0).expect("few events");
        let contact = bar.contacts().next().expect("one");
        let closed = contact.changes.iter().position(|c| !c.open).expect("it closes");
        near(contact.changes[closed].time, gap, 1e-12, "touch");
        near(contact.changes[closed + 1].time, gap + 2.0 * short, 1e-12, "end of contact");
        // The shorter bar comes to rest; the longer one has the whole momentum.
        for piece in bar.pieces().filter(|p| p.segment == 0) {
            assert!(piece.point.velocity.abs() < 1e-12 && piece.point.stress.abs() < 1e-12);
        }
        let sum = bar.balance();
        near(sum.momentum, 2.0 * short, 1e-12, "momentum");
        near(sum.total(), short, 1e-12, "energy");
    }
}

#[test]
fn a_gap_opens_and_closes_at_exact_times() {
    // Both bars move; the second strikes a wall and returns: free flight, contact, flight, contact.
    let steel = elastic();
    let segments =
        vec![segment(1.0, 1.0, &steel, 0.0).with_joint(Joint::Contact { gap: 0.5 }), segment(1.0, 1.0, &steel, 0.25)];
    let ends = [EndCondition::Free, EndCondition::Wall { gap: 0.125 }];
    let mut bar = track(segments, ends, Settings::default());
    // The wall is struck at 0.5 and released at 2.5; by then the faces are 0.5 + 0.125 apart, except for the motion due to the wave: from 1.5 on, the
    // left face of the second bar moves back with 0.25.
    for (t, gap) in [(0.4, 0.6), (1.5, 0.875), (2.5, 0.625), (4.5, 0.125), (4.9, 0.025)] {
        bar.advance_to(t).expect("few events");
        let state = bar.contacts().next().expect("one");
        near(state.gap, gap, 1e-12, "gap");
        near(state.jump, gap - 0.5, 1e-12, "jump");
        assert!(state.open);
    }
    bar.advance_to(5.5).expect("few events");
    let state = bar.contacts().next().expect("one");
    assert!(!state.open && state.gap == 0.0);
    near(state.changes[1].time, 5.0, 1e-12, "touch");
    near(bar.state_at(1.0).stress, -0.125, 1e-12, "stress");
    bar.advance_to(8.0).expect("few events");
    let sum = bar.balance();
    near(sum.momentum, sum.impulse[1] + 0.25, 1e-12, "momentum");
    near(sum.total(), 0.5 * 0.25 * 0.25, 1e-12, "energy");
}

#[test]
fn bars_of_other_sections_and_curves_keep_momentum_and_energy_through_a_contact() {
    let hard = material(&[(1.0, 1.0), (2.0, 1.25)]);
    let soft = material(&[(0.4, 0.2), (1.0, 0.3), (3.0, 0.4)]);
    for (gap, velocity) in [(0.0, 2.0), (0.2, 3.0), (0.05, 0.6)] {
        let mut bar = two_bars(gap, segment(0.5, 1.0, &hard, velocity), segment(0.7, 1.7, &soft, -0.3));
        let start = bar.balance();
        let mut plastic = 0.0;
        for k in 1..=20 {
            let stopped = bar.advance_to(0.1 * f64::from(k));
            let sum = bar.balance();
            near(sum.momentum, start.momentum, 1e-11, "momentum");
            near(sum.total(), start.total(), 1e-11, "energy");
            assert!(sum.plastic >= plastic - 1e-12 * start.total());
            plastic = sum.plastic;
            if stopped.is_err() {
                break;
            }
        }
        assert!(plastic > 0.01 * start.total());
    }
}

#[test]
fn a_joint_in_tension_opens_and_lets_nothing_through() {
    // A compression pulse returns from the free end as tension and opens the contact joint.
    let steel = elastic();
    let history = History::new(&[(0.0, -1.0), (0.3, -1.0), (0.3, 0.0)]).expect("in order");
    let segments = vec![segment(1.0, 1.0, &steel, 0.0), segment(0.5, 1.0, &steel, 0.0)];
    let mut bar = track(segments, [EndCondition::Stress { history }, EndCondition::Free], Settings::default());
    bar.advance_to(4.0).expect("few events");
    let state = bar.contacts().next().expect("one");
    let times: Vec<(f64, bool)> = state.changes.iter().map(|c| (c.time, c.open)).collect();
    // The joint is closed while the pulse passes, from 1 to 1.3, and opens when the pulse returns at 2: the end piece retains all of it.
    assert_eq!(times.iter().map(|t| t.1).collect::<Vec<_>>(), [true, false, true]);
    near(times[1].0, 1.0, 1e-12, "pulse comes");
    near(times[2].0, 1.3, 1e-12, "pulse has passed");
    let piece: f64 = bar.pieces().filter(|p| p.segment == 0).map(|p| p.point.velocity.abs() * (p.to - p.from)).sum();
    assert!(piece < 1e-12);
    // Momentum 0.3 on a length of 0.5; the gap has opened by the motion of the pulse in the end piece since then.
    near(bar.balance().momentum, 0.3, 1e-12, "momentum");
    near(state.gap, 2.0 * 0.3 * 2.0, 1e-12, "gap");
}

#[test]
fn an_elastic_ramp_is_right_to_second_order() {
    // Energy behind a ramp of velocity on an elastic bar: the integral of v^2.
    let ramp = History::new(&[(0.0, 0.0), (0.5, 1.0)]).expect("in order");
    let energy = |step: f64, end: EndCondition| {
        let mut bar = track(vec![segment(1.0, 1.0, &elastic(), 0.0)], [end, EndCondition::Free], with_step(step));
        bar.advance_to(0.75).expect("few events");
        near(bar.balance().momentum, 0.5, 1e-12, "momentum");
        bar.balance().total()
    };
    let exact = 0.25 + 0.5 / 3.0;
    let ends = [
        EndCondition::Velocity { history: ramp.clone(), release: None },
        EndCondition::Stress { history: History::new(&[(0.0, 0.0), (0.5, -1.0)]).expect("in order") },
    ];
    for end in ends {
        let [coarse, fine] = [1e-2, 5e-3].map(|step| (energy(step, end.clone()) - exact).abs());
        let order = (coarse / fine).log2();
        assert!((order - 2.0).abs() < 1e-3, "order {order}");
        // Error of the trapezoidal rule for v^2: step^2/12 times the change of 2 v.
        assert!((coarse / (0.5 * 1e-4 / 6.0) - 1.0).abs() < 1e-3, "error {coarse}");
    }
}
