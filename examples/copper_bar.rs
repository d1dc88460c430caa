//! A copper bar pulled below its critical velocity. README.md shows this file; `tests/docs` runs it.

use barwave::{error::Result, record::Field, run, scene::Scene};

pub(crate) fn main() -> Result<()> {
    let scene = Scene::builder()
        .set("bar.length", "1 m")
        .set("bar.material", "copper-annealed")
        .set("left.kind", "velocity")
        .set("left.value", "-60 m/s")
        .set("right.kind", "free")
        .set("solve.until", "200 us")
        .build()?;
    let solution = run::solution(&scene)?;
    println!("critical velocity: {:?} m/s", solution.summary.critical_velocity);
    let strain = solution.last(Field::Strain).expect("recorded unless `fields` leaves it out");
    println!("strain behind the fronts at 60 m/s: {:.4}", strain[10]);
    Ok(())
}
