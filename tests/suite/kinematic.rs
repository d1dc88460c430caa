//! Kinematic hardening along a curve of several lines: Masing's rule, against the equivalent model of parallel elements.

use crate::common;
use crate::common::muscl;

use std::path::PathBuf;
use std::process::Command;

use barwave::bar::{EndCondition, Segment};
use barwave::law::{Backbone, CellLaw, Indexed, Mixed, Overlay, Searched, Table};
use barwave::material::{Beyond, Curve, Material};
use barwave::record::store::ResultFile;
use barwave::record::{Field, Ledger};
use barwave::scene::{HardeningRule, Scene};
use barwave::solver::fd::Quantity;
use barwave::wave::riemann::{Flow, Medium, Path, Point as Riemann};
use proptest::prelude::*;

/// Number of state variables of the law, and of the reversals that it stores.
const N: usize = 13;
const DEPTH: usize = 8;

/// Aluminium, 70 GPa: yield at 95 MPa, then a power law to 137.6 MPa at a strain of 0.6 %, in 40 lines.
const ALUMINIUM: f64 = 70e9;

fn aluminium_curve(lines: u32) -> Curve {
    let (first, exponent) = (95e6 / ALUMINIUM, (137.6_f64 / 95.0).ln() / (0.006 * ALUMINIUM / 95e6).ln());
    let strain = |k: u32| first * (0.03 / first).powf(f64::from(k) / f64::from(lines));
    let mut rows: Vec<(f64, f64)> =
        (0..=lines).map(strain).chain([0.006]).map(|e| (e, 95e6 * (e / first).powf(exponent))).collect();
    rows.sort_by(|a, b| a.0.total_cmp(&b.0));
    Curve::new(&rows, Beyond::Extend).expect("rows rise")
}

fn aluminium() -> Table {
    Table::new(&aluminium_curve(40), ALUMINIUM)
}

/// Material point under a prescribed strain.
struct Point<L, const N: usize> {
    law: L,
    sigma: f64,
    state: [f64; N],
    z: f64,
}

impl<L: CellLaw<N>, const N: usize> Point<L, N> {
    fn new(law: L) -> Self {
        Self { law, sigma: 0.0, state: [0.0; N], z: 0.0 }
    }

    /// Strains the point to E times a strain, `z`, in one step; returns E times the plastic work per volume.
    fn to(&mut self, z: f64) -> f64 {
        let predictor = self.law.base(self.sigma, self.state) + (z - self.z);
        let after = self.law.respond(self.sigma, predictor, self.state);
        let work = 0.5 * (self.sigma + after.sigma) * after.plastic;
        (self.sigma, self.state, self.z) = (after.sigma, after.state, z);
        work
    }

    /// Strains the point in equal steps; returns the stresses.
    fn in_steps(&mut self, z: f64, count: u32) -> Vec<f64> {
        let from = self.z;
        (1..=count)
            .map(|k| {
                self.to(from + (z - from) * f64::from(k) / f64::from(count));
                self.sigma
            })
            .collect()
    }
}

fn point(table: &Table) -> Point<Overlay<Searched>, N> {
    Point::new(Overlay::new(Searched(table.clone()), table))
}

/// Besseling's model: parallel elastic-perfectly-plastic elements and a spring.
struct Elements {
    /// For each element, its modulus divided by E, E times its yield strain, and E times its plastic strain.
    elements: Vec<[f64; 3]>,
    spring: f64,
}

impl Elements {
    fn new(table: &Table) -> Self {
        let lines = table.lines().windows(2);
        let elements = lines.map(|pair| [pair[0].slope - pair[1].slope, pair[1].start, 0.0]).collect();
        Self { elements, spring: table.lines().last().expect("a line").slope }
    }

    /// Returns the stress at E times a strain.
    fn to(&mut self, z: f64) -> f64 {
        let mut stress = self.spring * z;
        for [modulus, limit, plastic] in &mut self.elements {
            let elastic = (z - *plastic).clamp(-*limit, *limit);
            (*plastic, stress) = (z - elastic, stress + *modulus * elastic);
        }
        stress
    }

