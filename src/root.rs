//! Bracketed root finding for functions of one variable, with guaranteed termination.

/// Returns the point in `low..high` at which `below` changes from true to false: the upper end of a bracket no wider than `resolution`, or of two
/// neighbouring floating-point numbers if `resolution` is 0.
pub(crate) fn bisect([mut low, mut high]: [f64; 2], resolution: f64, mut below: impl FnMut(f64) -> bool) -> f64 {
    while high - low > resolution {
        let middle = 0.5 * (low + high);
        if middle <= low || middle >= high {
            break;
        }
        *if below(middle) { &mut low } else { &mut high } = middle;
    }
    high
}

/// Difference, as a sum of a relative and an absolute part, up to which two numbers count as equal.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Tolerance {
    pub relative: f64,
    pub absolute: f64,
}

impl Tolerance {
    /// Returns the tolerance for differences between numbers of this size.
    #[inline(always)]
    pub fn of_differences(size: f64) -> Self {
        Self { relative: 1e-14, absolute: 2.0 * f64::EPSILON * size }
    }

    /// Returns the tolerance at a number of this size.
    #[inline(always)]
    pub fn at(self, x: f64) -> f64 {
        self.relative * x.abs() + self.absolute
    }
}

/// Largest number of iterations. Secants need a handful; every fourth iteration bisects, for functions that jump.
const MOST_TRIES: usize = 200;

/// Returns the fixed point `x = answer(x)` between bounds at which `answer(x) - x` is not negative and not positive, respectively. The secant
/// method starts at `first` and stays within the bracket. If `answer` jumps across x, the upper side of the jump is returned.
pub(crate) fn fixed_point(
    first: f64,
    [mut low, mut high]: [f64; 2],
    tolerance: Tolerance,
    answer: impl Fn(f64) -> f64,
) -> f64 {
    let mut x = first;
    let mut last: Option<[f64; 2]> = None;
    for tries in 1..=MOST_TRIES {
        let found = answer(x);
        let off = found - x;
        if off.abs() <= tolerance.at(x) || !off.is_finite() {
            return if off.is_finite() { found.clamp(low, high) } else { x };
        }
        *if off > 0.0 { &mut low } else { &mut high } = x;
        if high - low <= tolerance.at(high) {
            return high;
        }
        let next = match last {
            Some([x0, off0]) if off0 != off => x - off * (x - x0) / (off - off0),
            _ => found,
        };
        last = Some([x, off]);
        x = if next > low && next < high && tries % 4 != 0 { next } else { between(low, high) };
    }
    x
}

/// Returns the middle of a bracket: the geometric mean if both ends are positive and differ by more than a factor of 4.
fn between(low: f64, high: f64) -> f64 {
    if low > 0.0 && high > 4.0 * low { (low * high).sqrt() } else { 0.5 * (low + high) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bisection_ends_at_neighbouring_numbers() {
        let root = bisect([0.0, 2.0], 0.0, |x| x * x < 2.0);
        assert!(root * root >= 2.0 && root.next_down() * root.next_down() < 2.0);
    }

    /// Slopes of up to 1 - 1e-9, kinks and signs: secants alone or repeated answers alone take many thousand tries for some of these.
    #[test]
    fn fixed_points_of_pieces_of_lines_are_found() {
        let tolerance = Tolerance { relative: 4.0 * f64::EPSILON, absolute: 0.0 };
        for slope in [0.0, 0.5, 0.999, 1.0 - 1e-9] {
            for kink in [-3.0, -1e-8, 0.0, 2.0, 1e6] {
                for offset in [-1.0, 1e-12, 5.0] {
                    let answer = |x: f64| offset + if x > kink { slope * kink } else { slope * x };
                    let reach = 1.01 * (answer(7.0) - 7.0).abs() / (1.0 - slope);
                    let x = fixed_point(7.0, [7.0 - reach, 7.0 + reach], tolerance, answer);
                    let off = (answer(x) - x).abs();
                    assert!(off <= 1e-14 * (x.abs() + offset.abs()), "{slope} {kink} {offset}: {x} off {off:e}");
                }
            }
        }
    }
}
