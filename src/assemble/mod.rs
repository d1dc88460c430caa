//! Selects the types for a scene: which solver, which law for each segment, and in which form. This is the only module that does so.

mod rate_curves;
mod sudden_fans;

use std::f64::consts::PI;
use std::sync::Arc;

use crate::bar::{Bar, EndCondition, InitialFan, Origin, Segment, SuddenLoads, first_fans, starting_fans};
use crate::law::rate::{Heated, Overstress, RateLaw, Timed};
use crate::law::rupture::{Criteria, Criterion};
use crate::law::{
    ArmstrongFrederick, BackStress, Backbone, CellLaw, Chord, DataEnd, Envelope, Indexed, Isotropic, Mixed, Overlay,
    PathIndependent, RowLaw, Rows, Searched, Table, TwoSided,
};
use crate::material::{Curve, Heating, Material, Sense};
use crate::record::Stepped;
use crate::scene::{Effects, HardeningRule, Method, Scene};
use crate::snapshot::Snapshot;
use crate::solver::fd::{DistributedForces, Grid, Leapfrog, SegmentLaw, Shocks};
use crate::solver::moc::{FrontTracking, Settings};
use crate::solver::muscl::Muscl;
use crate::solver::net::{self, Net};
use crate::wave::riemann::{Flow, Medium};
use crate::wave::similarity::SCATTER;

/// Task to be done with the bar of a scene, whichever solver it needs.
pub trait Task {
    /// Result of the task.
    type Output;

    /// Runs the task on a grid method.
    fn on_grid(self, bar: impl Stepped + Snapshot) -> Self::Output;

    /// Runs the task by front tracking with the scene's settings.
    fn by_fronts(self, settings: Settings) -> Self::Output;
}

/// Builds the bar for the scene's method and runs the task on it. This is the only place that chooses between solvers. Tapers must already be divided
/// into pieces if the method needs that, see [`Scene::in_pieces`].
pub fn solve<T: Task>(scene: &Scene, task: T) -> T::Output {
    match scene.solve.method {
        Method::Leapfrog { cells, cfl } => task.on_grid(leapfrog(scene, cells, cfl)),
        Method::Muscl { cells, cfl } => task.on_grid(muscl(scene, cells, cfl)),
        Method::CharacteristicNet { cells } => task.on_grid(characteristic_net(scene, cells)),
        Method::FrontTracking { front_tolerance, event_budget } => {
            task.by_fronts(Settings { front_tolerance, event_budget, ..Settings::default() })
        }
    }
}

/// Largest shift between waves of two segments that rounding of transit times to whole steps may cause in a run, in time steps. With 250 cells of two
/// materials, rounding makes sharp waves more accurate up to a shift of 3 steps, and three times less accurate at 20.
const MOST_SHIFT: f64 = 3.0;

/// Returns the grid of a scene: about `cells` cells, Courant number `cfl`. If the scene may have sharp waves, they cross each cell in exactly one
/// step where possible: at a Courant number lower by 1e-4 the scheme disperses them by 10 % of their stress. Smooth waves do not need this and are
/// computed to second order without it.
///
/// # Panics
/// If the Courant number is outside of 0 < cfl <= 1, which scenes exclude.
pub fn grid(scene: &Scene, cells: usize, cfl: f64) -> Grid {
    let grid = Grid::new(&scene.bar, cells, cfl);
    if cfl < 1.0 || !(scene.may_have_sharp_waves() || sudden_fans::rise_within_steps(scene, grid.dt)) {
        return grid;
    }
    grid.in_whole_steps(&scene.bar, MOST_SHIFT / grid.steps_to(scene.solve.until) as f64)
}

/// Returns the grid of a scene for its method; `None` for front tracking. Tapers must already be divided into pieces if the method needs that.
pub fn grid_by_method(scene: &Scene) -> Option<Grid> {
    match scene.solve.method {
        Method::Leapfrog { cells, cfl } | Method::Muscl { cells, cfl } => Some(grid(scene, cells, cfl)),
        Method::CharacteristicNet { cells } => Some(net::grid(&scene.bar, cells)),
        Method::FrontTracking { .. } => None,
    }
}

