//! Properties of every law, with the loading table in every form in which it is evaluated.

use crate::common;

use barwave::law::rate::{Overstress, RateLaw, Timed};
use barwave::law::{
    ArmstrongFrederick, BackStress, Backbone, CellLaw, Envelope, Indexed, Isotropic, Line, Mixed, Overlay,
    PathIndependent, Searched, Table, TwoSided,
};
use barwave::material::{Beyond, Curve};
use common::MODULUS;

/// Material point: its stress, the state of its law, and E times its total strain.
struct Point<'a, L, const N: usize> {
    law: &'a L,
    sigma: f64,
    state: [f64; N],
    z: f64,
}

impl<'a, L: CellLaw<N>, const N: usize> Point<'a, L, N> {
    fn new(law: &'a L) -> Self {
        Self { law, sigma: 0.0, state: [0.0; N], z: 0.0 }
    }

    /// Applies an increment of E times strain; returns E times its plastic part.
    fn step(&mut self, increment: f64) -> f64 {
        let response = self.law.respond(self.sigma, self.law.base(self.sigma, self.state) + increment, self.state);
        (self.sigma, self.state) = (response.sigma, response.state);
        self.z += increment;
        response.plastic
    }

    /// Strains the point to a given strain in `count` equal steps; returns E times the work done, J/m^3.
    fn go_to(&mut self, z: f64, count: u32) -> f64 {
        let increment = (z - self.z) / f64::from(count);
        (0..count)
            .map(|_| {
                let before = self.sigma;
                self.step(increment);
                0.5 * (before + self.sigma) * increment
            })
            .sum()
    }
}

/// Returns increments of a strain path with alternating sign and growing amplitude up to about `reach`, the same in every run.
fn to_and_fro(reach: f64) -> Vec<f64> {
    let mut seed = 1_u64;
    let mut random = move || {
        seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (seed >> 11) as f64 / (1_u64 << 53) as f64
    };
    let mut path = Vec::new();
    let mut z = 0.0;
    for turn in 1..=24_u32 {
        let sign = if turn % 2 == 0 { -1.0 } else { 1.0 };
        let target = sign * random() * reach * f64::from(turn) / 24.0;
        let steps = 1 + (random() * 40.0) as u32;
        path.extend((0..steps).map(|_| (target - z) / f64::from(steps)));
        z = target;
    }
    path
}

/// Rounding of paths of about a thousand steps, relative to the largest E times strain on them.
const ROUND_OFF: f64 = 1e-12;

fn zero_at_rest<L: CellLaw<N>, const N: usize>(law: &L) {
    let mut point = Point::new(law);
    let plastic = point.step(0.0);
    assert_eq!((point.sigma, point.state, plastic), (0.0, [0.0; N], 0.0));
    assert_eq!((law.plastic_strain([0.0; N]), law.accumulated([0.0; N])), (0.0, 0.0));
}

/// Checks the mirror symmetry; `image` is the law with tension and compression exchanged.
fn mirrored<L: CellLaw<N>, const N: usize>(law: &L, image: &L, reach: f64) {
    let (mut here, mut there) = (Point::new(law), Point::new(image));
    for increment in to_and_fro(reach) {
        let (a, b) = (here.step(increment), there.step(-increment));
        assert_eq!((here.sigma, a), (-there.sigma, -b), "at {:e}", here.z);
        assert_eq!(law.plastic_strain(here.state), -image.plastic_strain(there.state));
        assert_eq!(law.accumulated(here.state), image.accumulated(there.state));
    }
}

/// Checks that the law is Hooke's law below yield, to the last bit.
fn elastic_before_yield<L: CellLaw<N>, const N: usize>(law: &L, yield_stress: f64) {
    let mut point = Point::new(law);
    let mut hooke = 0.0;
    for increment in to_and_fro(0.999 * yield_stress) {
        hooke += increment;
        assert_eq!(point.step(increment), 0.0);
        assert_eq!((point.sigma, point.state), (hooke, [0.0; N]));
    }
}

