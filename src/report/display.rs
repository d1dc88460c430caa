//! Display units: the factor from SI, the symbol, and the axis label of each quantity.

use crate::record::Field;
use crate::units::{Dimension, System, in_units, scale_for};

/// Units of a report.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Units {
    /// m, MPa, m/s.
    #[default]
    Si,
    /// in, ksi, ft/s.
    Us,
}

/// A unit to show values in.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Unit {
    /// Shown value = factor times SI value.
    pub factor: f64,
    /// Empty where there is none.
    pub symbol: &'static str,
}

const INCH: f64 = 0.0254;
const FOOT: f64 = 0.3048;
/// Pound-force, N.
const POUND_FORCE: f64 = 0.453_592_37 * 9.806_65;

impl Unit {
    const fn new(factor: f64, symbol: &'static str) -> Self {
        Self { factor, symbol }
    }

    /// The symbol as it is printed, with raised dots in products.
    fn printed(self) -> String {
        self.symbol.replace('*', "\u{b7}")
    }

    /// `name (unit)`.
    pub fn label(self, name: &str) -> String {
        if self.symbol.is_empty() { name.to_owned() } else { format!("{name} ({})", self.printed()) }
    }

    /// A value with its unit, four digits.
    pub fn show(self, value: f64) -> String {
        if !value.is_finite() {
            return "\u{2013}".into();
        }
        let number = four_digits(value * self.factor);
        if self.symbol.is_empty() { number } else { format!("{number} {}", self.printed()) }
    }

    /// A value with its unit for legends: at most four digits, no idle zeros.
    pub fn brief(self, value: f64) -> String {
        let number = four_digits(value * self.factor);
        let number = if number.contains('.') && !number.contains('e') {
            number.trim_end_matches('0').trim_end_matches('.').to_owned()
        } else {
            number
        };
        format!("{number} {}", self.printed()).trim_end().to_owned()
    }

    /// A value without its unit, four digits; a dash where there is none.
    pub fn number(self, value: f64) -> String {
        if value.is_finite() { four_digits(value * self.factor) } else { "\u{2013}".into() }
    }
}

/// Four significant digits, with an exponent only where plain decimals would be long.
pub(super) fn four_digits(value: f64) -> String {
    if value == 0.0 {
        return "0".into();
    }
    let power = value.abs().log10().floor() as i32;
    let text = if (-4..7).contains(&power) {
        format!("{value:.*}", (3 - power).max(0) as usize)
    } else {
        format!("{value:.3e}")
    };
    text.replace('-', "\u{2212}")
}

impl Units {
    /// A sentence with its quantities in these units.
    pub(super) fn sentence(self, text: &str) -> String {
        in_units(text, self.system())
    }

    fn system(self) -> System {
        match self {
            Self::Si => System::Si,
            Self::Us => System::Us,
        }
    }

    /// For times up to `longest` s.
    pub(super) fn time(longest: f64) -> Unit {
        if longest < 2e-3 {
            Unit::new(1e6, "\u{b5}s")
        } else if longest < 2.0 {
            Unit::new(1e3, "ms")
        } else {
            Unit::new(1.0, "s")
        }
    }

    /// For places on a bar of `length` m.
    pub(super) fn length(self, length: f64) -> Unit {
        match self {
            Self::Si if length < 0.2 => Unit::new(1e3, "mm"),
            Self::Si => Unit::new(1.0, "m"),
            Self::Us if length < 10.0 => Unit::new(1.0 / INCH, "in"),
            Self::Us => Unit::new(1.0 / FOOT, "ft"),
        }
    }

    pub(super) fn stress(self) -> Unit {
        match self {
            Self::Si => Unit::new(1e-6, "MPa"),
            Self::Us => Unit::new(1e-3 * INCH * INCH / POUND_FORCE, "ksi"),
        }
    }

    pub(super) fn velocity(self) -> Unit {
        match self {
            Self::Si => Unit::new(1.0, "m/s"),
            Self::Us => Unit::new(1.0 / FOOT, "ft/s"),
        }
    }

    /// For an energy, given the file's own unit ("J" or "J/m^2").
    pub(super) fn energy(self, stored: &str) -> Unit {
        match (self, stored) {
            (Self::Si, "J") => Unit::new(1.0, "J"),
            (Self::Si, _) => Unit::new(1e-3, "kJ/m\u{b2}"),
            (Self::Us, "J") => Unit::new(1.0 / (FOOT * POUND_FORCE), "ft\u{b7}lbf"),
            (Self::Us, _) => Unit::new(INCH * INCH / (FOOT * POUND_FORCE), "ft\u{b7}lbf/in\u{b2}"),
        }
    }

