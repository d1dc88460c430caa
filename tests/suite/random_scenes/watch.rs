//! Steps the bar of a scene to its end and checks properties that hold at any time.

use barwave::assemble;
use barwave::bar::{EndCondition, Segment};
use barwave::material::{Beyond, Curve, Sense};
use barwave::record::{Field, Ledger, Stepped, View};
use barwave::scene::{HardeningRule, Method, Scene};
use barwave::solver::Energies;
use barwave::solver::fd::{Quantity, Sampling};
use barwave::solver::moc::{FrontTracking, Settings};

use super::checks::Failure;

/// Number of checks during a run.
const LOOKS: u32 = 24;
/// Number of parts of the bar whose mean stresses are compared, and of positions in each.
const PARTS: usize = 10;
const PLACES: usize = 20;
/// Shift of the positions, relative to their distance.
const OFF_EVEN: f64 = 0.031_415_9;
/// Relative rounding of sums over some thousand terms; a missing term causes 1e-5 and more.
const ROUNDING: f64 = 1e-9;
/// Rounding of the energy of a body at an end over some thousand steps, of which its work is the difference.
const BODY_ROUNDING: f64 = 1e-13;

/// Allowed error of merged fronts in front tolerances; the largest in about 10^3 scenes is 3.4.
const FRONT_TOLERANCES: f64 = 6.0;

/// Returns the allowance for merged fronts: some front tolerances of the largest stress; its square is that for the energy.
fn front_tolerance(scene: &Scene) -> f64 {
    match scene.solve.method {
        Method::FrontTracking { front_tolerance, .. } => FRONT_TOLERANCES * front_tolerance,
        _ => 0.0,
    }
}

/// Fraction of the total energy of the run that the conservative scheme may add; a run stops above it.
const MOST_GIVEN: f64 = 0.2;
/// Number of cells whose kinetic energy a grid may add, those with the most. Its error is of the order of the energy of a cell at the front:
/// dissipation by the grid filter is guaranteed in smooth fronts only, and an end that accelerates its cell does the work of the velocity before. See
/// `what_the_grid_gives_goes_to_zero_with_the_cells`.
const CELLS_GIVEN: f64 = 1.0;

/// Class of failures of a method that adds energy to the bar.
pub const GIVES: &str = "gives energy";

/// Figures of a run that can be compared with those of another one.
pub struct Figures {
    /// Mean stresses of the parts of the bar, from left to right.
    pub stress: Scaled<Vec<f64>>,
    pub velocity: Scaled<Vec<f64>>,
    /// Impulses of the left and the right end.
    pub impulse: Scaled<[f64; 2]>,
    pub work: Scaled<[f64; 2]>,
    /// Largest magnitude of the strain at the sampled positions.
    pub strain: f64,
    /// Largest magnitude of the strain in any cell of a grid.
    pub strain_of_cell: f64,
    /// True if the run has finished.
    pub ended: bool,
    /// Fraction of the total energy that the method has dissipated; with a conservative scheme, in shocks.
    pub taken: f64,
    /// Largest fraction of the total energy that the method has added.
    pub given: f64,
    /// True if the curve is followed both ways (no effect `hardening`).
    pub returns: bool,
    /// True if strain concentrates at a point, where the load exceeds what the curve can transmit.
    pub gathers: bool,
}

/// Values and their scale: the largest magnitude during the run, the momentum that has passed through the bar, or its energy.
#[derive(Debug, Clone)]
pub struct Scaled<T> {
    pub values: T,
    pub scale: f64,
}

/// Returns the sampled positions, m: equidistant, except for a small shift towards the middle of each part. None is at a joint, where the mirrored
/// bar would be sampled on the other side.
fn places(length: f64) -> Vec<f64> {
    let shift = |j: usize| if j < PLACES / 2 { OFF_EVEN } else { -OFF_EVEN };
    let within = |j: usize| (j as f64 + 0.5 + shift(j)) / PLACES as f64;
    let all = (0..PARTS).flat_map(|part| (0..PLACES).map(move |j| part as f64 + within(j)));
    all.map(|part| part * length / PARTS as f64).collect()
}