/// Checks that first loading in many small steps follows the table, and that the strain is the sum of its elastic and plastic parts.
fn reproduces_the_table<L: CellLaw<N>, const N: usize>(law: &L, table: &Table, sign: f64) {
    let reach = far(table);
    let (mut point, searched) = (Point::new(law), Searched(table.clone()));
    for _ in 0..5000 {
        point.step(sign * reach / 5000.0);
        let expected = sign * searched.stress(point.z.abs(), sign);
        assert!((point.sigma - expected).abs() < ROUND_OFF * reach, "{:e}: {:e}", point.z, point.sigma - expected);
        let plastic = law.plastic_strain(point.state);
        assert!((point.sigma + plastic - point.z).abs() < ROUND_OFF * reach);
        assert!((law.accumulated(point.state) - plastic.abs()).abs() < ROUND_OFF * reach);
    }
}

/// Checks that from the middle of each line the stress increases with the slope of the line, and decreases with this slope or elastically.
fn tangents<L: CellLaw<N>, const N: usize>(law: &L, table: &Table, unloads: bool) {
    let ends = table.lines().iter().skip(1).map(|l| l.start).chain([far(table)]);
    for (line, end) in table.lines().iter().zip(ends) {
        let (middle, little) = (0.5 * (line.start + end), 1e-3 * (end - line.start));
        let mut point = Point::new(law);
        point.go_to(middle, 50);
        for (increment, slope) in [(little, line.slope), (-little, if unloads { 1.0 } else { line.slope })] {
            let mut moved = Point { state: point.state, ..Point::new(law) };
            (moved.sigma, moved.z) = (point.sigma, point.z);
            moved.step(increment);
            let difference = (moved.sigma - point.sigma) / increment;
            // Rounding of stresses of this size, divided by the increment.
            assert!((difference - slope).abs() < ROUND_OFF * end / little, "{line:?}: {difference}");
        }
    }
}

/// Checks that the work over closed strain cycles is never negative, and zero to rounding if the curve is followed both ways.
fn cycles_dissipate<L: CellLaw<N>, const N: usize>(law: &L, reach: f64, unloads: bool) {
    let mut point = Point::new(law);
    let little = ROUND_OFF * reach * reach;
    for amplitude in [0.01, 0.1, 0.3, 0.3, 1.0] {
        let a = amplitude * reach;
        // Out and back over the same strains, on both sides.
        let work: f64 = [a, 0.0, -a, 0.0].into_iter().map(|z| point.go_to(z, 200)).sum();
        let largest_elastic = point.sigma;
        assert!(work > -little, "{amplitude}: {work:e}");
        assert!(unloads || work < little, "{amplitude}: {work:e}, {largest_elastic:e}");
    }
}

/// Checks that a cell that continues to flow at constant strain reaches the state to which loading would have brought it.
fn flows_on<L: CellLaw<N>, const N: usize>(law: &L, reach: f64, unloads: bool) {
    let (mut point, mut further) = (Point::new(law), Point::new(law));
    point.go_to(0.9 * reach, 2000);
    let plastic = point.step(5e-4 * reach);
    for size in [1e2, 1e4, 1e6] {
        // Flow that is large enough to include reverse flow, as in scene 14554826157596581714, must not produce energy.
        if let Some((after, work)) = law.complete_flow(point.sigma, size * plastic, point.state) {
            assert!(after.plastic * plastic > 0.0 && work > 0.0, "{after:?}, {work:e} of {plastic:e} times {size:e}");
        }
    }
    let flowed = law.complete_flow(point.sigma, 0.5 * plastic, point.state);
    assert_eq!(flowed.is_some(), unloads, "{plastic:e}: {flowed:?}");
    let Some((after, work)) = flowed else { return };
    assert!((after.plastic / plastic - 0.5).abs() < 1e-9, "{:e} of {plastic:e}", after.plastic);
    assert!((work / (2.0 * point.sigma * after.plastic) - 1.0).abs() < 1e-2, "{work:e}");
    let strain = after.sigma + law.plastic_strain(after.state);
    assert!((strain - point.z).abs() < ROUND_OFF * reach.abs(), "{strain:e}, not {:e}", point.z);
    (point.sigma, point.state) = (after.sigma, after.state);
    point.go_to(reach, 500);
    further.go_to(reach, 2500);
    assert!((point.sigma - further.sigma).abs() < 1e-9 * reach.abs(), "{:e}, not {:e}", point.sigma, further.sigma);
}

