//! Figures of line panels in two columns.

use super::axis::Axis;
use super::drawing::{Anchor, Area, Drawing, Picture, Stroke};
use super::panel::{Series, line_panel};
use super::plot::{COLOURS, colour};

/// Width and height of a panel, px.
const PANEL: [f64; 2] = [566.0, 380.0];
const MARGIN: f64 = 16.0;
const HEADER: f64 = 40.0;

pub(super) const DASHES: [&str; 4] = ["", "7 3", "2 3", "9 3 2 3"];

/// Returns the line style of series `i`. Coincident lines remain visible: the first one is wide, and the others are dashed.
pub(super) fn stroke(i: usize) -> Stroke {
    let width = if i == 0 { 2.4 } else { 1.6 };
    Stroke::new(colour(i), width).dashed(DASHES[(i + i / COLOURS.len()) % DASHES.len()])
}

/// Panel with its title, axis labels and lines.
pub(super) struct Panel {
    pub(super) heading: String,
    pub(super) axes: [String; 2],
    pub(super) series: Vec<Series>,
}

/// Draws the panels below a title, lettered if there are several; every axis includes zero.
pub(super) fn draw(title: &str, panels: &[Panel]) -> Picture {
    draw_along(title, panels, Across::FromZero)
}

/// Kind of an x axis.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Across {
    /// Linear, including zero.
    FromZero,
    /// Linear, around the values.
    AroundValues,
    /// Logarithmic; all values are positive.
    Logarithmic,
}

/// Draws the panels as [`draw`] does, with x axes of another kind.
pub(super) fn draw_along(title: &str, panels: &[Panel], across: Across) -> Picture {
    document(title, [panels.len().min(2), panels.len().div_ceil(2)], |drawing| {
        for (k, Panel { heading, axes: [x, y], series }) in panels.iter().enumerate() {
            let letter = char::from(b'a' + (k % 26) as u8);
            let heading = if panels.len() > 1 { format!("({letter})  {heading}") } else { heading.clone() };
            panel_along(drawing, area(k % 2, k / 2), &heading, [x, y], series, across);
        }
    })
}

/// Returns the area of a panel in the figure, px.
pub(super) fn area(column: usize, row: usize) -> Area {
    let [width, height] = PANEL;
    let (x, y) = (MARGIN + (width + MARGIN) * column as f64, HEADER + (height + MARGIN) * row as f64);
    Area { x, y, width, height }
}

/// Creates a figure with this number of columns and rows of panels below a title.
pub(super) fn document(title: &str, [columns, rows]: [usize; 2], draw: impl FnOnce(&mut Drawing)) -> Picture {
    let mut drawing = Drawing::default();
    drawing.bold((MARGIN, 26.0), 18.0, Anchor::Start, title);
    draw(&mut drawing);
    let beyond = area(columns, rows);
    drawing.finish(beyond.x, beyond.y)
}

/// Draws a panel whose axes include zero and all points.
pub(super) fn panel(drawing: &mut Drawing, place: Area, heading: &str, axes: [&str; 2], series: &[Series]) {
    panel_along(drawing, place, heading, axes, series, Across::FromZero);
}

fn panel_along(
    drawing: &mut Drawing,
    place: Area,
    heading: &str,
    [x, y]: [&str; 2],
    series: &[Series],
    across: Across,
) {
    let all = || series.iter().flat_map(|s| &s.points).filter(|p| p.0.is_finite() && p.1.is_finite());
    let x = match across {
        Across::FromZero => axis(x, &all().map(|p| p.0), Some(0.0)),
        Across::AroundValues => axis(x, &all().map(|p| p.0), None),
        Across::Logarithmic => Axis::logarithmic_around(x, all().map(|p| p.0)),
    };
    let y = axis(y, &all().map(|p| p.1), Some(0.0));
    line_panel(drawing, place, heading, x, y, series);
}

/// Returns an axis that contains all values and the origin, and ends at zero if no value lies beyond it.
fn axis(label: &str, values: &(impl Iterator<Item = f64> + Clone), origin: Option<f64>) -> Axis {
    let mut axis = Axis::around(label, values.clone().chain(origin));
    let (negative, positive) = (values.clone().any(|v| v < 0.0), values.clone().any(|v| v > 0.0));
    if positive && !negative {
        axis.low = axis.low.max(0.0);
    }
    if negative && !positive {
        axis.high = axis.high.min(0.0);
    }
    axis
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn axes_end_at_zero_where_no_value_lies_beyond() {
        let ends = |values: &[f64], origin| {
            let axis = axis("", &values.iter().copied(), origin);
            (axis.low, axis.high)
        };
        assert_eq!(ends(&[10.0, 100.0], Some(0.0)).0, 0.0);
        assert_eq!(ends(&[-40.0, -10.0], Some(0.0)).1, 0.0);
        assert!(ends(&[-1.0, 1.0], Some(0.0)).0 < -1.0);
        let (low, high) = ends(&[-12.0, -7.0], None);
        assert!(low < -12.0 && (-7.0..-6.0).contains(&high));
        let (low, high) = ends(&[0.0, 0.0], Some(0.0));
        assert!(low < high);
    }
}
