//! Critical velocity of annealed copper, and a run below it. README.md shows this file; `tests/docs` runs it.

use std::ops::ControlFlow;
use std::path::Path;

use barwave::error::Result;
use barwave::material::{Sense, library};
use barwave::{run, scene::Scene, study::critical::critical};

pub(crate) fn main() -> Result<()> {
    let copper = library::find("copper-annealed", Path::new(""))?;
    println!("critical velocity: {:?} m/s", critical(&copper, Sense::Tension).critical_velocity_m_s);

    let changes = ["left.value=\"-60 m/s\"".to_owned()];
    let scene = Scene::read(Path::new("runs/copper-below-critical.toml"), &changes)?;
    let summary = run::run(&scene, None, &mut |_| ControlFlow::Continue(()))?;
    println!("strain behind the fronts at 60 m/s: {:.4}", summary.left.strain);
    Ok(())
}