/// Returns E times the strain up to which tables are tested, Pa: within the last line.
fn far(table: &Table) -> f64 {
    1.2 * table.lines()[table.lines().len() - 1].start
}

/// Checks the properties of every law, with a table that is the same in tension and compression.
fn contract<L: CellLaw<N>, const N: usize>(law: &L, table: &Table, unloads: bool) {
    zero_at_rest(law);
    mirrored(law, law, far(table));
    elastic_before_yield(law, table.yield_stress());
    reproduces_the_table(law, table, 1.0);
    reproduces_the_table(law, table, -1.0);
    tangents(law, table, unloads);
    cycles_dissipate(law, far(table), unloads);
    flows_on(law, far(table), unloads);
    flows_on(law, -far(table), unloads);
}

/// Checks these properties with a table for each sense; `image` is the law with the two exchanged.
fn two_sided_contract<L: CellLaw<N>, const N: usize>(
    law: &L,
    image: &L,
    [tension, compression]: [&Table; 2],
    unloads: bool,
) {
    let reach = far(tension).max(far(compression));
    zero_at_rest(law);
    mirrored(law, image, reach);
    elastic_before_yield(law, tension.yield_stress().min(compression.yield_stress()));
    reproduces_the_table(law, tension, 1.0);
    reproduces_the_table(law, compression, -1.0);
    tangents(law, tension, unloads);
    cycles_dissipate(law, reach, unloads);
    flows_on(law, far(tension), unloads);
    flows_on(law, -far(compression), unloads);
}

/// Checks that plastic flow dissipates energy in every step: stress times plastic increment is never negative.
fn isotropic_flow_dissipates<B: Backbone>(law: &Isotropic<B>, reach: f64) {
    let mut point = Point::new(law);
    for increment in to_and_fro(reach) {
        let plastic = point.step(increment);
        assert!(point.sigma * plastic >= 0.0, "{:e} {plastic:e}", point.sigma);
    }
}

/// Checks that the stress minus the back stress dissipates energy; the rest of the work is stored, and can be returned.
fn moving_flow_dissipates<L: CellLaw<N>, const N: usize>(law: &L, reach: f64) {
    let mut point = Point::new(law);
    for increment in to_and_fro(reach) {
        let plastic = point.step(increment);
        let above_back_stress = point.sigma - law.back_stress(point.state);
        assert!(above_back_stress * plastic >= 0.0, "{above_back_stress:e} {plastic:e}");
    }
}

fn mixed_without_kinematic_part_is_isotropic<B: Backbone + Clone>(backbone: &B, table: &Table) {
    let isotropic = Isotropic(backbone.clone());
    let mixed = Mixed { backbone: backbone.clone(), yield_stress: table.yield_stress(), kinematic: 0.0 };
    let (mut one, mut other) = (Point::new(&isotropic), Point::new(&mixed));
    let reach = far(table);
    for increment in to_and_fro(reach) {
        let plastic = one.step(increment) - other.step(increment);
        assert!((one.sigma - other.sigma).abs() < ROUND_OFF * reach && plastic.abs() < ROUND_OFF * reach);
    }
}

/// Checks the Bauschinger effect: after loading, reverse flow starts when the stress has decreased by twice the initial yield stress.
fn kinematic_keeps_its_elastic_range<B: Backbone>(law: &Mixed<B>, table: &Table) {
    let mut point = Point::new(law);
    point.go_to(far(table), 1000);
    let top = point.sigma;
    let little = 1e-4 * law.yield_stress;
    while point.step(-little) == 0.0 {}
    let range = top - point.sigma;
    // Up to the step in which flow starts.
    assert!((range - 2.0 * law.yield_stress).abs() <= 1.01 * little, "{range:e}");
}

