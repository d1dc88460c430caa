//! Front tracking and the schemes on a grid on the same bars. These methods share little except the curve; their difference decreases with the cell
//! size.

use crate::common;
use crate::common::muscl;

use barwave::assemble::flow;
use barwave::bar::{Bar, EndCondition, History, Segment};
use barwave::material::{Beyond, Curve, Material};
use barwave::record::Stepped;
use barwave::scene::{Effects, HardeningRule};
use barwave::solver::fd::{Leapfrog, Quantity};
use barwave::solver::moc::{FrontTracking, Settings};
use barwave::solver::muscl::Muscl;

/// Bar, its ends, and the number of elastic transits that are simulated.
struct Case {
    name: &'static str,
    segments: Vec<Segment>,
    ends: [EndCondition; 2],
    hardening: HardeningRule,
    transits: f64,
}

/// Number of comparisons, evenly spread over the run: the positions of fronts in their cells vary, which a single comparison would show as noise.
const LOOKS: usize = 20;

impl Case {
    fn bar(&self) -> Bar {
        Bar { segments: self.segments.clone(), area_given: true }
    }

    fn leapfrog(&self, cells: usize) -> Leapfrog {
        common::leapfrog(self.segments.clone(), self.ends.clone(), Some(self.hardening), cells, 1.0)
    }

    fn muscl(&self, cells: usize) -> Muscl {
        muscl::muscl(self.segments.clone(), self.ends.clone(), Some(self.hardening), cells, 1.0)
    }

    /// Returns the relative L1 difference of stress over the bar and time from a bar on a grid at t = 0.
    fn difference(&self, mut grid: impl Stepped) -> f64 {
        let bar = self.bar();
        let until = self.transits * bar.transit_time();
        let effects = Effects { hardening: Some(self.hardening), ..Effects::default() };
        let mut tracked = FrontTracking::new(&bar, flow(&effects), self.ends.clone(), Settings::default());
        let mut stress = vec![0.0; grid.grid().cells()];
        let (x, mut exact) = (grid.grid().centres(), Vec::new());
        let (mut missed, mut total) = (0.0, 0.0);
        for look in 1..=LOOKS {
            let time = until * look as f64 / LOOKS as f64;
            while grid.time() < time - 0.5 * grid.grid().dt {
                grid.advance();
            }
            tracked.advance_to(grid.time()).unwrap_or_else(|e| panic!("{}: {e}", self.name));
            exact.clear();
            tracked.sweep(&x, |_, _, point| exact.push(point.stress));
            grid.profile(Quantity::Stress, &mut stress);
            for (found, exact) in stress.iter().zip(&exact) {
                missed += (found - exact).abs();
                total += exact.abs();
            }
        }
        missed / total
    }
}

fn steel(length: f64) -> Segment {
    common::segment(common::bilinear_steel(), length)
}

/// Returns a segment of a metal like aluminium: half as stiff, a third as heavy, yield at 280 MPa.
fn light(length: f64) -> Segment {
    let curve = Curve::new(&[(0.004, 280e6), (0.05, 500e6)], Beyond::Extend).expect("rows rise");
    common::segment(Material::from_curve("light", 2700.0, curve).expect("a material"), length)
}

fn let_go(velocity: f64, release: f64) -> EndCondition {
    EndCondition::Velocity { history: History::constant(velocity), release: Some(release) }
}

fn cases() -> Vec<Case> {
    let four = common::material(&[(0.001, 200e6), (0.004, 320e6), (0.012, 420e6), (0.05, 600e6)], Beyond::Extend);
    let transit = (7800.0_f64 / 200e9).sqrt();
    let case = |name, segments, ends, hardening, transits| Case { name, segments, ends, hardening, transits };
    let isotropic = HardeningRule::Isotropic;
    vec![
        case("struck, far end free", vec![steel(1.0)], [common::moved(20.0), EndCondition::Free], isotropic, 3.0),
        case("struck, far end fixed", vec![steel(1.0)], [common::moved(15.0), EndCondition::Fixed], isotropic, 3.0),
        case("pulled and let go", vec![steel(1.0)], [let_go(-20.0, 0.6 * transit), EndCondition::Free], isotropic, 2.5),
        case(
            "kinematic, let go",
            vec![steel(1.0)],
            [let_go(-25.0, 0.5 * transit), EndCondition::Free],
            HardeningRule::Kinematic,
            1.5,
        ),
        case(
            "four lines",
            vec![common::segment(four, 1.0)],
            [common::moved(-25.0), EndCondition::Free],
            isotropic,
            1.6,
        ),
        case(
            "a step in area",
            vec![Segment { area: 2.0, ..steel(0.5) }, steel(0.5)],
            [common::moved(15.0), EndCondition::Free],
            isotropic,
            1.4,
        ),
        case(
            "two materials",
            vec![steel(0.6), light(0.4)],
            [common::moved(20.0), EndCondition::Absorbing],
            isotropic,
            1.4,
        ),
        case(
            "against a wall",
            vec![Segment { velocity: -15.0, ..steel(1.0) }],
            [EndCondition::Wall { gap: 0.0 }, EndCondition::Free],
            isotropic,
            2.0,
        ),
    ]
}

