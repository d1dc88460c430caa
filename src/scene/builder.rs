//! Scenes that are built in a program, key by key.

use std::path::{Path, PathBuf};

use toml::{Table, Value};

use super::{IntoValue, Scene};
use crate::error::{InputError, Result};

/// Builder of a scene from keys and values, which are checked like those of a scene file: numbers are in SI units, strings may contain a unit.
#[derive(Debug, Clone, Default)]
pub struct SceneBuilder {
    table: Table,
    folder: PathBuf,
    /// First key that could not be set, with the reason.
    blocked: Option<(String, String)>,
}

impl SceneBuilder {
    /// Sets a key by its path in the scene file, such as `bar.length` or `left.kind`, and creates missing tables. An existing value is replaced. An
    /// item of a list is addressed by its index from 0, as for [`Scene::with`]: `bar.segment.0.length`. A key in a table with the next index appends
    /// this table to the list.
    #[must_use]
    pub fn set(mut self, key: &str, value: impl IntoValue) -> Self {
        let parts: Vec<&str> = key.split('.').map(str::trim).collect();
        let [first, inside @ ..] = parts.as_slice() else { return self };
        if let Err(why) = put(entry(&mut self.table, first), inside, value.into_value()) {
            self.blocked.get_or_insert_with(|| (key.to_owned(), why));
        }
        self
    }

    /// Sets the folder to which paths of materials and histories are relative; by default the current folder.
    #[must_use]
    pub fn folder(mut self, folder: &Path) -> Self {
        folder.clone_into(&mut self.folder);
        self
    }

    /// Checks the scene.
    ///
    /// # Errors
    /// As for [`Scene::read`], with lines of the scene as it would be written to a file; an [`InputError`] if a key was set inside a value that is
    /// not a table.
    pub fn build(self) -> Result<Scene> {
        if let Some((key, why)) = self.blocked {
            return Err(InputError::new(why).key(key).help("set either a table or list, or the keys in it").into());
        }
        let text = toml::to_string(&self.table)
            .map_err(|e| InputError::new(format!("these keys do not form a scene: {e}")))?;
        Scene::parse("scene", &text, &self.folder, &[])
    }
}

/// Returns the value of a key; inserts an empty table if there is none.
fn entry<'a>(table: &'a mut Table, key: &str) -> &'a mut Value {
    table.entry(key).or_insert_with(|| Value::Table(Table::new()))
}

/// Sets the value at the remaining parts of a key; returns the reason if there is no such position.
fn put(at: &mut Value, parts: &[&str], value: Value) -> std::result::Result<(), String> {
    let [part, inside @ ..] = parts else {
        *at = value;
        return Ok(());
    };
    let of_table = !inside.is_empty();
    if of_table && *part == "0" && at.as_table().is_some_and(Table::is_empty) {
        *at = Value::Array(Vec::new());
    }
    match at {
        Value::Table(table) => put(entry(table, part), inside, value),
        Value::Array(list) => {
            let count = list.len();
            let number = part.parse().unwrap_or(usize::MAX);
            if of_table && number == count {
                list.push(Value::Table(Table::new()));
            }
            let item = list.get_mut(number);
            let item = item.ok_or_else(|| format!("there is no item {part}: the list has {count}, counted from 0"))?;
            put(item, inside, value)
        }
        _ => Err(format!("`{part}` lies inside a key that has a value of its own")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn pulled() -> SceneBuilder {
        Scene::builder()
            .set("bar.length", "1 m")
            .set("bar.material", "copper-annealed")
            .set("left.kind", "velocity")
            .set("left.value", -15.0)
            .set("right.kind", "free")
            .set("solve.until", 1e-4)
    }

    #[test]
    fn a_scene_is_that_of_the_same_file() {
        let text = "[bar]\nlength = 1\nmaterial = \"copper-annealed\"\n[left]\nkind = \"velocity\"\nvalue = -15\n\
                    [right]\nkind = \"free\"\n[solve]\nuntil = 1e-4\n";
        let written = Scene::parse("scene", text, Path::new(""), &[]).expect("a right scene");
        assert_eq!(pulled().build().expect("a right scene").resolved_json(), written.resolved_json());
    }

    #[test]
    fn wrong_keys_are_explained() {
        let message = |builder: SceneBuilder| builder.build().expect_err("wrong").to_string();
        assert!(message(pulled().set("bar.length", -1.0)).contains("bar.length"));
        assert!(message(pulled().set("left.kind.value", 1.0)).contains("lies inside a key"));
        let listed = || pulled().set("record.times", vec![0.0, 1e-4]);
        assert!(message(listed().set("record.times.2", 1e-4)).contains("the list has 2"));
        assert_eq!(listed().set("record.times.0", 5e-5).build().expect("right").record.times, [5e-5, 1e-4]);
        assert!(message(pulled().set("left.value", f64::NAN)).contains("`left.value`: NaN"));
        assert!(message(pulled().set("solve.cells", usize::MAX)).contains("`solve.cells`"));
    }

    #[test]
    fn lists_of_tables_grow_by_their_numbers() {
        let scene = Scene::builder()
            .set("bar.segment.0.length", 0.5)
            .set("bar.segment.0.area", 1e-4)
            .set("bar.segment.0.material", "mild-steel")
            .set("bar.segment.1.length", 0.25)
            .set("bar.segment.1.area", 2e-4)
            .set("bar.segment.1.material", "mild-steel")
            .set("left.kind", "velocity")
            .set("left.history", [(0.0, -1.0), (1e-5, 0.0)])
            .set("right.kind", "free")
            .set("record.gauges.0", 0.1)
            .set("solve.until", 1e-4);
        let built = scene.clone().build().unwrap_or_else(|e| panic!("{e:?}"));
        assert_eq!(built.bar.segments.iter().map(|s| s.length).collect::<Vec<_>>(), [0.5, 0.25]);
        assert_eq!(built.record.gauges, [("0".to_owned(), 0.1)]);
        let gap = scene.set("bar.segment.3.length", 0.5).build().expect_err("there is no third one");
        assert!(gap.to_string().contains("the list has 2"), "{gap}");
    }
}
