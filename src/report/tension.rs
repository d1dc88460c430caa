//! Figure of a tension-impact test.

use super::drawing::Picture;
use super::lines::{Line, Panel, Style, figure};
use crate::study::tension::{Point, Results};

const PERCENT: f64 = 0.01;
const MM: f64 = 1e-3;

/// Velocities, as parts of the critical one, whose residual strain is drawn.
const PROFILES: [f64; 4] = [0.25, 0.6, 0.95, 1.1];

/// Elongation, energy and place of fracture against impact velocity, with the critical velocity and the elongation at the maximum of the curve; and the
/// residual strain at some velocities. SVG text.
pub fn draw(results: &Results) -> Picture {
    let mut panels = vec![
        against_velocity(results, "elongation at fracture", "elongation (%)", |p| Some(p.elongation? / PERCENT)),
        against_velocity(results, "energy absorbed", "energy absorbed (J)", |p| p.energy),
        against_velocity(results, "place of fracture", "distance from the struck end (mm)", |p| {
            Some(p.fracture_position_m? / MM)
        }),
    ];
    let slow = vec![(0.0, results.static_elongation / PERCENT), (last(results), results.static_elongation / PERCENT)];
    panels[0].lines.push(line(format!("{} curve", results.curve), slow, 2, Style::Dotted));
    if !results.x.is_empty() {
        panels.push(profiles(results));
    }
    figure(&format!("Tension impact of {}", results.material), &panels)
}

fn last(results: &Results) -> f64 {
    results.points.last().map_or(1.0, |point| point.velocity_m_s)
}

fn line(name: impl Into<String>, points: Vec<(f64, f64)>, colour: usize, style: Style) -> Line {
    Line { name: name.into(), points, colour, style }
}

/// The points, and the critical velocity of the curve as a vertical line.
fn against_velocity(results: &Results, title: &str, label: &str, value: fn(&Point) -> Option<f64>) -> Panel {
    let points: Vec<_> = results.points.iter().filter_map(|p| Some((p.velocity_m_s, value(p)?))).collect();
    let top = points.iter().map(|p| p.1).fold(f64::MIN_POSITIVE, f64::max);
    let critical = vec![(results.critical_velocity_m_s, 0.0), (results.critical_velocity_m_s, top)];
    let lines = vec![
        line("simulated", points.clone(), 0, Style::Solid),
        line("", points, 0, Style::Marks),
        line("critical velocity", critical, 1, Style::Dashed),
    ];
    Panel { title: title.into(), labels: ["impact velocity (m/s)".into(), label.into()], lines }
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
    let lines = chosen.iter().enumerate().map(|(i, point)| {
        let points = results.x.iter().zip(&point.residual_strain).map(|(x, strain)| (x / MM, strain / PERCENT));
        line(format!("{:.1} m/s", point.velocity_m_s), points.collect(), i, Style::Solid)
    });
    let labels = ["distance from the struck end (mm)", "plastic strain (%)"].map(String::from);
    Panel { title: "residual strain".into(), labels, lines: lines.collect() }
}
