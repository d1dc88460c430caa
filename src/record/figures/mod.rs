//! Figures of a run: forces, contact, gauges, residual deformation, energy, rebound.
//!
//! Each figure is one [`Definition`] in `definitions`: its name, its dimension, its description, and its computation
//! from the records of a run. The summary, its JSON, the result file, the table of a sweep and the reference page are
//! made from these definitions.

mod contact;
mod definitions;
mod fragment;
mod groups;
mod profile;
mod records;
mod tally;

use serde::ser::SerializeMap;
use serde::{Serialize, Serializer};

pub use definitions::{Definition, definitions, names};
pub use fragment::Fragments;
pub use profile::ResidualProfile;
pub use records::{Records, SegmentEnd};
pub use tally::{Extreme, Tally};

use crate::units::Dimension;

/// Figures of a run that exist for its scene.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Figures(pub Vec<Group>);

/// Figures of one place, or of the whole bar.
#[derive(Debug, Clone, PartialEq)]
pub struct Group {
    /// Keys of the path to the group: none for the whole bar; "left"; "joints" and "1"; "gauges" and the name of a gauge; ...
    pub path: Vec<String>,
    /// Label in the printed summary.
    pub label: String,
    /// True if the summary prints a line for the group.
    pub in_summary: bool,
    /// Figures in the order of their definitions.
    pub figures: Vec<Figure>,
    /// Profile along the bar, if there is one.
    pub profile: Option<Profile>,
}

/// Values of one quantity along the bar.
#[derive(Debug, Clone, PartialEq)]
pub struct Profile {
    /// Name in the JSON and in the result file.
    pub name: &'static str,
    /// Description for the attribute `long_name`.
    pub description: &'static str,
    /// Dimensionless values from left to right.
    pub values: Vec<f64>,
}

/// Figure with its value.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Figure {
    /// Name in the result file.
    pub name: &'static str,
    /// Dimension of the value.
    pub dimension: Dimension,
    /// Description for the attribute `long_name`.
    pub description: &'static str,
    /// Text before the value in the summary; empty if another line of the summary contains the value.
    pub phrase: &'static str,
    /// Value in SI units.
    pub value: f64,
}

impl Figure {
    /// Returns the name with its unit, as in the JSON and in tables, e.g. `peak_force_N`.
    pub fn key(&self) -> String {
        key(self.name, self.dimension)
    }
}

/// Returns a name with the unit of a dimension.
fn key(name: &str, dimension: Dimension) -> String {
    let unit: String = dimension.si_symbol().replace(['*', '/'], "_").replace('^', "");
    if unit.is_empty() { name.to_owned() } else { format!("{name}_{unit}") }
}

/// Returns the dimension of a figure, given its name with the unit, e.g. `peak_force_N`, or `torque_N_m.0` for one of
/// several. The longest unit with which the name ends determines it; `N_m` denotes a moment.
pub fn dimension_of(key_of_figure: &str) -> Dimension {
    let name = key_of_figure.trim_end_matches(|c: char| c.is_ascii_digit());
    let name = name.strip_suffix('.').unwrap_or(key_of_figure);
    let ending = |dimension: &Dimension| key("", *dimension);
    let fits = |dimension: &&Dimension| name.ends_with(&ending(dimension));
    Dimension::ALL
        .iter()
        .filter(fits)
        .max_by_key(|dimension| ending(dimension).len())
        .copied()
        .unwrap_or(Dimension::None)
}

/// Returns the name of a figure without its unit.
pub fn without_unit(key_of_figure: &str) -> &str {
    let ending = key("", dimension_of(key_of_figure));
    key_of_figure.strip_suffix(ending.as_str()).unwrap_or(key_of_figure)
}

impl Figures {
    /// Returns a figure, given the path of its group and its name with or without the unit, e.g. `peak_force_N`.
    pub fn get(&self, path: &[&str], name: &str) -> Option<f64> {
        let group = self.0.iter().find(|group| group.path == path)?;
        group.figures.iter().find(|figure| figure.name == name || figure.key() == name).map(|figure| figure.value)
    }
}

/// Groups whose paths have the same first `depth` keys.
struct Level<'a> {
    groups: &'a [Group],
    depth: usize,
}

impl Serialize for Level<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let part = |group: &Group| group.path.get(self.depth).cloned();
        let mut map = serializer.serialize_map(None)?;
        for groups in self.groups.chunk_by(|a, b| part(a) == part(b)) {
            if let Some(name) = part(&groups[0]) {
                map.serialize_entry(&name, &Level { groups, depth: self.depth + 1 })?;
                continue;
            }
            for figure in groups.iter().flat_map(|group| &group.figures) {
                map.serialize_entry(&figure.key(), &figure.value)?;
            }
            for profile in groups.iter().filter_map(|group| group.profile.as_ref()) {
                map.serialize_entry(profile.name, &profile.values)?;
            }
        }
        map.end()
    }
}

impl Serialize for Figures {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        Level { groups: &self.0, depth: 0 }.serialize(serializer)
    }
}
