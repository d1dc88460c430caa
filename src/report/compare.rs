//! Figure of a comparison of materials: curves, front speeds, impact velocities, and sorted bars of the critical velocities.

use super::axes::{Frame, plot_area, title};
use super::axis::Axis;
use super::drawing::{Anchor, Area, Drawing, Picture, Stroke, text_width};
use super::panel::{Series, draw_series};
use super::plot::{COLOURS, colour};
use crate::study::compare::Compared;
use crate::units::{Dimension, Scale, System};

const PERCENT: f64 = 0.01;

const WIDTH: f64 = 1240.0;
const MARGIN: f64 = 16.0;
const HEIGHT: f64 = 400.0;
/// Height of a row with a bar and its name, px.
const ROW: f64 = 20.0;
const SMALL: f64 = 11.0;

/// Dash patterns, the solid line first; each is used for as many lines as there are colours.
const DASHES: [&str; 5] = ["", "7 3", "2 3", "9 3 2 3", "12 4"];

/// Slowest front speed that is shown, relative to the fastest.
const SLOWEST: f64 = 1e-3;

/// Material with its rank and its line style.
struct Line<'a> {
    material: &'a Compared,
    /// Rank by critical velocity, from 1.
    number: usize,
    stroke: Stroke,
}

/// Draws stress, front speed and impact velocity against strain with marks at the ultimate points, and the sorted critical velocities.
///
/// Lines differ in colour and dash pattern; the number at the end of each line is that of its bar.
pub fn figure(materials: &[Compared], units: System) -> Picture {
    let velocity = units.of_columns(Dimension::Velocity);
    let lines = lines(materials);
    let second = HEIGHT.max(70.0 + ROW * lines.len() as f64);
    let width = (WIDTH - 3.0 * MARGIN) / 2.0;
    let area = |column: usize, row: usize| Area {
        x: MARGIN + (width + MARGIN) * column as f64,
        y: MARGIN + (HEIGHT + MARGIN) * row as f64,
        width,
        height: if row == 0 { HEIGHT } else { second },
    };
    let mut drawing = Drawing::default();
    curves(&mut drawing, area(0, 0), &lines, units.of_columns(Dimension::Stress));
    speeds(&mut drawing, area(1, 0), &lines, velocity);
    velocities(&mut drawing, Area { height: HEIGHT, ..area(0, 1) }, &lines, velocity);
    bars(&mut drawing, area(1, 1), &lines, velocity);
    drawing.finish(WIDTH, HEIGHT + second + 3.0 * MARGIN)
}

/// Returns the materials sorted by critical velocity, the largest first; those without one come last.
fn lines(materials: &[Compared]) -> Vec<Line<'_>> {
    let mut order: Vec<usize> = (0..materials.len()).collect();
    let velocity = |i: usize| materials[i].critical.critical_velocity_m_s.unwrap_or(f64::NEG_INFINITY);
    order.sort_by(|&a, &b| velocity(b).total_cmp(&velocity(a)));
    let line = |(rank, i): (usize, usize)| Line {
        material: &materials[i],
        number: rank + 1,
        stroke: Stroke::new(colour(i), 1.8).dashed(DASHES[(i / COLOURS.len()) % DASHES.len()]),
    };
    order.into_iter().enumerate().map(line).collect()
}

/// Draws a framed panel of lines with their numbers at the ends, and marks.
fn panel(drawing: &mut Drawing, place: Area, heading: &str, [x, y]: [Axis; 2], series: &[Series], numbers: &[usize]) {
    let frame = Frame { plot: plot_area(place, 0, 30.0), x, y };
    title(drawing, place, heading);
    frame.draw(drawing, true);
    drawing.clipped(frame.plot, |drawing| series.iter().for_each(|series| draw_series(drawing, &frame, series)));
    let mut taken = Vec::new();
    for (series, number) in series.iter().zip(numbers) {
        let inside = |point: &&(f64, f64)| point.1 >= frame.y.low && point.0.is_finite();
        if let Some(&end) = series.points.iter().rev().find(inside) {
            label(drawing, frame.plot, frame.place(end), &number.to_string(), &series.stroke.colour, &mut taken);
        }
    }
}

