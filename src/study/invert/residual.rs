//! Stress-strain curve from the strain along a wire during or after an impact, by the method of Th. von Kármán and P. Duwez (J. Appl. Phys. 21,
//! 1950).
//!
//! While the end moves at the impact velocity, the strain eps is at x = c(eps) t. When the end is released at the time T, an elastic wave follows the
//! plastic ones. The plastic strain that remains at x is that of the time T + x/c0, so c = x/(T + x/c0), and `d eps = d eps_p/(1 - (c/c0)^2)` since
//! `d sigma = rho c^2 d eps`. The velocity of the end is `c0 eps_y` + integral c d eps. This equation verifies the result, or gives the yield strain
//! `eps_y` if it is not known.
//!
//! The method is not valid where a reflected wave has arrived. The released wire keeps its strains only if the elastic wave unloads it everywhere.
//! Where this wave meets the stress sigma and the velocity v, it leaves the stress `(sigma - sigma_max + rho c0 (V - v))/2`, which must not exceed
//! sigma. This condition is satisfied in hard wires, `rho c0 V <= sigma_max + 2 sigma_y`. A soft wire continues to yield due to its inertia; only its
//! strains while the end moves give the curve.

use std::path::Path;

use rand::{RngExt, SeedableRng};
use rand_xorshift::XorShiftRng;
use serde::Serialize;

use super::curve::{Bounds, Integrated, Interval, WavePoint, bounds, integrate, points, unknown_start};
use super::given::turns_back;
use super::isotonic::{first_reach, non_decreasing};
use super::noise::{Noise, rounded};
use super::setup::{self, REPLICATES, SEED, Segment};
use super::table::Table;
use super::zero::mean;
use crate::error::{InputError, Result};
use crate::input::{Allowed, Checked, equally_long, finite, member, optional, positive};
use crate::material::{Beyond, Curve, Sense};
use crate::record::Field;
use crate::record::store::{ResultFile, Side};
use crate::study::random::standard_normal;
use crate::units::Dimension;

/// Kind of strain along the wire.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum State {
    /// Total strain while the end still moves.
    Loaded,
    /// Plastic strain that remains after the release of the end.
    Released,
}

/// Strain along a wire.
#[derive(Debug, Clone)]
pub struct Profile {
    /// Distances from the struck end, m, increasing.
    pub distance: Vec<f64>,
    /// Strains, positive in the sense of the loading.
    pub strain: Vec<f64>,
    /// Sense of the loading.
    pub sense: Sense,
}

/// A profile with the data of the test from a result file.
#[derive(Debug, Clone)]
pub struct Test {
    /// Strain along the wire.
    pub profile: Profile,
    /// Impact velocity, m/s, > 0.
    pub velocity: f64,
    /// Time of the profile (loaded) or of the release of the end (released), s.
    pub time: f64,
    /// Density, kg/m^3.
    pub density: f64,
    /// Elastic modulus, Pa.
    pub modulus: f64,
    /// Length of the wire, m.
    pub length: f64,
    /// Curve that the simulation used.
    pub given: Option<Curve>,
    /// Properties of the run that simple-wave theory does not describe, one sentence each.
    pub notes: Vec<String>,
}

/// Known data besides the profile, and settings of the inversion. Time, velocity, density and modulus must be given: their defaults are NaN, which is
/// refused.
#[derive(Debug, Clone)]
pub struct Options {
    /// Kind of strain of the profile.
    pub state: State,
    /// Time of the profile (loaded) or duration of the impact (released), s.
    pub time: f64,
    /// Impact velocity, m/s, > 0.
    pub velocity: f64,
    /// Standard error of the impact velocity, m/s.
    pub velocity_error: f64,
    /// Standard error of the position of the struck end, m.
    pub position_error: f64,
    /// Density, kg/m^3.
    pub density: f64,
    /// Elastic modulus, Pa.
    pub modulus: f64,
    /// Length of the wire, m.
    pub length: Option<f64>,
    /// Yield stress, Pa. For a released wire, `None` determines it from the impact velocity.
    pub yield_stress: Option<f64>,
    /// Number of bootstrap replicates, 20 to 100 000.
    pub replicates: usize,
    /// Seed of the random numbers.
    pub seed: u64,
}