/// Steps the bar of a scene with its method up to a time, s, and returns its figures.
pub fn follow(scene: &Scene, until: f64, failures: &mut Vec<Failure>) -> Figures {
    match scene.solve.method {
        Method::Leapfrog { cells, cfl } => follow_grid(scene, assemble::leapfrog(scene, cells, cfl), until, failures),
        Method::Muscl { cells, cfl } => follow_grid(scene, assemble::muscl(scene, cells, cfl), until, failures),
        Method::CharacteristicNet { cells } => {
            follow_grid(scene, assemble::characteristic_net(scene, cells), until, failures)
        }
        Method::FrontTracking { front_tolerance, event_budget } => {
            let settings = Settings { front_tolerance, event_budget, ..Settings::default() };
            follow_fronts(scene, assemble::front_tracking(scene, settings), until, failures)
        }
    }
}

fn follow_grid<S: Stepped>(scene: &Scene, mut bar: S, until: f64, failures: &mut Vec<Failure>) -> Figures {
    let mut watch = Watch::new(scene, &bar);
    let limits = StressLimits::new(scene);
    let dt = bar.grid().dt;
    let steps = ((until / dt - 1e-9).ceil() as usize).max(1);
    let places = Sampling::at(bar.grid(), places(scene.bar.length()));
    // A bar in initial motion may have lost most of its kinetic energy by the first check.
    watch.cell = CELLS_GIVEN * largest_cell(scene, &bar);
    for look in 1..=LOOKS as usize {
        let target = steps * look / LOOKS as usize;
        bar.advance_by(target.saturating_sub(bar.step()));
        watch.cell = watch.cell.max(CELLS_GIVEN * largest_cell(scene, &bar));
        watch.look(&bar, &places, failures);
        let strains = (0..bar.grid().cells()).map(|cell| bar.value(Quantity::Strain, cell).abs());
        watch.strain_of_cell = strains.fold(watch.strain_of_cell, f64::max);
        if let Some(cell) = bar.not_finite() {
            failures.push(Failure::new("not finite", format!("cell {cell} at {:e} s", bar.time())));
            return watch.figures(&bar, &places, false);
        }
        let Some(limits) = &limits else { continue };
        for (k, part) in bar.grid().segments.iter().enumerate() {
            for cell in part.cells.clone() {
                let stress = bar.value(Quantity::Stress, cell);
                limits.check(k, stress, bar.value(Quantity::AccumulatedPlasticStrain, cell), bar.time(), failures);
            }
        }
    }
    if matches!(scene.solve.method, Method::Muscl { .. }) && watch.given > MOST_GIVEN * watch.energy {
        failures.push(Failure::new(GIVES, format!("numerical = {:e} of {:e} J", -watch.given, watch.energy)));
    }
    watch.figures(&bar, &places, true)
}

/// Returns the kinetic energy of the cell that has most, J.
fn largest_cell<S: Stepped>(scene: &Scene, bar: &S) -> f64 {
    let segments = scene.bar.segments.iter().zip(&bar.grid().segments);
    let motion = segments.flat_map(|(segment, grid)| {
        grid.cells.clone().map(move |cell| {
            let [from, to] = grid.cell(cell);
            let mass = segment.material.density * segment.mean_area(from, to) * (to - from);
            mass * bar.value(Quantity::Velocity, cell).powi(2)
        })
    });
    let (all, largest) = motion.fold((0.0, 0.0_f64), |(all, largest), of_cell| (all + of_cell, largest.max(of_cell)));
    if all > 0.0 { bar.account().energies.kinetic * largest / all } else { 0.0 }
}

fn follow_fronts(scene: &Scene, mut bar: FrontTracking, until: f64, failures: &mut Vec<Failure>) -> Figures {
    let cut = scene.in_pieces();
    let scene = cut.as_ref().unwrap_or(scene);
    let mut watch = Watch::new(scene, &bar);
    let slack = front_tolerance(scene) * bar.stress_scale();
    watch.unanswered = unanswered_by_balls(scene, slack);
    let limits = StressLimits::new(scene).map(|limits| StressLimits { slack, ..limits });
    let places = places(scene.bar.length());
    for look in 1..=LOOKS {
        if bar.advance_to(until * f64::from(look) / f64::from(LOOKS)).is_err() {
            return watch.figures(&bar, &places[..], false);
        }
        watch.look(&bar, &places[..], failures);
        let Some(limits) = &limits else { continue };
        for piece in bar.pieces() {
            // Along a curve that is followed both ways, no plastic strain is accumulated.
            let accumulated =
                piece.point.accumulated.max(piece.point.plastic.abs()) / bar.medium(piece.segment).modulus;
            limits.check(piece.segment, piece.point.stress, accumulated, bar.time(), failures);
        }
    }
    let short = bar.ends().iter().any(|end| end.above_critical.is_some());
    let figures = watch.figures(&bar, &places[..], true);
    Figures { gathers: figures.gathers || short, ..figures }
}

