//! Stress-strain curve from the arrival times of strain levels at gauges.
//!
//! In a simple wave that enters a bar at rest, each strain propagates at its own constant speed c(eps), so it passes the distance x at t = t0(eps) +
//! x/c(eps). The slope of the line through its arrivals gives c, and sigma = rho integral c^2 d eps. The loading need not be known, except that it
//! does not decrease. Shocks have the speed of their chord, so the result is the concave hull of the curve. Th. von Kármán, P. Duwez, J. Appl. Phys.
//! 21, 1950; N. Cristescu, Dynamic Plasticity, 1967.
//!
//! The method is not valid after reflected waves have arrived, or if the stress depends on the strain rate.

use std::path::Path;

use rand::{RngExt, SeedableRng};
use rand_xorshift::XorShiftRng;
use serde::Serialize;

use super::bands::{HALF_95, deviation};
use super::curve::{Integrated, WavePoint, bounds, integrate, points, unknown_start};
use super::isotonic::{first_reach, non_decreasing};
use super::noise::{Noise, rounded};
use super::records::{Record, Recording};
use super::setup::{self, REPLICATES, SEED};
use super::table::Table;
use super::zero::Zeroed;
use crate::error::{InputError, Result};
use crate::input::{Allowed, Checked, member, optional, positive};
use crate::material::Sense;
use crate::study::random::standard_normal;
use crate::units::Dimension;

/// Known data besides the arrivals, and settings of the inversion. The density must be given: its default is NaN, which is refused.
#[derive(Debug, Clone)]
pub struct Options {
    /// Density, kg/m^3.
    pub density: f64,
    /// Elastic modulus, Pa. If it is known, no speed exceeds the elastic one.
    pub modulus: Option<f64>,
    /// Distance from the loaded end to the origin of the first reflection, m.
    pub length: Option<f64>,
    /// Time at which the loading starts, s.
    pub start: f64,
    /// Whether the loading is sudden: all strains start at the loaded end at `start`.
    pub centred: bool,
    /// Standard error of the gauge positions, m.
    pub position_error: f64,
    /// Standard error of single arrival times, s; if `None`, it is estimated from their scatter.
    pub time_error: Option<f64>,
    /// Number of bootstrap replicates, 20 to 100 000.
    pub replicates: usize,
    /// Seed of the random numbers.
    pub seed: u64,
}

impl Default for Options {
    fn default() -> Self {
        Self {
            density: f64::NAN,
            modulus: None,
            length: None,
            start: 0.0,
            centred: false,
            position_error: 0.0,
            time_error: None,
            replicates: REPLICATES,
            seed: SEED,
        }
    }
}

impl Options {
    fn check(&self) -> Checked {
        positive([("density", self.density, Dimension::Density)])?;
        setup::check_replicates(self.replicates)?;
        optional("modulus", self.modulus, Dimension::Stress, Allowed::Positive)?;
        optional("length", self.length, Dimension::Length, Allowed::Positive)?;
        member("start", self.start, Dimension::Time, Allowed::Finite)?;
        member("position_error", self.position_error, Dimension::Length, Allowed::NotNegative)?;
        optional("time_error", self.time_error, Dimension::Time, Allowed::Positive)
    }
}

/// Inverted curve.
#[derive(Debug, Clone, Serialize)]
pub struct Inverted {
    /// Points of the curve, ordered by strain.
    pub points: Vec<WavePoint>,
    /// Distances of the gauges from the loaded end, m.
    #[serde(rename = "distances_m")]
    pub distances: Vec<f64>,
    /// Deviation of the arrivals from straight characteristics, relative to their times; `None` if no level has more than two gauges.
    pub curvature: Option<f64>,
    /// Deviation relative to the noise: about 1 in a simple wave. If it is larger than 1, the intervals are widened by this factor.
    pub misfit: Option<f64>,
    /// Zero offsets of the gauges, ordered by distance: the mean strain before the wave, or 0 if it does not exceed three standard errors and is not
    /// removed. `None` if they are unknown.
    pub zero_offsets: Option<Vec<f64>>,
    /// Limitations of the result.
    pub warnings: Vec<String>,
}

