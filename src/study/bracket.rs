//! Critical velocities by simulation: bars are driven at constant velocities, and the interval between those that hold and those that fracture is
//! bisected.

use std::borrow::Cow;
use std::sync::Arc;

use serde::Serialize;

use super::critical::critical;
use crate::assemble;
use crate::bar::{Bar, EndCondition, History, Segment};
use crate::error::{InputError, Result};
use crate::input::{Allowed, Checked, member};
use crate::material::{Material, Rate, Sense, Ultimate, rate_tables};
use crate::record::{Compression, Field, Precision};
use crate::scene::{Effects, HardeningRule, Heat, Method, Record, Scene, SceneParts, Solve};
use crate::solver::fd::{Leapfrog, Quantity};
use crate::solver::moc::Settings;
use crate::text_file::NamedFiles;
use crate::units::Dimension;
use crate::wave::similarity;

/// Width of a bracket, relative to its upper velocity.
const WIDTH: f64 = 1e-3;

/// Cells of the finer grid; the coarser grid has half as many.
const CELLS: usize = 400;

/// Most cells of a refined grid, and the largest relative change of the critical velocity from half as many cells for which a grid counts as
/// converged.
const MOST_CELLS: usize = 3200;
const CONVERGED: f64 = 0.01;

/// Relative difference between the velocity of the end and that behind the last front above which the bar does not follow its end.
const SLIP: f64 = 1e-9;

/// Interval of velocities in which the bar starts to fracture.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Bracket {
    /// Largest velocity found at which the bar holds, m/s.
    pub holds_m_s: f64,
    /// Smallest velocity found at which the bar fractures, m/s.
    pub breaks_m_s: f64,
}

impl Bracket {
    /// Returns the middle of the bracket, m/s.
    pub fn middle(&self) -> f64 {
        0.5 * (self.holds_m_s + self.breaks_m_s)
    }

    /// Returns whether a velocity lies in the bracket, with a tolerance of its width plus `more` (m/s) on each side.
    fn holds(&self, velocity: f64, more: f64) -> bool {
        let slack = self.breaks_m_s - self.holds_m_s + more;
        (self.holds_m_s - slack..=self.breaks_m_s + slack).contains(&velocity)
    }
}

/// Bracket on a grid, with its numerical uncertainty.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct OnGrid {
    /// Number of cells of the bar.
    pub cells: usize,
    /// Bracket of the critical velocity.
    #[serde(flatten)]
    pub bracket: Bracket,
    /// Distance of the middle of the bracket from that with half as many cells, m/s.
    pub resolution_m_s: f64,
}

impl OnGrid {
    fn has_converged(&self) -> bool {
        self.resolution_m_s <= CONVERGED * self.bracket.middle()
    }
}

/// Critical velocity of a curve by simulation.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Confirmation {
    /// Bracket from front tracking. Above the critical velocity the bar does not follow its end.
    pub fronts: Bracket,
    /// Bracket from the leapfrog scheme. The bar fractures if the strain of any of its first four cells exceeds that of the largest stress.
    pub grid: OnGrid,
    /// Whether the grid has converged: half as many cells change the critical velocity by at most 1 %.
    pub converged: bool,
    /// Whether the grid has converged and the integral lies in both brackets. The tolerance is the width of a bracket, for the grid plus the change
    /// from half as many cells.
    pub confirmed: bool,
}

/// Brackets the critical velocity of a material's curve by simulation. Returns `None` if the curve has no critical velocity. The bars are simulated
/// for one elastic transit time. The initial bounds of the search do not use the integral: 0, and `sqrt(stress strain/density)` of the ultimate
/// point.
///
/// # Errors
/// As for [`Material::check`].
pub fn confirm(material: &Material, sense: Sense) -> Result<Option<Confirmation>> {
    material.check()?;
    let ultimate = material.branch(sense).ultimate();
    let at = critical(material, sense).critical_velocity_m_s.zip(ultimate);
    Ok(at.map(|(velocity, ultimate)| confirmed(material, sense, velocity, ultimate)))
}