/// Builds the leapfrog bar of a scene at t = 0: about `cells` cells, Courant number `cfl`.
///
/// # Panics
/// If the Courant number is outside of 0 < cfl <= 1, which scenes exclude.
pub fn leapfrog(scene: &Scene, cells: usize, cfl: f64) -> Leapfrog {
    let grid = grid(scene, cells, cfl);
    let laws = scene.bar.segments.iter().map(|s| stepped_law(s, &scene.effects, grid.dt)).collect();
    let ends = ends_on_grid(scene);
    let rate_independent = scene.effects.rate.is_none();
    let along = distributed_forces(&scene.bar, &scene.effects).unwrap_or_default();
    let (fans, sudden) = start(scene, &grid, &along);
    let bar = Leapfrog::with_along(&scene.bar, grid, laws, ends.clone(), &along);
    let bar = bar.starting_with(&ends, &fans, rate_independent).under_sudden_loads(sudden);
    match criteria(scene) {
        Some(criteria) => bar.that_breaks(criteria, above_critical(scene, &fans)),
        None => bar,
    }
}

/// Returns the end conditions for a grid. A prescribed stress above the largest stress of the curve is limited to that stress, as in front tracking:
/// otherwise the first cell would store the excess momentum and return it once the stress falls. In a bar that may fracture nothing is limited,
/// because the strain of the first cell determines when it does.
fn ends_on_grid(scene: &Scene) -> [EndCondition; 2] {
    let limited = follows_curves(scene) && scene.effects.rupture.is_none();
    let last = scene.bar.segments.len() - 1;
    [(&scene.left, 0), (&scene.right, last)].map(|(end, segment)| match end {
        EndCondition::Stress { history } if limited => {
            let material = &scene.bar.segments[segment].material;
            let [tension, compression] = [Sense::Tension, Sense::Compression]
                .map(|sense| material.branch(sense).ultimate().map_or(f64::INFINITY, |ultimate| ultimate.stress));
            EndCondition::Stress { history: history.within([-compression, tension]) }
        }
        end => end.clone(),
    })
}

/// Returns whether the left and the right end are struck or pulled at more than the critical velocity.
fn above_critical(scene: &Scene, fans: &[InitialFan]) -> [bool; 2] {
    // A rate-dependent bar does not start with the fan of its curve, so the fans of the curve are checked as well.
    let [left, right] = scene.ends_in_run();
    let first = first_fans(&scene.bar, &left, &right);
    let all = || fans.iter().chain(&first);
    [Origin::Left, Origin::Right].map(|end| all().any(|fan| fan.origin == end && fan.fan.above_critical))
}

/// Returns the fan of a sudden load at t = 0 that strains the bar beyond the data of its curve at once; `None` if there is no such load or if the bar
/// does not start with the fans of its curves. The strain at the end of the bar is then beyond the data even where the mean strain of the first cell
/// is not, as under a light striker.
pub fn starts_beyond_data(scene: &Scene) -> Option<InitialFan> {
    let is_plain = distributed_forces(&scene.bar, &scene.effects).is_none() && scene.effects.rupture.is_none();
    let [left, right] = scene.ends_in_run();
    let fans = if is_plain && follows_curves(scene) { starting_fans(&scene.bar, &left, &right) } else { Vec::new() };
    fans.into_iter().find(|fan| fan.fan.beyond_data && fan.from == 0.0 && fan.holds_until > 0.0)
}