/// Number of strain levels at which records are read, and the exponent of their spacing. The spacing is fine at small strains, because at the elastic
/// limit, where the speed jumps, the stress has an error of half a strain step times the modulus.
const LEVELS: usize = 1000;
const SPACING: i32 = 3;

/// Number of points of the result.
const POINTS: usize = 40;

/// Misfit and relative deviation that must both be exceeded before the characteristics count as curved. A grid smears fronts by less than `BENT` of
/// their times.
const CURVED: f64 = 3.0;
const BENT: f64 = 0.02;

/// Arrival times: one column per gauge (or repeat) and one row per level; NaN if there is no arrival.
#[derive(Debug, Clone)]
struct Arrivals {
    distance: Vec<f64>,
    level: Vec<f64>,
    time: Vec<Vec<f64>>,
}

/// Inverts the records of gauges.
///
/// # Errors
/// Numbers out of range, columns of different lengths, rows that are not finite; too few gauges, no strain level that two gauges record before the
/// first reflection, contradictory positions and times.
pub fn of_records(recording: &Recording, options: &Options) -> Result<Inverted> {
    options.check()?;
    recording.check()?;
    let mut warnings = recording.notes.clone();
    enough_gauges(recording.records.iter().map(|r| r.distance), options)?;
    let zero = zeroed(recording, options, &mut warnings);
    let records = before_reflection(&zero.records, options, &mut warnings);
    let fits: Vec<Vec<f64>> = records.iter().map(|r| non_decreasing(&r.strain, |_| 1.0)).collect();
    let noise: Vec<Noise> = records.iter().zip(&fits).map(|(r, fit)| Noise::about(&r.strain, fit)).collect();
    // At its end the fit exceeds the strain by the noise.
    let top = |(fit, noise): (&Vec<f64>, &Noise)| fit.last().map_or(0.0, |last| last - 3.0 * noise.rms());
    let tops: Vec<f64> = fits.iter().zip(&noise).map(top).collect();
    let levels = levels(&tops, options)?;
    let column = |((record, fit), &top): ((&Record, &Vec<f64>), &f64)| -> Vec<f64> {
        let reached = |&level: &f64| first_reach(&record.time, fit, level).filter(|_| level <= top);
        levels.iter().map(|level| reached(level).unwrap_or(f64::NAN)).collect()
    };
    let read = |fits: &[Vec<f64>]| Arrivals {
        distance: records.iter().map(|r| r.distance).collect(),
        level: levels.clone(),
        time: records.iter().zip(fits).zip(&tops).map(column).collect(),
    };
    let rounding: Vec<f64> = noise.iter().zip(&records).map(|(noise, record)| noise.rounding(&record.strain)).collect();
    let errors: Vec<(f64, f64)> = zero.errors.iter().copied().zip(rounding).collect();
    let mut rng = XorShiftRng::seed_from_u64(options.seed);
    let mut replicate = |_| {
        let noisy = noise.iter().zip(&fits).zip(&errors).map(|((n, fit), &(error, rounding))| {
            let mut drawn = n.replicate(fit, &mut rng);
            let offset = if error > 0.0 { error * standard_normal(&mut rng) } else { 0.0 };
            let offset = offset + rounded(rounding, &mut rng);
            for strain in &mut drawn {
                *strain += offset;
            }
            non_decreasing(&drawn, |_| 1.0)
        });
        let noisy: Vec<Vec<f64>> = noisy.collect();
        displaced(read(&noisy), |k| sampling(&records[k]), options.position_error, &mut rng)
    };
    let replicates: Vec<Arrivals> = (0..options.replicates).map(&mut replicate).collect();
    let mut inverted = invert(&read(&fits), &replicates, options, warnings)?;
    inverted.zero_offsets = zero.offsets;
    let kept = |(i, _): &(usize, WavePoint)| (i + 1) % (LEVELS / POINTS) == 0;
    inverted.points = inverted.points.into_iter().enumerate().filter(kept).map(|(_, point)| point).collect();
    Ok(inverted)
}