/// Balances of a run.
struct Watch {
    ledger: Ledger,
    last: Energies,
    /// True if plastic work cannot decrease.
    plastic_stays: bool,
    /// True if heat can decrease with plastic work: see `heat_is_a_fraction_of_all_plastic_work`.
    cools: bool,
    /// Allowances for terms of either sign, relative to the total energy: for energy added by the method, and for energy beyond the elastic one that
    /// is returned along a curve that is followed both ways.
    numerical: f64,
    plastic: f64,
    returns: bool,
    /// Plastic work done before the start, J: an elastic range that it has moved can return some of it.
    earlier: f64,
    /// Energy that a grid may add because of the size of its cells, J.
    cell: f64,
    /// Power of a ball at an end of a tracked bar due to waves to which it does not respond, W.
    unanswered: f64,
    /// Largest energy that the method has added, J.
    given: f64,
    slack: f64,
    /// Absolute allowance for the energy, J.
    least: f64,
    energy: f64,
    momentum: f64,
    /// Largest stress, velocity and strain.
    largest: [f64; 3],
    strain_of_cell: f64,
}

impl Watch {
    fn new(scene: &Scene, bar: &impl View) -> Self {
        let both_ways = scene.effects.hardening.is_none();
        let isotropic = scene.effects.hardening == Some(HardeningRule::Isotropic);
        Self {
            ledger: Ledger::new(bar),
            last: Energies::default(),
            plastic_stays: isotropic,
            cools: !isotropic && scene.effects.heat.is_some(),
            numerical: match scene.solve.method {
                // Checked for the whole run, see `MOST_GIVEN`.
                Method::Muscl { .. } => f64::INFINITY,
                Method::FrontTracking { .. } => front_tolerance(scene),
                Method::Leapfrog { .. } | Method::CharacteristicNet { .. } => 0.0,
            },
            plastic: if both_ways || gives_back(scene) { f64::INFINITY } else { 0.0 },
            returns: both_ways,
            earlier: if isotropic { 0.0 } else { earlier_work(scene) },
            given: 0.0,
            unanswered: 0.0,
            cell: 0.0,
            least: [&scene.left, &scene.right].into_iter().map(body_energy).sum::<f64>() * BODY_ROUNDING,
            slack: ROUNDING + front_tolerance(scene).powi(2),
            energy: bar.start().energy,
            // As in the ledger: a bar in initial motion has momentum that no end has supplied. Without it, the impulse of an end that the bar only
            // touches (7e-5 to 1e-3 of 0.13 N s, in scene 16027058208322088354) would differ by 100 %.
            momentum: (2.0 * bar.start().energy * bar.start().mass).sqrt(),
            largest: [0.0; 3],
            strain_of_cell: 0.0,
        }
    }

