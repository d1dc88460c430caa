//! Reading of TOML files with errors that state file, line, key, value and remedy.

use std::ops::Range;
use std::path::Path;
use std::sync::Arc;

use serde::de::DeserializeOwned;
use toml::de::{DeTable, DeValue, ValueDeserializer};

use crate::error::{InputError, Place, Result};
use crate::text_file;
use crate::units::{Dimension, Quantity};

/// A number in a file, with its place.
pub type Number = toml::Spanned<Quantity>;

/// Deprecated keys that are still accepted: table, old name, present name.
pub const DEPRECATED_KEYS: [(&str, &str, &str); 5] = [
    ("effects", "unloading", "hardening"),
    ("solve", "event-budget", "max-events"),
    ("bar.segment", "notch", "stress-concentration"),
    ("bar.segment", "joint-notch", "joint-stress-concentration"),
    ("specimen", "notch", "stress-concentration"),
];

/// A text file being read; every error of its content is made here.
#[derive(Debug, Clone)]
pub struct Document {
    /// Name to show.
    pub file: String,
    /// Whole text.
    pub text: Arc<str>,
}

/// A key of a table, with its place and that of its value.
#[derive(Debug, Clone)]
pub struct GivenKey {
    /// Its name.
    pub name: String,
    /// Where the key stands.
    pub key: Range<usize>,
    /// Where its value stands.
    pub value: Range<usize>,
}

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

impl Document {
    /// Reads a file; a missing or unreadable one is an input error with a help line.
    pub fn read(path: &Path) -> Result<Self> {
        Ok(Self::new(path.display().to_string(), text_file::read(path)?))
    }

    /// Reads the record of an instrument, and says in which encoding it is unless in UTF-8; standard input where the path is `-`.
    ///
    /// # Errors
    /// An input error: the file cannot be read, or is no text.
    pub fn read_record(path: &Path) -> Result<(Self, Option<&'static str>)> {
        if path == Path::new("-") {
            return Ok((Self::read_scene(path)?, None));
        }
        let (text, encoding) = text_file::read_record(path)?;
        Ok((Self::new(path.display().to_string(), text), encoding))
    }

    /// Reads a scene: a file, or standard input where the path is `-`.
    pub fn read_scene(path: &Path) -> Result<Self> {
        if path == Path::new("-") { Ok(Self::new("stdin", text_file::read_stdin("stdin")?)) } else { Self::read(path) }
    }

    /// A document from text in memory.
    pub fn new(file: impl Into<String>, text: impl Into<Arc<str>>) -> Self {
        Self { file: file.into(), text: text.into() }
    }

    /// Parses into a serde mirror. An unknown key names the nearest right one; a syntax error keeps its line.
    pub fn parse<T: DeserializeOwned>(&self) -> Result<T> {
        toml::from_str(&self.text).map_err(|e| self.explain(&e).into())
    }

    /// An error at a span of this document.
    pub fn error(&self, span: Range<usize>, key: &str, message: impl Into<String>) -> InputError {
        InputError::new(message).key(key).at(Place { file: self.file.clone(), text: self.text.clone(), span })
    }

    /// Converts and checks one number. `key` is dotted, as in `solve.cfl`.
    pub fn number(&self, value: &Number, key: &str, dimension: Dimension, allowed: Allowed) -> Result<f64> {
        let name = last_part(key);
        let range = allowed.describe(name, dimension);
        let example = format!("e.g. {name} = \"{}\"", dimension.example());
        let typed = value.get_ref();
        let si = typed.si(dimension).map_err(|reason| {
            self.error(value.span(), key, reason).allowed(&range).help(number_help(name, dimension))
        })?;
        if allowed.holds(si) {
            return self.of_possible_magnitude(value, si, key, dimension, allowed);
        }
        let help = match allowed {
            Allowed::Finite => example,
            Allowed::Positive => format!("set `{name}` to a value above zero"),
            Allowed::NotNegative => format!("set `{name}` to zero or a positive value"),
            Allowed::Within(..) | Allowed::Above(..) | Allowed::Between(..) | Allowed::Below(..) => {
                format!("set `{name}` to a value in the allowed range")
            }
        };
        Err(self.error(value.span(), key, format!("{typed} is out of range")).allowed(range).help(help).into())
    }

    /// The same of a number that the text holds, whose key follows from its place.
    pub fn number_at(&self, value: &Number, dimension: Dimension, allowed: Allowed) -> Result<f64> {
        self.number_under(value, || self.key_at(&value.span()), dimension, allowed)
    }