impl Default for Options {
    fn default() -> Self {
        Self {
            state: State::Released,
            time: f64::NAN,
            velocity: f64::NAN,
            velocity_error: 0.0,
            position_error: 0.0,
            density: f64::NAN,
            modulus: f64::NAN,
            length: None,
            yield_stress: None,
            replicates: REPLICATES,
            seed: SEED,
        }
    }
}

impl Options {
    fn check(&self) -> Checked {
        positive([("time", self.time, Dimension::Time), ("velocity", self.velocity, Dimension::Velocity)])?;
        positive([("density", self.density, Dimension::Density), ("modulus", self.modulus, Dimension::Stress)])?;
        setup::check_replicates(self.replicates)?;
        member("velocity_error", self.velocity_error, Dimension::Velocity, Allowed::NotNegative)?;
        member("position_error", self.position_error, Dimension::Length, Allowed::NotNegative)?;
        optional("length", self.length, Dimension::Length, Allowed::Positive)?;
        optional("yield_stress", self.yield_stress, Dimension::Stress, Allowed::NotNegative)
    }
}

/// Inverted curve.
#[derive(Debug, Clone, Serialize)]
pub struct Inverted {
    /// Points of the curve, ordered by strain, from the yield point on.
    pub points: Vec<WavePoint>,
    /// Yield stress, Pa: as given, or from the impact velocity; `None` for a loaded wire for which it is not given.
    #[serde(rename = "yield_stress_Pa")]
    pub yield_stress: Option<Interval>,
    /// Whether the yield stress was determined from the impact velocity.
    pub yield_from_velocity: bool,
    /// Integral of c d eps up to the largest strain, m/s.
    pub velocity_integral_m_s: Interval,
    /// Impact velocity, m/s.
    pub impact_velocity_m_s: f64,
    /// Limitations of the result.
    pub warnings: Vec<String>,
}

/// Ratio of the strain at the far end of a profile to its standard error above which a wave has arrived there.
const FAR_NOISE: f64 = 4.0;

/// Fewest sections of a profile.
const FEWEST_SECTIONS: usize = 5;

const LEVELS: usize = 300;
const POINTS: usize = 40;

/// Fraction of the uniform strain near the end up to which levels are read.
const OFF_PLATEAU: f64 = 0.99;

impl Profile {
    /// Reads a profile from a CSV file with the columns `x` (distance from the struck end) and `strain` (or `plastic_strain`).
    ///
    /// # Errors
    /// An invalid file, or positions that do not increase.
    pub fn from_csv(path: &Path) -> Result<Self> {
        let of = |name: &str| if POSITION.contains(&name) { Dimension::Length } else { Dimension::None };
        let table = Table::read(path, |_, name| of(name))?;
        let distance = table.needed(POSITION)?.to_vec();
        let strain = table.needed_strains(&["strain", "plastic_strain", "residual_strain"])?.to_vec();
        if let Some(row) = turns_back(&distance, true) {
            return Err(table.error(row, "x does not increase from the row before").help("sort the rows by x").into());
        }
        Ok(Self::positive(distance, strain))
    }

    fn check(&self) -> Checked {
        let [distance, strain] = ["profile.distance", "profile.strain"];
        equally_long([(distance, self.distance.len()), (strain, self.strain.len())])?;
        finite(distance, self.distance.iter().copied())?;
        finite(strain, self.strain.iter().copied())?;
        if let Some(row) = turns_back(&self.distance, true) {
            let message = format!("row {row} (counted from 0) is not farther from the struck end than the row before");
            let error = InputError::new(message).key(distance);
            return Err(error.allowed("increasing distances").help("sort the rows by distance"));
        }
        if self.distance.len() < FEWEST_SECTIONS {
            let error = InputError::new(format!("the profile has {} sections", self.distance.len())).key("profile");
            let error = error.allowed(format!("at least {FEWEST_SECTIONS}"));
            return Err(error.help("measure the strain at more sections"));
        }
        Ok(())
    }

    fn positive(distance: Vec<f64>, mut strain: Vec<f64>) -> Self {
        let extreme = |sign: f64| strain.iter().fold(0.0_f64, |top, e| top.max(sign * e));
        let compressed = extreme(-1.0) > extreme(1.0);
        if compressed {
            for value in &mut strain {
                *value = -*value;
            }
        }
        Self { distance, strain, sense: if compressed { Sense::Compression } else { Sense::Tension } }
    }

