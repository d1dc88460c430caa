//! Exact piecewise constant solutions of bilinear bars with unloading and reflections, against the schemes on a grid.
//!
//! The cases (`tests/data/exact_bar_cases.json`) are in units of rho = c0 = E = `sigma_y` = 1, so that the yield velocity is 1, too. They were
//! computed in rational arithmetic by following every wave front.
//!
//! Every level of stress and velocity must be within 2 % of yield, and within 0.5 % on average; plastic strain within 0.03 of the yield strain.
//! Levels are compared in the middle half of their interval, since the scheme spreads a front over some cells and its position is not tested here.

use crate::common;
use crate::common::exact;
use crate::common::muscl;

use barwave::bar::{EndCondition, Segment};
use barwave::material::{Beyond, Curve, Material};
use barwave::record::{Ledger, Stepped};
use barwave::scene::HardeningRule;
use barwave::solver::fd::Quantity;
use exact::{Case, cases, ends, number, numbers};

const CELLS: usize = 2000;

/// Allowed error of any sample of a level, relative to yield.
const LEVEL: f64 = 0.02;
/// Allowed error of the mean of a level, relative to yield, or to the level itself if that is above yield: the first cells that yield under a sudden
/// load have an error proportional to the jump, which decays along the level.
const MEAN: f64 = 0.005;
/// Allowed error of plastic strain, relative to the yield strain.
const PLASTIC: f64 = 0.03;
/// Allowed error of momentum, relative to that of the impact velocity, or of the yield velocity without an impact.
const MOMENTUM: f64 = 0.01;
/// Allowed fraction of samples of a level with larger errors. A front of zero strength in the exact solution still has a position and a time, and
/// disturbs a few cells and steps (at most 2 of 1333 in a history).
const SPOTS: f64 = 0.02;

/// Length of the bar in place of a semi-infinite one: the fastest wave is at x = 4 at the end of the last case, so that none reaches the far end. The
/// length stated in the file (60) would leave too few cells, less than 2000, for a pulse of length 1.
const LONG: f64 = 5.0;

/// Returns the length of the bar with which a case is run.
fn length(case: &Case) -> f64 {
    number(&case.length).min(LONG)
}

fn bilinear(r: f64) -> Material {
    let rows = [(1.0, 1.0), (2.0, 1.0 + r * r)];
    Material::from_curve("bilinear", 1.0, Curve::new(&rows, Beyond::Extend).expect("rows rise")).expect("a material")
}

fn bar<S>(case: &Case, build: Build<S>) -> S {
    let velocity = number(&case.velocity);
    let segment = common::segment(bilinear(number(&case.r)), length(case)).with_velocity(velocity);
    let hardening = if case.iso { HardeningRule::Isotropic } else { HardeningRule::Kinematic };
    build(vec![segment], ends(case), Some(hardening), CELLS, 1.0)
}

/// Function that builds a bar for a scheme from segments, ends, hardening, number of cells and Courant number.
type Build<S> = fn(Vec<Segment>, [EndCondition; 2], Option<HardeningRule>, usize, f64) -> S;

/// Level that values should have in an interval of time or position.
struct Level<'a> {
    what: String,
    from: f64,
    to: f64,
    expected: f64,
    /// Time or position, and value.
    values: &'a [(f64, f64)],
}

impl Level<'_> {
    /// Returns the deviations in the middle half of the interval.
    fn deviations(&self) -> Vec<f64> {
        let margin = 0.25 * (self.to - self.from);
        let inside = self.values.iter().filter(|p| p.0 > self.from + margin && p.0 < self.to - margin);
        let deviations: Vec<f64> = inside.map(|p| p.1 - self.expected).collect();
        assert!(deviations.len() > 20, "{}: {} samples", self.what, deviations.len());
        deviations
    }

    /// Checks the mean, and all samples except a small fraction.
    fn check(&self, mean_tolerance: f64, tolerance: f64) {
        let deviations = self.deviations();
        let count = deviations.len() as f64;
        let mean = deviations.iter().sum::<f64>() / count;
        let mean_tolerance = mean_tolerance * self.expected.abs().max(1.0);
        let outside = deviations.iter().filter(|d| d.abs() > tolerance).count() as f64;
        let worst = deviations.iter().fold(0.0_f64, |m, d| m.max(d.abs()));
        let place = format!("{} {:.3}..{:.3} at {:.3}", self.what, self.from, self.to, self.expected);
        assert!(mean.abs() <= mean_tolerance, "{place}: mean off by {mean:.5}");
        assert!(outside <= SPOTS * count, "{place}: {outside} of {count} samples off, at most by {worst:.4}");
    }
}

/// Stress and velocity at both ends for every step.
struct Histories {
    stress: [Vec<(f64, f64)>; 2],
    velocity: [Vec<(f64, f64)>; 2],
}

