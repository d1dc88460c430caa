//! Selected effects and method of a scene that leaves them open. A resumed run continues with them.

use serde::{Deserialize, Serialize};

use super::auto;
use super::choice::Attempt;
use crate::error::Result;
use crate::record::AutoChoice;
use crate::scene::Scene;

/// Selections made before the current run.
#[derive(Debug, Clone, Default, Serialize, Deserialize)]
pub(super) struct Chosen {
    /// Selection by `effects = "auto"`: number of runs including this one, and the previous decisions.
    pub effects: Option<(usize, Vec<AutoChoice>)>,
    /// Selection by a tolerance.
    pub attempt: Option<Attempt>,
}

impl Chosen {
    /// Returns the scene with the selected effects.
    ///
    /// # Errors
    /// Those of a scene that this version of the program refuses with these effects.
    pub fn with_effects(&self, scene: Scene) -> Result<Scene> {
        match &self.effects {
            Some((_, choices)) => auto::chosen(scene, choices),
            None => Ok(scene),
        }
    }

    /// Returns the scene with the selected method, which is the scene that is run.
    pub fn with_method(&self, scene: &Scene) -> Scene {
        self.attempt.as_ref().map_or_else(|| scene.clone(), |attempt| attempt.scene(scene))
    }
}
