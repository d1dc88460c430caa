//! Panel of the field along the bar at several times.

use super::axis::Axis;
use super::colour::{ColourMap, hex};
use super::drawing::{Stroke, THEORY};
use super::panel::{LinePanel, Series};
use super::view::{View, nearest};
use crate::error::Result;
use crate::record::{Field, FrontRow};

/// Number of profiles in the panel; the last one is at the end time.
const PROFILES: usize = 5;
/// Number of levels behind the fronts above which they are not drawn, since they would merge into a grey band.
const MOST_LEVELS: usize = 10;
/// Number of frames from which the profiles are chosen, and largest number of positions at which they are compared.
const CANDIDATES: usize = 60;
const PLACES: usize = 2000;

/// Returns the line style of the i-th of `count` times, from dark to light.
pub(super) fn stroke(number: usize, count: usize) -> Stroke {
    let place = 0.82 * number as f64 / (count.max(2) - 1) as f64;
    Stroke::new(hex(ColourMap::Sequential.at(place)), 1.7)
}

/// Returns the field against x at several times, with the theoretical levels behind the fronts if the field is stress or strain.
pub(super) fn profiles(view: &View) -> Result<Option<LinePanel>> {
    let (time, length, unit) = (view.time_unit(), view.length_unit(), view.field_unit());
    let indices = snapshots(view)?;
    let first = indices.first().map_or(0.0, |&index| view.time[index]);
    // A front that met other waves before the first profile has no level in it.
    let under_way: Vec<_> = view.theory_fronts()?.into_iter().filter(|front| front.last_seen >= first).collect();
    let mut series = levels(view, &under_way);
    let mut limits = Vec::new();
    for (number, &index) in indices.iter().enumerate() {
        let values = view.file.field(view.field, index..index + 1)?;
        let points = view.x.iter().zip(values.row(0)).map(|(x, v)| (x * length.factor, v * unit.factor));
        let line = Series::line(time.brief(view.time[index]), points.collect(), stroke(number, indices.len()));
        limits.extend(view.limits(&line.points));
        series.push(line);
    }
    let name = view.field_name();
    let levels = series.iter().take(series.len() - indices.len()).flat_map(|s| s.points.iter().map(|p| p.1));
    let y = Axis::around(unit.label(name), limits.into_iter().chain(levels).chain(View::zero(view.field)));
    let x = Axis::new(length.label("position x"), 0.0, view.length * length.factor);
    let mut panel = LinePanel { heading: format!("{name} along the bar"), x, y, series };
    panel.mark("rupture", &view.ruptures.iter().map(|r| r.x * length.factor).collect::<Vec<_>>());
    Ok(Some(panel))
}

fn levels(view: &View, fronts: &[FrontRow]) -> Vec<Series> {
    let level = |front: &FrontRow| match view.field {
        Field::Stress => Some(front.stress_behind),
        Field::Strain => Some(front.strain_behind),
        _ => None,
    };
    let mut values: Vec<f64> = fronts.iter().filter_map(level).filter(|v| v.is_finite()).collect();
    values.sort_by(f64::total_cmp);
    values.dedup();
    if values.is_empty() || values.len() > MOST_LEVELS {
        return Vec::new();
    }
    let (factor, end) = (view.field_unit().factor, view.length * view.length_unit().factor);
    let points = values.iter().flat_map(|v| [(0.0, v * factor), (end, v * factor), (end, f64::NAN)]).collect();
    let name = format!("{}, behind each front at its start", view.theory());
    vec![Series::line(name, points, Stroke::new(THEORY, 1.1).dashed("2 3"))]
}