/// Writes a number beside the end of its line, inside the height of the plot, and shifted up or down if that place is taken.
fn label(drawing: &mut Drawing, plot: Area, (x, y): (f64, f64), text: &str, colour: &str, taken: &mut Vec<Area>) {
    let (width, height) = (text_width(text, SMALL), SMALL);
    let overlaps = |a: &Area, b: &Area| a.x < b.right() && b.x < a.right() && a.y < b.bottom() && b.y < a.bottom();
    let inside = |a: &Area| a.y >= plot.y && a.bottom() <= plot.bottom();
    let steps = (0..80).map(|k: i32| f64::from(if k % 2 == 0 { k / 2 } else { -(k + 1) / 2 }));
    let places = steps.map(|step| Area { x: x + 5.0, y: y - 0.5 * height + step * height, width, height });
    let free = places.into_iter().find(|area| inside(area) && taken.iter().all(|other| !overlaps(area, other)));
    if let Some(area) = free {
        if (area.y + 0.5 * height - y).abs() > height {
            drawing.line((x, y), (area.x, area.y + 0.5 * height), &Stroke::new(colour, 0.6));
        }
        drawing.coloured((area.x, area.bottom() - 1.5), SMALL, colour, text);
        taken.push(area);
    }
}

/// Returns marks at a point of each material that has one, in the colour of its line.
fn marks(lines: &[Line], point: impl Fn(&Compared) -> Option<(f64, f64)>) -> Vec<Series> {
    let mark = |line: &Line| {
        let at = point(line.material)?;
        Some(Series::marks("", vec![at], Stroke::new(&line.stroke.colour, 1.8)))
    };
    lines.iter().filter_map(mark).collect()
}

fn largest(series: &[Series], of: fn(&(f64, f64)) -> f64) -> f64 {
    series.iter().flat_map(|s| &s.points).map(of).fold(0.0, f64::max)
}

fn from_zero(label: &str, high: f64) -> Axis {
    Axis::new(label, 0.0, 1.04 * high)
}

const STRAIN: &str = "engineering strain (%)";

fn numbers(lines: &[Line]) -> Vec<usize> {
    lines.iter().map(|line| line.number).collect()
}

/// Draws the stress-strain curves, thin and dotted past the ultimate point.
fn curves(drawing: &mut Drawing, place: Area, lines: &[Line], stress: Scale) {
    let part = |line: &Line, keep: &dyn Fn(f64) -> bool| -> Vec<(f64, f64)> {
        let kept = line.material.curve.iter().filter(|p| keep(p.strain));
        kept.map(|p| (p.strain / PERCENT, stress.of(p.stress_pa))).collect()
    };
    let end = |line: &Line| line.material.critical.strain_at_max.unwrap_or(f64::INFINITY);
    let loading = |line: &Line| Series::line("", part(line, &|e| e <= end(line)), line.stroke.clone());
    let falling = |line: &Line| {
        Series::line("", part(line, &|e| e >= end(line)), Stroke::new(&line.stroke.colour, 0.8).dashed("1 3"))
    };
    let mut series: Vec<Series> = lines.iter().map(loading).collect();
    series.extend(lines.iter().map(falling));
    series
        .extend(marks(lines, |m| Some((m.critical.strain_at_max? / PERCENT, stress.of(m.critical.stress_at_max_pa?)))));
    let axes = [
        from_zero(STRAIN, largest(&series, |p| p.0)),
        from_zero(&format!("engineering stress ({})", stress.symbol), largest(&series, |p| p.1)),
    ];
    panel(drawing, place, "(a)  stress-strain curves, ultimate points", axes, &series, &numbers(lines));
}

