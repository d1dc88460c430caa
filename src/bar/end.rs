//! Boundary conditions of the bar: relations between velocity and stress of an end.

use std::borrow::Cow;

use super::{Hertz, History};

/// Boundary condition at one end. Velocities are positive in +x at both ends; stresses are tension positive.
#[derive(Debug, Clone)]
pub enum EndCondition {
    /// The end moves with this velocity, m/s. From `release` on (s) it is free.
    Velocity {
        /// Velocity as a function of time, m/s.
        history: History,
        /// Time at which the end is released, s; `None` if it never is.
        release: Option<f64>,
    },
    /// The end carries this stress, Pa.
    Stress {
        /// Stress as a function of time, Pa.
        history: History,
    },
    /// A free end, without stress.
    Free,
    /// A fixed end, without motion.
    Fixed,
    /// Elastic waves leave without reflection, as in an infinite elastic bar of the same cross-section.
    Absorbing,
    /// A linear dashpot to the ground: the force on the end of the bar is -c v.
    Dashpot {
        /// c, N s/m, >= 0, for the whole area of the section.
        coefficient: f64,
    },
    /// A rigid wall that can push but not pull; `gap` is the initial distance to it, m, >= 0.
    Wall {
        /// Initial distance, m.
        gap: f64,
    },
    /// A rigid mass that touches the end at t = 0. It can push but not pull: it separates instead, moves freely, and
    /// may strike again.
    Striker {
        /// Mass, kg, > 0, for the whole area of the section.
        mass: f64,
        /// Velocity at t = 0, m/s, positive in +x.
        velocity: f64,
    },
    /// A ball that touches the end at t = 0. It pushes by Hertz contact, on the whole area of the section. After separation
    /// it moves freely, and may strike again.
    Ball {
        /// Mass, kg, > 0.
        mass: f64,
        /// Velocity at t = 0, m/s, positive in +x.
        velocity: f64,
        /// Contact law.
        contact: Hertz,
    },
    /// A linear spring to the ground, without force at t = 0: the force on the end of the bar is -k u.
    Spring {
        /// k, N/m, > 0, for the whole area of the section.
        stiffness: f64,
    },
}

impl EndCondition {
    /// Returns the velocity (m/s) or stress (Pa) that the end imposes; `None` for ends that impose neither.
    pub fn history(&self) -> Option<&History> {
        match self {
            Self::Velocity { history, .. } | Self::Stress { history } => Some(history),
            _ => None,
        }
    }

    /// Returns the end with its history truncated at time `end` (s), or at its release if that is earlier.
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

    /// Returns true if the end can send a jump into a bar at rest: by a jump of its history, by a release, or by a striker or wall.
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
