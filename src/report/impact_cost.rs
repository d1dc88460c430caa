//! Figure of a cost study of an impact: error against the number of modes and against the number of steps, on logarithmic axes.

use super::axis::Axis;
use super::drawing::{Anchor, Area, Drawing, Picture, Stroke};
use super::panel::{Series, line_panel};
use super::plot::colour;
use crate::study::impact_cost::{ImpactCost, ImpactPoint};

const WIDTH: f64 = 520.0;
const HEIGHT: f64 = 380.0;

/// Draws one panel for each parameter that was varied.
pub fn figure(cost: &ImpactCost) -> Picture {
    let mut drawing = Drawing::default();
    drawing.bold((18.0, 28.0), 19.0, Anchor::Start, &cost.scene);
    drawing.text((18.0, 50.0), 13.0, Anchor::Start, &format!("error against {}", cost.reference));
    let mut x = 18.0;
    for (i, varied) in ["modes", "steps"].into_iter().enumerate() {
        let own: Vec<&ImpactPoint> = cost.points.iter().filter(|p| p.varied == varied && p.error > 0.0).collect();
        if own.is_empty() {
            continue;
        }
        let place = |p: &ImpactPoint| {
            let count = if varied == "modes" { p.modes.unwrap_or(1) } else { p.steps };
            (count as f64, p.error)
        };
        let points: Vec<(f64, f64)> = own.iter().map(|p| place(p)).collect();
        let across = Axis::logarithmic_around(format!("number of {varied}"), points.iter().map(|p| p.0));
        let up = Axis::logarithmic_around("error", points.iter().map(|p| p.1));
        let series = [
            Series::line("", points.clone(), Stroke::new(colour(i), 1.6)),
            Series::marks("", points, Stroke::new(colour(i), 1.6)),
        ];
        let panel = Area { x, y: 64.0, width: WIDTH, height: HEIGHT };
        line_panel(&mut drawing, panel, &format!("error against {varied}"), across, up, &series);
        x += WIDTH + 22.0;
    }
    drawing.finish(x, HEIGHT + 82.0)
}
