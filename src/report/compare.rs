//! The picture of a comparison of materials.

use kuva::prelude::{BarPlot, LegendEntry, LegendShape, LinePlot, LineStyle, MarkerShape, Plot, ScatterPlot};

use super::plot::{Panel, colour, figure_with_legend, layout, legend_line, line_style};
use crate::study::compare::Compared;

const MPA: f64 = 1e6;
const PERCENT: f64 = 0.01;

/// Curves, front speeds and impact velocities against strain, the ultimate points marked; and critical velocities
/// where there are several. SVG text.
pub fn figure(materials: &[Compared]) -> String {
    let mut panels = vec![curves(materials), speeds(materials), velocities(materials)];
    let mut legend: Vec<_> = materials.iter().enumerate().map(|(i, m)| legend_line(&m.critical.material, i)).collect();
    let critical = materials.iter().filter(|m| m.critical.critical_velocity_m_s.is_some()).count();
    if critical > 0 {
        let shape = LegendShape::Marker(MarkerShape::Circle);
        legend.push(LegendEntry { label: "critical".into(), color: "#444444".into(), shape, dasharray: None });
    }
    if critical > 1 {
        panels.push(critical_velocities(materials));
    }
    let columns = if panels.len() == 3 { 3 } else { 2 };
    figure_with_legend(panels, columns, legend)
}

fn line(points: Vec<(f64, f64)>, i: usize, style: LineStyle) -> Plot {
    LinePlot::new().with_data(points).with_color(colour(i)).with_stroke_width(2.0).with_line_style(style).into()
}

fn mark(point: (f64, f64), i: usize) -> Plot {
    let mark = ScatterPlot::new().with_data(vec![point]).with_color(colour(i)).with_size(5.0);
    mark.with_marker(MarkerShape::Circle).into()
}

/// Curves, dotted past the ultimate point.
fn curves(materials: &[Compared]) -> Panel {
    let mut plots = Vec::new();
    for (i, m) in materials.iter().enumerate() {
        let end = m.critical.strain_at_max.unwrap_or(f64::INFINITY);
        let points = |keep: &dyn Fn(f64) -> bool| -> Vec<_> {
            let kept = m.curve.iter().filter(|p| keep(p.strain));
            kept.map(|p| (p.strain / PERCENT, p.stress_pa / MPA)).collect()
        };
        plots.push(line(points(&|strain| strain <= end), i, line_style(i)));
        plots.push(line(points(&|strain| strain >= end), i, LineStyle::Dotted));
    }
    for (i, m) in materials.iter().enumerate() {
        if let (Some(strain), Some(stress)) = (m.critical.strain_at_max, m.critical.stress_at_max_pa) {
            plots.push(mark((strain / PERCENT, stress / MPA), i));
        }
    }
    let layout = layout(&plots, "Stress-strain curves", "Engineering strain (%)", "Engineering stress (MPa)");
    Panel { layout: layout.with_x_axis_min(0.0).with_y_axis_min(0.0), plots }
}

/// Speeds of the fronts as a staircase, on a logarithmic scale down to a thousandth of the fastest.
fn speeds(materials: &[Compared]) -> Panel {
    let fastest = materials.iter().map(|m| m.elastic_speed_m_s).fold(0.0, f64::max);
    let mut plots = Vec::new();
    for (i, m) in materials.iter().enumerate() {
        let fronts = m.fronts.iter().filter(|front| front.speed > 1e-3 * fastest);
        let stairs = fronts.flat_map(|f| [(f.strain_ahead, f.speed), (f.strain_behind, f.speed)]);
        plots.push(line(stairs.map(|(e, c)| (e / PERCENT, c)).collect(), i, line_style(i)));
    }
    let layout = layout(&plots, "Plastic wave speed", "Engineering strain (%)", "Front speed (m/s)");
    Panel { layout: layout.with_log_y().with_x_axis_min(0.0), plots }
}

fn velocities(materials: &[Compared]) -> Panel {
    let mut plots = Vec::new();
    for (i, m) in materials.iter().enumerate() {
        let points = m.loading.iter().map(|p| (p.strain / PERCENT, p.impact_velocity_m_s));
        plots.push(line(points.collect(), i, line_style(i)));
    }
    for (i, m) in materials.iter().enumerate() {
        if let (Some(strain), Some(velocity)) = (m.critical.strain_at_max, m.critical.critical_velocity_m_s) {
            plots.push(mark((strain / PERCENT, velocity), i));
        }
    }
    let layout = layout(&plots, "Impact velocity", "Engineering strain (%)", "Impact velocity (m/s)");
    Panel { layout: layout.with_x_axis_min(0.0).with_y_axis_min(0.0), plots }
}

fn critical_velocities(materials: &[Compared]) -> Panel {
    let mut bars = BarPlot::new().with_width(0.6);
    for (i, m) in materials.iter().enumerate() {
        if let Some(velocity) = m.critical.critical_velocity_m_s {
            bars = bars.with_colored_bar(m.critical.material.clone(), velocity, colour(i));
        }
    }
    let plots: Vec<Plot> = vec![bars.into()];
    let layout = layout(&plots, "Critical impact velocity", "", "Critical impact velocity (m/s)");
    let slanted = if materials.len() > 2 { layout.with_x_tick_rotate(-30.0) } else { layout };
    Panel { layout: slanted, plots }
}
