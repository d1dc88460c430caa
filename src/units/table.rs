//! The known unit symbols. A factor is a mantissa times a power of ten; the mantissa is an exact number except for `slug`, `kph`, angles and
//! pressures in pounds per area.

/// Exponents of m, kg, s, K.
pub(super) type Exponents = [i32; 4];

/// A unit symbol: 1 symbol = mantissa * 10^ten of the SI unit with these exponents.
#[derive(Debug, Clone, Copy)]
pub(super) struct Unit {
    pub(super) symbol: &'static str,
    pub(super) mantissa: f64,
    pub(super) ten: i32,
    pub(super) exponents: Exponents,
    /// Whether SI prefixes are allowed: "k" + "Pa".
    prefixed: bool,
}

const fn unit(symbol: &'static str, mantissa: f64, ten: i32, exponents: Exponents) -> Unit {
    Unit { symbol, mantissa, ten, exponents, prefixed: false }
}

const fn si(symbol: &'static str, ten: i32, exponents: Exponents) -> Unit {
    Unit { symbol, mantissa: 1.0, ten, exponents, prefixed: true }
}

const ONE: Exponents = [0, 0, 0, 0];
const LENGTH: Exponents = [1, 0, 0, 0];
const MASS: Exponents = [0, 1, 0, 0];
const TIME: Exponents = [0, 0, 1, 0];
const TEMPERATURE: Exponents = [0, 0, 0, 1];
const FORCE: Exponents = [1, 1, -2, 0];
const STRESS: Exponents = [-1, 1, -2, 0];
const ENERGY: Exponents = [2, 1, -2, 0];
const VELOCITY: Exponents = [1, 0, -1, 0];

/// Pound force: 0.45359237 kg * 9.80665 m/s^2, as an integer times 10^-13.
const LBF: f64 = 45_359_237.0 * 980_665.0;
// Integers are exact only below 2^53.
const _: () = assert!(LBF < 9_007_199_254_740_992.0);
/// Square inch, times 10^8 m^-2.
const SQUARE_INCH: f64 = 254.0 * 254.0;

/// The unit symbols by exact definitions: in = 0.0254 m, lb = 0.45359237 kg, standard gravity = 9.80665 m/s^2, atm = 101325 Pa, cal = 4.184 J
/// (thermochemical), Btu = 1055.05585262 J (International Table). Pressures in pounds per area, `slug`, `kph` and angles have no finite decimal
/// value: their mantissa is a rounded quotient.
pub(super) const UNITS: &[Unit] = &[
    // SI and metric
    si("m", 0, LENGTH),
    si("g", -3, MASS),
    si("s", 0, TIME),
    si("K", 0, TEMPERATURE),
    si("N", 0, FORCE),
    si("Pa", 0, STRESS),
    si("J", 0, ENERGY),
    si("W", 0, [2, 1, -3, 0]),
    si("Hz", 0, [0, 0, -1, 0]),
    si("bar", 5, STRESS),
    unit("t", 1.0, 3, MASS),
    unit("tonne", 1.0, 3, MASS),
    unit("L", 1.0, -3, [3, 0, 0, 0]),
    unit("min", 60.0, 0, TIME),
    unit("h", 3600.0, 0, TIME),
    unit("hr", 3600.0, 0, TIME),
    unit("sec", 1.0, 0, TIME),
    unit("gf", 980_665.0, -8, FORCE),
    unit("kgf", 980_665.0, -5, FORCE),
    unit("dyn", 1.0, -5, FORCE),
    unit("erg", 1.0, -7, ENERGY),
    unit("cal", 4184.0, -3, ENERGY),
    unit("kcal", 4184.0, 0, ENERGY),
    unit("atm", 101_325.0, 0, STRESS),
    unit("kph", 1.0 / 3.6, 0, VELOCITY),
    // inch-pound: lb is mass, lbf is force
    unit("in", 254.0, -4, LENGTH),
    unit("inch", 254.0, -4, LENGTH),
    unit("inches", 254.0, -4, LENGTH),
    unit("mil", 254.0, -7, LENGTH),
    unit("thou", 254.0, -7, LENGTH),
    unit("ft", 3048.0, -4, LENGTH),
    unit("foot", 3048.0, -4, LENGTH),
    unit("feet", 3048.0, -4, LENGTH),
    unit("yd", 9144.0, -4, LENGTH),
    unit("mi", 1_609_344.0, -3, LENGTH),
    unit("lb", 45_359_237.0, -8, MASS),
    unit("lbs", 45_359_237.0, -8, MASS),
    unit("lbm", 45_359_237.0, -8, MASS),
    unit("oz", 45_359_237.0 / 16.0, -8, MASS),
    unit("lbf", LBF, -13, FORCE),
    unit("kip", LBF, -10, FORCE),
    unit("kips", LBF, -10, FORCE),
    unit("slug", LBF / 3048.0, -9, MASS),
    unit("slugs", LBF / 3048.0, -9, MASS),
    unit("slinch", LBF / 254.0, -9, MASS),
    unit("psi", LBF / SQUARE_INCH, -5, STRESS),
    unit("kpsi", LBF / SQUARE_INCH, -2, STRESS),
    unit("ksi", LBF / SQUARE_INCH, -2, STRESS),
    unit("Mpsi", LBF / SQUARE_INCH, 1, STRESS),
    unit("Msi", LBF / SQUARE_INCH, 1, STRESS),
    unit("psf", LBF / (3048.0 * 3048.0), -5, STRESS),
    unit("mph", 44_704.0, -5, VELOCITY),
    unit("fps", 3048.0, -4, VELOCITY),
    unit("ips", 254.0, -4, VELOCITY),
    unit("Btu", 105_505_585_262.0, -8, ENERGY),
    unit("BTU", 105_505_585_262.0, -8, ENERGY),
    // angles, in radians
    si("rad", 0, ONE),
    unit("deg", std::f64::consts::PI / 180.0, 0, ONE),
    unit("rev", 2.0 * std::f64::consts::PI, 0, ONE),
    unit("rpm", std::f64::consts::PI / 30.0, 0, [0, 0, -1, 0]),
    // plain numbers
    unit("%", 1.0, -2, ONE),
    unit("percent", 1.0, -2, ONE),
];