    /// Returns E times the elastic energy per volume that remains after elastic unloading.
    fn stored(&self, z: f64, stress: f64) -> f64 {
        let parts = self.elements.iter().map(|[modulus, _, plastic]| 0.5 * modulus * (z - plastic).powi(2));
        parts.sum::<f64>() + 0.5 * self.spring * z * z - 0.5 * stress * stress
    }
}

/// Returns a generator of pseudo-random numbers between -1 and 1.
fn noise(seed: u64) -> impl FnMut() -> f64 {
    let mut seed = seed;
    move || {
        seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (seed >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
    }
}

#[test]
fn cycles_of_constant_strain_are_closed_and_symmetric() {
    let table = aluminium();
    let (mut point, tip) = (point(&table), 0.006 * ALUMINIUM);
    let mut loops = Vec::new();
    for cycle in 0..50 {
        let up = point.in_steps(tip, 97);
        assert!((up[96] - 137.6e6).abs() < 1e-12 * 137.6e6 * 10.0, "cycle {cycle}: {}", up[96]);
        let down = point.in_steps(-tip, 97);
        assert!((down[96] + 137.6e6).abs() < 1e-12 * 137.6e6 * 10.0, "cycle {cycle}: {}", down[96]);
        loops.push([up, down].concat());
    }
    for later in &loops[2..] {
        let apart = later.iter().zip(&loops[1]).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        assert!(apart < 1e-12 * 137.6e6, "loops apart by {apart:e} Pa");
    }
    // Neither holds for an elastic range that moves with the accumulated plastic strain.
    let mut old = Point::new(Mixed { backbone: Searched(table.clone()), yield_stress: 95e6, kinematic: 1.0 });
    let tips = [tip, -tip, tip].map(|z| *old.in_steps(z, 97).last().expect("97 of them"));
    assert!((tips[0] - 137.6e6).abs() < 1.0 && tips[1] > -90e6 && tips[2] < 130e6, "{tips:?}");
}

#[test]
fn unloading_follows_the_curve_doubled_in_size() {
    let table = aluminium();
    let curve = Searched(table.clone());
    for tip in [0.0015, 0.004, 0.02].map(|e| e * ALUMINIUM) {
        let mut point = point(&table);
        point.in_steps(tip, 31);
        let top = point.sigma;
        for k in 1..=200 {
            let z = tip - 2.0 * tip * f64::from(k) / 200.0;
            point.to(z);
            let doubled = top - 2.0 * curve.stress(0.5 * (tip - z), 1.0);
            assert!((point.sigma - doubled).abs() < 1e-13 * ALUMINIUM * 0.02, "{} for {doubled}", point.sigma);
        }
        // Beyond the mirror image of the tip, first loading continues.
        point.in_steps(-1.3 * tip, 7);
        assert!((point.sigma + curve.stress(1.3 * tip, 1.0)).abs() < 1e-13 * ALUMINIUM * 0.02);
    }
}

/// Madelung's rules: a loop inside a branch closes at its starting point, and the branch continues as without it.
#[test]
fn inner_loops_close_and_are_forgotten() {
    let table = aluminium();
    let unit = 0.001 * ALUMINIUM;
    let path = |points: &[f64]| {
        let mut point = point(&table);
        let stresses: Vec<f64> = points.iter().map(|z| *point.in_steps(z * unit, 23).last().expect("a step")).collect();
        (stresses, point)
    };
    let near = |a: f64, b: f64| (a - b).abs() < 1e-12 * 137.6e6;
    // A loop 2 .. -2, inside it 1.5 .. -1.9, inside that 1.4.
    let (plain, _) = path(&[6.0, -2.0, 7.0, 8.0]);
    let (looped, with) = path(&[6.0, -2.0, 5.0, -1.0, 4.5, 0.5, 7.0, 8.0]);
    assert!(near(plain[2], looped[6]) && near(plain[3], looped[7]), "{plain:?} {looped:?}");
    let (_, without) = path(&[8.0]);
    // The loop is forgotten: afterwards, the stress at any strain is the same.
    let (mut with, mut without) = (with, without);
    for z in [-3.0, 2.0, -9.0, 1.0] {
        with.to(z * unit);
        without.to(z * unit);
        assert!(near(with.sigma, without.sigma), "at {z}: {} and {}", with.sigma, without.sigma);
    }
    // The loop itself closes.
    let (stresses, _) = path(&[6.0, 1.0, 5.0, 1.0, 5.0]);
    assert!(near(stresses[1], stresses[3]) && near(stresses[2], stresses[4]), "{stresses:?}");
}

/// Random curves of any number of lines, some with a level end, some with an elastic limit of 0.
fn tables() -> impl Strategy<Value = Table> {
    let falls = prop::collection::vec(0.3..0.9_f64, 2..12);
    let widths = prop::collection::vec(0.2..2.0_f64, 12);
    (falls, widths, any::<bool>(), any::<bool>()).prop_map(|(falls, widths, level, at_once)| {
        let (mut e, mut s, mut slope) = (0.0, 0.0, if at_once { 0.8 } else { 1.0 });
        let mut rows = Vec::new();
        for (fall, width) in falls.iter().zip(&widths) {
            (e, s) = (e + width, s + width * slope);
            rows.push((e, s));
            slope *= fall;
        }
        let curve = Curve::new(&rows, if level { Beyond::Rupture } else { Beyond::Extend });
        Table::new(&curve.expect("rows rise"), 1.0)
    })
}

/// Returns turning points, of which no more are open at a time than the law can store, and then one beyond all of them.
fn turning_points(seed: u64, count: usize) -> Vec<f64> {
    let mut random = noise(seed);
    let mut open: Vec<f64> = Vec::new();
    let mut turn = |_| {
        let z = if open.len() >= DEPTH { -1.01 * open[0] } else { 12.0 * random() };
        open.push(z);
        while let [.., a, b, c] = open[..] {
            if (c - b) * (b - a) >= 0.0 {
                open.remove(open.len() - 2);
            } else if (c - b).abs() >= (b - a).abs() {
                open.drain(open.len() - 3..open.len() - 1);
            } else {
                break;
            }
        }
        if open.len() == 2 && open[1].abs() >= open[0].abs() {
            open.remove(0);
        }
        z
    };
    (0..count).map(&mut turn).collect()
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 400, ..ProptestConfig::default() })]

    #[test]
    fn any_history_is_that_of_the_elements(table in tables(), seed in any::<u64>(), steps in 1_u32..6) {
        let (mut point, mut elements) = (point(&table), Elements::new(&table));
        let mut accumulated = 0.0;
        for z in turning_points(seed, 60) {
            let from = point.z;
            for k in 1..=steps {
                let z = from + (z - from) * f64::from(k) / f64::from(steps);
                let expected = elements.to(z);
                let before = point.state[1];
                point.to(z);
                accumulated += (point.state[1] - before).abs();
                prop_assert!((point.sigma - expected).abs() < 1e-12 * 12.0, "{} for {expected}", point.sigma);
            }
            prop_assert!((point.law.accumulated(point.state) - accumulated).abs() < 1e-12 * (1.0 + accumulated));
            prop_assert!((point.sigma + point.law.plastic_strain(point.state) - z).abs() < 1e-12 * 12.0);
        }
    }

    #[test]
    fn the_mirrored_history_has_the_mirrored_bits(table in tables(), seed in any::<u64>()) {
        let (mut image, mut point) = (point(&table), point(&table));
        let mut random = noise(seed);
        for _ in 0..300 {
            let z = 9.0 * random();
            point.to(z);
            image.to(-z);
            prop_assert_eq!(point.sigma.to_bits(), (-image.sigma).to_bits());
            prop_assert_eq!(point.state[0].to_bits(), image.state[0].to_bits());
            prop_assert_eq!(point.state[1], -image.state[1]);
        }
    }

    /// The plastic work minus the energy stored in the elements is heat, which never decreases.
    #[test]
    fn heat_only_grows(table in tables(), seed in any::<u64>()) {
        let (mut point, mut elements) = (point(&table), Elements::new(&table));
        let (mut heat, mut work) = (0.0_f64, 0.0);
        for z in turning_points(seed, 40) {
            let from = point.z;
            for k in 1..=400 {
                let z = from + (z - from) * f64::from(k) / 400.0;
                elements.to(z);
                work += point.to(z);
                let now = work - elements.stored(z, point.sigma);
                // The error of the trapezoidal rule in a step across a knot is at most proportional to the square of the step.
                let rounding = 1e-12 * (1.0 + work.abs()) + 0.25 * (12.0 * 2.0 / 400.0_f64).powi(2);
                prop_assert!(now >= heat - rounding, "{now} after {heat}");
                heat = heat.max(now);
            }
        }
    }

    #[test]
    fn the_slope_is_that_of_the_curve(table in tables(), seed in any::<u64>()) {
        let mut point = point(&table);
        let slopes: Vec<f64> = table.lines().iter().map(|line| line.slope).collect();
        for z in turning_points(seed, 30) {
            point.to(z);
            for d in [1e-7, -1e-7] {
                let mut near = Point { law: point.law.clone(), sigma: point.sigma, state: point.state, z: point.z };
                near.to(z + d);
                let one = (near.sigma - point.sigma) / d;
                near.to(z + 2.0 * d);
                let two = (near.sigma - point.sigma) / (2.0 * d);
                // Except for a knot within the step, the slope is the elastic one or one of the curve.
                let known = slopes.iter().chain([&1.0]).any(|slope| (slope - one).abs() < 1e-6);
                prop_assert!(known || (one - two).abs() > 1e-6, "slope {one}, {two}");
            }
        }
    }

    /// With more open reversals than the law stores, the stress remains continuous, within the range of the elements and near theirs.
    #[test]
    fn histories_of_any_depth_stay_near_the_elements(table in tables(), seed in any::<u64>()) {
        let (mut point, mut elements) = (point(&table), Elements::new(&table));
        let mut random = noise(seed);
        let mut amplitude = 10.0;
        let mut sense = 1.0;
        for turn in 0..40 {
            let z = sense * amplitude;
            let from = point.z;
            for k in 1..=50 {
                let z = from + (z - from) * f64::from(k) / 50.0;
                let (before, z_before, expected) = (point.sigma, point.z, elements.to(z));
                point.to(z);
                prop_assert!((point.sigma - before).abs() <= (z - z_before).abs() * (1.0 + 1e-9) + 1e-12);
                if turn <= DEPTH {
                    prop_assert!((point.sigma - expected).abs() < 1e-12 * 12.0);
                }
                prop_assert!((point.sigma - expected).abs() <= 0.05 * 10.0, "{turn}: {} for {expected}", point.sigma);
            }
            (sense, amplitude) = (-sense, amplitude * (0.9 + 0.09 * random()));
        }
    }
}

