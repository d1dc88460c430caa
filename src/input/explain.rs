//! Converts errors of the TOML reader into errors for users: the key, the known keys of its table, and the remedy.

use std::ops::Range;

use super::deprecated::{is_deprecated, old_name};
use super::{Document, nearest};
use crate::error::InputError;

impl Document {
    /// Converts an error of the TOML reader into an error with key, suggestion and help.
    pub(super) fn explain(&self, error: &toml::de::Error) -> InputError {
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
            // Without a table of its own, the position is the whole file, whose first key is unrelated to the error.
            let table = self.text.get(span.clone()).is_some_and(|text| text.starts_with(['[', '{']));
            let error = self.missing_key(span, if table { &key } else { "" }, name);
            // For a number, the second line of the message is the help.
            return match message.split_once('\n') {
                Some((_, help)) => error.help(help.trim()),
                None => error,
            };
        }
        let value = self.text.get(span.clone()).unwrap_or_default();
        let tidy = plain_types(&message.trim().replace('\n', "; "), value, word_or_table(&key));
        if message.starts_with("duplicate key") {
            let twice = self.text.get(span.clone()).unwrap_or_default().trim().to_owned();
            return self.error(span, &twice, "duplicate key").help("keep one of the two");
        }
        if let (true, Some(name)) = (message.starts_with("duplicate field"), quoted.first()) {
            let old = old_name(name).unwrap_or(name);
            let message = format!("`{name}` and its old name `{old}` are both given");
            return self.error(span, &key, message).help(format!("remove `{old}`"));
        }
        let tidy = plain_syntax(&tidy, self.text.get(span.clone()).unwrap_or_default()).unwrap_or(tidy);
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
        if let Some([found, wanted]) = self.other_kind(&known).filter(|_| !key.contains('.')) {
            let message = format!("this file is {}, not {}", found.name(), wanted.name());
            return self.error(span, key, message).help(found.commands());
        }
        self.key_error(span, key, unknown, &known)
    }

    /// Returns the error for a key that is unknown in its table; the most similar known key is suggested.
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

    /// Returns the error for a word that is not among the allowed ones; the most similar one is suggested.
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

/// Returns the allowed values of a key that accepts a word or a table; the reader's error does not contain them.
fn word_or_table(key: &str) -> &'static str {
    match key {
        "effects.hardening" => "\"isotropic\", \"kinematic\", or a table such as { mixed = 0.3 }",
        "effects.rupture" => "\"critical-strain\", or a table such as { spall = \"2 GPa\" }",
        _ => "a string or a table",
    }
}

/// Replaces the reader's names of types by those that users know: `struct RawSolve` is a table. `value` is the text that was read. `choice` describes
/// the allowed values of a key that accepts a word or a table.
fn plain_types(message: &str, value: &str, choice: &str) -> String {
    if message == "wanted string or table" {
        return format!("found `{value}`, expected {choice}");
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
        (Some("map"), _) if value.starts_with(|c: char| c.is_ascii_digit()) => "a date or time".to_owned(),
        (Some("map"), _) => "a table".to_owned(),
        (Some("sequence"), _) => "a list".to_owned(),
        (Some(typed), _) => typed.trim_end_matches(" as i128").trim_end_matches(" as u128").to_owned(),
        (None, Some(length)) => format!("a list of {length}"),
        (None, None) => return format!("{found}, expected {expected}"),
    };
    format!("found {found}, expected {expected}")
}

/// Returns an error of the reader about TOML syntax in plain words; `None` if its message is clear.
fn plain_syntax(message: &str, value: &str) -> Option<String> {
    let value = value.lines().next().unwrap_or_default().trim();
    let unquoted =
        || if value.is_empty() { "a value is missing".to_owned() } else { format!("text without quotes: `{value}`") };
    let says = |part: &str| message.contains(part);
    Some(if says("wanted exactly 1 element") {
        "one entry is allowed in this table, several are given".to_owned()
    } else if says("string values must be quoted") {
        unquoted()
    } else if says("invalid float") || says("invalid integer") {
        "malformed number".to_owned()
    } else if says("invalid basic string") || says("invalid literal string") {
        "the closing quote of a string is missing".to_owned()
    } else if says("cannot recurse further") {
        "lists or tables are nested too deeply".to_owned()
    } else {
        return None;
    })
}

fn split_first<'a, 'b>(words: &'b [&'a str]) -> (&'a str, &'b [&'a str]) {
    words.split_first().map_or(("", &[]), |(first, rest)| (*first, rest))
}

#[cfg(test)]
mod tests {
    use serde::Deserialize;

    use super::*;
    use crate::error::Error;
    use crate::input::Number;

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
    fn the_grammar_of_the_reader_stays_with_it() {
        let said = |text: &str| wrong(text).message;
        assert_eq!(said("title =\n"), "a value is missing");
        assert_eq!(said("title = \"x\n"), "the closing quote of a string is missing");
        assert_eq!(said("[bar]\nlength = 1.2.3\n"), "malformed number");
        assert_eq!(said(&format!("title = {}\n", "[".repeat(3000))), "lists or tables are nested too deeply");
    }

    #[test]
    fn a_syntax_error_keeps_its_line() {
        let error = wrong("title = \"x\"\n[bar]\nlength = 1 m\n");
        assert_eq!(line(&error), 3);
        assert!(!error.help.is_empty());
    }
}
