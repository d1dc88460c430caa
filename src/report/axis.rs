//! Linear and logarithmic axes with ticks at round numbers.

/// Axis of a plot, linear or logarithmic.
#[derive(Debug, Clone)]
pub(super) struct Axis {
    pub label: String,
    pub low: f64,
    pub high: f64,
    logarithmic: bool,
}

impl Axis {
    /// Creates a linear axis from `low` to `high`. If the interval has no length (one frame, only zeros), the axis is one unit long.
    pub fn new(label: impl Into<String>, low: f64, high: f64) -> Self {
        let high = if high - low > 1e-290 { high } else { low + 1.0 };
        Self { label: label.into(), low, high, logarithmic: false }
    }

    /// Creates a logarithmic axis from `low` to `high`, 0 < low < high.
    pub fn logarithmic(label: impl Into<String>, low: f64, high: f64) -> Self {
        Self { label: label.into(), low, high, logarithmic: true }
    }

    /// Creates a logarithmic axis that contains all positive values, with a margin of a constant factor at either end.
    pub fn logarithmic_around(label: impl Into<String>, values: impl Iterator<Item = f64>) -> Self {
        const ROOM: f64 = 1.3;
        let positive = values.filter(|v| v.is_finite() && *v > 0.0);
        let (low, high) = positive.fold((f64::INFINITY, 0.0_f64), |(low, high), v| (low.min(v), high.max(v)));
        if high > 0.0 { Self::logarithmic(label, low / ROOM, high * ROOM) } else { Self::logarithmic(label, 1.0, 10.0) }
    }

    /// Returns true if the axis is logarithmic.
    pub fn is_logarithmic(&self) -> bool {
        self.logarithmic
    }

    /// Returns the position of a value along the axis: 0 at the low end, 1 at the high end.
    pub fn part(&self, value: f64) -> f64 {
        if self.logarithmic {
            return (value / self.low).ln() / (self.high / self.low).ln();
        }
        (value - self.low) / (self.high - self.low)
    }

    /// Returns the ticks with their labels, and the power of ten that is factored out of the labels.
    pub fn labelled(&self, count: usize) -> (Vec<(f64, String)>, i32) {
        if let Some(labels) = self.decades() {
            return (labels, 0);
        }
        let (ticks, step, power) = self.ticks(count);
        (ticks.into_iter().map(|tick| (tick, tick_label(tick, step, power))).collect(), power)
    }

    /// Returns the labels of a logarithmic axis: at the decades; if the axis covers less than two decades, at 1, 2 and 5 times powers of ten, or
    /// at every digit if these are fewer than three. Returns `None` for a linear axis, and if even the digits are fewer than three: such a short
    /// axis gets the ticks of a linear one.
    fn decades(&self) -> Option<Vec<(f64, String)>> {
        if !self.logarithmic {
            return None;
        }
        let count = |digits: &[u32]| self.digits().filter(|(digit, ..)| digits.contains(digit)).count();
        let finer: [&[u32]; 2] = [&[1, 2, 5], &[1, 2, 3, 4, 5, 6, 7, 8, 9]];
        let digits =
            if self.high / self.low >= 100.0 { &[1] } else { *finer.iter().find(|digits| count(digits) > 2)? };
        let labelled = self.digits().filter(|(digit, ..)| digits.contains(digit));
        let label = |(digit, power, value): (u32, i32, f64)| match digits.len() {
            1 => (value, format!("10{}", superscript(power))),
            _ if (-3..5).contains(&power) => (value, format!("{value:.*}", (-power).max(0) as usize)),
            _ => (value, format!("{digit}\u{b7}10{}", superscript(power))),
        };
        Some(labelled.map(label).collect())
    }

    /// Returns the multiples 1 to 9 of all powers of ten on a logarithmic axis: digit, power and value.
    fn digits(&self) -> impl Iterator<Item = (u32, i32, f64)> {
        let (low, high) = (self.low * (1.0 - 1e-9), self.high * (1.0 + 1e-9));
        let powers = self.low.log10().floor() as i32..=self.high.log10().floor() as i32;
        let all =
            powers.flat_map(|power| (1..10).map(move |digit| (digit, power, f64::from(digit) * 10_f64.powi(power))));
        all.filter(move |(.., value)| (low..=high).contains(value))
    }

    /// Returns the positions of fine grid lines between the labels: every digit of a logarithmic axis, none on a linear one.
    pub fn fine(&self) -> Vec<f64> {
        if self.logarithmic { self.digits().map(|(.., value)| value).collect() } else { Vec::new() }
    }

    /// Creates a linear axis that contains all finite values with a margin of 5 % at either end. For a single value, the margin is half its
    /// magnitude, or 1 if it is zero.
    pub fn around(label: impl Into<String>, values: impl Iterator<Item = f64>) -> Self {
        let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
        for value in values.filter(|v| v.is_finite()) {
            (low, high) = (low.min(value), high.max(value));
        }
        if low > high {
            (low, high) = (0.0, 1.0);
        }
        let size = low.abs().max(high.abs());
        let room = if high - low > 1e-12 * size {
            0.05 * (high - low)
        } else if size > 1e-280 {
            0.5 * size
        } else {
            1.0
        };
        Self::new(label, low - room, high + room)
    }