    /// The same with a key that is made up for messages only.
    pub fn number_under(
        &self,
        value: &Number,
        key: impl Fn() -> String,
        dimension: Dimension,
        allowed: Allowed,
    ) -> Result<f64> {
        self.number(value, "", dimension, allowed).or_else(|_| self.number(value, &key(), dimension, allowed))
    }

    /// Refuses values with which no computation makes sense; those that may be zero may be as small as they like.
    fn of_possible_magnitude(
        &self,
        value: &Number,
        si: f64,
        key: &str,
        dimension: Dimension,
        allowed: Allowed,
    ) -> Result<f64> {
        let range = dimension.magnitudes();
        let least = if matches!(allowed, Allowed::Positive) { range.least } else { 0.0 };
        if (least..=range.most).contains(&si.abs()) {
            return Ok(si);
        }
        let (name, unit, what) = (last_part(key), dimension.si_symbol(), dimension.describe());
        let bounds = if least > 0.0 { format!("{least:e} <= {name} <= ") } else { format!("|{name}| <= ") };
        let error = self.error(value.span(), key, format!("{} is beyond the range of {what}", value.get_ref()));
        let help = format!("check the number and its unit: {}", range.reason);
        Err(error.allowed(format!("{bounds}{:e} {unit}", range.most).trim_end()).help(help).into())
    }

    /// Converts and checks a number that may be absent.
    pub fn optional(
        &self,
        value: Option<&Number>,
        key: &str,
        dimension: Dimension,
        allowed: Allowed,
    ) -> Result<Option<f64>> {
        value.map(|v| self.number(v, key, dimension, allowed)).transpose()
    }

    /// The dotted key whose key or value covers a span ("bar.segment.0.length"); empty at the top level.
    pub fn key_at(&self, span: &Range<usize>) -> String {
        let Ok(table) = DeTable::parse(&self.text) else { return String::new() };
        let mut path = Vec::new();
        walk_table(table.get_ref(), span, &mut path);
        path.join(".")
    }

    /// Where a dotted key's value stands; none where the text has no such key.
    pub fn span_of(&self, key: &str) -> Option<Range<usize>> {
        let table = DeTable::parse(&self.text).ok()?;
        let mut parts = key.split('.');
        let mut value = table.get_ref().get(parts.next()?)?;
        for part in parts {
            value = match value.get_ref() {
                DeValue::Table(table) => table.get(part)?,
                DeValue::Array(items) => items.get(part.parse::<usize>().ok()?)?,
                _ => return None,
            };
        }
        Some(value.span())
    }

    /// A whole number within `low..=high` that the text holds; 1e5 is one too.
    pub fn count_at(&self, value: &Number, low: usize, high: usize) -> Result<usize> {
        let range = Allowed::Within(low as f64, high as f64);
        let number = self.number_at(value, Dimension::None, range)?;
        if number.fract() == 0.0 {
            return Ok(number as usize);
        }
        let key = self.key_at(&value.span());
        let allowed = format!("{}, a whole number", range.describe(last_part(&key), Dimension::None));
        let error = self.error(value.span(), &key, format!("{number} is not a whole number")).allowed(allowed);
        Err(error.help(format!("write e.g. {} = {}", last_part(&key), number.round())).into())
    }

    /// Reads the table under a top-level key, but for the keys that are known already.
    pub fn read_table<T: DeserializeOwned>(&self, key: &str, known: &[&str]) -> Result<T> {
        let mut root = DeTable::parse(&self.text).map_err(|e| self.explain(&e))?.into_inner();
        let Some(mut value) = root.remove(key) else {
            return Err(self.missing_key(0..0, "", key).into());
        };
        if let DeValue::Table(table) = value.get_mut() {
            for key in known {
                table.remove(*key);
            }
        }
        T::deserialize(ValueDeserializer::from(value)).map_err(|e| self.explain(&e).into())
    }

    /// The keys of a top-level table under their present names, in the order of the text, with the places of keys and values.
    pub fn keys_in(&self, name: &str) -> Vec<GivenKey> {
        let root = DeTable::parse(&self.text).map(toml::Spanned::into_inner).unwrap_or_default();
        let Some(DeValue::Table(table)) = root.get(name).map(toml::Spanned::get_ref) else { return Vec::new() };
        let all = table.iter();
        let present = |key: &str| {
            let renamed = DEPRECATED_KEYS.iter().find(|(of, old, _)| *of == name && *old == key);
            renamed.map_or(key, |(.., new)| new).to_owned()
        };
        let given =
            all.map(|(key, value)| GivenKey { name: present(key.get_ref()), key: key.span(), value: value.span() });
        let mut keys: Vec<GivenKey> = given.collect();
        keys.sort_by_key(|given| given.key.start);
        keys
    }

