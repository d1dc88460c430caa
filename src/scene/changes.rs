//! A scene with changed keys, to compare effects, methods or resolutions.

use super::overrides::Overrides;
use super::{Scene, check};
use crate::error::Result;
use crate::input::Document;

impl Scene {
    /// The scene's text, with its overrides, has this key.
    pub(crate) fn names(&self, key: &str) -> bool {
        let document = Document::new(self.name.as_str(), self.text.as_str());
        let edited = Overrides::new(&self.overrides).and_then(|overrides| overrides.apply(&document));
        edited.is_ok_and(|edited| edited.span_of(key).is_some())
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
