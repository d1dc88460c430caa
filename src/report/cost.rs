//! Figure of a cost study: error against stepping time, both on logarithmic axes, with one line per method.

use super::axis::superscript;
use super::drawing::{Anchor, Area, BORDER, Drawing, FINE, GRID, Picture, Stroke, shortened, text_width};
use super::plot::colour;
use crate::study::cost::{Cost, CostPoint, Resolution, TOLERANCES};

const WIDTH: f64 = 760.0;
const HEIGHT: f64 = 560.0;
/// Area of the plot, px.
const PLOT: Area = Area { x: 84.0, y: 58.0, width: 596.0, height: 410.0 };
/// Height of the strip at the bottom of the plot for errors too small for the axis, px.
const STRIP: f64 = 30.0;

/// Font sizes, px.
const SMALL: f64 = 11.0;
const NORMAL: f64 = 13.0;
const LARGE: f64 = 15.0;

/// Smallest error on the axis. Smaller ones (rounding errors, and exact results of front tracking) are drawn in a strip below it.
const SMALLEST: f64 = 1e-6;

/// Shape of the marks of a method, so that methods can be distinguished without colour.
#[derive(Debug, Clone, Copy)]
enum Mark {
    Circle,
    Square,
    Diamond,
    Triangle,
}

const MARKS: [Mark; 4] = [Mark::Circle, Mark::Square, Mark::Diamond, Mark::Triangle];
const MARK_SIZE: f64 = 4.5;

/// Ranges of the axes, as powers of ten.
struct Frame {
    time: [i32; 2],
    error: [i32; 2],
    /// True if some errors are too small for the axis.
    strip: bool,
}

/// Draws error against stepping time of every point, with the Pareto front and the tolerances.
pub fn figure(cost: &Cost) -> Picture {
    let frame = Frame::of(cost);
    let mut drawing = Drawing::default();
    let mut taken = Vec::new();
    title(&mut drawing, cost);
    grid(&mut drawing, &frame, cost.measure);
    tolerances(&mut drawing, &frame);
    uncertainty(&mut drawing, &frame, cost, &mut taken);
    front(&mut drawing, &frame, &cost.points);
    let schemes = cost.schemes();
    for (k, (_, points)) in schemes.iter().enumerate() {
        let points: Vec<&CostPoint> = points.iter().map(|p| p.1).collect();
        line(&mut drawing, &frame, &points, k);
        taken.extend(points.iter().map(|p| around(frame.place(p), MARK_SIZE + 1.0)));
        for pair in points.windows(2) {
            taken.extend(along(frame.place(pair[0]), frame.place(pair[1])));
        }
    }
    for (_, points) in &schemes {
        let ends = [points.first(), points.last()];
        let count = if points.len() > 1 { 2 } else { 1 };
        for (_, point) in ends.into_iter().flatten().take(count) {
            label(&mut drawing, &frame, point, &mut taken);
        }
    }
    legend(&mut drawing, cost, &schemes.iter().map(|s| s.0).collect::<Vec<_>>());
    drawing.finish(WIDTH, HEIGHT)
}

impl Frame {
    fn of(cost: &Cost) -> Self {
        let decades = |values: &mut dyn Iterator<Item = f64>, room: [f64; 2]| {
            let (low, high) = values.fold((f64::INFINITY, 0.0_f64), |(l, h), v| (l.min(v), h.max(v)));
            let low = (low * room[0]).log10().floor() as i32;
            [low, ((high * room[1]).log10().ceil() as i32).max(low + 1)]
        };
        let known = |p: &&CostPoint| p.step_wall_s > 0.0;
        let time = decades(&mut cost.points.iter().filter(known).map(|p| p.step_wall_s), [0.8, 1.2]);
        // The tolerances are always in the range of the axis.
        let errors = cost.points.iter().map(|p| p.error).filter(|e| *e >= SMALLEST);
        // The small increase keeps rounding from adding a decade: a tenth of a thousandth equals 1e-4 only to rounding.
        let error = decades(&mut errors.chain([TOLERANCES[0], TOLERANCES[3]]), [1.0 + 1e-9, 1.0]);
        Self { time, error, strip: cost.points.iter().any(|p| p.error < SMALLEST) }
    }

