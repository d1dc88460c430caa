//! Parsing of numbers with units to SI.
//!
//! Grammar: number, then factors joined by "*", "·", a blank (product) or "/" (quotient), read from left to
//! right; a factor is a symbol or a bracket, with an optional power: "^3", "^-1", "**2", "²", "⁻¹".

use super::Dimension;
use super::table::{self, Exponents};

/// A unit expression multiplied out: numerator/denominator * 10^ten, with exponents of m, kg, s, K.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Factor {
    numerator: f64,
    denominator: f64,
    ten: i32,
    exponents: Exponents,
}

const UNITY: Factor = Factor { numerator: 1.0, denominator: 1.0, ten: 0, exponents: [0; 4] };

impl Factor {
    fn times(self, other: Self) -> Self {
        let mut exponents = self.exponents;
        for (e, o) in exponents.iter_mut().zip(other.exponents) {
            *e += o;
        }
        Self {
            numerator: self.numerator * other.numerator,
            denominator: self.denominator * other.denominator,
            ten: self.ten + other.ten,
            exponents,
        }
    }

    fn power(self, n: i32) -> Self {
        let (up, down) = if n < 0 { (self.denominator, self.numerator) } else { (self.numerator, self.denominator) };
        Self {
            numerator: up.powi(n.abs()),
            denominator: down.powi(n.abs()),
            ten: self.ten * n,
            exponents: self.exponents.map(|e| e * n),
        }
    }

    /// Converts a value to SI. Each of the three operations rounds once; decimal units need none of them: "150 us" is the same number as 150e-6.
    fn apply(self, value: f64) -> f64 {
        let scaled = value * self.numerator / self.denominator;
        if self.ten < 0 { scaled / 10f64.powi(-self.ten) } else { scaled * 10f64.powi(self.ten) }
    }
}

/// Returns the SI value of a text such as "80 ft/s".
pub(super) fn parse(text: &str, dimension: Dimension) -> Result<f64, String> {
    let trimmed = text.trim();
    let (value, rest) = split_number(trimmed)?;
    let rest = rest.trim();
    if table::DEGREES.contains(&rest) {
        return temperature(value, rest, trimmed, dimension);
    }
    if rest.is_empty() {
        return bare(value, trimmed, dimension);
    }
    let factor = Parser { rest, depth: 0 }.whole()?;
    if factor.exponents != dimension.exponents() {
        return Err(wrong_dimension(trimmed, factor.exponents, dimension));
    }
    let si = decimal(&trimmed[..trimmed.len() - rest.len()], factor).unwrap_or_else(|| factor.apply(value));
    if dimension == Dimension::AngularVelocity && rest.contains("Hz") {
        let turning = 2.0 * std::f64::consts::PI * si;
        return Err(format!("`{trimmed}` is a frequency; as an angular velocity it is {turning:.6} rad/s"));
    }
    if si.is_finite() { Ok(si) } else { Err(format!("`{trimmed}` is too large")) }
}

/// Returns the SI value of a number in a decimal unit: the floating-point number nearest to the decimal fraction, without intermediate rounding.
/// `None` if the unit is not decimal.
fn decimal(number: &str, factor: Factor) -> Option<f64> {
    if factor.numerator != 1.0 || factor.denominator != 1.0 || factor.ten == 0 {
        return None;
    }
    let number = number.trim().replace('\u{2212}', "-");
    let (mantissa, exponent) = number.split_once(['e', 'E']).unwrap_or((&number, "0"));
    let exponent = exponent.parse::<i32>().ok()?.checked_add(factor.ten)?;
    format!("{mantissa}e{exponent}").parse().ok()
}

fn bare(value: f64, text: &str, dimension: Dimension) -> Result<f64, String> {
    if dimension == Dimension::None {
        return Ok(value);
    }
    let (what, example) = (dimension.describe(), dimension.example());
    Err(format!(
        "`{text}` has no unit; {what} is expected, e.g. \"{example}\" (or a plain number in SI, without quotes)"
    ))
}

fn temperature(value: f64, symbol: &str, text: &str, dimension: Dimension) -> Result<f64, String> {
    if dimension != Dimension::Temperature {
        return Err(wrong_dimension(text, Dimension::Temperature.exponents(), dimension));
    }
    let fahrenheit = symbol.ends_with(['F', '℉']);
    Ok(if fahrenheit { (value + 459.67) * 5.0 / 9.0 } else { value + 273.15 })
}

