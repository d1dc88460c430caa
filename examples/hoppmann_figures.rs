//! Draws Figures 9.3 and 9.4 of the handbook: Hoppmann's functions Phi and Psi of Q for several values of damping, in closed form.
//!
//! `cargo run --release --example hoppmann_figures -- docs/hoppmann.svg`

use std::path::PathBuf;

use barwave::error::Result;
use barwave::impact::phi_psi;
use barwave::report::lines::{Line, Panel, Style, figure};
use barwave::report::plot::save;

const DAMPING: [f64; 6] = [0.0, 0.05, 0.1, 0.2, 0.5, 1.0];

fn panel(index: usize, title: &str) -> Panel {
    let line = |(colour, beta): (usize, &f64)| {
        let points = (1..=400).map(|k| f64::from(k) / 100.0).map(|q| (q, phi_psi(*beta, q)[index])).collect();
        Line { name: format!("\u{3b2} = {beta}"), points, colour, style: Style::Solid }
    };
    let lines = DAMPING.iter().enumerate().map(line).collect();
    let labels = ["Q = \u{3c9}\u{3c4}/(2\u{3c0})", ["\u{3a6}", "\u{3a8}"][index]].map(String::from);
    Panel { title: title.into(), labels, lines }
}

fn main() -> Result<()> {
    let path = std::env::args().nth(1).map_or_else(|| PathBuf::from("hoppmann.svg"), PathBuf::from);
    let panels = [panel(0, "energy function (figure 9.3)"), panel(1, "damping function (figure 9.4)")];
    save(&path, "Hoppmann's functions", &figure("Hoppmann's functions", &panels))?;
    println!("{}", path.display());
    Ok(())
}
