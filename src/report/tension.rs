//! Figure of a tension-impact study.

use super::display::Unit;
use super::drawing::Picture;
use super::lines::{Line, Panel, Style, figure};
use crate::study::tension::{Point, Results};
use crate::units::{Dimension, Scale, System};

const PERCENT: f64 = 0.01;

/// Impact velocities, relative to the critical velocity, for which the residual strain is drawn.
const PROFILES: [f64; 4] = [0.25, 0.6, 0.95, 1.1];

/// Draws elongation, energy absorbed and place of fracture against impact velocity, with the critical velocity and the elongation at the maximum
/// of the curve, and the residual strain at some velocities.
pub fn draw(results: &Results, units: System) -> Picture {
    let [energy, length] = [Dimension::Energy, Dimension::Length].map(|dimension| units.of_columns(dimension));
    let by_curve = results.static_elongation / PERCENT;
    let energy_label = Unit { factor: 1.0 / energy.si, symbol: energy.symbol }.label("energy absorbed");
    let mut panels = vec![
        against_velocity(results, units, ["elongation at fracture", "elongation (%)"], by_curve, |p| {
            Some(p.elongation? / PERCENT)
        }),
        against_velocity(results, units, ["energy absorbed", &energy_label], 1.0, |p| Some(energy.of(p.energy?))),
        against_velocity(results, units, ["place of fracture", &distance(length)], length.of(results.length_m), |p| {
            Some(length.of(p.fracture_position_m?))
        }),
    ];
    let slow = vec![(0.0, by_curve), (velocity(units).of(last(results)), by_curve)];
    panels[0].lines.push(line(format!("{} curve", results.curve), slow, 2, Style::Dotted));
    if !results.x.is_empty() {
        panels.push(profiles(results, units));
    }
    figure(&format!("Tension impact of {}", results.material), &panels)
}

fn velocity(units: System) -> Scale {
    units.of_columns(Dimension::Velocity)
}

fn distance(unit: Scale) -> String {
    format!("distance from the struck end ({})", unit.symbol)
}

fn last(results: &Results) -> f64 {
    results.points.last().map_or(1.0, |point| point.velocity_m_s)
}

fn line(name: impl Into<String>, points: Vec<(f64, f64)>, colour: usize, style: Style) -> Line {
    Line { name: name.into(), points, colour, style }
}

/// Returns a panel with the points, and the critical velocity of the curve as a vertical line, which ends at `top` if no value lies above zero.
fn against_velocity(
    results: &Results,
    units: System,
    [title, label]: [&str; 2],
    top: f64,
    value: impl Fn(&Point) -> Option<f64>,
) -> Panel {
    let unit = velocity(units);
    let points: Vec<_> = results.points.iter().filter_map(|p| Some((unit.of(p.velocity_m_s), value(p)?))).collect();
    let largest = points.iter().map(|p| p.1).fold(0.0, f64::max);
    let critical = unit.of(results.critical_velocity_m_s);
    let critical = vec![(critical, 0.0), (critical, if largest > 0.0 { largest } else { top })];
    let mut lines = vec![line("critical velocity", critical, 1, Style::Dashed)];
    if !points.is_empty() {
        lines.insert(0, line("simulated", points.clone(), 0, Style::Solid));
        lines.insert(1, line("", points, 0, Style::Marks));
    }
    Panel { title: title.into(), labels: [format!("impact velocity ({})", unit.symbol), label.into()], lines }
}

fn profiles(results: &Results, units: System) -> Panel {
    let (unit, length) = (velocity(units), units.of_columns(Dimension::Length));
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
    let lines = chosen.iter().enumerate().map(|(i, point)| {
        let points = results.x.iter().zip(&point.residual_strain).map(|(x, strain)| (length.of(*x), strain / PERCENT));
        line(format!("{:.1} {}", unit.of(point.velocity_m_s), unit.symbol), points.collect(), i, Style::Solid)
    });
    let labels = [distance(length), "plastic strain (%)".into()];
    Panel { title: "residual strain".into(), labels, lines: lines.collect() }
}
