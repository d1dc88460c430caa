//! Order of the steps of masses, springs and balls in front tracking: force and impulse in the history of the end.

use barwave::bar::{Bar, EndCondition, Hertz, Segment};
use barwave::material::{Beyond, Curve, Material};
use barwave::solver::moc::{FrontTracking, Settings};
use barwave::wave::riemann::Flow;

/// Cross-section, m^2.
const AREA: f64 = 0.5;

/// Returns a bar with `E = rho = c0 = 1` that does not yield, of area `AREA`, length 1 and velocity `velocity`.
fn bar(ends: [EndCondition; 2], velocity: f64, step: f64) -> FrontTracking {
    let curve = Curve::new(&[(1e6, 1e6)], Beyond::Extend).expect("rows are right");
    let segment =
        Segment::new(1.0, AREA, Material::from_curve("test", 1.0, curve).expect("a material")).with_velocity(velocity);
    let settings = Settings { ramp_step: Some(step), ..Settings::default() };
    FrontTracking::new(
        &Bar { segments: vec![segment], area_given: true },
        Flow::Plastic { kinematic: 0.0 },
        ends,
        settings,
    )
}

/// Returns the largest compressive force in the history of the end, N.
fn peak(bar: &FrontTracking) -> f64 {
    AREA * bar.ends()[0].steps.iter().map(|step| -step.stress).fold(0.0, f64::max)
}

/// Returns the impulse in the history of the end from 0 to t, N s.
fn impulse(bar: &FrontTracking, t: f64) -> f64 {
    let steps = &bar.ends()[0].steps;
    let next = steps.iter().skip(1).map(|step| step.time).chain([t]);
    AREA * steps.iter().zip(next).map(|(step, next)| -step.stress * (next.min(t) - step.time).max(0.0)).sum::<f64>()
}

/// Returns times at which impulses are compared: within steps as well as at their ends.
fn times() -> impl Iterator<Item = f64> {
    (1..400).map(|k| 1.9 * f64::from(k) / 400.0)
}

/// Returns the integral over time, up to 1.9, of the error of the recorded forces, each of which is the mean of a step and is compared with the exact
/// force in the middle of the step.
fn missed_force(bar: &FrontTracking, exact: impl Fn(f64) -> f64) -> f64 {
    let steps = bar.ends()[0].steps.windows(2).filter(|pair| pair[1].time < 1.9);
    let missed = steps.map(|pair| {
        let [from, to] = [pair[0].time, pair[1].time];
        (-AREA * pair[0].stress - exact(0.5 * (from + to))).abs() * (to - from)
    });
    missed.sum()
}

/// Checks that the errors of peak force, force and impulse decrease at least with the power 1.8 of the step, over four halvings of the step `first`.
/// Errors below 1e-7 are rounding of the first step after a jump. (The position of the largest force relative to the steps is arbitrary, so that the
/// order of its error between neighbouring steps varies.)
#[track_caller]
fn check_orders(first: f64, missed: impl Fn(f64) -> [f64; 3]) {
    let errors = [1.0, 0.5, 0.25, 0.125, 0.0625].map(|part| missed(first * part));
    for (k, what) in ["peak force", "force", "impulse"].iter().enumerate() {
        let errors = errors.map(|error| error[k].abs());
        let order = (errors[0] / errors[4]).log2() / 4.0;
        println!("{what}: order {order:.2}, errors {errors:?}");
        assert!(errors[0] <= 1e-7 || order >= 1.8, "{what}: order {order}, errors {errors:?}");
    }
}

/// Returns the largest error of the impulse at any of the times.
fn missed_impulse(bar: &FrontTracking, exact: impl Fn(f64) -> f64) -> f64 {
    times().map(|t| (impulse(bar, t) - exact(t)).abs()).fold(0.0, f64::max)
}

