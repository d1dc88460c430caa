//! Scene keys and values that are known but not yet simulated: each is refused by name, with an alternative.

use std::ops::Range;

use toml::Spanned;
use toml::de::{DeTable, DeValue};

use crate::error::Result;
use crate::input::Document;

/// A refusal: the key ("*" is any item of a list), the value that is meant (empty: any), what it is, and the way out.
struct Word {
    path: &'static [&'static str],
    value: &'static str,
    what: &'static str,
    instead: &'static str,
}

const fn word(path: &'static [&'static str], value: &'static str, what: &'static str, instead: &'static str) -> Word {
    Word { path, value, what, instead }
}

const STRIKER: &str =
    "give an end kind = \"striker\" with mass and velocity, or place two segments in contact with joint = \"contact\"";

const WORDS: &[Word] = &[
    word(&["striker"], "", "a striking body of its own", STRIKER),
    word(&["solve", "viscosity"], "", "artificial viscosity", "remove it"),
];

/// Refuses the first word that cannot be simulated. Text that is no TOML passes: its reader complains better.
pub(super) fn refuse(document: &Document) -> Result<()> {
    let Ok(table) = DeTable::parse(&document.text) else { return Ok(()) };
    for word in WORDS {
        if let Some(span) = find(table.get_ref(), word.path, word.value) {
            let key = document.key_at(&span);
            let message = format!("this version does not simulate {}", word.what);
            return Err(document.error(span, &key, message).help(word.instead).into());
        }
    }
    Ok(())
}

/// The span of a value at a path; for a path alone, the span of its key.
fn find(table: &DeTable<'_>, path: &[&str], value: &str) -> Option<Range<usize>> {
    let (first, rest) = path.split_first()?;
    let (key, item) = table.iter().find(|(key, _)| key.get_ref() == *first)?;
    if !rest.is_empty() {
        return find_in(item, rest, value);
    }
    if value.is_empty() {
        return Some(key.span());
    }
    (item.get_ref().as_str() == Some(value)).then(|| item.span())
}

fn find_in(item: &Spanned<DeValue<'_>>, path: &[&str], value: &str) -> Option<Range<usize>> {
    match (item.get_ref(), path) {
        (DeValue::Table(table), _) => find(table, path, value),
        (DeValue::Array(items), ["*", rest @ ..]) => items.iter().find_map(|i| find_in(i, rest, value)),
        _ => None,
    }
}