/// The order is about 2/3, not 1, where plastic fronts travel along a straight line of the curve: there the wave equation is linear, and nothing
/// steepens a front that the grid has spread. A second-order scheme advects a jump of a linear equation with a third-derivative error, which spreads
/// it over h^(2/3) of length; the L1 error is this width times the jump. The order is 1 only where fronts are advected exactly (elastic ones at
/// Courant number 1), or where a stiffening curve keeps them sharp.
#[test]
fn the_difference_falls_with_the_cells() {
    for case in cases() {
        let [coarse, middle, fine] = [400, 1200, 3600].map(|cells| case.difference(case.leapfrog(cells)));
        let order = (coarse / fine).ln() / 9.0_f64.ln();
        println!("{:24} {coarse:.2e} {middle:.2e} {fine:.2e}  order {order:.2}", case.name);
        assert!(fine < middle && middle < coarse, "{}: {coarse:e} {middle:e} {fine:e}", case.name);
        // A second-order scheme spreads a front that does not travel at one cell per step over n^(1/3) of n cells, which is order 2/3 for the plastic
        // ones; the elastic ones are exact.
        assert!(order > 0.63, "{}: order {order}", case.name);
        assert!(fine < 5e-3, "{}: {fine:e}", case.name);
    }
}

/// The same holds for the conservative scheme: it shares the Riemann problem of front tracking for its flux, but not the advection of fronts.
#[test]
fn the_difference_of_muscl_falls_with_the_cells() {
    for case in cases() {
        let [coarse, middle, fine] = [300, 900, 2700].map(|cells| case.difference(case.muscl(cells)));
        let order = (coarse / fine).ln() / 9.0_f64.ln();
        println!("{:24} {coarse:.2e} {middle:.2e} {fine:.2e}  order {order:.2}", case.name);
        assert!(fine < middle && middle < coarse, "{}: {coarse:e} {middle:e} {fine:e}", case.name);
        assert!(order > 0.6, "{}: order {order}", case.name);
        assert!(fine < 6e-3, "{}: {fine:e}", case.name);
    }
}

#[test]
fn elastic_fronts_are_the_same_in_both_methods() {
    // At Courant number 1, a front moves from cell to cell without spreading, also at a step in area.
    let elastic = |area, length| Segment::new(length, area, common::elastic_steel());
    let case = Case {
        name: "elastic, a step in area",
        segments: vec![elastic(2.0, 0.5), elastic(1.0, 0.5)],
        ends: [common::moved(5.0), EndCondition::Free],
        hardening: HardeningRule::Isotropic,
        transits: 1.6,
    };
    for cells in [400, 3600] {
        let differences = [case.difference(case.leapfrog(cells)), case.difference(case.muscl(cells))];
        println!("{:24} {cells} cells: {differences:?}", case.name);
        // Rounding of sums over some thousand steps.
        assert!(differences.iter().all(|&d| d < 1e-11), "{cells}: {differences:?}");
    }
}

/// A bar in tension that is suddenly pushed, along a curve that is followed both ways: the shock of unloading stops at the yield stress in
/// compression, and slower plastic waves follow. Slopes (and, in leapfrog, a filter of the velocities after the step) must not keep the first of
/// them, up to 264 MPa, together with the shock, which would then be 1.18 times as fast at any resolution.
#[test]
fn a_shock_that_reverses_the_stress_splits_at_yield() {
    let curve = [(9.22e-4, 184.4e6), (8.50084e-3, 634.583e6)];
    let bar = Segment::new(1.0, 1.0, common::material(&curve, Beyond::Extend));
    let (c0, slope) = (bar.material.c0(), (curve[1].1 - curve[0].1) / (curve[1].0 - curve[0].0));
    let (c1, pulled, pushed) = (c0 * (slope / bar.material.modulus).sqrt(), 4.944e-3 * c0, -2.478e-3 * c0);
    let [turns, until] = [0.16, 0.56].map(|part| part / c0);
    let ends =
        || [EndCondition::Free, common::moved_by(&[(0.0, pulled), (turns, pulled), (turns, pushed), (1.0, pushed)])];
    // Length of the part with stress beyond yield, relative to the exact one, and the largest stress.
    let found = |stress: &[f64]| {
        let beyond = stress.iter().filter(|&&stress| stress < -1.2 * curve[0].1).count() as f64 / stress.len() as f64;
        (beyond / (c1 * (until - turns)), -stress.iter().copied().fold(0.0, f64::min))
    };
    for (cells, smeared) in [(400, 0.02), (1600, 0.01)] {
        let mut godunov = muscl::muscl(vec![bar.clone()], ends(), None, cells, 1.0);
        muscl::advance_to(&mut godunov, until);
        let (reach, largest) = found(&muscl::profile(&godunov, Quantity::Stress));
        println!("{cells} cells, Godunov scheme: {reach} of the way, {largest:e} Pa");
        assert!((reach - 1.0).abs() < smeared && (largest / 328.3e6 - 1.0).abs() < 2e-3, "{reach} {largest:e}");
        let mut leapfrog = common::leapfrog(vec![bar.clone()], ends(), None, cells, 1.0);
        common::advance_to(&mut leapfrog, until);
        let (reach, largest) = found(&common::profile(&leapfrog, Quantity::Stress));
        println!("{cells} cells, leapfrog: {reach} of the way, {largest:e} Pa");
        assert!((reach - 1.0).abs() < 0.05 && (largest / 328.3e6 - 1.0).abs() < 5e-3, "{reach} {largest:e}");
    }
}