    /// Adds normally distributed noise, whose standard deviation is the fraction `part` of the largest strain.
    #[must_use]
    pub fn with_noise(mut self, part: f64, seed: u64) -> Self {
        let mut rng = XorShiftRng::seed_from_u64(seed);
        let deviation = part * self.strain.iter().fold(0.0_f64, |top, e| top.max(e.abs()));
        self.strain.iter_mut().for_each(|e| *e += deviation * standard_normal(&mut rng));
        self
    }
}

const POSITION: &[&str] = &["x", "position", "distance"];

impl Test {
    /// Reads a test from a result file: from the frame nearest to `time` if it is given (loaded wire), otherwise from the last frame (released wire).
    ///
    /// # Errors
    /// A bar of several segments, missing fields, an end that is not released.
    pub fn from_result(file: &ResultFile, time: Option<f64>) -> Result<Self> {
        let segments = setup::segments(file)?;
        let wrong = |message: &str, help: &str| {
            InputError::new(format!("{}: {message}", file.path().display())).help(help.to_owned())
        };
        let [segment] = segments.as_slice() else {
            return Err(wrong("the bar has several segments", "use the result of one uniform bar").into());
        };
        let end = struck_end(file)?;
        let frames = file.time()?;
        let no_frame = || wrong("it has no frames", "run the scene again");
        let frame = match time {
            Some(time) => {
                (0..frames.len()).min_by(|&a, &b| (frames[a] - time).abs().total_cmp(&(frames[b] - time).abs()))
            }
            None => frames.len().checked_sub(1),
        }
        .ok_or_else(no_frame)?;
        let released = || {
            let help = "give `release` in the scene, or the time of the strain while the end still moves";
            end.released.ok_or_else(|| wrong("the end is not released before the run ends", help).key("time"))
        };
        let (time, state) = match time {
            Some(_) => (frames[frame], State::Loaded),
            None => (released()?, State::Released),
        };
        let strain = strains(file, segment, frame, state)?;
        let x = file.x()?;
        let (distance, strain) = match end.side {
            Side::Left => (x, strain),
            Side::Right => (x.iter().rev().map(|x| segment.length - x).collect(), strain.into_iter().rev().collect()),
        };
        let profile = Profile::positive(distance, strain);
        let knots = segment.curve(profile.sense == Sense::Compression);
        Ok(Self {
            profile,
            velocity: end.velocity,
            time,
            density: segment.density,
            modulus: segment.modulus,
            length: segment.length,
            given: Curve::new(&knots, Beyond::Error).ok(),
            notes: setup::outside_theory(file.metadata()),
        })
    }
}

/// The struck end: its side, its velocity, and the time at which its stress has decreased by half.
struct Struck {
    side: Side,
    velocity: f64,
    released: Option<f64>,
}

fn struck_end(file: &ResultFile) -> Result<Struck> {
    let ends = [(Side::Left, file.end(Side::Left)?), (Side::Right, file.end(Side::Right)?)];
    let peak = |values: &[f64]| values.iter().fold(0.0_f64, |top, s| top.max(s.abs()));
    let [left, right] = &ends;
    let (side, trace) = if peak(&left.1.stress) >= peak(&right.1.stress) { left } else { right };
    let half = 0.5 * peak(&trace.stress);
    let loaded = trace.stress.iter().position(|s| s.abs() >= half).unwrap_or(0);
    let released = trace.stress[loaded..].iter().position(|s| s.abs() < half).map(|row| trace.time[loaded + row]);
    let velocity = trace.velocity.get(loaded).map_or(0.0, |v| v.abs());
    Ok(Struck { side: *side, velocity, released })
}

/// Returns the total or the plastic strains of a frame.
fn strains(file: &ResultFile, segment: &Segment, frame: usize, state: State) -> Result<Vec<f64>> {
    let fields = file.fields();
    let row = |field: Field| -> Result<Vec<f64>> { Ok(file.field(field, frame..frame + 1)?.row(0).to_vec()) };
    let has = |field: Field| fields.contains(&field);
    match state {
        State::Loaded if has(Field::Strain) => row(Field::Strain),
        State::Released if has(Field::PlasticStrain) => row(Field::PlasticStrain),
        State::Released if has(Field::Strain) && has(Field::Stress) => {
            let stress = row(Field::Stress)?;
            Ok(row(Field::Strain)?.iter().zip(stress).map(|(e, s)| e - s / segment.modulus).collect())
        }
        _ => Err(InputError::new(format!("{} lacks the strain along the bar", file.path().display()))
            .help("record fields = [\"stress\", \"strain\"] or [\"plastic_strain\"], and run the scene again")
            .into()),
    }
}