/// Returns the fans with which leapfrog starts, and the sudden loads that its histories and peaks show.
fn start(scene: &Scene, grid: &Grid, along: &DistributedForces) -> (Vec<InitialFan>, SuddenLoads) {
    let mut fans = match (follows_curves(scene), along.is_nothing()) {
        (true, true) => sudden_fans(scene, grid, sudden_fans::LATE_IN_LEAPFROG),
        (true, false) => sudden_fans::beside_forces(scene, grid, along),
        (false, true) => return start_with_rate(scene, grid),
        (false, false) => Vec::new(),
    };
    let sudden = sudden_loads(scene, &fans, grid, 1.0);
    if along.is_nothing() {
        fans.extend(sudden_fans::at_springs(scene, grid, sudden_fans::LATE_IN_LEAPFROG));
        // A ball cannot pull, so that its fan ends once the stress is 0.
        let without_pull = |fan: InitialFan| InitialFan { yields_after: fan.yields_after.min(fan.fan.stress), ..fan };
        let balls = sudden_fans::at_balls(scene, grid).into_iter();
        fans.extend(balls.map(|fan| without_pull(unloaded(fan, scene))));
    }
    (fans, sudden)
}

/// Returns whether first loading follows the materials' curves from the first step on.
fn follows_curves(scene: &Scene) -> bool {
    scene.effects.rate.is_none() && starts_on_curves(scene)
}

/// Returns whether first loading starts on the materials' curves. The curve of a material that flow heats is adiabatic and holds only for a cold bar
/// without plastic strain.
fn starts_on_curves(scene: &Scene) -> bool {
    let warms = |segment: &Segment| heat_of_state(segment, &scene.effects).is_some();
    !scene.bar.segments.iter().any(|segment| warms(segment) && (segment.has_yielded() || segment.starts_warm()))
}

/// Builds the MUSCL (Godunov) bar of a scene at t = 0: about `cells` cells, Courant number `cfl`.
///
/// # Panics
/// If the Courant number is outside of 0 < cfl <= 1, which scenes exclude.
pub fn muscl(scene: &Scene, cells: usize, cfl: f64) -> Muscl {
    let grid = grid(scene, cells, cfl);
    let laws = scene.bar.segments.iter().map(|s| segment_law(s, &scene.effects)).collect();
    let media = scene.bar.segments.iter().map(|s| medium(s, &scene.effects)).collect();
    let mut fans = sudden_fans(scene, &grid, sudden_fans::LATE_IN_MUSCL);
    let sudden = sudden_loads(scene, &fans, &grid, 1.0);
    fans.extend(sudden_fans::at_springs(scene, &grid, sudden_fans::LATE_IN_MUSCL));
    let ends = ends_on_grid(scene);
    let bar = Muscl::new(&scene.bar, grid, laws, media, ends);
    let bar = if follows_curves(scene) { bar.starting_with(&fans) } else { bar };
    bar.under_sudden_loads(sudden)
}

/// Returns the fans with which ends and joints start, and those that start there later, with the way the bar behind them unloads.
fn sudden_fans(scene: &Scene, grid: &Grid, late: f64) -> Vec<InitialFan> {
    all_sudden_fans(scene, grid, late).into_iter().map(|fan| unloaded(fan, scene)).collect()
}

/// Returns the fan with the way the bar behind it unloads.
fn unloaded(fan: InitialFan, scene: &Scene) -> InitialFan {
    if is_followed_both_ways(&scene.effects) {
        return fan.unloading_along_curve();
    }
    let yields = if moves(&scene.effects) {
        yield_stress(&scene.bar.segments[fan.segment].material, fan.sense)
    } else {
        fan.fan.stress
    };
    InitialFan { yields_after: 2.0 * yields, ..fan }
}

/// Stress at which a material first yields in this sense, Pa.
fn yield_stress(material: &Material, sense: Sense) -> f64 {
    Table::new(material.branch(sense), material.modulus).yield_stress()
}

