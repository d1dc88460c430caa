//! A framed plot: its axes and its position in a panel.

use super::axis::Axis;
use super::drawing::{Anchor, Area, BORDER, Drawing, FINE, GRID, Stroke, text_width};
use super::html::escape;

/// Font sizes, px.
pub(super) const TICK: f64 = 12.0;
const LABEL: f64 = 13.0;
const TITLE: f64 = 14.5;
/// Margins around the plot of a panel, px.
pub(super) const LEFT: f64 = 72.0;
const BOTTOM: f64 = 46.0;
pub(super) const TOP: f64 = 26.0;
pub(super) const LEGEND_ROW: f64 = 18.0;

/// Framed plot: its position and its axes.
#[derive(Debug, Clone)]
pub(super) struct Frame {
    pub plot: Area,
    pub x: Axis,
    pub y: Axis,
}

impl Frame {
    /// Returns the position of a data point in the drawing, px.
    pub fn place(&self, (x, y): (f64, f64)) -> (f64, f64) {
        let (across, up) = (self.x.part(x), self.y.part(y));
        (self.plot.x + across * self.plot.width, self.plot.bottom() - up * self.plot.height)
    }

    /// Draws border, ticks and labels, and grid lines if `grid` is true.
    pub fn draw(&self, drawing: &mut Drawing, grid: bool) {
        let (ticks, power) = self.x.labelled((self.plot.width / 62.0).max(2.0) as usize);
        let (grid_line, tick_line) = (Stroke::new(GRID, 1.0), Stroke::new(BORDER, 1.0));
        if grid {
            self.draw_fine(drawing);
        }
        for (tick, label) in ticks {
            let (x, bottom) = (self.place((tick, self.y.low)).0, self.plot.bottom());
            if grid {
                drawing.line((x, self.plot.y), (x, bottom), &grid_line);
            }
            drawing.line((x, bottom), (x, bottom + 5.0), &tick_line);
            drawing.text((x, bottom + 18.0), TICK, Anchor::Middle, &label);
        }
        let middle = self.plot.x + self.plot.width / 2.0;
        drawing.text((middle, self.plot.bottom() + 38.0), LABEL, Anchor::Middle, &self.x.full_label(power));
        self.draw_upright_axis(drawing, grid.then_some(&grid_line), &tick_line);
        drawing.frame(self.plot, &tick_line, self.attributes());
    }

    /// Returns SVG attributes from which a script can convert pixels of the plot to values.
    fn attributes(&self) -> String {
        let axis = |name: &str, axis: &Axis| {
            let kind = if axis.is_logarithmic() { " log" } else { "" };
            format!(
                " data-{name}=\"{:e} {:e}{kind}\" data-{name}-label=\"{}\"",
                axis.low,
                axis.high,
                escape(&axis.label)
            )
        };
        format!(" class=\"plot\"{}{}", axis("x", &self.x), axis("y", &self.y))
    }

    /// Draws the pale grid lines of logarithmic axes.
    fn draw_fine(&self, drawing: &mut Drawing) {
        let fine = Stroke::new(FINE, 0.8);
        for x in self.x.fine() {
            let x = self.place((x, self.y.low)).0;
            drawing.line((x, self.plot.y), (x, self.plot.bottom()), &fine);
        }
        for y in self.y.fine() {
            let y = self.place((self.x.low, y)).1;
            drawing.line((self.plot.x, y), (self.plot.right(), y), &fine);
        }
    }

    fn draw_upright_axis(&self, drawing: &mut Drawing, grid: Option<&Stroke>, tick_line: &Stroke) {
        let mut widest = 0.0_f64;
        let (ticks, power) = self.y.labelled((self.plot.height / 36.0).max(2.0) as usize);
        for (tick, label) in ticks {
            let y = self.place((self.x.low, tick)).1;
            widest = widest.max(text_width(&label, TICK));
            if let Some(grid) = grid {
                drawing.line((self.plot.x, y), (self.plot.right(), y), grid);
            }
            drawing.line((self.plot.x - 5.0, y), (self.plot.x, y), tick_line);
            drawing.text((self.plot.x - 8.0, y + 4.0), TICK, Anchor::End, &label);
        }
        let middle = self.plot.y + self.plot.height / 2.0;
        // Aligned with the labels of other plots, unless the ticks have long labels.
        let room = (LEFT - 14.0).max(widest + 17.0);
        drawing.upright((self.plot.x - room, middle), LABEL, &self.y.full_label(power));
    }
}

impl Frame {
    /// Draws the vertical axis on the right side, for a colour bar.
    pub fn draw_right(&self, drawing: &mut Drawing) {
        let stroke = Stroke::new(BORDER, 1.0);
        let mut widest = 0.0_f64;
        let (ticks, power) = self.y.labelled((self.plot.height / 36.0).max(2.0) as usize);
        for (tick, text) in ticks {
            let (x, y) = (self.plot.right(), self.place((self.x.low, tick)).1);
            drawing.line((x, y), (x + 5.0, y), &stroke);
            widest = widest.max(text_width(&text, TICK));
            drawing.text((x + 8.0, y + 4.0), TICK, Anchor::Start, &text);
        }
        let middle = self.plot.y + self.plot.height / 2.0;
        drawing.upright((self.plot.right() + widest + 26.0, middle), LABEL, &self.y.full_label(power));
        drawing.outline(self.plot, &stroke);
    }
}

/// Returns the area of the plot in a panel: the panel without title, legend rows and axis labels.
pub(super) fn plot_area(panel: Area, legend_rows: usize, right: f64) -> Area {
    let top = TOP + LEGEND_ROW * legend_rows as f64;
    Area { x: panel.x + LEFT, y: panel.y + top, width: panel.width - LEFT - right, height: panel.height - top - BOTTOM }
}

/// Draws the title above the plot.
pub(super) fn title(drawing: &mut Drawing, panel: Area, text: &str) {
    drawing.bold((panel.x + LEFT, panel.y + 16.0), TITLE, Anchor::Start, text);
}