/// Inverts a table of arrivals with the columns `x` (distance from the loaded end), `strain` (the level) and `time`.
///
/// # Errors
/// As for [`of_records`]; an arrival later than the first reflection; arrivals without scatter if no error of the times is given.
pub fn of_table(path: &Path, options: &Options) -> Result<Inverted> {
    options.check()?;
    let mut warnings = Vec::new();
    let (arrivals, table) = read_table(path)?;
    enough_gauges(arrivals.distance.iter().copied(), options)?;
    not_after_reflection(&table, options, &mut warnings)?;
    if options.modulus.is_none() {
        let what = "stress and velocity have no upper bound: the speed below the first level is not known";
        warnings.push(format!("{what} (needs the modulus)"));
    }
    let columns = arrivals.distance.len();
    let weights = vec![vec![1.0; arrivals.level.len()]; columns];
    let error = match options.time_error {
        Some(error) => error,
        None => pooled_scatter(&lines(&arrivals, &weights, options)).ok_or_else(|| {
            InputError::new("the scatter of the arrivals is unknown: each level has one arrival at each gauge")
                .key("time_error")
                .help("give the standard error of an arrival time, or repeats")
        })?,
    };
    let mut rng = XorShiftRng::seed_from_u64(options.seed);
    let mut replicate = |_| {
        let mut noisy = arrivals.clone();
        noisy.time.iter_mut().flatten().for_each(|t| *t += error * standard_normal(&mut rng));
        displaced(noisy, |_| 0.0, options.position_error, &mut rng)
    };
    let replicates: Vec<Arrivals> = (0..options.replicates).map(&mut replicate).collect();
    invert(&arrivals, &replicates, options, warnings)
}

/// Fewest samples before the wave for which the mean is a zero offset, and the number of standard errors that it must exceed to be removed.
const FEWEST_QUIET: usize = 5;
const OFFSET: f64 = 3.0;

/// Records without their zero offsets.
struct Zero {
    records: Vec<Record>,
    /// Standard errors of the removed offsets; 0 if none was removed.
    errors: Vec<f64>,
    /// Offsets as recorded; `None` if a record is too short before the wave, or was simulated.
    offsets: Option<Vec<f64>>,
}

/// Removes the mean strain that gauges record before the elastic wave can arrive, or before the loading starts if the modulus is not known.
fn zeroed(recording: &Recording, options: &Options, warnings: &mut Vec<String>) -> Zero {
    let mut zero =
        Zero { records: recording.records.clone(), errors: vec![0.0; recording.records.len()], offsets: None };
    if recording.simulated {
        return zero;
    }
    let slowness = options.modulus.map_or(0.0, |modulus| (options.density / modulus).sqrt());
    let quiet = |r: &Record| Zeroed::until(&r.time, &r.strain, options.start + slowness * r.distance);
    let found: Vec<Zeroed> = recording.records.iter().map(quiet).collect();
    if let Some(k) = found.iter().position(|zeroed| zeroed.samples < FEWEST_QUIET) {
        let needs = if options.modulus.is_some() { "samples" } else { "the modulus, or samples" };
        let name = &recording.records[k].name;
        warnings.push(format!("not checked: zero offset of {name} (needs {needs} before the wave arrives)"));
    }
    let matters = |z: &Zeroed| z.samples >= FEWEST_QUIET && z.offset.abs() > OFFSET * z.offset_error;
    let sign = if recording.sense == Sense::Compression { -1.0 } else { 1.0 };
    let known = found.iter().all(|zeroed| zeroed.samples >= FEWEST_QUIET);
    zero.offsets = known.then(|| found.iter().map(|z| if matters(z) { sign * z.offset } else { 0.0 }).collect());
    for ((record, error), zeroed) in zero.records.iter_mut().zip(&mut zero.errors).zip(found) {
        if matters(&zeroed) {
            (record.strain, *error) = (zeroed.record.1, zeroed.offset_error);
        }
    }
    zero
}

