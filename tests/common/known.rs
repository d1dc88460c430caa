//! Scenes with known solutions: self-similar ones, those that front tracking solves exactly, elastic waves with formulas, and runs much finer
//! than any that is tested. The twenty scenes here were used to determine the factors of the error estimates; those of [`held_out`] were not.
#![allow(dead_code, reason = "every test file takes what it needs")]

#[path = "held_out.rs"]
mod held_out;

use std::collections::BTreeMap;
use std::path::Path;
use std::sync::{Arc, Mutex, PoisonError};

use barwave::assemble;
use barwave::bar::EndCondition;
use barwave::record::{Stepped, Summary, View};
use barwave::scene::{Method, Scene};
use barwave::solver::fd::{Quantity, Sampling};
use barwave::solver::moc::{FrontTracking, Settings};
use barwave::solver::net::Net;

pub use held_out::held_out;

/// Source of the reference solution.
pub enum Truth {
    /// Front tracking without merged waves.
    Tracked,
    /// sigma = -rho c0 v(t - x/c0), for an elastic bar driven at its left end.
    Travelling,
    /// Formula for the stress at x and t in this scene.
    Formula(fn(&Scene, f64, f64) -> f64),
    /// Characteristic net with this number of cells.
    Net(usize),
    /// Leapfrog with this number of cells.
    Leapfrog(usize),
    /// Front tracking with this front tolerance, which is also the size of the steps of ramps.
    Fine(f64),
}

/// Scene without a method, with its reference solution.
pub struct Known {
    pub name: &'static str,
    pub text: String,
    pub truth: Truth,
}

const BILINEAR: &str = r#"{ name = "b", density = 7800, modulus = "200 GPa", beyond = "extend", curve = { table = [[0.001, "200 MPa"], [0.021, "600 MPa"]] } }"#;
const FOUR: &str = r#"{ name = "f", density = 7800, modulus = "200 GPa", beyond = "extend", curve = { table = [[0.001, "200 MPa"], [0.004, "320 MPa"], [0.012, "420 MPa"], [0.05, "600 MPa"]] } }"#;
const LIGHT: &str = r#"{ name = "l", density = 2700, modulus = "70 GPa", beyond = "extend", curve = { table = [[0.004, "280 MPa"], [0.05, "500 MPa"]] } }"#;
const ELASTIC: &str =
    r#"{ name = "e", density = 7800, modulus = "200 GPa", beyond = "error", curve = { table = [[0.02, "4 GPa"]] } }"#;
const POWER: &str = r#"{ name = "p", density = 7800, modulus = "200 GPa", beyond = "extend", measure = "engineering", curve = { formula = "hollomon", K = "796.214341107 MPa", n = 0.2, tabulate = { tolerance = 1e-4, to-strain = 0.05 } } }"#;
const LOCKING: &str = r#"{ name = "c", density = 200, beyond = "extend", curve = { table = [[0.01, "1 MPa"], [0.6, "1.2 MPa"], [0.7, "5 MPa"], [0.75, "20 MPa"]] } }"#;

/// Transit time of an elastic wave through a metre of steel, s.
const TRANSIT: f64 = 1.974_841_766e-4;

fn driven(value: &str) -> String {
    format!("kind = \"velocity\"\nvalue = \"{value}\"")
}

fn let_go(value: &str, transits: f64) -> String {
    format!("{}\nrelease = {:e}", driven(value), transits * TRANSIT)
}

fn scene(bar: &str, left: &str, right: &str, effects: &str, until: f64) -> String {
    format!(
        "{bar}\n[left]\n{left}\n[right]\nkind = \"{right}\"\n[effects]\n{effects}\n[solve]\nuntil = {until:e}\n\
         [record]\nframes = 1\n"
    )
}

fn one(material: &str) -> String {
    format!("[bar]\nlength = 1\narea = 1e-4\nmaterial = {material}")
}

fn two(first: (f64, f64, &str), second: (f64, f64, &str)) -> String {
    let segment = |(length, area, material): (f64, f64, &str)| {
        format!("[[bar.segment]]\nlength = {length}\narea = {area:e}\nmaterial = {material}\n")
    };
    segment(first) + &segment(second)
}

const ISOTROPIC: &str = "hardening = \"isotropic\"";