/// Strain levels and their positions.
struct Fronts {
    /// Levels of the strain of the profile, increasing.
    level: Vec<f64>,
    /// Distances from the struck end, m; NaN if the profile does not reach the level.
    place: Vec<f64>,
    /// Strain at the far end of the profile, above which levels are found, and its position, m.
    far: [f64; 2],
    /// Half the step to which the strains are rounded; 0 if the noise averages out the rounding.
    half_step: f64,
}

/// State ahead of the lowest level of a profile, as `[strain, stress, velocity]`.
#[derive(Clone, Copy)]
struct Start {
    state: [f64; 3],
    /// Contribution of this state to the lower and upper bounds of the stresses and velocities.
    stress: [f64; 2],
    velocity: [f64; 2],
}

impl Start {
    /// Returns the state behind an elastic wave with this strain.
    fn elastic(strain: f64, options: &Options) -> Self {
        let c0 = (options.modulus / options.density).sqrt();
        Self { state: [strain, options.modulus * strain, c0 * strain], stress: [0.0; 2], velocity: [0.0; 2] }
    }

    /// Returns the state in a wire whose end still moves. If the yield stress is known, strains up to it propagate with the elastic wave. Otherwise
    /// the state is that of the strain at the far end of the profile. Its speed is at least the distance of the far end over the time and at most the
    /// elastic speed. Within these limits it makes up the part of the impact `velocity` that is not `explained` by the other strains.
    fn moving(fronts: &Fronts, options: &Options, velocity: f64, explained: f64) -> Self {
        if let Some(stress) = options.yield_stress {
            return Self::elastic(stress / options.modulus, options);
        }
        let c0 = (options.modulus / options.density).sqrt();
        let [strain, place] = fronts.far;
        let least = (place / options.time).min(c0);
        let speed = if strain > 0.0 { ((velocity - explained) / strain).clamp(least, c0) } else { least };
        // A rounded strain can also be 0, but not where the elastic wave has not arrived.
        let rounding = if least < c0 { fronts.half_step } else { 0.0 };
        let [low, high] = [(strain - rounding).max(0.0), strain + rounding];
        let [stress, velocity] = [options.density * speed * speed * strain, speed * strain];
        Self {
            state: [strain, stress, velocity],
            stress: [options.density * least * least * low - stress, options.density * c0 * c0 * high - stress],
            velocity: [least * low - velocity, c0 * high - velocity],
        }
    }

    /// Returns the strain above which the levels of a profile give their speeds.
    fn strain(fronts: &Fronts, options: &Options) -> f64 {
        options.yield_stress.map_or(fronts.far[0], |stress| stress / options.modulus)
    }
}

