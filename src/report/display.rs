//! Display units: conversion factor from SI, symbol, and axis label of each quantity.

use crate::record::Field;
use crate::units::{Dimension, System, in_units, one, scale_for};

/// System of units of a report.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Units {
    /// m, MPa, m/s.
    #[default]
    Si,
    /// in, ksi, ft/s.
    Us,
}

/// Unit in which values are shown.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Unit {
    /// Conversion factor: shown value = factor times SI value.
    pub factor: f64,
    /// Symbol as it is declared with the units, such as "ft*lbf/in^2"; empty for a number without unit.
    pub symbol: &'static str,
}

/// Unit of dimensionless numbers.
pub(super) const PLAIN: Unit = Unit { factor: 1.0, symbol: "" };

impl Unit {
    /// Returns the unit with this symbol.
    fn named(symbol: &'static str, dimension: Dimension) -> Self {
        // An unknown symbol gives NaN, shown as no value, rather than a wrong value.
        Self { factor: 1.0 / one(symbol, dimension).unwrap_or(f64::NAN), symbol }
    }

    /// Returns the symbol for print, with raised dots in products, raised exponents, and the micro sign.
    fn printed(self) -> String {
        let raised = [("*", "\u{b7}"), ("^2", "\u{b2}"), ("^3", "\u{b3}"), ("^4", "\u{2074}")];
        let symbol =
            raised.iter().fold(self.symbol.to_owned(), |symbol, (plain, raised)| symbol.replace(plain, raised));
        match symbol.strip_prefix('u') {
            Some(unit) => format!("\u{b5}{unit}"),
            None => symbol,
        }
    }

    /// Returns the label `name (unit)`.
    pub fn label(self, name: &str) -> String {
        if self.symbol.is_empty() { name.to_owned() } else { format!("{name} ({})", self.printed()) }
    }

    /// Returns a value with its unit, in four significant digits; a dash if it is not finite.
    pub fn show(self, value: f64) -> String {
        if !value.is_finite() {
            return "\u{2013}".into();
        }
        let number = four_digits(value * self.factor);
        if self.symbol.is_empty() { number } else { format!("{number} {}", self.printed()) }
    }

    /// Returns a value with its unit for legends, in at most four significant digits without trailing zeros.
    pub fn brief(self, value: f64) -> String {
        let number = four_digits(value * self.factor);
        let number = if number.contains('.') && !number.contains('e') {
            number.trim_end_matches('0').trim_end_matches('.').to_owned()
        } else {
            number
        };
        format!("{number} {}", self.printed()).trim_end().to_owned()
    }

    /// Returns a value without its unit, in four significant digits; a dash if it is not finite.
    pub fn number(self, value: f64) -> String {
        if value.is_finite() { four_digits(value * self.factor) } else { "\u{2013}".into() }
    }
}

