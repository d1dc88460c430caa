//! Ranges of numbers.

use crate::units::Dimension;

/// An allowed range, shown as the user would write it.
#[derive(Debug, Clone, Copy)]
pub enum Allowed {
    /// Any finite number.
    Finite,
    /// > 0.
    Positive,
    /// >= 0.
    NotNegative,
    /// low..=high.
    Within(f64, f64),
    /// low < value <= high.
    Above(f64, f64),
    /// low <= value < high.
    Below(f64, f64),
    /// low < value < high.
    Between(f64, f64),
}

impl Allowed {
    /// Whether a value (SI) lies in the range; never true of NaN or infinities.
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

    /// The range as text, e.g. "0 < cfl <= 1", with the SI unit where the bounds have one.
    pub fn describe(self, name: &str, dimension: Dimension) -> String {
        let unit = match dimension.si_symbol() {
            "" => String::new(),
            symbol => format!(" {symbol}"),
        };
        match self {
            Self::Finite => "any finite number".into(),
            Self::Positive => format!("{name} > 0"),
            Self::NotNegative => format!("{name} >= 0"),
            Self::Within(low, high) => format!("{} <= {name} <= {high}{unit}", bound(low)),
            Self::Above(low, high) => format!("{} < {name} <= {high}{unit}", bound(low)),
            Self::Below(low, high) => format!("{} <= {name} < {high}{unit}", bound(low)),
            Self::Between(low, high) => format!("{} < {name} < {high}{unit}", bound(low)),
        }
    }
}

/// Small numbers with an exponent.
fn bound(value: f64) -> String {
    if value != 0.0 && value.abs() < 1e-4 { format!("{value:e}") } else { value.to_string() }
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
    }
}