/// Returns the frames to draw: evenly spaced in time, unless profiles at these times look alike because of a period of the bar.
fn snapshots(view: &View) -> Result<Vec<usize>> {
    let evenly = |count: usize| -> Vec<usize> {
        let mut frames: Vec<usize> =
            (1..=count).map(|i| nearest(&view.time, view.end_time * i as f64 / count as f64)).collect();
        frames.dedup();
        frames
    };
    let (even, candidates) = (evenly(PROFILES), evenly(CANDIDATES));
    if even.len() < PROFILES {
        return Ok(even);
    }
    let step = view.x.len().div_ceil(PLACES);
    let mut profiles = Vec::with_capacity(candidates.len());
    for &frame in &candidates {
        profiles.push(view.file.field(view.field, frame..frame + 1)?.iter().step_by(step).copied().collect());
    }
    // Each of them is a candidate, since CANDIDATES is a multiple of PROFILES.
    let even: Vec<usize> = even.iter().filter_map(|frame| candidates.iter().position(|c| c == frame)).collect();
    Ok(distinct(&profiles, even).into_iter().map(|i| candidates[i]).collect())
}

/// Returns the preferred profiles, or, if two of them look alike, the same number of profiles that differ most: the last one, and repeatedly
/// the one with the largest distance from those chosen so far.
fn distinct(profiles: &[Vec<f64>], preferred: Vec<usize>) -> Vec<usize> {
    /// L1 norm of the difference of two profiles, relative to the sum of their norms, below which they look alike: that of two pulses that overlap
    /// over 95 % of their length.
    const ALIKE: f64 = 0.05;
    let norm = |values: &mut dyn Iterator<Item = f64>| values.map(f64::abs).filter(|v| v.is_finite()).sum::<f64>();
    let norms: Vec<f64> = profiles.iter().map(|p| norm(&mut p.iter().copied())).collect();
    let noise = 1e-3 * norms.iter().fold(f64::MIN_POSITIVE, |a, b| a.max(*b));
    // Relative to the norms of the profiles: short pulses at different positions differ as much as long ones.
    let distance = |a: usize, b: usize| {
        norm(&mut profiles[a].iter().zip(&profiles[b]).map(|(a, b)| a - b)) / (norms[a] + norms[b] + noise)
    };
    let separation = |chosen: &[usize], from: usize| {
        chosen.iter().filter(|&&i| i != from).map(|&i| distance(i, from)).fold(f64::INFINITY, f64::min)
    };
    let closest = |chosen: &[usize]| chosen.iter().map(|&i| separation(chosen, i)).fold(f64::INFINITY, f64::min);
    let mut chosen = vec![profiles.len() - 1];
    while chosen.len() < preferred.len() {
        let free = (0..profiles.len()).filter(|i| !chosen.contains(i));
        let Some(next) = free.max_by(|&a, &b| separation(&chosen, a).total_cmp(&separation(&chosen, b))) else { break };
        chosen.push(next);
    }
    if closest(&preferred) >= ALIKE.min(closest(&chosen)) {
        return preferred;
    }
    chosen.sort_unstable();
    chosen
}

#[cfg(test)]
mod tests {
    use super::distinct;

    /// Returns the profiles of a pulse that circulates in a bar of 60 samples with a period of 20 frames.
    fn round_trip(frame: usize) -> Vec<f64> {
        (0..60).map(|x| if (frame * 3) % 60 == x { 1.0 } else { 0.0 }).collect()
    }

    #[test]
    fn a_period_of_the_bar_does_not_alias_the_profiles() {
        let profiles: Vec<Vec<f64>> = (0..60).map(round_trip).collect();
        // Frames 19, 39 and 59 look alike.
        let chosen = distinct(&profiles, vec![9, 19, 29, 39, 59]);
        for (i, &a) in chosen.iter().enumerate() {
            assert!(chosen[..i].iter().all(|&b| profiles[a] != profiles[b]), "{chosen:?}");
        }
        assert_eq!((chosen.len(), chosen.last()), (5, Some(&59)));
    }

    #[test]
    fn profiles_that_differ_stay_evenly_spaced() {
        let growing: Vec<Vec<f64>> = (1..=60).map(|t| (0..60).map(|x| f64::from(u8::from(x < t))).collect()).collect();
        assert_eq!(distinct(&growing, vec![11, 23, 35, 47, 59]), [11, 23, 35, 47, 59]);
        let still = vec![vec![2.0; 60]; 60];
        assert_eq!(distinct(&still, vec![11, 59]), [11, 59]);
    }
}