    pub(super) fn density(self) -> Unit {
        match self {
            Self::Si => Unit::new(1.0, "kg/m\u{b3}"),
            Self::Us => Unit::new(INCH * INCH * INCH / 0.453_592_37, "lb/in\u{b3}"),
        }
    }

    /// For values up to `most` whose SI unit has this symbol, with spaces or, as older programs wrote it, with "*".
    pub(super) fn of_symbol(self, symbol: &str, most: f64) -> Unit {
        let symbol = symbol.replace('*', " ");
        let Some(dimension) =
            Dimension::ALL.iter().copied().find(|d| d.spaced_symbol() == symbol && !symbol.is_empty())
        else {
            return Unit::new(1.0, "");
        };
        let scale = scale_for(most, dimension, self.system());
        let symbol = match scale.symbol {
            "um" => "\u{b5}m",
            "us" => "\u{b5}s",
            other => other,
        };
        Unit::new(1.0 / scale.si, symbol)
    }

    /// For a recorded field.
    pub(super) fn field(self, field: Field) -> Unit {
        match field {
            Field::Stress => self.stress(),
            Field::Velocity => self.velocity(),
            Field::Displacement => match self {
                Self::Si => Unit::new(1e3, "mm"),
                Self::Us => Unit::new(1.0 / INCH, "in"),
            },
            Field::Temperature => Unit::new(1.0, "K"),
            Field::Strain | Field::PlasticStrain | Field::AccumulatedPlasticStrain => Unit::new(1.0, ""),
            Field::Torque => match self {
                Self::Si => Unit::new(1.0, "N\u{b7}m"),
                Self::Us => Unit::new(1.0 / (FOOT * POUND_FORCE), "lbf\u{b7}ft"),
            },
            Field::Twist => match self {
                Self::Si => Unit::new(1.0, "rad/m"),
                Self::Us => Unit::new(INCH, "rad/in"),
            },
            Field::AngularVelocity => Unit::new(1.0, "rad/s"),
        }
    }
}

/// A field's name for axes; `torsion` where it is that of the surface of a twisted bar.
pub(super) fn field_name(field: Field, torsion: bool) -> &'static str {
    match field {
        Field::Stress if torsion => "nominal shear stress at the surface",
        Field::Strain if torsion => "shear strain at the surface",
        Field::Velocity if torsion => "velocity of the surface",
        Field::Displacement if torsion => "displacement of the surface",
        Field::PlasticStrain if torsion => "plastic shear strain at the surface",
        Field::AccumulatedPlasticStrain if torsion => "accumulated plastic shear strain at the surface",
        Field::Stress => "stress",
        Field::Strain => "strain",
        Field::Velocity => "velocity",
        Field::Displacement => "displacement",
        Field::PlasticStrain => "plastic strain",
        Field::AccumulatedPlasticStrain => "accumulated plastic strain",
        Field::Temperature => "temperature",
        Field::Torque => "torque",
        Field::Twist => "twist",
        Field::AngularVelocity => "angular velocity",
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn inch_pound_units_have_their_exact_factors() {
        // 1 ksi = 1000 lbf/in^2 = 6.894757293... MPa, to the digits usually printed.
        assert!((Units::Us.stress().factor * 6.894_757_293_168_36e6 - 1.0).abs() < 1e-14);
        assert_eq!(Units::Us.velocity().show(30.48), "100.0 ft/s");
        for symbol in ["N m", "N*m"] {
            assert_eq!(Units::Si.of_symbol(symbol, 2.0).label("torque"), "torque (N\u{b7}m)");
        }
        // 1 lb/in^3 = 27679.9047 kg/m^3.
        assert_eq!(Units::Us.density().number(27_679.904_71 * 0.284), "0.2840");
    }

    #[test]
    fn four_digits_stay_readable() {
        assert_eq!(four_digits(-0.000_123_456), "\u{2212}0.0001235");
        assert_eq!(four_digits(1_234_567.0), "1234567");
        assert_eq!(four_digits(1.5e-15), "1.500e\u{2212}15");
        assert_eq!(Units::Si.stress().show(f64::NAN), "\u{2013}");
    }
}