/// Inverts a profile.
///
/// # Errors
/// Numbers out of range, columns of different lengths, rows that are not finite, distances that do not increase, fewer than five sections; a profile
/// whose strain does not exceed its noise; plastic strains that explain more than the impact velocity.
pub fn invert(profile: &Profile, options: &Options) -> Result<Inverted> {
    options.check()?;
    profile.check()?;
    setup::on_the_bar(profile.distance.iter().copied(), options.length)?;
    // Towards the struck end the strain does not decrease.
    let place: Vec<f64> = profile.distance.iter().rev().copied().collect();
    let strain: Vec<f64> = profile.strain.iter().rev().copied().collect();
    let fit = non_decreasing(&strain, |_| 1.0);
    let noise = Noise::about(&strain, &fit);
    // The last level is below the plateau, on which its position would be undefined.
    let plateau = fit.last().map_or(0.0, |last| OFF_PLATEAU * (last - 3.0 * noise.rms()));
    if plateau <= 0.0 {
        let message = "no strain along the wire exceeds the noise";
        return Err(InputError::new(message).help("check the columns and their units").into());
    }
    let level: Vec<f64> = (1..=LEVELS).map(|i| plateau * (i as f64 / LEVELS as f64).powi(2)).collect();
    // The strain left at the far end of a released wire starts no curve.
    let loaded = options.state == State::Loaded;
    let [far, far_error] = if loaded { far_strain(&strain, &fit, &noise) } else { [0.0; 2] };
    let rounding = noise.rounding(&strain);
    let read = |fit: &[f64], shift: f64, far: f64| Fronts {
        half_step: 0.5 * rounding,
        level: level.clone(),
        far: [far, place[0] + shift],
        place: level.iter().map(|&e| first_reach(&place, fit, e).map_or(f64::NAN, |x| x + shift)).collect(),
    };
    let best = read(&fit, 0.0, far);
    let start = if loaded { Start::strain(&best, options) } else { 0.0 };
    let kept: Vec<usize> = (0..LEVELS).filter(|&i| best.place[i] > 0.0 && level[i] > start).collect();
    if kept.len() < 2 {
        let message = "the strain does not decrease along the profile";
        return Err(InputError::new(message).help("give the profile up to where the wire has not yielded").into());
    }
    let above = uniform_strain(profile, best.place[kept[kept.len() - 1]]).map_or(0.0, |e| (e - plateau).max(0.0));
    // The position of a strain is uncertain by half the distance between sections.
    let spacing = (place[0] - place[place.len() - 1]) / (place.len() - 1) as f64;
    let mut rng = XorShiftRng::seed_from_u64(options.seed);
    let found = evaluate(&best, &kept, above, options, options.velocity)?;
    let mut drawn = Vec::new();
    for _ in 0..options.replicates {
        let mut noisy = non_decreasing(&noise.replicate(&fit, &mut rng), |_| 1.0);
        let error = rounded(rounding, &mut rng);
        for strain in &mut noisy {
            *strain += error;
        }
        let section = 0.5 * spacing * (2.0 * rng.random::<f64>() - 1.0);
        let far = if far_error > 0.0 { far + far_error * standard_normal(&mut rng) } else { far };
        let far = far.clamp(0.0, level[kept[0]]);
        let fronts = read(&noisy, section + options.position_error * standard_normal(&mut rng), far);
        let fronts = Fronts { place: filled(&fronts.place, &best.place), ..fronts };
        let velocity = options.velocity + options.velocity_error * standard_normal(&mut rng);
        drawn.extend(evaluate(&fronts, &kept, above, options, velocity));
    }
    Ok(summary(&found, &drawn, options, &best))
}

/// Returns the strain at the far end of a profile and its standard error: the mean over the sections there whose strains differ by no more than noise.
/// Both are 0 if no wave has arrived there, that is if the mean does not exceed [`FAR_NOISE`] standard errors. The strains start at the far end; `fit` is
/// their non-decreasing fit, whose first values are too small.
fn far_strain(strain: &[f64], fit: &[f64], noise: &Noise) -> [f64; 2] {
    let mut level = fit[0] + FAR_NOISE * noise.rms();
    let mut found = [0.0; 2];
    // The second iteration leaves out sections that only the margin of the first one included.
    for _ in 0..2 {
        let alike = fit.partition_point(|&e| e <= level).max(1);
        found = [mean(&strain[..alike]), noise.error_of_mean(alike)];
        level = found[0] + noise.rms();
    }
    if found[0] > FAR_NOISE * found[1] { found } else { [0.0; 2] }
}

/// Returns the mean strain of the sections ahead of the position at which it decreases, or `None` for fewer than five sections.
fn uniform_strain(profile: &Profile, place: f64) -> Option<f64> {
    let near: Vec<f64> =
        profile.distance.iter().zip(&profile.strain).filter(|(x, _)| **x < 0.9 * place).map(|(_, e)| *e).collect();
    (near.len() >= 5).then(|| near.iter().sum::<f64>() / near.len() as f64)
}

/// Returns the positions of a replicate, with those of the profile in place of missing ones.
fn filled(places: &[f64], best: &[f64]) -> Vec<f64> {
    places.iter().zip(best).map(|(&x, &best)| if x > 0.0 { x } else { best }).collect()
}

/// Evaluation of one profile.
struct Evaluated {
    strain: Vec<f64>,
    curve: Integrated,
    yield_stress: f64,
    velocity: f64,
    start: Start,
}

