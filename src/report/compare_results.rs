//! Figure of a comparison of result files.

use super::display::{Unit, Units, field_name};
use super::drawing::Picture;
use super::grid::{Panel, draw, stroke};
use super::panel::Series;
use crate::error::Result;
use crate::record::store::{ResultFile, Side};
use crate::record::{Field, Trace};
use crate::study::compare_results::{Difference, profile_at};

/// Largest number of gauges that get a panel each.
const GAUGES: usize = 6;

/// Draws the profiles of a field where it differs most, its difference against time, and the stress histories at gauges and ends.
///
/// # Errors
/// An error if a file cannot be read.
pub fn figure(files: &[ResultFile], differences: &[Difference], field: Option<Field>) -> Result<Picture> {
    let names: Vec<String> = files.iter().map(name).collect();
    let shown = field.or_else(|| differences.first()?.fields.first().map(|f| f.field));
    let mut panels = Vec::new();
    if let Some(field) = shown {
        let labelled = (field, files[0].is_in_torsion());
        panels.extend(profiles(files, &names, differences, labelled)?);
        panels.push(difference_in_time(&names, differences, labelled));
    }
    panels.extend(histories(files, &names)?);
    Ok(draw("Results side by side", &panels))
}

fn name(file: &ResultFile) -> String {
    file.path().file_stem().unwrap_or_default().to_string_lossy().into_owned()
}

fn unit_label(field: Field, torsion: bool) -> (Unit, String) {
    let unit = Units::Si.field(field);
    (unit, unit.label(field_name(field, torsion)))
}

/// Returns a panel of the field along the bar at the time of the largest difference, or `None` if the field is not compared.
fn profiles(
    files: &[ResultFile],
    names: &[String],
    all: &[Difference],
    (field, torsion): (Field, bool),
) -> Result<Option<Panel>> {
    let largest = all.iter().flat_map(|d| d.fields.iter().filter(|f| f.field == field));
    let largest = largest.max_by(|a, b| a.norms.max.value.total_cmp(&b.norms.max.value));
    let Some(largest) = largest.map(|f| f.largest) else { return Ok(None) };
    let (unit, label) = unit_label(field, torsion);
    let mut series = Vec::new();
    for (i, file) in files.iter().enumerate().filter(|(_, file)| file.fields().contains(&field)) {
        let values = profile_at(file, field, largest.time_s)?;
        let points = file.x()?.into_iter().zip(values).map(|(x, v)| (x, v * unit.factor)).collect();
        series.push(Series::line(&names[i], points, stroke(i)));
    }
    zoom(&mut series);
    let heading = format!(
        "{}, largest difference: at {:.4} m, {:.2} \u{b5}s",
        field_name(field, torsion),
        largest.x_m,
        1e6 * largest.time_s
    );
    Ok(Some(Panel { heading, axes: ["position x (m)".into(), label], series }))
}

/// Relative size below which values are invisible in a plot.
const UNSEEN: f64 = 1e-3;

/// Crops the series to the visible part of the bar if that is less than half of it.
fn zoom(series: &mut [Series]) {
    let points = || series.iter().flat_map(|one| &one.points);
    let largest = points().fold(0.0_f64, |largest, point| largest.max(point.1.abs()));
    let span = |seen: f64| {
        let within = points().filter(|point| point.1.abs() >= seen * largest);
        within.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], point| [low.min(point.0), high.max(point.0)])
    };
    let ([low, high], [start, end]) = (span(UNSEEN), span(0.0));
    if high - low < 0.5 * (end - start) {
        let margin = 0.5 * (high - low).max(0.02 * (end - start));
        for one in series {
            one.points.retain(|point| (low - margin..=high + margin).contains(&point.0));
        }
    }
}

fn difference_in_time(names: &[String], all: &[Difference], (field, torsion): (Field, bool)) -> Panel {
    let (unit, label) = unit_label(field, torsion);
    let line = |(i, difference): (usize, &Difference)| {
        let history = difference.fields.iter().find(|f| f.field == field)?;
        let points = history.history.iter().map(|(t, d)| (1e6 * t, d * unit.factor)).collect();
        Some(Series::line(&names[i + 1], points, stroke(i + 1)))
    };
    Panel {
        heading: format!("root mean square difference from {}", names[0]),
        axes: [TIME.into(), label],
        series: all.iter().enumerate().filter_map(line).collect(),
    }
}

const TIME: &str = "time (\u{b5}s)";

/// Returns panels of the stress at the gauges of the first file and at the ends.
fn histories(files: &[ResultFile], names: &[String]) -> Result<Vec<Panel>> {
    let unit = Units::Si.field(Field::Stress);
    let line = |i: usize, trace: &Trace| {
        let points = trace.time.iter().zip(&trace.stress).map(|(t, s)| (1e6 * t, s * unit.factor)).collect();
        Series::line(&names[i], points, stroke(i))
    };
    let panel =
        |heading: String, series: Vec<Series>| Panel { heading, axes: [TIME.into(), unit.label("stress")], series };
    let gauges = files.iter().map(ResultFile::gauges).collect::<Result<Vec<_>>>()?;
    let mut panels = Vec::new();
    for own in gauges.first().into_iter().flatten().take(GAUGES) {
        let same = gauges.iter().enumerate().filter_map(|(i, all)| Some((i, all.iter().find(|g| g.name == own.name)?)));
        let series = same.map(|(i, gauge)| line(i, &gauge.trace)).collect();
        panels.push(panel(format!("stress at the gauge {}", own.name), series));
    }
    for side in [Side::Left, Side::Right] {
        let traces = files.iter().map(|file| file.end(side)).collect::<Result<Vec<_>>>()?;
        // The stress at a free end is zero and is not shown.
        if traces.iter().all(|trace| trace.stress.iter().all(|stress| *stress == 0.0)) {
            continue;
        }
        let series = traces.iter().enumerate().map(|(i, trace)| line(i, trace)).collect();
        panels.push(panel(format!("stress at the {} end", side.name()), series));
    }
    Ok(panels)
}