/// Returns all fans as if the bar unloaded elastically.
fn all_sudden_fans(scene: &Scene, grid: &Grid, late: f64) -> Vec<InitialFan> {
    let first = starting_fans(&scene.bar, &scene.left, &scene.right);
    if !follows_curves(scene) {
        return first;
    }
    if !sudden_fans::can_be_tracked(scene) {
        return sudden_fans::with_first_rises(first, scene, (grid, late));
    }
    if !sudden_fans::is_uniform(scene) {
        return sudden_fans::until_changes_come(first, scene, (grid, late));
    }
    let stepped = as_stepped(scene, grid);
    let later = sudden_fans::tracked(&stepped, grid.dt, scene.solve.until);
    sudden_fans::with_later(first, &later, &stepped, (grid, late))
}

/// Returns the scene with the segment lengths that the scheme uses on this grid.
fn as_stepped(scene: &Scene, grid: &Grid) -> Scene {
    let mut scene = scene.clone();
    for (segment, part) in scene.parts.bar.segments.iter_mut().zip(&grid.segments) {
        segment.length *= part.dx / part.spacing;
    }
    scene
}

/// Returns the loads behind these fans. They last for the fraction `part` of the time for which schemes need the state behind a fan.
fn sudden_loads(scene: &Scene, fans: &[InitialFan], grid: &Grid, part: f64) -> SuddenLoads {
    let dx: Vec<f64> = grid.segments.iter().map(|segment| part * segment.dx).collect();
    SuddenLoads::new(&scene.bar, fans, &dx)
}

/// Numbers of steps after the load at which the state behind it is evaluated if it fades with time: the mean of the first step, and about the last
/// step in which the load is shown.
const FADING: [f64; 2] = [0.5, 100.0];

/// Fraction of the time for which schemes need the state behind a fan after which they reach that state by themselves if the bar is rate-dependent.
const SELF_CONVERGED: f64 = 0.5;

/// Returns the fans with which a rate-dependent bar starts, and its sudden loads; both are empty if the bar is not rate-dependent.
fn start_with_rate(scene: &Scene, grid: &Grid) -> (Vec<InitialFan>, SuddenLoads) {
    if scene.effects.rate.is_none() || !starts_on_curves(scene) {
        return Default::default();
    }
    let times = FADING.map(|steps| steps * grid.dt);
    let [early, late] = times.map(|time| {
        let rate_independent = rate_curves::rate_independent(scene, time);
        let mut fans = sudden_fans(&rate_independent, grid, sudden_fans::LATE_IN_LEAPFROG);
        fans.retain(|fan| rate_curves::has_relaxed(fan, scene, times[0]));
        // Flow after an earlier load is still relaxing when a later load arrives, so that the later fan is dropped.
        let all = fans.clone();
        fans.retain(|fan| !all.iter().any(|other| other.precedes(fan)));
        (sudden_loads(&rate_independent, &fans, grid, SELF_CONVERGED), fans)
    });
    let loads = late.0.fading(&early.0, times);
    let fans = late.1.into_iter().filter(|fan| loads.hardly_fades(fan, &early.1)).collect();
    (fans, loads)
}

/// Stress differences below this fraction of the yield stress count as rounding in states that are summed up over many steps.
const ROUND_OFF: f64 = 1e-11;

/// Returns the data of a segment on a grid that the Riemann problem needs.
pub fn medium(segment: &Segment, effects: &Effects) -> Medium {
    let material = &segment.material;
    let [tension, compression] = [Sense::Tension, Sense::Compression].map(|sense| {
        let table = Table::new(material.branch(sense), material.modulus);
        let level = table.yield_stress();
        (table, level)
    });
    let level = tension.1.min(compression.1);
    let round_off = if level.is_finite() { ROUND_OFF * level } else { 0.0 };
    let overlays = effects.hardening == Some(HardeningRule::Kinematic) && tension.0.is_multilinear();
    let flow = if overlays { Flow::Overlay } else { flow(effects) };
    let tables = [&tension.0, &compression.0];
    Medium::new(tables, material.modulus, material.density, segment.area, flow, round_off)
}