fn every_law<B: Backbone + Clone>(backbone: &B, table: &Table) {
    let yield_stress = table.yield_stress();
    let mixed = |kinematic| Mixed { backbone: backbone.clone(), yield_stress, kinematic };
    contract(&PathIndependent(backbone.clone()), table, false);
    contract(&Isotropic(backbone.clone()), table, true);
    isotropic_flow_dissipates(&Isotropic(backbone.clone()), far(table));
    for kinematic in [0.0, 0.3, 1.0] {
        contract(&mixed(kinematic), table, true);
        moving_flow_dissipates(&mixed(kinematic), far(table));
    }
    for (limit, gamma) in [(0.4, 1e3), (0.9, 50.0)] {
        let back = BackStress::new(limit * yield_stress * gamma, gamma, MODULUS);
        let law = ArmstrongFrederick::new(backbone.clone(), back);
        contract(&law, table, true);
        moving_flow_dissipates(&law, far(table));
    }
    if table.is_multilinear() {
        contract(&Overlay::new(backbone.clone(), table), table, true);
    }
    mixed_without_kinematic_part_is_isotropic(backbone, table);
    kinematic_keeps_its_elastic_range(&mixed(1.0), table);
}

/// A back stress without recall that increases as the curve leaves the size of the elastic range unchanged.
#[test]
fn armstrong_frederick_without_recall_is_kinematic_along_one_line() {
    let (table, hardening) = (bilinear(), 20e9);
    let backbone = Searched(table.clone());
    let rise = hardening / (1.0 - hardening / MODULUS);
    let law = ArmstrongFrederick::new(backbone.clone(), BackStress::new(rise, 1e-9, MODULUS));
    let kinematic = Mixed { backbone, yield_stress: table.yield_stress(), kinematic: 1.0 };
    let (mut one, mut other) = (Point::new(&law), Point::new(&kinematic));
    let reach = far(&table);
    for increment in to_and_fro(reach) {
        let plastic = one.step(increment) - other.step(increment);
        assert!((one.sigma - other.sigma).abs() < ROUND_OFF * reach && plastic.abs() < ROUND_OFF * reach);
    }
}

fn table(rows: &[(f64, f64)], beyond: Beyond) -> Table {
    Table::new(&Curve::new(rows, beyond).expect("rows rise"), MODULUS)
}

fn bilinear() -> Table {
    table(&[(0.001, 200e6), (0.021, 600e6)], Beyond::Extend)
}

/// Returns a table with three slopes and a level end.
fn three_slopes() -> Table {
    table(&[(0.001, 200e6), (0.01, 300e6), (0.05, 400e6)], Beyond::Rupture)
}

fn power_law() -> Table {
    Table::new(&common::power_law_steel().tension, MODULUS)
}

/// Returns a table with a yield drop, then increasing slopes (lock-up), which is not concave.
fn s_shaped() -> Table {
    let rows = [(0.0015, 300e6), (0.0016, 250e6), (0.02, 280e6), (0.03, 400e6), (0.04, 900e6), (0.05, 950e6)];
    table(&rows, Beyond::Extend)
}

/// Returns a table that is as steep as the elastic line between two rows, without plastic strain.
fn elastic_in_between() -> Table {
    table(&[(0.001, 200e6), (0.003, 240e6), (0.0035, 339_999_999.999_98), (0.02, 500e6)], Beyond::Extend)
}

/// A cell at the top of such a line that unloads is within its elastic range, and on the line to rounding: no hardening may be lost, as in scene
/// 12510585834813658275, where it would cost 1.5 % of the energy.
#[test]
fn unloading_along_a_line_as_steep_as_the_elastic_one_loses_no_hardening() {
    let rows = [
        (4.47e-4, 5.363_999_999_995e7),
        (9.6552e-4, 7.081_338_239_993e7),
        (3.9336e-3, 2.264_594_975_998e8),
        (4.434_24e-3, 2.865_362_975_997e8),
        (5.176_26e-3, 3.146_736_959_997e8),
    ];
    let table = Table::new(&Curve::new(&rows, Beyond::Rupture).expect("rows rise"), 120e9);
    let law = Mixed { backbone: Searched(table.clone()), yield_stress: table.yield_stress(), kinematic: 0.975 };
    let sigma = 2.718_599_079_005_897e8;
    let state = [245_572_502.400_199_98, 245_533_985.433_327_17, 222_112_910.124_935_87, 227_822_796.212_266_62];
    for ulps in -20..20 {
        let predictor = sigma - 8.023_972_254_990_886e7 + f64::from(ulps) * 3e-8;
        let after = law.respond(sigma, predictor, state);
        assert_eq!((after.sigma, after.state, after.plastic), (predictor, state, 0.0), "{ulps}");
    }
}

#[test]
fn laws_on_an_envelope_of_two_lines() {
    let table = bilinear();
    every_law(&Envelope::<2>::new(&table).expect("fits"), &table);
}

