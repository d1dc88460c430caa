//! Axes: ticks at round numbers, frames, labels, legends, lines.

use super::svg::{Anchor, Area, Stroke, Svg, text_width};

/// Text sizes, px.
const TICK: f64 = 12.0;
const LABEL: f64 = 13.0;
const TITLE: f64 = 14.5;
/// Room around the plot of a panel, px.
const LEFT: f64 = 72.0;
const BOTTOM: f64 = 46.0;
const TOP: f64 = 26.0;
const LEGEND_ROW: f64 = 18.0;

/// An axis, linear or logarithmic.
#[derive(Debug, Clone)]
pub(super) struct Axis {
    pub label: String,
    pub low: f64,
    pub high: f64,
    logarithmic: bool,
}

impl Axis {
    /// An axis from `low` to `high`; where that is no length (one frame, nothing but zeros) it is one unit long.
    pub fn new(label: impl Into<String>, low: f64, high: f64) -> Self {
        let high = if high - low > 1e-290 { high } else { low + 1.0 };
        Self { label: label.into(), low, high, logarithmic: false }
    }

    /// A logarithmic axis from `low` to `high`, 0 < low < high.
    pub fn logarithmic(label: impl Into<String>, low: f64, high: f64) -> Self {
        Self { label: label.into(), low, high, logarithmic: true }
    }

    /// Part of the axis below a value.
    fn part(&self, value: f64) -> f64 {
        if self.logarithmic {
            return (value / self.low).ln() / (self.high / self.low).ln();
        }
        (value - self.low) / (self.high - self.low)
    }

    /// Ticks with their labels, and the power of ten taken out of these.
    fn labelled(&self, count: usize) -> (Vec<(f64, String)>, i32) {
        if self.logarithmic {
            let [first, last] = [self.low.log10().ceil() as i32, self.high.log10().floor() as i32];
            let decade = |power: i32| (10_f64.powi(power), format!("10{}", superscript(power)));
            return ((first..=last).map(decade).collect(), 0);
        }
        let (ticks, step, power) = self.ticks(count);
        (ticks.into_iter().map(|tick| (tick, tick_label(tick, step, power))).collect(), power)
    }

    /// An axis that holds all values with a little room; a single value gets room around it.
    pub fn around(label: impl Into<String>, values: impl Iterator<Item = f64>) -> Self {
        let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
        for value in values.filter(|v| v.is_finite()) {
            (low, high) = (low.min(value), high.max(value));
        }
        if low > high {
            (low, high) = (0.0, 1.0);
        }
        let size = low.abs().max(high.abs());
        let room = if high - low > 1e-12 * size {
            0.05 * (high - low)
        } else if size > 1e-280 {
            0.5 * size
        } else {
            1.0
        };
        Self::new(label, low - room, high + room)
    }

    /// Round tick values, about `count` of them, and the power of ten taken out of their labels.
    fn ticks(&self, count: usize) -> (Vec<f64>, f64, i32) {
        let step = round_step((self.high - self.low) / count as f64);
        let first = (self.low / step - 1e-9).ceil() as i64;
        let last = (self.high / step + 1e-9).floor() as i64;
        let ticks = (first..=last).map(|i| i as f64 * step).collect();
        let size = self.low.abs().max(self.high.abs());
        let power = size.log10().floor() as i32;
        (ticks, step, if (-3..5).contains(&power) { 0 } else { power.div_euclid(3) * 3 })
    }

    fn full_label(&self, power: i32) -> String {
        if power == 0 { self.label.clone() } else { format!("{}  \u{d7}10{}", self.label, superscript(power)) }
    }
}

/// 1, 2 or 5 times a power of ten, at least `raw`.
fn round_step(raw: f64) -> f64 {
    let power = 10_f64.powi(raw.log10().floor() as i32);
    [1.0, 2.0, 5.0, 10.0].iter().map(|m| m * power).find(|step| *step >= raw * 0.999).unwrap_or(10.0 * power)
}

/// A tick's label: as many decimals as the step needs.
fn tick_label(value: f64, step: f64, power: i32) -> String {
    let scale = 10_f64.powi(-power);
    let decimals = (-(step * scale).log10().floor()).clamp(0.0, 12.0) as usize;
    let text = format!("{:.decimals$}", value * scale);
    // A minus before zero comes from rounding; the typographic minus is as wide as a digit.
    let zero = text.trim_start_matches('-').chars().all(|c| c == '0' || c == '.');
    if zero { text.trim_start_matches('-').into() } else { text.replace('-', "\u{2212}") }
}