/// Computes the brackets and compares them with `velocity` (m/s), the critical velocity of the ultimate point.
fn confirmed(material: &Material, sense: Sense, velocity: f64, ultimate: Ultimate) -> Confirmation {
    let most = 1.001 * (ultimate.stress * ultimate.strain / material.density).sqrt();
    let material = Arc::new(material.clone());
    let fronts = bisect([0.0, most], |v| follows(&material, sense, v));
    let effects = Effects { hardening: Some(HardeningRule::Isotropic), ..Effects::default() };
    let grid = |cells| grid_bracket(&material, &effects, sense, &Grid { cells, length: LENGTH, transits: 1.0 }, most);
    let mut on = on_grid(grid(CELLS), grid(CELLS / 2), CELLS);
    while !on.has_converged() && on.cells < MOST_CELLS {
        on = on_grid(grid(2 * on.cells), on.bracket, 2 * on.cells);
    }
    let converged = on.has_converged();
    let confirmed = converged && fronts.holds(velocity, 0.0) && on.bracket.holds(velocity, on.resolution_m_s);
    Confirmation { fronts, grid: on, converged, confirmed }
}

/// Effects that are simulated in addition to the quasi-static curve.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct RateAndHeat {
    /// The material's own rate law.
    pub rate: bool,
    /// Adiabatic heating.
    pub heat: bool,
}

/// Apparent critical velocity with a rate law or heating.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Apparent {
    /// Definition of the apparent critical velocity.
    pub definition: &'static str,
    /// Simulated effects.
    pub effects: Vec<String>,
    /// Length of the bar, m.
    pub length_m: f64,
    /// Strain at the driven end above which the bar counts as fractured.
    pub strain_limit: f64,
    /// Integral over the adiabatic curve, m/s; only with heating and without a rate law.
    pub adiabatic_m_s: Option<f64>,
    /// Bracket by simulation.
    pub grid: OnGrid,
}

/// Definition of [`Apparent`]. The strain is averaged over a length, because the first cell alone has an error of its own if the rate law relaxes
/// within less than a time step.
pub const DEFINITION: &str = "the lowest constant velocity of the end at which the mean strain of the first 1 % of the bar \
                              exceeds the strain of the largest static stress before the elastic wave returns from the far end \
                              (2 L/c0)";

/// Allowed lengths of a bar, m.
const LENGTHS: Allowed = Allowed::Within(1e-3, 1e3);

/// Checks the length of the bar of [`apparent`], m.
pub(crate) fn check_length(length: f64) -> Checked {
    member("length", length, Dimension::Length, LENGTHS)
}

/// Computes the apparent critical velocity of a bar of `length` (m, 1e-3 to 1e3) by simulation. Returns `None` if the quasi-static curve has no
/// critical velocity. With heating, the adiabatic curves are computed here unless the material already has them.
///
/// # Errors
/// A length out of range; an error of [`Material::check`]; missing constants of a requested rate law or of requested heating.
pub fn apparent(material: &Material, sense: Sense, with: RateAndHeat, length: f64) -> Result<Option<Apparent>> {
    check_length(length)?;
    material.check()?;
    let heated = with_constants(material, with)?;
    Ok(strain_limit(material, sense).and_then(|limit| bracketed(&heated, sense, with, length, limit)))
}

/// Returns the material as it is simulated: with adiabatic curves if heating is requested.
fn with_constants(material: &Material, with: RateAndHeat) -> Result<Cow<'_, Material>> {
    let of_material = |error: InputError| {
        let message = format!("`{}`: {}", material.name, error.message);
        InputError { message, ..error }
    };
    if with.rate && material.constants.rate.is_empty() {
        let error = InputError::new("the material has no rate constants").key("rate");
        return Err(of_material(error.help(format!("add {} to it", rate_tables()))).into());
    }
    if !with.heat || material.heating.is_some() {
        return Ok(Cow::Borrowed(material));
    }
    let heated = material.heated(None).map_err(|error| of_material(InputError::from(error).key("heat")))?;
    Ok(Cow::Owned(heated))
}