    /// Turns what the TOML reader says into an error with key, suggestion and help.
    fn explain(&self, error: &toml::de::Error) -> InputError {
        let span = error.span().unwrap_or(0..0);
        let message = error.message();
        let quoted: Vec<&str> = message.split('`').skip(1).step_by(2).collect();
        let key = self.key_at(&span);
        if message.starts_with("unknown field") {
            return self.unknown_key(span, &key, &quoted);
        }
        if message.starts_with("unknown variant") {
            return self.unknown_word(span, &key, &quoted);
        }
        if let (true, Some(name)) = (message.starts_with("missing field"), quoted.first()) {
            // Without a table of its own the place is the whole file, whose first key is not to blame.
            let table = self.text.get(span.clone()).is_some_and(|text| text.starts_with(['[', '{']));
            let error = self.missing_key(span, if table { &key } else { "" }, name);
            // A number says what to add.
            return match message.split_once('\n') {
                Some((_, help)) => error.help(help.trim()),
                None => error,
            };
        }
        let tidy = plain_types(&message.trim().replace('\n', "; "), self.text.get(span.clone()).unwrap_or_default());
        if message.starts_with("duplicate key") {
            let twice = self.text.get(span.clone()).unwrap_or_default().trim().to_owned();
            return self.error(span, &twice, "duplicate key").help("keep one of the two");
        }
        if let (true, Some(name)) = (message.starts_with("duplicate field"), quoted.first()) {
            let old = DEPRECATED_KEYS.iter().find(|(.., new)| new == name).map_or("", |(_, old, _)| old);
            let message = format!("`{name}` and its old name `{old}` are both given");
            return self.error(span, &key, message).help(format!("remove `{old}`"));
        }
        let wrong_type = tidy.starts_with("found ");
        let help = match (wrong_type, tidy.split_once("expected ")) {
            (true, Some((_, expected))) => format!("write {expected} here"),
            _ => "write strings in \"quotes\", tables in [brackets], one `key = value` per line".into(),
        };
        self.error(span, &key, tidy).help(help)
    }

    fn unknown_key(&self, span: Range<usize>, key: &str, quoted: &[&str]) -> InputError {
        let (unknown, known) = split_first(quoted);
        let known: Vec<&str> = known.iter().copied().filter(|name| !is_deprecated(key, name)).collect();
        self.key_error(span, key, unknown, &known)
    }

    /// An error for a key that is none of those of its table; the nearest is suggested.
    pub fn key_error(&self, span: Range<usize>, key: &str, unknown: &str, known: &[&str]) -> InputError {
        let parent = key.rsplit_once('.').map_or("", |(parent, _)| parent);
        let place = if parent.is_empty() { "at the top level".to_owned() } else { format!("in `{parent}`") };
        let list = known.join(", ");
        let help = match nearest(unknown, known.iter().copied()) {
            Some(near) => format!("did you mean `{near}`? The keys {place} are: {list}"),
            None => format!("the keys {place} are: {list}"),
        };
        self.error(span, key, format!("unknown key `{unknown}`")).help(help)
    }

    fn unknown_word(&self, span: Range<usize>, key: &str, quoted: &[&str]) -> InputError {
        let (unknown, known) = split_first(quoted);
        self.word_error(span, key, unknown, known)
    }

    /// An error for a word that is none of the allowed ones; the nearest is suggested.
    pub fn word_error(&self, span: Range<usize>, key: &str, word: &str, known: &[&str]) -> InputError {
        let list = known.iter().map(|k| format!("\"{k}\"")).collect::<Vec<_>>().join(", ");
        let help = match nearest(word, known.iter().copied()) {
            Some(near) => format!("did you mean `{near}`?"),
            None => "write one of the allowed values".into(),
        };
        self.error(span, key, format!("unknown value `{word}`")).allowed(list).help(help)
    }