/// Splits "10in" into 10 and "in".
pub(super) fn split_number(text: &str) -> Result<(f64, &str), String> {
    let sign = text.chars().next().filter(|c| matches!(c, '+' | '-' | '\u{2212}'));
    let unsigned = &text[sign.map_or(0, char::len_utf8)..];
    let end = number_end(unsigned);
    let not_a_number = || format!("`{text}` does not start with a number");
    let magnitude: f64 = unsigned[..end].parse().map_err(|_| not_a_number())?;
    let rest = &unsigned[end..];
    if rest.starts_with(',') {
        return Err(format!("`{text}` has a comma in its number; write the decimal point as `.`, and no separators"));
    }
    if !magnitude.is_finite() {
        return Err(format!("`{text}` is too large"));
    }
    Ok((if matches!(sign, Some('-' | '\u{2212}')) { -magnitude } else { magnitude }, rest))
}

/// Returns the number of bytes of digits, point and exponent; an "e" without digits belongs to the unit.
fn number_end(text: &str) -> usize {
    let digits = |from: usize| text[from..].bytes().take_while(u8::is_ascii_digit).count();
    let mut end = digits(0);
    if text[end..].starts_with('.') {
        end += 1 + digits(end + 1);
    }
    if text[end..].starts_with(['e', 'E']) {
        let sign = usize::from(text[end + 1..].starts_with(['+', '-']));
        let power = digits(end + 1 + sign);
        if power > 0 {
            end += 1 + sign + power;
        }
    }
    end
}

struct Parser<'a> {
    rest: &'a str,
    /// Number of open brackets.
    depth: u32,
}

/// Largest nesting depth of brackets: a unit needs no more, and deeper recursion would exhaust the stack.
const DEEPEST: u32 = 8;

impl Parser<'_> {
    fn whole(mut self) -> Result<Factor, String> {
        let factor = self.expression()?;
        match self.rest.chars().next() {
            None => Ok(factor),
            Some(c) => Err(format!("`{c}` is not expected in a unit")),
        }
    }

    fn expression(&mut self) -> Result<Factor, String> {
        let mut product = UNITY;
        // "1/s" and "/s" start with a quotient.
        if self.starts_with_one() || self.rest.starts_with('/') {
            self.rest = self.rest.trim_start_matches('1').trim_start();
        } else {
            product = self.factor()?;
        }
        loop {
            self.rest = self.rest.trim_start();
            if self.take('/') {
                product = product.times(self.factor()?.power(-1));
            } else if self.take('*') || self.take('·') {
                product = product.times(self.factor()?);
            } else if self.rest.is_empty() || self.rest.starts_with(')') {
                return Ok(product);
            } else {
                product = product.times(self.factor()?);
            }
        }
    }

    fn starts_with_one(&self) -> bool {
        self.rest.strip_prefix('1').is_some_and(|r| r.trim_start().starts_with('/'))
    }

    fn factor(&mut self) -> Result<Factor, String> {
        self.rest = self.rest.trim_start();
        let base = if self.take('(') {
            self.depth += 1;
            if self.depth > DEEPEST {
                return Err("the unit has too many brackets".into());
            }
            let inner = self.expression()?;
            if !self.take(')') {
                return Err("a bracket in the unit is not closed".into());
            }
            self.depth -= 1;
            inner
        } else {
            self.symbol()?
        };
        Ok(base.power(self.exponent()?))
    }

    fn symbol(&mut self) -> Result<Factor, String> {
        let is_symbol = |c: char| c.is_alphabetic() && !"⁻⁰¹²³⁴⁵⁶⁷⁸⁹".contains(c) || matches!(c, '%' | '°' | '_');
        let end = self.rest.find(|c| !is_symbol(c)).unwrap_or(self.rest.len());
        let (symbol, rest) = self.rest.split_at(end);
        if symbol.is_empty() {
            return Err(match rest.chars().next() {
                None => "the unit is incomplete".into(),
                Some(c) if c.is_ascii_digit() => {
                    format!("a unit is expected at `{rest}`; fractions are written as decimals, e.g. \"0.5 in\"")
                }
                Some(c) => format!("a unit is expected at `{c}`"),
            });
        }
        self.rest = rest;
        // The micro sign and the Greek letter mu look alike; both are the prefix u.
        let plain = symbol.replace(['\u{b5}', '\u{3bc}'], "u");
        let unit = table::find(&plain).ok_or_else(|| unknown(symbol, &plain))?;
        Ok(Factor { numerator: unit.mantissa, denominator: 1.0, ten: unit.ten, exponents: unit.exponents })
    }

    fn exponent(&mut self) -> Result<i32, String> {
        if let Some(rest) = self.rest.strip_prefix("**").or_else(|| self.rest.strip_prefix('^')) {
            let rest = rest.trim_start();
            let sign = usize::from(rest.starts_with(['-', '+']));
            let end = sign + rest[sign..].bytes().take_while(u8::is_ascii_digit).count();
            self.rest = &rest[end..];
            return small_power(&rest[..end]);
        }
        let raised: String = self.rest.chars().map_while(lowered).collect();
        if raised.is_empty() {
            return Ok(1);
        }
        let bytes: usize = self.rest.chars().take(raised.chars().count()).map(char::len_utf8).sum();
        self.rest = &self.rest[bytes..];
        small_power(&raised)
    }

    fn take(&mut self, c: char) -> bool {
        let rest = self.rest.strip_prefix(c);
        self.rest = rest.unwrap_or(self.rest);
        rest.is_some()
    }
}