fn overlay(table: &Table) -> Overlay<Indexed> {
    Overlay::new(Indexed::new(table).expect("fits"), table)
}

#[test]
fn below_yield_it_is_the_elastic_law_to_the_last_bit() {
    let table = aluminium();
    let mut point = Point::new(overlay(&table));
    let mut random = noise(3);
    for _ in 0..1000 {
        let z = 94.9e6 * random();
        let elastic = point.sigma + (z - point.z);
        point.to(z);
        assert_eq!((point.sigma, point.state), (elastic, [0.0; N]));
    }
}

fn bar(lines: u32) -> Vec<Segment> {
    let material = Material::from_curve("aluminium", 2700.0, aluminium_curve(lines)).expect("a material");
    vec![common::segment(material, 1.0)]
}

/// Returns ends that pull, push and pull again.
fn to_and_fro(transit: f64) -> [EndCondition; 2] {
    let stress = |t: f64, mpa: f64| (t * transit, mpa * 1e6);
    let rows = [(0.0, 0.0), (0.2, 130.0), (0.4, 130.0), (0.8, -125.0), (1.0, -125.0), (1.4, 128.0), (3.0, 120.0)];
    [common::loaded_by(&rows.map(|(t, s)| stress(t, s))), EndCondition::Fixed]
}

