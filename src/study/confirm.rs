//! A critical velocity put to the test: a bar driven a little below and a little above it.

use std::sync::Arc;

use serde::Serialize;

use super::critical::CriticalRow;
use crate::assemble;
use crate::bar::{Bar, EndCondition, History, Segment};
use crate::material::Material;
use crate::record::{Compression, Field, Precision};
use crate::scene::{Effects, Method, Record, Scene, Solve, Unloading};
use crate::solver::fd::Quantity;
use crate::text_file::NamedFiles;

/// Cells of the bar.
const CELLS: usize = 1000;

/// How far from the critical velocity the bar is driven, as a share of it: far enough for the strain at the struck end
/// of the faster bar to run away within one transit of the elastic wave, near enough to say something.
const ASIDE: f64 = 0.05;

/// The bar below and above the critical velocity.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Confirmation {
    /// 5 % below.
    pub below: Driven,
    /// 5 % above.
    pub above: Driven,
    /// The bar holds below and breaks above.
    pub confirmed: bool,
}

/// A bar driven at one velocity for one transit of the elastic wave.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Driven {
    /// Velocity of the struck end, m/s.
    pub velocity_m_s: f64,
    /// Largest strain of the four cells next to the struck end after the run, magnitude.
    pub strain_at_end: f64,
    /// The strain has gone past the one on which the critical velocity rests.
    pub breaks: bool,
}

/// Simulates a bar 5 % below and 5 % above its critical velocity; none where the row has none.
pub fn confirm(material: &Material, row: &CriticalRow) -> Option<Confirmation> {
    let (velocity, limit) = (row.critical_velocity_m_s?, row.strain_at_max?);
    let material = Arc::new(material.clone());
    let below = drive(&material, row, (1.0 - ASIDE) * velocity, limit);
    let above = drive(&material, row, (1.0 + ASIDE) * velocity, limit);
    Some(Confirmation { below, above, confirmed: !below.breaks && above.breaks })
}

fn drive(material: &Arc<Material>, row: &CriticalRow, velocity: f64, limit: f64) -> Driven {
    // Pulling the left end in -x is tension.
    let scene = scene(material, -row.sense.sign() * velocity);
    let mut bar = assemble::leapfrog(&scene, CELLS, 1.0);
    bar.advance_by(bar.grid().steps_to(scene.solve.until));
    // Strain that the waves cannot carry away stays in the first cells.
    let strain = (0..4).map(|cell| bar.value(Quantity::Strain, cell).abs()).fold(0.0, f64::max);
    Driven { velocity_m_s: velocity, strain_at_end: strain, breaks: strain > limit }
}

/// A long bar at rest whose left end is driven at a constant velocity, until the elastic wave has crossed it once.
fn scene(material: &Arc<Material>, velocity: f64) -> Scene {
    let segment = Segment::new(1.0, 1.0, Arc::clone(material));
    let until = segment.length / material.c0();
    Scene {
        title: format!("{} at {velocity} m/s", material.name),
        name: material.name.clone(),
        path: None,
        text: String::new(),
        overrides: Vec::new(),
        bar: Bar { segments: vec![segment], area_given: false },
        left: EndCondition::Velocity { history: History::constant(velocity), release: None },
        right: EndCondition::Free,
        effects: Effects { unloading: Some(Unloading::Isotropic), ..Effects::default() },
        auto: None,
        base: std::path::PathBuf::new(),
        files: NamedFiles::default(),
        solve: Solve {
            until,
            method: Method::Leapfrog { cells: CELLS, cfl: 1.0 },
            audit_tolerance: Solve::AUDIT_TOLERANCE,
            tolerance: None,
            estimate_error: false,
        },
        record: Record {
            times: vec![until],
            cells: None,
            paths: false,
            fields: vec![Field::Stress],
            gauges: Vec::new(),
            precision: Precision::F64,
            compression: Compression::None,
        },
        discretized: None,
        torsion: None,
    }
}