    fn look<V: View>(&mut self, bar: &V, places: &V::Places, failures: &mut Vec<Failure>) {
        let at = bar.time();
        let mut fail = |class: &'static str, detail: String| {
            failures.push(Failure::new(class, format!("{detail} at {at:e} s")));
        };
        let row = self.ledger.row(bar);
        let account = bar.account();
        let values = row.energies.values();
        let all = values.into_iter().chain([row.work_left, row.work_right, row.impulse, row.energies.momentum]);
        if all.into_iter().any(|value| !value.is_finite()) {
            fail("not finite", format!("{row:?}"));
            return;
        }
        let held: f64 = values.iter().map(|energy| energy.abs()).sum();
        self.energy = self.energy.max(held).max(row.work_left.abs()).max(row.work_right.abs());
        self.momentum = self.momentum.max(account.momentum_scale);
        let slack = self.slack * self.energy + self.least;
        let unanswered = self.unanswered * at;
        for ((&[name, _], now), before) in Energies::COLUMNS.iter().zip(values).zip(self.last.values()) {
            let least = match name {
                "half_step" => f64::INFINITY,
                "numerical" => (self.numerical * self.energy).max(self.cell) + unanswered + slack,
                "plastic" | "heat" => self.plastic * self.energy + self.earlier + slack,
                // Energy concentrated at a point is plastic work, too.
                "concentrated" => self.plastic * self.energy + slack,
                _ => slack,
            };
            if now < -least {
                let class = if name == "numerical" { GIVES } else { "negative energy" };
                fail(class, format!("{name} = {now:e} of {:e} J", self.energy));
            }
            let stays = matches!(name, "heat" | "viscoplastic" | "fracture" | "damping")
                || (matches!(name, "plastic" | "concentrated") && self.plastic_stays);
            let stays = stays && !(self.cools && name == "heat");
            if stays && now < before - slack {
                fail(
                    "dissipated energy decreases",
                    format!("{name} from {before:e} to {now:e} of {:e} J", self.energy),
                );
            }
        }
        self.last = row.energies;
        self.given = self.given.max(-self.last.numerical);
        let fields = [Field::Stress, Field::Velocity, Field::Strain].map(|field| sample(bar, field, places));
        for (largest, field) in self.largest.iter_mut().zip(fields) {
            *largest = field.iter().fold(*largest, |most, value| most.max(value.abs()));
        }
        for (class, worst) in
            [("energy residual", self.ledger.worst_energy()), ("momentum residual", self.ledger.worst_momentum())]
        {
            if worst > ROUNDING {
                fail(class, format!("{worst:e}"));
            }
        }
    }

    fn figures<V: View>(&self, bar: &V, places: &V::Places, ended: bool) -> Figures {
        let account = bar.account();
        // A bar of this energy in equilibrium moves by rounding only.
        let speed = self.largest[1].max(ROUNDING * (2.0 * self.energy / bar.start().mass).sqrt());
        // Relative to the momentum of a bar of this energy.
        let rounding = ROUNDING * self.energy / speed.max(f64::MIN_POSITIVE);
        let means = |field, scale| {
            let values = sample(bar, field, places);
            let mean = |part: &[f64]| part.iter().sum::<f64>() / part.len() as f64;
            Scaled { values: values.chunks(PLACES).map(mean).collect(), scale }
        };
        Figures {
            stress: means(Field::Stress, self.largest[0]),
            velocity: means(Field::Velocity, speed),
            impulse: Scaled { values: account.impulse, scale: self.momentum.max(rounding) },
            work: Scaled { values: account.work, scale: self.energy },
            strain: self.largest[2],
            strain_of_cell: self.strain_of_cell.max(self.largest[2]),
            taken: self.last.numerical / self.energy.max(f64::MIN_POSITIVE),
            given: self.given / self.energy.max(f64::MIN_POSITIVE),
            returns: self.returns,
            ended,
            gathers: self.last.concentrated > self.slack * self.energy,
        }
    }
}

/// Returns an upper bound of the plastic work, J, that is needed in one sense for the initial plastic strains.
pub fn earlier_work(scene: &Scene) -> f64 {
    let of = |segment: &Segment| {
        let table = segment.profile.as_ref().map(|profile| profile.plastic_strain.largest());
        let plastic = table.unwrap_or(segment.initial.plastic_strain.abs());
        let work = [Sense::Tension, Sense::Compression].map(|sense| {
            let curve = segment.material.branch(sense);
            // The strain whose plastic part is this plastic strain.
            let strain =
                (0..200).fold(plastic, |strain, _| plastic + curve.stress_at(strain) / segment.material.modulus);
            plastic * curve.stress_at(strain)
        });
        segment.mean_area(0.0, segment.length) * segment.length * work[0].max(work[1])
    };
    scene.bar.segments.iter().map(of).sum()
}

/// Returns true if a back stress that grows with the tangent at the accumulated plastic strain may return more than it stored: see
/// `mixed_hardening_along_several_lines_gives_back_more_than_it_stored`. Its plastic work is negative only if it exceeds half the elastic range, for
/// which more than half of the hardening must be kinematic.
fn gives_back(scene: &Scene) -> bool {
    let by_tangent = scene.effects.rate.is_some() || scene.effects.heat.is_some();
    let kinematic = match scene.effects.hardening {
        Some(HardeningRule::Mixed(kinematic)) => kinematic,
        Some(HardeningRule::Kinematic) if by_tangent => 1.0,
        // Its back stress may exceed half of the elastic range.
        Some(HardeningRule::ArmstrongFrederick { .. }) => return true,
        _ => 0.0,
    };
    let several = |curve: &Curve| curve.slopes().count() > if curve.beyond() == Beyond::Extend { 2 } else { 1 };
    kinematic > 0.5 && scene.bar.segments.iter().any(|segment| several(segment.material.branch(Sense::Tension)))
}

