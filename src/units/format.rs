//! Numbers for people: SI in, text with a fitting unit out.

use super::{Dimension, System};

/// A unit to show numbers in.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Scale {
    /// e.g. "MPa"; empty for plain numbers.
    pub symbol: &'static str,
    /// SI value of one such unit.
    pub si: f64,
}

const fn scale(symbol: &'static str, si: f64) -> Scale {
    Scale { symbol, si }
}

const INCH: f64 = 0.0254;
const POUND: f64 = 0.453_592_37;
const POUND_FORCE: f64 = POUND * 9.806_65;
const FOOT_POUND: f64 = 12.0 * INCH * POUND_FORCE;
const PSI: f64 = POUND_FORCE / (INCH * INCH);
const TIMES: [Scale; 4] = [scale("ns", 1e-9), scale("us", 1e-6), scale("ms", 1e-3), scale("s", 1.0)];

/// The unit in which a value of this magnitude reads best: the largest that leaves at least one before the
/// point, or the smallest there is; zero takes the unit nearest to the SI one. For an axis, give the largest
/// value on it.
pub fn scale_for(magnitude: f64, dimension: Dimension, system: System) -> Scale {
    let choices = match system {
        System::Si => si_scales(dimension),
        System::Us => us_scales(dimension),
    };
    let magnitude = if magnitude == 0.0 { 1.0 } else { magnitude.abs() };
    // Just below one is one when rounded for people.
    let fits = |s: &&Scale| magnitude >= s.si * (1.0 - 1e-9);
    *choices.iter().rev().find(fits).unwrap_or(&choices[0])
}

/// A value with a fitting unit, six significant digits: "386.554 MPa".
pub fn format(value: f64, dimension: Dimension, system: System) -> String {
    let scale = scale_for(value, dimension, system);
    let number = significant(value / scale.si);
    if scale.symbol.is_empty() { number } else { format!("{number} {}", scale.symbol) }
}

/// Six significant digits, no trailing zeros; exponents only for very large and very small numbers.
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
    // Digits after the point; below one, the zeros that follow it do not count.
    let decimals = if magnitude == 0.0 { 0 } else { (5.0 - magnitude.log10().floor()).max(0.0) as usize };
    let text = format!("{value:.decimals$}");
    let text = if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.') } else { &text };
    // A zero has no sign for people.
    if text == "-0" { "0".into() } else { text.into() }
}

fn si_scales(dimension: Dimension) -> &'static [Scale] {
    match dimension {
        Dimension::None => const { &[scale("", 1.0)] },
        Dimension::Length => const { &[scale("um", 1e-6), scale("mm", 1e-3), scale("m", 1.0)] },
        Dimension::Area => const { &[scale("mm^2", 1e-6), scale("cm^2", 1e-4), scale("m^2", 1.0)] },
        Dimension::Time => &TIMES,
        Dimension::Velocity => const { &[scale("m/s", 1.0)] },
        Dimension::Stress => const { &[scale("Pa", 1.0), scale("kPa", 1e3), scale("MPa", 1e6), scale("GPa", 1e9)] },
        Dimension::Density => const { &[scale("kg/m^3", 1.0)] },
        Dimension::Mass => const { &[scale("g", 1e-3), scale("kg", 1.0)] },
        Dimension::Force => const { &[scale("N", 1.0), scale("kN", 1e3), scale("MN", 1e6)] },
        Dimension::Stiffness => const { &[scale("N/m", 1.0), scale("kN/m", 1e3), scale("MN/m", 1e6)] },
        Dimension::DampingCoefficient => const { &[scale("N*s/m", 1.0), scale("kN*s/m", 1e3), scale("MN*s/m", 1e6)] },
        Dimension::TorsionalDampingCoefficient => const { &[scale("N*m*s/rad", 1.0), scale("kN*m*s/rad", 1e3)] },
        Dimension::Energy => const { &[scale("J", 1.0), scale("kJ", 1e3), scale("MJ", 1e6)] },
        Dimension::EnergyDensity => const { &[scale("J/m^3", 1.0), scale("kJ/m^3", 1e3), scale("MJ/m^3", 1e6)] },
        Dimension::Rate => const { &[scale("1/s", 1.0)] },
        Dimension::Temperature => const { &[scale("K", 1.0)] },
        Dimension::SpecificHeat => const { &[scale("J/(kg*K)", 1.0)] },
        Dimension::Viscosity => const { &[scale("Pa*s", 1.0), scale("kPa*s", 1e3), scale("MPa*s", 1e6)] },
        Dimension::Drag => const { &[scale("N*s/m^2", 1.0), scale("kN*s/m^2", 1e3)] },
        Dimension::Foundation => const { &[scale("N/m^2", 1.0), scale("kN/m^2", 1e3), scale("MN/m^2", 1e6)] },
        Dimension::AngularVelocity => const { &[scale("rad/s", 1.0)] },
        Dimension::Torque => const { &[scale("N*m", 1.0), scale("kN*m", 1e3)] },
        Dimension::MomentOfInertia => const { &[scale("kg*m^2", 1.0)] },
        Dimension::TorsionalStiffness => const { &[scale("N*m/rad", 1.0), scale("kN*m/rad", 1e3)] },
    }
}

