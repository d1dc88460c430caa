//! The effect `damping`: distributed forces, each declared once.

use std::ops::Range;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::error::Result;
use crate::input::Document;
use crate::typed::{Key as _, NotNegative, Of, Or};
use crate::units::{Dimension, System, format, measures};

/// Quantity to which a force is related.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Per {
    /// Area of the section: the force is a stress.
    Area,
    /// Length of the bar; the area of the section must then be known.
    Length,
}

/// Key of `damping`.
pub(super) struct Key {
    pub name: &'static str,
    pub place: Option<Range<usize>>,
    pub per: Per,
}

/// Declares the forces. Each row contains the name, the dimension of the constant (which is >= 0), and the quantity to which the force is related.
macro_rules! forces {
    ($($(#[doc = $doc:literal])* $name:ident: $dimension:ident, $per:ident;)*) => {
        /// Constants of the distributed forces in SI units, >= 0; 0 for a force that is not set.
        #[derive(Debug, Clone, Copy, Default, PartialEq, Serialize)]
        pub struct Damping {
            $($(#[doc = $doc])* pub $name: f64,)*
        }

        /// Distributed forces, the same in all segments: `{ internal = "20 kPa*s" }`, `{ external = "300 N*s/m^2" }`,
        /// `{ foundation = "50 MN/m^2" }`, or several of them. All except internal damping need the area of the bar.
        #[derive(Debug, Deserialize, JsonSchema)]
        #[serde(deny_unknown_fields)]
        pub struct RawDamping {
            $($(#[doc = $doc])* #[schemars(default)] $name: Or<Of<measures::$dimension, NotNegative>, 0>,)*
        }

        impl Damping {
            pub(super) const NAMES: &[&str] = &[$(stringify!($name),)*];

            /// Returns the constants as listed in messages: "internal = 20 kPa*s, external = 300 N*s/m^2".
            pub(super) fn describe(self) -> String {
                let all = [$((stringify!($name), self.$name, Dimension::$dimension),)*];
                let on = all.iter().filter(|(_, value, _)| *value > 0.0);
                let one = |(name, value, dimension): &(&str, f64, Dimension)| {
                    format!("{name} = {}", format(*value, *dimension, System::Si))
                };
                let parts: Vec<String> = on.map(one).collect();
                parts.join(", ")
            }
        }

        impl RawDamping {
            pub(super) fn keys(&self) -> Vec<Key> {
                vec![$(Key { name: stringify!($name), place: self.$name.place(), per: Per::$per },)*]
            }

            /// Reads the constants in SI units.
            pub(super) fn read(&self, document: &Document) -> Result<Damping> {
                Ok(Damping { $($name: self.$name.si(document, false)?,)* })
            }
        }
    };
}

forces! {
    /// Internal (Kelvin-Voigt) damping: stress per strain rate.
    internal: Viscosity, Area;
    /// External viscous damping: force per unit length and velocity.
    external: Drag, Length;
    /// Elastic foundation: force per unit length and displacement.
    foundation: Foundation, Length;
    /// Dry (Coulomb) friction: force per unit length against the motion; a section at rest is held by up to this force. Not
    /// together with `internal` or lateral inertia.
    friction: ForcePerLength, Length;
}
