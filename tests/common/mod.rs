//! Builds bars without scene files, for the integration tests.
#![allow(dead_code, reason = "every test file takes what it needs")]

pub mod binary;
pub mod exact;
pub mod impacts;
pub mod known;
pub mod long_bars;
pub mod methods;
pub mod muscl;
pub mod net;
pub mod results;
pub mod synthetic;

use barwave::assemble::segment_law;
use barwave::bar::{Bar, EndCondition, History, Segment};
use barwave::material::{Beyond, Curve, Material};
use barwave::record::Ledger;
use barwave::scene::{Effects, HardeningRule};
use barwave::solver::fd::{Grid, Leapfrog, Quantity};

/// Elastic modulus, Pa.
pub const MODULUS: f64 = 200e9;
/// Density, kg/m^3.
pub const DENSITY: f64 = 7800.0;
/// Yield stress, Pa.
pub const YIELD: f64 = 200e6;

/// Returns the bilinear steel of the benchmarks: yield stress 200 MPa, then a tangent modulus of 20 GPa.
pub fn bilinear_steel() -> Material {
    material(&[(0.001, YIELD), (0.021, 600e6)], Beyond::Extend)
}

/// Returns a material of [`DENSITY`] with this table.
pub fn material(rows: &[(f64, f64)], beyond: Beyond) -> Material {
    Material::from_curve("steel", DENSITY, Curve::new(rows, beyond).expect("rows rise")).expect("a material")
}

/// Returns a material that is elastic at all strains.
pub fn elastic_steel() -> Material {
    material(&[(0.01, 2e9)], Beyond::Extend)
}

/// Returns a material with 60 knots on the curve 200 MPa (eps/0.001)^0.2.
pub fn power_law_steel() -> Material {
    power_law_table(60)
}

/// Returns a material with knots on the curve 200 MPa (eps/0.001)^0.2 from strain 0.001 to 0.05, evenly spaced in the logarithm of strain.
pub fn power_law_table(knots: u32) -> Material {
    let knot = |k: u32| 0.001 * 50.0_f64.powf(f64::from(k) / f64::from(knots - 1));
    let rows: Vec<(f64, f64)> = (0..knots).map(|k| (knot(k), YIELD * (knot(k) / 0.001).powf(0.2))).collect();
    material(&rows, Beyond::Extend)
}

/// Returns a segment of 1 m^2 at rest, bonded to the next.
pub fn segment(material: Material, length: f64) -> Segment {
    Segment::new(length, 1.0, material)
}

/// Returns an end with constant velocity from t = 0.
pub fn moved(velocity: f64) -> EndCondition {
    EndCondition::Velocity { history: History::constant(velocity), release: None }
}

/// Returns an end with a history of velocity.
pub fn moved_by(rows: &[(f64, f64)]) -> EndCondition {
    EndCondition::Velocity { history: history(rows), release: None }
}

/// Returns an end with a history of stress.
pub fn loaded_by(rows: &[(f64, f64)]) -> EndCondition {
    EndCondition::Stress { history: history(rows) }
}

/// Cross-section of the bar for which [`busy_ends`] are chosen, m^2.
pub const BUSY_AREA: f64 = 0.7;

/// Returns ends of every kind except balls. Driven ends, at 5 m/s or 200 MPa, are strong enough for a bar of this area (m^2) to yield.
pub fn busy_ends(area: f64) -> Vec<EndCondition> {
    let ramp = [(0.0, 0.0), (2e-5, 15.0), (9e-5, 15.0), (9e-5, -12.0), (2e-4, 0.0)];
    let scale = area / BUSY_AREA;
    vec![
        moved(12.0),
        moved_by(&ramp),
        EndCondition::Velocity { history: History::constant(-18.0), release: Some(7.7e-5) },
        loaded_by(&[(0.0, -300e6), (5e-5, -300e6), (5e-5, 100e6), (1.1e-4, 250e6)]),
        EndCondition::Free,
        EndCondition::Fixed,
        EndCondition::Absorbing,
        EndCondition::Wall { gap: 0.0 },
        EndCondition::Wall { gap: 2e-4 },
        EndCondition::Striker { mass: 3000.0 * scale, velocity: 14.0 },
        EndCondition::Striker { mass: 800.0 * scale, velocity: -9.0 },
        EndCondition::Spring { stiffness: 3e10 * scale },
        // Much stiffer than a cell.
        EndCondition::Spring { stiffness: 1e15 * scale },
    ]
}

/// Returns a history from rows in order of time.
pub fn history(rows: &[(f64, f64)]) -> History {
    History::new(rows).expect("rows are in order")
}

/// Returns a pulse sin^4 of 5 m/s (below yield for the steels here) of this duration, s.
pub fn smooth_pulse(duration: f64) -> History {
    let row = |k: u32| {
        let s = f64::from(k) / 4000.0;
        (s * duration, 5.0 * (std::f64::consts::PI * s).sin().powi(4))
    };
    history(&(0..=4000).map(row).collect::<Vec<_>>())
}

/// Returns a leapfrog bar at t = 0.
pub fn leapfrog(
    segments: Vec<Segment>,
    ends: [EndCondition; 2],
    hardening: Option<HardeningRule>,
    cells: usize,
    cfl: f64,
) -> Leapfrog {
    let effects = Effects { hardening, ..Effects::default() };
    let laws = segments.iter().map(|s| segment_law(s, &effects)).collect();
    let bar = Bar { segments, area_given: true };
    let grid = Grid::new(&bar, cells, cfl);
    Leapfrog::new(&bar, grid, laws, ends)
}

/// Advances a bar by a number of steps.
pub fn advance(bar: &mut Leapfrog, steps: usize) {
    bar.advance_by(steps);
}

/// Advances a bar to the step nearest to a time.
pub fn advance_to(bar: &mut Leapfrog, time: f64) {
    let last = (time / bar.grid().dt).round() as usize;
    bar.advance_by(last.saturating_sub(bar.step()));
}

/// Returns a quantity in every cell.
pub fn profile(bar: &Leapfrog, quantity: Quantity) -> Vec<f64> {
    let mut values = vec![0.0; bar.grid().cells()];
    bar.profile(quantity, &mut values);
    values
}

/// Checks that the balances of momentum and energy close to 1e-10 of the throughput of the bar. These are sums of about 1e6 terms with errors of
/// 1e-16 each, most of which cancel; a missing term causes residuals of 1e-5 and more.
pub fn assert_ledger(ledger: &Ledger, what: &str) {
    assert!(ledger.worst_energy() < 1e-10, "{what}: energy residual {:e}", ledger.worst_energy());
    assert!(ledger.worst_momentum() < 1e-10, "{what}: momentum residual {:e}", ledger.worst_momentum());
}