    fn x(&self, seconds: f64) -> f64 {
        let part = (seconds.log10() - f64::from(self.time[0])) / f64::from(self.time[1] - self.time[0]);
        PLOT.x + PLOT.width * part
    }

    fn bottom(&self) -> f64 {
        PLOT.bottom() - if self.strip { STRIP } else { 0.0 }
    }

    fn y(&self, error: f64) -> f64 {
        if error < SMALLEST {
            return PLOT.bottom() - 0.5 * STRIP;
        }
        let part = (error.log10() - f64::from(self.error[0])) / f64::from(self.error[1] - self.error[0]);
        self.bottom() - (self.bottom() - PLOT.y) * part
    }

    fn place(&self, point: &CostPoint) -> (f64, f64) {
        (self.x(point.step_wall_s.max(f64::MIN_POSITIVE)), self.y(point.error))
    }
}

fn title(drawing: &mut Drawing, cost: &Cost) {
    drawing.bold((PLOT.x, 26.0), LARGE, Anchor::Start, &shortened(&cost.scene, 78));
    let under = format!("errors against the {}", cost.reference);
    drawing.text((PLOT.x, 44.0), SMALL, Anchor::Start, &shortened(&under, 104));
}

/// Draws the grid lines of both axes, their labels and titles, and the strip of small errors.
fn grid(drawing: &mut Drawing, frame: &Frame, measure: &str) {
    let (pale, fine, dark) = (Stroke::new(GRID, 0.8), Stroke::new(FINE, 0.6), Stroke::new(BORDER, 1.0));
    let power = |exponent: i32| format!("10{}", superscript(exponent));
    for decade in frame.time[0]..=frame.time[1] {
        for k in 2..10 {
            let x = frame.x(f64::from(k) * 10_f64.powi(decade));
            if x < PLOT.right() {
                drawing.line((x, PLOT.y), (x, PLOT.bottom()), &fine);
            }
        }
    }
    for decade in frame.time[0]..=frame.time[1] {
        let x = frame.x(10_f64.powi(decade));
        drawing.line((x, PLOT.y), (x, PLOT.bottom()), &pale);
        drawing.text((x, PLOT.bottom() + 18.0), NORMAL, Anchor::Middle, &power(decade));
    }
    for decade in frame.error[0]..=frame.error[1] {
        let y = frame.y(10_f64.powi(decade) * (1.0 + 1e-9));
        drawing.line((PLOT.x, y), (PLOT.right(), y), &pale);
        drawing.text((PLOT.x - 8.0, y + 4.5), NORMAL, Anchor::End, &power(decade));
    }
    if frame.strip {
        drawing.line((PLOT.x, frame.bottom()), (PLOT.right(), frame.bottom()), &Stroke::new("#888", 0.8).dashed("2 3"));
        drawing.text((PLOT.x - 8.0, PLOT.bottom() - 0.5 * STRIP + 4.0), SMALL, Anchor::End, "below");
    }
    drawing.outline(PLOT, &dark);
    drawing.text(
        (PLOT.x + 0.5 * PLOT.width, PLOT.bottom() + 40.0),
        NORMAL,
        Anchor::Middle,
        "stepping time (s), median",
    );
    drawing.upright((24.0, 0.5 * (PLOT.y + PLOT.bottom())), NORMAL, &format!("error: {measure}"));
}

/// Draws a line at each tolerance of the study, labelled on the right.
fn tolerances(drawing: &mut Drawing, frame: &Frame) {
    for tolerance in TOLERANCES {
        let y = frame.y(tolerance);
        drawing.line((PLOT.x, y), (PLOT.right(), y), &Stroke::new("#999", 1.0).dashed("6 4"));
        drawing.text((PLOT.right() + 8.0, y + 4.5), NORMAL, Anchor::Start, &format!("{} %", 100.0 * tolerance));
    }
}