pub(super) fn superscript(power: i32) -> String {
    let digits = [
        '\u{2070}', '\u{b9}', '\u{b2}', '\u{b3}', '\u{2074}', '\u{2075}', '\u{2076}', '\u{2077}', '\u{2078}',
        '\u{2079}',
    ];
    power.to_string().chars().map(|c| c.to_digit(10).map_or('\u{207b}', |d| digits[d as usize])).collect()
}

/// A line with its name for the legend; an empty name has no entry.
#[derive(Debug, Clone)]
pub(super) struct Series {
    pub name: String,
    pub points: Vec<(f64, f64)>,
    pub stroke: Stroke,
    /// Circles instead of a line.
    pub marks: bool,
}

impl Series {
    pub fn line(name: impl Into<String>, points: Vec<(f64, f64)>, stroke: Stroke) -> Self {
        Self { name: name.into(), points, stroke, marks: false }
    }

    pub fn marks(name: impl Into<String>, points: Vec<(f64, f64)>, stroke: Stroke) -> Self {
        Self { name: name.into(), points, stroke, marks: true }
    }
}

/// A framed plot: where it stands and its axes.
#[derive(Debug, Clone)]
pub(super) struct Frame {
    pub plot: Area,
    pub x: Axis,
    pub y: Axis,
}

impl Frame {
    /// Where a point stands.
    pub fn place(&self, (x, y): (f64, f64)) -> (f64, f64) {
        let (across, up) = (self.x.part(x), self.y.part(y));
        (self.plot.x + across * self.plot.width, self.plot.bottom() - up * self.plot.height)
    }

    /// Border, ticks and labels; grid lines where asked for.
    pub fn draw(&self, svg: &mut Svg, grid: bool) {
        let (ticks, power) = self.x.labelled((self.plot.width / 62.0).max(2.0) as usize);
        let grid_line = Stroke::new("#e4e4e4", 1.0);
        let tick_line = Stroke::new("#222", 1.0);
        for (tick, label) in ticks {
            let (x, bottom) = (self.place((tick, self.y.low)).0, self.plot.bottom());
            if grid {
                svg.line((x, self.plot.y), (x, bottom), &grid_line);
            }
            svg.line((x, bottom), (x, bottom + 5.0), &tick_line);
            svg.text((x, bottom + 18.0), TICK, Anchor::Middle, &label);
        }
        let middle = self.plot.x + self.plot.width / 2.0;
        svg.text((middle, self.plot.bottom() + 38.0), LABEL, Anchor::Middle, &self.x.full_label(power));
        self.draw_upright_axis(svg, grid.then_some(&grid_line), &tick_line);
        svg.rect(self.plot, "none", Some(&tick_line));
    }

    fn draw_upright_axis(&self, svg: &mut Svg, grid: Option<&Stroke>, tick_line: &Stroke) {
        let (ticks, power) = self.y.labelled((self.plot.height / 36.0).max(2.0) as usize);
        for (tick, label) in ticks {
            let y = self.place((self.x.low, tick)).1;
            if let Some(grid) = grid {
                svg.line((self.plot.x, y), (self.plot.right(), y), grid);
            }
            svg.line((self.plot.x - 5.0, y), (self.plot.x, y), tick_line);
            svg.text((self.plot.x - 8.0, y + 4.0), TICK, Anchor::End, &label);
        }
        let middle = self.plot.y + self.plot.height / 2.0;
        svg.upright((self.plot.x - LEFT + 14.0, middle), LABEL, &self.y.full_label(power));
    }
}

impl Frame {
    /// The upright axis on the right side, for a colour bar.
    pub fn draw_right(&self, svg: &mut Svg) {
        let stroke = Stroke::new("#222", 1.0);
        let mut widest = 0.0_f64;
        let (ticks, power) = self.y.labelled((self.plot.height / 36.0).max(2.0) as usize);
        for (tick, text) in ticks {
            let (x, y) = (self.plot.right(), self.place((self.x.low, tick)).1);
            svg.line((x, y), (x + 5.0, y), &stroke);
            widest = widest.max(text_width(&text, TICK));
            svg.text((x + 8.0, y + 4.0), TICK, Anchor::Start, &text);
        }
        let middle = self.plot.y + self.plot.height / 2.0;
        svg.upright((self.plot.right() + widest + 26.0, middle), LABEL, &self.y.full_label(power));
        svg.rect(self.plot, "none", Some(&stroke));
    }
}

