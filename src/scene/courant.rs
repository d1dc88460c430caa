//! The Courant number of a grid on which parts of the bar can part and meet.

use super::{Method, Scene};
use crate::bar::{Bar, EndCondition, Joint, Segment};

/// Default where blows can repeat. At 1 leapfrog's two lattices keep a zigzag between them for nothing, and every further blow
/// may add to it without bound; half a hundredth less ties them together, and front widths stay those of 1.
const BLOWS: f64 = 0.995;

/// Leapfrog's Courant number where none is asked for: 1, at which elastic waves keep their shape exactly, or less where parts of
/// the bar can part and meet.
pub fn default_courant(bar: &Bar, ends: [&EndCondition; 2]) -> f64 {
    if blows_can_repeat(bar, ends) { BLOWS } else { 1.0 }
}

/// Parts of the bar can part and meet, or the bar and a wall across a gap, and may do so again and again.
fn blows_can_repeat(bar: &Bar, ends: [&EndCondition; 2]) -> bool {
    let wall = |end: &&EndCondition| matches!(end, EndCondition::Wall { gap } if *gap > 0.0);
    let joint = |segment: &Segment| matches!(segment.joint, Joint::Contact { .. });
    ends.iter().any(wall) || bar.segments.iter().any(joint)
}

impl Scene {
    /// Leapfrog's Courant number for this scene where none is asked for, see [`default_courant`].
    pub fn default_courant(&self) -> f64 {
        default_courant(&self.bar, [&self.left, &self.right])
    }

    /// What a user should know of a scene that is right, but asks for something that does not go well: a sentence each.
    pub fn notes(&self) -> Vec<String> {
        self.rings().into_iter().collect()
    }

    fn rings(&self) -> Option<String> {
        let Method::Leapfrog { cfl, .. } = self.solve.method else { return None };
        let most = self.default_courant();
        (cfl > most).then(|| {
            format!(
                "at cfl = {cfl} leapfrog rings from cell to cell behind every blow of parts that meet, more with each; leave \
                 `cfl` out of [solve], which gives {most}, or take less"
            )
        })
    }
}