/// Returns the twenty scenes.
pub fn known() -> Vec<Known> {
    let t = TRANSIT;
    let moving = format!("{}\nvelocity = \"-15 m/s\"", one(BILINEAR));
    let smooth: Vec<String> = (0..=200)
        .map(|k| {
            let s = f64::from(k) / 200.0;
            format!("[{:e}, {:e}]", 0.3 * t * s, 5.0 * (std::f64::consts::PI * s).sin().powi(4))
        })
        .collect();
    let smooth = format!("kind = \"velocity\"\nhistory = [{}]", smooth.join(", "));
    let rate = |model: &str| format!("rate = {model}");
    let malvern = rate("{ model = \"malvern\", k = 1e5 }");
    let cowper = rate("{ model = \"cowper-symonds\", D = 40, q = 5 }");
    let short = |material: &str| format!("[bar]\nlength = 0.2\narea = 1e-4\nmaterial = {material}");
    let tracked = |name, text| Known { name, text, truth: Truth::Tracked };
    let net = |name, text| Known { name, text, truth: Truth::Net(6144) };
    vec![
        tracked("P1 elastic", scene(&one(ELASTIC), &driven("10 m/s"), "free", "", 0.8 * t)),
        tracked("P2 bilinear", scene(&one(BILINEAR), &driven("20 m/s"), "free", ISOTROPIC, 0.8 * t)),
        tracked("P3 power law", scene(&one(POWER), &driven("20 m/s"), "free", ISOTROPIC, 0.8 * t)),
        tracked("power law, reflected", scene(&one(POWER), &driven("20 m/s"), "free", ISOTROPIC, 1.6 * t)),
        tracked("locking foam", scene(&one(LOCKING), &driven("124 m/s"), "free", "", 1.2e-3)),
        tracked("copper", scene(&one("\"copper-annealed\""), &driven("-30 m/s"), "free", "", 2.5e-4)),
        tracked("bilinear, free, 3 transits", scene(&one(BILINEAR), &driven("20 m/s"), "free", ISOTROPIC, 3.0 * t)),
        tracked("power law, released", scene(&one(POWER), &let_go("20 m/s", 0.4), "free", ISOTROPIC, 1.5 * t)),
        tracked("released, 2.5 transits", scene(&one(BILINEAR), &let_go("-20 m/s", 0.6), "free", ISOTROPIC, 2.5 * t)),
        tracked(
            "released, kinematic",
            scene(&one(BILINEAR), &let_go("-25 m/s", 0.5), "free", "hardening = \"kinematic\"", 1.5 * t),
        ),
        tracked("four lines, reflected", scene(&one(FOUR), &driven("-25 m/s"), "free", ISOTROPIC, 1.6 * t)),
        tracked(
            "step in area",
            scene(&two((0.5, 2e-4, BILINEAR), (0.5, 1e-4, BILINEAR)), &driven("15 m/s"), "free", ISOTROPIC, 1.4 * t),
        ),
        tracked(
            "two materials",
            scene(&two((0.6, 1e-4, BILINEAR), (0.4, 1e-4, LIGHT)), &driven("20 m/s"), "absorbing", ISOTROPIC, 1.4 * t),
        ),
        tracked("against a wall", scene(&moving, "kind = \"wall\"\ngap = 0", "free", ISOTROPIC, 1.7 * t)),
        tracked(
            "copper, released",
            scene(&one("\"copper-annealed\""), &let_go("-30 m/s", 0.7), "free", ISOTROPIC, 3.6e-4),
        ),
        tracked(
            "elastic step in area",
            scene(&two((0.5, 2e-4, ELASTIC), (0.5, 1e-4, ELASTIC)), &driven("5 m/s"), "free", "", 1.6 * t),
        ),
        tracked(
            "released, step in area",
            scene(
                &two((0.4, 2e-4, BILINEAR), (0.6, 1.2e-4, BILINEAR)),
                &let_go("-18 m/s", 0.5),
                "fixed",
                ISOTROPIC,
                1.3 * t,
            ),
        ),
        Known {
            name: "smooth elastic pulse",
            text: scene(&one(ELASTIC), &smooth, "absorbing", "", 0.85 * t),
            truth: Truth::Travelling,
        },
        net("precursor, Malvern", scene(&short("\"mild-steel\""), &driven("20 m/s"), "free", &malvern, 80e-6)),
        net("Cowper and Symonds", scene(&short(BILINEAR), &driven("15 m/s"), "free", &cowper, 30e-6)),
    ]
}

