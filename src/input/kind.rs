//! Kinds of TOML files, by the keys at their top level.

use super::{Document, Parsed};

/// Kind of a file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum FileKind {
    /// A bar or another impact.
    Scene,
    /// A stress-strain curve with its constants.
    Material,
    /// Axes over a scene.
    Sweep,
}

/// Keys that only a scene has at its top level.
const OF_A_SCENE: [&str; 11] =
    ["bar", "specimen", "spheres", "plate", "beam", "striker", "left", "right", "effects", "solve", "record"];
/// Keys that only a material has at its top level.
const OF_A_MATERIAL: [&str; 4] = ["density", "curve", "modulus", "source"];
/// Keys that only a sweep has at its top level.
const OF_A_SWEEP: [&str; 2] = ["sweep", "axes"];

impl FileKind {
    /// Returns the kind of a file; `None` if it has no key of any kind. `sweep` decides over the keys of a scene, and these over those of a material.
    pub fn of(parsed: &Parsed<'_>) -> Option<Self> {
        let has = |kind: Self| kind.keys().iter().any(|key| parsed.has(key));
        [Self::Sweep, Self::Scene, Self::Material].into_iter().find(|kind| has(*kind))
    }

    /// Returns the kind of the files with these keys at their top level; `None` if they belong to none or to several.
    fn of_keys(keys: &[&str]) -> Option<Self> {
        let mut kinds = [Self::Sweep, Self::Scene, Self::Material]
            .into_iter()
            .filter(|kind| keys.iter().any(|key| kind.keys().contains(key)));
        kinds.next().filter(|_| kinds.next().is_none())
    }

    fn keys(self) -> &'static [&'static str] {
        match self {
            Self::Scene => &OF_A_SCENE,
            Self::Material => &OF_A_MATERIAL,
            Self::Sweep => &OF_A_SWEEP,
        }
    }

    /// Returns the kind with its article.
    pub(super) fn name(self) -> &'static str {
        match self {
            Self::Scene => "a scene",
            Self::Material => "a material",
            Self::Sweep => "a sweep file",
        }
    }

    /// Returns the commands that read such a file.
    pub(super) fn commands(self) -> &'static str {
        match self {
            Self::Scene => "`barwave run`, `barwave plan` and `barwave cost` read scenes",
            Self::Material => {
                "`barwave critical` and `barwave compare` read materials; in a scene, `material` names the file"
            }
            Self::Sweep => "`barwave sweep` reads sweep files",
        }
    }
}

impl Document {
    /// Returns the kind of this file if its keys are those of another kind than the keys that were expected.
    pub(super) fn other_kind(&self, expected: &[&str]) -> Option<[FileKind; 2]> {
        let wanted = FileKind::of_keys(expected)?;
        let parsed = self.parsed().ok()?;
        let found = FileKind::of_keys(&parsed.keys().collect::<Vec<_>>())?;
        (found != wanted).then_some([found, wanted])
    }
}
