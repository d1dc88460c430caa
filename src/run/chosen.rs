//! The selected effects and method of a scene that leaves them open. A resumed run continues with them.

use serde::{Deserialize, Serialize};

use super::auto;
use super::choice::Attempt;
use crate::error::Result;
use crate::record::AutoChoice;
use crate::scene::Scene;

/// The choices made before the current run.
#[derive(Debug, Clone, Default, Serialize, Deserialize)]
pub(super) struct Chosen {
    /// By `effects = "auto"`: runs so far, this one included, and the decisions before it.
    pub effects: Option<(usize, Vec<AutoChoice>)>,
    /// By a tolerance.
    pub attempt: Option<Attempt>,
}

impl Chosen {
    /// The scene with the effects that were chosen.
    ///
    /// # Errors
    /// What another program refuses that scene for.
    pub fn with_effects(&self, scene: Scene) -> Result<Scene> {
        match &self.effects {
            Some((_, choices)) => auto::chosen(scene, choices),
            None => Ok(scene),
        }
    }

    /// The same with the method that was chosen: the scene that is run.
    pub fn with_method(&self, scene: &Scene) -> Scene {
        self.attempt.as_ref().map_or_else(|| scene.clone(), |attempt| attempt.scene(scene))
    }
}