/// Draws the front speed of each straight segment of the loading curves as a step function, on a logarithmic scale down to a thousandth of the
/// fastest.
fn speeds(drawing: &mut Drawing, place: Area, lines: &[Line], unit: Scale) {
    let fastest = lines.iter().map(|line| unit.of(line.material.elastic_speed_m_s)).fold(0.0, f64::max);
    let stairs = |line: &Line| {
        let steps = line.material.loading.windows(2).flat_map(|p| {
            // Where the stress does not rise, the line is drawn below the panel.
            let speed = unit.of(p[1].wave_speed_m_s).max(0.1 * SLOWEST * fastest);
            [(p[0].strain / PERCENT, speed), (p[1].strain / PERCENT, speed)]
        });
        Series::line("", steps.collect(), line.stroke.clone())
    };
    let series: Vec<Series> = lines.iter().map(stairs).collect();
    let axes = [
        from_zero(STRAIN, largest(&series, |p| p.0)),
        Axis::logarithmic(format!("front speed ({})", unit.symbol), SLOWEST * fastest, 1.4 * fastest),
    ];
    panel(drawing, place, "(b)  plastic wave speed", axes, &series, &numbers(lines));
}

fn velocities(drawing: &mut Drawing, place: Area, lines: &[Line], unit: Scale) {
    let line = |line: &Line| {
        let points = line.material.loading.iter().map(|p| (p.strain / PERCENT, unit.of(p.impact_velocity_m_s)));
        Series::line("", points.collect(), line.stroke.clone())
    };
    let mut series: Vec<Series> = lines.iter().map(line).collect();
    series.extend(marks(lines, |m| {
        Some((m.critical.strain_at_max? / PERCENT, unit.of(m.critical.critical_velocity_m_s?)))
    }));
    let label = format!("impact velocity ({})", unit.symbol);
    let axes = [from_zero(STRAIN, largest(&series, |p| p.0)), from_zero(&label, largest(&series, |p| p.1))];
    panel(drawing, place, "(c)  impact velocity", axes, &series, &numbers(lines));
}

/// Draws rank, line style, name and critical velocity of every material.
fn bars(drawing: &mut Drawing, place: Area, lines: &[Line], unit: Scale) {
    let heading = format!("(d)  critical impact velocity ({})", unit.symbol);
    drawing.bold((place.x + 26.0, place.y + 16.0), 14.5, Anchor::Start, &heading);
    let widest = lines.iter().map(|line| text_width(&line.material.critical.material, 12.0)).fold(0.0, f64::max);
    let names = place.x + 76.0;
    let start = names + 1.08 * widest + 8.0;
    let most = lines.iter().filter_map(|line| line.material.critical.critical_velocity_m_s).fold(0.0, f64::max);
    for (row, line) in lines.iter().enumerate() {
        let y = place.y + 34.0 + ROW * row as f64;
        let middle = y + 0.5 * ROW;
        drawing.text((place.x + 36.0, middle + 4.0), 12.0, Anchor::End, &line.number.to_string());
        drawing.line((place.x + 42.0, middle), (place.x + 70.0, middle), &line.stroke);
        drawing.text((names, middle + 4.0), 12.0, Anchor::Start, &line.material.critical.material);
        let Some(velocity) = line.material.critical.critical_velocity_m_s else {
            drawing.text((start, middle + 4.0), 12.0, Anchor::Start, "none within the data");
            continue;
        };
        let width = (place.x + place.width - start - 50.0) * velocity / most;
        let bar = Area { x: start, y: y + 3.0, width, height: ROW - 6.0 };
        drawing.rect(bar, &line.stroke.colour, None);
        drawing.text((bar.right() + 5.0, middle + 4.0), 12.0, Anchor::Start, &format!("{:.2}", unit.of(velocity)));
    }
}
