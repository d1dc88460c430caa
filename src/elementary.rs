//! Exponential and logarithm as plain sums and products without branches. The compiler vectorizes loops over them, and their results are bitwise
//! the same on every processor, which the standard library does not guarantee.

use std::f64::consts::LOG2_E;

const MANTISSA: u64 = (1 << 52) - 1;
const ONE: u64 = 1.0_f64.to_bits();
const SQRT_HALF: u64 = std::f64::consts::FRAC_1_SQRT_2.to_bits();

/// ln 2 as a sum of two parts; the first has few digits, so that its product with an integer is exact.
const LN_2: [f64; 2] = [f64::from_bits(0x3FE6_2E42_FEE0_0000), f64::from_bits(0x3DEA_39EF_3579_3C76)];

/// Adding this number rounds to an integer, which the last bits of the sum then hold.
const WHOLE: f64 = 1.5 * LAST_BIT_ONE;

/// From this number on, the last bit of a number has the value 1.
const LAST_BIT_ONE: f64 = (1_u64 << 52) as f64;

/// Largest magnitude of the argument of exponentials: the result is then a normal number.
pub(crate) const LARGEST_EXPONENT: f64 = 700.0;

/// `1/n!` for n = 2 to 13.
const FACTORIALS: [f64; 12] = {
    let (mut terms, mut k) = ([0.5; 12], 1);
    while k < 12 {
        terms[k] = terms[k - 1] / (k + 2) as f64;
        k += 1;
    }
    terms
};

/// `2/(2 n + 1)` for n = 1 to 11.
const ODD: [f64; 11] = {
    let (mut terms, mut k) = ([0.0; 11], 0);
    while k < 11 {
        terms[k] = 2.0 / (2 * k + 3) as f64;
        k += 1;
    }
    terms
};

/// Returns the sum of `terms[k] x^k`. Even and odd powers are summed separately, so that the two sums do not wait for each other.
#[inline(always)]
fn polynomial<const N: usize>(terms: &[f64; N], x: f64) -> f64 {
    let (square, mut sums) = (x * x, [0.0; 2]);
    for k in (0..N).rev() {
        sums[k % 2] = sums[k % 2] * square + terms[k];
    }
    sums[0] + x * sums[1]
}

/// Returns `[scale, rest]` of `exp(x) = scale (1 + rest)`, where `scale` is a power of 2 and `rest` lies between -0.3 and 0.42.
#[inline(always)]
fn scaled(x: f64) -> [f64; 2] {
    let whole = x * LOG2_E + WHOLE;
    let power = whole - WHOLE;
    let rest = (x - power * LN_2[0]) - power * LN_2[1];
    let scale = f64::from_bits((whole.to_bits() << 52).wrapping_add(ONE));
    [scale, rest + rest * rest * polynomial(&FACTORIALS, rest)]
}

/// Returns `exp(x)` for |x| up to [`LARGEST_EXPONENT`].
#[inline(always)]
pub(crate) fn exp(x: f64) -> f64 {
    let [scale, rest] = scaled(x);
    scale + scale * rest
}

/// Returns `exp(x) - 1` for |x| up to [`LARGEST_EXPONENT`].
#[inline(always)]
pub(crate) fn exp_m1(x: f64) -> f64 {
    let [scale, rest] = scaled(x);
    scale * rest + (scale - 1.0)
}

/// Returns `ln(x)` for normal x > 0.
#[inline(always)]
pub(crate) fn ln(x: f64) -> f64 {
    // x = 2^power (1 + f) with 1 + f between sqrt(1/2) and sqrt(2), and with s = f/(2 + f), ln(1 + f) = 2 (s + s^3/3 + s^5/5 + ...).
    let bits = x.to_bits().wrapping_add(ONE - SQRT_HALF);
    let power = f64::from_bits((bits >> 52) | LAST_BIT_ONE.to_bits()) - (LAST_BIT_ONE + 1023.0);
    let f = f64::from_bits((bits & MANTISSA) + SQRT_HALF) - 1.0;
    let s = f / (2.0 + f);
    let (square, half) = (s * s, 0.5 * f * f);
    let rest = s * (half + square * polynomial(&ODD, square));
    power * LN_2[0] + (f - (half - (rest + power * LN_2[1])))
}

/// Returns `ln(1 + x)` for finite x >= 0.
#[inline(always)]
pub(crate) fn ln_1p(x: f64) -> f64 {
    let sum = 1.0 + x;
    ln(sum) + (x - (sum - 1.0)) / sum
}

/// Returns the smaller of two numbers, the second if one is NaN. Compiles to one instruction, unlike [`f64::min`].
#[inline(always)]
pub(crate) fn lesser(a: f64, b: f64) -> f64 {
    if a < b { a } else { b }
}

/// Returns the larger of two numbers, the second if one is NaN.
#[inline(always)]
pub(crate) fn larger(a: f64, b: f64) -> f64 {
    if a > b { a } else { b }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Largest difference from the standard library, in units in the last place.
    fn largest_difference(own: fn(f64) -> f64, standard: fn(f64) -> f64, arguments: impl Iterator<Item = f64>) -> u64 {
        arguments.map(|x| own(x).to_bits().abs_diff(standard(x).to_bits())).max().expect("arguments")
    }

    /// Sizes from the smallest normal numbers to a largest one, evenly spaced on a scale of powers.
    fn sizes(largest: f64) -> impl Iterator<Item = f64> + Clone {
        (0..400_000).map(move |k| largest * (f64::from(k) * -0.00175).exp()).filter(|x| x.is_normal())
    }

    #[test]
    fn they_are_those_of_the_standard_library_to_two_units_in_the_last_place() {
        let exponents = || sizes(LARGEST_EXPONENT).chain(sizes(3.0)).flat_map(|x| [x, -x]);
        assert!(largest_difference(exp, f64::exp, exponents()) <= 1);
        assert!(largest_difference(exp_m1, f64::exp_m1, exponents()) <= 2);
        let near_one = sizes(0.5).flat_map(|x| [1.0 + x, 1.0 - x]);
        let numbers = || sizes(f64::MAX).chain(sizes(1e10)).chain(near_one.clone());
        assert!(largest_difference(ln, f64::ln, numbers()) <= 1);
        assert!(largest_difference(ln_1p, f64::ln_1p, numbers()) <= 2);
    }

    #[test]
    fn they_are_exact_where_the_result_is_a_number() {
        assert_eq!([exp(0.0), exp_m1(0.0), ln(1.0), ln_1p(0.0)], [1.0, 0.0, 0.0, 0.0]);
    }
}
