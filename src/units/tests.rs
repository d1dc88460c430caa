use proptest::prelude::*;

use super::*;

fn si(text: &str, dimension: Dimension) -> f64 {
    Quantity::Text(text.into()).si(dimension).unwrap_or_else(|e| panic!("{text}: {e}"))
}

fn refused(text: &str, dimension: Dimension) -> String {
    Quantity::Text(text.into()).si(dimension).expect_err(text)
}

#[test]
fn a_unit_tells_which_of_like_dimensions_is_meant() {
    let of = |text: &str| Quantity::Text(text.into()).in_si().expect("a quantity").1;
    assert_eq!(["3 rad/s", "3 1/s", "3 kHz"].map(of), [Dimension::AngularVelocity, Dimension::Rate, Dimension::Rate]);
    assert_eq!(["3 N*m", "3 J", "3 mJ"].map(of), [Dimension::Torque, Dimension::Energy, Dimension::Energy]);
    assert_eq!(["3 m", "3"].map(of), [Dimension::Length, Dimension::None]);
    assert!(of("3 rpm").is_like(of("3 rad/s")) && !of("3 m").is_like(of("3 s")));
}

/// Decimal units give exactly the same number as a Rust literal.
#[test]
fn decimal_spellings_are_exact() {
    use Dimension as D;
    let cases: &[(&str, Dimension, f64)] = &[
        ("80 ft/s", D::Velocity, 24.384),
        ("80 fps", D::Velocity, 24.384),
        ("10 in", D::Length, 0.254),
        ("10in", D::Length, 0.254),
        ("10 inches", D::Length, 0.254),
        ("-10 in", D::Length, -0.254),
        ("\u{2212}10 in", D::Length, -0.254),
        ("+10 in", D::Length, 0.254),
        (" 10 in ", D::Length, 0.254),
        ("2 thou", D::Length, 50.8e-6),
        ("2 mil", D::Length, 50.8e-6),
        ("3 feet", D::Length, 0.9144),
        ("1 yd", D::Length, 0.9144),
        ("1 mi", D::Length, 1609.344),
        ("1e3mm", D::Length, 1.0),
        ("1.5E-3 km", D::Length, 1.5),
        (".5 m", D::Length, 0.5),
        ("5. m", D::Length, 5.0),
        ("1 cm^2", D::Area, 1e-4),
        ("1 cm²", D::Area, 1e-4),
        ("1 cm**2", D::Area, 1e-4),
        ("1 in*in", D::Area, 6.4516e-4),
        ("150 us", D::Time, 150e-6),
        ("150 µs", D::Time, 150e-6),
        ("150 μs", D::Time, 150e-6),
        ("150us", D::Time, 150e-6),
        ("2 min", D::Time, 120.0),
        ("3 ms", D::Time, 3e-3),
        ("1 h", D::Time, 3600.0),
        ("5 in/s", D::Velocity, 0.127),
        ("5 in s^-1", D::Velocity, 0.127),
        ("5 m·s⁻¹", D::Velocity, 5.0),
        ("10 mph", D::Velocity, 4.4704),
        ("36 km/h", D::Velocity, 10.0),
        ("200 GPa", D::Stress, 200e9),
        ("200 N/mm^2", D::Stress, 200e6),
        ("10 bar", D::Stress, 1e6),
        ("1 atm", D::Stress, 101_325.0),
        ("1 kgf/mm^2", D::Stress, 9.806_65e6),
        ("7.8 g/cm^3", D::Density, 7800.0),
        ("7.8 t/m^3", D::Density, 7800.0),
        ("7800 kg m^-3", D::Density, 7800.0),
        ("200 lb", D::Mass, 90.718_474),
        ("200 lbm", D::Mass, 90.718_474),
        ("16 oz", D::Mass, 0.453_592_37),
        ("5 kN", D::Force, 5e3),
        ("10 N/mm", D::Stiffness, 1e4),
        ("10 kN/mm", D::Stiffness, 1e7),
        ("5 kJ", D::Energy, 5e3),
        ("5 N*m", D::Energy, 5.0),
        ("1 cal", D::Energy, 4.184),
        ("5 MJ/m^3", D::EnergyDensity, 5e6),
        ("100 1/s", D::Rate, 100.0),
        ("100/s", D::Rate, 100.0),
        ("100 s^-1", D::Rate, 100.0),
        ("100 Hz", D::Rate, 100.0),
        ("50 %", D::None, 0.5),
        ("50%", D::None, 0.5),
        ("0.25", D::None, 0.25),
        ("0.1 in/in", D::None, 0.1),
        ("300 K", D::Temperature, 300.0),
        ("20 degC", D::Temperature, 293.15),
        ("20 °C", D::Temperature, 293.15),
        ("385 J/(kg*K)", D::SpecificHeat, 385.0),
        ("385 J/kg/K", D::SpecificHeat, 385.0),
        ("0.385 J/g/K", D::SpecificHeat, 385.0),
    ];
    for &(text, dimension, expected) in cases {
        assert_eq!(si(text, dimension), expected, "{text}");
    }
}

