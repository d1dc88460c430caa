//! A scene with changed keys, to compare effects, methods or resolutions.

use super::overrides::Overrides;
use super::{Scene, check};
use crate::error::Result;
use crate::input::Document;

impl Scene {
    /// The scene's text, with its overrides, has this key.
    pub(crate) fn names(&self, key: &str) -> bool {
        let all: Vec<String> = self.overrides.iter().cloned().chain([format!("{key}=")]).collect();
        let document = Document::new(self.name.as_str(), self.text.as_str());
        // An empty value takes a key out, and only one that is there.
        Overrides::new(&all).and_then(|overrides| overrides.apply(&document)).is_ok()
    }

    /// The same scene with keys changed, each `KEY=VALUE` as for [`Scene::read`], on top of its overrides: everything is
    /// checked again, and defaults follow. Text, overrides and choices stay what they were.
    ///
    /// # Errors
    /// What the changed scene is refused for.
    pub(crate) fn with_changes(&self, changes: &[String]) -> Result<Self> {
        let all: Vec<String> = self.overrides.iter().chain(changes).cloned().collect();
        let document = Document::new(self.name.as_str(), self.text.as_str());
        let edited = Overrides::new(&all)?.apply(&document)?;
        let mut checked = check::check(&edited, &self.base)?;
        super::find_methods(&mut checked, &edited, &self.base);
        checked.solve.estimate_error = self.solve.estimate_error;
        Ok(Self {
            title: self.title.clone(),
            name: self.name.clone(),
            path: self.path.clone(),
            files: self.files.clone(),
            text: self.text.clone(),
            overrides: self.overrides.clone(),
            auto: self.auto.clone(),
            ..checked
        })
    }
}
