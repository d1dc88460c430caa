//! Critical velocity of annealed copper, and a bar pulled below it. README.md shows this file; `tests/docs` runs it.

use std::ops::ControlFlow;
use std::path::Path;

use barwave::error::Result;
use barwave::material::{Sense, library};
use barwave::{record::Field, run, scene::Scene, study::critical::critical};

pub(crate) fn main() -> Result<()> {
    let copper = library::find("copper-annealed", Path::new(""))?;
    println!("critical velocity: {:?} m/s", critical(&copper, Sense::Tension).critical_velocity_m_s);

    let scene = Scene::builder()
        .set("bar.length", "1 m")
        .set("bar.material", "copper-annealed")
        .set("left.kind", "velocity")
        .set("left.value", "-60 m/s")
        .set("right.kind", "free")
        .set("solve.until", "200 us")
        .build()?;
    let solution = run::solve(&scene, &mut |_| ControlFlow::Continue(()))?;
    let strain = solution.last(Field::Strain).expect("recorded unless `fields` leaves it out");
    println!("strain behind the fronts at 60 m/s: {:.4}", strain[10]);
    Ok(())
}