fn enough_gauges(distances: impl Iterator<Item = f64>, options: &Options) -> Result<()> {
    let mut distances: Vec<f64> = distances.collect();
    setup::on_the_bar(distances.iter().copied(), options.length)?;
    distances.sort_by(f64::total_cmp);
    distances.dedup();
    let needed = if options.centred { 1 } else { 2 };
    if distances.len() >= needed && distances.first().is_none_or(|&x| x > 0.0 || !options.centred) {
        return Ok(());
    }
    let message = match distances.len() {
        1 => "all gauges are at one position".to_owned(),
        count => format!("the gauges are at {count} different positions"),
    };
    let help = "add a gauge; with a sudden loading from a known start on (centred) one is enough, away from the end";
    Err(InputError::new(message)
        .key("centred")
        .allowed(format!("at least {needed}, at positive distances"))
        .help(help)
        .into())
}

/// Returns the arrival time, as a function of the distance, of the elastic wave reflected at the far end, or `None` if the length or the modulus is
/// not known.
fn reflection(options: &Options, warnings: &mut Vec<String>) -> Option<impl Fn(f64) -> f64 + use<>> {
    if let (Some(length), Some(modulus)) = (options.length, options.modulus) {
        let (start, c0) = (options.start, (modulus / options.density).sqrt());
        return Some(move |distance: f64| start + (2.0 * length - distance) / c0);
    }
    warnings.push("not checked: reflections from the far end (needs the length and the modulus)".to_owned());
    None
}

/// Returns the records up to the arrival of the reflected wave.
fn before_reflection(records: &[Record], options: &Options, warnings: &mut Vec<String>) -> Vec<Record> {
    let Some(arrival) = reflection(options, warnings) else { return records.to_vec() };
    let mut left_out = Vec::new();
    let mut cut = |record: &Record| {
        let until = arrival(record.distance);
        let keep = record.time.partition_point(|&t| t < until);
        if keep < record.time.len() {
            left_out.push(format!("{} after {:.1} us", record.name, 1e6 * until));
        }
        let mut shorter = record.clone();
        shorter.time.truncate(keep);
        shorter.strain.truncate(keep);
        shorter
    };
    let records = records.iter().map(&mut cut).collect();
    if !left_out.is_empty() {
        let what = "left out, since the wave reflected from the far end has arrived:";
        warnings.push(format!("{what} {}", left_out.join(", ")));
    }
    records
}

fn not_after_reflection(table: &Table, options: &Options, warnings: &mut Vec<String>) -> Result<()> {
    let Some(arrival) = reflection(options, warnings) else { return Ok(()) };
    let (x, time) = (table.needed(POSITION)?, table.needed(TIME)?);
    let Some(row) = (0..x.len()).find(|&row| time[row] >= arrival(x[row])) else { return Ok(()) };
    let message = format!("arrival at {:.6e} s, after the wave reflected from the far end", time[row]);
    let allowed = format!("t < {:.6e} s at x = {} m", arrival(x[row]), x[row]);
    Err(table.error(row, message).allowed(allowed).help("leave out later arrivals, or use a longer bar").into())
}

/// Returns strain levels up to the largest strain that enough gauges record. They are denser at small strains, where the speed changes most.
fn levels(tops: &[f64], options: &Options) -> Result<Vec<f64>> {
    let mut tops = tops.to_vec();
    tops.sort_by(|a, b| b.total_cmp(a));
    let top = tops[usize::from(!options.centred)];
    if top <= 0.0 || !top.is_finite() {
        let message = "no strain level arrives at two gauges before the reflected wave, or above the noise";
        let help = "check the start and the length, use a longer bar, or put the gauges nearer to the loaded end";
        return Err(InputError::new(message).help(help).into());
    }
    Ok((1..=LEVELS).map(|i| top * (i as f64 / LEVELS as f64).powi(SPACING)).collect())
}