    fn missing_key(&self, span: Range<usize>, table: &str, name: &str) -> InputError {
        let key = if table.is_empty() { name.to_owned() } else { format!("{table}.{name}") };
        let place = if table.is_empty() { "the top level of the file".to_owned() } else { format!("`[{table}]`") };
        self.error(span, &key, format!("`{name}` is missing")).help(format!("add `{name}` to {place}"))
    }
}

/// The reader's words for types as users know them: `struct RawSolve` is a table. `value` is the text that it read.
fn plain_types(message: &str, value: &str) -> String {
    if message == "wanted string or table" {
        return format!("found `{value}`, expected a string or a table");
    }
    let Some((found, expected)) = message.split_once(", expected ") else { return message.to_owned() };
    let expected = match expected {
        "map" | "a map" => "a table",
        "a sequence" | "sequence" => "a list",
        name if name.starts_with("struct ") => "a table",
        other => other,
    };
    let typed = found.strip_prefix("invalid type: ").or_else(|| found.strip_prefix("invalid value: "));
    let found = match (typed, found.strip_prefix("invalid length ")) {
        (Some("map"), _) if value.starts_with(|c: char| c.is_ascii_digit()) => "date or time".to_owned(),
        (Some("map"), _) => "table".to_owned(),
        (Some("sequence"), _) => "list".to_owned(),
        (Some(typed), _) => typed.trim_end_matches(" as i128").trim_end_matches(" as u128").to_owned(),
        (None, Some(length)) => format!("a list of {length}"),
        (None, None) => return format!("{found}, expected {expected}"),
    };
    format!("found {found}, expected {expected}")
}

/// The word of a list that is most like a given one, if one is like it at all.
pub fn nearest<'a>(word: &str, known: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    let plain = |text: &str| text.to_lowercase().replace('_', "-");
    let word = plain(word);
    known
        .into_iter()
        .map(|k| (strsim::jaro_winkler(&plain(k), &word), k))
        .filter(|(likeness, _)| *likeness > 0.78)
        .max_by(|a, b| a.0.total_cmp(&b.0))
        .map(|(_, k)| k)
}

/// `name` is a deprecated name in the table of the dotted key `key`.
fn is_deprecated(key: &str, name: &str) -> bool {
    let mut parts: Vec<&str> = key.split('.').filter(|part| part.parse::<usize>().is_err()).collect();
    parts.pop();
    let table = parts.join(".");
    DEPRECATED_KEYS.iter().any(|(of, old, _)| *of == table && *old == name)
}

/// The last part of a dotted key, which is how a range names the value.
fn last_part(key: &str) -> &str {
    key.rsplit('.').find(|part| part.parse::<usize>().is_err()).unwrap_or(key)
}

fn number_help(name: &str, dimension: Dimension) -> String {
    match dimension.si_symbol() {
        "" => format!("write a plain number, e.g. {name} = {}", dimension.example()),
        symbol => format!("write e.g. {name} = \"{}\"; a plain number is in {symbol}", dimension.example()),
    }
}