/// Draws the uncertainty of the reference if it is on the axis.
fn uncertainty(drawing: &mut Drawing, frame: &Frame, cost: &Cost, taken: &mut Vec<Area>) {
    if cost.reference_uncertainty < SMALLEST.max(10_f64.powi(frame.error[0])) {
        return;
    }
    let y = frame.y(cost.reference_uncertainty);
    drawing.line((PLOT.x, y), (PLOT.right(), y), &Stroke::new("#b03060", 1.2).dashed("1.5 3"));
    let text = "uncertainty of the reference";
    let area = Area { x: PLOT.x + 6.0, y: y - 3.0 - SMALL, width: text_width(text, SMALL), height: SMALL + 2.0 };
    drawing.rect(area, "white", None);
    drawing.text((area.x, y - 4.0), SMALL, Anchor::Start, text);
    taken.push(area);
}

/// Draws the Pareto front as a broad pale step function.
fn front(drawing: &mut Drawing, frame: &Frame, points: &[CostPoint]) {
    let mut best: Vec<&CostPoint> = points.iter().filter(|p| p.pareto).collect();
    best.sort_by(|a, b| a.step_wall_s.total_cmp(&b.step_wall_s));
    let Some(first) = best.first() else { return };
    let mut stairs = vec![(frame.place(first).0, PLOT.y)];
    for point in &best {
        let (x, y) = frame.place(point);
        stairs.push((x, stairs[stairs.len() - 1].1));
        stairs.push((x, y));
    }
    stairs.push((PLOT.right(), stairs[stairs.len() - 1].1));
    drawing.path(&stairs, &Stroke::new("#ffd37a", 7.0).opacity(0.6));
}

fn line(drawing: &mut Drawing, frame: &Frame, points: &[&CostPoint], k: usize) {
    let places: Vec<(f64, f64)> = points.iter().map(|p| frame.place(p)).collect();
    drawing.path(&places, &Stroke::new(colour(k), 1.8));
    for (point, place) in points.iter().zip(places) {
        // Marks of errors below the uncertainty of the reference are hollow.
        mark(drawing, place, k, point.below_reference && point.error >= SMALLEST);
    }
}

fn mark(drawing: &mut Drawing, (x, y): (f64, f64), k: usize, hollow: bool) {
    let stroke = Stroke::new(colour(k), 1.6);
    let s = MARK_SIZE;
    let fill = if hollow { "white" } else { colour(k) };
    match MARKS[k % MARKS.len()] {
        Mark::Circle => drawing.circle((x, y), s, fill, &stroke),
        Mark::Square => {
            let area = Area { x: x - 0.9 * s, y: y - 0.9 * s, width: 1.8 * s, height: 1.8 * s };
            drawing.rect(area, fill, Some(&stroke));
        }
        Mark::Diamond => {
            drawing.polygon(&[(x, y - 1.3 * s), (x + 1.3 * s, y), (x, y + 1.3 * s), (x - 1.3 * s, y)], fill, &stroke);
        }
        Mark::Triangle => {
            drawing.polygon(&[(x, y - 1.2 * s), (x + 1.2 * s, y + 0.9 * s), (x - 1.2 * s, y + 0.9 * s)], fill, &stroke);
        }
    }
}

fn around((x, y): (f64, f64), size: f64) -> Area {
    Area { x: x - size, y: y - size, width: 2.0 * size, height: 2.0 * size }
}

/// Returns small squares along a line, where no label is placed.
fn along(from: (f64, f64), to: (f64, f64)) -> impl Iterator<Item = Area> {
    let pieces = ((to.0 - from.0).hypot(to.1 - from.1) / 4.0).ceil().max(1.0);
    (0..=pieces as usize).map(move |k| {
        let part = k as f64 / pieces;
        around((from.0 + part * (to.0 - from.0), from.1 + part * (to.1 - from.1)), 2.0)
    })
}

fn overlap(a: &Area, b: &Area) -> bool {
    a.x < b.right() && b.x < a.right() && a.y < b.bottom() && b.y < a.bottom()
}

