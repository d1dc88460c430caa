//! Scenes of impacts without waves in a bar: the energy method, spheres, plates and beams.
//!
//! A kind of scene consists of a file in this module that reads its keys, its entry in [`KINDS`], and its [`Problem`] in `impact`. Everything else is
//! common to all kinds: checks, runs, result files, summaries, plans, reports and cost studies.

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

/// Kind of scene, identified by the table that replaces `[bar]`.
#[derive(Debug)]
pub struct Kind {
    /// Name of the table.
    pub key: &'static str,
    /// Returns the schema of its keys.
    pub schema: fn() -> schemars::Schema,
    check: fn(&Checker<'_>) -> Result<Parts>,
}

/// Data that a kind reads from its scene.
struct Parts {
    title: Option<String>,
    problem: Arc<dyn Problem>,
    /// Materials of the bodies, if the scene names them.
    materials: Vec<Arc<Material>>,
    /// Tables of the scene in SI units, with all defaults filled in.
    resolved: Value,
}

/// All kinds.
pub const KINDS: [Kind; 4] = [
    Kind { key: "specimen", schema: || typed::schema::<specimen::RawSpecimenScene>(), check: specimen::check },
    Kind { key: "spheres", schema: || typed::schema::<spheres::RawSpheresScene>(), check: spheres::check },
    Kind { key: "plate", schema: || typed::schema::<plate::RawPlateScene>(), check: plate::check },
    Kind { key: "beam", schema: || typed::schema::<beam::RawBeamScene>(), check: beam::check },
];

/// Checked scene of any of these kinds.
#[derive(Debug, Clone)]
pub struct ImpactScene {
    /// Title; by default the stem of the file.
    pub title: String,
    /// Stem of the file, used for the name of the default output.
    pub name: String,
    /// Exact text of the scene, as read.
    pub text: String,
    /// Changes of keys (`--set` on the command line), as typed.
    pub overrides: Vec<String>,
    /// The impact.
    pub problem: Arc<dyn Problem>,
    /// Materials of the bodies, if the scene names them.
    pub materials: Vec<Arc<Material>>,
    resolved: Value,
}

impl ImpactScene {
    /// Returns notes on the deprecated keys of the scene.
    pub fn notes(&self) -> Vec<String> {
        super::deprecated::notes(&self.text, &self.overrides)
    }

    /// Returns all input values of the simulation in SI units.
    pub fn resolved_json(&self) -> Value {
        let mut all = json!({ "title": self.title, "name": self.name, "overrides": self.overrides });
        if let (Some(all), Some(own)) = (all.as_object_mut(), self.resolved.as_object()) {
            all.extend(own.clone());
        }
        all
    }
}

/// Returns the kind of a scene. Returns `None` for a scene that has `[bar]` and no table of another kind, and for text that is not valid TOML, for
/// which the reader reports a better error. A scene with none of these tables is of the kind whose table name resembles one of its keys, so that the
/// error suggests it.
pub(super) fn kind(document: &Document) -> Option<&'static Kind> {
    let parsed = document.parsed().ok()?;
    if parsed.has("bar") {
        return KINDS.iter().find(|kind| parsed.has(kind.key));
    }
    let like = |kind: &&Kind| parsed.keys().any(|key| resembled(key) == Some(kind.key));
    KINDS.iter().find(|kind| parsed.has(kind.key)).or_else(|| KINDS.iter().find(like))
}

/// Returns the table name (`bar`, or that of one of the kinds) that is most similar to a key.
fn resembled(key: &str) -> Option<&'static str> {
    nearest(key, KINDS.iter().map(|kind| kind.key).chain(["bar"]))
}

/// Checks a document; the caller sets `text` and `overrides`.
pub(super) fn check(kind: &Kind, document: &Document, base: &Path) -> Result<ImpactScene> {
    let checker = Checker { document, base, torsion: false, keys: Default::default() };
    let Parts { title, problem, materials, resolved } = (kind.check)(&checker)?;
    // A check and a plan refuse everything that a run would refuse.
    problem.check()?;
    let name = checker.name();
    let title = title.unwrap_or_else(|| name.clone());
    Ok(ImpactScene { title, name, text: String::new(), overrides: Vec::new(), problem, materials, resolved })
}