/// Fraction of the stress allowance by which a wave may change the force on a ball without a response, see `StepControl::passing`: a tenth of one
/// front tolerance.
const PASSING: f64 = 0.1 / FRONT_TOLERANCES;

/// Returns the power of balls at the ends due to waves to which they do not respond, W: the force times their own velocity, since the kinetic energy
/// of a ball and the energy of its contact are exchanged. In the first microseconds, this exceeds the power into the bar: see
/// `what_the_steps_of_a_ball_leave_goes_to_zero_with_the_tolerance`.
fn unanswered_by_balls(scene: &Scene, stress: f64) -> f64 {
    let last = scene.bar.segments.len() - 1;
    let power = |(end, segment): (&EndCondition, usize)| match end {
        EndCondition::Ball { velocity, .. } => PASSING * stress * scene.bar.segments[segment].area * velocity.abs(),
        _ => 0.0,
    };
    [(&scene.left, 0), (&scene.right, last)].into_iter().map(power).sum()
}

/// Returns the kinetic energy of a body that strikes an end, J.
fn body_energy(end: &EndCondition) -> f64 {
    match end {
        EndCondition::Striker { mass, velocity } | EndCondition::Ball { mass, velocity, .. } => {
            0.5 * mass * velocity.powi(2)
        }
        _ => 0.0,
    }
}

fn sample<V: View>(bar: &V, field: Field, places: &V::Places) -> Vec<f64> {
    let mut values = vec![0.0; PARTS * PLACES];
    bar.sample(field, places, &mut values);
    values
}

/// Largest stress that the curve of each segment can reach after some plastic strain.
struct StressLimits {
    modulus: Vec<f64>,
    curves: Vec<[Curve; 2]>,
    /// Allowance, Pa.
    slack: f64,
}

impl StressLimits {
    /// Returns the limits, or `None` if the stress does not follow a single curve: with a rate, a temperature, or damping in the stress.
    fn new(scene: &Scene) -> Option<Self> {
        let effects = &scene.effects;
        let moves = !matches!(effects.hardening, None | Some(HardeningRule::Isotropic));
        let viscous = effects.damping.is_some_and(|damping| damping.internal > 0.0);
        if effects.rate.is_some() || (effects.heat.is_some() && moves) || viscous {
            return None;
        }
        // A heated bar with initial plastic strain or temperature does not follow the adiabatic curve, but remains below the cold one.
        let curves = |segment: &Segment| {
            let starts_on_curve = !(segment.has_yielded() || segment.starts_warm());
            let heating = segment.material.heating.as_ref().filter(|_| !starts_on_curve);
            let cold = |k: usize| heating.map(|heating| &heating.cold[k.min(heating.cold.len() - 1)]);
            [(Sense::Tension, 0), (Sense::Compression, 1)]
                .map(|(sense, k)| cold(k).unwrap_or_else(|| segment.material.branch(sense)).running_maximum())
        };
        Some(Self {
            modulus: scene.bar.segments.iter().map(|segment| segment.material.modulus).collect(),
            curves: scene.bar.segments.iter().map(curves).collect(),
            slack: 0.0,
        })
    }

    fn check(&self, segment: usize, stress: f64, accumulated: f64, time: f64, failures: &mut Vec<Failure>) {
        let modulus = self.modulus[segment];
        let strain = stress.abs() / modulus + accumulated.abs();
        let allowed = self.curves[segment].iter().map(|curve| curve.stress_at(strain)).fold(0.0, f64::max);
        // A strain below the smallest normal number loses digits. NaN fails.
        let rounding = ROUNDING * modulus * strain + f64::MIN_POSITIVE * modulus;
        if !(stress.abs() <= allowed + rounding + self.slack) {
            let detail =
                format!("{stress:e} Pa, the curve reaches {allowed:e} Pa after {accumulated:e}, at {time:e} s");
            failures.push(Failure::new("stress above the curve", detail));
        }
    }
}