#[test]
fn the_force_of_a_rigid_mass_is_of_second_order() {
    let mass = 0.7;
    let force = |t: f64| AREA * (-AREA * t / mass).exp();
    let given = |t: f64| mass * (1.0 - (-AREA * t / mass).exp());
    check_orders(1e-2, |step| {
        let ends = [EndCondition::Striker { mass, velocity: 1.0 }, EndCondition::Absorbing];
        let mut bar = bar(ends, 0.0, step);
        bar.advance_to(1.95).expect("enough events");
        [peak(&bar) - AREA, missed_force(&bar, force), missed_impulse(&bar, given)]
    });
}

#[test]
fn the_force_of_a_spring_is_of_second_order() {
    let stiffness = 0.8;
    // Up to t = 2, the compression s satisfies s' + a s = 1; then 2 exp(-a (t - 2)) - 1 arrives from the free end.
    let a = stiffness / AREA;
    let risen = |t: f64| (1.0 - (-a * t).exp()) / a;
    let late = (-2.0 * a).exp() / (2.0 * a);
    let highest = (risen(2.0) + 2.0 * late + 1.0 / a) * (-a * late).exp() - 1.0 / a;
    check_orders(1e-2, |step| {
        let mut bar = bar([EndCondition::Spring { stiffness }, EndCondition::Free], -1.0, step);
        bar.advance_to(2.05).expect("enough events");
        let force = missed_force(&bar, |t| stiffness * risen(t));
        [peak(&bar) - stiffness * highest, force, missed_impulse(&bar, |t| AREA * (t - risen(t)))]
    });
}

/// Returns the forces of a ball on an end that moves with the velocity F/AREA, at equidistant times up to `until`, and its impulses up to then, by
/// the classical Runge-Kutta method.
fn ball_alone(contact: Hertz, mass: f64, velocity: f64, until: f64) -> Vec<[f64; 2]> {
    let steps = 200_000;
    let dt = until / f64::from(steps);
    let rates = |[a, v]: [f64; 2]| [v - contact.force(a) / AREA, -contact.force(a) / mass];
    let mut state = [0.0, velocity];
    let mut rows = vec![[0.0; 2]];
    for _ in 0..steps {
        let shifted = |r: [f64; 2], h: f64| [state[0] + h * r[0], state[1] + h * r[1]];
        let r1 = rates(state);
        let r2 = rates(shifted(r1, 0.5 * dt));
        let r3 = rates(shifted(r2, 0.5 * dt));
        let r4 = rates(shifted(r3, dt));
        state = std::array::from_fn(|i| state[i] + dt / 6.0 * (r1[i] + 2.0 * (r2[i] + r3[i]) + r4[i]));
        rows.push([contact.force(state[0]), mass * (velocity - state[1])]);
    }
    rows
}

#[test]
fn the_force_of_a_ball_is_of_second_order() {
    let (contact, mass, velocity) = (Hertz::new(0.1, [(40.0, 0.3), (60.0, 0.3)]), 0.2, 0.5);
    let alone = ball_alone(contact, mass, velocity, 1.9);
    let highest = alone.iter().fold(0.0_f64, |m, row| m.max(row[0]));
    assert!(alone[alone.len() - 1][0] < 0.1 * highest, "the peak lies within the time");
    let row = |t: f64| {
        let place = t / 1.9 * (alone.len() - 1) as f64;
        let before = (place as usize).min(alone.len() - 2);
        let part = place - before as f64;
        [0, 1].map(|k| (1.0 - part) * alone[before][k] + part * alone[before + 1][k])
    };
    check_orders(5e-3, |step| {
        let ends = [EndCondition::Ball { mass, velocity, contact }, EndCondition::Absorbing];
        let mut bar = bar(ends, 0.0, step);
        bar.advance_to(1.95).expect("enough events");
        let force = missed_force(&bar, |t| row(t)[0]);
        [peak(&bar) - highest, force, missed_impulse(&bar, |t| row(t)[1])]
    });
}
