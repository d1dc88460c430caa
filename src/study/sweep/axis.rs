//! An axis of a sweep: a key of the scene and its values.
//!
//! Values are written into the scene as a user would write them, in the unit of the sweep file: steps of "0.1 mm" are decimal numbers of millimetres,
//! not sums of rounded metres.

use std::collections::BTreeSet;
use std::sync::LazyLock;

use rand::{RngExt, SeedableRng};
use rand_xorshift::XorShiftRng;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use toml::Value;

use crate::scene::{KINDS, RawScene};
use crate::study::random::standard_normal;
use crate::typed;
use crate::units::{Dimension, Quantity};

/// Most values of an axis.
pub(super) const MOST_VALUES: usize = 1_000_000;

/// Keys for random values.
pub(super) const RANDOM: [&str; 3] = ["uniform", "normal", "choice"];

/// Decimal places of the mantissa to which computed values are rounded: more than any input has, and few enough to remove rounding errors.
const DIGITS: usize = 14;

/// Fraction of a step by which the end of a range may be missed due to rounding.
const SLACK: f64 = 1e-9;

/// One value of an axis.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Level {
    /// Value as it is written into the scene, in TOML.
    pub typed: String,
    /// Value in SI units; `None` if it is not a number, such as the name of a material.
    pub si: Option<f64>,
}

/// A key of the scene and its values.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Axis {
    /// Dotted key, as for `--set`: `left.value`.
    pub key: String,
    /// SI unit of the values; empty for texts and dimensionless numbers.
    pub unit: String,
    /// Values in the order of the file.
    pub levels: Vec<Level>,
    /// Whether the values are spaced by equal ratios, or are random with uniformly distributed logarithms.
    #[serde(default)]
    pub logarithmic: bool,
}

/// The values of an axis, for the JSON schema.
#[derive(JsonSchema)]
#[schemars(untagged)]
#[expect(dead_code)]
pub(super) enum Values {
    /// A list.
    List(Vec<serde_json::Value>),
    /// Computed.
    Range(Box<RawRange>),
}

/// What a table of an axis may hold.
#[derive(Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub(super) struct RawRange {
    /// The first value.
    from: Option<Quantity>,
    /// The last value.
    to: Option<Quantity>,
    /// Number of values.
    count: Option<usize>,
    /// Distance of the values, in place of `count`.
    step: Option<Quantity>,
    /// Equal steps or equal ratios of a range; for `uniform`, whether the values or their logarithms are uniformly distributed.
    scale: Option<Scale>,
    /// Random values, uniformly distributed between these.
    uniform: Option<[Quantity; 2]>,
    /// Random values with this mean and standard deviation.
    normal: Option<[Quantity; 2]>,
    /// Random items of a list, drawn with replacement.
    #[schemars(with = "Vec<serde_json::Value>")]
    choice: Option<Vec<Value>>,
    /// Number of random values.
    samples: Option<usize>,
    /// Start of the random numbers: the same seed gives the same values.
    seed: Option<u64>,
}

#[derive(Debug, Clone, Copy, Default, PartialEq, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
enum Scale {
    #[default]
    Linear,
    Log,
}

/// Numbers in a common unit.
struct InUnit {
    numbers: Vec<f64>,
    /// Unit as typed; empty for SI.
    unit: String,
    dimension: Dimension,
}

type Read<T> = Result<T, String>;

impl Level {
    /// Returns the value as it is shown to users and in tables: a text without the quotes of TOML.
    pub(super) fn plain(&self) -> &str {
        self.typed.trim_matches(['"', '\''])
    }

    /// Returns the number in SI units, or the text.
    pub(super) fn value(&self) -> serde_json::Value {
        self.si.map_or_else(|| self.plain().into(), Into::into)
    }
}

impl Axis {
    /// Creates an axis from its value in the sweep file.
    ///
    /// # Errors
    /// A sentence that states what is wrong.
    pub(crate) fn read(key: &str, value: &Value) -> Read<Self> {
        let mut logarithmic = false;
        let (levels, dimension) = match value {
            Value::Array(items) if items.is_empty() => return Err("the list is empty".into()),
            Value::Array(items) => listed(items)?,
            Value::Table(_) => {
                let range: RawRange = value.clone().try_into().map_err(|e: toml::de::Error| e.message().to_owned())?;
                let (levels, dimension) = range.levels(key)?;
                logarithmic = range.scale == Some(Scale::Log);
                let computed = range.choice.is_none() && dimension == Dimension::None;
                (if computed && is_whole(key) { whole(levels, range.samples.is_some()) } else { levels }, dimension)
            }
            _ => return Err("an axis is a list of values, or a table such as { from = 1, to = 2, count = 11 }".into()),
        };
        Ok(Self { key: key.to_owned(), unit: dimension.spaced_symbol(), levels, logarithmic })
    }
}

