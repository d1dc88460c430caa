//! Scenes built in a program, key by key.

use std::path::{Path, PathBuf};

use toml::{Table, Value};

use super::Scene;
use crate::error::{InputError, Result};

/// Keys of a scene with their values, as in a scene file and checked in the same way: numbers are SI, texts may carry a unit.
#[derive(Debug, Clone, Default)]
pub struct SceneBuilder {
    table: Table,
    folder: PathBuf,
    /// The first key that could not be set.
    blocked: Option<String>,
}

impl SceneBuilder {
    /// Sets a key by its path in the scene file, such as `bar.length` or `left.kind`; the tables on the way are made. What was there is
    /// replaced.
    #[must_use]
    pub fn set(mut self, key: &str, value: impl Into<Value>) -> Self {
        let mut parts: Vec<&str> = key.split('.').collect();
        let last = parts.pop().unwrap_or_default();
        let mut table = &mut self.table;
        for part in parts {
            let inner = table.entry(part).or_insert_with(|| Value::Table(Table::new()));
            let Value::Table(inner) = inner else {
                self.blocked.get_or_insert_with(|| key.to_owned());
                return self;
            };
            table = inner;
        }
        table.insert(last.to_owned(), value.into());
        self
    }

    /// The folder to which paths of materials and histories are relative; the current one otherwise.
    #[must_use]
    pub fn folder(mut self, folder: &Path) -> Self {
        folder.clone_into(&mut self.folder);
        self
    }

    /// Checks the scene.
    ///
    /// # Errors
    /// As for [`Scene::read`]; places are lines of the scene as it would stand in a file. A key inside of one that is no table.
    pub fn build(self) -> Result<Scene> {
        if let Some(key) = self.blocked {
            let message = format!("`{key}` lies inside a key that has a value of its own");
            return Err(InputError::new(message).key(&key).help("set either the table or the keys in it").into());
        }
        let text = toml::to_string(&self.table)
            .map_err(|e| InputError::new(format!("these keys do not form a scene: {e}")))?;
        Scene::parse("scene", &text, &self.folder, &[])
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
    }
}