/// Returns a number in four significant digits, with an exponent only if plain decimals would be long.
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
    /// Returns a sentence with its quantities converted to these units.
    pub(super) fn sentence(self, text: &str) -> String {
        in_units(text, self.system())
    }

    fn system(self) -> System {
        match self {
            Self::Si => System::Si,
            Self::Us => System::Us,
        }
    }

    /// Returns the unit for this system from a pair (SI, US) of the same dimension.
    fn either(self, [si, us]: [&'static str; 2], dimension: Dimension) -> Unit {
        match self {
            Self::Si => Unit::named(si, dimension),
            Self::Us => Unit::named(us, dimension),
        }
    }

    /// Returns the unit for times up to `longest` (s).
    pub(super) fn time(longest: f64) -> Unit {
        let symbol = match longest {
            _ if longest < 2e-3 => "us",
            _ if longest < 2.0 => "ms",
            _ => "s",
        };
        Unit::named(symbol, Dimension::Time)
    }

    /// Returns the unit for positions on a bar of `length` (m).
    pub(super) fn length(self, length: f64) -> Unit {
        let symbols = [if length < 0.2 { "mm" } else { "m" }, if length < 10.0 { "in" } else { "ft" }];
        self.either(symbols, Dimension::Length)
    }

    pub(super) fn stress(self) -> Unit {
        self.either(["MPa", "ksi"], Dimension::Stress)
    }

    pub(super) fn velocity(self) -> Unit {
        self.either(["m/s", "ft/s"], Dimension::Velocity)
    }

    /// Returns the unit for an energy from the unit that is stored in the file: "J", or "J/m^2" for an energy per area.
    pub(super) fn energy(self, stored: &str) -> Unit {
        match stored {
            "J" => self.either(["J", "ft*lbf"], Dimension::Energy),
            _ => self.either(["kJ/m^2", "ft*lbf/in^2"], Dimension::EnergyPerArea),
        }
    }

    pub(super) fn density(self) -> Unit {
        self.either(["kg/m^3", "lb/in^3"], Dimension::Density)
    }

    /// Returns the unit for values up to `most` from an SI symbol, whose factors are separated by spaces or, in files of older versions, by "*".
    /// Without a matching dimension, the unit is [`PLAIN`].
    pub(super) fn of_symbol(self, symbol: &str, most: f64) -> Unit {
        let symbol = symbol.replace('*', " ");
        let Some(dimension) =
            Dimension::ALL.iter().copied().find(|d| d.spaced_symbol() == symbol && !symbol.is_empty())
        else {
            return PLAIN;
        };
        let scale = scale_for(most, dimension, self.system());
        Unit { factor: 1.0 / scale.si, symbol: scale.symbol }
    }

    /// Returns the unit of a recorded field.
    pub(super) fn field(self, field: Field) -> Unit {
        match field {
            Field::Stress => self.stress(),
            Field::Velocity => self.velocity(),
            Field::Displacement => self.either(["mm", "in"], Dimension::Length),
            Field::Temperature => Unit::named("K", Dimension::Temperature),
            Field::Strain | Field::PlasticStrain | Field::AccumulatedPlasticStrain => PLAIN,
            Field::Torque => self.either(["N*m", "lbf*ft"], Dimension::Torque),
            Field::Twist => self.twist(),
            Field::AngularVelocity => Unit::named("rad/s", Dimension::AngularVelocity),
        }
    }

    /// Returns the unit of a twist, an angle per length.
    fn twist(self) -> Unit {
        let length = self.either(["m", "in"], Dimension::Length);
        Unit { factor: 1.0 / length.factor, symbol: if self == Self::Si { "rad/m" } else { "rad/in" } }
    }
}

/// Returns the name of a field for axes; with `torsion`, that of the field at the surface of a twisted bar.
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
        assert_eq!(Units::Us.of_symbol("m^2", 2e-3).label("area"), "area (in\u{b2})");
        assert_eq!(Units::Si.of_symbol("m", 2e-6).label("depth"), "depth (\u{b5}m)");
        // 1 lb/in^3 = 27679.9047 kg/m^3.
        assert_eq!(Units::Us.density().number(27_679.904_71 * 0.284), "0.2840");
    }

    #[test]
    fn every_unit_has_a_value() {
        for units in [Units::Si, Units::Us] {
            let fields = Field::ALL.map(|field| units.field(field));
            let others =
                [units.density(), units.energy("J"), units.energy("J/m^2"), units.length(0.1), units.length(20.0)];
            let times = [1e-4, 0.1, 10.0].map(Units::time);
            for unit in fields.iter().chain(&others).chain(&times) {
                assert!(unit.factor.is_finite(), "{unit:?}");
            }
        }
    }

    #[test]
    fn four_digits_stay_readable() {
        assert_eq!(four_digits(-0.000_123_456), "\u{2212}0.0001235");
        assert_eq!(four_digits(1_234_567.0), "1234567");
        assert_eq!(four_digits(1.5e-15), "1.500e\u{2212}15");
        assert_eq!(Units::Si.stress().show(f64::NAN), "\u{2013}");
    }
}