fn apart(one: &[f64], other: &[f64]) -> f64 {
    let ratio = other.len() / one.len();
    let mean = |k: usize| other[k * ratio..(k + 1) * ratio].iter().sum::<f64>() / ratio as f64;
    let sum: f64 = one.iter().enumerate().map(|(k, s)| (s - mean(k)).abs()).sum();
    sum / one.iter().map(|s| s.abs()).sum::<f64>()
}

#[test]
fn a_bar_pulled_and_pushed_comes_out_alike_by_both_schemes() {
    let transit = (2700.0 / ALUMINIUM).sqrt();
    let kinematic = Some(HardeningRule::Kinematic);
    let grid = |cells: usize| {
        let mut bar = common::leapfrog(bar(12), to_and_fro(transit), kinematic, cells, 1.0);
        let mut ledger = Ledger::new(&bar);
        for _ in 0..20 {
            common::advance(&mut bar, cells / 10);
            ledger.row(&bar);
        }
        common::assert_ledger(&ledger, "leapfrog");
        [Quantity::Stress, Quantity::PlasticStrain].map(|q| common::profile(&bar, q))
    };
    let conservative = |cells: usize| {
        let mut bar = muscl::muscl(bar(12), to_and_fro(transit), kinematic, cells, 1.0);
        muscl::advance_with_ledger(&mut bar, 2.0 * transit);
        [Quantity::Stress, Quantity::PlasticStrain].map(|q| muscl::profile(&bar, q))
    };
    let fine = grid(6400);
    for (k, fine) in fine.iter().enumerate() {
        let by_leapfrog = [200, 400, 800].map(|cells| apart(&grid(cells)[k], fine));
        let by_muscl = [200, 400, 800].map(|cells| apart(&conservative(cells)[k], fine));
        println!("leapfrog {by_leapfrog:?} muscl {by_muscl:?}");
        assert!(by_leapfrog[2] < 0.01 && by_muscl[2] < 0.01, "{by_leapfrog:?} {by_muscl:?}");
        assert!(by_leapfrog[2] < 0.6 * by_leapfrog[0] && by_muscl[2] < 0.6 * by_muscl[0]);
    }
    let old = {
        let mut bar = common::leapfrog(bar(12), to_and_fro(transit), Some(HardeningRule::Mixed(1.0)), 800, 1.0);
        common::advance_to(&mut bar, 2.0 * transit);
        common::profile(&bar, Quantity::Stress)
    };
    println!("the other rule {:.2e}", apart(&old, &fine[0]));
    assert!(apart(&old, &fine[0]) > 0.03);
}