/// Last components of all scene keys that are declared as whole numbers.
static WHOLE: LazyLock<BTreeSet<String>> = LazyLock::new(|| {
    let scenes = [typed::schema::<RawScene>()].into_iter().chain(KINDS.iter().map(|kind| (kind.schema)()));
    let mut names = BTreeSet::new();
    scenes.for_each(|schema| gather_whole(schema.as_value(), &mut names));
    names
});

fn gather_whole(schema: &serde_json::Value, names: &mut BTreeSet<String>) {
    use serde_json::Value as Json;
    let of_count = |key: &Json| key[typed::VALUE].as_str().is_some_and(|value| value.starts_with("whole number"));
    match schema {
        Json::Object(members) => {
            let keys = members.get("properties").and_then(Json::as_object).into_iter().flatten();
            names.extend(keys.filter(|(_, key)| of_count(key)).map(|(name, _)| name.clone()));
            members.values().for_each(|member| gather_whole(member, names));
        }
        Json::Array(items) => items.iter().for_each(|item| gather_whole(item, names)),
        _ => {}
    }
}

fn is_whole(key: &str) -> bool {
    WHOLE.contains(key.rsplit('.').next().unwrap_or(key))
}

/// Rounds computed values to the nearest whole numbers. Duplicates in a range are removed; random values may repeat.
fn whole(levels: Vec<Level>, random: bool) -> Vec<Level> {
    let rounded = |level: Level| match level.si.map(f64::round) {
        Some(number) => Level { typed: format!("{number:.0}"), si: Some(number) },
        None => level,
    };
    let mut levels: Vec<Level> = levels.into_iter().map(rounded).collect();
    if !random {
        levels.dedup();
    }
    levels
}

/// Returns the values of a list, each of which is a number, a number with a unit, or a text.
fn listed(items: &[Value]) -> Read<(Vec<Level>, Dimension)> {
    let quantity = |item: &Value| match item {
        Value::Float(number) => Some(Quantity::Number(*number)),
        Value::Integer(number) => Some(Quantity::Number(*number as f64)),
        Value::String(text) => Some(Quantity::Text(text.clone())),
        _ => None,
    };
    let measured: Vec<_> = items.iter().map(|item| quantity(item).and_then(|q| q.in_si().ok())).collect();
    let all = measured.iter().all(Option::is_some);
    let with_unit =
        || items.iter().zip(measured.iter().flatten()).filter(|(_, (_, dimension))| *dimension != Dimension::None);
    let dimension = with_unit().next().map_or(Dimension::None, |(_, (_, dimension))| *dimension);
    if let (true, Some((other, _)), Some((first, _))) =
        (all, with_unit().find(|(_, (_, own))| !own.is_like(dimension)), with_unit().next())
    {
        return Err(format!("{first} and {other} are of different dimensions"));
    }
    let level = |(item, si): (&Value, &Option<(f64, Dimension)>)| Level {
        typed: item.to_string(),
        si: si.filter(|_| all).map(|(si, _)| si),
    };
    Ok((items.iter().zip(&measured).map(level).collect(), if all { dimension } else { Dimension::None }))
}

impl RawRange {
    fn levels(&self, key: &str) -> Read<(Vec<Level>, Dimension)> {
        match (&self.uniform, &self.normal, &self.choice) {
            (Some(bounds), None, None) if self.scale == Some(Scale::Log) => {
                self.sampled(key, bounds, |[low, high], rng| between_logs([low, high], rng.random::<f64>()))
            }
            (Some(bounds), None, None) => {
                self.sampled(key, bounds, |[low, high], rng| Ok(low + (high - low) * rng.random::<f64>()))
            }
            (None, Some(_), None) if self.scale.is_some() => {
                Err("`scale` belongs to `uniform` and to ranges; `normal` has none".into())
            }
            (None, Some([_, deviation]), None) if deviation.in_si()?.0 < 0.0 => {
                Err(format!("the standard deviation {deviation} is out of range (allowed: >= 0)"))
            }
            (None, Some(moments), None) => {
                self.sampled(key, moments, |[mean, deviation], rng| Ok(mean + deviation * standard_normal(rng)))
            }
            (None, None, Some(items)) => self.chosen(key, items),
            (None, None, None) => self.range(),
            _ => Err("`uniform`, `normal` and `choice` exclude each other".into()),
        }
    }