/// Units based on the pound-force are not decimal: a few roundings of 1.1e-16 each are allowed.
#[test]
fn pound_force_spellings_are_right_to_the_last_digits() {
    use Dimension as D;
    let lbf = 4.448_221_615_260_5;
    let cases: &[(&str, Dimension, f64)] = &[
        ("29e6 psi", D::Stress, 29e6 * lbf / 6.4516e-4),
        ("29000 ksi", D::Stress, 29e6 * lbf / 6.4516e-4),
        ("29 Mpsi", D::Stress, 29e6 * lbf / 6.4516e-4),
        ("29 Msi", D::Stress, 29e6 * lbf / 6.4516e-4),
        ("29e6 lbf/in^2", D::Stress, 29e6 * lbf / 6.4516e-4),
        ("144 psf", D::Stress, lbf / 6.4516e-4),
        ("3 kip", D::Force, 3e3 * lbf),
        ("3000 lbf", D::Force, 3e3 * lbf),
        ("1 slug", D::Mass, lbf / 0.3048),
        ("1 lbf*s^2/ft", D::Mass, lbf / 0.3048),
        ("0.284 lb/in^3", D::Density, 0.284 * 0.453_592_37 / 1.638_706_4e-5),
        ("7.35e-4 lbf*s^2/in^4", D::Density, 7.35e-4 * lbf / 0.0254_f64.powi(4)),
        ("15.2 slug/ft^3", D::Density, 15.2 * lbf / 0.3048_f64.powi(4)),
        ("50 lbf/in", D::Stiffness, 50.0 * lbf / 0.0254),
        ("500 ft*lbf/in^3", D::EnergyDensity, 500.0 * 0.3048 * lbf / 1.638_706_4e-5),
        ("500 ft lbf/in^3", D::EnergyDensity, 500.0 * 0.3048 * lbf / 1.638_706_4e-5),
        ("500 ft·lbf/in³", D::EnergyDensity, 500.0 * 0.3048 * lbf / 1.638_706_4e-5),
        ("1 Btu", D::Energy, 1_055.055_852_62),
        ("68 degF", D::Temperature, 293.15),
        ("36 kph", D::Velocity, 10.0),
    ];
    for &(text, dimension, expected) in cases {
        let relative = (si(text, dimension) / expected - 1.0).abs();
        assert!(relative < 1e-15, "{text}: {relative:e}");
    }
}

/// The chapter's 500 ft lb/in^3 is 41.37 MJ/m^3 to the digits printed there.
#[test]
fn rupture_energy_of_the_chapter() {
    assert!((si("500 ft*lbf/in^3", Dimension::EnergyDensity) - 41.37e6).abs() < 0.005e6);
}

#[test]
fn a_wrong_dimension_names_both_and_an_example() {
    let message = refused("10 kg", Dimension::Length);
    assert_eq!(message, "`10 kg` is a mass, but a length is expected, e.g. \"10 in\"");
    let message = refused("30 ksi", Dimension::Velocity);
    assert!(message.contains("is a stress, but a velocity is expected"), "{message}");
    let message = refused("200 lbf", Dimension::Mass);
    assert!(message.contains("`lb` is mass, `lbf` is force"), "{message}");
    let message = refused("20 degC", Dimension::Time);
    assert!(message.contains("is a temperature, but a time"), "{message}");
    // Units are read from left to right and a blank multiplies, so that K is not in the denominator here.
    assert!(refused("385 J/kg K", Dimension::SpecificHeat).contains("is in m^2 s^-2 K, but a specific heat"));
}