fn evaluate(fronts: &Fronts, kept: &[usize], above: f64, options: &Options, velocity: f64) -> Result<Evaluated> {
    let c0 = (options.modulus / options.density).sqrt();
    let place = |i: &usize| fronts.place[*i];
    let level: Vec<f64> = kept.iter().map(|&i| fronts.level[i]).collect();
    if options.state == State::Loaded {
        let speed: Vec<f64> = kept.iter().map(|i| (place(i) / options.time).min(c0)).collect();
        let slowest = speed[speed.len() - 1];
        let from = [Start::strain(fronts, options), 0.0, 0.0];
        let mut curve = integrate(options.density, &level, speed, from, Some(c0));
        let explained = curve.velocity[level.len() - 1] + slowest * above;
        let start = Start::moving(fronts, options, velocity, explained);
        let [_, stress_before, velocity_before] = start.state;
        curve.stress.iter_mut().for_each(|stress| *stress += stress_before);
        curve.velocity.iter_mut().for_each(|velocity| *velocity += velocity_before);
        let velocity = explained + velocity_before;
        let yield_stress = options.yield_stress.unwrap_or(f64::NAN);
        return Ok(Evaluated { strain: level, curve, yield_stress, velocity, start });
    }
    let speed: Vec<f64> = kept.iter().map(|i| place(i) / (options.time + place(i) / c0)).collect();
    let slowest = speed[speed.len() - 1];
    let whole = whole_strains(&level, &speed, c0);
    let plastic = integrate(options.density, &whole, speed.clone(), [0.0; 3], None);
    let explained = plastic.velocity[level.len() - 1] + slowest * above;
    let yield_strain = match options.yield_stress {
        Some(stress) => stress / options.modulus,
        None => (velocity - explained) / c0,
    };
    if yield_strain <= 0.0 {
        let message =
            format!("the plastic strains explain {explained:.2} m/s, more than the impact velocity {velocity:.2} m/s");
        let help = "a wire with rho c0 V above the largest stress and twice the yield stress continues to yield after release: \
                    use the strains while the end moves; otherwise check velocity, duration, modulus and position of the end";
        return Err(InputError::new(message)
            .key("velocity")
            .allowed("less than the impact velocity")
            .help(help)
            .into());
    }
    let strain: Vec<f64> = whole.iter().map(|e| e + yield_strain).collect();
    let start = Start::elastic(yield_strain, options);
    let curve = integrate(options.density, &strain, speed, start.state, Some(c0));
    let velocity = curve.velocity[level.len() - 1] + slowest * above;
    Ok(Evaluated { strain, curve, yield_stress: options.modulus * yield_strain, velocity, start })
}

/// Returns the strains beyond yield from the plastic strains: d eps = d `eps_p`/(1 - (c/c0)^2).
fn whole_strains(plastic: &[f64], speed: &[f64], c0: f64) -> Vec<f64> {
    let (mut before, mut sum) = (0.0, 0.0);
    let add = |(&level, &c): (&f64, &f64)| {
        sum += (level - before) / (1.0 - (c / c0).powi(2));
        before = level;
        sum
    };
    plastic.iter().zip(speed).map(add).collect()
}

fn summary(found: &Evaluated, drawn: &[Evaluated], options: &Options, fronts: &Fronts) -> Inverted {
    let curves: Vec<Integrated> = drawn.iter().map(|evaluated| evaluated.curve.clone()).collect();
    let from_velocity = options.state == State::Released && options.yield_stress.is_none();
    let (between, yields) = between_levels(found, options, from_velocity);
    let all = points(&found.strain, &found.curve, &curves, &between, &vec![1; found.strain.len()], 1.0);
    let every = (all.len() / POINTS).max(1);
    let kept = all.iter().rev().step_by(every).rev().copied().collect();
    let interval = |of: fn(&Evaluated) -> f64| Interval::of_replicates(of(found), drawn.iter().map(of), 1.0);
    let top = between.velocity.len() - 1;
    let plateau = found.velocity - found.curve.velocity[top];
    let mut inverted = Inverted {
        points: kept,
        yield_stress: (!found.yield_stress.is_nan()).then(|| interval(|e| e.yield_stress).within(yields).magnitude()),
        yield_from_velocity: from_velocity,
        velocity_integral_m_s: interval(|e| e.velocity).within(between.velocity[top].map(|v| v + plateau)),
        impact_velocity_m_s: options.velocity,
        warnings: Vec::new(),
    };
    inverted.warnings.extend(velocity_warning(&inverted));
    inverted
        .warnings
        .extend(unknown_start(&all, "give the yield stress, or a profile that goes on to where nothing has come yet"));
    inverted.warnings.extend(reloading_warning(options, found));
    inverted.warnings.extend(reflection_warning(options, fronts));
    inverted
}