    fn range(&self) -> Read<(Vec<Level>, Dimension)> {
        let (Some(from), Some(to)) = (&self.from, &self.to) else {
            return Err(
                "give `from` and `to`, or `uniform = [lowest, highest]`, or `normal = [mean, standard deviation]`, or \
                 `choice = [...]`"
                    .into(),
            );
        };
        if self.samples.is_some() || self.seed.is_some() {
            return Err(
                "`samples` and `seed` belong to `uniform`, `normal` and `choice`; a range has `count` or `step`".into(),
            );
        }
        let all: Vec<&Quantity> = [from, to].into_iter().chain(&self.step).collect();
        let InUnit { numbers, unit, dimension } = in_one_unit(&all)?;
        let [from, to] = [numbers[0], numbers[1]];
        let values: Vec<f64> = match (self.count, numbers.get(2), self.scale.unwrap_or_default()) {
            (Some(_), Some(_), _) => return Err("`count` and `step` exclude each other".into()),
            (None, Some(_), Scale::Log) => {
                return Err("a range with scale = \"log\" has a `count`, not a `step`".into());
            }
            (None, None, _) => return Err("give `count`, the number of values, or `step`".into()),
            (Some(count), None, scale) => {
                (0..counted(count)?).map(|i| between([from, to], i, count, scale)).collect::<Read<_>>()?
            }
            (None, Some(step), Scale::Linear) => stepped([from, to], *step)?,
        };
        levels(&values, &unit, dimension)
    }

    fn sampled(
        &self,
        key: &str,
        given: &[Quantity; 2],
        draw: impl Fn([f64; 2], &mut XorShiftRng) -> Read<f64>,
    ) -> Read<(Vec<Level>, Dimension)> {
        let samples = self.samples()?;
        let InUnit { numbers, unit, dimension } = in_one_unit(&given.iter().collect::<Vec<_>>())?;
        let mut rng = self.random_numbers(key);
        let values = (0..samples).map(|_| draw([numbers[0], numbers[1]], &mut rng)).collect::<Read<Vec<f64>>>()?;
        levels(&values, &unit, dimension)
    }

    /// Draws items with replacement.
    fn chosen(&self, key: &str, items: &[Value]) -> Read<(Vec<Level>, Dimension)> {
        let samples = self.samples()?;
        if items.is_empty() || self.scale.is_some() {
            return Err("`choice` is a list of values, with `samples` and `seed` and no other keys".into());
        }
        let (all, dimension) = listed(items)?;
        let mut rng = self.random_numbers(key);
        Ok(((0..samples).map(|_| all[rng.random_range(0..all.len())].clone()).collect(), dimension))
    }

    /// Returns the random number generator of a key. Axes with the same seed are independent of each other.
    fn random_numbers(&self, key: &str) -> XorShiftRng {
        let own = u64::from(crc32fast::hash(key.as_bytes())) << 32;
        XorShiftRng::seed_from_u64(self.seed.unwrap_or(1) ^ own)
    }

    /// Returns the number of random values.
    fn samples(&self) -> Read<usize> {
        if self.from.is_some() || self.to.is_some() || self.count.is_some() || self.step.is_some() {
            return Err("random samples have `samples` and `seed`, not the keys of a range".into());
        }
        counted(self.samples.ok_or("give `samples`, the number of random values")?)
    }
}

fn counted(count: usize) -> Read<usize> {
    if (1..=MOST_VALUES).contains(&count) {
        Ok(count)
    } else {
        Err(format!("{count} values are out of range (allowed: 1 to {MOST_VALUES})"))
    }
}

/// Returns value `i` of `count` values between the bounds, both included.
fn between([from, to]: [f64; 2], i: usize, count: usize, scale: Scale) -> Read<f64> {
    let share = if count > 1 { i as f64 / (count - 1) as f64 } else { 0.0 };
    if scale == Scale::Linear {
        return Ok(rounded(from + (to - from) * share));
    }
    between_logs([from, to], share).map(rounded)
}

/// Returns the number at a fraction of the way between the bounds on a logarithmic scale.
fn between_logs([from, to]: [f64; 2], part: f64) -> Read<f64> {
    if from * to <= 0.0 {
        return Err("scale = \"log\" needs bounds of one sign, neither of them zero".into());
    }
    Ok(from * (to / from).powf(part))
}

/// Returns values from one bound in steps towards the other, which is included if a whole number of steps reaches it.
fn stepped([from, to]: [f64; 2], step: f64) -> Read<Vec<f64>> {
    let steps = ((to - from) / step).abs();
    if !steps.is_finite() {
        return Err("`step` must not be zero".into());
    }
    let count = counted((steps + SLACK).floor() as usize + 1)?;
    let step = step.abs().copysign(to - from);
    Ok((0..count).map(|i| rounded(from + i as f64 * step)).collect())
}