/// The plot of a panel: what is left when titles, legend rows and axis labels have their room.
pub(super) fn plot_area(panel: Area, legend_rows: usize, right: f64) -> Area {
    let top = TOP + LEGEND_ROW * legend_rows as f64;
    Area { x: panel.x + LEFT, y: panel.y + top, width: panel.width - LEFT - right, height: panel.height - top - BOTTOM }
}

/// Title above the plot.
pub(super) fn title(svg: &mut Svg, panel: Area, text: &str) {
    svg.bold((panel.x + LEFT, panel.y + 16.0), TITLE, Anchor::Start, text);
}

/// Draws a whole panel of lines: title, legend above the plot (nothing can lie under it), axes, lines.
pub(super) fn line_panel(svg: &mut Svg, panel: Area, heading: &str, x: Axis, y: Axis, series: &[Series]) {
    let rows = legend_rows(series, panel.width - LEFT - 12.0);
    let frame = Frame { plot: plot_area(panel, rows.len(), 12.0), x, y };
    title(svg, panel, heading);
    draw_legend(svg, panel, &rows);
    frame.draw(svg, true);
    svg.clipped(frame.plot, |svg| {
        for series in series {
            draw_series(svg, &frame, series);
        }
    });
}

pub(super) fn draw_series(svg: &mut Svg, frame: &Frame, series: &Series) {
    if series.marks {
        let ring = Stroke::new(&series.stroke.colour, series.stroke.width);
        for &point in series.points.iter().filter(|p| p.0.is_finite() && p.1.is_finite()) {
            svg.circle(frame.place(point), 3.5, "white", &ring);
        }
        return;
    }
    let points: Vec<_> = series.points.iter().map(|&p| frame.place(p)).collect();
    svg.path(&thinned(&points), &series.stroke);
}

/// Points for the eye: where many fall into one column of pixels, its first, lowest, highest and last stay.
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

/// Legend entries broken into rows that fit the width, each with its place from the left.
fn legend_rows(series: &[Series], width: f64) -> Vec<Vec<(f64, &Series)>> {
    let mut rows: Vec<Vec<(f64, &Series)>> = Vec::new();
    let mut right = f64::INFINITY;
    for series in series.iter().filter(|s| !s.name.is_empty()) {
        let needed = 46.0 + text_width(&series.name, TICK);
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

fn draw_legend(svg: &mut Svg, panel: Area, rows: &[Vec<(f64, &Series)>]) {
    for (index, row) in rows.iter().enumerate() {
        let y = panel.y + TOP + LEGEND_ROW * index as f64 + 6.0;
        for (place, series) in row {
            let x = panel.x + LEFT + place;
            if series.marks {
                svg.circle((x + 12.0, y), 3.5, "white", &series.stroke);
            } else {
                svg.line((x, y), (x + 24.0, y), &series.stroke);
            }
            svg.text((x + 29.0, y + 4.0), TICK, Anchor::Start, &series.name);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ticks_are_round_and_inside() {
        let (ticks, step, power) = Axis::new("", -0.3, 612.0).ticks(6);
        assert_eq!((step, power), (200.0, 0));
        assert_eq!(ticks, [0.0, 200.0, 400.0, 600.0]);
    }

    #[test]
    fn small_numbers_give_their_power_to_the_label() {
        let axis = Axis::new("residual", -2e-15, 3e-15);
        let (ticks, step, power) = axis.ticks(5);
        assert_eq!(power, -15);
        let labels: Vec<_> = ticks.iter().map(|t| tick_label(*t, step, power)).collect();
        assert_eq!(labels, ["\u{2212}2", "\u{2212}1", "0", "1", "2", "3"]);
        assert_eq!(axis.full_label(power), "residual  \u{d7}10\u{207b}\u{b9}\u{2075}");
    }

    #[test]
    fn one_value_gets_an_axis_around_it() {
        for value in [0.0, 5.0, -3e8] {
            let axis = Axis::around("", [value, value].into_iter());
            assert!(axis.low < value && value < axis.high);
            assert!(!axis.ticks(5).0.is_empty());
        }
        assert!(!Axis::around("", std::iter::empty()).ticks(5).0.is_empty());
    }

    #[test]
    fn thinning_keeps_every_peak() {
        let mut points: Vec<(f64, f64)> = (0..100_000).map(|i| (f64::from(i) * 0.005, 0.0)).collect();
        points[43_210].1 = 7.0;
        let kept = thinned(&points);
        assert!(kept.len() < 5000 && kept.iter().any(|p| p.1 == 7.0));
    }
}