/// Returns the strain of the largest quasi-static stress; for a heated material, of its isothermal curve.
fn strain_limit(material: &Material, sense: Sense) -> Option<f64> {
    let cold = material.heating.as_ref().map_or(&[][..], |heating| &heating.cold[..]);
    let own = cold.get(usize::from(sense == Sense::Compression)).or(cold.first());
    similarity::critical(own.unwrap_or_else(|| material.branch(sense)), material.density).map(|c| c.strain)
}

/// Brackets the apparent critical velocity of a material. `limit` is the strain of the largest quasi-static stress.
fn bracketed(material: &Material, sense: Sense, with: RateAndHeat, length: f64, limit: f64) -> Option<Apparent> {
    let ultimate = material.branch(sense).ultimate()?;
    let effects = Effects {
        hardening: Some(HardeningRule::Isotropic),
        rate: with.rate.then_some(Rate::Material),
        heat: with.heat.then_some(Heat { fraction: None }),
        ..Effects::default()
    };
    let most = 2.0 * (ultimate.stress * limit.max(ultimate.strain) / material.density).sqrt();
    let shared = Arc::new(material.clone());
    let grid = |cells| {
        let grid = Grid { cells, length, transits: 2.0 };
        widening(most, |v| largest_mean(&shared, &effects, sense, &grid, (v, cells / 100)) <= limit)
    };
    let (fine, coarse) = (grid(CELLS), grid(CELLS / 2));
    let adiabatic = (with.heat && !with.rate).then(|| similarity::critical(material.branch(sense), material.density));
    Some(Apparent {
        definition: DEFINITION,
        effects: effects.names(),
        length_m: length,
        strain_limit: limit,
        adiabatic_m_s: adiabatic.flatten().map(|c| c.velocity),
        grid: on_grid(fine, coarse, CELLS),
    })
}

/// Length of the bar in simulations whose result does not depend on it, m.
const LENGTH: f64 = 1.0;

/// Discretization of a bar: cells, length (m), and simulated time in elastic transit times.
struct Grid {
    cells: usize,
    length: f64,
    transits: f64,
}

fn on_grid(bracket: Bracket, coarse: Bracket, cells: usize) -> OnGrid {
    OnGrid { cells, bracket, resolution_m_s: (bracket.middle() - coarse.middle()).abs() }
}

fn grid_bracket(material: &Arc<Material>, effects: &Effects, sense: Sense, grid: &Grid, most: f64) -> Bracket {
    let limit = material.branch(sense).ultimate().map_or(f64::INFINITY, |u| u.strain);
    let largest = |strains: Vec<f64>| strains.into_iter().fold(0.0, f64::max);
    widening(most, |v| largest(strains_at_end(material, effects, sense, grid, (v, 4))) <= limit)
}

/// Returns a bracket between 0 and `most`. If the bar holds at `most`, the upper bound is doubled up to six times.
fn widening(most: f64, holds: impl Fn(f64) -> bool) -> Bracket {
    let (mut low, mut high) = (0.0, most);
    for _ in 0..6 {
        if !holds(high) {
            break;
        }
        (low, high) = (high, 2.0 * high);
    }
    bisect([low, high], holds)
}

fn bisect([mut low, mut high]: [f64; 2], holds: impl Fn(f64) -> bool) -> Bracket {
    while high - low > WIDTH * high {
        let middle = 0.5 * (low + high);
        *if holds(middle) { &mut low } else { &mut high } = middle;
    }
    Bracket { holds_m_s: low, breaks_m_s: high }
}

