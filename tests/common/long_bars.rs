//! Ten bars in which waves multiply: fans that meet reflections, unloading, steps in area, several materials.
#![allow(dead_code, reason = "every test file takes what it needs")]

use std::convert::Infallible;
use std::sync::Arc;

use barwave::accuracy::{Companions, FrontRecorder, Response};
use barwave::bar::{Bar, EndCondition, History, Segment};
use barwave::material::{Beyond, Curve, Material};
use barwave::record::{ErrorTable, Measure};
use barwave::solver::moc::{FrontTracking, Settings, Stopped};
use barwave::wave::riemann::Flow;

/// Bar that is simulated for ten transits of an elastic wave.
pub struct Case {
    pub name: &'static str,
    pub bar: Bar,
    pub flow: Flow,
    pub ends: [EndCondition; 2],
}

fn material(rows: &[(f64, f64)], density: f64) -> Arc<Material> {
    Arc::new(
        Material::from_curve("study", density, Curve::new(rows, Beyond::Extend).expect("rows are right"))
            .expect("a material"),
    )
}

/// Returns a material with a power law above yield, with `knots` knots evenly spaced in the logarithm of strain.
fn power_law(modulus: f64, density: f64, yield_stress: f64, exponent: f64, knots: i32) -> Arc<Material> {
    let first = yield_stress / modulus;
    let strain = |k: i32| first * (0.2 / first).powf(f64::from(k) / f64::from(knots - 1));
    let rows: Vec<_> = (0..knots).map(|k| (strain(k), yield_stress * (strain(k) / first).powf(exponent))).collect();
    material(&rows, density)
}

fn segment(length: f64, area: f64, material: &Arc<Material>) -> Segment {
    Segment::new(length, area, Arc::clone(material))
}

fn bar(segments: Vec<Segment>) -> Bar {
    Bar { segments, area_given: true }
}

fn pulled(velocity: f64, release: f64) -> EndCondition {
    EndCondition::Velocity { history: History::constant(velocity), release: Some(release) }
}

fn pulse(stress: f64, until: f64) -> EndCondition {
    let history = History::new(&[(0.0, stress), (until, stress), (until, 0.0)]).expect("in order");
    EndCondition::Stress { history }
}

/// Returns the ten bars.
pub fn cases() -> Vec<Case> {
    use EndCondition::{Fixed, Free};
    let plastic = |kinematic| Flow::Plastic { kinematic };
    let copper = power_law(117e9, 8930.0, 33e6, 0.32, 40);
    let coarse = power_law(117e9, 8930.0, 33e6, 0.32, 10);
    let steel = material(&[(0.001, 200e6), (0.02, 210e6), (0.1, 600e6)], 7800.0);
    let hard = material(&[(0.001, 200e6), (0.1, 600e6)], 7800.0);
    let soft = material(&[(0.0005, 35e6), (0.02, 80e6), (0.2, 120e6)], 2700.0);
    let one = |m: &Arc<Material>| bar(vec![segment(1.0, 1.0, m)]);
    let two = bar(vec![segment(0.5, 1e-4, &hard), segment(0.5, 3e-4, &soft)]);
    let three = bar(vec![segment(0.3, 2.0, &copper), segment(0.4, 1.0, &hard), segment(0.3, 2.0, &copper)]);
    let step = bar(vec![segment(0.5, 1.0, &coarse), segment(0.5, 0.6, &coarse)]);
    let (c, s) = (copper.c0().recip(), hard.c0().recip());
    let case = |name, bar, flow, ends| Case { name, bar, flow, ends };
    vec![
        case("released, free", one(&copper), plastic(0.0), [pulled(-30.0, c), Free]),
        case("released, fixed", one(&copper), plastic(0.0), [pulled(-30.0, c), Fixed]),
        case("released, kinematic", one(&copper), plastic(1.0), [pulled(-30.0, c), Free]),
        case("released, mixed", one(&coarse), plastic(0.5), [pulled(-30.0, c), Fixed]),
        case("pushed and released, mixed", one(&copper), plastic(0.3), [pulled(25.0, 0.6 * c), Free]),
        case("held, kinematic, two materials", two.clone(), plastic(1.0), [pulled(8.0, 9.0), Fixed]),
        case("released, two materials", two, plastic(0.0), [pulled(8.0, 0.5 * s), Fixed]),
        case("three segments", three, plastic(0.0), [pulse(120e6, 0.5 * c), Fixed]),
        case("area step", step, plastic(0.0), [pulled(20.0, 0.7 * c), Free]),
        case("yield plateau", one(&steel), plastic(0.0), [pulled(24.0, 0.7 * s), Fixed]),
    ]
}

impl Case {
    /// Returns the end time, s.
    pub fn until(&self) -> f64 {
        10.0 * self.bar.transit_time()
    }

    /// Returns the bar at t = 0.
    pub fn start(&self, settings: Settings) -> FrontTracking {
        FrontTracking::new(&self.bar, self.flow, self.ends.clone(), settings)
    }

    /// Returns the bar at the end of a run with this front tolerance.
    pub fn run(&self, front_tolerance: f64, event_budget: u64) -> (FrontTracking, Result<(), Stopped>) {
        let mut run = self.start(Settings { front_tolerance, event_budget, ..Settings::default() });
        let ended = run.advance_to(self.until());
        (run, ended)
    }

    /// Returns the state at the end of a run, which is compared.
    fn response(&self, run: &FrontTracking) -> Response {
        let mut recorder = FrontRecorder::new(&self.bar, 0, &[]);
        recorder.read_fields(run);
        recorder.response(run)
    }
}

/// Returns the estimated error of a run at its end, in stress or in plastic strain, whichever is larger, from companion runs.
///
/// # Errors
/// The coarser companion run is stopped.
pub fn estimate(case: &Case, run: &FrontTracking, settings: Settings) -> Result<f64, Stopped> {
    let follow = |settings| -> Result<(FrontTracking, Response), Stopped> {
        let mut bar = case.start(settings);
        bar.advance_to(case.until())?;
        let response = case.response(&bar);
        Ok((bar, response))
    };
    let response = case.response(run);
    let (coarser, its_response) = follow(settings.coarser())?;
    let companions = Companions::coarser(&response, &its_response);
    let Ok(companions) = companions.with_finer((run, &response), coarser.events(), settings, |settings| {
        Ok::<_, Infallible>(follow(settings).ok())
    });
    Ok(larger(&companions.errors(run, &response)))
}

/// Returns the difference of a run from a more accurate one at its end, in stress or in plastic strain, relative to the run's own values, as in
/// the estimate.
pub fn error(case: &Case, run: &FrontTracking, better: &FrontTracking) -> f64 {
    let own = case.response(run);
    larger(&own.difference(&case.response(better), &own))
}

fn larger(errors: &ErrorTable) -> f64 {
    let [stress, plastic] =
        [Measure::FieldAtEnd, Measure::ResidualStrain].map(|measure| errors[measure].unwrap_or(0.0));
    stress.max(plastic)
}