/// Returns the forces that act along the bar besides the stress of the curve; `None` if there are none. A section counts as round: its polar radius
/// of gyration is that of a disc, `r_p^2 = A/(2 pi)`. Poisson's ratio is the elastic one throughout.
pub fn distributed_forces(bar: &Bar, effects: &Effects) -> Option<DistributedForces> {
    let damping = effects.damping.unwrap_or_default();
    let lateral = |segment: &Segment| {
        let poisson = segment.material.poisson.filter(|_| effects.lateral_inertia).unwrap_or(0.0);
        poisson * poisson * segment.area / (2.0 * PI)
    };
    let along = DistributedForces {
        internal: damping.internal,
        external: damping.external,
        foundation: damping.foundation,
        friction: damping.friction,
        lateral: bar.segments.iter().map(lateral).collect(),
    };
    Some(along).filter(|along| !along.is_nothing())
}

/// Returns the fracture criteria of the bar; `None` if the scene has no rupture effect.
pub fn criteria(scene: &Scene) -> Option<Criteria> {
    let rupture = scene.effects.rupture.as_ref()?;
    let criterion = |(segment, &notch): (&Segment, &f64)| {
        let material = &segment.material;
        let own = || material.branch(Sense::Tension).ultimate().map_or(f64::INFINITY, |u| u.strain);
        Criterion::new(rupture.cause, rupture.threshold.unwrap_or_else(own), material.modulus, notch)
    };
    Some(Criteria {
        segments: scene.bar.segments.iter().zip(&rupture.notches).map(criterion).collect(),
        joints: rupture.joint_notches.clone(),
    })
}

/// Builds the front-tracking bar of a scene at t = 0, with tapered segments divided into steps, see [`Scene::in_pieces`].
pub fn front_tracking(scene: &Scene, settings: Settings) -> FrontTracking {
    let cut = scene.in_pieces();
    let scene = cut.as_ref().unwrap_or(scene);
    let whole = scene.discretized.as_ref().map_or(&scene.bar, |cut| &cut.original.bar);
    let ends = ([scene.left.clone(), scene.right.clone()], whole.end_velocities());
    FrontTracking::that_breaks(&scene.bar, flow(&scene.effects), ends, settings, criteria(scene))
}

/// Builds the characteristic net of a rate-dependent scene at t = 0 with about `cells` cells; tapered segments are divided in the same way.
pub fn characteristic_net(scene: &Scene, cells: usize) -> Net {
    let cut = scene.in_pieces();
    let scene = cut.as_ref().unwrap_or(scene);
    let laws = scene.bar.segments.iter().map(|s| rate_law(&s.material, &scene.effects)).collect();
    let grid = net::grid(&scene.bar, cells);
    let (_, sudden) = start_with_rate(scene, &grid);
    Net::new(&scene.bar, grid, laws, [scene.left.clone(), scene.right.clone()]).under_sudden_loads(sudden)
}

/// Returns the rate-dependent law of a material at its reference temperature. The law is rate-independent if the scene has no rate effect or if the
/// material lacks the constants (which [`Scene::notes`] reports).
pub fn rate_law(material: &Material, effects: &Effects) -> RateLaw {
    let law = effects.rate.and_then(|rate| Overstress::of(rate, material));
    let overstress = law.unwrap_or(Overstress::RATE_INDEPENDENT);
    let kinematic = effects.hardening.map_or(0.0, HardeningRule::kinematic_fraction);
    // If the temperature is a state variable, the curves are those of the cold material.
    let cold = material.heating.as_ref().map(|heating| heating.cold.iter().collect());
    let curves: Vec<&Curve> =
        cold.unwrap_or_else(|| [&material.tension].into_iter().chain(&material.compression).collect());
    let tables: Vec<Table> = curves.iter().map(|curve| Table::new(curve, material.modulus)).collect();
    RateLaw::new(overstress, &tables[0], tables.get(1), kinematic)
}