/// Removes the last digits, which are affected by rounding.
fn rounded(value: f64) -> f64 {
    format!("{value:.DIGITS$e}").parse().unwrap_or(value)
}

/// Converts quantities of one dimension to numbers in their common unit, or in SI units if their units differ. Plain numbers are in SI units,
/// whatever their dimension.
fn in_one_unit(quantities: &[&Quantity]) -> Read<InUnit> {
    let si = quantities.iter().map(|q| q.in_si()).collect::<Read<Vec<_>>>()?;
    let parts: Vec<(f64, &str)> = quantities.iter().map(|q| q.number_and_unit()).collect::<Read<_>>()?;
    let first = parts.iter().position(|part| !part.1.is_empty()).unwrap_or(0);
    let (unit, dimension) = (parts[0].1, si[first].1);
    let other = |k: &usize| !parts[*k].1.is_empty() && !si[*k].1.is_like(dimension);
    if let Some(k) = (0..parts.len()).find(other) {
        return Err(format!("`{}` and `{}` are of different dimensions", quantities[first], quantities[k]));
    }
    if parts.iter().all(|part| part.1 == unit) {
        return Ok(InUnit { numbers: parts.iter().map(|part| part.0).collect(), unit: unit.to_owned(), dimension });
    }
    Ok(InUnit { numbers: si.iter().map(|si| si.0).collect(), unit: String::new(), dimension })
}