/// Returns bounds of the points and of the yield stress, which result from the unknown speeds between the levels. If the impact velocity determines
/// the yield stress, the velocity at the largest strain is fixed, and an error of the integral is compensated by the yield stress.
fn between_levels(found: &Evaluated, options: &Options, from_velocity: bool) -> (Bounds, [f64; 2]) {
    let c0 = (options.modulus / options.density).sqrt();
    let Start { state, stress, velocity } = found.start;
    let mut all = bounds(options.density, &found.strain, &found.curve.speed, state, Some(c0));
    let widen = |bounds: &mut [[f64; 2]], by: [f64; 2]| {
        for bound in bounds {
            *bound = [bound[0] + by[0], bound[1] + by[1]];
        }
    };
    widen(&mut all.stress, stress);
    widen(&mut all.velocity, velocity);
    if !from_velocity {
        return (all, [found.yield_stress; 2]);
    }
    let velocity = found.curve.velocity[found.strain.len() - 1];
    let top = all.velocity[found.strain.len() - 1];
    for v in &mut all.velocity {
        *v = [velocity - (top[1] - v[1]), velocity - (top[0] - v[0])];
    }
    let impedance = options.density * c0;
    let open = [impedance * (velocity - top[1]), impedance * (velocity - top[0])];
    for stress in &mut all.stress {
        *stress = [stress[0] + open[0], stress[1] + open[1]];
    }
    (all, open.map(|open| found.yield_stress + open))
}

/// Largest relative difference between the integral and the impact velocity for which no warning is given. A difference within the interval gives
/// none either.
const VELOCITY_TOLERANCE: f64 = 0.03;

fn velocity_warning(inverted: &Inverted) -> Option<String> {
    let (integral, velocity) = (inverted.velocity_integral_m_s, inverted.impact_velocity_m_s);
    let outside = !(integral.low..=integral.high).contains(&velocity);
    let matters = outside && (integral.value - velocity).abs() > VELOCITY_TOLERANCE * velocity;
    (matters && !inverted.yield_from_velocity).then(|| {
        format!(
            "the wave speeds integrate to {:.2} m/s, and the impact velocity is {velocity:.2} m/s: the stresses are not reliable",
            integral.value
        )
    })
}

/// Returns a warning if the wire yields again behind the release wave. With the impedance z = rho c0, this elastic wave carries sigma - z v = z V -
/// `sigma_max` from the free end and meets sigma + z v, where v is the velocity towards the part of the wire at rest. It leaves half the sum as
/// stress.
fn reloading_warning(options: &Options, found: &Evaluated) -> Option<String> {
    if options.state == State::Loaded {
        return None;
    }
    let z = (options.modulus * options.density).sqrt();
    let largest = found.curve.stress.last().copied().unwrap_or(0.0);
    let from_end = z * options.velocity - largest;
    let left = |i: usize| 0.5 * (found.curve.stress[i] - z * found.curve.velocity[i] + from_end);
    let reloaded = (0..found.strain.len()).rev().find(|&i| left(i) > found.curve.stress[i])?;
    Some(format!(
        "the wire yields again behind the release wave at strains below {:.4}: their speeds are too large: use the strain \
         while the end moves",
        found.strain[reloaded]
    ))
}

/// Returns a warning if levels were still propagating when the reflected elastic wave met them.
fn reflection_warning(options: &Options, fronts: &Fronts) -> Option<String> {
    let Some(length) = options.length else {
        return Some("not checked: the wave reflected from the far end (needs the length)".to_owned());
    };
    let c0 = (options.modulus / options.density).sqrt();
    let met = match options.state {
        State::Loaded => 2.0 * length - c0 * options.time,
        State::Released => length - 0.5 * c0 * options.time,
    };
    let late = (0..fronts.level.len()).rev().find(|&i| fronts.place[i] > met)?;
    let (level, met) = (fronts.level[late], met.max(0.0));
    Some(format!(
        "the wave reflected from the far end has passed x > {met:.4} m: strains below {level:.2e} may have changed there"
    ))
}
