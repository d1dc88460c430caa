//! Figures of line panels in two columns.

use super::drawing::{Picture, Stroke};
use super::grid;
use super::panel::Series;
use super::plot::colour;

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

/// Panels two in a row, lettered (a), (b), ... where there is more than one.
pub fn figure(title: &str, panels: &[Panel]) -> Picture {
    let drawn = |panel: &Panel| grid::Panel {
        heading: panel.title.clone(),
        axes: panel.labels.clone(),
        series: panel.lines.iter().map(series).collect(),
    };
    grid::draw(title, &panels.iter().map(drawn).collect::<Vec<_>>())
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
