//! The keys of an end: which belong to which kind, and which were given.

use std::ops::Range;

use toml::Spanned;

use super::super::raw::{EndKind, RawEnd};

impl EndKind {
    pub(super) fn word(self) -> &'static str {
        match self {
            Self::Velocity => "velocity",
            Self::Stress => "stress",
            Self::Torque => "torque",
            Self::Free => "free",
            Self::Fixed => "fixed",
            Self::Absorbing => "absorbing",
            Self::Dashpot => "dashpot",
            Self::Wall => "wall",
            Self::Striker => "striker",
            Self::Ball => "ball",
            Self::Spring => "spring",
        }
    }

    /// The keys, beside `kind`, that this kind takes.
    pub(super) fn keys(self) -> &'static [&'static str] {
        match self {
            Self::Velocity => &["value", "history", "csv", "release"],
            Self::Stress | Self::Torque => &["value", "history", "csv"],
            Self::Dashpot => &["coefficient"],
            Self::Wall => &["gap"],
            Self::Striker => &["mass", "velocity"],
            Self::Ball => &[
                "radius",
                "diameter",
                "velocity",
                "mass",
                "density",
                "material",
                "modulus",
                "poisson",
                "rigid",
                "bar-poisson",
            ],
            Self::Spring => &["stiffness"],
            Self::Free | Self::Fixed | Self::Absorbing => &[],
        }
    }
}

/// The optional keys that were given, with their places.
pub(super) fn given(raw: &RawEnd) -> Vec<(&'static str, Range<usize>)> {
    let all = [
        ("value", raw.value.as_ref().map(Spanned::span)),
        ("history", raw.history.as_ref().map(Spanned::span)),
        ("csv", raw.csv.as_ref().map(Spanned::span)),
        ("release", raw.release.as_ref().map(Spanned::span)),
        ("gap", raw.gap.as_ref().map(Spanned::span)),
        ("arm", raw.arm.as_ref().map(Spanned::span)),
        ("mass", raw.mass.as_ref().map(Spanned::span)),
        ("inertia", raw.inertia.as_ref().map(Spanned::span)),
        ("velocity", raw.velocity.as_ref().map(Spanned::span)),
        ("radius", raw.radius.as_ref().map(Spanned::span)),
        ("diameter", raw.diameter.as_ref().map(Spanned::span)),
        ("density", raw.density.as_ref().map(Spanned::span)),
        ("material", raw.material.as_ref().map(Spanned::span)),
        ("modulus", raw.modulus.as_ref().map(Spanned::span)),
        ("poisson", raw.poisson.as_ref().map(Spanned::span)),
        ("rigid", raw.rigid.as_ref().map(Spanned::span)),
        ("bar-poisson", raw.bar_poisson.as_ref().map(Spanned::span)),
        ("stiffness", raw.stiffness.as_ref().map(Spanned::span)),
        ("coefficient", raw.coefficient.as_ref().map(Spanned::span)),
    ];
    all.into_iter().filter_map(|(name, span)| span.map(|s| (name, s))).collect()
}
