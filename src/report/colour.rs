//! Colour maps, one sequential and one diverging, and conversions of colours.

/// Colour map over 0..=1.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum ColourMap {
    /// Dark blue to yellow with uniform change in lightness (viridis): for values of one sign.
    Sequential,
    /// Blue to white to red: for signed values, with zero in the middle.
    Diverging,
}

/// Colours of viridis at nine equidistant positions.
const VIRIDIS: [[u8; 3]; 9] = [
    [68, 1, 84],
    [71, 44, 122],
    [59, 81, 139],
    [44, 113, 142],
    [33, 144, 141],
    [39, 173, 129],
    [92, 200, 99],
    [170, 220, 50],
    [253, 231, 37],
];

/// Blue, white, red at nine equidistant positions (Brewer's `RdBu`, reversed, with white in the middle).
const BLUE_RED: [[u8; 3]; 9] = [
    [5, 48, 97],
    [33, 102, 172],
    [67, 147, 195],
    [146, 197, 222],
    [250, 250, 250],
    [244, 165, 130],
    [214, 96, 77],
    [178, 24, 43],
    [103, 0, 31],
];

impl ColourMap {
    /// Returns the colour at a position on the map, clamped to 0..=1; NaN is grey.
    pub fn at(self, place: f64) -> [u8; 3] {
        if place.is_nan() {
            return [190, 190, 190];
        }
        let stops = match self {
            Self::Sequential => &VIRIDIS,
            Self::Diverging => &BLUE_RED,
        };
        let scaled = place.clamp(0.0, 1.0) * (stops.len() - 1) as f64;
        let lower = (scaled as usize).min(stops.len() - 2);
        let part = scaled - lower as f64;
        std::array::from_fn(|i| {
            let (a, b) = (f64::from(stops[lower][i]), f64::from(stops[lower + 1][i]));
            (a + (b - a) * part).round() as u8
        })
    }
}

/// Returns the red, green and blue bytes of a hexadecimal colour `rrggbb` or `rgb` (without `#`).
pub(super) fn bytes(colour: &str) -> Option<[u8; 3]> {
    let number = u32::from_str_radix(colour, 16).ok()?;
    match colour.len() {
        3 => Some([8, 4, 0].map(|shift| 17 * (number >> shift & 15) as u8)),
        6 => Some([16, 8, 0].map(|shift| (number >> shift & 255) as u8)),
        _ => None,
    }
}

/// Returns red, green and blue of a colour as it is written in SVG.
///
/// # Errors
/// A sentence, if the colour is neither `black`, `white` nor hexadecimal.
pub(super) fn rgb(colour: &str) -> Result<[u8; 3], String> {
    match colour {
        "black" => Ok([0; 3]),
        "white" => Ok([255; 3]),
        _ => colour.strip_prefix('#').and_then(bytes).ok_or_else(|| format!("`{colour}` is no colour")),
    }
}

/// Returns the colour as `#rrggbb`.
pub(super) fn hex([r, g, b]: [u8; 3]) -> String {
    format!("#{r:02x}{g:02x}{b:02x}")
}

/// Interval of values with its colour map.
#[derive(Debug, Clone, Copy)]
pub(super) struct Range {
    pub low: f64,
    pub high: f64,
    pub map: ColourMap,
    /// True if the value of largest magnitude is `low`: the map then runs from `high` to `low`.
    pub reversed: bool,
}

impl Range {
    /// Chooses the map for values from `low` to `high`: diverging around zero if both signs are present (the smaller magnitude at least a
    /// twentieth of the larger one), otherwise sequential from the smaller to the larger magnitude.
    pub fn of(low: f64, high: f64) -> Self {
        let largest = high.max(-low);
        if !(high > low && largest.is_finite()) {
            let low = if low.is_finite() { low } else { 0.0 };
            return Self { low, high: low + 1.0, map: ColourMap::Sequential, reversed: false };
        }
        if high.min(-low) >= 0.05 * largest {
            return Self { low: -largest, high: largest, map: ColourMap::Diverging, reversed: false };
        }
        Self { low, high, map: ColourMap::Sequential, reversed: -low > high }
    }

    /// Returns the colour of a value.
    pub fn colour(&self, value: f64) -> [u8; 3] {
        let place = (value - self.low) / (self.high - self.low);
        self.map.at(if self.reversed { 1.0 - place } else { place })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn signed_values_are_centred_on_white() {
        let range = Range::of(-50.0, 200.0);
        assert_eq!((range.low, range.high, range.map), (-200.0, 200.0, ColourMap::Diverging));
        assert_eq!(range.colour(0.0), [250, 250, 250]);
    }

    #[test]
    fn one_sign_runs_from_zero_whichever_it_is() {
        let tension = Range::of(0.0, 10.0);
        let compression = Range::of(-10.0, 0.0);
        assert_eq!(tension.colour(0.0), VIRIDIS[0]);
        assert_eq!(compression.colour(0.0), VIRIDIS[0]);
        assert_eq!(tension.colour(10.0), compression.colour(-10.0));
    }

    #[test]
    fn nothing_and_not_a_number_have_colours_too() {
        assert_eq!(Range::of(0.0, 0.0).colour(0.0), VIRIDIS[0]);
        assert_eq!(Range::of(0.0, 1.0).colour(f64::NAN), [190, 190, 190]);
    }
}