#[test]
fn laws_on_an_envelope_of_four_lines() {
    let table = three_slopes();
    assert!(Envelope::<2>::new(&table).is_none());
    every_law(&Envelope::<4>::new(&table).expect("fits"), &table);
}

#[test]
fn laws_on_an_envelope_of_eight_lines() {
    let rows: Vec<(f64, f64)> =
        (0..7_i32).map(|k| 0.001 * 2.0_f64.powi(k)).map(|e| (e, 200e6 * (e / 0.001).powf(0.3))).collect();
    let table = table(&rows, Beyond::Rupture);
    assert_eq!(table.lines().len(), 8);
    every_law(&Envelope::<8>::new(&table).expect("fits"), &table);
}

#[test]
fn laws_on_an_indexed_table() {
    for table in [bilinear(), three_slopes(), power_law(), s_shaped(), elastic_in_between()] {
        every_law(&Indexed::new(&table).expect("fits"), &table);
    }
}

#[test]
fn laws_on_a_searched_table() {
    for table in [bilinear(), three_slopes(), power_law(), s_shaped(), elastic_in_between()] {
        every_law(&Searched(table.clone()), &table);
    }
}

#[test]
fn laws_on_a_table_for_each_sense_that_are_equal() {
    let table = power_law();
    let indexed = Indexed::new(&table).expect("fits");
    every_law(&TwoSided { tension: indexed.clone(), compression: indexed }, &table);
}

#[test]
fn laws_on_different_tables_in_tension_and_compression() {
    let (tension, compression) = (three_slopes(), s_shaped());
    let two = TwoSided { tension: Searched(tension.clone()), compression: Searched(compression.clone()) };
    let swapped = TwoSided { tension: Searched(compression.clone()), compression: Searched(tension.clone()) };
    let tables = [&tension, &compression];
    two_sided_contract(&PathIndependent(two.clone()), &PathIndependent(swapped.clone()), tables, false);
    two_sided_contract(&Isotropic(two.clone()), &Isotropic(swapped), tables, true);
    isotropic_flow_dissipates(&Isotropic(two), far(&tension));
}

#[test]
fn equal_neighbouring_slopes_are_one_line() {
    let table = table(&[(0.0005, 100e6), (0.001, 200e6), (0.011, 400e6), (0.021, 600e6)], Beyond::Extend);
    let [elastic, plastic] = table.lines() else { panic!("{:?}", table.lines()) };
    assert_eq!(*elastic, Line { start: 0.0, offset: 0.0, slope: 1.0 });
    assert!((plastic.start - 200e6).abs() < 1e-6 && (plastic.slope - 0.1).abs() < 1e-12);
}

const RATES: [Overstress; 5] = [
    Overstress::Malvern { k: 1e6 },
    Overstress::CowperSymonds { rate: MODULUS * 40.0, exponent: 5.0 },
    Overstress::CowperSymonds { rate: MODULUS * 40.0, exponent: 1.0 },
    Overstress::CowperSymonds { rate: MODULUS * 40.0, exponent: 0.5 },
    Overstress::JohnsonCook { c: 0.014, rate: MODULUS },
];

/// Checks the properties with steps so long that all overstress relaxes in each, and a path with steps of any length.
fn timed_contract<const N: usize>(table: &Table, kinematic: f64) {
    for overstress in RATES {
        let law = |time| Timed::<N>::new(RateLaw::new(overstress, table, None, kinematic), time);
        contract(&law(1e60), table, true);
        for time in [1e-300, 1e-12, 1e-8, 1e-6, 1e-3, 1.0, 1e60] {
            zero_at_rest(&law(time));
            mirrored(&law(time), &law(time), far(table));
            elastic_before_yield(&law(time), table.yield_stress());
            never_below_the_static_curve(&law(time), table);
        }
        // Without time, the law is Hooke's.
        let (frozen, mut hooke) = (law(0.0), 0.0);
        let mut point = Point::new(&frozen);
        for increment in to_and_fro(far(table)) {
            hooke += increment;
            point.step(increment);
            assert_eq!(point.sigma, hooke);
        }
    }
}

