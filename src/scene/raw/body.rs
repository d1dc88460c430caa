//! Keys of striking and struck bodies, shared by the ends of bars and all kinds of impacts.

use super::MaterialChoice;
use crate::typed::{Of, Placed, Poisson, Positive};
use crate::units::measures::{Density, Length, Mass, Stress};

/// Keys of an elastic body in any table.
#[derive(Debug, Clone, Copy, Default)]
pub struct BodyKeys<'a> {
    pub radius: Option<&'a Of<Length, Positive>>,
    pub diameter: Option<&'a Of<Length, Positive>>,
    pub mass: Option<&'a Of<Mass, Positive>>,
    pub density: Option<&'a Of<Density, Positive>>,
    pub material: Option<&'a Placed<MaterialChoice>>,
    pub modulus: Option<&'a Of<Stress, Positive>>,
    pub poisson: Option<&'a Of<crate::typed::Plain, Poisson>>,
    pub rigid: Option<&'a Placed<bool>>,
}

impl BodyKeys<'_> {
    /// Returns whether the body is rigid.
    pub(in crate::scene) fn is_rigid(&self) -> bool {
        self.rigid.is_some_and(|rigid| *rigid.get_ref())
    }
}

/// Declares the raw table of a body with the method `keys`: its own keys, those of a sphere (with `sphere`), and those of its material.
/// (`serde(flatten)` would lose the positions of values and the check for unknown keys.)
macro_rules! raw_body {
    ($(#[$meta:meta])* $name:ident sphere { $($own:tt)* }) => {
        raw_body! { @table $(#[$meta])* $name {
            $($own)*
            /// Radius; or give `diameter`.
            pub radius: Option<Of<measures::Length, Positive>>,
            /// Diameter; in place of `radius`.
            pub diameter: Option<Of<measures::Length, Positive>>,
            /// Mass. Default: that of a solid sphere.
            pub mass: Option<Of<measures::Mass, Positive>>,
            /// Rigid body, instead of `modulus` and `poisson`. Default: false.
            pub rigid: Option<Placed<bool>>,
        } }

        impl $name {
            pub(in crate::scene) fn keys(&self) -> BodyKeys<'_> {
                BodyKeys {
                    radius: self.radius.as_ref(),
                    diameter: self.diameter.as_ref(),
                    mass: self.mass.as_ref(),
                    rigid: self.rigid.as_ref(),
                    ..self.material_keys()
                }
            }
        }
    };
    ($(#[$meta:meta])* $name:ident { $($own:tt)* }) => {
        raw_body! { @table $(#[$meta])* $name { $($own)* } }

        impl $name {
            pub(in crate::scene) fn keys(&self) -> BodyKeys<'_> {
                self.material_keys()
            }
        }
    };
    (@table $(#[$meta:meta])* $name:ident { $($own:tt)* }) => {
        $(#[$meta])*
        #[derive(Debug, Deserialize, JsonSchema)]
        #[serde(deny_unknown_fields, rename_all = "kebab-case")]
        pub struct $name {
            $($own)*
            /// Material, for density, modulus and Poisson's ratio. The body remains elastic.
            pub material: Option<Placed<MaterialChoice>>,
            /// Density. Default: its material's.
            pub density: Option<Of<measures::Density, Positive>>,
            /// Elastic modulus. Default: its material's.
            pub modulus: Option<Of<measures::Stress, Positive>>,
            /// Poisson's ratio. Default: its material's.
            pub poisson: Option<Of<Plain, Poisson>>,
        }

        impl $name {
            fn material_keys(&self) -> BodyKeys<'_> {
                BodyKeys {
                    material: self.material.as_ref(),
                    density: self.density.as_ref(),
                    modulus: self.modulus.as_ref(),
                    poisson: self.poisson.as_ref(),
                    ..BodyKeys::default()
                }
            }
        }
    };
}
pub(in crate::scene) use raw_body;
