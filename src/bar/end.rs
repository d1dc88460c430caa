//! Boundary conditions of the bar: relations between velocity and stress of an end.

use std::borrow::Cow;

use super::{Hertz, History};

/// The condition at one end. Velocities are positive in +x at both ends; stresses are tension positive.
#[derive(Debug, Clone)]
pub enum EndCondition {
    /// The end moves with this velocity, m/s. From `release` on (s) it is free.
    Velocity {
        /// Velocity against time.
        history: History,
        /// Time at which the end is released.
        release: Option<f64>,
    },
    /// The end carries this stress, Pa.
    Stress {
        /// Stress against time.
        history: History,
    },
    /// No stress.
    Free,
    /// No motion.
    Fixed,
    /// Elastic waves leave without reflection, as in an infinite elastic bar of the same section.
    Absorbing,
    /// A linear dashpot to the ground: the bar's end gets the force -c v.
    Dashpot {
        /// c, N s/m, >= 0, on the section's whole area.
        coefficient: f64,
    },
    /// A rigid wall that can push but not pull; `gap` is the initial distance to it, m, >= 0.
    Wall {
        /// Initial distance, m.
        gap: f64,
    },
    /// A rigid mass that touches the end at the start. It pushes; where it would have to pull it flies on by itself, and
    /// may strike again.
    Striker {
        /// kg, > 0, on the section's whole area.
        mass: f64,
        /// Velocity at the start, m/s, positive in +x.
        velocity: f64,
    },
    /// A ball that touches the end at the start. It pushes by Hertz's contact, on the section's whole area; where they part
    /// it flies on by itself, and may strike again.
    Ball {
        /// kg, > 0.
        mass: f64,
        /// Velocity at the start, m/s, positive in +x.
        velocity: f64,
        /// The contact.
        contact: Hertz,
    },
    /// A linear spring to the ground, without force at the start: the bar's end gets the force -k u.
    Spring {
        /// k, N/m, > 0, on the section's whole area.
        stiffness: f64,
    },
}

impl EndCondition {
    /// The velocity (m/s) or stress (Pa) that the end imposes; none of other ends.
    pub fn history(&self) -> Option<&History> {
        match self {
            Self::Velocity { history, .. } | Self::Stress { history } => Some(history),
            _ => None,
        }
    }

    /// The end with what it imposes before a time (s) and before its release.
    #[must_use]
    pub fn until(&self, end: f64) -> Cow<'_, Self> {
        let cut = match self {
            Self::Velocity { history, release } => history
                .until(release.map_or(end, |release| release.min(end)))
                .map(|history| Self::Velocity { history, release: *release }),
            Self::Stress { history } => history.until(end).map(|history| Self::Stress { history }),
            _ => None,
        };
        cut.map_or(Cow::Borrowed(self), Cow::Owned)
    }

    /// It can send a jump into a bar that rests: one that it imposes at some time, that of a release, or of a body or wall that is struck.
    pub fn is_sudden(&self) -> bool {
        match self {
            Self::Velocity { history, release } => release.is_some() || !history.is_continuous(),
            Self::Stress { history } => !history.is_continuous(),
            Self::Wall { .. } | Self::Striker { .. } => true,
            Self::Free
            | Self::Fixed
            | Self::Absorbing
            | Self::Dashpot { .. }
            | Self::Ball { .. }
            | Self::Spring { .. } => false,
        }
    }
}
