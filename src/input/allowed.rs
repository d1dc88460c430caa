//! Ranges of numbers.

use crate::units::Dimension;

/// Allowed range of a number.
#[derive(Debug, Clone, Copy)]
pub enum Allowed {
    /// Any finite number.
    Finite,
    /// value > 0.
    Positive,
    /// value >= 0.
    NotNegative,
    /// low <= value <= high.
    Within(f64, f64),
    /// low < value <= high.
    Above(f64, f64),
    /// low <= value < high.
    Below(f64, f64),
    /// low < value < high.
    Between(f64, f64),
}

impl Allowed {
    /// Returns whether a value (SI) is in the range; false for NaN and infinities.
    pub fn holds(self, value: f64) -> bool {
        value.is_finite()
            && match self {
                Self::Finite => true,
                Self::Positive => value > 0.0,
                Self::NotNegative => value >= 0.0,
                Self::Within(low, high) => (low..=high).contains(&value),
                Self::Above(low, high) => value > low && value <= high,
                Self::Below(low, high) => value >= low && value < high,
                Self::Between(low, high) => value > low && value < high,
            }
    }

    /// Returns the range as text, e.g. "0 < cfl <= 1", with the SI unit if the bounds have one.
    pub fn describe(self, name: &str, dimension: Dimension) -> String {
        let unit = match dimension.si_symbol() {
            "" => String::new(),
            symbol => format!(" {symbol}"),
        };
        let (low, less, up_to, high) = match self {
            Self::Finite => return "any finite number".into(),
            Self::Positive => return format!("{name} > 0"),
            Self::NotNegative => return format!("{name} >= 0"),
            Self::Within(low, high) => (low, "<=", "<=", high),
            Self::Above(low, high) => (low, "<", "<=", high),
            Self::Below(low, high) => (low, "<=", "<", high),
            Self::Between(low, high) => (low, "<", "<", high),
        };
        match (low == f64::NEG_INFINITY, high == f64::INFINITY) {
            (false, false) => format!("{} {less} {name} {up_to} {}{unit}", shown(low), shown(high)),
            (true, false) => format!("{name} {up_to} {}{unit}", shown(high)),
            (false, true) => format!("{name} {} {}{unit}", less.replace('<', ">"), shown(low)),
            (true, true) => "any finite number".into(),
        }
    }

    /// Returns the range of meaningful magnitudes if a value (SI) is outside it, otherwise `None`. Values that may be zero have no lower bound.
    pub(super) fn impossible(self, name: &str, value: f64, dimension: Dimension) -> Option<String> {
        let range = dimension.magnitudes();
        let least = if matches!(self, Self::Positive) { range.least } else { 0.0 };
        if (least..=range.most).contains(&value.abs()) {
            return None;
        }
        let bounds = if least > 0.0 { format!("{least:e} <= {name} <= ") } else { format!("|{name}| <= ") };
        Some(format!("{bounds}{:e} {}", range.most, dimension.si_symbol()).trim_end().to_owned())
    }
}

/// Formats a number for a message, with an exponent if it is very small or very large.
pub(super) fn shown(value: f64) -> String {
    let far = value != 0.0 && value.is_finite() && !(1e-4..1e15).contains(&value.abs());
    if far { format!("{value:e}") } else { value.to_string() }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ranges_are_what_they_say() {
        assert!(!Allowed::Above(0.0, 1.0).holds(0.0) && Allowed::Above(0.0, 1.0).holds(1.0));
        assert!(Allowed::Within(0.0, 1.0).holds(0.0) && !Allowed::Within(0.0, 1.0).holds(1.1));
        assert!(!Allowed::Positive.holds(0.0) && Allowed::NotNegative.holds(0.0));
        assert!(!Allowed::Finite.holds(f64::INFINITY));
        let said = |range: Allowed| range.describe("axial", Dimension::Force);
        assert_eq!(said(Allowed::Between(f64::NEG_INFINITY, 5e20)), "axial < 5e20 N");
        assert_eq!(said(Allowed::Within(1.0, f64::INFINITY)), "axial >= 1 N");
    }
}