#[test]
fn an_unknown_unit_names_the_nearest() {
    assert_eq!(refused("30 mpsi", Dimension::Stress), "unknown unit `mpsi`; did you mean `Mpsi`?");
    assert_eq!(refused("30 mpa", Dimension::Stress), "unknown unit `mpa`; did you mean `MPa`?");
    assert_eq!(refused("30 metr", Dimension::Length), "unknown unit `metr`");
    assert_eq!(refused("30 furlong", Dimension::Length), "unknown unit `furlong`");
    assert!(refused("1 J/degC", Dimension::Energy).contains("use `K`"));
}

#[test]
fn brackets_are_bounded() {
    assert_eq!(si("2 ((m))", Dimension::Length), 2.0);
    assert_eq!(si("2 (m)/(s)/((kg))*(kg)", Dimension::Velocity), 2.0);
    let deep = std::format!("2 {}m{}", "(".repeat(100_000), ")".repeat(100_000));
    assert!(refused(&deep, Dimension::Length).contains("too many brackets"));
}

#[test]
fn what_is_no_quantity_is_refused() {
    use Dimension as D;
    let cases = [
        ("", D::Length, "does not start with a number"),
        ("in", D::Length, "does not start with a number"),
        ("ten in", D::Length, "does not start with a number"),
        ("nan m", D::Length, "does not start with a number"),
        ("inf m", D::Length, "does not start with a number"),
        ("1e999 m", D::Length, "too large"),
        ("1e305 km^9", D::Length, "is in m^9, but a length"),
        ("1e307 km", D::Length, "too large"),
        ("5", D::Length, "has no unit"),
        ("0,5 m", D::Length, "decimal point"),
        ("1 1/2 in", D::Length, "fractions are written as decimals"),
        ("1/2 in", D::Length, "fractions are written as decimals"),
        ("5 000 m", D::Length, "fractions are written as decimals"),
        ("5 m^", D::Length, "power must be an integer"),
        ("5 m^2.5", D::Length, "a unit is expected at `.`"),
        ("5 m^99", D::Length, "power must be an integer"),
        ("5 m/", D::Length, "incomplete"),
        ("5 (m", D::Length, "not closed"),
        ("5 m)", D::Length, "`)` is not expected"),
        ("5 m$", D::Length, "a unit is expected at `$`"),
        ("--5 m", D::Length, "does not start with a number"),
    ];
    for (text, dimension, part) in cases {
        let message = refused(text, dimension);
        assert!(message.contains(part), "{text}: {message}");
    }
    assert!(Quantity::Number(f64::NAN).si(D::Length).is_err());
    assert_eq!(Quantity::Number(3.0).si(D::Length), Ok(3.0));
}

proptest! {
    /// Numbers as shown can be read again, to the six digits shown.
    #[test]
    fn shown_numbers_read_back(mantissa in -9.99_f64..9.99, power in -12_i32..12, d in 0..Dimension::ALL.len(), us: bool) {
        let (value, dimension) = (mantissa * 10f64.powi(power), Dimension::ALL[d]);
        let text = format(value, dimension, if us { System::Us } else { System::Si });
        let back = si(&text, dimension);
        prop_assert!((back - value).abs() <= 5.1e-6 * value.abs(), "{} -> {} -> {}", value, text, back);
    }

    /// Text in SI units gives the number itself.
    #[test]
    fn si_symbols_are_neutral(value in -1e12_f64..1e12, d in 0..Dimension::ALL.len()) {
        let dimension = Dimension::ALL[d];
        let text = std::format!("{value} {}", dimension.si_symbol());
        prop_assert_eq!(si(&text, dimension), value);
    }

    /// No text makes the parser panic.
    #[test]
    fn any_text_is_answered(text in "\\PC{0,20}", d in 0..Dimension::ALL.len()) {
        let _ = Quantity::Text(text).si(Dimension::ALL[d]);
    }

    /// Nor does text that looks like a quantity.
    #[test]
    fn quantity_like_text_is_answered(text in "[-+]?[0-9.]{1,5}(e[-+]?[0-9]{0,3})? ?[a-zµ%()/*^0-9² ]{0,12}") {
        let _ = Quantity::Text(text).si(Dimension::Stress);
    }
}