fn moves(effects: &Effects) -> bool {
    effects.hardening.is_some_and(HardeningRule::moves)
}

/// Returns the heating data of a segment if its temperature is a state variable of each cell. `None` if hardening is isotropic, flow is
/// rate-independent, and the segment starts cold and without plastic strain: then the adiabatic curve alone determines the temperature.
pub fn heat_of_state<'a>(segment: &'a Segment, effects: &Effects) -> Option<&'a Heating> {
    let heating = segment.material.heating.as_deref()?;
    let own = moves(effects) || effects.rate.is_some() || segment.has_yielded() || segment.starts_warm();
    (heating.warms() && own).then_some(heating)
}

/// Returns the law of one segment under the scene's effects, for steps of `dt` (s). Heat applies first (to the curve, or to the static stresses of
/// the cell), then the strain rate. Rupture comes last, in the solver.
pub fn stepped_law(segment: &Segment, effects: &Effects, dt: f64) -> SegmentLaw {
    let (law, material) = (segment_law(segment, effects), &segment.material);
    let (moves, heat) = (moves(effects), heat_of_state(segment, effects));
    if effects.rate.is_none() && heat.is_none() {
        return law;
    }
    let timed = rate_law(material, effects);
    let rows: Arc<dyn RowLaw> = match (heat, moves) {
        (Some(heat), true) => rows(Heated::<7>::new(timed, heat, material.modulus, dt)),
        (Some(heat), false) => rows(Heated::<6>::new(timed, heat, material.modulus, dt)),
        (None, true) => warming(Timed::<6>::new(timed, dt), material),
        (None, false) => warming(Timed::<5>::new(timed, dt), material),
    };
    let end = if heat.is_some() { cold_end(material) } else { law.end };
    SegmentLaw { law: rows, end, ..law }
}

/// Returns where the data end for a cell whose temperature is a state variable.
fn cold_end(material: &Material) -> DataEnd {
    let cold: Vec<&Curve> = material.heating.iter().flat_map(|heating| &heating.cold).collect();
    let tables: Vec<Table> = cold.iter().map(|curve| Table::new(curve, material.modulus)).collect();
    DataEnd::new([&tables[0], &tables[tables.len() - 1]], material.modulus, material.loading)
}

/// Returns the law of one segment under all of the scene's effects except the strain rate.
pub fn segment_law(segment: &Segment, effects: &Effects) -> SegmentLaw {
    let material = &segment.material;
    let tension = Table::new(material.branch(Sense::Tension), material.modulus);
    let compression = Table::new(material.branch(Sense::Compression), material.modulus);
    SegmentLaw {
        yield_stress: tension.yield_stress().min(compression.yield_stress()),
        end: DataEnd::new([&tension, &compression], material.modulus, material.loading),
        shocks: shocks([&tension, &compression], material, effects),
        stiffenings: if is_followed_both_ways(effects) {
            <[Arc<[f64]>; 2]>::default()
        } else {
            [&tension, &compression].map(|table| table.stiffenings().collect())
        },
        law: choose_backbone(material, &tension, compression, effects),
    }
}

/// Returns whether unloading follows the curve: in bars with neither a hardening rule nor a rate law.
fn is_followed_both_ways(effects: &Effects) -> bool {
    effects.hardening.is_none() && effects.rate.is_none()
}

/// Returns which waves of a segment can be shocks.
fn shocks(tables: [&Table; 2], material: &Material, effects: &Effects) -> Shocks {
    let distance = |chord: Chord| chord.relative_distance(material.modulus);
    let loading = tables.map(|table| table.chords(SCATTER).into_iter().map(distance).fold(0.0, f64::max));
    let unloading = if is_followed_both_ways(effects) {
        tables.map(|table| table.chords_from_origin().map(distance).fold(0.0, f64::max))
    } else {
        [0.0; 2]
    };
    let to_stiffening = tables.map(Table::velocity_to_stiffening).into_iter().fold(f64::INFINITY, f64::min);
    Shocks { loading, unloading, velocity: to_stiffening / material.impedance() }
}

