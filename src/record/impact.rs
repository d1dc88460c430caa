//! Summary of an impact without waves in a bar.

use std::collections::BTreeMap;

use serde::ser::SerializeMap;
use serde::{Serialize, Serializer};

use crate::impact::{Column, Figure, Solution, Table};

/// Output of `barwave run --json` for an impact scene: the keys of every summary, then the figures of this kind of
/// impact. The name of each figure includes its unit; a figure without a value is null.
#[derive(Debug, Clone, PartialEq)]
pub struct ImpactSummary {
    /// Title of the scene.
    pub scene: String,
    /// Kind of the impact: "energy", "spheres", "plate" or "beam".
    pub method: &'static str,
    /// Result of the impact.
    pub solution: Solution,
    /// Wall time of the whole run, s.
    pub wall_s: f64,
    /// Path of the result file; empty if there is none.
    pub output: String,
}

/// Output of `barwave plan --json` for an impact scene: the results that are known without an integration.
#[derive(Debug, Clone, PartialEq)]
pub struct ImpactPlan {
    /// Title of the scene.
    pub scene: String,
    /// Kind of the impact: "energy", "spheres", "plate" or "beam".
    pub method: &'static str,
    /// Results that are known without an integration.
    pub solution: Solution,
}

/// Returns one map per row, with the same keys as figures.
fn rows(table: &Table) -> Vec<BTreeMap<String, f64>> {
    let count = table.columns.first().map_or(0, |column| column.values.len());
    let key = |c: &Column| Figure::new(c.name, c.dimension, c.long_name, f64::NAN).json_key();
    (0..count).map(|i| table.columns.iter().map(|c| (key(c), c.values[i])).collect()).collect()
}

impl Serialize for ImpactSummary {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut map = serializer.serialize_map(None)?;
        map.serialize_entry("scene", &self.scene)?;
        map.serialize_entry("outcome", self.solution.outcome)?;
        entries(&mut map, self.method, &self.solution)?;
        map.serialize_entry("wall_s", &self.wall_s)?;
        map.serialize_entry("output", &self.output)?;
        map.end()
    }
}

impl Serialize for ImpactPlan {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut map = serializer.serialize_map(None)?;
        map.serialize_entry("scene", &self.scene)?;
        entries(&mut map, self.method, &self.solution)?;
        map.end()
    }
}

/// Writes the keys common to plans and summaries.
fn entries<M: SerializeMap>(map: &mut M, method: &str, solution: &Solution) -> Result<(), M::Error> {
    map.serialize_entry("method", method)?;
    map.serialize_entry("scheme", solution.scheme)?;
    map.serialize_entry("effects", &[(); 0])?;
    for figure in &solution.figures {
        map.serialize_entry(&figure.json_key(), &figure.json_value())?;
    }
    if !solution.gauges.is_empty() {
        let of =
            |figures: &[Figure]| figures.iter().map(|f| (f.json_key(), f.json_value())).collect::<BTreeMap<_, _>>();
        let gauges: BTreeMap<_, _> = solution.gauges.iter().map(|(name, figures)| (name, of(figures))).collect();
        map.serialize_entry("gauges", &gauges)?;
    }
    for (name, flag) in &solution.flags {
        map.serialize_entry(name, flag)?;
    }
    if let Some(contacts) = solution.tables.iter().find(|table| table.path == "contacts") {
        map.serialize_entry("contacts", &rows(contacts))?;
    }
    map.serialize_entry("equation", &solution.equation)?;
    map.serialize_entry("validity", &solution.validity)?;
    map.serialize_entry("notes", &solution.warnings)
}