fn levels(values: &[f64], unit: &str, dimension: Dimension) -> Read<(Vec<Level>, Dimension)> {
    let level = |&value: &f64| {
        if unit.is_empty() {
            return Ok(Level { typed: format!("{value:?}"), si: Some(value) });
        }
        let text = format!("{value} {unit}");
        Ok(Level { si: Some(Quantity::Text(text.clone()).si(dimension)?), typed: format!("\"{text}\"") })
    };
    Ok((values.iter().map(level).collect::<Read<_>>()?, dimension))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn axis(text: &str) -> Read<Axis> {
        let table: toml::Table = format!("a = {text}").parse().expect("TOML");
        Axis::read("left.value", &table["a"])
    }

    fn typed(text: &str) -> Vec<String> {
        axis(text).expect("an axis").levels.into_iter().map(|level| level.typed).collect()
    }

    #[test]
    fn ranges_are_decimal() {
        assert_eq!(typed("{ from = 0, to = 0.3, step = 0.1 }"), ["0.0", "0.1", "0.2", "0.3"]);
        assert_eq!(
            typed("{ from = \"-5 m/s\", to = \"-15 m/s\", count = 3 }"),
            ["\"-5 m/s\"", "\"-10 m/s\"", "\"-15 m/s\""]
        );
        assert_eq!(typed("{ from = 1, to = 100, count = 3, scale = \"log\" }"), ["1.0", "10.0", "100.0"]);
        // A step in another unit: all in SI.
        assert_eq!(typed("{ from = \"1 m\", to = \"2 m\", step = \"50 cm\" }"), ["1.0", "1.5", "2.0"]);
        let speeds = axis("{ from = \"10 ft/s\", to = \"20 ft/s\", count = 2 }").expect("an axis");
        assert_eq!((speeds.unit.as_str(), speeds.levels[0].si), ("m/s", Some(3.048)));
    }

    #[test]
    fn keys_of_whole_numbers_have_whole_values() {
        for key in ["cells", "frames", "max-events", "modes", "shapes"] {
            assert!(is_whole(key), "{key}: {WHOLE:?}");
        }
        assert!(!is_whole("left.value") && !is_whole("solve.cfl"));
        let cells = |text: &str| {
            let table: toml::Table = format!("a = {text}").parse().expect("TOML");
            let axis = Axis::read("solve.cells", &table["a"]).expect("an axis");
            axis.levels.into_iter().map(|level| level.typed).collect::<Vec<_>>()
        };
        assert_eq!(cells("{ from = 100, to = 1000, count = 4, scale = \"log\" }"), ["100", "215", "464", "1000"]);
        assert_eq!(cells("{ from = 2, to = 4, count = 7 }"), ["2", "3", "4"]);
        assert_eq!(cells("{ uniform = [2, 4], samples = 20 }").len(), 20);
        assert_eq!(cells("[2.5]"), ["2.5"]);
    }

    #[test]
    fn lists_are_numbers_or_texts() {
        let names = axis("[\"copper-annealed\", \"mild-steel\"]").expect("an axis");
        assert_eq!((names.levels[0].typed.as_str(), names.levels[0].si), ("\"copper-annealed\"", None));
        let lengths = axis("[\"10 cm\", 0.2]").expect("an axis");
        assert_eq!((lengths.unit.as_str(), lengths.levels[1].si), ("m", Some(0.2)));
        let speeds = axis("{ from = -5, to = \"-18 km/h\", count = 2 }").expect("a plain number is in SI");
        assert_eq!(
            (
                speeds.unit.as_str(),
                speeds.levels[1].si,
                typed("{ from = \"1 km/h\", to = 4, count = 1 }")[0].is_empty()
            ),
            ("m/s", Some(-5.0), false)
        );
    }

    #[test]
    fn samples_follow_their_seed_and_distribution() {
        let sample = |seed: u64| {
            axis(&format!("{{ normal = [\"1 m\", \"1 cm\"], samples = 4000, seed = {seed} }}")).expect("an axis")
        };
        assert_eq!(sample(3), sample(3));
        assert_ne!(sample(3), sample(4));
        let values: Vec<f64> = sample(5).levels.iter().filter_map(|level| level.si).collect();
        let mean = values.iter().sum::<f64>() / 4000.0;
        let variance = values.iter().map(|v| (v - mean) * (v - mean)).sum::<f64>() / 3999.0;
        // Four standard errors.
        assert!((mean - 1.0).abs() < 6.4e-4 && (variance.sqrt() / 0.01 - 1.0).abs() < 0.045, "{mean} {variance}");
        let chosen =
            axis("{ choice = [\"mild-steel\", \"copper-annealed\"], samples = 100, seed = 2 }").expect("an axis");
        let steel = chosen.levels.iter().filter(|level| level.typed == "\"mild-steel\"").count();
        assert!(chosen.levels.len() == 100 && (30..70).contains(&steel), "{steel}");
        let logs = axis("{ uniform = [\"-1 m/s\", \"-100 m/s\"], scale = \"log\", samples = 400 }").expect("an axis");
        let below = logs.levels.iter().filter(|level| level.si.expect("a number") > -10.0).count();
        assert!((150..250).contains(&below), "{below}");
        let uniform = axis("{ uniform = [2, 3], samples = 100 }").expect("an axis");
        assert!(uniform.levels.iter().all(|level| (2.0..3.0).contains(&level.si.expect("a number"))));
    }

    #[test]
    fn axes_with_the_same_seed_are_independent() {
        let of = |key: &str| {
            let table: toml::Table = "a = { normal = [0, 1], samples = 4000 }".parse().expect("TOML");
            let axis = Axis::read(key, &table["a"]).expect("an axis");
            axis.levels.into_iter().filter_map(|level| level.si).collect::<Vec<f64>>()
        };
        let (one, other) = (of("left.value"), of("bar.length"));
        let correlation = one.iter().zip(&other).map(|(a, b)| a * b).sum::<f64>() / 4000.0;
        // Four standard errors.
        assert!(correlation.abs() < 0.064, "{correlation}");
        assert_eq!(one, of("left.value"));
    }

    #[test]
    fn wrong_axes_are_explained() {
        for (text, words) in [
            ("[]", "empty"),
            ("3", "an axis is a list"),
            ("{ from = 1 }", "give `from` and `to`"),
            ("{ from = 1, to = 2 }", "give `count`"),
            ("{ from = 1, to = 2, step = 0 }", "must not be zero"),
            ("{ from = -1, to = 2, count = 3, scale = \"log\" }", "one sign"),
            ("{ from = \"1 m\", to = \"2 s\", count = 3 }", "different dimensions"),
            ("[\"-1 m/s\", 2, \"5 kN\"]", "different dimensions"),
            ("{ normal = [\"1 m\", \"-1 cm\"], samples = 3 }", "standard deviation -1 cm is out of range"),
            ("{ from = 1, to = 2, cuont = 3 }", "unknown field `cuont`"),
            ("{ from = 0, to = 1, step = 1e-9 }", "out of range"),
            ("{ uniform = [0, 1] }", "give `samples`"),
            ("{ uniform = [0, 1], normal = [0, 1], samples = 2 }", "exclude each other"),
            ("{ uniform = [-1, 1], scale = \"log\", samples = 2 }", "one sign"),
            ("{ choice = [], samples = 2 }", "a list of values"),
        ] {
            let error = axis(text).expect_err(text);
            assert!(error.contains(words), "{text}: {error}");
        }
    }
}