/// Returns a scene with such a bar; `rest` is the rest of `[solve]`.
fn scene(table: &str, hardening: &str, rest: &str) -> String {
    format!(
        "[bar]\nlength = \"1 m\"\narea = \"1 cm^2\"\n[bar.material]\nname = \"own\"\ndensity = \"2700 kg/m^3\"\n\
         modulus = \"70 GPa\"\nmeasure = \"engineering\"\nbeyond = \"extend\"\n[bar.material.curve]\ntable = {table}\n\
         [left]\nkind = \"stress\"\nhistory = [[\"0 us\", \"0 MPa\"], [\"40 us\", \"130 MPa\"], [\"80 us\", \"130 MPa\"], \
         [\"160 us\", \"-125 MPa\"], [\"200 us\", \"-125 MPa\"], [\"280 us\", \"128 MPa\"], [\"400 us\", \"128 MPa\"]]\n\
         [right]\nkind = \"fixed\"\n[effects]\nhardening = {hardening}\n[solve]\nuntil = \"400 us\"\n{rest}\n"
    )
}

const CURVE: &str = "[[0.0014, \"98 MPa\"], [0.003, \"118 MPa\"], [0.006, \"135 MPa\"], [0.02, \"170 MPa\"]]";
const PLATEAU: &str = "[[0.0014, \"98 MPa\"], [0.01, \"98 MPa\"], [0.05, \"170 MPa\"]]";

/// Runs a scene with the program; returns its results, and its error output.
fn barwave(text: &str) -> (Option<Vec<f64>>, String) {
    let folder = tempfile::tempdir().expect("a folder");
    let (file, out) = (folder.path().join("bar.toml"), folder.path().join("bar.h5"));
    std::fs::write(&file, text).expect("written");
    let output =
        Command::new(env!("CARGO_BIN_EXE_barwave")).arg("run").args([&file, &PathBuf::from("-o"), &out]).output();
    let output = output.expect("it starts");
    let shown = String::from_utf8_lossy(&output.stderr).into_owned();
    if !output.status.success() {
        assert_eq!(output.status.code(), Some(2), "{shown}");
        return (None, shown);
    }
    let result = ResultFile::open(&out).expect("a result file");
    let last = result.time().expect("times").len() - 1;
    let row = result.field(Field::Strain, last..last + 1).expect("a row").into_raw_vec_and_offset().0;
    (Some(row), shown)
}

