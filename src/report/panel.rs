//! A panel of lines: title, legend, axes and lines.

use super::axes::{Frame, LEFT, LEGEND_ROW, TICK, TOP, plot_area, title};
use super::axis::Axis;
use super::display::four_digits;
use super::drawing::{Anchor, Area, Drawing, INK, PAPER, RUPTURE, Stroke, text_width};

/// Font size of the values that are cut off by an axis, px.
const CUT: f64 = 11.0;

/// Line or marks with a name for the legend; an empty name has no entry.
#[derive(Debug, Clone)]
pub(super) struct Series {
    pub name: String,
    pub points: Vec<(f64, f64)>,
    pub stroke: Stroke,
    /// True for circles at the points instead of a line.
    pub marks: bool,
}

impl Series {
    pub fn line(name: impl Into<String>, points: Vec<(f64, f64)>, stroke: Stroke) -> Self {
        Self { name: name.into(), points, stroke, marks: false }
    }

    pub fn styled(self, stroke: Stroke) -> Self {
        Self { stroke, ..self }
    }

    pub fn marks(name: impl Into<String>, points: Vec<(f64, f64)>, stroke: Stroke) -> Self {
        Self { name: name.into(), points, stroke, marks: true }
    }
}

/// Panel of lines.
#[derive(Debug, Clone)]
pub(super) struct LinePanel {
    pub heading: String,
    pub x: Axis,
    pub y: Axis,
    pub series: Vec<Series>,
}

impl LinePanel {
    /// Adds vertical dashed lines over the full height of the plot; adds none if there are more than eight, too many to tell apart.
    pub fn mark(&mut self, name: &str, places: &[f64]) {
        const MOST: usize = 8;
        if places.is_empty() || places.len() > MOST {
            return;
        }
        let points = places.iter().flat_map(|&x| [(x, self.y.low), (x, self.y.high), (x, f64::NAN)]).collect();
        self.series.push(Series::line(name, points, Stroke::new(RUPTURE, 1.3).dashed("4 3")));
    }

    /// Draws the panel. If the vertical axis cuts off values, the farthest values are written at the edges of the plot.
    pub fn draw(&self, drawing: &mut Drawing, area: Area) {
        let frame = line_panel(drawing, area, &self.heading, self.x.clone(), self.y.clone(), &self.series);
        self.draw_cut(drawing, &frame);
    }

    /// Draws an arrow at each edge that cuts off values, with the farthest value.
    fn draw_cut(&self, drawing: &mut Drawing, frame: &Frame) {
        let seen = |p: &&(f64, f64)| p.1.is_finite() && (self.x.low..=self.x.high).contains(&p.0);
        let points = || self.series.iter().filter(|s| !s.marks).flat_map(|s| &s.points).filter(seen);
        let highest = points().max_by(|a, b| a.1.total_cmp(&b.1)).filter(|p| self.y.part(p.1) > 1.0 + 1e-6);
        let lowest = points().min_by(|a, b| a.1.total_cmp(&b.1)).filter(|p| self.y.part(p.1) < -1e-6);
        for (point, edge, inward) in [(highest, frame.plot.y, 1.0), (lowest, frame.plot.bottom(), -1.0)] {
            let Some(&(x, value)) = point else { continue };
            let x = frame.place((x, self.y.low)).0;
            let text = format!("extends to {}", four_digits(value));
            let arrow = [(x, edge), (x - 5.0, edge + 9.0 * inward), (x + 5.0, edge + 9.0 * inward)];
            let ink = Stroke::new(INK, 0.8);
            drawing.polygon(&arrow, INK, &ink);
            let width = text_width(&text, CUT);
            let left = if x + 10.0 + width < frame.plot.right() { x + 8.0 } else { x - 8.0 - width };
            let area = Area { x: left, y: edge + 7.0 * inward - 0.5 * CUT - 1.0, width, height: CUT + 2.0 };
            drawing.rect(area, PAPER, None);
            drawing.text((left, area.bottom() - 3.0), CUT, Anchor::Start, &text);
        }
    }
}

