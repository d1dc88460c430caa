//! Figure of imported test records: before and after the reduction.

use super::axis::Axis;
use super::drawing::{Anchor, Area, Drawing, Picture, Stroke};
use super::grid::DASHES;
use super::panel::{Series, line_panel};
use super::plot::colour;
use crate::material::Scatter;
use crate::test_record::Reduction;

const WIDTH: f64 = 1120.0;
const PANEL: (f64, f64) = (540.0, 420.0);
const MARGIN: f64 = 14.0;
const TOP: f64 = 40.0;
const MPA: f64 = 1e6;
const PERCENT: f64 = 0.01;

/// Largest strain in the panel of the start of the curve.
const START: f64 = 0.015;

/// Line width of the curve of one of several tests, so that it remains visible beside the thin line of the mean.
const TEST: f64 = 2.8;

/// Test record with the curve derived from it.
#[derive(Debug, Clone, Copy)]
pub struct Drawn<'a> {
    /// Name of the record.
    pub name: &'a str,
    /// Strain and stress (Pa) as read, magnitudes.
    pub record: &'a [(f64, f64)],
    /// Curve and results of the reduction.
    pub reduction: &'a Reduction,
}

/// Draws the records and their curves in two panels: whole, and their start with the elastic line and the proof stress. For several tests,
/// `mean` is their mean (strain, stress in Pa), drawn with a band of one standard deviation.
pub fn figure(title: &str, tests: &[Drawn<'_>], mean: Option<(&[(f64, f64)], &Scatter)>) -> Picture {
    let mut drawing = Drawing::default();
    drawing.bold((MARGIN, 26.0), 17.0, Anchor::Start, title);
    let whole = Area { x: MARGIN, y: TOP, width: PANEL.0, height: PANEL.1 };
    let start = Area { x: MARGIN + PANEL.0 + MARGIN, ..whole };
    let series = series(tests, mean);
    let farthest = extent(&series, |point| point.0);
    let highest = extent(&series, |point| point.1);
    let y = |high: f64| Axis::new("engineering stress (MPa)", 0.0, high);
    let x = |low: f64, high: f64| Axis::new("engineering strain (%)", low, high);
    let heading = if tests.len() == 1 { "(a)  record and curve" } else { "(a)  records, their curves and the mean" };
    line_panel(&mut drawing, whole, heading, x(0.0, 1.05 * farthest), y(1.08 * highest), &series);
    let end = (START / PERCENT).min(farthest);
    let low = series.iter().flat_map(|s| &s.points).map(|p| p.0).fold(0.0, f64::min).max(-0.3 * end);
    let mut near = series;
    near.extend(elastic_lines(tests));
    let visible = near.iter().flat_map(|s| &s.points).filter(|p| p.0 <= end).map(|p| p.1).fold(0.0, f64::max);
    line_panel(
        &mut drawing,
        start,
        "(b)  start of the curve",
        x(low, end),
        y(1.12 * visible.min(1.08 * highest)),
        &near,
    );
    drawing.finish(WIDTH, TOP + PANEL.1 + MARGIN)
}

fn extent(series: &[Series], pick: fn(&(f64, f64)) -> f64) -> f64 {
    series.iter().flat_map(|s| &s.points).map(pick).filter(|v| v.is_finite()).fold(0.0, f64::max)
}

fn shown(rows: &[(f64, f64)]) -> Vec<(f64, f64)> {
    rows.iter().map(|&(e, s)| (e / PERCENT, s / MPA)).collect()
}

fn series(tests: &[Drawn<'_>], mean: Option<(&[(f64, f64)], &Scatter)>) -> Vec<Series> {
    let alone = tests.len() == 1;
    let record = |(i, test): (usize, &Drawn<'_>)| {
        let name = if alone { "record" } else { ["records", ""][i.min(1)] };
        Series::line(name, shown(test.record), Stroke::new("#9a9a9a", 1.0))
    };
    let mut series: Vec<Series> = tests.iter().enumerate().map(record).collect();
    for (i, test) in tests.iter().enumerate() {
        let (legend, width) = if alone { ("curve", 1.6) } else { (test.name, TEST) };
        let stroke = Stroke::new(colour(i), width).dashed(DASHES[i % DASHES.len()]);
        series.push(Series::line(legend, shown(&test.reduction.knots), stroke));
        if alone {
            series.push(Series::marks("knots", shown(&test.reduction.knots), Stroke::new(colour(i), 1.0)));
            let max = test.reduction.maximum;
            series.push(Series::marks("maximum load", shown(&[max]), Stroke::new(colour(1), 2.2)));
            if let Some(fracture) = test.reduction.fracture {
                series.push(Series::marks("fracture", shown(&[fracture]), Stroke::new("#000000", 2.2)));
            }
        }
    }
    series.extend(mean.into_iter().flat_map(|(rows, scatter)| with_band(rows, scatter)));
    series
}

/// Returns the mean of several tests and the limits of the band of one standard deviation, as thin lines above the curves of the tests.
fn with_band(rows: &[(f64, f64)], scatter: &Scatter) -> [Series; 3] {
    let band = |sign: f64| -> Vec<(f64, f64)> {
        let rows = scatter.deviation.iter().filter_map(|&(e, d)| {
            let k = rows.iter().position(|row| row.0 >= e)?;
            Some((e, rows[k].1 + sign * d))
        });
        shown(&rows.collect::<Vec<_>>())
    };
    let from_zero: Vec<_> = std::iter::once((0.0, 0.0)).chain(rows.iter().copied()).collect();
    let thin = Stroke::new("#000000", 0.9);
    let dotted = thin.clone().dashed("1.5 3.5");
    [
        Series::line("mean", shown(&from_zero), thin),
        Series::line("mean \u{b1} standard deviation", band(1.0), dotted.clone()),
        Series::line("", band(-1.0), dotted),
    ]
}

/// Returns the elastic line through a plastic strain of 0.2 % and the proof stress where it meets the curve; nothing for several tests.
fn elastic_lines(tests: &[Drawn<'_>]) -> Vec<Series> {
    let [test] = tests else { return Vec::new() };
    let (modulus, offset) = (test.reduction.modulus, crate::test_record::PROOF_OFFSET);
    let Some(proof) = test.reduction.proof_stress else { return Vec::new() };
    let end = 1.15 * proof;
    let line = vec![(offset, 0.0), (offset + end / modulus, end)];
    vec![
        Series::line("0.2 % offset", shown(&line), Stroke::new(colour(2), 1.3).dashed("6 3")),
        Series::marks("proof stress", shown(&[(offset + proof / modulus, proof)]), Stroke::new(colour(2), 2.2)),
    ]
}