#[test]
fn the_program_runs_it_by_leapfrog_and_muscl_and_refuses_the_rest() {
    let run = |rest: &str| barwave(&scene(CURVE, "\"kinematic\"", rest)).0.expect("it runs");
    let fine = run("cells = 3200");
    for rest in ["cells = 400", "cells = 400\nscheme = \"muscl\""] {
        let missed = apart(&run(rest), &fine);
        println!("{rest}: {missed:.2e}");
        assert!(missed < 0.03, "{rest}: {missed:e}");
    }
    let other = barwave(&scene(CURVE, "{ mixed = 1 }", "cells = 3200")).0.expect("it runs");
    assert!(apart(&fine, &other) > 0.05, "{:e}", apart(&fine, &other));
    let tracked = barwave(&scene(CURVE, "\"kinematic\"", "method = \"moc\"")).1;
    let refused = "error: `solve.method`: method = \"moc\" (front tracking) does not simulate kinematic hardening along several lines";
    assert!(tracked.starts_with(refused) && tracked.contains("hardening = { mixed = 1 }"), "{tracked}");
    let stiffens = barwave(&scene(PLATEAU, "\"kinematic\"", "cells = 100")).1;
    assert!(stiffens.contains("does not stiffen") && stiffens.contains("{ mixed = 1 }"), "{stiffens}");
    assert!(barwave(&scene(PLATEAU, "{ mixed = 1 }", "cells = 100")).0.is_some());
}

/// An elastic range that has moved cancels a level stretch only to rounding: no wave may be long enough to see the difference.
#[test]
fn a_level_stretch_ends_where_it_began_wherever_the_elastic_range_is() {
    let curve = Curve::new(&[(0.7, 0.7), (2.0, 1.1), (4.0, 1.1), (20.0, 2.0)], Beyond::Extend).expect("rows rise");
    let table = Table::new(&curve, 1.0);
    let medium = Medium::new([&table, &table], 1.0, 1.0, 1.0, Flow::Plastic { kinematic: 1.0 }, 0.0);
    let (mut path, mut random) = (Path::default(), noise(7));
    for _ in 0..1000 {
        let back = 2.0 * random();
        for accumulated in [0.9, 1.5] {
            let point = Riemann { stress: back, back, accumulated, ..Riemann::default() };
            path.fill(&medium, &point, 1.0);
            let mut level = (back + 0.7).next_down().next_down();
            for _ in 0..5 {
                let velocity = path.velocity(level);
                assert!(velocity.is_finite() && velocity < 10.0, "{velocity} at {level}");
                level = level.next_up();
            }
        }
    }
}

/// The law of `mixed` returns along a level line what it stored along a steep one, which is noted.
#[test]
fn hardening_that_may_return_more_work_than_was_done_is_noted() {
    let notes = |table: &str, effects: &str| {
        let text = format!(
            "[bar]\nlength = 1\narea = 1e-4\nmaterial = {{ name = \"m\", density = 7800, modulus = 2e11, beyond = \"extend\", \
             curve = {{ table = {table} }} }}\n[left]\nkind = \"velocity\"\nvalue = 5\n[right]\nkind = \"free\"\n\
             [effects]\n{effects}\n[solve]\nuntil = 1e-4\nmethod = \"fd\"\n"
        );
        let scene = Scene::parse("notes.toml", &text, std::path::Path::new("."), &[]).unwrap_or_else(|e| panic!("{e}"));
        scene.notes().iter().any(|note| note.contains("return more plastic work"))
    };
    let (several, one) = ("[[0.001, 2e8], [0.01, 3e8], [0.1, 4e8]]", "[[0.001, 2e8], [0.1, 4e8]]");
    assert!(notes(several, "hardening = { mixed = 0.7 }"));
    assert!(!notes(several, "hardening = { mixed = 0.5 }"));
    assert!(!notes(several, "hardening = \"kinematic\""));
    assert!(!notes(one, "hardening = { mixed = 1 }"));
}
