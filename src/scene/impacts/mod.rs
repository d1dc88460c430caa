//! Scenes of impacts without waves in a bar: the energy method, spheres, plates, beams.
//!
//! A kind of scene is a file here that reads its keys, its line in [`KINDS`], and its [`Problem`] in `impact`. Everything else is the same
//! for all: checks, runs, result files, summaries, plans, reports and cost studies.

mod beam;
mod body;
mod plate;
mod specimen;
mod spheres;

use std::path::Path;
use std::sync::Arc;

use serde_json::{Value, json};

use super::check::Checker;
use crate::error::Result;
use crate::impact::Problem;
use crate::input::{Document, nearest};
use crate::material::Material;
use crate::typed;

/// A kind of scene, known by the table that stands in place of `[bar]`.
#[derive(Debug)]
pub struct Kind {
    /// The table's name.
    pub key: &'static str,
    /// Its keys.
    pub schema: fn() -> schemars::Schema,
    check: fn(&Checker<'_>) -> Result<Parts>,
}

/// What a kind reads from its scene.
struct Parts {
    title: Option<String>,
    problem: Arc<dyn Problem>,
    /// What the bodies are made of, where the scene names materials.
    materials: Vec<Arc<Material>>,
    /// Tables of the scene with every default filled in, SI.
    resolved: Value,
}

/// All kinds.
pub const KINDS: [Kind; 4] = [
    Kind { key: "specimen", schema: || typed::schema::<specimen::RawSpecimenScene>(), check: specimen::check },
    Kind { key: "spheres", schema: || typed::schema::<spheres::RawSpheresScene>(), check: spheres::check },
    Kind { key: "plate", schema: || typed::schema::<plate::RawPlateScene>(), check: plate::check },
    Kind { key: "beam", schema: || typed::schema::<beam::RawBeamScene>(), check: beam::check },
];

/// A checked scene of any of these kinds.
#[derive(Debug, Clone)]
pub struct ImpactScene {
    /// Title; by default the stem of the file.
    pub title: String,
    /// The file's stem: names the default output.
    pub name: String,
    /// The scene's exact text, as read.
    pub text: String,
    /// Changes of keys (on the command line `--set`), as typed.
    pub overrides: Vec<String>,
    /// The impact.
    pub problem: Arc<dyn Problem>,
    /// What the bodies are made of, where the scene says so.
    pub materials: Vec<Arc<Material>>,
    resolved: Value,
}

impl ImpactScene {
    /// Notes on its keys.
    pub fn notes(&self) -> Vec<String> {
        super::deprecated::notes(&self.text, &self.overrides)
    }

    /// All input values of the simulation, SI.
    pub fn resolved_json(&self) -> Value {
        let mut all = json!({ "title": self.title, "name": self.name, "overrides": self.overrides });
        if let (Some(all), Some(own)) = (all.as_object_mut(), self.resolved.as_object()) {
            all.extend(own.clone());
        }
        all
    }
}

/// The kind of a scene; none of a bar, and of text that is no TOML, of which its reader complains better. A scene of no kind is of that whose
/// key one of its own resembles, so that the error suggests it.
pub(super) fn kind(document: &Document) -> Option<&'static Kind> {
    let parsed = document.parsed().ok()?;
    if parsed.has("bar") {
        return KINDS.iter().find(|kind| parsed.has(kind.key));
    }
    let like = |kind: &&Kind| parsed.keys().any(|key| resembled(key) == Some(kind.key));
    KINDS.iter().find(|kind| parsed.has(kind.key)).or_else(|| KINDS.iter().find(like))
}

/// What makes a scene one of a bar, or of one of the kinds, that is most like a key.
fn resembled(key: &str) -> Option<&'static str> {
    nearest(key, KINDS.iter().map(|kind| kind.key).chain(["bar"]))
}

/// Checks a document; `text` and `overrides` are the caller's to fill.
pub(super) fn check(kind: &Kind, document: &Document, base: &Path) -> Result<ImpactScene> {
    let checker = Checker { document, base, torsion: false, keys: Default::default() };
    let Parts { title, problem, materials, resolved } = (kind.check)(&checker)?;
    // A check and a plan refuse what a run would.
    problem.check()?;
    let name = checker.name();
    let title = title.unwrap_or_else(|| name.clone());
    Ok(ImpactScene { title, name, text: String::new(), overrides: Vec::new(), problem, materials, resolved })
}
