//! Figures 9.3 and 9.4 of the handbook: Hoppmann's functions Phi and Psi over Q for several values of damping, in closed form.
//!
//! `cargo run --release --example hoppmann_figures -- docs/hoppmann.svg`

use std::path::PathBuf;

use barwave::error::Result;
use barwave::impact::phi_psi;
use barwave::report::plot::{Panel, colour, figure_with_legend, layout, legend_line, save};
use kuva::prelude::{LinePlot, Plot};

const DAMPING: [f64; 6] = [0.0, 0.05, 0.1, 0.2, 0.5, 1.0];

fn panel(index: usize, title: &str) -> Panel {
    let line = |(i, beta): (usize, &f64)| {
        let points: Vec<(f64, f64)> =
            (1..=400).map(|k| f64::from(k) / 100.0).map(|q| (q, phi_psi(*beta, q)[index])).collect();
        Plot::Line(LinePlot::new().with_data(points).with_color(colour(i)).with_stroke_width(2.0))
    };
    let plots: Vec<Plot> = DAMPING.iter().enumerate().map(line).collect();
    let layout = layout(&plots, title, "Q = omega tau/(2 pi)", ["Phi", "Psi"][index]);
    Panel { plots, layout }
}

fn main() -> Result<()> {
    let path = std::env::args().nth(1).map_or_else(|| PathBuf::from("hoppmann.svg"), PathBuf::from);
    let panels = vec![panel(0, "Energy function (figure 9.3)"), panel(1, "Damping function (figure 9.4)")];
    let legend = DAMPING.iter().enumerate().map(|(i, beta)| legend_line(&format!("beta = {beta}"), i)).collect();
    save(&path, "Hoppmann's functions", &figure_with_legend(panels, 2, legend))?;
    println!("{}", path.display());
    Ok(())
}