/// Returns the flow rule of front tracking under the scene's effects. Kinematic hardening is that of a bilinear curve, without an overlay.
pub fn flow(effects: &Effects) -> Flow {
    effects.hardening.map_or(Flow::PathIndependent, |rule| Flow::Plastic { kinematic: rule.kinematic_fraction() })
}

/// Returns the hardening law with the fastest representation that its table permits.
fn choose_backbone(material: &Material, tension: &Table, compression: Table, effects: &Effects) -> Arc<dyn RowLaw> {
    if material.compression.is_some() {
        let indexed = (Indexed::new(tension), Indexed::new(&compression));
        return if let (Some(tension), Some(compression)) = indexed {
            without_back_stress(TwoSided { tension, compression }, effects.hardening, material)
        } else {
            let tension = Searched(tension.clone());
            without_back_stress(TwoSided { tension, compression: Searched(compression) }, effects.hardening, material)
        };
    }
    match effects.hardening {
        // The representations for few lines gain nothing here: the law searches for the flow of each cell.
        Some(HardeningRule::Kinematic) if tension.is_multilinear() => match Indexed::new(tension) {
            Some(indexed) => warming(Overlay::new(indexed, tension), material),
            None => warming(Overlay::new(Searched(tension.clone()), tension), material),
        },
        Some(HardeningRule::ArmstrongFrederick { c, gamma }) => {
            let back = BackStress::new(c, gamma, material.modulus);
            match Indexed::new(tension) {
                Some(indexed) => rows(ArmstrongFrederick::new(indexed, back)),
                None => rows(ArmstrongFrederick::new(Searched(tension.clone()), back)),
            }
        }
        rule => {
            if let Some(two) = Envelope::<2>::new(tension) {
                of_one_curve(two, rule, tension, material)
            } else if let Some(four) = Envelope::<4>::new(tension) {
                of_one_curve(four, rule, tension, material)
            } else if let Some(eight) = Envelope::<8>::new(tension) {
                of_one_curve(eight, rule, tension, material)
            } else if let Some(indexed) = Indexed::new(tension) {
                of_one_curve(indexed, rule, tension, material)
            } else {
                of_one_curve(Searched(tension.clone()), rule, tension, material)
            }
        }
    }
}

/// Returns a law without back stress. Materials with a curve for each sense have none: scenes are checked for that.
fn without_back_stress<B: Backbone + 'static>(
    backbone: B,
    rule: Option<HardeningRule>,
    material: &Material,
) -> Arc<dyn RowLaw> {
    match rule {
        None => rows(PathIndependent(backbone)),
        Some(_) => warming(Isotropic(backbone), material),
    }
}

/// Returns a law with one curve for both senses and isotropic hardening, or hardening that moves the elastic range by a fixed fraction.
fn of_one_curve<B: Backbone + 'static>(
    backbone: B,
    rule: Option<HardeningRule>,
    table: &Table,
    material: &Material,
) -> Arc<dyn RowLaw> {
    match rule.filter(|rule| rule.moves()) {
        None => without_back_stress(backbone, rule, material),
        Some(rule) => {
            let (yield_stress, kinematic) = (table.yield_stress(), rule.kinematic_fraction());
            warming(Mixed { backbone, yield_stress, kinematic }, material)
        }
    }
}

/// Wraps a law so that it can report the temperature if its tables are those of a heated material.
fn warming<L: CellLaw<N> + 'static, const N: usize>(law: L, material: &Material) -> Arc<dyn RowLaw> {
    match &material.heating {
        Some(heating) => Arc::new(Rows::adiabatic(law, heating, material.modulus)),
        None => rows(law),
    }
}

fn rows<L: CellLaw<N> + 'static, const N: usize>(law: L) -> Arc<dyn RowLaw> {
    Arc::new(Rows::new(law))
}
