//! Figures of line panels in two columns, for studies and examples.

use super::drawing::{Picture, Stroke};
use super::grid;
use super::panel::Series;
use super::plot::colour;

/// Style of a line.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Style {
    /// Solid line.
    Solid,
    /// Long dashes.
    Dashed,
    /// Short dashes.
    Dotted,
    /// Circles at the points instead of a line.
    Marks,
}

/// Line of a panel.
#[derive(Debug, Clone, PartialEq)]
pub struct Line {
    /// Name in the legend; a line with an empty name has no entry.
    pub name: String,
    /// Points in the units of the axes.
    pub points: Vec<(f64, f64)>,
    /// Index of its colour, see [`colour`].
    pub colour: usize,
    /// Line style.
    pub style: Style,
}

/// Lines over common axes, which include zero and all points.
#[derive(Debug, Clone, PartialEq)]
pub struct Panel {
    /// Title above the panel.
    pub title: String,
    /// Labels of the axes with their units in round brackets: "stress (MPa)".
    pub labels: [String; 2],
    /// Lines, drawn in this order.
    pub lines: Vec<Line>,
}

/// Draws panels in two columns, lettered (a), (b), ... if there are several.
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