/// Returns half the mean sampling interval, s, as the uncertainty of an arrival time. Records with jumps (two samples at one time) give arrivals
/// exactly, so their value is 0.
fn sampling(record: &Record) -> f64 {
    if record.time.windows(2).any(|pair| pair[0] == pair[1]) {
        return 0.0;
    }
    let (first, last) = (record.time.first(), record.time.last());
    0.5 * first.zip(last).map_or(0.0, |(a, b)| (b - a) / record.time.len() as f64)
}

/// Shifts the positions and the clocks of the gauges by random errors.
fn displaced(mut arrivals: Arrivals, clock: impl Fn(usize) -> f64, position: f64, rng: &mut XorShiftRng) -> Arrivals {
    for (k, column) in arrivals.time.iter_mut().enumerate() {
        arrivals.distance[k] += position * standard_normal(rng);
        let shift = clock(k) * (2.0 * rng.random::<f64>() - 1.0);
        for time in column {
            *time += shift;
        }
    }
    arrivals
}

const POSITION: &[&str] = &["x", "position", "distance"];
const TIME: &[&str] = &["time", "t", "arrival"];

fn read_table(path: &Path) -> Result<(Arrivals, Table)> {
    let table = Table::read(path, |_, name| match name {
        name if POSITION.contains(&name) => Dimension::Length,
        name if TIME.contains(&name) => Dimension::Time,
        _ => Dimension::None,
    })?;
    let (x, strain, time) = (table.needed(POSITION)?, table.needed_strains(&["strain", "level"])?, table.needed(TIME)?);
    if let Some(row) = strain.iter().position(|&e| e == 0.0) {
        return Err(table.error(row, "a strain level of zero has no arrival").allowed("strain > 0").into());
    }
    let mut level: Vec<f64> = strain.iter().map(|e| e.abs()).collect();
    level.sort_by(f64::total_cmp);
    level.dedup();
    // Repeated arrivals at one position have separate columns.
    let (mut distance, mut columns) = (Vec::new(), Vec::<Vec<f64>>::new());
    for row in 0..x.len() {
        let at = level.partition_point(|&e| e < strain[row].abs());
        let free = (0..columns.len()).find(|&k| distance[k] == x[row] && columns[k][at].is_nan());
        let column = free.unwrap_or_else(|| {
            distance.push(x[row]);
            columns.push(vec![f64::NAN; level.len()]);
            columns.len() - 1
        });
        columns[column][at] = time[row];
    }
    Ok((Arrivals { distance, level, time: columns }, table))
}

/// Slownesses 1/c of the levels, s/m, the distances of their arrivals from the fitted lines, s, and the number of gauges per level. NaN if a level
/// has fewer gauges than a line needs.
struct Lines {
    slowness: Vec<f64>,
    residual: Vec<Vec<f64>>,
    gauges: Vec<usize>,
}

#[expect(clippy::needless_range_loop, reason = "a level is a column of several tables")]
/// Fits lines t = t0 + x/c to the arrivals of each level by weighted least squares. For a centred wave t0 is the start.
fn lines(arrivals: &Arrivals, weights: &[Vec<f64>], options: &Options) -> Lines {
    let count = arrivals.level.len();
    let mut all = Lines { slowness: vec![f64::NAN; count], residual: Vec::new(), gauges: vec![0; count] };
    all.residual = vec![vec![f64::NAN; count]; arrivals.distance.len()];
    for i in 0..count {
        let seen: Vec<usize> = (0..arrivals.distance.len()).filter(|&k| arrivals.time[k][i].is_finite()).collect();
        let mean = |of: &dyn Fn(usize) -> f64| {
            let sum: f64 = seen.iter().map(|&k| weights[k][i]).sum();
            seen.iter().map(|&k| weights[k][i] * of(k)).sum::<f64>() / sum
        };
        let (x, t) = (|k: usize| arrivals.distance[k], |k: usize| arrivals.time[k][i]);
        let centre = if options.centred { (0.0, options.start) } else { (mean(&x), mean(&t)) };
        let slowness = mean(&|k| (x(k) - centre.0) * (t(k) - centre.1)) / mean(&|k| (x(k) - centre.0).powi(2));
        all.gauges[i] = seen.len();
        if slowness.is_finite() {
            all.slowness[i] = slowness;
            for &k in &seen {
                all.residual[k][i] = t(k) - centre.1 - slowness * (x(k) - centre.0);
            }
        }
    }
    all
}