/// Parses a power from -9 to 9: physical powers are small; larger ones are mistakes, and would overflow.
fn small_power(text: &str) -> Result<i32, String> {
    let wrong = || format!("a unit's power must be an integer from -9 to 9, not `{text}`");
    text.parse().ok().filter(|n| (-9..=9).contains(n)).ok_or_else(wrong)
}

fn lowered(c: char) -> Option<char> {
    match c {
        '⁻' => Some('-'),
        '¹' => Some('1'),
        '²' => Some('2'),
        '³' => Some('3'),
        '⁴' => Some('4'),
        '⁵' => Some('5'),
        '⁶' => Some('6'),
        '⁷' => Some('7'),
        '⁸' => Some('8'),
        '⁹' => Some('9'),
        _ => None,
    }
}

/// Whether a word is a unit, or is meant as one: `MPa`, `Mpa`, `N/mm2`, `usec`.
pub(crate) fn is_like_unit(word: &str) -> bool {
    let is_unit = Parser { rest: word, depth: 0 }.whole().is_ok();
    let plain = word.replace(['\u{b5}', '\u{3bc}'], "u");
    is_unit || word.contains(['/', '^', '*']) || plain.ends_with("sec") || table::in_another_case(&plain).is_some()
}

fn unknown(shown: &str, plain: &str) -> String {
    if table::DEGREES.contains(&plain) {
        return format!("`{shown}` has an offset zero and cannot be part of a compound unit; use `K`");
    }
    match table::nearest(plain) {
        Some(near) => format!("unknown unit `{shown}`; did you mean `{near}`?"),
        None => format!("unknown unit `{shown}`"),
    }
}

/// Returns a unit such as "m^2 s^-1", for messages.
fn in_base_units(exponents: Exponents) -> String {
    let units = ["m", "kg", "s", "K"].into_iter().zip(exponents).filter(|(_, power)| *power != 0);
    units
        .map(|(unit, power)| if power == 1 { unit.to_owned() } else { format!("{unit}^{power}") })
        .collect::<Vec<_>>()
        .join(" ")
}

fn wrong_dimension(text: &str, given: Exponents, expected: Dimension) -> String {
    let what = Dimension::ALL.iter().find(|d| d.exponents() == given).map(|d| format!("is {}", d.describe()));
    let what = what.unwrap_or_else(|| format!("is in {}", in_base_units(given)));
    let (want, example) = (expected.describe(), expected.example());
    let meant = match expected {
        _ if text.contains("lb") => "; `lb` is mass, `lbf` is force",
        Dimension::Time if text.ends_with('m') => "; a minute is `min`",
        _ => "",
    };
    format!("`{text}` {what}, but {want} is expected, e.g. \"{example}\"{meant}")
}