fn us_scales(dimension: Dimension) -> &'static [Scale] {
    match dimension {
        Dimension::Length => const { &[scale("mil", 1e-3 * INCH), scale("in", INCH)] },
        Dimension::Area => const { &[scale("in^2", INCH * INCH)] },
        Dimension::Velocity => const { &[scale("ft/s", 12.0 * INCH)] },
        Dimension::Stress => const { &[scale("psi", PSI), scale("ksi", 1e3 * PSI)] },
        Dimension::Density => const { &[scale("lb/in^3", POUND / (INCH * INCH * INCH))] },
        Dimension::Mass => const { &[scale("lb", POUND)] },
        Dimension::Force => const { &[scale("lbf", POUND_FORCE), scale("kip", 1e3 * POUND_FORCE)] },
        Dimension::Stiffness => const { &[scale("lbf/in", POUND_FORCE / INCH)] },
        Dimension::DampingCoefficient => const { &[scale("lbf*s/in", POUND_FORCE / INCH)] },
        Dimension::TorsionalDampingCoefficient => const { &[scale("lbf*ft*s/rad", FOOT_POUND)] },
        Dimension::Energy => const { &[scale("ft*lbf", FOOT_POUND)] },
        Dimension::EnergyDensity => const { &[scale("ft*lbf/in^3", FOOT_POUND / (INCH * INCH * INCH))] },
        // A temperature may be a difference: kelvin for both.
        Dimension::None | Dimension::Time | Dimension::Rate | Dimension::Temperature | Dimension::AngularVelocity => {
            si_scales(dimension)
        }
        Dimension::Torque => const { &[scale("lbf*ft", FOOT_POUND)] },
        Dimension::MomentOfInertia => const { &[scale("lb*ft^2", POUND * 144.0 * INCH * INCH)] },
        Dimension::TorsionalStiffness => const { &[scale("lbf*ft/rad", FOOT_POUND)] },
        Dimension::SpecificHeat => const { &[scale("Btu/(lb*K)", 1_055.055_852_62 / POUND)] },
        Dimension::Viscosity => const { &[scale("psi*s", PSI)] },
        Dimension::Drag => const { &[scale("lbf*s/in^2", PSI)] },
        Dimension::Foundation => const { &[scale("lbf/in^2", PSI)] },
    }
}

#[cfg(test)]
mod tests {
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
    fn extremes_stay_readable() {
        assert_eq!(significant(1.234_567_8e9), "1.23457e9");
        assert_eq!(significant(-2e-7), "-2e-7");
        assert_eq!(significant(-0.0), "0");
        assert_eq!(significant(123_456.7), "123457");
        assert_eq!(significant(f64::NAN), "NaN");
    }
}
