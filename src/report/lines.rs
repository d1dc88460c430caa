//! Figures of panels of lines, two in a row.

use super::axes::{Axis, Series, line_panel};
use super::plot::colour;
use super::svg::{Anchor, Area, Stroke, Svg};

/// Width and height of a panel.
const PANEL: [f64; 2] = [566.0, 380.0];
const MARGIN: f64 = 16.0;
const HEADER: f64 = 40.0;

/// How a line is drawn.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Style {
    /// Without gaps.
    Solid,
    /// Long strokes.
    Dashed,
    /// Short strokes.
    Dotted,
    /// Circles instead of a line.
    Marks,
}

/// A line of a panel.
#[derive(Debug, Clone, PartialEq)]
pub struct Line {
    /// For the legend; none where it is empty.
    pub name: String,
    /// In the units of the axes.
    pub points: Vec<(f64, f64)>,
    /// Number of its colour, see [`colour`].
    pub colour: usize,
    /// Solid, dashed, ...
    pub style: Style,
}

/// Lines over common axes, which reach from zero to all points.
#[derive(Debug, Clone, PartialEq)]
pub struct Panel {
    /// Above it.
    pub title: String,
    /// Labels of the axes with their units in round brackets: "stress (MPa)".
    pub labels: [String; 2],
    /// Drawn in this order.
    pub lines: Vec<Line>,
}

/// Panels row by row, lettered (a), (b), ... where there is more than one, as SVG text.
pub fn figure(title: &str, panels: &[Panel]) -> String {
    document(title, [panels.len().min(2), panels.len().div_ceil(2)], |svg| {
        for (k, drawn) in panels.iter().enumerate() {
            let letter = char::from(b'a' + (k % 26) as u8);
            let heading = if panels.len() > 1 { format!("({letter})  {}", drawn.title) } else { drawn.title.clone() };
            let series: Vec<Series> = drawn.lines.iter().map(series).collect();
            let [x, y] = &drawn.labels;
            panel(svg, area(k % 2, k / 2), &heading, [x, y], &series);
        }
    })
}

fn series(line: &Line) -> Series {
    let (name, points, stroke) = (line.name.clone(), line.points.clone(), Stroke::new(colour(line.colour), 1.8));
    match line.style {
        Style::Solid => Series::line(name, points, stroke),
        Style::Dashed => Series::line(name, points, stroke.dashed("6 3")),
        Style::Dotted => Series::line(name, points, stroke.dashed("2 3")),
        Style::Marks => Series::marks(name, points, stroke),
    }
}

/// Where a panel stands.
pub(super) fn area(column: usize, row: usize) -> Area {
    let [width, height] = PANEL;
    let (x, y) = (MARGIN + (width + MARGIN) * column as f64, HEADER + (height + MARGIN) * row as f64);
    Area { x, y, width, height }
}

/// A figure of so many columns and rows of panels under a title.
pub(super) fn document(title: &str, [columns, rows]: [usize; 2], draw: impl FnOnce(&mut Svg)) -> String {
    let mut svg = Svg::default();
    svg.bold((MARGIN, 26.0), 18.0, Anchor::Start, title);
    draw(&mut svg);
    let beyond = area(columns, rows);
    svg.document(beyond.x, beyond.y)
}

/// A panel whose axes reach from zero to all points.
pub(super) fn panel(svg: &mut Svg, place: Area, heading: &str, [x, y]: [&str; 2], series: &[Series]) {
    let all = || series.iter().flat_map(|s| &s.points).filter(|p| p.0.is_finite() && p.1.is_finite());
    let x = Axis::around(x, all().map(|p| p.0).chain([0.0]));
    let y = Axis::around(y, all().map(|p| p.1).chain([0.0]));
    line_panel(svg, place, heading, x, y, series);
}