/// Returns whether the bar follows its end in front tracking: behind the last front it has the velocity of the end.
fn follows(material: &Arc<Material>, sense: Sense, velocity: f64) -> bool {
    let effects = Effects { hardening: Some(HardeningRule::Isotropic), ..Effects::default() };
    let scene = scene(material, effects, sense, &Grid { cells: CELLS, length: LENGTH, transits: 1.0 }, velocity);
    let mut bar = assemble::front_tracking(&scene, Settings::default());
    // Without reflections there are at most as many events as fronts, so the event limit is never reached.
    let arrived = bar.advance_to(scene.solve.until).is_ok();
    let moves = bar.pieces().next().map_or(0.0, |piece| piece.point.velocity.abs());
    arrived && moves >= velocity * (1.0 - SLIP)
}

/// Returns a bar whose end is driven at `velocity`, and the number of steps of its run.
fn moving_bar(
    material: &Arc<Material>,
    effects: &Effects,
    sense: Sense,
    grid: &Grid,
    velocity: f64,
) -> (Leapfrog, usize) {
    let scene = scene(material, effects.clone(), sense, grid, velocity);
    let bar = assemble::leapfrog(&scene, grid.cells, 1.0);
    let steps = bar.grid().steps_to(scene.solve.until);
    (bar, steps)
}

/// Returns the magnitudes of the strain in the `cells` cells next to the end after a run at `velocity`. Strain that waves cannot carry away
/// accumulates there.
fn strains_at_end(
    material: &Arc<Material>,
    effects: &Effects,
    sense: Sense,
    grid: &Grid,
    (velocity, cells): (f64, usize),
) -> Vec<f64> {
    let (mut bar, steps) = moving_bar(material, effects, sense, grid, velocity);
    bar.advance_by(steps);
    (0..cells).map(|cell| bar.value(Quantity::Strain, cell).abs()).collect()
}

/// Returns the largest mean strain of the `cells` cells next to the end during a run at `velocity`. The largest value is used, because the wave
/// reflected from the far end unloads these cells in the last steps.
fn largest_mean(
    material: &Arc<Material>,
    effects: &Effects,
    sense: Sense,
    grid: &Grid,
    (velocity, cells): (f64, usize),
) -> f64 {
    let (mut bar, steps) = moving_bar(material, effects, sense, grid, velocity);
    let mean_after_step = |_| {
        bar.advance_by(1);
        (0..cells).map(|cell| bar.value(Quantity::Strain, cell).abs()).sum::<f64>() / cells as f64
    };
    (0..steps).map(mean_after_step).fold(0.0, f64::max)
}

/// Returns a scene with a bar at rest whose left end is driven at a constant velocity.
fn scene(material: &Arc<Material>, effects: Effects, sense: Sense, grid: &Grid, velocity: f64) -> Scene {
    let segment = Segment::new(grid.length, 1.0, Arc::clone(material));
    let until = grid.transits * grid.length / material.c0();
    // Pulling the left end in -x is tension.
    let driven = History::constant(-sense.sign() * velocity);
    let parts = SceneParts {
        title: format!("{} at {velocity} m/s", material.name),
        name: material.name.clone(),
        path: None,
        text: String::new(),
        overrides: Vec::new(),
        bar: Bar { segments: vec![segment], area_given: false },
        left: EndCondition::Velocity { history: driven, release: None },
        right: EndCondition::Free,
        effects,
        auto: None,
        base: std::path::PathBuf::new(),
        files: NamedFiles::default(),
        solve: Solve {
            until,
            method: Method::Leapfrog { cells: grid.cells, cfl: 1.0 },
            audit_tolerance: Solve::AUDIT_TOLERANCE,
            tolerance: None,
            estimate_error: false,
        },
        record: Record {
            times: vec![until],
            cells: None,
            paths: false,
            fields: vec![Field::Stress],
            gauges: Vec::new(),
            precision: Precision::F64,
            compression: Compression::None,
        },
        discretized: None,
        torsion: None,
    };
    Scene { parts }
}
