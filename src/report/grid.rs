//! Panels of lines, two in a row.

use super::axes::{Axis, Series, line_panel};
use super::plot::{COLOURS, colour};
use super::svg::{Anchor, Area, Stroke, Svg};

const WIDTH: f64 = 1240.0;
const HEIGHT: f64 = 340.0;
const MARGIN: f64 = 16.0;

const DASHES: [&str; 4] = ["", "7 3", "2 3", "9 3 2 3"];

/// The line of series `i`.
pub(super) fn stroke(i: usize) -> Stroke {
    Stroke::new(colour(i), 1.6).dashed(DASHES[(i / COLOURS.len()) % DASHES.len()])
}

/// A panel and its title.
pub(super) struct Panel {
    pub(super) heading: String,
    pub(super) axes: [String; 2],
    pub(super) series: Vec<Series>,
}

/// The panels with a title above them; zero is on every axis. SVG text.
pub(super) fn draw(title: &str, panels: &[Panel]) -> String {
    let mut svg = Svg::default();
    let width = (WIDTH - 3.0 * MARGIN) / 2.0;
    svg.bold((MARGIN, 26.0), 18.0, Anchor::Start, title);
    for (k, panel) in panels.iter().enumerate() {
        let area = Area {
            x: MARGIN + (width + MARGIN) * (k % 2) as f64,
            y: 40.0 + (HEIGHT + MARGIN) * (k / 2) as f64,
            width,
            height: HEIGHT,
        };
        let all = || panel.series.iter().flat_map(|s| &s.points).filter(|p| p.0.is_finite() && p.1.is_finite());
        let [x, y] = &panel.axes;
        let x = Axis::around(x.as_str(), all().map(|p| p.0).chain([0.0]));
        let y = Axis::around(y.as_str(), all().map(|p| p.1).chain([0.0]));
        let letter = char::from(b'a' + k as u8);
        line_panel(&mut svg, area, &format!("({letter})  {}", panel.heading), x, y, &panel.series);
    }
    svg.document(WIDTH, 40.0 + (HEIGHT + MARGIN) * panels.len().div_ceil(2) as f64)
}