/// Writes the resolution at the first free place around a point; nothing if none is free.
fn label(drawing: &mut Drawing, frame: &Frame, point: &CostPoint, taken: &mut Vec<Area>) {
    let text = match point.resolution() {
        _ if point.exact == Some(true) => "all waves tracked".into(),
        Resolution::Cells(cells) => format!("{cells} cells"),
        Resolution::FrontTolerance(tolerance) => format!("tolerance {tolerance}"),
    };
    let ((x, y), width) = (frame.place(point), text_width(&text, SMALL));
    let (gap, height) = (9.0, SMALL + 1.0);
    let places = [
        (x + gap, y - 0.5 * height),
        (x + gap, y - height - 4.0),
        (x + gap, y + 4.0),
        (x - 0.5 * width, y - gap - height),
        (x - 0.5 * width, y + gap),
        (x - gap - width, y - 0.5 * height),
        (x - gap - width, y + 4.0),
    ];
    let inside = |a: &Area| a.x > PLOT.x && a.right() < PLOT.right() && a.y > PLOT.y && a.bottom() < PLOT.bottom();
    let free = places
        .into_iter()
        .map(|(x, y)| Area { x, y, width, height })
        .find(|area| inside(area) && taken.iter().all(|other| !overlap(area, other)));
    if let Some(area) = free {
        // A white background hides the grid lines behind the text.
        drawing.rect(area, "white", None);
        drawing.text((area.x, area.bottom() - 2.5), SMALL, Anchor::Start, &text);
        taken.push(area);
    }
}

/// Draws the legend as one row below the axis: methods with their orders, and the Pareto front.
fn legend(drawing: &mut Drawing, cost: &Cost, schemes: &[&str]) {
    let (mut x, y) = (PLOT.x, HEIGHT - 22.0);
    for (k, scheme) in schemes.iter().enumerate() {
        let order = cost.order_fits.iter().find(|fit| fit.scheme == *scheme);
        let text = match order {
            Some(fit) if fit.against == "cells" => format!("{scheme} (order {:.2})", fit.order),
            _ => (*scheme).to_owned(),
        };
        drawing.line((x, y - 4.0), (x + 24.0, y - 4.0), &Stroke::new(colour(k), 1.8));
        mark(drawing, (x + 12.0, y - 4.0), k, false);
        drawing.text((x + 30.0, y), SMALL + 0.5, Anchor::Start, &text);
        x += 46.0 + text_width(&text, SMALL + 0.5);
    }
    drawing.line((x, y - 4.0), (x + 24.0, y - 4.0), &Stroke::new("#ffd37a", 7.0).opacity(0.6));
    drawing.text((x + 30.0, y), SMALL + 0.5, Anchor::Start, "Pareto front");
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn labels_that_would_overlap_find_another_place_or_none() {
        let frame = Frame { time: [-4, 0], error: [-4, 0], strip: false };
        let point = CostPoint::plain("fd", Resolution::Cells(100), 0.01, 0.01);
        let mut taken = vec![around(frame.place(&point), 5.0)];
        let mut drawing = Drawing::default();
        for _ in 0..20 {
            label(&mut drawing, &frame, &point, &mut taken);
        }
        let drawn = drawing.finish(1.0, 1.0).svg().matches("100 cells").count();
        assert!((2..=7).contains(&drawn), "{drawn}");
        for (i, a) in taken.iter().enumerate() {
            assert!(taken[..i].iter().all(|b| !overlap(a, b)));
        }
    }

    #[test]
    fn what_is_too_small_for_the_axis_stands_in_the_strip_below_it() {
        let frame = Frame { time: [-6, -2], error: [-4, 0], strip: true };
        assert!(frame.y(0.0) > frame.bottom() && frame.y(1e-15) == frame.y(0.0));
        assert!((frame.y(1e-4) - frame.bottom()).abs() < 1e-9);
        assert!((frame.y(1.0) - PLOT.y).abs() < 1e-9);
    }
}
