//! The picture of a tension-impact test.

use kuva::prelude::{LinePlot, LineStyle, MarkerShape, Plot, ScatterPlot};

use super::plot::{Panel, colour, figure, layout};
use crate::study::tension::{Point, Results};

const PERCENT: f64 = 0.01;
const MM: f64 = 1e-3;

/// Velocities, as parts of the critical one, whose residual strain is drawn.
const PROFILES: [f64; 4] = [0.25, 0.6, 0.95, 1.1];

/// Elongation, energy and place of fracture against impact velocity, with the critical velocity and the elongation of a slow test; and the
/// residual strain at some velocities. SVG text.
pub fn draw(results: &Results) -> String {
    let mut panels = vec![
        against_velocity(results, "Elongation at fracture", "Elongation (%)", |p| Some(p.elongation? / PERCENT)),
        against_velocity(results, "Energy absorbed", "Energy absorbed (J)", |p| p.energy),
        against_velocity(results, "Place of fracture", "Distance from the struck end (mm)", |p| {
            Some(p.fracture_position_m? / MM)
        }),
    ];
    let slow = [(0.0, results.static_elongation / PERCENT), (last(results), results.static_elongation / PERCENT)];
    panels[0].plots.push(line(slow.to_vec(), "static curve", 2, LineStyle::Dotted));
    if !results.x.is_empty() {
        panels.push(profiles(results));
    }
    figure(panels, 2)
}

fn last(results: &Results) -> f64 {
    results.points.last().map_or(1.0, |point| point.velocity_m_s)
}

fn line(points: Vec<(f64, f64)>, name: &str, i: usize, style: LineStyle) -> Plot {
    let line = LinePlot::new().with_data(points).with_color(colour(i)).with_stroke_width(2.0).with_line_style(style);
    line.with_legend(name).into()
}

/// The points, and the critical velocity of the curve as a vertical line.
fn against_velocity(results: &Results, title: &str, label: &str, value: fn(&Point) -> Option<f64>) -> Panel {
    let points: Vec<_> = results.points.iter().filter_map(|p| Some((p.velocity_m_s, value(p)?))).collect();
    let top = points.iter().map(|p| p.1).fold(f64::MIN_POSITIVE, f64::max);
    let critical = vec![(results.critical_velocity_m_s, 0.0), (results.critical_velocity_m_s, top)];
    let marks = ScatterPlot::new().with_data(points.clone()).with_color(colour(0)).with_size(3.5);
    let plots = vec![
        line(points, "simulated", 0, LineStyle::Solid),
        marks.with_marker(MarkerShape::Circle).into(),
        line(critical, "critical velocity", 1, LineStyle::Dashed),
    ];
    let layout = layout(&plots, title, "Impact velocity (m/s)", label).with_x_axis_min(0.0).with_y_axis_min(0.0);
    Panel { plots, layout }
}

fn profiles(results: &Results) -> Panel {
    let drawn = results.points.iter().filter(|point| !point.residual_strain.is_empty());
    let mut chosen: Vec<&Point> = Vec::new();
    for part in PROFILES {
        let velocity = part * results.critical_velocity_m_s;
        let distance = |p: &&Point| (p.velocity_m_s - velocity).abs();
        if let Some(point) = drawn.clone().min_by(|a, b| distance(a).total_cmp(&distance(b)))
            && !chosen.contains(&point)
        {
            chosen.push(point);
        }
    }
    let plots: Vec<Plot> = chosen
        .iter()
        .enumerate()
        .map(|(i, point)| {
            let points = results.x.iter().zip(&point.residual_strain).map(|(x, strain)| (x / MM, strain / PERCENT));
            line(points.collect(), &format!("{:.1} m/s", point.velocity_m_s), i, LineStyle::Solid)
        })
        .collect();
    let layout = layout(&plots, "Residual strain", "Distance from the struck end (mm)", "Plastic strain (%)");
    Panel { layout: layout.with_x_axis_min(0.0).with_y_axis_min(0.0), plots }
}