const PREFIXES: &[(&str, i32)] = &[
    ("p", -12),
    ("n", -9),
    ("u", -6),
    ("m", -3),
    ("c", -2),
    ("d", -1),
    ("h", 2),
    ("k", 3),
    ("M", 6),
    ("G", 9),
    ("T", 12),
];

/// Temperature scales with an offset zero: kelvin = (value + offset) * 5/9, or value + offset.
pub(super) const DEGREES: &[&str] = &["degC", "°C", "℃", "degF", "°F", "℉"];

/// Returns the unit of a symbol; whole symbols have priority over prefixed ones ("min" is a minute, "ft" a foot).
pub(super) fn find(symbol: &str) -> Option<Unit> {
    if let Some(whole) = UNITS.iter().find(|u| u.symbol == symbol) {
        return Some(*whole);
    }
    PREFIXES.iter().find_map(|&(prefix, power)| {
        let base = symbol.strip_prefix(prefix)?;
        let found = UNITS.iter().find(|u| u.prefixed && u.symbol == base)?;
        Some(Unit { ten: found.ten + power, ..*found })
    })
}

fn known() -> impl Iterator<Item = String> {
    let prefixed = UNITS.iter().filter(|u| u.prefixed);
    let with_prefix = prefixed.flat_map(|u| ["M", "k", "G", "m", "u", "c", "n"].map(|p| format!("{p}{}", u.symbol)));
    UNITS.iter().map(|u| u.symbol.to_owned()).chain(DEGREES.iter().map(|&d| d.to_owned())).chain(with_prefix)
}

/// Returns the known symbol that differs from this one only in capitalization.
pub(super) fn in_another_case(symbol: &str) -> Option<String> {
    known().find(|k| k.eq_ignore_ascii_case(symbol))
}

/// Returns the known symbol most similar to an unknown one: first another capitalization ("mpa"), then a few changed letters.
pub(super) fn nearest(symbol: &str) -> Option<String> {
    if let Some(other_case) = in_another_case(symbol) {
        return Some(other_case);
    }
    let limit = match symbol.chars().count() {
        // Any single letter is one change from any other.
        ..=1 => return None,
        2..=5 => 1,
        _ => 2,
    };
    known()
        .map(|k| (strsim::osa_distance(&k.to_lowercase(), &symbol.to_lowercase()), k))
        .filter(|(distance, _)| *distance <= limit)
        .min_by_key(|(distance, _)| *distance)
        .map(|(_, k)| k)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn symbols_are_unique() {
        for (i, unit) in UNITS.iter().enumerate() {
            assert!(UNITS[..i].iter().all(|u| u.symbol != unit.symbol), "duplicate unit {}", unit.symbol);
        }
    }

    #[test]
    fn nearest_prefers_another_case() {
        assert_eq!(nearest("mpa").as_deref(), Some("MPa"));
        assert_eq!(nearest("Psi").as_deref(), Some("psi"));
        assert_eq!(nearest("inchs").as_deref(), Some("inch"));
        assert_eq!(nearest("furlong"), None);
        assert_eq!(nearest("x"), None);
    }
}