impl Known {
    /// Returns the scene with these lines added under `[solve]`.
    pub fn scene(&self, solve: &str) -> Scene {
        let text = self.text.replace("[solve]\n", &format!("[solve]\n{solve}\n"));
        let read = Scene::parse(self.name, &text, Path::new(""), &[]);
        read.unwrap_or_else(|e| panic!("{}: {e}\n{text}", self.name))
    }

    /// Returns the relative L1 error of stress at the end time, with the method and resolution that the summary of a run names.
    pub fn true_error(&self, scene: &Scene, summary: &Summary) -> f64 {
        let tried = summary.choice.as_ref().and_then(|c| c.tried.last()).expect("a choice");
        let asked = scene.solve.tolerance.as_ref().expect("a tolerance");
        let methods = asked.methods.iter().copied().find(|m| m.names()[1] == summary.scheme);
        let method = methods.expect("one of them");
        let method = match tried.by.front_tolerance {
            Some(front_tolerance) => method.with_front_tolerance(front_tolerance),
            None => method.with_cells(tried.by.cells.expect("cells")),
        };
        self.error_by(scene, method)
    }

    /// Returns the relative L1 error of stress at the end time with the scene's own method.
    pub fn error_of(&self, scene: &Scene) -> f64 {
        self.error_by(scene, scene.solve.method)
    }

    fn error_by(&self, scene: &Scene, method: Method) -> f64 {
        match method {
            Method::FrontTracking { front_tolerance, event_budget } => {
                let settings = Settings { front_tolerance, event_budget, ..Settings::default() };
                let mut bar = assemble::front_tracking(scene, settings);
                bar.advance_to(scene.solve.until).unwrap_or_else(|e| panic!("{}: {e}", self.name));
                self.error_of_tracked(scene, &bar)
            }
            Method::Leapfrog { cells, cfl } => self.error_on_grid(scene, assemble::leapfrog(scene, cells, cfl)),
            Method::Muscl { cells, cfl } => self.error_on_grid(scene, assemble::muscl(scene, cells, cfl)),
            Method::CharacteristicNet { cells } => {
                self.error_on_grid(scene, assemble::characteristic_net(scene, cells))
            }
        }
    }

    fn error_on_grid(&self, scene: &Scene, mut bar: impl Stepped) -> f64 {
        for _ in 0..bar.grid().steps_to(scene.solve.until) {
            bar.advance();
        }
        let x = bar.grid().centres();
        let found: Vec<f64> = (0..x.len()).map(|k| bar.value(Quantity::Stress, k)).collect();
        self.error_at(scene, bar.time(), &x, &found)
    }

    fn exact(&self, scene: &Scene, time: f64) -> FrontTracking {
        let mut bar = assemble::front_tracking(scene, Settings::default());
        bar.advance_to(time).unwrap_or_else(|e| panic!("{}: {e}", self.name));
        assert!(bar.is_exact(), "{} is not exact", self.name);
        bar
    }

    fn error_of_tracked(&self, scene: &Scene, bar: &FrontTracking) -> f64 {
        if let Truth::Tracked = self.truth {
            let (apart, total) = self.exact(scene, bar.time()).stress_difference(bar);
            return apart / total;
        }
        // Enough positions to resolve an error of 0.001.
        let x: Vec<f64> = (0..20_000).map(|k| (f64::from(k) + 0.5) * scene.bar.length() / 20_000.0).collect();
        let mut found = vec![0.0; x.len()];
        bar.sample(barwave::record::Field::Stress, &x, &mut found);
        self.error_at(scene, bar.time(), &x, &found)
    }

    /// Returns the relative L1 error of the stress `found` at these positions (m).
    fn error_at(&self, scene: &Scene, time: f64, x: &[f64], found: &[f64]) -> f64 {
        let mut exact = vec![0.0; x.len()];
        self.answer(scene, time, x, &mut exact);
        let apart: f64 = found.iter().zip(&exact).map(|(a, b)| (a - b).abs()).sum();
        apart / exact.iter().map(|e| e.abs()).sum::<f64>()
    }