/// Returns the standard deviation of the arrivals about all lines, s, or `None` without degrees of freedom.
fn pooled_scatter(lines: &Lines) -> Option<f64> {
    let squares: f64 = lines.residual.iter().flatten().filter(|r| r.is_finite()).map(|r| r * r).sum();
    let freedom: usize = lines.gauges.iter().map(|n| n.saturating_sub(2)).sum();
    (freedom > 0).then(|| (squares / freedom as f64).sqrt())
}

/// Returns the reciprocal variance of each arrival among the replicates.
fn weights(replicates: &[Arrivals], best: &Arrivals) -> Vec<Vec<f64>> {
    let columns = 0..best.distance.len();
    let at = |k: usize, i: usize| deviation(replicates.iter().map(move |replicate| replicate.time[k][i]));
    let all: Vec<Vec<f64>> = columns.map(|k| (0..best.level.len()).map(|i| at(k, i)).collect()).collect();
    // If nothing varies, all weights are equal.
    let largest = all.iter().flatten().fold(0.0_f64, |a, b| a.max(*b));
    let floor = if largest > 0.0 { 1e-3 * largest } else { 1.0 };
    all.iter().map(|column| column.iter().map(|d| (d * d + floor * floor).recip()).collect()).collect()
}

fn invert(arrivals: &Arrivals, replicates: &[Arrivals], options: &Options, warnings: Vec<String>) -> Result<Inverted> {
    let weights = weights(replicates, arrivals);
    let found = lines(arrivals, &weights, options);
    not_backwards(arrivals, &found)?;
    let drawn: Vec<Lines> = replicates.iter().map(|replicate| lines(replicate, &weights, options)).collect();
    let spread = |i: usize| deviation(drawn.iter().map(|lines| lines.slowness[i]));
    let spread: Vec<f64> = (0..arrivals.level.len()).map(spread).collect();
    let kept: Vec<usize> = (0..arrivals.level.len()).filter(|&i| found.slowness[i].is_finite()).collect();
    let strain: Vec<f64> = kept.iter().map(|&i| arrivals.level[i]).collect();
    let c0 = options.modulus.map(|modulus| (modulus / options.density).sqrt());
    let misfit = misfit(arrivals, &found, &weights);
    let widened = misfit.unwrap_or(1.0).max(1.0);
    let smallest = spread.iter().fold(0.0_f64, |a, b| a.max(*b)) * 1e-3 + f64::MIN_POSITIVE.sqrt();
    let curve = |lines: &Lines| -> Integrated {
        // A replicate without a level uses the slowness of the estimate.
        let known = |&i: &usize| if lines.slowness[i].is_finite() { lines.slowness[i] } else { found.slowness[i] };
        let slowness: Vec<f64> = kept.iter().map(known).collect();
        // Behind a front, no strain level is faster than the front.
        let monotone = non_decreasing(&slowness, |j| (spread[kept[j]].powi(2) + smallest.powi(2)).recip());
        let speed = with_elastic_part(&monotone, |j| HALF_95 * widened * spread[kept[j]], c0);
        integrate(options.density, &strain, speed, [0.0; 3], c0)
    };
    let replicates: Vec<Integrated> = drawn.iter().map(curve).collect();
    let gauges: Vec<usize> = kept.iter().map(|&i| found.gauges[i]).collect();
    let best = curve(&found);
    let bounds = bounds(options.density, &strain, &best.speed, [0.0; 3], c0);
    let points = points(&strain, &best, &replicates, &bounds, &gauges, widened);
    let curvature = curvature(arrivals, &found, options);
    let curved = misfit.zip(curvature).filter(|&(misfit, curvature)| misfit > CURVED && curvature > BENT);
    let warnings = warnings.into_iter().chain(curved.map(|(misfit, curvature)| {
        format!(
            "the arrivals deviate from straight characteristics by {:.1} % of their times, {misfit:.1} times their noise: a \
             rate-dependent material, reflections, an unloading end or wrong positions",
            100.0 * curvature
        )
    }));
    let unknown = unknown_start(&points, "give levels at and below the elastic limit");
    let warnings = warnings.chain(unknown).collect();
    Ok(Inverted { points, distances: arrivals.distance.clone(), curvature, misfit, zero_offsets: None, warnings })
}