/// Checks that the stress of first loading is between the static curve and the elastic line, and that the strain is the sum of its parts.
fn never_below_the_static_curve<const N: usize>(law: &Timed<N>, table: &Table) {
    let (mut point, searched, reach) = (Point::new(law), Searched(table.clone()), far(table));
    for _ in 0..500 {
        point.step(reach / 500.0);
        let lowest = searched.stress(point.z, 1.0);
        assert!(point.sigma >= lowest - ROUND_OFF * reach, "{law:?} at {:e}: {:e} {lowest:e}", point.z, point.sigma);
        assert!(point.sigma <= point.z * (1.0 + ROUND_OFF));
        assert!((point.sigma + law.plastic_strain(point.state) - point.z).abs() < ROUND_OFF * reach);
        assert!(law.overstress_work(point.state) >= 0.0);
    }
}

#[test]
fn rate_laws_keep_the_contract() {
    for table in [bilinear(), three_slopes(), power_law(), s_shaped(), elastic_in_between()] {
        timed_contract::<5>(&table, 0.0);
        timed_contract::<6>(&table, 0.3);
        timed_contract::<6>(&table, 1.0);
    }
}

#[test]
fn quick_flow_is_the_rate_independent_law() {
    for table in [bilinear(), three_slopes(), power_law()] {
        let backbone = Searched(table.clone());
        let timed = Timed::<5>::new(RateLaw::new(RATES[0], &table, None, 0.0), 1e60);
        quick_as(&timed, &Isotropic(backbone.clone()), far(&table));
        for kinematic in [0.3, 1.0] {
            let timed = Timed::<6>::new(RateLaw::new(RATES[0], &table, None, kinematic), 1e60);
            let mixed = Mixed { backbone: backbone.clone(), yield_stress: table.yield_stress(), kinematic };
            quick_as(&timed, &mixed, far(&table));
        }
    }
}

fn quick_as<A: CellLaw<N>, B: CellLaw<M>, const N: usize, const M: usize>(timed: &A, law: &B, reach: f64) {
    let (mut one, mut other) = (Point::new(timed), Point::new(law));
    for increment in to_and_fro(reach) {
        let plastic = one.step(increment) - other.step(increment);
        assert!((one.sigma - other.sigma).abs() < ROUND_OFF * reach && plastic.abs() < ROUND_OFF * reach);
        assert!(
            timed.overstress_work(one.state).abs() < ROUND_OFF * reach * reach,
            "nothing is left to the overstress"
        );
    }
}

/// A cell strained at a constant rate with Malvern's law on a level curve has the overstress E rate/k (1 - exp(-k t)). Steps of a flowing cell follow
/// it exactly. In the step in which it yields, part of the strain is treated as a jump, with an error of third order in the step.
#[test]
fn a_cell_strained_evenly_follows_its_differential_equation() {
    let flat = table(&[(0.001, 200e6), (0.1, 200e6)], Beyond::Extend);
    let (k, rate, until) = (1e6, 1e3, 2e-6);
    let steady = MODULUS * rate / k;
    let exact = steady * (1.0 - f64::exp(-k * until));
    let error = |steps: u32| {
        let time = until / f64::from(steps);
        let timed = Timed::<5>::new(RateLaw::new(Overstress::Malvern { k }, &flat, None, 0.0), time);
        let mut point = Point::new(&timed);
        point.step(200e6);
        point.step(MODULUS * rate * time);
        let first = point.sigma - 200e6;
        point.go_to(200e6 + MODULUS * rate * until, steps - 1);
        let found = point.sigma - 200e6;
        let goes_on = steady + (first - steady) * f64::exp(-k * (until - time));
        assert!((found / goes_on - 1.0).abs() < 1e-14 * f64::from(steps), "{steps}: {found:e} {goes_on:e}");
        (found / exact - 1.0).abs()
    };
    // From two relaxation times per step.
    for steps in [1, 2, 3, 10] {
        let error = error(steps);
        assert!(error < 0.01 * (k * until / f64::from(steps)).powi(3), "{steps}: {error:e}");
    }
    let errors = [20, 40, 80].map(error);
    for pair in errors.windows(2) {
        let order = (pair[0] / pair[1]).log2();
        // The next term is of fourth order: k dt/3 of this one.
        assert!((order - 3.0).abs() < 0.05, "{errors:?}");
    }
}
