//! The figures of a run: forces, contact, gauges, residual deformation, energy, rebound.
//!
//! Each figure is one [`Definition`] in `definitions`: its name, dimension, description, and how it follows from the records of a run. The
//! summary, its JSON, the result file, the table of a sweep and the reference page are made from these.

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

/// The figures of a run, those that exist for its scene.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Figures(pub Vec<Group>);

/// Figures of one place, or of the whole bar.
#[derive(Debug, Clone, PartialEq)]
pub struct Group {
    /// Keys that lead to it: none for the whole bar, "left", "joints" and "1", "gauges" and the name of a gauge, ...
    pub path: Vec<String>,
    /// For people.
    pub label: String,
    /// It has results worth a line of the summary.
    pub tells: bool,
    /// In the order of the definitions.
    pub figures: Vec<Figure>,
    /// Values along the bar.
    pub profile: Option<Profile>,
}

/// Values of one kind along the bar.
#[derive(Debug, Clone, PartialEq)]
pub struct Profile {
    /// As in the JSON and in the result file.
    pub name: &'static str,
    /// For the attribute `long_name`.
    pub description: &'static str,
    /// Without a unit, from the left.
    pub values: Vec<f64>,
}

/// A figure with its value.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Figure {
    /// As in the result file.
    pub name: &'static str,
    /// Its unit.
    pub dimension: Dimension,
    /// For the attribute `long_name`.
    pub description: &'static str,
    /// Text before the value; empty if another line of the summary has it.
    pub phrase: &'static str,
    /// SI.
    pub value: f64,
}

impl Figure {
    /// Name with its unit, as in the JSON and in tables: `peak_force_N`.
    pub fn key(&self) -> String {
        key(self.name, self.dimension)
    }
}

/// A name with its unit.
fn key(name: &str, dimension: Dimension) -> String {
    let unit: String = dimension.si_symbol().replace(['*', '/'], "_").replace('^', "");
    if unit.is_empty() { name.to_owned() } else { format!("{name}_{unit}") }
}

/// The dimension of a figure by its name with the unit (`peak_force_N`, of one of several `torque_N_m.0`): that of the longest unit with which it
/// ends, and of `N_m` the moment.
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

/// The name of a figure without its unit.
pub fn without_unit(key_of_figure: &str) -> &str {
    let ending = key("", dimension_of(key_of_figure));
    key_of_figure.strip_suffix(ending.as_str()).unwrap_or(key_of_figure)
}

impl Figures {
    /// A figure by the path of its group and its name, with its unit (`peak_force_N`) or without.
    pub fn get(&self, path: &[&str], name: &str) -> Option<f64> {
        let group = self.0.iter().find(|group| group.path == path)?;
        group.figures.iter().find(|figure| figure.name == name || figure.key() == name).map(|figure| figure.value)
    }
}

/// Groups that have the first parts of their paths in common.
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