/// Returns the speeds of increasing slownesses, limited to the elastic speed `c0` if it is known. The first levels have this speed as long as their
/// own agrees with it within `error`. Noise delays the arrivals of levels near the elastic limit. Because no speed can exceed `c0`, these errors
/// would not average out.
fn with_elastic_part(slowness: &[f64], error: impl Fn(usize) -> f64, c0: Option<f64>) -> Vec<f64> {
    let Some(c0) = c0 else { return slowness.iter().map(|s| s.max(f64::MIN_POSITIVE).recip()).collect() };
    let elastic = slowness.iter().enumerate().take_while(|(j, s)| **s <= c0.recip() + error(*j)).count();
    let speed = |(j, s): (usize, &f64)| if j < elastic { c0 } else { s.max(c0.recip()).recip() };
    slowness.iter().enumerate().map(speed).collect()
}

/// Refuses arrivals if more than half of the levels arrive earlier at larger distances.
fn not_backwards(arrivals: &Arrivals, lines: &Lines) -> Result<()> {
    let wrong = |&i: &usize| lines.slowness[i] <= 0.0;
    let seen = lines.slowness.iter().filter(|s| s.is_finite()).count();
    let failed = (0..arrivals.level.len()).filter(wrong).count();
    if seen > 0 && 2 * failed <= seen {
        return Ok(());
    }
    let message = format!("{failed} of {seen} strain levels arrive at the farther gauges first");
    let help = "give positions as distances from the loaded end, and check their order and units";
    Err(InputError::new(message).help(help).into())
}

/// Returns the median over the levels of the root mean square distance of the arrivals from their line, relative to their noise (Birge's ratio, R. T.
/// Birge, Phys. Rev. 40, 1932). `None` if no level has more than two gauges.
fn misfit(arrivals: &Arrivals, lines: &Lines, weights: &[Vec<f64>]) -> Option<f64> {
    let weighted = |i: usize, k: usize| weights[k][i] * lines.residual[k][i].powi(2);
    median_of_levels(arrivals, lines, weighted)
}

/// Returns the median over the levels of the root mean square distance of the arrivals from their line, relative to the time since the start of the
/// loading.
fn curvature(arrivals: &Arrivals, lines: &Lines, options: &Options) -> Option<f64> {
    let relative = |i: usize, k: usize| (lines.residual[k][i] / (arrivals.time[k][i] - options.start)).powi(2);
    median_of_levels(arrivals, lines, relative)
}

/// Returns the median over the levels of the root of the sum of `square` over the degrees of freedom.
fn median_of_levels(arrivals: &Arrivals, lines: &Lines, square: impl Fn(usize, usize) -> f64) -> Option<f64> {
    let of_level = |i: usize| {
        let sum: f64 = (0..arrivals.distance.len()).map(|k| square(i, k)).filter(|s| s.is_finite()).sum();
        (sum / (lines.gauges[i] - 2) as f64).sqrt()
    };
    let levels = (0..arrivals.level.len()).filter(|&i| lines.gauges[i] > 2);
    let mut all: Vec<f64> = levels.map(of_level).filter(|value| value.is_finite()).collect();
    all.sort_by(f64::total_cmp);
    all.get(all.len() / 2).copied()
}
