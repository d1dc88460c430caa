//! Changes of keys, `KEY=VALUE` (`--set` on the command line): the text of the scene is edited before it is read, so that all checks of the file
//! apply.

use toml_edit::{ArrayOfTables, DocumentMut, Item, Value};

use crate::error::{Error, InputError, Place, Result};
use crate::input::{DEPRECATED_KEYS, Document};

/// File name in the position of an error in a change `KEY=VALUE`, and key of an error for a text that is not of this form.
pub const CHANGES: &str = "changes";

/// Override, split into key and value.
#[derive(Debug, Clone)]
struct Override {
    typed: String,
    key: Vec<String>,
    value: String,
}

/// Overrides of a scene.
#[derive(Debug, Clone)]
pub(super) struct Overrides(Vec<Override>);

impl Overrides {
    /// Splits texts such as "left.value=-40 m/s" at the first "=".
    pub(super) fn new(typed: &[String]) -> Result<Self> {
        typed.iter().map(|t| split(t)).collect::<Result<_>>().map(Self)
    }

    /// Returns the overrides as they were typed.
    pub(super) fn texts(&self) -> Vec<String> {
        self.0.iter().map(|one| one.typed.clone()).collect()
    }

    /// Returns the document with all overrides applied in order. An empty VALUE removes the key.
    pub(super) fn apply(&self, document: &Document) -> Result<Document> {
        if self.0.is_empty() { Ok(document.clone()) } else { self.edit(document, editable(document)?) }
    }

    /// Returns the document with all overrides applied to `edited`, its parsed text.
    pub(super) fn edit(&self, document: &Document, mut edited: DocumentMut) -> Result<Document> {
        for one in &self.0 {
            one.put(edited.as_item_mut()).map_err(|message| one.error(message))?;
        }
        Ok(Document::new(document.file.clone(), edited.to_string()))
    }

    /// Returns the dotted keys that are set, without the indices of lists.
    pub(super) fn keys(&self) -> Vec<String> {
        let named = |o: &Override| {
            let parts: Vec<&str> =
                o.key.iter().map(String::as_str).filter(|part| part.parse::<usize>().is_err()).collect();
            parts.join(".")
        };
        self.0.iter().map(named).collect()
    }

    /// Moves the position of an error in the edited text to what the user can see: the override, or the same key in the file.
    pub(super) fn explain(&self, error: Error, original: &Document) -> Error {
        let Error::Input(error) = error else { return error };
        if self.0.is_empty() || error.place.as_ref().is_none_or(|p| p.file != original.file) {
            return error.into();
        }
        // The last override takes precedence, as in the text. A table that the file does not contain was created by the override of a key in it.
        let is_new = original.span_of(&error.key).is_none();
        if let Some(one) = self.0.iter().rev().find(|o| o.concerns(&error.key) || is_new && o.is_inside(&error.key)) {
            return one.place(error).into();
        }
        match original.span_of(&error.key) {
            Some(span) => error.at(original.place(span)).into(),
            None => error.into(),
        }
    }
}

/// Parses the document so that it can be edited.
pub(super) fn editable(document: &Document) -> Result<DocumentMut> {
    // The error of the reader for an invalid file is better than that of the editor.
    document.parse::<toml::Table>()?;
    document.text.parse().map_err(|e: toml_edit::TomlError| InputError::new(e.message()).into())
}

fn split(typed: &str) -> Result<Override> {
    let wrong = |message: &str| {
        InputError::new(format!("{typed}: {message}"))
            .key(CHANGES)
            .allowed("KEY=VALUE with a dotted key")
            .help("write e.g. \"solve.cells=4000\" or \"left.value=-40 m/s\"")
    };
    let (key, value) = typed.split_once('=').ok_or_else(|| wrong("missing `=`"))?;
    let key: Vec<String> = key.trim().split('.').map(|part| part.trim().to_owned()).collect();
    if key.iter().any(String::is_empty) {
        return Err(wrong("the key is incomplete").into());
    }
    Ok(Override { typed: typed.to_owned(), key, value: value.trim().to_owned() })
}

impl Override {
    /// Returns the value as TOML if it is valid, otherwise as a string: a shell removes quotes.
    fn parsed(&self) -> Value {
        self.value.parse().unwrap_or_else(|_| Value::from(self.value.as_str()))
    }