fn split_first<'a, 'b>(words: &'b [&'a str]) -> (&'a str, &'b [&'a str]) {
    words.split_first().map_or(("", &[]), |(first, rest)| (*first, rest))
}

fn covers(outer: &Range<usize>, inner: &Range<usize>) -> bool {
    outer.start <= inner.start && inner.end <= outer.end
}

/// Follows the keys down to the one that covers the span; true where one was found.
fn walk_table(table: &DeTable<'_>, span: &Range<usize>, path: &mut Vec<String>) -> bool {
    for (key, value) in table {
        path.push(key.get_ref().to_string());
        if covers(&key.span(), span) || walk_value(value, span, path) {
            return true;
        }
        path.pop();
    }
    false
}

fn walk_value(value: &toml::Spanned<DeValue<'_>>, span: &Range<usize>, path: &mut Vec<String>) -> bool {
    let inside = match value.get_ref() {
        // The parts of a [table] may stand anywhere in the file, so its own span says nothing about them.
        DeValue::Table(table) => walk_table(table, span, path),
        DeValue::Array(items) => items.iter().enumerate().any(|(i, item)| {
            path.push(i.to_string());
            let found = walk_value(item, span, path);
            if !found {
                path.pop();
            }
            found
        }),
        _ => false,
    };
    inside || covers(&value.span(), span)
}

#[cfg(test)]
mod tests {
    use serde::Deserialize;

    use super::*;
    use crate::error::Error;

    #[derive(Debug, Deserialize)]
    #[serde(deny_unknown_fields)]
    #[expect(dead_code, reason = "only parsed")]
    struct File {
        title: Option<String>,
        bar: Option<Bar>,
    }

    #[derive(Debug, Deserialize)]
    #[serde(deny_unknown_fields)]
    #[expect(dead_code, reason = "only parsed")]
    struct Bar {
        length: Number,
        kind: Option<Kind>,
        segment: Option<Vec<Bar>>,
    }

    #[derive(Debug, Deserialize)]
    #[serde(rename_all = "kebab-case")]
    enum Kind {
        Free,
        Absorbing,
    }

    fn wrong(text: &str) -> InputError {
        match Document::new("test.toml", text).parse::<File>() {
            Err(Error::Input(error)) => error,
            other => panic!("{other:?}"),
        }
    }

    fn line(error: &InputError) -> usize {
        error.place.as_ref().map_or(0, |p| p.line())
    }

    #[test]
    fn an_unknown_key_names_path_line_and_the_nearest() {
        let error = wrong("title = \"x\"\n[bar]\nlenght = 1\n");
        assert_eq!((error.key.as_str(), line(&error)), ("bar.lenght", 3));
        assert_eq!(error.message, "unknown key `lenght`");
        assert!(error.help.starts_with("did you mean `length`?"), "{}", error.help);
        assert!(error.help.contains("length, kind, segment"), "{}", error.help);
    }

    #[test]
    fn keys_inside_arrays_of_tables_carry_their_index() {
        let error = wrong("[bar]\nlength = 1\n[[bar.segment]]\nlength = 1\n[[bar.segment]]\nlen = 2\n");
        assert_eq!((error.key.as_str(), line(&error)), ("bar.segment.1.len", 6));
    }

    #[test]
    fn an_unknown_word_lists_the_allowed_ones() {
        let error = wrong("[bar]\nlength = 1\nkind = \"fre\"\n");
        assert_eq!((error.key.as_str(), line(&error)), ("bar.kind", 3));
        assert_eq!(error.allowed, "\"free\", \"absorbing\"");
        assert_eq!(error.help, "did you mean `free`?");
    }

    #[test]
    fn a_missing_key_names_its_table() {
        let error = wrong("title = \"x\"\n\n[bar]\nkind = \"free\"\n");
        assert_eq!((error.key.as_str(), line(&error)), ("bar.length", 3));
        assert_eq!(error.help, "add `length` to `[bar]`");
    }

    #[test]
    fn a_wrong_type_says_what_is_expected() {
        let error = wrong("[bar]\nlength = true\n");
        assert_eq!((error.key.as_str(), line(&error)), ("bar.length", 2));
        assert!(error.message.contains("boolean `true`"), "{}", error.message);
        assert!(error.help.contains("a number, or a string with a unit"), "{}", error.help);
    }

    #[test]
    fn a_syntax_error_keeps_its_line() {
        let error = wrong("title = \"x\"\n[bar]\nlength = 1 m\n");
        assert_eq!(line(&error), 3);
        assert!(!error.help.is_empty());
    }

    #[test]
    fn numbers_out_of_range_show_value_and_range() {
        let document = Document::new("test.toml", "cfl = 1.5\n");
        let value = Number::new(6..9, Quantity::Number(1.5));
        let range = Allowed::Above(0.0, 1.0);
        let Err(Error::Input(error)) = document.number(&value, "solve.cfl", Dimension::None, range) else {
            panic!("1.5 was accepted");
        };
        assert_eq!(error.to_string(), "test.toml:1: `solve.cfl`: 1.5 is out of range (allowed: 0 < cfl <= 1)");
        assert!(!error.help.is_empty());
    }

    #[test]
    fn ranges_are_what_they_say() {
        assert!(!Allowed::Above(0.0, 1.0).holds(0.0) && Allowed::Above(0.0, 1.0).holds(1.0));
        assert!(Allowed::Within(0.0, 1.0).holds(0.0) && !Allowed::Within(0.0, 1.0).holds(1.1));
        assert!(!Allowed::Positive.holds(0.0) && Allowed::NotNegative.holds(0.0));
        assert!(!Allowed::Finite.holds(f64::INFINITY));
    }

    #[test]
    fn a_missing_file_is_an_input_error() {
        let Err(error) = Document::read(Path::new("no/such/scene.toml")) else { panic!("there is one") };
        assert_eq!(error.exit_code(), 2);
        assert!(error.to_string().contains("no such file"), "{error}");
    }
}