/// Draws a panel of lines: title, legend (above the plot, so that it hides nothing), axes, lines.
pub(super) fn line_panel(
    drawing: &mut Drawing,
    panel: Area,
    heading: &str,
    x: Axis,
    y: Axis,
    series: &[Series],
) -> Frame {
    let rows = legend_rows(series, panel.width - LEFT - 12.0);
    let frame = Frame { plot: plot_area(panel, rows.len(), 12.0), x, y };
    title(drawing, panel, heading);
    draw_legend(drawing, panel, &rows);
    frame.draw(drawing, true);
    drawing.clipped(frame.plot, |drawing| {
        for series in series {
            draw_series(drawing, &frame, series);
        }
    });
    frame
}

pub(super) fn draw_series(drawing: &mut Drawing, frame: &Frame, series: &Series) {
    if series.marks {
        let ring = Stroke::new(&series.stroke.colour, series.stroke.width);
        for &point in series.points.iter().filter(|p| p.0.is_finite() && p.1.is_finite()) {
            drawing.circle(frame.place(point), 3.5, PAPER, &ring);
        }
        return;
    }
    let points: Vec<_> = series.points.iter().map(|&p| frame.place(p)).collect();
    drawing.named_path(&series.name, &thinned(&points), &series.stroke);
}

/// Returns the points that are visible: of each half px in width, only the first, lowest, highest and last point; all if there are at most 2000.
fn thinned(points: &[(f64, f64)]) -> Vec<(f64, f64)> {
    const ENOUGH: usize = 2000;
    if points.len() <= ENOUGH {
        return points.to_vec();
    }
    let mut kept = Vec::new();
    for column in points.chunk_by(|a, b| (2.0 * a.0).floor() == (2.0 * b.0).floor()) {
        let extreme = |pick: fn(&f64, &f64) -> std::cmp::Ordering| {
            column.iter().enumerate().min_by(|a, b| pick(&a.1.1, &b.1.1)).map_or(0, |(i, _)| i)
        };
        let mut places = vec![0, extreme(f64::total_cmp), extreme(|a, b| b.total_cmp(a)), column.len() - 1];
        places.sort_unstable();
        places.dedup();
        kept.extend(places.into_iter().map(|i| column[i]));
    }
    kept
}

/// Returns the legend entries in rows that fit the width, each entry with its distance from the left.
pub(super) fn legend_rows(series: &[Series], width: f64) -> Vec<Vec<(f64, &Series)>> {
    let mut rows: Vec<Vec<(f64, &Series)>> = Vec::new();
    let mut right = f64::INFINITY;
    for series in series.iter().filter(|s| !s.name.is_empty()) {
        let needed = entry_width(series);
        if right + needed > width {
            rows.push(Vec::new());
            right = 0.0;
        }
        if let Some(row) = rows.last_mut() {
            row.push((right, series));
        }
        right += needed;
    }
    rows
}

fn entry_width(series: &Series) -> f64 {
    46.0 + text_width(&series.name, TICK)
}

pub(super) fn draw_legend(drawing: &mut Drawing, panel: Area, rows: &[Vec<(f64, &Series)>]) {
    for (index, row) in rows.iter().enumerate() {
        let y = panel.y + TOP + LEGEND_ROW * index as f64 + 6.0;
        // A row with long names extends into the margin left of the plot.
        let end = row.last().map_or(0.0, |(place, series)| place + entry_width(series));
        let left = panel.x + LEFT - (LEFT + end - panel.width).clamp(0.0, LEFT);
        for (place, series) in row {
            let x = left + place;
            if series.marks {
                drawing.circle((x + 12.0, y), 3.5, PAPER, &series.stroke);
            } else {
                drawing.line((x, y), (x + 24.0, y), &series.stroke);
            }
            drawing.text((x + 29.0, y + 4.0), TICK, Anchor::Start, &series.name);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn thinning_keeps_every_peak() {
        let mut points: Vec<(f64, f64)> = (0..100_000).map(|i| (f64::from(i) * 0.005, 0.0)).collect();
        points[43_210].1 = 7.0;
        let kept = thinned(&points);
        assert!(kept.len() < 5000 && kept.iter().any(|p| p.1 == 7.0));
    }
}
