//! Scenes with changed keys, for the comparison of effects, methods or resolutions.

use super::overrides::Overrides;
use super::{IntoValue, Method, Scene, SceneParts, check};
use crate::error::Result;
use crate::input::Document;

impl Scene {
    /// Returns the scene with changed keys, each `KEY=VALUE` as for [`Scene::read`], in addition to its overrides. Its text and files are read again,
    /// and everything is checked again with new defaults. The changes are among the overrides in the result file.
    ///
    /// ```
    /// use barwave::scene::Scene;
    ///
    /// let scene = Scene::builder()
    ///     .set("bar.length", 1.0)
    ///     .set("bar.material", "mild-steel")
    ///     .set("left.kind", "velocity")
    ///     .set("left.value", -5.0)
    ///     .set("right.kind", "free")
    ///     .set("solve.until", 1e-4)
    ///     .build()?;
    /// let faster = scene.with(&["left.value=-20 m/s", "solve.cells=2000"])?;
    /// assert_eq!(faster.solve.method.cells(), Some(2000));
    /// assert!(scene.with(&["bar.length=-1"]).is_err());
    /// # Ok::<(), barwave::error::Error>(())
    /// ```
    ///
    /// # Errors
    /// As for [`Scene::read`].
    pub fn with(&self, changes: &[impl AsRef<str>]) -> Result<Self> {
        let changes = changes.iter().map(|change| change.as_ref().to_owned());
        let all: Vec<String> = self.overrides.iter().cloned().chain(changes).collect();
        let file = self.path.as_ref().map_or_else(|| format!("{}.toml", self.name), |path| path.display().to_string());
        let mut scene = Self::parse(&file, &self.text, &self.base, &all)?;
        scene.parts.path.clone_from(&self.path);
        scene.parts.solve.estimate_error = self.solve.estimate_error;
        Ok(scene)
    }

    /// Returns the scene with one key changed to a value given by a program.
    ///
    /// ```
    /// use barwave::scene::Scene;
    ///
    /// # let scene = Scene::builder().set("bar.length", 1.0).set("bar.material", "mild-steel").set("left.kind", "velocity")
    /// #     .set("left.value", -5.0).set("right.kind", "free").set("solve.until", 1e-4).build()?;
    /// let scene = scene.with_value("record.times", [0.0, 5e-5, 1e-4])?;
    /// let error = scene.with_value("bar.length", f64::NAN).unwrap_err();
    /// assert!(error.to_string().contains("`bar.length`: NaN is not a finite number"), "{error}");
    /// # Ok::<(), barwave::error::Error>(())
    /// ```
    ///
    /// # Errors
    /// As for [`Scene::read`].
    pub fn with_value(&self, key: &str, value: impl IntoValue) -> Result<Self> {
        self.with(&[format!("{key}={}", value.into_value())])
    }

    /// Returns the scene with the error estimate enabled, as with `--estimate-error`.
    #[must_use]
    pub fn with_error_estimate(mut self) -> Self {
        self.parts.solve.estimate_error = true;
        self
    }

    /// Restricts the methods of a scene with a tolerance to those for which `meant` returns true. Returns the scene unchanged if there are none.
    #[must_use]
    pub fn with_methods(mut self, meant: impl Fn(&Method) -> bool) -> Self {
        if let Some(tolerance) = &mut self.parts.solve.tolerance
            && tolerance.methods.iter().any(&meant)
        {
            tolerance.methods.retain(meant);
        }
        self
    }

    /// Returns the scene with another method, which must support it.
    pub(crate) fn by(&self, method: Method) -> Self {
        let mut scene = self.clone();
        scene.parts.solve.method = method;
        scene
    }

    /// Returns whether the scene's text, with its overrides, contains this key.
    pub(crate) fn names(&self, key: &str) -> bool {
        let document = Document::new(self.name.as_str(), self.text.as_str());
        let edited = Overrides::new(&self.overrides).and_then(|overrides| overrides.apply(&document));
        edited.is_ok_and(|edited| edited.span_of(key).is_some())
    }

    /// Returns the scene with changed keys, each `KEY=VALUE` as for [`Scene::read`], in addition to its overrides. Everything is checked again with
    /// new defaults. The text, the overrides and the selected effects remain those of this scene.
    ///
    /// # Errors
    /// Those of the changed scene.
    pub(crate) fn with_changes(&self, changes: &[String]) -> Result<Self> {
        let all: Vec<String> = self.overrides.iter().chain(changes).cloned().collect();
        let document = Document::new(self.name.as_str(), self.text.as_str());
        let edited = Overrides::new(&all)?.apply(&document)?;
        let mut checked = check::check(&edited, &self.base)?;
        super::find_methods(&mut checked, &edited, &self.base);
        checked.parts.solve.estimate_error = self.solve.estimate_error;
        let parts = SceneParts {
            title: self.title.clone(),
            name: self.name.clone(),
            path: self.path.clone(),
            files: self.files.clone(),
            text: self.text.clone(),
            overrides: self.overrides.clone(),
            auto: self.auto.clone(),
            ..checked.parts
        };
        Ok(Self { parts })
    }
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::*;

    #[test]
    fn a_key_is_named_in_the_text_or_by_an_override() {
        let text = "[bar]\nlength = 1\narea = 1e-4\nmaterial = \"mild-steel\"\n[left]\nkind = \"free\"\n[right]\nkind = \"free\"\n\
                    [solve]\nuntil = 1e-6\n";
        let named = |text: &str, overrides: &[&str]| {
            let overrides: Vec<String> = overrides.iter().map(|&one| one.to_owned()).collect();
            Scene::parse("scene.toml", text, Path::new("."), &overrides).expect("a right scene").names("solve.method")
        };
        let with_method = format!("{text}method = \"fd\"\n");
        assert!(!named(text, &[]) && named(&with_method, &[]));
        assert!(named(text, &["solve.method=fd"]) && !named(&with_method, &["solve.method="]));
    }
}