    fn put(&self, root: &mut Item) -> std::result::Result<(), String> {
        let Some((last, parents)) = self.key.split_last() else { return Ok(()) };
        let (mut item, mut path) = (root, String::new());
        for part in parents {
            let part = name_in_file(item, &path, part);
            // A missing table is not entered, because this would create it.
            if self.value.is_empty() && item.as_table_like().is_some_and(|table| !table.contains_key(part)) {
                return Ok(());
            }
            item = step(item, part)?;
            if part.parse::<usize>().is_err() {
                path = if path.is_empty() { part.to_owned() } else { format!("{path}.{part}") };
            }
        }
        let last = name_in_file(item, &path, last);
        if self.value.is_empty() {
            return remove(item, last);
        }
        *step(item, last)? = Item::Value(self.parsed());
        Ok(())
    }

    /// Returns whether the key of an error is the one that is set here, or lies inside it.
    fn concerns(&self, key: &str) -> bool {
        let own = self.key.join(".");
        key == own || key.strip_prefix(&own).is_some_and(|rest| rest.starts_with('.'))
    }

    /// Returns whether the key of an error is that of a table around the one that is set here.
    fn is_inside(&self, key: &str) -> bool {
        self.key.join(".").strip_prefix(key).is_some_and(|rest| rest.starts_with('.'))
    }

    /// Moves the position of an error to the value, or to the part of the key that caused it.
    fn place(&self, error: InputError) -> InputError {
        let start = self.typed.find('=').map_or(0, |i| i + 1);
        let part = error.key.rsplit('.').next().unwrap_or_default();
        let is_of_key = error.place.as_ref().is_some_and(|place| place.text.get(place.span.clone()) == Some(part));
        let span = match self.typed[..start].rfind(part) {
            Some(at) if is_of_key => at..at + part.len(),
            _ if start < self.typed.len() => start..self.typed.len(),
            _ => 0..self.typed.len(),
        };
        error.at(Place { file: CHANGES.into(), text: self.typed.as_str().into(), span })
    }

    fn error(&self, message: String) -> InputError {
        let help = "the key is dotted as in the file, e.g. solve.cells or bar.segment.0.length (counted from 0)";
        self.place(InputError::new(message).key(self.key.join(".")).help(help))
    }
}

/// Returns the name under which a table of the file contains the key `part`, if it has either only the deprecated or only the present name.
fn name_in_file<'a>(item: &Item, path: &str, part: &'a str) -> &'a str {
    let has = |name: &str| item.as_table_like().is_some_and(|table| table.contains_key(name));
    let names = DEPRECATED_KEYS.iter().filter(|(table, ..)| *table == path);
    let mut other = names.flat_map(|&(_, old, new)| [(old, new), (new, old)]);
    if has(part) { part } else { other.find(|(from, to)| *from == part && has(to)).map_or(part, |(_, to)| to) }
}

/// Returns the item at one part of a key; a missing item is created as an inline table.
fn step<'a>(item: &'a mut Item, part: &str) -> std::result::Result<&'a mut Item, String> {
    match item {
        Item::ArrayOfTables(_) | Item::Value(Value::Array(_)) => step_index(item, part),
        Item::None if part.parse::<usize>().is_ok() => {
            Err(format!("there is no item {part}: the scene has no such list, and no item can be added to it here"))
        }
        Item::None | Item::Table(_) | Item::Value(Value::InlineTable(_)) => Ok(&mut item[part]),
        Item::Value(_) => Err(format!("`{part}` cannot be set inside a value of type {}", item.type_name())),
    }
}

fn step_index<'a>(item: &'a mut Item, part: &str) -> std::result::Result<&'a mut Item, String> {
    let count = match item {
        Item::ArrayOfTables(tables) => tables.len(),
        _ => item.as_array().map_or(0, toml_edit::Array::len),
    };
    let index: usize =
        part.parse().map_err(|_| format!("`{part}` must be a number, the index of an item in a list"))?;
    if index >= count {
        return Err(format!("there is no item {index}: the list has {count}, counted from 0"));
    }
    Ok(&mut item[index])
}

/// Removes a key; a missing key is not an error. For items of lists the index must exist.
fn remove(item: &mut Item, part: &str) -> std::result::Result<(), String> {
    if let Item::ArrayOfTables(tables) = item {
        let count = tables.len();
        let missing = || format!("there is no item `{part}`: the list has {count}, counted from 0");
        return if remove_table(tables, part) { Ok(()) } else { Err(missing()) };
    }
    // A missing key is not an error.
    let _ = item.as_table_like_mut().and_then(|table| table.remove(part));
    Ok(())
}

fn remove_table(tables: &mut ArrayOfTables, part: &str) -> bool {
    let index = part.parse().ok().filter(|i: &usize| *i < tables.len());
    if let Some(index) = index {
        tables.remove(index);
    }
    index.is_some()
}
