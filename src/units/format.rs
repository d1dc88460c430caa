//! Formatting of SI values with a suitable unit.

use super::{Dimension, Scale, System};

/// Returns the most readable unit for a value of this magnitude: the largest unit in which the value is at least one, or the smallest there is.
/// Zero is shown in the unit nearest to the SI one. For an axis, give its largest value.
pub fn scale_for(magnitude: f64, dimension: Dimension, system: System) -> Scale {
    let choices = match system {
        System::Si => dimension.si_scales(),
        System::Us => dimension.us_scales(),
    };
    let magnitude = if magnitude == 0.0 { 1.0 } else { magnitude.abs() };
    // A value just below one is shown as one after rounding.
    let fits = |s: &&Scale| magnitude >= s.si * (1.0 - 1e-9);
    *choices.iter().rev().find(fits).unwrap_or(&choices[0])
}

impl System {
    /// Returns the unit of columns and axes, the same for all their values: one that suits bars and the loads on them, such as MPa or ksi.
    pub fn of_columns(self, dimension: Dimension) -> Scale {
        let usual = match dimension {
            Dimension::Stress => 100e6,
            Dimension::Length => 0.1,
            Dimension::Time => 100e-6,
            _ => 10.0,
        };
        scale_for(usual, dimension, self)
    }
}

impl Scale {
    /// Converts an SI value to this unit.
    pub fn of(self, value: f64) -> f64 {
        value / self.si
    }
}

/// Formats a value in a suitable unit with six significant digits: "386.554 MPa".
pub fn format(value: f64, dimension: Dimension, system: System) -> String {
    let scale = scale_for(value, dimension, system);
    let number = significant(value / scale.si);
    if scale.symbol.is_empty() { number } else { format!("{number} {}", scale.symbol) }
}

/// Formats a number with six significant digits and no trailing zeros; exponents only for very large and very small numbers.
fn significant(value: f64) -> String {
    let magnitude = value.abs();
    if !value.is_finite() {
        return value.to_string();
    }
    if magnitude != 0.0 && !(1e-3..1e6).contains(&magnitude) {
        let text = format!("{value:.5e}");
        let (mantissa, power) = text.split_once('e').unwrap_or((&text, "0"));
        return format!("{}e{power}", mantissa.trim_end_matches('0').trim_end_matches('.'));
    }
    // Digits after the point; below one, leading zeros do not count.
    let decimals = if magnitude == 0.0 { 0 } else { (5.0 - magnitude.log10().floor()).max(0.0) as usize };
    let text = format!("{value:.decimals$}");
    let text = if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.') } else { &text };
    // "-0" is shown as "0".
    if text == "-0" { "0".into() } else { text.into() }
}

#[cfg(test)]
mod tests {
    use super::super::scale::PSI;
    use super::*;

    #[test]
    fn prefixes_fit_the_magnitude() {
        let si = |v, d| format(v, d, System::Si);
        assert_eq!(si(386.554e6, Dimension::Stress), "386.554 MPa");
        assert_eq!(si(200e9, Dimension::Stress), "200 GPa");
        assert_eq!(si(-30.0, Dimension::Velocity), "-30 m/s");
        assert_eq!(si(600e-6, Dimension::Time), "600 us");
        assert_eq!(si(0.5, Dimension::Length), "500 mm");
        assert_eq!(si(0.0, Dimension::Stress), "0 Pa");
        assert_eq!(si(1e-4, Dimension::Area), "1 cm^2");
        assert_eq!(si(0.014_413_2, Dimension::None), "0.0144132");
        let us = |v, d| format(v, d, System::Us);
        assert_eq!(us(80.0 * 0.3048, Dimension::Velocity), "80 ft/s");
        assert_eq!(us(0.254, Dimension::Length), "10 in");
        assert_eq!(us(29e6 * PSI, Dimension::Stress), "29000 ksi");
    }

    #[test]
    fn columns_have_the_units_of_bars() {
        let symbols = |system: System| {
            let all = [Dimension::Stress, Dimension::Length, Dimension::Time, Dimension::Velocity, Dimension::Energy];
            all.map(|dimension| system.of_columns(dimension).symbol)
        };
        assert_eq!(symbols(System::Si), ["MPa", "mm", "us", "m/s", "J"]);
        assert_eq!(symbols(System::Us), ["ksi", "in", "us", "ft/s", "ft*lbf"]);
        assert!((System::Us.of_columns(Dimension::Velocity).of(0.3048) - 1.0).abs() < 1e-12);
    }

    #[test]
    fn extremes_stay_readable() {
        assert_eq!(significant(1.234_567_8e9), "1.23457e9");
        assert_eq!(significant(-2e-7), "-2e-7");
        assert_eq!(significant(-0.0), "0");
        assert_eq!(significant(123_456.7), "123457");
        assert_eq!(significant(f64::NAN), "NaN");
    }
}
