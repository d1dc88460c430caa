//! Conversion of the quantities in sentences to the unit system of the reader.

use super::{Dimension, Scale, System, scale_for};

/// Converts the quantities of a sentence written in SI, such as "a stress of 218 MPa", to the units of a system, with as many digits. Text in
/// quotes and times are not changed.
pub fn in_units(sentence: &str, system: System) -> String {
    if system == System::Si {
        return sentence.to_owned();
    }
    let words: Vec<&str> = sentence.split(' ').collect();
    let mut shown = Vec::with_capacity(words.len());
    let mut at = 0;
    while at < words.len() {
        let converted = words.get(at + 1).and_then(|unit| quantity(words[at], unit, system));
        at += if converted.is_some() { 2 } else { 1 };
        shown.push(converted.unwrap_or_else(|| words[at - 1].to_owned()));
    }
    shown.join(" ")
}

/// Converts "(218" and "MPa)," to "(31.6 ksi),"; `None` if they are not a number and a unit that the system replaces by another.
fn quantity(number: &str, unit: &str, system: System) -> Option<String> {
    let digits = number.trim_start_matches('(');
    let symbol = unit.trim_end_matches([',', ';', '.', ':', ')']);
    let (dimension, si) = si_unit(symbol)?;
    let value = si.si * digits.parse::<f64>().ok().filter(|value| value.is_finite())?;
    let scale = scale_for(value, dimension, system);
    if scale == si {
        return None;
    }
    let (before, after) = (&number[..number.len() - digits.len()], &unit[symbol.len()..]);
    Some(format!("{before}{} {}{after}", rounded(value / scale.si, significant_digits(digits)), scale.symbol))
}

/// Returns the dimension and scale of a unit in which SI values are shown.
fn si_unit(symbol: &str) -> Option<(Dimension, Scale)> {
    let of = |dimension: Dimension| dimension.si_scales().iter().find(|scale| scale.symbol == symbol);
    Dimension::ALL.iter().find_map(|&dimension| Some((dimension, *of(dimension)?))).filter(|_| !symbol.is_empty())
}

/// Returns the number of significant digits of a number as written, at least three.
fn significant_digits(number: &str) -> usize {
    let mantissa = number.split(['e', 'E']).next().unwrap_or(number).trim_start_matches(['-', '0', '.']);
    mantissa.chars().filter(char::is_ascii_digit).count().max(3)
}

fn rounded(value: f64, digits: usize) -> String {
    let text = format!("{value:.*e}", digits - 1);
    text.parse::<f64>().map_or(text, |value| super::format(value, Dimension::None, System::Si))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quantities_of_a_sentence_are_converted() {
        for (si, us) in [
            ("a stress of 217.964 MPa; then 339.21 MPa.", "a stress of 31.613 ksi; then 49.198 ksi."),
            ("(bar radius 5 mm, rise time 0 s)", "(bar radius 197 mil, rise time 0 s)"),
            ("a plastic strain of 0.195 in compression", "a plastic strain of 0.195 in compression"),
            ("at t = 110.212 us, x = 254 mm", "at t = 110.212 us, x = 10 in"),
            ("write \"10 mm\" and 800 cells", "write \"10 mm\" and 800 cells"),
            ("at -30 m/s", "at -98.4 ft/s"),
        ] {
            assert_eq!(in_units(si, System::Us), us);
            assert_eq!(in_units(si, System::Si), si);
        }
    }
}