    /// Computes the true stress (Pa) at these positions.
    fn answer(&self, scene: &Scene, time: f64, x: &[f64], exact: &mut [f64]) {
        match self.truth {
            Truth::Tracked => self.exact(scene, time).sample(barwave::record::Field::Stress, x, exact),
            Truth::Travelling => {
                let material = &scene.bar.segments[0].material;
                let EndCondition::Velocity { history, .. } = &scene.left else { panic!("it is driven") };
                for (exact, x) in exact.iter_mut().zip(x) {
                    let since = time - x / material.c0();
                    *exact = if since > 0.0 { -material.impedance() * history.at(since) } else { 0.0 };
                }
            }
            Truth::Formula(formula) => {
                for (exact, x) in exact.iter_mut().zip(x) {
                    *exact = formula(scene, *x, time);
                }
            }
            Truth::Net(cells) => Reference::of(self.name, scene, cells).read(time, x, exact),
            Truth::Leapfrog(cells) => on_grid(assemble::leapfrog(scene, cells, 1.0), time, x, exact),
            Truth::Fine(step) => {
                let event_budget = 1_000_000_000;
                let settings =
                    Settings { front_tolerance: step, ramp_step: Some(step), event_budget, ..Settings::default() };
                let mut bar = assemble::front_tracking(scene, settings);
                bar.advance_to(time).unwrap_or_else(|e| panic!("{}: {e}", self.name));
                bar.sample(barwave::record::Field::Stress, x, exact);
            }
        }
    }
}

/// Last steps of a characteristic net, which is run once per process: the end times of runs of a scene on different grids differ by less than a
/// step.
struct Reference {
    net: Net,
    /// Step of the first row.
    first: usize,
    /// Stress in every cell after each step, from step `first`.
    rows: Vec<Vec<f64>>,
}

impl Reference {
    /// Time stored before and after the end time of the scene, relative to the end time.
    const KEPT: f64 = 0.01;

    fn of(name: &'static str, scene: &Scene, cells: usize) -> Arc<Self> {
        static ALL: Mutex<BTreeMap<(&str, usize), Arc<Reference>>> = Mutex::new(BTreeMap::new());
        let mut all = ALL.lock().unwrap_or_else(PoisonError::into_inner);
        Arc::clone(all.entry((name, cells)).or_insert_with(|| Arc::new(Self::new(scene, cells))))
    }

    fn new(scene: &Scene, cells: usize) -> Self {
        let mut net = assemble::characteristic_net(scene, cells);
        let [first, last] =
            [-Self::KEPT, Self::KEPT].map(|part| ((1.0 + part) * scene.solve.until / net.grid().dt) as usize);
        (0..first).for_each(|_| net.advance());
        let mut rows = Vec::new();
        for _ in first..=last {
            rows.push((0..cells).map(|k| net.value(Quantity::Stress, k)).collect());
            net.advance();
        }
        Self { net, first, rows }
    }

    /// Interpolates the stress linearly in time, and to these positions.
    fn read(&self, time: f64, x: &[f64], stress: &mut [f64]) {
        let steps = time / self.net.grid().dt;
        let before = (steps + 1e-6).floor();
        let rows = &self.rows[before as usize - self.first..];
        let places = Sampling::at(self.net.grid(), x.to_vec());
        places.read(|k| rows[0][k], stress);
        let mut next = vec![0.0; x.len()];
        places.read(|k| rows[1][k], &mut next);
        let part = (steps - before).max(0.0);
        stress.iter_mut().zip(next).for_each(|(stress, next)| *stress += part * (next - *stress));
    }
}

/// Steps a bar to a time; the stress is interpolated linearly between two steps, and to these positions.
fn on_grid(mut bar: impl Stepped, time: f64, x: &[f64], stress: &mut [f64]) {
    let steps = time / bar.grid().dt;
    for _ in 0..(steps + 1e-6).floor() as usize {
        bar.advance();
    }
    let places = Sampling::at(bar.grid(), x.to_vec());
    places.read(|cell| bar.value(Quantity::Stress, cell), stress);
    let part = steps - bar.step() as f64;
    if part > 1e-6 {
        bar.advance();
        let mut next = vec![0.0; x.len()];
        places.read(|cell| bar.value(Quantity::Stress, cell), &mut next);
        stress.iter_mut().zip(next).for_each(|(stress, next)| *stress += part * (next - *stress));
    }
}