    /// Returns round tick values, their step, and the power of ten that is factored out of their labels. There are about `count` ticks, but at
    /// least two, and at least three on a logarithmic axis.
    fn ticks(&self, count: usize) -> (Vec<f64>, f64, i32) {
        /// Number of ticks from which a finer step does not help, because the axis is too short for the precision of its numbers.
        const ENOUGH: usize = 16;
        let step = round_step((self.high - self.low) / count as f64);
        let first = (self.low / step - 1e-9).ceil() as i64;
        let last = (self.high / step + 1e-9).floor() as i64;
        let least = if self.logarithmic { 3 } else { 2 };
        if last - first + 1 < least && count < ENOUGH {
            return self.ticks(2 * count);
        }
        let ticks = (first..=last).map(|i| i as f64 * step).collect();
        let size = self.low.abs().max(self.high.abs());
        let power = size.log10().floor() as i32;
        (ticks, step, if (-3..5).contains(&power) { 0 } else { power.div_euclid(3) * 3 })
    }

    pub fn full_label(&self, power: i32) -> String {
        if power == 0 { self.label.clone() } else { format!("{}  \u{d7}10{}", self.label, superscript(power)) }
    }
}

/// Returns 1, 2 or 5 times a power of ten, at least `raw`.
fn round_step(raw: f64) -> f64 {
    let power = 10_f64.powi(raw.log10().floor() as i32);
    [1.0, 2.0, 5.0, 10.0].iter().map(|m| m * power).find(|step| *step >= raw * 0.999).unwrap_or(10.0 * power)
}

/// Returns the label of a tick with as many decimals as the step needs.
fn tick_label(value: f64, step: f64, power: i32) -> String {
    let scale = 10_f64.powi(-power);
    let decimals = (-(step * scale).log10().floor()).clamp(0.0, 12.0) as usize;
    let text = format!("{:.decimals$}", value * scale);
    // A minus sign before zero comes from rounding; the typographic minus is as wide as a digit.
    let zero = text.trim_start_matches('-').chars().all(|c| c == '0' || c == '.');
    if zero { text.trim_start_matches('-').into() } else { text.replace('-', "\u{2212}") }
}

pub(super) fn superscript(power: i32) -> String {
    let digits = [
        '\u{2070}', '\u{b9}', '\u{b2}', '\u{b3}', '\u{2074}', '\u{2075}', '\u{2076}', '\u{2077}', '\u{2078}',
        '\u{2079}',
    ];
    power.to_string().chars().map(|c| c.to_digit(10).map_or('\u{207b}', |d| digits[d as usize])).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ticks_are_round_and_inside() {
        let (ticks, step, power) = Axis::new("", -0.3, 612.0).ticks(6);
        assert_eq!((step, power), (200.0, 0));
        assert_eq!(ticks, [0.0, 200.0, 400.0, 600.0]);
    }

    #[test]
    fn axes_have_two_labels_however_low_they_are() {
        for count in 2..6 {
            let labels = Axis::new("", -0.044, 0.0441).labelled(count).0;
            assert!(labels.len() > 1, "{labels:?}");
        }
    }

    #[test]
    fn logarithmic_axes_have_labels_over_any_range() {
        let labels = |low, high| {
            let axis = Axis::logarithmic("", low, high);
            axis.labelled(5).0.into_iter().map(|(_, label)| label).collect::<Vec<_>>()
        };
        assert_eq!(labels(80.0, 9000.0), ["10\u{b2}", "10\u{b3}"]);
        assert_eq!(labels(300.0, 5000.0), ["500", "1000", "2000", "5000"]);
        assert_eq!(labels(3900.0, 6100.0), ["4000", "5000", "6000"]);
        assert_eq!(labels(0.045, 0.12), ["0.05", "0.06", "0.07", "0.08", "0.09", "0.1"]);
        assert_eq!(labels(14_900.0, 22_000.0), ["16000", "18000", "20000", "22000"]);
        assert_eq!(
            labels(2e7, 6e7),
            ["2\u{b7}10\u{2077}", "3\u{b7}10\u{2077}", "4\u{b7}10\u{2077}", "5\u{b7}10\u{2077}", "6\u{b7}10\u{2077}"]
        );
        let around = Axis::logarithmic_around("", [0.0, f64::NAN, 200.0, 5000.0].into_iter());
        assert!(around.low < 200.0 && around.low > 100.0 && around.high > 5000.0);
    }

    /// Every axis of front speeds in ft/s has at least three labels.
    #[test]
    fn logarithmic_axes_of_any_length_have_three_labels() {
        for k in 0..200 {
            let low = 130.0 * 10_f64.powf(0.01 * f64::from(k));
            for factor in [1.05, 1.2, 1.5, 2.0, 3.0, 4.9, 9.9, 30.0] {
                let labels = Axis::logarithmic("", low, factor * low).labelled(5).0;
                assert!(labels.len() > 2, "{low} to {}: {labels:?}", factor * low);
            }
        }
    }

    #[test]
    fn small_numbers_give_their_power_to_the_label() {
        let axis = Axis::new("residual", -2e-15, 3e-15);
        let (ticks, step, power) = axis.ticks(5);
        assert_eq!(power, -15);
        let labels: Vec<_> = ticks.iter().map(|t| tick_label(*t, step, power)).collect();
        assert_eq!(labels, ["\u{2212}2", "\u{2212}1", "0", "1", "2", "3"]);
        assert_eq!(axis.full_label(power), "residual  \u{d7}10\u{207b}\u{b9}\u{2075}");
    }

    #[test]
    fn one_value_gets_an_axis_around_it() {
        for value in [0.0, 5.0, -3e8] {
            let axis = Axis::around("", [value, value].into_iter());
            assert!(axis.low < value && value < axis.high);
            assert!(!axis.ticks(5).0.is_empty());
        }
        assert!(!Axis::around("", std::iter::empty()).ticks(5).0.is_empty());
    }
}
