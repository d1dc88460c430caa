//! One unknown that is its own answer: `x = answer(x)`.

/// Answers that differ by this part are one.
const SAME: f64 = 1e-14;

/// Secants take a handful; halving, every fourth try, is there for answers that jump.
const MOST_TRIES: usize = 200;

/// The root of `answer(x) - x` between bounds (>= 0) at which it is not negative and not positive, from a first guess: by
/// secants, kept within the bracket. Where the answer jumps across x, the upper side of the jump. `size` is that of the
/// numbers whose differences answers are.
pub(super) fn root(first: f64, [mut low, mut high]: [f64; 2], size: f64, answer: impl Fn(f64) -> f64) -> f64 {
    let noise = 2.0 * f64::EPSILON * size;
    let mut x = first;
    let mut last: Option<[f64; 2]> = None;
    for tries in 1..=MOST_TRIES {
        let found = answer(x);
        let off = found - x;
        if off.abs() <= SAME * x.abs() + noise || !off.is_finite() {
            return if off.is_finite() { found.clamp(low, high) } else { x };
        }
        if off > 0.0 {
            low = x;
        } else {
            high = x;
        }
        if high - low <= SAME * high + noise {
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

fn between(low: f64, high: f64) -> f64 {
    if low > 0.0 && high > 4.0 * low { (low * high).sqrt() } else { 0.5 * (low + high) }
}