/// Runs to the end of the case, and records the ledger.
fn histories(bar: &mut impl Stepped, ledger: &mut Ledger, end: f64) -> Histories {
    let mut all = Histories { stress: [Vec::new(), Vec::new()], velocity: [Vec::new(), Vec::new()] };
    while bar.time() < end - 0.5 * bar.grid().dt {
        bar.advance();
        for (side, end) in bar.ends().into_iter().enumerate() {
            all.stress[side].push((bar.time(), end.stress));
            all.velocity[side].push((bar.time(), end.velocity));
        }
        if bar.step().is_multiple_of(50) {
            ledger.row(bar);
        }
    }
    ledger.row(bar);
    all
}

fn check_histories(case: &Case, histories: &Histories, end: f64) {
    for (side, (name, rows)) in [("left", &case.left_history), ("right", &case.right_history)].into_iter().enumerate() {
        for (k, row) in rows.iter().enumerate() {
            let [from, stress, velocity] = numbers(row);
            let to = rows.get(k + 1).map_or(end, |next| number(&next[0]));
            // A wave that arrives at the end of the case leaves an empty interval.
            if to <= from {
                continue;
            }
            let level = |what: &str, expected, values| Level {
                what: format!("{}: {what} of the {name} end", case.name),
                from,
                to,
                expected,
                values,
            };
            level("stress", stress, &histories.stress[side]).check(MEAN, LEVEL);
            level("velocity", velocity, &histories.velocity[side]).check(MEAN, LEVEL);
        }
    }
}

fn check_profiles(case: &Case, bar: &impl Stepped) {
    let x = bar.grid().centres();
    let profile = |quantity| -> Vec<(f64, f64)> {
        let mut values = vec![0.0; x.len()];
        bar.profile(quantity, &mut values);
        x.iter().copied().zip(values).collect()
    };
    let (stress, velocity) = (profile(Quantity::Stress), profile(Quantity::Velocity));
    let plastic = profile(Quantity::PlasticStrain);
    let level = |what: &str, from: f64, to: f64, expected, values| Level {
        what: format!("{}: final {what}", case.name),
        from,
        to: to.min(length(case)),
        expected,
        values,
    };
    for row in &case.state {
        let [from, to, s, v] = numbers(row);
        level("stress", from, to, s, &stress).check(MEAN, LEVEL);
        level("velocity", from, to, v, &velocity).check(MEAN, LEVEL);
    }
    for row in &case.ep_profile {
        let [from, to, expected] = numbers(row);
        level("plastic strain", from, to, expected, &plastic).check(PLASTIC, PLASTIC);
    }
}

fn check<S: Stepped>(name: &str, build: Build<S>) {
    let case = cases().iter().find(|c| c.name == name).expect("a case of the file");
    let mut bar = bar(case, build);
    let bar_mass = bar.start().mass;
    let mut ledger = Ledger::new(&bar);
    let end = number(&case.t_final);
    let histories = histories(&mut bar, &mut ledger, end);
    check_histories(case, &histories, end);
    check_profiles(case, &bar);
    common::assert_ledger(&ledger, name);
    // For an impact, momentum divided by mass and impact velocity is the coefficient of restitution.
    let strike = number(&case.velocity).abs();
    let scale = if strike > 0.0 { strike * bar_mass } else { 1.0 };
    let missed = (bar.account().energies.momentum - number(&case.momentum)) / scale;
    assert!(missed.abs() < MOMENTUM, "{name}: momentum off by {missed:.5}");
}

macro_rules! tests {
    ($($test:ident: $name:literal,)*) => {
        mod by_leapfrog {
            $(#[test]
            fn $test() {
                super::check($name, super::common::leapfrog);
            })*
        }

        mod by_muscl {
            $(#[test]
            fn $test() {
                super::check($name, super::muscl::muscl);
            })*
        }

        #[test]
        fn no_case_of_the_file_is_left_out() {
            let mut tested = vec![$($name),*];
            let mut all: Vec<&str> = cases().iter().map(|c| c.name.as_str()).collect();
            tested.sort_unstable();
            all.sort_unstable();
            assert_eq!(tested, all);
        }
    };
}

tests! {
    wall_half_5_4: "wall_r1/2_V5/4",
    wall_half_3_2: "wall_r1/2_V3/2",
    wall_half_2: "wall_r1/2_V2",
    wall_half_3: "wall_r1/2_V3",
    wall_third_2: "wall_r1/3_V2",
    wall_third_3: "wall_r1/3_V3",
    stress_pulse_3_2: "stresspulse_r1/2_S3/2",
    stress_pulse_2: "stresspulse_r1/2_S2",
    stress_pulse_3: "stresspulse_r1/2_S3",
    velocity_pulse_2: "velpulse_r1/2_V2",
    tension_fixed_1_2: "tension_fixed_r1/2_V1/2",
    tension_fixed_3_2: "tension_fixed_r1/2_V3/2",
    tension_free_3_2: "tension_free_r1/2_V3/2",
    wall_isotropic_2: "wall_iso_r1/2_V2",
    wall_kinematic_2: "wall_kin_r1/2_V2",
}
